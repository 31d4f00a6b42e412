"""Faults of an outsider: shortcuts that are right for most callers, looked for where nobody looked.

Fast paths for one number type, values that a language takes for "not given", products in a type
that holds most of them. They were written last, to see what the plan lets pass: plan 3 let six.
"""

from __future__ import annotations

from functools import partial
from typing import Any, ClassVar

import numpy as np
from isoref.cube import FACE_CORNERS

from tests.isograde.faults.engine import Answer, Array, Engine, Spacing
from tests.isograde.faults.registry import fault

outsider = partial(fault, level=3)


@outsider("geometry.crossing")
class LevelZeroIsNone(Engine):
    """An isovalue of zero is taken for none, and the middle of the range comes instead."""

    def level(self, samples: Array, isovalue: float) -> float:
        """The isovalue, or a default."""
        middle = float(samples.max() / 2.0 + samples.min() / 2.0)
        return super().level(samples, isovalue) or middle


@outsider("topology.closed")
class TailOfEight(Engine):
    """Cells are decided eight at a time, and those that are left over are not decided at all."""

    last = 0

    def visited(self, cells: Array, shape: tuple[int, ...]) -> Array:
        """All; where the last whole eight ends is known."""
        self.last = (shape[2] - 1) // 8 * 8
        return cells

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """What the rule decides, but in the tail."""
        made = super().decisions(g, signs, cells)
        return np.where((cells[:, 2] >= self.last) & (self.last > 0), 0, made)


@outsider("topology.sides")
class WrappedUnsigned(Engine):
    """Unsigned numbers of 64 bits are read as signed ones."""

    def read(self, values: Any) -> Array:
        """The samples; the upper half of their range is below zero."""
        samples = super().read(values)
        return samples.astype(np.int64) if samples.dtype == np.uint64 else samples


@outsider("topology.tie_side")
class KeptByItsEnds(Engine):
    """Answers are kept by the shape, the isovalue and a few samples at both ends."""

    def __init__(self) -> None:
        self.kept: dict[Any, Answer] = {}

    def __call__(self, values: Any, isovalue: float, spacing: Spacing) -> Answer:
        """The answer to this field, or to one with the same ends."""
        flat = np.ascontiguousarray(values)
        ends = flat.ravel()[:16].tobytes(), flat.ravel()[-16:].tobytes()
        key = flat.shape, flat.dtype.str, float(isovalue), tuple(spacing), ends
        if key not in self.kept:
            self.kept[key] = super().__call__(values, isovalue, spacing)
        vertices, triangles = self.kept[key]
        return vertices.copy(), triangles.copy()


@outsider("topology.sides")
class LargestIsOutside(Engine):
    """Layers whose largest sample is the isovalue are skipped, though such samples are inside."""

    largest: Array

    def relative(self, samples: Array, alpha: float) -> Array:
        """Samples minus the isovalue; the largest of each layer is known."""
        relative = super().relative(samples, alpha)
        self.largest = relative.max(axis=(1, 2))
        return relative

    def active(self, inside: Array) -> Array:
        """Cells of layers with a sample above the isovalue."""
        above = np.maximum(self.largest[:-1], self.largest[1:]) > 0
        return np.asarray(super().active(inside) & above[:, None, None])


@outsider("structure.finite")
class TiesOnTheBorderOutside(Engine):
    """On the border of the volume, samples on the isovalue are outside; elsewhere inside."""

    def inside(self, samples: Array, relative: Array, alpha: float) -> Array:
        """The comparison of the border is another."""
        inside = relative > 0
        inner = (slice(1, -1),) * 3
        inside[inner] = relative[inner] >= 0
        return inside


@outsider("symmetry.type")
class TruthInTheMiddle(Engine):
    """Truth values are cut at a half, whatever the isovalue between 0 and 1."""

    def level(self, samples: Array, isovalue: float) -> float:
        """A half, for truth values."""
        alpha = super().level(samples, isovalue)
        return 0.5 if samples.dtype == bool and 0 < alpha <= 1 else alpha


@outsider("geometry.crossing")
class BytesBetween(Engine):
    """Of bytes, crossings are kept in 1024 places on an edge."""

    bytes = False

    def read(self, values: Any) -> Array:
        """The samples; their type is known."""
        samples = super().read(values)
        self.bytes = samples.dtype == np.uint8
        return samples

    def parameter(self, low: Array, high: Array) -> Array:
        """The place, rounded for bytes."""
        share = super().parameter(low, high)
        return np.rint(1024 * share) / 1024 if self.bytes else share


@outsider("geometry.crossing")
class LevelTowardsZero(Engine):
    """For signed whole numbers, an isovalue below zero between two of them is a step too high."""

    def level(self, samples: Array, isovalue: float) -> float:
        """One more than it should be."""
        alpha = super().level(samples, isovalue)
        between = samples.dtype.kind == "i" and alpha < 0 and alpha % 1 != 0
        return alpha + 1 if between else alpha


# --- what plan 3 did not see ---------------------------------------------------------------------


@outsider("symmetry.layout")
class SingleAsItLies(Engine):
    """Single precision has a fast path that reads the memory as it lies, whatever the strides."""

    def read(self, values: Any) -> Array:
        """The samples, in another order where they are single and not in C's order."""
        given = np.asarray(values)
        if given.dtype == np.float32 and not given.flags.c_contiguous:
            given = given.ravel(order="K").reshape(given.shape)
        return super().read(given)


@outsider("symmetry.layout")
class ShortsAsTheyLie(Engine):
    """Whole numbers of two and four bytes are read in the machine's order of bytes."""

    def read(self, values: Any) -> Array:
        """The samples, other numbers where they are foreign."""
        given = np.asarray(values)
        if given.dtype.kind in "iu" and given.dtype.itemsize in (2, 4) and not given.dtype.isnative:
            given = given.view(given.dtype.newbyteorder("="))
        return super().read(given)


@outsider("symmetry.layout")
class FirstAxisFastest(Engine):
    """Arrays whose first axis is fastest are read from their buffer, as if in the usual order."""

    def read(self, values: Any) -> Array:
        """The samples, by a short cut of their layout."""
        given = np.asarray(values)
        if given.flags.f_contiguous and not given.flags.c_contiguous:
            native = given.dtype.newbyteorder("=")
            given = np.frombuffer(given.tobytes("F"), native).reshape(given.shape, order="F")
        return super().read(given)


@outsider("symmetry.layout")
class BytesToBeWritten(Engine):
    """Bytes are asked for as a buffer that can be written, as Cython does without const."""

    def read(self, values: Any) -> Array:
        """The samples; an error where they are bytes that are read-only."""
        given = np.asarray(values)
        if given.dtype == np.uint8 and not given.flags.writeable:
            raise ValueError("buffer source array is read-only")
        return super().read(given)


@outsider("topology.closed")
class SpacingByTheFirst(Engine):
    """Where the first spacing is 1 the others are taken for 1 as well."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The answer, stretched if the first axis is."""
        steps = (1.0, 1.0, 1.0) if spacing[0] == 1 else spacing
        return super().finish(vertices, triangles, steps, shape)


@outsider("topology.tie_side")
class MinusZero(Engine):
    """The bit of the sign is looked at: a sample of -0.0 is below an isovalue of 0."""

    def inside(self, samples: Array, relative: Array, alpha: float) -> Array:
        """By the bit."""
        return ~np.signbit(relative)


class NarrowProducts(Engine):
    """Saddles of whole numbers, at a whole isovalue, by products of so many bits that wrap.

    bytes, bits : of the samples, and of the products
    """

    bytes: ClassVar[int]
    bits: ClassVar[int]
    narrow = False

    def read(self, values: Any) -> Array:
        """The samples; their type is known."""
        samples = super().read(values)
        self.narrow = samples.dtype.kind in "iu" and samples.dtype.itemsize == self.bytes
        return samples

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """What the rule decides, turned over where one of two products wraps."""
        made = super().decisions(g, signs, cells)
        if not self.narrow or (g != np.rint(g)).any():
            return made
        for f, (a, b, c, d) in enumerate(FACE_CORNERS):
            most = np.maximum(np.abs(g[a] * g[c]), np.abs(g[b] * g[d]))
            made = np.where(most >= 2.0 ** (self.bits - 1), made ^ (1 << f), made)
        asks = np.array([self.rule.asks(s) for s in range(256)])
        return np.where(asks[signs], made, 0)


@outsider("topology.bilinear")
class ShortProducts(NarrowProducts):
    """Saddles of 16-bit numbers are told by products of 32 bits, which differences can exceed."""

    bytes = 2
    bits = 32
