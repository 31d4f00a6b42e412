"""A kind that nobody has thought of passes through everything: one module, one registration.

The kind is that of isolated points in the plane, in which two contours meet: (n, m) = (2, 2). Its
module of cases and its extractor, a plain function, are written here; `FAMILIES` is where the cases
are registered. The rest of the grader does not know that there are points.
"""

from __future__ import annotations

import contextlib
import io
import json
import runpy
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from isograde import cases
from isograde.cases import all_cases
from isograde.command import app
from isograde.model import Case, Kind
from isograde.report import reading
from isograde.report.snippet import snippet
from isoref.field import Field
from typer.testing import CliRunner, Result

# The extractor: in each half of a square both functions are linear, and vanish in one point.
EXTRACTOR = '''
import numpy as np

declaration = {"interpolant": "kuhn", "limits": {"kinds": [[2, 2]], "least": 2}}


def points(values, isovalues, spacing):
    """The points (V, 2) in which two contours meet."""
    if values.ndim != 3 or values.shape[0] != 2 or not values.size:
        raise ValueError(f"samples have shape {values.shape}, not (2, N1, N2)")
    if not np.isfinite(values).all() or not np.isfinite(isovalues).all():
        raise ValueError("a sample or an isovalue is not a number")
    f = values.astype(float) - np.reshape(isovalues, (2, 1, 1))
    found = []
    for i in range(f.shape[1] - 1):
        for j in range(f.shape[2] - 1):
            for middle in ((1, 0), (0, 1)):
                corners = np.array([(i, j), (i + middle[0], j + middle[1]), (i + 1, j + 1)])
                found += zero(f[:, corners[:, 0], corners[:, 1]], corners)
    return np.reshape(found, (-1, 2)) * spacing


def zero(f, corners):
    """The common zero of two functions in a triangle, if there is one."""
    matrix = np.vstack([f, np.ones(3)])
    if not np.linalg.det(matrix):
        return []
    weights = np.linalg.solve(matrix, [0, 0, 1])
    return [weights @ corners] if (weights >= 0).all() else []


def one_missing(values, isovalues, spacing):
    """The same without the last point."""
    return points(values, isovalues, spacing)[:-1]
'''


def family() -> ModuleType:
    """The module of cases: what somebody would write as ``isograde/cases/points.py``."""
    module = ModuleType("points")

    def noise() -> Field:
        return Field.of(np.random.default_rng(8).normal(size=(2, 4, 5)), (0.5, 2.0), dimension=2)

    def cross() -> Field:
        x, y = np.indices((4, 4)) - np.reshape([1.37, 1.61], (2, 1, 1))
        return Field.of(np.stack([x + 0.3 * y, y - 0.2 * x]), dimension=2)

    def listed(seed: int = 0) -> list[Case]:
        del seed
        zeros, kind = (0.0, 0.0), Kind(2, 2)
        return [
            Case("points/cross", cross, zeros, 16, frozenset({"posed"}), kind=kind),
            Case("points/noise", noise, zeros, 20, frozenset({"posed"}), kind=kind),
        ]

    module.cases = listed  # type: ignore[attr-defined]
    return module


@pytest.fixture(autouse=True)
def registered(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The one registration."""
    monkeypatch.setitem(cases.FAMILIES, "points", family())
    all_cases.cache_clear()
    yield
    all_cases.cache_clear()


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    """The file of the extractor."""
    place = tmp_path / "mine.py"
    place.write_text(EXTRACTOR, encoding="utf-8")
    return place


def run(*arguments: str | Path) -> Result:
    """The result of the command with these arguments."""
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def test_points_are_checked(mine: Path) -> None:
    """The declaration in the file is enough."""
    told = run("check", f"python:{mine}:points")
    assert told.exit_code == 0, told.output


def test_points_are_graded_and_reach_the_top_of_their_ladder(mine: Path, tmp_path: Path) -> None:
    """On the new cases and on known bodies, with every claim that can be said of points."""
    out = tmp_path / "out"
    told = run("grade", f"python:{mine}:points", "--only", "*", "--out", out)
    assert told.exit_code == 0, told.output
    report = reading.read(out / "report.jsonl")
    judged = {name for name, one in report.summaries.items() if one.counts.get("pass")}
    assert {"topology.sides", "bodies.pieces", "bodies.distance", "symmetry.translation"} <= judged
    assert "consistent" in told.output


def test_a_missing_point_is_shown_everywhere(mine: Path, tmp_path: Path) -> None:
    """Page, picture, lines without the grader, and JUnit."""
    out = tmp_path / "out"
    told = run("grade", f"python:{mine}:one_missing", "--only", "points/*", "--out", out)
    assert told.exit_code == 1, told.output
    report = reading.read(out / "report.jsonl")
    summary = report.summaries["topology.sides"]
    assert summary.failure is not None
    page = (out / "report.html").read_text(encoding="utf-8")
    assert 'id="failure-topology.sides"' in page
    assert "<svg" in page
    # The lines fail on the accused and are silent on the right one.
    program = snippet(report, report.summaries["symmetry.orientation"])
    assert program is not None
    with contextlib.redirect_stdout(io.StringIO()), pytest.raises(AssertionError):
        exec(program, {})
    exec(program.replace("one_missing", "points"), {})
    suites = ET.parse(out / "report.junit.xml").getroot()
    failures = [
        case.get("name") for case in suites.iter("testcase") if case.find("failure") is not None
    ]
    assert any("topology.sides" in str(name) for name in failures)


def test_points_are_exported_and_judged_from_files(tmp_path: Path, mine: Path) -> None:
    """Answers written beside the fields by a program that knows the files only."""
    folder = tmp_path / "fields"
    told = run("export", folder, "--kind", "2,2", "--only", "points/*")
    assert told.exit_code == 0, told.output
    points = runpy.run_path(str(mine))["points"]
    asked = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))["fields"]
    assert len(asked) == 2
    for field in asked:
        file = folder / field["values"]
        found = points(np.load(file), field["isovalues"], field["spacing"]) + field["origin"]
        np.save(file.with_suffix(".vertices.npy"), found)
        np.save(file.with_suffix(".simplices.npy"), np.arange(len(found))[:, None])
    judged = run("grade", f"dir:{folder}", "--only", "topology.*", "--out", tmp_path / "out")
    assert judged.exit_code == 0, judged.output
    report = reading.read(tmp_path / "out" / "report.jsonl")
    assert report.summaries["topology.sides"].counts["pass"] == 2
