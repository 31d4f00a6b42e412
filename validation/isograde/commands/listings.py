"""What `isograde list` and `isograde explain` show."""

from __future__ import annotations

import difflib
import inspect
from collections import Counter
from collections.abc import Iterable
from importlib import import_module

from rich.markup import escape
from rich.table import Table

from isograde.adapters.ready_made import READY_MADE
from isograde.cases import volumes
from isograde.commands.console import Exit, console, stop
from isograde.disciplines.registry import ALL_CLAIMS, DISCIPLINES
from isograde.disciplines.registry import READY_MADE as OTHERS
from isograde.model import LEVELS, Case, Claim


def _table(*columns: str) -> Table:
    """A plain table; the first column is never broken."""
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    for index, name in enumerate(columns):
        table.add_column(name, no_wrap=index == 0, overflow="fold")
    return table


def claims() -> Table:
    """A row a claim."""
    table = _table("claim", "level", "rule")
    for claim in ALL_CLAIMS.values():
        table.add_row(claim.id, "" if claim.level is None else str(claim.level), escape(claim.rule))
    return table


def fields() -> Table:
    """A row a case, or a row for many that differ in a number only; then what is not here."""
    table = _table("case", "samples", "isovalue", "runs")
    for discipline in DISCIPLINES.values():
        cases = discipline.cases(0)
        for group, members in _grouped(cases).items():
            table.add_row(*_row(group, [cases[name] for name in members]))
    for volume in volumes.REGISTRY.values():
        if volumes.find(volume) is None:
            told = f"absent; {volume.url or volume.source}"
            table.add_row(f"real/{volume.name}", str(volume.samples), "", told)
    return table


def _row(group: str, cases: list[Case]) -> tuple[str, str, str, str]:
    """The name, size, isovalue and occasion of a group of cases."""
    rare = sum("full" in case.tags for case in cases)
    runs = {0: "always", len(cases): "with --full"}.get(
        rare, f"{len(cases) - rare} always, {rare} with --full"
    )
    name = group if len(cases) == 1 else f"{group} ({len(cases)} cases)"
    return name, str(max(case.samples for case in cases)), f"{cases[0].isovalue:g}", runs


def _grouped(names: Iterable[str]) -> dict[str, list[str]]:
    """Ids that differ only in their last, numeric part, under one pattern."""
    groups: dict[str, list[str]] = {}
    for name in names:
        head, _, tail = name.rpartition("/")
        groups.setdefault(f"{head}/*" if tail.isdigit() else name, []).append(name)
    return groups


def implementations() -> Table:
    """A row a ready-made name."""
    table = _table("implementation", "package", "level", "notes")
    for name, made in READY_MADE.items():
        package = f"{made.distribution} {made.version}"
        table.add_row(name, package, str(made.level), escape(made.notes))
    for name in OTHERS:
        table.add_row(name, "", "", f"discipline {name.split(':')[0]}")
    return table


def levels() -> Table:
    """A row a level."""
    table = _table("level", "name", "guarantee")
    for level, (name, promise) in LEVELS.items():
        table.add_row(str(level), name, promise)
    return table


# How to write an implementation: the adapter's own words.
GUIDES = {
    "python": "isograde.adapters.loading",
    "exec": "isograde.adapters.exec",
    "dir": "isograde.adapters.directory",
    "declaration": "isograde.adapters.declaring",
}


def explain(name: str) -> None:
    """The claim of this id, or every claim of this family, or the guide to an adapter, printed."""
    if name in GUIDES:
        console.print(inspect.getdoc(import_module(GUIDES[name])), markup=False, soft_wrap=True)
        return
    found = [c for known, c in ALL_CLAIMS.items() if name in (known, known.split(".")[0])]
    if not found:
        close = difflib.get_close_matches(name, ALL_CLAIMS, n=3, cutoff=0.4)
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
    table.add_row("vertices", f"count as one {_weld(claim)}")
    tagged = f"cases tagged {', '.join(sorted(claim.tags))}"
    table.add_row("judged on", tagged if claim.tags else "every case")
    if claim.variants:
        table.add_row("posed as", ", ".join(_families(claim.variants)))
    if claim.unless:
        table.add_row("unless", f"declared without {', '.join(sorted(claim.unless))}")
    if told := inspect.getdoc(claim.judge):
        table.add_row("passes", escape(told))
    table.add_row("try it", f"isograde grade IMPLEMENTATION --only {claim.id}")
    console.print(table)


def _families(names: Iterable[str]) -> list[str]:
    """The names, those of one family (before the slash) counted under it."""
    counts = Counter(name.split("/")[0] for name in names)
    return [name if count == 1 else f"{name}/* ({count})" for name, count in counts.items()]


def _weld(claim: Claim) -> str:
    """When two vertices count as one."""
    return "where they share an index" if claim.weld == "as given" else "where they coincide"
