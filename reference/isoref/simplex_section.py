r"""The section of a simplex by a hyperplane, cut into simplices.

Let psi be linear on an n-simplex, negative at p of its vertices and positive at q = n + 1 - p.
The hyperplane psi = 0 crosses the p q edges that join the two kinds, and the section is their
convex hull. It looks like a product of a (p-1)-simplex and a (q-1)-simplex, whatever the values
are::

    type (1, 3)   triangle          type (2, 2)   quadrilateral   02 ---- 12
    cut in 1                        cut in 2, along a diagonal     |    /  |
                                                                   |  /    |
                                                                  03 ---- 13

To cut it into simplices is to choose one table for each type (p, q). Three kinds of table are
here. They cover the same points; what sets them apart is whether two n-simplices that share a
facet cut the section of that facet alike:

`staircase`  simplices are the paths that climb from (0, 0) to (p-1, q-1). Facets of such a
             table are again such tables: neighbours always agree.
`printed`    Tables 1 to 4 of Min. Row (3, 3) of Table 4 disagrees with rows (3, 2) and (4, 2).
`delaunay`   made as section 3 says, by a Delaunay triangulation of one section of each type.

Glossary
--------
S, H            the n-simplex and the hyperplane
p, q            numbers of negative and positive vertices of S
i, j            a negative and a positive vertex, counted from 0 among their kind, in the order
                of S; printed tables count v_1 .. v_(n+1) through both kinds, negative first
v_ij            point of H on the edge from i to j (equation 2)
code            signs of a simplex: bit k is set where vertex k is positive
w_0 .. w_(n-1)  vertices of a simplex of the section

Invariants
----------
Every table for (p, q) has (p+q-2)! / ((p-1)! (q-1)!) rows (corollary 3.2). Vertices of a row
stand in increasing order of the pair (lower vertex, higher vertex) of their edges: the order of
S is handed on, so that a section can be cut by the next hyperplane.

Zeros: a vertex where psi is 0 counts as positive, as if psi were raised by an infinitesimal
there. No number is changed: v_ij then falls on the vertex j, some simplices of the section lie
flat, and their combinatorics stay those of a generic section. `with_epsilon` is the paper's way:
it writes a small positive number instead.

References
----------
1. C. Min, 2003: section 3, equation 2, Tables 1 to 4, theorem 3.1, corollary 3.2.
2. M. Haiman, "A simple and relatively efficient triangulation of the n-cube", Discrete Comput.
   Geom. 6, 1991.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from math import comb

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import Delaunay

from isoref.field import Floats, Integers

Rule = Callable[[int, int], Integers]
Row = frozenset[tuple[int, int]]

# Min's tables, letter for letter: an edge v_ij is printed as the digits ij, one row a simplex.
PRINTED: dict[tuple[int, int], tuple[str, ...]] = {
    (2, 1): ("13 23",),
    (3, 1): ("14 24 34",),
    (2, 2): ("13 23 14", "14 23 24"),
    (4, 1): ("15 25 35 45",),
    (3, 2): ("14 15 34 24", "15 24 25 34", "15 25 35 34"),
    (5, 1): ("16 26 36 56 46",),
    (4, 2): ("15 16 25 45 35", "16 25 26 35 45", "16 26 35 45 36", "16 26 36 45 46"),
    (3, 3): (
        "14 15 16 36 25",
        "14 15 25 36 35",
        "14 16 25 26 36",
        "14 24 25 34 26",
        "14 25 26 36 34",
        "14 25 34 36 35",
    ),
}


def section_types(n: int) -> list[tuple[int, int]]:
    """The [(n+1)/2] types (p, q) of a section of an n-simplex with p >= q >= 1.

    >>> section_types(5)
    [(5, 1), (4, 2), (3, 3)]
    """
    return [(n + 1 - q, q) for q in range(1, (n + 1) // 2 + 1)]


def haiman_count(p: int, q: int) -> int:
    """How many simplices every triangulation of a section of type (p, q) has (corollary 3.2).

    >>> haiman_count(3, 3), haiman_count(4, 2)
    (6, 4)
    """
    return comb(p + q - 2, p - 1)


@cache
def staircase(p: int, q: int) -> Integers:
    """Rows of pairs (i, j) that climb from (0, 0) to (p-1, q-1) by one step in i or in j.

    Shape (haiman_count, p+q-1, 2).

    >>> staircase(2, 2).tolist()
    [[[0, 0], [1, 0], [1, 1]], [[0, 0], [0, 1], [1, 1]]]
    """
    steps = p + q - 2
    rows = []
    for in_i in itertools.combinations(range(steps), p - 1):
        i = np.cumsum([0, *(int(step in in_i) for step in range(steps))])
        rows.append(np.stack([i, np.arange(steps + 1) - i], axis=1))
    return np.array(rows, np.int64)


@cache
def printed(p: int, q: int) -> Integers:
    """Min's table for (p, q), or for (q, p) with the roles of the signs exchanged.

    Raises
    ------
    ValueError
        for types that are not printed (p + q > 6).

    >>> printed(2, 2).tolist()
    [[[0, 0], [1, 0], [0, 1]], [[0, 1], [1, 0], [1, 1]]]
    """
    if p < q:
        return printed(q, p)[:, :, ::-1]
    if (p, q) == (1, 1):
        return np.zeros((1, 1, 2), np.int64)
    if (p, q) not in PRINTED:
        raise ValueError(f"the paper prints no table for ({p}, {q}); use 'staircase'")
    rows = [[[int(d) for d in edge] for edge in row.split()] for row in PRINTED[p, q]]
    table: Integers = np.array(rows, np.int64) - np.array([1, p + 1])
    return table


@cache
def delaunay(p: int, q: int) -> Integers:
    """A table made by the Delaunay triangulation of one generic section of type (p, q).

    The symmetric section psi = -1, +1 has all its points on one sphere, so that its Delaunay
    triangulation is not unique. The section used here has psi(v_k) = -1 - k/8 on the negative
    and 1 + (k+1)^2/16 on the positive vertices of a regular simplex; there it is.

    >>> len(delaunay(3, 3))
    6
    """
    if p == 1 or q == 1:
        return staircase(p, q)
    negative = -1 - np.arange(p) / 8
    positive = 1 + np.arange(1, q + 1) ** 2 / 16
    pairs = np.array(list(itertools.product(range(p), range(q))), np.int64)
    vertices = np.eye(p + q)
    i, j = pairs.T
    points = crossing(vertices[i], vertices[p + j], negative[i], positive[j])
    centred = points - points.mean(axis=0)
    axes = np.linalg.svd(centred)[2][: p + q - 2]
    return np.asarray(pairs[Delaunay(centred @ axes.T).simplices])


def induced(rule: str, p: int, q: int, kind: int, dropped: int) -> set[Row]:
    """The rows that the table of (p, q) leaves on the facet of S opposite one vertex.

    The vertex is number `dropped` among the negative (kind 0) or the positive ones (kind 1).

    >>> sorted(map(sorted, induced("staircase", 2, 2, kind=1, dropped=0)))
    [[(0, 0), (1, 0)]]
    """
    rows = set()
    for pairs in RULES[rule](p, q).tolist():
        kept = [pair for pair in pairs if pair[kind] != dropped]
        if len(kept) == len(pairs) - 1:
            for pair in kept:
                pair[kind] -= pair[kind] > dropped
            rows.add(frozenset((i, j) for i, j in kept))
    return rows


def disagreements(rule: str, n: int) -> tuple[int, int]:
    """Of all pairs of facets of n-simplices with equal signs, how many are cut unlike; and all.

    Two n-simplices may share a facet as any vertex of either: a rule without disagreements makes
    a simplicial complex of every section, a rule with some makes only a union of simplices.

    >>> disagreements("staircase", 5), disagreements("printed", 4)
    ((0, 84), (0, 45))
    """
    facets: dict[tuple[int, int], list[set[Row]]] = {}
    for p in range(1, n + 1):
        for kind, count in ((0, p), (1, n + 1 - p)):
            for dropped in range(count if count > 1 else 0):
                kept = (p - 1, n + 1 - p) if kind == 0 else (p, n - p)
                facets.setdefault(kept, []).append(induced(rule, p, n + 1 - p, kind, dropped))
    pairs = [pair for cuts in facets.values() for pair in itertools.combinations(cuts, 2)]
    return sum(a != b for a, b in pairs), len(pairs)


def crossing(v_i: ArrayLike, v_j: ArrayLike, psi_i: ArrayLike, psi_j: ArrayLike) -> Floats:
    """The points v_ij where psi = 0 on the edges from v_i (psi < 0) to v_j (psi >= 0).

    Equation 2, in a form that is exact where psi_j is 0 and never leaves the edge.

    Parameters
    ----------
    v_i, v_j : (.., d) ends
    psi_i, psi_j : (..) values there

    >>> crossing([[0.0, 1.0]], [[4.0, 1.0]], [-1.0], [3.0]).tolist()
    [[1.0, 1.0]]
    """
    low, high = np.asarray(v_i, np.float64), np.asarray(v_j, np.float64)
    negative, positive = np.asarray(psi_i, np.float64), np.asarray(psi_j, np.float64)
    t = (negative / (negative - positive))[..., None]
    return np.asarray(np.where(t < 1, low + t * (high - low), high))


def with_epsilon(psi: ArrayLike, epsilon: float) -> Floats:
    """Values with each exact zero replaced by `epsilon`, the paper's way with H through a vertex.

    Raises
    ------
    ValueError
        for an epsilon that is not positive.

    >>> with_epsilon([0.0, -2.0], 1e-6).tolist()
    [1e-06, -2.0]
    """
    if not 0 < epsilon < np.inf:
        raise ValueError(f"epsilon {epsilon} must be a small positive number")
    values = np.asarray(psi, np.float64)
    return np.where(values == 0, epsilon, values)


RULES: dict[str, Rule] = {"staircase": staircase, "printed": printed, "delaunay": delaunay}


@dataclass(frozen=True, eq=False)
class SectionTable:
    """How the section of a k-simplex with given signs is cut.

    Attributes
    ----------
    negatives, positives : positions of the vertices of either sign, p and q of them
    rows : (T, k) numbers i * q + j of the edges v_ij, in the handed-on order
    signs : (T,) orientation of each row; +1 where (outward, w_0, .., w_(k-1)) is oriented like
        the simplex, outward being the way from positive to negative
    """

    negatives: Integers
    positives: Integers
    rows: Integers
    signs: Integers


@cache
def section_table(rule: str, k: int, code: int) -> SectionTable:
    """The table of `rule` for a k-simplex whose vertices are positive where `code` has bits.

    Raises
    ------
    ValueError
        where all signs are equal: the hyperplane misses the simplex.

    >>> section_table("staircase", 2, 0b100).rows.tolist()
    [[0, 1]]
    """
    bits = code >> np.arange(k + 1) & 1
    negatives, positives = np.flatnonzero(bits == 0), np.flatnonzero(bits == 1)
    p, q = len(negatives), len(positives)
    if p == 0 or q == 0:
        raise ValueError(f"code {code} has vertices of one sign only")
    pairs = RULES[rule](p, q)
    edges = np.stack([negatives[pairs[..., 0]], positives[pairs[..., 1]]], axis=-1)
    order = np.argsort(edges.min(axis=-1) * (k + 1) + edges.max(axis=-1), axis=1)
    pairs = np.take_along_axis(pairs, order[..., None], axis=1)
    edges = np.take_along_axis(edges, order[..., None], axis=1)
    rows = pairs[..., 0] * q + pairs[..., 1]
    return SectionTable(negatives, positives, rows, _orientations(edges, k))


def _orientations(edges: Integers, k: int) -> Integers:
    """Signs of rows of edges (T, k, 2), (negative, positive), of the simplex 0, e_1, .., e_k.

    The section halfway, psi = -1 and +1, stands for all: a row never falls flat while the signs
    stay, so its orientation cannot change.
    """
    vertices = np.vstack([np.zeros((1, k), np.int64), np.eye(k, dtype=np.int64)])
    outward = vertices[edges[:, 0, 0]] - vertices[edges[:, 0, 1]]
    doubled = vertices[edges].sum(axis=2)
    frame = np.concatenate([outward[:, None], doubled[:, 1:] - doubled[:, :1]], axis=1)
    determinants: Floats = np.linalg.det(frame.astype(np.float64))
    return np.sign(np.rint(determinants)).astype(np.int64)
