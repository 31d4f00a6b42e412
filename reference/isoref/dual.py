r"""Dual surfaces: a vertex in each cell that is crossed, a quadrilateral across each crossed edge.

Marching cubes puts its vertices on the edges of the lattice and its polygons into the cells. A
dual method exchanges the two. Each crossed lattice edge gets a polygon, and since four cells meet
in an edge the polygon has four corners, one in each of them::

          |         |
       ---+---------+---          seen along a lattice edge, which is the + in the middle:
          |  *---*  |             four cells, a vertex * in each, and the quadrilateral
       ---+--|-+-|--+---          across the edge
          |  *---*  |
       ---+---------+---

That leaves one thing to be said, and it is what sets the methods apart: how many vertices a cell
has, and which of them its crossings belong to. A `DualRule` says it. One vertex for all crossings
of a cell makes surface nets (`isoref.surface_nets`); one for each polygon that marching cubes
would draw makes dual marching cubes (`isoref.dual_marching_cubes`). The vertex stands at the mean
of its crossings, and so in its cell.

`isoref.fast.dual` is the vectorised twin.

Glossary
--------
cell        named by the lattice index of its lowest corner
signs       eight bits, one a corner: whether its sample is inside (`isoref.cube`)
crossing    the point where the linear interpolant of a crossed lattice edge takes the isovalue
patch       the crossings of one cell that share a vertex
border      six bits: bit f is set where face f of the cell lies in the border of the lattice
inner       of a crossed edge: four cells meet in it, so it has a quadrilateral
turned      of a cell: the rule draws its other surface, because of a neighbour

Invariants
----------
Vertices are numbered by their cells (C order) and patches, quadrilaterals by the axis of their
edge and its lower end. Each quadrilateral begins in the cell above its edge's lower end, which is
the highest of its four, and goes round so that its normal points from high to low. Triangles are
cut along the diagonal from there to the lowest cell. The surface ends in the border layer of
cells, half a cell inside the lattice where the field is smooth.

References
----------
[1] G. M. Nielson, "Dual marching cubes", IEEE Visualization 2004, section 2.
[2] S. F. F. Gibson, "Constrained elastic surface nets", MICCAI 1998, section 2.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import NamedTuple

import numpy as np

from isoref.cube import CORNER_OFFSETS, EDGE_OF, FACE_EDGES, corner_at, crossed_edges
from isoref.cycles import Polygon
from isoref.field import Booleans, Field, Floats, Integers, check_isovalue, inside_samples
from isoref.mesh import Mesh, Provenance, in_space
from isoref.sweep import cell_crossings, check_volume

Cell = tuple[int, int, int]


class Patch(NamedTuple):
    """One vertex of a cell.

    crossings : the crossed edges whose mean point it stands at; no two patches share one
    quads : the inner ones of them, across which it is a corner of the quadrilateral
    """

    crossings: Polygon
    quads: Polygon


@dataclass(frozen=True)
class DualRule:
    """A dual method.

    name : as the catalogue knows it
    patches : signs, turned, border -> the vertices of a cell; none without a quadrilateral
    turns_at : signs -> the face beyond which a cell that also turns there turns both, or None
    """

    name: str
    patches: Callable[[int, bool, int], tuple[Patch, ...]]
    turns_at: Callable[[int], int | None]


def inner_edges(signs: int, border: int) -> frozenset[int]:
    """The crossed edges of a cell that have a quadrilateral.

    >>> sorted(inner_edges(0b00000001, border=0)), sorted(inner_edges(0b00000001, border=0b000001))
    ([0, 4, 8], [0])
    """
    outer = {e for f in range(6) if border >> f & 1 for e in FACE_EDGES[f]}
    return frozenset(crossed_edges(signs)) - outer


@in_space
def surface(rule: DualRule, field: Field, isovalue: float, provenance: bool = False) -> Mesh:
    """The rule's surface of a volume, in triangles, its normals from high values to low ones.

    Parameters
    ----------
    rule : `isoref.surface_nets.RULE` or `isoref.dual_marching_cubes.RULE`
    field : one value a sample on a lattice (N1, N2, N3)
    isovalue : in the unit of the samples
    provenance : also say of each vertex in which cell it is (`isoref.mesh.Provenance`)

    Raises
    ------
    FieldError
        for a field that is not a scalar volume, or an isovalue that is no finite number.
    """
    vertices, rows, cells = drawn(rule, field, isovalue)
    mesh = in_triangles(vertices, rows)
    return replace(mesh, provenance=provenance_of(cells, mesh, field)) if provenance else mesh


def provenance_of(cells: Integers, mesh: Mesh, field: Field) -> Provenance:
    """That of a mesh whose vertices are in the cells with these lowest samples, (V,)."""
    ends = np.stack([cells, np.full(len(cells), -1)], axis=1)
    return Provenance(ends, np.full(len(cells), np.nan), np.full(len(mesh.simplices), -1), field)


def quads(rule: DualRule, field: Field, isovalue: float) -> tuple[Floats, Integers]:
    """The rule's surface in quadrilaterals: vertices (V, 3) and rows of four of them (Q, 4).

    Parameters and errors are those of `surface`.

    >>> from isoref import surface_nets
    >>> samples = np.zeros((3, 3, 3)); samples[1, 1, 1] = 1
    >>> vertices, rows = quads(surface_nets.RULE, Field.of(samples), 0.5)
    >>> len(vertices), len(rows)
    (8, 6)
    """
    return drawn(rule, field, isovalue)[:2]


def drawn(rule: DualRule, field: Field, isovalue: float) -> tuple[Floats, Integers, Integers]:
    """Vertices (V, 3) and quadrilaterals (Q, 4), and the lowest sample of each vertex's cell (V,).

    Parameters and errors are those of `surface`.
    """
    check_volume(field)
    alpha = check_isovalue(isovalue)
    inside = inside_samples(field, alpha)
    relative = field.values.astype(np.float64) - alpha
    places: list[Floats] = []
    cells: list[int] = []
    corner: dict[tuple[Cell, int], int] = {}

    # Make the vertices of each cell, and note across which of its edges each is a corner.
    for cell in _cells(field.shape):
        patches = rule.patches(
            signs_of(inside, cell), is_turned(rule, inside, cell), border_of(field.shape, cell)
        )
        g = np.array([[relative[tuple(cell + offset)]] for offset in CORNER_OFFSETS])
        for patch in patches:
            corner |= {(cell, e): len(places) for e in patch.quads}
            inner = cell_crossings(g)[list(patch.crossings), 0].mean(axis=0)
            places.append(field.position(cell + inner))
            cells.append(int(np.ravel_multi_index(cell, field.shape)))

    # Join the four vertices round each crossed lattice edge that is no edge of the border.
    rows = []
    for axis in range(3):
        for low in np.ndindex(inside.shape):
            round_it = cells_round(axis, low)
            if all((cell, e) in corner for cell, e in round_it):
                row = [corner[cell, e] for cell, e in round_it]
                rows.append(row if inside[low] else [row[0], *row[:0:-1]])
    vertices = np.array(places).reshape(-1, 3)
    return vertices, np.array(rows, np.int64).reshape(-1, 4), np.array(cells, np.int64)


def _cells(shape: tuple[int, ...]) -> Iterator[Cell]:
    """All cells of the lattice, in C order."""
    yield from product(*(range(n - 1) for n in shape))


def signs_of(inside: Booleans, cell: Cell) -> int:
    """The signs of a cell."""
    return sum(1 << c for c, offset in enumerate(CORNER_OFFSETS) if inside[tuple(cell + offset)])


def border_of(shape: tuple[int, ...], cell: Cell) -> int:
    """The faces of a cell that lie in the border of the lattice, as bits.

    >>> bin(border_of((3, 3, 2), (0, 1, 0)))
    '0b111001'
    """
    ends = [(cell[a] == 0, cell[a] == shape[a] - 2) for a in range(3)]
    return sum(1 << 2 * a + s for a in range(3) for s in (0, 1) if ends[a][s])


def is_turned(rule: DualRule, inside: Booleans, cell: Cell) -> bool:
    """Whether the cell and its neighbour both turn at the face they share."""
    f = rule.turns_at(signs_of(inside, cell))
    if f is None or border_of(inside.shape, cell) >> f & 1:
        return False
    return rule.turns_at(signs_of(inside, beyond(cell, f))) == f ^ 1


def beyond(cell: Cell, f: int) -> Cell:
    """The cell on the other side of face f.

    >>> beyond((1, 1, 1), 4)
    (1, 1, 0)
    """
    axis, side = divmod(f, 2)
    i, j, k = (x + (2 * side - 1) * (a == axis) for a, x in enumerate(cell))
    return i, j, k


def cells_round(axis: int, low: tuple[int, ...]) -> list[tuple[Cell, int]]:
    """The four cells round a lattice edge, and what number the edge has in each.

    Counterclockwise for someone towards whom the axis points, from the highest cell on.

    >>> cells_round(2, (1, 1, 0))
    [((1, 1, 0), 8), ((0, 1, 0), 9), ((0, 0, 0), 11), ((1, 0, 0), 10)]
    """
    found = []
    for step, e in ROUND[axis]:
        i, j, k = (x - s for x, s in zip(low, step, strict=True))
        found.append(((i, j, k), e))
    return found


def _round(axis: int) -> tuple[tuple[Cell, int], ...]:
    """For each cell round an edge of this axis: from it to the edge's lower end, and its number."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    found = []
    for along in ((), (u,), (u, v), (v,)):
        i, j, k = (int(a in along) for a in range(3))
        c = corner_at(i, j, k)
        found.append(((i, j, k), EDGE_OF[frozenset((c, c | 1 << axis))]))
    return tuple(found)


ROUND = tuple(_round(axis) for axis in range(3))


def in_triangles(vertices: Floats, rows: Integers) -> Mesh:
    """The mesh of quadrilaterals, each cut along the diagonal from its first corner.

    >>> in_triangles(np.zeros((4, 3)), np.array([[0, 1, 2, 3]])).simplices.tolist()
    [[0, 1, 2], [0, 2, 3]]
    """
    return Mesh.of(vertices, rows[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3))
