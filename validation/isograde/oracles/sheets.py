"""What a mesh does in each cell: its sheets, its Euler characteristic, its arcs on the faces.

A triangle lies in one cell. The triangles of a cell make a little surface of their own, whose
components are the cell's sheets and whose open edges are its arcs. Both are compared with the
truth by the crossed cell edges they meet: two crossed edges are on one sheet, or joined by an arc,
in the mesh exactly when they are in the trilinear level set.

A triangle that lies in a face shared by two cells belongs to neither more than to the other. A
mesh is read in four ways, with such *flat* triangles in the upper cell, in the lower, in both, in
none; a cell is right when one of the readings is.

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
from typing import Literal

import numpy as np
from isoref.field import Booleans, Floats, Integers

from isograde.oracles.halfedges import components_of
from isograde.oracles.trilinear import EDGES, FACES, Truths

Flats = Literal["upper", "lower", "both", "none"]

# Number of the cell edge at half steps (2 i0, 2 i1, 2 i2) with one odd entry, else -1.
_EDGE_AT = np.full((3, 3, 3), -1)
for _number, (_a, _b) in enumerate(EDGES):
    _half = [(_a >> bit & 1) + (_b >> bit & 1) for bit in (2, 1, 0)]
    _EDGE_AT[tuple(_half)] = _number
_ON_FACE = np.array([[a in face and b in face for a, b in EDGES] for face in FACES])


class Fault(StrEnum):
    """What is wrong in a cell; the first that applies."""

    NONE = "right"
    OPEN = "hole"
    FACE = "wrong face"
    FALSE = "false tunnel"
    MISSING = "missing tunnel"
    EULER = "wrong Euler characteristic"
    CROWDED = "non-manifold edge"


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


def sheets(
    places: Floats, faces: Integers, index: Integers, shape: Sequence[int], flats: Flats = "upper"
) -> Sheets:
    """The surface in each of the cells `index` (n, 3), sorted, of a lattice of this shape."""
    cell, which = _cells(places, faces, shape, flats)
    flat = np.ravel_multi_index(tuple(index.T), tuple(shape))
    row = np.searchsorted(flat, cell)
    known = row < len(flat)
    known[known] &= flat[row[known]] == cell[known]
    triangles, row = faces[which][known], row[known]

    # Give each cell its own copy of each vertex.
    keys, local = np.unique(row[:, None] * len(places) + triangles, return_inverse=True)
    local = local.reshape(-1, 3)
    owner, vertex = np.divmod(keys, max(len(places), 1))
    edge = _edges_of(places[vertex], index[owner])
    ends = np.sort(local[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    pairs, uses = np.unique(ends, axis=0, return_counts=True)
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


def _cells(
    places: Floats, faces: Integers, shape: Sequence[int], flats: Flats
) -> tuple[Integers, Integers]:
    """Pairs of a cell, by its flat index, and a triangle in it."""
    last = np.array(shape) - 2
    cell = np.floor(places[faces].mean(axis=1)).astype(np.int64)
    flat = _flat(places, faces)
    plane = np.rint(places[faces[:, 0]]).astype(np.int64)
    lower, upper = np.where(flat, plane - 1, cell), np.where(flat, plane, cell)
    level = np.arange(len(faces))
    single = ~np.logical_or.reduce(flat, axis=1)
    chosen = {
        "upper": [(upper, level)],
        "lower": [(lower, level)],
        "both": [(upper, level), (lower[~single], level[~single])],
        "none": [(upper[single], level[single])],
    }[flats]
    cells = np.concatenate([np.clip(c, 0, last) for c, _ in chosen])
    triangles = np.concatenate([t for _, t in chosen])
    # On the skin of the lattice both sides are one cell: keep such a triangle once.
    index = np.asarray(np.ravel_multi_index(tuple(cells.T), tuple(shape)))
    pairs = np.unique(np.stack([triangles, index], axis=1), axis=0)
    return pairs[:, 1], pairs[:, 0]


def _flat(places: Floats, faces: Integers) -> Booleans:
    """(F, 3) whether the triangle lies in a plane of the lattice across this axis."""
    corners = places[faces]
    gap = np.abs(corners - np.rint(corners[:, :1]))
    return np.asarray(gap.max(axis=1) < 1e-6)


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
    arcs = np.zeros((len(truths), 12, 12), bool)
    for face, joined in enumerate(truths.faces.T):
        edges = np.flatnonzero(_ON_FACE[face])
        for a in edges:
            for b in edges[edges > a]:
                shared = set(EDGES[a]) & set(EDGES[b])
                both = crossed[:, a] & crossed[:, b]
                if shared:
                    # On an ambiguous face an arc cuts a corner off: one whose side is not joined.
                    side = np.where(truths.high[:, shared.pop()], 1, -1)
                    both &= (joined == 0) | (joined != side)
                else:
                    both &= joined == 0
                arcs[:, a, b] |= both
                arcs[:, b, a] |= both
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
    places: Floats, faces: Integers, index: Integers, truths: Truths, shape: Sequence[int]
) -> list[Fault]:
    """The fault of each cell, flat triangles taken in the mesh's favour.

    Of the faults of several readings the last in order is named: the earlier ones it passed.
    """
    names = list(Fault)
    readings: tuple[Flats, ...] = ("upper", "lower", "both", "none")
    if not _flat(places, faces).any():
        readings = ("upper",)
    found = np.array([faults(truths, sheets(places, faces, index, shape, r)) for r in readings])
    best = np.where((found == 0).any(axis=0), 0, found.max(axis=0))
    return [names[k] for k in best]
