"""Verdicts on a fault, those of the sound engine taken where the fault answers as it does.

Most faults change the answer on few fields. Whatever a claim looks at, the outcomes of a case and
its variants, is compared with what the sound engine answered there, byte for byte; where all of it
is the same, and both declare the same family, so is the verdict. What is known of the sound engine
is kept (`Sound.path`), so that it is judged once for all faults.

A claim that has failed on `MOST` cases is not asked again: that it fails is what a row of the
matrix says. On others it is counted.
"""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

from isograde import variants
from isograde.cases import all_cases
from isograde.declaration import Declaration, declaration_from
from isograde.model import BAD, Outcome, Trial, Verdict
from isograde.runner import Task, Worker, cases_for, claims_for
from isoref.field import Field

from tests.isograde.faults.catching import SMALL
from tests.isograde.faults.engine import Engine
from tests.isograde.judging import Here

MOST = 10


def digest(outcome: Outcome) -> str:
    """What all that claims see of an outcome comes to."""
    total = hashlib.blake2b(digest_size=12)
    total.update(f"{outcome.status}{outcome.input_changed}{outcome.detail}".encode())
    for array in (outcome.vertices, outcome.simplices, outcome.normals):
        if array is not None:
            total.update(f"{array.dtype.str}{array.shape}".encode() + array.tobytes())
    return total.hexdigest()


def family(declared: Declaration) -> Declaration:
    """The declaration but for what no judge looks at: names, and what is promised."""
    nothing = frozenset[str]()
    return replace(
        declared, name="", version="", notes="", level=2, promised=nothing, not_promised=nothing
    )


class Sound:
    """What the sound engine answered on each case, and what was said of it.

    path : where it is kept, a line a case
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.known: dict[str, dict[str, Any]] = {}
        if path.exists():
            for line in path.read_text(encoding="utf-8").splitlines():
                one = json.loads(line)
                self.known[one["case"]] = one

    @property
    def worker(self) -> Worker:
        """A worker that judges it."""
        return sound_worker()

    def on(self, case: str) -> dict[str, Any]:
        """The digests of its outcomes and its verdicts on a case, judged if they are not known."""
        if case not in self.known:
            worker = self.worker
            claims = tuple(
                name
                for name, claim in worker.claims.items()
                if claim.applies_to(worker.cases[case])
                and (not claim.variants or "posed" in worker.cases[case].tags)
            )
            trial, outcomes = worker._tried(worker.cases[case])
            judged = worker._judge(trial, outcomes, [worker.claims[name] for name in claims])
            one = {
                "case": case,
                "outcomes": {name: digest(outcome) for name, outcome in outcomes.items()},
                "verdicts": {name: str(f.verdict) for name, f in judged.findings.items()},
            }
            self.known[case] = one
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(one) + "\n")
        return self.known[case]


@cache
def sound_worker() -> Worker:
    """The worker of the sound engine."""
    declared = declaration_from({"level": 3}, "engine")
    adapter = Here(Engine(), declared)
    return Worker(adapter, declared, cases_for(declared, 0), claims_for(declared))


@cache
def built(case: str) -> Field:
    """The field of a case, built once for all faults."""
    return all_cases()[case].build()


def verdicts(worker: Worker, task: Task, sound: Sound | None, asked: Iterable[str]) -> Counter[str]:
    """Which of the claims that are asked fail on a case, each counted once; "shared" beside them.

    sound : None where the fault's family is another
    """
    case, found = worker.cases[task.case], Counter[str]()
    outcomes: dict[str, Outcome] = {}
    field = built(task.case) if case.samples <= SMALL else case.build()
    trial = Trial(case, field, worker.declaration, outcomes)
    worker._ask(trial, outcomes, ["plain"])
    same = False
    if sound is not None and task.case in sound.worker.cases:
        known = sound.on(task.case)
        same = known["outcomes"]["plain"] == digest(outcomes["plain"])
    for name in asked:
        claim = worker.claims[name]
        if same and name in known["verdicts"]:
            posed = variants.named(claim.variants, case.kind)
            worker._ask(trial, outcomes, posed)
            if all(
                known["outcomes"].get(one) == digest(outcomes[one])
                for one in posed
                if one in outcomes
            ):
                found["shared"] += 1
                found[name] += Verdict(known["verdicts"][name]) in BAD
                continue
        found[name] += worker._decide(claim, trial, outcomes).verdict in BAD
    return +found
