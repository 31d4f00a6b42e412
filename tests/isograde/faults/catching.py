"""Who catches a fault: the plan's tasks judged one after the other, until a promise is broken."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from isograde.claims import CLAIMS
from isograde.declaration import declaration_from
from isograde.model import BAD
from isograde.runner import Judged, Options, Task, Worker, cases_for, claims_for, plan

from tests.isograde.faults.registry import Fault
from tests.isograde.judging import Here

#: A case of at most so many samples is small.
SMALL = 5_000
#: Families of hundreds of cases.
LONG = ("cells", "pairs", "trilinear")
#: How an extractor can be asked in this process, beside once: ways that leave nothing behind.
WAYS = ("kept", "again")


def worker_of(fault: Fault, seed: int = 0) -> Worker:
    """A worker that judges the fault, made anew."""
    declared = declaration_from({**fault.declares}, fault.name)
    adapter = Here(fault.make(), declared, WAYS if fault.first.startswith("calls.") else ())
    return Worker(adapter, declared, cases_for(declared, seed), claims_for(declared))


def tasks_of(worker: Worker) -> list[Task]:
    """The default plan."""
    return plan(Options(), worker.cases, worker.claims)


def broken(worker: Worker, judged: Judged) -> list[str]:
    """The promises that did not hold, the lowest rung first."""
    held = [
        name
        for name, finding in judged.findings.items()
        if finding.verdict in BAD and worker.claims[name].held(worker.declaration)
    ]
    return sorted(held, key=rank)


def rank(claim: str) -> tuple[int, int]:
    """Where a claim stands: by its rung, those beside the ladder last, then as they are listed."""
    level = CLAIMS[claim].level
    return (99 if level is None else level, list(CLAIMS).index(claim))


@dataclass(frozen=True)
class Caught:
    """The first case of the plan on which a promise is broken, and what is broken on it."""

    case: str
    claims: tuple[str, ...]
    detail: str


def mixed(tasks: list[Task], worker: Worker) -> list[Task]:
    """The tasks, small ones first and the families in turns, so that all are met early."""
    turn: dict[str, int] = {}
    places = []
    for task in tasks:
        family = task.case.split("/")[0]
        turn[family] = turn.get(family, 0) + 1
        # Scatter a family of hundreds, whose neighbours are alike.
        scattered = turn[family] * 89 % 512 if family in LONG else turn[family]
        places.append((worker.cases[task.case].samples > SMALL, scattered))
    return [tasks[i] for i in sorted(range(len(tasks)), key=places.__getitem__)]


def caught_by(fault: Fault, most: int = 400) -> Caught | None:
    """A case of the plan on which the expected claim is the lowest promise that is broken.

    None where so many cases, a mixture of all families, have none.
    """
    worker = worker_of(fault)
    every = [name for name, claim in worker.claims.items() if claim.held(worker.declaration)]
    for task in mixed(tasks_of(worker), worker):
        if fault.first not in task.claims:
            continue
        most -= 1
        if most < 0:
            return None
        if broken(worker, worker.judge(Task(task.case, (fault.first,)))):
            applying = tuple(name for name in every if name in task.claims)
            judged = worker.judge(Task(task.case, applying))
            claims = broken(worker, judged)
            if claims and claims[0] == fault.first:
                return Caught(task.case, tuple(claims), judged.findings[claims[0]].detail)
    return None


def lowest(fault: Fault) -> Caught | None:
    """The lowest promise seen broken, and a case that shows it; None where all hold."""
    *_, last = None, *ever_lower(fault)
    return last


def ever_lower(fault: Fault, patience: int = 24) -> Iterator[Caught]:
    """A broken promise and a case that shows it, then lower ones.

    The claim that is expected is asked first, then all that need no variants, then the others if
    none was broken. Once a promise is known to be broken, only lower ones are asked, of so many
    cases more. On a case that shows one, all promises are judged.
    """
    worker = worker_of(fault)
    tasks = mixed(tasks_of(worker), worker)
    held = sorted(
        (name for name, claim in worker.claims.items() if claim.held(worker.declaration)), key=rank
    )
    every, known = list(held), False
    posed = [name for name in held if worker.claims[name].variants]
    plain = [name for name in held if name not in posed]
    # Look at some cases of each family by all claims before looking at all of them.
    stages = [([fault.first], 100), (plain, 250), (posed, 30), (every, len(tasks))]
    for stage, most in stages:
        left = patience if known else most
        if known and stage in (posed, every):
            return
        for task in tasks:
            asked = [name for name in held if name in stage and name in task.claims]
            if asked and not left:
                break
            left -= bool(asked)
            if asked and broken(worker, worker.judge(Task(task.case, tuple(asked)))):
                applying = tuple(name for name in every if name in task.claims)
                judged = worker.judge(Task(task.case, applying))
                claims = broken(worker, judged)
                if not claims:
                    continue  # It does not fail each time.
                yield Caught(task.case, tuple(claims), judged.findings[claims[0]].detail)
                held, known = [name for name in held if rank(name) < rank(claims[0])], True
                left = min(left, patience)
