r"""The isosurface by its points on m-faces, and by tracing from one to the next.

`isoref.simplicial` cuts simplices by one component after another, and what it makes depends on the
order of the components: a cut adds edges, and the next cut puts points on them. Another way has no
order. In general position the isosurface of m components meets an m-face of the triangulation in
one point or not at all, and an (m+j)-face in a convex polytope of dimension j::

    n = 3, m = 1        edge: a point      triangle: a segment     tetrahedron: a polygon

So the crossed m-faces are the vertices of the isosurface as a complex of polytopes, the faces above
them are its other cells, and neighbours can be walked to: from an m-face to the (m+1)-faces that
hold it, and on to the m-faces of these. Nothing of the rest of the lattice is visited. A simplex of
the Kuhn triangulation and all faces round it follow from a partition of the axes, so that a step
costs a time that is polynomial in n, and exponential in the dimension n - m of the isosurface only.

Glossary
--------
n, m        dimension of the lattice, number of components
face        of the Kuhn triangulation: its lowest vertex and the steps from vertex to vertex, each a
            set of axes that are climbed together; what is climbed by no step is the rest. A step is
            written as a bit mask; the rest, with bit n added, comes last
    v_0 --step 1--> v_1 --step 2--> .. --step d--> v_d --rest--> v_0 + (1, .., 1)
lambda      barycentric coordinates of the point of an m-face where all components are 0
cell        of the isosurface: an (m+j)-face that holds a crossed m-face; its dimension is j

Ties
----
Everything is decided in rational arithmetic. Component i is taken to be larger by epsilon^i, with
an infinitesimal epsilon: then no m-face is met in its boundary, and faces with a common vertex
agree.

Invariants
----------
Every (m+1)-face has no crossed m-face or two. The points do not depend on the order of components,
where none is tied. The cells of dimension 0, 1, .. give the Euler characteristic.

References
----------
[1] J.-D. Boissonnat, S. Kachanovich, M. Wintraecken, "Tracing isomanifolds in R^d in time
    polynomial in d using Coxeter-Freudenthal-Kuhn triangulations", SoCG 2021: the partitions, and
    the cost of a step.
[2] C. Min, 2003, section 4: the way by successive cuts.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, product

import numpy as np

from isoref.field import Field, FieldError, Floats
from isoref.kuhn import check_thickness

Vertex = tuple[int, ...]
Value = Callable[[Vertex], tuple[Fraction, ...]]


@dataclass(frozen=True, order=True)
class Face:
    """A face of the Kuhn triangulation of the lattice of integers.

    Attributes
    ----------
    base : the lowest vertex, n integers
    steps : d + 1 bit masks of axes; the last is the rest, and holds bit n
    """

    base: Vertex
    steps: tuple[int, ...]

    @property
    def dimension(self) -> int:
        """d, the number of steps but the rest."""
        return len(self.steps) - 1

    def vertices(self) -> list[Vertex]:
        """The d + 1 vertices, from the lowest to the highest.

        >>> Face((0, 0), (0b10, 0b101)).vertices()
        [(0, 0), (0, 1)]
        """
        found = [self.base]
        for step in self.steps[:-1]:
            found.append(climbed(found[-1], step))
        return found

    def facets(self) -> Iterator[Face]:
        """The d + 1 faces of one dimension less: two neighbouring steps joined, cyclically."""
        steps = self.steps
        for i in range(self.dimension):
            yield Face(self.base, (*steps[:i], steps[i] | steps[i + 1], *steps[i + 2 :]))
        # Without the lowest vertex the face begins at the second, and its first step is rest.
        yield Face(climbed(self.base, steps[0]), (*steps[1:-1], steps[-1] | steps[0]))

    def cofaces(self) -> Iterator[Face]:
        """The faces of one dimension more that hold it: one step split in two, in every way."""
        n = len(self.base)
        for i, step in enumerate(self.steps):
            for part in parts(step):
                split = (*self.steps[:i], part, step & ~part, *self.steps[i + 1 :])
                yield split_face(self.base, split, n)


def climbed(vertex: Vertex, step: int, by: int = 1) -> Vertex:
    """The vertex after a step along all axes of the mask.

    >>> climbed((3, 4, 5), 0b101)
    (4, 4, 6)
    """
    return tuple(x + by * (step >> axis & 1) for axis, x in enumerate(vertex))


def parts(step: int) -> Iterator[int]:
    """The masks of the sets between none and all of a set.

    >>> sorted(parts(0b101))
    [1, 4]
    """
    part = (step - 1) & step
    while part:
        yield part
        part = (part - 1) & step


def split_face(base: Vertex, steps: tuple[int, ...], n: int) -> Face:
    """The face of a closed walk of steps from `base`, written with the step that holds bit n last.

    Where the rest was split and bit n is in its first half, the second half is a step that ends at
    the base: the face begins there.

    >>> split_face((1, 1), (0b100, 0b11), 2)
    Face(base=(0, 0), steps=(3, 4))
    """
    if steps[-1] >> n & 1:
        return Face(base, steps)
    last = steps[-1]
    return Face(climbed(base, last, -1), (last, *steps[:-1]))


def inside(face: Face, shape: tuple[int, ...]) -> bool:
    """Whether all of the face lies in the lattice of this shape."""
    top = face.base
    for step in face.steps[:-1]:
        top = climbed(top, step)
    low_enough = all(x >= 0 for x in face.base)
    return low_enough and all(x < N for x, N in zip(top, shape, strict=True))


def crossing(face: Face, value: Value) -> list[Fraction] | None:
    """The lambda of the m-face's point where all components are 0; None where there is none.

    The m + 1 numbers solve sum(lambda) = 1, sum(lambda_k phi(v_k)) = 0. Each is a polynomial in the
    infinitesimal epsilon; the point is in the face if all of them are positive.
    """
    columns = [value(vertex) for vertex in face.vertices()]
    m = len(columns) - 1
    rows = [[Fraction(1)] * (m + 1), *([c[i] for c in columns] for i in range(m))]
    right = [[Fraction(int(j == 0))] + [Fraction(0)] * m for j in range(m + 1)]
    for i in range(m):
        # phi_i + epsilon^(i+1) = 0: the right-hand side is -epsilon^(i+1).
        right[i + 1][i + 1] = Fraction(-1)
    solved = solve(rows, right)
    if solved is None or any(not _positive(polynomial) for polynomial in solved):
        return None
    return [polynomial[0] for polynomial in solved]


def _positive(polynomial: list[Fraction]) -> bool:
    """Whether the first coefficient that is not 0 is positive."""
    leading = next((c for c in polynomial if c), Fraction(0))
    return leading > 0


def solve(rows: list[list[Fraction]], right: list[list[Fraction]]) -> list[list[Fraction]] | None:
    """The X with rows X = right, by Gauss and Jordan in rationals; None where rows are dependent.

    >>> one, two = Fraction(1), Fraction(2)
    >>> solve([[one, one], [one, -one]], [[two], [one * 0]])
    [[Fraction(1, 1)], [Fraction(1, 1)]]
    """
    a = [[*row, *wanted] for row, wanted in zip(rows, right, strict=True)]
    size = len(a)
    for k in range(size):
        pivot = next((i for i in range(k, size) if a[i][k]), None)
        if pivot is None:
            return None
        a[k], a[pivot] = a[pivot], a[k]
        a[k] = [x / a[k][k] for x in a[k]]
        for i in range(size):
            if i != k and a[i][k]:
                a[i] = [x - a[i][k] * y for x, y in zip(a[i], a[k], strict=True)]
    return [row[size:] for row in a]


def exact(field: Field, isovalue: float = 0.0) -> Value:
    """The samples minus the isovalue, as rational numbers."""
    flat, level = field.values.reshape(field.components, *field.shape), Fraction(float(isovalue))

    def value(vertex: Vertex) -> tuple[Fraction, ...]:
        return tuple(Fraction(float(flat[i][vertex])) - level for i in range(field.components))

    return value


@dataclass(frozen=True, eq=False)
class Traced:
    """The isosurface as a complex of polytopes.

    Attributes
    ----------
    points : crossed m-face -> its point, in steps of the lattice
    shape : samples along each axis
    """

    points: dict[Face, Floats]
    shape: tuple[int, ...]

    def cells(self) -> list[set[Face]]:
        """The cells of dimension 0, 1, .., n - m: the faces of the lattice that hold a vertex."""
        found = [set(self.points)]
        for _ in range(len(self.shape) - next(iter(self.points), EMPTY).dimension):
            above = (coface for face in found[-1] for coface in face.cofaces())
            found.append({face for face in above if inside(face, self.shape)})
        return found

    def euler(self) -> int:
        """The alternating sum of the numbers of cells."""
        return sum((-1) ** j * len(faces) for j, faces in enumerate(self.cells()))


EMPTY = Face((), (1,))


def trace(value: Value, m: int, shape: tuple[int, ...], seeds: Iterable[Face]) -> Traced:
    """The components of the isosurface that the crossed m-faces among the seeds lie on.

    Parameters
    ----------
    value : phi at a vertex, m rational numbers
    shape : samples along each axis; the walk ends at the border
    seeds : m-faces; those that are not crossed are passed over
    """
    points: dict[Face, Floats] = {}
    waiting = deque(seeds)
    tried: set[Face] = set()
    while waiting:
        face = waiting.popleft()
        if face in tried or not inside(face, shape):
            continue
        tried.add(face)
        weights = crossing(face, value)
        if weights is None:
            continue
        corners = np.array(face.vertices(), np.float64)
        points[face] = np.array([float(w) for w in weights]) @ corners
        waiting.extend(other for coface in face.cofaces() for other in coface.facets())
    return Traced(points, shape)


def every_face(shape: tuple[int, ...], m: int) -> Iterator[Face]:
    """All m-faces of a lattice: each base with each way to climb in m steps. For small lattices.

    >>> len(list(every_face((3, 3), 1))), len(list(every_face((2, 2, 2), 3)))
    (16, 6)
    """
    n = len(shape)
    walks = list(_walks((1 << n) - 1, m))
    for base in product(*(range(N) for N in shape)):
        for walk in walks:
            used = sum(walk)
            face = Face(base, (*walk, ((1 << n + 1) - 1) & ~used))
            if inside(face, shape):
                yield face


def _walks(free: int, m: int) -> Iterator[tuple[int, ...]]:
    """The sequences of m disjoint masks of these axes, none empty."""
    if m == 0:
        yield ()
        return
    axes = [axis for axis in range(free.bit_length()) if free >> axis & 1]
    for size in range(1, len(axes) - m + 2):
        for chosen in combinations(axes, size):
            step = sum(1 << axis for axis in chosen)
            for rest in _walks(free & ~step, m - 1):
                yield (step, *rest)


def all_of(field: Field, isovalue: float = 0.0) -> Traced:
    """All of the isosurface, every m-face of the lattice asked.

    Raises
    ------
    FieldError
        for more components than axes, or a lattice one sample thick.

    >>> i, j = np.indices((5, 5))
    >>> found = all_of(Field.of((i - 2) ** 2 + (j - 2) ** 2), 2.5)
    >>> len(found.points), found.euler()
    (22, 0)
    """
    m = field.components
    if m > field.dimension:
        raise FieldError(f"{m} components on a lattice of dimension {field.dimension}: m <= n")
    check_thickness(field.shape)
    return trace(exact(field, isovalue), m, field.shape, every_face(field.shape, m))
