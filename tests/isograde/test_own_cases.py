"""Cases of the user's own: what is written is read again, and what is no case is refused."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some
from hypothesis.extra import numpy as arrays
from isograde.cases import own
from isograde.declaration import Declaration
from isograde.runner import Options, cases_for, claims_for, plan
from isoref.field import Field

CELL = Field.of([[[1.0, -1.0], [-1.0, -1.0]], [[-1.0, -1.0], [-1.0, 1e-300]]], (1, 2, 0.5))


def entry(**changes: Any) -> dict[str, Any]:
    """The entry of one cell, with changes."""
    return {**own.entry_of(CELL, [0.25], "topology.closed", "mine", "a hole"), **changes}


@given(
    some.sampled_from(["<f8", ">f8", "<f4", "<f2", "|u1", ">i2", "|b1", "<u8", "<i8"]).flatmap(
        lambda kind: arrays.arrays(
            np.dtype(kind),
            arrays.array_shapes(min_dims=3, max_dims=3, max_side=3),
            elements=arrays.from_dtype(np.dtype(kind), allow_nan=False, allow_infinity=False),
        )
    )
)
def test_every_number_of_every_type_comes_back(values: Any) -> None:
    """Through JSON text, bit for bit, and in the same byte order."""
    field = Field.of(values, (1, 2, 3))
    written = own.entry_of(field, [0.1], "cells.legal", "mine", "")
    case = own.case_of(json.loads(json.dumps(written)))
    back = case.build()
    assert back.values.dtype == field.values.dtype
    assert back.values.tobytes() == np.ascontiguousarray(field.values).tobytes()
    assert back.spacing == field.spacing
    assert case.isovalues == (0.1,)


def test_a_file_is_added_to_and_names_no_case_twice(tmp_path: Path) -> None:
    """The id is made of what a case holds, so that the same failure is kept once."""
    file = tmp_path / "new" / "cases.json"
    assert [one["id"] for one in own.add(file, [entry()])] == [entry()["id"]]
    assert own.add(file, [entry()]) == []
    other = own.entry_of(CELL, [0.5], "topology.closed", "mine", "a hole")
    assert len(own.add(file, [entry(), other])) == 1
    assert [case.isovalues for case in own.read(file)] == [(0.25,), (0.5,)]
    assert [path.name for path in file.parent.iterdir()] == ["cases.json"]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"id": "../../etc/passwd"}, "own/"),
        ({"id": "own/a b"}, "own/"),
        ({"id": 7}, "own/"),
        ({"shape": [2, 2]}, "2"),
        ({"shape": [2, 2, 10**9]}, "samples"),
        ({"shape": [2, 2, 3]}, "do not fill"),
        ({"shape": [0, 2, 2]}, "lattice"),
        ({"type": "O"}, "real numbers"),
        ({"type": "<c16"}, "real numbers"),
        ({"type": "|u1"}, "own/"),
        ({"type": "<i8"}, "no number of type"),
        ({"type": "nonsense"}, "nonsense"),
        ({"values": [[1] * 8, "x"]}, "own/"),
        ({"values": [float("nan")] * 8}, "no number"),
        ({"values": ["1"] * 8}, "no number"),
        ({"isovalues": [0.1, 0.2]}, "1 finite isovalues"),
        ({"isovalues": [float("inf")]}, "1 finite isovalues"),
        ({"isovalues": "x"}, "own/"),
        ({"spacing": [1, 1]}, "spacing"),
        ({"spacing": [1, 1, -1]}, "spacing"),
        ({"kind": [3, 2]}, "own/"),
        ({"kind": [3]}, "own/"),
        ({"kind": None}, "own/"),
    ],
)
def test_what_is_no_case_is_refused_by_name(changes: dict[str, Any], said: str) -> None:
    """The message holds what was wrong."""
    with pytest.raises(own.OwnCasesError, match=said):
        own.case_of(entry(**changes))


@pytest.mark.parametrize("missing", ["id", "kind", "shape", "values", "isovalues", "spacing"])
def test_what_is_missing_is_named(missing: str) -> None:
    whole = entry()
    del whole[missing]
    with pytest.raises(own.OwnCasesError, match=missing):
        own.case_of(whole)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        '{"format": "isograde-cases-1"}',
        "[" * 100_000,
        '{"format": "other"}',
        "\xff",
    ],
)
def test_what_is_no_file_of_cases_is_refused(tmp_path: Path, text: str) -> None:
    """And is not overwritten."""
    file = tmp_path / "cases.json"
    file.write_bytes(text.encode("latin-1"))
    with pytest.raises(own.OwnCasesError, match=r"cases.json"):
        own.read(file)
    with pytest.raises(own.OwnCasesError):
        own.add(file, [entry()])
    assert file.read_bytes() == text.encode("latin-1")


def test_an_absent_file_is_said_to_be_absent(tmp_path: Path) -> None:
    with pytest.raises(own.OwnCasesError, match="No such file"):
        own.read(tmp_path / "absent.json")


def test_own_cases_are_judged_by_every_claim_beside_the_plan(tmp_path: Path) -> None:
    """`grade --cases`: after the plan, in every way."""
    file = tmp_path / "cases.json"
    own.add(file, [entry()])
    declared = Declaration("mine")
    cases = cases_for(declared, 0, own.read(file))
    claims = claims_for(declared)
    whole = plan(Options(), cases, claims)
    assert whole[-1].case == entry()["id"]
    assert "symmetry.orientation" in whole[-1].claims
    assert len(whole) == 1 + len(plan(Options(), cases_for(declared, 0), claims))
    assert [task.case for task in plan(Options(only=("own/*",)), cases, claims)] == [entry()["id"]]


def test_cases_of_other_kinds_are_left_out(tmp_path: Path) -> None:
    """As those of the plan are."""
    file = tmp_path / "cases.json"
    square = Field.of([[1.0, 0.0], [0.0, 1.0]])
    own.add(file, [own.entry_of(square, [0.5], "cells.legal", "mine", "")])
    assert not any(
        name.startswith("own/") for name in cases_for(Declaration("mine"), 0, own.read(file))
    )
