"""Curves: chains, cycles, lengths, and pairs of fields."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from isoref.curves import Curve, check_pair, follow, real_and_imaginary
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
