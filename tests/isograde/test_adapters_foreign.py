"""Contours and curves through every adapter: a program in Perl, and its broken copies."""

import shlex
import shutil
import subprocess
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np
import pytest
from isograde import variants
from isograde.adapters import export, open_adapter
from isograde.adapters.measure import ball, levels
from isograde.claims import CLAIMS
from isograde.model import CONTOURS, CURVES, Case, Kind, Limits, Request, Verdict
from isograde.runner import Task, Worker
from isoref.field import Field

KUHN = Path(__file__).with_name("foreign") / "kuhn.pl"

if (
    not shutil.which("perl")
    or subprocess.run(["perl", "-MJSON::PP", "-e1"], capture_output=True, check=False).returncode
):
    pytest.skip("no Perl with JSON::PP here", allow_module_level=True)


def noise(kind: Kind, samples: int) -> Field:
    """Random samples of this kind, in general position."""
    shape = (samples,) * kind.n if kind.m == 1 else (kind.m, *(samples,) * kind.n)
    spacing = (1.0, 2.0, 0.5)[: kind.n]
    return Field.of(np.random.default_rng(1).random(shape), spacing, dimension=kind.n)


CASES = [
    Case("circle", lambda: ball(CONTOURS), levels(CONTOURS), 30, kind=CONTOURS),
    Case("plane", lambda: noise(CONTOURS, 8), (0.4,), 64, kind=CONTOURS),
    Case("circle-in-space", lambda: ball(CURVES), levels(CURVES), 210, kind=CURVES),
    Case("two", lambda: noise(CURVES, 4), (0.4, 0.6), 64, kind=CURVES),
    Case("space", lambda: noise(Kind(3, 1), 3), (0.5,), 27),
]
# A program answers a wrong rank with an error, a folder with silence: no use to compare them.
ASKED = {
    name: claim
    for name, claim in CLAIMS.items()
    if name not in ("robustness.bad_input", "robustness.nan")
}
Said = dict[str, set[str]]


def judged(spec: str, asked: Iterable[Case]) -> Said:
    """By verdict, each claim with the case it was judged on."""
    cases = {case.id: case for case in asked}
    adapter = open_adapter(spec)
    found: Said = {}
    try:
        worker = Worker(adapter, adapter.open(Limits()), cases, ASKED)
        for case in cases.values():
            claims = tuple(
                name
                for name, claim in ASKED.items()
                if claim.applies_to(case) and claim.held(worker.declaration)
            )
            for claim, finding in worker.judge(Task(case.id, claims)).findings.items():
                found.setdefault(finding.verdict.value, set()).add(f"{case.id} {claim}")
    finally:
        adapter.close()
    return found


def program(form: str, at: Path = KUHN) -> str:
    """The adapter to the program."""
    return f"exec:perl {shlex.quote(str(at))} {form}"


def answered(form: str, folder: Path, asked: Iterable[Case], at: Path = KUHN) -> str:
    """The adapter to a folder with these cases in every way, once the program has answered."""
    requests = []
    for case in asked:
        field = case.build()
        names = {
            name
            for claim in ASKED.values()
            if claim.applies_to(case)
            for name in variants.named(claim.variants, case.kind)
        }
        for name in ("plain", *sorted(names)):
            posed = variants.pose(name, case, field)
            if posed is not None:
                requests.append(Request(case.id, name, *posed))
    export(folder, requests)
    subprocess.run(["perl", str(at), form, str(folder)], check=True)
    return f"dir:{folder}"


@pytest.mark.slow
@pytest.mark.parametrize("form", ["polylines", "segments"])
def test_a_foreign_program_is_graded_alike_through_both_adapters(form: str, tmp_path: Path) -> None:
    """Asked line by line, and by files alone: all is right, and the same claims are judged."""
    live = judged(program(form), CASES)
    assert set(live) == {Verdict.PASS, Verdict.SKIP, Verdict.UNSUPPORTED}
    assert {said.split()[0] for said in live["unsupported"]} == {"space"}
    for case in ("circle", "plane", "circle-in-space", "two"):
        assert sum(said.startswith(f"{case} ") for said in live["pass"]) >= 8, case
    assert judged(answered(form, tmp_path / "out", CASES), CASES) == live


def broken(tmp_path: Path, was: str, now: str) -> Path:
    """A copy of the program with one place changed."""
    text = KUHN.read_text(encoding="utf-8")
    assert text.count(was) == 1, was
    copy = tmp_path / "broken.pl"
    copy.write_text(text.replace(was, now), encoding="utf-8")
    return copy


FAULTS: Mapping[str, tuple[str, str, set[str]]] = {
    "the second isovalue is not read": (
        "$_ - $isovalue[$c]", "$_ - $isovalue[0]", {"topology.sides"},
    ),
    "points are counted in samples": ("* $spacing->[$_] +", "+", {"topology.sides"}),
    "coordinates come in reversed order": (
        "$at{$key}[$_] * $spacing->[$_]", "$at{$key}[$n - 1 - $_] * $spacing->[$_]",
        {"topology.sides"},
    ),
    "points in the plane": (
        "$origin->[$_], 0 .. $n - 1;\n}", "$origin->[$_], 0 .. 1;\n}", {"structure.answers"},
    ),
    "the curve is not followed to its end": (
        "        push @chains, [", "        pop @chain if @chain > 2;\n        push @chains, [",
        {"topology.closed"},
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_a_broken_program_fails_through_both_adapters(fault: str, tmp_path: Path) -> None:
    """Wrong arguments, wrong dimensions, cut curves: judged, and alike through both adapters."""
    was, now, expected = FAULTS[fault]
    at = broken(tmp_path, was, now)
    asked = [case for case in CASES if case.id == "two"]
    live = judged(program("polylines", at), asked)
    assert {f"two {claim}" for claim in expected} <= live["fail"]
    assert judged(answered("polylines", tmp_path / "out", asked, at), asked) == live


def test_an_answer_line_cut_short_is_garbage(tmp_path: Path) -> None:
    """Half a line of JSON, and the rest never comes."""
    at = broken(
        tmp_path,
        'print encode_json($said), "\\n";',
        'print substr(encode_json($said), 0, $ask->{command} eq "run" ? 9 : 1e6), "\\n";',
    )
    found = judged(program("polylines", at), [case for case in CASES if case.id == "circle"])
    assert "circle structure.answers" in found["fail"]
    assert not any("topology" in said for said in found.get("pass", set()))


def test_files_cut_short_are_garbage(tmp_path: Path) -> None:
    """An array that ends before its header says is no answer."""
    at = broken(tmp_path, "print $file $_[1];", "print $file substr($_[1], 0, length($_[1]) - 9);")
    found = judged(program("segments", at), [case for case in CASES if case.id == "circle"])
    assert "circle structure.answers" in found["fail"]
    assert not any("topology" in said for said in found.get("pass", set()))
