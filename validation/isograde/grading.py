"""One implementation graded from adapter to report.

The JSON lines are written while the cases run, into a file beside the report that takes its place
at the end. A run that is cut off leaves there what it found, without a footer, and the report of an
earlier run as it was. The pages are made from the lines afterwards, and can be made again from
them.
"""

from __future__ import annotations

import hashlib
import math
import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from dataclasses import field as fresh
from itertools import accumulate
from pathlib import Path
from types import MappingProxyType

import numpy as np

from isograde import cluster
from isograde.adapters import open_adapter
from isograde.adapters.loading import called
from isograde.bounds import GivenUp, at_most
from isograde.causes import roots
from isograde.declaration import Declaration
from isograde.drafts import Draft, fingerprint, unfinished
from isograde.expectations import Expectations, is_expected
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
from isograde.runner import Evidence, Judged, Options, Task, Worker, part, plan, run
from isograde.shrinking import shrink

# Keep this share of a budget for the evidence and the pages.
SHARE = 0.2
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

Say = Callable[[str], None]
Watch = Callable[[int, int, record.Tally], None]


@dataclass(frozen=True, eq=False)
class Smallest:
    """The smallest case on which a claim failed, and what it is made from.

    follows : the claim fails there because another does
    """

    judged: Judged
    samples: int
    of: str = ""
    expected: bool = False
    follows: bool = False

    @property
    def size(self) -> tuple[bool, bool, bool, int]:
        """What makes a case small: not expected, in general position, the claim the root."""
        return (self.expected, not self.judged.general, self.follows, self.samples)


def grade(
    spec: str,
    options: Options,
    path: Path,
    *,
    arguments: Sequence[str] = (),
    watch: Watch | None = None,
    resume: bool | None = None,
    interruptible: bool = False,
    keep_draft: bool = False,
    say: Say | None = None,
    expected: Expectations | None = None,
) -> reading.Report:
    """The report of one implementation, written to `path`.

    What was judged is kept beside it as it comes (`isograde.drafts`), and taken from there where an
    earlier run of the same was stopped. Where the budget is used up the report is of what was
    judged until then, and says so; the rest can be judged later.

    resume : True insists on an earlier run's draft, False begins anew
    keep_draft : the draft stays until `finished(path)`, after whatever is made of the report
    interruptible : Ctrl-C stops as a budget does, with a report at `interrupted(path)`
    say : called with what is worth a sentence meanwhile
    expected : failures that are known: told in the report, and shown only where a claim has no
        other

    Raises
    ------
    AdapterError
        where the implementation does not start.
    NothingToRun
        where no case and claim match.
    Busy, NotResumed
        where another process grades into this place; where there is nothing to go on with.
    """
    worker = Worker.open(spec, options)
    how = Manner(watch, resume, interruptible, keep_draft, say, expected or {})
    try:
        return graded_by(worker, spec, options, path, arguments, how)
    finally:
        worker.adapter.close()


@dataclass(frozen=True)
class Manner:
    """How a run is watched and stopped; see `grade`."""

    watch: Watch | None = None
    resume: bool | None = None
    interruptible: bool = False
    keep_draft: bool = False
    say: Say | None = None
    expected: Expectations = fresh(default_factory=dict)


def graded_by(
    worker: Worker,
    spec: str,
    options: Options,
    path: Path,
    arguments: Sequence[str] = (),
    how: Manner | None = None,
) -> reading.Report:
    """The report by an open worker, written to `path`; see `grade`."""
    start, how = time.monotonic(), how or Manner()
    whole = plan(options, worker.cases, worker.claims)
    tasks = part(whole, options)
    options = replace(options, jobs=max(1, min(options.jobs, len(tasks) // CASES_PER_JOB)))
    first = _beginning(spec, whole, worker, options, arguments, how.expected)
    with Draft.of(path, first, how.resume) as draft:
        judging = Judging(worker, options, draft, start, how.expected)
        stopped = judging.all(spec, tasks, how)
        records = _records(first, tasks, judging, stopped, start)
        report = reading.gather(records)
        lines.write_lines(records, place_of(path, report))
        if stopped is None and not how.keep_draft:
            draft.remove()
    return report


def finished(path: Path, report: reading.Report) -> None:
    """The draft of a whole report is gone: a process that is killed now has lost nothing."""
    if report.stopped is None:
        unfinished(path).unlink(missing_ok=True)


INTERRUPTED = "interrupted"


def place_of(path: Path, report: reading.Report) -> Path:
    """Where a report is written: what Ctrl-C leaves takes the place of no whole report."""
    was = report.stopped is not None and report.stopped["why"] == INTERRUPTED
    return path.with_name(f"{INTERRUPTED}-{path.name}") if was else path


def _beginning(
    spec: str,
    tasks: Sequence[Task],
    worker: Worker,
    options: Options,
    arguments: Sequence[str],
    expected: Expectations,
) -> list[lines.JSON]:
    """The header, and a line for each claim: stated, or in a run of a part judged by some task.

    A claim that no task judges is shown too: it is without evidence.
    """
    judged = {name for task in tasks for name in task.claims}
    header = record.header(called(spec), worker.declaration, options, list(arguments), expected)
    header |= {"tasks": checksum(tasks), "fingerprint": fingerprint(spec, options.own)}
    claims = [
        record.claim_record(claim, worker.declaration)
        for name, claim in worker.claims.items()
        if not options.only or name in judged
    ]
    return [lines.plain(one) for one in (header, *claims)]


def checksum(tasks: Sequence[Task]) -> str:
    """A number for what is asked: the same for the same cases and claims."""
    digest = hashlib.sha256()
    for task in tasks:
        digest.update(f"{task.case}\n{' '.join(task.claims)}\n".encode())
    return digest.hexdigest()[:16]


def _records(
    first: Sequence[lines.JSON],
    tasks: Sequence[Task],
    judging: Judging,
    stopped: lines.JSON | None,
    start: float,
) -> list[lines.JSON]:
    """The lines of the report in the order of the plan, whatever the order they were judged in."""
    done = judging.draft.done
    records = [*first]
    for task in tasks:
        records += done.get(task.case, ())
    records += map(lines.plain, judging.evidence(tasks))
    report = reading.gather(records)
    tally = record.tally_of(report)
    report.footer = None if stopped is None else {"stopped": stopped}
    seconds = judging.earlier + time.monotonic() - start
    footer = tally.footer(seconds, report)
    if judging.spent and not judging.earlier:
        footer["spent"] = {name: round(one, 3) for name, one in judging.spent.items()}
    return [*records, lines.plain(footer if stopped is None else {**footer, "stopped": stopped})]


class Judging:
    """The judging of a plan: what is known already is not asked again.

    earlier : seconds that earlier runs took for what is taken from them
    spent : seconds that the parts of this run's judging took, added over its processes
    """

    def __init__(
        self,
        worker: Worker,
        options: Options,
        draft: Draft,
        start: float,
        expected: Expectations = MappingProxyType({}),
    ):
        self.worker, self.options, self.draft, self.expected = worker, options, draft, expected
        self.earlier = sum(float(result["seconds"]) for _, result in draft.done.values())
        self.deadline = math.inf if options.budget is None else start + options.budget
        self.smallest: dict[str, Smallest] = {}
        self.judged: dict[str, Judged] = {}
        self.spent: dict[str, float] = {}

    def all(self, spec: str, tasks: Sequence[Task], how: Manner) -> lines.JSON | None:
        """Judge each task; None, or why it was stopped before the end, and how much is left."""
        done = self.draft.done
        left = [task for task in tasks if task.case not in done]
        if how.say is not None and done:
            before = f"{len(done):,} of {len(tasks):,} cases were judged before"
            how.say(f"{before}; --fresh judges all again")
        tally = record.Tally()
        for _, result in done.values():
            tally.add_record(result)
        if self.options.budget is not None:
            left = spread(left, lambda case: self.worker.cases[case].samples)
        why = ""
        if self.options.dask is None:
            results = run(spec, left, self.options, self.worker)
        else:
            results = cluster.run(spec, left, self.options)
        try:
            for judged in results:
                self._take(judged, tally)
                if how.watch is not None:
                    how.watch(tally.cases, len(tasks), tally)
                # Leave a part of the budget for the evidence and the pages.
                if time.monotonic() > self.deadline - SHARE * (self.options.budget or 0.0):
                    why = f"the budget of {self.options.budget:g} s is used up"
                    break
        except KeyboardInterrupt:
            if not how.interruptible:
                raise
            why = INTERRUPTED
        finally:
            results.close()
        rest = len(tasks) - len(done)
        return {"why": why, "left": rest} if why and rest else None

    def _take(self, judged: Judged, tally: record.Tally) -> None:
        """One more case is known, and in the draft."""
        case = self.worker.cases[judged.case]
        pair = (
            lines.plain(record.case_record(case)),
            lines.plain(record.result_record(judged, self.worker.claims)),
        )
        self.draft.add(*pair)
        self.draft.done[judged.case] = pair
        tally.add(judged)
        for name, seconds in record.spent(judged).items():
            self.spent[name] = self.spent.get(name, 0.0) + seconds
        if judged.evidence is not None:
            self.judged[judged.case] = judged
        _keep(self.smallest, judged, case.samples, self.expected)
        kept = {one.judged.case for one in self.smallest.values()}
        self.judged = {name: one for name, one in self.judged.items() if name in kept}

    def evidence(self, tasks: Sequence[Task]) -> Iterator[lines.JSON]:
        """A line for each failed claim whose smallest case, made smaller still, can be shown."""
        self._recall(tasks)
        worker, legal = self.worker, Legal(self.worker, self.options)
        found = {claim: self._shrunk(claim, one) for claim, one in self.smallest.items()}
        kept = {claim: one for claim, one in found.items() if one.judged.evidence is not None}
        answers: dict[str, Outcome] = {}
        if (left := self.deadline - time.monotonic()) > 0:
            with suppress(GivenUp), at_most(left):
                answers = legal.answers({claim: one.judged for claim, one in kept.items()})
        for claim, one in kept.items():
            posed = worker.claims[claim].variants
            yield shown.evidence_record(claim, one.judged, one.of, answers.get(claim), posed)

    def _shrunk(self, claim: str, one: Smallest) -> Smallest:
        """The smallest block on which the claim fails; the case as it is where time is over."""
        left = self.deadline - time.monotonic()
        if left <= 0:
            return one
        try:
            with at_most(left):
                return _shrunk(claim, one, self.worker)
        except GivenUp:
            return one

    def _recall(self, tasks: Sequence[Task]) -> None:
        """`smallest` is over all that was judged, in the order of the plan.

        What an earlier run judged is known by its lines alone; where it has the smallest case of a
        claim, that is judged once more, for its field and its answers.
        """
        sizes: dict[str, tuple[bool, bool, bool, int]] = {}
        where: dict[str, Task] = {}
        for task in tasks:
            if task.case not in self.draft.done:
                continue
            case, result = self.draft.done[task.case]
            bad = {
                one["claim"]: one.get("numbers", {})
                for one in result["findings"]
                if one["verdict"] in BAD
            }
            for name, root in roots(bad).items():
                known = is_expected(self.expected, name, task.case)
                size = (known, not result["general"], root != name, int(case["samples"]))
                if name in bad and (name not in sizes or size < sizes[name]):
                    sizes[name], where[name] = size, task
        again: dict[str, Judged] = dict(self.judged)
        self.smallest = {}
        for name, task in where.items():
            if task.case not in again:
                again[task.case] = self.worker.judge(task)
            judged = again[task.case]
            if name in judged.findings and judged.findings[name].verdict in BAD:
                known, _, follows, samples = sizes[name]
                self.smallest[name] = Smallest(judged, samples, "", known, follows)


def spread(tasks: Sequence[Task], samples: Callable[[str], int]) -> list[Task]:
    """The tasks, small ones first, and of every family as many samples as of the others so far.

    So a part of them is of all kinds, and no large case is waited for before its turn.

    >>> sizes = {"a/1": 9, "a/2": 2, "b/1": 2, "b/2": 2, "b/3": 2, "c/1": 100}
    >>> [one.case for one in spread([Task(name, ()) for name in sizes], sizes.__getitem__)]
    ['a/2', 'b/1', 'b/2', 'b/3', 'a/1', 'c/1']
    """
    families: dict[str, list[Task]] = {}
    for task in sorted(tasks, key=lambda task: samples(task.case)):
        families.setdefault(task.case.split("/")[0], []).append(task)
    ordered = []
    for number, own in enumerate(families.values()):
        spent = accumulate(samples(task.case) for task in own)
        ordered += [(sum_, number, task) for sum_, task in zip(spent, own, strict=True)]
    return [task for _, _, task in sorted(ordered, key=lambda one: one[:2])]


@dataclass(frozen=True)
class Legal:
    """Answers of which a failed claim holds, asked of the references."""

    worker: Worker
    options: Options

    def answers(self, judgements: Mapping[str, Judged]) -> dict[str, Outcome]:
        """For each claim an answer to its failed case that is right, where one was found."""
        found: dict[str, Outcome] = {}
        declared = self.worker.declaration
        for spec in _references(declared, {judged.kind for judged in judgements.values()}):
            asked = {name: one for name, one in judgements.items() if name not in found}
            answers = contrast(spec, list(asked.values()), self.options, declared)
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


def _keep(
    smallest: dict[str, Smallest], judged: Judged, samples: int, expected: Expectations
) -> None:
    """`smallest` knows this case for each claim that failed on it and on no smaller one.

    A case that was not expected to fail is shown before one that was, and one in general position
    before one with ties: it is the one that ends a level. One on which the claim is the root comes
    before one on which it follows from another.
    """
    bad = {name: one.numbers for name, one in judged.findings.items() if one.verdict in BAD}
    root = roots(bad)
    for claim, finding in judged.findings.items():
        known = smallest.get(claim)
        if finding.verdict not in BAD:
            continue
        listed = is_expected(expected, claim, judged.case)
        one = Smallest(judged, samples, "", listed, root[claim] != claim)
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
    return Smallest(less, worker.cases[less.case].samples, case.id, found.expected)


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
