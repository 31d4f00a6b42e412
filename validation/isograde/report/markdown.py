"""A report in Markdown, short enough for a pull request."""

from __future__ import annotations

from isograde.report import words
from isograde.report.findings import Cause, causes
from isograde.report.headline import choices, headline
from isograde.report.reading import Report, Rung

MARK = {
    "pass": "✅",
    "fail": "❌",
    "no evidence": "▫️",
    "unsupported": "➖",
    "not promised": "➖",
    "choice": "➖",
}


def markdown(report: Report) -> str:
    """The report as Markdown: the headline, the ladder, what failed, every claim folded away."""
    title = plain(f"{report.name} {report.declaration['version']}".rstrip())
    said = " ".join(filter(None, [words.verdict(report), words.right(report), *_choices(report)]))
    parts = [f"# {title}", f"**{plain(headline(report))}**", plain(said), _ladder(report)]
    found = causes(report)
    for held in (True, False):
        told = [_cause(report, cause) for cause in found if cause.held is held]
        parts += [f"## {words.part(held)}", *told] if told else []
    parts += filter(None, [words.ranges(report)])
    if report.measured:
        parts.append(_measured(report))
    parts.append(_all_claims(report))
    parts.append(_run(report))
    return "\n\n".join(parts) + "\n"


def plain(text: str) -> str:
    r"""Text of an implementation on one line, with nothing in it that Markdown would act on.

    >>> print(plain("<b>a|b c*"))
    &lt;b&gt;a\|b c\*
    """
    one_line = " ".join(text.split())
    for character, entity in (("&", "&amp;"), ("<", "&lt;"), (">", "&gt;")):
        one_line = one_line.replace(character, entity)
    # A name after an @ would be notified; an empty space keeps it from being one.
    one_line = one_line.replace("@", "@\u200b")
    return "".join(f"\\{c}" if c in "\\`*_[]|~$#" else c for c in one_line)


def code(text: str) -> str:
    """Text in code type, on one line, whatever backticks and bars it holds."""
    return f"`{' '.join(text.split()).replace('`', chr(39)).replace('|', chr(0xA6))}`"


def _choices(report: Report) -> list[str]:
    """What it chooses, as sentences."""
    return [f"It {choice}." for choice in choices(report)]


def _ladder(report: Report) -> str:
    """The levels as a table."""
    lines = ["| level | | guarantee | claims |", "| ---: | --- | --- | --- |"]
    lines += [_rung(rung) for rung in report.rungs]
    return "\n".join(lines)


def _rung(rung: Rung) -> str:
    """One level as a row."""
    name = f"{MARK[rung.state]} **{rung.name}**"
    return f"| {rung.level} | {name} | {rung.promise} | {words.rung(rung)} |"


def _cause(report: Report, cause: Cause) -> str:
    """One finding: the diagnosis, its claim with the smallest case, and what follows."""
    summary, failure = cause.root, cause.root.failure
    assert failure is not None
    language = "py" if report.spec.startswith("function:") else "sh"
    said = words.brief(f"{cause.said[:1].upper()}{cause.said[1:]}")
    text = (
        f"### {plain(said)}\n\n"
        f"`{summary.id}`: {summary.claim['rule']}\n\n"
        f"{words.evidence(summary)}; {words.where(cause)}. Smallest: "
        f"{code(words.case(failure.case))}, {failure.samples} samples: "
        f"{plain(words.brief(failure.detail))}."
        f"{' ' if cause.elsewhere else ''}{words.elsewhere(cause)}\n\n"
        f"```{language}\n{' '.join(words.reproduce(report, summary).split())}\n```"
    )
    whole = [one.summary for one in cause.follows if one.wholly]
    rows = [f"- `{one.id}` {words.evidence(one)}" for one in whole]
    return "\n\n".join([text, *(["What follows from it:\n\n" + "\n".join(rows)] if rows else [])])


def _measured(report: Report) -> str:
    """Every figure that was measured, in a folded table."""
    lines = ["<details><summary>Measured</summary>", ""]
    lines += ["| claim | case | figures |", "| --- | --- | --- |"]
    for claim, case, numbers in report.measured:
        lines.append(f"| {code(claim)} | {code(case)} | {plain(words.figures(numbers))} |")
    return "\n".join([*lines, "", "</details>"])


def _all_claims(report: Report) -> str:
    """Every claim in a folded table."""
    lines = ["<details><summary>Every claim</summary>", ""]
    lines += ["| | claim | level | evidence | counts |", "| --- | --- | ---: | --- | --- |"]
    lines += [
        f"| {MARK[s.state]} | `{s.id}` | {words.level_of(s)} | {words.evidence(s)} "
        f"| {words.counted(s)} |"
        for s in report.summaries.values()
    ]
    return "\n".join([*lines, "", "</details>"])


def _run(report: Report) -> str:
    """How it was run, in a line."""
    footer, header = report.footer, report.header
    if footer is None:
        return "The run was cut off."
    versions = header["versions"]
    commit = f" at commit {plain(versions['commit'])}" if "commit" in versions else ""
    took = f" ({words.spent(report)})" if words.spent(report) else ""
    return (
        f"{header['date']}: {footer['cases']:,} cases (checksum {footer['checksum']}), "
        f"{footer['calls']:,} calls, {footer['seconds']:.0f} s{took}, plan "
        f"{header.get('plan', 1)}, "
        f"seed {header['seed']}; isograde "
        f"{versions.get('isograde', 'source')}{commit}, Python {versions['python']}, NumPy "
        f"{versions['numpy']}."
    )
