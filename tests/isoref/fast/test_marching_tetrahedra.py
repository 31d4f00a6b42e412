"""The vectorised marching tetrahedra give the mesh of the article."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from isoref import marching_tetrahedra
from isoref.fast.marching_tetrahedra import surface
from isoref.field import Array, Field
from isoref.marching_tetrahedra import Split
from isoref.mesh import Mesh
from isoref.methods import SPLITS

EVERY = pytest.mark.parametrize("split", SPLITS.values(), ids=list(SPLITS))


def corners(mesh: Mesh) -> list[list[float]]:
    """The nine coordinates of each triangle's corners, in order."""
    listed: list[list[float]] = mesh.vertices[mesh.simplices].reshape(-1, 9).tolist()
    return listed


@EVERY
@pytest.mark.parametrize("shape", [(2, 2, 2), (3, 2, 2), (5, 6, 7), (4, 9, 3), (1, 4, 4)])
def test_both_give_the_same_mesh_on_noise(split: Split, shape: tuple[int, int, int]) -> None:
    """Number for number, up to the numbering of the vertices; triangles in the same order."""
    values = np.random.default_rng(7).normal(size=shape)
    field = Field.of(values, (1, 2, 0.5), (3, -1, 2))
    fast, plain = surface(split, field, 0.1), marching_tetrahedra.surface(split, field, 0.1)
    assert len(fast.simplices) > 0 or min(shape) == 1
    assert corners(fast) == corners(plain)
    np.testing.assert_array_equal(fast.canonical().vertices, plain.canonical().vertices)
    np.testing.assert_array_equal(fast.canonical().simplices, plain.canonical().simplices)


@EVERY
@given(
    values=hnp.arrays(
        st.sampled_from([np.uint8, np.int16, np.float32]),
        st.tuples(*[st.integers(2, 4)] * 3),
        elements=st.integers(0, 3),
    ),
    isovalue=st.sampled_from([0, 1, 1.5, 2, 3, 4]),
)
@settings(max_examples=40)
def test_both_put_every_triangle_in_place_with_ties(
    split: Split, values: Array, isovalue: float
) -> None:
    """Vertices may coincide there: their number and the corners' positions are compared."""
    field = Field.of(values)
    fast, plain = (
        surface(split, field, isovalue),
        marching_tetrahedra.surface(split, field, isovalue),
    )
    assert len(fast.vertices) == len(plain.vertices)
    assert corners(fast) == corners(plain)


@EVERY
def test_layout_and_byte_order_make_no_difference(split: Split) -> None:
    plain = np.random.default_rng(11).normal(size=(7, 9, 10)).astype(np.float32)
    spread = np.zeros((14, 9, 20), np.float32)
    spread[::2, :, ::2] = plain
    mesh = surface(split, Field.of(plain), 0.1)
    assert len(mesh.simplices) > 100
    for same in (np.asfortranarray(plain), plain.astype(">f4"), spread[::2, :, ::2]):
        other = surface(split, Field.of(same), 0.1)
        np.testing.assert_array_equal(mesh.vertices, other.vertices)
        np.testing.assert_array_equal(mesh.simplices, other.simplices)
