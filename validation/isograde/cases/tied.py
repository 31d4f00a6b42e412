"""More ties than chance gives: ones, whole numbers, plates at the isovalue, saddles on it.

`isograde.cases.ties` has patterns and configurations. These fields have many ties at once, of each
kind: samples at the isovalue, saddles of faces and of bodies on it, plates that are one sample
thick.

Glossary
--------
ones        noise of 1 and -1: no sample is tied, and every ambiguous face has a tied saddle
whole       noise of whole numbers from -2 to 2, at the isovalues 0 and 1
product     (i - 2) (j - 3) and (i - 2) (j - 3) (k - 2): lines of saddles at the isovalue
plates      low samples, but for a plate of samples at the isovalue: flat, or in steps
"""

from __future__ import annotations

from functools import partial

import numpy as np
from isoref.field import Field

from isograde.cases.frozen import integers
from isograde.model import Case

SIZE = (5, 6, 7)
SEEDS = 3


def ones(name: str, seed: int) -> Field:
    """Noise of 1 and -1."""
    return Field.of(2.0 * integers(name, seed, SIZE, 0, 2) - 1)


def whole(name: str, seed: int) -> Field:
    """Noise of whole numbers from -2 to 2."""
    return Field.of(integers(name, seed, SIZE, -2, 3).astype(np.float64))


def product(axes: int) -> Field:
    """The product of the distances from layers across the first axes."""
    distances = np.indices(SIZE) - np.array([2, 3, 2]).reshape(3, 1, 1, 1)
    return Field.of(distances[:axes].prod(axis=0).astype(np.float64))


def plates(steps: bool) -> Field:
    """A plate of samples at the isovalue, amid low ones; with `steps` it climbs by one sample."""
    values = np.full(SIZE, -1.0)
    i, j, _ = np.indices(SIZE)
    values[i == (1 + j // 2 if steps else 2)] = 0
    return Field.of(values)


def cases(seed: int = 0) -> list[Case]:
    """The fields above."""
    made = []
    for number in range(SEEDS):
        name = f"tied/ones-{number}"
        made.append(_case(name, partial(ones, name, seed), 0.0))
        name = f"tied/whole-{number}"
        made.append(_case(name, partial(whole, name, seed), float(number % 2)))
    made += [_case(f"tied/product-{axes}", partial(product, axes), 0.0) for axes in (2, 3)]
    made.append(_case("tied/plate", partial(plates, False), 0.0))
    made.append(_case("tied/plate-in-steps", partial(plates, True), 0.0))
    return made


def _case(name: str, build: partial[Field], isovalue: float) -> Case:
    """The case of this name."""
    return Case(name, build, (isovalue,), int(np.prod(SIZE)), frozenset({"ties"}))
