"""VESTA: the original beside the marching variant and VTK's marching cubes, in turn, one thread.

Prints a Markdown table for each field: seconds, ratio to the original, extra peak memory, points.
`make benchmarks` keeps it in `reports/benchmarks/vesta.md`. The bunny is there where ISOGRADE_DATA
names the folder that holds its scan.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

import numpy as np
from bench_extraction import bunny, here, noise, sphere, vtk_peers
from isograde.stopwatch import interleave, peak_memory
from isoref.diconex import diconex as diconex_plainly
from isoref.fast.diconex import diconex
from isoref.fast.vesta import extract
from isoref.field import Array, Field
from isoref.methods import METHODS
from isoref.vesta import extract as extract_plainly
from pages import Page, over, profile, table_of

Run = Callable[[], object]
PAIRS = ("disconnect-L", "mixed-L", "mixed-H")


FIELDS: dict[str, tuple[Callable[[], Array], float]] = {
    "sphere 128^3": (lambda: sphere(128), 0.0),
    "sphere 256^3": (lambda: sphere(256), 0.0),
    "smoothed noise 128^3": (lambda: noise(128), 0.0),
    "bunny 361 x 512 x 512": (bunny, 1807.0),
}


def contestants(values: Array, isovalue: float) -> dict[str, Run]:
    """The codes as calls without arguments, the original first."""
    field = Field.of(values)

    def method(name: str) -> Run:
        return lambda: METHODS[name](field, isovalue)

    runs: dict[str, Run] = {}
    for pair in PAIRS:
        runs[f"original, {pair}"] = method(f"vesta-{pair}")
        runs[f"marching, {pair}"] = method(f"marching-vesta-{pair}")
    try:
        peers = vtk_peers(values, isovalue)
    except ImportError:
        return runs
    return runs | {name: run for name, run in peers.items() if "arching" in name}


GOAL = 3.0
"""What the original's time over the marching variant's shall be at most."""


def reasons(page: Page, name: str, values: Array, isovalue: float) -> list[str]:
    """Where the original's time goes on a field, and what it has to do that marching has not."""
    field = Field.of(values)
    rows = profile(lambda: METHODS["vesta-mixed-L"](field, isovalue), "isoref")
    active = values >= isovalue
    faces = sum(
        int(np.count_nonzero(np.diff(active.view(np.int8), axis=axis))) for axis in range(3)
    )
    inside = np.lib.stride_tricks.sliding_window_view(active, (2, 2, 2))
    corners = inside.reshape(*inside.shape[:3], 8).sum(axis=-1, dtype=np.int8)
    cells = int(np.count_nonzero((corners > 0) & (corners < 8)))
    for pair in PAIRS:
        page.explain(
            f"original over marching, {pair}, {name}",
            f"it follows {4 * faces / cells:.1f} paths for each case that marching looks up, one "
            f"step after another; its largest part, {rows[0][0]}, takes {rows[0][1]}",
        )
    return [
        table_of(["original, mixed-L: function", "of its time"], rows),
        f"The original has a support point for each of {faces:,} faces between voxels, and follows "
        f"four paths on each, {4 * faces:,}, of each of which it asks for the successor, one step "
        "after another with the same arrays; the marching variant looks up a case for each of "
        f"{cells:,} cells, {4 * faces / cells:.1f} times fewer, and finds the cycles of a case in "
        "a table. *Argued from the code:* the successors are what the algorithm is, so a look-up "
        "of cycles by case would be the marching variant under another name.",
    ]


def table(title: str, runs: dict[str, Run], rounds: int, page: Page | None = None) -> str:
    """Seconds, ratios and memory of these calls; the page notes what was asked of them."""
    lines = [
        f"## {title}",
        "",
        "| | median s (least to most) | time / first | extra peak MiB |",
        "| --- | ---: | ---: | ---: |",
    ]
    timings = interleave(runs, rounds)
    for pair in PAIRS:
        if page is not None:
            found = over(timings, f"original, {pair}", f"marching, {pair}")
            page.ask("vesta", f"original over marching, {pair}, {title}", found, GOAL, most=True)
    for timing in timings:
        memory = peak_memory(runs[timing.name]) / 2**20
        lines.append(f"| {timing.name} | {timing.shown()} | {timing.ratio:.2f} | {memory:.0f} |")
    return "\n".join(lines) + "\n"


def twins(rounds: int) -> list[str]:
    """The vectorised algorithms beside the loops they are read by."""
    volume = np.random.default_rng(1).normal(size=(16, 16, 16))
    image = np.random.default_rng(2).normal(size=(64, 64))
    return [
        table(
            "VESTA beside its plain twin: noise 16^3, closed border",
            {
                "arrays": lambda: extract(volume, 0.0, border="closed"),
                "plain loop": lambda: extract_plainly(volume, 0.0),
            },
            rounds,
        ),
        table(
            "DICONEX beside its plain twin: noise 64^2, closed border",
            {
                "arrays": lambda: diconex(image, 0.0, border="closed").polygons(),
                "plain loop": lambda: diconex_plainly(image, 0.0),
            },
            rounds,
        ),
    ]


def main() -> None:
    """Run the tables and write them down."""
    offered = [name for name in FIELDS if here(name)]
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fields", nargs="*", choices=list(FIELDS), default=offered)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--out", type=Path, default=Path("reports/benchmarks/vesta.md"))
    arguments = parser.parse_args()
    page = Page(
        "VESTA, one thread",
        f"medians of {arguments.rounds} rounds, contestants in turn. Only the ratios carry over.",
    )
    profiles = []
    for name in arguments.fields:
        build, isovalue = FIELDS[name]
        values = build()
        page.add(table(name, contestants(values, isovalue), arguments.rounds, page))
        profiles += [f"### {name}", *reasons(page, name, values, isovalue)]
    for name in FIELDS:
        if not here(name):
            what, absent = f"original over marching, {name}", "the scan is not here: ISOGRADE_DATA"
            page.ask("vesta", what, None, GOAL, most=True, absent=absent)
    page.show_goals()
    page.why(*profiles)
    page.add(*twins(arguments.rounds))
    page.write(arguments.out)


if __name__ == "__main__":
    main()
