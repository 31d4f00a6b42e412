"""One implementation graded from door to report.

The JSON lines are written while the cases run, so that a run that is cut off leaves what it found,
and no footer. The pages are made from the lines afterwards, and can be made again from them.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from isograde.claims import CLAIMS
from isograde.doors import open_door
from isograde.fields import all_cases
from isograde.model import DoorError, Outcome, Request, Verdict
from isograde.report import record
from isograde.runner import Evidence, Judged, Options, Task, Worker, plan, run

# A second process costs a start; below so many cases it does not pay.
CASES_PER_JOB = 60
# Show this answer beside a failed one, where it is not the one that failed.
CONTRAST = "isoref:asymptotic-decider"

Watch = Callable[[int, int, record.Tally], None]


@dataclass(frozen=True, eq=False)
class Smallest:
    """The smallest failed case of a claim that can be shown whole."""

    case: str
    samples: int
    evidence: Evidence


def grade(
    spec: str,
    options: Options,
    path: Path,
    *,
    arguments: Sequence[str] = (),
    watch: Watch | None = None,
) -> record.Report:
    """The report of one implementation, written to `path` line by line.

    Raises
    ------
    DoorError
        where the implementation does not start.
    NothingToRun
        where no case and claim match.
    """
    start = time.perf_counter()
    cases = all_cases(options.seed)
    worker = Worker.open(spec, options.limits, cases, CLAIMS)
    try:
        tasks = plan(options, cases, CLAIMS, worker.declaration.discipline)
        options = replace(options, jobs=max(1, min(options.jobs, len(tasks) // CASES_PER_JOB)))
        path.parent.mkdir(parents=True, exist_ok=True)
        with record.open_text(path, "w") as file:
            writer = Writer(file)
            writer.write(record.header(spec, worker.declaration, options, list(arguments)))
            writer.write_claims(tasks, worker)
            tally, smallest = writer.write_results(tasks, run(spec, tasks, options, worker), watch)
            writer.write_evidence(smallest, options)
            writer.write(tally.footer(time.perf_counter() - start))
    finally:
        worker.door.close()
    return record.gather(writer.records)


class Writer:
    """Writes records, and keeps them for the pages."""

    def __init__(self, file: Any):
        self.file = file
        self.records: list[record.JSON] = []

    def write(self, line: record.JSON) -> None:
        """One more line."""
        self.records.append(record.write_line(self.file, line))

    def write_claims(self, tasks: Sequence[Task], worker: Worker) -> None:
        """A line for each claim that some task judges."""
        judged = {name for task in tasks for name in task.claims}
        for name, claim in CLAIMS.items():
            if name in judged:
                self.write(record.claim_record(claim, worker.declaration))

    def write_results(
        self, tasks: Sequence[Task], judgements: Any, watch: Watch | None
    ) -> tuple[record.Tally, dict[str, Smallest]]:
        """A case and a result line for each task; what was counted, and the smallest failures."""
        tally, smallest = record.Tally(), dict[str, Smallest]()
        cases = all_cases(self.records[0]["seed"])
        for judged in judgements:
            case = cases[judged.case]
            self.write(record.case_record(case))
            self.write(record.result_record(judged))
            tally.add(judged)
            _keep(smallest, judged, case.samples)
            if watch is not None:
                watch(tally.cases, len(tasks), tally)
        return tally, smallest

    def write_evidence(self, smallest: Mapping[str, Smallest], options: Options) -> None:
        """A line for each failed claim whose smallest case can be shown whole."""
        legal = contrast(smallest.values(), options) if smallest else {}
        for claim, found in smallest.items():
            self.write(
                record.evidence_record(claim, found.case, found.evidence, legal.get(found.case))
            )


def _keep(smallest: dict[str, Smallest], judged: Judged, samples: int) -> None:
    """`smallest` knows the evidence of this case, where it is smaller than what it knew."""
    if judged.evidence is None:
        return
    for claim, finding in judged.findings.items():
        known = smallest.get(claim)
        if finding.verdict is Verdict.FAIL and (known is None or samples < known.samples):
            smallest[claim] = Smallest(judged.case, samples, judged.evidence)


def contrast(found: Any, options: Options) -> dict[str, Outcome]:
    """What the reference makes of these cases, by case; nothing where it does not start."""
    door = open_door(CONTRAST)
    try:
        door.open(options.limits)
    except DoorError:
        return {}
    wanted = {one.case: one.evidence for one in found}
    try:
        return {
            case: door.run(Request(case, "plain", evidence.field, evidence.isovalue))
            for case, evidence in wanted.items()
        }
    finally:
        door.close()
