"""Cells at the isovalue at which a tunnel of theirs ends: whether the mesh jumps there.

The isovalue is the value of a saddle inside the cell. A little to one side of it the cell has a
tunnel, a little to the other it has none, and nothing else happens: signs and faces stay. The level
set itself moves by about the root of the step. The cell stands amid low samples, so that its
surfaces are closed, and anybody can be asked. Tunnels also end at saddles of faces; there every
mesh without vertices on faces jumps (`papers/trilinear`), and no case is made of it.

Glossary
--------
level     the isovalue, to the last bit of doubles: found by halving, with
          `isograde.oracles.trilinear`
CLEAR     as far from the level nothing has happened yet

These cases run in full runs alone: ``isograde grade NAME --full --only accuracy.continuity``.
"""

from __future__ import annotations

from functools import cache, partial
from itertools import product

import numpy as np
from isoref.field import Field, Floats

from isograde.cases.trilinear_cells import TUNNELS, drawn_cells, topology_of
from isograde.model import Case

CLEAR = 2.0**-7
AROUND = -1.5
CELLS = 2
"""So many cells of each case that has a tunnel."""

# What a case of this family is judged by.
ONLY = ("accuracy.continuity", "structure.*", "topology.closed", "topology.oriented")


def end_of_tunnel(cell: Floats) -> float | None:
    """The isovalue nearest 0 at which the tunnel ends inside the cell and nothing else happens.

    None where it ends at a face, or with the sign of a corner, or too near to something else.
    """
    here = topology_of(cell)
    for way in (1.0, -1.0):
        tunnel, none = 0.0, way * 0.5
        if topology_of(cell - none).tunnels:
            continue
        for _ in range(60):
            middle = (tunnel + none) / 2
            if topology_of(cell - middle).tunnels:
                tunnel = middle
            else:
                none = middle
        beside = [topology_of(cell - (none + side * way * CLEAR)) for side in (-1, 1)]
        alike = all((one.signs, one.faces) == (here.signs, here.faces) for one in beside)
        if alike and beside[0].tunnels and not beside[1].tunnels:
            return none
    return None


@cache
def cells_of(name: str, seed: int) -> tuple[tuple[Floats, float], ...]:
    """The first random cells of this case whose tunnel ends inside them, with the isovalue."""
    found: list[tuple[Floats, float]] = []
    for cell in drawn_cells(name, seed):
        level = end_of_tunnel(cell)
        if level is not None:
            found.append((cell, level))
        if len(found) == CELLS:
            break
    return tuple(found)


def cases(seed: int = 0) -> list[Case]:
    """The cases "passing/4.2/0" ..; the isovalue is in the samples, so that it is 0."""
    return [
        Case(
            f"passing/{name}/{number}",
            partial(_field, name, number, seed),
            (0.0,),
            4**3,
            frozenset({"passing", "full", "posed"}),
            only=ONLY,
        )
        for name, number in product(TUNNELS, range(CELLS))
    ]


def _field(name: str, number: int, seed: int) -> Field:
    """The cell amid low samples."""
    cell, level = cells_of(name, seed)[number]
    return Field.of(np.pad(cell - level, 1, constant_values=AROUND))
