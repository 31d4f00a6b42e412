"""Dual surfaces, vectorised: the mesh of `isoref.dual`, vertex by vertex and row by row.

What a rule says of a cell depends on a key of fifteen bits, so a rule is asked once for each key
that occurs, and its answers are laid out as tables. Then each crossed lattice edge is visited once:
it adds its crossing to the vertices of the four cells round it, and joins them.

Glossary
--------
key         of a cell: signs + 256 * turned + 512 * border (`isoref.dual`)
slot        of a vertex: a place among all vertices; those of a cell follow one another
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from isoref.cube import CORNER_OFFSETS, EDGE_CORNERS
from isoref.dual import ROUND, DualRule, in_triangles, provenance_of
from isoref.field import Array, Booleans, Field, Floats, Integers, check_isovalue, inside_samples
from isoref.mesh import Mesh, in_space
from isoref.sweep import check_volume, crossing_parameter


@in_space
def surface(rule: DualRule, field: Field, isovalue: float, provenance: bool = False) -> Mesh:
    """The rule's surface in triangles; see `isoref.dual.surface`."""
    vertices, rows, cells = drawn(rule, field, isovalue)
    mesh = in_triangles(vertices, rows)
    return replace(mesh, provenance=provenance_of(cells, mesh, field)) if provenance else mesh


def quads(rule: DualRule, field: Field, isovalue: float) -> tuple[Floats, Integers]:
    """The rule's surface in quadrilaterals; see `isoref.dual.quads`."""
    return drawn(rule, field, isovalue)[:2]


def drawn(rule: DualRule, field: Field, isovalue: float) -> tuple[Floats, Integers, Integers]:
    """Vertices, quadrilaterals and the cells of the vertices; see `isoref.dual.drawn`."""
    check_volume(field)
    alpha = check_isovalue(isovalue)
    if min(field.shape) < 2:
        return np.empty((0, 3)), np.empty((0, 4), np.int64), np.empty(0, np.int64)
    inside = np.ascontiguousarray(inside_samples(field, alpha))
    cells = _Cells.of(rule, inside)
    tables = _Tables.of(rule, cells.keys)
    count = tables.count[cells.rows]
    first = np.cumsum(count) - count
    total, rows = np.zeros((3, int(count.sum()))), []
    for edges in _crossed_edges(field, alpha, inside):
        corners = _corners(edges, cells, tables, first, inside.shape)
        for slot in corners:
            real = slot >= 0
            share = np.bincount(slot[real], edges.t[real], minlength=total.shape[1])
            total[edges.axis] += share
        rows.append(_rows(edges, corners, inside))
    vertices = _placed(field, cells, tables, total)
    return vertices, np.concatenate(rows), np.repeat(cells.points, count)


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
        index = np.unravel_index(np.flatnonzero((signs + 1) > 1), signs.shape)
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
    """What the rule says of each of K keys.

    count : (K,) vertices
    vertex : (12 K,) which of them the crossing on an edge counts for, 12 k + e; -1 for none
    start : (K,) its first vertex among those of all keys
    crossings : (v,) how many crossings each vertex of a key has
    low : (3, v) the sum of the lower ends of their edges, in coordinates of the cell
    """

    count: Integers
    vertex: Array
    start: Integers
    crossings: Integers
    low: Integers

    @classmethod
    def of(cls, rule: DualRule, keys: Integers) -> _Tables:
        """The rule, asked once for each key."""
        found = [rule.patches(k & 255, bool(k >> 8 & 1), k >> 9) for k in keys.tolist()]
        vertex = np.full((len(keys), 12), -1, np.int8)
        for k, patches in enumerate(found):
            for v, patch in enumerate(patches):
                vertex[k, list(patch.crossings)] = v
        count = np.array([len(patches) for patches in found], np.int64)
        every = [list(patch.crossings) for patches in found for patch in patches]
        lower = CORNER_OFFSETS[EDGE_CORNERS[:, 0]]
        low = np.array([lower[edges].sum(axis=0) for edges in every], np.int64).reshape(-1, 3)
        crossings = np.array([len(edges) for edges in every], np.int64)
        return cls(count, vertex.reshape(-1), np.cumsum(count) - count, crossings, low.T)


@dataclass(frozen=True)
class _Edges:
    """The crossed lattice edges of an axis, in C order of their lower ends.

    low : (E,) flat index of the lower end; index (3, E) its coordinates
    t : (E,) where they are crossed
    """

    axis: int
    low: Integers
    index: Integers
    t: Floats


def _crossed_edges(field: Field, alpha: float, inside: Booleans) -> Iterator[_Edges]:
    """The crossed edges of each axis in turn."""
    for axis in range(3):
        here = (slice(None),) * axis + (slice(None, -1),)
        there = (slice(None),) * axis + (slice(1, None),)
        crossed = inside[here] != inside[there]
        index = np.array(np.unravel_index(np.flatnonzero(crossed), crossed.shape))
        beyond = index + (np.arange(3) == axis)[:, None]
        low, high = (field.values[tuple(i)].astype(np.float64) - alpha for i in (index, beyond))
        flat = np.ravel_multi_index(tuple(index), inside.shape)
        yield _Edges(axis, np.asarray(flat), index, crossing_parameter(low, high))


def _corners(
    edges: _Edges, cells: _Cells, tables: _Tables, first: Integers, shape: tuple[int, ...]
) -> Integers:
    """The slots of the vertices in the four cells round each edge, (4, E); -1 for none."""
    strides = np.array([shape[1] * shape[2], shape[2], 1])
    corners = np.full((4, len(edges.low)), -1, np.int64)
    for out, (step, e) in zip(corners, ROUND[edges.axis], strict=True):
        # Leave out the cells that a border edge lacks.
        exists = np.ones(len(edges.low), np.bool_)
        for a in range(3):
            if a != edges.axis:
                exists &= edges.index[a] > 0 if step[a] else edges.index[a] < shape[a] - 1
        some = np.flatnonzero(exists)
        cell = cells.number[edges.low[some] - int(np.dot(step, strides))]
        vertex = tables.vertex[12 * cells.rows[cell] + e]
        out[some] = np.where(vertex >= 0, first[cell] + vertex, -1)
    return corners


def _rows(edges: _Edges, corners: Integers, inside: Booleans) -> Integers:
    """The quadrilaterals across the edges that have four cells, (Q, 4), from high to low."""
    shape = inside.shape
    inner = np.ones(len(edges.low), np.bool_)
    for a in range(3):
        if a != edges.axis:
            inner &= (edges.index[a] > 0) & (edges.index[a] < shape[a] - 1)
    rows = corners[:, inner].T
    turned = ~inside.reshape(-1)[edges.low[inner]]
    rows[turned] = rows[turned][:, [0, 3, 2, 1]]
    return np.ascontiguousarray(rows)


def _placed(field: Field, cells: _Cells, tables: _Tables, total: Floats) -> Floats:
    """The vertices, from the sums of their crossings' parameters, (V, 3)."""
    count = tables.count[cells.rows]
    cell = np.repeat(np.arange(len(count)), count)
    begin = np.cumsum(count) - count
    kind = tables.start[cells.rows][cell] + np.arange(len(cell)) - begin[cell]
    index = np.array(np.unravel_index(cells.points[cell], field.shape))
    return field.position((index + (tables.low[:, kind] + total) / tables.crossings[kind]).T)
