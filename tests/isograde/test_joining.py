"""Parts of a run join to the report of the whole, and nothing else joins."""

from pathlib import Path
from typing import Any

import pytest
from isograde.command import app
from isograde.grading import grade
from isograde.report import reading
from isograde.report.joining import JoinError, join
from isograde.runner import Options
from typer.testing import CliRunner

FLAWED = "isoref:lorensen-cline"
ONLY = ("pairs/02*", "ties/noise-0*", "topology.*")
PARTS = 3


def graded(folder: Path, name: str, shard: tuple[int, int] | None, **more: Any) -> Path:
    """The path of the report of one part."""
    path = folder / f"{name}.jsonl"
    grade(FLAWED, Options(only=more.pop("only", ONLY), shard=shard, **more), path)
    return path


@pytest.fixture(scope="module")
def parts(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """The reports of three parts of a run."""
    folder = tmp_path_factory.mktemp("parts")
    return [graded(folder, str(i), (i, PARTS)) for i in range(1, PARTS + 1)]


def timeless(report: reading.Report) -> list[Any]:
    """The records of a report without its date, its times and who asked how."""
    apart = {"date", "seconds", "spent", "jobs", "arguments"}
    found = [{k: v for k, v in one.items() if k not in apart} for one in report.records]
    return sorted(found, key=lambda one: (one["record"], str(one.get("claim"))))


def test_the_joined_report_is_that_of_the_whole(parts: list[Path], tmp_path: Path) -> None:
    whole = reading.read(graded(tmp_path, "whole", None))
    found = [reading.read(path) for path in parts]
    assert [len(one.results) for one in found] == [9, 9, 8]
    assert all(one.partial for one in found)
    for order in ([0, 1, 2], [2, 0, 1]):
        joined = join([found[i] for i in order], list("abc"))
        assert [r["case"] for r in joined.results] == [r["case"] for r in whole.results]
        assert timeless(joined) == timeless(whole)
        footers = [one.footer or {} for one in (joined, *found)]
        inside = [one["spent"]["implementation"] for one in footers]
        assert inside[0] == pytest.approx(sum(inside[1:]))


def test_a_part_alone_reaches_no_level(parts: list[Path]) -> None:
    assert reading.read(parts[0]).reached is None


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda head: head.pop("shard"), "is no part of a run"),
        (lambda head: head.update(spec="isoref:trilinear-cubes"), "differ in the implementation"),
        (lambda head: head.update(seed=1), "differ in the seed"),
        (lambda head: head.update(tasks="0"), "not parts of one plan"),
        (lambda head: head["shard"].update(of=4), "different numbers of parts"),
        (lambda head: head.update(fingerprint="0"), "differ in the implementation's file"),
        (lambda head: head["shard"].update(part=1), "part 2 of 3 is missing; part 1 is there more"),
        (lambda head: head["versions"].update(numpy="0"), "differ in the versions"),
        (lambda head: head.update(expected={"topology.closed": {}}), "differ in the expected"),
    ],
)
def test_what_is_no_part_of_the_same_run_does_not_join(
    parts: list[Path], change: Any, message: str
) -> None:
    found = [reading.read(path) for path in parts]
    change(found[1].header)
    with pytest.raises(JoinError, match=message):
        join(found, ["one", "two", "three"])


def test_a_part_that_is_missing_or_cut_off_is_told(parts: list[Path]) -> None:
    found = [reading.read(path) for path in parts]
    with pytest.raises(JoinError, match="part 3 of 3 is missing"):
        join(found[:2], ["one", "two"])
    found[0].footer = None
    with pytest.raises(JoinError, match="one was cut off"):
        join(found, ["one", "two", "three"])


def test_the_command_joins_and_ends_with_the_status_of_the_whole(
    parts: list[Path], tmp_path: Path
) -> None:
    runner = CliRunner()
    arguments = ["join", *map(str, parts), "--out", str(tmp_path), "--format", "md"]
    result = runner.invoke(app, arguments)
    assert result.exit_code == 1, result.output
    assert "topology.closed" in (tmp_path / "report.md").read_text(encoding="utf-8")
    assert not reading.read(tmp_path / "report.jsonl").header.get("shard")
    less = runner.invoke(app, ["join", str(parts[0]), "--out", str(tmp_path)])
    assert less.exit_code == 2
    assert "part 2 of 3 is missing" in less.output
    for said in ("0/3", "4/3", "3", "a/b", "1/0"):
        wrong = runner.invoke(app, ["grade", FLAWED, "--shard", said])
        assert wrong.exit_code == 2
        assert "--shard" in wrong.output
