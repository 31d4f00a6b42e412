"""Reports made up for tests: claims, cases and findings in a table, no implementation needed."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from isograde.cases import Catalogue
from isograde.declaration import Declaration, declaration_from
from isograde.expectations import Expected
from isograde.grading import graded_by
from isograde.model import SURFACES, Adapter, Case, Claim, Finding, Kind, Trial, Verdict
from isograde.oracles.bodies import KINDS
from isograde.report import record
from isograde.report.lines import lines
from isograde.report.reading import Report, gather
from isograde.runner import Judged, Options, Worker, claims_for
from isoref.field import Field


def judge(trial: Trial) -> Finding:
    """Pass when it is so."""
    del trial
    return Finding(Verdict.PASS)


def claim(name: str, level: int | None, **more: Any) -> Claim:
    """A claim of this name and level."""
    return Claim(name, f"The rule of {name}.", "a paper, section 1", level, judge, **more)


# One claim or two a level, as the registry has them, and three beside the ladder.
CLAIMS: dict[str, Claim] = {
    one.id: one
    for one in (
        claim("structure.answers", 0, needs_mesh=False),
        claim(
            "bodies.pieces",
            0,
            firm=True,
            tags=frozenset({"bodies"}),
            kinds=lambda kind: kind in KINDS,
        ),
        claim("topology.closed", 1),
        claim("topology.sides", 1),
        claim("topology.manifold", 2),
        claim("symmetry.type", 2),
        claim("topology.bilinear", 3, promised=False),
        claim("topology.trilinear", 4, promised=False),
        claim("topology.ties", None),
        claim("structure.all_used", None, promised=False),
        claim("cells.separate", None, promised=False),
        claim("robustness.bad_input", None, needs_mesh=False),
        claim("robustness.nan", None, needs_mesh=False),
    )
}


def case(name: str, kind: Kind = SURFACES, tags: Iterable[str] = ()) -> Case:
    """A case of this name."""
    return Case(name, lambda: Field.of([0.0]), (0.5,) * kind.m, 27, frozenset(tags), kind=kind)


def finding(said: Any) -> Finding:
    """A finding from a verdict, or a verdict with its numbers."""
    verdict, numbers = said if isinstance(said, tuple) else (said, {})
    found = Verdict(verdict)
    return Finding(found, "" if found is Verdict.PASS else f"it is a {found.value}", numbers)


def row(
    name: str,
    general: bool | None = True,
    *,
    every: Any = "pass",
    tags: Iterable[str] = (),
    kind: Kind = SURFACES,
    without: Sequence[str] = ("topology.ties", "bodies.pieces"),
    **said: Any,
) -> tuple[Case, Judged]:
    """A case on which every claim has the verdict `every`, but those in `said`, dots as __."""
    special = {key.replace("__", "."): value for key, value in said.items()}
    names = [one for one in CLAIMS if one not in without or one in special]
    findings = {one: finding(special.get(one, every)) for one in names}
    return case(name, kind, tags), Judged(name, kind, findings, general)


def body(**said: Any) -> tuple[Case, Judged]:
    """A known body that comes out."""
    return row("bodies/ball", tags=["bodies"], without=("topology.ties",), **said)


def made(
    rows: Sequence[tuple[Case, Judged]],
    claims: Mapping[str, Claim] = CLAIMS,
    only: tuple[str, ...] = (),
    expected: Mapping[str, Expected] | None = None,
    **declared: Any,
) -> Report:
    """The report of these rows, with its footer, read back from its records."""
    declaration: Declaration = declaration_from(
        {"name": "mine", "version": "1.2", "level": 4, **declared}, "mine"
    )
    head = record.header("python:mine:f", declaration, Options(only=only), ["grade"], expected)
    written = [head, *(record.claim_record(one, declaration) for one in claims.values())]
    tally = record.Tally()
    for asked, judged in rows:
        written.append(record.case_record(asked))
        written.append(record.result_record(judged, claims))
        tally.add(judged)
    written.append(tally.footer(1.5, gather(written)))
    return gather(written)


def graded(adapter: Adapter, spec: str, asked: Iterable[Case], only: str = "") -> Report:
    """The report on these cases, of any kind, by the real worker; claims whose ids begin so."""
    options = Options()
    declared = adapter.open(options.limits)
    try:
        cases = Catalogue({one.id: one for one in asked})
        claims = {name: one for name, one in claims_for(declared).items() if name.startswith(only)}
        worker = Worker(adapter, declared, cases, claims)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "report.jsonl"
            report = graded_by(worker, spec, options, path)
            assert len(list(lines(path))) > 2  # Each is read by the schema.
    finally:
        adapter.close()
    return report
