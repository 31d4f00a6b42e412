"""What `isograde bench` does: an implementation is timed beside a peer, and the page is written."""

from __future__ import annotations

from pathlib import Path

import typer
from rich.markup import escape

from isograde.adapters.exchange import TemporaryFull
from isograde.benching import Bench, NothingToBench, Plan, Row, Side, bench
from isograde.commands.console import Exit, errors, say, stop, warn_of_foreign
from isograde.model import AdapterError, Limits, UnknownName
from isograde.report.bench import headline, sentences, write


def run(spec: str, against: str | None, out: Path, plan: Plan, limits: Limits) -> None:
    """The page of an implementation is in a folder; status 4 where it answered no field."""
    warn_of_foreign(spec)
    if out.exists() and not out.is_dir():
        stop(Exit.WRONG_USE, f"{out} is a file; name a folder with --out")
    try:
        found = bench(spec, against, plan, limits, _told)
        page = write(found, out)
    except (UnknownName, NothingToBench, TemporaryFull) as error:
        stop(Exit.WRONG_USE, str(error))
    except AdapterError as error:
        stop(Exit.NOT_STARTED, str(error))
    except OSError as error:
        why = f"{out} cannot be written: {error.filename}: {error.strerror}"
        stop(Exit.WRONG_USE, f"{why}; name another folder with --out")
    except KeyboardInterrupt:
        stop(Exit.STOPPED, "stopped before the end; no page was written")
    _tell(found, page)
    raise typer.Exit(Exit.HOLDS if found.measured else Exit.NO_EVIDENCE)


def _told(row: Row) -> None:
    """A row is told as soon as it is known."""
    failed = [f"{who} {side.failed}" for who, side in _sides(row) if side.failed]
    ratio = "" if row.ratio is None else f"{row.ratio[0]:.2f} times the time"
    errors.print(f"[dim]{row.name}: {escape('; '.join(filter(None, [ratio, *failed])))}[/]")


def _sides(row: Row) -> tuple[tuple[str, Side], ...]:
    """Both, with the words for them."""
    return ("failed:", row.own), ("the peer failed:", row.peer)


def _tell(found: Bench, page: Path) -> None:
    """What was found, and where it is."""
    say(f"[bold]{escape(headline(found))}[/]")
    for said in sentences(found):
        say(escape(said))
    say(f"[dim]{escape(found.machine)}[/]")
    say(f"\npage: [bold]{escape(str(page))}[/]")
