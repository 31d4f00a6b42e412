"""Every fault is caught, by the claim that must; the engine they are made of is sound."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from isograde.cases import FULL, all_cases
from isograde.claims import CLAIMS
from isograde.declaration import declaration_from
from isograde.model import BAD, Verdict
from isograde.runner import Task, Worker, claims_for
from isoref import Mesh, extract

from tests.isograde import test_claims_calls
from tests.isograde.faults import matrix, sharing
from tests.isograde.faults.catching import broken, rank, tasks_of, worker_of
from tests.isograde.faults.engine import Engine
from tests.isograde.faults.histories import Trilinear
from tests.isograde.faults.matrix import caught
from tests.isograde.faults.registry import FAULTS, SURVIVORS
from tests.isograde.judging import Here

CAUGHT = caught()
#: Claims on calls need a process of their own: their faults stand with their tests.
CALLS = set(test_claims_calls.BROKEN.values())


def test_there_are_enough_faults_and_who_survives_is_named() -> None:
    """Issue 13: at least 120, at least 40 of them blind, many after public reports."""
    assert len(CAUGHT) >= 120
    assert sum(FAULTS[name].blind for name in CAUGHT) >= 40
    assert sum(bool(FAULTS[name].report) for name in CAUGHT) >= 40
    assert not set(CAUGHT) & set(SURVIVORS)
    assert set(CAUGHT) | set(SURVIVORS) == set(FAULTS)


def test_each_claim_is_first_for_at_least_one_fault() -> None:
    """A claim that is never first could be left out.

    The faults of claims that only full runs ask stand with their tests.
    """
    first = {FAULTS[name].first for name in CAUGHT}
    alone = {name for name, claim in CLAIMS.items() if claim.tags and claim.tags <= FULL}
    assert alone == {"accuracy.continuity", "accuracy.shapes", "curves.confidence"}
    assert first | CALLS | alone == set(CLAIMS)


def test_reports_are_addresses_of_public_threads() -> None:
    """And no name is on two faults."""
    reports = [fault.report for fault in FAULTS.values() if fault.report]
    assert len(set(reports)) >= 30
    assert all(report.startswith("https://") for report in reports)


@pytest.mark.parametrize("name", sorted(CAUGHT))
def test_a_fault_is_caught_by_the_claim_that_must(name: str) -> None:
    """On the case that caught it no lower promise is broken, as far as one call can tell.

    Lower promises that need variants were judged when the case was found, and take too long here.
    """
    fault, case = FAULTS[name], CAUGHT[name]["case"]
    worker = worker_of(fault)
    task = next(task for task in tasks_of(worker) if task.case == case)
    asked = tuple(
        claim
        for claim in task.claims
        if claim == fault.first
        or (
            rank(claim) < rank(fault.first)
            and not worker.claims[claim].variants
            and worker.claims[claim].held(worker.declaration)
        )
    )
    assert fault.first in asked
    assert worker.claims[fault.first].held(worker.declaration)
    # What an extractor keeps from call to call shows on a case that comes after another.
    if before := CAUGHT[name].get("after"):
        assert broken(worker, worker.judge(Task(before, asked))) == []
    assert broken(worker, worker.judge(Task(case, asked))) == [fault.first]
    assert CAUGHT[name]["claim"] == fault.first


@pytest.mark.parametrize(
    ("engine", "method"), [(Engine, "asymptotic-decider"), (Trilinear, "trilinear-cubes")]
)
def test_the_engine_draws_what_the_reference_draws(engine: type[Engine], method: str) -> None:
    """A fault is what it changes, and nothing else: the engine itself has none."""
    for seed in range(3):
        values = np.random.default_rng(seed).normal(size=(5, 6, 7))
        mine = Mesh.of(*engine()(values, 0.1, (1.0, 2.0, 0.5))).canonical()
        theirs = extract(values, 0.1, (1, 2, 0.5), method=method).canonical()
        assert len(mine.simplices) > 100
        assert np.array_equal(mine.simplices, theirs.simplices)
        assert np.allclose(mine.vertices, theirs.vertices, rtol=0, atol=1e-12)


@pytest.mark.parametrize("case", ["noise/white-5x6x7", "ties/point", "pairs/0000"])
def test_the_sound_engine_passes_where_faults_are_caught(case: str) -> None:
    """Every claim that is held against it, posed in every way."""
    declared = declaration_from({"level": 3}, "engine")
    claims = claims_for(declared)
    worker = Worker(Here(Engine(), declared), declared, all_cases(), claims)
    asked = tuple(
        name
        for name, claim in claims.items()
        if claim.applies_to(all_cases()[case]) and claim.held(declared)
    )
    verdicts = {name: one.verdict for name, one in worker.judge(Task(case, asked)).findings.items()}
    fine = {Verdict.PASS, Verdict.SKIP, Verdict.UNSUPPORTED}
    assert {name: one for name, one in verdicts.items() if one not in fine} == {}
    assert Verdict.PASS in verdicts.values()


@pytest.mark.parametrize("name", ["row-short", "zero-is-halfway"])
def test_verdicts_that_are_shared_are_those_that_are_judged(name: str, tmp_path: Path) -> None:
    """`sharing`: where the fault answers as the sound engine does, and where it does not."""
    sound, worker = sharing.Sound(tmp_path / "sound.jsonl"), worker_of(FAULTS[name])
    shared = 0
    for case in ("cells/outside/001", "ties/point", "pairs/3951", "noise/white-7x5x6"):
        task = next(task for task in tasks_of(worker) if task.case == case)
        asked = [one for one in task.claims if not one.startswith(("symmetry.", "range."))]
        found = sharing.verdicts(worker, task, sound, asked)
        shared += found.pop("shared", 0)
        judged = worker.judge(Task(case, tuple(asked))).findings
        assert set(found) == {claim for claim, one in judged.items() if one.verdict in BAD}
    assert shared > 20
    assert set(sharing.Sound(tmp_path / "sound.jsonl").known) == set(sound.known)


def test_a_fault_of_another_family_shares_nothing() -> None:
    """Its verdicts hang on what it declares."""
    assert matrix.sound_for(worker_of(FAULTS["row-short"])) is not None
    assert matrix.sound_for(worker_of(FAULTS["duals-of-nielson"])) is None
