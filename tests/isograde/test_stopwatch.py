import os
import subprocess
import sys
import time
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from isograde import stopwatch
from isograde.stopwatch import (
    TELLING,
    Cost,
    Machine,
    Timing,
    in_turn,
    interleave,
    orders,
    peak_memory,
)


def test_contestants_take_turns() -> None:
    """A B B A A B .., after one warm-up each."""
    order: list[str] = []
    timings = interleave({"a": lambda: order.append("a"), "b": lambda: order.append("b")}, 3)
    assert "".join(order) == "ab" + "abbaab"
    assert [t.name for t in timings] == ["a", "b"]
    assert timings[0].ratio == 1.0
    assert all(len(timing.seconds) == 3 for timing in timings)


def test_who_follows_whom_changes_from_round_to_round() -> None:
    """With a fixed neighbour, one contestant would always pay for what that one gave back."""
    names = [f"c{i}" for i in range(18)]
    rounds = orders(names, 5)
    assert all(sorted(order) == sorted(names) for order in rounds)
    before = [order[order.index("c7") - 1] for order in rounds if order[0] != "c7"]
    assert len(before) == len(set(before)) == 5


def test_a_slower_contestant_has_a_ratio_above_one() -> None:
    """The ratio is that of the medians beside it, so that a reader can check it."""
    fast, slow = interleave({"f": lambda: time.sleep(0.002), "s": lambda: time.sleep(0.02)}, 3)
    assert slow.ratio > fast.ratio == 1.0
    assert slow.ratio == slow.median / fast.median
    assert slow.shown(3).startswith(f"{slow.median:.3f} ({min(slow.seconds):.3f} to ")


def test_the_state_of_the_machine_names_versions_and_load() -> None:
    """Every report of a benchmark begins with it."""
    machine = Machine()
    state = machine.state("VTK 9")
    assert np.__version__ in state
    assert f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors" in state
    assert "VTK 9" in state
    assert "meanwhile" not in state  # Of a moment nobody can tell.
    time.sleep(TELLING)
    assert "others used" in machine.state()
    assert machine.others <= machine.processors


def test_ratios_are_taken_round_by_round() -> None:
    """With their quartiles; of processor time where that is known."""
    one = Timing("one", (1.0, 2.0, 3.0), 2.0)
    two = Timing("two", (2.0, 8.0, 3.0), 2.0)
    assert two.over(one) == (2.0, 1.5, 3.0)
    assert one.over(one) == (1.0, 1.0, 1.0)
    slept, worked = interleave({"a": lambda: time.sleep(0.02), "b": lambda: sum(range(10**5))}, 3)
    assert max(slept.processor) < min(slept.seconds) / 2
    assert worked.over(slept)[0] > 1


def test_seconds_of_the_clock_are_not_compared_with_those_of_a_processor() -> None:
    """Of a program nobody knows the processor's: then both are the clock's."""
    known = Timing("known", (2.0, 2.0), 2.0, (1.0, 1.0))
    unknown = Timing("unknown", (4.0, 4.0), 2.0)
    assert unknown.over(known) == (2.0, 2.0, 2.0)
    assert known.over(unknown) == (0.5, 0.5, 0.5)
    mixed = in_turn({"a": lambda: Cost(1.0, 1.0), "b": lambda: Cost(2.0)}, 2)
    assert [len(timing.processor) for timing in mixed] == [2, 0]


def test_who_is_slow_is_asked_twice_and_compared_over_both_rounds() -> None:
    """In a round that it is not in, the others are asked as before."""
    seconds = iter([1.0, 2.0, 4.0, 5.0])
    slow, fast = in_turn(
        {"slow": lambda: Cost(3.0), "fast": lambda: Cost(next(seconds))}, 4, enough=5
    )
    assert slow.seconds == (3.0, 3.0)
    assert fast.seconds == (1.0, 2.0, 4.0, 5.0)
    assert slow.over(fast)[0] == (3.0 + 1.5) / 2
    assert fast.over(slow)[0] == (1 / 3 + 2 / 3) / 2
    assert len(in_turn({"a": lambda: Cost(2.0)}, 4, enough=5)[0].seconds) == 4


def test_no_round_is_begun_after_the_time_but_the_least_are_made() -> None:
    """A slow call costs so many rounds, and no more."""

    def asked() -> Cost:
        time.sleep(0.01)
        return Cost(1.0)

    slow = {"slow": asked}
    assert len(in_turn(slow, 9, seconds=0.0, least=2)[0].seconds) == 2
    assert len(in_turn(slow, 4, seconds=60.0)[0].seconds) == 4


def test_what_children_use_is_own_whether_they_live_or_have_ended() -> None:
    """A worker's work is none of a stranger's, and is not lost where it ends."""
    program = "import sys\nsum(range(10**7))\nprint(1, flush=True)\nsys.stdin.read()"
    before = stopwatch._own()
    with subprocess.Popen(
        [sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as child:
        assert child.stdout is not None
        child.stdout.readline()
        living = stopwatch._own() - before
        child.communicate()
    assert 0.05 < living <= stopwatch._own() - before + 0.02


def test_a_machine_is_quiet_where_only_we_work(monkeypatch: pytest.MonkeyPatch) -> None:
    """What all processors did, less what is our own, a second of the clock."""
    seconds = iter([0.0, 10.0, 20.0])
    clock = SimpleNamespace(monotonic=lambda: next(seconds))
    monkeypatch.setattr(stopwatch, "time", clock)
    for name, numbers in (("_busy", [100.0, 110.5, 150.0]), ("_own", [5.0, 15.0, 25.0])):
        monkeypatch.setattr(stopwatch, name, partial(next, iter(numbers)))
    machine = Machine()
    assert machine.others == pytest.approx(0.05)
    assert machine.state().endswith(
        "others used 1.50 of them meanwhile, a busy machine: the ratios are rough"
    )


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
