"""Stratified Morse theory: the same Euler numbers as sheets glued over the grid, and as meshes."""

import numpy as np
import pytest
from isograde.oracles.complexes import Complex
from isograde.oracles.stratified_morse import euler
from isograde.oracles.trilinear_grid import grid
from isoref import extract
from isoref.field import Array


def padded(values: Array) -> Array:
    """In a frame of samples far below."""
    return np.pad(values, 1, constant_values=-9.0)


@pytest.mark.parametrize("isovalue", [-0.5, 0.0, 0.7])
def test_noise_has_the_euler_number_of_its_sheets(isovalue: float) -> None:
    """Two oracles that share nothing: sheets glued along crossed edges, and critical points."""
    numbers = set()
    for seed in range(12):
        values = padded(np.random.default_rng(seed).normal(size=(5, 6, 4)))
        known = grid(values, isovalue)
        assert known.ties == 0
        assert euler(values, isovalue) == known.euler
        numbers.add(known.euler)
    assert len(numbers) > 3


def test_trilinear_cubes_has_it_and_the_asymptotic_decider_has_not_always() -> None:
    """Tunnels show: the same noise, in which the decider draws none."""
    wrong = 0
    for seed in range(6):
        values = padded(np.random.default_rng(100 + seed).normal(size=(7, 7, 7)))
        known = euler(values)
        for method in ("trilinear-cubes", "asymptotic-decider"):
            mesh = extract(values, 0.0, method=method)
            made = Complex.of(mesh.vertices, mesh.simplices).euler
            if method == "trilinear-cubes":
                assert made == known
            else:
                wrong += made != known
    assert wrong > 0


def test_known_bodies() -> None:
    """A ball, a shell and a torus on a lattice."""
    x, y, z = np.indices((15, 15, 15)) - 7.01
    r = np.sqrt(x**2 + y**2 + z**2)
    ring = np.sqrt((np.hypot(x, y) - 4.1) ** 2 + z**2)
    assert euler(5.2 - r) == 2
    assert euler(1.3 - np.abs(r - 4.2)) == 4
    assert euler(1.7 - ring) == 0


def test_a_surface_that_reaches_the_border_is_refused() -> None:
    """And a volume without an inside."""
    with pytest.raises(ValueError, match="pad the volume"):
        euler(np.ones((3, 3, 3)))
    with pytest.raises(ValueError, match="has no inside"):
        euler(np.ones((2, 3, 3)))
