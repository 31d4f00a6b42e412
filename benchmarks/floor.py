"""The least that a vectorised extraction does, timed: we know of no way in NumPy below it.

Two kinds of passes. Those that *find*, without which nobody knows where the surface is:

    each sample      compared with the isovalue, once; its answer packed into a bit
    each 64 bits     compared with their neighbours along three axes, joined, looked at
    each crossing    its number found from its bit; its place, its other end and three coordinates
                     from its byte's
    each cell        its number found from its bit; its place; its eight bits brought together, its
                     tile looked up
    each node of a   the step to its edge looked up
    polygon

And those that *draw*, without which there is no mesh of these arrays:

    each crossing    its number written into the table of edges; both samples looked up, made
                     doubles, the isovalue taken away, subtracted, divided; the place along the edge
                     added; three coordinates written
    each corner      its edge had from its cell's and its tile's, its vertex looked up and written

All else is given for nothing: in which bytes something is crossed, decisions, the order of tiles,
slabs and their seams, room for what is made. The passes go over arrays in portions that stay in the
processor's cache. A compiled loop needs none of them: it has the samples of a cell, its crossings
and its corners in registers. So a peer's time over this floor is the most that we think a ratio to
such a program in NumPy can be. It is no proof: who knows fewer passes has a lower floor.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from isoref.fast._bits import POPULATION, transposed
from isoref.field import Array, Integers, least_inside
from isoref.mesh import Mesh, Precision, number_types

# So many crossings at once; so many entries in a table of edges, which is used again and again.
PORTION, TABLE = 1 << 15, 3 << 20
# So many words of bits at once.
WORDS = 1 << 12
Spent = dict[str, float]
#: The stages of the floor, in their order.
PASSES = (
    "samples compared",
    "bits compared",
    "crossings found",
    "cells found",
    "crossings placed",
    "corners drawn",
)


def floor(
    values: Array, isovalue: float, mesh: Mesh, precision: Precision = "double"
) -> Callable[..., tuple[Array, Array]]:
    """The least passes towards this mesh, as a call that gives its arrays.

    The call takes a dictionary, where one wants to know the seconds of each stage.

    Vertices come axis by axis within each portion (`given_order`), and triangles name them so.
    Points inside cells are placed as if they were crossings: those are not less work.

    values : (N1, N2, N3), in C order
    mesh : with its provenance
    """
    assert mesh.provenance is not None
    flat = values.reshape(-1)
    axis, order = given_order(mesh, values.shape)
    low = mesh.provenance.ends[order, 0]
    steps = np.array([values.shape[1] * values.shape[2], values.shape[2], 1])
    high = np.minimum(low + steps[axis[order]], flat.size - 1)
    places = (3 * low + axis[order]) % TABLE
    index = [one.astype(float) for one in np.unravel_index(low, values.shape)]
    portions = [
        (at, (at + np.searchsorted(axis[order[at : at + PORTION]], [0, 1, 2, 3])).tolist())
        for at in range(0, len(low), PORTION)
    ]
    place = np.empty(len(order), np.int64)
    place[order] = places
    corners = place.take(mesh.simplices.reshape(-1))
    of_tile = corners % 64
    of_cell = corners - of_tile
    real, whole = number_types(precision)
    numbers = np.zeros(min(3 * values.size, TABLE), np.int32)

    find = finding(values, isovalue, mesh)

    def run(spent: Spent | None = None) -> tuple[Array, Array]:
        find(spent)
        start = time.process_time()

        # Number and place the crossings.
        vertices = np.empty((len(low), 3), real)
        for at, ends in portions:
            some = slice(at, ends[-1])
            numbers[places[some]] = np.arange(at, ends[-1], dtype=np.int32)
            below = flat.take(low[some]).astype(np.float64)
            above = flat.take(high[some]).astype(np.float64)
            below -= isovalue
            above -= isovalue
            above -= below
            with np.errstate(divide="ignore", invalid="ignore"):  # inside a cell
                np.divide(below, above, out=above)
            for along in range(3):
                vertices[some, along] = index[along][some]
                own = slice(ends[along], ends[along + 1])
                vertices[own, along] -= above[own.start - at : own.stop - at]

        start = tick(spent, "crossings placed", start)

        # Look the corners of the triangles up.
        triangles = np.empty(len(corners), whole)
        edge = np.empty(PORTION, np.int64)
        for at in range(0, len(corners), PORTION):
            some = slice(at, at + PORTION)
            found = edge[: len(of_cell[some])]
            np.add(of_cell[some], of_tile[some], out=found)
            triangles[some] = numbers.take(found, mode="clip")
        tick(spent, "corners drawn", start)
        return vertices, triangles

    return run


def finding(values: Array, isovalue: float, mesh: Mesh) -> Callable[[Spent | None], None]:
    """The passes that find this mesh's crossings and cells, as a call that forgets them."""
    level, flat = least_inside(values.dtype, isovalue), values.reshape(-1)
    inside = values >= level
    crossed = [
        np.packbits(np.diff(inside, axis=axis), axis=-1, bitorder="little").reshape(-1)
        for axis in range(3)
    ]
    every, some_one = inside, inside
    for axis in range(3):
        ends = [(slice(None),) * axis + (some,) for some in (slice(-1), slice(1, None))]
        every, some_one = every[ends[0]] & every[ends[1]], some_one[ends[0]] | some_one[ends[1]]
    cells = np.packbits(some_one & ~every, axis=-1, bitorder="little").reshape(-1)
    del inside, every, some_one

    touched = [bytes_[bytes_ != 0] for bytes_ in (*crossed, cells)]
    most = max(map(len, touched), default=0)
    place, coordinate = np.arange(most) * 8, np.arange(most, dtype=np.float64)
    corner = [np.arange(most) for _ in range(8)]
    bits = np.zeros(-(-flat.size // 64) + 2, np.uint64)
    compared, tiles = np.empty(PORTION * 4, bool), np.arange(256)
    nodes = np.arange(len(mesh.simplices) + 2 * int(POPULATION[cells].sum())) % 256

    def run(spent: Spent | None) -> None:
        # Compare the samples, and pack the answers.
        start = time.process_time()
        for at in range(0, flat.size, compared.size):
            samples = flat[at : at + compared.size]
            np.greater_equal(samples, level, out=compared[: len(samples)])
            packed = np.packbits(compared[: len(samples)], bitorder="little")
            bits.view(np.uint8)[at // 8 : at // 8 + len(packed)] = packed
        start = tick(spent, "samples compared", start)

        # Compare the bits with their neighbours, and join them.
        one, other, work = (np.empty(WORDS, np.uint64) for _ in range(3))
        found = np.empty(WORDS, bool)
        for at in range(0, len(bits) - 1, WORDS):
            here, beside = bits[at : at + WORDS][:-1], bits[at + 1 : at + WORDS]
            count = len(here)
            np.right_shift(here, 1, out=work[:count])
            np.bitwise_xor(here, beside, out=one[:count])
            np.bitwise_xor(here, beside, out=other[:count])
            np.bitwise_xor(here, work[:count], out=work[:count])
            np.bitwise_or(one[:count], other[:count], out=other[:count])
            np.bitwise_or(work[:count], other[:count], out=other[:count])
            np.not_equal(other[:count], 0, out=found[:count])
        start = tick(spent, "bits compared", start)

        # Find the crossings of each axis, their places, other ends and coordinates.
        for bytes_ in touched[:3]:
            for at in range(0, len(bytes_), PORTION // 2):
                number, byte = numbers_of(bytes_[at : at + PORTION // 2])
                low = place[at:].take(byte, mode="clip")
                low += number
                _ = low + 1
                for _ in range(3):
                    coordinate[at:].take(byte, mode="clip")
        start = tick(spent, "crossings found", start)

        # Find the cells, their places, signs and tiles.
        own = touched[3]
        for at in range(0, len(own), PORTION // 2):
            some = own[at : at + PORTION // 2]
            number, byte = numbers_of(some)
            low = place[at:].take(byte, mode="clip")
            low += number
            corners = np.empty((len(some), 8), np.uint8)
            for c in range(8):
                corners[:, c] = own.take(corner[c][at : at + len(some)], mode="clip")
            signs = transposed(corners).take(number, mode="clip")
            tiles.take(signs, mode="clip")
        for at in range(0, len(nodes), PORTION):
            tiles.take(nodes[at : at + PORTION], mode="clip")
        tick(spent, "cells found", start)

    return run


def numbers_of(bytes_: Array) -> tuple[Integers, Integers]:
    """The numbers of the bits that are set, and of the byte that each is in."""
    number = np.unpackbits(bytes_, bitorder="little").view(np.bool_).nonzero()[0]
    return number, number >> 3


def tick(spent: Spent | None, stage: str, start: float) -> float:
    """The time now; what passed since `start` is added to a stage, where somebody asks."""
    if spent is None:
        return 0.0
    now = time.process_time()
    spent[stage] = spent.get(stage, 0.0) + now - start
    return now


def dual_floor(
    values: Array, isovalue: float, mesh: Mesh, rows: Integers
) -> Callable[[], tuple[Array, Array]]:
    """The same towards a dual surface of quadrilaterals, whose vertices are means of crossings.

    Each sample is compared, each crossing found from two samples; it is added to the sums of the
    four vertices round it, and joins them: their numbers are looked up and written, as triangles.
    Each vertex has its sums divided, its cell's coordinates added, three numbers written. Which
    vertices those are is given for nothing.

    mesh : a mesh of cubes with its provenance, for the crossings
    rows : (Q, 4) the quadrilaterals
    """
    assert mesh.provenance is not None
    flat, ends = values.reshape(-1), mesh.provenance.ends
    ends = ends[ends[:, 1] >= 0][: len(rows)]
    low, high = (np.ascontiguousarray(ends[:, end]) for end in (0, 1))
    slots = [np.ascontiguousarray(slot[: len(low)]) for slot in rows.T]
    count = int(rows.max()) + 1
    number, shift, shares = np.arange(count), np.zeros(count), np.full(count, 4.0)
    compared, level = np.empty(PORTION * 4, bool), least_inside(values.dtype, isovalue)

    def run() -> tuple[Array, Array]:
        # Compare the samples, and place the crossings.
        for at in range(0, flat.size, compared.size):
            samples = flat[at : at + compared.size]
            np.greater_equal(samples, level, out=compared[: len(samples)])
        t = np.empty(len(low))
        for at in range(0, len(low), PORTION):
            some = slice(at, at + PORTION)
            below = flat.take(low[some], mode="clip").astype(np.float64)
            above = flat.take(high[some], mode="clip").astype(np.float64)
            below -= isovalue
            above -= isovalue
            above -= below
            np.divide(below, above, out=t[some])

        # Add each crossing to four vertices, and join these.
        third, total = -(-len(low) // 3), np.zeros((3, count))
        for axis in range(3):
            some = slice(axis * third, (axis + 1) * third)
            for slot in slots:
                np.add.at(total[axis], slot[some], t[some])
        triangles = np.empty((len(low), 6), np.int64)
        for column, slot in zip((0, 1, 2, 5), slots, strict=True):
            triangles[:, column] = number.take(slot, mode="clip")
        triangles[:, 3:5] = triangles[:, [0, 2]]

        # Place the vertices.
        vertices = np.empty((count, 3))
        for axis in range(3):
            total[axis] += shift
            total[axis] /= shares
            np.add(total[axis], shift, out=vertices[:, axis])
        return vertices, triangles

    return run


def given_order(mesh: Mesh, shape: tuple[int, ...]) -> tuple[Integers, Integers]:
    """(V,) the axis of each vertex's edge, and (V,) vertices axis by axis within each portion."""
    assert mesh.provenance is not None
    low, high = mesh.provenance.ends.T
    apart = np.where(high < 0, 1, high - low)
    axis = np.where(apart == 1, 2, np.where(apart == shape[2], 1, 0))
    return axis, np.lexsort((axis, np.arange(len(axis)) // PORTION))


def leaves(peer: float, goal: float, least: float, own: float) -> str:
    """What the floor says of a goal that is not met; all times in the same unit.

    >>> leaves(peer=2.0, goal=2.0, least=1.2, own=2.0)
    'out of reach: the floor alone is 1.20 of what it allows'
    >>> leaves(peer=2.0, goal=2.0, least=0.5, own=1.5)
    'the floor is 0.50 of what it allows; ours takes 3.0 times the floor, it allows 2.0'
    """
    allowed = peer / goal
    if least >= allowed:
        return f"out of reach: the floor alone is {least / allowed:.2f} of what it allows"
    return (
        f"the floor is {least / allowed:.2f} of what it allows; ours takes {own / least:.1f} times "
        f"the floor, it allows {allowed / least:.1f}"
    )
