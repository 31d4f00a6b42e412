"""The explicit way: make both surfaces, intersect their triangles, join the segments.

Two surfaces of N triangles each take N^2 tests to intersect. But marching cubes puts every triangle
into one voxel, and does so voxel by voxel. A running count of triangles therefore tells which
triangles a voxel holds, and only triangles of one voxel need be tested: about sqrt(N) tests.

The tests are made in rational arithmetic, so that no sign is ever in doubt: a float is a fraction.
`isoref.fast.surface_intersection` is the vectorised twin: the same segments up to rounding, in the
same order, with the same nodes up to their names.

Glossary
--------
T, t_j      a surface's triangles, in the order of the voxels
I_T(k)      number of triangles in the voxels up to and including k
L, I_L      line segments, one a pair of triangles that meet; their running count
m           end of a segment: 0 its start, 1 its end
U           the segments already linked to another
e           a mesh edge, from corner e of its triangle to the next
node        where an edge of one surface meets a triangle, or an edge, of the other
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
"""

from __future__ import annotations

import itertools
from collections import Counter, defaultdict
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from isoref import asymptotic_decider
from isoref.curves import Curve, check_pair, curves_through, follow
from isoref.field import Field, Floats, Integers
from isoref.mesh import Mesh
from isoref.rule import Rule
from isoref.sweep import sweep

Point = tuple[Fraction, Fraction, Fraction]
Triangle = Sequence[Point]

# --------------------------------------------------------------------------------------------
# Section 4.1: enhanced marching cubes
# --------------------------------------------------------------------------------------------


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

    Parameters and errors are those of `isoref.sweep.sweep`. The index is kept as one voxel number
    a triangle, in order, from which I_T follows: "it could be implemented by hash-tables in order
    to reduce the memory requirement" (section 9).
    """
    mesh = sweep(rule, field, isovalue, provenance=True)
    return IndexedSurface(mesh, mesh.traced().cells, tuple(max(n - 1, 0) for n in field.shape))


# --------------------------------------------------------------------------------------------
# Section 4.2: surface intersection
# --------------------------------------------------------------------------------------------


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


class End(NamedTuple):
    """The end of a segment, and what makes it.

    place : on both triangles
    edge_a, edge_b : the edge of the first and of the second triangle that passes here; -1 where
        it is the inside of the triangle
    """

    place: Point
    edge_a: int
    edge_b: int


def surface_intersection(first: IndexedSurface, second: IndexedSurface) -> Segments:
    """SURFACEISECT (table 2): the segments in which triangles of one voxel meet.

    Raises
    ------
    ValueError
        for surfaces of different lattices.
    """
    if first.shape != second.shape:
        raise ValueError(f"surfaces of {first.shape} and {second.shape} voxels share no voxels")
    a, b = exact_triangles(first.mesh), exact_triangles(second.mesh)
    tests = 0
    ends: list[list[list[float]]] = []
    nodes: list[list[int]] = []
    cells: list[int] = []
    number: dict[Hashable, int] = {}
    for k in range(int(np.prod(first.shape))):
        # Test the triangles of this voxel, each of one surface with each of the other.
        for i in range(int(first.count_through(k - 1)), int(first.count_through(k))):
            for j in range(int(second.count_through(k - 1)), int(second.count_through(k))):
                tests += 1
                meeting = triangle_intersection(a[i], b[j])
                if meeting is None:
                    continue

                # Note the segment, and name its nodes by what makes them.
                names = [
                    (edge_name(a[i], end.edge_a, i), edge_name(b[j], end.edge_b, j))
                    for end in meeting
                ]
                nodes.append([number.setdefault(name, len(number)) for name in names])
                ends.append([[float(x) for x in end.place] for end in meeting])
                cells.append(k)
    return Segments(
        np.array(ends, np.float64).reshape(-1, 2, 3),
        np.array(nodes, np.int64).reshape(-1, 2),
        np.array(cells, np.int64),
        tests,
    )


def exact_triangles(mesh: Mesh) -> list[list[Point]]:
    """The corners of each triangle, exactly."""
    points = [rational(vertex) for vertex in mesh.vertices]
    return [[points[v] for v in triangle] for triangle in mesh.simplices.tolist()]


def edge_name(triangle: Triangle, e: int, number: int) -> Hashable:
    """A name for edge e that all triangles at the edge share; for e = -1 the triangle's number."""
    return number if e < 0 else frozenset((triangle[e], triangle[(e + 1) % 3]))


def triangle_intersection(a: Triangle, b: Triangle) -> tuple[End, End] | None:
    """Where two triangles meet: the segment from start to end along D, or None.

    The line common to both planes passes each triangle from an entry to an exit; the segment is
    what both passages share. Points in a triangle's plane count as behind it; see the module's
    text for what follows.

    >>> flat = [rational(p) for p in ((0, 0, 0), (4, 0, 0), (0, 4, 0))]
    >>> wall = [rational(p) for p in ((1, 1, -1), (1, 2, 1), (1, 1, 1))]
    >>> [[float(x) for x in end.place] for end in triangle_intersection(flat, wall) or ()]
    [[1.0, 1.0, 0.0], [1.0, 1.5, 0.0]]
    >>> triangle_intersection(flat, flat) is None
    True
    """
    # Find the edges by which each triangle passes the plane of the other.
    span_a, span_b = passages(a, b), passages(b, a)
    if span_a is None or span_b is None:
        return None

    # Order the passages along D: the first triangle is entered where it passes to the front of
    # the second, and the second is left where it passes to the front of the first.
    (entry_a, exit_a), (exit_b, entry_b) = span_a, span_b
    D = _cross(_normal(a), _normal(b))
    in_a, out_a, in_b, out_b = (
        _dot(passage.place, D) for passage in (entry_a, exit_a, entry_b, exit_b)
    )
    if in_a >= out_b or in_b >= out_a:
        return None

    # Take the later entry and the earlier exit; both, where they coincide.
    start = End(
        (entry_a if in_a >= in_b else entry_b).place,
        entry_a.edge if in_a >= in_b else -1,
        entry_b.edge if in_b >= in_a else -1,
    )
    stop = End(
        (exit_a if out_a <= out_b else exit_b).place,
        exit_a.edge if out_a <= out_b else -1,
        exit_b.edge if out_b <= out_a else -1,
    )
    return start, stop


class Passage(NamedTuple):
    """Where an edge of a triangle passes a plane."""

    place: Point
    edge: int


def passages(own: Triangle, other: Triangle) -> tuple[Passage, Passage] | None:
    """Where the boundary of `own` passes the plane of `other`: to its front, then to its back.

    None where all of `own` is on one side; in the plane is behind it.
    """
    # See which corners are in front of the plane.
    x, y, z = other
    height = [orientation(x, y, z, p) for p in own]

    # Find the edges between front and back, and where they pass.
    found: dict[bool, Passage] = {}
    for e in range(3):
        low, high = height[e], height[(e + 1) % 3]
        if (low > 0) != (high > 0):
            p, q, t = own[e], own[(e + 1) % 3], low / (low - high)
            place = (
                p[0] + t * (q[0] - p[0]),
                p[1] + t * (q[1] - p[1]),
                p[2] + t * (q[2] - p[2]),
            )
            found[high > 0] = Passage(place, e)
    return (found[True], found[False]) if found else None


def orientation(a: Point, b: Point, c: Point, d: Point) -> Fraction:
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


def _normal(triangle: Triangle) -> Point:
    """The right-hand normal, not scaled."""
    return _cross(_minus(triangle[1], triangle[0]), _minus(triangle[2], triangle[0]))


# --------------------------------------------------------------------------------------------
# Section 5: joining by distance
# --------------------------------------------------------------------------------------------


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


# --------------------------------------------------------------------------------------------
# Joining by identity
# --------------------------------------------------------------------------------------------


def join_segments(segments: Segments) -> list[Curve]:
    """The segments in order along their curves, by the identity of their nodes.

    A segment is followed by the one that starts on the node it ends on. Ends that are left over
    (vertices of one surface exactly on the other) are joined where their coordinates are equal,
    bit for bit. No tolerance is involved. Segments that run both ways are left out.
    """
    return curves_along(segments, segment_chains(segments))


def curves_along(segments: Segments, chains: list[tuple[Integers, bool]]) -> list[Curve]:
    """The curves through the segments of each chain; a chain that is closed ends where it began."""
    found = []
    for chain, closed in chains:
        starts, stops = segments.ends[chain].transpose(1, 0, 2)
        points = starts if closed else np.concatenate([starts, stops[-1:]])
        found += curves_through(points + 0.0, closed)  # no negative zeros
    return found


def segment_chains(segments: Segments) -> list[tuple[Integers, bool]]:
    """The indices of the segments along each curve, and whether it is closed."""
    # Name the ends twice: by what makes them and by where they are, negative zeros as zeros.
    nodes = [tuple(pair) for pair in segments.nodes.tolist()]
    places = [(tuple(start), tuple(stop)) for start, stop in (segments.ends + 0.0).tolist()]

    # Leave out the segments that run both ways equally often: contact, not crossing.
    runs = Counter(places)
    crossing = [
        s
        for s, (start, stop) in enumerate(places)
        if start == stop or runs[start, stop] != runs[stop, start]
    ]

    # Link each free end to the first free start of the same name.
    successor = dict.fromkeys(crossing, -1)
    for names in (nodes, places):
        taken = set(successor.values())
        waiting = defaultdict(list)
        for s in crossing:
            if s not in taken:
                waiting[names[s][0]].append(s)
        for s in crossing:
            if successor[s] < 0 and waiting[names[s][1]]:
                successor[s] = waiting[names[s][1]].pop(0)

    # Follow the links.
    row = {s: n for n, s in enumerate(crossing)}
    after = np.array([row.get(successor[s], -1) for s in crossing], np.int64)
    return [(np.array(crossing, np.int64)[chain], closed) for chain, closed in follow(after)]


# --------------------------------------------------------------------------------------------
# The whole way
# --------------------------------------------------------------------------------------------


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
