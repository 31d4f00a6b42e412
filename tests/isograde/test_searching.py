"""The search finds what is broken, makes it small, and finds nothing in what is right."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from isograde.adapters.libraries import isoref
from isograde.cases import own
from isograde.claims import CLAIMS
from isograde.command import app
from isograde.declaration import declaration_from
from isograde.model import BAD
from isograde.report import words
from isograde.runner import Options, Task, Worker, claims_for
from isograde.searching import STYLES, Tally, drawn_for, looked_for, search
from typer.testing import CliRunner

from tests.isograde.families import cubes
from tests.isograde.judging import Here
from tests.isograde.mistaken import correct

BROKEN = """
import numpy as np
from isoref import extract as reference

def extract(values, isovalue, spacing):
    mesh = reference(values, isovalue, spacing)
    {line}
    return mesh.vertices, mesh.simplices
"""


#: Never reached: what is found depends on the number of fields alone, however busy the machine is.
MINUTES = 60.0


def worker(function: Any, **says: Any) -> Worker:
    """A worker without cases: the search makes its own."""
    declared = declaration_from(says, "tried")
    return Worker(Here(function, declared), declared, {}, claims_for(declared))


def single(values: Any, isovalue: float, spacing: Any) -> Any:
    """The level is subtracted in single precision: wrong far from zero alone."""
    less = np.asarray(values, np.float32) - np.float32(isovalue)
    return cubes(less.astype(np.float64), 0.0, spacing)


def without_first_of_many(values: Any, isovalue: float, spacing: Any) -> Any:
    """The first triangle of five or more is missing."""
    vertices, faces = cubes(values, isovalue, spacing)
    return vertices, faces[1:] if len(faces) >= 5 else faces


def test_a_hole_is_found_and_made_small() -> None:
    """Half of what may be drawn or less, and small numbers."""
    asked = worker(without_first_of_many)
    tally = search(asked, [CLAIMS["topology.closed"]], "mine", MINUTES, most=600)
    (found,) = tally.found
    assert found.claim == "topology.closed"
    case = own.case_of(found.entry)
    assert case.samples < 64
    assert np.abs(case.build().values).max() <= 3
    assert found.entry["by"] == "mine"
    assert tally.fields > 0


def test_what_fails_far_from_zero_only_is_found() -> None:
    """A style for each thing that small whole numbers cannot show."""
    tally = search(worker(single), [CLAIMS["topology.sides"]], "mine", MINUTES, most=300)
    (found,) = tally.found
    assert abs(found.entry["isovalues"][0]) > 1000 or max(map(abs, found.entry["values"])) < 0.1


def test_a_right_answer_is_searched_in_vain() -> None:
    """Every promised claim that drawn fields can be judged by."""
    asked = worker(correct, level=3)
    claims = looked_for(asked)
    assert len(claims) > 20
    tally = search(asked, claims, "mine", MINUTES, most=25)
    assert tally.found == []
    assert tally.fields > 10


@pytest.mark.parametrize("kind", [(2, 1), (3, 2)])
def test_other_kinds_are_drawn_too(kind: tuple[int, int]) -> None:
    """A contour left out, a curve left out."""

    def less(values: Any, level: Any, spacing: Any) -> Any:
        if kind == (2, 1):
            found = isoref.diconex(values, level, spacing, "mixed")
        else:
            a, b = values
            found = isoref.marching_faces(a, b, level[0], level[1], spacing)
        return list(found)[1:]

    asked = worker(less, limits={"kinds": [list(kind)]})
    tally = search(asked, [CLAIMS["topology.sides"]], "mine", MINUTES, most=60)
    assert [found.claim for found in tally.found] == ["topology.sides"]
    assert tally.found[0].entry["kind"] == list(kind)


def test_what_is_drawn_is_within_the_limits() -> None:
    """And every style occurs."""
    limits = {"types": ["float32", "uint8"], "least": 3, "greatest": 4, "cubes": True}
    asked = worker(cubes, limits=limits)
    shapes, types, styles = set(), set(), set()

    from hypothesis import given, settings

    @settings(max_examples=150, database=None, derandomize=True, deadline=None)
    @given(drawn_for(asked, [CLAIMS["topology.closed"]]))
    def look(drawn: Any) -> None:
        shapes.add(drawn.numbers.shape)
        types.add(np.dtype(drawn.dtype).name)
        styles.add(drawn.style)

    look()
    assert shapes == {(1, 3, 3, 3), (1, 4, 4, 4)}
    assert types == {"float32", "uint8"}
    assert styles == set(STYLES)


def test_claims_on_known_bodies_and_known_failures_are_not_looked_for() -> None:
    """What a report says has failed is not new."""
    asked = worker(cubes)
    everything = {claim.id for claim in looked_for(asked)}
    assert not any(name.startswith(("bodies.", "accuracy.")) for name in everything)
    assert "topology.bilinear" not in everything
    less = {claim.id for claim in looked_for(asked, known=["topology.closed"])}
    assert everything - less == {"topology.closed"}
    assert [c.id for c in looked_for(asked, ["topology.bil*"])] == ["topology.bilinear"]


def test_the_time_is_kept() -> None:
    """Half a second is not a minute."""
    seen: list[int] = []

    def watch(tally: Tally) -> None:
        seen.append(tally.fields)

    asked = worker(cubes)
    tally = search(asked, looked_for(asked), "mine", 0.02, watch=watch)
    assert tally.fields == seen[-1]


# --- the command --------------------------------------------------------------------------------


def told(*arguments: str) -> tuple[int, str]:
    """The status and what was printed."""
    done = CliRunner().invoke(app, list(arguments))
    return done.exit_code, done.output


def test_what_is_found_is_kept_and_graded(tmp_path: Path) -> None:
    """Issue 13: search, then grade --cases, which fails on the same claim."""
    module = tmp_path / "mine.py"
    line = "mesh.simplices[:] = mesh.simplices[:, ::(-1 if len(mesh.simplices) > 2 else 1)]"
    module.write_text(BROKEN.format(line=line))
    spec, file = f"python:{module}:extract", tmp_path / "cases.json"
    status, output = told(
        "search", spec, "--minutes", "0.2", "--cases", str(file), "--only", "topology.sides"
    )
    assert status == 1, output
    assert "topology.sides" in output
    assert len(own.read(file)) == 1
    out = tmp_path / "report"
    status, output = told(
        "grade", spec, "--cases", str(file), "--only", "own/*", "--out", str(out), "--jobs", "1"
    )
    assert status == 1, output
    assert "topology.sides" in output


def test_wrong_use_is_said(tmp_path: Path) -> None:
    """A claim that is none, a file that is none, an implementation that is none."""
    file = str(tmp_path / "cases.json")
    status, output = told("search", "isoref:trilinear-cubes", "--only", "topology.close")
    assert status == 4
    assert "topology.closed" in output
    assert told("search", "python:nowhere:f", "--cases", file)[0] == 3
    Path(file).write_text("no cases", encoding="utf-8")
    for command in ("search", "grade"):
        status, output = told(command, "isoref:trilinear-cubes", "--cases", file)
        assert status == 2
        assert "no JSON" in output


def test_the_command_that_reproduces_names_the_file() -> None:
    """An own case is in no plan: without its file nobody finds it."""
    assert words.own_files(["grade", "x", "--cases", "a.json", "--cases=b.json"]) == [
        "a.json",
        "b.json",
    ]


def test_the_kept_findings_are_still_failures() -> None:
    """`reports/search`: of the version that was searched, each case breaks its claim."""
    skimage = pytest.importorskip("skimage")
    if skimage.__version__ != "0.26.0":
        pytest.skip(f"the findings are of scikit-image 0.26.0, not {skimage.__version__}")
    file = Path(__file__).parents[2] / "reports" / "search" / "skimage-lewiner.json"
    claims = {one["id"]: one["breaks"] for one in own.entries(file)}
    assert set(claims.values()) == {"symmetry.layout", "structure.answers", "geometry.crossing"}
    opened = Worker.open("skimage:lewiner", Options(own=(file,)))
    try:
        for case, claim in claims.items():
            finding = opened.judge(Task(case, (claim,))).findings[claim]
            assert finding.verdict in BAD, (case, claim, finding)
    finally:
        opened.adapter.close()
