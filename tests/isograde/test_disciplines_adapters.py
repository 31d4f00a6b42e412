"""Every discipline goes through every adapter: a program in Perl, and its broken copies."""

import json
import shlex
import shutil
import subprocess
from collections import Counter
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from isograde.adapters import export, open_adapter
from isograde.command import app
from isograde.commands.exporting import requests
from isograde.disciplines.registry import DISCIPLINES
from isograde.model import AdapterError, Case, Limits, Verdict
from isograde.runner import Options
from typer.testing import CliRunner

from tests.isograde.judging import grade

KUHN = Path(__file__).with_name("foreign") / "kuhn.pl"
# What a few seconds suffice for; the rest of each discipline has its own tests.
CASES = {
    "contours": ("disc", "annulus", "border", "noise", "bytes", "constant"),
    "curves": ("two-isovalues", "noise", "apart"),
    "simplices": ("circle", "circle-in-space", "noise-3-2", "sphere", "apart"),
}
Count = Mapping[str, Counter[str]]

if (
    not shutil.which("perl")
    or subprocess.run(["perl", "-MJSON::PP", "-e1"], capture_output=True, check=False).returncode
):
    pytest.skip("no Perl with JSON::PP here", allow_module_level=True)


def some(kind: str, *names: str) -> list[Case]:
    """Cases of a discipline."""
    return [DISCIPLINES[kind].cases(0)[f"{kind}/{name}"] for name in names or CASES[kind]]


def judged(spec: str, asked: list[Case]) -> dict[str, dict[str, list[str]]]:
    """The claims by verdict, each with the cases it was judged on."""
    adapter = open_adapter(spec)
    declaration = adapter.open(Limits())
    found: dict[str, dict[str, list[str]]] = {}
    try:
        for case, claim, finding in grade(adapter, declaration, asked):
            place = found.setdefault(finding.verdict.value, {})
            place.setdefault(claim.split(".")[1], []).append(case.split("/")[1])
    finally:
        adapter.close()
    return found


def program(kind: str, at: Path = KUHN) -> str:
    """The adapter to the program."""
    return f"exec:perl {shlex.quote(str(at))} {kind}"


def exported(kind: str, folder: Path, asked: list[Case]) -> Path:
    """A folder with these cases in every way that is asked for."""
    options = Options(only=tuple(case.id for case in asked))
    fields = requests(DISCIPLINES[kind], options, variants=True)
    export(folder, fields, kind, DISCIPLINES[kind].layout)
    return folder


def answered(kind: str, folder: Path, at: Path = KUHN) -> str:
    """The adapter to the folder, once the program has answered what is in it."""
    subprocess.run(["perl", str(at), kind, str(folder)], check=True)
    return f"dir:{folder}"


@pytest.mark.slow
@pytest.mark.parametrize("kind", CASES)
def test_a_foreign_program_is_graded_alike_through_both_adapters(kind: str, tmp_path: Path) -> None:
    """Asked line by line, and by files alone: all is right, and the same claims are judged."""
    asked = some(kind)
    asked_live = judged(program(kind), asked)
    from_files = judged(answered(kind, exported(kind, tmp_path / "out", asked)), asked)
    assert set(asked_live) <= {Verdict.PASS, Verdict.UNSUPPORTED}
    assert from_files == asked_live
    assert len(asked_live["pass"]) >= 8
    declined = {case for cases in asked_live.get("unsupported", {}).values() for case in cases}
    assert declined == ({"sphere"} if kind == "simplices" else declined)


def broken(tmp_path: Path, was: str, now: str) -> Path:
    """A copy of the program with one place changed."""
    text = KUHN.read_text(encoding="utf-8")
    assert text.count(was) == 1, was
    copy = tmp_path / "broken.pl"
    copy.write_text(text.replace(was, now), encoding="utf-8")
    return copy


FAULTS = {
    "the second isovalue is not read": (
        "    $isovalue[1] = $values[2 * $size] if",
        "    $isovalue[1] = $isovalue[0] if",
        {"count", "covers", "linking", "converges"},
    ),
    "points are counted in samples": (
        "$p->[$_] * $spacing->[$_] +",
        "$p->[$_] +",
        {"covers", "on-surfaces"},
    ),
    "coordinates come in reversed order": (
        "} @keys;\n    spill",
        "} @keys;\n    @points = reverse @points;\n    spill",
        {"covers"},
    ),
    "one number too few": (
        '    spill("$stem.vertices.npy"',
        '    pop @second;\n    spill("$stem.vertices.npy"',
        {"well-formed", "whole", "count"},
    ),
    "points in the plane": (
        "npy('<f8', 'd<*', $n, @points)",
        "npy('<f8', 'd<*', 2, @points[0 .. 2 * @keys - 1])",
        {"well-formed", "whole", "count"},
    ),
    "files are cut off": (
        "print $file $_[1];",
        "print $file substr($_[1], 0, length($_[1]) - 9 * (length($_[1]) > 300));",
        {"well-formed", "whole", "count"},
    ),
    "the curve is not followed to its end": (
        "        push @chains, [",
        "        pop @chain;\n        push @chains, [",
        {"whole", "count"},
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_a_broken_program_fails_through_both_adapters(fault: str, tmp_path: Path) -> None:
    """Wrong arguments, truncated arrays and files: judged, and alike through both adapters."""
    was, now, expected = FAULTS[fault]
    at = broken(tmp_path, was, now)
    asked = some("curves", "two-isovalues")
    live = judged(program("curves", at), asked)
    files = judged(answered("curves", exported("curves", tmp_path / "out", asked), at), asked)
    assert set(live) <= {"pass", "fail"}
    assert expected & set(live["fail"]) == expected
    assert files == live


def test_an_answer_line_cut_short_is_garbage(tmp_path: Path) -> None:
    """Half a line of JSON, and the rest never comes."""
    at = broken(
        tmp_path,
        'print encode_json($said), "\\n";',
        """
        print substr(encode_json($said), 0, $ask->{command} eq "run" ? 9 : 1e6), "\\n";""",
    )
    found = judged(program("curves", at), some("curves", "two-cylinders"))
    assert set(found) == {"fail"}
    assert "well-formed" in found["fail"]


def test_the_manifest_tells_a_stranger_what_is_asked(tmp_path: Path) -> None:
    """Which discipline it is, and how samples and answers are laid out."""
    for kind in DISCIPLINES:
        folder = tmp_path / kind
        case = next(iter(DISCIPLINES[kind].cases(0).values()))
        export(folder, [case], kind, DISCIPLINES[kind].layout)
        manifest = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
        assert manifest["discipline"] == kind
        assert {"values", "vertices", "faces", "answer"} <= set(manifest["conventions"])
        stem = folder / manifest["fields"][0]["values"].removesuffix(".npy")
        for part in ("vertices", "faces"):
            np.save(f"{stem}.{part}.npy", np.empty((0, 3)))
        assert open_adapter(f"dir:{folder}").open(Limits()).discipline == kind


def test_a_declaration_of_another_discipline_is_refused(tmp_path: Path) -> None:
    """The fields in the folder are none of contours."""
    folder = exported("curves", tmp_path / "out", some("curves", "apart"))
    (folder / "declaration.json").write_text('{"discipline": "contours"}', encoding="utf-8")
    with pytest.raises(AdapterError, match="declares contours, but the folder holds curves"):
        open_adapter(f"dir:{folder}").open(Limits())


def test_fields_of_a_discipline_are_exported_and_graded_by_the_command(tmp_path: Path) -> None:
    """`isograde export --discipline curves`, a program run by hand, `isograde grade dir:`."""
    folder = tmp_path / "out"
    only = ("--only", "curves/two-isovalues")
    run = CliRunner().invoke
    written = run(app, ["export", str(folder), "--discipline", "curves", "--variants", *only])
    assert written.exit_code == 0, written.output
    spec = answered("curves", folder)
    done = run(app, ["grade", spec, *only, "--out", str(tmp_path / "report"), "--format", "md"])
    assert done.exit_code == 0, done.output
    wrong = run(app, ["export", str(tmp_path / "none"), "--discipline", "curve"])
    assert wrong.exit_code == 2
    assert "no discipline 'curve'" in wrong.output
