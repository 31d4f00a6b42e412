"""The curves in which a mesh meets the faces of the cells, and which of them are legal.

A cell's surface is bounded by segments on the cell's six faces. The signs of a face's four
corners leave little choice: with one crossing pair of edges there is one segment; with four
crossings there are two, and they cut off either the two inside corners (*separated*) or the two
outside corners (*joined*). These are the legal resolutions of the cell: for each ambiguous face
one of two, for every other face one. Segments that join opposite edges would cross each other.

A trace is read off a mesh without asking how it was made. Each triangle lies in one cell; the
edges of the cell's triangles that lie in a face, counted modulo two, are the cell's trace. Chords
that two triangles of the same cell share cancel, as do folds. Triangles that lie flat in a face
may belong to the cell on either side of it; `isograde.oracles.flat` reads such faces.

Glossary
--------
place       index coordinates
cell        named by its lowest corner (i, j, k), or by that corner's flat index among the cells
node        the place of a vertex in its cell, in half steps: offsets 0, 1, 2 along each axis with
            exactly one 1 (the middle of a lattice edge), as the number 9 a + 3 b + c
code        a cell's trace: 36 bits, six for each face, one for each pair of the face's four edges
flat        a triangle that lies in a face, see `isograde.oracles.flat`
excess      triangles in a cell beyond those that a disc in each of its curves takes

Nodes, faces and pairs are numbered by position alone; no table of the reference is used.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import combinations
from weakref import WeakKeyDictionary

import numpy as np
from isoref.field import Booleans, Floats, Integers
from numpy.typing import NDArray

from isograde.oracles.flat import OUTSIDE, WALL, Lying, Readings, read
from isograde.oracles.lattice import Lattice

Place = tuple[int, int, int]

HALVES = (0, 1, 2)
PLACES: tuple[Place, ...] = tuple((a, b, c) for a in HALVES for b in HALVES for c in HALVES)
NODES: tuple[Place, ...] = tuple(p for p in PLACES if p.count(1) == 1)
CORNERS: tuple[Place, ...] = tuple(p for p in PLACES if p.count(1) == 0)
FACES: tuple[tuple[int, int], ...] = tuple((axis, side) for axis in range(3) for side in (0, 2))
NOWHERE = 27
# Look so few traces up one by one; of more, each distinct one once.
FEW = 128


def number(place: Place) -> int:
    """9 a + 3 b + c, for a node or a corner in half steps."""
    return 9 * place[0] + 3 * place[1] + place[2]


def nodes_on(face: tuple[int, int]) -> tuple[Place, ...]:
    """The four nodes on a face.

    >>> nodes_on((2, 0))
    ((0, 1, 0), (1, 0, 0), (1, 2, 0), (2, 1, 0))
    """
    axis, side = face
    return tuple(p for p in NODES if p[axis] == side)


def segments_on(face: tuple[int, int]) -> tuple[tuple[Place, Place], ...]:
    """The six pairs of nodes on a face, in the order of the code's bits."""
    return tuple(combinations(nodes_on(face), 2))


@cache
def _bits() -> Integers:
    """(28 * 28,) the code's bit of a segment between two nodes, 0 where there is none."""
    table = np.zeros((28, 28), np.int64)
    for f, face in enumerate(FACES):
        for s, (p, q) in enumerate(segments_on(face)):
            table[number(p), number(q)] = table[number(q), number(p)] = 1 << (6 * f + s)
    return table.reshape(-1)


def _ends(node: Place) -> tuple[Place, Place]:
    """The two corners of a node's lattice edge."""
    a, b = (tuple(side if x == 1 else x for x in node) for side in (0, 2))
    return (a[0], a[1], a[2]), (b[0], b[1], b[2])


def _cut(face: tuple[int, int], corners: set[Place]) -> int:
    """The bits of the segments that cut these corners off, one by one."""
    return sum(
        1 << s
        for s, (p, q) in enumerate(segments_on(face))
        if set(_ends(p)) & set(_ends(q)) & corners
    )


def _legal_on(face: tuple[int, int], inside: set[Place]) -> tuple[int, int]:
    """A face's legal traces, six bits each: inside corners separated, and joined."""
    axis, side = face
    corners = {c for c in CORNERS if c[axis] == side}
    crossed = [p for p in nodes_on(face) if len(set(_ends(p)) & inside) == 1]
    if len(crossed) == 4:
        return _cut(face, corners & inside), _cut(face, corners - inside)
    if not crossed:
        return 0, 0
    segment = 1 << segments_on(face).index((crossed[0], crossed[1]))
    return segment, segment


@cache
def legal() -> Integers:
    """(256, 6, 2) legal traces of each face of each cell: separated first, joined second.

    Bit c of the cell's number is set where the corner ``CORNERS[c]`` is inside. Where the two are
    equal, the face is not ambiguous.
    """
    table = np.zeros((256, 6, 2), np.int64)
    for signs in range(256):
        inside = {c for bit, c in enumerate(CORNERS) if signs >> bit & 1}
        table[signs] = [_legal_on(face, inside) for face in FACES]
    return table


@cache
def polygons(code: int) -> int:
    """Number of closed curves that a trace consists of.

    >>> polygons(0)
    0
    """
    segments = [
        pair
        for f, face in enumerate(FACES)
        for s, pair in enumerate(segments_on(face))
        if code >> (6 * f + s) & 1
    ]
    group = {p: p for pair in segments for p in pair}
    for p, q in segments:
        old, new = group[p], group[q]
        group = {node: new if g == old else g for node, g in group.items()}
    return len(set(group.values()))


_ONES = np.array([x.bit_count() for x in range(64)])
"""Number of segments of a face's trace."""


@dataclass(frozen=True, eq=False)
class Traces:
    """What a mesh does in each cell that the field or the mesh makes active.

    Attributes
    ----------
    cell : (n,) flat index of each cell, increasing
    place : (n, 3) its lowest corner
    signs : (n,) its corners' sides, as in `legal`
    tied : (n,) a corner is a tied sample: what the mesh does there is not judged
    code : (n,) its trace, flat triangles apart
    triangles : (n,) triangles in it, flat ones apart
    extra : (n,) vertices strictly inside it
    spanning : triangles that no single cell contains
    lying : the triangles that lie flat in the cells' faces
    unjudged : (n,) there are more ways to give the cell its flat triangles than are tried
    """

    cell: Integers
    place: Integers
    signs: Integers
    tied: Booleans
    code: Integers
    triangles: Integers
    extra: Integers
    spanning: Integers
    lying: Lying
    unjudged: Booleans

    @cached_property
    def faces(self) -> Integers:
        """(n, 6) the trace of each face."""
        return _by_face(self.code)

    @cached_property
    def legal(self) -> Integers:
        """(n, 6, 2) the legal traces of each face, as in `legal`."""
        return legal()[self.signs]

    @cached_property
    def ambiguous(self) -> Booleans:
        """(n, 6) faces with two legal traces."""
        return np.asarray(self.legal[..., 0] != self.legal[..., 1])

    @cached_property
    def readings(self) -> Readings:
        """The ways to read the faces in which triangles lie flat."""
        return read(self.lying, self.faces, self.legal)

    @cached_property
    def separated(self) -> Booleans:
        """(n, 6) faces that can be read so that the trace separates the inside corners."""
        return self._is(0)

    @cached_property
    def joined(self) -> Booleans:
        """(n, 6) faces that can be read so that the trace joins the inside corners."""
        return self._is(1)

    def _is(self, state: int) -> Booleans:
        """(n, 6) the trace is the legal one of this state; with flat triangles, can be."""
        found = np.asarray(self.faces == self.legal[..., state])
        return self._on_flat(found, self.readings.legal[:, state]) if len(self.lying) else found

    @cached_property
    def undecided(self) -> Booleans:
        """(n, 6) faces with more flat triangles than are tried."""
        none = np.zeros((len(self.cell), 6), bool)
        return self._on_flat(none, self.readings.undecided) if len(self.lying) else none

    def _on_flat(self, found: Booleans, given: Booleans) -> Booleans:
        """(n, 6) what was found, and on faces with flat triangles what is given (m,)."""
        for row, face in self.lying.sides:
            known = row >= 0
            found[row[known], face[known]] = given[known]
        return found

    @cached_property
    def settled(self) -> Traces:
        """The traces with each flat triangle in one cell, so that the most cells have no excess.

        Where a cell has more than discs, four triangles more, a tunnel between two of its curves,
        come next.
        """
        if not len(self.lying):
            return self
        readings, trials = self.readings, self.readings.trials
        tried = self._tried()
        excess = tried.excess
        tunnel = (excess == 4) & (tried.polygons >= 2)
        cost = np.where(tried.tied | (excess == 0), 0, np.where(tunnel, 1, 1 << 20))
        chosen = trials.chosen(readings, readings.settle(cost))
        rows = np.array(list(trials.first), np.int64)
        code, triangles, unjudged = self.code.copy(), self.triangles.copy(), self.unjudged.copy()
        code[rows], triangles[rows] = tried.code[chosen], tried.triangles[chosen]
        unjudged[readings.unjudged] = True
        return replace(self, code=code, triangles=triangles, lying=Lying.none(), unjudged=unjudged)

    def _tried(self) -> Traces:
        """The trial cells, each with the flat triangles that it has."""
        trials = self.readings.trials
        code, triangles = self.code[trials.row], self.triangles[trials.row]
        position = np.searchsorted(self.lying.start, trials.triangle, side="right") - 1
        below = self.lying.below[position] == trials.row[trials.owner]
        shift = 12 * self.lying.axis[position] + 6 * below
        np.bitwise_xor.at(code, trials.owner, self.lying.bits[trials.triangle] << shift)
        np.add.at(triangles, trials.owner, 1)
        row = trials.row
        return Traces(
            self.cell[row],
            self.place[row],
            self.signs[row],
            self.tied[row],
            code,
            triangles,
            self.extra[row],
            self.spanning,
            Lying.none(),
            self.unjudged[row],
        )

    @cached_property
    def polygons(self) -> Integers:
        """(n,) number of closed curves in each cell's trace."""
        if len(self.code) <= FEW:
            return np.array([polygons(code) for code in self.code.tolist()], np.int64)
        codes, group = np.unique(self.code, return_inverse=True)
        counts = np.array([polygons(int(c)) for c in codes], np.int64)
        return counts[group]

    @cached_property
    def segments(self) -> Integers:
        """(n,) number of segments in each cell's trace."""
        return np.asarray(_ONES[self.faces].sum(axis=1))

    @cached_property
    def excess(self) -> Integers:
        """(n,) triangles less those of one disc a curve, with the vertices inside the cell."""
        return np.asarray(self.triangles - self.segments - 2 * self.extra + 2 * self.polygons)


def alike(ours: Traces, theirs: Traces, row: Integers, other: Integers) -> Booleans:
    """(n, 6) the cells ours[row] and theirs[other] can be read alike on a face, or are not decided.

    Each two are one cell of a lattice.

    Flat triangles of a neighbour add readings to a face, and which cell they belong to is not
    compared; so the same surface posed otherwise may have more readings, but has one in common.
    """
    # Without flat triangles there is one reading, and most often it is the same everywhere.
    plain = not len(ours.lying) and not len(theirs.lying)
    if plain and np.array_equal(ours.code[row], theirs.code[other]):
        return np.ones((len(row), 6), bool)
    separated, joined = ours.separated[row], ours.joined[row]
    others = theirs.separated[other], theirs.joined[other]
    common = (separated & others[0]) | (joined & others[1])
    neither = ~(separated | joined) & ~(others[0] | others[1])
    return np.asarray(common | neither | ours.undecided[row] | theirs.undecided[other])


def _by_face(code: Integers) -> Integers:
    """(n, 6) six bits a face."""
    split: Integers = (code[:, None] >> (6 * np.arange(6))) & 63
    return split


def signs_of(lattice: Lattice) -> NDArray[np.uint8]:
    """(N1 - 1, N2 - 1, N3 - 1) the sides of every cell's corners, as in `legal`."""
    n = [max(size - 1, 0) for size in lattice.shape]
    signs: NDArray[np.uint8] = np.zeros(n, np.uint8)
    for bit, corner in enumerate(CORNERS):
        window = tuple(slice(x // 2, x // 2 + size) for x, size in zip(corner, n, strict=True))
        signs |= lattice.inside[window].astype(np.uint8) << np.uint8(bit)
    return signs


def traces(lattice: Lattice, places: Floats, faces: Integers, *, more: bool = False) -> Traces:
    """The trace of every active cell; triangles outside the volume are not looked at.

    more : the mesh goes on beyond the border, whatever is declared. A triangle that lies in the
        border may belong to what is beyond it; where the mesh ends in the border, it is the cell's.
    """
    shape = np.maximum(np.subtract(lattice.shape, 1), 0)
    if lattice not in _ACTIVE:
        signs = signs_of(lattice).reshape(-1)
        _ACTIVE[lattice] = _cells(lattice, signs, np.flatnonzero((signs != 0) & (signs != 255)))
    cells = _ACTIVE[lattice]
    corner, code, extent = _triangles(lattice, places, faces)
    here = ((corner >= 0) & (corner < shape)).all(axis=1)
    proper = here & (extent == 1).all(axis=1)
    own = _flat_index(corner[proper], shape)
    # Most often every triangle is in a cell with both sides.
    signs = cells.all_signs[own]
    if ((signs == 0) | (signs == 255)).any():
        cells = _cells(lattice, cells.all_signs, np.union1d(cells.cell, own))
    cell = cells.cell
    at = np.searchsorted(cell, own)
    order = np.argsort(at, kind="stable")
    count = np.bincount(at, minlength=len(cell))
    total = np.zeros(len(cell), np.int64)
    busy = np.flatnonzero(count)
    if len(busy):
        starts = (np.cumsum(count) - count)[busy]
        total[busy] = np.bitwise_xor.reduceat(code[proper][order], starts)
    lying = _lying(cell, corner, code, extent, shape)
    if len(lying) and not more:
        lying = _walled(lying, lattice)
    return Traces(
        cell,
        cells.place,
        cells.signs,
        cells.tied,
        total,
        count,
        _extra_vertices(lattice, places, faces, cell, shape),
        np.flatnonzero((extent > 1).any(axis=1)),
        lying,
        np.zeros(len(cell), bool),
    )


@dataclass(frozen=True, eq=False)
class _Cells:
    """Cells of a lattice, `cell`, `place`, `signs` and `tied` as in `Traces`; the signs of all."""

    all_signs: NDArray[np.uint8]
    cell: Integers
    place: Integers
    signs: Integers
    tied: Booleans


def _cells(lattice: Lattice, signs: NDArray[np.uint8], cell: Integers) -> _Cells:
    """These cells, where all have these signs."""
    shape = tuple(max(size - 1, 1) for size in lattice.shape)
    place = np.stack(np.unravel_index(cell, shape), axis=1)
    tied = _tied_cells(lattice, place)
    return _Cells(signs, cell, place, signs[cell].astype(np.int64), tied)


_ACTIVE: WeakKeyDictionary[Lattice, _Cells] = WeakKeyDictionary()
"""The cells of a lattice that have both sides: many meshes lie over one lattice."""


def _flat_index(corner: Integers, shape: Integers) -> Integers:
    """Flat index of cells among (N1 - 1, N2 - 1, N3 - 1)."""
    index: Integers = (corner[:, 0] * shape[1] + corner[:, 1]) * shape[2] + corner[:, 2]
    return index


def _triangles(
    lattice: Lattice, places: Floats, faces: Integers
) -> tuple[Integers, Integers, Integers]:
    """Each triangle's cell, the bits of its edges, and its extent in whole cells along each axis.

    A flat triangle has extent 0 along one axis; its cell is the upper of the two.
    """
    low = np.floor(places + lattice.tolerance).astype(np.int64)
    high = np.ceil(places - lattice.tolerance).astype(np.int64)
    a, b, c = faces[:, 0], faces[:, 1], faces[:, 2]
    corner = np.minimum(np.minimum(low[a], low[b]), low[c])
    extent = np.maximum(np.maximum(high[a], high[b]), high[c]) - corner
    node = _nodes(lattice, places, low)
    base = 2 * (corner @ [9, 3, 1])
    p, q, r = (_within(node[v] - base) for v in (a, b, c))
    bits = _bits()
    return corner, bits[28 * p + q] ^ bits[28 * q + r] ^ bits[28 * r + p], extent


def _nodes(lattice: Lattice, places: Floats, low: Integers) -> Integers:
    """(V,) number of each vertex's node from the lattice's own zero; far below it for others."""
    nearest = np.rint(places).astype(np.int64)
    gap = np.abs(places - nearest)
    free = gap.argmax(axis=1)
    rows = np.arange(len(places))
    on_edge = (gap <= lattice.tolerance).sum(axis=1) >= 2
    halves = 2 * nearest
    halves[rows, free] = 2 * low[rows, free] + 1
    return np.where(on_edge, halves @ [9, 3, 1], -(1 << 60))


def _within(node: Integers) -> Integers:
    """The number where it is a place in the cell, else NOWHERE."""
    return np.where((node >= 0) & (node < NOWHERE), node, NOWHERE)


def _lying(
    cell: Integers, corner: Integers, code: Integers, extent: Integers, shape: Integers
) -> Lying:
    """The flat triangles on the faces of these cells."""
    level = extent <= 0
    if not level.any():
        return Lying.none()
    flat = np.flatnonzero(level.any(axis=1) & (level.sum(axis=1) == 1) & (extent <= 1).all(axis=1))
    if not len(flat) or not len(cell):
        return Lying.none()
    axis = level[flat].argmax(axis=1)
    above = _rows(cell, corner[flat], shape)
    below = _rows(cell, corner[flat] - np.eye(3, dtype=np.int64)[axis], shape)
    known = (above >= 0) | (below >= 0)
    flat, axis, above, below = flat[known], axis[known], above[known], below[known]
    # A face is named by its axis and a cell beside it; both sides are needed, as one may be -1.
    names = np.stack([axis, below, above], axis=1)
    order = np.lexsort(names.T)
    new = (np.diff(names[order], axis=0, prepend=-9) != 0).any(axis=1)
    first = order[new]
    # Seen from the upper cell the face is the lower one of its axis; from the lower cell it is
    # the upper one, with the same pairs in the same order.
    bits = code[flat[order]] >> (12 * axis[order]) & 63
    start = np.append(np.flatnonzero(new), len(order))
    return Lying(flat[order], bits, start, axis[first], below[first], above[first])


def _walled(lying: Lying, lattice: Lattice) -> Lying:
    """The flat triangles, with a wall beyond faces of the border in which the mesh ends."""
    ends_here = np.array([end.end == "open" and end.inset >= 0 for end in lattice.ends])
    walled = ends_here[lying.axis]
    below, above = (
        np.where((row == OUTSIDE) & walled, WALL, row) for row in (lying.below, lying.above)
    )
    return replace(lying, below=below, above=above)


def _rows(cell: Integers, place: Integers, shape: Integers) -> Integers:
    """The rows of cells by their lowest corners; -1 for one not listed, else `OUTSIDE`."""
    there = ((place >= 0) & (place < shape)).all(axis=1)
    index = _flat_index(place, shape)
    at = np.minimum(np.searchsorted(cell, index), len(cell) - 1)
    return np.where(there, np.where(cell[at] == index, at, -1), OUTSIDE)


def _tied_cells(lattice: Lattice, place: Integers) -> Booleans:
    """(n,) cells with a tied corner."""
    tied = np.zeros(len(place), bool)
    if lattice.tied.any():
        for corner in CORNERS:
            i, j, k = (place + np.asarray(corner) // 2).T
            tied |= lattice.tied[i, j, k]
    return tied


def _extra_vertices(
    lattice: Lattice, places: Floats, faces: Integers, cell: Integers, shape: Integers
) -> Integers:
    """(n,) vertices in use strictly inside each cell."""
    used = np.zeros(len(places), bool)
    used[faces] = True
    gap = np.abs(places - np.rint(places))
    inner = places[used & (gap > lattice.tolerance).all(axis=1)]
    corner = np.floor(inner).astype(np.int64)
    corner = corner[((corner >= 0) & (corner < shape)).all(axis=1)]
    at = np.searchsorted(cell, _flat_index(corner, shape))
    at = at[at < len(cell)]
    return np.bincount(at, minlength=len(cell))
