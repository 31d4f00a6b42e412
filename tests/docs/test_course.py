"""The lessons: what they print is what comes, what they show is what is made now."""

from __future__ import annotations

import doctest
import re
import subprocess
import sys
from itertools import pairwise
from math import prod
from pathlib import Path
from types import ModuleType
from urllib.parse import parse_qsl

import numpy as np
import pytest
from isograde.exercises import EXERCISES
from isoref.cube import CORNERS, REPRESENTATIVES, ROTATIONS, configuration, moved_signs
from isoref.cycles import ALL_SEPARATED, Polygon, cycles, share_face
from isoref.methods import RULES

from tests.browser import found
from tests.loading import module_at

ROOT = Path(__file__).parent.parent.parent
COURSE = ROOT / "docs" / "course"
LESSONS = sorted(COURSE.glob("lesson_*.rst"), key=lambda path: int(path.stem[7:]))
FIRST = 5  # The lessons that a reader gets through in an afternoon.
TABS = {"cell", "gallery", "pair", "field", "plane", "four"}
KINDS = {"", "noise", "smooth", "gyroid", "balls"}


@pytest.fixture(scope="module")
def figures() -> ModuleType:
    """The program that makes the films."""
    return module_at(COURSE / "figures.py", "course_figures")


def number(lesson: Path) -> int:
    """Which lesson it is."""
    return int(lesson.stem[7:])


@pytest.mark.parametrize("lesson", LESSONS, ids=number)
def test_what_a_lesson_prints_is_what_comes(lesson: Path) -> None:
    """Issue 17: every output and number is made or tested by the build."""
    found = doctest.testfile(str(lesson), module_relative=False, encoding="utf-8")
    assert found.failed == 0
    assert found.attempted >= (2 if number(lesson) > FIRST else 0)


@pytest.mark.parametrize("lesson", LESSONS, ids=number)
def test_a_lesson_has_a_figure_that_moves_and_its_exercise(lesson: Path) -> None:
    """Issue 17: each lesson a page with a figure that moves and an exercise."""
    text = lesson.read_text(encoding="utf-8")
    assert f"``isograde exercise {number(lesson)}``" in text
    assert EXERCISES[number(lesson)].title.lower() in text.splitlines()[0].lower()
    films = re.findall(r":file: (made/film_\d+\.html)", text)
    assert all((COURSE / film).is_file() for film in films)
    assert films == [f"made/film_{number(lesson)}.html"]
    for link in re.findall(r"<\.\./explorer\.html#([^>]+)>", text):
        parts = dict(parse_qsl(link))
        assert parts["tab"] in TABS
        assert parts.get("kind", "") in KINDS
        assert parts.get("tiles", "lorensen-cline") in RULES
        assert set(parts.get("r", "lorensen-cline").split(",")) <= set(RULES)
        if "v" in parts:
            size = prod(map(int, parts["n"].split(",")))
            assert len(list(map(float, parts["v"].split(",")))) == size


def test_every_lesson_has_an_exercise_and_every_exercise_a_lesson() -> None:
    """And the contents name them in order."""
    assert [number(lesson) for lesson in LESSONS] == sorted(EXERCISES)
    index = (COURSE / "index.rst").read_text(encoding="utf-8")
    assert re.findall(r"^   lesson_(\d+)$", index, re.MULTILINE) == [
        str(number(lesson)) for lesson in LESSONS
    ]


def words(lesson: Path) -> int:
    """How many words a reader reads: all that is neither code nor a drawing."""
    text = lesson.read_text(encoding="utf-8")
    paragraphs = re.split(r"\n\s*\n", text)
    return sum(len(p.split()) for p in paragraphs if not p.startswith((" ", ">>>", ".. ")))


def test_a_lesson_is_not_too_long() -> None:
    """Issue 17: the first five at most 6,000 words together; the others as a chapter of a book."""
    assert sum(len(one.read_text(encoding="utf-8").split()) for one in LESSONS[:FIRST]) <= 6_000
    for lesson in LESSONS[FIRST:]:
        assert 700 <= words(lesson) <= 1_250, lesson.name


def test_the_syllabus_is_true_and_names_every_lesson() -> None:
    """What it prints is what comes; a row for each lesson, with its title."""
    syllabus = COURSE / "syllabus.rst"
    assert doctest.testfile(str(syllabus), module_relative=False, encoding="utf-8").failed == 0
    linked = re.findall(r"`([^`<]+) <lesson_(\d+)\.html>`_", syllabus.read_text(encoding="utf-8"))
    assert [(int(n), title) for title, n in linked] == [
        (one.number, one.title) for one in EXERCISES.values()
    ]


def test_slides_build_with_every_lesson_and_film_and_without_a_network(tmp_path: Path) -> None:
    """Issue 17: slides from the same figures."""
    pytest.importorskip("sphinx_revealjs")
    command = ["-m", "sphinx", "-W", "-q", "-b", "revealjs", str(COURSE / "slides"), str(tmp_path)]
    done = subprocess.run(
        [sys.executable, *command], capture_output=True, encoding="utf-8", check=False
    )
    assert done.returncode == 0, done.stderr
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    for one in EXERCISES.values():
        assert f"isograde exercise {one.number}" in re.sub(r"<[^>]+>", "", page)
    for film in COURSE.glob("made/film_*.html"):
        assert film.read_text(encoding="utf-8").strip() in page
    assert not re.findall(r"<(?:script|link|img|iframe)[^>]*(?:src|href)=\"https?:", page)


def test_films_are_as_they_are_made_now(figures: ModuleType) -> None:
    """Nothing in the pages is older than the code it is made of."""
    assert figures.FILMS
    for name, film in figures.FILMS.items():
        kept = (COURSE / "made" / f"film_{name}.html").read_text(encoding="utf-8")
        assert film().fragment() == kept, f"film {name}: run python docs/course/figures.py"


@pytest.mark.slow
def test_every_step_of_every_film_is_drawn_and_what_stands_in_space_turns(tmp_path: Path) -> None:
    """In a real browser: nothing raises, all that is drawn is in the picture, keys turn it."""
    films = sorted(COURSE.glob("made/film_*.html"))
    assert len(films) == len(LESSONS)
    page = "".join(film.read_text(encoding="utf-8") for film in films)
    script = """
      const numbers = (svg) => [...svg.children].flatMap((one) =>
        ["points", "x1", "y1", "x2", "y2", "cx", "cy", "x", "y"].flatMap((name) =>
          (one.getAttribute(name) ?? "").split(/[ ,]/).filter(Boolean).map(Number)));
      return [...document.querySelectorAll("figure.film")].map((figure) => {
        const [svg, slider] = [figure.querySelector("svg"), figure.querySelector("input")];
        const steps = [];
        for (let n = 0; n <= Number(slider.max); n++) {
          slider.value = n;
          slider.dispatchEvent(new Event("input"));
          const all = numbers(svg);
          steps.push([all.length, Math.min(...all), Math.max(...all),
                      figure.querySelector("figcaption").textContent]);
        }
        const before = svg.innerHTML;
        svg.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft" }));
        return { steps, turned: svg.innerHTML !== before, inSpace: svg.tabIndex === 0 };
      });
    """
    told = found(f"<!doctype html><body>{page}</body>", script, tmp_path)
    assert len(told) == len(films)
    for name, film in zip(films, told, strict=True):
        assert film["turned"] == film["inSpace"], name
        assert len({says for *_, says in film["steps"]}) == len(film["steps"]) > 3, name
        for count, least, most, says in film["steps"]:
            assert count > 0, says
            assert least >= -1, (name, says)
            assert most <= 641, (name, says)


def test_numbers_that_the_first_lessons_say_in_words_are_right() -> None:
    """24 rotations, 15 configurations, 23 where inside and outside differ; and two examples."""
    assert len(set(ROTATIONS)) == 24
    assert len(REPRESENTATIVES) == 15
    assert len({min(moved_signs(s, move) for move in ROTATIONS) for s in range(256)}) == 23
    text = {number(one): one.read_text(encoding="utf-8") for one in LESSONS}
    for n, said in ((3, "24 rotations"), (3, "fifteen *configurations*"), (4, "twenty-three")):
        assert said in text[n]
    # Lesson 1: between 3 and 5, 3.5 is a quarter of the way.
    assert "0.25" in text[1]
    assert (3.5 - 3) / (5 - 3) == 0.25
    # Lesson 2: the mean is inside, and the saddle is not.
    a, b, c, d = 4, -1.7, 0.5, -1.7
    mean, saddle = (a + b + c + d) / 4, (a * c - b * d) / (a + c - b - d)
    assert mean > 0 > saddle
    said = " ".join(text[2].split())
    assert "*a* = 4, *c* = 0.5 and *b* = *d* = -1.7" in said
    assert f"the mean is {mean:.3g}, so inside, and the saddle {saddle:.3f}, so outside" in said


def test_the_cell_of_lesson_5_is_of_configuration_3_and_falls_apart_as_its_text_says() -> None:
    """The linked cell; and at 0.2, which the text names, its saddle is outside."""
    text = (COURSE / "lesson_5.rst").read_text(encoding="utf-8")
    (link,) = re.findall(r"cell of configuration 3\s<\.\./explorer\.html#([^>]+)>", text)
    g = np.reshape([float(x) for x in dict(parse_qsl(link))["v"].split(",")], (2, 2, 2))
    assert configuration(sum(1 << c for c in range(8) if g[CORNERS[c]] >= 0)) == 3
    for value, joined in ((0.4, True), (0.2, False)):
        assert str(value) in text
        g[1, 1, 0] = value
        assert (g[0, 0, 0] * g[1, 1, 0] >= g[1, 0, 0] * g[0, 1, 0]) == joined


def test_a_polygon_of_seven_sides_has_a_fan_without_a_chord_on_a_face() -> None:
    """Lesson 6 says so, of all patterns."""
    polygons = {p for signs in range(256) for p in cycles(signs, ALL_SEPARATED)}
    assert len(polygons) > 100
    assert max(map(len, polygons)) == 7
    assert all(any(map(is_fan, turns(polygon))) for polygon in polygons)


def turns(polygon: Polygon) -> list[Polygon]:
    """The polygon begun at each of its corners."""
    return [polygon[k:] + polygon[:k] for k in range(len(polygon))]


def is_fan(polygon: Polygon) -> bool:
    """Whether no chord from its first corner lies on a face."""
    first, *others = polygon
    return len(list(pairwise(others))) < 2 or not any(share_face(first, e) for e in others[1:-1])
