"""Tables that hold a printed or an expected number beside ours."""

import numpy as np
import pytest
from isograde.reproduction import Row, Table


def test_a_row_is_printed_or_expected_and_never_both() -> None:
    """The column "paper" holds printed numbers only."""
    table = Table("t")
    with pytest.raises(ValueError, match="not both"):
        table.add("cells", 3, 3, expected=3)


def test_a_table_without_printed_numbers_has_no_column_for_them() -> None:
    """A column that would be empty is left out; the heads say what the numbers are."""
    table = Table("t")
    table.add("right", None, 4, expected=4)
    assert "| expected | ours |" in table.markdown()
    assert "paper" not in table.markdown()
    table.add("cells", 3, 4)
    assert "| paper | expected | ours |" in table.markdown()
    assert "differs by +1" in table.markdown()


def test_one_more_draw_fits_as_often_as_the_level_says() -> None:
    """Bonferroni's level of 5 % over a family of five: few of 400 families differ anywhere."""
    chance = np.random.default_rng(0)
    wrong = 0
    for _ in range(400):
        table = Table("t")
        for _ in range(5):
            draws = chance.normal(7, 2, 16)
            table.add_draws("x", float(chance.normal(7, 2)), draws.tolist(), step=0.0, family=5)
        wrong += bool(table.differing())
    assert 4 <= wrong <= 36


def test_a_number_far_from_all_draws_differs_and_says_by_how_much() -> None:
    """The one-line voxels of Ljung & Ynnerman's Table 1: 0.117 +- 0.003 beside 0.15."""
    draws = [0.114, 0.117, 0.120, 0.116, 0.118, 0.117]
    table = Table("t")
    table.add_draws("lines, 1", 0.15, draws, step=0.01, family=21)
    (row,) = table.differing()
    assert row.verdict.startswith("differs by -0.033, z = -")


def test_rounding_of_the_print_widens_what_fits() -> None:
    """Draws that never vary fit a print that is rounded to the same number."""
    table = Table("t")
    table.add_draws("x", 0.12, [0.1203, 0.1203, 0.1203], step=0.01, family=1)
    assert not table.differing()


def test_a_deviation_needs_two_draws() -> None:
    """One draw says nothing of the spread."""
    with pytest.raises(ValueError, match="at least two draws"):
        Table("t").add_draws("x", 1.0, [1.0], step=0.0, family=1)


def test_words_differ_without_a_number() -> None:
    """What is no number has no difference."""
    assert Row("path", "13 0 12", "12 0 13").verdict == "differs"
