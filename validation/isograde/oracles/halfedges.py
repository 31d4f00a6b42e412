"""The topology of a triangle mesh, from one sort of its half-edges.

A face (a, b, c) has three half-edges a→b, b→c, c→a. Write each as a number that holds its lower
end, its higher end and its own index, in this order of significance, and sort: the half-edges of
an edge now stand side by side. How many there are and which way they run says whether the mesh
is closed, edge-manifold and oriented; which faces they join says the rest.

Glossary
--------
V, F, E     number of vertices in use, of faces, of edges
half-edge   ``3 * face + corner``, from that corner to the next one of its face
uses        number of half-edges of an edge
twin        the other half-edge of an edge that is used twice
fan         the faces round a vertex that can be reached from one another across edges at it
chain       the sum of directed edges; a→b and b→a cancel

Faces that name a vertex twice are left out first: the half-edges of (a, a, b) cancel.

References
----------
[1] A. Hatcher, Algebraic Topology, 2002, chapter 2 (chains, Euler characteristic).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from isoref.field import Booleans, Floats, Integers
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components


@dataclass(frozen=True, eq=False)
class Edges:
    """The edges of a mesh, with the half-edges of each.

    Attributes
    ----------
    ends : (E, 2) vertices, the lower one first
    uses : (E,) number of half-edges
    balance : (E,) half-edges that run upwards less those that run downwards
    halfedges : half-edges in the order of their edges
    start : (E,) where each edge's half-edges begin in `halfedges`
    """

    ends: Integers
    uses: Integers
    balance: Integers
    halfedges: Integers
    start: Integers


@dataclass(frozen=True, eq=False)
class Surface:
    """A triangle mesh and what is true of it; each property is computed when it is first asked.

    Attributes
    ----------
    points : (V, 3) positions
    faces : (F, 3) indices of vertices, none twice in a face
    """

    points: Floats
    faces: Integers

    @classmethod
    def of(cls, points: Floats, faces: Integers) -> Surface:
        """The surface of these faces without those that name a vertex twice.

        >>> Surface.of(np.eye(3), np.array([[0, 1, 2], [0, 0, 2]])).faces
        array([[0, 1, 2]])
        """
        a, b, c = faces.T
        sound = (a != b) & (b != c) & (c != a)
        return cls(points, faces if sound.all() else faces[sound])

    def welded(self) -> Surface:
        """The same surface, vertices of exactly equal coordinates made one."""
        # Adding zero makes the two zeros of floating point one.
        points, name = np.unique(self.points + 0.0, axis=0, return_inverse=True)
        return Surface.of(points, name.reshape(-1)[self.faces])

    @cached_property
    def edges(self) -> Edges:
        """The edges, by one sort of the half-edges."""
        tail = self.faces.reshape(-1)
        head = self.faces[:, [1, 2, 0]].reshape(-1)
        low, high = np.minimum(tail, head), np.maximum(tail, head)
        pair, halfedges = _sorted_pairs(low, high, len(self.points))
        start = np.flatnonzero(np.r_[True, pair[1:] != pair[:-1]][: len(pair)])
        uses = np.diff(start, append=len(pair))
        upwards = np.where(tail < head, 1, -1)[halfedges]
        balance = np.add.reduceat(upwards, start) if len(start) else start
        first = halfedges[start]
        return Edges(np.stack([low[first], high[first]], 1), uses, balance, halfedges, start)

    @cached_property
    def open_edges(self) -> Integers:
        """(B, 2) ends of the edges used an odd number of times: the boundary modulo two."""
        return self._ends(self.edges.uses % 2 == 1)

    @cached_property
    def crowded_edges(self) -> Integers:
        """(.., 2) ends of the edges that more than two faces share."""
        return self._ends(self.edges.uses > 2)

    @cached_property
    def misdirected_edges(self) -> Integers:
        """(.., 2) ends of the edges used evenly, but not as often one way as the other."""
        return self._ends((self.edges.uses % 2 == 0) & (self.edges.balance != 0))

    @cached_property
    def unbalanced_edges(self) -> Integers:
        """(.., 2) ends of the edges that the chain of directed edges does not cancel on."""
        return self._ends(self.edges.balance != 0)

    def _ends(self, which: Booleans) -> Integers:
        """The ends of the marked edges."""
        ends: Integers = self.edges.ends[which]
        return ends

    @cached_property
    def used(self) -> Booleans:
        """(V,) vertices that some face names."""
        used = np.zeros(len(self.points), bool)
        used[self.faces] = True
        return used

    @cached_property
    def fans(self) -> Integers:
        """(V,) number of fans round each vertex; 1 where the surface is a disc or half a disc."""
        edges = self.edges
        plain = (edges.uses <= 2).all() and not len(self.misdirected_edges)
        roots = self._fans_by_turning() if plain else self._fans_by_linking()
        return np.bincount(self.faces.reshape(-1)[roots], minlength=len(self.points))

    def _fans_by_turning(self) -> Integers:
        """One corner of each fan, where no edge is crowded or misdirected.

        Turning about a vertex is a partial permutation of corners: cross the edge that comes in
        and stand at the next face's corner. Doubling the turn finds every orbit's lowest corner
        in as many steps as the largest fan has binary digits.
        """
        corners = np.arange(self.faces.size)
        twin = corners.copy()
        edges = self.edges
        at = edges.start[edges.uses == 2]
        one, other = edges.halfedges[at], edges.halfedges[at + 1]
        twin[one], twin[other] = other, one
        # The half-edge that comes into corner 3f + c is 3f + (c + 2) % 3; its twin leaves the
        # same vertex. At a boundary there is no twin and the fan ends: stay, and mark it by -1.
        before = np.roll(corners.reshape(-1, 3), 1, axis=1).reshape(-1)
        ends = twin[before] == before
        turn = np.where(ends, corners, twin[before])
        lowest = np.where(ends, -1, corners)
        while True:
            lower = np.minimum(lowest, lowest[turn])
            if np.array_equal(lower, lowest):
                return np.flatnonzero(ends | (lowest == corners))
            lowest, turn = lower, turn[turn]

    def _fans_by_linking(self) -> Integers:
        """One corner of each fan, on any mesh: the components of corners linked across edges."""
        edges = self.edges
        same = np.ones(len(edges.halfedges), bool)
        same[edges.start] = False
        later = np.flatnonzero(same)
        one, other = edges.halfedges[later - 1], edges.halfedges[later]
        tail = self.faces.reshape(-1)
        following = np.roll(np.arange(self.faces.size).reshape(-1, 3), -1, axis=1).reshape(-1)
        # Two half-edges of one edge link their corners at its lower and at its higher end.
        links = []
        for end in (0, 1):
            place = [
                np.where((tail[h] < tail[following[h]]) == (end == 0), h, following[h])
                for h in (one, other)
            ]
            links.append(np.stack(place))
        pairs = np.concatenate(links, axis=1)
        _, fan = components_of(self.faces.size, pairs)
        return np.unique(fan, return_index=True)[1]

    @cached_property
    def components(self) -> int:
        """Number of connected pieces, faces joined by shared vertices."""
        count, _ = components_of(len(self.points), self.edges.ends.T)
        return count - int((~self.used).sum())

    @cached_property
    def euler(self) -> int:
        """V - E + F; two for each closed sphere."""
        return int(self.used.sum()) - len(self.edges.ends) + len(self.faces)

    @cached_property
    def boundary_loops(self) -> int:
        """Number of connected pieces of the boundary."""
        count, _ = components_of(len(self.points), self.open_edges.T)
        return count - (len(self.points) - len(np.unique(self.open_edges)))

    @cached_property
    def normals(self) -> Floats:
        """(F, 3) right-hand normals, as long as twice the face's area."""
        a, b, c = (self.points[self.faces[:, k]] for k in range(3))
        normal: Floats = np.cross(b - a, c - a)
        return normal

    @cached_property
    def area(self) -> float:
        """The sum of the faces' areas."""
        return float(np.linalg.norm(self.normals, axis=1).sum() / 2)

    @cached_property
    def volume(self) -> float:
        """The volume inside a closed surface whose normals point outwards (divergence theorem)."""
        return float((self.points[self.faces[:, 0]] * self.normals).sum() / 6)

    @cached_property
    def flat_faces(self) -> Integers:
        """Faces without area."""
        return np.flatnonzero(~self.normals.any(axis=1))


def components_of(nodes: int, pairs: Integers) -> tuple[int, Integers]:
    """Number of components of the graph with these (2, n) pairs, and each node's component."""
    weights = np.ones(pairs.shape[1], np.int8)
    graph = coo_array((weights, (pairs[0], pairs[1])), shape=(nodes, nodes))
    count, label = connected_components(graph, directed=False)
    return int(count), np.asarray(label, np.int64)


def _sorted_pairs(low: Integers, high: Integers, vertices: int) -> tuple[Integers, Integers]:
    """The pairs as single numbers, sorted, and the half-edge of each.

    Pair and half-edge share one 63-bit key where they fit, so that one plain sort does both.
    """
    v, h = max(vertices - 1, 1).bit_length(), max(len(low) - 1, 1).bit_length()
    pair = low << v | high
    if 2 * v + h > 63:
        order = np.argsort(pair, kind="stable")
        return pair[order], order
    key = pair << h | np.arange(len(low))
    key.sort()
    return key >> h, key & ((1 << h) - 1)
