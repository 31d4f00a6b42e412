"""Works that the site cites: a link where one is named, a page of all, and none without an address.

A sentence names a work by its author with the year behind it, "Nielson and Hamann (1991)": the year
becomes a link to the work's DOI. A reference of a module, a claim's source or a sentence that names
what `docs/bibliography.toml` does not have is a warning, and so stops the build.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util import logging

from isosite.evidence import ROOT
from isosite.modules import Module, everywhere, label_of
from isosite.prose import (
    address_of,
    bibliography,
    escaped,
    heading,
    link_of,
    mentions,
    papers_of,
)
from isosite.writing import Pages

logger = logging.getLogger(__name__)

# Two names, or one with others, or a year in brackets: a work. A lone name before a year may be
# anything.
NAMED = re.compile(
    r"\b([A-ZÄÖÜ][\w-]+)(?:,? (?:&|and) (?:others|[A-ZÄÖÜ][\w-]+),? \(?| \()((?:19|20)\d\d)\b"
)
# What our own programs are called, behind which a year may stand.
OURS = {"Python", "Visualization", "November"}
# Pages whose sentences are searched; articles have references with numbers.
TEXTS = (
    "course/",
    "papers/",
    "reports/papers/",
    "benchmarks/",
    "auto_examples/",
    "learn/",
    "readme",
)
SOURCES = (
    "docs/course/*.rst",
    "docs/examples/*.py",
    "docs/learn/*.md",
    "papers/**/*.md",
    "reports/papers/**/*.md",
    "reports/benchmarks/*.md",
    "README.md",
)


def references(module: Module) -> list[str]:
    """The module's numbered references."""
    part = re.search(r"^References\n-+\n(.*)", module.doc, re.DOTALL | re.MULTILINE)
    if part is None:
        return []
    rows = re.split(r"^(?:\[\d+\]|\d+\.) ", part[1], flags=re.MULTILINE)
    return [" ".join(row.split()) for row in rows[1:]]


def unknown_in(text: str) -> list[str]:
    """What the text names like a work, and the bibliography does not have."""
    years = {place for _, place in mentions(text)}
    return [m[0] for m in NAMED.finditer(text) if m.span(2) not in years and m[1] not in OURS]


def unknown() -> list[str]:
    """Where a work is named that the bibliography does not have, and what it calls it."""
    from isograde.claims import CLAIMS

    found = [
        f"{name}: {text}"
        for name, module in everywhere().items()
        for text in references(module)
        if not papers_of(text)
    ]
    found += [
        f"{claim.id}: {claim.source}"
        for claim in CLAIMS.values()
        if re.search(r"\b(?:19|20)\d\d\b|\[\d+\]", claim.source) and not papers_of(claim.source)
    ]
    for pattern in SOURCES:
        for path in sorted(ROOT.glob(pattern)):
            text = path.read_text(encoding="utf-8")
            found += [f"{path.relative_to(ROOT)}: {one}" for one in unknown_in(text)]
    return found


def without_address() -> list[str]:
    """Works that have neither a DOI nor another address with the reason why."""
    return [
        f"{paper['author']} {paper['year']}"
        for paper in bibliography()
        if "doi" not in paper and not ("why" in paper and {"url", "isbn"} & paper.keys())
    ]


def citing(paper: dict[str, str]) -> tuple[list[str], list[str]]:
    """Modules and claims that cite the work."""
    from isograde.claims import CLAIMS

    modules = [
        name
        for name, module in everywhere().items()
        if any(paper in papers_of(text) for text in references(module))
    ]
    return modules, [claim.id for claim in CLAIMS.values() if paper in papers_of(claim.source)]


def page() -> str:
    """The page of all works, with where each is and who cites it."""
    text = heading("Works", "=", "works")
    text += (
        f"The {len(bibliography())} papers, books and notes that this site cites, by author. "
        "A title is given as far as it tells the work from others. Articles and claims that rest "
        "on one are linked behind it; where none is, a guided reading or a lesson names it.\n\n"
    )
    for paper in bibliography():
        modules, claims = citing(paper)
        links = [f":ref:`{name} <{label_of(name)}>`" for name in modules]
        links += [f":ref:`{one} <claim.{one}>`" for one in claims]
        # Initials at the beginning number nothing.
        row = f"\\{escaped(paper['authors'])}, *{escaped(paper['title'])}*, {paper['year']}. "
        row += link_of(paper) + ("" if not links else ". In " + ", ".join(links))
        text += f"* {row}\n"
    return text + "\n"


def write(pages: Pages) -> None:
    """Write the page, and warn of what has no address."""
    for one in unknown():
        logger.warning("no such work in docs/bibliography.toml: %s", one)
    for one in without_address():
        logger.warning("neither a DOI nor an address with a reason: %s", one)
    pages.put("papers/works.rst", page())


def links(app: Sphinx, tree: nodes.document) -> None:
    """Make the years of works that sentences name links to them."""
    if app.env.docname.startswith(TEXTS) and app.env.docname != "papers/works":
        for paragraph in list(tree.findall(nodes.paragraph)):
            link_years(paragraph)


def link_years(paragraph: nodes.paragraph) -> None:
    """Put a link where the paragraph has a work's year in its text."""
    linked = {link.get("refuri") for link in paragraph.findall(nodes.reference)}
    places = {
        place: paper
        for paper, place in mentions(paragraph.astext())
        if address_of(paper)[1] not in linked
    }
    for text, start in list(texts(paragraph)):
        inside = {p: paper for p, paper in places.items() if start <= p[0] < start + len(text)}
        if not inside or not free(text):
            continue
        parts: list[nodes.Node] = []
        at = 0
        for (begin, end), paper in sorted(inside.items(), key=lambda one: one[0]):
            _, address = address_of(paper)
            if not address:
                continue
            year = text[begin - start : end - start]
            link = nodes.reference("", year, refuri=address, internal=False)
            parts += [nodes.Text(text[at : begin - start]), link]
            at = end - start
        text.parent.replace(text, [*parts, nodes.Text(text[at:])])


def texts(paragraph: nodes.paragraph) -> Iterator[tuple[nodes.Text, int]]:
    """The paragraph's pieces of text, and where each begins in it."""
    at = 0
    for text in paragraph.findall(nodes.Text):
        yield text, at
        at += len(text)


def free(text: nodes.Text) -> bool:
    """The text is no code, formula or link."""
    node = text.parent
    while node is not None and not isinstance(node, nodes.paragraph):
        if isinstance(node, (nodes.literal, nodes.math, nodes.reference, nodes.raw)):
            return False
        if type(node).__name__ in ("pending_xref", "download_reference"):
            return False
        node = node.parent
    return True


def setup(app: Sphinx) -> None:
    """Tell Sphinx of the links."""
    app.connect("doctree-read", links)
