"""The bits of a slab: which samples are inside, which edges are crossed, which cells are active.

Comparing a sample gives one bit. Whatever can be asked of bits is asked of eight samples at once, a
byte, or of sixty-four, a word::

    samples     . . . I I I . .  . . I I I . . .       inside or not, a bit each
    bits        00011100         00111000              one byte for eight samples
    crossed     bits ^ bits of the next sample         along each axis in turn
    touched     crossed edges of a cell, joined by OR  not one cell has been looked at yet

Only where a word of *touched* is not 0 are bytes looked at, and only in bytes that are not 0, bits.

Glossary
--------
row         the samples along axis 2, padded to a multiple of 8
place       of a sample or a cell (its lower corner): flat index in the padded slab
edge        3 * place of its lower end + axis
signs       eight bits, one a corner of a cell: whether it is inside (`isoref.cube`)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isoref.cube import CORNER_OFFSETS, EDGE_CORNERS
from isoref.field import Array, Integers

Bytes = NDArray[np.uint8]

# How many bits of a byte are set.
POPULATION = np.array([n.bit_count() for n in range(256)])


def take(table: Array, index: Array) -> Array:
    """table[index], for indices that are in range: the look-up that NumPy is fastest at."""
    return table.take(index, mode="clip")


# --- Where samples, rows and bytes lie ---------------------------------------------------------


@dataclass(frozen=True)
class Lattice:
    """The padded planes: how samples, rows and bytes lie in a slab.

    n2, n3 : samples along axes 1 and 2
    row_bytes : bytes of a row, a bit a sample
    """

    n2: int
    n3: int
    row_bytes: int

    @property
    def row(self) -> int:
        """Places of a row."""
        return 8 * self.row_bytes

    @property
    def plane(self) -> int:
        """Places of a plane."""
        return self.n2 * self.row

    @property
    def plane_bytes(self) -> int:
        """Bytes of a plane, a bit a place."""
        return self.n2 * self.row_bytes

    @cached_property
    def steps(self) -> Integers:
        """(3,) how far neighbours along each axis are apart, in places."""
        return np.array([self.plane, self.row, 1])

    @cached_property
    def sample_steps(self) -> Integers:
        """(3,) the same in samples."""
        return np.array([self.n2 * self.n3, self.n3, 1])

    @cached_property
    def edge_steps(self) -> Integers:
        """(12,) from 3 * place of a cell to each of its edges."""
        lower = CORNER_OFFSETS[EDGE_CORNERS[:, 0]]
        return np.asarray(3 * (lower @ self.steps) + np.arange(12) // 4)


@lru_cache(maxsize=64)
def lattice_of(n2: int, n3: int) -> Lattice:
    """The planes of so many samples, with what was worked out for them before."""
    return Lattice(n2, n3, -(-n3 // 8))


# --- Bytes in which something is crossed, and the bits in them ---------------------------------


class Touched:
    """Bytes of some planes of a slab in which something may be crossed, B of them.

    A bit that is number b of the 8 B bits stands in byte b >> 3. What climbs by one from bit to
    bit, as places do, is known of all of them from a table for bytes: its entry is what a bit 0
    has, less its b. Places, rows and planes are counted from the first of the planes.

    where : (B,) the numbers of the bytes in the slab, which climb
    row : (B,) in which row each lies
    place : (B,) the place of its bit 0, less b
    index : three times (B,) the lattice index of its bit 0; along axis 2 less b
    """

    def __init__(self, where: Integers, lattice: Lattice, low: int) -> None:
        self.lattice, self.where, self.low = lattice, where, low
        own = where - low * lattice.plane_bytes
        self.row = own // lattice.row_bytes
        i = self.row // lattice.n2
        self.place = own - np.arange(len(own)) << 3
        self.index = i, self.row - i * lattice.n2, self.place - self.row * lattice.row

    @cached_property
    def sample(self) -> Integers:
        """(B,) the number of the sample of each byte's bit 0, less b."""
        if self.lattice.row == self.lattice.n3:
            return self.place
        return np.asarray(self.row * self.lattice.n3 + self.index[2])

    def before(self, plane: int) -> int:
        """How many of the bytes lie in planes before this one."""
        return int(self.where.searchsorted((self.low + plane) * self.lattice.plane_bytes))


class Set:
    """Some of the bits of touched bytes, N of them, in order.

    bit : (N,) their numbers b
    byte : (N,) to which byte each belongs
    """

    def __init__(self, touched: Touched, bit: Integers) -> None:
        self.touched, self.bit, self.byte = touched, bit, bit >> 3

    def places(self) -> Integers:
        """(N,) the place of each bit."""
        places: Integers = take(self.touched.place, self.byte)
        places += self.bit
        return places

    def samples(self, which: Integers | None = None) -> Integers:
        """(N,) the number of the sample of each bit, or of those asked for."""
        if which is None:
            samples: Integers = take(self.touched.sample, self.byte)
            samples += self.bit
            return samples
        return np.asarray(take(self.touched.sample, take(self.byte, which)) + take(self.bit, which))

    def lattice_index(self, axis: int, which: Integers) -> Integers:
        """The index along an axis of some bits."""
        index: Integers = take(self.touched.index[axis], take(self.byte, which))
        if axis == 2:
            index += take(self.bit, which)
        return index


def _set_bits(bytes_: Bytes) -> Integers:
    """The numbers of the bits that are set."""
    return np.unpackbits(bytes_.reshape(-1), bitorder="little").view(np.bool_).nonzero()[0]


# --- The bits of one slab after another --------------------------------------------------------


class Bits:
    """The bits of a slab, in arrays that one slab after another works in.

    lattice : of the padded planes
    planes : planes of cells that a slab has at most
    chunk : planes of samples that are compared at once
    level : a sample is inside from here on
    """

    level: Any

    def __init__(self, lattice: Lattice, planes: int, chunk: int) -> None:
        self.lattice = lattice
        size = (planes + 1) * lattice.plane_bytes
        room = size + 16 & -8
        self.inside = np.zeros((chunk, lattice.n2, lattice.row), np.bool_)
        self.bits, self.next, self.work, self.touched = (np.zeros(room, np.uint8) for _ in range(4))
        self.crossed = [np.zeros(room, np.uint8) for _ in range(3)]
        self.is_set = np.empty(room // 8, np.bool_)

        # Mark the samples that have a neighbour along axis 2, and those that have a cell.
        has_next = np.packbits(np.arange(lattice.row) < lattice.n3 - 1, bitorder="little")
        self.has_next = np.zeros(room, np.uint8)
        self.has_next[:size].reshape(-1, lattice.row_bytes)[:] = has_next
        self.has_cell = self.has_next.copy()
        rows = self.has_cell[:size].reshape(planes + 1, lattice.n2, lattice.row_bytes)
        rows[:, -1] = 0

    def begin(self, samples: Array) -> None:
        """Take the first plane of the first slab."""
        self.bits[: self.lattice.plane_bytes] = self._packed(samples)

    def crossed_on_first_plane(self) -> int:
        """How many edges along axis 1 are crossed on the first plane of the slab."""
        lattice = self.lattice
        rows = self.bits[: lattice.plane_bytes].reshape(lattice.n2, lattice.row_bytes)
        return int(take(POPULATION, rows[1:] ^ rows[:-1]).sum())

    def go_on(self, planes: int) -> None:
        """Make the last plane of a slab, which had so many, the first one of the next."""
        plane = self.lattice.plane_bytes
        self.bits[:plane] = self.bits[planes * plane : (planes + 1) * plane]

    def _packed(self, samples: Array) -> Bytes:
        """Whether the samples of these planes are inside, a bit each."""
        inside = self.inside[: len(samples)]
        np.greater_equal(samples, self.level, out=inside[:, :, : self.lattice.n3])
        return np.packbits(inside.reshape(-1), bitorder="little")

    def slab(self, samples: Array) -> Integers:
        """The numbers of the bytes in which something may be crossed.

        samples : (P, N2, N3) the planes of the slab, of which `begin` or `go_on` took the first
        """
        planes, plane = len(samples) - 1, self.lattice.plane_bytes
        for start in range(1, planes + 1, len(self.inside)):
            packed = self._packed(samples[start : start + len(self.inside)])
            self.bits[start * plane : start * plane + len(packed)] = packed
        self._cross(planes)
        self._touch(planes)

        # Look for the words where something is, and in these for the bytes.
        words = self.work[: (planes + 1) * plane + 7 & -8].view("<u8")
        which = np.not_equal(words, 0, out=self.is_set[: len(words)]).nonzero()[0]
        inner = (take(words, which).view(np.uint8) != 0).nonzero()[0]
        where: Integers = take(which - np.arange(len(which)) << 3, inner >> 3)
        where += inner
        return where

    def edges(self, touched: Touched, lowest: int, high: int) -> tuple[Set, list[int]]:
        """The crossed edges, by their lower ends and axis by axis; where those of an axis end.

        Along axis 0 those that begin in planes before `high`; along the others those that lie in
        planes from `lowest` on.
        """
        crossed = np.empty((3, len(touched.where)), np.uint8)
        for bytes_, own in zip(self.crossed, crossed, strict=True):
            bytes_.take(touched.where, mode="clip", out=own)
        crossed[2] &= take(self.has_next, touched.where)
        crossed[0, touched.before(high) :] = 0
        crossed[1:, : touched.before(lowest)] = 0

        # Count the bits of each axis from the first byte on.
        bit = _set_bits(crossed)
        size = 8 * len(touched.where)
        first, second = bit.searchsorted((size, 2 * size)).tolist()
        bit[first:second] -= size
        bit[second:] -= 2 * size
        return Set(touched, bit), [0, first, second, len(bit)]

    def active(self, where: Integers) -> Bytes:
        """Which of the cells in these bytes are active, a bit each, but for the last plane."""
        return np.asarray(take(self.work, where) & take(self.has_cell, where))

    def cells(self, touched: Touched, high: int) -> tuple[Set, Bytes]:
        """The active cells before a plane, and their signs."""
        where = touched.where[: touched.before(high)]
        cells = Set(touched, _set_bits(self.active(where)))
        corners = np.empty((len(where), 8), np.uint8)
        for c, (i, j, k) in enumerate(CORNER_OFFSETS.tolist()):
            beside = i * self.lattice.plane_bytes + j * self.lattice.row_bytes
            corners[:, c] = take(self.next if k else self.bits, where + beside)
        return cells, take(transposed(corners), cells.bit)

    def _cross(self, planes: int) -> None:
        """Compare neighbours along each axis."""
        row, plane = self.lattice.row_bytes, self.lattice.plane_bytes
        size, below = (planes + 1) * plane, planes * plane
        bits, (first, second, third) = self.bits, self.crossed

        # Bring the next sample along axis 2 to each place; what comes to the last one of a row is
        # left out later.
        words = size // 8 + 1
        old, new, carry = (a.view("<u8") for a in (bits, self.next, self.work))
        np.right_shift(old[:words], 1, out=new[:words])
        np.left_shift(old[1 : words + 1], 63, out=carry[:words])
        new[:words] |= carry[:words]

        np.bitwise_xor(bits[:below], bits[plane:size], out=first[:below])
        np.bitwise_xor(bits[: size - row], bits[row:size], out=second[: size - row])
        np.bitwise_xor(bits[:size], self.next[:size], out=third[:size])

        # The last plane and the last row of each have none; nor has what is left of a word.
        first[below : size + 7 & -8] = 0
        second[:size].reshape(planes + 1, self.lattice.n2, row)[:, -1] = 0
        for one in self.crossed:
            one[size : size + 7 & -8] = 0

    def _touch(self, planes: int) -> None:
        """Join the crossings of each cell's edges, in `work`: what is 0 has none.

        A cell has crossed edges if one of seven is crossed that join all its corners: one along
        axis 0, two along axis 1, four along axis 2. Where there is no cell, at the end of an axis,
        those count that are there; besides, some bits may be set for no reason.
        """
        row, plane = self.lattice.row_bytes, self.lattice.plane_bytes
        size, below = (planes + 1) * plane, planes * plane
        first, second, third = self.crossed
        touched, joined = self.touched, self.work
        np.bitwise_or(third[: size - row], third[row:size], out=touched[: size - row])
        touched[size - row : size] = third[size - row : size]
        touched[: size - row] |= second[: size - row]
        np.bitwise_or(touched[:below], touched[plane:size], out=joined[:below])
        joined[:below] |= first[:below]
        joined[below:size] = touched[below:size]
        joined[size : size + 7 & -8] = 0


def transposed(corners: Bytes) -> Bytes:
    """(8 M,) the signs of eight cells a row, from (M, 8): for each corner a byte, a bit a cell.

    The matrix of 8 x 8 bits in each word is transposed by swapping its quarters, then the quarters
    of these, then theirs (Warren, "Hacker's Delight", section 7-3).

    >>> transposed(np.array([[1, 1, 0, 0, 0, 0, 0, 2]], np.uint8)).tolist()
    [3, 128, 0, 0, 0, 0, 0, 0]
    """
    words = corners.reshape(-1).view("<u8")
    swap = np.empty_like(words)
    for shift, mask in (
        (7, 0x00AA00AA00AA00AA),
        (14, 0x0000CCCC0000CCCC),
        (28, 0x00000000F0F0F0F0),
    ):
        np.right_shift(words, shift, out=swap)
        swap ^= words
        swap &= np.uint64(mask)
        words ^= swap
        np.left_shift(swap, shift, out=swap)
        words ^= swap
    return words.view(np.uint8)
