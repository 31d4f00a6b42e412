"""Ratios of times taken in turn, on one machine, and what else that machine did meanwhile.

An absolute time says little: machines differ and drift. Whatever is timed here is therefore called
in turn with what it is compared with, A B C B C A .., and medians are quoted with their spread, and
ratios, so that a reader can check one against the other. A `Machine` watches what others used of
the processors meanwhile: a ratio of a busy machine is rough, and every page says so.
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import math
import multiprocessing
import os
import platform
import statistics
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import NamedTuple

import numpy as np
import psutil

# Others may use so much of each processor on a machine that is called quiet.
QUIET = 0.1
# Of fewer seconds the ticks of the processors' clocks tell nothing.
TELLING = 0.5
TWICE = 2


class Cost(NamedTuple):
    """What one call cost: seconds of the clock, and of the processors where these are known."""

    seconds: float
    processor: float | None = None


@dataclass(frozen=True)
class Timing:
    """Seconds of one contestant, a number a round, and the median of the first contestant.

    processor : seconds of the processors that it used, which others on the machine disturb less,
        though they share its caches and its memory; empty where they are not known
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

        Of processor time, where it is known of both; else of the clock. Of the rounds that both
        were asked in, for who is slow is asked in fewer (`in_turn`).
        """
        known = bool(self.processor and other.processor)
        own, theirs = (t.processor if known else t.seconds for t in (self, other))
        return quartiles([a / b for a, b in zip(own, theirs, strict=False)])

    def shown(self, digits: int = 4, scale: float = 1.0) -> str:
        """The median, times `scale`, with the least and the largest of the rounds.

        >>> Timing("a", (0.25, 0.5, 1.0), 0.5).shown(2)
        '0.50 (0.25 to 1.00)'
        """
        least, most = min(self.seconds) * scale, max(self.seconds) * scale
        return f"{self.median * scale:.{digits}f} ({least:.{digits}f} to {most:.{digits}f})"


def quartiles(numbers: Sequence[float]) -> tuple[float, float, float]:
    """Median, lower and upper quartile.

    >>> quartiles([1.0, 2.0, 3.0])
    (2.0, 1.5, 2.5)
    >>> quartiles([4.0])
    (4.0, 4.0, 4.0)
    """
    if len(numbers) == 1:
        return numbers[0], numbers[0], numbers[0]
    low, middle, high = statistics.quantiles(numbers, n=4, method="inclusive")
    return middle, low, high


class Machine:
    """The machine since this was made: what it is, and what others used of its processors.

    What this process and its children use is their own, whether they live or have ended. Processors
    count in ticks of a hundredth of a second, so of less than `TELLING` seconds nothing is said.
    """

    def __init__(self) -> None:
        self.processors = os.cpu_count() or 1
        self.load = psutil.getloadavg()[0]
        self._start, self._busy, self._own = time.monotonic(), _busy(), _own()

    @property
    def passed(self) -> float:
        """Seconds since this was made."""
        return time.monotonic() - self._start

    @property
    def others(self) -> float:
        """How many processors others kept busy until now, on average."""
        return self._used(self.passed)

    def _used(self, passed: float) -> float:
        """The same of so many seconds."""
        if passed < TELLING:
            return 0.0
        used = ((_busy() - self._busy) - (_own() - self._own)) / passed
        return min(max(0.0, used), float(self.processors))

    @property
    def quiet(self) -> bool:
        """Others used next to nothing until now."""
        return self.others <= QUIET * self.processors

    def state(self, *more: str) -> str:
        """The machine, the versions, and whether it was quiet until now, in one sentence.

        more : said of versions beside Python's and NumPy's
        """
        busy = f"load {self.load:.1f} on {self.processors} processors when this began"
        passed = self.passed
        if passed >= TELLING:
            others = self._used(passed)
            quiet = others <= QUIET * self.processors
            told = "a quiet machine" if quiet else "a busy machine: the ratios are rough"
            busy += f"; others used {others:.2f} of them meanwhile, {told}"
        versions = f"Python {platform.python_version()}, NumPy {np.__version__}"
        return ", ".join([platform.machine(), versions, *more, busy])


def _busy() -> float:
    """Seconds that all processors have worked since the machine started."""
    times = psutil.cpu_times()
    idle = times.idle + getattr(times, "iowait", 0.0)
    guests = getattr(times, "guest", 0.0) + getattr(times, "guest_nice", 0.0)
    return float(sum(times) - idle - guests)  # What guests use is counted as the user's too.


def _own() -> float:
    """Seconds of the processors that this process and its children have used."""
    ended = os.times()
    total = time.process_time() + ended.children_user + ended.children_system
    for child in psutil.Process().children(recursive=True):
        with contextlib.suppress(psutil.Error):
            used = child.cpu_times()
            total += used.user + used.system + used.children_user + used.children_system
    return total


def interleave(
    contestants: Mapping[str, Callable[[], object]], rounds: int = 5, *, enough: float = math.inf
) -> list[Timing]:
    """One `Timing` a contestant, run in this process, in turn, after one warm-up each.

    enough : as in `in_turn`
    """
    for run in contestants.values():
        run()
    costs = {name: timed(run) for name, run in contestants.items()}
    return in_turn(costs, rounds, enough=enough)


def in_turn(
    contestants: Mapping[str, Callable[[], Cost]],
    rounds: int = 5,
    *,
    seconds: float = math.inf,
    least: int = 3,
    enough: float = math.inf,
) -> list[Timing]:
    """One `Timing` a contestant of calls that tell what they cost, asked in turn `rounds` times.

    Each round begins with the next contestant and goes on by another step (`orders`): who follows
    one that gives much memory back pays for what the system does about it, and that should not
    always be the same.

    seconds : no further round is begun after so many, but `least` rounds are made
    enough : who has taken so many in two rounds is not asked in another
    """
    if not contestants or rounds < 1:
        raise ValueError("name at least one contestant and one round")
    costs: dict[str, list[Cost]] = {name: [] for name in contestants}
    begun = time.monotonic()
    for turn, order in enumerate(orders(list(contestants), rounds)):
        if turn >= least and time.monotonic() - begun > seconds:
            break
        for name in order:
            if turn >= TWICE and sum(cost.seconds for cost in costs[name][:TWICE]) > enough:
                continue
            gc.collect()
            costs[name].append(contestants[name]())
    median = statistics.median(cost.seconds for cost in next(iter(costs.values())))
    return [_timing(name, own, median) for name, own in costs.items()]


def orders(names: Sequence[str], rounds: int) -> list[list[str]]:
    """The order of each round: it begins with the next name, and who follows whom changes, too.

    A round takes every s-th name, round and round, where s shares no factor with their number.

    >>> ["".join(order) for order in orders("abcde", 4)]
    ['abcde', 'bdace', 'cadbe', 'dcbae']
    """
    count = len(names)
    steps = [step for step in range(1, max(count, 2)) if math.gcd(step, count) == 1]
    return [
        [names[(turn + steps[turn % len(steps)] * i) % count] for i in range(count)]
        for turn in range(rounds)
    ]


def _timing(name: str, costs: Sequence[Cost], first: float) -> Timing:
    """The timing that these costs make."""
    processor = tuple(cost.processor for cost in costs if cost.processor is not None)
    known = processor if len(processor) == len(costs) else ()
    return Timing(name, tuple(cost.seconds for cost in costs), first, known)


def timed(run: Callable[[], object]) -> Callable[[], Cost]:
    """A call that is run in this process, and tells what it cost."""

    def asked() -> Cost:
        start, used = time.perf_counter(), time.process_time()
        run()
        spent = time.process_time() - used
        return Cost(time.perf_counter() - start, spent)

    return asked


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
