"""Claims on how the mesh hangs together, and on which side of it the samples are.

They are said of every (n, m): contours, surfaces, curves in which surfaces meet, simplices of any
dimension. A *facet* is an end of a segment, an edge of a triangle, and so on. How vertices count as
one, and what is excused at ties, is said in `isograde.claims.evidence`; what an open end of the
domain is, in `isograde.declaration`. As sheets may touch at a tied sample, a facet or a vertex that
is not manifold there is not held against a mesh.
"""

from __future__ import annotations

import numpy as np
from isoref.field import Booleans, Floats, Integers

from isograde.claims.evidence import (
    complex_of,
    failed,
    judged_complex,
    lattice_of,
    meetings_of,
    off_border,
    off_ties,
    on_mesh,
    passed,
    place,
    skipped,
    welded_at_ties,
)
from isograde.declaration import Declaration
from isograde.model import Claim, Finding, Judge, Kind, Trial
from isograde.oracles.complexes import EXACT, Complex
from isograde.oracles.degree import TooWideError
from isograde.oracles.lattice import Lattice, components

HATCHER = (
    "A. Hatcher, Algebraic Topology, 2002, chapter 2: a manifold has a boundary or it has none"
)
NIELSON = "Nielson & Hamann 1991, section 1 and Figure 3: the holes of the marching cubes method"
MILNOR = (
    "J. Milnor, Topology from the differentiable viewpoint, 1965: degree and intersection number"
)


def has_facets(kind: Kind) -> bool:
    """Points have no facets; simplices of every higher dimension do."""
    return kind.k >= 1


def facet(kind: Kind) -> str:
    """What a facet is called: an end, an edge, or a facet."""
    return {1: "end", 2: "edge"}.get(kind.k, "facet")


def where(found: Complex, row: Integers) -> str:
    """Where a facet is, by the places of its vertices."""
    return " to ".join(str(place(point)) for point in found.points[row])


def closed(trial: Trial) -> Finding:
    """Pass when every facet off the open ends belongs to an even number of simplices."""
    found = judged_complex(trial)
    if not len(found.facets.rows):
        return skipped("there is no simplex")
    loose = _unmatched(trial, off_border(trial, found.open_facets, found.points), found)
    if not len(loose):
        return passed(facets=len(found.facets.rows))
    advice, still = _if_welded(trial)
    beyond = _beyond_one_end(lattice_of(trial), found.points[loose])
    told = "beyond the end of" if beyond else "inside"
    alone = set(map(tuple, found.facets.rows[found.facets.uses == 1].tolist()))
    single = all(tuple(row) in alone for row in loose.tolist())
    many = "one simplex only" if single else "an odd number of simplices"
    return failed(
        f"{len(loose)} {facet(trial.kind)}s {told} the domain belong to {many}, the first at index "
        f"{where(found, loose[0])}{advice}",
        boundary_facets=len(loose),
        **({"beyond": True} if beyond else {}),
        boundary_facets_after_welding=still,
        first=[place(point) for point in found.points[loose[0]]],
        alone=len(np.unique(trial.mesh.simplices)) == trial.mesh.simplices.size,
        **_planes(found.points[loose], lattice_of(trial).tolerance),
    )


def _beyond_one_end(lattice: Lattice, places: Floats) -> bool:
    """Every facet (r, k, n) lies beyond an end of the domain: the surface stops, but too late."""
    low = (places < lattice.first - lattice.tolerance).all(axis=1)
    high = (places > lattice.last + lattice.tolerance).all(axis=1)
    return bool(np.concatenate([low, high], axis=1).any(axis=1).all())


def _planes(places: Floats, tolerance: float) -> dict[str, object]:
    """The axis along which all facets (r, k, n) lie in planes of samples, and which; if one is."""
    whole = np.rint(places)
    flat = (np.abs(places - whole) <= tolerance) & (whole == whole[:, :1])
    axes = np.flatnonzero(flat.all(axis=(0, 1)))
    if len(axes) != 1:
        return {}
    at = np.unique(whole[:, 0, axes[0]]).astype(int).tolist()
    return {"planes": {"axis": int(axes[0]), "at": at}}


def _unmatched(trial: Trial, rows: Integers, found: Complex) -> Integers:
    """The open facets that have no partner one period away along a periodic axis."""
    lattice = lattice_of(trial)
    for axis, end in enumerate(lattice.ends):
        if end.end != "periodic" or not len(rows):
            continue
        places = found.points[rows]
        sides = []
        for plane in (lattice.first[axis], lattice.last[axis]):
            at = np.flatnonzero(
                (np.abs(places[..., axis] - plane) <= lattice.tolerance).all(axis=1)
            )
            around = np.delete(places[at], axis, axis=2).round(5)
            keys = [tuple(sorted(map(tuple, row))) for row in around.tolist()]
            sides.append(dict(zip(keys, at.tolist(), strict=True)))
        paired = [side[key] for key in sides[0].keys() & sides[1].keys() for side in sides]
        rows = np.delete(rows, paired, axis=0)
        # At a tie, what meets at the seam need not be the same on either side.
        if lattice.tied.any() and len(rows):
            rows = rows[~_in_seam_at_tie(lattice, found.points[rows], axis)]
    return rows


def _in_seam_at_tie(lattice: Lattice, places: Floats, axis: int) -> Booleans:
    """(r,) facets (r, k, n) in the seam of a periodic axis, with a vertex beside a tied sample."""
    planes = np.array([lattice.first[axis], lattice.last[axis]])
    near = np.abs(places[..., axis, None] - planes) <= lattice.tolerance
    tied = lattice.beside_tie(places.reshape(-1, lattice.n)).reshape(places.shape[:2]).any(axis=1)
    return np.asarray(near.all(axis=1).any(axis=1) & tied)


def _if_welded(trial: Trial) -> tuple[str, int]:
    """What welding equal vertices, or nearly equal ones, would mend; facets open even then."""
    found = complex_of(trial)
    welded = found.welded()
    still = len(off_border(trial, welded.open_facets, welded.points))
    if not still:
        return "; it is closed once equal vertices are welded: share them", 0
    from isograde.claims.evidence import clusters

    near = found.renamed(clusters(found.points, NEARLY))
    if not len(off_border(trial, near.open_facets, near.points)):
        told = (
            f"; it is closed at {NEARLY:g} of a cell: the interpolation along an edge depends on "
        )
        return told + "the direction in which the edge is walked", still
    return "", still


# Vertices of a soup that were interpolated from either end of an edge are this near, in cells.
NEARLY = 1e-5


def oriented(trial: Trial) -> Finding:
    """Pass when the simplices of every facet give it opposite orientations.

    A net has an edge of four quads between cells that share an ambiguous face. On the open end of
    its domain two of the four may be missing, and the two that are there turn alike.
    """
    if trial.declaration.conventions.normals == "none":
        return skipped("it declares that its simplices are not oriented")
    found = judged_complex(trial)
    even = found.facets.uses % 2 == 0
    if not even.any():
        return skipped("no two simplices share a facet")
    bad = found.misdirected_facets
    if trial.declaration.vertices == "cells":
        bad = off_border(trial, bad, found.points)
    if len(bad):
        bad = bad[
            off_ties(trial, found.points[bad].reshape(-1, trial.kind.n))
            .reshape(len(bad), -1)
            .any(axis=1)
        ]
    if not len(bad):
        return passed(facets=int(even.sum()))
    return failed(
        f"{len(bad)} {facet(trial.kind)}s whose simplices turn opposite ways, the first at index "
        f"{where(found, bad[0])}",
        facets=len(bad),
        first=[place(point) for point in found.points[bad[0]]],
    )


def _own_ties(trial: Trial) -> bool:
    """Whether samples on an implementation's own lattice may equal the isovalue.

    They may where ours do; and where the isovalue is the middle of two of ours, as in a field of
    booleans, since its own samples may lie in the middle between ours.
    """
    if trial.declaration.vertices != "own":
        return False
    if lattice_of(trial).tied.any():
        return True
    components = trial.field.values.reshape(trial.kind.m, -1)
    for samples, isovalue in zip(components, trial.case.isovalues, strict=True):
        values = np.unique(samples).astype(np.float64)
        if np.isin(2 * isovalue - values, values).any():
            return True
    return False


def manifold(trial: Trial) -> Finding:
    """Pass when no facet has more than two simplices and every vertex's link is as it must be."""
    found = judged_complex(trial)
    if not len(found.simplices):
        return skipped("there is no simplex")
    crowded = found.crowded_facets
    if len(crowded):
        free = off_ties(trial, found.points[crowded].reshape(-1, trial.kind.n))
        crowded = crowded[free.reshape(len(crowded), -1).all(axis=1)]
    declared = trial.declaration
    unknown = "samples of its own lattice, unknown here, may be tied"
    own_ties = _own_ties(trial)
    if len(crowded) and own_ties and declared.soup is not None:
        return skipped(f"{unknown}, and what is at one place is one")
    if len(crowded):
        return failed(
            f"{len(crowded)} {facet(trial.kind)}s belong to more than two simplices, the first at "
            f"index {where(found, crowded[0])}",
            facets=len(crowded),
            first=[place(point) for point in found.points[crowded[0]]],
        )
    bad = found.singular_vertices
    if len(bad) and own_ties:
        return skipped(unknown)
    bad = bad[off_ties(trial, found.points[bad])] if len(bad) else bad
    if len(bad):
        return failed(
            f"{len(bad)} vertices where several sheets meet, the first at index "
            f"{place(found.points[bad[0]])}",
            vertices=len(bad),
            first=place(found.points[bad[0]]),
        )
    exact = {} if trial.kind.k <= EXACT else {"links": "Euler characteristics only"}
    return passed(facets=len(found.facets.rows), vertices=int(found.used.sum()), **exact)


def sides(trial: Trial) -> Finding:
    """Pass when the mesh meets every face of the lattice as often, with sign, as its samples say.

    Points have no orientation of their own: there the numbers agree modulo two, and there are at
    least as many as the degree says.
    """
    lattice, kind = lattice_of(trial), trial.kind
    if kind.m > 2 and trial.declaration.interpolant != "tetrahedra":
        return skipped("the samples alone do not fix the degree on faces of dimension 3 and more")
    # Vertices in cells make a surface in a single layer of cells, whose middles have no extent.
    least = 1 if trial.declaration.vertices == "edges" else 0
    if min(lattice.shape) < 2 or (lattice.last - lattice.first < least).any():
        return _without_cells(trial)
    try:
        met = meetings_of(trial)
    except TooWideError as error:
        return failed(str(error))
    if not len(met.found):
        return skipped("no judged face of the lattice is met, or should be")
    signed = trial.declaration.conventions.normals != "none" and kind.k > 0
    wrong = met.wrong(signed=signed)
    if kind.k == 0:
        wrong = (np.abs(met.found) < np.abs(met.wanted)) | ((met.found - met.wanted) % 2 != 0)
    bad = np.flatnonzero(wrong)
    if not len(bad):
        return passed(faces=len(met.found), met=int(np.abs(met.wanted).sum()))
    first = int(bad[0])
    corner, axes = met.corner[first].tolist(), met.axes[first].tolist()
    reverse = int(met.reversed.sum())
    told = (
        f"; on {reverse} of them it is met the right number of times with normals the other way"
        if reverse
        else ""
    )
    what, along = ("step", "axis") if kind.m == 1 else ("face", "axes")
    wanted, found = int(met.wanted[first]), int(met.found[first])
    return failed(
        f"{len(bad)} of {len(met.found)} {what}s of the lattice; on that from sample {corner} "
        f"along {along} {', '.join(map(str, axes))} the samples ask for {wanted:+d}, and the mesh "
        f"meets it {found:+d} times{told}",
        faces=len(bad),
        judged=len(met.found),
        reversed=reverse,
        sample=corner,
        axes=axes,
        found=found,
        wanted=wanted,
        inside=[bool(side[tuple(corner)]) for side in lattice.sides],
    )


def _without_cells(trial: Trial) -> Finding:
    """Pass when nothing came for a domain that is one sample thick, unless it goes on beyond."""
    lattice = lattice_of(trial)
    if any(end.end != "open" or end.inset < 0 for end in lattice.ends):
        return skipped("the domain is one sample thick, and the surface goes on beyond it")
    if trial.declaration.vertices != "edges" and min(lattice.shape) > 1:
        return skipped("the ends leave no cell, and such vertices may stand beyond the ends")
    count = len(complex_of(trial).simplices)
    if not count:
        return passed(faces=0)
    return failed(f"{count} simplices where the domain is one sample thick and has no cells")


def ties(trial: Trial) -> Finding:
    """Pass when, equal vertices welded, the boundary of the oriented mesh cancels off the ends."""
    if not lattice_of(trial).tied.any():
        return skipped("no sample is tied")
    found = complex_of(trial)
    if not len(found.simplices):
        return skipped("there is no simplex")
    for tried in (found, welded_at_ties(trial), found.welded()):
        loose = off_border(trial, tried.unbalanced_facets, tried.points)
        loose = _unmatched(trial, loose, tried)
        if not len(loose):
            return passed(facets=len(tried.facets.rows))
    return failed(
        f"{len(loose)} {facet(trial.kind)}s inside the domain are not cancelled, even with equal "
        "vertices welded",
        facets=len(loose),
    )


def raw(trial: Trial) -> Finding:
    """Pass when, on a field with ties, the mesh as given is closed and manifold."""
    if not lattice_of(trial).tied.any():
        return skipped("no sample is tied")
    found = complex_of(trial)
    if not len(found.simplices):
        return skipped("there is no simplex")
    name = facet(trial.kind)
    counts = {
        f"{name}s of one simplex": len(off_border(trial, found.open_facets, found.points)),
        f"{name}s of more than two": len(found.crowded_facets),
        "vertices where sheets meet": len(found.singular_vertices),
    }
    told = [f"{count} {what}" for what, count in counts.items() if count]
    if not told:
        return passed(facets=len(found.facets.rows))
    return failed(f"as it came, with nothing excused at ties: {', '.join(told)}", **counts)


def tie_side(trial: Trial) -> Finding:
    """Pass when a block of tied samples is a body, or is none, as the declared side has it.

    Only a block tells: at fewer tied samples the surface may have no area, and an implementation
    may leave simplices without area out.
    """
    lattice = lattice_of(trial)
    if any(end.end != "open" or not 0 <= end.inset < 1 for end in lattice.ends):
        return skipped("the surface goes on beyond the samples, or ends far inside them")
    values = components(lattice.field)[0]
    tied = values == lattice.isovalue
    windows = np.lib.stride_tricks.sliding_window_view(tied, (2,) * lattice.n)
    if min(lattice.shape) < 2 or not windows.all(axis=tuple(range(-lattice.n, 0))).any():
        return skipped("there is no block of tied samples")
    above, below = bool((values > lattice.isovalue).any()), bool((values < lattice.isovalue).any())
    if above == below:
        return skipped("the side of the tied samples does not decide whether there is a surface")
    said = trial.declaration.conventions.tie
    wanted = below if said == "inside" else above
    measure = complex_of(trial).measure
    if (measure > lattice.tolerance) == wanted:
        return passed(measure=measure)
    other = "outside" if said == "inside" else "inside"
    found = "there is no surface round" if wanted else "there is a surface round"
    return failed(
        f"{found} a block of samples on the isovalue, as if they counted as {other}, and {said} is "
        f'declared: declare {{"conventions": {{"tie": "{other}"}}}} if that is meant',
        measure=measure,
    )


def sees_ties(declaration: Declaration) -> bool:
    """It interpolates between the field's own samples."""
    return declaration.interpolant != "labels" and declaration.vertices != "own"


def _claim(name: str, rule: str, source: str, level: int | None, judge: Judge) -> Claim:
    """A claim of this family, on all kinds that have facets."""
    return Claim(
        id=f"topology.{name}",
        rule=rule,
        source=source,
        level=level,
        judge=on_mesh(judge),
        kinds=has_facets,
    )


CLAIMS = (
    _claim(
        "closed",
        "The mesh has no boundary but at the open ends of its domain: every other facet belongs to "
        "an even number of simplices.",
        NIELSON,
        1,
        closed,
    ),
    _claim(
        "oriented",
        "The simplices of every facet give it opposite orientations.",
        HATCHER,
        1,
        oriented,
    ),
    Claim(
        id="topology.sides",
        rule="The mesh meets every face of the lattice of dimension m as often, with sign, as the "
        "samples on its boundary say: it passes between samples on different sides, nowhere else, "
        "and its normals point the declared way.",
        source=f"Lorensen & Cline 1987: the surface separates samples above from below; {MILNOR}",
        level=1,
        judge=on_mesh(sides),
    ),
    _claim(
        "manifold",
        "No facet belongs to more than two simplices, and no two sheets meet in a vertex.",
        HATCHER,
        2,
        manifold,
    ),
    _claim(
        "ties",
        "On a field with ties the mesh, its equal vertices welded, has no boundary inside the "
        "domain.",
        "isograde design: fields in general position and fields with ties are told apart",
        None,
        ties,
    ),
    Claim(
        id="topology.raw",
        rule="On a field with ties too the mesh is closed and manifold as it comes, with nothing "
        "welded and nothing excused.",
        source="isograde design: fields in general position and fields with ties are told apart",
        level=None,
        judge=on_mesh(raw),
        kinds=has_facets,
        promised=False,
    ),
    Claim(
        id="topology.tie_side",
        rule="A block of samples on the isovalue counts as inside, or as outside, as is declared.",
        source="isograde design: conventions are declared, and what was declared is verified",
        level=None,
        judge=on_mesh(tie_side),
        kinds=lambda kind: kind.m == 1 and has_facets(kind),
        families=sees_ties,
        tags=frozenset({"ties"}),
    ),
)
