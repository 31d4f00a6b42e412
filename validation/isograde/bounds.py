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
from contextlib import AbstractContextManager, contextmanager, nullcontext
from types import FrameType

from isograde.model import Outcome

# Judge answers of so many vertices and simplices, and so many more a sample.
LEAST, A_SAMPLE = 20_000, 1000
# Give a claim up on one case after so many seconds.
SECONDS = 120.0
# Look so often whether that is over.
TICK = 0.2


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
    """The system's clock, which rings again and again while something is timed.

    limits : when each limit that is open is over, and of how many seconds it is
    heard : it rings now
    """

    def __init__(self) -> None:
        self.limits: list[tuple[float, float]] = []
        self.heard = False

    def there(self) -> bool:
        """Whether it can ring here: the system has one, and this is the main thread."""
        main = threading.current_thread() is threading.main_thread()
        return main and hasattr(signal, "SIGALRM")

    def ring(self, number: int, frame: FrameType | None) -> None:
        """Raise `GivenUp` where a limit is over, the one that was over first."""
        del number, frame
        if not self.limits:
            return
        end, seconds = min(self.limits)
        if time.monotonic() >= end:
            raise GivenUp(f"given up: judging it took more than {seconds:g} s")


_CLOCK = _Clock()


@contextmanager
def hearing(tick: float = TICK) -> Iterator[None]:
    """The clock rings every so many seconds; to start it for each `at_most` would take longer.

    What is inside may take one ring for its own, so it goes on ringing.
    """
    if _CLOCK.heard or not _CLOCK.there():
        yield
        return
    start = time.monotonic()
    before = signal.signal(signal.SIGALRM, _CLOCK.ring)
    left, again = signal.setitimer(signal.ITIMER_REAL, tick, tick)
    _CLOCK.heard = True
    try:
        yield
    finally:
        _CLOCK.heard = False
        # Somebody else's clock goes on.
        rest = max(1e-3, left - (time.monotonic() - start)) if left else 0.0
        signal.setitimer(signal.ITIMER_REAL, rest, again)
        signal.signal(signal.SIGALRM, before)


def at_most(seconds: float) -> AbstractContextManager[None]:
    """What is done inside raises `GivenUp` when it takes longer, to within `TICK`.

    Where the system has no such clock, and outside the main thread, it takes as long as it takes.
    One inside another ends with whichever is over first.
    """
    if seconds == math.inf or not _CLOCK.there():
        return nullcontext()
    return _Limit(seconds) if _CLOCK.heard else _heard(seconds)


@contextmanager
def _heard(seconds: float) -> Iterator[None]:
    """The same, where the clock does not ring yet."""
    with hearing(min(TICK, seconds)), _Limit(seconds):
        yield


class _Limit(AbstractContextManager[None]):
    """A limit that is open, while the clock rings."""

    def __init__(self, seconds: float) -> None:
        self.limit = time.monotonic() + seconds, seconds

    def __enter__(self) -> None:
        _CLOCK.limits.append(self.limit)

    def __exit__(self, *raised: object) -> None:
        _CLOCK.limits.remove(self.limit)
