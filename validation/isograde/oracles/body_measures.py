"""What a mesh measures, beside a known body: pieces, holes, volumes, places and distances.

Vertices (V, n) are float64 in index coordinates, simplices (S, k+1) int64; vertices that count as
one have one number: the caller has welded a soup. Simplices that repeat a vertex are left out of
the topology, and so is the second of two with the same vertices.

Glossary
--------
sheet     simplices joined through facets that just two of them share
b1        first Betti number over Z/2: independent loops that bound nothing; for k <= 2
shells    the k-th: independent sets of simplices that meet every facet an even number of times.
          A closed manifold has one in each piece, a mesh with a missing patch has none there.

A k-cycle takes a whole sheet or none of it, so the k-cycles are the kernel of a small matrix over
Z/2: sheets against the facets that one, three or more simplices share. For k = 2 the rank of the
boundary of triangles follows, F - shells, and b1 = E - V + pieces - (F - shells).

References
----------
1. H. Edelsbrunner, J. Harer: Computational Topology, 2010, section IV.2 (Betti numbers as ranks
   of boundary matrices).
2. C. Ericson: Real-Time Collision Detection, 2005, section 5.1 (the nearest point of a simplex
   lies in the interior of one of its faces).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from math import factorial
from typing import Any

import numpy as np
from isoref.field import Booleans, Floats, Integers

from isograde.oracles.bodies import Body, Bounds

POINTS = 2000
"""About how many points of a body are held against a mesh."""


@dataclass(frozen=True, eq=False)
class Measures:
    """A mesh in numbers, in cells.

    pieces, shells : see above; 0 for an empty mesh
    b1 : None where k > 2
    measure : k-dimensional volume; the number of points where k = 0
    volume : enclosed, with the sign of the orientation, of a body with one
    centroid : of the enclosed set of a body with a volume, else of the mesh; NaN where empty
    mean : of a body with a volume |difference of volume| over the area, else the mean distance
    to_body, to_mesh : the largest distances, mesh to body and body to mesh; infinite where empty
    degree : how often the mesh covers the body, with sign; without sign where k = 0
    """

    pieces: int
    shells: int
    b1: int | None
    measure: float
    volume: float | None
    centroid: Floats
    mean: float
    to_body: float
    to_mesh: float
    degree: float


def measures(vertices: Floats, simplices: Integers, body: Body) -> Measures:
    """The numbers of a mesh whose answer is `body`."""
    sizes, volume = simplex_measures(vertices, simplices), None
    total = float(sizes.sum())
    if not len(simplices):
        nowhere = np.full(body.n, np.nan)
        infinite = float("inf")
        return Measures(0, 0, 0, 0.0, 0.0, nowhere, infinite, infinite, infinite, 0.0)
    inner = middles(vertices, simplices)
    away = body.distance(inner.reshape(-1, body.n)).reshape(inner.shape[:2])
    at_corners = body.distance(vertices[np.unique(simplices)])
    if body.volume is not None:
        volume, centroid = enclosed(vertices, simplices)
        mean = abs(volume - (body.volume or 0.0)) / total if total else float("inf")
    else:
        shares = sizes / total if total else np.full(len(sizes), 1 / len(sizes))
        centroid = np.asarray(shares @ vertices[simplices].mean(axis=1))
        mean = float(shares @ away[:, -1])
    return Measures(
        pieces(simplices),
        shells(simplices),
        first_betti(simplices),
        total,
        volume,
        centroid,
        mean,
        float(max(away.max(), at_corners.max())),
        farthest(body.points(POINTS), vertices, simplices),
        degree(vertices, simplices, body),
    )


def disagreements(
    found: Measures, body: Body, allowed: Bounds
) -> Mapping[str, tuple[float, float]]:
    """Each number that is not the body's: what was found, and what is right or allowed at most."""
    wrong: dict[str, tuple[float, float]] = {}
    for name, right in (("pieces", body.pieces), ("shells", body.pieces), ("b1", body.b1)):
        number = getattr(found, name)
        if number is not None and number != right:
            wrong[name] = (number, right)
    shift = float(np.linalg.norm(found.centroid - body.centroid))
    for name, number, most in (
        ("mean", found.mean, allowed.mean),
        ("to_body", found.to_body, allowed.largest),
        ("to_mesh", found.to_mesh, allowed.largest),
        ("centroid", shift, allowed.centroid),
        ("degree", abs(found.degree - 1), 0.5),
    ):
        # A number that is none is not within its bound.
        if not number <= most:
            wrong[name] = (number, most)
    return wrong


# -- topology --------------------------------------------------------------------------------------


def distinct(simplices: Integers) -> Integers:
    """The simplices as sets of vertices, each once, without those that repeat a vertex."""
    rows = np.sort(simplices, axis=1)
    rows = rows[(np.diff(rows, axis=1) != 0).all(axis=1)]
    _, first, _ = _named(rows)
    return np.asarray(rows[first])


def _named(rows: Integers) -> tuple[Integers, Integers, Integers]:
    """A number for each row, the same for equal ones; where each first stands; how often."""
    order = np.lexsort(rows.T)
    new = np.ones(len(rows), bool)
    new[1:] = (np.diff(rows[order], axis=0) != 0).any(axis=1)
    name = np.empty(len(rows), np.int64)
    name[order] = np.cumsum(new) - 1
    return name, order[new], np.bincount(name, minlength=int(new.sum()))


def pieces(simplices: Integers) -> int:
    """The number of connected components."""
    used, numbers = np.unique(simplices, return_inverse=True)
    numbers = numbers.reshape(simplices.shape)
    return len(np.unique(_components(len(used), numbers[:, :-1].ravel(), numbers[:, 1:].ravel())))


def shells(simplices: Integers) -> int:
    """The k-th Betti number over Z/2: for points their number."""
    rows = distinct(simplices)
    k = rows.shape[1] - 1
    if k == 0:
        return len(rows)
    if not len(rows):
        return 0
    # Find who owns each facet.
    facets = np.concatenate([np.delete(rows, i, axis=1) for i in range(k + 1)])
    owner = np.tile(np.arange(len(rows)), k + 1)
    name, _, uses = _named(facets)
    order = np.argsort(name, kind="stable")
    start = np.cumsum(uses) - uses
    # Join the two owners of a facet to sheets.
    two = start[uses == 2]
    sheet = _components(len(rows), owner[order[two]], owner[order[two + 1]])
    # Count the sets of sheets that meet each of the other facets an even number of times.
    others = [
        sheet[owner[order[first : first + count]]]
        for first, count in zip(start[uses != 2], uses[uses != 2], strict=True)
    ]
    return len(np.unique(sheet)) - rank(others)


def rank(rows: list[Integers]) -> int:
    """The rank over Z/2 of a matrix; each row as the columns of its ones, repeated ones cancel."""
    pivots: dict[int, int] = {}
    for columns in {tuple(sorted(row.tolist())) for row in rows}:
        bits = 0
        for column in columns:
            bits ^= 1 << column
        while bits and (top := bits.bit_length()) in pivots:
            bits ^= pivots[top]
        if bits:
            pivots[bits.bit_length()] = bits
    return len(pivots)


def first_betti(simplices: Integers) -> int | None:
    """b1 over Z/2 for points, curves and surfaces; None beyond."""
    k = simplices.shape[1] - 1
    if k == 0:
        return 0
    if k > 2:
        return None
    pairs = [simplices[:, [i, j]] for i, j in combinations(range(k + 1), 2)]
    edges = distinct(np.concatenate(pairs))
    loops = len(edges) - len(np.unique(simplices)) + pieces(simplices)
    return loops if k == 1 else loops - (len(distinct(simplices)) - shells(simplices))


def _components(count: int, one: Integers, other: Integers) -> Integers:
    """(count,) the component of each of `count` things, of which these pairs are joined."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    joined = coo_array((np.ones(len(one), np.int8), (one, other)), shape=(count, count))
    return np.asarray(connected_components(joined, directed=False)[1], np.int64)


# -- volumes and places ----------------------------------------------------------------------------


def simplex_measures(vertices: Floats, simplices: Integers) -> Floats:
    """(S,) the k-dimensional volumes: sqrt(det(T T')) / k! of the edges T from a vertex."""
    edges = np.diff(vertices[simplices], axis=1)
    gram = edges @ edges.transpose(0, 2, 1)
    k = edges.shape[1]
    return np.asarray(np.sqrt(np.maximum(np.linalg.det(gram), 0.0)) / factorial(k))


def enclosed(vertices: Floats, simplices: Integers) -> tuple[float, Floats]:
    """The signed volume inside a hypersurface, and its centroid: cones from one point added up."""
    n = vertices.shape[1]
    middle = vertices[simplices].reshape(-1, n).mean(axis=0)
    corners = vertices[simplices] - middle
    cones = np.linalg.det(corners) / factorial(n)
    volume = float(cones.sum())
    if not volume:
        return 0.0, np.full(n, np.nan)
    return volume, np.asarray(middle + cones @ corners.sum(axis=1) / (n + 1) / volume)


def middles(vertices: Floats, simplices: Integers) -> Floats:
    """(S, Q, n) the middles of the edges of each simplex, and last its centroid."""
    corners = vertices[simplices]
    edges = [
        (corners[:, i] + corners[:, j]) / 2 for i, j in combinations(range(corners.shape[1]), 2)
    ]
    return np.stack([*edges, corners.mean(axis=1)], axis=1)


def degree(vertices: Floats, simplices: Integers, body: Body) -> float:
    """How often the mesh covers the body: the sum of det(-g, t) / k! over the body's measure."""
    corners = vertices[simplices]
    k = simplices.shape[1] - 1
    if k == 0:
        return len(simplices) / body.measure
    frame = np.concatenate(
        [-body.gradients(corners.mean(axis=1)), np.diff(corners, axis=1)], axis=1
    )
    return float(np.linalg.det(frame).sum() / factorial(k) / body.measure)


# -- distances -------------------------------------------------------------------------------------


def farthest(points: Floats, vertices: Floats, simplices: Integers) -> float:
    """The largest distance of a point from the mesh.

    A few simplices give each point an upper bound; points are made exact in the order of their
    bounds, until the next bound is no larger than what was found.
    """
    search = Search.of(vertices, simplices)
    most = search.few(points)
    order, found = np.argsort(-most), 0.0
    for start in range(0, len(points), BATCH):
        batch = order[start : start + BATCH]
        if most[batch[0]] <= found:
            break
        found = max(found, float(search.distances(points[batch]).max()))
    return found


FEW, BATCH = 8, 32


@dataclass(frozen=True, eq=False)
class Search:
    """The nearest simplices to points, by their centroids.

    largest : the largest radius of a simplex about its centroid
    """

    corners: Floats
    tree: Any
    largest: float

    @classmethod
    def of(cls, vertices: Floats, simplices: Integers) -> Search:
        """The search in a mesh that has simplices."""
        from scipy.spatial import cKDTree

        corners = vertices[simplices]
        centroids = corners.mean(axis=1)
        radius = np.linalg.norm(corners - centroids[:, None], axis=2).max()
        return cls(corners, cKDTree(centroids), float(radius))

    def few(self, points: Floats) -> Floats:
        """(P,) an upper bound of the distance of each point from the mesh."""
        return self._nearest(points, min(FEW, len(self.corners)))[0]

    def distances(self, points: Floats) -> Floats:
        """(P,) the distance of each point from the nearest simplex.

        A simplex is no nearer than its centroid less the largest radius: candidates are taken in
        the order of their centroids until no other can be nearer.
        """
        found, open_, count = np.full(len(points), np.inf), np.arange(len(points)), FEW
        while len(open_):
            count = min(count, len(self.corners))
            found[open_], last = self._nearest(points[open_], count)
            if count == len(self.corners):
                break
            open_ = open_[last - self.largest < found[open_]]
            count *= 4
        return found

    def _nearest(self, points: Floats, count: int) -> tuple[Floats, Floats]:
        """The least distance from the `count` nearest by centroid, and the last centroid's."""
        away, near = self.tree.query(points, k=count)
        repeated = np.repeat(points, count, axis=0)
        each = to_simplices(repeated, self.corners[np.ravel(near)])
        least = each.reshape(len(points), count).min(axis=1)
        return np.asarray(least), np.reshape(away, (len(points), count))[:, -1]


def to_simplices(points: Floats, corners: Floats) -> Floats:
    """(P,) the distance of each point (P, n) from its own simplex (P, k+1, n).

    The nearest point lies inside one of the faces, and there it is the foot on the face's flat; a
    face without extent is left to its own faces.

    >>> to_simplices(np.array([[0.0, 2.0]]), np.array([[[-1.0, 0.0], [1.0, 0.0]]])).tolist()
    [2.0]
    """
    size = corners.shape[1]
    squared = ((points[:, None] - corners) ** 2).sum(axis=2).min(axis=1)
    for d in range(2, size + 1):
        for face in combinations(range(size), d):
            inside, foot = _foot(points, corners[:, face])
            nearer = ((points - foot) ** 2).sum(axis=1)
            squared = np.where(inside, np.minimum(squared, nearer), squared)
    return np.asarray(np.sqrt(squared))


def _foot(points: Floats, corners: Floats) -> tuple[Booleans, Floats]:
    """Where the foot of each point on the flat of its face is inside the face, and that foot."""
    edges = corners[:, 1:] - corners[:, :1]
    gram = edges @ edges.transpose(0, 2, 1)
    scale = np.maximum(np.einsum("pii->p", gram), np.finfo(float).tiny)
    solid = np.linalg.det(gram / scale[:, None, None]) > 1e-14
    gram = np.where(solid[:, None, None], gram, np.eye(edges.shape[1]))
    right = np.einsum("pen,pn->pe", edges, points - corners[:, 0])
    weights = np.linalg.solve(gram, right[..., None])[..., 0]
    inside = solid & (weights >= 0).all(axis=1) & (weights.sum(axis=1) <= 1)
    return inside, corners[:, 0] + np.einsum("pe,pen->pn", weights, edges)
