"""Level sets of any dimension and codimension of which the answer is known.

Each is the common zero set of m functions on a box [-half, half]^n, with its Euler characteristic,
its number of pieces and, where it has a closed form, its k-dimensional volume, k = n - m. The
closed ones stay clear of the border of the box; `slanted` ones are flat and cross it.

The Euler characteristics are those of spheres (1 + (-1)^k), of products (they multiply) and of
curves of degree d in C^2 (2 - 2 g - d with g = (d-1)(d-2)/2). A test checks volumes by Monte
Carlo integration, which knows nothing of meshes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Manifold:
    """The common zeros of m functions on [-half, half]^n.

    phi : positions (P, n) to values (P, m), high inside
    volume : of dimension n - m, or None where it is not known
    flat : phi is affine
    """

    name: str
    n: int
    m: int
    half: float
    phi: Callable[[Floats], Floats]
    euler: int
    pieces: int = 1
    volume: float | None = None
    flat: bool = False

    def sample(self, N: int) -> tuple[Floats, float]:
        """Values (m, N, .., N) on N samples a side of the box, and the spacing."""
        axis = np.linspace(-self.half, self.half, N)
        grid = np.stack(np.meshgrid(*[axis] * self.n, indexing="ij"), axis=-1)
        values = self.phi(grid.reshape(-1, self.n)).T.reshape(self.m, *(N,) * self.n)
        return values, 2 * self.half / (N - 1)

    def gradients(self, points: Floats) -> Floats:
        """The gradients (P, m, n) at points, by central differences."""
        h = 1e-5
        steps = h * np.eye(self.n)
        parts = [(self.phi(points + s) - self.phi(points - s)) / (2 * h) for s in steps]
        return np.stack(parts, axis=-1)


def ball(x: Floats, axes: slice) -> Floats:
    """One minus the squared length of some coordinates."""
    inside: Floats = 1 - (x[:, axes] ** 2).sum(axis=1)
    return inside


def tube(x: Floats, across: int, radius: float, thickness: float) -> Floats:
    """High within `thickness` of the sphere of this radius in the first `across` coordinates."""
    away = np.linalg.norm(x[:, :across], axis=1) - radius
    inside: Floats = thickness**2 - away**2 - (x[:, across:] ** 2).sum(axis=1)
    return inside


def column(*components: Floats) -> Floats:
    """Components as columns."""
    return np.stack(components, axis=1)


def complex_curve(x: Floats, degree: int) -> Floats:
    """z1^d + z2^d - 1, real and imaginary part."""
    f = (x[:, 0] + 1j * x[:, 1]) ** degree + (x[:, 2] + 1j * x[:, 3]) ** degree - 1
    return column(f.real, f.imag)


def slanted(n: int, m: int) -> Manifold:
    """An affine set of R^n through the middle of the box, cut off by its border."""
    rng = np.random.default_rng(100 * n + m)
    A, b = rng.normal(size=(m, n)), rng.normal(size=m) * 0.1
    return Manifold(f"flat-{n}-{m}", n, m, 1.0, lambda x: x @ A.T + b, 1, flat=True)


EVERY = slice(None)
APART = np.array([0, 0, 0, 0.5])
MANIFOLDS: dict[str, Manifold] = {
    known.name: known
    for known in (
        Manifold("circle", 2, 1, 1.31, lambda x: column(ball(x, EVERY)), 0, volume=2 * pi),
        Manifold("sphere", 3, 1, 1.33, lambda x: column(ball(x, EVERY)), 2, volume=4 * pi),
        Manifold("torus", 3, 1, 1.63, lambda x: column(tube(x, 2, 1.0, 0.5)), 0, volume=2 * pi**2),
        Manifold("three-sphere", 4, 1, 1.33, lambda x: column(ball(x, EVERY)), 0, volume=2 * pi**2),
        Manifold("tube", 4, 1, 1.57, lambda x: column(tube(x, 3, 1.0, 0.5)), 0),
        Manifold(
            "circle-in-space", 3, 2, 1.29,
            lambda x: column(ball(x, EVERY), x[:, 2] - 0.5), 0, volume=pi * 3**0.5,
        ),
        Manifold(
            "two-circles", 3, 2, 1.29,
            lambda x: column(ball(x, EVERY), x[:, 2] ** 2 - 0.25), 0, 2, volume=2 * pi * 3**0.5,
        ),
        Manifold(
            "two-spheres-meeting", 4, 2, 1.37,
            lambda x: column(ball(x - APART, EVERY), ball(x + APART, EVERY)),
            2, volume=3 * pi,
        ),
        Manifold(
            "clifford-torus", 4, 2, 1.37,
            lambda x: column(ball(x, slice(2)), ball(x, slice(2, 4))), 0, volume=4 * pi**2,
        ),
        Manifold("complex-circle", 4, 2, 1.5, lambda x: complex_curve(x, 2), 0),
        Manifold(
            "torus-in-R5", 5, 3, 1.43,
            lambda x: column(ball(x, slice(2)), ball(x, slice(2, 4)), x[:, 4] - 0.1 * x[:, 0]), 0,
        ),
        *(slanted(n, m) for n, m in ((2, 1), (3, 1), (3, 2), (4, 2), (5, 3))),
    )
}  # fmt: skip
