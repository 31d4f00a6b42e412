"""A page of a benchmark: its tables as Markdown, its plots as SVG beside it, and the machine.

What was asked of what it measured is written a second time, as JSON in `goals` beside the pages, so
that `asked.py` can gather the goals of all of them.
"""

from __future__ import annotations

import cProfile
import json
import pstats
import re
import timeit
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from isograde.stopwatch import Machine, Timing


@dataclass(frozen=True)
class Goal:
    """What was asked of a number, and what was found.

    row : the row of the table of goals (`asked.ROWS`) that it belongs to
    what : the number, in words
    bound, most : the number shall be at most the bound; else at least
    found : the median and the quartiles; None where it was not measured
    absent : why it was not
    why : the heading of the page under which it says where the time goes
    reason : why it is not met, in one sentence of what was measured; empty where none is known
    """

    row: str
    what: str
    bound: float
    most: bool
    found: tuple[float, float, float] | None
    absent: str = ""
    why: str = ""
    reason: str = ""

    @property
    def met(self) -> bool | None:
        """The median is on the right side of the bound; None where it is not known."""
        if self.found is None:
            return None
        return self.found[0] <= self.bound if self.most else self.found[0] >= self.bound

    def cells(self) -> list[str]:
        """The row of a table under `GOAL_HEADS`."""
        asked = f"at {'most' if self.most else 'least'} {self.bound:g}"
        if self.found is None:
            return [self.what, asked, self.absent, "not measured"]
        shown = "{:.2f} ({:.2f} to {:.2f})".format(*self.found)
        return [self.what, asked, shown, "met" if self.met else "not met"]


GOAL_HEADS = ("", "goal", "found (quartiles)", "")
WHY = "Where the time goes, and why it is not less"


class UnexplainedError(Exception):
    """A page says of a goal that it is not met, and not why."""


class Page:
    """A page as it grows, and what the machine did meanwhile.

    told : how it was measured, said in one line with the state of the machine
    versions : of the libraries that took part, as "VTK 9.7"
    """

    def __init__(self, title: str, told: str, *versions: str) -> None:
        self.title, self.told, self.versions = title, told, versions
        self.machine = Machine()
        self.parts: list[str] = []
        self.goals: list[Goal] = []
        self.plots: dict[str, str] = {}

    def add(self, *parts: str) -> None:
        """These parts come next, and are printed."""
        self.parts += parts
        print(*parts, sep="\n", flush=True)

    def table(self, heads: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
        """A table comes next, its first column to the left."""
        self.add(table_of(heads, rows))

    def ask(
        self,
        row: str,
        what: str,
        found: tuple[float, float, float] | None,
        bound: float,
        *,
        most: bool,
        absent: str = "",
    ) -> None:
        """A goal is noted, for `show_goals`; see `Goal`."""
        self.goals.append(Goal(row, what, float(bound), most, found, absent, WHY))

    def explain(self, what: str, reason: str) -> None:
        """The goal of this number, where it is not met, has this reason; see `Goal`."""
        for at, one in enumerate(self.goals):
            if one.what == what and one.met is False:
                self.goals[at] = replace(one, reason=reason)

    @property
    def unexplained(self) -> list[str]:
        """The goals that are not met and have no reason."""
        return [one.what for one in self.goals if one.met is False and not one.reason]

    def show_goals(self) -> None:
        """The goals noted until now come next, in a table, where there are any."""
        if not self.goals:
            return
        self.add("## What was asked, and what was found")
        self.table(GOAL_HEADS, [one.cells() for one in self.goals])

    def why(self, *parts: str) -> None:
        """What follows says where the time goes; each goal that is not met first, with why."""
        self.add(f"## {WHY}")
        if rows := [[one.what, one.reason] for one in self.goals if one.met is False]:
            self.table(["goal that is not met", "why"], rows)
        self.add(*parts)

    def plot(self, name: str, svg: str) -> None:
        """A plot comes next, where there is one; it is written beside the page."""
        if svg:
            self.plots[name] = svg
            self.parts.append(f"![{name}]({{stem}}-{name}.svg)")

    def write(self, out: Path) -> None:
        """The page and its plots are in the folder of `out`, and plots it had before are not.

        Raises
        ------
        UnexplainedError
            where a goal is not met and has no reason; what was measured is written all the same.
        """
        from isograde.report import write_whole

        state = self.machine.state(*self.versions)
        busy = (
            [] if self.machine.quiet else ["**The machine was not quiet: the ratios are rough.**"]
        )
        said = [f"# {self.title}", f"{state}; {self.told}", *busy]
        parts = [part.replace("{stem}", out.stem) for part in self.parts]
        before = out.read_text(encoding="utf-8") if out.exists() else ""
        write_whole(out, "\n\n".join([*said, *parts]) + "\n")
        old = set(re.findall(rf"{re.escape(out.stem)}-[\w-]+\.svg", before))
        for name in old - {f"{out.stem}-{name}.svg" for name in self.plots}:
            out.with_name(name).unlink(missing_ok=True)
        for name, svg in self.plots.items():
            write_whole(out.with_name(f"{out.stem}-{name}.svg"), svg)
        if self.goals:
            told = {
                "page": out.name,
                "state": state,
                "quiet": self.machine.quiet,
                "goals": [asdict(one) for one in self.goals],
            }
            text = json.dumps(told, indent=1, ensure_ascii=False) + "\n"
            write_whole(out.parent / "goals" / f"{out.stem}.json", text)
        if self.unexplained:
            raise UnexplainedError(f"{out.name}: not met, and not said why: {self.unexplained}")


def table_of(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table, its first column to the left."""
    lines = [f"| {' | '.join(heads)} |", "| --- |" + " ---: |" * (len(heads) - 1)]
    return "\n".join([*lines, *(f"| {' | '.join(row)} |" for row in rows)])


def profile(run: Callable[[], object], package: str, most: int = 8) -> list[list[str]]:
    """Rows of a table: the package's functions by the share of the time that is their own.

    What a function calls outside the package, as NumPy, is its own. Under a profiler calls cost
    more than they do, so shares of functions that are called very often are too large.
    """
    return own_times(profiled(run), package, most)


def profiled(run: Callable[[], object]) -> dict[Any, Any]:
    """What the profiler counted, by function: calls, calls, own seconds, all seconds, callers."""
    profiler = cProfile.Profile()
    profiler.runcall(run)
    entries: dict[Any, Any] = pstats.Stats(profiler).stats  # type: ignore[attr-defined]
    return entries


def of_numpy(entries: dict[Any, Any]) -> int:
    """How many of the profiled calls were NumPy's own, in C."""
    return sum(
        calls
        for (_, _, name), (_, calls, *_) in entries.items()
        if name.startswith("<") and "numpy" in name
    )


def one_call() -> float:
    """Seconds of one call of NumPy on eight numbers, the least of several."""
    numbers = np.arange(8.0)
    return min(timeit.repeat(lambda: np.add.reduce(numbers), number=10_000, repeat=7)) / 10_000


def own_times(
    entries: dict[Any, Any], package: str, most: int = 8, *, modules: bool = False
) -> list[list[str]]:
    """The rows of `profile`, of what was counted; by modules, where these are asked for."""
    inside = {name for name in entries if f"/{package}/" in Path(name[0]).as_posix()}
    own = {name: entries[name][2] for name in inside}
    for name, (*_, callers) in entries.items():
        for caller, (*_, seconds) in callers.items():
            if name not in inside and caller in inside:
                own[caller] += seconds
    shares: dict[Any, float] = {}
    for (file, line, what), seconds in own.items():
        shown = (Path(file).stem,) if modules else (Path(file).stem, what, file, line)
        shares[shown] = shares.get(shown, 0.0) + seconds
    whole = sum(shares.values())
    first = sorted(shares, key=lambda name: -shares[name])[:most]
    rows = [[f"`{'.'.join(name[:2])}`", f"{shares[name] / whole:.0%}"] for name in first]
    rest = whole - sum(shares[name] for name in first)
    return [*rows, [f"{len(shares) - len(first)} others", f"{rest / whole:.0%}"]]


def over(timings: Sequence[Timing], one: str, other: str) -> tuple[float, float, float]:
    """The ratio of two contestants' times, round by round: the median and the quartiles."""
    named = {timing.name: timing for timing in timings}
    return named[one].over(named[other])
