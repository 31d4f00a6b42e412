"""The sweep, vectorised: the mesh of `isoref.sweep`, triangle by triangle.

It goes through the volume twice, in *slabs* of planes small enough that their intermediate arrays
stay in the processor's cache. The first pass does what must be done for each voxel: it compares,
and finds the few cells the surface passes through. Then the size of the mesh is known, and the
second pass writes it into its final arrays, working on the active cells alone.

Glossary
--------
point       a lattice point, by its flat index in its slab
cell        named by its lower corner's point
signs       eight bits, one a corner: whether it is inside (`isoref.cube`)
active      a cell with corners on both sides
owner       each lattice edge belongs to the cell at its lower end, so no vertex is made twice and
            none has to be searched for: vertices are numbered by a running count
phantom     a cell beyond the upper border, whose missing samples repeat the border; it owns
            edges of the border but makes no triangles

Weld rule: two triangles share a vertex when they cross the same lattice edge, and only then.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isoref.cube import CORNER_OFFSETS, EDGE_CORNERS
from isoref.field import (
    Array,
    Booleans,
    Field,
    Floats,
    Integers,
    check_isovalue,
    least_inside,
)
from isoref.mesh import Mesh
from isoref.rule import Rule, Tile
from isoref.sweep import cell_crossings, check_volume, crossing_parameter

# Points of a slab and active cells worked on at once: a slab's bytes fit the processor's last
# cache, the numbers of a block of cells nearly fit its second.
SLAB_POINTS = 1 << 20
BLOCK_CELLS = 1 << 14


def sweep(rule: Rule, field: Field, isovalue: float) -> Mesh:
    """The rule's surface; see `isoref.sweep.sweep`."""
    return _swept(rule, field, isovalue, with_cells=False)[0]


def sweep_with_cells(rule: Rule, field: Field, isovalue: float) -> tuple[Mesh, Integers]:
    """The rule's surface and the cells of its triangles; see `isoref.sweep.sweep_with_cells`."""
    return _swept(rule, field, isovalue, with_cells=True)


def _swept(rule: Rule, field: Field, isovalue: float, with_cells: bool) -> tuple[Mesh, Integers]:
    """The rule's surface, and the cells of its triangles where they are wanted."""
    check_volume(field)
    isovalue = check_isovalue(isovalue)
    if min(field.shape) < 2:
        return Mesh.empty(3, 2), np.empty(0, np.int64)
    volume, tiles = _Volume.of(field, isovalue), _Tiles(rule)
    slabs = list(_find(volume, tiles))
    surface = _Surface(volume, tiles, slabs, with_cells)
    for slab, behind in zip(slabs, [*slabs[1:], None], strict=True):
        surface.add(slab, behind)
    surface.place_interior_points(slabs)
    return Mesh(surface.vertices, surface.triangles), surface.cells


class _Tiles:
    """The tiles met so far, as flat tables that many cells can be looked up in at once.

    A key is signs + 256 * decisions.
    """

    def __init__(self, rule: Rule) -> None:
        self.rule = rule
        self.asks = np.array([rule.asks(signs) for signs in range(256)])
        self.tile: dict[int, Tile] = {}
        size = 1 << (8 + rule.bits)
        self.key_type = np.min_scalar_type(size - 1)
        self.is_known = np.zeros(size, np.bool_)
        self.count = np.zeros(size, np.int64)  # triangles of a tile
        self.start = np.zeros(size, np.int64)  # its first row in `nodes`
        self.interior = np.zeros(size, np.int64)  # its interior points
        self.nodes = np.empty((0, 3), np.int64)

    def learn(self, keys: Array) -> None:
        """Make the tables hold the tile of every key that occurs."""
        rows = [self.nodes]
        end = len(self.nodes)
        unknown = keys[~_take(self.is_known, keys)]
        for key in np.flatnonzero(np.bincount(unknown)).tolist():
            tile = self.rule.tile(key & 255, key >> 8)
            self.tile[key], self.is_known[key] = tile, True
            self.count[key], self.start[key] = len(tile.triangles), end
            self.interior[key] = len(tile.interior)
            end += len(tile.triangles)
            rows.append(np.array(tile.triangles, np.int64).reshape(-1, 3))
        self.nodes = np.concatenate(rows)


def number_type(n: int) -> type[np.int32 | np.int64]:
    """The least of the two common integer types that can number n things.

    >>> number_type(1 << 31).__name__, number_type((1 << 31) + 1).__name__
    ('int32', 'int64')
    """
    return np.int32 if n <= 1 << 31 else np.int64


def _take(table: Array, index: Array) -> Array:
    """table[index], for indices that are in range: the look-up that NumPy is fastest at."""
    return table.take(index, mode="clip")


@dataclass(frozen=True)
class _Volume:
    """The field as slabs of planes.

    values : the samples, (N1, N2, N3)
    planes : of a slab, at most
    strides : how far neighbours along each axis are apart in a slab's samples, by flat index
    """

    field: Field
    values: Array
    isovalue: float
    planes: int
    strides: Integers

    @classmethod
    def of(cls, field: Field, isovalue: float) -> _Volume:
        """The volume in slabs of about `SLAB_POINTS` points."""
        n1, n2, n3 = field.shape
        planes = min(n1, max(1, SLAB_POINTS // (n2 * n3)))
        values = field.values.reshape(field.shape)
        return cls(field, values, isovalue, planes, np.array([n2 * n3, n3, 1]))

    def samples(self, first: int) -> Array:
        """The samples of the slab from plane `first` and of the plane behind it, flat."""
        planes = self.values[first : first + self.planes + 1]
        return np.ascontiguousarray(planes).reshape(-1)

    def relative(self, samples: Array) -> Floats:
        """Samples minus the isovalue."""
        values: Floats = samples.astype(np.float64)
        values -= self.isovalue
        return values

    def corners(self, samples: Array, cells: Array) -> Array:
        """The samples at the corners of n cells of a slab, (8, n)."""
        low = cells.astype(np.int64)
        return np.stack([_take(samples, low + s) for s in CORNER_OFFSETS @ self.strides])

    def index(self, points: Array) -> tuple[Array, Array, Array]:
        """Lattice indices of a slab's points, their planes counted from the slab's first."""
        plane, row, _ = self.strides.tolist()
        i = points // plane
        rest = points - i * plane
        j = rest // row
        return i, j, rest - j * row


# --- First pass: find the active cells ------------------------------------------------------


@dataclass(frozen=True)
class _Slab:
    """The active cells of some planes, named by their points' flat index in these planes.

    first : its first plane
    owners, signs : the active cells, phantoms included, in order
    cells, keys : those that are no phantoms
    having : which of `cells` have interior points
    corners : (8, n) the samples at the corners of these
    """

    first: int
    owners: Array
    signs: NDArray[np.uint8]
    cells: Array
    keys: Array
    having: Integers
    corners: Array


def _find(volume: _Volume, tiles: _Tiles) -> Iterator[_Slab]:
    """All slabs; `tiles` learns every tile that occurs in them."""
    n1, n2, n3 = volume.field.shape
    points = (volume.planes + 1) * n2 * n3
    work = np.empty((2, points + 7 & -8), np.uint8)
    for first in range(0, n1, volume.planes):
        samples = volume.samples(first)
        dense = _dense_signs(volume, samples, work)
        dense = dense[: min(volume.planes, n1 - first) * n2 * n3]
        owners = np.flatnonzero(_mixed(dense, work[1])).astype(number_type(points))
        signs = _take(dense, owners)
        i, j, k = volume.index(owners)
        real = np.flatnonzero((i < n1 - 1 - first) & (j < n2 - 1) & (k < n3 - 1))
        cells = _take(owners, real)
        keys = _keys(volume, tiles, samples, cells, _take(signs, real))
        tiles.learn(keys)
        having = np.flatnonzero(_take(tiles.interior > 0, keys))
        corners = volume.corners(samples, _take(cells, having))
        yield _Slab(first, owners, signs, cells, keys, having, corners)


def _dense_signs(volume: _Volume, samples: Array, work: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The signs of the cell above each sample, as if the samples at the end were repeated."""
    size = len(samples)
    signs, shifted = work[:, :size]
    level = least_inside(samples.dtype, volume.isovalue)
    np.greater_equal(samples, level, out=signs.view(np.bool_))
    # Join to the corners so far those of the next point along each axis in turn. Shift words of
    # eight bytes, whose bits stay apart.
    words, words_shifted = work.view(np.uint64)
    block, block_shifted = (a.reshape(-1, *volume.field.shape[1:]) for a in (signs, shifted))
    for axis, last in ((2, np.s_[:, :, -1]), (1, np.s_[:, -1]), (0, np.s_[-1])):
        np.left_shift(words, 1 << axis, out=words_shifted)
        repeated = block[last] | block_shifted[last]
        step = int(volume.strides[axis])
        np.bitwise_or(signs[:-step], shifted[step:], out=signs[:-step])
        block[last] = repeated
    return np.asarray(signs)


def _mixed(signs: NDArray[np.uint8], work: NDArray[np.uint8]) -> Booleans:
    """Which signs are neither none nor all; written into `work`."""
    # Add one, so that all wraps round to zero beside none.
    following = np.add(signs, 1, out=work[: len(signs)])
    return np.asarray(np.greater(following, 1, out=following.view(np.bool_)))


def _keys(
    volume: _Volume,
    tiles: _Tiles,
    samples: Array,
    cells: Array,
    signs: NDArray[np.uint8],
) -> Array:
    """The key of each cell, its decisions taken only where the rule asks."""
    keys = signs.astype(tiles.key_type)
    asked = np.flatnonzero(_take(tiles.asks, signs))
    if tiles.rule.bits and len(asked):
        g = volume.relative(volume.corners(samples, _take(cells, asked)))
        keys[asked] |= (tiles.rule.decisions(g) << 8).astype(tiles.key_type)
    return keys


# --- Second pass: number the crossings and gather the triangles --------------------------------

# For signs, which of the cell's three lower edges are crossed; one word of four bytes.
_CROSSED = np.array(
    [[(signs ^ signs >> (1 << a)) & 1 for a in range(3)] + [0] for signs in range(256)], np.uint8
)
_CROSSINGS = _CROSSED.sum(axis=1, dtype=np.int64)


def _crossed_edges(owners: Array, signs: NDArray[np.uint8]) -> tuple[Array, Integers]:
    """The crossed edges these cells own, in order: their lower points and their axes."""
    slots = np.flatnonzero(_take(_CROSSED.view(np.uint32), signs).view(np.bool_))
    return _take(owners, slots >> 2), slots & 3


def _owners(end: Integers) -> Integers:
    """To which cell each triangle belongs, where the cells' triangles end before `end`.

    The same as np.repeat(np.arange(len(count)), count) in half the time.

    >>> _owners(np.cumsum([2, 0, 3]))
    array([0, 0, 2, 2, 2])
    """
    size = int(end[-1])
    begun = np.bincount(end[:-1], minlength=size)[:size]
    return np.cumsum(begun, out=begun)


def _blocks(n: int) -> Iterator[slice]:
    """Slices of at most `BLOCK_CELLS` that cover 0 .. n - 1."""
    return (slice(start, min(start + BLOCK_CELLS, n)) for start in range(0, n, BLOCK_CELLS))


class _Surface:
    """The arrays of the mesh, of their final size, filled from the front slab by slab.

    crossings : how many vertices are crossings; the interior points come behind them
    made, gathered, made_inside : crossings, triangles and interior points so far
    vertex_of : lattice edge 3 * point + axis of a slab -> vertex
    steps : (3, rows) from 3 * point to the edge of each node in `tiles.nodes`
    """

    def __init__(
        self, volume: _Volume, tiles: _Tiles, slabs: list[_Slab], with_cells: bool
    ) -> None:
        self.volume, self.tiles = volume, tiles
        self.crossings = sum(int(_CROSSINGS.take(slab.signs).sum()) for slab in slabs)
        interior = sum(int(tiles.interior.take(slab.keys).sum()) for slab in slabs)
        triangles = sum(int(tiles.count.take(slab.keys).sum()) for slab in slabs)
        self.vertices = np.empty((self.crossings + interior, 3))
        self.triangles = np.empty((triangles, 3), np.int64)
        self.cells = np.empty(triangles if with_cells else 0, np.int64)
        self.made = self.gathered = self.made_inside = 0
        edges = 3 * (volume.planes + 1) * int(volume.strides[0])
        self.vertex_of = np.empty(edges, number_type(self.crossings))
        # Edge e of a cell is the lower edge, along its axis, of the cell at its lower corner.
        corner_steps = CORNER_OFFSETS @ volume.strides
        edge_steps = 3 * corner_steps[EDGE_CORNERS[:, 0]] + np.arange(12) // 4
        self.steps = np.append(edge_steps, 0)[np.minimum(tiles.nodes.T, 12)]

    def add(self, slab: _Slab, behind: _Slab | None) -> None:
        """Write the crossings of a slab's edges and its triangles; `behind` is the next slab."""
        samples = self.volume.samples(slab.first)
        for block in _blocks(len(slab.owners)):
            points, axis = _crossed_edges(slab.owners[block], slab.signs[block])
            self._number(points, axis, self.made)
            self._place(slab, samples, points, axis)
            self.made += len(points)
        if behind is not None:
            # The upper edges of the last cells belong to the next slab: number them ahead.
            plane = int(self.volume.strides[0])
            ahead = slice(0, int(np.searchsorted(behind.owners, plane)))
            points, axis = _crossed_edges(behind.owners[ahead], behind.signs[ahead])
            self._number(points + self.volume.planes * plane, axis, self.made)
        for block in _blocks(len(slab.cells)):
            self._gather(slab, slab.cells[block], slab.keys[block])

    def _number(self, points: Array, axis: Integers, first: int) -> None:
        """Remember the vertices of these edges, numbered from `first` on."""
        edges = 3 * points.astype(np.int64) + axis
        self.vertex_of[edges] = np.arange(first, first + len(edges), dtype=self.vertex_of.dtype)

    def _place(self, slab: _Slab, samples: Array, points: Array, axis: Integers) -> None:
        """Write the positions of the crossings of these edges."""
        field = self.volume.field
        low = self.volume.relative(_take(samples, points))
        high = self.volume.relative(_take(samples, points + _take(self.volume.strides, axis)))
        t = crossing_parameter(low, high)
        out = self.vertices[self.made : self.made + len(points)]
        for a, index in enumerate(self.volume.index(points)):
            place = (axis == a) * t
            place += index + slab.first if a == 0 else index
            place *= field.spacing[a]
            np.add(place, field.origin[a], out=out[:, a])

    def _gather(self, slab: _Slab, cells: Array, keys: Array) -> None:
        """Write the triangles of these cells, in order."""
        count = _take(self.tiles.count, keys)
        end = np.cumsum(count)
        owner = _owners(end)
        row = _take(_take(self.tiles.start, keys) - end + count, owner)
        row += np.arange(len(owner))
        base = _take(3 * cells.astype(np.int64), owner)
        out = slice(self.gathered, self.gathered + len(owner))
        for k in range(3):
            edges = _take(self.steps[k], row)
            edges += base
            self.triangles[out, k] = _take(self.vertex_of, edges)
        if len(self.cells):
            self.cells[out] = _take(self._flat(slab, cells), owner)
        self._gather_inside(keys, owner, row)
        self.gathered += len(owner)

    def _gather_inside(self, keys: Array, owner: Integers, row: Integers) -> None:
        """Write the nodes of triangles that are interior points, numbered cell by cell."""
        interior = _take(self.tiles.interior, keys)
        if not interior.any():
            return
        end = np.cumsum(interior)
        first = end - interior + (self.crossings + self.made_inside)
        for k, nodes in enumerate(self.tiles.nodes.T):
            if nodes.max() >= 12:
                places = np.flatnonzero(_take(nodes >= 12, row))
                numbers = _take(first, owner[places]) + nodes[row[places]] - 12
                self.triangles[self.gathered + places, k] = numbers
        self.made_inside += int(end[-1])

    def _flat(self, slab: _Slab, cells: Array) -> Integers:
        """The flat index of cells in the lattice of cells."""
        i, j, k = self.volume.index(cells.astype(np.int64))
        _, n2, n3 = self.volume.field.shape
        return np.asarray(((i + slab.first) * (n2 - 1) + j) * (n3 - 1) + k)

    def place_interior_points(self, slabs: list[_Slab]) -> None:
        """Write the positions of the interior points behind the crossings, cell by cell."""
        plane = int(self.volume.strides[0])
        cells = np.concatenate([_take(s.cells, s.having) + s.first * plane for s in slabs])
        keys = np.concatenate([_take(s.keys, s.having) for s in slabs])
        corners = np.concatenate([s.corners for s in slabs], axis=1)
        own = _take(self.tiles.interior, keys)
        first = self.crossings + np.cumsum(own) - own
        # Take the cells of one key together: they share their placements.
        order = np.argsort(keys, kind="stable")
        for same in np.split(order, np.flatnonzero(np.diff(keys[order])) + 1):
            for block in _blocks(len(same)):
                rows = same[block]
                g = self.volume.relative(corners.take(rows, axis=1, mode="clip"))
                self._place_inside(cells[rows], int(keys[rows[0]]), g, first[rows])

    def _place_inside(self, cells: Integers, key: int, g: Floats, first: Integers) -> None:
        """Write the interior points of cells of one key, from vertices `first` on."""
        field = self.volume.field
        crossings = cell_crossings(g)
        low = self.volume.index(cells)
        for k, place in enumerate(self.tiles.tile[key].interior):
            inner = place(g, crossings)
            for a in range(3):
                coordinate = (low[a] + inner[:, a]) * field.spacing[a] + field.origin[a]
                self.vertices[first + k, a] = coordinate
