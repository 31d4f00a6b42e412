"""Reports and manifests that are damaged or hostile: status 2 and one sentence (issue 13)."""

import gzip
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from isograde import errata
from isograde.adapters import export, open_adapter
from isograde.adapters.answers import json_in, load, mesh_in
from isograde.adapters.forms import AnswerError
from isograde.command import app
from isograde.errata import Erratum
from isograde.grading import grade
from isograde.model import SURFACES, AdapterError, Limits, Request, Status
from isograde.report import comparison, reading
from isograde.report.lines import ReportError
from isograde.report.page import page
from isograde.runner import Options
from isoref.field import Field
from typer.testing import CliRunner, Result


def run(*arguments: object) -> Result:
    """The result of the command."""
    return CliRunner().invoke(app, [str(one) for one in arguments])


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A report with a failure."""
    path = tmp_path_factory.mktemp("sound") / "report.jsonl"
    grade("isoref:lorensen-cline", Options(only=("pairs/0217", "topology.closed")), path)
    return path


def lines_of(path: Path) -> list[dict[str, Any]]:
    """The lines of a report."""
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def without(name: str) -> Any:
    """A damage: the lines of a record are gone."""
    return lambda lines: [one for one in lines if one["record"] != name]


def changed(record: str, **entries: Any) -> Any:
    """A damage: entries of a record say something else."""
    return lambda lines: [one | entries if one["record"] == record else one for one in lines]


DAMAGES: dict[str, Any] = {
    "no header": without("header"),
    "no claims": without("claim"),
    "no cases": without("case"),
    "two headers": lambda lines: [lines[0], *lines],
    "header at the end": lambda lines: [*lines[1:], lines[0]],
    "another format": changed("header", format=99),
    "spec a number": changed("header", spec=5),
    "kinds of text": changed("header", kinds="surfaces"),
    "no such level": changed("claim", level=9),
    "a result of no case": changed("result", case="no/such/case"),
    "a claim of no name": changed("result", passed=["no.such"]),
    "findings a text": changed("result", findings="all good"),
    "seconds negative": changed("result", seconds=-1),
    "verdict unknown": changed(
        "result", findings=[{"claim": "topology.closed", "verdict": "splendid", "detail": ""}]
    ),
    "evidence of no claim": changed("evidence", claim="no.such"),
    "shape of text": changed("evidence", shape="large"),
    "a footer of nothing": changed("footer", cases=None),
    "an unknown record": lambda lines: [*lines, {"record": "surprise"}],
    "a list": lambda lines: [*lines, [1, 2]],
    "a number": lambda lines: [*lines, 7],
}


@pytest.mark.parametrize("damage", sorted(DAMAGES))
def test_a_damaged_report_is_refused_in_a_sentence(
    damage: str, sound: Path, tmp_path: Path
) -> None:
    lines = DAMAGES[damage](lines_of(sound))
    path = tmp_path / "report.jsonl"
    path.write_text("".join(json.dumps(one) + "\n" for one in lines))
    for command in (("compare", path, sound), ("diff", sound, path)):
        found = run(*command)
        assert found.exit_code == 2, found.output
        assert "Traceback" not in found.output


TEXTS = {
    "nothing": b"",
    "no text": b"\xff\xfe\x00",
    "half a line": b'{"record": "header", "for',
    "nan": b'{"record": "header", "seed": NaN}\n',
    "nested": b"[" * 100_000,
    "long number": b'{"record": ' + b"9" * 10_000 + b"}\n",
    "null": b"null\n",
    "surrogates": b'"\\ud800"\n',
    "html": b"<html></html>",
    "gzip": gzip.compress(b"not JSON"),
}


@pytest.mark.parametrize("name", sorted(TEXTS))
@pytest.mark.parametrize("ending", [".jsonl", ".jsonl.gz"])
def test_what_is_no_report_is_refused_in_a_sentence(
    name: str, ending: str, sound: Path, tmp_path: Path
) -> None:
    path = tmp_path / f"x{ending}"
    path.write_bytes(TEXTS[name])
    found = run("diff", path, sound)
    assert found.exit_code == 2, found.output
    assert str(path) in found.output.replace("\n", "")


def test_a_folder_a_link_and_a_missing_file_are_no_reports(sound: Path, tmp_path: Path) -> None:
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    for path in (tmp_path, tmp_path / "loop", tmp_path / "absent", Path("/dev/null")):
        assert run("compare", path, sound).exit_code == 2


def test_an_archive_cut_off_anywhere_is_told_so(sound: Path, tmp_path: Path) -> None:
    whole = gzip.compress(sound.read_bytes())
    path = tmp_path / "x.jsonl.gz"
    for cut in (1, 5, 12, len(whole) // 2, len(whole) - 3):
        path.write_bytes(whole[:cut])
        with pytest.raises(ReportError):
            reading.read(path)


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(place=st.integers(0, 10**6), byte=st.integers(0, 255), cut=st.integers(0, 10**6))
def test_a_report_with_a_changed_byte_is_read_or_refused(
    place: int, byte: int, cut: int, sound: Path, tmp_path: Path
) -> None:
    """Fuzz: a report or a `ReportError`, and what is read can be shown."""
    data = bytearray(sound.read_bytes())
    data[place % len(data)] = byte
    path = tmp_path / "x.jsonl"
    path.write_bytes(bytes(data if cut % 2 else data[: cut % len(data)]))
    try:
        found = reading.read(path)
    except ReportError:
        return
    assert found.summaries is not None
    comparison.changes(found, found)


# --- Folders of meshes ---------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """An exported folder with one answer, and a secret beside it."""
    field = Field.of(np.arange(8.0).reshape(2, 2, 2))
    export(tmp_path / "v", [Request("a", "plain", field, (3.5,))])
    (tmp_path / "v" / "a.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    (tmp_path / "secret.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    return tmp_path / "v"


MANIFESTS = {
    "up": {"values": "../secret.npy"},
    "deep up": {"values": "x/../../secret.npy"},
    "absolute": {"values": "/etc/hostname.npy"},
    "home": {"values": "~/secret.npy"},
    "nul": {"values": "a\0.npy"},
    "surrogate": {"values": "\ud800.npy"},
    "long": {"values": "x" * 5000 + ".npy"},
    "deep": {"values": "x/" * 3000 + "a.npy"},
    "a number": {"values": 5},
    "no kind": {"kind": []},
    "strange kind": {"kind": [3, 9]},
    "negative kind": {"kind": [-3, -1]},
    "isovalues a text": {"isovalues": "0.5"},
    "no id": {"id": None},
}


@pytest.mark.parametrize("name", sorted(MANIFESTS))
def test_a_manifest_that_leaves_its_folder_or_its_schema_is_refused(
    name: str, folder: Path
) -> None:
    """Issue 13: `..`, absolute paths."""
    manifest = json.loads((folder / "manifest.json").read_text())
    manifest["fields"][0] |= MANIFESTS[name]
    (folder / "manifest.json").write_text(json.dumps(manifest))
    with pytest.raises(AdapterError) as told:
        open_adapter(f"dir:{folder}").open(Limits())
    assert "\n" not in str(told.value)
    assert run("check", f"dir:{folder}").exit_code == 3


@pytest.mark.parametrize(
    "text", ["", "[" * 100_000, "{", "null", "[]", '{"format": 2}', '{"format": NaN}', "\ud800"]
)
def test_a_manifest_that_is_none_is_refused(text: str, folder: Path) -> None:
    """Deep nesting among them."""
    (folder / "manifest.json").write_bytes(text.encode("utf-8", "surrogatepass"))
    with pytest.raises(AdapterError):
        open_adapter(f"dir:{folder}").open(Limits())


def test_a_link_out_of_the_folder_is_not_followed(folder: Path) -> None:
    (folder / "a.off").unlink()
    (folder / "a.off").symlink_to(folder.parent / "secret.off")
    adapter = open_adapter(f"dir:{folder}")
    adapter.open(Limits())
    field = Field.of(np.arange(8.0).reshape(2, 2, 2))
    outcome = adapter.run(Request("a", "plain", field, (3.5,)))
    assert outcome.status is Status.GARBAGE
    assert "outside the folder" in outcome.detail


@settings(max_examples=80, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.binary(max_size=300), ending=st.sampled_from([".ply", ".obj", ".off", ".stl"]))
def test_bytes_are_a_mesh_or_refused(data: bytes, ending: str, tmp_path: Path) -> None:
    """Fuzz of the readers of mesh files: arrays or an `AnswerError`."""
    heads = {
        ".ply": b"ply\nformat ascii 1.0\n",
        ".off": b"OFF\n",
        ".stl": b"solid\n",
        ".obj": b"v ",
    }
    for text in (data, heads[ending] + data):
        path = tmp_path / f"x{ending}"
        path.write_bytes(text)
        try:
            vertices, rows = mesh_in(path, 10**6, SURFACES)
        except AnswerError:
            continue
        assert vertices.dtype.kind in "biuf"
        assert rows.dtype.kind in "biuf"


PLAIN = st.none() | st.booleans() | st.integers() | st.text(max_size=5)


@settings(max_examples=80, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    said=st.recursive(
        st.none()
        | st.booleans()
        | st.integers()
        | st.text(max_size=5)
        | st.floats(allow_nan=False),
        lambda inner: (
            st.lists(inner, max_size=4)
            | st.dictionaries(
                st.sampled_from(["vertices", "simplices", "faces", "polylines"]), inner
            )
        ),
        max_leaves=12,
    )
)
def test_json_is_an_answer_or_refused(said: object, tmp_path: Path) -> None:
    """Fuzz of the reader of answers in JSON."""
    path = tmp_path / "x.json"
    path.write_text(json.dumps(said))
    try:
        vertices, rows = json_in(path, 10**6, SURFACES)
    except AnswerError:
        return
    assert vertices.dtype.kind in "biuf"
    assert rows.dtype.kind in "biuf"


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.binary(max_size=200))
def test_bytes_are_an_array_or_refused(data: bytes, tmp_path: Path) -> None:
    """Fuzz of the reader of .npy files."""
    path = tmp_path / "x.npy"
    for text in (data, b"\x93NUMPY\x01\x00v\x00" + data):
        path.write_bytes(text)
        try:
            load(path, 10**6)
        except AnswerError as error:
            assert str(error)  # noqa: PT017 - what is said, where something is


# --- Contested verdicts --------------------------------------------------------------------------


def test_a_verdict_has_an_id_and_its_erratum_is_shown(
    sound: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Issue 13: each has an id, errata are listed."""
    report = reading.read(sound)
    name = report.verdict_id("topology.closed", "pairs/0217")
    assert name == f"{report.plan}.0.topology.closed.pairs/0217"
    assert name in page(report)
    assert "no erratum is known of it" in run("explain", name).output
    known = Erratum("E1", "2030-01-01", (report.plan,), "topology.*", "pairs/*", "it was right")
    monkeypatch.setattr(errata, "ERRATA", (known,))
    assert "Erratum E1 (2030-01-01): it was right" in page(report)
    assert "it was right" in run("explain", name).output
    other = report.verdict_id("topology.closed", "cells/outside/001")
    assert "it was right" not in run("explain", other).output


@pytest.mark.parametrize(
    ("change", "word"), [({"plan": 1}, "plan"), ({"seed": 3}, "seed"), ({"full": True}, "full")]
)
def test_reports_of_unlike_plans_are_not_compared(
    change: dict[str, Any], word: str, sound: Path, tmp_path: Path
) -> None:
    other = tmp_path / "other.jsonl"
    lines = changed("header", **change)(lines_of(sound))
    other.write_text("".join(json.dumps(one) + "\n" for one in lines))
    found = run("compare", sound, other)
    assert found.exit_code == 2
    assert "unlike plans" in found.output
    assert word in found.output
    assert "unlike plans" in run("diff", sound, other).output


# --- Foreign code ------------------------------------------------------------------------------


def test_foreign_code_is_announced_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Once on a machine; again where the cache cannot remember it; never for what came with it."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    foreign = ("check", f"exec:{sys.executable} -c pass")
    assert "It runs as you" not in run("check", "isoref:no-such").output
    assert run(*foreign).output.count("It runs as you") == 1
    assert "It runs as you" not in run(*foreign).output
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert run(*foreign).output.count("It runs as you") == 1
    assert run(*foreign).output.count("It runs as you") == 1
