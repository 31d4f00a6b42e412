r"""Isosurfaces in any dimension and codimension, as unions of simplices.

A field phi on a lattice of dimension n has m components, m <= n. Its isosurface is the set where
the simplicial interpolant phi^ takes a given value in all m components at once: a curve where
n = m + 1, a surface where n = m + 2, isolated points where n = m. Inside one simplex of the Kuhn
triangulation phi^ is linear, so the isosurface is the section of the simplex by m hyperplanes::

    C_J  --phi_1 = 0-->  (n-1)-simplices  --phi_2 = 0-->  (n-2)-simplices  -->  ..  (n-m)-simplices

Each arrow is `isoref.simplex_section`, applied to every simplex that is left.

The whole computation is one operation on one object. A `Complex` is a set of oriented simplices
on shared vertices with values at the vertices; `section` cuts it where the first value is 0 and
gives the complex that is left, one dimension lower and with one value fewer. `extract` makes the
complex of the lattice and cuts it m times. `isoref.fast.simplicial` is the vectorised twin: the
same vertices, the same simplices up to their order.

Glossary
--------
n, m        dimension of the lattice, number of components (codimension)
phi, phi^   samples, their simplicial interpolant; here always minus the isovalue
psi         the component that is cut next
k           dimension of the simplices of a complex, n at first, n - m at last
cell        a cube of the lattice, named by the number of its lowest sample (C order)
parent      of a simplex: the Kuhn simplex it lies in, as cell * n! + number of the permutation

Invariants
----------
Rows of a complex climb in the numbering of its vertices; vertices of a section are numbered by
the pair (lower end, higher end) of the edge they lie on. So every shared face is cut alike with
the rule "staircase", and the result is a simplicial complex: an (n-m)-manifold, closed away from
the border of the lattice, whatever the samples are.

Orientation: with g_i the gradient of component i and t_1 .. t_(n-m) the edges of a simplex from
its first vertex, det(-g_1, .., -g_m, t_1, .., t_(n-m)) > 0. For n = 3, m = 1 this says that
right-hand normals point from high to low; for n = 2, m = 1 the inside lies to the left. A point,
n = m, has no edges and no row can tell its orientation: `jacobian_signs` gives it, the sign of
det(g_1, .., g_n), and the signs of all points sum to the degree of phi on the border.

References
----------
[1] C. Min, 2003: section 4, equation 4.
[2] C. Weigle, D. Banks, "Complex-valued contour meshing", IEEE Visualization 1996.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import factorial
from typing import NamedTuple

import numpy as np

from isoref.field import Field, FieldError, Floats, Integers, check_isovalue
from isoref.kuhn import (
    chains,
    check_thickness,
    corner_offsets,
    gradient,
    permutations,
    signs,
    strides,
)
from isoref.mesh import Mesh, Provenance, in_space
from isoref.simplex_section import crossing, section_table, with_epsilon

Isovalue = float | Sequence[float]
Sampler = Callable[[Integers], Floats]
Edge = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Complex:
    """Oriented simplices on shared vertices, with values at the vertices.

    Attributes
    ----------
    names : (V, 2^s) after s sections: the sample a vertex is, or the names of the ends of its edge
    points : (V, n) indices into the lattice, fractional from the first section on
    values : (V, r) the components that are still to be cut
    simplices : (S, k + 1) rows of vertices, climbing
    signs : (S,) +1 where the row as it stands has the right orientation, else -1
    parents : (S,) the Kuhn simplex each lies in
    """

    names: Integers
    points: Floats
    values: Floats
    simplices: Integers
    signs: Integers
    parents: Integers


class Piece(NamedTuple):
    """A simplex of a section, each of its vertices named by the edge it lies on."""

    edges: list[Edge]
    sign: int
    parent: int


@in_space
def extract(
    field: Field,
    isovalue: Isovalue = 0.0,
    *,
    rule: str = "staircase",
    epsilon: float | None = None,
    provenance: bool = False,
) -> Mesh:
    """The isosurface of `field`: (n-m)-simplices on shared vertices.

    Parameters
    ----------
    field : m components on a lattice of dimension n, m <= n
    isovalue : one number for all components, or one a component
    rule : a name of `isoref.simplex_section.RULES`
    epsilon : replace exact zeros by this number, as the paper does; by default nothing is changed
    provenance : for one component, also say where vertices and simplices come from
        (`isoref.mesh.Provenance`)

    Returns
    -------
    Mesh
        vertices (V, n) in the unit of the field's spacing, simplices (S, n - m + 1).

    Raises
    ------
    FieldError
        for more components than axes, a lattice one sample thick, or an isovalue that is no
        finite number.

    >>> i, j = np.indices((5, 5))
    >>> extract(Field.of((i - 2) ** 2 + (j - 2) ** 2), 2.5)
    Mesh(22 vertices in R^2, 22 simplices of dimension 1)
    """
    complex_ = section_of_field(field, isovalue, rule, epsilon)
    mesh = to_mesh(complex_, field.spacing, field.origin)
    return replace(mesh, provenance=provenance_of(complex_, field)) if provenance else mesh


def section_of_field(
    field: Field,
    isovalue: Isovalue = 0.0,
    rule: str = "staircase",
    epsilon: float | None = None,
) -> Complex:
    """The isosurface as a complex, whose simplices still know their parents. See `extract`."""
    check_input(field.shape, field.components)
    sample = sampler(field, levels(isovalue, field.components), epsilon)
    lowest = np.indices([N - 1 for N in field.shape]).reshape(field.dimension, -1)
    cells = np.ravel_multi_index(tuple(lowest), field.shape)
    return section_of_cells(field.shape, np.asarray(cells, np.int64), sample, rule, epsilon)


def section_of_cells(
    shape: tuple[int, ...],
    cells: Integers,
    sample: Sampler,
    rule: str = "staircase",
    epsilon: float | None = None,
) -> Complex:
    """The isosurface in these cells (C,), cut by one component after the other.

    `sample` gives the values (P, m), minus the isovalue, of the samples with numbers (P,).
    """
    complex_ = kuhn_complex(shape, cells, sample)
    while complex_.values.shape[1]:
        complex_ = section(complex_, rule, epsilon)
    return complex_


def kuhn_complex(shape: tuple[int, ...], cells: Integers, sample: Sampler) -> Complex:
    """The Kuhn simplices of `cells` on which every component takes both signs."""
    n = len(shape)
    m = sample(np.zeros(1, np.int64)).shape[1]
    offsets = corner_offsets(n) @ strides(shape)
    simplices, orientation, parents = [], [], []
    value: dict[int, Floats] = {}
    for cell in cells.tolist():
        # Sample the corners.
        corners = cell + offsets
        values = sample(corners)
        if not takes_both_signs(values):
            continue
        checked_values(values)

        # Keep the simplices that the surface may meet.
        for J, chain in enumerate(chains(n)):
            if takes_both_signs(values[chain]):
                simplices.append(corners[chain].tolist())
                orientation.append(int(signs(n)[J]))
                parents.append(cell * factorial(n) + J)
                value.update(zip(corners[chain].tolist(), values[chain], strict=True))

    # Number the samples that are used, in the order of the lattice.
    numbers = np.array(sorted(value), np.int64)
    place = {sample_: v for v, sample_ in enumerate(numbers.tolist())}
    return Complex(
        names=numbers[:, None],
        points=np.array(np.unravel_index(numbers, shape), np.float64).T,
        values=np.array([value[number] for number in numbers.tolist()]).reshape(-1, m),
        simplices=np.array([[place[v] for v in row] for row in simplices], np.int64).reshape(
            -1, n + 1
        ),
        signs=np.array(orientation, np.int64),
        parents=np.array(parents, np.int64),
    )


def takes_both_signs(values: Floats) -> bool:
    """Whether each of the m components of (V, m) values is >= 0 somewhere and < 0 somewhere.

    >>> takes_both_signs(np.array([[-1.0, 2.0], [0.0, -3.0]]))
    True
    """
    inside = values >= 0
    return bool((inside.any(axis=0) & ~inside.all(axis=0)).all())


def section(complex_: Complex, rule: str = "staircase", epsilon: float | None = None) -> Complex:
    """The section of a complex where its first value is 0: one dimension and one value fewer."""
    psi, k = complex_.values[:, 0], complex_.simplices.shape[1] - 1
    rows = zip(
        complex_.simplices.tolist(),
        complex_.signs.tolist(),
        complex_.parents.tolist(),
        strict=True,
    )

    # Cut each simplex by the table for the signs of its vertices.
    pieces: list[Piece] = []
    for vertices, sign, parent in rows:
        code = sum(1 << place for place, v in enumerate(vertices) if psi[v] >= 0)
        if code in (0, (1 << k + 1) - 1):
            continue
        table = section_table(rule, k, code)
        ends = [(vertices[a], vertices[b]) for a, b in product(table.negatives, table.positives)]
        for row, orientation in zip(table.rows, table.signs, strict=True):
            edges = [(min(ends[e]), max(ends[e])) for e in row]
            pieces.append(Piece(edges, sign * int(orientation), parent))

    # Give each crossed edge one vertex, numbered by the ends of the edge.
    crossed = sorted({edge for piece in pieces for edge in piece.edges})
    number = {edge: v for v, edge in enumerate(crossed)}
    points, values = [], []
    for edge in crossed:
        i, j = sorted(edge, key=lambda v: bool(psi[v] >= 0))
        points.append(crossing(complex_.points[i], complex_.points[j], psi[i], psi[j]))
        left = crossing(complex_.values[i, 1:], complex_.values[j, 1:], psi[i], psi[j])
        values.append(zeroed(left, epsilon))

    # Gather the complex that is left.
    low, high = np.array(crossed, np.int64).reshape(-1, 2).T
    return Complex(
        names=np.hstack([complex_.names[low], complex_.names[high]]),
        points=np.array(points).reshape(len(crossed), complex_.points.shape[1]),
        values=np.array(values).reshape(len(crossed), complex_.values.shape[1] - 1),
        simplices=np.array(
            [[number[edge] for edge in piece.edges] for piece in pieces], np.int64
        ).reshape(-1, k),
        signs=np.array([piece.sign for piece in pieces], np.int64),
        parents=np.array([piece.parent for piece in pieces], np.int64),
    )


def levels(isovalue: Isovalue, m: int) -> Floats:
    """The isovalue of each component, or a `FieldError`.

    >>> levels(2, 3).tolist()
    [2.0, 2.0, 2.0]
    """
    given = list(isovalue) if isinstance(isovalue, Sequence | np.ndarray) else [isovalue] * m
    if len(given) != m:
        raise FieldError(f"{len(given)} isovalues for {m} components; give one, or one a component")
    return np.array([check_isovalue(value) for value in given])


def sampler(field: Field, level: Floats, epsilon: float | None) -> Sampler:
    """What gives the values of samples above the level, (p, m), by the numbers of the samples."""
    flat = field.values.reshape(field.components, -1)
    return lambda numbers: zeroed(flat[:, numbers].T.astype(np.float64) - level, epsilon)


def zeroed(values: Floats, epsilon: float | None) -> Floats:
    """The values, with exact zeros replaced where an epsilon is given."""
    return values if epsilon is None else with_epsilon(values, epsilon)


def check_input(shape: tuple[int, ...], m: int) -> None:
    """Raise FieldError unless m components can be cut on this lattice."""
    if m > len(shape):
        raise FieldError(
            f"{m} components on a lattice of dimension {len(shape)}: an isosurface needs m <= n; "
            "was `dimension` given to Field.of?"
        )
    check_thickness(shape)


def checked_values(values: Floats) -> Floats:
    """The values, or a `FieldError` where they are not finite or too large to be interpolated."""
    if not (np.abs(values) <= np.finfo(np.float64).max / 2).all():
        raise FieldError(
            "a sample minus the isovalue is not finite or beyond 8.9e307; rescale the field"
        )
    return values


def to_mesh(complex_: Complex, spacing: Sequence[float], origin: Sequence[float]) -> Mesh:
    """The mesh of a complex, its points in space and its rows oriented as they stand."""
    rows = complex_.simplices.copy()
    if rows.shape[1] > 1:
        negative = complex_.signs < 0
        rows[negative, -2:] = rows[negative, -2:][:, ::-1]
    return Mesh(complex_.points * spacing + origin, rows)


def provenance_of(complex_: Complex, field: Field) -> Provenance:
    """Where the vertices and simplices of a section by one component come from.

    Raises
    ------
    FieldError
        for several components.
    """
    if field.components != 1:
        raise FieldError(
            f"a vertex where {field.components} components meet lies on no edge of the lattice"
        )
    n = field.dimension
    ends = complex_.names
    low, high = (np.stack(np.unravel_index(end, field.shape), axis=1) for end in ends.T)
    # The ends differ by 0 or 1 along every axis.
    along = (complex_.points - low).sum(axis=1) / (high - low).sum(axis=1)
    lowest = np.unravel_index(complex_.parents // factorial(n), field.shape)
    cells = np.ravel_multi_index(lowest, tuple(N - 1 for N in field.shape))
    return Provenance(ends, along, np.asarray(cells), field)


def jacobian_signs(complex_: Complex) -> Integers:
    """The sign of det(g_1, .., g_n) at each point where n = m: the index of each zero, (S,).

    In the order of the simplices, which is that of the mesh. The signs are combinatorial, like
    all orientation here: none is 0, even where samples are tied.

    Raises
    ------
    FieldError
        for a complex of anything but points.

    >>> x, y = np.indices((9, 9)) - 4.0
    >>> squared = Field.of([x * x - y * y, 2 * x * y], dimension=2)
    >>> jacobian_signs(section_of_field(squared, [3.0, 0.5])).tolist()
    [1, 1]
    """
    n, k = complex_.points.shape[1], complex_.simplices.shape[1] - 1
    if k:
        raise FieldError(
            f"simplices of dimension {k} are oriented by their rows; points need n = m"
        )
    return np.asarray(complex_.signs * (-1) ** n)


def gradients(
    parents: Integers, sample: Sampler, shape: tuple[int, ...], spacing: Sequence[float]
) -> Floats:
    """The gradients of the m components of phi^ on Kuhn simplices, (S, m, n), by equation 1.

    Parameters
    ----------
    parents : (S,) the Kuhn simplices, as in `Complex`
    sample : gives the values (P, m) of the samples with numbers (P,)
    shape, spacing : of the lattice; gradients are in units of the values over that of the spacing
    """
    n = len(shape)
    cell, J = np.divmod(parents, factorial(n))
    chain = chains(n)[J]
    vertices = cell[:, None] + (corner_offsets(n) @ strides(shape))[chain]
    values = sample(vertices.ravel()).reshape(*vertices.shape, -1)
    return gradient(np.moveaxis(values, -1, 1), permutations(n)[J][:, None], spacing)
