"""A run that was killed goes on where it was, and two at once spoil nothing (issue 13)."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from isograde import grading
from isograde.cases import PLAN
from isograde.declaration import declaration_from
from isograde.drafts import Busy, Draft, NotResumed, fingerprint, unfinished
from isograde.grading import INTERRUPTED, Manner, grade, place_of
from isograde.report import reading
from isograde.report.lines import lines
from isograde.runner import Options, Task, cases_for, claims_for, plan

HEADER = {"record": "header", "format": 2, "seed": 0}
SPEC = "isoref:asymptotic-decider"
ONLY = Options(only=("cells/outside/0[0-3]?", "topology.closed", "topology.sides"))
FAULTY = Path(__file__).with_name("miniatures.py")


def plain(path: Path) -> list[dict[str, Any]]:
    """The lines of a report without what may differ between two runs: seconds and the date."""
    kept = []
    for one in lines(path):
        for name in ("seconds", "spent", "date", "arguments", "jobs"):
            one.pop(name, None)
        kept.append(one)
    return kept


@pytest.fixture(scope="module")
def broken(tmp_path_factory: pytest.TempPathFactory) -> str:
    """An implementation that fails many claims: a triangle is always lost."""
    place = tmp_path_factory.mktemp("broken") / "lossy.py"
    place.write_text(
        "from isoref import extract as reference\n\n\n"
        "def lossy(values, isovalue, spacing):\n"
        "    mesh = reference(values, isovalue, spacing)\n"
        "    return mesh.vertices, mesh.simplices[1:]\n"
    )
    return f"python:{place}:lossy"


@pytest.fixture(scope="module")
def whole(broken: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of a run that nothing stopped."""
    path = tmp_path_factory.mktemp("whole") / "report.jsonl"
    grade(broken, ONLY, path)
    return path


@pytest.fixture(scope="module")
def draft(broken: str, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """What a run leaves that was interrupted after thirty cases."""
    path = tmp_path_factory.mktemp("draft") / "report.jsonl"
    with pytest.raises(KeyboardInterrupt):
        grade(broken, ONLY, path, watch=stop_after(30))
    return unfinished(path).read_bytes()


def stop_after(count: int) -> grading.Watch:
    """What presses Ctrl-C after so many cases."""

    def watch(done: int, total: int, tally: Any) -> None:
        del total, tally
        if done == count:
            raise KeyboardInterrupt

    return watch


def test_a_run_that_was_interrupted_goes_on_where_it_was(
    broken: str, whole: Path, tmp_path: Path
) -> None:
    path, said = tmp_path / "report.jsonl", list[str]()
    with pytest.raises(KeyboardInterrupt):
        grade(broken, ONLY, path, watch=stop_after(17))
    assert not path.exists()
    assert sum(one["record"] == "result" for one in lines(unfinished(path))) == 17
    grade(broken, ONLY, path, say=said.append)
    assert said == ["17 of 40 cases were judged before; --fresh judges all again"]
    assert plain(path) == plain(whole)
    assert sorted(os.listdir(tmp_path)) == ["report.jsonl"]


@pytest.mark.parametrize("cut", [0, 1, 100, 5_000, -1, -2, -40, -400])
def test_a_draft_cut_off_anywhere_is_gone_on_with(
    cut: int, broken: str, whole: Path, draft: bytes, tmp_path: Path
) -> None:
    """As a process leaves it that is killed while it writes."""
    path, said = tmp_path / "report.jsonl", list[str]()
    unfinished(path).write_bytes(draft[:cut])
    grade(broken, ONLY, path, say=said.append)
    assert any("were judged before" in one for one in said) == (cut not in (0, 1, 100))
    assert plain(path) == plain(whole)


@pytest.fixture(scope="module")
def outside(broken: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report on every cell outside of which all is low, of a run that nothing stopped."""
    path = tmp_path_factory.mktemp("outside") / "report.jsonl"
    grade(broken, Options(only=("cells/outside/*", *ONLY.only[1:])), path)
    return path


@pytest.mark.slow
@pytest.mark.parametrize("jobs", [1, 2])
def test_a_run_killed_at_random_moments_ends_with_the_same_report(
    jobs: int, broken: str, outside: Path, tmp_path: Path
) -> None:
    """SIGKILL, again and again, until it is through; then nothing is left behind."""
    draw = random.Random(jobs)
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    out = tmp_path / "killed"
    only = ["--only", "cells/outside/*", "--only", "topology.closed", "--only", "topology.sides"]
    command = [sys.executable, "-m", "isograde.command", "grade", broken, *only]
    command += ["--jobs", str(jobs), "--format", "md", "--out"]
    environment = {**os.environ, "TMPDIR": str(temporary)}
    draft = out / "unfinished-report.jsonl"

    def judged() -> int:
        return draft.read_bytes().count(b'"record":"result"') if draft.exists() else 0

    seen = []
    for _ in range(2):
        goal = judged() + draw.randint(1, 50)
        running = subprocess.Popen([*command, str(out)], env=environment, stderr=subprocess.PIPE)
        while running.poll() is None and judged() < goal:
            time.sleep(0.005)
        time.sleep(draw.uniform(0.0, 0.3))
        through = running.poll() is not None
        running.kill()
        running.communicate()
        if through or not draft.exists():
            break
        seen.append(judged())
    assert seen
    assert seen == sorted(seen)
    subprocess.run([*command, str(out)], env=environment, check=False)
    assert plain(out / "report.jsonl") == plain(outside)
    assert sorted(os.listdir(out)) == ["report.jsonl", "report.md"]
    deadline = time.monotonic() + 20
    while os.listdir(temporary) and time.monotonic() < deadline:
        time.sleep(0.2)
    assert os.listdir(temporary) == []


def test_another_run_is_not_gone_on_with(broken: str, tmp_path: Path) -> None:
    """Another seed, another file: the draft is of something else."""
    path = tmp_path / "report.jsonl"
    with pytest.raises(KeyboardInterrupt):
        grade(broken, ONLY, path, watch=stop_after(5))
    other = Options(seed=1, only=ONLY.only)
    with pytest.raises(NotResumed, match="seed changed"):
        grade(broken, other, path, resume=True)
    script = Path(broken.split(":")[1])
    text = script.read_text(encoding="utf-8")
    script.write_text(f"{text}# changed\n", encoding="utf-8")
    try:
        with pytest.raises(
            NotResumed, match="the implementation's files, or those of the cases, changed"
        ):
            grade(broken, ONLY, path, resume=True)
    finally:
        script.write_text(text, encoding="utf-8")
    with pytest.raises(KeyboardInterrupt):
        grade(broken, ONLY, path, resume=True, watch=stop_after(6))
    assert sum(one["record"] == "result" for one in lines(unfinished(path))) == 6
    with pytest.raises(KeyboardInterrupt):
        grade(broken, ONLY, path, resume=False, watch=stop_after(2))
    assert sum(one["record"] == "result" for one in lines(unfinished(path))) == 2


def test_cases_of_the_users_own_are_part_of_what_is_gone_on_with(tmp_path: Path) -> None:
    """What was judged on other samples under the same ids is not taken over."""
    mine = tmp_path / "mine.json"
    mine.write_text("[1]", encoding="utf-8")
    before = fingerprint("skimage:lewiner", [mine])
    assert before != fingerprint("skimage:lewiner")
    mine.write_text("[2]", encoding="utf-8")
    assert fingerprint("skimage:lewiner", [mine]) != before


def test_there_is_nothing_to_insist_on(broken: str, tmp_path: Path) -> None:
    with pytest.raises(NotResumed, match="there is no unfinished run"):
        grade(broken, ONLY, tmp_path / "report.jsonl", resume=True)


def test_two_processes_cannot_grade_into_one_place(tmp_path: Path) -> None:
    path = tmp_path / "report.jsonl"
    with Draft.of(path, [HEADER], None) as draft:
        with (
            pytest.raises(Busy, match="another process is grading"),
            Draft.of(path, [HEADER], None),
        ):
            pass
        draft.remove()
    with Draft.of(path, [HEADER], None):
        assert unfinished(path).exists()


def test_the_lock_of_a_process_that_was_killed_is_gone(tmp_path: Path) -> None:
    program = (
        "import sys, time; from pathlib import Path; from isograde.drafts import Draft\n"
        f"with Draft.of(Path({str(tmp_path / 'report.jsonl')!r}), [{HEADER!r}], None):\n"
        "    print('locked', flush=True); time.sleep(60)"
    )
    running = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, encoding="utf-8"
    )
    assert running.stdout is not None
    assert running.stdout.readline() == "locked\n"
    with pytest.raises(Busy), Draft.of(tmp_path / "report.jsonl", [HEADER], None):
        pass
    running.send_signal(signal.SIGKILL)
    running.communicate()
    with Draft.of(tmp_path / "report.jsonl", [HEADER], None):
        pass


def test_a_budget_leaves_a_report_of_a_part_and_the_rest_for_later(
    broken: str, whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Issue 12: a page from what was judged so far."""
    path = tmp_path / "report.jsonl"
    monkeypatch.setattr(grading, "SHARE", 1.0)  # Used up after the first case.
    found = grade(broken, Options(only=ONLY.only, budget=60.0), path)
    assert found.stopped == {"why": "the budget of 60 s is used up", "left": 39}
    assert found.partial
    assert reading.read(path).stopped == found.stopped
    monkeypatch.undo()
    grade(broken, Options(only=ONLY.only, budget=600.0), path)
    assert plain(path) == plain(whole)


def test_a_budget_is_kept_by_what_is_made_of_failures_too(
    broken: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A case that takes long to be made smaller is shown as it is."""

    def slow(*_: object) -> None:
        time.sleep(300)

    monkeypatch.setattr(grading, "shrink", slow)
    monkeypatch.setattr(grading, "contrast", slow)
    start = time.monotonic()
    found = grade(broken, Options(only=ONLY.only, budget=5.0), tmp_path / "report.jsonl")
    assert time.monotonic() - start < 120
    assert "topology.closed" in found.evidence


def test_a_part_within_a_budget_is_of_every_family() -> None:
    tasks = [Task(f"{family}/{n}", ()) for family in "abc" for n in range(3)]
    assert [one.case for one in grading.spread(tasks, lambda _: 1)[:3]] == ["a/0", "b/0", "c/0"]


def test_a_budget_is_not_spent_on_large_cases_first() -> None:
    """A new user's 25 seconds judged 6 cases of 1,785, the first of them a mosaic."""
    declared = declaration_from({"name": "any"}, "any")
    cases = cases_for(declared, 0)
    tasks = plan(Options(), cases, claims_for(declared))
    order = grading.spread(tasks, lambda case: cases[case].samples)
    assert sorted(one.case for one in order) == sorted(one.case for one in tasks)
    begun = [one.case for one in order[:300]]
    assert sum(cases[case].samples for case in begun) < 100 * len(begun)
    assert len({case.split("/")[0] for case in begun}) > 5


def test_what_ctrl_c_leaves_replaces_no_whole_report(broken: str, tmp_path: Path) -> None:
    path = tmp_path / "report.jsonl"
    grade(broken, ONLY, path)
    before = path.read_bytes()
    worker_of = Manner(watch=stop_after(9), interruptible=True)
    found = grade(broken, ONLY, path, watch=worker_of.watch, interruptible=True)
    assert found.stopped == {"why": INTERRUPTED, "left": 31}
    assert place_of(path, found).name == "interrupted-report.jsonl"
    assert reading.read(place_of(path, found)).stopped == found.stopped
    assert path.read_bytes() == before


def test_files_that_an_implementation_is_in_are_known(tmp_path: Path) -> None:
    """A changed file is another implementation."""
    script = tmp_path / "mine.py"
    script.write_text("one")
    specs = [f"python:{script}:f", f"exec:{sys.executable} {script}", f"dir:{tmp_path}"]
    before = [fingerprint(spec) for spec in specs]
    assert all(before)
    script.write_text("two")
    assert all(fingerprint(spec) != was for spec, was in zip(specs, before, strict=True))
    assert fingerprint("python:json.decoder:JSONDecoder")
    assert fingerprint("skimage:lewiner") == fingerprint("exec:'") == ""


def test_a_draft_is_read_as_a_report_that_was_cut_off(broken: str, tmp_path: Path) -> None:
    path = tmp_path / "report.jsonl"
    with pytest.raises(KeyboardInterrupt):
        grade(broken, ONLY, path, watch=stop_after(3))
    found = reading.read(unfinished(path))
    assert found.footer is None
    assert len(found.results) == 3
    assert json.loads(unfinished(path).read_text().splitlines()[0])["plan"] == PLAN
