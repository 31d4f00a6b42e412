"""The truth about a whole field: the trilinear level set of each cell, glued over the grid.

The level set is cut into open cells, faces and edges of the lattice. Neighbouring cells agree on
the face they share, since the interpolant on it depends on its four samples only; so sheets are
joined by the lattice edges they cross, and nothing else need be known.

Glossary
--------
sheet       component of the level set in a cell, named by the parts on its two sides
arc         component of the level set on a face
crossed     a lattice edge with samples on both sides
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from isograde.oracles.bounded import Ints, Numbers
from isograde.oracles.trilinear import EDGES, FACES, NONE, Truths, cells


@dataclass(frozen=True)
class GridTruth:
    """The topology of the level set over a grid of cells; nothing holds where `ties` is not 0.

    components, euler, curves : of the level set, curves being those on the grid's skin
    ties : number of cells in which no single truth exists
    """

    components: int
    euler: int
    curves: int
    ties: int


def active_cells(values: ArrayLike, isovalue: float) -> tuple[Ints, Numbers]:
    """Indices (m, 3) and values (m, 2, 2, 2) of the cells with corners on both sides or on it."""
    samples = np.asarray(values)
    windows = np.lib.stride_tricks.sliding_window_view(samples, (2, 2, 2))
    some = _any_corner(samples >= isovalue) & _any_corner(samples <= isovalue)
    index = np.argwhere(some)
    return index, windows[tuple(index.T)]


def _any_corner(flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether any of a cell's corners is set, for every cell."""
    for axis in range(3):
        low = [slice(None)] * 3
        high = [slice(None)] * 3
        low[axis], high[axis] = slice(None, -1), slice(1, None)
        flags = flags[tuple(low)] | flags[tuple(high)]
    return flags


def grid(values: ArrayLike, isovalue: float = 0.0) -> GridTruth:
    """The truth about a whole (N0, N1, N2) field, glued from its cells.

    The level set is cut into open cells, faces and edges of the lattice. Its Euler
    characteristic is the sum over cells, less one for each arc on a face, plus one for each
    crossed edge. Its components are those of the graph of sheets and crossed edges.

    >>> v = np.full((3, 3, 3), -1.0); v[1, 1, 1] = 1
    >>> grid(v)
    GridTruth(components=1, euler=2, curves=0, ties=0)
    """
    samples = np.asarray(values)
    index, corners = active_cells(samples, isovalue)
    truths = cells(corners, isovalue)
    ties = int((truths.ties != NONE).sum())
    if ties:
        return GridTruth(0, 0, 0, ties)
    sheets, crossed = _incidence(index, truths.high, truths.body, samples.shape, range(12))
    components = _components(sheets, crossed)
    euler = int(truths.euler.sum()) - _arcs(samples > isovalue) + len(np.unique(crossed))
    return GridTruth(components, euler, _skin_curves(index, truths, samples.shape), 0)


def _incidence(
    index: Ints, high: NDArray[np.bool_], names: Ints, shape: tuple[int, ...], edges: Any
) -> tuple[Ints, Ints]:
    """(sheet of a cell, lattice edge) for each crossed cell edge among `edges`.

    A sheet is named by its cell and the parts on its two sides.
    """
    cell = np.ravel_multi_index(tuple(index.T), shape)
    sheets, crossed = [], []
    for edge in edges:
        a, b = EDGES[edge]
        here = high[:, a] != high[:, b]
        upper = np.where(high[:, a], names[:, a], names[:, b])
        lower = np.where(high[:, a], names[:, b], names[:, a])
        offset = np.array([a >> 2 & 1, a >> 1 & 1, a & 1])
        axis = 2 - (a ^ b).bit_length() + 1
        start = np.ravel_multi_index(tuple((index + offset).T), shape)
        sheets.append((cell * 64 + upper * 8 + lower)[here])
        crossed.append((start * 3 + axis)[here])
    return np.concatenate(sheets), np.concatenate(crossed)


def _components(left: Ints, right: Ints) -> int:
    """Number of components of the bipartite graph with these edges."""
    if not len(left):
        return 0
    a, i = np.unique(left, return_inverse=True)
    b, j = np.unique(right, return_inverse=True)
    n = len(a) + len(b)
    graph = coo_array((np.ones(len(i), bool), (i, j + len(a))), shape=(n, n))
    number, _ = connected_components(graph, directed=False)
    return int(number)


def _arcs(high: NDArray[np.bool_]) -> int:
    """Number of arcs of the level set on all lattice faces: half the crossed edges of each."""
    total = 0
    for axis in range(3):
        b, c = (x for x in range(3) if x != axis)
        flags = np.moveaxis(high, (b, c), (0, 1))
        along = (flags[1:] != flags[:-1], flags[:, 1:] != flags[:, :-1])
        total += int(along[0][:, :-1].sum() + along[0][:, 1:].sum())
        total += int(along[1][:-1].sum() + along[1][1:].sum())
    return total // 2


def _skin_curves(index: Ints, truths: Truths, shape: tuple[int, ...]) -> int:
    """Number of closed curves in which the level set meets the skin of the grid."""
    arcs, crossed = [], []
    for face, corners in enumerate(FACES):
        axis, side = divmod(face, 2)
        layer = index[:, axis] == (shape[axis] - 2 if side else 0)
        names = _face_parts(truths.high[layer], truths.faces[layer, face], corners)
        edges = [e for e, (a, b) in enumerate(EDGES) if a in corners and b in corners]
        arc, edge = _incidence(index[layer], truths.high[layer], names, shape, edges)
        arcs.append(arc * 6 + face)
        crossed.append(edge)
    return _components(np.concatenate(arcs), np.concatenate(crossed))


def _face_parts(high: NDArray[np.bool_], joined: Ints, corners: tuple[int, ...]) -> Ints:
    """(n, 8) names of the parts of one face its corners are in; those of others mean nothing."""
    names = high.astype(np.int64)
    a, b, c, d = corners
    for first, second in ((a, d), (b, c)):
        apart = (joined != 0) & (joined != np.where(high[:, first], 1, -1))
        names[:, second] = np.where(apart, 2, names[:, second])
    return names
