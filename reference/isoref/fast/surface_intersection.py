"""Surface intersection, vectorised: the segments and curves of `isoref.surface_intersection`.

All pairs of triangles that share a voxel are listed and tested at once. Signs are those of the
article all the same: floating-point numbers decide where their error bound [1] lets them; what is
left, ties among it, is decided after the article's motion, in whole numbers of any length.

References
----------
[1] J. R. Shewchuk, Adaptive precision floating-point arithmetic, 1997: the bound of `orientation`.
[2] P. Guigue, O. Devillers, Fast and robust triangle-triangle overlap test using orientation
    predicates, J. Graphics Tools 8, 2003: order on the common line by signs of tetrahedra.
[3] G. L. Steele, D. Lea, C. H. Flood, Fast splittable pseudorandom number generators, 2014.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isoref import asymptotic_decider
from isoref import surface_intersection as article
from isoref.curves import Curve, check_pair, follow
from isoref.fast.sweep import sweep
from isoref.field import Array, Booleans, Field, Floats, Integers
from isoref.rule import Rule
from isoref.surface_intersection import IndexedSurface, Segments, curves_along


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
    pairs = _Pairs(first, second, i, j)
    shared = pairs.shared()
    # Keep pairs of which each triangle has corners on both sides of the other's plane.
    pairs = pairs.of(np.flatnonzero(_mixed(pairs.front(0))))
    pairs = pairs.of(np.flatnonzero(_mixed(pairs.front(1))))
    (entry_a, exit_a), (exit_b, entry_b) = (_passages(pairs.front(side)) for side in (0, 1))

    # Order entries and exits along D; keep pairs whose intervals overlap.
    alive = np.flatnonzero((pairs.order(entry_a, exit_b) > 0) & (pairs.order(exit_a, entry_b) < 0))
    pairs = pairs.of(alive)
    entry_a, exit_a, entry_b, exit_b = (e[alive] for e in (entry_a, exit_a, entry_b, exit_b))
    starts, stops = pairs.order(entry_a, entry_b), -pairs.order(exit_a, exit_b)
    ends, keys = zip(
        *(
            pairs.nodes(*passage)
            for passage in ((entry_a, entry_b, starts), (exit_a, exit_b, stops))
        ),
        strict=True,
    )
    nodes = names_of_rows(np.stack(keys, axis=1).reshape(-1, 4))
    i, j = pairs.triangles
    contact = shared[0][i] & shared[1][j]
    return Segments(np.stack(ends, axis=1), nodes.reshape(-1, 2), first.cells[i], tests, contact)


class _Pairs:
    """Pairs of triangles, one of each surface, and the signs asked of their corners.

    A corner is named by its side (0 or 1, the surface) and its vertex there, (P,) numbers.
    """

    def __init__(
        self, first: IndexedSurface, second: IndexedSurface, i: Integers, j: Integers
    ) -> None:
        self.surfaces = first, second
        self.triangles = i, j
        self.corners = first.mesh.simplices[i], second.mesh.simplices[j]
        self.known: dict[tuple[int, int], Integers] = {}

    def of(self, kept: Integers) -> _Pairs:
        """Some of the pairs, with what is known of them."""
        left = _Pairs(*self.surfaces, self.triangles[0][kept], self.triangles[1][kept])
        left.known = {corner: signs[kept] for corner, signs in self.known.items()}
        return left

    def shared(self) -> tuple[Booleans, Booleans]:
        """Which triangles of each surface are on the same corners as one of the other's."""
        # Look at those alone that reach from the same places to the same places.
        alike = np.ones(len(self.triangles[0]), bool)
        for axis in range(3):
            a, b = (
                one.mesh.vertices[:, axis][corners]
                for one, corners in zip(self.surfaces, self.corners, strict=True)
            )
            alike &= (a.min(axis=1) == b.min(axis=1)) & (a.max(axis=1) == b.max(axis=1))
        rows = np.flatnonzero(alike)
        a, b = (
            one.mesh.vertices[corners[rows]]
            for one, corners in zip(self.surfaces, self.corners, strict=True)
        )
        same = (a[:, :, None] == b[:, None]).all(axis=3)
        rows = rows[same.any(axis=1).all(axis=1) & same.any(axis=2).all(axis=1)]
        found = tuple(np.zeros(len(one.mesh.simplices), bool) for one in self.surfaces)
        for marks, triangles in zip(found, self.triangles, strict=True):
            marks[triangles[rows]] = True
        return found[0], found[1]

    def front(self, side: int) -> Booleans:
        """(P, 3) which corners on this side are in front of the other triangle's plane."""
        return np.stack([self.height(side, c) > 0 for c in range(3)], axis=1)

    def height(self, side: int, c: int) -> Integers:
        """(P,) the sign of corner c over the other triangle's plane."""
        if (side, c) not in self.known:
            plane = [(1 - side, self.corners[1 - side][:, k]) for k in range(3)]
            self.known[side, c] = self.sign([*plane, (side, self.corners[side][:, c])])
        return self.known[side, c]

    def order(self, edge_a: Integers, edge_b: Integers) -> Integers:
        """(P,) the sign of the tetrahedron of an edge of each triangle."""
        return self.sign([*self.ends(0, edge_a), *self.ends(1, edge_b)])

    def ends(self, side: int, edge: Integers) -> list[tuple[int, Integers]]:
        """The two corners of an edge of each triangle."""
        rows = np.arange(len(edge))
        return [(side, self.corners[side][rows, (edge + k) % 3]) for k in (0, 1)]

    def sign(self, points: list[tuple[int, Integers]]) -> Integers:
        """(P,) the sign of `isoref.surface_intersection.orientation` after the motion."""
        places = [self.surfaces[side].mesh.vertices[v] for side, v in points]
        sign, unsure = orientation(*places)
        if len(unsure):
            # Leave out what lies in one plane of the lattice, and stays there.
            still = np.ones((len(unsure), 3), bool)
            for (side, v), place in zip(points, places, strict=True):
                still &= place[unsure] == places[0][unsure]
                still &= self.surfaces[side].motion[v[unsure]] == 0
            sign[unsure] = 0
            unsure = unsure[~still.any(axis=1)]
            exact = article.orientation(*self.moved(points, unsure).transpose(0, 2, 1))
            sign[unsure] = (exact > 0).astype(np.int64) - (exact < 0).astype(np.int64)
        return sign

    def moved(self, points: list[tuple[int, Integers]], rows: Integers) -> NDArray[np.object_]:
        """(4, R, 3) the points of some pairs after their motion, in whole numbers."""
        own = [(self.surfaces[side], v[rows]) for side, v in points]
        found = article.moved(
            np.concatenate([surface.mesh.vertices[v] for surface, v in own]),
            np.concatenate([surface.motion[v] for surface, v in own]),
            np.repeat([side + 1 for side, _ in points], len(rows)),
            np.concatenate([surface.own_number[v] for surface, v in own]),
        )
        return found.reshape(len(points), len(rows), 3)

    def nodes(self, edge_a: Integers, edge_b: Integers, later: Integers) -> tuple[Floats, Integers]:
        """Places (P, 3) and keys (P, 4) of the ends of segments.

        `later` is positive where the edge of the first surface makes the end, negative where that
        of the second does, and 0 where both meet there. A key is the edge of the first surface, or
        its triangle and -1, then the same of the second.
        """
        keys = []
        for side, edge, is_node in ((0, edge_a, later >= 0), (1, edge_b, later <= 0)):
            ends = np.sort(np.stack([v for _, v in self.ends(side, edge)], axis=1), axis=1)
            triangle = np.stack([self.triangles[side], np.full(len(edge), -1)], axis=1)
            keys.append(np.where(is_node[:, None], ends, triangle))
        of_first = later >= 0
        places = np.where(of_first[:, None], self.passage(0, edge_a), self.passage(1, edge_b))
        return places, np.concatenate(keys, axis=1)

    def passage(self, side: int, edge: Integers) -> Floats:
        """(P, 3) where an edge of this side passes the other triangle's plane."""
        # Take heights in floating-point numbers, and start from the nearer end.
        own = self.surfaces[side].mesh.vertices
        a, b, c = (self.surfaces[1 - side].mesh.vertices[v] for v in self.corners[1 - side].T)
        ends = self.ends(side, edge)
        p, q = own[ends[0][1]], own[ends[1][1]]
        low, error_low = _determinant(b - a, c - a, p - a)
        high, error_high = _determinant(b - a, c - a, q - a)
        swap = np.abs(high) < np.abs(low)
        near, far = np.where(swap, high, low), np.where(swap, low, high)
        t = np.divide(near, near - far, out=np.zeros_like(near), where=near != far)
        start, stop = np.where(swap[:, None], q, p), np.where(swap[:, None], p, q)
        places = start + np.clip(t, 0, 1)[:, None] * (stop - start)

        # Where their signs are not sure, take them after the motion.
        unsure = np.flatnonzero((np.abs(low) <= error_low) | (np.abs(high) <= error_high))
        if len(unsure):
            plane = [(1 - side, v) for v in self.corners[1 - side].T]
            *triangle, first, second = self.moved([*plane, *ends], unsure)
            low, high = (
                article.orientation(*np.transpose([*triangle, end], (0, 2, 1)))
                for end in (first, second)
            )
            places[unsure] = _passages_of(p[unsure], q[unsure], low, high)
        return np.asarray(places)


def _passages_of(start: Floats, stop: Floats, low: Array, high: Array) -> Floats:
    """(P, 3) `isoref.surface_intersection.passage`, each coordinate rounded once.

    t is the ratio of the heights, a whole number of 2^-PLACE_BITS.
    """
    one = 1 << article.PLACE_BITS
    t = (2 * low * one + (low - high)) // (2 * (low - high))
    (p, q), power, _ = article.scaled(np.stack([start, stop]))
    whole, power = p * one + t[:, None] * (q - p), power - article.PLACE_BITS
    up, down = 1 << max(power, 0), 1 << max(-power, 0)
    return np.asarray((whole * up / down).astype(np.float64))


def _mixed(front: Booleans) -> Booleans:
    """Which triangles have corners in front of and behind a plane."""
    return np.asarray(front.any(axis=1) & ~front.all(axis=1))


def _passages(front: Booleans) -> tuple[Integers, Integers]:
    """The edges (corner e to e + 1) that go from behind to the front, and back."""
    ahead = np.roll(front, -1, axis=1)
    return (~front & ahead).argmax(axis=1), (front & ~ahead).argmax(axis=1)


def orientation(a: Floats, b: Floats, c: Floats, d: Floats) -> tuple[Integers, Integers]:
    """(P,) the sign of ``det[b - a, c - a, d - a]``, and the rows where floats cannot vouch [1]."""
    det, error = _determinant(b - a, c - a, d - a)
    return np.sign(det).astype(np.int64), np.flatnonzero(np.abs(det) <= error)


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
    successor = np.full(len(segments.nodes), -1)
    _link(segments.nodes, successor)
    kept = []
    for chain, closed in follow(successor):
        if segments.contact is not None and segments.contact[chain].all():
            continue
        ends = segments.ends[chain]
        left = np.arange(len(chain))
        if _returns(ends):
            left = article.without_returns(ends, closed)
        if len(left):
            kept.append((chain[left], closed))
    return kept


def _returns(ends: Floats) -> bool:
    """Whether a segment has no length, or the next one (after the last, the first) runs back."""
    after = np.roll(ends, -1, axis=0)
    still = (ends[:, 0] == ends[:, 1]).all(axis=1)
    back = (ends[:, 0] == after[:, 1]).all(axis=1) & (ends[:, 1] == after[:, 0]).all(axis=1)
    return bool((still | back).any())


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
