"""Fields: numbers on a lattice.

A field is what every algorithm of this package starts from: an array of samples and the place
where the lattice stands in space.

Glossary
--------
n           dimension of the lattice
N1 .. Nn    number of samples along each axis, in the order of the array's axes
m           number of components a sample has (1 for a scalar field)
index       integer coordinates of a sample, (i1, .., in)
position    ``origin + index * spacing``
isovalue    the constant of the isosurface; a sample is *inside* when ``value >= isovalue``

Invariants
----------
Samples are finite numbers, there is at least one along each axis, and spacings are positive:
whoever holds a `Field` need not ask again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[Any]
Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Booleans = NDArray[np.bool_]


class FieldError(ValueError):
    """The input is no field; the message says what is wrong, where, and what to do."""


@dataclass(frozen=True, eq=False)
class Field:
    """Samples on a regular lattice, with the place of the lattice in space.

    Build one with `Field.of`, which checks everything.

    Attributes
    ----------
    values : (N1, .., Nn) array, or (m, N1, .., Nn) for m components
        Real numbers of any integer or floating type, never copied without need.
    spacing, origin : n floats
        Position of index i is ``origin + i * spacing``.
    """

    values: Array
    spacing: tuple[float, ...]
    origin: tuple[float, ...]

    @classmethod
    def of(
        cls,
        values: ArrayLike,
        spacing: float | Sequence[float] | None = None,
        origin: float | Sequence[float] | None = None,
        *,
        dimension: int | None = None,
    ) -> Field:
        """The field with these samples, checked.

        Parameters
        ----------
        values : array-like of real numbers
        spacing : one number for all axes or one an axis; 1 by default
        origin : one number for all axes or one an axis; 0 by default
        dimension : n, where it is not the rank of `values`: with ``dimension = rank - 1`` the
            first axis counts components

        Raises
        ------
        FieldError
            for NaN or infinite samples, an empty array, a wrong rank, a type that is not real,
            a masked array, a spacing that is not positive, an origin that is not finite, or either
            of a wrong length.

        >>> Field.of([[0, 1], [2, 3]], spacing=0.5).position([1, 1])
        array([0.5, 0.5])
        >>> Field.of([[0.0, float("nan")]])
        Traceback (most recent call last):
        isoref.field.FieldError: sample (0, 1) is nan; replace or crop samples that are not finite
        """
        # Read the samples.
        if isinstance(values, np.ma.MaskedArray):
            raise FieldError(
                "a masked array has samples that do not count, and a field has none: fill it "
                "(values.filled(number)) or crop it"
            )
        try:
            samples = np.asarray(values)
        except ValueError as error:
            raise FieldError(f"rows of different lengths are no array: {error}") from None
        n = samples.ndim if dimension is None else dimension
        _check_samples(samples, n)

        # Place the lattice in space.
        steps = _one_an_axis("spacing", 1.0 if spacing is None else spacing, n)
        corner = _one_an_axis("origin", np.zeros(n) if origin is None else origin, n)
        if not (np.isfinite(steps).all() and (steps > 0).all()):
            raise FieldError(f"spacing {steps.tolist()} must be positive and finite on every axis")
        if not np.isfinite(corner).all():
            raise FieldError(f"origin {corner.tolist()} must be {n} finite numbers")
        return cls(samples, tuple(steps.tolist()), tuple(corner.tolist()))

    @property
    def dimension(self) -> int:
        """n, the number of axes of the lattice."""
        return len(self.spacing)

    @property
    def shape(self) -> tuple[int, ...]:
        """(N1, .., Nn), the number of samples along each axis."""
        return self.values.shape[self.values.ndim - self.dimension :]

    @property
    def components(self) -> int:
        """m, the number of values a sample has; 1 for a scalar field."""
        return 1 if self.values.ndim == self.dimension else self.values.shape[0]

    def position(self, index: ArrayLike) -> Floats:
        """``origin + index * spacing`` for fractional indices of shape (.., n)."""
        place: Floats = np.multiply(index, self.spacing) + np.asarray(self.origin, np.float64)
        return place


def _one_an_axis(what: str, given: ArrayLike, n: int) -> Floats:
    """(n,) numbers, one of them for all axes where one is given; else a FieldError."""
    try:
        numbers = np.asarray(given, np.float64)
    except (TypeError, ValueError):
        raise FieldError(f"{what} {given!r} is not made of numbers") from None
    if numbers.shape not in ((), (n,)):
        raise FieldError(
            f"{what} {numbers.tolist()} does not fit {n} axes; give {n} numbers, one an axis"
        )
    return np.broadcast_to(numbers, (n,))


def _check_samples(samples: Array, n: int) -> None:
    """Raise FieldError unless `samples` are real, finite and fill an n-dimensional lattice."""
    if samples.dtype.kind not in "biuf":
        raise FieldError(f"samples of type {samples.dtype} are not real numbers")
    if n < 1 or samples.ndim not in (n, n + 1):
        raise FieldError(
            f"an array of rank {samples.ndim} does not fill a lattice of dimension {n}"
        )
    if samples.size == 0:
        raise FieldError(f"an array of shape {samples.shape} has no samples")
    # Look at both ends of the range: NaN is passed on by both, and no copy is made.
    if samples.dtype.kind == "f" and not np.isfinite([samples.min(), samples.max()]).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(samples))[0])
        raise FieldError(
            f"sample {where} is {samples[where]}; replace or crop samples that are not finite"
        )


def check_isovalue(isovalue: float) -> float:
    """`isovalue` as a finite float, or a `FieldError` that says what it was.

    >>> check_isovalue(3)
    3.0
    """
    try:
        number = float(isovalue)
    except (TypeError, ValueError):
        raise FieldError(f"isovalue {isovalue!r} is not a number") from None
    if not np.isfinite(number):
        raise FieldError(f"isovalue {number} is not finite")
    return number


def least_inside(dtype: np.dtype[Any], isovalue: float) -> Any:
    """The least number of type `dtype` that is not below the isovalue.

    A comparison would round the isovalue to the samples' type; this rounds it up, so that the
    comparison stays exact, and cheap.

    >>> least_inside(np.dtype(np.uint8), 3.2)
    4
    >>> float(least_inside(np.dtype(np.float32), 0.3)) >= 0.3
    True
    """
    if dtype.kind in "biu":
        return int(np.ceil(isovalue))
    with np.errstate(over="ignore"):
        rounded = dtype.type(isovalue)
    if rounded < isovalue:
        rounded = np.nextafter(rounded, dtype.type(np.inf))
    return rounded


def inside_samples(field: Field, isovalue: float) -> Booleans:
    """Which samples are inside, of the shape of the samples: value >= isovalue, exactly."""
    mask: Booleans = field.values >= least_inside(field.values.dtype, isovalue)
    return mask
