"""Ratios of times taken in turn, in one process, on one machine.

An absolute time says little: machines differ and drift. Every benchmark here therefore runs its
contestants in turn, A B C A B C .., and quotes medians and ratios of the same round.
"""

from __future__ import annotations

import gc
import statistics
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import psutil


@dataclass(frozen=True)
class Timing:
    """Seconds of one contestant, a number a round, and its ratio to the first contestant."""

    name: str
    seconds: tuple[float, ...]
    ratios: tuple[float, ...]

    @property
    def median(self) -> float:
        """Median seconds over the rounds."""
        return statistics.median(self.seconds)

    @property
    def ratio(self) -> float:
        """Median over the rounds of this contestant's time divided by the first one's."""
        return statistics.median(self.ratios)


def interleave(contestants: Mapping[str, Callable[[], object]], rounds: int = 5) -> list[Timing]:
    """One `Timing` a contestant, run in turn `rounds` times after one warm-up each."""
    if not contestants or rounds < 1:
        raise ValueError("name at least one contestant and one round")
    for run in contestants.values():
        run()
    seconds: dict[str, list[float]] = {name: [] for name in contestants}
    for _ in range(rounds):
        for name, run in contestants.items():
            gc.collect()
            start = time.perf_counter()
            run()
            seconds[name].append(time.perf_counter() - start)
    first = seconds[next(iter(contestants))]
    return [
        Timing(name, tuple(own), tuple(a / b for a, b in zip(own, first, strict=True)))
        for name, own in seconds.items()
    ]


def peak_memory(run: Callable[[], object], interval: float = 0.002) -> int:
    """Bytes by which the resident memory of this process rose at its highest while `run` ran.

    Sampled every `interval` seconds from another thread, so that native code is counted too; a
    shorter spike can be missed.
    """
    process = psutil.Process()
    gc.collect()
    before = process.memory_info().rss
    highest = before
    done = threading.Event()

    def watch() -> None:
        nonlocal highest
        while not done.wait(interval):
            highest = max(highest, process.memory_info().rss)

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        result = run()
        highest = max(highest, process.memory_info().rss)
    finally:
        done.set()
        watcher.join()
    del result
    return int(highest - before)
