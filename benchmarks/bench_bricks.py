"""Many isovalues of one volume: the index of bricks beside the plain sweep, in turn, one thread.

For each field: what the index costs to build, and for each isovalue the plain extraction, the one
by the index, and one threshold pass. Keeps the table in `reports/benchmarks/bricks.md`.
"""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path

import numpy as np
from bench_extraction import ANEURISM, aneurism, gyroid, sphere
from isograde.cases.volumes import find
from isograde.report.plot import Series, curves
from isograde.stopwatch import interleave
from isoref.fast.bricks import Index
from isoref.field import Array, least_inside
from isoref.methods import extract
from pages import Page

#: Isovalues by the share of the samples below them, those at an end of the range left out.
SHARES = (0.5, 0.9, 0.98, 0.998, 0.9998)
FIELDS = {
    "sphere 256^3": lambda: sphere(256),
    "gyroid 256^3": lambda: gyroid(256),
    "sphere 256^3 uint8": lambda: np.clip(sphere(256) * 200 + 128, 0, 255).astype(np.uint8),
    "angiography 256^3 uint8": aneurism,
}


def isovalues(values: Array) -> list[float]:
    """Isovalues between samples, from a surface in the middle to one round the largest samples.

    Samples at an end of the range are not counted: of a scan they are most.
    """
    sample = np.sort(values[::3, ::3, ::3].reshape(-1).astype(float))
    sample = sample[(sample > sample[0]) & (sample < sample[-1])]
    found = [float(sample[int(share * (len(sample) - 1))]) for share in SHARES]
    half = 0.5 if values.dtype.kind == "u" else 0.0
    return sorted({level + half for level in found if level + half < sample[-1]})


WHY = """\
What an index can save is the pass over the samples, and of it only what lies in bricks that the
isovalue does not divide. Where it saves less than it costs to go from brick to brick, the table
says how much that pass is of a plain extraction, and how many bricks are divided:"""


def measure(
    page: Page, name: str, values: Array, rounds: int, colour: int, why: list[list[str]]
) -> Series:
    """The table of one field is on the page; its ratios against vertices a sample.

    why : grows by a row for each isovalue at which the index does not pay
    """
    index = Index.of(values)
    (built,) = interleave({"build": lambda: Index.of(values)}, rounds)
    rows, places = [], []
    for level in isovalues(values):
        plain, indexed, threshold = interleave(
            {
                "plain": partial(extract, values, level),
                "index": partial(index.extract, level),
                # Of the samples' type: nothing is converted.
                "threshold": partial(np.greater_equal, values, least_inside(values.dtype, level)),
            },
            rounds,
        )
        ratio = plain.over(indexed)
        vertices = len(index.extract(level).vertices)
        divided = index.divided(level).mean()
        page.ask("bricks", f"{name} at {level:.4g}", ratio, 1.0, most=False)
        if not page.goals[-1].met:
            share = threshold.over(plain)[0]
            page.explain(
                f"{name} at {level:.4g}",
                f"all that an index can save is a pass over the samples, {share:.0%} of a plain "
                f"extraction, and {divided:.0%} of the bricks are divided",
            )
            why.append([f"{name} at {level:.4g}", f"{share:.0%}", f"{divided:.0%}"])
        places.append((max(vertices / values.size, 1e-9), ratio[0]))
        saved = np.median(plain.processor) - np.median(indexed.processor)
        pays = np.median(built.processor) / saved if saved > 0 else np.inf
        rows.append(
            [
                f"{level:.4g}",
                f"{vertices:,}",
                f"{divided:.1%}",
                plain.shown(2, 1e3),
                indexed.shown(2, 1e3),
                f"{ratio[0]:.2f} ({ratio[1]:.2f} to {ratio[2]:.2f})",
                f"{threshold.shown(2, 1e3)}",
                "never" if pays > 1000 else f"{int(np.ceil(pays))}",
            ]
        )
    page.add(f"## {name}; the index is built in {built.shown(1, 1e3)} ms")
    heads = ["isovalue", "vertices", "bricks divided", "plain, ms", "by the index, ms"]
    heads += ["plain / index", "one threshold pass, ms", "the index has paid after"]
    page.table(heads, rows)
    return Series(name, sorted(places), colour)


def main() -> None:
    """Run the tables and write them down."""
    parser = argparse.ArgumentParser(description=__doc__)
    offered = [n for n in FIELDS if not n.startswith("angio") or find(ANEURISM) is not None]
    parser.add_argument("--fields", nargs="*", choices=offered, default=offered)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--out", type=Path, default=Path("reports/benchmarks/bricks.md"))
    arguments = parser.parse_args()
    page = Page(
        "Many isovalues of one volume",
        f"medians of {arguments.rounds} rounds, contestants in turn, least to most in brackets; "
        "ratios of processor time, round by round, with their quartiles. The asymptotic decider, "
        "from an array in memory. What the index saves is the pass over the samples, so it saves "
        "much where there are few vertices for many samples.",
    )
    series: list[Series] = []
    why: list[list[str]] = []
    for name in arguments.fields:
        series.append(measure(page, name, FIELDS[name](), arguments.rounds, len(series), why))
    page.plot("ratios", curves("Plain over indexed", "vertices a sample", "ratio", series))
    page.show_goals()
    if why:
        page.why(WHY)
        page.table(["", "one threshold pass, of a plain extraction", "bricks divided"], why)
    page.write(arguments.out)


if __name__ == "__main__":
    main()
