"""Two cells side by side: every pair of configurations that agrees on the shared face.

The flaw of the original marching cubes needs two cells: each is sound by itself, and they connect
the four points on their common face differently. Twelve samples, 3 x 2 x 2, are the smallest
field that can show it, and 2 ** 12 patterns of signs are all there are. A pair can disagree only
where its shared face is ambiguous; those 512 run by default, the rest with ``--full``.

Glossary
--------
pattern     twelve bits: bit i + 3 * (j + 2 * k) is set where sample (i, j, k) is inside
shared face the samples with i = 1
"""

from __future__ import annotations

from functools import partial

import numpy as np
from isoref.field import Booleans

from isograde.cases.cells import ISOVALUE, signed
from isograde.model import Case

SHAPE = (3, 2, 2)


def inside_of(pattern: int) -> Booleans:
    """The inside samples of a pattern, as an array of 3 x 2 x 2."""
    bits = pattern >> np.arange(12) & 1 == 1
    return np.asarray(bits, np.bool_).reshape(SHAPE, order="F")


def ambiguous(pattern: int) -> bool:
    """Whether the shared face has its inside samples on one diagonal and no others.

    >>> sum(ambiguous(pattern) for pattern in range(4096))
    512
    """
    (a, b), (c, d) = inside_of(pattern)[1]
    return bool(a == d and b == c and a != b)


def cases(seed: int = 0) -> list[Case]:
    """4096 cases: "pairs/0000" to "pairs/4095"; "full" where the shared face has one answer."""
    return [_case(pattern, seed) for pattern in range(4096)]


def _case(pattern: int, seed: int) -> Case:
    """The case of this pattern."""
    name = f"pairs/{pattern:04d}"
    tags = {"pairs"} if ambiguous(pattern) else {"pairs", "full"}
    return Case(
        name, partial(signed, name, seed, inside_of(pattern)), (ISOVALUE,), 12, frozenset(tags)
    )
