"""What `isograde check` prints: each verdict with its sentence, and the declaration to paste."""

from __future__ import annotations

import typer
from rich.markup import escape

from isograde import checking
from isograde.commands.console import Exit, say, warn_of_foreign


def check(spec: str, timeout: float) -> None:
    """What was found is printed; status 0 where nothing is to be mended."""
    warn_of_foreign(spec)
    checked = checking.check(spec, timeout)
    for word, sentence in checked.told:
        colour = {"right": "green", "note": "dim"}.get(word, "red")
        say(f"[{colour}]{word:>11}[/]  {escape(sentence)}")
    if checked.to_paste:
        say("\n" + escape("\n".join(checked.to_paste)))
    if not checked.known:
        raise typer.Exit(Exit.WRONG_USE)
    if not checked.started:
        raise typer.Exit(Exit.NOT_STARTED)
    raise typer.Exit(Exit.HOLDS if checked.right else Exit.FAILS)
