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
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from isoref.cube import CORNER_OFFSETS, EDGE_CORNERS
from isoref.dual import ROUND, DualRule, provenance_of
from isoref.fast._bits import take
from isoref.field import Array, Booleans, Field, Floats, Integers, check_isovalue, inside_samples
from isoref.mesh import Mesh, in_space
from isoref.sweep import check_volume, crossing_parameter


@in_space
def surface(rule: DualRule, field: Field, isovalue: float, provenance: bool = False) -> Mesh:
    """The rule's surface in triangles; see `isoref.dual.surface`."""
    vertices, rows, cells = drawn(rule, field, isovalue)
    mesh = Mesh.of(vertices, _halves(rows))
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
    count = take(tables.count, cells.rows)
    first = np.cumsum(count) - count
    total, rows = np.zeros((3, int(count.sum()))), []
    for edges in _crossed_edges(field, alpha, inside):
        corners, inner = _corners(edges, cells, tables, first, inside.shape)
        for slot in corners:
            real = (slot >= 0).nonzero()[0]
            whole = len(real) == len(slot)
            slots, t = (slot, edges.t) if whole else (take(slot, real), take(edges.t, real))
            np.add.at(total[edges.axis], slots, t)
        rows.append(_rows(edges, corners, inner, inside))
    vertices = _placed(field, cells, tables, total)
    return vertices, np.concatenate(rows), np.repeat(cells.points, count)


@dataclass(frozen=True)
class _Cells:
    """The active cells, in C order.

    index : three times (C,) the coordinates of the lowest corner
    points : (C,) flat index of the lattice point there
    keys : the distinct keys that occur
    rows : (C,) the place of each cell's key among them
    number : lattice point -> number of the cell; -1 for points on the upper border, which have no
        cell; other entries count where the cell is active. Before those of the lattice there are
        `spare` entries of -1.
    """

    index: tuple[Integers, ...]
    points: Integers
    keys: Integers
    rows: Integers
    number: Array
    spare: int

    @classmethod
    def of(cls, rule: DualRule, inside: Booleans) -> _Cells:
        """The cells with corners on both sides."""
        signs = cell_signs(inside)
        active = np.flatnonzero((signs + 1) > 1)
        index = np.unravel_index(active, signs.shape)
        own = take(signs.reshape(-1), active)
        keys = own.astype(np.int64)
        keys |= _turned(rule, signs, own, index).astype(np.int64) << 8
        for a, size in enumerate(signs.shape):
            border = np.zeros(size, np.int64)
            border[0] |= 1 << (9 + 2 * a)
            border[-1] |= 1 << (10 + 2 * a)
            keys |= take(border, index[a])
        points = (index[0] * inside.shape[1] + index[1]) * inside.shape[2] + index[2]
        spare = sum(_strides(inside.shape))
        number = np.empty(spare + inside.size, np.int32 if len(points) < 1 << 31 else np.int64)
        number[:spare] = -1
        whole = number[spare:].reshape(inside.shape)
        whole[-1], whole[:, -1], whole[:, :, -1] = -1, -1, -1
        number[points + spare] = np.arange(len(points), dtype=number.dtype)
        occurs = np.bincount(keys, minlength=1 << 15) > 0
        rows = take(np.cumsum(occurs) - 1, keys)
        return cls(index, points, np.flatnonzero(occurs), rows, number, spare)


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


def _turned(rule: DualRule, signs: Array, own: Array, index: tuple[Array, ...]) -> Booleans:
    """Which of these cells, whose signs are `own`, turn, as their neighbours do."""
    face = _faces(rule)
    turned = np.zeros(len(own), np.bool_)
    own = take(face, own.astype(np.intp))
    for f in set(face.tolist()) - {-1}:
        axis, side = divmod(f, 2)
        asked = np.flatnonzero(own == f)
        there = [i[asked] for i in index]
        there[axis] = there[axis] + (2 * side - 1)
        exists = (there[axis] >= 0) & (there[axis] < signs.shape[axis])
        there[axis] = there[axis].clip(0, signs.shape[axis] - 1)
        turned[asked] = exists & (face[signs[tuple(there)]] == f ^ 1)
    return turned


@lru_cache(maxsize=16)
def _faces(rule: DualRule) -> Array:
    """(256,) the face that cells of these signs may turn at, or -1."""
    turns = [rule.turns_at(signs) for signs in range(256)]
    return np.array([-1 if f is None else f for f in turns], np.int8)


class _Answer(NamedTuple):
    """What the rule says of a key: one row of `_Tables`, and its vertices.

    vertex : twelve bytes
    crossings, low : of each vertex, how many it has, and the sum of their lower ends
    """

    vertex: bytes
    crossings: tuple[int, ...]
    low: tuple[tuple[int, ...], ...]


@lru_cache(maxsize=1 << 15)
def _answer(rule: DualRule, key: int) -> _Answer:
    """The rule's answer for a key, kept for the next call."""
    patches = rule.patches(key & 255, bool(key >> 8 & 1), key >> 9)
    vertex = np.full(12, -1, np.int8)
    for v, patch in enumerate(patches):
        vertex[list(patch.crossings)] = v
    lower = CORNER_OFFSETS[EDGE_CORNERS[:, 0]]
    low = [lower[list(patch.crossings)].sum(axis=0).tolist() for patch in patches]
    crossings = tuple(len(patch.crossings) for patch in patches)
    return _Answer(vertex.tobytes(), crossings, tuple(map(tuple, low)))


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
        found = [_answer(rule, key) for key in keys.tolist()]
        vertex = np.frombuffer(b"".join(answer.vertex for answer in found), np.int8)
        count = np.array([len(answer.crossings) for answer in found], np.int64)
        low = np.array([low for answer in found for low in answer.low], np.int64).reshape(-1, 3)
        crossings = np.array([n for answer in found for n in answer.crossings], np.int64)
        start = np.cumsum(count) - count
        return cls(count, vertex, start, crossings, np.ascontiguousarray(low.T))


@dataclass(frozen=True)
class _Edges:
    """The crossed lattice edges of an axis, in C order of their lower ends.

    low : (E,) flat index of the lower end
    t : (E,) where they are crossed
    """

    axis: int
    low: Integers
    t: Floats


def _crossed_edges(field: Field, alpha: float, inside: Booleans) -> Iterator[_Edges]:
    """The crossed edges of each axis in turn."""
    samples = field.values.reshape(-1)
    for axis, stride in enumerate(_strides(inside.shape)):
        here = (slice(None),) * axis + (slice(None, -1),)
        there = (slice(None),) * axis + (slice(1, None),)
        crossed = np.zeros(inside.shape, np.bool_)
        np.not_equal(inside[here], inside[there], out=crossed[here])
        at = np.flatnonzero(crossed)
        low, high = (take(samples, i).astype(np.float64) - alpha for i in (at, at + stride))
        yield _Edges(axis, at, crossing_parameter(low, high))


def _strides(shape: tuple[int, ...]) -> tuple[int, int, int]:
    """From a lattice point to the next one along each axis, in flat indices."""
    return shape[1] * shape[2], shape[2], 1


def _corners(
    edges: _Edges, cells: _Cells, tables: _Tables, first: Integers, shape: tuple[int, ...]
) -> tuple[Integers, Booleans]:
    """The slots of the vertices in the four cells round each edge, (4, E); -1 for none.

    And (E,) whether there are four cells. Where one is beyond the lower border, its number is
    looked for at a point on the upper border, of the row, the plane or the volume before.
    """
    corners = np.empty((4, len(edges.low)), np.int64)
    inner = np.ones(len(edges.low), np.bool_)
    for out, (step, e) in zip(corners, ROUND[edges.axis], strict=True):
        back = int(np.dot(step, _strides(shape)))
        cell = take(cells.number, edges.low + (cells.spare - back))
        lacks = (cell < 0).nonzero()[0]
        cell[lacks] = 0
        entry = take(cells.rows, cell)
        entry *= 12
        entry += e
        vertex = take(tables.vertex, entry)
        np.add(take(first, cell), vertex, out=out)
        out[(vertex < 0).nonzero()[0]] = -1
        out[lacks] = -1
        inner[lacks] = False
    return corners, inner


def _rows(edges: _Edges, corners: Integers, inner: Booleans, inside: Booleans) -> Integers:
    """The quadrilaterals across the edges that have four cells, (Q, 4), from high to low."""
    low = edges.low
    if not inner.all():
        which = inner.nonzero()[0]
        corners, low = corners.take(which, axis=1), low.take(which)
    straight = take(inside.reshape(-1), low)
    rows = np.empty((len(low), 4), np.int64)
    rows[:, 0], rows[:, 2] = corners[0], corners[2]
    rows[:, 1] = np.where(straight, corners[1], corners[3])
    rows[:, 3] = np.where(straight, corners[3], corners[1])
    return rows


def _halves(rows: Integers) -> Integers:
    """(2 Q, 3) the triangles of quadrilaterals, as `isoref.dual.in_triangles` cuts them."""
    halves = np.empty((len(rows), 6), rows.dtype)
    halves[:, :3], halves[:, 3], halves[:, 4:] = rows[:, :3], rows[:, 0], rows[:, 2:]
    return halves.reshape(-1, 3)


def _placed(field: Field, cells: _Cells, tables: _Tables, total: Floats) -> Floats:
    """The vertices, from the sums of their crossings' parameters, (V, 3)."""
    count, kind, index = take(tables.count, cells.rows), take(tables.start, cells.rows), cells.index
    if not (count == 1).all():
        nth = np.arange(total.shape[1]) - np.repeat(np.cumsum(count) - count, count)
        kind = np.repeat(kind, count) + nth
        index = tuple(np.repeat(one, count) for one in index)
    crossings = take(tables.crossings, kind)
    places, straight = np.empty((len(kind), 3)), field.directions is None
    for axis in range(3):
        place = take(tables.low[axis], kind) + total[axis]
        place /= crossings
        place += index[axis]
        if straight and field.spacing[axis] != 1:
            place *= field.spacing[axis]
        if straight and field.origin[axis] != 0:
            place += field.origin[axis]
        places[:, axis] = place
    return places if straight else field.position(places)
