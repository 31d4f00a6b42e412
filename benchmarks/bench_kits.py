"""What a call of a program costs: the kits of each language beside the reference, in turn.

The same marching cubes, but for the reference's, behind ``exec:`` and behind a worker process. A
program is started once, and asked line by line; the samples go to a file, the mesh comes back as
text. Writes ``reports/benchmarks/kits.md``.
"""

from __future__ import annotations

import argparse
import shlex
import shutil
import tempfile
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from pathlib import Path

from bench_adapters import repeated
from bench_extraction import sphere
from isograde.adapters import open_adapter
from isograde.commands.kits import KITS, folder_of, write
from isograde.model import Adapter, Limits, Request
from isograde.stopwatch import Machine, interleave
from isoref.field import Field

PEER = "isoref:marching-vesta-disconnect-L"
# Small fields are asked many times, so that a round takes some hundredths of a second.
SIDES = {3: 50, 16: 20, 64: 1, 128: 1}


def opened(folder: Path, stack: ExitStack) -> dict[str, Adapter]:
    """The peer, and each kit whose language is here, built and started."""
    specs = {PEER: PEER}
    for name, kit in KITS.items():
        if all(shutil.which(tool) for tool in kit.tools):
            write(kit, folder_of(name), folder / name)
            specs[kit.language] = f"exec:{shlex.quote(str(folder / name / 'run'))}"
        else:
            print(f"no {' or '.join(kit.tools)} here: {kit.language} is left out")
    adapters = {}
    for name, spec in specs.items():
        adapters[name] = open_adapter(spec)
        adapters[name].open(Limits(seconds=120.0))
        stack.callback(adapters[name].close)
    return adapters


def rows(adapters: dict[str, Adapter], side: int, rounds: int) -> list[str]:
    """The table's rows for a sphere in side^3 samples."""
    times = SIDES[side]
    request = Request("sphere", "plain", Field.of(sphere(side)), (0.0,))
    contestants: dict[str, Callable[[], object]] = {
        name: repeated(partial(adapter.run, request), times) for name, adapter in adapters.items()
    }
    timings = interleave(contestants, rounds)
    return [
        f"| {side}^3 | {name} | {timing.shown(3, 1000 / times)} | {timing.ratio:.2f} |"
        for name, timing in zip(contestants, timings, strict=True)
    ]


def main() -> None:
    """Run the table and write it down."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sides", nargs="*", type=int, choices=list(SIDES), default=list(SIDES))
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--out", type=Path, default=Path("reports/benchmarks/kits.md"))
    arguments = parser.parse_args()
    machine = Machine()
    lines = [
        "# What a call of a program costs\n",
        "| samples | implementation | ms a call (least to most) | ratio |",
        "| ---: | --- | ---: | ---: |",
    ]
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        adapters = opened(folder, stack)
        for side in arguments.sides:
            lines += rows(adapters, side, arguments.rounds)
            print("\n".join(lines[-len(adapters) :]), flush=True)
    lines.insert(
        1,
        f"{machine.state()}; a sphere in float32; medians of {arguments.rounds} rounds, in turn; "
        f"ratios to {PEER} in its worker process.\n",
    )
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    arguments.out.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
