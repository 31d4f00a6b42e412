"""Claims on calls in company and on their cost: a sound extractor passes, each fault is caught."""

from __future__ import annotations

from functools import cache

import pytest
from isograde.cases import all_cases
from isograde.model import Finding, Limits, Verdict
from isograde.runner import Options, Task, Worker

BROKEN = {
    "buffered": "calls.buffer",
    "by_array": "calls.again",
    "with_globals": "calls.threads",
    "leaking": "calls.leak",
    "searching": "calls.growth",
    "hoarding": "calls.growth",
}
CLAIMS = ("calls.buffer", "calls.again", "calls.threads", "calls.growth", "calls.leak")


@cache
def judged(spec: str, case: str) -> dict[str, Finding]:
    """What the five claims say of an implementation behind a real worker."""
    worker = Worker.open(spec, Options(limits=Limits(seconds=20)))
    try:
        return dict(worker.judge(Task(case, CLAIMS)).findings)
    finally:
        worker.adapter.close()


@pytest.mark.parametrize(
    ("spec", "case"),
    [
        ("isoref:asymptotic-decider", "cost/surfaces"),
        ("isoref:diconex-mixed", "cost/contours"),
        ("isoref:marching-faces", "cost/curves"),
    ],
)
def test_the_reference_bears_company_and_gives_back(spec: str, case: str) -> None:
    """Of every kind that has a case; and it promises what several threads get."""
    assert {name: one.verdict for name, one in judged(spec, case).items()} == dict.fromkeys(
        CLAIMS, Verdict.PASS
    )


@pytest.mark.slow
@pytest.mark.parametrize(("name", "claim"), BROKEN.items())
def test_each_fault_is_caught_by_its_claim(name: str, claim: str) -> None:
    """A buffer, what is known by its array, a global, a leak, a search among all, a table of pairs.

    By no other, but that threads write over a buffer too.
    """
    found = judged(f"python:tests.isograde.mistaken:{name}", "cost/surfaces")
    failed = {one for one, said in found.items() if said.verdict is Verdict.FAIL}
    assert claim in failed
    assert failed <= {claim, *(("calls.threads",) if name == "buffered" else ())}


def test_who_answers_one_question_at_a_time_is_not_judged() -> None:
    """Nothing passes that was not asked."""
    from isograde.cases.cost import SHAPES
    from isograde.declaration import Declaration

    from tests.isograde.judging import Here, grade
    from tests.isograde.mistaken import correct

    case = all_cases()["cost/surfaces"]
    assert case.kind in SHAPES
    found = [f for _, name, f in grade(Here(correct, Declaration("c")), [case], "calls.")]
    assert [one.verdict for one in found] == [Verdict.SKIP] * len(CLAIMS)
