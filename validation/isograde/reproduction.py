"""Tables that hold a paper's number beside ours.

Every program under `papers/` ends in such tables: what the paper printed, what was computed here,
and whether they agree. Numbers are compared, never copied from one column to the other.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

Value = int | float | str | None


@dataclass(frozen=True)
class Row:
    """One number of the paper beside ours; `note` explains where they differ."""

    what: str
    paper: Value
    ours: Value
    tolerance: float = 0.0
    note: str = ""

    @property
    def verdict(self) -> str:
        """``exact``, ``within x``, ``differs``, or ``not printed`` where the paper has no number.

        >>> Row("cells", 3, 3).verdict, Row("share", 88.13, 88.2, tolerance=0.1).verdict
        ('exact', 'within 0.1')
        >>> Row("cells", 3, 4).verdict, Row("cells", None, 4).verdict
        ('differs', 'not printed')
        """
        if self.paper is None:
            return "not printed"
        if self.paper == self.ours:
            return "exact"
        numbers = isinstance(self.paper, int | float) and isinstance(self.ours, int | float)
        if numbers and abs(float(self.paper) - float(self.ours)) <= self.tolerance:  # type: ignore[arg-type]
            return f"within {self.tolerance:g}"
        return "differs"


@dataclass
class Table:
    """Rows under a title, written as Markdown."""

    title: str
    rows: list[Row] = field(default_factory=list)

    def add(
        self, what: str, paper: Value, ours: Value, *, tolerance: float = 0.0, note: str = ""
    ) -> None:
        """Append the row that holds these two numbers."""
        self.rows.append(Row(what, paper, ours, tolerance, note))

    def differing(self) -> list[Row]:
        """The rows whose numbers disagree."""
        return [row for row in self.rows if row.verdict == "differs"]

    def markdown(self) -> str:
        """The table as Markdown, thousands separated."""
        lines = [f"## {self.title}", "", "| | paper | ours | verdict | note |"]
        lines.append("| --- | ---: | ---: | --- | --- |")
        lines += [
            f"| {r.what} | {_shown(r.paper)} | {_shown(r.ours)} | {r.verdict} | {r.note} |"
            for r in self.rows
        ]
        return "\n".join(lines) + "\n"


def _shown(value: Value) -> str:
    """The number as the table shows it."""
    if isinstance(value, int):
        return f"{value:,}"
    if isinstance(value, float):
        return f"{value:.6g}"
    return value or ""


def write_report(path: Path, title: str, parts: Iterable[Table | str]) -> None:
    """The file `path` holds the title and the parts in order, written whole or not at all."""
    texts = [part.markdown() if isinstance(part, Table) else part.rstrip() + "\n" for part in parts]
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_suffix(path.suffix + ".tmp")
    draft.write_text(f"# {title}\n\n" + "\n".join(texts), encoding="utf-8")
    draft.replace(path)
