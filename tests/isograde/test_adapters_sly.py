"""What attacks the grader gets its verdict; nothing outside its folder is touched (issue 13)."""

import contextlib
import json
import os
import signal
import time
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
from isograde import bounds
from isograde.adapters import exchange, open_adapter
from isograde.adapters.exchange import Exchange, TemporaryFull
from isograde.adapters.python import PythonAdapter
from isograde.adapters.texts import clean
from isograde.cases import all_cases
from isograde.model import Limits, Outcome, Request, Status, Verdict
from isograde.report.junit import junit
from isograde.report.markdown import markdown
from isograde.report.page import page
from isograde.runner import Options, Task, Worker
from isoref.field import Field

from tests.isograde import sly

SLY = Path(sly.__file__)
FIELD = Field.of(np.arange(8.0).reshape(2, 2, 2))
SOUND = {
    "runs_on", "links_in_folder", "spoofs_endless_seconds", "spoofs_negative_peak",
    "spoofs_list_detail", "patches_memory", "patches_sizes", "appends_to_shared", "scribbles",
}  # fmt: skip
ENDS = {
    "long_error": (Status.RAISED, "(30,000,000 characters)"),
    "unfit_error": (Status.RAISED, "\\ud800 \\x00 \\x1b[31m"),
    "unfit_decline": (Status.DECLINED, "(2,000,000 characters)"),
    "removes_folder": (Status.GARBAGE, "removed the folder"),
    "replaces_folder": (Status.GARBAGE, "put another in its place"),
    "cuts_shared_short": (Status.GARBAGE, "shared memory ends"),
    "closes_shared": (Status.GARBAGE, "Bad file descriptor"),
    "header_beyond": (Status.GARBAGE, "shared memory ends"),
    "header_shared_object": (Status.GARBAGE, "no numbers"),
    "header_bytes_huge": (Status.MEMORY, "absurd"),
}


def outcomes(name: str) -> list[Outcome]:
    """Before, while and after it attacks."""
    adapter = open_adapter(f"python:{SLY}:{name}")
    adapter.open(Limits(seconds=20.0, megabytes=400))
    try:
        return [adapter.run(Request("test", "plain", FIELD, (x,))) for x in (1.5, 0.5, 1.5)]
    finally:
        adapter.close()


@pytest.mark.parametrize("name", sorted(sly.ATTACKS))
def test_an_attack_costs_the_call_in_which_it_is_made(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It gets a verdict, the next call is sound, and what is not ours is not touched."""
    precious = tmp_path / "precious"
    precious.mkdir()
    (precious / "work.txt").write_text("years of it")
    monkeypatch.setenv("PRECIOUS", str(precious))
    before, bad, after = outcomes(name)
    assert before.status is Status.OK, before.detail
    status, word = ENDS.get(name, (None, ""))
    if name in SOUND:
        assert bad.status is Status.OK, bad.detail
    elif status is None:
        assert bad.status in (Status.GARBAGE, Status.CRASH, Status.RAISED), bad
    else:
        assert bad.status is status, bad.detail
    assert word in bad.detail
    assert len(bad.detail) < 3000
    bad.detail.encode()
    assert after.status is Status.OK or name.startswith(("spoofs", "header", "patches"))
    assert (precious / "work.txt").read_text() == "years of it"


def test_children_with_sessions_of_their_own_are_ended() -> None:
    before = {one.pid for one in psutil.process_iter()}
    adapter = open_adapter(f"python:{SLY}:runs_on")
    adapter.open(Limits(seconds=20.0, megabytes=400))
    assert adapter.run(Request("test", "plain", FIELD, (0.5,))).status is Status.OK
    # A child that was forked a moment ago may not be what it will be yet.
    deadline = time.monotonic() + 10
    mine: list[psutil.Process] = []
    while not mine and time.monotonic() < deadline:
        mine = [
            one
            for one in psutil.process_iter()
            if one.pid not in before and "time.sleep(61)" in " ".join(one.cmdline())
        ]
    assert len(mine) == 1
    adapter.close()
    gone, alive = psutil.wait_procs(mine, timeout=5)
    assert gone
    assert not alive


def test_a_folder_that_was_replaced_is_left_alone(tmp_path: Path) -> None:
    folder = Exchange()
    (folder.path / "file").write_text("x")
    folder.empty()
    assert list(folder.path.iterdir()) == []
    precious = tmp_path / "precious"
    precious.mkdir()
    (precious / "file").write_text("x")
    first = folder.path
    first.rmdir()
    first.symlink_to(precious)
    folder.empty()
    assert (precious / "file").exists()
    assert not folder.intact()
    assert folder.path != first
    assert folder.intact()
    first.unlink()


def test_a_full_temporary_folder_is_called_that(monkeypatch: pytest.MonkeyPatch) -> None:
    """By the grader's own writing, and where an implementation fails for want of space."""
    adapter = PythonAdapter(f"python:{SLY}:long_error")
    adapter.open(Limits(seconds=20.0, megabytes=400))
    large = Field.of(np.zeros((30, 30, 30)))

    def full(*_: Any, **__: Any) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(os, "pwrite", full)
        with pytest.raises(TemporaryFull, match="is full: free some space, or set TMPDIR"):
            adapter.run(Request("test", "plain", large, (1.5,)))
    monkeypatch.setattr(exchange.Exchange, "full", lambda self: True)
    with pytest.raises(TemporaryFull, match="is full"):
        adapter.run(Request("test", "plain", FIELD, (0.5,)))
    adapter.close()


def test_memory_that_can_no_longer_be_written_costs_the_worker(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It is one of the two that have it open; the next worker is given other memory."""
    adapter = PythonAdapter(f"python:{SLY}:long_error")
    adapter.open(Limits(seconds=20.0, megabytes=400))
    large = Request("test", "plain", Field.of(np.zeros((30, 30, 30))), (1.5,))

    def refused(*_: Any) -> None:
        raise PermissionError(1, "Operation not permitted")

    with monkeypatch.context() as patch:
        patch.setattr(os, "pwrite", refused)
        bad = adapter.run(large)
    assert (bad.status, "cannot be written" in bad.detail) == (Status.GARBAGE, True), bad.detail
    assert adapter.run(large).status is Status.OK
    adapter.close()


def test_a_killed_worker_leaves_no_memory_behind() -> None:
    """Descriptors of this process, after many deaths: as many as before."""
    adapter = PythonAdapter(f"python:{SLY}:long_error")
    adapter.open(Limits(seconds=20.0, megabytes=400))
    large = Request("test", "plain", Field.of(np.zeros((30, 30, 30))), (1.5,))
    open_ = psutil.Process().num_fds()
    for _ in range(3):
        assert adapter._child is not None
        adapter._child.process.kill()
        assert adapter.run(large).status is Status.CRASH
        assert adapter.run(large).status is Status.OK
        assert psutil.Process().num_fds() == open_
    adapter.close()
    assert psutil.Process().num_fds() < open_


def test_what_came_is_not_changed_any_more() -> None:
    """The implementation writes over the shared answer for ever; what was read is a copy."""
    adapter = open_adapter(f"python:{SLY}:scribbles")
    adapter.open(Limits(seconds=20.0, megabytes=400))
    came = adapter.run(Request("test", "plain", FIELD, (0.5,))).vertices
    assert came is not None
    before = came.copy()
    time.sleep(0.1)
    assert np.array_equal(came, before, equal_nan=True)
    adapter.close()


@pytest.mark.parametrize(
    ("vertices", "rows", "words"),
    [
        (2_000_000, 1, "2,000,000 vertices for 64 samples"),
        (3, 1_000_000, "1,000,000 simplices for 64 samples"),
    ],
)
def test_judging_has_limits_and_says_which_it_hit(vertices: int, rows: int, words: str) -> None:
    """Two million unused vertices, a soup of a million triangles: structure alone is judged."""

    class Huge:
        def run(self, request: Request) -> Outcome:
            points = np.zeros((vertices, 3))
            points[1:3] = [[1, 0, 0], [0, 1, 0]]
            return Outcome(Status.OK, points, np.tile([[0, 1, 2]], (rows, 1)))

    cases = all_cases(0)
    options = Options()
    worker = Worker.open("isoref:asymptotic-decider", options)
    worker.adapter.close()
    worker.adapter = Huge()  # type: ignore[assignment]
    start = time.monotonic()
    claims = tuple(
        n for n, one in worker.claims.items() if one.applies_to(cases["cells/outside/001"])
    )
    found = worker.judge(Task("cells/outside/001", claims)).findings
    assert time.monotonic() - start < 60
    told = [one.detail for one in found.values() if one.verdict is Verdict.NOT_RUN]
    assert any(words in one for one in told), told
    assert any(one.verdict is Verdict.FAIL for one in found.values())


def test_a_claim_that_takes_too_long_is_given_up() -> None:
    def endless() -> None:
        while True:
            time.sleep(0.01)

    with pytest.raises(bounds.GivenUp, match=r"more than 0\.1 s"), bounds.at_most(0.1):
        endless()
    with bounds.at_most(0.1):
        pass


def test_of_two_limits_the_first_that_is_over_counts() -> None:
    """And who takes it for another's is told again."""

    def patient() -> None:
        for _ in range(100):
            with contextlib.suppress(bounds.GivenUp), bounds.at_most(60.0):
                time.sleep(0.05)
            time.sleep(0.05)

    with pytest.raises(bounds.GivenUp, match=r"0\.2 s"), bounds.at_most(0.2):
        patient()
    with pytest.raises(bounds.GivenUp, match=r"0\.1 s"), bounds.at_most(60.0), bounds.at_most(0.1):
        time.sleep(5)
    with bounds.at_most(60.0):
        pass


def test_somebody_elses_clock_goes_on_after_ours() -> None:
    """It rings no earlier than it would, and to whom it would."""
    rung: list[int] = []
    before = signal.signal(signal.SIGALRM, lambda number, _: rung.append(number))
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        with bounds.hearing(0.01), bounds.at_most(60.0):
            time.sleep(0.05)
        assert not rung
        time.sleep(0.2)
        assert rung == [signal.SIGALRM]
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def test_no_text_of_an_implementation_breaks_a_report(tmp_path: Path) -> None:
    """JUnit stays XML, the page and Markdown escape everything, lines stay JSON."""
    from isograde.grading import grade

    script = tmp_path / "loud.py"
    script.write_text(
        "TEXT = '\\ud800 \\x00 \\x1b ]]> </script><script>alert(1)</script> | `x` \\u202e' * 200\n"
        "def loud(values, isovalue, spacing):\n    raise ValueError(TEXT)\n"
        "loud.declaration = {'name': TEXT, 'version': '<u>' + TEXT, 'notes': TEXT}\n"
    )
    path = tmp_path / "report.jsonl"
    report = grade(f"python:{script}:loud", Options(only=("cells/outside/00?",)), path)
    for line in path.read_text(encoding="utf-8").splitlines():
        json.loads(line)
    ElementTree.fromstring(junit(report))
    html = page(report)
    assert "<script>alert" not in html
    assert "<u>" not in html
    assert "<script>alert" not in markdown(report)
    for text in (html, markdown(report), junit(report)):
        text.encode("utf-8")
        assert "\x1b" not in text
        assert "\u202e" not in text
    assert len(report.name) < 200


def test_a_text_is_cut_and_spelt_out() -> None:
    assert clean("a\tb\nc") == "a\tb\nc"
    assert clean("\x00\x7f\u2028\ufffe\udfff") == "\\x00\\x7f\\u2028\\ufffe\\udfff"
    assert clean("é" * 10, 4) == "éééé.. (10 characters)"
