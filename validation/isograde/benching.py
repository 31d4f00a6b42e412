"""What an implementation costs beside a peer: fields of growing sizes, asked in turn.

Both answer through their adapters, each in a process of its own, and the call alone is timed there:
from samples in C order to what the function returns. Of a program the adapter sees no more than the
time from the request to the answer, the text of the mesh included, unless the program tells its own
``seconds``. A round asks one and then the other, and who is first changes; a ratio is of one round.

A field is drawn in several sizes, so that time can be read against samples, active cells and
vertices. What fails on a field costs that row, and the row says how.

Glossary
--------
active cell   a cell with corners on both sides of the isovalue; of several components, of each
work          a call costs so much, each sample so much, and each active cell so much (`Work`)
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial, reduce
from itertools import product

import numpy as np
from isoref.field import Field, Floats
from numpy.typing import NDArray

from isograde.adapters import open_adapter
from isograde.declaration import Declaration
from isograde.model import (
    CONTOURS,
    CURVES,
    SURFACES,
    Adapter,
    AdapterError,
    Calls,
    Kind,
    Limits,
    Outcome,
    Request,
    Status,
)
from isograde.stopwatch import Cost, Machine, Timing, in_turn

# The peers that are tried where none is named, by kind; the reference is always there.
PEERS: Mapping[Kind, tuple[str, ...]] = {
    SURFACES: ("skimage:lewiner", "vtk:flying-edges", "pymcubes", "isoref:asymptotic-decider"),
    CONTOURS: ("skimage:find-contours", "contourpy", "isoref:diconex-mixed"),
    CURVES: ("vtk:contour-twice", "isoref:marching-faces", "isoref:surface-intersection"),
}
# Samples along each axis.
SIDES: Mapping[Kind, tuple[int, ...]] = {
    SURFACES: (32, 48, 64, 96, 128),
    CONTOURS: (128, 256, 512, 1024),
    CURVES: (16, 24, 32, 48, 64),
}
QUICK_SIDES: Mapping[Kind, tuple[int, ...]] = {
    SURFACES: (12, 18, 24),
    CONTOURS: (32, 48, 64),
    CURVES: (8, 12, 16),
}
# Asked first, so that a library has loaded what it needs before anything is measured.
FIRST_SIDE = 8
# No two calls have one isovalue, so that an answer that is remembered is of no use.
ISOVALUE, STEP = 0.013, 2.0**-20
PERIOD = 16.0
SMOOTHED = 1.5


@dataclass(frozen=True)
class Plan:
    """How much is asked: rounds of each field, and seconds after which no further one is begun."""

    rounds: int = 7
    seconds: float = 8.0
    quick: bool = False

    def sides(self, kind: Kind) -> tuple[int, ...]:
        """Samples along each axis, in the order in which they are asked."""
        return (QUICK_SIDES if self.quick else SIDES)[kind]


@dataclass(frozen=True)
class Side:
    """One implementation on one field.

    vertices, simplices : how many came
    megabytes : resident memory that a call on this field added at its highest, or, of a program,
        all that its process held; None where nothing was seen of it
    timing : its rounds; None where it failed
    failed : how, in words; else empty
    """

    vertices: int = 0
    simplices: int = 0
    megabytes: float | None = None
    timing: Timing | None = None
    failed: str = ""

    @property
    def seconds(self) -> float:
        """Median seconds of the processors, of the clock where these are not known."""
        assert self.timing is not None
        return statistics.median(self.timing.processor or self.timing.seconds)


@dataclass(frozen=True)
class Row:
    """A field, and what each of the two made of it.

    family, side : which field, in how many samples along each axis
    samples, active : how many samples, and how many active cells
    """

    family: str
    side: int
    kind: Kind
    samples: int
    active: int
    own: Side
    peer: Side

    @property
    def name(self) -> str:
        """The field in words."""
        return f"{self.family}, {self.side}^{self.kind.n}"

    @property
    def ratio(self) -> tuple[float, float, float] | None:
        """Time over the peer's, median and quartiles over rounds; None where one has failed."""
        if self.own.timing is None or self.peer.timing is None:
            return None
        return self.own.timing.over(self.peer.timing)

    @property
    def by_clock(self) -> float | None:
        """The same ratio by the clock alone."""
        if self.own.timing is None or self.peer.timing is None:
            return None
        own, peer = (Timing("", one.seconds, 1.0) for one in (self.own.timing, self.peer.timing))
        return own.over(peer)[0]


@dataclass(frozen=True)
class Work:
    """What a call, a sample and an active cell cost, fitted to the rows; all at least 0.

    worst : the largest share by which a row's median is off
    """

    call: float
    sample: float
    active: float
    worst: float


@dataclass(frozen=True)
class Contestant:
    """An implementation that is asked.

    program : it is none of Python's, so its process is seen from outside alone
    """

    spec: str
    name: str
    version: str
    program: bool


@dataclass(frozen=True)
class Bench:
    """All that was measured.

    machine : what it was measured on, and whether that was quiet, in a sentence
    others : processors that others used meanwhile, on average
    rounds : at most
    """

    own: Contestant
    peer: Contestant
    kind: Kind
    rounds: int
    rows: tuple[Row, ...]
    machine: str
    others: float
    processors: int
    quiet: bool
    seconds: float

    @property
    def ratio(self) -> float | None:
        """The geometric mean of the ratios, over the fields that both answered."""
        found = [row.ratio[0] for row in self.rows if row.ratio is not None]
        return statistics.geometric_mean(found) if found else None

    @property
    def measured(self) -> list[Row]:
        """The rows that the implementation answered."""
        return [row for row in self.rows if row.own.timing is not None]

    def parallel(self, which: str) -> float | None:
        """How many processors "own" or "peer" used at a time, of its largest field.

        Its processor time over that of the clock, the most of the rounds: waiting for others makes
        it less, and nothing makes it more.
        """
        sides: list[Side] = [getattr(row, which) for row in self.rows]
        timings = [side.timing for side in sides if side.timing and side.timing.processor]
        if not timings:
            return None
        largest = max(timings, key=lambda one: one.median)
        pairs = zip(largest.processor, largest.seconds, strict=True)
        return max(used / seconds for used, seconds in pairs)

    def work(self, which: str) -> Work | None:
        """What a call, a sample and an active cell cost "own" or "peer"; None of too few rows."""
        rows = [row for row in self.rows if getattr(row, which).timing is not None]
        if len(rows) < 4:
            return None
        from scipy.optimize import nnls

        # Fit shares of each row's time, so that small fields count as much as large ones.
        taken = np.array([getattr(row, which).seconds for row in rows])
        counts = np.array([[1.0, row.samples, row.active] for row in rows])
        scale = counts.max(axis=0)
        found = nnls(counts / scale / taken[:, None], np.ones(len(rows)))[0] / scale
        worst = float(np.abs(counts @ found / taken - 1).max())
        call, sample, active = found.tolist()
        return Work(call, sample, active, worst)


class NothingToBench(ValueError):  # noqa: N818 - wrong use, told in a sentence
    """What was named cannot be timed; the message says why."""


Watch = Callable[[Row], None]


def bench(
    spec: str,
    against: str | None = None,
    plan: Plan | None = None,
    limits: Limits | None = None,
    watch: Watch | None = None,
) -> Bench:
    """What an implementation costs, on every field of the plan, beside a peer.

    Parameters
    ----------
    spec, against : as of `isograde.adapters.open_adapter`; without a peer one that is installed
    watch : called with each row

    Raises
    ------
    AdapterError
        where one of the two does not start; `UnknownName`, which is one, for an unknown name.
    NothingToBench
        for a folder of meshes, a kind for which there are no fields, or a peer of another kind.
    """
    plan, limits = plan or Plan(), limits or Limits()
    for name in filter(None, (spec, against)):
        if name.startswith("dir:"):
            raise NothingToBench(f"{name} holds answers that were made elsewhere: nothing to time")
    machine, start = Machine(), time.monotonic()
    adapter = open_adapter(spec)
    declared = adapter.open(limits)
    try:
        kind = _kind(spec, declared)
        peer, other, said = _peer(spec, against, kind, limits)
        try:
            asked = (_Asked(adapter), _Asked(other))
            rows = []
            for row in _rows(kind, asked, plan):
                rows.append(row)
                if watch is not None:
                    watch(row)
        finally:
            other.close()
        state, others, quiet = machine.state(), machine.others, machine.quiet
    finally:
        adapter.close()
    return Bench(
        _contestant(spec, declared),
        _contestant(peer, said),
        kind,
        plan.rounds,
        tuple(rows),
        state,
        others,
        machine.processors,
        quiet,
        time.monotonic() - start,
    )


def _contestant(spec: str, declared: Declaration) -> Contestant:
    """The implementation as the page names it."""
    return Contestant(spec, declared.name, declared.version, spec.startswith("exec:"))


def _kind(spec: str, declared: Declaration) -> Kind:
    """The first kind of which there are fields that it makes."""
    kinds = {Kind(*kind) for kind in declared.limits.kinds}
    for kind in SIDES:
        if kind in kinds:
            return kind
    made = ", ".join(map(str, sorted(kinds)))
    raise NothingToBench(f"there are fields for surfaces, contours and curves; {spec} makes {made}")


def _peer(
    spec: str, against: str | None, kind: Kind, limits: Limits
) -> tuple[str, Adapter, Declaration]:
    """The peer that is named, or the first that starts, open."""
    if against is not None:
        adapter = open_adapter(against)
        declared = adapter.open(limits)
        if kind in {Kind(*one) for one in declared.limits.kinds}:
            return against, adapter, declared
        adapter.close()
        raise NothingToBench(f"{spec} makes {kind}, and {against} does not: name another peer")
    for name in PEERS[kind]:
        if name == spec:
            continue
        adapter = open_adapter(name)
        try:
            return name, adapter, adapter.open(limits)
        except AdapterError:
            adapter.close()
    raise NothingToBench(f"no peer that makes {kind} is installed: name one with --against")


# --- Fields --------------------------------------------------------------------------------------


def ball(kind: Kind, side: int) -> Field:
    """A ball, of which few cells are active; with planes through it for more components."""
    axes = np.meshgrid(*[np.linspace(-1, 1, side, dtype="f4")] * kind.n, indexing="ij", sparse=True)
    radius = np.sqrt(sum(x**2 for x in axes))
    return _field(
        kind, [np.float32(0.7) - radius, *(axes[n] + 0 * radius for n in range(kind.m - 1))]
    )


def waves(kind: Kind, side: int) -> Field:
    """Waves of a period of 16 samples, of which many cells are active; shifted for more."""

    def shifted(by: float) -> NDArray[np.float32]:
        axes = [2 * np.pi * (np.arange(side) + by) / PERIOD] * kind.n
        turned = np.meshgrid(*axes, indexing="ij", sparse=True)
        pairs = zip(turned, [*turned[1:], turned[0]], strict=True)
        total: Floats = sum(np.sin(a) * np.cos(b) for a, b in pairs)
        return total.astype("f4")

    return _field(kind, [shifted(3.7 * n) for n in range(kind.m)])


def noise(kind: Kind, side: int) -> Field:
    """White noise smoothed by one and a half samples: a folded surface of many parts."""
    from scipy.ndimage import gaussian_filter

    rng = np.random.default_rng(side)
    white = rng.normal(size=(kind.m, *(side,) * kind.n)).astype("f4")
    smooth = [gaussian_filter(one, SMOOTHED) for one in white]
    return _field(kind, [one / one.std() for one in smooth])


FAMILIES: Mapping[str, Callable[[Kind, int], Field]] = {
    "ball": ball,
    "waves": waves,
    "noise": noise,
}


def _field(kind: Kind, components: Sequence[NDArray[np.float32]]) -> Field:
    """The field of these components."""
    if kind.m == 1:
        return Field.of(components[0])
    return Field.of(np.stack(components), dimension=kind.n)


def active_cells(field: Field, isovalue: float) -> int:
    """How many cells have corners on both sides of the isovalue, of every component.

    >>> active_cells(Field.of([[0.0, 1.0, 1.0], [1.0, 1.0, 1.0]]), 0.5)
    1
    """
    n = field.dimension
    inside = field.values.reshape(field.components, *field.shape) >= isovalue
    windows = [
        inside[
            (
                slice(None),
                *(slice(o, size - 1 + o) for o, size in zip(at, field.shape, strict=True)),
            )
        ]
        for at in product((0, 1), repeat=n)
    ]
    crossed = reduce(np.logical_or, windows) & ~reduce(np.logical_and, windows)
    return int(crossed.all(axis=0).sum())


# --- Asking --------------------------------------------------------------------------------------


class _Failed(Exception):  # noqa: N818 - an outcome of the implementation
    """A call did not answer; the message says how, and who it was."""

    def __init__(self, which: str, outcome: Outcome) -> None:
        self.which, self.status = which, outcome.status
        super().__init__(
            f"{outcome.status.value}: {outcome.detail}" if outcome.detail else outcome.status.value
        )


@dataclass
class _Asked:
    """An open adapter, and how often it was asked."""

    adapter: Adapter
    calls: int = 0

    def answer(self, which: str, field: Field, kind: Kind, calls: Calls = "once") -> Outcome:
        """What came back; raises `_Failed`."""
        isovalues = (ISOVALUE + STEP * self.calls,) * kind.m
        self.calls += 1
        outcome = self.adapter.run(Request("bench", "plain", field, isovalues, calls))
        if outcome.status is not Status.OK:
            raise _Failed(which, outcome)
        return outcome

    def cost(self, which: str, field: Field, kind: Kind) -> Cost:
        """What one call costs; raises `_Failed`."""
        outcome = self.answer(which, field, kind)
        return Cost(max(outcome.seconds, 1e-9), outcome.processor)


def _rows(kind: Kind, asked: tuple[_Asked, _Asked], plan: Plan) -> Iterator[Row]:
    """Every field of the plan, small ones first, asked of both.

    Where one ran out of time or memory, it is not asked about larger fields of that family.
    """
    contestants = dict(zip(("own", "peer"), asked, strict=True))
    small = ball(kind, FIRST_SIDE)
    for one in asked:
        one.adapter.run(Request("bench", "plain", small, (0.0,) * kind.m))
    gone: dict[str, str] = {}
    for family, build in FAMILIES.items():
        for side in plan.sides(kind):
            field = build(kind, side)
            sides = {
                which: _first(which, one, field, kind, gone.get(f"{which} {family}", ""))
                for which, one in contestants.items()
            }
            sides = _timed(sides, contestants, field, kind, plan)
            for which, found in sides.items():
                if found.failed.startswith((Status.TIMEOUT, Status.MEMORY)):
                    gone[f"{which} {family}"] = f"not asked: on {side}^{kind.n} {found.failed}"
            samples = math.prod(field.shape)
            active = active_cells(field, ISOVALUE)
            yield Row(family, side, kind, samples, active, sides["own"], sides["peer"])


def _first(which: str, one: _Asked, field: Field, kind: Kind, gone: str) -> Side:
    """What the first call on a field gives, whose memory is told; not asked where it is `gone`."""
    if gone:
        return Side(failed=gone)
    try:
        told = getattr(one.adapter, "calls", False)
        outcome = one.answer(which, field, kind, "trimmed" if told else "once")
    except _Failed as failed:
        return Side(failed=str(failed))
    assert outcome.vertices is not None
    assert outcome.simplices is not None
    known = outcome.processor is not None or outcome.peak_bytes > 0
    seen = outcome.peak_bytes / 2**20 if known else None
    return Side(len(outcome.vertices), len(outcome.simplices), seen)


def _timed(
    sides: Mapping[str, Side],
    contestants: Mapping[str, _Asked],
    field: Field,
    kind: Kind,
    plan: Plan,
) -> dict[str, Side]:
    """The same with the rounds of those that have not failed; who fails in one has failed."""
    found = dict(sides)
    while asked := [which for which, side in found.items() if not side.failed]:
        calls = {which: partial(contestants[which].cost, which, field, kind) for which in asked}
        try:
            timings = in_turn(calls, plan.rounds, seconds=plan.seconds)
        except _Failed as failed:
            found[failed.which] = Side(failed=f"in a later round: {failed}")
            continue
        for timing in timings:
            side = found[timing.name]
            found[timing.name] = Side(side.vertices, side.simplices, side.megabytes, timing)
        break
    return found
