"""Variants pose the same case in another way, and say how to come back."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from isograde import variants
from isograde.model import Case, Kind
from isograde.variants import Variant, named, variant
from isoref.field import Field

FIELD = Field.of(
    np.random.default_rng(0).integers(0, 200, (3, 4, 5)).astype(float),
    (0.5, 1.0, 2.0),
    (1.0, 2.0, 3.0),
)
KINDS = [Kind(1, 1), Kind(2, 1), Kind(3, 1), Kind(3, 2), Kind(4, 2)]
SYMMETRIES = [variant(name, Kind(3, 1)) for name in named(["symmetry/"], Kind(3, 1))]
SAME = ("repeat", "spacing", "fortran", "strided", "backwards", "float32", "int16", "uint8")


def pose(name: str, field: Field, isovalue: float) -> tuple[Field, float] | None:
    """The variant of a field of one component, with its one isovalue."""
    kind = Kind(field.dimension, 1)
    posed = variants.pose(name, Case("test", lambda: field, (isovalue,), 1, kind=kind), field)
    return None if posed is None else (posed[0], posed[1][0])


def several(kind: Kind) -> Field:
    """A small field of this kind, no two numbers of it alike."""
    shape = (3, 4, 2, 3)[: kind.n]
    values = np.arange(float(kind.m * np.prod(shape))).reshape(kind.m, *shape)
    values = np.sin(values * 7.7)
    return Field.of(values if kind.m > 1 else values[0], dimension=kind.n)


@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_every_variant_brings_every_sample_of_every_kind_back(kind: Kind) -> None:
    """The values at an index of the variant are those at the index it is brought back to."""
    field = several(kind)
    case = Case("test", lambda: field, (0.0,) * kind.m, 1, kind=kind)
    parts = field.values if kind.m > 1 else field.values[None]
    names = named(["symmetry/", "translate", "translate-2", "spacing", "components"], kind)
    assert len(names) >= 4
    for name in names:
        posed = variants.pose(name, case, field)
        assert posed is not None
        there = posed[0].values if kind.m > 1 else posed[0].values[None]
        index = np.argwhere(np.ones(posed[0].shape, bool))
        plain = variant(name, kind).back(index.astype(float), field).astype(int)
        kept = ((plain >= 0) & (plain < field.shape)).all(axis=1)
        assert kept.sum() == np.prod(field.shape)
        ours = parts[(slice(None), *plain[kept].T)]
        theirs = there[(slice(None), *index[kept].T)]
        assert np.array_equal(ours[::-1] if name == "components" else ours, theirs)


@pytest.mark.parametrize(("n", "count"), [(1, 1), (2, 7), (3, 47), (4, 7), (5, 9)])
def test_symmetries_of_few_axes_are_all_there_and_of_many_their_generators(
    n: int, count: int
) -> None:
    """2^n n! less the plain one; n - 1 exchanges of neighbours and n mirrors beyond three axes."""
    assert len(named(["symmetry/"], Kind(n, 1))) == count


def test_the_components_of_two_fields_change_places_with_their_isovalues() -> None:
    """And the curve in which they meet is turned over."""
    field = several(Kind(3, 2))
    case = Case("test", lambda: field, (0.25, 0.5), 1, kind=Kind(3, 2))
    posed = variants.pose("components", case, field)
    assert posed is not None
    assert np.array_equal(posed[0].values, field.values[::-1])
    assert posed[1] == (0.5, 0.25)
    assert variant("components", Kind(3, 2)).reflects
    assert "components" not in named(["components"], Kind(3, 1))


def test_there_are_48_symmetries_with_the_plain_one() -> None:
    """Six orders of the axes, eight ways to mirror them; half of all reflect."""
    assert len({v.name for v in SYMMETRIES}) == 47
    assert sum(v.reflects for v in SYMMETRIES) == 24


@pytest.mark.parametrize(
    "one", [*SYMMETRIES, variant("translate", Kind(3, 1))], ids=lambda v: v.name
)
def test_the_way_back_finds_every_sample(one: Variant) -> None:
    """The value at an index of the variant is the value at the index it is brought back to."""
    posed = one.pose(FIELD, (0.5,))
    assert posed is not None
    field, isovalues = posed
    assert isovalues == (0.5,)
    index = np.argwhere(np.ones(field.shape, bool))
    plain = one.back(index.astype(float), FIELD).astype(int)
    kept = ((plain >= 0) & (plain < FIELD.shape)).all(axis=1)
    assert kept.sum() == FIELD.values.size
    ours, theirs = FIELD.values[tuple(plain[kept].T)], field.values[tuple(index[kept].T)]
    assert np.array_equal(ours, theirs)


@pytest.mark.parametrize("one", SYMMETRIES, ids=lambda v: v.name)
def test_a_variant_reflects_where_its_way_back_has_a_negative_determinant(one: Variant) -> None:
    """Faces must be turned over exactly then."""
    origin = one.back(np.zeros((1, 3)), FIELD)
    matrix = one.back(np.eye(3), FIELD) - origin
    assert (np.linalg.det(matrix) < 0) == one.reflects


@pytest.mark.parametrize("name", SAME)
def test_layout_and_type_keep_the_numbers(name: str) -> None:
    """The same values at the same indices."""
    posed = pose(name, FIELD, 99.5)
    assert posed is not None
    assert np.array_equal(posed[0].values, FIELD.values)
    assert posed[1] == 99.5


def test_layouts_are_not_contiguous() -> None:
    """None of them is what an implementation is usually given."""
    for name in ("fortran", "strided", "backwards"):
        posed = pose(name, FIELD, 0.0)
        assert posed is not None
        assert not posed[0].values.flags.c_contiguous


def test_values_that_a_type_does_not_hold_are_not_posed() -> None:
    """Halves are no integers, 300 is no byte, and a third is not in single precision."""
    assert pose("int16", Field.of(np.full((2, 2, 2), 0.5)), 0.0) is None
    assert pose("uint8", Field.of(np.full((2, 2, 2), 300.0)), 0.0) is None
    assert pose("uint8", Field.of(np.resize([0.0, 300.0], (2, 2, 2))), 0.0) is None
    assert pose("float32", Field.of(np.full((2, 2, 2), 1 / 3)), 0.0) is None
    assert pose("float64", FIELD, 0.0) is None


@given(st.lists(st.floats(-1e6, 1e6), min_size=8, max_size=8), st.floats(-1e3, 1e3))
def test_a_shift_keeps_every_sample_on_its_side(values: list[float], isovalue: float) -> None:
    """Or is not posed."""
    field = Field.of(np.reshape(values, (2, 2, 2)))
    posed = pose("shift", field, isovalue)
    assume(posed is not None)
    assert posed is not None
    before, after = field.values - isovalue, posed[0].values - posed[1]
    assert np.array_equal(np.sign(before), np.sign(after))


def test_a_shift_that_makes_a_tie_is_not_posed() -> None:
    """A difference of 1e-30 is lost beside 1."""
    values = np.ones((2, 2, 2))
    values[0, 0, 0] = 1e-30
    assert pose("shift", Field.of(values), 0.0) is None


def test_bad_input_is_bad() -> None:
    """A NaN, a plane, nothing, and no isovalue."""
    posed = {name: pose(name, FIELD, 0.5) for name in ("nan", "rank", "no-samples")}
    fields = {name: p[0] for name, p in posed.items() if p is not None}
    assert np.isnan(fields["nan"].values).sum() == 1
    assert fields["rank"].values.ndim == 2
    assert fields["no-samples"].values.size == 0
    nothing = pose("isovalue-nan", FIELD, 0.5)
    assert nothing is not None
    assert np.isnan(nothing[1])


def test_isovalues_beyond_all_samples() -> None:
    """Above and below."""
    above, below = pose("above", FIELD, 0.5), pose("below", FIELD, 0.5)
    assert above is not None
    assert below is not None
    assert above[1] > FIELD.values.max()
    assert below[1] < FIELD.values.min()


def test_a_shift_moves_values_and_isovalue_by_one_power_of_two() -> None:
    """The least that is as large as the largest difference from the isovalue."""
    posed = pose("shift", FIELD, 99.5)
    assert posed is not None
    largest = float(np.abs(FIELD.values - 99.5).max())
    assert 64 < largest <= 128
    assert set((posed[0].values - FIELD.values).ravel().tolist()) == {128.0}
    assert posed[1] == 99.5 + 128


def test_a_levelled_field_keeps_sides_and_order_and_little_else() -> None:
    """Each sample about 1 from the isovalue 0, in its old order."""
    posed = pose("level", FIELD, 99.5)
    assert posed is not None
    field, isovalue = posed
    assert isovalue == 0.0
    assert np.array_equal(field.values > 0, FIELD.values > 99.5)
    assert 0 < np.abs(np.abs(field.values) - 1).max() <= 2.0**-12
    assert np.array_equal(
        np.unique(field.values.ravel(), return_inverse=True)[1],
        np.unique(FIELD.values.ravel(), return_inverse=True)[1],
    )


def test_a_translated_field_has_a_rim_of_one_sample_before_and_two_after() -> None:
    """It repeats what is beside it."""
    posed = pose("translate", FIELD, 0.5)
    assert posed is not None
    assert posed[0].shape == tuple(n + 3 for n in FIELD.shape)
    nearest = [np.clip(np.arange(-1, n + 2), 0, n - 1) for n in FIELD.shape]
    assert np.array_equal(posed[0].values, FIELD.values[np.ix_(*nearest)])


@pytest.mark.parametrize("field", [FIELD, Field.of(np.full((2, 2, 2), 3.0))])
def test_an_isovalue_out_of_range_is_outside_the_samples(field: Field) -> None:
    """By 1 at least, also of a field that is constant."""
    above, below = pose("above", field, 3.0), pose("below", field, 3.0)
    assert above is not None
    assert below is not None
    assert above[1] >= field.values.max() + 1
    assert below[1] <= field.values.min() - 1
    assert np.array_equal(above[0].values, field.values)


def test_a_plane_is_one_that_crosses_the_isovalue_with_its_own_spacing() -> None:
    """The first; none where no plane has values on both sides."""
    values = np.zeros((3, 2, 2))
    values[1, 0, 0] = 1.0
    posed = pose("rank", Field.of(values, (0.5, 1.0, 2.0), (1.0, 2.0, 3.0)), 0.5)
    assert posed is not None
    assert posed[0].values.tolist() == values[1].tolist()
    assert (posed[0].spacing, posed[0].origin) == ((1.0, 2.0), (2.0, 3.0))
    assert pose("rank", Field.of(np.zeros((2, 2, 2))), 0.5) is None
