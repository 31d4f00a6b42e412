"""What `isograde grade` does: one implementation, or all that are ready made."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import typer
from rich.markup import escape
from rich.table import Table

from isograde import report as reports
from isograde.adapters import ready_made_names
from isograde.adapters.exchange import TemporaryFull
from isograde.cases.own import OwnCasesError
from isograde.commands.console import Exit, console, errors, say, status_of, stop
from isograde.drafts import Busy, NotResumed, unfinished
from isograde.grading import INTERRUPTED, grade, place_of
from isograde.model import AdapterError, UnknownName
from isograde.progress import progress
from isograde.report import comparison, reading, words
from isograde.report.findings import causes
from isograde.report.headline import choices, headline
from isograde.runner import NothingToRun, Options


def grade_one(
    spec: str,
    options: Options,
    out: Path,
    kinds: list[str],
    strict: bool = False,
    resume: bool | None = None,
) -> None:
    """One implementation graded, its report written and told."""
    path = out / "report.jsonl"
    with _faults_told(path):
        result = _grade(spec, options, path, resume)
        place = place_of(path, result)
        pages = reports.write(result, out, place.stem, kinds)
    _tell(result)
    say(f"\nreport: [bold]{escape(str(pages[0] if pages else place))}[/]")
    raise typer.Exit(_status(result, path, strict))


def _status(result: reading.Report, path: Path, strict: bool) -> Exit:
    """The status of a report, which is told where it is of a part; STOPPED after Ctrl-C."""
    if result.stopped is None:
        return status_of(result, strict)
    why, left = result.stopped["why"], result.stopped["left"]
    draft = escape(str(unfinished(path)))
    errors.print(
        f"[yellow]{why}[/]: {left:,} cases were not judged. The same command goes on from {draft}"
    )
    return Exit.STOPPED if why == INTERRUPTED else status_of(result, strict)


def _grade(spec: str, options: Options, path: Path, resume: bool | None = None) -> reading.Report:
    """The report of one implementation, with a bar while it is made. Raises `AdapterError`."""
    with progress(spec, by_lines=True) as watch:
        return grade(
            spec,
            options,
            path,
            arguments=sys.argv[1:],
            watch=watch,
            resume=resume,
            interruptible=True,
            say=lambda told: errors.print(told, markup=False),
        )


@contextmanager
def _faults_told(path: Path) -> Iterator[None]:
    """Whatever ends the making of a report is told, with its status."""
    try:
        yield
    except UnknownName as error:
        stop(Exit.WRONG_USE, str(error))
    except AdapterError as error:
        stop(Exit.NOT_STARTED, str(error))
    except OwnCasesError as error:
        stop(Exit.WRONG_USE, str(error))
    except NothingToRun as error:
        stop(Exit.NO_EVIDENCE, str(error.args[0]))
    except (Busy, NotResumed, TemporaryFull) as error:
        stop(Exit.WRONG_USE, str(error))
    except OSError as error:
        why = f"{path} cannot be written: {error.filename}: {error.strerror}"
        stop(Exit.WRONG_USE, f"{why}; name another folder with --out")
    except KeyboardInterrupt:
        stop(Exit.STOPPED, _stopped(path))


def _stopped(path: Path) -> str:
    """What is there after Ctrl-C."""
    draft = unfinished(path)
    kept = f"; what it found until then is in {draft}" if draft.exists() else ""
    return f"stopped before the end{kept}. No report was written or changed."


def grade_all(
    options: Options,
    out: Path,
    kinds: list[str],
    strict: bool = False,
    resume: bool | None = None,
) -> None:
    """Every ready-made implementation graded, a page each, and a comparison."""
    done: dict[str, reading.Report] = {}
    absent: dict[str, str] = {}
    for spec in ready_made_names():
        stem = spec.replace(":", "-")
        path = out / f"{stem}.jsonl.gz"
        try:
            found_one = _grade(spec, options, path, resume)
        except KeyboardInterrupt:
            stop(Exit.STOPPED, _stopped(path))
        except (Busy, TemporaryFull) as error:
            stop(Exit.WRONG_USE, str(error))
        except NotResumed:
            continue  # It was judged to its end, or not begun.
        except AdapterError as error:
            absent[spec] = str(error)
            errors.print(f"[yellow]{escape(spec)}[/] is left out: {escape(str(error))}")
            continue
        except NothingToRun:
            continue  # What was asked for is not of its kinds.
        reports.write(found_one, out, place_of(path, found_one).name.split(".")[0], kinds)
        if _status(found_one, path, strict) is Exit.STOPPED:
            raise typer.Exit(Exit.STOPPED)
        done[stem] = found_one
        say(escape(headline(found_one)))
    if not done:
        stop(Exit.NOT_STARTED if absent else Exit.NO_EVIDENCE, "no implementation was graded")
    links = [f"{stem}.html" if "html" in kinds else "" for stem in done]
    found = list(done.values())
    page = comparison.comparison_page(found, links, absent)
    place = reports.write_whole(out / "comparison.html", page)
    reports.write_whole(out / "comparison.md", comparison.markdown_table(found))
    say(f"\ncomparison: [bold]{escape(str(place))}[/]")
    raise typer.Exit(worst(status_of(one, strict) for one in found))


def worst(statuses: Iterable[Exit]) -> Exit:
    """FAILS where one fails, else NO_EVIDENCE where one has none, else HOLDS."""
    found = set(statuses)
    return next((one for one in (Exit.FAILS, Exit.NO_EVIDENCE) if one in found), Exit.HOLDS)


def _tell(result: reading.Report) -> None:
    """Print the headline, the ladder, and what failed."""
    say(f"[bold]{escape(headline(result))}[/]")
    say(escape(words.verdict(result)))
    for told in filter(None, [words.right(result), *(f"It {one}." for one in choices(result))]):
        say(escape(told))
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    colours = {"pass": "green", "fail": "red"}
    for rung in reversed(result.rungs if not result.partial else []):
        colour = colours.get(rung.state, "dim")
        table.add_row(str(rung.level), rung.name, f"[{colour}]{escape(words.rung(rung))}[/]")
    console.print(table)
    for cause in causes(result):
        failure = cause.root.failure
        assert failure is not None
        colour = "red" if cause.held else "dim"
        say(
            f"[{colour}]{escape(cause.root.id)}[/]: {escape(cause.said)} "
            f"({escape(words.where(cause))}); smallest {escape(failure.case)}, "
            f"{failure.samples} samples"
        )
