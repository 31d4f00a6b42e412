"""Marching faces, vectorised: the points and curves of `isoref.marching_faces`.

Configurations are made for a slab of voxels at once and looked up in FaceTable; only the few faces
that both surfaces intersect are gone into. Corners and edges of a face are numbered 0 .. 3 along
its walk in `isoref.cube`: corner i is `FACE_CORNERS[f][i]`, edge i runs from corner i to the next.

Glossary
--------
F, P, C     faces, points, crowded voxels that are looked at together
d           (F, 4) samples at a face's corners minus the isovalue, along the walk
c           (F,) configuration of a face: bit i is set where corner i of the walk is inside
l           (F, 2, 2) isolines of a face: at most two, each from edge to edge of the walk
upward      (F, 4) whether the walk runs along an edge from its lower end to its upper one
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import linear_sum_assignment

from isoref import asymptotic_decider
from isoref import marching_faces as article
from isoref.cube import CORNER_OFFSETS
from isoref.cube import FACE_CORNERS as FACE_CORNERS_OF_CUBE
from isoref.cube import FACE_EDGES as FACE_EDGES_OF_CUBE
from isoref.curves import Curve, curves_through, follow, real_and_imaginary
from isoref.cycles import segments
from isoref.field import Array, Booleans, Field, Floats, Integers, least_inside
from isoref.marching_faces import (
    FacePoints,
    FaceRule,
    edge_across,
    isosurfaces,
    number_of_cells,
    units,
)

# Voxels classified at once; their configurations then stay in the cache.
SLAB = 1 << 20

# (6,) axis and side of each face, (6, 2) the two axes within it.
AXES = np.arange(6) >> 1
SIDES = np.arange(6) & 1
WITHIN = np.array([[axis for axis in range(3) if axis != f // 2] for f in range(6)])

# (6, 4) corners and edges along the walk around a face, and (6, 4, 3) its corners' offsets.
FACE_CORNERS = np.array(FACE_CORNERS_OF_CUBE)
FACE_EDGES = np.array(FACE_EDGES_OF_CUBE)
FACE_VERTICES: Integers = CORNER_OFFSETS[FACE_CORNERS]

# (6, 4) the walk's numbers of the lower and the upper end of an edge.
UPWARD = FACE_CORNERS < np.roll(FACE_CORNERS, -1, axis=1)
LOW = np.where(UPWARD, np.arange(4), (np.arange(4) + 1) % 4)
HIGH = np.where(UPWARD, (np.arange(4) + 1) % 4, np.arange(4))

# The corners along the walk in the order of their numbers, the same from both sides of a face.
RISING = np.argsort(FACE_CORNERS, axis=1)

FACE_TABLE = np.array(article.FACE_TABLE, np.uint8)
ACROSS = np.array([[edge_across(e, axis) if e // 4 != axis else -1 for e in range(12)]
                   for axis in range(3)])  # fmt: skip


def setup_lines() -> Integers:
    """SETUPLINES as a table (2, 16, 2, 2): separated, c, line, (start, end); -1 for no line.

    The walk numbers the parts of all faces alike, so one face serves for all.
    """
    table = np.full((2, 16, 2, 2), -1)
    walk, edges = FACE_CORNERS_OF_CUBE[0], FACE_EDGES_OF_CUBE[0]
    for separated in (False, True):
        for c in range(16):
            signs = sum(1 << walk[i] for i in range(4) if c >> i & 1)
            for line, ends in enumerate(segments(signs, 0, separated)):
                table[int(separated), c, line] = [edges.index(e) for e in ends]
    return table


LINES = setup_lines()
AMBIGUOUS = LINES[0, :, 1, 0] >= 0

COLUMNS = ("positions", "tangents", "confidence", "voxels", "faces", "headings", "edges")


def marching_faces(
    first: Field,
    second: Field,
    isovalues: tuple[float, float] = (0.0, 0.0),
    rule: FaceRule = "gradient",
) -> FacePoints:
    """The points where two isosurfaces cross; see `isoref.marching_faces.marching_faces`."""
    pair = Pair(first, second, isovalues, rule)
    found = [pair.intersect(*candidates) for candidates in pair.candidates()]
    columns: dict[str, Any] = {
        name: np.concatenate([part[number] for part in found])
        for number, name in enumerate(COLUMNS)
    }
    return FacePoints(cells=pair.cells, **columns)


def intersection_curves(
    first: Field,
    second: Field,
    isovalues: tuple[float, float] = (0.0, 0.0),
    rule: FaceRule = "gradient",
) -> list[Curve]:
    """The curves in which they meet; see `isoref.marching_faces.intersection_curves`."""
    points = marching_faces(first, second, isovalues, rule)
    return [
        curve
        for chain, closed in join(points, Pair(first, second, isovalues, rule))
        for curve in curves_through(points.positions[chain], closed)
    ]


def nodal_lines(psi: ArrayLike, spacing: ArrayLike | None = None) -> list[Curve]:
    """The curves on which a complex field is 0; see `isoref.marching_faces.nodal_lines`."""
    return intersection_curves(*real_and_imaginary(psi, spacing))


@dataclass(frozen=True, eq=False)
class Pair:
    """Two co-located fields with their isovalues and the rule of ambiguous faces."""

    first: Field
    second: Field
    isovalues: tuple[float, float]
    rule: FaceRule

    def __post_init__(self) -> None:
        """Raise FieldError unless the fields stand on one lattice and the rule is known."""
        isosurfaces(self.first, self.second, self.isovalues, self.rule)

    @property
    def sides(self) -> tuple[tuple[Field, float], tuple[Field, float]]:
        """Each field with its isovalue."""
        return (self.first, self.isovalues[0]), (self.second, self.isovalues[1])

    @property
    def cells(self) -> tuple[int, int, int]:
        """The number of voxels along each axis."""
        return number_of_cells(self.first)

    def candidates(self) -> list[tuple[Integers, Integers]]:
        """(voxels, faces) that both surfaces intersect, slab by slab, each face once."""
        layer = max(self.cells[1] * self.cells[2], 1)
        step = max(SLAB // layer, 1)
        slabs = range(0, self.cells[0], step)
        return [self._slab(start, min(start + step, self.cells[0])) for start in slabs] or [
            (np.empty(0, np.int64), np.empty(0, np.int64))
        ]

    def _slab(self, start: int, stop: int) -> tuple[Integers, Integers]:
        """`candidates` with first index start to stop - 1."""
        b1, b2 = (
            voxel_configurations(self.inside(field, isovalue, start, stop)).ravel()
            for field, isovalue in self.sides
        )
        # b + 1 wraps 255 to 0, so that b + 1 > 1 says that the voxel is mixed.
        one = np.uint8(1)
        active = np.flatnonzero((b1 + one > one) & (b2 + one > one))
        voxels = active + start * self.cells[1] * self.cells[2]
        f = FACE_TABLE[b1[active]] & FACE_TABLE[b2[active]]
        where = np.stack(np.unravel_index(voxels, self.cells), axis=1)
        checked = (SIDES == 0) | (where[:, AXES] == np.array(self.cells)[AXES] - 1)
        row, face = np.nonzero((f[:, None] >> np.arange(6) & 1).astype(bool) & checked)
        return voxels[row], face

    def inside(self, field: Field, isovalue: float, start: int, stop: int) -> Booleans:
        """Which samples are inside, in the planes start to stop."""
        samples = field.values[start : stop + 1]
        mask: Booleans = samples >= least_inside(samples.dtype, isovalue)
        return mask

    def vertices(self, voxels: Integers, faces: Integers) -> Integers:
        """(F, 4, 3) lattice indices of the vertices of these faces."""
        corner = np.stack(np.unravel_index(voxels, self.cells), axis=1)
        return corner[:, None, :] + FACE_VERTICES[faces]

    def lines(
        self, side: int, vertices: Integers, faces: Integers
    ) -> tuple[Floats, Booleans, Integers]:
        """Of one field on these faces: d (F, 4), which corners are inside (F, 4), l (F, 2, 2)."""
        field, isovalue = self.sides[side]
        samples = field.values[vertices[..., 0], vertices[..., 1], vertices[..., 2]]
        inside = np.asarray(samples >= least_inside(samples.dtype, isovalue))
        d = samples.astype(np.float64) - isovalue
        c = inside @ np.array([1, 2, 4, 8])
        separated = self.separated(field, d, c, vertices, faces)
        return d, inside, LINES[separated.astype(np.int64), c]

    def separated(
        self, field: Field, d: Floats, c: Integers, vertices: Integers, faces: Integers
    ) -> Booleans:
        """(F,) whether the inside corners are separated; False where that is no question."""
        result = np.zeros(len(c), bool)
        hard = np.flatnonzero(AMBIGUOUS[c])
        if self.rule in ("separated", "joined") or not len(hard):
            result[hard] = self.rule == "separated"
            return result
        d = d[hard]
        result[hard] = asymptotic_decider.separated(*d.T)
        if self.rule in article.GRADIENT_RULES:
            # Take the corners in the order that is the same from both sides of the face.
            order = RISING[faces[hard]]
            g = gradients(field, np.take_along_axis(vertices[hard], order[..., None], axis=1))
            d = np.take_along_axis(d, order, axis=1)
            for axis in range(3):
                own = np.flatnonzero(AXES[faces[hard]] == axis)
                within = [a for a in range(3) if a != axis]
                slopes = g[own].transpose(1, 0, 2)[:, :, within]
                h = np.array(field.spacing)[within]
                against = article.GRADIENT_RULES[self.rule](d[own].T, slopes, h)
                decided = (against < 0) == (d[own, 0] >= 0)
                result[hard[own]] = np.where(against == 0, result[hard[own]], decided)
        return result

    def intersect(self, voxels: Integers, faces: Integers) -> tuple[Array, ...]:
        """The columns of `FacePoints` for these faces."""
        vertices = self.vertices(voxels, faces)
        one, two = (self.lines(side, vertices, faces) for side in (0, 1))
        face, place, leaves, edges = intersect_lines(faces, *one, *two)
        corner = vertices[face, 0] - FACE_VERTICES[faces[face], 0]
        positions = self.first.position(corner + place)
        tangents, confidence = self.tangents(vertices[face], faces[face], place)
        headings = np.where(leaves == (SIDES[faces[face]] == 1), 1, -1)
        return positions, tangents, confidence, voxels[face], faces[face], headings, edges

    def tangents(self, vertices: Integers, faces: Integers, place: Floats) -> tuple[Floats, Floats]:
        """Unit tangents (P, 3) and confidence (P,), gradients bilinear on each face."""
        rising = RISING[faces]
        vertices = np.take_along_axis(vertices, rising[..., None], axis=1)
        corners = CORNER_OFFSETS[np.take_along_axis(FACE_CORNERS[faces], rising, axis=1)]
        factors = np.where(corners == 1, place[:, None], 1 - place[:, None])
        u, v = WITHIN[faces].T[..., None, None]
        weights = np.take_along_axis(factors, u, axis=2) * np.take_along_axis(factors, v, axis=2)
        g1, g2 = (
            units((gradients(field, vertices) * weights).sum(axis=1)) for field, _ in self.sides
        )
        cross = np.cross(g1, g2)
        return units(cross), np.minimum(np.linalg.norm(cross, axis=1), 1.0)


def voxel_configurations(inside: Booleans) -> NDArray[np.uint8]:
    """VOXELCONFIG (eq. 2) of all voxels: bit c is set where corner c is inside.

    >>> voxel_configurations(np.arange(8).reshape(2, 2, 2) >= 4)
    array([[[170]]], dtype=uint8)
    """
    bits = inside.view(np.uint8)
    # Fold one axis after the other: pairs, then faces, then voxels; corner bits 1, 2, 4.
    bits = bits[:, :, :-1] | bits[:, :, 1:] << np.uint8(4)
    bits = bits[:, :-1] | bits[:, 1:] << np.uint8(2)
    return bits[:-1] | bits[1:] << np.uint8(1)


def gradients(field: Field, indices: Integers) -> Floats:
    """Gradients (.., 3) at samples: central differences, one-sided at the border (eq. 4)."""
    result = np.empty(indices.shape, np.float64)
    for axis in range(3):
        above, below = indices.copy(), indices.copy()
        above[..., axis] = np.minimum(indices[..., axis] + 1, field.shape[axis] - 1)
        below[..., axis] = np.maximum(indices[..., axis] - 1, 0)
        half = _gather(field.values, above) / 2 - _gather(field.values, below) / 2
        result[..., axis] = half / ((above - below)[..., axis] * field.spacing[axis] / 2)
    return result


def intersect_lines(
    faces: Integers,
    d1: Floats,
    inside1: Booleans,
    l1: Integers,
    d2: Floats,
    inside2: Booleans,
    l2: Integers,
) -> tuple[Integers, Floats, Booleans, Integers]:
    """INTERSECTLINES: where the isolines of two fields cross, on F faces at once.

    Returns
    -------
    rows into `faces` (P,), places in the voxel (P, 3), whether the curve leaves there (P,), and
    the edges of the voxel on which the lines start (P, 2); sorted by row.
    """
    t1, t2 = crossings(faces, d1, inside1), crossings(faces, d2, inside2)
    ahead = first_is_ahead(faces, (d1, inside1, t1), (d2, inside2, t2))
    # Places on the walk, 4 an edge: the second field's at 2, the first one's before or after.
    place1, place2 = 4 * np.arange(4) + np.where(ahead, 3, 1), 4 * np.arange(4) + 2
    found = []
    for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):
        row = np.flatnonzero((l1[:, i, 0] >= 0) & (l2[:, j, 0] >= 0))
        a, b = l1[row, i], l2[row, j]
        start, stop = np.take_along_axis(place1[row], a, axis=1).T[..., None]
        right = (place2[b] - start) % 16 < (stop - start) % 16
        cross = np.flatnonzero(right[:, 0] != right[:, 1])
        row, a, b = row[cross], a[cross], b[cross]
        place = crossing_point(
            faces[row], line_ends(faces[row], t1[row], a), line_ends(faces[row], t2[row], b)
        )
        starts = np.stack([a[:, 0], b[:, 0]], axis=1)
        edges = np.take_along_axis(FACE_EDGES[faces[row]], starts, axis=1)
        found.append((row, place, right[cross, 0], edges))
    row, place, leaves, edges = (np.concatenate(column) for column in zip(*found, strict=True))
    order = np.argsort(row, kind="stable")
    return row[order], place[order], leaves[order], edges[order]


def crossings(faces: Integers, d: Floats, inside: Booleans) -> Floats:
    """(F, 4) where the value 0 is met on each edge, as a fraction of the way from its lower end."""
    lower, upper = LOW[faces], HIGH[faces]
    low, high = np.take_along_axis(d, lower, axis=1), np.take_along_axis(d, upper, axis=1)
    mixed = np.take_along_axis(inside, lower, axis=1) != np.take_along_axis(inside, upper, axis=1)
    return np.divide(low, low - high, out=np.zeros_like(low), where=mixed & (low != high))


def first_is_ahead(
    faces: Integers, one: tuple[Floats, Booleans, Floats], two: tuple[Floats, Booleans, Floats]
) -> Booleans:
    """(F, 4) whether field 1 crosses an edge later on the walk around the face than field 2.

    Each field is given by d, which corners are inside, and its crossings. Equal positions are told
    apart as if both isovalues were lower by the same infinitesimal, then as if that of field 1 were
    lower still.
    """
    (shift1, t1), (shift2, t2) = ((_shift(faces, d, inside), t) for d, inside, t in (one, two))
    up = np.where(shift1 == shift2, shift1 > 0, shift1 > shift2)
    up = np.where(t1 == t2, up, t1 > t2)
    ahead: Booleans = up == UPWARD[faces]
    return ahead


def _shift(faces: Integers, d: Floats, inside: Booleans) -> Floats:
    """(F, 4) by how much a crossing moves up its edge when the isovalue falls: -1 / slope."""
    low, high = LOW[faces], HIGH[faces]
    rise = np.take_along_axis(d, high, axis=1) - np.take_along_axis(d, low, axis=1)
    # Samples that a float cannot tell apart rise where the upper one is inside.
    falls = np.take_along_axis(inside, low, axis=1)
    with np.errstate(divide="ignore"):
        shift = -1 / rise
    return np.asarray(np.where(rise == 0, np.where(falls, np.inf, -np.inf), shift))


def line_ends(faces: Integers, t: Floats, line: Integers) -> Floats:
    """(P, 2, 3) the start and the end of lines (P, 2) on P faces, in coordinates of the voxel."""
    rows = np.arange(len(line))[:, None]
    low = np.take_along_axis(LOW[faces], line, axis=1)
    ends: Floats = CORNER_OFFSETS[np.take_along_axis(FACE_CORNERS[faces], low, axis=1)].astype(
        float
    )
    along = FACE_EDGES[faces[:, None], line] // 4
    ends[rows, np.arange(2), along] = np.take_along_axis(t, line, axis=1)
    return ends


def crossing_point(faces: Integers, a: Floats, b: Floats) -> Floats:
    """(P, 3) where segments a and b (P, 2, 3) of P faces, known to cross, do so."""
    return np.asarray((_meet(faces, a, b) + _meet(faces, b, a)) / 2)


def _meet(faces: Integers, a: Floats, b: Floats) -> Floats:
    """The point of segment a on the line of segment b."""
    rows, (u, v) = np.arange(len(faces)), WITHIN[faces].T
    da, db, gap = a[:, 1] - a[:, 0], b[:, 1] - b[:, 0], b[:, 0] - a[:, 0]
    det = da[rows, u] * db[rows, v] - da[rows, v] * db[rows, u]
    s = np.divide(
        gap[rows, u] * db[rows, v] - gap[rows, v] * db[rows, u],
        det,
        out=np.full(len(det), 0.5),
        where=det != 0,
    )
    place: Floats = a[:, 0] + np.clip(s, 0, 1)[:, None] * da
    return place


# --- joining -------------------------------------------------------------------------------------


def join(points: FacePoints, pair: Pair) -> list[tuple[Integers, bool]]:
    """The points in order along their curves, by index, and whether each curve is closed.

    In a voxel with one point in and one point out there is nothing to choose. With more, only
    points on the same loop of either surface around the voxel are joined, and among those the
    choice of least total length.
    """
    leaves, enters = _voxels_beside(points)
    successor = np.full(len(points), -1)
    used, count = np.unique(enters[enters >= 0], return_counts=True)
    simple = np.zeros(int(np.prod(points.cells)) + 1, bool)
    simple[used[count == 1]] = True
    into = np.flatnonzero(simple[enters])
    out = np.flatnonzero(simple[leaves])
    successor[into[np.argsort(enters[into])]] = out[np.argsort(leaves[out])]
    _join_crowded(points, pair, used[count > 1], leaves, enters, successor)
    return follow(successor)


def _voxels_beside(points: FacePoints) -> tuple[Integers, Integers]:
    """The voxel that the curve leaves and the one that it enters at each point, or -1."""
    stride = np.array([points.cells[1] * points.cells[2], points.cells[2], 1])
    axis, side = AXES[points.faces], SIDES[points.faces]
    corner = np.stack(np.unravel_index(points.voxels, points.cells), axis=1)
    # A face of side 0 has its owner above it, a face of side 1 (on the border) below it.
    above = np.where(side == 0, points.voxels, -1)
    inner = corner[np.arange(len(points)), axis] > 0
    below = np.where(side == 1, points.voxels, np.where(inner, points.voxels - stride[axis], -1))
    up = points.headings > 0
    return np.where(up, below, above), np.where(up, above, below)


def _join_crowded(
    points: FacePoints,
    pair: Pair,
    crowded: Integers,
    leaves: Integers,
    enters: Integers,
    successor: Integers,
) -> None:
    """`successor` filled in for the points that enter a voxel which several points enter."""
    if not len(crowded):
        return
    loops = np.stack([loop_labels(pair, side, crowded) for side in (0, 1)], axis=1)
    groups: dict[int, tuple[list[int], list[int]]] = {}
    for role, voxels in enumerate((enters, leaves)):
        chosen = np.flatnonzero(np.isin(voxels, crowded))
        row = np.searchsorted(crowded, voxels[chosen])
        edge = _cell_edges(points, chosen, voxels[chosen])
        labels = loops[row[:, None], [[0, 1]], edge]
        keys = (144 * row + 12 * labels[:, 0] + labels[:, 1]).tolist()
        for point, key in zip(chosen.tolist(), keys, strict=True):
            groups.setdefault(key, ([], []))[role].append(point)
    for into, out in groups.values():
        apart = points.positions[into][:, None] - points.positions[out][None]
        row, column = linear_sum_assignment(np.linalg.norm(apart, axis=2))
        successor[np.array(into)[row]] = np.array(out)[column]


def _cell_edges(points: FacePoints, chosen: Integers, voxels: Integers) -> Integers:
    """(P, 2) edges of `voxels` where the lines through the chosen points start."""
    edges = points.edges[chosen]
    across = ACROSS[AXES[points.faces[chosen]][:, None], edges]
    return np.where((points.voxels[chosen] == voxels)[:, None], edges, across)


def loop_labels(pair: Pair, side: int, voxels: Integers) -> Integers:
    """(C, 12) for each edge of these voxels, the least edge on the same loop of a surface."""
    faces = np.tile(np.arange(6), len(voxels))
    _, _, lines = pair.lines(side, pair.vertices(np.repeat(voxels, 6), faces), faces)
    lines = lines.reshape(len(voxels), 12, 2)
    rows, line = np.nonzero(lines[:, :, 0] >= 0)
    start, end = FACE_EDGES[line[:, None] // 2, lines[rows, line]].T
    labels = np.tile(np.arange(12), (len(voxels), 1))
    # A loop has at most twelve edges, so that twelve rounds carry the least one all around.
    for _ in range(12):
        least = np.minimum(labels[rows, start], labels[rows, end])
        np.minimum.at(labels, (rows, start), least)
        np.minimum.at(labels, (rows, end), least)
    return labels


def _gather(values: Array, indices: Integers) -> Floats:
    """Samples at lattice indices (.., 3), as float64."""
    gathered: Floats = values[indices[..., 0], indices[..., 1], indices[..., 2]].astype(np.float64)
    return gathered
