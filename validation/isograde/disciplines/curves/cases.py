"""Two fields on one lattice: known curves, waves, noise, and surfaces that touch or never meet."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache, partial
from typing import Any

import numpy as np
from isoref.field import Field
from numpy.typing import NDArray

from isograde.model import Case
from isograde.oracles import space_curves
from isograde.oracles.space_curves import KnownCurves, Points

# Samples along each axis of a known case; "finer" has cells of half the size.
COARSE = (24, 27, 25)


def cases(seed: int = 0) -> list[Case]:
    """Every case of the discipline, deterministic for a seed."""
    listed = [_known_case(known) for known in known_curves().values()]
    for name, build, tags in (
        ("curves/waves", partial(_waves, seed), {"generic"}),
        ("curves/noise", partial(_noise, seed), {"generic", "noise"}),
        ("curves/apart", _apart, {"generic", "empty"}),
        ("curves/identical", _identical, {"degenerate", "identical"}),
        ("curves/tangent", _tangent, {"ties"}),
        ("curves/integers", _integers, {"ties"}),
    ):
        size = build().values[0].size
        listed.append(Case(name, build, 0.0, size, frozenset({"curves", *tags})))
    return listed


@cache
def known_curves() -> Mapping[str, KnownCurves]:
    """The known curves by the id of their case."""
    return {f"curves/{known.name}": known for known in (make() for make in space_curves.KNOWN)}


def _known_case(known: KnownCurves) -> Case:
    """The case that samples two functions whose common zeros are known."""
    tags = {"curves", "known", "generic"} if known.transversal else {"curves", "touching"}
    if known.levels != (0, 0):
        tags = {"curves", "known", "levels"}
    return Case(
        f"curves/{known.name}",
        lambda: _sampled(known, COARSE),
        known.levels[0],
        int(np.prod(COARSE)),
        frozenset(tags),
        {"length": known.length, "closed": known.closed},
    )


def _sampled(known: KnownCurves, shape: tuple[int, int, int]) -> Field:
    """Both functions on the lattice, as one field; a third component is the second isovalue."""
    first, second, spacing = known.sample(shape)
    one, two = known.levels
    last = [] if one == two else [np.full(shape, two)]
    values = np.stack([first, second, *last])
    return Field.of(values, spacing.tolist(), (-known.half,) * 3, dimension=3)


def _pair(
    first: NDArray[Any], second: NDArray[Any], spacing: float | tuple[float, ...] = 1.0
) -> Field:
    """Two arrays as one field of two components."""
    return Field.of(np.stack([first, second]), spacing, dimension=3)


def _waves(seed: int) -> Field:
    """Real and imaginary part of 60 plane waves of wave number 6 in a cube of side 3."""
    chance = np.random.default_rng(seed)
    axis = np.linspace(0, 3, 22)
    grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1)
    psi = np.zeros(grid.shape[:3], np.complex128)
    for _ in range(60):
        k = chance.normal(size=3)
        psi += np.exp(1j * (grid @ (6 * k / np.linalg.norm(k)) + chance.uniform(0, 2 * np.pi)))
    return _pair(psi.real, psi.imag, 3 / 21)


def _noise(seed: int) -> Field:
    """Independent normal numbers: every configuration, many ambiguous faces."""
    a, b = np.random.default_rng(seed + 1).normal(size=(2, 9, 8, 10))
    return _pair(a, b, (1.0, 0.5, 2.0))


def _grid(n: int) -> list[Points]:
    """Coordinates -1 to 1."""
    return list(np.meshgrid(*[np.linspace(-1, 1, n)] * 3, indexing="ij"))


def _apart() -> Field:
    """A small ball in a large one: the surfaces never meet."""
    x, y, z = _grid(13)
    r2 = x**2 + y**2 + z**2
    return _pair(0.31 - r2, 0.83 - r2, 1 / 6)


def _identical() -> Field:
    """The same ball twice."""
    x, y, z = _grid(11)
    ball = 0.53 - x**2 - 0.9 * y**2 - 1.1 * z**2
    return _pair(ball, ball, 0.2)


def _tangent() -> Field:
    """A ball on a plane."""
    x, y, z = _grid(13)
    return _pair(0.25 - x**2 - y**2 - z**2, z + 0.5, 1 / 6)


def _integers() -> Field:
    """Balls in small integers: samples on the isovalue, ties on edges."""
    x, y, z = np.indices((9, 9, 9)) - 4
    return _pair(9 - x**2 - y**2 - z**2, 9 - (x - 2) ** 2 - y**2 - z**2)


def pose(variant: str, case: Case, field: Field) -> Field:
    """The field of a variant of a case: ``plain``, ``swapped`` or ``finer``."""
    if variant == "swapped":
        return Field.of(field.values[::-1].copy(), field.spacing, field.origin, dimension=3)
    if variant == "finer":
        n1, n2, n3 = COARSE
        return _sampled(known_curves()[case.id], (2 * n1 - 1, 2 * n2 - 1, 2 * n3 - 1))
    return field
