"""What `isograde export` does: the plan's fields are written as files."""

from __future__ import annotations

from pathlib import Path

from rich.markup import escape

from isograde.claims import CLAIMS
from isograde.commands.console import Exit, console, stop
from isograde.doors.directory import export as write
from isograde.fields import all_cases
from isograde.model import Case, DoorError, Request
from isograde.runner import NothingToRun, Options, plan
from isograde.variants import pose


def export(folder: Path, options: Options, variants: bool) -> None:
    """The fields of the plan are in the folder; with `variants` in every way they are posed."""
    try:
        count = write(folder, _requests(options, variants))
    except (DoorError, OSError) as error:
        stop(Exit.WRONG_USE, str(error))
    except NothingToRun as error:
        stop(Exit.NOTHING_RAN, str(error.args[0]))
    console.print(
        f"{count:,} fields in [bold]{escape(str(folder))}[/]; put a mesh beside each, then "
        f"isograde grade dir:{escape(str(folder))}"
    )


def _requests(options: Options, variants: bool) -> list[Case | Request]:
    """The cases of the plan, and every variant that its claims ask for. Raises `NothingToRun`."""
    cases = all_cases(options.seed)
    found: list[Case | Request] = []
    for task in plan(options, cases, CLAIMS):
        case = cases[task.case]
        found.append(case)
        names = {name for claim in task.claims for name in CLAIMS[claim].variants}
        for name in sorted(names) if variants else ():
            posed = pose(name, case.build(), case.isovalue)
            if posed is not None:
                found.append(Request(case.id, name, *posed))
    return found
