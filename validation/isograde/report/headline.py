"""One line on an implementation, computed from the results, and the two orders of a comparison.

The line says, where there is something to say:

* name and version, and the level reached of those its family can reach;
* how many fields in general position are short of the next one, and what is wrong with most;
* what became of fields with ties;
* how many cells of real scans have the wrong topology, in a million;
* how many of the cases could be judged, where not all could.

Libraries are ordered by level, then by the share of fields that are short of the next rung (a field
that could not be judged is short), then torn with ties, wrong cells and waste; the second order
puts topology first. What was not measured comes after everything that was.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from math import inf

from isograde.causes import roots
from isograde.model import LEVELS, Kind, Verdict
from isograde.report.reading import Report, Rung, Summary, bad_in, bad_of, results_tagged

TIES = "topology.ties"
ANSWERS = "structure.answers"
TRILINEAR = "topology.trilinear"
# Vertices that nothing uses, and simplices without a measure.
WASTE = ("structure.all_used", "structure.with_measure")

# What a failure of a claim is, said of one field; {facet}, {simplices} and {facets} are the kind's.
FAULTS = {
    "structure.answers": "no answer",
    "structure.shapes": "arrays of the wrong shape",
    "structure.finite": "a vertex that is not finite",
    "structure.in_range": "an index out of range",
    "structure.no_repeated_index": "a vertex named twice",
    "topology.closed": "a hole",
    "topology.oriented": "neighbours that turn opposite ways",
    "topology.sides": "samples on the wrong side",
    "topology.manifold": "{a_facet} of more than two {simplices}",
    "topology.bilinear": "a face that the bilinear interpolant decides otherwise",
    "topology.trilinear": "a cell that the trilinear interpolant fills otherwise",
    "geometry.vertices": "a vertex where none may be",
    "geometry.crossing": "a vertex away from the crossing of its edge",
    "geometry.embedded": "{simplices} that cross",
    "cells.legal": "a cell with an illegal piece",
    "cells.count": "a cell with too many or too few pieces",
    "robustness.deterministic": "another answer when asked twice",
    "robustness.input_unmodified": "samples changed",
    "symmetry.type": "another answer in another number type",
    "symmetry.layout": "another answer in another memory layout",
    "symmetry.spacing": "another answer at another spacing",
    "symmetry.directions": "another answer where the axes are turned in the world",
    "symmetry.translation": "another answer after a translation",
    "symmetry.scaling": "another answer to scaled values",
    "symmetry.shift": "another answer to shifted values",
    "symmetry.orientation": "another answer after a turn or mirroring",
}
FAMILY_FAULTS = {"bodies": "a known body that comes out wrong", "symmetry": "another answer"}
VERDICT_FAULTS = {
    Verdict.ERROR.value: "an error",
    Verdict.CRASH.value: "a crash",
    Verdict.TIMEOUT.value: "no answer in time",
}
# Nouns for simplices and their facets, by the dimension of the simplices.
NOUNS = {
    0: ("points", "a point"),
    1: ("segments", "an end"),
    2: ("triangles", "an edge"),
}
# What is said of an implementation of which a claim of choice holds on every case.
CHOSEN = {
    "cells.separate": "separates the inside corners of every ambiguous face, by choice",
    "cells.join": "joins the inside corners of every ambiguous face, by choice",
    "cells.mean": "decides every ambiguous face by the mean of its samples, by choice",
}
BILINEAR = "topology.bilinear"


def headline(report: Report) -> str:
    """The line: name, level, what is short of the next, ties, scans, what was not judged."""
    return f"{titled(report)} - {standing(report)}"


def titled(report: Report) -> str:
    """Name and version, on one line."""
    return " ".join(f"{report.name} {report.declaration['version']}".split())


def standing(report: Report) -> str:
    """The headline without the name."""
    said = (level, short, with_ties, scans, unjudged)
    return " - ".join(part for tell in said if (part := tell(report)))


def level(report: Report) -> str:
    """The level reached, of how many, and the family where it is not the usual one."""
    if report.partial:
        return "part of the cases"
    family = family_of(report)
    of = f"of {report.top}{f' ({family})' if family else ''}"
    if report.reached is None:
        return f"no level {of}"
    return f"{LEVELS[report.reached][0]}, {report.reached} {of}"


def family_of(report: Report) -> str:
    """Interpolant and placing of vertices; nothing for multilinear with vertices on edges."""
    declared = report.declaration
    interpolant, vertices = declared["interpolant"], declared["vertices"]
    said = [] if interpolant == "multilinear" else [_interpolant(interpolant)]
    if isinstance(vertices, dict):
        said.append("vertices on a lattice of its own")
    elif vertices != "edges":
        said.append(f"vertices in {vertices}")
    return ", ".join(said)


def _interpolant(word: object) -> str:
    """The word of an interpolant."""
    return "tetrahedra" if isinstance(word, dict) else str(word)


# The level at which an extractor that decides ambiguous faces in its own way stops, by choice.
LEVEL_OF_CHOICE = 3


def short(report: Report) -> str:
    """How many fields in general position are short of the next rung, and by which fault.

    Where faces are always decided in one way, the choice is said instead: no count of what it
    brings reads like a fault.
    """
    rung = report.next_rung
    if rung is None:
        return ""
    if rung.level == LEVEL_OF_CHOICE and (by := chosen(report)):
        return by[0]
    if rung.state == "fail":
        failed, _, fields = report.short_of(rung.level)
        noun = "field" if fields == 1 else "fields"
        called = rung.name if rung.level else "level 0"
        return f"{failed:,} of {fields:,} {noun} short of {called} ({fault(report, rung)})"
    return f"{rung.name} not reached: {missing(rung)}"


def missing(rung: Rung) -> str:
    """What a rung that does not fail lacks."""
    if rung.bodiless:
        return f"no known body of {', '.join(map(str, rung.bodiless))} was judged right"
    if rung.lacking:
        return f"no evidence of {listed([summary.id for summary in rung.lacking])}"
    if rung.withdrawn:
        return f"not promised: {listed([summary.id for summary in rung.withdrawn])}"
    return "no claim was judged"


def listed(names: Sequence[str], most: int = 2) -> str:
    """A few names, and how many more there are.

    >>> listed(["a", "b"]), listed(["a", "b", "c", "d"])
    ('a, b', 'a, b and 2 more')
    """
    more = len(names) - most
    return ", ".join(names[:most]) + (f" and {more} more" if more > 0 else "")


def anded(names: Sequence[object]) -> str:
    """Names with "and" between the last two.

    >>> anded([[0, 0], [1, 0]]), anded(["a", "b", "c"])
    ('[0, 0] and [1, 0]', 'a, b and c')
    """
    words = [str(name) for name in names]
    return " and ".join(filter(None, [", ".join(words[:-1]), words[-1]]))


def fault(report: Report, rung: Rung) -> str:
    """The fault of most fields that fail the rung in general position, in words."""
    names = {summary.id for summary in rung.summaries}
    found: Counter[str] = Counter()
    for result in report.results:
        if not result["general"]:
            continue
        kind = Kind(*report.cases[result["case"]]["kind"])
        bad = {name: finding for name, _, finding in bad_of(result) if name in names}
        # Of one cause, say the root.
        of = roots({name: finding.get("numbers", {}) for name, finding in bad.items()})
        found.update(sorted({_fault(name, kind, bad[name]) for name in of.values()}))
    return found.most_common(1)[0][0]


def _fault(claim: str, kind: Kind, finding: dict[str, object]) -> str:
    """What is wrong, in words."""
    verdict = str(finding.get("verdict", ""))
    if verdict in VERDICT_FAULTS:
        return VERDICT_FAULTS[verdict]
    numbers = finding.get("numbers", {})
    if claim == "topology.manifold" and isinstance(numbers, dict) and "vertices" in numbers:
        return "a vertex where sheets meet"
    if claim == "topology.closed" and isinstance(numbers, dict) and numbers.get("beyond"):
        return "a surface that goes on beyond its domain"
    simplices, a_facet = NOUNS.get(kind.k, ("simplices", "a facet"))
    text = FAULTS.get(claim, FAMILY_FAULTS.get(claim.split(".")[0], claim))
    return text.format(simplices=simplices, a_facet=a_facet)


def with_ties(report: Report) -> str:
    """What became of fields with ties: the level holds, or how many are torn."""
    if report.with_ties:
        return "with ties too"
    torn = ties_torn(report)
    return f"with ties torn in {torn[0]:,} of {torn[1]:,}" if torn is not None and torn[0] else ""


def ties_torn(report: Report) -> tuple[int, int] | None:
    """Fields with ties that are torn, of how many; None where there is no evidence."""
    summary = report.summaries.get(TIES)
    return (summary.bad, summary.evidence) if summary is not None and summary.evidence else None


def ties_unanswered(report: Report) -> int:
    """Fields with ties on which no mesh came: an error, say, in place of one."""
    summary = report.summaries.get(ANSWERS)
    return 0 if summary is None else bad_in(summary.tied)


def scans(report: Report) -> str:
    """How many cells of real scans are wrong, in a million."""
    share = wrong_cells(report)
    return "" if share is None else f"{share:,.0f} wrong cells in a million on scans"


def wrong_cells(report: Report) -> float | None:
    """Cells of real scans with the wrong topology, in a million; None where none was judged."""
    counted = [
        numbers
        for result in results_tagged(report, "real")
        if (numbers := result["measured"].get(TRILINEAR)) and "cells" in numbers
    ]
    cells = sum(numbers["cells"] for numbers in counted)
    return 1e6 * sum(numbers.get("wrong", 0) for numbers in counted) / cells if cells else None


def unjudged(report: Report) -> str:
    """How many cases were judged, where some could not be."""
    judged, asked = report.judged
    return f"{judged:,} of {asked:,} judged" if judged < asked else ""


def waste(report: Report) -> float:
    """The share of fields with unused vertices or simplices without a measure."""
    found = [one for name in WASTE if (one := report.summaries.get(name)) and one.evidence]
    return sum(one.bad for one in found) / sum(one.evidence for one in found) if found else inf


def by_level(report: Report) -> tuple[float, ...]:
    """A key that sorts by level, then short of the next, torn, wrong cells, waste; best first."""
    rung = report.next_rung
    height = report.top if rung is None else rung.level - 1
    share = 0.0 if rung is None else report.short_of(rung.level).share
    return (-height, share, _torn_share(report), *_topology(report), waste(report))


def by_topology(report: Report) -> tuple[float, ...]:
    """A key that sorts by wrong cells first, then torn, then as `by_level`; best first."""
    return (*_topology(report), _torn_share(report), *by_level(report))


def _torn_share(report: Report) -> float:
    """The share of fields with ties that are torn."""
    torn = ties_torn(report)
    return inf if torn is None else torn[0] / torn[1]


def _topology(report: Report) -> tuple[float, float]:
    """Wrong cells in a million on scans, and the share of other fields with a wrong cell."""
    share = wrong_cells(report)
    summary = report.summaries.get(TRILINEAR)
    fields = summary.bad / summary.evidence if summary is not None and summary.evidence else inf
    return (inf if share is None else share, fields)


def choices(report: Report) -> list[str]:
    """How ambiguous faces are decided, where it is always in one way."""
    said = chosen(report)
    if not said and not report.partial and _always(report.summaries.get(BILINEAR)):
        said = ["decides every ambiguous face as the bilinear interpolant does"]
    return said


def chosen(report: Report) -> list[str]:
    """The choices that are made on every case, whatever the samples are.

    A run of a part of the cases has not seen enough of them to speak of a choice.
    """
    if report.partial:
        return []
    return [told for name, told in CHOSEN.items() if _always(report.summaries.get(name))]


def _always(summary: Summary | None) -> bool:
    """The claim holds wherever it could fail."""
    return summary is not None and summary.state == "pass"


def not_promised(summary: Summary) -> str:
    """How often a claim that is not promised holds."""
    return f"not promised: {summary.passed:,} of {summary.evidence:,} cases hold"
