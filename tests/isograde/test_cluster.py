"""Cases judged by the workers of a dask cluster: the verdicts of this machine, whoever dies."""

import io
import subprocess
import sys
from pathlib import Path
from typing import Any

import psutil
import pytest
from isograde import cluster
from isograde.cluster import Judge
from isograde.command import app
from isograde.commands import grading
from isograde.model import AdapterError, Limits
from isograde.report import reading
from isograde.runner import Options, Task, Worker, run
from typer.testing import CliRunner

TASKS = [Task(f"pairs/02{n}", ("topology.closed", "topology.manifold")) for n in range(10, 22)]
FLAWED = "isoref:lorensen-cline"
# Kills the worker of dask above its judge, once.
KILLING = """
import os, pathlib, signal
import isoref, psutil

flag = pathlib.Path(__file__).with_name("kill")


def extract(values, isovalue, spacing):
    try:
        flag.unlink()
    except FileNotFoundError:
        pass
    else:
        os.kill(psutil.Process().parent().ppid(), signal.SIGKILL)
    mesh = isoref.extract(values, isovalue, spacing)
    return mesh.vertices, mesh.simplices
"""


def test_a_judge_answers_as_a_worker_of_this_process_does() -> None:
    """In a process of its own, portion after portion, until it is closed."""
    options = Options(limits=Limits(20.0))
    worker = Worker.open(FLAWED, options)
    right = list(run(FLAWED, TASKS, options, worker))
    worker.adapter.close()
    judge = Judge(FLAWED, options, ".")
    found = judge.judged(TASKS[:5]) + judge.judged(TASKS[5:])
    judge.close()
    assert judge.process.returncode == 0
    assert [(one.case, one.findings) for one in found] == [
        (one.case, one.findings) for one in right
    ]
    assert any(one.findings["topology.closed"].verdict == "fail" for one in found)


def test_what_keeps_a_judge_from_its_work_is_raised_where_it_was_asked() -> None:
    """An implementation that does not start, a case that there is not, an end without a word."""
    before = set(psutil.Process().children())
    with pytest.raises(AdapterError, match="nowhere"):
        Judge("python:nowhere:extract", Options(), ".")
    assert set(psutil.Process().children()) <= before  # It is gone with its pipes.
    judge = Judge(FLAWED, Options(), "no such folder")
    with pytest.raises(KeyError, match="no/such/case"):
        judge.judged([Task("no/such/case", ("topology.closed",))])
    assert len(judge.judged(TASKS[:1])) == 1
    judge.process.kill()
    with pytest.raises((EOFError, BrokenPipeError)):
        judge.judged(TASKS[:1])
    judge.close()


def test_messages_are_whole_or_none() -> None:
    stream = io.BytesIO()
    cluster._write(stream, {"a": [1, None]})
    whole = stream.getvalue()
    assert cluster._read(io.BytesIO(whole)) == {"a": [1, None]}
    with pytest.raises(EOFError):
        cluster._read(io.BytesIO(whole[:3]))


def test_judges_are_used_again_and_gone_when_their_run_is_over() -> None:
    """As the functions of a worker do it; one that comes back too late is closed at once."""
    cluster.judged_there("one run", FLAWED, Options(), ".", TASKS[:1])
    idle = cluster._IDLE["one run"]
    assert idle is not None
    (judge,) = idle
    cluster.judged_there("one run", FLAWED, Options(), ".", TASKS[1:2])
    assert cluster._IDLE["one run"] == [judge]
    cluster.release("one run")
    assert judge.process.returncode == 0
    assert cluster._IDLE["one run"] is None


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_a_cluster_gives_the_verdicts_of_this_machine(
    client: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The lines of all reports are the same, but for times, and for what says how it was run."""
    names = [FLAWED, "isoref:asymptotic-decider"]
    monkeypatch.setattr(grading, "ready_made_names", lambda: names)
    words = ["grade", "--all", "--only", "pairs/021*", "--format", "md"]
    address = client.scheduler.address
    here = CliRunner().invoke(app, [*words, "--out", str(tmp_path / "here")])
    there = CliRunner().invoke(app, [*words, "--out", str(tmp_path / "there"), "--dask", address])
    assert (here.exit_code, there.exit_code) == (1, 1), there.output

    def judged(folder: str, name: str) -> tuple[list[Any], list[Any]]:
        found = reading.read(tmp_path / folder / f"{name.replace(':', '-')}.jsonl.gz")
        claims = [(one.id, one.state, one.failure) for one in found.summaries.values()]
        return [{**one, "seconds": 0} for one in found.results], claims

    for name in names:
        own, other = judged("here", name), judged("there", name)
        assert len(own[0]) > 2
        assert other == own
    idle = client.run(lambda: __import__("isograde.cluster").cluster._IDLE)
    assert len(idle) == 2
    assert all(set(one.values()) == {None} for one in idle.values())


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_a_killed_worker_costs_time_and_nothing_else(client: Any, tmp_path: Path) -> None:
    """Issue "Faster than every library": its cases are judged by another."""
    file = tmp_path / "killing.py"
    file.write_text(KILLING, encoding="utf-8")
    (tmp_path / "kill").touch()
    options = Options(dask=client.scheduler.address, limits=Limits(20.0))
    before = set(client.scheduler_info()["workers"])
    found = list(cluster.run(f"python:{file}:extract", TASKS, options))
    assert not (tmp_path / "kill").exists()
    assert set(client.scheduler_info()["workers"]) != before
    assert [one.case for one in found] == [task.case for task in TASKS]
    assert all(str(one.verdict) == "pass" for case in found for one in case.findings.values())


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_what_does_not_start_is_raised_here(client: Any) -> None:
    """On a worker it is what it is here; nothing is asked of nobody."""
    options = Options(dask=client.scheduler.address)
    with pytest.raises(AdapterError, match="nowhere"):
        list(cluster.run("python:nowhere:extract", TASKS[:1], options))
    assert list(cluster.run(FLAWED, [], options)) == []


@pytest.mark.slow
def test_nobody_at_an_address_is_wrong_use(tmp_path: Path) -> None:
    """Told in one sentence, before anything is judged.

    In a process of its own: a client that finds nobody leaves a loop behind, in which no cluster
    begins.
    """
    pytest.importorskip("distributed")
    words = ["grade", FLAWED, "--only", "pairs/021*", "--out", str(tmp_path), "--dask", "nowhere"]
    done = subprocess.run(
        [sys.executable, "-m", "isograde", *words],
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    assert done.returncode == 2, done.stderr
    assert "no dask scheduler answers at nowhere" in " ".join(done.stderr.split())
