"""Reports beside each other: what changed between two, and a table of many."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from isograde.model import SURFACES, Verdict
from isograde.report import words
from isograde.report.findings import by_choice
from isograde.report.headline import anded, by_level, by_topology, standing, titled
from isograde.report.lines import JSON
from isograde.report.markdown import MARK, plain
from isograde.report.page import environment
from isograde.report.reading import Report, bad_of

# The two orders of a comparison, by the name that is shown.
ORDERS: Mapping[str, Callable[[Report], tuple[float, ...]]] = {
    "level first": by_level,
    "topology first": by_topology,
}


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


def unlike(reports: Sequence[Report]) -> str:
    """Why reports are not to be laid side by side, or nothing: what differs might be the grader."""
    for name, said in (
        ("the version of the plan", {one.plan: one.name for one in reports}),
        ("the seed", {one.header["seed"]: one.name for one in reports}),
        ("--full", {one.header["full"]: one.name for one in reports}),
    ):
        if len(said) > 1:
            told = ", ".join(f"{value} for {who}" for value, who in said.items())
            return f"reports of unlike plans: {name} is {told}; grade again by the same"
    return ""


def fewer_scans(reports: Sequence[Report]) -> dict[str, str]:
    """By name, of what extracts surfaces, what was graded on fewer real scans than the others."""
    scans = [
        (one.name, {case for case, said in one.cases.items() if "real" in said["tags"]})
        for one in reports
        if SURFACES in one.kinds
    ]
    every = set().union(*(own for _, own in scans))
    return {
        name: f"graded without {len(every - own)} of the {len(every)} scans (ISOGRADE_DATA)"
        for name, own in scans
        if every - own
    }


def changes(before: Report, after: Report) -> list[Change]:
    """The claims on which some case went from good to bad, or from bad to good."""
    old, new = _bad_cases(before), _bad_cases(after)
    unsent, unsent_now = _unsent(before), _unsent(after)
    seen = {result["case"] for result in before.results}
    shared = seen & {result["case"] for result in after.results}
    found = []
    for claim in before.claims.keys() & after.claims.keys():
        # What was not sent neither held nor failed.
        broken = new.get(claim, set()) - old.get(claim, set()) - unsent.get(claim, set())
        mended = old.get(claim, set()) - new.get(claim, set()) - unsent_now.get(claim, set())
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
        for name, _, _ in bad_of(result):
            if report.summaries[name].state == "fail":
                bad.setdefault(name, set()).add(result["case"])
    return bad


def _unsent(report: Report) -> dict[str, set[str]]:
    """The cases of each claim that were outside the limits, and so not sent."""
    found: dict[str, set[str]] = {}
    for result in report.results:
        for finding in result["findings"]:
            if finding["verdict"] == Verdict.UNSUPPORTED:
                found.setdefault(finding["claim"], set()).add(result["case"])
    return found


def claims_of(reports: Sequence[Report]) -> dict[str, JSON]:
    """Every claim that some report judged, by id, in the order of the ladder."""
    found: dict[str, JSON] = {}
    for report in reports:
        for name, summary in report.summaries.items():
            if summary.asked:
                found.setdefault(name, summary.claim)
    return dict(sorted(found.items(), key=lambda item: _height(item[1]["level"])))


def _height(level: object) -> int:
    """Where a claim of this level stands in the table; what is beside the ladder comes last."""
    return level if isinstance(level, int) else 99


def mark(report: Report, claim: str) -> tuple[str, str]:
    """The state of a claim in a report, and its share of bad cases in words."""
    summary = report.summaries.get(claim)
    if summary is None or not summary.asked:
        return "no evidence", ""
    if claim in by_choice(report):
        return "choice", "by choice"
    if summary.state == "fail":
        return "fail", f"{summary.bad:,} of {summary.evidence:,}"
    if summary.state == "choice":
        return "choice", f"{summary.passed:,} of {summary.evidence:,}"
    return summary.state, ""


def by_kinds(reports: Sequence[Report]) -> dict[str, list[Report]]:
    """The reports that take the same kinds, in the first order."""
    groups: dict[str, list[Report]] = {}
    for report in sorted(reports, key=by_level):
        groups.setdefault(words.kinds(report.kinds), []).append(report)
    return groups


def markdown_table(reports: Sequence[Report], notes: Sequence[str] = ()) -> str:
    """Headlines in both orders, then claims down and implementations across, a part for kinds.

    `notes` are sentences on what makes the reports hard to compare.
    """
    parts = ["# Comparison", *map(plain, notes)]
    for name, group in by_kinds(reports).items():
        parts.append(f"## {name[:1].upper()}{name[1:]}")
        parts += [_headlines(title, group) for title in ORDERS]
        parts.append(_rows(group))
    parts.append("## How they were run")
    parts.append("\n".join(_runs(reports)))
    return "\n\n".join(parts) + "\n"


RUN = ("date", "commit", "checksum of the cases", "isograde", "python", "numpy")


def _runs(reports: Sequence[Report]) -> Iterator[str]:
    """The rows of a table of when and with what each was run."""
    yield f"| implementation | {' | '.join(RUN)} |"
    yield "| --- |" + " --- |" * len(RUN)
    for report in reports:
        said = words.run(report)
        cells = [titled(report), *(said.get(name, "") for name in RUN)]
        yield f"| {' | '.join(plain(cell) for cell in cells)} |"


def _headlines(title: str, reports: Sequence[Report]) -> str:
    """The headlines in one of the orders."""
    lines = [
        f"{place}. {plain(anded([titled(one) for one in group]))} - {plain(said)}"
        for place, said, group in ranked(title, reports)
    ]
    return "\n".join([f"### {title.capitalize()}", "", *lines])


def ranked(title: str, reports: Sequence[Report]) -> list[tuple[int, str, list[Report]]]:
    """Place, headline without the name, and the reports of which it is said, in this order.

    What is said of several that stand together is said once.
    """
    rows: list[tuple[int, str, list[Report]]] = []
    for place, report in enumerate(sorted(reports, key=ORDERS[title]), 1):
        said = standing(report)
        if rows and rows[-1][1] == said:
            rows[-1][2].append(report)
        else:
            rows.append((place, said, [report]))
    return rows


def _rows(reports: Sequence[Report]) -> str:
    """The rows of one table."""
    lines = ["| claim | level | " + " | ".join(plain(r.name) for r in reports) + " |"]
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
    reports: Sequence[Report],
    links: Sequence[str],
    absent: Mapping[str, str] | None = None,
    notes: Sequence[str] = (),
) -> str:
    """Headlines in both orders, claims down, implementations across, as one HTML file.

    `links` are the addresses of the implementations' own pages, empty where there is none; `absent`
    says why other implementations are missing, and `notes` what makes the reports hard to compare.
    """
    link_of = {id(report): link for report, link in zip(reports, links, strict=True)}
    tables = {
        name: {
            "orders": {title: ranked(title, group) for title in ORDERS},
            "reports": [(one, link_of[id(one)]) for one in group],
            "claims": claims_of(group),
        }
        for name, group in by_kinds(reports).items()
    }
    return (
        environment()
        .get_template("comparison.html")
        .render(
            count=len(reports),
            tables=tables,
            mark=mark,
            titled=titled,
            run=words.run,
            RUN=RUN,
            link_of=lambda report: link_of[id(report)],
            absent=absent or {},
            notes=notes,
        )
    )
