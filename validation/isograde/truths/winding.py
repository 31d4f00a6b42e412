"""How often, and which way, a mesh passes between two neighbouring samples.

Walk from sample to sample along every axis and count the mesh's crossings with their sign: +1
where its normal points the way we go. That is the change of the winding number; a surface that
separates inside from outside changes it by exactly (inside here) - (inside there). Counting steps
rather than the winding number itself, the test also holds for a mesh that is open at the border
of the volume, where it is cut off.

The line of samples runs through the mesh's own vertices, which stand on lattice edges. So the
walk is displaced by an infinitesimal (e, e * e) across its direction, always into the volume
(simulation of simplicity [1]): a vertex or an edge is never hit, one of the faces at it is, and
which one follows from the signs of exact differences. Two faces that share an edge decide with
the same product, so no rounding can lose a crossing or count it twice.

What is left undecided are samples that the mesh itself touches, to within the tolerance. Such a
sample is on neither side; the steps before and after it are added up and judged as one.

References
----------
[1] H. Edelsbrunner and E. P. Muecke, Simulation of simplicity, ACM Trans. Graphics 9, 1990.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from isoref.field import Booleans, Floats, Integers

from isograde.truths.lattice import Lattice


@dataclass(frozen=True, eq=False)
class Steps:
    """Judged steps between neighbouring samples where mesh and samples could disagree.

    Attributes
    ----------
    axis : (n,) the direction of each step
    sample : (n, 3) the sample it starts from
    found : (n,) the mesh's signed crossings
    wanted : (n,) (inside at the start) - (inside at the end)
    """

    axis: Integers
    sample: Integers
    found: Integers
    wanted: Integers

    @property
    def unseparated(self) -> Booleans:
        """(n,) steps on which the mesh does not do what the samples say, whatever its sign."""
        return np.asarray(np.abs(self.found) != np.abs(self.wanted))

    @property
    def reversed(self) -> Booleans:
        """(n,) steps on which it does, with its normal the wrong way."""
        return np.asarray((self.found == -self.wanted) & (self.wanted != 0))


def steps(lattice: Lattice, places: Floats, faces: Integers) -> Steps:
    """Every step that crosses the mesh or changes side, touched samples bridged.

    Parameters
    ----------
    lattice : samples and sides
    places : (V, 3) vertices in index coordinates
    faces : (F, 3)
    """
    parts = [_along(lattice, places, faces, axis) for axis in range(3)]
    return Steps(
        np.concatenate([np.full(len(found), axis) for axis, (_, found, _) in enumerate(parts)]),
        np.concatenate([sample for sample, _, _ in parts]),
        np.concatenate([found for _, found, _ in parts]),
        np.concatenate([wanted for _, _, wanted in parts]),
    )


def _along(
    lattice: Lattice, places: Floats, faces: Integers, axis: int
) -> tuple[Integers, Integers, Integers]:
    """Start, crossings found and crossings wanted of the steps along one axis."""
    turned = (axis, (axis + 1) % 3, (axis + 2) % 3)
    inside = lattice.inside.transpose(turned)
    shape = inside.shape
    height, column, sign = crossings(places[:, turned], faces, shape)
    # A crossing beyond the last sample belongs to no step.
    step = np.ceil(height).astype(np.int64) - 1
    within = (step >= 0) & (step < shape[0] - 1)
    places_found = np.ravel_multi_index((step[within], column[within, 0], column[within, 1]), shape)
    changes = np.flatnonzero(inside[:-1] != inside[1:])
    flat_inside = inside.reshape(-1)
    behind = shape[1] * shape[2]
    turn = flat_inside[changes].astype(np.int64) - flat_inside[changes + behind]
    key, group = np.unique(np.concatenate([places_found, changes]), return_inverse=True)
    found = np.zeros(len(key), np.int64)
    np.add.at(found, group[: len(places_found)], sign[within])
    wanted = np.zeros(len(key), np.int64)
    wanted[group[len(places_found) :]] = turn
    if (found != wanted).any():
        touched = _touched(lattice, places, turned, height, column)
        key, found, wanted = _bridged(key, found, wanted, touched, shape)
    start = np.stack(np.unravel_index(key, shape), 1)
    back = np.argsort(turned)
    return start[:, back], found, wanted


def crossings(
    places: Floats, faces: Integers, shape: tuple[int, ...]
) -> tuple[Floats, Integers, Integers]:
    """Where the faces cross the displaced lines of samples along axis 0.

    Parameters
    ----------
    places : (V, 3) vertices, axis 0 along the lines
    faces : (F, 3)
    shape : number of samples along each axis

    Returns
    -------
    height : (n,) coordinate along the line
    column : (n, 2) the line's other two index coordinates
    sign : (n,) +1 where the right-hand normal points along axis 0
    """
    found = [
        _crossings_of_side(places, faces, shape, last)
        for last in ((False, False), (False, True), (True, False), (True, True))
    ]
    height, column, sign = (np.concatenate(part) for part in zip(*found, strict=True))
    return height, column, sign


def _crossings_of_side(
    places: Floats, faces: Integers, shape: tuple[int, ...], last: tuple[bool, bool]
) -> tuple[Floats, Integers, Integers]:
    """Crossings with the lines on the last plane of the marked axes, or off it.

    The last plane's lines are displaced downwards: mirror them, and downwards is upwards.
    """
    mirror = np.where(last, -1, 1)
    flat = places[:, 1:] * mirror
    corners = flat[faces]
    # A line at j + e is within [low, high] exactly when low <= j < high.
    first = np.ceil(corners.min(axis=1)).astype(np.int64)
    final = np.ceil(corners.max(axis=1)).astype(np.int64) - 1
    planes = np.subtract(shape[1:], 1)
    first = np.maximum(first, np.where(last, -planes, 0))
    final = np.minimum(final, np.where(last, -planes, planes - 1))
    face, column = _pairs(first, final)
    p = corners[face] - column[:, None, :]
    q = p[:, [1, 2, 0]]
    side = p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0]
    upwards = (p[..., 1] <= 0) & (q[..., 1] > 0) & (side > 0)
    downwards = (p[..., 1] > 0) & (q[..., 1] <= 0) & (side < 0)
    turns = upwards.sum(axis=1) - downwards.sum(axis=1)
    hit = np.flatnonzero(turns)
    heights = places[faces[face[hit]], 0]
    weights = side[hit][:, [1, 2, 0]]
    height = (heights * weights).sum(axis=1) / weights.sum(axis=1)
    height = np.clip(height, heights.min(axis=1), heights.max(axis=1))
    sign = turns[hit] * int(mirror.prod())
    return height, column[hit] * mirror, sign


def _pairs(first: Integers, final: Integers) -> tuple[Integers, Integers]:
    """Each face with each line whose two coordinates lie between first and final, inclusive."""
    count = np.maximum(final - first + 1, 0)
    total = count.prod(axis=1)
    face = np.repeat(np.arange(len(first)), total)
    rank = np.arange(len(face)) - np.repeat(np.cumsum(total) - total, total)
    width = count[face, 1]
    offset = np.stack([rank // np.maximum(width, 1), rank % np.maximum(width, 1)], 1)
    return face, first[face] + offset


def _touched(
    lattice: Lattice, places: Floats, turned: tuple[int, ...], height: Floats, column: Integers
) -> Booleans:
    """Samples that a vertex or a crossing touches to within the tolerance, axes turned."""
    touched = np.zeros(lattice.inside.transpose(turned).shape, bool)
    spots = np.concatenate([places[:, turned], np.column_stack([height, column])])
    nearest = np.rint(spots)
    near = (np.abs(spots - nearest) <= lattice.tolerance).all(axis=1)
    near &= ((nearest >= 0) & (nearest < touched.shape)).all(axis=1)
    i, j, k = nearest[near].astype(np.int64).T
    touched[i, j, k] = True
    return touched


def _bridged(
    key: Integers, found: Integers, wanted: Integers, touched: Booleans, shape: tuple[int, ...]
) -> tuple[Integers, Integers, Integers]:
    """The steps with those that meet at a touched sample added up, end to end.

    A run of steps that starts or ends on the border at a touched sample says nothing and is
    dropped.
    """
    lines = shape[1] * shape[2]
    # Take up the empty steps next to touched samples, so that runs are complete.
    sample = np.flatnonzero(touched)
    beside = np.concatenate(
        [sample[sample >= lines] - lines, sample[sample < touched.size - lines]]
    )
    every = np.union1d(key, beside)
    place = np.searchsorted(every, key)
    both = np.zeros((2, len(every)), np.int64)
    both[0, place], both[1, place] = found, wanted
    # Order by line, then along it; a step continues the run before it when its start is touched.
    order = np.lexsort((every // lines, every % lines))
    start = every[order]
    flat = touched.reshape(-1)
    head = ~flat[start]
    head[:1] = True
    loose = flat[start] & (start < lines)
    run = np.cumsum(head | loose) - 1
    sums = np.zeros((2, run[-1] + 1 if len(run) else 0), np.int64)
    for total, part in zip(sums, both, strict=True):
        np.add.at(total, run, part[order])
    first = np.flatnonzero(head | loose)
    last = np.append(first[1:], len(start)) - 1
    ends_touched = flat[start[last] + lines] if len(last) else np.zeros(0, bool)
    keep = ~(flat[start[first]] | ends_touched)
    return start[first][keep], sums[0][keep], sums[1][keep]
