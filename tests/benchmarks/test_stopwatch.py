import os
import time

import numpy as np
import pytest
from stopwatch import Timing, interleave, machine_state, peak_memory


def test_contestants_take_turns() -> None:
    """A B B A A B .., after one warm-up each."""
    order: list[str] = []
    timings = interleave({"a": lambda: order.append("a"), "b": lambda: order.append("b")}, 3)
    assert "".join(order) == "ab" + "abbaab"
    assert [t.name for t in timings] == ["a", "b"]
    assert timings[0].ratio == 1.0
    assert all(len(timing.seconds) == 3 for timing in timings)


def test_a_slower_contestant_has_a_ratio_above_one() -> None:
    """The ratio is that of the medians beside it, so that a reader can check it."""
    fast, slow = interleave({"f": lambda: time.sleep(0.002), "s": lambda: time.sleep(0.02)}, 3)
    assert slow.ratio > fast.ratio == 1.0
    assert slow.ratio == slow.median / fast.median
    assert slow.shown(3).startswith(f"{slow.median:.3f} ({min(slow.seconds):.3f} to ")


def test_the_state_of_the_machine_names_versions_and_load() -> None:
    """Every report of a benchmark begins with it."""
    state = machine_state("VTK 9")
    assert np.__version__ in state
    assert f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors" in state
    assert "VTK 9" in state


def test_ratios_are_taken_round_by_round() -> None:
    """With their quartiles; of processor time where that is known."""
    one = Timing("one", (1.0, 2.0, 3.0), 2.0)
    two = Timing("two", (2.0, 8.0, 3.0), 2.0)
    assert two.over(one) == (2.0, 1.5, 3.0)
    assert one.over(one) == (1.0, 1.0, 1.0)
    slept, worked = interleave({"a": lambda: time.sleep(0.02), "b": lambda: sum(range(10**5))}, 3)
    assert max(slept.processor) < min(slept.seconds) / 2
    assert worked.over(slept)[0] > 1


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
