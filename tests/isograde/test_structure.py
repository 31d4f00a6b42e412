"""The claims on the arrays as they came, on each fault and on right arrays of every kind."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from isograde.claims import structure
from isograde.declaration import Declaration
from isograde.model import SURFACES, Case, Kind, Outcome, Status, Trial, Verdict
from isoref.field import Field

CLAIMS = {claim.id.removeprefix("structure."): claim for claim in structure.CLAIMS}
POINTS = np.array([[0.5, 0, 0], [0, 0.5, 0], [0, 0, 0.5], [0.5, 1, 0.0]])
FACES = np.array([[0, 1, 2], [1, 2, 3]])


def verdict(
    name: str, vertices: Any, simplices: Any, kind: Kind = SURFACES, soup: float | None = None
) -> Verdict:
    """What a claim says of these arrays, from a field of this kind."""
    field = Field.of(np.zeros((kind.m, *(3,) * kind.n)), dimension=kind.n)
    case = Case("test", lambda: field, (0.5,) * kind.m, 27, kind=kind)
    outcome = Outcome(Status.OK, np.asarray(vertices), np.asarray(simplices))
    trial = Trial(case, field, Declaration("", soup=soup), {"plain": outcome})
    return CLAIMS[name].judge(trial).verdict


@pytest.mark.parametrize("name", CLAIMS)
def test_right_arrays_pass(name: str) -> None:
    """On evidence: the arrays could be wrong."""
    assert verdict(name, POINTS, FACES) is Verdict.PASS


@pytest.mark.parametrize("name", ["apart", "with_measure"])
@pytest.mark.parametrize("soup", [None, 1e-6])
def test_what_is_near_an_end_of_the_domain_is_not_brought_together_there(
    name: str, soup: float | None
) -> None:
    """Of VTK's smoothed nets and misc3d: on either side of the last samples, by rounding."""
    near = np.array([[1.5, 0.5, 2 - 1e-6], [1.5, 0.5, 2 + 1e-6], [1.9, 0.5, 2.0], [1.5, 1, 1.5]])
    assert verdict(name, near, [[0, 1, 2], [1, 3, 2]], soup=soup) is Verdict.PASS
    near[:2, 2] = 2
    expected = Verdict.PASS if soup else Verdict.FAIL
    assert verdict(name, near, [[0, 1, 2], [1, 3, 2]], soup=soup) is expected


# A fault of the arrays, and the claim that names it.
FAULTS: list[tuple[str, Any, Any]] = [
    ("shapes", POINTS[:, :2], FACES),
    ("shapes", POINTS, FACES[:, :2]),
    ("shapes", POINTS, FACES.astype(float)),
    ("shapes", POINTS.astype(complex), FACES),
    ("finite", np.where(POINTS == 1, np.nan, POINTS), FACES),
    ("finite", np.where(POINTS == 1, np.inf, POINTS), FACES),
    ("in_range", POINTS, FACES + 1),
    ("in_range", POINTS, FACES - 1),
    ("no_repeated_index", POINTS, FACES * [[1, 1, 1], [1, 1, 0]] + [[0, 0, 0], [0, 0, 1]]),
    ("no_duplicate", POINTS, FACES[[0, 0]]),
    ("no_duplicate", POINTS, [[0, 1, 2], [2, 1, 0]]),
    ("all_used", POINTS, FACES[:1]),
    ("apart", POINTS[[0, 1, 2, 0]], FACES),
    ("with_measure", POINTS[[0, 1, 2, 1]], FACES),
]


@pytest.mark.parametrize(("name", "vertices", "simplices"), FAULTS)
def test_a_fault_is_named(name: str, vertices: Any, simplices: Any) -> None:
    """By its own claim."""
    assert verdict(name, vertices, simplices) is Verdict.FAIL


@pytest.mark.parametrize("kind", [Kind(2, 1), Kind(3, 2), Kind(4, 2), Kind(2, 2)], ids=str)
def test_other_kinds_have_other_shapes(kind: Kind) -> None:
    """N coordinates, n - m + 1 corners."""
    points = np.random.default_rng(0).uniform(0, 2, (6, kind.n))
    rows = np.arange(6).reshape(-1, kind.k + 1)[:2]
    assert verdict("shapes", points, rows, kind) is Verdict.PASS
    assert verdict("shapes", points, np.tile(rows, 2), kind) is Verdict.FAIL
    assert verdict("no_duplicate", points, rows[[0, 0]], kind) is Verdict.FAIL


def test_an_empty_mesh_is_no_evidence_of_anything_but_an_answer() -> None:
    """Its arrays have a shape, and nothing in them to be wrong."""
    nothing = np.empty((0, 3)), np.empty((0, 3), int)
    expected = {"answers": Verdict.PASS, "shapes": Verdict.PASS}
    assert {name: verdict(name, *nothing) for name in CLAIMS} == {
        name: expected.get(name, Verdict.SKIP) for name in CLAIMS
    }


def test_a_soup_repeats_vertices_and_is_asked_within_its_tolerance() -> None:
    """As given it has duplicates; welded it has none."""
    soup, rows = POINTS[FACES].reshape(-1, 3), np.arange(6).reshape(-1, 3)
    assert verdict("apart", soup, rows) is Verdict.FAIL
    assert verdict("apart", soup, rows, soup=0.0) is Verdict.PASS
    twice = np.concatenate([soup, soup[:3]]), np.arange(9).reshape(-1, 3)
    assert verdict("no_duplicate", *twice) is Verdict.PASS
    assert verdict("no_duplicate", *twice, soup=0.0) is Verdict.FAIL


def test_an_index_beyond_the_last_vertex_uses_none() -> None:
    """That it is out of range is for another claim to say: here it is neither used nor an error."""
    for rows in (FACES + 1, FACES + 10, FACES - 1):
        assert verdict("all_used", POINTS, rows) is Verdict.FAIL
    assert verdict("all_used", POINTS, [[0, 1, 2], [1, 2, 3], [0, 1, 4]]) is Verdict.PASS
