"""Implementations that sample a function themselves, asked about fields of samples.

Such an implementation declares ``{"given": "function", "vertices": {"own": reach}}``, and is a
function ``extract(function, lower, upper, spacing, isovalue)``:

function    of n coordinates, floats or arrays of one shape, to a float or an array: the multilinear
            interpolant of the field's samples, continued constantly beyond them; of a known body
            sampled in double precision the body's own function, as a ball's radius less the
            distance from its centre
lower, upper
            tuples of n floats, the ends of the box
spacing     a tuple of n floats: how fine the field is, and its own samples should be
isovalue    a float
answer      as of any function in Python, in the coordinates of the box

It is judged as one whose vertices stand on a lattice of its own. A program in another language is
sent samples: it makes a function of them itself, and declares its vertices as its own. Where a
failure is shown without the grader, the functions of this module are printed: they need NumPy
alone.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable
from typing import Any

import numpy as np


def on_samples(given: Callable[..., Any]) -> Callable[..., Any]:
    """The extractor `given` a function, as one that is given samples.

    >>> def ends(function, lower, upper, spacing, isovalue):
    ...     return function(*lower), function(*upper), function(0.5)
    >>> on_samples(ends)(np.array([3, 5, 6]), 4.5, (1.0,))
    (3.0, 6.0, 4.0)
    """

    def extract(values: Any, isovalue: Any, spacing: Any, function: Any = None) -> Any:
        """What it makes of the interpolant of the samples, or of what they are samples of."""
        upper = tuple((n - 1) * h for n, h in zip(values.shape, spacing, strict=True))
        lower = (0.0,) * len(upper)
        asked = interpolant(values, spacing) if function is None else function
        return given(asked, lower, upper, tuple(spacing), isovalue)

    return extract


def interpolant(values: Any, spacing: Any) -> Callable[..., Any]:
    """The multilinear interpolant, continued constantly beyond the lattice.

    >>> at = interpolant(np.array([[0, 1], [2, 3]]), (1.0, 2.0))
    >>> at(0.5, 1.0), at(np.array([0.5, 9.0]), np.array([1.0, 0.0])).tolist()
    (1.5, [1.5, 2.0])
    """
    flat = np.ascontiguousarray(values, np.float64).ravel()
    numbers = array("d", flat.tobytes())  # An array of Python's gives floats, and quickly.
    strides = [int(np.prod(values.shape[axis + 1 :])) for axis in range(values.ndim)]

    def at(*place: Any) -> Any:
        """The value at a place, or at many."""
        many = isinstance(sum(place), np.ndarray)
        low: Any = 0
        shares = []
        for p, h, size, stride in zip(place, spacing, values.shape, strides, strict=True):
            cell, share = (cells if many else cell_of)(p / h, size)
            low = low + cell * stride
            shares.append((share, stride if size > 1 else 0))
        return within(flat if many else numbers, low, shares)

    return at


def cell_of(index: float, size: int) -> tuple[int, float]:
    """The cell on an axis of so many samples that an index is in, and its share of the cell."""
    if index <= 0.0:
        return 0, 0.0
    if index >= size - 1:
        return size - 1, 0.0
    cell = int(index)
    return cell, index - cell


def cells(index: Any, size: int) -> tuple[Any, Any]:
    """The cells of many indices, and their shares."""
    inside = np.clip(index, 0.0, size - 1.0)
    cell = np.minimum(inside.astype(np.int64), max(size - 2, 0))
    return cell, inside - cell


def within(numbers: Any, low: Any, shares: Any) -> Any:
    """The interpolant in the cell that begins at `low`, at these shares of its sides."""
    if not shares:
        return numbers[low]
    (share, step), *others = shares
    first = within(numbers, low, others)
    if isinstance(share, float) and not share:
        return first
    return first * (1 - share) + within(numbers, low + step, others) * share
