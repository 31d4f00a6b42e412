"""What judging itself may cost: an answer beyond any use is not judged, and that is said.

A surface of a lattice has a few simplices a cell; who samples on a finer lattice of their own has
some hundreds. Far beyond that an answer is no attempt at the case, and its structure alone is
judged. A claim that takes minutes on one answer is given up as well.
"""

from __future__ import annotations

import math
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from isograde.model import Outcome

# Judge answers of so many vertices and simplices, and so many more a sample.
LEAST, A_SAMPLE = 20_000, 1000
# Give a claim up on one case after so many seconds.
SECONDS = 120.0
AGAIN = 0.2


class GivenUp(Exception):  # noqa: N818 - a limit, not an error
    """Judging one claim on one case took too long; the message says which limit that is."""


def beyond(outcome: Outcome, samples: int) -> str:
    """Why an answer is too large to be judged beyond its structure, or nothing."""
    most = LEAST + A_SAMPLE * samples
    for name, array in (("vertices", outcome.vertices), ("simplices", outcome.simplices)):
        if array is not None and array.ndim and len(array) > most:
            return (
                f"not judged: {len(array):,} {name} for {samples:,} samples, and no more than "
                f"{most:,} are judged"
            )
    return ""


class _Clock:
    """The system's clock for this process; where it has none, and for other threads, never one.

    limits : seconds of what is timed now, the innermost last
    heard : who hears it ring is settled
    """

    def __init__(self) -> None:
        self.limits: list[float] = []
        self.heard = False

    def there(self) -> bool:
        """Whether it can ring here."""
        main = threading.current_thread() is threading.main_thread()
        return main and hasattr(signal, "SIGALRM")

    def ring(self, number: int, frame: FrameType | None) -> None:
        """Raise `GivenUp`, where something is timed."""
        del number, frame
        if self.limits:
            raise GivenUp(f"given up: judging it took more than {self.limits[-1]:g} s")


_CLOCK = _Clock()


@contextmanager
def hearing() -> Iterator[None]:
    """Every `at_most` inside rings here; to settle that for each takes longer than many a claim."""
    if _CLOCK.heard or not _CLOCK.there():
        yield
        return
    before = signal.signal(signal.SIGALRM, _CLOCK.ring)
    _CLOCK.heard = True
    try:
        yield
    finally:
        _CLOCK.heard = False
        signal.signal(signal.SIGALRM, before)


@contextmanager
def at_most(seconds: float) -> Iterator[None]:
    """What is done inside raises `GivenUp` when it takes longer.

    Where the system has no such clock, and outside the main thread, it takes as long as it takes.
    One inside another ends with whichever is over first.
    """
    if seconds == math.inf or not _CLOCK.there():
        yield
        return
    left, _ = signal.getitimer(signal.ITIMER_REAL)
    if left and left <= seconds:
        yield  # The clock outside is over first.
        return
    with hearing():
        start = time.monotonic()
        _CLOCK.limits.append(seconds)
        # Ring again and again: what is inside may have taken the first for its own.
        signal.setitimer(signal.ITIMER_REAL, seconds, AGAIN)
        try:
            yield
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
            _CLOCK.limits.pop()
            if left:
                rest = max(1e-3, left - (time.monotonic() - start))
                signal.setitimer(signal.ITIMER_REAL, rest, AGAIN)
