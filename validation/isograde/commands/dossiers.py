"""What `isograde dossier` does: a document is made, or one that was filed is checked."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import NoReturn

import typer
from rich.markup import escape

from isograde import dossier
from isograde.commands.comparing import read_report
from isograde.commands.console import Exit, say, status_of, stop
from isograde.commands.grading import graded
from isograde.report.headline import headline
from isograde.runner import Options


def make(implementation: str, options: Options, out: Path, key: str | None) -> NoReturn:
    """The dossier of an implementation, which is graded, or of a report that is there."""
    if out.suffix not in {".pdf", ".html"}:
        stop(Exit.WRONG_USE, f"{out} ends in neither .pdf nor .html")
    if Path(implementation).exists():
        report = read_report(Path(implementation))
    else:
        with tempfile.TemporaryDirectory(prefix="isograde-") as folder:
            report = graded(implementation, options, Path(folder) / "report.jsonl")
    try:
        files = dossier.make(report, out, key)
    except dossier.DossierError as error:
        stop(Exit.WRONG_USE, str(error))
    except OSError as error:
        stop(Exit.WRONG_USE, f"{out} cannot be written: {error.strerror}")
    say(f"[bold]{escape(headline(report))}[/]")
    for file in files:
        say(f"  {escape(str(file))}")
    raise typer.Exit(status_of(report))


def verify(path: Path) -> NoReturn:
    """Whether a dossier is what it was is told; status 1 where it is not."""
    try:
        found = dossier.verify(path)
    except dossier.DossierError as error:
        stop(Exit.WRONG_USE, str(error))
    for good, said in found:
        say(f"[{'green' if good else 'red'}]{'right' if good else 'wrong':>6}[/]  {escape(said)}")
    raise typer.Exit(Exit.HOLDS if all(good for good, _ in found) else Exit.FAILS)
