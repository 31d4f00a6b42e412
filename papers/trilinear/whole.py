"""Judging a whole surface: for implementations that no single cell can be asked of.

A dual method, or one with a lattice of its own, promises nothing about the crossings on the edges
of our cells. But put a cell amid low samples, and its level set closes to a surface of its own:
how many pieces that has, and its Euler characteristic, any mesh can be asked. The samples around
add no choice: a cell or face with a low side has no ambiguity of its own.

An island is 4^3 samples, the cell in the middle; islands stand side by side in one field.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import posing
from isograde.model import Adapter
from isograde.oracles.complexes import Complex
from isograde.oracles.rows import components_of
from isograde.oracles.trilinear import NONE, cells
from isograde.oracles.trilinear_grid import grid
from numpy.typing import NDArray

SIZE = 4
Ints = NDArray[np.int64]


def island(cell: posing.Floats) -> posing.Floats:
    """The cell amid low samples."""
    return np.pad(cell, 1, constant_values=-1.0)


def archipelago(values: posing.Floats, side: int) -> posing.Floats:
    """The field in which side^3 islands stand side by side."""
    pad = [(0, 0)] + [(1, 1)] * 3
    islands = np.pad(values, pad, constant_values=-1.0).reshape(*(side,) * 3, *(SIZE,) * 3)
    return islands.transpose(0, 3, 1, 4, 2, 5).reshape((SIZE * side,) * 3)


def truth(values: posing.Floats) -> Ints:
    """(n, 2) components and Euler characteristic of the level set on each cell's island.

    Cells of one topology have one answer, so that one of each is glued.
    """
    known = cells(values)
    assert (known.ties == NONE).all(), "a cell that is a tie has no single truth"
    rows = np.column_stack([known.high, known.faces, known.body])
    _, first, back = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    glued = [grid(island(values[i])) for i in first]
    return np.array([(one.components, one.euler) for one in glued])[back.reshape(-1)]


def found(answer: Complex, side: int) -> Ints:
    """(side^3, 2) components and Euler characteristic of the mesh on each island."""
    place = np.floor((answer.points + 0.5) / SIZE).astype(np.int64)
    home = np.ravel_multi_index(tuple(np.clip(place, 0, side - 1).T), (side,) * 3)
    used = answer.used
    _, component = components_of(len(answer.points), answer.facets.rows.T)
    _, lowest = np.unique(component[used], return_index=True)
    pieces = home[used][lowest]
    total = side**3
    euler = np.bincount(home[used], minlength=total)
    euler -= np.bincount(home[answer.facets.rows[:, 0]], minlength=total)
    euler += np.bincount(home[answer.simplices[:, 0]], minlength=total)
    return np.stack([np.bincount(pieces, minlength=total), euler], axis=1)


def answers(adapter: Adapter, values: posing.Floats, side: int) -> Iterator[tuple[Complex, int]]:
    """What the implementation makes of the islands, and how many of them are cells of ours."""
    for start in range(0, len(values), side**3):
        block = values[start : start + side**3]
        padded = np.concatenate([block, np.full((side**3 - len(block), 2, 2, 2), -1.0)])
        yield posing.surface(adapter, archipelago(padded, side)), len(block)


def right(
    adapter: Adapter, values: posing.Floats, wanted: Ints, side: int
) -> tuple[NDArray[np.bool_], Complex]:
    """(n,) islands with the true components and Euler characteristic; and the first answer."""
    made, kept = [], None
    for answer, number in answers(adapter, values, side):
        kept = answer if kept is None else kept
        made.append(found(answer, side)[:number])
    assert kept is not None, "there are cells"
    return (np.concatenate(made) == wanted).all(axis=1), kept
