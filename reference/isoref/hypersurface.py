r"""STEVE: the freeze-out hypersurface round a fireball in 3+1 dimensions, with its normals.

A fireball without symmetry needs time and all three directions of space. Its freeze-out
hypersurface is the isosurface of the temperature on a lattice of four axes, of dimension three, and
what is asked of it are its elements: a place, and a normal as long as the element is large. STEVE,
the four-dimensional counterpart of VESTA, goes from cell to cell and builds from the bottom up, as
`isoref.cornelius` does in another way::

    edge        a point       by linear interpolation
    square      segments      two points, or four: the mean of the corners says how they are joined
    cube        polygons      segments joined end to end: the cycles of `isoref.marching_vesta`
    4-cell      polyhedra     polygons of its eight cubes joined side to side

A polyhedron is filled from the average of its points. So its normal is a sum over its polygons, and
does not depend on how they are cut.

Glossary
--------
corner c    of a 4-cell: bit i is its coordinate along axis i, 0 .. 15
edge        of a 4-cell: two corners that differ in one bit
cube        of a 4-cell: an axis and a side, eight of them; its own axes are the three others
polygon     a cycle of edges in a cube, the inside on the left of its outer side
dsigma      normal of one tetrahedron: two neighbouring points of a polygon, the average of the
            polygon, the average of the polyhedron
dSigma      normal of one polyhedron, the sum of its dsigma
mode        what an ambiguous square does: ``mixed`` asks the mean of its four samples, as
            CORNELIUS does; ``disconnect`` and ``connect`` are the global modes of VESTA and STEVE

Invariants
----------
Every side of a polygon is a side of one other polygon of the cell, which runs the other way, and
every polygon off the border is one of the neighbouring cell, turned over. Hence over a closed
hypersurface the dSigma sum to zero, and the flux of x / 4 by the dsigma at the middles of their
tetrahedra is the enclosed volume, both up to rounding.

References
----------
1. B. R. Schlei, "Hyper-surface extraction in four dimensions" (STEVE), arXiv 1302.5683, 2013. The
   text was not at hand; section IV of "Volume-Enclosing Surface Extraction" names it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Literal, get_args

import numpy as np

from isoref.cube import EDGES
from isoref.diconex import check_choice
from isoref.field import Field, FieldError, Floats, Integers, check_isovalue, check_straight
from isoref.freeze_out import Elements
from isoref.kuhn import check_thickness, corner_offsets
from isoref.marching_vesta import cycles, decisions

Mode = Literal["mixed", "disconnect", "connect"]
Edge = tuple[int, int]
Polygon = tuple[Edge, ...]
AXES = 4


@dataclass(frozen=True, eq=False)
class Hypersurface:
    """The elements of a hypersurface, coarse and fine.

    Attributes
    ----------
    polyhedra : the dSigma, each at the average of its polyhedron's points
    tetrahedra : the dsigma, each at the middle of its tetrahedron
    owners : (T,) the polyhedron of each tetrahedron
    """

    polyhedra: Elements
    tetrahedra: Elements
    owners: Integers


def hypersurface(temperature: Field, freeze_out: float, mode: Mode = "mixed") -> Hypersurface:
    """The elements of the hypersurface on which a field on four axes falls through a value.

    Normals point from high to low, out of the fireball. The hypersurface ends at the border of the
    lattice; pad the field with low samples to close it.

    Parameters
    ----------
    temperature : one component on a lattice of four axes, time among them
    freeze_out : T_f
    mode : of ambiguous squares

    Raises
    ------
    FieldError
        for another number of axes or components, or a lattice one sample thick
    ValueError
        for a mode that is none of the three

    >>> values = np.zeros((3, 3, 3, 3)); values[1, 1, 1, 1] = 1
    >>> found = hypersurface(Field.of(values), 0.5)
    >>> len(found.polyhedra.places), len(found.tetrahedra.places)
    (16, 192)
    """
    check_choice("mode", mode, get_args(Mode))
    if temperature.dimension != AXES or temperature.components != 1:
        raise FieldError(
            f"{temperature.components} components on {temperature.dimension} axes: a freeze-out "
            "hypersurface in 3+1 dimensions needs one temperature on four; two and three axes are "
            "isoref.diconex and isoref.freeze_out"
        )
    check_straight(temperature)
    check_thickness(temperature.shape)
    values = temperature.values.astype(np.float64) - check_isovalue(freeze_out)
    places: list[Floats] = []
    normals: list[Floats] = []
    owners: list[Integers] = []
    averages: list[Floats] = []
    for low in product(*(range(N - 1) for N in temperature.shape)):
        g = values[tuple((np.array(low) + corner_offsets(AXES)).T)]
        if (g >= 0).all() or (g < 0).all():
            continue
        for polyhedron in polyhedra(g, mode):
            tetrahedra = filled(polyhedron, g) + np.array(low)
            tetrahedra = tetrahedra * temperature.spacing + temperature.origin
            places.append(tetrahedra.mean(axis=1))
            normals.append(normals_of(tetrahedra))
            owners.append(np.full(len(tetrahedra), len(averages)))
            averages.append(tetrahedra[0, 3])
    if not averages:
        none = Elements(np.empty((0, AXES)), np.empty((0, AXES)))
        return Hypersurface(none, none, np.empty(0, np.int64))
    fine = Elements(np.concatenate(places), np.concatenate(normals))
    owner = np.concatenate(owners).astype(np.int64)
    summed = np.zeros((len(averages), AXES))
    np.add.at(summed, owner, fine.normals)
    return Hypersurface(Elements(np.array(averages), summed), fine, owner)


def polyhedra(g: Floats, mode: Mode) -> list[list[Polygon]]:
    """The polyhedra of a 4-cell with values g (16,) at its corners, as lists of polygons."""
    polygons = [polygon for axis, side in cubes() for polygon in polygons_of(g, axis, side, mode)]
    # Join polygons that share a side.
    at: dict[frozenset[Edge], int] = {}
    group = list(range(len(polygons)))

    def root(i: int) -> int:
        while group[i] != i:
            i = group[i]
        return i

    for i, polygon in enumerate(polygons):
        for side_ in sides_of(polygon):
            other = at.setdefault(frozenset(side_), i)
            group[root(i)] = root(other)
    found: dict[int, list[Polygon]] = {}
    for i, polygon in enumerate(polygons):
        found.setdefault(root(i), []).append(polygon)
    return list(found.values())


def cubes() -> Iterator[tuple[int, int]]:
    """The eight cubes of a 4-cell: axis and side."""
    return product(range(AXES), (0, 1))


def polygons_of(g: Floats, axis: int, side: int, mode: Mode) -> list[Polygon]:
    """The polygons in one cube of a 4-cell, turned so that all eight cubes agree."""
    corners = cube_corners(axis, side)
    own = g[list(corners)]
    signs = int(sum(1 << c for c in range(8) if own[c] >= 0))
    if signs in (0, 255):
        return []
    separated = {"disconnect": 0b111111, "connect": 0}.get(mode)
    if separated is None:
        separated = int(decisions(own[:, None])[0])
    # The boundary of a cell: neighbouring cubes induce opposite directions on a common square.
    forward = (axis + side) % 2 == 1
    found = []
    for cycle in cycles(signs, separated):
        polygon = tuple((corners[EDGES[e][0]], corners[EDGES[e][1]]) for e in cycle)
        found.append(polygon if forward else polygon[::-1])
    return found


@cache
def cube_corners(axis: int, side: int) -> tuple[int, ...]:
    """The corners of the 4-cell that are corners 0 .. 7 of this cube.

    >>> cube_corners(0, 1)
    (1, 3, 5, 7, 9, 11, 13, 15)
    """
    others = [a for a in range(AXES) if a != axis]
    return tuple(
        sum((c >> i & 1) << a for i, a in enumerate(others)) | side << axis for c in range(8)
    )


def sides_of(polygon: Polygon) -> list[tuple[Edge, Edge]]:
    """The directed sides of a polygon, from edge to edge."""
    return list(zip(polygon, polygon[1:] + polygon[:1], strict=True))


def filled(polyhedron: list[Polygon], g: Floats) -> Floats:
    """(T, 4, 4) tetrahedra in the cell: a, b, average of the polygon, average of all points."""
    points = {edge: crossing(edge, g) for polygon in polyhedron for edge in polygon}
    middle = np.mean([points[edge] for edge in sorted(points)], axis=0)
    rows = []
    for polygon in polyhedron:
        average = np.mean([points[edge] for edge in sorted(polygon)], axis=0)
        rows += [[points[a], points[b], average, middle] for a, b in sides_of(polygon)]
    return np.array(rows)


def crossing(edge: Edge, g: Floats) -> Floats:
    """(4,) where the value is 0 on an edge of the cell."""
    a, b = edge
    offsets = corner_offsets(AXES)
    t = g[a] / (g[a] - g[b])
    return np.asarray(offsets[a] + t * (offsets[b] - offsets[a]))


def normals_of(tetrahedra: Floats) -> Floats:
    """(T, 4) normals of tetrahedra (T, 4, 4), as long as their volume.

    The component along axis mu is the determinant of the three edges without it, with the sign
    (-1)^mu, over 6: orthogonal to the three edges.

    >>> corner = np.array([[[0, 0, 0, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.0]]])
    >>> bool(np.allclose(normals_of(corner), [[0, 0, 0, -1 / 6]]))
    True
    """
    edges = tetrahedra[:, 1:] - tetrahedra[:, :1]
    normals = np.empty((len(tetrahedra), AXES))
    for mu in range(AXES):
        others = [a for a in range(AXES) if a != mu]
        normals[:, mu] = (-1) ** mu * np.linalg.det(edges[:, :, others]) / 6
    return normals
