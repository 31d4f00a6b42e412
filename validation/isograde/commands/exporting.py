"""What `isograde export` does: the plan's fields are written as files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.markup import escape

from isograde import variants
from isograde.adapters.directory import export as write
from isograde.cases import all_cases
from isograde.claims import CLAIMS
from isograde.commands.console import Exit, console, stop
from isograde.model import KINDS, AdapterError, Case, Kind, Request
from isograde.runner import NothingToRun, Options, plan


def export(folder: Path, options: Options, posed: bool, kinds: Sequence[str]) -> None:
    """The plan's fields of these kinds are in the folder; with `posed` in every way."""
    try:
        count = write(folder, requests([kind_named(one) for one in kinds], options, posed))
    except (AdapterError, OSError) as error:
        stop(Exit.WRONG_USE, str(error))
    except NothingToRun as error:
        stop(Exit.NO_EVIDENCE, str(error.args[0]))
    fields = "1 field" if count == 1 else f"{count:,} fields"
    console.print(
        f"{fields} in [bold]{escape(str(folder))}[/]; put an answer beside each, then "
        f"isograde grade dir:{escape(str(folder))}"
    )


def kind_named(name: str) -> Kind:
    """The kind of a word, or of two numbers; stops the command for any other."""
    words = {word: kind for kind, word in KINDS.items()}
    if name in words:
        return words[name]
    parts = name.replace("(", "").replace(")", "").split(",")
    try:
        n, m = map(int, parts)
    except ValueError:
        n, m = 0, 0
    if not n >= m >= 1:
        stop(
            Exit.WRONG_USE,
            f"no kind {name!r}; there are {', '.join(words)}, and n,m for m fields on an "
            "n-dimensional lattice, such as 4,2",
        )
    return Kind(n, m)


def requests(kinds: Sequence[Kind], options: Options, posed: bool) -> list[Case | Request]:
    """The cases of the plan, and every variant that its claims ask for. Raises `NothingToRun`."""
    every = all_cases(options.seed)
    cases = type(every)({name: case for name, case in every.items() if case.kind in kinds})
    found: list[Case | Request] = []
    for task in plan(options, cases, CLAIMS):
        case = cases[task.case]
        found.append(case)
        if posed:
            found += _posed(case, {name for one in task.claims for name in CLAIMS[one].variants})
    return found


def _posed(case: Case, names: set[str]) -> list[Request]:
    """The case in each of these ways that its values allow."""
    field, found = case.build(), []
    for name in sorted(variants.named(sorted(names), case.kind)):
        way = variants.pose(name, case, field)
        # A file holds samples, and cannot say how a program is to be called; folders hold fields
        # whose axes run as those of the world.
        if way is None or way[0].directions is not None or min(way[0].spacing, default=1) < 0:
            continue
        if variants.variant(name, case.kind).calls == "once":
            found.append(Request(case.id, name, *way))
    return found
