"""VESTA: surfaces of a 3-D field, grown from the faces of voxels.

A sample stands at the centre of a voxel, and a voxel is *active* when its value is at least the
isovalue. The faces between active and inactive voxels already enclose the active ones without a
gap. VESTA draws the same eight small vectors on each of these faces, connects all of them over
the whole volume at once, and reads the surface off the closed cycles they form. It needs no table
and looks at no 2 x 2 x 2 cell; that each cycle stays within one is a result (section II.C).

Three steps, in the order of the code: find the boundary faces, follow the paths from face to face
until they close, move the faces' centres to where the field takes the isovalue. Cutting the cycles
into triangles comes last. `isoref.fast.vesta` is the vectorised twin: the same numbers.

Glossary
--------
voxel       the unit cube round a sample; v, w, p, q below are voxels
r           range direction, from an active voxel to its inactive neighbour across a boundary
            face: 0 .. 5 for +i, -i, +j, -j, +k, -k; ``r ^ 1`` is the opposite one
support     the point of the surface a boundary face carries: its centre, later moved along the
point       range vector to where the field takes the isovalue
juncture    the middle of an edge of a boundary face, named by the direction d from the centre
face        (v, r): the face of an active voxel v towards its inactive neighbour v + r
path        two voxel face vectors, juncture - centre - juncture, round one quarter of a face
POA         point of ambiguity: a juncture where four boundary faces meet, because two active
            voxels share no more than an edge
N-cycle     closed chain of N paths; without its junctures, an oriented polygon of N points

A face has its junctures numbered counterclockwise round its range vector, and four paths, each
from one juncture to the one before it (Fig. 2b)::

        +----2----+        4 -> 3
        |    |    |        3 -> 2
        3----o----1        2 -> 1          r points at the reader
        |    |    |        1 -> 4
        +----4----+

At juncture d of the face (v, r) four voxels meet: v (active), w = v + r (inactive), p = v + d
and q = w + d. The path goes on over the face (Figs. 3 and 6)::

      w | q      in plane   p active, q inactive     (p, r), which it enters at -d
     ---+---     convex     neither active           (v, d), which it enters at r
      v | p      concave    both active              (q, -d), which it enters at -r
                 POA        q active, p inactive     convex to disconnect, concave to connect

Invariants
----------
The successor of a path is a permutation of all paths, so cycles are closed and cover each path
once; two neighbouring points of a cycle are neighbours the other way round in another cycle: the
surface is closed and oriented, with right-hand normals from active to inactive. A cycle has 3 to
7 points, in mixed mode also 8, 9 or 12.

References
----------
[1] B. R. Schlei, "Volume-Enclosing Surface Extraction". Sections II.B and II.C, Figs. 2 to 7 (the
    algorithm), II.D, Figs. 8, 9 and 14 (triangles), II.E, Figs. 10 to 13 (mixed mode), III.B
    (displacement, the average at a POA).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise, product
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from isoref.cycles import Triangle, fan
from isoref.diconex import Border, Mode, as_field, check_choice, connects
from isoref.field import Field, FieldError, Floats, Integers, check_isovalue, inside_samples
from isoref.mesh import Mesh, Provenance, in_space
from isoref.sweep import crossing_parameter

Resolution = Literal["L", "H"]
Voxel = tuple[int, int, int]
Face = tuple[Voxel, int]
Path = tuple[Voxel, int, int]
Cycles = dict[int, Integers]

SIX_SURFACES: tuple[tuple[Mode, Resolution], ...] = tuple(
    product(get_args(Mode), get_args(Resolution))
)
DIRECTIONS = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)])


def _number(direction: Integers) -> int:
    """The r with ``DIRECTIONS[r] == direction``."""
    return int(np.flatnonzero((direction == DIRECTIONS).all(axis=1))[0])


def _junctures(r: int) -> list[int]:
    """The four directions from the centre of a face, counterclockwise round r."""
    around = [next(d for d in range(6) if d // 2 != r // 2)]
    while len(around) < 4:
        around.append(_number(np.cross(DIRECTIONS[r], DIRECTIONS[around[-1]])))
    return around


#: (6, 4) direction of juncture k of a face with range direction r.
JUNCTURES = np.array([_junctures(r) for r in range(6)])
#: (6, 6) the k of a juncture in direction d, -1 along the range vector itself.
RANK = np.array([[_junctures(r).index(d) if d // 2 != r // 2 else -1 for d in range(6)]
                 for r in range(6)])  # fmt: skip


@dataclass(frozen=True, eq=False)
class Surface:
    """Support points and the oriented cycles through them.

    Attributes
    ----------
    points : (V, 3) positions of the support points, shared by all cycles
    centres : (V, 3) their unmoved places, twice the index: one odd coordinate each
    cycles : N -> (n, N) rows of point numbers, each row begun at its smallest
    """

    points: Floats
    centres: Integers
    cycles: Cycles

    @property
    def lengths(self) -> dict[int, int]:
        """N -> how many N-cycles there are."""
        return {length: len(rows) for length, rows in self.cycles.items()}

    def mesh(self, resolution: Resolution = "L") -> Mesh:
        """The cycles cut into triangles, section II.D.

        Parameters
        ----------
        resolution : ``"L"`` adds no point to a cycle of up to seven; ``"H"`` adds the average of
            its points to every cycle of more than three. Cycles of 8, 9 and 12 always take their
            average: most of them cannot do without (see `fan_start`), and Table III's counts
            imply it.

        Raises
        ------
        ValueError
            for another resolution.
        """
        check_choice("resolution", resolution, get_args(Resolution))
        vertices = list(self.points)
        triangles: list[Triangle] = []
        for length, rows in self.cycles.items():
            for row in rows.tolist():
                if length > 7 or (resolution == "H" and length > 3):
                    # Join each side of the polygon to the average of its points.
                    triangles += fan(tuple(row), len(vertices))
                    vertices.append(self.points[row].mean(axis=0))
                else:
                    # Join each side to one of its points.
                    start = fan_start(self.centres[row])
                    first, *others = row[start:] + row[:start]
                    triangles += [(first, a, b) for a, b in pairwise(others)]
        if not triangles:
            return Mesh(self.points, np.empty((0, 3), np.int64))
        return Mesh.of(vertices, triangles)

    @cached_property
    def normals(self) -> dict[int, Floats]:
        """N -> (n, 3) the sum of the outward normals of a cycle's triangles, eq. 1.

        In the square of the points' unit: a normal is as long as its triangle's area. Half the sum
        of the cross products of neighbours is the same for every way to cut the cycle into
        triangles, so it needs none.
        """
        sums = {}
        for length, rows in self.cycles.items():
            spokes = [[self.points[i] - self.points[row[0]] for i in row] for row in rows]
            sums[length] = np.array(
                [
                    0.5 * sum((np.cross(a, b) for a, b in pairwise(cycle)), np.zeros(3))
                    for cycle in spokes
                ]
            )
        return sums


@in_space
def vesta(
    values: ArrayLike | Field,
    isovalue: float,
    *,
    mode: Mode = "mixed",
    resolution: Resolution = "L",
    border: Border = "open",
    displaced: bool = True,
    provenance: bool = False,
) -> Mesh:
    """The VESTA surface of a field as triangles, normals from active to inactive.

    Parameters and errors are those of `extract`; `resolution` is that of `Surface.mesh`, and with
    `provenance`, for which the border must be open, the mesh has its `isoref.mesh.Provenance`.

    >>> vesta(np.ones((1, 1, 1)), 0.5, border="closed")
    Mesh(6 vertices in R^3, 8 simplices of dimension 2)
    """
    surface = extract(values, isovalue, mode=mode, border=border, displaced=displaced)
    mesh = surface.mesh(resolution)
    if not provenance:
        return mesh
    return replace(mesh, provenance=provenance_of(surface, resolution, as_field(values, 3)))


def provenance_of(surface: Surface, resolution: Resolution, field: Field) -> Provenance:
    """Where the support points and averages of a surface's mesh, and its triangles, come from.

    Raises
    ------
    FieldError
        where a point lies beyond the samples, as with a closed border: it is on no lattice edge.
    """
    # A support point lies between the samples on both sides of its face.
    low, across = np.divmod(surface.centres, 2)
    if (low < 0).any() or (low + across >= field.shape).any():
        raise FieldError("with a closed border there are points that lie on no edge of the lattice")
    ends = np.stack(
        [np.ravel_multi_index(tuple(end.T), field.shape) for end in (low, low + across)]
    )
    along = ((field.index(surface.points) - low) * across).sum(axis=1)

    # A cycle lies in one cell, and so does its average.
    shape = tuple(n - 1 for n in field.shape)
    cells, inner = [np.empty(0, np.int64)], [np.empty(0, np.int64)]
    for length, rows in surface.cycles.items():
        lowest = tuple(low[rows].min(axis=1).T)
        spokes = length > 7 or (resolution == "H" and length > 3)
        triangles = length if spokes else length - 2
        cells.append(np.repeat(np.ravel_multi_index(lowest, shape), triangles))
        if spokes:
            inner.append(np.ravel_multi_index(lowest, field.shape))
    corners = np.concatenate(inner)
    averages = np.stack([corners, np.full(len(corners), -1)], axis=1)
    t = np.concatenate([along, np.full(len(corners), np.nan)])
    pairs = np.concatenate([ends.T, averages])
    return Provenance(pairs, t, np.concatenate(cells), field)


def extract(
    values: ArrayLike | Field,
    isovalue: float,
    *,
    mode: Mode = "mixed",
    border: Border = "open",
    displaced: bool = True,
) -> Surface:
    """The cycles round the voxels whose value is at least `isovalue`.

    Parameters
    ----------
    values : (N1, N2, N3) array or a `Field` of dimension 3
    isovalue : in the unit of the samples
    mode : at a point of ambiguity, keep the active voxels apart, join them, or (``"mixed"``)
        join them where the average of the four voxels is active
    border : ``"open"`` drops the cycles that reach beyond the outermost samples; ``"closed"``
        takes everything outside the volume as inactive, and leaves the points between a border
        voxel and the outside where they are, half a voxel out
    displaced : False leaves every point at the centre of its face, the perfect surface of
        Fig. 28f

    Raises
    ------
    FieldError
        for a field that is not scalar and three-dimensional, or an isovalue that is not finite.
    ValueError
        for an unknown mode or border.

    >>> two = np.zeros((2, 2, 1)); two[0, 0] = two[1, 1] = 1
    >>> extract(two, 0.5, mode="disconnect", border="closed").lengths
    {3: 16}
    >>> extract(two, 0.5, mode="connect", border="closed").lengths
    {3: 12, 6: 2}
    """
    # Find the boundary faces of the active voxels, section II.B.
    field, alpha = as_field(values, 3), check_isovalue(isovalue)
    check_choice("mode", mode, get_args(Mode))
    check_choice("border", border, get_args(Border))
    inside = inside_samples(field, alpha)
    grey = {v: float(field.values[v]) - alpha for v in voxels(field.shape)}
    active = {v for v in grey if inside[v]}
    faces = [(v, r) for v in active for r in range(6) if neighbour(v, r) not in active]
    faces.sort(key=lower_voxel_and_axis)

    # Follow the paths, section II.C.
    cycles = trace(faces, active, grey, mode)

    # Leave out the cycles that reach beyond the samples.
    if border == "open":
        inner = {face for face in faces if neighbour(*face) in grey}
        cycles = [cycle for cycle in cycles if inner.issuperset(cycle)]
        faces = [face for face in faces if face in inner]

    # Place the points, and gather the cycles by length.
    places = [place(face, grey) if displaced else centre(face) / 2 for face in faces]
    number = {face: n for n, face in enumerate(faces)}
    rows = [[number[face] for face in cycle] for cycle in cycles]
    return Surface(
        field.position(np.array(places).reshape(-1, 3)),
        np.array([centre(face) for face in faces], np.int64).reshape(-1, 3),
        {
            length: np.array([row for row in rows if len(row) == length], np.int64)
            for length in sorted({len(row) for row in rows})
        },
    )


def voxels(shape: tuple[int, ...]) -> Iterator[Voxel]:
    """The index of each voxel, in C order.

    >>> list(voxels((1, 2, 1)))
    [(0, 0, 0), (0, 1, 0)]
    """
    n1, n2, n3 = shape
    return product(range(n1), range(n2), range(n3))


def neighbour(v: Voxel, d: int) -> Voxel:
    """The voxel one step from v in direction d.

    >>> neighbour((4, 4, 4), 3)
    (4, 3, 4)
    """
    i, j, k = DIRECTIONS[d].tolist()
    return (v[0] + i, v[1] + j, v[2] + k)


def centre(face: Face) -> Integers:
    """(3,) the centre of a face, twice its index."""
    v, r = face
    doubled: Integers = 2 * np.array(v) + DIRECTIONS[r]
    return doubled


def lower_voxel_and_axis(face: Face) -> tuple[Voxel, int]:
    """The key that orders faces: the lower of the two voxels at the face, and the face's axis."""
    v, r = face
    return min(v, neighbour(v, r)), r // 2


def trace(
    faces: list[Face], active: set[Voxel], grey: dict[Voxel, float], mode: Mode
) -> list[list[Face]]:
    """The closed cycles as lists of faces, each begun at its first path, in order of these.

    Each face has four paths, and each path is on one cycle: so follow any path that is left over
    until it comes back.
    """
    waiting = {(v, r, k) for v, r in faces for k in range(4)}
    cycles = []
    for path in ((v, r, k) for v, r in faces for k in range(4)):
        cycle = []
        while path in waiting:
            waiting.remove(path)
            v, r, _ = path
            cycle.append((v, r))
            path = successor(path, active, grey, mode)
        if cycle:
            cycles.append(cycle)
    return cycles


def successor(path: Path, active: set[Voxel], grey: dict[Voxel, float], mode: Mode) -> Path:
    """The path (v, r, k) that follows a path; see the table in the module's text.

    Path k of a face begins at its juncture k + 1 and ends at its juncture k. `grey` has the values
    minus the isovalue.
    """
    # Look at the four voxels at the juncture where the path ends.
    v, r, k = path
    d = int(JUNCTURES[r, k])
    w, p = neighbour(v, r), neighbour(v, d)
    q = neighbour(w, d)

    # Choose the face on which to go on, and the juncture at which it is entered.
    in_plane, convex, concave = (p, r, d ^ 1), (v, d, r), (q, d ^ 1, r ^ 1)
    if p in active:
        voxel, face, entry = concave if q in active else in_plane
    elif q not in active:
        voxel, face, entry = convex
    else:
        # Decide the point of ambiguity.
        joined = connects(mode, *(grey[voxel] for voxel in (v, q, w, p)))
        voxel, face, entry = concave if joined else convex

    # Take the path of that face which begins there.
    return voxel, face, int(RANK[face, entry] - 1) % 4


def place(face: Face, grey: dict[Voxel, float]) -> Floats:
    """(3,) the index of a face's support point, where the field takes the isovalue (Fig. 2d).

    A face on the border of the volume has no value on its outer side, and keeps its centre.
    """
    lower, axis = lower_voxel_and_axis(face)
    upper = neighbour(lower, 2 * axis)
    if lower not in grey or upper not in grey:
        return np.asarray(centre(face) / 2)
    t = crossing_parameter(np.array([grey[lower]]), np.array([grey[upper]]))
    return np.asarray(np.array(lower) + t * DIRECTIONS[2 * axis])


def fan_start(centres: Integers) -> int:
    """Where in its cycle a fan of triangles may start, for (N, 3) doubled centres.

    The first point from which no chord is short. A chord of at most one voxel between unmoved
    points joins two faces of one voxel edge: it lies in the square of the four voxels round that
    edge, where another cycle may run along it, and the edge would then have four triangles. Every
    cycle of up to seven points has such a start; no 9- or 12-cycle has.

    Raises
    ------
    ValueError
        where no point of the cycle will do.
    """
    N = len(centres)
    for first in range(N):
        chords = [centres[(first + i) % N] - centres[first] for i in range(2, N - 1)]
        if all(chord @ chord > 4 for chord in chords):
            return first
    raise ValueError(f"a cycle of {N} points has no fan without a short chord")
