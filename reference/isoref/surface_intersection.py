"""The explicit way: make both surfaces, intersect their triangles, join the segments.

Two surfaces of N triangles each take N^2 tests to intersect. But marching cubes puts every triangle
into one voxel, and does so voxel by voxel. A running count of triangles therefore tells which
triangles a voxel holds, and only triangles of one voxel need be tested: about sqrt(N) tests.

The tests are made in whole numbers, so that no sign is ever in doubt: a float is a fraction.
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
epsilon     an infinitesimal: smaller than any number, as long as signs are asked for

Touching surfaces
-----------------
Where samples tie, vertices of both surfaces come to one place, edges cross edges, triangles lie in
one plane or have no area, and what meets what has no answer. So nobody asks it. Each vertex moves
by an infinitesimal, along its lattice edge, and the surfaces that are intersected are these::

    first surface       p + epsilon u + epsilon^3 c u     u: along the lattice edge of the vertex,
    second surface      p + epsilon^2 u + epsilon^3 c u      to its outside end (from there inwards)

As if both isovalues were a little lower, that is, the first by much more than the second; and since
that alone may leave some coincidence, each vertex has a number c of its own besides. Vertices stay
on their edges, so triangles stay in their voxels and in one piece with their neighbours: the moved
surfaces are as closed as the given ones. This is simulation of simplicity [3]: four points of both
surfaces have a sign that is not 0, unless all four lie in one face of a voxel, or their numbers c
happen to cancel (c is hashed to 32 bits; no case is known).

The symbol needs no algebra. A determinant of three differences is a polynomial in epsilon whose
coefficients are integers, once all coordinates are; with epsilon = 2^-K, and 2^K greater than any
coefficient, the first that is not 0 outweighs all that follow, so that the sign is the symbol's.

Segments are returned where they stand as epsilon goes to 0. There a curve may run along an edge
and back, where surfaces touched: joining leaves both ways out. And since a vertex can only move
along its edge, which need not lead to the front of all its triangles, moved twins of one surface
may cross here and there: a curve all of whose segments lie in triangles that both surfaces have is
left out as well. Hence

- identical surfaces have no curve;
- where surfaces share a piece, their curve runs along its rim;
- surfaces that are the same but for rounding have curves, or pieces of them, along their edges: the
  last bits decide which.

Triangles that stand on no lattice (made by hand) do not move. A point in the plane of such a
triangle counts as behind it, on the inside.

Invariants
----------
Segments and curves run along ``grad psi_1 x grad psi_2``. Every node has one segment in and one
out, or lies on the border of the lattice, ties or not. (A triangle of a hand-made rule that lies
flat in a face of its voxel breaks that; the rules of this package have none.)

References
----------
[1] P. Ljung, A. Ynnerman, Extraction of intersection curves from iso-surfaces on co-located 3D
    grids, sections 4 and 5, tables 2 and 3, eq. 1, appendix A.
[2] P. Guigue, O. Devillers, Fast and robust triangle-triangle overlap test using orientation
    predicates, J. Graphics Tools 8, 2003: order on the common line by signs of tetrahedra.
[3] H. Edelsbrunner, E. P. Muecke, Simulation of simplicity, ACM Transactions on Graphics 9, 1990.
"""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from isoref import asymptotic_decider
from isoref.curves import Curve, check_pair, curves_through, follow
from isoref.field import Booleans, Field, Floats, Integers
from isoref.mesh import Mesh
from isoref.rule import Rule
from isoref.sweep import sweep

Point = tuple[Fraction, Fraction, Fraction]
Triangle = Sequence[Point]
Whole = NDArray[np.object_]

#: A vertex's own number c has so many bits; positions along an edge are rounded to so many.
OWN_BITS = 32
PLACE_BITS = 128

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

    @cached_property
    def motion(self) -> Floats:
        """(V, 3) u: how each vertex moves, per epsilon; zero where the mesh has no lattice.

        On a lattice edge to its outside end, the one with the lesser sample, or from there inwards;
        inside a cell by the mean of what its neighbours on edges do, and off the cell's skin.
        """
        found = self.mesh.provenance
        if found is None:
            return np.zeros_like(self.mesh.vertices)
        low, high = found.ends.T
        samples = found.field.values.reshape(-1)
        outside, inside = np.where(samples[low] < samples[high], (low, high), (high, low))
        at, other = (
            np.array(np.unravel_index(np.where(high < 0, low, end), found.field.shape)).T
            for end in (outside, inside)
        )
        u = (at - other) * np.asarray(found.field.spacing)
        there = (self.mesh.vertices == found.field.position(at)).all(axis=1)
        u[there] *= -1
        inner = high < 0
        u = _led(u, self.mesh.simplices, inner)

        # Move what stands on the skin of its cell to the middle of the cell as well.
        for end, way in ((0, 1), (1, -1)):
            skin = found.field.position(other + end)
            on_skin = inner[:, None] & (self.mesh.vertices == skin)
            u += on_skin * way * np.asarray(found.field.spacing)
        return u

    @cached_property
    def own_number(self) -> Integers:
        """(V,) c, hashed from the vertex's rank in the order in which triangles name them."""
        named = self.mesh.simplices.reshape(-1)
        first = np.full(len(self.mesh.vertices), len(named))
        # Of equal indices the last is assigned: backwards, where a vertex is named first.
        first[named[::-1]] = np.arange(len(named))[::-1]
        used = np.flatnonzero(first < len(named))
        rank = np.zeros(len(self.mesh.vertices), np.int64)
        rank[used[np.argsort(first[used])]] = np.arange(len(used))
        return (rank + 1) * 0x9E3779B1 % (1 << OWN_BITS)

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


def _led(u: Floats, triangles: Integers, inside: NDArray[np.bool_]) -> Floats:
    """The motions u (V, 3), those of vertices `inside` cells led by their neighbours on edges."""
    # Sort the sides of those triangles alone that have such a vertex: mostly there are none.
    triangles = triangles[inside[triangles].any(axis=1)]
    sides = np.unique(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=0)
    sides = np.unique(np.concatenate([sides, sides[:, ::-1]]), axis=0)
    start, stop = sides[inside[sides[:, 0]] & ~inside[sides[:, 1]]].T
    led = np.where(inside[:, None], 0.0, u)
    np.add.at(led, start, u[stop])
    led[inside] /= np.maximum(np.bincount(start, minlength=len(u))[inside], 1)[:, None]
    return led


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
    contact : (S,) whether both triangles are shared: the other surface has one on the same corners
    """

    ends: Floats
    nodes: Integers
    cells: Integers
    tests: int
    contact: Booleans | None = None

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
    places = [[rational(vertex) for vertex in one.mesh.vertices] for one in (first, second)]
    moved = moved_points(first, second)
    rows = first.mesh.simplices.tolist(), second.mesh.simplices.tolist()
    tests = 0
    ends: list[list[list[float]]] = []
    nodes: list[list[int]] = []
    cells: list[int] = []
    pairs: list[tuple[int, int]] = []
    shared: tuple[set[int], set[int]] = set(), set()
    number: dict[Hashable, int] = {}
    for k in range(int(np.prod(first.shape))):
        # Test the triangles of this voxel, each of one surface with each of the other.
        for i in range(int(first.count_through(k - 1)), int(first.count_through(k))):
            for j in range(int(second.count_through(k - 1)), int(second.count_through(k))):
                tests += 1
                a, b = rows[0][i], rows[1][j]
                if {places[0][v] for v in a} == {places[1][v] for v in b}:
                    shared[0].add(i)
                    shared[1].add(j)
                meeting = triangle_intersection(
                    [places[0][v] for v in a],
                    [places[1][v] for v in b],
                    [moved[0][v] for v in a],
                    [moved[1][v] for v in b],
                )
                if meeting is None:
                    continue

                # Note the segment, and name its nodes by what makes them.
                names = [
                    (edge_name(a, end.edge_a, i), edge_name(b, end.edge_b, j)) for end in meeting
                ]
                nodes.append([number.setdefault(name, len(number)) for name in names])
                ends.append([[float(x) for x in end.place] for end in meeting])
                cells.append(k)
                pairs.append((i, j))
    return Segments(
        np.array(ends, np.float64).reshape(-1, 2, 3),
        np.array(nodes, np.int64).reshape(-1, 2),
        np.array(cells, np.int64),
        tests,
        np.array([i in shared[0] and j in shared[1] for i, j in pairs], np.bool_),
    )


def moved_points(first: IndexedSurface, second: IndexedSurface) -> tuple[list[Any], list[Any]]:
    """The vertices of both surfaces after their motion, in whole numbers of one unit."""
    count = len(first.mesh.vertices)
    points = moved(
        np.concatenate([first.mesh.vertices, second.mesh.vertices]),
        np.concatenate([first.motion, second.motion]),
        np.repeat([1, 2], [count, len(second.mesh.vertices)]),
        np.concatenate([first.own_number, second.own_number]),
    ).tolist()
    return points[:count], points[count:]


def moved(places: Floats, motion: Floats, order: Integers, own: Integers) -> Whole:
    """(N, 3) ``p + epsilon^order u + epsilon^3 c u``, in whole numbers of one unit.

    epsilon is 2^-K. Differences of coordinates are below 2^(bits + 1), of u c below
    2^(bits + 1 + OWN_BITS), and a coefficient of a determinant is a sum of 6 products of three
    such terms, each in at most 16 ways: below 2^(K - 1).

    >>> place, motion = np.array([[0.5, 0, 0]]), np.array([[1.0, 0, 0]])
    >>> half, more = (
    ...     moved(place, u, np.array([1]), np.array([0]))[0, 0] for u in (0 * motion, motion)
    ... )
    >>> half < more
    True
    """
    (p, u), _, bits = scaled(np.stack([places, motion]))
    K = 3 * (bits + 1 + OWN_BITS) + 8
    shift = ((3 - order) * K).astype(object)[:, None]
    return np.asarray((p << 3 * K) + (u << shift) + u * own.astype(object)[:, None])


def scaled(numbers: Floats) -> tuple[Whole, int, int]:
    """The numbers exactly: whole ones, the power of two they are times, and their most bits.

    >>> scaled(np.array([0.75, -2.0]))[0] / 2**53
    array([0.75, -2.0], dtype=object)
    """
    mantissa, exponent = np.frexp(numbers)
    there = exponent[mantissa != 0]
    least, most = (int(there.min()), int(there.max())) if there.size else (0, 0)
    shift = np.where(mantissa != 0, exponent - least, 0).astype(object)
    whole = np.ldexp(mantissa, 53).astype(np.int64).astype(object) << shift
    return np.asarray(whole), least - 53, most - least + 53


def edge_name(triangle: Sequence[int], e: int, number: int) -> Hashable:
    """A name for edge e that both triangles at the edge share; for e = -1 the triangle's number."""
    return number if e < 0 else frozenset((triangle[e], triangle[(e + 1) % 3]))


def triangle_intersection(
    a: Triangle, b: Triangle, moved_a: Sequence[Any] = (), moved_b: Sequence[Any] = ()
) -> tuple[End, End] | None:
    """Where two triangles meet: the segment from start to end along D, or None.

    The line common to both planes passes each triangle from an entry to an exit; the segment is
    what both passages share.

    Parameters
    ----------
    a, b : corners, exactly
    moved_a, moved_b : where they stand after their motion, in whole numbers of one unit; by
        default where they are. Signs are asked of these. A point in a plane is behind it

    >>> flat = [rational(p) for p in ((0, 0, 0), (4, 0, 0), (0, 4, 0))]
    >>> wall = [rational(p) for p in ((1, 1, -1), (1, 2, 1), (1, 1, 1))]
    >>> [[float(x) for x in end.place] for end in triangle_intersection(flat, wall) or ()]
    [[1.0, 1.0, 0.0], [1.0, 1.5, 0.0]]
    >>> triangle_intersection(flat, flat) is None
    True
    """
    # Find the edges by which each triangle passes the plane of the other.
    p, q = moved_a or a, moved_b or b
    span_a, span_b = passages(a, p, q), passages(b, q, p)
    if span_a is None or span_b is None:
        return None

    # Order the passages along D by signs of tetrahedra: the first triangle is entered where it
    # passes to the front of the second, and the second is left where it passes to the front of
    # the first.
    (entry_a, exit_a), (exit_b, entry_b) = span_a, span_b

    def beyond(one: Passage, other: Passage) -> Any:
        """Positive where the edge of a is passed before that of b, along D."""
        (e, f), (g, h) = ((passage.edge, (passage.edge + 1) % 3) for passage in (one, other))
        return orientation(p[e], p[f], q[g], q[h])

    if beyond(entry_a, exit_b) <= 0 or beyond(exit_a, entry_b) >= 0:
        return None

    # Take the later entry and the earlier exit; both, where they coincide.
    late, early = beyond(entry_a, entry_b), beyond(exit_a, exit_b)
    start = End(
        (entry_a if late >= 0 else entry_b).place,
        entry_a.edge if late >= 0 else -1,
        entry_b.edge if late <= 0 else -1,
    )
    stop = End(
        (exit_a if early <= 0 else exit_b).place,
        exit_a.edge if early <= 0 else -1,
        exit_b.edge if early >= 0 else -1,
    )
    return start, stop


class Passage(NamedTuple):
    """Where an edge of a triangle passes a plane."""

    place: Point
    edge: int


def passages(
    own: Triangle, moved_own: Sequence[Any], moved_other: Sequence[Any]
) -> tuple[Passage, Passage] | None:
    """Where the boundary of `own` passes the plane of the other: to its front, then to its back.

    None where all of `own` is on one side; in the plane is behind it.
    """
    # See which corners are in front of the plane.
    x, y, z = moved_other
    height = [orientation(x, y, z, point) for point in moved_own]

    # Find the edges between front and back, and where they pass.
    found: dict[bool, Passage] = {}
    for e in range(3):
        low, high = height[e], height[(e + 1) % 3]
        if (low > 0) != (high > 0):
            found[high > 0] = Passage(passage(own[e], own[(e + 1) % 3], low, high), e)
    return (found[True], found[False]) if found else None


def passage(start: Point, stop: Point, low: Any, high: Any) -> Point:
    """Where an edge has height 0, as epsilon goes to 0: its ends, and their heights.

    A ratio of heights is that far from its limit that epsilon tells, so it is rounded.

    >>> [float(x) for x in passage(rational((0, 0, 0)), rational((1, 0, 0)), 1, -1)]
    [0.5, 0.0, 0.0]
    """
    t = Fraction(round(Fraction(low, low - high) * 2**PLACE_BITS), 2**PLACE_BITS)
    x, y, z = (p + t * (q - p) for p, q in zip(start, stop, strict=True))
    return x, y, z


def orientation(a: Any, b: Any, c: Any, d: Any) -> Any:
    """``det[b - a, c - a, d - a]``, exactly: positive where d is in front of triangle abc."""
    return _dot(_cross(_minus(b, a), _minus(c, a)), _minus(d, a))


def rational(point: Floats | tuple[float, ...]) -> Point:
    """The exact value of each coordinate."""
    x, y, z = (Fraction(float(coordinate)) for coordinate in point)
    return x, y, z


def _minus(p: Any, q: Any) -> Any:
    """The vector from q to p."""
    return p[0] - q[0], p[1] - q[1], p[2] - q[2]


def _cross(u: Any, v: Any) -> Any:
    """The cross product."""
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


def _dot(u: Any, v: Any) -> Any:
    """The scalar product."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


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

    A segment is followed by the one that starts on the node it ends on; no tolerance is involved.
    Where a curve runs back where it came from, both ways are left out, and so is a curve that runs
    in shared triangles alone: there is contact, not crossing.
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
    # Link each end to the first free start on its node.
    waiting = defaultdict(list)
    for s, (start, _) in enumerate(segments.nodes.tolist()):
        waiting[start].append(s)
    after = [waiting[stop].pop(0) if waiting[stop] else -1 for _, stop in segments.nodes.tolist()]

    # Follow the links; leave out contact, and what runs back.
    kept = []
    for chain, closed in follow(np.array(after, np.int64)):
        if segments.contact is None or not segments.contact[chain].all():
            left = without_returns(segments.ends[chain], closed)
            if len(left):
                kept.append((chain[left], closed))
    return kept


def without_returns(ends: Floats, closed: bool) -> Integers:
    """Which segments (N, 2, 3) of a chain are left when those that run back are left out.

    A segment and the next one that runs exactly back cancel, as often as it happens; segments of
    no length count for nothing. A closed chain has no beginning, so its ends are compared too.

    >>> there = np.array([[[0.0, 0, 0], [1, 0, 0]]])
    >>> without_returns(np.concatenate([there, there[:, ::-1], there]), closed=False).tolist()
    [2]
    """
    places = [(tuple(start), tuple(stop)) for start, stop in (ends + 0.0).tolist()]
    left: list[int] = []
    for s, (start, stop) in enumerate(places):
        if start == stop:
            continue
        if left and places[left[-1]] == (stop, start):
            left.pop()
        else:
            left.append(s)
    while closed and len(left) > 1 and places[left[-1]] == places[left[0]][::-1]:
        left = left[1:-1]
    return np.array(left, np.int64)


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
