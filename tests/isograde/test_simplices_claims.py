"""Claims on simplices of any dimension: right answers pass, each claim has a fault it catches."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from isograde.cases import all_cases
from isograde.claims.simplices import CLAIMS
from isograde.declaration import declaration_from
from isograde.model import Verdict
from isograde.oracles.complexes import Complex
from isograde.oracles.known_manifolds import MANIFOLDS
from isoref.fast import simplicial
from isoref.field import Field

from tests.isograde.judging import Here, grade

Extract = Callable[[Any, Any, Any], tuple[Any, Any]]
CASES = {
    name.removeprefix("simplices/"): case
    for name, case in all_cases().items()
    if name.startswith("simplices/")
}
KINDS = sorted({tuple(case.kind) for case in CASES.values()})
SAYS = {"interpolant": "kuhn", "limits": {"kinds": [list(kind) for kind in KINDS], "least": 2}}


def reference(values: Any, isovalue: Any, spacing: Any) -> tuple[Any, Any]:
    """The level set on Kuhn's simplices."""
    mesh = simplicial.extract(Field.of(values, spacing, dimension=len(spacing)), isovalue)
    return mesh.vertices, mesh.simplices


def printed(values: Any, isovalue: Any, spacing: Any) -> tuple[Any, Any]:
    """The same with the tables as printed, which do not fit each other in five dimensions."""
    field = Field.of(values, spacing, dimension=len(spacing))
    mesh = simplicial.extract(field, isovalue, rule="printed")
    return mesh.vertices, mesh.simplices


def found(function: Extract, name: str) -> dict[str, Verdict]:
    """What each claim of the family says of a case."""
    declared = declaration_from(SAYS, "tried")
    asked = [CASES[name]]
    return {
        claim.removeprefix("simplices."): finding.verdict
        for _, claim, finding in grade(Here(function, declared), asked, "simplices.")
    }


QUICK = [
    name
    for name, case in CASES.items()
    if case.samples <= 10_000 and any(claim.applies_to(case) for claim in CLAIMS)
    if case.kind.k > 1 or {"curved", "flat", "empty"} & case.tags
]


@pytest.mark.parametrize("name", QUICK)
def test_the_reference_passes(name: str) -> None:
    """Known manifolds, noise, ties and zeros apart, in two to five dimensions."""
    verdicts = found(reference, name)
    assert verdicts
    assert set(verdicts.values()) <= {Verdict.PASS, Verdict.SKIP}


def broken(change: Callable[[Any, Any], Any]) -> Extract:
    """The reference with a changed answer."""
    return lambda *asked: change(*reference(*asked))


def bubble(vertices: Any, simplices: Any) -> Any:
    """A copy of the set, so small that it fits one cell."""
    tiny = vertices[simplices[0, 0]] + 1e-4 * (vertices - vertices.mean(axis=0))
    return np.vstack([vertices, tiny]), np.vstack([simplices, simplices + len(vertices)])


def pierced(vertices: Any, simplices: Any) -> Any:
    """Without the largest simplex."""
    which = Complex.of(vertices, simplices).measures.argmax()
    return vertices, np.delete(simplices, which, axis=0)


# Implementations with one fault: the case that shows it, and the claim that catches it.
BROKEN: list[tuple[Extract, str, str]] = [
    (broken(bubble), "circle", "euler"),
    (broken(pierced), "sphere", "euler"),
    (broken(lambda v, s: (v, s[:0])), "sphere", "euler"),
    (lambda v, level, h: reference(v, np.add(level, 0.05), h), "flat-2-1", "flat"),
    (broken(lambda v, s: (v, s[:0])), "flat-3-2", "flat"),
    (broken(lambda v, s: (np.eye(3)[:2], np.array([[0, 1]]))), "apart", "nothing"),
    (printed, "noise-5-3", "conforming"),
]


@pytest.mark.parametrize(("function", "case", "caught"), BROKEN)
def test_each_claim_catches_its_broken_implementation(
    function: Extract, case: str, caught: str
) -> None:
    """And the right answer to the same case passes it."""
    assert found(function, case)[caught] is Verdict.FAIL
    assert found(reference, case)[caught] is Verdict.PASS


def test_a_hole_is_no_second_cut() -> None:
    """Min's tables leave no gap; a missing simplex does, and conforms."""
    declared = declaration_from(SAYS, "tried")
    asked = [CASES["sphere"]]
    said = {claim: f.verdict for _, claim, f in grade(Here(broken(pierced), declared), asked)}
    assert said["topology.closed"] is Verdict.FAIL
    assert said["simplices.conforming"] is Verdict.PASS


def test_every_claim_has_a_broken_implementation_and_a_case() -> None:
    """The table is complete."""
    assert {f"simplices.{caught}" for _, _, caught in BROKEN} == {claim.id for claim in CLAIMS}
    assert all(any(claim.applies_to(case) for case in CASES.values()) for claim in CLAIMS)


@pytest.mark.parametrize("name", [k for k, v in MANIFOLDS.items() if v.volume is not None])
def test_volumes_of_known_manifolds_agree_with_monte_carlo(name: str) -> None:
    """The co-area formula: the mean of |Jacobian| over a thin shell, divided by its thickness."""
    known = MANIFOLDS[name]
    rng = np.random.default_rng(7)
    d, hits = 0.12, 200_000
    points = rng.uniform(-known.half, known.half, (hits, known.n))
    near = (abs(known.phi(points)) < d).all(axis=1)
    g = known.gradients(points[near])
    total = np.sqrt(np.linalg.det(g @ g.transpose(0, 2, 1))).sum()
    volume = total / hits * (2 * known.half) ** known.n / (2 * d) ** known.m
    assert volume == pytest.approx(known.volume, rel=0.06)


def test_a_manifold_that_goes_on_beyond_the_domain_is_no_evidence() -> None:
    """Found by ``make correct``: the torus comes near the border, the sphere does not."""

    def cropped(values: Any, isovalue: Any, spacing: Any) -> tuple[Any, Any]:
        vertices, simplices = reference(values[1:-1, 1:-1, 1:-1], isovalue, spacing)
        return vertices + spacing, simplices

    says = {"interpolant": "kuhn", "limits": {"kinds": [[3, 1]]}}
    declared = declaration_from({**says, "domain": {"inset": 1, "end": "open"}}, "cropped")
    for name, verdict in (("sphere", Verdict.PASS), ("torus", Verdict.SKIP)):
        judged = grade(Here(cropped, declared), [CASES[name]], "simplices.euler")
        assert [finding.verdict for _, _, finding in judged] == [verdict]
    holed = Here(lambda *asked: pierced(*cropped(*asked)), declared)
    judged = grade(holed, [CASES["sphere"]], "simplices.euler")
    assert [finding.verdict for _, _, finding in judged] == [Verdict.FAIL]


@pytest.mark.parametrize("types", [["uint8"], ["float32"]])
def test_samples_in_whole_numbers_are_of_another_manifold(types: list[str]) -> None:
    declared = declaration_from({"limits": {"types": types}}, "narrow")
    euler = next(claim for claim in CLAIMS if claim.id == "simplices.euler")
    assert euler.families(declared) is (types == ["float32"])


def test_a_cap_need_not_solve_the_equations() -> None:
    """Found by ``make correct``: a cap lies in the border; beyond a period values begin anew."""
    flat = next(claim for claim in CLAIMS if claim.id == "simplices.flat")
    for ends in ({"inset": -1, "end": "closed"}, "periodic"):
        assert not flat.families(declaration_from({"domain": ends}, "capped"))
    assert flat.families(declaration_from({"domain": {"inset": 1, "end": "open"}}, "cropped"))


def test_a_finding_names_what_the_manifold_has() -> None:
    """Its Euler characteristic, and its pieces."""
    declared = declaration_from(SAYS, "tried")
    asked = [CASES["sphere"]]
    said = {claim: f for _, claim, f in grade(Here(broken(pierced), declared), asked, "simplices.")}
    detail = said["simplices.euler"].detail
    assert detail.startswith("Euler characteristic 1 in 1 pieces, where ")
    assert detail.endswith(" has 2 in 1")
