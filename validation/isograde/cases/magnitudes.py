"""Large and small numbers, and small differences on large ones.

Everything here is a number of single precision, and so is every difference between a sample and
the isovalue. What a scale or an offset leaves of the answer is asked by variants as well, up to
1e300 (`isograde.claims.ranges`); these are the fields of which every claim must hold.

Glossary
--------
small, large    noise of about 1e-7, and of about 1e7
offset          smooth noise of about 1, or white noise, at an isovalue of 8192
single          noise in single precision at an isovalue of 10,000, where it has ties
mixed           samples of about 2 ** -6 to 2 ** 6 side by side; or from 2 ** -30 to 2 ** 30, where
                nearly every crossing is at the end of its edge
"""

from __future__ import annotations

from functools import partial

import numpy as np
from isoref.field import Field

from isograde.cases.frozen import STEP, integers, uniform
from isograde.cases.noise import smooth, white
from isograde.cases.shapes import gentle
from isograde.model import Case

SIZE = (6, 7, 6)
OFFSET, LEVEL = 8192.0, 10_000.0


def scaled(name: str, seed: int, factor: float) -> Field:
    """White noise times a power of two."""
    return Field.of(white(name, seed, SIZE).values * factor)


def lifted(name: str, seed: int) -> Field:
    """White noise, lifted."""
    return Field.of(white(name, seed, SIZE).values + OFFSET)


def lifted_smooth(name: str, seed: int) -> Field:
    """Smooth noise rounded to odd multiples of the step, lifted."""
    values = smooth(name, seed, (10, 9, 11), 1).values
    return Field.of((2 * np.floor(values / (2 * STEP)) + 1) * STEP + OFFSET)


def single(name: str, seed: int) -> Field:
    """White noise at 10,000, rounded to single precision: one sample in a thousand ties."""
    noise = uniform(name, seed, (12, 12, 12)) - 0.5
    return Field.of((LEVEL + 2 * noise).astype(np.float32))


def mixed(name: str, seed: int, reach: int) -> Field:
    """Noise whose samples are of the order of 2 ** -reach to 2 ** reach, each by chance."""
    exponent = integers(f"{name}/exponent", seed, SIZE, -reach, reach + 1)
    return Field.of(gentle(name, seed, SIZE) * 2.0**exponent)


def cases(seed: int = 0) -> list[Case]:
    """The fields above."""
    samples = int(np.prod(SIZE))
    made = []
    for word, factor in (("small", 2.0**-23), ("large", 2.0**23)):
        name = f"magnitudes/{word}"
        made.append(_case(name, partial(scaled, name, seed, factor), 0.0, samples))
    name = "magnitudes/offset"
    made.append(_case(name, partial(lifted, name, seed), OFFSET, samples))
    name = "magnitudes/offset-smooth"
    made.append(_case(name, partial(lifted_smooth, name, seed), OFFSET, 990))
    for number in range(3):
        name = f"magnitudes/single-{number}"
        made.append(_case(name, partial(single, name, seed), LEVEL, 12**3))
    for reach in (6, 30):
        name = f"magnitudes/mixed-{reach}"
        made.append(_case(name, partial(mixed, name, seed, reach), 0.0, samples))
    return made


def _case(name: str, build: partial[Field], isovalue: float, samples: int) -> Case:
    """The case of this name."""
    return Case(name, build, (isovalue,), samples, frozenset({"magnitudes", "noise"}))
