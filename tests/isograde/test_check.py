"""Each mistake gets the advice that mends it."""

import shlex
from pathlib import Path

import numpy as np
import pytest
from isograde.adapters import export
from isograde.check import Advice, check
from isograde.model import Request, Verdict
from isoref.field import Field

MISTAKEN = Path(__file__).with_name("mistaken.py")


def advice(name: str) -> list[Advice]:
    """What is said of one of the mistaken implementations."""
    return check(f"python:{MISTAKEN}:{name}")


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("turned", "faces[:, ::-1]"),
        ("reversed_axes", "vertices[:, ::-1]"),
        ("unscaled", "vertices * spacing"),
        ("shifted", "the surface is not there"),
        ("one_based", "subtract 1"),
        ("out_of_range", "name vertices -5"),
        ("float_faces", "faces.astype(int)"),
        ("transposed", "vertices.T"),
        ("flat", "faces.reshape(-1, 3)"),
        ("counted", "leading count"),
        ("not_finite", "NaN or infinite"),
        ("nothing", "returned NoneType"),
        ("four", "return only the first two"),
        ("two_parameters", "function(values, isovalue, spacing)"),
        ("empty", "is the isovalue used?"),
        ("overwriting", "work on a copy"),
        ("fussy", "np.ascontiguousarray"),
        ("careless", "another surface for the same samples in Fortran order"),
        ("raising_where_empty", "arrays of shape (0, 3)"),
        ("ignoring_nan", '"nan": "answers"'),
        ("misdeclared", "'high' is not of type 'integer'"),
        ("absent", "it has"),
    ],
)
def test_a_mistake_is_named_with_what_to_do(name: str, words: str) -> None:
    bad = [sentence for verdict, sentence in advice(name) if verdict is not Verdict.PASS]
    assert any(words in sentence for sentence in bad), bad


@pytest.mark.parametrize("spec", ["correct", "declared", "printing"])
def test_nothing_is_held_against_one_that_is_right(spec: str) -> None:
    """A declared convention is no mistake, and printing to a guarded stream is none."""
    said = advice(spec)
    assert [verdict for verdict, _ in said if verdict is not Verdict.PASS] == []
    assert ("'marching'" in str(said)) == (spec == "printing")
    assert ("turned on purpose" in str(said)) == (spec == "declared")


def test_an_unknown_name_is_an_error() -> None:
    assert check("skimage:levine")[0][0] is Verdict.ERROR


def test_a_folder_is_checked_file_by_file(tmp_path: Path) -> None:
    field = Field.of(np.zeros((2, 2, 2)))
    export(tmp_path / "v", [Request(name, "plain", field, 1.0) for name in ("a", "b", "c")])
    (tmp_path / "v/a.off").write_text("OFF\n0 0 0\n")
    (tmp_path / "v/b.off").write_text("OFF")
    said = check(f"dir:{tmp_path / 'v'}")
    assert [verdict for verdict, _ in said] == [Verdict.PASS, Verdict.PASS, Verdict.FAIL]
    assert "2 of 3 exported fields" in said[1][1]
    assert "b.off" in said[2][1]


def test_a_program_is_checked_like_a_function(tmp_path: Path) -> None:
    triangle = '{"id": 1, "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[1, 2, 3]]}'
    script = tmp_path / "program.sh"
    script.write_text(
        f"read start; echo '{{\"protocol\": 2}}'; while read run; do echo '{triangle}'; done"
    )
    said = check(f"exec:sh {shlex.quote(str(script))}")
    assert said[-1] == (Verdict.FAIL, "faces count vertices from 1: subtract 1")


def test_another_discipline_is_checked_by_its_smallest_cases() -> None:
    """Its conventions are not those of surfaces: nothing is said of them."""
    said = check("contours:diconex-mixed")
    assert [verdict for verdict, _ in said] == [Verdict.PASS] * 7
    assert all("contours/" in sentence for _, sentence in said[1:])


def test_an_unknown_discipline_is_told_at_the_adapter(tmp_path: Path) -> None:
    path = tmp_path / "odd.py"
    path.write_text("def f(*_): ...\nf.declaration = {'discipline': 'surface'}\n")
    ((verdict, sentence),) = check(f"python:{path}:f")
    assert verdict is Verdict.ERROR
    assert "'surface' is not one of ['surfaces'," in sentence
