"""isoref: every method of the reference."""

import numpy as np


def surface(values, isovalue, spacing, method):
    """The surface by the method of this name in the catalogue."""
    from isoref import extract

    return extract(values, isovalue, spacing, method=method)


def simplicial(values, isovalue, spacing, rule):
    """The level set on Kuhn's simplices, for any number of axes and fields."""
    from isoref.fast.simplicial import extract
    from isoref.field import Field

    return extract(Field.of(values, spacing, dimension=len(spacing)), isovalue, rule=rule)


def diconex(values, isovalue, spacing, mode):
    """The contours of DICONEX, open ones first."""
    from isoref.fast.diconex import diconex
    from isoref.field import Field

    return diconex(Field.of(values, spacing), isovalue, mode=mode).polygons()


def marching_faces(a, b, isovalue_a, isovalue_b, spacing):
    """The curves in which two isosurfaces meet, from face to face."""
    from isoref.fast.marching_faces import intersection_curves
    from isoref.field import Field

    fields = Field.of(a, spacing), Field.of(b, spacing)
    curves = intersection_curves(*fields, (isovalue_a, isovalue_b))
    return [curve.polyline for curve in curves]


def directed_curves(a, b, isovalue_a, isovalue_b, spacing):
    """The same curves with a vector at each vertex, its tangent times the confidence in it."""
    from isoref.curves import moved_on
    from isoref.fast.marching_faces import Pair, join
    from isoref.fast.marching_faces import marching_faces as points_of
    from isoref.field import Field

    asked = Field.of(a, spacing), Field.of(b, spacing), (isovalue_a, isovalue_b), "gradient"
    points = points_of(*asked)
    chosen, segments, start = [np.empty(0, np.int64)], [np.empty((0, 2), np.int64)], 0
    for chain, closed in join(points, Pair(*asked)):
        chain = chain[moved_on(points.positions[chain], closed)]
        if len(chain) > 2 and (points.positions[chain[0]] == points.positions[chain[-1]]).all():
            chain, closed = chain[:-1], True
        if len(chain) > 1:
            step = np.arange(len(chain) if closed else len(chain) - 1)
            segments.append(start + np.stack([step, (step + 1) % len(chain)], axis=1))
            chosen.append(chain)
            start += len(chain)
    used = np.concatenate(chosen)
    directions = points.tangents[used] * points.confidence[used, None]
    return points.positions[used], np.concatenate(segments), directions


def surface_intersection(a, b, isovalue_a, isovalue_b, spacing):
    """The curves in which the triangles of two isosurfaces meet."""
    from isoref.fast.surface_intersection import intersection_curves
    from isoref.field import Field

    fields = Field.of(a, spacing), Field.of(b, spacing)
    curves = intersection_curves(*fields, (isovalue_a, isovalue_b))
    return [curve.polyline for curve in curves]


LIBRARY = {"distribution": "isograde", "imports": ["isoref"]}
_CLAIMS = {"disconnect": "cells.separate", "connect": "cells.join", "mixed": "cells.mean"}
# Tetrahedra over a block of 2 x 2 x 2 cells: in each cell the one of its points with an even sum,
# and the four corners that it leaves.
_CELLS = [(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]


def _five():
    """The alternating split into five tetrahedra a cell."""
    found = []
    for cell in _CELLS:
        points = [[a + b for a, b in zip(cell, corner, strict=True)] for corner in _CELLS]
        even = [p for p in points if sum(p) % 2 == 0]
        found.append(even)
        for odd in (p for p in points if sum(p) % 2):
            near = [p for p in even if sum(abs(a - b) for a, b in zip(p, odd, strict=True)) == 1]
            found.append([odd, *near])
    return {"tetrahedra": found}


# What a call leaves behind, and what it does among threads.
_CALLS = ["calls.*"]


def _surface(method, promised=(), **said):
    """The row of a method of the catalogue."""
    said = {"promised": [*_CALLS, *promised], **said}
    return {"function": "surface", "options": {"method": method}, "declaration": said}


def _simplicial(rule, most):
    """The row of a rule of the simplicial method, for which (n, m) is anything up to n = `most`."""
    kinds = [[n, m] for n in range(1, most + 1) for m in range(1, n + 1)]
    limits = {"kinds": kinds, "least": 2}
    said = {"interpolant": "kuhn", "limits": limits}
    return {"function": "simplicial", "options": {"rule": rule}, "declaration": said}


_INSET = {"domain": {"inset": 0.5, "end": "open"}}
METHODS = {
    "isoref:lorensen-cline": _surface("lorensen-cline"),
    "isoref:asymptotic-decider": _surface("asymptotic-decider", level=3),
    "isoref:trilinear-cubes": _surface("trilinear-cubes", level=4),
    **{
        f"isoref:{way}-{mode}-{resolution}": _surface(
            f"{way}-{mode}-{resolution}", promised=[_CLAIMS[mode]]
        )
        for way in ("marching-vesta", "vesta")
        for mode in _CLAIMS
        for resolution in "LH"
    },
    "isoref:marching-tetrahedra-kuhn": _surface("marching-tetrahedra-kuhn", interpolant="kuhn"),
    "isoref:marching-tetrahedra-five": _surface("marching-tetrahedra-five", interpolant=_five()),
    "isoref:surface-nets": _surface(
        "surface-nets", vertices="cells", level=1, notes="not manifold at ambiguous cells", **_INSET
    ),
    "isoref:dual-marching-cubes": _surface("dual-marching-cubes", vertices="cells", **_INSET),
    "isoref:label-cubes": _surface(
        "label-cubes", interpolant="labels", promised=["cells.separate"]
    ),
    "isoref:simplicial": _simplicial("staircase", 6),
    # The paper prints its tables for simplices of six corners at most.
    "isoref:simplicial-printed": _simplicial("printed", 5),
    **{
        f"isoref:diconex-{mode}": {
            "function": "diconex",
            "options": {"mode": mode},
            "declaration": {"limits": {"kinds": [[2, 1]]}, "promised": [*_CALLS, claim]},
        }
        for mode, claim in _CLAIMS.items()
    },
    **{
        f"isoref:{name.replace('_', '-')}": {
            "function": function,
            "declaration": {
                "limits": {"kinds": [[3, 2]]},
                "promised": [*_CALLS, "curves.identical"],
                # The gradient that decides a face is taken in space, so a spacing turns it.
                "not_promised": ["symmetry.spacing"] if name == "marching_faces" else [],
            },
        }
        for name, function in (
            ("marching_faces", "directed_curves"),
            ("surface_intersection", "surface_intersection"),
        )
    },
}
