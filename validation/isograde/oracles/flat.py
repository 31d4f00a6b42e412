r"""To which cell a triangle belongs that lies flat in the face between two cells.

A mesh is judged cell by cell, and a triangle in a face between two cells may be part of the
surface in either. Nothing in the mesh says of which, so every way to give the face's triangles to
the two cells is tried, and one way under which all is right is enough: cells that are right under
one assignment glue to the right surface, whoever drew which triangle::

      the face, seen from above          two triangles in it turn one pair of segments
      o-----B-----o                      into the other: a cell whose own triangles join
      |   /   \   |                      the corners by A-B and C-D separates them by A-D
      | A       C |   A, B, C, D nodes   and B-C once A B C and A C D are given to it
      |   \   /   |
      o-----D-----o

The assignments of one face are *kept* under which both cells have the same trace on it, and that
trace is legal. Where none is kept, the face is *torn*. For what is asked of a cell as a whole
(its topology, its number of triangles), cells are joined across faces that have several kept
assignments, and the product of these is tried.

Nothing is guessed: faces with more than `MOST` flat triangles, and joined cells with more than
`LIMIT` combinations, are left undecided, and said to be.

Glossary
--------
row         a cell, by its number in a list of cells; -1 for a cell that is not in the list, in
            which nothing is drawn; beyond the border of the lattice `WALL`, where nothing can be,
            or `OUTSIDE`, where there may be more of the surface, such as a cap
bits        the six bits of a trace on one face, see `isograde.oracles.traces`
mask        an assignment: bit b is set where the face's triangle b belongs to the cell above
above, below  the cells on the higher and on the lower side of a face along its axis
option      one of the assignments of a face that are still open
trial cell  a cell under one combination of its own faces' options

An edge that two cells both draw on the face they share has four triangles. That is a fault of the
mesh (it is not manifold), and not of the face or of the cells.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from isoref.field import Booleans, Integers

from isograde.oracles.rows import components_of

MOST = 8
LIMIT = 4096
OUTSIDE, WALL = -2, -3


@dataclass(frozen=True, eq=False)
class Lying:
    """The triangles that lie flat in faces of cells, in the order of their faces.

    Attributes
    ----------
    triangle : (t,) number of each triangle in the mesh
    bits : (t,) the segments of its sides, the same seen from either cell
    start : (m + 1,) where the triangles of each face begin
    axis : (m,) the axis that each face is across
    below, above : (m,) rows of the cells on either side of it
    """

    triangle: Integers
    bits: Integers
    start: Integers
    axis: Integers
    below: Integers
    above: Integers

    @classmethod
    def none(cls) -> Lying:
        """No triangle lies flat."""
        empty = np.empty(0, np.int64)
        return cls(empty, empty, np.zeros(1, np.int64), empty, empty, empty)

    def __len__(self) -> int:
        return len(self.axis)

    @property
    def count(self) -> Integers:
        """(m,) number of flat triangles in each face."""
        return np.diff(self.start)

    @property
    def sides(self) -> Iterator[tuple[Integers, Integers]]:
        """The row of the cell below each face and the face's number in it; then the same above."""
        yield self.below, 2 * self.axis + 1
        yield self.above, 2 * self.axis

    def given(self, face: int, mask: int) -> tuple[Integers, Integers]:
        """Places in `triangle` of those that a mask gives to the cell below, and above."""
        places = np.arange(self.start[face], self.start[face + 1])
        up = mask >> np.arange(len(places)) & 1 > 0
        return places[~up], places[up]


def both_sides(
    bits: Integers, below: Integers, above: Integers, beyond: Booleans
) -> tuple[Integers, Integers]:
    """(m, 2 ** k) traces of the two cells on a face with k flat triangles, under each mask.

    Parameters
    ----------
    bits : (m, k) the flat triangles' segments
    below, above : (m,) what the two cells' own triangles draw on the face
    beyond : (m, 2) there is no cell below, or above; it is taken to agree

    >>> drawn, beyond = np.array([1]), np.zeros((1, 2), bool)
    >>> both_sides(np.array([[3]]), drawn, drawn, beyond)
    (array([[2, 1]]), array([[1, 2]]))
    """
    masks = np.arange(1 << bits.shape[1])
    low = np.repeat(below[:, None], len(masks), axis=1)
    high = np.repeat(above[:, None], len(masks), axis=1)
    for b in range(bits.shape[1]):
        up = masks >> b & 1
        high ^= bits[:, b, None] * up
        low ^= bits[:, b, None] * (1 - up)
    low = np.where(beyond[:, :1], high, low)
    return low, np.where(beyond[:, 1:], low, high)


@dataclass(frozen=True, eq=False)
class Readings:
    """The ways to read each face in which triangles lie flat.

    Attributes
    ----------
    lying : the flat triangles and their faces
    masks : for each face its options: the assignments that are kept; where there is none, the one
        that leaves the most cells with a legal trace there
    legal : (m, 2) a kept assignment separates the inside corners; one joins them
    states : for each face (options, 2), which of the two each option is; both where the face is
        not ambiguous, neither where it is torn
    undecided : (m,) more flat triangles than are tried
    """

    lying: Lying
    masks: tuple[Integers, ...]
    states: tuple[Booleans, ...]
    undecided: Booleans

    @cached_property
    def legal(self) -> Booleans:
        """(m, 2) a kept assignment separates the face's inside corners; one joins them."""
        found = [state.any(axis=0) for state in self.states]
        return np.array(found, bool).reshape(-1, 2)

    @property
    def torn(self) -> Booleans:
        """(m,) no assignment gives both cells the same legal trace."""
        return np.asarray(~self.legal.any(axis=1) & ~self.undecided)

    def preferring(self, wanted: Integers) -> Readings:
        """The readings with the options of the wanted state alone, where a face has any.

        wanted : (m,) 0 separated, 1 joined, -1 either
        """
        masks, states = list(self.masks), list(self.states)
        for face in np.flatnonzero(wanted >= 0):
            right = states[face][:, wanted[face]]
            if right.any():
                masks[face], states[face] = masks[face][right], states[face][right]
        return replace(self, masks=tuple(masks), states=tuple(states))

    @cached_property
    def faces_of(self) -> dict[int, list[int]]:
        """The faces with flat triangles of each cell, in increasing order."""
        found: dict[int, list[int]] = {}
        for face, rows in enumerate(np.stack([self.lying.below, self.lying.above], axis=1)):
            for row in rows[rows >= 0].tolist():
                found.setdefault(row, []).append(face)
        return found

    @cached_property
    def clusters(self) -> list[list[int]]:
        """The faces that have to be decided together, as cells with a choice link them."""
        free = np.flatnonzero(np.array([len(m) for m in self.masks], np.int64) > 1)
        number = {face: n for n, face in enumerate(free.tolist())}
        pairs = [
            pair
            for faces in self.faces_of.values()
            for pair in pairwise(number[face] for face in faces if face in number)
        ]
        count, label = components_of(len(free), np.array(pairs, np.int64).reshape(-1, 2).T)
        return [free[label == c].tolist() for c in range(count)]

    @cached_property
    def beyond(self) -> Booleans:
        """(m,) faces that are not decided: too many flat triangles, or too many combinations."""
        found = self.undecided.copy()
        for cluster in self.clusters:
            size = 1
            for face in cluster:
                size *= len(self.masks[face])
            found[cluster] |= size > LIMIT
        return found

    @cached_property
    def unjudged(self) -> Integers:
        """Rows of the cells that have a face which is not decided."""
        both = np.concatenate([self.lying.below[self.beyond], self.lying.above[self.beyond]])
        return np.unique(both[both >= 0])

    @cached_property
    def trials(self) -> Trials:
        """The trial cells of all cells that have flat triangles and are judged."""
        return Trials.of(self)

    def settle(self, cost: Integers) -> Integers:
        """(m,) the option of each face for which the trial cells' costs sum to the least.

        cost : (v,) of each trial cell; 0 where all is right
        """
        chosen = np.zeros(len(self.masks), np.int64)
        for cluster in self.clusters:
            if not self.beyond[cluster].any():
                total = self._total(cluster, cost)
                chosen[cluster] = np.unravel_index(int(total.argmin()), total.shape)
        return chosen

    def _total(self, cluster: list[int], cost: Integers) -> Integers:
        """The sum of the costs of the cluster's cells under each combination of its options."""
        total = np.zeros([len(self.masks[face]) for face in cluster], np.int64)
        at = {face: n for n, face in enumerate(cluster)}
        sides = (self.lying.below[cluster], self.lying.above[cluster])
        for row in np.unique(np.concatenate(sides)).tolist():
            if row in self.trials.first:
                # A face of another cluster, or none, has one option here: it takes no axis.
                shape = [1] * len(cluster)
                for face in self.faces_of[row]:
                    if face in at:
                        shape[at[face]] = len(self.masks[face])
                begin = self.trials.first[row]
                total = total + cost[begin : begin + int(np.prod(shape))].reshape(shape)
        return total


@dataclass(frozen=True, eq=False)
class Trials:
    """Each cell with flat triangles, under each combination of its own faces' options.

    Attributes
    ----------
    row : (v,) the cell that each trial cell is
    first : the first trial cell of each cell; the others follow, the last face's options running
        the fastest
    owner, triangle : (p,) flat triangles that each trial cell has: its number, and the place of
        the triangle in `Lying.triangle`
    """

    row: Integers
    first: dict[int, int]
    owner: Integers
    triangle: Integers

    @classmethod
    def of(cls, readings: Readings) -> Trials:
        """The trial cells of all cells whose faces are decided."""
        lying = readings.lying
        skipped = set(readings.unjudged.tolist())
        rows: list[int] = []
        first: dict[int, int] = {}
        owners: list[Integers] = []
        triangles: list[Integers] = []
        for row, faces in readings.faces_of.items():
            if row in skipped:
                continue
            first[row] = len(rows)
            for options in np.ndindex(*(len(readings.masks[face]) for face in faces)):
                for face, option in zip(faces, options, strict=True):
                    down, up = lying.given(face, int(readings.masks[face][option]))
                    mine = down if lying.below[face] == row else up
                    triangles.append(mine)
                    owners.append(np.full(len(mine), len(rows)))
                rows.append(row)
        none = [np.empty(0, np.int64)]
        return cls(
            np.array(rows, np.int64),
            first,
            np.concatenate(owners + none),
            np.concatenate(triangles + none),
        )

    def chosen(self, readings: Readings, options: Integers) -> Integers:
        """For each cell in `first`, in its order, its trial cell under these options of faces."""
        found = []
        for row, begin in self.first.items():
            faces = readings.faces_of[row]
            sizes = tuple(len(readings.masks[face]) for face in faces)
            found.append(begin + int(np.ravel_multi_index(tuple(options[faces]), sizes)))
        return np.array(found, np.int64)


def read(lying: Lying, drawn: Integers, legal: Integers) -> Readings:
    """The ways to read the faces in which triangles lie flat.

    Parameters
    ----------
    drawn : (n, 6) the bits of the cells' own triangles on each face
    legal : (n, 6, 2) the legal bits: inside corners separated, joined
    """
    m = len(lying)
    masks: list[Integers] = [np.zeros(1, np.int64)] * m
    states: list[Booleans] = [np.zeros((1, 2), bool)] * m
    own, wanted, beyond = _at_faces(lying, drawn, legal)
    for k in range(1, MOST + 1):
        faces = np.flatnonzero(lying.count == k)
        if not len(faces):
            continue
        bits = lying.bits[lying.start[faces][:, None] + np.arange(k)]
        traces = both_sides(bits, own[faces, 0], own[faces, 1], beyond[faces])
        low, high = ((trace[..., None] == wanted[faces][:, None]) for trace in traces)
        good = low & high & _allowed(lying, faces, k)[..., None]
        for n, face in enumerate(faces.tolist()):
            kept = np.flatnonzero(good[n].any(axis=1))
            if not len(kept):
                score = low[n].any(axis=1).astype(int) + high[n].any(axis=1)
                score = np.where(_allowed(lying, faces[[n]], k)[0], score, -1)
                kept = np.array([score.argmax()])
            masks[face], states[face] = kept, good[n][kept]
    return Readings(lying, tuple(masks), tuple(states), np.asarray(lying.count > MOST))


def _at_faces(
    lying: Lying, drawn: Integers, legal: Integers
) -> tuple[Integers, Integers, Booleans]:
    """What each face's two cells draw on it (m, 2), what is legal (m, 2), which are outside."""
    m = len(lying)
    own, wanted = np.zeros((m, 2), np.int64), np.zeros((m, 2), np.int64)
    beyond = np.zeros((m, 2), bool)
    for side, (row, face) in enumerate(lying.sides):
        known = row >= 0
        own[known, side] = drawn[row[known], face[known]]
        wanted[known] = legal[row[known], face[known]]
        beyond[:, side] = (row == OUTSIDE) | (row == WALL)
    return own, wanted, beyond


def _allowed(lying: Lying, faces: Integers, k: int) -> Booleans:
    """(m, 2 ** k) the mask gives nothing to a wall."""
    masks = np.arange(1 << k)
    up, down = lying.above[faces] != WALL, lying.below[faces] != WALL
    return np.asarray((up[:, None] | (masks == 0)) & (down[:, None] | (masks == masks[-1])))
