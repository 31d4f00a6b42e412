import os
import time

import numpy as np
import pytest
from stopwatch import interleave, peak_memory


def test_contestants_take_turns() -> None:
    """A B A B .., after one warm-up each."""
    order: list[str] = []
    timings = interleave({"a": lambda: order.append("a"), "b": lambda: order.append("b")}, 3)
    assert order == ["a", "b"] * 4
    assert [t.name for t in timings] == ["a", "b"]
    assert timings[0].ratios == (1.0, 1.0, 1.0)


def test_a_slower_contestant_has_a_ratio_above_one() -> None:
    """The ratio is taken to the first contestant, round by round."""
    fast, slow = interleave({"f": lambda: time.sleep(0.002), "s": lambda: time.sleep(0.02)}, 3)
    assert slow.ratio > fast.ratio == 1.0


def test_no_contestants_is_an_error() -> None:
    """Bad input is refused."""
    with pytest.raises(ValueError, match="at least one"):
        interleave({})


def test_peak_memory_sees_an_array_that_is_gone_afterwards() -> None:
    """A temporary of 64 MiB is counted; a second measurement sees it again."""

    def run() -> float:
        return float(np.ones(1 << 23).sum())

    for _ in range(2):
        assert 60 << 20 < peak_memory(run) < 90 << 20


def test_peak_memory_of_a_call_that_dies_is_an_error() -> None:
    """The exit code is named."""
    with pytest.raises(RuntimeError, match="exit code 3"):
        peak_memory(lambda: os._exit(3))
