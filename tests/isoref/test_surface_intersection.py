"""Surface intersection, as the article has it: eq. 1, tables 2 and 3, exact signs."""

from fractions import Fraction

import numpy as np
import pytest
from isoref.curves import real_and_imaginary
from isoref.field import Field
from isoref.mesh import Mesh
from isoref.plane_waves import random_waves
from isoref.surface_intersection import (
    IndexedSurface,
    Segments,
    combine_line_segments,
    enhanced_marching_cubes,
    intersection_curves,
    join_segments,
    rational,
    surface_intersection,
    triangle_intersection,
)


def test_the_running_count_has_the_paper_s_border_conditions() -> None:
    """Eq. 1: ``I_T(k) = 0`` for k < 0 and ``|T|`` for ``k >= N_voxels``."""
    psi = random_waves((6, 6, 6), 9.0, seed=1)
    surface = enhanced_marching_cubes(real_and_imaginary(psi, 0.2)[0], 0.0)
    n = int(np.prod(surface.shape))
    total = len(surface.mesh.simplices)
    assert surface.count_through(np.array([-1, -5, n, n + 7])).tolist() == [0, 0, total, total]
    counts = surface.count_in(np.arange(n))
    np.testing.assert_array_equal(counts, np.bincount(surface.cells, minlength=n))
    np.testing.assert_array_equal(surface.histogram(), np.bincount(counts))


def test_the_greedy_joining_needs_its_threshold() -> None:
    """Section 5: a maximum distance to allow connection of two end points."""
    ends = np.array([[[0.0, 0, 0], [1, 0, 0]], [[1.1, 0, 0], [2, 0, 0]], [[2, 0, 0], [3, 0, 0]]])
    segments = Segments(ends, np.array([[0, 1], [2, 3], [3, 4]]), np.array([0, 1, 2]), 3)
    assert len(combine_line_segments(segments, (3, 1, 1), 0.2)) == 1
    apart = combine_line_segments(segments, (3, 1, 1), 0.05)
    assert sorted(len(c.points) for c in apart) == [2, 3]
    assert sorted(len(c.points) for c in join_segments(segments)) == [2, 3]


def test_a_square_of_segments_in_any_direction_is_one_closed_curve() -> None:
    """Greedy joining does not use the direction of segments."""
    corner = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    ends = np.array([corner[[0, 1]], corner[[2, 1]], corner[[2, 3]], corner[[0, 3]]])
    segments = Segments(ends, np.arange(8).reshape(4, 2), np.zeros(4, np.int64), 4)
    (curve,) = combine_line_segments(segments, (1, 1, 1), 1e-9)
    assert curve.closed
    assert curve.length == 4


def test_rational_is_exact() -> None:
    """A float is a fraction."""
    assert rational((0.1, 0.5, 2.0))[1:] == (Fraction(1, 2), Fraction(2))
    assert rational((0.1, 0, 0))[0] != Fraction(1, 10)


def test_an_end_says_which_edges_make_it() -> None:
    """A wall across a triangle: its own edges make the ends, or an edge of each where two meet."""
    floor = [rational(p) for p in ((0, 0, 0), (4, 0, 0), (0, 4, 0))]
    wall = [rational(p) for p in ((1, 1, -1), (1, 2, 1), (1, 1, 1))]
    start, stop = triangle_intersection(floor, wall) or pytest.fail("they meet")
    assert [(end.edge_a, end.edge_b) for end in (start, stop)] == [(-1, 2), (-1, 0)]
    longer = [rational(p) for p in ((1, 1, -1), (1, 5, 1), (1, 1, 1))]
    start, stop = triangle_intersection(floor, longer) or pytest.fail("they meet")
    assert [(end.edge_a, end.edge_b) for end in (start, stop)] == [(-1, 2), (1, 0)]


def test_only_triangles_of_one_voxel_are_tested() -> None:
    """Table 2, lines 3 to 6: the running counts of both surfaces name the pairs."""
    triangle = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    mesh = Mesh.of(np.tile(triangle, (3, 1)), np.arange(9).reshape(3, 3))
    one = IndexedSurface(mesh, np.array([0, 0, 2]), (3, 1, 1))
    two = IndexedSurface(mesh, np.array([0, 1, 2]), (3, 1, 1))
    assert surface_intersection(one, two).tests == 2 * 1 + 1 * 1
    with pytest.raises(ValueError, match="share no voxels"):
        surface_intersection(one, IndexedSurface(mesh, np.array([0, 1, 2]), (1, 1, 3)))


def test_two_planes_meet_in_a_straight_line() -> None:
    """From border to border, along ``grad psi_1 x grad psi_2``."""
    x, y, _ = np.meshgrid(*[np.arange(3.0)] * 3, indexing="ij")
    (curve,) = intersection_curves(Field.of(x - 1.25), Field.of(y - 1.5))
    assert not curve.closed
    np.testing.assert_allclose(curve.points[[0, -1]], [[1.25, 1.5, 0], [1.25, 1.5, 2]])
