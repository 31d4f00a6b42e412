"""The truth about contours of a 2-D field: what they cross, what they enclose, how squares join.

Everything is in index coordinates, x along axis 0 and y along axis 1, so that "left" of a
direction (dx, dy) is (-dy, dx). A *step* leads from a sample to its upper neighbour along one
axis; a *square* has samples at its four corners; its edges are steps.

Glossary
--------
segment     (2, 2): from a point to the next one of the same contour
side        whether a sample is inside, value >= isovalue
ambiguous   a square whose inside corners are two opposite ones
joined      the contour leaves the inside corners of an ambiguous square connected
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

Points = NDArray[np.float64]
Integers = NDArray[np.int64]
Booleans = NDArray[np.bool_]
Edge = tuple[int, int, int]

# Coordinates this near to a whole number are taken for it: single precision in 1000 samples.
SNAP = 1e-4


def snapped(places: Points) -> Points:
    """Places, with coordinates that are almost whole made whole."""
    whole = np.rint(places)
    return np.where(np.abs(places - whole) < SNAP, whole, places)


def segments(contours: Sequence[Points]) -> Points:
    """(n, 2, 2) the segments of all contours."""
    pieces = [np.stack([c[:-1], c[1:]], axis=1) for c in contours if len(c) > 1]
    return np.concatenate([*pieces, np.empty((0, 2, 2))])


def farthest(parts: Points, others: Points) -> float:
    """The greatest difference in a coordinate between a segment and the other one most like it.

    Segments may run either way. Without others it is infinite, without segments 0.

    >>> farthest(np.array([[[0, 0], [1, 2]]]), np.array([[[1, 2], [0, 0.5]]]))
    0.5
    """
    both = np.concatenate([others, others[:, ::-1]]).reshape(-1, 4)
    if not len(parts) or not len(both):
        return np.inf if len(parts) else 0.0
    return float(np.max(KDTree(both).query(parts.reshape(-1, 4), p=np.inf)[0]))


def crossings(parts: Points, shape: tuple[int, ...], axis: int) -> Integers:
    """How often contours cross each step along `axis`, from right to left minus left to right.

    A step has its lower sample on the left of whatever crosses it "from right to left": the
    number is inside(lower) - inside(upper) where contours keep the inside on their left.
    """
    # Look along the steps: s runs with them, t across; for axis 1 the plane is mirrored.
    s, t = parts[..., axis], parts[..., 1 - axis]
    count = np.zeros((shape[axis] - 1, shape[1 - axis]), np.int64)
    for line in range(shape[1 - axis]):
        # A point on a line belongs to the segment below it; on the first line, to the one above.
        above = t > line if line == 0 else t >= line
        for up, sign in ((above[:, 1] & ~above[:, 0], 1), (above[:, 0] & ~above[:, 1], -1)):
            at = np.flatnonzero(up)
            share = (line - t[at, 0]) / (t[at, 1] - t[at, 0])
            step = np.floor(s[at, 0] + share * (s[at, 1] - s[at, 0])).astype(np.int64)
            step = step[(step >= 0) & (step < len(count))]
            np.add.at(count[:, line], step, sign)
    return count if axis == 0 else -count.T


def enclosed_area(contours: Sequence[Points]) -> float:
    """The signed area of closed contours, positive counterclockwise."""
    return 0.5 * sum(float(c[:-1, 0] @ c[1:, 1] - c[1:, 0] @ c[:-1, 1]) for c in contours)


def crossing_pairs(parts: Points) -> Integers:
    """(n, 2) numbers of segments that cross each other away from their ends."""
    found = []
    for first in range(len(parts) - 1):
        others = np.arange(first + 1, len(parts))
        a, b = parts[first]
        c, d = parts[others, 0], parts[others, 1]
        apart = _turn(a, b, c) * _turn(a, b, d) < 0
        apart &= _turn(c, d, a) * _turn(c, d, b) < 0
        found += [(first, int(n)) for n in others[apart]]
    return np.array(found, np.int64).reshape(-1, 2)


def _turn(a: Points, b: Points, c: Points) -> NDArray[Any]:
    """Twice the signed area of the triangles a b c, zero where it drowns in rounding."""
    u, v = b - a, c - a
    area = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    return np.where(np.abs(area) < 1e-12, 0.0, area)


def edge_of(place: Points) -> Edge | None:
    """The lattice edge (i, j, axis) a point lies inside of, or None."""
    whole = place == np.rint(place)
    if whole.all() or not whole.any():
        return None
    i, j = (int(x) for x in np.floor(place))
    return i, j, int(whole[0])


def squares(parts: Points) -> dict[tuple[int, int], list[frozenset[Edge | None]]]:
    """Square (i, j) -> the pairs of edges that its segments join; None for a point off an edge."""
    found: dict[tuple[int, int], list[frozenset[Edge | None]]] = {}
    for part in parts:
        i, j = (int(x) for x in np.floor(part.mean(axis=0)))
        found.setdefault((i, j), []).append(frozenset(edge_of(end) for end in part))
    return found


def legal(inside: Booleans) -> Mapping[tuple[int, int], list[set[frozenset[Edge]]]]:
    """Square -> its legal sets of pairs: one, or separated and joined where it is ambiguous."""
    four = np.stack([inside[:-1, :-1], inside[1:, :-1], inside[:-1, 1:], inside[1:, 1:]])
    active = np.argwhere(four.any(axis=0) & ~four.all(axis=0))
    return {(i, j): _legal(i, j, inside[i : i + 2, j : j + 2]) for i, j in active.tolist()}


def _legal(i: int, j: int, side: Booleans) -> list[set[frozenset[Edge]]]:
    """The legal sets of pairs of one square with these sides, which differ."""
    # Each corner has the two edges of the square that meet in it.
    corners: dict[tuple[int, int], frozenset[Edge]] = {
        (a, b): frozenset({(i, j + b, 0), (i + a, j, 1)}) for a in (0, 1) for b in (0, 1)
    }
    cut = {c: bool(side[c]) for c in corners}
    within = [c for c in corners if cut[c]]
    without = [c for c in corners if not cut[c]]
    if len(within) == 2 and within[0][0] != within[1][0] and within[0][1] != within[1][1]:
        return [{corners[c] for c in within}, {corners[c] for c in without}]
    few = min(within, without, key=len)
    if len(few) == 1:
        return [{corners[few[0]]}]
    # Two neighbours: the edges that leave them on either side.
    return [{corners[few[0]] ^ corners[few[1]]}]


def joins(values: NDArray[Any], isovalue: float) -> dict[str, bool | None]:
    """Rule -> whether it joins the inside corners of an ambiguous square (2, 2); None for a tie."""
    (a, b), (c, d) = values.astype(np.float64) - isovalue
    mean = a + b + c + d
    # The bilinear interpolant at its saddle, times a denominator with the sign of a.
    saddle = (a * d - b * c) * np.sign(a + d - b - c)
    return {
        "separate": False,
        "join": True,
        "mean": None if mean == 0 else bool(mean > 0),
        "saddle": None if saddle == 0 else bool(saddle > 0),
    }
