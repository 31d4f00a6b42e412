r"""The Kuhn triangulation, and the function that is linear on each of its simplices.

A cube of dimension n is cut into n! simplices, one for each order J in which a path may climb
from its lowest corner to its highest, one axis at a time::

    (0,1)-----(1,1)      J = (0, 1): first along axis 0, then along axis 1
      |       / |        J = (1, 0): first along axis 1, then along axis 0
      | (1,0)/  |        both share the diagonal
      |    /    |
      |  / (0,1)|
    (0,0)-----(1,0)

Neighbouring cubes are cut alike on the face they share, so that the simplices of all cubes of a
lattice triangulate space. A function on the lattice then has one continuous extension that is
linear on every simplex: there is nothing ambiguous left to decide.

Glossary
--------
n       dimension
J       a permutation of the axes 0 .. n-1
C_J     simplex of the unit cube: the points with 1 >= x_J(0) >= .. >= x_J(n-1) >= 0
v_k     vertex k of C_J; v_0 is the lowest corner and v_k = v_(k-1) + e_J(k-1)
corner  number of a corner of the cube; bit i is its coordinate along axis i (see `isoref.cube`)
phi     values on the lattice, phi^ (hat) their simplicial interpolant

Invariants
----------
The C_J fill the cube, have volume 1/n! each, and meet in common faces. The vertices v_0 .. v_n
come in increasing order of every linear numbering of the lattice. The sign of J is the
orientation of (v_0, .., v_n).

References
----------
1. C. Min, "Simplicial isosurfacing in arbitrary dimension and codimension", 2003: section 2.1
   (triangulation), section 2.2 (interpolation, equation 1, theorem 2.1).
2. H. W. Kuhn, "Some combinatorial lemmas in topology", IBM J. Res. Develop. 4, 1960.
"""

from __future__ import annotations

import itertools
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from isoref.field import Field, FieldError, Floats, Integers


@cache
def permutations(n: int) -> Integers:
    """Row by row the n! permutations J of the axes, in lexicographic order.

    >>> permutations(2).tolist()
    [[0, 1], [1, 0]]
    """
    return np.array(list(itertools.permutations(range(n))), np.int64).reshape(-1, n)


@cache
def signs(n: int) -> Integers:
    """The sign of each permutation: the orientation of C_J, with its vertices v_0 .. v_n.

    >>> signs(2).tolist()
    [1, -1]
    """
    J = permutations(n)
    inversions = sum(
        (J[:, i] > J[:, j]).astype(np.int64) for i in range(n) for j in range(i + 1, n)
    )
    return np.asarray(1 - 2 * (inversions % 2), np.int64) * np.ones(len(J), np.int64)


@cache
def chains(n: int) -> Integers:
    """Row by row the corners v_0 .. v_n of C_J, for the permutations in their order.

    >>> chains(2).tolist()
    [[0, 1, 3], [0, 2, 3]]
    """
    steps = np.cumsum(1 << permutations(n), axis=1)
    return np.hstack([np.zeros((len(steps), 1), np.int64), steps])


@cache
def corner_offsets(n: int) -> Integers:
    """The coordinates of the 2^n corners, (2^n, n), each 0 or 1.

    >>> corner_offsets(2).tolist()
    [[0, 0], [1, 0], [0, 1], [1, 1]]
    """
    return (np.arange(1 << n)[:, None] >> np.arange(n)) & 1


def box_simplices(a: ArrayLike, b: ArrayLike) -> Floats:
    """The vertices of the n! simplices of the box [a_1, b_1] x .. x [a_n, b_n], (n!, n+1, n).

    Raises
    ------
    FieldError
        where a box has no inside.

    >>> box_simplices([0, 0], [2, 1])[0].tolist()
    [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]]
    """
    low, high = np.asarray(a, np.float64), np.asarray(b, np.float64)
    if low.shape != high.shape or low.ndim != 1 or not (low < high).all():
        raise FieldError(f"the box from {low.tolist()} to {high.tolist()} has no inside")
    corners = np.where(corner_offsets(len(low)) == 1, high, low)
    return np.asarray(corners[chains(len(low))])


def strides(shape: tuple[int, ...]) -> Integers:
    """Steps in the number of a sample, in C order, for one step along each axis.

    >>> strides((4, 5, 6)).tolist()
    [30, 6, 1]
    """
    return np.append(np.cumprod(shape[:0:-1], dtype=np.int64)[::-1], 1).astype(np.int64)


def lattice_simplices(shape: tuple[int, ...]) -> tuple[Integers, Integers]:
    """All simplices of a lattice as rows of sample numbers (C order), and their orientations.

    Meant for small lattices and for reading; `isoref.simplicial` lists only those it needs.

    >>> lattice_simplices((2, 2))[0].tolist()
    [[0, 2, 3], [0, 1, 3]]
    """
    n = len(shape)
    step = strides(shape)
    lowest = np.indices([N - 1 for N in shape]).reshape(n, -1).T @ step
    corner = corner_offsets(n) @ step
    rows = lowest[:, None, None] + corner[chains(n)]
    return rows.reshape(-1, n + 1), np.tile(signs(n), len(lowest))


def interpolate(field: Field, points: ArrayLike) -> Floats:
    """phi^ at the points, (P, n) positions in space: (P, m), by Kuhn's procedure (section 2.2).

    The fractional coordinates y are sorted, y_J(0) >= .. >= y_J(n-1); the sorted sequence
    1, y_J(0), .., y_J(n-1), 0 falls by the barycentric coordinates of v_0 .. v_n.

    Raises
    ------
    FieldError
        for a point outside the lattice or a lattice one sample thick.

    >>> interpolate(Field.of([[0.0, 1.0], [2.0, 7.0]]), [[0.5, 0.25]]).tolist()
    [[2.25]]
    """
    # Find the cell of each point, and its coordinates there.
    shape = np.asarray(field.shape)
    place = field.index(points)
    check_thickness(field.shape)
    if not ((place >= 0) & (place <= shape - 1)).all():
        raise FieldError("a point lies outside the lattice; interpolate inside it only")
    a = np.minimum(np.floor(place).astype(np.int64), shape - 2)
    y = place - a

    # Sort the coordinates: they fall by the barycentric ones.
    J = np.argsort(-y, axis=1, kind="stable")
    falling = np.take_along_axis(y, J, axis=1)
    ones, zeros = np.ones((len(y), 1)), np.zeros((len(y), 1))
    barycentric = -np.diff(np.hstack([ones, falling, zeros]), axis=1)

    # Climb from the lowest corner, one axis at a time, and average.
    step = strides(field.shape)
    vertex = np.cumsum(np.hstack([(a @ step)[:, None], step[J]]), axis=1)
    phi = field.values.reshape(field.components, -1).astype(np.float64)
    return np.asarray(np.einsum("pk,mpk->pm", barycentric, phi[:, vertex]))


def gradient(simplex_values: ArrayLike, J: ArrayLike, spacing: ArrayLike) -> Floats:
    """The gradient of phi^ on simplices, by divided differences (equation 1).

    Parameters
    ----------
    simplex_values : (.., n+1) values at v_0 .. v_n
    J : (.., n) the permutation of each simplex
    spacing : n numbers

    >>> gradient([1.0, 3.0, 4.0], [1, 0], [1.0, 0.5]).tolist()
    [1.0, 4.0]
    """
    order = np.asarray(J, np.int64)
    slopes = np.diff(np.asarray(simplex_values, np.float64), axis=-1)
    slopes = slopes / np.asarray(spacing, np.float64)[order]
    order, slopes = np.broadcast_arrays(order, slopes)
    out = np.empty(slopes.shape)
    np.put_along_axis(out, order, slopes, axis=-1)
    return out


def check_thickness(shape: tuple[int, ...]) -> None:
    """Raise FieldError, with the axis that is too thin, unless a lattice has cells."""
    for axis, N in enumerate(shape):
        if N < 2:
            raise FieldError(
                f"the lattice {shape} is {N} sample thick along axis {axis}; "
                "a cell takes 2 samples along each axis"
            )
