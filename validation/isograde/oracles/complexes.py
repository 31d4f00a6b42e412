"""What is true of a mesh of oriented k-simplices in n dimensions, counted from its arrays.

A simplex (v0, .., vk) has k + 1 facets, each named by the vertex it leaves out. Write each facet as
a number that holds its vertices in ascending order and then its own index, and sort: the facets
that two simplices share now stand side by side. How often each occurs and which way it is turned
says whether the mesh is closed, oriented, and a manifold across its facets; what is round each
vertex says the rest.

Glossary
--------
n, k        dimension of the space and of the simplices
facet       a (k - 1)-simplex of a k-simplex: an end, an edge, a triangle, ..
side        a facet as a part of one simplex, numbered ``(k + 1) * simplex + corner`` by the corner
            opposite to it; the side of a triangle by the corner from which it runs to the next one
uses        number of sides of a facet
balance     sides turned as the ascending order of the facet's vertices, less those turned against
link        of a vertex: the facets opposite to it, in the simplices that have it
fan         of a vertex of a triangle mesh: a connected part of its link

Simplices that name a vertex twice are left out first: they bound nothing.

A mesh is a k-manifold where every facet has two simplices (one at its boundary) and every link is
a sphere (a ball at the boundary) of dimension k - 1. For k up to 3 that is decided exactly: links
are points, closed or open chains, and closed surfaces of Euler characteristic 2 or discs. For
larger k a link is only asked to be connected, to have at most two simplices a facet and the Euler
characteristic of a sphere or a ball.

References
----------
[1] A. Hatcher, Algebraic Topology, 2002, chapter 2 (chains, boundary, Euler characteristic).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from math import factorial

import numpy as np
from isoref.field import Booleans, Floats, Integers

from isograde.oracles.rows import components_of, distinct

# The largest dimension of simplices for which "manifold" is decided and not only bounded.
EXACT = 3

# From so many corners on, fans are asked about by walks, of at most so many steps each; so many
# sides are named at once, so that their arrays stay in the processor's cache.
LARGE, WALK, PORTION = 1 << 14, 64, 3 << 14


@dataclass(frozen=True, eq=False)
class Facets:
    """The facets of a mesh, with the sides of each.

    Attributes
    ----------
    rows : (F, k) vertices, ascending
    uses, balance : (F,)
    sides : sides in the order of their facets
    start : (F,) where each facet's sides begin in `sides`
    """

    rows: Integers
    uses: Integers
    balance: Integers
    sides: Integers
    start: Integers


@dataclass(frozen=True, eq=False)
class Complex:
    """A mesh and what is true of it; each property is computed when it is first asked.

    Attributes
    ----------
    points : (V, n) positions
    simplices : (S, k + 1) indices of vertices, none twice in a simplex
    """

    points: Floats
    simplices: Integers

    @classmethod
    def of(cls, points: Floats, simplices: Integers) -> Complex:
        """The complex of these simplices without those that name a vertex twice.

        >>> Complex.of(np.eye(3), np.array([[0, 1, 2], [0, 0, 2]])).simplices
        array([[0, 1, 2]])
        """
        sound = np.ones(len(simplices), bool)
        for i, j in combinations(range(simplices.shape[1]), 2):
            sound &= simplices[:, i] != simplices[:, j]
        return cls(points, simplices if sound.all() else simplices[sound])

    @property
    def k(self) -> int:
        """The dimension of the simplices."""
        return int(self.simplices.shape[1]) - 1

    def renamed(self, name: Integers) -> Complex:
        """The complex with vertex v called ``name[v]``, a vertex; collapsed simplices left out."""
        return Complex.of(self.points, name[self.simplices])

    def welded(self) -> Complex:
        """The same, vertices of exactly equal coordinates made one."""
        # Adding zero makes the two zeros of floating point one.
        points = self.points + 0.0
        first, name = distinct(points)
        return Complex.of(points[first], name[self.simplices])

    # --- facets ---------------------------------------------------------------------------------

    @cached_property
    def facets(self) -> Facets:
        """The facets, by one sort; points have none."""
        if not self.k or not len(self.simplices):
            none = np.empty(0, np.int64)
            return Facets(np.empty((0, max(self.k, 0)), np.int64), none, none, none, none)
        if self.k == 2 and (found := _edges(self.simplices, len(self.points))) is not None:
            return found
        columns, sign = _sides(self.simplices)
        order, start = _sorted(columns, len(self.points))
        uses = np.diff(start, append=len(order))
        balance = np.add.reduceat(sign[order], start)
        first = order[start]
        rows = np.stack([column[first] for column in columns], axis=1)
        return Facets(rows, uses, balance, order, start)

    @cached_property
    def open_facets(self) -> Integers:
        """(.., k) facets used an odd number of times: the boundary modulo two."""
        return self._rows(self.facets.uses % 2 == 1)

    @cached_property
    def crowded_facets(self) -> Integers:
        """(.., k) facets that more than two simplices share."""
        return self._rows(self.facets.uses > 2)

    @cached_property
    def misdirected_facets(self) -> Integers:
        """(.., k) facets used evenly, but not as often one way as the other."""
        return self._rows((self.facets.uses % 2 == 0) & (self.facets.balance != 0))

    @cached_property
    def unbalanced_facets(self) -> Integers:
        """(.., k) facets that the boundary of the oriented mesh does not cancel on."""
        return self._rows(self.facets.balance != 0)

    def _rows(self, which: Booleans) -> Integers:
        """The marked facets."""
        rows: Integers = self.facets.rows[which]
        return rows

    # --- vertices -------------------------------------------------------------------------------

    @cached_property
    def used(self) -> Booleans:
        """(V,) vertices that some simplex names."""
        used = np.zeros(len(self.points), bool)
        used[self.simplices.reshape(-1)] = True
        return used

    @cached_property
    def fans(self) -> Integers:
        """(V,) connected parts of each vertex's link; 1 on a manifold. For triangles only."""
        facets = self.facets
        plain = (facets.uses <= 2).all() and not len(self.misdirected_facets)
        if not plain:
            roots = self._fans_by_linking()
        else:
            turn, ends = self._turns()
            if self.simplices.size > LARGE and self._each_is_one_fan(turn, ends):
                return self.used.astype(np.int64)
            roots = self._fans_by_turning(turn, ends)
        return np.bincount(self.simplices.reshape(-1)[roots], minlength=len(self.points))

    def _turns(self) -> tuple[Integers, Booleans]:
        """The corner after each one about its vertex, itself where a fan ends, and where one does.

        Turning about a vertex is a partial permutation of corners, where no edge is crowded or
        misdirected: cross the edge that comes in and stand at the next triangle's corner.
        """
        # Half the bytes are half the time, where the numbers fit.
        size = self.simplices.size
        twin: Integers = np.arange(size, dtype=np.int32 if size < 1 << 31 else np.int64)
        facets = self.facets
        if 2 * len(facets.start) == size:
            one, other = facets.sides[::2], facets.sides[1::2]
        else:
            at = facets.start[facets.uses == 2]
            one, other = facets.sides[at], facets.sides[at + 1]
        twin[one], twin[other] = other, one

        # The side that comes into corner 3 t + c is 3 t + (c + 2) % 3; its twin leaves the same
        # vertex. At a boundary there is no twin, and the fan ends.
        turn: Integers = np.empty((size // 3, 3), twin.dtype)
        turn[:, 0], turn[:, 1:] = twin.reshape(-1, 3)[:, 2], twin.reshape(-1, 3)[:, :2]
        ends = np.zeros((size // 3, 3), bool)
        if 2 * len(facets.start) != size:
            alone = (twin == np.arange(size)).reshape(-1, 3)
            ends[:, 0], ends[:, 1:] = alone[:, 2], alone[:, :2]
            turn[ends] = np.flatnonzero(ends)
        return turn.reshape(-1), ends.reshape(-1)

    def _each_is_one_fan(self, turn: Integers, ends: Booleans) -> bool:
        """Whether every vertex has one fan: a walk about it meets all of its corners.

        A walk begins anywhere, or where the first triangle of an open fan is, and takes as many
        steps as the largest fan has corners; so those with large ones are not asked.
        """
        tail = self.simplices.reshape(-1)
        corners = np.bincount(tail, minlength=len(self.points))
        if corners.max() > WALK:
            return False
        first = np.empty(len(self.points), turn.dtype)
        first[tail] = np.arange(len(tail), dtype=turn.dtype)
        if ends.any():
            begins = np.ones(len(tail), bool)
            begins[turn[~ends]] = False
            first[tail[begins]] = np.flatnonzero(begins)
        vertex = np.flatnonzero(self.used)
        start, number = first.take(vertex), corners.take(vertex)
        at, met = start, 0
        while len(at):
            met += 1
            after = turn.take(at)
            round_ = after == start
            if ends.any():
                round_ |= after == at
            if not round_.any():
                at = after
                continue
            if (number.take(round_.nonzero()[0]) != met).any():
                return False
            goes_on = (~round_).nonzero()[0]
            at, start, number = (one.take(goes_on) for one in (after, start, number))
        return True

    def _fans_by_turning(self, turn: Integers, ends: Booleans) -> Integers:
        """One corner of each fan, by turns (`_turns`).

        Doubling the turn finds every orbit's lowest corner, or -1 where the fan ends, in as many
        steps as the largest fan has binary digits.
        """
        corners = np.arange(len(turn), dtype=turn.dtype)
        lowest = np.where(ends, turn.dtype.type(-1), corners)
        while True:
            lower = np.minimum(lowest, lowest[turn])
            if np.array_equal(lower, lowest):
                return np.flatnonzero(ends | (lowest == corners))
            lowest, turn = lower, turn[turn]

    def _fans_by_linking(self) -> Integers:
        """One corner of each fan, on any triangles: components of corners linked across edges."""
        facets = self.facets
        later = np.ones(len(facets.sides), bool)
        later[facets.start] = False
        place = np.flatnonzero(later)
        tail = self.simplices.reshape(-1)
        following = np.roll(np.arange(tail.size).reshape(-1, 3), -1, axis=1).reshape(-1)
        # Two sides of one edge link their corners at its lower and at its higher end.
        pairs = []
        for end in (0, 1):
            corners = [
                np.where((tail[side] < tail[following[side]]) == (end == 0), side, following[side])
                for side in (facets.sides[place - 1], facets.sides[place])
            ]
            pairs.append(np.stack(corners))
        _, fan = components_of(self.simplices.size, np.concatenate(pairs, axis=1))
        return np.unique(fan, return_index=True)[1]

    @cached_property
    def singular_vertices(self) -> Integers:
        """Vertices whose link is no sphere and no ball, as far as `EXACT` says."""
        if self.k < 2 or not len(self.simplices):
            return np.empty(0, np.int64)
        if self.k == 2:
            return np.flatnonzero(self.fans > 1)
        return self._singular_by_links()

    def _singular_by_links(self) -> Integers:
        """The same, by looking at all links as one complex of disjoint parts."""
        link, owner = self._links()
        bad = np.zeros(len(self.points), bool)
        bad[owner[link.crowded_facets[:, 0]]] = True
        bad[owner[link.singular_vertices]] = True
        # One connected part a vertex.
        _, part = components_of(len(owner), link.pairs)
        parts = owner[distinct(np.stack([owner, part], axis=1))[0]]
        bad |= np.bincount(parts, minlength=len(bad)) > 1
        # The Euler characteristic of a sphere, or of a ball where the link has a boundary.
        bounded = np.zeros(len(bad), bool)
        bounded[owner[link.open_facets[:, 0]]] = True
        wanted = np.where(bounded, 1, 1 + (-1) ** (self.k - 1))
        found = np.zeros(len(bad), np.int64)
        for rows, sign in link.faces():
            found += sign * np.bincount(owner[rows[:, 0]], minlength=len(bad))
        return np.flatnonzero(self.used & (bad | (found != wanted)))

    def _links(self) -> tuple[Complex, Integers]:
        """Every vertex's link, as one complex on nodes (vertex, neighbour); each node's vertex."""
        count = self.k + 1
        centre = np.repeat(self.simplices, count - 1).reshape(-1, count - 1)
        others = np.concatenate([np.delete(self.simplices, i, axis=1) for i in range(count)])
        centre = np.concatenate(
            [np.repeat(self.simplices[:, [i]], count - 1, axis=1) for i in range(count)]
        )
        nodes, rows = np.unique(centre * len(self.points) + others, return_inverse=True)
        owner = nodes // max(len(self.points), 1)
        return Complex(np.zeros((len(nodes), 0)), rows.reshape(others.shape)), owner

    # --- numbers of the whole -------------------------------------------------------------------

    @cached_property
    def pairs(self) -> Integers:
        """(2, ..) vertices that a simplex joins: its first with each other one."""
        rows = self.simplices
        if rows.shape[1] < 2:
            return np.empty((2, 0), np.int64)
        return np.concatenate([rows[:, [0, i]] for i in range(1, rows.shape[1])]).T

    @cached_property
    def components(self) -> int:
        """Number of connected pieces, simplices joined by shared vertices."""
        # The edges of triangles are fewer than their pairs, and known already.
        pairs = np.ascontiguousarray(self.facets.rows.T) if self.k == 2 else self.pairs
        count, _ = components_of(len(self.points), pairs)
        return count - int((~self.used).sum())

    def faces(self) -> list[tuple[Integers, int]]:
        """The distinct faces of each dimension, with the sign the Euler characteristic gives."""
        rows = self.simplices
        found = []
        for size in range(1, rows.shape[1] + 1):
            subsets = combinations(range(rows.shape[1]), size)
            every = np.concatenate([np.sort(rows[:, list(subset)], axis=1) for subset in subsets])
            columns = [every[:, i] for i in range(size)]
            order, start = _sorted(columns, len(self.points))
            found.append((every[order[start]], (-1) ** (size - 1)))
        return found

    @cached_property
    def euler(self) -> int:
        """Vertices less edges plus triangles less ..; two for each closed sphere.

        >>> Complex.of(np.eye(3), np.array([[0, 1], [1, 2], [2, 0]])).euler
        0
        """
        if self.k == 2:
            return int(self.used.sum()) - len(self.facets.rows) + len(self.simplices)
        return sum(sign * len(rows) for rows, sign in self.faces())

    @cached_property
    def boundary_pieces(self) -> int:
        """Number of connected pieces of the boundary modulo two."""
        rim = Complex(self.points, self.open_facets)
        return rim.components if len(rim.simplices) else 0

    # --- sizes ----------------------------------------------------------------------------------

    @cached_property
    def measures(self) -> Floats:
        """(S,) k-dimensional volume of each simplex, by the Gram determinant.

        >>> Complex.of(np.array([[0.0, 0], [3, 4]]), np.array([[0, 1]])).measures
        array([5.])
        """
        if self.k == 2 and self.points.shape[1] == 3:
            area = np.empty(len(self.normals), self.normals.dtype)
            for at in range(0, len(area), PORTION):
                x, y, z = self.normals[at : at + PORTION].T
                area[at : at + PORTION] = np.sqrt(x * x + y * y + z * z) / 2
            return area
        place = self.points[self.simplices]
        edges = place[:, 1:] - place[:, :1]
        gram = np.linalg.det(edges @ edges.transpose(0, 2, 1))
        return np.asarray(np.sqrt(np.maximum(gram, 0)) / factorial(self.k))

    @cached_property
    def measure(self) -> float:
        """The sum of the simplices' measures: length, area, .."""
        return float(self.measures.sum())

    @cached_property
    def normals(self) -> Floats:
        """(S, 3) right-hand normals of triangles in space, as long as twice the area."""
        normal = np.empty((len(self.simplices), 3), self.points.dtype)
        for at in range(0, len(normal), PORTION):
            some = self.simplices[at : at + PORTION]
            place, u, v = (self.points.take(corner, axis=0) for corner in some.T)
            u -= place
            v -= place
            for axis, (i, j) in enumerate(((1, 2), (2, 0), (0, 1))):
                normal[at : at + PORTION, axis] = u[:, i] * v[:, j] - u[:, j] * v[:, i]
        return normal

    @cached_property
    def enclosed(self) -> float:
        """The volume inside a closed hypersurface, k = n - 1, whose normals point outwards.

        >>> square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
        >>> Complex.of(square, np.array([[0, 1], [1, 2], [2, 3], [3, 0]])).enclosed
        1.0
        """
        if self.k == 2:
            inner = np.empty_like(self.normals)
            for at in range(0, len(inner), PORTION):
                some = slice(at, at + PORTION)
                place = self.points.take(self.simplices[some, 0], axis=0)
                np.multiply(place, self.normals[some], out=inner[some])
            return float(inner.sum() / 6)
        place = self.points[self.simplices] - self.points.mean(axis=0)
        return float(np.linalg.det(place).sum() / factorial(self.k + 1))


def parity(rows: Integers) -> Integers:
    """+1 or -1 for each row: the parity of the permutation that sorts it.

    >>> parity(np.array([[2, 0, 1], [1, 0, 2]])).tolist()
    [1, -1]
    """
    swaps = np.zeros(len(rows), np.int64)
    for i, j in combinations(range(rows.shape[1]), 2):
        swaps += rows[:, i] > rows[:, j]
    return 1 - 2 * (swaps % 2)


def _edges(simplices: Integers, vertices: int) -> Facets | None:
    """The facets of triangles, by one sort; None where a side's name needs more than 64 bits.

    A side is named by its lower vertex, its higher one, its number, and a bit that says whether it
    runs from the lower to the higher; whatever is asked of an edge then follows from the names.
    """
    v, h = max(vertices - 1, 1).bit_length(), max(simplices.size - 1, 1).bit_length()
    if 2 * v + h + 1 > 64:
        return None
    names = np.empty(simplices.size, np.uint64)
    for at in range(0, len(names), PORTION):
        some = simplices[at // 3 : (at + PORTION) // 3].astype(np.uint64)
        tail, head = some.reshape(-1), some[:, [1, 2, 0]].reshape(-1)
        name = np.minimum(tail, head)
        name <<= np.uint64(v)
        name |= np.maximum(tail, head)
        name <<= np.uint64(h)
        name |= np.arange(at, at + len(name), dtype=np.uint64)
        name <<= np.uint64(1)
        name |= tail < head
        names[at : at + PORTION] = name
    names.sort()

    # Read the sides and the edges off the names.
    new = np.ones(len(names), bool)
    sides = np.empty(len(names), np.int64)
    climbs = np.empty(len(names), bool)
    for at in range(0, len(names), PORTION):
        name = names[max(at - 1, 0) : at + PORTION]
        edge = name >> np.uint64(h + 1)
        np.not_equal(edge[1:], edge[:-1], out=new[at + (at == 0) : at + PORTION])
        name = name[(at > 0) :]
        np.not_equal(name & np.uint64(1), 0, out=climbs[at : at + PORTION])
        sides[at : at + PORTION] = name >> np.uint64(1) & np.uint64((1 << h) - 1)
    start = np.flatnonzero(new)
    edge = names[start] >> np.uint64(h + 1)
    rows = np.empty((len(start), 2), np.int64)
    rows[:, 0], rows[:, 1] = edge >> np.uint64(v), edge & np.uint64((1 << v) - 1)
    if 2 * len(start) == len(names) and new[::2].all():
        balance = 2 * (climbs[::2].astype(np.int64) + climbs[1::2] - 1)
        return Facets(rows, np.full(len(start), 2), balance, sides, start)
    uses = np.diff(start, append=len(names))
    return Facets(
        rows, uses, 2 * np.add.reduceat(climbs, start, dtype=np.int64) - uses, sides, start
    )


def _sides(simplices: Integers) -> tuple[list[Integers], Integers]:
    """The k columns of every side's vertices, ascending, and +1 where it is turned so."""
    k = simplices.shape[1] - 1
    if k == 2:
        tail = simplices.reshape(-1)
        head = simplices[:, [1, 2, 0]].reshape(-1)
        climbs = np.where(tail < head, 1, -1)
        return [np.minimum(tail, head), np.maximum(tail, head)], climbs
    sides = np.stack([np.delete(simplices, i, axis=1) for i in range(k + 1)], axis=1)
    turned = np.where(np.arange(k + 1) % 2 == 0, 1, -1)
    flat = sides.reshape(-1, k)
    sign = np.tile(turned, len(simplices)) * parity(flat)
    ordered = np.sort(flat, axis=1)
    return [ordered[:, i] for i in range(k)], sign


def _sorted(columns: list[Integers], vertices: int) -> tuple[Integers, Integers]:
    """An order that sorts rows given by columns, and where each distinct row begins in it.

    Row and index share one 63-bit key where they fit, so that one plain sort does both.
    """
    rows = len(columns[0]) if columns else 0
    v, h = max(vertices - 1, 1).bit_length(), max(rows - 1, 1).bit_length()
    if not rows:
        return np.empty(0, np.int64), np.empty(0, np.int64)
    if v * len(columns) <= 63:
        key = columns[0].astype(np.int64)
        for column in columns[1:]:
            key = key << v | column
        if v * len(columns) + h <= 63:
            key = key << h | np.arange(rows)
            key.sort()
            order, row = key & ((1 << h) - 1), key >> h
        else:
            order = np.argsort(key, kind="stable")
            row = key[order]
        return order, np.flatnonzero(np.r_[True, row[1:] != row[:-1]])
    order = np.lexsort(columns[::-1])
    new = np.zeros(rows, bool)
    new[0] = True
    for column in columns:
        new[1:] |= column[order[1:]] != column[order[:-1]]
    return order, np.flatnonzero(new)
