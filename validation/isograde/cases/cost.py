"""One field a kind, of some size, for what calls cost and how they bear company.

It is small enough to be asked a hundred times, and large enough that a leaked answer shows. Its
mirror images make a field 2^n times as large, with as much work a sample (the variant "larger").
"""

from __future__ import annotations

from functools import partial

import numpy as np
from isoref.field import Field, Integers

from isograde.cases.frozen import STEP, integers
from isograde.model import CONTOURS, CURVES, SURFACES, Case, Kind

SHAPES = {SURFACES: (24, 25, 26), CONTOURS: (120, 110), CURVES: (12, 13, 14)}
PASSES = 2


def blurred(numbers: Integers) -> Integers:
    """1 2 1 along every axis but the first, again and again, each time two samples shorter."""
    for axis in list(range(1, numbers.ndim)) * PASSES:
        turned = np.moveaxis(numbers, axis, 0)
        numbers = np.moveaxis(turned[:-2] + 2 * turned[1:-1] + turned[2:], 0, axis)
    return numbers


def field(name: str, seed: int, kind: Kind) -> Field:
    """Smooth noise, of as many components as the kind has."""
    shape = (kind.m, *(n + 2 * PASSES for n in SHAPES[kind]))
    numbers = blurred(integers(name, seed, shape, -1024, 1024))
    values = np.ascontiguousarray((2 * numbers + 1) * STEP / 4.0 ** (PASSES * kind.n))
    return Field.of(values if kind.m > 1 else values[0], dimension=kind.n)


def cases(seed: int = 0) -> list[Case]:
    """A field for surfaces, for contours and for curves; isovalues 0."""
    made = []
    for kind, shape in SHAPES.items():
        name = f"cost/{kind}"
        tags = frozenset({"cost", "posed"})
        asked = ("structure.answers", "calls.*")
        build = partial(field, name, seed, kind)
        samples = int(np.prod(shape))
        made.append(Case(name, build, (0.0,) * kind.m, samples, tags, kind=kind, only=asked))
    return made
