"""A failing case shrinks to the least block that still fails."""

import numpy as np
import pytest
from isograde.adapters import open_adapter
from isograde.cases import all_cases, blocks
from isograde.claims import CLAIMS
from isograde.declaration import Declaration
from isograde.model import Case, Claim, Finding, Limits, Trial, Verdict
from isograde.runner import Judged, Options, Worker, plan
from isograde.shrinking import _candidates, _fails, shrink
from isoref.field import Field

from tests.isograde.miniatures import Inside, Miniature, plain


def _holds_a_seven(trial: Trial) -> Finding:
    """Fails where a sample is 7."""
    return Finding(Verdict.FAIL if (trial.field.values == 7).any() else Verdict.PASS)


@pytest.mark.parametrize("place", [(0, 0, 0), (3, 4, 1), (6, 8, 5)])
def test_the_block_that_is_left_holds_the_fault_and_little_else(
    place: tuple[int, int, int],
) -> None:
    values = np.zeros((7, 9, 6))
    values[place] = 7
    case = Case("family/one", lambda: Field.of(values), (0.5,), values.size)
    claim = Claim("family.seven", "", "", 1, _holds_a_seven, needs_mesh=False)

    class Cases(dict[str, Case]):
        """Cases whose blocks are found by name."""

        def __missing__(self, name: str) -> Case:
            named = blocks.parse(name)
            assert named is not None
            return blocks.block(self[named[0]], named[1])

    adapter = open_adapter("isoref:asymptotic-decider")
    adapter.open(Limits())
    try:
        worker = Worker(adapter, Declaration("x"), Cases({case.id: case}), {claim.id: claim})
        found = shrink(worker, case, claim)
    finally:
        adapter.close()
    assert found is not None
    assert found.evidence is not None
    assert found.evidence.field.shape == (2, 2, 2)
    named = blocks.parse(found.case)
    assert named is not None
    assert all(start <= p < stop for p, (start, stop) in zip(place, named[1], strict=True))


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
    return _fails(worker, case, claim, 3)


def test_a_part_is_judged_where_the_claim_is_one_for_it() -> None:
    """By its tags; and never less than a cell."""
    assert judged_part(set(), (2, 2, 2)) is not None
    assert judged_part({"ties", "cells"}, (2, 2, 2)) is not None
    assert judged_part({"cells"}, (2, 2, 2)) is None
    assert judged_part(set(), (1, 2, 3)) is None
