"""Each mistake gets the advice that mends it, and the declaration to paste is the right one."""

import json
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from isograde.adapters import export
from isograde.adapters.measure import ball, frame
from isograde.adapters.registry import READY_MADE
from isograde.checking import Advice, Checked, check, paste, sentences, small, trying
from isograde.checking.places import misplacement
from isograde.checking.words import alternating, five
from isograde.declaration import declaration_from, declaration_json
from isograde.model import Outcome, Request, Status, Verdict
from isoref.field import Field
from isoref.methods import METHODS

MISTAKEN = Path(__file__).with_name("mistaken.py")


@pytest.fixture(autouse=True)
def _soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few small cases: what is looked at here is the advice."""
    monkeypatch.setattr(small, "CASES_TRIED", 6)


def advice(name: str) -> list[Advice]:
    """What is said of one of the mistaken implementations."""
    return check(f"python:{MISTAKEN}:{name}").advice


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("turned", "simplices[:, ::-1]"),
        ("reversed_axes", "vertices[:, ::-1]"),
        ("unscaled", "vertices * spacing"),
        ("shifted", "the surface is not there"),
        ("one_based", "subtract 1"),
        ("out_of_range", "name vertices -5"),
        ("float_faces", "simplices.astype(int)"),
        ("transposed", "vertices.T"),
        ("counted", "simplices"),
        ("two_parameters", "parameter"),
        ("flat", "simplices.reshape(-1, 3)"),
        ("not_finite", "NaN or infinite"),
        ("nothing", "returned NoneType"),
        ("four", "return only the first two"),
        ("empty", "is the isovalue used?"),
        ("overwriting", "work on a copy"),
        ("fussy", "np.ascontiguousarray"),
        ("careless", "another surface for the same samples in Fortran order"),
        ("raising_where_empty", "return arrays without rows"),
        ("ignoring_nan", '"nan": "answers"'),
        ("misdeclared", "level"),
        ("absent", "it has"),
    ],
)
def test_a_mistake_is_named_with_what_to_do(name: str, words: str) -> None:
    bad = [sentence for verdict, sentence in advice(name) if verdict is not Verdict.PASS]
    assert any(words in sentence for sentence in bad), bad


def test_an_error_on_one_field_is_told_and_does_not_end_the_check() -> None:
    """Issue 12: the next thing is tried."""
    checked = check(f"python:{MISTAKEN}:raising_on_small_fields")
    told = [said for verdict, said in checked.advice if verdict is Verdict.ERROR]
    assert len(told) == 1
    assert "it raised on a field of 3 x 3 x 3 float64 samples, and on" in told[0]
    assert "odd shape" in told[0]
    assert not checked.right
    assert "claims of levels 0 to 2 hold" in checked.advice[-1][1]


def test_who_hangs_is_asked_once_and_has_nothing_to_paste() -> None:
    """--timeout: no other field is tried, and no declaration was measured."""
    checked = check(f"python:{MISTAKEN}:hanging", timeout=1.0)
    assert [verdict for verdict, _ in checked.advice] == [Verdict.PASS, Verdict.TIMEOUT]
    assert "no answer within 1 s" in checked.advice[-1][1]
    assert checked.paste == ""


def test_an_alternating_split_is_known_by_its_diagonals() -> None:
    """Five tetrahedra a cell: what it joins is told, and is no dual method's vertices in cells."""
    field = ball()
    index = {
        name: METHODS[name](field, 1.0).vertices / field.spacing
        for name in ("marching-tetrahedra-five", "marching-tetrahedra-kuhn", "asymptotic-decider")
    }
    assert alternating(index["marching-tetrahedra-five"]) == 0
    assert alternating(index["marching-tetrahedra-five"] + [1, 0, 0]) == 1
    assert alternating(index["marching-tetrahedra-kuhn"]) is None
    assert alternating(index["asymptotic-decider"]) is None
    declared = declaration_json(READY_MADE["isoref:marching-tetrahedra-five"].declaration())
    assert five(0) == declared["interpolant"]
    split = declaration_from({"interpolant": five(1)}, "mine")
    assert split.split != declaration_from({"interpolant": five(0)}, "mine").split


def test_vertices_that_are_shared_within_cells_alone_are_a_soup() -> None:
    """The npm package isosurface: it was told "open inside", though every claim holds."""
    told = " ".join(said for _, said in check(f"python:{MISTAKEN}:soup_of_cells").advice)
    assert "open inside" not in told
    checked = check(f"python:{MISTAKEN}:shared_in_cells")
    assert json.loads(checked.paste)["mesh"] == {"soup": 1e-6}
    told = " ".join(said for _, said in checked.advice)
    assert 'how triangles share vertices looks like {"soup": 1e-06}' in told
    assert "open inside" not in told


@pytest.mark.parametrize("spec", ["correct", "declared", "printing", "soup_of_cells"])
def test_nothing_is_held_against_one_that_is_right(spec: str) -> None:
    """A declared convention is no mistake, and printing to a guarded stream is none."""
    checked = check(f"python:{MISTAKEN}:{spec}")
    assert checked.right, checked.advice
    assert ("'marching'" in str(checked.advice)) == (spec == "printing")
    assert ("turned on purpose" in str(checked.advice)) == (spec == "declared")


def test_a_surface_whose_first_two_axes_are_exchanged_is_not_where_it_should_be() -> None:
    """Though a ball near the middle of the lattice nearly lies where it did."""
    spacing = np.array(ball().spacing)

    def exchanged(field: Field, isovalues: tuple[float, ...]) -> Outcome:
        mesh = METHODS["asymptotic-decider"](field, isovalues[0])
        index = mesh.vertices / spacing if len(mesh.vertices) else mesh.vertices
        return Outcome(Status.OK, index[:, [1, 0, 2]] * spacing, mesh.simplices)

    assert frame(exchanged(ball(), (1.0,)), ball()) == (None, None)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda v, n, h: v + np.array(h) / 2, "half a cell is added"),
        (lambda v, n, h: v - np.array(h) / 2, "half a cell is taken"),
        (lambda v, n, h: v + np.array(h), "as if the field were padded"),
        (lambda v, n, h: v * n / (n - 1), sentences.scaled()),
        (lambda v, n, h: v / ((n - 1) * h), "unit cube"),
        (lambda v, n, h: 2 * v / ((n - 1) * h) - 1, "from -1 to 1"),
        (lambda v, n, h: v - (n - 1) * h / 2, "centred at 0"),
        (lambda v, n, h: v[:, [1, 0, 2]], "take vertices[:, [1, 0, 2]]"),
        (lambda v, n, h: v[:, [2, 0, 1]], "take vertices[:, [1, 2, 0]]"),
        (lambda v, n, h: (v / h)[:, [1, 0, 2]] * h, "vertex = index[:, [1, 0, 2]] * spacing"),
        (lambda v, n, h: (v / h)[:, [0, 2, 1]], "index[:, [0, 2, 1]] * spacing, where it is not"),
        (lambda v, n, h: v + 77, ""),
        (lambda v, n, h: (v + np.array(h) / 2)[:, ::-1], "axes are reversed"),
    ],
)
def test_a_surface_elsewhere_is_explained_by_the_mistake_that_puts_it_there(
    change: Any, words: str
) -> None:
    """Issue 12: half a voxel, centred, unit cube, scale, padding."""
    field = ball()
    mesh = METHODS["asymptotic-decider"](field, 1.0)
    moved = change(mesh.vertices, np.array(field.shape, float), np.array(field.spacing))
    told = misplacement(moved, field)
    assert words in told
    assert bool(told) == bool(words)


@pytest.mark.parametrize(
    ("spec", "words"),
    [
        ("isoref:asymptotic-decider", {}),
        ("isoref:surface-nets", {"vertices": "cells"}),
        ("isoref:label-cubes", {"interpolant": "labels"}),
        ("skimage:lewiner", {}),
        ("trimesh", {"interpolant": "labels"}),
    ],
)
def test_the_declaration_to_paste_is_that_of_the_ready_made(
    spec: str, words: dict[str, Any], tmp_path: Path
) -> None:
    """Undeclared and measured, each comes out with the words and conventions it declares."""
    ready = READY_MADE[spec]
    pytest.importorskip(ready.imports[0])
    (tmp_path / "mine.py").write_text("import numpy as np\n" + ready.source + "\n")
    checked = check(f"python:{tmp_path / 'mine.py'}:extract")
    pasted, declared = json.loads(checked.paste), ready.declaration()
    found = declaration_from(pasted, "mine")
    assert found.conventions == declared.conventions
    kept = {name: pasted[name] for name in ("interpolant", "vertices", "mesh") if name in pasted}
    assert kept == words
    assert found.domain[0].end == declared.domain[0].end
    if words == {"vertices": "cells"}:
        # A dual method has no table: its author is told what a crowded edge is, and of no row.
        crowded = [told for _, told in checked.advice if "topology.manifold fails" in told]
        assert len(crowded) == 1
        assert "one vertex stands for both" in crowded[0]
        assert " row " not in crowded[0]


SOUP = """
import numpy as np
from isoref import extract as reference


def soup(values, isovalue, spacing):
    mesh = reference(values, isovalue, spacing)
    return mesh.vertices[mesh.simplices]


def tetrahedra(values, isovalue, spacing):
    from isoref.field import Field
    from isoref.simplicial import extract

    mesh = extract(Field.of(values, spacing), isovalue)
    return mesh.vertices, mesh.simplices


def cubes_of_bytes(values, isovalue, spacing):
    if values.dtype != np.uint8 or len(set(values.shape)) > 1:
        raise NotImplementedError("cubes of bytes only")
    return soup(values, isovalue, spacing)


def moody(values, isovalue, spacing):
    if not np.isfinite(values).all():
        raise SystemExit("enough")
    return soup(values, isovalue, spacing)


calls = []


def forgetful(values, isovalue, spacing):
    mesh = reference(values, isovalue, spacing)
    calls.append(1)
    return mesh.vertices + (0.01 if len(calls) > 1 else 0), mesh.simplices
"""


@pytest.fixture(scope="module")
def odd(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Implementations that are odd in one way each."""
    place = tmp_path_factory.mktemp("odd") / "odd.py"
    place.write_text(SOUP, encoding="utf-8")
    return place


def checked_of(odd: Path, name: str) -> Checked:
    """What is said of one of them."""
    return check(f"python:{odd}:{name}")


def test_a_soup_and_a_split_are_seen(odd: Path) -> None:
    assert json.loads(checked_of(odd, "soup").paste)["mesh"] == {"soup": 1e-6}
    assert json.loads(checked_of(odd, "tetrahedra").paste)["interpolant"] == "kuhn"


def test_one_that_declines_is_asked_what_it_can_do(odd: Path) -> None:
    """Issue 12: cubes only, bytes only."""
    checked = checked_of(odd, "cubes_of_bytes")
    assert "it takes one that is a cube of type uint8" in str(checked.advice)
    assert json.loads(checked.paste)["limits"] == {"types": ["uint8"], "cubes": True}


def test_what_is_raised_on_one_field_ends_nothing(odd: Path) -> None:
    checked = checked_of(odd, "moody")
    assert checked.started
    assert checked.paste
    assert len(checked.advice) > 3


def test_two_answers_to_one_question_are_told(odd: Path) -> None:
    assert "asked twice, it gives two answers" in str(checked_of(odd, "forgetful").advice)


def test_a_fault_of_ours_is_told_and_ends_nothing(
    odd: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def breaks(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(trying, "measure", breaks)
    checked = checked_of(odd, "soup")
    assert "could not be finished: ZeroDivisionError" in str(checked.advice)
    assert not checked.right
    assert checked.paste


def test_an_unknown_name_does_not_start() -> None:
    checked = check("skimage:levine")
    assert not checked.started
    assert checked.advice[0][0] is Verdict.ERROR


def test_a_folder_is_checked_file_by_file(tmp_path: Path) -> None:
    field = Field.of(np.zeros((2, 2, 2)))
    export(tmp_path / "v", [Request(name, "plain", field, (1.0,)) for name in ("a", "b", "c")])
    (tmp_path / "v/a.off").write_text("OFF\n0 0 0\n")
    (tmp_path / "v/b.off").write_text("OFF")
    said = check(f"dir:{tmp_path / 'v'}").advice
    assert [verdict for verdict, _ in said] == [Verdict.PASS, Verdict.PASS, Verdict.FAIL]
    assert "2 of 3 exported fields" in said[1][1]
    assert "b.off" in said[2][1]


def test_a_program_is_checked_like_a_function(tmp_path: Path) -> None:
    triangle = '{"id": 1, "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "simplices": [[1, 2, 3]]}'
    script = tmp_path / "program.sh"
    script.write_text(
        f"read start; echo '{{\"protocol\": 3}}'; while read run; do echo '{triangle}'; done"
    )
    said = check(f"exec:sh {shlex.quote(str(script))}").advice
    assert said[-1] == (Verdict.FAIL, "simplices count vertices from 1: subtract 1")


@pytest.mark.parametrize("spec", ["isoref:diconex-mixed", "isoref:marching-faces"])
def test_contours_and_curves_are_checked_like_surfaces(spec: str) -> None:
    """Their conventions are measured as well."""
    said = check(spec).advice
    kind = "contours" if "diconex" in spec else "curves"
    right = [told for verdict, told in said if verdict is Verdict.PASS]
    assert any(told.startswith(f"{kind}: measured as it declares: tie") for told in right)


def test_one_of_many_kinds_is_tried_on_the_smallest() -> None:
    told = str(check("isoref:simplicial").advice)
    assert "surfaces: " in told
    assert "more kinds that it declares were not tried" in told


def test_what_goes_without_saying_is_not_pasted() -> None:
    said = {"name": "mine", "domain": ["closed", "open", "open"], "conventions": {"tie": "inside"}}
    assert json.loads(paste(declaration_from(said, "x"))) == {
        "name": "mine", "domain": ["closed", "open", "open"],
    }  # fmt: skip


def test_advice_to_a_program_is_in_no_particular_language(tmp_path: Path) -> None:
    """Issue 12: nothing about NumPy to who writes C."""
    answer = '{"id": 1, "vertices": [[0, 0, 0, 1, 1, 1]], "simplices": [[0.5, 1, 2]]}'
    script = tmp_path / "program.sh"
    script.write_text(
        f"read start; echo '{{\"protocol\": 3}}'; while read run; do echo '{answer}'; done"
    )
    advised = check(f"exec:sh {shlex.quote(str(script))}").advice
    said = " ".join(told for _, told in advised)
    assert "not (n, 3)" in said
    assert "not integers" in said
    for word in ("astype", "reshape", "np.", "[:,", "<"):
        assert word not in said


def test_nan_is_a_note_and_a_function_is_told_where_its_declaration_goes() -> None:
    """Issue 11: NaN is a convention, and held against nobody; a new user's first "wrong" was it."""
    checked = check(f"python:{MISTAKEN}:ignoring_nan")
    assert checked.right
    notes = [said for verdict, said in checked.advice if verdict is Verdict.SKIP]
    assert any("NaN" in said for said in notes)
    where, what = checked.to_paste
    assert "put it into the module of the function (isograde explain python)" in where
    assert what == 'declaration = {"conventions": {"nan": "answers"}}'
    assert check(f"python:{MISTAKEN}:correct").to_paste == ["Nothing has to be declared."]
