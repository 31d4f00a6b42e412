"""The smallest cell of whole numbers in which an implementation errs, for each of its faults."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
import posing
from isograde.cases import trilinear_cells
from isograde.cases.trilinear_cells import TUNNELS
from isograde.claims.cells import on_cell_edges
from isograde.model import Adapter, AdapterError, Limits
from isograde.oracles.sheets import Fault
from isograde.oracles.trilinear import NONE, cells
from isograde.oracles.trilinear_cases import case_names

DRAWN = 4000


@dataclass(frozen=True)
class Smallest:
    """A cell of small whole numbers in which an implementation errs."""

    name: str
    case: str
    fault: str
    values: tuple[int, ...]


def small_cells(limit: int, seed: int) -> posing.Floats:
    """4,000 cells of whole numbers from -limit to limit, none of them a tie."""
    rng = np.random.default_rng((seed, limit))
    drawn = rng.integers(1, limit + 1, (4 * DRAWN, 2, 2, 2)) * rng.choice(
        [-1, 1], (4 * DRAWN, 2, 2, 2)
    )
    good = drawn[cells(drawn).ties == NONE][:DRAWN]
    filler = np.full((DRAWN - len(good), 2, 2, 2), 1)
    return np.concatenate([good, filler]).astype(float)


def checkered_cells(limit: int, seed: int) -> posing.Floats:
    """The same, in two thirds of them with the signs of a tunnel case."""
    values = np.abs(small_cells(limit, seed + 1))
    patterns = [np.sign(trilinear_cells.far(name, 0)[0]) for name in TUNNELS]
    rng = np.random.default_rng((seed, limit, 1))
    signs = np.array(patterns)[rng.integers(0, len(patterns), DRAWN)]
    signs *= rng.choice([-1, 1], (DRAWN, 1, 1, 1))
    return np.asarray(values * signs)


def smallest_failures(name: str, limits: Iterable[int] = range(2, 13)) -> list[Smallest]:
    """For each fault the implementation has, the cell of least numbers found."""
    adapter = posing.posed_to(name)
    best: dict[str, tuple[tuple[float, ...], Smallest]] = {}
    try:
        if not on_cell_edges(adapter.open(Limits(seconds=120))):
            return []
        for limit in limits:
            for draw in (small_cells, checkered_cells):
                _keep_smallest(name, adapter, draw, limit, best)
    except AdapterError:
        return []
    finally:
        adapter.close()
    return [small for _, small in best.values()]


def _keep_smallest(
    name: str,
    adapter: Adapter,
    draw: Callable[[int, int], posing.Floats],
    limit: int,
    best: dict[str, tuple[tuple[float, ...], Smallest]],
) -> None:
    """Put into `best` what is smaller than what is there."""
    values = draw(limit, 0)
    truths = cells(values)
    names = case_names(truths)
    for i, fault in enumerate(posing.faults(adapter, values, posing.side_of(name))):
        if fault is Fault.NONE or truths.ties[i] != NONE:
            continue
        flat = values[i].reshape(-1)
        size = (float(np.abs(flat).max()), float(np.abs(flat).sum()), *flat.tolist())
        if str(fault) not in best or size < best[str(fault)][0]:
            small = Smallest(name, str(names[i]), str(fault), tuple(int(x) for x in flat))
            best[str(fault)] = (size, small)
