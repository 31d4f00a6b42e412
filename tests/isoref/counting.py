"""Exact counts of half-edges and of fans, for triangles and quadrilaterals."""

from collections import Counter
from typing import NamedTuple

import numpy as np
from isoref.field import Booleans, Integers
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components


class Edges(NamedTuple):
    """The edges of a mesh of polygons.

    ends : (E, 2) vertices, the lower first
    forth, back : (E,) how many polygons pass the edge upwards and downwards
    """

    ends: Integers
    forth: Integers
    back: Integers

    @property
    def crowded(self) -> Integers:
        """The ends of edges with more than two polygons."""
        return np.asarray(self.ends[self.forth + self.back > 2])

    @property
    def one_sided(self) -> Integers:
        """The ends of edges that are not passed as often forth as back."""
        return np.asarray(self.ends[self.forth != self.back])


def edges(rows: Integers) -> Edges:
    """The edges of polygons given as rows of vertices."""
    start, end = rows.ravel(), np.roll(rows, -1, axis=1).ravel()
    pairs, which = np.unique(
        np.sort(np.stack([start, end], axis=1), axis=1), axis=0, return_inverse=True
    )
    upwards = np.bincount(which.ravel()[start < end], minlength=len(pairs))
    downwards = np.bincount(which.ravel()[start > end], minlength=len(pairs))
    return Edges(pairs, upwards, downwards)


def fans(rows: Integers, vertices: int) -> Integers:
    """Into how many fans the polygons round each vertex fall, (V,); 0 for one that is not used."""
    count, size = rows.shape
    corner = np.arange(count * size).reshape(count, size)
    following = np.roll(corner, -1, axis=1).ravel()
    start, end = rows.ravel(), rows.ravel()[following]
    key = np.minimum(start, end) * vertices + np.maximum(start, end)
    # Two polygons at an edge link their corners at its lower end, and those at its upper end.
    low = np.where(start < end, corner.ravel(), following)
    high = np.where(start < end, following, corner.ravel())
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(key[order][1:] == key[order][:-1])
    first, second = order[same], order[same + 1]
    links = np.concatenate(
        [np.stack([low[first], low[second]]), np.stack([high[first], high[second]])], axis=1
    )
    graph = coo_array((np.ones(links.shape[1]), links), shape=(count * size,) * 2)
    _, piece = connected_components(graph, directed=False)
    found = Counter(rows.ravel()[np.unique(piece, return_index=True)[1]].tolist())
    return np.array([found[v] for v in range(vertices)])


def in_cells(cells: Integers, shape: tuple[int, ...]) -> Booleans:
    """Which cells, (C, 3), are in the border layer of the lattice."""
    return np.asarray(((cells == 0) | (cells == np.array(shape) - 2)).any(axis=1))
