"""Samples, the side each is on, and where a mesh's vertices stand among them, for any (n, m).

Everything is said in *index coordinates*: the sample (i1, .., in) stands there, whatever the
spacing and origin.

Glossary
--------
inside      value >= isovalue, or > isovalue where an implementation declares ties outside
lattice edge  the segment between two neighbouring samples; the level set of a component *crosses*
            it when its ends are on different sides
tied        a sample that stands on a level set to within the tolerance: its value equals the
            isovalue, or a crossing on an edge at it comes that near; or, for several components,
            an end of an edge that two of them cross at one place
general     a field without a tied sample and without a face whose bilinear saddle is on the
            isovalue: nothing about its level set hangs on rounding
border      the boundary of the domain, in which the implementation says its surface ends

The tolerance is a length in units of the spacing. It allows for vertices kept in single
precision, whose error grows with their distance from the zero of the coordinates. A sample is tied
up to `ROOM` tolerances from a crossing, so that near any other sample an inner vertex, in the
middle of as many as twelve others, is still told from one on a lattice edge. Vertices of a soup
count as one within its tolerance, so a crossing within it ties the sample too. A sample is tied
because of its values alone, whatever the mesh does. Where an implementation sees only inside and
outside, no sample is tied.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from dataclasses import field as fresh
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np
from isoref.field import Array, Booleans, Field, Floats, Integers

from isograde.declaration import Declaration, End

FAR = 1e9
ROOM = 16
SINGLE = float(np.finfo(np.float32).eps)
NOBODY = Declaration("")


@dataclass(frozen=True, eq=False)
class Lattice:
    """A field as the oracles see it.

    Attributes
    ----------
    field, isovalues : what was asked
    sides : (m, N1, .., Nn) which samples are inside, component by component
    declared : what the implementation says of itself
    """

    field: Field
    isovalues: tuple[float, ...]
    sides: Booleans
    declared: Declaration = fresh(default_factory=lambda: NOBODY)

    @classmethod
    def of(
        cls, field: Field, isovalues: tuple[float, ...], declared: Declaration = NOBODY
    ) -> Lattice:
        """The lattice, with ties on the declared side."""
        inside = declared.conventions.tie == "inside"
        rows = [
            component >= level if inside else component > level
            for component, level in zip(components(field), isovalues, strict=True)
        ]
        return cls(field, isovalues, np.stack(rows), declared)

    @property
    def shape(self) -> tuple[int, ...]:
        """(N1, .., Nn), samples along each axis."""
        return self.sides.shape[1:]

    @property
    def n(self) -> int:
        """The dimension of the lattice."""
        return len(self.shape)

    @property
    def inside(self) -> Booleans:
        """(N1, .., Nn) which samples of the first component are inside."""
        side: Booleans = self.sides[0]
        return side

    @property
    def isovalue(self) -> float:
        """The isovalue of the first component."""
        return self.isovalues[0]

    @cached_property
    def ends(self) -> tuple[End, ...]:
        """How the surface ends along each axis."""
        return self.declared.ends(self.n)

    @cached_property
    def first(self) -> Floats:
        """(n,) where the domain begins."""
        return np.array([end.inset for end in self.ends])

    @cached_property
    def last(self) -> Floats:
        """(n,) where the domain ends; the period of a periodic axis is one cell longer."""
        extra = [float(end.end == "periodic") for end in self.ends]
        return np.subtract(self.shape, 1.0) - self.first + extra

    @cached_property
    def within(self) -> tuple[Lattice, Integers]:
        """The samples inside the domain as a lattice of their own, and (n,) where it begins here.

        Along a periodic axis the first sample comes again after the last, unless a split of the
        cells does not fit. The new lattice is open in its border where the mesh ends there, and
        closed behind it where the mesh goes on.
        """
        start = np.ceil(self.first - self.tolerance).astype(np.int64)
        stop = np.floor(self.last + self.tolerance).astype(np.int64)
        period = (1,) * self.n
        if self.declared.interpolant == "tetrahedra":
            period = self.declared.split.period(self.n)
        taken, ends = [], []
        for axis, (end, size) in enumerate(zip(self.ends, self.shape, strict=True)):
            if end.end != "periodic" or size % period[axis]:
                start[axis] = max(start[axis], 0)
                stop[axis] = min(stop[axis], size - 1)
            taken.append(np.arange(start[axis], stop[axis] + 1) % size)
            stops_here = end.end == "open" and end.inset >= 0 and end.inset % 1 == 0
            ends.append(End() if stops_here else End(-0.5, "closed"))
        same = all(
            np.array_equal(one, np.arange(n)) for one, n in zip(taken, self.shape, strict=True)
        )
        if same and all(end.end == "open" and not end.inset for end in self.ends):
            return self, start
        window: Any = (..., *np.ix_(*taken))
        origin = tuple(self.field.position(start).tolist())
        field = replace(self.field, values=self.field.values[window], origin=origin)
        declared = replace(self.declared, domain=tuple(ends))
        return Lattice(field, self.isovalues, self.sides[window], declared), start

    @cached_property
    def tolerance(self) -> float:
        """Distance, in units of the spacing, below which two places are one."""
        field = self.field
        extent = np.abs(np.divide(field.origin, field.spacing)) + self.shape
        if field.directions is not None:
            # In the world each coordinate has a share of every axis.
            whole = float(np.abs(np.multiply(field.spacing, self.shape)).sum())
            extent = (np.abs(field.origin) + whole) / np.abs(field.spacing).min()
        return max(1e-6, 8 * SINGLE * float(extent.max()))

    @cached_property
    def reach(self) -> float:
        """Distance, in units of the spacing, from which a crossing ties the sample.

        Beyond sixteen thousand samples an axis single precision leaves less room; a crossing in
        the middle of its edge never ties.
        """
        return max(min(ROOM * self.tolerance, 0.25), 2 * (self.declared.soup or 0.0))

    def index(self, points: Floats) -> Floats:
        """Index coordinates of world positions; those at the domain's ends stand there exactly.

        Places absurdly far outside are brought to `FAR`, where whole numbers are still exact.
        """
        places = np.minimum(np.maximum(self.field.index(points), -FAR), FAR)
        for plane in self._planes:
            places = np.where(np.abs(places - plane) <= self.tolerance, plane, places)
        return places

    @cached_property
    def _planes(self) -> list[Floats]:
        """(n,) the first and the last samples, and the ends of the domain that stand elsewhere."""
        samples = [np.zeros(self.n), np.subtract(self.shape, 1.0)]
        ends = [self.first, self.last]
        same = all(map(np.array_equal, samples, ends))
        return samples if same else [*samples, *ends]

    def on_border(self, places: Floats, rows: Integers) -> Booleans:
        """(r,) all vertices of the row lie at one end of the domain where it is open.

        Vertices on edges stand in the end's plane; those in cells, in the border layer of cells;
        those on a lattice of its own, within its reach.
        """
        where = places[rows]
        slack = {"edges": self.tolerance, "cells": 0.5 + self.tolerance}.get(
            self.declared.vertices, self.declared.reach + self.tolerance
        )
        low = (np.abs(where - self.first) <= slack).all(axis=1)
        high = (np.abs(where - self.last) <= slack).all(axis=1)
        open_axes = np.array([end.end == "open" for end in self.ends])
        return np.asarray(((low | high) & open_axes).any(axis=1))

    @cached_property
    def tied(self) -> Booleans:
        """(N1, .., Nn) samples on a level set to within the tolerance."""
        if self.declared.interpolant == "labels":
            return np.zeros(self.shape, bool)
        tied = np.zeros(self.shape, bool)
        values = components(self.field)
        for component, level in zip(values, self.isovalues, strict=True):
            tied |= np.asarray(component == level, bool)
        for step in self.edges:
            self._tie_edges(tied, values, step)
        for axis in (a for a, end in enumerate(self.ends) if end.end == "periodic"):
            self._tie_across(tied, values, axis)
        return tied

    @cached_property
    def edges(self) -> tuple[tuple[int, ...], ...]:
        """The directions of the edges on which the interpolant is linear: axes, and diagonals."""
        axes = [tuple(int(a == axis) for a in range(self.n)) for axis in range(self.n)]
        if self.declared.interpolant != "tetrahedra":
            return tuple(axes)
        found = set(axes)
        for simplex in self.declared.split.over(self.n):
            for one, other in combinations(simplex, 2):
                step = tuple(b - a for a, b in zip(one, other, strict=True))
                found.add(max(step, tuple(-x for x in step)))
        return tuple(sorted(found))

    def _tie_edges(self, tied: Booleans, values: list[Array], step: tuple[int, ...]) -> None:
        """Mark the samples that a crossing on an edge in this direction ties."""
        low, high = stepped(step)
        shares: list[Floats] = []
        for c, level in enumerate(self.isovalues):
            where = np.nonzero(self.sides[c][low] != self.sides[c][high])
            share = crossing_share(values[c][low][where], values[c][high][where], level)
            tied[low][tuple(w[share <= self.reach] for w in where)] = True
            tied[high][tuple(w[share >= 1 - self.reach] for w in where)] = True
            if len(self.isovalues) > 1:
                every = np.full(self.sides[c][low].shape, np.inf)
                every[where] = share
                shares.append(every)
        # Two components that cross an edge at one place meet on it.
        for one, other in combinations(shares, 2):
            with np.errstate(invalid="ignore"):
                met = np.abs(one - other) <= self.reach
            tied[low] |= met
            tied[high] |= met

    def _tie_across(self, tied: Booleans, values: list[Array], axis: int) -> None:
        """Mark the samples that a crossing between the last plane and the first ties."""
        ends = [tuple([slice(None)] * axis + [end]) for end in (slice(-1, None), slice(0, 1))]
        for c, level in enumerate(self.isovalues):
            where = np.nonzero(self.sides[c][ends[0]] != self.sides[c][ends[1]])
            last, first = (values[c][end][where] for end in ends)
            share = crossing_share(last, first, level)
            tied[ends[0]][tuple(w[share <= self.reach] for w in where)] = True
            tied[ends[1]][tuple(w[share >= 1 - self.reach] for w in where)] = True

    def at_tie(self, places: Floats) -> Booleans:
        """(r,) the place is a tied sample."""
        nearest = np.rint(places)
        near = (np.abs(places - nearest) <= self.reach).all(axis=1)
        sample, here = self._sample(nearest)
        return np.asarray(near & here.all(axis=1) & self.tied[tuple(sample.T)])

    def _sample(self, index: Floats) -> tuple[Integers, Booleans]:
        """(r, n) the sample nearest to whole coordinates, and which of them are the sample's.

        Along a periodic axis the samples come again.
        """
        size = np.array(self.shape)
        inside = np.clip(index, 0, size - 1)
        periodic = np.array([end.end == "periodic" for end in self.ends])
        inside = np.where(periodic, np.mod(index, size), inside)
        return inside.astype(np.int64), np.asarray((inside == index) | periodic)

    def beside_tie(self, places: Floats) -> Booleans:
        """(r,) a corner of a cell that the place belongs to is a tied sample."""
        beside = np.zeros(len(places), bool)
        if not len(places) or not self.tied.any():
            return beside
        # Look only at places whose nearest sample is not far from a tied one.
        whole = np.rint(places)
        rows = np.flatnonzero(self._near_tied[tuple(self._sample(whole)[0].T)])
        places, whole = places[rows], whole[rows]
        places = np.where(np.abs(places - whole) <= self.tolerance, whole, places)
        choices = np.stack(
            [
                self._sample(index)[0]
                for index in (np.ceil(places) - 1, np.rint(places), np.floor(places) + 1)
            ]
        )
        for offset in np.ndindex((3,) * self.n):
            beside[rows] |= self.tied[tuple(choices[o, :, a] for a, o in enumerate(offset))]
        return beside

    @cached_property
    def _near_tied(self) -> Booleans:
        """(N1, .., Nn) samples a step or none from a tied one, as if each axis were periodic."""
        near = self.tied
        for axis in range(self.n):
            near = near | np.roll(near, 1, axis) | np.roll(near, -1, axis)
        return near


def components(field: Field) -> list[Array]:
    """The samples of each component, each of the lattice's shape."""
    if field.values.ndim == field.dimension:
        return [field.values]
    return list(field.values)


def stepped(step: tuple[int, ...]) -> tuple[tuple[slice, ...], tuple[slice, ...]]:
    """Slices that give both samples of every edge in this direction.

    >>> stepped((1, -1))
    ((slice(None, -1, None), slice(1, None, None)), (slice(1, None, None), slice(None, -1, None)))
    """
    low, high = [], []
    for move in step:
        ends = slice(None, -abs(move) or None), slice(abs(move), None)
        low.append(ends[0] if move >= 0 else ends[1])
        high.append(ends[1] if move >= 0 else ends[0])
    return tuple(low), tuple(high)


def pair(n: int, axis: int) -> tuple[tuple[slice, ...], tuple[slice, ...]]:
    """Slices that give the lower and the higher sample of every lattice edge along an axis."""
    return stepped(tuple(int(a == axis) for a in range(n)))


def crossing_share(low: Array, high: Array, isovalue: float) -> Floats:
    """Where the linear interpolant takes the isovalue, as a share of the way from low to high.

    >>> crossing_share(np.array([0, 4]), np.array([10, 0]), 2.5)
    array([0.25 , 0.375])
    """
    a, b = np.asarray(low, np.float64), np.asarray(high, np.float64)
    share: Floats = (isovalue - a) / (b - a)
    return share
