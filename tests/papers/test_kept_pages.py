"""The kept pages hold what their programs say today: sentences and tables that take no time."""

import re
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


READINGS = Path(__file__).parents[2] / "papers"


def reading(paper: str) -> str:
    """The README of a paper's folder, on one line."""
    return joined((READINGS / paper / "README.md").read_text(encoding="utf-8"))


def rows(name: str, start: str = "") -> list[list[str]]:
    """The cells of the lines of tables of a kept page that begin with this cell's text."""
    lines = (REPORTS / name).read_text(encoding="utf-8").splitlines()
    found = [line for line in lines if line.startswith(f"| {start}")]
    assert found, f"{name}: no row {start!r}"
    return [[cell.strip() for cell in line.strip().strip("|").split(" | ")] for line in found]


def number(text: str) -> float:
    """The number that a cell begins with."""
    found = re.match(r"[+-]?[\d,]+(\.\d+)?", text)
    assert found, text
    return float(found[0].replace(",", ""))


@pytest.mark.parametrize(
    ("paper", "said", "page", "held"),
    [
        ("trilinear", "on the isovalue", "trilinear/tied.md", "0 triangles are without area"),
        ("trilinear", "keeps one vertex and four edges on blocks", "trilinear/tied.md",
         "| asymptotic-decider | apart | 5,800 | 0 | 1 | 4 | 64 |"),
        ("trilinear", "nearly tied, 29 pairs do, where none did", "trilinear/tied.md",
         "| trilinear-cubes | apart | 13,747 | 0 | 0 | 0 | 29 |"),
        ("trilinear", "the topologies that all three axes allow are 768", "trilinear.md",
         "| topologies of a cell with numbered corners | | | 768 |"),
        ("trilinear", "Of 64 decisions on the faces of configuration 13 only 46", "trilinear.md",
         "| face decisions of configuration 13 | 64 | | 46 |"),
        ("trilinear", "without the exchange they are 57", "trilinear.md",
         "| up to rotation alone | | | 57 |"),
        ("trilinear", "About one random cell in 216", "trilinear.md",
         "Cells with a tunnel: 2,317 of 500,000 "),
        ("trilinear", "jumps by a third of a cell's side", "trilinear/continuity.md",
         "from 0.41 to 0.32 of a cell's side as the step goes from 0.01 to 1e-06"),
        ("nielson_hamann_1991", "**Nine of 26 triangulations**", "nielson_hamann_1991.md",
         "17 of 26 lists fill their boundary polygons as scanned, 9 do once"),
        ("nielson_hamann_1991", "reads 304. It is 340", "nielson_hamann_1991.md",
         "| 9 | 304 | 340 | differs by +36 |"),
        ("nielson_hamann_1991", "0.5679 Example 2", "nielson_hamann_1991.md",
         "## Table 1, Example 2, isovalue 0.5679"),
        ("nielson_hamann_1991", "0.4633 reproduces Example 3", "nielson_hamann_1991.md",
         "## Table 1, Example 3, isovalue 0.4633"),
        ("schlei_2010", "at least 1807 for its 150", "schlei_2010.md", "| bunny | 1807 | mixed |"),
        ("schlei_2010", "the same cycles in all 254 cells and cut 34 of the 162", "schlei_2010.md",
         "Of the 162 oriented cycles 34 are cut in one way in one cell"),
        ("schlei_2010", "there are 16: three kinds of 12-cycle", "schlei_2010.md",
         "of types, 2 of the 3 types of 12-cycle"),
        ("schlei_2010", "932,739 and should read 934,304", "schlei_2010.md",
         "| III, mixed: L points | 932,739 | 934,304 | differs by +1,565 |"),
        ("schlei_2010", "it lacks those 1,565 averages", "schlei_2010.md",
         "do not contain these 1,565 points"),
        ("schlei_2010", "none of its 970,299 cells", "schlei_2010.md",
         "0 of its 970,299 cells alternate"),
        ("ljung_ynnerman", "487 thousand triangles and 42 thousand segments", "ljung_ynnerman.md",
         "| primitives, real | 310,627 | 486,901 |"),
        ("ljung_ynnerman", "the captions say 311 and 17 thousand", "ljung_ynnerman.md",
         "| primitives, lines | 17,104 | 41,787 |"),
        ("ljung_ynnerman", "every threshold tried from 1e-12 to 0.3", "ljung_ynnerman/methods.md",
         "0.3 h is wrong on 2 of 13."),
        ("min_2003", "none of the three facets of type (3, 2)", "min_2003.md",
         "on 4 of their 4 facets of that type, rows (3, 3) on 0 of 3"),
        ("min_2003", "the others to within 90 segments", "min_2003.md",
         "| N = 128 | 51,120 | 49,032 | differs by -2,088 | -87 segments |"),
        ("min_2003", "144 + 768 k", "min_2003.md", "The sizes of phi in Table 7 are 144 + 768 k"),
        ("custodio_2013", "2,580 of the 10,000 grids are distinct", "custodio_2013.md",
         "| distinct grids | 2,580 | measured | one of them 7 times |"),
    ],
)  # fmt: skip
def test_a_number_of_a_reading_is_that_of_its_page(
    paper: str, said: str, page: str, held: str
) -> None:
    """Who changes one of the two has to change the other."""
    assert said in reading(paper)
    assert re.sub(r" +", " ", held) in kept(page)


def test_who_has_all_tunnels_and_who_crowds_a_face() -> None:
    """The reading of the trilinear interpolant, beside the page of every implementation."""
    page, said = "trilinear/implementations.md", reading("trilinear")
    asked = [row for row in rows(page) if len(row) == 10 and row[8].isdigit()]
    assert len(asked) > 40
    assert [row[0] for row in asked if row[7] == "1,876 of 1,876"] == ["isoref:trilinear-cubes"]
    assert "only trilinear cubes has" in said
    judged = [row for row in asked if row[5]]
    crowding = {row[0]: int(row[5]) for row in judged if int(row[5])}
    assert {name.split(":")[0]: n for name, n in crowding.items()} == {
        "pymeshlab": 2, "skimage": 2, "trimesh": 3,
    }  # fmt: skip
    assert "in 2 with either library, in 3 with trimesh" in said
    crossing = {row[0]: int(row[8]) for row in asked if int(row[8])}
    assert crossing == {"manifold3d": 15}
    noise = [row for row in rows(page) if len(row) == 9 and row[6].isdigit()]
    assert len(noise) > 35
    found = {row[0]: (row[6], row[7]) for row in noise if row[6:8] != ["0", "0"]}
    assert found == {"manifold3d": ("27", "34")}
    assert "15 pairs on 125 islands of cells, 27 in the noise" in said


def test_tunnels_in_real_volumes() -> None:
    """90 among some 18,700 cells."""
    own = [row for row in rows("trilinear.md") if " with a tunnel;" in row[-1]]
    cells = sum(number(row[2]) for row in own)
    assert sum(number(row[-1]) for row in own) == 90
    assert round(cells, -2) == 18_700
    assert "there are 90 among some 18,700 cells" in reading("trilinear")


def test_averages_and_saddles_disagree_on_about_one_ambiguous_face_in_ten() -> None:
    """Over all scans of the page together."""
    own = [row for row in rows("schlei_2010.md") if len(row) == 4 and row[3].endswith(" %")]
    assert len(own) == 10
    share = sum(number(row[2]) for row in own) / sum(number(row[1]) for row in own)
    assert 0.09 < share < 0.12
    assert "on about one ambiguous face in ten" in reading("schlei_2010")


def test_exponents_of_figure_6() -> None:
    """Up to about a percent off as fitted, within half a percent with both corrections."""
    own = [row for row in rows("ljung_ynnerman.md") if " over s" in row[0]]
    off = {row[0] + row[4][:8]: abs(number(row[2]) / number(row[1]) - 1) for row in own}
    bent = [row for row in own if row[4].startswith("the bend")]
    assert [row[0] for row in bent] == ["n1 over s", "trisect over s", "xface over s + 1"]
    assert all(abs(number(row[2]) / number(row[1]) - 1) < 0.005 for row in bent)
    assert 0.008 < max(off.values()) < 0.015
    assert "within half a percent" in reading("ljung_ynnerman")


def test_orders_of_the_known_fireball() -> None:
    """The table of items says of which quantity the order is the formal one."""
    own = rows("schlei_2010/hypersurfaces.md")
    orders = {row[0]: row for row in own if row[0].endswith(": order")}
    assert len(orders) == 4
    assert all(("volume" in name) == row[3].startswith("differs") for name, row in orders.items())
    assert {round(number(row[2]), 2) for n, row in orders.items() if "volume" in n} == {1.92}
    table = joined((READINGS / "README.md").read_text(encoding="utf-8"))
    assert "the volume in space-time differs: 1.92, and 1.96 of the two finest" in table


def test_how_near_table_7_comes() -> None:
    """By the paper's own tables at three sizes, by the staircase at all four."""
    by_both = [row for row in rows("min_2003.md") if len(row) == 8 and row[-1].endswith("%")]
    assert [row[0] for row in by_both] == ["8", "16", "32"]
    assert max(abs(number(row[1]) / number(row[2]) - 1) for row in by_both) < 0.031
    surface = [row for row in rows("min_2003.md", "N = ") if row[4].endswith(" triangles")]
    assert len(surface) == 4
    assert max(abs(number(row[1]) / number(row[2]) - 1) for row in surface) < 0.065
    table = joined((READINGS / "README.md").read_text(encoding="utf-8"))
    assert "within 3.1 % at N = 8, 16 and 32" in table
    assert "within 6.5 % at all four N with the staircase" in table
