"""The sweep: a rule carried over a field.

Twice. `sweep_plain` is the obvious triple loop, to be read; `sweep` is the same in NumPy, to be
used. Both give the same mesh, triangle by triangle, up to the numbering of the vertices.

The vectorised sweep goes through the volume in *slabs* of planes, small enough that their
intermediate arrays stay in the processor's cache, and does as little as it can for each voxel:
it compares, finds the few cells the surface passes through, and works on those alone.

Glossary
--------
point       a lattice point of the slab, by its flat index
cell        named by its lower corner's point
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
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isoref.cube import CORNER_OFFSETS, EDGE_CORNERS, axis_of
from isoref.field import Array, Booleans, Field, FieldError, Floats, Integers, check_isovalue
from isoref.mesh import Mesh
from isoref.rule import Rule, Tile

SLAB_POINTS = 1 << 20


def least_inside(dtype: np.dtype[Any], isovalue: float) -> Any:
    """The least number of type `dtype` that is not below the isovalue.

    A comparison would round the isovalue to the samples' type; this rounds it up, so that the
    comparison stays exact, and cheap.

    >>> least_inside(np.dtype(np.uint8), 3.2)
    4
    >>> float(least_inside(np.dtype(np.float32), 0.3)) >= 0.3
    True
    """
    if dtype.kind in "biu":
        return int(np.ceil(isovalue))
    with np.errstate(over="ignore"):
        rounded = dtype.type(isovalue)
    if rounded < isovalue:
        rounded = np.nextafter(rounded, dtype.type(np.inf))
    return rounded


def inside_samples(field: Field, isovalue: float) -> Booleans:
    """Which samples are inside: value >= isovalue."""
    mask: Booleans = field.values >= least_inside(field.values.dtype, isovalue)
    return mask


def crossing_parameter(low: Floats, high: Floats) -> Floats:
    """Where on an edge the linear interpolant vanishes, 0 at the end `low` and 1 at `high`.

    Both are relative values (sample minus isovalue) of different signs.
    """
    return np.asarray(low / (low - high))


def _check_volume(field: Field) -> None:
    """Nothing, where the field is a scalar field on a three-dimensional lattice; else raises."""
    if field.dimension != 3 or field.components != 1:
        raise FieldError(
            f"a sweep needs one value a sample on a 3-D lattice, not {field.components} on a "
            f"{field.dimension}-D one"
        )


# --------------------------------------------------------------------------------------------
# The plain sweep
# --------------------------------------------------------------------------------------------


def sweep_plain(rule: Rule, field: Field, isovalue: float) -> Mesh:
    """The rule's surface, by a triple loop over the cells.

    Raises `FieldError` for a field that is not a scalar volume or an isovalue that is no number.
    """
    _check_volume(field)
    values = field.values.astype(np.float64) - check_isovalue(isovalue)
    vertices: list[Floats] = []
    number: dict[object, int] = {}
    triangles: list[list[int]] = []
    for cell in np.ndindex(*(n - 1 for n in field.shape)):
        g = np.array([values[tuple(cell + offset)] for offset in CORNER_OFFSETS])
        signs = sum(1 << c for c in range(8) if g[c] >= 0)
        decisions = int(rule.decisions(g[:, None])[0]) if rule.asks(signs) else 0
        tile = rule.tile(signs, decisions)
        crossings = cell_crossings(g[:, None])

        def vertex(node: int) -> int:
            """The number of the vertex at this node of the cell, made when it is first met."""
            key = lattice_edge(cell, node) if node < 12 else (cell, node)  # noqa: B023
            if key not in number:
                place = _node_place(tile, node, g, crossings)  # noqa: B023
                number[key] = len(vertices)
                vertices.append(field.position(np.asarray(cell) + place))  # noqa: B023
            return number[key]

        triangles += [[vertex(node) for node in triangle] for triangle in tile.triangles]
    if not triangles:
        return Mesh.empty(3, 2)
    return Mesh.of(vertices, triangles)


def lattice_edge(cell: tuple[int, ...], e: int) -> tuple[int, ...]:
    """The lattice edge that is edge e of the cell: its lower end and its axis.

    >>> lattice_edge((0, 0, 0), 3) == lattice_edge((0, 1, 1), 0)
    True
    """
    low = CORNER_OFFSETS[EDGE_CORNERS[e][0]]
    return (*(int(i) for i in cell + low), axis_of(e))


def _node_place(tile: Tile, node: int, g: Floats, crossings: Floats) -> Floats:
    """The coordinates of a node in its cell, (3,)."""
    if node < 12:
        return np.asarray(crossings[node, 0])
    return np.asarray(tile.interior[node - 12](g[:, None], crossings)[0])


def cell_crossings(g: Floats) -> Floats:
    """Where the surface crosses each edge of n cells, (12, n, 3) from g (8, n).

    Coordinates are those of the cell; an edge that is not crossed has NaN.
    """
    crossings = np.full((12, g.shape[1], 3), np.nan)
    for e, (a, b) in enumerate(EDGE_CORNERS):
        crossed = (g[a] >= 0) != (g[b] >= 0)
        crossings[e, crossed] = CORNER_OFFSETS[a]
        crossings[e, crossed, axis_of(e)] = crossing_parameter(g[a, crossed], g[b, crossed])
    return crossings


# --------------------------------------------------------------------------------------------
# The vectorised sweep
# --------------------------------------------------------------------------------------------


def sweep(rule: Rule, field: Field, isovalue: float) -> Mesh:
    """The rule's surface, vectorised.

    Raises `FieldError` for a field that is not a scalar volume or an isovalue that is no number.
    """
    return sweep_with_cells(rule, field, isovalue)[0]


def sweep_with_cells(rule: Rule, field: Field, isovalue: float) -> tuple[Mesh, Integers]:
    """The rule's surface, and for each triangle the cell it lies in.

    A cell is given by its flat index in the lattice of cells, (N1-1) x (N2-1) x (N3-1), and
    triangles come in that order.
    """
    _check_volume(field)
    isovalue = check_isovalue(isovalue)
    if min(field.shape) < 2:
        return Mesh.empty(3, 2), np.empty(0, np.int64)
    tiles = _Tiles(rule)
    pieces = list(_pieces(tiles, field, isovalue))
    vertices = np.concatenate([piece.vertices for piece in pieces])
    triangles = np.concatenate([piece.triangles for piece in pieces])
    cells = np.concatenate([piece.cells for piece in pieces])
    having = np.concatenate([piece.having for piece in pieces], axis=1)
    if having.size:
        # Number the interior points behind the crossings: so far they count down from -1.
        triangles = np.where(triangles < 0, len(vertices) - 1 - triangles, triangles)
        interior = _interior_points(tiles, field, isovalue, having[:3], having[3])
        vertices = np.concatenate([vertices, interior])
    return Mesh(vertices, triangles), cells


class _Tiles:
    """The tiles met so far, as flat tables that a whole slab can be looked up in at once.

    A key is signs + 256 * decisions.
    """

    def __init__(self, rule: Rule) -> None:
        self.rule = rule
        self.asks = np.array([rule.asks(signs) for signs in range(256)])
        self.known: dict[int, Tile] = {}
        size = 1 << (8 + rule.bits)
        self.count = np.zeros(size, np.int64)  # triangles of a tile
        self.start = np.zeros(size, np.int64)  # its first row in `nodes`
        self.interior = np.zeros(size, np.int64)  # its interior points
        self.nodes = np.empty((0, 3), np.int64)

    def learn(self, keys: Integers) -> None:
        """Make the tables hold the tile of every key that occurs."""
        occurring = np.flatnonzero(np.bincount(keys, minlength=len(self.count)))
        rows = [self.nodes]
        end = len(self.nodes)
        for key in (int(k) for k in occurring if int(k) not in self.known):
            tile = self.rule.tile(key & 255, key >> 8)
            self.known[key] = tile
            self.count[key], self.start[key] = len(tile.triangles), end
            self.interior[key] = len(tile.interior)
            end += len(tile.triangles)
            rows.append(np.array(tile.triangles, np.int64).reshape(-1, 3))
        self.nodes = np.concatenate(rows)


@dataclass(frozen=True)
class _Piece:
    """What one slab contributes: the vertices it owns, the triangles of its cells.

    having : (4, n) lattice indices and key of the cells that have interior points
    """

    vertices: Floats
    triangles: Integers
    cells: Integers
    having: Integers
    made_inside: int


@dataclass(frozen=True)
class _Volume:
    """The field as the slabs need it, and the arrays they use one after the other."""

    field: Field
    isovalue: float
    planes: int  # of cells in a slab, at most
    block: Booleans  # a slab's points, compared
    scratch: Booleans  # two more of the size of `block`
    vertex_of: NDArray[np.int32]  # lattice edge 3 * point + axis -> vertex of this slab

    @classmethod
    def of(cls, field: Field, isovalue: float) -> _Volume:
        """The volume, with room for slabs of about `SLAB_POINTS` points."""
        n1, n2, n3 = field.shape
        planes = min(n1 - 1, max(1, SLAB_POINTS // (n2 * n3)))
        points = (planes + 2) * (n2 + 1) * (n3 + 1)
        return cls(
            field,
            isovalue,
            planes,
            np.empty(points, np.bool_),
            np.empty((2, points), np.bool_),
            np.empty(3 * points, np.int32),
        )


class _Slab:
    """Some planes of the lattice with one plane of phantoms behind each upper border.

    first, planes : the planes of cells this slab turns into triangles
    shape : of the padded block of points, (planes + 2, N2 + 1, N3 + 1)
    samples : the slab's samples, flat, without padding
    inside : whether each point is inside, flat, padded by repeating the border
    """

    def __init__(self, volume: _Volume, first: int) -> None:
        n1, n2, n3 = volume.field.shape
        self.volume = volume
        self.first = first
        self.planes = min(volume.planes, n1 - 1 - first)
        self.shape = (self.planes + 2, n2 + 1, n3 + 1)
        self.is_last = first + self.planes == n1 - 1
        samples = volume.field.values[first : first + self.planes + 2]
        self.samples = np.ascontiguousarray(samples).reshape(-1)
        self.inside = volume.block[: self.shape[0] * self.shape[1] * self.shape[2]]
        self._compare(samples)

    def _compare(self, samples: Array) -> None:
        """Fill `inside`; repeat the last plane of each axis where none follows."""
        n, n2, n3 = samples.shape
        block = self.inside.reshape(self.shape)
        level = least_inside(samples.dtype, self.volume.isovalue)
        np.greater_equal(samples, level, out=block[:n, :n2, :n3])
        block[n:, :n2, :n3] = block[n - 1, :n2, :n3]
        block[:, n2] = block[:, n2 - 1]
        block[:, :, n3] = block[:, :, n3 - 1]

    def steps(self) -> Integers:
        """How far each corner of a cell is from its lower corner, in points."""
        _, b, c = self.shape
        return np.asarray(CORNER_OFFSETS @ np.array([b * c, c, 1]))

    def strides(self) -> Integers:
        """How far neighbours along each axis are apart in `samples`."""
        _, n2, n3 = self.volume.field.shape
        return np.array([n2 * n3, n3, 1])

    def active_cells(self) -> Integers:
        """The cells, phantoms included, that have corners on both sides, in order."""
        size = len(self.inside)
        some, every = self.inside, self.inside
        # Combine neighbours along the axes in turn, on the flat arrays, where a row's end meets
        # the next row's beginning: what comes out there is cleared at the end.
        for step in self.steps()[[1, 2, 4]]:
            size -= int(step)
            out = self.volume.scratch[:, :size]
            some = np.logical_or(some[:size], some[step : step + size], out=out[0])
            every = np.logical_and(every[:size], every[step : step + size], out=out[1])
        mixed = np.not_equal(some, every, out=some)
        active = self.volume.scratch[0, : len(self.inside)]
        active[len(mixed) :] = False
        active = active.reshape(self.shape)
        active[-1] = active[:, -1] = active[:, :, -1] = False
        return np.flatnonzero(active)

    def index(self, points: Integers) -> Integers:
        """Lattice indices (3, n) of points."""
        plane, rest = np.divmod(points, self.shape[1] * self.shape[2])
        row, column = np.divmod(rest, self.shape[2])
        return np.stack([plane + self.first, row, column])

    def values(self, index: Integers, step: Integers | int = 0) -> Floats:
        """Samples minus the isovalue at lattice indices (3, n), or `step` samples behind them."""
        plane, row, column = self.strides()
        flat = (index[0] - self.first) * plane + index[1] * row + index[2] * column + step
        samples: Floats = self.samples.take(flat).astype(np.float64)
        return samples - self.volume.isovalue

    def corner_values(self, index: Integers) -> Floats:
        """G (8, n), the relative values at the corners of n cells with indices (3, n)."""
        return np.stack([self.values(index, s) for s in CORNER_OFFSETS @ self.strides()])


def _pieces(tiles: _Tiles, field: Field, isovalue: float) -> Iterator[_Piece]:
    """One piece a slab; vertices are numbered through, interior points count down from -1."""
    volume = _Volume.of(field, isovalue)
    made = made_inside = 0
    for first in range(0, field.shape[0] - 1, volume.planes):
        piece = _piece(tiles, _Slab(volume, first), made, made_inside)
        made += len(piece.vertices)
        made_inside += piece.made_inside
        yield piece


def _piece(tiles: _Tiles, slab: _Slab, made: int, made_inside: int) -> _Piece:
    """What this slab adds to `made` vertices and `made_inside` interior points."""
    cells = slab.active_cells()
    index = slab.index(cells)
    signs = np.zeros(len(cells), np.uint8)
    for c, step in enumerate(slab.steps()):
        signs |= slab.inside.view(np.uint8).take(cells + step) << c

    # Number the crossings of the three lower edges of each cell, and remember them by edge.
    crossed = np.stack([signs ^ signs >> (1 << a) for a in range(3)], axis=1) & 1
    row, axis = np.divmod(np.flatnonzero(crossed.view(np.bool_)), 3)
    slab.volume.vertex_of[3 * cells[row] + axis] = np.arange(len(row), dtype=np.int32)
    # Leave the edges that start in the next slab's first plane to that slab.
    bound = np.array(slab.volume.field.shape) - 1
    bound[0] = slab.first + slab.planes
    own = len(row) if slab.is_last else int(np.searchsorted(index[0][row], bound[0]))
    vertices = _crossing_points(slab, index, row[:own], axis[:own])

    # Leave the phantoms out: they own vertices, but have no surface.
    real = np.flatnonzero((index < bound[:, None]).all(axis=0))
    cells, index = cells[real], index[:, real]
    keys = _keys(tiles, slab, index, signs[real].astype(np.int64))
    tiles.learn(keys)
    triangles, owner = _gather(tiles, slab, cells, keys, made, made_inside)
    flat = np.ravel_multi_index(tuple(index), tuple(n - 1 for n in slab.volume.field.shape))
    own_points = tiles.interior[keys]
    having = np.vstack([index, keys])[:, own_points > 0]
    return _Piece(vertices, triangles, flat[owner], having, int(own_points.sum()))


def _crossing_points(slab: _Slab, index: Integers, row: Integers, axis: Integers) -> Floats:
    """Positions (n, 3) of the crossings of each lattice edge from index[:, row] along its axis."""
    field = slab.volume.field
    low = index[:, row]
    t = crossing_parameter(slab.values(low), slab.values(low, slab.strides()[axis]))
    points = np.empty((len(row), 3))
    for a in range(3):
        place = low[a] + np.where(axis == a, t, 0.0)
        points[:, a] = place * field.spacing[a] + field.origin[a]
    return points


def _keys(tiles: _Tiles, slab: _Slab, index: Integers, signs: Integers) -> Integers:
    """The key of each cell, its decisions taken only where the rule asks."""
    asked = np.flatnonzero(tiles.asks[signs])
    keys = signs.copy()
    if tiles.rule.bits and len(asked):
        keys[asked] |= tiles.rule.decisions(slab.corner_values(index[:, asked])) << 8
    return keys


def _gather(
    tiles: _Tiles, slab: _Slab, cells: Integers, keys: Integers, made: int, made_inside: int
) -> tuple[Integers, Integers]:
    """The triangles (T, 3) of all cells in order, and for each the number of its cell."""
    count = tiles.count[keys]
    owner = np.repeat(np.arange(len(cells)), count)
    tile_row = (tiles.start[keys] - np.cumsum(count) + count)[owner] + np.arange(len(owner))
    # Look up the crossing at each node: edge e of a cell is the lower edge of another.
    edge_step = 3 * slab.steps()[EDGE_CORNERS[:, 0]] + np.arange(12) // 4
    step = np.append(edge_step, 0)[np.minimum(tiles.nodes, 12)]
    base = 3 * cells[owner]
    triangles = np.empty((len(owner), 3), np.int64)
    for k in range(3):
        edge = base + step[:, k].take(tile_row)
        np.add(slab.volume.vertex_of.take(edge), made, out=triangles[:, k])
    if tiles.interior[keys].any():
        nodes = tiles.nodes[tile_row]
        first = made_inside + np.cumsum(tiles.interior[keys]) - tiles.interior[keys]
        inner = -1 - (first[owner][:, None] + nodes - 12)
        triangles = np.where(nodes < 12, triangles, inner)
    return triangles, owner


def _interior_points(
    tiles: _Tiles, field: Field, isovalue: float, index: Integers, keys: Integers
) -> Floats:
    """Positions of the interior points of the cells with these indices (3, n), cell by cell."""
    own = tiles.interior[keys]
    first = np.cumsum(own) - own
    points = np.empty((int(own.sum()), 3))
    # Take the cells of one key together: they share their placements.
    order = np.argsort(keys, kind="stable")
    for rows in np.split(order, np.flatnonzero(np.diff(keys[order])) + 1):
        low = index[:, rows]
        corners = (low[:, None] + CORNER_OFFSETS.T[:, :, None]).reshape(3, -1)
        g = field.values[tuple(corners)].astype(np.float64).reshape(8, -1) - isovalue
        crossings = cell_crossings(g)
        for k, place in enumerate(tiles.known[int(keys[rows[0]])].interior):
            points[first[rows] + k] = field.position(low.T + place(g, crossings))
    return points
