"""A page of a benchmark: its tables as Markdown, its plots as SVG beside it, and the machine."""

from __future__ import annotations

import cProfile
import pstats
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from isograde.stopwatch import Machine, Timing


class Page:
    """A page as it grows, and what the machine did meanwhile.

    told : how it was measured, said in one line with the state of the machine
    versions : of the libraries that took part, as "VTK 9.7"
    """

    def __init__(self, title: str, told: str, *versions: str) -> None:
        self.title, self.told, self.versions = title, told, versions
        self.machine = Machine()
        self.parts: list[str] = []
        self.plots: dict[str, str] = {}

    def add(self, *parts: str) -> None:
        """These parts come next, and are printed."""
        self.parts += parts
        print(*parts, sep="\n", flush=True)

    def table(self, heads: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
        """A table comes next, its first column to the left."""
        self.add(table_of(heads, rows))

    def plot(self, name: str, svg: str) -> None:
        """A plot comes next, where there is one; it is written beside the page."""
        if svg:
            self.plots[name] = svg
            self.parts.append(f"![{name}]({{stem}}-{name}.svg)")

    def write(self, out: Path) -> None:
        """The page and its plots are in the folder of `out`."""
        from isograde.report import write_whole

        state = self.machine.state(*self.versions)
        busy = (
            [] if self.machine.quiet else ["**The machine was not quiet: the ratios are rough.**"]
        )
        said = [f"# {self.title}", f"{state}; {self.told}", *busy]
        parts = [part.replace("{stem}", out.stem) for part in self.parts]
        write_whole(out, "\n\n".join([*said, *parts]) + "\n")
        for name, svg in self.plots.items():
            write_whole(out.with_name(f"{out.stem}-{name}.svg"), svg)


def table_of(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table, its first column to the left."""
    lines = [f"| {' | '.join(heads)} |", "| --- |" + " ---: |" * (len(heads) - 1)]
    return "\n".join([*lines, *(f"| {' | '.join(row)} |" for row in rows)])


def profile(run: Callable[[], object], package: str, most: int = 8) -> list[list[str]]:
    """Rows of a table: the package's functions by the share of the time that is their own.

    What a function calls outside the package, as NumPy, is its own. Under a profiler calls cost
    more than they do, so shares of functions that are called very often are too large.
    """
    profiler = cProfile.Profile()
    profiler.runcall(run)
    entries: dict[Any, Any] = pstats.Stats(profiler).stats  # type: ignore[attr-defined]
    inside = {name for name in entries if f"/{package}/" in Path(name[0]).as_posix()}
    own = {name: entries[name][2] for name in inside}
    for name, (*_, callers) in entries.items():
        for caller, (*_, seconds) in callers.items():
            if name not in inside and caller in inside:
                own[caller] += seconds
    whole = sum(own.values())
    first = sorted(own, key=lambda name: -own[name])[:most]
    rows = [
        [f"`{Path(file).stem}.{what}`", f"{own[file, line, what] / whole:.0%}"]
        for file, line, what in first
    ]
    rest = sum(own.values()) - sum(own[name] for name in first)
    return [*rows, [f"{len(own) - len(first)} others", f"{rest / whole:.0%}"]]


def goal(what: str, found: tuple[float, float, float], bound: float, *, most: bool) -> list[str]:
    """A row of a table: what was asked of a ratio, what was found, whether it is met.

    found : the median and the quartiles
    most : the ratio shall be at most the bound; else at least
    """
    met = found[0] <= bound if most else found[0] >= bound
    shown = "{:.2f} ({:.2f} to {:.2f})".format(*found)
    return [what, f"at {'most' if most else 'least'} {bound:g}", shown, "met" if met else "not met"]


GOAL_HEADS = ("", "goal", "found (quartiles)", "")


def over(timings: Sequence[Timing], one: str, other: str) -> tuple[float, float, float]:
    """The ratio of two contestants' times, round by round: the median and the quartiles."""
    named = {timing.name: timing for timing in timings}
    return named[one].over(named[other])
