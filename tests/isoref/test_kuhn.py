"""The Kuhn triangulation is a triangulation, and its interpolant is linear on each simplex."""

import itertools
from math import factorial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from isoref import Field, FieldError
from isoref.kuhn import (
    box_simplices,
    chains,
    corner_offsets,
    gradient,
    interpolate,
    lattice_simplices,
    permutations,
    signs,
    strides,
)

DIMENSIONS = [1, 2, 3, 4, 5]


@pytest.mark.parametrize("n", DIMENSIONS)
def test_the_simplices_of_a_box_have_equal_volumes_that_add_up(n: int) -> None:
    """Section 2.1: the n! simplices C_J fill the box."""
    a, b = np.arange(n) * 0.5, np.arange(n) + 1.25
    simplices = box_simplices(a, b)
    volumes = np.linalg.det(np.diff(simplices, axis=1)) / factorial(n)
    assert len(simplices) == factorial(n)
    np.testing.assert_allclose(abs(volumes), np.prod(b - a) / factorial(n))
    np.testing.assert_array_equal(np.sign(volumes), signs(n))


@pytest.mark.parametrize("n", DIMENSIONS)
def test_every_point_is_in_the_simplex_of_its_sorted_coordinates_and_in_no_other(n: int) -> None:
    """Section 2.1: C_J holds the points whose coordinates fall in the order J."""
    points = np.random.default_rng(n).random((20, n))
    corners = corner_offsets(n)[chains(n)].astype(float)
    edges = np.diff(corners, axis=1).transpose(0, 2, 1)
    tail = np.linalg.solve(edges[:, None], (points - corners[:, :1])[..., None])[..., 0]
    steps = np.concatenate([np.ones((*tail.shape[:2], 1)), tail, np.zeros((*tail.shape[:2], 1))], 2)
    inside = (-np.diff(steps, axis=2) > 0).all(axis=2)
    assert (inside.sum(axis=0) == 1).all()
    np.testing.assert_array_equal(permutations(n)[inside.argmax(axis=0)], np.argsort(-points, 1))


@pytest.mark.parametrize("shape", [(3, 4), (3, 3, 3), (3, 3, 2, 3)])
def test_the_simplices_of_a_lattice_meet_in_common_facets(shape: tuple[int, ...]) -> None:
    """Section 2.1: neighbouring cells are cut alike, and orientations of neighbours agree."""
    simplices, orientation = lattice_simplices(shape)
    seen: dict[tuple[int, ...], list[int]] = {}
    for row, sign in zip(simplices.tolist(), orientation.tolist(), strict=True):
        for k in range(len(row)):
            seen.setdefault(tuple(row[:k] + row[k + 1 :]), []).append(sign * (-1) ** k)
    index = np.indices(shape).reshape(len(shape), -1)
    for facet, owners in seen.items():
        where = index[:, list(facet)]
        same = where == where[:, :1]
        end = (where[:, 0] == 0) | (where[:, 0] == np.array(shape) - 1)
        on_border = bool((same.all(axis=1) & end).any())
        assert len(owners) == (1 if on_border else 2)
        assert on_border or sum(owners) == 0


def test_vertices_of_a_simplex_climb_in_the_numbering_of_the_lattice() -> None:
    """The handed-on order of `simplex_section` starts here."""
    simplices, _ = lattice_simplices((2, 3, 4))
    assert (np.diff(simplices, axis=1) > 0).all()
    assert strides((2, 3, 4)).tolist() == [12, 4, 1]


@given(n=st.integers(1, 4), seed=st.integers(0, 99))
def test_the_interpolant_reproduces_linear_functions(n: int, seed: int) -> None:
    """Section 2.2: linear on each simplex, so exact for a function that is linear."""
    rng = np.random.default_rng(seed)
    slope, shape = rng.normal(size=(2, n)), (3,) * n
    spacing, origin = rng.uniform(0.5, 2, n), rng.normal(size=n)
    place = np.moveaxis(np.indices(shape), 0, -1) * spacing + origin
    values = np.moveaxis(place @ slope.T, -1, 0)
    points = origin + spacing * rng.random((10, n)) * 2
    field = Field.of(values, list(spacing), list(origin), dimension=n)
    np.testing.assert_allclose(interpolate(field, points), points @ slope.T, atol=1e-12)


def test_the_interpolant_is_the_samples_at_the_samples_and_continuous_across_cells() -> None:
    """Theorem 2.1."""
    values = np.random.default_rng(0).normal(size=(4, 3, 3))
    field = Field.of(values)
    index = np.array(list(itertools.product(range(4), range(3), range(3))))
    np.testing.assert_array_equal(interpolate(field, index)[:, 0], values.ravel())
    wall = np.random.default_rng(1).random((50, 3)) * [3, 2, 2]
    wall[:, 0] = 1
    left = interpolate(field, wall - [1e-9, 0, 0])
    np.testing.assert_allclose(left, interpolate(field, wall), atol=1e-7)


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_the_gradient_is_the_difference_quotient_of_the_interpolant(n: int) -> None:
    """Equation 1, against small steps of `interpolate` inside each simplex."""
    rng = np.random.default_rng(n)
    spacing = rng.uniform(0.5, 2, n)
    field = Field.of(rng.normal(size=(2,) * n), list(spacing))
    corner_values = field.values.ravel()[corner_offsets(n) @ strides(field.shape)]
    exact = gradient(corner_values[chains(n)], permutations(n), spacing)
    centre = corner_offsets(n)[chains(n)].mean(axis=1) * spacing
    h = 1e-4
    for axis in range(n):
        step = h * np.eye(n)[axis]
        quotient = (interpolate(field, centre + step) - interpolate(field, centre - step)) / (2 * h)
        np.testing.assert_allclose(exact[:, axis], quotient[:, 0], rtol=1e-7, atol=1e-8)


def test_bad_input_is_refused_with_a_reason() -> None:
    """A thin lattice, a point outside, a box without inside."""
    with pytest.raises(FieldError, match="1 sample thick along axis 1"):
        interpolate(Field.of(np.zeros((3, 1))), [[0.0, 0.0]])
    with pytest.raises(FieldError, match="outside the lattice"):
        interpolate(Field.of(np.zeros((3, 3))), [[0.0, 2.5]])
    with pytest.raises(FieldError, match="no inside"):
        box_simplices([0, 0], [1, 0])
    with pytest.raises(FieldError, match="no inside"):
        box_simplices([0, 0], [1])
    with pytest.raises(FieldError, match="no inside"):
        box_simplices([[0, 0]], [[1, 1]])
