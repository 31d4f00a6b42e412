"""The vectorised dual surfaces are those of the article."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from isoref import dual
from isoref.dual import DualRule
from isoref.fast.dual import quads, surface
from isoref.field import Array, Field, FieldError
from isoref.methods import DUAL_RULES, METHODS

RULES = pytest.mark.parametrize("rule", DUAL_RULES.values(), ids=list(DUAL_RULES))


def assert_same(rule: DualRule, field: Field, isovalue: float) -> int:
    """Both give the same rows, and vertices up to the order of a sum; how many rows there are."""
    vertices, rows = quads(rule, field, isovalue)
    plain, same = dual.quads(rule, field, isovalue)
    np.testing.assert_allclose(vertices, plain, rtol=0, atol=1e-13)
    np.testing.assert_array_equal(rows, same)
    return len(rows)


@RULES
@pytest.mark.parametrize("shape", [(2, 2, 2), (2, 5, 3), (3, 3, 3), (5, 6, 7), (9, 4, 3)])
def test_both_give_the_same_arrays_on_noise(rule: DualRule, shape: tuple[int, int, int]) -> None:
    """In a lattice that stands somewhere in space, thin ones too."""
    values = np.random.default_rng(7).normal(size=shape)
    drawn = assert_same(rule, Field.of(values, (1, 2, 0.5), (3, -1, 2)), 0.1)
    assert drawn > 0 or min(shape) == 2


@RULES
@given(
    values=hnp.arrays(
        st.sampled_from([np.uint8, np.int16, np.float32]),
        st.tuples(*[st.integers(1, 4)] * 3),
        elements=st.integers(0, 3),
    ),
    isovalue=st.sampled_from([0, 1, 1.5, 2, 3, 4]),
)
@settings(max_examples=60)
def test_both_give_the_same_arrays_with_ties_and_integers(
    rule: DualRule, values: Array, isovalue: float
) -> None:
    assert_same(rule, Field.of(values), isovalue)


@RULES
def test_layout_and_byte_order_make_no_difference(rule: DualRule) -> None:
    """The same samples give the same arrays, however they lie in memory."""
    plain = np.random.default_rng(11).normal(size=(7, 9, 10)).astype(np.float32)
    spread = np.zeros((14, 9, 20), np.float32)
    spread[::2, :, ::2] = plain
    mesh = surface(rule, Field.of(plain), 0.1)
    assert len(mesh.simplices) > 100
    for same in (np.asfortranarray(plain), plain.astype(">f4"), spread[::2, :, ::2]):
        other = surface(rule, Field.of(same), 0.1)
        np.testing.assert_array_equal(mesh.vertices, other.vertices)
        np.testing.assert_array_equal(mesh.simplices, other.simplices)


@RULES
def test_the_catalogue_holds_the_fast_one(rule: DualRule) -> None:
    field = Field.of(np.random.default_rng(2).normal(size=(5, 5, 5)))
    mesh, plain = METHODS[rule.name](field, 0.0), dual.surface(rule, field, 0.0)
    assert len(mesh.simplices) > 50
    np.testing.assert_array_equal(mesh.simplices, plain.simplices)


@RULES
def test_what_is_no_volume_is_refused(rule: DualRule) -> None:
    with pytest.raises(FieldError, match="3-D lattice"):
        surface(rule, Field.of(np.zeros((3, 3))), 0)
    with pytest.raises(FieldError, match="not finite"):
        surface(rule, Field.of(np.zeros((3, 3, 3))), float("nan"))
