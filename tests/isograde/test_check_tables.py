"""`check` names what is wrong with a table, an interpolation, a walk; issue 12 lists the mistakes.

The broken extractors are called here in this process: what stands between is tested elsewhere.
"""

import json
from typing import Any

import numpy as np
import pytest
from isograde import checking
from isograde.adapters.forms import arrays_from
from isograde.checking import Checked, sentences, small
from isograde.checking.rows import cell, configurations, judged, row_told
from isograde.declaration import Declaration
from isograde.model import Outcome, Request, Status, Verdict
from isoref.methods import METHODS

from tests.isograde import broken_tables


class Direct:
    """An adapter that calls a function in this process."""

    def __init__(self, function: Any):
        self.function = function

    def answer(self, request: Request) -> Outcome:
        """What the function returns."""
        field = request.field
        values = field.values.copy(order="K")
        try:
            with np.errstate(all="ignore"):
                answer = self.function(values, request.isovalues[0], field.spacing)
        except NotImplementedError as error:
            return Outcome(Status.DECLINED, detail=str(error))
        except Exception as error:  # noqa: BLE001 - as the worker does
            return Outcome(Status.RAISED, detail=str(error))
        return Outcome(Status.OK, *arrays_from(answer, request.kind))

    def said(self) -> tuple[str, str]:
        """Nothing is printed."""
        return "", ""


def checked(function: Any, **says: Any) -> Checked:
    """What check finds of a function."""
    found = Checked()
    adapter: Any = Direct(function)
    checking._kinds(found, adapter, Declaration("mine", **says))
    return found


@pytest.fixture(autouse=True)
def _soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few small cases: what is looked at here is the advice."""
    monkeypatch.setattr(small, "CASES_TRIED", 2)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("wrong_entry", "1 row of the table names an edge that is not crossed"),
        ("flipped_row", "1 row of the table is turned over"),
        ("flipped_triangle", "1 row of the table has a triangle that faces another way"),
        ("missing_triangle", "leaves a crossed edge without a vertex"),
        ("missing_middle", "1 row of the table lacks a triangle"),
        ("missing_row", "1 row of the table gives no triangles"),
        ("doubled_row", "1 row of the table has an edge that belongs to more than two triangles"),
        ("swapped", "the interpolation is swapped on every edge"),
        ("swapped_axis", "the interpolation is swapped on the edges along axis 1"),
        ("halved_axis", "in the middle of the edge on the edges along axis 2"),
        ("bent", "not stand where the linear interpolant crosses on every edge"),
        ("with_epsilon", "16777216 times smaller; is a fixed tolerance"),
        ("one_layer_short", "1 cells short at the last layer along axis 2"),
        ("seam", "open inside, along axis 2 at 32, 64: is there a seam"),
        ("seam_left_out", "open inside, along axis 0 at 15, 16, 31, 32"),
        ("upside_down", "read from the other end along axis 0"),
        ("isovalue_left_out", "it draws the surface of isovalue 0, asked for 1"),
        ("both_sides", "every triangle is there 2 times, both ways round"),
        ("every_twice", "every triangle is there 2 times, the same way round"),
        ("moody", "asked twice, it gives two answers"),
        ("shuffled", "asked twice, it gives two answers"),
        ("padded", "as if the field were padded: subtract spacing"),
        ("swapped_axes", "axes are exchanged: take vertices[:, [1, 0, 2]]"),
        ("stretched", sentences.scaled()),
    ],
)
def test_a_broken_extractor_is_told_what_is_wrong(name: str, words: str) -> None:
    """Issue 12: a wrong entry, a flipped row, a missing triangle, a swapped interpolation, .."""
    found = checked(getattr(broken_tables, name))
    bad = [told for verdict, told in found.advice if verdict is Verdict.FAIL]
    assert any(words in told for told in bad), bad
    assert not found.right


@pytest.mark.parametrize("name", ["moody", "shuffled"])
def test_chance_is_not_taken_for_a_matter_of_types(name: str) -> None:
    """Issue 12: nondeterminism, not "another surface for int16"."""
    assert "int16" not in str(checked(getattr(broken_tables, name)).advice)


def test_the_row_is_named_by_its_corners_and_its_number() -> None:
    told = str(checked(broken_tables.flipped_row).advice)
    assert "inside corners (0, 0, 0) (1, 0, 0) (1, 0, 1)" in told
    assert "in the usual order of corners row 35, or 220 by the outside" in told


def test_a_table_without_a_fault_has_none() -> None:
    found = checked(broken_tables.extract)
    assert found.right, found.advice
    assert "each of 254 configurations of one cell is answered rightly" in str(found.advice)


@pytest.mark.parametrize("method", ["asymptotic-decider", "trilinear-cubes", "lorensen-cline"])
def test_rows_of_correct_methods_are_right(method: str) -> None:
    """Whatever a cell does inside, with points of its own or without."""
    rows = configurations()
    assert len(rows) == 254
    for inside in rows:
        field = cell(inside)
        mesh = METHODS[method](field, 0.5)
        outcome = Outcome(Status.OK, mesh.vertices, mesh.simplices)
        assert not judged(inside, outcome, field).fault, row_told(inside)


def test_a_capped_surface_is_declared_so() -> None:
    pasted = json.loads(checked(broken_tables.capped).paste)
    assert pasted["domain"] == {"inset": -1.0, "end": "closed"}


def test_who_takes_bytes_only_is_measured_in_bytes() -> None:
    """Issue 12: an implementation that declines is asked what it can do."""
    found = checked(broken_tables.bytes_only)
    assert 'declare {"limits": {"types": ["uint8"]}}' in str(found.advice)
    assert "the interpolation is swapped on the edges along axis 1" in str(found.advice)


def test_who_takes_cubes_only_is_measured_in_cubes() -> None:
    found = checked(broken_tables.cubes_only)
    assert json.loads(found.paste)["limits"] == {"cubes": True}
    assert json.loads(found.paste)["conventions"] == {"units": "index"}


def test_nothing_is_pasted_where_the_surface_is_not_in_its_place() -> None:
    assert checked(broken_tables.padded).paste == ""
    assert checked(broken_tables.stretched).paste == ""


def test_a_declared_soup_is_not_told_of_a_seam_that_welding_closes() -> None:
    """A trial of 27 November: `grade` welds what is declared a soup, and so does `check`."""
    assert "open inside" in str(checked(broken_tables.seam).advice)
    assert "open inside" not in str(checked(broken_tables.seam, soup=0.0).advice)
