"""What the commands share: how they speak, and with which status they leave."""

from __future__ import annotations

import difflib
import sys
from collections.abc import Iterable
from contextlib import suppress
from enum import IntEnum
from functools import cache
from typing import TYPE_CHECKING, NoReturn

import typer

from isograde.places import cache_folder

if TYPE_CHECKING:
    from rich.console import Console

    from isograde.report.reading import Report

    console: Console
    errors: Console


@cache
def _made(name: str) -> Console:
    """The console of standard output, or of errors, made when the first word is said.

    Help does without: what speaks takes as long to import as all that help needs.
    """
    from rich.console import Console

    if name == "errors":
        return Console(stderr=True, highlight=False, soft_wrap=True)
    # Leave tables room where nobody's window sets a width.
    return Console(highlight=False, width=None if sys.stdout.isatty() else 120)


def __getattr__(name: str) -> Console:
    """`console` and `errors`."""
    if name not in ("console", "errors"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return _made(name)


class Exit(IntEnum):
    """Exit status of the command.

    NO_EVIDENCE: nothing ran, or nothing that did could have failed.

    70, as sysexits.h has it, where the command itself broke; 130, as shells have it, after Ctrl-C.
    """

    HOLDS = 0
    FAILS = 1
    WRONG_USE = 2
    NOT_STARTED = 3
    NO_EVIDENCE = 4
    BROKEN = 70
    STOPPED = 130


def status_of(report: Report, strict: bool = False) -> Exit:
    """The status that a report ends with.

    FAILS when a promised claim fails on a case on which it was not expected to; else NO_EVIDENCE
    when no promised claim could have failed, or in a full run no known body was judged; else HOLDS.
    With `strict` a promised claim without evidence fails too, and a case that was expected to fail
    and holds. Claims on bad input never change it.
    """
    if report.unexpected or (strict and (report.unproven or report.mended)):
        return Exit.FAILS
    return Exit.HOLDS if report.has_evidence else Exit.NO_EVIDENCE


def stop(status: Exit, message: str) -> NoReturn:
    """Say why and leave with this status."""
    from rich.markup import escape

    _made("errors").print(f"[bold red]isograde:[/] {escape(message)}")
    raise typer.Exit(status)


def warn_of_foreign(spec: str) -> None:
    """Say, where code runs that did not come with the grader, what is kept from it.

    It is said once on a machine: an empty file in the cache remembers it.
    """
    told = cache_folder() / "told-what-is-contained"
    if not spec.startswith(("python:", "exec:")) or told.exists():
        return
    _made("errors").print(
        "[dim]It runs as you: its time, memory and crashes are contained, its files and its "
        "network are not (SECURITY.md). This is said once.[/]"
    )
    # Where nothing can be kept it is said again.
    with suppress(OSError):
        told.parent.mkdir(parents=True, exist_ok=True)
        told.touch()


def say(text: str) -> None:
    """Print a line, however long it is."""
    _made("console").print(text, soft_wrap=True)


def close_to(name: str, names: Iterable[str]) -> str:
    """Which of the names may have been meant, or what there is.

    >>> close_to("nmae", ["name", "other"]), close_to("x", ["name", "other"])
    ('did you mean name?', 'there are name, other')
    """
    known = list(names)
    close = difflib.get_close_matches(name, known, n=1)
    return f"did you mean {close[0]}?" if close else f"there are {', '.join(known)}"
