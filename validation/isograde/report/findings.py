"""What is wrong and what is right: one finding a cause, and the sentences of the first screen.

A claim that fails is told where it is the root on some case (`isograde.causes`), or else under the
root that most of its cases come from. On the other cases it is counted under what it follows from.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace

from isograde.causes import roots
from isograde.model import EVIDENCE
from isograde.report.diagnosis import diagnoses, right_cells
from isograde.report.headline import BILINEAR, TRILINEAR, chosen
from isograde.report.reading import CONVENTIONS, Report, Summary, bad_in, bad_of

# What holds, said of a claim that holds wherever it could fail; whole families are said as one.
WHOLE = {"structure": "the arrays are well formed", "bodies": "known bodies come out"}
HOLDS = {
    "topology.closed": "there is no hole",
    "topology.oriented": "neighbours turn alike",
    "topology.sides": "every sample is on its side",
    "topology.manifold": "the mesh is a manifold",
    "geometry.vertices": "every vertex is where it may be",
    "geometry.crossing": "every crossing is where the interpolant has it",
    "geometry.embedded": "nothing crosses",
    "cells.legal": "every cell is legal",
    "topology.bilinear": "every ambiguous face is decided as the bilinear interpolant does",
    "topology.trilinear": "every cell has the topology of the trilinear interpolant",
}
ALIKE = "the answer is the same however the field is posed"


@dataclass(frozen=True)
class Follower:
    """A claim that fails because another does: on so many of its cases."""

    summary: Summary
    cases: int

    @property
    def wholly(self) -> bool:
        """It fails on no other case."""
        return self.cases == self.summary.bad


@dataclass(frozen=True)
class Cause:
    """One thing that is wrong.

    Attributes
    ----------
    root : the claim that says it most directly
    said : the diagnosis, a sentence without a full stop
    general, tied : cases of which it is the root, in general position and with ties
    follows : claims that fail because of it, those that fail for nothing else first
    elsewhere : the claims that the root follows from on its other cases, with how many
    choice : it is a choice that the implementation makes on every case
    held : it, or what follows from it alone, is promised
    mistakes : so many are told in the diagnosis, where more than one is seen
    """

    root: Summary
    said: str
    general: int
    tied: int
    follows: tuple[Follower, ...] = ()
    elsewhere: tuple[Follower, ...] = ()
    choice: bool = False
    held: bool = False
    mistakes: int = 1

    @property
    def told(self) -> list[Summary]:
        """The claims that this finding tells: the root, and what fails for nothing else."""
        return [self.root, *(one.summary for one in self.follows if one.wholly)]

    @property
    def cases(self) -> int:
        """Cases of which it is the root."""
        return self.general + self.tied


def causes(report: Report) -> list[Cause]:
    """What is wrong: what is held against the implementation first, then by level."""
    if "causes" not in report.memory:
        report.memory["causes"] = _causes(report)
    found: list[Cause] = report.memory["causes"]
    return found


def _causes(report: Report) -> list[Cause]:
    """The same, computed."""
    failing = {summary.id: summary for summary in report.failures}
    found, ties = _counted(report, failing)
    told = {claim: _told_under(claim, found) for claim in failing}
    rows = [
        _cause(report, claim, failing, found, ties, told)
        for claim in failing
        if told[claim] == claim
    ]
    return sorted(rows, key=_rank)


def _counted(
    report: Report, failing: dict[str, Summary]
) -> tuple[Counter[tuple[str, str]], Counter[str]]:
    """(claim, root) with how many cases, and each root's cases with ties."""
    found, ties = Counter[tuple[str, str]](), Counter[str]()
    for result in report.results:
        bad = {
            name: finding.get("numbers", {})
            for name, _, finding in bad_of(result)
            if name in failing
        }
        for claim, root in roots(bad).items():
            found[claim, root] += 1
            ties[claim] += claim == root and not result["general"]
    return found, ties


def _told_under(claim: str, found: Counter[tuple[str, str]]) -> str:
    """The root that a claim is told under: itself where it is one, or the most frequent one."""
    mine = {root: n for (one, root), n in found.items() if one == claim}
    return claim if claim in mine else max(mine, key=lambda root: mine[root])


def _cause(
    report: Report,
    claim: str,
    failing: dict[str, Summary],
    found: Counter[tuple[str, str]],
    ties: Counter[str],
    told: dict[str, str],
) -> Cause:
    """The finding whose root is this claim."""
    root = failing[claim]
    follows = [
        Follower(failing[one], n) for (one, of), n in found.items() if of == claim and one != claim
    ]
    # A claim that is nowhere a root is told under one of its roots, and there alone.
    follows = [
        replace(one, cases=one.summary.bad) if told[one.summary.id] == claim else one
        for one in follows
        if told[one.summary.id] in (claim, one.summary.id)
    ]
    follows.sort(key=lambda one: (not one.wholly, -one.cases))
    elsewhere = [
        Follower(failing[of], n) for (one, of), n in found.items() if one == claim and of != claim
    ]
    own, by = found[claim, claim], chosen(report) if claim == BILINEAR else []
    clauses = diagnoses(report, root)
    said = "; ".join(clauses)
    made = Cause(
        root,
        f"{'; '.join(by)}: {said}" if by else said,
        own - ties[claim],
        ties[claim],
        tuple(follows),
        tuple(elsewhere),
        bool(by) and not root.promised,
        mistakes=len(clauses),
    )
    held = any(one.promised and one.id not in CONVENTIONS for one in made.told)
    return replace(made, held=held)


def _rank(cause: Cause) -> tuple[bool, bool, bool, int, int]:
    """What is held first, choices last; general position before ties, by level, most cases first.

    So torn comes before wrong topology, and that before wasteful.
    """
    level = cause.root.level
    beside = 99 if level is None else level
    return (not cause.held, cause.choice, not cause.general, beside, -cause.cases)


def by_choice(report: Report) -> set[str]:
    """The claims that fail for a choice which the implementation always makes, and nothing else."""
    return {one.id for cause in causes(report) if cause.choice for one in cause.told}


def rights(report: Report) -> list[str]:
    """What is right on every case tried, in words, and the cells that are right where some are not.

    What fails with ties alone is right "but for ties".
    """
    said = [*_whole(report), *_held(report), *_alike(report)]
    cells = right_cells(report)
    if cells and (summary := report.summaries.get(TRILINEAR)) and summary.bad:
        said.append(f"the topology is right in {cells}")
    return said


def _whole(report: Report) -> list[str]:
    """Families of which every claim of the ladder holds."""
    return [
        told
        for family, told in WHOLE.items()
        if _all([s for s in report.summaries.values() if s.family == family])
    ]


def _held(report: Report) -> list[str]:
    """Single claims that hold."""
    said = []
    for name, told in HOLDS.items():
        summary = report.summaries.get(name)
        if summary is None or not summary.evidence or bad_in(summary.general):
            continue
        if not summary.bad:
            said.append(told)
        elif any(summary.general[verdict.value] for verdict in EVIDENCE):
            said.append(f"but for ties, {told}")
    return said


def _alike(report: Report) -> list[str]:
    """The claims on symmetry, types and layouts."""
    alike = [s for s in report.summaries.values() if s.family in ("symmetry", "robustness")]
    return [ALIKE] if _all(alike) else []


def _all(summaries: list[Summary]) -> bool:
    """The claims of the ladder among these hold on evidence."""
    ladder = [summary for summary in summaries if summary.level is not None]
    judged = [summary for summary in ladder if summary.evidence]
    return bool(judged) and not any(summary.bad for summary in judged)
