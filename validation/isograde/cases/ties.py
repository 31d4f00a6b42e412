"""Samples exactly at the isovalue, and faces whose saddle is exactly at it.

A sample that equals the isovalue is on one side by convention; the surface then passes through the
sample, and several of its vertices coincide there. A face whose two diagonals have equal products
has its saddle at the isovalue: any decision is right, if the two cells agree on it. Measured data
are full of both, for they are integers.

Glossary
--------
tie       a sample equal to the isovalue
saddle    of a bilinear face: its value where the asymptotes cross
"""

from __future__ import annotations

from functools import partial

import numpy as np
from isoref.field import Field, Floats, Integers

from isograde.cases.cells import embedded, representatives
from isograde.cases.frozen import integers
from isograde.model import Case


def three_values(name: str, seed: int, shape: tuple[int, int, int]) -> Field:
    """Random samples of -1, 0 and 1."""
    return Field.of(integers(name, seed, shape, -1, 2).astype(np.float64))


def minus_zero() -> Field:
    """A slab of -0.0, which is 0, amid low samples."""
    return Field.of(np.copysign(patterned("slab").values, -1.0))


def balanced(configuration: int) -> Field:
    """The configuration with every sample at distance 1: each ambiguous face has a tied saddle."""
    return Field.of(np.where(embedded(configuration, border=False), 1.0, -1.0))


def at_corners(configuration: int, rest: float) -> Field:
    """The configuration's inside corners are ties; all other samples are `rest`."""
    return Field.of(np.where(embedded(configuration, border=False), 0.0, rest))


def squares(shape: tuple[int, int, int]) -> Field:
    """Minus the squared distance from the middle, in integers: many ties at square numbers."""
    i, j, k = (np.arange(n) - n // 2 for n in shape)
    total: Integers = i[:, None, None] ** 2 + j[:, None] ** 2 + k**2
    return Field.of(-total.astype(np.float64))


def patterned(name: str) -> Field:
    """A tied sample, line, plane or slab amid low samples, a checkerboard, or ties alone."""
    values: Floats = np.full((5, 5, 5), -1.0)
    if name == "point":
        values[2, 2, 2] = 0
    elif name == "line":
        values[1:4, 2, 2] = 0
    elif name == "plane":
        values[2] = 0
    elif name == "step":
        values[2], values[3:] = 0, 1
    elif name == "slab":
        values[2:4, 1:4, 1:4] = 0
    elif name == "checkerboard":
        values += np.indices(values.shape).sum(axis=0) % 2
    else:
        values[:] = 0
    return Field.of(values)


PATTERNS = ("point", "line", "plane", "step", "slab", "checkerboard", "everywhere")
NOISE = 12


def cases(seed: int = 0) -> list[Case]:
    """Patterns, noise of three values, and every configuration with tied corners or saddles."""
    plain = frozenset({"ties"})
    made = [Case(f"ties/{name}", partial(patterned, name), (0.0,), 125, plain) for name in PATTERNS]
    made.append(Case("ties/squares", partial(squares, (11, 12, 13)), (-9.0,), 11 * 12 * 13, plain))
    for index in range(NOISE):
        name = f"ties/noise-{index:02d}"
        tags = plain | {"posed"} if index < 2 else plain
        made.append(Case(name, partial(three_values, name, seed, (4, 5, 6)), (0.0,), 120, tags))
    made.append(Case("ties/minus-zero", minus_zero, (0.0,), 125, plain))
    for configuration in range(256):
        tags = plain if configuration in representatives() else plain | {"full"}
        made += _corners(configuration, tags)
    return made


def _corners(configuration: int, tags: frozenset[str]) -> list[Case]:
    """The three cases of one configuration."""
    number = f"{configuration:03d}"
    return [
        Case(f"ties/saddle/{number}", partial(balanced, configuration), (0.0,), 64, tags),
        Case(f"ties/low/{number}", partial(at_corners, configuration, -1.0), (0.0,), 64, tags),
        Case(f"ties/high/{number}", partial(at_corners, configuration, 1.0), (0.0,), 64, tags),
    ]
