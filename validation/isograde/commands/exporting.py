"""What `isograde export` does: the plan's fields are written as files."""

from __future__ import annotations

from pathlib import Path

from rich.markup import escape

from isograde.adapters.directory import export as write
from isograde.commands.console import Exit, console, stop
from isograde.disciplines.registry import Discipline
from isograde.disciplines.registry import discipline as find
from isograde.model import AdapterError, Case, Request
from isograde.runner import NothingToRun, Options, plan


def export(folder: Path, options: Options, variants: bool, discipline: str) -> None:
    """The fields of the plan are in the folder; with `variants` in every way they are posed."""
    try:
        asked = find(discipline)
        count = write(folder, requests(asked, options, variants), discipline, asked.layout)
    except (AdapterError, OSError) as error:
        stop(Exit.WRONG_USE, str(error))
    except NothingToRun as error:
        stop(Exit.NO_EVIDENCE, str(error.args[0]))
    fields = "1 field" if count == 1 else f"{count:,} fields"
    console.print(
        f"{fields} in [bold]{escape(str(folder))}[/]; put an answer beside each, then "
        f"isograde grade dir:{escape(str(folder))}"
    )


def requests(asked: Discipline, options: Options, variants: bool) -> list[Case | Request]:
    """The cases of the plan, and every variant that its claims ask for. Raises `NothingToRun`."""
    cases = asked.cases(options.seed)
    found: list[Case | Request] = []
    for task in plan(options, cases, asked.claims):
        case = cases[task.case]
        found.append(case)
        names = {name for claim in task.claims for name in asked.claims[claim].variants}
        for name in sorted(names) if variants else ():
            posed = asked.pose(name, case, case.build())
            if posed is not None:
                found.append(Request(case.id, name, *posed))
    return found
