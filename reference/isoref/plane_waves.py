"""Random plane waves: complex fields whose nodal lines are the curves of wave chaos.

A wave in a chaotic cavity looks, away from the walls, like a superposition of many plane waves of
one wave number, with random directions, amplitudes and phases. It vanishes (real and imaginary
part at once) along curves, the *nodal lines*: the intersection of the isosurfaces ``Re psi = 0``
and ``Im psi = 0``.

Glossary
--------
psi         the complex wave function, sampled on a cubic lattice in the unit cube
k           wave number, in radians per side of the cube (the wave length is 2 pi / k)
k_j         wave vector of the j-th wave
a_j, phi_j  its amplitude (normal) and phase (uniform)
c_j         complex amplitude of a standing wave in a box
N           number of waves mixed; 100 gives nearly Gaussian statistics

Invariants
----------
A seed fixes the *function*, not the samples: the same seed on a finer lattice samples the same
waves. The longest side of the lattice spans the unit length, so cells are cubes. Every field is
scaled to a mean square modulus near 1.

References
----------
[1] P. Ljung, A. Ynnerman, Extraction of intersection curves from iso-surfaces on co-located 3D
    grids, section 8, eqs. 5 and 6.
[2] M. V. Berry, Regular and irregular semiclassical wavefunctions, J. Phys. A 10, 1977.
[3] M. V. Berry, M. R. Dennis, Phase singularities in isotropic random waves, Proc. R. Soc. A 456,
    2000: nodal lines of isotropic waves have length ``k^2 / (3 pi)`` per unit volume.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from isoref.field import FieldError, Floats

Complex = NDArray[np.complex128]
Shape = tuple[int, int, int]


def random_waves(shape: Shape, k: float, count: int = 100, seed: int = 0) -> Complex:
    """Samples of eq. 5: ``sum over j of a_j exp(i (k_j . r + phi_j))`` with ``|k_j| = k``.

    Parameters
    ----------
    shape : samples along each axis
    k : wave number, radians per side
    count : number of waves
    seed : of the amplitudes, phases and directions

    Raises
    ------
    FieldError
        for an empty shape, a wave number that is not positive and finite, or no waves.

    >>> coarse, fine = random_waves((3, 3, 3), 9.0), random_waves((5, 5, 5), 9.0)
    >>> bool(np.allclose(coarse, fine[::2, ::2, ::2]))
    True
    """
    _check(shape, k, count)
    chance = np.random.default_rng(seed)
    vectors = k * directions(count, chance)
    amplitudes = chance.normal(size=count)
    phases = chance.uniform(0, 2 * np.pi, count)
    first, second, third = (
        np.exp(1j * np.outer(vectors[:, axis], _coordinates(shape, axis))) for axis in range(3)
    )
    c = amplitudes * np.exp(1j * phases) / math.sqrt(count)
    return _superpose(c[:, None] * first, second, third)


def bounded_waves(
    shape: Shape, k: float, count: int = 100, seed: int = 0, margin: float = 0.02
) -> Complex:
    """Samples of eq. 6: ``sum over j of c_j sin(kx_j x) sin(ky_j y) sin(kz_j z)`` in a unit box.

    Each component of k_j is a multiple of pi, so that psi vanishes on every wall; the directions
    are random and ``|k_j|`` is k as nearly as such multiples allow. The lattice leaves out a
    margin along the walls "in order to reveal the interior structure".

    >>> walls = bounded_waves((5, 5, 5), 12.0, margin=0.0)[[0, -1]]
    >>> bool(abs(walls).max() < 1e-12)
    True
    """
    _check(shape, k, count)
    if not 0 <= margin < 0.5:
        raise FieldError(f"margin {margin} leaves nothing of the box; take 0 to 0.5")
    chance = np.random.default_rng(seed)
    vectors = np.pi * np.maximum(1, np.rint(k * np.abs(directions(count, chance)) / np.pi))
    c = chance.normal(size=(count, 2)) @ np.array([1, 1j]) * 2 / math.sqrt(count)
    first, second, third = (
        np.sin(np.outer(vectors[:, axis], margin + (1 - 2 * margin) * _coordinates(shape, axis)))
        for axis in range(3)
    )
    return _superpose(c[:, None] * first, second, third)


def directions(count: int, chance: np.random.Generator) -> Floats:
    """(count, 3) unit vectors, uniform on the sphere."""
    vectors: Floats = chance.normal(size=(count, 3))
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors


def nodal_density(k: float) -> float:
    """Length of nodal line per unit volume of isotropic Gaussian waves, ``k^2 / (3 pi)`` [3]."""
    return k * k / (3 * math.pi)


def _coordinates(shape: Shape, axis: int) -> Floats:
    """Coordinates of the samples along an axis; the longest axis spans 0 to 1."""
    return np.arange(shape[axis]) / max(max(shape) - 1, 1)


def _superpose(first: Complex, second: Complex | Floats, third: Complex | Floats) -> Complex:
    """``sum over j of first[j, x] second[j, y] third[j, z]``, one layer of x at a time."""
    psi = np.empty((first.shape[1], second.shape[1], third.shape[1]), np.complex128)
    for x, weight in enumerate(first.T):
        if np.iscomplexobj(third):
            np.matmul((weight[:, None] * second).T, third, out=psi[x])
            continue
        # Two real products are half the work of a complex one.
        psi[x].real = (weight.real[:, None] * second).T @ third
        psi[x].imag = (weight.imag[:, None] * second).T @ third
    return psi


def _check(shape: Shape, k: float, count: int) -> None:
    """Raise FieldError unless waves can be sampled."""
    if len(shape) != 3 or min(shape) < 1:
        raise FieldError(f"shape {tuple(shape)} must be three positive numbers of samples")
    if not (math.isfinite(k) and k > 0):
        raise FieldError(f"wave number {k} must be positive and finite")
    if count < 1:
        raise FieldError(f"{count} waves make no field; mix at least one")
