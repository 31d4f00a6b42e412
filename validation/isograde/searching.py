"""The search for new failures: fields that the frozen plan does not have, made smaller and kept.

Hypothesis draws fields of the kinds that the implementation takes: a shape, numbers of one of
several *styles*, a type, an isovalue, a spacing. Each is judged by every claim that is looked for.
Where one fails, Hypothesis makes the field smaller and its numbers simpler for as long as the claim
fails; the smallest is kept, the claim is put aside, and the search goes on for the others until the
time is over.

A claim that the plan finds broken needs no search: `looked_for` leaves out those that a report of
the implementation says have failed, so that what is found is new.

Styles
------
plain       small whole numbers round an isovalue of 1/2: general position, easy to read
ties        small whole numbers round an isovalue of 0, on which samples and saddles lie
edges       like plain, but constant along one axis but for its ends
uneven      whole numbers times powers of two from 2^-20 to 2^20, each sample its own
scaled      plain times one number from 1e-12 to 1e12
far         plain over 1024, plus 1e4 or 1e6: the differences take the last of the digits
"""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from dataclasses import field as fresh
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Any

import numpy as np
from isoref.field import Field

from isograde.cases import own
from isograde.model import BAD, Case, Claim, Finding, Kind, Verdict
from isograde.runner import Task, Worker

if TYPE_CHECKING:
    from hypothesis.strategies import SearchStrategy

#: Lattices of so many axes at most, and so many samples along each, by the number of axes.
LARGEST = {1: 12, 2: 7, 3: 5, 4: 3}
STYLES = ("plain", "ties", "edges", "uneven", "scaled", "far")
SCALES = (1e-12, 1e-9, 1e-7, 1e-5, 1e-3, 1e3, 1e6, 1e12)
OFFSETS = (1e4, -1e4, 1e6)
TYPES = ("<f8", "<f4", "|i1", "|u1", "<i2", ">i2", "<i4", ">f4", ">f8")
SPACINGS = (1.0, 0.5, 3.0, 1e-3, 1e3)
#: The share of the time that is left in which a failure may be made smaller, and the share of the
#: whole time after which the other kind of claims has its turn.
PATIENCE, SLICE = 0.25, 0.15
#: Claims that are judged on known bodies or convergence alone need another kind of case.
NEEDS_KNOWN = ("bodies.*", "accuracy.*", "curves.*", "simplices.*")


@dataclass(frozen=True)
class Found:
    """A failure: the claim, its finding, and the case as an entry of a file."""

    claim: str
    finding: Finding
    entry: own.Entry


@dataclass
class Tally:
    """What a search has done so far."""

    fields: int = 0
    calls: int = 0
    found: list[Found] = fresh(default_factory=list)


Watch = Callable[[Tally], None]


class TimeIsUp(KeyboardInterrupt):
    """Ends a round at once; as no `Exception`, Hypothesis lets it through."""


class BrokenError(AssertionError):
    """A claim failed."""


def looked_for(worker: Worker, globs: Iterable[str] = (), known: Iterable[str] = ()) -> list[Claim]:
    """The claims to search for: those asked for, or all that are promised, but the known ones."""
    asked, failed = tuple(globs), set(known)
    found = []
    for name, claim in worker.claims.items():
        if asked:
            wanted = any(fnmatchcase(name, glob) for glob in asked)
        else:
            wanted = claim.held(worker.declaration) and name not in failed
        needs_known = any(fnmatchcase(name, glob) for glob in NEEDS_KNOWN)
        if wanted and not needs_known and (not claim.tags or claim.tags & own.TAGS):
            found.append(claim)
    return found


def search(
    worker: Worker,
    claims: Iterable[Claim],
    by: str,
    minutes: float,
    seed: int = 0,
    watch: Watch = lambda _: None,
    most: int = 0,
) -> Tally:
    """Failures of these claims, the smallest seen of each, in this time.

    Claims that look at one answer and claims that compare several take turns: a field posed in
    fifty ways costs as much as fifty fields.

    most : so many fields a turn at most, and an end when neither kind of claims has a failure in
        its turn; 0 for no such bound. What is found then depends on the seed alone.

    Raises
    ------
    ModuleNotFoundError
        where Hypothesis is not installed.
    """
    import hypothesis

    del hypothesis
    tally, open_ = Tally(), list(claims)
    end = time.monotonic() + 60 * minutes
    turn = vain = 0
    while open_ and time.monotonic() < end and not (most and vain > 1):
        asked = [claim for claim in open_ if bool(claim.variants) == bool(turn % 2)]
        slice_ = min(end, time.monotonic() + 60 * minutes * SLICE)
        turn, vain = turn + 1, vain + 1
        if not asked:
            continue
        last = tally.fields + most if most else sys.maxsize
        one = Round(worker, asked, by, slice_, end, last, tally, watch).run(seed + turn)
        if one is not None:
            vain = 0
            tally.found.append(one)
            watch(tally)
            open_ = [claim for claim in open_ if claim.id != one.claim]
    return tally


@dataclass
class Round:
    """The search for one failure.

    until : when it is given up, or, once there is one, no longer made smaller
    end : when the whole search is over
    last : with which field it is given up
    """

    worker: Worker
    claims: list[Claim]
    by: str
    until: float
    end: float
    last: int
    tally: Tally
    watch: Watch
    smallest: Found | None = None
    size: tuple[int, float, int] = (0, 0.0, 0)

    def run(self, seed: int) -> Found | None:
        """The smallest failure seen of the first claim to fail; None where none did."""
        from hypothesis import HealthCheck, Phase, Verbosity, errors, given, settings
        from hypothesis import seed as seeded

        run = settings(
            max_examples=1_000_000,
            deadline=None,
            database=None,
            suppress_health_check=list(HealthCheck),
            phases=[Phase.generate, Phase.shrink],
            report_multiple_bugs=False,
            print_blob=False,
            verbosity=Verbosity.quiet,
        )(given(drawn_for(self.worker, self.claims))(self.judge))
        # A failure that does not come back is kept too: it was seen.
        with contextlib.suppress(BrokenError, TimeIsUp, errors.Flaky):
            seeded(seed)(run)()
        return self.smallest

    def judge(self, drawn: Drawn) -> None:
        """Raise `BrokenError` where the claim that is made smaller, or any at first, fails."""
        if time.monotonic() > self.until or self.tally.fields >= self.last:
            raise TimeIsUp
        self.tally.fields += 1
        self.watch(self.tally)
        before = self.smallest
        asked = [c for c in self.claims if before is None or c.id == before.claim]
        if asked and asked[0].variants and before is None:
            asked = [c for c in asked if c.id == drawn.posed]
        broken = _broken(self.worker, drawn, asked, self.by, self.tally)
        if broken is None:
            return
        if before is None:
            left = self.end - time.monotonic()
            self.until = time.monotonic() + max(left * PATIENCE, 5.0)
        if before is None or drawn.size < self.size:
            self.smallest, self.size = broken, drawn.size
        raise BrokenError(broken.claim)


def _broken(
    worker: Worker, drawn: Drawn, claims: list[Claim], by: str, tally: Tally
) -> Found | None:
    """The lowest of the claims that fails on this field, or None."""
    try:
        field = drawn.field
    except ValueError:
        return None
    name, samples = f"{own.PREFIX}candidate", int(np.prod(field.shape))
    case = Case(name, lambda: field, drawn.isovalues, samples, own.TAGS, kind=drawn.kind)
    asked = [claim.id for claim in claims if claim.applies_to(case)]
    alone = Worker(worker.adapter, worker.declaration, {case.id: case}, worker.claims)
    judged = alone.judge(Task(case.id, tuple(asked)))
    tally.calls += judged.calls
    for claim in sorted(claims, key=lambda c: (c.level is None, c.level or 0)):
        finding = judged.findings.get(claim.id, Finding(Verdict.NOT_RUN))
        if finding.verdict in BAD:
            entry = own.entry_of(field, drawn.isovalues, claim.id, by, finding.detail[:300])
            return Found(claim.id, finding, entry)
    return None


# --- What is drawn ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Drawn:
    """A field as it is drawn: whole numbers, and what is done to them.

    numbers : (m, N1, .., Nn) whole numbers
    powers : of the same shape, for the style "uneven"
    posed : the claim to ask where each needs the field posed in many ways
    """

    kind: Kind
    style: str
    numbers: Any
    powers: Any
    factor: float
    dtype: str
    spacing: tuple[float, ...]
    posed: str

    @property
    def size(self) -> tuple[int, float, int]:
        """What makes a field small: few samples, small numbers, a plain style."""
        plain = STYLES.index(self.style) + TYPES.index(self.dtype)
        return self.numbers.size, float(np.abs(self.numbers).sum()), plain

    @property
    def isovalues(self) -> tuple[float, ...]:
        """One isovalue a component."""
        level = {
            "ties": 0.0,
            "uneven": 0.0,
            "scaled": self.factor / 2,
            "far": self.factor + 2.0**-11,
        }
        return (level.get(self.style, 0.5),) * self.kind.m

    @property
    def field(self) -> Field:
        """The field. Raises `ValueError` where the type does not hold the numbers."""
        values = self.numbers.astype(np.float64)
        if self.style == "uneven":
            values = np.ldexp(values + 0.5, self.powers)
        elif self.style == "scaled":
            values = values * self.factor
        elif self.style == "far":
            values = values / 1024 + self.factor
        elif self.style == "edges" and values.shape[1] > 2:
            values[:, 1:-1] = values[:, 1:2]
        kind = np.dtype(self.dtype)
        if kind.kind in "iu":
            span = np.iinfo(kind)
            if values.min() < span.min or values.max() > span.max or (values % 1).any():
                raise ValueError(f"not numbers of type {kind}")
        typed = values.astype(kind)
        return Field.of(typed if self.kind.m > 1 else typed[0], self.spacing, dimension=self.kind.n)


def drawn_for(worker: Worker, claims: Sequence[Claim]) -> SearchStrategy[Drawn]:
    """Fields within the limits that the implementation states."""
    from hypothesis import strategies as some
    from hypothesis.extra import numpy as arrays

    limits = worker.declaration.limits
    kinds = [Kind(*kind) for kind in limits.kinds if kind[0] in LARGEST]
    types = [one for one in TYPES if not limits.types or np.dtype(one).name in limits.types]

    @some.composite
    def draw(pick: Any) -> Drawn:
        # Choose a lattice.
        kind = pick(some.sampled_from(kinds))
        low = max(2, limits.least)
        high = max(low, min(LARGEST[kind.n], limits.greatest or LARGEST[kind.n]))
        lengths = [pick(some.integers(low, high)) for _ in range(1 if limits.cubes else kind.n)]
        whole = (kind.m, *(lengths * kind.n if limits.cubes else lengths))

        # Fill it.
        style, reach = pick(some.sampled_from(STYLES)), pick(some.sampled_from((1, 3, 9)))
        numbers = pick(arrays.arrays(np.int64, whole, elements=some.integers(-reach, reach)))
        powers = np.zeros(whole, np.int64)
        if style == "uneven":
            powers = pick(arrays.arrays(np.int64, whole, elements=some.integers(-20, 20)))
        factor = pick(some.sampled_from({"scaled": SCALES, "far": OFFSETS}.get(style, (1.0,))))
        dtype = pick(some.sampled_from(types))
        spacing = tuple(pick(some.sampled_from(SPACINGS)) for _ in range(kind.n))
        posed = pick(some.sampled_from([claim.id for claim in claims]))
        return Drawn(kind, style, numbers, powers, factor, dtype, spacing, posed)

    return draw()
