"""The two laws of growth that Min's section 6 leaves to decide."""

from typing import Any

import pytest

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
