"""No answer, however odd, makes a judge raise: it gets a verdict, and never a pass on structure."""

import numpy as np
import pytest
from isograde.declaration import Declaration
from isograde.model import Case, Finding, Outcome, Status, Trial, Verdict
from isograde.runner import claims_for
from isoref.field import Field
from numpy.typing import NDArray

CLAIMS = [claim for claim in claims_for(Declaration("odd")).values() if not claim.tags]
TRIANGLE = np.array([[0, 1, 2]])
POINTS = np.array([[0.5, 0, 0], [0, 0.5, 0], [0, 0, 0.5]])
ODD: dict[str, tuple[NDArray[np.generic], NDArray[np.generic]]] = {
    "words": (np.array([["a", "b", "c"]] * 3), TRIANGLE),
    "complex": (POINTS.astype(complex), TRIANGLE),
    "flat": (POINTS.reshape(-1), TRIANGLE),
    "in the plane": (POINTS[:, :2], TRIANGLE),
    "real faces": (POINTS, TRIANGLE.astype(float)),
    "one long face": (POINTS, TRIANGLE.reshape(-1)),
    "negative": (POINTS, -TRIANGLE - 1),
    "too large": (POINTS, TRIANGLE.astype(np.uint64) + np.uint64(2**63)),
    "no vertices": (np.empty((0, 3)), TRIANGLE),
    "infinite": (np.full((3, 3), np.inf), TRIANGLE),
    "quadrilaterals": (POINTS, np.array([[0, 1, 2, 0]])),
    "flags": (POINTS, TRIANGLE > 0),
}


def findings(vertices: NDArray[np.generic], faces: NDArray[np.generic]) -> dict[str, Finding]:
    """What every claim says of this answer to a field with one corner inside."""
    values = np.full((3, 3, 3), -1.0)
    values[0, 0, 0] = 1.0
    field = Field.of(values)
    case = Case("odd", lambda: field, (0.0,), 27)
    outcome = Outcome(Status.OK, vertices, faces)
    trial = Trial(case, field, Declaration("odd"), {"plain": outcome})
    return {
        claim.id: claim.judge(trial)
        for claim in CLAIMS
        if not claim.needs_mesh or outcome.mesh is not None
    }


@pytest.mark.parametrize("name", ODD)
def test_an_odd_answer_fails_in_its_structure(name: str) -> None:
    """Some claim of level 0 says what is wrong with it."""
    with np.errstate(invalid="ignore"):
        found = findings(*ODD[name])
    wrong = [f for c, f in found.items() if c.startswith("structure.") and f.verdict != "pass"]
    assert any(f.verdict is Verdict.FAIL and f.detail for f in wrong)


def test_the_right_answer_passes() -> None:
    """The same field, answered as it should be."""
    found = findings(POINTS, TRIANGLE)
    # One triangle shares no edge and crosses none, its field has no tie and no ambiguous face, and
    # no variant was asked.
    silent = {claim.id for claim in CLAIMS if claim.variants}
    silent |= {"topology.oriented", "topology.ties", "topology.bilinear"}
    silent |= {"geometry.embedded", "cells.frequencies"}
    said = {claim.id: found[claim.id].verdict for claim in CLAIMS if claim.promised}
    assert set(said.values()) == {Verdict.PASS, Verdict.SKIP}
    assert not {name for name, verdict in said.items() if verdict is Verdict.SKIP} - silent
