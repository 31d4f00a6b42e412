"""The repository's own Markdown as pages: nothing copied by hand, every link leads somewhere.

A file keeps its text. Its relative links are turned to pages where the target has one, to the
article where it is a module, to a download where it is another file, and else the build says which
link leads nowhere. Pictures that a guided reading names in back quotes are set below the paragraph
that names them.
"""

from __future__ import annotations

import os
import posixpath
import re
import shutil
from functools import cache
from pathlib import Path

from sphinx.util import logging

from isosite.articles import LEFT_OUT
from isosite.evidence import PACKAGES, ROOT, shown_tests
from isosite.modules import everywhere
from isosite.prose import address_of, titled_in
from isosite.writing import Pages

logger = logging.getLogger(__name__)

# Files that have a page of their own name.
NAMED = {
    "README.md": "readme",
    "CHANGELOG.md": "changelog",
    "CONTRIBUTING.md": "contributing",
    "SECURITY.md": "security",
    "papers/README.md": "papers/index",
    "docs/explorer/README.md": "learn/explorer-notes",
    "docs/coming_from.rst": "coming_from",
    "reports/implementations/comparison.md": "reports/implementations",
    "reports/coverage.md": "reports/coverage",
    "reports/faults/README.md": "reports/faults",
    "reports/mutation/README.md": "reports/mutation",
    "reports/fuzz.md": "reports/fuzz",
    "reports/search/README.md": "reports/search",
    "validation/proofs/README.md": "reports/proofs",
    "validation/league/README.md": "choose/how",
}
PATTERNS = {
    "papers/*/README.md": "papers/{folder}",
    "reports/papers/*.md": "reports/papers/{stem}",
    "reports/papers/*/*.md": "reports/papers/{folder}-{stem}",
    "reports/benchmarks/*.md": "benchmarks/{stem}",
    "reports/league/upstream/*.md": "choose/upstream-{stem}",
    "docs/coming_from/*.rst": "coming_from/{stem}",
}
# Folders, as links to them are meant.
FOLDERS = {
    "papers": "papers/index",
    "reports": "reports/index",
    "reports/benchmarks": "benchmarks/index",
    "reports/implementations": "reports/implementations",
    "reports/papers": "papers/index",
    "docs/examples": "auto_examples/index",
    "docs/course": "course/index",
    "docs/explorer": "learn/explorer",
    "reference/isoref": "articles/isoref/index",
    "reference/isoref/fast": "articles/isoref/index",
    "validation/isograde": "articles/isograde/index",
    "validation/league": "choose/how",
    "benchmarks": "benchmarks/index",
    "tests": "tests/index",
}
# What is served as it stands: whole pages with their pictures, made by the grader.
SERVED = {"reports/implementations": "graded/implementations", "reports/league": "graded/league"}
SERVED_KINDS = (".html", ".svg", ".png", ".gz", ".json")
EXPLORER = "explorer.html"
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^()\s]+(?:\([^()]*\)[^()\s]*)?)\)")
# A module in back quotes, that is no link already.
NAME = re.compile(r"(?<![\[`])`(iso(?:ref|grade)(?:\.\w+)+)`(?![\]`])")
# A program, a text or a module's file in back quotes; a module of the reference by its last name,
# in tables with a column for it.
FILE = re.compile(r"(?<![\[`])`((?:[\w.-]+/)*[\w-]+\.(?:py|md))`(?![\]`])")
SHORT = re.compile(r"(?<![\[`])`([a-z_]+)`(?![\]`])")
OF_MODULES = re.compile(
    r"^\|[^\n]*\| *(?:module|read beside|where) *\|[^\n]*\n(?:\|[^\n]*(?:\n|\Z))+"
    r"|^\| *module *\|[^\n]*\n(?:\|[^\n]*(?:\n|\Z))+",
    re.MULTILINE,
)
PICTURE = re.compile(r"`((?:[\w.-]+/)*[\w.-]+\.(?:png|svg))`")


@cache
def pages() -> dict[str, str]:
    """Paths of files from the repository's root to names of pages."""
    found = {path: name for path, name in NAMED.items() if (ROOT / path).is_file()}
    for pattern, name in PATTERNS.items():
        for path in sorted(ROOT.glob(pattern)):
            key = path.relative_to(ROOT).as_posix()
            found.setdefault(key, name.format(folder=path.parent.name, stem=path.stem))
    return found


def target_of(path: str, target: str, page: str) -> tuple[str, str] | None:
    """What a link in the file `path` becomes: its kind and address; None if it leads nowhere."""
    bare, _, anchor = target.partition("#")
    there = posixpath.normpath(posixpath.join(posixpath.dirname(path), bare)) if bare else path
    here = posixpath.dirname(page) or "."
    suffix = f"#{anchor}" if anchor else ""
    if not (ROOT / there).exists():
        return None
    if there in pages():
        return "page", posixpath.relpath(pages()[there], here) + Path(there).suffix + suffix
    for folder, served in SERVED.items():
        if there.startswith(folder + "/") and there.endswith(SERVED_KINDS):
            return "file", posixpath.relpath(served + there.removeprefix(folder), here) + suffix
        if there.startswith(folder + "/") and there.endswith(".md"):
            made = served + there.removeprefix(folder).removesuffix(".md") + ".html"
            return "file", posixpath.relpath(made, here) + suffix
    if there in FOLDERS:
        hand = (
            FOLDERS[there] in pages().values() or (ROOT / "docs" / f"{FOLDERS[there]}.md").is_file()
        )
        return "page", posixpath.relpath(FOLDERS[there], here) + (".md" if hand else ".rst")
    if f"{there}/README.md" in pages():
        return "page", posixpath.relpath(pages()[f"{there}/README.md"], here) + ".md"
    module = module_at(there)
    if module:
        return "page", posixpath.relpath(module, here) + ".rst"
    if (ROOT / there).is_file():
        return "download", posixpath.relpath(f"../{there}", here)
    return None


def file_at(name: str, path: str, page: str) -> tuple[str, str] | None:
    """The kind of link, and its address, to the file that the text in `path` names."""
    here = posixpath.dirname(page) or "."
    for folder in (
        posixpath.dirname(path),
        "",
        "reference",
        "validation",
        "tests/isoref",
        "reports/papers",
    ):
        there = posixpath.normpath(posixpath.join(folder, name))
        if there in pages_of_tests():
            return "page", posixpath.relpath(pages_of_tests()[there], here) + ".rst"
        found = target_of(path, posixpath.relpath(there, posixpath.dirname(path) or "."), page)
        if (ROOT / there).is_file() and found:
            return found
    return None


@cache
def pages_of_tests() -> dict[str, str]:
    """Files of tests to their pages."""
    return {test.file: test.page for test in shown_tests()}


@cache
def articles() -> dict[Path, str]:
    """Files of modules to their articles."""
    return {m.path: m.page for name, m in everywhere().items() if name not in PACKAGES}


def module_at(path: str) -> str | None:
    """The article of a module's file."""
    return articles().get(ROOT / path)


def converted(path: str, page: str) -> str:
    """The file's Markdown as it stands on its page."""
    text = (ROOT / path).read_text(encoding="utf-8")

    def link(match: re.Match[str]) -> str:
        picture, label, target = match.groups()
        if re.match(r"[a-z]+:", target):
            return match[0]
        if target.startswith("#"):
            return match[0]
        if picture:
            there = posixpath.normpath(posixpath.join(posixpath.dirname(path), target))
            return f"![{label}]({posixpath.relpath('../' + there, posixpath.dirname(page) or '.')})"
        found = target_of(path, target, page)
        if found is None:
            logger.warning("the link to %s leads nowhere", target, location=(path, None))
            return label
        kind, address = found
        if kind == "page":
            return f"[{label}](<{address}>)"
        if kind == "file":
            return f'<a href="{address}">{label}</a>'
        return f"{{download}}`{label.replace('`', '')} <{address}>`"

    def name(match: re.Match[str]) -> str:
        module = everywhere().get(match[1])
        if module is None or match[1] in LEFT_OUT:
            return match[0]
        address = posixpath.relpath(module.page, posixpath.dirname(page) or ".")
        return f"[{match[0]}](<{address}.rst>)"

    def file(match: re.Match[str]) -> str:
        kind, address = file_at(match[1], path, page) or ("", "")
        if kind == "page":
            return f"[{match[0]}](<{address}>)"
        return f"{{download}}`{match[1]} <{address}>`" if kind == "download" else match[0]

    def short(match: re.Match[str]) -> str:
        module = everywhere().get(f"isoref.{match[1]}")
        if module is None:
            return match[0]
        address = posixpath.relpath(module.page, posixpath.dirname(page) or ".")
        return f"[{match[0]}](<{address}.rst>)"

    fenced = re.split(r"(^```.*?^```$)", text, flags=re.DOTALL | re.MULTILINE)

    def rows(match: re.Match[str]) -> str:
        return SHORT.sub(short, match[0])

    for pattern, made in ((LINK, link), (NAME, name), (FILE, file), (OF_MODULES, rows)):
        fenced = [p if n % 2 else pattern.sub(made, p) for n, p in enumerate(fenced)]
    text = "".join(fenced)
    if path == "README.md":
        text = text.replace("# isograde\n", "# The README\n", 1)
    if path.startswith("papers/"):
        text = with_pictures(with_address(text), page)
    return text


def with_address(text: str) -> str:
    """A guided reading with the addresses of its papers behind the first paragraph."""
    head, _, rest = text.partition("\n\n")
    first, _, others = rest.partition("\n\n")
    # Authors and title: the first paragraph of a guided reading.
    if "doi.org" in first or not re.search(r"\*.+\*", first, re.DOTALL):
        return text
    links = ""
    for paper in titled_in(first):
        shown, address = address_of(paper)
        why = f" ({paper['why']})" if "why" in paper else ""
        links += f" [{shown}](<{address}>){why}" if address else f" {shown}{why}"
    return f"{head}\n\n{first}{links}\n\n{others}"


def with_pictures(text: str, page: str) -> str:
    """The text with each picture below the paragraph, or the item of a list, that names it."""
    shown: set[Path] = set()
    done = []
    # An item of a list ends where the next begins; a table is one block.
    for block in re.split(r"(\n\n|\n(?=(?:\d+\.|[-*]) ))", text):
        figures = ""
        if not block.lstrip().startswith(("```", "|")):
            for name in PICTURE.findall(block):
                path = picture_at(name, text)
                if path and path not in shown:
                    shown.add(path)
                    address = posixpath.relpath(
                        f"../{path.relative_to(ROOT).as_posix()}", posixpath.dirname(page) or "."
                    )
                    caption = path.stem.replace("-", " ").replace("_", " ")
                    figures += f"![{caption}]({address})\n\n"
            if figures:
                inner = re.match(r"(\d+\.|[-*]) ", block.lstrip("\n"))
                pad = " " * len(inner[0]) if inner else ""
                figures = "\n\n" + "".join(
                    f"{pad}{row}\n" if row else "\n" for row in figures.rstrip().split("\n")
                )
        done.append(block + figures)
    return "".join(done)


def picture_at(name: str, text: str) -> Path | None:
    """The file of a picture by its path from the root, or by its name in the report's folder."""
    if (ROOT / name).is_file():
        return ROOT / name
    folders = re.findall(r"reports/papers/([\w]+)/", text) + re.findall(
        r"reports/papers/([\w]+)\.md", text
    )
    for folder in dict.fromkeys(folders):
        path: Path = ROOT / "reports" / "papers" / folder / Path(name).name
        if path.is_file():
            return path
    return None


def write(made: Pages) -> None:
    """Write every page of the repository's Markdown."""
    for path, page in pages().items():
        if path.endswith(".md"):
            made.put(f"{page}.md", converted(path, page))


def serve(out: Path) -> None:
    """Copy the grader's own pages into the site, where they are linked to."""
    for folder, place in SERVED.items():
        for path in sorted((ROOT / folder).rglob("*")):
            if path.is_file() and path.suffix in SERVED_KINDS and "unfinished" not in path.name:
                to = out / place / path.relative_to(ROOT / folder)
                to.parent.mkdir(parents=True, exist_ok=True)
                # A way to the repository's explorer stands beside reports: here, the page itself.
                source = ROOT / "docs/explorer/explorer.html" if path.name == EXPLORER else path
                if not to.exists() or to.stat().st_mtime != source.stat().st_mtime:
                    shutil.copy2(source, to)


def relative(page: str, target: str) -> str:
    """The way from one page to a file of the site."""
    return os.path.relpath(target, posixpath.dirname(page) or ".")
