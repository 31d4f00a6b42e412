"""Dual surfaces, vectorised: the mesh of `isoref.dual`, number for number.

Only active cells are worked on once they are found. What a rule says of a cell depends on a key of
fifteen bits, so each rule is asked once for each key that occurs, and its answers are laid out as
tables that all cells are looked up in at once.

Glossary
--------
key         of a cell: signs + 256 * turned + 512 * border (`isoref.dual`)
slot        12 * (number of an active cell) + edge: a possible corner of a quadrilateral
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from isoref.cube import CORNER_OFFSETS
from isoref.dual import ROUND, DualRule, in_triangles
from isoref.field import Array, Booleans, Field, Floats, Integers, check_isovalue, inside_samples
from isoref.mesh import Mesh
from isoref.sweep import cell_crossings, check_volume

# Active cells whose crossings are held at once.
BLOCK_CELLS = 1 << 15


def surface(rule: DualRule, field: Field, isovalue: float) -> Mesh:
    """The rule's surface in triangles; see `isoref.dual.surface`."""
    return in_triangles(*quads(rule, field, isovalue))


def quads(rule: DualRule, field: Field, isovalue: float) -> tuple[Floats, Integers]:
    """The rule's surface in quadrilaterals; see `isoref.dual.quads`."""
    check_volume(field)
    alpha = check_isovalue(isovalue)
    if min(field.shape) < 2:
        return np.empty((0, 3)), np.empty((0, 4), np.int64)
    inside = inside_samples(field, alpha)
    cells = _Cells.of(rule, inside)
    tables = _Tables.of(rule, cells.keys)
    first = np.cumsum(tables.count[cells.rows]) - tables.count[cells.rows]
    vertices = np.empty((int(tables.count[cells.rows].sum()), 3))
    for start in range(0, len(cells.points), BLOCK_CELLS):
        block = slice(start, start + BLOCK_CELLS)
        _place(field, alpha, cells, tables, first, block, vertices)
    return vertices, _join(inside, cells, tables, first)


@dataclass(frozen=True)
class _Cells:
    """The active cells, in C order.

    points : (C,) flat index of the lattice point at the lowest corner
    keys : the distinct keys that occur
    rows : (C,) the place of each cell's key among them
    number : lattice point -> number of the cell, (N1 N2 N3,); only active cells' entries count
    """

    points: Integers
    keys: Integers
    rows: Integers
    number: Array

    @classmethod
    def of(cls, rule: DualRule, inside: Booleans) -> _Cells:
        """The cells with corners on both sides."""
        signs = cell_signs(inside)
        index = np.nonzero((signs != 0) & (signs != 255))
        keys = signs[index].astype(np.int64)
        keys |= _turned(rule, signs, index).astype(np.int64) << 8
        for a in range(3):
            keys |= (index[a] == 0).astype(np.int64) << (9 + 2 * a)
            keys |= (index[a] == signs.shape[a] - 1).astype(np.int64) << (10 + 2 * a)
        points = np.ravel_multi_index(index, inside.shape)
        number = np.empty(inside.size, np.int32 if len(points) < 1 << 31 else np.int64)
        number[points] = np.arange(len(points))
        occurs = np.bincount(keys, minlength=1 << 15) > 0
        rows = np.cumsum(occurs) - 1
        return cls(points, np.flatnonzero(occurs), rows[keys], number)


def cell_signs(inside: Booleans) -> Array:
    """The signs of every cell, (N1-1, N2-1, N3-1) bytes.

    >>> cell_signs(np.arange(8).reshape(2, 2, 2) == 4).tolist()
    [[[2]]]
    """
    signs: Array = inside.astype(np.uint8)
    for axis in range(3):
        low = (slice(None),) * axis + (slice(None, -1),)
        high = (slice(None),) * axis + (slice(1, None),)
        signs = signs[low] | signs[high] << (1 << axis)
    return signs


def _turned(rule: DualRule, signs: Array, index: tuple[Array, ...]) -> Booleans:
    """Which of these cells turn, as their neighbours do."""
    face = np.array([_face(rule, s) for s in range(256)], np.int8)
    turned = np.zeros(len(index[0]), np.bool_)
    own = face[signs[index]]
    for f in range(6):
        axis, side = divmod(f, 2)
        asked = np.flatnonzero(own == f)
        there = [i[asked] for i in index]
        there[axis] = there[axis] + (2 * side - 1)
        exists = (there[axis] >= 0) & (there[axis] < signs.shape[axis])
        there[axis] = there[axis].clip(0, signs.shape[axis] - 1)
        turned[asked] = exists & (face[signs[tuple(there)]] == f ^ 1)
    return turned


def _face(rule: DualRule, signs: int) -> int:
    """The face the signs may turn at, or -1."""
    f = rule.turns_at(signs)
    return -1 if f is None else f


@dataclass(frozen=True)
class _Tables:
    """What the rule says of each key that occurs.

    count : (K,) vertices
    corner : (K, 12) the vertex that is a corner of the quadrilateral across an edge, or -1
    crossings : for each row (k, v, e) of vertex v of key k: e is one of its crossings
    """

    count: Integers
    corner: Array
    crossings: list[list[tuple[int, ...]]]

    @classmethod
    def of(cls, rule: DualRule, keys: Integers) -> _Tables:
        """The rule, asked once for each key."""
        found = [rule.patches(k & 255, bool(k >> 8 & 1), k >> 9) for k in keys.tolist()]
        corner = np.full((len(keys), 12), -1, np.int8)
        for k, patches in enumerate(found):
            for v, patch in enumerate(patches):
                corner[k, list(patch.quads)] = v
        count = np.array([len(patches) for patches in found], np.int64)
        return cls(count, corner, [[patch.crossings for patch in patches] for patches in found])


def _place(
    field: Field,
    alpha: float,
    cells: _Cells,
    tables: _Tables,
    first: Integers,
    block: slice,
    vertices: Floats,
) -> None:
    """Write the vertices of a block of cells."""
    shape = field.shape
    index = np.array(np.unravel_index(cells.points[block], shape))
    samples = np.array([field.values[tuple(index + o[:, None])] for o in CORNER_OFFSETS])
    crossings = cell_crossings(samples.astype(np.float64) - alpha)
    # Take the cells of one key together: they share their patches.
    rows = cells.rows[block]
    order = np.argsort(rows, kind="stable")
    for same in np.split(order, np.flatnonzero(np.diff(rows[order])) + 1):
        for v, patch in enumerate(tables.crossings[rows[same[0]]] if len(same) else []):
            inner = crossings[np.array(patch)[:, None], same].mean(axis=0)
            vertices[first[block][same] + v] = field.position(index[:, same].T + inner)


def _join(inside: Booleans, cells: _Cells, tables: _Tables, first: Integers) -> Integers:
    """The quadrilaterals across the crossed lattice edges that have one, (Q, 4)."""
    shape = inside.shape
    strides = np.array([shape[1] * shape[2], shape[2], 1])
    flat = inside.reshape(-1)
    parts = []
    for axis in range(3):
        # Leave out the edges in the border: only three or fewer cells meet there.
        window = tuple(slice(0, -1) if a == axis else slice(1, -1) for a in range(3))
        beyond = tuple(slice(1, None) if a == axis else slice(1, -1) for a in range(3))
        crossed = np.nonzero(inside[window] != inside[beyond])
        low = sum((i + (a != axis)) * strides[a] for a, i in enumerate(crossed))
        low = np.asarray(low, np.int64)
        quad = np.empty((len(low), 4), np.int64)
        for place, (step, e) in enumerate(ROUND[axis]):
            cell = cells.number[low - int(np.dot(step, strides))]
            quad[:, place] = first[cell] + tables.corner[cells.rows[cell], e]
        reverse = ~flat[low]
        quad[reverse] = quad[reverse][:, [0, 3, 2, 1]]
        parts.append(quad)
    return np.concatenate(parts)
