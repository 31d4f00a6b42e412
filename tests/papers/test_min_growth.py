"""The two laws of growth that Min's section 6 leaves to decide."""

from typing import Any

import pytest
from isograde.reproduction import Table

from tests.papers.loading import importer

SIZES = [32, 64, 128, 256, 512]


@pytest.fixture(scope="module")
def growth() -> Any:
    """The module."""
    return importer("min_2003")("min_growth")


def test_each_law_is_told_from_the_other(growth: Any) -> None:
    """Counts made by either law, with a lower term that the law does not have."""
    power = [7 * N**2 + 40 * N for N in SIZES]
    logarithm = [N**2 * (3 + 0.5 * (N.bit_length() - 1)) + 9 * N for N in SIZES]
    assert growth.growth(SIZES, power, 2).supported == "N^p"
    assert growth.growth(SIZES, logarithm, 2).supported == "N^p log N"


def test_the_interval_of_a_slope_is_that_of_the_fit(growth: Any) -> None:
    """A perfect power has none; a bend has one that holds the mean slope."""
    assert growth.slope(SIZES, [5 * N**3 for N in SIZES]) == (3.0, 0.0)
    found, half = growth.slope(SIZES, [5 * N**3 + 800 * N**2 for N in SIZES])
    assert 2 < found < 3
    assert half > 0.01


def test_two_sizes_decide_nothing(growth: Any) -> None:
    """Two numbers are fitted."""
    with pytest.raises(ValueError, match="three sizes"):
        growth.growth([8, 16], [1, 2], 1)


def test_an_exponent_of_times_is_measured_and_not_judged() -> None:
    """A time has a fixed cost: beside no p there is no verdict; beside one there is."""
    growth = importer("min_2003")("min_growth")
    table = Table("")
    growth.add_slope(table, "time", [8, 16, 32], [1.0, 1.5, 4.0], None)
    growth.add_slope(table, "cells", [8, 16, 32], [8.0, 16.0, 32.0], 1)
    growth.add_slope(table, "cells", [8, 16, 32], [8.0, 16.0, 32.0], 2)
    assert [row.verdict for row in table.rows] == ["measured", "exact", "differs by -1"]
