"""Tables that hold a printed or an expected number beside ours.

Every program under `papers/` ends in such tables: what the paper printed, or what theory and our
own totals let us expect, what was computed here, and whether they agree. The column "paper" holds
printed numbers only; whatever else there is to compare with stands under "expected". Numbers are
compared, never copied from one column to the other, and a row that does not fit says by how much.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy import stats

Value = int | float | str | None


@dataclass(frozen=True)
class Row:
    """One number beside ours; `note` explains where they differ.

    Attributes
    ----------
    paper, expected : what is printed, or else what must come out; at most one of them
    tolerance : the largest difference that the print's rounding or a stated error allows
    error, limit : where ours is the mean of several draws: the standard deviation of the
        difference, and how many of them may lie between the two numbers
    """

    what: str
    paper: Value
    ours: Value
    tolerance: float = 0.0
    note: str = ""
    expected: Value = None
    error: float | None = None
    limit: float = 0.0

    @property
    def beside(self) -> Value:
        """What ours is compared with: the printed number, or else the expected one."""
        return self.expected if self.paper is None else self.paper

    @property
    def verdict(self) -> str:
        """``exact``, ``within x``, ``fits, z = x``, ``differs by x``, or ``measured`` alone.

        Numbers that may differ are ``within`` even where their shown digits are the same.

        >>> Row("cells", 3, 3).verdict, Row("share", 88.13, 88.2, tolerance=0.1).verdict
        ('exact', 'within 0.1')
        >>> Row("share", 0.5, 0.5, tolerance=0.1).verdict
        'within 0.1'
        >>> Row("cells", 3, 4).verdict, Row("cells", None, 4).verdict
        ('differs by +1', 'measured')
        >>> Row("cells", None, 4, expected=4).verdict
        'exact'
        >>> Row("share", 0.15, 0.12, error=0.01, limit=2).verdict
        'differs by -0.03, z = -3.0'
        >>> Row("order", "0 1 2", "0 2 1").verdict
        'differs'
        """
        if self.beside is None:
            return "measured"
        if self.error is None and not self.tolerance and self.beside == self.ours:
            return "exact"
        if not (isinstance(self.beside, int | float) and isinstance(self.ours, int | float)):
            return "differs"
        apart = self.ours - self.beside
        by = f"differs by {apart:+,}" if isinstance(apart, int) else f"differs by {apart:+.3g}"
        if self.error is not None:
            z = apart / self.error if apart else 0.0
            return f"fits, z = {z:+.1f}" if abs(z) <= self.limit else f"{by}, z = {z:+.1f}"
        return f"within {self.tolerance:g}" if abs(apart) <= self.tolerance else by

    @property
    def differs(self) -> bool:
        """Whether the two numbers disagree."""
        return self.verdict.startswith("differs")


@dataclass
class Table:
    """Rows under a title, written as Markdown."""

    title: str
    rows: list[Row] = field(default_factory=list)

    def add(
        self,
        what: str,
        paper: Value,
        ours: Value,
        *,
        expected: Value = None,
        tolerance: float = 0.0,
        note: str = "",
    ) -> None:
        """Append the row that holds these two numbers. Raises ValueError for three."""
        if paper is not None and expected is not None:
            raise ValueError(f"row {what!r}: give what is printed or what is expected, not both")
        self.rows.append(Row(what, paper, ours, tolerance, note, expected))

    def add_draws(
        self,
        what: str,
        paper: float,
        draws: Sequence[float],
        *,
        step: float,
        family: int,
        note: str = "",
    ) -> None:
        """Append the row that asks whether `paper` can be one more draw of the same kind.

        The difference between a further draw and the mean of n has the variance
        ``s^2 (1 + 1/n)``, to which rounding to multiples of `step` adds ``step^2 / 12``. With
        Student's t for n - 1 degrees of freedom, and the level of 5 % shared by the `family` of
        rows that are looked at together (Bonferroni), the limit follows.

        Raises
        ------
        ValueError
            for fewer than two draws
        """
        n = len(draws)
        if n < 2:
            raise ValueError(f"row {what!r}: a deviation needs at least two draws, not {n}")
        deviation = float(np.std(draws, ddof=1))
        error = float(np.sqrt(deviation**2 * (1 + 1 / n) + step**2 / 12))
        limit = float(stats.t.ppf(1 - 0.025 / family, n - 1))
        spread = f"deviation of one draw {deviation:.2g}, {n} draws"
        told = f"{spread}; {note}" if note else spread
        self.rows.append(Row(what, paper, float(np.mean(draws)), 0.0, told, None, error, limit))

    def differing(self) -> list[Row]:
        """The rows whose numbers disagree."""
        return [row for row in self.rows if row.differs]

    def markdown(self) -> str:
        """The table as Markdown, thousands separated, without a column that would be empty."""
        columns = {"paper": [row.paper for row in self.rows]}
        columns["expected"] = [row.expected for row in self.rows]
        kept = {name: c for name, c in columns.items() if any(x is not None for x in c)}
        heads = ["", *kept, "ours", "verdict", "note"]
        lines = [f"## {self.title}", "", f"| {' | '.join(heads)} |"]
        lines.append(f"| --- |{' ---: |' * (len(kept) + 1)} --- | --- |")
        for i, row in enumerate(self.rows):
            shown = [row.what, *(_shown(c[i]) for c in kept.values()), _shown(row.ours)]
            lines.append(f"| {' | '.join([*shown, row.verdict, row.note])} |")
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
