"""The claim of VESTA: a surface is perfect before its points are moved from the middle of edges.

No adapter gives the surface with its points still in the middle of their lattice edges. But a field
whose samples are all about as far from the isovalue, some above and some below, has every crossing
in the middle: the surface of such a field *is* the unmoved one. The variant `level` makes one of
any field, and keeps what the averages of ambiguous faces decide, so that the cycles of a mixed
mode occur as well.

Moved, a surface may well degenerate: a point that moves to the end of its edge meets others.

Triangles and distances are asked with a margin (`isograde.oracles.apart`), for points on edges
stand a little beside the middle. Not so in a cell whose level set has a tunnel: the values say how
narrow the tunnel is, also where all are about 1 and -1, and who draws it truly has small triangles
there. In such a cell nothing but rounding counts as no area, or as one place.
"""

from __future__ import annotations

import numpy as np
from isoref.field import Booleans, Floats

from isograde.claims.cells import on_cell_edges
from isograde.claims.evidence import (
    VERDICT_OF,
    failed,
    on_mesh,
    passed,
    place,
    placed,
    skipped,
)
from isograde.model import SURFACES, Claim, Finding, Status, Trial, Verdict
from isograde.oracles import apart
from isograde.oracles.complexes import Complex
from isograde.oracles.self_intersections import self_intersections
from isograde.oracles.trilinear import NONE, cells
from isograde.variants import pose

VARIANT = "level"


def perfect(trial: Trial) -> Finding:
    """Pass when the levelled field's surface has no flat or crossing triangles or equal points."""
    outcome = trial.outcomes.get(VARIANT)
    if outcome is None:
        return skipped("the values are too large to be levelled")
    if outcome.status is Status.DECLINED:
        return Finding(Verdict.UNSUPPORTED, outcome.detail)
    mesh = outcome.mesh_of(trial.kind)
    if mesh is None:
        verdict = VERDICT_OF.get(outcome.status, Verdict.FAIL)
        told = outcome.detail or "what came is no mesh of this kind"
        return Finding(verdict, f"{VARIANT}: {told}", {"variant": VARIANT})
    return _judged(trial, placed(trial, mesh))


def _judged(trial: Trial, surface: Complex) -> Finding:
    """The first fault of the unmoved surface, or how many triangles have none."""
    places, faces = surface.points, surface.simplices
    if not len(faces):
        return skipped("there is no triangle")
    used = np.unique(faces)
    flat = apart.without_area(places[faces])
    flat = flat[
        ~_in_tunnels(trial, places[faces[flat]].mean(axis=1))
        | np.isin(flat, apart.without_area(places[faces], apart.ROUNDING))
    ]
    if len(flat):
        return _told(len(flat), "triangles have no area", places[faces[flat[0]]].mean(axis=0))
    met = apart.together(places[used])
    near = places[used[met]]
    met = met[
        ~_in_tunnels(trial, near.mean(axis=1))
        | (np.linalg.norm(near[:, 0] - near[:, 1], axis=1) < apart.ROUNDING)
    ]
    if len(met):
        return _told(len(met), "points fall together with another", places[used[met[0, 0]]])
    crossed = self_intersections(places, faces)
    if len(crossed):
        where = places[faces[crossed[0, 0]]].mean(axis=0)
        return _told(len(crossed), "pairs of triangles cross or overlap", where)
    return passed(triangles=len(faces), points=len(used))


def _in_tunnels(trial: Trial, places: Floats) -> Booleans:
    """Which places (n, 3) are inside a cell whose level set, levelled, has a tunnel."""
    posed = pose(VARIANT, trial.case, trial.field) if len(places) else None
    if posed is None:
        return np.zeros(len(places), np.bool_)
    values = posed[0].values
    low = np.clip(np.floor(places).astype(np.int64), 0, np.array(values.shape) - 2)
    corners = low[:, None] + np.array(list(np.ndindex(2, 2, 2)))
    found = cells(values[tuple(corners.T)].T.reshape(-1, 2, 2, 2), posed[1][0])
    # On the skin of a cell there is no inside of a tunnel.
    inside = (np.abs(places - np.rint(places)) > apart.ROUNDING).all(axis=1)
    return np.asarray(inside & (found.ties == NONE) & (found.tunnels > 0))


def _told(count: int, what: str, where: Floats) -> Finding:
    """The failure, with its first place."""
    return failed(
        f"before its points are moved, {count} {what}, the first at index {place(where)}",
        count=count,
        first=place(where),
        variant=VARIANT,
    )


CLAIMS = (
    Claim(
        id="cells.perfect",
        rule="Before its points are moved from the middle of their lattice edges, the surface is "
        "not degenerate: no triangle is without area, no two points are at one place, and no two "
        "triangles cross or overlap.",
        source="Schlei 2010, sections III.B and IV: VESTA surfaces are perfect, prior to a move",
        level=None,
        judge=on_mesh(perfect),
        kinds=lambda kind: kind == SURFACES,
        families=on_cell_edges,
        variants=(VARIANT,),
        promised=False,
    ),
)
