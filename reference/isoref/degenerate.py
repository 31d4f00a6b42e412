r"""Degenerate triangles: those without area, removed where that does no harm.

Where samples equal the isovalue, crossings of several lattice edges stand at one sample. The mesh
is as good a manifold as ever, by its indices, but some of its triangles have no area: two corners
at one place, or three on a line. Renderers do not mind; solvers and printers may. To remove them is
a step of its own, since it can cost what the extraction has proven:

    collapse    an edge of length 0 becomes one vertex, and the triangles on it go. Allowed where
                the *link condition* holds [1]: the two ends have no common neighbours but the
                corners opposite the edge, and no common opposite edges. Then the surface is the
                same manifold as before. Elsewhere it would be pinched or folded::

                      a                     a
                     / \                    |
                    u---v       ->          u          only a and b are joined to both u and v
                     \ /                    |
                      b                     b

    flip        a triangle whose corners lie on a line shares its longest edge with another; the two
                triangles are cut along the other diagonal, unless that edge exists already. The
                same points are covered.

    vanish      a piece of the surface all of whose corners stand at one place, as round a lone
                sample that equals the isovalue, goes as a whole.

What cannot be removed so is left, and counted. With ``manifold=False`` vertices at one place become
one whatever comes of it; the report says what came of it.

Glossary
--------
u, v        ends of an edge that is to be collapsed; v becomes u
apex        of an edge: the third corner of a triangle on it
crowded     of an edge: more than two triangles share it
pinched     of a vertex: its triangles form more than one fan
height      of a triangle: over its longest edge; no height is one that rounding could have made

References
----------
[1] T. K. Dey, H. Edelsbrunner, S. Guha, D. V. Nekhayev, "Topology preserving edge contraction",
    Publications de l'Institut Mathematique 66, 1999.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from isoref.attributes import only, regions
from isoref.field import Booleans, FieldError, Integers
from isoref.mesh import Mesh

Triangle = tuple[int, int, int]


@dataclass(frozen=True)
class State:
    """How good a manifold a mesh of triangles is.

    degenerate : triangles without area
    boundary : edges of one triangle
    crowded : edges of more than two triangles
    pinched : vertices whose triangles form several fans
    euler : vertices minus edges plus triangles, of the vertices that are used
    """

    degenerate: int
    boundary: int
    crowded: int
    pinched: int
    euler: int


@dataclass(frozen=True, eq=False)
class Removal:
    """A mesh without degenerate triangles, and what was done to get it.

    kept : for each vertex of it, which vertex of the given mesh that was
    collapsed, flipped, vanished : how many edges, pairs of triangles and pieces
    before, after : the state of the mesh
    """

    mesh: Mesh
    kept: Integers
    collapsed: int
    flipped: int
    vanished: int
    before: State
    after: State

    @property
    def keeps_manifold(self) -> bool:
        """Whether no edge became crowded, none a boundary, and no vertex pinched."""
        before, after = self.before, self.after
        return (
            after.crowded <= before.crowded
            and after.pinched <= before.pinched
            and after.boundary <= before.boundary
        )


def without_degenerate(mesh: Mesh, *, manifold: bool = True) -> Removal:
    """The mesh with degenerate triangles removed; its remaining vertices stand where they stood.

    Parameters
    ----------
    mesh : of triangles; its provenance is not kept
    manifold : remove only what can be removed without harm; else make one vertex of all at one
        place, and drop every triangle that has lost a corner by it

    Raises
    ------
    FieldError
        for a mesh of other simplices.

    >>> flat = Mesh.of([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 1, 0]], [[0, 1, 2], [1, 3, 2]])
    >>> removal = without_degenerate(flat)
    >>> removal.mesh, removal.collapsed, removal.after.degenerate
    (Mesh(3 vertices in R^3, 1 simplices of dimension 2), 1, 0)
    """
    if mesh.dimension != 2:
        raise FieldError(f"simplices of dimension {mesh.dimension} are no triangles")
    before = state(mesh)
    bare = Mesh(mesh.vertices, mesh.simplices)
    if not manifold:
        rows = _welded(bare)
        gone = len(np.unique(mesh.simplices)) - len(np.unique(rows))
        return _removal(bare, rows, gone, 0, 0, before)
    extended, vanished = _extended(bare)
    surgery = _Surgery(Mesh(mesh.vertices, mesh.simplices[extended]))
    collapsed, flipped = surgery.run()
    return _removal(bare, surgery.rows(), collapsed, flipped, vanished, before)


def _removal(
    mesh: Mesh, rows: Integers, collapsed: int, flipped: int, vanished: int, before: State
) -> Removal:
    """What was done, with the mesh of these triangles on the vertices that they use."""
    left = Mesh(mesh.vertices, rows)
    left = only(left, np.ones(len(rows), np.bool_))
    return Removal(left, np.unique(rows), collapsed, flipped, vanished, before, state(left))


def state(mesh: Mesh) -> State:
    """How good a manifold a mesh of triangles is."""
    triangles = mesh.simplices.astype(np.int64)
    unique, counts = np.unique(sides(triangles), axis=0, return_counts=True)
    used = len(np.unique(triangles))
    return State(
        degenerate=int(degenerate(mesh).sum()),
        boundary=int((counts == 1).sum()),
        crowded=int((counts > 2).sum()),
        pinched=int(fans(triangles, len(mesh.vertices)).sum()) - used,
        euler=used - len(unique) + len(triangles),
    )


def sides(triangles: Integers) -> Integers:
    """(3 S, 2) the edges of each triangle (S, 3), the lower number first.

    >>> sides(np.array([[4, 2, 7]])).tolist()
    [[2, 4], [2, 7], [4, 7]]
    """
    return np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)


def three_corners(triangles: Integers) -> Booleans:
    """(S,) which triangles have three corners.

    >>> three_corners(np.array([[4, 2, 7], [4, 2, 4]])).tolist()
    [True, False]
    """
    a, b, c = triangles.T
    return np.asarray((a != b) & (b != c) & (c != a))


def crowded_edges(triangles: Integers) -> Integers:
    """(E, 2) the edges that more than two of the triangles share.

    >>> crowded_edges(np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]])).tolist()
    [[0, 1]]
    """
    unique, counts = np.unique(sides(triangles), axis=0, return_counts=True)
    return np.asarray(unique[counts > 2])


def fans(triangles: Integers, vertices: int) -> Integers:
    """(vertices,) how many fans the triangles (S, 3) form at each: corners joined by edges.

    >>> fans(np.array([[0, 1, 2], [0, 2, 3], [0, 4, 5]]), 6).tolist()
    [2, 1, 1, 1, 1, 1]
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    if not len(triangles):
        return np.zeros(vertices, np.int64)
    # Two corners at one vertex are joined where their triangles share an edge that ends there.
    corner = np.arange(triangles.size).reshape(-1, 3)
    here, there = triangles.ravel(), np.stack([np.roll(triangles, s, axis=1) for s in (1, -1)])
    keys = np.stack([np.tile(here, 2), there.reshape(2, -1).ravel()])
    owner = np.tile(corner.ravel(), 2)
    order = np.lexsort(keys)
    same = (np.diff(keys[:, order], axis=1) == 0).all(axis=0)
    joined = order[:-1][same], order[1:][same]
    graph = coo_array(
        (np.ones(len(joined[0])), (owner[joined[0]], owner[joined[1]])),
        shape=(triangles.size, triangles.size),
    )
    fan = connected_components(graph, directed=False)[1]
    _, first = np.unique(fan, return_index=True)
    return np.bincount(here[first], minlength=vertices)


def degenerate(mesh: Mesh) -> Booleans:
    """(S,) which triangles have no area: no height that could not be rounding."""
    corners = mesh.vertices[mesh.simplices].astype(np.float64)
    if not len(corners):
        return np.zeros(0, np.bool_)
    sides = np.roll(corners, -1, axis=1) - corners
    longest = np.linalg.norm(sides, axis=2).max(axis=1)
    doubled = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    step = np.finfo(mesh.vertices.dtype).eps * np.abs(mesh.vertices).max()
    return np.asarray(doubled <= 4 * step * longest)


def _welded(mesh: Mesh) -> Integers:
    """The triangles that keep three corners where vertices at one place are the first of them."""
    _, first, number = np.unique(mesh.vertices, axis=0, return_index=True, return_inverse=True)
    rows = first[number.reshape(-1)][mesh.simplices].astype(mesh.simplices.dtype)
    return np.asarray(rows[three_corners(rows)])


def _extended(mesh: Mesh) -> tuple[Booleans, int]:
    """Which triangles belong to pieces that are no points, and how many pieces are."""
    if not len(mesh.simplices):
        return np.zeros(0, np.bool_), 0
    number = regions(mesh)
    sides = mesh.vertices[mesh.simplices] - mesh.vertices[mesh.simplices][:, [1, 2, 0]]
    flat = (sides == 0).all(axis=(1, 2))
    extended = np.bincount(number, ~flat) > 0
    return extended[number], int((~extended).sum())


class _Surgery:
    """A mesh that can be cut: triangles by number, and for each vertex the triangles round it."""

    def __init__(self, mesh: Mesh) -> None:
        self.vertices = mesh.vertices
        self.whole = mesh.simplices.dtype
        self.triangles: list[Triangle | None] = [(a, b, c) for a, b, c in mesh.simplices.tolist()]
        self.round: defaultdict[int, set[int]] = defaultdict(set)
        for number, triangle in enumerate(mesh.simplices.tolist()):
            for v in triangle:
                self.round[v].add(number)
        self.flat = set(np.flatnonzero(degenerate(mesh)).tolist())

    def rows(self) -> Integers:
        """(T, 3) the triangles that are left."""
        left = [triangle for triangle in self.triangles if triangle is not None]
        return np.array(left, self.whole).reshape(-1, 3)

    def run(self) -> tuple[int, int]:
        """Collapse what can be collapsed, then flip once; how often each was done."""
        collapsed = 0
        waiting = deque(sorted(self.flat))
        while waiting:
            u = self._collapse_in(waiting.popleft())
            if u is not None:
                collapsed += 1
                # What could not be done before may now be possible, near by.
                near = set().union(*(self.round[w] for w in {u} | self._neighbours(u)))
                waiting.extend(sorted(near & self.flat))
        return collapsed, sum(self._flip_at(number) for number in sorted(self.flat))

    def _collapse_in(self, number: int) -> int | None:
        """The vertex that an edge of length 0 of this triangle was collapsed to, if one was."""
        triangle = self.triangles[number]
        for u, v in _sides(triangle) if triangle is not None else ():
            if np.array_equal(self.vertices[u], self.vertices[v]) and self._may_collapse(u, v):
                self._collapse(u, v)
                return u
        return None

    def _may_collapse(self, u: int, v: int) -> bool:
        """The link condition, at the boundary too."""
        on_edge = self.round[u] & self.round[v]
        apexes = {w for n in on_edge for w in self._corners(n)} - {u, v}
        if len(on_edge) > 2 or len(apexes) != len(on_edge):
            return False
        if self._neighbours(u) & self._neighbours(v) != apexes:
            return False
        if self._opposite(u) & self._opposite(v):
            return False
        # An edge between two boundary vertices must itself be boundary.
        return len(on_edge) == 1 or not (self._on_boundary(u) and self._on_boundary(v))

    def _collapse(self, u: int, v: int) -> None:
        """V becomes u."""
        for number in self.round[u] & self.round[v]:
            for w in self._corners(number):
                self.round[w].discard(number)
            self.triangles[number] = None
            self.flat.discard(number)
        for number in self.round.pop(v, set()):
            a, b, c = (u if w == v else w for w in self._corners(number))
            self.triangles[number] = (a, b, c)
            self.round[u].add(number)

    def _flip_at(self, number: int) -> int:
        """1 where the longest edge of this triangle on a line was flipped away, else 0."""
        triangle = self.triangles[number]
        if triangle is None or not self._is_flat(triangle):
            return 0
        a, b, c = max(
            (triangle, triangle[1:] + triangle[:1], triangle[2:] + triangle[:2]),
            key=lambda t: float(np.linalg.norm(self.vertices[t[0]] - self.vertices[t[1]])),
        )
        others = (self.round[a] & self.round[b]) - {number}
        if len(others) != 1 or any(
            np.array_equal(self.vertices[p], self.vertices[q]) for p, q in _sides(triangle)
        ):
            return 0
        (other,) = others
        (d,) = set(self._corners(other)) - {a, b}
        if d == c or self.round[c] & self.round[d]:
            return 0
        # Cut a, d, b, c along c d; leave it where nothing would be gained.
        if self._is_flat((a, d, c)) or self._is_flat((d, b, c)):
            return 0
        self._replace(number, (a, d, c))
        self._replace(other, (d, b, c))
        return 1

    def _replace(self, number: int, triangle: Triangle) -> None:
        """Another triangle stands under this number."""
        for w in self._corners(number):
            self.round[w].discard(number)
        self.triangles[number] = triangle
        for w in triangle:
            self.round[w].add(number)

    def _corners(self, number: int) -> Triangle:
        """The corners of a triangle that is there."""
        triangle = self.triangles[number]
        assert triangle is not None
        return triangle

    def _neighbours(self, v: int) -> set[int]:
        """The vertices that share a triangle with this one."""
        return {w for n in self.round[v] for w in self._corners(n)} - {v}

    def _opposite(self, v: int) -> set[frozenset[int]]:
        """The edges opposite a vertex in its triangles."""
        return {frozenset(self._corners(n)) - {v} for n in self.round[v]}

    def _on_boundary(self, v: int) -> bool:
        """Whether an edge of one triangle ends here."""
        return any(len(self.round[v] & self.round[w]) == 1 for w in self._neighbours(v))

    def _is_flat(self, triangle: Triangle) -> bool:
        """Whether a triangle has no area."""
        one = Mesh(self.vertices[list(triangle)], np.array([[0, 1, 2]]))
        return bool(degenerate(one)[0])


def _sides(triangle: Triangle) -> Iterator[tuple[int, int]]:
    """The three sides, in order."""
    a, b, c = triangle
    yield from ((a, b), (b, c), (c, a))
