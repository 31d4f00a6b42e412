"""Levels, exit status and headline, each computed from made-up results.

The rules are those of the design: no pass without evidence, general position and ties apart, and a
level is a guarantee, so one counterexample ends one.
"""

import itertools
from typing import Any

import pytest
from isograde.commands.console import Exit, status_of
from isograde.model import CONTOURS, CURVES, SURFACES, Kind
from isograde.report.headline import by_level, by_topology, choices, headline, wrong_cells
from isograde.report.reading import CONVENTIONS, Report
from isograde.report.words import evidence, verdict

from tests.isograde.reporting import CLAIMS, body, claim, made, row

TIED = row("ties/a", False, topology__ties="pass")


def sound(**declared: Any) -> Report:
    """The report of an implementation that holds everything, with ties too."""
    return made([body(), row("noise/a"), TIED], **declared)


def test_every_claim_passed_reaches_the_top_with_ties_too() -> None:
    report = sound()
    assert (report.reached, report.top, report.with_ties) == (4, 4, True)
    assert status_of(report) is Exit.HOLDS
    assert report.footer is not None
    assert report.footer["reached"] == 4


@pytest.mark.parametrize("verdict", ["fail", "error", "crash", "timeout"])
@pytest.mark.parametrize(
    ("name", "reached"),
    [
        ("structure__answers", None),
        ("bodies__pieces", None),
        ("topology__closed", 0),
        ("topology__manifold", 1),
        ("topology__bilinear", 2),
        ("topology__trilinear", 3),
        ("structure__all_used", 4),
    ],
)
def test_one_counterexample_in_general_position_ends_a_level(
    name: str, reached: int | None, verdict: str
) -> None:
    """Design: levels are guarantees, so one counterexample ends one."""
    said: dict[str, Any] = {name: verdict}
    report = made([body(), row("noise/a"), row("noise/b", **said)])
    assert report.reached == reached


@pytest.mark.parametrize("name", ["topology__closed", "topology__manifold", "structure__answers"])
def test_a_failure_with_ties_keeps_the_level_and_costs_the_status(name: str) -> None:
    """Design: a level is reached in general position, and "with ties too" is said beside it."""
    said: dict[str, Any] = {name: "fail"}
    report = made([body(), row("noise/a"), row("ties/a", False, **said)])
    assert report.reached == 4
    assert report.with_ties is False
    assert status_of(report) is Exit.FAILS


def test_without_a_field_with_ties_nothing_is_said_of_ties() -> None:
    report = made([body(), row("noise/a")])
    assert (report.reached, report.with_ties) == (4, None)


@pytest.mark.parametrize("nothing", ["skip", "unsupported", "not run"])
@pytest.mark.parametrize(
    ("name", "reached"),
    [("structure.answers", None), ("topology.sides", 0), ("symmetry.type", 1)],
)
def test_a_claim_without_one_pass_ends_the_level_below(
    name: str, reached: int | None, nothing: str
) -> None:
    """Design: no pass without evidence."""
    special: dict[str, Any] = {name.replace(".", "__"): nothing}
    report = made([body(**special), row("noise/a", **special)])
    assert report.reached == reached
    assert status_of(report) is Exit.HOLDS
    assert status_of(report, strict=True) is Exit.FAILS
    assert f"no evidence of {name}" in headline(report)


def test_a_claim_that_no_case_asked_is_no_evidence_either() -> None:
    report = made([body(), row("noise/a")], {**CLAIMS, "new.claim": claim("new.claim", 1)})
    assert report.reached == 0


@pytest.mark.parametrize(
    ("glob", "reached"),
    [("topology.manifold", 1), ("topology.*", 0), ("structure.answers", None), ("cells.*", 4)],
)
def test_a_level_with_a_claim_that_is_not_promised_is_not_reached(
    glob: str, reached: int | None
) -> None:
    """Design: not promised is judged and shown, and the level it belongs to is not reached."""
    report = sound(not_promised=[glob])
    assert report.reached == reached
    assert status_of(report) is Exit.HOLDS
    if reached != 4:
        assert "not promised: " in headline(report)


def test_what_is_not_promised_may_fail_without_cost_to_the_status() -> None:
    rows = [body(), row("noise/a", symmetry__type="fail")]
    assert status_of(made(rows)) is Exit.FAILS
    assert status_of(made(rows, not_promised=["symmetry.type"])) is Exit.HOLDS
    assert status_of(made(rows, level=1)) is Exit.HOLDS


def test_known_bodies_cannot_be_taken_out_of_the_promise() -> None:
    report = made([body(bodies__pieces="fail"), row("noise/a")], not_promised=["*"])
    assert status_of(report) is Exit.FAILS
    assert report.reached is None


def test_a_declared_kind_of_which_no_body_came_out_reaches_no_level() -> None:
    """Whoever declares contours besides, and declines them all, has not shown any."""
    kinds: dict[str, Any] = {"limits": {"kinds": [[3, 1], [2, 1]]}}
    planar = row("contours/a", kind=CONTOURS, every="unsupported", bodies__pieces="unsupported")
    report = made([body(), row("noise/a"), planar], **kinds)
    assert report.reached is None
    assert "no known body of contours" in headline(report)
    shown = row("bodies/disc", kind=CONTOURS, bodies__pieces="pass")
    assert made([body(), row("noise/a"), shown], **kinds).reached == 4


def test_a_declared_kind_that_is_declined_but_for_its_bodies_reaches_no_level() -> None:
    """Whoever answers the bodies of a kind alone has shown nothing else of it."""
    kinds: dict[str, Any] = {"limits": {"kinds": [[3, 1], [2, 1]]}}
    disc = row("bodies/disc", kind=CONTOURS, every="skip", bodies__pieces="pass")
    declined = row("contours/a", kind=CONTOURS, every="unsupported")
    assert made([body(), row("noise/a"), disc, declined], **kinds).reached is None
    absent = row("contours/a", kind=CONTOURS, every="skip")
    assert made([body(), row("noise/a"), disc, absent], **kinds).reached == 4


def test_of_a_kind_without_known_bodies_the_page_says_so() -> None:
    """(5, 1) has no known body here: the level stands, and what it does not rest on is said."""
    kinds: dict[str, Any] = {"limits": {"kinds": [[3, 1], [5, 1]]}}
    report = made([body(), row("noise/a")], **kinds)
    assert report.reached == 4
    assert "No known body is kept of (5, 1)" in verdict(report)
    assert "No known body" not in verdict(made([body(), row("noise/a")]))


def test_who_declares_only_kinds_without_known_bodies_reaches_no_level() -> None:
    """The cheat that goes with it: a kind of which nothing can be shown."""
    alone: dict[str, Any] = {"limits": {"kinds": [[5, 1]]}}
    report = made([row("simplices/a", kind=Kind(5, 1))], **alone)
    assert report.reached is None
    assert status_of(report) is Exit.NO_EVIDENCE


def test_a_run_of_a_part_reaches_no_level_and_needs_no_body() -> None:
    report = made([row("noise/a")], only=("noise/*",))
    assert report.reached is None
    assert "part of the cases" in headline(report)
    assert status_of(report) is Exit.HOLDS
    assert status_of(made([row("noise/a")])) is Exit.NO_EVIDENCE


@pytest.mark.parametrize("name", sorted(CONVENTIONS))
@pytest.mark.parametrize("verdict", ["fail", "error", "crash", "timeout", "unsupported"])
def test_bad_input_never_changes_the_status(name: str, verdict: str) -> None:
    """Design: input checks are a convention, measured and shown."""
    special: dict[str, Any] = {name.replace(".", "__"): verdict}
    assert status_of(made([body(**special), row("noise/a", **special)])) is Exit.HOLDS
    special[name.replace(".", "__")] = "pass"
    declined = made([row("noise/a", every="unsupported", **special)])
    assert status_of(declined) is Exit.NO_EVIDENCE


# What becomes of extractors that make nothing of what they are asked.
IDLE = {
    "nothing": [
        body(
            every="skip", structure__answers="pass", bodies__pieces="fail", topology__sides="fail"
        ),
        row("noise/a", every="skip", structure__answers="pass", topology__sides="fail"),
    ],
    "declines everything": [body(every="unsupported"), row("noise/a", every="unsupported")],
    "one triangle": [body(bodies__pieces="fail"), row("noise/a", topology__closed="fail")],
    "the same mesh": [body(bodies__pieces="fail"), row("noise/a", topology__sides="fail")],
    "raises": [
        body(every="not run", structure__answers="error", bodies__pieces="not run"),
        row("noise/a", every="not run", structure__answers="error"),
    ],
}


@pytest.mark.parametrize("idle", IDLE)
def test_who_makes_nothing_of_what_is_asked_reaches_nothing_whatever_is_declared(idle: str) -> None:
    """Issue 11: each reaches no level and ends with a status that is not 0."""
    interpolants = ["multilinear", "kuhn", "labels"]
    vertices = ["edges", "cells", {"own": 2.0}]
    meshes, domains = ["indexed", {"soup": 1e-6}], ["open", "closed", "periodic"]
    promises: list[list[str]] = [[], ["*"], ["bodies.*"], ["structure.*", "topology.*"]]
    tried = list(itertools.product(interpolants, vertices, meshes, domains, promises, (0, 2)))
    assert len(tried) == 432
    for interpolant, places, mesh, domain, promised, level in tried:
        words: dict[str, Any] = {
            "interpolant": interpolant,
            "vertices": places,
            "mesh": mesh,
            "domain": domain,
        }
        report = made(IDLE[idle], **words, not_promised=promised, level=level)
        assert report.reached is None
        assert status_of(report) in (Exit.FAILS, Exit.NO_EVIDENCE)
        assert "no level of" in headline(report)


def test_the_top_is_that_of_the_family_and_of_its_kinds() -> None:
    two = {name: one for name, one in CLAIMS.items() if (one.level or 0) <= 2}
    rows = [body(), row("noise/a", without=(*set(CLAIMS) - set(two), "topology.ties"))]
    rows[0] = body()
    labels = made([rows[1], _only(body(), two)], two, interpolant="labels", level=2)
    assert (labels.reached, labels.top) == (2, 2)
    assert "consistent, 2 of 2 (labels)" in headline(labels)
    curves = made([_only(body(kind=CURVES), two)], two, limits={"kinds": [[3, 2]]})
    assert (curves.reached, curves.top) == (2, 2)


def _only(pair: Any, claims: Any) -> Any:
    """The row with the findings of these claims alone."""
    asked, judged = pair
    kept = {name: one for name, one in judged.findings.items() if name in claims}
    return asked, type(judged)(judged.case, judged.kind, kept, judged.general)


def test_cases_that_could_not_be_judged_stand_beside_the_level() -> None:
    """A skipped case is no evidence and no failure; a declined one is not judged."""
    rows = [
        body(),
        row("noise/a"),
        row("noise/b", every="skip"),
        row("noise/c", every="unsupported"),
    ]
    report = made(rows)
    assert report.judged == (2, 3)
    assert headline(report).endswith("2 of 3 judged")
    assert report.short_of(1) == (0, 1, 3)


def test_the_headline_is_one_line_of_counts() -> None:
    """Design: the form of the headline."""
    cells = {"cells": 1_000_000, "wrong": 1419}
    rows = [
        body(),
        *(row(f"noise/{i}") for i in range(5)),
        row("noise/x", topology__manifold=("fail", {"facets": 2})),
        row("noise/y", topology__manifold=("fail", {"facets": 2}), symmetry__type="fail"),
        row("ties/a", False, topology__ties="fail", topology__closed="fail"),
        row("ties/b", False, topology__ties="pass"),
        row("real/a", tags=["real"], topology__trilinear=("fail", cells)),
    ]
    assert headline(made(rows)) == (
        "mine 1.2 - closed, 1 of 4 - 2 of 9 fields short of consistent "
        "(an edge of more than two triangles) - with ties torn in 1 of 2 - "
        "1,419 wrong cells in a million on scans"
    )


def test_the_headline_leaves_out_what_there_is_not() -> None:
    assert headline(sound()) == "mine 1.2 - trilinear, 4 of 4 - with ties too"
    assert headline(made([body(), row("a")], version="")) == "mine - trilinear, 4 of 4"


def test_a_name_of_several_lines_makes_no_headline_of_several() -> None:
    assert "\n" not in headline(sound(name="a\nb", version="1\r\n2"))


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ({"topology__manifold": ("fail", {"vertices": 1})}, "a vertex where sheets meet"),
        ({"topology__manifold": "crash"}, "a crash"),
        ({"symmetry__type": "timeout"}, "no answer in time"),
        ({"symmetry__type": "fail"}, "another answer in another number type"),
    ],
)
def test_the_fault_of_most_fields_is_said_in_words(said: dict[str, Any], words: str) -> None:
    assert f"short of consistent ({words})" in headline(made([body(), row("a", **said)]))


def test_the_fault_of_a_contour_is_not_said_of_triangles() -> None:
    planar = row("a", kind=CONTOURS, topology__manifold=("fail", {"facets": 1}))
    disc = body(kind=CONTOURS)
    said = headline(made([disc, planar], limits={"kinds": [[2, 1]]}))
    assert "(an end of more than two segments)" in said


def test_wrong_cells_are_counted_on_scans_of_passes_too() -> None:
    rows = [
        body(),
        row("real/a", tags=["real"], topology__trilinear=("pass", {"cells": 300})),
        row("real/b", tags=["real"], topology__trilinear=("fail", {"cells": 100, "wrong": 2})),
        row("noise/a", topology__trilinear=("fail", {"cells": 10, "wrong": 9})),
    ]
    assert wrong_cells(made(rows)) == pytest.approx(5000)
    assert wrong_cells(made([body(), row("noise/a")])) is None


def _library(name: str, **said: Any) -> Report:
    """A library that holds everything but what is said, on some fields."""
    return made([body(), row("a", **said), row("b"), TIED], name=name)


def test_torn_comes_after_wrong_topology_and_that_after_wasteful() -> None:
    """Issue 12: torn comes before wrong topology before wasteful, the worst first."""
    torn = _library("torn", topology__closed="fail")
    wrong = _library("wrong", topology__trilinear="fail")
    wasteful = _library("wasteful", structure__all_used="fail")
    assert [one.name for one in sorted([torn, wrong, wasteful, sound()], key=by_level)] == [
        "mine", "wasteful", "wrong", "torn",
    ]  # fmt: skip


def test_within_a_level_the_share_of_fields_short_of_the_next_decides() -> None:
    """Unjudged counts as failing: declining the hard fields gains nothing."""
    often = made([body(), row("a", topology__manifold="fail"), row("b", topology__manifold="fail")])
    seldom = made([body(), row("a", topology__manifold="fail"), row("b")])
    declines = made([body(), row("a", topology__manifold="fail"), row("b", every="unsupported")])
    assert by_level(seldom) < by_level(often)
    assert by_level(seldom) < by_level(declines)
    assert by_level(declines)[:2] == by_level(often)[:2]


def test_the_second_order_puts_topology_first() -> None:
    """An exact extractor with crowded edges is below a plain one by level, above by topology."""
    exact = made([body(), row("a", topology__manifold="fail"), TIED], name="exact")
    plain = made([body(), row("a", topology__trilinear="fail"), TIED], name="plain")
    assert by_level(plain) < by_level(exact)
    assert by_topology(exact) < by_topology(plain)


@pytest.mark.parametrize(
    ("verdict", "words"),
    [
        ("pass", ["separates the inside corners of every ambiguous face, by choice"]),
        ("fail", ["decides every ambiguous face as the bilinear interpolant does"]),
    ],
)
def test_a_choice_is_said_in_words(verdict: str, words: list[str]) -> None:
    report = made([body(), row("a", cells__separate=verdict), row("b", cells__separate=verdict)])
    found = choices(report)
    if verdict == "fail":
        body_too = made([body(cells__separate="fail"), row("a", cells__separate="fail")])
        found = choices(body_too)
    assert found == words


def test_a_choice_made_sometimes_is_none() -> None:
    rows = [body(), row("a", cells__separate="fail", topology__bilinear="fail"), row("b")]
    assert choices(made(rows)) == []


def test_surfaces_are_the_usual_kind() -> None:
    assert sound().kinds == [SURFACES]


def test_runs_of_a_part_are_ordered_by_the_first_rung_that_fails() -> None:
    """They reach no level, but what tears is still told, and comes last."""
    torn = made([row("a", topology__closed="fail"), row("b")], only=("a", "b"), name="torn")
    whole = made([row("a"), row("b")], only=("a", "b"), name="whole")
    assert by_level(whole) < by_level(torn)
    assert headline(torn) == "torn 1.2 - part of the cases - 1 of 2 fields short of closed (a hole)"
    assert headline(whole) == "whole 1.2 - part of the cases"


def test_a_choice_that_is_not_promised_is_no_failure() -> None:
    """Issue 12: never a bare count that reads like a bug."""
    rows = [body(), row("a", cells__separate="fail"), row("b")]
    free = made(rows)
    assert [summary.id for summary in free.failures] == []
    assert evidence(free.summaries["cells.separate"]) == "a choice, made on 2 of 3 cases"
    bound = made(rows, promised=["cells.separate"])
    assert [summary.id for summary in bound.failures] == ["cells.separate"]
    assert status_of(bound) is Exit.FAILS
