"""Isosurfaces in any dimension, vectorised: the complexes of `isoref.simplicial`.

Simplices whose vertices have the same signs are cut alike, so a section is one look-up in the table
for each pattern of signs that occurs. Vertices are made one by sorting keys. Cells are cut a block
at a time. How many are cut together follows from the memory there is and from what a simplex can
become at most, before anything is cut; where the mesh would not fit, a trial on a share of the
cells says so.

Glossary
--------
code        the signs of a simplex's vertices, a bit each
key         of an edge: low * V + high, for V vertices
block       cells that are cut together
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import comb, factorial
from pathlib import Path

import numpy as np

from isoref.field import Booleans, Field, FieldError, Floats, Integers, least_inside
from isoref.kuhn import chains, corner_offsets, signs, strides
from isoref.mesh import Mesh, in_space
from isoref.simplex_section import SectionTable, crossing, section_table
from isoref.simplicial import (
    Complex,
    Isovalue,
    Sampler,
    check_input,
    checked_values,
    levels,
    provenance_of,
    sampler,
    to_mesh,
    zeroed,
)

# Kuhn simplices that are cut together: enough for NumPy to be fast, few enough for the cache.
BLOCK = 1 << 17

# How many times its size a complex takes: the result while blocks are put together, the largest
# of a block's complexes while it is cut.
JOINING, CUTTING = 3.5, 6.0

# Bytes a sample that the search for active cells takes: five arrays of signs.
PASS_BYTES = 5

# A trial cuts runs of neighbouring cells, evenly spread: one cell in 16, in 16 to 64 runs.
RUN, SHARE, LEAST_RUNS, MOST_RUNS = 16, 16, 16, 64


@in_space
def extract(
    field: Field,
    isovalue: Isovalue = 0.0,
    *,
    rule: str = "staircase",
    epsilon: float | None = None,
    memory: int | None = None,
    provenance: bool = False,
) -> Mesh:
    """The isosurface of `field`; see `isoref.simplicial.extract`.

    Besides, `memory` says how many bytes may be used beyond the field; what the machine has free
    by default. A surface that is too large for it raises a FieldError before it is made.
    """
    complex_ = section_of_field(field, isovalue, rule, epsilon, memory)
    mesh = to_mesh(complex_, field.spacing, field.origin)
    return replace(mesh, provenance=provenance_of(complex_, field)) if provenance else mesh


def section_of_field(
    field: Field,
    isovalue: Isovalue = 0.0,
    rule: str = "staircase",
    epsilon: float | None = None,
    memory: int | None = None,
) -> Complex:
    """The isosurface as a complex, whose simplices still know their parents. See `extract`."""
    check_input(field.shape, field.components)
    level = levels(isovalue, field.components)
    samples = int(np.prod(field.shape))
    check_memory(PASS_BYTES * samples, allowed_memory(memory), f"one pass over {samples:,} samples")
    cells = active_cells(field, level)
    sample = sampler(field, level, epsilon)
    return section_of_cells(field.shape, cells, sample, rule, epsilon, memory)


def section_of_cells(
    shape: tuple[int, ...],
    cells: Integers,
    sample: Sampler,
    rule: str,
    epsilon: float | None,
    memory: int | None,
) -> Complex:
    """The isosurface in these cells (C,), cut a block of cells at a time.

    `sample` gives the values (P, m), minus the isovalue, of the samples with numbers (P,).
    """
    n, m = len(shape), sample(np.zeros(1, np.int64)).shape[1]
    allowed = allowed_memory(memory)
    at_once = Portions.within(allowed, n, m)

    def cut(block: Integers) -> Iterator[Iterator[Complex]]:
        whole = kuhn_complex(shape, block, sample)
        for start in range(0, max(len(whole.simplices), 1), at_once.simplices):
            portion = portion_of(whole, slice(start, start + at_once.simplices))
            yield successive_sections(portion, rule, epsilon)

    needed = estimated_bytes(cut, cells, at_once)
    check_memory(needed, allowed, f"the isosurface in {len(cells):,} cells")
    parts = []
    for start in range(0, max(len(cells), 1), at_once.cells):
        for stages in cut(cells[start : start + at_once.cells]):
            for complex_ in stages:
                last = complex_
            parts.append(last)
    return united(parts)


@dataclass(frozen=True)
class Portions:
    """How much is cut together, so that it fits into the memory whatever the samples are.

    cells : cells whose Kuhn simplices are listed together
    simplices : of these, how many are cut together
    bytes : the most that cutting them takes
    """

    cells: int
    simplices: int
    bytes: float

    @classmethod
    def within(cls, allowed: int, n: int, m: int) -> Portions:
        """The largest portions up to `BLOCK` simplices that take no more than half of `allowed`.

        Bounded before anything is listed or cut: the simplices of a cell by n!, what becomes of a
        simplex by the largest tables of each dimension (`cut_bytes`).

        Raises
        ------
        FieldError
            where a single cell cannot be listed, or a single simplex not be cut.
        """
        cell, simplex = kuhn_bytes(n, m), cut_bytes(n, m)
        check_memory(cell, allowed, f"listing the {factorial(n):,} simplices of a cell")
        check_memory(simplex, allowed, f"cutting one simplex of dimension {n}")
        simplices = int(min(BLOCK, max(allowed / 2 // simplex, 1)))
        cells = int(min(-(-BLOCK // factorial(n)), max(allowed / 2 // cell, 1)))
        return cls(cells, simplices, simplex * simplices)


def kuhn_bytes(n: int, m: int) -> float:
    """A bound of the bytes for the Kuhn simplices of one cell: tables and rows of n + 1 numbers.

    The tables of permutations and chains, made from a list of tuples, and the rows of a cell in
    which every simplex is kept, stand beside each other.
    """
    rows = factorial(n) * 8.0 * (n + 1)
    return 8 * rows + (1 << n) * 8.0 * (n + m + 4)


def cut_bytes(n: int, m: int) -> float:
    """A bound of the bytes for cutting one n-simplex by m components, one after the other.

    A section of dimension k - 1 has at most C(k - 1, floor((k - 1) / 2)) simplices (corollary 3.2)
    and as many vertices as edges are crossed, at most floor((k + 1)^2 / 4). So n_1 <= 6, n_2 <= 18,
    n_3 <= 36 for n = 5, as section 4 of the paper says.
    """
    most = bytes_of_rows(1, n + 1, n + 1, n, m, 0)
    for s, rows in enumerate(most_pieces(n, m), start=1):
        k = n - s + 1
        before = most_pieces(n, m)[s - 2] if s > 1 else 1
        vertices = before * ((k + 1) ** 2 // 4)
        most = max(most, bytes_of_rows(rows, k, vertices, n, m - s, s))
    return CUTTING * most


def most_pieces(n: int, m: int) -> list[int]:
    """The most simplices that one n-simplex can leave after 1, 2, .. m cuts.

    >>> most_pieces(5, 3)
    [6, 18, 36]
    """
    pieces, found = 1, []
    for k in range(n, n - m, -1):
        pieces *= comb(k - 1, (k - 1) // 2)
        found.append(pieces)
    return found


def bytes_of_rows(rows: int, size: int, vertices: int, n: int, left: int, cuts: int) -> float:
    """The bytes of a complex of so many rows of `size` vertices, with `left` values at each."""
    return 8.0 * (rows * (size + 2) + vertices * (n + left + (1 << cuts)))


def portion_of(complex_: Complex, rows: slice) -> Complex:
    """The complex of some of the simplices, with the vertices they use."""
    if rows.start == 0 and rows.stop >= len(complex_.simplices):
        return complex_
    used, places = np.unique(complex_.simplices[rows].ravel(), return_inverse=True)
    return Complex(
        complex_.names[used],
        complex_.points[used],
        complex_.values[used],
        places.reshape(-1, complex_.simplices.shape[1]),
        complex_.signs[rows],
        complex_.parents[rows],
    )


def successive_sections(complex_: Complex, rule: str, epsilon: float | None) -> Iterator[Complex]:
    """The complex, its section by its first value, .., and last its section by all its values."""
    yield complex_
    while complex_.values.shape[1]:
        complex_ = section(complex_, rule, epsilon)
        yield complex_


def united(parts: list[Complex]) -> Complex:
    """One complex of several, vertices of one name made one, simplices in order of parents."""
    names = np.concatenate([part.names for part in parts])
    order = np.lexsort(names.T[::-1])
    first = np.ones(len(names), bool)
    first[1:] = (np.diff(names[order], axis=0) != 0).any(axis=1)
    places = np.empty(len(names), np.int64)
    places[order] = np.cumsum(first) - 1
    starts = np.cumsum([0, *(len(part.names) for part in parts)])
    rows = np.concatenate(
        [places[start + part.simplices] for part, start in zip(parts, starts, strict=False)]
    )
    parents = np.concatenate([part.parents for part in parts])
    by_parent = np.argsort(parents, kind="stable")
    return Complex(
        names[order[first]],
        np.concatenate([part.points for part in parts])[order[first]],
        np.concatenate([part.values for part in parts])[order[first]],
        rows[by_parent],
        np.concatenate([part.signs for part in parts])[by_parent],
        parents[by_parent],
    )


def section(complex_: Complex, rule: str = "staircase", epsilon: float | None = None) -> Complex:
    """The section of a complex where its first value is 0: one dimension and one value fewer."""
    simplices, k = complex_.simplices, complex_.simplices.shape[1] - 1
    inside = complex_.values[:, 0] >= 0
    groups = [(own, section_table(rule, k, code)) for code, own in _by_signs(inside, simplices)]
    # Give each crossed edge one vertex, numbered by the ends of the edge.
    edges = [_edge_keys(simplices[own], table, len(inside)) for own, table in groups]
    keys, numbers = weld(np.concatenate([np.empty(0, np.int64), *(e.ravel() for e in edges)]))
    low, high = np.divmod(keys, max(len(inside), 1))
    names = np.hstack([complex_.names[low], complex_.names[high]])
    points, values = _cross(complex_, low, high, epsilon)
    # Cut the section of each simplex by the table for its signs.
    rows, orientation, parents = [np.empty((0, k), np.int64)], [], []
    ends = np.cumsum([e.size for e in edges])[:-1]
    for part, (own, table) in zip(np.split(numbers, ends), groups, strict=False):
        rows.append(part.reshape(len(own), -1)[:, table.rows].reshape(-1, k))
        orientation.append(np.multiply.outer(complex_.signs[own], table.signs).ravel())
        parents.append(np.repeat(complex_.parents[own], len(table.rows)))
    none = complex_.parents[:0]
    flat = [np.concatenate([none, *parts]) for parts in (orientation, parents)]
    return _straddling(Complex(names, points, values, np.concatenate(rows), *flat))


def _by_signs(inside: Booleans, simplices: Integers) -> Iterator[tuple[int, Integers]]:
    """The simplices that are cut, by the signs of their vertices: (code, their numbers)."""
    size = simplices.shape[1]
    codes = np.zeros(len(simplices), np.uint16)
    for position in range(size):
        codes |= inside[simplices[:, position]].astype(np.uint16) << np.uint16(position)
    for code in np.unique(codes).tolist():
        if 0 < code < (1 << size) - 1:
            yield code, np.flatnonzero(codes == code)


def _edge_keys(simplices: Integers, table: SectionTable, V: int) -> Integers:
    """For each simplex its p q crossed edges as low * V + high, (S, p, q)."""
    i, j = simplices[:, table.negatives, None], simplices[:, None, table.positives]
    return np.asarray(np.minimum(i, j) * V + np.maximum(i, j))


def _cross(
    complex_: Complex, low: Integers, high: Integers, epsilon: float | None
) -> tuple[Floats, Floats]:
    """Points and remaining values where psi is 0 on the edges from `low` to `high`."""
    psi = complex_.values[:, 0]
    i, j = np.where(psi[low] < 0, low, high), np.where(psi[low] < 0, high, low)
    points = crossing(complex_.points[i], complex_.points[j], psi[i], psi[j])
    values = crossing(complex_.values[i, 1:], complex_.values[j, 1:], psi[i], psi[j])
    return points, zeroed(values, epsilon)


def _straddling(complex_: Complex) -> Complex:
    """Only the simplices on which every remaining value takes both signs, and their vertices."""
    bits = sign_bits(complex_.values)
    kept = np.flatnonzero(straddles(bits[complex_.simplices.T], complex_.values.shape[1]))
    rows = complex_.simplices[kept]
    used = np.zeros(len(bits), bool)
    used[rows] = True
    places = np.cumsum(used) - 1
    return Complex(
        complex_.names[used],
        complex_.points[used],
        complex_.values[used],
        places[rows],
        complex_.signs[kept],
        complex_.parents[kept],
    )


def sign_bits(values: Floats) -> Integers:
    """For each row of (V, r) values an integer whose bit c is set where value c is >= 0.

    >>> sign_bits(np.array([[-1.0, 2.0], [0.0, -3.0]])).tolist()
    [2, 1]
    """
    r = values.shape[1]
    kind = next(size for size in (8, 16, 32, 64) if r < size)
    bits = np.zeros(len(values), f"uint{kind}")
    for c in range(r):
        bits |= (values[:, c] >= 0).astype(bits.dtype) << bits.dtype.type(c)
    return bits


def straddles(bits: Integers, r: int) -> Booleans:
    """Where all r values take both signs over the first axis of `bits`."""
    some, every = np.bitwise_or.reduce(bits, axis=0), np.bitwise_and.reduce(bits, axis=0)
    return np.asarray((some & ~every) == (1 << r) - 1)


def weld(keys: Integers) -> tuple[Integers, Integers]:
    """The distinct keys in order, and for each key its place among them.

    >>> [part.tolist() for part in weld(np.array([7, 3, 7]))]
    [[3, 7], [1, 0, 1]]
    """
    bits = len(keys).bit_length()
    if keys.max(initial=0) < 1 << (63 - bits):
        ordered, order = _sorted_packed(keys, bits)
    else:
        order = np.argsort(keys)
        ordered = keys[order]
    first = np.ones(len(keys), bool)
    first[1:] = ordered[1:] != ordered[:-1]
    places = np.empty(len(keys), np.int64)
    places[order] = np.cumsum(first) - 1
    return ordered[first], places


def _sorted_packed(keys: Integers, bits: int) -> tuple[Integers, Integers]:
    """Keys in order and where they were, by one sort of keys and places packed together."""
    packed = keys << bits | np.arange(len(keys))
    packed.sort()
    return packed >> bits, packed & ((1 << bits) - 1)


def allowed_memory(memory: int | None) -> int:
    """The bytes that may be used: those given, or what the machine has free."""
    return available_memory() if memory is None else memory


def available_memory() -> int:
    """The bytes that this machine has free, where Linux tells; else as many as there can be."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        kibibytes = dict(line.split(":") for line in lines)["MemAvailable"].split()[0]
    except (OSError, KeyError, ValueError):
        return sys.maxsize
    return int(kibibytes) * 1024


def check_memory(needed: float, allowed: int, what: str) -> None:
    """Raise FieldError, with the numbers, unless `what` fits in the memory allowed."""
    if needed > allowed:
        raise FieldError(
            f"{what} needs about {int(needed):,} bytes, but {allowed:,} are allowed; "
            "take a coarser lattice or a part of it"
        )


def estimated_bytes(
    cut: Callable[[Integers], Iterator[Iterator[Complex]]], cells: Integers, at_once: Portions
) -> float:
    """About how many bytes the isosurface in these cells takes at the highest, from a trial.

    The trial cuts the same portions, so that it stays within the memory itself.
    """
    runs = min(max(len(cells) // (SHARE * RUN), LEAST_RUNS), MOST_RUNS)
    starts = np.linspace(0, max(len(cells) - RUN, 0), runs).astype(np.int64)
    tried = np.unique(starts[:, None] + np.arange(min(RUN, len(cells))))
    sizes: dict[int, float] = {}
    for start in range(0, max(len(tried), 1), at_once.cells):
        for stages in cut(cells[tried[start : start + at_once.cells]]):
            for stage, part in enumerate(stages):
                sizes[stage] = sizes.get(stage, 0.0) + bytes_of(part) / max(len(tried), 1)
    whole = max(sizes.items())[1] * len(cells)
    largest = max(sizes.values()) * min(at_once.cells, len(cells))
    return max(JOINING * whole, min(CUTTING * largest, at_once.bytes))


def bytes_of(complex_: Complex) -> int:
    """The bytes of the arrays of a complex."""
    return sum(array.nbytes for array in vars(complex_).values())


def active_cells(field: Field, level: Floats) -> Integers:
    """The cells on whose corners every component takes both signs, in order."""
    n, m = field.dimension, field.components
    components = field.values.reshape(m, *field.shape)
    kind = next(size for size in (8, 16, 32, 64) if m < size)
    bits = np.zeros(field.shape, f"uint{kind}")
    for c in range(m):
        # Round the level up to the samples' type, so that the comparison is that of the values.
        own = components[c]
        least = least_inside(own.dtype, float(level[c])) if own.dtype.kind == "f" else level[c]
        bits |= (own >= least).astype(bits.dtype) << bits.dtype.type(c)
    some = every = bits
    for axis in range(n):
        low = (slice(None),) * axis + (slice(None, -1),)
        high = (slice(None),) * axis + (slice(1, None),)
        some, every = some[low] | some[high], every[low] & every[high]
    active = np.nonzero((some & ~every) == (1 << m) - 1)
    return np.asarray(np.ravel_multi_index(active, field.shape), np.int64)


def kuhn_complex(shape: tuple[int, ...], cells: Integers, sample: Sampler) -> Complex:
    """The Kuhn simplices of `cells` on which every component takes both signs."""
    n = len(shape)
    corners = cells[:, None] + corner_offsets(n) @ strides(shape)
    numbers, places = weld(corners.ravel())
    values = checked_values(sample(numbers))
    places = places.reshape(corners.shape)
    bits = np.ascontiguousarray(sign_bits(values)[places].T)
    hit = [np.flatnonzero(straddles(bits[chain], values.shape[1])) for chain in chains(n)]
    rows = [places[own][:, chain] for own, chain in zip(hit, chains(n), strict=True)]
    orientation = [np.full(len(own), s) for own, s in zip(hit, signs(n), strict=True)]
    parents = [cells[own] * factorial(n) + J for J, own in enumerate(hit)]
    points = np.array(np.unravel_index(numbers, shape), np.float64).T
    simplices = [np.concatenate(lists) for lists in (rows, orientation, parents)]
    return Complex(numbers[:, None], points, values, *simplices)
