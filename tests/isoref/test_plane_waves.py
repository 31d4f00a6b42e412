"""Random waves: the wave equation, the walls, the seed."""

from collections.abc import Callable

import numpy as np
import pytest
from isoref.field import FieldError
from isoref.plane_waves import Complex, bounded_waves, directions, nodal_density, random_waves

Sampler = Callable[..., Complex]


def laplacian(psi: Complex, h: float) -> Complex:
    """Second differences at interior samples."""
    c = psi[1:-1, 1:-1, 1:-1]
    total = -6 * c
    for axis in range(3):
        for shift in (0, 2):
            cut = [slice(1, -1)] * 3
            cut[axis] = slice(shift, psi.shape[axis] - 2 + shift)
            total = total + psi[tuple(cut)]
    return total / h**2


def test_random_waves_solve_the_helmholtz_equation() -> None:
    """Eq. 5 mixes waves of one wave number: the Laplacian is -k^2 psi."""
    k, n = 7.0, 65
    psi = random_waves((n, n, n), k, 20, seed=3)
    residual = laplacian(psi, 1 / (n - 1)) + k**2 * psi[1:-1, 1:-1, 1:-1]
    assert abs(residual).max() < 1e-3 * k**2 * abs(psi).max()


def test_bounded_waves_vanish_on_every_wall() -> None:
    """Eq. 6: "in a bounded space like a cube, the function must vanish on the boundary"."""
    psi = bounded_waves((9, 9, 9), 20.0, seed=1, margin=0.0)
    for axis in range(3):
        assert abs(np.take(psi, [0, -1], axis)).max() < 1e-12
    assert abs(psi).max() > 0.1
    assert abs(bounded_waves((9, 9, 9), 20.0, seed=1)[0]).max() > 1e-3


@pytest.mark.parametrize("waves", [random_waves, bounded_waves])
def test_the_seed_fixes_the_function_at_any_size(waves: Sampler) -> None:
    """Every second sample of the finer lattice is the coarser lattice."""
    coarse, fine = waves((9, 7, 9), 15.0, seed=5), waves((17, 13, 17), 15.0, seed=5)
    np.testing.assert_allclose(fine[::2, ::2, ::2], coarse, atol=1e-12)
    assert abs(waves((9, 7, 9), 15.0, seed=6) - coarse).max() > 0.1


def test_the_mean_square_modulus_is_one() -> None:
    """Over seeds and places; amplitudes are scaled by the number of waves."""
    for waves in (random_waves, bounded_waves):
        power = [np.mean(abs(waves((24, 24, 24), 30.0, seed=s)) ** 2) for s in range(12)]
        assert 0.8 < np.mean(power) < 1.2


def test_directions_are_uniform() -> None:
    """Mean zero and second moments one third."""
    d = directions(4000, np.random.default_rng(0))
    np.testing.assert_allclose(np.linalg.norm(d, axis=1), 1)
    np.testing.assert_allclose(d.mean(axis=0), 0, atol=0.03)
    np.testing.assert_allclose(d.T @ d / len(d), np.eye(3) / 3, atol=0.02)


def test_bad_input_is_refused_with_its_number() -> None:
    """What was wrong, where, and what to do."""
    with pytest.raises(FieldError, match="shape"):
        random_waves((0, 4, 4), 5.0)
    with pytest.raises(FieldError, match="three positive numbers"):
        random_waves((4, 4), 5.0)  # type: ignore[arg-type]
    with pytest.raises(FieldError, match="wave number nan"):
        random_waves((4, 4, 4), float("nan"))
    with pytest.raises(FieldError, match="0 waves"):
        bounded_waves((4, 4, 4), 5.0, count=0)
    with pytest.raises(FieldError, match="margin"):
        bounded_waves((4, 4, 4), 5.0, margin=0.5)
    assert nodal_density(3.0) == pytest.approx(3 / np.pi)


def test_bounded_waves_have_their_wave_number_as_nearly_as_the_walls_allow() -> None:
    """Eq. 6: each component is rounded to a multiple of pi, so the Laplacian is near -k^2 psi."""
    k, n = 40.0, 97
    psi = bounded_waves((n, n, n), k, 30, seed=2, margin=0.0)
    inner = psi[1:-1, 1:-1, 1:-1]
    ratio = np.vdot(inner, laplacian(psi, 1 / (n - 1))).real / np.vdot(inner, inner).real
    assert ratio == pytest.approx(-(k**2), rel=0.1)


def test_the_slowest_bounded_wave_has_one_hump() -> None:
    """No component is rounded to zero, which would leave no wave at all."""
    psi = bounded_waves((9, 9, 9), 0.1, 5, margin=0.0)
    hump = np.sin(np.pi * np.linspace(0, 1, 9))
    expected = hump[:, None, None] * hump[:, None] * hump
    np.testing.assert_allclose(psi, psi[4, 4, 4] * expected, atol=1e-12)
    assert abs(psi[4, 4, 4]) > 0.1
