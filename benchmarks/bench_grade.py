"""Where the time of a grade goes: the implementation, its adapter, the judging, the report.

The default plan is graded in one process, as `isograde grade` does it, and the clock is read at
the adapter and round the parts of the grade. Keeps the table in `reports/benchmarks/grade.md`.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

from isograde import grading, report
from isograde.declaration import Declaration
from isograde.model import Adapter, Limits, Outcome, Request
from isograde.report.plot import Bar, bars
from isograde.runner import Options, Worker, plan
from pages import Page, of_numpy, one_call, own_times, profiled

NAME = "skimage:lewiner"
JUDGING = "judging (oracles, variants)"
# What judging may take of the whole, and the seconds that the whole may take on two processors.
SHARE, SECONDS = 0.5, 60.0
ONE = "in one process where two were asked"
TENTH, FUNCTIONS = 10, 16


class Watched:
    """An adapter, with the clock's seconds of all calls, and those inside the implementation."""

    def __init__(self, adapter: Adapter) -> None:
        self.adapter = adapter
        self.seconds = self.inside = 0.0
        self.calls = 0

    def open(self, limits: Limits) -> Declaration:
        """As the adapter does."""
        return self.adapter.open(limits)

    def run(self, request: Request) -> Outcome:
        """As the adapter does; the time is added."""
        start = time.perf_counter()
        outcome = self.adapter.run(request)
        self.seconds += time.perf_counter() - start
        # What asks several times tells its own kind of seconds.
        if request.calls == "once":
            self.inside += outcome.seconds
        self.calls += 1
        return outcome

    def close(self) -> None:
        """As the adapter does."""
        self.adapter.close()


def shares(name: str, only: tuple[str, ...]) -> tuple[dict[str, float], int, int]:
    """Seconds of each part of a grade, cases and calls."""
    options = Options(only=only, jobs=1)
    start = time.perf_counter()
    worker = Worker.open(name, options)
    opened = time.perf_counter() - start
    worker.adapter = watched = Watched(worker.adapter)
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        try:
            made = grading.graded_by(worker, name, options, Path(folder) / "report.jsonl")
        finally:
            worker.adapter.close()
        graded = time.perf_counter() - start
        start = time.perf_counter()
        report.write(made, Path(folder), "report", ["html", "md"])
        written = time.perf_counter() - start
    judged = sum(float(one["seconds"]) for one in made.results)
    footer = made.footer
    assert footer is not None
    found = {
        "starting the adapter": opened,
        "implementation": watched.inside,
        "adapter": watched.seconds - watched.inside,
        JUDGING: max(0.0, judged - watched.seconds),
        "fields, smallest cases, lines": max(0.0, graded - max(judged, watched.seconds)),
        "pages": written,
    }
    return found, len(made.results), watched.calls


def by_function(name: str, only: tuple[str, ...]) -> tuple[list[list[str]], str]:
    """Rows of a table: where the time of judging goes, by function, on every tenth case.

    And how much of it the calls of NumPy take, whatever they do.
    """
    options = Options(only=only, jobs=1)
    worker = Worker.open(name, options)
    try:
        tasks = plan(options, worker.cases, worker.claims)[::TENTH]
        used = time.process_time()
        for task in tasks:
            worker.judge(task)
        used = time.process_time() - used
        entries = profiled(lambda: [worker.judge(task) for task in tasks])
    finally:
        worker.adapter.close()
    calls, each = of_numpy(entries), one_call()
    told = (
        f"To judge {len(tasks):,} cases takes {used:.2f} s of the processor and {calls:,} calls of "
        f"NumPy's functions in C, {calls / len(tasks):,.0f} a case, besides operators. One such "
        f"call on eight numbers takes {each * 1e6:.2f} microseconds here, so what they cost if "
        f"they did nothing is {calls * each / used:.0%} of it: most fields of the default plan are "
        "small. The rest are the functions in Python between them, and the work itself. Much less "
        "time needs fewer calls, so cases that are judged together."
    )
    return own_times(entries, "isograde", FUNCTIONS), told


def ask(page: Page, name: str, share: float, total: float) -> None:
    """Note what was asked of the share of judging, and of the seconds of the whole."""
    page.ask("grade", f"judging's share of the grade of {name}", (share,) * 3, SHARE, most=True)
    what = f"seconds of the grade of {name}, {ONE}"
    page.ask("grade", what, (total,) * 3, SECONDS, most=True)


def main() -> None:
    """Run the table and write it down."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", default=[NAME])
    parser.add_argument("--only", nargs="*", default=[], help="globs; all unless said")
    parser.add_argument("--out", type=Path, default=Path("reports/benchmarks/grade.md"))
    arguments = parser.parse_args()
    page = Page(
        "Where the time of a grade goes",
        f"one process; {', '.join(arguments.only) or 'the default plan'}. A part's time is the "
        "clock's. Smallest cases are looked for with the adapter too, which counts as its time.",
    )
    for colour, name in enumerate(arguments.names):
        found, cases, calls = shares(name, tuple(arguments.only))
        total = sum(found.values())
        page.add(f"## {name}: {cases:,} cases, {calls:,} calls, {total:.1f} s")
        rows = [[part, f"{one:.2f}", f"{one / total:.0%}"] for part, one in found.items()]
        page.table(["", "seconds", "share"], rows)
        drawn = [Bar(part, one, one, one, colour) for part, one in found.items() if one > 0.001]
        page.plot(name.replace(":", "-"), bars(f"{name}: seconds of each part", "seconds", drawn))
        if not arguments.only:
            ask(page, name, found[JUDGING] / total, total)
    page.show_goals()
    profiles = []
    for name in arguments.names:
        rows, told = by_function(name, tuple(arguments.only))
        first = f"its largest part in Python, {rows[0][0]}, takes {rows[0][1]} of judging"
        page.explain(f"judging's share of the grade of {name}", f"{told.split(': ')[0]}; {first}")
        page.explain(f"seconds of the grade of {name}, {ONE}", f"{told.split(': ')[0]}; {first}")
        profiles.append((name, rows, told))
    page.why()
    for name, rows, told in profiles:
        page.add(f"{name}, by function, on every {TENTH}th case, the adapter's waiting included:")
        page.table(["function", "of its time"], rows)
        page.add(told)
    page.write(arguments.out)


if __name__ == "__main__":
    main()
