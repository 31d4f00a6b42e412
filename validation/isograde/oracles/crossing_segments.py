"""Segments in the plane that meet where they should not, by exact arithmetic.

Two segments of a sound mesh meet in nothing, or in a vertex that both name. Where they share one
they meet in more when they run the same way along one line; otherwise they are apart when one has
both ends strictly on one side of the other's line, or, on one line, when neither reaches the
other. Signs are tried in floating point with a bound on the error, and asked again in rational
numbers where the bound does not tell. Segments without length, and pairs with the same ends, are
left out: other claims name them.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from isoref.field import Booleans, Floats, Integers

from isograde.oracles.self_intersections import near_pairs

ROUNDING = 16 * float(np.finfo(np.float64).eps)


def crossing_segments(points: Floats, segments: Integers) -> Integers:
    """(r, 2) pairs of segments, the lower first, that meet in more than the vertices they share.

    >>> points = np.array([[0, 0], [2, 2], [0, 2], [2, 0.0]])
    >>> crossing_segments(points, np.array([[0, 1], [2, 3]]))
    array([[0, 1]])
    """
    in_space = np.column_stack([points, np.zeros(len(points))])
    found = [np.empty((0, 2), np.int64)]
    for pairs in near_pairs(in_space, segments):
        found.append(pairs[_meet(points, segments[pairs])])
    return np.unique(np.concatenate(found), axis=0)


def _meet(points: Floats, pairs: Integers) -> Booleans:
    """(r,) the two segments of the pair meet in more than they share."""
    shared = (pairs[:, 0, :, None] == pairs[:, 1, None, :]).sum(axis=(1, 2))
    a, b = points[pairs[:, 0, 0]], points[pairs[:, 0, 1]]
    c, d = points[pairs[:, 1, 0]], points[pairs[:, 1, 1]]
    parted = (_turn(a, b, c) * _turn(a, b, d) > 0) | (_turn(c, d, a) * _turn(c, d, b) > 0)
    length = (a != b).any(axis=1) & (c != d).any(axis=1)
    # Those that touch or share a vertex are few, and on one line fewer still.
    meet = np.asarray((shared == 0) & length & ~parted)
    for row in np.flatnonzero(meet):
        meet[row] = not _apart_on_line(a[row], b[row], c[row], d[row])
    for row in np.flatnonzero((shared == 1) & length):
        meet[row] = _folded(points, pairs[row])
    return meet


def _turn(a: Floats, b: Floats, c: Floats) -> Integers:
    """(r,) sign of the area of the triangles a b c."""
    u, v = b - a, c - a
    left, right = u[:, 0] * v[:, 1], u[:, 1] * v[:, 0]
    sign = np.sign(left - right).astype(np.int64)
    size = np.abs(a).max(axis=1) + np.abs(b).max(axis=1) + np.abs(c).max(axis=1)
    reach = np.abs(u).max(axis=1) + np.abs(v).max(axis=1)
    for row in np.flatnonzero(np.abs(left - right) <= ROUNDING * size * (reach + size * ROUNDING)):
        sign[row] = _exact_turn(a[row], b[row], c[row])
    return sign


def _exact_turn(a: Floats, b: Floats, c: Floats) -> int:
    """The sign in rational numbers."""
    (ax, ay), (bx, by), (cx, cy) = ([Fraction(x) for x in p.tolist()] for p in (a, b, c))
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return (area > 0) - (area < 0)


def _apart_on_line(a: Floats, b: Floats, c: Floats, d: Floats) -> bool:
    """Segments that no line parts are on one line, and have no point in common."""
    boxes = [(np.minimum(p, q), np.maximum(p, q)) for p, q in ((a, b), (c, d))]
    (low, high), (least, most) = boxes
    return bool(((high < least) | (most < low)).any())


def _folded(points: Floats, pair: Integers) -> bool:
    """Two segments with a common vertex run the same way from it."""
    one, other = pair.tolist()
    common = next(iter(set(one) & set(other)))
    b, d = ((set(x) - {common}).pop() for x in (one, other))
    at, p, q = points[common], points[b], points[d]
    return _exact_turn(at, p, q) == 0 and float((p - at) @ (q - at)) > 0
