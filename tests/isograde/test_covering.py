"""Facets that lie on other facets, checked by hand and against SciPy's point location."""

import numpy as np
import pytest
from isograde.oracles.complexes import Complex
from isograde.oracles.covering import contain, covered, inner_open_facets
from scipy.spatial import Delaunay


def test_two_cuts_of_a_square_are_covered_and_a_hole_is_not() -> None:
    """The square between two blocks, cut along either diagonal, and half of it missing."""
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    one, other = [[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]
    assert covered(square, np.array(one + other)).all()
    assert not covered(square, np.array(one)).any()
    shifted = np.vstack([square, square + np.array([0, 0, 0.01])])
    apart = np.array(one + [[a + 4, b + 4, c + 4] for a, b, c in other])
    assert not covered(shifted, apart).any()


def test_open_facets_inside_the_box_are_those_of_a_hole() -> None:
    """A square with one triangle: the diagonal is inside, two sides are on the border."""
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    box = [[0.0, 0.0], [1.0, 1.0]]
    assert inner_open_facets(Complex.of(square, np.array([[0, 1, 2]])), box).tolist() == [[0, 2]]
    whole = Complex.of(square, np.array([[0, 1, 2], [0, 2, 3]]))
    assert len(inner_open_facets(whole, box)) == 0


@pytest.mark.parametrize("d", [2, 3, 4])
def test_a_simplex_contains_what_scipy_finds_in_it(d: int) -> None:
    """Against SciPy's point location."""
    rng = np.random.default_rng(d)
    corners = rng.normal(size=(d + 1, d))
    points = (rng.dirichlet(np.ones(d + 1), 200) * 1.6 - 0.6 / (d + 1)) @ corners
    inside = Delaunay(corners).find_simplex(points) >= 0
    assert 0 < inside.sum() < 200
    found = contain(np.broadcast_to(corners, (200, d + 1, d)), points)
    np.testing.assert_array_equal(found, inside)


def test_the_box_may_lie_anywhere() -> None:
    """Of faces of a box about zero, or below it, a facet that rounding moved is still one."""
    rounded = np.array([[0.0, 1e-10], [1, 1e-10], [1, 1], [0, 1]])
    for low in (-0.5, -3.0):
        mesh = Complex.of(rounded + low, np.array([[0, 1, 2], [0, 2, 3]]))
        assert len(inner_open_facets(mesh, [[low, low], [low + 1, low + 1]])) == 0


def test_a_centroid_beside_a_facet_is_not_on_it() -> None:
    """A small triangle with its centroid a little beyond the side of a large one: two facets."""
    large = np.array([[0.0, 0, 0], [4, 0, 0], [0, 4, 0]])
    small = 0.1 * (large - large.mean(axis=0)) + [1.0, 0, 0]
    rows = np.array([[0, 1, 2], [3, 4, 5]])
    for beyond, on in ((0.0, True), (5e-8, False)):
        places = np.concatenate([large, small - [0, beyond, 0]])
        assert covered(places, rows).tolist() == [False, on]
