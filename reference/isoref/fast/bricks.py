"""Many isovalues of one volume: an index of the least and the largest sample of each brick.

A volume is passed once, whatever is asked of it, and the least and the largest sample of every
*brick* are kept. For an isovalue only the bricks that it divides are looked at again::

    brick       a block of cells with all their corners: neighbours share a layer of samples
    divided     least < isovalue <= largest
    boxes       the divided bricks, in boxes that share no sample
    mesh        of each box by itself, one after the other

Why it is right: a lattice edge is crossed where one end is inside (``value >= isovalue``) and the
other is not. Both ends of an edge of a brick's cells are samples of that brick, since it has all
corners of its cells. Where all of them are inside, or all outside, no edge of its cells is crossed,
and a cell without crossed edges has no triangles, by any rule. So every triangle lies in a divided
brick, and all of these are in the boxes. Cells of two boxes have no edge in common, since the boxes
have no sample in common, so no vertex of one belongs to the other. And a vertex is computed from
the two samples of its edge (one inside a cell from the cell's eight) and from their indices in the
whole volume, in a box as in the whole, so it comes out bit by bit the same. What comes is the mesh
of the whole, up to the order of its vertices and triangles.

What it saves is the pass over the samples, so it saves much where the surface is small beside the
volume, in few places, or in a file; a surface that goes everywhere costs what it costs without.

Boxes
-----
Divided bricks that share samples belong together: those that touch in a face, an edge or a corner.
Round each such heap there is a box; boxes that share samples become one, and so do boxes that are
cheaper together, for to begin with one takes as long as to look at `CALL` cells.

Glossary
--------
side        cells along each axis of a brick; the last one may have fewer
divided     (K1, K2, K3) booleans, one a brick
box         three slices of bricks

>>> ball = 10.0 - np.linalg.norm(np.indices((24, 24, 24)) - 11.5, axis=0)
>>> index = Index.of(ball, side=4)
>>> index.extract(7.0), int(index.divided(7.0).sum()), index.divided(7.0).size
(Mesh(192 vertices in R^3, 380 simplices of dimension 2), 8, 216)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import overload

import numpy as np
from numpy.typing import ArrayLike

from isoref.fast.sweep import _Sweep
from isoref.field import (
    Array,
    Booleans,
    Field,
    FieldError,
    Integers,
    check_finite,
    check_isovalue,
    least_inside,
)
from isoref.mesh import Mesh, Precision, number_types
from isoref.methods import RULES
from isoref.rule import Rule

Box = tuple[slice, slice, slice]

SIDE = 16

#: To begin with a box takes as long as this many cells that are not divided.
CALL = 400_000

#: Parts of planes are copied before they are swept, which costs as much again.
COPY = 2

#: More heaps than this are in one box: to see which belong together would cost more than it saves.
MOST = 64


@dataclass(frozen=True, eq=False)
class Index:
    """A volume with the least and the largest sample of each brick.

    Build one with `Index.of`. The samples are not copied, and must not change.

    Attributes
    ----------
    field : the volume
    side : cells along each axis of a brick
    least, largest : (K1, K2, K3) of the samples of each brick, of the volume's type; none along an
        axis of one sample
    """

    field: Field
    side: int
    least: Array
    largest: Array

    @classmethod
    def of(
        cls,
        values: ArrayLike,
        spacing: float | Sequence[float] | None = None,
        origin: Sequence[float] | None = None,
        *,
        directions: ArrayLike | None = None,
        side: int = SIDE,
    ) -> Index:
        """The index of a volume, which is passed once.

        Parameters
        ----------
        values : (N1, N2, N3) real numbers; of a `numpy.memmap` a layer of bricks is read at a time,
            and later no more than the boxes
        spacing, origin, directions : of the lattice, as of `isoref.field.Field.of`
        side : cells along each axis of a brick

        Raises
        ------
        FieldError
            as `Field.of`, and for a side below 1.
        """
        if side < 1:
            raise FieldError(f"bricks of {side} cells a side are none; say 1 or more")
        samples = values if isinstance(values, np.ndarray) else Field.of(values).values
        if samples.ndim != 3 or not samples.size:
            raise FieldError(f"an array of shape {samples.shape} is no volume with samples")
        # Check all but the other samples, which are looked at below.
        place = Field.of(samples[:1, :1, :1], spacing, origin, directions=directions)
        ends = [
            np.empty(_bricks(samples.shape, side), samples.dtype) for _ in (np.minimum, np.maximum)
        ]
        for first in range(0, max(1, len(samples) - 1), side):
            layer = samples[first : first + side + 1]
            lowest, highest = np.minimum.reduce(layer), np.maximum.reduce(layer)
            # NaN is passed on by both.
            if samples.dtype.kind == "f" and not np.isfinite([lowest.min(), highest.max()]).all():
                check_finite(layer, first)
            for reduce, plane, end in zip(
                (np.minimum, np.maximum), (lowest, highest), ends, strict=True
            ):
                end[first // side : first // side + 1] = _over_bricks(reduce, plane, side)
        return cls(place.with_values(samples), side, *ends)

    def divided(self, isovalue: float) -> Booleans:
        """(K1, K2, K3) which bricks have samples on both sides, exactly."""
        level = least_inside(self.field.values.dtype, check_isovalue(isovalue))
        return np.asarray((self.least < level) & (self.largest >= level))

    @overload
    def extract(self, isovalue: float, method: str = ..., precision: Precision = ...) -> Mesh: ...

    @overload
    def extract(
        self, isovalue: Sequence[float], method: str = ..., precision: Precision = ...
    ) -> list[Mesh]: ...

    def extract(
        self,
        isovalue: float | Sequence[float],
        method: str = "asymptotic-decider",
        precision: Precision = "double",
    ) -> Mesh | list[Mesh]:
        """The isosurface, or one for each of several isovalues.

        It is that of `isoref.extract`, bit by bit, up to the order of vertices and triangles.

        Parameters
        ----------
        isovalue : in the unit of the samples; several give a list of meshes
        method : a cube rule of `isoref.methods.RULES`
        precision : "double" or "single", as of `isoref.extract`

        Raises
        ------
        ValueError
            for a method that is no cube rule
        FieldError
            for an isovalue that is no number, or an unknown precision
        """
        if method not in RULES:
            raise ValueError(f"no cube rule {method!r}; there are {', '.join(sorted(RULES))}")
        number_types(precision)
        if isinstance(isovalue, Sequence | np.ndarray) and np.ndim(isovalue) > 0:
            return [self._surface(RULES[method], level, precision) for level in isovalue]
        return self._surface(RULES[method], isovalue, precision)  # type: ignore[arg-type]

    def _surface(self, rule: Rule, isovalue: float, precision: Precision) -> Mesh:
        """The rule's surface at one isovalue."""
        found = self._widened(boxes(self.divided(isovalue), self.side))
        drawn = [self._drawn(one, rule, isovalue, precision) for one in found]
        return _joined(drawn).in_precision(precision).placed(self.field)

    def _drawn(self, box: Box, rule: Rule, isovalue: float, precision: Precision) -> Mesh:
        """The rule's surface in a box of bricks, where it is in the whole of a straight field."""
        straight = self.field.straight()
        i, j, k = self._samples(box)
        inner = straight.with_values(straight.values.reshape(straight.shape)[i, j, k])
        start = i.start, j.start, k.start
        return _Sweep(rule, inner, isovalue, precision, False, start).mesh()

    def _samples(self, box: Box) -> Box:
        """The samples of a box of bricks, its last layers included."""
        i, j, k = (
            slice(bricks.start * self.side, min(bricks.stop * self.side + 1, n))
            for bricks, n in zip(box, self.field.shape, strict=True)
        )
        return i, j, k

    def _widened(self, found: list[Box]) -> list[Box]:
        """The boxes; one that is alone has whole planes, where to copy parts of them costs more."""
        whole = self.least.shape
        if len(found) == 1 and COPY * _bricks_in(found[0][1:]) > whole[1] * whole[2]:
            return [(found[0][0], slice(0, whole[1]), slice(0, whole[2]))]
        return found


def _joined(parts: Sequence[Mesh]) -> Mesh:
    """One mesh of parts that have no vertex in common."""
    if len(parts) < 2:
        return parts[0] if parts else Mesh.empty(3, 2)
    before = np.cumsum([0, *(len(one.vertices) for one in parts)])[:-1].tolist()
    numbered = [one.simplices.astype(np.int64) + n for one, n in zip(parts, before, strict=True)]
    return Mesh(np.concatenate([one.vertices for one in parts]), np.concatenate(numbered))


def _bricks(shape: Sequence[int], side: int) -> tuple[int, ...]:
    """(K1, K2, K3) how many bricks there are along each axis.

    >>> _bricks((1, 17, 18), 16)
    (0, 1, 2)
    """
    return tuple(-(-(n - 1) // side) for n in shape)


def _over_bricks(reduce: np.ufunc, plane: Array, side: int) -> Array:
    """(K2, K3) the least or largest number of each brick, from (N2, N3) those over its planes.

    >>> _over_bricks(np.maximum, np.array([[1, 2, 3], [4, 5, 9]]), 1)
    array([[5, 9]])
    """
    if min(plane.shape) < 2:
        return np.empty(_bricks(plane.shape, side), plane.dtype)
    for axis in (0, 1):
        turned = plane if axis == 0 else plane.T
        starts = np.arange(0, len(turned) - 1, side)
        own = reduce.reduceat(turned, starts, axis=0)
        # Add the layer that a brick shares with the next; the last one has its own already.
        shared = turned[np.minimum(starts + side, len(turned) - 1)]
        found = reduce(own, shared)
        plane = found if axis == 0 else found.T
    return plane


def _bricks_in(box: Sequence[slice]) -> int:
    """How many bricks are in a box, or a part of a plane."""
    return int(np.prod([bricks.stop - bricks.start for bricks in box]))


# --- Boxes ---------------------------------------------------------------------------------------


def boxes(divided: Booleans, side: int) -> list[Box]:
    """Boxes that share no sample, in which all divided bricks are; none where there is none.

    >>> corners = np.zeros((40, 2, 2), bool)
    >>> corners[0, 0, 0] = corners[39, 1, 1] = True
    >>> boxes(corners, 4)
    [(slice(0, 40, None), slice(0, 2, None), slice(0, 2, None))]
    >>> boxes(corners, 100)
    [(slice(0, 1, None), slice(0, 1, None), slice(0, 1, None)), (slice(39, 40, None), \
slice(1, 2, None), slice(1, 2, None))]
    """
    if not divided.any():
        return []
    from scipy import ndimage  # Here, since SciPy takes a second to import.

    heaps, count = ndimage.label(divided, np.ones((3, 3, 3)))
    if count > MOST:
        heaps = divided.astype(np.int64)
    found = ndimage.find_objects(heaps)
    low = np.array([[part.start for part in box] for box in found]).reshape(-1, 3)
    high = np.array([[part.stop for part in box] for box in found]).reshape(-1, 3)
    while (pair := _to_join(low, high, side)) is not None:
        one, other = pair
        low[one], high[one] = np.minimum(low[one], low[other]), np.maximum(high[one], high[other])
        low, high = np.delete(low, other, axis=0), np.delete(high, other, axis=0)
    return [
        (slice(i0, i1), slice(j0, j1), slice(k0, k1))
        for (i0, j0, k0), (i1, j1, k1) in zip(low.tolist(), high.tolist(), strict=True)
    ]


def _to_join(low: Integers, high: Integers, side: int) -> tuple[int, int] | None:
    """Two boxes that share samples, or are cheaper as one; None where there are none.

    low, high : (B, 3) the first brick of each box, and the one behind its last
    """
    share = ((low[:, None] <= high) & (low <= high[:, None])).all(axis=2)
    together = (np.maximum(high[:, None], high) - np.minimum(low[:, None], low)).prod(axis=2)
    alone = (high - low).prod(axis=1)
    cheaper = (together - alone[:, None] - alone) * side**3 <= CALL
    first, second = np.nonzero(np.triu(share | cheaper, 1))
    return (int(first[0]), int(second[0])) if len(first) else None
