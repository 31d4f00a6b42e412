"""Works that the site cites: each has its DOI, or an address and the reason why there is none."""

from __future__ import annotations

import logging
import re
from pathlib import Path

import pytest
from docutils import nodes
from docutils.core import publish_doctree
from isosite import prose, works
from isosite.repository import with_address
from isosite.writing import Pages


def test_every_work_that_is_cited_has_an_address() -> None:
    """Issue 17: papers have DOIs."""
    assert len(prose.bibliography()) > 50
    assert works.without_address() == []
    assert works.unknown() == []
    for paper in prose.bibliography():
        assert paper["author"] in paper["authors"]
        assert re.fullmatch(r"10\.\d{4,5}/\S+", paper.get("doi", "10.1000/1"))


def test_no_two_works_are_named_alike() -> None:
    """An author and a year, or an author and a title, belong to one work."""
    papers = prose.bibliography()
    assert papers
    for key in ("year", "title"):
        assert len({(one["author"], one[key]) for one in papers}) == len(papers)
    for one in papers:
        assert one in prose.papers_of(f"{one['authors']}, {one['title']}, {one['year']}")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("as Nobody and Someone (1999) wrote", ["Nobody and Someone (1999"]),
        ("as Min (1999) wrote", ["Min (1999"]),
        ("as Min (2003) and Nielson and Hamann (1991) wrote", []),
        ("IEEE Visualization (1991), under Python (2023)", []),
    ],
)
def test_a_work_that_nobody_wrote_is_told(text: str, told: list[str]) -> None:
    """Two authors, or one and a year in brackets, are a work; it must be in the bibliography."""
    assert works.unknown_in(text) == told


def test_the_build_is_refused_with_a_work_without_an_address(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """What is unknown or without an address is a warning, which `-W` turns into an error."""
    told: list[str] = []

    class Kept(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            told.append(record.getMessage())

    papers = [*prose.bibliography(), {"author": "Nobody", "year": "1999", "title": "Nothing"}]
    papers[-1]["authors"] = papers[-1]["isbn"] = "Nobody"
    monkeypatch.setattr(works, "bibliography", lambda: papers)
    monkeypatch.setattr(works, "unknown", lambda: ["page: Someone (1999"])
    kept = Kept()
    works.logger.logger.addHandler(kept)
    try:
        works.write(Pages(tmp_path))
    finally:
        works.logger.logger.removeHandler(kept)
    assert len(told) == 2
    assert "Someone (1999" in told[0]
    assert "Nobody 1999" in told[1]


def test_a_sentence_links_its_years_and_nothing_else() -> None:
    """The year alone, through marks too; code and what is a link already stay as they are."""
    paragraph = nodes.paragraph()
    paragraph += nodes.Text("Nielson's ")
    paragraph += nodes.emphasis("", "dual marching cubes")
    paragraph += nodes.Text(" (2004), and Lorensen and Cline, 1987; of 1987 ")
    paragraph += nodes.literal("", "Min (2003)")
    before = paragraph.astext()
    works.link_years(paragraph)
    assert paragraph.astext() == before
    assert [(r.astext(), r["refuri"]) for r in paragraph.findall(nodes.reference)] == [
        ("2004", "https://doi.org/10.1109/VISUAL.2004.28"),
        ("1987", "https://doi.org/10.1145/37401.37422"),
    ]


def test_a_reference_has_the_works_it_is_to_and_not_those_it_speaks_of() -> None:
    """By title; by author and year without one; two of them where a semicolon parts them."""

    def dois(text: str) -> list[str]:
        return [paper["doi"] for paper in prose.works_of(text)]

    steve = "B. R. Schlei, Hyper-surface extraction in four dimensions; section IV of"
    assert dois(f"{steve} Volume-enclosing surface extraction")[0] == "10.48550/arXiv.1302.5683"
    assert dois("C. Min, 2003: section 6") == ["10.1016/S0021-9991(03)00275-4"]
    assert len(dois("K. Brauner, 1928; M. R. Dennis et al., Isolated optical vortex knots")) == 2
    assert dois("D. Cohen-Steiner, J.-M. Morvan, 2003") == ["10.1145/777792.777839"]


def test_a_guided_reading_has_the_address_of_each_of_its_papers() -> None:
    """Behind its first paragraph; a paragraph without a title is left alone."""
    text = (
        "# A\n\nT. Etiene, *Topology verification for isosurface extraction*, 2012. L. Custodio,\n"
    )
    text += "*Practical considerations on Marching Cubes 33*, 2013.\n\nMore."
    assert re.findall(r"\[doi:([^\]]+)\]", with_address(text)) == [
        "10.1109/TVCG.2011.109",
        "10.1016/j.cag.2013.04.004",
    ]
    assert with_address("# A\n\nMin (2003).\n\nMore.") == "# A\n\nMin (2003).\n\nMore."


def test_the_page_of_works_numbers_nothing() -> None:
    """Initials at the beginning of a line would be the numbers of a list."""
    rows = [row for row in works.page().splitlines() if row.startswith("* ")]
    assert len(rows) == len(prose.bibliography())
    tree = publish_doctree(rows[0])
    assert tree.astext().startswith("T. F. Banchoff")
    assert not list(tree.findall(nodes.enumerated_list))
