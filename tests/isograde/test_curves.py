"""Claims on curves: right answers pass, and each claim has a fault that it catches."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from isograde.adapters.conventions import to_house
from isograde.adapters.forms import arrays_from
from isograde.adapters.libraries import isoref
from isograde.cases import all_cases
from isograde.cases.curves import COARSE
from isograde.claims.curves import CLAIMS
from isograde.declaration import Conventions, declaration_from
from isograde.model import CURVES as CURVES_KIND
from isograde.model import Outcome, Request, Status, Verdict
from isograde.oracles import space_curves
from isograde.oracles.space_curves import Points, is_closed
from isoref.field import Field

from tests.isograde.judging import Here, grade

SAYS = {"limits": {"kinds": [[3, 2]]}, "promised": ["curves.identical"]}
CURVES = {name: case for name, case in all_cases().items() if name.startswith("curves/")}
KNOWN = [name for name, case in CURVES.items() if {"known", "touching"} & case.tags]
Extract = Callable[[Any, Any, Any], Any]


def reference(values: Any, isovalues: Any, spacing: Any) -> list[Points]:
    """The curves from face to face, as polylines."""
    one, other = values
    return list(isoref.marching_faces(one, other, isovalues[0], isovalues[1], spacing))


def by_triangles(values: Any, isovalues: Any, spacing: Any) -> list[Points]:
    """The curves in which triangles of the two surfaces meet."""
    one, other = values
    return list(isoref.surface_intersection(one, other, isovalues[0], isovalues[1], spacing))


def found(function: Extract, names: list[str], only: str = "curves.") -> dict[str, set[Verdict]]:
    """The verdicts of each claim on these cases."""
    verdicts: dict[str, set[Verdict]] = {}
    asked = [CURVES[name] for name in names]
    for _, claim, finding in grade(Here(function, declaration_from(SAYS, "tried")), asked, only):
        verdicts.setdefault(claim.removeprefix("curves."), set()).add(finding.verdict)
    return verdicts


@pytest.mark.parametrize("name", KNOWN)
def test_the_reference_passes(name: str) -> None:
    """Rings, links, a knot, a line, and circles of Villarceau, where surfaces touch."""
    verdicts = found(reference, [name])
    assert verdicts
    fine = {Verdict.PASS, Verdict.SKIP} if "tangent" in name else {Verdict.PASS}
    assert all(said <= fine for said in verdicts.values()), verdicts


def test_the_other_method_passes_on_a_knot_and_on_equal_surfaces() -> None:
    """Ljung and Ynnerman's two ways agree on what is known."""
    verdicts = found(by_triangles, ["curves/trefoil", "curves/identical"])
    names = {claim.id.removeprefix("curves.") for claim in CLAIMS} - {"confidence"}
    assert set(verdicts) == names
    assert all(said == {Verdict.PASS} for said in verdicts.values()), verdicts


def changed(change: Callable[[list[Points]], list[Points]]) -> Extract:
    """The reference with its answer changed."""
    return lambda *asked: change([np.array(curve) for curve in reference(*asked)])


def opened(curves: list[Points]) -> list[Points]:
    """Closed curves without their last segment."""
    return [curve[:-1] if is_closed(curve) else curve for curve in curves]


def with_a_speck(curves: list[Points]) -> list[Points]:
    """A closed curve more, too small to see."""
    ring = np.array([[1, 0, 0], [2, 0, 0], [1, 1, 0], [1, 0, 0]])
    return [*curves, curves[0][0] + 1e-4 * ring]


def halved(curves: list[Points]) -> list[Points]:
    """Curves that go straight from their first quarter to their last."""
    return [np.concatenate([c[: len(c) // 4], c[3 * len(c) // 4 :]]) for c in curves]


def directed(change: Callable[[Points], Points]) -> Extract:
    """The reference with its vectors changed."""

    def function(values: Any, isovalues: Any, spacing: Any) -> Any:
        one, other = values
        found = isoref.directed_curves(one, other, isovalues[0], isovalues[1], spacing)
        return (*found[:2], change(found[2]))

    return function


# For each claim an implementation that it catches, the case where it does, and what follows.
BROKEN: dict[str, tuple[Extract, str, set[str]]] = {
    "count": (changed(opened), "curves/two-spheres", {"linking"}),
    "linking": (
        changed(lambda curves: [curves[0], curves[1] + 5]),
        "curves/hopf-link",
        {"on_surfaces", "covers"},
    ),
    "on_surfaces": (changed(lambda c: [one + 0.02 for one in c]), "curves/two-spheres", set()),
    "covers": (changed(halved), "curves/two-spheres", set()),
    # The tangents alone, whatever the confidence in them.
    "confidence": (
        directed(lambda v: v / np.linalg.norm(v, axis=1, keepdims=True)),
        "curves/directed/two-spheres",
        set(),
    ),
    "identical": (
        lambda *_: [np.array([[0, 0.1, 0.1], [0, 0.2, 0.2]])],
        "curves/identical",
        set(),
    ),
}


def test_every_claim_has_a_broken_implementation() -> None:
    """The table is complete."""
    assert {f"curves.{name}" for name in BROKEN} == {claim.id for claim in CLAIMS}


@pytest.mark.parametrize("claim", BROKEN)
def test_a_broken_one_is_caught_by_its_claim_and_what_follows(claim: str) -> None:
    """By no other claim of the family, so that the claim is needed."""
    function, case, follows = BROKEN[claim]
    failed = {name for name, said in found(function, [case]).items() if said == {Verdict.FAIL}}
    assert claim in failed
    assert failed <= {claim, *follows}


def test_a_speck_is_counted() -> None:
    """A closed curve that fits into one cell."""
    verdicts = found(changed(with_a_speck), ["curves/two-spheres"])
    assert verdicts["count"] == {Verdict.FAIL}


def test_one_isovalue_for_both_fields_is_caught() -> None:
    """The case of two isovalues, which the others cannot tell."""

    def first_only(values: Any, isovalues: Any, spacing: Any) -> list[Points]:
        return reference(values, (isovalues[0], isovalues[0]), spacing)

    same = found(first_only, ["curves/two-cylinders"])
    assert all(said == {Verdict.PASS} for said in same.values())
    told = found(first_only, ["curves/two-isovalues"])
    assert told["count"] == told["covers"] == {Verdict.FAIL}


def test_identical_surfaces_are_a_convention_of_who_promises_it() -> None:
    """Judged for everybody, held against nobody else."""
    claim = next(claim for claim in CLAIMS if claim.id == "curves.identical")
    assert not claim.held(declaration_from({}, "silent"))
    assert claim.held(declaration_from(SAYS, "promised"))


def test_cases_sample_the_known_curves() -> None:
    """Both functions are small at the samples beside a curve, and nowhere else than there."""
    case = CURVES["curves/trefoil"]
    assert case.facts["curves"].sample(COARSE)[0].shape == COARSE == case.build().shape
    assert case.facts["closed"] == 1
    assert CURVES["curves/two-isovalues"].isovalues == (0.7, -1.3)
    assert {f"curves/{make().name}" for make in space_curves.KNOWN} <= set(CURVES)
    assert len(DIRECTED) == 3


DIRECTED = [name for name, case in CURVES.items() if "directed" in case.tags]


@pytest.mark.parametrize("name", DIRECTED)
def test_tangents_are_as_long_as_the_confidence_in_them(name: str) -> None:
    """Ljung and Ynnerman, section 6; either way along the curves, all of them alike."""
    for sign in (1, -1):
        verdicts = found(directed(lambda v, sign=sign: sign * v), [name])  # type: ignore[misc]
        assert verdicts == {"confidence": {Verdict.PASS}}


def test_a_wrong_vector_is_caught_and_none_is_no_evidence() -> None:
    """Exchanged axes, a forgotten field, vectors that run either way; curves without any."""
    name = ["curves/directed/two-spheres"]
    wrong: list[Callable[[Points], Points]] = [
        lambda v: v[:, ::-1],
        lambda v: np.where(np.arange(len(v))[:, None] % 3 == 0, -v, v),
        lambda v: v * np.nan,
        lambda v: 0 * v,
    ]
    for change in wrong:
        assert found(directed(change), name) == {"confidence": {Verdict.FAIL}}
    assert found(reference, name) == {"confidence": {Verdict.SKIP}}


@pytest.mark.parametrize("name", ["two-spheres", "hydrogen-axis", "noise", "integers", "apart"])
def test_the_curves_with_vectors_are_the_curves_without(name: str) -> None:
    """Vertices and segments of the adapter's two forms."""
    field, levels = CURVES[f"curves/{name}"].build(), CURVES[f"curves/{name}"].isovalues
    asked = (*field.values, *levels, field.spacing)
    lines = arrays_from(isoref.marching_faces(*asked), CURVES_KIND)
    vertices, segments, vectors = isoref.directed_curves(*asked)
    assert (vertices == lines[0]).all()
    assert (segments == lines[1]).all()
    assert vectors.shape == vertices.shape


def test_lengths_survive_conventions() -> None:
    """Directions in units of samples, axes reversed: turned into the world's, as long as before."""
    field = Field.of(np.zeros((2, 3, 3, 3)), (1.0, 2.0, 4.0), dimension=3)
    vectors = np.array([[0.0, 0.0, 0.5], [0.3, 0.0, 0.4], [0.0, 0.0, 0.0]])
    here = Outcome(Status.OK, np.zeros((3, 3)), np.array([[0, 1], [1, 2]]), normals=vectors)
    asked = Request("a case", "plain", field, (0.0, 0.0))
    made = to_house(here, asked, Conventions(axes="reversed", units="index")).normals
    assert made is not None
    assert made[0].tolist() == [0.5, 0, 0]
    assert np.linalg.norm(made, axis=1) == pytest.approx([0.5, 0.5, 0.0])
    assert made[1] / made[1][0] == pytest.approx([1.0, 0.0, 3.0])
