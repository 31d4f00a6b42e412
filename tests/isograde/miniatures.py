"""Small implementations to test the grader with: correct ones, and broken ones.

The grader is graded: for every claim there is a miniature that only this claim, and what follows
from it, catches; and every correct miniature passes everything, whatever its conventions and
legal choices.

All are made of one plain extractor, `extract`. Its parts can be exchanged: how an ambiguous face
is decided, where a crossing is put, how a polygon is cut into triangles. It has its own numbering,
by half steps: twice the index coordinates, so that a node on a lattice edge has one odd number.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from dataclasses import field as fresh
from functools import cache, partial
from itertools import product
from typing import Any

import numpy as np
from isograde.adapters.conventions import to_house
from isograde.declaration import Declaration, declaration_from
from isograde.model import Limits, Outcome, Request, Status
from isograde.oracles.rows import components_of
from isoref.field import Array, Field, Floats, Integers
from isoref.methods import METHODS
from scipy.spatial import ConvexHull

Place = tuple[int, int, int]
Answer = tuple[Any, Any]
Function = Callable[[Array, float, tuple[float, ...]], Answer]
# Whether an ambiguous face joins its inside corners, from its corner values in a ring, less the
# isovalue, its middle in half steps, and the number of the cell's inside corners.
Decide = Callable[[list[float], Place, int], bool]
Cut = Callable[[Sequence[Place]], list[Sequence[Place | None]]]

CORNERS: tuple[Place, ...] = tuple((a, b, c) for a in (0, 2) for b in (0, 2) for c in (0, 2))
# Corners of each face in a ring, counter-clockwise seen from outside the cell.
RINGS: dict[Place, tuple[Place, Place, Place, Place]] = {
    (0, 1, 1): ((0, 0, 0), (0, 0, 2), (0, 2, 2), (0, 2, 0)),
    (2, 1, 1): ((2, 0, 0), (2, 2, 0), (2, 2, 2), (2, 0, 2)),
    (1, 0, 1): ((0, 0, 0), (2, 0, 0), (2, 0, 2), (0, 0, 2)),
    (1, 2, 1): ((0, 2, 0), (0, 2, 2), (2, 2, 2), (2, 2, 0)),
    (1, 1, 0): ((0, 0, 0), (0, 2, 0), (2, 2, 0), (2, 0, 0)),
    (1, 1, 2): ((0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)),
}


def add(a: Place, b: Place) -> Place:
    """The sum of two places."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def middle(a: Place, b: Place) -> Place:
    """The place between two others."""
    return (a[0] + b[0]) // 2, (a[1] + b[1]) // 2, (a[2] + b[2]) // 2


# How an ambiguous face is decided: whether its inside corners are joined.


def apart(_ring: list[float], _place: Place, _count: int) -> bool:
    """Never."""
    return False


def together(_ring: list[float], _place: Place, _count: int) -> bool:
    """Always."""
    return True


def asymptotic(ring: list[float], _place: Place, _count: int) -> bool:
    """Where the bilinear interpolant's saddle is inside (Nielson & Hamann)."""
    a, b, c, d = ring
    inside = a * c - b * d
    return inside > 0 if a >= 0 else inside < 0


def by_mean(ring: list[float], _place: Place, _count: int) -> bool:
    """Where the mean of the four values is inside (VESTA's mixed mode)."""
    return sum(ring) >= 0


def by_axis(_ring: list[float], place: Place, _count: int) -> bool:
    """On faces across the last axis."""
    return place[2] % 2 == 0


def by_place(_ring: list[float], place: Place, _count: int) -> bool:
    """On every other face, like a chessboard."""
    return sum(x // 2 for x in place) % 2 == 0


def by_cell(_ring: list[float], _place: Place, count: int) -> bool:
    """In cells with more inside corners than outside ones: two answers for a face (1987)."""
    return count > 4


# How a polygon is cut into triangles; None stands for a new vertex in its middle.


def fan_from(polygon: Sequence[Place], start: int) -> list[Sequence[Place | None]]:
    """Triangles that all have one corner in common."""
    turned = [*polygon[start:], *polygon[:start]]
    return [(turned[0], turned[i], turned[i + 1]) for i in range(1, len(turned) - 1)]


def chords_in_faces(polygon: Sequence[Place], start: int) -> int:
    """How many chords of a fan lie in a face of the cell."""
    turned = [*polygon[start:], *polygon[:start]]
    return sum(
        any(p == q and p != 1 for p, q in zip(turned[0], end, strict=True)) for end in turned[2:-1]
    )


def star(polygon: Sequence[Place]) -> list[Sequence[Place | None]]:
    """Triangles round a new vertex."""
    return [(None, p, q) for p, q in zip(polygon, [*polygon[1:], polygon[0]], strict=True)]


def careful_fan(polygon: Sequence[Place]) -> list[Sequence[Place | None]]:
    """A fan without chords in faces, or a star where there is none."""
    for start in range(len(polygon)):
        if not chords_in_faces(polygon, start):
            return fan_from(polygon, start)
    return star(polygon)


def careless_fan(polygon: Sequence[Place]) -> list[Sequence[Place | None]]:
    """The fan with the most chords in faces."""
    return fan_from(polygon, max(range(len(polygon)), key=lambda s: chords_in_faces(polygon, s)))


@cache
def polygons(inside: tuple[bool, ...], joined: tuple[bool, ...]) -> tuple[tuple[Place, ...], ...]:
    """The cell's oriented polygons, from its corners' sides and its ambiguous faces' decisions."""
    side = dict(zip(CORNERS, inside, strict=True))
    following: dict[Place, Place] = {}
    for together_here, ring in zip(joined, RINGS.values(), strict=True):
        turn = [(i, middle(ring[i], ring[(i + 1) % 4])) for i in range(4)]
        enter = [i for i, _ in turn if not side[ring[i]] and side[ring[(i + 1) % 4]]]
        leave = [i for i, _ in turn if side[ring[i]] and not side[ring[(i + 1) % 4]]]
        for i in enter:
            # Go on to the next edge that leaves, or back to the one before.
            steps = (3, 2, 1) if together_here else (1, 2, 3)
            j = next((i + s) % 4 for s in steps if (i + s) % 4 in leave)
            following[turn[i][1]] = turn[j][1]
    found = []
    while following:
        start, at = following.popitem()
        polygon = [start]
        while at != start:
            polygon.append(at)
            at = following.pop(at)
        found.append(tuple(polygon))
    return tuple(found)


@dataclass(frozen=True)
class Parts:
    """The exchangeable parts of `extract`."""

    decide: Decide = apart
    cut: Cut = careful_fan
    tie_inside: bool = True
    midpoints: bool = False
    shared_middle: bool = False


def extract(
    values: Array, isovalue: float, spacing: tuple[float, ...], parts: Parts = Parts()
) -> Answer:
    """The isosurface as (vertices, faces), cell by cell; raises `ValueError` on bad input."""
    check(values, isovalue)
    level = values.astype(np.float64) - isovalue
    inside = level >= 0 if parts.tie_inside else level > 0
    points: list[list[float]] = []
    known: dict[Place, int] = {}
    faces: list[list[int]] = []
    for cell in product(*(range(n - 1) for n in values.shape)):
        origin = (2 * cell[0], 2 * cell[1], 2 * cell[2])
        corners = {c: sample(add(origin, c)) for c in CORNERS}
        sides = tuple(bool(inside[corners[c]]) for c in CORNERS)
        if len(set(sides)) == 1:
            continue
        joined = tuple(
            is_ambiguous([bool(inside[corners[c]]) for c in ring])
            and parts.decide(
                [float(level[corners[c]]) for c in ring], add(origin, face), sum(sides)
            )
            for face, ring in RINGS.items()
        )
        shared: int | None = None
        for polygon in polygons(sides, joined):
            ids = {p: vertex(add(origin, p), level, known, points, parts) for p in polygon}
            inner: int | None = shared
            for triangle in parts.cut(polygon):
                if None in triangle and inner is None:
                    inner = len(points)
                    points.append(np.mean([points[i] for i in ids.values()], axis=0).tolist())
                names = [inner if p is None else ids[p] for p in triangle]
                faces.append([name for name in names if name is not None])
            shared = inner if parts.shared_middle else None
    vertices = np.array(points, np.float64).reshape(-1, 3) * spacing
    return vertices, np.array(faces, np.int64).reshape(-1, 3)


def check(values: Array, isovalue: float) -> None:
    """Nothing, for a field of rank three with samples; else `ValueError`."""
    if values.ndim != 3 or not values.size:
        raise ValueError(f"samples of shape {values.shape} are no field of rank three")
    if not np.isfinite(values).all() or not np.isfinite(isovalue):
        raise ValueError("samples and isovalue must be finite")


def sample(place: Place) -> Place:
    """The index of the sample at a place."""
    return place[0] // 2, place[1] // 2, place[2] // 2


def is_ambiguous(ring: list[bool]) -> bool:
    """Opposite corners of the face are on one side, neighbours on different ones."""
    return ring[0] == ring[2] != ring[1] == ring[3]


def vertex(
    node: Place, level: Floats, known: dict[Place, int], points: list[list[float]], parts: Parts
) -> int:
    """The number of the vertex on this lattice edge."""
    if node not in known:
        axis = next(a for a in range(3) if node[a] % 2)
        low = sample(node)
        high = add(low, (int(axis == 0), int(axis == 1), int(axis == 2)))
        share = 0.5 if parts.midpoints else float(level[low] / (level[low] - level[high]))
        point = [float(x) for x in low]
        point[axis] += share
        known[node] = len(points)
        points.append(point)
    return known[node]


def made(**changes: Any) -> Function:
    """`extract` with these parts."""
    return partial(extract, parts=replace(Parts(), **changes))


plain = made()


@dataclass(frozen=True)
class Miniature:
    """An implementation with what is known of it.

    breaks : the claim that catches it, or nothing for a correct one
    follows : claims that may fail as a consequence
    says : what it declares beside its level, as JSON
    """

    name: str
    run: Function
    breaks: str = ""
    follows: tuple[str, ...] = ()
    says: Mapping[str, Any] = fresh(default_factory=dict)
    level: int = 2

    @property
    def declaration(self) -> Declaration:
        """What it declares."""
        return declaration_from({**self.says, "level": self.level}, self.name)


class Inside:
    """An adapter to a miniature in this very process."""

    def __init__(self, miniature: Miniature) -> None:
        self.miniature = miniature

    def open(self, limits: Limits) -> Declaration:
        """What the miniature declares."""
        return self.miniature.declaration

    def run(self, request: Request) -> Outcome:
        """The outcome of one call, in the house's conventions; of calls in other ways, none."""
        if request.calls != "once":
            return Outcome(Status.DECLINED, detail="asked in the worker only")
        values = request.field.values.copy(order="K")
        values = np.lib.stride_tricks.as_strided(values, values.shape, values.strides)
        before = values.copy()
        try:
            vertices, faces = self.miniature.run(
                values, request.isovalues[0], request.field.spacing
            )
        except ValueError as error:
            outcome = Outcome(Status.RAISED, detail=str(error))
        else:
            changed = not np.array_equal(before, values, equal_nan=values.dtype.kind == "f")
            outcome = Outcome(Status.OK, vertices, faces, input_changed=changed)
        return to_house(outcome, request, self.miniature.declaration.conventions)

    def close(self) -> None:
        """Nothing to stop."""


# Broken in what they do to the right answer.

Change = Callable[[Floats, Integers], Answer]


def changed(change: Change, base: Function = plain) -> Function:
    """The right answer, changed in index coordinates where there is one."""

    def run(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
        vertices, faces = base(values, isovalue, (1.0, 1.0, 1.0))
        if len(faces):
            vertices, faces = change(vertices, faces)
        return vertices * np.asarray(spacing, vertices.dtype), faces

    return run


def with_nan(v: Floats, f: Integers) -> Answer:
    """The first vertex is nowhere."""
    v = v.copy()
    v[0, 0] = np.nan
    return v, f


def with_far_index(v: Floats, f: Integers) -> Answer:
    """A face more, which names the vertex after the last."""
    return v, np.concatenate([f, [[0, 1, len(v)]]])


def with_collapsed_face(v: Floats, f: Integers) -> Answer:
    """A face more, which names a vertex twice."""
    return v, np.concatenate([f, f[:1, [0, 0, 1]]])


def with_spare_vertex(v: Floats, f: Integers) -> Answer:
    """A vertex more, which nobody names."""
    return np.concatenate([v, v[:1]]), f


def with_purse(v: Floats, f: Integers) -> Answer:
    """A triangle inside a cell, there and back."""
    return _with_inner(v, f, np.array([[0, 1, 2], [2, 1, 0]]), 3)


def with_bubble(v: Floats, f: Integers) -> Answer:
    """A closed tetrahedron inside a cell."""
    return _with_inner(v, f, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]), 4)


def _with_inner(v: Floats, f: Integers, more: Integers, count: int) -> Answer:
    """Faces more on new vertices near the middle of the first triangle."""
    base = v[f[0]].mean(axis=0)
    shape = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])[:count]
    return np.concatenate([v, base + 0.001 * (shape + np.array([1, 2, 3]))]), np.concatenate(
        [f, more + len(v)]
    )


def with_flipped_face(v: Floats, f: Integers) -> Answer:
    """The first face turned over."""
    f = f.copy()
    f[0] = f[0, ::-1]
    return v, f


def with_bent_border(v: Floats, f: Integers) -> Answer:
    """A vertex more in the middle of every edge between cells."""
    edges: dict[tuple[int, int], int] = {}
    points, faces = list(v), []
    for face in f.tolist():
        ring: list[int] = []
        for a, b in zip(face, [*face[1:], face[0]], strict=True):
            ring.append(a)
            whole = np.isclose(v[a], v[b]) & np.isclose(v[a], np.rint(v[a]))
            if whole.any():
                key = (min(a, b), max(a, b))
                if key not in edges:
                    edges[key] = len(points)
                    points.append((v[a] + v[b]) / 2)
                ring.append(edges[key])
        start = next((i for i, p in enumerate(ring) if p >= len(v)), 0)
        ring = [*ring[start:], *ring[:start]]
        faces += [[ring[0], ring[i], ring[i + 1]] for i in range(1, len(ring) - 1)]
    return np.array(points), np.array(faces)


def with_flipped_diagonal(v: Floats, f: Integers) -> Answer:
    """An edge between two cells exchanged for the other diagonal of its two triangles."""
    for one in range(len(f)):
        for other in range(one + 1, len(f)):
            a, b = shared_edge(f[one], f[other])
            if a < 0 or not across_cells(v[f[one]], v[f[other]]):
                continue
            c = next(x for x in f[one] if x not in (a, b))
            d = next(x for x in f[other] if x not in (a, b))
            if any({c, d} <= set(face) for face in f.tolist()):
                continue
            f = f.copy()
            f[one], f[other] = (a, d, c), (d, b, c)
            return v, f
    return v, f


def shared_edge(one: Integers, other: Integers) -> tuple[int, int]:
    """The edge a→b of the first face that the second runs along from b to a, or -1, -1."""
    back = {(int(other[(i + 1) % 3]), int(other[i])) for i in range(3)}
    for i in range(3):
        edge = (int(one[i]), int(one[(i + 1) % 3]))
        if edge in back:
            return edge
    return -1, -1


def across_cells(one: Floats, other: Floats) -> bool:
    """The two triangles lie in different cells."""
    return bool((np.floor(one.mean(axis=0)) != np.floor(other.mean(axis=0))).any())


def turned_over(v: Floats, f: Integers) -> Answer:
    """Every face turned over."""
    return v, f[:, ::-1]


def soup(v: Floats, f: Integers) -> Answer:
    """Triangles that share no vertex."""
    return v[f].reshape(-1, 3), np.arange(f.size).reshape(-1, 3)


def as_quadrilaterals(v: Floats, f: Integers) -> Answer:
    """Faces of four corners."""
    return v, np.concatenate([f, f[:, :1]], axis=1)


def with_swapped_middles(v: Floats, f: Integers) -> Answer:
    """The two inner vertices of a cell that has two, exchanged."""
    v = v.copy()
    inner: dict[tuple[int, ...], list[int]] = {}
    for i in np.flatnonzero((v != np.rint(v)).all(axis=1)):
        inner.setdefault(tuple(np.floor(v[i]).astype(int).tolist()), []).append(int(i))
    for pair in inner.values():
        if len(pair) == 2:
            v[pair] = v[pair[::-1]]
    return v, f


def with_false_tunnel(v: Floats, f: Integers) -> Answer:
    """Two triangles of one cell that no triangles of it connect, exchanged for a band."""
    cells: dict[tuple[int, ...], list[int]] = {}
    for i, middle_of in enumerate(v[f].mean(axis=1)):
        cells.setdefault(tuple(np.floor(middle_of).astype(int).tolist()), []).append(i)
    for mine in cells.values():
        first = sheet_of(f, mine)
        rest = [i for i in mine if i not in first]
        if rest:
            a, b = f[mine[0]], f[rest[0]][::-1]
            turn = [(0, 1), (1, 2), (2, 0)]
            band = [(a[i], a[j], b[i]) for i, j in turn] + [(b[i], a[j], b[j]) for i, j in turn]
            return v, np.concatenate([np.delete(f, [mine[0], rest[0]], axis=0), band])
    return v, f


def sheet_of(f: Integers, cell: list[int]) -> set[int]:
    """The triangles of the cell that are connected to its first one."""
    found, corners = {cell[0]}, set(f[cell[0]].tolist())
    while more := {i for i in cell if i not in found and corners & set(f[i].tolist())}:
        found |= more
        corners |= {int(c) for i in more for c in f[i]}
    return found


def with_pinch(v: Floats, f: Integers) -> Answer:
    """A triangle there and back, between an edge and a vertex that is joined to neither end.

    Two faces more and two edges more: the Euler characteristic stays, but the edge has four faces.
    """
    edges = {frozenset((int(t[i]), int(t[(i + 1) % 3]))) for t in f for i in range(3)}
    for x in range(len(v)):
        for a, b in (tuple(edge) for edge in edges):
            apart_from_both = frozenset((x, a)) not in edges and frozenset((x, b)) not in edges
            one_cell = np.ptp(v[[a, b, x]], axis=0).max() <= 1
            if x not in (a, b) and apart_from_both and one_cell:
                return v, np.concatenate([f, [(a, b, x), (b, a, x)]])
    return v, f


# Broken in what they make of their input.


def raises_on_a_surface(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
    """No answer where there is something to answer."""
    vertices, faces = plain(values, isovalue, spacing)
    if len(faces):
        raise ValueError("something went wrong")
    return vertices, faces


def by_size(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
    """The polarity depends on how large the values are."""
    check(values, isovalue)
    large = float(values.max()) - float(values.min()) > 6
    return made(decide=together if large else apart)(values, isovalue, spacing)


def by_isovalue(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
    """The polarity depends on the isovalue."""
    return made(decide=together if isovalue > 0.9 else apart)(values, isovalue, spacing)


def without_specks(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
    """Inside samples without an inside neighbour are taken for noise."""
    check(values, isovalue)
    inside = np.pad(values >= isovalue, 1, mode="edge")
    beside = np.zeros_like(inside)
    for axis in range(3):
        beside |= np.roll(inside, 1, axis) | np.roll(inside, -1, axis)
    core = (slice(1, -1),) * 3
    speck = (inside & ~beside)[core]
    return plain(np.where(speck, isovalue - 1, values), isovalue, spacing)


def in_cubes(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
    """All three spacings are taken to be the first."""
    return plain(values, isovalue, (spacing[0],) * 3)


def reversed_axes(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
    """Vertices as (z, y, x), their normals still to lower values."""
    vertices, faces = plain(values, isovalue, spacing)
    return vertices[:, ::-1], faces[:, ::-1]


def in_memory_order(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
    """The samples are read as they lie in memory."""
    return plain(values.ravel(order="K").reshape(values.shape), isovalue, spacing)


def in_their_type(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
    """The isovalue is taken off in the type of the samples."""
    check(values, isovalue)
    with np.errstate(over="ignore"):
        return plain(values - values.dtype.type(isovalue), 0.0, spacing)


def in_place(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
    """The isovalue is taken off the caller's samples."""
    check(values, isovalue)
    if values.dtype.kind == "f":
        values -= isovalue
        return plain(values, 0.0, spacing)
    return plain(values, isovalue, spacing)


SHUFFLE = np.random.default_rng(0)


def shuffled(v: Floats, f: Integers) -> Answer:
    """The faces in an order that changes from call to call."""
    return v, SHUFFLE.permutation(f)


def forgives_nan(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
    """A sample that is not a number is taken for zero."""
    return plain(np.nan_to_num(values), isovalue, spacing)


def never_empty(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
    """A triangle where there should be nothing."""
    vertices, faces = plain(values, isovalue, spacing)
    return (vertices, faces) if len(faces) else (np.eye(3), np.array([[0, 1, 2]]))


def takes_anything(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
    """A plane of samples has no surface, so nothing is said."""
    if values.ndim != 3:
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    return plain(values, isovalue, spacing)


def without_touching(v: Floats, f: Integers) -> Answer:
    """Faces with a corner exactly on a sample are left out."""
    touches = (v == np.rint(v)).all(axis=1)
    return v, f[~touches[f].any(axis=1)]


def welded(v: Floats, f: Integers) -> Answer:
    """Vertices at one place made one, and what collapses left out: sheets meet at tied samples."""
    places, name = np.unique(v, axis=0, return_inverse=True)
    faces = name.reshape(-1)[f]
    kept = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    return places, faces[kept]


def trilinear(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
    """The reference with the topology of the trilinear interpolant: no plain twin is as short."""
    check(values, isovalue)
    if min(values.shape) < 2:
        return plain(values, isovalue, spacing)
    mesh = METHODS["trilinear-cubes"](Field.of(values.astype(np.float64), spacing), isovalue)
    return mesh.vertices, mesh.simplices


BY_PLACE = {"not_promised": ["symmetry.translation", "symmetry.orientation"]}
TO_HIGH = {"conventions": {"normals": "to_high"}}
TIES_FOLLOW = ("topology.ties",)
# What is added to a cell of the answer, or turned over in it, is so in another cell when the field
# is turned.
TURNED_FOLLOWS = ("symmetry.orientation",)
# Two holes at a lattice edge cut the faces round its vertex into two fans.
HOLES_FOLLOW = ("topology.manifold", *TIES_FOLLOW)

CORRECT = (
    Miniature("separates", plain),
    Miniature("joins", made(decide=together)),
    Miniature("asymptotic", made(decide=asymptotic), level=3),
    Miniature("trilinear", trilinear, level=4),
    Miniature("means", made(decide=by_mean)),
    Miniature("mixed", made(decide=by_mean), says={"promised": ["cells.mean"]}),
    Miniature("inner vertices", made(cut=star)),
    Miniature("joins, inner vertices", made(decide=together, cut=star)),
    Miniature("ties outside", made(tie_inside=False), says={"conventions": {"tie": "outside"}}),
    Miniature(
        "normals to high", changed(turned_over), says={"conventions": {"normals": "to_high"}}
    ),
    Miniature(
        "axes reversed",
        reversed_axes,
        says={"conventions": {"axes": "reversed"}},
    ),
    Miniature(
        "in samples",
        lambda values, isovalue, _: plain(values, isovalue, (1.0, 1.0, 1.0)),
        says={"conventions": {"units": "index"}},
    ),
    Miniature("forgives NaN", forgives_nan, says={"conventions": {"nan": "answers"}}),
    Miniature("soup", changed(soup), says={"mesh": {"soup": 0.0}}),
    Miniature("midpoints", made(midpoints=True), says={"interpolant": "labels"}),
    Miniature(
        "chessboard",
        made(decide=by_place),
        says=BY_PLACE,
    ),
    Miniature(
        "by axis",
        made(decide=by_axis),
        says=BY_PLACE,
    ),
    Miniature(
        "single precision",
        changed(lambda v, f: (v.astype(np.float32), f.astype(np.int32))),
    ),
    Miniature("unsigned faces", changed(lambda v, f: (v, f.astype(np.uint32)))),
)

BROKEN = (
    Miniature("raises", raises_on_a_surface, "structure.answers"),
    Miniature(
        "quadrilaterals",
        changed(as_quadrilaterals),
        "structure.shapes",
        ("structure.no_repeated_index",),
    ),
    Miniature("NaN vertex", changed(with_nan), "structure.finite"),
    Miniature("index too far", changed(with_far_index), "structure.in_range"),
    Miniature("collapsed face", changed(with_collapsed_face), "structure.no_repeated_index"),
    Miniature(
        "purse", changed(with_purse), "structure.no_duplicate", ("cells.count", *TURNED_FOLLOWS)
    ),
    Miniature("spare vertex", changed(with_spare_vertex), "structure.all_used"),
    Miniature("1987", made(decide=by_cell), "topology.closed", HOLES_FOLLOW),
    Miniature("soup undeclared", changed(soup), "topology.closed"),
    Miniature(
        "careless fan",
        made(decide=together, cut=careless_fan),
        "topology.manifold",
        ("structure.no_duplicate", "cells.legal"),
    ),
    Miniature(
        "shared middle",
        made(cut=star, shared_middle=True),
        "topology.manifold",
        ("cells.count",),
    ),
    Miniature(
        "flipped face",
        changed(with_flipped_face),
        "topology.oriented",
        ("topology.sides", *TIES_FOLLOW, *TURNED_FOLLOWS),
    ),
    Miniature(
        "no specks",
        without_specks,
        "topology.sides",
        ("cells.legal", *TIES_FOLLOW),
    ),
    Miniature("turned over", changed(turned_over), "topology.sides"),
    Miniature("fixed polarity", plain, "topology.bilinear", ("cells.frequencies",), level=3),
    Miniature(
        "face means",
        made(decide=by_mean),
        "topology.bilinear",
        ("cells.frequencies",),
        level=3,
    ),
    Miniature(
        "bent border",
        changed(with_bent_border),
        "geometry.vertices",
        ("cells.legal", "topology.bilinear"),
    ),
    Miniature("midpoints undeclared", made(midpoints=True), "geometry.crossing"),
    Miniature(
        "flipped diagonal",
        changed(with_flipped_diagonal),
        "cells.legal",
        ("symmetry.translation", "symmetry.orientation"),
    ),
    Miniature(
        "swapped middles",
        changed(with_swapped_middles, made(cut=star)),
        "geometry.embedded",
    ),
    Miniature("declared mixed", plain, "cells.mean", says={"promised": ["cells.mean"]}),
    Miniature("counted wrong", plain, "cells.frequencies", ("topology.bilinear",), level=3),
    Miniature(
        "bubble",
        changed(with_bubble),
        "cells.count",
        ("geometry.embedded", *TURNED_FOLLOWS),
    ),
    Miniature(
        "chessboard undeclared",
        made(decide=by_place),
        "symmetry.translation",
        ("symmetry.orientation",),
    ),
    Miniature("by size", by_size, "symmetry.scaling"),
    Miniature("by isovalue", by_isovalue, "symmetry.shift"),
    Miniature("by axis undeclared", made(decide=by_axis), "symmetry.orientation"),
    Miniature("in cubes", in_cubes, "symmetry.spacing"),
    Miniature("memory order", in_memory_order, "symmetry.layout"),
    Miniature("their type", in_their_type, "symmetry.type"),
    Miniature("in place", in_place, "robustness.input_unmodified", ("symmetry.type",)),
    Miniature("shuffled", changed(shuffled), "robustness.deterministic"),
    Miniature("NaN undeclared", forgives_nan, "robustness.nan"),
    Miniature("never empty", never_empty, "robustness.out_of_range"),
    Miniature("takes anything", takes_anything, "robustness.bad_input"),
    Miniature(
        "leaves ties out",
        changed(without_touching),
        "topology.ties",
        (
            "structure.all_used",
            "topology.closed",
            "topology.manifold",
            "topology.sides",
        ),
    ),
    Miniature("welded at ties", changed(welded), "topology.raw"),
    Miniature("missing tunnel", made(decide=asymptotic), "topology.trilinear", level=4),
    Miniature(
        "wrong face",
        plain,
        "topology.trilinear",
        ("topology.bilinear", "cells.frequencies"),
        level=4,
    ),
    Miniature(
        "false tunnel",
        changed(with_false_tunnel, trilinear),
        "topology.trilinear",
        ("geometry.embedded", "symmetry.translation", "symmetry.orientation"),
        level=4,
    ),
    Miniature(
        "non-manifold edge",
        changed(with_pinch, trilinear),
        "topology.trilinear",
        (
            "structure.no_duplicate",
            "topology.manifold",
            "topology.manifold",
            "geometry.embedded",
            "cells.legal",
            "cells.count",
            *TURNED_FOLLOWS,
        ),
        level=4,
    ),
)


# Broken in how far their errors shrink, on the row of spheres of `isograde.cases.accuracy`.


def accurate(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
    """The reference, since `extract` takes minutes for so large a field."""
    check(values, isovalue)
    mesh = METHODS["asymptotic-decider"](Field.of(values, spacing), isovalue)
    return mesh.vertices, mesh.simplices


def halved(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
    """Every crossing in the middle of its edge."""
    return accurate(np.where(values >= isovalue, 1.0, -1.0), 0.0, spacing)


def lowered(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
    """The isosurface of another value, half a spacing away."""
    return accurate(values, isovalue - 0.5, spacing)


def pieces_of(v: Floats, f: Integers) -> list[Integers]:
    """The vertices of each connected piece."""
    _, piece = components_of(len(v), np.concatenate([f[:, :2], f[:, 1:]]).T)
    return [np.flatnonzero(piece == p) for p in range(piece.max() + 1)]


def with_vertex_astray(v: Floats, f: Integers) -> Answer:
    """One vertex of every piece half a spacing too high."""
    v = v.copy()
    for piece in pieces_of(v, f):
        v[piece[v[piece, 2].argmax()], 2] += 0.5
    return v, f


def coarsened(v: Floats, f: Integers) -> Answer:
    """Of each piece only the six vertices that are farthest along an axis, and their hull."""
    faces = []
    for piece in pieces_of(v, f):
        ends = np.unique(piece[[*v[piece].argmin(axis=0), *v[piece].argmax(axis=0)]])
        faces.append(ends[ConvexHull(v[ends]).simplices])
    return v, np.concatenate(faces)


def in_three_layers(v: Floats, f: Integers) -> Answer:
    """Every face there, back and there again."""
    return v, np.concatenate([f, f[:, ::-1], f])


def half_turned(v: Floats, f: Integers) -> Answer:
    """The faces that look upwards turned over."""
    a, b, c = (v[f[:, k]] for k in range(3))
    upwards = np.cross(b - a, c - a)[:, 2] > 0
    return v, np.where(upwards[:, None], f[:, ::-1], f)


ROUGH = (
    Miniature(
        "vertex astray",
        changed(with_vertex_astray, accurate),
        "accuracy.position",
        ("accuracy.distance",),
    ),
    Miniature(
        "halved edges",
        halved,
        "accuracy.normal",
        tuple(f"accuracy.{name}" for name in ("position", "distance", "measure", "curvature")),
    ),
    Miniature(
        "coarsened",
        changed(coarsened, accurate),
        "accuracy.distance",
        tuple(f"accuracy.{name}" for name in ("normal", "measure", "volume", "curvature")),
    ),
    Miniature(
        "three layers",
        changed(in_three_layers, accurate),
        "accuracy.measure",
        ("accuracy.curvature",),
    ),
    Miniature(
        "lowered",
        lowered,
        "accuracy.volume",
        ("accuracy.position", "accuracy.distance", "accuracy.measure"),
    ),
    Miniature(
        "half turned",
        changed(half_turned, accurate),
        "accuracy.curvature",
        ("accuracy.volume",),
    ),
)
