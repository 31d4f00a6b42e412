"""A document to file: made from its report alone, complete, and checked later."""

import json
import shutil
import subprocess
from collections.abc import Callable
from importlib import metadata
from pathlib import Path

import pytest
from isograde import dossier
from isograde.cataloguing import asked_by
from isograde.claims import CLAIMS
from isograde.command import app
from isograde.expectations import Expected
from isograde.report.reading import Report
from typer.testing import CliRunner

from tests.isograde.reporting import body, made, row

PARTS = ("html", "report.jsonl.gz", "facts.json", "lock.txt", "sha256")


def graded() -> Report:
    """The report of a made-up run with a failure, fields drawn at random, and a known failure."""
    rows = [body()]
    rows += [row(f"noise/{i}", symmetry__type="skip") for i in range(30)]
    rows += [row("cells/1", topology__manifold=("fail", {})), row("ties/1", general=False)]
    return made(rows, expected={"topology.sides": Expected("a <b>reason</b>")})


@pytest.fixture
def filed(tmp_path: Path) -> Path:
    """A dossier as HTML."""
    dossier.make(graded(), tmp_path / "mine.html")
    return tmp_path / "mine.html"


def test_every_part_is_there_and_is_right(filed: Path) -> None:
    assert {path.name for path in filed.parent.iterdir()} == {f"mine.{one}" for one in PARTS}
    found = dossier.verify(filed)
    assert len(found) == len(PARTS)
    assert all(good for good, _ in found), found
    assert dossier.verify(filed.with_name("mine.sha256")) == found
    if shutil.which("sha256sum"):
        command = ["sha256sum", "-c", "--strict", "mine.sha256"]
        subprocess.run(command, cwd=filed.parent, check=True, capture_output=True)


def test_the_document_says_what_a_reader_asks(filed: Path) -> None:
    text = filed.read_text(encoding="utf-8")
    for asked in (
        "Approval", "Intended use and limits", "isograde grade python:mine:f --timeout 30",
        "checksum of the cases", "What this lets one say", "Real volumes", "The environment",
        "topology.manifold", "cells/1", "The oracles, and how they were verified",
    ):  # fmt: skip
        assert asked in text, asked
    assert "a &lt;b&gt;reason" in text
    assert dossier.lock()[0] in text


def change(name: str, old: str, new: str) -> Callable[[Path], None]:
    """A change of a part that leaves the manifest as it is."""

    def make(document: Path) -> None:
        path = document.with_name(f"mine.{name}")
        text = path.read_text(encoding="utf-8")
        assert old in text
        path.write_text(text.replace(old, new, 1), encoding="utf-8")

    return make


@pytest.mark.parametrize(
    ("attack", "said"),
    [
        (change("html", "Approval", "approval"), "mine.html was changed"),
        (change("lock.txt", "==", "=="[::-1] + " "), "mine.lock.txt was changed"),
        (lambda document: document.with_name("mine.facts.json").unlink(), "is missing"),
        (change("sha256", "  mine.html\n", "  other.html\n"), "does not list mine.html"),
        (lambda document: document.with_name("mine.pdf").write_text("%PDF"), "stands beside it"),
    ],
)
def test_what_was_changed_afterwards_is_told(
    attack: Callable[[Path], None], said: str, filed: Path
) -> None:
    attack(filed)
    found = dossier.verify(filed)
    assert any(not good and said in told for good, told in found), found


def test_a_document_that_its_report_does_not_make_is_told(filed: Path) -> None:
    """Attack: somebody edits the page and writes the checksums anew."""
    change("html", "fails on 1 of", "fails on 0 of")(filed)
    manifest = filed.with_name("mine.sha256")
    lines = [line.split("  ")[1] for line in manifest.read_text(encoding="utf-8").splitlines()]
    text = "".join(f"{dossier.checksum(filed.with_name(name))}  {name}\n" for name in lines)
    manifest.write_text(text, encoding="utf-8")
    found = dossier.verify(filed)
    assert (False, "the document is not the one that its report makes") in found


def test_another_version_of_the_grader_does_not_make_it_again(filed: Path) -> None:
    facts = filed.with_name("mine.facts.json")
    known = json.loads(facts.read_text(encoding="utf-8")) | {"code": "0"}
    facts.write_text(json.dumps(known), encoding="utf-8")
    manifest = filed.with_name("mine.sha256")
    lines = manifest.read_text(encoding="utf-8").splitlines()
    kept = [line for line in lines if not line.endswith("facts.json")]
    kept.append(f"{dossier.checksum(facts)}  mine.facts.json")
    manifest.write_text("\n".join(kept) + "\n", encoding="utf-8")
    found = dossier.verify(filed)
    assert all(good for good, _ in found)
    assert "another version of the grader" in found[-1][1]


def test_who_graded_and_where_is_not_mistaken_for_who_made_the_document(tmp_path: Path) -> None:
    """Attack: a report of another version and environment is made into a document here."""
    report = graded()
    here = {"python": dossier.facts()["python"], "isograde": "0.0.9", "commit": "abc"}
    report.header["versions"] = here | {"numpy": "1.0"}
    dossier.make(report, tmp_path / "old.html")
    text = (tmp_path / "old.html").read_text(encoding="utf-8")
    assert "<th>graded by</th><td>isograde 0.0.9, commit abc, plan" in text
    assert "graded elsewhere or earlier, with isograde 0.0.9, numpy 1.0." in text
    report.header["versions"] = {"python": here["python"]}
    dossier.make(report, tmp_path / "new.html")
    assert "graded elsewhere" not in (tmp_path / "new.html").read_text(encoding="utf-8")


def test_a_ready_made_library_is_named_by_the_checksum_of_its_files(tmp_path: Path) -> None:
    """Where the version that is installed is the one that was graded, and nowhere else."""
    pytest.importorskip("skimage")
    report = graded()
    assert dossier.recorded(report) == {}
    report.header["spec"] = "skimage:lewiner"
    report.header["declaration"]["version"] = "0.0.1"
    assert dossier.recorded(report) == {}
    report.header["declaration"]["version"] = metadata.version("scikit-image")
    dossier.make(report, tmp_path / "mine.html")
    text = (tmp_path / "mine.html").read_text(encoding="utf-8")
    assert dossier.recorded(report)["record"] in text
    assert all(good for good, _ in dossier.verify(tmp_path / "mine.html"))


@pytest.mark.skipif(shutil.which("gpg") is None, reason="gpg is not here")
def test_a_signature_is_made_and_checked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    home = tmp_path / "home"
    home.mkdir(mode=0o700)
    monkeypatch.setenv("GNUPGHOME", str(home))
    new = ["gpg", "--batch", "--passphrase", "", "--quick-gen-key", "Tester <t@example.org>"]
    subprocess.run([*new, "default", "default", "never"], check=True, capture_output=True)
    document = tmp_path / "mine.html"
    dossier.make(graded(), document, key="t@example.org")
    assert (True, "the signature is good: Tester <t@example.org>") in dossier.verify(document)
    change("sha256", "a", "b")(document)
    found = dossier.verify(document)
    assert any(not good and "signature" in told for good, told in found)
    with pytest.raises(dossier.DossierError, match="gpg did not sign"):
        dossier.make(graded(), document, key="nobody@example.org")


def test_a_rate_is_claimed_of_fields_drawn_at_random_alone() -> None:
    found = {one.family: one for one in dossier.populations(graded())}
    assert found["noise"].drawn
    assert not found["cells"].drawn
    assert (found["noise"].judged, found["noise"].failed) == (30, 0)
    assert 0.9 * 3 / 30 < found["noise"].bound < 3 / 30
    assert found["cells"].failed == 1


def test_the_families_that_are_said_to_be_drawn_change_with_the_seed() -> None:
    """What is drawn at random is other numbers under another seed; what is enumerated is not."""
    import numpy as np
    from isograde.cases import all_cases

    first, second = all_cases(0), all_cases(1)
    for family in (*dossier.DRAWN, "analytic"):
        names = [name for name in first if name.startswith(f"{family}/")][:4]
        assert names, family
        same = [
            np.array_equal(first[name].build().values, second[name].build().values)
            for name in names
        ]
        assert all(same) if family not in dossier.DRAWN else not all(same), family


def test_the_oracles_of_a_claim_are_found_in_its_code() -> None:
    assert "isograde.oracles.degree" in asked_by(CLAIMS["topology.sides"])
    assert not asked_by(CLAIMS["structure.finite"])
    assert "degree" in dossier.judged_by("topology.sides")


def test_the_command_makes_and_checks(filed: Path, tmp_path: Path) -> None:
    runner = CliRunner()
    report = str(filed.with_name("mine.report.jsonl.gz"))
    out = tmp_path / "again.html"
    done = runner.invoke(app, ["dossier", report, "-o", str(out)])
    assert done.exit_code == 1, done.output
    assert "again.sha256" in done.output
    good = runner.invoke(app, ["dossier", "--verify", str(out)])
    assert good.exit_code == 0, good.output
    out.write_text("", encoding="utf-8")
    bad = runner.invoke(app, ["dossier", "--verify", str(out)])
    assert bad.exit_code == 1
    for wrong, message in (
        ([], "name an implementation"),
        ([report, "-o", "a.doc"], "neither .pdf nor .html"),
        (["--verify", str(tmp_path / "absent.pdf")], "there is no"),
        (["skimage:levine", "-o", str(out)], "did you mean skimage:lewiner"),
    ):
        told = runner.invoke(app, ["dossier", *wrong])
        assert told.exit_code == 2
        assert message in " ".join(told.output.split())


@pytest.mark.slow
def test_the_pdf_has_numbered_pages_with_the_same_words(tmp_path: Path) -> None:
    pytest.importorskip("weasyprint", exc_type=(ImportError, OSError))  # type: ignore[arg-type]
    pdfium = pytest.importorskip("pypdfium2")
    dossier.make(graded(), tmp_path / "mine.pdf")
    found = dossier.verify(tmp_path / "mine.pdf")
    assert all(good for good, _ in found)
    assert found[-1][1] == "mine.pdf is the one that the document makes"
    pages = pdfium.PdfDocument(tmp_path / "mine.pdf")
    assert pages.get_metadata_dict()["Title"] == "Dossier of mine"
    texts = [page.get_textpage().get_text_bounded() for page in pages]
    assert len(texts) > 3
    for index, text in enumerate(texts, 1):
        assert f"page {index} of {len(texts)}" in text
    assert "Approval" in texts[0]
    assert "topology.manifold" in "".join(texts)
