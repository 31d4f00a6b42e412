"""The smallest part of a case on which a claim still fails.

Slabs are dropped from either end of each axis, half of the samples at first and then less, for as
long as the claim fails on what is left. The result is smallest in the sense that no further outer
layer can go; it is found within a number of calls, not at any price.
"""

from __future__ import annotations

import time
from collections.abc import Iterator

from isograde.cases import blocks
from isograde.model import Case, Claim, Verdict
from isograde.runner import Judged, Task, Worker

# A cell is the least that has a surface, and two cells are small enough to be read.
SMALL = 12
SECONDS = 6.0
# A call that ran out of time is not asked again and again.
SHRUNK = (Verdict.FAIL, Verdict.ERROR, Verdict.CRASH)


def shrink(worker: Worker, case: Case, claim: Claim, seconds: float = SECONDS) -> Judged | None:
    """The smallest part of the case found in this time, judged; None where none is smaller.

    The part's claims are judged with what is known of it, which is nothing but its samples.
    """
    deadline = time.monotonic() + seconds
    shape = case.build().shape
    ranges: blocks.Ranges = tuple((0, n) for n in shape)
    best: Judged | None = None
    smaller = True
    while smaller:
        smaller = False
        for tried in _candidates(ranges):
            if time.monotonic() > deadline:
                return best
            judged = _fails(worker, blocks.block(case, tried), claim, len(shape))
            if judged is not None:
                best, ranges, smaller = judged, tried, True
                break
    return best


def _candidates(ranges: blocks.Ranges) -> Iterator[blocks.Ranges]:
    """Smaller ranges, those that drop most first; each axis keeps two samples."""
    lengths = [stop - start for start, stop in ranges]
    drops = sorted(
        {(n >> k, axis) for axis, n in enumerate(lengths) for k in range(1, n.bit_length())},
        reverse=True,
    )
    for drop, axis in drops:
        start, stop = ranges[axis]
        if drop and stop - start - drop >= 2:
            for kept in ((start, stop - drop), (start + drop, stop)):
                yield (*ranges[:axis], kept, *ranges[axis + 1 :])


def _fails(worker: Worker, case: Case, claim: Claim, dimension: int) -> Judged | None:
    """The judgement of the case, where the claim is one for it and fails."""
    if case.samples < 2**dimension or (claim.tags and not claim.tags & case.tags):
        return None
    judged = worker.judge(Task(case.id, (claim.id,)))
    return judged if judged.findings[claim.id].verdict in SHRUNK else None
