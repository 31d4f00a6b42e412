"""Freeze-out in 3+1 dimensions: closed, oriented, and as large as it should be."""

from math import factorial

import numpy as np
import pytest
from isoref.fast.simplicial import extract
from isoref.field import Field, FieldError, Floats
from isoref.hypersurface import (
    Mode,
    cube_corners,
    cubes,
    hypersurface,
    normals_of,
    polyhedra,
    sides_of,
)

MODES: list[Mode] = ["mixed", "disconnect", "connect"]


def noise(shape: tuple[int, ...], seed: int) -> Field:
    """Noise amid low samples, in cells that are no cubes."""
    inner = np.random.default_rng(seed).normal(size=shape)
    values = np.pad(inner, 1, constant_values=-1.0)
    return Field.of(values, (0.5, 1.0, 1.25, 0.75), (1.0, -2.0, 0.0, 3.0))


def ball(n: int, radius: float = 1.0) -> Field:
    """A ball of four dimensions, on n^4 samples."""
    h = 2.6 / (n - 1)
    axis = np.arange(n) * h - 1.3
    squared = sum(x**2 for x in np.meshgrid(axis, axis, axis, axis, indexing="ij"))
    return Field.of(radius - np.sqrt(squared), h, [-1.3] * 4)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("seed", [0, 1])
def test_the_normals_of_a_closed_hypersurface_sum_to_zero(mode: Mode, seed: int) -> None:
    """On noise, with ambiguous squares: in every component, up to rounding."""
    found = hypersurface(noise((3, 3, 4, 3), seed), 0.0, mode)
    for elements in (found.polyhedra, found.tetrahedra):
        size = np.abs(elements.normals).sum()
        assert size > 10
        assert np.abs(elements.normals.sum(axis=0)).max() < 1e-14 * size


@pytest.mark.parametrize("mode", MODES)
def test_every_side_of_a_polygon_is_shared_and_runs_both_ways(mode: Mode) -> None:
    """In every cell: the polygons of the eight cubes bound polyhedra without a gap."""
    chance = np.random.default_rng(2)
    several = 0
    for _ in range(400):
        found = polyhedra(chance.normal(size=16), mode)
        several += len(found) > 1
        for polyhedron in found:
            sides = [side for polygon in polyhedron for side in sides_of(polygon)]
            assert len(set(sides)) == len(sides)
            assert {(b, a) for a, b in sides} == set(sides)
    assert several > 50


@pytest.mark.parametrize("mode", MODES)
def test_the_flux_of_x_over_4_is_the_volume(mode: Mode) -> None:
    """By the tetrahedra exactly: whatever the origin is; it turns over with the field."""
    field = noise((3, 4, 3, 3), 3)
    volume = hypersurface(field, 0.0, mode).tetrahedra.flux(lambda x: x / 4)
    moved = Field.of(field.values, field.spacing, (70.0, -3.0, 11.0, 5.0))
    again = hypersurface(moved, 0.0, mode).tetrahedra.flux(lambda x: x / 4)
    assert volume > 0
    assert again == pytest.approx(volume, rel=1e-11)
    other: Mode = {"mixed": "mixed", "disconnect": "connect", "connect": "disconnect"}[mode]  # type: ignore[assignment]
    turned = hypersurface(Field.of(-field.values, field.spacing, field.origin), 0.0, other)
    assert turned.tetrahedra.flux(lambda x: x / 4) == pytest.approx(-volume, rel=1e-11)


def test_volumes_of_simplices_and_of_polyhedra_are_near() -> None:
    """The hypersurface by Kuhn's simplices is of another interpolant: the same ball, nearly."""
    field = ball(8)
    mesh = extract(field, 0.0)
    by_simplices = np.linalg.det(mesh.vertices[mesh.simplices]).sum() / factorial(4)
    by_polyhedra = hypersurface(field, 0.0).tetrahedra.flux(lambda x: x / 4)
    assert by_polyhedra == pytest.approx(by_simplices, rel=0.04)


@pytest.mark.slow
def test_a_ball_converges_in_second_order() -> None:
    """Volume pi^2 R^4 / 2 and area 2 pi^2 R^3, by the fine and the coarse elements."""
    errors = []
    for n in (7, 13):
        found = hypersurface(ball(n), 0.0)
        volumes = [e.flux(lambda x: x / 4) for e in (found.tetrahedra, found.polyhedra)]
        area = np.linalg.norm(found.polyhedra.normals, axis=1).sum()
        ratios = [*(v / (np.pi**2 / 2) for v in volumes), area / (2 * np.pi**2)]
        errors.append([abs(ratio - 1) for ratio in ratios])
    orders = np.log2(np.array(errors[0]) / np.array(errors[1]))
    assert (orders > 1.7).all()
    assert (orders < 2.4).all()


@pytest.mark.slow
def test_what_leaves_a_fireball_was_in_it_at_first() -> None:
    """A fireball that cools: the flux of a current along time is its volume at the first frame.

    T = T0 exp(-r^2 / 2 s^2 - t / tau) falls through T_f on r^2 = 2 s^2 (log(T0 / T_f) - t / tau).
    """
    errors = []
    for n in (7, 13):
        t = np.linspace(0, 6.5, n)
        x = np.linspace(-3.2, 3.2, n)
        T, X, Y, Z = np.meshgrid(t, x, x, x, indexing="ij")
        values = np.log(235.0) - (X**2 + Y**2 + Z**2) / 8 - T / 7 - np.log(139.0)
        spacing = [t[1], *[x[1] - x[0]] * 3]
        found = hypersurface(Field.of(values, spacing, [0.0, -3.2, -3.2, -3.2]), 0.0)

        def along_time(places: Floats) -> Floats:
            return np.tile([1.0, 0.0, 0.0, 0.0], (len(places), 1))

        radius = np.sqrt(8 * np.log(235.0 / 139.0))
        errors.append(abs(found.polyhedra.flux(along_time) / (4 / 3 * np.pi * radius**3) - 1))
    assert errors[1] < 0.08
    assert 1.6 < np.log2(errors[0] / errors[1]) < 2.6


def test_normals_are_orthogonal_to_the_edges_and_as_long_as_the_volume() -> None:
    """Random tetrahedra of R^4: against Gram's determinant."""
    tetrahedra = np.random.default_rng(4).normal(size=(20, 4, 4))
    edges = tetrahedra[:, 1:] - tetrahedra[:, :1]
    normals = normals_of(tetrahedra)
    np.testing.assert_allclose(np.einsum("tij,tj->ti", edges, normals), 0, atol=1e-12)
    volume = np.sqrt(np.linalg.det(edges @ edges.transpose(0, 2, 1))) / 6
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), volume)


def test_a_4_cell_has_eight_cubes_of_eight_corners() -> None:
    """Each corner lies in four of them."""
    every = [cube_corners(axis, side) for axis, side in cubes()]
    assert len(every) == 8
    assert np.bincount(np.concatenate(every)).tolist() == [4] * 16


def test_what_is_no_temperature_in_3_plus_1_dimensions_is_refused() -> None:
    """Three axes, two components, an unknown mode; nothing crossed is nothing."""
    with pytest.raises(FieldError, match="needs one temperature on four"):
        hypersurface(Field.of(np.zeros((3, 3, 3))), 0.5)
    with pytest.raises(FieldError, match="2 components"):
        hypersurface(Field.of(np.zeros((2, 3, 3, 3, 3)), dimension=4), 0.5)
    with pytest.raises(ValueError, match="mode"):
        hypersurface(Field.of(np.zeros((3,) * 4)), 0.5, "nearest")  # type: ignore[arg-type]
    assert len(hypersurface(Field.of(np.zeros((3,) * 4)), 0.5).polyhedra.places) == 0
