"""Which triangles meet: beside linear programming, beside MeshLab, and known cases."""

from itertools import combinations

import numpy as np
import pymeshlab
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from isograde.oracles.bounded import integers
from isograde.oracles.self_intersections import (
    _apart,
    _apart_at_edge,
    _apart_at_vertex,
    _ask,
    _parted,
    _planes,
    _shared_first,
    near_pairs,
    self_intersections,
)
from isoref.field import Field, Floats, Integers
from isoref.methods import METHODS
from scipy.optimize import linprog

ONE: list[list[float]] = [[0.0, 0, 0], [4, 0, 0], [0, 4, 0]]


def meet(one: list[list[float]], other: list[list[float]]) -> bool:
    """Whether two triangles, corners of equal coordinates being one, are named as a pair."""
    points, names = np.unique(np.array([*one, *other], float), axis=0, return_inverse=True)
    return len(self_intersections(points, names.reshape(2, 3))) == 1


WAYS: list[tuple[list[list[float]], bool]] = [
    ([[1, 1, -1], [1, 1, 1], [9, 9, 0]], True),  # pierces
    ([[1, 1, 0], [1, 1, 1], [9, 9, 1]], True),  # touches with a corner
    ([[2, 2, -1], [2, 2, 1], [9, 9, 0]], True),  # touches with a side
    ([[1, 1, 1e-9], [1, 1, 1], [9, 9, 1]], False),  # hangs above
    ([[1, 1, 0], [9, 9, 0], [9, 8, 0]], True),  # overlaps in the plane
    ([[3, 3, 0], [9, 9, 0], [9, 8, 0]], False),  # beside it in the plane
    ([[0, 0, 0], [-1, 0, 0], [0, -1, 0]], False),  # shares a corner, in the plane
    ([[0, 0, 0], [1, 1, 0], [-1, 1, 0]], True),  # shares a corner and overlaps
    ([[0, 0, 0], [9, 9, 0], [9, 9, 1]], True),  # shares a corner, runs along the inside
    ([[0, 0, 0], [1, 1, 1], [1, 1, -1]], True),  # shares a corner and pierces
    ([[0, 0, 0], [1, 1, 1], [1, 1, 2]], False),  # shares a corner
    ([[0, 0, 0], [2, 0, 0], [0, 0, 1]], True),  # shares a corner, half a side lies on a side
    ([[0, 0, 0], [4, 0, 0], [0, 0, 1]], False),  # shares an edge
    ([[0, 0, 0], [4, 0, 0], [1, -1, 0]], False),  # shares an edge, in the plane
    ([[0, 0, 0], [4, 0, 0], [1, 1, 0]], True),  # folded back
    ([[1, 1, 0], [1, 1, 0], [1, 1, 1]], False),  # no triangle
    ([[1, 1, -1], [1, 1, 0], [1, 1, 1]], False),  # without area
    (ONE, False),  # the same: another claim's
]


@pytest.mark.parametrize(("other", "expected"), WAYS)
def test_pairs_meet_in_what_they_share_or_are_named(
    other: list[list[float]], expected: bool
) -> None:
    """Each way to meet, with nothing, a vertex and an edge in common."""
    assert meet(ONE, other) is expected


corner = st.tuples(*[st.integers(-3, 3)] * 3)


@settings(max_examples=200)
@given(st.lists(corner, min_size=6, max_size=6), st.integers(0, 2))
def test_pairs_are_those_of_linear_programming(places: list[tuple[int, ...]], shared: int) -> None:
    """Two triangles of small whole numbers, ties of every kind among them."""
    places = [*places[:3], *places[:shared], *places[3 + shared :]]
    one, other = np.array(places[:3], float), np.array(places[3:], float)
    if len(np.unique(places, axis=0)) < 6 - shared or _area(one) == 0 or _area(other) == 0:
        return
    assert meet(one.tolist(), other.tolist()) is feasible(one, other, shared)


def _area(triangle: Floats) -> float:
    """The length of the normal."""
    return float(np.linalg.norm(np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])))


def feasible(one: Floats, other: Floats, shared: int) -> bool:
    """Whether a point outside what is shared is a mean of the corners of both.

    Sum w_i p_i = sum u_j q_j with weights that are positive and add up to one; the most weight that
    can be on corners of the first that are not shared tells.
    """
    equal = np.block([[one.T, -other.T], [np.ones((1, 3)), np.zeros((1, 3))]])
    equal = np.vstack([equal, np.r_[np.zeros(3), np.ones(3)]])
    free = np.r_[np.arange(3) >= shared, np.arange(3) >= shared].astype(float)
    found = linprog(-free, A_eq=equal, b_eq=[0, 0, 0, 1, 1])
    return found.status == 0 and bool(free @ found.x > 1e-6)


def by_meshlab(points: Floats, faces: Integers) -> set[int]:
    """The faces that MeshLab's filter selects."""
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(points, faces.astype(np.int32)))
    meshes.compute_selection_by_self_intersections_per_face()
    return set(np.flatnonzero(meshes.current_mesh().face_selection_array()).tolist())


@pytest.mark.parametrize("shift", [0.21, 0.9, 3.3])
def test_faces_are_those_of_meshlab(shift: float) -> None:
    """Two spheres that cut through each other, or do not."""
    ball = np.linalg.norm(
        np.stack(np.meshgrid(*[np.arange(9.0)] * 3, indexing="ij")) - 4.03, axis=0
    )
    mesh = METHODS["trilinear-cubes"](Field.of(3.1 - ball), 0.0)
    moved = mesh.vertices + shift * np.array([1, 0.37, 0.51])
    points = np.concatenate([mesh.vertices, moved])
    faces = np.concatenate([mesh.simplices, mesh.simplices + len(moved)])
    found = self_intersections(points, faces)
    assert set(found.reshape(-1).tolist()) == by_meshlab(points, faces)
    assert len(found) > 0


@pytest.mark.parametrize("few", [0, 48])
def test_bins_miss_no_pair(few: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Triangles of all sizes, compared with every pair by itself; with bins, and without."""
    monkeypatch.setattr("isograde.oracles.self_intersections.FEW", few)
    rng = np.random.default_rng(0)
    points = rng.normal(size=(16, 1, 3)) + rng.lognormal(0, 1, (16, 1, 1)) * rng.normal(
        size=(16, 3, 3)
    )
    corners = points.reshape(-1, 3)
    found = self_intersections(corners, np.arange(48).reshape(16, 3))
    expected = [(i, j) for i, j in combinations(range(16), 2) if meet(points[i], points[j])]
    assert [tuple(pair) for pair in found.tolist()] == expected
    assert len(expected) > 5


@pytest.mark.parametrize("few", [0, 48])
@pytest.mark.parametrize("corners", [2, 3])
def test_boxes_that_meet_are_a_pair_once(
    few: int, corners: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In however many bins they meet; triangles and segments; on lattices, where boxes touch."""
    monkeypatch.setattr("isograde.oracles.self_intersections.FEW", few)
    random = np.random.default_rng(corners)
    for count in (1, 5, 40):
        points = random.integers(0, 6, (count * corners, 3)) / 2.0
        faces = np.arange(count * corners).reshape(count, corners)
        found = [pair for some in near_pairs(points, faces) for pair in map(tuple, some.tolist())]
        low, high = points[faces].min(axis=1), points[faces].max(axis=1)
        expected = [
            (i, j)
            for i, j in combinations(range(count), 2)
            if (low[i] <= high[j]).all() and (low[j] <= high[i]).all()
        ]
        assert sorted(found) == expected
    assert len(expected) > 50


def test_an_empty_mesh_has_none() -> None:
    """And neither has one without triangles, or with one."""
    nothing = np.empty((0, 3), np.int64)
    assert len(self_intersections(np.empty((0, 3)), nothing)) == 0
    assert len(self_intersections(np.eye(3), np.array([[0, 1, 2]]))) == 0


@pytest.mark.parametrize("shared", [0, 1, 2])
@pytest.mark.parametrize("whole", [True, False])
def test_what_floating_point_parts_is_apart_in_integers(shared: int, whole: bool) -> None:
    """The filter beside the exact question it spares; on triangles without ties it is rarely open.

    The shared corners stand anywhere among a triangle's three, in either order.
    """
    random = np.random.default_rng(shared)
    count = 3000
    points = random.integers(-2, 3, (count, 6, 3)) if whole else random.normal(size=(count, 6, 3))
    rows = 6 * np.arange(count)[:, None]
    one, other = np.array([0, 1, 2]) + rows, np.array([0, 1, 2]) + rows
    other[:, shared:] = np.arange(3, 6 - shared) + rows
    faces = random.permuted(np.concatenate([one, other]), axis=1)
    pairs = np.stack([np.arange(count), np.arange(count, 2 * count)], axis=1)
    places = points.reshape(-1, 3).astype(np.float64)
    parted = _parted(places, faces, _planes(places, faces), pairs)
    corners, found = _shared_first(faces[pairs])
    assert (found == shared).all()
    exact = integers(places[corners].reshape(-1, 18))
    apart = _ask((_apart, _apart_at_vertex, _apart_at_edge)[shared], exact)
    assert parted.any()
    assert not (parted & ~apart).any()
    if not whole:
        assert np.array_equal(parted, apart)
