"""What is true of a mesh of k-simplices in R^d, for any k and d, counted from its arrays.

Glossary
--------
k, d        dimension of the simplices and of the space
facet       a (k-1)-face of a k-simplex, k of its vertices
owners      number of simplices a facet belongs to
box         the block of space that the lattice fills; its faces are the border
covered     a facet whose centroid lies on another facet that is also open

A facet of a closed complex away from the border has two owners of opposite orientation. Where it
has one, it is *open*. Two kinds of open facets are told apart: at a hole nothing is on the other
side; where two simplices met a common face and cut it differently, each open facet is covered by
open facets of the other cut. The second kind leaves no gap in space, but no complex either.

Nothing here knows how the mesh was made.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from math import factorial

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Booleans = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Facets:
    """The distinct facets of a mesh.

    Attributes
    ----------
    rows : (F, k) vertices, sorted
    owners : (F,) simplices each belongs to
    balance : (F,) sum of the orientations its simplices give it; 0 where two of them agree
    """

    rows: Integers
    owners: Integers
    balance: Integers


def facets(simplices: Integers) -> Facets:
    """The facets of oriented simplices, with their owners.

    >>> facets(np.array([[0, 1, 2], [0, 2, 3]])).owners.tolist()
    [1, 2, 1, 1, 1]
    """
    k = simplices.shape[1] - 1
    parity = permutation_parity(simplices)
    ordered = np.sort(simplices, axis=1)
    rows = np.concatenate([np.delete(ordered, i, axis=1) for i in range(k + 1)])
    given = np.concatenate([parity * (-1) ** i for i in range(k + 1)])
    example, where = distinct_rows(rows)
    owners = np.bincount(where, minlength=len(example))
    balance = np.bincount(where, given, len(example)).astype(np.int64)
    return Facets(rows[example], owners, balance)


def distinct_rows(rows: Integers) -> tuple[Integers, Integers]:
    """Where each distinct row occurs first, and for each row which distinct one it is.

    >>> [part.tolist() for part in distinct_rows(np.array([[1, 2], [0, 5], [1, 2]]))]
    [[1, 0], [1, 0, 1]]
    """
    where = np.zeros(len(rows), np.int64)
    for column in rows.T:
        where = np.unique(where * (rows.max(initial=0) + 1) + column, return_inverse=True)[1]
    example = np.unique(where, return_index=True)[1]
    return example, where


def permutation_parity(rows: Integers) -> Integers:
    """+1 or -1 for each row: the parity of the permutation that sorts it.

    >>> permutation_parity(np.array([[2, 0, 1], [1, 0, 2]])).tolist()
    [1, -1]
    """
    swaps = np.zeros(len(rows), np.int64)
    for i, j in combinations(range(rows.shape[1]), 2):
        swaps += rows[:, i] > rows[:, j]
    return 1 - 2 * (swaps % 2)


def on_border(vertices: Floats, rows: Integers, box: Sequence[Sequence[float]]) -> Booleans:
    """Which rows of vertices lie in one of the faces of the box (lowest, highest corner)."""
    low, high = np.asarray(box, np.float64)
    slack = 1e-9 * (high - low).max()
    place = vertices[rows]
    at_low = (abs(place - low) <= slack).all(axis=1)
    at_high = (abs(place - high) <= slack).all(axis=1)
    return np.asarray((at_low | at_high).any(axis=1))


def open_facets(vertices: Floats, simplices: Integers, box: Sequence[Sequence[float]]) -> Integers:
    """The facets (F, k) with one owner away from the border."""
    found = facets(simplices)
    alone = found.rows[found.owners == 1]
    return np.asarray(alone[~on_border(vertices, alone, box)])


def covered(vertices: Floats, rows: Integers) -> Booleans:
    """Which of these facets have their centroid on another one of them."""
    out = np.zeros(len(rows), bool)
    if not len(rows):
        return out
    place = vertices[rows]
    centroid = place.mean(axis=1)
    low, high = place.min(axis=1), place.max(axis=1)
    radius = np.linalg.norm(place - centroid[:, None], axis=2).max(axis=1) * (1 + 1e-9)
    near = cKDTree(centroid).query_ball_point(centroid, radius)
    other = np.repeat(np.arange(len(rows)), [len(found) for found in near])
    own = np.concatenate([np.asarray(found, np.int64) for found in near])
    slack = 1e-9 * radius[other, None]
    boxed = (low[other] - slack <= centroid[own]) & (centroid[own] <= high[other] + slack)
    pairs = np.flatnonzero(boxed.all(axis=1) & (own != other))
    hit = contain(place[other[pairs]], centroid[own[pairs]])
    out[own[pairs[hit]]] = True
    return out


def contain(corners: Floats, points: Floats, slack: float = 1e-7) -> Booleans:
    """Whether each simplex, corners (P, k, d), contains its point (P, d), up to rounding.

    >>> contain(np.array([[[0.0, 0.0], [2.0, 0.0]]]), np.array([[1.0, 0.0]])).tolist()
    [True]
    """
    scale = abs(corners - corners[:, :1]).max(axis=(1, 2), initial=1e-300)
    edges = (corners[:, 1:] - corners[:, :1]) / scale[:, None, None]
    offset = (points - corners[:, 0]) / scale[:, None]
    weights = (offset[:, None] @ np.linalg.pinv(edges))[:, 0]
    flat = abs((weights[:, None] @ edges)[:, 0] - offset).max(axis=1) <= slack
    return np.asarray(flat & (weights >= -slack).all(axis=1) & (weights.sum(axis=1) <= 1 + slack))


def joined(vertices: Floats, simplices: Integers, slack: float) -> tuple[Floats, Integers]:
    """Vertices within `slack` of each other made one, without the simplices that collapse by it.

    What was closed before, counted by two, is closed after it.

    >>> joined(np.array([[0.0], [1.0], [1 + 1e-9]]), np.array([[0, 1], [1, 2]]), 1e-6)[1].tolist()
    [[0, 1]]
    """
    distinct, where = np.unique(vertices, axis=0, return_inverse=True)
    i, j = cKDTree(distinct).query_pairs(slack, output_type="ndarray").T
    near = coo_array((np.ones(len(i)), (i, j)), (len(distinct), len(distinct)))
    cluster = connected_components(near, directed=False)[1]
    rows = cluster[where.ravel()][simplices]
    ordered = np.sort(rows, axis=1)
    whole = (ordered[:, 1:] != ordered[:, :-1]).all(axis=1)
    return distinct[np.unique(cluster, return_index=True)[1]], rows[whole]


def euler_characteristic(simplices: Integers) -> int:
    """Vertices minus edges plus triangles minus .., over the faces that occur.

    >>> euler_characteristic(np.array([[0, 1], [1, 2], [2, 0]]))
    0
    """
    total = 0
    for size in range(1, simplices.shape[1] + 1):
        subsets = combinations(range(simplices.shape[1]), size)
        rows = np.concatenate([np.sort(simplices[:, list(subset)], axis=1) for subset in subsets])
        total += (-1) ** (size - 1) * len(distinct_rows(rows)[0])
    return total


def components(simplices: Integers) -> int:
    """The number of connected pieces, simplices joined where they share a vertex.

    >>> components(np.array([[0, 1], [1, 2], [3, 4]]))
    2
    """
    used, flat = np.unique(simplices, return_inverse=True)
    rows = flat.reshape(simplices.shape)
    pairs = np.concatenate([rows[:, [0, i]] for i in range(simplices.shape[1])])
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), (len(used), len(used)))
    return int(connected_components(graph, directed=False)[0]) if len(used) else 0


def measures(vertices: Floats, simplices: Integers) -> Floats:
    """The k-dimensional volume of each simplex, by the Gram determinant.

    >>> measures(np.array([[0.0, 0, 0], [3, 0, 0], [0, 4, 0]]), np.array([[0, 1, 2]])).tolist()
    [6.0]
    """
    k = simplices.shape[1] - 1
    place = vertices[simplices]
    edges = place[:, 1:] - place[:, :1]
    gram = np.linalg.det(edges @ edges.transpose(0, 2, 1))
    return np.asarray(np.sqrt(np.maximum(gram, 0)) / factorial(k))


def signed_volume(vertices: Floats, simplices: Integers) -> float:
    """The volume that a closed oriented hypersurface (k = d - 1) encloses.

    It is positive where normals, det(normal, t_1, .., t_k) > 0, point outward.

    >>> square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    >>> signed_volume(square, np.array([[0, 1], [1, 2], [2, 3], [3, 0]]))
    1.0
    """
    place = vertices[simplices] - vertices.mean(axis=0)
    return float(np.linalg.det(place).sum() / factorial(vertices.shape[1]))
