"""How many topologies a cell can have: all of them, derived, classified and named.

Idea
----
What the sweep of `isograde.oracles.trilinear` reads in a cell is a finite thing: the signs of the
corners, the order in which the lines of the sweep cross zero, and what the saddle of the slices
does meanwhile. Write down every reading that does not contradict itself:

- where an interval of ambiguous slices begins or ends at a crossing, the line that vanishes there
  fixes the sign of q = w0 w3 - w1 w2, for one of the two products is zero;
- on the four faces along the sweep the order of the two crossings is the face's decision;
- q is a quadratic, so it has at most two roots on all intervals together.

Each reading has a topology. Keep those topologies that a reading along each of the three axes
gives. What is left is an upper bound: nothing else can happen in a cell. That every one of them
does happen is shown by cells (`isograde.cases.trilinear_cells` holds one of each).

    768 topologies of labelled corners; 33 up to rotations and exchange of high and low; 31 when
    mirror images count as one; 57 up to rotations alone.

Glossary
--------
Topology        signs of the corners, decisions on the faces, who is joined in the body
configuration   0 .. 14, Figure 2 of [2]; 11 and 14 are mirror images
case            Chernyaev's name for a class: configuration, then a number for the faces, then
                1 without and 2 with a tunnel
sheet, curve    as in `isograde.oracles.trilinear`

References
----------
1. E. V. Chernyaev: Marching Cubes 33. CERN CN 95-17, 1995.
2. G. M. Nielson, B. Hamann: The asymptotic decider. Visualization '91.
3. T. Lewiner and others: Efficient implementation of marching cubes' cases with topological
   guarantees. Journal of Graphics Tools 8(2), 2003 (the names as used since).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import combinations, permutations, product

import numpy as np
from numpy.typing import NDArray

from isograde.oracles.rows import distinct
from isograde.oracles.trilinear import (
    EDGES,
    FACES,
    PAIRS,
    SEQUENCES,
    Truths,
    rim_of,
    topology,
)

Signs = tuple[int, ...]
Groups = tuple[tuple[int, ...], ...]


@dataclass(frozen=True, order=True)
class Topology:
    """One thing that can happen in a cell; corners and faces as in `isograde.oracles.trilinear`.

    signs : 1 or -1 for each corner
    faces : 1 where the high corners of an ambiguous face are joined on it, -1 the low ones, else 0
    body : for each corner the least corner of its component in the cell
    """

    signs: Signs
    faces: Signs
    body: Signs

    @property
    def rim(self) -> Signs:
        """For each corner the least corner of its component on the cell's skin."""
        return rim_of(self.signs, self.faces)

    @property
    def sheets(self) -> tuple[tuple[int, ...], ...]:
        """For each sheet the numbers of crossed edges on its curves, sorted.

        >>> one = Topology((1, -1, -1, -1, -1, -1, -1, 1), (0,) * 6, (0, 1, 1, 1, 1, 1, 1, 0))
        >>> one.sheets
        ((3, 3),)
        """
        rim = self.rim
        curves: dict[tuple[int, int], dict[tuple[int, int], int]] = {}
        for a, b in EDGES:
            if self.signs[a] != self.signs[b]:
                sheet = curves.setdefault(_pair(self.body[a], self.body[b]), {})
                curve = _pair(rim[a], rim[b])
                sheet[curve] = sheet.get(curve, 0) + 1
        return tuple(sorted(tuple(sorted(sheet.values())) for sheet in curves.values()))

    @property
    def tunnels(self) -> int:
        """Number of curves less number of sheets."""
        return sum(len(sheet) - 1 for sheet in self.sheets)


def _pair(a: int, b: int) -> tuple[int, int]:
    """The two numbers in order."""
    return (a, b) if a < b else (b, a)


# --- derivation ---------------------------------------------------------------------------------


def weak_orders(items: tuple[int, ...]) -> Iterator[Groups]:
    """Every way to let the items happen one after another, some together.

    >>> sum(1 for order in weak_orders((0, 1, 2, 3)))
    75
    """
    if not items:
        yield ()
    for size in range(1, len(items) + 1):
        for first in combinations(items, size):
            for rest in weak_orders(tuple(i for i in items if i not in first)):
                yield (first, *rest)


def _signs_of_q(group: tuple[int, ...] | None) -> set[int]:
    """The signs q can have next to a crossing of these lines; None stands for a face."""
    zero_first = group is not None and bool({0, 3} & set(group))
    zero_second = group is not None and bool({1, 2} & set(group))
    if zero_first != zero_second:
        return {-1} if zero_first else {1}
    return {-1, 1}


@dataclass(frozen=True)
class _Ambiguous:
    """An interval of ambiguous slices: what q can do on it, and which faces it touches."""

    sequences: tuple[tuple[int, ...], ...]
    at_start: bool
    at_end: bool


def _ambiguous_intervals(signs: Signs, order: Groups) -> dict[int, _Ambiguous]:
    """The ambiguous intervals of a sweep by the sign of lines 0 and 3, at most one for each."""
    state, found = list(signs[:4]), {}
    for i in range(len(order) + 1):
        if state[0] == state[3] != state[1] == state[2]:
            begin = _signs_of_q(order[i - 1] if i else None)
            end = _signs_of_q(order[i] if i < len(order) else None)
            fitting = tuple(s for s in SEQUENCES[1:] if s[0] in begin and s[-1] in end)
            found[state[0]] = _Ambiguous(fitting, i == 0, i == len(order))
        if i < len(order):
            for line in order[i]:
                state[line] = -state[line]
    return found


def _faces_along(signs: Signs, rank: dict[int, int]) -> dict[int, int] | None:
    """The decisions on the four faces along the sweep; None where one would be tied.

    When the first of two lines has crossed, both have the sign of the other: that sign is joined.
    """
    faces = {}
    for face, (a, b, c, d) in enumerate(FACES[2:], start=2):
        if signs[a] == signs[d] != signs[b] == signs[c]:
            if rank[a] == rank[b]:
                return None
            faces[face] = signs[b] if rank[a] < rank[b] else signs[a]
    return faces


def _rows(signs: Signs) -> Iterator[Signs]:
    """Every reading of cells with these signs that does not contradict itself."""
    crossing = tuple(line for line in range(4) if signs[line] != signs[4 + line])
    for order in weak_orders(crossing):
        rank = {line: i for i, group in enumerate(order) for line in group}
        along = _faces_along(signs, rank)
        if along is None:
            continue
        pairs = [
            int(np.sign(rank[a] - rank[b])) if a in rank and b in rank else 0 for a, b in PAIRS
        ]
        intervals = _ambiguous_intervals(signs, order)
        choices = [intervals[s].sequences if s in intervals else ((),) for s in (1, -1)]
        for high, low in product(*choices):
            if max(len(high) - 1, 0) + max(len(low) - 1, 0) <= 2:
                faces = [along.get(face, 0) for face in range(6)]
                for sign, q in ((1, high), (-1, low)):
                    if q and intervals[sign].at_start:
                        faces[0] = sign * q[0]
                    if q and intervals[sign].at_end:
                        faces[1] = sign * q[-1]
                codes = (SEQUENCES.index(high), SEQUENCES.index(low))
                yield (*signs, *pairs, *codes, *faces)


@cache
def every_topology() -> frozenset[Topology]:
    """All that can happen in a cell.

    >>> len(every_topology())
    768
    """
    along_first = {
        Topology(row[:8], row[16:], topology(row)[1])
        for signs in product((1, -1), repeat=8)
        for row in _rows(signs)
    }
    turns = [
        Symmetry((0, 1, 2), (0, 0, 0)),
        Symmetry((1, 2, 0), (0, 0, 0)),
        Symmetry((2, 0, 1), (0, 0, 0)),
    ]
    return frozenset.intersection(
        *(frozenset(turn.of(one) for one in along_first) for turn in turns)
    )


# --- classes ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Symmetry:
    """A symmetry of the cube: new axis a is old axis `axes[a]`, turned round where `flips[a]`."""

    axes: tuple[int, ...]
    flips: tuple[int, ...]

    @property
    def is_rotation(self) -> bool:
        """Whether right hands stay right hands."""
        inversions = sum(a > b for a, b in combinations(self.axes, 2))
        return (inversions + sum(self.flips)) % 2 == 0

    def corner(self, c: int) -> int:
        """Where corner c goes."""
        bits = (c >> 2 & 1, c >> 1 & 1, c & 1)
        new = [bits[self.axes[a]] ^ self.flips[a] for a in range(3)]
        return new[0] << 2 | new[1] << 1 | new[2]

    def of(self, one: Topology) -> Topology:
        """The topology in the moved cell."""
        corners, faces = _moves(self)
        signs, body, decisions = [0] * 8, [0] * 8, [0] * 6
        for c in range(8):
            signs[corners[c]], body[corners[c]] = one.signs[c], one.body[c]
        for face in range(6):
            decisions[faces[face]] = one.faces[face]
        names = tuple(body.index(name) for name in body)
        return Topology(tuple(signs), tuple(decisions), names)


@cache
def _moves(symmetry: Symmetry) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Where corners and faces go."""
    corners = tuple(symmetry.corner(c) for c in range(8))
    faces = [frozenset(face) for face in FACES]
    return corners, tuple(faces.index(frozenset(corners[c] for c in face)) for face in faces)


SYMMETRIES = tuple(
    Symmetry(axes, flips) for axes in permutations(range(3)) for flips in product((0, 1), repeat=3)
)


def exchanged(one: Topology) -> Topology:
    """The topology of -F."""
    return Topology(tuple(-s for s in one.signs), tuple(-f for f in one.faces), one.body)


@cache
def representative(one: Topology, *, mirror: bool = True, exchange: bool = True) -> Topology:
    """The greatest member of the class, the same for all members."""
    sides = (one, exchanged(one)) if exchange else (one,)
    moves = [s for s in SYMMETRIES if mirror or s.is_rotation]
    return max(move.of(side) for move in moves for side in sides)


def classes(*, mirror: bool = True, exchange: bool = True) -> list[Topology]:
    """One member of each class.

    >>> len(classes()), len(classes(mirror=False))
    (31, 33)
    """
    return sorted(
        {representative(one, mirror=mirror, exchange=exchange) for one in every_topology()}
    )


# --- names --------------------------------------------------------------------------------------

# Distances, in edges, between the corners of the smaller side, and the configuration of [2].
CONFIGURATIONS: dict[tuple[int, ...], int] = {
    (1,): 2,
    (2,): 3,
    (3,): 4,
    (1, 1, 2): 5,
    (1, 2, 3): 6,
    (2, 2, 2): 7,
    (1, 1, 1, 1, 2, 2): 8,
    (1, 1, 1, 2, 2, 2): 9,
    (1, 1, 2, 2, 3, 3): 10,
    (1, 1, 1, 2, 2, 3): 11,
    (1, 1, 2, 2, 2, 3): 12,
    (2, 2, 2, 2, 2, 2): 13,
}


def configuration(signs: Signs) -> int:
    """The number of the configuration in Figure 2 of [2].

    >>> configuration((1, -1, -1, -1, -1, -1, -1, 1))
    4
    """
    high = [c for c in range(8) if signs[c] > 0]
    few = high if len(high) <= 4 else [c for c in range(8) if signs[c] < 0]
    if len(few) < 2:
        return len(few)
    found = CONFIGURATIONS[tuple(sorted((a ^ b).bit_count() for a, b in combinations(few, 2)))]
    return 14 if found == 11 and _winds_left(few) else found


def _winds_left(path: list[int]) -> bool:
    """Whether a path of four corners along three axes turns against the right hand."""
    near = {c: [d for d in path if (c ^ d).bit_count() == 1] for c in path}
    walk = [next(c for c in path if len(near[c]) == 1)]
    while len(walk) < 4:
        walk += [d for d in near[walk[-1]] if d not in walk]
    place = np.array([[c >> 2 & 1, c >> 1 & 1, c & 1] for c in walk])
    return bool(np.linalg.det(np.diff(place, axis=0)) < 0)


# Names of the classes of a configuration, by the curves of its sheets and, where these agree, by
# the number of faces on which the smaller side is joined.
NAMES: dict[int, dict[tuple[tuple[int, ...], ...], str]] = {
    3: {((3,), (3,)): "1", ((6,),): "2"},
    4: {((3,), (3,)): "1", ((3, 3),): "2"},
    6: {((3,), (4,)): "1.1", ((3, 4),): "1.2", ((7,),): "2"},
    7: {
        ((3,), (3,), (3,)): "1",
        ((3,), (6,)): "2",
        ((9,),): "3",
        ((3, 6),): "4.2",
    },
    10: {((4,), (4,)): "1.1", ((4, 4),): "1.2", ((8,),): "2"},
    12: {((3,), (5,)): "1.1", ((3, 5),): "1.2", ((8,),): "2"},
    13: {
        ((3,), (3,), (3,), (3,)): "1",
        ((3,), (3,), (6,)): "2",
        ((3,), (9,)): "3",
        ((12,),): "4",
        ((3,), (3, 6)): "5.2",
    },
}


@cache
def case_name(one: Topology) -> str:
    """Chernyaev's name of the topology's class.

    >>> case_name(Topology((1, -1, -1, -1, -1, -1, -1, 1), (0,) * 6, (0, 1, 1, 1, 1, 1, 1, 0)))
    '4.2'
    """
    number = configuration(one.signs)
    if number not in NAMES:
        return str(number)
    name = NAMES[number][one.sheets]
    joined = sum(abs(f) for f in one.faces), abs(sum(one.faces))
    if number == 7 and name == "2" and joined == (3, 3):
        name = "4.1"  # all three faces join the smaller side; case 7.2 joins it on one
    if number == 13 and name == "2" and joined == (6, 0):
        name = "5.1"  # three faces each way; case 13.2 has one against five
    return f"{number}.{name}"


@cache
def every_case() -> tuple[str, ...]:
    """The names in order; 32, as 11 and 14 are mirror images but have two names.

    >>> every_case()[:6]
    ('0', '1', '2', '3.1', '3.2', '4.1')
    """
    names = {case_name(one) for one in every_topology()}
    return tuple(sorted(names, key=lambda name: [int(part) for part in name.split(".")]))


def case_names(truths: Truths) -> NDArray[np.str_]:
    """The case of each cell; meaningless where the cell is a tie."""
    signs = np.where(truths.high, 1, -1)
    rows = np.column_stack([signs, truths.faces, truths.body])
    first, back = distinct(rows)
    names = [
        case_name(Topology(tuple(row[:8]), tuple(row[8:14]), tuple(row[14:])))
        if tied == 0
        else "tie"
        for row, tied in zip(rows[first].tolist(), _ties_of(truths, back), strict=True)
    ]
    return np.array(names, np.str_)[back]


def _ties_of(truths: Truths, back: NDArray[np.int64]) -> list[int]:
    """For each unique row whether a cell that has it is tied."""
    worst = np.zeros(int(back.max(initial=-1)) + 1, np.int64)
    np.maximum.at(worst, back, truths.ties)
    return [int(x) for x in worst]
