"""VESTA: surfaces of a 3-D field, grown from the faces of voxels.

A sample stands at the centre of a voxel, and a voxel is *active* when its value is at least the
isovalue. The faces between active and inactive voxels already enclose the active ones without a
gap. VESTA draws the same eight small vectors on each of these faces, connects all of them over
the whole volume at once, and reads the surface off the closed cycles they form. It needs no table
and looks at no 2 x 2 x 2 cell; that each cycle stays within one is a result (section II.C).

Glossary
--------
voxel       the unit cube round a sample; v, w, p, q below are voxels
r           range direction, from an active voxel to its inactive neighbour across a boundary
            face: 0 .. 5 for +i, -i, +j, -j, +k, -k; ``r ^ 1`` is the opposite one
support     the point of the surface a boundary face carries: its centre, later moved along the
point       range vector to where the field takes the isovalue
juncture    the middle of an edge of a boundary face, named by the direction d from the centre
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
1. B. R. Schlei, "Volume-Enclosing Surface Extraction". Sections II.B and II.C, Figs. 2 to 7 (the
   algorithm), II.D, Figs. 8, 9 and 14 (triangles), II.E, Figs. 10 to 13 (mixed mode), III.B
   (displacement, the average at a POA).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from isoref.diconex import (
    Border,
    Mode,
    as_field,
    average_is_active,
    between,
    check_choice,
    connects,
    framed,
)
from isoref.field import Array, Booleans, Field, Floats, Integers
from isoref.mesh import Mesh

Resolution = Literal["L", "H"]
Voxel = tuple[int, int, int]
Face = tuple[Voxel, int]
Cycles = dict[int, Integers]
Decide = Callable[[Integers, Integers, Integers, Integers], Booleans]

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

        ``"L"`` adds no point to a cycle of up to seven; ``"H"`` adds the average of its points to
        every cycle of more than three. Cycles of 8, 9 and 12 always take their average: most of
        them cannot do without (see `fan_start`), and Table III's counts imply it.
        """
        check_choice("resolution", resolution, get_args(Resolution))
        vertices, triangles = [self.points], [np.empty((0, 3), np.int64)]
        count = len(self.points)
        for length, rows in self.cycles.items():
            if length > 7 or (resolution == "H" and length > 3):
                vertices.append(self.points[rows].mean(axis=1))
                triangles.append(_spokes(rows, count))
                count += len(rows)
            else:
                triangles.append(_fan(rows, fan_start(self.centres[rows])))
        return Mesh.of(np.concatenate(vertices), np.concatenate(triangles))

    @cached_property
    def normals(self) -> dict[int, Floats]:
        """N -> (n, 3) the sum of the outward normals of a cycle's triangles, eq. 1.

        Half the sum of the cross products of neighbours: it is the same for every way to cut the
        cycle into triangles, so it needs none.
        """
        sums = {}
        for length, rows in self.cycles.items():
            spoke = self.points[rows] - self.points[rows[:, :1]]
            sums[length] = 0.5 * np.cross(spoke, np.roll(spoke, -1, axis=1)).sum(axis=1)
        return sums


def vesta(
    values: ArrayLike | Field,
    isovalue: float,
    *,
    mode: Mode = "mixed",
    resolution: Resolution = "L",
    border: Border = "open",
    displaced: bool = True,
) -> Mesh:
    """The VESTA surface of a field as triangles.

    Parameters are those of `extract`; `resolution` is that of `Surface.mesh`.

    >>> vesta(np.ones((1, 1, 1)), 0.5, border="closed")
    Mesh(6 vertices in R^3, 8 simplices of dimension 2)
    """
    return extract(values, isovalue, mode=mode, border=border, displaced=displaced).mesh(resolution)


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
    field, alpha, active = framed(values, isovalue, 3, mode, border)
    faces = Faces.of(active)
    successor = successors(faces, active, _decider(mode, field.values, alpha))
    cycles = {length: paths // 4 for length, paths in cycles_of(successor).items()}
    surface = Surface(_points(faces, field, alpha, displaced), faces.centres, cycles)
    return surface if border == "closed" else _without(surface, faces.outer)


@dataclass(frozen=True, eq=False)
class Faces:
    """The boundary faces of the active voxels, in the order of their lower voxel and axis.

    Voxels are named by their flat index in the framed volume.

    Attributes
    ----------
    shape : of the framed volume
    keys : (F,) three times the lower of the face's two voxels, plus the axis; ascending
    voxel : (F,) the active voxel
    direction : (F,) the range direction r
    """

    shape: tuple[int, ...]
    keys: Integers
    voxel: Integers
    direction: Integers

    @classmethod
    def of(cls, active: Booleans) -> Faces:
        """All boundary faces of a framed volume, section II.B."""
        flat = active.ravel()
        keys = np.sort(np.concatenate([_crossings(flat, a, active.shape) for a in range(3)]))
        lower, axis = np.divmod(keys, 3)
        upward = flat[lower]
        step = strides(active.shape)
        voxel = np.where(upward, lower, lower + step[2 * axis])
        return cls(active.shape, keys, voxel, 2 * axis + ~upward)

    def find(self, voxel: Integers, direction: Integers) -> Integers:
        """The numbers of the faces of these voxels in these directions, which must exist."""
        lower = voxel + np.minimum(strides(self.shape), 0)[direction]
        return np.searchsorted(self.keys, 3 * lower + direction // 2)

    @cached_property
    def centres(self) -> Integers:
        """(F, 3) the centres, twice the index in the volume without its frame."""
        doubled: Integers = 2 * self.indices(self.voxel) + DIRECTIONS[self.direction]
        return doubled

    @cached_property
    def outer(self) -> Booleans:
        """(F,) whether the inactive voxel lies in the frame."""
        top = 2 * np.array(self.shape) - 5
        outside: Booleans = np.any((self.centres < 0) | (self.centres >= top), axis=1)
        return outside

    def indices(self, voxel: Integers) -> Integers:
        """(.., 3) the index of each voxel in the volume without its frame."""
        i, j, k = np.unravel_index(voxel, self.shape)
        return np.stack([i - 1, j - 1, k - 1], axis=-1)


def _crossings(flat: Booleans, axis: int, shape: tuple[int, ...]) -> Integers:
    """The keys of the faces across one axis.

    Whatever wraps round from the end of one row to the start of the next is frame and frame.
    """
    step = strides(shape)[2 * axis]
    return 3 * np.flatnonzero(flat[:-step] != flat[step:]) + axis


def strides(shape: tuple[int, ...]) -> Integers:
    """(6,) what to add to a flat index to go one voxel in each direction.

    >>> strides((9, 4, 10))
    array([ 40, -40,  10, -10,   1,  -1])
    """
    steps: Integers = DIRECTIONS @ [shape[1] * shape[2], shape[2], 1]
    return steps


def successors(faces: Faces, active: Booleans, decide: Decide) -> Integers:
    """(4 F,) the path that follows each path, a permutation.

    Path ``4 f + k`` lies on face f, begins at juncture k + 1 and ends at juncture k.
    """
    successor = np.empty((len(faces.keys), 4), np.int64)
    for k in range(4):
        face, juncture = _across(faces, JUNCTURES[faces.direction, k], active.ravel(), decide)
        # Go on along the path that begins at the juncture.
        path = (RANK[faces.direction[face], juncture] - 1) % 4
        successor[:, k] = 4 * face + path
    return successor.ravel()


def _across(
    faces: Faces, d: Integers, active: Booleans, decide: Decide
) -> tuple[Integers, Integers]:
    """The face met at juncture d of each face, and the juncture's direction seen from there."""
    v, r, step = faces.voxel, faces.direction, strides(faces.shape)
    w, p = v + step[r], v + step[d]
    q = w + step[d]
    concave, flat = active[q], active[p]
    # Settle the points of ambiguity: the voxels v and q touch in an edge alone.
    poa = np.flatnonzero(concave & ~flat)
    concave[poa] = decide(v[poa], q[poa], w[poa], p[poa])
    flat &= ~concave
    voxel = np.where(concave, q, np.where(flat, p, v))
    direction = np.where(concave, d ^ 1, np.where(flat, r, d))
    juncture = np.where(concave, r ^ 1, np.where(flat, d ^ 1, r))
    return faces.find(voxel, direction), juncture


def _decider(mode: Mode, values: Array, alpha: float) -> Decide:
    """Whether to connect v and q at points of ambiguity, from the voxels v, q, w, p."""

    def decide(v: Integers, q: Integers, w: Integers, p: Integers) -> Booleans:
        if mode != "mixed":
            return np.full(len(v), mode == "connect")
        framed = tuple(n + 2 for n in values.shape)
        index = (np.unravel_index(voxel, framed) for voxel in (v, q, w, p))
        grey = (values[i - 1, j - 1, k - 1].astype(np.float64) - alpha for i, j, k in index)
        return average_is_active(*grey)

    return decide


def cycles_of(successor: Integers) -> Cycles:
    """The cycles of a permutation by length, each row begun at its smallest member.

    Walks on from every member at once, and drops a walk when it meets a member smaller than its
    start: that cycle is found from there.

    >>> {n: rows.tolist() for n, rows in cycles_of(np.array([2, 1, 4, 5, 0, 3])).items()}
    {1: [[1]], 2: [[3, 5]], 3: [[0, 2, 4]]}
    """
    start = np.arange(len(successor))
    here, length, cycles = start, 0, {}
    while len(start):
        here, length = successor[here], length + 1
        closed = start[here == start]
        if len(closed):
            cycles[length] = _rows(successor, closed, length)
        going = np.flatnonzero(here > start)
        start, here = start[going], here[going]
    return cycles


def _rows(successor: Integers, start: Integers, length: int) -> Integers:
    """(n, length) the members of each cycle, in order."""
    columns = [start]
    while len(columns) < length:
        columns.append(successor[columns[-1]])
    return np.stack(columns, axis=1)


def _points(faces: Faces, field: Field, alpha: float, displaced: bool) -> Floats:
    """(F, 3) positions of the support points, as in Fig. 2d."""
    place = 0.5 * faces.centres
    if displaced:
        inner = np.flatnonzero(~faces.outer)
        # The lower voxel lies half a voxel below the centre, which has one odd coordinate.
        lower, step = np.divmod(faces.centres[inner], 2)
        place[inner] = between(field.values, alpha, lower, step)
    return field.position(place)


def _without(surface: Surface, outer: Booleans) -> Surface:
    """The surface without the cycles that visit a point marked `outer`."""
    number = np.cumsum(~outer) - 1
    kept = {n: number[rows[~outer[rows].any(axis=1)]] for n, rows in surface.cycles.items()}
    cycles = {n: rows for n, rows in kept.items() if len(rows)}
    return Surface(surface.points[~outer], surface.centres[~outer], cycles)


def fan_start(centres: Integers) -> Integers:
    """(n,) where in its cycle a fan of triangles may start, for (n, N, 3) doubled centres.

    The first point from which no chord is short. A chord of at most one voxel between unmoved
    points joins two faces of one voxel edge: it lies in the square of the four voxels round that
    edge, where another cycle may run along it, and the edge would then have four triangles. Every
    cycle of up to seven points has such a start; no 9- or 12-cycle has.

    Raises
    ------
    ValueError
        where no point of a cycle will do.
    """
    n, N = centres.shape[:2]
    start, undecided = np.zeros(n, np.int64), np.arange(n)
    for first in range(N):
        corners = np.roll(centres[undecided], -first, axis=1)
        chords = corners[:, 2 : N - 1] - corners[:, :1]
        short = ((chords**2).sum(axis=2) <= 4).any(axis=1)
        start[undecided[~short]] = first
        undecided = undecided[short]
    if len(undecided):
        raise ValueError(f"a cycle of {N} points has no fan without a short chord")
    return start


def _fan(rows: Integers, start: Integers) -> Integers:
    """The triangles (c0, ci, ci+1) of each cycle, turned to begin at `start`."""
    N = rows.shape[1]
    turned = np.take_along_axis(rows, (start[:, None] + np.arange(N)) % N, axis=1)
    fan = np.stack([turned[:, [0, i, i + 1]] for i in range(1, N - 1)], axis=1)
    return fan.reshape(-1, 3)


def _spokes(rows: Integers, first: int) -> Integers:
    """The triangles (ci, ci+1, average) of each cycle, its average numbered from `first` on."""
    n, N = rows.shape
    average = np.broadcast_to(first + np.arange(n)[:, None], (n, N))
    return np.stack([rows, np.roll(rows, -1, axis=1), average], axis=2).reshape(-1, 3)


# The same cycles, one path at a time: for reading, and to hold the arrays above to it.


def cycles_plainly(
    values: ArrayLike | Field, isovalue: float, mode: Mode = "mixed"
) -> list[list[Face]]:
    """The closed cycles as lists of faces (voxel, r), each begun at its smallest path.

    >>> sorted(len(cycle) for cycle in cycles_plainly(np.ones((1, 1, 2)), 0.5))
    [3, 3, 3, 3, 3, 3, 3, 3, 4, 4, 4, 4]
    """
    field = as_field(values, 3)
    grey = {(int(i), int(j), int(k)): float(x) for (i, j, k), x in np.ndenumerate(field.values)}
    active = {voxel for voxel, x in grey.items() if x >= isovalue}
    waiting = {
        (v, r, k) for v in active for r in range(6) for k in range(4)
        if _neighbour(v, r) not in active
    }  # fmt: skip
    cycles = []
    for path in sorted(waiting):
        cycle = []
        while path in waiting:
            waiting.remove(path)
            v, r, k = path
            cycle.append((v, r))
            v, r, juncture = _over(v, r, int(JUNCTURES[r, k]), active, grey, isovalue, mode)
            path = (v, r, int(RANK[r, juncture] - 1) % 4)
        if cycle:
            cycles.append(cycle)
    return cycles


def _neighbour(voxel: Voxel, direction: int) -> Voxel:
    """The voxel one step away."""
    i, j, k = DIRECTIONS[direction].tolist()
    return (voxel[0] + i, voxel[1] + j, voxel[2] + k)


def _over(
    v: Voxel, r: int, d: int, active: set[Voxel], grey: dict[Voxel, float], isovalue: float,
    mode: Mode,
) -> tuple[Voxel, int, int]:  # fmt: skip
    """The face (voxel, r) met at juncture d of face (v, r), and the juncture seen from there."""
    w, p = _neighbour(v, r), _neighbour(v, d)
    q = _neighbour(w, d)
    in_plane, convex, concave = (p, r, d ^ 1), (v, d, r), (q, d ^ 1, r ^ 1)
    if p in active:
        return concave if q in active else in_plane
    if q not in active:
        return convex
    # Decide a point of ambiguity.
    joined = connects(mode, *(grey[voxel] - isovalue for voxel in (v, q, w, p)))
    return concave if joined else convex
