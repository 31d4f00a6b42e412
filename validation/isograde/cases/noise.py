"""Seeded noise: every configuration next to every other, and smooth fields with many parts.

White noise visits all configurations at once, ambiguous ones most of all. Smoothed noise looks
like measured data: large parts, thin necks, few ambiguous cells.

A smoothing pass adds each sample's two neighbours along each axis with weights 1 2 1, on integers,
so that the sums are exact and the numbers frozen.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from isoref.field import Field, Integers

from isograde.cases.frozen import STEP, integers
from isograde.model import Case

# Sides differ, so that a swapped axis cannot hide.
WHITE = ((5, 6, 7), (7, 5, 6), (6, 7, 5), (8, 9, 10), (10, 8, 9), (12, 12, 12))
WHITE_FULL = ((24, 25, 26), (40, 40, 40))
SMOOTH = (((14, 16, 18), 1), ((18, 16, 14), 2), ((24, 24, 24), 3))
SMOOTH_FULL = (((48, 50, 52), 2), ((64, 64, 64), 3))


def white(name: str, seed: int, shape: tuple[int, int, int]) -> Field:
    """Independent multiples of the step in [-1, 1), none of them 0."""
    drawn = integers(name, seed, shape, -1024, 1023)
    return Field.of(np.where(drawn >= 0, drawn + 1, drawn) * STEP)


def smooth(name: str, seed: int, shape: tuple[int, int, int], passes: int) -> Field:
    """White noise after this many passes of 1 2 1 along each axis; odd, so that none is 0."""
    padded = tuple(n + 2 * passes for n in shape)
    numbers = integers(name, seed, padded, -1024, 1024)
    for _ in range(passes):
        for axis in range(3):
            numbers = _weighted(numbers, axis)
    return Field.of((2 * numbers + 1) * STEP / 64**passes)


def _weighted(numbers: Integers, axis: int) -> Integers:
    """1 2 1 along one axis, two samples shorter."""
    turned = np.moveaxis(numbers, axis, 0)
    return np.moveaxis(turned[:-2] + 2 * turned[1:-1] + turned[2:], 0, axis)


def cases(seed: int = 0) -> list[Case]:
    """White and smooth noise in several sizes; isovalue 0."""
    drawn = [_white(shape, seed, full=False) for shape in WHITE]
    drawn += [_smooth(shape, passes, seed, full=False) for shape, passes in SMOOTH]
    drawn += [_white(shape, seed, full=True) for shape in WHITE_FULL]
    drawn += [_smooth(shape, passes, seed, full=True) for shape, passes in SMOOTH_FULL]
    return drawn


def _white(shape: tuple[int, int, int], seed: int, *, full: bool) -> Case:
    """White noise of this shape."""
    name = "noise/white-" + "x".join(map(str, shape))
    samples = int(np.prod(shape))
    # Ask on the small ones too over which magnitudes the answer stays.
    tags = _tags(full) | ({"ranges"} if samples < 1000 else set())
    return Case(name, partial(white, name, seed, shape), (0.0,), samples, tags)


def _smooth(shape: tuple[int, int, int], passes: int, seed: int, *, full: bool) -> Case:
    """Smoothed noise of this shape."""
    name = f"noise/smooth-{passes}-" + "x".join(map(str, shape))
    build = partial(smooth, name, seed, shape, passes)
    return Case(name, build, (0.0,), int(np.prod(shape)), _tags(full))


def _tags(full: bool) -> frozenset[str]:
    """The tags of noise; what runs by default is also posed in every variant."""
    return frozenset({"noise", "full" if full else "posed"})
