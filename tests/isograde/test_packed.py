"""Packed pages: what they carry comes back, in Python and in a browser, whatever it is."""

import os
import re
import shutil
from functools import cache
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
from isograde import report as reports
from isograde.report.lines import write_lines
from isograde.report.packed import MARK, packed, unpacked
from isograde.report.page import page as page_of
from isograde.report.reading import Report

from tests.browser import found
from tests.isograde.reporting import body, made, row
from tests.isograde.test_command import run

ROOT = Path(__file__).parents[2]
KEPT = [ROOT / "reports" / "implementations", ROOT / "reports" / "league"]
EVIL = '</script></title><!--<script>alert("x")</script>]]>"\''


def torn(name: str) -> Report:
    """A report of this name, with a failure."""
    report = made([body(), row("noise/a", topology__closed="fail")])
    report.header["declaration"]["name"] = name
    return report


@pytest.mark.parametrize("name", ["mine", EVIL, "名前 ∂ \U0001f600", "<!-- a page of isograde -->"])
def test_what_is_packed_comes_back_and_says_its_name(name: str) -> None:
    """The page bit by bit; its name in the title and in clear, as text."""
    page = page_of(torn(name))
    shell = packed(page, f"isograde render {name}.jsonl.gz")
    assert unpacked(shell) == page
    assert shell == packed(page, f"isograde render {name}.jsonl.gz"), "the same bytes each time"
    assert len(shell) < len(page) / 2
    parser = Elements()
    parser.feed(shell)
    assert parser.scripts == 2, "nothing in a name ends or begins an element"
    told = unescape(re.findall("<title>(.*?)</title>", shell)[0])
    assert told.startswith(name)


class Elements(HTMLParser):
    """How many scripts a page has."""

    scripts = 0

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Count them."""
        del attrs
        self.scripts += tag == "script"


def test_any_other_page_is_left_as_it_is() -> None:
    """Whoever reads pages need not know which are packed, and none passes for one by its text."""
    carried = packed("<title>a</title>", "x").removeprefix(MARK)
    for page in ("", "<p>plain</p>", f"<!doctype html>\n{carried}"):
        assert unpacked(page) == page


@pytest.mark.parametrize("damage", ["cut", "letters", "nothing"])
def test_a_damaged_page_is_told(damage: str) -> None:
    """A clear error, and never half a page."""
    shell = packed(page_of(torn("mine")), "isograde render mine.jsonl.gz")
    start = shell.index('id="packed">') + 13
    harmed = {
        "cut": shell[: start + 400] + "\n</script>",
        "letters": shell[: start + 404] + "AAAA" + shell[start + 408 :],
        "nothing": shell.replace('id="packed"', 'id="other"'),
    }
    with pytest.raises(ValueError, match="a packed page that is damaged"):
        unpacked(harmed[damage])


def test_a_page_without_a_title_is_not_packed() -> None:
    """It would have none in clear."""
    with pytest.raises(ValueError, match="without a <title>"):
        packed("<p>nothing</p>", "x")


def test_render_writes_pages_again_plain_or_packed(tmp_path: Path) -> None:
    """From the lines alone: beside them, or in a folder; two of one name are wrong use."""
    lines = tmp_path / "mine.jsonl.gz"
    write_lines(torn("mine").records, lines)
    done = run("render", lines, "--packed")
    assert done.exit_code == 0, done.output
    kept = (tmp_path / "mine.html").read_text(encoding="utf-8")
    assert kept.startswith(MARK)
    assert "isograde render mine.jsonl.gz" in kept
    done = run("render", lines, "--out", tmp_path / "plain")
    assert done.exit_code == 0, done.output
    assert (tmp_path / "plain" / "mine.html").read_text(encoding="utf-8") == unpacked(kept)
    shutil.copytree(tmp_path / "plain", tmp_path / "more")
    shutil.copy(lines, tmp_path / "more")
    both = [lines, tmp_path / "more" / lines.name]
    done = run("render", *both, "--out", tmp_path / "twice")
    assert done.exit_code == 2
    assert "two reports would be written as mine" in done.output.replace("\n", " ")
    done = run("render", tmp_path / "nothing.jsonl")
    assert done.exit_code == 2
    assert "nothing.jsonl" in done.output.replace("\n", " ")


def test_a_comparison_packed_links_to_the_pages_beside_the_reports(tmp_path: Path) -> None:
    """`isograde compare --choose --packed` of anybody's reports: each verdict leads to a page."""
    for name in ("mine", "yours"):
        folder = tmp_path / "their reports" / name
        write_lines(torn(name).records, folder / "report.jsonl")
        reports.write(torn(name), folder, "report", ["html"])
    folders = [str(tmp_path / "their reports" / name) for name in ("mine", "yours")]
    out = tmp_path / "choose.html"
    done = run("compare", *folders, "--choose", "--packed", "--out", out)
    assert done.exit_code == 0, done.output
    shell = out.read_text(encoding="utf-8")
    assert shell.startswith(MARK)
    assert 'href="their%20reports/mine/report.html#failure-topology.closed"' in unpacked(shell)


@pytest.mark.slow
def test_a_browser_unpacks_it_and_goes_to_the_place_of_the_link(tmp_path: Path) -> None:
    """Opened from disk, at the failure that the link names, whatever the implementation is called.

    Without script, or what unpacks, it says how the page is had.
    """
    shell = packed(page_of(torn(EVIL)), f"isograde render {EVIL}.jsonl")
    (tmp_path / "inner.html").write_text(shell, encoding="utf-8")
    old = shell.replace("<script>\n(async", "<script>\ndelete window.DecompressionStream;\n(async")
    assert old != shell
    (tmp_path / "old.html").write_text(old, encoding="utf-8")
    told = found(
        '<body><iframe src="inner.html#failure-topology.closed" width="390" height="600"></iframe>'
        '<iframe src="old.html"></iframe>'
        '<iframe src="inner.html" sandbox="allow-same-origin"></iframe></body>',
        """
        await new Promise((done) => setTimeout(done, 3000));
        const [whole, old, still] = [...document.querySelectorAll("iframe")].map(
          (frame) => frame.contentDocument);
        const place = whole.getElementById("failure-topology.closed");
        return {
          name: whole.querySelector("h1").textContent.trim(),
          at: Math.abs(place.getBoundingClientRect().top) < 5,
          moved: whole.defaultView.scrollY > 100,
          target: place.matches(":target"),
          open: place.open,
          title: whole.title,
          more: whole.documentElement.scrollWidth - 390,
          old: old.getElementById("not-unpacked").innerText,
          still: still.querySelector("noscript").textContent,
          hidden: still.getElementById("not-unpacked").getBoundingClientRect().height,
        };
        """,
        tmp_path,
        "--allow-file-access-from-files",
    )
    assert told.pop("title").startswith(EVIL)
    assert told.pop("name").startswith(EVIL)
    assert told.pop("more") <= 0
    for where in ("old", "still"):
        said = unescape(told.pop(where))
        assert f"isograde render {EVIL}.jsonl" in said
    assert told == {"at": True, "moved": True, "target": True, "open": True, "hidden": 0}


# --- what the repository keeps ------------------------------------------------------------------

PAGES = sorted(path for folder in KEPT for path in folder.rglob("*.html"))


class Links(HTMLParser):
    """The anchors and links of a page."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.anchors: set[str] = set()
        self.links: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keep them."""
        said = dict(attrs)
        self.anchors.add(said.get("id") or "")
        if tag == "a":
            self.links.add(said.get("href") or "")


@cache
def links_of(path: Path) -> Links:
    """Those of a kept page."""
    return Links(unpacked(path.read_text(encoding="utf-8")))


def test_kept_pages_are_packed_and_all_of_reports_is_below_30_megabytes() -> None:
    """Issue 16: `reports/` stays under 30 MB in all."""
    assert len(PAGES) > 70
    large = [path for path in PAGES if path.stat().st_size > 5_000]
    assert [path for path in large if not path.read_bytes().startswith(MARK.encode())] == []
    sizes = (file.stat().st_size for file in (ROOT / "reports").rglob("*") if file.is_file())
    assert sum(sizes) < 30e6


@pytest.mark.slow
def test_every_link_of_the_page_to_choose_by_leads_to_a_place_on_a_page() -> None:
    """Issue 16: every number can be clicked down to the case and the lines that show it."""
    start = ROOT / "reports" / "league" / "index.html"
    links = [urlsplit(link) for link in links_of(start).links if link]
    inside = [link for link in links if not link.scheme and not link.netloc]
    assert len(inside) > 300
    wrong = []
    for link in inside:
        page = Path(os.path.normpath(start.parent / unquote(link.path))) if link.path else start
        if not page.is_file() or (
            link.fragment and unquote(link.fragment) not in links_of(page).anchors
        ):
            wrong.append(link.geturl())
    assert wrong == []
