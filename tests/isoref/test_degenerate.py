"""Triangles without area go where that does no harm, and what is left is said truly."""

from __future__ import annotations

import numpy as np
import pytest
from isoref import METHODS, FieldError, Mesh, extract
from isoref.degenerate import degenerate, state, without_degenerate


def tied(seed: int, side: int = 8) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
    """Small whole numbers: a third of the samples equal the isovalue 0."""
    return np.random.default_rng(seed).integers(-1, 2, size=(side,) * 3)


@pytest.mark.parametrize("method", METHODS)
def test_a_manifold_stays_one_and_loses_most_of_its_flat_triangles(method: str) -> None:
    """No edge becomes crowded, no vertex pinched, nothing opens; the Euler number tells of points.

    What is left has lain in the mesh before, at the same places.
    """
    for seed in range(3):
        mesh = extract(tied(seed), 0, method=method)
        removal = without_degenerate(mesh)
        before, after = removal.before, removal.after
        assert before == state(mesh)
        assert after == state(removal.mesh)
        assert removal.keeps_manifold
        assert after.crowded == before.crowded
        assert after.pinched <= before.pinched
        # The law of the Euler number is one of manifolds; a piece that was a point had its own.
        if not (removal.vanished or before.pinched):
            assert after.euler == before.euler
        assert after.degenerate <= before.degenerate / 2
        assert np.array_equal(mesh.vertices[removal.kept], removal.mesh.vertices)
        area = [
            np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
            for a, b, c in (
                np.moveaxis(m.vertices[m.simplices], 1, 0) for m in (mesh, removal.mesh)
            )
        ]
        assert area[1] == pytest.approx(area[0])


def test_welding_leaves_none_of_length_zero_and_says_what_it_cost() -> None:
    """The report tells of the crowded edges and pinched vertices that it made."""
    mesh = extract(tied(0), 0)
    removal = without_degenerate(mesh, manifold=False)
    assert removal.before.crowded == removal.before.pinched == 0
    assert removal.after.crowded + removal.after.pinched > 0
    assert not removal.keeps_manifold
    places = removal.mesh.vertices
    assert np.array_equal(mesh.vertices[removal.kept], places)
    assert len(np.unique(places, axis=0)) == len(places)


def test_a_mesh_without_any_is_left_alone() -> None:
    """In general position there is nothing to remove."""
    mesh = extract(np.random.default_rng(0).normal(size=(7, 7, 7)), 0.0)
    removal = without_degenerate(mesh)
    assert (removal.collapsed, removal.flipped, removal.vanished) == (0, 0, 0)
    assert np.array_equal(removal.mesh.simplices, mesh.simplices)
    assert removal.before == removal.after


def test_a_piece_that_is_a_point_vanishes() -> None:
    """Round a lone sample on the isovalue: eight triangles, all corners at the sample."""
    values = -np.ones((3, 3, 3))
    values[1, 1, 1] = 0
    mesh = extract(values, 0)
    assert len(mesh.simplices) == 8
    removal = without_degenerate(mesh)
    assert (removal.vanished, len(removal.mesh.vertices)) == (1, 0)


def test_an_edge_is_flipped_where_three_corners_lie_on_a_line() -> None:
    """The neighbour across the longest side gives it an area; the same square is covered."""
    square = Mesh.of([[0, 0, 0], [2, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 2, 1], [0, 1, 3]])
    removal = without_degenerate(square)
    assert removal.flipped == 1
    assert removal.after.degenerate == 0
    assert {frozenset(row) for row in removal.mesh.simplices.tolist()} == {
        frozenset({0, 2, 3}),
        frozenset({1, 2, 3}),
    }
    a, b, c = np.moveaxis(removal.mesh.vertices[removal.mesh.simplices], 1, 0)
    assert (np.cross(b - a, c - a)[:, 2] > 0).all()


def test_a_tetrahedron_with_an_edge_of_no_length_is_kept() -> None:
    """To collapse it would leave two triangles back to back: the link condition fails."""
    flat = Mesh.of(
        [[0, 0, 0], [0, 0, 0], [1, 0, 0], [0, 1, 0]],
        [[0, 1, 2], [1, 0, 3], [0, 2, 3], [1, 3, 2]],
    )
    removal = without_degenerate(flat)
    assert (removal.collapsed, removal.after.degenerate) == (0, 2)
    assert without_degenerate(flat, manifold=False).after.degenerate == 0


def test_pinched_and_crowded_are_counted_as_they_are() -> None:
    """Two tetrahedra that share a vertex; three triangles on one edge."""
    tetrahedron = np.array([[0, 1, 2], [1, 0, 3], [0, 2, 3], [1, 3, 2]])
    vertices = np.random.default_rng(0).normal(size=(7, 3))
    double = Mesh.of(vertices, np.concatenate([tetrahedron, np.array([3, 4, 5, 6])[tetrahedron]]))
    found = state(double)
    assert (found.boundary, found.crowded, found.pinched, found.euler) == (0, 0, 1, 3)
    book = Mesh.of(vertices, [[0, 1, 2], [0, 1, 3], [0, 1, 4]])
    assert (state(book).crowded, state(book).boundary) == (1, 6)
    nothing = state(Mesh.empty(3, 2))
    assert (nothing.degenerate, nothing.pinched, nothing.euler) == (0, 0, 0)


def test_rounding_is_no_area() -> None:
    """Three points on a slanted line, far from 0, have the area that rounding gives them."""
    t = np.array([0.1, 0.37, 0.83])[:, None]
    line = 1e4 + t * [1.1, 2.3, 0.7]
    assert degenerate(Mesh.of(line, [[0, 1, 2]])).tolist() == [True]
    line[1, 0] += 1e-6
    assert degenerate(Mesh.of(line, [[0, 1, 2]])).tolist() == [False]


def test_what_is_no_surface_is_refused() -> None:
    """Segments have no area to lose."""
    with pytest.raises(FieldError, match="dimension 1 are no triangles"):
        without_degenerate(Mesh.empty(2, 1))
