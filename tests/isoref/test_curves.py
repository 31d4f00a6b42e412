"""Curves: chains, cycles, lengths, and pairs of fields."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from isoref.curves import Curve, check_pair, curves_through, follow, real_and_imaginary
from isoref.field import Field, FieldError


@given(st.permutations(range(12)), st.sets(st.integers(0, 11)))
def test_every_item_is_on_exactly_one_chain_or_cycle(order: list[int], cut: set[int]) -> None:
    """A permutation with some links cut: consecutive items are linked, chains start unlinked."""
    successor = np.array([-1 if i in cut else order[i] for i in range(12)])
    found = follow(successor)
    assert sorted(int(i) for chain, _ in found for i in chain) == list(range(12))
    for chain, closed in found:
        np.testing.assert_array_equal(successor[chain[:-1]], chain[1:])
        assert successor[chain[-1]] == (chain[0] if closed else -1)
        assert closed or chain[0] not in successor


def test_a_closed_curve_returns_to_its_first_point() -> None:
    """`points` has each point once, `polyline` the first one twice."""
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    assert Curve(square, True).length == 4
    assert Curve(square, False).length == 3
    assert len(Curve(square, True).polyline) == 5
    assert repr(Curve(square, True)) == "Curve(4 points, closed, length 4)"


def test_a_complex_field_splits_into_two() -> None:
    """Real and imaginary part on one lattice."""
    real, imaginary = real_and_imaginary(np.full((2, 2, 2), 3 + 4j), 0.5)
    assert real.values.max() == 3
    assert imaginary.values.min() == 4
    assert real.spacing == imaginary.spacing == (0.5, 0.5, 0.5)
    with pytest.raises(FieldError, match="nan"):
        real_and_imaginary(np.full((2, 2, 2), np.nan * 1j))


def test_a_pair_of_components_is_refused() -> None:
    """Two scalar fields are wanted, not one vector field twice."""
    vector = Field.of(np.zeros((2, 3, 3, 3)), dimension=3)
    with pytest.raises(FieldError, match="one scalar component"):
        check_pair(vector, vector, (0, 0))


def test_lattices_that_differ_are_refused_with_the_difference() -> None:
    """Shape, spacing and origin; the message names the field."""
    field = Field.of(np.zeros((2, 3, 4)), 0.5, (1.0, 2.0, 3.0))
    check_pair(field, Field.of(np.ones((2, 3, 4)), 0.5, (1.0, 2.0, 3.0)), (0.5, -1))
    for other, message in (
        (Field.of(np.zeros((2, 3, 5)), 0.5, (1.0, 2.0, 3.0)), r"\(2, 3, 4\) and \(2, 3, 5\)"),
        (Field.of(np.zeros((2, 3, 4)), 1.0, (1.0, 2.0, 3.0)), "lattices differ: spacing"),
        (Field.of(np.zeros((2, 3, 4)), 0.5), "lattices differ: .* origin"),
        (Field.of(np.zeros((3, 4))), "field 2 has rank 2 on a lattice of dimension 2"),
        (Field.of(np.zeros((1, 2, 3, 4)), dimension=3), "field 2 has rank 4"),
    ):
        with pytest.raises(FieldError, match=message):
            check_pair(field, other, (0, 0))
    with pytest.raises(FieldError, match="isovalue inf"):
        check_pair(field, field, (0, np.inf))


def test_a_complex_field_of_unit_spacing_needs_none() -> None:
    """As `Field.of`."""
    real, imaginary = real_and_imaginary(np.zeros((2, 2, 2)))
    assert real.spacing == imaginary.spacing == (1.0, 1.0, 1.0)
    with pytest.raises(FieldError, match="rank 2"):
        real_and_imaginary(np.zeros((2, 2)))


def test_a_curve_has_no_point_twice_in_a_row() -> None:
    """Nor last and first where it is closed; a curve of one point is none."""
    a, b, c = np.eye(3)
    for closed, points, kept in (
        (False, [a, a, b, b, b, a], [a, b, a]),
        (True, [a, b, b, c, a], [b, c, a]),
        (True, [a, b, c], [a, b, c]),
        (True, [a, a], []),
        (False, [a, a], []),
        (False, [a], []),
    ):
        found = curves_through(np.array(points), closed)
        assert [curve.points.tolist() for curve in found] == (
            [np.array(kept).tolist()] if kept else []
        )
        assert all(curve.closed == closed for curve in found)


def test_chains_come_first_and_each_kind_by_its_first_item() -> None:
    """Cycles start at their lowest item."""
    found = follow(np.array([1, -1, 4, -1, 2, 3]))
    assert [(c.tolist(), closed) for c, closed in found] == [
        ([0, 1], False),
        ([5, 3], False),
        ([2, 4], True),
    ]
