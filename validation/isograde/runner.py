"""Cases times claims gives findings.

A *plan* says which claims are judged on which cases. A *worker* holds one open adapter, asks each
request of a case once however many claims need it, and has the claims judge what came back. Several
workers share a plan, each a process of its own with an adapter of its own.

What becomes of a claim on a case
---------------------------------
1. A claim that is not stated for the implementation's family, or for the case's (n, m), is not in
   the plan.
2. A field outside the stated limits is posed within them (`isograde.within`) or not sent, and a
   call may be declined: "unsupported".
3. Judges of the raw outcome (structure, robustness) come first; without a mesh, every other claim
   is "not run": the fault is counted once, where it is.
4. Variants are asked only when a claim that needs them is reached.
5. A case on which the claim could not fail is no evidence: "skip".
6. Who does not answer a field tagged "large" within the limits of a call counts as declining it.

A judge that raises is a fault of the grader, not of the implementation: the claim is "not run",
and the report says so at its head.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from dataclasses import field as fresh
from difflib import get_close_matches
from fnmatch import fnmatchcase
from pathlib import Path
from types import ModuleType

from isoref.field import Field

from isograde import bounds, variants
from isograde.adapters import open_adapter
from isograde.adapters.conventions import refusal
from isograde.bounds import at_most, beyond, hearing
from isograde.cases import all_cases, blocks, given, own
from isograde.claims import CLAIMS
from isograde.claims.evidence import is_general, remembered
from isograde.declaration import Declaration
from isograde.formats.reading import VolumeError
from isograde.model import (
    BAD,
    JUDGE_FAULT,
    Adapter,
    Case,
    Claim,
    Finding,
    Kind,
    Limits,
    Outcome,
    Request,
    Status,
    Trial,
    Verdict,
)
from isograde.within import posed, recast

# Keep a failed case whole, for its picture and its numbers, up to this many numbers; of a larger
# one in the plane, on a curve or in many dimensions, the answer alone, up to as many vertices.
SHOWN_SAMPLES = 2200
# Pose a case in every way with ``--full`` up to this many samples.
POSED_SAMPLES = 40_000
# Keep the answers to cases up to this many numbers, where they are kept.
KEPT_SAMPLES = 5_000
# Leave families of thousands of small cases as they stand: cells and noise are posed instead.
UNPOSED = frozenset({"pairs", "trilinear"})
# Give up on an implementation that ran out of time so many times in a row.
PATIENCE = 8


@dataclass(frozen=True)
class Options:
    """How to grade.

    only : globs on ids of claims or of cases; empty for all
    full : every case, and every variant on all but pairs and large cases
    own : files of cases of the user's own, which are added to the plan
    budget : seconds after which no further case is begun; None for all cases
    shard : (i, n) for the i-th of n parts of the plan, counted from 1
    dask : the address of a scheduler whose workers judge the cases (`isograde.cluster`)
    """

    seed: int = 0
    full: bool = False
    only: tuple[str, ...] = ()
    limits: Limits = fresh(default_factory=Limits)
    jobs: int = 1
    own: tuple[Path, ...] = ()
    budget: float | None = None
    shard: tuple[int, int] | None = None
    dask: str | None = None


@dataclass(frozen=True)
class Task:
    """A case and the claims to judge on it, by id."""

    case: str
    claims: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Evidence:
    """A failed case whole: what was asked, what came, and on which variant."""

    field: Field
    isovalues: tuple[float, ...]
    outcomes: Mapping[str, Outcome]


@dataclass(frozen=True, eq=False)
class Judged:
    """One case with every finding on it.

    general : the field is in general position; None where it was not built
    seconds : of asking and judging, in which are `inside`, those of the calls themselves, and
        `asking`, what the adapter took beside them; the building of the field comes on top
    """

    case: str
    kind: Kind
    findings: Mapping[str, Finding]
    general: bool | None = None
    seconds: float = 0.0
    calls: int = 0
    evidence: Evidence | None = None
    inside: float = 0.0
    asking: float = 0.0
    building: float = 0.0


class NothingToRun(LookupError):  # noqa: N818 - a state of the plan, not an error of the program
    """No case and claim match what was asked for."""


class NotKnown(NothingToRun):
    """What was asked for is no claim and no case: a name that was misspelt."""


def plan(options: Options, cases: Mapping[str, Case], claims: Mapping[str, Claim]) -> list[Task]:
    """The tasks in the order of the cases. Raises `NothingToRun`, or `NotKnown`, which is one."""
    _known(options, cases, claims)
    chosen_claims, chosen_cases = _select(options, cases, claims)
    tasks = []
    for case in chosen_cases.values():
        all_ways = _in_all_ways(case, options)
        wanted = tuple(
            claim.id
            for claim in chosen_claims.values()
            if claim.applies_to(case) and (all_ways or not claim.variants)
        )
        if wanted:
            tasks.append(Task(case.id, wanted))
    if not tasks:
        asked = " ".join(options.only) or "the plan"
        raise NothingToRun(
            f"nothing matches {asked}: of what it declares, no such claim is judged on such a case"
        )
    return tasks


def _known(options: Options, cases: Mapping[str, Case], claims: Mapping[str, Claim]) -> None:
    """Nothing, where each name of `only` is of a claim or a case; else raises `NotKnown`."""
    for one in options.only:
        if any(fnmatchcase(name, one) for name in (*claims, *cases)) or _is_block(one, cases):
            continue
        # It may be known, and not be for what the implementation declares.
        known = [*CLAIMS, *all_cases(options.seed)]
        if any(fnmatchcase(name, one) for name in known) or _is_block(one, all_cases(options.seed)):
            continue
        close = get_close_matches(one, known, n=1)
        hint = f"did you mean {close[0]}? " if close else ""
        if one.startswith("given/"):
            hint = f"{given.fault(one)}; "
        raise NotKnown(
            f"nothing matches {one}; {hint}`isograde list claims` and `isograde list cases` "
            "show ids"
        )


def part(tasks: Sequence[Task], options: Options) -> Sequence[Task]:
    """The tasks of this shard: every n-th, so that each part has some of every family.

    >>> tasks = [Task(name, ()) for name in "abcde"]
    >>> [task.case for task in part(tasks, Options(shard=(2, 3)))]
    ['b', 'e']
    """
    if options.shard is None:
        return tasks
    number, of = options.shard
    return tasks[number - 1 :: of]


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
    """Whether this names a block of a known case, or spells a case out."""
    named = blocks.parse(name)
    return given.parse(name) is not None or (named is not None and named[0] in cases)


def _matches(name: str, globs: Sequence[str]) -> bool:
    """Whether one of the globs matches."""
    return any(fnmatchcase(name, glob) for glob in globs)


def cases_for(declaration: Declaration, seed: int, more: Iterable[Case] = ()) -> Mapping[str, Case]:
    """The cases of the kinds that the implementation takes, by id; blocks of them by name.

    more : cases beside the plan's
    """
    every, kinds = all_cases(seed), declaration.limits.kinds
    listed = {**every, **{case.id: case for case in more}}
    return type(every)({name: case for name, case in listed.items() if case.kind in kinds})


def claims_for(declaration: Declaration) -> dict[str, Claim]:
    """The claims that are stated for the implementation's family, by id."""
    kinds = [Kind(*kind) for kind in declaration.limits.kinds]
    return {
        name: claim
        for name, claim in CLAIMS.items()
        if claim.families(declaration) and any(map(claim.kinds, kinds))
    }


@dataclass
class Worker:
    """One open adapter, and the judging of what comes back through it.

    keeps : small cases and their answers are kept, for who asks for one claim after another
    inside, asking : seconds so far inside the implementation, and in its adapter besides
    """

    adapter: Adapter
    declaration: Declaration
    cases: Mapping[str, Case]
    claims: Mapping[str, Claim]
    hangs: int = 0
    keeps: bool = False
    kept: dict[str, tuple[Trial, dict[str, Outcome]]] = fresh(default_factory=dict)
    inside: float = 0.0
    asking: float = 0.0

    @classmethod
    def open(cls, spec: str, options: Options) -> Worker:
        """A worker with an open adapter and what is asked of its family.

        Raises `AdapterError`, and `own.OwnCasesError` for a file of cases that is none.
        """
        more = [case for file in options.own for case in own.read(file)]
        adapter = open_adapter(spec)
        declared = adapter.open(options.limits)
        cases = cases_for(declared, options.seed, more)
        return cls(adapter, declared, cases, claims_for(declared))

    def judge(self, task: Task) -> Judged:
        """Every finding on one case."""
        case = self.cases[task.case]
        claims = [self.claims[name] for name in task.claims]
        if self.hangs >= PATIENCE:
            gave_up = f"given up after {PATIENCE} calls in a row that ran out of time"
            return _all(case, claims, Finding(Verdict.NOT_RUN, gave_up))
        start = time.perf_counter()
        try:
            trial, outcomes = self._tried(case)
        except VolumeError as error:
            return _all(case, claims, Finding(Verdict.SKIP, str(error)))
        building = time.perf_counter() - start
        return replace(self._judge(trial, outcomes, claims), building=building)

    def _tried(self, case: Case) -> tuple[Trial, dict[str, Outcome]]:
        """The case with its field, and the outcomes that were asked for. Raises `VolumeError`."""
        if case.id in self.kept:
            return self.kept[case.id]
        outcomes: dict[str, Outcome] = {}
        given, field = posed(case, case.build(), self.declaration.limits)
        trial = Trial(given, field, self.declaration, outcomes)
        if self.keeps and case.samples * case.kind.m <= KEPT_SAMPLES:
            self.kept[case.id] = trial, outcomes
        return trial, outcomes

    def _judge(self, trial: Trial, outcomes: dict[str, Outcome], claims: Sequence[Claim]) -> Judged:
        """Every finding on one case whose field is built."""
        start, case, field = time.perf_counter(), trial.case, trial.field
        inside, asking = self.inside, self.asking
        self._ask(trial, outcomes, ["plain"])
        findings = {}
        with hearing():
            for claim in sorted(claims, key=lambda claim: claim.needs_mesh):
                findings[claim.id] = self._decide(claim, trial, outcomes)
        failed = any(finding.verdict in BAD for finding in findings.values())
        shown = failed and _can_be_shown(case, trial.plain)
        return Judged(
            case.id,
            case.kind,
            findings,
            is_general(trial),
            time.perf_counter() - start,
            sum(outcome.status is not Status.DECLINED for outcome in outcomes.values()),
            Evidence(field, case.isovalues, outcomes) if shown else None,
            self.inside - inside,
            self.asking - asking,
        )

    def _ask(self, trial: Trial, outcomes: dict[str, Outcome], names: Iterable[str]) -> None:
        """`outcomes` holds these variants, each asked once."""
        for name in names:
            if name in outcomes:
                continue
            way = variants.pose(name, trial.case, trial.field)
            if way is None:
                continue
            field, isovalues = way
            if name not in variants.TYPES:
                field = recast(field, trial.field, self.declaration.limits)
            calls = "once" if name == "plain" else variants.variant(name, trial.kind).calls
            # What the samples are of is known of the field itself, not of what is made of it.
            same = field is trial.field and calls == "once"
            function = trial.case.function if same else None
            outcome = self._call(Request(trial.case.id, name, field, isovalues, calls, function))
            if "large" in trial.case.tags and outcome.status in (Status.TIMEOUT, Status.MEMORY):
                told = f"too large for the limits of a call: {outcome.detail}"
                outcome = Outcome(Status.DECLINED, detail=told)
            self.hangs = self.hangs + 1 if outcome.status is Status.TIMEOUT else 0
            outcomes[name] = outcome

    def _call(self, request: Request) -> Outcome:
        """What comes back from one call; a field outside the stated limits is not sent."""
        if reason := refusal(request, self.declaration):
            return Outcome(Status.DECLINED, detail=reason)
        start = time.perf_counter()
        outcome = self.adapter.run(request)
        took = time.perf_counter() - start
        # Who is asked many times at once tells the seconds of one, and spends nearly all inside.
        inside = min(took, outcome.seconds) if request.calls == "once" else took
        self.inside += inside
        self.asking += took - inside
        return outcome

    def _decide(self, claim: Claim, trial: Trial, outcomes: dict[str, Outcome]) -> Finding:
        """What the claim says of the trial."""
        if trial.plain.status is Status.DECLINED:
            return Finding(Verdict.UNSUPPORTED, trial.plain.detail)
        if claim.needs_mesh and (hindered := _hindered(trial)):
            return hindered
        if claim.variants:
            self._ask(trial, outcomes, variants.named(claim.variants, trial.kind))
        try:
            with at_most(bounds.SECONDS):
                return claim.judge(trial)
        except bounds.GivenUp as error:
            return Finding(Verdict.NOT_RUN, str(error))
        except Exception as error:  # noqa: BLE001 - counted and shown as a fault of the grader
            return Finding(Verdict.NOT_RUN, f"{JUDGE_FAULT}: {type(error).__name__}: {error}")


def _hindered(trial: Trial) -> Finding | None:
    """What to say of a claim that needs a mesh, where there is none that can be judged."""

    def compute() -> Finding | None:
        told = beyond(trial.plain, trial.case.samples)
        if trial.plain.mesh_of(trial.kind) is None:
            told = "no mesh came back that could be judged"
        return Finding(Verdict.NOT_RUN, told) if told else None

    return remembered(trial, "hindered", compute)


def _can_be_shown(case: Case, came: Outcome) -> bool:
    """Whether the case is small enough to be kept whole, or its answer to be drawn alone."""
    if case.samples * case.kind.m <= SHOWN_SAMPLES:
        return True
    drawn = came.vertices is not None and len(came.vertices) <= SHOWN_SAMPLES
    return drawn and (case.kind.k == 1 or case.kind.n > 3)


def _all(case: Case, claims: Iterable[Claim], finding: Finding) -> Judged:
    """The same finding on every claim."""
    return Judged(case.id, case.kind, {claim.id: finding for claim in claims})


def run(
    spec: str, tasks: Sequence[Task], options: Options, worker: Worker | None = None
) -> Generator[Judged]:
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
        with _without_main():
            answers = pool.map(_judge_all, portions(tasks, options))
        for portion in answers:
            yield from portion
    finally:
        pool.shutdown(cancel_futures=True)


@contextmanager
def _without_main() -> Iterator[None]:
    """Processes that start meanwhile do not run the caller's script a second time."""
    main = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


def portions(tasks: Sequence[Task], options: Options) -> list[Sequence[Task]]:
    """The tasks in runs of neighbours, long enough to be worth a message, where there is time."""
    size = max(1, min(16, len(tasks) // (4 * options.jobs)))
    size = size if options.budget is None else 1
    return [tasks[start : start + size] for start in range(0, len(tasks), size)]


# The worker of a process that `run` started; a process has one, or none.
_WORKERS: list[Worker] = []


def _start(spec: str, options: Options) -> None:
    """The worker of this process is open."""
    # Ctrl-C is for the process that started this one, which ends it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
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
