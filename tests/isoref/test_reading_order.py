"""One reading order: that of the docstring, from which the site has it, is the README's too."""

import re
from pathlib import Path

import isoref
import pytest

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "reference" / "isoref"
ORDER = re.findall(r"`(\w+)`", (isoref.__doc__ or "").partition("Read in this order:")[2])


def test_the_order_names_every_article_once() -> None:
    """Beginning with the drawings of 1987."""
    modules = {path.stem for path in PACKAGE.glob("*.py")} - {"__init__"}
    assert ORDER[0] == "lorensen_cline"
    assert sorted(ORDER) == sorted(modules)


def test_the_readme_has_the_same_order() -> None:
    """The table of modules, row by row; it may leave out what only serves others."""
    text = (ROOT / "README.md").read_text(encoding="utf-8").partition("## Use the reference")[2]
    rows = re.findall(r"^\| (`.*?) \|", text.partition("\n## ")[0], re.MULTILINE)
    named = [name for row in rows for name in re.findall(r"`(\w+)`", row)]
    assert len(named) > 10
    assert named == [name for name in ORDER if name in named]


# `slabs` is the fast sweep again, for volumes that stay in their files, and `bricks` for many
# isovalues: the article is `sweep`.
TWINS = sorted({p.stem for p in (PACKAGE / "fast").glob("[a-z]*.py")} - {"slabs", "bricks"})


@pytest.mark.parametrize("twin", TWINS)
def test_each_twin_has_an_article_of_its_name(twin: str) -> None:
    """Design: `isoref/fast/<same name>.py`."""
    assert twin in ORDER
