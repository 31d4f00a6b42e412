"""A report as one HTML file: nothing to load, for light and dark, paper and phone."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from isograde.model import LEVELS
from isograde.report import words
from isograde.report.picture import picture
from isograde.report.polyline_picture import contour_picture, curve_picture
from isograde.report.record import JSON, Report, Summary
from isograde.report.simplex_picture import SHOWN_BEYOND, simplex_picture
from isograde.report.snippet import snippet

FAMILIES = {
    "structure": "The arrays as they came",
    "topology": "How the mesh hangs together",
    "geometry": "Where the vertices are",
    "counting": "How many there are",
    "cases": "What a cell becomes",
    "symmetry": "The same answer however the field is posed",
    "robustness": "Input that is no field",
    "speed": "What it costs",
}

Draw = Callable[[JSON, JSON, str], str]
_SIDES = (("in", "inside"), ("out", "outside"))
_OPEN = (("gap", "hole"), ("rim", "border of the volume"))
_FAULT = ("ring", "where the fault is")
# How the failures of each discipline are drawn, and what is what in the picture.
DRAWN: dict[str, tuple[Draw, tuple[tuple[str, str], ...]]] = {
    "surfaces": (
        picture,
        (*_SIDES, ("front", "seen from outside"), ("back", "from inside"), *_OPEN),
    ),
    "contours": (
        contour_picture,
        (*_SIDES, ("run", "contour, inside on its left"), ("spot", "loose end"), _FAULT),
    ),
    "curves": (
        curve_picture,
        (("run", "curve, fainter away from the eye"), ("spot", "loose end"), _FAULT),
    ),
    "simplices": (
        simplex_picture,
        (("run", "simplices"), ("gap", "facet of one simplex only"), _OPEN[1], _FAULT),
    ),
}


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
    failures = [_shown(report, summary) for summary in report.failures]
    return (
        environment()
        .get_template("report.html")
        .render(
            report=report,
            failures=failures,
            groups=_groups(report),
            cases=_families_of_cases(report),
        )
    )


def _groups(report: Report) -> dict[str, list[Summary]]:
    """The judged claims by family."""
    groups: dict[str, list[Summary]] = {}
    for summary in report.summaries.values():
        if summary.judged:
            groups.setdefault(summary.family, []).append(summary)
    return groups


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
    declared = report.header["implementation"]
    draw, key = DRAWN[declared["discipline"]]
    if draw is picture:
        draw = partial(picture, tie=declared["conventions"]["tie"])
    pictures = _pictures(report.name, record, draw) if record is not None else []
    return {
        "summary": summary,
        "failure": summary.failure,
        "pictures": pictures,
        "key": key,
        "note": _note(record),
        "record": record,
        "command": words.reproduce(report, summary),
        "snippet": snippet(report, summary),
    }


def _pictures(name: str, record: JSON, draw: Draw) -> list[tuple[str, str]]:
    """What came, and beside it what contradicts it: a variant's answer, or a legal one."""
    if "faces" not in record["came"] and not record["values"]:
        return []
    shown = [(name, draw(record, record["came"], name))]
    posed = record.get("posed")
    if posed is not None and "faces" in posed.get("came", {}):
        caption = f"{name}, {posed['meaning']}; brought back"
        shown.append((caption, draw(record, posed["came"], caption)))
    elif posed is None and "faces" in record.get("legal", {}):
        shown.append(("a legal answer", draw(record, record["legal"], "a legal answer")))
    return shown


def _note(record: JSON | None) -> str:
    """What the picture leaves out."""
    if record is None or "faces" not in record["came"] or len(record["shape"]) <= 3:
        return ""
    shown = min(SHOWN_BEYOND, len(record["came"]["faces"]))
    return (
        f"R^{len(record['shape'])} with one direction of the picture for each axis: of the "
        f"{len(record['came']['faces']):,} simplices the {shown} nearest to the fault."
    )


def _number(value: Any) -> str:
    """A number of the evidence as it is shown."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    return f"{value:,}" if isinstance(value, int) else f"{value:.6g}"
