"""What `isograde submissions` does: a class's folder is judged, and a table is shown or written."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.markup import escape

from isograde.commands.console import Exit, console, say, stop, warn_of_foreign
from isograde.exercises import EXERCISES
from isograde.exercises.submissions import (
    NoSubmissionsError,
    Row,
    as_csv,
    as_markdown,
    collected,
    rows,
)
from isograde.model import AdapterError

WRITERS = {".csv": as_csv, ".md": as_markdown}
COLOURS = {"mended": "green", "still wrong": "red", "no answer": "red", "not handed in": "dim"}


def submissions(
    folder: Path, numbers: Sequence[int], out: Sequence[Path], seconds: float, jobs: int
) -> None:
    """Each submission is judged and its row shown; the tables are written."""
    _check(folder, numbers, out)
    try:
        found = collected(folder, numbers)
    except NoSubmissionsError as error:
        stop(Exit.WRONG_USE, str(error))
    warn_of_foreign("python:")
    table: list[Row] = []
    try:
        for row in rows(found, seconds, jobs):
            table.append(row)
            _show(row)
    except AdapterError as error:
        stop(Exit.NOT_STARTED, str(error))
    mended = sum(row.result == "mended" for row in table)
    say(f"{mended} of {len(table)} mended.")
    for path in out:
        try:
            path.write_text(WRITERS[path.suffix](table), encoding="utf-8")
        except OSError as error:
            stop(Exit.WRONG_USE, f"{path} cannot be written: {error.strerror}")
        say(f"Table: {path}")


def _check(folder: Path, numbers: Sequence[int], out: Sequence[Path]) -> None:
    """Stop where something is asked for that is not there, before anything is judged."""
    if not folder.is_dir():
        stop(Exit.WRONG_USE, f"there is no folder {folder}")
    for number in numbers:
        if number not in EXERCISES:
            stop(Exit.WRONG_USE, f"there is no exercise {number}; there are 1 to {max(EXERCISES)}")
    for path in out:
        if path.suffix not in WRITERS:
            stop(Exit.WRONG_USE, f"{path} ends in neither {' nor '.join(WRITERS)}")


def _show(row: Row) -> None:
    """One row, as soon as it is known."""
    colour = COLOURS[row.result]
    console.print(
        f"[bold]{escape(row.name)}[/]  exercise {row.number}  [{colour}]{row.result}[/]"
        f"  [dim]{row.changed} lines changed[/]"
    )
    for told in row.told:
        console.print(f"    {escape(told)}", style="dim")
