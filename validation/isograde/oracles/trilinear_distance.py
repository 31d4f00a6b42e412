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
    t = points - cell
    total, slope = np.zeros(len(points)), np.zeros((len(points), 3))
    for corner in np.ndindex(2, 2, 2):
        sample = values[tuple((cell + np.array(corner)).T)]
        weights = np.where(np.array(corner), t, 1 - t)
        total += sample * weights.prod(axis=1)
        for axis in range(3):
            others = np.delete(weights, axis, axis=1).prod(axis=1)
            slope[:, axis] += sample * others * (1 if corner[axis] else -1)
    return total, slope


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
