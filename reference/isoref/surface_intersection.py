"""The explicit way: make both surfaces, intersect their triangles, join the segments.

Two surfaces of N triangles each take N^2 tests to intersect. But marching cubes puts every triangle
into one voxel, and does so voxel by voxel. A running count of triangles therefore tells which
triangles a voxel holds, and only triangles of one voxel need be tested: about sqrt(N) tests.

Glossary
--------
T, t_j      a surface's triangles, in the order of the voxels
I_T(k)      number of triangles in the voxels up to and including k
L, I_L      line segments, one a pair of triangles that meet; their running count
m           end of a segment: 0 its start, 1 its end
U           the segments already linked to another
e           a mesh edge; node: where an edge of one surface meets a triangle of the other
entry, exit where the line common to two planes enters and leaves a triangle, seen along D
D           N_1 x N_2, the direction of that line; N_i the normals, from high to low

Touching triangles
------------------
Signs are exact, also where floating-point numbers cannot tell. A point exactly in the plane of a
triangle counts as *behind* it, on the inside, as if the isovalue were lower by an infinitesimal:
the convention for samples (value >= isovalue is inside), carried over. Hence

- coplanar triangles have no segment;
- an edge that lies in a triangle is a segment for the one of its two triangles that rises in front;
- a triangle that touches another with one corner has none, or one of no length, which holds its
  neighbours together and leaves no point of its own in a curve;
- identical surfaces have segments along their concave edges, each once either way. Segments that
  run both ways are contact, not crossing: joining leaves them out, and there is no curve;
- surfaces that are the same but for rounding, or but for the way they face, have curves, or pieces
  of them, along their edges: the last bits decide which. `isoref.marching_faces` has whole curves
  there, or none.

Invariants
----------
Segments and curves run along ``grad psi_1 x grad psi_2``. Where no vertex of one surface lies
exactly on the other, every node has one segment in and one out, or lies on the border.

References
----------
[1] P. Ljung, A. Ynnerman, Extraction of intersection curves from iso-surfaces on co-located 3D
    grids, sections 4 and 5, tables 2 and 3, eq. 1, appendix A.
[2] P. Guigue, O. Devillers, Fast and robust triangle-triangle overlap test using orientation
    predicates, J. Graphics Tools 8, 2003: order on the common line by signs of tetrahedra.
[3] J. R. Shewchuk, Adaptive precision floating-point arithmetic, 1997: the bound of `orientation`.
"""

from __future__ import annotations

import itertools
from collections import defaultdict
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from isoref import asymptotic_decider
from isoref.curves import Curve, check_pair, curves_through, follow
from isoref.fast.sweep import sweep_with_cells
from isoref.field import Booleans, Field, Floats, Integers
from isoref.mesh import Mesh
from isoref.rule import Rule

Point = tuple[Fraction, Fraction, Fraction]


# --- enhanced marching cubes (section 4.1) -----------------------------------------------------


@dataclass(frozen=True, eq=False)
class IndexedSurface:
    """A surface whose triangles know their voxel.

    Attributes
    ----------
    mesh : its triangles in the order of the voxels
    cells : (T,) the voxel of each triangle, in C order over the voxels
    shape : the number of voxels along each axis
    """

    mesh: Mesh
    cells: Integers
    shape: tuple[int, ...]

    def count_through(self, k: Integers | int) -> Integers:
        """I_T(k), for any integers k: 0 before the first voxel, |T| from the last one on."""
        return np.asarray(np.searchsorted(self.cells, k, side="right"), np.int64)

    def count_in(self, k: Integers | int) -> Integers:
        """``n = I_T(k) - I_T(k - 1)``, the number of triangles in voxel k (eq. 1)."""
        return np.asarray(self.count_through(k) - self.count_through(np.asarray(k) - 1))

    def histogram(self) -> Integers:
        """How many voxels have 0, 1, 2, .. triangles (a row of table 1)."""
        counts = np.bincount(np.bincount(self.cells)) if len(self.cells) else np.zeros(1, np.int64)
        counts[0] = int(np.prod(self.shape)) - counts[1:].sum()
        return counts.astype(np.int64)


def enhanced_marching_cubes(
    field: Field, isovalue: float, rule: Rule = asymptotic_decider.RULE
) -> IndexedSurface:
    """The rule's surface with its triangle index I_T.

    The index is kept as one voxel number a triangle, in order, from which I_T follows: "it could
    be implemented by hash-tables in order to reduce the memory requirement" (section 9).
    """
    mesh, cells = sweep_with_cells(rule, field, isovalue)
    return IndexedSurface(mesh, cells, tuple(max(n - 1, 0) for n in field.shape))


# --- surface intersection (section 4.2) --------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Segments:
    """The line segments L in which triangles of two surfaces meet.

    Attributes
    ----------
    ends : (S, 2, 3) start and end, along D
    nodes : (S, 2) the node each end stands on; equal where the same mesh parts meet
    cells : (S,) the voxel, ascending; I_L is its running count
    tests : number of pairs of triangles that were tested
    """

    ends: Floats
    nodes: Integers
    cells: Integers
    tests: int

    def count_through(self, k: Integers | int) -> Integers:
        """I_L(k), the number of segments in the voxels up to and including k."""
        return np.asarray(np.searchsorted(self.cells, k, side="right"), np.int64)


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
    """SURFACEISECT (table 2): the segments in which triangles of one voxel meet."""
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
    _, nodes = np.unique(np.stack(keys, axis=1)[alive].reshape(-1, 4), axis=0, return_inverse=True)
    return Segments(
        np.stack(ends, axis=1)[alive],
        nodes.reshape(-1, 2).astype(np.int64),
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

    Each is (P, 2, 3). Where floating-point arithmetic cannot vouch for the sign [3], rational
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
        exact = plain_orientation(*(rational(p[row]) for p in (a, b, c, d)))
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


# --- the plain twin ------------------------------------------------------------------------------


def plain_surface_intersection(first: IndexedSurface, second: IndexedSurface) -> Floats:
    """(S, 2, 3) the segments L of table 2, by its loops, in rational arithmetic; to be read."""
    corners_1, corners_2 = (
        [[rational(s.mesh.vertices[v]) for v in row] for row in s.mesh.simplices]
        for s in (first, second)
    )
    segments = []
    for k in range(int(np.prod(first.shape))):
        if first.count_in(k) == 0 or second.count_in(k) == 0:
            continue
        for i in range(int(first.count_through(k - 1)), int(first.count_through(k))):
            for j in range(int(second.count_through(k - 1)), int(second.count_through(k))):
                meeting = triangle_intersection(corners_1[i], corners_2[j])
                if meeting is not None:
                    segments.append([[float(x) for x in end] for end in meeting])
    return np.array(segments).reshape(-1, 2, 3)


def triangle_intersection(a: list[Point], b: list[Point]) -> tuple[Point, Point] | None:
    """Where two triangles meet: the segment from start to end along D, or None.

    Points in a triangle's plane count as behind it; see the module's text for what follows.

    >>> flat = [rational(p) for p in ((0, 0, 0), (4, 0, 0), (0, 4, 0))]
    >>> wall = [rational(p) for p in ((1, 1, -1), (1, 2, 1), (1, 1, 1))]
    >>> [[float(x) for x in end] for end in triangle_intersection(flat, wall) or ()]
    [[1.0, 1.0, 0.0], [1.0, 1.5, 0.0]]
    >>> triangle_intersection(flat, flat) is None
    True
    """
    span_a, span_b = _span(a, b), _span(b, a)
    if span_a is None or span_b is None:
        return None
    direction = _cross(_normal(a), _normal(b))
    (entry_a, exit_a), (exit_b, entry_b) = span_a, span_b
    start = max(entry_a, entry_b, key=lambda p: _dot(p, direction))
    stop = min(exit_a, exit_b, key=lambda p: _dot(p, direction))
    apart = _dot(entry_a, direction) >= _dot(exit_b, direction)
    apart |= _dot(entry_b, direction) >= _dot(exit_a, direction)
    return None if apart else (start, stop)


def _span(own: list[Point], other: list[Point]) -> tuple[Point, Point] | None:
    """Where the boundary of `own` passes the plane of `other`: to its front, then to its back."""
    x, y, z = other
    height = [plain_orientation(x, y, z, p) for p in own]
    passages: dict[bool, Point] = {}
    for e in range(3):
        low, high = height[e], height[(e + 1) % 3]
        if (low > 0) != (high > 0):
            p, q, t = own[e], own[(e + 1) % 3], low / (low - high)
            passages[high > 0] = (
                p[0] + t * (q[0] - p[0]),
                p[1] + t * (q[1] - p[1]),
                p[2] + t * (q[2] - p[2]),
            )
    return (passages[True], passages[False]) if passages else None


def plain_orientation(a: Point, b: Point, c: Point, d: Point) -> Fraction:
    """``det[b - a, c - a, d - a]``, exactly: positive where d is in front of triangle abc."""
    return _dot(_cross(_minus(b, a), _minus(c, a)), _minus(d, a))


def rational(point: Floats | tuple[float, ...]) -> Point:
    """The exact value of each coordinate."""
    x, y, z = (Fraction(float(coordinate)) for coordinate in point)
    return x, y, z


def _minus(p: Point, q: Point) -> Point:
    """The vector from q to p."""
    return p[0] - q[0], p[1] - q[1], p[2] - q[2]


def _cross(u: Point, v: Point) -> Point:
    """The cross product."""
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


def _dot(u: Point, v: Point) -> Fraction:
    """The scalar product."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def _normal(triangle: list[Point]) -> Point:
    """The right-hand normal, not scaled."""
    return _cross(_minus(triangle[1], triangle[0]), _minus(triangle[2], triangle[0]))


# --- joining by distance (section 5) -------------------------------------------------------------


def combine_line_segments(
    segments: Segments, shape: tuple[int, ...], threshold: float
) -> list[Curve]:
    """The curves of `greedy_chains`."""
    curves = []
    for trace, closed in greedy_chains(segments, shape, threshold):
        points = [segments.ends[segment, m] for segment, m in trace]
        if not closed:
            points.append(segments.ends[trace[-1][0], 1 - trace[-1][1]])
        curves.append(Curve(np.array(points), closed))
    return curves


Trace = list[tuple[int, int]]


def greedy_chains(
    segments: Segments, shape: tuple[int, ...], threshold: float
) -> list[tuple[Trace, bool]]:
    """COMBINELINESEGS (table 3): segments joined greedily, the closest free ends first.

    Each chain is a list of segments in order, each with the end that comes first, and whether the
    curve is closed.

    Parameters
    ----------
    segments : L with its index I_L
    shape : the number of voxels along each axis
    threshold : the greatest distance of two ends that are joined, in units of the positions

    Notes
    -----
    Two lines of table 3 are mended. Line 12 searches from i_F, which has just been found to have
    no neighbour; the forward trace has to search from i_L. And the last segment of an open curve
    is linked to nothing, hence not in U, and would start a curve of its own; here U has every
    segment of a finished curve. The ends of a curve are found in whatever direction they come:
    unlike `join_segments`, the direction along D is not used, and curves may run either way.
    """
    search = _Neighbourhood(segments, shape, threshold)
    chains = []
    for i in range(len(segments.cells)):
        if i in search.used:
            continue
        trace = [(i, 0)]
        closed = search.extend(trace, backward=True)
        if not closed:
            search.extend(trace, backward=False)
        search.used.update(segment for segment, _ in trace)
        chains.append((trace, closed))
    return chains


@dataclass(eq=False)
class _Neighbourhood:
    """Segments by voxel, and U."""

    segments: Segments
    shape: tuple[int, ...]
    threshold: float

    def __post_init__(self) -> None:
        """No segment is used yet."""
        self.used: set[int] = set()

    def extend(self, trace: Trace, *, backward: bool) -> bool:
        """Whether the curve closed while `trace` grew at one end as far as it goes."""
        while True:
            i, first = trace[0] if backward else trace[-1]
            m = first if backward else 1 - first
            last = trace[-1] if backward else trace[0]
            found = self.closest_point(i, m, trace, (last[0], 1 - last[1] if backward else last[1]))
            if found is None:
                return False
            if found[0] == last[0]:
                return True
            self.used.add(found[0])
            if backward:
                trace.insert(0, (found[0], 1 - found[1]))
            else:
                trace.append(found)

    def closest_point(
        self, i: int, m: int, trace: Trace, far_end: tuple[int, int]
    ) -> tuple[int, int] | None:
        """FINDCLOSESTPOINT: the free end (i', m') closest to end m of segment i, or None.

        Ends of unused segments in the voxels around count, and the far end of the curve itself,
        which would close it.
        """
        here = self.segments.ends[i, m]
        candidates = [(j, end) for j in self.around(i) for end in (0, 1) if j not in self.used]
        candidates = [(j, end) for j, end in candidates if j not in (i, far_end[0])]
        if len(trace) > 1:
            candidates.append(far_end)
        if not candidates:
            return None
        gaps = np.linalg.norm(self.segments.ends[tuple(np.transpose(candidates))] - here, axis=1)
        best = int(gaps.argmin())
        return candidates[best] if gaps[best] <= self.threshold else None

    def around(self, i: int) -> list[int]:
        """The segments in the voxel of segment i and in those that touch it."""
        where = np.array(np.unravel_index(self.segments.cells[i], self.shape))
        low, high = np.maximum(where - 1, 0), np.minimum(where + 1, np.array(self.shape) - 1)
        found: list[int] = []
        for x, y in itertools.product(range(low[0], high[0] + 1), range(low[1], high[1] + 1)):
            row = (x * self.shape[1] + y) * self.shape[2]
            start, stop = self.segments.count_through(np.array([row + low[2] - 1, row + high[2]]))
            found += range(int(start), int(stop))
        return found


# --- joining by identity -------------------------------------------------------------------------


def join_segments(segments: Segments) -> list[Curve]:
    """The segments in order along their curves, by the identity of their nodes.

    A segment is followed by the one that starts on the node it ends on. Ends that are left over
    (vertices of one surface exactly on the other) are joined where their coordinates are equal,
    bit for bit. No tolerance is involved. Segments that run both ways are left out.
    """
    found = []
    for chain, closed in segment_chains(segments):
        starts, stops = segments.ends[chain].transpose(1, 0, 2)
        points = starts if closed else np.concatenate([starts, stops[-1:]])
        found += curves_through(points + 0.0, closed)  # no negative zeros
    return found


def segment_chains(segments: Segments) -> list[tuple[Integers, bool]]:
    """The indices of the segments along each curve, and whether it is closed."""
    ends = segments.ends + 0.0  # no negative zeros
    _, inverse = np.unique(ends.reshape(-1, 3), axis=0, return_inverse=True)
    places = inverse.reshape(-1, 2)
    crossing = np.flatnonzero(~_run_both_ways(places))
    successor = np.full(len(crossing), -1)
    for names in (segments.nodes, places):
        _link(names[crossing], successor)
    return [(crossing[chain], closed) for chain, closed in follow(successor)]


def _run_both_ways(places: Integers) -> Booleans:
    """Which segments (S, 2) have as many others of the same ends run against them as with them."""
    heading = np.sign(places[:, 1] - places[:, 0])
    _, pair = np.unique(np.sort(places, axis=1), axis=0, return_inverse=True)
    balance = np.bincount(pair.reshape(-1), weights=heading)
    return np.asarray((balance[pair.reshape(-1)] == 0) & (heading != 0))


def _link(nodes: Integers, successor: Integers) -> None:
    """`successor` filled in: free ends linked to free starts on the same node, in order."""
    free_end = np.flatnonzero(successor < 0)
    free_start = np.setdiff1d(np.arange(len(successor)), successor)
    waiting = defaultdict(list)
    for segment in free_start.tolist():
        waiting[int(nodes[segment, 0])].append(segment)
    for segment in free_end.tolist():
        candidates = waiting[int(nodes[segment, 1])]
        if candidates:
            successor[segment] = candidates.pop(0)


# --- the whole way --------------------------------------------------------------------------------


def intersection_curves(
    first: Field,
    second: Field,
    isovalues: tuple[float, float] = (0.0, 0.0),
    rule: Rule = asymptotic_decider.RULE,
) -> list[Curve]:
    """The curves in which the rule's surfaces of two fields meet, joined by identity.

    Raises
    ------
    FieldError
        where the fields are not scalar fields on one three-dimensional lattice.
    """
    check_pair(first, second, isovalues)
    surfaces = [
        enhanced_marching_cubes(field, isovalue, rule)
        for field, isovalue in zip((first, second), isovalues, strict=True)
    ]
    return join_segments(surface_intersection(*surfaces))
