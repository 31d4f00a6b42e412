"""What an adapter costs: scikit-image called directly, and through its process, in turn.

The difference of the two is the adapter's: the field is sent, the mesh is sent back. What guards
the input is counted apart: the samples are copied, as they lie in memory, and compared with the
copy after the call. Writes ``reports/benchmarks/adapters.md``.
"""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from bench_extraction import sphere
from isograde.adapters import open_adapter
from isograde.adapters.worker import differ, laid_out
from isograde.model import Adapter, Limits, Request
from isograde.stopwatch import Machine, interleave, quartiles
from isoref.field import Field
from numpy.typing import NDArray
from skimage.measure import marching_cubes

NAME = "skimage:lewiner"
# Small fields are asked many times, so that a round takes some hundredths of a second.
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


def row(adapter: Adapter, side: int, rounds: int) -> str:
    """The table's row for a sphere in side^3 samples."""
    values, times = sphere(side), SIDES[side]
    request = Request("sphere", "plain", Field.of(values), (0.0,))
    contestants: dict[str, Callable[[], object]] = {
        "direct": repeated(partial(marching_cubes, values, 0.0), times),
        "adapter": repeated(partial(adapter.run, request), times),
        "guard": repeated(partial(guarded, values), times),
    }
    timings = interleave(contestants, rounds)
    direct, through, guard = timings
    shown = [timing.shown(3, 1000 / times) for timing in timings]
    # Without the guard: milliseconds more than the direct call, and the ratio to it.
    seconds = zip(through.seconds, guard.seconds, direct.seconds, strict=True)
    left = [(a - g, d) for a, g, d in seconds]
    more = statistics.median(1000 * (own - d) / times for own, d in left)
    ratio, low, high = quartiles([own / d for own, d in left])
    return (
        f"| {side}^3 | {' | '.join(shown)} | {more:.3f} | {ratio:.2f} ({low:.2f} to {high:.2f}) |"
    )


def main() -> None:
    """Run the table and write it down."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sides", nargs="*", type=int, choices=list(SIDES), default=list(SIDES))
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--out", type=Path, default=Path("reports/benchmarks/adapters.md"))
    arguments = parser.parse_args()
    machine = Machine()
    adapter = open_adapter(NAME)
    adapter.open(Limits(seconds=120.0))
    lines = [
        "# What an adapter costs\n",
        "The guard is the copy of the input and its comparison after the call. The adapter's time "
        "has it in it; the last two columns do not.\n",
        "| samples | direct, ms a call (least to most) | through the adapter, ms | the guard, ms "
        "| more than direct, ms | ratio (quartiles) |",
        "| ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for side in arguments.sides:
        lines.append(row(adapter, side, arguments.rounds))
        print(lines[-1], flush=True)
    adapter.close()
    lines.insert(
        1,
        f"{machine.state()}; {NAME}, a sphere in float32; medians of {arguments.rounds} rounds, "
        "in turn.\n",
    )
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    arguments.out.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
