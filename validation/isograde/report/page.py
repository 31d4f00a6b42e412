"""A report as one HTML file: nothing to load, for light and dark, paper and phone."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from isograde.model import EVIDENCE, LEVELS
from isograde.report import words
from isograde.report.findings import Cause, causes, rights
from isograde.report.headline import choices, headline, standing
from isograde.report.lines import JSON
from isograde.report.oracles import judge_of, oracles_of
from isograde.report.picture import SHOWN_BEYOND, picture
from isograde.report.reading import CONVENTIONS, Report, Summary, findings_of
from isograde.report.snippet import snippet, without
from isograde.report.viewer import turned_case

FAMILIES = {
    "structure": "The arrays as they came",
    "bodies": "Known bodies come out",
    "topology": "How the mesh hangs together",
    "geometry": "Where the vertices are",
    "counting": "How many there are",
    "cases": "What a cell becomes",
    "cells": "What a cell becomes",
    "symmetry": "The same answer however the field is posed",
    "robustness": "Types, layouts, and input that is no field",
    "accuracy": "How near to a known body, and how fast it gets nearer",
}

# Tell so many findings on the first screen, where there are as many, and no more.
FEW, MANY = 3, 6

_SIDES = (("in", "inside"), ("out", "outside"))
_OPEN = (("gap", "facet of one simplex"), ("rim", "on the border"))
_FAULT = (("crowd", "of more than two"), ("sore", "where the fault is"))
# What is what in a picture, by the dimension of the simplices.
KEYS = {
    0: (*_SIDES, ("spot", "point"), *_FAULT),
    1: (*_SIDES, ("run", "segments"), ("spot", "loose end"), *_FAULT),
    2: (*_SIDES, ("front", "seen from outside"), ("back", "from inside"), *_OPEN, *_FAULT),
}
_LEVEL = ("level", "flat in a face between cells")
BEYOND = (("run", "edges of simplices"), *_OPEN, *_FAULT)


@cache
def environment() -> Environment:
    """The templates, with the words they use."""
    made = Environment(
        loader=PackageLoader("isograde", "report/templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.globals.update(words=words, LEVELS=LEVELS, families=FAMILIES)
    made.filters["number"] = _number
    return made


def page(report: Report) -> str:
    """The report as HTML."""
    found = causes(report)
    return (
        environment()
        .get_template("report.html")
        .render(
            report=report,
            headline=headline(report),
            standing=standing(report),
            choices=choices(report),
            rights=rights(report),
            causes=found,
            first=_first(found),
            judge_of=judge_of,
            oracles_of=oracles_of,
            evidence_of=_evidence_of(report),
            shown={s.id: _shown(report, s) for s in report.failures},
            groups=_groups(report),
            cases=_families_of_cases(report),
            conventions=CONVENTIONS,
            does=done_for(report.spec),
        )
    )


def _first(found: Sequence[Cause]) -> Sequence[Cause]:
    """The findings of the first screen: what is held, a few at least, and not too many."""
    held = sum(cause.held for cause in found)
    return found[: min(max(held, FEW), MANY)]


def done_for(spec: str) -> tuple[str, ...]:
    """What the adapter of a ready-made name does for its library."""
    from isograde.adapters.registry import READY_MADE

    ready = READY_MADE.get(spec)
    return () if ready is None else ready.does


def _groups(report: Report) -> dict[str, list[Summary]]:
    """The claims by family."""
    groups: dict[str, list[Summary]] = {}
    for summary in report.summaries.values():
        groups.setdefault(summary.family, []).append(summary)
    return groups


def _evidence_of(report: Report) -> dict[str, dict[str, int]]:
    """For each claim, how many cases of each family could have failed it."""
    counts: dict[str, dict[str, int]] = {name: {} for name in report.summaries}
    for result in report.results:
        family = result["case"].split("/")[0]
        for name, verdict, _ in findings_of(result):
            if verdict in EVIDENCE:
                counts[name][family] = counts[name].get(family, 0) + 1
    return counts


def _families_of_cases(report: Report) -> dict[str, int]:
    """How many cases of each family there were."""
    counts: dict[str, int] = {}
    for name in report.cases:
        family = name.split("/")[0]
        counts[family] = counts.get(family, 0) + 1
    return counts


def _shown(report: Report, summary: Summary) -> dict[str, Any]:
    """A failed claim with its pictures and the lines that reproduce it."""
    record = report.evidence.get(summary.id)
    pictures = [] if record is None else _pictures(report, record)
    return {
        "summary": summary,
        "failure": summary.failure,
        "pictures": pictures,
        "key": () if record is None else _key(record, pictures),
        "note": _note(record),
        "record": record,
        "command": words.reproduce(report, summary),
        "snippet": snippet(report, summary),
        "without": without(report, summary),
        "turned": turned_case(record, _answers(report, record), _tie(report)),
    }


def _key(record: JSON, drawn: Sequence[tuple[str, str]]) -> tuple[tuple[str, str], ...]:
    """What is what in the pictures of this record; of what is seldom, only what is drawn."""
    n, m = record["kind"]
    seldom = (_LEVEL,) if any('class="level"' in svg for _, svg in drawn) else ()
    return (*_usual(n, m), *seldom)


def _usual(n: int, m: int) -> tuple[tuple[str, str], ...]:
    """What is what in the pictures of a kind."""
    return KEYS.get(n - m, BEYOND) if n <= 3 else BEYOND


def _tie(report: Report) -> str:
    """The side on which a sample equal to the isovalue counts."""
    return str(report.declaration["conventions"]["tie"])


def _pictures(report: Report, record: JSON) -> list[tuple[str, str]]:
    """The answers, each with its caption, as pictures."""
    answers = _answers(report, record)
    return [(caption, picture(record, mesh, caption, _tie(report))) for caption, mesh in answers]


def _answers(report: Report, record: JSON | None) -> list[tuple[str, JSON]]:
    """What came, and beside it what contradicts it: a variant's answer, or a legal one."""
    if record is None or ("simplices" not in record["came"] and not record["values"]):
        return []
    shown = [(report.name, record["came"])]
    posed = record.get("posed")
    if posed is not None and "simplices" in posed.get("came", {}):
        shown.append((f"{report.name}, {posed['meaning']}; brought back", posed["came"]))
    elif posed is None and "simplices" in record.get("legal", {}):
        shown.append(("a legal answer", record["legal"]))
    return shown


def pictured(report: Report, claim: str) -> str:
    """What came on the smallest case that fails a claim, as a picture; nothing where there is none.

    Without the words that a pointer would be shown: for a picture small enough to stand in a row.
    """
    record = report.evidence.get(claim)
    answers = _answers(report, record)
    if record is None or not answers:
        return ""
    return re.sub("<title>.*?</title>", "", picture(record, answers[0][1], claim, _tie(report)))


def _note(record: JSON | None) -> str:
    """What the picture leaves out."""
    if record is None or "simplices" not in record["came"] or len(record["shape"]) <= 3:
        return ""
    count = len(record["came"]["simplices"])
    return (
        f"R^{len(record['shape'])} with one direction of the picture for each axis: of the "
        f"{count:,} simplices the {min(SHOWN_BEYOND, count)} nearest to the fault."
    )


def _number(value: Any) -> str:
    """A number of the evidence as it is shown."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    return f"{value:,}" if isinstance(value, int) else f"{value:.6g}"
