"""What the lines of a report hold, made from what the runner found.

One JSON object a line, each with the name of its ``record``, in this order:

header    the implementation and what it declares, its kinds, versions, machine, the plan's
          version, seed, arguments
claim     a line a claim that can be said of these kinds and this family: rule, source, level,
          whether it is promised; in a run of a part (``--only``) the claims asked for
case      a line a case, followed at once by its
result    ids of the claims that passed, every other finding with its numbers, the figures of
          claims that count, and whether the field is in general position
evidence  for each failed claim the smallest case: samples, isovalues, the mesh that came
footer    counts, the level reached, the headline; a report without one was cut off

Evidence lines are made in `isograde.report.shown`, lines are written and checked in
`isograde.report.lines`, and read back as a whole in `isograde.report.reading`.
"""

from __future__ import annotations

import hashlib
import inspect
import json
import os
import platform
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from dataclasses import field as fresh
from datetime import UTC, datetime
from fnmatch import fnmatchcase
from functools import cache, partial
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING

from isograde.cases import PLAN
from isograde.declaration import Declaration, declaration_json
from isograde.expectations import Expectations
from isograde.model import JUDGE_FAULT, Case, Claim, Finding, Kind, Verdict, every_family
from isograde.report.lines import FORMAT, JSON

if TYPE_CHECKING:
    from isograde.report.reading import Report
    from isograde.runner import Judged, Options

LIBRARIES = (
    "isograde", "numpy", "scipy", "scikit-image", "pymeshlab", "manifold3d", "trimesh",
    "PyMCubes", "vtk", "libigl", "contourpy", "nibabel", "pyvista",
)  # fmt: skip
# Numbers that are kept of passes too, whatever claim they belong to: cells judged, an order.
FIGURES = ("cells", "order")


def header(
    spec: str,
    declaration: Declaration,
    options: Options,
    arguments: list[str],
    expected: Expectations | None = None,
) -> JSON:
    """The first line of a report."""
    part = options.shard
    known = {
        name: {"reason": one.reason, "cases": list(one.cases)}
        for name, one in (expected or {}).items()
    }
    return {
        **({"expected": known} if known else {}),
        **({"shard": dict(zip(("part", "of"), part, strict=True))} if part else {}),
        "record": "header",
        "format": FORMAT,
        "spec": spec,
        "declaration": declaration_json(declaration),
        "kinds": [list(kind) for kind in declaration.limits.kinds],
        "top": declaration.top,
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "plan": PLAN,
        "seed": options.seed,
        "full": options.full,
        "only": list(options.only),
        "limits": {"seconds": options.limits.seconds, "megabytes": options.limits.megabytes},
        "jobs": options.jobs,
        "arguments": arguments,
        "versions": dict(versions()),
        "machine": dict(machine()),
    }


@cache
def versions() -> dict[str, str]:
    """The versions of Python, of each library of interest, and the commit of a checkout of ours."""
    found = {"python": platform.python_version()}
    if mine := commit():
        found["commit"] = mine
    for name in LIBRARIES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def commit() -> str:
    """The commit of the checkout that this package is in, with -dirty where it differs; or nothing.

    An installed copy has none: its version says what it is.
    """
    place = Path(__file__).resolve().parent
    git = shutil.which("git")
    if git is None or not any((one / ".git").exists() for one in place.parents):
        return ""
    asked = [git, "-C", str(place), "describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"]
    try:
        done = subprocess.run(asked, capture_output=True, encoding="utf-8", timeout=10, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


@cache
def machine() -> dict[str, str | int]:
    """What the machine is, without its name."""
    return {
        "system": platform.platform(),
        "processor": platform.processor() or platform.machine(),
        "processors": os.cpu_count() or 1,
        "byteorder": sys.byteorder,
    }


def kinds_of(claim: Claim, declaration: Declaration) -> list[Kind]:
    """The declared kinds of which the claim can be said; empty where it cannot be said at all."""
    if not claim.families(declaration):
        return []
    return [kind for one in declaration.limits.kinds if claim.kinds(kind := Kind(*one))]


def stated(claims: Mapping[str, Claim], declaration: Declaration) -> dict[str, Claim]:
    """The claims that can be said of the declared kinds and family; each needs evidence."""
    return {name: claim for name, claim in claims.items() if kinds_of(claim, declaration)}


def withdrawn(claim: Claim, declaration: Declaration) -> bool:
    """The declaration takes the claim out of what is promised."""
    named = any(fnmatchcase(claim.id, glob) for glob in declaration.not_promised)
    return named and not claim.held(declaration)


def claim_record(claim: Claim, declaration: Declaration) -> JSON:
    """The line of one claim."""
    return {
        "record": "claim",
        "id": claim.id,
        "rule": claim.rule,
        "source": claim.source,
        "level": claim.level,
        "promised": claim.held(declaration),
        "withdrawn": withdrawn(claim, declaration),
        "firm": claim.firm,
        "kinds": [list(kind) for kind in kinds_of(claim, declaration)],
        "families": families_of(claim),
        "judge": first_line(claim.judge),
    }


def families_of(claim: Claim) -> str:
    """The families that a claim is stated for, in words.

    >>> from isograde.model import Claim
    >>> families_of(Claim("a.b", "", "", 0, print))
    'every family'
    """
    return "every family" if claim.families is every_family else first_line(claim.families)


def first_line(function: object) -> str:
    """The first line of what a function says of itself; its name where it says nothing.

    Of a function with some arguments bound it is the function's.
    """
    while True:
        wrapped = getattr(function, "__wrapped__", None)
        if wrapped is None and not isinstance(function, partial):
            break
        function = function.func if isinstance(function, partial) else wrapped
    text = inspect.getdoc(function) or str(getattr(function, "__name__", function))
    return text.split("\n\n")[0].replace("\n", " ").rstrip(".")


def case_record(case: Case) -> JSON:
    """The line of one case."""
    return {
        "record": "case",
        "id": case.id,
        "kind": list(case.kind),
        "samples": case.samples,
        "isovalues": list(case.isovalues),
        "tags": sorted(case.tags),
    }


def result_record(judged: Judged, claims: Mapping[str, Claim]) -> JSON:
    """The line of one result."""
    findings = judged.findings
    return {
        "record": "result",
        "case": judged.case,
        "general": judged.general,
        "calls": judged.calls,
        "seconds": round(judged.seconds, 6),
        "passed": [name for name, one in findings.items() if one.verdict is Verdict.PASS],
        "findings": [
            finding_record(name, finding)
            for name, finding in findings.items()
            if finding.verdict is not Verdict.PASS
        ],
        "measured": {
            name: dict(finding.numbers)
            for name, finding in findings.items()
            if finding.numbers and _counts(claims.get(name), finding)
        },
    }


def _counts(claim: Claim | None, finding: Finding) -> bool:
    """Whether the finding's numbers are kept although it passed."""
    beside = claim is not None and claim.level is None
    return beside or any(name in finding.numbers for name in FIGURES)


def finding_record(claim: str, finding: Finding) -> JSON:
    """One finding that is no pass."""
    record: JSON = {"claim": claim, "verdict": finding.verdict.value, "detail": finding.detail}
    if finding.numbers:
        record["numbers"] = dict(finding.numbers)
    return record


@dataclass
class Tally:
    """What is counted while a report is written."""

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

    def add_record(self, result: JSON) -> None:
        """Count one case by its line."""
        self.cases += 1
        self.calls += result["calls"]
        self.verdicts[Verdict.PASS.value] += len(result["passed"])
        for finding in result["findings"]:
            self.verdicts[finding["verdict"]] += 1
            self.judge_faults += finding["detail"].startswith(JUDGE_FAULT)

    def footer(self, seconds: float, report: Report) -> JSON:
        """The last line of the report that the lines before it make."""
        from isograde.report.headline import headline

        whole = not report.partial
        return {
            "record": "footer",
            "cases": self.cases,
            "calls": self.calls,
            "judge_faults": self.judge_faults,
            "verdicts": {name: n for name, n in sorted(self.verdicts.items()) if n},
            # A run of a part of the cases reaches no level.
            "reached": report.reached,
            "with_ties": report.with_ties,
            "not_promised": report.withdrawn,
            "headline": headline(report) if whole else "",
            "checksum": checksum(report),
            "seconds": round(seconds, 3),
        }


def spent(judged: Judged) -> dict[str, float]:
    """Where the seconds of one case went."""
    return {
        "implementation": judged.inside,
        "adapter": judged.asking,
        "oracles": max(0.0, judged.seconds - judged.inside - judged.asking),
        "fields": judged.building,
    }


def tally_of(report: Report) -> Tally:
    """What is counted in a report that has its results."""
    tally = Tally()
    for result in report.results:
        tally.add_record(result)
    return tally


def checksum(report: Report) -> str:
    """A number for the cases that were asked: the same for the same ids, sizes and isovalues."""
    digest = hashlib.sha256()
    for case in report.cases.values():
        digest.update(json.dumps(case, sort_keys=True).encode())
    return digest.hexdigest()[:16]
