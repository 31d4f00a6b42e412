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
from dataclasses import field as fresh
from typing import Any

import numpy as np

from isoref.cube import CORNER_OFFSETS, EDGE_CORNERS, axis_of
from isoref.field import Booleans, Field, FieldError, Floats, Integers, check_isovalue
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
    interior = [piece.interior for piece in pieces if len(piece.interior)]
    if interior:
        # Number the interior points behind the crossings: so far they count down from -1.
        triangles = np.where(triangles < 0, len(vertices) - 1 - triangles, triangles)
        vertices = np.concatenate([vertices, *interior])
    return Mesh(vertices, triangles), cells


class _Tiles:
    """The tiles met so far, as flat tables that a whole slab can be looked up in at once."""

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
        """Make the tables hold the tile of every key, signs + 256 * decisions, that occurs."""
        occurring = np.flatnonzero(np.bincount(keys, minlength=len(self.count)))
        new = [int(key) for key in occurring if int(key) not in self.known]
        rows = [self.nodes]
        end = len(self.nodes)
        for key in new:
            tile = self.rule.tile(key & 255, key >> 8)
            self.known[key] = tile
            self.count[key], self.start[key] = len(tile.triangles), end
            self.interior[key] = len(tile.interior)
            end += len(tile.triangles)
            rows.append(np.array(tile.triangles, np.int64).reshape(-1, 3))
        self.nodes = np.concatenate(rows)


@dataclass(frozen=True)
class _Piece:
    """What one slab contributes: the vertices it owns, the triangles of its cells."""

    vertices: Floats
    triangles: Integers
    cells: Integers
    interior: Floats


@dataclass
class _Slab:
    """Some planes of the lattice with one plane of phantoms behind each upper border.

    first, planes : the planes of cells this slab turns into triangles
    shape : of the padded block of points, (planes + 2, N2 + 1, N3 + 1)
    inside : its flat mask
    """

    field: Field
    isovalue: float
    first: int
    planes: int
    shape: tuple[int, int, int] = fresh(init=False)
    inside: Booleans = fresh(init=False)

    def __post_init__(self) -> None:
        """Compare the samples; repeat the last plane of each axis where none follows."""
        _, n2, n3 = self.field.shape
        self.shape = (self.planes + 2, n2 + 1, n3 + 1)
        block = np.empty(self.shape, np.bool_)
        samples = self.field.values[self.first : self.first + self.planes + 2]
        level = least_inside(samples.dtype, self.isovalue)
        np.greater_equal(samples, level, out=block[: len(samples), :n2, :n3])
        block[len(samples) :, :n2, :n3] = block[len(samples) - 1, :n2, :n3]
        block[:, n2] = block[:, n2 - 1]
        block[:, :, n3] = block[:, :, n3 - 1]
        self.inside = block.reshape(-1)

    def active_cells(self) -> Integers:
        """The cells, phantoms included, that have corners on both sides, in order."""
        block = self.inside.reshape(self.shape)
        some = block[:, :, :-1] | block[:, :, 1:]
        every = block[:, :, :-1] & block[:, :, 1:]
        some = some[:, :-1] | some[:, 1:]
        every = every[:, :-1] & every[:, 1:]
        active = np.zeros(self.shape, np.bool_)
        mixed = active[:-1, :-1, :-1]
        np.logical_or(some[:-1], some[1:], out=mixed)
        mixed ^= every[:-1] & every[1:]
        return np.flatnonzero(active)

    def steps(self) -> Integers:
        """How far each corner of a cell is from its lower corner, in points."""
        _, b, c = self.shape
        return np.asarray(CORNER_OFFSETS @ np.array([b * c, c, 1]))

    def index(self, points: Integers) -> Integers:
        """Lattice indices (n, 3) of points."""
        plane, rest = np.divmod(points, self.shape[1] * self.shape[2])
        row, column = np.divmod(rest, self.shape[2])
        return np.stack([plane + self.first, row, column], axis=1)

    def values(self, index: Integers) -> Floats:
        """Samples minus the isovalue at lattice indices (n, 3)."""
        samples = self.field.values[index[:, 0], index[:, 1], index[:, 2]]
        return samples.astype(np.float64) - self.isovalue


def _slabs(field: Field, isovalue: float) -> Iterator[_Slab]:
    """The volume, cut into slabs of about `SLAB_POINTS` points."""
    n1, n2, n3 = field.shape
    planes = max(1, SLAB_POINTS // (n2 * n3))
    for first in range(0, n1 - 1, planes):
        yield _Slab(field, isovalue, first, min(planes, n1 - 1 - first))


def _pieces(tiles: _Tiles, field: Field, isovalue: float) -> Iterator[_Piece]:
    """One piece a slab; vertices are numbered through, interior points count down from -1."""
    made = made_inside = 0
    for slab in _slabs(field, isovalue):
        last = slab.first + slab.planes == field.shape[0] - 1
        piece = _piece(tiles, slab, made, made_inside, last)
        made += len(piece.vertices)
        made_inside += len(piece.interior)
        yield piece


def _piece(tiles: _Tiles, slab: _Slab, made: int, made_inside: int, last: bool) -> _Piece:
    """What this slab adds to `made` vertices and `made_inside` interior points."""
    cells = slab.active_cells()
    signs = np.zeros(len(cells), np.int64)
    for c, step in enumerate(slab.steps()):
        signs |= slab.inside[cells + step].astype(np.int64) << c

    # Number the crossings of the three lower edges of each cell, and remember them by edge.
    low = np.stack([signs ^ signs >> (1 << a) for a in range(3)], axis=1) & 1
    owned_edges = (3 * cells[:, None] + np.arange(3))[low == 1]
    vertex_of = np.empty(3 * len(slab.inside), np.int64)
    vertex_of[owned_edges] = np.arange(made, made + len(owned_edges))
    # Leave the edges that start in the next slab's first plane to that slab.
    plane_points = slab.shape[1] * slab.shape[2]
    end = (slab.planes + last) * plane_points
    vertices = _crossing_points(slab, owned_edges[: np.searchsorted(owned_edges, 3 * end)])

    real = _real_cells(slab, cells)
    cells, keys = cells[real], _keys(tiles, slab, cells[real], signs[real])
    tiles.learn(keys)
    triangles, owner = _gather(tiles, slab, cells, keys, vertex_of, made_inside)
    flat = np.ravel_multi_index(slab.index(cells).T, [n - 1 for n in slab.field.shape])
    interior = _interior_points(tiles, slab, cells, keys)
    return _Piece(vertices, triangles, np.asarray(flat)[owner], interior)


def _crossing_points(slab: _Slab, edges: Integers) -> Floats:
    """Positions (n, 3) of the crossings of lattice edges, 3 * point + axis."""
    points, axes = np.divmod(edges, 3)
    low = slab.index(points)
    high = low.copy()
    rows = np.arange(len(edges))
    high[rows, axes] += 1
    place = low.astype(np.float64)
    place[rows, axes] += crossing_parameter(slab.values(low), slab.values(high))
    return slab.field.position(place)


def _real_cells(slab: _Slab, cells: Integers) -> Booleans:
    """Which of the cells are no phantoms and belong to this slab."""
    index = slab.index(cells)
    bound = (slab.first + slab.planes, slab.field.shape[1] - 1, slab.field.shape[2] - 1)
    return np.asarray((index < np.array(bound)).all(axis=1))


def _corner_values(slab: _Slab, cells: Integers) -> Floats:
    """G (8, n), the relative values at the corners of n cells."""
    index = slab.index(cells)
    return np.stack([slab.values(index + offset) for offset in CORNER_OFFSETS])


def _keys(tiles: _Tiles, slab: _Slab, cells: Integers, signs: Integers) -> Integers:
    """Signs + 256 * decisions for each cell, the decisions taken only where the rule asks."""
    asked = np.flatnonzero(tiles.asks[signs])
    keys = signs.copy()
    if tiles.rule.bits and len(asked):
        keys[asked] |= tiles.rule.decisions(_corner_values(slab, cells[asked])) << 8
    return keys


def _gather(
    tiles: _Tiles,
    slab: _Slab,
    cells: Integers,
    keys: Integers,
    vertex_of: Integers,
    made_inside: int,
) -> tuple[Integers, Integers]:
    """The triangles (T, 3) of all cells in order, and for each the number of its cell."""
    count = tiles.count[keys]
    owner = np.repeat(np.arange(len(cells)), count)
    behind = np.cumsum(count) - count
    nodes = tiles.nodes[(tiles.start[keys] - behind)[owner] + np.arange(len(owner))]
    # Look up the crossing at each node: edge e of a cell is the lower edge of another.
    edge_step = 3 * slab.steps()[EDGE_CORNERS[:, 0]] + np.arange(12) // 4
    on_edge = nodes < 12
    step = np.append(edge_step, 0)[np.minimum(nodes, 12)]
    triangles = vertex_of[np.where(on_edge, 3 * cells[owner][:, None] + step, 0)]
    if not on_edge.all():
        own = tiles.interior[keys]
        first = made_inside + np.cumsum(own) - own
        triangles = np.where(on_edge, triangles, -1 - (first[owner][:, None] + nodes - 12))
    return triangles, owner


def _interior_points(tiles: _Tiles, slab: _Slab, cells: Integers, keys: Integers) -> Floats:
    """Positions of the interior points of all cells, cell by cell."""
    own = tiles.interior[keys]
    first = np.cumsum(own) - own
    points = np.empty((int(own.sum()), 3))
    having = np.flatnonzero(own)
    for key in np.flatnonzero(np.bincount(keys[having], minlength=1)):
        rows = having[keys[having] == key]
        g = _corner_values(slab, cells[rows])
        crossings = cell_crossings(g)
        low = slab.index(cells[rows])
        for k, place in enumerate(tiles.known[int(key)].interior):
            points[first[rows] + k] = slab.field.position(low + place(g, crossings))
    return points
