"""One cause, one finding: how the failures of a report are grouped and ordered."""

from typing import Any

import pytest
from isograde.report.comparison import comparison_page, mark, markdown_table, ranked
from isograde.report.findings import causes, rights
from isograde.report.headline import headline
from isograde.report.junit import junit
from isograde.report.markdown import markdown
from isograde.report.page import page

from tests.isograde.reporting import body, made, row

CHOOSES: dict[str, Any] = {"topology__bilinear": "fail", "cells__separate": "pass"}


def test_what_follows_is_told_under_its_root_and_nowhere_else() -> None:
    """Issue 12: `topology.closed` and `topology.ties` told one failure twice."""
    tied = row("ties/a", False, topology__closed="fail", topology__ties="fail")
    (one,) = causes(made([body(), row("a"), tied]))
    assert one.root.id == "topology.closed"
    assert [(f.summary.id, f.cases, f.wholly) for f in one.follows] == [("topology.ties", 1, True)]
    assert (one.general, one.tied) == (0, 1)


def test_a_claim_with_a_cause_of_its_own_has_a_finding_of_its_own() -> None:
    """Where it fails for another cause besides, both findings say so."""
    rows = [
        body(),
        row("a", topology__closed="fail", topology__manifold="fail"),
        row("b", topology__manifold="fail"),
        row("c"),
    ]
    closed, manifold = causes(made(rows))
    assert (closed.root.id, manifold.root.id) == ("topology.closed", "topology.manifold")
    assert [(f.summary.id, f.cases, f.wholly) for f in closed.follows] == [
        ("topology.manifold", 1, False)
    ]
    assert [(f.summary.id, f.cases) for f in manifold.elsewhere] == [("topology.closed", 1)]
    assert manifold.cases == 1


def test_torn_comes_before_wrong_topology_before_wasteful_and_choices_last() -> None:
    """Issue 12; what is promised comes first, and general position before ties."""
    rows = [
        body(),
        row("a", topology__trilinear="fail"),
        row("b", structure__all_used="fail"),
        row("c", topology__closed="fail"),
        row("d", False, topology__sides="fail"),
        row("e", symmetry__type="fail"),
    ]
    found = [one.root.id for one in causes(made(rows, promised=["topology.trilinear"]))]
    assert found == [
        "topology.closed", "symmetry.type", "topology.trilinear", "topology.sides",
        "structure.all_used",
    ]  # fmt: skip


def test_each_failed_claim_is_on_the_page_once_and_can_be_linked() -> None:
    rows = [body(), row("ties/a", False, topology__closed="fail", topology__ties="fail")]
    report = made(rows)
    text = page(report)
    for name in ("topology.closed", "topology.ties"):
        assert text.count(f'id="failure-{name}"') == 1
    assert "What follows from it" in text
    assert "What follows from it:\n\n- `topology.ties`" in markdown(report)
    assert "follows from topology.closed" in junit(report)


def test_a_choice_is_said_in_words_and_not_counted_like_a_fault() -> None:
    """Issue 12: never a bare count that reads like a bug."""
    report = made([body(**CHOOSES), row("a", **CHOOSES), row("b", **CHOOSES)], level=2)
    told = "separates the inside corners of every ambiguous face, by choice"
    assert headline(report) == f"mine 1.2 - consistent, 2 of 4 - {told}"
    (one,) = causes(report)
    assert one.choice
    assert not one.held
    assert one.said.startswith(told)
    assert mark(report, "topology.bilinear") == ("choice", "by choice")
    text = comparison_page([report], [""])
    assert 'title="mine, topology.bilinear: choice by choice"' in text
    assert "| `topology.bilinear` | 3 | ➖ by choice |" in markdown_table([report])


def test_a_promise_of_bilinear_faces_is_broken_by_a_choice_too() -> None:
    (one,) = causes(made([body(**CHOOSES), row("a", **CHOOSES)], promised=["*.bilinear"]))
    assert one.held
    assert not one.choice


def test_what_is_right_is_said_and_what_is_so_but_for_ties() -> None:
    report = made([body(), row("a"), row("t", False, topology__closed="fail")])
    assert rights(report)[:3] == [
        "the arrays are well formed", "known bodies come out", "but for ties, there is no hole",
    ]  # fmt: skip


@pytest.mark.parametrize("every", ["skip", "unsupported", "not run"])
def test_nothing_is_called_right_without_evidence(every: str) -> None:
    report = made([row("a", every=every, without=("topology.ties",))])
    assert rights(report) == []


def test_a_headline_that_several_share_is_said_once_with_their_places() -> None:
    """The comparison repeated one sentence for each."""
    alike = [made([body(), row("a")], name=name) for name in ("one", "two")]
    other = made([body(), row("a", topology__closed="fail")], name="three")
    found = ranked("level first", [*alike, other])
    assert [(place, [one.name for one in group]) for place, _, group in found] == [
        (1, ["one", "two"]), (3, ["three"]),
    ]  # fmt: skip
    text = markdown_table([*alike, other])
    assert "1. one 1.2 and two 1.2 - trilinear, 4 of 4" in text
    assert "3. three 1.2 - runs, 0 of 4" in text
    assert '<li value="3">' in comparison_page([*alike, other], ["", "", "c.html"])
