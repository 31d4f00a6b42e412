"""What the grader writes: JSON lines, HTML, Markdown, JUnit XML, a badge."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from isograde.report.badge import badge, shields
from isograde.report.junit import junit
from isograde.report.markdown import markdown
from isograde.report.packed import packed
from isograde.report.page import page
from isograde.report.reading import Report
from isograde.report.viewer import EXPLORER, beside, explorer

FORMATS: dict[str, tuple[str, Callable[[Report], str]]] = {
    "html": (".html", page),
    "md": (".md", markdown),
    "junit": (".junit.xml", junit),
    "badge": (".svg", badge),
    "shields": (".shields.json", shields),
}


def write(
    report: Report, folder: Path, stem: str, formats: Iterable[str], *, pack: bool = False
) -> list[Path]:
    """The files of these formats, each written whole or not at all.

    Beside a page stands the explorer, which its failing cases open in.

    pack : the page is packed, and says how it is written plain from the lines beside it
    """
    formats = tuple(formats)
    if "html" in formats and explorer() is not None:
        write_whole(folder / EXPLORER, beside(folder))
    written = []
    for name in formats:
        ending, made = FORMATS[name]
        text = made(report)
        if pack and name == "html":
            ending_of_lines = "jsonl.gz" if (folder / f"{stem}.jsonl.gz").exists() else "jsonl"
            text = packed(text, f"isograde render {stem}.{ending_of_lines}")
        written.append(write_whole(folder / f"{stem}{ending}", text))
    return written


def write_whole(path: Path, text: str) -> Path:
    """The file holds the text; what was there before stays until it does."""
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(path.name + ".tmp")
    draft.write_text(text, encoding="utf-8")
    draft.replace(path)
    return path
