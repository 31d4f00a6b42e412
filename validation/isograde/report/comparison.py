"""Reports beside each other: what changed between two, and a table of many."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from isograde.report import words
from isograde.report.markdown import MARK
from isograde.report.page import environment
from isograde.report.record import Report
from isograde.runner import BAD


@dataclass(frozen=True)
class Change:
    """A claim that two reports see differently, with the cases that made the difference.

    Only cases that both reports judged are compared.
    """

    claim: str
    before: str
    after: str
    broken: tuple[str, ...]
    mended: tuple[str, ...]


def changes(before: Report, after: Report) -> list[Change]:
    """The claims on which some case went from good to bad, or from bad to good."""
    old, new = _bad_cases(before), _bad_cases(after)
    seen = {result["case"] for result in before.results}
    shared = seen & {result["case"] for result in after.results}
    found = []
    for claim in before.claims.keys() & after.claims.keys():
        broken = new.get(claim, set()) - old.get(claim, set())
        mended = old.get(claim, set()) - new.get(claim, set())
        if (broken | mended) & shared:
            states = before.summaries[claim].state, after.summaries[claim].state
            found.append(
                Change(
                    claim, *states, tuple(sorted(broken & shared)), tuple(sorted(mended & shared))
                )
            )
    return sorted(found, key=lambda change: change.claim)


def _bad_cases(report: Report) -> dict[str, set[str]]:
    """The cases on which each claim is bad."""
    bad: dict[str, set[str]] = {}
    for result in report.results:
        for finding in result["findings"]:
            if finding["verdict"] in BAD:
                bad.setdefault(finding["claim"], set()).add(result["case"])
    return bad


def claims_of(reports: Sequence[Report]) -> dict[str, dict[str, object]]:
    """Every claim that some report judged, by id, in the order of the ladder."""
    found: dict[str, dict[str, object]] = {}
    for report in reports:
        for name, summary in report.summaries.items():
            if summary.judged:
                found.setdefault(name, summary.claim)
    return dict(sorted(found.items(), key=lambda item: _height(item[1]["level"])))


def _height(level: object) -> int:
    """Where a claim of this level stands in the table; what is beside the ladder comes last."""
    return level if isinstance(level, int) else 99


def mark(report: Report, claim: str) -> tuple[str, str]:
    """The state of a claim in a report, and its share of bad cases in words."""
    summary = report.summaries.get(claim)
    if summary is None or not summary.judged:
        return "not judged", ""
    if summary.state == "fail":
        return "fail", f"{summary.bad:,} of {summary.judged:,}"
    return summary.state, ""


def by_discipline(reports: Sequence[Report]) -> dict[str, list[Report]]:
    """The reports of each discipline."""
    groups: dict[str, list[Report]] = {}
    for report in reports:
        groups.setdefault(discipline_of(report), []).append(report)
    return groups


def discipline_of(report: Report) -> str:
    """The discipline that the implementation declares."""
    return str(report.header["implementation"]["discipline"])


def markdown_table(reports: Sequence[Report]) -> str:
    """Claims down, implementations across, as Markdown; a table a discipline."""
    tables = [
        f"## {name.capitalize()}\n\n{_rows(group)}\n"
        for name, group in by_discipline(reports).items()
    ]
    return "\n".join(["# Comparison\n", *tables])


def _rows(reports: Sequence[Report]) -> str:
    """The rows of one table."""
    lines = ["| claim | level | " + " | ".join(r.name for r in reports) + " |"]
    lines.append("| --- | ---: |" + " --- |" * len(reports))
    levels = " | ".join(f"**{words.reached(report)}**" for report in reports)
    lines.append(f"| reached | | {levels} |")
    for claim, record in claims_of(reports).items():
        cells = [mark(report, claim) for report in reports]
        shown = " | ".join(f"{MARK[state]} {share}".strip() for state, share in cells)
        level = "" if record["level"] is None else record["level"]
        lines.append(f"| `{claim}` | {level} | {shown} |")
    return "\n".join(lines)


def comparison_page(
    reports: Sequence[Report], links: Sequence[str], absent: dict[str, str] | None = None
) -> str:
    """Claims down, implementations across, as one HTML file.

    `links` are the addresses of the implementations' own pages, empty where there is none; `absent`
    says why other implementations are missing.
    """
    linked = list(zip(reports, links, strict=True))
    tables = {
        name: (
            [(one, link) for one, link in linked if discipline_of(one) == name],
            claims_of(group),
        )
        for name, group in by_discipline(reports).items()
    }
    return (
        environment()
        .get_template("comparison.html")
        .render(count=len(reports), tables=tables, mark=mark, absent=absent or {})
    )
