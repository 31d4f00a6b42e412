"""The sweep: a rule carried over a volume, cell by cell.

A rule (`isoref.rule`) says what one cell does. To make a surface of a volume, visit the cells one
after the other, read the eight samples at each cell's corners, and copy the triangles of its tile.
Two things remain to be said: where a vertex stands, and which vertices are one.

*Where.* The surface crosses a lattice edge whose ends lie on different sides. It does so where the
linear interpolant of the two samples takes the isovalue::

        low             0          high
         o--------------x-----------o         t = low / (low - high)
         0              t           1         low, high: samples minus the isovalue

*Which are one.* Up to four cells share a lattice edge, and each of them meets the crossing on it.
So a vertex is named by its lattice edge, and is made by the first cell that asks for the name.
Interior points belong to their cell alone.

`isoref.fast.sweep` is the vectorised twin: the same mesh, triangle by triangle, up to the numbers
of the vertices and the order of the triangles.

Glossary
--------
cell        named by the lattice index of its lowest corner
g           (8, 1) the samples at the cell's corners minus the isovalue
signs       eight bits, one a corner: whether its sample is inside (`isoref.cube`)
tile        the oriented triangles of a cell on its nodes (`isoref.rule`)
node        0 .. 11 the crossing on that edge of the cell; 12, 13, .. interior points

Invariants
----------
Triangles come in the order of their cells (C order). Two triangles share a vertex when they cross
the same lattice edge, and only then: vertices that happen to coincide stay apart.

References
----------
[1] Lorensen, Cline, "Marching cubes", SIGGRAPH 1987, section 4: the loop over the cells and the
    linear interpolation along their edges.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from isoref.cube import CORNER_OFFSETS, EDGE_CORNERS, axis_of
from isoref.field import (
    Field,
    FieldError,
    Floats,
    check_isovalue,
    check_straight,
    inside_samples,
)
from isoref.mesh import Mesh, Provenance, in_space
from isoref.rule import Rule

#: The least positive float.
LEAST = 5e-324

Cell = tuple[int, ...]
Name = tuple[int, ...]


@in_space
def sweep(rule: Rule, field: Field, isovalue: float, provenance: bool = False) -> Mesh:
    """The rule's surface of a volume, its normals from high values to low ones.

    Parameters
    ----------
    rule : what a cell does, as in `isoref.methods.RULES`
    field : one value a sample on a lattice (N1, N2, N3)
    isovalue : in the unit of the samples
    provenance : also say where vertices and triangles come from (`isoref.mesh.Provenance`)

    Returns
    -------
    Mesh
        of triangles; vertices (V, 3) in the unit of the field's spacing. Empty where no sample
        is inside or all are, or where the lattice is one sample thick.

    Raises
    ------
    FieldError
        for a field that is not a scalar volume, or an isovalue that is no finite number.

    >>> from isoref import lorensen_cline
    >>> corner = Field.of([[[1, 0], [0, 0]], [[0, 0], [0, 0]]])
    >>> sweep(lorensen_cline.RULE, corner, 0.5).vertices.tolist()
    [[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]]
    """
    check_volume(field)
    alpha = check_isovalue(isovalue)
    inside = inside_samples(field, alpha).reshape(field.shape)
    relative = field.values.reshape(field.shape).astype(np.float64) - alpha
    relative[(relative >= 0) & ~inside] = -LEAST  # whole numbers that a float rounds up to alpha
    vertices: list[Floats] = []
    number: dict[Name, int] = {}
    ends: list[tuple[int, int]] = []
    parameters: list[float] = []
    triangles: list[list[int]] = []
    cells: list[int] = []

    for k, cell in enumerate(np.ndindex(*(n - 1 for n in field.shape))):
        # Read the samples at the corners.
        corners = [tuple(cell + offset) for offset in CORNER_OFFSETS]
        g = np.array([[relative[corner]] for corner in corners])
        signs = sum(1 << c for c in range(8) if inside[corners[c]])

        # Decide what the signs leave open, and take the tile.
        decisions = int(rule.decisions(g)[0]) if rule.asks(signs) else 0
        tile = rule.tile(signs, decisions)

        # Place the cell's nodes, and number those that no earlier cell has met.
        crossings = cell_crossings(g)
        names: dict[int, Name] = {}
        for node in sorted({node for triangle in tile.triangles for node in triangle}):
            if node < 12:
                names[node], place = lattice_edge(cell, node), crossings[node, 0]
            else:
                names[node], place = (*cell, node), tile.interior[node - 12](g, crossings)[0]
            if names[node] not in number:
                number[names[node]] = len(vertices)
                vertices.append(field.position(cell + place))
                ends.append(ends_of(field, cell, node))
                parameters.append(place[axis_of(node)] if node < 12 else np.nan)

        # Copy the triangles.
        for triangle in tile.triangles:
            triangles.append([number[names[node]] for node in triangle])
            cells.append(k)

    mesh = Mesh.of(vertices, triangles) if triangles else Mesh.empty(3, 2)
    if not provenance:
        return mesh
    pairs = np.array(ends, np.int64).reshape(-1, 2)
    owners = np.array(cells, np.int64)
    return replace(mesh, provenance=Provenance(pairs, np.array(parameters), owners, field))


def ends_of(field: Field, cell: Cell, node: int) -> tuple[int, int]:
    """The flat indices of the samples between which a node of a cell lies, as in `Provenance`.

    >>> ends_of(Field.of(np.zeros((2, 2, 3))), (0, 0, 1), 4), ends_of(
    ...     Field.of(np.zeros((2, 2, 3))), (0, 0, 1), 12
    ... )
    ((1, 4), (1, -1))
    """
    if node >= 12:
        return int(np.ravel_multi_index(cell, field.shape)), -1
    low, high = (
        int(np.ravel_multi_index(tuple(cell + CORNER_OFFSETS[c]), field.shape))
        for c in EDGE_CORNERS[node]
    )
    return low, high


def lattice_edge(cell: Cell, e: int) -> Name:
    """The lattice edge that is edge e of the cell: the index of its lower end, and its axis.

    >>> lattice_edge((0, 0, 0), 3) == lattice_edge((0, 1, 1), 0)
    True
    """
    low = CORNER_OFFSETS[EDGE_CORNERS[e][0]]
    return (*(int(i) for i in cell + low), axis_of(e))


def cell_crossings(g: Floats) -> Floats:
    """Where the surface crosses each edge of n cells, (12, n, 3) from g (8, n).

    Coordinates are those of the cell, 0 to 1; an edge that is not crossed has NaN.

    >>> cell_crossings(np.array([[3.0], [-1], [-1], [-1], [-1], [-1], [-1], [-1]]))[0, 0].tolist()
    [0.75, 0.0, 0.0]
    """
    crossings = np.full((12, g.shape[1], 3), np.nan)
    inside = g >= 0
    for e, (a, b) in enumerate(EDGE_CORNERS):
        crossed = np.flatnonzero(inside[a] != inside[b])
        crossings[e, crossed] = CORNER_OFFSETS[a]
        crossings[e, crossed, axis_of(e)] = crossing_parameter(g[a, crossed], g[b, crossed])
    return crossings


def crossing_parameter(low: Floats, high: Floats) -> Floats:
    """Where on an edge the linear interpolant vanishes: t from 0 at the end `low` to 1 at `high`.

    Both are relative values (sample minus isovalue) of different signs, in arrays of one shape.

    >>> crossing_parameter(np.array([-1.5e308]), np.array([1.5e308]))
    array([0.5])

    Raises
    ------
    FieldError
        where a relative value itself is beyond what a float holds.
    """
    with np.errstate(over="ignore"):
        gap = np.asarray(low - high)
    if np.isfinite(gap).all():
        if gap.all():
            return np.asarray(low / gap)
        # Two samples that a float cannot tell apart are crossed at the lower one.
        return np.divide(low, gap, out=np.zeros_like(gap), where=gap != 0)
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        raise FieldError(
            "a sample differs from the isovalue by more than a float holds: scale both"
        )
    # Halve what would overflow, and nothing else: the smallest floats have no half.
    half = np.where(np.isfinite(gap), 1.0, 0.5)
    return np.asarray(low * half / (low * half - high * half))


def check_volume(field: Field) -> None:
    """Raise FieldError unless the field has one value a sample on a 3-D lattice."""
    if field.dimension != 3 or field.components != 1:
        raise FieldError(
            f"a sweep needs one value a sample on a 3-D lattice, not {field.components} on a "
            f"{field.dimension}-D one"
        )
    check_straight(field)
