"""Fields with structure that noise never has: constant along axes, mirrored, padded, in steps.

Programs that decide inside a cell divide by differences; where a field does not change along an
axis, these are nothing. A published implementation of Marching Cubes 33 makes a false tunnel in
every ambiguous cell that is constant along an axis, which padding by the nearest sample gives.

Glossary
--------
along       constant along these axes
padded      noise in a rim of two samples that repeat the nearest one
mirrored    noise and its mirror image about a layer of samples, along each axis
plateaus    steps of whole numbers, with the isovalue between two
thin edges  crossings within 2e-4 of an edge's end, and within 1e-5, which is a tie
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from isoref.field import Field

from isograde.cases.frozen import integers
from isograde.cases.noise import white
from isograde.cases.shapes import gentle
from isograde.model import Case

SIZE = (6, 7, 8)
BETWEEN = 1 + 105 / 256
"""No mean of whole numbers at the corners of a cell, so that resampling makes no tie of it."""


def along(name: str, seed: int, axes: tuple[int, ...]) -> Field:
    """Noise that is constant along these axes."""
    shape = tuple(1 if axis in axes else n for axis, n in enumerate(SIZE))
    values = white(name, seed, (shape[0], shape[1], shape[2])).values
    return Field.of(np.ascontiguousarray(np.broadcast_to(values, SIZE)))


def padded(name: str, seed: int) -> Field:
    """Noise in a rim that repeats it."""
    return Field.of(np.pad(white(name, seed, (3, 4, 5)).values, 2, mode="edge"))


def mirrored(name: str, seed: int) -> Field:
    """Noise, and behind a layer of samples its mirror image, along each axis."""
    return Field.of(
        np.pad(white(name, seed, (4, 4, 3)).values, ((0, 3), (0, 3), (0, 2)), "reflect")
    )


def plateaus(name: str, seed: int) -> Field:
    """Blocks of 2 x 2 x 2 equal samples of 0 to 3."""
    blocks = integers(name, seed, (3, 4, 3), 0, 4)
    return Field.of(np.kron(blocks, np.ones((2, 2, 2), np.int64)).astype(np.float64))


def thin_edges(name: str, seed: int, share: float) -> Field:
    """High samples of about 1, low ones this much of it: crossings near the low ends."""
    values = gentle(name, seed, (5, 6, 4))
    return Field.of(np.where(values > 0, values, values * share))


def spaced(name: str, seed: int, spacing: tuple[float, float, float]) -> Field:
    """Noise on a lattice of this spacing."""
    return Field.of(gentle(name, seed, (5, 4, 6)), spacing)


def cases(seed: int = 0) -> list[Case]:
    """The fields above; isovalue 0, of plateaus between two steps."""
    made = []
    for axes in ((0,), (1,), (2,), (0, 1), (0, 2), (1, 2)):
        name = "structured/along-" + "".join(map(str, axes))
        tags = ("posed", "ranges") if axes in ((1,), (0, 2)) else ()
        made.append(_case(name, partial(along, name, seed, axes), 336, *tags))
    build: Callable[[str, int], Field]
    for name, build, samples in (
        ("structured/padded", padded, 7 * 8 * 9),
        ("structured/mirrored", mirrored, 7 * 7 * 5),
    ):
        made.append(_case(name, partial(build, name, seed), samples))
    name = "structured/plateaus"
    made.append(_case(name, partial(plateaus, name, seed), 6 * 8 * 6, isovalue=BETWEEN))
    for name, share in (("structured/edges-2e-4", 2e-4), ("structured/edges-1e-5", 1e-5)):
        made.append(_case(name, partial(thin_edges, name, seed, share), 120))
    for word, spacing in (
        ("1e-6", (1e-6, 1e-6, 1e-6)),
        ("ratio", (1e-3, 1.0, 1.0)),
        ("million", (1e6, 2e6, 3e6)),
        ("first", (1.0, 2.0, 0.5)),
        ("second", (2.0, 1.0, 0.5)),
        ("third", (0.5, 2.0, 1.0)),
        ("but-first", (0.5, 2.0, 2.0)),
        ("but-second", (2.0, 0.5, 2.0)),
        ("but-third", (2.0, 2.0, 0.5)),
        ("nanometres", (4e-9, 4e-9, 3e-8)),
        ("flat", (1e-6, 1.0, 1.0)),
    ):
        name = f"structured/spacing-{word}"
        made.append(_case(name, partial(spaced, name, seed, spacing), 120))
    return made


def _case(
    name: str, build: partial[Field], samples: int, *tags: str, isovalue: float = 0.0
) -> Case:
    """The case of this name."""
    return Case(name, build, (isovalue,), samples, frozenset({"structured", "noise", *tags}))
