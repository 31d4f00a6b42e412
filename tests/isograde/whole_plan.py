"""Every correct extractor on the whole default plan: ``make correct``, or with names of some.

What the tests judge on a chosen part of the plan (`tests/isograde/test_correct.py`) is judged here
on all of it. A line an extractor says what it reached and which promise the grader thinks broken:
each would be a false alarm. Ends with 1 where there is one.
"""

from __future__ import annotations

import sys
from concurrent.futures import ProcessPoolExecutor

from isograde.declaration import declaration_from
from isograde.report import headline
from isograde.runner import cases_for, processors

from tests.isograde.families import CORRECT, NARROW
from tests.isograde.judging import Here
from tests.isograde.reporting import graded

EVERY = {**CORRECT, **NARROW}


def judged(name: str) -> tuple[str, list[str]]:
    """The headline of one extractor, and the promises that did not hold."""
    family = EVERY[name]
    declared = declaration_from(family.says, name)
    planned = [c for c in cases_for(declared, 0).values() if "full" not in c.tags]
    report = graded(Here(family.function, declared), f"python:families:{name}", planned)
    broken = [f"{s.id} ({s.failure.case if s.failure else ''})" for s in report.broken]
    return headline.headline(report), broken


def main(names: list[str]) -> int:
    """1 where a promise of a correct extractor is said to be broken, else 0."""
    unknown = set(names) - set(EVERY)
    if unknown:
        print(f"no extractor {', '.join(sorted(unknown))}; there are {', '.join(EVERY)}")
        return 2
    alarms = 0
    with ProcessPoolExecutor(processors()) as pool:
        for told, broken in pool.map(judged, names or list(EVERY)):
            alarms += bool(broken)
            print(told, *(f"\n    false alarm: {one}" for one in broken), flush=True)
    return int(alarms > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
