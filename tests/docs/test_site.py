"""The site: it builds without a warning, and its links lead somewhere."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import nbformat
import pytest
from isosite import links

ROOT = Path(__file__).parents[2]


@pytest.mark.slow
def test_the_site_builds_without_a_warning_and_its_links_lead_somewhere(tmp_path: Path) -> None:
    """`make site` but for running the gallery, whose programs have tests of their own."""
    out = tmp_path / "site"
    command = [
        *(sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-j", "2"),
        *(
            "-D",
            "plot_gallery=0",
            "-d",
            str(tmp_path / "trees"),
            "-b",
            "html",
            str(ROOT / "docs"),
            str(out),
        ),
    ]
    done = subprocess.run(command, capture_output=True, encoding="utf-8", check=False)
    assert done.returncode == 0, done.stderr[-4000:]
    assert links.broken(out) == []
    article = (out / "articles" / "isoref" / "isoref.asymptotic_decider.html").read_text(
        encoding="utf-8"
    )
    assert article.count("<math") > 20
    assert "test_asymptotic_decider.html#" in article, "links to tests"
    assert "claims.html#claim-topology-bilinear" in article, "links to claims"
    assert "https://doi.org/10.1109/VISUAL.1991.175782" in article
    lessons = sorted((out / "_downloads" / "notebooks").glob("lesson_*.ipynb"))
    assert len(lessons) == len(list((ROOT / "docs" / "course").glob("lesson_*.rst"))) > 0
    programs = list((out / "_downloads" / "notebooks").glob("plot_*.ipynb"))
    assert len(programs) == len(list((ROOT / "docs" / "examples").glob("plot_*.py")))
    for path in (*lessons, *programs):
        nbformat.validate(nbformat.read(path, as_version=4))
    for path in lessons:
        run(nbformat.read(path, as_version=4))
    # Nothing is fetched when a page is opened.
    for page in (out / "index.html", out / "articles" / "isoref" / "isoref.cube.html"):
        assert 'src="http' not in page.read_text(encoding="utf-8")
        assert 'rel="stylesheet" href="http' not in page.read_text(encoding="utf-8")


def run(notebook: Any) -> None:
    """Run the cells one after the other, but for what only a shell or IPython understands."""
    names: dict[str, Any] = {"__name__": "__main__"}
    for cell in notebook.cells:
        if cell.cell_type == "code" and not re.search(r"^\s*[!%]", cell.source, re.MULTILINE):
            exec(compile(cell.source, "cell", "exec"), names)


def test_a_link_that_leads_nowhere_is_told(tmp_path: Path) -> None:
    """A missing file, a missing place, a way out of the site; a link elsewhere is not looked at."""
    (tmp_path / "a.html").write_text(
        '<h1 id="top-of-a">A</h1><a href="b.html">1</a><a href="#nowhere">2</a>'
        '<a href="../c.html">3</a><img src="d.png"><a href="https://example.org">4</a>'
        '<a href="#top-of-a">5</a>',
        encoding="utf-8",
    )
    assert links.broken(tmp_path) == [
        "a.html: b.html is not there",
        "a.html: #nowhere has no such place",
        "a.html: ../c.html leads out of the site",
        "a.html: d.png is not there",
    ]


def test_links_elsewhere_are_told_apart(tmp_path: Path) -> None:
    """Without a network it is said that nothing is known."""
    row = {"filename": "a.md", "lineno": 3, "status": "broken", "uri": "https://example.org/x"}
    (tmp_path / "output.json").write_text(
        json.dumps(row | {"info": "no route"}) + "\n", encoding="utf-8"
    )
    told = links.elsewhere(tmp_path)
    assert "0 of 1" in told
    assert "a.md:3: https://example.org/x (no route)" in told
    assert "no network" in told
