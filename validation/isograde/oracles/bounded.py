"""Numbers with a known error: signs decided in floating point where they can be, exactly else.

The same formula is evaluated twice. In floating point every operation carries a bound on its
error along, and a sign is known where the value is larger than its error. Where it is not, the
formula is evaluated again on integers, whose error is zero: Python's (dtype object), or those of
the machine where they are small enough.

References
----------
1. J. R. Shewchuk: Adaptive precision floating-point arithmetic and fast robust geometric
   predicates. Discrete & Computational Geometry 18, 1997 (the idea of a filter).
2. T. J. Dekker: A floating-point technique for extending the available precision. Numerische
   Mathematik 18, 1971 (what a rounded sum lacks).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import lcm
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Numbers = NDArray[Any]
Ints = NDArray[np.int64]
EPS = 2.0**-52
# Doubles hold all whole numbers up to this one.
LARGEST = 1 << 53


@dataclass(frozen=True)
class Bounded:
    """Numbers known up to `error`; integers have error zero.

    >>> x = Bounded(np.array([1.0]), np.array([0.0])) - Bounded(np.array([1.0]), np.array([0.0]))
    >>> x.sign()[0], x.unsure()[0]
    (np.int64(0), np.True_)
    """

    value: Numbers
    error: Numbers

    def __mul__(self, other: Bounded) -> Bounded:
        product = self.value * other.value
        return Bounded(
            product,
            self._rounding(product)
            + (abs(self.value) + self.error) * other.error
            + abs(other.value) * self.error,
        )

    def __sub__(self, other: Bounded) -> Bounded:
        difference = self.value - other.value
        return Bounded(difference, self._rounding(difference) + self.error + other.error)

    def __add__(self, other: Bounded) -> Bounded:
        return self - Bounded(-other.value, other.error)

    def __getitem__(self, where: Any) -> Bounded:
        return Bounded(self.value[where], self.error[where])

    def _rounding(self, result: Numbers) -> Numbers:
        """A bound on the rounding of one operation, the bound's own rounding included."""
        if result.dtype.kind != "f":
            return result * 0
        bound: Numbers = 4 * EPS * abs(result) + 1e-300
        return bound

    def sign(self) -> Ints:
        """-1, 0 or 1 an entry; 0 where the error leaves the sign open."""
        above, below = self.value > self.error, self.value < -self.error
        return np.asarray(above, np.int64) - np.asarray(below, np.int64)

    def unsure(self) -> NDArray[np.bool_]:
        """Whether the error leaves the sign open."""
        return np.asarray(abs(self.value) <= self.error, bool) & (self.value.dtype.kind == "f")


def integers(rows: ArrayLike, zero: Any = 0) -> Numbers:
    """(n, k) numbers minus `zero` as Python integers, each row times a positive number of its own.

    >>> integers([[0.5, 0.75]], 0.25)
    array([[1, 2]], dtype=object)
    """
    given = np.asarray(rows)
    exact = given.dtype.kind == "f" and given.dtype.itemsize <= 8
    if given.dtype.kind in "biu" and given.size:
        exact = -LARGEST < int(given.min()) and int(given.max()) < LARGEST
    if exact and isinstance(zero, int | float) and float(zero) == zero and given.ndim == 2:
        values = np.column_stack([given.astype(np.float64), np.full(len(given), float(zero))])
        if np.isfinite(values).all():
            whole = _whole(values)
            return np.asarray(whole[:, :-1] - whole[:, -1:])
    taken = np.asarray(rows, object)
    level = Fraction(zero)
    scaled = []
    for row in taken:
        numbers = [Fraction(x.item() if isinstance(x, np.generic) else x) - level for x in row]
        scale = lcm(*(x.denominator for x in numbers))
        scaled.append([int(x * scale) for x in numbers])
    return np.array(scaled, object).reshape(taken.shape)


def _whole(values: NDArray[np.float64]) -> Numbers:
    """(n, k) doubles as Python integers, each row times the least power of two that takes."""
    mantissa, exponent = np.frexp(values)
    digits = (mantissa * 2.0**53).astype(np.int64)
    # Write each number as an odd one times a power of two.
    lowest = np.maximum(np.frexp((digits & -digits).astype(np.float64))[1] - 1, 0)
    power = np.where(digits == 0, 0, exponent - 53 + lowest)
    shift = power - np.minimum(power.min(axis=1, initial=0), 0)[:, None]
    return np.asarray((digits >> lowest).astype(object) << shift.astype(object))


def lost(one: Numbers, other: Numbers, difference: Numbers) -> Numbers:
    """What the rounded difference of two doubles lacks of the exact one [2]."""
    part = difference - one
    return np.asarray((one - (difference - part)) - (other + part))


def rounded(values: Numbers, isovalue: float) -> NDArray[np.bool_]:
    """(n,) whether one of n rows of numbers has a distance from the isovalue that is no double.

    >>> rounded(np.array([[0.4, -0.4, -0.4, 0.5], [2, -1, -1, 1]]), 0.05)
    array([ True,  True])
    >>> rounded(np.array([[0.4, -0.4, -0.4, 0.5]]), 0.25)
    array([False])
    """
    doubles = values.astype(np.float64)
    with np.errstate(over="ignore", invalid="ignore"):
        left = lost(doubles, np.full_like(doubles, isovalue), doubles - isovalue)
    return np.asarray((np.isnan(left) | (left != 0)).any(axis=1))
