"""The site's reading of formulas: what is one becomes mathematics, and words stay words."""

from __future__ import annotations

import importlib
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
from isosite import articles
from isosite.formulas import as_tex, displayed, symbol, with_formulas
from isosite.mathml import mathml
from isosite.modules import banners, modules
from isosite.prose import Scope, line_of, rst_of
from pictures import REGISTERED


@pytest.mark.parametrize(
    ("source", "tex"),
    [
        ("S = (a c - b d) / (a + c - b - d)", r"S = \frac{a\, c - b\, d}{a + c - b - d}"),
        ("c1^2 - 4 c0 c2", r"{c_{1}}^{2} - 4\, c_{0}\, c_{2}"),
        ("0 <= v_(k-1) < e'", r"0 \le v_{k-1} < e'"),
        ("|phi(b) - phi(a)|", r"|\phi(b) - \phi(a)|"),
        ("sqrt(x^2 + 1)", r"\sqrt{{x}^{2} + 1}"),
        ("-a", "-a"),
        ("(n - m)! / n!", r"\frac{(n - m)!}{n!}"),
    ],
)
def test_a_formula_of_the_source_is_read(source: str, tex: str) -> None:
    """The grammar in the module's docstring."""
    assert as_tex(source) == tex
    ElementTree.fromstring(mathml(tex, display=True))


@pytest.mark.parametrize(
    "text", ["the saddle", "a = ", "(a", "a )", "min", "S == T ==", "x_", "Fig. 2"]
)
def test_what_cannot_be_read_is_left(text: str) -> None:
    """No half of a formula is shown as one."""
    assert as_tex(text) is None


@pytest.mark.parametrize(
    "text",
    [
        "A cell in a 2 x 2 x 2 block, a 3-cycle and the n-th of 0 .. 7; see sections 1 - 3.",
        "I have an end; a point on a face, either/or, x-axis.",
        "``a + b`` and *a + b* and `a + b` are marked already.",
        "A line [1] of text.",
        "Samples on a 3-D lattice; NASA TN D-5541; IEICE Transactions E74(1).",
    ],
)
def test_words_are_no_formulas(text: str) -> None:
    """Prose without a formula comes out as it was."""
    assert with_formulas(text) == text


def test_formulas_are_found_among_words() -> None:
    """The longest run that says something; an article before it is left alone."""
    assert with_formulas("where a = B00, and a c < b d holds.") == (
        r"where :math:`a = B_{00}`, and :math:`a\, c < b\, d` holds."
    )
    assert with_formulas("a k-simplex where k = n - m") == "a k-simplex where :math:`k = n - m`"
    assert with_formulas("f(x) = 0 or 1") == ":math:`f(x) = 0` or 1"
    # Each by itself, so that a narrow line may end between them.
    assert with_formulas("a = b, c = d") == ":math:`a = b`, :math:`c = d`"


def test_symbols_that_stand_alone_are_mathematics() -> None:
    """A letter with an index, in a row or a list too; words and names of code stay words."""
    assert with_formulas("The vertices v_0 .. v_n come") == (
        r"The vertices :math:`v_{0}\, \dots\, v_{n}` come"
    )
    assert with_formulas("x_1, x_2, .. be points") == ":math:`x_{1}`, :math:`x_{2}`, .. be points"
    assert with_formulas("a field phi") == r"a field :math:`\phi`"
    assert with_formulas("phi^ at the points") == r":math:`\hat{\phi}` at the points"
    assert with_formulas("phi^2 = 1") == r":math:`{\phi}^{2} = 1`"
    for words in ("n_jobs and a_b_c", "x and n, m", "a lambda, an epsilon"):
        assert with_formulas(words) == words


def test_a_block_is_mathematics_only_if_every_line_is() -> None:
    """A drawing with a formula in it stays a drawing."""
    assert (
        displayed("  a = b\n  c < d    where it ends")
        == r"a = b \\ c < d \qquad \text{where it ends}"
    )
    assert displayed("  a = b\n  o-----o") is None
    assert displayed("  one word") is None


def test_symbols_have_their_indices() -> None:
    """Digits behind a letter are an index, as papers write them."""
    assert [symbol(s) for s in ("B00", "c_1", "alpha", "w_(i+1)")] == [
        "B_{00}",
        "c_{1}",
        r"\alpha",
        "w_{i+1}",
    ]


def test_every_formula_of_the_reference_becomes_mathematics() -> None:
    """MathML without an error or a rest of TeX, for each formula that is found in isoref."""
    formulas = set()
    for module in modules("isoref").values():
        text = rst_of(module.doc, Scope())
        for part in module.definitions().values():
            text += (
                line_of(part.doc.partition("\n")[0], Scope()) + "\n\n" + rst_of(part.doc, Scope())
            )
        formulas |= set(re.findall(r":math:`(.+?)`", text, re.DOTALL))
        formulas |= {m.strip() for m in re.findall(r"\.\. math::\n   :nowrap:\n\n   (.+)\n", text)}
    assert len(formulas) > 150
    for tex in formulas:
        ElementTree.fromstring(mathml(tex, display=False))


def test_a_formula_that_words_follow_at_once_ends_where_it_ends() -> None:
    """A bracket right behind a role would keep it open: a space that is not shown is between."""
    assert line_of("where (1 - u) e(top) is", Scope()) == r"where :math:`(1 - u)\, e`\ (top) is"


def test_words_beside_words_are_definitions_and_drawings_stay() -> None:
    """One row or several, indented or not; what has lines, arrows or more columns is a drawing."""
    told = rst_of("Title.\n\nGlossary\n--------\nlabel       1 where it is inside", Scope())
    assert ".. container:: glossary-rows\n\n   label\n      1 where it is inside" in told
    told = rst_of(
        "Title.\n\nThey are:\n\n    block       of cells\n    two words   beside", Scope()
    )
    assert "   block\n      of cells" in told
    assert "   two words\n      beside" in told
    for drawing in (
        "o-----o     a square\n    |     |     of four",
        "edge    a point     by a line",
        "3 inside    2 inside",
    ):
        assert ":class: drawing" in rst_of(f"Title.\n\nThis:\n\n    {drawing}", Scope())


def test_tables_of_the_source_are_tables() -> None:
    """Between bars, with a head; and between rules, as definitions."""
    told = rst_of("Title.\n\n| a | b |\n| --- | --- |\n| x, y | what `z` is |", Scope())
    assert ".. list-table::\n   :header-rows: 1\n\n   * - a\n     - b\n" in told
    assert "   * - x, y\n     - what ``z`` is\n" in told
    told = rst_of("Title.\n\n=====  =====\nmany   ties\nfew    none at all\n=====  =====", Scope())
    assert "   few\n      none at all" in told
    assert "==" not in told


def test_errors_of_two_kinds_are_one_list() -> None:
    """As those of one kind are."""
    doc = "Title.\n\nRaises\n------\nValueError\n    for one\nFieldError\n    for another"
    told = rst_of(doc, Scope())
    assert "   ValueError\n      for one\n\n   FieldError\n      for another" in told


def test_headings_of_the_source_are_headings() -> None:
    """On one line or between two, and what stands before and behind them is kept."""
    bar = "# " + "-" * 40
    text = f"x = 1\n# --- a b {'-' * 9}\n# why\n{bar}\n# c\n{bar}\ny = 2"
    assert banners(text) == [("x = 1\n", "a b"), ("\n# why\n", "c"), ("\ny = 2", "")]


def test_no_symbol_for_something_unknown_is_shown() -> None:
    """A formula that cannot be read is an error with its text, not a red box on the page."""
    with pytest.raises(ValueError, match="foo"):
        mathml(r"\foo{", display=False)


def test_the_reference_has_its_formulas_where_its_papers_have_them() -> None:
    """The decider's saddle and the quadratic of the tunnel are displayed or inline mathematics."""
    decider = modules("isoref")["isoref.asymptotic_decider"].definitions()["saddle"].doc
    assert r"\,B_{11} - B_{01}\, B_{10}" in rst_of(decider, Scope()).replace(
        r"\, B_{11}", r"\,B_{11}"
    )
    tunnel = modules("isoref")["isoref.trilinear_cubes"].doc
    assert ".. math::" in rst_of(tunnel, Scope())


def test_a_picture_beside_nothing_is_told() -> None:
    """Its name is a module's, a function's or a class's."""
    articles.check_pictures({"hero": "", "isoref.sweep": "", "isoref.sweep.sweep": ""})
    with pytest.raises(ValueError, match=r"isoref\.methods\.METHODS"):
        articles.check_pictures({"isoref.methods.METHODS": ""})


def test_every_article_of_the_reference_that_is_no_twin_has_a_picture() -> None:
    """Issue 17: pictures beside the paragraph that they explain."""
    importlib.import_module("isosite.pictures").register()
    shown = {place for place, _ in REGISTERED.values()}
    lacking = [
        name
        for name in modules("isoref")
        if ".fast" not in name
        and name != "isoref"
        and not any(place == name or place.startswith(f"{name}.") for place in shown)
    ]
    assert lacking == []


def test_here_is_the_site() -> None:
    """The modules under test are those of docs."""
    assert (
        Path(as_tex.__code__.co_filename).parent
        == Path(__file__).parents[2] / "docs" / "_ext" / "isosite"
    )


def test_a_word_in_a_formula_is_one_name() -> None:
    """Lesson 1 says *low* and *high*."""
    made = mathml(r"\mathit{low} < \mathit{high}", display=True)
    assert '<mi class="word">low</mi>' in made
    assert '<mi class="word">high</mi>' in made
    assert "italic" not in made
