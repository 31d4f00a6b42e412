"""Lines that make a field of the plan make that field, and know of it what the case knows."""

from __future__ import annotations

from hashlib import sha256
from typing import Any

import numpy as np
import pytest
from isograde.cases import all_cases
from isograde.oracles.space_curves import KnownCurves, distances
from isograde.report.formulas import of_case

CASES = all_cases(0)
MADE = [
    name
    for name, case in CASES.items()
    if name.split("/")[0] in ("curves", "contours", "accuracy", "simplices", "cost")
    and of_case(case) is not None
]


def ran(name: str) -> dict[str, Any]:
    """What the lines of this case define."""
    lines = of_case(CASES[name])
    assert lines is not None
    found: dict[str, Any] = {"np": np, "sha256": sha256}
    exec(lines, found)
    return found


def test_every_case_of_which_a_curve_a_manifold_or_an_order_is_known_has_its_lines() -> None:
    """What a claim on known curves, manifolds, errors or costs is judged on can be shown."""
    known = {
        name
        for name, case in CASES.items()
        if {"curves", "closed", "manifold", "row"} & set(case.facts) or "cost" in case.tags
    }
    known -= {name for name in known if CASES[name].id.startswith(("analytic", "bodies"))}
    # Of directions along curves, which only full runs ask for, the page says that it has no lines.
    known -= {name for name in known if "directed" in CASES[name].tags}
    assert len(known) > 30
    assert known <= set(MADE)


@pytest.mark.parametrize("name", [one for one in MADE if "full" not in CASES[one].tags])
def test_the_lines_make_the_field_of_the_case(name: str) -> None:
    """Number for number, but for rounding."""
    found, case = ran(name), CASES[name]
    field = case.build()
    assert found["values"].shape == field.values.shape
    assert found["isovalue"] == case.isovalues
    assert np.allclose(found["spacing"], field.spacing, rtol=1e-12)
    assert np.allclose(found["origin"], field.origin, atol=1e-12) or name.startswith("contours/")
    assert np.abs(found["values"] - field.values).max() < 2e-6


@pytest.mark.parametrize(
    "name", [one for one in MADE if isinstance(CASES[one].facts.get("curves"), KnownCurves)]
)
def test_the_lines_know_the_curves(name: str) -> None:
    """Each known curve is the case's, and lies on both surfaces."""
    found, known = ran(name), CASES[name].facts["curves"]
    assert len(found["known"]) == len(known.curves)
    for mine, theirs in zip(found["known"], known.curves, strict=True):
        assert distances(mine, [theirs]).max() < 1e-4
        assert distances(theirs, [mine]).max() < 1e-4
