"""Kits for other languages: their tables, and each project built, asked, and judged."""

import json
import shlex
import shutil
import subprocess
from collections import Counter
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import typer
from isograde.adapters import open_adapter
from isograde.checking import check
from isograde.command import app
from isograde.commands.kits import KITS, folder_of, new, write
from isograde.model import Limits, Outcome, Request, Status, Verdict
from isograde.oracles.self_intersections import self_intersections
from isograde.runner import Options, Worker, plan
from isoref.cube import CORNER_OFFSETS, EDGES, axis_of
from isoref.cycles import Triangle
from isoref.fast.sweep import sweep
from isoref.field import Array, Field
from isoref.mesh import Mesh
from isoref.rule import Rule, Tile
from typer.testing import CliRunner

from tests.loading import module_at

LONGEST = 150
TYPES = ("i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8", "f2", "f4", "f8", "b1")


def _tables() -> ModuleType:
    """The program that writes the tables, which is in no package."""
    path = Path(__file__).parents[2] / "validation" / "kits" / "tables.py"
    return module_at(path, "tables")


tables = _tables()


def triangles(signs: int) -> list[Triangle]:
    """The table's triangles of these signs, as edges of the cell."""
    edges = [ord(letter) - ord("a") for letter in tables.triangles_of(signs)]
    return list(zip(edges[::3], edges[1::3], edges[2::3], strict=True))


def twin(field: Field, isovalue: float) -> Mesh:
    """What the kits' marching cubes gives, by the reference's sweep and the same table."""
    rule = Rule("kits", lambda signs, _: Tile(tuple(triangles(signs))), asks=lambda _: False)
    return sweep(rule, field, isovalue)


# The tables, and the files of each kit.


@pytest.mark.parametrize("name", tables.LANGUAGES)
def test_the_table_of_each_language_is_current(name: str) -> None:
    assert (tables.KITS / name).read_text(encoding="utf-8") == tables.table(name)


def test_triangles_of_a_cell_never_cross() -> None:
    """Wherever the surface crosses the edges, near their ends and at random; exact arithmetic."""
    random = np.random.default_rng(0)
    ends = random.choice([0.001, 0.02, 0.5, 0.98, 0.999], (100, 12))
    t = np.concatenate([ends, random.random((100, 12))])
    cells = np.repeat(CORNER_OFFSETS[[low for low, _ in EDGES]][None], len(t), 0).astype(float)
    cells[:, range(12), [axis_of(e) for e in range(12)]] += t
    cells[:, :, 0] += 3 * np.arange(len(t))[:, None]
    starts = 12 * np.arange(len(t))[:, None, None]
    judged = [signs for signs in range(256) if len(triangles(signs)) > 1]
    assert len(judged) == 238
    for signs in judged:
        rows = (np.array(triangles(signs)) + starts).reshape(-1, 3)
        assert not len(self_intersections(cells.reshape(-1, 3), rows)), signs


@pytest.mark.parametrize("name", KITS)
def test_a_kit_has_all_its_files_and_speaks_briefly(name: str) -> None:
    """Issue 15: at most 150 lines, the marching cubes of its example apart."""
    kit, place = KITS[name], folder_of(name)
    found = {str(path.relative_to(place)) for path in place.rglob("*") if path.is_file()}
    assert found == set(kit.files)
    assert len((place / kit.speaks).read_text(encoding="utf-8").splitlines()) <= LONGEST


def test_the_readme_has_a_row_for_each_kit_and_says_which_language_has_none() -> None:
    text = (Path(__file__).parents[2] / "validation/kits/README.md").read_text(encoding="utf-8")
    rows = [line for line in text.splitlines() if line.startswith("| ")][1:]
    assert len(rows) == len(KITS) + 1
    for kit, row in zip(KITS.values(), rows[1:], strict=True):
        assert row.startswith(f"| {kit.language}")
        assert f"`{kit.speaks}` | `{kit.extracts}`" in row
    assert "no kit for Julia" in text


def test_a_wheel_has_the_kits() -> None:
    """Each folder is package data: an installed copy finds its kits inside the package."""
    import tomllib

    text = (Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8")
    included = tomllib.loads(text)["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"]
    kits = {name: f"isograde/kits/{name}" for name in KITS}
    assert {Path(path).name: inside for path, inside in included.items() if "kits" in path} == kits


def test_a_folder_with_something_in_it_is_left_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine").write_text("precious")
    with pytest.raises(typer.Exit) as left:
        new("c", tmp_path)
    assert left.value.exit_code == 2
    assert "not empty" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["mine"]


def test_what_it_says_to_try_can_be_pasted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Whatever the folder is called: the shell takes one quoting away, and the adapter another."""
    folder = tmp_path / "my 'own' kit"
    new("c", folder)
    *_, last = capsys.readouterr().out.splitlines()
    isograde, check, spec = shlex.split(last.removeprefix("Try it: "))
    assert (isograde, check, spec) == ("isograde", "check", spec_of(folder))
    assert (folder / "run").stat().st_mode & 0o111


def test_the_help_names_every_kit() -> None:
    told = " ".join(CliRunner().invoke(app, ["new", "--help"]).output.split())
    assert all(f"{name}" in told for name in KITS)


@pytest.mark.parametrize(
    ("language", "advice"),
    [("jav", "did you mean java"), ("python", "explain python"), ("cobol", "explain exec")],
)
def test_an_unknown_language_gets_advice(
    language: str, advice: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(typer.Exit) as left:
        new(language, tmp_path / "project")
    assert left.value.exit_code == 2
    assert advice in " ".join(capsys.readouterr().err.split())


# Each kit's project, built where its language is.


@pytest.fixture(scope="module", params=KITS)
def project(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a project, as `isograde new` writes it."""
    name: str = request.param
    kit = KITS[name]
    for tool in kit.tools:
        if shutil.which(tool) is None:
            pytest.skip(f"no {tool} here, which the kit for {kit.language} needs")
    folder = tmp_path_factory.mktemp("kits") / name
    write(kit, folder_of(name), folder)
    return folder


def spec_of(project: Path) -> str:
    """The project as an implementation."""
    return f"exec:{shlex.quote(str(project / 'run'))}"


def asked(project: Path, requests: Sequence[tuple[Array, float]]) -> list[Outcome]:
    """What the project makes of these samples and isovalues, spaced unevenly."""
    adapter = open_adapter(spec_of(project))
    adapter.open(Limits())
    try:
        return [
            adapter.run(Request("test", "plain", Field(values, SPACING, (0.0,) * 3), (isovalue,)))
            for values, isovalue in requests
        ]
    finally:
        adapter.close()


SPACING = (1.0, 2.0, 0.5)


def facets(mesh: Mesh) -> Counter[Any]:
    """The triangles by their corners' coordinates, each begun at its least corner."""
    apart = 3.3e-8  # No coordinate here is halfway between two that are rounded to.
    corners = (mesh.vertices + apart).round(7)[mesh.simplices].tolist()
    rows = [[tuple(point) for point in triangle] for triangle in corners]
    return Counter(tuple(row[row.index(min(row)) :] + row[: row.index(min(row))]) for row in rows)


def noise(kind: str) -> tuple[Array, float]:
    """Random samples of this type, some equal to the isovalue, and the isovalue."""
    random = np.random.default_rng(5)
    dtype = np.dtype(kind)
    if dtype.kind == "f":
        return (random.random((5, 6, 7)) - 0.5).round(1).astype(dtype), 0.1
    low, high = (0, 2) if dtype.kind == "b" else (max(-60, np.iinfo(dtype).min), 60)
    return random.integers(low, high, (5, 6, 7)).astype(dtype), 0.5 if dtype.kind == "b" else 20.0


@pytest.mark.slow
def test_it_is_accepted_by_check_at_once(project: Path) -> None:
    """Issue 15: `isograde new` writes a project that `isograde check` accepts."""
    found = check(spec_of(project), 30.0)
    assert found.right, found
    assert found.started


@pytest.mark.slow
def test_it_gives_the_twins_triangles_for_every_type(project: Path) -> None:
    """Triangle by triangle, on noise with ties, as each number type."""
    requests = [noise(kind) for kind in TYPES]
    outcomes = asked(project, requests)
    for kind, (values, isovalue), outcome in zip(TYPES, requests, outcomes, strict=True):
        assert outcome.mesh is not None, (kind, outcome)
        right = facets(twin(Field.of(values, SPACING), isovalue))
        assert len(right) > 100
        assert facets(outcome.mesh) == right, kind


HARD: Sequence[tuple[str, Array, float]] = [
    ("just below an isovalue that rounding reaches", np.array([2**62 - 1, 2**62 + 512]), 2.0**62),
    ("the same, negative", np.array([-(2**62) - 1, 2**40]), -(2.0**62)),
    ("the largest integer", np.array([2**63 - 1, 0]), 2.0**63),
    ("the largest of all", np.array([2**64 - 1, 0], np.uint64), 2.0**64),
    ("a large one", np.array([2**63 + 1, 0], np.uint64), 2.0**63),
    ("halves that are denormal", np.array([2**-24, 3 * 2**-24], np.float16), 2.0**-23),
    ("halves below zero", np.array([-65504, 65504], np.float16), 0.0),
    ("doubles that no difference holds", np.array([-1e308, 1.5e308]), 1e307),
    ("doubles that are denormal", np.array([5e-324, 2e-323]), 1e-323),
]


@pytest.mark.slow
def test_it_is_right_where_numbers_are_hard(project: Path) -> None:
    """Sides are exact whatever the samples' size; so is the crossing, where doubles hold them."""
    requests = [(np.broadcast_to(pair, (2, 2, 2)), isovalue) for _, pair, isovalue in HARD]
    for (what, pair, isovalue), outcome in zip(HARD, asked(project, requests), strict=True):
        assert outcome.mesh is not None, (what, outcome)
        high = [int(one) if pair.dtype.kind in "iu" else float(one) for one in pair]
        crossed = (high[0] >= isovalue) != (high[1] >= isovalue)
        assert len(outcome.mesh.simplices) == 2 * crossed, what
        if crossed and pair.dtype.kind == "f":
            low, up, level = map(Fraction, (*high, isovalue))
            t = float((level - low) / (up - low))
            assert outcome.mesh.vertices[:, 2] / SPACING[2] == pytest.approx(t, abs=1e-9), what


@pytest.mark.slow
def test_it_refuses_what_is_no_field_and_goes_on(project: Path) -> None:
    """An error with a text for each, and the next request is answered by the same process."""
    good = noise("f8")
    nan, infinite = good[0].copy(), good[0].copy()
    nan[2, 2, 2], infinite[1, 1, 1] = np.nan, np.inf
    refused = [
        (nan, 0.1),
        (infinite, 0.1),
        (good[0], float("nan")),
        (good[0], float("inf")),
        (good[0][:0], 0.1),
        (good[0].astype(np.longdouble), 0.1),
    ]
    *errors, last = asked(project, [*refused, good])
    for (values, isovalue), outcome in zip(refused, errors, strict=True):
        assert outcome.status is Status.RAISED, (values.dtype, values.shape, isovalue, outcome)
        assert outcome.detail.strip()
    assert last.status is Status.OK


# What each kit's extractor says of its isovalue, in place of a sentence.
SAYS = {
    "c": 'isovalue == INFINITY ? "inf" : isovalue == -INFINITY ? "-inf" : "nan"',
    "cpp": "std::to_string(isovalue)",
    "java": 'String.valueOf(isovalue).replace("Infinity", "inf")',
    "javascript": 'String(isovalue).replace("Infinity", "inf")',
    "rust": "isovalue.to_string()",
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SAYS)
def test_an_isovalue_that_is_not_finite_comes_as_it_was_asked(name: str, tmp_path: Path) -> None:
    """The protocol has texts for these; an extractor that gets another one is judged for it."""
    if missing := [tool for tool in KITS[name].tools if shutil.which(tool) is None]:
        pytest.skip(f"no {', '.join(missing)} here")
    sentence = '"a sample minus the isovalue is no finite number"'
    told = (sentence, SAYS[name])
    copy = changed(name, tmp_path / name, KITS[name].extracts, told)
    values, _ = noise("f8")
    levels = float("inf"), -float("inf"), float("nan")
    outcomes = asked(copy, [(values, level) for level in levels])
    said = [one.detail.lower() for one in outcomes]
    assert "-inf" not in said[0]
    assert ["inf" in said[0], "-inf" in said[1], "nan" in said[2]] == [True] * 3, said


@pytest.mark.slow
def test_it_reads_both_orders_of_bytes(project: Path, tmp_path: Path) -> None:
    """The protocol's types begin with < or |; a program that is sent > is right too."""
    lines = [{"command": "start", "protocol": 3}]
    for number, kind in enumerate(TYPES):
        values, isovalue = noise(kind)
        for order in "<>":
            path = tmp_path / f"{order == '<'}{kind}"
            path.write_bytes(b"beginning" + values.astype(order + kind).tobytes())
            lines.append(run_line(number, order + kind, path, values.shape, isovalue))
    text = "".join(json.dumps(line) + "\n" for line in lines)
    done = subprocess.run(
        [project / "run"],
        input=text,
        capture_output=True,
        encoding="utf-8",
        check=True,
        timeout=120,
    )
    _, *answers = map(json.loads, done.stdout.splitlines())
    assert len(answers) == 2 * len(TYPES)
    for one, other in zip(answers[::2], answers[1::2], strict=True):
        assert len(one["simplices"]) > 100
        assert one == other


def run_line(
    number: int, dtype: str, path: Path, shape: tuple[int, ...], isovalue: float
) -> dict[str, Any]:
    """A request as the grader writes it."""
    return {
        "command": "run",
        "id": number,
        "dtype": dtype,
        "shape": shape,
        "components": 1,
        "spacing": SPACING,
        "isovalues": [isovalue],
        "offset": len(b"beginning"),
        "values": str(path),
        "directory": str(path.parent),
        "case": "test",
    }


def changed(name: str, folder: Path, file: str, *changes: tuple[str, str]) -> Path:
    """A new project with places of a file changed."""
    write(KITS[name], folder_of(name), folder)
    text = (folder / file).read_text(encoding="utf-8")
    for was, now in changes:
        assert text.count(was) == 1, was
        text = text.replace(was, now)
    (folder / file).write_text(text, encoding="utf-8")
    return folder


# By language: a line on standard output, as libraries write them, and vertices that are NaN.
NOISY = {
    "c": [("if (values->count == 0)", 'puts("noise"); if (values->count == 0)'),
          ("at[a] *= spacing[a]", "at[a] *= NAN")],
    "cpp": [("if (values.empty())", 'std::cout << "noise" << std::endl; if (values.empty())'),
            ("at[a] *= spacing[a]", "at[a] *= NAN")],
    "rust": [("if values.is_empty()", 'println!("noise"); if values.is_empty()'),
             ("at[a] * spacing[a]", "at[a] * f64::NAN")],
    "go": [("if len(values) == 0", 'fmt.Println("noise"); if len(values) == 0'),
           ('"errors"\n', '"errors"\n\t"fmt"\n'), ("at[a] *= spacing[a]", "at[a] *= math.NaN()")],
    "java": [("if (values.length() == 0)", 'System.out.println("x"); if (values.length() == 0)'),
             ("at[a] *= spacing[a]", "at[a] *= Double.NaN")],
    "javascript": [("if (values.length === 0)", 'console.log("x"); if (values.length === 0)'),
                   ("step * spacing[a]", "step * NaN")],
}  # fmt: skip


@pytest.mark.slow
def test_prints_are_kept_apart_and_a_vertex_that_is_not_finite_is_told(
    project: Path, tmp_path: Path
) -> None:
    """JSON has no NaN: it comes as null, or, where a language refuses that, as an error."""
    name = project.name
    copy = changed(name, tmp_path / name, KITS[name].extracts, *NOISY[name])
    for outcome in asked(copy, [noise("f8")] * 2):
        if outcome.status is Status.OK:
            assert outcome.vertices is not None
            assert np.isnan(outcome.vertices).all()
        else:
            assert (outcome.status, name) == (Status.RAISED, "go")
            assert "NaN" in outcome.detail


@pytest.mark.slow
def test_a_wrong_row_of_the_table_is_seen_by_check(tmp_path: Path) -> None:
    """One triangle of 256 rows turned over."""
    if shutil.which("cc") is None:
        pytest.skip("no C compiler here")
    found = check(spec_of(changed("c", tmp_path / "c", "table.h", ('"dlh"', '"dhl"'))), 30.0)
    assert found.started
    assert not found.right


# A part of the plan; the whole plan takes minutes for each kit.
GRADED = (
    "cells/inside/*7", "ties/point", "ties/noise-0*", "noise/white-5x6x7",
    "bodies/3-1/sphere-1?-*", "simplices/positive-3-1", "simplices/sphere",
)  # fmt: skip


@pytest.mark.slow
def test_it_reaches_level_2(project: Path) -> None:
    """Every claim up to level 2, and every other promised one, on a part of the plan."""
    options = Options(only=GRADED)
    worker = Worker.open(spec_of(project), options)
    found: dict[str, Counter[Verdict]] = {}
    try:
        for task in plan(options, worker.cases, worker.claims):
            for claim, finding in worker.judge(task).findings.items():
                if worker.claims[claim].held(worker.declaration):
                    found.setdefault(claim, Counter())[finding.verdict] += 1
    finally:
        worker.adapter.close()
    for claim, verdicts in found.items():
        assert set(verdicts) <= {Verdict.PASS, Verdict.SKIP}, (claim, verdicts)
    judged = {claim for claim, verdicts in found.items() if verdicts[Verdict.PASS]}
    levels = {name for name, claim in worker.claims.items() if claim.level in (0, 1, 2)}
    assert len(levels) > 20
    assert levels <= judged, levels - judged
