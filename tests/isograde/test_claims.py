"""The grader is graded: right answers pass every claim, and each claim catches its miniature."""

from functools import partial

import numpy as np
import pytest
from isograde.cases.trilinear_cells import far
from isograde.claims import CLAIMS
from isograde.model import Case, Finding, Limits, Verdict
from isograde.runner import Task, Worker, claims_for
from isoref.field import Field

from tests.isograde.miniatures import (
    BROKEN,
    CORRECT,
    Inside,
    Miniature,
    apart,
    made,
    plain,
    star,
    together,
)


def noise(shape: tuple[int, int, int], seed: int) -> Field:
    """Values in steps of 1/64, so that single precision holds them."""
    return Field.of(np.rint(64 * np.random.default_rng(seed).normal(size=shape)) / 64)


def closed_noise(shape: tuple[int, int, int], seed: int) -> Field:
    values = np.pad(noise(shape, seed).values, 1, constant_values=-1.0)
    return Field.of(values, (0.5, 0.5, 0.5), (3.0, -4.0, 5.0))


def integers(shape: tuple[int, int, int], seed: int) -> Field:
    return Field.of(np.random.default_rng(seed).integers(0, 6, shape).astype(float))


def three_values(shape: tuple[int, int, int], seed: int) -> Field:
    return Field.of(np.random.default_rng(seed).integers(-1, 2, shape).astype(float))


def tunnel(name: str) -> Field:
    """A cell of configuration 12, with a tunnel or without it."""
    with_it, without_it = far("12.1.2", 0)
    return Field.of(with_it if name == "12.1.2" else without_it)


def case(name: str, build: partial[Field], isovalue: float, *tags: str) -> Case:
    return Case(name, build, (isovalue,), build().values.size, frozenset(tags))


CASES = {
    c.id: c
    for c in (
        case("bordered", partial(noise, (4, 5, 4), 3), 0.13, "posed", "noise"),
        case("closed", partial(closed_noise, (5, 4, 5), 1), 0.13, "noise"),
        case("integers", partial(integers, (3, 4, 3), 2), 2.5, "posed"),
        case("tunnel", partial(tunnel, "12.1.2"), 0.0, "trilinear"),
        case("no-tunnel", partial(tunnel, "12.1.1"), 0.0, "trilinear"),
        case("ties", partial(three_values, (4, 4, 4), 3), 0.0, "ties"),
        case("ties-closed", partial(three_values, (4, 4, 4), 5), 0.0, "ties"),
    )
}


def grade(
    miniature: Miniature, asked: dict[str, Case], only: str = ""
) -> dict[str, list[tuple[str, Finding]]]:
    """What each claim says of every case, but for variants of cases that are not posed."""
    adapter = Inside(miniature)
    declared = adapter.open(Limits())
    claims = {n: c for n, c in claims_for(declared).items() if n.startswith(only)}
    worker = Worker(adapter, declared, asked, claims)
    found: dict[str, list[tuple[str, Finding]]] = {name: [] for name in claims}
    for c in asked.values():
        wanted = tuple(
            name
            for name, claim in claims.items()
            if claim.applies_to(c) and ("posed" in c.tags or not claim.variants)
        )
        for name, finding in worker.judge(Task(c.id, wanted)).findings.items():
            found[name].append((c.id, finding))
    return found


def failures(miniature: Miniature, asked: dict[str, Case] = CASES) -> dict[str, str]:
    """The claims held against the miniature, or made to catch it, that do not all pass."""
    held: dict[str, str] = {}
    for name, findings in grade(miniature, asked).items():
        if not CLAIMS[name].held(miniature.declaration) and name != miniature.breaks:
            continue
        for c, finding in findings:
            fine = (Verdict.PASS, Verdict.UNSUPPORTED, Verdict.SKIP)
            if finding.verdict is Verdict.NOT_RUN:
                assert "judge failed" not in finding.detail, finding.detail
            elif finding.verdict not in fine:
                held.setdefault(name, f"{c}: {finding.verdict} {finding.detail}")
    return held


@pytest.mark.parametrize("miniature", CORRECT, ids=lambda m: m.name)
def test_a_right_answer_passes_everything(miniature: Miniature) -> None:
    """Whatever its conventions and its legal choices."""
    assert failures(miniature) == {}


@pytest.mark.parametrize("miniature", BROKEN, ids=lambda m: m.name)
def test_a_broken_one_is_caught_by_its_claim_and_what_follows(miniature: Miniature) -> None:
    """By no other claim, so that the claim is needed."""
    held = failures(miniature)
    assert miniature.breaks in held
    assert set(held) <= {miniature.breaks, *miniature.follows}, held


@pytest.mark.parametrize(
    "word", ["missing tunnel", "wrong face", "false tunnel", "non-manifold edge"]
)
def test_level_four_says_what_was_got_wrong(word: str) -> None:
    """Issue of the trilinear cell: each of the four words, with the case it was got wrong in."""
    miniature = next(m for m in BROKEN if m.name == word)
    said = [f for _, f in grade(miniature, CASES, "topology.trilinear")["topology.trilinear"]]
    wrong = [finding for finding in said if finding.verdict is Verdict.FAIL]
    assert any(f"{word} in " in finding.detail for finding in wrong)
    assert word in {fault for f in wrong for _, fault, _ in f.numbers["faults"]}


def full_of_ties(seed: int) -> Field:
    """A small field of few values: exact ties, differences of 1e-9, or values of all sizes."""
    rng = np.random.default_rng(seed)
    shape = tuple(int(n) for n in rng.integers(2, 5, 3))
    values = (
        rng.integers(-1, 2, shape).astype(float),
        rng.choice([-1.0, -1e-9, 0.0, 1e-9, 1.0], shape),
        rng.integers(-3, 4, shape).astype(float),
        rng.normal(size=shape) ** 9,
    )[seed % 4]
    return Field.of(values)


TIED = {c.id: c for c in (case(f"{n}", partial(full_of_ties, n), 0.0, "ties") for n in range(40))}


@pytest.mark.parametrize("miniature", [CORRECT[n] for n in (0, 2, 5, 6)], ids=lambda m: m.name)
def test_a_right_answer_passes_on_fields_full_of_ties(miniature: Miniature) -> None:
    """No claim mistakes what a tie leaves open for a fault."""
    assert failures(miniature, TIED) == {}


def alone(values: list[float]) -> dict[str, Case]:
    """A single cell with these corner values, last axis fastest, at isovalue 0."""
    field = Field.of(np.array(values).reshape(2, 2, 2))
    return {"cell": Case("cell", lambda: field, (0.0,), 8)}


def test_two_sheets_that_meet_in_a_point_are_caught() -> None:
    """Two are enough: the corners cut off at both ends of a diagonal share their middle."""
    cell = alone([2, -1, -1, -1, -1, -1, -1, 2])
    pinched = Miniature("pinched", made(cut=star, shared_middle=True))
    assert "topology.manifold" in failures(pinched, cell)
    assert failures(Miniature("stars", made(cut=star)), cell) == {}


def test_a_saddle_on_the_isovalue_may_be_joined_or_separated() -> None:
    """The level set is its asymptotes: level 3 holds neither answer against anybody."""
    for decide in (apart, together):
        either = Miniature("either", made(decide=decide), level=3)
        assert failures(either, alone([1, -1, -1, 1, -1, -1, -1, -1])) == {}
    clear = failures(Miniature("apart", plain, level=3), alone([2, -1, -1, 1, -1, -1, -1, -1]))
    assert set(clear) == {"topology.bilinear", "cells.frequencies"}
