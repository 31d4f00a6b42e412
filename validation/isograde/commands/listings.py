"""What `isograde list` and `isograde explain` show."""

from __future__ import annotations

import difflib
import inspect
from collections import Counter
from collections.abc import Iterable, Sequence
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING

from rich.markup import escape
from rich.table import Table

from isograde import places
from isograde.catalogue import read
from isograde.commands.console import Exit, console, stop
from isograde.installed import version_of

if TYPE_CHECKING:
    from isograde.model import Claim


def _table(*columns: str, whole: int = 1) -> Table:
    """A plain table; so many columns, the first, are never broken."""
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    for index, name in enumerate(columns):
        table.add_column(name, no_wrap=index < whole, overflow="fold")
    return table


def claims() -> None:
    """Print a row a claim."""
    table = _table("claim", "level", "kinds", "rule")
    for name, level, kinds, rule, _ in read()["claims"]:
        table.add_row(name, "" if level is None else str(level), kinds, escape(rule))
    console.print(table)


def cases() -> None:
    """Print a row a case, or a row for many that differ in their end only; then what is absent.

    The rows are many and short: they are lined up by hand, since a table of Rich's takes as long
    for so many as NumPy takes to import.
    """
    head = ["case", "kind", "samples", "isovalues", "runs"]
    rows, absent = [head, *read()["cases"]], []
    for name, file, package, samples, source, listed in read()["volumes"]:
        if places.find(file, package) is None:
            absent.append([f"real/{name}", "surfaces", samples, "", f"absent; {source}"])
        else:
            rows += listed
    words = [[str(word) for word in row] for row in [*rows, *absent]]
    widths = [max(map(len, column)) for column in zip(*words, strict=True)]
    for row in words:
        cells = [word.ljust(width) for word, width in zip(row, widths, strict=True)]
        print("  ".join(cells).rstrip())


def implementations() -> None:
    """Print a row a ready-made name."""
    table = _table("implementation", "package", "kinds", "promises", "notes", whole=2)
    for name, distribution, modules, kinds, level, notes in read()["implementations"]:
        package = f"{distribution} {_installed(distribution, modules)}"
        table.add_row(name, package, kinds, level, escape(notes))
    console.print(table)


def _installed(distribution: str, modules: Sequence[str]) -> str:
    """The installed version of a package, "not installed", or "source" where it is used as it is.

    >>> _installed("no-such-thing", ["no_such_thing.inner"])
    'not installed'
    """
    if (version := version_of(distribution)) is not None:
        return version
    # Do not import: ask for the package of each module only.
    there = all(find_spec(one.partition(".")[0]) is not None for one in modules)
    return "source" if there else "not installed"


def levels() -> None:
    """Print a row a level."""
    table = _table("level", "name", "guarantee")
    for level, name, promise in read()["levels"]:
        table.add_row(str(level), name, promise)
    console.print(table)


# How to write an implementation: the modules' own words.
GUIDES = {
    "python": "isograde.adapters.loading",
    "function": "isograde.adapters.interpolants",
    "exec": "isograde.adapters.exec",
    "dir": "isograde.adapters.directory",
    "declaration": "isograde.declaration",
}


def explained() -> None:
    """Print what can be explained: ways in, families of claims, families of cases."""
    from isograde.cases import FAMILIES
    from isograde.claims import CLAIMS

    told = {
        "How to write an implementation": [*GUIDES, "protocol"],
        "Families of claims": dict.fromkeys(one.split(".")[0] for one in CLAIMS),
        "Families of cases": FAMILIES,
        "One claim": ["topology.closed, and so on: `isograde list claims`"],
    }
    for what, names in told.items():
        console.print(f"[bold]{what}[/]\n  {', '.join(names)}")


def _family(name: str) -> None:
    """Print what a family of cases is for, and how many cases it has."""
    from isograde.cases import FAMILIES, all_cases

    own = [case for case in all_cases(0).values() if case.id.startswith(f"{name}/")]
    usual = sum("full" not in case.tags for case in own)
    text = inspect.getdoc(FAMILIES[name]) or ""
    console.print(f"[bold]{name}/*[/]: {usual:,} cases, {len(own):,} with --full")
    console.print(text, markup=False, soft_wrap=True)
    console.print(f"\nisograde grade IMPLEMENTATION --only '{name}/*'", markup=False)


def explain(name: str) -> None:
    """What goes by this name is printed: a claim, a family of claims or cases, a guide."""
    if name == "protocol":
        from isograde.adapters.protocol import protocol_text

        console.print(protocol_text(), markup=False, soft_wrap=True, end="")
        return
    if name in GUIDES:
        console.print(inspect.getdoc(import_module(GUIDES[name])), markup=False, soft_wrap=True)
        return
    from isograde import errata
    from isograde.cases import FAMILIES
    from isograde.claims import CLAIMS

    if (verdict := errata.parsed(name)) is not None:
        plan, seed, name, case = verdict
        console.print(f"the verdict of plan {plan}, seed {seed}, on [bold]{escape(case)}[/]")
        told = [
            f"erratum {one.id} ({one.date}): {one.told}"
            for one in errata.errata_of(plan, name, case)
        ]
        console.print("\n".join(told or ["no erratum is known of it"]), markup=False)
    found = [c for known, c in CLAIMS.items() if name in (known, known.split(".")[0])]
    cases = name.partition("/")[0]
    if not found and cases not in FAMILIES:
        known = [*CLAIMS, *(one.split(".")[0] for one in CLAIMS), *GUIDES, "protocol", *FAMILIES]
        close = difflib.get_close_matches(name, dict.fromkeys(known), n=3, cutoff=0.6)
        hint = f"did you mean {', '.join(close)}? " if close else ""
        stop(Exit.WRONG_USE, f"nothing is called {name!r}; {hint}`isograde explain` says what is")
    for one in found:
        _explain(one)
    if cases in FAMILIES:
        _family(cases)


def _explain(claim: Claim) -> None:
    """Print one claim."""
    from isograde.cases import FULL
    from isograde.cataloguing import kinds_of
    from isograde.model import LEVELS
    from isograde.report.record import families_of, first_line

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
    full = "--full " if claim.tags and claim.tags <= FULL else ""
    table.add_row("try it", f"isograde grade IMPLEMENTATION {full}--only {claim.id}")
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
