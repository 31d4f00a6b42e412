"""What the benchmarks write is what they counted, and says how quiet the machine was."""

from pathlib import Path

import bench_distributed
import bench_past_memory
import everything
import numpy as np
import pytest
from bench_past_memory import Ball
from isograde.report.plot import Series, curves
from isograde.stopwatch import Machine
from isoref.methods import extract
from pages import Page, goal, profile


@pytest.mark.parametrize("others", [0.0, 1.7])
def test_a_page_says_whether_the_machine_was_quiet(
    others: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """While it was made, not only when it began; and its plots stand beside it."""
    monkeypatch.setattr(Machine, "passed", 10.0)
    monkeypatch.setattr(Machine, "_used", lambda self, passed: others)
    page = Page("A title", "how")
    page.table(["a", "b"], [["1", "2"]])
    page.plot("line", curves("t", "x", "y", [Series("s", [(1, 1), (2, 4)])]))
    page.plot("none", curves("t", "x", "y", []))
    page.write(tmp_path / "page.md")
    text = (tmp_path / "page.md").read_text(encoding="utf-8")
    assert ("**The machine was not quiet" in text) is (others > 1)
    assert f"others used {others:.2f} of them meanwhile" in text
    assert "| 1 | 2 |" in text
    assert "![line](page-line.svg)" in text
    assert {path.name for path in tmp_path.iterdir()} == {"page.md", "page-line.svg"}


def test_the_volume_that_is_made_when_it_is_read_has_the_counts_of_the_whole() -> None:
    """And its surface is a closed one without handles: 2 V - F = 4."""
    whole = extract(Ball(40)[0:40], bench_past_memory.ISOVALUE)
    assert bench_past_memory.extract(40) == (len(whole.vertices), len(whole.simplices))
    assert 2 * len(whole.vertices) - len(whole.simplices) == 4


def test_what_blocks_send_is_counted_in_the_blocks_themselves() -> None:
    """All blocks together have the vertices of the whole, and some of those on borders again."""
    values = np.random.default_rng(3).normal(size=(17, 17, 17)).astype("f4")
    found = bench_distributed.sent(values, 8, 0.1)
    assert found.number == 8
    assert found.samples > 9**3 * 4
    whole = len(extract(values, 0.1).vertices)
    assert whole < 8 * found.all_vertices <= whole + 8 * found.shared


def test_every_program_is_run() -> None:
    """`make benchmarks` finds them by their names."""
    folder = Path(everything.__file__).parent
    assert len(everything.programs()) == len(list(folder.glob("bench_*.py"))) > 10
    assert set(everything.TOLD) <= set(everything.programs())


def test_a_profile_gives_a_function_what_it_calls_outside_the_package() -> None:
    """Shares add up to all of the time; sorting in NumPy is the time of who asks for it."""
    values = np.random.default_rng(0).normal(size=(24, 24, 24))
    rows = profile(lambda: extract(values, 0.0), "isoref", 3)
    shares = [float(share.rstrip("%")) for _, share in rows]
    assert len(rows) == 4
    assert shares[:3] == sorted(shares[:3], reverse=True)
    assert sum(shares) == pytest.approx(100, abs=3)
    assert "others" in rows[-1][0]
    assert all("." in name for name, _ in rows[:3])


def test_a_goal_is_met_on_the_right_side_of_its_bound() -> None:
    assert goal("a", (1.5, 1.4, 1.6), 1.5, most=True) == [
        "a", "at most 1.5", "1.50 (1.40 to 1.60)", "met",
    ]  # fmt: skip
    assert goal("a", (1.4, 1.4, 1.6), 1.5, most=False)[-1] == "not met"
    assert goal("a", (1.6, 1.4, 1.6), 1.5, most=True)[-1] == "not met"
