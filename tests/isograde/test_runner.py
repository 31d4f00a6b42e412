"""The runner asks each request once, orders claims, and keeps a fault where it belongs."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from dataclasses import field as fresh

import numpy as np
import pytest
from isograde import runner
from isograde.cases import all_cases
from isograde.declaration import Declaration, Scope
from isograde.model import (
    CONTOURS,
    SURFACES,
    Case,
    Claim,
    Finding,
    Limits,
    Outcome,
    Request,
    Status,
    Trial,
    Verdict,
)
from isograde.runner import NothingToRun, Options, Task, Worker, cases_for, claims_for, plan
from isoref.field import Field

TRIANGLE = Outcome(Status.OK, np.eye(3), np.array([[0, 1, 2]]))


@dataclass
class Adapter:
    """Answers every request with the same outcome, and remembers what it was asked."""

    outcome: Outcome = TRIANGLE
    asked: list[tuple[str, str]] = fresh(default_factory=list)

    def open(self, limits: Limits) -> Declaration:
        """A declaration of nothing."""
        del limits
        return Declaration("stub")

    def run(self, request: Request) -> Outcome:
        """The same outcome as ever."""
        self.asked.append((request.case, request.variant))
        return self.outcome

    def close(self) -> None:
        """Nothing to stop."""


def _case(name: str = "family/one", *tags: str) -> Case:
    values = np.zeros((2, 2, 2))
    return Case(name, lambda: Field.of(values), (0.5,), 8, frozenset(tags))


def _passes(trial: Trial) -> Finding:
    del trial
    return Finding(Verdict.PASS)


def _fails(trial: Trial) -> Finding:
    del trial
    return Finding(Verdict.FAIL, "as it should", {"count": 1})


def _claim(name: str, judge: Callable[[Trial], Finding] = _passes, **more: object) -> Claim:
    return Claim(name, "rule", "source", 1, judge, **more)  # type: ignore[arg-type]


def _judged(
    adapter: Adapter, *claims: Claim, declaration: Declaration | None = None
) -> runner.Judged:
    case = _case()
    by_id = {claim.id: claim for claim in claims}
    worker = Worker(adapter, declaration or Declaration("stub"), {case.id: case}, by_id)
    return worker.judge(Task(case.id, tuple(by_id)))


def test_a_request_is_run_once_however_many_claims_need_it() -> None:
    adapter = Adapter()
    judged = _judged(adapter, _claim("a.one"), _claim("a.two"), _claim("a.three", needs_mesh=False))
    assert adapter.asked == [("family/one", "plain")]
    assert judged.calls == 1
    assert {finding.verdict for finding in judged.findings.values()} == {Verdict.PASS}


def test_judges_of_the_raw_outcome_come_first() -> None:
    judged = _judged(Adapter(), _claim("a.mesh"), _claim("b.raw", needs_mesh=False))
    assert list(judged.findings) == ["b.raw", "a.mesh"]


def test_without_a_mesh_later_claims_are_not_run() -> None:
    adapter = Adapter(Outcome(Status.RAISED, detail="ValueError"))
    judged = _judged(adapter, _claim("a.mesh"), _claim("b.raw", _fails, needs_mesh=False))
    assert judged.findings["a.mesh"].verdict is Verdict.NOT_RUN
    assert judged.findings["b.raw"].verdict is Verdict.FAIL


def test_a_declined_call_is_unsupported() -> None:
    judged = _judged(Adapter(Outcome(Status.DECLINED, detail="too thin")), _claim("a.mesh"))
    assert judged.findings["a.mesh"] == Finding(Verdict.UNSUPPORTED, "too thin")


@pytest.mark.parametrize("status", [Status.TIMEOUT, Status.MEMORY])
def test_who_is_too_slow_for_a_large_field_has_declined_it(status: Status) -> None:
    """A small field must be answered in time all the same."""
    for tags, verdict in ((("large",), Verdict.UNSUPPORTED), ((), Verdict.NOT_RUN)):
        case = _case("family/one", *tags)
        stub = Adapter(Outcome(status, detail="no answer"))
        worker = Worker(stub, Declaration("stub"), {case.id: case}, {"a": _claim("a")})
        assert worker.judge(Task(case.id, ("a",))).findings["a"].verdict is verdict


def test_a_field_outside_the_limits_is_not_sent() -> None:
    adapter = Adapter()
    judged = _judged(
        adapter, _claim("a.mesh"), declaration=Declaration("stub", limits=Scope(least=3))
    )
    assert adapter.asked == []
    assert judged.findings["a.mesh"].verdict is Verdict.UNSUPPORTED
    assert "fewer than 3 samples" in judged.findings["a.mesh"].detail
    assert judged.calls == 0


def test_what_is_not_promised_is_judged_all_the_same() -> None:
    declaration = Declaration("stub", not_promised=frozenset({"a.*"}))
    claim = _claim("a.mesh", _fails)
    judged = _judged(Adapter(), claim, declaration=declaration)
    assert judged.findings["a.mesh"].verdict is Verdict.FAIL
    assert not claim.held(declaration)
    assert claim.held(Declaration("stub"))
    assert replace(claim, firm=True).held(declaration)


def test_a_case_says_whether_its_field_is_in_general_position() -> None:
    assert _judged(Adapter(), _claim("a.mesh")).general is True
    tied = Case("family/tied", lambda: Field.of(np.full((2, 2, 2), 0.5)), (0.5,), 8)
    worker = Worker(Adapter(), Declaration("stub"), {tied.id: tied}, {"a": _claim("a")})
    assert worker.judge(Task(tied.id, ("a",))).general is False


def test_cases_and_claims_follow_from_kinds_and_family() -> None:
    contours = Declaration("contours", limits=Scope(kinds=((2, 1),)))
    assert {case.kind for case in cases_for(contours, 0).values()} <= {CONTOURS}
    assert {case.kind for case in cases_for(Declaration("x"), 0).values()} == {SURFACES}
    own = Declaration("own", vertices="own", reach=1.0)
    every, less = claims_for(Declaration("x")), claims_for(own)
    assert "symmetry.orientation" in every
    assert "symmetry.orientation" not in less
    assert set(less) < set(every)


def test_a_judge_that_raises_is_the_graders_fault() -> None:
    def breaks(trial: Trial) -> Finding:
        raise ZeroDivisionError(trial.case.id)

    finding = _judged(Adapter(), _claim("a.mesh", breaks)).findings["a.mesh"]
    assert finding.verdict is Verdict.NOT_RUN
    assert "the grader's judge failed: ZeroDivisionError" in finding.detail


def test_a_failed_case_is_kept_whole_and_a_passed_one_is_not() -> None:
    failed = _judged(Adapter(), _claim("a.mesh", _fails))
    assert failed.evidence is not None
    assert failed.evidence.outcomes["plain"] is TRIANGLE
    assert _judged(Adapter(), _claim("a.mesh")).evidence is None


def test_the_runner_gives_up_on_an_implementation_that_always_hangs() -> None:
    adapter = Adapter(Outcome(Status.TIMEOUT, detail="no answer"))
    cases = {f"family/{i}": _case(f"family/{i}") for i in range(runner.PATIENCE + 3)}
    claim = _claim("a.raw", _fails, needs_mesh=False)
    worker = Worker(adapter, Declaration("stub"), cases, {claim.id: claim})
    judged = [worker.judge(Task(name, (claim.id,))) for name in cases]
    assert len(adapter.asked) == runner.PATIENCE
    assert judged[-1].findings["a.raw"].verdict is Verdict.NOT_RUN
    assert "given up" in judged[-1].findings["a.raw"].detail


CASES = {
    name: _case(name, *tags)
    for name, tags in {
        "cells/1": ("cells", "posed"),
        "cells/2": ("cells",),
        "noise/1": ("noise", "full"),
    }.items()
}
CLAIMS = {
    claim.id: claim
    for claim in (
        _claim("topology.closed"),
        _claim("symmetry.scaled", variants=("scaled",)),
        _claim("cases.legal", tags=frozenset({"cells"})),
    )
}


def _planned(**options: object) -> dict[str, tuple[str, ...]]:
    tasks = plan(Options(**options), CASES, CLAIMS)  # type: ignore[arg-type]
    return {task.case: task.claims for task in tasks}


def test_the_default_plan_leaves_out_full_cases_and_variants_of_all_but_posed_ones() -> None:
    assert _planned() == {
        "cells/1": ("topology.closed", "symmetry.scaled", "cases.legal"),
        "cells/2": ("topology.closed", "cases.legal"),
    }


def test_the_full_plan_has_all_that_applies() -> None:
    assert _planned(full=True) == {
        "cells/1": tuple(CLAIMS),
        "cells/2": tuple(CLAIMS),
        "noise/1": ("topology.closed", "symmetry.scaled"),
    }


def test_the_full_plan_poses_no_pair_and_nothing_large_in_every_way() -> None:
    large = runner.POSED_SAMPLES + 1
    cases = {
        "cells/1": _case("cells/1", "posed"),
        "pairs/1": _case("pairs/1", "pairs"),
        "real/1": Case("real/1", _case().build, (0.5,), large, frozenset()),
    }
    planned = {task.case: task.claims for task in plan(Options(full=True), cases, CLAIMS)}
    assert [name for name, claims in planned.items() if "symmetry.scaled" in claims] == ["cells/1"]


def test_only_chooses_by_case_or_by_claim() -> None:
    assert list(_planned(only=("cells/*",))) == ["cells/1", "cells/2"]
    assert set(_planned(only=("topology.*",)).values()) == {("topology.closed",)}
    assert _planned(only=("cells/1", "cases.*")) == {"cells/1": ("cases.legal",)}


def test_a_case_named_in_full_is_judged_in_full() -> None:
    assert _planned(only=("noise/1",)) == {"noise/1": ("topology.closed", "symmetry.scaled")}
    assert "symmetry.scaled" in _planned(only=("cells/2",))["cells/2"]


def test_a_plan_without_tasks_says_so() -> None:
    with pytest.raises(NothingToRun, match="nothing matches absent"):
        plan(Options(only=("absent",)), CASES, CLAIMS)


def test_two_processes_find_what_one_finds() -> None:
    """The findings on a portion of the cells do not depend on the number of processes."""
    spec, cases = "isoref:lorensen-cline", all_cases(0)
    claims = claims_for(Declaration(spec))
    one, two = Options(only=("pairs/02*",)), Options(only=("pairs/02*",), jobs=2)
    tasks = plan(one, cases, claims)
    worker = Worker.open(spec, one)
    try:
        alone = list(runner.run(spec, tasks, one, worker))
    finally:
        worker.adapter.close()
    shared = list(runner.run(spec, tasks, two))
    assert [(j.case, j.findings) for j in alone] == [(j.case, j.findings) for j in shared]
    assert any(f.verdict is Verdict.FAIL for j in alone for f in j.findings.values())
