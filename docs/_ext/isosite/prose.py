"""A docstring as a page's text: prose, definitions, references, drawings, formulas.

==================  =======================================================================
in the source       on the page
==================  =======================================================================
a line underlined   a heading
two columns         a list of definitions, with symbols as mathematics
``[1] Author, ..``  a reference with an anchor, and the paper's DOI
``>>>``             an example
indented, ``::``    displayed mathematics where every line is a formula, else a drawing
`` `name` ``        a link to the module, function, class or table of that name
the rest            paragraphs, with formulas as mathematics
==================  =======================================================================
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from textwrap import dedent, indent

from isosite.formulas import as_tex, displayed, says_something, tokens, with_formulas

BIBLIOGRAPHY = Path(__file__).parents[2] / "bibliography.toml"
# Marks that no docstring has, round what is rst already.
OPEN, CLOSE = "\x02", "\x03"
CODE = re.compile(r"``(.+?)``", re.DOTALL)
NAME = re.compile(r"`([^`\n]+)`_?")
EMPHASIS = re.compile(r"(?<![\w)*])(\*{1,2})(?=\S)([^*]+?)(?<=\S)\1(?![\w*])")
CITATION = re.compile(r"\[(\d+)(?:-(\d+))?\]")
ROW = re.compile(r"(\S.*?) {2,}(\S.*)")
# Another column, or a line of a drawing.
DRAWN = re.compile(r"\S {3,}\S|--|->|[|/\\]")


@dataclass(frozen=True)
class Scope:
    """Where a text stands: how names are found there, and where its numbered references are.

    named : a name in back quotes to a label, or None where nothing is meant by it
    references : numbers to labels
    """

    named: Callable[[str], str | None] = lambda _: None
    references: dict[str, str] = field(default_factory=dict)


def heading(title: str, underline: str, label: str = "") -> str:
    """A title of reStructuredText, with its label."""
    anchor = f".. _{label}:\n\n" if label else ""
    return f"{anchor}{title}\n{underline * max(len(title), 3)}\n\n"


def escaped(text: str) -> str:
    """The text with nothing in it that reStructuredText would take for markup."""
    return re.sub(r"([\\*`|])|(?<=\w)(_)(?!\w)", lambda m: "\\" + m[0], text)


def line_of(text: str, scope: Scope) -> str:
    """A paragraph's text as reStructuredText: code, names, citations and formulas in it."""
    kept: list[str] = []

    def keep(rst: str) -> str:
        kept.append(rst)
        return f"{OPEN}{len(kept) - 1}{CLOSE}"

    def name(match: re.Match[str]) -> str:
        label = scope.named(match[1])
        return keep(f":ref:`{match[1]} <{label}>`" if label else f"``{match[1]}``")

    def citation(match: re.Match[str]) -> str:
        label = scope.references.get(match[1])
        rest = f"-{match[2]}" if match[2] else ""
        return keep(f":ref:`[{match[1]}{rest}] <{label}>`") if label else match[0]

    text = CODE.sub(lambda m: keep(f"``{m[1]}``"), text)
    text = NAME.sub(name, text)
    text = CITATION.sub(citation, text)
    text = EMPHASIS.sub(lambda m: keep(f"{m[1]}{m[2]}{m[1]}"), text)
    pieces = re.split(rf"({OPEN}\d+{CLOSE})", text)
    text = "".join(
        piece if n % 2 else with_formulas(piece, OPEN + "m{}" + CLOSE)
        for n, piece in enumerate(pieces)
    )
    done = ""
    for n, piece in enumerate(re.split(rf"{OPEN}(.*?){CLOSE}", text, flags=re.DOTALL)):
        if n % 2 == 0:
            # Markup ends where a letter would go on: a space that is not shown stands between.
            joined = "\\ " if done and re.match(r"[\w`([{<]", piece) else ""
            done += joined + escaped(piece) if n else escaped(piece)
        else:
            joined = "\\ " if re.search(r"[\w)\]}>]$", done) else ""
            done += joined + (kept[int(piece)] if piece.isdigit() else f":math:`{piece[1:]}`")
    return done


def term_of(text: str, scope: Scope) -> str:
    """The left column of a definition: symbols as mathematics, words as they are."""
    if text.startswith("`"):
        return line_of(text, scope)
    if ", " in text and "(" not in text:
        return ", ".join(term_of(part, scope) for part in text.split(", "))
    tex = as_tex(text, inline=True)
    row = tokens(text)
    if tex is not None and (
        says_something(row) or any(len(t.text) == 1 or t.kind == "symbol" for t in row)
    ):
        return f":math:`{tex}`"
    return f"``{text}``" if re.search(r"[\w]+\(|_|\.\.", text) else line_of(text, scope)


def definitions(paragraph: str) -> list[tuple[str, str]] | None:
    """The rows of two columns; None where the paragraph has another form."""
    rows: list[tuple[str, str]] = []
    edge = 0
    for line in paragraph.splitlines():
        match = ROW.fullmatch(line)
        if edge and not match and line[edge - 1 : edge] == " " and line[edge:].strip():
            match = re.fullmatch(rf"(.{{{edge - 1}}}) (\S.*)", line)
        typed = re.fullmatch(r"(\*{0,2}\w[\w, *]*) : (.*)", line)
        if line.startswith(" "):
            if not rows or (edge and len(line) - len(line.lstrip()) < min(edge, 4)):
                return None
            rows[-1] = (rows[-1][0], f"{rows[-1][1]} {line.strip()}".strip())
        elif match and (not edge or match.start(2) == edge) and len(match[1]) < 40:
            edge = match.start(2)
            rows.append((match[1], match[2]))
        elif typed and not match:
            rows.append((typed[1], typed[2]))
        elif len(line) < 32 and (
            edge or not rows or (rows[-1][1] and re.fullmatch(r"\w+(, \w+)*", line))
        ):
            rows.append((line, ""))
        else:
            return None
    return rows if rows and all(text for _, text in rows) else None


def definition_list(rows: list[tuple[str, str]], scope: Scope) -> str:
    """The rows as definitions."""
    body = "".join(f"{term_of(term, scope)}\n   {line_of(text, scope)}\n\n" for term, text in rows)
    return ".. container:: glossary-rows\n\n" + indent(body, "   ")


@cache
def bibliography() -> list[dict[str, str]]:
    """The papers with their DOIs or addresses."""
    papers: list[dict[str, str]] = tomllib.loads(BIBLIOGRAPHY.read_text(encoding="utf-8"))["paper"]
    return papers


def plain(text: str) -> str:
    """The text in small letters, with one space for all that is no letter or digit."""
    return re.sub(r"\W+", " ", text).casefold()


@cache
def papers_of(text: str) -> tuple[dict[str, str], ...]:
    """The papers of the bibliography that the text names: by author, and by year or title."""
    flat = plain(text)
    mentioned = {(paper["author"], paper["year"]) for paper, _ in mentions(text)}

    def named(paper: dict[str, str]) -> bool:
        if not re.search(rf"\b{re.escape(plain(paper['author']))}\b", flat):
            return False
        return (
            paper.get("by_author") == "yes"
            or plain(paper["title"]) in flat
            or (paper.get("by_year", "yes") == "yes" and paper["year"] in flat)
            or (paper["author"], paper["year"]) in mentioned
        )

    return tuple(paper for paper in bibliography() if named(paper))


@cache
def dated() -> tuple[re.Pattern[str], dict[tuple[str, str], dict[str, str]]]:
    """What finds an author with a year a few words behind; authors and years to papers."""
    papers = {(paper["author"], paper["year"]): paper for paper in bibliography()}
    authors = "|".join(sorted({re.escape(author) for author, _ in papers}))
    between = r"(?:\W+(?!(?:19|20)\d\d\b)\w+){0,5}?\W+"
    # Looked ahead for, so that the second of two names is found too.
    return re.compile(rf"\b(?=({authors})\b{between}((?:19|20)\d\d)\b)"), papers


def mentions(text: str) -> list[tuple[dict[str, str], tuple[int, int]]]:
    """Papers that the text names by author and year, with the place of the year; in its order."""
    name, papers = dated()
    found = {m.span(2): papers[m[1], m[2]] for m in name.finditer(text) if (m[1], m[2]) in papers}
    return [(paper, place) for place, paper in sorted(found.items(), key=lambda one: one[0])]


def address_of(paper: dict[str, str]) -> tuple[str, str]:
    """What is shown of a paper's address, and the address; empty where it has a number only."""
    if "doi" in paper:
        return f"doi:{paper['doi']}", f"https://doi.org/{paper['doi']}"
    if "url" in paper:
        return re.sub(r"^https?://", "", paper["url"]), paper["url"]
    return f"ISBN {paper['isbn']}", ""


def link_of(paper: dict[str, str]) -> str:
    """Where the paper is, as reStructuredText, and why it has no DOI."""
    shown, address = address_of(paper)
    link = f"`{shown} <{address}>`__" if address else shown
    return f"{link} ({paper['why']})" if "why" in paper else link


def reference(number: str, text: str, label: str, scope: Scope) -> str:
    """A numbered reference with its anchor and the paper's address."""
    flat = " ".join(text.split())
    links = " ".join(link_of(paper) for paper in works_of(flat))
    shown = line_of(flat, Scope(scope.named))
    return f".. _{label}:\n\n[{number}] {shown} {links}\n\n"


def titled_in(text: str) -> list[dict[str, str]]:
    """The papers whose title stands in the text, in its order."""
    flat = plain(text)
    titled = [paper for paper in papers_of(text) if plain(paper["title"]) in flat]
    return sorted(titled, key=lambda paper: flat.find(plain(paper["title"])))


def works_of(text: str) -> list[dict[str, str]]:
    """The works of a numbered reference: one a part where semicolons part it, else the first."""
    parts = [found for part in text.split(";") if (found := papers_of(part))]
    if len(parts) > 1:
        return [found[0] for found in parts]
    return (titled_in(text) or [*papers_of(text)])[:1]


def references_of(docstring: str, prefix: str) -> dict[str, str]:
    """Numbers of the references to labels."""
    part = re.search(r"^References\n-+\n(.*)", docstring, re.DOTALL | re.MULTILINE)
    numbers = re.findall(r"^(?:\[(\d+)\]|(\d+)\.) ", part[1], re.MULTILINE) if part else []
    return {one or two: f"{prefix}.reference-{one or two}" for one, two in numbers}


def rst_of(docstring: str, scope: Scope, *, level: str = "", label: str = "") -> str:
    """The docstring without its first line; its headings underlined by `level`, or rubrics."""
    _, _, body = docstring.partition("\n")
    # A line that ends in two colons announces what is indented below it.
    parts: list[str] = []
    announced = False
    for paragraph in re.split(r"\n{2,}", body.strip("\n")):
        if not paragraph.strip():
            continue
        title = re.fullmatch(r"(\S.*)\n[-=]{3,}(?:\n(.*))?", paragraph, re.DOTALL)
        if title:
            name = escaped(title[1])
            # A docstring inside a page has no headings of the page's own.
            parts.append(
                heading(name, level, f"{label}.{slug(title[1])}" if label else "")
                if level
                else f".. rubric:: {name}\n\n"
            )
            paragraph = title[2] or ""
            if not paragraph:
                continue
        if paragraph.startswith(" "):
            parts.append(drawn(paragraph, scope))
            announced = False
            continue
        announced = paragraph.rstrip().endswith("::")
        if announced:
            paragraph = re.sub(r"\s*::\s*$", ":", paragraph.rstrip())
            if paragraph == ":":
                continue
        parts.append(told(paragraph, scope))
    return "".join(parts)


def drawn(paragraph: str, scope: Scope) -> str:
    """An indented paragraph: formulas, or a drawing."""
    block = dedent(paragraph)
    tex = displayed(re.sub(r"(?<!\.)[.,]$", "", block.rstrip()))
    if tex:
        return f".. math::\n   :nowrap:\n\n   {tex}\n\n"
    rows = definitions(re.sub(r"::\s*$", ":", block))
    two = all(ROW.fullmatch(line) for line in block.splitlines() if line[:1].strip())
    # Words beside words; more columns, lines and corners, or a line alone are a drawing.
    if (
        rows
        and two
        and "\n" in block
        and all(re.match(r"[\w`\"]", a) and not DRAWN.search(b) for a, b in rows)
    ):
        return definition_list(rows, scope)
    return ".. code-block:: text\n   :class: drawing\n\n" + indent(block, "   ") + "\n\n"


def table(rows: list[str], scope: Scope) -> str:
    """Rows between bars, the second of them a line, as a table with a head."""
    lines = []
    for n, row in enumerate(rows):
        if n != 1:
            cells = [line_of(cell.strip(), scope) for cell in row.strip().strip("|").split("|")]
            lines.append("   * - " + "\n     - ".join(cells))
    return ".. list-table::\n   :header-rows: 1\n\n" + "\n".join(lines) + "\n\n"


def told(paragraph: str, scope: Scope) -> str:
    """A paragraph that is not indented."""
    lines = paragraph.splitlines()
    if len(lines) > 2 and re.fullmatch(r"\|( *-+ *\|)+", lines[1]):
        return table(lines, scope)
    # Two columns between two rules.
    if len(lines) > 2 and {*lines[0]} == {*lines[-1]} == {"=", " "}:
        paragraph = "\n".join(lines[1:-1])
    if paragraph.startswith(">>>"):
        return ".. code-block:: pycon\n\n" + indent(paragraph, "   ") + "\n\n"
    numbered = re.split(r"^(?:\[(\d+)\]|(\d+)\.) ", paragraph, flags=re.MULTILINE)
    if (
        len(numbered) > 1
        and not numbered[0].strip()
        and (numbered[1] or numbered[2]) in scope.references
    ):
        entries = zip(numbered[1::3], numbered[2::3], numbered[3::3], strict=True)
        return "".join(
            reference(a or b, text, scope.references[a or b], scope) for a, b, text in entries
        )
    rows = definitions(paragraph)
    alone = re.match(r"\*{0,2}\w+ : \S", paragraph) or ROW.match(paragraph)
    if rows and (len(paragraph.splitlines()) > 1 or alone):
        return definition_list(rows, scope)
    if re.search(r"\S {3,}\S", paragraph):
        return ".. code-block:: text\n   :class: drawing\n\n" + indent(paragraph, "   ") + "\n\n"
    listed = re.match(r"([-*]|\d+\.) ", paragraph)
    if listed:
        items = re.split(r"^(?=(?:[-*]|\d+\.) )", paragraph, flags=re.MULTILINE)
        return "".join(item_of(item, scope) for item in items if item) + "\n"
    # Indented lines under a line of prose are a drawing or formulas of it.
    head, _, under = re.sub(r"\n(?= {3,})", "\0", paragraph, count=1).partition("\0")
    if under and all(line.startswith("   ") for line in under.splitlines()):
        return line_of(re.sub(r"\s*::$", ":", head), scope) + "\n\n" + drawn(under, scope)
    return line_of(paragraph, scope) + "\n\n"


def item_of(item: str, scope: Scope) -> str:
    """An item of a list."""
    mark, _, text = item.partition(" ")
    return f"{mark} {line_of(' '.join(text.split()), scope)}\n"


def slug(title: str) -> str:
    """A heading as a part of a label."""
    return re.sub(r"\W+", "-", title).strip("-").casefold()
