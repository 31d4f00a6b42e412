"""Continuity in the isovalue: at the end of a tunnel, who moves as the level set, and who jumps."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest
from isograde.cases import FULL, all_cases, passing
from isograde.cases.trilinear_cells import TUNNELS, topology_of
from isograde.claims import CLAIMS
from isograde.claims.passing import farthest, moved
from isograde.declaration import Declaration, declaration_from
from isograde.model import Finding, Verdict
from isograde.oracles.complexes import Complex
from isograde.runner import Options, Task, Worker, claims_for, plan
from isoref import asymptotic_decider, trilinear_cubes
from isoref.fast.sweep import sweep
from isoref.field import Field
from isoref.methods import METHODS
from isoref.rule import Rule

from tests.isograde.judging import Here

CLAIM = "accuracy.continuity"
CASES = {case.id: case for case in passing.cases()}
# One tunnel of each kind: through the body of the cell, and beside a third sheet.
FEW = ["passing/4.2/1", "passing/13.5.2/0"]


def by_rule(rule: Rule) -> Callable[..., Any]:
    """The rule as an implementation."""

    def function(values: Any, isovalue: float, spacing: Any) -> Any:
        mesh = sweep(rule, Field.of(values, spacing), isovalue)
        return mesh.vertices, mesh.simplices

    return function


def by_method(name: str, values: Any, isovalue: float, spacing: Any) -> Any:
    """A method of isoref as an implementation."""
    mesh = METHODS[name](Field.of(values, spacing), isovalue)
    return mesh.vertices, mesh.simplices


def asked(function: Callable[..., Any], declared: Declaration, names: list[str]) -> list[Finding]:
    """What the claim says of the implementation on these cases."""
    chosen = {name: CASES[name] for name in names}
    worker = Worker(Here(function, declared), declared, chosen, claims_for(declared))
    return [worker.judge(Task(name, (CLAIM,))).findings[CLAIM] for name in names]


def test_the_isovalue_is_the_end_of_a_tunnel_and_of_nothing_else() -> None:
    """Beside it the cell has a tunnel, or none; its signs and faces are the same."""
    for name in ("4.2", "7.4.2"):
        cells = passing.cells_of(name, 0)
        assert len(cells) == passing.CELLS
        for cell, level in cells:
            step = passing.CLEAR / 4
            two = [topology_of(cell - level - way * step) for way in (-1, 1)]
            assert sorted(bool(one.tunnels) for one in two) == [False, True]
            assert two[0].signs == two[1].signs
            assert two[0].faces == two[1].faces


def test_the_cases_run_only_where_they_are_asked_for() -> None:
    """The plan's default run has none of them; a full run judges the claim on each."""
    declared = Declaration("here")
    claims, every = claims_for(declared), all_cases(0)
    assert len(CASES) == passing.CELLS * len(TUNNELS)
    assert set(CASES) <= set(every)
    default = plan(Options(), every, claims)
    assert default
    assert not [task for task in default if task.case in CASES or CLAIM in task.claims]
    full = plan(Options(full=True, only=(CLAIM,)), every, claims)
    assert [task.case for task in full] == list(CASES)
    assert not CLAIMS[CLAIM].promised


def test_tags_that_are_said_to_be_of_full_runs_are() -> None:
    """Every case with such a tag, and there is one of each."""
    every = all_cases(0).values()
    for tag in FULL:
        tagged = [case for case in every if tag in case.tags]
        assert tagged
        assert all("full" in case.tags for case in tagged)


def test_a_rule_with_points_on_the_tips_moves_as_the_level_set_does() -> None:
    """Order 1/2, as Lopes and Brodlie ask."""
    found = asked(by_rule(trilinear_cubes.CONTINUOUS), Declaration("here", level=4), FEW)
    assert [one.verdict for one in found] == [Verdict.PASS] * len(FEW)
    assert all(0.4 < one.numbers["order"] < 0.6 for one in found)


def test_flat_sheets_that_were_a_tunnel_jump_and_are_caught() -> None:
    """Of "accuracy.continuity": the plain rule has every tunnel right, and jumps at its end."""
    found = asked(by_rule(trilinear_cubes.RULE), Declaration("here", level=4), FEW)
    assert [one.verdict for one in found] == [Verdict.FAIL] * len(FEW)
    for one in found:
        assert one.numbers["last_move"] > 0.2
        assert abs(one.numbers["order"]) < 0.05
        assert "as the isovalue passes the saddle" in one.detail


@pytest.mark.parametrize(
    ("function", "said"),
    [
        (by_rule(asymptotic_decider.RULE), {}),
        (partial(by_method, "dual-marching-cubes"), {"vertices": "cells"}),
        (partial(by_method, "marching-tetrahedra-kuhn"), {"interpolant": "kuhn"}),
    ],
    ids=["no tunnels", "vertices in cells", "a split"],
)
def test_who_draws_no_tunnel_moves_with_the_crossings(
    function: Callable[..., Any], said: dict[str, Any]
) -> None:
    """Right answers of other families pass, with order 1."""
    (found,) = asked(function, declaration_from(said, "here"), FEW[:1])
    assert found.verdict is Verdict.PASS
    assert found.numbers["order"] > 0.9


def test_an_answer_that_does_not_move_is_no_evidence_and_none_at_all_is_a_fault() -> None:
    """Never a pass for who was not seen to move; never one for who has no surface there."""
    declared = Declaration("here")
    still = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])
    (found,) = asked(lambda *_: still, declared, FEW[:1])
    assert found.verdict is Verdict.SKIP

    def only_plain(values: Any, isovalue: float, spacing: Any) -> Any:
        return (still[0], still[1] if isovalue == 0 else still[1][:0])

    (found,) = asked(only_plain, declared, FEW[:1])
    assert found.verdict is Verdict.FAIL


def test_labels_are_not_asked() -> None:
    """Who sees sides only cannot move where no side changes."""
    assert not CLAIMS[CLAIM].families(declaration_from({"interpolant": "labels"}, "here"))


@pytest.mark.parametrize("corner", range(3))
def test_the_distance_of_meshes_is_that_of_the_corner_that_is_farthest(corner: int) -> None:
    """Whichever corner of a triangle it is, from the one mesh to the other and back."""
    flat = np.array([[0.0, 0, 0], [4, 0, 0], [0, 4, 0]])
    raised = flat.copy()
    raised[corner, 2] = 0.5
    plane, tip = Complex(flat, np.array([[0, 1, 2]])), Complex(raised, np.array([[0, 1, 2]]))
    assert farthest(tip, plane) == pytest.approx(0.5)
    assert moved(plane, tip) == moved(tip, plane) == pytest.approx(0.5)
