"""A failure of contours, curves or simplices is shown as one of surfaces: picture and lines."""

import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from isograde.grading import grade
from isograde.report import record
from isograde.report.page import page
from isograde.report.polyline_picture import contour_picture, curve_picture
from isograde.report.record import Report
from isograde.report.simplex_picture import nearest, simplex_picture
from isograde.report.snippet import snippet
from isograde.runner import Options

BROKEN = """
import numpy as np


def contours(values, isovalue, spacing):
    from isograde.adapters.contour_methods import _reference
    return [line[:-1] for line in _reference("mixed")(values, isovalue, spacing)]


def curves(a, b, isovalue_a, isovalue_b, spacing):
    from isograde.adapters.curve_methods import _reference
    from isoref.fast import marching_faces
    found = _reference(marching_faces)(a, b, isovalue_a, isovalue_b, spacing)
    return [line[: max(2, len(line) - 1)] for line in found]


def simplices(values, spacing):
    from isograde.adapters.simplex_methods import isoref_simplices
    vertices, rows = isoref_simplices(values, spacing)
    return vertices, rows[:-1]


def by_the_first_axis(values, isovalue, spacing):
    from isograde.adapters.contour_methods import _reference
    tall = values.shape[0] > values.shape[1]
    return _reference("mixed")(values, isovalue, spacing) if tall else []


contours.declaration = {"discipline": "contours"}
curves.declaration = {"discipline": "curves"}
simplices.declaration = {"discipline": "simplices", "level": 1}
by_the_first_axis.declaration = {"discipline": "contours"}
"""
ASKED = [
    ("contours", "contours.whole", "contours/integers", 'class="run"'),
    ("curves", "curves.whole", "curves/noise", 'class="run"'),
    ("simplices", "simplices.closed", "simplices/noise-3-2", 'class="spot"'),
    ("simplices", "simplices.closed", "simplices/noise-4-1", 'class="gap"'),
]


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of implementations that leave something out."""
    path = tmp_path_factory.mktemp("broken") / "broken.py"
    path.write_text(BROKEN, encoding="utf-8")
    return path


def graded(file: Path, function: str, *only: str) -> Report:
    """The report of a function of the file, read back from its lines."""
    lines = file.with_suffix(".jsonl")
    grade(f"python:{file}:{function}", Options(only=only), lines)
    return record.read(lines)


@pytest.mark.parametrize(("function", "claim", "case", "drawn"), ASKED)
def test_a_failure_has_its_smallest_case_a_picture_and_lines_that_show_it(
    file: Path, function: str, claim: str, case: str, drawn: str
) -> None:
    report = graded(file, function, claim, case)
    evidence, summary = report.evidence[claim], report.summaries[claim]
    assert evidence["of"] == case
    assert np.prod(evidence["shape"]) < report.cases[case]["samples"]
    text = page(report)
    assert evidence["legal"]["status"] == "ok"  # An answer of which the claim holds.
    assert text.count('<svg class="pic"') == 2
    assert drawn in text
    shown = snippet(report, summary)
    assert shown is not None
    done = subprocess.run(
        [sys.executable, "-c", shown], capture_output=True, text=True, check=True, timeout=60
    )
    assert len(done.stdout.split()) > 3
    assert f"--only &#39;{evidence['case']}&#39;" in text


def test_no_answer_is_called_legal_that_breaks_the_claim(file: Path) -> None:
    """DICONEX decides by the mean: where the saddle decides otherwise, nothing legal is at hand."""
    claim, case = "contours.bilinear", "contours/saddle-mean-out-in"
    text = BROKEN.replace('"contours"}', '"contours", "level": 3}').replace("[line[:-1]", "[line")
    file.with_name("mean.py").write_text(text, encoding="utf-8")
    report = graded(file.with_name("mean.py"), "contours", claim, case)
    assert report.summaries[claim].state == "fail"
    assert "legal" not in report.evidence[claim]


def test_a_variant_that_differs_is_drawn_beside(file: Path) -> None:
    """The answer to the transposed field, brought back."""
    report = graded(file, "by_the_first_axis", "contours.transposed", "contours/bytes")
    evidence = report.evidence["contours.transposed"]
    assert evidence["posed"]["variant"] == "transposed"
    assert page(report).count('<svg class="pic"') == 2
    assert "the field transposed; brought back" in page(report)
    shown = snippet(report, report.summaries["contours.transposed"])
    assert shown is not None
    assert "values.T" in shown


def test_a_block_of_another_discipline_is_graded_again_by_its_name(file: Path) -> None:
    block = "curves/noise[0:3,0:3,0:3]"
    assert list(graded(file, "curves", "curves.whole", block).cases) == [block]


RECORD = {
    "shape": [2, 3],
    "spacing": [1.0, 2.0],
    "origin": [1.0, 0.0],
    "isovalue": 0.5,
    "values": [1, 0, 0, 0, 0, 1],
    "finding": {"numbers": {"at": [0.5, 1.0], "square": [0, 1], "sample": [0, 0], "axis": 1}},
}
LINE = {"vertices": [[1.5, 0.0], [1.5, 1.0]], "faces": [[0], [0]]}


def test_contours_are_drawn_over_their_samples_and_the_fault_is_marked() -> None:
    drawn = contour_picture(RECORD, LINE, "one")
    ET.fromstring(drawn)
    for kind, count in {"in": 2, "out": 4, "run": 1, "head": 1, "spot": 1, "ring": 1}.items():
        assert drawn.count(f'class="{kind}"') == count, kind
    assert drawn.count('class="sore"') == drawn.count('class="gap"') == 1


def test_an_answer_that_is_missing_leaves_the_samples() -> None:
    drawn = contour_picture(RECORD, {"status": "raised"}, "one")
    assert 'class="run"' not in drawn
    assert drawn.count('class="in"') == 2


def test_both_signs_stand_beside_each_sample_of_two_fields() -> None:
    values = [1] * 8 + [0] * 8
    two = {**RECORD, "shape": [2, 2, 2], "spacing": [1] * 3, "origin": [0] * 3, "values": values}
    two["finding"] = {}
    drawn = curve_picture(two, {"vertices": [[0, 0, 0.5], [1, 1, 0.5]], "faces": [[0], [0]]})
    ET.fromstring(drawn)
    assert drawn.count("+−</text>") == 8


def test_simplices_beyond_space_are_those_nearest_to_the_fault() -> None:
    points = np.eye(5)
    rows = np.array([[0, 1, 2, 3], [1, 2, 3, 4], [0, 2, 3, 4]])
    assert nearest(points, rows, np.array([0, 1, 1, 1, 1]) / 4, 1).tolist() == [1]
    five = {"shape": [2] * 5, "spacing": [1] * 5, "origin": [0] * 5, "finding": {}}
    drawn = simplex_picture(five, {"vertices": points.tolist(), "faces": rows.tolist()})
    ET.fromstring(drawn)
    assert 'class="run"' in drawn
