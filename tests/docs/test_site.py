"""The site: it builds without a warning, and its links lead somewhere."""

from __future__ import annotations

import doctest
import json
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import isograde
import isosite
import nbformat
import pytest
from isosite import links, repository

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
BINDER = ROOT / "binder"


def all_pages() -> set[str]:
    """The names of all pages, once the build has made those that it makes."""
    apart = ("_build", "explorer", "examples", "ci", "solutions", "slides")
    sources = [*DOCS.rglob("*.md"), *DOCS.rglob("*.rst")]
    places = [path.relative_to(DOCS) for path in sources]
    return {place.with_suffix("").as_posix() for place in places if not {*place.parts} & {*apart}}


def chosen() -> list[Path]:
    """Pages to write: all that people wrote, and of those made from code one of each kind."""
    texts = {path: page for path, page in repository.pages().items() if path.endswith(".md")}
    made = [f"{page}.md" for page in texts.values() if "upstream" not in page]
    hand = [
        path.relative_to(DOCS).as_posix()
        for folder in ("", "choose", "grade", "learn", "papers", "reports", "benchmarks", "start",
                       "course", "reference")
        for path in (DOCS / folder).glob("*.*")
        if path.suffix in (".md", ".rst")
    ]  # fmt: skip
    kinds = [f"articles/isoref/isoref.{name}.rst" for name in ("asymptotic_decider", "cube")]
    kinds += ["articles/isoref/index.rst", "articles/isoref/twins/sweep.rst", "tests/index.rst"]
    kinds += ["articles/isograde/isograde.oracles.trilinear.rst", "articles/differences.rst"]
    kinds += ["tests/isoref/test_asymptotic_decider.rst", "api/claims.rst", "papers/works.rst"]
    return [DOCS / name for name in dict.fromkeys([*hand, *made, *kinds])]


@pytest.mark.slow
def test_the_site_builds_without_a_warning_and_its_links_lead_somewhere(tmp_path: Path) -> None:
    """`make site` but for running the gallery, whose programs have tests of their own.

    All pages are read and all references in them looked up; written, which takes as long again,
    are those of people, and some of those that are made from code.
    """
    out = tmp_path / "site"
    options = ("-D", "plot_gallery=0", "-D", "isosite_resolve=1", "-d", str(tmp_path / "trees"))
    command = [
        *(sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-j", "2", *options),
        *("-b", "html", str(DOCS), str(out), *map(str, chosen())),
    ]
    done = subprocess.run(command, capture_output=True, encoding="utf-8", check=False)
    assert done.returncode == 0, done.stderr[-4000:]
    written = {path.relative_to(out).as_posix() for path in out.rglob("*.html")}
    names = {f"{page}.html" for page in all_pages()}
    assert len(names) > 400
    assert 60 < len(names & written) < 250
    # No search is made for a part.
    assert links.broken(out, {*names - written, "searchindex.js"}) == []
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
    assert links.broken(tmp_path, {"b.html"}) == links.broken(tmp_path)[1:]
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


def test_a_check_that_did_not_run_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Nothing found is not nothing wrong."""
    assert links.main(["--elsewhere", str(tmp_path)]) == 1
    assert "no link was looked at" in capsys.readouterr().err


def test_what_the_start_page_says_is_what_comes() -> None:
    """Its examples run; the package that it offers has the version of now, on every page."""
    text = (DOCS / "start" / "index.md").read_text(encoding="utf-8")
    examples = re.findall(r"```pycon\n(.*?)```", text, re.DOTALL)
    assert examples
    for example in examples:
        test = doctest.DocTestParser().get_doctest(example, {}, "start", None, None)
        assert doctest.DocTestRunner(verbose=False).run(test).failed == 0
    pages = [path for path in DOCS.rglob("*.md") if "_build" not in path.parts]
    offered = [
        version
        for path in pages
        for version in re.findall(r"isograde-([\d.]+)-py3", path.read_text(encoding="utf-8"))
    ]
    assert len(offered) > 3
    assert {*offered} == {isograde.__version__}


def test_long_names_may_break_behind_their_parts() -> None:
    """In what is read, and not in addresses."""
    title = '<h1><a href="#a.b_c">isoref.dual_faces</a>, BinaryMask3DSource</h1>'
    assert re.sub(r"<h1>.*", isosite.broken, title) == (
        '<h1><a href="#a.b_c">isoref.<wbr>dual_<wbr>faces</a>, Binary<wbr>Mask3<wbr>DSource</h1>'
    )


def test_the_machine_of_binder_can_be_made(tmp_path: Path) -> None:
    """What can be known without a network: its files, its Python, its extras and its program."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    first, package, *others = (BINDER / "requirements.txt").read_text(encoding="utf-8").split("\n")
    # pip looks for it from where the requirements stand.
    assert (BINDER / first.removeprefix("-c ")).resolve() == ROOT / "constraints.txt"
    extras = re.fullmatch(r"\.\[([\w,]+)\]", package)
    assert extras
    assert {*extras[1].split(",")} < project["optional-dependencies"].keys()
    assert {"jupyterlab", "sphinx-gallery"} < {*others}
    runtime = (BINDER / "runtime.txt").read_text(encoding="utf-8").strip()
    assert project["requires-python"] == ">=" + runtime.removeprefix("python-")
    program = next((DOCS / "examples").glob("plot_*.py"))
    shutil.copy(program, tmp_path)
    call = "from sphinx_gallery.notebook import python_to_jupyter_cli as made; made()"
    command = [sys.executable, "-c", call, program.name]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    nbformat.validate(nbformat.read(tmp_path / f"{program.stem}.ipynb", as_version=4))
    assert "sphinx_gallery_py2jupyter docs/examples" in (BINDER / "postBuild").read_text("utf-8")
