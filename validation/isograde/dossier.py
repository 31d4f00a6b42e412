"""A document to file: what was graded, how, with what result, and what that lets one say.

A dossier is a folder's worth of files beside each other, all of one stem::

    dossier.pdf              the document, dated and paginated (where a .pdf is asked for)
    dossier.html             the same, as one page
    dossier.report.jsonl.gz  every finding it rests on
    dossier.facts.json       what is known of grader, environment and implementation besides
    dossier.lock.txt         the environment, as ``pip install -r`` takes it
    dossier.sha256           the checksum of each, as ``sha256sum -c`` takes it
    dossier.sha256.asc       a detached signature of the checksums, where a key was named

The document is made from the report and the facts alone, so that `verify` can make it again and
compare. Its PDF is made by WeasyPrint: it sets the very page that is shown as HTML, with page
numbers, a running head and bookmarks, and is kept well; ReportLab would need the document written a
second time, and a browser is too large to ask for.
"""

from __future__ import annotations

import hashlib
import json
import platform
import shutil
import subprocess
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from pathlib import Path

from scipy.stats import beta

from isograde import catalogue
from isograde.adapters.registry import READY_MADE
from isograde.model import BAD, EVIDENCE
from isograde.report import words
from isograde.report.headline import TRILINEAR, headline, wrong_cells
from isograde.report.lines import JSON, ReportError, write_lines
from isograde.report.page import done_for, environment
from isograde.report.reading import Report, findings_of, read, results_tagged

# Families whose fields are drawn at random, from a seed; a rate can be said of these alone.
DRAWN = ("noise", "trilinear")
CONFIDENCE = 0.95
# What a document is made from: code, templates, and what is known of claims and oracles.
MAKING = {".py", ".html", ".css", ".js", ".json"}
# Name so many failed cases of a claim.
NAMED = 12


class DossierError(RuntimeError):
    """A dossier cannot be made; the message says what is missing."""


@dataclass(frozen=True)
class Places:
    """Where the files of a dossier stand."""

    document: Path

    def of(self, ending: str) -> Path:
        """The file with this ending."""
        return self.document.with_name(f"{self.document.stem}.{ending}")

    @property
    def manifest(self) -> Path:
        """The file of checksums."""
        return self.of("sha256")

    @property
    def signature(self) -> Path:
        """The detached signature of the checksums."""
        return self.of("sha256.asc")


def facts() -> JSON:
    """What is known of the grader and its environment here and now, fit for a file."""
    package = Path(__file__).parent
    return {
        "isograde": _version("isograde"),
        "commit": _commit(package),
        "code": code_checksum(package),
        "python": platform.python_version(),
        "lock": lock(),
    }


def recorded(report: Report) -> JSON:
    """The checksum of the list of a ready-made library's files, where it is the one graded."""
    ready = READY_MADE.get(report.spec)
    if ready is None:
        return {}
    try:
        found = metadata.distribution(ready.distribution)
    except metadata.PackageNotFoundError:
        return {}
    record, top = found.read_text("RECORD") or "", ready.imports[0].partition(".")[0]
    # A checkout that is installed as it stands lists none of its code.
    code = [line for line in record.splitlines() if line.startswith(top)]
    whole = any(".dist-info/" not in line for line in code)
    if not whole or found.version != report.declaration.get("version"):
        return {}
    digest = hashlib.sha256(record.encode()).hexdigest()
    return {"distribution": f"{ready.distribution} {found.version}", "record": digest}


def _version(name: str) -> str:
    """The installed version of a distribution, or "source"."""
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "source"


def _commit(package: Path) -> str:
    """The commit of a checkout, and whether files were changed since; nothing elsewhere."""
    ask = [
        "git",
        "-C",
        str(package),
        "describe",
        "--always",
        "--abbrev=40",
        "--dirty",
        "--exclude=*",
    ]
    try:
        done = subprocess.run(ask, capture_output=True, encoding="utf-8", check=True, timeout=30)
    except (OSError, subprocess.SubprocessError):
        return ""
    return done.stdout.strip()


@cache
def code_checksum(package: Path) -> str:
    """A checksum of every file of the grader from which a document is made."""
    digest = hashlib.sha256()
    for path in sorted(one for one in package.rglob("*") if one.suffix in MAKING):
        digest.update(path.relative_to(package).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def lock() -> list[str]:
    """The installed distributions with their versions, as ``pip install -r`` takes them."""
    found = {
        f"{one.metadata['Name']}=={one.version}"
        for one in metadata.distributions()
        if one.metadata["Name"]
    }
    return sorted(found, key=str.lower)


@dataclass(frozen=True)
class Population:
    """The fields of one family: how many were judged, how many failed, and the rate's bound."""

    family: str
    judged: int
    failed: int
    drawn: bool

    @property
    def bound(self) -> float:
        """The exact upper bound of the rate; without a failure, close to 3 of the judged.

        >>> round(Population("noise", 1000, 0, True).bound, 5)
        0.00299
        """
        if self.failed == self.judged:
            return 1.0
        return float(beta.ppf(CONFIDENCE, self.failed + 1, self.judged - self.failed))


def populations(report: Report) -> list[Population]:
    """Each family of cases, with the promised claims of the ladder that failed on them."""
    held = {one.id for one in report.promised if one.level is not None}
    judged, failed = Counter[str](), Counter[str]()
    for result in report.results:
        verdicts = {verdict for name, verdict, _ in findings_of(result) if name in held}
        family = result["case"].split("/")[0]
        judged[family] += bool(verdicts & set(EVIDENCE))
        failed[family] += bool(verdicts & set(BAD))
    return [
        Population(name, count, failed[name], name in DRAWN)
        for name, count in sorted(judged.items())
        if count
    ]


@dataclass(frozen=True)
class Scan:
    """A block of a real volume: how many of its active cells have the wrong topology."""

    case: str
    cells: int
    wrong: int

    @property
    def in_a_million(self) -> float:
        """Wrong cells in a million."""
        return 1e6 * self.wrong / self.cells


def scans(report: Report) -> list[Scan]:
    """The blocks of real volumes whose cells were counted."""
    return [
        Scan(result["case"], numbers["cells"], numbers.get("wrong", 0))
        for result in results_tagged(report, "real")
        if (numbers := result["measured"].get(TRILINEAR)) and numbers.get("cells")
    ]


def judged_by(claim: str) -> list[str]:
    """The oracles that a claim's judge asks, by the last part of their modules' names."""
    asked: list[str] = dict(catalogue.read()["judged_by"]).get(claim, [])
    return [name.rpartition(".")[2] for name in asked]


def oracles(report: Report) -> list[tuple[str, str, list[list[str]]]]:
    """Each oracle that some claim of the report asks: what it says of itself, and its tests."""
    asked = {name for claim in report.claims for name in judged_by(claim)}
    every = catalogue.read()["oracles"]
    rows = [(name.rpartition(".")[2], said, tests) for name, said, tests in every]
    return [row for row in rows if row[0] in asked]


def document(report: Report, known: JSON) -> str:
    """The document as HTML; the same for the same report and facts."""
    template = environment().get_template("dossier.html")
    return template.render(
        report=report,
        facts=known,
        headline=headline(report),
        grader=grader(report),
        elsewhere=elsewhere(report, known),
        verdict=words.verdict(report),
        declared=words.declared(report),
        does=done_for(report.spec),
        command=command(report),
        families=Counter(name.split("/")[0] for name in report.cases),
        populations=populations(report),
        scans=scans(report),
        wrong_in_a_million=wrong_cells(report),
        tiles=catalogue.read()["tiles"],
        mutation=catalogue.read()["mutation"],
        oracles=oracles(report),
        judged_by=judged_by,
        failed_cases=lambda name: report.bad_cases.get(name, []),
        named=NAMED,
        number=number(report, known),
    )


def grader(report: Report) -> str:
    """The version of isograde, and its commit where it was a checkout, that graded."""
    versions = report.header["versions"]
    commit = f", commit {versions['commit']}" if versions.get("commit") else ""
    return f"isograde {versions.get('isograde', 'source')}{commit}"


def elsewhere(report: Report, known: JSON) -> list[str]:
    """What the run had in another version than the environment in which the document is made."""
    here = dict(line.lower().split("==", 1) for line in known["lock"])
    here |= {"python": known["python"]}
    versions = {name: one for name, one in report.header["versions"].items() if name != "commit"}
    return [f"{name} {one}" for name, one in versions.items() if here.get(name.lower()) != one]


def number(report: Report, known: JSON) -> str:
    """A short number of the document, from all that it rests on."""
    text = json.dumps([*report.records, known], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def command(report: Report) -> str:
    """The command that repeats the run."""
    header = report.header
    parts = [f"isograde grade {report.spec}"]
    parts += ["--full"] if header["full"] else []
    parts += [f"--seed {header['seed']}"] if header["seed"] else []
    parts += [f"--only {name}" for name in header["only"]]
    limits = header["limits"]
    parts += [f"--timeout {limits['seconds']:g}", f"--memory {limits['megabytes']}"]
    return " ".join(parts)


def make(report: Report, path: Path, key: str | None = None) -> list[Path]:
    """Write a dossier, its document at `path` (.pdf or .html); every file of it.

    Raises
    ------
    DossierError
        where WeasyPrint or a key is missing, or where the report was cut off.
    """
    if report.footer is None:
        raise DossierError("the report was cut off: it has no footer")
    places, known = Places(path), {**facts(), **recorded(report)}
    path.parent.mkdir(parents=True, exist_ok=True)
    html = document(report, known)
    write_lines(report.records, places.of("report.jsonl.gz"))
    places.of("facts.json").write_text(json.dumps(known, indent=1) + "\n", encoding="utf-8")
    places.of("lock.txt").write_text("\n".join(known["lock"]) + "\n", encoding="utf-8")
    places.of("html").write_text(html, encoding="utf-8")
    files = [places.of(e) for e in ("html", "report.jsonl.gz", "facts.json", "lock.txt")]
    if path.suffix == ".pdf":
        write_pdf(html, path)
        files.insert(0, path)
    lines = [f"{checksum(one)}  {one.name}\n" for one in files]
    places.manifest.write_text("".join(lines), encoding="utf-8")
    files.append(places.manifest)
    places.signature.unlink(missing_ok=True)
    if key is not None:
        files.append(sign(places, key))
    return files


def write_pdf(html: str, path: Path) -> None:
    """The document as PDF. Raises `DossierError` where WeasyPrint does not load."""
    try:
        from weasyprint import HTML
    except (ImportError, OSError) as error:
        raise DossierError(
            f'a PDF needs WeasyPrint: pip install "isograde[dossier]" (and the system\'s Pango; '
            f"Debian, Ubuntu: apt-get install libpango-1.0-0 libpangoft2-1.0-0): {error}"
        ) from error
    HTML(string=html).write_pdf(path)


def checksum(path: Path) -> str:
    """The SHA-256 of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def sign(places: Places, key: str) -> Path:
    """The detached signature of the checksums by this key of GnuPG. Raises `DossierError`."""
    if shutil.which("gpg") is None:
        raise DossierError("a signature needs gpg, which is not here")
    run = ["gpg", "--batch", "--yes", "--armor", "--local-user", key, "--output"]
    run += [str(places.signature), "--detach-sign", str(places.manifest)]
    done = subprocess.run(run, capture_output=True, encoding="utf-8", check=False)
    if done.returncode:
        raise DossierError(f"gpg did not sign: {done.stderr.strip().splitlines()[-1]}")
    return places.signature


Checked = tuple[bool, str]


def verify(path: Path) -> list[Checked]:
    """Whether a dossier is what it was when it was made, a sentence for each thing looked at.

    Raises
    ------
    DossierError
        where there is no manifest beside the document.
    """
    stem = path.name.removesuffix(".asc").removesuffix(".sha256")
    document_ = path.with_name(stem) if path.name.endswith((".sha256", ".asc")) else path
    places = Places(
        document_ if document_.suffix in {".pdf", ".html"} else path.with_name(f"{stem}.html")
    )
    if not places.manifest.is_file():
        raise DossierError(
            f"there is no {places.manifest}: name a dossier's .pdf, .html or .sha256"
        )
    found = [*_checksums(places), *_signature(places)]
    if all(good for good, _ in found):
        found += _made_again(places)
    return found


def _checksums(places: Places) -> Iterator[Checked]:
    """Each file of the manifest, which must name every part."""
    lines = places.manifest.read_text(encoding="utf-8").splitlines()
    pairs = (line.split("  ", 1) for line in lines if "  " in line)
    listed = {name: said for said, name in pairs}
    for ending in ("html", "report.jsonl.gz", "facts.json", "lock.txt"):
        if places.of(ending).name not in listed:
            yield False, f"{places.manifest.name} does not list {places.of(ending).name}"
    pdf = places.of("pdf")
    if pdf.is_file() and pdf.name not in listed:
        yield False, f"{places.manifest.name} does not list {pdf.name}, which stands beside it"
    for name, said in listed.items():
        file = places.manifest.with_name(Path(name).name)
        if not file.is_file():
            yield False, f"{name} is missing"
        elif checksum(file) != said:
            yield False, f"{name} was changed: its SHA-256 is not the one listed"
        else:
            yield True, f"{name} is unchanged"


def _signature(places: Places) -> Iterator[Checked]:
    """Whether the signature, where there is one, is one of the checksums."""
    if not places.signature.is_file():
        return
    if shutil.which("gpg") is None:
        yield False, "the signature cannot be checked: gpg is not here"
        return
    run = ["gpg", "--batch", "--status-fd", "1", "--verify"]
    run += [str(places.signature), str(places.manifest)]
    done = subprocess.run(run, capture_output=True, encoding="utf-8", check=False)
    who = [line.split(" ", 3)[3] for line in done.stdout.splitlines() if "GOODSIG" in line]
    if done.returncode or not who:
        yield False, "the signature is not one of these checksums by a key that is known here"
    else:
        yield True, f"the signature is good: {who[0]}"


def _made_again(places: Places) -> Iterator[Checked]:
    """Whether the document is the one that its report and facts make."""
    known = json.loads(places.of("facts.json").read_text(encoding="utf-8"))
    try:
        report = read(places.of("report.jsonl.gz"))
    except ReportError as error:
        yield False, str(error)
        return
    if known["code"] != code_checksum(Path(__file__).parent):
        said = known["commit"] or f"isograde {known['isograde']}"
        yield True, f"made by another version of the grader ({said}): not made again to compare"
        return
    same = document(report, known) == places.of("html").read_text(encoding="utf-8")
    told = "the document is the one its report makes"
    yield same, told if same else "the document is not the one that its report makes"
    if same and places.of("pdf").is_file():
        yield True, _pdf_again(places)


def _pdf_again(places: Places) -> str:
    """Whether the document gives the same PDF here, byte for byte, in words.

    Other fonts or another WeasyPrint give other bytes, so that nothing is held against a PDF.
    """
    name = places.of("pdf").name
    with tempfile.TemporaryDirectory(prefix="isograde-") as folder:
        again = Path(folder) / name
        try:
            write_pdf(places.of("html").read_text(encoding="utf-8"), again)
        except DossierError:
            return f"{name} is held by its checksum alone: there is no WeasyPrint to make it again"
        if again.read_bytes() == places.of("pdf").read_bytes():
            return f"{name} is the one that the document makes"
    return f"{name} is held by its checksum alone: fonts and WeasyPrint here make other bytes"
