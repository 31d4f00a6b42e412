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

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isoref import vesta as article
from isoref.diconex import Border, Mode, as_field, average_is_active, check_choice
from isoref.fast._bits import take
from isoref.fast.diconex import framed
from isoref.field import Array, Booleans, Field, Floats, Integers
from isoref.mesh import Mesh, in_space
from isoref.sweep import crossing_parameter
from isoref.vesta import DIRECTIONS, JUNCTURES, RANK, Cycles, Resolution, provenance_of

#: Planes of at most so many voxels have their faces followed at once, or one plane.
BLOCK_VOXELS = 1 << 20

Decide = Callable[[Integers, Integers, Integers, Integers], Booleans]


class Surface(article.Surface):
    """Support points and the oriented cycles through them; see `isoref.vesta.Surface`."""

    def mesh(self, resolution: Resolution = "L") -> Mesh:
        """The cycles cut into triangles, all of one length together."""
        check_choice("resolution", resolution, get_args(Resolution))
        vertices, triangles = [self.points], [np.empty((0, 3), np.int64)]
        count, codes = len(self.points), _code(self.centres)
        for length, rows in self.cycles.items():
            if length > 7 or (resolution == "H" and length > 3):
                vertices.append(self.points[rows].mean(axis=1))
                triangles.append(_spokes(rows, count))
                count += len(rows)
            else:
                triangles.append(_fan(rows, _fan_start(take(codes, rows.T))))
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

    def blocks(self) -> Iterator[slice]:
        """Runs of faces, so that each has at most so many planes of voxels, or one."""
        plane = self.shape[1] * self.shape[2]
        planes = max(1, BLOCK_VOXELS // plane)
        cuts = self.keys.searchsorted(3 * plane * np.arange(0, self.shape[0] + planes, planes))
        return (slice(*cut) for cut in pairwise(cuts.tolist()) if cut[0] < cut[1])

    def numbers(self, block: slice) -> tuple[Integers, NDArray[np.int32]]:
        """The first key, and from there on by their keys the numbers of faces near a block.

        Near are two planes on either side; what lies between is undefined.
        """
        reach = 6 * self.shape[1] * self.shape[2]
        first, last = self.keys[block.start] - reach, self.keys[block.stop - 1] + reach
        start, stop = self.keys.searchsorted((first, last))
        number = np.empty(last - first + 1, np.int32)
        number[self.keys[start:stop] - first] = np.arange(start, stop, dtype=np.int32)
        return first, number

    @cached_property
    def lower(self) -> tuple[Integers, Integers, Integers]:
        """Three times (F,) the index of the lower voxel in the volume without its frame."""
        _, n2, n3 = self.shape
        place = self.keys // 3
        row = place // n3
        i = row // n2
        return i - 1, row - i * n2 - 1, place - row * n3 - 1

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
    for block in faces.blocks():
        first, number = faces.numbers(block)
        for k in range(4):
            key, path = _across(faces, block, k, active.ravel(), decide)
            key -= first
            successor[block, k] = 4 * take(number, key).astype(np.int64) + path
    return successor.ravel()


def _across(
    faces: Faces, block: slice, k: int, active: Booleans, decide: Decide
) -> tuple[Integers, Integers]:
    """The key of the face met at juncture k of each face of a block, and the path followed there.

    What is met depends on the range direction and on which voxels are active alone, so that key and
    path are looked up.
    """
    v, r, step = faces.voxel[block], faces.direction[block], strides(faces.shape)
    p = v + take(step[JUNCTURES[:, k]], r)
    q = p + take(step, r)
    concave, flat = take(active, q), take(active, p)
    # Settle the points of ambiguity: the voxels v and q touch in an edge alone.
    poa = (concave & ~flat).nonzero()[0]
    if len(poa):
        w = v[poa] + step[r[poa]]
        concave[poa] = decide(v[poa], q[poa], w, p[poa])
    case = r + 6 * (flat & ~concave) + 12 * concave
    keys, paths = _onward(k, step)
    return 3 * v + take(keys, case), take(paths, case)


def _onward(k: int, step: Integers) -> tuple[Integers, Integers]:
    """(18,) from 3 * v to the key of the face met at juncture k, and the path followed there.

    By the range direction, first where the corner is convex, then in plane, then concave.
    """
    r, d = np.arange(6), JUNCTURES[:, k]
    voxel = np.concatenate([0 * d, step[d], step[r] + step[d]])
    direction = np.concatenate([d, r, d ^ 1])
    juncture = np.concatenate([r, d ^ 1, r ^ 1])
    lower = voxel + np.minimum(step, 0)[direction]
    # Go on along the path that begins at the juncture.
    return 3 * lower + direction // 2, (RANK[direction, juncture] - 1) % 4


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
    here, length, cycles = successor, 1, {}
    while len(start):
        closed = take(start, (here == start).nonzero()[0])
        if len(closed):
            cycles[length] = _rows(successor, closed, length)
        going = (here > start).nonzero()[0]
        start, here = take(start, going), take(successor, take(here, going))
        length += 1
    return cycles


def _rows(successor: Integers, start: Integers, length: int) -> Integers:
    """(n, length) the members of each cycle, in order."""
    columns = [start]
    while len(columns) < length:
        columns.append(take(successor, columns[-1]))
    return np.stack(columns, axis=1)


def _points(faces: Faces, field: Field, alpha: float, displaced: bool) -> Floats:
    """(F, 3) positions of the support points, as in Fig. 2d."""
    t = np.full(len(faces.keys), 0.5)
    if displaced:
        # Take the samples on both sides of each face that has them.
        inner = (~faces.outer).nonzero()[0]
        samples = np.ascontiguousarray(field.values).reshape(-1)
        steps = strides(field.shape)
        i, j, k = faces.lower
        low = take(i * steps[0] + j * steps[2] + k, inner)
        high = low + take(steps, take(faces.direction, inner) & 6)
        ends = (take(samples, place).astype(np.float64) - alpha for place in (low, high))
        t[inner] = crossing_parameter(*ends)
    place = np.empty((len(faces.keys), 3))
    for axis in range(3):
        index = faces.lower[axis] + faces.along[axis] * t
        place[:, axis] = index * field.spacing[axis] + field.origin[axis]
    return place


def _without(surface: Surface, outer: Booleans) -> Surface:
    """The surface without the cycles that visit a point marked `outer`."""
    if not outer.any():
        return surface
    left = (~outer).nonzero()[0]
    number, cycles = np.cumsum(~outer) - 1, {}
    for length, rows in surface.cycles.items():
        reaches = np.zeros(len(rows), np.bool_)
        for points in rows.T:
            reaches |= take(outer, points)
        kept = rows.take((~reaches).nonzero()[0], axis=0)
        if len(kept):
            cycles[length] = take(number, kept)
    points, centres = surface.points.take(left, axis=0), surface.centres.take(left, axis=0)
    return Surface(points, centres, cycles)


def fan_start(centres: Integers) -> Integers:
    """(n,) where in its cycle a fan of triangles may start, for (n, N, 3) doubled centres.

    See `isoref.vesta.fan_start`; raises ValueError where no point of a cycle will do.
    """
    return _fan_start(np.moveaxis(_code(centres), 0, -1))


def _code(centres: Integers) -> Integers:
    """A number for each of (.., 3) doubled centres that tells those of a cycle from each other.

    They differ by at most two along each axis, so the difference of two numbers tells how.
    """
    return np.asarray(centres[..., 0] + 5 * centres[..., 1] + 25 * centres[..., 2])


#: (125,) whether the chord between two centres is short, by the difference of their numbers + 62.
SHORT = ((np.indices((5, 5, 5)).T.reshape(-1, 3) - 2) ** 2).sum(axis=1) <= 4


def _fan_start(codes: Integers) -> Integers:
    """(n,) as `fan_start`, for the numbers (N, n) of the centres."""
    N, n = codes.shape
    start, undecided = np.zeros(n, np.int64), np.arange(n)
    for first in range(N):
        short = np.zeros(len(undecided), np.bool_)
        for other in range(2, N - 1):
            chord = codes[(first + other) % N] - codes[first]
            chord += 62
            short |= take(SHORT, chord)
        start[undecided[~short]] = first
        left = short.nonzero()[0]
        undecided, codes = take(undecided, left), codes.take(left, axis=1)
        if not len(left):
            return start
    raise ValueError(f"a cycle of {N} points has no fan without a short chord")


def _fan(rows: Integers, start: Integers) -> Integers:
    """The triangles (c0, ci, ci+1) of each cycle, turned to begin at `start`."""
    n, N = rows.shape
    turned, late = rows.copy(), start.nonzero()[0]
    places = (take(start, late)[:, None] + np.arange(N)) % N
    turned[late] = np.take_along_axis(rows[late], places, axis=1)
    fan = np.empty((n, N - 2, 3), np.int64)
    for i in range(N - 2):
        for corner, point in enumerate((0, i + 1, i + 2)):
            fan[:, i, corner] = turned[:, point]
    return fan.reshape(-1, 3)


def _spokes(rows: Integers, first: int) -> Integers:
    """The triangles (ci, ci+1, average) of each cycle, its average numbered from `first` on."""
    n, N = rows.shape
    average = np.broadcast_to(first + np.arange(n)[:, None], (n, N))
    return np.stack([rows, np.roll(rows, -1, axis=1), average], axis=2).reshape(-1, 3)
