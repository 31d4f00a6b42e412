"""What `isograde list` and `isograde explain` show."""

from __future__ import annotations

import difflib
import inspect
from collections import Counter
from collections.abc import Iterable
from importlib import import_module

from rich.markup import escape
from rich.table import Table

from isograde.adapters.registry import READY_MADE
from isograde.cases import all_cases, volumes
from isograde.claims import CLAIMS
from isograde.commands.console import Exit, console, stop
from isograde.model import LEVELS, Case, Claim, Kind
from isograde.report.record import families_of, first_line
from isograde.report.words import kinds as kind_words

# Kinds by which it is told of which a claim can be said.
ASKED = tuple(Kind(n, m) for n in range(1, 6) for m in range(1, n + 1))
# List so many kinds that have no word of their own.
LISTED = 3


def _table(*columns: str) -> Table:
    """A plain table; the first column is never broken."""
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    for index, name in enumerate(columns):
        table.add_column(name, no_wrap=index == 0, overflow="fold")
    return table


def claims() -> Table:
    """A row a claim."""
    table = _table("claim", "level", "kinds", "rule")
    for claim in CLAIMS.values():
        level = "" if claim.level is None else str(claim.level)
        table.add_row(claim.id, level, kinds_of(claim), escape(claim.rule))
    return table


def kinds_of(claim: Claim) -> str:
    """The kinds of which a claim can be said, in words."""
    told = [kind for kind in ASKED if claim.kinds(kind)]
    if len(told) == len(ASKED):
        return "every kind"
    named = [kind for kind in told if not str(kind).startswith("(")]
    others = [kind for kind in told if kind not in named]
    shown = kind_words([*named, *others[:LISTED]])
    return f"{shown} and others" if len(others) > LISTED else shown


def cases() -> Table:
    """A row a case, or a row for many that differ in a number only; then what is not here."""
    table = _table("case", "kind", "samples", "isovalues", "runs")
    every = all_cases(0)
    for group, members in _grouped(every).items():
        table.add_row(*_row(group, [every[name] for name in members]))
    for volume in volumes.REGISTRY.values():
        if volumes.find(volume) is None:
            told = f"absent; {volume.url or volume.source}"
            table.add_row(f"real/{volume.name}", "surfaces", str(volume.samples), "", told)
    return table


def _row(group: str, members: list[Case]) -> tuple[str, ...]:
    """The name, kind, size, isovalues and occasion of a group of cases."""
    rare = sum("full" in case.tags for case in members)
    runs = {0: "always", len(members): "with --full"}.get(
        rare, f"{len(members) - rare} always, {rare} with --full"
    )
    name = group if len(members) == 1 else f"{group} ({len(members)} cases)"
    first = members[0]
    levels = ", ".join(f"{level:g}" for level in first.isovalues)
    return name, str(first.kind), str(max(case.samples for case in members)), levels, runs


def _grouped(names: Iterable[str]) -> dict[str, list[str]]:
    """Ids that differ only in their last, numeric part, under one pattern."""
    groups: dict[str, list[str]] = {}
    for name in names:
        head, _, tail = name.rpartition("/")
        groups.setdefault(f"{head}/*" if tail.isdigit() else name, []).append(name)
    return groups


def implementations() -> Table:
    """A row a ready-made name."""
    table = _table("implementation", "package", "kinds", "promises", "notes")
    for name, made in READY_MADE.items():
        declared = made.declaration()
        kinds = [Kind(*kind) for kind in declared.limits.kinds]
        shown = kind_words(kinds) if len(kinds) <= LISTED else f"{len(kinds)} kinds"
        level = f"{declared.level} {LEVELS[declared.level][0]}"
        package = f"{made.distribution} {made.version}"
        table.add_row(name, package, shown, level, escape(declared.notes))
    return table


def levels() -> Table:
    """A row a level."""
    table = _table("level", "name", "guarantee")
    for level, (name, promise) in LEVELS.items():
        table.add_row(str(level), name, promise)
    return table


# How to write an implementation: the modules' own words.
GUIDES = {
    "python": "isograde.adapters.loading",
    "exec": "isograde.adapters.exec",
    "dir": "isograde.adapters.directory",
    "declaration": "isograde.declaration",
}


def explain(name: str) -> None:
    """The claim of this id, or every claim of this family, or the guide to an adapter, printed."""
    if name in GUIDES:
        console.print(inspect.getdoc(import_module(GUIDES[name])), markup=False, soft_wrap=True)
        return
    found = [c for known, c in CLAIMS.items() if name in (known, known.split(".")[0])]
    if not found:
        close = difflib.get_close_matches(name, [*CLAIMS, *GUIDES], n=3, cutoff=0.4)
        hint = f"did you mean {', '.join(close)}?" if close else "see `isograde list claims`"
        stop(Exit.WRONG_USE, f"no claim {name!r}; {hint}")
    for one in found:
        _explain(one)


def _explain(claim: Claim) -> None:
    """Print one claim."""
    console.print(f"\n[bold]{claim.id}[/]\n{escape(claim.rule)}\n")
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    table.add_column(style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    level = "beside the ladder"
    if claim.level is not None:
        level = f"{claim.level}, {LEVELS[claim.level][0]}: {LEVELS[claim.level][1]}"
    table.add_row("level", level)
    table.add_row("source", escape(claim.source))
    kinds = kinds_of(claim)
    if kinds.endswith("others"):
        kinds += f" ({first_line(claim.kinds)})"
    table.add_row("said of", f"{kinds}; {families_of(claim)}")
    tagged = f"cases tagged {', '.join(sorted(claim.tags))}"
    table.add_row("judged on", tagged if claim.tags else "every case")
    if claim.variants:
        table.add_row("posed as", ", ".join(_families(claim.variants)))
    table.add_row("promised", _promised(claim))
    table.add_row("passes", escape(first_line(claim.judge)))
    table.add_row("try it", f"isograde grade IMPLEMENTATION --only {claim.id}")
    console.print(table)


def _promised(claim: Claim) -> str:
    """By whom the claim is promised."""
    if claim.firm:
        return "always; it cannot be taken out"
    if not claim.promised:
        return f'only by who declares "promised": ["{claim.id}"]'
    if claim.level is None:
        return "unless declared otherwise"
    return f"by who declares level {claim.level} or more (2 unless said), unless declared otherwise"


def _families(names: Iterable[str]) -> list[str]:
    """The names, those of one family (before the slash) counted under it."""
    counts = Counter(name.split("/")[0] for name in names)
    return [name if count == 1 else f"{name}/* ({count})" for name, count in counts.items()]
