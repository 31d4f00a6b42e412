"""What `isograde render` does: the pages of reports are written again, from their JSON lines."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.markup import escape

from isograde import report as reports
from isograde.commands.comparing import file_of, read_report
from isograde.commands.console import Exit, say, stop


def render(
    files: Sequence[Path], out: Path | None, kinds: Sequence[str], *, pack: bool = False
) -> None:
    """The pages of each report stand beside it, or in `out`; what was written is told."""
    places = [file_of(path) for path in files]
    written = [((out or place.parent), stem_of(place)) for place in places]
    if twice := {stem for folder, stem in written if written.count((folder, stem)) > 1}:
        named = ", ".join(sorted(twice))
        stop(Exit.WRONG_USE, f"two reports would be written as {named}: render them one by one")
    for place, (folder, stem) in zip(places, written, strict=True):
        found = read_report(place)
        try:
            pages = reports.write(found, folder, stem, kinds, pack=pack)
        except OSError as error:
            stop(Exit.WRONG_USE, f"{folder} cannot be written: {error.strerror}")
        for page in pages:
            say(f"page: [bold]{escape(str(page))}[/]")


def stem_of(path: Path) -> str:
    """The name of a report's file without what it ends in.

    >>> stem_of(Path("reports/vtk-js.jsonl.gz")), stem_of(Path("pymcubes-0.1.6.jsonl"))
    ('vtk-js', 'pymcubes-0.1.6')
    """
    return path.name.removesuffix(".gz").removesuffix(".jsonl")
