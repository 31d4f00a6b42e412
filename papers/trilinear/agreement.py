"""How far an implementation agrees with the trilinear truth, case by case."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
import whole
from isograde.adapters import ready_made_names
from isograde.claims.cells import on_cell_edges
from isograde.model import SURFACES, Adapter, AdapterError, Limits
from isograde.oracles.self_intersections import self_intersections
from isograde.oracles.sheets import Fault, judge
from isograde.oracles.trilinear import NONE, cells
from isograde.oracles.trilinear_cases import case_names, every_topology
from isograde.oracles.trilinear_grid import active_cells
from numpy.typing import NDArray
from posing import (
    Floats,
    crowded,
    faults,
    posed_to,
    random_cells,
    side_of,
    stacked,
    surface,
    targeted,
    tunnel_pairs,
)


@dataclass
class Agreement:
    """One implementation's row of the table.

    right, total : cells of each case, over the targeted cells
    faults : faults of each case
    whole : cells of each case whose island (see `whole`) has the true surface
    random : right and all random cells
    crowded : pairs of tunnel cells in which an edge has more than two triangles, of 72
    crossing : pairs of triangles that meet where they should not, in the targeted cells
    why_not_cells : why single cells could not be judged, or ""
    why_not : why nothing could be, or ""
    """

    name: str
    version: str = ""
    right: Counter[str] = field(default_factory=Counter)
    total: Counter[str] = field(default_factory=Counter)
    faults: Counter[tuple[str, str]] = field(default_factory=Counter)
    whole: Counter[str] = field(default_factory=Counter)
    random: tuple[int, int] = (0, 0)
    crowded: int = 0
    crossing: int = 0
    why_not_cells: str = ""
    why_not: str = ""


@dataclass(frozen=True, eq=False)
class Posed:
    """What is asked of every implementation.

    values, names : the targeted cells and their cases
    islands : (n, 2) components and Euler characteristic on the island of each
    random : random cells
    """

    values: Floats
    names: list[str]
    islands: NDArray[np.int64]
    random: Floats


def posed(share: int) -> Posed:
    """The targeted cells, or a share of them, and 10,000 random ones."""
    values = targeted()[1][::share]
    names: list[str] = case_names(cells(values)).tolist()
    return Posed(values, names, whole.truth(values), random_cells(10_000 // share, 4))


def agreement(name: str, asked: Posed) -> Agreement:
    """The implementation's row."""
    adapter, row = posed_to(name), Agreement(name)
    try:
        said = adapter.open(Limits(seconds=120))
        row.version = said.version
        row.total = Counter(asked.names)
        good, islands = whole.right(adapter, asked.values, asked.islands, side_of(name))
        row.whole = Counter(np.array(asked.names)[good].tolist())
        if not on_cell_edges(said):
            row.why_not_cells = "its vertices are not on the lattice's edges"
            row.crossing = len(self_intersections(islands.points, islands.simplices))
        else:
            _judge_cells(adapter, row, asked)
    except AdapterError as error:
        row.why_not = str(error).splitlines()[0]
    finally:
        adapter.close()
    return row


def _judge_cells(adapter: Adapter, row: Agreement, asked: Posed) -> None:
    """What is true of the implementation cell by cell."""
    side = side_of(row.name)
    found = faults(adapter, asked.values, side)
    for case, fault in zip(asked.names, found, strict=True):
        row.right[case] += fault is Fault.NONE
        if fault is not Fault.NONE:
            row.faults[case, str(fault)] += 1
    wild = faults(adapter, asked.random if side > 2 else asked.random[:1000], side)
    row.random = (sum(f is Fault.NONE for f in wild), len(wild))
    row.crowded = sum(crowded(adapter, pair) for pair in tunnel_pairs())
    row.crossing = crossing(adapter, asked.values, side)


def crossing(adapter: Adapter, values: Floats, side: int) -> int:
    """Pairs of triangles of one cell that meet in more than they share, over all the cells."""
    total = 0
    for start in range(0, len(values), side**3):
        block = values[start : start + side**3]
        padded = np.concatenate([block, np.ones((side**3 - len(block), 2, 2, 2))])
        answer = surface(adapter, stacked(padded, side))
        middle = answer.points[answer.simplices].mean(axis=1)
        here = ((middle - 1) % 3 <= 1).all(axis=1)
        total += len(self_intersections(answer.points, answer.simplices[here]))
    return total


def implementations() -> list[str]:
    """Every ready-made name, the reference last."""
    return sorted(ready_made_names(SURFACES), key=lambda name: (name.startswith("isoref"), name))


def noise_grids(number: int, size: int) -> Iterator[Floats]:
    """Grids of noise, no sample nearer to zero than 1/16."""
    rng = np.random.default_rng(0)
    for _ in range(number):
        yield rng.integers(64, 1024, (size,) * 3) / 1024 * rng.choice([-1, 1], (size,) * 3)


def grids_of_noise(adapter: Adapter, number: int, size: int) -> tuple[int, int, int]:
    """Over grids of noise: cells, wrong cells, grids with an edge of more than two triangles."""
    total = wrong = crowds = 0
    for values in noise_grids(number, size):
        answer = surface(adapter, values)
        index, corners = active_cells(values, 0.0)
        truths = cells(corners)
        found = judge(answer.points, answer.simplices, index, truths, values.shape)
        good = truths.ties == NONE
        total += int(good.sum())
        wrong += sum(f is not Fault.NONE for f, g in zip(found, good, strict=True) if g)
        crowds += len(answer.crowded_facets) > 0
    return total, wrong, crowds


def crossing_in_grids(adapter: Adapter, number: int, size: int) -> int:
    """Pairs of triangles that meet in more than they share, over the first of these grids."""
    return sum(
        len(self_intersections(answer.points, answer.simplices))
        for answer in (surface(adapter, values) for values in noise_grids(number, size))
    )


def decided(high: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(n,) whether the signs (n, 8) alone decide: only one topology has them."""
    number: Counter[tuple[int, ...]] = Counter(one.signs for one in every_topology())
    only = np.array(
        [number[tuple(1 if code >> c & 1 else -1 for c in range(8))] == 1 for code in range(256)]
    )
    return np.asarray(only[high @ (1 << np.arange(8))])
