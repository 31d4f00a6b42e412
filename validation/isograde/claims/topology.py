"""Claims on how the mesh hangs together, and on which side of it the samples are (level 1).

Vertices count as one where the implementation says so, by sharing an index. There is one
exception, and it is only for fields with *ties*, samples that stand on the surface to within the
tolerance: an implementation may have one vertex or several there, and leave out the faces without
area between them. Where such a mesh is open as given, vertices at one tied sample, or of exactly
equal coordinates, are welded before it is judged. And as sheets may touch at a tied sample, an
edge or a vertex that is not manifold there is not held against a mesh.
"""

from __future__ import annotations

import numpy as np

from isograde.claims.evidence import (
    failed,
    judged_surface,
    lattice_of,
    off_border,
    off_ties,
    on_triangles,
    passed,
    place,
    steps_of,
    traces_of,
    undecided,
    welded,
)
from isograde.model import Claim, Finding, Judge, Trial
from isograde.oracles.bilinear import saddles
from isograde.oracles.winding import TooWideError

WELDED = frozenset({"welded"})
MANIFOLD = frozenset({"welded", "manifold"})
SEPARATES = frozenset({"separates"})
HATCHER = "A. Hatcher, Algebraic Topology, 2002, chapter 2: a surface has a boundary or it has none"
NIELSON = "Nielson & Hamann 1991, section 1 and Figure 3: the holes of the marching cubes method"


def closed(trial: Trial) -> Finding:
    """Pass when every edge off the border belongs to an even number of faces."""
    surface = judged_surface(trial)
    loose = off_border(trial, surface.open_edges, surface.points)
    if not len(loose):
        return passed(edges=len(surface.edges.ends))
    joined = welded(trial)
    still = len(off_border(trial, joined.open_edges, joined.points))
    advice = "" if still else "; it is closed once equal vertices are welded: share them"
    a, b = surface.points[loose[0]]
    return failed(
        f"{len(loose)} boundary edges inside the volume, the first from index {place(a)} to "
        f"{place(b)}{advice}",
        boundary_edges=len(loose),
        boundary_edges_after_welding=still,
        first=[place(a), place(b)],
    )


def edge_manifold(trial: Trial) -> Finding:
    """Pass when no edge belongs to more than two faces, but between tied samples."""
    surface = judged_surface(trial)
    crowded = surface.crowded_edges
    if len(crowded):
        tied = ~off_ties(trial, surface.points[crowded].reshape(-1, 3)).reshape(-1, 2)
        crowded = crowded[~tied.any(axis=1)]
    if not len(crowded):
        return passed(edges=len(surface.edges.ends))
    a, b = surface.points[crowded[0]]
    return failed(
        f"{len(crowded)} edges belong to more than two faces, the first from index {place(a)} to "
        f"{place(b)}",
        edges=len(crowded),
        first=[place(a), place(b)],
    )


def vertex_manifold(trial: Trial) -> Finding:
    """Pass when the faces round each vertex are one fan, but at tied samples."""
    surface = judged_surface(trial)
    bad = np.flatnonzero(surface.fans > 1)
    if len(bad):
        bad = bad[off_ties(trial, surface.points[bad])]
    if not len(bad):
        return passed(vertices=len(surface.points))
    first = int(bad[0])
    return failed(
        f"{len(bad)} vertices where several sheets meet, the first at index "
        f"{place(surface.points[first])} with {int(surface.fans[first])} fans",
        vertices=len(bad),
        first=place(surface.points[first]),
    )


def oriented(trial: Trial) -> Finding:
    """Pass when the two faces of every edge run along it in opposite directions."""
    surface = judged_surface(trial)
    bad = surface.misdirected_edges
    if not len(bad):
        return passed(edges=len(surface.edges.ends))
    a, b = surface.points[bad[0]]
    return failed(
        f"{len(bad)} edges whose faces turn opposite ways, the first from index {place(a)} to "
        f"{place(b)}",
        edges=len(bad),
        first=[place(a), place(b)],
    )


def separates(trial: Trial) -> Finding:
    """Pass when the winding number changes between two samples exactly where they differ."""
    try:
        steps = steps_of(trial)
    except TooWideError as error:
        return failed(str(error))
    bad = np.flatnonzero(steps.unseparated)
    if not len(bad):
        return passed(crossed=len(steps.axis))
    first = int(bad[0])
    start = [int(i) for i in steps.sample[first]]
    side = "the same side" if not steps.wanted[first] else "different sides"
    return failed(
        f"{len(bad)} steps between samples; from sample {start} along axis "
        f"{int(steps.axis[first])} the samples are on {side}, and the mesh is crossed "
        f"{int(steps.found[first]):+d} times",
        steps=len(bad),
        sample=start,
        axis=int(steps.axis[first]),
        crossings=int(steps.found[first]),
        wanted=int(steps.wanted[first]),
    )


def facing(trial: Trial) -> Finding:
    """Pass when the normal points the declared way wherever the mesh separates two samples."""
    try:
        steps = steps_of(trial)
    except TooWideError as error:
        return failed(str(error))
    bad = np.flatnonzero(steps.reversed)
    if not len(bad):
        return passed(crossed=len(steps.axis))
    first = int(bad[0])
    start = [int(i) for i in steps.sample[first]]
    declared = trial.declaration.conventions.normals
    return failed(
        f"on {len(bad)} of {len(steps.axis)} crossings, the first after sample {start} along axis "
        f"{int(steps.axis[first])}, the right-hand normal is against the declared {declared!r}",
        reversed=len(bad),
        crossings=len(steps.axis),
        sample=start,
    )


def bilinear(trial: Trial) -> Finding:
    """Pass when every ambiguous face is connected as the bilinear interpolant connects it.

    A face whose saddle is exactly on the surface may be either way, and cells with a tied corner
    are not judged.
    """
    traces, lattice = traces_of(trial), lattice_of(trial)
    row, face, sign, _ = saddles(lattice, traces)
    judged = ~traces.tied[row] & ~traces.undecided[row, face]
    row, face, sign = row[judged], face[judged], sign[judged]
    separated, joined = traces.separated[row, face], traces.joined[row, face]
    bad = np.flatnonzero(np.where(sign > 0, ~joined, np.where(sign < 0, ~separated, False)))
    counts = {
        "faces": len(row),
        "joined": int(joined.sum()),
        "separated": int(separated.sum()),
        "degenerate": int((sign == 0).sum()),
    }
    if not len(bad):
        return undecided(trial, np.asarray(traces.undecided.any(axis=1))) or passed(**counts)
    n = int(bad[0])
    cell, f = traces.place[row[n]].tolist(), int(face[n])
    return failed(
        f"{len(bad)} of {len(row)} ambiguous faces; on the {'low' if f % 2 == 0 else 'high'} face "
        f"of axis {f // 2} of the cell at {cell} the bilinear interpolant "
        f"{'joins' if sign[n] > 0 else 'separates'} the inside corners",
        wrong=len(bad),
        cell=cell,
        face=f,
        **counts,
    )


def _claim(
    name: str, rule: str, source: str, judge: Judge, unless: frozenset[str] = WELDED
) -> Claim:
    """A claim of this family: level 1, vertices as given."""
    return Claim(
        id=f"topology.{name}",
        rule=rule,
        source=source,
        level=1,
        judge=on_triangles(judge),
        unless=unless,
    )


CLAIMS = (
    _claim(
        "closed",
        "The mesh has no boundary but on the border of the volume: every other edge belongs to an "
        "even number of faces.",
        NIELSON,
        closed,
        unless=WELDED | {"closed"},
    ),
    _claim(
        "edge_manifold",
        "No edge belongs to more than two faces.",
        HATCHER,
        edge_manifold,
        unless=MANIFOLD,
    ),
    _claim(
        "vertex_manifold",
        "The faces round every vertex are one fan: no two sheets meet in a point.",
        HATCHER,
        vertex_manifold,
        unless=MANIFOLD,
    ),
    _claim(
        "oriented",
        "The faces of every edge run along it in opposite directions.",
        HATCHER,
        oriented,
    ),
    _claim(
        "separates",
        "The winding number of the mesh changes by one between neighbouring samples on different "
        "sides and not at all between others; samples the mesh touches are bridged.",
        "Lorensen & Cline 1987: the surface separates samples above from samples below",
        separates,
        unless=SEPARATES,
    ),
    _claim(
        "facing",
        "Right-hand normals point the declared way wherever the mesh passes between two samples.",
        "isograde design: from inside to outside, from high to low, unless declared",
        facing,
        unless=SEPARATES,
    ),
    Claim(
        id="topology.bilinear",
        rule="On every ambiguous face the mesh connects what the bilinear interpolant connects.",
        source="Nielson & Hamann 1991, section 2: the asymptotic decider",
        level=3,
        judge=on_triangles(bilinear),
        unless=frozenset({"on-edges", "welded"}),
    ),
)
