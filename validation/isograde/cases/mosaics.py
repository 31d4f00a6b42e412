"""Many cells side by side in one field: everything a cell can be asked, in a handful of cases.

A cell posed alone costs a call. Here cells stand next to each other, two samples apart, so that the
cells between them, whose corners belong to different ones, are chance's. A mosaic is as good as its
cells one by one, since claims judge cell by cell, and what fails is cut down to the cell.

Glossary
--------
each    one cell for each of the 766 topologies of a cell that the surface meets: every tile of
        every cube rule of the reference, in every position and with both signs
near    six cases with a tunnel and the same without it, `BASES` independent cells each, in 96
        positions: 2 ** -7 of the way from one to the other, and 2 ** -12, where single precision
        must calculate with care; 2 ** -18 is beyond it, and in full runs alone
faces   cells with one ambiguous face, whose saddle is 2 ** -21 of the samples beside the isovalue:
        as near as single precision tells apart without care
ones    the 256 cells of ones and minus ones: every ambiguous face has its saddle on the isovalue
bodies  cells of small whole numbers with a saddle of the body on the isovalue, and no other tie
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from itertools import count, islice, product

import numpy as np
from isoref.field import Field, Floats

from isograde.cases.cells import corners
from isograde.cases.frozen import integers
from isograde.cases.trilinear_cells import TUNNELS, UNIT, cell_of, moved, near
from isograde.model import Case
from isograde.oracles.trilinear import BODY, cells
from isograde.oracles.trilinear_cases import SYMMETRIES, every_topology

BASES = 8
"""Independent pairs of cells, of each case, between which a tunnel opens."""

CLEAR = 1 / 16
STEPS = {"near-07": 7, "near-12": 12, "near-18": 18}
POSITIONS = tuple((symmetry, sign) for symmetry in SYMMETRIES for sign in (1, -1))
BODY_SADDLES = 64
LARGEST = 6


def mosaic(parts: Floats, blocks: tuple[int, int, int]) -> Floats:
    """The cells (n, 2, 2, 2) side by side, so many along each axis.

    >>> mosaic(np.arange(16.0).reshape(2, 2, 2, 2), (1, 1, 2))[0, 0]
    array([0., 1., 8., 9.])
    """
    laid = parts.reshape(*blocks, 2, 2, 2).transpose(0, 3, 1, 4, 2, 5)
    return np.ascontiguousarray(laid.reshape([2 * n for n in blocks]))


def each(seed: int) -> Field:
    """One cell of each topology that the surface meets, and two more of the first."""
    topologies = [one for one in sorted(every_topology()) if len(set(one.signs)) > 1]
    parts = np.array([cell_of(one, seed) for one in [*topologies, *topologies[:2]]])
    # Shift all samples a little: the faces between cells of one origin would have tied saddles.
    shifts = (2 * integers("mosaics/each", seed, parts.shape, -64, 64) + 1) * UNIT
    return Field.of(mosaic(parts + shifts, (8, 8, 12)))


def clarity(cell: Floats) -> float:
    """How far the saddle of the cell's least clear face is from the isovalue, from 0 to 1."""
    faces = np.concatenate([np.moveaxis(cell, axis, 0).reshape(2, 4) for axis in range(3)])
    one, other = faces[:, 0] * faces[:, 3], faces[:, 1] * faces[:, 2]
    return float((np.abs(one - other) / (np.abs(one) + np.abs(other))).min())


@cache
def bases(name: str, seed: int) -> tuple[int, ...]:
    """The first bases of this case whose faces are clear: there only the tunnel is near."""
    every = (base for base in count() if clarity_of(name, seed, base) > CLEAR)
    return tuple(islice(every, BASES))


def clarity_of(name: str, seed: int, base: int) -> float:
    """The clarity of both cells of a base, with the tunnel and without."""
    return min(clarity(cell) for cell in near(name, seed, STEPS["near-07"], base))


def tunnels(bits: int, seed: int) -> Field:
    """The cells on either side of each tunnel, base after base, in all positions."""
    parts = [
        moved(near(name, seed, bits, bases(name, seed)[number % BASES])[side], symmetry, sign)
        for name in TUNNELS
        for side in (0, 1)
        for number, (symmetry, sign) in enumerate(POSITIONS)
    ]
    return Field.of(mosaic(np.array(parts), (8, 12, 12)))


def faces() -> Field:
    """Cells with one ambiguous face that is nearly undecided: every face, both ways and signs.

    Each is of another size, lest the faces between them have saddles on the isovalue.
    """
    parts: list[Floats] = []
    for axis, side, turned, sign in product(range(3), (0, 1), (0, 1), (-1, 1)):
        for nearly in (1 + 2.0**-21, 1 - 2.0**-21):
            face = np.array([[1.0, -1.0], [-1.0, nearly]])[:, :: -1 if turned else 1]
            cell = np.full((2, 2, 2), -1.0)
            np.moveaxis(cell, axis, 0)[side] = face
            parts.append(cell * sign * (64 + len(parts)) / 64)
    return Field.of(mosaic(np.array(parts), (3, 4, 4)))


def ones() -> Field:
    """The cells of ones and minus ones."""
    parts = [np.where(corners(number), 1.0, -1.0) for number in range(256)]
    return Field.of(mosaic(np.array(parts), (4, 8, 8)))


def body_saddles() -> Floats:
    """Cells of whole numbers that are alike at opposite corners and add up to nothing.

    Seen from its middle such a cell is the same either way, so its interpolant has a saddle there,
    and the value of the saddle is the mean of the corners, nothing. Those with another tie are out.
    """
    four = np.array(list(product([x for x in range(-LARGEST, LARGEST + 1) if x], repeat=4)))
    four = four[four.sum(axis=1) == 0]
    corner = np.arange(8)
    pairs = four[:, np.minimum(corner, 7 - corner)].reshape(-1, 2, 2, 2).astype(np.float64)
    return np.asarray(pairs[cells(pairs).ties == BODY])


def bodies() -> Field:
    """Cells with a saddle of the body on the isovalue, spread over all there are."""
    every = body_saddles()
    taken = every[np.linspace(0, len(every) - 1, BODY_SADDLES).astype(int)]
    return Field.of(mosaic(taken, (4, 4, 4)))


def cases(seed: int = 0) -> list[Case]:
    """The mosaics; isovalue 0."""
    made = [_case("each", partial(each, seed), 8 * 768, {"trilinear", "posed"})]
    for name, bits in STEPS.items():
        tags = {"trilinear", "full"} if bits > 12 else {"trilinear"}
        made.append(_case(name, partial(tunnels, bits, seed), 8 * 1152, tags))
    made.append(_case("faces", faces, 8 * 48, {"trilinear"}))
    made.append(_case("ones", ones, 8 * 256, {"ties"}))
    made.append(_case("bodies", bodies, 8 * BODY_SADDLES, {"ties"}))
    return made


def _case(name: str, build: Callable[[], Field], samples: int, tags: set[str]) -> Case:
    """The mosaic of this name."""
    return Case(f"mosaics/{name}", build, (0.0,), samples, frozenset({"mosaics", *tags}))
