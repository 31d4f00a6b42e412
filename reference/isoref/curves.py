"""Curves: polylines in space, closed or open.

The one way this package holds a curve, whichever algorithm found it.

Glossary
--------
point       a vertex of the polyline
successor   for each item (a point, a segment), the item that follows it, or -1

Invariants
----------
Points are float64 (N, 3), in order. A closed curve does not repeat its first point. Curves that are
the intersection of two isosurfaces run along ``grad psi_1 x grad psi_2``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from isoref.field import (
    Booleans,
    Field,
    FieldError,
    Floats,
    Integers,
    check_isovalue,
    check_straight,
)


@dataclass(frozen=True, eq=False)
class Curve:
    """A polyline through `points`; back to the first point where it is `closed`."""

    points: Floats
    closed: bool

    @property
    def polyline(self) -> Floats:
        """(N, 3) points, or (N + 1, 3) with the first one repeated at the end of a closed curve."""
        return np.concatenate([self.points, self.points[:1]]) if self.closed else self.points

    @property
    def length(self) -> float:
        """Sum of the lengths of the segments.

        >>> Curve(np.array([[0.0, 0, 0], [3, 0, 0], [3, 4, 0]]), closed=True).length
        12.0
        """
        return float(np.linalg.norm(np.diff(self.polyline, axis=0), axis=1).sum())

    def __repr__(self) -> str:
        kind = "closed" if self.closed else "open"
        return f"Curve({len(self.points)} points, {kind}, length {self.length:.6g})"


def curves_through(points: Floats, closed: bool) -> list[Curve]:
    """The curve through these points without repeated neighbours; none where one point is left.

    >>> curves_through(np.array([[0.0, 0, 0], [0, 0, 0], [1, 0, 0]]), closed=False)
    [Curve(2 points, open, length 1)]
    """
    new = moved_on(points, closed)
    return [Curve(points[new], closed)] if new.sum() > 1 else []


def moved_on(points: Floats, closed: bool) -> Booleans:
    """(N,) which points do not stand where the one before them does.

    >>> moved_on(np.array([[0.0, 0, 0], [1, 0, 0], [1, 0, 0], [0, 0, 0]]), closed=True).tolist()
    [False, True, False, True]
    """
    new = np.ones(len(points), bool)
    new[1:] = (points[1:] != points[:-1]).any(axis=1)
    if closed and (points[0] == points[-1]).all():
        new[0] = False
    return new


def follow(successor: Integers) -> list[tuple[Integers, bool]]:
    """The chains and the cycles of a partial permutation, each item in exactly one of them.

    Parameters
    ----------
    successor : (N,) indices of the next item, each index at most once, or -1 at the end of a chain

    Returns
    -------
    list of (indices in order, True for a cycle); chains first, then cycles, each kind by its
    first item.

    >>> [(chain.tolist(), closed) for chain, closed in follow(np.array([3, 2, 1, -1]))]
    [([0, 3], False), ([1, 2], True)]
    """
    # Begin chains at the items that follow none, and then cycles at any item that is left.
    after = successor.tolist()
    heads = np.setdiff1d(np.arange(len(after)), successor).tolist()
    seen = [False] * len(after)
    found = []
    for closed, starts in ((False, heads), (True, range(len(after)))):
        for start in starts:
            # Follow it to its end, or back to its start.
            chain, item = [], start
            while item >= 0 and not seen[item]:
                seen[item] = True
                chain.append(item)
                item = after[item]
            if chain:
                found.append((np.array(chain, np.int64), closed))
    return found


def real_and_imaginary(psi: ArrayLike, spacing: ArrayLike | None = None) -> tuple[Field, Field]:
    """The two scalar fields of a complex one; their zero sets meet in its nodal lines.

    Raises
    ------
    FieldError
        for what `Field.of` refuses, and for an array that is not three-dimensional.
    """
    samples = np.asarray(psi, np.complex128)
    steps = None if spacing is None else np.asarray(spacing).tolist()
    return Field.of(samples.real, steps, dimension=3), Field.of(samples.imag, steps, dimension=3)


def check_pair(first: Field, second: Field, isovalues: tuple[float, float]) -> None:
    """Raise FieldError unless two scalar fields stand on one three-dimensional lattice.

    Raises
    ------
    FieldError
        for fields of other dimension, several components, or lattices that differ, and for
        isovalues that are not finite numbers.
    """
    # Look at each field by itself.
    for number, (field, isovalue) in enumerate(zip((first, second), isovalues, strict=True), 1):
        check_isovalue(isovalue)
        check_straight(field)
        if field.dimension != 3 or field.components != 1 or field.values.ndim != 3:
            raise FieldError(
                f"field {number} has rank {field.values.ndim} on a lattice of dimension "
                f"{field.dimension}; take one scalar component in three dimensions"
            )

    # Compare their lattices.
    if first.shape != second.shape:
        raise FieldError(
            f"fields of shapes {first.shape} and {second.shape} are not co-located; "
            "sample both on one lattice"
        )
    if (first.spacing, first.origin) != (second.spacing, second.origin):
        raise FieldError(
            f"lattices differ: spacing {first.spacing} and {second.spacing}, "
            f"origin {first.origin} and {second.origin}; sample both fields on one lattice"
        )
