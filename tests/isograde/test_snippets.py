"""Lines without us: each snippet fails on the accused, says where, and is silent on the reference.

Every snippet is a program of its own that is run here, on an implementation that is broken in a
known way and on one that is right.
"""

from __future__ import annotations

import contextlib
import io
import itertools
import json
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from isograde import grading
from isograde.adapters import open_adapter
from isograde.adapters.python import PythonAdapter
from isograde.cases import all_cases
from isograde.claims import CLAIMS
from isograde.declaration import declaration_from
from isograde.model import CONTOURS, CURVES, Adapter, Case, Kind
from isograde.report.page import page
from isograde.report.shows import BODIES
from isograde.report.snippet import UNSTEADY, snippet, without
from isograde.shrinking import shrink

from tests.isograde import accused
from tests.isograde import miniatures as mini
from tests.isograde.judging import Here
from tests.isograde.miniatures import BROKEN, ROUGH, Inside, Miniature
from tests.isograde.reporting import graded
from tests.isograde.test_adapters_foreign import KUHN
from tests.isograde.test_claims import CASES
from tests.isograde.test_perfect_claim import BROKEN as DEGENERATE

SOME = (
    "pairs/0217", "cells/outside/003", "noise/white-5x6x7", "ties/noise-00",
    "trilinear/each/3.2/0", "trilinear/each/7.4.2/0", "trilinear/each/4.1/0",
)  # fmt: skip
PLANE = ("contours/noise", "contours/waves")
PAIRS = ("curves/noise-small", "curves/noise")
# Claims of which there are no lines: conventions, of which the page says so in a sentence.
WITHOUT = {"robustness.nan", "robustness.bad_input"}
# Those that take more than a few lines to show, of which the page says that.
LONGER = {
    "robustness.elsewhere", "topology.tie_side", "accuracy.normals_returned",
    "symmetry.directions", "symmetry.normals_returned", "accuracy.continuity",
    "curves.confidence", "accuracy.shapes", "accuracy.normals_of_planes",
}  # fmt: skip


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


KNOWN = [one for one in BROKEN if one.breaks not in WITHOUT]


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


# Faults of which the answer is known by formula: function, claim, case, reference, declaration.
ORDERS = {one.breaks: (accused.slug(one.name), "WHOLE") for one in ROUGH}
CURVE = {"limits": {"kinds": [list(CURVES)]}}
BY_FORMULA = (
    *(("curves_with_a_speck", "curves.count", case, "curves_right", CURVE) for case in (
        "curves/two-spheres", "curves/two-cylinders", "curves/two-isovalues",
        "curves/hydrogen-ring", "curves/hydrogen-axis")),
    ("curves_of_four_points", "curves.linking", "curves/trefoil", "curves_right", CURVE),
    ("curves_of_four_points", "curves.linking", "curves/hopf-link", "curves_right", CURVE),
    ("curves_pulled_inwards", "curves.on_surfaces", "curves/two-spheres", "curves_right", CURVE),
    ("curves_of_eight_points", "curves.covers", "curves/trefoil", "curves_right", CURVE),
    ("half_a_curve", "curves.covers", "curves/villarceau", "kuhn",
     {"interpolant": "kuhn", **CURVE}),
    ("contour_with_a_speck", "curves.count", "contours/annulus", "contours",
     {"limits": {"kinds": [list(CONTOURS)]}}),
    ("contour_with_a_speck", "curves.count", "contours/border", "contours",
     {"limits": {"kinds": [list(CONTOURS)]}}),
    ("sections_with_a_bubble", "simplices.euler", "simplices/clifford-torus", "kuhn",
     {"interpolant": "kuhn", "limits": {"kinds": [[4, 2]]}}),
    ("torn_curve", "simplices.euler", "simplices/two-circles", "kuhn",
     {"interpolant": "kuhn", **CURVE}),
    ("sections_at_means", "simplices.flat", "simplices/flat-3-2", "kuhn",
     {"interpolant": "kuhn", **CURVE}),
    ("sections_at_means", "simplices.flat", "simplices/flat-4-2", "kuhn",
     {"interpolant": "kuhn", "limits": {"kinds": [[4, 2]]}}),
)  # fmt: skip


@pytest.mark.parametrize(("name", "claim", "case", "reference", "says"), BY_FORMULA)
def test_what_is_known_by_formula_is_shown_by_it(
    name: str, claim: str, case: str, reference: str, says: dict[str, Any]
) -> None:
    """Curves, their links, the surfaces they lie on, manifolds and flat sets."""
    check(of(name, claim, (case,), **says), name, reference)


@pytest.mark.parametrize("claim", ORDERS)
def test_an_error_that_does_not_shrink_is_shown_on_a_row_of_spheres(claim: str) -> None:
    """Its order is fitted by the lines."""
    name, reference = ORDERS[claim]
    check(of(name, claim, ("accuracy/sphere",)), name, reference)


@pytest.mark.parametrize("case", ["accuracy/torus", "accuracy/2-1", "accuracy/3-2"])
def test_errors_are_shown_of_other_bodies(case: str) -> None:
    """Of tori, of circles in the plane, and of circles in space."""
    if case == "accuracy/torus":
        for claim in ("accuracy.normal", "accuracy.volume"):
            name = ORDERS[claim][0]
            check(of(name, claim, (case,)), name, "WHOLE")
        return
    kind = {"accuracy/2-1": CONTOURS, "accuracy/3-2": CURVES}[case]
    says = {"interpolant": "kuhn", "limits": {"kinds": [list(kind)]}}
    for claim in ("accuracy.position", "accuracy.normal"):
        check(of("kuhn_at_middles", claim, (case,), **says), "kuhn_at_middles", "kuhn")


def test_two_cuts_of_one_face_are_shown() -> None:
    """The tables of the paper as they were printed, in five dimensions."""
    says = {"interpolant": "kuhn", "limits": {"kinds": [[5, 3]], "least": 2}}
    program = of("sections_as_printed", "simplices.conforming", ("simplices/noise-5-3",), **says)
    check(program, "sections_as_printed", "kuhn")


def test_components_that_may_not_change_places_are_shown() -> None:
    """Where the curve meets the faces of the lattice."""
    name = "curves_by_the_first_field"
    check(of(name, "symmetry.components", PAIRS, **CURVE), name, "curves_right")


@pytest.mark.parametrize("told", DEGENERATE)
def test_a_degenerate_surface_is_shown_before_its_points_move(told: str) -> None:
    """No area, one place, a crossing."""
    name = accused.slug(told)
    cases = [all_cases(0)[case] for case in SOME]
    adapter = Here(getattr(accused, name), declaration_from({}, name))
    check(lines(adapter, name, "cells.perfect", cases), name, "STARS")


@pytest.mark.parametrize(
    ("name", "claim"),
    [
        ("with_epsilon", "range.scale"),
        ("in_half_precision", "range.shift"),
        ("in_single_precision", "range.digits"),
        ("turned_by_isovalue", "symmetry.shift"),
    ],
)
def test_a_range_is_shown_where_it_ends(name: str, claim: str) -> None:
    """By the field at the first magnitude, or offset, at which the answer is another."""
    check(of(name, claim, ("noise/white-5x6x7",)), name, "WHOLE")


@pytest.mark.parametrize("name", ["overflowing", "torn_at_extremes"])
def test_samples_of_extremes_are_shown_by_themselves(name: str) -> None:
    """The mesh is not finite, or open, where samples of 1e300 stand among others."""
    check(of(name, "range.extremes", ("noise/white-5x6x7",)), name, "WHOLE")


CALLS = {
    "buffered": "calls.buffer",
    "by_array": "calls.again",
    "with_globals": "calls.threads",
    "leaking": "calls.leak",
    "squaring": "calls.growth",
    "hoarding": "calls.growth",
}


def ends(program: str) -> tuple[int, str]:
    """How these lines end in a process of their own, and what they print."""
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, capture_output=True, encoding="utf-8", check=False)
    assert done.returncode in (0, 1)
    assert done.returncode == 0 or "AssertionError" in done.stderr, done.stderr
    return done.returncode, done.stdout.strip()


@pytest.mark.slow
@pytest.mark.parametrize("name", CALLS)
def test_what_calls_do_to_each_other_and_cost_is_shown(name: str) -> None:
    """In a process of its own: a buffer, an array known again, a global, a leak, squared costs."""
    claim, spec = CALLS[name], f"python:tests.isograde.mistaken:{name}"
    adapter = PythonAdapter(spec)
    try:
        report = graded(adapter, spec, [all_cases(0)["cost/surfaces"]], claim)
    finally:
        adapter.close()
    program = snippet(report, report.summaries[claim])
    assert program is not None
    status, told = ends(program)
    assert status == 1
    assert told
    call = f"import {name} as extract"
    assert call in program
    assert ends(program.replace(call, "import correct as extract")) == (0, "")


@pytest.mark.parametrize("claim", sorted(WITHOUT))
def test_the_page_says_why_there_are_no_lines(claim: str) -> None:
    """In a sentence, as where the answers stand in a folder or the field is too large."""
    [one] = [one for one in BROKEN if one.breaks == claim]
    cases = [all_cases(0)[case] for case in SOME[:2]]
    posed = [replace(case, tags=case.tags | {"posed"}) for case in cases]
    spec = f"python:tests.isograde.accused:{accused.slug(one.name)}"
    report = graded(Inside(one), spec, posed, claim)
    summary = report.summaries[claim]
    assert summary.failure is not None
    assert snippet(report, summary) is None
    assert "convention" in without(report, summary)
    assert "Without isograde: what it does with such input is a convention" in page(report)
    foreign = graded(Inside(KNOWN[1]), "dir:answers", posed, KNOWN[1].breaks)
    summary = foreign.summaries[KNOWN[1].breaks]
    assert snippet(foreign, summary) is None
    assert "No lines of Python" in without(foreign, summary)


SERVICE = Path(__file__).parents[2] / "validation" / "league" / "services" / "serve.py"


def served(folder: Path, name: str) -> str:
    """The command of a program, of its own, that answers as a function of `accused`, in files."""
    shutil.copy(SERVICE, folder)
    (folder / "adapter.py").write_text(
        f"import sys\nsys.path.insert(0, {str(Path.cwd())!r})\n"
        f"from tests.isograde.accused import {name} as extract\n",
        encoding="utf-8",
    )
    method = {"function": "extract", "options": {}, "declaration": {"name": name}}
    (folder / "method.json").write_text(json.dumps(method), encoding="utf-8")
    return shlex.join([sys.executable, str(folder / "serve.py"), str(folder / "method.json")])


def cut(folder: Path, name: str) -> str:
    """The command of a program that prints polylines, some without their ends."""
    text = KUHN.read_text(encoding="utf-8")
    if name == "cut":
        at = "        push @chains, ["
        assert text.count(at) == 1
        text = text.replace(at, f"        pop @chain if @chain > 2;\n{at}")
    (folder / f"{name}.pl").write_text(text, encoding="utf-8")
    return shlex.join(["perl", str(folder / f"{name}.pl"), "polylines"])


@pytest.mark.parametrize(
    ("command", "wrong", "right", "case"),
    [(served, "HOLED", "MEAN", "noise/white-5x6x7"), (cut, "cut", "whole", "contours/noise")],
)
def test_a_program_in_any_language_is_shown_by_lines_that_ask_it(
    command: Callable[[Path, str], str], wrong: str, right: str, case: str, tmp_path: Path
) -> None:
    """Its own command stands in the lines; they fail on who is wrong, and not on the other."""
    spec = f"exec:{command(tmp_path, wrong)}"
    adapter = open_adapter(spec)
    try:
        posed = replace(all_cases(0)[case], tags=frozenset({"posed"}))
        report = graded(adapter, spec, [posed], "topology.closed")
    finally:
        adapter.close()
    program = snippet(report, report.summaries["topology.closed"])
    assert program is not None
    status, told = ends(program)
    assert status == 1
    assert told
    called = spec.removeprefix("exec:")
    assert ascii(called) in program
    assert ends(program.replace(ascii(called), ascii(command(tmp_path, right)))) == (0, "")


def test_every_claim_has_lines_that_are_run_here_or_is_said_to_have_none() -> None:
    """No claim is forgotten."""
    run = {one.breaks for one in KNOWN} | set(BODIES) | {"curves.identical", "cells.separate"}
    run |= {
        "topology.scan",
        "cells.join",
        "simplices.nothing",
        "structure.apart",
        "structure.with_measure",
        "simplices.conforming",
        "symmetry.components",
        "cells.perfect",
        "range.scale",
        "range.shift",
        "range.extremes",
        "range.digits",
        *ORDERS,
        *CALLS.values(),
        *(claim for _, claim, *_ in BY_FORMULA),
    }
    assert set(CLAIMS) - run - WITHOUT - LONGER == set()


def test_lines_on_who_answers_otherwise_each_time_say_so() -> None:
    """Of pytessel and gts-tetra-bounded, lines that failed in the grade were silent later."""
    calls = itertools.count()

    def unsteady(values: Any, isovalue: float, spacing: Any) -> Any:
        vertices, faces = mini.plain(values, isovalue, spacing)
        return vertices, faces[next(calls) % 2 :]

    cases = [all_cases(0)["noise/white-6x7x5"]]
    for function, said in ((unsteady, True), (mini.plain, False)):
        declared = declaration_from({"level": 2}, "it")
        report = graded(Here(function, declared), "python:it:it", cases)
        assert bool(report.summaries["robustness.deterministic"].bad) == said
        programs = [text for one in report.summaries.values() if (text := snippet(report, one))]
        assert programs
        assert {text.startswith(UNSTEADY) for text in programs if text} == {said}
