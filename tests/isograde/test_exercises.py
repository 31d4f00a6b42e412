"""Exercises: what is given is wrong as the lesson says, and the solutions are right."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from difflib import SequenceMatcher
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from isograde.adapters.loading import load
from isograde.command import app
from isograde.exercises import EXERCISES, Told, fields, judged, told_through
from isoref import dual_marching_cubes
from isoref.dual import is_turned
from typer.testing import CliRunner

from tests.isograde.judging import Here

COURSE = Path(__file__).parents[2] / "docs" / "course"
# The claim that each exercise is about; all that fails is among the hints.
ABOUT = {
    1: {"topology.sides", "geometry.crossing"},
    2: {"topology.bilinear"},
    3: {"topology.closed", "topology.oriented", "topology.sides"},
    4: {"topology.closed"},
    5: {"topology.bilinear"},
    6: {"topology.closed", "topology.sides", "topology.manifold"},
    7: {"topology.closed", "topology.bilinear"},
    8: {"topology.trilinear"},
    9: {"topology.closed", "topology.sides", "geometry.crossing", "cells.mean"},
    10: {"topology.closed", "topology.sides"},
    11: {"topology.closed", "topology.sides", "topology.oriented"},
    12: {"topology.manifold", "topology.sides", "topology.oriented"},
    13: {
        "structure.answers",
        "robustness.input_unmodified",
        "geometry.crossing",
        "symmetry.spacing",
        "symmetry.layout",
        "symmetry.type",
    },
}
# How many faults each lesson says there are.
FAULTS = {1: 2, 6: 2, 7: 2, 8: 2, 9: 2, 10: 2, 11: 2, 12: 2, 13: 4}


def marked(numbers: Iterable[int], slow: set[int]) -> list[Any]:
    """The exercises, those with many or costly fields marked as slow."""
    return [pytest.param(n, marks=pytest.mark.slow) if n in slow else n for n in numbers]


def here(number: int, path: Path) -> list[Told]:
    """What `judged` tells, in this process: a worker takes a second to start."""
    call, declared = load(f"python:{path}:extract")

    def function(values: Any, level: Any, spacing: tuple[float, ...]) -> Any:
        return call(values, level if isinstance(level, tuple) else (level,), spacing)

    return told_through(EXERCISES[number], Here(function, declared), declared)


@pytest.mark.parametrize("number", marked(EXERCISES, slow={3, 8}))
def test_what_is_given_fails_by_what_the_lesson_is_about(number: int, tmp_path: Path) -> None:
    """Issue 17: it says what is still wrong in the words of the lesson."""
    exercise = EXERCISES[number]
    path = tmp_path / exercise.file
    path.write_text(exercise.text)
    found = judged(exercise, path)
    assert {one.claim for one in found} == ABOUT[number]
    assert all(one.claim in exercise.hints for one in found)
    assert all(one.hint == exercise.hint(one.claim, one.case, "") for one in found)
    assert all(one.case and one.failed <= one.asked for one in found)


@pytest.mark.parametrize("number", marked(EXERCISES, slow={3}))
def test_a_solution_has_nothing_wrong(number: int) -> None:
    """The solutions are apart, and each is the given file but for what was wrong."""
    exercise = EXERCISES[number]
    path = COURSE / "solutions" / exercise.file
    assert here(number, path) == []
    given, mended = exercise.text.splitlines(), path.read_text().splitlines()
    assert 0 < len(set(given) - set(mended)) <= 12


def half_mended(number: int) -> Iterator[str]:
    """The solution with one of the given file's faults in it, one after the other.

    In lesson 8 both faults are in neighbouring lines; each is then put back by itself.
    """
    exercise = EXERCISES[number]
    right = (COURSE / "solutions" / exercise.file).read_text().splitlines(keepends=True)
    given = exercise.text.splitlines(keepends=True)
    for tag, a, b, c, d in SequenceMatcher(None, right, given, autojunk=False).get_opcodes():
        # Skip the first line, which says how many there are, and a helper that the mending adds.
        if tag not in ("equal", "delete") and a:
            yield "".join(right[:a] + given[c:d] + right[b:])
    if number == 8:
        text = "".join(right)
        for old, new in (
            ("for axis in range(3)", "for axis in (0,)"),
            ("(g, middle)", "(g, half)"),
        ):
            changed = text.replace(old, new).replace("half)", "np.full_like(middle, 0.5))")
            assert changed != text
            yield changed


@pytest.mark.parametrize("number", marked(FAULTS, slow={8}))
def test_each_fault_by_itself_is_seen(number: int, tmp_path: Path) -> None:
    """Who mends one of two faults is told of the other, and not that all is well."""
    count, hints = 0, set()
    for count, text in enumerate(half_mended(number), 1):
        path = tmp_path / f"half_{count}.py"
        path.write_text(text)
        found = here(number, path)
        assert found, f"fault {count} of exercise {number} goes unseen"
        assert {one.claim for one in found} <= set(EXERCISES[number].hints)
        hints.add(found[0].hint)
    # Faults that fail the same claim are told apart by the cases that show them.
    assert len(hints) >= (FAULTS[number] if EXERCISES[number].apart else 1)
    assert count >= (FAULTS[number] if number > 1 else 1)


# Other answers than the solution's, as a reader may find them: what is replaced, and by what.
PRODUCTS = "np.where(a >= 0, a * c < b * d, b * d < a * c)"
QUOTIENT = "(a * c - b * d) / (a + c - b - d) < 0"
# The interpolant at its saddle: right but for rounding, which depends on the first corner.
SADDLE = (
    "(lambda s, t: a * (1 - s) * (1 - t) + b * s * (1 - t) + c * s * t + d * (1 - s) * t < 0)"
    "((a - d) / (a + c - b - d), (a - b) / (a + c - b - d))"
)
RIGHT = {
    "2 by a quotient": ("a * c < b * d if a >= 0 else b * d < a * c", QUOTIENT),
    "5 by a quotient": (PRODUCTS, QUOTIENT),
    "6 from the other end": ("in range(len(polygon))", "in reversed(range(len(polygon)))"),
    "6 all joined": ("(i + 1) % 4\n            following", "(i - 1) % 4\n            following"),
    "7 everybody asked": ("len(ambiguous_faces(signs)) > 0", "True"),
    "10 another order": ("(high) if one]", "(high) if one][::-1]"),
    "12 in another order": (
        "cycles(signs, ALL_SEPARATED)\n\n",
        "[sorted(p) for p in cycles(signs, ALL_SEPARATED)]\n\n",
    ),
    "13 a new array": ("values.astype(float) - isovalue", "values - isovalue"),
}
WRONG = {
    "2 the diagonal forgotten": ("a * c < b * d if a >= 0 else b * d < a * c", "a * c < b * d"),
    "4 turned over": ("letters = TRIANGLES[signs]\n", "letters = TRIANGLES[signs][::-1]\n"),
    "5 the diagonal forgotten": (PRODUCTS, "a * c < b * d"),
    "5 the saddle from the first corner": (PRODUCTS, SADDLE),
    "5 never separated": (PRODUCTS, "np.zeros(a.shape, bool)"),
    "7 by the mean": (PRODUCTS, "(a + c) + (b + d) < 0"),
    "8 no tunnels": ("there & (product < 0)", "there & False"),
    "8 two axes": ("range(3)", "range(2)"),
    "9 never connected": ("(v + q) + (w + p) >= 0", "False"),
    "9 a careless sum": ("(v + q) + (w + p) >= 0", "v + w + p + q >= 0"),
    "10 in the middle": ("point[a] + t * (point[b] - point[a])", "(point[a] + point[b]) / 2"),
    "12 one piece alone": (
        "cycles(signs, ALL_SEPARATED)\n\n",
        "cycles(signs, ALL_SEPARATED)[:1]\n\n",
    ),
    "13 six decimals": ("name = ends", "name = tuple(np.round(place, 6))"),
}


def test_each_hint_of_exercise_11_is_of_one_fault(tmp_path: Path) -> None:
    """Who stores segments in a tidy order is told of directions alone, and the other way round."""
    hints = []
    for text in half_mended(11):
        path = tmp_path / EXERCISES[11].file
        path.write_text(text)
        hints.append({one.claim: one.hint for one in here(11, path)})
    places, directions = hints
    assert set(places) == {"topology.closed", "topology.sides"}
    assert set(directions) == {"topology.oriented", "topology.sides"}
    assert "longer than what both" in places["topology.sides"]
    assert "it has a direction" in directions["topology.sides"]


def changed(name: str, replaced: tuple[str, str], folder: Path) -> tuple[int, Path]:
    """The number of an exercise, and its solution with one thing replaced, in a file."""
    number = int(name.split()[0])
    text = (COURSE / "solutions" / EXERCISES[number].file).read_text()
    assert text.count(replaced[0]) == 1
    path = folder / f"{name.replace(' ', '_')}.py"
    path.write_text(text.replace(*replaced))
    return number, path


@pytest.mark.parametrize("name", RIGHT)
def test_a_right_answer_need_not_be_the_solution(name: str, tmp_path: Path) -> None:
    """Never punish a choice that the lesson did not rule out."""
    assert here(*changed(name, RIGHT[name], tmp_path)) == []


@pytest.mark.parametrize("name", WRONG)
def test_an_answer_that_misses_the_point_is_told(name: str, tmp_path: Path) -> None:
    """Short cuts that satisfy all but one of the claims."""
    assert here(*changed(name, WRONG[name], tmp_path))


def test_rounding_that_depends_on_the_first_corner_is_a_hole(tmp_path: Path) -> None:
    """Lesson 5: near S = 0 the rounded results can differ, and there is the hole again."""
    name = "5 the saddle from the first corner"
    found = here(*changed(name, WRONG[name], tmp_path))
    assert [one.claim for one in found] == ["topology.closed"]
    assert found[0].case.startswith("exercise/saddle-")


# What is said of row 210 of exercise 3, by how it was mended.
SAID = {
    "ajfcikckl": "one of its polygons is not filled",
    "aikaklalfcjh": "Two cells do not fit each other",
    "cikcklclh": "Two cells do not fit each other",
}


@pytest.mark.parametrize("row", SAID)
def test_cells_that_do_not_fit_are_no_unfilled_polygon(
    row: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A row that joins on a face has every polygon filled: the other cell decides otherwise."""
    cases = [case for case in fields.cells() if case.id.startswith("exercise/pattern-210-")]
    assert len(cases) == 2
    few = replace(EXERCISES[3], cases=lambda: cases)
    monkeypatch.setitem(EXERCISES, 3, few)
    found = here(*changed(f"3 {row}", ('"ajfcikcklclh"', f'"{row}"'), tmp_path))
    assert SAID[row] in found[0].hint
    assert found[0].claim == "topology.closed"


def test_the_values_of_the_square_at_fault_are_told(tmp_path: Path) -> None:
    """A reader can work out the saddle with a pencil: four values, as one walks round."""
    for number in (2, 5):
        path = tmp_path / EXERCISES[number].file
        path.write_text(EXERCISES[number].text)
        told = next(one for one in here(number, path) if one.claim == "topology.bilinear")
        a, b, c, d = map(float, re.findall(r"(-?\d[\d.e-]*) at \[", told.detail))
        assert (a >= 0) == (c >= 0) != (b >= 0) == (d >= 0)
        saddle, mean = (a * c - b * d) / (a + c - b - d), a + b + c + d
        assert saddle * mean < 0, "what the mean decides wrongly"
        case = next(one for one in EXERCISES[number].cases() if one.id == told.case)
        places = re.findall(r"at \[([\d, ]+)\](?=,|$)", told.detail.partition("isovalue: ")[2])
        values = [case.build().values[tuple(map(int, at.split(",")))] for at in places]
        assert values == pytest.approx([a, b, c, d], rel=1e-3)


def test_the_file_of_another_exercise_is_named(tmp_path: Path) -> None:
    """Exercise 1's file answers no square, and says whose it is."""
    path = tmp_path / "mine.py"
    path.write_text(EXERCISES[1].text)
    (told,) = here(2, path)
    assert "of exercise 1" in told.hint


def test_no_two_cells_of_exercise_12_pinch_one_face() -> None:
    """Lesson 12 promises it: a vertex for each polygon is then enough."""
    assert fields.UNPINCHED
    for case in fields.islands():
        inside = case.build().values >= 0
        cells = np.ndindex(*np.subtract(inside.shape, 1))
        assert not any(is_turned(dual_marching_cubes.RULE, inside, cell) for cell in cells)


@pytest.mark.parametrize("number", EXERCISES)
def test_a_hint_never_has_a_line_of_the_solution(number: int) -> None:
    """Issue 17: and never the answer."""
    exercise = EXERCISES[number]
    mended = (COURSE / "solutions" / exercise.file).read_text().splitlines()
    new = {line.strip() for line in set(mended) - set(exercise.text.splitlines())}
    assert new
    for hint in (*exercise.hints.values(), *exercise.apart.values()):
        assert not any(line in hint for line in new if len(line) > 3)


NOTHING = "def extract(values, isovalue, spacing):\n    "


@pytest.mark.parametrize("number", range(4, 14))
def test_an_answer_that_returns_nothing_is_not_mended(number: int, tmp_path: Path) -> None:
    """Nothing is closed, and on no sample's wrong side; it is no answer all the same."""
    path = tmp_path / f"nothing_{number}.py"
    kinds = sorted({tuple(case.kind) for case in EXERCISES[number].cases()})
    path.write_text(f"{NOTHING}return [], []\ndeclaration = {{'limits': {{'kinds': {kinds}}}}}\n")
    assert here(number, path)


@pytest.mark.parametrize("text", ["raise NotImplementedError", "return 1 / 0"])
def test_a_file_that_does_nothing_is_not_mended(text: str, tmp_path: Path) -> None:
    """Declining, and raising, are no answers."""
    path = tmp_path / "mine.py"
    path.write_text(f"{NOTHING}{text}\n")
    assert judged(EXERCISES[5], path)


def test_the_command_gives_a_file_and_judges_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It never writes over a file that is there."""
    monkeypatch.chdir(tmp_path)
    run = CliRunner()
    assert run.invoke(app, ["exercise", "1"]).exit_code == 0
    again = run.invoke(app, ["exercise", "1"])
    assert again.exit_code == 2
    wrong = run.invoke(app, ["exercise", "1", "exercise_1.py"])
    assert wrong.exit_code == 1
    assert "Still wrong" in wrong.output
    solved = COURSE / "solutions" / "exercise_1.py"
    right = run.invoke(app, ["exercise", "1", str(solved)])
    assert right.exit_code == 0
    assert "Mended" in right.output
    assert run.invoke(app, ["exercise", "99"]).exit_code == 2
    assert run.invoke(app, ["exercise", "1", "nowhere.py"]).exit_code == 2
    folder = run.invoke(app, ["exercise", "1", str(tmp_path)])
    assert folder.exit_code == 2
    assert "isograde submissions" in folder.output
