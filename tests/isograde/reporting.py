"""Reports made up for tests: claims, cases and findings in a table, no implementation needed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from isograde.declaration import Declaration, declaration_from
from isograde.model import SURFACES, Case, Claim, Finding, Kind, Limits, Trial, Verdict
from isograde.report import record
from isograde.report.reading import Report, gather
from isoref.field import Field


@dataclass(frozen=True)
class Options:
    """As the runner's."""

    seed: int = 0
    full: bool = False
    only: tuple[str, ...] = ()
    limits: Limits = field(default_factory=Limits)
    jobs: int = 1


@dataclass(frozen=True)
class Judged:
    """As the runner's."""

    case: str
    kind: Kind
    findings: Mapping[str, Finding]
    general: bool | None = True
    seconds: float = 0.0
    calls: int = 1
    evidence: Any = None


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
        claim("bodies.pieces", 0, firm=True, tags=frozenset({"bodies"})),
        claim("topology.closed", 1),
        claim("topology.sides", 1),
        claim("topology.manifold", 2),
        claim("robustness.dtype", 2),
        claim("topology.bilinear", 3, promised=False),
        claim("topology.trilinear", 4, promised=False),
        claim("topology.ties", None),
        claim("structure.all_used", None, promised=False),
        claim("cells.separate", None, promised=False),
        claim("robustness.bad_input", None, needs_mesh=False),
        claim("robustness.nan", None, needs_mesh=False),
    )
}
Row = tuple[str, bool | None, Mapping[str, Any]]


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
    **declared: Any,
) -> Report:
    """The report of these rows, with its footer, read back from its records."""
    declaration: Declaration = declaration_from(
        {"name": "mine", "version": "1.2", "level": 4, **declared}, "mine"
    )
    lines = [record.header("python:mine:f", declaration, Options(only=only), ["grade"])]  # type: ignore[arg-type]
    lines += [record.claim_record(one, declaration) for one in claims.values()]
    tally = record.Tally()
    for asked, judged in rows:
        lines.append(record.case_record(asked))
        lines.append(record.result_record(judged, claims))  # type: ignore[arg-type]
        tally.add(judged)  # type: ignore[arg-type]
    lines.append(tally.footer(1.5, gather(lines)))
    return gather(lines)
