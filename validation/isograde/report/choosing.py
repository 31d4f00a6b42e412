"""The page on which people choose: implementations as rows, one scoring, answers with reasons.

A row is computed from a report, and from what is known *about* the package beside it: language,
licence, homepage. Rows stand in the first order of a comparison (`isograde.report.comparison`),
libraries first, what is ours apart. A number that was not measured is left blank and says so; an
implementation that could not be graded keeps its row, greyed, with the reason.

A *need* is a question with a rule: which rows answer it, and what is shown as the reason. The rules
are those of the page's text, and nothing else ranks.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from dataclasses import field as fresh
from math import inf

from isograde.model import LEVELS
from isograde.report.comparison import by_kinds
from isograde.report.findings import causes
from isograde.report.headline import (
    by_level,
    choices,
    family_of,
    ties_torn,
    wrong_cells,
)
from isograde.report.page import environment
from isograde.report.reading import CONVENTIONS, Report

OURS = ("isoref", "isograde")
CLOSED, CONSISTENT = 1, 2


@dataclass(frozen=True)
class About:
    """What is known of a package beside its report; empty where it is not.

    use : what the licence allows: permissive, copyleft or non-commercial
    calls : the call that was graded
    """

    package: str = ""
    language: str = ""
    written_in: str = ""
    licence: str = ""
    use: str = ""
    homepage: str = ""
    calls: str = ""


NOBODY = About()


@dataclass(frozen=True)
class Row:
    """An implementation as the page shows it.

    Attributes
    ----------
    rank : its place in the first order, from 1
    family : interpolant and placing of vertices, in words
    capped : it closes the surface at the border of the volume
    level, top : the level reached, -1 for none, and the highest of its family
    level_name : in words
    ties : the level holds with ties too; None where no field had ties
    torn : fields with ties that are torn, of how many
    wrong : wrong cells in a million on real scans
    worst : the first thing that is wrong, in a sentence; its claim; and whether it is promised
    """

    rank: int
    name: str
    version: str
    link: str
    ours: bool
    about: About
    family: str
    capped: bool
    level: int
    top: int
    level_name: str
    ties: bool | None
    torn: tuple[int, int] | None
    wrong: float | None
    worst: str
    worst_claim: str
    worst_held: bool
    choices: tuple[str, ...]
    date: str


@dataclass(frozen=True)
class Need:
    """A question of somebody who chooses.

    fits : the rows that answer it
    key : which answers better; smaller is better
    reason : why a row is an answer, in words
    rule : the same for all, in a sentence
    """

    name: str
    asked: str
    rule: str
    fits: Callable[[Row], bool]
    key: Callable[[Row], tuple[float, ...]]
    reason: Callable[[Row], str]


def row(report: Report, rank: int, link: str, about: About = NOBODY) -> Row:
    """The row of a report."""
    reached = report.reached
    found = [one for one in causes(report) if not one.choice and one.root.id not in CONVENTIONS]
    return Row(
        rank,
        report.name,
        str(report.declaration["version"]),
        link,
        report.spec.split(":")[0] in OURS,
        about,
        family_of(report) or "multilinear, vertices on edges",
        all(end["end"] == "closed" for end in report.declaration["domain"]),
        -1 if reached is None else reached,
        report.top,
        "none" if reached is None else LEVELS[reached][0],
        report.with_ties,
        ties_torn(report),
        wrong_cells(report),
        found[0].said if found else "",
        found[0].root.id if found else "",
        bool(found) and found[0].held,
        tuple(choices(report)),
        str(report.header["date"])[:10],
    )


def _in_order(one: Row) -> tuple[float, ...]:
    """The page's own order."""
    return (one.rank,)


def _torn_share(one: Row) -> float:
    """The share of fields with ties that are torn; 1 where none was judged."""
    return one.torn[0] / one.torn[1] if one.torn else 1.0


def _wrong(one: Row) -> float:
    """Wrong cells in a million; infinite where none was judged."""
    return inf if one.wrong is None else one.wrong


def _closed_because(one: Row) -> str:
    """What is said of a closed surface."""
    said = f"level {one.level} of {one.top}"
    said += ", capped at the border" if one.capped else ""
    if one.ties:
        return f"{said}, with ties too"
    return f"{said}; torn in {one.torn[0]} of {one.torn[1]} fields with ties" if one.torn else said


def _wrong_because(one: Row) -> str:
    """What is said of topology."""
    return f"{_wrong(one):,.0f} wrong cells in a million on scans; {_closed_because(one)}"


def _from_python(one: Row) -> bool:
    """It is called from Python, and its licence is permissive."""
    return one.about.language == "Python" and one.about.use == "permissive"


NEEDS = (
    Need(
        "closed-python",
        "a closed surface of a CT, from Python, permissive licence",
        "Level 1 or above (closed wherever no sample equals the isovalue), called from Python, a "
        "permissive licence; fewest fields with ties torn first, then fewest wrong cells on scans.",
        lambda one: one.level >= CLOSED and _from_python(one),
        lambda one: (_torn_share(one), _wrong(one), one.rank),
        _closed_because,
    ),
    Need(
        "watertight",
        "a closed surface for printing",
        "Level 1 or above, and no field with ties torn: scans of whole numbers have ties. A "
        "surface that meets the border of the volume is closed there only by those that cap it.",
        lambda one: one.level >= CLOSED and one.torn is not None and not one.torn[0],
        _in_order,
        _closed_because,
    ),
    Need(
        "topology",
        "the right topology, to measure or to count",
        "Level 2 or above; fewest cells of real scans in which the topology is not that of the "
        "trilinear interpolant first.",
        lambda one: one.level >= CONSISTENT and one.wrong is not None,
        lambda one: (_wrong(one), one.rank),
        _wrong_because,
    ),
    Need(
        "manifold",
        "a manifold for simulation or repair-free processing",
        "Level 2 or above, with ties too.",
        lambda one: one.level >= CONSISTENT and bool(one.ties),
        _in_order,
        _closed_because,
    ),
    Need(
        "labels",
        "a surface round a label",
        "Takes inside and outside alone (interpolant labels), level 1 or above.",
        lambda one: one.family.startswith("labels") and one.level >= CLOSED,
        _in_order,
        _closed_because,
    ),
)
"""Questions the results can answer. Speed, sharp features and huge volumes are not among them: the
grader does not measure them, and the page says so."""


@dataclass(frozen=True)
class Page:
    """What the template shows of one group of kinds."""

    kinds: str
    rows: tuple[Row, ...]
    answers: tuple[tuple[Need, tuple[Row, ...]], ...] = fresh(default=())


def pages(
    reports: Sequence[Report], links: Mapping[str, str], about: Mapping[str, About]
) -> list[Page]:
    """The groups of those that take the same kinds, the largest first."""
    found = []
    for kinds, group in by_kinds(reports).items():
        ranked = [
            row(one, place, links.get(one.name, ""), about.get(one.name, NOBODY))
            for place, one in enumerate(sorted(group, key=by_level), 1)
        ]
        rows = tuple(sorted(ranked, key=lambda one: (one.ours, one.rank)))
        found.append(Page(kinds, rows, tuple((need, answers(need, rows)) for need in NEEDS)))
    return sorted(found, key=lambda page: -len(page.rows))


def answers(need: Need, rows: Sequence[Row]) -> tuple[Row, ...]:
    """The rows that fit a need, the best first."""
    return tuple(sorted(filter(need.fits, rows), key=need.key))


def choosing_page(
    reports: Sequence[Report],
    links: Mapping[str, str],
    about: Mapping[str, About] | None = None,
    absent: Mapping[str, str] | None = None,
) -> str:
    """The page as one HTML file.

    links, about : by the implementation's name
    absent : by name, why an implementation could not be graded
    """
    return (
        environment()
        .get_template("choosing.html")
        .render(pages=pages(reports, links, about or {}), absent=absent or {}, count=len(reports))
    )


def twelve_lines(reports: Sequence[Report], about: Mapping[str, About], most: int = 10) -> str:
    """The best of those that are not ours, as a Markdown table of `most` rows."""
    lines = ["| implementation | language | level | wrong cells in a million | licence |"]
    lines.append("| --- | --- | --- | ---: | --- |")
    rows = [one for page in pages(reports, {}, about)[:1] for one in page.rows if not one.ours]
    for one in rows[:most]:
        wrong = "" if one.wrong is None else f"{one.wrong:,.0f}"
        ties = ", with ties too" if one.ties else ""
        lines.append(
            f"| {one.name} {one.version} | {one.about.language} | {one.level} of {one.top} "
            f"{one.level_name}{ties} | {wrong} | {one.about.licence} |"
        )
    return "\n".join(lines) + "\n"
