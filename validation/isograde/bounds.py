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


@contextmanager
def at_most(seconds: float) -> Iterator[None]:
    """What is done inside raises `GivenUp` when it takes longer.

    Where the system has no such clock, and outside the main thread, it takes as long as it takes.
    One inside another ends with whichever is over first.
    """
    if seconds == math.inf:
        yield
        return
    if threading.current_thread() is not threading.main_thread() or not hasattr(signal, "SIGALRM"):
        yield
        return

    left, _ = signal.getitimer(signal.ITIMER_REAL)
    if left and left <= seconds:
        yield  # The clock outside is over first.
        return

    def ring(number: int, frame: FrameType | None) -> None:
        del number, frame
        raise GivenUp(f"given up: judging it took more than {seconds:g} s")

    start = time.monotonic()
    before = signal.signal(signal.SIGALRM, ring)
    # Ring again and again: what is inside may have taken the first for its own.
    signal.setitimer(signal.ITIMER_REAL, seconds, AGAIN)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
        if left:
            rest = max(1e-3, left - (time.monotonic() - start))
            signal.setitimer(signal.ITIMER_REAL, rest, AGAIN)
