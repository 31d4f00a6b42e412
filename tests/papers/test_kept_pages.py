"""The kept pages hold what their programs say today: sentences and tables that take no time."""

from pathlib import Path

import pytest

from tests.papers.loading import importer

REPORTS = Path(__file__).parents[2] / "reports" / "papers"


def kept(name: str) -> str:
    """A kept page, its lines joined by spaces: how a sentence is broken does not matter."""
    return joined((REPORTS / name).read_text(encoding="utf-8"))


def joined(text: str) -> str:
    """The text on one line."""
    return " ".join(text.split())


def test_nielson_and_hamann() -> None:
    """The printed lists, the formula as scanned, and configuration 13."""
    reproduce, page = importer("nielson_hamann_1991")("reproduce"), kept("nielson_hamann_1991.md")
    assert joined(reproduce.lists_text(reproduce.check_all())) in page
    assert joined(reproduce.formula_table().markdown()) in page
    assert joined(reproduce.reachable()) in page
    assert joined(reproduce.first_example().markdown()) in page


def test_schlei(tmp_path: Path) -> None:
    """Sections II.F, II.G, and what the identities of Tables II to IV say."""
    reproduce, page = importer("schlei_2010")("reproduce"), kept("schlei_2010.md")
    parts = [reproduce.paths(), *reproduce.section_g(tmp_path), *reproduce.identities()]
    assert len(parts) > 5
    for part in parts:
        text = part if isinstance(part, str) else part.markdown()
        assert joined(text) in page


def test_ljung_and_ynnerman() -> None:
    """Table 1 beside Figure 1."""
    reproduce, page = importer("ljung_ynnerman")("reproduce"), kept("ljung_ynnerman.md")
    assert joined(reproduce.consistency().markdown()) in page
    assert joined(reproduce.words.of_which_waves(*reproduce.of_both())) in page


def test_min(tmp_path: Path) -> None:
    """Tables 1 to 4, and what is said of the printed bytes and the printed constant."""
    reproduce, page = importer("min_2003")("reproduce"), kept("min_2003.md")
    words, tables = reproduce.words, reproduce.TABLES
    seven = tables["table_7"]["rows"]
    columns = ([row[i] for row in seven] for i in (1, 3))
    parts = [
        *reproduce.sections(tmp_path, False),
        words.table_5(tables["table_5"]["rows"], reproduce.SEGMENT_BYTES),
        words.table_7(*columns, reproduce.TRIANGLE_BYTES),
        words.constant(tables["constant_7_3"], reproduce.examples.spindle_constants()),
    ]
    for part in parts:
        text = part if isinstance(part, str) else part.markdown()
        assert joined(text) in page


def test_trilinear() -> None:
    """How many cases there are, which are mirror images, and how the page on drawing opens."""
    load = importer("trilinear")
    reproduce, drawing = load("reproduce"), load("drawing")
    table, _, shown = reproduce.how_many_cases(share=1000)
    for text in (table.markdown(), shown):
        assert joined(text) in kept("trilinear.md")
    for text in (drawing.OPENING, drawing.READING):
        assert joined(text) in kept("trilinear/drawing.md")
    libraries = load("libraries")
    for text in (libraries.SUMMARY, libraries.NEAR, libraries.ORDERS):
        assert joined(text) in kept("trilinear/implementations.md")


@pytest.mark.parametrize("name", ["trilinear/drawing.md", "custodio_2013.md"])
def test_nothing_differs_on_a_page_of_what_must_be(name: str) -> None:
    """Verdicts of pages whose every row is expected to be exact."""
    page = kept(name)
    assert page.count("| exact |") > 4
    assert "differs" not in page
