"""What the benchmarks write is what they counted, and says how quiet the machine was."""

from pathlib import Path

import bench_distributed
import bench_past_memory
import everything
import floor as module
import numpy as np
import pytest
from asked import ROWS, read
from asked import page as gathered
from bench_past_memory import Ball
from floor import PASSES, dual_floor, finding, floor, given_order, numbers_of
from isograde.report.plot import Series, curves
from isograde.stopwatch import Machine
from isoref.fast.dual import quads
from isoref.field import Array, Field, Integers
from isoref.methods import DUAL_RULES, METHODS, extract
from pages import Goal, Page, UnexplainedError, own_times, profile, profiled


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
    by_module = own_times(profiled(lambda: extract(values, 0.0)), "isoref", 3, modules=True)
    assert "`sweep`" in {name for name, _ in by_module}
    assert sum(float(share.rstrip("%")) for _, share in by_module) == pytest.approx(100, abs=3)


def test_a_goal_is_met_on_the_right_side_of_its_bound() -> None:
    """What was not measured is neither met nor not."""
    assert Goal("vesta", "a", 1.5, True, (1.5, 1.4, 1.6)).cells() == [
        "a", "at most 1.5", "1.50 (1.40 to 1.60)", "met",
    ]  # fmt: skip
    assert not Goal("vesta", "a", 1.5, False, (1.4, 1.4, 1.6)).met
    assert not Goal("vesta", "a", 1.5, True, (1.6, 1.4, 1.6)).met
    unknown = Goal("vesta", "a", 1.5, True, None, "no such library")
    assert unknown.met is None
    assert unknown.cells()[2:] == ["no such library", "not measured"]


def test_the_goals_of_all_pages_are_gathered_with_links_to_what_is_not_met(tmp_path: Path) -> None:
    """Each with its page; a row that nothing was measured for is said to be that."""
    page = Page("A title", "how")
    page.ask("vesta", "slow", (4.0, 3.9, 4.1), 3, most=True)
    page.ask("vesta", "fast", (2.0, 1.9, 2.1), 3, most=True)
    page.ask("joining", "absent", None, 1, most=True, absent="no such library")
    page.explain("slow", "its floor")
    page.show_goals()
    page.why("because")
    page.write(tmp_path / "page.md")
    text = gathered(read(tmp_path))
    assert "| original VESTA over marching | 1 of 2 met" in text
    assert "| joining of curves over Marching Faces | 0 of 1 met, 1 not measured" in text
    assert text.count("| not measured |  |") == len(ROWS) - 2
    where = "(page.md#where-the-time-goes-and-why-it-is-not-less)"
    assert (
        f"| slow | at most 3 | 4.00 (3.90 to 4.10) | not met | [page]{where} | its floor |" in text
    )
    assert "| fast | at most 3 | 2.00 (1.90 to 2.10) | met |  |  |" in text
    assert "## Where the time goes, and why it is not less" in (tmp_path / "page.md").read_text(
        encoding="utf-8"
    )


def test_a_goal_that_nobody_asked_for_is_refused() -> None:
    with pytest.raises(ValueError, match="nobody asked for: speed of light"):
        gathered([("page.md", True, Goal("speed of light", "a", 1.0, True, (1.0, 1.0, 1.0)))])


def test_the_least_passes_make_the_mesh_itself() -> None:
    """Crossings where they are, and the triangles between them: nothing is left out."""
    values = np.random.default_rng(3).normal(size=(9, 10, 11)).astype("f4")
    mesh = METHODS["lorensen-cline"](Field.of(values), 0.1, provenance=True)
    assert mesh.provenance is not None
    vertices, triangles = floor(values, 0.1, mesh)()
    _, order = given_order(mesh, values.shape)
    assert (mesh.provenance.ends >= 0).all()  # no points inside cells
    np.testing.assert_allclose(vertices, mesh.vertices[order], rtol=0, atol=1e-12)
    np.testing.assert_array_equal(order[triangles].reshape(-1, 3), mesh.simplices)
    single = floor(values, 0.1, mesh, "single")()
    assert [array.itemsize for array in single] == [4, 4]


def test_the_least_passes_make_the_triangles_of_a_dual_surface() -> None:
    """And as many vertices as it has; where these are is not asked of a floor."""
    field = Field.of(np.random.default_rng(3).normal(size=(9, 10, 11)).astype("f4"))
    crossings = METHODS["lorensen-cline"](field, 0.1, provenance=True)
    mesh = METHODS["dual-marching-cubes"](field, 0.1)
    rows = quads(DUAL_RULES["dual-marching-cubes"], field, 0.1)[1]
    vertices, triangles = dual_floor(field.values, 0.1, crossings, rows)()
    assert vertices.shape == mesh.vertices.shape
    np.testing.assert_array_equal(triangles.reshape(-1, 3), mesh.simplices)


def test_a_page_that_does_not_say_why_a_goal_is_not_met_ends_badly(tmp_path: Path) -> None:
    """What was measured is kept; with a reason for each, page and table of goals have it."""
    page = Page("A title", "how")
    page.ask("vesta", "slow", (4.0, 3.9, 4.1), 3, most=True)
    page.ask("vesta", "slower", (5.0, 4.9, 5.1), 3, most=True)
    page.ask("vesta", "fast", (2.0, 1.9, 2.1), 3, most=True)
    page.ask("joining", "absent", None, 1, most=True, absent="no such library")
    page.explain("slow", "its floor is 3.5")
    page.explain("fast", "nobody asks")
    assert page.unexplained == ["slower"]
    with pytest.raises(UnexplainedError, match=r"page\.md: .*\['slower'\]"):
        page.write(tmp_path / "page.md")
    assert "**none is given** |" in gathered(read(tmp_path))
    page.explain("slower", "its floor is 4.5")
    page.why("a profile")
    page.write(tmp_path / "page.md")
    text = (tmp_path / "page.md").read_text(encoding="utf-8")
    assert "| slow | its floor is 3.5 |\n| slower | its floor is 4.5 |" in text
    assert "nobody asks" not in text
    table = gathered(read(tmp_path))
    assert "| its floor is 3.5 |" in table
    assert "none is given" not in table


def test_every_kept_goal_that_is_not_met_has_its_reason() -> None:
    """Of pages that were made since reasons are written; the others say that they have none."""
    kept = [one for _, _, one in read(Path(__file__).parents[2] / "reports" / "benchmarks")]
    assert len(kept) > 100
    if not any(one.reason for one in kept):
        pytest.skip("the kept pages were made before reasons were written: make benchmarks")
    assert [one.what for one in kept if one.met is False and not one.reason] == []


def test_the_least_passes_tell_what_each_stage_takes() -> None:
    """All of them, in one call; nothing is made twice or left out."""
    values = np.random.default_rng(3).normal(size=(20, 24, 32)).astype("f4")
    mesh = METHODS["asymptotic-decider"](Field.of(values), 0.1, provenance=True)
    spent: dict[str, float] = {}
    floor(values, 0.1, mesh)(spent)
    assert tuple(spent) == PASSES
    assert sum(spent.values()) > 0


@pytest.mark.parametrize("shape", [(9, 10, 11), (8, 8, 16)])
def test_the_least_passes_find_each_crossing_and_each_cell_once(
    shape: tuple[int, int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """As many as the mesh has: their bits are counted in the bytes that are looked at."""
    values = np.random.default_rng(3).normal(size=shape).astype("f4")
    mesh = METHODS["asymptotic-decider"](Field.of(values), 0.1, provenance=True)
    assert mesh.provenance is not None
    counted: list[int] = []

    def numbered(bytes_: Array) -> tuple[Integers, Integers]:
        numbers = numbers_of(bytes_)
        counted.append(len(numbers[0]))
        return numbers

    monkeypatch.setattr(module, "numbers_of", numbered)
    finding(values, 0.1, mesh)(None)
    crossings = int((mesh.provenance.ends[:, 1] >= 0).sum())
    cells = len(np.unique(mesh.provenance.cells))
    assert counted[-1] == cells
    assert sum(counted[:-1]) == crossings
