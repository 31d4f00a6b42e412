"""What `isograde diff` and `isograde compare` do: reports are read and laid beside each other."""

from __future__ import annotations

from pathlib import Path

import typer
from rich.markup import escape
from rich.table import Table

from isograde import report as reports
from isograde.commands.console import Exit, console, errors, say, stop
from isograde.report import choosing, comparison, lines, reading, words
from isograde.report.headline import by_level, headline


def read_report(path: Path) -> reading.Report:
    """The report in a file or in a folder."""
    place = path / "report.jsonl" if path.is_dir() else path
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


def compare(files: list[Path], out: Path | None, *, choose: bool = False) -> None:
    """Reports are printed side by side, or written to `out`: a matrix, or rows to choose by."""
    if choose and (out is None or out.suffix != ".html"):
        stop(Exit.WRONG_USE, "--choose writes a page: name an .html file with --out")
    found = [read_report(path) for path in files]
    if told := comparison.unlike(found):
        stop(Exit.WRONG_USE, told)
    if out is not None:
        if out.suffix not in {".html", ".md"}:
            stop(Exit.WRONG_USE, f"{out} ends in neither .html nor .md")
        if choose:
            text = choosing.choosing_page(found, {})
        elif out.suffix == ".html":
            text = comparison.comparison_page(found, [""] * len(found))
        else:
            text = comparison.markdown_table(found)
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
