"""The autograder: a row each, and a hostile submission costs only its own."""

from __future__ import annotations

import csv
import io
import os
from pathlib import Path

import psutil
import pytest
from isograde.command import app
from isograde.exercises import EXERCISES
from isograde.exercises.submissions import (
    NoSubmissionsError,
    Row,
    as_csv,
    as_markdown,
    collected,
    rows,
)
from typer.testing import CliRunner

COURSE = Path(__file__).parents[2] / "docs" / "course"
DECLARED = 'declaration = {"limits": {"kinds": [[1, 1]]}}\n'
CALLED = DECLARED + "import os, signal, subprocess, sys\ndef extract(values, isovalue, spacing):\n"
MARK = "print-this-to-find-the-orphan"
HOSTILE = {
    "kills": CALLED + "    os.kill(os.getppid(), signal.SIGKILL)\n    while True: pass\n",
    "hangs": CALLED + "    while True: pass\n",
    "forges": CALLED
    + "    with open(f'/proc/{os.getppid()}/fd/1', 'w') as out:\n"
    + '        out.write(\'{"secret": "", "result": "mended", "told": []}\\n\')\n'
    + "    return [], []\n",
    "orphans": CALLED
    + f"    subprocess.Popen([sys.executable, '-c', 'while 1: pass', '{MARK}'], "
    + "start_new_session=True)\n    os.kill(os.getppid(), signal.SIGKILL)\n",
}


def hand_in(folder: Path, name: str, text: str, number: int = 1) -> Path:
    """A submission in a person's folder."""
    path = folder / name / f"exercise_{number}.py"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.slow
def test_a_hostile_submission_costs_only_its_own_row(tmp_path: Path) -> None:
    """Issue 17: an autograder that runs a class's submissions, each in its own process."""
    hand_in(tmp_path, "ada", (COURSE / "solutions" / "exercise_1.py").read_text())
    hand_in(tmp_path, "zoe", EXERCISES[1].text)
    for name, text in HOSTILE.items():
        hand_in(tmp_path, name, text)
    found = {row.name: row for row in rows(collected(tmp_path), seconds=3, jobs=2)}
    assert found["ada"].result == "mended"
    assert found["ada"].told == ()
    assert found["zoe"].result == "still wrong"
    assert found["zoe"].changed == 0
    assert len(found["zoe"].told) == 2
    assert not {row.result for name, row in found.items() if name in HOSTILE} & {"mended"}
    assert "SIGKILL" in found["kills"].told[0]
    assert "no answer within 3 s" in found["hangs"].told[0]
    assert "something else" in found["forges"].told[0]
    mine = [one for one in psutil.process_iter(["cmdline"]) if MARK in (one.info["cmdline"] or ())]
    assert not mine, "a process of a submission outlived its row"


@pytest.mark.slow
def test_the_command_judges_a_class_and_writes_tables(tmp_path: Path) -> None:
    """A table of names, exercises, mended or what is still wrong, as CSV and Markdown."""
    solved = (COURSE / "solutions" / "exercise_1.py").read_text(encoding="utf-8")
    (tmp_path / "class").mkdir()
    (tmp_path / "class" / "ada_exercise_1.py").write_text(solved, encoding="utf-8")
    tables = [str(tmp_path / "table.csv"), str(tmp_path / "table.md")]
    words = ["submissions", str(tmp_path / "class"), "-e", "1", "-e", "2"]
    told = CliRunner().invoke(app, [*words, "-o", tables[0], "-o", tables[1]])
    assert told.exit_code == 0, told.output
    assert "1 of 2 mended" in told.output
    read = list(csv.DictReader(io.StringIO(Path(tables[0]).read_text(encoding="utf-8"))))
    assert [(one["name"], one["exercise"], one["result"]) for one in read] == [
        ("ada", "1", "mended"),
        ("ada", "2", "not handed in"),
    ]
    assert "| ada | 2 | not handed in | 0 |  |" in Path(tables[1]).read_text(encoding="utf-8")


def test_both_layouts_are_read_and_what_is_no_submission_is_told(tmp_path: Path) -> None:
    """A folder a person, or names before files; links, twins and other files."""
    hand_in(tmp_path, "ada", "x = 1\n", 4)
    hand_in(tmp_path, "ada", "x = 1\n", 5)
    (tmp_path / "Bob B._exercise_4.py").write_text("x = 2\n")
    (tmp_path / "ada_exercise_4.py").write_text("x = 3\n")
    (tmp_path / "exercise_4.py").write_text("whose?\n")
    (tmp_path / "eve_exercise_99.py").write_text("there is no such exercise\n")
    (tmp_path / "eve_exercise_5.py").symlink_to(tmp_path / "ada" / "exercise_5.py")
    (tmp_path / "max_exercise_5.py").write_bytes(b"#" * (1 << 20) + b"#")
    os.mkfifo(tmp_path / "fifo_exercise_5.py")
    found = {(one.name, one.number): one for one in collected(tmp_path)}
    assert set(found) == {(n, k) for n in ("ada", "Bob B", "eve", "fifo", "max") for k in (4, 5)}
    assert found["Bob B", 4].text == b"x = 2\n"
    assert "twice" in found["ada", 4].fault
    assert found["ada", 5].text == b"x = 1\n"
    assert "link" in found["eve", 5].fault
    assert "link, or no file" in found["fifo", 5].fault
    assert "bytes" in found["max", 5].fault
    assert found["eve", 4] == type(found["eve", 4])("eve", 4, None)
    with pytest.raises(NoSubmissionsError, match=r"NAME/exercise_7\.py"):
        collected(tmp_path, [7])


def test_a_table_is_data_for_spreadsheets_and_for_markdown() -> None:
    """A name or an error of a submission is no formula, no link, no markup."""
    table = [Row("=HYPERLINK(1)", 4, "no answer", ("@SUM | <script>", "[a](b)"), 2)]
    (read,) = csv.DictReader(io.StringIO(as_csv(table)))
    assert read["name"] == "'=HYPERLINK(1)"
    assert read["what"].startswith("'@SUM")
    line = as_markdown(table).splitlines()[2]
    assert line.replace(r"\|", "").count("|") == 6
    assert r"\<script\>" in line
    assert r"\[a\]\(b\)" in line


def test_wrong_use_is_told_before_anything_is_judged(tmp_path: Path) -> None:
    """No folder, no such exercise, a table of no known kind, nobody handed in."""
    run = CliRunner()
    for words, told in (
        (["nowhere"], "there is no folder"),
        ([str(tmp_path), "-e", "99"], "there is no exercise 99"),
        ([str(tmp_path), "-o", "table.xls"], "ends in neither"),
        ([str(tmp_path)], "holds no submission"),
    ):
        came = run.invoke(app, ["submissions", *words])
        assert came.exit_code == 2, came.output
        assert told in came.output.replace("\n", " ")
