"""What `isograde grade` does: one implementation, or all that are ready made."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import typer
from rich.markup import escape
from rich.table import Table

from isograde import report as reports
from isograde.adapters import ready_made_names
from isograde.adapters.exchange import TemporaryFull
from isograde.cases.own import OwnCasesError
from isograde.cluster import ClusterError
from isograde.commands.comparing import read_report
from isograde.commands.console import Exit, console, errors, say, status_of, stop, warn_of_foreign
from isograde.drafts import Busy, NotResumed, unfinished
from isograde.expectations import (
    EVERY,
    FIRM,
    ExpectationError,
    Expectations,
    Expected,
    expectations,
    toml,
)
from isograde.grading import INTERRUPTED, finished, grade, place_of
from isograde.model import AdapterError, UnknownName
from isograde.progress import progress
from isograde.report import comparison, reading, words
from isograde.report.findings import causes
from isograde.report.headline import choices, headline, listed
from isograde.report.joining import JoinError, join
from isograde.report.lines import write_lines
from isograde.report.packed import packed
from isograde.runner import NothingToRun, NotKnown, Options


@dataclass(frozen=True)
class Known:
    """The files of expected failures: the one that is read, and the one that is written."""

    read: Path | None = None
    written: Path | None = None


def shard_named(said: str | None) -> tuple[int, int] | None:
    """Part and number of parts; stops the command for anything that is not I/N, 1 <= I <= N."""
    if said is None:
        return None
    number, _, of = said.partition("/")
    if not (number.isdecimal() and of.isdecimal() and 1 <= int(number) <= int(of)):
        stop(Exit.WRONG_USE, f"--shard {said}: say I/N, such as 1/4 for the first of four parts")
    return int(number), int(of)


def grade_one(
    spec: str,
    options: Options,
    out: Path,
    kinds: list[str],
    strict: bool = False,
    resume: bool | None = None,
    known: Known = Known(),
    *,
    pack: bool = False,
) -> None:
    """One implementation graded, its report written and told."""
    warn_of_foreign(spec)
    path = out / "report.jsonl"
    with _faults_told(path):
        result = _grade(spec, options, path, resume, expectations(known.read))
        place = place_of(path, result)
        pages = reports.write(result, out, place.stem, kinds, pack=pack)
        finished(path, result)
        _tell(result)
        if known.written is not None:
            _write_expected(result, known.written)
    say(f"\nreport: [bold]{escape(str(pages[0] if pages else place))}[/]")
    raise typer.Exit(_status(result, path, strict))


def graded(spec: str, options: Options, path: Path) -> reading.Report:
    """The report of one implementation; stops the command where there is none."""
    with _faults_told(path):
        return _grade(spec, options, path)


def join_parts(files: list[Path], out: Path, kinds: list[str], strict: bool) -> None:
    """The parts of a run joined, the whole report written and told."""
    found = [read_report(path) for path in files]
    try:
        result = join(found, [str(path) for path in files])
    except JoinError as error:
        stop(Exit.WRONG_USE, str(error))
    path = out / "report.jsonl"
    with _faults_told(path):
        write_lines(result.records, path)
        pages = reports.write(result, out, "report", kinds)
    _tell(result)
    say(f"\nreport: [bold]{escape(str(pages[0] if pages else path))}[/]")
    raise typer.Exit(status_of(result, strict))


def _write_expected(result: reading.Report, path: Path) -> None:
    """The file lists what failed, with the reasons it had before; what cannot be listed is told."""
    before = expectations(path) if path.exists() else {}
    found = {}
    for summary in result.broken:
        if summary.id.startswith(FIRM):
            say(f"[red]{summary.id}[/] is not written: known bodies cannot be expected to fail")
            continue
        assert summary.failure is not None
        known = before.get(summary.id) or result.expected.get(summary.id)
        reason = known.reason if known is not None else summary.failure.detail
        found[summary.id] = Expected(reason, tuple(sorted(result.bad_cases[summary.id])))
    if result.partial:
        found = {**before, **found}
    title = f"Known failures of {result.spec}. Say why of each; run with --expect {path.name}."
    reports.write_whole(path, toml(found, title))
    count = sum(len(one.cases) for one in found.values())
    say(f"{count:,} failures of {len(found)} claims are in [bold]{escape(str(path))}[/]")


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


def _grade(
    spec: str,
    options: Options,
    path: Path,
    resume: bool | None = None,
    expected: Expectations | None = None,
) -> reading.Report:
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
            keep_draft=True,
            say=lambda told: errors.print(told, markup=False),
            expected=expected,
        )


@contextmanager
def _faults_told(path: Path) -> Iterator[None]:
    """Whatever ends the making of a report is told, with its status."""
    try:
        yield
    except (UnknownName, ExpectationError) as error:
        stop(Exit.WRONG_USE, str(error))
    except AdapterError as error:
        stop(Exit.NOT_STARTED, str(error))
    except OwnCasesError as error:
        stop(Exit.WRONG_USE, str(error))
    except NotKnown as error:
        stop(Exit.WRONG_USE, str(error.args[0]))
    except NothingToRun as error:
        stop(Exit.NO_EVIDENCE, str(error.args[0]))
    except (Busy, NotResumed, TemporaryFull, ClusterError) as error:
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
    *,
    pack: bool = False,
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
        except (Busy, TemporaryFull, ClusterError) as error:
            stop(Exit.WRONG_USE, str(error))
        except NotResumed:
            continue  # It was judged to its end, or not begun.
        except AdapterError as error:
            absent[spec] = str(error)
            errors.print(f"[yellow]{escape(spec)}[/] is left out: {escape(str(error))}")
            continue
        except NotKnown as error:
            stop(Exit.WRONG_USE, str(error.args[0]))
        except NothingToRun:
            continue  # What was asked for is not of its kinds.
        kept = place_of(path, found_one).name.split(".")[0]
        reports.write(found_one, out, kept, kinds, pack=pack)
        finished(path, found_one)
        if _status(found_one, path, strict) is Exit.STOPPED:
            raise typer.Exit(Exit.STOPPED)
        done[stem] = found_one
        say(escape(headline(found_one)))
    if not done:
        stop(Exit.NOT_STARTED if absent else Exit.NO_EVIDENCE, "no implementation was graded")
    links = [f"{stem}.html" if "html" in kinds else "" for stem in done]
    found = list(done.values())
    page = comparison.comparison_page(found, links, absent)
    if pack:
        page = packed(page, "isograde compare *.jsonl.gz --out comparison.html")
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
    _tell_expected(result)
    for cause in causes(result):
        failure = cause.root.failure
        assert failure is not None
        colour = "red" if cause.held else "dim"
        say(
            f"[{colour}]{escape(cause.root.id)}[/]: {escape(words.brief(cause.said))} "
            f"({escape(words.where(cause))}); smallest {escape(words.case(failure.case))}, "
            f"{failure.samples} samples"
        )


def _tell_expected(result: reading.Report) -> None:
    """Print what became of the failures that were expected, where some were."""
    if not result.expected:
        return
    for name, cases in result.unexpected.items():
        told = listed(cases, 5)
        say(f"[red]not expected[/]: {name} on {len(cases):,} cases: {escape(told)}")
    for name, cases in result.mended.items():
        told = "every case" if cases == [EVERY] else listed(cases, 5)
        say(f"[yellow]expected to fail, and holds[/]: {name} on {escape(told)}; take it out")
