"""What a door costs: scikit-image called directly, and through its process, in turn.

The difference of the two is the door's: the field is sent, laid out in memory, compared with itself
after the call, and the mesh is sent back. Writes ``reports/benchmarks/doors.md``.
"""

from __future__ import annotations

import argparse
import platform
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from bench_extraction import sphere
from isograde.doors import open_door
from isograde.model import Door, Limits, Request
from isoref.field import Field
from skimage.measure import marching_cubes
from stopwatch import interleave

NAME = "skimage:lewiner"
# Small fields are asked many times, so that a round takes some hundredths of a second.
SIDES = {3: 200, 16: 50, 64: 3, 128: 1, 256: 1}


def repeated(run: Callable[[], object], times: int) -> Callable[[], None]:
    """`run`, so many times."""

    def every() -> None:
        for _ in range(times):
            run()

    return every


def row(door: Door, side: int, rounds: int) -> str:
    """The table's row for a sphere in side^3 samples."""
    values, times = sphere(side), SIDES[side]
    request = Request("sphere", "plain", Field.of(values), 0.0)
    contestants: dict[str, Callable[[], object]] = {
        "direct": repeated(partial(marching_cubes, values, 0.0), times),
        "door": repeated(partial(door.run, request), times),
    }
    direct, through = interleave(contestants, rounds)
    pairs = zip(through.seconds, direct.seconds, strict=True)
    extra = float(np.median([a - b for a, b in pairs])) / times
    return (
        f"| {side}^3 | {1000 * direct.median / times:.3f} | {1000 * extra:.3f} | "
        f"{through.ratio:.2f} |"
    )


def main() -> None:
    """Run the table and write it down."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sides", nargs="*", type=int, choices=list(SIDES), default=list(SIDES))
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--out", type=Path, default=Path("reports/benchmarks/doors.md"))
    arguments = parser.parse_args()
    door = open_door(NAME)
    door.open(Limits(seconds=120.0))
    lines = [
        "# What a door costs\n",
        f"{NAME}, a sphere in float32; {platform.machine()}, Python {platform.python_version()}; "
        f"medians of {arguments.rounds} rounds, in turn.\n",
        "| samples | direct ms a call | door's share, ms | through the door / direct |",
        "| ---: | ---: | ---: | ---: |",
    ]
    for side in arguments.sides:
        lines.append(row(door, side, arguments.rounds))
        print(lines[-1], flush=True)
    door.close()
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    arguments.out.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
