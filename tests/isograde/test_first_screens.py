"""What the first screen says, tried on implementations like those that people have.

Issue 12: an MC33 that is right in every cell and crowds edges read "below level 0"; a soup whose
vertices differ in the last digits had holes by the hundred. Each of these is one thing that is
wrong, and all the rest is right.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from functools import cache
from html import unescape
from pathlib import Path
from typing import Any

import pytest
from isograde import grading
from isograde.cases import all_cases
from isograde.declaration import declaration_from
from isograde.report.findings import by_choice, causes
from isograde.report.headline import CHOSEN, by_level, chosen, headline, waste, wrong_cells
from isograde.report.lines import open_text
from isograde.report.page import page
from isograde.report.reading import Report, bad_in, gather
from isoref.field import Field

from tests.isograde import families
from tests.isograde.judging import Here
from tests.isograde.reporting import graded
from tests.isograde.test_flat import BOTH, by

CASES = (
    "noise/white-5x6x7", "pairs/0217", "trilinear/each/4.2/0", "trilinear/each/12.1.2/0",
    "bodies/3-1/sphere-16-float64",
)  # fmt: skip


def vega(values: Any, isovalue: float, spacing: Any) -> Any:
    """An MC33 with every tunnel right, whose cells draw flat triangles in the faces they share."""
    mesh = by(BOTH)(Field.of(values, spacing), isovalue)
    return mesh.vertices, mesh.simplices


LIKE: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "vega": (vega, {"level": 4}),
    "nets": (
        families.nets,
        {"level": 2, "vertices": "cells", "domain": {"inset": 0.5, "end": "open"}},
    ),
    "rust": (families.cubes_in_soup_from_either_end, {"level": 2}),
}


@cache
def report_of(name: str) -> Report:
    """The report of one of them on a few cases."""
    function, says = LIKE[name]
    cases = [all_cases(0)[case] for case in CASES]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(grading, "contrast", lambda *_: {})
        return graded(Here(function, declaration_from(says, name)), f"python:it:{name}", cases)


def screens(name: str) -> tuple[str, str]:
    """What the first screen of the page says is wrong, and what it says is right; as text."""
    head = page(report_of(name)).split('<h2 id="ladder">')[0]
    text = " ".join(unescape(re.sub(r"<[^>]+>", " ", head.split("</style>")[-1])).split())
    wrong, _, right = text.partition("What is right")
    return wrong.partition("What is wrong")[2], right


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "wrong", "right"),
    [
        (
            "vega",
            ["triangles lie flat in the face between the cells", "two of each, and share an edge",
             "so fails geometry.embedded"],
            ["Every cell has the topology of the trilinear interpolant", "There is no hole",
             "Every vertex is where it may be", "Known bodies come out"],
        ),
        (
            "nets",
            ["sheets of the surface", "each cell has one vertex"],
            ["There is no hole", "Every sample is on its side", "Known bodies come out",
             "Nothing crosses"],
        ),
        (
            "rust",
            ["No two triangles share a vertex", "equal vertices differ in the last digits",
             "interpolate from the same end for every cell", '"mesh": {"soup": 1e-5}'],
            ["Every crossing is where the interpolant has it", "The arrays are well formed",
             "Every sample is on its side"],
        ),
    ],
)  # fmt: skip
def test_the_first_screen_says_what_is_wrong_and_what_is_right(
    name: str, wrong: list[str], right: list[str]
) -> None:
    """Issue 12, done when: one finding is held, and what is right stands beside it."""
    is_wrong, is_right = screens(name)
    assert [told for told in wrong if told not in is_wrong] == []
    assert [told for told in right if told not in is_right] == []
    assert len([one for one in causes(report_of(name)) if one.held]) == 1


@pytest.mark.slow
def test_an_exact_extractor_that_crowds_edges_is_closed_and_said_to_be_exact() -> None:
    """It reads "no level" on a few cases, but never as torn or wrong inside."""
    assert "hole" not in headline(report_of("vega"))
    _, right = screens("vega")
    assert "Every ambiguous face is decided as the bilinear interpolant does" in right


# --- a dozen implementations --------------------------------------------------------------------

KEPT = Path(__file__).parents[2] / "reports" / "implementations"
DOZEN = (
    "isoref-trilinear-cubes", "isoref-asymptotic-decider", "isoref-vesta-mixed-L", "pymcubes",
    "vtk-marching-cubes", "libigl", "vtk-contour-filter", "skimage-lewiner", "trimesh",
    "isoref-surface-nets", "isoref-lorensen-cline", "pymeshlab",
)  # fmt: skip


@cache
def kept(name: str) -> Report:
    """A kept report, its lines read without the schema, which is tested elsewhere."""
    with open_text(KEPT / f"{name}.jsonl.gz", "r") as file:
        return gather(map(json.loads, file))


@pytest.mark.slow
def test_of_a_dozen_torn_comes_after_wrong_topology_and_that_after_wasteful() -> None:
    """Issue 12: the headline order, tried on the kept results."""
    found = [kept(name) for name in DOZEN]
    assert len(found) == 12
    order = sorted(found, key=by_level)
    torn = [bool(bad_in(one.summaries["topology.closed"].general)) for one in order]
    runs = [one.reached is None for one in order]
    broken = [a or b for a, b in zip(torn, runs, strict=True)]
    assert any(broken)
    assert broken == sorted(broken), "what tears, or does not run, comes last"
    # Among those of one level that decide faces by choice, fewer wrong cells come first.
    chosen_ones = [one for one in order if chosen(one) and one.reached == 2]
    shares = [one.short_of(3).share for one in chosen_ones]
    assert len(chosen_ones) > 2
    assert shares == sorted(shares)
    ties = [
        (wrong_cells(one), waste(one)) for one in chosen_ones if one.short_of(3).share == shares[-1]
    ]
    assert ties == sorted(ties)


@pytest.mark.slow
def test_of_a_dozen_no_choice_reads_like_a_fault() -> None:
    """Words for choices: whoever decides faces in one way always is said to, not counted."""
    free = [one for one in map(kept, DOZEN) if chosen(one) and one.reached == 2 < one.top]
    assert len(free) > 3
    for one in free:
        assert any(told in headline(one) for told in CHOSEN.values())
        assert "topology.bilinear" in by_choice(one)
        assert "short of bilinear" not in headline(one)
