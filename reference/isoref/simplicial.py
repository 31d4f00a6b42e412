r"""Isosurfaces in any dimension and codimension, as unions of simplices.

A field phi on a lattice of dimension n has m components, m <= n. Its isosurface is the set where
the simplicial interpolant phi^ takes a given value in all m components at once: a curve where
n = m + 1, a surface where n = m + 2, isolated points where n = m. Inside one simplex of the Kuhn
triangulation phi^ is linear, so the isosurface is the section of the simplex by m hyperplanes::

    C_J  --phi_1 = 0-->  (n-1)-simplices  --phi_2 = 0-->  (n-2)-simplices  -->  ..  (n-m)-simplices

Each arrow is `isoref.simplex_section`, applied to every simplex that is left.

The whole computation is one operation on one object. A `Complex` is a set of oriented simplices
on shared vertices with values at the vertices; `section` cuts it where the first value is 0 and
gives the complex that is left, one dimension lower and with one value fewer. `extract` makes the
complex of the lattice and cuts it m times. `extract_plain` does the same a simplex at a time.

Glossary
--------
n, m        dimension of the lattice, number of components (codimension)
phi, phi^   samples, their simplicial interpolant; here always minus the isovalue
psi         the component that is cut next
k           dimension of the simplices of a complex, n at first, n - m at last
cell        a cube of the lattice, named by the number of its lowest sample (C order)
parent      of a simplex: the Kuhn simplex it lies in, as cell * n! + number of the permutation

Invariants
----------
Rows of a complex climb in the numbering of its vertices; vertices of a section are numbered by
the pair (lower end, higher end) of the edge they lie on. So every shared face is cut alike with
the rule "staircase", and the result is a simplicial complex: an (n-m)-manifold, closed away from
the border of the lattice, whatever the samples are.

Orientation: with g_i the gradient of component i and t_1 .. t_(n-m) the edges of a simplex from
its first vertex, det(-g_1, .., -g_m, t_1, .., t_(n-m)) > 0. For n = 3, m = 1 this says that
right-hand normals point from high to low; for n = 2, m = 1 the inside lies to the left. A point,
n = m, has no edges and no row can tell its orientation: `jacobian_signs` gives it, the sign of
det(g_1, .., g_n), and the signs of all points sum to the degree of phi on the border.

References
----------
1. C. Min, 2003: section 4, equation 4.
2. C. Weigle, D. Banks, "Complex-valued contour meshing", IEEE Visualization 1996.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import factorial
from typing import Any

import numpy as np
import psutil

from isoref.field import Booleans, Field, FieldError, Floats, Integers, check_isovalue
from isoref.kuhn import (
    chains,
    check_thickness,
    corner_offsets,
    gradient,
    lattice_simplices,
    permutations,
    signs,
    strides,
)
from isoref.mesh import Mesh
from isoref.simplex_section import SectionTable, crossing, section_table, with_epsilon

Isovalue = float | Sequence[float]
Sampler = Callable[[Integers], Floats]

Name = Any  # a sample's number, or a pair of names
State = dict[Name, Floats]  # the point and the values of each vertex
Named = tuple[list[Name], int]  # a simplex and its orientation

# Kuhn simplices that are cut together: enough for NumPy to be fast, few enough for the cache.
BLOCK = 1 << 17

# How many times its size a complex takes: the result while blocks are put together, the largest
# of a block's complexes while it is cut.
JOINING, CUTTING = 3.5, 6.0

# Bytes a sample that the search for active cells takes: five arrays of signs.
PASS_BYTES = 5

# A trial cuts runs of neighbouring cells, evenly spread: one cell in 16, in 16 to 64 runs.
RUN, SHARE, LEAST_RUNS, MOST_RUNS = 16, 16, 16, 64


@dataclass(frozen=True, eq=False)
class Complex:
    """Oriented simplices on shared vertices, with values at the vertices.

    Attributes
    ----------
    names : (V, 2^s) after s sections: the sample a vertex is, or the names of the ends of its edge
    points : (V, n) indices into the lattice, fractional from the first section on
    values : (V, r) the components that are still to be cut
    simplices : (S, k + 1) rows of vertices, climbing
    signs : (S,) +1 where the row as it stands has the right orientation, else -1
    parents : (S,) the Kuhn simplex each lies in
    """

    names: Integers
    points: Floats
    values: Floats
    simplices: Integers
    signs: Integers
    parents: Integers


def extract(
    field: Field,
    isovalue: Isovalue = 0.0,
    *,
    rule: str = "staircase",
    epsilon: float | None = None,
    memory: int | None = None,
) -> Mesh:
    """The isosurface of `field`: (n-m)-simplices on shared vertices.

    Parameters
    ----------
    isovalue : one number for all components, or one a component
    rule : a name of `isoref.simplex_section.RULES`
    epsilon : replace exact zeros by this number, as the paper does; by default nothing is changed
    memory : bytes that may be used beyond the field; what the machine has free by default

    Raises
    ------
    FieldError
        for more components than axes, a lattice one sample thick, an isovalue that is no finite
        number, or, before it is made, a surface that is too large for the memory.

    >>> i, j = np.indices((5, 5))
    >>> extract(Field.of((i - 2) ** 2 + (j - 2) ** 2), 2.5)
    Mesh(22 vertices in R^2, 22 simplices of dimension 1)
    """
    complex_ = section_of_field(field, isovalue, rule, epsilon, memory)
    return to_mesh(complex_, field.spacing, field.origin)


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
    flat = field.values.reshape(field.components, -1)

    def sample(numbers: Integers) -> Floats:
        return zeroed(flat[:, numbers].T.astype(np.float64) - level, epsilon)

    samples = flat.shape[1]
    check_memory(PASS_BYTES * samples, allowed_memory(memory), f"one pass over {samples:,} samples")
    cells = active_cells(field, level)
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

    def cut(block: Integers) -> Iterator[Complex]:
        return successive_sections(kuhn_complex(shape, block, sample), rule, epsilon)

    block = -(-BLOCK // factorial(len(shape)))
    needed, allowed = estimated_bytes(cut, cells, block), allowed_memory(memory)
    check_memory(needed, allowed, f"the isosurface in {len(cells):,} cells")
    starts = range(0, max(len(cells), 1), block)
    return united([deque(cut(cells[start : start + block]), maxlen=1).pop() for start in starts])


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


def levels(isovalue: Isovalue, m: int) -> Floats:
    """The isovalue of each component, or a `FieldError`.

    >>> levels(2, 3).tolist()
    [2.0, 2.0, 2.0]
    """
    given = list(isovalue) if isinstance(isovalue, Sequence | np.ndarray) else [isovalue] * m
    if len(given) != m:
        raise FieldError(f"{len(given)} isovalues for {m} components; give one, or one a component")
    return np.array([check_isovalue(value) for value in given])


def zeroed(values: Floats, epsilon: float | None) -> Floats:
    """The values, with exact zeros replaced where an epsilon is given."""
    return values if epsilon is None else with_epsilon(values, epsilon)


def check_input(shape: tuple[int, ...], m: int) -> None:
    """Nothing, where m components can be cut on this lattice; else raises a `FieldError`."""
    if m > len(shape):
        raise FieldError(
            f"{m} components on a lattice of dimension {len(shape)}: an isosurface needs m <= n; "
            "was `dimension` given to Field.of?"
        )
    check_thickness(shape)


def checked_values(values: Floats) -> Floats:
    """The values, or a `FieldError` where they are not finite or too large to be interpolated."""
    if not (np.abs(values) <= np.finfo(np.float64).max / 2).all():
        raise FieldError(
            "a sample minus the isovalue is not finite or beyond 8.9e307; rescale the field"
        )
    return values


def allowed_memory(memory: int | None) -> int:
    """The bytes that may be used: those given, or what the machine has free."""
    return int(psutil.virtual_memory().available) if memory is None else memory


def check_memory(needed: float, allowed: int, what: str) -> None:
    """Nothing, where `what` fits in the memory allowed; else a `FieldError` with the numbers."""
    if needed > allowed:
        raise FieldError(
            f"{what} needs about {int(needed):,} bytes, but {allowed:,} are allowed; "
            "take a coarser lattice or a part of it"
        )


def estimated_bytes(
    cut: Callable[[Integers], Iterator[Complex]], cells: Integers, block: int
) -> float:
    """About how many bytes the isosurface in these cells takes at the highest, from a trial."""
    runs = min(max(len(cells) // (SHARE * RUN), LEAST_RUNS), MOST_RUNS)
    starts = np.linspace(0, max(len(cells) - RUN, 0), runs).astype(np.int64)
    tried = np.unique(starts[:, None] + np.arange(min(RUN, len(cells))))
    sizes = [bytes_of(part) / max(len(tried), 1) for part in cut(cells[tried])]
    whole, largest = sizes[-1] * len(cells), max(sizes) * min(block, len(cells))
    return max(JOINING * whole, CUTTING * largest)


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
        bits |= (components[c] >= level[c]).astype(bits.dtype) << bits.dtype.type(c)
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


def to_mesh(complex_: Complex, spacing: Sequence[float], origin: Sequence[float]) -> Mesh:
    """The mesh of a complex, its points in space and its rows oriented as they stand."""
    rows = complex_.simplices.copy()
    if rows.shape[1] > 1:
        negative = complex_.signs < 0
        rows[negative, -2:] = rows[negative, -2:][:, ::-1]
    return Mesh(complex_.points * spacing + origin, rows)


def jacobian_signs(complex_: Complex) -> Integers:
    """The sign of det(g_1, .., g_n) at each point where n = m: the index of each zero, (S,).

    In the order of the simplices, which is that of the mesh. The signs are combinatorial, like
    all orientation here: none is 0, even where samples are tied.

    Raises
    ------
    FieldError
        for a complex of anything but points.

    >>> x, y = np.indices((9, 9)) - 4.0
    >>> squared = Field.of([x * x - y * y, 2 * x * y], dimension=2)
    >>> jacobian_signs(section_of_field(squared, [3.0, 0.5])).tolist()
    [1, 1]
    """
    n, k = complex_.points.shape[1], complex_.simplices.shape[1] - 1
    if k:
        raise FieldError(
            f"simplices of dimension {k} are oriented by their rows; points need n = m"
        )
    return np.asarray(complex_.signs * (-1) ** n)


def gradients(
    parents: Integers, sample: Sampler, shape: tuple[int, ...], spacing: Sequence[float]
) -> Floats:
    """The gradients of the m components of phi^ on Kuhn simplices, (S, m, n), by equation 1."""
    n = len(shape)
    cell, J = np.divmod(parents, factorial(n))
    chain = chains(n)[J]
    vertices = cell[:, None] + (corner_offsets(n) @ strides(shape))[chain]
    values = sample(vertices.ravel()).reshape(*vertices.shape, -1)
    return gradient(np.moveaxis(values, -1, 1), permutations(n)[J][:, None], spacing)


def extract_plain(
    field: Field,
    isovalue: Isovalue = 0.0,
    *,
    rule: str = "staircase",
    epsilon: float | None = None,
) -> Mesh:
    """The mesh of `extract`, up to the order of its simplices, made one simplex at a time.

    A vertex is named by the sample it is, or by the pair of vertices whose edge it lies on;
    names in order number the vertices.
    """
    check_input(field.shape, field.components)
    n, m = field.dimension, field.components
    flat = field.values.reshape(m, -1).astype(np.float64)
    values = zeroed(flat.T - levels(isovalue, m), epsilon)
    state: State = {
        number: np.concatenate([index, values[number]])
        for number, index in enumerate(np.ndindex(field.shape))
    }
    rows, orientation = lattice_simplices(field.shape)
    simplices: list[Named] = list(zip(rows.tolist(), orientation.tolist(), strict=True))
    for c in range(m):
        simplices = [
            piece
            for names, sign in simplices
            for piece in _cut_plainly(names, sign, state, n + c, rule, epsilon)
        ]
    return to_mesh(_numbered(simplices, state, n, n - m), field.spacing, field.origin)


def _numbered(simplices: list[Named], state: State, n: int, k: int) -> Complex:
    """Named k-simplices of R^n as a complex, their vertices numbered in the order of names."""
    used = sorted({name for names, _ in simplices for name in names})
    number = {name: i for i, name in enumerate(used)}
    rows = [[number[name] for name in names] for names, _ in simplices]
    none = np.empty((0, 0), np.int64)
    return Complex(
        none,
        np.array([state[name][:n] for name in used]).reshape(-1, n),
        np.empty((0, 0)),
        np.array(rows, np.int64).reshape(-1, k + 1),
        np.array([sign for _, sign in simplices], np.int64),
        none,
    )


def _cut_plainly(
    names: list[Name], sign: int, state: State, psi: int, rule: str, epsilon: float | None
) -> list[Named]:
    """The oriented simplices of the section of one simplex where entry `psi` of its state is 0."""
    positive = [bool(state[name][psi] >= 0) for name in names]
    if all(positive) or not any(positive):
        return []
    code = sum(1 << position for position, bit in enumerate(positive) if bit)
    table = section_table(rule, len(names) - 1, code)
    vertices = []
    for i in (names[position] for position in table.negatives):
        for j in (names[position] for position in table.positives):
            v = crossing(state[i], state[j], state[i][psi], state[j][psi])
            v[psi + 1 :] = zeroed(v[psi + 1 :], epsilon)
            vertices.append((min(i, j), max(i, j)))
            state[vertices[-1]] = v
    return [
        ([vertices[edge] for edge in row], sign * int(orientation))
        for row, orientation in zip(table.rows, table.signs, strict=True)
    ]
