"""CORNELIUS: the surface of DICONEX, VESTA and STEVE, by steps that share nothing with them."""

import numpy as np
import pytest
from isoref.cornelius import cornelius, elements, lines, polyhedra, squares
from isoref.fast.diconex import diconex
from isoref.fast.vesta import extract
from isoref.field import Field, FieldError
from isoref.hypersurface import hypersurface

SPACING = (0.5, 1.0, 1.25, 0.75)
ORIGIN = (1.0, -2.0, 0.0, 3.0)


def noise(shape: tuple[int, ...], seed: int) -> Field:
    """Noise amid cold samples, in cells that are no cubes."""
    inner = np.random.default_rng(seed).normal(size=shape)
    n = len(shape)
    return Field.of(np.pad(inner, 1, constant_values=-1.0), SPACING[:n], ORIGIN[:n])


def ball(sides: int, n: int) -> Field:
    """The unit ball in n dimensions."""
    h = 2.6 / (sides - 1)
    axes = np.meshgrid(*[np.arange(sides) * h - 1.3] * n, indexing="ij")
    return Field.of(1 - np.sqrt(sum(x**2 for x in axes)), h, [-1.3] * n)


def test_in_two_dimensions_it_draws_the_lines_of_diconex() -> None:
    """Mixed mode: every line has its place and its normal."""
    field = noise((7, 8), 0)
    found = cornelius(field, 0.0)
    contours = diconex(field, 0.0, mode="mixed", border="closed").polygons()
    sides = np.concatenate([p[1:] - p[:-1] for p in contours])
    middles = np.concatenate([(p[1:] + p[:-1]) / 2 for p in contours])
    assert len(found.places) == len(sides) > 20
    order, other = (np.lexsort(x.T.round(9)) for x in (found.places, middles))
    np.testing.assert_allclose(found.places[order], middles[other], atol=1e-12)
    across = np.stack([sides[:, 1], -sides[:, 0]], axis=1)
    np.testing.assert_allclose(np.abs(found.normals[order]), np.abs(across[other]), atol=1e-12)
    assert np.abs(found.normals.sum(axis=0)).max() < 1e-12


def test_in_three_dimensions_it_has_the_cycles_of_vesta() -> None:
    """As many elements of as many points; on a smooth body the same normals."""
    for field in (noise((5, 4, 5), 1), ball(9, 3)):
        surface = extract(field, 0.0, mode="mixed", border="closed")
        found = cornelius(field, 0.0)
        cycles = sum(len(rows) for rows in surface.cycles.values())
        assert len(found.places) == cycles > 20
    wanted = np.concatenate(list(surface.normals.values()))
    key, other = (np.lexsort(x.T.round(9)) for x in (found.normals, wanted))
    np.testing.assert_allclose(found.normals[key], wanted[other], atol=1e-12)


def test_in_four_dimensions_it_has_the_polyhedra_of_steve() -> None:
    """On a smooth body, in the same order of cells; polygons are filled from another middle."""
    field = ball(6, 4)
    found, steve = cornelius(field, 0.0), hypersurface(field, 0.0).polyhedra
    assert len(found.places) == len(steve.places) > 100
    away = np.linalg.norm(found.normals - steve.normals, axis=1)
    assert (away < 1e-3 * np.linalg.norm(steve.normals, axis=1)).all()
    assert np.abs(found.normals.sum(axis=0)).max() < 1e-12


@pytest.mark.parametrize(
    ("n", "area", "volume"),
    [
        (2, 2 * np.pi, np.pi),
        (3, 4 * np.pi, 4 / 3 * np.pi),
        pytest.param(4, 2 * np.pi**2, np.pi**2 / 2, marks=pytest.mark.slow),
    ],
)
def test_a_ball_is_as_large_as_it_should_be(n: int, area: float, volume: float) -> None:
    """Second order: a lattice twice as fine errs a quarter."""
    errors = []
    for sides in (7, 13) if n < 4 else (5, 9):
        found = cornelius(ball(sides, n), 0.0)
        size = np.linalg.norm(found.normals, axis=1).sum()
        errors.append([size / area - 1, found.flux(lambda x: x / n) / volume - 1])
    assert np.abs(errors[1]).max() < (0.05 if n < 4 else 0.15)
    assert (np.abs(errors[1]) < 0.42 * np.abs(errors[0])).all()


def test_its_surface_is_closed_though_nothing_keeps_an_order() -> None:
    """Noise in four dimensions: the sum is zero, the volume that of STEVE but for the filling."""
    field = noise((3, 3, 3, 3), 2)
    found, steve = cornelius(field, 0.0), hypersurface(field, 0.0)
    assert len(found.places) == len(steve.polyhedra.places)
    size = np.abs(found.normals).sum()
    assert np.abs(found.normals.sum(axis=0)).max() < 1e-14 * size
    fluxes = [x.flux(lambda x: x / 4) for x in (found, steve.tetrahedra)]
    assert fluxes[0] == pytest.approx(fluxes[1], rel=0.02)


def test_two_corners_of_a_square_are_cut_off_on_the_side_away_from_its_mean() -> None:
    """The paper's reading of alternating corners; each line knows where it is cold."""
    (walk,) = squares(2)
    hot, cold = (np.array([[m + 1, -1], [-1, m + 1]], float) for m in (1, -1 / 2))
    for g, outside in ((hot, {(1.0, 0.0), (0.0, 1.0)}), (cold, {(0.5, 0.5)})):
        assert {line.outside for line in lines(g, walk)} == outside


def test_every_line_of_a_4_cell_is_in_two_polygons_of_one_polyhedron() -> None:
    """Random values: nothing is left open, and some cells have several polyhedra."""
    chance, several = np.random.default_rng(3), 0
    from isoref.cornelius import in_cube, joined

    for _ in range(60):
        g = chance.normal(size=(2,) * 4)
        polygons = [
            polygon
            for axis in range(4)
            for side in (0, 1)
            for polygon in joined(
                [x for s in squares(4) if in_cube(s, axis, side) for x in lines(g, s)]
            )
        ]
        found = polyhedra(polygons)
        several += len(found) > 1
        for polyhedron in found:
            uses = [line for polygon in polyhedron for line in polygon]
            assert all(uses.count(line) == 2 for line in uses)
        assert len(list(elements(g, np.ones(4)))) == len(found)
    assert several > 5


def test_what_it_cannot_take_is_refused() -> None:
    """One axis, two components; nothing crossed is nothing."""
    with pytest.raises(FieldError, match="two, three or four"):
        cornelius(Field.of(np.zeros(5)), 0.5)
    with pytest.raises(FieldError, match="2 components"):
        cornelius(Field.of(np.zeros((2, 3, 3)), dimension=2), 0.5)
    assert cornelius(Field.of(np.zeros((3, 3))), 0.5).places.shape == (0, 2)
