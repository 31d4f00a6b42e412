"""Cases times claims gives findings.

A *plan* says which claims are judged on which cases. A *worker* holds one open adapter, asks each
request of a case once however many claims need it, and has the claims judge what came back. Several
workers share a plan, each a process of its own with an adapter of its own.

What becomes of a claim on a case
---------------------------------
1. "unsupported" where the declaration excludes it (`Claim.unless`), or the call was declined;
2. judges of the raw outcome (structure, robustness) come first;
3. without a mesh, every other claim is "not run": the fault is counted once, where it is;
4. variants are asked only when a claim that needs them is reached.

A judge that raises is a fault of the grader, not of the implementation: the claim is "not run",
and the report says so at its head.
"""

from __future__ import annotations

import multiprocessing
import os
import threading
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from dataclasses import field as fresh
from difflib import get_close_matches
from fnmatch import fnmatchcase

from isoref.field import Field

from isograde.adapters import open_adapter
from isograde.cases import blocks
from isograde.cases.volumes import VolumeError
from isograde.disciplines.registry import READY_MADE, Pose, discipline, pose_surfaces
from isograde.model import (
    Adapter,
    AdapterError,
    Case,
    Claim,
    Declaration,
    Finding,
    Limits,
    Outcome,
    Request,
    Status,
    Trial,
    Verdict,
)

# Keep a failed case whole, for its picture and its numbers, up to this many samples.
SHOWN_SAMPLES = 2200
# Pose a case in every way with ``--full`` up to this many samples.
POSED_SAMPLES = 40_000
# Leave families of thousands of small cases as they stand: cells and noise are posed instead.
UNPOSED = frozenset({"pairs", "trilinear"})
# Give up on an implementation that ran out of time so many times in a row.
PATIENCE = 8
JUDGE_FAULT = "the grader's judge failed"
# Verdicts that say something went wrong; the rest say that nothing was seen, or all was well.
BAD = (Verdict.FAIL, Verdict.ERROR, Verdict.CRASH, Verdict.TIMEOUT)


@dataclass(frozen=True)
class Options:
    """How to grade.

    only : globs on ids of claims or of cases; empty for all
    full : every case, and every variant on all but pairs and large cases
    """

    seed: int = 0
    full: bool = False
    only: tuple[str, ...] = ()
    limits: Limits = fresh(default_factory=Limits)
    jobs: int = 1


@dataclass(frozen=True)
class Task:
    """A case and the claims to judge on it, by id."""

    case: str
    claims: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Evidence:
    """A failed case whole: what was asked, what came, and on which variant."""

    field: Field
    isovalue: float
    outcomes: Mapping[str, Outcome]


@dataclass(frozen=True, eq=False)
class Judged:
    """One case with every finding on it."""

    case: str
    findings: Mapping[str, Finding]
    seconds: float = 0.0
    calls: int = 0
    evidence: Evidence | None = None


class NothingToRun(LookupError):  # noqa: N818 - a state of the plan, not an error of the program
    """No case and claim match what was asked for."""


def plan(options: Options, cases: Mapping[str, Case], claims: Mapping[str, Claim]) -> list[Task]:
    """The tasks in the order of the cases. Raises `NothingToRun`."""
    chosen_claims, chosen_cases = _select(options, cases, claims)
    chosen = any("posed" in case.tags for case in cases.values())
    tasks = []
    for case in chosen_cases.values():
        all_ways = not chosen or _in_all_ways(case, options)
        wanted = tuple(
            claim.id
            for claim in chosen_claims.values()
            if claim.applies_to(case) and (all_ways or not claim.variants)
        )
        if wanted:
            tasks.append(Task(case.id, wanted))
    if not tasks:
        asked = " ".join(options.only) or "the plan"
        known = [*claims, *cases]
        close = [near for one in options.only for near in get_close_matches(one, known, n=1)]
        hint = f"did you mean {' '.join(close)}? " if close else ""
        raise NothingToRun(
            f"nothing matches {asked}; {hint}`isograde list claims` and `isograde list fields` "
            "show ids"
        )
    return tasks


def _in_all_ways(case: Case, options: Options) -> bool:
    """Whether claims that need variants are judged on the case: where that is affordable."""
    if "posed" in case.tags or case.id in options.only:
        return True
    return options.full and not UNPOSED & case.tags and case.samples <= POSED_SAMPLES


def _select(
    options: Options, cases: Mapping[str, Case], claims: Mapping[str, Claim]
) -> tuple[dict[str, Claim], dict[str, Case]]:
    """The claims and the cases that `only` and `full` leave."""
    claim_ids = [name for name in claims if _matches(name, options.only)]
    case_ids = [name for name in cases if _matches(name, options.only)]
    case_ids += [name for name in options.only if name not in cases and _is_block(name, cases)]
    kept = {name: claims[name] for name in claim_ids or claims}
    if options.only and not claim_ids and not case_ids:
        return {}, {}
    shown = {
        name: cases[name]
        for name in case_ids or cases
        if options.full or name in options.only or "full" not in cases[name].tags
    }
    return kept, shown


def _is_block(name: str, cases: Mapping[str, Case]) -> bool:
    """Whether this names a block of a known case."""
    named = blocks.parse(name)
    return named is not None and named[0] in cases


def _matches(name: str, globs: Sequence[str]) -> bool:
    """Whether one of the globs matches."""
    return any(fnmatchcase(name, glob) for glob in globs)


@dataclass
class Worker:
    """One open adapter, and the judging of what comes back through it."""

    adapter: Adapter
    declaration: Declaration
    cases: Mapping[str, Case]
    claims: Mapping[str, Claim]
    pose: Pose = pose_surfaces
    hangs: int = 0

    @classmethod
    def open(cls, spec: str, options: Options) -> Worker:
        """A worker whose adapter is open, with what its discipline asks. Raises `AdapterError`."""
        adapter = open_adapter(READY_MADE.get(spec, spec))
        declaration = adapter.open(options.limits)
        try:
            asked = discipline(declaration.discipline)
        except AdapterError:
            adapter.close()
            raise
        return cls(adapter, declaration, asked.cases(options.seed), asked.claims, asked.pose)

    def judge(self, task: Task) -> Judged:
        """Every finding on one case."""
        case = self.cases[task.case]
        claims = [self.claims[name] for name in task.claims]
        if self.hangs >= PATIENCE:
            gave_up = f"given up after {PATIENCE} calls in a row that ran out of time"
            return _all(case, claims, Finding(Verdict.NOT_RUN, gave_up))
        try:
            field = case.build()
        except VolumeError as error:
            return _all(case, claims, Finding(Verdict.SKIP, str(error)))
        return self._judge(case, field, claims)

    def _judge(self, case: Case, field: Field, claims: Sequence[Claim]) -> Judged:
        """Every finding on one case whose field is built."""
        start = time.perf_counter()
        outcomes: dict[str, Outcome] = {}
        trial = Trial(case, field, self.declaration, outcomes)
        self._ask(trial, outcomes, ["plain"])
        findings = {}
        for claim in sorted(claims, key=lambda claim: claim.needs_mesh):
            findings[claim.id] = self._decide(claim, trial, outcomes)
        failed = any(finding.verdict in BAD for finding in findings.values())
        shown = failed and self._can_be_shown(case, trial.plain)
        evidence = Evidence(field, case.isovalue, outcomes) if shown else None
        seconds = time.perf_counter() - start
        return Judged(case.id, findings, seconds, len(outcomes), evidence)

    def _can_be_shown(self, case: Case, came: Outcome) -> bool:
        """Whether the case is small enough to be kept whole.

        Other disciplines than surfaces have few cases: there the answer alone may be drawn.
        """
        if case.samples <= SHOWN_SAMPLES or self.declaration.discipline == "surfaces":
            return case.samples <= SHOWN_SAMPLES
        return came.vertices is not None and len(came.vertices) <= SHOWN_SAMPLES

    def _ask(self, trial: Trial, outcomes: dict[str, Outcome], variants: Iterable[str]) -> None:
        """`outcomes` holds these variants, each asked once."""
        for name in variants:
            if name in outcomes:
                continue
            plain = trial.field, trial.case.isovalue
            posed = plain if name == "plain" else self.pose(name, trial.case, trial.field)
            if posed is None:
                continue
            field, isovalue = posed
            outcome = self.adapter.run(Request(trial.case.id, name, field, isovalue))
            self.hangs = self.hangs + 1 if outcome.status is Status.TIMEOUT else 0
            outcomes[name] = outcome

    def _decide(self, claim: Claim, trial: Trial, outcomes: dict[str, Outcome]) -> Finding:
        """What the claim says of the trial."""
        excluded = claim.unless & self.declaration.without
        if excluded:
            return Finding(Verdict.UNSUPPORTED, f"declared without {', '.join(sorted(excluded))}")
        if trial.plain.status is Status.DECLINED:
            return Finding(Verdict.UNSUPPORTED, trial.plain.detail)
        if claim.needs_mesh and trial.plain.mesh is None:
            return Finding(Verdict.NOT_RUN, "no mesh came back that could be judged")
        self._ask(trial, outcomes, claim.variants)
        try:
            return claim.judge(trial)
        except Exception as error:  # noqa: BLE001 - counted and shown as a fault of the grader
            return Finding(Verdict.NOT_RUN, f"{JUDGE_FAULT}: {type(error).__name__}: {error}")


def _all(case: Case, claims: Iterable[Claim], finding: Finding) -> Judged:
    """The same finding on every claim."""
    return Judged(case.id, {claim.id: finding for claim in claims})


def run(
    spec: str, tasks: Sequence[Task], options: Options, worker: Worker | None = None
) -> Iterator[Judged]:
    """Every task judged, in the order of the plan.

    With one job the open `worker` does them all; otherwise each of several processes opens an
    adapter of its own to `spec`, and looks cases and claims up by id.
    """
    if worker is not None and options.jobs <= 1:
        yield from map(worker.judge, tasks)
        return
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(options.jobs, context, _start, (spec, options))
    try:
        for portion in pool.map(_judge_all, _portions(tasks, options.jobs)):
            yield from portion
    finally:
        pool.shutdown(cancel_futures=True)


def _portions(tasks: Sequence[Task], jobs: int) -> list[Sequence[Task]]:
    """The tasks in runs of neighbours, long enough to be worth a message."""
    size = max(1, min(16, len(tasks) // (4 * jobs)))
    return [tasks[start : start + size] for start in range(0, len(tasks), size)]


# The worker of a process that `run` started; a process has one, or none.
_WORKERS: list[Worker] = []


def _start(spec: str, options: Options) -> None:
    """The worker of this process is open."""
    threading.Thread(target=_leave_with_parent, daemon=True).start()
    _WORKERS[:] = [Worker.open(spec, options)]


def _leave_with_parent() -> None:
    """The process ends when the one that started it does, however that ended."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _judge_all(tasks: Sequence[Task]) -> list[Judged]:
    """The tasks judged by this process's worker."""
    return [_WORKERS[0].judge(task) for task in tasks]


def processors() -> int:
    """How many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
