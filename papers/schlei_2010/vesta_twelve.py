"""Where 12-cycles occur in a volume, decided for every isovalue at once (section II.E, Fig. 12e).

A 12-cycle crosses all twelve edges of its cell, so its active corners are every other corner: one
of the cube's two tetrahedra. That needs the lowest value of the one above the highest of the
other, and an isovalue between the two. What the averages of the faces then decide changes only
where the isovalue passes one of them. So each cell is settled by seven numbers, and a volume by
one pass: either it lists every isovalue with a 12-cycle, or it proves that there is none.

Glossary
--------
alternating  a cell whose one tetrahedron lies above the other
span         (low, high]: the cell has a 12-cycle in mixed mode for low < isovalue <= high
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from isoref.cube import CORNERS, FACE_CORNERS
from isoref.field import Array, Booleans, Floats, Integers
from isoref.marching_vesta import cycles

TETRAHEDRA = tuple([c for c in range(8) if sum(CORNERS[c]) % 2 == odd] for odd in (0, 1))


@dataclass(frozen=True, eq=False)
class Twelve:
    """The 12-cycles of a volume in mixed mode.

    Attributes
    ----------
    cells, alternating : how many cells the volume has, and how many of them alternate
    spans : (n, 2) low and high of each span
    """

    cells: int
    alternating: int
    spans: Floats

    def count(self, isovalue: Any) -> Integers:
        """How many 12-cycles there are at these isovalues."""
        begun, over = (np.searchsorted(np.sort(end), isovalue) for end in self.spans.T)
        return np.asarray(begun - over)

    def richest(self) -> tuple[float, int]:
        """The isovalue with most 12-cycles, the lowest among equals, and how many it has."""
        candidates = np.unique(self.spans[:, 1])
        found = self.count(candidates)
        return float(candidates[found.argmax()]), int(found.max())


def scan(values: Array) -> Twelve:
    """Every span of every cell.

    >>> scan(np.array([[[0, 6], [5, 2]], [[5, 1], [2, 6]]])).spans.tolist()
    [[3.25, 3.5]]
    """
    alternating, spans = 0, [np.empty((0, 2))]
    for corners, active in _alternating(values):
        alternating += corners.shape[1]
        spans.append(_spans(corners.astype(np.float64), active))
    cells = int(np.prod(np.maximum(np.subtract(values.shape, 1), 0)))
    return Twelve(cells, alternating, np.concatenate(spans))


def _alternating(values: Array) -> Iterator[tuple[Array, list[int]]]:
    """Plane by plane, the corner values (8, n) of alternating cells and their active corners."""
    for plane in range(values.shape[0] - 1):
        corner = [_corner(values[plane : plane + 2], c) for c in range(8)]
        for high, low in (TETRAHEDRA, TETRAHEDRA[::-1]):
            above = np.minimum.reduce([corner[c] for c in high])
            below = np.maximum.reduce([corner[c] for c in low])
            at = np.nonzero(above > below)
            yield np.stack([x[at] for x in corner]), high


def _corner(layers: Array, c: int) -> Array:
    """(N2 - 1, N3 - 1) the values at corner c of the cells between two planes."""
    i, j, k = CORNERS[c]
    rows, columns = np.subtract(layers.shape[1:], 1)
    return layers[i, j : j + rows, k : k + columns]


def _spans(corners: Floats, active: list[int]) -> Floats:
    """The spans of cells with these corner values (8, n), their active corners the higher ones."""
    low = corners[[c for c in range(8) if c not in active]].max(axis=0)
    high = corners[active].min(axis=0)
    means = np.stack([corners[list(walk)].sum(axis=0) / 4 for walk in FACE_CORNERS])
    # Cut low .. high at each mean; the isovalue at the upper end of a piece stands for all of it.
    ends = np.sort(np.clip(np.vstack([low, means, high]), low, high), axis=0)
    pieces = np.stack([ends[:-1], ends[1:]], axis=-1)
    separated = (means[:, None] < ends[1:]) << np.arange(6)[:, None, None]
    twelve = has_twelve(sum(1 << c for c in active))[separated.sum(axis=0)]
    spans: Floats = pieces[twelve & (ends[:-1] < ends[1:])]
    return spans


@cache
def has_twelve(signs: int) -> Booleans:
    """(64,) which decisions give a cell with these signs a 12-cycle."""
    return np.array([12 in map(len, cycles(signs, separated)) for separated in range(64)])
