"""The page on which people choose: rows, needs with reasons, and no name that breaks it."""

import re
from pathlib import Path
from typing import Any

import isograde.report
import numpy as np
import pytest
from isograde.report.choosing import NEEDS, About, answers, choosing_page, pages, twelve_lines
from isograde.report.page import page as page_of
from isograde.report.reading import Report
from isograde.report.scatter import RADIUS, Places, Point, front, scatter
from isograde.report.speed import measured
from isograde.report.trend import trends
from isograde.report.viewer import beside, explorer

from tests.browser import found
from tests.isograde.reporting import body, made, row

TEMPLATES = Path(isograde.report.__file__).parent / "templates"
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
    fits = {need.name: [one.name for one in rows] for need, rows in page.answers}
    assert fits["closed-python"] == ["sound", "leaky"]
    assert fits["watertight"] == ["sound"]
    assert fits["manifold"] == ["sound"]
    said = {need.name: [need.reason(one) for one in rows] for need, rows in page.answers}
    assert said["watertight"] == ["level 4 of 4, with ties too"]
    torn = "level 4 of 4; torn in 1 of 1 fields with ties; speed not measured"
    assert said["closed-python"][1] == torn


def test_no_answer_to_a_field_with_ties_is_no_better_than_a_torn_one() -> None:
    """Whoever raises where samples equal the isovalue has torn nothing, and closes no CT either."""
    mute = named("mute", TIED, row("ties/b", False, structure__answers="error"))
    about = dict.fromkeys(("sound", "leaky", "mute"), FREE)
    (page,) = pages([LEAKY, mute, SOUND], {}, about)
    fits = {need.name: [one.name for one in rows] for need, rows in page.answers}
    assert fits["closed-python"] == ["sound", "mute", "leaky"]
    assert fits["watertight"] == ["sound"]
    said = {need.name: [need.reason(one) for one in rows] for need, rows in page.answers}
    assert "no answer to 1 of the fields with ties" in said["closed-python"][1]
    assert "no answer to 1" in choosing_page([mute], {"mute": "mute.html"})


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


def cost(own: float, loads: tuple[float, ...] = (0.1, 0.2)) -> dict[str, Any]:
    """A record of a method that takes so many times the peer's second, in three rounds."""
    said = {"own": [[9.0, own]] * 3, "peer": [[9.0, 1.0]] * 3, "megabytes": [own, 2.0]}
    machine = {"processor": "x", "processors": 2}
    return {
        "version": "1.2",
        "date": "2026-11-27T12:00:00+00:00",
        "machine": machine,
        "loads": list(loads),
        "fields": {"ball": said},
    }


COSTS = {
    name: one
    for name, own in {"sound": 2.0, "leaky": 0.5, "open": 4.0, "ours": 8.0}.items()
    if (one := measured(cost(own), name, "peer"))
}
LINKS = {name: f"{name}.html" for name in COSTS}


def test_a_ratio_is_of_processor_time_in_the_same_round() -> None:
    """Interleaved: the median over rounds of one over the other, whatever the clock says."""
    record = cost(1.0)
    record["fields"]["ball"]["own"] = [[9.0, 2.0], [9.0, 6.0], [9.0, 20.0]]
    record["fields"]["ball"]["peer"] = [[1.0, 1.0], [1.0, 2.0], [1.0, 10.0]]
    of = measured(record, "a", "peer")
    assert of is not None
    assert (of.costs[0].ratio, of.costs[0].low, of.costs[0].high) == (2.0, 2.0, 2.5)
    assert not of.busy


def test_a_busy_machine_is_told() -> None:
    """Issue 16: the load is recorded, and the page says so."""
    busy = measured(cost(2.0, (0.1, 3.0)), "sound", "peer")
    assert busy is not None
    assert busy.busy
    shown = choosing_page([SOUND], LINKS, {}, {}, {"sound": busy})
    assert "a busy machine" in shown
    assert "load 1.5 on each processor" in shown


def test_what_could_not_be_measured_has_no_cost() -> None:
    """A record of a failure is no number."""
    assert measured({"version": "1", "failed": "no cost"}, "a", "peer") is None


def test_the_front_is_what_no_other_beats_in_both() -> None:
    """Of equal height the faster; of equal speed the higher."""
    points = [
        Point("slow and high", "", 4.0, 3.0, False),
        Point("fast and low", "", 0.5, 1.0, False),
        Point("slower and low", "", 1.0, 1.0, False),
        Point("as fast and lower", "", 0.5, 0.5, False),
    ]
    assert [one.name for one in front(points)] == ["fast and low", "slow and high"]


def test_no_label_of_the_picture_covers_another_or_a_point() -> None:
    """Many of one level and nearly one speed: each label has a place of its own."""
    points = [(120.0 + 9 * (n // 4), 200.0 + 2 * (n % 4)) for n in range(80)]
    places = Places(points)
    for at in points:
        places.place(at, (15.0, 14.0))
    boxes = places.taken
    assert len(boxes) == 160
    for n, box in enumerate(boxes[80:], 80):
        apart = (box[:2] >= boxes[:n, 2:]) | (box[2:] <= boxes[:n, :2])
        assert apart.any(axis=1).all(), n
    middles = (boxes[80:, :2] + boxes[80:, 2:]) / 2
    away = np.hypot(*(middles - np.array(points)).T)
    assert away.min() > RADIUS
    assert away.max() < 120


@pytest.mark.slow
def test_the_letters_of_the_picture_do_not_cover_each_other_in_a_browser(tmp_path: Path) -> None:
    """The sizes that letters are taken to have are no smaller than what a browser draws."""
    points = [
        Point(f"wide-method-{n % 7}{n}", "#", 1.5 ** (n % 9 - 4), n % 5 + n / 99, n % 3 == 0)
        for n in range(80)
    ]
    told = found(
        f"<style>{(TEMPLATES / 'choosing.css').read_text(encoding='utf-8')}</style>"
        f"<body>{scatter(points, 'peer')}</body>",
        """
        const boxes = [...document.querySelectorAll(".number, .name")].map((one) => one.getBBox());
        let covered = 0;
        boxes.forEach((a, n) => boxes.slice(n + 1).forEach((b) => {
          const x = Math.min(a.x + a.width, b.x + b.width) - Math.max(a.x, b.x);
          const y = Math.min(a.y + a.height, b.y + b.height) - Math.max(a.y, b.y);
          covered += x > 1 && y > 4;
        }));
        return { labels: boxes.length, covered };
        """,
        tmp_path,
    )
    assert told == {"labels": 80, "covered": 0}


def test_fast_and_small_are_answered_where_they_were_measured() -> None:
    """The needs of speed and memory are empty without costs, and ordered by them with costs."""
    (page,) = pages([OPEN, LEAKY, SOUND], {}, {}, COSTS)
    fits = {need.name: [one.name for one in rows] for need, rows in page.answers}
    assert fits["preview"] == ["leaky", "sound", "open"]
    assert fits["huge"] == ["leaky", "sound"]
    (page,) = pages([OPEN, LEAKY, SOUND], {}, {})
    unmeasured = {need.name: len(rows) for need, rows in page.answers}
    assert unmeasured["preview"] == unmeasured["huge"] == 0


def test_every_verdict_is_a_link_to_what_it_rests_on() -> None:
    """Issue 16: every number can be clicked down to the case, or to the rounds."""
    (page,) = pages([LEAKY, OPEN], LINKS, {}, COSTS)
    leaky, wide = page.rows
    assert leaky.link_to("ties") == "leaky.html#failure-topology.ties"
    assert wide.link_to("level") == "open.html#failure-topology.closed"
    assert wide.link_to("worst") == "open.html#failure-topology.closed"
    assert wide.link_to("ties") == "open.html#topology.ties"
    shown = choosing_page([LEAKY, OPEN], LINKS, {}, {}, COSTS)
    for place in re.findall(r'href="#(cost-[^"]*)"', shown):
        assert f'id="{place}"' in shown
    own = page_of(LEAKY)
    assert 'id="failure-topology.ties"' in own


def test_versions_say_what_was_mended_and_what_broke() -> None:
    """Issue 16: the trend, in the order of the versions whatever that of the files."""
    old, new = (named("lib", row("noise/b", topology__closed=said)) for said in ("fail", "pass"))
    for report, version in ((old, "0.9"), (new, "0.10")):
        report.header["declaration"]["version"] = version
    (trend,) = trends([(new, "new.html"), (old, "old.html")])
    assert [one.version for one in trend.versions] == ["0.9", "0.10"]
    assert [(one.claim, one.mended) for one in trend.steps[0].mended] == [
        ("topology.closed", ("noise/b",))
    ]
    assert not trend.steps[0].broken
    shown = choosing_page([SOUND], {}, {}, {}, {}, [(old, "old.html"), (new, "new.html")])
    assert 'href="old.html#topology.closed"' in shown
    assert "the table above on plan" not in shown
    for one in (old, new):
        one.header["plan"] = SOUND.plan - 1
    shown = choosing_page([SOUND], {}, {}, {}, {}, [(old, "old.html"), (new, "new.html")])
    assert f"Graded on plan {SOUND.plan - 1}, the table above on plan {SOUND.plan}." in shown


def test_a_case_that_was_not_sent_neither_breaks_nor_is_mended() -> None:
    """A later grader poses what an earlier one left out: that is no change of the library."""
    both = [named("lib", row("noise/b", topology__closed=said)) for said in ("unsupported", "fail")]
    for report, version in zip(both, ("0.9", "0.10"), strict=True):
        report.header["declaration"]["version"] = version
    for older, newer in (both, both[::-1]):
        older.header["declaration"]["version"], newer.header["declaration"]["version"] = "1", "2"
        (trend,) = trends([(older, ""), (newer, "")])
        assert not trend.steps[0].changes


def luminance(colour: str) -> float:
    """Relative luminance of #rrggbb (WCAG 2.2)."""
    parts = [int(colour[at : at + 2], 16) / 255 for at in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def test_text_is_legible_on_what_it_stands_on_in_light_and_dark() -> None:
    """Issue 16: contrast checked; 4.5 to 1 for text (WCAG 2.2, 1.4.3)."""
    style = (TEMPLATES / "style.css").read_text(encoding="utf-8")
    roots = re.findall(r":root \{(.*?)\}", style, re.DOTALL)
    schemes = [root for root in roots if "--ink" in root]  # On paper some are changed.
    assert len(schemes) == 2
    for scheme in schemes:
        colours = dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6})", scheme))
        for ink in ("ink", "soft", "good", "bad", "accent"):
            for under in ("paper", "card", "wash"):
                light, dark = sorted((luminance(colours[ink]), luminance(colours[under])))[::-1]
                assert (light + 0.05) / (dark + 0.05) >= 4.5, (ink, under)
    used = (TEMPLATES / "choosing.css").read_text(encoding="utf-8")
    assert "var(--none)" not in used, "too pale for text or borders of fields"


ABOUT = dict.fromkeys(("sound", "leaky"), FREE)
WIDE = choosing_page(
    [SOUND, LEAKY, OPEN, OURS], LINKS, {**ABOUT, "open": About("o", "Rust", "", "GPL", "copyleft")},
    {"gone": "the registry refuses it"}, COSTS,
)  # fmt: skip


@pytest.mark.slow
def test_a_closed_surface_in_python_fast_and_permissive_takes_two_clicks(tmp_path: Path) -> None:
    """Issue 16: the question and, at most, one more click; the table fits; sorting, hiding.

    Who hides a row by keyboard goes on at the next; what printing opened is closed after it.
    """
    told = found(
        WIDE,
        """
        const need = document.querySelector("#need-closed-python");
        need.querySelector("summary").click();
        await new Promise((done) => setTimeout(done, 50));
        const first = need.querySelector("li a");
        const head = document.querySelectorAll("table.choose thead button")[4];
        head.click();
        const rows = [...document.querySelectorAll("tr[data-level]")];
        const names = rows.map((row) => row.dataset.name);
        document.querySelector("tr[data-name=leaky] .hide").click();
        const hidden = document.querySelector("tr[data-name=leaky]").hidden;
        const went = document.activeElement.className;
        document.querySelector(".back").click();
        dispatchEvent(new Event("beforeprint"));
        const shut = document.querySelectorAll("details:not([open]):not(.columns)").length;
        dispatchEvent(new Event("afterprint"));
        return {
          open: need.open, answer: first.textContent, at: first.getAttribute("href"),
          seen: first.getBoundingClientRect().height > 0, names, hidden,
          again: document.querySelector("tr[data-name=leaky]").hidden,
          wide: Math.max(0, document.documentElement.scrollWidth - innerWidth),
          sticky: getComputedStyle(document.querySelector(".choose thead th")).position,
          shut, went, left: document.querySelectorAll(".need[open]").length,
          titles: document.querySelectorAll("main [title]").length,
        };
        """,
        tmp_path,
        "--window-size=1400,1000",
    )
    assert told == {
        "open": True,
        "answer": "sound",
        "at": "sound.html",
        "seen": True,
        "names": ["leaky", "sound", "open", "ours"],
        "hidden": True,
        "again": False,
        "wide": 0,
        "sticky": "sticky",
        "shut": 0,
        "went": "hide",
        "left": 1,
        "titles": 0,
    }


@pytest.mark.slow
def test_the_page_fits_a_telephone(tmp_path: Path) -> None:
    """390 pixels: nothing is wider than the screen, and each cell says its heading.

    Chromium's own window is never so narrow: the page stands in a frame that is.
    """
    (tmp_path / "inner.html").write_text(WIDE, encoding="utf-8")
    told = found(
        '<body><iframe src="inner.html" width="390" height="800"></iframe></body>',
        """
        const page = document.querySelector("iframe").contentDocument;
        const cell = page.querySelector("td[data-label]");
        return {
          more: page.documentElement.scrollWidth - 390,
          said: page.defaultView.getComputedStyle(cell, "::before").content,
        };
        """,
        tmp_path,
        "--allow-file-access-from-files",
    )
    assert told["more"] <= 0
    assert "level" in told["said"] or "attr(data-label)" in told["said"]


def test_the_explorer_is_kept_once_in_the_repository(tmp_path: Path) -> None:
    """Beside kept pages stands a page that leads to it; beside anybody else's, the explorer."""
    here = Path(isograde.report.__file__).parents[3] / "reports" / "league"
    whole = explorer()
    if whole is None or not whole.is_relative_to(here.parents[1] / "docs"):
        pytest.skip("the explorer is not built, or installed with the package")
    assert "../../docs/explorer/explorer.html" in beside(here)
    assert (here / "../../docs/explorer/explorer.html").resolve() == whole.resolve()
    assert beside(tmp_path) == whole.read_text(encoding="utf-8")
