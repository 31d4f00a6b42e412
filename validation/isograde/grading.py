"""One implementation graded from adapter to report.

The JSON lines are written while the cases run, into a file beside the report that takes its place
at the end. A run that is cut off leaves there what it found, without a footer, and the report of an
earlier run as it was. The pages are made from the lines afterwards, and can be made again from
them.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from isograde.adapters import open_adapter
from isograde.adapters.loading import called
from isograde.causes import roots
from isograde.declaration import Declaration
from isograde.model import (
    BAD,
    CONTOURS,
    CURVES,
    SURFACES,
    Adapter,
    AdapterError,
    Kind,
    Outcome,
    Request,
    Trial,
    Verdict,
)
from isograde.report import lines, reading, record, shown
from isograde.runner import Evidence, Judged, Options, Task, Worker, plan, run
from isograde.shrinking import shrink

# A second process costs a start; below so many cases it does not pay.
CASES_PER_JOB = 60
# Show the answer of one of these beside a failed one, where the claim holds of it; for any other
# kind, and for simplices, that of the last.
CONTRAST: Mapping[Kind, tuple[str, ...]] = {
    SURFACES: ("isoref:asymptotic-decider", "isoref:trilinear-cubes"),
    CONTOURS: ("isoref:diconex-mixed",),
    CURVES: ("isoref:marching-faces",),
}
SIMPLICIAL, LABELS = "isoref:simplicial", "isoref:label-cubes"
DUAL = ("isoref:dual-marching-cubes", "isoref:surface-nets")

Watch = Callable[[int, int, record.Tally], None]


@dataclass(frozen=True, eq=False)
class Smallest:
    """The smallest case on which a claim failed, and what it is made from.

    follows : the claim fails there because another does
    """

    judged: Judged
    samples: int
    of: str = ""
    follows: bool = False

    @property
    def size(self) -> tuple[bool, bool, int]:
        """What makes a case small: general position first, then that the claim is the root."""
        return (not self.judged.general, self.follows, self.samples)


def grade(
    spec: str,
    options: Options,
    path: Path,
    *,
    arguments: Sequence[str] = (),
    watch: Watch | None = None,
) -> reading.Report:
    """The report of one implementation, written to `path` line by line.

    Raises
    ------
    AdapterError
        where the implementation does not start.
    NothingToRun
        where no case and claim match.
    """
    start = time.perf_counter()
    worker = Worker.open(spec, options)
    try:
        tasks = plan(options, worker.cases, worker.claims)
        options = replace(options, jobs=max(1, min(options.jobs, len(tasks) // CASES_PER_JOB)))
        path.parent.mkdir(parents=True, exist_ok=True)
        draft = unfinished(path)
        with lines.open_text(draft, "w") as file:
            writer = Writer(file, worker, options.only)
            writer.write(record.header(called(spec), worker.declaration, options, list(arguments)))
            writer.write_claims(tasks)
            tally, smallest = writer.write_results(tasks, run(spec, tasks, options, worker), watch)
            writer.write_evidence(smallest, options)
            seconds = time.perf_counter() - start
            writer.write(tally.footer(seconds, reading.gather(writer.records)))
        draft.replace(path)
    finally:
        worker.adapter.close()
    return reading.gather(writer.records)


def unfinished(path: Path) -> Path:
    """Where the lines of the report `path` stand until it has all of them."""
    return path.with_name(f"unfinished-{path.name}")


class Writer:
    """Writes records, and keeps them for the pages."""

    def __init__(self, file: Any, worker: Worker, only: Sequence[str] = ()):
        self.file = file
        self.only = only
        self.worker = worker
        self.records: list[lines.JSON] = []

    def write(self, line: lines.JSON) -> None:
        """One more line."""
        self.records.append(lines.write_line(self.file, line))

    def write_claims(self, tasks: Sequence[Task]) -> None:
        """A line for each claim stated for the implementation, or in part for each that is judged.

        A claim that no task judges is shown too: it is without evidence.
        """
        judged = {name for task in tasks for name in task.claims}
        for name, claim in self.worker.claims.items():
            if not self.only or name in judged:
                self.write(record.claim_record(claim, self.worker.declaration))

    def write_results(
        self, tasks: Sequence[Task], judgements: Any, watch: Watch | None
    ) -> tuple[record.Tally, dict[str, Smallest]]:
        """A case and a result line for each task; what was counted, and the smallest failures."""
        tally, smallest = record.Tally(), dict[str, Smallest]()
        for judged in judgements:
            case = self.worker.cases[judged.case]
            self.write(record.case_record(case))
            self.write(record.result_record(judged, self.worker.claims))
            tally.add(judged)
            _keep(smallest, judged, case.samples)
            if watch is not None:
                watch(tally.cases, len(tasks), tally)
        return tally, smallest

    def write_evidence(self, smallest: Mapping[str, Smallest], options: Options) -> None:
        """A line for each failed claim whose smallest case, made smaller still, can be shown."""
        worker = self.worker
        found = {claim: _shrunk(claim, one, worker) for claim, one in smallest.items()}
        kept = {claim: one for claim, one in found.items() if one.judged.evidence is not None}
        legal = self._legal({claim: one.judged for claim, one in kept.items()}, options)
        for claim, one in kept.items():
            judged, posed = one.judged, worker.claims[claim].variants
            answer = legal.get(claim)
            self.write(shown.evidence_record(claim, judged, one.of, answer, posed))

    def _legal(self, judgements: Mapping[str, Judged], options: Options) -> dict[str, Outcome]:
        """For each claim an answer to its failed case that is right, where one was found."""
        found: dict[str, Outcome] = {}
        declared = self.worker.declaration
        for spec in _references(declared, {judged.kind for judged in judgements.values()}):
            asked = {name: one for name, one in judgements.items() if name not in found}
            answers = contrast(spec, list(asked.values()), options, declared)
            for name, judged in asked.items():
                answer = answers.get(judged.case)
                if answer is not None and self._right(name, judged, answer):
                    found[name] = answer
        return found

    def _right(self, name: str, judged: Judged, answer: Outcome) -> bool:
        """Whether the claim holds of this answer, and none fails of the levels that are claimed.

        Claims that compare variants are not asked: there is one answer.
        """
        claims, evidence, declared = self.worker.claims, judged.evidence, self.worker.declaration
        if claims[name].variants or evidence is None or answer.mesh_of(judged.kind) is None:
            return False
        case = self.worker.cases[judged.case]
        trial = Trial(case, evidence.field, declared, {"plain": answer})
        if claims[name].judge(trial).verdict is not Verdict.PASS:
            return False
        claimed = (
            claim
            for claim in claims.values()
            if claim.level is not None
            and claim.level <= declared.level
            and not claim.variants
            and claim.applies_to(case)
        )
        return not any(claim.judge(trial).verdict in BAD for claim in claimed)


def _keep(smallest: dict[str, Smallest], judged: Judged, samples: int) -> None:
    """`smallest` knows this case for each claim that failed on it and on no smaller one.

    A case in general position is shown before one with ties: it is the one that ends a level. One
    on which the claim is the root comes before one on which it follows from another.
    """
    bad = {name: one.numbers for name, one in judged.findings.items() if one.verdict in BAD}
    root = roots(bad)
    for claim, finding in judged.findings.items():
        known = smallest.get(claim)
        if finding.verdict not in BAD:
            continue
        one = Smallest(judged, samples, follows=root[claim] != claim)
        if known is None or one.size < known.size:
            smallest[claim] = one


def _references(declared: Declaration, kinds: Collection[Kind]) -> list[str]:
    """The references to ask about these kinds, of the declared family; the simplest answer first.

    Of a split there are those of the same one, where it is Kuhn's.
    """
    if declared.interpolant == "tetrahedra":
        return [] if declared.split.simplices else [SIMPLICIAL]
    if declared.vertices == "cells":
        return list(DUAL)
    specs = [spec for kind in kinds for spec in CONTRAST.get(kind, (SIMPLICIAL,))]
    labels = [LABELS] if declared.interpolant == "labels" else []
    return list(dict.fromkeys([*labels, *specs]))


def _shrunk(claim: str, found: Smallest, worker: Worker) -> Smallest:
    """The smallest and simplest part of the case on which the claim fails, or the case as it is."""
    case = worker.cases[found.judged.case]
    less = shrink(worker, case, worker.claims[claim], found.judged)
    if less is None:
        return found
    return Smallest(less, worker.cases[less.case].samples, case.id)


def contrast(
    spec: str, judgements: Sequence[Judged], options: Options, declared: Declaration
) -> dict[str, Outcome]:
    """What `spec` makes of these cases, by case; nothing where it does not start.

    Ties count on the side that is declared.
    """
    tie = declared.conventions.tie
    if not judgements:
        return {}
    adapter = open_adapter(spec)
    try:
        takes = adapter.open(options.limits).limits
    except AdapterError:
        return {}
    wanted = {one.case: one.evidence for one in judgements if tuple(one.kind) in takes.kinds}
    try:
        return {
            case: _answer(adapter, case, evidence, tie)
            for case, evidence in wanted.items()
            if evidence is not None
        }
    finally:
        adapter.close()


def _answer(adapter: Adapter, case: str, evidence: Evidence, tie: str) -> Outcome:
    """The adapter's answer, whose ties are inside, as it is where ties are on the side `tie`.

    A value is above the isovalue where the negated value is not at least the negated isovalue: the
    same level set, with the sides of each component exchanged.
    """
    field, isovalues = evidence.field, evidence.isovalues
    if tie == "inside":
        return adapter.run(Request(case, "plain", field, isovalues))
    negated = replace(field, values=-np.asarray(field.values, np.float64))
    outcome = adapter.run(Request(case, "plain", negated, tuple(-one for one in isovalues)))
    rows = outcome.simplices
    if rows is None or rows.ndim != 2 or rows.shape[1] < 2 or len(isovalues) % 2 == 0:
        return outcome
    return replace(outcome, simplices=rows[:, [*range(rows.shape[1] - 2), -1, -2]])
