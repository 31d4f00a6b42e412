r"""Trilinear cubes: every cell has the topology of its trilinear interpolant.

The asymptotic decider settles what happens on the faces of a cell. Two closed polygons may still
be the rims of two discs or of one *tunnel*, and only the interpolant's interior can say which.
Chernyaev [1] counted 33 cases, and decided the interior by one slice; later work [2-5] found that
one slice is not enough, and that diagonals on cell faces make edges with four triangles where two
tunnels meet. This module decides by the interpolant's own shape and draws nothing on a face but
the polygons.

The interior, without a table
-----------------------------
Cut the cell at t along axis a. The slice is bilinear; its saddle is on the isovalue where

    q(t) = w00 w11 - w10 w01 = 0,

a quadratic, as the slice's corners w are linear in t. Write D for its discriminant. D is the same
on all three axes (Cayley's hyperdeterminant of the eight values). Where D > 0 the interpolant is

    F = A (x - p0)(y - p1)(z - p2) + B (x - r0)(y - r1)(z - r2)

with p and r the roots of the three quadratics, so the level set holds a closed *hexagon* of axis-
parallel segments through the six points that mix p and r: (p0, r1, r2), (p0, r1, p2), ..

::

            r-------*           * the hexagon, on the level set
           /|      /|           p, r: both on one side of it
          * |     * |
          | *-----|-*           There is a tunnel iff A B < 0 and all six roots are inside the
          |/      |/            cell; the hexagon is then its waist. The two body saddles lie on
          *-------p             the line from p to r, on the side of p and r.

So a tunnel is drawn as two bands, from either polygon to its waist. All inner points lie on the
level set, and so do the six sides of the waist.

Glossary
--------
g           (8, n) corner values minus the isovalue
c0, c1, c2  Bernstein coefficients of q: q = c0 (1-t)^2 + c1 t (1-t) + c2 t^2
D           c1^2 - 4 c0 c2
M           the middle of p and r; F has there the sign of the side that the tunnel joins
rim part    a component of the inside (or outside) corners on the cell's skin
pole        p or r, as corners of the box between the roots; the other six make the hexagon

Decisions
---------
bits 0 .. 5  inside corners of ambiguous face f are separated, as in `isoref.asymptotic_decider`
bit 6        a tunnel joins two inside rim parts
bit 7        a tunnel joins two outside rim parts

Which two parts they are follows from the signs (`tunnel`). Bits that no values can set, such as a
tunnel where some axis has c0 c2 < 0, change nothing.

Every decision is exact, as if the values were worked on in endless precision, whatever their sizes:
floats decide where their error cannot matter, and Python's integers, which have no error, the few
cells that are left. So both cells at a face decide it alike, and a tunnel's bit never contradicts
the bits of the faces. An exact D = 0 is no tunnel.

References
----------
[1] E. V. Chernyaev, "Marching cubes 33", CERN CN 95-17, 1995.
[2] A. Lopes, K. Brodlie, "Improving the robustness and accuracy of the marching cubes algorithm
    for isosurfacing", IEEE TVCG 9(1), 2003: body saddles; small changes for small steps.
[3] G. M. Nielson, "On marching cubes", IEEE TVCG 9(3), 2003.
[4] L. Custodio, T. Etiene, S. Pesco, C. Silva, "Practical considerations on marching cubes 33
    topological correctness", Computers & Graphics 37(7), 2013: the interior test mended.
[5] R. Grosso, "Construction of topologically correct and manifold isosurfaces", Computer Graphics
    Forum 35(5), 2016: the hexagon; diagonals on faces.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, partial
from itertools import product
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from isoref import asymptotic_decider
from isoref.cube import CORNERS, EDGES, FACE_CORNERS, ambiguous_faces, configuration, inside
from isoref.cycles import Polygon, Triangle, cycles, fan, triangulate
from isoref.field import Array, Booleans, Floats, Integers
from isoref.rule import Placement, Rule, Tile

INSIDE_TUNNEL, OUTSIDE_TUNNEL = 1 << 6, 1 << 7
FACE_BITS = 0b111111
HALVINGS = 60
TINY = 5e-324

Quadratic = tuple[Array, Array, Array]


# --- decisions: the numbers ---------------------------------------------------------------------


def _slice_corners(g: Array, axis: int, side: int) -> Array:
    """w00, w10, w01, w11 (4, n) at one end of `axis`."""
    others = [a for a in range(3) if a != axis]
    return g[[side << axis | u << others[0] | v << others[1] for v in (0, 1) for u in (0, 1)]]


def quadratic(g: Array, axis: int) -> Quadratic:
    """c0, c1, c2 of q(t) = w00 w11 - w10 w01 on slices across `axis`, for g (8, n).

    >>> g = np.array([3.0, -1, -1, -1, -1, -1, -1, 3]).reshape(8, 1)
    >>> [float(c[0]) for c in quadratic(g, 0)]
    [-4.0, 8.0, -4.0]
    """
    w, z = _slice_corners(g, axis, 0), _slice_corners(g, axis, 1)
    c0 = w[0] * w[3] - w[1] * w[2]
    c2 = z[0] * z[3] - z[1] * z[2]
    c1 = (w[0] * z[3] + z[0] * w[3]) - (w[1] * z[2] + z[1] * w[2])
    return c0, c1, c2


def at_middle(g: Array, c: Sequence[Quadratic]) -> Array:
    """F at M, times a positive number: F has degree 1 in M's coordinates n / d on each axis.

    A tunnel's c0 and c2 have one sign and c1 the other, so nothing cancels in n and d.

    >>> g = np.array([-3.0, 1, 1, 1, 1, 1, 1, -3]).reshape(8, 1)
    >>> [float(h) for h in at_middle(g, [quadratic(g, axis) for axis in range(3)])]
    [0.0]
    """
    values = g.reshape(2, 2, 2, -1)
    for c0, c1, c2 in reversed(c):  # the first index of g is the coordinate along axis 2
        n, d = 2 * c0 - c1, 2 * (c0 - c1 + c2)
        side = sign(d)
        values = values[0] * ((d - n) * side) + values[1] * (n * side)
    return values


def tunnels(g: Floats) -> tuple[Booleans, Booleans]:
    """For n cells: whether there is a tunnel, and whether it joins inside parts, from g (8, n).

    Exact: what floats cannot tell for sure is decided anew in integers, by the same lines.
    """
    there, joins_inside = np.zeros((2, g.shape[1]), bool)
    left = maybe(normalised(g))
    if len(left):
        g = g[:, left]
        there[left], joins_inside[left], sure = read(normalised(g), ERROR, ERROR_AT_MIDDLE)
        doubtful = np.flatnonzero(~sure)
        if len(doubtful):
            exact = read(integers(g[:, doubtful]), 0, 0)
            there[left[doubtful]], joins_inside[left[doubtful]] = exact[:2]
    return there, joins_inside


def maybe(g: Floats) -> Integers:
    """The cells, of n with normalised values g (8, n), that can have a tunnel, (m,) in order.

    Most cells fail the first condition on the first axis beyond doubt: c0 and c2 of one sign, c1 of
    the other. Those that are left are looked at along the second axis, and so on.
    """
    left = np.arange(g.shape[1])
    for axis in range(3):
        c0, c1, c2 = quadratic(g, axis)
        s0, s1, s2 = (sign(x, ERROR) for x in (c0, c1, c2))
        possible = np.flatnonzero((s0 * s2 >= 0) & (s0 * s1 <= 0) & (s1 * s2 <= 0))
        left, g = left[possible], g.take(possible, axis=1)
    return left


def read(g: Array, error: float, error_at_middle: float) -> tuple[Booleans, Booleans, Booleans]:
    """For n cells: a tunnel, it joins inside parts, and both are sure.

    Both roots of c0 (1-t)^2 + c1 t (1-t) + c2 t^2 lie in (0, 1) iff c0 and c2 have one sign, c1
    the other, and D > 0. The product of the three c0 has the sign of A B.

    g : (8, n) values, normalised floats or integers
    error : how far from the truth c0, c1, c2 and D can be; zero for integers
    error_at_middle : the same of F at M
    """
    c = [quadratic(g, axis) for axis in range(3)]
    possible, certain = np.ones((2, g.shape[1]), bool)
    product_of_signs = np.ones(g.shape[1], np.int8)
    for c0, c1, c2 in c:
        s0, s1, s2 = (sign(x, error) for x in (c0, c1, c2))
        D = sign(c1 * c1 - 4 * c0 * c2, error)
        possible &= (s0 * s2 >= 0) & (s0 * s1 <= 0) & (s1 * s2 <= 0) & (D >= 0)
        certain &= (s0 * s2 > 0) & (s0 * s1 < 0) & (D > 0)
        product_of_signs *= s0
    possible &= product_of_signs <= 0
    certain &= product_of_signs < 0
    # A tunnel's F(M) is not zero: A and B have different signs, and F(M) that of +-(A - B).
    side = np.zeros(g.shape[1], np.int8)
    side[certain] = sign(at_middle(g[:, certain], [_of(q, certain) for q in c]), error_at_middle)
    return certain, side > 0, ~possible | (certain & (side != 0))


def _of(q: Quadratic, cells: Booleans) -> Quadratic:
    """The quadratics of some cells."""
    c0, c1, c2 = q
    return c0[cells], c1[cells], c2[cells]


def decisions(g: Floats) -> Integers:
    """The face bits and the tunnel bits of n cells, from g (8, n).

    A face is decided by its own four values, as they are: scaled by what else is in the cell they
    could lose bits, and two cells could decide differently.
    """
    there, joins_inside = tunnels(g)
    bits = np.where(joins_inside, INSIDE_TUNNEL, OUTSIDE_TUNNEL)
    return asymptotic_decider.decisions(g) | np.where(there, bits, 0)


# --- decisions: floats where they are sure, else integers ---------------------------------------
#
# Let |g| <= 1 and let u = 2^-53 be the relative error of one operation. A product of two values is
# off by u at most, so c0 and c2 (at most 2) are off by 4 u, c1 (at most 4) by 12 u, c1^2 by 112 u,
# 4 c0 c2 by 80 u, and D (at most 32) by 224 u: less than 2^-45.
#
# In `at_middle`, n is off by 28 u and d - n by 112 u at most, and |n| + |d - n| = |d| <= 16. A step
# makes the values, and their error, at most 16 times as large, and adds an error of at most 200 u
# times the size the values had: after three steps 200 u, 6,400 u and 153,600 u, less than 2^-35.
# What `ldexp` and products round off below the smallest normal float is far smaller than all this.

ERROR = 2.0**-45
ERROR_AT_MIDDLE = 2.0**-35


def sign(x: Array, error: float = 0) -> NDArray[np.int8]:
    """-1 or 1 where x is that far from zero, else 0; for floats and for Python's integers.

    >>> sign(np.array([-2.0, 0.5, 3.0]), error=1)
    array([-1,  0,  1], dtype=int8)
    """
    return np.asarray((x > error).astype(np.int8) - (x < -error).astype(np.int8))


def normalised(g: Floats) -> Floats:
    """Values g, each cell scaled by a power of two to below 1: no product overflows."""
    _, exponent = np.frexp(np.abs(g).max(axis=0))
    return np.asarray(np.ldexp(g, -exponent))


def integers(g: Floats) -> NDArray[np.object_]:
    """Values g exactly, each cell times a power of two: Python's integers, of any length.

    >>> integers(np.array([[0.5], [-3.0]])).ravel() / 2**52
    array([1.0, -6.0], dtype=object)
    """
    mantissa, exponent = np.frexp(g)
    shift = (exponent - exponent.min(axis=0)).astype(object)
    return np.asarray(np.ldexp(mantissa, 53).astype(np.int64).astype(object) << shift)


def interpolate(g: Floats, points: Floats) -> Floats:
    """F (.., n) at points (.., n, 3), for g (8, n)."""
    values: Floats = g.reshape(2, 2, 2, *(1,) * (points.ndim - 2), -1)
    for axis in (2, 1, 0):  # the first index of g is the coordinate along axis 2
        t = points[..., axis]
        values = values[0] * (1 - t) + values[1] * t
    return values


def asks(signs: int) -> bool:
    """Whether the signs alone do not decide: an ambiguous face, or two opposite corners."""
    return bool(ambiguous_faces(signs)) or configuration(signs) == 4


# --- tiles: the combinatorics -------------------------------------------------------------------


@cache
def rim_parts(signs: int, separated: int) -> tuple[frozenset[int], ...]:
    """The parts of the cell's skin, each by its corners: joined along edges and across faces.

    >>> [sorted(part) for part in rim_parts(0b10000001, 0)]
    [[0], [1, 2, 3, 4, 5, 6], [7]]
    """
    links = [(a, b) for a, b in EDGES if inside(signs, a) == inside(signs, b)]
    for f in ambiguous_faces(signs):
        a, b, c, d = FACE_CORNERS[f]
        links.append((a, c) if inside(signs, a) != _is_cut(separated, f) else (b, d))
    part = list(range(8))
    for a, b in links:
        old, new = max(part[a], part[b]), min(part[a], part[b])
        part = [new if p == old else p for p in part]
    return tuple(frozenset(c for c in range(8) if part[c] == p) for p in sorted(set(part)))


def _is_cut(separated: int, f: int) -> bool:
    """Whether the inside corners of face f are separated."""
    return bool(separated >> f & 1)


def face_sign(signs: int, separated: int, f: int) -> int:
    """The sign of w00 w11 - w10 w01 on face f as far as signs and face bits tell it; else 0.

    >>> face_sign(0b00000001, 0, 0), face_sign(0b00000011, 0, 4)
    (-1, 0)
    """
    axis, side = divmod(f, 2)
    u, v = (1 << a for a in range(3) if a != axis)
    base = side << axis
    w00, w10, w01, w11 = (inside(signs, base | more) for more in (0, u, v, u | v))
    if (w00 == w11) != (w10 == w01):
        return 1 if w00 == w11 else -1
    if w00 == w11 != w10:
        return 1 if w00 != _is_cut(separated, f) else -1
    return 0


@cache
def axis_signs(signs: int, separated: int) -> tuple[int, int, int] | None:
    """The sign of c0 and c2 on each axis, 0 where open; None where no tunnel can be.

    A tunnel needs one sign at both ends of each axis, and a negative product of the three.

    >>> axis_signs(0b10000001, 0), axis_signs(0b00001001, 0)
    ((-1, -1, -1), None)
    """
    found = []
    for axis in range(3):
        ends = {face_sign(signs, separated, 2 * axis + side) for side in (0, 1)} - {0}
        if len(ends) > 1:
            return None
        found.append(ends.pop() if ends else 0)
    x, y, z = found
    return None if x * y * z > 0 else (x, y, z)


@cache
def tunnel(signs: int, decisions: int) -> tuple[Polygon, Polygon] | None:
    """The two polygons that a tunnel joins under these decisions; None where there is none.

    A tunnel that joins two parts of one side pierces the part of the other side between them:
    the one part that has two polygons.
    """
    separated = decisions & FACE_BITS
    bit = decisions & (INSIDE_TUNNEL | OUTSIDE_TUNNEL)
    if bit not in (INSIDE_TUNNEL, OUTSIDE_TUNNEL) or axis_signs(signs, separated) is None:
        return None
    for part in rim_parts(signs, separated):
        if inside(signs, min(part)) != (bit == INSIDE_TUNNEL):
            rims = [p for p in cycles(signs, separated) if part & set(EDGES[p[0]])]
            if len(rims) == 2:
                return rims[0], rims[1]
    return None


@dataclass(frozen=True)
class Waist:
    """The six inner points of a tunnel, in order: corners of the box between the roots.

    corners : bit a set where the point has the greater root on axis a
    swap : where a point would be a pole (p or r), flip these bits: which diagonal of the box the
        poles are on can depend on the values
    """

    corners: tuple[int, ...]
    swap: int


@cache
def waist(signs: int, separated: int) -> Waist:
    """The hexagon of a tunnel cell.

    The sign of c0 on axis a is that of -(r_b - p_b)(r_c - p_c). Read the diagonal p-r off these
    signs; walk round the six other corners of the box. Two open signs are opposite in product, so
    either choice will do for the combinatorics, and the other is reached by a swap.
    """
    known = axis_signs(signs, separated)
    assert known is not None, "only a cell with a tunnel has a waist"
    swap = sum(1 << a for a in range(3) if known[a] == 0)
    _, y, z = next(
        choice
        for choice in product((1, -1), repeat=3)
        if np.prod(choice) < 0 and all(k in (0, c) for k, c in zip(known, choice, strict=True))
    )
    pole = int(_pole(np.array(y), np.array(z)))
    return Waist(tuple(pole ^ step for step in (1, 3, 2, 6, 4, 5)), swap)


def _pole(y: NDArray[Any], z: NDArray[Any]) -> Integers:
    """The box corner p from the signs of c0 on axes 1 and 2, taking r - p positive on axis 0.

    Then r - p has on axis 1 the sign of -z and on axis 2 that of -y; where it is negative, p has
    the greater root.
    """
    return np.asarray((z > 0).astype(np.int64) << 1 | (y > 0).astype(np.int64) << 2)


def _band(polygon: Polygon, loop: list[int], places: Floats) -> tuple[float, list[Triangle]]:
    """The shortest band of triangles from a polygon to a loop that runs alongside, and its cost.

    `places` (18, 3) are typical positions of the nodes; the cost of a band is the sum of its
    cross edges' squared lengths.
    """
    n, m = len(polygon), len(loop)
    best: tuple[float, list[Triangle]] = (np.inf, [])
    for turn in range(m):
        ring = loop[turn:] + loop[:turn]
        cost = np.full((n + 1, m + 1), np.inf)
        cost[0, 0] = 0
        for i, j in product(range(n + 1), range(m + 1)):
            before = min(cost[i - 1, j] if i else np.inf, cost[i, j - 1] if j else np.inf)
            gap = places[polygon[i % n]] - places[ring[j % m]]
            cost[i, j] = gap @ gap + (before if i or j else 0)
        if cost[n, m] < best[0]:
            best = (cost[n, m], _walk_back(polygon, ring, cost))
    return best


def _walk_back(polygon: Polygon, ring: list[int], cost: Floats) -> list[Triangle]:
    """The triangles of the cheapest way from the end of both rings to their start."""
    i, j = len(polygon), len(ring)
    triangles: list[Triangle] = []
    while i or j:
        a, b = polygon[i % len(polygon)], ring[j % len(ring)]
        if j == 0 or (i and cost[i - 1, j] <= cost[i, j - 1]):
            i -= 1
            triangles.append((polygon[i], a, b))
        else:
            j -= 1
            triangles.append((b, ring[j], a))
    return triangles


def _typical_places(corners: tuple[int, ...]) -> Floats:
    """Middles of the twelve edges, and of the box's corners at a quarter and three quarters."""
    edges = [(np.array(CORNERS[a]) + CORNERS[b]) / 2 for a, b in EDGES]
    return np.array([*edges, *(0.25 + 0.5 * np.array(CORNERS[c]) for c in corners)])


@cache
def bands(first: Polygon, second: Polygon, corners: tuple[int, ...]) -> tuple[Triangle, ...]:
    """The triangles of a tunnel: two bands that meet in its waist, nodes 12 .. 17."""
    places = _typical_places(corners)
    loop = list(range(12, 18))
    ways = []
    for one, other in ((loop, loop[::-1]), (loop[::-1], loop)):
        (a, near), (b, far) = _band(first, one, places), _band(second, other, places)
        ways.append((a + b, near + far))
    return tuple(min(ways, key=lambda way: way[0])[1])


@cache
def tile(signs: int, decisions: int, largest: int | None = None) -> Tile:
    """The triangles of the cell: a tunnel where there is one, and a disc for each other polygon.

    A polygon of more than `largest` sides is joined to a point on the level set inside it, not cut
    along diagonals; without a number only those are that no diagonals cut.
    """
    separated = decisions & FACE_BITS
    triangles: list[Triangle] = []
    interior: list[Placement] = []
    joined = tunnel(signs, decisions)
    if joined is not None:
        around = waist(signs, separated)
        triangles += bands(*joined, around.corners)
        interior += [OnWaist(corner, around.swap) for corner in around.corners]
    for polygon in cycles(signs, separated):
        if joined is None or polygon not in joined:
            few = largest is None or len(polygon) <= largest
            pieces = triangulate(polygon) if few else None
            if pieces is None:
                pieces = fan(polygon, 12 + len(interior))
                interior.append(OnSurface(polygon))
            triangles += pieces
    return Tile(tuple(triangles), tuple(interior))


# --- placements: the inner points ---------------------------------------------------------------


def coefficients(g: Floats, axis: int) -> Floats:
    """c0, c1, c2 and D of cells with a tunnel, (4, n): up to a scale, and each with its true sign.

    Where floats lose a sign, the numbers are worked out in integers and rounded once.
    """
    c0, c1, c2 = quadratic(normalised(g), axis)
    found = np.array([c0, c1, c2, c1 * c1 - 4 * c0 * c2])
    doubtful = np.flatnonzero((sign(found, ERROR) == 0).any(axis=0))
    for n in doubtful.tolist():
        exact = [int(c[0]) for c in quadratic(integers(g[:, [n]]), axis)]
        found[:, n] = _rounded(*exact)
    return found


def _rounded(c0: int, c1: int, c2: int) -> list[float]:
    """The integers and their D as floats, scaled to about 1; none but zero becomes zero."""
    size = 1 << max(abs(c).bit_length() for c in (c0, c1, c2))
    exact = [(c0, size), (c1, size), (c2, size), (c1 * c1 - 4 * c0 * c2, size * size)]
    return [x / y or (x > 0) * TINY - (x < 0) * TINY for x, y in exact]


def roots(g: Floats, axis: int) -> tuple[Floats, Floats]:
    """The lesser and the greater root of q in tunnel cells, (n,) each, in [0, 1].

    There c0 and c2 have one sign and c1 the other, so nothing cancels but in D.
    """
    c0, c1, c2, D = coefficients(g, axis)
    half = (2 * c0 - c1 + np.copysign(np.sqrt(np.maximum(D, 0)), c0)) / 2
    first, second = half / (c0 - c1 + c2), c0 / half
    return np.minimum(first, second).clip(0, 1), np.maximum(first, second).clip(0, 1)


@dataclass(frozen=True)
class OnWaist:
    """The placement at one corner of the box between the roots: a corner of the hexagon."""

    corner: int
    swap: int

    asks_crossings: ClassVar[bool] = False

    def __call__(self, g: Floats, crossings: Floats) -> Floats:
        """The points, (n, 3)."""
        return self.finish(g, self.begin(g, crossings))

    def begin(self, g: Floats, crossings: Floats) -> Floats:
        """(n, 2) the corner and what to flip, for each cell."""
        return np.tile(np.array([self.corner, self.swap], np.float64), (g.shape[1], 1))

    @staticmethod
    def finish(g: Floats, begun: Floats) -> Floats:
        """The points, (n, 3)."""
        given, swap = begun.astype(np.int64).T
        y, z = (coefficients(g, axis)[0] for axis in (1, 2))
        pole = _pole(y, z)
        at_pole = (pole == given) | (pole == 7 - given)
        corner = np.where(at_pole, given ^ swap, given)
        points = np.empty((g.shape[1], 3))
        for axis in range(3):
            low, high = roots(g, axis)
            points[:, axis] = np.where(corner >> axis & 1, high, low)
        return points


@dataclass(frozen=True)
class OnSurface:
    """The placement on the level set, near the mean of a polygon's crossings.

    From the mean, towards each corner on the other side of the level set, the first crossing that
    halving finds; the nearest of these.
    """

    polygon: Polygon

    def __call__(self, g: Floats, crossings: Floats) -> Floats:
        """The points, (n, 3)."""
        return self.finish(g, self.begin(g, crossings))

    def begin(self, g: Floats, crossings: Floats) -> Floats:
        """(n, 3) the mean of the polygon's crossings."""
        return np.asarray(crossings[list(self.polygon)].mean(axis=0))

    @staticmethod
    def finish(g: Floats, mean: Floats) -> Floats:
        """The points, (n, 3)."""
        scaled = normalised(g)
        found = _leaves(scaled, mean)
        other_side = (g >= 0) != (interpolate(scaled, mean) >= 0)
        distance = np.where(other_side, ((found - mean) ** 2).sum(axis=-1), np.inf)
        return np.asarray(found[distance.argmin(axis=0), np.arange(len(mean))])


def _leaves(g: Floats, start: Floats) -> Floats:
    """Points (8, n, 3) on the ways from `start` (n, 3) to the corners where F changes its side."""
    way = np.array(CORNERS, float)[:, None] - start
    here = interpolate(g, start) >= 0
    near, far = np.zeros(way.shape[:2]), np.ones(way.shape[:2])
    for _ in range(HALVINGS):
        half = (near + far) / 2
        same = (interpolate(g, start + half[..., None] * way) >= 0) == here
        near, far = np.where(same, half, near), np.where(same, far, half)
    return np.asarray(start + near[..., None] * way)


# --- continuity: what the mesh does where a tunnel ends -------------------------------------------
#
# As the isovalue passes the value of a saddle in the cell, a tunnel's waist shrinks to the saddle
# and parts. The two sheets that are left have their tips there, but two flat discs know nothing of
# it: the mesh jumps. So give each disc a point that comes from the saddle.
#
# Move the origin so that F = h XYZ + A X + B Y + C Z + c. Where R^2 = -ABC/h > 0 the saddles are
# s (R/A, R/B, R/C) with s = 1 and -1, and on the line through both
#
#     F = c + R (3 s - s^3),    2 R above and below c at the saddles.
#
# With k = -c / R the level set meets the line where s^3 - 3 s + k = 0. For k > 2 there is a tunnel
# round the line at s = 1 that joins outside parts, for k < -2 one at s = -1 that joins inside
# parts; in between, the two roots next to that saddle are the tips of its two sheets.


@cache
def candidates(signs: int, decisions: int) -> dict[int, tuple[Polygon, Polygon]]:
    """The two polygons that a tunnel of either kind would join, by its bit, if there was one.

    >>> sorted(candidates(0b10000001, 0)) == [INSIDE_TUNNEL]
    True
    """
    separated = decisions & FACE_BITS
    found = {bit: tunnel(signs, separated | bit) for bit in (INSIDE_TUNNEL, OUTSIDE_TUNNEL)}
    return {bit: pair for bit, pair in found.items() if pair is not None}


@dataclass(frozen=True)
class Axis:
    """The line through both saddles of n cells.

    centre, step : (n, 3) so that the saddles are centre +- step
    k : (n,) where the isovalue is between the saddles' values, from -2 to 2; NaN where there are no
        two saddles
    """

    centre: Floats
    step: Floats
    k: Floats

    @classmethod
    def of(cls, g: Floats) -> Axis:
        """That of cells g (8, n)."""
        # Write F in powers of x, y, z: the coefficient of each product.
        powers = normalised(g).reshape(2, 2, 2, -1).copy()
        for axis in range(3):
            low, high = (powers.take([side], axis=axis) for side in (0, 1))
            powers = np.concatenate([low, high - low], axis=axis)
        one, x, y, xy, z, xz, yz, h = powers.reshape(8, -1)
        with np.errstate(all="ignore"):
            centre = np.array([-yz / h, -xz / h, -xy / h])
            slopes = np.array([x - xy * xz / h, y - xy * yz / h, z - xz * yz / h])
            R = np.sqrt(-slopes.prod(axis=0) / h)
            # At the centre X = Y = Z = 0, so F is c there.
            c = one - x * yz / h - y * xz / h - z * xy / h + 2 * xy * xz * yz / h**2
            return cls(centre.T, (R / slopes).T, -c / R)

    def tips(self, side: int) -> Floats:
        """(2, n, 3) the sheets' points on the line next to the saddle 1 or -1, the inner one first.

        For k beyond the saddle's value, the saddle.
        """
        with np.errstate(all="ignore"):
            third = np.arccos(np.clip(-side * self.k / 2, -1, 1)) / 3
            s = side * 2 * np.cos(np.array([third - 2 * np.pi / 3, third]))
            return np.asarray(self.centre + s[..., None] * self.step)


@dataclass(frozen=True)
class OnTip:
    """The placement of a disc's point: at the tip of its sheet where a tunnel has just ended.

    Half-way between the saddles' values, and beyond, it stands where it would without tunnels; from
    there to the saddle's value it goes to the tip in proportion.

    pairs : by the bit of a tunnel that would end in this disc, the two discs it would join
    """

    polygon: Polygon
    pairs: tuple[tuple[int, tuple[Polygon, Polygon]], ...]

    def __call__(self, g: Floats, crossings: Floats) -> Floats:
        """The points, (n, 3)."""
        triangle = len(self.polygon) == 3
        mean = crossings[list(self.polygon)].mean(axis=0)
        points = mean if triangle else OnSurface(self.polygon)(g, crossings)
        axis = Axis.of(g)
        for bit, (first, second) in self.pairs:
            # Take the outer tip for the disc that is further out on the line.
            side = 1 if bit == OUTSIDE_TUNNEL else -1
            ways = [
                side * ((crossings[list(p)].mean(axis=0) - axis.centre) * axis.step).sum(axis=1)
                for p in (first, second)
            ]
            outer = (ways[0] > ways[1]) == (self.polygon == first)
            near, far = axis.tips(side)
            tip: Floats = np.where(outer[:, None], far, near)

            # Go there in proportion, where the saddle is inside the cell.
            saddle = axis.centre + side * axis.step
            inside_cell = ((saddle > 0) & (saddle < 1)).all(axis=1)
            share = np.where(inside_cell, np.clip(side * axis.k / 2, 0, 1), 0)
            tip = np.where(share[:, None] > 0, np.clip(tip, 0, 1), points)
            points = points + share[:, None] * (tip - points)
        return np.asarray(points)


@cache
def continuous_tile(signs: int, decisions: int) -> Tile:
    """The tile with a point in each disc of four sides or more, or that a tunnel may have left."""
    plain = tile(signs, decisions, 3)
    joined = tunnel(signs, decisions) or ()
    pairs = candidates(signs, decisions)
    triangles, interior = list(plain.triangles), list(plain.interior)
    for polygon in cycles(signs, decisions & FACE_BITS):
        own = tuple((bit, pair) for bit, pair in pairs.items() if polygon in pair)
        if not own or polygon in joined:
            continue
        if len(polygon) == 3:
            at = min(n for n, t in enumerate(triangles) if set(t) == set(polygon))
            triangles[at : at + 1] = fan(polygon, 12 + len(interior))
            interior.append(OnTip(polygon, own))
        else:
            interior[interior.index(OnSurface(polygon))] = OnTip(polygon, own)
    return Tile(tuple(triangles), tuple(interior))


RULE = Rule("trilinear-cubes", tile, decisions, asks, bits=8)

#: The rule whose mesh does not jump where a tunnel ends.
CONTINUOUS = Rule("trilinear-cubes-continuous", continuous_tile, decisions, asks, bits=8)


def drawn(largest: int) -> Rule:
    """The rule with a point on the level set in each polygon of more than `largest` sides.

    The topology is the same, and the triangles lie nearer to the level set. With 3 every polygon
    but a triangle gets its point, which is what Lopes and Brodlie do [2]; with 5, those of six
    sides and more, at far fewer triangles; with 2 triangles too, nearer than theirs and at more.

    Raises
    ------
    ValueError
        for fewer than two sides

    >>> drawn(5).name, len(drawn(5).tile(0b00000011, 0).triangles)
    ('trilinear-cubes-5', 2)
    """
    if largest < 2:
        raise ValueError(f"a polygon has three sides at least: give 2 or more, not {largest}")
    name = f"trilinear-cubes-{largest}"
    return Rule(name, partial(tile, largest=largest), decisions, asks, bits=8)
