"""How far an implementation agrees with the trilinear truth, case by case.

Cells are posed by the thousand: independent cells stand in one field, parted by layers of high
samples and with one all round. What the implementation does in the cells between them is not
looked at: with high samples on one whole side they have no tunnel, and nothing need be drawn on
a face they share.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from isograde.doors import open_door, ready_made_names
from isograde.fields import trilinear_cells
from isograde.fields.trilinear_cells import TUNNELS
from isograde.model import Door, DoorError, Limits, Request
from isograde.truths.halfedges import Surface
from isograde.truths.sheets import Fault, judge
from isograde.truths.trilinear import NONE, active_cells, cells
from isograde.truths.trilinear_cases import case_names, every_topology
from isoref.field import Field
from numpy.typing import NDArray

Floats = NDArray[np.float64]

REFERENCE = "isoref:trilinear-cubes"
# MeshLab takes small fields only.
SIDES = {"pymeshlab": 2}
DRAWN = 4000


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


def surface(door: Door, values: Floats) -> Surface:
    """What the implementation answers, equal vertices made one. Raises `DoorError` for no mesh."""
    outcome = door.run(Request("papers/trilinear", "plain", Field.of(values), 0.0))
    if outcome.mesh is None:
        raise DoorError(f"no mesh: {outcome.status}, {outcome.detail}")
    return Surface.of(outcome.mesh.vertices, outcome.mesh.simplices).welded()


def faults(door: Door, values: Floats, side: int = 10) -> list[Fault]:
    """The fault of each of n cells (n, 2, 2, 2), in order."""
    found: list[Fault] = []
    for start in range(0, len(values), side**3):
        block = values[start : start + side**3]
        padded = np.concatenate([block, np.ones((side**3 - len(block), 2, 2, 2))])
        field = stacked(padded, side)
        answer = surface(door, field)
        judged = judge(answer.points, answer.faces, places(side), cells(padded), field.shape)
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


@dataclass
class Agreement:
    """One implementation's row of the table.

    right, total : cells of each case, over the targeted cells
    faults : faults of each case
    random : right and all random cells
    crowded : pairs of tunnel cells in which an edge has more than two triangles, of 72
    why_not : why it could not be judged, or ""
    """

    name: str
    version: str
    right: Counter[str]
    total: Counter[str]
    faults: Counter[tuple[str, str]]
    random: tuple[int, int]
    crowded: int
    why_not: str = ""


def agreement(name: str, posed: tuple[list[str], Floats], random: Floats) -> Agreement:
    """The implementation's row."""
    door = open_door(name)
    empty: Agreement = Agreement(name, "", Counter(), Counter(), Counter(), (0, 0), 0)
    try:
        said = door.open(Limits(seconds=120))
        empty.version = said.version
        if "on-edges" in said.without:
            empty.why_not = "its vertices are not on the lattice's edges"
            return empty
        names = case_names(cells(posed[1]))
        side = SIDES.get(name, 10)
        found = faults(door, posed[1], side)
        for case, fault in zip(names.tolist(), found, strict=True):
            empty.total[case] += 1
            empty.right[case] += fault is Fault.NONE
            if fault is not Fault.NONE:
                empty.faults[case, str(fault)] += 1
        wild = faults(door, random if side > 2 else random[:1000], side)
        empty.random = (sum(f is Fault.NONE for f in wild), len(wild))
        empty.crowded = sum(crowded(door, pair) for pair in tunnel_pairs())
    except DoorError as error:
        empty.why_not = str(error).splitlines()[0]
    finally:
        door.close()
    return empty


def tunnel_pairs() -> Iterator[Floats]:
    """72 fields: a tunnel cell and its mirror image across each face, and the same negated."""
    for name, face, sign in product(TUNNELS, range(6), (1, -1)):
        yield trilinear_cells.pair(name, face, sign, 0)


def crowded(door: Door, values: Floats) -> bool:
    """Whether some edge of the answer has more than two triangles."""
    return len(surface(door, values).crowded_edges) > 0


def implementations() -> list[str]:
    """Every ready-made name, the reference last."""
    return sorted(ready_made_names(), key=lambda name: (name.startswith("isoref"), name))


# --- the smallest failing cell of each fault ----------------------------------------------------


@dataclass(frozen=True)
class Smallest:
    """A cell of small whole numbers in which an implementation errs."""

    name: str
    case: str
    fault: str
    values: tuple[int, ...]


def small_cells(limit: int, seed: int) -> Floats:
    """4,000 cells of whole numbers from -limit to limit, none of them a tie."""
    rng = np.random.default_rng((seed, limit))
    drawn = rng.integers(1, limit + 1, (4 * DRAWN, 2, 2, 2)) * rng.choice(
        [-1, 1], (4 * DRAWN, 2, 2, 2)
    )
    good = drawn[cells(drawn).ties == NONE][:DRAWN]
    filler = np.full((DRAWN - len(good), 2, 2, 2), 1)
    return np.concatenate([good, filler]).astype(float)


def checkered_cells(limit: int, seed: int) -> Floats:
    """The same, in two thirds of them with the signs of a tunnel case."""
    values = np.abs(small_cells(limit, seed + 1))
    patterns = [np.sign(trilinear_cells.far(name, 0)[0]) for name in TUNNELS]
    rng = np.random.default_rng((seed, limit, 1))
    signs = np.array(patterns)[rng.integers(0, len(patterns), DRAWN)]
    signs *= rng.choice([-1, 1], (DRAWN, 1, 1, 1))
    return np.asarray(values * signs)


def smallest_failures(name: str, limits: Iterable[int] = range(2, 13)) -> list[Smallest]:
    """For each fault the implementation has, the cell of least numbers found."""
    door = open_door(name)
    best: dict[str, tuple[tuple[float, ...], Smallest]] = {}
    try:
        if "on-edges" in door.open(Limits(seconds=120)).without:
            return []
        for limit in limits:
            for draw in (small_cells, checkered_cells):
                _keep_smallest(name, door, draw, limit, best)
    except DoorError:
        return []
    finally:
        door.close()
    return [small for _, small in best.values()]


def _keep_smallest(
    name: str,
    door: Door,
    draw: Callable[[int, int], Floats],
    limit: int,
    best: dict[str, tuple[tuple[float, ...], Smallest]],
) -> None:
    """Put into `best` what is smaller than what is there."""
    values = draw(limit, 0)
    truths = cells(values)
    names = case_names(truths)
    for i, fault in enumerate(faults(door, values, SIDES.get(name, 10))):
        if fault is Fault.NONE or truths.ties[i] != NONE:
            continue
        flat = values[i].reshape(-1)
        size = (float(np.abs(flat).max()), float(np.abs(flat).sum()), *flat.tolist())
        if str(fault) not in best or size < best[str(fault)][0]:
            small = Smallest(name, str(names[i]), str(fault), tuple(int(x) for x in flat))
            best[str(fault)] = (size, small)


# --- the reference, at length -------------------------------------------------------------------


def grids_of_noise(door: Door, number: int, size: int) -> tuple[int, int, int]:
    """Over grids of noise: cells, wrong cells, grids with an edge of more than two triangles."""
    rng = np.random.default_rng(0)
    total = wrong = crowds = 0
    for _ in range(number):
        values = rng.integers(64, 1024, (size,) * 3) / 1024 * rng.choice([-1, 1], (size,) * 3)
        answer = surface(door, values)
        index, corners = active_cells(values, 0.0)
        truths = cells(corners)
        found = judge(answer.points, answer.faces, index, truths, values.shape)
        good = truths.ties == NONE
        total += int(good.sum())
        wrong += sum(f is not Fault.NONE for f, g in zip(found, good, strict=True) if g)
        crowds += len(answer.crowded_edges) > 0
    return total, wrong, crowds


# --- real volumes -------------------------------------------------------------------------------


def decided(high: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(n,) whether the signs (n, 8) alone decide: only one topology has them."""
    number: Counter[tuple[int, ...]] = Counter(one.signs for one in every_topology())
    only = np.array(
        [number[tuple(1 if code >> c & 1 else -1 for c in range(8))] == 1 for code in range(256)]
    )
    return np.asarray(only[high @ (1 << np.arange(8))])


def line(n: int) -> NDArray[np.int64]:
    """(n, 3) where n cells stand in the field of `in_line`."""
    return np.stack([3 * np.arange(n), np.zeros(n, int), np.zeros(n, int)], axis=1)


def in_line(values: NDArray[np.generic], level: float) -> Floats:
    """The field (3 n, 2, 2) in which the cells stand in a row, parted by high samples."""
    field = np.full((len(values), 3, 2, 2), level + 1)
    field[:, :2] = values
    return field.reshape(-1, 2, 2)
