"""What a mesh does in each cell: its sheets, its Euler characteristic, its arcs on the faces.

A triangle lies in one cell. The triangles of a cell make a little surface of their own, whose
components are the cell's sheets and whose open edges are its arcs. Both are compared with the
truth by the crossed cell edges they meet: two crossed edges are on one sheet, or joined by an arc,
in the mesh exactly when they are in the trilinear level set.

A triangle that lies in a face shared by two cells belongs to neither more than to the other. Such
*flat* triangles are given to the cells in every way that leaves the face whole; cells are right
when they are under one and the same way, see `isograde.oracles.flat`.

Glossary
--------
place       index coordinates
corner, edge, face   of a cell, as numbered in `isograde.oracles.trilinear`
sheet       component of the surface in a cell
arc         open edge of that surface between crossings of two edges of one face
loose       any other open edge: a hole
crowded     an edge with more than two triangles
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import combinations

import numpy as np
from isoref.field import Booleans, Field, Floats, Integers

from isograde.oracles.flat import Readings
from isograde.oracles.lattice import Lattice
from isograde.oracles.rows import components_of, distinct
from isograde.oracles.traces import Traces, traces
from isograde.oracles.trilinear import EDGES, FACES, NONE, Truths

# Number of the cell edge at half steps (2 i0, 2 i1, 2 i2) with one odd entry, else -1.
_EDGE_AT = np.full((3, 3, 3), -1)
for _number, (_a, _b) in enumerate(EDGES):
    _half = [(_a >> bit & 1) + (_b >> bit & 1) for bit in (2, 1, 0)]
    _EDGE_AT[tuple(_half)] = _number
_ON_FACE = np.array([[a in face and b in face for a, b in EDGES] for face in FACES])

# Each two edges of one face, which have no other face in common, by face and edges; last the corner
# in which they meet, or -1.
_PAIRS_ON_FACES = np.array(
    [
        (face, a, b, *(set(EDGES[a]) & set(EDGES[b]) or {-1}))
        for face, on in enumerate(_ON_FACE)
        for a, b in combinations(np.flatnonzero(on).tolist(), 2)
    ]
)

# A face's number in `FACES`, by twice its axis, and one more on the upper side.
_NUMBER = np.array(
    [
        next(f for f, face in enumerate(FACES) if all((c >> (2 - a) & 1) == side for c in face))
        for a in range(3)
        for side in (0, 1)
    ]
)


class Fault(StrEnum):
    """What is wrong in a cell; the first that applies. Where nothing can be told: undecided."""

    NONE = "right"
    OPEN = "hole"
    FACE = "wrong face"
    FALSE = "false tunnel"
    MISSING = "missing tunnel"
    EULER = "wrong Euler characteristic"
    CROWDED = "non-manifold edge"
    UNDECIDED = "undecided: too many flat triangles"


@dataclass(frozen=True, eq=False)
class Sheets:
    """The surface in each of n cells.

    sheet : (n, 12) name of the sheet that meets the crossing on each edge, -1 where none does
    euler : (n,) vertices less edges plus triangles
    arcs : (n, 12, 12) an arc joins the crossings on these two edges
    loose, crowded : (n,) number of such edges
    """

    sheet: Integers
    euler: Integers
    arcs: Booleans
    loose: Integers
    crowded: Integers


def sheets(places: Floats, triangles: Integers, row: Integers, index: Integers) -> Sheets:
    """The surface in each of the cells `index` (n, 3): triangle t lies in the cell row[t]."""
    # Give each cell its own copy of each vertex.
    keys, local = np.unique(row[:, None] * len(places) + triangles, return_inverse=True)
    local = local.reshape(-1, 3)
    owner, vertex = np.divmod(keys, max(len(places), 1))
    edge = _edges_of(places[vertex], index[owner])
    ends = np.sort(local[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    first, name = distinct(ends)
    pairs, uses = ends[first], np.bincount(name)
    _, component = components_of(len(keys), pairs.T)

    n = len(index)
    sheet = np.full((n, 12), -1)
    on = edge >= 0
    sheet[owner[on], edge[on]] = component[on]
    euler = np.bincount(owner, minlength=n) - np.bincount(owner[pairs[:, 0]], minlength=n)
    euler += np.bincount(row, minlength=n)
    crowded = np.bincount(owner[pairs[uses > 2, 0]], minlength=n)
    arcs, loose = _open_edges(pairs[uses % 2 == 1], owner, edge, n)
    return Sheets(sheet, euler, arcs, loose, crowded)


def _rows(
    places: Floats, faces: Integers, index: Integers, shape: Sequence[int]
) -> tuple[Integers, Integers]:
    """The row of the cell in which each triangle's middle lies, and the triangles that have one."""
    cell = np.floor(places[faces].mean(axis=1)).astype(np.int64)
    cell = np.clip(cell, 0, np.array(shape) - 2)
    which = np.ravel_multi_index(tuple(cell.T), tuple(shape))
    listed = np.ravel_multi_index(tuple(index.T), tuple(shape))
    row = np.searchsorted(listed, which)
    known = row < len(listed)
    known[known] &= listed[row[known]] == which[known]
    return row[known], np.flatnonzero(known)


def _level(places: Floats, faces: Integers, tolerance: float) -> Booleans:
    """(F,) whether the triangle lies in a plane of the lattice."""
    level = np.zeros(len(faces), bool)
    for axis in range(3):
        a, b, c = (places[faces[:, k], axis] for k in range(3))
        whole = np.rint(a)
        gap = np.maximum(np.maximum(abs(a - whole), abs(b - whole)), abs(c - whole))
        level |= gap <= tolerance
    return level


def _edges_of(places: Floats, cell: Integers) -> Integers:
    """The cell edge each place stands on: between two corners, on the line that joins them; or -1.

    The free coordinate is the one farthest from a whole number.
    """
    inside = places - cell
    nearest = np.rint(inside)
    free = np.abs(inside - nearest).argmax(axis=1)
    rows = np.arange(len(places))
    half = 2 * nearest.astype(np.int64)
    half[rows, free] = 1
    gap = np.abs(inside - nearest)
    gap[rows, free] = 0
    good = (gap < 1e-5).all(axis=1) & (half >= 0).all(axis=1) & (half <= 2).all(axis=1)
    found = np.full(len(places), -1)
    found[good] = _EDGE_AT[tuple(half[good].T)]
    return found


def _open_edges(
    pairs: Integers, owner: Integers, edge: Integers, n: int
) -> tuple[Booleans, Integers]:
    """The arcs (n, 12, 12), and the number of other open edges (n,)."""
    a, b = edge[pairs[:, 0]], edge[pairs[:, 1]]
    row = owner[pairs[:, 0]]
    proper = (a >= 0) & (b >= 0) & (_ON_FACE[:, a] & _ON_FACE[:, b]).any(axis=0)
    arcs = np.zeros((n, 12, 12), bool)
    arcs[row[proper], a[proper], b[proper]] = True
    arcs[row[proper], b[proper], a[proper]] = True
    return arcs, np.bincount(row[~proper], minlength=n)


# --- the same, of the truth ---------------------------------------------------------------------


def true_arcs(truths: Truths) -> Booleans:
    """(n, 12, 12) the level set joins the crossings on these two edges across a face."""
    ends = np.array(EDGES)
    crossed = truths.high[:, ends[:, 0]] != truths.high[:, ends[:, 1]]
    face, a, b, corner = _PAIRS_ON_FACES.T
    joined = truths.faces[:, face]
    # On an ambiguous face an arc cuts a corner off: one whose side is not joined.
    side = np.where(truths.high[:, corner], 1, -1)
    drawn = crossed[:, a] & crossed[:, b] & ((joined == 0) | ((corner >= 0) & (joined != side)))
    arcs = np.zeros((len(truths), 12, 12), bool)
    arcs[:, a, b] = arcs[:, b, a] = drawn
    return arcs


def true_sheets(truths: Truths) -> Integers:
    """(n, 12) name of the sheet that meets the crossing on each edge, -1 where there is none."""
    ends = np.array(EDGES)
    a, b = truths.high[:, ends[:, 0]], truths.high[:, ends[:, 1]]
    first, second = truths.body[:, ends[:, 0]], truths.body[:, ends[:, 1]]
    name = np.where(a, 8 * first + second, 8 * second + first)
    return np.where(a != b, name, -1)


def faults(truths: Truths, found: Sheets) -> Integers:
    """(n,) the number of the fault in each cell, in the order of `Fault`; 0 where it is right."""
    wanted, made = true_sheets(truths), found.sheet
    missing = ((wanted >= 0) != (made >= 0)).any(axis=1)
    arcs = (true_arcs(truths) != found.arcs).any(axis=(1, 2))
    both = (wanted >= 0)[:, :, None] & (wanted >= 0)[:, None]
    alike = wanted[:, :, None] == wanted[:, None]
    joined = made[:, :, None] == made[:, None]
    order = [
        missing | (found.loose > 0),
        arcs,
        (both & joined & ~alike).any(axis=(1, 2)),
        (both & ~joined & alike).any(axis=(1, 2)),
        found.euler != truths.euler,
        found.crowded > 0,
    ]
    number = np.zeros(len(truths), np.int64)
    for k in range(len(order), 0, -1):
        number[order[k - 1]] = k
    return number


def judge(
    places: Floats,
    faces: Integers,
    index: Integers,
    truths: Truths,
    shape: Sequence[int],
    lattice: Lattice | None = None,
    judged: Booleans | None = None,
) -> list[Fault]:
    """The fault of each cell.

    Parameters
    ----------
    places, faces : the mesh in index coordinates, equal vertices welded
    index, truths : (n, 3) and (n,) all cells that the surface passes through, in order
    shape : samples along each axis
    lattice : the samples, whose tolerance holds for flat triangles; that of `shape` if not given
    judged : (n,) cells to be right; the others, such as ties, may be anything. All that are no
        tie, if not given
    """
    lattice = lattice or _lattice(index, truths, shape)
    level = _level(places, faces, lattice.tolerance)
    row, which = _rows(places, faces[~level], index, shape)
    triangles = faces[~level][which]
    found = faults(truths, sheets(places, triangles, row, index))
    if level.any():
        drawn = traces(lattice, places, faces)
        wanted = truths.ties == NONE if judged is None else judged
        _with_flat(found, drawn, wanted, (places, faces, triangles, row), index, truths)
    names = list(Fault)
    return [names[k] for k in found]


def _lattice(index: Integers, truths: Truths, shape: Sequence[int]) -> Lattice:
    """A lattice with the sides that the truths tell; it has no ties."""
    sides = np.full(tuple(shape), -1.0)
    for corner in range(8):
        i, j, k = (index + np.array([corner >> 2 & 1, corner >> 1 & 1, corner & 1])).T
        sides[i, j, k] = np.where(truths.high[:, corner], 1.0, -1.0)
    return Lattice.of(Field.of(sides), (0.0,))


def _with_flat(
    found: Integers,
    drawn: Traces,
    judged: Booleans,
    mesh: tuple[Floats, Integers, Integers, Integers],
    index: Integers,
    truths: Truths,
) -> None:
    """Judge the cells that have flat triangles anew, with the triangles given to them.

    mesh : places, faces, the triangles that are not flat, and the row of each in `index`
    """
    places, faces, triangles, row = mesh
    here = _listed(drawn.place, index)
    readings = drawn.readings.preferring(_wanted(drawn.readings, here, truths))

    # Every trial cell has its cell's own triangles, and the flat ones that are given to it.
    trials = readings.trials
    known = here[trials.row] >= 0
    cell = np.where(known, here[trials.row], 0)
    order = np.argsort(row, kind="stable")
    count = np.bincount(row, minlength=len(index))
    first = np.cumsum(count) - count
    owner = np.repeat(np.arange(len(cell)), count[cell])
    within = np.arange(len(owner)) - np.repeat(np.cumsum(count[cell]) - count[cell], count[cell])
    own = triangles[order[first[cell[owner]] + within]]
    flat = faces[readings.lying.triangle[trials.triangle]]
    surface = sheets(
        places,
        np.concatenate([own, flat]),
        np.concatenate([owner, trials.owner]),
        index[cell],
    )

    # Few wrong cells are better than many; of as many, those with the later faults.
    fault = faults(truths[cell], surface)
    weight = np.where(fault == 0, 0, (1 << 20) - fault)
    chosen = trials.chosen(readings, readings.settle(np.where(known & judged[cell], weight, 0)))
    chosen = chosen[known[chosen]]
    found[cell[chosen]] = fault[chosen]
    beyond = here[readings.unjudged]
    found[beyond[beyond >= 0]] = list(Fault).index(Fault.UNDECIDED)


def _listed(place: Integers, index: Integers) -> Integers:
    """The row in `index`, which is in order, of each cell at `place`, or -1."""
    if not len(index):
        return np.full(len(place), -1)
    shape = tuple(np.maximum(place.max(axis=0, initial=0), index.max(axis=0)) + 1)
    listed = np.ravel_multi_index(tuple(index.T), shape)
    wanted = np.ravel_multi_index(tuple(place.T), shape)
    row = np.minimum(np.searchsorted(listed, wanted), len(listed) - 1)
    return np.where(listed[row] == wanted, row, -1)


def _wanted(readings: Readings, here: Integers, truths: Truths) -> Integers:
    """(m,) what the level set does on each face: 0 separated, 1 joined, -1 either, or not told."""
    wanted = np.full(len(readings.lying), -1)
    for row, face in readings.lying.sides:
        cell = np.where(row >= 0, here[np.maximum(row, 0)], -1)
        known = (cell >= 0) & (truths.ties[cell] == NONE)
        joined = truths.faces[cell[known], _NUMBER[face[known]]]
        wanted[known] = np.array([-1, 1, 0])[joined]
    return wanted
