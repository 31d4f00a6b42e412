"""Triangles of one mesh that meet where they should not, by exact arithmetic.

Idea
----
Two triangles of a sound mesh meet in what they share: in nothing, in a common vertex, or in a
common edge. Anything more is a *self-intersection*, be it a touch in a single point. Which
vertices are common is a matter of their names: weld a mesh of loose triangles first.

Only triangles whose boxes meet are compared. Triangles of an isosurface are about as large as a
cell, so the boxes are sorted into bins as large as the largest of them; on a mesh with one triangle
a cell or more these are the cells of the lattice.

What is asked of a pair is whether something parts them:

    nothing shared  a plane with one triangle strictly on either side. If there is any, there is one
                    along a side of each, along one of the triangles, or, where they lie in
                    parallel planes, across these and along a side.
    a vertex        a plane through it that parts the two angles at it, and meets at most one side
                    of each. If there is any, there is one along one of the triangles or along a
                    side of each; angles in one plane are apart when neither holds a side of the
                    other.
    an edge         the triangles are in different half planes of the edge.

Nearly all pairs are parted for certain, mostly by the plane of one of the triangles, and a few
determinants in floating point say so (`_parted`). Of the rest every sign is tried in floating point
with a bound on its error (`isograde.oracles.bounded`); the pairs that nothing parts for certain are
asked again in integers.
Triangles without area, and pairs of triangles with the same three vertices, are left out: other
claims name them.

Glossary
--------
p, q        corners of the two triangles of a pair, (n, 3, 3), those they share first
apart       (n,) the triangles meet in nothing but what they share, for certain
n, m        normals of the two triangles

References
----------
1. S. Gottschalk, M. C. Lin, D. Manocha: OBBTree. SIGGRAPH '96, section 5 (separating axes).
2. P. Guigue, O. Devillers: Fast and robust triangle-triangle overlap test using orientation
   predicates. Journal of Graphics Tools 8(1), 2003.
3. J. R. Shewchuk: Adaptive precision floating-point arithmetic and fast robust geometric
   predicates. Discrete & Computational Geometry 18, 1997.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cache
from itertools import product

import numpy as np
from isoref.field import Booleans, Floats, Integers

from isograde.oracles.bounded import EPS, Bounded, Numbers, integers
from isograde.oracles.rows import distinct

PORTION, CACHED = 200_000, 1 << 13
"""Pairs of triangles that are looked for at a time, and that are compared: those fit the cache."""

FEW = 48
"""Faces of which all pairs are compared."""

FINE = 64
"""Differences of coordinates are below 2 FINE^2 = 2^13, and every number below 3 * 2^54."""


def self_intersections(points: Floats, faces: Integers) -> Integers:
    """(k, 2) pairs of faces, the lower first, that meet in more than the vertices they share.

    >>> points = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, -1], [1, 1, 1], [9, 9, 0]]
    >>> self_intersections(np.array(points, float), np.array([[0, 1, 2], [3, 4, 5]]))
    array([[0, 1]])
    """
    planes = _planes(points, faces)
    found = [np.empty((0, 2), np.int64)]
    for pairs in near_pairs(points, faces):
        for at in range(0, len(pairs), CACHED):
            some = pairs[at : at + CACHED]
            found.append(some[_meet(points, faces, planes, some)])
    every = np.concatenate(found)
    crossing: Integers = every[distinct(every)[0]]
    return crossing


def _meet(points: Floats, faces: Integers, planes: Floats, pairs: Integers) -> Booleans:
    """(n,) the triangles of the pair meet in more than they share."""
    meet = np.zeros(len(pairs), bool)
    open_ = np.flatnonzero(~_parted(points, faces, planes, pairs))
    if not len(open_):
        return meet
    corners, shared = _shared_first(faces[pairs[open_]])
    for number, apart in enumerate((_apart, _apart_at_vertex, _apart_at_edge)):
        rows = np.flatnonzero(shared == number)
        if not len(rows):
            continue
        # Ask at once in integers where those of the machine do, else first in floating point.
        fine = _on_fine_grid(points[corners[rows]])
        small, rest = rows[fine], rows[~fine]
        rest = rest[~_ask(apart, points[corners[rest]])]
        for some, numbers in ((small, _small), (rest, integers)):
            meet[open_[some]] = ~_ask(apart, numbers(points[corners[some]].reshape(-1, 18)))
    return meet


# --- what floating point says for certain ---------------------------------------------------------

# Coordinates stand first here, then corners, then pairs: sums over coordinates are then sums of
# arrays, and not of three numbers at a time.


def _parted(points: Floats, faces: Integers, planes: Floats, pairs: Integers) -> Booleans:
    """(n,) something parts the two triangles for certain, the corners they share apart.

    What floating point leaves open is not parted: touches, triangles in one plane, near misses.

    planes : of all faces, as `_planes` gives them
    """
    one, other = (np.ascontiguousarray(faces.take(pairs[:, side], axis=0).T) for side in (0, 1))
    same = one[:, None] == other[None]
    held = same[:, 0] | same[:, 1] | same[:, 2], same[0] | same[1] | same[2]
    shared = held[0].sum(axis=0, dtype=np.int8)
    parted = np.zeros(len(pairs), bool)
    for number, parts in enumerate((_disjoint_parted, _vertex_parted, _edge_parted)):
        rows = (shared == number).nonzero()[0]
        if len(rows):
            here, there = (_Near(points, planes, pairs[rows, side]) for side in (0, 1))
            free = [
                _free(face.take(rows, axis=1), own.take(rows, axis=1), 3 - number)
                for face, own in ((one, held[0]), (other, held[1]))
            ]
            parted[rows] = parts(here, there, *free)
    return parted


class _Near:
    """Triangles of n pairs, one of each: on which side of their planes the others' corners are."""

    def __init__(self, points: Floats, planes: Floats, which: Integers) -> None:
        self.points, self.planes, self.which = points, planes, which

    def side(self, corners: Integers, rows: Integers | None = None) -> Integers:
        """(k, n) as `_side_of_plane` of these corners (k, n), or of the pairs in `rows` alone."""
        which = self.which
        if rows is not None:
            which, corners = which.take(rows), corners.take(rows, axis=1)
        planes = np.ascontiguousarray(self.planes.take(which, axis=0).T)
        places = np.ascontiguousarray(self.points.take(corners.reshape(-1), axis=0).T)
        return _side_of_plane(planes, places.reshape(3, *corners.shape))


def _free(corners: Integers, held: Booleans, count: int) -> Integers:
    """(count, n) corners of each triangle (3, n) that are not shared; two as they run round it."""
    if count == 3:
        return corners
    code = held[0] + 2 * held[1].view(np.int8) + 4 * held[2].view(np.int8)
    at = _FREE_FIRST[:count].take(code, axis=1)
    at *= corners.shape[1]
    at += np.arange(corners.shape[1])
    free: Integers = corners.reshape(-1).take(at)
    return free


_FREE_FIRST = np.array(
    [[0, 1, 2], [1, 2, 0], [2, 0, 1], [2, 0, 1], [0, 1, 2], [1, 0, 2], [0, 1, 2], [0, 1, 2]]
).T.copy()
"""By the corners that are shared, one bit each."""


def _disjoint_parted(one: _Near, other: _Near, p: Integers, q: Integers) -> Booleans:
    """(n,) triangles that share nothing are parted by the plane of one, or along a side of each."""
    parted = _on_one_side(one.side(q))
    rows = (~parted).nonzero()[0]
    if len(rows):
        parted[rows] = _on_one_side(other.side(p, rows))
        rows = rows[~parted[rows]]
    if len(rows):
        places = (one.points.take(own.take(rows, axis=1), axis=0) for own in (p, q))
        parted[rows] = _parted_along_sides(*(of.transpose(2, 0, 1).copy() for of in places))
    return parted


def _on_one_side(side: Integers) -> Booleans:
    """(n,) all three corners are on one side for certain."""
    total = side.sum(axis=0, dtype=np.int8)
    return np.asarray((total == 3) | (total == -3))


def _parted_along_sides(p: Floats, q: Floats) -> Booleans:
    """(n,) one of two triangles (3, 3, n) is for certain further than the other along some axis.

    It is that from middle to middle, or one across a side of each.
    """
    origin = p[:, :1].copy()
    p -= origin
    q -= origin
    parted = _apart_along((q.sum(axis=1) - p.sum(axis=1))[:, None], p, q)
    rows = (~parted).nonzero()[0]
    if len(rows):
        p, q = p.take(rows, axis=2), q.take(rows, axis=2)
        along, other = (corners[:, [1, 2, 0]] - corners for corners in (p, q))
        a, b = along[:, :, None], other[:, None]
        after, before = [1, 2, 0], [2, 0, 1]
        axes = a[after] * b[before]
        axes -= a[before] * b[after]
        parted[rows] = _apart_along(axes.reshape(3, 9, -1), p, q)
    return parted


def _apart_along(axes: Floats, p: Floats, q: Floats) -> Booleans:
    """(n,) along one of the axes (3, k, n) one of two triangles is for certain further.

    However an axis was rounded, triangles that are apart along it are apart.
    """
    largest = np.maximum(np.abs(p).max(axis=1), np.abs(q).max(axis=1))
    bound = (np.abs(axes) * largest[:, None]).sum(axis=0)
    bound *= 32 * EPS
    bound += 1e-300
    here, there = ((axes[:, None] * of[:, :, None]).sum(axis=0) for of in (p, q))
    further = there.min(axis=0) - here.max(axis=0) > bound
    further |= here.min(axis=0) - there.max(axis=0) > bound
    return np.asarray(further.any(axis=0))


def _vertex_parted(one: _Near, other: _Near, p: Integers, q: Integers) -> Booleans:
    """(n,) triangles that share a corner meet, for certain, in nothing else.

    With n and m the normals, a0, a1 and b0, b1 the sides that leave the corner, `_apart_at_vertex`
    asks for the signs of n.b0, n.b1, m.a0, m.a1 and of determinants, which are these but for sign:
    det(ai, bj, ak) = -n.bj for i = 0, and so on. Where either pair has one sign, a plane of a
    triangle parts them; else what is across a side of each, where n.b0 and m.a0 have one sign.
    """
    s = one.side(q)
    alike = s[0] * s[1]
    parted: Booleans = alike > 0
    rows = (~parted).nonzero()[0]
    if len(rows):
        t = other.side(p, rows)
        across = (alike[rows] < 0) & (t[0] * t[1] < 0) & (s[0, rows] * t[0] > 0)
        parted[rows] = (t[0] * t[1] > 0) | across
    return parted


def _edge_parted(one: _Near, other: _Near, p: Integers, q: Integers) -> Booleans:
    """(n,) triangles that share an edge are, for certain, not in one plane."""
    del other, p
    return np.asarray(one.side(q)[0] != 0)


def _planes(points: Floats, faces: Integers) -> Floats:
    """(F, 9) of each triangle its first corner, its normal, and the size of what made that."""
    planes = np.empty((len(faces), 9))
    after, before = [1, 2, 0], [2, 0, 1]
    for at in range(0, len(faces), CACHED):
        some = slice(at, at + CACHED)
        p, a, b = (np.ascontiguousarray(points.take(own, axis=0).T) for own in faces[some].T)
        a, b = a - p, b - p
        one, other = a[after] * b[before], a[before] * b[after]
        made = np.concatenate([p, one - other, np.abs(one) + np.abs(other)])
        planes[some] = made.T
    return planes


def _side_of_plane(planes: Floats, places: Floats) -> Integers:
    """(k, n) on which side of its plane each place (3, k, n) is, 0 where rounding leaves it open.

    planes : (9, n)

    The bound is that of [3], section 4, for the determinant of differences, doubled.
    """
    start, normal, size = planes.reshape(3, 3, 1, -1)
    away = places - start
    determinant = (away * normal).sum(axis=0)
    np.abs(away, out=away)
    away *= size
    bound = away.sum(axis=0)
    bound *= 16 * EPS
    bound += 1e-300
    return np.asarray((determinant > bound).view(np.int8) - (determinant < -bound).view(np.int8))


def _ask(apart: Callable[[Bounded, Bounded], Booleans], numbers: Numbers) -> Booleans:
    """(n,) what `apart` says of pairs of triangles, 18 exact numbers each."""
    if not len(numbers):
        return np.empty(0, bool)
    corners = numbers.reshape(-1, 2, 3, 3)
    p, q = corners[:, 0], corners[:, 1]
    return apart(Bounded(p, p * 0), Bounded(q, q * 0))


def _on_fine_grid(corners: Floats) -> Booleans:
    """(n,) all coordinates are multiples of 1 / FINE below FINE: no product of four overflows."""
    scaled = corners.reshape(-1, 18) * FINE
    return np.asarray(((scaled == np.rint(scaled)) & (np.abs(scaled) < FINE**2)).all(axis=1))


def _small(rows: Floats) -> Integers:
    """Such coordinates as integers of the machine."""
    return np.asarray(rows * FINE, np.int64)


# --- which pairs ----------------------------------------------------------------------------------


def near_pairs(points: Floats, faces: Integers) -> Iterator[Integers]:
    """Pairs (n, 2) of faces whose boxes meet, each once, in portions."""
    corners = [np.ascontiguousarray(points.take(corner, axis=0).T) for corner in faces.T]
    low, high = np.minimum.reduce(corners), np.maximum.reduce(corners)
    for one, other in _every_pair(len(faces)) or _in_one_bin(*_bins(low.T, high.T)):
        found = [np.empty((0, 2), np.int64)]
        for at in range(0, len(one), CACHED):
            first, second = one[at : at + CACHED], other[at : at + CACHED]
            near = (low.take(first, axis=1) <= high.take(second, axis=1)).all(axis=0)
            near &= (low.take(second, axis=1) <= high.take(first, axis=1)).all(axis=0)
            rows = near.nonzero()[0]
            first, second = first.take(rows), second.take(rows)
            found.append(np.stack([np.minimum(first, second), np.maximum(first, second)], axis=1))
        yield np.concatenate(found)


def _every_pair(count: int) -> list[tuple[Integers, Integers]]:
    """All pairs of so few faces that sorting them into bins costs more; else no portion."""
    if count > FEW:
        return []
    return [_each_with_each(count)]


@cache
def _each_with_each(count: int) -> tuple[Integers, Integers]:
    """Every pair of so many things, each once."""
    one, other = np.triu_indices(count, 1)
    return one, other


def _bins(low: Floats, high: Floats) -> tuple[Integers, Integers, Integers]:
    """(face, bin, which) for every bin that the face's box meets: at most eight each.

    which : a bit an axis, set where the bin is not the face's first one along it
    """
    if not len(low):
        none = np.empty(0, np.int64)
        return none, none, none
    start = low.min(axis=0)
    size = np.maximum((high - low).max(axis=0), (high.max(axis=0) - start) / 2**20)
    size = np.where(size > 0, size, 1.0)
    first = np.floor((low - start) / size).astype(np.int64)
    last = np.floor((high - start) / size).astype(np.int64)
    both = (last > first) @ np.array([1, 2, 4])
    name = first @ STEPS
    face, place, which = [], [], []
    for offset in range(8):
        rows = ((both & offset) == offset).nonzero()[0]
        step = sum(int(STEPS[axis]) for axis in range(3) if offset >> axis & 1)
        face.append(rows)
        place.append(name.take(rows) + step)
        which.append(np.full(len(rows), offset))
    return np.concatenate(face), np.concatenate(place), np.concatenate(which)


STEPS = np.array([1 << 42, 1 << 21, 1])
"""From the name of a bin to those of the next ones along the axes."""


def _in_one_bin(
    face: Integers, place: Integers, which: Integers
) -> Iterator[tuple[Integers, Integers]]:
    """Pairs of faces in one bin, in portions: each with the one that is `step` after it.

    Two boxes that meet do so in several bins. They are a pair in the one that is the first, along
    each axis, of one or the other.
    """
    order = np.argsort(place, kind="stable")
    face, place, which = face[order], place[order], which[order]
    waiting: list[tuple[Integers, Integers]] = []
    step, rows = 1, np.arange(len(face))
    while len(rows):
        rows = rows[: rows.searchsorted(len(face) - step)]
        after = rows + step
        rows = rows.take((place.take(rows) == place.take(after)).nonzero()[0])
        after = rows + step
        kept = ((which.take(rows) & which.take(after)) == 0).nonzero()[0]
        waiting.append((face.take(rows.take(kept)), face.take(after.take(kept))))
        step += 1
        if sum(len(one) for one, _ in waiting) > PORTION:
            yield _joined(waiting)
            waiting = []
    if waiting:
        yield _joined(waiting)


def _joined(waiting: list[tuple[Integers, Integers]]) -> tuple[Integers, Integers]:
    """The pairs end to end."""
    ones, others = zip(*waiting, strict=True)
    return np.concatenate(ones), np.concatenate(others)


def _shared_first(faces: Integers) -> tuple[Integers, Integers]:
    """Corners (n, 2, 3) of the pairs with those they share first, and how many these are (n,).

    >>> corners, shared = _shared_first(np.array([[[7, 8, 9], [5, 9, 8]]]))
    >>> corners.tolist(), shared.tolist()
    ([[[8, 9, 7], [8, 9, 5]]], [2])
    """
    one, other = faces[:, 0], faces[:, 1]
    same = one[:, :, None] == other[:, None, :]
    shared = same.any(axis=2).sum(axis=1)
    # Sort each triangle by (not shared, name): the shared ones then stand in the same order.
    turned = []
    for corners, common in ((one, same.any(axis=2)), (other, same.any(axis=1))):
        order = np.lexsort((corners, ~common), axis=1)
        turned.append(np.take_along_axis(corners, order, axis=1))
    return np.stack(turned, axis=1), shared


# --- vectors --------------------------------------------------------------------------------------


def _cross(a: Bounded, b: Bounded) -> Bounded:
    """(.., 3) cross products."""
    left, right = [1, 2, 0], [2, 0, 1]
    return a[..., left] * b[..., right] - a[..., right] * b[..., left]


def _dot(a: Bounded, b: Bounded) -> Bounded:
    """(..,) inner products."""
    terms = a * b
    return terms[..., 0] + terms[..., 1] + terms[..., 2]


def _stacked(vectors: Sequence[Bounded]) -> Bounded:
    """(n, k, 3) these k vectors (n, 3)."""
    return Bounded(np.stack([v.value for v in vectors], 1), np.stack([v.error for v in vectors], 1))


def _sides(p: Bounded) -> list[Bounded]:
    """The three sides of triangles (n, 3, 3)."""
    return [p[:, (i + 1) % 3] - p[:, i] for i in range(3)]


def _flat(*normals: Bounded) -> Booleans:
    """(n,) one of the normals is zero for certain: a triangle without area, not compared."""
    zero = [((n.sign() == 0) & ~n.unsure()).all(axis=1) for n in normals]
    return np.asarray(np.logical_or.reduce(zero))


# --- what parts two triangles ---------------------------------------------------------------------


def _apart(p: Bounded, q: Bounded) -> Booleans:
    """(n,) triangles that share nothing do not meet."""
    n, m = (
        _cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) for corners in (p, q)
    )
    apart = _flat(n, m) | _parts(_stacked([n, m]), p, q)
    rest = np.flatnonzero(~apart)
    apart[rest] = _apart_along_sides(p[rest], q[rest], n[rest], m[rest])
    return apart


def _apart_along_sides(p: Bounded, q: Bounded, n: Bounded, m: Bounded) -> Booleans:
    """(n,) triangles are parted by a plane along a side of each, or across one and along a side."""
    along, other = _sides(p), _sides(q)
    axes = [_cross(a, b) for a, b in product(along, other)]
    axes += [_cross(n, a) for a in along] + [_cross(m, b) for b in other]
    return _parts(_stacked(axes), p, q)


def _parts(axes: Bounded, p: Bounded, q: Bounded) -> Booleans:
    """(n,) along one of the axes (n, k, 3) all of q is further than all of p, or nearer."""
    first = p[:, :1]
    here = _dot(axes[:, :, None], (p - first)[:, None])
    there = _dot(axes[:, :, None], (q - first)[:, None])
    signs = (there[:, :, None, :] - here[:, :, :, None]).sign()
    parted = np.asarray((signs > 0).all(axis=(2, 3)) | (signs < 0).all(axis=(2, 3)))
    return np.asarray(np.logical_or.reduce(parted, axis=1))


def _apart_at_vertex(p: Bounded, q: Bounded) -> Booleans:
    """(n,) triangles that share their first corner meet in nothing else."""
    one = [p[:, i] - p[:, 0] for i in (1, 2)]
    other = [q[:, i] - q[:, 0] for i in (1, 2)]
    n, m = _cross(*one), _cross(*other)
    apart = _flat(n, m)
    above = [_dot(n, v).sign() for v in other]
    apart |= above[0] * above[1] > 0
    apart |= np.multiply(*(_dot(m, v).sign() for v in one)) > 0
    for i, j in product((0, 1), repeat=2):
        axis = _cross(one[i], other[j])
        apart |= _dot(axis, one[1 - i]).sign() * _dot(axis, other[1 - j]).sign() < 0
    level = [_dot(n, v) for v in other]
    in_plane = np.logical_and.reduce([(v.sign() == 0) & ~v.unsure() for v in level])
    return np.asarray(apart | (in_plane & _angles_apart(n, m, one, other)))


def _angles_apart(n: Bounded, m: Bounded, one: list[Bounded], other: list[Bounded]) -> Booleans:
    """(n,) angles in one plane hold no side of each other."""
    held = [_holds(n, one, v) for v in other] + [_holds(m, other, v) for v in one]
    return np.asarray(~np.logical_or.reduce(held))


def _holds(n: Bounded, angle: list[Bounded], v: Bounded) -> Booleans:
    """(n,) v is in the closed angle, whose normal is n, or may be."""
    after, before = _dot(n, _cross(angle[0], v)), _dot(n, _cross(v, angle[1]))
    return np.asarray((after.sign() >= 0) & (before.sign() >= 0))


def _apart_at_edge(p: Bounded, q: Bounded) -> Booleans:
    """(n,) triangles that share their first two corners meet in nothing but that edge."""
    edge = p[:, 1] - p[:, 0]
    n, m = _cross(edge, p[:, 2] - p[:, 0]), _cross(edge, q[:, 2] - q[:, 0])
    bent = _dot(n, q[:, 2] - q[:, 0]).sign() != 0
    return np.asarray(_flat(n, m) | bent | (_dot(n, m).sign() < 0))
