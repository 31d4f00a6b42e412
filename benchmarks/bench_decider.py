"""The asymptotic decider beside the drawings of 1987: triangles, and time as a ratio, in turn.

Nielson and Hamann (1991, section 4) found "no significant effect" of the decider on the running
time or on the total number of triangles. `make benchmarks` writes what is found here to
`reports/benchmarks/decider.md`: on two made fields, and on the scans that are there
(ISOGRADE_DATA).
"""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path

from bench_extraction import noise, sphere
from isograde.cases.volumes import REGISTRY, find, read
from isograde.stopwatch import interleave
from isoref.field import Array, Field
from isoref.methods import METHODS
from pages import Page, over

SCANS = {"bunny": 1807.0, "headsq": 1150.0, "carotid": 200.0, "stroke": 80.0}
OLD, NEW = "lorensen-cline", "asymptotic-decider"


def fields() -> list[tuple[str, Array, float]]:
    """Name, samples and isovalue of each field that is at hand."""
    made = [("sphere 128^3", sphere(128), 0.0), ("smoothed noise 128^3", noise(128), 0.0)]
    for name, isovalue in SCANS.items():
        place = find(REGISTRY[name])
        if place is not None:
            values = read(place, volume=REGISTRY[name]).values
            made.append((f"{name} {isovalue:g}", values, isovalue))
    return made


def row(name: str, values: Array, isovalue: float, rounds: int) -> list[str]:
    """The row of a field: triangles of both, how many more, and the ratio of times."""
    field = Field.of(values)
    runs = {method: partial(METHODS[method], field, isovalue) for method in (OLD, NEW)}
    old, new = (len(run().simplices) for run in runs.values())
    timings = interleave(runs, rounds)
    shown = "{:.2f} ({:.2f} to {:.2f})".format(*over(timings, NEW, OLD))
    return [name, f"{old:,}", f"{new:,}", f"{100 * (new - old) / old:+.2f} %", shown]


def main() -> None:
    """Run every row and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--out", type=Path, default=Path("reports/benchmarks/decider.md"))
    arguments = parser.parse_args()
    page = Page(
        "The asymptotic decider beside the drawings of 1987",
        f"medians of {arguments.rounds} rounds, the two in turn, one thread. Only the ratios carry "
        "over.",
    )
    page.add(
        'Nielson and Hamann (1991, section 4): "no significant effect" on the running time or on '
        "the total number of triangles.",
    )
    rows = [row(*field, arguments.rounds) for field in fields()]
    page.table(
        ["field", "triangles, 1987", "decider", "more", "time, decider / 1987 (quartiles)"], rows
    )
    absent = [name for name in SCANS if find(REGISTRY[name]) is None]
    if absent:
        page.add(f"Not at hand: {', '.join(absent)}.")
    page.write(arguments.out)


if __name__ == "__main__":
    main()
