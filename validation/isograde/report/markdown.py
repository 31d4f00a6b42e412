"""A report in Markdown, short enough for a pull request."""

from __future__ import annotations

from isograde.report import words
from isograde.report.record import Report, Rung, Summary

MARK = {"pass": "✅", "fail": "❌", "not judged": "▫️", "unsupported": "➖"}
# A level that holds but for claims that are withheld.
PART = "☑️"


def markdown(report: Report) -> str:
    """The report as Markdown: the ladder, what failed, and every claim folded away."""
    declared = report.header["implementation"]
    title = f"# {report.name} {declared['version']}".rstrip()
    parts = [title, f"**{words.reached(report)}** · {words.verdict(report)}", _ladder(report)]
    if report.failures:
        parts.append("## What failed")
        parts += [_failure(report, summary) for summary in report.failures]
    if report.measured:
        parts.append(_measured(report))
    parts.append(_all_claims(report))
    parts.append(_run(report))
    return "\n\n".join(parts) + "\n"


def _ladder(report: Report) -> str:
    """The levels as a table."""
    lines = ["| level | | guarantee | claims |", "| ---: | --- | --- | --- |"]
    lines += [_rung(rung) for rung in report.rungs]
    return "\n".join(lines)


def _rung(rung: Rung) -> str:
    """One level as a row."""
    held = sum(summary.state == "pass" for summary in rung.summaries)
    count = f"{held} of {len(rung.summaries)} hold" if rung.summaries else "none judged"
    if rung.withheld:
        count += f", {words.withheld(len(rung.withheld))}: {', '.join(rung.withheld)}"
    mark = PART if rung.state == "pass" and rung.withheld else MARK[rung.state]
    return f"| {rung.level} | {mark} **{rung.name}** | {rung.promise} | {count} |"


def _failure(report: Report, summary: Summary) -> str:
    """One failed claim with its smallest case."""
    failure = summary.failure
    assert failure is not None
    held = "" if summary.claim["held"] else " (not claimed, not held against it)"
    return (
        f"### `{summary.id}`{held}\n\n"
        f"{summary.claim['rule']}\n\n"
        f"{words.counted(summary)}. Smallest: `{failure.case}`, {failure.samples} samples: "
        f"{failure.detail}.\n\n```sh\n{words.reproduce(report, summary)}\n```"
    )


def _measured(report: Report) -> str:
    """Every figure that was measured, in a folded table."""
    lines = ["<details><summary>Measured</summary>", ""]
    lines += ["| claim | case | figures |", "| --- | --- | --- |"]
    for claim, case, numbers in report.measured:
        lines.append(f"| `{claim}` | `{case}` | {words.figures(numbers)} |")
    return "\n".join([*lines, "", "</details>"])


def _all_claims(report: Report) -> str:
    """Every claim in a folded table."""
    lines = ["<details><summary>Every claim</summary>", ""]
    lines += ["| | claim | level | counts |", "| --- | --- | ---: | --- |"]
    lines += [
        f"| {MARK[s.state]} | `{s.id}` | {words.level_of(s)} | {words.counted(s)} |"
        for s in report.summaries.values()
        if s.judged
    ]
    return "\n".join([*lines, "", "</details>"])


def _run(report: Report) -> str:
    """How it was run, in a line."""
    footer, header = report.footer, report.header
    if footer is None:
        return "The run was cut off."
    versions = header["versions"]
    return (
        f"{footer['cases']:,} cases, {footer['calls']:,} calls, {footer['seconds']:.0f} s, seed "
        f"{header['seed']}; isograde {versions.get('isograde', 'source')}, "
        f"Python {versions['python']}, NumPy {versions['numpy']}."
    )
