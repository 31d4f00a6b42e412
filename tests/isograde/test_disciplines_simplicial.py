"""The discipline ``simplices``: right answers pass, and each claim catches its broken one."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import pytest
from isograde.adapters import simplex_methods
from isograde.adapters.simplex_methods import (
    isoref_printed_tables,
    isoref_simplices,
    skimage_measure,
    vtk_kuhn,
)
from isograde.disciplines import simplices
from isograde.disciplines.simplices import CLAIMS, READY_MADE, cases
from isograde.model import Case, Declaration, Limits, Outcome, Request, Status, Verdict
from isograde.oracles import simplices as oracle
from isograde.oracles.known_manifolds import MANIFOLDS

from tests.isograde.judging import Here, grade

DECLARATION = Declaration("here", discipline="simplices")
CASES = {case.id.removeprefix("simplices/"): case for case in cases()}
Simplices = Callable[[Any, tuple[float, ...]], Any]


def here(function: Simplices) -> Here:
    """An adapter to the function."""
    return Here(simplices.through_adapter(function), "simplices")


def verdicts(function: Simplices, asked: Iterable[Case]) -> dict[str, set[Verdict]]:
    """What is said of each claim, over the cases."""
    said: dict[str, set[Verdict]] = {}
    for _, claim, finding in grade(here(function), DECLARATION, asked):
        said.setdefault(claim.removeprefix("simplices."), set()).add(finding.verdict)
    return said


def failing(function: Simplices, *names: str) -> set[str]:
    """The claims that fail on some of these cases."""
    said = verdicts(function, [CASES[name] for name in names])
    return {claim for claim, found in said.items() if Verdict.FAIL in found}


@pytest.mark.parametrize("name", [*MANIFOLDS, "noise-5-3", "integers-4-2", "positive-3-1", "apart"])
def test_the_reference_passes_every_claim(name: str) -> None:
    """A right answer must pass, on known manifolds, noise, ties and where there is nothing."""
    said = verdicts(isoref_simplices, [CASES[name]])
    assert said
    assert all(found == {Verdict.PASS} for found in said.values()), said


def test_the_printed_tables_fail_conformity_in_dimension_five_and_nothing_else() -> None:
    """Table 4 of Min: the union is the same set, but no complex."""
    assert failing(isoref_printed_tables, "noise-5-3") == {"conforming"}
    assert failing(isoref_printed_tables, "noise-4-2", "sphere") == set()


KINDS = {
    "skimage": {(2, 1), (3, 1)},
    "contourpy": {(2, 1)},
    "pymcubes": {(3, 1)},
    "libigl": {(2, 1), (3, 1)},
    "vtk": {(3, 1), (3, 2)},
    "vtk-tetrahedra": {(2, 1), (3, 1), (3, 2)},
}
MODULES = {"pymcubes": "mcubes", "libigl": "igl", "vtk-tetrahedra": "vtk"}
# A case of each kind, with ties and without.
LIBRARY_CASES = (
    "circle", "flat-2-1", "integers-2-1", "sphere", "flat-3-1", "noise-3-1", "integers-3-1",
    "circle-in-space", "noise-3-2", "integers-3-2", "noise-4-1", "clifford-torus",
    "positive-2-1", "positive-3-1", "apart",
)  # fmt: skip


@pytest.mark.parametrize("library", KINDS)
def test_libraries_pass_where_they_answer_and_decline_elsewhere(library: str) -> None:
    """What a library has no answer for is no failure; what it answers is right, ties included."""
    pytest.importorskip(MODULES.get(library, library))
    method = getattr(simplex_methods, library.replace("-", "_"))
    asked = [CASES[name] for name in LIBRARY_CASES]
    adapter = Here(method, "simplices")
    for case, claim, finding in grade(adapter, DECLARATION, asked):
        field = next(one for one in asked if one.id == case).build()
        answers = (field.dimension, field.components) in KINDS[library]
        assert finding.verdict is (Verdict.PASS if answers else Verdict.UNSUPPORTED), (case, claim)


@pytest.mark.parametrize(("case", "m"), [("sphere", 1), ("torus", 1), ("circle-in-space", 2)])
def test_vtk_finds_the_same_set_in_kuhns_tetrahedra(case: str, m: int) -> None:
    """N = 3: sections of the same simplices, cut otherwise where m = 2; one length, one area."""
    pytest.importorskip("vtk")
    values, h = MANIFOLDS[case].sample(17)
    ours, peer = isoref_simplices(values, (h,) * 3), vtk_kuhn(values, (h,) * 3)
    areas = [oracle.measures(vertices, rows).sum() for vertices, rows in (ours, peer)]
    assert areas[0] == pytest.approx(areas[1], rel=1e-9)
    if m == 1:
        assert len(ours[1]) == len(peer[1])


def test_vertices_on_tied_samples_count_as_one_up_to_rounding() -> None:
    """The smallest case found: scikit-image puts four of them 2e-16 beside a sample, or on it."""
    pytest.importorskip("skimage")
    values = np.array([[[0, 1, 1], [1, 0, 1]], [[-1, 0, 0], [-1, 1, 1]]], float)
    vertices, triangles = skimage_measure(values[None], (1.0, 1.0, 1.0))
    box = [[0.0, 0.0, 0.0], [1.0, 1.0, 2.0]]
    apart = oracle.joined(vertices.astype(float), triangles.astype(np.int64), 0.0)
    assert len(oracle.open_facets(*apart, box)) == 2
    one = oracle.joined(vertices.astype(float), triangles.astype(np.int64), 1e-6)
    assert len(oracle.open_facets(*one, box)) == 0


def broken(change: Callable[[Any, Any], Any]) -> Simplices:
    """The reference with a changed answer."""
    return lambda values, spacing: change(*isoref_simplices(values, spacing))


def largest(vertices: Any, simplices: Any) -> int:
    """The number of the largest simplex, which is not flat and not on the border."""
    return int(oracle.measures(vertices, simplices).argmax())


def doubled(vertices: Any, simplices: Any) -> Any:
    """One simplex more, on the facets of the largest, to a vertex of its own."""
    which = largest(vertices, simplices)
    extra = simplices[which : which + 1].copy()
    extra[0, -1] = len(vertices)
    middle = vertices[simplices[which]].mean(axis=0)
    return np.vstack([vertices, middle]), np.vstack([simplices, extra])


def turned(vertices: Any, simplices: Any) -> Any:
    """The largest simplex turned over."""
    out, which = simplices.copy(), largest(vertices, simplices)
    out[which, -2:] = out[which, -2:][::-1]
    return vertices, out


def pierced(vertices: Any, simplices: Any) -> Any:
    """Without the largest simplex."""
    return vertices, np.delete(simplices, largest(vertices, simplices), axis=0)


def bubble(vertices: Any, simplices: Any) -> Any:
    """A copy of the surface, so small that it fits one cell."""
    tiny = vertices[simplices[0, 0]] + 1e-4 * (vertices - vertices.mean(axis=0))
    return np.vstack([vertices, tiny]), np.vstack([simplices, simplices + len(vertices)])


def to_the_middle(values: Any, spacing: tuple[float, ...]) -> Any:
    """Crossings half-way between samples: only signs are looked at."""
    return isoref_simplices(np.where(values >= 0, 1.0, -1.0), spacing)


# Implementations with one fault: the case that shows it, the claim that catches it, what follows.
BROKEN: list[tuple[Simplices, str, str, set[str]]] = [
    (broken(lambda v, s: (v[:, :-1], s)), "sphere", "well-formed", set()),
    (broken(lambda v, s: (v, s[:, :-1])), "sphere", "well-formed", set()),
    (broken(lambda v, s: (v, s + 1)), "sphere", "well-formed", set()),
    (broken(pierced), "sphere", "closed", {"euler"}),
    (broken(pierced), "circle-in-space", "closed", {"euler", "converges"}),
    (broken(pierced), "clifford-torus", "closed", {"euler"}),
    (broken(doubled), "clifford-torus", "manifold", {"closed"}),
    (broken(turned), "circle-in-space", "oriented", {"side"}),
    (broken(turned), "clifford-torus", "oriented", {"side"}),
    (broken(lambda v, s: (v, np.flip(s, 1))), "circle-in-space", "side", set()),
    (broken(bubble), "circle", "euler", {"converges"}),
    (broken(lambda v, s: (v + 0.3, s)), "circle", "at-crossing", {"converges"}),
    (to_the_middle, "flat-3-2", "flat", {"euler"}),
    (to_the_middle, "sphere", "converges", set()),
    (lambda v, h: isoref_simplices(v - 0.05, h), "flat-2-1", "flat", set()),
    (broken(lambda v, s: (np.eye(3)[:2], np.array([[0, 1]]))), "apart", "nothing", set()),
    (isoref_printed_tables, "noise-5-3", "conforming", set()),
    (broken(pierced), "integers-4-2", "closed", set()),
    (broken(lambda v, s: (v, s[:0])), "sphere", "euler", {"converges"}),
]


@pytest.mark.parametrize(("function", "case", "caught", "by_the_way"), BROKEN)
def test_each_claim_catches_its_broken_implementation(
    function: Simplices, case: str, caught: str, by_the_way: set[str]
) -> None:
    """What follows from the same fault may fail too; nothing else does."""
    found = failing(function, case)
    assert caught in found
    assert found <= {caught, *by_the_way}


def test_every_claim_has_a_broken_implementation() -> None:
    """The table is complete."""
    assert {f"simplices.{caught}" for _, _, caught, _ in BROKEN} == {claim.id for claim in CLAIMS}


def test_every_claim_has_its_case_and_every_case_a_claim() -> None:
    """Nothing is listed that is never judged."""
    assert all(any(claim.applies_to(case) for case in CASES.values()) for claim in CLAIMS)
    assert all(any(claim.applies_to(case) for claim in CLAIMS) for case in CASES.values())
    assert len({claim.id for claim in CLAIMS}) == len(CLAIMS)


def test_an_implementation_that_raises_is_an_error_not_a_pass() -> None:
    """Only a mesh can pass."""

    class Raising(Here):
        def run(self, request: Request) -> Outcome:
            return Outcome(Status.RAISED, detail="ValueError: no")

    adapter = Raising(simplices.through_adapter(isoref_simplices), "simplices")
    said = {f.verdict for _, _, f in grade(adapter, DECLARATION, [CASES["circle"]])}
    assert said == {Verdict.ERROR}


def test_ready_made_names_go_through_a_real_adapter() -> None:
    """`python:` adapters find the functions, in a process of their own."""
    from isograde.adapters import open_adapter

    adapter = open_adapter(READY_MADE["simplices:reference"])
    declaration = adapter.open(Limits())
    try:
        assert declaration.discipline == "simplices"
        found = list(grade(adapter, declaration, [CASES["circle-in-space"]]))
    finally:
        adapter.close()
    assert {finding.verdict for _, _, finding in found} == {Verdict.PASS}


@pytest.mark.parametrize("name", [k for k, v in MANIFOLDS.items() if v.volume is not None])
def test_volumes_of_known_manifolds_agree_with_monte_carlo(name: str) -> None:
    """The co-area formula: the mean of |Jacobian| over a thin shell, divided by its thickness."""
    known = MANIFOLDS[name]
    rng = np.random.default_rng(7)
    d, total, hits = 0.12, 0.0, 200_000
    points = rng.uniform(-known.half, known.half, (hits, known.n))
    near = (abs(known.phi(points)) < d).all(axis=1)
    g = known.gradients(points[near])
    total = np.sqrt(np.linalg.det(g @ g.transpose(0, 2, 1))).sum()
    volume = total / hits * (2 * known.half) ** known.n / (2 * d) ** known.m
    assert volume == pytest.approx(known.volume, rel=0.06)
