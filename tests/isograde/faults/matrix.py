"""Every fault on every case of the default plan: ``make faults``.

    python -m tests.isograde.faults.matrix [--minutes M] [NAME ...]   goes on where it was stopped
    python -m tests.isograde.faults.matrix --report                   writes reports/faults
    python -m tests.isograde.faults.matrix --first [NAME ...]         finds cases for caught.json

What is found is added to ``reports/faults/matrix.jsonl``, a line a fault, with a digest of the plan
and of the fault's module: a line of another plan or of another text does not count. Verdicts on the
sound engine are used where a fault answers as it does (`tests.isograde.faults.sharing`). The report
has a row for each fault: the claims that failed and on how many cases, up to ten.
"""

from __future__ import annotations

import argparse
import hashlib
import inspect
import json
import sys
import time
import warnings
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from isograde.claims import CLAIMS
from isograde.runner import Task, Worker

from tests.isograde.faults import (
    blind,
    engine,
    histories,
    kinds,
    outsiders,
    placed,
    strangers_numbers,
    strangers_shapes,
    strangers_third,
)
from tests.isograde.faults.catching import caught_by, lowest, rank, tasks_of, worker_of
from tests.isograde.faults.registry import FAULTS, SURVIVORS, Fault
from tests.isograde.faults.sharing import MOST, Sound, family, sound_worker, verdicts

HERE = Path(__file__).resolve().parents[3]
BUILD = HERE / "build" / "faults"
MODULES = (
    blind,
    histories,
    kinds,
    outsiders,
    placed,
    strangers_numbers,
    strangers_shapes,
    strangers_third,
)
CAUGHT = Path(__file__).parent / "caught.json"
KEPT = HERE / "reports" / "faults" / "matrix.jsonl"
REPORT = HERE / "reports" / "faults" / "README.md"


def caught() -> dict[str, dict[str, str]]:
    """For each fault the case that catches it, and the lowest promise that is broken there."""
    found: dict[str, dict[str, str]] = json.loads(CAUGHT.read_text(encoding="utf-8"))
    return found


def digest_of(fault: Fault) -> str:
    """What the fault's line depends on: the plan, and the text of its module."""
    worker = worker_of(fault)
    plan = [(task.case, task.claims) for task in asked_of(worker)]
    text = "".join(inspect.getsource(module) for module in MODULES if fault.name in texts(module))
    return hashlib.sha256(f"{plan}{text}{dict(fault.declares)}".encode()).hexdigest()[:12]


def asked_of(worker: Worker) -> list[Task]:
    """The default plan but for scans, which not everybody has."""
    return [task for task in tasks_of(worker) if "real" not in worker.cases[task.case].tags]


def texts(module: Any) -> set[str]:
    """The names of the faults that a module registers."""
    from tests.isograde.faults.registry import kebab

    return {kebab(name) for name in vars(module)} & set(FAULTS)


def judged(fault: Fault) -> dict[str, Any]:
    """The line of one fault: for each claim that failed on how many cases, held or not."""
    started, worker = time.process_time(), worker_of(fault)
    sound = sound_for(worker)
    failed: Counter[str] = Counter()
    cases = shared = asked = 0
    for task in asked_of(worker):
        left = [name for name in task.claims if failed[name] < MOST]
        found = verdicts(worker, task, sound, left)
        shared += found.pop("shared", 0)
        asked += len(left)
        failed += found
        cases += 1
    held = [name for name in failed if CLAIMS[name].held(worker.declaration)]
    return {
        "fault": fault.name,
        "digest": digest_of(fault),
        "cases": cases,
        "shared": round(shared / max(asked, 1), 3),
        "failed": dict(sorted(failed.items(), key=lambda item: rank(item[0]))),
        "lowest": min(held, key=rank, default=""),
        "seconds": round(time.process_time() - started, 1),
    }


def sound_for(worker: Worker) -> Sound | None:
    """What is known of the sound engine on this plan; None for a fault of another family."""
    told = sound_worker()
    if family(worker.declaration) != family(told.declaration):
        return None
    plan = [(task.case, task.claims) for task in asked_of(told)]
    text = f"{plan}{inspect.getsource(engine)}"
    return Sound(BUILD / f"sound-{hashlib.sha256(text.encode()).hexdigest()[:12]}.jsonl")


def kept() -> dict[str, dict[str, Any]]:
    """The lines that still count, by fault."""
    if not KEPT.exists():
        return {}
    lines = [json.loads(line) for line in KEPT.read_text(encoding="utf-8").splitlines()]
    return {
        line["fault"]: line
        for line in lines
        if line["fault"] in FAULTS and line["digest"] == digest_of(FAULTS[line["fault"]])
    }


def go_on(names: Iterable[str], minutes: float) -> None:
    """Faults without a line are judged until the time is over, those with few cases first."""
    end, done = time.monotonic() + 60 * minutes, kept()
    KEPT.parent.mkdir(parents=True, exist_ok=True)
    for name in sorted(names, key=lambda name: len(asked_of(worker_of(FAULTS[name])))):
        if time.monotonic() > end:
            print("the time is over; the same command goes on from here")
            return
        if name not in done:
            line = judged(FAULTS[name])
            with KEPT.open("a", encoding="utf-8") as file:
                file.write(json.dumps(line) + "\n")
            print(f"{name}: {line['lowest'] or 'SURVIVES'} ({line['seconds']} s)", flush=True)


def find(names: Iterable[str]) -> None:
    """`CAUGHT` has a case for each of these faults that the plan catches."""
    known = caught() if CAUGHT.exists() else {}
    for name in names:
        last = caught_by(FAULTS[name]) or lowest(FAULTS[name])
        if last is None:
            known.pop(name, None)
            print(f"{name}: SURVIVES", flush=True)
            continue
        known[name] = {"case": last.case, "claim": last.claims[0]}
        print(f"{name}: {last.claims[0]} on {last.case}", flush=True)
        write(known)


def write(known: dict[str, dict[str, str]]) -> None:
    """`CAUGHT` holds these, in the order of their names, a line each."""
    lines = [f"  {json.dumps(name)}: {json.dumps(known[name])}" for name in sorted(known)]
    CAUGHT.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


def report() -> None:
    """`REPORT` says of each fault what it is, where its like was seen, and who catches it."""
    done, shown = kept(), caught()
    survivors = [name for name in FAULTS if name not in shown]
    assert set(survivors) == set(SURVIVORS), "caught.json and SURVIVORS do not fit each other"
    blind_ones = [one for one in FAULTS.values() if one.blind]
    whole = [line for line in done.values() if line["failed"]]
    verb = "is" if len(survivors) == 1 else "are"
    told = (
        f"{len(shown)} of them are caught by the default plan, {len(survivors)} {verb} not: "
        f"{', '.join(survivors)}."
        if survivors
        else "All of them are caught by the default plan."
    )
    text = [
        "# Faults, and the claims that catch them",
        "",
        f"{len(FAULTS)} extractors are broken on purpose (`tests/isograde/faults`), "
        f"{len(blind_ones)} of them written from the README and `isograde explain` alone, "
        f"{sum(bool(one.report) for one in FAULTS.values())} after a public report. "
        f"**{told}**",
        "",
        "`first` is the claim that must catch it: on the case named beside it no lower promise is "
        "broken. The suite judges that case again for every fault. The last column comes from the "
        f"whole plan: the claims that failed, with the number of cases ({MOST} where it is no "
        f"less), for the {len(whole)} faults on which `make faults` has run it so far. Claims in "
        "italics were not promised.",
        "",
        "| fault | what is wrong | first | on | the whole plan |",
        "| --- | --- | --- | --- | --- |",
    ]
    for name in sorted(FAULTS):
        fault, line = FAULTS[name], done.get(name)
        said = fault.says + (f" ([report]({fault.report}))" if fault.report else "")
        found = shown.get(name, {"case": "", "claim": "none"})
        blind_mark = " (blind)" if fault.blind else ""
        row = [f"{name}{blind_mark}", said, found["claim"], found["case"], _told(fault, line)]
        text.append("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |")
    if survivors:
        text += ["", "## Survivors", "", "| fault | what is wrong | what would catch it |"]
        text += ["| --- | --- | --- |"]
        text += [f"| {name} | {FAULTS[name].says} | {why} |" for name, why in SURVIVORS.items()]
    REPORT.parent.mkdir(parents=True, exist_ok=True)
    REPORT.write_text("\n".join(text) + "\n", encoding="utf-8")
    print(f"{len(shown)} of {len(FAULTS)} caught, {len(done)} on the whole plan: {REPORT.name}")


def _told(fault: Fault, line: dict[str, Any] | None) -> str:
    """The claims that failed on the whole plan, with the number of cases."""
    if line is None:
        return "not run yet"
    declared = worker_of(fault).declaration
    return ", ".join(
        f"{name} {count}" if CLAIMS[name].held(declared) else f"*{name} {count}*"
        for name, count in line["failed"].items()
    )


def main(arguments: list[str] | None = None) -> int:
    """0, or 2 for a fault that is none."""
    parser = argparse.ArgumentParser(description="Faults against claims.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="faults; all of them if none")
    parser.add_argument("--minutes", type=float, default=24 * 60.0, help="stop after so long")
    parser.add_argument("--first", action="store_true", help="find cases for caught.json")
    parser.add_argument("--report", action="store_true", help="write the report and stop")
    asked = parser.parse_args(arguments)
    unknown = set(asked.names) - set(FAULTS)
    if unknown:
        print(f"no fault {', '.join(sorted(unknown))}; there are {', '.join(sorted(FAULTS))}")
        return 2
    warnings.simplefilter("ignore")
    names = asked.names or list(FAULTS)
    if asked.first:
        find(names)
    elif not asked.report:
        go_on(names, asked.minutes)
    if not asked.first:
        report()
    return 0


if __name__ == "__main__":
    sys.exit(main())
