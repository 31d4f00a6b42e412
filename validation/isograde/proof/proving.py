"""A rule put to the proof: every premise and condition, how it was checked, and what follows."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from isoref.rule import Rule, Tile

from isograde.proof import adversarial, premises
from isograde.proof.meetings import Tear, meetings_of, shared_chords, tears_at
from isograde.proof.tiles import Case, Cell, cell_of, faults_in

TRIALS = 60_000


@dataclass(frozen=True)
class Check:
    """One premise or condition: what must hold, how that was checked, and what is wrong.

    tried : it was tried on samples; else every case was seen
    reached : an earlier fault did not keep it from being checked
    """

    name: str
    sentence: str
    how: str
    faults: tuple[str, ...] = ()
    tried: bool = False
    reached: bool = True

    @property
    def holds(self) -> bool:
        """It was checked, and nothing is wrong."""
        return self.reached and not self.faults

    def lines(self, shown: int) -> list[str]:
        """The check in words, with the first few of its faults."""
        mark = "not reached" if not self.reached else "broken" if self.faults else "holds"
        first = f"  {mark:<12} {self.name}: {self.sentence}"
        if not self.reached:
            return [first]
        faults = [f"    - {fault}" for fault in self.faults[:shown]]
        hidden = len(self.faults) - shown
        more = [f"    and {hidden} more"] if hidden > 0 else []
        return [first, f"{'':<15}checked {self.how}", *faults, *more]


@dataclass(frozen=True)
class Proof:
    """What was checked of a rule; it is proved where every check holds.

    rule, bits, asked : the rule's name, its bits, and the signs it is asked for
    tiles : the tile of every case
    meetings : how many kinds of face two cells can meet at
    tears : pairs of cells that break condition 3
    trials : pairs of cells on which decisions were tried; 0 where the rule is never asked
    """

    rule: str
    bits: int
    asked: tuple[int, ...]
    checks: tuple[Check, ...]
    tiles: dict[Case, Tile] = field(default_factory=dict)
    meetings: int = 0
    tears: tuple[Tear, ...] = ()
    trials: int = 0

    @property
    def holds(self) -> bool:
        """The rule is closed, oriented and manifold on every field, under the condition stated."""
        return bool(self.checks) and all(check.holds for check in self.checks)

    @property
    def broken(self) -> tuple[str, ...]:
        """The names of the checks that found a fault."""
        return tuple(check.name for check in self.checks if check.faults)

    @property
    def sentence(self) -> str:
        """What is proved, with its condition."""
        given = (
            "Given that a decision on a face is a function of the face's four values, on"
            if self.bits and self.asked
            else "On"
        )
        return (
            f"{given} every field on every finite lattice the mesh of {self.rule} is closed off "
            "the border of the lattice, oriented with the inside behind it, and manifold, all by "
            "index."
        )

    def text(self, shown: int = 8) -> str:
        """The result in words, with the first few of what is wrong."""
        lines = [
            f"{self.rule}: {len(self.tiles)} tiles, {self.meetings} kinds of face at which two "
            "cells meet.",
            *(line for check in self.checks for line in check.lines(shown)),
        ]
        if not self.holds:
            broken = ", ".join(self.broken)
            return "\n".join(
                [*lines, f"Not proved: {broken}. The conditions are sufficient, not necessary."]
            )
        return "\n".join(
            [
                *lines,
                f"Proved. {self.sentence}",
                "By index: vertices are told apart by their numbers. A sample on the isovalue is "
                "inside; where there are such, vertices of different numbers may coincide.",
                "Not claimed: that triangles do not cut each other in space.",
            ]
        )


def prove(rule: Rule, trials: int = TRIALS) -> Proof:
    """Every premise and condition, checked on every tile and every meeting, or tried."""
    name = str(getattr(rule, "name", "the rule"))
    form = _form(premises.faults_of_form(rule))
    if not form.holds:
        return Proof(name, 0, (), (form, *_unreached(form)))
    asked = tuple(signs for signs in range(256) if rule.asks(signs))
    tiles, faults = premises.tiles_of(rule)
    defined = _tiles(faults, len(tiles))
    if not defined.holds:
        return Proof(name, rule.bits, asked, (form, defined, *_unreached(form, defined)), tiles)
    cells = [cell_of(case, tile) for case, tile in tiles.items()]
    meetings = meetings_of(rule.bits, cells)
    tears = [tear for key, sides in meetings.items() for tear in tears_at(key, *sides)]
    chords = [fault for key, sides in meetings.items() for fault in shared_chords(key, *sides)]
    tried = _trials(rule, trials) if asked else ()
    checks = (
        form,
        defined,
        *tried,
        _asked(tears),
        _in_each(1, cells),
        _in_each(2, cells),
        _at_faces(tears, len(meetings)),
        _chords(chords, len(meetings)),
        _in_each(5, cells),
    )
    done = len(tried) and premises.trials_each(trials) * 3 * len(adversarial.KINDS)
    return Proof(name, rule.bits, asked, checks, tiles, len(meetings), tuple(tears), done)


# ------------------------------------------------------------------------------------------------
# Premises
# ------------------------------------------------------------------------------------------------


def _form(faults: Iterable[str]) -> Check:
    """The rule has the form of a rule."""
    return Check(
        "form",
        "a rule has tiles, decisions of a fixed number of bits, and says for which signs it is "
        "asked for them.",
        "by asking twice for all 256 signs",
        tuple(faults),
    )


def _tiles(faults: Iterable[str], count: int) -> Check:
    """Every case has one tile, and it names nodes that are there."""
    return Check(
        "tiles",
        "a tile follows from signs and decision, and its triangles name nodes that are there, "
        "every interior one among them.",
        f"on all cases, each asked twice: {count} tiles",
        tuple(faults),
    )


DECISIONS = {
    "range": (
        "decisions in range",
        "a decision is one of those enumerated, and decides no face that is not ambiguous.",
    ),
    "cell": (
        "decisions of a cell",
        "a cell's decision follows from its own eight values.",
    ),
    "face": (
        "decisions of a face",
        "a decision on a face is a function of the face's four values: both cells come to the "
        "same one.",
    ),
}


CELL_HOW = (
    "on the same pairs: all in one call, in smaller ones, backwards, in another layout, some by "
    "themselves"
)


def _trials(rule: Rule, trials: int) -> tuple[Check, ...]:
    """The premises on decisions, tried."""
    faults = dict(premises.faults_of_decisions(rule, trials))
    each = premises.trials_each(trials)
    how = (
        f"on {3 * each * len(adversarial.KINDS)} pairs of cells that share a face, by trial and "
        f"not by proof: on each axis {each} of each of {', '.join(adversarial.KINDS)}"
    )
    # After a decision that is none, nothing more was tried.
    reached = "range" not in faults
    return tuple(
        Check(
            name,
            sentence,
            {"range": how, "cell": CELL_HOW, "face": "on the same pairs"}[key],
            (faults[key],) if key in faults else (),
            tried=True,
            reached=reached or key in faults,
        )
        for key, (name, sentence) in DECISIONS.items()
    )


def _unreached(*reached: Check) -> tuple[Check, ...]:
    """The checks that were not come to, and say so."""
    names = {check.name for check in reached}
    empty = (
        _tiles((), 0),
        *(Check(name, sentence, "") for name, sentence in DECISIONS.values()),
        _asked(()),
        _in_each(1, ()),
        _in_each(2, ()),
        _at_faces((), 0),
        _chords((), 0),
        _in_each(5, ()),
    )
    return tuple(
        Check(check.name, check.sentence, "", reached=False)
        for check in empty
        if check.name not in names
    )


# ------------------------------------------------------------------------------------------------
# Conditions
# ------------------------------------------------------------------------------------------------

CONDITIONS = {
    1: "every crossed edge has its node, no triangle names a node twice, no directed edge occurs "
    "twice.",
    2: "segments lie on faces, with the inside on their right.",
    5: "the triangles round each node are one fan.",
}


def _in_each(number: int, cells: Iterable[Cell]) -> Check:
    """Condition 1, 2 or 5, on every tile."""
    found = [list(faults_in(cell)) for cell in cells]
    faults = tuple(fault for one in found for n, fault in one if n == number)
    # Where condition 1 is broken, faults of the others would only repeat it.
    kept = sum(all(n != 1 for n, _ in one) for one in found)
    whole = number == 1 or kept == len(found)
    how = f"on all {len(found)} tiles" if whole else f"on the {kept} tiles that keep condition 1"
    return Check(f"condition {number}", CONDITIONS[number], how, faults)


def _asked(tears: Iterable[Tear]) -> Check:
    """The part of condition 3 that concerns cells without a decision."""
    return Check(
        "cells that are not asked",
        "where the rule is not asked and a decision counts as 0, the tile fits a neighbour that "
        "is asked, whatever it decides.",
        "on all pairs of cells that can meet at a face",
        _torn([tear for tear in tears if tear.unasked]),
    )


def _at_faces(tears: Iterable[Tear], meetings: int) -> Check:
    """Condition 3, on every pair of tiles that can meet."""
    return Check(
        "condition 3",
        "at a face both cells have the same segments, in opposite directions.",
        f"on all pairs of cells at {meetings} kinds of face",
        _torn([tear for tear in tears if not tear.unasked]),
    )


def _torn(tears: list[Tear]) -> tuple[str, ...]:
    """Pairs that tear, in words; first how many."""
    if not tears:
        return ()
    head = (
        f"{len(tears)} pairs of cells tear at the face they share (a cell is its eight signs, "
        "corner 7 first; places on the face in half steps)"
    )
    return (head, *map(str, tears))


def _chords(faults: Iterable[str], meetings: int) -> Check:
    """Condition 4, on every pair of tiles that can meet."""
    return Check(
        "condition 4",
        "no chord of a face is one of both its cells.",
        f"on all pairs of cells at {meetings} kinds of face",
        tuple(faults),
    )
