"""What an adapter costs: scikit-image called directly, and through its process, in turn.

The difference of the two is the adapter's: the field is sent, laid out in memory, compared with
itself after the call, and the mesh is sent back. Writes ``reports/benchmarks/adapters.md``.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from pathlib import Path

from bench_extraction import sphere
from isograde.adapters import open_adapter
from isograde.model import Adapter, Limits, Request
from isograde.stopwatch import Machine, interleave
from isoref.field import Field
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


def row(adapter: Adapter, side: int, rounds: int) -> str:
    """The table's row for a sphere in side^3 samples."""
    values, times = sphere(side), SIDES[side]
    request = Request("sphere", "plain", Field.of(values), (0.0,))
    contestants: dict[str, Callable[[], object]] = {
        "direct": repeated(partial(marching_cubes, values, 0.0), times),
        "adapter": repeated(partial(adapter.run, request), times),
    }
    direct, through = interleave(contestants, rounds)
    shown = [timing.shown(3, 1000 / times) for timing in (direct, through)]
    return f"| {side}^3 | {' | '.join(shown)} | {through.ratio:.2f} |"


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
        "| samples | direct, ms a call (least to most) | through the adapter, ms | ratio |",
        "| ---: | ---: | ---: | ---: |",
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
