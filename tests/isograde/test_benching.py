"""What is timed: every field, both implementations, in turn, and nothing that failed."""

import json
import shlex
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from isograde import benching
from isograde.benching import Bench, NothingToBench, Plan, Row, Side, active_cells, bench
from isograde.command import app
from isograde.model import CONTOURS, CURVES, SURFACES, AdapterError, Kind, Limits, UnknownName
from isograde.report.bench import headline, markdown, numbers, page, plots, sentences, write
from isograde.stopwatch import Timing
from isoref.field import Field
from isoref.methods import extract
from typer.testing import CliRunner

from tests.browser import found as in_browser

PLAN = Plan(rounds=2, seconds=0.5, quick=True)
# It fails where the field has 24 samples an axis and hangs on the larger fields of noise; and it
# refuses to be asked the same twice.
FAILING = """
import time
import isoref

asked = set()


def extract(values, isovalue, spacing):
    question = values.tobytes(), isovalue
    if question in asked:
        raise RuntimeError("asked before")
    asked.add(question)
    if len(values) >= 18 and values.std() > 0.99:
        time.sleep(60)
    if len(values) == 24:
        raise ValueError("24 samples | are too many")
    mesh = isoref.extract(values, isovalue, spacing)
    return mesh.vertices, mesh.simplices
"""
# A program of one triangle, that answers only fields of fewer than 18 samples an axis.
PROGRAM = """
import json, sys
print(json.dumps({"protocol": 3, "declaration": {"name": "program"}}))
sys.stdin.readline()
for line in sys.stdin:
    asked = json.loads(line)
    if asked["command"] == "stop":
        break
    answer = {"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "simplices": [[0, 1, 2]]}
    if asked["shape"][0] >= 18:
        answer = {"unsupported": "small ones only"}
    print(json.dumps({"id": asked["id"], **answer}), flush=True)
"""


@pytest.fixture(scope="module")
def failing(tmp_path_factory: pytest.TempPathFactory) -> Bench:
    """What came of the implementation that fails on some fields."""
    file = tmp_path_factory.mktemp("failing") / "failing.py"
    file.write_text(FAILING, encoding="utf-8")
    seen: list[Row] = []
    spec, peer = f"python:{file}:extract", "isoref:asymptotic-decider"
    found = bench(spec, peer, PLAN, Limits(seconds=2.0), seen.append)
    assert list(found.rows) == seen
    return found


def test_a_field_on_which_it_fails_costs_that_row_and_no_other(failing: Bench) -> None:
    """The row says how it failed; the peer is timed on it all the same."""
    failed = {row.name: row.own.failed for row in failing.rows if row.own.failed}
    assert list(failed) == ["ball, 24^3", "waves, 24^3", "noise, 18^3", "noise, 24^3"]
    assert "24 samples | are too many" in failed["ball, 24^3"]
    assert failed["noise, 18^3"].startswith("timeout: no answer within 2 s")
    assert failed["noise, 24^3"].startswith("not asked: on 18^3 timeout")
    assert len(failing.measured) == 5
    for row in failing.rows:
        assert not row.peer.failed
        assert (row.ratio is None) is bool(row.own.failed)
        assert row.peer.timing is not None
        assert len(row.peer.timing.seconds) == 2


def test_what_it_made_is_counted_and_so_are_samples_and_cells(failing: Bench) -> None:
    """Against the reference, asked here."""
    row = failing.rows[0]
    field = benching.ball(SURFACES, 12)
    mesh = extract(field.values, benching.ISOVALUE)
    assert (row.own.vertices, row.own.simplices) == (len(mesh.vertices), len(mesh.simplices))
    assert (row.samples, row.own.vertices) == (12**3, row.peer.vertices)
    traced = extract(field.values, benching.ISOVALUE, provenance=True).traced()
    assert row.active == len(np.unique(traced.cells))


def test_cells_are_active_where_every_component_is_crossed() -> None:
    """Counted by hand: four cells of a square, crossed along one line and along another."""
    up = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [1.0, 1.0, 1.0]])
    assert active_cells(Field.of(up), 0.5) == 2
    both = Field.of(np.stack([up, up.T]), dimension=2)
    assert active_cells(both, 0.5) == 1
    assert active_cells(Field.of(np.zeros((3, 1, 4))), 0.5) == 0


@pytest.mark.parametrize("kind", [SURFACES, CONTOURS, CURVES])
def test_fields_of_every_kind_have_crossed_cells_and_no_ties(kind: Kind) -> None:
    """Every family, in every size that is asked quickly; ever more cells."""
    assert len(benching.FAMILIES) > 1
    for build in benching.FAMILIES.values():
        fields = [build(kind, side) for side in PLAN.sides(kind)]
        assert [(one.dimension, one.components) for one in fields] == [tuple(kind)] * len(fields)
        cells = [active_cells(one, benching.ISOVALUE) for one in fields]
        assert cells == sorted(cells)
        assert cells[0] > 0
        assert not any((one.values == benching.ISOVALUE).any() for one in fields)


def test_work_is_found_again_in_times_that_were_made_of_it() -> None:
    """A call, a sample and an active cell, fitted to rows whose times have them exactly."""
    counts = [(1000, 300), (8000, 1200), (64000, 9000), (512000, 19000), (4096, 3000)]
    rows = []
    for samples, active in counts:
        seconds = 1e-3 + 2e-9 * samples + 3e-7 * active
        side = Side(1, 1, 0.0, Timing("own", (seconds,), seconds))
        rows.append(Row("ball", 9, SURFACES, samples, active, side, side))
    one = benching.Contestant("a", "a", "", True)
    found = Bench(one, one, SURFACES, 1, tuple(rows), "", 0.0, 1, True, 1.0)
    work = found.work("own")
    assert work is not None
    assert [work.call, work.sample, work.active] == pytest.approx([1e-3, 2e-9, 3e-7])
    assert work.worst < 1e-9
    assert found.ratio == pytest.approx(1.0)
    assert found.parallel("own") is None
    assert "its threads are not counted" in "".join(sentences(found))


def test_threads_are_told_only_where_it_did_not_wait() -> None:
    """Processor time over that of the clock: two threads, one, or nothing that can be told."""
    told = []
    for used in (1.9, 1.0, 0.4):
        side = Side(1, 1, 0.0, Timing("own", (1.0, 2.0), 1.0, (used, used)))
        one = benching.Contestant("a", "a", "", False)
        row = Row("ball", 9, SURFACES, 729, 1, side, side)
        found = Bench(one, one, SURFACES, 1, (row,), "", 0.0, 1, True, 1.0)
        assert found.parallel("own") == used
        told.append(sentences(found)[0])
    assert "1.9 processors at a time on its largest field, several threads" in told[0]
    assert "one thread at a time" in told[1]
    assert "its threads cannot be told" in told[2]


def test_names_that_cannot_be_timed_are_refused_with_the_reason() -> None:
    with pytest.raises(UnknownName):
        bench("no-such-thing")
    with pytest.raises(NothingToBench, match="made elsewhere"):
        bench("dir:somewhere")
    with pytest.raises(NothingToBench, match="isoref:diconex-mixed does not: name another peer"):
        bench("isoref:lorensen-cline", "isoref:diconex-mixed")
    with pytest.raises(AdapterError, match="nowhere"):
        bench("python:nowhere:extract")


# --- What is written -----------------------------------------------------------------------------


def test_page_markdown_and_numbers_say_the_same(failing: Bench, tmp_path: Path) -> None:
    """Every row stands in all three, and every failure; the numbers have each round."""
    write(failing, tmp_path)
    names = {path.name for path in tmp_path.iterdir()}
    assert {"bench.html", "bench.md", "bench.json", "bench-ratios.svg"} <= names
    told = json.loads((tmp_path / "bench.json").read_text(encoding="utf-8"))
    text = (tmp_path / "bench.md").read_text(encoding="utf-8")
    shown = (tmp_path / "bench.html").read_text(encoding="utf-8")
    assert len(told["rows"]) == len(failing.rows) == 9
    for row in told["rows"]:
        assert f"| {row['name']} | {row['samples']:,} |" in text
        assert f'<th scope="row">{row["name"]}</th>' in shown
        assert len(row["peer"]["timing"]["seconds"]) == 2
    assert "24 samples \\| are too many" in text
    assert "24 samples | are too many" in shown
    assert headline(failing) in shown
    assert f"{failing.ratio:.2f} times the time of" in text
    assert "failed on 4 of 9 fields" in text
    for name in plots(failing):
        assert f"](bench-{name}.svg)" in text
        assert f"bench-{name}.svg" in names


def test_a_busy_machine_is_told_on_the_first_screen(failing: Bench) -> None:
    """And a quiet one too."""
    busy, quiet = (
        page(replace(failing, quiet=quiet, others=0.0 if quiet else 1.5)) for quiet in (False, True)
    )
    assert "The machine was busy: others used 1.50 of" in busy
    assert "The machine was busy" not in quiet
    assert "a <b>quiet</b> machine" in quiet


def test_every_point_of_a_plot_is_inside_it(failing: Bench) -> None:
    """And there is a point for each row that was measured, of each of the two."""
    drawn = plots(failing)
    assert set(drawn) == {"ratios", "samples", "active", "vertices", "memory"}
    assert drawn["samples"].count("<circle") == 5 + 9
    assert drawn["ratios"].count("<circle") == 5


def test_the_page_is_as_wide_as_a_phone(failing: Bench, tmp_path: Path) -> None:
    """Nothing but the table's own frame scrolls sideways, and no word of a plot leaves it."""
    script = """
    const over = [], root = document.documentElement;
    for (const svg of document.querySelectorAll("svg.plot")) {
      const frame = svg.getBoundingClientRect();
      for (const one of svg.querySelectorAll("text, circle, polyline, line")) {
        const box = one.getBoundingClientRect();
        if (box.left < frame.left - 1 || box.right > frame.right + 1 ||
            box.top < frame.top - 1 || box.bottom > frame.bottom + 1) over.push(one.outerHTML);
      }
    }
    const plots = document.querySelectorAll("svg.plot").length;
    return [root.scrollWidth - root.clientWidth, plots, over];
    """
    answer = in_browser(page(failing), script, tmp_path, "--window-size=400,900")
    assert answer == [0, 5, []]


# --- The command ---------------------------------------------------------------------------------


def test_a_program_is_timed_by_the_clock_and_refusals_are_rows(tmp_path: Path) -> None:
    """Status 0 where it answered some field; the page says what a program's time is."""
    file = tmp_path / "program.py"
    file.write_text(PROGRAM, encoding="utf-8")
    spec = f"exec:{shlex.quote(sys.executable)} {shlex.quote(str(file))}"
    asked = ["bench", spec, "--against", "isoref:lorensen-cline", "--quick", "--rounds", "1"]
    done = CliRunner().invoke(app, [*asked, "-o", str(tmp_path / "out")])
    assert done.exit_code == 0, done.output
    text = (tmp_path / "out" / "bench.md").read_text(encoding="utf-8")
    assert "program declined: small ones only" in text
    assert "program is a program: its time runs from the request" in text
    told = json.loads((tmp_path / "out" / "bench.json").read_text(encoding="utf-8"))
    answered = [row for row in told["rows"] if row["own"]["timing"]]
    assert [row["side"] for row in answered] == [12, 12, 12]
    assert all(row["own"]["timing"]["processor"] == [] for row in answered)


@pytest.mark.parametrize(
    ("asked", "status", "said"),
    [
        (["no-such-thing"], 2, "no implementation 'no-such-thing'"),
        (["dir:here"], 2, "nothing to time"),
        (["isoref:lorensen-cline", "--against", "isoref:diconex-mixed"], 2, "name another peer"),
        (["isoref:lorensen-cline", "--rounds", "0"], 2, "--rounds"),
        (["python:nowhere:extract"], 2, "nowhere"),
        (["exec:false"], 3, "did not start"),
        (["isoref:lorensen-cline", "-o", __file__], 2, "is a file; name a folder"),
    ],
)
def test_wrong_use_is_one_sentence_and_its_status(asked: list[str], status: int, said: str) -> None:
    done = CliRunner().invoke(app, ["bench", *asked])
    assert done.exit_code == status, done.output
    assert said in done.output


def test_nothing_that_was_answered_is_no_evidence(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Status 4; the page is there and says why."""
    side = Side(failed="raised: no")
    one = benching.Contestant("a", "a", "", False)
    row = Row("ball", 9, SURFACES, 729, 1, side, side)
    found = Bench(one, one, SURFACES, 1, (row,), "a machine", 0.0, 1, True, 1.0)
    monkeypatch.setattr("isograde.commands.benching.bench", lambda *_: found)
    done = CliRunner().invoke(app, ["bench", "a", "-o", str(tmp_path)])
    assert done.exit_code == 4
    assert "no field that both answered" in done.output
    assert "raised: no" in (tmp_path / "bench.html").read_text(encoding="utf-8")
    assert numbers(found)["rows"][0]["own"]["failed"] == "raised: no"
    assert "![samples]" not in markdown(found, "bench")
