"""Numbers with a known error, and the integers that are taken where it leaves a sign open."""

from fractions import Fraction
from math import lcm
from typing import Any

import numpy as np
import pytest
from isograde.oracles.bounded import integers
from isoref.field import Array

RANDOM = np.random.default_rng(0)
ROWS: dict[str, tuple[Array, Any]] = {
    "doubles": (RANDOM.normal(size=(40, 8)), 0.1),
    "single precision": (RANDOM.normal(size=(40, 8)).astype(np.float32), 0.1),
    "half precision": (RANDOM.normal(size=(40, 8)).astype(np.float16), 0),
    "whole numbers": (RANDOM.integers(-5, 6, (40, 8)), 0.5),
    "bytes": (RANDOM.integers(0, 256, (40, 8)).astype(np.uint8), 3.0),
    "booleans": (RANDOM.integers(0, 2, (40, 8)).astype(bool), 0.5),
    "large whole numbers": (RANDOM.integers(-(2**62), 2**62, (40, 8)), 0.5),
    "unsigned": (RANDOM.integers(2**63, 2**64, (40, 8), np.uint64), 1),
    "tiny and huge": (RANDOM.choice([0, 5e-324, -1e-310, 1e300, -2.5], (40, 8)), 0.0),
    "nothing": (np.zeros((3, 8)), 0.0),
    "no row": (np.zeros((0, 8)), 0.0),
    "fractions": (np.array([[Fraction(1, 3), Fraction(-2, 7)]], object), Fraction(1, 5)),
}


def by_fractions(rows: Array, zero: Any) -> list[list[int]]:
    """Each row less zero, over the least common denominator."""
    found = []
    for row in rows.tolist():
        numbers = [Fraction(x) - Fraction(zero) for x in row]
        scale = lcm(*(x.denominator for x in numbers))
        found.append([int(x * scale) for x in numbers])
    return found


@pytest.mark.parametrize("name", ROWS)
def test_integers_are_the_numbers_less_zero_up_to_a_factor(name: str) -> None:
    """Beside fractions: each row is theirs times one positive number; Python's integers."""
    rows, zero = ROWS[name]
    found, wanted = integers(rows, zero), by_fractions(rows, zero)
    assert found.shape == rows.shape
    assert found.dtype == object
    for one, other in zip(found.tolist(), wanted, strict=True):
        assert all(type(x) is int for x in one)
        place = next((i for i, x in enumerate(other) if x), None)
        factor = Fraction(one[place], other[place]) if place is not None else Fraction(1)
        assert factor > 0
        assert one == [factor * x for x in other]


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_no_number_is_refused(bad: float) -> None:
    with pytest.raises((ValueError, OverflowError), match="cannot convert"):
        integers(np.array([[1.0, bad]]))
