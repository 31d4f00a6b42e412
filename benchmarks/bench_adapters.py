"""What an adapter costs: scikit-image called directly, and through its process, in turn.

The difference of the two is the adapter's: the field is sent, the mesh is sent back. What guards
the input is counted apart: the samples are copied, as they lie in memory, and compared with the
copy after the call. Beside them stands the bare exchange of as many bytes. Writes
``reports/benchmarks/adapters.md``.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from functools import partial
from multiprocessing import Pipe, get_context
from multiprocessing.connection import Connection
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import psutil
from bench_extraction import sphere
from isograde.adapters import open_adapter
from isograde.adapters.worker import differ, laid_out
from isograde.model import Adapter, Limits, Request
from isograde.stopwatch import interleave, quartiles
from isoref.field import Field
from numpy.typing import NDArray
from pages import Page, profile
from skimage.measure import marching_cubes

NAME = "skimage:lewiner"
# Small fields are asked many times, so that a round takes some hundredths of a second.
# What was asked: milliseconds more for small fields; from 64^3 on, the ratio to a direct call.
MORE, RATIO = 0.2, 1.2
SIDES = {3: 200, 16: 50, 64: 3, 128: 1, 256: 1}


def repeated(run: Callable[[], object], times: int) -> Callable[[], None]:
    """`run`, so many times."""

    def every() -> None:
        for _ in range(times):
            run()

    return every


def guarded(values: NDArray[Any]) -> None:
    """Make the copy that guards the input, and compare it, as the worker does."""
    differ(values, laid_out(values, values.strides))


def echo(pieces: Sequence[int]) -> tuple[Callable[[], None], Callable[[], object]]:
    """What nobody's adapter is below: these bytes to another process, one back; and its end.

    pieces : bytes of what is sent there, and of what comes back
    """
    here, there = Pipe()
    process = get_context("spawn").Process(target=_echo, args=(there, pieces[1]))
    process.start()
    there.close()
    sent = bytes(pieces[0])

    def run() -> None:
        here.send_bytes(sent)
        here.recv_bytes()

    def end() -> None:
        here.close()
        process.join()

    run()
    return run, end


def _echo(there: Connection, back: int) -> None:
    """So many bytes for each message, until there is none."""
    answer = bytes(back)
    try:
        while True:
            there.recv_bytes()
            there.send_bytes(answer)
    except EOFError:
        return


class Row(NamedTuple):
    """What was found for one size: milliseconds a call, by contestant, as the page shows them.

    more : milliseconds through the adapter beyond the direct call, without the guard
    ratio : through the adapter over the direct call, without the guard
    bare : milliseconds of the bare exchange
    ours, theirs : milliseconds of the processor that a call takes in the grader's process, and in
        the worker's beyond the direct call and the guard
    """

    shown: list[str]
    more: tuple[float, float, float]
    ratio: tuple[float, float, float]
    bare: float
    ours: float
    theirs: float


def row(adapter: Adapter, side: int, rounds: int) -> Row:
    """What a sphere in side^3 samples costs."""
    values, times = sphere(side), SIDES[side]
    request = Request("sphere", "plain", Field.of(values), (0.0,))
    vertices, triangles, *_ = marching_cubes(values, 0.0)
    exchange, end = echo((values.nbytes, vertices.nbytes + triangles.nbytes))
    contestants: dict[str, Callable[[], object]] = {
        "direct": repeated(partial(marching_cubes, values, 0.0), times),
        "adapter": repeated(partial(adapter.run, request), times),
        "guard": repeated(partial(guarded, values), times),
        "bare": repeated(exchange, times),
    }
    timings = interleave(contestants, rounds)
    end()
    direct, through, guard, bare = timings
    theirs = worked(partial(adapter.run, request), 5 * times)
    # Without the guard: milliseconds more than the direct call, and the ratio to it.
    seconds = zip(through.seconds, guard.seconds, direct.seconds, strict=True)
    left = [(a - g, d) for a, g, d in seconds]
    more = quartiles([1000 * (own - d) / times for own, d in left])
    ratio = quartiles([own / d for own, d in left])
    shown = [timing.shown(3, 1000 / times) for timing in timings]
    own, inside, copied = (1000 * median(one.processor) / times for one in (through, direct, guard))
    beyond = 1000 * theirs - inside - copied
    return Row(shown, more, ratio, 1000 * bare.median / times, own, max(0.0, beyond))


def worked(run: Callable[[], object], times: int) -> float:
    """Seconds of the processor a call in the processes that this one started.

    The system counts them in hundredths of a second, so there are to be many calls.
    """
    children = psutil.Process().children(recursive=True)
    before = sum(sum(child.cpu_times()[:2]) for child in children)
    repeated(run, times)()
    return (sum(sum(child.cpu_times()[:2]) for child in children) - before) / times


HEADS = (
    "samples",
    "direct, ms a call (least to most)",
    "through the adapter, ms",
    "the guard, ms",
    "a bare exchange, ms",
    "more than direct, ms",
    "ratio (quartiles)",
)
REASON = """\
*A bare exchange* sends the bytes of the samples through a pipe to a process that waits for them,
and gets the bytes of the mesh back, with nothing done on either side: two messages, and the system
has to wake a process for each. What a call costs beyond it is the protocol: the request is
described and read again, the samples are checked not to have changed, the answer is described, its
arrays are checked and copied out of what the two share. What either side takes of its processor for
that stands beside it, the worker's without the call itself and the guard; what is in neither is the
time in which the system wakes the one that was waited for."""


def main() -> None:
    """Run the table and write it down."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sides", nargs="*", type=int, choices=list(SIDES), default=list(SIDES))
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--out", type=Path, default=Path("reports/benchmarks/adapters.md"))
    arguments = parser.parse_args()
    page = Page(
        "What an adapter costs",
        f"{NAME}, a sphere in float32; medians of {arguments.rounds} rounds, in turn, of the "
        "clock. The guard is the copy of the input and its comparison after the call. The "
        "adapter's time has it in it; the last two columns do not.",
    )
    adapter = open_adapter(NAME)
    adapter.open(Limits(seconds=120.0))
    rows, why = [], []
    for side in arguments.sides:
        found = row(adapter, side, arguments.rounds)
        ratio = "{:.2f} ({:.2f} to {:.2f})".format(*found.ratio)
        rows.append([f"{side}^3", *found.shown, f"{found.more[0]:.3f}", ratio])
        print(rows[-1], flush=True)
        if side < 64:
            what = f"ms more than a direct call, {side}^3"
            page.ask("adapter", what, found.more, MORE, most=True)
        else:
            page.ask("adapter", f"ratio to a direct call, {side}^3", found.ratio, RATIO, most=True)
        told = (found.more[0], found.bare, found.ours, found.theirs)
        what = (
            f"ms more than a direct call, {side}^3"
            if side < 64
            else f"ratio to a direct call, {side}^3"
        )
        page.explain(
            what,
            f"of {found.more[0]:.2f} ms more, a bare exchange of the bytes takes {found.bare:.2f}; "
            f"our process works {found.ours:.2f} ms, the worker {found.theirs:.2f} beyond the call",
        )
        why.append([f"{side}^3", *(f"{one:.3f}" for one in told)])
    adapter.close()
    page.table(HEADS, rows)
    page.show_goals()
    page.why(REASON)
    heads = ["samples", "more than direct, ms", "a bare exchange, ms"]
    page.table([*heads, "processor, our side, ms", "processor, the worker's side, ms"], why)
    for side in arguments.sides[:1]:
        page.add(f"On our side of a call of {side}^3, by function, the waiting for the other's:")
        page.table(["function", "of its time"], by_function(side))
    page.write(arguments.out)


def by_function(side: int) -> list[list[str]]:
    """Rows of a table: where the time of calls goes on our side."""
    adapter = open_adapter(NAME)
    adapter.open(Limits(seconds=120.0))
    request = Request("sphere", "plain", Field.of(sphere(side)), (0.0,))
    try:
        return profile(repeated(partial(adapter.run, request), SIDES[side]), "isograde")
    finally:
        adapter.close()


if __name__ == "__main__":
    main()
