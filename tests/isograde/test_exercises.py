"""Exercises: what is given is wrong as the lesson says, and the solutions are right."""

from pathlib import Path

import pytest
from isograde.command import app
from isograde.exercises import EXERCISES, judged
from typer.testing import CliRunner

COURSE = Path(__file__).parents[2] / "docs" / "course"
# The claim that each exercise is about; all that fails is among the hints.
ABOUT = {
    1: {"topology.sides", "geometry.crossing"},
    2: {"topology.bilinear"},
    3: {"topology.closed", "topology.oriented", "topology.sides"},
    4: {"topology.closed"},
    5: {"topology.bilinear"},
}


@pytest.mark.parametrize("number", EXERCISES)
def test_what_is_given_fails_by_what_the_lesson_is_about(number: int, tmp_path: Path) -> None:
    """Issue 17: it says what is still wrong in the words of the lesson."""
    exercise = EXERCISES[number]
    path = tmp_path / exercise.file
    path.write_text(exercise.text)
    found = judged(exercise, path)
    assert {one.claim for one in found} == ABOUT[number]
    assert all(one.hint == exercise.hints[one.claim] for one in found)
    assert all(one.case and one.failed <= one.asked for one in found)


@pytest.mark.parametrize("number", EXERCISES)
def test_a_solution_has_nothing_wrong(number: int) -> None:
    """The solutions are apart, and each is the given file but for what was wrong."""
    exercise = EXERCISES[number]
    path = COURSE / "solutions" / exercise.file
    assert judged(exercise, path) == []
    given, mended = exercise.text.splitlines(), path.read_text().splitlines()
    assert 0 < len(set(given) - set(mended)) <= 8


@pytest.mark.parametrize("number", EXERCISES)
def test_a_hint_never_has_a_line_of_the_solution(number: int) -> None:
    """Issue 17: and never the answer."""
    exercise = EXERCISES[number]
    mended = (COURSE / "solutions" / exercise.file).read_text().splitlines()
    new = {line.strip() for line in set(mended) - set(exercise.text.splitlines())}
    assert new
    for hint in exercise.hints.values():
        assert not any(line in hint for line in new if len(line) > 3)


@pytest.mark.parametrize(
    "text",
    [
        "def extract(values, isovalue, spacing):\n    return [], []\n",
        "def extract(values, isovalue, spacing):\n    raise NotImplementedError\n",
        "def extract(values, isovalue, spacing):\n    return 1 / 0\n",
    ],
)
@pytest.mark.parametrize("number", [3, 4, 5])
def test_a_file_that_does_nothing_is_not_mended(number: int, text: str, tmp_path: Path) -> None:
    """Nothing for every field, declining, and raising are no answers."""
    path = tmp_path / "mine.py"
    path.write_text(text)
    assert judged(EXERCISES[number], path)


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
    assert run.invoke(app, ["exercise", "9"]).exit_code == 2
    assert run.invoke(app, ["exercise", "1", "nowhere.py"]).exit_code == 2
