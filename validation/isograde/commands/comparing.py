"""What `isograde diff` and `isograde compare` do: reports are read and laid beside each other."""

from __future__ import annotations

import os
from pathlib import Path
from urllib.parse import quote

import typer
from rich.markup import escape
from rich.table import Table

from isograde import report as reports
from isograde.commands.console import Exit, console, errors, say, stop
from isograde.drafts import unfinished
from isograde.report import choosing, comparison, lines, reading, words
from isograde.report.headline import by_level, headline
from isograde.report.packed import packed

# How a page is written plain: a matrix, and rows to choose by.
AGAIN = ("REPORT.. --out comparison.html", "REPORT.. --choose --out choose.html")


def file_of(path: Path) -> Path:
    """The file of a report: the path, or in a folder what `isograde grade` writes there."""
    return path / "report.jsonl" if path.is_dir() else path


def page_beside(path: Path, out: Path) -> str:
    """The way from a page to that of a report, where the report's page stands beside its lines."""
    place = file_of(path)
    page = place.with_name(place.name.removesuffix(".gz").removesuffix(".jsonl") + ".html")
    if not page.exists():
        return ""
    return quote(os.path.relpath(page.resolve(), out.resolve().parent).replace(os.sep, "/"))


def read_report(path: Path) -> reading.Report:
    """The report in a file or in a folder."""
    place = file_of(path)
    try:
        found = reading.read(place)
    except lines.ReportError as error:
        stop(Exit.WRONG_USE, str(error))
    if found.footer is None:
        errors.print(f"[yellow]{escape(str(place))} was cut off: it has no footer[/]")
    return found


def diff(before: Path, after: Path) -> None:
    """What changed between two reports is printed; status 1 where a case broke."""
    old, new = read_report(before), read_report(after)
    if told := comparison.unlike([old, new]):
        errors.print(f"[yellow]{escape(told)}[/]")
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


def compare(
    files: list[Path], out: Path | None, *, choose: bool = False, pack: bool = False
) -> None:
    """Reports are printed side by side, or written to `out`: a matrix, or rows to choose by.

    Pages that stand beside the reports are linked to.
    """
    if choose and (out is None or out.suffix != ".html"):
        stop(Exit.WRONG_USE, "--choose writes a page: name an .html file with --out")
    found = [read_report(path) for path in files]
    if told := comparison.unlike(found):
        stop(Exit.WRONG_USE, told)
    notes = [*_fewer_scans(found), *_begun(files)]
    for note in notes:
        errors.print(f"[yellow]{escape(note)}[/]")
    if out is not None:
        if out.suffix not in {".html", ".md"}:
            stop(Exit.WRONG_USE, f"{out} ends in neither .html nor .md")
        if out.suffix == ".html":
            text = _page(found, [page_beside(path, out) for path in files], notes, choose=choose)
            text = packed(text, f"isograde compare {AGAIN[choose]}") if pack else text
        else:
            text = comparison.markdown_table(found, notes)
        try:
            reports.write_whole(out, text)
        except OSError as error:
            stop(Exit.WRONG_USE, f"{out} cannot be written: {error.strerror}")
        say(f"comparison: [bold]{escape(str(out))}[/]")
        return
    for title, order in comparison.ORDERS.items():
        say(f"[bold]{title}[/]")
        for one in sorted(found, key=order):
            say(f"  {escape(headline(one))}")
    console.print(_table(sorted(found, key=by_level)))


def _fewer_scans(found: list[reading.Report]) -> list[str]:
    """A sentence for each report that has fewer real scans than the others."""
    return [
        f"{name} was {why}: what it gets wrong on those does not count against it."
        for name, why in comparison.fewer_scans(found).items()
    ]


def _begun(files: list[Path]) -> list[str]:
    """A sentence for each report beside which a later grade was begun, and is not done."""
    return [
        f"{place} is of an earlier grade: beside it stands {unfinished(place).name}, of one that "
        "did not end."
        for place in map(file_of, files)
        if unfinished(place).exists()
    ]


def _page(found: list[reading.Report], links: list[str], notes: list[str], *, choose: bool) -> str:
    """Reports side by side, or rows to choose by."""
    if not choose:
        return comparison.comparison_page(found, links, notes=notes)
    named = [one.name for one in found]
    # Of reports of one name, two runs say, a link would lead to the wrong one.
    alone = {name: link for name, link in zip(named, links, strict=True) if named.count(name) == 1}
    return choosing.choosing_page(found, alone, notes=notes)


def _table(found: list[reading.Report]) -> Table:
    """Claims down, reports across."""
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
    return table
