"""The page on which people choose: rows, needs with reasons, and no name that breaks it."""

from typing import Any

import pytest
from isograde.report.choosing import NEEDS, About, answers, choosing_page, pages, twelve_lines
from isograde.report.reading import Report

from tests.isograde.reporting import body, made, row

TIED = row("ties/a", False, topology__ties="pass")
TORN = row("ties/a", False, topology__ties="fail", topology__closed="fail")
FREE = About("mine", "Python", "C++", "MIT", "permissive", "https://example.org", "mine.surface()")


def named(name: str, *rows: Any, spec: str = "python:mine:extract", **says: Any) -> Report:
    """A report of this name."""
    report = made([body(), row("noise/a"), *rows], **says)
    report.header["declaration"]["name"] = name
    report.header["spec"] = spec
    return report


SOUND = named("sound", TIED)
LEAKY = named("leaky", TORN)
OPEN = named("open", row("noise/b", topology__closed="fail"))
OURS = named("ours", TIED, spec="isoref:asymptotic-decider")


def test_libraries_come_first_and_what_is_ours_apart() -> None:
    """Issue 16: libraries first, ours apart."""
    (page,) = pages([OURS, OPEN, SOUND], {}, {})
    assert [one.name for one in page.rows] == ["sound", "open", "ours"]
    assert [one.ours for one in page.rows] == [False, False, True]


def test_a_need_is_answered_by_its_rule_and_says_why() -> None:
    """Issue 16: computed from the results, with the reasons."""
    about = dict.fromkeys(("sound", "leaky", "open"), FREE)
    (page,) = pages([OPEN, LEAKY, SOUND], {}, about)
    found = {need.name: [one.name for one in rows] for need, rows in page.answers}
    assert found["closed-python"] == ["sound", "leaky"]
    assert found["watertight"] == ["sound"]
    assert found["manifold"] == ["sound"]
    said = {need.name: [need.reason(one) for one in rows] for need, rows in page.answers}
    assert said["watertight"] == ["level 4 of 4, with ties too"]
    assert said["closed-python"][1] == "level 4 of 4; torn in 1 of 1 fields with ties"


@pytest.mark.parametrize("use", ["copyleft", "non-commercial"])
def test_a_licence_that_is_not_permissive_is_no_answer_where_one_is_asked_for(use: str) -> None:
    """Whoever asks for a permissive licence gets no other."""
    need = next(need for need in NEEDS if need.name == "closed-python")
    strict = {"sound": About("mine", "Python", "C++", "GPL-3.0", use)}
    (page,) = pages([SOUND], {}, strict)
    assert answers(need, page.rows) == ()
    (page,) = pages([SOUND], {}, {"sound": FREE})
    assert len(answers(need, page.rows)) == 1


def test_what_could_not_be_graded_keeps_its_row() -> None:
    """Issue 16: failures greyed and not omitted."""
    shown = choosing_page([SOUND], {}, {}, {"sdfx": "the registry refuses it"})
    assert "sdfx" in shown
    assert "the registry refuses it" in shown


def test_names_and_reasons_are_shown_as_text() -> None:
    """Nothing an implementation says is markup here."""
    evil = named("<script>alert(1)</script>", TIED)
    shown = choosing_page([evil], {}, {}, {"<b>x</b>": "<img src=x>"})
    assert "<script>alert" not in shown
    assert "<img" not in shown
    assert "&lt;script&gt;alert(1)" in shown


def test_the_table_for_the_readme_has_its_lines_and_leaves_out_what_is_ours() -> None:
    """Issue 16: a Markdown of twelve lines: ten rows, and two of heading."""
    text = twelve_lines([SOUND, OURS, *(named(f"n{i}", TIED) for i in range(20))], {"sound": FREE})
    lines = text.splitlines()
    assert len(lines) == 12
    assert not any("ours" in line for line in lines)
    assert "| sound 1.2 | Python | 4 of 4 trilinear, with ties too |  | MIT |" in lines
