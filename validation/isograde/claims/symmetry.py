"""Claims that the answer does not depend on how the field is posed (level 2, *consistent*).

What is compared
----------------
The answer to a variant is brought back to the plain field's index coordinates, turned over if the
variant reflects, and laid over the plain answer. What must agree depends on what was changed and on
the family (`isograde.declaration`):

scale, shift, layout, type    the arrays; else the oriented simplices as a multiset, up to rounding
translation                   the oriented simplices one cell off the border; of a split, where it
                              is moved by its own period
symmetry, spacing and directions
    vertices on edges         the same lattice edges carry vertices, at the same place, and on every
                              face of every cell the mesh has the same segments; in every cell it
                              has as many sheets, of the same Euler characteristic
    vertices in cells         the same vertices, and the same edges between cells that share a face
    a split                   the same vertices on its edges, the same number of pieces and Euler
                              characteristic, under the split's own symmetries
    contours                  the same of the squares of the plane
    other dimensions          the same points in which the mesh meets the lattice's faces of
                              dimension m; where they settle the rest, the same number of pieces
                              and Euler characteristic
    a lattice of its own      is judged on known bodies only

Numbering, diagonals and inner triangles are never compared under a symmetry: nobody promises them.
Tied samples and what is beside them are left out, and so are ambiguous faces whose saddle is on the
surface to within rounding.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import combinations, product
from math import prod

import numpy as np
from isoref.field import Booleans, Field, Floats, Integers
from isoref.mesh import Mesh

from isograde import variants
from isograde.claims.evidence import (
    VERDICT_OF,
    complex_of,
    failed,
    given_samples,
    lattice_of,
    meetings_of,
    on_mesh,
    passed,
    place,
    placed,
    remembered,
    skipped,
    traces_of,
)
from isograde.declaration import Declaration, Split
from isograde.model import (
    CONTOURS,
    SURFACES,
    Claim,
    Finding,
    Judge,
    Kind,
    Outcome,
    Status,
    Trial,
    Verdict,
    every_family,
    every_kind,
)
from isograde.oracles import overlay
from isograde.oracles.bilinear import saddles
from isograde.oracles.complexes import Complex
from isograde.oracles.degree import crossings, meetings
from isograde.oracles.lattice import Lattice
from isograde.oracles.squares import squares
from isograde.oracles.traces import Traces, alike, traces

# A saddle this near the isovalue, relative to the products that decide, may fall either way when
# values are rounded anew.
ROUNDED = 1e-6
# Places are the same within so many tolerances of the lattice, and areas within so many.
NEAR = 8
ROUGH = 100
NO_MESH = "what came is no mesh of this kind"
DESIGN = "isograde design, level 2: the same answer however the field is posed"

Difference = Callable[[Trial, Complex, variants.Variant], str]


def same(difference: Difference, *asked: str) -> Judge:
    """The judge that passes when each of these variants gives the plain answer."""

    @on_mesh
    def judge(trial: Trial) -> Finding:
        """Pass when each of these ways to pose the field gives the plain answer."""
        same_ones, empty = 0, not len(complex_of(trial).simplices)
        for name in variants.named(asked, trial.kind):
            if name not in trial.outcomes or not _posed_alike(trial, name):
                continue
            outcome = trial.outcomes[name]
            if outcome.status is Status.DECLINED:
                continue
            finding = compared(trial, outcome, variants.variant(name, trial.kind), difference)
            if finding.verdict is not Verdict.PASS:
                return finding
            same_ones += 1
        if not same_ones:
            return skipped(f"neither values nor limits allow {' or '.join(asked)}")
        return skipped("both answers are empty") if empty else passed(variants=same_ones)

    return judge


def compared(
    trial: Trial, outcome: Outcome, variant: variants.Variant, difference: Difference
) -> Finding:
    """Whether the variant's answer is the plain one."""
    said = f"{variant.name} ({variant.meaning})"
    if outcome.status is not Status.OK:
        detail = f"{said}: {outcome.status} {outcome.detail}"
        return Finding(VERDICT_OF[outcome.status], detail, {"variant": variant.name})
    mesh = outcome.mesh_of(trial.kind)
    if mesh is None:
        return failed(f"{said}: {NO_MESH}", variant=variant.name)
    told = difference(trial, brought_back(trial, variant, mesh), variant)
    return failed(f"{said}: {told}", variant=variant.name) if told else passed()


def brought_back(trial: Trial, variant: variants.Variant, mesh: Mesh) -> Complex:
    """The variant's answer in the plain field's index coordinates, turned over if it reflects."""
    posed = variant.pose(trial.field, trial.isovalues)
    assert posed is not None, "a variant that was asked was posed"
    field, _ = posed
    frame = _frame(trial, field, _turned(trial.declaration, variant, field.dimension))
    rows = mesh.simplices
    if variant.reflects and rows.shape[1] > 1:
        rows = rows[:, [*range(rows.shape[1] - 2), -1, -2]]
    places = variant.back(frame.index(mesh.vertices), trial.field)
    whole = lattice_of(trial)
    if field.shape == trial.field.shape or variant.name.startswith("symmetry/"):
        places, rows = _within_a_period(whole, places, rows)
    return placed(trial, Mesh(whole.field.position(places), rows))


def _frame(trial: Trial, field: Field, declared: Declaration) -> Lattice:
    """The frame of index coordinates of a field, which is that of many variants of the trial's."""
    # Only the frame is wanted of this lattice, so any sides of its shape will do.
    nothing = np.broadcast_to(np.False_, (1, *field.shape))
    placed_so = (field.shape, field.spacing, field.origin, field.directions, declared.domain)
    compute = partial(Lattice, field, trial.isovalues, nothing, declared)
    return remembered(trial, f"frame {placed_so}", compute)


def _within_a_period(lattice: Lattice, places: Floats, rows: Integers) -> tuple[Floats, Integers]:
    """The simplices moved by whole periods into the period that begins at the first sample.

    Vertices are repeated where simplices at them move differently.
    """
    for axis, end in enumerate(lattice.ends):
        if end.end != "periodic" or not len(rows):
            continue
        period = lattice.shape[axis]
        low = np.floor(places[rows][:, :, axis].min(axis=1) + lattice.tolerance)
        moved = -np.floor(low / period).astype(np.int64)
        span = int(moved.max() - moved.min()) + 1
        key = rows * span + (moved - moved.min())[:, None]
        names, flat = np.unique(key, return_inverse=True)
        places = places[names // span].copy()
        places[:, axis] += (names % span + moved.min()) * period
        rows = flat.reshape(rows.shape)
    return places, rows


def _turned(declared: Declaration, variant: variants.Variant, n: int) -> Declaration:
    """The declaration with its ends in the order of the variant's axes."""
    if not variant.name.startswith("symmetry/") or len(declared.domain) == 1:
        return declared
    order, _ = variants.symmetry_of(variant.name)
    ends = declared.ends(n)
    return replace(declared, domain=tuple(ends[axis] for axis in order))


# --- the same simplices --------------------------------------------------------------------------


def same_simplices(trial: Trial, other: Complex, variant: variants.Variant) -> str:
    """How the oriented simplices differ, up to rounding; nothing where they do not."""
    ours, lattice = complex_of(trial), lattice_of(trial)
    if np.array_equal(ours.points, other.points) and np.array_equal(
        ours.simplices, other.simplices
    ):
        return ""
    if "translate" in variant.name:
        ours, other = (_off_the_border(lattice, mesh) for mesh in (ours, other))
    mine, theirs = overlay.unmatched(ours, other, NEAR * lattice.tolerance)
    mine, theirs = (_clear(trial, mesh, rows) for mesh, rows in ((ours, mine), (other, theirs)))
    if not len(mine) and not len(theirs):
        return ""
    mesh, rows = (ours, mine) if len(mine) else (other, theirs)
    middle = mesh.points[mesh.simplices[rows[0]]].mean(axis=0)
    return (
        f"{len(mine)} simplices of the plain answer are not in this one, and {len(theirs)} of this "
        f"one not in the plain answer; one is at index {place(middle)}"
    )


def _off_the_border(lattice: Lattice, mesh: Complex) -> Complex:
    """The simplices that lie one cell off the border of the samples."""
    where = mesh.points[mesh.simplices]
    last = np.subtract(lattice.shape, 2.0)
    slack = lattice.tolerance
    within = ((where >= 1 - slack) & (where <= last + slack)).all(axis=(1, 2))
    # Flat ones in the outermost planes belong to cells on either side.
    low, high = (np.all(np.abs(where - plane) <= slack, axis=1) for plane in (1, last))
    return Complex(mesh.points, mesh.simplices[within & ~np.any(low | high, axis=1)])


def _clear(trial: Trial, mesh: Complex, rows: Integers) -> Integers:
    """Those of the simplices that are not beside a tied sample or an unclear face."""
    if not len(rows):
        return rows
    lattice = lattice_of(trial)
    middles = mesh.points[mesh.simplices[rows]].mean(axis=1)
    unclear = lattice.beside_tie(middles)
    if trial.kind == SURFACES:
        unclear |= np.isin(_cells(lattice, middles), _unclear_cells(trial))
    return rows[~unclear]


def _cells(lattice: Lattice, places: Floats) -> Integers:
    """(r,) flat index of the sample at the lowest corner of each place's cell."""
    last = np.maximum(np.subtract(lattice.shape, 2), 0)
    corner = np.clip(np.floor(places).astype(np.int64), 0, last)
    return np.asarray(np.ravel_multi_index(tuple(corner.T), lattice.shape))


def _unclear_cells(trial: Trial) -> Integers:
    """Cells with an ambiguous face whose decision hangs on rounding."""

    def compute() -> Integers:
        found = traces_of(trial)
        row, _, _, clarity = saddles(lattice_of(trial), found)
        corner = found.place[row[clarity <= ROUNDED]]
        return np.unique(np.ravel_multi_index(tuple(corner.T), lattice_of(trial).shape))

    return remembered(trial, "unclear cells", compute)


# --- the same but for diagonals ------------------------------------------------------------------


def same_in_the_world(trial: Trial, other: Complex, variant: variants.Variant) -> str:
    """How it differs where the axes run elsewhere in the world, its orientation included."""
    if told := same_shape(trial, other, variant):
        return told
    if trial.declaration.conventions.normals == "none" or trial.kind.k == 0 or trial.kind.m > 2:
        return ""
    lattice = lattice_of(trial)
    if min(lattice.shape) < 2 or meetings_of(trial).wrong().any():
        return ""
    reversed_ = int(meetings(lattice, other.points, other.simplices).reversed.sum())
    if not reversed_:
        return ""
    return f"{reversed_} faces of the lattice are met the right number of times, the other way"


def same_shape(trial: Trial, other: Complex, variant: variants.Variant) -> str:
    """How what the family must agree on under a symmetry differs; nothing where it does not."""
    if trial.declaration.vertices == "cells":
        return _same_cells(trial, other)
    if trial.declaration.interpolant == "tetrahedra" and trial.kind.m == 1:
        return _same_crossings_of_split(trial, other)
    if trial.kind == SURFACES:
        return _same_traces(trial, other)
    if trial.kind == CONTOURS:
        return _same_squares(trial, other)
    return _same_meetings(trial, other)


def _same_traces(trial: Trial, other: Complex) -> str:
    """How vertices on lattice edges, or segments on faces of cells, differ."""
    lattice = lattice_of(trial)
    theirs, ours = traces(lattice, other.points, other.simplices, more=True), traces_of(trial)
    judged = remembered(trial, "judged faces", lambda: _judged_faces(trial, ours))
    row, other_row, lost = _matched(ours, theirs)
    if lost:
        return f"{lost} cells have triangles in one answer and not in the other"
    changed = np.zeros(judged.shape, bool)
    changed[row] = ~alike(ours, theirs, row, other_row)
    changed &= judged
    if changed.any():
        first, face = np.argwhere(changed)[0]
        return (
            f"{int(changed.sum())} faces of cells are connected otherwise, the first is face "
            f"{int(face)} of the cell at {ours.place[first].tolist()}"
        )
    mine = complex_of(trial)
    own = remembered(trial, "on edges", lambda: _on_edges(lattice, mine))
    if told := _moved(lattice, own, _on_edges(lattice, other)):
        return told
    # Go on inside the cells whose faces are all judged, and bear no flat triangle.
    settled = remembered(trial, "settled", lambda: judged.all(axis=1) & ~_under_flat(ours))[row]
    if len(theirs.lying):
        settled = settled & ~_under_flat(theirs)[other_row]
    sides = (ours, row[settled]), (theirs, other_row[settled])
    if told := _hanging_otherwise(*sides):
        return told
    # Slivers at a tie are in one cell or in the next.
    if lattice.tied.any():
        return ""
    areas = remembered(trial, "areas", lambda: _areas(lattice, mine)), _areas(lattice, other)
    return _turned_over(lattice, ours, row[settled], areas)


def _under_flat(found: Traces) -> Booleans:
    """(n,) cells that a triangle lies flat on a face of."""
    under = np.zeros(len(found.cell), bool)
    rows = np.concatenate([found.lying.below, found.lying.above])
    under[rows[rows >= 0]] = True
    return under


def _hanging_otherwise(ours: tuple[Traces, Integers], theirs: tuple[Traces, Integers]) -> str:
    """How what is inside the cells hangs together, whose curves on their faces are the same.

    How triangles are cut is free; their number gives the Euler characteristic away.
    """
    (mine, row), (others, other_row) = ours, theirs
    changed = mine.excess[row] != others.excess[other_row]
    if not changed.any():
        return ""
    first = mine.place[row[changed][0]].tolist()
    count = int(changed.sum())
    if count == 1:
        return f"the cell at {first} hangs together otherwise"
    return f"{count} cells hang together otherwise, the first is that at {first}"


def _turned_over(
    lattice: Lattice, mine: Traces, row: Integers, areas: tuple[Floats, Floats]
) -> str:
    """Which cells have triangles turned over: two surfaces with the same curves, of these areas.

    The sum of their areas as vectors is that of any surface with the same curves, if all are
    turned alike.
    """
    cell = np.ravel_multi_index(tuple(mine.place[row].T), lattice.shape)
    gap = np.abs(areas[0][cell] - areas[1][cell])
    turned = (gap > ROUGH * lattice.tolerance).any(axis=1)
    if not turned.any():
        return ""
    first = mine.place[row[turned][0]].tolist()
    return f"{int(turned.sum())} cells have triangles turned over, the first is that at {first}"


def _areas(lattice: Lattice, mesh: Complex) -> Floats:
    """(N, 3) the sum of the areas, as vectors, of the triangles of each cell."""
    size = prod(lattice.shape)
    cell = _cells(lattice, mesh.points[mesh.simplices].mean(axis=1))
    return np.stack([np.bincount(cell, part, size) for part in (mesh.normals / 2).T], axis=1)


def _same_squares(trial: Trial, other: Complex) -> str:
    """How vertices on lattice edges, or what is joined in the squares of a plane, differs."""
    lattice, mine = lattice_of(trial), complex_of(trial)
    ours, theirs = (squares(lattice, one.points, one.simplices) for one in (mine, other))
    number, other_number = (
        np.ravel_multi_index(tuple(one.place.T), lattice.shape) for one in (ours, theirs)
    )
    _, row, other_row = np.intersect1d(
        number, other_number, assume_unique=True, return_indices=True
    )
    # A square whose saddle is on the contour, to within rounding, may be joined either way.
    a, b, c, d = (ours.values[row].astype(np.float64) - trial.isovalues[0]).T
    clear = np.abs(a * d - b * c) > ROUNDED * (np.abs(a * d) + np.abs(b * c))
    judged = ~ours.tied[row] & (clear | ~ours.ambiguous[row])
    differ = (ours.code[row] != theirs.code[other_row]) | (ours.odd[row] != theirs.odd[other_row])
    changed = row[judged & differ]
    if len(changed):
        first = ours.place[changed[0]].tolist()
        return f"{len(changed)} squares are joined otherwise, the first is that at {first}"
    return _moved(lattice, *(_on_edges(lattice, mesh) for mesh in (mine, other)))


def _matched(ours: Traces, theirs: Traces) -> tuple[Integers, Integers, int]:
    """The rows of the cells that both have, and how many untied cells only one has."""
    if np.array_equal(ours.cell, theirs.cell):
        every = np.arange(len(ours.cell))
        return every, every, 0
    _, row, other = np.intersect1d(ours.cell, theirs.cell, assume_unique=True, return_indices=True)
    lost = int((~ours.tied).sum() - (~ours.tied[row]).sum())
    lost += int((~theirs.tied).sum() - (~theirs.tied[other]).sum())
    return row, other, lost


def _judged_faces(trial: Trial, ours: Traces) -> Booleans:
    """(n, 6) faces of cells on which two answers must agree."""
    judged = np.repeat(~ours.tied[:, None], 6, axis=1)
    row, face, _, clarity = saddles(lattice_of(trial), ours)
    judged[row, face] &= clarity > ROUNDED
    return judged


def _on_edges(lattice: Lattice, mesh: Complex) -> Floats:
    """The places of the vertices in use that stand on lattice edges, off tied samples."""
    places = mesh.points[mesh.used]
    whole = (np.abs(places - np.rint(places)) <= lattice.tolerance).sum(axis=1)
    return _free(lattice, places[whole >= lattice.n - 1])


def _moved(lattice: Lattice, mine: Floats, theirs: Floats) -> str:
    """How two sets of places differ; nothing where they do not."""
    alone, other = overlay.lonely(mine, theirs, NEAR * lattice.tolerance)
    if not len(alone) and not len(other):
        return ""
    first = mine[alone[0]] if len(alone) else theirs[other[0]]
    return (
        f"{len(alone)} vertices of the plain answer have none of this one at their place, and "
        f"{len(other)} of this one none of the plain answer; one is at index {place(first)}"
    )


def _same_cells(trial: Trial, other: Complex) -> str:
    """How the vertices in cells, or the edges between cells that share a face, differ."""
    mine, lattice = complex_of(trial), lattice_of(trial)
    places = [_free(lattice, mesh.points[mesh.used]) for mesh in (mine, other)]
    if told := _moved(lattice, *places):
        return told
    kept = [_between_neighbours(lattice, mesh) for mesh in (mine, other)]
    alone, lone = overlay.unmatched_edges(mine, other, (kept[0], kept[1]), NEAR * lattice.tolerance)
    if not len(alone) and not len(lone):
        return ""
    ends = mine.points[alone[0]] if len(alone) else other.points[lone[0]]
    return (
        f"{len(alone)} edges between cells that share a face are only in the plain answer, and "
        f"{len(lone)} only in this one; one is from index {place(ends[0])} to {place(ends[1])}"
    )


def _free(lattice: Lattice, places: Floats) -> Floats:
    """The places that are not beside a tied sample."""
    return places[~lattice.beside_tie(places)] if len(places) else places


def _between_neighbours(lattice: Lattice, mesh: Complex) -> Booleans:
    """(e,) edges between vertices in cells that share a face, not beside a tied sample."""
    ends = overlay.edges(mesh)
    cells = np.floor(mesh.points[ends])
    step = np.abs(cells[:, 0] - cells[:, 1])
    near = lattice.beside_tie(mesh.points[ends].reshape(-1, lattice.n)).reshape(-1, 2).any(axis=1)
    # A vertex in a face of its cell belongs to either side.
    inner = np.abs(mesh.points[ends] - np.rint(mesh.points[ends])) > lattice.tolerance
    return np.asarray((step.sum(axis=1) == 1) & ~near & inner.all(axis=(1, 2)))


def _same_crossings_of_split(trial: Trial, other: Complex) -> str:
    """How the vertices, which stand on the edges of the split, differ."""
    lattice = lattice_of(trial)
    mine, theirs = (_free(lattice, mesh.points[mesh.used]) for mesh in (complex_of(trial), other))
    if told := _moved(lattice, mine, theirs):
        return told
    return _same_numbers(lattice, complex_of(trial), other)


def _same_meetings(trial: Trial, other: Complex) -> str:
    """How the points on lattice faces of dimension m, the pieces or the Euler numbers differ."""
    mine, lattice = complex_of(trial), lattice_of(trial)
    points = [_free(lattice, met(lattice, mesh)) for mesh in (mine, other)]
    if told := _moved(lattice, *points):
        return told
    # Between the faces of a cell several components leave the set open, unless they are linear.
    settled = trial.kind.m == 1 or trial.declaration.interpolant == "tetrahedra"
    return _same_numbers(lattice, mine, other) if settled else ""


def _same_numbers(lattice: Lattice, mine: Complex, other: Complex) -> str:
    """How pieces and Euler characteristics differ, where no sample is tied."""
    if lattice.tied.any():
        return ""
    plain, posed = ((mesh.components, mesh.euler) for mesh in (mine, other))
    if plain == posed:
        return ""
    return f"{posed[0]} pieces of Euler characteristic {posed[1]}; plain, {plain[0]} of {plain[1]}"


def met(lattice: Lattice, mesh: Complex) -> Floats:
    """The points in which the mesh meets the flats of dimension m through the samples."""
    n, m = lattice.n, len(lattice.isovalues)
    found = [np.empty((0, n))]
    for axes in combinations(range(n), m):
        turned = (*axes, *(a for a in range(n) if a not in axes))
        shape = tuple(lattice.shape[a] for a in turned)
        along, flat, _ = crossings(mesh.points[:, turned], mesh.simplices, shape, m)
        found.append(np.concatenate([along, flat], axis=1)[:, np.argsort(turned)])
    return np.concatenate(found)


# Cosine of the angle up to which normals are the same: those of single precision are within it.
TURNED = 0.999


def normals_of_stretched(trial: Trial) -> Finding:
    """Pass when the normals that came at an uneven spacing are those of the stretched surface.

    Where the field has no slope there is no normal, and zero or no number may come: vertices where
    either answer has that are not compared.
    """
    posed, other = variants.pose("spacing", trial.case, trial.field), trial.outcomes.get("spacing")
    if posed is None or other is None or other.status is not Status.OK:
        return skipped("it was not asked at another spacing")
    lattice, mesh = lattice_of(trial), other.mesh_of(trial.kind)
    if trial.plain.normals is None or other.normals is None:
        return skipped("no normals came with the vertices")
    if mesh is None or mesh.vertices.shape != trial.mesh.vertices.shape:
        return skipped("other vertices came: see symmetry.spacing")
    # Keep the vertices that are where they were, and are not beside a tied sample.
    factors = np.divide(posed[0].spacing, trial.field.spacing)
    away = np.abs(mesh.vertices / factors - trial.mesh.vertices).max(axis=1)
    used = np.unique(trial.mesh.simplices)
    used = used[away[used] <= NEAR * lattice.tolerance]
    points = lattice.index(trial.mesh.vertices[used])
    clear = ~lattice.beside_tie(points)
    used, points = used[clear], points[clear]
    if not len(used):
        return skipped("no vertex is where it was, or all are beside tied samples")
    # A surface that is stretched has normals that are shrunk.
    wanted, found = trial.plain.normals[used] / factors, other.normals[used].astype(np.float64)
    sizes = np.linalg.norm(wanted, axis=1) * np.linalg.norm(found, axis=1)
    known = np.isfinite(sizes) & (sizes > 0)
    if not known.any():
        return skipped("every normal that could be compared is zero, or not finite")
    wanted, found, sizes, points = wanted[known], found[known], sizes[known], points[known]
    cosine = (wanted * found).sum(axis=1) / sizes
    bad = np.flatnonzero(~(cosine >= TURNED))
    if not len(bad):
        return passed(normals=len(points))
    worst = np.degrees(np.arccos(np.clip(np.nanmin(cosine), -1, 1)))
    return failed(
        f"spacing: {len(bad)} of {len(points)} normals are not those of the stretched surface, the "
        f"first at index {place(points[bad[0]])}; the worst is off by {worst:.0f} degrees",
        variant="spacing",
        wrong=len(bad),
    )


# --- what may be asked ---------------------------------------------------------------------------


def _posed_alike(trial: Trial, name: str) -> bool:
    """Whether the interpolant of a variant is that of the plain field, moved or turned with it."""
    declared, n = trial.declaration, trial.kind.n
    if declared.interpolant != "tetrahedra":
        return True
    if name.startswith("translate"):
        cells = 2 if name.endswith("-2") else 1
        return all(cells % period == 0 for period in declared.split.period(n))
    if not name.startswith("symmetry/"):
        return True
    order, mirrored = variants.symmetry_of(name)
    parities = tuple((size - 1) % 2 for size in trial.field.shape)
    key = f"own symmetry {order} {mirrored}"
    return remembered(trial, key, lambda: own_symmetry(declared.split, parities, order, mirrored))


def own_symmetry(
    split: Split, parities: tuple[int, ...], order: tuple[int, ...], mirrored: tuple[bool, ...]
) -> bool:
    """Whether the split of a lattice, turned, is the split of the turned lattice.

    `parities` are the numbers of cells along each axis modulo two: where a split repeats after two
    cells, they say where a mirrored one begins.

    >>> own_symmetry(Split(), (0, 0), (1, 0), (False, False))
    True
    >>> own_symmetry(Split(), (0, 0), (0, 1), (True, False))
    False
    """
    cells = tuple(2 + parity for parity in parities)
    plain = _simplices_of(split, cells)
    turned_cells = tuple(cells[axis] for axis in order)
    there = _simplices_of(split, turned_cells)
    back = set()
    for simplex in there:
        corners = []
        for corner in simplex:
            moved = [turned_cells[a] - x if mirrored[a] else x for a, x in enumerate(corner)]
            corners.append(tuple(moved[order.index(axis)] for axis in range(len(cells))))
        back.add(frozenset(corners))
    return back == plain


def _simplices_of(split: Split, cells: tuple[int, ...]) -> set[frozenset[tuple[int, ...]]]:
    """The simplices of a lattice of so many cells; those of blocks that stick out are cut off."""
    n = len(cells)
    found = set()
    for start in product(*(range(0, c, p) for c, p in zip(cells, split.period(n), strict=True))):
        for simplex in split.over(n):
            moved = [tuple(s + x for s, x in zip(start, corner, strict=True)) for corner in simplex]
            if all(x <= c for corner in moved for x, c in zip(corner, cells, strict=True)):
                found.add(frozenset(moved))
    return found


def not_own(declared: Declaration) -> bool:
    """Vertices on edges or in cells; an own lattice is judged on known bodies only."""
    return declared.vertices != "own"


def placed_in_the_world(declared: Declaration) -> bool:
    """Takes directions of the axes, or negative spacings; and vertices on edges or in cells."""
    return not_own(declared) and (declared.limits.directions or declared.limits.negative)


def of_several_types(declared: Declaration) -> bool:
    """Called with samples, of more than one type."""
    return given_samples(declared) and len(declared.limits.types) != 1


def two_components(kind: Kind) -> bool:
    """Kinds with components that can change places."""
    return kind.m > 1


LAYOUTS = (
    "fortran", "strided", "cropped", "backwards", "swapped", "read-only", "mapped", "stride-0",
)  # fmt: skip


def _claim(
    name: str,
    rule: str,
    difference: Difference,
    asked: tuple[str, ...],
    families: Callable[[Declaration], bool] = not_own,
    kinds: Callable[[Kind], bool] = every_kind,
) -> Claim:
    """A claim of level 2 that compares these variants with the plain answer."""
    return Claim(
        id=name,
        rule=rule,
        source=DESIGN,
        level=2,
        judge=same(difference, *asked),
        kinds=kinds,
        families=families,
        variants=asked,
    )


CLAIMS = (
    _claim(
        "symmetry.translation",
        "A field inside a larger grid is answered, one cell off its border, as it is alone.",
        same_simplices,
        ("translate", "translate-2"),
    ),
    _claim(
        "symmetry.scaling",
        "Values and isovalue times a positive number give the same mesh.",
        same_simplices,
        ("scale",),
        every_family,
    ),
    _claim(
        "symmetry.shift",
        "Values and isovalue plus a number give the same mesh, up to rounding.",
        same_simplices,
        ("shift",),
        every_family,
    ),
    _claim(
        "symmetry.orientation",
        "Each symmetry of the lattice, applied to the field, is applied to the answer, but for "
        "diagonals.",
        same_shape,
        ("symmetry/",),
    ),
    _claim(
        "symmetry.components",
        "The components in another order give the same answer, but for diagonals.",
        same_shape,
        ("components",),
        not_own,
        two_components,
    ),
    _claim(
        "symmetry.spacing",
        "An uneven spacing stretches the answer and changes nothing else, but for diagonals.",
        same_shape,
        ("spacing",),
    ),
    _claim(
        "symmetry.directions",
        "Where the axes of the samples run elsewhere in the world, mirrored ones too, the answer "
        "goes with them, and its normals still point the way they did; asked of those who take "
        "directions or negative spacings.",
        same_in_the_world,
        ("directions/", "negative/"),
        placed_in_the_world,
    ),
    _claim(
        "symmetry.layout",
        "How the samples lie in memory does not change the answer: the order of axes and of bytes, "
        "gaps, whether they can be written.",
        same_simplices,
        LAYOUTS,
        given_samples,
    ),
    _claim(
        "symmetry.type",
        "The same numbers in another type give the same answer, up to rounding.",
        same_simplices,
        tuple(variants.TYPES),
        of_several_types,
    ),
    Claim(
        "symmetry.normals_returned",
        "Where normals come with the vertices, those at an uneven spacing are normals of the "
        "stretched surface.",
        DESIGN,
        None,
        on_mesh(normals_of_stretched),
        kinds=lambda kind: kind == SURFACES,
        families=not_own,
        variants=("spacing",),
        promised=False,
    ),
)
