"""Samples, the side each is on, and where a mesh's vertices stand among them.

Everything is said in *index coordinates*: the sample (i, j, k) stands at (i, j, k), whatever the
spacing and origin.

Glossary
--------
inside      value >= isovalue, or > isovalue where an implementation declares ties outside
lattice edge  the segment between two neighbouring samples; the surface *crosses* it when its ends
            are on different sides
tied        a sample that stands on the surface to within the tolerance: its value equals the
            isovalue, or a crossing on an edge at it comes that near
border      the boundary of the volume

The tolerance is a length in units of the spacing. It allows for vertices kept in single
precision, whose error grows with their distance from the zero of the coordinates. A sample is tied
up to `ROOM` tolerances from a crossing, so that near any other sample an inner vertex, in the
middle of as many as twelve others, is still told from one on a lattice edge.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from isoref.field import Array, Booleans, Field, Floats, Integers

FAR = 1e9
ROOM = 16
SINGLE = float(np.finfo(np.float32).eps)


@dataclass(frozen=True, eq=False)
class Lattice:
    """A field of rank three as the truths see it.

    Attributes
    ----------
    field, isovalue : what was asked
    inside : (N1, N2, N3) bool
    """

    field: Field
    isovalue: float
    inside: Booleans

    @classmethod
    def of(cls, field: Field, isovalue: float, tie: str = "inside") -> Lattice:
        """The lattice, with ties on the declared side."""
        above = field.values >= isovalue if tie == "inside" else field.values > isovalue
        return cls(field, isovalue, np.asarray(above))

    @property
    def shape(self) -> tuple[int, ...]:
        """(N1, N2, N3), samples along each axis."""
        return self.inside.shape

    @cached_property
    def tolerance(self) -> float:
        """Distance, in units of the spacing, below which two places are one."""
        extent = np.abs(np.divide(self.field.origin, self.field.spacing)) + self.shape
        return max(1e-6, 8 * SINGLE * float(extent.max()))

    @property
    def reach(self) -> float:
        """Distance, in units of the spacing, from which a crossing ties the sample."""
        return ROOM * self.tolerance

    def index(self, points: Floats) -> Floats:
        """Index coordinates of world positions; those at the border stand on it exactly.

        Places absurdly far outside are brought to `FAR`, where whole numbers are still exact.
        """
        places = np.subtract(points, self.field.origin) / self.field.spacing
        places = np.clip(places, -FAR, FAR)
        last = np.subtract(self.shape, 1.0)
        places[np.abs(places) <= self.tolerance] = 0.0
        return np.where(np.abs(places - last) <= self.tolerance, last, places)

    def on_border(self, places: Floats, ends: Integers) -> Booleans:
        """(n,) both ends of the edge lie on one and the same side of the border."""
        where = places[ends]
        first = (where == 0.0).all(axis=1)
        last = (where == np.subtract(self.shape, 1.0)).all(axis=1)
        on: Booleans = (first | last).any(axis=1)
        return on

    @cached_property
    def tied(self) -> Booleans:
        """(N1, N2, N3) samples on the surface to within the tolerance."""
        tied: Booleans = np.asarray(self.field.values == self.isovalue)
        for axis in range(3):
            low, high = _pair(axis)
            crossing = self.inside[low] != self.inside[high]
            where = np.nonzero(crossing)
            share = crossing_share(
                self.field.values[low][where], self.field.values[high][where], self.isovalue
            )
            tied[low][tuple(w[share <= self.reach] for w in where)] = True
            tied[high][tuple(w[share >= 1 - self.reach] for w in where)] = True
        return tied

    def at_tie(self, places: Floats) -> Booleans:
        """(n,) the place is a tied sample."""
        nearest = np.rint(places)
        last = np.subtract(self.shape, 1)
        at = (np.abs(places - nearest) <= self.reach).all(axis=1)
        i, j, k = np.clip(nearest, 0, last).astype(np.int64).T
        return np.asarray(at & self.tied[i, j, k])


def _pair(axis: int) -> tuple[tuple[slice, ...], tuple[slice, ...]]:
    """Slices that give the lower and the higher sample of every lattice edge along an axis."""
    whole = [slice(None)] * 3
    low, high = whole.copy(), whole.copy()
    low[axis], high[axis] = slice(None, -1), slice(1, None)
    return tuple(low), tuple(high)


def crossing_share(low: Array, high: Array, isovalue: float) -> Floats:
    """Where the linear interpolant takes the isovalue, as a share of the way from low to high.

    >>> crossing_share(np.array([0, 4]), np.array([10, 0]), 2.5)
    array([0.25 , 0.375])
    """
    a, b = np.asarray(low, np.float64), np.asarray(high, np.float64)
    share: Floats = (isovalue - a) / (b - a)
    return share
