"""The command `isograde`.

Exit status: 0 every claim the implementation makes holds, 1 some fail, 2 wrong use, 3 the
implementation did not start, 4 nothing ran.
"""

from __future__ import annotations

import difflib
import inspect
import sys
from collections import Counter
from collections.abc import Iterable
from enum import IntEnum, StrEnum
from pathlib import Path
from typing import Annotated, NoReturn

import numpy as np
import trimesh
import typer
from isoref.field import Field, FieldError
from isoref.mesh import Mesh
from isoref.methods import METHODS, RULES
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from isograde import listings, proof
from isograde import report as reports
from isograde.check import check
from isograde.claims import CLAIMS
from isograde.disciplines.registry import ALL_CLAIMS
from isograde.disciplines.registry import READY_MADE as OTHERS
from isograde.doors import ready_made_names
from isograde.doors.directory import export
from isograde.fields import all_cases, volumes
from isograde.frequencies import frequencies
from isograde.grading import grade as grade_one
from isograde.model import LEVELS, Case, Claim, DoorError, Limits, Request, Verdict
from isograde.report import comparison, record, words
from isograde.runner import BAD, NothingToRun, Options, plan, processors
from isograde.variants import pose

app = typer.Typer(
    name="isograde",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="rich",
    help="Grade an isosurface extractor: what it guarantees, and the smallest case that breaks it.",
    epilog="Start with [bold]isograde check python:mine:extract[/bold], then [bold]isograde grade "
    "python:mine:extract[/bold]. Exit status: 0 every claim holds, 1 some fail, 2 wrong use, "
    "3 the implementation did not start, 4 nothing ran.",
)
# Leave tables room where nobody's window sets a width.
console = Console(highlight=False, width=None if sys.stdout.isatty() else 120)
errors = Console(stderr=True, highlight=False, soft_wrap=True)


class Exit(IntEnum):
    """Exit status of the command; 70, as sysexits.h has it, where the command itself broke."""

    HOLDS = 0
    FAILS = 1
    WRONG_USE = 2
    NOT_STARTED = 3
    NOTHING_RAN = 4
    BROKEN = 70


class Listing(StrEnum):
    """What `isograde list` lists."""

    CLAIMS = "claims"
    FIELDS = "fields"
    IMPLEMENTATIONS = "implementations"
    LEVELS = "levels"


class Format(StrEnum):
    """What `isograde grade` writes beside the JSON lines."""

    HTML = "html"
    MARKDOWN = "md"
    JUNIT = "junit"
    BADGE = "badge"


GRADE_HELP = "python:module:function, exec:command, dir:path, or a ready-made name (list them)."
Spec = Annotated[str, typer.Argument(metavar="IMPLEMENTATION", help=GRADE_HELP)]


def stop(status: Exit, message: str) -> NoReturn:
    """Say why and leave with this status."""
    errors.print(f"[bold red]isograde:[/] {escape(message)}")
    raise typer.Exit(status)


def say(text: str) -> None:
    """Print a line, however long it is."""
    console.print(text, soft_wrap=True)


@app.command()
def grade(
    implementation: Annotated[
        str | None, typer.Argument(metavar="IMPLEMENTATION", help=GRADE_HELP)
    ] = None,
    everything: Annotated[
        bool, typer.Option("--all", help="Every ready-made implementation, and a comparison.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="Folder of the report: report, or report/only with --only.")
    ] = None,
    full: Annotated[
        bool, typer.Option("--full", help="Every case, and many more in every way.")
    ] = False,
    seed: Annotated[int, typer.Option(min=0, help="Other numbers under the same ids.")] = 0,
    only: Annotated[
        list[str] | None, typer.Option(metavar="GLOB", help="Claims or cases with such an id.")
    ] = None,
    timeout: Annotated[float, typer.Option(min=0.01, help="Seconds a call may take.")] = 30.0,
    memory: Annotated[int, typer.Option(min=16, help="Megabytes it may hold.")] = 4096,
    jobs: Annotated[
        int | None, typer.Option(min=1, help="Processes; by default as many as processors.")
    ] = None,
    formats: Annotated[
        list[Format] | None,
        typer.Option("--format", help="Beside the JSON lines; by default all of them."),
    ] = None,
) -> None:
    """Grade an implementation and write the report."""
    if everything == (implementation is not None):
        stop(Exit.WRONG_USE, "name one implementation, or --all")
    limits = Limits(timeout, memory)
    options = Options(seed, full, tuple(only or ()), limits, jobs or processors())
    kinds = [kind.value for kind in formats] if formats else list(reports.FORMATS)
    out = out or Path("report/only" if only else "report")
    if everything:
        _grade_all(options, out, kinds)
        return
    assert implementation is not None
    result = _grade(implementation, options, out / "report.jsonl")
    pages = reports.write(result, out, "report", kinds)
    _tell(result)
    shown = pages[0] if pages else out / "report.jsonl"
    say(f"\nreport: [bold]{escape(str(shown))}[/]")
    raise typer.Exit(Exit.FAILS if result.broken else Exit.HOLDS)


def _grade(spec: str, options: Options, path: Path) -> record.Report:
    """The report of one implementation, with a bar while it is made."""
    try:
        with _progress() as bar:
            task = bar.add_task(spec, total=None, bad="")

            def watch(done: int, total: int, tally: record.Tally) -> None:
                bad = sum(tally.verdicts[verdict.value] for verdict in BAD)
                bar.update(task, completed=done, total=total, bad=f"{bad} bad" if bad else "")

            return grade_one(spec, options, path, arguments=sys.argv[1:], watch=watch)
    except DoorError as error:
        stop(Exit.NOT_STARTED, str(error))
    except NothingToRun as error:
        stop(Exit.NOTHING_RAN, str(error.args[0]))
    except OSError as error:
        stop(Exit.WRONG_USE, f"{path} cannot be written: {error}")


def _progress() -> Progress:
    """A bar that is there only on a terminal, and gone when it is done."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("[red]{task.fields[bad]}"),
        TimeRemainingColumn(),
    )
    return Progress(*columns, console=errors, transient=True, disable=not errors.is_terminal)


def _grade_all(options: Options, out: Path, kinds: list[str]) -> None:
    """Every ready-made implementation graded, a page each, and a comparison."""
    done: dict[str, record.Report] = {}
    absent: dict[str, str] = {}
    for spec in [*ready_made_names(), *OTHERS]:
        stem = spec.replace(":", "-")
        try:
            done[stem] = _grade_quietly(spec, options, out / f"{stem}.jsonl.gz")
        except DoorError as error:
            absent[spec] = str(error)
            errors.print(f"[yellow]{escape(spec)}[/] is left out: {escape(str(error))}")
            continue
        except NothingToRun:
            continue  # What was asked for belongs to another discipline.
        reports.write(done[stem], out, stem, kinds)
        say(f"{escape(spec):40} {words.reached(done[stem])}")
    if not done:
        stop(Exit.NOT_STARTED if absent else Exit.NOTHING_RAN, "no implementation was graded")
    links = [f"{stem}.html" if "html" in kinds else "" for stem in done]
    found = list(done.values())
    page = comparison.comparison_page(found, links, absent)
    place = reports.write_whole(out / "comparison.html", page)
    reports.write_whole(out / "comparison.md", comparison.markdown_table(found))
    say(f"\ncomparison: [bold]{escape(str(place))}[/]")
    raise typer.Exit(Exit.FAILS if any(one.broken for one in found) else Exit.HOLDS)


def _grade_quietly(spec: str, options: Options, path: Path) -> record.Report:
    """The report of one implementation of many. Raises `DoorError`."""
    with _progress() as bar:
        task = bar.add_task(spec, total=None, bad="")
        return grade_one(
            spec,
            options,
            path,
            arguments=sys.argv[1:],
            watch=lambda done, total, _: bar.update(task, completed=done, total=total),
        )


def _tell(result: record.Report) -> None:
    """Print the ladder and what failed."""
    say(f"[bold]{escape(result.name)}[/]: {words.reached(result)}")
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    colours = {"pass": "green", "fail": "red", "not judged": "dim"}
    for rung in reversed(result.rungs):
        held = sum(summary.state == "pass" for summary in rung.summaries)
        count = f"{held} of {len(rung.summaries)}" if rung.summaries else ""
        state = f"[{colours[rung.state]}]{'holds' if rung.state == 'pass' else rung.state}[/]"
        table.add_row(str(rung.level), rung.name, state, count)
    console.print(table)
    for summary in result.failures:
        failure = summary.failure
        assert failure is not None
        colour = "red" if summary.claim["held"] else "dim"
        say(
            f"[{colour}]{escape(summary.id)}[/]: {summary.bad} of {summary.judged} cases, smallest "
            f"{escape(failure.case)} ({failure.samples} samples): {escape(failure.detail)}"
        )


@app.command(name="check")
def check_(implementation: Spec) -> None:
    """Try the door in a second or two, with advice on each mistake."""
    advice = check(implementation)
    for verdict, sentence in advice:
        colour = "green" if verdict is Verdict.PASS else "red"
        say(f"[{colour}]{verdict.value:>11}[/]  {escape(sentence)}")
    if all(verdict is Verdict.PASS for verdict, _ in advice):
        return
    started = len(advice) > 1
    raise typer.Exit(Exit.FAILS if started else Exit.NOT_STARTED)


@app.command(name="export")
def export_(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A new folder.")],
    full: Annotated[bool, typer.Option("--full", help="Every case.")] = False,
    seed: Annotated[int, typer.Option(min=0, help="Other numbers under the same ids.")] = 0,
    only: Annotated[
        list[str] | None, typer.Option(metavar="GLOB", help="Claims or cases with such an id.")
    ] = None,
    variants: Annotated[
        bool, typer.Option("--variants", help="Every way a case is posed, not only the plain one.")
    ] = False,
) -> None:
    """Write the fields as files, to be judged later as dir:DIR."""
    options = Options(seed, full, tuple(only or ()))
    try:
        count = export(folder, _requests(options, variants))
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


@app.command(name="frequencies")
def frequencies_(
    volume: Annotated[str, typer.Argument(metavar="VOLUME", help="A file, or a known data set.")],
    isovalue: Annotated[float, typer.Option(help="Value of the surface.")],
) -> None:
    """Count the configurations of the cells, as Table 1 of Nielson & Hamann."""
    try:
        table = frequencies(_volume(volume), isovalue).markdown()
    except (volumes.VolumeError, FieldError) as error:
        stop(Exit.WRONG_USE, str(error))
    console.print(table, end="", markup=False)


@app.command()
def explain(
    claim: Annotated[str, typer.Argument(metavar="CLAIM", help="An id, or a family of them.")],
) -> None:
    """Say what a claim asks, where it comes from, and what it is judged on."""
    found = [c for name, c in ALL_CLAIMS.items() if claim in (name, name.split(".")[0])]
    if not found:
        close = difflib.get_close_matches(claim, ALL_CLAIMS, n=3, cutoff=0.4)
        hint = f"did you mean {', '.join(close)}?" if close else "`isograde list claims`"
        stop(Exit.WRONG_USE, f"no claim {claim!r}; {hint}")
    for one in found:
        _explain(one)


def _explain(claim: Claim) -> None:
    """Print one claim."""
    console.print(f"\n[bold]{claim.id}[/]\n{escape(claim.rule)}\n")
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    table.add_column(style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    level = "beside the ladder"
    if claim.level is not None:
        level = f"{claim.level}, {LEVELS[claim.level][0]}: {LEVELS[claim.level][1]}"
    table.add_row("level", level)
    table.add_row("source", escape(claim.source))
    table.add_row("vertices", f"count as one {_weld(claim)}")
    tagged = f"cases tagged {', '.join(sorted(claim.tags))}"
    table.add_row("judged on", tagged if claim.tags else "every case")
    if claim.variants:
        table.add_row("posed as", ", ".join(_families(claim.variants)))
    if claim.unless:
        table.add_row("unless", f"declared without {', '.join(sorted(claim.unless))}")
    if told := inspect.getdoc(claim.judge):
        table.add_row("passes", escape(told))
    table.add_row("try it", f"isograde grade IMPLEMENTATION --only {claim.id}")
    console.print(table)


def _families(names: Iterable[str]) -> list[str]:
    """The names, those of one family (before the slash) counted under it."""
    counts = Counter(name.split("/")[0] for name in names)
    return [name if count == 1 else f"{name}/* ({count})" for name, count in counts.items()]


def _weld(claim: Claim) -> str:
    """When two vertices count as one."""
    return "where they share an index" if claim.weld == "as given" else "where they coincide"


@app.command(name="list")
def list_(
    what: Annotated[Listing, typer.Argument(help="What to list.")],
) -> None:
    """List claims, fields, implementations or levels."""
    table = {
        Listing.CLAIMS: listings.claims,
        Listing.FIELDS: listings.fields,
        Listing.IMPLEMENTATIONS: listings.implementations,
        Listing.LEVELS: listings.levels,
    }[what]
    console.print(table())


def _read(path: Path) -> record.Report:
    """The report in a file or in a folder."""
    place = path / "report.jsonl" if path.is_dir() else path
    try:
        found = record.read(place)
    except record.ReportError as error:
        stop(Exit.WRONG_USE, str(error))
    if found.footer is None:
        errors.print(f"[yellow]{escape(str(place))} was cut off: it has no footer[/]")
    return found


@app.command()
def diff(before: Path, after: Path) -> None:
    """Show what changed between two reports; status 1 where a case broke."""
    old, new = _read(before), _read(after)
    found = comparison.changes(old, new)
    for change in found:
        say(f"[bold]{change.claim}[/]: {change.before} → {change.after}")
        for colour, word, cases in (
            ("red", "broke", change.broken),
            ("green", "mended", change.mended),
        ):
            shown = ", ".join(cases[:5]) + (f" and {len(cases) - 5} more" if len(cases) > 5 else "")
            if cases:
                say(f"  [{colour}]{len(cases)} {word}[/]: {escape(shown)}")
    if not found:
        say("no case that both judged went from good to bad or back")
    raise typer.Exit(Exit.FAILS if any(change.broken for change in found) else Exit.HOLDS)


@app.command()
def compare(
    files: Annotated[list[Path], typer.Argument(metavar="REPORT...")],
    out: Annotated[Path | None, typer.Option("-o", "--out", help="An .html or .md file.")] = None,
) -> None:
    """Lay reports side by side: claims down, implementations across."""
    found = [_read(path) for path in files]
    if out is not None:
        if out.suffix not in {".html", ".md"}:
            stop(Exit.WRONG_USE, f"{out} ends in neither .html nor .md")
        page = comparison.comparison_page(found, [""] * len(found))
        text = page if out.suffix == ".html" else comparison.markdown_table(found)
        say(f"comparison: [bold]{escape(str(reports.write_whole(out, text)))}[/]")
        return
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="bold")
    table.add_column("claim", no_wrap=True)
    for one in found:
        table.add_column(escape(one.name))
    table.add_row("reached", *(words.reached(one) for one in found))
    colour = {"pass": "green", "fail": "red"}
    for claim in comparison.claims_of(found):
        marks = [comparison.mark(one, claim) for one in found]
        cells = [f"[{colour.get(s, 'dim')}]{share or s}[/]" for s, share in marks]
        table.add_row(claim, *cells)
    console.print(table)


@app.command()
def extract(
    volume: Annotated[str, typer.Argument(metavar="VOLUME", help="A file, or a known data set.")],
    isovalue: Annotated[float, typer.Option(help="Value of the surface.")],
    method: Annotated[str, typer.Option(help="A method of isoref.")] = "asymptotic-decider",
    out: Annotated[
        Path, typer.Option("-o", "--out", help="ply, obj, off, stl, glb or npz.")
    ] = Path("mesh.ply"),
) -> None:
    """Extract an isosurface with the reference, and write it as a mesh file."""
    if method not in METHODS:
        close = difflib.get_close_matches(method, METHODS, n=1)
        hint = f"did you mean {close[0]}?" if close else f"there are {', '.join(METHODS)}"
        stop(Exit.WRONG_USE, f"no method {method!r}; {hint}")
    if out.suffix.lower() not in {".ply", ".obj", ".off", ".stl", ".glb", ".npz"}:
        stop(Exit.WRONG_USE, f"{out} ends in none of .ply .obj .off .stl .glb .npz")
    try:
        mesh = METHODS[method](_volume(volume), isovalue)
        write_mesh(mesh, out)
    except (volumes.VolumeError, FieldError, OSError) as error:
        stop(Exit.WRONG_USE, str(error))
    console.print(
        f"{len(mesh.vertices):,} vertices, {len(mesh.simplices):,} triangles: "
        f"[bold]{escape(str(out))}[/]"
    )


@app.command(name="prove")
def prove_(
    rule: Annotated[str, typer.Argument(metavar="RULE", help=f"{', '.join(RULES)}.")],
    why: Annotated[bool, typer.Option("--why", help="Also print the argument.")] = False,
    shown: Annotated[int, typer.Option(help="How many pairs that tear to list.")] = 8,
) -> None:
    """Prove by enumeration that a rule of isoref is closed and manifold on every field."""
    if rule not in RULES:
        close = difflib.get_close_matches(rule, RULES, n=1)
        hint = f"did you mean {close[0]}?" if close else f"there are {', '.join(RULES)}"
        stop(Exit.WRONG_USE, f"no rule {rule!r}; {hint}")
    if why:
        console.print(inspect.getdoc(proof), end="\n\n", markup=False)
    found = proof.prove(RULES[rule])
    console.print(found.text(shown), markup=False, soft_wrap=True)
    raise typer.Exit(Exit.HOLDS if found.holds else Exit.FAILS)


def _volume(name: str) -> Field:
    """The field in a file, or of a known data set, which is downloaded where it is not here."""
    known = volumes.REGISTRY.get(name)
    if known is not None and not Path(name).exists():
        return volumes.read(volumes.fetch(known), volume=known)
    return volumes.read(Path(name))


def write_mesh(mesh: Mesh, path: Path) -> None:
    """The file holds the mesh; nothing half-written stays."""
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(f".{path.stem}.tmp{path.suffix}")
    try:
        if path.suffix.lower() == ".npz":
            np.savez(draft, vertices=mesh.vertices, faces=mesh.simplices)
        else:
            trimesh.Trimesh(mesh.vertices, mesh.simplices, process=False).export(draft)
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)


def main() -> None:
    """Run the command. A fault of its own is none of the documented statuses."""
    try:
        app()
    except Exception:  # noqa: BLE001 - shown whole, and told apart from claims that fail
        errors.print_exception()
        sys.exit(Exit.BROKEN)


if __name__ == "__main__":
    main()
