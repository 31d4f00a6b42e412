"""Truths about meshes of simplices, checked a second way."""

from itertools import combinations
from math import factorial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from isograde.oracles import simplices as oracle
from scipy.spatial import ConvexHull, Delaunay


def hull(d: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A convex hull in R^d: a sphere of dimension d - 1."""
    points = np.random.default_rng(seed).normal(size=(6 + 2 * d, d))
    return points, ConvexHull(points).simplices.astype(np.int64)


@given(d=st.integers(2, 5), seed=st.integers(0, 99))
def test_hulls_are_closed_spheres(d: int, seed: int) -> None:
    """Counted with sets of sets, and by Qhull's own neighbours."""
    points, simplices = hull(d, seed)
    found = oracle.facets(simplices)
    counts: dict[frozenset[int], int] = {}
    for row in simplices.tolist():
        for face in combinations(row, d - 1):
            counts[frozenset(face)] = counts.get(frozenset(face), 0) + 1
    assert {
        frozenset(r): c for r, c in zip(found.rows.tolist(), found.owners, strict=True)
    } == counts
    assert (found.owners == 2).all()
    assert oracle.euler_characteristic(simplices) == 1 + (-1) ** (d - 1)
    assert oracle.components(simplices) == 1
    assert oracle.measures(points, simplices).sum() == pytest.approx(ConvexHull(points).area)


@given(seed=st.integers(0, 99))
def test_pieces_and_cycles_are_those_of_the_graph(seed: int) -> None:
    """Segments: components by merging sets, Euler characteristic by counting."""
    rng = np.random.default_rng(seed)
    pairs = sorted({tuple(sorted(rng.choice(12, 2, replace=False).tolist())) for _ in range(12)})
    pieces: list[set[int]] = []
    for pair in pairs:
        touched = [piece for piece in pieces if piece & set(pair)]
        pieces = [piece for piece in pieces if piece not in touched]
        pieces.append(set(pair).union(*touched))
    segments = np.array(pairs, np.int64)
    assert oracle.components(segments) == len(pieces)
    assert oracle.euler_characteristic(segments) == sum(map(len, pieces)) - len(segments)


@pytest.mark.parametrize("d", [2, 3, 4])
def test_parity_is_the_sign_of_the_permutation_matrix(d: int) -> None:
    """Against determinants."""
    rows = np.array([np.random.default_rng(i).permutation(d + 1) for i in range(20)])
    expected = [round(np.linalg.det(np.eye(d + 1)[row])) for row in rows]
    assert oracle.permutation_parity(rows).tolist() == expected


def test_two_cuts_of_a_square_are_covered_and_a_hole_is_not() -> None:
    """The square between two blocks, cut along either diagonal, and half of it missing."""
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    one, other = [[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]
    assert oracle.covered(square, np.array(one + other)).all()
    assert not oracle.covered(square, np.array(one)).any()
    shifted = np.vstack([square, square + np.array([0, 0, 0.01])])
    apart = np.array(one + [[a + 4, b + 4, c + 4] for a, b, c in other])
    assert not oracle.covered(shifted, apart).any()


@pytest.mark.parametrize("d", [2, 3, 4])
def test_a_simplex_contains_what_scipy_finds_in_it(d: int) -> None:
    """Against SciPy's point location."""
    rng = np.random.default_rng(d)
    corners = rng.normal(size=(d + 1, d))
    points = (rng.dirichlet(np.ones(d + 1), 200) * 1.6 - 0.6 / (d + 1)) @ corners
    inside = Delaunay(corners).find_simplex(points) >= 0
    found = oracle.contain(np.broadcast_to(corners, (200, d + 1, d)), points)
    np.testing.assert_array_equal(found, inside)
    assert inside.any()
    assert not inside.all()


@pytest.mark.parametrize("d", [2, 3, 4])
def test_signed_volumes_turn_with_the_surface(d: int) -> None:
    """The border of a simplex encloses its volume, with the sign of its orientation."""
    corners = np.random.default_rng(d).normal(size=(d + 1, d))
    exact = np.linalg.det(corners[1:] - corners[0]) / factorial(d)
    border = []
    for i in range(d + 1):
        row = [j for j in range(d + 1) if j != i]
        border.append(row if i % 2 == 0 else [row[1], row[0], *row[2:]])
    rows = np.array(border)
    assert oracle.signed_volume(corners, rows) == pytest.approx(exact)
    assert (oracle.facets(rows).balance == 0).all()


def test_the_border_of_the_box_is_known_by_its_planes() -> None:
    """A facet that touches two different planes with its ends does not lie in either."""
    points = np.array([[0.0, 0.5], [0.0, 1.0], [0.5, 1.0], [0.5, 0.5]])
    rows = np.array([[0, 1], [1, 2], [0, 2], [2, 3]])
    found = oracle.on_border(points, rows, [[0, 0], [1, 1]])
    assert found.tolist() == [True, True, False, False]
    far = oracle.on_border(points * [3.0, 1.0] + 5, rows, [[5, 5], [8, 6]])
    assert far.tolist() == found.tolist()
    assert not oracle.on_border(points + 1e-6, rows, [[0, 0], [1, 1]]).any()


def test_points_measure_one_each() -> None:
    """A simplex of dimension 0 has no edges; counting is its measure."""
    points = np.random.default_rng(0).normal(size=(3, 2))
    assert oracle.measures(points, np.array([[0], [2]])).tolist() == [1, 1]
