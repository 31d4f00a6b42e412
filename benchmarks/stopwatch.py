"""Ratios of times taken in turn, in one process, on one machine.

An absolute time says little: machines differ and drift. Every benchmark here therefore runs its
contestants in turn, A B C B C A .., and quotes medians with their spread, and ratios of these
medians, so that a reader can check one against the other. Every report begins with
`machine_state`: what else ran can be read off the load.
"""

from __future__ import annotations

import ctypes
import gc
import multiprocessing
import os
import platform
import statistics
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from multiprocessing.connection import Connection

import numpy as np
import psutil


@dataclass(frozen=True)
class Timing:
    """Seconds of one contestant, a number a round, and the median of the first contestant.

    processor : seconds of the processor that this process used, which others on the machine
        disturb less, though they share its caches and its memory
    """

    name: str
    seconds: tuple[float, ...]
    first: float
    processor: tuple[float, ...] = ()

    @property
    def median(self) -> float:
        """Median seconds over the rounds."""
        return statistics.median(self.seconds)

    @property
    def ratio(self) -> float:
        """The median over that of the first contestant."""
        return self.median / self.first

    def over(self, other: Timing) -> tuple[float, float, float]:
        """The median of the ratios to another contestant round by round, and their quartiles.

        Of processor time, where it is known.
        """
        own, theirs = (t.processor or t.seconds for t in (self, other))
        ratios = [a / b for a, b in zip(own, theirs, strict=True)]
        if len(ratios) == 1:
            return ratios[0], ratios[0], ratios[0]
        low, middle, high = statistics.quantiles(ratios, n=4, method="inclusive")
        return middle, low, high

    def shown(self, digits: int = 4, scale: float = 1.0) -> str:
        """The median, times `scale`, with the least and the largest of the rounds.

        >>> Timing("a", (0.25, 0.5, 1.0), 0.5).shown(2)
        '0.50 (0.25 to 1.00)'
        """
        least, most = min(self.seconds) * scale, max(self.seconds) * scale
        return f"{self.median * scale:.{digits}f} ({least:.{digits}f} to {most:.{digits}f})"


def machine_state(*others: str) -> str:
    """The machine, the versions, and the load at this moment, in one sentence."""
    load, processors = os.getloadavg()[0], os.cpu_count() or 1
    quiet = "" if load < 0.25 * processors else ", a busy machine: the ratios are rough"
    busy = f"load {load:.1f} on {processors} processors when this began{quiet}"
    versions = f"Python {platform.python_version()}, NumPy {np.__version__}"
    return ", ".join([platform.machine(), versions, *others, busy])


def interleave(contestants: Mapping[str, Callable[[], object]], rounds: int = 5) -> list[Timing]:
    """One `Timing` a contestant, run in turn `rounds` times after one warm-up each.

    Each round begins with the next contestant: who follows one that gives much memory back pays for
    what the system does about it, and that should not always be the same.
    """
    if not contestants or rounds < 1:
        raise ValueError("name at least one contestant and one round")
    for run in contestants.values():
        run()
    seconds: dict[str, list[float]] = {name: [] for name in contestants}
    processor: dict[str, list[float]] = {name: [] for name in contestants}
    names = list(contestants)
    for turn in range(rounds):
        first = turn % len(names)
        for name in names[first:] + names[:first]:
            run = contestants[name]
            gc.collect()
            start, used = time.perf_counter(), time.process_time()
            run()
            processor[name].append(time.process_time() - used)
            seconds[name].append(time.perf_counter() - start)
    median = statistics.median(seconds[names[0]])
    return [
        Timing(name, tuple(own), median, tuple(processor[name])) for name, own in seconds.items()
    ]


def peak_memory(run: Callable[[], object], interval: float = 0.001) -> int:
    """Bytes by which resident memory rose at its highest while `run` ran in a child process.

    The child is forked, so that `run` may be any closure, and what earlier runs left in the
    allocator is handed back first. Sampled every `interval` seconds from a thread, so that native
    code is counted too; a shorter spike can be missed. POSIX only.

    Raises
    ------
    RuntimeError
        where the child died, with its exit code.
    """
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    child = context.Process(target=_report_peak, args=(run, interval, sender))
    child.start()
    sender.close()
    try:
        return int(receiver.recv())
    except EOFError:
        child.join()
        raise RuntimeError(f"the measured call ended with exit code {child.exitcode}") from None
    finally:
        child.join()


def _report_peak(run: Callable[[], object], interval: float, sender: Connection) -> None:
    """Send the rise of resident memory while `run` ran."""
    gc.collect()
    libc = ctypes.CDLL(None)
    if hasattr(libc, "malloc_trim"):
        libc.malloc_trim(0)
    process = psutil.Process()
    before = highest = process.memory_info().rss
    done = threading.Event()

    def watch() -> None:
        nonlocal highest
        while not done.wait(interval):
            highest = max(highest, process.memory_info().rss)

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    result = run()
    highest = max(highest, process.memory_info().rss)
    done.set()
    watcher.join()
    del result
    sender.send(highest - before)
