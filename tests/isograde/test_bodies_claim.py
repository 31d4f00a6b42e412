"""Known bodies come out of every correct extractor, of any family and kind, and out of no cheat."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from itertools import product
from typing import Any

import numpy as np
import pytest
from isograde.cases import all_cases
from isograde.claims.bodies import CLAIMS, _within
from isograde.declaration import Split, declaration_from
from isograde.model import Case, Kind, Verdict
from isoref.fast import simplicial
from isoref.field import Field

from tests.isograde.cheats import EMPTY_HANDED
from tests.isograde.families import CORRECT
from tests.isograde.judging import verdicts

KINDS = [[n, m] for n in range(1, 7) for m in range(1, n + 1)]


def bodies(kind: Kind, part: str = "") -> list[Case]:
    """The bodies of a kind that are run by default and have this in their names."""
    return [
        case
        for case in all_cases().values()
        if "bodies" in case.tags
        and "full" not in case.tags
        and case.kind == kind
        and part in case.id
    ]


def on_kuhn(values: Any, isovalue: Any, spacing: Any) -> tuple[Any, Any]:
    """The level set on Kuhn's simplices, of any kind."""
    mesh = simplicial.extract(Field.of(values, spacing, dimension=len(spacing)), isovalue)
    return mesh.vertices, mesh.simplices


def judged(
    function: Callable[..., Any], says: dict[str, Any], cases: list[Case]
) -> dict[str, Counter[Verdict]]:
    """The verdicts of the claims on bodies."""
    assert cases
    return verdicts(function, declaration_from(says, "tried"), cases, "bodies.")


SURFACES = bodies(Kind(3, 1), "sphere-1")


def test_the_plan_has_two_topologies_both_types_and_both_sizes_of_every_kind() -> None:
    """The design: at least two topologies, floats and bytes, cubes of 2^k and 2^k + 1."""
    kinds = {case.kind for case in all_cases().values() if "bodies" in case.tags}
    assert {(2, 1), (3, 1), (3, 2), (4, 2), (2, 2)} <= kinds
    for kind in kinds:
        planned = bodies(kind)
        known = [case.facts["body"] for case in planned]
        assert len({(body.pieces, body.b1) for body in known}) >= 2
        assert {"float64", "uint8"} <= {case.id.split("-")[-1] for case in planned}
        assert {body.shape[0] % 2 for body in known} == {0, 1}
    assert len({case.facts["body"].b1 for case in bodies(Kind(3, 1))}) >= 2


@pytest.mark.parametrize("name", CORRECT)
def test_a_correct_extractor_passes(name: str) -> None:
    """Every family, convention and layout; what its limits leave out is unsupported."""
    family = CORRECT[name]
    found = judged(family.function, dict(family.says), SURFACES)
    assert set(found) == {claim.id for claim in CLAIMS}
    for claim, counted in found.items():
        assert set(counted) <= {Verdict.PASS, Verdict.SKIP, Verdict.UNSUPPORTED}, (claim, counted)
    assert all(found[f"bodies.{claim}"][Verdict.PASS] for claim in ("pieces", "holes", "centroid"))


@pytest.mark.parametrize(
    "kind",
    [
        *[(1, 1), (2, 1), (2, 2), (3, 2), (3, 3), (4, 3), (4, 4), (6, 6)],
        pytest.param((6, 5), marks=pytest.mark.slow),
    ],
)
def test_every_kind_passes_on_kuhns_simplices(kind: tuple[int, int]) -> None:
    """Curves, points and surfaces in four dimensions are judged as surfaces are."""
    limits = {"kinds": KINDS, "least": 2}
    planned = [case for case in bodies(Kind(*kind)) if case.samples <= 400_000]
    assert len({case.facts["body"].name for case in planned}) == 2
    found = judged(on_kuhn, {"interpolant": "kuhn", "limits": limits}, planned)
    assert len(found) == len(CLAIMS)
    assert all(set(counted) == {Verdict.PASS} for counted in found.values()), found


# The largest bounds that words can give, and the usual ones; the sphere is the smallest body.
WORDS = [
    {"interpolant": interpolant, "vertices": vertices, "mesh": {"soup": 0.1}}
    for interpolant, vertices in (
        ("multilinear", "edges"),
        ("kuhn", {"own": 3.0}),
        ("labels", "cells"),
        ("labels", {"own": 3.0}),
    )
]


@pytest.mark.parametrize("name", EMPTY_HANDED)
def test_who_has_nothing_to_show_fails_whatever_is_declared(name: str) -> None:
    """Issue 11: nothing, one triangle, the same mesh for every field; all words, nothing promised.

    A case or more must fail for each way to declare it, and the failure must be held against it.
    """
    function = EMPTY_HANDED[name].function
    planned = SURFACES[:1] if "always" in name else SURFACES
    for words in WORDS if "always" in name else WORDS[:1]:
        says = {**words, "level": 0, "not_promised": ["*"], "conventions": {"normals": "none"}}
        declared = declaration_from(says, name)
        assert all(claim.held(declared) for claim in CLAIMS)
        found = judged(function, says, planned)
        counts = sum(found.values(), Counter())
        bad = counts[Verdict.FAIL] + counts[Verdict.ERROR] + counts[Verdict.NOT_RUN]
        assert bad or not counts[Verdict.PASS], (words, found)


def test_half_a_cell_moves_the_centroid() -> None:
    """The design: volume alone misses a shift of half a voxel."""

    def shifted(values: Any, isovalue: Any, spacing: Any) -> tuple[Any, Any]:
        vertices, simplices = on_kuhn(values, isovalue, spacing)
        return vertices + 0.5 * np.asarray(spacing), simplices

    says = {"interpolant": "kuhn", "limits": {"kinds": KINDS}}
    for kind in ((2, 1), (3, 2)):
        found = judged(shifted, says, bodies(Kind(*kind), "circle-1"))
        assert set(found["bodies.centroid"]) == {Verdict.FAIL}
        assert set(found["bodies.pieces"]) == {Verdict.PASS}


def test_the_other_orientation_is_found() -> None:
    """A curve that runs the other way covers its body minus once."""

    def reversed_(values: Any, isovalue: Any, spacing: Any) -> tuple[Any, Any]:
        vertices, simplices = on_kuhn(values, isovalue, spacing)
        return vertices, simplices[:, ::-1]

    says: dict[str, Any] = {"interpolant": "kuhn", "limits": {"kinds": KINDS}}
    planned = bodies(Kind(3, 2), "circle-1")
    found = judged(reversed_, says, planned)
    assert set(found["bodies.degree"]) == {Verdict.FAIL}
    unsaid = judged(reversed_, {**says, "conventions": {"normals": "none"}}, planned)
    assert set(unsaid["bodies.degree"]) == {Verdict.SKIP}
    assert set(unsaid["bodies.offset"]) == {Verdict.PASS}


def test_a_missing_patch_opens_a_piece() -> None:
    """The design: the patch shows in the holes."""

    def patched(values: Any, isovalue: Any, spacing: Any) -> tuple[Any, Any]:
        vertices, simplices = on_kuhn(values, isovalue, spacing)
        return vertices, simplices[:-1]

    found = judged(patched, {"interpolant": "kuhn"}, SURFACES)
    assert set(found["bodies.holes"]) == {Verdict.FAIL}
    assert set(found["bodies.offset"]) == {Verdict.PASS}


def astray(vertices: Any, faces: Any) -> tuple[Any, Any]:
    """One vertex two cells farther from the middle."""
    moved = np.array(vertices)
    away = moved[0] - moved.mean(axis=0)
    moved[0] += 2 * away / np.linalg.norm(away)
    return moved, faces


def with_speck(vertices: Any, faces: Any) -> tuple[Any, Any]:
    """A tiny tetrahedron beside the body."""
    corners = np.array([[0.0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]) + 0.5
    speck = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    return np.concatenate([vertices, corners]), np.concatenate([faces, speck + len(vertices)])


def grown(vertices: Any, faces: Any) -> tuple[Any, Any]:
    """A sphere a tenth larger round its middle."""
    middle = vertices.mean(axis=0)
    return middle + 1.1 * (vertices - middle), faces


BROKEN = {"bodies.distance": astray, "bodies.pieces": with_speck, "bodies.offset": grown}


@pytest.mark.parametrize("claim", BROKEN)
def test_a_fault_is_caught_by_its_claim(claim: str) -> None:
    """A vertex astray, a piece too many, a body too large; in index coordinates of a sphere."""
    right = CORRECT["cubes"].function

    def wrong(values: Any, isovalue: Any, spacing: Any) -> tuple[Any, Any]:
        vertices, faces = BROKEN[claim](*right(values, isovalue, (1.0, 1.0, 1.0)))
        return vertices * np.asarray(spacing), faces

    found = judged(wrong, {}, SURFACES[:1])
    assert set(found[claim]) == {Verdict.FAIL}
    assert set(judged(right, {}, SURFACES[:1])[claim]) == {Verdict.PASS}


# Every word's values: three splits, three reaches, each end and inset, both kinds of mesh.
KUHN = [list(map(list, simplex)) for simplex in Split().over(3)]
MIRRORED = [[[1 - x, y, z] for x, y, z in simplex] for simplex in KUHN]
INTERPOLANTS = (
    "multilinear",
    "labels",
    "kuhn",
    {"tetrahedra": MIRRORED},
    CORRECT["tetrahedra_of_five"].says["interpolant"],
)
VERTICES = ("edges", "cells", {"own": 0.5}, {"own": 1.5}, {"own": 3.0})
DOMAINS = ("open", "closed", "periodic", {"inset": 0.5, "end": "open"}, {"inset": -0.5})
MESHES = ("indexed", {"soup": 1e-6})
NOTHING_PROMISED: tuple[list[str], ...] = ([], ["*"])


@pytest.mark.slow
@pytest.mark.parametrize("interpolant", INTERPOLANTS, ids=lambda one: str(one)[:12])
@pytest.mark.parametrize(
    "name", ["always_empty", "declines_everything", "always_one_triangle", "always_one_ball"]
)
def test_no_way_to_declare_it_lets_nothing_pass_for_something(name: str, interpolant: Any) -> None:
    """Issue 11, done when: every combination of the words; promised everything or nothing.

    Level 0 asks every claim on bodies to pass, and none can be taken out of the promise. So where
    one fails the status is 1 and no level is reached; where none was judged there is no evidence.
    """
    function, tried = EMPTY_HANDED[name].function, 0
    planned = [case for case in SURFACES if "sphere-16-float64" in case.id]
    assert len(planned) == 1
    for vertices, domain, mesh, without in product(VERTICES, DOMAINS, MESHES, NOTHING_PROMISED):
        says = {"interpolant": interpolant, "vertices": vertices, "domain": domain, "mesh": mesh}
        declared = declaration_from({**says, "not_promised": without, "level": 0}, name)
        assert all(claim.held(declared) for claim in CLAIMS)
        found = judged(function, {**says, "not_promised": without, "level": 0}, planned)
        counts = sum(found.values(), Counter())
        bad = counts[Verdict.FAIL] + counts[Verdict.ERROR]
        assert bad or not counts[Verdict.PASS], (says, found)
        tried += 1
    assert tried == 100


@pytest.mark.parametrize(
    ("found", "most", "verdict"),
    [
        (0.25, 0.25, Verdict.PASS),
        (np.nextafter(0.25, 1), 0.25, Verdict.FAIL),
        (np.nan, 0.25, Verdict.FAIL),
        (np.inf, 0.25, Verdict.FAIL),
        (0.25, np.inf, Verdict.SKIP),
    ],
)
def test_a_number_is_within_its_bound_up_to_the_bound(
    found: float, most: float, verdict: Verdict
) -> None:
    """What is no number is not, and without a bound there is no evidence."""
    finding = _within("distance", found, most)
    assert finding.verdict is verdict
    assert ("at most 0.25" in finding.detail) == (verdict is Verdict.FAIL)
