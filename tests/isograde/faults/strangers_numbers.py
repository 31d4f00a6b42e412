"""Faults of a stranger to the plan: slips with numbers, arrays, and what stays between two calls.

Each is right on the arrays that a test is written with, and wrong on ones that a user has: an
isovalue typed as a whole number, a crop of a larger array, a volume that is written in place, a
voxel of some nanometres. They were written from the README and `isograde explain` alone.

Three more of his are no faults here, since they keep what is agreed. Isovalues are handed on as
floats, so that nobody need take a whole number. Who rounds the isovalue to the single precision of
the samples has taken another isovalue, by less than the samples can tell. And who takes differences
below 2 ** -52 for none is right for all magnitudes that are promised: `range.scale` measures, and
tells, how far an answer stays.
"""

from __future__ import annotations

import hashlib
import weakref
from functools import partial
from typing import Any, ClassVar

import numpy as np

from tests.isograde.faults.engine import Answer, Array, Engine, Spacing
from tests.isograde.faults.registry import fault

stranger = partial(fault, blind=True, level=3)


@stranger("topology.tie_side")
class SignBit(Engine):
    """Sides are the sign bits of the differences, and that of minus zero is set."""

    def inside(self, samples: Array, relative: Array, alpha: float) -> Array:
        """Which differences have no sign bit."""
        return ~np.signbit(relative)


@stranger("symmetry.layout")
class CroppedRows(Engine):
    """Planes are taken to be adjacent where the samples of a row are, as in no crop they are."""

    def read(self, values: Any) -> Array:
        """The samples, read through the stride of their rows."""
        if isinstance(values, np.ndarray) and values.ndim == 3 and values.size:
            plane = values.shape[1] * values.strides[1]
            adjacent = values.strides[2] == values.itemsize
            if adjacent and 0 < plane <= values.strides[0]:
                strides = (plane, *values.strides[1:])
                values = np.lib.stride_tricks.as_strided(values, strides=strides)
        return super().read(values)


@stranger("symmetry.layout")
class ForeignColumns(Engine):
    """Samples in the order of Fortran are copied as they lie, their order of bytes forgotten."""

    def read(self, values: Any) -> Array:
        """The samples; those in Fortran's order by a copy of their memory."""
        if isinstance(values, np.ndarray) and values.ndim == 3:
            flags = values.flags
            if flags.f_contiguous and not flags.c_contiguous:
                memory = np.frombuffer(values.tobytes("F"), values.dtype.newbyteorder("="))
                values = memory.reshape(values.shape, order="F")
        return super().read(values)


@stranger("calls.again", promised=["calls.again"])
class ConvertedOnce(Engine):
    """The array last asked is kept as converted, and not read again when it was written to."""

    def __init__(self) -> None:
        self.array: Any = lambda: None
        self.converted: Array = np.zeros(0)

    def read(self, values: Any) -> Array:
        """The samples in double precision; those of the last call for the same array."""
        if not isinstance(values, np.ndarray):
            return super().read(values)
        if self.array() is not values:
            self.converted = super().read(values).astype(np.float64)
            self.array = weakref.ref(values)
        return self.converted


@stranger("calls.again", promised=["calls.again"])
class KeptByPrintedIsovalue(Engine):
    """Answers are kept by all samples, the spacing, and six digits of the isovalue."""

    most: ClassVar[int] = 32

    def __init__(self) -> None:
        self.kept: dict[tuple[Any, ...], Answer] = {}

    def __call__(self, values: Any, isovalue: float, spacing: Spacing) -> Answer:
        """Vertices and triangles; those kept, if there are any."""
        samples = self.read(values)
        digest = hashlib.sha256(samples.tobytes()).digest()
        key = (digest, samples.dtype.str, samples.shape, tuple(spacing), f"{isovalue:g}")
        if key not in self.kept:
            while len(self.kept) >= self.most:
                self.kept.pop(next(iter(self.kept)))
            self.kept[key] = super().__call__(values, isovalue, spacing)
        vertices, triangles = self.kept[key]
        return vertices.copy(), triangles.copy()


@stranger("calls.buffer", promised=["calls.buffer"])
class TwoBuffers(Engine):
    """Vertices are returned in two buffers by turns, so that a third call overwrites the first."""

    def __init__(self) -> None:
        self.buffers = [np.empty((1024, 3)), np.empty((1024, 3))]

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The answer; its vertices a view of the buffer whose turn it is."""
        self.buffers.reverse()
        if len(self.buffers[0]) < len(vertices):
            self.buffers[0] = np.empty((2 * len(vertices), 3))
        view = self.buffers[0][: len(vertices)]
        view[:], kept = super().finish(vertices, triangles, spacing, shape)
        return view, kept


@stranger("calls.again", promised=["calls.again"])
class StampOfAByte(Engine):
    """The table of edges is cleared by a stamp of one byte: call 256 meets those of call 1."""

    def __init__(self) -> None:
        self.shape: tuple[int, ...] = ()
        self.stamps: Array = np.zeros(0, np.uint8)
        self.numbers: Array = np.zeros(0, np.int64)
        self.stamp = 0

    def visited(self, cells: Array, shape: tuple[int, ...]) -> Array:
        """All; a table for this shape is there, with a stamp that is not zero."""
        if self.shape != shape:
            self.shape, self.stamp = shape, 0
            self.stamps = np.zeros(3 * int(np.prod(shape)), np.uint8)
            self.numbers = np.zeros(3 * int(np.prod(shape)), np.int64)
        self.stamp = self.stamp % 255 + 1
        return cells

    def weld(
        self, names: list[Array], places: list[Array], owners: list[Array], keys: Array
    ) -> tuple[Array, Array]:
        """Vertices and triangles; an edge that bears the stamp has its vertex already."""
        vertices, triangles = super().weld(names, places, owners, keys)
        every = np.unique(np.concatenate(names))
        edge = every >= 0
        known = np.zeros(len(every), bool)
        known[edge] = self.stamps[every[edge]] == self.stamp
        number = np.cumsum(~known) - 1
        number[known] = self.numbers[every[known]]
        self.stamps[every[edge]] = self.stamp
        self.numbers[every[edge]] = number[edge]
        return vertices[~known], number[triangles]


@stranger("topology.sides")
class HashOf32Bits(Engine):
    """A lattice edge is known by 32 bits of a good hash, and two edges of the same hash are one."""

    def edge_name(self, cells: Array, e: int, shape: tuple[int, ...]) -> Array:
        """The finalizer of splitmix64, cut to 32 bits."""
        x = super().edge_name(cells, e, shape).astype(np.uint64)
        x = (x ^ x >> np.uint64(30)) * np.uint64(0xBF58476D1CE4E5B9)
        x = (x ^ x >> np.uint64(27)) * np.uint64(0x94D049BB133111EB)
        return ((x ^ x >> np.uint64(31)) & np.uint64(0xFFFFFFFF)).astype(np.int64)


@stranger("topology.closed")
class LoneLastLayer(Engine):
    """Layers of cells are drawn 64 at a time, and a single one that is left over is not drawn."""

    def visited(self, cells: Array, shape: tuple[int, ...]) -> Array:
        """The cells but those of a last layer alone in its slab."""
        layers = shape[0] - 1
        if layers > 64 and layers % 64 == 1:
            return cells[cells[:, 0] < layers - 1]
        return cells


@stranger("topology.closed")
class BricksApart(Engine):
    """Bricks of 32 samples, all on one side, are skipped, whatever is on the next brick's."""

    side: ClassVar[int] = 32

    def active(self, inside: Array) -> Array:
        """The crossed cells of bricks that are not all inside or all outside."""
        found, s = super().active(inside), self.side
        for corner in np.ndindex(*(-(-n // s) for n in inside.shape)):
            brick = tuple(slice(s * c, s * c + s) for c in corner)
            if inside[brick].all() or not inside[brick].any():
                found[brick] = False
        return found


@stranger("topology.closed")
class FirstTwoSpacings(Engine):
    """Voxels are taken to be cubes if their first two sides are equal."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The answer in the world's units, by one factor where one seems to be enough."""
        if spacing[0] == spacing[1]:
            return vertices * spacing[0], triangles
        return super().finish(vertices, triangles, spacing, shape)


@stranger("topology.closed")
class WeldedInMetres(Engine):
    """Vertices within 1e-8 of each other are welded, in units of the world, say metres."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The answer, its vertices welded, and no triangle that has one twice."""
        world, triangles = super().finish(vertices, triangles, spacing, shape)
        _, first, number = np.unique(
            np.round(world / 1e-8), axis=0, return_index=True, return_inverse=True
        )
        welded = number.reshape(-1)[triangles]
        kept = (welded != np.roll(welded, 1, axis=1)).all(axis=1)
        return world[first], welded[kept]
