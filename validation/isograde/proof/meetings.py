"""Two tiles at a face: conditions 3 and 4 of the argument (`isograde.proof`).

A *meeting* is a kind of face at which two cells can meet: its axis, the signs of its four corners,
and what is decided on it. A cell that decides its face, because the rule is asked for it and has a
bit for this face, takes part in the meetings of its own decision. A cell that does not, reads 0; it
takes part in the meetings with decision 0, and where any cell across the face can decide 1 in these
as well.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

from isograde.proof.tiles import (
    FACES,
    Cell,
    Edge,
    Face,
    Place,
    common_face,
    corners_of,
    directed,
    flat,
    segments,
)


class Meeting(NamedTuple):
    """A kind of face at which two cells can meet."""

    axis: int
    signs: tuple[bool, ...]
    decision: int


@dataclass(frozen=True)
class Side:
    """What a cell does on one of its faces, in coordinates of the face.

    decides : the cell has a decision on the face; else it reads 0
    """

    cell: Cell
    segments: frozenset[tuple[Place, Place]]
    chords: frozenset[frozenset[Place]]
    decides: bool


Sides = tuple[set[Side], set[Side]]


@dataclass(frozen=True)
class Tear:
    """Two cells that can meet at a face and do not agree there."""

    axis: int
    low: Side
    high: Side
    decision: int

    @property
    def unasked(self) -> bool:
        """One of the cells reads 0 where the other decides 1."""
        return self.decision == 1 and not (self.low.decides and self.high.decides)

    def __str__(self) -> str:
        return (
            f"axis {self.axis}: {self.low.cell} below draws {_drawn(self.low.segments)}, "
            f"{self.high.cell} above draws {_drawn(self.high.segments)}"
        )


def meetings_of(bits: int, cells: Iterable[Cell]) -> dict[Meeting, Sides]:
    """For each meeting the cells below the face and the cells above it."""
    found: dict[Meeting, Sides] = defaultdict(lambda: (set(), set()))
    reading = []
    for cell in cells:
        edges = segments(cell)
        chords = set(directed(cell)) - set(edges)
        for f, face in enumerate(FACES):
            axis, side = face
            signs = tuple(cell.case.inside(corner) for corner in corners_of(face))
            decides = cell.case.asked and f < bits
            decision = cell.case.decision >> f & 1 if decides else 0
            below = 0 if side == 2 else 1  # The upper face of a cell is where it is the cell below.
            this = _side(cell, face, edges, chords, decides)
            found[Meeting(axis, signs, decision)][below].add(this)
            if not decides:
                reading.append((Meeting(axis, signs, 1), below, this))
    # Cells that read 0 also meet those that decide 1, where there are such.
    for meeting, below, this in reading:
        if meeting in found:
            found[meeting][below].add(this)
    return dict(found)


def _side(
    cell: Cell, face: Face, edges: Iterable[Edge], chords: Iterable[Edge], decides: bool
) -> Side:
    """The segments and chords of a cell that lie on this face."""

    def here(group: Iterable[Edge]) -> list[tuple[Place, Place]]:
        return [
            (flat(face, p), flat(face, q))
            for p, q in group
            if not isinstance(p, int) and not isinstance(q, int)
            if p != q and common_face(p, q) == face
        ]

    chords_here = frozenset(frozenset(edge) for edge in here(chords))
    return Side(cell, frozenset(here(edges)), chords_here, decides)


def tears_at(meeting: Meeting, below: set[Side], above: set[Side]) -> Iterator[Tear]:
    """The pairs whose segments are not the same in opposite directions."""
    ordered = sorted(above, key=_by_cell)
    for low in sorted(below, key=_by_cell):
        turned = frozenset((q, p) for p, q in low.segments)
        for high in ordered:
            if high.segments != turned:
                yield Tear(meeting.axis, low, high, meeting.decision)


def _by_cell(side: Side) -> tuple[int, int]:
    """A side's cell, to sort by."""
    return side.cell.case.signs, side.cell.case.decision


def shared_chords(meeting: Meeting, below: set[Side], above: set[Side]) -> Iterator[str]:
    """The chords that a cell below and a cell above can both have, in words."""
    low = {chord: side for side in below for chord in side.chords}
    high = {chord: side for side in above for chord in side.chords}
    for chord in sorted(low.keys() & high.keys(), key=sorted):
        p, q = sorted(chord)
        yield (
            f"axis {meeting.axis}: cells {low[chord].cell} and {high[chord].cell} both have the "
            f"chord {p}-{q} on the face they share: four triangles meet there"
        )


def tears_by_face(tears: Iterable[Tear]) -> dict[tuple[int, tuple[bool, ...]], int]:
    """How many pairs of cells tear, by axis and signs of the face they share."""
    counts: Counter[tuple[int, tuple[bool, ...]]] = Counter()
    for tear in tears:
        case = tear.low.cell.case
        counts[tear.axis, tuple(case.inside(c) for c in corners_of((tear.axis, 2)))] += 1
    return dict(counts)


def _drawn(pieces: frozenset[tuple[Place, Place]]) -> str:
    """Segments in the face's half steps."""
    return " and ".join(f"{p}-{q}" for p, q in sorted(pieces)) or "nothing"
