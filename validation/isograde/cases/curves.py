"""Two fields on one lattice: known curves, waves, noise, and surfaces that touch or never meet.

Facts of a known case: "curves", the `KnownCurves`; "closed" and "open", how many there are.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from isoref.field import Field
from numpy.typing import NDArray

from isograde.model import CURVES, Case
from isograde.oracles import space_curves
from isograde.oracles.space_curves import KnownCurves, Points

Shape = tuple[int, int, int]
# Samples along each axis of a known case.
COARSE: Shape = (24, 27, 25)
FINE: Shape = (61, 43, 52)
# Known curves of functions that bend little in a cell of it.
GENTLE = ("two-spheres", "two-cylinders", "hydrogen-ring")


def cases(seed: int = 0) -> list[Case]:
    """Every case, deterministic for a seed."""
    return [
        *(_known_case(make()) for make in space_curves.KNOWN),
        *(_directed_case(known) for make in space_curves.KNOWN if (known := make()).name in GENTLE),
        _case("waves", partial(_waves, seed), (22, 22, 22), "full"),
        _case("noise", partial(_noise, seed), (9, 8, 10), "noise posed"),
        _case("noise-small", partial(_small_noise, seed), (6, 5, 7), "noise posed"),
        _case("bytes", partial(_whole_noise, seed), (6, 7, 5), "noise posed", (99.5, 120.5)),
        _case("apart", _apart, (13, 13, 13), "empty"),
        _case("identical", _identical, (11, 11, 11), "identical"),
        _case("tangent", _tangent, (13, 13, 13), "touching"),
        _case("integers", _integers, (9, 9, 9), "ties posed"),
    ]


def _case(
    name: str,
    build: Callable[[], Field],
    shape: Shape,
    tags: str,
    isovalues: tuple[float, float] = (0.0, 0.0),
) -> Case:
    """The case of this name; `tags` are separated by spaces."""
    labels = frozenset({"curves", *tags.split()})
    samples = int(np.prod(shape))
    return Case(f"curves/{name}", build, isovalues, samples, labels, {}, CURVES)


def _known_case(known: KnownCurves) -> Case:
    """The case that samples two functions whose common zeros are known."""
    tags = {"curves", "known" if known.transversal else "touching"}
    facts = {"curves": known, "closed": known.closed, "open": len(known.curves) - known.closed}
    build, samples = partial(_sampled, known), int(np.prod(COARSE))
    name = f"curves/{known.name}"
    return Case(name, build, known.levels, samples, frozenset(tags), facts, CURVES)


def _directed_case(known: KnownCurves) -> Case:
    """The same on a finer lattice, uneven along its axes, for who says where the curves go.

    In full runs alone.
    """
    build, tags = partial(_sampled, known, FINE), frozenset({"curves", "directed", "full"})
    only = ("curves.confidence", "structure.*")
    samples, facts = int(np.prod(FINE)), {"curves": known}
    name = f"curves/directed/{known.name}"
    return Case(name, build, known.levels, samples, tags, facts, CURVES, only)


def _sampled(known: KnownCurves, shape: Shape = COARSE) -> Field:
    """Both functions on the lattice, as one field."""
    first, second, spacing = known.sample(shape)
    values = np.stack([first, second])
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


def _small_noise(seed: int) -> Field:
    """The same, small enough to be in general position."""
    a, b = np.random.default_rng([seed + 1, 65]).normal(size=(2, 6, 5, 7))
    return _pair(a, b, (1.0, 0.5, 2.0))


def _whole_noise(seed: int) -> Field:
    """Numbers that are bytes, floats and 16-bit integers alike, with isovalues between them."""
    a, b = np.random.default_rng([seed + 1, 66]).integers(0, 220, (2, 6, 7, 5)).astype(float)
    return _pair(a, b)


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
