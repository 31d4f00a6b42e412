"""What `isograde.grade` and `isograde.compare` give: results that show and write themselves.

In a notebook a result is a short summary, with the whole page folded away below it; printed, it is
the headline and the ladder.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from isograde import report as reports
from isograde.commands.console import Exit, status_of
from isograde.report import comparison, words
from isograde.report.headline import by_level, headline
from isograde.report.lines import write_lines
from isograde.report.page import page
from isograde.report.reading import Report, Summary

MARKS = {"pass": "✓", "fail": "✗"}
# Colours that are read on light and on dark pages.
GOOD, BAD, QUIET = "#2f9e5f", "#d64535", "#808890"
COLOURS = {"pass": GOOD, "fail": BAD}


@dataclass(frozen=True, eq=False)
class Grade:
    """What was found of one implementation.

    report : everything that was found, claim by claim and case by case
    strict : a promised claim without evidence counts as a failure
    """

    report: Report
    strict: bool = False

    @property
    def headline(self) -> str:
        """One line: name, level, and what is short of the next."""
        return headline(self.report)

    @property
    def level(self) -> int | None:
        """The level reached; None where not even level 0 is, or a part was graded."""
        return self.report.reached

    @property
    def status(self) -> int:
        """The exit status of the command for this result."""
        return int(status_of(self.report, self.strict))

    @property
    def holds(self) -> bool:
        """Every promised claim that could be tested holds, and there was evidence."""
        return self.status == Exit.HOLDS

    @property
    def failures(self) -> dict[str, str]:
        """What is wrong with the smallest failed case of each claim that failed, by id."""
        found = {}
        for summary in self.report.failures:
            assert summary.failure is not None
            found[summary.id] = f"{summary.failure.case}: {summary.failure.detail}"
        return found

    def save(self, folder: str | Path, formats: Sequence[str] = tuple(reports.FORMATS)) -> Path:
        """Write report.jsonl, and html, md, junit, badge, shields, to a folder; its path."""
        place = Path(folder)
        write_lines(self.report.records, place / "report.jsonl")
        reports.write(self.report, place, "report", formats)
        return place

    def __str__(self) -> str:
        """The headline, the ladder, and what failed."""
        report = self.report
        lines = [self.headline, words.verdict(report)]
        lines += [
            f"  {MARKS.get(rung.state, '·')} {rung.level} {rung.name}: {words.rung(rung)}"
            for rung in reversed([] if report.partial else report.rungs)
        ]
        lines += [f"{_failed(one)}\n  {words.reproduce(report, one)}" for one in report.failures]
        return "\n".join(lines)

    def __repr__(self) -> str:
        """The headline."""
        return f"<isograde.Grade {self.headline}>"

    def _repr_html_(self) -> str:
        """The headline, the ladder and what failed, then the whole page, folded away."""
        report = self.report
        rungs = "".join(
            f'<tr><td>{rung.level}</td><td style="text-align:left">{rung.name}</td>'
            f'<td style="text-align:left;color:{COLOURS.get(rung.state, QUIET)}">'
            f"{escape(words.rung(rung))}</td></tr>"
            for rung in reversed([] if report.partial else report.rungs)
        )
        failed = "".join(f"<li>{escape(_failed(one))}</li>" for one in report.failures)
        return (
            f"<p><b>{escape(self.headline)}</b><br>{escape(words.verdict(report))}</p>"
            + (f"<table>{rungs}</table>" if rungs else "")
            + (f"<ul>{failed}</ul>" if failed else "")
            + _folded(page(report))
        )


def _failed(summary: Summary) -> str:
    """What failed, in a line."""
    failure = summary.failure
    assert failure is not None
    promised = "" if summary.promised else " (not promised)"
    return (
        f"{summary.id}{promised}: {words.counted(summary)}; smallest {words.case(failure.case)} "
        f"({failure.samples} samples): {failure.detail}"
    )


def _folded(html: str) -> str:
    """A page of its own inside another, shown on request."""
    return (
        "<details><summary>the whole report</summary>"
        f'<iframe srcdoc="{escape(html)}" style="width:100%;height:40rem;border:1px solid {QUIET}" '
        'sandbox="allow-scripts allow-popups"></iframe></details>'
    )


@dataclass(frozen=True, eq=False)
class Comparison:
    """Several implementations side by side, the best first."""

    grades: tuple[Grade, ...]

    @property
    def reports(self) -> list[Report]:
        """The reports in order: by level, then by what is short of the next."""
        return sorted((one.report for one in self.grades), key=by_level)

    @property
    def ranking(self) -> list[str]:
        """The names, the best first."""
        return [report.name for report in self.reports]

    def save(self, path: str | Path) -> Path:
        """Write the comparison as a .html or .md file; its path."""
        place = Path(path)
        if place.suffix not in {".html", ".md"}:
            raise ValueError(f"{place} ends in neither .html nor .md")
        return reports.write_whole(
            place, self._page() if place.suffix == ".html" else self._table()
        )

    def _page(self) -> str:
        """The comparison as HTML."""
        return comparison.comparison_page(self.reports, [""] * len(self.grades))

    def _table(self) -> str:
        """The comparison as Markdown."""
        return comparison.markdown_table(self.reports)

    def __str__(self) -> str:
        """The headlines, the best first."""
        return "\n".join(headline(report) for report in self.reports)

    def __repr__(self) -> str:
        """The names, the best first."""
        return f"<isograde.Comparison of {', '.join(self.ranking)}>"

    def _repr_html_(self) -> str:
        """The headlines in order, then the whole page, folded away."""
        lines = "".join(f"<li>{escape(headline(report))}</li>" for report in self.reports)
        return f"<ol>{lines}</ol>{_folded(self._page())}"
