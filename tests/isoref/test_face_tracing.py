"""The isosurface by its points on m-faces: a second way to what successive cutting makes."""

from fractions import Fraction

import numpy as np
import pytest
from isograde.oracles.complexes import Complex
from isoref.face_tracing import (
    Face,
    Traced,
    all_of,
    every_face,
    exact,
    inside,
    split_face,
    trace,
)
from isoref.fast.simplicial import extract
from isoref.field import Field, FieldError
from isoref.kuhn import chains, corner_offsets

CASES = [
    ((6, 5), 1),
    ((6, 5), 2),
    ((4, 5, 4), 1),
    ((4, 4, 4), 2),
    ((4, 4, 4), 3),
    ((3, 3, 3, 3), 1),
    ((3, 3, 3, 3), 2),
    ((3, 3, 3, 3), 3),
]


def noise(shape: tuple[int, ...], m: int, seed: int = 0) -> Field:
    """Noise of m components on this lattice."""
    values = np.random.default_rng(seed).normal(size=(m, *shape))
    return Field.of(values, dimension=len(shape))


def test_faces_and_cofaces_are_those_of_the_simplices_of_a_cube() -> None:
    """In a cube of dimension 3: the faces by partitions are the subsets of the six simplices."""
    corners = corner_offsets(3)
    simplices = [frozenset(map(tuple, corners[chain].tolist())) for chain in chains(3)]
    for d in range(4):
        by_partition = {frozenset(face.vertices()) for face in every_face((2, 2, 2), d)}
        by_subset = {
            frozenset(subset)
            for simplex in simplices
            for subset in _subsets(sorted(simplex), d + 1)
        }
        assert by_partition == by_subset
        for face in every_face((2, 2, 2), d):
            below = [frozenset(f.vertices()) for f in face.facets()] if d else []
            assert (
                sorted(map(sorted, below))
                == sorted(sorted(set(face.vertices()) - {v}) for v in face.vertices())[: len(below)]
            )


def _subsets(items: list[tuple[int, ...]], size: int) -> list[tuple[tuple[int, ...], ...]]:
    """The subsets of this size."""
    from itertools import combinations

    return list(combinations(items, size))


def test_cofaces_are_the_faces_above() -> None:
    """On a lattice of dimension 3: a face is a coface of another if and only if it holds it."""
    shape = (3, 3, 3)
    for d in range(3):
        above = {face: frozenset(face.vertices()) for face in every_face(shape, d + 1)}
        for face in list(every_face(shape, d))[:40]:
            own = frozenset(face.vertices())
            wanted = {other for other, vertices in above.items() if own < vertices}
            found = [other for other in face.cofaces() if inside(other, shape)]
            assert len(found) == len(set(found))
            assert set(found) == wanted


@pytest.mark.parametrize(("shape", "m"), CASES)
def test_points_on_m_faces_are_vertices_of_the_mesh_by_cutting(
    shape: tuple[int, ...], m: int
) -> None:
    """Every one of them; they are all where m = 1, else a cut adds points on its own edges."""
    field = noise(shape, m)
    found, mesh = all_of(field), extract(field)
    points = np.array(list(found.points.values()))
    assert len(points) > 3
    nearest = np.abs(mesh.vertices[:, None] - points).max(axis=2).min(axis=0)
    assert nearest.max() < 1e-9
    if m == 1:
        assert len(points) == len(mesh.vertices)


@pytest.mark.parametrize(("shape", "m"), CASES)
def test_euler_characteristics_by_both_ways_agree(shape: tuple[int, ...], m: int) -> None:
    """The complex of polytopes and the complex of simplices are one set."""
    field = noise(shape, m, 1)
    mesh = extract(field)
    assert all_of(field).euler() == Complex(mesh.vertices, mesh.simplices).euler


@pytest.mark.parametrize(("shape", "m"), CASES)
def test_the_order_of_components_changes_no_point(shape: tuple[int, ...], m: int) -> None:
    """Successive cutting depends on it, tracing does not."""
    field = noise(shape, m, 2)
    turned = Field.of(field.values.reshape(m, *shape)[::-1].copy(), dimension=len(shape))
    one, other = all_of(field).points, all_of(turned).points
    assert one.keys() == other.keys()
    for face, point in one.items():
        np.testing.assert_allclose(point, other[face], atol=1e-12)


def test_each_face_above_has_two_crossed_faces_or_none() -> None:
    """Ties included: small whole numbers, decided by the infinitesimal."""
    values = np.random.default_rng(3).integers(-1, 2, (2, 4, 4, 4))
    field = Field.of(values, dimension=3)
    crossed = all_of(field).points
    numbers = {
        sum(facet in crossed for facet in face.facets()) for face in every_face(field.shape, 3)
    }
    assert numbers == {0, 2}


def test_tracing_from_one_face_finds_its_component_and_no_other() -> None:
    """Two circles in the plane: from a face of one, that one."""
    i, j = np.indices((7, 15)).astype(float)
    rings = np.minimum((i - 3) ** 2 + (j - 3.1) ** 2, (i - 3) ** 2 + (j - 11.2) ** 2)
    field = Field.of(rings)
    whole = all_of(field, 4.3)
    seed = min(whole.points)
    part = trace(exact(field, 4.3), 1, field.shape, [seed])
    assert 0 < len(part.points) < len(whole.points)
    assert set(part.points) < set(whole.points)
    assert (part.euler(), whole.euler()) == (0, 0)


def test_a_curve_in_dimension_eight_is_traced() -> None:
    """With n = 8, m = 7: a straight line through a lattice too large to list, from one seed."""
    n, N = 8, 60
    shape = (N,) * n
    asked = 0

    def value(vertex: tuple[int, ...]) -> tuple[Fraction, ...]:
        nonlocal asked
        asked += 1
        return tuple(Fraction(10 * (vertex[i + 1] - vertex[0]) + i + 1, 7) for i in range(n - 1))

    # On the line x_(i+1) = x_0 - (i + 1) / 10 the first axis leads: climb it first, then the rest.
    base = (30, *[29] * (n - 1))
    order = [1 << axis for axis in range(1, n)]
    seeds = [Face(base, (*order, 1 << n | 1))]
    found = trace(value, n - 1, shape, seeds)
    assert len(found.points) > 100
    places = np.array(list(found.points.values()))
    expected = places[:, :1] - np.arange(1, n) / 10
    np.testing.assert_allclose(places[:, 1:], expected, atol=1e-12)
    assert places[:, 0].min() < 2
    assert places[:, 0].max() > N - 3
    assert asked < 10**6


def test_nothing_crossed_is_nothing() -> None:
    """An empty isosurface has no cells."""
    found = all_of(Field.of(np.ones((3, 3))))
    assert isinstance(found, Traced)
    assert found.points == {}
    assert found.euler() == 0


def test_more_components_than_axes_are_refused() -> None:
    """As by `isoref.simplicial`."""
    with pytest.raises(FieldError, match="m <= n"):
        all_of(Field.of(np.zeros((3, 4, 4)), dimension=2))


def test_a_walk_is_written_with_the_rest_last() -> None:
    """Bit n marks the rest; a step that ends at the base begins the face."""
    assert split_face((1, 1), (0b01, 0b110), 2) == Face((1, 1), (0b01, 0b110))
    assert split_face((1, 1), (0b101, 0b10), 2) == Face((1, 0), (0b10, 0b101))
