"""What `isograde check` prints: each verdict with its sentence, and the declaration to paste."""

from __future__ import annotations

import typer
from rich.markup import escape

from isograde import checking
from isograde.commands.console import Exit, say
from isograde.model import Verdict

# How a verdict is called here.
SAID = {Verdict.PASS: "right", Verdict.FAIL: "wrong", Verdict.SKIP: "note"}


def check(spec: str, timeout: float) -> None:
    """What was found is printed; status 0 where nothing is to be mended."""
    checked = checking.check(spec, timeout)
    for verdict, sentence in checked.advice:
        colour = {Verdict.PASS: "green", Verdict.SKIP: "dim"}.get(verdict, "red")
        say(f"[{colour}]{SAID.get(verdict, verdict.value):>11}[/]  {escape(sentence)}")
    if checked.paste:
        say(f"\nThe declaration to paste (isograde explain declaration):\n{escape(checked.paste)}")
    if not checked.started:
        raise typer.Exit(Exit.NOT_STARTED)
    raise typer.Exit(Exit.HOLDS if checked.right else Exit.FAILS)
