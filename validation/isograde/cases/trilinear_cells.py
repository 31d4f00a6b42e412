"""Cells in which a tunnel forms, or just does not, and one cell of everything that can happen.

Interior ambiguity hides from random testing: about one random cell in two hundred has a tunnel.
Here each configuration that can have one is posed with it and without it, well clear of the
decision and close to it from both sides, turned and mirrored in all 48 ways, as it is and negated.
Two cells that share a face and both have a tunnel are posed as well: a method that draws a
diagonal on the face they share makes an edge with four triangles there.

Glossary
--------
each    one cell for each of the 768 topologies of a cell, "trilinear/each/13.5.2/7"
far     a cell well clear of the decision, "trilinear/13.5.2/far/00+"
near    the two cells a step of 2 ** -7 apart between which the tunnel opens
fine    the same, 2 ** -18 apart: beyond single precision's arithmetic
00+     number of the symmetry, and + or - for the sign
pair    a tunnel cell and its mirror image across a face, "trilinear/pair/7.4.2/3-"

All values are multiples of 2 ** -20 below 1, so that single precision holds them exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache, partial
from itertools import islice, product

import numpy as np
from isoref.field import Field, Floats

from isograde.cases.frozen import STEP, integers
from isograde.model import Case
from isograde.oracles.trilinear import FACES, cells
from isograde.oracles.trilinear_cases import (
    SYMMETRIES,
    Symmetry,
    Topology,
    case_name,
    case_names,
    every_case,
    every_topology,
    exchanged,
)

TUNNELS = {
    "4.2": "4.1",
    "6.1.2": "6.1.1",
    "7.4.2": "7.4.1",
    "10.1.2": "10.1.1",
    "12.1.2": "12.1.1",
    "13.5.2": "13.5.1",
}
"""The cases with a tunnel, and what each is without it."""

AT_ONCE = 4
STEPS = {"near": 7, "fine": 18}
BLOCK = 4096
BLOCKS = 200
UNIT = 2.0**-20


def moved(values: Floats, symmetry: Symmetry, sign: int) -> Floats:
    """The cell turned by the symmetry, and negated where sign is -1."""
    turned = values.transpose(symmetry.axes)
    for axis in range(3):
        if symmetry.flips[axis]:
            turned = np.flip(turned, axis)
    return np.ascontiguousarray(sign * turned)


def topology_of(values: Floats) -> Topology:
    """What happens in the cell."""
    truth = cells(values)
    signs = tuple(1 if high else -1 for high in truth.high[0])
    return Topology(
        signs, tuple(int(x) for x in truth.faces[0]), tuple(int(x) for x in truth.body[0])
    )


@cache
def _drawn(block: int, seed: int) -> tuple[Floats, tuple[str, ...]]:
    """Random cells in this block, their samples at least 1/16 away from zero, and their cases."""
    shape = (BLOCK, 2, 2, 2)
    size = integers(f"trilinear/size/{block}", seed, shape, 64, 1024) * STEP
    sign = 2 * integers(f"trilinear/sign/{block}", seed, shape, 0, 2) - 1
    # Let most cells be checkered: the rare cases are.
    checkers = np.where(np.indices((2, 2, 2)).sum(0) % 2, 1, -1)
    sign[: BLOCK // 2] = np.where(np.arange(BLOCK // 2) % 2, 1, -1)[:, None, None, None] * checkers
    values = np.asarray(size * sign, np.float64)
    return values, tuple(case_names(cells(values)))


@cache
def _first(name: str, seed: int, skip: int = 0) -> Floats:
    """The first random cell of this case, or a later one."""
    found = next(islice(drawn_cells(name, seed), skip, None), None)
    if found is None:
        raise LookupError(f"no cell of case {name} among {BLOCKS * BLOCK} for seed {seed}")
    return found


def drawn_cells(name: str, seed: int) -> Iterator[Floats]:
    """The random cells of this case, in the order in which they are drawn."""
    for block in range(BLOCKS):
        values, _ = _drawn(block, seed)
        for i in _numbers(block, seed).get(name, ()):
            yield np.asarray(values[i])


@cache
def _numbers(block: int, seed: int) -> dict[str, list[int]]:
    """The numbers of the random cells in this block, by their cases."""
    found: dict[str, list[int]] = {}
    for number, name in enumerate(_drawn(block, seed)[1]):
        found.setdefault(name, []).append(number)
    return found


@cache
def far(name: str, seed: int, base: int = 0) -> tuple[Floats, Floats]:
    """A cell with the tunnel of this case, and one with the same signs and faces without it.

    Another `base` is another cell with the tunnel, and the first without that fits after as many.
    """
    inside = _first(name, seed, base)
    wanted = topology_of(inside)
    for skip in range(base, 400):
        plain = _first(TUNNELS[name], seed, skip)
        for symmetry, sign, found in _positions(topology_of(plain)):
            if (found.signs, found.faces) == (wanted.signs, wanted.faces):
                return inside, moved(plain, symmetry, sign)
    raise LookupError(f"no cell of case {TUNNELS[name]} matches {wanted}")


def _positions(one: Topology) -> Iterator[tuple[Symmetry, int, Topology]]:
    """The 96 positions of a cell in which this happens, and what happens there."""
    for symmetry in SYMMETRIES:
        yield symmetry, 1, symmetry.of(one)
        yield symmetry, -1, symmetry.of(exchanged(one))


@cache
def near(name: str, seed: int, bits: int, base: int = 0) -> tuple[Floats, Floats]:
    """Two cells between `far`'s, 2 ** -bits of the way apart: with the tunnel, and without."""
    inside, outside = far(name, seed, base)

    def between(s: float) -> Floats:
        return np.asarray(np.round((inside + s * (outside - inside)) / UNIT) * UNIT)

    # Halve the way to where the tunnel goes, several times at once: ask for all the middles.
    low, width, left = 0.0, 1.0, bits
    while left:
        halvings = min(AT_ONCE, left)
        width, left = width / 2**halvings, left - halvings
        middles = [between(low + width * step) for step in range(1, 2**halvings)]
        there = cells(np.stack(middles)).tunnels > 0
        at = 0
        for half in (2**power for power in reversed(range(halvings))):
            at += half if there[at + half - 1] else 0
        low += width * at
    return between(low), between(low + width)


def pair(name: str, face: int, sign: int, seed: int) -> Floats:
    """Three layers of samples: a cell with the tunnel of this case, and its mirror image."""
    cell = sign * _first(name, seed)
    axis, side = divmod(face, 2)
    layers = np.moveaxis(cell, axis, 0)
    shared, outer = layers[side], layers[1 - side]
    return np.ascontiguousarray(np.moveaxis(np.stack([outer, shared, outer]), 0, axis))


def cell_of(one: Topology, seed: int) -> Floats:
    """A cell in which this happens: the first of its case, moved."""
    name = case_name(one)
    symmetry, sign = _moves_of(name, seed)[one]
    return moved(_first(name, seed), symmetry, sign)


@cache
def _moves_of(name: str, seed: int) -> dict[Topology, tuple[Symmetry, int]]:
    """What happens in the first cell of this case in any position, and the first that does it."""
    found: dict[Topology, tuple[Symmetry, int]] = {}
    for symmetry, sign, one in _positions(topology_of(_first(name, seed))):
        found.setdefault(one, (symmetry, sign))
    return found


def cases(seed: int = 0) -> list[Case]:
    """Each, far and near, fine, and pairs; all but a sample of them only in a full run."""
    return [*_each(seed), *_posed(seed), *_pairs(seed)]


def _each(seed: int) -> list[Case]:
    """768 cases; the first of each name in every run."""
    found, count = [], dict.fromkeys(every_case(), 0)
    for one in sorted(every_topology()):
        name = case_name(one)
        tags = {"each", "full"} if count[name] else {"each"}
        build = partial(_each_field, one, seed)
        found.append(_case(f"trilinear/each/{name}/{count[name]}", build, tags))
        count[name] += 1
    return found


def _each_field(one: Topology, seed: int) -> Field:
    """The cell in which this happens."""
    return Field.of(cell_of(one, seed))


def _posed(seed: int) -> list[Case]:
    """For each tunnel case: with and without it, far, near and fine, in all 96 positions."""
    found = []
    for kind, name, side in product(("far", "near", "fine"), TUNNELS, (0, 1)):
        title = (name, TUNNELS[name])[side]
        for (number, symmetry), sign in product(enumerate(SYMMETRIES), (1, -1)):
            tags = {kind} | ({"full"} if kind == "fine" or number % 6 else set())
            build = partial(_posed_field, kind, name, side, symmetry, sign, seed)
            key = f"trilinear/{title}/{kind}/{number:02d}{'+' if sign > 0 else '-'}"
            found.append(_case(key, build, tags))
    return found


def _posed_field(
    kind: str, name: str, side: int, symmetry: Symmetry, sign: int, seed: int
) -> Field:
    """The cell with the tunnel (side 0) or without it (side 1), in this position."""
    two = far(name, seed) if kind == "far" else near(name, seed, STEPS[kind])
    return Field.of(moved(two[side], symmetry, sign))


def _pairs(seed: int) -> list[Case]:
    """For each tunnel case, each face and both signs: the cell and its mirror image."""
    found = []
    for name, face, sign in product(TUNNELS, range(len(FACES)), (1, -1)):
        key = f"trilinear/pair/{name}/{face}{'+' if sign > 0 else '-'}"
        found.append(_case(key, partial(_pair_field, name, face, sign, seed), {"pair"}, 12))
    return found


def _pair_field(name: str, face: int, sign: int, seed: int) -> Field:
    """The field of a pair."""
    return Field.of(pair(name, face, sign, seed))


def _case(key: str, build: Callable[[], Field], tags: set[str], samples: int = 8) -> Case:
    """The case of this field; the isovalue is zero."""
    return Case(key, build, (0.0,), samples, frozenset({"trilinear", *tags}))
