r"""CORNELIUS: a freeze-out surface in two to four dimensions, element by element, without tables.

The freeze-out surface of a simulation is cut into elements, each with a place and a normal, from
the bottom up, and in any number of dimensions by the same steps::

    square      lines         between the crossings of its edges: two where corners alternate
    cube        polygons      the lines of its six squares, joined where they end
    4-cell      polyhedra     the polygons of its eight cubes, joined where they share a line

Every line remembers a point on its cold side. With it, each piece of an element's normal is turned
outwards by itself, and no order of corners has to be kept. That is what tells this method from
`isoref.hypersurface` (STEVE), where the direction comes from the way the lines run; and where
STEVE's element stands at the average of its points, this one stands at its centre of mass.

Glossary
--------
corner      of a cell: its bits are its coordinates, last axis last, as a tuple of 0 and 1
edge        two corners that differ in one bit; a point of the surface is named by its edge
line        two edges of one square, and a point on their cold side
mean        of an element's points; its pieces are filled from there
centroid    the mean of the pieces' middles, by their size: where the element stands
dSigma      the element's normal: the sum of its pieces', filled from the centroid, all outwards

Invariants
----------
A crossing on an edge of a cube ends two of its lines, and a line on a square of a 4-cell belongs to
two of its polygons, so all that is joined is closed, and neighbouring cells fill a polygon they
share from one and the same middle. Over a closed surface the dSigma sum to zero and the flux of
x / n is the enclosed volume, up to rounding, as long as no piece's outside point turns it the wrong
way. That is not proved here; in noise of three and four dimensions no such piece was found.

References
----------
1. P. Huovinen, H. Petersen, "Particlization in hybrid models", Eur. Phys. J. A 48, 171, 2012,
   arXiv 1206.3371. Written from what the programs that use it say of it: the mean of a square's
   corners, centroids by size, pieces turned outwards. The text was not at hand.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, product
from math import factorial
from typing import NamedTuple

import numpy as np

from isoref.field import Field, FieldError, Floats, check_isovalue, check_straight
from isoref.freeze_out import Elements
from isoref.kuhn import check_thickness

Corner = tuple[int, ...]
Edge = tuple[Corner, Corner]
AXES = (2, 3, 4)


class Line(NamedTuple):
    """The part of the surface in a square: its ends, and a point on its cold side."""

    ends: frozenset[Edge]
    outside: tuple[float, ...]


Polygon = tuple[Line, ...]


def cornelius(temperature: Field, freeze_out: float) -> Elements:
    """The elements of the surface on which a temperature on 2, 3 or 4 axes falls through a value.

    Normals point from high to low, out of the fireball, and are as long as the element is large.
    The surface ends at the border of the lattice; pad the field with cold samples to close it.

    Parameters
    ----------
    temperature : one component on two, three or four axes
    freeze_out : T_f

    Raises
    ------
    FieldError
        for another number of axes or components, or a lattice one sample thick

    >>> values = np.zeros((3, 3, 3, 3)); values[1, 1, 1, 1] = 1
    >>> found = cornelius(Field.of(values), 0.5)
    >>> found.places.shape, bool(np.allclose(found.normals.sum(axis=0), 0))
    ((16, 4), True)
    """
    n = temperature.dimension
    if n not in AXES or temperature.components != 1:
        raise FieldError(
            f"{temperature.components} components on {n} axes: CORNELIUS needs one temperature on "
            "two, three or four"
        )
    check_straight(temperature)
    check_thickness(temperature.shape)
    values = temperature.values.astype(np.float64) - check_isovalue(freeze_out)
    spacing, places, normals = np.array(temperature.spacing), [np.empty((0, n))], [np.empty((0, n))]
    for low in product(*(range(N - 1) for N in temperature.shape)):
        g = values[tuple(slice(i, i + 2) for i in low)]
        if (g >= 0).all() or (g < 0).all():
            continue
        for place, normal in elements(g, spacing):
            places.append((temperature.origin + np.array(low) * spacing + place)[None])
            normals.append(normal[None])
    return Elements(np.concatenate(places), np.concatenate(normals))


def elements(g: Floats, spacing: Floats) -> Iterator[tuple[Floats, Floats]]:
    """Places from the first corner, and normals, of the elements of a cell with values g."""
    n = g.ndim
    faces = squares(n)
    if n == 2:
        pieces = [[line] for line in lines(g, faces[0])]
    elif n == 3:
        pieces = [list(polygon) for polygon in joined([x for s in faces for x in lines(g, s)])]
    else:
        polygons = [
            polygon
            for axis, side in product(range(n), (0, 1))
            for polygon in joined([x for s in faces if in_cube(s, axis, side) for x in lines(g, s)])
        ]
        for polyhedron in polyhedra(polygons):
            yield element([(p, polygon_centre(p, g, spacing)) for p in polyhedron], g, spacing)
        return
    for piece in pieces:
        yield element([(tuple(piece), None)], g, spacing)


# --- squares, cubes, 4-cells ----------------------------------------------------------------------


def squares(n: int) -> list[tuple[Corner, ...]]:
    """The squares of a cell of n axes, each as its four corners in a walk around it.

    >>> [len(squares(n)) for n in (2, 3, 4)]
    [1, 6, 24]
    """
    found = []
    for a, b in combinations(range(n), 2):
        for rest in product((0, 1), repeat=n - 2):
            walk = []
            for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)):
                corner = list(rest)
                corner.insert(a, u)
                corner.insert(b, v)
                walk.append(tuple(corner))
            found.append(tuple(walk))
    return found


def in_cube(square: tuple[Corner, ...], axis: int, side: int) -> bool:
    """All corners of the square are in the cube of a 4-cell on this side of this axis."""
    return all(corner[axis] == side for corner in square)


def lines(g: Floats, square: tuple[Corner, ...]) -> list[Line]:
    """The lines of a square: none, one, or two where its corners alternate.

    >>> walk = squares(2)[0]
    >>> [len(lines(np.array(g, float), walk)) for g in ([[1, 1], [1, 1]], [[1, -1], [-1, 1]])]
    [0, 2]
    """
    hot = [bool(g[corner] >= 0) for corner in square]
    crossed = [k for k in range(4) if hot[k] != hot[(k + 1) % 4]]
    edges = {k: edge_between(square[k], square[(k + 1) % 4]) for k in crossed}
    cold = [np.array(square[k], float) for k in range(4) if not hot[k]]
    if len(crossed) == 2:
        first, second = crossed
        return [Line(frozenset((edges[first], edges[second])), tuple(np.mean(cold, axis=0)))]
    if not crossed:
        return []
    # Cut off the corners on the other side of the middle's.
    middle = float(np.mean([g[corner] for corner in square])) >= 0
    found = []
    for k in range(4):
        if hot[k] != middle:
            outside = np.array(square[k], float) if middle else np.mean(square, axis=0)
            ends = frozenset((edges[(k - 1) % 4], edges[k]))
            found.append(Line(ends, tuple(outside)))
    return found


def edge_between(a: Corner, b: Corner) -> Edge:
    """The edge of two corners, by one name from either side."""
    return (a, b) if a < b else (b, a)


def joined(loose: list[Line]) -> list[Polygon]:
    """The lines of a cube as polygons: each ends where the next begins."""
    at: dict[Edge, list[Line]] = {}
    for line in loose:
        for edge in line.ends:
            at.setdefault(edge, []).append(line)
    found, left = [], set(loose)
    for start in loose:
        if start not in left:
            continue
        polygon, edge = [start], next(iter(sorted(start.ends)))
        left.discard(start)
        while (follows := [line for line in at[edge] if line in left]) != []:
            polygon.append(follows[0])
            left.discard(follows[0])
            (edge,) = follows[0].ends - {edge}
        found.append(tuple(polygon))
    return found


def polyhedra(polygons: list[Polygon]) -> list[list[Polygon]]:
    """The polygons of a 4-cell's cubes as polyhedra: those that share a line are of one."""
    found: list[tuple[set[Line], list[Polygon]]] = []
    for polygon in polygons:
        own, together = set(polygon), [polygon]
        for other in [one for one in found if one[0] & own]:
            found.remove(other)
            own |= other[0]
            together = other[1] + together
        found.append((own, together))
    return [together for _, together in found]


# --- where an element stands, and its normal ------------------------------------------------------


def point(edge: Edge, g: Floats, spacing: Floats) -> Floats:
    """Where the value is 0 on the edge."""
    a, b = edge
    t = g[a] / (g[a] - g[b])
    return np.asarray((np.array(a) + t * (np.array(b) - np.array(a))) * spacing)


def element(
    parts: list[tuple[Polygon, Floats | None]], g: Floats, spacing: Floats
) -> tuple[Floats, Floats]:
    """Place and normal of a line, a polygon or a polyhedron, given its polygons and their centres.

    A piece is a line, with the polygon's centre in four dimensions, and in three or four with the
    centre of the element.
    """
    # Lay out the pieces but for the centre they are filled from.
    rows, outside = [], []
    for polygon, centre in parts:
        for line in polygon:
            ends = [point(edge, g, spacing) for edge in sorted(line.ends)]
            rows.append([*ends, *([] if centre is None else [centre])])
            outside.append(np.array(line.outside) * spacing)
    pieces, cold = np.array(rows), np.array(outside)
    if pieces.shape[1] == g.ndim:  # A line in the plane has no centre but its middle.
        place = pieces.mean(axis=(0, 1))
    else:
        place = centroid(pieces, distinct(parts, g, spacing))
        pieces = np.concatenate([pieces, np.broadcast_to(place, (len(pieces), 1, g.ndim))], axis=1)
    normals = normals_of(pieces)
    # Turn each outwards.
    inwards = ((cold - place) * normals).sum(axis=1) < 0
    return place, np.where(inwards[:, None], -normals, normals).sum(axis=0)


def polygon_centre(polygon: Polygon, g: Floats, spacing: Floats) -> Floats:
    """The centroid of a polygon."""
    ends = np.array([[point(edge, g, spacing) for edge in sorted(x.ends)] for x in polygon])
    return centroid(ends, distinct([(polygon, None)], g, spacing))


def distinct(parts: list[tuple[Polygon, Floats | None]], g: Floats, spacing: Floats) -> Floats:
    """The mean of the points of an element, each counted once."""
    edges = sorted({edge for polygon, _ in parts for line in polygon for edge in line.ends})
    return np.asarray(np.mean([point(edge, g, spacing) for edge in edges], axis=0))


def centroid(pieces: Floats, mean: Floats) -> Floats:
    """The centre of mass of pieces (P, k, n) filled from the mean; the mean where they are flat."""
    whole = np.concatenate([pieces, np.broadcast_to(mean, (len(pieces), 1, len(mean)))], axis=1)
    size = sizes(whole)
    if size.sum() == 0:
        return mean
    return np.asarray((whole.mean(axis=1) * size[:, None]).sum(axis=0) / size.sum())


def sizes(simplices: Floats) -> Floats:
    """(P,) length, area or volume of simplices (P, k + 1, n), by Gram's determinant."""
    edges = simplices[:, 1:] - simplices[:, :1]
    squared = np.linalg.det(edges @ edges.transpose(0, 2, 1))
    return np.asarray(np.sqrt(np.maximum(squared, 0)) / factorial(edges.shape[1]))


def normals_of(simplices: Floats) -> Floats:
    """(P, n) normals of simplices (P, n, n), as long as they are large, either way.

    >>> normals_of(np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0.0]]])).tolist()
    [[0.0, -0.0, 0.5]]
    """
    n = simplices.shape[2]
    edges = simplices[:, 1:] - simplices[:, :1]
    parts = [(-1) ** axis * np.linalg.det(np.delete(edges, axis, axis=2)) for axis in range(n)]
    return np.asarray(np.stack(parts, axis=1) / factorial(n - 1))
