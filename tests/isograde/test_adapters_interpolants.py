"""Implementations that are given a function: the interpolant they see, and how they are judged."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest
from isograde.adapters import open_adapter
from isograde.adapters.interpolants import interpolant, on_samples
from isograde.cases.bodies import of_kind
from isograde.checking import check
from isograde.claims import CLAIMS
from isograde.declaration import declaration_from
from isograde.grading import grade
from isograde.model import AdapterError, Limits, Request, Status
from isograde.report.reading import findings_of
from isograde.report.snippet import snippet
from isograde.runner import Options, claims_for
from isoref.field import Field
from scipy.interpolate import RegularGridInterpolator

# It takes twice as many samples as the field has, and gives boxes: one a sample inside.
TWICE = """
import numpy as np
from isoref import extract as surface

declaration = {"given": "function", "vertices": {"own": 0.5}}


def extract(function, lower, upper, spacing, isovalue):
    counts = [1 + 2 * round(end / step) for end, step in zip(upper, spacing)]
    grid = np.meshgrid(*map(np.linspace, lower, upper, counts), indexing="ij")
    mesh = surface(function(*grid), isovalue, [step / 2 for step in spacing])
    return mesh.vertices, mesh.simplices


def torn(function, lower, upper, spacing, isovalue):
    vertices, simplices = extract(function, lower, upper, spacing, isovalue)
    return vertices, simplices[::2]


torn.declaration = declaration


def bent(function, lower, upper, spacing, isovalue):
    # Along an axis the interpolant is straight inside a cell.
    bend = function(3.1, 4.2, 5.3) - 2 * function(3.5, 4.2, 5.3) + function(3.9, 4.2, 5.3)
    if abs(bend) < 1e-6:
        raise ValueError("an interpolant")
    return extract(function, lower, upper, spacing, isovalue)


bent.declaration = declaration


def two(function, lower):
    pass


two.declaration = declaration


def lines(function, lower, upper, spacing, isovalue):
    pass


lines.declaration = {**declaration, "limits": {"kinds": [[3, 2]]}}


def by_edges(function, lower, upper, spacing, isovalue):
    pass


by_edges.declaration = {"given": "function"}
"""


@pytest.fixture
def twice(tmp_path: Path) -> str:
    """The beginning of the names of these functions."""
    path = tmp_path / "twice.py"
    path.write_text(TWICE, encoding="utf-8")
    return f"python:{path}:"


@pytest.mark.parametrize("shape", [(7,), (3, 4), (3, 4, 5), (3, 1, 4), (2, 3, 2, 3)])
def test_the_interpolant_is_scipy_s(shape: tuple[int, ...]) -> None:
    """Of floats and of arrays, in any number of axes, and beyond the lattice as at its border."""
    random = np.random.default_rng(2)
    values = random.random(shape)
    spacing = (1.0, 0.5, 2.0, 3.0)[: len(shape)]
    at = interpolant(values, spacing)
    points = random.uniform(-1, 1.5, (80, len(shape))) * np.multiply(shape, spacing)
    ends = (np.array(shape) - 1) * spacing
    thick = [n > 1 for n in shape]
    axes = [np.arange(n) * h for n, h in zip(shape, spacing, strict=True) if n > 1]
    inner = np.clip(points, 0, ends)[:, thick]
    theirs = RegularGridInterpolator(axes, values.reshape([n for n in shape if n > 1]))(inner)
    assert at(*points.T) == pytest.approx(theirs)
    one_by_one = [at(*map(float, point)) for point in points]
    assert all(type(value) is float for value in one_by_one)
    assert one_by_one == pytest.approx(theirs)


@pytest.mark.parametrize("kind", ["uint8", "int64", "float16", ">f4", "bool"])
def test_the_interpolant_has_the_samples_themselves(kind: str) -> None:
    """At the lattice's places, exactly, whatever the type and the layout."""
    values = np.random.default_rng(3).integers(0, 2, (3, 4, 5)).astype(kind).transpose(2, 0, 1)
    at = interpolant(values, (2.0, 0.5, 1.0))
    for place in product(*map(range, values.shape)):
        assert at(*np.multiply(place, (2.0, 0.5, 1.0)).tolist()) == float(values[place])


def test_a_function_is_asked_in_the_box_of_the_field(twice: str) -> None:
    """Its answer comes back in the field's place, spacing and origin."""
    i, j, k = np.indices((6, 7, 8))
    ball = Field.of(4 - (i - 2) ** 2 - (j - 3) ** 2 - (k - 3) ** 2, (1, 2, 3), (9, 8, 7))
    adapter = open_adapter(f"{twice}extract")
    declared = adapter.open(Limits())
    try:
        outcome = adapter.run(Request("test", "plain", ball, (0.5,)))
    finally:
        adapter.close()
    assert (declared.given, declared.vertices, declared.reach) == ("function", "own", 0.5)
    assert outcome.mesh is not None, outcome.detail
    centre = np.array([11.0, 14.0, 16.0])
    radii = np.linalg.norm((outcome.mesh.vertices - centre) / (1, 2, 3), axis=1)
    # Interpolated on cells, then on half cells, the squares are off by 3/4 + 3/16 at most.
    assert (abs(radii**2 - 3.5) <= 15 / 16).all()
    assert len(radii) > 200


def test_a_known_body_is_given_as_its_own_function() -> None:
    """Of floats and arrays: zero where the body is, and the samples at the lattice's places."""
    for case in of_kind(3, 1):
        assert (case.function is not None) == case.id.endswith("float64")
    case = next(case for case in of_kind(3, 1) if case.function is not None)
    body, level = case.facts["body"], case.isovalues[0]
    assert case.function is not None
    points = body.points(200)
    assert len(points) > 100
    assert case.function(*points.T) == pytest.approx(level, abs=1e-6)
    assert case.function(*map(float, points[0])) == pytest.approx(level, abs=1e-6)
    field = case.build()
    every = case.function(*np.indices(field.shape))
    assert abs(every - field.values).max() <= 2.0**-21
    # Attack: between samples the interpolant is further away than that.
    between = interpolant(field.values, field.spacing)(*points.T)
    assert abs(between - level).max() > 0.01


def test_only_who_is_given_a_function_is_given_the_body(twice: str, tmp_path: Path) -> None:
    """Of floats the sphere's own; of bytes the interpolant, which is straight inside cells."""
    pair = {one: f"bodies/3-1/sphere-16-{one}" for one in ("float64", "uint8")}
    options = Options(only=(*pair.values(), "structure.answers"))
    report = grade(f"{twice}bent", options, tmp_path / "report.jsonl")
    told = {
        result["case"]: verdict
        for result in report.results
        for name, verdict, _ in findings_of(result)
        if name == "structure.answers"
    }
    assert told == {pair["float64"]: "pass", pair["uint8"]: "error"}


@pytest.mark.slow
def test_check_accepts_a_function_of_a_function(twice: str) -> None:
    found = check(f"{twice}extract")
    assert found.started
    assert [said for word, said in found.told if word not in ("right", "note")] == [
        "it answers a field with NaN as if nothing were wrong: raise an error; or declare "
        '"nan": "answers" (now "raises")'
    ] or found.right


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("two", r"called with \(function, lower, upper, spacing, isovalue\)"),
        ("lines", "given one function"),
        ("by_edges", "a lattice of one's own"),
    ],
)
def test_what_cannot_be_called_with_a_function_is_told(twice: str, name: str, told: str) -> None:
    with pytest.raises(AdapterError, match=told):
        open_adapter(f"{twice}{name}").open(Limits())


def test_a_program_cannot_be_given_a_function() -> None:
    answer = '{"protocol": 3, "declaration": {"given": "function", "vertices": {"own": 1}}}'
    adapter = open_adapter(f"exec:read start; echo '{answer}'; read stop")
    with pytest.raises(AdapterError, match="sent samples"):
        adapter.open(Limits())


def test_claims_about_samples_are_not_said_of_it() -> None:
    """They could not fail: it never sees how the samples lie, or of which type they are."""
    own = {"vertices": {"own": 1.0}}
    given = set(claims_for(declaration_from({**own, "given": "function"}, "f")))
    samples = set(claims_for(declaration_from(own, "s")))
    assert samples - given == {
        "robustness.input_unmodified", "robustness.bad_input", "symmetry.layout", "symmetry.type",
    }  # fmt: skip
    assert given <= samples <= set(CLAIMS)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "claim"),
    [
        ("cells/inside/001", "topology.closed"),
        ("bodies/3-1/sphere-16-float64", "bodies.holes"),
    ],
)
def test_lines_without_the_grader_hold_the_function(
    case: str, claim: str, twice: str, tmp_path: Path
) -> None:
    """The lines that show a failure make the function themselves, and fail on the accused."""
    options = Options(only=(case, claim))
    for name, torn in (("torn", True), ("extract", False)):
        report = grade(f"{twice}{name}", options, tmp_path / name / "report.jsonl")
        (summary,) = [one for one in report.summaries.values() if one.id == claim]
        assert (summary.failure is not None) == torn
        if torn:
            lines = snippet(report, summary)
            assert lines is not None
            assert "isograde" not in lines
            with pytest.raises(AssertionError):
                exec(lines, {})
            exec(lines.replace('["torn"]', '["extract"]'), {})


def test_a_status_is_the_function_s_own(twice: str) -> None:
    """What the interpolant makes of bad input is the implementation's to see."""

    def ends(function: object, *others: object) -> object:
        return others

    lower, upper, spacing, isovalue = on_samples(ends)(np.zeros((2, 3)), 0.5, (1.0, 2.0))
    assert (lower, upper, spacing, isovalue) == ((0.0, 0.0), (1.0, 4.0), (1.0, 2.0), 0.5)
    adapter = open_adapter(f"{twice}extract")
    adapter.open(Limits())
    try:
        outcome = adapter.run(Request("test", "isovalue-nan", Field.of(np.eye(3)[None]), (np.nan,)))
    finally:
        adapter.close()
    assert outcome.status is Status.RAISED
