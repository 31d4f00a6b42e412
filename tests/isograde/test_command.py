"""The command says what it did, and leaves with the right status."""

import itertools
import json
import subprocess
import sys
import time
from pathlib import Path

import isograde
import numpy as np
import psutil
import pytest
import trimesh
from isograde import command
from isograde.adapters import ready_made_names
from isograde.claims import CLAIMS
from isograde.command import app
from isograde.commands import grading, listings
from isograde.commands.console import Exit
from isograde.report import reading, record
from typer.testing import CliRunner, Result


def run(*arguments: str | Path) -> Result:
    """The result of the command with these arguments."""
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def flawed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of the original marching cubes on a few pairs, in a folder."""
    folder = tmp_path_factory.mktemp("flawed")
    result = run("grade", "isoref:lorensen-cline", "--only", "pairs/02*", "--out", folder)
    assert result.exit_code == 1, result.output
    return folder


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of the asymptotic decider on the same pairs, in a folder."""
    folder = tmp_path_factory.mktemp("sound")
    result = run("grade", "isoref:asymptotic-decider", "--only", "pairs/02*", "--out", folder)
    assert result.exit_code == 0, result.output
    return folder


def test_the_hole_of_1987_is_found_and_the_smallest_case_is_two_cells(flawed: Path) -> None:
    """Nielson & Hamann 1991, Figure 3: two cells that disagree on their common face."""
    failure = reading.read(flawed / "report.jsonl").summaries["topology.closed"].failure
    assert failure is not None
    assert failure.samples == 12
    assert failure.numbers["boundary_facets"] == 4


def test_every_format_is_written(flawed: Path) -> None:
    names = {path.name for path in flawed.iterdir()}
    expected = {".jsonl", ".html", ".md", ".junit.xml", ".svg", ".shields.json"}
    assert names == {"explorer.html", *(f"report{ending}" for ending in expected)}


def test_only_the_formats_asked_for_are_written(tmp_path: Path) -> None:
    only = ("--only", "pairs/0217", "--only", "topology.closed")
    options = (*only, "--out", tmp_path, "--format", "md")
    assert run("grade", "isoref:asymptotic-decider", *options).exit_code == 0
    assert {path.name for path in tmp_path.iterdir()} == {"report.jsonl", "report.md"}


def test_diff_names_what_broke_and_what_was_mended(flawed: Path, sound: Path) -> None:
    broke, mended = run("diff", sound, flawed), run("diff", flawed, sound)
    assert (broke.exit_code, mended.exit_code) == (1, 0)
    assert "topology.closed: pass → fail" in broke.output
    assert "4 broke: pairs/0217" in broke.output
    assert "4 mended: pairs/0217" in mended.output
    same = run("diff", sound, sound)
    assert same.exit_code == 0
    assert "no case" in same.output


def test_compare_lays_reports_side_by_side(flawed: Path, sound: Path, tmp_path: Path) -> None:
    shown = run("compare", flawed, sound)
    assert shown.exit_code == 0
    row = next(line for line in shown.output.splitlines() if line.startswith("topology.closed"))
    assert sorted(row.split()[1:]) == ["16", "4", "of", "pass"]
    assert "level first" in shown.output
    assert "topology first" in shown.output
    for name in ("table.md", "table.html"):
        assert run("compare", flawed, sound, "-o", tmp_path / name).exit_code == 0
        assert "isoref:lorensen-cline" in (tmp_path / name).read_text(encoding="utf-8")
    assert run("compare", flawed, "-o", tmp_path / "table.pdf").exit_code == 2


def test_compare_says_what_makes_reports_hard_to_compare(
    flawed: Path, sound: Path, tmp_path: Path
) -> None:
    """Issue 16: scans that one was not asked about, and a grade that was begun beside a report."""
    assert "graded without" not in run("compare", flawed, sound).output
    lines = (sound / "report.jsonl").read_text(encoding="utf-8").splitlines()
    scanned = []
    for line in map(json.loads, lines):
        if line["record"] == "case" and line["id"] == "pairs/0217":
            line["tags"] = [*line["tags"], "real"]
        scanned.append(json.dumps(line))
    (tmp_path / "report.jsonl").write_text("\n".join(scanned) + "\n", encoding="utf-8")
    (tmp_path / "unfinished-report.jsonl").touch()
    without = "was graded without 1 of the 1 scans"
    for name, more in (("table.md", []), ("table.html", []), ("choose.html", ["--choose"])):
        result = run("compare", flawed, tmp_path, *more, "-o", tmp_path / name)
        assert result.exit_code == 0
        for text in (result.output, (tmp_path / name).read_text(encoding="utf-8")):
            assert f"isoref:lorensen-cline {without}" in " ".join(text.split())
            assert "unfinished-report.jsonl, of one that did not end" in " ".join(text.split())


def test_a_report_that_was_cut_off_is_said_to_be(flawed: Path, tmp_path: Path) -> None:
    lines = (flawed / "report.jsonl").read_text(encoding="utf-8").splitlines()
    cut = tmp_path / "cut.jsonl"
    cut.write_text("\n".join(lines[:-1]) + "\n", encoding="utf-8")
    result = run("compare", cut)
    assert result.exit_code == 0
    assert "cut off" in result.output


def test_a_file_that_is_no_report_is_refused(tmp_path: Path) -> None:
    bad = tmp_path / "bad.jsonl"
    bad.write_text('{"record": "header"}\n', encoding="utf-8")
    result = run("compare", bad)
    assert result.exit_code == 2
    assert "bad.jsonl:1 is no header record" in result.output


@pytest.mark.parametrize(
    ("arguments", "status", "message"),
    [
        (("grade",), 2, "name one implementation, or --all"),
        (("grade", "isoref:lorensen-cline", "--all"), 2, "name one implementation, or --all"),
        (("grade", "skimage:levine"), 2, "did you mean skimage:lewiner"),
        (("grade", "python:absent_module:f"), 2, "absent_module"),
        (("grade", "python:isoref.methds:extract"), 2, "did you mean isoref.methods?"),
        (("grade", "python:isoref.methods:extrct"), 2, "did you mean extract?"),
        (("grade", "python:absent.py:extract"), 2, "no such file"),
        (("grade", "dir:absent"), 2, "does not exist"),
        (("grade", "exec:exit 3"), 3, "did not start"),
        (("check", "skimage:levine"), 2, "did you mean skimage:lewiner"),
        (("grade", "pyhton:mine:f"), 2, "did you mean python:mine:f?"),
        (("grade", "isoref:lorensen-cline", "--only", "topology.closd"), 2, "topology.closed?"),
        (("grade", "isoref:lorensen-cline", "--only", "absent"), 2, "nothing matches absent"),
        (("grade", "isoref:lorensen-cline", "--jobs", "0"), 2, "greater than or equal to 1"),
        (("explain", "topology.closd"), 2, "did you mean topology.closed"),
        (("list", "nonsense"), 2, "nonsense"),
        (("extract", "absent.npy", "--isovalue", "1"), 2, "absent.npy is not a file"),
        (("extract", "a.npy", "--isovalue", "1", "--method", "asymtotic"), 2, "did you mean"),
        (("extract", "a.npy", "--isovalue", "1", "-o", "a.xyz"), 2, "ends in none of"),
        (("extract", "a.npy"), 2, "--isovalue VALUE, or --label NUMBER"),
        (("extract", "a.npy", "--isovalue", "1", "--label", "1"), 2, "say which surface"),
        (("extract", "a.raw", "--isovalue", "1", "--shape", "4,4"), 2, "not three positive"),
        (("extract", "a.raw", "--isovalue", "1", "--type", "int7"), 2, "no type of real numbers"),
    ],
)
def test_wrong_use_is_told_with_its_status(
    arguments: tuple[str, ...],
    status: int,
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    result = run(*arguments)
    assert result.exit_code == status
    assert message in " ".join(result.output.split())
    assert not list(tmp_path.rglob("*.jsonl"))


@pytest.mark.parametrize("name", sorted(CLAIMS))
def test_every_claim_is_explained(name: str) -> None:
    result = run("explain", name)
    assert result.exit_code == 0
    told = "".join(result.output.split())
    claim = CLAIMS[name]
    assert "".join(claim.rule.split()) in told
    assert "".join(claim.source.split()) in told


@pytest.mark.parametrize(
    ("adapter", "words"),
    [
        ("python", "extract(values, isovalue, spacing)"),
        ("exec", "``id``"),
        ("dir", "manifest.json"),
        ("declaration", "not_promised"),
    ],
)
def test_the_ways_in_are_explained(adapter: str, words: str) -> None:
    assert words in run("explain", adapter).output


def test_lists_name_everything() -> None:
    claims, levels = run("list", "claims").output, run("list", "levels").output
    assert all(name in claims for name in CLAIMS)
    assert "trilinear" in levels
    implementations = run("list", "implementations").output
    assert all(name in implementations for name in ready_made_names())
    cases = run("list", "cases").output
    assert "pairs/* (4096 cases)" in cases
    assert "real/hydrogen_atom" in cases
    assert "surfaces" in cases


@pytest.mark.parametrize("name", sorted(CLAIMS))
def test_what_is_explained_says_of_which_kinds_and_families(name: str) -> None:
    told = " ".join(run("explain", name).output.split())
    assert "said of" in told
    assert "promised" in told


def test_a_module_that_does_not_import_did_not_start(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A fault inside the module is the implementation's, whatever it misses: status 3, not 2."""
    monkeypatch.chdir(tmp_path)
    Path("mine.py").write_text("import absent_module\n", encoding="utf-8")
    result = run("grade", "python:mine.py:extract")
    assert result.exit_code == 3
    assert "No module named 'absent_module'" in result.output


@pytest.mark.parametrize("begin", [["isograde"], ["-m", "isograde"], ["-m", "isograde.command"]])
def test_the_command_can_be_called_as_a_module_and_says_its_version(begin: list[str]) -> None:
    if begin == ["isograde"]:
        result = run("--version")
        assert result.exit_code == 0
        assert result.output == f"isograde {isograde.__version__}\n"
        return
    done = subprocess.run(
        [sys.executable, *begin, "--version"], capture_output=True, encoding="utf-8", check=True
    )
    assert done.stdout == f"isograde {isograde.__version__}\n"


def test_what_is_not_installed_is_said_to_be(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ready-made name whose library is absent is listed, and told."""
    monkeypatch.setattr(listings, "version_of", lambda name: None)
    monkeypatch.setattr(listings, "find_spec", lambda name: None if name == "mcubes" else object())
    rows = run("list", "implementations").output.splitlines()
    assert "not installed" in next(row for row in rows if row.startswith("pymcubes"))
    assert "source" in next(row for row in rows if row.startswith("isoref:trilinear-cubes"))


def test_a_bare_call_shows_the_help() -> None:
    result = run()
    assert "Usage" in result.output
    assert "grade" in result.output


@pytest.mark.parametrize("ending", ["ply", "obj", "off", "stl", "glb", "npz"])
def test_extract_writes_a_mesh_that_reads_back(ending: str, tmp_path: Path) -> None:
    x, y, z = np.ogrid[-1:1:12j, -1:1:12j, -1:1:12j]
    np.save(tmp_path / "ball.npy", 0.5 - (x * x + y * y + z * z))
    out = tmp_path / f"ball.{ending}"
    result = run("extract", tmp_path / "ball.npy", "--isovalue", "0", "-o", out)
    assert result.exit_code == 0, result.output
    if ending == "npz":
        with np.load(out) as arrays:
            mesh = trimesh.Trimesh(arrays["vertices"], arrays["faces"])
    else:
        mesh = trimesh.load_mesh(out)
    assert mesh.is_watertight
    assert mesh.volume > 0
    assert {path.name for path in tmp_path.iterdir()} == {"ball.npy", out.name}


def extracted(tmp_path: Path, *arguments: str | Path) -> tuple[str, dict[str, trimesh.Trimesh]]:
    """What `isograde extract` says of a labelled, oblique scan with a hole, and its meshes."""
    nibabel = pytest.importorskip("nibabel")
    values = np.zeros((9, 10, 11), np.float32)
    values[1:4, 2:8, 2:8], values[4:8, 2:8, 2:11] = 3, 7
    affine = np.array([[0, -2.0, 0, 5], [0.6, 0, 0.8, 6], [-0.8, 0, 0.6, 7], [0, 0, 0, 1]])
    nibabel.save(nibabel.Nifti1Image(values, affine), tmp_path / "whole.nii.gz")
    values[0, 0, 0] = np.nan
    nibabel.save(nibabel.Nifti1Image(values, affine), tmp_path / "holed.nii.gz")
    result = run("extract", *arguments, "-o", tmp_path / "out.npz")
    assert result.exit_code == 0, result.output
    meshes = {}
    for path in sorted(tmp_path.glob("out*.npz")):
        with np.load(path) as arrays:
            meshes[path.stem] = trimesh.Trimesh(arrays["vertices"], arrays["faces"], process=False)
    return result.output, meshes


def test_extract_makes_one_file_for_each_label(tmp_path: Path) -> None:
    """The third label stands where its voxels stand, half a voxel larger, outside outwards."""
    told, meshes = extracted(tmp_path, tmp_path / "whole.nii.gz", "--label", "3", "--label", "7")
    assert "in RAS coordinates" in told
    assert list(meshes) == ["out-3", "out-7"]
    third = meshes["out-3"]
    assert third.is_watertight
    assert third.volume > 0
    # x = 5 - 2 j, and j runs from 1.5 to 7.5.
    assert np.allclose([third.vertices[:, 0].min(), third.vertices[:, 0].max()], [-10, 2])
    refused = run("extract", tmp_path / "whole.nii.gz", "--label", "4")
    assert refused.exit_code == 2
    assert "no sample has the label 4; there are 0, 3, 7" in refused.output


def test_extract_caps_what_runs_out_of_the_volume(tmp_path: Path) -> None:
    """The seventh label reaches the last samples, where the cap closes it; LPS mirrors x and y."""
    scan = tmp_path / "whole.nii.gz"
    _, plain = extracted(tmp_path, scan, "--label", "7")
    _, ras = extracted(tmp_path, scan, "--label", "7", "--cap")
    told, lps = extracted(tmp_path, scan, "--label", "7", "--cap", "--space", "LPS")
    assert "in LPS coordinates" in told
    assert not plain["out"].is_watertight
    assert ras["out"].is_watertight
    assert np.allclose(lps["out"].vertices, ras["out"].vertices * [-1, -1, 1])
    assert lps["out"].volume == pytest.approx(ras["out"].volume)


def test_extract_leaves_out_absent_samples_when_asked(tmp_path: Path) -> None:
    """Without the word, a sample that is no number is an error that names the word."""
    told, meshes = extracted(
        tmp_path, tmp_path / "holed.nii.gz", "--isovalue", "3", "--absent", "--clean"
    )
    assert "1 samples of 990 are absent" in told
    assert "triangles without area" in told
    assert len(meshes["out"].faces) > 100
    assert not meshes["out"].is_watertight
    _, closed = extracted(
        tmp_path, tmp_path / "holed.nii.gz", "--isovalue", "3", "--absent", "--cap"
    )
    assert closed["out"].is_watertight
    refused = run("extract", tmp_path / "holed.nii.gz", "--isovalue", "3")
    assert refused.exit_code == 2
    assert "sample (0, 0, 0) is nan" in refused.output
    assert "--absent leaves them out" in refused.output


def test_extract_says_why_there_is_no_surface(tmp_path: Path) -> None:
    """With the range of the samples."""
    told, _ = extracted(tmp_path, tmp_path / "whole.nii.gz", "--isovalue", "30")
    assert "no surface at 30: samples lie between 0 and 7" in told


def test_the_command_runs_as_a_process_without_a_terminal(tmp_path: Path) -> None:
    """No bar and no escape codes where nobody watches."""
    command = [sys.executable, "-m", "isograde.command", "grade", "isoref:asymptotic-decider"]
    done = subprocess.run(
        [*command, "--only", "pairs/02*", "--out", str(tmp_path)],
        capture_output=True,
        encoding="utf-8",
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert "\x1b" not in done.stdout
    assert "report.html" in done.stdout
    last = (tmp_path / "report.jsonl").read_text(encoding="utf-8").splitlines()[-1]
    assert json.loads(last)["cases"] == 16


@pytest.mark.slow
def test_no_process_outlives_a_run_that_is_killed(tmp_path: Path) -> None:
    """Killed in the middle, it leaves its lines without a footer, and no children."""
    command = [sys.executable, "-m", "isograde.command", "grade", "isoref:asymptotic-decider"]
    options = ["--only", "pairs/*", "--full", "--jobs", "2", "--out", str(tmp_path)]
    running = psutil.Popen([*command, *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    with running:
        lines = tmp_path / "unfinished-report.jsonl"
        deadline = time.monotonic() + 90
        while not (lines.exists() and '"result"' in lines.read_text(encoding="utf-8")):
            assert time.monotonic() < deadline, "nothing was judged"
            time.sleep(0.1)
        family = running.children(recursive=True)
        running.kill()
        running.wait()
    assert len(family) >= 4
    _, alive = psutil.wait_procs(family, timeout=20)
    assert not alive
    assert reading.read(lines).footer is None


def test_all_leaves_out_what_does_not_start_and_compares_the_rest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A library that cannot load is named, and never stops the rest; nor does another kind."""
    specs = ["isoref:asymptotic-decider", "absent", "isoref:lorensen-cline", "isoref:diconex-mixed"]
    monkeypatch.setattr(grading, "ready_made_names", lambda: specs)
    result = run("grade", "--all", "--only", "pairs/02*", "--out", tmp_path, "--format", "html")
    assert result.exit_code == 1, result.output
    names = {path.name for path in tmp_path.iterdir()}
    stems = ("isoref-asymptotic-decider", "isoref-lorensen-cline")
    assert names == {"comparison.html", "comparison.md", "explorer.html"} | {
        f"{stem}{ending}" for stem in stems for ending in (".html", ".jsonl.gz")
    }
    text = (tmp_path / "comparison.html").read_text(encoding="utf-8")
    assert "no implementation &#39;absent&#39;" in text
    assert 'href="isoref-lorensen-cline.html#failure-topology.closed"' in text
    nothing = run("grade", "--all", "--only", "absent/*", "--out", tmp_path / "none")
    assert nothing.exit_code == 2


def test_a_fault_of_the_command_is_not_taken_for_a_claim_that_fails(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def breaks() -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(command, "app", breaks)
    with pytest.raises(SystemExit) as left:
        command.main()
    assert left.value.code == 70


def test_check_tells_what_a_adapter_does_and_why_another_does_not_open() -> None:
    good, bad = run("check", "isoref:asymptotic-decider"), run("check", "absent")
    assert good.exit_code == 0
    assert "promises level" in good.output
    assert "The declaration to paste" in good.output
    assert '"level": 3' in good.output
    assert bad.exit_code == 2
    assert "no implementation 'absent'" in bad.output


def test_exported_fields_are_graded_from_the_folder(tmp_path: Path) -> None:
    """Without meshes nothing is supported, and nothing passes."""
    folder = tmp_path / "vectors"
    result = run("export", folder, "--only", "pairs/02*", "--variants")
    assert result.exit_code == 0, result.output
    assert "16 fields" in result.output
    again = run("export", folder, "--only", "pairs/02*")
    assert again.exit_code == 2
    assert "not empty" in again.output
    assert run("export", tmp_path / "none", "--only", "absent").exit_code == 4
    assert not (tmp_path / "none").exists()


def test_frequencies_are_a_table(tmp_path: Path) -> None:
    np.save(tmp_path / "one.npy", np.array([[[1, 0], [0, 0]], [[0, 0], [0, 1.0]]]))
    result = run("frequencies", tmp_path / "one.npy", "--isovalue", "0.5")
    assert result.exit_code == 0
    assert "| 4 | 1 |" in result.output
    assert run("frequencies", tmp_path / "two.npy", "--isovalue", "0.5").exit_code == 2


def test_a_rule_is_proved_or_the_pairs_that_tear_are_named() -> None:
    """Nielson & Hamann 1991, Figure 3: the rule of 1987 tears, its repair does not."""
    good, bad = run("prove", "asymptotic-decider"), run("prove", "lorensen-cline")
    assert (good.exit_code, bad.exit_code) == (0, 1)
    assert "oriented with the inside behind it, and manifold, all by index" in good.output
    assert "tear" in bad.output
    assert run("prove", "asymptotic").exit_code == 2


@pytest.mark.parametrize("place", ["file", "file/below"])
def test_a_folder_that_cannot_be_written_is_named(place: str, flawed: Path, tmp_path: Path) -> None:
    """No traceback, and no report."""
    (tmp_path / "file").write_text("in the way")
    options = ("--only", "pairs/0217", "--only", "topology.closed", "--out", tmp_path / place)
    result = run("grade", "isoref:asymptotic-decider", *options)
    assert result.exit_code == 2
    assert "cannot be written" in result.output
    assert "name another folder with --out" in result.output
    result = run("compare", flawed, "-o", tmp_path / place / "table.md")
    assert result.exit_code == 2
    assert "cannot be written" in result.output


def test_a_run_that_is_stopped_leaves_the_last_report_as_it_was(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Ctrl-C in the middle: what was found stands beside, under a name that says so."""
    asked = ("grade", "isoref:asymptotic-decider", "--only", "pairs/02*", "--out", tmp_path)
    assert run(*asked, "--format", "md").exit_code == 0
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    done = itertools.count()

    def stopped(tally: record.Tally, judged: object) -> None:
        if next(done) == 3:
            raise KeyboardInterrupt

    monkeypatch.setattr(record.Tally, "add", stopped)
    result = run(*asked, "--format", "md")
    assert result.exit_code == 130
    assert "unfinished-report.jsonl" in result.output
    after = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    for name in ("unfinished-report.jsonl", "interrupted-report.jsonl"):
        assert after.pop(name).count(b'"record":"result"') == 4
    assert b"stopped before the end (interrupted)" in after.pop("interrupted-report.md")
    assert after == before


STRANGE = """
import numpy as np
from isoref import extract as reference


def nothing(values, isovalue, spacing):
    return np.empty((0, 3)), np.empty((0, 3), int)


def declines(values, isovalue, spacing):
    raise NotImplementedError("not today")


def one_triangle(values, isovalue, spacing):
    return np.eye(3), np.array([[0, 1, 2]])


def right(values, isovalue, spacing):
    mesh = reference(values, isovalue, spacing)
    return mesh.vertices, mesh.simplices


def careless(values, isovalue, spacing):
    return right(np.nan_to_num(values), isovalue, spacing)


def all_but_types(values, isovalue, spacing):
    if values.dtype != np.float64:
        raise TypeError("no")
    return right(values, isovalue, spacing)


all_but_types.declaration = {"not_promised": ["*"]}
"""


@pytest.fixture(scope="module")
def strange(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Implementations that make nothing of what they are asked, and right ones."""
    place = tmp_path_factory.mktemp("strange") / "strange.py"
    place.write_text(STRANGE, encoding="utf-8")
    return place


@pytest.mark.parametrize(
    ("name", "only", "options", "status"),
    [
        ("nothing", ("noise/white-5*",), (), Exit.FAILS),
        ("declines", ("noise/white-5*",), (), Exit.NO_EVIDENCE),
        ("declines", ("noise/white-5*",), ("--strict",), Exit.FAILS),
        ("one_triangle", ("noise/white-5*",), (), Exit.FAILS),
        ("right", ("noise/white-5*", "topology.closed"), (), Exit.HOLDS),
        ("right", ("noise/white-5*", "topology.closed"), ("--strict",), Exit.HOLDS),
        ("right", ("noise/white-5*", "topology.ties"), (), Exit.NO_EVIDENCE),
        ("right", ("noise/white-5*", "topology.ties"), ("--strict",), Exit.FAILS),
        ("careless", ("noise/white-5*", "robustness.nan", "topology.closed"), (), Exit.HOLDS),
        ("careless", ("noise/white-5*", "robustness.nan"), (), Exit.NO_EVIDENCE),
        ("all_but_types", ("noise/white-5*", "topology.closed"), (), Exit.NO_EVIDENCE),
    ],
)
def test_the_status_says_what_was_proven(
    name: str,
    only: tuple[str, ...],
    options: tuple[str, ...],
    status: Exit,
    strange: Path,
    tmp_path: Path,
) -> None:
    """Design: 1 a promise is broken, 4 nothing promised could have failed, else 0."""
    asked = [word for glob in only for word in ("--only", glob)]
    result = run("grade", f"python:{strange}:{name}", *asked, *options, "--out", tmp_path)
    assert result.exit_code == status, result.output


@pytest.mark.parametrize(
    ("found", "status"),
    [
        ([], Exit.HOLDS),
        ([Exit.HOLDS, Exit.NO_EVIDENCE], Exit.NO_EVIDENCE),
        ([Exit.NO_EVIDENCE, Exit.FAILS, Exit.HOLDS], Exit.FAILS),
    ],
)
def test_of_many_the_worst_status_is_told(found: list[Exit], status: Exit) -> None:
    assert grading.worst(found) is status


@pytest.mark.parametrize(
    ("kind", "message"), [("surface", "there are contours"), ("1,2", "no kind '1,2'")]
)
def test_a_kind_that_is_none_is_refused(kind: str, message: str, tmp_path: Path) -> None:
    result = run("export", tmp_path / "x", "--kind", kind)
    assert result.exit_code == 2
    assert message in " ".join(result.output.split())


def test_the_terminal_says_the_headline_and_what_is_right(tmp_path: Path) -> None:
    asked = ("--only", "pairs/02*", "--out", tmp_path, "--format", "md")
    told = run("grade", "isoref:lorensen-cline", *asked).output
    assert "part of the cases" in told
    assert "of its promises are broken" in told
    assert "Right on every case tried: the arrays are well formed" in told
    said = " ".join(told.split())
    assert "topology.closed: the cells [0, 0, 0] and [1, 0, 0] disagree on the face" in said
    assert "(4 fields; so fails topology.manifold); smallest given/3x2x2/" in said
    assert ", 12 samples" in said


def test_explain_tells_what_there_is_and_what_a_family_of_cases_is_for() -> None:
    """A new user asked for `pairs`, which the README names, and was told of `dir`."""
    every = run("explain")
    assert every.exit_code == 0
    assert "protocol" in every.output
    assert "nielson-hamann" in every.output
    pairs = run("explain", "pairs/*")
    assert "512 cases, 4,096 with --full" in pairs.output
    assert "Two cells side by side" in pairs.output
    both = run("explain", "bodies")
    assert "bodies.pieces" in both.output
    assert "bodies/*: " in both.output
    nothing = run("explain", "xyzzy")
    assert nothing.exit_code == 2
    assert "nothing is called 'xyzzy'; `isograde explain` says what is" in nothing.output
