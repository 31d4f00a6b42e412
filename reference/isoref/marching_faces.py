"""Marching faces: where two isosurfaces meet, found on the faces of the voxels.

The curve in which two isosurfaces intersect enters and leaves a voxel through its faces. On a face
each isosurface is at most two straight lines; where a line of one crosses a line of the other, the
curve passes. No triangle is ever made.

          v2 --- edge 2 --- v3
          |      .          |        a   isoline of field 1, inside on its left
     edge 3    a  .    b    edge 1   b   isoline of field 2
          |  . . . . . .    |        +   they cross: a point of the curve
          |        +        |
          v0 --- edge 0 --- v1       u runs along edge 0, v along edge 3

Glossary
--------
k, I_P      a voxel, in C order over the cells; running count of points up to and including it
b           voxel configuration: bit c is set where corner c of the voxel is inside
f           six bits, one a face: face ``2 * axis + side``
c           face configuration: bit i is set where vertex i of the face is inside
u, v        the face's own axes, so that (u, v, normal axis) is right-handed;
            vertex i of a face stands at (u, v) = (i & 1, i >> 1)
l           isolines of a face, each from one of its edges to another, inside on the left
separated   on an ambiguous face: each line cuts off one *inside* vertex, not an outside one
heading     +1 where the curve runs along the positive axis through the face, else -1

Invariants
----------
Whether two lines cross is decided by the order of their ends around the face, not by computed
positions. Two ends on one edge are ordered by their position; if the positions are equal, as if
both isovalues were lower by the same infinitesimal, and if still equal, that of the first field
by a trifle more. The order belongs to the lattice edge, so all faces at the edge agree, and the
lines are closed loops around every voxel. Two loops on a sphere cross as often one way as the
other, hence *in every voxel as many points enter as leave*, whatever the numbers are. Curves close
or end on the border of the lattice; identical surfaces have no point in common; fields that touch
have points or none, never half a curve.

References
----------
[1] P. Ljung, A. Ynnerman, Extraction of intersection curves from iso-surfaces on co-located 3D
    grids, sections 6 and 7, table 4, eqs. 2 to 4, figures 2 to 4.
[2] G. M. Nielson, B. Hamann, The asymptotic decider, 1991 (option ``asymptotic``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import linear_sum_assignment

from isoref import asymptotic_decider
from isoref.cube import CORNER_OFFSETS, EDGE_OF, corner_at
from isoref.curves import Curve, check_pair, curves_through, follow, real_and_imaginary
from isoref.field import Array, Booleans, Field, FieldError, Floats, Integers, least_inside

FaceRule = Literal["gradient", "asymptotic", "separated", "joined"]

# Voxels classified at once; their configurations then stay in the cache.
SLAB = 1 << 20

# The six face bits, each twice: face f of a voxel is (axis, side) = (f >> 1, f & 1).
AXES = np.arange(6) >> 1
SIDES = np.arange(6) & 1
# Vertices of a face's edges, in the direction of growing coordinate, and whether the walk
# v0 v1 v3 v2 around the face runs along that direction.
EDGES = ((0, 1), (1, 3), (2, 3), (0, 2))
FORWARD = (True, True, False, False)


def face_corners() -> Integers:
    """(6, 4) the corner of the cube that is vertex i of face f.

    Both faces across an axis look along it, unlike the walks of `isoref.cube.FACE_CORNERS`, which
    look from outside: a face is seen alike by the two voxels that share it.

    >>> face_corners()[4:].tolist()
    [[0, 1, 2, 3], [4, 5, 6, 7]]
    """
    corners = [
        [corner_at(*np.roll((side, i & 1, i >> 1), axis)) for i in range(4)]
        for axis, side in zip(AXES, SIDES, strict=True)
    ]
    return np.array(corners)


FACE_CORNERS = face_corners()
# (6, 4, 3) offsets in the voxel of vertex i of face f.
FACE_VERTICES: Integers = CORNER_OFFSETS[FACE_CORNERS]


def face_table() -> NDArray[np.uint8]:
    """FaceTable: for each configuration b, the faces that have vertices on both sides.

    Derived from the definition. It serves equation 2 with either sense of the inequality, since
    a face has both kinds of vertices whichever kind is called inside.

    >>> table = face_table()
    >>> table[0], table[255], format(table[1], "06b"), bool((table == table[::-1]).all())
    (np.uint8(0), np.uint8(0), '010101', True)
    """
    inside = np.arange(256)[:, None, None] >> FACE_CORNERS & 1
    mixed = inside.any(axis=2) & ~inside.all(axis=2)
    bits: NDArray[np.uint8] = (mixed << np.arange(6)).sum(axis=1).astype(np.uint8)
    return bits


FACE_TABLE = face_table()


def isolines(c: int, separated: bool) -> list[tuple[int, int]]:
    """The lines of a face of configuration c: pairs of edges, inside on the left (Fig. 3).

    Walk around the face. A line starts on an edge where the walk leaves the inside. Where inside
    vertices are separated, it ends where the walk last entered, else where it enters next.

    >>> isolines(0b0001, False), isolines(0b1001, True), isolines(0b1001, False)
    ([(0, 3)], [(0, 3), (2, 1)], [(0, 1), (2, 3)])
    """
    walk = [c >> i & 1 for i in (0, 1, 3, 2)]
    leaving = [e for e in range(4) if walk[e] and not walk[(e + 1) % 4]]
    entering = [e for e in range(4) if not walk[e] and walk[(e + 1) % 4]]
    step = -1 if separated else 1
    return [(e, min(entering, key=lambda other: (other - e) * step % 4)) for e in leaving]


def setup_lines() -> Integers:
    """SETUPLINES as a table (2, 16, 2, 2): separated, c, line, (start, end); -1 for no line."""
    table = np.full((2, 16, 2, 2), -1)
    for separated in (False, True):
        for c in range(16):
            for line, ends in enumerate(isolines(c, separated)):
                table[int(separated), c, line] = ends
    return table


LINES = setup_lines()
AMBIGUOUS = LINES[0, :, 1, 0] >= 0


@dataclass(frozen=True, eq=False)
class FacePoints:
    """Points P where two isosurfaces cross on voxel faces, in the order of the voxels.

    Attributes
    ----------
    positions : (P, 3) float64
    tangents : (P, 3) unit vectors along ``grad psi_1 x grad psi_2``; 0 where the gradients are
        parallel
    confidence : (P,) sine of the angle between the gradients, 0 (no tangent) to 1
    voxels : (P,) the voxel that owns the face, in C order over the cells
    faces : (P,) the face of that voxel, ``2 * axis + side``
    headings : (P,) +1 where the curve runs along the positive axis through the face, else -1
    edges : (P, 2) the edges of the face where the two lines through the point start
    cells : the number of voxels along each axis
    """

    positions: Floats
    tangents: Floats
    confidence: Floats
    voxels: Integers
    faces: Integers
    headings: Integers
    edges: Integers
    cells: tuple[int, int, int]

    def __len__(self) -> int:
        """P, the number of points."""
        return len(self.positions)

    def running_count(self) -> Integers:
        """I_P of table 4: for each voxel, the number of points up to and including it."""
        n = int(np.prod(self.cells))
        return np.cumsum(np.bincount(self.voxels, minlength=n)).astype(np.int64)


COLUMNS = ("positions", "tangents", "confidence", "voxels", "faces", "headings", "edges")


def marching_faces(
    first: Field,
    second: Field,
    isovalues: tuple[float, float] = (0.0, 0.0),
    rule: FaceRule = "gradient",
) -> FacePoints:
    """MARCHINGFACES (table 4): the points in which the two isosurfaces cross voxel faces.

    Parameters
    ----------
    first, second : scalar fields on one three-dimensional lattice
    isovalues : of the first and of the second field
    rule : of the ambiguous faces. ``gradient``: the direction of the gradient in the middle of
        the face, as the paper suggests; ``asymptotic``: the bilinear saddle value; ``separated``
        or ``joined``: always so

    Raises
    ------
    FieldError
        where the fields are not scalar fields on one lattice, or there is no such rule.

    Notes
    -----
    A lattice with fewer than two samples along an axis has no voxels, hence no points. Positions
    carry the error of linear interpolation, of second order in the spacing.
    """
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
    """The curves in which two isosurfaces meet, points of `marching_faces` joined voxel by voxel.

    Parameters and errors are those of `marching_faces`. Each point lies on exactly one curve. A
    curve is closed, or its two ends lie on the border of the lattice; it runs along
    ``grad psi_1 x grad psi_2``. Where neighbours have the same position, one of them is left, and
    a curve that is only one position is no curve.
    """
    points = marching_faces(first, second, isovalues, rule)
    return [
        curve
        for chain, closed in join(points, Pair(first, second, isovalues, rule))
        for curve in curves_through(points.positions[chain], closed)
    ]


def nodal_lines(psi: ArrayLike, spacing: ArrayLike | None = None) -> list[Curve]:
    """The curves on which a complex field is ``0 + 0i``, each with the phase turning around it.

    >>> x, y, z = np.meshgrid(*[np.linspace(-1, 1, 6)] * 3, indexing="ij")
    >>> nodal_lines(x + 1j * y)[0].points[[0, -1]].round(12).tolist()
    [[2.5, 2.5, 0.0], [2.5, 2.5, 5.0]]
    """
    return intersection_curves(*real_and_imaginary(psi, spacing))


# --- table 4, to be read --------------------------------------------------------------------------


def plain_marching_faces(
    first: Field,
    second: Field,
    isovalues: tuple[float, float] = (0.0, 0.0),
    rule: FaceRule = "gradient",
) -> FacePoints:
    """The same points as `marching_faces`, by the triple loop of table 4; to be read."""
    pair = Pair(first, second, isovalues, rule)
    rows = []
    for k, index in enumerate(np.ndindex(pair.cells)):
        b1, b2 = (voxel_config(field, isovalue, index) for field, isovalue in pair.sides)
        f = FACE_TABLE[b1] & FACE_TABLE[b2] & face_check(index, pair.cells)
        for j in (j for j in range(6) if f >> j & 1):
            vertices = np.array(index) + FACE_VERTICES[j]
            d1, l1 = _plain_lines(pair, 0, vertices, j)
            d2, l2 = _plain_lines(pair, 1, vertices, j)
            for uv, heading, edges in plain_intersect_lines(d1, l1, d2, l2):
                rows.append((vertices, uv, k, j, heading, edges))
    return _plain_points(pair, rows)


def voxel_config(field: Field, isovalue: float, index: tuple[int, ...]) -> int:
    """VOXELCONFIG (eq. 2) of one voxel: bit c is set where corner c is inside."""
    i, j, k = index
    cell = field.values[i : i + 2, j : j + 2, k : k + 2].astype(np.float64)
    return sum(1 << c for c in range(8) if cell[c & 1, c >> 1 & 1, c >> 2 & 1] >= isovalue)


def face_check(index: tuple[int, ...], cells: tuple[int, ...]) -> int:
    """FACECHECK: the faces that a voxel owns, so that no face is visited twice.

    Faces 0, 2 and 4 always; 1, 3 and 5 only of the last voxel along their axis.

    >>> format(face_check((0, 4, 1), (5, 5, 5)), "06b")
    '011101'
    """
    return sum(1 << f for f in range(6) if f % 2 == 0 or index[f // 2] == cells[f // 2] - 1)


def _plain_lines(
    pair: Pair, side: int, vertices: Integers, face: int
) -> tuple[list[float], list[tuple[int, int]]]:
    """FACECONFIG and SETUPLINES: values less the isovalue at the vertices, and the isolines."""
    field, isovalue = pair.sides[side]
    d = [float(field.values[tuple(vertex)]) - isovalue for vertex in vertices.tolist()]
    c = sum(1 << i for i in range(4) if d[i] >= 0)
    separated = False
    if c in (0b0110, 0b1001):
        separated = _plain_separated(pair, field, d, c == 0b1001, vertices, face // 2)
    return d, isolines(c, separated)


def _plain_separated(
    pair: Pair, field: Field, d: list[float], main: bool, vertices: Integers, axis: int
) -> bool:
    """Whether the inside vertices of an ambiguous face are separated, 0 and 3 where `main`."""
    if pair.rule in ("separated", "joined"):
        return pair.rule == "separated"
    if pair.rule == "gradient":
        whole = np.asarray(np.gradient(field.values.astype(np.float64), *field.spacing))
        g = whole[:, *vertices.T].mean(axis=1)
        slope = g[(axis + 1) % 3] * g[(axis + 2) % 3]
        if slope != 0:
            return bool((slope > 0) == main)
    return d[0] * d[3] < d[1] * d[2] if main else d[1] * d[2] < d[0] * d[3]


def plain_intersect_lines(
    d1: list[float], l1: list[tuple[int, int]], d2: list[float], l2: list[tuple[int, int]]
) -> list[tuple[tuple[float, float], int, tuple[int, int]]]:
    """INTERSECTLINES on one face: ((u, v), heading, starting edges) of each crossing.

    All ends of lines are sorted as the walk around the face meets them. A line crosses another
    where exactly one end of the other lies between its own start and its own end.
    """
    keys = {
        (number, e): (e, *_order_on_edge(d, e, number))
        for number, d in enumerate((d1, d2))
        for e in range(4)
        if (d[EDGES[e][0]] >= 0) != (d[EDGES[e][1]] >= 0)
    }
    rank = {end: place for place, end in enumerate(sorted(keys, key=lambda end: keys[end]))}
    n = len(rank)
    found = []
    for a in l1:
        for b in l2:
            start, stop = rank[0, a[0]], rank[0, a[1]]
            between = [(rank[1, e] - start) % n < (stop - start) % n for e in b]
            if between[0] != between[1]:
                uv = crossing_point(_plain_ends(d1, a), _plain_ends(d2, b))[0]
                place = (float(uv[0]), float(uv[1]))
                found.append((place, 1 if between[0] else -1, (a[0], b[0])))
    return found


def _order_on_edge(d: list[float], e: int, number: int) -> tuple[float, float, float]:
    """Sorts ends on one edge along the walk: position, shift, and which field it is."""
    low, high = d[EDGES[e][0]], d[EDGES[e][1]]
    t, shift = low / (low - high), -1 / (high - low)
    first = 0.0 if number else np.sign(shift)
    return (t, shift, first) if FORWARD[e] else (-t, -shift, -first)


def _plain_ends(d: list[float], line: tuple[int, int]) -> Floats:
    """(1, 2, 2) coordinates (u, v) of the ends of a line."""
    ends_uv = []
    for e in line:
        low, high = d[EDGES[e][0]], d[EDGES[e][1]]
        t = low / (low - high)
        ends_uv.append([(t, 0.0), (1.0, t), (t, 1.0), (0.0, t)][e])
    return np.array([ends_uv])


def _plain_points(pair: Pair, rows: list[tuple[Any, ...]]) -> FacePoints:
    """`FacePoints` of the rows (vertices, uv, voxel, face, heading, edges)."""
    n = len(rows)
    columns = zip(*rows, strict=True) if n else [()] * 6
    shapes = ((n, 4, 3), (n, 2), (n,), (n,), (n,), (n, 2))
    vertices, uv, voxels, faces, headings, edges = (
        np.array(column, float if number == 1 else np.int64).reshape(shape)
        for number, (column, shape) in enumerate(zip(columns, shapes, strict=True))
    )
    positions = pair.first.position(_places(vertices[:, 0], AXES[faces], uv))
    tangents, confidence = pair.tangents(vertices, uv)
    return FacePoints(positions, tangents, confidence, voxels, faces, headings, edges, pair.cells)


# --- the sweep over the active voxels ----------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Pair:
    """Two co-located fields with their isovalues and the rule of ambiguous faces."""

    first: Field
    second: Field
    isovalues: tuple[float, float]
    rule: FaceRule

    def __post_init__(self) -> None:
        check_pair(self.first, self.second, self.isovalues)
        if self.rule not in get_args(FaceRule):
            raise FieldError(f"no face rule {self.rule!r}; choose of {get_args(FaceRule)}")

    @property
    def sides(self) -> tuple[tuple[Field, float], tuple[Field, float]]:
        """Each field with its isovalue."""
        return (self.first, self.isovalues[0]), (self.second, self.isovalues[1])

    @property
    def cells(self) -> tuple[int, int, int]:
        """The number of voxels along each axis."""
        n1, n2, n3 = (max(n - 1, 0) for n in self.first.shape)
        return n1, n2, n3

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

    def lines(self, side: int, vertices: Integers, faces: Integers) -> tuple[Floats, Integers]:
        """Values (F, 4), less the isovalue, and isolines (F, 2, 2) of one field on these faces."""
        field, isovalue = self.sides[side]
        d = _gather(field.values, vertices)
        c = (d >= isovalue) @ np.array([1, 2, 4, 8])
        separated = self.separated(field, d - isovalue, c, vertices, faces)
        return d - isovalue, LINES[separated.astype(np.int64), c]

    def separated(
        self, field: Field, d: Floats, c: Integers, vertices: Integers, faces: Integers
    ) -> Booleans:
        """(F,) whether the inside vertices are separated; False where that is no question."""
        result = np.zeros(len(c), bool)
        hard = np.flatnonzero(AMBIGUOUS[c])
        if self.rule in ("separated", "joined") or not len(hard):
            result[hard] = self.rule == "separated"
            return result
        d = d[hard]
        result[hard] = asymptotic_decider.separated(d[:, 0], d[:, 1], d[:, 3], d[:, 2])
        if self.rule == "gradient":
            axis, rows = AXES[faces[hard]], np.arange(len(hard))
            g = gradients(field, vertices[hard]).mean(axis=1)
            slope = g[rows, (axis + 1) % 3] * g[rows, (axis + 2) % 3]
            result[hard] = np.where(slope == 0, result[hard], (slope > 0) == (d[:, 0] >= 0))
        return result

    def intersect(self, voxels: Integers, faces: Integers) -> tuple[Array, ...]:
        """The columns of `FacePoints` for these faces."""
        vertices = self.vertices(voxels, faces)
        d1, l1 = self.lines(0, vertices, faces)
        d2, l2 = self.lines(1, vertices, faces)
        face, uv, headings, edges = intersect_lines(d1, l1, d2, l2)
        place = _places(vertices[face, 0], AXES[faces[face]], uv)
        tangents, confidence = self.tangents(vertices[face], uv)
        positions = self.first.position(place)
        return positions, tangents, confidence, voxels[face], faces[face], headings, edges

    def tangents(self, vertices: Integers, uv: Floats) -> tuple[Floats, Floats]:
        """Unit tangents (P, 3) and confidence (P,), gradients bilinear in (u, v)."""
        u, v = uv.T
        weights = np.stack([(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v], axis=1)
        g1, g2 = (
            _unit((gradients(field, vertices) * weights[:, :, None]).sum(axis=1))
            for field, _ in self.sides
        )
        cross = np.cross(g1, g2)
        return _unit(cross), np.minimum(np.linalg.norm(cross, axis=1), 1.0)


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
        rise = _gather(field.values, above) - _gather(field.values, below)
        result[..., axis] = rise / ((above - below)[..., axis] * field.spacing[axis])
    return result


def intersect_lines(
    d1: Floats, l1: Integers, d2: Floats, l2: Integers
) -> tuple[Integers, Floats, Integers, Integers]:
    """INTERSECTLINES: where the isolines of two fields cross, on F faces at once.

    Parameters
    ----------
    d1, d2 : (F, 4) values at the vertices, less the isovalue
    l1, l2 : (F, 2, 2) isolines, as in `LINES`

    Returns
    -------
    faces (P,), coordinates (P, 2) as (u, v), headings (P,), starting edges (P, 2); sorted by face.
    """
    t1, t2 = crossings(d1), crossings(d2)
    ahead = first_is_ahead(d1, t1, d2, t2)
    # Places around the face, 4 an edge: the second field's at 2, the first one's before or after.
    place1, place2 = 4 * np.arange(4) + np.where(ahead, 3, 1), 4 * np.arange(4) + 2
    found = []
    for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):
        face = np.flatnonzero((l1[:, i, 0] >= 0) & (l2[:, j, 0] >= 0))
        a, b = l1[face, i], l2[face, j]
        a_place = np.take_along_axis(place1[face], a, axis=1)
        b_place = place2[b]
        right = (b_place - a_place[:, :1]) % 16 < (a_place[:, 1:] - a_place[:, :1]) % 16
        cross = np.flatnonzero(right[:, 0] != right[:, 1])
        face, a, b = face[cross], a[cross], b[cross]
        uv = crossing_point(ends(t1[face], a), ends(t2[face], b))
        heading = np.where(right[cross, 0], 1, -1)
        found.append((face, uv, heading, np.stack([a[:, 0], b[:, 0]], axis=1)))
    face, uv, heading, edges = (np.concatenate(column) for column in zip(*found, strict=True))
    order = np.argsort(face, kind="stable")
    return face[order], uv[order], heading[order], edges[order]


def crossings(d: Floats) -> Floats:
    """(F, 4) where the value 0 is met on each edge, as a fraction of the way up its coordinate."""
    low, high = d[:, [0, 1, 2, 0]], d[:, [1, 3, 3, 2]]
    mixed = (low >= 0) != (high >= 0)
    return np.divide(low, low - high, out=np.zeros_like(low), where=mixed)


def first_is_ahead(d1: Floats, t1: Floats, d2: Floats, t2: Floats) -> Booleans:
    """(F, 4) whether field 1 crosses an edge later on the walk around the face than field 2.

    Equal positions are told apart as if both isovalues were lower by the same infinitesimal, then
    as if that of field 1 were lower still.
    """
    slope1, slope2 = (d[:, [1, 3, 3, 2]] - d[:, [0, 1, 2, 0]] for d in (d1, d2))
    # A crossing shifts by -1 / slope along the edge; larger t, then larger shift, is further up.
    with np.errstate(divide="ignore"):
        shift1, shift2 = -1 / slope1, -1 / slope2
    up = np.where(shift1 == shift2, shift1 > 0, shift1 > shift2)
    up = np.where(t1 == t2, up, t1 > t2)
    ahead: Booleans = up == np.array(FORWARD)
    return ahead


def ends(t: Floats, line: Integers) -> Floats:
    """(P, 2, 2) coordinates (u, v) of the start and the end of lines on P faces."""
    fixed = np.array([0.0, 1.0, 1.0, 0.0])[line]
    moving = np.take_along_axis(t, line, axis=1)
    along_u = line % 2 == 0
    return np.stack([np.where(along_u, moving, fixed), np.where(along_u, fixed, moving)], axis=2)


def crossing_point(a: Floats, b: Floats) -> Floats:
    """(P, 2) where segments a and b (P, 2, 2), known to cross, do so.

    Each segment is met within its ends, in its middle where rounding leaves them parallel; the
    mean of the two places is the same whichever field is called the first.
    """
    return (_meet(a, b) + _meet(b, a)) / 2


def _meet(a: Floats, b: Floats) -> Floats:
    """The point of segment a on the line of segment b."""
    da, db, gap = a[:, 1] - a[:, 0], b[:, 1] - b[:, 0], b[:, 0] - a[:, 0]
    det = da[:, 0] * db[:, 1] - da[:, 1] * db[:, 0]
    s = np.divide(
        gap[:, 0] * db[:, 1] - gap[:, 1] * db[:, 0],
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


# Edge of the voxel that is edge e of face f.
CELL_EDGES = np.array(
    [[EDGE_OF[frozenset((row[i], row[j]))] for i, j in EDGES] for row in FACE_CORNERS.tolist()]
)


def _cell_edges(points: FacePoints, chosen: Integers, voxels: Integers) -> Integers:
    """(P, 2) edges of `voxels` where the lines through the chosen points start."""
    face = points.faces[chosen]
    # Seen from the voxel that does not own it, a face of side 0 is one of side 1.
    face = np.where(points.voxels[chosen] == voxels, face, face ^ 1)
    return CELL_EDGES[face[:, None], points.edges[chosen]]


def loop_labels(pair: Pair, side: int, voxels: Integers) -> Integers:
    """(C, 12) for each edge of these voxels, the least edge on the same loop of a surface."""
    faces = np.tile(np.arange(6), len(voxels))
    _, lines = pair.lines(side, pair.vertices(np.repeat(voxels, 6), faces), faces)
    lines = lines.reshape(len(voxels), 12, 2)
    rows, line = np.nonzero(lines[:, :, 0] >= 0)
    start, end = CELL_EDGES[line[:, None] // 2, lines[rows, line]].T
    labels = np.tile(np.arange(12), (len(voxels), 1))
    # A loop has at most twelve edges, so that twelve rounds carry the least one all around.
    for _ in range(12):
        least = np.minimum(labels[rows, start], labels[rows, end])
        np.minimum.at(labels, (rows, start), least)
        np.minimum.at(labels, (rows, end), least)
    return labels


def _places(corners: Integers, axes: Integers, uv: Floats) -> Floats:
    """Fractional lattice indices (P, 3) of points (u, v) of faces across these axes."""
    place, rows = corners.astype(np.float64), np.arange(len(corners))
    place[rows, (axes + 1) % 3] += uv[:, 0]
    place[rows, (axes + 2) % 3] += uv[:, 1]
    return place


def _gather(values: Array, indices: Integers) -> Floats:
    """Samples at lattice indices (.., 3), as float64."""
    gathered: Floats = values[indices[..., 0], indices[..., 1], indices[..., 2]].astype(np.float64)
    return gathered


def _unit(vectors: Floats) -> Floats:
    """Vectors (P, 3) of length 1; those of length 0 stay as they are."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    unit: Floats = np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0)
    return unit
