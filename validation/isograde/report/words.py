"""How counts, states and levels are said; the same words on every page."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from shlex import quote
from typing import Any

from isograde.cases import given
from isograde.model import EVIDENCE, LEVELS, Kind, Verdict
from isograde.report.findings import Cause, Follower, causes, rights
from isograde.report.headline import listed, missing, not_promised
from isograde.report.reading import Failure, Report, Rung, Summary, bad_in
from isograde.variants import MAGNITUDES, OFFSETS

ORDER = (*EVIDENCE, Verdict.NOT_RUN, Verdict.UNSUPPORTED, Verdict.SKIP)
# Cut a heading that is longer, or that brings a trace.
LONG = 480
TRACE = re.compile(r" (?=Current thread 0x|Thread 0x|Traceback \(most|Extension modules:)")
# What counts are called: a case that is no evidence is none of the verdicts a reader knows.
# Magnitudes and offsets from the nearest to the farthest.
SMALLER, LARGER = (["1", *(word for word in MAGNITUDES if word[2] == sign)] for sign in "-+")
FARTHER = ["0", *OFFSETS]
CALLED = {Verdict.SKIP: "no evidence", Verdict.UNSUPPORTED: "declined"}


def reached(report: Report) -> str:
    """The level reached, as a phrase.

    A run of a part of the claims or the cases reaches no level: it did not look at the rest.
    """
    if report.footer is None:
        return "cut off"
    if report.stopped is not None:
        return "stopped before the end"
    if report.partial:
        return "part of the cases"
    if report.reached is None:
        return "no level"
    return f"level {report.reached} {LEVELS[report.reached][0]}"


def rung(rung: Rung) -> str:
    """What is said of one level."""
    if rung.state == "fail":
        failing, more = len(rung.failing), sum(s.only_with_ties for s in rung.summaries)
        said = f"{failing} of {len(rung.summaries)} claims {'fails' if failing == 1 else 'fail'}"
        return f"{said}, {more} more with ties" if more else said
    if rung.state == "pass":
        return "holds with ties too" if not rung.failing_with_ties else "holds, but not with ties"
    return missing(rung)


def verdict(report: Report) -> str:
    """What the run says of the promises, in a sentence or two."""
    if report.footer is None:
        return "The report was cut off: it has no footer. What follows is what there is."
    if report.stopped is not None:
        why, left = report.stopped["why"], report.stopped["left"]
        return (
            f"The run stopped before the end ({why}): {left:,} cases were not judged, so no level "
            f"is reached. Of {len(report.results):,} cases: {_kept(report)}"
        )
    return _kept(report)


def _kept(report: Report) -> str:
    """What is said of the promises by what was judged."""
    level = report.declaration["level"]
    promise = f"It promises level {min(level, report.top)} ({LEVELS[min(level, report.top)][0]})."
    n = len(report.broken)
    if n:
        held = sum(cause.mistakes for cause in causes(report) if cause.held)
        why = f", by {held} {'cause' if held == 1 else 'causes'}" if n > 1 else ""
        said = f"{n} of its promises {'is' if n == 1 else 'are'} broken{why}."
    elif not report.has_evidence:
        said = "No promise was put to the test: nothing that was judged could have failed."
    else:
        said = "Every promise that could be tested holds on every case tried."
    if report.expected and n and not report.unexpected:
        said += " What fails is what was expected to."
    if report.withdrawn:
        said += f" Not promised: {listed(report.withdrawn, 6)}."
    if report.unbodied:
        told = listed([str(kind) for kind in report.unbodied], 6)
        said += f" No known body is kept of {told}: of these, level 0 rests on the other claims."
    return f"{promise} {said}"


def right(report: Report) -> str:
    """What is right on every case tried, in a sentence; or nothing."""
    said = rights(report)
    return f"Right on every case tried: {', '.join(said)}." if said else ""


def where(cause: Cause) -> str:
    """On how many cases a cause is at work, and what else fails for it.

    A choice, and what is not promised, is not counted like a fault.
    """
    said = []
    if cause.choice:
        said.append("by choice")
    elif not cause.held:
        said.append("not promised")
    general, tied = cause.general, cause.tied
    if general:
        said.append(
            f"{general:,} {_fields(general)}" + (f" and {tied:,} with ties" if tied else "")
        )
    else:
        said.append(f"{tied:,} {_fields(tied)} with ties")
    whole = [one.summary.id for one in cause.follows if one.wholly]
    return ", ".join(said) + (f"; so fails {listed(whole, 3)}" if whole else "")


def part(held: bool) -> str:
    """The heading above findings that are held against an implementation, or above the others."""
    return "Promises that are broken" if held else "Beyond what it promises"


def elsewhere(cause: Cause) -> str:
    """On how many of its cases the root of a cause follows from another claim; or nothing."""
    said = [
        f"{one.cases:,} {'follows' if one.cases == 1 else 'follow'} from {one.summary.id}"
        for one in cause.elsewhere
    ]
    return f"Of its {cause.root.bad:,} cases {', '.join(said)}." if said else ""


def _fields(count: int) -> str:
    """The noun of a count of cases."""
    return "field" if count == 1 else "fields"


def partly(follower: Follower) -> str:
    """On how many of its cases a claim fails for another cause."""
    return f"{follower.cases:,} of the {follower.summary.bad:,} cases of {follower.summary.id}"


def run(report: Report) -> dict[str, str]:
    """What a result can be traced by: implementation, date, cases, seed and versions."""
    header, footer = report.header, report.footer or {}
    said = {
        "implementation": report.spec,
        "date": str(header["date"]),
        "checksum of the cases": str(footer.get("checksum", "cut off")),
        "seed": str(header["seed"]),
    }
    return said | {name: str(one) for name, one in header["versions"].items()}


# What the parts of a grade's time are called.
PARTS = {
    "implementation": "the implementation",
    "adapter": "its adapter",
    "oracles": "judging by the oracles",
    "fields": "making the fields",
}


def spent(report: Report) -> str:
    """Where the time of a grade went, in a clause; nothing where the report does not tell.

    What is left of the whole is told of a single process: of several, who waited for whom is not
    known.
    """
    footer = report.footer or {}
    known = footer.get("spent")
    if not known:
        return ""
    told = [f"{known.get(part, 0.0):.1f} s {name}" for part, name in PARTS.items()]
    there = any(one.startswith("--dask") for one in report.header["arguments"])
    if there or report.header["jobs"] > 1:
        return f"{', '.join(told)}, added over its processes"
    rest = max(0.0, footer["seconds"] - sum(known.values()))
    return f"{', '.join(told)}, {rest:.1f} s the smallest cases and the lines of the report"


def brief(text: str) -> str:
    """The text as a heading tells it: without a crash's trace, and at most so long.

    >>> brief("a crash"), len(brief("last words " * 99))
    ('a crash', 480)
    >>> brief("killed; last words: Fatal error: Segmentation fault Current thread 0x7f (most ..")
    'killed; last words: Fatal error: Segmentation fault ..'
    """
    short = TRACE.split(text, maxsplit=1)[0]
    if len(short) > LONG:
        short = short[:LONG].rpartition(" ")[0]
    return text if short == text else f"{short} .."


def case(name: str) -> str:
    """The name of a case in a sentence; where it is cut, the command beside it has it whole."""
    return given.brief(name)


def made_from(failure: Failure) -> str:
    """What the smallest case was made from."""
    if failure.case.startswith("given/"):
        return f"Cut out of {failure.of}; its values are as simple as they can be."
    return f"The smallest failing block of {failure.of}."


def counted(summary: Summary) -> str:
    """The counts of a claim, the passes first."""
    return counts(summary.counts)


def counts(found: Mapping[str, int]) -> str:
    """Counts of verdicts, the passes first.

    >>> counts({"skip": 2, "pass": 1200})
    '1,200 pass, 2 no evidence'
    """
    parts = [f"{found[word]:,} {CALLED.get(word, word)}" for word in ORDER if found.get(word)]
    return ", ".join(parts)


def evidence(summary: Summary) -> str:
    """On how many cases a claim holds, of those on which it could fail."""
    if summary.state == "choice":
        return f"a choice, made on {summary.passed:,} of {summary.evidence:,} cases"
    if not summary.promised and summary.evidence:
        return not_promised(summary)
    if not summary.evidence:
        return "no evidence"
    if not summary.bad:
        return f"holds on {summary.passed:,} cases" if summary.passed > 1 else "holds on 1 case"
    return f"fails on {summary.bad:,} of {summary.evidence:,} cases"


def ranges(report: Report) -> str:
    """Over which magnitudes and offsets the answer stays the same; nothing where nobody asked."""
    scales, shifts = report.figures_of("range.scale"), report.figures_of("range.shift")
    told = []
    if scales:
        least, greatest = (
            min((str(one[end]) for one in scales), key=order.index)
            for end, order in (("least", SMALLER), ("greatest", LARGER))
        )
        greatest = greatest.replace("+", "")
        told.append(f"for values from {least} to {greatest} times as large")
    if shifts:
        offset = min((str(one["offset"]) for one in shifts), key=FARTHER.index)
        told.append(f"on offsets of up to {offset} times their range")
    return f"The answer stays the same {' and '.join(told)}." if told else ""


def split(summary: Summary) -> str:
    """Where a claim fails: in general position, or with ties only."""
    general, tied = bad_in(summary.general), bad_in(summary.tied)
    if general and tied:
        return f"{general:,} in general position, {tied:,} with ties"
    return "all in general position" if general else "all with ties" if tied else ""


def kinds(found: Sequence[Kind]) -> str:
    """The kinds, in words.

    >>> kinds([Kind(3, 1), Kind(4, 2)])
    'surfaces, (4, 2)'
    """
    return ", ".join(map(str, found))


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
    if isinstance(value, Mapping):
        return "; ".join(f"{name} {_shown(one)}" for name, one in value.items())
    return f"{value:.3g}" if isinstance(value, int | float) else str(value)


def level_of(summary: Summary) -> str:
    """The claim's level, or where it stands instead."""
    return "beside" if summary.level is None else str(summary.level)


def declared(report: Report) -> dict[str, str]:
    """The declaration in words: its four words, conventions and limits."""
    said = report.declaration
    rows = {name: _word(said[name]) for name in ("interpolant", "vertices", "domain", "mesh")}
    if said.get("given") == "function":
        rows["given"] = "a function: the interpolant of the samples, or of a known body its own"
    rows |= {name: str(value).replace("_", " ") for name, value in said["conventions"].items()}
    rows["kinds"] = kinds(report.kinds)
    rows |= {
        name: _word(value)
        for name, value in said["limits"].items()
        if name != "kinds" and value not in (0, False, []) and (name, value) != ("least", 1)
    }
    for name in ("promised", "not_promised"):
        if said[name]:
            rows[name.replace("_", " ")] = ", ".join(said[name])
    return rows


def _word(value: Any) -> str:
    """An entry of a declaration, in words."""
    if isinstance(value, list):
        several = [_word(one) for one in value]
        return several[0] if len(set(several)) == 1 else ", ".join(several)
    if not isinstance(value, Mapping):
        return str(value)
    if set(value) == {"inset", "end"}:
        return (
            f"{value['end']}, {value['inset']:g} cells inside" if value["inset"] else value["end"]
        )
    ((name, what),) = value.items()
    return f"{name}, {len(what)} simplices" if isinstance(what, list) else f"{name} {what:g}"


def reproduce(report: Report, summary: Summary) -> str:
    """The command that judges the smallest failed case again, or the call in a session."""
    assert summary.failure is not None
    kind, _, name = report.spec.partition(":")
    if kind == "function":
        seeded = f", seed={report.header['seed']}" if report.header["seed"] else ""
        return f"isograde.grade({name}, only={[summary.failure.case, summary.id]}{seeded})"
    seed = f" --seed {report.header['seed']}" if report.header["seed"] else ""
    only = " ".join(f"--only {quote(name)}" for name in (summary.failure.case, summary.id))
    own = "".join(f" --cases {quote(file)}" for file in own_files(report.header["arguments"]))
    return f"isograde grade {quote(report.spec)} {only}{seed}{own}"


def own_files(arguments: Sequence[str]) -> list[str]:
    """The files of cases of the user's own that were named on a command line.

    >>> own_files(["grade", "x", "--cases", "a.json", "--cases=b.json"])
    ['a.json', 'b.json']
    """
    follows = [after for one, after in pairwise(arguments) if one == "--cases"]
    return follows + [one[8:] for one in arguments if one.startswith("--cases=")]
