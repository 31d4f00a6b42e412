"""A stranger's afternoon with the wheel, from a function of one's own to a document to file.

Everything runs in an environment that holds the wheel and what it needs, in a folder with nothing
but what the stranger writes. The notebook is `tests/isograde/test_notebook.py`.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

ROOT = Path(__file__).parent.parent
Run = Callable[..., "subprocess.CompletedProcess[str]"]

MINE = """
from isoref import extract as reference

def extract(values, isovalue, spacing):
    mesh = reference(values, isovalue, spacing, method="lorensen-cline")
    return mesh.vertices, mesh.simplices
"""
# A part of the plan, so that a round takes seconds.
PART = ["--only", "pairs/02*", "--only", "topology.*"]
IN_PYTHON = """
import isograde
from mine import extract

if __name__ == "__main__":
    found = isograde.grade(extract, only=["pairs/0217", "topology.*"])
    print(found)
    print(sorted(found.failures))
"""


@pytest.fixture
def run(clean: Path, tmp_path: Path) -> Run:
    """A function that runs a program of the clean environment, or of the machine, in a folder."""
    (tmp_path / "mine.py").write_text(MINE, encoding="utf-8")
    path = f"{clean / 'bin'}{os.pathsep}{os.environ['PATH']}"
    there = {**os.environ, "PATH": path, "VIRTUAL_ENV": str(clean), "PYTHONPATH": ""}

    def called(*command: str, **more: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            command, cwd=tmp_path, env={**there, **more}, capture_output=True, encoding="utf-8",
            check=False,
        )  # fmt: skip

    return called


def steps() -> dict[str, str]:
    """The lines that a project adds to its continuous integration, by their names."""
    text = (ROOT / "docs" / "ci" / "github-actions.yml").read_text(encoding="utf-8")
    job = yaml.safe_load(text)["jobs"]["grade"]
    found = {step["name"]: step["run"] for step in job["steps"] if "run" in step}
    return {name: found[name] for name in ("install", "grade", "summary", "nothing broke")}


@pytest.mark.slow
def test_a_function_is_graded_and_its_two_known_failures_are_listed_in_ci(
    run: Run, tmp_path: Path
) -> None:
    """From Python; then green with two failures listed, and red when there is a third."""
    (tmp_path / "look.py").write_text(IN_PYTHON, encoding="utf-8")
    told = run("python", "look.py")
    assert told.returncode == 0, told.stderr
    assert "topology.closed: 1 fail" in told.stdout

    # List what fails today: the two promises that the drawings of 1987 break.
    listed = run(
        "isograde", "grade", "python:mine:extract", *PART, "--write-expect", "known-failures.toml"
    )
    assert listed.returncode == 1, listed.stdout + listed.stderr
    known = (tmp_path / "known-failures.toml").read_text(encoding="utf-8")
    assert known.count("reason =") == 2
    assert '["topology.closed"]' in known
    assert '["topology.manifold"]' in known

    # Run the four lines of the recipe; the package is installed already.
    four = steps()
    assert four.pop("install") == "pip install isograde ."
    part = " ".join(f"'{word}'" for word in PART)
    more = {"IMPLEMENTATION": "python:mine:extract", "GITHUB_STEP_SUMMARY": "summary.md"}

    def statuses() -> dict[str, int]:
        found = {}
        for name, line in four.items():
            done = run("bash", "-ec", line.replace(" --out", f" {part} --out"), **more)
            found[name] = done.returncode
            assert done.returncode in (0, 1), done.stderr
        return found

    assert statuses() == {"grade": 0, "summary": 0, "nothing broke": 0}
    summary = (tmp_path / "summary.md").read_text(encoding="utf-8")
    assert "topology.closed" in summary

    # Break a third promise: the triangles are turned over.
    shutil.copytree(tmp_path / "report", tmp_path / "main-report")
    broken = MINE.replace("mesh.simplices", "mesh.simplices[:, ::-1]")
    (tmp_path / "mine.py").write_text(broken, encoding="utf-8")
    assert statuses() == {"grade": 1, "summary": 0, "nothing broke": 1}


@pytest.mark.slow
def test_a_scan_is_extracted_where_it_stands_and_a_dossier_is_filed(
    run: Run, tmp_path: Path
) -> None:
    """Oblique and mirrored; without the reader it is told what to install."""
    nibabel: Any = pytest.importorskip("nibabel")
    turned = np.array([[0, -2, 0, 5], [1.6, 0, 0.6, 6], [-1.2, 0, 0.8, 7], [0, 0, 0, 1.0]])
    x, y, z = np.indices((14, 12, 13))
    values = (30 - (x - 6) ** 2 - (y - 5) ** 2 - (z - 6) ** 2).astype(np.float32)
    nibabel.save(nibabel.Nifti1Image(values, turned), tmp_path / "scan.nii.gz")
    extract = ("isograde", "extract", "scan.nii.gz", "--isovalue", "5.5", "-o", "ball.npz")
    told = run(*extract)
    assert told.returncode == 2
    assert "isograde[volumes]" in told.stderr + told.stdout
    install = run("pip", "install", "-q", "-c", str(ROOT / "constraints.txt"), "nibabel")
    assert install.returncode == 0, install.stderr
    done = run(*extract)
    assert done.returncode == 0, done.stderr
    assert "RAS" in done.stdout
    with np.load(tmp_path / "ball.npz") as mesh:
        index = (mesh["vertices"] - turned[:3, 3]) @ np.linalg.inv(turned[:3, :3]).T
        a, b, c = np.moveaxis(mesh["vertices"][mesh["faces"]], 1, 0)
    assert len(index) > 300
    # Vertices are off by the chord of an edge, 1 / (8 R), triangles by that of a cell, 3 / (8 R).
    radius = 24.5**0.5
    off = np.linalg.norm(index - [6, 5, 6], axis=1) - radius
    assert abs(off).max() < 1.1 / (8 * radius)
    ball = 4 / 3 * np.pi * radius**3 * abs(np.linalg.det(turned[:3, :3]))
    enclosed = (a * np.cross(b, c)).sum() / 6
    assert (1 - 1.1 * 3 / (8 * radius**2)) ** 3 < enclosed / ball < 1

    # File a dossier of one's own function, and check it as years later.
    filed = run("isograde", "dossier", "python:mine:extract", *PART, "-o", "filed/mine.html")
    assert filed.returncode == 1, filed.stderr  # its promises are broken, and that is said
    assert "fails on" in (tmp_path / "filed" / "mine.html").read_text(encoding="utf-8")
    assert run("isograde", "dossier", "--verify", "filed/mine.html").returncode == 0
    with (tmp_path / "filed" / "mine.lock.txt").open("a", encoding="utf-8") as lock:
        lock.write("numpy==0\n")
    changed = run("isograde", "dossier", "--verify", "filed/mine.html")
    assert changed.returncode == 1
    assert "mine.lock.txt was changed" in changed.stdout


@pytest.mark.slow
def test_a_rust_extractor_is_written_from_the_kit(run: Run, tmp_path: Path) -> None:
    """`isograde check` accepts what the kit writes; all of levels 0 to 2 hold on a part."""
    if shutil.which("cargo") is None:
        pytest.skip("no cargo: the Rust kit was not built")
    assert run("isograde", "new", "rust", "mine-rs").returncode == 0
    assert (tmp_path / "mine-rs" / "Cargo.toml").is_file()
    checked = run("isograde", "check", "exec:mine-rs/run", "--timeout", "120")
    assert checked.returncode == 0, checked.stdout + checked.stderr
    some = ("cells/inside/0[0-4]*", "bodies/3-1/sphere-*", "noise/*-5x6x7")
    only = [word for glob in some for word in ("--only", glob)]
    graded = run("isograde", "grade", "exec:mine-rs/run", *only)
    assert graded.returncode == 0, graded.stdout + graded.stderr
    assert "promises level 2" in graded.stdout
