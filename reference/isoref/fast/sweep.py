"""The sweep, vectorised: the triangles of `isoref.sweep`.

Most of a volume is nowhere near the surface, so what must be done for each sample decides. Here
that is little: compare it, and keep the answer as one *bit*. All that follows is asked of eight
samples at once, a byte, or of sixty-four, a word::

    samples     . . . I I I . .  . . I I I . . .       inside or not, a bit each
    bits        00011100         00111000              one byte for eight samples
    crossed     bits ^ bits of the next sample         along each axis in turn
    active      crossed edges of a cell, joined by OR  not one cell has been looked at yet

Only where a byte of *active* is not 0 are cells looked at. There the eight corners' bytes make one
word of 8 x 8 bits, which is transposed: from a byte a corner to a byte a cell, its signs.

The volume is passed once, in *slabs* of planes small enough that their bits stay in the processor's
cache, and a slab in *parts* of so many cells that their numbers do. A part owns the cells between
its planes, and the crossed edges of all its planes but the first, which the part before it owns:
each crossing is numbered once, by a running count, and nothing has to be searched for. Nothing of a
slab is kept but its last plane and the mesh so far, so a volume may be larger than the memory (a
`numpy.memmap`, say).

Glossary
--------
row         the samples along axis 2, padded to a multiple of 8
place       of a sample or a cell (its lower corner): flat index in the padded slab
edge        3 * place of its lower end + axis
signs       eight bits, one a corner of a cell: whether it is inside (`isoref.cube`)
key         of a cell: signs + 256 * decisions; it names a tile
group       the keys whose tiles have as many triangles, and interior points or none

Weld rule: two triangles share a vertex when they cross the same lattice edge, and only then.
Triangles come slab by slab, within a slab group by group; where provenance is asked for they are
sorted by cells.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isoref.cube import CORNER_OFFSETS, EDGE_CORNERS
from isoref.cycles import Triangle
from isoref.field import Array, Field, Floats, Integers, check_isovalue, least_inside
from isoref.mesh import Mesh, Precision, Provenance, in_space, number_types
from isoref.rule import Average, Rule, Tile
from isoref.sweep import LEAST, cell_crossings, check_volume, crossing_parameter

Bytes = NDArray[np.uint8]

# At most so many places in a slab, so that its bits and the numbers of its vertices fit the last
# cache; so many samples compared at once, and about so many active cells, so that their arrays fit
# the second.
SLAB_POINTS = 1 << 20
CHUNK_POINTS = 1 << 17
PART_CELLS = 3 << 13


@in_space
def sweep(
    rule: Rule,
    field: Field,
    isovalue: float,
    precision: Precision = "double",
    provenance: bool = False,
) -> Mesh:
    """The rule's surface; see `isoref.sweep.sweep`.

    Besides, `precision` says what the arrays of the mesh are made of: float64 and int64, or, in
    half the memory, float32 and int32. Positions are computed in double precision and rounded last.
    """
    return _Sweep(rule, field, isovalue, precision, provenance).mesh()


def block(
    rule: Rule,
    field: Field,
    isovalue: float,
    start: tuple[int, int, int],
    precision: Precision = "double",
) -> Mesh:
    """The surface in a block of a larger volume, with the positions it has in the whole.

    field : the samples of the block, straight, with spacing and origin of the whole
    start : the block's first sample in the whole

    The mesh has its provenance, which counts samples and cells of the block.
    """
    return _Sweep(rule, field, isovalue, precision, True, start).mesh()


def pieces(
    rule: Rule, field: Field, isovalue: float, precision: Precision = "double"
) -> Iterator[tuple[Array, Array]]:
    """The same surface of a straight field piece by piece: new vertices (V, 3), triangles (T, 3).

    Triangles number all vertices since the first piece. Of the samples no more than a slab is
    looked at at once, and of the mesh no more than a piece is kept (`isoref.fast.slabs`).
    """
    return _Sweep(rule, field, isovalue, precision, False).pieces()


# --- What is known of a rule -------------------------------------------------------------------


class _Inside(IntEnum):
    """What interior points the tiles of a group have."""

    NONE = 0
    AVERAGES = 1
    OTHERS = 2


@dataclass(frozen=True, eq=False)
class _Group:
    """The tiles with equally many triangles, and interior points of one kind.

    nodes : (K, 3 T) the nodes of the T triangles of each tile
    """

    nodes: Integers
    inside: _Inside


@dataclass(frozen=True, eq=False)
class _Tables:
    """The tiles of the keys met so far, so that many cells can be looked up at once.

    known : for each key, whether its tile is in the tables
    group, row : where in `groups` it is
    interior : its number of interior points
    means : for a key, the number of its first average
    length, place : for an average, its number of nodes N, and its column in `averages[N]`
    """

    tile: dict[int, Tile]
    known: NDArray[np.bool_]
    group: Bytes
    row: Integers
    interior: Integers
    groups: tuple[_Group, ...]
    means: Integers
    length: Bytes
    place: Integers
    averages: dict[int, Integers]

    @classmethod
    def of(cls, tile: dict[int, Tile], size: int) -> _Tables:
        """The tables of these tiles, for keys below `size`."""
        known, group = np.zeros(size, np.bool_), np.zeros(size, np.uint8)
        row, interior, means = (np.zeros(size, np.int64) for _ in range(3))
        rows: dict[tuple[int, _Inside], list[tuple[Triangle, ...]]] = {}
        numbers: dict[tuple[int, _Inside], int] = {}
        averages: dict[int, list[tuple[int, ...]]] = {}
        length: list[int] = []
        place: list[int] = []
        for key, one in tile.items():
            # Put the tile into the group of its kind.
            kind = len(one.triangles), _inside(one)
            own = rows.setdefault(kind, [])
            known[key], row[key], interior[key] = True, len(own), len(one.interior)
            group[key] = numbers.setdefault(kind, len(numbers))
            own.append(one.triangles)

            # Note its averages.
            means[key] = len(length)
            for mean in one.interior:
                if isinstance(mean, Average):
                    of_length = averages.setdefault(len(mean.nodes), [])
                    length.append(len(mean.nodes))
                    place.append(len(of_length))
                    of_length.append(mean.nodes)
        return cls(
            tile,
            known,
            group,
            row,
            interior,
            tuple(
                _Group(np.array(own, np.int64).reshape(len(own), 3 * triangles), inside)
                for (triangles, inside), own in rows.items()
            ),
            means,
            np.array(length, np.uint8),
            np.array(place, np.int64),
            {n: np.ascontiguousarray(np.array(nodes).T) for n, nodes in averages.items()},
        )

    def steps(self, edge_steps: Integers) -> list[Integers]:
        """For each group (K, 3 T): from 3 * place of a cell to the edge of each node."""
        steps = np.append(edge_steps, 0)
        return [_take(steps, np.minimum(group.nodes, 12)) for group in self.groups]


def _inside(tile: Tile) -> _Inside:
    """What interior points a tile has."""
    if not tile.interior:
        return _Inside.NONE
    averages = all(isinstance(place, Average) for place in tile.interior)
    return _Inside.AVERAGES if averages else _Inside.OTHERS


class _Tiles:
    """What was learned of a rule; kept between calls, and safe to share between threads."""

    def __init__(self, rule: Rule) -> None:
        self.rule = rule
        self.asks = np.array([rule.asks(signs) for signs in range(256)])
        self.size = 1 << (8 + rule.bits)
        self.key_type = np.min_scalar_type(self.size - 1)
        self.lock = threading.Lock()
        self.tables = _Tables.of({}, self.size)

    def learn(self, keys: Array) -> _Tables:
        """Tables that hold the tile of every key that occurs."""
        tables = self.tables
        known = _take(tables.known, keys)
        if known.all():
            return tables
        with self.lock:
            # Never change tables that another thread may be reading: make new ones.
            tile = dict(self.tables.tile)
            for key in np.unique(keys[~known]).tolist():
                if key not in tile:
                    tile[key] = self.rule.tile(key & 255, key >> 8)
            self.tables = _Tables.of(tile, self.size)
            return self.tables


_remembered = lru_cache(maxsize=64)(_Tiles)


def _tiles(rule: Rule) -> _Tiles:
    """What is known of this rule from earlier calls, where the rule can be remembered."""
    try:
        return _remembered(rule)
    except TypeError:
        return _Tiles(rule)


# --- Arrays ------------------------------------------------------------------------------------


class _Growing:
    """An array that grows at its end, with room to spare, and gives the spare room back.

    Memory that is reserved and never written costs nothing.

    size : rows so far
    gone : rows of these that were handed on, and are here no more
    """

    def __init__(self, width: int, dtype: type[Any], rows: int) -> None:
        shape = (rows, width) if width else (rows,)
        self.array = np.empty(shape, dtype)
        self.size = self.gone = 0

    def more(self, rows: int) -> Array:
        """Room for so many rows, behind those that are there."""
        begun, self.size = self.size - self.gone, self.size + rows
        if self.size - self.gone > len(self.array):
            self._widen(2 * (self.size - self.gone), begun)
        return self.array[begun : self.size - self.gone]

    def since(self, row: int) -> Array:
        """The rows from this number on, to be read or changed."""
        return self.array[row - self.gone : self.size - self.gone]

    def put(self, numbers: Integers, rows: Array) -> None:
        """Write the rows with these numbers."""
        self.array[numbers - self.gone] = rows

    def hand_on(self) -> Array:
        """A copy of the rows that are here, which make room for those to come."""
        rows = self.since(self.gone).copy()
        self.gone = self.size
        return rows

    def foresee(self, done: float) -> None:
        """Make room for the whole, of which this share is done, before it is short and costly."""
        if self.size > len(self.array) * done:
            self._widen(int(1.25 * self.size / done), self.size)

    def _widen(self, rows: int, used: int) -> None:
        """Move to a larger array."""
        larger = np.empty((rows, *self.array.shape[1:]), self.array.dtype)
        larger[:used] = self.array[:used]
        self.array = larger

    def finished(self) -> Array:
        """The array, no larger than it has to be; the memory behind it is returned, not copied."""
        self.array.resize((self.size, *self.array.shape[1:]), refcheck=False)
        return self.array


def _take(table: Array, index: Array) -> Array:
    """table[index], for indices that are in range: the look-up that NumPy is fastest at."""
    return table.take(index, mode="clip")


def _transposed(corners: Bytes) -> Bytes:
    """(8 M,) the signs of eight cells a row, from (M, 8): for each corner a byte, a bit a cell.

    The matrix of 8 x 8 bits in each word is transposed by swapping its quarters, then the quarters
    of these, then theirs (Warren, "Hacker's Delight", section 7-3).

    >>> _transposed(np.array([[1, 1, 0, 0, 0, 0, 0, 2]], np.uint8)).tolist()
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


@dataclass(frozen=True)
class _Lattice:
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

    @property
    def steps(self) -> Integers:
        """(3,) how far neighbours along each axis are apart, in places."""
        return np.array([self.plane, self.row, 1])

    @property
    def sample_steps(self) -> Integers:
        """(3,) the same in samples."""
        return np.array([self.n2 * self.n3, self.n3, 1])

    @cached_property
    def edge_steps(self) -> Integers:
        """(12,) from 3 * place of a cell to each of its edges."""
        lower = CORNER_OFFSETS[EDGE_CORNERS[:, 0]]
        return np.asarray(3 * (lower @ self.steps) + np.arange(12) // 4)


# In place of the crossings of a cell for those who do not look at them.
_NO_CROSSINGS = np.empty((12, 0, 3))

# (3, 12) along each axis: whether an edge runs along it, and where its lower end is in the cell.
_ALONG = np.array([[float(e // 4 == axis) for e in range(12)] for axis in range(3)])
_LOWER = np.ascontiguousarray(CORNER_OFFSETS[EDGE_CORNERS[:, 0]].T.astype(np.float64))

# How many bits of a byte are set.
_POPULATION = np.array([n.bit_count() for n in range(256)])


@lru_cache(maxsize=64)
def _lattice(n2: int, n3: int) -> _Lattice:
    """The planes of so many samples, with what was worked out for them before."""
    return _Lattice(n2, n3, -(-n3 // 8))


@dataclass(frozen=True, eq=False)
class _Found:
    """Bytes of a slab that are not 0, and their numbers, which climb."""

    where: Integers
    found: Bytes


def _between(bytes_: _Found, start: int, stop: int) -> _Found:
    """Those of the bytes that have numbers from `start` to below `stop`."""
    own = slice(*np.searchsorted(bytes_.where, (start, stop)).tolist())
    return _Found(bytes_.where[own], bytes_.found[own])


@dataclass(frozen=True, eq=False)
class _Set:
    """The set bits of a slab's bytes, in order: B bytes that are not 0, N bits.

    byte : (N,) to which of the B each bit belongs
    bit : (N,) which of its eight bits it is
    first : (B,) the place of the bit 0 of each byte
    sample : (B,) the number of that sample in the slab
    index : three times (B,) its lattice index, the planes counted from the slab's first
    """

    byte: Integers
    bit: Integers
    first: Integers
    sample: Integers
    index: tuple[Integers, Integers, Integers]

    @classmethod
    def of(cls, m: Integers, found: Bytes, lattice: _Lattice) -> _Set:
        """The set bits of these bytes, which are number m of a slab's bytes."""
        where = np.flatnonzero(np.unpackbits(found, bitorder="little").view(np.bool_))
        row = m // lattice.row_bytes
        k = (m - row * lattice.row_bytes) << 3
        i = row // lattice.n2
        j = row - i * lattice.n2
        first = m << 3
        sample = first if lattice.row == lattice.n3 else row * lattice.n3 + k
        return cls(where >> 3, where & 7, first, sample, (i, j, k))

    def places(self) -> Integers:
        """(N,) the place of each bit."""
        return np.asarray(_take(self.first, self.byte) + self.bit)

    def samples(self, which: Integers | None = None) -> Integers:
        """(N,) the number of the sample of each bit, or of those asked for, in the slab."""
        if which is None:
            return np.asarray(_take(self.sample, self.byte) + self.bit)
        return np.asarray(_take(self.sample, _take(self.byte, which)) + _take(self.bit, which))

    def lattice_index(self, axis: int, which: Integers | slice = slice(None)) -> Integers:
        """The index along an axis of each bit, planes counted from the slab's first."""
        index = _take(self.index[axis], self.byte[which])
        if axis == 2:
            index += self.bit[which]
        return np.asarray(index)


# --- The sweep ---------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Deferred:
    """Interior points that are placed at the end, key by key: n cells of a slab.

    keys : (n,)
    g : (8, n) samples at the corners minus the isovalue
    cells : three times (n,) the lattice index of the cell
    first : (n,) the number of the cell's first interior point
    """

    keys: Array
    g: Floats
    cells: tuple[Integers, Integers, Integers]
    first: Integers


@dataclass(frozen=True, eq=False)
class _Part:
    """A part of a slab: its cells between two of the slab's planes.

    first : the first plane of the slab in the volume
    planes : how many planes of cells the slab has
    low, high : the planes between which the part lies, counted from the slab's first
    samples : of the slab, flat
    """

    first: int
    planes: int
    low: int
    high: int
    samples: Array


class _Sweep:
    """One passage through a volume: what a slab needs to know of the one before, and the mesh."""

    def __init__(
        self,
        rule: Rule,
        field: Field,
        isovalue: float,
        precision: Precision,
        traced: bool,
        start: tuple[int, int, int] = (0, 0, 0),
    ) -> None:
        check_volume(field)
        self.start = start
        self.isovalue = check_isovalue(isovalue)
        self.precision = precision
        real, whole = number_types(precision)
        self.field, self.tiles, self.traced = field, _tiles(rule), traced
        self.values = field.values if field.values.ndim == 3 else field.values[0]
        self.level = least_inside(field.values.dtype, self.isovalue)
        self.lattice = _lattice(*field.shape[1:])
        self.tables = self.tiles.tables
        self.steps: list[Integers] = []
        self.vertices = _Growing(3, real, 1 << 12)
        self.triangles = _Growing(3, whole, 1 << 13)
        self.cells = _Growing(0, np.int64, 1 << 13 if traced else 0)
        self.ends = _Growing(2, np.int64, 1 << 12 if traced else 0)
        self.along = _Growing(0, np.float64, 1 << 12 if traced else 0)
        self.deferred: list[_Deferred] = []

    def mesh(self) -> Mesh:
        """The mesh of all slabs."""
        for done in self._run():
            for array in (self.vertices, self.triangles, self.cells, self.ends, self.along):
                array.foresee(done)
        self._place_deferred()
        number_types(self.precision, self.vertices.size)
        mesh = Mesh(self.vertices.finished(), self.triangles.finished())
        if not self.traced:
            return mesh
        arrays = self.ends.finished(), self.along.finished(), self.cells.finished()
        return replace(mesh, provenance=Provenance(*arrays, self.field))

    def pieces(self) -> Iterator[tuple[Array, Array]]:
        """What each part of the volume adds to the mesh, which is not kept."""
        for _ in self._run():
            self._place_deferred()
            number_types(self.precision, self.vertices.size)
            yield self.vertices.hand_on(), self.triangles.hand_on()

    def _run(self) -> Iterator[float]:
        """Pass through the volume, slab by slab; after each part, which share is done."""
        layers = self.field.shape[0] - 1
        if min(self.field.shape) < 2:
            return
        planes = min(layers, max(1, SLAB_POINTS // self.lattice.plane))
        self._make_room(planes)
        self.bits[: self.lattice.plane_bytes] = self._packed(self.values[:1])
        for first in range(0, layers, planes):
            yield from self._slab(first, min(planes, layers - first))

    def _make_room(self, planes: int) -> None:
        """The arrays that all slabs of at most so many planes of cells work in."""
        lattice = self.lattice
        size = (planes + 1) * lattice.plane_bytes
        words = 3 * size // 8 + 2
        chunk = min(planes, max(1, CHUNK_POINTS // lattice.plane))
        self.inside = np.zeros((chunk, lattice.n2, lattice.row), np.bool_)
        self.bits, self.shifted, self.carry, self.touched = (
            np.zeros(size + 16 & -8, np.uint8) for _ in range(4)
        )
        self.crossed = np.zeros(8 * words, np.uint8)
        self.is_set = np.empty(words, np.bool_)
        has_next = np.packbits(np.arange(lattice.row) < lattice.n3 - 1, bitorder="little")
        self.has_next = np.empty(size, np.uint8)
        self.has_next.reshape(-1, lattice.row_bytes)[:] = has_next
        self.vertex_of = np.empty(3 * (planes + 1) * lattice.plane, np.int32)
        self.copied: Array | None = None  # the samples of a slab, where they lie in another order
        # Vertices of a slab are numbered from `offset` on, the first vertex of the slab before.
        self.offset = self.begun = 0
        self.parameters = np.empty(0)
        self.upper_edges = self.upper_vertices = np.empty(0, np.int64)

    def _packed(self, samples: Array) -> Bytes:
        """Whether the samples of these planes are inside, a bit each."""
        inside = self.inside[: len(samples)]
        np.greater_equal(samples, self.level, out=inside[:, :, : self.lattice.n3])
        return np.packbits(inside.reshape(-1), bitorder="little")

    def _slab(self, first: int, planes: int) -> Iterator[float]:
        """Add the cells between planes `first` and `first + planes`; as `_run`."""
        plane = self.lattice.plane_bytes
        samples = self._samples(first, planes)
        crossed, active = self._crossed_and_active(samples, bool(first))

        # Number the vertices from the first one of the slab before, which shares a plane.
        size = self.vertices.size
        kept = self.parameters[self.begun - self.offset : size - self.offset].copy()
        self.parameters[: len(kept)] = kept
        self.offset, self.begun = self.begun, size
        self.vertex_of[self.upper_edges] = self.upper_vertices
        self.upper_edges = self.upper_vertices = np.empty(0, np.int64)

        # Go through the active cells part by part.
        edges, cells = self._not_zero(crossed), self._not_zero(active)
        if len(edges.where):
            for low, high in pairwise(self._parts(cells, planes)):
                part = _Part(first, planes, low, high, samples.reshape(-1))
                self._make_crossings(part, edges)
                self._make_cells(part, _between(cells, low * plane, high * plane))
                yield (first + high) / (self.field.shape[0] - 1)

        # The last plane is the first one of the next slab.
        self.bits[:plane] = self.bits[planes * plane : (planes + 1) * plane]

    def _samples(self, first: int, planes: int) -> Array:
        """The samples of these planes and of the one behind them, in C order and native numbers."""
        samples = self.values[first : first + planes + 1]
        if samples.flags.c_contiguous and samples.dtype.isnative:
            return samples
        if self.copied is None:
            kind = samples.dtype.newbyteorder("=")
            self.copied = np.empty(samples.shape, kind)
        copied = self.copied[: planes + 1]
        copied[:] = samples
        return copied

    def _parts(self, cells: _Found, planes: int) -> list[int]:
        """The planes at which to cut a slab, so that a part has about `PART_CELLS` active cells."""
        if 8 * len(cells.where) <= PART_CELLS:
            return [0, planes]
        starts = np.searchsorted(cells.where, self.lattice.plane_bytes * np.arange(planes + 1))
        before = np.append(0, np.cumsum(_take(_POPULATION, cells.found)))[starts]
        parts = [0]
        while parts[-1] < planes:
            most = before[parts[-1]] + PART_CELLS
            parts.append(max(parts[-1] + 1, int(np.searchsorted(before, most, "right")) - 1))
        return parts

    def _crossed_and_active(self, samples: Array, has_before: bool) -> tuple[Bytes, Bytes]:
        """Which edges of a slab are crossed, (3, planes + 1, ..), and which cells are active.

        As bytes, a bit a place. Edges of the first plane are left out where a slab before has
        numbered them.
        """
        lattice, planes = self.lattice, len(samples) - 1
        row, plane = lattice.row_bytes, lattice.plane_bytes
        size, below = (planes + 1) * plane, planes * plane
        bits, shifted, touched = self.bits, self.shifted, self.touched
        for start in range(1, planes + 1, len(self.inside)):
            packed = self._packed(samples[start : start + len(self.inside)])
            bits[start * plane : start * plane + len(packed)] = packed

        # Bring the next sample along axis 2 to each place.
        words = size // 8 + 1
        old, new, carry = (a.view("<u8") for a in (bits, shifted, self.carry))
        np.right_shift(old[:words], 1, out=new[:words])
        np.left_shift(old[1 : words + 1], 63, out=carry[:words])
        new[:words] |= carry[:words]

        # Compare neighbours along each axis; the last sample of a row has none.
        crossed = self.crossed[: 3 * size].reshape(3, size)
        np.bitwise_xor(bits[:below], bits[plane:size], out=crossed[0, :below])
        np.bitwise_xor(bits[: size - row], bits[row:size], out=crossed[1, : size - row])
        np.bitwise_xor(bits[:size], shifted[:size], out=crossed[2])
        crossed[2] &= self.has_next[:size]
        crossed[0, below:] = 0
        crossed[1].reshape(planes + 1, lattice.n2, row)[:, -1] = 0

        # A cell is active where one of seven edges is crossed that join all its corners: one along
        # axis 0, two along axis 1, four along axis 2.
        np.bitwise_or(crossed[2, : size - row], crossed[2, row:], out=touched[: size - row])
        touched[: size - row] |= crossed[1, : size - row]
        active = self.carry[:below]
        np.bitwise_or(touched[:below], touched[plane:size], out=active)
        active |= crossed[0, :below]
        active &= self.has_next[:below]
        active.reshape(planes, lattice.n2, row)[:, -1] = 0
        self.carry[below : below + 7 & -8] = 0
        self.crossed[3 * size : 3 * size + 7 & -8] = 0

        # Leave out what the slab before has numbered.
        if has_before:
            crossed[1:, :plane] = 0
        return self.crossed[: 3 * size + 7 & -8], self.carry[: below + 7 & -8]

    def _not_zero(self, found: Bytes) -> _Found:
        """The bytes that are not 0, found by way of the words that are not; whole words."""
        words = found.view("<u8")
        flags = np.not_equal(words, 0, out=self.is_set[: len(words)])
        which = np.flatnonzero(flags)
        own = _take(words, which).view(np.uint8)
        inner = np.flatnonzero(own != 0)
        return _Found((_take(which, inner >> 3) << 3) + (inner & 7), _take(own, inner))

    def _signs(self, where: Integers, cells: _Set) -> Bytes:
        """The signs of the active cells, which lie in the bytes with these numbers."""
        corners = np.empty((len(where), 8), np.uint8)
        for c, (i, j, k) in enumerate(CORNER_OFFSETS.tolist()):
            beside = i * self.lattice.plane_bytes + j * self.lattice.row_bytes
            corners[:, c] = _take(self.shifted if k else self.bits, where + beside)
        return np.asarray(_take(_transposed(corners), (cells.byte << 3) + cells.bit))

    # --- Crossings -------------------------------------------------------------------------

    def _make_crossings(self, part: _Part, crossed: _Found) -> None:
        """Number and place the crossings on the edges that a part owns, axis by axis."""
        edges, ends = self._edges(part, crossed)
        places = edges.places()
        self._number(part, places, ends)

        # Interpolate between the samples at both ends of each edge.
        at = edges.samples()
        below = self._relative(_take(part.samples, at))
        for axis in range(3):
            at[ends[axis] : ends[axis + 1]] += self.lattice.sample_steps[axis]
        t = crossing_parameter(below, self._relative(_take(part.samples, at)))
        self._remember(t)
        if self.traced:
            self._trace(part, edges.samples(), at, t)

        # Write the positions.
        out = self.vertices.more(len(t))
        for axis in range(3):
            index = edges.lattice_index(axis).astype(np.float64)
            if before := self.start[axis] + (part.first if axis == 0 else 0):
                index += before
            along = slice(ends[axis], ends[axis + 1])
            index[along] += t[along]
            out[:, axis] = self._position(index, axis)

    def _edges(self, part: _Part, crossed: _Found) -> tuple[_Set, list[int]]:
        """The crossed edges that a part owns, by their lower ends; where those of an axis end.

        They are those between its planes, and on all of these but the lowest.
        """
        # The bytes of a slab come in three segments, one an axis.
        plane = self.lattice.plane_bytes
        size, lowest = (part.planes + 1) * plane, part.low + bool(part.first or part.low)
        own = [
            _between(crossed, part.low * plane, part.high * plane),
            _between(crossed, size + lowest * plane, size + (part.high + 1) * plane),
            _between(crossed, 2 * size + lowest * plane, 2 * size + (part.high + 1) * plane),
        ]
        where = np.concatenate([one.where - axis * size for axis, one in enumerate(own)])
        edges = _Set.of(where, np.concatenate([one.found for one in own]), self.lattice)
        bytes_before = np.cumsum([len(one.where) for one in own[:2]])
        return edges, [0, *np.searchsorted(edges.byte, bytes_before).tolist(), len(edges.byte)]

    def _number(self, part: _Part, places: Integers, ends: list[int]) -> None:
        """Give the edges of a part the next numbers; keep those that the next slab needs."""
        names = 3 * places
        for axis in (1, 2):
            names[ends[axis] : ends[axis + 1]] += axis
        start = self.vertices.size - self.offset
        self.vertex_of[names] = np.arange(start, start + len(names), dtype=np.int32)
        if part.high < part.planes:
            return

        # The edges on the last plane are those on the first plane of the next slab.
        top = part.planes * self.lattice.plane
        kept = np.flatnonzero(places >= top)
        self.upper_edges = names[kept] - 3 * top
        self.upper_vertices = kept + (self.vertices.size - self.begun)

    def _remember(self, t: Floats) -> None:
        """Keep where on their edges the new crossings are, for the averages of cells."""
        start = self.vertices.size - self.offset
        if len(self.parameters) < start + len(t):
            longer = np.empty(int(1.25 * (start + len(t))))
            longer[: len(self.parameters)] = self.parameters
            self.parameters = longer
        self.parameters[start : start + len(t)] = t

    def _trace(self, part: _Part, low: Integers, high: Integers | int, t: Floats | float) -> None:
        """Say of new vertices between which samples of the slab they lie, and where."""
        before = part.first * int(self.lattice.sample_steps[0])
        ends = self.ends.more(len(low))
        ends[:, 0] = low + before
        ends[:, 1] = high + before if isinstance(high, np.ndarray) else high
        self.along.more(len(low))[:] = t

    def _relative(self, samples: Array) -> Floats:
        """Samples minus the isovalue, negative where they are outside."""
        values: Floats = samples.astype(np.float64)
        values -= self.isovalue
        if samples.dtype.kind in "iu" and samples.dtype.itemsize == 8:
            values[(values >= 0) & (samples < self.level)] = -LEAST
        return values

    def _position(self, index: Floats, axis: int) -> Floats:
        """The positions of fractional indices along an axis, in the array of these."""
        if self.field.spacing[axis] != 1:
            index *= self.field.spacing[axis]
        if self.field.origin[axis] != 0:
            index += self.field.origin[axis]
        return index

    # --- Triangles -------------------------------------------------------------------------

    def _make_cells(self, part: _Part, active: _Found) -> None:
        """Add the triangles of active cells, and note their interior points."""
        if not len(active.where):
            return
        cells = _Set.of(active.where, active.found, self.lattice)
        keys = self._keys(part.samples, cells, self._signs(active.where, cells))
        tables = self._learn(keys)
        group = _take(tables.group, keys)
        order = np.argsort(group, kind="stable")
        counts = np.bincount(group, minlength=len(tables.groups)).tolist()

        # Take the cells of one group together: their tiles have rows of one length.
        base = 3 * cells.places()
        begun, owners, start, filled = self.triangles.size, [], 0, 0
        widths = [group.nodes.shape[1] for group in tables.groups]
        out = self.triangles.more(sum(n * w // 3 for n, w in zip(counts, widths, strict=True)))
        for number, (n, width) in enumerate(zip(counts, widths, strict=True)):
            rows = order[start : start + n]
            start += n
            if not (n and width):
                continue
            key = _take(keys, rows)
            found = self._nodes(number, _take(tables.row, key), _take(base, rows))
            if tables.groups[number].inside:
                self._add_interior(part, number, cells, rows, key, _take(base, rows), found)
            own = out[filled : filled + n * width // 3]
            filled += len(own)
            np.add(found, self.offset, out=own.reshape(n, width))
            if self.traced:
                owners.append(np.repeat(rows, width // 3))
        if owners:
            self._sort(part.first, cells, np.concatenate(owners), begun)

    def _keys(self, samples: Array, cells: _Set, signs: Bytes) -> Array:
        """The key of each cell, its decisions taken only where the rule asks."""
        keys = signs.astype(self.tiles.key_type)
        asked = np.flatnonzero(_take(self.tiles.asks, signs))
        if self.tiles.rule.bits and len(asked):
            g = self._corners(samples, cells.samples(asked))
            keys[asked] |= (self.tiles.rule.decisions(g) << 8).astype(keys.dtype)
        return keys

    def _corners(self, samples: Array, low: Integers) -> Floats:
        """(8, n) the samples at the corners of n cells, minus the isovalue."""
        steps = (CORNER_OFFSETS @ self.lattice.sample_steps).tolist()
        g = np.empty((8, len(low)))
        for c, step in enumerate(steps):
            g[c] = self._relative(_take(samples, low + step))
        return g

    def _learn(self, keys: Array) -> _Tables:
        """Tables that hold the tiles of these keys, and with them the steps to their nodes."""
        tables = self.tiles.learn(keys)
        if tables is not self.tables or not self.steps:
            self.tables, self.steps = tables, tables.steps(self.lattice.edge_steps)
        return tables

    def _nodes(self, number: int, row: Integers, base: Integers) -> Array:
        """(n, 3 T) the vertices, from `offset` on, at the nodes of cells of one group.

        row : (n,) of the tile in its group
        base : (n,) 3 * place of the cell
        """
        edges = self.steps[number].take(row, axis=0, mode="clip")
        for column in edges.T:
            column += base
        return _take(self.vertex_of, edges)

    def _sort(self, first: int, cells: _Set, owner: Integers, begun: int) -> None:
        """Sort the triangles from number `begun` on by the cells they are in, and name these."""
        order = np.argsort(owner, kind="stable")
        made = self.triangles.since(begun)
        made[:] = made[order]
        i, j, k = (cells.lattice_index(axis) for axis in range(3))
        _, n2, n3 = self.field.shape
        flat = ((i + first) * (n2 - 1) + j) * (n3 - 1) + k
        self.cells.more(len(owner))[:] = flat[owner[order]]

    # --- Interior points -------------------------------------------------------------------

    def _add_interior(
        self,
        part: _Part,
        number: int,
        cells: _Set,
        rows: Integers,
        key: Array,
        base: Integers,
        found: Array,
    ) -> None:
        """Number the interior points of cells of one group, and write them into their nodes."""
        own = _take(self.tables.interior, key)
        end = np.cumsum(own)
        inner = end - own + self.vertices.size
        out = self.vertices.more(int(end[-1]))
        if self.traced:
            self._trace(part, np.repeat(cells.samples(rows), own), -1, np.nan)
        node = self.tables.groups[number].nodes.take(
            _take(self.tables.row, key), axis=0, mode="clip"
        )
        inside = (inner - self.offset - 12)[:, None] + node
        np.copyto(found, inside, where=node >= 12, casting="same_kind")

        # Place averages here and now, all others at the end.
        index = [cells.lattice_index(axis, rows) + self.start[axis] for axis in range(3)]
        index[0] += part.first
        if self.tables.groups[number].inside == _Inside.AVERAGES:
            self._average(key, own, base, index, out)
        else:
            g = self._corners(part.samples, cells.samples(rows))
            self.deferred.append(_Deferred(key, g, (index[0], index[1], index[2]), inner))

    def _average(
        self, key: Array, own: Integers, base: Integers, index: list[Integers], out: Array
    ) -> None:
        """Place the averages of n cells, `own` (n,) in each, cell by cell."""
        # Find the average that each point is; take those of as many nodes together.
        tables = self.tables
        if (own == 1).all():
            cell, mean = np.arange(len(own)), _take(tables.means, key)
        else:
            cell = np.repeat(np.arange(len(own)), own)
            nth = np.arange(len(cell)) - np.repeat(np.cumsum(own) - own, own)
            mean = _take(tables.means, _take(key, cell)) + nth
        length = _take(tables.length, mean)
        order = np.argsort(length, kind="stable")
        start = 0
        for n, count in enumerate(np.bincount(length).tolist()):
            if not count:
                continue
            points = order[start : start + count]
            start += count
            column = _take(tables.place, _take(mean, points))
            own_cell = _take(cell, points)
            own_base = _take(base, own_cell)

            # Add the coordinates of the nodes, in the order of the cycle.
            total = np.zeros((3, count))
            for nodes in tables.averages[n]:
                e = _take(nodes, column)
                vertex = _take(self.vertex_of, _take(self.lattice.edge_steps, e) + own_base)
                t = _take(self.parameters, vertex)
                for axis in range(3):
                    along = _take(_ALONG[axis], e)
                    along *= t
                    along += _take(_LOWER[axis], e)
                    total[axis] += along
            total /= n
            for axis in range(3):
                total[axis] += _take(index[axis], own_cell)
                out[points, axis] = self._position(total[axis], axis)

    def _place_deferred(self) -> None:
        """Write the positions of interior points, the cells of one key together."""
        if not self.deferred:
            return

        # Ask each tile where its points are, or for what tells it.
        keys = np.concatenate([part.keys for part in self.deferred])
        g = np.concatenate([part.g for part in self.deferred], axis=1)
        first = np.concatenate([part.first for part in self.deferred])
        cells = [np.concatenate([part.cells[a] for part in self.deferred]) for a in range(3)]
        self.deferred.clear()
        later: dict[Callable[[Floats, Floats], Floats], list[tuple[Integers, Integers, Floats]]]
        later = {}
        order = np.argsort(keys, kind="stable")
        for rows in np.split(order, np.flatnonzero(np.diff(keys[order])) + 1):
            own = g[:, rows]
            interior = self.tables.tile[int(keys[rows[0]])].interior
            asks = any(getattr(place, "asks_crossings", True) for place in interior)
            crossings = cell_crossings(own) if asks else _NO_CROSSINGS
            for n, place in enumerate(interior):
                if hasattr(place, "finish"):
                    begun = place.begin(own, crossings)  # type: ignore[attr-defined]
                    later.setdefault(place.finish, []).append((rows, first[rows] + n, begun))
                else:
                    self._put(first[rows] + n, cells, rows, place(own, crossings))

        # Finish what many tiles have in common, for the cells of all of them at once.
        for finish, begun_ones in later.items():
            rows, numbers, begun = (np.concatenate(x) for x in zip(*begun_ones, strict=True))
            self._put(numbers, cells, rows, finish(g[:, rows], begun))

    def _put(
        self, numbers: Integers, cells: list[Integers], rows: Integers, inside: Floats
    ) -> None:
        """Write the positions of vertices that are at `inside` (n, 3) in the cells `rows` (n,)."""
        out = np.empty((len(rows), 3), self.vertices.array.dtype)
        for axis in range(3):
            out[:, axis] = self._position(cells[axis][rows] + inside[:, axis], axis)
        self.vertices.put(numbers, out)
