"""The viewer of a failed case: what it is given, and what it does in a real browser."""

from __future__ import annotations

import json
import shutil
import subprocess
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from isograde.grading import grade
from isograde.model import Finding, Verdict
from isograde.report import lines, reading
from isograde.report.page import page
from isograde.report.reading import Report
from isograde.report.viewer import EXACT, KEPT, MARKED, turned_case
from isograde.runner import Options

from tests.browser import found
from tests.isograde.reporting import body, made, row

TEMPLATES = resources.files("isograde.report") / "templates"
LANGUAGES = ("Python", "C", "Rust", "JSON")
# Collects what each button of the first viewer writes to the clipboard.
COPIES = """
  const texts = [];
  const writeText = async (text) => texts.push(text);
  Object.defineProperty(navigator, "clipboard", { value: { writeText } });
  for (const button of document.querySelectorAll(".viewer")[0].querySelectorAll("button"))
    if (["Python", "C", "Rust", "JSON"].includes(button.textContent)) button.click();
  await new Promise((done) => setTimeout(done, 50));
  return texts;
"""


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Report:
    """The hole of 1987, and the lines round it."""
    place = tmp_path_factory.mktemp("report") / "report.jsonl"
    grade("isoref:lorensen-cline", Options(only=("pairs/02*",)), place, arguments=["grade"])
    return reading.read(place)


def evidence(**changed: Any) -> lines.JSON:
    """A record of one cell whose lowest corner is inside, and one triangle round it."""
    record: lines.JSON = {
        "case": "mine/0", "shape": [2, 2, 2], "spacing": [1.0, 1.0, 2.0], "origin": [0.0] * 3,
        "dtype": "float64", "isovalues": [0.5], "values": [1.0] + [0.0] * 7,
        "finding": {"detail": "it is so", "numbers": {}},
        "came": {
            "vertices": [[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 1.0]],
            "simplices": [[0, 1, 2]],
        },
    }  # fmt: skip
    return {**record, **changed}


def turned(record: lines.JSON, tie: str = "inside") -> lines.JSON:
    """The viewer's data of this record."""
    made = turned_case(record, [("mine", record["came"])], tie)
    assert made is not None
    json.dumps(made, allow_nan=False)
    return made


def kinds(made: lines.JSON) -> list[str]:
    """The kinds of what is marked in the first answer."""
    return [mark[0] for mark in made["answers"][0]["marks"]]


def test_points_are_in_index_coordinates() -> None:
    (answer,) = turned(evidence())["answers"]
    assert answer["points"] == [0.5, 0, 0, 0, 0.5, 0, 0, 0, 0.5]
    assert answer["rows"] == [[0, 1, 2]]


def test_sides_follow_the_convention_on_ties() -> None:
    record = evidence(values=[1.0, 0.5] + [0.0] * 6)
    assert turned(record)["inside"] == [1, 1, 0, 0, 0, 0, 0, 0]
    assert turned(record, "outside")["inside"] == [1, 0, 0, 0, 0, 0, 0, 0]


@pytest.mark.parametrize(
    ("numbers", "simplices", "kind", "count"),
    [
        ({"first": [[0.5, 0, 0], [0, 0.5, 0]]}, [[0, 1, 2]], "sore-line", 1),
        ({"first": [[[0.5, 0, 0], [0, 0.5, 0], [0, 0, 0.5]]] * 2}, [[0, 1, 2]], "sore-line", 6),
        ({"at": [0.5, 0.5, 0.5]}, [[0, 1, 2]], "ring", 1),
        ({"cell": [0, 0, 0]}, [[0, 1, 2]], "sore-line", 12),
        ({"sample": [0, 0, 0], "axes": [0, 1]}, [[0, 1, 2]], "sore-line", 4),
        ({}, [[0, 1, 2]], "rim", 3),
        ({}, [[0, 1, 2], [2, 1, 0]], "twice", 3),
        ({}, [[0, 1, 2], [0, 1, 2], [1, 2, 0]], "crowd", 3),
        ({}, [[0, 1, 1]], "flat", 3),
        ({}, [[0, 1, 1]], "unused", 1),
        ({"vertex": 2}, [[0, 1, 2]], "ring", 1),
        ({"simplex": 0}, [[0, 1, 2]], "sore-line", 3),
        ({"cell": [0, 0, 0], "face": 1}, [[0, 1, 2]], "sore-line", 4),
    ],
)
def test_faults_are_marked(
    numbers: dict[str, Any], simplices: list[list[int]], kind: str, count: int
) -> None:
    record = evidence(finding={"detail": "", "numbers": numbers})
    record["came"] = {**record["came"], "simplices": simplices}
    assert kinds(turned(record)).count(kind) == count


def test_an_edge_of_one_triangle_inside_the_lattice_is_a_gap() -> None:
    record = evidence()
    vertices = [[0.5, 0.5, 0.0], [0.5, 0.5, 1.0], [0.2, 0.2, 0.5]]
    record["came"] = {**record["came"], "vertices": vertices}
    assert kinds(turned(record)) == ["gap"] * 3


def test_a_loose_end_of_a_curve_is_a_spot() -> None:
    record = evidence(isovalues=[0.5, 0.5], values=[1.0] * 16)
    record["came"] = {"vertices": [[0.5, 0.5, 0.5], [0.5, 0.5, 0.0]], "simplices": [[0, 1]]}
    assert kinds(turned(record)) == ["spot"]


def test_numbers_that_json_lacks_are_text() -> None:
    values = [float("nan"), float("inf"), float("-inf"), EXACT, EXACT + 1, 0.0, 0.0, 0.0]
    made = turned(evidence(values=values))
    assert made["values"][:5] == ["NaN", "Infinity", "-Infinity", EXACT, str(EXACT + 1)]


def test_of_a_large_mesh_the_simplices_near_the_fault_are_kept() -> None:
    """80 pages of reports stay small."""
    n = 4000
    rng = np.random.default_rng(3)
    at = rng.uniform(0, 9, (n, 1, 3)) + rng.uniform(0, 0.1, (n, 3, 3))
    record = evidence(shape=[10, 10, 10], values=[], spacing=[1.0] * 3)
    record["finding"] = {"detail": "", "numbers": {"at": [2, 2, 2]}}
    record["came"] = {
        "vertices": at.reshape(-1, 3).tolist(),
        "simplices": np.arange(3 * n).reshape(n, 3).tolist(),
    }
    made = turned(record)
    (answer,) = made["answers"]
    assert (len(answer["rows"]), answer["left_out"]) == (KEPT, n - KEPT)
    kept = np.reshape(answer["points"], (-1, 3))
    farthest = np.abs(kept - 2).max()
    left = np.sort(np.abs(at.mean(axis=1) - 2).max(axis=1))[KEPT:]
    assert farthest < left.min() + 0.1
    assert kinds(made).count("gap") == MARKED
    assert len(json.dumps(made)) < 60_000


def test_without_values_and_answers_there_is_nothing_to_turn() -> None:
    assert turned_case(None, [], "inside") is None
    assert turned_case(evidence(values=[]), [], "inside") is None


def test_in_the_plane_the_array_can_be_copied_and_nothing_turns() -> None:
    record = evidence(shape=[2, 2], spacing=[1.0] * 2, origin=[0.0] * 2, values=[1.0, 0, 0, 0])
    record["came"] = {"vertices": [[0.5, 0.0], [0.0, 0.5]], "simplices": [[0, 1]]}
    made = turned(record)
    assert (made["answers"], made["inside"]) == ([], [])
    assert made["values"] == [1.0, 0, 0, 0]


def test_the_viewer_is_small_and_on_a_page_once(report: Report) -> None:
    """Issue 12: at most 30 kB, without dependencies."""
    size = sum(len((TEMPLATES / f"viewer.{kind}").read_bytes()) for kind in ("js", "css"))
    assert 10_000 < size <= 30_000
    text = page(report)
    assert text.count("const enliven") == 1
    shown = [one.id for one in report.failures if one.id in report.evidence]
    assert text.count('class="turned-case"') == len(shown) > 3


# --- in the browser ------------------------------------------------------------------------------


@pytest.mark.slow
def test_pictures_turn_by_key_mouse_and_button_and_together(report: Report, tmp_path: Path) -> None:
    script = """
      // Without a window frames are not drawn one after another: take the clock for them.
      window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), 5);
      const wait = () => new Promise((done) => setTimeout(done, 100));
      const [first, second] = document.querySelectorAll(".body:has(.legal) .pic.live");
      const panel = first.closest(".body").querySelector(".viewer");
      const event = (key) => new KeyboardEvent("keydown", { key, cancelable: true });
      const press = (key) => first.dispatchEvent(event(key));
      const seen = {};
      const look = async (name) => {
        await wait();
        seen[name] = [first.innerHTML, second.innerHTML];
      };
      await look("start");
      press("ArrowLeft"); await look("left");
      press("ArrowUp"); await look("up");
      press("Home"); await look("home");
      first.setPointerCapture = () => {}; first.hasPointerCapture = () => true;
      first.dispatchEvent(new PointerEvent("pointermove", { movementX: 40, movementY: 10 }));
      await look("dragged");
      [...panel.querySelectorAll("button")].find((b) => b.textContent === "as at first").click();
      await look("again");
      panel.querySelector("button[aria-label='turn right']").click(); await look("right");
      return { seen, pressed: press("ArrowLeft"), ignored: press("x"),
        still: getComputedStyle(first.parentElement.querySelector(".still")).display };
    """
    told = found(page(report), script, tmp_path, "--force-prefers-reduced-motion")
    seen = told["seen"]
    assert seen["home"] == seen["start"] == seen["again"]
    views = [seen[name] for name in ("start", "left", "up", "dragged", "right")]
    for answer in (0, 1):
        assert len({view[answer] for view in views}) == 5
        assert all("<polygon" in view[answer] and "<text" in view[answer] for view in views)
    assert not told["pressed"], "an arrow key would scroll the page"
    assert told["ignored"]
    assert told["still"] == "none"


@pytest.mark.slow
def test_each_case_turns_its_own_pictures(tmp_path: Path) -> None:
    """One failure stands inside of another where it follows from it."""
    figure = '<div class="pictures"><figure><svg></svg></figure></div><p class="key"></p>'
    one, other = turned(evidence()), turned(evidence(isovalues=[-0.5]))
    data = [json.dumps(made).replace("<", "\\u003c") for made in (one, other)]
    script = '<script type="application/json" class="turned-case">{}</script>'
    inner = f'<details class="follow" open>{figure}{script.format(data[1])}</details>'
    text = _page_of(one, figure).replace("</script></div>", f"</script>{inner}</div>", 1)
    counted = "return [...document.querySelectorAll('figure')].map((one) => [one.querySelectorAll("
    counted += "'.live').length, one.querySelectorAll('.in').length]);"
    assert found(text, counted, tmp_path) == [[1, 1], [1, 8]]


@pytest.mark.slow
def test_the_turned_picture_begins_as_the_static_one(report: Report, tmp_path: Path) -> None:
    """The same samples, triangles and faults, and up to one scale and shift at the same places."""
    script = """
      const shapes = (svg) => [...svg.querySelectorAll("circle.in, circle.out")].map((one) =>
        [one.getAttribute("class"), one.querySelector("title").textContent.split(":")[0],
         +one.getAttribute("cx"), +one.getAttribute("cy")]).sort((a, b) => a[1] < b[1] ? -1 : 1);
      const count = (svg) => Object.fromEntries(["polygon.front", "polygon.back", ".gap", ".rim",
        ".sore-line", ".crowd"].map((kind) => [kind, svg.querySelectorAll(kind).length]));
      return [...document.querySelectorAll(".pic.live")].map((live) => {
        const still = live.parentElement.querySelector(".still");
        return [shapes(live), shapes(still), count(live), count(still)];
      });
    """
    told = found(page(report), script, tmp_path)
    assert len(told) > 4
    for live, still, drawn, wanted in told:
        assert [one[:2] for one in live] == [one[:2] for one in still]
        assert drawn == wanted
        a, b = (np.array([one[2:] for one in each]) for each in (live, still))
        a, b = a - a.mean(axis=0), b - b.mean(axis=0)
        scale = (a * b).sum() / (b * b).sum()
        np.testing.assert_allclose(a, scale * b, atol=0.3)


@pytest.mark.slow
def test_the_copied_array_is_the_array_in_each_language(tmp_path: Path) -> None:
    """Python, C, Rust and JSON give back the samples, whatever the number type."""
    tried = [
        ("float64", [0.1, -2.5e-300, 1e22, 3.0, float("nan"), float("inf"), float("-inf"), 0.0]),
        ("float32", [0.1, 2.0, -3.0, 4.5, 5.0, 6.0, 7.0, 1e-30]),
        (">i2", [-32768, 2, 3, 4, 5, 6, 7, 32767]),
        ("uint64", [2**64 - 1, 2, 3, 4, 5, 6, 7, 0]),
        ("int64", [-(2**63), 2**63 - 1, 3, 4, 5, 6, 7, 0]),
        ("uint8", [255, 2, 3, 4, 5, 6, 7, 0]),
    ]
    for dtype, values in tried:
        # float32 numbers are written as the record holds them, which is as doubles.
        kept = np.array(values, dtype).ravel()
        record = evidence(dtype=dtype, values=kept.tolist())
        folder = tmp_path / dtype.strip(">")
        folder.mkdir()
        text = _page_of(turned(record))
        copies = dict(zip(LANGUAGES, found(text, COPIES, folder), strict=True))
        scope: dict[str, Any] = {}
        exec(copies["Python"], scope)
        np.testing.assert_array_equal(scope["values"], kept.reshape(2, 2, 2))
        assert scope["values"].dtype == kept.dtype
        assert (scope["isovalue"], scope["spacing"]) == (0.5, (1, 1, 2))
        back = json.loads(copies["JSON"])
        np.testing.assert_array_equal([np.dtype(dtype).type(x) for x in back["values"]], kept)
        native = kept.astype(kept.dtype.newbyteorder("="))
        for language, bytes_of in (("C", _c_bytes), ("Rust", _rust_bytes)):
            raw = bytes_of(copies[language], folder)
            if raw is not None:
                answer = np.frombuffer(raw, native.dtype)
                np.testing.assert_array_equal(answer, native, err_msg=language)


def _page_of(made: lines.JSON, figure: str = "") -> str:
    """A page with one viewer, of this data, and its static picture."""
    data = json.dumps(made).replace("<", "\\u003c")
    return (
        f'<!doctype html><body><div class="body">{figure}<script type="application/json" '
        f'class="turned-case">{data}</script></div>'
        f"<script>{(TEMPLATES / 'viewer.js').read_text(encoding='utf-8')}</script></body>"
    )


def _c_bytes(text: str, folder: Path) -> bytes | None:
    """The bytes of `values`, from a C program; None where there is no compiler."""
    compiler = shutil.which("cc")
    if compiler is None:
        return None
    main = "\n#include <stdio.h>\nint main(void) { (void)isovalue; (void)spacing; (void)origin;"
    main += " fwrite(values, sizeof values, 1, stdout); return 0; }\n"
    (folder / "case.c").write_text(text + main, encoding="utf-8")
    program = folder / "case-c"
    flags = ["-std=c99", "-Wall", "-Werror", "-o", str(program)]
    subprocess.run([compiler, str(folder / "case.c"), *flags], check=True)
    return subprocess.run([program], capture_output=True, check=True).stdout


def _rust_bytes(text: str, folder: Path) -> bytes | None:
    """The bytes of `VALUES`, from a Rust program; None where there is no compiler."""
    compiler = shutil.which("rustc")
    if compiler is None:
        return None
    main = """
use std::io::Write;
fn main() {
    let _ = (ISOVALUE, SPACING, ORIGIN);
    for x in VALUES.iter().flatten().flatten() {
        std::io::stdout().write_all(&x.to_ne_bytes()).unwrap();
    }
}
"""
    (folder / "case.rs").write_text(text + main, encoding="utf-8")
    program = folder / "case-rust"
    subprocess.run([compiler, "-o", str(program), str(folder / "case.rs")], check=True)
    return subprocess.run([program], capture_output=True, check=True).stdout


@pytest.mark.slow
def test_on_a_telephone_a_page_is_as_wide_as_the_screen(tmp_path: Path) -> None:
    """Whatever is long: a case's name, an error, a version. Seven pages were wider once."""
    name = f"given/8x3x3/{','.join(['-0.5'] * 72)}"
    long = row(name, structure__answers="error")
    long[1].findings["structure.answers"] = Finding(Verdict.ERROR, "e" * 400)  # type: ignore[index]
    text = page(made([body(), long], name="n" * 80, version="1." * 40, notes="no" * 90))
    # A window is never as narrow as a telephone; a frame is.
    script = """
      const frame = document.body.appendChild(document.createElement("iframe"));
      frame.style.width = "390px";
      const { promise, resolve } = Promise.withResolvers();
      frame.onload = resolve;
      frame.srcdoc = page;
      await promise;
      const inside = frame.contentDocument.documentElement;
      for (const one of inside.querySelectorAll("details")) one.open = true;
      return [inside.clientWidth, inside.scrollWidth];
    """
    held = f"const page = {json.dumps(text).replace('<', chr(92) + 'u003c')};"
    width, needed = found("<body></body>", held + script, tmp_path)
    assert 300 < width <= 390
    assert needed == width


@pytest.mark.slow
def test_on_paper_every_claim_is_open_and_afterwards_as_it_was(
    report: Report, tmp_path: Path
) -> None:
    """Issue 12: printed. What is held and every claim can be read; lines to copy stay folded."""
    script = """
      const count = () => document.querySelectorAll(
        "details.family:not([open]), details.failure:not(.unheld):not([open])").length;
      const before = count();
      dispatchEvent(new Event("beforeprint"));
      const printed = count();
      dispatchEvent(new Event("afterprint"));
      return [before, printed, count()];
    """
    before, printed, after = found(page(report), script, tmp_path)
    assert before > 0
    assert (printed, after) == (0, before)


def test_on_paper_the_ground_is_white_whatever_the_reader_prefers() -> None:
    """The dark colours are of screens alone."""
    style = (TEMPLATES / "style.css").read_text(encoding="utf-8")
    assert style.count("prefers-color-scheme: dark") == 1
    assert "@media screen and (prefers-color-scheme: dark)" in style


def test_a_page_without_a_clipboard_shows_the_text(tmp_path: Path) -> None:
    script = """
      Object.defineProperty(navigator, "clipboard", { value: undefined });
      const panel = document.querySelector(".viewer");
      [...panel.querySelectorAll("button")].find((b) => b.textContent === "JSON").click();
      await new Promise((done) => setTimeout(done, 50));
      return panel.querySelector(".said").textContent;
    """
    assert '"shape":[2,2,2]' in found(_page_of(turned(evidence())), script, tmp_path)


@pytest.mark.slow
def test_nothing_in_a_case_becomes_markup(tmp_path: Path) -> None:
    """Captions and names are text wherever they are drawn."""
    evil = '</title><img src=x onerror="window.caught = 1">"\'&'
    record = evidence(case=evil)
    made = turned_case(record, [(evil, record["came"])], "inside")
    assert made is not None
    figure = '<div class="pictures"><figure><svg></svg></figure></div>'
    text = _page_of(made, figure)
    script = """
      await new Promise((done) => setTimeout(done, 50));
      return [!!window.caught, document.images.length];
    """
    assert found(text, script, tmp_path) == [False, 0]
