"""One reading order: the package's docstring, the site and the README say the same."""

import ast
import re
from pathlib import Path

import isoref
import pytest

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "reference" / "isoref"
ORDER = re.findall(r"`(\w+)`", (isoref.__doc__ or "").partition("Read in this order:")[2])


def chapters() -> dict[str, tuple[str, ...]]:
    """The chapters of the site, read out of its program."""
    tree = ast.parse((ROOT / "docs" / "conf.py").read_text(encoding="utf-8"))
    values = [
        ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "CHAPTERS"
    ]
    found: dict[str, tuple[str, ...]] = values[0]
    return found


def test_the_order_names_every_article_once() -> None:
    """Beginning with the drawings of 1987."""
    modules = {path.stem for path in PACKAGE.glob("*.py")} - {"__init__"}
    assert ORDER[0] == "lorensen_cline"
    assert sorted(ORDER) == sorted(modules)


def test_the_site_has_the_same_order_and_the_twins_behind_it() -> None:
    """`docs/conf.py`: chapters of articles, then the twins."""
    named = [name for chapter in chapters().values() for name in chapter]
    twins = [name for name in named if name.startswith("fast.")]
    assert named == [*ORDER, *twins]
    assert set(twins) == {f"fast.{p.stem}" for p in (PACKAGE / "fast").glob("*.py")} - {
        "fast.__init__"
    }


def test_the_readme_has_the_same_order() -> None:
    """The table of modules, row by row; it may leave out what only serves others."""
    text = (ROOT / "README.md").read_text(encoding="utf-8").partition("## Use the reference")[2]
    rows = re.findall(r"^\| (`.*?) \|", text.partition("\n## ")[0], re.MULTILINE)
    named = [name for row in rows for name in re.findall(r"`(\w+)`", row)]
    assert len(named) > 10
    assert named == [name for name in ORDER if name in named]


@pytest.mark.parametrize("twin", sorted(p.stem for p in (PACKAGE / "fast").glob("[a-z]*.py")))
def test_each_twin_has_an_article_of_its_name(twin: str) -> None:
    """Design: `isoref/fast/<same name>.py`."""
    assert twin in ORDER
