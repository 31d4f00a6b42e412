"""Lines without us: each snippet fails on the accused, says where, and is silent on the reference.

Every snippet is a program of its own that is run here, on an implementation that is broken in a
known way and on one that is right.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from typing import Any

import pytest
from isograde import grading
from isograde.cases import all_cases
from isograde.claims import CLAIMS
from isograde.declaration import declaration_from
from isograde.model import CONTOURS, CURVES, Adapter, Case, Kind
from isograde.report.shows import BODIES
from isograde.report.snippet import snippet
from isograde.shrinking import shrink

from tests.isograde import accused
from tests.isograde.judging import Here
from tests.isograde.miniatures import BROKEN, Inside, Miniature
from tests.isograde.reporting import graded
from tests.isograde.test_claims import CASES

SOME = (
    "pairs/0217", "cells/outside/003", "noise/white-5x6x7", "ties/noise-00",
    "trilinear/each/3.2/0", "trilinear/each/7.4.2/0", "trilinear/each/4.1/0",
)  # fmt: skip
PLANE = ("contours/noise", "contours/waves")
PAIRS = ("curves/noise-small", "curves/noise")
# Claims of which there are no lines: an error is right there, or none is; what they ask takes more
# than a snippet (time and memory, errors that shrink, magnitudes, a surface before its points move,
# triangulations in many dimensions), or the case is too large to print.
WITHOUT = {
    "robustness.nan", "robustness.bad_input", "cells.perfect", "curves.count", "curves.linking",
    "curves.on_surfaces", "curves.covers", "simplices.conforming", "simplices.euler",
    "simplices.flat", "symmetry.components",
    *(name for name in CLAIMS if name.split(".")[0] in ("accuracy", "calls", "range")),
}  # fmt: skip
# Miniatures whose claim has lines that do not see this fault.
BLIND = {"non-manifold edge"}


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """No reference is started to draw beside, and little time is spent on making cases smaller."""
    monkeypatch.setattr(grading, "contrast", lambda *_: {})
    monkeypatch.setattr(grading, "shrink", partial(shrink, seconds=0.5))


def holds(program: str) -> tuple[bool, str]:
    """Whether the lines find nothing wrong, and what they print; any other error is raised."""
    printed = io.StringIO()
    try:
        with contextlib.redirect_stdout(printed):
            exec(program, {})
    except AssertionError:
        return False, printed.getvalue().strip()
    return True, printed.getvalue().strip()


def lines(adapter: Adapter, name: str, claim: str, cases: Iterable[Case]) -> str:
    """The snippet of the first of these cases on which the claim fails of this implementation."""
    for case in cases:
        posed = replace(case, tags=case.tags | {"posed"})
        report = graded(adapter, f"python:tests.isograde.accused:{name}", [posed], claim)
        summary = report.summaries[claim]
        if summary.failure is not None:
            program = snippet(report, summary)
            assert program is not None, summary.failure
            return program
    raise AssertionError(f"{name} does not fail {claim}")


def of(name: str, claim: str, cases: Iterable[str], **says: Any) -> str:
    """The same, of a function of `accused` on cases of the catalogue."""
    adapter = Here(getattr(accused, name), declaration_from(says, name))
    return lines(adapter, name, claim, [all_cases(0)[case] for case in cases])


def check(program: str, name: str, reference: str) -> None:
    """The program fails on the accused with a place, and is silent on the reference."""
    assert "isograde" not in program.replace("tests.isograde", "")
    assert "assert not wrong" in program
    accused_holds, told = holds(program)
    assert not accused_holds, program
    assert told
    call = f"import {name} as extract"
    assert call in program
    assert holds(program.replace(call, f"import {reference} as extract")) == (True, ""), program


KNOWN = [one for one in BROKEN if one.breaks not in WITHOUT and one.name not in BLIND]


@pytest.mark.parametrize("one", KNOWN, ids=[one.name for one in KNOWN])
def test_every_broken_miniature_is_shown_without_us(one: Miniature) -> None:
    """Of surfaces, for each claim on a cell, its topology, its geometry, how it is posed."""
    name = accused.slug(one.name)
    cases = [*(all_cases(0)[case] for case in SOME), *CASES.values()]
    program = lines(Inside(one), name, one.breaks, cases)
    reference = "MEAN" if one.breaks == "cells.mean" else "EXACT"
    check(program, name, reference)


@pytest.mark.parametrize(
    ("name", "claim"),
    [
        ("ONCE_MORE", "bodies.pieces"),
        ("HOLED", "bodies.holes"),
        ("GROWN", "bodies.offset"),
        ("SCALED", "bodies.centroid"),
        ("SPIKED", "bodies.distance"),
        ("TURNED", "bodies.degree"),
    ],
)
@pytest.mark.parametrize("kind", ["float64", "uint8"])
def test_a_known_body_is_shown_by_its_formula(name: str, claim: str, kind: str) -> None:
    assert claim in BODIES
    case = {"float64": "bodies/3-1/sphere-16-float64", "uint8": "bodies/3-1/sphere-17-uint8"}[kind]
    check(of(name, claim, (case,)), name, "WHOLE")


@pytest.mark.parametrize(
    ("name", "claim", "reference", "says"),
    [
        ("contours_apart", "topology.bilinear", "contours", {"level": 3}),
        ("contours_apart", "cells.join", "contours_joined", {"promised": ["cells.join"]}),
        ("contours_crossing", "cells.legal", "contours", {}),
        ("contours_crossing", "geometry.embedded", "contours", {}),
        ("kuhn_without_half", "topology.sides", "kuhn", {"interpolant": "kuhn"}),
        ("kuhn_turned", "topology.sides", "kuhn", {"interpolant": "kuhn"}),
        ("kuhn_astray", "geometry.vertices", "kuhn", {"interpolant": "kuhn"}),
    ],
)
def test_contours_are_shown_too(
    name: str, claim: str, reference: str, says: dict[str, Any]
) -> None:
    says = {**says, "limits": {"kinds": [list(CONTOURS)]}}
    check(of(name, claim, PLANE, **says), name, reference)


@pytest.mark.parametrize(
    ("name", "claim"),
    [
        ("kuhn_without_half", "topology.sides"),
        ("kuhn_without_half", "topology.closed"),
        ("kuhn_turned", "topology.sides"),
    ],
)
def test_curves_are_shown_too(name: str, claim: str) -> None:
    says = {"interpolant": "kuhn", "limits": {"kinds": [list(CURVES)]}}
    check(of(name, claim, PAIRS, **says), name, "kuhn")


def test_a_curve_where_there_is_none_is_shown() -> None:
    says = {"limits": {"kinds": [list(CURVES)]}}
    program = of("double_curve", "curves.identical", ("curves/identical",), **says)
    check(program, "double_curve", "no_curve")


def test_pieces_that_the_trilinear_level_set_does_not_have_are_shown() -> None:
    name = "broken_fixed_polarity"
    check(of(name, "topology.scan", ["noise/white-5x6x7"], level=3), name, "EXACT")


@pytest.mark.parametrize("n", [3, 4])
def test_sides_are_shown_in_any_dimension(n: int) -> None:
    kind = Kind(n, 1)
    names = tuple(
        name for name, one in all_cases(0).items() if one.kind == kind and "noise" in name
    )
    assert names
    says = {"interpolant": "kuhn", "limits": {"kinds": [list(kind)]}}
    program = of("kuhn_without_half", "topology.sides", names[:2], **says)
    check(program, "kuhn_without_half", "kuhn")


def test_every_claim_has_lines_that_are_run_here_or_is_said_to_have_none() -> None:
    """No claim is forgotten."""
    run = {one.breaks for one in KNOWN} | set(BODIES) | {"curves.identical", "cells.separate"}
    run |= {
        "topology.scan",
        "cells.join",
        "simplices.nothing",
        "structure.apart",
        "structure.with_measure",
    }
    assert set(CLAIMS) - run - WITHOUT == set()
