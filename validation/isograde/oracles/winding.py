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

What is left undecided are tied samples, and those that the mesh itself touches to within the
tolerance. Such a sample is on neither side; the steps before and after it are added up and judged
as one.

References
----------
[1] H. Edelsbrunner and E. P. Muecke, Simulation of simplicity, ACM Trans. Graphics 9, 1990.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from isoref.field import Booleans, Floats, Integers

from isograde.oracles.lattice import Lattice

# A surface meets a line of samples a few times; give up on a mesh that does so very often.
MOST = 200


class TooWideError(ValueError):
    """The faces are so wide that no isosurface of the field is like that."""


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

    Raises
    ------
    TooWideError
        for faces that lie across far more lines of samples than an isosurface's do
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
    seen = ((step * shape[1] + column[:, 0]) * shape[2] + column[:, 1])[within]
    changes = np.flatnonzero(inside[:-1] != inside[1:])
    turn = 2 * inside.reshape(-1)[changes].astype(np.int64) - 1
    if _same(seen, sign[within], changes, turn):
        key, found, wanted = changes, turn, turn
    else:
        key, group = np.unique(np.concatenate([seen, changes]), return_inverse=True)
        found, wanted = np.zeros((2, len(key)), np.int64)
        np.add.at(found, group[: len(seen)], sign[within])
        wanted[group[len(seen) :]] = turn
        touched = _touched(lattice, places, turned, height, column)
        key, found, wanted = _bridged(key, found, wanted, touched, shape)
    start = np.stack(np.unravel_index(key, shape), 1)
    return start[:, np.argsort(turned)], found, wanted


def _same(seen: Integers, sign: Integers, changes: Integers, turn: Integers) -> bool:
    """Each change of side is seen once, with its sign, and nothing else is."""
    return len(seen) == len(changes) and np.array_equal(
        np.sort(4 * seen + sign), 4 * changes + turn
    )


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
    face, column = _candidates(places, faces, shape)
    last = column == np.subtract(shape[1:], 1)
    # On a last plane the line is displaced downwards: mirror it, and downwards is upwards.
    mirror = np.where(last, -1, 1)
    corners = places[faces[face]]
    p = (corners[:, :, 1:] - column[:, None]) * mirror[:, None]
    py, pz = p[..., 0], p[..., 1]
    qy, qz = py[:, [1, 2, 0]], pz[:, [1, 2, 0]]
    side = py * qz - pz * qy
    turns = ((pz <= 0) & (qz > 0) & (side > 0)).sum(1) - ((pz > 0) & (qz <= 0) & (side < 0)).sum(1)
    hit = np.flatnonzero(turns)
    heights = corners[hit, :, 0]
    weights = side[hit][:, [1, 2, 0]]
    height = (heights * weights).sum(1) / weights.sum(1)
    height = np.minimum(np.maximum(height, heights.min(1)), heights.max(1))
    return height, column[hit], turns[hit] * mirror[hit].prod(1)


def _candidates(
    places: Floats, faces: Integers, shape: tuple[int, ...]
) -> tuple[Integers, Integers]:
    """Faces and lines whose projections' boxes meet: (n,) faces and (n, 2) lines.

    A line at j + e is within [low, high] exactly when low <= j < high, one at j - e when
    low < j <= high.
    """
    first, count = [], []
    for axis in (1, 2):
        above = np.ceil(places[:, axis]).astype(np.int32)
        at = above[faces[:, 0]], above[faces[:, 1]], above[faces[:, 2]]
        low = np.maximum(np.minimum(np.minimum(at[0], at[1]), at[2]), 0)
        high = np.minimum(np.maximum(np.maximum(at[0], at[1]), at[2]), shape[axis] - 1)
        # A face that reaches the last plane also meets the line there, unless it lies in it.
        reaches = np.flatnonzero(high == shape[axis] - 1)
        levels = places[faces[reaches], axis]
        reaches = reaches[(levels.max(1) >= shape[axis] - 1) & (levels.min(1) < shape[axis] - 1)]
        high[reaches] += 1
        first.append(low)
        count.append(np.maximum(high - low, 0))
    met = np.flatnonzero((count[0] > 0) & (count[1] > 0))
    total = float(np.dot(count[0][met].astype(np.float64), count[1][met]))
    if total > MOST * (len(faces) + shape[1] * shape[2]):
        raise TooWideError(f"{len(faces)} faces lie across {total:.0f} lines of samples")
    return _spread(met, [c[met] for c in first], [c[met] for c in count])


def _spread(
    face: Integers, first: list[Integers], count: list[Integers]
) -> tuple[Integers, Integers]:
    """Each face once for each of its ``count[0] * count[1]`` lines from `first` on."""
    total = count[0] * count[1]
    if (total == 1).all():
        return face, np.stack(first, axis=1).astype(np.int64)
    which = np.repeat(np.arange(len(face)), total)
    rank = np.arange(len(which)) - np.repeat(np.cumsum(total) - total, total)
    over, along = np.divmod(rank, count[1][which])
    return face[which], np.stack([first[0][which] + over, first[1][which] + along], axis=1)


def _touched(
    lattice: Lattice, places: Floats, turned: tuple[int, ...], height: Floats, column: Integers
) -> Booleans:
    """Samples that are tied, or that a vertex or a crossing touches, axes turned."""
    touched = lattice.tied.transpose(turned).copy()
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
