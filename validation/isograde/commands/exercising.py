"""What `isograde exercise` does: a file to mend is written, or one that was mended is judged."""

from __future__ import annotations

from pathlib import Path

import typer
from rich.markup import escape

from isograde.commands.console import Exit, say, stop
from isograde.exercises import EXERCISES, Exercise, judged
from isograde.model import AdapterError


def exercise(number: int, file: Path | None) -> None:
    """The file is written where there is none, or judged; status 1 where something is wrong."""
    if number not in EXERCISES:
        listed = "; ".join(f"{one.number} {one.title}" for one in EXERCISES.values())
        stop(Exit.WRONG_USE, f"there is no exercise {number}: {listed}")
    chosen = EXERCISES[number]
    if file is None:
        _given(chosen)
    else:
        _judge(chosen, file)


def _given(chosen: Exercise) -> None:
    """The file of the exercise, in the folder where the command was called."""
    path = Path(chosen.file)
    try:
        with path.open("x", encoding="utf-8") as out:
            out.write(chosen.text)
    except FileExistsError:
        told = f"{path} is there already; isograde exercise {chosen.number} {path} judges it"
        stop(Exit.WRONG_USE, told)
    except OSError as error:
        stop(Exit.WRONG_USE, f"{path} cannot be written: {error.strerror}")
    say(f"[bold]{chosen.number}. {chosen.title}[/]: {path} is written.")
    say(f"Mend it, and ask: isograde exercise {chosen.number} {path}")


def _judge(chosen: Exercise, path: Path) -> None:
    """What is still wrong is told in the words of the lesson."""
    if path.is_dir():
        told = f"isograde submissions {path} -e {chosen.number} judges what is in it"
        stop(Exit.WRONG_USE, f"{path} is a folder; {told}")
    if not path.is_file():
        stop(Exit.WRONG_USE, f"there is no file {path}")
    try:
        found = judged(chosen, path)
    except AdapterError as error:
        stop(Exit.NOT_STARTED, str(error))
    if not found:
        say(f"[green]Mended.[/] {chosen.number}. {chosen.title}: nothing is wrong any more.")
        raise typer.Exit(Exit.HOLDS)
    for one in found:
        where = f"{one.failed} of the {one.asked} fields that can show it"
        share = where if one.asked else "every field"
        say(f"[red]Still wrong[/] on {share}. {escape(one.hint)}")
        if one.case:
            say(f"  [dim]smallest: {escape(one.case)}: {escape(one.detail)} ({one.claim})[/]")
    raise typer.Exit(Exit.FAILS)
