"""Contours are judged by the claims that every kind has: right answers pass, faults are caught."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from isograde.adapters.libraries import isoref
from isograde.cases import all_cases
from isograde.claims import CLAIMS
from isograde.declaration import declaration_from
from isograde.model import CONTOURS, Verdict
from isograde.oracles.space_curves import is_closed

from tests.isograde.judging import Here, grade

Polylines = list[Any]
Extract = Callable[[Any, Any, Any], Polylines]
CASES = [c for c in all_cases().values() if c.kind == CONTOURS and c.id.startswith("contours/")]
SAYS: dict[str, Any] = {"limits": {"kinds": [[2, 1]]}}
FINE = {Verdict.PASS, Verdict.SKIP}


def mixed(values: Any, isovalue: float, spacing: Any) -> Polylines:
    """DICONEX, deciding by the mean."""
    return list(isoref.diconex(values, isovalue, spacing, "mixed"))


def failing(
    function: Extract, says: dict[str, Any], names: tuple[str, ...] = ()
) -> dict[str, set[str]]:
    """The claims held against the function that do not hold, with their cases."""
    declared = declaration_from(says, "tried")
    asked = [case for case in CASES if not names or case.id.removeprefix("contours/") in names]
    assert asked
    failed: dict[str, set[str]] = {}
    passed = set()
    for case, claim, finding in grade(Here(function, declared), asked):
        if finding.verdict not in FINE and CLAIMS[claim].held(declared):
            failed.setdefault(claim, set()).add(case)
        passed |= {claim} if finding.verdict is Verdict.PASS else set()
    assert passed
    return failed


@pytest.mark.parametrize(("mode", "claim"), [("disconnect", "separate"), ("mixed", "mean")])
def test_diconex_keeps_what_it_promises(mode: str, claim: str) -> None:
    """Schlei 2010, section II.A: one rule decides every ambiguous square."""

    def contours(values: Any, isovalue: float, spacing: Any) -> Polylines:
        return list(isoref.diconex(values, isovalue, spacing, mode))

    says = {**SAYS, "promised": [f"cells.{claim}"]}
    assert failing(contours, says) == {}


def test_find_contours_of_scikit_image_keeps_what_its_signature_says() -> None:
    """As level 1; it needs two samples an axis."""
    measure = pytest.importorskip("skimage.measure")

    def contours(values: Any, isovalue: float, spacing: Any) -> Polylines:
        lines = measure.find_contours(values, isovalue, positive_orientation="high")
        return [line * np.asarray(spacing) for line in lines]

    says = {**SAYS, "level": 1, "conventions": {"tie": "outside", "nan": "answers"}}
    says["limits"] = {"kinds": [[2, 1]], "least": 2}
    names = ("disc", "annulus", "two-discs", "border", "noise", "saddle-mean-in-out")
    assert failing(contours, says, names) == {}


def changed(change: Callable[[Polylines], Polylines]) -> Extract:
    """DICONEX with its answer changed."""
    return lambda *asked: change([np.array(line) for line in mixed(*asked)])


# For each fault a case that shows it, and a claim that catches it.
BROKEN: dict[str, tuple[Extract, str, str]] = {
    "an end inside the lattice": (
        changed(lambda lines: [x[:-1] if is_closed(x) else x for x in lines]),
        "disc",
        "topology.closed",
    ),
    "the other way round": (
        changed(lambda lines: [x[::-1] for x in lines]),
        "disc",
        "topology.sides",
    ),
    "one contour left out": (changed(lambda lines: lines[1:]), "two-discs", "curves.count"),
    "every contour twice": (changed(lambda lines: lines + lines), "disc", "topology.sides"),
    "contours that cross": (
        changed(lambda lines: [*lines, np.array([[0, 0], [6.9, 8.1]])]),
        "disc",
        "geometry.embedded",
    ),
    "half a cell away": (
        changed(lambda lines: [x + 0.15 for x in lines]),
        "disc",
        "topology.sides",
    ),
    "midpoints": (
        lambda values, isovalue, spacing: mixed(
            np.where(values >= isovalue, 1.0, -1.0), 0, spacing
        ),
        "disc",
        "geometry.crossing",
    ),
    "a contour where there is none": (
        changed(lambda lines: lines or [np.array([[0.1, 0.1], [0.2, 0.2], [0.1, 0.1]])]),
        "constant",
        "simplices.nothing",
    ),
}


@pytest.mark.parametrize("fault", BROKEN)
def test_a_fault_of_contours_is_caught(fault: str) -> None:
    """By the claim that says so of every kind."""
    function, case, claim = BROKEN[fault]
    assert claim in failing(function, SAYS, (case,))


def test_who_decides_by_the_order_of_the_axes_is_caught() -> None:
    """A square and the same square turned are joined in different ways."""

    def by_order(values: Any, isovalue: float, spacing: Any) -> Polylines:
        mode = "connect" if values[0, 0] > values[-1, 0] else "disconnect"
        return list(isoref.diconex(values, isovalue, spacing, mode))

    assert "symmetry.orientation" in failing(by_order, SAYS, ("saddle-mean-in-out",))
