"""The discipline of curves: right answers pass, and each claim has a fault that it catches."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import isoref.fast.marching_faces
import numpy as np
import pytest
from isograde.adapters import curve_methods, open_adapter
from isograde.disciplines import curves as discipline
from isograde.disciplines.curves import CLAIMS, Extract, cases, known_curves
from isograde.disciplines.curves.cases import COARSE
from isograde.disciplines.polylines import complaint, unstacked
from isograde.model import Declaration, Finding, Limits, Request
from isograde.oracles.space_curves import Points, is_closed
from isoref.fast.marching_faces import intersection_curves
from isoref.field import Field
from isoref.marching_faces import FaceRule

from tests.isograde.judging import Here, grade

Change = Callable[[list[Points]], list[Points]]


def graded(
    function: Extract, only: tuple[str, ...] = (), identical: str = "nothing"
) -> dict[tuple[str, str], Finding]:
    """Every finding on this function, by case and claim; on some cases only, by their names."""
    asked = [case for case in cases() if not only or case.id.removeprefix("curves/") in only]
    declaration = Declaration("here", discipline="curves", identical=identical)
    findings = grade(Here(discipline.through_adapter(function), "curves"), declaration, asked)
    return {(case, claim): finding for case, claim, finding in findings}


def faults(function: Extract, only: tuple[str, ...] = ()) -> dict[str, set[str]]:
    """The claims that fail, each with the cases it fails on."""
    found: dict[str, set[str]] = {}
    for (case, claim), finding in graded(function, only).items():
        if finding.verdict != "pass":
            found.setdefault(claim.removeprefix("curves."), set()).add(case)
    return found


reference = curve_methods._reference(isoref.fast.marching_faces)


def changed(change: Change) -> Extract:
    """The reference with its answer changed."""

    def extract_curves(a: Any, b: Any, *rest: Any) -> list[Points]:
        return change([np.array(curve) for curve in reference(a, b, *rest)])

    return extract_curves


@pytest.mark.slow
@pytest.mark.parametrize("name", ["curves:marching-faces", "curves:surface-intersection"])
def test_the_reference_passes_everything_through_a_real_adapter(name: str) -> None:
    """Both methods of the paper, each in a process of its own."""
    adapter = open_adapter(discipline.READY_MADE[name])
    declaration = adapter.open(Limits())
    try:
        assert declaration.discipline == "curves"
        findings = list(grade(adapter, declaration, cases()))
    finally:
        adapter.close()
    assert {claim for _, claim, _ in findings} == {claim.id for claim in CLAIMS}
    assert [f for f in findings if f[2].verdict != "pass"] == []


MINE = """
declaration = {"name": "mine", "discipline": "curves"}

def extract_curves(values_a, values_b, isovalue_a, isovalue_b, spacing):
    from isoref.field import Field
    from isoref.fast.marching_faces import intersection_curves
    fields = Field.of(values_a, spacing), Field.of(values_b, spacing)
    return [c.polyline for c in intersection_curves(*fields, (isovalue_a, isovalue_b))]
"""


def test_a_third_party_s_function_is_graded_as_it_stands(tmp_path: Path) -> None:
    """The signature of the discipline, a declaration, and nothing else."""
    (tmp_path / "mine.py").write_text(MINE, encoding="utf-8")
    adapter = open_adapter(f"python:{tmp_path / 'mine.py'}:extract_curves")
    declaration = adapter.open(Limits())
    asked = [case for case in cases() if case.id in ("curves/two-isovalues", "curves/apart")]
    try:
        findings = list(grade(adapter, declaration, asked))
    finally:
        adapter.close()
    assert declaration.name == "mine"
    assert len(findings) > 5
    assert {finding.verdict for *_, finding in findings} == {"pass"}


@pytest.mark.slow
@pytest.mark.parametrize("way", ["vtk_contour_twice", "vtk_contour_and_intersect"])
def test_vtk_is_graded_as_a_peer(way: str) -> None:
    """Contour, then contour again or intersect, strip: right on smooth curves, broken on noise."""
    pytest.importorskip("vtkmodules.vtkFiltersCore")
    found = faults(getattr(curve_methods, way))
    assert "curves/noise" in found["whole"]
    smooth = {"two-spheres", "two-cylinders", "hopf-link", "trefoil"}
    kinds = ("count", "linking", "covers", "on-surfaces")
    broken = {case for name in kinds for case in found.get(name, ())}
    assert not {f"curves/{name}" for name in smooth} & broken
    assert "well-formed" not in found


# Curves astray do not come nearer with the size of the cells.
CONVERGES = {"converges"}
QUICK = ("two-spheres", "two-cylinders", "noise", "apart", "identical")
FAULTS: dict[str, tuple[Change, set[str]]] = {
    "a single point as a curve": (
        lambda curves: [*curves, np.array([[0.1, 0.2, 0.3]])] if curves else curves,
        {"well-formed"},
    ),
    "a curve where there is none": (
        lambda curves: curves or [np.array([[0, 0.1, 0.1], [0, 0.2, 0.2]])],
        {"nothing"},
    ),
    "the last segment of a closed curve left out": (
        lambda curves: [curve[:-1] if is_closed(curve) else curve for curve in curves],
        {"whole", "count", "linking"},
    ),
    "a curve in two halves": (
        lambda curves: [half for c in curves for half in (c[: len(c) // 2 + 1], c[len(c) // 2 :])],
        {"whole", "no-point-twice", "count", "linking"},
    ),
    "points repeated": (
        lambda curves: [np.repeat(curve, 2, axis=0) for curve in curves],
        {"no-point-twice"},
    ),
    "one curve left out": (
        lambda curves: curves[1:],
        {"count", "linking", "covers", "converges"},
    ),
    "every curve reported twice": (
        lambda curves: curves + curves,
        {"no-point-twice", "count", "linking"},
    ),
    "rounded to half a cell": (
        lambda curves: [np.round(curve * 8) / 8 for curve in curves],
        {"on-surfaces", "converges", "no-point-twice"},
    ),
    "half a cell astray": (
        lambda curves: [curve + np.array([0, 0, 0.06]) for curve in curves],
        {"on-surfaces", "converges"},
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_each_fault_is_caught_by_its_claims(fault: str) -> None:
    """A broken implementation for every claim about the answer itself."""
    change, expected = FAULTS[fault]
    assert expected <= set(faults(changed(change), QUICK))


def by_order(a: Any, b: Any, one: float, two: float, spacing: Any) -> list[Points]:
    """Separated for one order of the fields, joined for the other: legal each time."""
    rule: FaceRule = "separated" if a.flat[0] > b.flat[0] else "joined"
    pair = Field.of(a, spacing), Field.of(b, spacing)
    return [c.polyline for c in intersection_curves(*pair, (one, two), rule)]


def opened(curves: list[Points]) -> list[Points]:
    """Closed curves without their last segment."""
    return [curve[:-1] if is_closed(curve) else curve for curve in curves]


def halved(curves: list[Points]) -> list[Points]:
    """Curves that go straight from their first quarter to their last."""
    return [np.concatenate([c[: len(c) // 4], c[3 * len(c) // 4 :]]) for c in curves]


def with_a_speck(curves: list[Points]) -> list[Points]:
    """A closed curve more, too small to see."""
    ring = np.array([[1, 0, 0], [2, 0, 0], [1, 1, 0], [1, 0, 0]])
    return [*curves, curves[0][0] + 1e-4 * ring]


# For each claim an implementation that it catches, the case where it does, and what follows.
BROKEN: dict[str, tuple[Extract, str, set[str]]] = {
    "well-formed": (
        changed(lambda curves: [*curves, curves[0][:1]]),
        "two-spheres",
        {claim.id.removeprefix("curves.") for claim in CLAIMS},
    ),
    "nothing": (
        changed(lambda curves: curves or [np.array([[0, 0.1, 0.1], [0, 0.2, 0.2]])]),
        "apart",
        set(),
    ),
    "identical": (
        changed(lambda curves: curves or [np.array([[0, 0.1, 0.1], [0, 0.2, 0.2]])]),
        "identical",
        set(),
    ),
    "whole": (changed(opened), "two-spheres", {"count", "linking", "swapped"}),
    "no-point-twice": (
        changed(lambda curves: [np.repeat(curve, 2, axis=0) for curve in curves]),
        "two-spheres",
        set(),
    ),
    "count": (changed(with_a_speck), "two-spheres", {"linking"}),
    "linking": (
        changed(lambda curves: [curves[0], curves[1] + 5]),
        "hopf-link",
        {"on-surfaces", "covers", "converges"},
    ),
    "swapped": (by_order, "noise", set()),
    "on-surfaces": (changed(lambda curves: [c + 0.02 for c in curves]), "two-spheres", CONVERGES),
    "covers": (changed(halved), "two-spheres", {"swapped", *CONVERGES}),
    "converges": (changed(lambda curves: [c + 0.005 for c in curves]), "two-spheres", set()),
}


def test_every_claim_has_a_broken_implementation() -> None:
    """The table is complete."""
    assert {f"curves.{name}" for name in BROKEN} == {claim.id for claim in CLAIMS}


@pytest.mark.parametrize("claim", BROKEN)
def test_a_broken_one_is_caught_by_its_claim_and_what_follows(claim: str) -> None:
    """By no other claim, so that the claim is needed."""
    function, case, follows = BROKEN[claim]
    found = set(faults(function, (case,)))
    assert claim in found
    assert found <= {claim, *follows}


def test_who_states_no_answer_for_identical_surfaces_is_not_judged_by_one() -> None:
    """Any list of curves will do, and none is counted for it."""
    function, case, _ = BROKEN["identical"]
    found = graded(function, (case,), identical="")
    assert found.pop(("curves/identical", "curves.identical")).verdict == "unsupported"
    assert {finding.verdict for finding in found.values()} == {"pass"}


def test_an_answer_that_depends_on_the_order_of_the_fields_is_otherwise_right() -> None:
    """No other claim sees it, on any of these cases."""
    found = faults(by_order, QUICK)
    assert set(found) == {"swapped"}


def test_who_fails_only_when_the_fields_are_swapped_is_told_so() -> None:
    """Even where there is no curve, so that no answer would be a right one."""
    first = next(case for case in cases() if case.id == "curves/apart").build().values[0]

    def extract_curves(a: Any, b: Any, *rest: Any) -> list[Points]:
        if not np.array_equal(a, first):
            raise ValueError("not this way round")
        return list(reference(a, b, *rest))

    findings = graded(extract_curves, ("apart",))
    broken = {claim: found for (_, claim), found in findings.items() if found.verdict != "pass"}
    assert set(broken) == {"curves.swapped"}
    assert broken["curves.swapped"].verdict == "error"
    assert broken["curves.swapped"].detail.startswith("swapped: ")


def test_an_error_and_an_answer_of_the_wrong_shape_are_told_apart_from_failures() -> None:
    """An exception is an error; arrays of pairs are refused with their shape."""

    def raises(*_: Any) -> list[Points]:
        raise RuntimeError("no licence")

    def flat(*_: Any) -> list[Points]:
        return [np.zeros((3, 2))]

    case, field = cases()[0], cases()[0].build()
    for function, word in ((raises, "no licence"), (flat, "(3, 2)")):
        outcome = Here(discipline.through_adapter(function), "curves").run(
            Request(case.id, "plain", field, 0.0)
        )
        assert unstacked(outcome, 3) is None
        assert word in complaint(outcome, 3)
    found = {finding.verdict for finding in graded(raises, QUICK).values()}
    assert found == {"error"}


def test_cases_are_deterministic_and_on_one_lattice() -> None:
    """The same seed gives the same numbers; another one does not."""
    for one, two in zip(cases(), cases(), strict=True):
        np.testing.assert_array_equal(one.build().values, two.build().values)
        assert one.build().components in (2, 3)
    assert (cases(1)[-5].build().values != cases(0)[-5].build().values).any()
    assert {case.id for case in cases()} >= set(known_curves())
    assert known_curves()["curves/trefoil"].sample(COARSE)[0].shape == COARSE


def test_one_isovalue_for_both_fields_is_caught() -> None:
    """The case of two isovalues, which the others cannot tell."""

    def extract_curves(a: Any, b: Any, one: float, two: float, spacing: Any) -> list[Points]:
        return reference(a, b, one, one, spacing)  # type: ignore[return-value]

    found = faults(extract_curves, ("two-cylinders", "two-isovalues"))
    assert {case for some in found.values() for case in some} == {"curves/two-isovalues"}
    assert {"count", "covers"} <= set(found)


def test_two_isovalues_are_told_apart() -> None:
    """Called directly, the two isovalues go to their own fields."""
    x, y, _ = np.meshgrid(*[np.arange(5.0)] * 3, indexing="ij")
    (line,) = reference(x, y, 1.5, 2.25, (1.0, 1.0, 1.0))
    np.testing.assert_allclose(line[:, :2], [[1.5, 2.25]] * 5)
