"""Blocks on many machines: what `isoref.distributed` sends, and how it scales; then, on paper.

Measured: a volume extracted by one worker and by two, each a process of one thread, in turn; and
for blocks of several sizes what travels and what is welded, counted in the pieces themselves.
Computed from these: what a thousand workers would send, wait for and weld. Keeps the tables in
`reports/benchmarks/distributed.md`.
"""

from __future__ import annotations

import argparse
import pickle
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from bench_extraction import gyroid
from isograde.report.plot import Series, curves
from isograde.stopwatch import Cost, in_turn
from isoref.distributed import blocks, extract, piece, start_of, welded
from isoref.field import Array
from isoref.methods import extract as whole
from pages import Page

SIDES = (16, 32, 64, 128)
WORKERS = 1000
LARGE = 512


class Sent(NamedTuple):
    """Blocks of one size: how many, and what each sends and costs, on average.

    samples, answer : bytes to a worker and back; shared : vertices that may be in two blocks;
    all_vertices : of a block; seconds : of the processor to extract it; weld : to weld it
    """

    side: int
    number: int
    samples: float
    answer: float
    shared: float
    all_vertices: float
    seconds: float
    weld: float


def sent(values: Array, side: int, isovalue: float) -> Sent:
    """What blocks of this side send, and what they take."""
    chunks = [[side] * (n // side) + [n % side] * bool(n % side) for n in values.shape]
    where = blocks(values.shape, chunks)
    start = time.process_time()
    pieces = [piece(values[one], isovalue, values.shape, start_of(one)) for one in where]
    middle = time.process_time()
    mesh = welded(pieces)
    end = time.process_time()
    assert len(mesh.vertices) == len(whole(values, isovalue).vertices)
    n = len(pieces)
    return Sent(
        side,
        n,
        sum(len(pickle.dumps(np.ascontiguousarray(values[one]))) for one in where) / n,
        sum(len(pickle.dumps(one)) for one in pieces) / n,
        sum(int(one.shared.sum()) for one in pieces) / n,
        sum(len(one.vertices) for one in pieces) / n,
        (middle - start) / n,
        (end - middle) / n,
    )


def scaling(page: Page, values: Array, isovalue: float, rounds: int) -> None:
    """One worker and two, in turn, beside the plain extraction in this process."""
    try:
        import dask.array as arrays
        import distributed
    except ImportError:
        page.add('dask is not installed (pip install "isograde[distributed]"): nothing to scale.')
        return
    array = arrays.from_array(values, chunks=max(values.shape) // 2)

    def asked(client: Any) -> Cost:
        start = time.perf_counter()
        with client.as_current():
            extract(array, isovalue)
        return Cost(time.perf_counter() - start)

    def alone() -> Cost:
        start = time.perf_counter()
        whole(values, isovalue)
        return Cost(time.perf_counter() - start)

    options = {"threads_per_worker": 1, "dashboard_address": None, "memory_limit": 0}
    with (
        distributed.LocalCluster(n_workers=1, **options) as one,
        distributed.LocalCluster(n_workers=2, **options) as two,
        distributed.Client(one, set_as_default=False) as first,
        distributed.Client(two, set_as_default=False) as second,
    ):
        asked(first), asked(second)
        contestants = {
            "one worker": lambda: asked(first),
            "two workers": lambda: asked(second),
            "no cluster, one process": alone,
        }
        timings = in_turn(contestants, rounds)
    rows = [
        [one.name, one.shown(3), "{:.2f} ({:.2f} to {:.2f})".format(*timings[0].over(one))]
        for one in timings
    ]
    page.add(
        f"## Measured: {' x '.join(map(str, values.shape))} samples in {array.npartitions} blocks"
    )
    page.table(["", "seconds (least to most)", "one worker's time over it"], rows)
    page.add(
        "Times of the clock, samples sent from here to the workers and meshes back; on a machine "
        f"of {page.machine.processors} processors two workers share them with the scheduler and "
        "this process."
    )


def on_paper(page: Page, found: list[Sent], itemsize: int) -> None:
    """A thousand workers, from what was counted: the rates of the largest blocks, carried over."""
    last = found[-1]
    times = LARGE / last.side
    surface, volume = times**2, times**3
    answer, shared = last.answer * surface, last.shared * times
    vertices, samples = last.all_vertices * surface, (LARGE + 1) ** 3 * itemsize
    work, weld = last.seconds * volume, last.weld * surface
    page.add(
        f"## On paper: {WORKERS:,} workers, a block of {LARGE}^3 each",
        f"From the blocks of {last.side}^3: a surface crosses {times:g}^2 times as many cells of a "
        f"block {times:g} times as long, and its border {times:g} times as many; the work of a "
        f"block is taken to grow by {times:g}^3, which is more than it does.",
    )
    gigabit = 125e6
    rows = [
        ["messages", f"{2 * WORKERS:,}", "two a block: what to do, and its piece"],
        ["sent to a worker", f"{samples / 1e6:,.0f} MB", "nothing where it reads a store"],
        ["sent back, a block", f"{answer / 1e6:,.1f} MB", "grows as the square of the side"],
        [
            "sent back, all",
            f"{WORKERS * answer / 1e9:,.1f} GB",
            "into one process, unless kept there",
        ],
        [
            "time of that on one line of 1 Gbit/s",
            f"{WORKERS * answer / gigabit:,.0f} s",
            "the ends of the line are the limit",
        ],
        ["work of a block", f"{work:,.1f} s", "all workers at once"],
        ["welding, all", f"{WORKERS * weld:,.1f} s", "in one process"],
        ["vertices looked up, share", f"{shared / vertices:.2%}", "falls as one over the side"],
        [
            "speed-up",
            f"{WORKERS * work / (work + WORKERS * (weld + answer / gigabit)):,.0f}",
            "one worker's time over work, line and welding, none overlapped",
        ],
        [
            "speed-up where pieces stay with the workers",
            f"{WORKERS * work / (work + 26 * shared * 8 / gigabit):,.0f}",
            "each writes its own file; 26 neighbours exchange names",
        ],
    ]
    page.table(["", "number", "how"], rows)
    page.add(
        "One process that has to have the whole mesh, and its line, limit the workers before the "
        "blocks do. Where the mesh may stay in parts, only names on the borders travel, and their "
        "share falls as one over the side of a block."
    )


def main() -> None:
    """Run the tables and write them down."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--side", type=int, default=256)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--out", type=Path, default=Path("reports/benchmarks/distributed.md"))
    arguments = parser.parse_args()
    values = gyroid(arguments.side)
    page = Page(
        "Blocks on many machines",
        f"a gyroid of four periods in float32; medians of {arguments.rounds} rounds, in turn.",
    )
    scaling(page, values, 0.0, arguments.rounds)
    found = [sent(values, side, 0.0) for side in SIDES if side < arguments.side]
    page.add("## Counted: what blocks send and what is welded, a block")
    rows = [
        [
            f"{one.side}^3",
            f"{one.number:,}",
            f"{one.samples / 1e6:.3f}",
            f"{one.answer / 1e6:.3f}",
            f"{one.all_vertices:,.0f}",
            f"{one.shared / max(one.all_vertices, 1):.1%}",
            f"{one.seconds * 1e3:.2f}",
            f"{one.weld * 1e3:.2f}",
        ]
        for one in found
    ]
    heads = ["cells", "blocks", "MB to a worker", "MB back", "vertices", "on its border"]
    page.table([*heads, "ms to extract", "ms to weld"], rows)
    series = [
        Series("MB to a worker", [(one.side, one.samples / 1e6) for one in found], 0),
        Series("MB back", [(one.side, one.answer / 1e6) for one in found], 1),
        Series(
            "share on its border", [(one.side, one.shared / one.all_vertices) for one in found], 2
        ),
    ]
    page.plot("blocks", curves("What a block sends", "cells along a block", "see the key", series))
    on_paper(page, found, values.itemsize)
    page.write(arguments.out)


if __name__ == "__main__":
    main()
