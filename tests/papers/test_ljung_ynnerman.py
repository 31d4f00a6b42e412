"""The reproduction of Ljung & Ynnerman, on small lattices."""

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from isoref.fast.surface_intersection import enhanced_marching_cubes, surface_intersection
from isoref.surface_intersection import Segments

from tests.papers.loading import importer


@pytest.fixture(scope="module")
def module() -> Callable[[str], ModuleType]:
    """Imports a module of the paper's folder."""
    return importer("ljung_ynnerman")


@pytest.fixture(scope="module")
def reproduce(module: Callable[[str], ModuleType]) -> ModuleType:
    """The program as a module."""
    return module("reproduce")


def test_the_wave_number_brings_the_empty_share_to_the_printed_one(reproduce: ModuleType) -> None:
    """Table 1, first column."""
    k = reproduce.matching_wave_number(reproduce.random_waves, 48, 1, 88.13)
    share = reproduce.empty_share(reproduce.random_waves((48,) * 3, k, seed=1))
    assert share == pytest.approx(88.13, abs=0.05)


def test_table_1_has_the_shape_of_the_paper_s(reproduce: ModuleType) -> None:
    """Two triangles are the commonest number, one comes next, then three; lines in under 1.3 %."""
    _, means = reproduce.table_1(48, range(2))
    assert means
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
    module: Callable[[str], ModuleType],
) -> None:
    """Figure 6 and appendix A: exponents 1 and 1/2, prediction c1 c2 s."""
    scaling = module("ljung_scaling")
    rows = [scaling.count(side, seed, 14.0) for side in (25, 37, 55) for seed in range(3)]
    assert scaling.exponent(rows, "trisect", "s")[0] == pytest.approx(1, abs=0.08)
    assert scaling.exponent(rows, "xface", "s")[0] == pytest.approx(1, abs=0.08)
    assert scaling.exponent(rows, "trisect", "n1")[0] == pytest.approx(0.5, abs=0.04)
    ratio = np.mean([row.trisect * row.s**3 / (row.n1 * row.n2) for row in rows])
    assert ratio == pytest.approx(1, abs=0.15)


def test_tests_are_counted_as_they_are_done(module: Callable[[str], ModuleType]) -> None:
    """Counted without being done, they are as many as `surface_intersection` does."""
    scaling = module("ljung_scaling")
    pair = scaling.waves(25, 3, 14.0)
    surfaces = [enhanced_marching_cubes(field, 0.0) for field in pair]
    assert scaling.count(25, 3, 14.0).trisect == surface_intersection(*surfaces).tests


def test_the_fit_finds_the_exponent_of_a_known_law(module: Callable[[str], ModuleType]) -> None:
    """``(s + 1)^1 exp(-9 / s^2)``: a plain power is off, with border and bend allowed for not."""
    scaling = module("ljung_scaling")
    law = [round(1e9 * (s + 1) * np.exp(-9 / s**2)) for s in (24, 48, 96, 192)]
    rows = [
        scaling.Counted(s, seed, s**2, s**2, 2 * s, n * (seed + 1))
        for s, n in zip((24, 48, 96, 192), law, strict=True)
        for seed in (0, 1)
    ]
    assert abs(scaling.exponent(rows, "xface", "s")[0] - 1) > 0.005
    fitted, half = scaling.exponent(rows, "xface", "s", border=1, bend=True)
    assert fitted == pytest.approx(1, abs=1e-6)
    assert half < 1e-6


def test_the_three_ways_of_joining_agree(module: Callable[[str], ModuleType]) -> None:
    """As many curves, as many closed; the explicit ones are equally long."""
    rows = module("ljung_joining").joining(24, 14.0, [0]).rows
    identity, greedy, faces = (row.ours.split(", length ") for row in rows[:3])
    assert identity == greedy
    assert identity[0] == faces[0]


def test_whole_numbers_leave_no_loose_end(module: Callable[[str], ModuleType]) -> None:
    """Neither method has one; without the infinitesimal motion there would be some."""
    rows = module("ljung_joining").ties(7, [0]).rows
    assert [row.ours for row in rows if row.expected is not None] == [0] * 4
    assert all(row.ours > 0 for row in rows if row.expected is None)


@pytest.mark.slow
def test_the_greedy_joining_is_right_between_rounding_and_the_distance_of_curves(
    module: Callable[[str], ModuleType],
) -> None:
    """Most are broken without a threshold; with 0.1 voxels all but noise, where curves crowd."""
    joining = module("ljung_joining")
    faults = 0
    for name, (pair, isovalues) in joining.fields(24, 14.0, [0]).items():
        surfaces = [enhanced_marching_cubes(*one) for one in zip(pair, isovalues, strict=True)]
        segments = surface_intersection(*surfaces)
        h = max(pair[0].spacing)
        for share in (1e-12, 1e-6, 0.1):
            found = joining.compare(segments, surfaces[0].shape, share * h)
            assert found.right == (name != "noise" or share < 0.1), f"{name}, {share}: {found}"
        faults += not joining.compare(segments, surfaces[0].shape, 0.0).right
    assert faults >= 5


def test_each_fault_of_a_joining_is_counted(module: Callable[[str], ModuleType]) -> None:
    """Two parallel lines of two segments: 0.2 apart they are merged, with a gap they are broken."""
    joining = module("ljung_joining")

    def lines(gap: float) -> Segments:
        x = np.array([[0, 0.5], [0.5 + gap, 1.0]])
        ends = np.zeros((4, 2, 3))
        ends[:, :, 0] = np.concatenate([x, x])
        ends[2:, :, 1] = 0.2
        nodes = np.array([[0, 1], [1, 2], [3, 4], [4, 5]])
        return Segments(ends, nodes, np.zeros(4, np.int64), 0)

    assert joining.compare(lines(0.0), (1, 1, 1), 0.1).right
    near = joining.compare(lines(0.0), (1, 1, 1), 0.3)
    assert (near.curves, near.merged, near.shut) == (1, 1, 1)
    assert str(joining.compare(lines(0.1), (1, 1, 1), 0.05)) == "4: 2 broken"


@pytest.mark.slow
def test_the_whole_program_runs_without_real_data(
    reproduce: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It says what it skipped."""
    monkeypatch.delenv("ISOGRADE_DATA", raising=False)
    monkeypatch.setattr(reproduce, "figure_1", lambda *_: "no pictures here")
    report = tmp_path / "ljung_ynnerman.md"
    tables = reproduce.main(24, (13, 17, 25), 2, report)
    waves = report.read_text(encoding="utf-8")
    methods = (tmp_path / "ljung_ynnerman" / "methods.md").read_text(encoding="utf-8")
    assert len(tables) == 11
    assert "readings fit the print" in waves
    assert "load" in waves
    assert "Skipped: no pictures here." in waves
    assert "## Ambiguous faces: the rules beside the true field" in methods
    assert "## The greedy joining's threshold" in methods
    assert "Skipped: phase vortices in real data" in methods
    assert "ljung_ynnerman/methods.md" in waves
    assert (tmp_path / "ljung_ynnerman" / "figure6.svg").is_file()


def test_curves_of_higher_order_have_it_and_confidence_is_the_sine_of_the_angle(
    module: Callable[[str], ModuleType], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Section 6: cubics of order 4, chords of 2; tangents err more where surfaces meet flatly."""
    curves = module("ljung_curves")
    monkeypatch.setattr(curves, "ANGLES", (60, 3))
    table = curves.report()
    assert not table.differing()
    assert len(table.rows) == 8
    errors = [row.ours.split("; ") for row in table.rows if "error of tangents" in row.what]
    assert float(errors[1][0]) > 3 * float(errors[0][0])
    assert float(errors[1][1]) < float(errors[0][1])


def test_phase_vortices_of_the_real_volume(
    module: Callable[[str], ModuleType], data: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The headings add up to the winding of the phase on every face of all three echoes."""
    pytest.importorskip("nibabel")
    vortices = module("ljung_vortices")
    monkeypatch.setattr(vortices, "vortex_picture", lambda *_: None)
    table, _ = vortices.vortices(*vortices.complex_mri(data), Path())
    assert [row.ours for row in table.rows if "winding" in row.what] == [0, 0, 0]
    assert next(row.ours for row in table.rows if row.what == "echo 3: points") > 50


def test_gradients_at_the_four_points_are_right_more_often_than_the_saddle(
    module: Callable[[str], ModuleType],
) -> None:
    """Section 6, on random waves: the middle of the face is worse than chance, p_j the best."""
    found = module("ljung_faces").compared(45.0, range(1))
    assert found.faces > 150
    share = {rule: right / found.faces for rule, right in found.right.items()}
    assert max(share, key=lambda rule: share[rule]) == "gradient"
    assert share["gradient"] > share["asymptotic"] + 0.03
    assert share["middle"] < 0.5


def test_tables_2_and_3_as_printed_lose_counts_and_break_curves(
    module: Callable[[str], ModuleType],
) -> None:
    """Line 4 leaves I_L unset; line 10 makes curves of single segments, called closed."""
    segments, unset, curves, closed = module("ljung_misprints").report().rows
    assert segments.verdict == "exact"
    assert unset.ours < unset.expected
    assert curves.ours > curves.expected == 1
    assert closed.ours > closed.expected == 0


def test_every_reading_of_the_lines_is_counted(
    reproduce: ModuleType, module: Callable[[str], ModuleType]
) -> None:
    """Small: a row a reading, its five columns with z-scores, and a sentence that counts."""

    def match(sampler: object, side: int, seed: int) -> float:
        return 6.0

    lines = module("ljung_lines")
    printed = reproduce.PRINTED["table_1"]
    text = lines.readings(reproduce.SAMPLERS, 20, range(2), printed, match)
    rows = [line for line in text.splitlines() if line.startswith(("| eq. 5", "| eq. 6"))]
    assert len(rows) > 10
    assert all(row.count("(") >= 5 for row in rows)
    fitting = sum(row.endswith((" | yes | yes |", " | yes | no |")) for row in rows)
    both = sum(row.endswith(" | yes | yes |") for row in rows)
    assert f"The lines of {fitting} of {len(rows)} readings fit the print" in text
    assert f"Both surfaces fit as well in {both}: " in text


def test_a_reading_that_is_far_from_the_print_does_not_fit(
    module: Callable[[str], ModuleType],
) -> None:
    """Draws round the print fit; the same draws a deviation of ten away do not."""
    lines = module("ljung_lines")
    printed = {"lines": [99.2, 0.15, 0.24, 0.26, 0.12, 0.03]}
    row = np.array([*printed["lines"], 0, 0])
    draws = [{"lines": row + wiggle} for wiggle in (-0.003, 0.0, 0.003, 0.001)]
    assert not lines.fit(draws, printed, {"lines": range(1, 6)}).differing()
    away = [{"lines": one["lines"] + 0.06} for one in draws]
    assert len(lines.fit(away, printed, {"lines": range(1, 6)}).differing()) == 5


# The sentences of the report follow from the results they are given


def test_whether_two_counts_can_be_of_one_field_follows_from_them(
    module: Callable[[str], ModuleType], reproduce: ModuleType
) -> None:
    """Table 1 and the captions of Figure 1; the figure has fewer triangles, or the table."""
    words = module("ljung_words")
    captions, implied = reproduce.of_both()
    assert words.one_field(captions, implied).endswith("are not of the same data")
    assert words.one_field(captions, captions).endswith("may be of the same data")
    assert "The figure must show a field of smaller" in words.of_which_waves(captions, implied)
    assert "The table must be of a field of smaller" in words.of_which_waves(implied, captions)
    mixed = {**implied, "real_triangles": 1}
    assert words.of_which_waves(captions, mixed).endswith("Neither has fewer triangles throughout.")


def test_a_bound_is_kept_or_broken(module: Callable[[str], ModuleType]) -> None:
    """Section 4.2: at most 25 pairs in a voxel."""
    bound = module("ljung_words").bound
    assert bound(25, 25).endswith("a bound, kept")
    assert bound(26, 25).endswith("a bound, broken")


def test_how_far_a_number_is_from_a_printed_range(module: Callable[[str], ModuleType]) -> None:
    """Section 4.2: typically 2 to 3 pairs."""
    beyond = module("ljung_words").beyond
    assert [beyond(x, 2, 3) for x in (2.5, 4.03, 1.5)] == [
        "in the range",
        "+1.03 beyond the range",
        "-0.50 beyond the range",
    ]


def test_words_on_times_are_held_against_every_run(module: Callable[[str], ModuleType]) -> None:
    """Section 7: traversal takes almost all of the time, and the segments little beside."""
    quoted = module("ljung_scaling")._quoted
    assert quoted([0.9, 0.8], [0.1, 0.2], "").differing() == []
    assert [row.ours for row in quoted([0.9, 0.1], [3.0, 0.2], "").rows] == [1, 1]
