"""Cells posed to an implementation by the thousand, and what it answers.

Independent cells stand in one field, parted by layers of high samples and with one all round. What
the implementation does in the cells between them is not looked at: with high samples on one whole
side they have no tunnel, and nothing need be drawn on a face they share.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from isograde.adapters import open_adapter
from isograde.cases import trilinear_cells
from isograde.cases.trilinear_cells import TUNNELS
from isograde.model import Adapter, AdapterError, Declaration, Limits, Outcome, Request
from isograde.oracles.complexes import Complex
from isograde.oracles.sheets import Fault, judge
from isograde.oracles.trilinear import cells
from isoref.field import Field
from numpy.typing import NDArray

Floats = NDArray[np.float64]

REFERENCE = "isoref:trilinear-cubes"
# MeshLab takes small fields only; manifold3d's lattice is finer than ours.
SIDES = {"pymeshlab": 2, "pymeshlab:raw": 2, "manifold3d": 5}
# MeshLab's filter leaves the last two layers of cells along each axis out, where nobody mends it.
MARGINS = {"pymeshlab:raw": 2}


@dataclass(frozen=True)
class WithMargin:
    """An adapter that is given each field with its last layer of samples repeated."""

    adapter: Adapter
    layers: int

    def open(self, limits: Limits) -> Declaration:
        """What the implementation declares."""
        return self.adapter.open(limits)

    def run(self, request: Request) -> Outcome:
        """The outcome on the larger field."""
        wide = np.pad(request.field.values, (0, self.layers), mode="edge")
        return self.adapter.run(replace(request, field=Field.of(wide)))

    def close(self) -> None:
        """Stop the implementation."""
        self.adapter.close()


def posed_to(name: str) -> Adapter:
    """The adapter of this implementation, with a margin where it needs one."""
    layers = MARGINS.get(name, 0)
    return WithMargin(open_adapter(name), layers) if layers else open_adapter(name)


def side_of(name: str) -> int:
    """How many cells along each axis are posed at once."""
    return SIDES.get(name, 10)


def stacked(values: Floats, side: int) -> Floats:
    """The field in which these side^3 cells stand at every third place."""
    field = np.ones((3 * side,) * 3)
    spaced = field.reshape(side, 3, side, 3, side, 3)
    shape = (side, side, side, 2, 2, 2)
    spaced[:, :2, :, :2, :, :2] = values.reshape(shape).transpose(0, 3, 1, 4, 2, 5)
    return np.pad(field[:-1, :-1, :-1], 1, constant_values=1.0)


def places(side: int) -> NDArray[np.int64]:
    """(side^3, 3) where the cells of a stacked field stand."""
    return 1 + 3 * np.stack(np.unravel_index(np.arange(side**3), (side,) * 3), axis=1)


def surface(adapter: Adapter, values: Floats) -> Complex:
    """What the implementation answers, equal vertices made one. Raises `AdapterError`."""
    outcome = adapter.run(Request("papers/trilinear", "plain", Field.of(values), (0.0,)))
    if outcome.mesh is None:
        raise AdapterError(f"no mesh: {outcome.status}, {outcome.detail}")
    return Complex.of(outcome.mesh.vertices, outcome.mesh.simplices).welded()


def faults(adapter: Adapter, values: Floats, side: int = 10) -> list[Fault]:
    """The fault of each of n cells (n, 2, 2, 2), in order."""
    found: list[Fault] = []
    for start in range(0, len(values), side**3):
        block = values[start : start + side**3]
        padded = np.concatenate([block, np.ones((side**3 - len(block), 2, 2, 2))])
        field = stacked(padded, side)
        answer = surface(adapter, field)
        judged = judge(answer.points, answer.simplices, places(side), cells(padded), field.shape)
        found += judged[: len(block)]
    return found


def random_cells(n: int, seed: int) -> Floats:
    """Cells of random signs and sizes, no sample nearer to zero than 1/16."""
    rng = np.random.default_rng(seed)
    sizes = rng.integers(64, 1024, (n, 2, 2, 2)) / 1024
    return np.asarray(sizes * rng.choice([-1, 1], (n, 2, 2, 2)))


def targeted() -> tuple[list[str], Floats]:
    """The ids and values of the frozen cells, without the pairs."""
    listed = [case for case in trilinear_cells.cases(0) if "pair" not in case.tags]
    return [c.id for c in listed], np.array([c.build().values for c in listed])


def tunnel_pairs() -> Iterator[Floats]:
    """72 fields: a tunnel cell and its mirror image across each face, and the same negated."""
    for name, face, sign in product(TUNNELS, range(6), (1, -1)):
        yield trilinear_cells.pair(name, face, sign, 0)


def crowded(adapter: Adapter, values: Floats) -> bool:
    """Whether some edge of the answer has more than two triangles."""
    return len(surface(adapter, values).crowded_facets) > 0


def line(n: int) -> NDArray[np.int64]:
    """(n, 3) where n cells stand in the field of `in_line`."""
    return np.stack([3 * np.arange(n), np.zeros(n, int), np.zeros(n, int)], axis=1)


def in_line(values: NDArray[np.generic], level: float) -> Floats:
    """The field (3 n, 2, 2) in which the cells stand in a row, parted by high samples."""
    field = np.full((len(values), 3, 2, 2), level + 1)
    field[:, :2] = values
    return field.reshape(-1, 2, 2)
