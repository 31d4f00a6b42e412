"""The page on which people choose: implementations as rows, one scoring, answers with reasons.

A row is computed from a report, and from what is known *about* the package beside it: language,
licence, homepage. Rows stand in the first order of a comparison (`isograde.report.comparison`),
libraries first, what is ours apart. A number that was not measured is left blank and says so; an
implementation that could not be graded keeps its row, greyed, with the reason.

A *need* is a question with a rule: which rows answer it, and what is shown as the reason. The rules
are those of the page's text, and nothing else ranks.

Every verdict is a link to what it rests on: a claim of the implementation's own page, with the case
and the lines that show it, or the rounds that were measured (`isograde.report.speed`).
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
    ANSWERS,
    TIES,
    TRILINEAR,
    by_level,
    choices,
    family_of,
    ties_torn,
    ties_unanswered,
    wrong_cells,
)
from isograde.report.page import environment, pictured
from isograde.report.reading import CONVENTIONS, Report
from isograde.report.scatter import Point, front, scatter
from isograde.report.speed import Measured
from isograde.report.trend import Trend, trends

OURS = ("isoref", "isograde")
RUNS, CLOSED, CONSISTENT = 0, 1, 2
DISTANCE = "accuracy.distance"


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
    unanswered : fields with ties on which no mesh came
    wrong : wrong cells in a million on real scans
    accuracy : mean distance to a known sphere, in its radius, with 3 * 2^k samples a radius
    worst : the first thing that is wrong, in a sentence; whether it is promised; its picture
    at : by what is shown (level, ties, wrong, accuracy, worst), where on its page that is shown
    short : the share of fields in general position that are short of the next level
    cost : what it costs beside the peer, where that was measured
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
    unanswered: int
    wrong: float | None
    accuracy: float | None
    worst: str
    worst_held: bool
    worst_picture: str
    at: Mapping[str, str]
    choices: tuple[str, ...]
    date: str
    short: float
    cost: Measured | None

    @property
    def height(self) -> float:
        """The level, and the share of fields that reach the next."""
        return self.level + (1 - self.short if self.level < self.top else 0.0)

    @property
    def id(self) -> str:
        """The name, fit to be the target of a link on this page."""
        return "".join(letter if letter.isalnum() else "-" for letter in self.name)

    @property
    def torn_share(self) -> float:
        """The share of fields with ties torn or without an answer; 2 where there are none."""
        torn, judged = self.torn or (0, 0)
        asked = judged + self.unanswered
        return (torn + self.unanswered) / asked if asked else 2.0

    @property
    def whole_with_ties(self) -> bool:
        """Every field with ties was answered, and none is torn."""
        return self.torn is not None and not self.torn[0] and not self.unanswered

    def link_to(self, shown: str) -> str:
        """Where what is shown can be checked, or nothing where there is no page."""
        return f"{self.link}#{self.at[shown]}" if self.link else ""


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


def row(
    report: Report, rank: int, link: str, about: About = NOBODY, cost: Measured | None = None
) -> Row:
    """The row of a report."""
    reached = report.reached
    found = [one for one in causes(report) if not one.choice and one.root.id not in CONVENTIONS]
    rung = report.next_rung
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
        ties_unanswered(report),
        wrong_cells(report),
        _accuracy(report),
        found[0].said if found else "",
        bool(found) and found[0].held,
        pictured(report, found[0].root.id) if found else "",
        {
            "level": _place(report, _first_failing(report)),
            "ties": _place(report, ANSWERS if ties_unanswered(report) else TIES),
            "wrong": _place(report, TRILINEAR),
            "accuracy": _place(report, DISTANCE),
            "worst": _place(report, found[0].root.id if found else ""),
        },
        tuple(choices(report)),
        str(report.header["date"])[:10],
        0.0 if rung is None else report.short_of(rung.level).share,
        cost,
    )


def _first_failing(report: Report) -> str:
    """The claim that keeps a report from the next level, or nothing."""
    rung = report.next_rung
    return rung.failing[0].id if rung is not None and rung.failing else ""


def _place(report: Report, claim: str) -> str:
    """Where a report's page speaks of a claim: the failing case, the claim, or the ladder."""
    if any(one.id == claim for cause in causes(report) for one in cause.told):
        return f"failure-{claim}"
    return claim if claim in report.summaries else "ladder"


def _accuracy(report: Report) -> float | None:
    """The finest mean distance to the sphere, or None where it was not measured."""
    for claim, case, numbers in report.measured:
        if claim == DISTANCE and case == "accuracy/sphere":
            return float(numbers["finest_error"])
    return None


def _in_order(one: Row) -> tuple[float, ...]:
    """The page's own order."""
    return (one.rank,)


def _torn_share(one: Row) -> float:
    """The share of fields with ties torn or without an answer; 1 where none was judged."""
    return min(one.torn_share, 1.0)


def _wrong(one: Row) -> float:
    """Wrong cells in a million; infinite where none was judged."""
    return inf if one.wrong is None else one.wrong


def _closed_because(one: Row) -> str:
    """What is said of a closed surface."""
    said = f"level {one.level} of {one.top}"
    said += ", capped at the border" if one.capped else ""
    if one.ties:
        return f"{said}, with ties too"
    if one.unanswered:
        said += f"; no answer to {one.unanswered} of the fields with ties"
    return f"{said}; torn in {one.torn[0]} of {one.torn[1]} fields with ties" if one.torn else said


def _wrong_because(one: Row) -> str:
    """What is said of topology."""
    return f"{_wrong(one):,.0f} wrong cells in a million on scans; {_closed_because(one)}"


def _ratio(one: Row) -> float:
    """Its time over the peer's; infinite where it was not measured."""
    return inf if one.cost is None else one.cost.ratio


def _memory(one: Row) -> float:
    """Its memory over the peer's; infinite where it was not measured."""
    found = None if one.cost is None else one.cost.memory
    return inf if found is None else found


def _timed(one: Row) -> str:
    """What is said of its speed."""
    if one.cost is None:
        return "speed not measured"
    busy = " (a busy machine)" if one.cost.busy else ""
    return f"{one.cost.ratio:.2g} times the time of {one.cost.peer}{busy}"


def _fast_because(one: Row) -> str:
    """Speed first, then what it is worth."""
    return f"{_timed(one)}; {_closed_because(one)}"


def _closed_and_fast_because(one: Row) -> str:
    """What it is worth first, then its speed."""
    return f"{_closed_because(one)}; {_timed(one)}"


def _small_because(one: Row) -> str:
    """What is said of memory."""
    assert one.cost is not None
    most = max(one.cost.costs, key=lambda cost: cost.megabytes[0])
    said = f"{_memory(one):.2g} times the memory of {one.cost.peer}"
    return f"{said}; {most.megabytes[0]:.3g} MB for {most.field}; {_closed_because(one)}"


def _in_cells_because(one: Row) -> str:
    """What is said of a method that can have a vertex on a crease."""
    return f"{one.family}; {_closed_because(one)}"


def _from_python(one: Row) -> bool:
    """It is called from Python, and its licence is permissive."""
    return one.about.language == "Python" and one.about.use == "permissive"


NEEDS = (
    Need(
        "closed-python",
        "a closed surface of a CT, in Python, fast, permissive licence",
        "Level 1 or above (closed wherever no sample equals the isovalue), called from Python, a "
        "permissive licence; fewest fields with ties torn or without an answer first, for a CT of "
        "whole numbers has ties, then the fastest.",
        lambda one: one.level >= CLOSED and _from_python(one),
        lambda one: (_torn_share(one), _ratio(one), _wrong(one), one.rank),
        _closed_and_fast_because,
    ),
    Need(
        "watertight",
        "a closed surface for printing",
        "Level 1 or above, every field with ties answered and none torn: scans of whole numbers "
        "have ties. A surface that meets the border of the volume is closed there only by those "
        "that cap it, which come first.",
        lambda one: one.level >= CLOSED and one.whole_with_ties,
        lambda one: (not one.capped, one.rank),
        _closed_because,
    ),
    Need(
        "topology",
        "the right topology, to measure or to count",
        "Level 1 or above; fewest cells of real scans in which the topology is not that of the "
        "trilinear interpolant first.",
        lambda one: one.level >= CLOSED and one.wrong is not None,
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
        "preview",
        "the fastest preview",
        "Level 0 or above; the least time beside the peer first.",
        lambda one: one.level >= RUNS and one.cost is not None,
        lambda one: (_ratio(one), one.rank),
        _fast_because,
    ),
    Need(
        "huge",
        "huge volumes, little memory",
        "Level 1 or above; the least memory beside the peer first, on top of the samples "
        "themselves. None was tried on a volume larger than memory.",
        lambda one: one.level >= CLOSED and _memory(one) < inf,
        lambda one: (_memory(one), one.rank),
        _small_because,
    ),
    Need(
        "sharp",
        "sharp features",
        "Level 0 or above, with vertices in cells or on a lattice of its own: only these can place "
        "one on a crease, where a vertex on an edge of the lattice cuts it off. How well they do "
        "it is not measured.",
        lambda one: one.level >= RUNS and "vertices" in one.family and "edges" not in one.family,
        _in_order,
        _in_cells_because,
    ),
    Need(
        "labels",
        "a surface round a label",
        "Takes inside and outside alone (interpolant labels), level 1 or above.",
        lambda one: one.family.startswith("labels") and one.level >= CLOSED,
        _in_order,
        _closed_because,
    ),
    Need(
        "licence",
        "a permissive licence, whatever the language",
        "A permissive licence (neither copyleft nor non-commercial), level 1 or above.",
        lambda one: one.level >= CLOSED and one.about.use == "permissive",
        _in_order,
        lambda one: f"{one.about.licence}, {one.about.language}; {_closed_because(one)}",
    ),
)
"""Questions that the results answer; of sharp features they say what they can."""


@dataclass(frozen=True)
class Absent:
    """An implementation that could not be graded, and why."""

    name: str
    why: str
    about: About


@dataclass(frozen=True)
class Page:
    """What the template shows of one group of kinds.

    answers : to each need, the rows that fit it, the best first
    """

    kinds: str
    rows: tuple[Row, ...]
    answers: tuple[tuple[Need, tuple[Row, ...]], ...] = fresh(default=())

    @property
    def measured(self) -> tuple[Row, ...]:
        """The rows of which the cost was measured, the fastest first."""
        return tuple(sorted((one for one in self.rows if one.cost), key=_ratio))

    @property
    def points(self) -> list[Point]:
        """A point for each of these: its time, its height, and where its costs are."""
        return [
            Point(one.name, f"#cost-{one.id}", _ratio(one), one.height, one.ours)
            for one in self.measured
        ]

    @property
    def drawn(self) -> str:
        """Correctness against speed."""
        peers = [one.cost.peer for one in self.measured if one.cost]
        return scatter(self.points, peers[0]) if len(peers) > 1 else ""

    @property
    def numbered(self) -> list[Row]:
        """The rows that have numbers in the picture, in the order of these."""
        best = {one.name for one in self.front}
        return [one for one in self.measured if one.name not in best]

    @property
    def front(self) -> list[Row]:
        """The rows that no other beats both in height and in time."""
        best = {point.name for point in front(self.points)}
        return [one for one in self.measured if one.name in best]


def pages(
    reports: Sequence[Report],
    links: Mapping[str, str],
    about: Mapping[str, About],
    costs: Mapping[str, Measured] | None = None,
) -> list[Page]:
    """The groups of those that take the same kinds, the largest first."""
    found = []
    costs = costs or {}
    for kinds, group in by_kinds(reports).items():
        ranked = [
            row(
                one,
                place,
                links.get(one.name, ""),
                about.get(one.name, NOBODY),
                costs.get(one.name),
            )
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
    costs: Mapping[str, Measured] | None = None,
    versions: Sequence[tuple[Report, str]] = (),
    notes: Sequence[str] = (),
) -> str:
    """The page as one HTML file.

    links, about, costs : by the implementation's name
    absent : by name, why an implementation could not be graded
    versions : reports of several versions of the same implementations, each with its page
    notes : sentences on what makes the reports hard to compare
    """
    about = about or {}
    grouped = pages(reports, links, about, costs)
    left = [Absent(name, why, about.get(name, NOBODY)) for name, why in (absent or {}).items()]
    told: list[Trend] = trends(versions)
    plan = max((one.plan for one in reports), default=0)
    return (
        environment()
        .get_template("choosing.html")
        .render(pages=grouped, absent=left, count=len(reports), trends=told, notes=notes, plan=plan)
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
