"""VESTA, vectorised: the numbers of `isoref.vesta`.

All faces at once, and all paths at once: each step of the article is one pass over arrays. Voxels
are named by their flat index in the volume with a frame of inactive ones, one voxel wide, so that
every voxel has its neighbours. The successor of a path is found for all paths, and the cycles of
that permutation by walking on from all of them together.

Glossary
--------
key         of a face: three times the lower of its two voxels, plus its axis
path        4 f + k on face f, from its juncture k + 1 to its juncture k
v, w, p, q  the four voxels at a juncture, as in `isoref.vesta`
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import get_args

import numpy as np
from numpy.typing import ArrayLike

from isoref import vesta as article
from isoref.diconex import Border, Mode, as_field, average_is_active, check_choice
from isoref.fast.diconex import framed
from isoref.field import Array, Booleans, Field, Floats, Integers
from isoref.mesh import Mesh, in_space
from isoref.sweep import crossing_parameter
from isoref.vesta import DIRECTIONS, JUNCTURES, RANK, Cycles, Resolution, provenance_of

Decide = Callable[[Integers, Integers, Integers, Integers], Booleans]


class Surface(article.Surface):
    """Support points and the oriented cycles through them; see `isoref.vesta.Surface`."""

    def mesh(self, resolution: Resolution = "L") -> Mesh:
        """The cycles cut into triangles, all of one length together."""
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
        """N -> (n, 3) the sum of the outward normals of a cycle's triangles."""
        sums = {}
        for length, rows in self.cycles.items():
            spoke = self.points[rows] - self.points[rows[:, :1]]
            sums[length] = 0.5 * np.cross(spoke, np.roll(spoke, -1, axis=1)).sum(axis=1)
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
    """The VESTA surface of a field as triangles; see `isoref.vesta.vesta`."""
    surface = extract(values, isovalue, mode=mode, border=border, displaced=displaced)
    mesh = surface.mesh(resolution)
    if not provenance:
        return mesh
    return replace(mesh, provenance=provenance_of(surface, resolution, as_field(values, 3)))


def extract(
    values: ArrayLike | Field,
    isovalue: float,
    *,
    mode: Mode = "mixed",
    border: Border = "open",
    displaced: bool = True,
) -> Surface:
    """The cycles round the voxels at or above the isovalue; see `isoref.vesta.extract`."""
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
    def lower(self) -> tuple[Integers, Integers, Integers]:
        """Three times (F,) the index of the lower voxel in the volume without its frame."""
        _, n2, n3 = self.shape
        row, k = np.divmod(self.keys // 3, n3)
        i, j = np.divmod(row, n2)
        return i - 1, j - 1, k - 1

    @cached_property
    def along(self) -> tuple[Booleans, Booleans, Booleans]:
        """Three times (F,) whether the face is across this axis."""
        axis = self.direction >> 1
        return axis == 0, axis == 1, axis == 2

    @cached_property
    def centres(self) -> Integers:
        """(F, 3) the centres, twice the index in the volume without its frame."""
        doubled = np.empty((len(self.keys), 3), np.int64)
        for axis in range(3):
            doubled[:, axis] = 2 * self.lower[axis] + self.along[axis]
        return doubled

    @cached_property
    def outer(self) -> Booleans:
        """(F,) whether the inactive voxel lies in the frame."""
        outside = np.zeros(len(self.keys), np.bool_)
        for axis, index in enumerate(self.lower):
            beyond = (index < 0) | (index == self.shape[axis] - 3)
            outside |= self.along[axis] & beyond
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
    t = np.full(len(faces.keys), 0.5)
    if displaced:
        # Take the samples on both sides of each face that has them.
        inner = np.flatnonzero(~faces.outer)
        samples = np.ascontiguousarray(field.values).reshape(-1)
        steps = strides(field.shape)
        low = sum(
            (faces.lower[axis][inner] * steps[2 * axis] for axis in range(3)),
            np.zeros(len(inner), np.int64),
        )
        high = low + steps[faces.direction[inner] & 6]
        ends = (samples[place].astype(np.float64) - alpha for place in (low, high))
        t[inner] = crossing_parameter(*ends)
    place = np.empty((len(faces.keys), 3))
    for axis in range(3):
        place[:, axis] = faces.lower[axis] + faces.along[axis] * t
    return field.position(place)


def _without(surface: Surface, outer: Booleans) -> Surface:
    """The surface without the cycles that visit a point marked `outer`."""
    number = np.cumsum(~outer) - 1
    kept = {n: number[rows[~outer[rows].any(axis=1)]] for n, rows in surface.cycles.items()}
    cycles = {n: rows for n, rows in kept.items() if len(rows)}
    return Surface(surface.points[~outer], surface.centres[~outer], cycles)


def fan_start(centres: Integers) -> Integers:
    """(n,) where in its cycle a fan of triangles may start, for (n, N, 3) doubled centres.

    See `isoref.vesta.fan_start`; raises ValueError where no point of a cycle will do.
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
