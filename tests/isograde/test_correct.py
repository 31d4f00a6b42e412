"""Right answers pass: correct extractors of every family reach the top of their ladder.

The issue "One judge for every kind of answer": at least twenty correct extractors of different
families, conventions and layouts pass everything they promise, and none declares more than the four
words, its conventions and its limits. Here each is judged on a chosen part of the plan; `make
correct` judges them on the whole of it.
"""

from __future__ import annotations

import pytest
from isograde.cases import all_cases
from isograde.commands.console import Exit, status_of
from isograde.declaration import declaration_from
from isograde.model import Case

from tests.isograde.families import CORRECT, NARROW
from tests.isograde.judging import Here
from tests.isograde.reporting import graded

# Ties, a tunnel, a pair that shares a face, nothing at all, and beside them one field that is posed
# in all ways: a cell with ambiguous faces, or some noise where a lattice of its own needs room.
CHOSEN = (
    "ties/squares",
    "trilinear/each/7.4.2/0",
    "trilinear/pair/10.1.2/0-",
    "simplices/positive-3-1",
    "simplices/sphere",
    "bodies/3-1/sphere-16-float64",
    "bodies/3-1/sphere-16-float32",
    "bodies/3-1/sphere-17-uint8",
)
POSED = {"own": "noise/white-5x6x7"}
WORDS = {
    "name", "version", "level", "interpolant", "vertices", "domain", "mesh", "conventions",
    "limits", "not_promised", "notes",
}  # fmt: skip


def chosen(posed: str) -> tuple[Case, ...]:
    """The chosen cases, one of them posed; `test_bodies_claim` has more bodies for all."""
    return tuple(all_cases()[name] for name in (posed, *CHOSEN))


def test_there_are_more_than_twenty_families_and_they_say_no_more_than_they_may() -> None:
    """Four words, conventions, limits; what is not promised is only the nets' manifold."""
    assert len(CORRECT) >= 20
    for name, family in CORRECT.items():
        assert set(family.says) <= WORDS, name
        assert set(family.says.get("not_promised", ())) <= {"topology.manifold"}, name


@pytest.mark.slow
@pytest.mark.parametrize("name", [*CORRECT, *NARROW])
def test_a_correct_extractor_breaks_no_promise_and_reaches_its_top(name: str) -> None:
    """On evidence: known bodies came out, and every claim of its levels could have failed."""
    family = {**CORRECT, **NARROW}[name]
    declared = declaration_from(family.says, name)
    asked = chosen(POSED.get(declared.vertices, "cells/outside/006"))
    report = graded(Here(family.function, declared), f"python:families:{name}", asked)
    broken = {s.id: s.failure and (s.failure.case, s.failure.detail) for s in report.broken}
    assert not broken
    assert status_of(report) is Exit.HOLDS
    expected = 1 if declared.not_promised else min(declared.level, declared.top)
    lacking = [s.id for rung in report.rungs[: expected + 1] for s in rung.lacking]
    assert report.reached is not None
    assert report.reached >= expected, lacking
