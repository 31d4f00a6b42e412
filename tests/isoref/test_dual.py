"""What all dual methods have in common: vertices in cells, quadrilaterals across crossed edges."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from isograde.oracles.self_intersections import self_intersections
from isoref.dual import DualRule, cells_round, in_triangles, quads, surface
from isoref.fast import dual as fast
from isoref.field import Array, Field, FieldError, Floats
from isoref.methods import DUAL_RULES
from isoref.sweep import sweep
from isoref.trilinear_cubes import RULE as TRILINEAR

from tests.isoref.counting import edges

RULES = pytest.mark.parametrize("rule", DUAL_RULES.values(), ids=list(DUAL_RULES))


def noise(shape: tuple[int, ...], seed: int = 0) -> Field:
    """Normal random samples."""
    return Field.of(np.random.default_rng(seed).normal(size=shape))


def inner_crossings(values: Array, isovalue: float) -> int:
    """How many crossed lattice edges are in no face of the border, counted axis by axis."""
    inside = values >= isovalue
    count = 0
    for axis in range(3):
        moved = np.moveaxis(inside, axis, 0)[:, 1:-1, 1:-1]
        count += int((moved[1:] != moved[:-1]).sum())
    return count


@RULES
@given(values=hnp.arrays(np.int8, st.tuples(*[st.integers(1, 4)] * 3), elements=st.integers(0, 3)))
def test_each_inner_crossed_edge_has_one_quadrilateral(rule: DualRule, values: Array) -> None:
    """Nielson, section 2: the quadrilaterals are the crossings of marching cubes."""
    vertices, rows = quads(rule, Field.of(values), 1.5)
    assert len(rows) == inner_crossings(values, 1.5)
    assert set(np.unique(rows).tolist()) == set(range(len(vertices)))


@RULES
def test_vertices_are_inside_their_cells_and_come_in_their_order(rule: DualRule) -> None:
    """The mean of points on the boundary of a convex cell that are not all in one face."""
    field = noise((5, 6, 7))
    vertices, rows = quads(rule, field, 0.1)
    cell = np.floor(vertices).astype(int)
    assert ((cell < vertices) & (vertices < cell + 1)).all()
    number = np.ravel_multi_index(tuple(cell.T), field.shape)
    assert (np.diff(number) >= 0).all()
    # Each row is a square of cells, with the highest first.
    steps = cell[rows] - cell[rows[:, :1]]
    assert (steps.min(axis=1).sum(axis=1) == -2).all()
    assert (steps[:, 0] == 0).all()
    assert (abs(np.diff(cell[rows], axis=1)).sum(axis=2) == 1).all()


@RULES
def test_normals_point_from_high_to_low(rule: DualRule) -> None:
    """House convention, on a ball: the volume enclosed is positive, and near the ball's.

    A quadrilateral's diagonal spans up to three cells: the mean offset is below 0.4 / R at R = 6
    (design), and three times that over R is the share of the volume.
    """
    x = np.indices((15, 15, 16)) - np.array([6.9, 7.3, 7.8])[:, None, None, None]
    mesh = surface(rule, Field.of(6 - np.sqrt((x**2).sum(axis=0))), 0.0)
    assert len(edges(mesh.simplices).one_sided) == 0
    enclosed = volume(mesh.vertices[mesh.simplices])
    assert enclosed == pytest.approx(4 / 3 * np.pi * 216, rel=3 * 0.4 / 36)


def volume(corners: Floats) -> float:
    """The signed volume inside triangles (T, 3, 3)."""
    return float(np.linalg.det(corners).sum() / 6)


@RULES
@pytest.mark.parametrize("seed", range(3))
def test_no_two_triangles_cross_on_noise(rule: DualRule, seed: int) -> None:
    """Not proven, but so on every field in general position that was tried."""
    values = np.random.default_rng(seed).normal(size=(14, 14, 14))
    mesh = fast.surface(rule, Field.of(values), 0.3 * seed)
    assert len(mesh.simplices) > 3000
    assert len(self_intersections(mesh.vertices, mesh.simplices)) == 0


@RULES
def test_a_plane_is_drawn_exactly(rule: DualRule) -> None:
    """The means of points of a plane are points of the plane."""
    i, j, k = np.indices((6, 7, 8))
    vertices, rows = quads(rule, Field.of(1.0 * i + 2 * j - 1.5 * k), 3.3)
    assert len(rows) > 30
    np.testing.assert_allclose(vertices @ [1, 2, -1.5], 3.3, atol=1e-12)


@RULES
def test_the_surface_stands_where_the_lattice_stands(rule: DualRule) -> None:
    """A vertex is origin + index * spacing."""
    values = noise((4, 5, 4)).values
    plain, rows = quads(rule, Field.of(values), 0.1)
    placed, same = quads(rule, Field.of(values, (0.5, 2, 1), (3, -1, 7)), 0.1)
    assert len(rows) > 10
    np.testing.assert_array_equal(rows, same)
    np.testing.assert_allclose(placed, plain * [0.5, 2, 1] + [3, -1, 7], rtol=1e-14)


@RULES
def test_the_vertex_of_a_simple_cell_is_the_mean_of_the_crossings_of_marching_cubes(
    rule: DualRule,
) -> None:
    """One crossed corner in the middle: eight cells with three crossings each."""
    values = np.zeros((3, 3, 3))
    values[1, 1, 1] = 4
    crossings = sweep(TRILINEAR, Field.of(values), 1.0).vertices - 1
    means = {
        tuple(np.where(np.eye(3, dtype=bool), side, 0).mean(axis=0))
        for side in np.stack(np.meshgrid(*[[-0.75, 0.75]] * 3), axis=-1).reshape(-1, 3)
    }
    assert sorted(np.abs(crossings).max(axis=1).tolist()) == [0.75] * 6
    assert {tuple(v) for v in (quads(rule, Field.of(values), 1.0)[0] - 1)} == means


def test_the_cells_round_an_edge_go_round_it_and_know_it_by_its_number() -> None:
    """Counterclockwise: the area that the middles of the four cells enclose is one."""
    for axis in range(3):
        cells = np.array([cell for cell, _ in cells_round(axis, (1, 1, 1))], float)
        u, v = cells[:, (axis + 1) % 3], cells[:, (axis + 2) % 3]
        assert (np.roll(v, -1) * u - np.roll(u, -1) * v).sum() / 2 == 1


@RULES
def test_quadrilaterals_and_triangles_are_one_surface(rule: DualRule) -> None:
    """Two triangles each, along the diagonal from the first corner."""
    field = noise((5, 5, 5), seed=3)
    vertices, rows = quads(rule, field, 0.0)
    mesh = surface(rule, field, 0.0)
    assert len(mesh.simplices) == 2 * len(rows)
    np.testing.assert_array_equal(mesh.vertices, vertices)
    np.testing.assert_array_equal(in_triangles(vertices, rows).simplices, mesh.simplices)


@RULES
def test_nothing_is_drawn_where_nothing_is_crossed(rule: DualRule) -> None:
    """Out of range, one sample thick, or without an inner edge: an empty mesh of right shape."""
    for values, isovalue in (
        (np.ones((4, 4, 4)), 2),
        (np.ones((4, 4, 4)), 0),
        (np.random.default_rng(0).normal(size=(2, 2, 2)), 0),
        (np.random.default_rng(0).normal(size=(5, 1, 5)), 0),
    ):
        vertices, rows = quads(rule, Field.of(values), isovalue)
        assert vertices.shape == (0, 3)
        assert rows.shape == (0, 4)


@RULES
def test_what_is_no_volume_is_refused(rule: DualRule) -> None:
    with pytest.raises(FieldError, match="3-D lattice"):
        surface(rule, Field.of(np.zeros((3, 3))), 0)
    with pytest.raises(FieldError, match="not finite"):
        surface(rule, Field.of(np.zeros((3, 3, 3))), float("nan"))
