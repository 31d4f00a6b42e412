"""A page of a benchmark: its tables as Markdown, its plots as SVG beside it, and the machine."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from isograde.stopwatch import Machine


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
        lines = [f"| {' | '.join(heads)} |", "| --- |" + " ---: |" * (len(heads) - 1)]
        lines += [f"| {' | '.join(row)} |" for row in rows]
        self.add("\n".join(lines))

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
