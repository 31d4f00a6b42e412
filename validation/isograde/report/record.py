"""A report as JSON lines, and read back.

One JSON object a line, each with a `kind`, in this order:

header    implementation and what it declares, versions, machine, seed, arguments
claim     a line a claim: rule, source, level, whether it is held against the implementation
case      a line a case, followed at once by its
result    ids of the claims that passed, every other finding with its numbers, and the figures of
          claims that measure an order, whatever the verdict
evidence  for each failed claim the smallest case: samples, isovalue, the mesh that came
footer    counts, the level reached and the claims withheld; a report without one was cut off

`schema.json` beside this module describes every line. A file whose name ends in .gz is compressed.
"""

from __future__ import annotations

import gzip
import io
import json
import os
import platform
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from dataclasses import field as fresh
from functools import cache, cached_property
from importlib import metadata
from importlib.resources import files
from pathlib import Path
from typing import Any, TextIO

import jsonschema
import numpy as np
from isoref.field import Field, Floats, Integers

from isograde.model import LEVELS, Case, Claim, Declaration, Finding, Outcome, Verdict
from isograde.runner import BAD, JUDGE_FAULT, Evidence, Judged, Options
from isograde.variants import VARIANTS, pose

FORMAT = 1
LIBRARIES = (
    "isograde", "numpy", "scipy", "scikit-image", "pymeshlab", "manifold3d", "trimesh",
    "PyMCubes", "vtk", "libigl", "nibabel", "pyvista",
)  # fmt: skip
KINDS = ("header", "claim", "case", "result", "evidence", "footer")
JSON = dict[str, Any]
# Write out the samples of a failed case up to so many numbers: two components of a shown case.
SHOWN_NUMBERS = 4400
# The variants of the other disciplines than surfaces, whose own are in `isograde.variants`.
MEANINGS = {
    "transposed": "the field transposed",
    "swapped": "the two fields in the other order",
    "finer": "in cells of half the size",
}


class ReportError(ValueError):
    """A file is no report; the message says which line and why."""


def header(spec: str, declaration: Declaration, options: Options, arguments: list[str]) -> JSON:
    """The first line of a report."""
    conventions = declaration.conventions
    return {
        "kind": "header",
        "format": FORMAT,
        "implementation": {
            "spec": spec,
            "name": declaration.name,
            "version": declaration.version,
            "level": declaration.level,
            "discipline": declaration.discipline,
            "conventions": {name: getattr(conventions, name) for name in vars(conventions)},
            "without": sorted(declaration.without),
            "promises": {
                name: word
                for name in ("connectivity", "identical")
                if (word := getattr(declaration, name))
            },
            "notes": declaration.notes,
        },
        "seed": options.seed,
        "full": options.full,
        "only": list(options.only),
        "limits": {"seconds": options.limits.seconds, "megabytes": options.limits.megabytes},
        "jobs": options.jobs,
        "arguments": arguments,
        "versions": versions(),
        "machine": machine(),
    }


def versions() -> dict[str, str]:
    """The versions of Python and of each library of interest that is installed."""
    found = {"python": platform.python_version()}
    for name in LIBRARIES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def machine() -> dict[str, str | int]:
    """What the machine is, without its name."""
    return {
        "system": platform.platform(),
        "processor": platform.processor() or platform.machine(),
        "processors": os.cpu_count() or 1,
        "byteorder": sys.byteorder,
    }


def held(claim: Claim, declaration: Declaration) -> bool:
    """Whether a failure of the claim counts against the implementation."""
    return claim.level is None or claim.level <= declaration.level


def claim_record(claim: Claim, declaration: Declaration) -> JSON:
    """The line of one claim."""
    return {
        "kind": "claim",
        "id": claim.id,
        "rule": claim.rule,
        "source": claim.source,
        "level": claim.level,
        "weld": claim.weld,
        "held": held(claim, declaration),
    }


def case_record(case: Case) -> JSON:
    """The line of one case."""
    return {
        "kind": "case",
        "id": case.id,
        "samples": case.samples,
        "isovalue": case.isovalue,
        "tags": sorted(case.tags),
    }


def result_record(judged: Judged) -> JSON:
    """The line of one result."""
    plain = [name for name, finding in judged.findings.items() if finding.verdict is Verdict.PASS]
    return {
        "kind": "result",
        "case": judged.case,
        "calls": judged.calls,
        "seconds": round(judged.seconds, 6),
        "passed": plain,
        "findings": [
            _finding_record(name, finding)
            for name, finding in judged.findings.items()
            if finding.verdict is not Verdict.PASS
        ],
        "measured": {
            name: dict(finding.numbers)
            for name, finding in judged.findings.items()
            if "order" in finding.numbers
        },
    }


def _finding_record(claim: str, finding: Finding) -> JSON:
    """One finding that is no pass."""
    record: JSON = {"claim": claim, "verdict": finding.verdict.value, "detail": finding.detail}
    if finding.numbers:
        record["numbers"] = dict(finding.numbers)
    return record


def evidence_record(
    claim: str,
    judged: Judged,
    of: str = "",
    legal: Outcome | None = None,
    variants: Sequence[str] = (),
) -> JSON:
    """The smallest failed case of a claim.

    `of` is the case it is a block of, and `legal` what an implementation that passes made of it. Of
    the claim's `variants` the one that the judge named is kept, or the only one.
    """
    evidence, finding = judged.evidence, judged.findings[claim]
    assert evidence is not None, "only a case that was kept whole can be shown"
    record: JSON = {
        "kind": "evidence",
        "claim": claim,
        "case": judged.case,
        "of": of,
        "finding": _finding_record(claim, finding),
        **_field_record(evidence.field, evidence.isovalue),
        "came": _mesh_record(evidence.outcomes["plain"]),
    }
    if legal is not None:
        record["legal"] = _mesh_record(legal)
    only = variants[0] if len(variants) == 1 else ""
    posed = _posed_record(evidence, str(finding.numbers.get("variant", only)))
    if posed is not None:
        record["posed"] = posed
    return record


def _field_record(field: Field, isovalue: float) -> JSON:
    """The samples, in the array's order, and their place; of a large field only the place."""
    values = np.asarray(field.values)
    return {
        "shape": list(field.shape),
        "spacing": list(field.spacing),
        "origin": list(field.origin),
        "dtype": str(field.values.dtype),
        "isovalue": isovalue,
        "components": field.components,
        "values": values.ravel().tolist() if values.size <= SHOWN_NUMBERS else [],
    }


def _posed_record(evidence: Evidence, name: str) -> JSON | None:
    """A variant of the case: how it was posed, and its answer brought back to the plain field."""
    if name in MEANINGS and name in evidence.outcomes:
        came = _mesh_record(evidence.outcomes[name])
        if name == "transposed" and "vertices" in came:
            came["vertices"] = [row[::-1] for row in came["vertices"]]
        return {"variant": name, "meaning": MEANINGS[name], "came": came}
    variant, outcome = VARIANTS.get(name), evidence.outcomes.get(name)
    posed = pose(name, evidence.field, evidence.isovalue) if variant is not None else None
    if variant is None or outcome is None or posed is None:
        return None
    field, isovalue = posed
    record: JSON = {"variant": name, "meaning": variant.meaning, **_field_record(field, isovalue)}
    mesh = outcome.mesh
    if mesh is None or mesh.vertices.shape[1] != field.dimension or field.values.size == 0:
        return {**record, "came": {"status": outcome.status.value, "detail": outcome.detail}}
    if field.dimension != evidence.field.dimension:
        return record
    places = (mesh.vertices - np.asarray(field.origin)) / np.asarray(field.spacing)
    vertices = evidence.field.position(variant.back(places, evidence.field))
    faces = mesh.simplices[:, ::-1] if variant.reflects else mesh.simplices
    return {**record, "came": {"status": "ok", **_arrays_record(vertices, faces)}}


def _mesh_record(outcome: Outcome) -> JSON:
    """Vertices and faces of an outcome, or what became of it."""
    if outcome.faces is not None and outcome.faces.ndim == 1:
        outcome = replace(outcome, faces=outcome.faces[:, None])
    mesh = outcome.mesh
    if mesh is None:
        return {"status": outcome.status.value, "detail": outcome.detail}
    return {"status": outcome.status.value, **_arrays_record(mesh.vertices, mesh.simplices)}


def _arrays_record(vertices: Floats, faces: Integers) -> JSON:
    """Vertices to nine digits, which is what a picture needs, and faces."""
    return {
        "vertices": [[float(f"{x:.9g}") for x in row] for row in vertices.tolist()],
        "faces": faces.tolist(),
    }


@dataclass
class Tally:
    """What is counted while a report is written.

    smallest : the smallest failed case of each claim, with its evidence
    """

    verdicts: Counter[str] = fresh(default_factory=Counter)
    cases: int = 0
    calls: int = 0
    judge_faults: int = 0

    def add(self, judged: Judged) -> None:
        """Count one case."""
        self.cases += 1
        self.calls += judged.calls
        for finding in judged.findings.values():
            self.verdicts[finding.verdict.value] += 1
            self.judge_faults += finding.detail.startswith(JUDGE_FAULT)

    def footer(self, seconds: float, report: Report) -> JSON:
        """The last line of the report that the lines before it make."""
        return {
            "kind": "footer",
            "cases": self.cases,
            "calls": self.calls,
            "judge_faults": self.judge_faults,
            "verdicts": dict(sorted(self.verdicts.items())),
            # A run of a part of the cases reaches no level.
            "reached": None if report.header["only"] else report.reached,
            "withheld": [] if report.header["only"] else report.withheld,
            "seconds": round(seconds, 3),
        }


@contextmanager
def open_text(path: Path, mode: str) -> Iterator[TextIO]:
    """The file, open for "r" or "w" as UTF-8; compressed where its name ends in .gz."""
    with ExitStack() as stack:
        raw = stack.enter_context(path.open("rb" if mode == "r" else "wb"))
        binary: Any = raw
        if path.suffix == ".gz":
            # Leave name and time out of the archive, so that the same report is the same file.
            archive = gzip.GzipFile("", "rb" if mode == "r" else "wb", fileobj=raw, mtime=0)
            binary = stack.enter_context(archive)
        yield stack.enter_context(io.TextIOWrapper(binary, encoding="utf-8", newline="\n"))


def write_line(file: TextIO, record: Mapping[str, Any]) -> JSON:
    """The record as written: one more line of the file."""
    plain: JSON = _plain(record)
    file.write(json.dumps(plain, separators=(",", ":"), allow_nan=False) + "\n")
    return plain


def _plain(value: Any) -> Any:
    """The value with NumPy's types made Python's, and numbers that are not finite made text."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set | frozenset | np.ndarray):
        return [_plain(item) for item in value]
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, float) and not np.isfinite(value):
        return str(value)
    return value


@dataclass(frozen=True)
class Failure:
    """The smallest case on which a claim failed; `of` is the case it is a block of, or empty."""

    case: str
    samples: int
    detail: str
    numbers: Mapping[str, Any]
    of: str = ""


@dataclass
class Summary:
    """One claim over all cases."""

    claim: JSON
    counts: Counter[str] = fresh(default_factory=Counter)
    failure: Failure | None = None
    # Why a finding is no pass, with how often, for verdicts other than fail.
    reasons: Counter[str] = fresh(default_factory=Counter)

    @property
    def id(self) -> str:
        """The claim's id."""
        return str(self.claim["id"])

    @property
    def family(self) -> str:
        """The first part of the claim's id."""
        return self.id.split(".")[0]

    @property
    def bad(self) -> int:
        """Findings that say something went wrong."""
        return sum(self.counts[verdict.value] for verdict in BAD)

    @property
    def judged(self) -> int:
        """All findings."""
        return sum(self.counts.values())

    @property
    def state(self) -> str:
        """One word: fail, pass, unsupported, or not judged."""
        if self.bad:
            return "fail"
        if self.counts[Verdict.PASS.value]:
            return "pass"
        return "unsupported" if self.counts[Verdict.UNSUPPORTED.value] else "not judged"


@dataclass
class Rung:
    """One level of the ladder."""

    level: int
    name: str
    promise: str
    summaries: list[Summary]

    @property
    def state(self) -> str:
        """One word: fail, pass, or not judged when a claim of it has no evidence."""
        states = {summary.state for summary in self.summaries}
        if "fail" in states:
            return "fail"
        return "pass" if "pass" in states and "not judged" not in states else "not judged"

    @property
    def withheld(self) -> list[str]:
        """Claims of this level that the implementation does not promise."""
        return [summary.id for summary in self.summaries if summary.state == "unsupported"]


@dataclass
class Report:
    """A report read back."""

    header: JSON
    claims: dict[str, JSON] = fresh(default_factory=dict)
    cases: dict[str, JSON] = fresh(default_factory=dict)
    results: list[JSON] = fresh(default_factory=list)
    evidence: dict[str, JSON] = fresh(default_factory=dict)
    footer: JSON | None = None

    @property
    def name(self) -> str:
        """The implementation's name."""
        return str(self.header["implementation"]["name"])

    @property
    def spec(self) -> str:
        """How the implementation was named on the command line."""
        return str(self.header["implementation"]["spec"])

    @cached_property
    def summaries(self) -> dict[str, Summary]:
        """Each claim over all cases, by id."""
        summaries = {name: Summary(claim) for name, claim in self.claims.items()}
        for result in self.results:
            for name in result["passed"]:
                summaries[name].counts[Verdict.PASS.value] += 1
            for finding in result["findings"]:
                self._add(summaries[finding["claim"]], result["case"], finding)
        for name, record in self.evidence.items():
            found, samples = record["finding"], int(np.prod(record["shape"]))
            summaries[name].failure = Failure(
                record["case"], samples, found["detail"], found.get("numbers", {}), record["of"]
            )
        return summaries

    def _add(self, summary: Summary, case: str, finding: JSON) -> None:
        """Count a finding that is no pass."""
        summary.counts[finding["verdict"]] += 1
        if finding["verdict"] not in BAD:
            summary.reasons[finding["detail"]] += 1
            return
        samples = self.cases[case]["samples"]
        if summary.failure is None or samples < summary.failure.samples:
            numbers = finding.get("numbers", {})
            summary.failure = Failure(case, samples, finding["detail"], numbers)

    @cached_property
    def rungs(self) -> list[Rung]:
        """The ladder."""
        return [
            Rung(level, name, promise, self._of_level(level))
            for level, (name, promise) in LEVELS.items()
        ]

    def _of_level(self, level: int | None) -> list[Summary]:
        """The summaries of one level."""
        return [s for s in self.summaries.values() if s.claim["level"] == level and s.judged]

    @property
    def beside(self) -> list[Summary]:
        """The claims beside the ladder."""
        return self._of_level(None)

    @property
    def reached(self) -> int | None:
        """The highest level that holds with all levels below it; None when not even the lowest.

        Above what the implementation claims, a level of which it promises only a part is not
        reached. At and below what it claims such a level counts, and `withheld` names the rest:
        whoever shows the level says so.
        """
        reached = None
        claimed = self.header["implementation"]["level"]
        for rung in self.rungs:
            if rung.state != "pass" or (rung.level > claimed and rung.withheld):
                break
            reached = rung.level
        return reached

    @property
    def withheld(self) -> list[str]:
        """Claims of the levels reached that were not judged: the implementation withholds them."""
        return self.withheld_to(self.reached)

    def withheld_to(self, level: int | None) -> list[str]:
        """Claims up to this level that the implementation withholds."""
        height = -1 if level is None else level
        return [name for rung in self.rungs if rung.level <= height for name in rung.withheld]

    @property
    def failures(self) -> list[Summary]:
        """Claims that failed and are held against the implementation, then those that are not."""
        failed = [summary for summary in self.summaries.values() if summary.state == "fail"]
        return sorted(failed, key=lambda summary: not summary.claim["held"])

    @property
    def measured(self) -> list[tuple[str, str, JSON]]:
        """Claim, case and figures of everything that was measured."""
        return [
            (claim, result["case"], numbers)
            for result in self.results
            for claim, numbers in result.get("measured", {}).items()
        ]

    @property
    def broken(self) -> list[Summary]:
        """The failures that are held against the implementation."""
        return [summary for summary in self.failures if summary.claim["held"]]


@cache
def schema() -> JSON:
    """The JSON Schema of a line."""
    text = files("isograde.report").joinpath("schema.json").read_text(encoding="utf-8")
    parsed: JSON = json.loads(text)
    return parsed


def lines(path: Path) -> Iterator[JSON]:
    """The records of a file, each checked against the schema. Raises `ReportError`."""
    try:
        with open_text(path, "r") as file:
            for number, line in enumerate(file, 1):
                yield _checked(line, f"{path}:{number}")
    except (OSError, UnicodeDecodeError, EOFError) as error:
        raise ReportError(f"{path} cannot be read: {error}") from error


def _checked(line: str, place: str) -> JSON:
    """The record on a line."""
    try:
        record: JSON = json.loads(line)
    except json.JSONDecodeError as error:
        raise ReportError(f"{place} is not JSON: {error}") from error
    kind = record.get("kind") if isinstance(record, dict) else None
    if kind not in KINDS:
        raise ReportError(f"{place} is no record of a report: kind {kind!r}")
    fault = jsonschema.exceptions.best_match(_validator(kind).iter_errors(record))
    if fault is not None:
        raise ReportError(f"{place} is no {kind} record: {fault.json_path} {fault.message}")
    return record


@cache
def _validator(kind: str) -> Any:
    """The validator of one kind of line."""
    definitions = schema()["$defs"]
    return jsonschema.Draft202012Validator({**definitions[kind], "$defs": definitions})


def read(path: Path) -> Report:
    """The report in a file. Raises `ReportError`; a missing footer is no error, but `None`."""
    return gather(lines(path), str(path))


def gather(records: Iterable[JSON], place: str = "the report") -> Report:
    """The report these records make. Raises `ReportError` where they do not begin with a header."""
    report: Report | None = None
    for record in records:
        kind = record["kind"]
        if kind == "header":
            report = Report(record)
        elif report is None:
            raise ReportError(f"{place} does not begin with a header")
        elif kind == "claim":
            report.claims[record["id"]] = record
        elif kind == "case":
            report.cases[record["id"]] = record
        elif kind == "result":
            report.results.append(record)
        elif kind == "evidence":
            report.evidence[record["claim"]] = record
        else:
            report.footer = record
    if report is None:
        raise ReportError(f"{place} is empty")
    return report
