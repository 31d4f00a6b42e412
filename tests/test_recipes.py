"""The recipes for continuous integration: their very steps, run in a folder as a runner would."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

RECIPES = Path(__file__).parent.parent / "docs" / "ci"
MINE = """
from isoref import extract as reference

def extract(values, isovalue, spacing):
    mesh = reference(values, isovalue, spacing, method="{method}")
    return mesh.vertices, mesh.simplices
"""
KNOWN = '["{claim}"]\nreason = "the flaw of 1987"\ncases = ["*"]\n'
# A part of the plan, so that a round takes seconds: what a runner's copy of the recipe leaves out.
PART = ' --only "pairs/02*" --only "topology.*" --out'


def recipe(name: str) -> Any:
    """A recipe as it stands."""
    return yaml.safe_load((RECIPES / name).read_text(encoding="utf-8"))


@pytest.fixture
def runner(tmp_path: Path) -> Any:
    """A function that runs lines of a recipe in a project's folder: their status and output."""
    tools = tmp_path / "tools"
    tools.mkdir()
    (tools / "pip").write_text('#!/bin/sh\necho "pip $@"\n', encoding="utf-8")
    program = f'#!/bin/sh\nexec {sys.executable} -m isograde "$@"\n'
    (tools / "isograde").write_text(program, encoding="utf-8")
    for tool in tools.iterdir():
        tool.chmod(0o755)
    work = tmp_path / "work"
    work.mkdir()
    known = KNOWN.format(claim="topology.closed") + KNOWN.format(claim="topology.manifold")
    (work / "known-failures.toml").write_text(known, encoding="utf-8")

    def run(line: str, **more: str) -> subprocess.CompletedProcess[str]:
        path = f"{tools}{os.pathsep}{os.environ['PATH']}"
        there = {**os.environ, "PATH": path, "IMPLEMENTATION": "python:mine:extract", **more}
        line = line.replace(" --out", PART) if "isograde grade" in line else line
        command = ["bash", "-e", "-o", "pipefail", "-c", line]
        return subprocess.run(
            command, cwd=work, env=there, capture_output=True, encoding="utf-8", check=False
        )

    return run, work


@pytest.mark.slow
def test_the_steps_of_github_go_green_and_red(runner: Any) -> None:
    """Known failures are green; an extractor that gains a third is red, twice over."""
    run, work = runner
    job = recipe("github-actions.yml")["jobs"]["grade"]
    steps = {step["name"]: step["run"] for step in job["steps"] if "run" in step}
    assert list(steps) == ["install", "grade", "summary", "nothing broke", "keep it for the next"]
    (work / "mine.py").write_text(MINE.format(method="lorensen-cline"), encoding="utf-8")
    summary = {"GITHUB_STEP_SUMMARY": str(work / "summary.md")}
    for name, line in steps.items():
        done = run(line, **summary)
        assert done.returncode == 0, (name, done.stdout, done.stderr)
    assert "lorensen" in (work / "summary.md").read_text(encoding="utf-8") or (
        "topology" in (work / "summary.md").read_text(encoding="utf-8")
    )
    assert (work / "main-report" / "report.jsonl").is_file()
    # Turn the triangles over: the sides are wrong, which no list expects.
    text = MINE.format(method="lorensen-cline").replace("mesh.simplices", "mesh.simplices[:, ::-1]")
    (work / "mine.py").write_text(text, encoding="utf-8")
    red = run(steps["grade"])
    assert red.returncode == 1
    assert "not expected: topology.sides" in red.stdout
    gate = run(steps["nothing broke"])
    assert gate.returncode == 1
    assert "topology.sides" in gate.stdout


@pytest.mark.slow
def test_the_script_of_gitlab_shares_the_cases_and_joins(runner: Any) -> None:
    run, work = runner
    jobs = recipe("gitlab-ci.yml")
    (work / "mine.py").write_text(MINE.format(method="lorensen-cline"), encoding="utf-8")
    total = jobs["part"]["parallel"]
    for index in range(1, total + 1):
        for line in jobs["part"]["script"]:
            done = run(line, CI_NODE_INDEX=str(index), CI_NODE_TOTAL=str(total))
            assert done.returncode == 0, (line, done.stdout, done.stderr)
    for line in jobs["whole"]["script"]:
        done = run(line)
        assert done.returncode == 0, (line, done.stdout, done.stderr)
    report = work / jobs["whole"]["artifacts"]["reports"]["junit"]
    assert "expected to fail: the flaw of 1987" in report.read_text(encoding="utf-8")


def test_the_recipes_name_only_options_that_there_are() -> None:
    """Each isograde line of a recipe is understood, option by option, by the command's help."""
    lines = [
        step["run"]
        for step in recipe("github-actions.yml")["jobs"]["grade"]["steps"]
        if "run" in step
    ]
    gitlab = recipe("gitlab-ci.yml")
    lines += [*gitlab["part"]["script"], *gitlab["whole"]["script"]]
    asked = {
        (words[1], word)
        for line in lines
        if (words := line[line.find("isograde ") :].split()) and words[0] == "isograde"
        for word in words
        if word.startswith("--")
    }
    assert len(asked) >= 5
    for command, option in asked:
        done = subprocess.run(
            [sys.executable, "-m", "isograde", command, "--help"],
            capture_output=True,
            encoding="utf-8",
            check=True,
        )
        assert option in done.stdout, (command, option)
