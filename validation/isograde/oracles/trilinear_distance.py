"""How far points are from the level set of the trilinear interpolant.

From each point Newton's steps along the gradient lead to the level set. Where they end is on it, so
the way back to the point is an upper bound of its distance; near a smooth surface it is the
distance but for a share that shrinks with it.

References
----------
1. G. Taubin: Distance approximations for rasterizing implicit curves. ACM TOG 13(1), 1994 (value
   over gradient as a distance).
"""

from __future__ import annotations

import numpy as np
from isoref.field import Array, Floats

STEPS = 20


def value_and_gradient(values: Array, points: Floats) -> tuple[Floats, Floats]:
    """F (n,) and its gradient (n, 3) of the trilinear interpolant at index coordinates (n, 3).

    >>> value, slope = value_and_gradient(np.arange(8.0).reshape(2, 2, 2), np.full((1, 3), 0.5))
    >>> value, slope
    (array([3.5]), array([[4., 2., 1.]]))
    """
    cell = np.clip(np.floor(points).astype(np.int64), 0, np.subtract(values.shape, 2))
    sides = [(1 - t, t) for t in np.ascontiguousarray((points - cell).T)]
    steps = np.array([values.shape[1] * values.shape[2], values.shape[2], 1])
    flat, low = values.reshape(-1), cell @ steps
    total, slope = np.zeros(len(points)), np.zeros((3, len(points)))
    for corner in np.ndindex(2, 2, 2):
        sample = flat.take(low + int(steps @ corner))
        weights = [pair[side] for pair, side in zip(sides, corner, strict=True)]
        total += sample * (weights[0] * weights[1] * weights[2])
        for axis, (one, other) in enumerate(((1, 2), (0, 2), (0, 1))):
            step = sample * (weights[one] * weights[other])
            (np.add if corner[axis] else np.subtract)(slope[axis], step, out=slope[axis])
    return total, slope.T


def distance(values: Array, isovalue: float, points: Floats) -> Floats:
    """(n,) distance of points, in spacings, from the level set; NaN where no step led to it."""
    last = np.subtract(values.shape, 1.0)
    close = 1e-9 * max(float(np.ptp(values)), np.finfo(float).tiny)
    at = np.clip(points, 0, last)
    away = np.full(len(points), np.nan)
    walking = np.arange(len(points))
    for _ in range(STEPS):
        value, slope = value_and_gradient(values, at[walking])
        value -= isovalue
        there = np.abs(value) <= close
        arrived = walking[there]
        away[arrived] = np.linalg.norm(at[arrived] - points[arrived], axis=1)
        walking, value, slope = walking[~there], value[~there], slope[~there]
        if not len(walking):
            break
        size = np.maximum((slope**2).sum(axis=1), np.finfo(float).tiny)
        at[walking] = np.clip(at[walking] - (value / size)[:, None] * slope, 0, last)
    return away
