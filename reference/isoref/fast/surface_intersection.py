"""Surface intersection, vectorised: the segments and curves of `isoref.surface_intersection`.

All pairs of triangles that share a voxel are listed and tested at once. Signs are those of exact
arithmetic all the same: floating-point numbers decide where their error bound [1] lets them, and
rational arithmetic decides the rest.

References
----------
[1] J. R. Shewchuk, Adaptive precision floating-point arithmetic, 1997: the bound of `orientation`.
[2] P. Guigue, O. Devillers, Fast and robust triangle-triangle overlap test using orientation
    predicates, J. Graphics Tools 8, 2003: order on the common line by signs of tetrahedra.
[3] G. L. Steele, D. Lea, C. H. Flood, Fast splittable pseudorandom number generators, 2014.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from isoref import asymptotic_decider
from isoref import surface_intersection as article
from isoref.curves import Curve, check_pair, follow
from isoref.fast.sweep import sweep
from isoref.field import Array, Booleans, Field, Floats, Integers
from isoref.rule import Rule
from isoref.surface_intersection import IndexedSurface, Segments, curves_along, rational


def enhanced_marching_cubes(
    field: Field, isovalue: float, rule: Rule = asymptotic_decider.RULE
) -> IndexedSurface:
    """The rule's surface with I_T; see `isoref.surface_intersection.enhanced_marching_cubes`."""
    mesh = sweep(rule, field, isovalue, provenance=True)
    return IndexedSurface(mesh, mesh.traced().cells, tuple(max(n - 1, 0) for n in field.shape))


def candidate_pairs(first: IndexedSurface, second: IndexedSurface) -> tuple[Integers, Integers]:
    """Indices (i, j) of all pairs of triangles in one voxel, in the order of table 2.

    Raises
    ------
    ValueError
        for surfaces of different lattices.
    """
    if first.shape != second.shape:
        raise ValueError(f"surfaces of {first.shape} and {second.shape} voxels share no voxels")
    partners = second.count_in(first.cells)
    i = np.repeat(np.arange(len(first.cells)), partners)
    start = second.count_through(first.cells - 1) - (np.cumsum(partners) - partners)
    return i, np.arange(len(i)) + np.repeat(start, partners)


def surface_intersection(first: IndexedSurface, second: IndexedSurface) -> Segments:
    """The segments of table 2; see `isoref.surface_intersection.surface_intersection`."""
    i, j = candidate_pairs(first, second)
    tests = len(i)
    a, b = (s.mesh.vertices[s.mesh.simplices[t]] for s, t in ((first, i), (second, j)))
    # Keep pairs of which each triangle has corners on both sides of the other's plane.
    signs_a = signs_beside(b, a)
    alive = np.flatnonzero(_mixed(signs_a > 0))
    i, j, a, b, signs_a = i[alive], j[alive], a[alive], b[alive], signs_a[alive]
    signs_b = signs_beside(a, b)
    alive = np.flatnonzero(_mixed(signs_b > 0))
    i, j, a, b, signs_a = i[alive], j[alive], a[alive], b[alive], signs_a[alive]
    signs_b = signs_b[alive]
    entry_a, exit_a = _passages(signs_a > 0)
    exit_b, entry_b = _passages(signs_b > 0)

    # Order entries and exits along D; keep pairs whose intervals overlap.
    def order(edge_a: Integers, edge_b: Integers) -> Integers:
        return orientation(_edge(a, edge_a), _edge(b, edge_b))

    alive = np.flatnonzero((order(entry_a, exit_b) > 0) & (order(exit_a, entry_b) < 0))
    starts, stops = order(entry_a, entry_b), -order(exit_a, exit_b)
    sides = (_Side(first, i, a, b, signs_a), _Side(second, j, b, a, signs_b))
    ends, keys = zip(
        *(
            _nodes(sides, edge_a, edge_b, later)
            for edge_a, edge_b, later in ((entry_a, entry_b, starts), (exit_a, exit_b, stops))
        ),
        strict=True,
    )
    nodes = names_of_rows(np.stack(keys, axis=1)[alive].reshape(-1, 4))
    return Segments(
        np.stack(ends, axis=1)[alive],
        nodes.reshape(-1, 2),
        first.cells[i[alive]],
        tests,
    )


@dataclass(frozen=True, eq=False)
class _Side:
    """One surface's triangles of the pairs, with corners `own`, and those they meet.

    `signs` says where each corner is: in front of the other's plane, in it, or behind.
    """

    surface: IndexedSurface
    triangles: Integers
    own: Floats
    other: Floats
    signs: Integers

    def name(self, edge: Integers) -> Integers:
        """(P, 2) the two ends of edge `edge` of each triangle, by name, ascending."""
        ends = np.stack([edge, (edge + 1) % 3], axis=1)
        return np.sort(np.take_along_axis(self.corners, ends, axis=1), axis=1)

    @cached_property
    def corners(self) -> Integers:
        """(P, 3) names of the corners; vertices at one place, on different edges, share one."""
        used, inverse = np.unique(
            self.surface.mesh.simplices[self.triangles].reshape(-1), return_inverse=True
        )
        # Adding zero makes negative zeros positive.
        places = self.surface.mesh.vertices[used] + 0.0
        _, names = np.unique(places, axis=0, return_inverse=True)
        return np.asarray(names.reshape(-1)[inverse.reshape(-1)].reshape(-1, 3))

    def crossing(self, edge: Integers) -> tuple[Floats, Booleans]:
        """(P, 3) where the edge meets the plane of the other, and whether a corner stands there."""
        ends = _edge(self.own, edge)
        normal = np.cross(self.other[:, 1] - self.other[:, 0], self.other[:, 2] - self.other[:, 0])
        level = np.take_along_axis(self.signs, np.stack([edge, (edge + 1) % 3], axis=1), axis=1)
        height = np.einsum("pij,pj->pi", ends - self.other[:, :1], normal)
        # Start from the nearer end, so that an end exactly in the plane is met exactly.
        near = np.where(level == 0, -1.0, np.abs(height)).argmin(axis=1)
        rows = np.arange(len(near))
        in_plane = level[rows, near] == 0
        low, high = np.where(in_plane, 0, height[rows, near]), height[rows, 1 - near]
        t = np.divide(low, low - high, out=np.zeros_like(low), where=low != high)
        p, q = ends[rows, near], ends[rows, 1 - near]
        return p + np.clip(t, 0, 1)[:, None] * (q - p), in_plane


def _nodes(
    sides: tuple[_Side, _Side], edge_a: Integers, edge_b: Integers, later: Integers
) -> tuple[Floats, Integers]:
    """Places (P, 3) and keys (P, 4) of the ends of segments.

    `later` is positive where the edge of the first surface makes the end, negative where that of
    the second does, and 0 where both meet there. A key is the edge of the first surface, or its
    triangle and -1, then the same of the second.
    """
    keys, places, corners = [], [], []
    for side, edge, is_node in zip(sides, (edge_a, edge_b), (later >= 0, later <= 0), strict=True):
        triangle = np.stack([side.triangles, np.full(len(edge), -1)], axis=1)
        keys.append(np.where(is_node[:, None], side.name(edge), triangle))
        place, corner = side.crossing(edge)
        places.append(place)
        corners.append(corner)
    of_first = (later > 0) | ((later == 0) & ~corners[1])
    return np.where(of_first[:, None], *places), np.concatenate(keys, axis=1)


def _mixed(front: Booleans) -> Booleans:
    """Which triangles have corners in front of and behind a plane."""
    return np.asarray(front.any(axis=1) & ~front.all(axis=1))


def _passages(front: Booleans) -> tuple[Integers, Integers]:
    """The edges (corner e to e + 1) that go from behind to the front, and back."""
    ahead = np.roll(front, -1, axis=1)
    return (~front & ahead).argmax(axis=1), (front & ~ahead).argmax(axis=1)


def _edge(corners: Floats, edge: Integers) -> Floats:
    """(P, 2, 3) the ends of edge `edge` of each triangle (P, 3, 3)."""
    which = np.stack([edge, (edge + 1) % 3], axis=1)
    return np.take_along_axis(corners, which[..., None], axis=1)


def signs_beside(triangles: Floats, points: Floats) -> Integers:
    """(P, 3) for each of three points (P, 3, 3): 1 in front of a triangle's plane, 0 in it, -1."""
    signs = [
        orientation(triangles[:, :2], np.stack([triangles[:, 2], points[:, c]], axis=1))
        for c in range(3)
    ]
    return np.stack(signs, axis=1)


def orientation(first: Floats, second: Floats) -> Integers:
    """(P,) exact sign of ``det[b - a, c - a, d - a]``, a, b of `first`, c, d of `second`.

    Each is (P, 2, 3). Where floating-point arithmetic cannot vouch for the sign [1], rational
    arithmetic finds it.
    """
    a, b, c, d = first[:, 0], first[:, 1], second[:, 0], second[:, 1]
    det, error = _determinant(b - a, c - a, d - a)
    sign = np.sign(det).astype(np.int64)
    unsure = np.flatnonzero((np.abs(det) <= error) & (error > 0))
    equal = np.zeros(len(unsure), bool)
    for p, q in itertools.combinations((a, b, c, d), 2):
        equal |= (p[unsure] == q[unsure]).all(axis=1)
    sign[unsure[equal]] = 0
    for row in unsure[~equal].tolist():
        exact = article.orientation(*(rational(p[row]) for p in (a, b, c, d)))
        sign[row] = (exact > 0) - (exact < 0)
    return sign


def _determinant(u: Floats, v: Floats, w: Floats) -> tuple[Floats, Floats]:
    """``u . (v x w)`` and a bound of its error that allows for rounded differences too."""
    det, size = np.zeros(len(u)), np.zeros(len(u))
    for x, y, z in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        one, two = v[:, y] * w[:, z], v[:, z] * w[:, y]
        det += u[:, x] * (one - two)
        size += np.abs(u[:, x]) * (np.abs(one) + np.abs(two))
    return det, 8 * np.finfo(np.float64).eps * size


def join_segments(segments: Segments) -> list[Curve]:
    """The curves of the segments; see `isoref.surface_intersection.join_segments`."""
    return curves_along(segments, segment_chains(segments))


def segment_chains(segments: Segments) -> list[tuple[Integers, bool]]:
    """The indices of the segments along each curve, and whether it is closed."""
    ends = segments.ends + 0.0  # no negative zeros
    places = names_of_rows(ends.reshape(-1, 3)).reshape(-1, 2)
    crossing = np.flatnonzero(~_run_both_ways(places))
    successor = np.full(len(crossing), -1)
    for names in (segments.nodes, places):
        _link(names[crossing], successor)
    return [(crossing[chain], closed) for chain, closed in follow(successor)]


def names_of_rows(rows: Array) -> Integers:
    """(N,) a number for each of N rows, the same for equal rows and for no others.

    Rows (N, k) are of 64-bit numbers without negative zeros. They are sorted by a hash [3]; where
    different rows have one hash, NumPy sorts the rows themselves.

    >>> names = names_of_rows(np.array([[1.0, 2.0], [3.0, 4.0], [1.0, 2.0]]))
    >>> bool(names[0] == names[2] != names[1])
    True
    """
    if len(rows) < 2:
        return np.zeros(len(rows), np.int64)
    hashes = np.zeros(len(rows), np.uint64)
    for column in np.ascontiguousarray(rows.T).view(np.uint64):
        hashes = _mixed_up(hashes + _mixed_up(column))
    order = np.argsort(hashes)
    ordered = hashes[order]
    new = ordered[1:] != ordered[:-1]
    if not (new | (rows[order[1:]] == rows[order[:-1]]).all(axis=1)).all():
        _, names = np.unique(rows, axis=0, return_inverse=True)
        return np.asarray(names.reshape(-1), np.int64)
    names = np.empty(len(rows), np.int64)
    names[order] = np.append(0, np.cumsum(new))
    return names


def _mixed_up(words: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """The finisher of splitmix64 [3]: each bit of a word depends on all."""
    words = words + np.uint64(0x9E3779B97F4A7C15)
    words = (words ^ (words >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    words = (words ^ (words >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return words ^ (words >> np.uint64(31))


def _run_both_ways(places: Integers) -> Booleans:
    """Which segments (S, 2) have as many others of the same ends run against them as with them."""
    heading = np.sign(places[:, 1] - places[:, 0])
    pair = names_of_rows(np.sort(places, axis=1))
    balance = np.bincount(pair, weights=heading)
    return np.asarray((balance[pair] == 0) & (heading != 0))


def _link(nodes: Integers, successor: Integers) -> None:
    """`successor` filled in: free ends linked to free starts on the same node, in order."""
    free_end = np.flatnonzero(successor < 0)
    is_free = np.ones(len(successor), bool)
    is_free[successor[successor >= 0]] = False
    free_start = np.flatnonzero(is_free)
    # Name an end or a start by its node and by how many came before it there.
    end, start = (
        2 * nodes[free, side] * len(nodes) + _rank(nodes[free, side])
        for free, side in ((free_end, 1), (free_start, 0))
    )
    _, of_end, of_start = np.intersect1d(end, start, assume_unique=True, return_indices=True)
    successor[free_end[of_end]] = free_start[of_start]


def _rank(nodes: Integers) -> Integers:
    """How many equal numbers stand before each number.

    >>> _rank(np.array([7, 5, 7, 7])).tolist()
    [0, 0, 1, 2]
    """
    order = np.argsort(nodes, kind="stable")
    ordered = nodes[order]
    first = np.searchsorted(ordered, ordered)
    rank = np.empty(len(nodes), np.int64)
    rank[order] = np.arange(len(nodes)) - first
    return rank


def intersection_curves(
    first: Field,
    second: Field,
    isovalues: tuple[float, float] = (0.0, 0.0),
    rule: Rule = asymptotic_decider.RULE,
) -> list[Curve]:
    """The curves in which the surfaces meet; see `isoref.surface_intersection`."""
    check_pair(first, second, isovalues)
    surfaces = [
        enhanced_marching_cubes(field, isovalue, rule)
        for field, isovalue in zip((first, second), isovalues, strict=True)
    ]
    return join_segments(surface_intersection(*surfaces))
