"""The vectorised sweep gives the mesh of the article, whatever the samples and their layout."""

from collections.abc import Callable

import isoref.fast.sweep
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from isoref.fast.sweep import sweep, sweep_with_cells
from isoref.field import Array, Field, FieldError
from isoref.mesh import Mesh
from isoref.methods import RULES
from isoref.rule import Rule
from isoref.sweep import sweep as sweep_plain
from isoref.sweep import sweep_with_cells as sweep_plain_with_cells

Carry = Callable[[Rule, Field, float], Mesh]


def assert_same(a: Mesh, b: Mesh) -> None:
    """Both meshes are equal, number for number, up to the numbering of vertices."""
    a, b = a.canonical(), b.canonical()
    assert np.array_equal(a.vertices, b.vertices)
    assert np.array_equal(a.simplices, b.simplices)


def corners(mesh: Mesh) -> list[list[float]]:
    """The nine coordinates of each triangle's corners."""
    listed: list[list[float]] = mesh.vertices[mesh.simplices].reshape(-1, 9).tolist()
    return listed


@pytest.mark.parametrize("rule", RULES.values(), ids=list(RULES))
@pytest.mark.parametrize("shape", [(2, 2, 2), (3, 2, 2), (5, 6, 7), (4, 9, 3)])
@pytest.mark.parametrize("slab_points", [10, 130, 1 << 20])
def test_both_sweeps_give_the_same_mesh_on_noise(
    rule: Rule, shape: tuple[int, int, int], slab_points: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every fast path has a plain twin; wherever slabs and blocks of cells are cut."""
    monkeypatch.setattr(isoref.fast.sweep, "SLAB_POINTS", slab_points)
    monkeypatch.setattr(isoref.fast.sweep, "PART_CELLS", min(slab_points, 1 << 14))
    values = np.random.default_rng(7).normal(size=shape)
    field = Field.of(values, spacing=(1, 2, 0.5), origin=(3, -1, 2))
    assert_same(sweep(rule, field, 0.1), sweep_plain(rule, field, 0.1))


@pytest.mark.parametrize("rule", RULES.values(), ids=list(RULES))
@given(
    values=hnp.arrays(
        st.sampled_from([np.uint8, np.int16, np.float32]),
        st.tuples(*[st.integers(2, 4)] * 3),
        elements=st.integers(0, 3),
    ),
    isovalue=st.sampled_from([0, 1, 1.5, 2, 3, 4]),
)
@settings(max_examples=40)
def test_both_sweeps_put_every_triangle_in_place_with_ties(
    rule: Rule, values: Array, isovalue: float
) -> None:
    """Samples on the isovalue and integer types are no exception.

    Vertices may coincide there, so triangles are compared by their corners' positions.
    """
    field = Field.of(values)
    fast, plain = sweep(rule, field, isovalue), sweep_plain(rule, field, isovalue)
    assert len(fast.vertices) == len(plain.vertices)
    assert sorted(map(tuple, corners(fast))) == sorted(map(tuple, corners(plain)))


@pytest.mark.parametrize("slab_points", [150, 1 << 20])
def test_layout_and_byte_order_make_no_difference(
    slab_points: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same samples give the same arrays, however they lie in memory."""
    monkeypatch.setattr(isoref.fast.sweep, "SLAB_POINTS", slab_points)
    plain = np.random.default_rng(11).normal(size=(7, 9, 10)).astype(np.float32)
    spread = np.zeros((14, 9, 20), np.float32)
    spread[::2, :, ::2] = plain
    rule = RULES["marching-vesta-mixed-H"]
    mesh = sweep(rule, Field.of(plain), 0.1)
    for same in (np.asfortranarray(plain), plain.astype(">f4"), spread[::2, :, ::2]):
        other = sweep(rule, Field.of(same), 0.1)
        assert np.array_equal(mesh.vertices, other.vertices)
        assert np.array_equal(mesh.simplices, other.simplices)


def test_triangles_come_in_the_order_of_their_cells() -> None:
    """`sweep_with_cells` names for each triangle the cell that holds its vertices."""
    values = np.random.default_rng(3).normal(size=(5, 4, 6))
    mesh, cells = sweep_with_cells(RULES["asymptotic-decider"], Field.of(values), 0.0)
    assert len(cells) > 100
    assert np.all(np.diff(cells) >= 0)
    assert np.array_equal(
        cells, sweep_plain_with_cells(RULES["asymptotic-decider"], Field.of(values), 0.0)[1]
    )
    low = np.stack(np.unravel_index(cells, (4, 3, 5)), axis=1)[:, None]
    points = mesh.vertices[mesh.simplices]
    assert np.all((low <= points) & (points <= low + 1))


@pytest.mark.parametrize("isovalue", [-1e9, 1e9, 300])
def test_an_isovalue_out_of_range_gives_an_empty_mesh(isovalue: float) -> None:
    """Design: an isovalue outside the range is no error."""
    field = Field.of(np.arange(8, dtype=np.uint8).reshape(2, 2, 2))
    mesh = sweep(RULES["asymptotic-decider"], field, isovalue)
    assert mesh.vertices.shape == (0, 3)
    assert mesh.simplices.shape == (0, 3)


@pytest.mark.parametrize("shape", [(1, 5, 5), (5, 1, 5), (1, 1, 1)])
def test_a_lattice_one_sample_thick_has_no_cells(shape: tuple[int, int, int]) -> None:
    """No cell, no surface."""
    field = Field.of(np.random.default_rng(0).normal(size=shape))
    for make in (sweep, sweep_plain):
        assert len(make(RULES["asymptotic-decider"], field, 0).simplices) == 0


@pytest.mark.parametrize("carry", [sweep, sweep_plain])
def test_a_field_that_is_no_volume_is_refused(carry: Carry) -> None:
    """Wrong rank: a clear error."""
    with pytest.raises(FieldError, match="3-D lattice"):
        carry(RULES["asymptotic-decider"], Field.of(np.zeros((3, 3))), 0)


@pytest.mark.parametrize("carry", [sweep, sweep_plain])
def test_an_isovalue_that_is_no_number_is_refused(carry: Carry) -> None:
    """NaN: a clear error."""
    with pytest.raises(FieldError, match="not finite"):
        carry(RULES["asymptotic-decider"], Field.of(np.zeros((3, 3, 3))), float("nan"))


@pytest.mark.parametrize("carry", [sweep, sweep_plain])
def test_one_component_may_have_an_axis_of_its_own(carry: Carry) -> None:
    """A scalar field may come as (1, N1, N2, N3): it is the same volume."""
    values = np.random.default_rng(3).normal(size=(3, 4, 5))
    rule = RULES["asymptotic-decider"]
    mesh, same = (
        carry(rule, Field.of(values), 0),
        carry(rule, Field.of(values[None], dimension=3), 0),
    )
    assert len(mesh.simplices) > 20
    assert_same(mesh, same)


def test_integers_beyond_what_a_float_holds_are_compared_exactly() -> None:
    """2^53 + 3 is below 2^53 + 4, though as a float it is not: outside, for both."""
    values = np.full((3, 3, 3), 2**53)
    values[1, 1, 1] = 2**53 + 3
    rule = RULES["asymptotic-decider"]
    for carry in (sweep, sweep_plain):
        assert len(carry(rule, Field.of(values), float(2**53 + 4)).simplices) == 0
    values[1, 1, 1] = 2**53 + 5
    fast, plain = (
        carry(rule, Field.of(values), float(2**53 + 4)) for carry in (sweep, sweep_plain)
    )
    assert len(fast.simplices) == 8
    assert sorted(corners(fast)) == sorted(corners(plain))


@pytest.mark.parametrize("size", [1.7e308, 1e-300, 2.0**-1000])
@pytest.mark.parametrize("carry", [sweep, sweep_plain])
def test_vertices_do_not_move_where_values_are_huge_or_tiny(carry: Carry, size: float) -> None:
    """The difference of two samples may overflow: the crossing is still halfway to the sample."""
    values = np.where(np.indices((3, 4, 3)).sum(axis=0) % 3, -1.0, 1.0) * [1.0, 0.5, 0.25]
    rule = RULES["asymptotic-decider"]
    plain = carry(rule, Field.of(values), 0.0)
    scaled = carry(rule, Field.of(values * size), 0.0)
    assert len(plain.vertices) > 10
    assert np.allclose(scaled.vertices, plain.vertices, rtol=0, atol=1e-12)
