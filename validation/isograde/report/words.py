"""How counts, states and levels are said; the same words on every page."""

from __future__ import annotations

from collections.abc import Mapping
from shlex import quote
from typing import Any

from isograde.model import LEVELS
from isograde.report.record import Report, Rung, Summary


def reached(report: Report) -> str:
    """The level reached, as a phrase.

    A run of a part of the claims or the cases reaches no level: it did not look at the rest.
    """
    if report.footer is None:
        return "cut off"
    if report.header["only"]:
        return "part of the cases"
    if report.reached is None:
        return "below level 0"
    level = f"level {report.reached} {LEVELS[report.reached][0]}"
    return f"{level}, {withheld(len(report.withheld))}" if report.withheld else level


def withheld(count: int) -> str:
    """How many claims are withheld: declared as not promised, and so not judged.

    >>> withheld(1), withheld(3)
    ('1 claim withheld', '3 claims withheld')
    """
    return f"{count} claim{'s' if count > 1 else ''} withheld"


def rung(rung: Rung) -> str:
    """What is said of one level: a level of which claims are withheld holds in part."""
    failed = sum(summary.state == "fail" for summary in rung.summaries)
    if rung.state == "fail":
        return f"{failed} of {len(rung.summaries)} fail"
    if rung.state == "pass":
        return "holds in part" if rung.withheld else "holds"
    return "not judged"


def verdict(report: Report) -> str:
    """What the run says of the implementation, in one sentence."""
    level = report.header["implementation"]["level"]
    claimed = f"level {level} ({LEVELS[level][0]})"
    if report.footer is None:
        return "The report was cut off: it has no footer. What follows is what there is."
    n = len(report.broken)
    if n:
        said = f"{n} of the claims it makes {'fails' if n == 1 else 'fail'}."
    else:
        said = "Every claim it makes holds on every case tried."
    without = report.withheld_to(level)
    if without:
        said += f" Of these levels it withholds {', '.join(without)}."
    return f"It claims {claimed}. {said}"


def counted(summary: Summary) -> str:
    """The counts of a claim, the passes first."""
    order = ("pass", "fail", "error", "crash", "timeout", "not run", "unsupported", "skip")
    parts = [f"{summary.counts[word]:,} {word}" for word in order if summary.counts[word]]
    return ", ".join(parts)


def figures(numbers: Mapping[str, Any]) -> str:
    """Figures in a line.

    >>> figures({"order": 1.99, "interval": [1.9, 2.1], "finest_error": 0.00123456})
    'order 1.99, interval 1.9 to 2.1, finest error 0.00123'
    """
    return ", ".join(f"{name.replace('_', ' ')} {_shown(value)}" for name, value in numbers.items())


def _shown(value: Any) -> str:
    """A figure to three digits; a range by its ends; anything else as it is."""
    if isinstance(value, list):
        return " to ".join(map(_shown, value))
    return f"{value:.3g}" if isinstance(value, int | float) else str(value)


def level_of(summary: Summary) -> str:
    """The claim's level, or where it stands instead."""
    level = summary.claim["level"]
    return "beside" if level is None else str(level)


def reproduce(report: Report, summary: Summary) -> str:
    """The command that judges the smallest failed case again."""
    assert summary.failure is not None
    seed = f" --seed {report.header['seed']}" if report.header["seed"] else ""
    only = " ".join(f"--only {quote(name)}" for name in (summary.failure.case, summary.id))
    return f"isograde grade {quote(report.spec)} {only}{seed}"
