"""DICONEX, vectorised: the numbers of `isoref.diconex`.

All vectors at once, as rows (i, j, r) of an array, in an image with a frame of inactive pixels, so
that every pixel has its neighbours.
"""

from __future__ import annotations

from typing import get_args

import numpy as np
from numpy.typing import ArrayLike

from isoref.diconex import (
    DIRECTIONS,
    Border,
    Contours,
    Mode,
    as_field,
    average_is_active,
    check_choice,
)
from isoref.field import Array, Booleans, Field, Floats, Integers, check_isovalue, inside_samples
from isoref.sweep import crossing_parameter


def diconex(
    values: ArrayLike | Field,
    isovalue: float,
    *,
    mode: Mode = "mixed",
    border: Border = "open",
    displaced: bool = True,
) -> Contours:
    """The contours round the active pixels; see `isoref.diconex.diconex`."""
    field, alpha, active = framed(values, isovalue, 2, mode, border)
    vectors = initial_contour_vectors(active)
    successor = successors(vectors, active, poa_joined(field.values, alpha, mode))
    outer = _reaches_outside(vectors, field.shape)
    index = vectors[:, :2] - 1 + 0.5 * np.asarray(DIRECTIONS)[vectors[:, 2]]
    if displaced:
        inner = np.flatnonzero(~outer)
        index[inner] = _displaced(field.values, alpha, vectors[inner])
    contours = Contours(field.position(index), successor)
    return contours if border == "closed" else _without(contours, outer)


def framed(
    values: ArrayLike | Field, isovalue: float, dimension: int, mode: str, border: str
) -> tuple[Field, float, Booleans]:
    """The field, the isovalue, and which samples are active, in a frame of inactive ones.

    The frame, one sample wide, gives every pixel its neighbours. Errors are those of `diconex`.
    """
    field = as_field(values, dimension)
    alpha = check_isovalue(isovalue)
    check_choice("mode", mode, get_args(Mode))
    check_choice("border", border, get_args(Border))
    return field, alpha, np.pad(inside_samples(field, alpha), 1)


def initial_contour_vectors(active: Booleans) -> Integers:
    """(N, 3) rows (i, j, r): active pixels and the directions of their inactive neighbours.

    `active` is framed by inactive pixels. Rows are sorted. See Figs. 1b and 1c.
    """
    neighbour = np.stack([np.roll(active, (-i, -j), (0, 1)) for i, j in DIRECTIONS], axis=-1)
    return np.argwhere(active[..., None] & ~neighbour)


def successors(vectors: Integers, active: Booleans, joined: Booleans) -> Integers:
    """(N,) the row of the vector that follows each vector, as in Fig. 1d.

    `joined` tells of each corner of the framed image, at [i, j] the one between pixels (i, j) and
    (i + 1, j + 1), whether a point of ambiguity there connects.
    """
    move = np.asarray(DIRECTIONS)
    v, r = vectors[:, :2], vectors[:, 2]
    d = (r + 1) % 4
    p, q = v + move[d], v + move[d] + move[r]
    p_active, q_active = active[tuple(p.T)], active[tuple(q.T)]
    # Turn right where both pixels ahead are active, and at a point of ambiguity that connects.
    corner = np.minimum(v, q)
    right = q_active & (p_active | joined[tuple(corner.T)])
    straight = p_active & ~q_active
    pixel = np.where(right[:, None], q, np.where(straight[:, None], p, v))
    direction = np.where(right, (d + 2) % 4, np.where(straight, r, d))
    return np.searchsorted(_keys(vectors, active), _keys(np.c_[pixel, direction], active))


def _keys(vectors: Integers, active: Booleans) -> Integers:
    """One number a row (i, j, r), in the order of the rows."""
    keys: Integers = (vectors[:, 0] * active.shape[1] + vectors[:, 1]) * 4 + vectors[:, 2]
    return keys


def poa_joined(values: Array, alpha: float, mode: Mode) -> Booleans:
    """(N1 + 1, N2 + 1) booleans: whether a point of ambiguity at that corner connects.

    In mixed mode it does where the average of the four pixels is active (section III.B). Corners
    on the border of the image are never ambiguous and stay False.
    """
    joined = np.zeros((values.shape[0] + 1, values.shape[1] + 1), np.bool_)
    inside = joined[1:-1, 1:-1]
    if mode == "mixed":
        grey = values.astype(np.float64) - alpha
        inside[:] = average_is_active(grey[:-1, :-1], grey[1:, 1:], grey[1:, :-1], grey[:-1, 1:])
    else:
        inside[:] = mode == "connect"
    return joined


def _displaced(values: Array, alpha: float, vectors: Integers) -> Floats:
    """(N, 2) indices of the points at the isovalue, between each pixel and its neighbour."""
    v, step = vectors[:, :2] - 1, np.asarray(DIRECTIONS)[vectors[:, 2]]
    return between(values, alpha, np.minimum(v, v + step), np.abs(step))


def between(values: Array, alpha: float, lower: Integers, step: Integers) -> Floats:
    """(N, n) where linear interpolation meets `alpha` between samples `lower` and lower + step.

    >>> between(np.array([133, 0]), 100, np.array([[0]]), np.array([[1]])).round(4)  # Fig. 2c
    array([[0.2481]])
    """
    ends = [values[tuple(i.T)].astype(np.float64) - alpha for i in (lower, lower + step)]
    return np.asarray(lower + crossing_parameter(*ends)[:, None] * step)


def _reaches_outside(vectors: Integers, shape: tuple[int, ...]) -> Booleans:
    """Whether a vector's inactive pixel lies outside the image."""
    w = vectors[:, :2] - 1 + np.asarray(DIRECTIONS)[vectors[:, 2]]
    outside: Booleans = ((w < 0) | (w >= shape)).any(axis=1)
    return outside


def _without(contours: Contours, outer: Booleans) -> Contours:
    """The contours cut open at the vectors marked `outer`."""
    number = np.where(outer, -1, np.cumsum(~outer) - 1)
    return Contours(contours.points[~outer], number[contours.successor[~outer]])
