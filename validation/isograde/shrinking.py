"""The smallest and simplest part of a case on which a claim still fails.

First the samples. Slabs are dropped from either end of each axis, half of the samples at first and
then less, for as long as the claim fails on what is left: no further outer layer can go. Then the
values, which are spelt out (`isograde.cases.given`): the isovalue becomes 0 and the spacing 1, each
value gets the fewest digits, as many as can be become 1 or -1, and as many of those that are inside
as can be go outside; and layers are dropped once more. Whatever is tried is kept only where the
claim still fails, in the same way: on a field in general position where the first one was, and with
the same kind of numbers beside it. All is found within a number of calls, not at any price.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from isoref.field import Booleans, Field, Floats

from isograde.cases import blocks, given
from isograde.formats.reading import VolumeError
from isograde.model import Case, Claim, Verdict
from isograde.runner import Judged, Task, Worker

SECONDS = 6.0
# A call that ran out of time is not asked again and again.
SHRUNK = (Verdict.FAIL, Verdict.ERROR, Verdict.CRASH)
# Round to so many significant digits, the fewest first.
DIGITS = (1, 2, 3, 4, 6)


@dataclass
class Shrinking:
    """One claim that fails on a case, and how long to look for a smaller one."""

    worker: Worker
    claim: Claim
    first: Judged
    deadline: float

    @property
    def late(self) -> bool:
        """There is no time left."""
        return time.monotonic() > self.deadline

    def fails(self, case: Case) -> Judged | None:
        """The judgement of the case, where the claim is one for it and fails as it did at first."""
        if case.samples < 2**case.kind.n or (self.claim.tags and not self.claim.tags & case.tags):
            return None
        judged = self.worker.judge(Task(case.id, (self.claim.id,)))
        alike = _way(judged, self.claim.id) == _way(self.first, self.claim.id)
        return judged if alike else None


def _way(judged: Judged, claim: str) -> tuple[object, ...]:
    """In which way the claim fails: on general values, with which numbers, by which faults."""
    finding = judged.findings[claim]
    if finding.verdict not in SHRUNK:
        return (object(),)
    # Of cells, what is wrong with them; of variants, which one; of edges and vertices, which.
    faults = {fault for _, fault, _ in finding.numbers.get("faults", [])}
    return (
        bool(judged.general),
        finding.verdict,
        frozenset(finding.numbers) & {"vertices", "facets", "spanning", "signs"},
        frozenset(faults),
        # Whether the level set is that beside the isovalue, since a saddle is on it.
        judged.evidence is not None
        and finding.numbers.get("isovalue", judged.evidence.isovalues[0])
        != judged.evidence.isovalues[0],
        # Of a hole, whether it is none once equal vertices are one.
        finding.numbers.get("boundary_facets_after_welding", -1) == 0,
    )


def shrink(
    worker: Worker, case: Case, claim: Claim, first: Judged, seconds: float = SECONDS
) -> Judged | None:
    """The smallest and simplest part of the case found in this time; None where none is smaller.

    `first` is the judgement of the whole case. A part's claims are judged with what is known of it,
    which is nothing but its samples.
    """
    try:
        shape = case.build().shape
    except VolumeError:
        return None
    start = time.monotonic()
    shrinking = Shrinking(worker, claim, first, start + seconds)
    ranges, best = _cut(shrinking, case, tuple((0, n) for n in shape))
    # Have as long again for the values: of a case that is slow to judge there are few tries.
    shrinking.deadline = max(shrinking.deadline, time.monotonic() + seconds / 2)
    part = case if best is None else blocks.block(case, ranges)
    return _simplified(shrinking, part) or best


# --- samples ------------------------------------------------------------------------------------


def _cut(
    shrinking: Shrinking, case: Case, ranges: blocks.Ranges
) -> tuple[blocks.Ranges, Judged | None]:
    """The least ranges of the case on which the claim fails, judged."""
    best, smaller = None, True
    while smaller:
        smaller = False
        for tried in _candidates(ranges):
            if shrinking.late:
                return ranges, best
            judged = shrinking.fails(blocks.block(case, tried))
            if judged is not None:
                best, ranges, smaller = judged, tried, True
                break
    return ranges, best


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


# --- values -------------------------------------------------------------------------------------


def _simplified(shrinking: Shrinking, case: Case) -> Judged | None:
    """The case spelt out with the simplest values found, judged; None where that is no failure."""
    field, levels = case.build(), case.isovalues
    if field.values.size > given.MOST or field.values.dtype.kind not in "fiu":
        return None
    field = Field.of(field.values, field.spacing, dimension=field.dimension)
    best = _spelt(shrinking, field, levels)
    if best is None:
        return None
    evenly = Field.of(field.values, dimension=field.dimension)
    for tried in (_plainly(field, levels), (evenly, levels)):
        if (judged := _spelt(shrinking, *tried)) is not None:
            best, (field, levels) = judged, tried
            break
    if field.values.dtype.kind != "f":
        return best
    spelt = _Values(shrinking, field, levels, best)
    spelt.round()
    spelt.ones()
    spelt.outside()
    spelt.cut()
    return spelt.best


def _plainly(field: Field, levels: tuple[float, ...]) -> tuple[Field, tuple[float, ...]]:
    """The same level sets of floats at isovalue 0, at spacing 1."""
    level = _levels(field, levels)
    values = np.asarray(field.values, np.float64) - level
    return Field.of(values, dimension=field.dimension), (0.0,) * len(levels)


def _levels(field: Field, levels: tuple[float, ...]) -> Floats:
    """The isovalues, in the shape in which they are taken off the samples."""
    one = np.asarray(levels, np.float64)
    return one.reshape(-1, *[1] * field.dimension) if len(levels) > 1 else one


def _spelt(shrinking: Shrinking, field: Field, levels: tuple[float, ...]) -> Judged | None:
    """The judgement of the case that spells this field out, where the claim fails."""
    case = given.parse(given.name(field, levels))
    return None if case is None else shrinking.fails(case)


@dataclass
class _Values:
    """Samples that become simpler while the claim fails."""

    shrinking: Shrinking
    field: Field
    levels: tuple[float, ...]
    best: Judged

    @property
    def above(self) -> Floats:
        """The samples, less their isovalues."""
        return np.asarray(self.field.values, np.float64) - _levels(self.field, self.levels)

    def take(self, above: Floats) -> bool:
        """Take these samples, less their isovalues, where they are others and the claim fails."""
        if self.shrinking.late:
            return False
        values = np.ascontiguousarray(above + _levels(self.field, self.levels))
        if np.array_equal(values, self.field.values):
            return False
        field = Field.of(values, self.field.spacing, dimension=self.field.dimension)
        judged = _spelt(self.shrinking, field, self.levels)
        if judged is not None:
            self.field, self.best = field, judged
        return judged is not None

    def round(self) -> None:
        """The samples have the fewest significant digits, all at once."""
        above = self.above
        for digits in DIGITS:
            if self.take(_rounded(above, digits)):
                return

    def ones(self) -> None:
        """As many samples as can be are 1 or -1: all, then halves, quarters and so on, one by one.

        Those that cannot be have the fewest digits, each by itself.
        """
        self._each(lambda above, some: np.where(some, np.sign(above), above))
        self._each(lambda above, some: np.where(some, _rounded(above, 1), above), last=True)

    def outside(self) -> None:
        """As many samples as can be are outside."""
        self._each(lambda above, some: np.where(some & (above > 0), -1.0, above), last=True)

    def cut(self) -> None:
        """No outer layer can go, now that the values are others."""
        smaller = True
        while smaller:
            smaller = False
            for tried in _candidates(tuple((0, n) for n in self.field.shape)):
                window: Any = (..., *(slice(start, stop) for start, stop in tried))
                if self.take(self.above[window]):
                    smaller = True
                    break

    def _each(self, change: Callable[[Floats, Booleans], Floats], last: bool = False) -> None:
        """Change as many samples as can be, in runs of half as many each time; `last`: singly."""
        count = self.field.values.size
        size = 1 if last else count
        while size:
            for start in range(0, count, size):
                some = np.zeros(count, bool)
                some[start : start + size] = True
                self.take(change(self.above, some.reshape(self.field.values.shape)))
            size //= 2


def _rounded(values: Floats, digits: int) -> Floats:
    """The numbers to so many significant digits; what is not 0 stays so."""
    rounded = [float(f"{x:.{digits - 1}e}") for x in values.ravel().tolist()]
    return np.array(rounded, np.float64).reshape(values.shape)
