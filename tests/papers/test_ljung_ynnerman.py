"""The reproduction of Ljung & Ynnerman, on small lattices."""

from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from tests.papers.loading import importer


@pytest.fixture(scope="module")
def reproduce() -> ModuleType:
    """The program as a module."""
    return importer("ljung_ynnerman")("reproduce")


def test_the_wave_number_brings_the_empty_share_to_the_printed_one(reproduce: ModuleType) -> None:
    """Table 1, first column."""
    k = reproduce.matching_wave_number(reproduce.random_waves, 48, 1, 88.13)
    share = reproduce.empty_share(reproduce.random_waves((48,) * 3, k, seed=1))
    assert share == pytest.approx(88.13, abs=0.05)


def test_table_1_has_the_shape_of_the_paper_s(reproduce: ModuleType) -> None:
    """Two triangles are the commonest number, one comes next, then three; lines in under 1.3 %."""
    _, means = reproduce.table_1(48, range(2))
    for rows in means.values():
        assert np.sum(rows["real"]) == pytest.approx(100)
        one, two, three, four = rows["real"][1:5]
        assert two > one > three > four
        assert 98.7 < rows["lines"][0] < 99.5


def test_table_1_and_figure_1_contradict_each_other(reproduce: ModuleType) -> None:
    """The rows of the table add up to more triangles than the captions say."""
    table = reproduce.consistency()
    assert len(table.differing()) == 3
    assert all(float(row.ours) > 1.5 * float(row.paper) for row in table.differing())
    assert table.rows[-1].verdict == "exact"


def test_tests_grow_with_the_side_and_with_the_root_of_the_triangles(
    reproduce: ModuleType,
) -> None:
    """Figure 6 and appendix A: exponents 1 and 1/2, prediction c1 c2 s."""
    rows = [reproduce.measure(side, seed, 14.0) for side in (25, 37, 55) for seed in range(3)]
    assert reproduce.exponent(rows, "trisect", "s")[0] == pytest.approx(1, abs=0.08)
    assert reproduce.exponent(rows, "xface", "s")[0] == pytest.approx(1, abs=0.08)
    assert reproduce.exponent(rows, "trisect", "n1")[0] == pytest.approx(0.5, abs=0.04)
    ratio = np.mean([row.trisect * row.s**3 / (row.n1 * row.n2) for row in rows])
    assert ratio == pytest.approx(1, abs=0.15)


def test_the_three_ways_of_joining_agree(reproduce: ModuleType) -> None:
    """As many curves, as many closed; the explicit ones are equally long."""
    rows = reproduce.joining(24, 14.0, [0]).rows
    identity, greedy, faces = (row.ours.split(", length ") for row in rows[:3])
    assert identity == greedy
    assert identity[0] == faces[0]


@pytest.mark.slow
def test_the_whole_program_runs_without_real_data(
    reproduce: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It says what it skipped."""
    monkeypatch.delenv("ISOGRADE_DATA", raising=False)
    monkeypatch.setattr(reproduce, "figure_1", lambda *_: "no pictures here")
    report = tmp_path / "ljung_ynnerman.md"
    tables = reproduce.main(24, (13, 17, 25), 2, report)
    text = report.read_text(encoding="utf-8")
    assert len(tables) == 7
    assert "Skipped: no pictures here." in text
    assert "Skipped: phase vortices in real data" in text
    assert (tmp_path / "ljung_ynnerman" / "figure6.svg").is_file()


def test_phase_vortices_of_the_real_volume(
    reproduce: ModuleType, data: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The headings add up to the winding of the phase on every face of all three echoes."""
    pytest.importorskip("nibabel")
    monkeypatch.setattr(reproduce, "vortex_picture", lambda *_: None)
    table, _ = reproduce.vortices(data, Path())
    assert [row.ours for row in table.rows if "winding" in row.what] == [0, 0, 0]
    assert next(row.ours for row in table.rows if row.what == "echo 3: points") > 50
