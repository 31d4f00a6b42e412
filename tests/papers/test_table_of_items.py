"""The table of items in papers/README.md names what is there."""

import re
from pathlib import Path

import pytest

from tests.papers.loading import importer

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "papers" / "README.md").read_text(encoding="utf-8")
SECTIONS = {
    "Nielson & Hamann 1991": "nielson_hamann_1991",
    "Schlei 2010": "schlei_2010",
    "Ljung & Ynnerman": "ljung_ynnerman",
    "Min 2003": "min_2003",
}


def rows(section: str) -> list[list[str]]:
    """The cells of each row of a section's table."""
    own = TEXT.partition(f"### {section}\n")[2].partition("\n### ")[0]
    lines = [line for line in own.splitlines() if line.startswith("| ") and "---" not in line]
    return [[cell.strip() for cell in line.strip("| ").split(" | ")] for line in lines][1:]


@pytest.mark.parametrize("section", SECTIONS)
def test_every_item_has_a_place_and_a_verdict(section: str) -> None:
    """Three cells a row, none empty, and nothing is said to be missing."""
    found = rows(section)
    assert len(found) > 15
    for row in found:
        assert len(row) == 3
        assert all(row)
        assert "missing" not in row[2]


@pytest.mark.parametrize("section", SECTIONS)
def test_every_place_exists(section: str) -> None:
    """Modules of isoref, files of the paper's folder, and tests."""
    folder = ROOT / "papers" / SECTIONS[section]
    named = [name for row in rows(section) for name in re.findall(r"`([\w./]+)`", row[1])]
    assert named
    for name in named:
        module = name.split("(")[0].split(".")[0]
        places = [
            ROOT / "reference" / "isoref" / f"{module}.py",
            folder / name,
            ROOT / "papers" / name,
            ROOT / "tests" / "isoref" / name,
            ROOT / "tests" / "isograde" / name,
            ROOT / "tests" / "papers" / name,
        ]
        assert any(place.exists() for place in places), f"{section}: {name}"


def test_every_folder_has_a_program_a_reading_and_a_report() -> None:
    """As the first table says."""
    folders = re.findall(r"^\| \[(\w+)\]", TEXT, re.MULTILINE)
    assert sorted(folders) == sorted(
        p.parent.name for p in (ROOT / "papers").glob("*/reproduce.py")
    )
    for name in folders:
        assert (ROOT / "papers" / name / "README.md").is_file()
        assert (ROOT / "reports" / "papers" / f"{name}.md").is_file()


@pytest.mark.parametrize(
    "program",
    sorted((ROOT / "papers").glob("*/*.py")),
    ids=lambda path: f"{path.parent.name}/{path.stem}",
)
def test_every_program_of_the_papers_can_be_started(program: Path) -> None:
    """Each imports what it needs: a name that moved would be found by nobody else."""
    module = importer(program.parent.name)(program.stem)
    assert module.__doc__


PAGES = [
    *sorted((ROOT / "papers").rglob("*.md")),
    *sorted((ROOT / "reports" / "papers").rglob("*.md")),
]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_link_of_a_page_leads_somewhere(page: Path) -> None:
    """Links and pictures inside the repository, of the readings and of the reports."""
    links = re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
    inner = [link for link in links if not re.match(r"[a-z]+:", link)]
    assert [link for link in inner if not (page.parent / link).exists()] == []


def test_there_are_links_to_follow() -> None:
    """Pages, and links on them."""
    assert len(PAGES) > 15
    assert sum(page.read_text(encoding="utf-8").count("](") for page in PAGES) > 60
