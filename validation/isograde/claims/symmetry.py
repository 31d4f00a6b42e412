"""Claims that the answer does not depend on how the field is posed (level 2, *consistent*).

What is compared
----------------
The answer to a variant is brought back to the plain field's index coordinates, turned over if the
variant reflects, and laid over the plain answer. The two are the same when

1. the same lattice edges carry vertices, at the same place to within the tolerance, and
2. on every face of every cell the mesh has the same segments.

Numbering, diagonals, inner vertices and inner triangles are not compared: nobody promises them.
Lattice edges and cells with a tied sample are left out, and so are ambiguous faces whose saddle is
on the surface to within rounding. An implementation that declares itself without
"symmetric-choices" (it decides ambiguous faces by where the cell stands or how it is turned) is
compared on the other faces only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from isoref.field import Booleans, Floats, Integers
from isoref.mesh import Mesh

from isograde.claims.evidence import (
    VERDICT_OF,
    failed,
    lattice_of,
    on_triangles,
    passed,
    remembered,
    skipped,
    surface_of,
    traces_of,
)
from isograde.model import Claim, Finding, Judge, Status, Trial, Verdict
from isograde.oracles.bilinear import saddles
from isograde.oracles.halfedges import Surface
from isograde.oracles.lattice import Lattice
from isograde.oracles.traces import Traces, alike, traces
from isograde.variants import SYMMETRIES, VARIANTS, Variant, pose

# A saddle this near the isovalue, relative to the products that decide, may fall either way when
# values are rounded anew.
ROUNDED = 1e-6


def same(*names: str) -> Judge:
    """The judge that passes when each of these variants gives the plain answer."""

    @on_triangles
    def judge(trial: Trial) -> Finding:
        compared = 0
        for name in names:
            finding = _compare(trial, VARIANTS[name])
            if finding is None:
                continue
            if finding.verdict is not Verdict.PASS:
                return finding
            compared += 1
        if not compared:
            return skipped(f"the values do not allow {' or '.join(names)}")
        return passed(variants=compared)

    return judge


def _compare(trial: Trial, variant: Variant) -> Finding | None:
    """Whether the variant's answer is the plain one; None where the case has no such variant."""
    outcome = trial.outcomes.get(variant.name)
    if outcome is None or f"dtype:{variant.name}" in trial.declaration.without:
        return None
    if outcome.status is Status.DECLINED:
        return None
    if outcome.status is not Status.OK:
        detail = f"{variant.name} ({variant.meaning}): {outcome.status} {outcome.detail}"
        return Finding(VERDICT_OF[outcome.status], detail, {"variant": variant.name})
    mesh = outcome.mesh
    if mesh is None or mesh.vertices.shape[1] != 3 or mesh.simplices.shape[1] != 3:
        return failed(
            f"{variant.name}: vertices that are not finite, or faces that are no triangles",
            variant=variant.name,
        )
    difference = _difference(trial, variant, mesh)
    if not difference:
        return passed()
    return failed(f"{variant.name} ({variant.meaning}): {difference}", variant=variant.name)


def _difference(trial: Trial, variant: Variant, mesh: Mesh) -> str:
    """How the variant's answer differs from the plain one; nothing where it does not."""
    lattice = lattice_of(trial)
    other = _brought_back(trial, variant, mesh)
    theirs = traces(lattice, other.points, other.faces, more=True)
    ours = traces_of(trial)
    judged = remembered(trial, "judged faces", lambda: _judged_faces(trial, ours))
    row, other_row, lost = _matched(ours, theirs)
    if lost:
        return f"{lost} cells have triangles in one answer and not in the other"
    changed = np.zeros(judged.shape, bool)
    changed[row] = ~alike(ours, theirs, row, other_row)
    changed &= judged
    if changed.any():
        row, face = np.argwhere(changed)[0]
        return (
            f"{int(changed.sum())} faces of cells are connected otherwise, the first is face "
            f"{int(face)} of the cell at {ours.place[row].tolist()}"
        )
    return _moved(
        remembered(trial, "crossings", lambda: _crossings(trial, surface_of(trial))),
        _crossings(trial, other),
        lattice,
    )


def _matched(ours: Traces, theirs: Traces) -> tuple[Integers, Integers, int]:
    """The rows of the cells that both have, and how many untied cells only one has."""
    _, row, other = np.intersect1d(ours.cell, theirs.cell, assume_unique=True, return_indices=True)
    lost = int((~ours.tied).sum() - (~ours.tied[row]).sum())
    lost += int((~theirs.tied).sum() - (~theirs.tied[other]).sum())
    return row, other, lost


def _brought_back(trial: Trial, variant: Variant, mesh: Mesh) -> Surface:
    """The variant's answer as a surface in the plain field's index coordinates."""
    posed = pose(variant.name, trial.field, trial.case.isovalue)
    assert posed is not None, "a variant that was asked was posed"
    field, isovalue = posed
    # Only the frame of coordinates is wanted of this lattice, so any array of its shape will do.
    frame = Lattice(field, isovalue, np.broadcast_to(np.False_, field.shape))
    places = variant.back(frame.index(mesh.vertices), trial.field)
    faces = mesh.simplices[:, ::-1] if variant.reflects else mesh.simplices
    middle = places[faces].mean(axis=1)
    inside = ((middle >= 0) & (middle <= np.subtract(trial.field.shape, 1))).all(axis=1)
    return Surface.of(places, faces if inside.all() else faces[inside])


def _judged_faces(trial: Trial, ours: Traces) -> Booleans:
    """(n, 6) faces of cells on which two answers must agree."""
    judged = np.repeat(~ours.tied[:, None], 6, axis=1)
    if "symmetric-choices" in trial.declaration.without:
        return np.asarray(judged & ~ours.ambiguous)
    row, face, _, clarity = saddles(lattice_of(trial), ours)
    judged[row, face] &= clarity > ROUNDED
    return judged


@dataclass(frozen=True, eq=False)
class Crossings:
    """The lattice edges that carry vertices, each as three half steps, and where."""

    edge: Integers
    place: Floats


def _crossings(trial: Trial, surface: Surface) -> Crossings:
    """The crossings of a surface, off tied samples, in the order of their edges."""
    lattice = lattice_of(trial)
    places = surface.points[surface.used]
    nearest = np.rint(places)
    gap = np.abs(places - nearest)
    free = gap.argmax(axis=1)
    rows = np.arange(len(places))
    halves = 2 * nearest.astype(np.int64)
    halves[rows, free] = 2 * np.floor(places[rows, free]).astype(np.int64) + 1
    kept = (gap <= lattice.tolerance).sum(axis=1) >= 2
    kept &= ((halves >= 0) & (halves <= 2 * np.subtract(lattice.shape, 1))).all(axis=1)
    kept[kept] = ~_at_tied_edge(lattice, halves[kept])
    number = (halves[kept] @ _strides(lattice)).astype(np.int64)
    edge, first = np.unique(number, return_index=True)
    return Crossings(edge, places[kept][first])


def _strides(lattice: Lattice) -> Integers:
    """What a half step along each axis adds to an edge's number."""
    _, b, c = (2 * n for n in lattice.shape)
    return np.array([b * c, c, 1])


def _at_tied_edge(lattice: Lattice, halves: Integers) -> Booleans:
    """(n,) an end of the lattice edge is a tied sample."""
    if not lattice.tied.any():
        return np.zeros(len(halves), bool)
    low, high = halves // 2, (halves + 1) // 2
    return np.asarray(lattice.tied[tuple(low.T)] | lattice.tied[tuple(high.T)])


def _moved(ours: Crossings, theirs: Crossings, lattice: Lattice) -> str:
    """How the crossings differ; nothing where they do not."""
    if not np.array_equal(ours.edge, theirs.edge):
        lost = np.setxor1d(ours.edge, theirs.edge)
        return f"{len(lost)} lattice edges have a vertex in one answer and not in the other"
    if not len(ours.edge):
        return ""
    distance = np.abs(ours.place - theirs.place).max(axis=1)
    far = int(distance.argmax())
    if distance[far] <= 8 * lattice.tolerance:
        return ""
    return (
        f"the vertex at index {ours.place[far].round(6).tolist()} is {distance[far]:.3g} spacings "
        "away"
    )


def _claim(name: str, rule: str, variants: tuple[str, ...]) -> Claim:
    """A claim of this family: level 2."""
    return Claim(
        id=f"symmetry.{name}",
        rule=rule,
        source="isograde design, level 2: the same answer however the field is presented",
        level=2,
        judge=same(*variants),
        variants=variants,
        unless=frozenset({"on-edges"}),
    )


CLAIMS = (
    _claim(
        "translation",
        "A field inside a larger grid is answered as it is alone: the same vertices on lattice "
        "edges, the same segments on faces of cells.",
        ("translate",),
    ),
    _claim(
        "scaling",
        "Values and isovalue times a positive number give the same vertices on lattice edges and "
        "the same segments on faces of cells.",
        ("scale",),
    ),
    _claim(
        "shift",
        "Values and isovalue plus a number give the same vertices on lattice edges and the same "
        "segments on faces of cells.",
        ("shift",),
    ),
    _claim(
        "orientation",
        "Each of the 48 symmetries of the cube, applied to the field, is applied to the vertices "
        "on lattice edges and to the segments on faces of cells.",
        tuple(variant.name for variant in SYMMETRIES),
    ),
)
