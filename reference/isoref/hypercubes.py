r"""Isosurfaces from cubes in any dimension, by convex hulls.

Marching cubes needs a table of what a cube with given signs holds. In the plane it has 16 entries,
in space 256, in dimension four 65,536: nobody draws those. Bhaniramka, Wenger and Crawfis found
that nobody has to. Take the corners that are inside, and the middles of the edges that are crossed,
and their convex hull. What the hull shows inside the cube is the surface::

    o-------o        + inside, o outside, x middle of a crossed edge
    |       |
    x----.  |        the hull of + + x x has the edge x..x inside the square:
    |     ` x        that is the isosurface
    +-------+

On a face of the cube the hull is the hull of what is on that face. So neighbours agree, with no
decision at all: the inside corners of an ambiguous face are always joined.

Facets of the hull need not be simplices. Each is cut from its lowest vertex (a *pulling*
triangulation) in one order of all middles, so that neighbours also cut their common faces alike.

Glossary
--------
n           dimension of the lattice; the surface has n - 1
corner c    bit i is its coordinate along axis i (`isoref.kuhn.corner_offsets`)
signs       bit c is set where corner c is inside, F >= isovalue
place       of a corner or a middle: twice its coordinates in the cube, integers 0, 1, 2
facet       of the hull, as the frozenset of the places on it
middle      a place with one odd coordinate: that of a crossed edge

Invariants
----------
The surface is closed away from the border and oriented: with t_1 .. t_(n-1) the edges of a simplex
from its first vertex, det(-g, t_1, .., t_(n-1)) > 0, g the gradient. Vertices of the facets inside
are middles: near an inside corner the hull fills the cube.

References
----------
[1] P. Bhaniramka, R. Wenger, R. Crawfis, "Isosurfacing in higher dimensions", Visualization 2000.
[2] C. Min, 2003, section 1: 14 classes of signs in space, 222 in dimension four.
"""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np
from scipy.spatial import ConvexHull

from isoref.field import Field, FieldError, Floats, Integers, check_isovalue
from isoref.kuhn import check_thickness, corner_offsets
from isoref.mesh import Mesh, in_space

Place = tuple[int, ...]
Facet = frozenset[Place]
#: Tables of more corners would take hulls by the thousand.
LARGEST = 4


@cache
def tile(signs: int, n: int) -> tuple[tuple[Place, ...], ...]:
    """The oriented simplices of the surface in a cube, each a row of n middles.

    >>> tile(0b0001, 2)
    (((1, 0), (0, 1)),)
    >>> len(tile(0b01101001, 3)), len(tile(0b1, 4))
    (4, 1)
    """
    if signs in (0, (1 << (1 << n)) - 1):
        return ()
    places = hull_places(signs, n)
    hull = ConvexHull(np.array(places, np.float64))
    facets: dict[Place, set[Place]] = {}
    for simplex, equation in zip(hull.simplices.tolist(), hull.equations, strict=True):
        facets.setdefault(normal_of(equation), set()).update(places[i] for i in simplex)
    every = [on_plane(places, normal, rows) for normal, rows in facets.items()]
    rows = []
    for normal, facet in zip(facets, every, strict=True):
        if not on_the_cube(facet):
            simplices = pulled(facet, every, n - 1)
            rows += [oriented(row, np.array(normal[:-1], np.float64)) for row in simplices]
    return tuple(rows)


def hull_places(signs: int, n: int) -> list[Place]:
    """The inside corners and the middles of the crossed edges, in ascending order."""
    offsets = corner_offsets(n)
    places = set()
    for c in range(1 << n):
        if signs >> c & 1:
            places.add(tuple((2 * offsets[c]).tolist()))
        for axis in range(n):
            d = c | 1 << axis
            if d != c and (signs >> c ^ signs >> d) & 1:
                places.add(tuple((offsets[c] + offsets[d]).tolist()))
    return sorted(places)


def normal_of(equation: Floats) -> Place:
    """A hull's equation a . x + b <= 0 in small integers, the same for all simplices of a facet.

    >>> normal_of(np.array([0.6, 0.8, -1.4]))
    (3, 4, -7)
    """
    size = np.abs(equation[:-1])
    scaled = equation / size[size > 1e-9].min()
    # Coordinates are 0, 1, 2: components of normals are ratios of small determinants.
    for factor in range(1, 61):
        whole = np.rint(scaled * factor)
        if np.allclose(whole, scaled * factor, atol=1e-6):
            return tuple(int(x) for x in whole)
    raise ValueError(f"the plane {equation.tolist()} has no small integer normal")


def on_plane(places: list[Place], normal: Place, rows: set[Place]) -> Facet:
    """All places on the facet's plane: Qhull leaves out those that are no corners of a simplex."""
    a, b = np.array(normal[:-1]), normal[-1]
    return frozenset(rows) | {p for p in places if int(a @ np.array(p)) + b == 0}


def on_the_cube(facet: Facet) -> bool:
    """Whether all of the facet lies in one face of the cube."""
    coordinates = np.array(sorted(facet))
    return bool(((coordinates == 0).all(axis=0) | (coordinates == 2).all(axis=0)).any())


def pulled(face: Facet, facets: list[Facet], dimension: int) -> list[tuple[Place, ...]]:
    """The pulling triangulation of a face of the hull: its lowest vertex over what lies opposite.

    The faces of a face are its intersections with facets, those of one dimension less.
    """
    if len(face) == dimension + 1:
        return [tuple(sorted(face))]
    lowest = min(face)
    parts = {face & other for other in facets if lowest not in other}
    walls = [part for part in parts if rank(part) == dimension - 1]
    return [
        (lowest, *row)
        for wall in sorted(walls, key=sorted)
        for row in pulled(wall, facets, dimension - 1)
    ]


@cache
def rank(places: Facet) -> int:
    """The dimension of the affine hull; -1 of nothing."""
    if not places:
        return -1
    points = np.array(sorted(places))
    return int(np.linalg.matrix_rank(points[1:] - points[0])) if len(points) > 1 else 0


def oriented(row: tuple[Place, ...], outward: Floats) -> tuple[Place, ...]:
    """The row, its last two vertices swapped unless det(outward, edges ..) > 0."""
    points = np.array(row, np.float64)
    frame = np.vstack([outward, points[1:] - points[0]])
    return row if np.linalg.det(frame) > 0 else (*row[:-2], row[-1], row[-2])


@in_space
def extract(field: Field, isovalue: float = 0.0) -> Mesh:
    """The isosurface of a scalar field on a lattice of two to four axes, cube by cube.

    Parameters
    ----------
    field : one component on a lattice of dimension n
    isovalue : a finite number

    Returns
    -------
    Mesh
        vertices (V, n) in the unit of the spacing, on crossed lattice edges, and simplices (S, n).

    Raises
    ------
    FieldError
        for several components, more than four axes, or a lattice one sample thick.

    >>> i, j = np.indices((5, 5))
    >>> extract(Field.of(2.5 - (i - 2) ** 2 - (j - 2) ** 2))
    Mesh(12 vertices in R^2, 12 simplices of dimension 1)
    """
    check_scalar(field)
    level, n = check_isovalue(isovalue), field.dimension
    values = field.values.astype(np.float64) - level
    number: dict[tuple[Place, Place], int] = {}
    points: list[Floats] = []
    rows: list[list[int]] = []
    for cell in product(*(range(N - 1) for N in field.shape)):
        low = np.array(cell)
        corners = low + corner_offsets(n)
        inside = values[tuple(corners.T)] >= 0
        signs = int(sum(1 << c for c in np.flatnonzero(inside).tolist()))
        for row in tile(signs, n):
            rows.append([vertex(low, place, values, number, points) for place in row])
    if not rows:
        return Mesh.empty(n, n - 1)
    places = np.array(points) * field.spacing + field.origin
    return Mesh(places, np.array(rows, np.int64))


def vertex(
    low: Integers,
    place: Place,
    values: Floats,
    number: dict[tuple[Place, Place], int],
    points: list[Floats],
) -> int:
    """The number of the vertex on a crossed edge, new or known; its place by interpolation."""
    middle = np.array(place)
    a, b = low + middle // 2, low + (middle + 1) // 2
    key = (tuple(a.tolist()), tuple(b.tolist()))
    if key not in number:
        number[key] = len(points)
        f, g = values[key[0]], values[key[1]]
        points.append(a + (b - a) * (f / (f - g)))
    return number[key]


def check_scalar(field: Field) -> None:
    """Raise FieldError unless the field can be cut by cubes here."""
    if field.components != 1 or not 2 <= field.dimension <= LARGEST:
        raise FieldError(
            f"{field.components} components on a lattice of dimension {field.dimension}: cubes "
            f"take one component on two to {LARGEST} axes; isoref.simplicial takes the rest"
        )
    check_thickness(field.shape)


def classes(n: int, complement: bool = True) -> int:
    """How many kinds of signs there are under the symmetries of the cube, by Burnside's lemma.

    The average over the symmetries of the number of signs that each leaves as they are: two to the
    number of cycles it has on the corners. With the exchange of inside and outside the group is
    twice as large; a symmetry followed by the exchange leaves signs as they are only if all its
    cycles are even.

    >>> classes(3), classes(4), classes(3, complement=False)
    (14, 222, 22)
    """
    offsets = corner_offsets(n)
    total = size = 0
    for axes in _orders(n):
        for flips in product((0, 1), repeat=n):
            moved = (offsets[:, axes] ^ np.array(flips)) @ (1 << np.arange(n))
            lengths = cycle_lengths(moved.tolist())
            total += 1 << len(lengths)
            size += 1
            if complement:
                total += 1 << len(lengths) if all(x % 2 == 0 for x in lengths) else 0
                size += 1
    return total // size


def _orders(n: int) -> list[list[int]]:
    """The orders of the axes."""
    if n == 0:
        return [[]]
    return [[*order[:i], n - 1, *order[i:]] for order in _orders(n - 1) for i in range(n)]


def cycle_lengths(moved: list[int]) -> list[int]:
    """The lengths of the cycles of a permutation.

    >>> cycle_lengths([1, 0, 2])
    [2, 1]
    """
    seen, lengths = set[int](), []
    for start in range(len(moved)):
        here, length = start, 0
        while here not in seen:
            seen.add(here)
            here, length = moved[here], length + 1
        if length:
            lengths.append(length)
    return lengths
