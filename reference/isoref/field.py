"""Fields: numbers on a lattice.

A field is what every algorithm of this package starts from: an array of samples and the place
where the lattice stands in space.

Glossary
--------
n           dimension of the lattice
N1 .. Nn    number of samples along each axis, in the order of the array's axes
m           number of components a sample has (1 for a scalar field)
index       integer coordinates of a sample, (i1, .., in)
direction   of an axis: the unit vector in space along which its index grows
position    ``origin + sum of index_a * spacing_a * direction_a``; where axis a of the array is axis
            a of space, as it is unless something else is said, ``origin + index * spacing``
straight    a field whose axes are those of space
isovalue    the constant of the isosurface; a sample is *inside* when ``value >= isovalue``

Invariants
----------
Samples are finite numbers, there is at least one along each axis, spacings are positive, and
directions have length one and are independent: whoever holds a `Field` need not ask again.
Directions need not be at right angles: a scanner's gantry may be tilted.
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


#: How far from 1 the length of a direction may be, and how small the volume of all of them.
UNIT, FLAT = 1e-3, 1e-6


class FieldError(ValueError):
    """The input is no field; the message says what is wrong, where, and what to do."""


@dataclass(frozen=True, eq=False)
class Field:
    """Samples on a regular lattice, with the place of the lattice in space.

    Build one with `Field.of`, which checks everything.

    Attributes
    ----------
    values : (N1, .., Nn) array, or (m, N1, .., Nn) for m components
        of real numbers of any integer or floating type, never copied without need.
    spacing, origin : n floats
        each; the position of index i is ``origin + i * spacing`` in a straight field.
    directions : n rows of n floats, one an axis, or None for a straight field
    """

    values: Array
    spacing: tuple[float, ...]
    origin: tuple[float, ...]
    directions: tuple[tuple[float, ...], ...] | None = None

    @classmethod
    def of(
        cls,
        values: ArrayLike,
        spacing: float | Sequence[float] | None = None,
        origin: float | Sequence[float] | None = None,
        *,
        directions: ArrayLike | None = None,
        dimension: int | None = None,
    ) -> Field:
        """The field with these samples, checked.

        Parameters
        ----------
        values : array-like of real numbers
        spacing : one number for all axes or one an axis; 1 by default
        origin : one number for all axes or one an axis; 0 by default
        directions : (n, n), for each axis of the array the unit vector along which it runs in
            space; by default axis a runs along axis a of space
        dimension : n, where it is not the rank of `values`: with ``dimension = rank - 1`` the
            first axis counts components

        Raises
        ------
        FieldError
            for NaN or infinite samples, an empty array, a wrong rank, a type that is not real,
            a masked array, a spacing that is not positive, an origin that is not finite, either
            of a wrong length, or directions that are no n independent vectors of length one.

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
                "(values.filled(number)), crop it, or let extract leave them out (absent=True)"
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
        frame = None if directions is None else _frame(directions, n)
        return cls(samples, tuple(steps.tolist()), tuple(corner.tolist()), frame)

    @classmethod
    def of_affine(cls, values: ArrayLike, affine: ArrayLike) -> Field:
        """The scalar field whose sample i stands at ``affine @ (i1, .., in, 1)``.

        Parameters
        ----------
        values : (N1, .., Nn) real numbers
        affine : (n + 1, n + 1), its last row (0, .., 0, 1), as nibabel gives it

        Raises
        ------
        FieldError
            for a matrix of another shape, one that is not finite or flattens space, and as `of`.

        >>> turned = [[0, -2, 0, 5], [1, 0, 0, 6], [0, 0, 3, 7], [0, 0, 0, 1]]
        >>> Field.of_affine(np.zeros((4, 4, 4)), turned).position([1, 1, 0]).tolist()
        [3.0, 7.0, 7.0]
        """
        n = np.ndim(values)
        matrix = np.asarray(affine, np.float64)
        if matrix.shape != (n + 1, n + 1) or not np.isfinite(matrix).all():
            raise FieldError(f"the affine of {n} axes is {n + 1} by {n + 1} finite numbers")
        if matrix[n].tolist() != [0.0] * n + [1.0]:
            raise FieldError(f"the last row of an affine is 0, .., 0, 1, not {matrix[n].tolist()}")
        steps = matrix[:n, :n].T
        lengths = np.linalg.norm(steps, axis=1)
        if not lengths.all():
            raise FieldError(f"the affine moves nothing along axis {int(lengths.argmin())}")
        return cls.of(
            values, lengths.tolist(), matrix[:n, n].tolist(), directions=steps / lengths[:, None]
        )

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

    @property
    def handedness(self) -> int:
        """+1, or -1 where the axes of the array are a mirror image of those of space."""
        return 1 if self.directions is None else int(np.sign(np.linalg.det(self.directions)))

    @property
    def affine(self) -> Floats:
        """(n + 1, n + 1) the matrix that takes (index, 1) to (position, 1)."""
        n = self.dimension
        matrix = np.eye(n + 1)
        frame = np.eye(n) if self.directions is None else np.array(self.directions)
        matrix[:n, :n] = (frame * np.array(self.spacing)[:, None]).T
        matrix[:n, n] = self.origin
        return matrix

    def position(self, index: ArrayLike) -> Floats:
        """Where fractional indices of shape (.., n) stand in space, (.., n)."""
        if self.directions is not None:
            return self.placed(np.multiply(index, self.spacing))
        place: Floats = np.multiply(index, self.spacing) + np.asarray(self.origin, np.float64)
        return place

    def placed(self, points: Floats) -> Floats:
        """(.., n) points given along the lattice's own axes from its first sample on, in space."""
        frame = np.eye(self.dimension) if self.directions is None else np.array(self.directions)
        place: Floats = points @ frame + np.asarray(self.origin, np.float64)
        return place

    def index(self, positions: ArrayLike) -> Floats:
        """The fractional indices of positions of shape (.., n): `position`, backwards."""
        away = np.subtract(positions, self.origin)
        if self.directions is not None:
            away = away @ np.linalg.inv(self.directions)
        found: Floats = away / self.spacing
        return found

    def straight(self) -> Field:
        """The same samples on a straight lattice; the field itself where it is straight.

        Where it has directions, what is straightened begins at 0.
        """
        if self.directions is None:
            return self
        return Field(self.values, self.spacing, (0.0,) * self.dimension)

    def with_values(self, values: Array) -> Field:
        """Other samples, which must be finite, on the same lattice at the same place."""
        return Field(values, self.spacing, self.origin, self.directions)


def _frame(given: ArrayLike, n: int) -> tuple[tuple[float, ...], ...] | None:
    """The rows of a matrix of directions, of length one; None where they are the axes of space."""
    try:
        rows = np.asarray(given, np.float64)
    except (TypeError, ValueError):
        raise FieldError(f"directions {given!r} are not made of numbers") from None
    if rows.shape != (n, n) or not np.isfinite(rows).all():
        raise FieldError(f"directions of {n} axes are {n} rows of {n} finite numbers, one an axis")
    lengths = np.linalg.norm(rows, axis=1)
    # Files round to three or four digits.
    if (abs(lengths - 1) > UNIT).any():
        raise FieldError(
            f"directions have lengths {lengths.tolist()}, not 1: what is longer belongs to spacing"
        )
    if abs(np.linalg.det(rows)) < FLAT:
        raise FieldError("directions lie in a plane: the volume would be flat")
    if (rows == np.eye(n)).all():
        return None
    return tuple(tuple(row) for row in (rows / lengths[:, None]).tolist())


def check_straight(field: Field) -> None:
    """Raise FieldError where the axes of a field are not those of space."""
    if field.directions is not None:
        raise FieldError(
            "this works on straight lattices alone: use field.straight(), and field.placed for the "
            "points that come back"
        )


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
    check_finite(samples)


def check_finite(samples: Array, first: int = 0) -> None:
    """Raise FieldError unless all samples are finite; they are counted from plane `first` on."""
    # Look at both ends of the range: NaN is passed on by both, and no copy is made.
    if samples.dtype.kind == "f" and not np.isfinite([samples.min(), samples.max()]).all():
        index = tuple(int(i) for i in np.argwhere(~np.isfinite(samples))[0])
        where = (index[0] + first, *index[1:])
        raise FieldError(
            f"sample {where} is {samples[index]}; replace or crop samples that are not finite"
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
    >>> least_inside(np.dtype(bool), 0.5), least_inside(np.dtype(bool), -1e300)
    (1, 0)
    >>> [float(least_inside(np.dtype(np.float32), level)) >= level for level in (0.3, 0.7)]
    [True, True]
    """
    if dtype.kind == "b":
        return int(np.ceil(min(max(isovalue, 0.0), 2.0)))  # Larger numbers fit no comparison.
    if dtype.kind in "iu":
        return int(np.ceil(isovalue))
    with np.errstate(over="ignore"):
        rounded = dtype.type(isovalue)
    if float(rounded) < isovalue:  # As doubles: NumPy would round the isovalue here too.
        rounded = np.nextafter(rounded, dtype.type(np.inf))
    return rounded


def inside_samples(field: Field, isovalue: float) -> Booleans:
    """Which samples are inside, of the shape of the samples: value >= isovalue, exactly."""
    mask: Booleans = field.values >= least_inside(field.values.dtype, isovalue)
    return mask
