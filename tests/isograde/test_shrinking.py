"""A failing case shrinks to the least block that still fails."""

from typing import Any

import numpy as np
import pytest
from isograde.adapters import open_adapter
from isograde.cases import all_cases, blocks, given
from isograde.claims import CLAIMS
from isograde.declaration import Declaration, declaration_from
from isograde.model import Case, Claim, Finding, Limits, Trial, Verdict
from isograde.runner import Judged, NothingToRun, Options, Task, Worker, claims_for, plan
from isograde.shrinking import Shrinking, _candidates, shrink
from isoref.field import Field
from isoref.simplicial import extract

from tests.isograde import miniatures as mini
from tests.isograde.judging import Here
from tests.isograde.miniatures import Inside, Miniature, plain


def _holds_a_seven(trial: Trial) -> Finding:
    """Fails where a sample is 7 above its isovalue, rounded."""
    above = trial.field.values - trial.isovalues[0]
    return Finding(Verdict.FAIL if (above.round() == 7).any() else Verdict.PASS)


@pytest.mark.parametrize("place", [(0, 0, 0), (3, 4, 1), (6, 8, 5)])
def test_the_block_that_is_left_holds_the_fault_and_little_else(
    place: tuple[int, int, int],
) -> None:
    values = np.zeros((7, 9, 6))
    values[place] = 7.25
    case = Case("family/one", lambda: Field.of(values), (0.5,), values.size)
    claim = Claim("family.seven", "", "", 1, _holds_a_seven, needs_mesh=False)

    class Cases(dict[str, Case]):
        """Cases whose blocks are found by name, and cases spelt out."""

        def __missing__(self, name: str) -> Case:
            if (spelt := given.parse(name)) is not None:
                return spelt
            named = blocks.parse(name)
            assert named is not None
            return blocks.block(self[named[0]], named[1])

    adapter = open_adapter("isoref:asymptotic-decider")
    adapter.open(Limits())
    try:
        worker = Worker(adapter, Declaration("x"), Cases({case.id: case}), {claim.id: claim})
        first = worker.judge(Task(case.id, (claim.id,)))
        found = shrink(worker, case, claim, first)
    finally:
        adapter.close()
    assert found is not None
    assert found.evidence is not None
    values = found.evidence.field.values
    assert values.shape == (2, 2, 2)
    assert sorted(values.ravel().tolist()) == [-1.0] * 7 + [7.0]
    assert found.case.startswith("given/2x2x2/")


def test_a_block_stands_where_it_stood() -> None:
    case = all_cases(0)["analytic/sphere-uneven"]
    whole, part = case.build(), blocks.block(case, ((2, 5), (1, 4), (3, 8))).build()
    assert np.array_equal(part.values, whole.values[2:5, 1:4, 3:8])
    assert np.allclose(part.position([0, 0, 0]), whole.position([2, 1, 3]))


def test_a_block_of_a_block_is_a_block_of_the_whole() -> None:
    cases = all_cases(0)
    inner = blocks.block(cases["noise/white-5x6x7"], ((1, 5), (0, 5), (2, 7)))
    part = blocks.block(inner, ((2, 4), (1, 3), (0, 2)))
    assert part.id == "noise/white-5x6x7[3:5,1:3,2:4]"
    assert np.array_equal(part.build().values, cases[part.id].build().values)


def test_a_block_is_graded_by_its_name() -> None:
    name = "ties/noise-05[0:3,2:4,4:6]"
    cases = all_cases(0)
    assert cases[name].samples == 12
    assert cases[name].tags == {"ties"}
    tasks = plan(Options(only=(name, "topology.closed")), cases, CLAIMS)
    assert [(task.case, task.claims) for task in tasks] == [(name, ("topology.closed",))]


def test_a_block_of_no_case_is_no_case() -> None:
    with pytest.raises(KeyError):
        all_cases(0)["absent/one[0:2,0:2,0:2]"]
    with pytest.raises(KeyError):
        all_cases(0)["ties/noise-05[0:2"]


def test_candidates_drop_half_a_quarter_and_so_on_and_keep_two_samples() -> None:
    """Of every axis, from either end, wherever the range starts; the largest drop first."""
    found = list(_candidates(((2, 5), (7, 9), (1, 9))))
    left = [int(np.prod([stop - start for start, stop in ranges])) for ranges in found]
    assert left[:4] == [24, 24, 36, 36]
    assert set(found) == {
        ((2, 5), (7, 9), (1, 5)),
        ((2, 5), (7, 9), (5, 9)),
        ((2, 5), (7, 9), (1, 7)),
        ((2, 5), (7, 9), (3, 9)),
        ((2, 5), (7, 9), (1, 8)),
        ((2, 5), (7, 9), (2, 9)),
        ((2, 4), (7, 9), (1, 9)),
        ((3, 5), (7, 9), (1, 9)),
    }


def judged_part(claim_tags: set[str], shape: tuple[int, ...]) -> Judged | None:
    """What `_fails` says of a case tagged "ties", for a claim that always fails."""
    field = Field.of(np.ones(shape))
    case = Case("ties/one", lambda: field, (0.5,), field.values.size, frozenset({"ties"}))
    claim = Claim(
        "family.never",
        "",
        "",
        1,
        lambda _: Finding(Verdict.FAIL),
        needs_mesh=False,
        tags=frozenset(claim_tags),
    )
    adapter = Inside(Miniature("plain", plain))
    worker = Worker(adapter, Declaration("x"), {case.id: case}, {claim.id: claim})
    first = worker.judge(Task(case.id, (claim.id,)))
    return Shrinking(worker, claim, first, np.inf).fails(case)


def test_a_part_is_judged_where_the_claim_is_one_for_it() -> None:
    """By its tags; and never less than a cell."""
    assert judged_part(set(), (2, 2, 2)) is not None
    assert judged_part({"ties", "cells"}, (2, 2, 2)) is not None
    assert judged_part({"cells"}, (2, 2, 2)) is None
    assert judged_part(set(), (1, 2, 3)) is None


# --- values -------------------------------------------------------------------------------------


def simplest(run: Any, name: str, claim: str, **says: Any) -> Judged:
    """What is left of a case on which this claim fails of this function."""
    declared = declaration_from({"level": 4, **says}, "it")
    worker = Worker(Here(run, declared), declared, all_cases(0), claims_for(declared))
    first = worker.judge(Task(name, (claim,)))
    assert first.findings[claim].verdict is Verdict.FAIL, first.findings[claim]
    # On a busy machine six seconds are few tries.
    found = shrink(worker, all_cases(0)[name], worker.claims[claim], first, seconds=120)
    assert found is not None
    assert found.findings[claim].verdict is Verdict.FAIL
    assert found.general == first.general
    return found


def test_a_pair_is_made_of_ones_where_ones_will_do() -> None:
    """Issue 12: fewest digits, then ones, then signs; the hole of 1987 needs one other number.

    With ones alone the saddle of the face would be on the isovalue, and the field not general.
    """
    found = simplest(mini.made(decide=mini.by_cell), "pairs/0217", "topology.closed")
    values = found.case.rsplit("/", 1)[1].split(",")
    assert found.case.startswith("given/3x2x2/")
    assert sum(value not in ("1", "-1") for value in values) == 1
    assert values.count("1") == 5


def test_a_cell_in_a_larger_field_is_left_alone_with_its_neighbour() -> None:
    """Issue 12: 18 samples show what was reported with 64."""
    found = simplest(mini.made(decide=mini.by_cell), "noise/white-5x6x7", "topology.closed")
    assert found.case.startswith("given/")
    assert all_cases(0)[found.case].samples == 12


@pytest.mark.parametrize("name", ["contours/waves", "curves/noise"])
def test_other_kinds_are_spelt_out_too(name: str) -> None:
    kind = all_cases(0)[name].kind

    def missing(values: Any, isovalue: Any, spacing: Any) -> Any:
        levels = np.atleast_1d(isovalue)
        field = Field.of(values, spacing, dimension=kind.n)
        mesh = extract(field, tuple(levels.tolist()))
        return mesh.vertices, mesh.simplices[::2]

    found = simplest(
        missing, name, "topology.sides", level=2, interpolant="kuhn",
        limits={"kinds": [list(kind)]},
    )  # fmt: skip
    assert found.case.startswith("given/")
    again = all_cases(0)[found.case]
    assert again.kind == kind
    assert again.samples == 2**kind.n


def test_a_case_of_bytes_keeps_its_bytes_where_they_matter() -> None:
    """What fails for uint8 alone is shown with uint8."""
    found = simplest(mini.in_their_type, "bodies/3-1/sphere-16-uint8", "topology.sides")
    assert "/as=uint8/" in found.case or "sphere-16-uint8[" in found.case


@pytest.mark.parametrize(
    ("text", "shape", "levels", "dtype"),
    [
        ("given/2x2x2/1,2,3,4,5,6,7,8", (2, 2, 2), (0.0,), "float64"),
        ("given/2x3/at=0.5/as=uint8/0,1,2,1,0,1", (2, 3), (0.5,), "uint8"),
        ("given/2x2/at=0,1/by=1,2.5/-1,1,1,1,0,2,3,0", (2, 2), (0.0, 1.0), "float64"),
    ],
)
def test_a_case_spelt_out_is_its_name(
    text: str, shape: tuple[int, ...], levels: tuple[float, ...], dtype: str
) -> None:
    case = given.parse(text)
    assert case is not None
    field = case.build()
    assert (field.shape, case.isovalues, str(field.values.dtype)) == (shape, levels, dtype)
    assert given.name(field, levels) == text
    assert all_cases(0)[text].id == text
    tasks = plan(Options(only=(text, "topology.sides")), all_cases(0), CLAIMS)
    assert [(task.case, task.claims) for task in tasks] == [(text, ("topology.sides",))]


@pytest.mark.parametrize(
    "text",
    [
        "given/2x2x2/1,2", "given/2x2/a,b,c,d", "given/0x2/", "given/2x2/as=void8/1,2,3,4",
        "given/2x2/by=0,1/1,2,3,4", "given/2x2/nan,1,1,1", "given/99999x99999/1",
    ],
)  # fmt: skip
def test_what_spells_nothing_out_is_no_case(text: str) -> None:
    assert given.parse(text) is None
    with pytest.raises(KeyError):
        all_cases(0)[text]
    with pytest.raises(NothingToRun, match="spells no case out"):
        plan(Options(only=(text,)), all_cases(0), CLAIMS)
