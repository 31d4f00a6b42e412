import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from isoref.mesh import Mesh


@pytest.mark.parametrize("bad", [[[0, 1, 3]], [[-1, 0, 1]]])
def test_an_index_out_of_range_is_refused(bad: list[list[int]]) -> None:
    """The message names the indices and the number of vertices."""
    with pytest.raises(ValueError, match="there are 3 vertices"):
        Mesh.of(np.zeros((3, 3)), bad)


@given(k=st.integers(1, 4), seed=st.integers(0, 2**32 - 1))
def test_canonical_forms_agree_however_the_mesh_is_numbered(k: int, seed: int) -> None:
    """Renumbered vertices, reordered simplices and even permutations change nothing."""
    random = np.random.default_rng(seed)
    vertices = random.normal(size=(8, 3))
    simplices = np.array([random.permutation(8)[: k + 1] for _ in range(5)])
    order = random.permutation(8)
    renumbered = np.argsort(order)[simplices][random.permutation(5)]
    if k >= 2:
        renumbered[:, :3] = np.roll(renumbered[:, :3], 1, axis=1)
    a = Mesh.of(vertices, simplices).canonical()
    b = Mesh.of(vertices[order], renumbered).canonical()
    assert np.array_equal(a.vertices, b.vertices)
    assert np.array_equal(a.simplices, b.simplices)


@pytest.mark.parametrize("k", [1, 2, 3, 4])
def test_canonical_form_keeps_the_orientation(k: int) -> None:
    """An odd permutation of a simplex is another simplex."""
    vertices = np.random.default_rng(0).normal(size=(k + 1, 3))
    there = np.arange(k + 1)[None]
    back = there.copy()
    back[0, :2] = back[0, 1::-1]
    a, b = Mesh.of(vertices, there).canonical(), Mesh.of(vertices, back).canonical()
    assert not np.array_equal(a.simplices, b.simplices)


@pytest.mark.parametrize("arrays", [(np.zeros(3), [[0, 1]]), (np.zeros((3, 3)), [0, 1])])
def test_arrays_of_one_axis_are_refused(arrays: tuple[object, object]) -> None:
    """Both the vertices and the simplices have a row each."""
    with pytest.raises(ValueError, match="must have two axes"):
        Mesh.of(*arrays)  # type: ignore[arg-type]


def test_a_mesh_without_simplices_is_a_mesh() -> None:
    """With vertices and without."""
    assert len(Mesh.of(np.zeros((3, 3)), np.empty((0, 3))).canonical().simplices) == 0
    assert len(Mesh.of(np.empty((0, 3)), np.empty((0, 3))).vertices) == 0


@pytest.mark.parametrize("k", [1, 2, 3, 4])
def test_canonical_form_is_the_same_mesh(k: int) -> None:
    """The same vertices in sorted order; the same oriented simplices on them."""
    random = np.random.default_rng(k)
    mesh = Mesh.of(random.normal(size=(9, k)), [random.permutation(9)[: k + 1] for _ in range(12)])
    found = mesh.canonical()
    assert found.vertices.tolist() == sorted(mesh.vertices.tolist())
    sizes = [
        {
            frozenset(map(tuple, place)): round(float(np.linalg.det(np.diff(place, axis=0))), 9)
            for place in m.vertices[m.simplices].tolist()
        }
        for m in (mesh, found)
    ]
    assert sizes[0] == sizes[1]
    if k == 2:
        assert (found.simplices[:, :1] <= found.simplices).all()
