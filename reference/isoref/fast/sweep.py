"""The sweep, vectorised: the triangles of `isoref.sweep`.

Most of a volume is nowhere near the surface, so what must be done for each sample decides. Here
that is little: compare it, and keep the answer as one *bit*. All that follows is asked of eight
samples at once, or of sixty-four (`isoref.fast._bits`), and only where the surface is are edges and
cells looked at one by one. What a cell draws is known from its signs and decisions: its tile, cut
into fans of triangles, so that the cells of a volume can be drawn together (`isoref.fast._fans`).

The volume is passed once, in *slabs* of planes small enough that their bits stay in the processor's
cache, and a slab in *parts* of so many cells that their numbers do. A part owns the cells between
its planes, and the crossed edges of all its planes but the first, which the part before it owns:
each crossing is numbered once, by a running count, and nothing has to be searched for. Nothing of a
slab is kept but its last plane and the mesh so far, so a volume may be larger than the memory (a
`numpy.memmap`, say).

Glossary
--------
place, edge, signs
            as in `isoref.fast._bits`
key, kind   as in `isoref.fast._fans`

Weld rule: two triangles share a vertex when they cross the same lattice edge, and only then.
Triangles come part by part, within a part kind by kind; where provenance is asked for they are
sorted by cells. Vertices come part by part, crossings before interior points.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from isoref.cube import CORNER_OFFSETS
from isoref.fast._bits import POPULATION, Bits, Bytes, Lattice, Set, Touched, lattice_of, take
from isoref.fast._fans import BLOCK, LONGEST, Kind, corners_of, steps_of, tiles_of
from isoref.fast._growing import Growing
from isoref.field import Array, Field, Floats, Integers, check_isovalue, least_inside
from isoref.mesh import Mesh, Precision, Provenance, in_space, number_types
from isoref.rule import Rule
from isoref.sweep import LEAST, cell_crossings, check_volume, crossing_parameter

# At most so many places in a slab, its last plane too, and half as many where the surface is
# folded, so that its bits and the numbers of its vertices fit the last cache; so many samples
# compared at once, and about so many active cells, so that their arrays fit the second, and the
# parts of a folded surface take little memory beside it.
SLAB_POINTS = 17 << 16
CHUNK_POINTS = 1 << 17
PART_CELLS = 5 << 12

# At most so many vertices that room is made for at once. To move to larger arrays leaves the
# allocator with the smaller ones, so there should be room for most surfaces.
EXPECTED = 1 << 21

# The vertices of a slab's edges may take so many bytes of a room that is kept for the next call.
KEPT = 1 << 22


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


# --- The sweep ---------------------------------------------------------------------------------

# In place of the crossings of a cell for those who do not look at them.
_NO_CROSSINGS = np.empty((12, 0, 3))


class _Room:
    """The arrays that all slabs of at most so many planes of cells work in.

    vertex_of : (3 * places,) the vertex on each crossed edge of a part, counted from `offset` on; a
        part's places are counted from its own first plane, so of a slab in many parts most is never
        written
    edges, found, nodes : of a block of fans: the edges and vertices at one node, and the vertices
        at all of them
    """

    def __init__(self, lattice: Lattice, planes: int, chunk: int, whole: type[Any]) -> None:
        self.bits = Bits(lattice, planes, chunk)
        self.vertex_of = np.empty(3 * (planes + 1) * lattice.plane, np.int32)
        self.edges, self.found = np.empty(BLOCK, np.int64), np.empty(BLOCK, np.int32)
        self.nodes = np.empty((LONGEST + 2, BLOCK), whole)


# Small rooms, left by sweeps that are done, for sweeps to come: with a small volume, to make a room
# takes as long as to work in it.
_rooms: deque[tuple[Any, _Room]] = deque(maxlen=4)


@contextmanager
def _room(*kind: Any) -> Iterator[_Room]:
    """A room of this kind, which nobody else works in."""
    try:
        found, room = _rooms.pop()
    except IndexError:
        found = None
    if found != kind:
        room = _Room(*kind)
    yield room
    if room.vertex_of.nbytes <= KEPT:
        _rooms.append((kind, room))


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
class _Points:
    """The interior points of n cells of a part.

    cells : (n,) which of the part's cells
    keys : (n,) of these
    first : (n,) the first of each one's points, counted from the first of the part's
    """

    cells: Integers
    keys: Integers
    first: Integers


@dataclass(frozen=True, eq=False)
class _Part:
    """A part of a slab: its cells between two of the slab's planes.

    first : the first of its planes in the volume
    planes : how many planes of cells it has
    samples : from that plane on, flat
    """

    first: int
    planes: int
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
        self.field, self.tiles, self.traced = field, tiles_of(rule), traced
        self.values = field.values if field.values.ndim == 3 else field.values[0]
        self.level = least_inside(field.values.dtype, self.isovalue)
        self.lattice = lattice_of(*field.shape[1:])
        self.tables = self.tiles.tables
        expected = self._expected()
        self.vertices = Growing(3, real, expected)
        self.triangles = Growing(3, whole, 2 * expected)
        self.cells = Growing(0, np.int64, 2 * expected if traced else 0)
        self.ends = Growing(2, np.int64, expected if traced else 0)
        self.along = Growing(0, np.float64, expected if traced else 0)
        self.deferred: list[_Deferred] = []

    def _expected(self) -> int:
        """Vertices to make room for at once: a surface twice as large as the volume's border."""
        n1, n2, n3 = self.field.shape
        return min(2 * (n1 * n2 + n2 * n3 + n3 * n1), EXPECTED)

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

    # --- Slabs and parts -------------------------------------------------------------------

    def _run(self) -> Iterator[float]:
        """Pass through the volume, slab by slab; after each part, which share is done."""
        layers = self.field.shape[0] - 1
        if min(self.field.shape) < 2:
            return
        planes, half = (
            min(layers, max(1, places // self.lattice.plane - 1))
            for places in (SLAB_POINTS, SLAB_POINTS // 2)
        )
        chunk = min(planes, max(1, CHUNK_POINTS // self.lattice.plane))
        with _room(self.lattice, planes, chunk, self.triangles.array.dtype.type) as room:
            self._move_in(room)
            self.bits.begin(self.values[:1])
            # A slab that is cut into parts anyway gains nothing by its size, and takes memory.
            first, rate = 0, 3 * self.bits.crossed_on_first_plane()
            while first < layers:
                most = half if rate * planes > PART_CELLS else planes
                before, step = self.vertices.size, min(most, layers - first)
                yield from self._slab(first, step)
                first, rate = first + step, (self.vertices.size - before) // step

    def _move_in(self, room: _Room) -> None:
        """Begin to work in this room."""
        self.bits, self.vertex_of = room.bits, room.vertex_of
        self.edges, self.found, self.nodes = room.edges, room.found, room.nodes
        self.bits.level = self.level
        self.copied: Array | None = None  # the samples of a slab, where they lie in another order
        # Vertices of a part are numbered from `offset` on, the first vertex of the part before.
        self.offset = self.begun = 0
        # Where on their edges the crossings are of this part and the one before: as they came, each
        # with the number of its first vertex, and, where averages ask, so many of them by number.
        self.recent: list[tuple[int, Floats]] = []
        self.parameters, self.entered = np.empty(0), 0
        self.upper_edges = self.upper_vertices = np.empty(0, np.int64)

    def _slab(self, first: int, planes: int) -> Iterator[float]:
        """Add the cells between planes `first` and `first + planes`; as `_run`."""
        samples = self._samples(first, planes)
        where = self.bits.slab(samples)

        # Go through the active cells part by part; the last plane of one is the first of the next.
        if len(where):
            starts = where.searchsorted(self.lattice.plane_bytes * np.arange(planes + 2))
            for low, high in pairwise(self._parts(where, starts, planes)):
                part = _Part(first + low, high - low, samples[low:].reshape(-1))
                touched = Touched(where[starts[low] : starts[high + 1]], self.lattice, low)
                self._enter()
                self._make_crossings(part, touched)
                self._make_cells(part, touched)
                yield (first + high) / (self.field.shape[0] - 1)
        self.bits.go_on(planes)

    def _enter(self) -> None:
        """Begin a part: its first plane is the last of the part before, whose vertices it knows."""
        self.recent, self.entered = self.recent[-1:], 0
        self.offset, self.begun = self.begun, self.vertices.size
        self.vertex_of[self.upper_edges] = self.upper_vertices
        self.upper_edges = self.upper_vertices = np.empty(0, np.int64)

    def _samples(self, first: int, planes: int) -> Array:
        """The samples of these planes and of the one behind them, in C order and native numbers."""
        samples = self.values[first : first + planes + 1]
        if samples.flags.c_contiguous and samples.dtype.isnative:
            return samples
        if self.copied is None or len(self.copied) < len(samples):
            kind = samples.dtype.newbyteorder("=")
            self.copied = np.empty(samples.shape, kind)
        copied = self.copied[: planes + 1]
        copied[:] = samples
        return copied

    def _parts(self, where: Integers, starts: Integers, planes: int) -> list[int]:
        """The planes at which to cut a slab, so that a part has about `PART_CELLS` active cells.

        starts : (planes + 2,) where in `where` each plane starts
        """
        if 4 * len(where) <= PART_CELLS:  # seldom are more than half of a byte's cells active
            return [0, planes]
        before = np.append(0, np.cumsum(take(POPULATION, self.bits.active(where))))[starts]
        parts = [0]
        while parts[-1] < planes:
            most = before[parts[-1]] + PART_CELLS
            last = int(np.searchsorted(before[: planes + 1], most, "right")) - 1
            parts.append(max(parts[-1] + 1, last))
        return parts

    # --- Crossings -------------------------------------------------------------------------

    def _make_crossings(self, part: _Part, touched: Touched) -> None:
        """Number and place the crossings on the edges that a part owns, axis by axis.

        They are those between its planes, and on all of these but the lowest.
        """
        edges, ends = self.bits.edges(touched, int(part.first > 0), part.planes)
        at = edges.places()
        self._number(part, at, ends)

        # Interpolate between the samples at both ends of each edge.
        if self.lattice.row > self.lattice.n3:
            at = edges.samples()
        below = self._relative(take(part.samples, at))
        for axis, step in enumerate(self.lattice.sample_steps.tolist()):
            at[ends[axis] : ends[axis + 1]] += step
        t = self._parameters_of(below, self._relative(take(part.samples, at)))
        self.recent.append((self.vertices.size, t))
        if self.traced:
            self._trace(part, edges.samples(), at, t)

        # Write the positions.
        out = self.vertices.more(len(t))
        for axis in range(3):
            first = touched.index[axis] + (self.start[axis] + (0 if axis else part.first))
            index = take(first.astype(np.float64), edges.byte)
            if axis == 2:
                index += edges.bit
            index[ends[axis] : ends[axis + 1]] += t[ends[axis] : ends[axis + 1]]
            out[:, axis] = self._position(index, axis)

    def _number(self, part: _Part, places: Integers, ends: list[int]) -> None:
        """Give the edges of a part the next numbers; keep those that the next part needs."""
        names = 3 * places
        for axis in (1, 2):
            names[ends[axis] : ends[axis + 1]] += axis
        start = self.vertices.size - self.offset
        self.vertex_of[names] = np.arange(start, start + len(names), dtype=np.int32)

        # The edges on the last plane are those on the first plane of the next part.
        top = part.planes * self.lattice.plane
        kept = np.concatenate(
            [
                np.arange(begin + places[begin:end].searchsorted(top), end)
                for begin, end in pairwise(ends[1:])
            ]
        )
        self.upper_edges = names[kept] - 3 * top
        self.upper_vertices = kept  # counted from the first vertex of this part

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

    def _parameters_of(self, below: Floats, above: Floats) -> Floats:
        """Where on their edges the crossings are, as `crossing_parameter`."""
        if self.values.dtype.itemsize > 4:
            return crossing_parameter(below, above)
        # Numbers of 32 bits are far enough apart, and not too far, for any difference of doubles.
        above -= below
        np.divide(below, above, out=above)
        return np.negative(above, out=above)

    def _position(self, index: Floats, axis: int) -> Floats:
        """The positions of fractional indices along an axis, in the array of these."""
        if self.field.spacing[axis] != 1:
            index *= self.field.spacing[axis]
        if self.field.origin[axis] != 0:
            index += self.field.origin[axis]
        return index

    # --- Triangles -------------------------------------------------------------------------

    def _make_cells(self, part: _Part, touched: Touched) -> None:
        """Add the triangles of active cells, and note their interior points."""
        cells, signs = self.bits.cells(touched, part.planes)
        if not len(signs):
            return
        keys = self._keys(part.samples, cells, signs)
        self.tables = self.tiles.learn(keys)
        self.steps = steps_of(self.tables, self.lattice)
        base = 3 * cells.places()
        inner = self._add_interior(part, cells, keys, base)

        # Take the fans of one kind together.
        fans, owners = self.tables.fans_of(keys)
        kinds = take(self.tables.kind, fans)
        order = kinds.argsort(kind="stable")
        counts = np.bincount(kinds, minlength=256)
        columns, owners = take(self.tables.column, take(fans, order)), take(owners, order)
        base = take(base, owners)
        start, begun = 0, self.triangles.size
        for kind in self.tables.kinds.values():
            own = slice(start, start + int(counts[kind.number]))
            if own.stop > start:
                first = None
                if inner is not None and kind.is_inside:
                    first = take(inner, owners[own])
                self._draw(kind, columns[own], base[own], first)
            start = own.stop
        if self.traced:
            self._sort(part.first, cells, np.repeat(owners, self._sizes(counts)), begun)

    def _keys(self, samples: Array, cells: Set, signs: Bytes) -> Integers:
        """The key of each cell, its decisions taken only where the rule asks."""
        keys = signs.astype(np.int64)
        if not self.tiles.rule.bits:
            return keys
        asked = take(self.tiles.asks, keys).nonzero()[0]
        if len(asked):
            g = self._corners(samples, cells.samples(asked))
            keys[asked] |= self.tiles.rule.decisions(g) << 8
        return keys

    def _corners(self, samples: Array, low: Integers) -> Floats:
        """(8, n) the samples at the corners of n cells, minus the isovalue."""
        steps = (CORNER_OFFSETS @ self.lattice.sample_steps).tolist()
        g = np.empty((8, len(low)))
        for c, step in enumerate(steps):
            g[c] = self._relative(take(samples, low + step))
        return g

    def _draw(self, kind: Kind, column: Integers, base: Integers, inner: Integers | None) -> None:
        """Add the triangles of n fans of one kind, block by block.

        column : (n,) of each fan in its kind
        base : (n,) 3 * place of its cell
        inner : (n,) the number of the node 12 of its cell, less 12, where there are such nodes
        """
        size, corners = 3 * kind.triangles, corners_of(kind.number)
        out = self.triangles.more(kind.triangles * len(base)).reshape(-1)
        for start in range(0, len(base), BLOCK):
            own = slice(start, min(start + BLOCK, len(base)))
            count = own.stop - start
            self._look_up(kind, column[own], base[own], None if inner is None else inner[own])
            self.nodes.take(
                corners[: size * count], mode="clip", out=out[size * start : size * own.stop]
            )

    def _look_up(
        self, kind: Kind, column: Integers, base: Integers, inner: Integers | None
    ) -> None:
        """Put the vertices at the nodes of a block of fans into `nodes`; as `_draw`."""
        edges, found = self.edges[: len(base)], self.found[: len(base)]
        for steps, nodes, out in zip(
            self.steps.fans[kind.number], kind.nodes, self.nodes, strict=False
        ):
            steps.take(column, mode="clip", out=edges)
            edges += base
            self.vertex_of.take(edges, mode="clip", out=found)
            np.add(found, self.offset, out=out[: len(base)])
            if inner is not None and nodes.max() >= 12:
                node = take(nodes, column)
                np.copyto(out[: len(base)], inner + node, where=node >= 12, casting="same_kind")

    def _sizes(self, counts: Integers) -> Integers:
        """(n,) how many triangles each fan has, given how many there are of each kind."""
        kinds = self.tables.kinds
        return np.repeat([kind.triangles for kind in kinds.values()], counts[list(kinds)])

    def _sort(self, first: int, cells: Set, owner: Integers, begun: int) -> None:
        """Sort the triangles from number `begun` on by the cells they are in, and name these."""
        order = np.argsort(owner, kind="stable")
        made = self.triangles.since(begun)
        made[:] = made[order]
        owner = owner[order]
        i, j, k = (cells.lattice_index(axis, owner) for axis in range(3))
        _, n2, n3 = self.field.shape
        self.cells.more(len(owner))[:] = ((i + first) * (n2 - 1) + j) * (n3 - 1) + k

    # --- Interior points -------------------------------------------------------------------

    def _add_interior(
        self, part: _Part, cells: Set, keys: Integers, base: Integers
    ) -> Integers | None:
        """Number the interior points of n cells; (n,) the number of the first, less 12.

        Numbers are as they come where a cell has no such points. None where no cell has any.
        """
        if not self.tables.interior.any():
            return None
        own = take(self.tables.interior, keys)
        rows = own.nonzero()[0]
        if not len(rows):
            return None
        begun, own, key = self.vertices.size, take(own, rows), take(keys, rows)
        end = own.cumsum()
        first = end - own
        out = self.vertices.more(int(end[-1]))
        if self.traced:
            self._trace(part, cells.samples(rows).repeat(own), -1, np.nan)

        # Place averages here and now, all others at the end.
        deferred = take(self.tables.deferred, key)
        if not deferred.all():
            which = (~deferred).nonzero()[0]
            points = _Points(*(take(one, which) for one in (rows, key, first)))
            self._average(part, cells, points, take(base, points.cells), out)
        if deferred.any():
            which = deferred.nonzero()[0]
            later = take(rows, which)
            g = self._corners(part.samples, cells.samples(later))
            index = self._cell_index(part, cells, later)
            self.deferred.append(_Deferred(take(key, which), g, index, take(first, which) + begun))

        inner = np.empty(len(keys), np.int64)
        inner[rows] = first + (begun - 12)
        return inner

    def _cell_index(
        self, part: _Part, cells: Set, rows: Integers
    ) -> tuple[Integers, Integers, Integers]:
        """Three times (n,) the index of some cells, in the larger volume where there is one."""
        i, j, k = (cells.lattice_index(axis, rows) + self.start[axis] for axis in range(3))
        return i + part.first, j, k

    def _average(
        self, part: _Part, cells: Set, points: _Points, base: Integers, out: Array
    ) -> None:
        """Place the averages of n cells in the rows of `out` that are theirs.

        base : (n,) 3 * place of each cell
        """
        # Name the cell, the row and the number of each average.
        tables = self.tables
        own = take(tables.interior, points.keys)
        cell = np.arange(len(own)).repeat(own)
        nth = np.arange(len(cell)) - (own.cumsum() - own).repeat(own)
        row = take(points.first, cell) + nth
        mean = take(tables.means, take(points.keys, cell)) + nth

        # Take those of as many nodes together.
        length = take(tables.length, mean)
        order = length.argsort(kind="stable")
        start = 0
        for n, count in enumerate(np.bincount(length).tolist()):
            if not count:
                continue
            which = order[start : start + count]
            start += count
            own_cell, own_row = take(cell, which), take(row, which)
            place = self._mean(n, take(tables.place, take(mean, which)), take(base, own_cell))
            index = self._cell_index(part, cells, take(points.cells, own_cell))
            for axis in range(3):
                place[axis] += index[axis]
                out[own_row, axis] = self._position(place[axis], axis)

    def _parameters(self) -> Floats:
        """Where on its edge each crossing is, by its number, counted from `offset` on."""
        size = self.vertices.size - self.offset
        if len(self.parameters) < size:
            self.parameters, self.entered = np.empty(2 * size), 0
        for first, t in self.recent[self.entered :]:
            start = first - self.offset
            self.parameters[start : start + len(t)] = t
        self.entered = len(self.recent)
        return self.parameters

    def _mean(self, n: int, column: Integers, base: Integers) -> Floats:
        """(3, m) where the averages of n nodes are in their cells, the nodes added in their order.

        column : (m,) of each average in its tables
        base : (m,) 3 * place of its cell
        """
        means, steps = self.tables.averages[n], self.steps.averages[n]
        parameters = self._parameters()
        total = np.zeros((3, len(column)))
        for node in range(n):
            edges = take(steps[node], column)
            edges += base
            t = take(parameters, take(self.vertex_of, edges))
            for axis in range(3):
                along = take(means.along[axis, node], column)
                along *= t
                along += take(means.lower[axis, node], column)
                total[axis] += along
        total /= n
        return total

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
