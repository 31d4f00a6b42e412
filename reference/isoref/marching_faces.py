r"""Marching faces: where two isosurfaces meet, found on the faces of the voxels.

The curve in which two isosurfaces intersect enters and leaves a voxel through its faces. On a face
each isosurface is at most two straight lines; where a line of one crosses a line of the other, the
curve passes. No triangle is ever made.

          o --------x------ o
          |        .        |        a   isoline of field 1, inside on its right
          |  b    .         |        b   isoline of field 2
          x . . .+. . . . . x        +   they cross: a point of the curve
          |     .  a        |        x   crossed edges, o corners
          o ---x----------- o

Two parts. MARCHINGFACES walks through the voxels and collects the points. Joining goes from voxel
to voxel: what enters leaves. `isoref.fast.marching_faces` is the vectorised twin: the same points
in the same order, and the same curves.

Glossary
--------
k, I_P      a voxel, in C order over the cells; running count of points up to and including it
b           voxel configuration: the signs of `isoref.cube`, bit c is set where corner c is inside
f           a face, ``2 * axis + side``; also six bits, one a face
l           isolines of a face: its segments (e, e') of `isoref.cycles`, oriented, inside on the
            right for who looks at the face from outside the voxel
walk        corners and edges of a face, counterclockwise seen from outside (`FACE_CORNERS`,
            `FACE_EDGES`); an end of a line has its place on this walk
separated   on an ambiguous face: each line cuts off one *inside* corner, not an outside one
loop        the isolines of one surface around a voxel form loops: its cycles in `isoref.cycles`
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

from collections import defaultdict
from dataclasses import dataclass
from itertools import product
from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import linear_sum_assignment

from isoref import asymptotic_decider
from isoref.cube import (
    CORNERS,
    EDGE_OF,
    EDGES,
    FACE_CORNERS,
    FACE_EDGES,
    axis_of,
    inside,
    is_ambiguous,
)
from isoref.curves import Curve, check_pair, curves_through, follow, real_and_imaginary
from isoref.cycles import Polygon, cycles, segments
from isoref.field import Field, FieldError, Floats, Integers, least_inside

FaceRule = Literal["gradient", "middle", "asymptotic", "separated", "joined"]
Voxel = tuple[int, ...]
Line = tuple[int, int]
Place = tuple[int, float, float, float]


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
    edges : (P, 2) the edges of that voxel on which the two lines through the point start
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


@dataclass(frozen=True, eq=False)
class Isosurface:
    """One of the two surfaces: a scalar field, its isovalue, and the rule of ambiguous faces."""

    field: Field
    isovalue: float
    rule: FaceRule


class FaceLines(NamedTuple):
    """The isolines of one surface on a face of a voxel.

    d : (8) samples at the voxel's corners minus the isovalue
    b : the voxel's configuration
    lines : pairs of edges, inside on the right
    """

    d: list[float]
    b: int
    lines: list[Line]


class Crossing(NamedTuple):
    """Where two isolines cross on a face of a voxel.

    place : (3,) in coordinates of the voxel, 0 to 1
    leaves : whether the curve leaves the voxel here; else it enters
    edges : of the voxel, on which the two lines start
    """

    place: Floats
    leaves: bool
    edges: tuple[int, int]


class FacePoint(NamedTuple):
    """One row of `FacePoints`."""

    position: Floats
    tangent: Floats
    confidence: float
    voxel: int
    face: int
    heading: int
    edges: tuple[int, int]


# --------------------------------------------------------------------------------------------
# Table 4: the points
# --------------------------------------------------------------------------------------------


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
    rule : of the ambiguous faces. ``gradient``: lines run across the gradients at their ends, as
        the paper suggests; ``middle``: across the gradient in the middle of the face, which is
        worse than chance on random waves and kept to be compared; ``asymptotic``: the bilinear
        saddle value; ``separated`` or ``joined``: always so

    Raises
    ------
    FieldError
        where the fields are not scalar fields on one lattice, or there is no such rule.

    Notes
    -----
    A lattice with fewer than two samples along an axis has no voxels, hence no points. Positions
    carry the error of linear interpolation, of second order in the spacing.
    """
    one, two = isosurfaces(first, second, isovalues, rule)
    cells = number_of_cells(first)
    rows = []
    for k, voxel in enumerate(np.ndindex(cells)):
        # Choose the faces that both surfaces intersect, each face of the lattice once.
        b1, b2 = voxel_config(one, voxel), voxel_config(two, voxel)
        chosen = FACE_TABLE[b1] & FACE_TABLE[b2] & face_check(voxel, cells)
        for f in (f for f in range(6) if chosen >> f & 1):
            # Set up the isolines of both surfaces, and intersect them.
            l1, l2 = setup_lines(one, voxel, f), setup_lines(two, voxel, f)
            for crossing in intersect_lines(f, l1, l2):
                # Note the point, its tangent, and which way the curve goes.
                tangent, confidence = tangent_at(first, second, voxel, f, crossing.place)
                position = first.position(voxel + crossing.place)
                heading = 1 if crossing.leaves == (f % 2 == 1) else -1
                rows.append(FacePoint(position, tangent, confidence, k, f, heading, crossing.edges))
    return gathered(rows, cells)


def isosurfaces(
    first: Field, second: Field, isovalues: tuple[float, float], rule: FaceRule
) -> tuple[Isosurface, Isosurface]:
    """Both surfaces; raise FieldError unless they stand on one lattice and the rule is known."""
    check_pair(first, second, isovalues)
    if rule not in get_args(FaceRule):
        raise FieldError(f"no face rule {rule!r}; choose of {get_args(FaceRule)}")
    return Isosurface(first, isovalues[0], rule), Isosurface(second, isovalues[1], rule)


def number_of_cells(field: Field) -> tuple[int, int, int]:
    """The number of voxels along each axis.

    >>> number_of_cells(Field.of(np.zeros((4, 3, 1))))
    (3, 2, 0)
    """
    n1, n2, n3 = (n - 1 for n in field.shape)
    return n1, n2, n3


def face_table() -> tuple[int, ...]:
    """FaceTable: for each configuration b, six bits, one a face that has corners on both sides.

    Derived from the definition. It serves equation 2 with either sense of the inequality, since
    a face has both kinds of corners whichever kind is called inside.

    >>> table = face_table()
    >>> table[0], table[255], format(table[1], "06b"), table == table[::-1]
    (0, 0, '010101', True)
    """
    return tuple(
        sum(1 << f for f in range(6) if 0 < sum(inside(b, c) for c in FACE_CORNERS[f]) < 4)
        for b in range(256)
    )


FACE_TABLE = face_table()


def corner_values(surface: Isosurface, voxel: Voxel) -> list[float]:
    """The eight samples at the corners of a voxel, minus the isovalue."""
    samples = [surface.field.values[corner_index(voxel, c)] for c in range(8)]
    return [float(x) - surface.isovalue for x in samples]


def corner_index(voxel: Voxel, c: int) -> Voxel:
    """The lattice index of corner c of a voxel.

    >>> corner_index((4, 0, 1), 0b101)
    (5, 0, 2)
    """
    return tuple(i + offset for i, offset in zip(voxel, CORNERS[c], strict=True))


def voxel_config(surface: Isosurface, voxel: Voxel) -> int:
    """VOXELCONFIG (eq. 2) of one voxel: bit c is set where corner c is inside."""
    values = surface.field.values
    level = least_inside(values.dtype, surface.isovalue)
    return sum(1 << c for c in range(8) if values[corner_index(voxel, c)] >= level)


def face_check(voxel: Voxel, cells: tuple[int, ...]) -> int:
    """FACECHECK: six bits, one a face that the voxel owns, so that no face is visited twice.

    Faces 0, 2 and 4 always; 1, 3 and 5 only of the last voxel along their axis.

    >>> format(face_check((0, 4, 1), (5, 5, 5)), "06b")
    '011101'
    """
    return sum(1 << f for f in range(6) if f % 2 == 0 or voxel[f // 2] == cells[f // 2] - 1)


def setup_lines(surface: Isosurface, voxel: Voxel, f: int) -> FaceLines:
    """SETUPLINES: the isolines of a surface on face f of a voxel."""
    b = voxel_config(surface, voxel)
    lines = segments(b, f, is_separated(surface, voxel, f))
    return FaceLines(corner_values(surface, voxel), b, lines)


def is_separated(surface: Isosurface, voxel: Voxel, f: int) -> bool:
    """Whether the inside corners of face f are separated; False where that is no question."""
    if not is_ambiguous(voxel_config(surface, voxel), f):
        return False
    if surface.rule in ("separated", "joined"):
        return surface.rule == "separated"
    g = corner_values(surface, voxel)
    walk = FACE_CORNERS[f]

    # Ask the gradients; the order of the corners is the same from both sides of the face.
    if surface.rule in ("gradient", "middle"):
        order = sorted(walk)
        within = [axis for axis in range(3) if axis != f // 2]
        slopes = [gradient(surface.field, corner_index(voxel, c))[within] for c in order]
        d, h = np.array([[g[c]] for c in order]), np.array(surface.field.spacing)[within]
        against = GRADIENT_RULES[surface.rule](d, np.array(slopes)[:, None], h)[0]
        if against != 0:
            return bool((against < 0) == (g[order[0]] >= 0))

    # Ask the bilinear saddle.
    return bool(asymptotic_decider.separated(*np.array([[g[c]] for c in walk]))[0])


def across_at_ends(d: Floats, g: Floats, h: Floats) -> Floats:
    """(n,) how much worse lines that cut off corners 0 and 3 of a face run across the gradients.

    The four points p_j stand on the edges of the face; the gradient at each is interpolated
    between the two corners of its edge (section 6: "the interpolated gradient orientation can be
    used to deterministically determine the best choice"). An isoline runs across the gradient. Of
    the two ways to join the points, each is charged with the cosine between a line and the gradient
    at its end, over its four ends. Negative: lines that cut off corners 0 and 3 fit better.

    Parameters
    ----------
    d : (4, n) samples minus the isovalue at the corners (0, 0), (1, 0), (0, 1), (1, 1) of n
        ambiguous faces
    g : (4, n, 2) gradients there, along the two axes of the face
    h : (2,) spacing along them

    >>> d = np.array([[1.0], [-1.0], [-1.0], [1.0]])
    >>> ridge = np.array([[[1.0, -1.0]]] * 4)  # along the diagonal from (0, 0) to (1, 1)
    >>> across_at_ends(d, ridge, np.ones(2)).round(3).tolist()
    [4.0]
    """
    # Place the points p_j on the edges, with their gradients.
    ends: dict[tuple[int, int], tuple[Floats, Floats]] = {}
    place = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]) * h
    for a, b in ((0, 1), (2, 3), (0, 2), (1, 3)):
        # Halve, so that the difference of two large values stays finite.
        low, fall = d[a] / 2, d[a] / 2 - d[b] / 2
        t = np.divide(low, fall, out=np.zeros_like(low), where=fall != 0)[:, None]
        ends[a, b] = place[a] + t * (place[b] - place[a]), units((1 - t) * g[a] + t * g[b])

    def charge(one: tuple[int, int], other: tuple[int, int]) -> Floats:
        """The cosines at both ends of the line that joins two points."""
        (p, u), (q, v) = ends[one], ends[other]
        along = units(q - p)
        first = np.abs(u[:, 0] * along[:, 0] + u[:, 1] * along[:, 1])
        return np.asarray(first + np.abs(v[:, 0] * along[:, 0] + v[:, 1] * along[:, 1]))

    # Charge both ways to join them.
    outer = charge((0, 1), (0, 2)) + charge((1, 3), (2, 3))
    inner = charge((0, 1), (1, 3)) + charge((0, 2), (2, 3))
    return np.asarray(outer - inner)


def across_in_the_middle(d: Floats, g: Floats, h: Floats) -> Floats:
    """(n,) the same by the gradient in the middle of the face, the mean of those at its corners.

    If it points more along one diagonal, lines run across that diagonal. This is the same as to
    compare the value in the middle of the face with that at the saddle.

    >>> g = np.array([[[1.0, 2.0]], [[1.0, 2.0]], [[1.0, 2.0]], [[1.0, 2.0]]])
    >>> across_in_the_middle(np.zeros((4, 1)), g, np.ones(2)).tolist()
    [-0.5]
    """
    middle = units((((g[0] + g[1]) + g[2]) + g[3]) / 4, largest=True)
    return np.asarray(-middle[:, 0] * middle[:, 1])


GRADIENT_RULES = {"gradient": across_at_ends, "middle": across_in_the_middle}


def units(vectors: Floats, largest: bool = False) -> Floats:
    """Vectors (n, k) at length 1, of any magnitude; those of length 0 stay as they are.

    With `largest` they are scaled by their largest component, which costs no rounding of equals.

    >>> units(np.array([[3e200, 4e200], [3e-320, 0.0], [0.0, 0.0]])).tolist()
    [[0.6, 0.8], [1.0, 0.0], [0.0, 0.0]]
    """
    # Scale by the largest component first: squares of large or tiny numbers do not fit a float.
    size = np.abs(vectors).max(axis=-1, keepdims=True, initial=0.0)
    scaled = np.divide(vectors, size, out=np.zeros_like(vectors), where=size > 0)
    if largest:
        return np.asarray(scaled)
    length = np.sqrt((scaled**2).sum(axis=-1, keepdims=True))
    return np.asarray(np.divide(scaled, length, out=np.zeros_like(vectors), where=length > 0))


def gradient(field: Field, index: Voxel) -> Floats:
    """(3,) the gradient at a sample: central differences, one-sided at the border (eq. 4)."""
    result = np.zeros(3)
    for axis in range(3):
        above, below = list(index), list(index)
        above[axis] = min(index[axis] + 1, field.shape[axis] - 1)
        below[axis] = max(index[axis] - 1, 0)
        # Halve, so that the difference of two large values stays finite.
        half = float(field.values[tuple(above)]) / 2 - float(field.values[tuple(below)]) / 2
        result[axis] = half / ((above[axis] - below[axis]) * field.spacing[axis] / 2)
    return result


def intersect_lines(f: int, one: FaceLines, two: FaceLines) -> list[Crossing]:
    """INTERSECTLINES: where the isolines of two surfaces cross on face f of a voxel.

    All ends of lines are sorted as the walk around the face meets them. A line crosses another
    where exactly one end of the other lies between its own start and its own end. The walk from
    its start to its end passes on its right, the inside: where the other line starts there, it
    crosses to the left, and the curve leaves the voxel.
    """
    # Number the ends in the order of the walk.
    ends = [(number, e) for number in (0, 1) for line in (one, two)[number].lines for e in line]
    ends.sort(key=lambda end: place_on_walk(f, end[1], (one, two)[end[0]], end[0]))
    rank = {end: n for n, end in enumerate(ends)}

    # Compare each line of one with each of the other.
    found = []
    for a, b in product(one.lines, two.lines):
        start, stop = rank[0, a[0]], rank[0, a[1]]
        length = (stop - start) % len(ends)
        starts_right, ends_right = ((rank[1, e] - start) % len(ends) < length for e in b)
        if starts_right != ends_right:
            place = crossing_point(f, line_ends(a, one.d), line_ends(b, two.d))
            found.append(Crossing(place, starts_right, (a[0], b[0])))
    return found


def place_on_walk(f: int, e: int, own: FaceLines, number: int) -> Place:
    """The key that sorts ends of lines along the walk around face f.

    The edge; on it the position; where both surfaces cross at one position, the shift of the
    crossing when the isovalue falls; and if that is the same, the number of the surface, 0 or 1.
    """
    i = FACE_EDGES[f].index(e)
    low, high = EDGES[e]
    rise = own.d[high] - own.d[low]
    # Samples that a float cannot tell apart rise where the upper one is inside.
    endless = np.inf if inside(own.b, low) else -np.inf
    shift = -1 / rise if rise else endless
    first = 0.0 if number else float(np.sign(shift))
    t = parameter(e, own.d)
    upward = FACE_CORNERS[f][i] == low
    return (i, t, shift, first) if upward else (i, -t, -shift, -first)


def parameter(e: int, d: list[float]) -> float:
    """Where edge e is crossed, from 0 at its lower end to 1, for values d (8) at the corners."""
    low, high = (d[c] for c in EDGES[e])
    return low / (low - high) if low != high else 0.0


def line_ends(line: Line, d: list[float]) -> Floats:
    """(2, 3) the ends of an isoline in coordinates of the voxel."""
    ends = np.array([CORNERS[EDGES[e][0]] for e in line], np.float64)
    for end, e in zip(ends, line, strict=True):
        end[axis_of(e)] = parameter(e, d)
    return ends


def crossing_point(f: int, a: Floats, b: Floats) -> Floats:
    """(3,) where segments a and b (2, 3) of face f, known to cross, do so.

    Each segment is met within its ends, in its middle where rounding leaves them parallel; the
    mean of the two places is the same whichever surface is called the first.
    """
    return np.asarray((_meet(f, a, b) + _meet(f, b, a)) / 2)


def _meet(f: int, a: Floats, b: Floats) -> Floats:
    """The point of segment a on the line of segment b."""
    u, v = (axis for axis in range(3) if axis != f // 2)
    da, db, gap = a[1] - a[0], b[1] - b[0], b[0] - a[0]
    det = da[u] * db[v] - da[v] * db[u]
    s = (gap[u] * db[v] - gap[v] * db[u]) / det if det else 0.5
    return np.asarray(a[0] + min(max(s, 0.0), 1.0) * da)


def tangent_at(
    first: Field, second: Field, voxel: Voxel, f: int, place: Floats
) -> tuple[Floats, float]:
    """The unit tangent (3,) at a place on face f of a voxel, and the confidence in it.

    Along the cross product of the unit gradients, which are bilinear on the face; its length is
    the confidence, and the tangent is 0 where it is 0.
    """
    normals = []
    for field in (first, second):
        total = np.zeros(3)
        for c in sorted(FACE_CORNERS[f]):
            total += corner_weight(f, c, place) * gradient(field, corner_index(voxel, c))
        normals.append(units(total[None])[0])
    cross = np.cross(normals[0], normals[1])
    return units(cross[None])[0], min(float(np.linalg.norm(cross)), 1.0)


def corner_weight(f: int, c: int, place: Floats) -> float:
    """The weight of corner c in the bilinear interpolant of face f."""
    u, v = (place[a] if CORNERS[c][a] else 1 - place[a] for a in range(3) if a != f // 2)
    return float(u * v)


def gathered(rows: list[FacePoint], cells: tuple[int, int, int]) -> FacePoints:
    """The rows as arrays, one a column."""
    return FacePoints(
        positions=np.array([row.position for row in rows], np.float64).reshape(-1, 3),
        tangents=np.array([row.tangent for row in rows], np.float64).reshape(-1, 3),
        confidence=np.array([row.confidence for row in rows], np.float64),
        voxels=np.array([row.voxel for row in rows], np.int64),
        faces=np.array([row.face for row in rows], np.int64),
        headings=np.array([row.heading for row in rows], np.int64),
        edges=np.array([row.edges for row in rows], np.int64).reshape(-1, 2),
        cells=cells,
    )


# --------------------------------------------------------------------------------------------
# Joining the points to curves
# --------------------------------------------------------------------------------------------


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
        for chain, closed in join(points, *isosurfaces(first, second, isovalues, rule))
        for curve in curves_through(points.positions[chain], closed)
    ]


def nodal_lines(psi: ArrayLike, spacing: ArrayLike | None = None) -> list[Curve]:
    """The curves on which a complex field is ``0 + 0i``, each with the phase turning around it.

    Parameters
    ----------
    psi : (N1, N2, N3) complex samples
    spacing : one number, or one an axis; 1 by default

    Raises
    ------
    FieldError
        for samples that are no volume, or not finite.

    >>> x, y, z = np.meshgrid(*[np.linspace(-1, 1, 6)] * 3, indexing="ij")
    >>> nodal_lines(x + 1j * y)[0].points[[0, -1]].round(12).tolist()
    [[2.5, 2.5, 0.0], [2.5, 2.5, 5.0]]
    """
    return intersection_curves(*real_and_imaginary(psi, spacing))


def join(points: FacePoints, one: Isosurface, two: Isosurface) -> list[tuple[Integers, bool]]:
    """The points in order along their curves, by index, and whether each curve is closed.

    In a voxel with one point in and one point out there is nothing to choose. With more, only
    points on the same loop of either surface around the voxel are joined, and among those the
    choice of least total length.
    """
    # Note for each voxel the points that enter it and those that leave it, by their loops.
    Groups = dict[tuple[Polygon, ...], tuple[list[int], list[int]]]
    groups: dict[Voxel, Groups] = defaultdict(lambda: defaultdict(lambda: ([], [])))
    for n in range(len(points)):
        owner, across = voxels_beside(points, n)
        outward = points.headings[n] == (1 if points.faces[n] % 2 else -1)
        for voxel, leaves in ((owner, outward), (across, not outward)):
            if voxel is not None:
                edges = points.edges[n].tolist()
                if voxel != owner:
                    edges = [edge_across(e, int(points.faces[n]) // 2) for e in edges]
                loops = (loop_of(one, voxel, edges[0]), loop_of(two, voxel, edges[1]))
                groups[voxel][loops][int(leaves)].append(n)

    # Join what enters to what leaves.
    successor = np.full(len(points), -1)
    for by_loops in groups.values():
        for into, out in by_loops.values():
            gaps = points.positions[into][:, None] - points.positions[out][None]
            row, column = linear_sum_assignment(np.linalg.norm(gaps, axis=2))
            successor[np.array(into)[row]] = np.array(out)[column]
    return follow(successor)


def voxels_beside(points: FacePoints, n: int) -> tuple[Voxel, Voxel | None]:
    """The voxel that owns the face of point n, and the one across it; None beyond the lattice."""
    owner = tuple(int(i) for i in np.unravel_index(points.voxels[n], points.cells))
    axis, side = divmod(int(points.faces[n]), 2)
    if side == 1 or owner[axis] == 0:
        return owner, None
    return owner, tuple(i - (a == axis) for a, i in enumerate(owner))


def edge_across(e: int, axis: int) -> int:
    """The number that edge e of a face has in the voxel on the other side of that face.

    >>> edge_across(0, 1), edge_across(1, 1)
    (1, 0)
    """
    return EDGE_OF[frozenset(c ^ 1 << axis for c in EDGES[e])]


def loop_of(surface: Isosurface, voxel: Voxel, e: int) -> Polygon:
    """The loop of a surface around a voxel that passes edge e."""
    separated = sum(1 << f for f in range(6) if is_separated(surface, voxel, f))
    loops = cycles(voxel_config(surface, voxel), separated)
    return next(loop for loop in loops if e in loop)
