"""A failure of any kind is shown in one way: a picture with the fault, and lines that assert it."""

import contextlib
import io
import runpy
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from isograde import grading
from isograde.cases import all_cases
from isograde.declaration import declaration_from
from isograde.model import CONTOURS, CURVES, SURFACES, Case, Kind, Outcome, Status
from isograde.report.page import page
from isograde.report.picture import picture
from isograde.report.reading import Report
from isograde.report.snippet import snippet
from isograde.runner import Evidence, Judged, Options, Worker, claims_for
from isoref.field import Field
from isoref.methods import METHODS

from tests.isograde.judging import Here
from tests.isograde.reporting import graded

POINTS = Kind(2, 2)
FLAT = Kind(4, 1)
BEYOND = Kind(4, 2)
BROKEN = """
from isoref.field import Field
from isoref.methods import METHODS
from isoref.simplicial import extract

KINDS = [[2, 1], [3, 1], [3, 2], [2, 2], [4, 1], [4, 2]]


def whole(values, isovalues, spacing):
    mesh = extract(Field.of(values, spacing, dimension=len(spacing)), isovalues)
    return mesh.vertices, mesh.simplices


def missing(values, isovalues, spacing):
    vertices, rows = whole(values, isovalues, spacing)
    return vertices, rows[1:]


def turned(values, isovalues, spacing):
    vertices, rows = whole(values, isovalues, spacing)
    rows = rows.copy()
    rows[:1, -2:] = rows[:1, -2:][:, ::-1]
    return vertices, rows


def twice(values, isovalues, spacing):
    vertices, rows = whole(values, isovalues, spacing)
    return vertices, [*rows, *rows[:1]]


def tall(values, isovalues, spacing):
    found = whole(values, isovalues, spacing)
    return found if values.shape[-1] >= values.shape[-2] else (found[0], found[1][:1])


for one in (whole, missing, turned, twice, tall):
    one.declaration = {"interpolant": "kuhn", "limits": {"kinds": KINDS}}
"""


# Few enough samples that nothing is made smaller.
SHAPES = {2: (3, 4), 3: (2, 2, 3), 4: (2, 2, 2, 2)}


def noise(kind: Kind) -> Case:
    """White noise in general position."""
    rng = np.random.default_rng(4)
    values = rng.standard_normal((kind.m, *SHAPES[kind.n]))
    field = Field.of(values if kind.m > 1 else values[0], dimension=kind.n)
    samples = int(np.prod(field.shape))
    return Case(
        f"noise/{kind.n}-{kind.m}", lambda: field, (0.0,) * kind.m, samples, frozenset({"posed"}),
        kind=kind,
    )  # fmt: skip


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The broken implementations."""
    place = tmp_path_factory.mktemp("kinds") / "broken.py"
    place.write_text(BROKEN, encoding="utf-8")
    return place


def made_by(file: Path, name: str, cases: list[Case], claim: str) -> Report:
    """The report of one of them, run in this process, on one claim."""
    function = runpy.run_path(str(file))[name]
    declared = declaration_from(function.declaration, name)
    return graded(Here(function, declared), f"python:{file}:{name}", cases, claim)


def shown(file: Path, name: str, claim: str, kind: Kind) -> Report:
    """The report of one of them on one claim."""
    return made_by(file, name, [noise(kind)], claim)


def holds(program: str) -> tuple[bool, str]:
    """Whether the lines find nothing wrong, and what they print."""
    printed = io.StringIO()
    try:
        with contextlib.redirect_stdout(printed):
            exec(program, {})
    except AssertionError:
        return False, printed.getvalue().strip()
    return True, printed.getvalue().strip()


CASES = [
    ("missing", "topology.closed", CONTOURS, "spot"),
    ("missing", "topology.closed", SURFACES, "gap"),
    ("missing", "topology.closed", CURVES, "spot"),
    ("missing", "topology.closed", FLAT, "gap"),
    ("missing", "topology.closed", BEYOND, "gap"),
    ("turned", "topology.oriented", CONTOURS, "ring"),
    ("turned", "topology.oriented", SURFACES, "sore-line"),
    ("turned", "topology.oriented", BEYOND, "sore-line"),
    ("twice", "topology.manifold", SURFACES, "crowd"),
    ("twice", "structure.no_duplicate", CURVES, "sore-line"),
    ("twice", "structure.no_duplicate", POINTS, "ring"),
]


@pytest.mark.parametrize(("name", "claim", "kind", "drawn"), CASES)
def test_a_failure_has_its_fault_drawn_and_lines_that_assert_it(
    name: str, claim: str, kind: Kind, drawn: str, file: Path
) -> None:
    """Design: the lines fail on the accused, and are silent on the reference."""
    report = shown(file, name, claim, kind)
    evidence = report.evidence[claim]
    svg = ET.fromstring(picture(evidence, evidence["came"], "came"))
    assert drawn in [element.get("class") for element in svg.iter()]
    assert f'id="failure-{claim}"' in page(report)
    program = snippet(report, report.summaries[claim])
    assert program is not None
    assert "isograde" not in program
    accused, told = holds(program)
    assert not accused
    assert told
    assert holds(program.replace(f'["{name}"]', '["whole"]')) == (True, "")


def test_points_are_drawn_as_points(file: Path) -> None:
    report = shown(file, "missing", "topology.sides", POINTS)
    evidence = report.evidence["topology.sides"]
    svg = picture(evidence, evidence["came"])
    assert svg.count('class="spot"') == len(evidence["came"]["simplices"])
    assert "sore-line" in svg


@pytest.fixture(autouse=True)
def alone(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """The reference is started only where its answer is looked at."""
    if "legal" not in request.node.name:
        monkeypatch.setattr(grading, "contrast", lambda *_: {})


def test_a_legal_answer_of_the_same_split_stands_beside(file: Path) -> None:
    report = shown(file, "missing", "topology.closed", SURFACES)
    evidence = report.evidence["topology.closed"]
    assert len(evidence["legal"]["simplices"]) == len(evidence["came"]["simplices"]) + 1
    assert "sore-line" not in picture(evidence, evidence["legal"])


@pytest.mark.parametrize(
    ("level", "method", "right"),
    [
        (2, "asymptotic-decider", True),
        (4, "asymptotic-decider", False),
        (4, "trilinear-cubes", True),
    ],
)
def test_a_legal_answer_satisfies_every_level_that_is_claimed(
    level: int, method: str, right: bool
) -> None:
    """Issue 12: who promises the topology inside cells is shown an answer that has it."""
    case = all_cases(0)["trilinear/each/7.4.2/0"]
    field, declared = case.build(), declaration_from({"level": level}, "it")
    worker = Worker(Here(print, declared), declared, all_cases(0), claims_for(declared))
    judged = Judged(case.id, case.kind, {}, evidence=Evidence(field, case.isovalues, {}))
    mesh = METHODS[method](field, case.isovalues[0])
    answer = Outcome(Status.OK, mesh.vertices, mesh.simplices)
    legal = grading.Legal(worker, Options())
    assert legal._right("topology.manifold", judged, answer) is right


@pytest.mark.parametrize("kind", [CONTOURS, SURFACES, CURVES])
def test_a_variant_that_differs_is_brought_back_and_drawn_beside(kind: Kind, file: Path) -> None:
    """The answer to the turned field lies over the plain one but for what is missing."""
    report = shown(file, "tall", "symmetry.orientation", kind)
    evidence = report.evidence["symmetry.orientation"]
    posed = np.array(evidence["posed"]["came"]["vertices"])
    plain = np.array(evidence["came"]["vertices"])
    top = np.array(evidence["shape"]) - 1.0
    assert ((posed >= -1e-9) & (posed <= top + 1e-9)).all()
    assert len(posed) == len(plain)
    assert "brought back" in page(report)
    program = snippet(report, report.summaries["symmetry.orientation"])
    assert program is not None
    assert holds(program.replace('["tall"]', '["whole"]')) == (True, "")


def test_signs_stand_beside_each_sample_of_two_fields(file: Path) -> None:
    values = np.array([[[1.0, -1], [1, -1]], [[1, 2], [-1, -3]]])
    field = Field.of(values, dimension=2)
    case = Case("two", lambda: field, (0.0, 0.0), 4, kind=POINTS)
    report = made_by(file, "missing", [case], "topology.sides")
    evidence = report.evidence["topology.sides"]
    drawn = picture(evidence, evidence["came"])
    assert [sign for sign in ("++", "+−", "−+", "−−") if f">{sign}</text>" in drawn] == [
        "++", "+−", "−+", "−−",
    ]  # fmt: skip
    assert drawn.count('class="in"') == 1


def test_beyond_space_the_simplices_nearest_to_the_fault_are_drawn(file: Path) -> None:
    report = shown(file, "missing", "topology.closed", BEYOND)
    text = page(report)
    assert "R^4 with one direction of the picture for each axis" in text


def test_no_word_of_an_older_grader_is_on_the_page(file: Path) -> None:
    """One meaning each: adapter, oracle, normals, kind."""
    text = page(shown(file, "missing", "topology.closed", CURVES)).lower()
    assert [word for word in ("discipline", "door", "facing", "withheld") if word in text] == []
