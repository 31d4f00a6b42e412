"""Simplicial isosurfaces: cost in four and five dimensions, growth with N, peers in space.

Times are CPU seconds of one thread; memory is the highest rise of the process. Beside them stand
the first version of the project, where its history is here, and GUDHI's manifold tracing, where its
program is built (``python benchmarks/outside.py gudhi``). Writes
``reports/benchmarks/simplicial.md``.
"""

from __future__ import annotations

import argparse
import importlib.util
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path

import numpy as np
from isograde.stopwatch import Cost, in_turn, interleave, peak_memory, timed
from isoref.dyadic import Samples, SlopeBound
from isoref.fast.dyadic import dyadic_tree, extract_dyadic
from isoref.fast.simplicial import extract
from isoref.field import Field, Floats, Integers
from isoref.mesh import Mesh
from outside import ROOT, AbsentError, Outside, gudhi
from pages import Page, over, profile, table_of
from spindle import spindle_5d

Make = Callable[[], Mesh]

# Time once what takes more seconds than this.
LONG = 4.0

GROWTH = """A leaf is a cell that the surface may meet, so leaves follow the area of the surface. A
wide box is tested where its parent, twice as wide, could not be ruled out: on the first levels
that is everywhere, and the law shows only where boxes are small beside the surface. Seconds at
small N are the fixed cost of calls; they are the least of three runs, or of one that takes long."""

PEERS = """Kuhn's triangulation cuts a cell into six tetrahedra, which make more triangles than
a cube does. The general machinery costs more than a table of cubes; `isoref.sweep` is the module
for surfaces in space."""


def two_spheres(x: Floats) -> Floats:
    """Min, section 7.5: two unit spheres of R^4."""
    across: Floats = (x[:, :3] ** 2).sum(axis=1) - 1
    shifted = [across + (x[:, 3] - 0.5) ** 2, across + (x[:, 3] + 0.5) ** 2]
    return np.asarray(np.stack(shifted, axis=1))


def spheres_4d(N: int) -> tuple[Samples, SlopeBound]:
    """The two spheres on N cells a side, with slopes that bound them box by box."""
    h, centres = 2.6 / N, np.array([[0, 0, 0, 0.5], [0, 0, 0, -0.5]])
    samples = Samples.of_function(two_spheres, (N + 1,) * 4, h, [-1.3] * 4)

    def slopes(low: Integers, high: Integers) -> Floats:
        ends = np.stack([low, high])[:, :, None] * h - 1.3 - centres
        steepest: Floats = 2 * h * np.abs(ends).max(axis=0)
        return steepest

    return samples, SlopeBound(slopes)


def dense(samples: Samples) -> Field:
    """All samples of a lattice."""
    values = samples.at(np.arange(np.prod(samples.shape))).T.reshape(-1, *samples.shape)
    return Field.of(values, samples.spacing, samples.origin, dimension=len(samples.shape))


def cost(make: Make, rounds: int) -> tuple[float, int, int]:
    """Least CPU seconds, highest rise of memory in bytes, and the number of simplices."""
    seconds, count = np.inf, 0
    for _ in range(rounds):
        start = time.process_time()
        count = len(make().simplices)
        seconds = min(seconds, time.process_time() - start)
    return seconds, peak_memory(make), count


def scale(small: bool) -> list[str]:
    """Rows of cost by size, uniform and by tree."""
    lines = [
        "| field | N | grid | CPU s | peak MB | simplices |",
        "| --- | --: | --- | --: | --: | --: |",
    ]
    jobs: list[tuple[str, int, str, Make]] = []
    for N in (16, 32) if small else (16, 32, 64):
        samples, bound = spheres_4d(N)
        field = dense(samples)
        jobs.append(("4-D, m = 2", N, "uniform", lambda field=field: extract(field)))  # type: ignore[misc]
        jobs.append(("4-D, m = 2", N, "tree", tree_of(samples, bound)))
    for N in (8, 16) if small else (8, 16, 32, 64):
        jobs.append(("5-D, m = 3", N, "tree", tree_of(*spindle_5d(N))))
    for name, N, grid, make in jobs:
        seconds, peak, count = cost(make, 1 if N == 64 else 3)
        lines.append(f"| {name} | {N} | {grid} | {seconds:.3f} | {peak / 1e6:.0f} | {count:,} |")
        print(lines[-1], flush=True)
    return lines


def tree_of(samples: Samples, bound: SlopeBound) -> Make:
    """The extraction from a tree, as a call without arguments."""
    return lambda: extract_dyadic(samples, bound)


def growth(small: bool) -> list[str]:
    """Leaves and boxes of trees by size, and their exponents beside n - m = 2."""
    lines = [
        "| field | N | leaves | exponent | boxes tested | exponent | CPU s | exponent |",
        "| --- | --: | --: | --: | --: | --: | --: | --: |",
    ]
    fits = ["| field | sizes | leaves | boxes tested | CPU s |", "| --- | --- | --: | --: | --: |"]
    for name, make, largest in (
        ("4-D, m = 2", spheres_4d, 6 if small else 9),
        ("5-D, m = 3", spindle_5d, 4 if small else 7),
    ):
        sizes = [1 << i for i in range(3, largest + 1)]
        costs = np.array([tree_cost(*make(N)) for N in sizes])
        slopes = [["", "", ""], *(f"{x:.2f} {y:.2f} {z:.2f}".split() for x, y, z in local(costs))]
        for N, numbers, along in zip(sizes, costs.tolist(), slopes, strict=True):
            shown = [f"{numbers[0]:,.0f}", f"{numbers[1]:,.0f}", f"{numbers[2]:.3f}"]
            columns = [x for pair in zip(shown, along, strict=True) for x in pair]
            lines.append(f"| {name} | {N} | {' | '.join(columns)} |")
            print(lines[-1], flush=True)
        for few in (slice(None), slice(-4, None)):
            some = sizes[few]
            found = [f"{exponent(some, list(column)):.2f}" for column in costs[few].T]
            listed = ", ".join(map(str, some))
            fits.append(f"| {name} | {listed} | {' | '.join(found)} |")
    return [*lines, "", "Fitted over all sizes, and over the four largest:", "", *fits]


def local(costs: Floats) -> Floats:
    """The exponents from each size to the next, for sizes that double."""
    return np.asarray(np.diff(np.log2(costs), axis=0))


def tree_cost(samples: Samples, bound: SlopeBound) -> tuple[int, int, float]:
    """Leaves, boxes tested, and least CPU seconds of three runs, or of one that took long."""
    seconds, runs = np.inf, 0
    while runs < 3 and not (runs and seconds > LONG):
        start = time.process_time()
        tree = dyadic_tree(samples, bound)
        seconds, runs = min(seconds, time.process_time() - start), runs + 1
    return len(tree.leaves), tree.tested, seconds


def exponent(sizes: Sequence[int], numbers: Sequence[float]) -> float:
    """The slope of a straight line through the logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(numbers), 1)[0])


def peers(N: int, rounds: int) -> list[str]:
    """A sphere in space beside the libraries that are installed, in turn."""
    axis = np.linspace(-1.3, 1.3, N)
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij", sparse=True)
    values = 1 - x**2 - y**2 - z**2
    field = Field.of(values, 2.6 / (N - 1))
    runs: dict[str, Callable[[], object]] = {"isoref.simplicial": lambda: extract(field)}
    if importlib.util.find_spec("skimage"):
        from skimage.measure import marching_cubes

        runs["skimage lewiner"] = lambda: marching_cubes(values, 0.0)
    if importlib.util.find_spec("pyvista"):
        import pyvista

        image = pyvista.ImageData(dimensions=values.shape)
        image["phi"] = values.ravel(order="F")
        runs["vtkContourFilter"] = lambda: image.contour([0.0], scalars="phi")
    lines = [f"| sphere, {N}^3 | seconds (least to most) | over ours |", "| --- | --: | --: |"]
    for timing in interleave(runs, rounds):
        lines.append(f"| {timing.name} | {timing.shown(3)} | {timing.ratio:.2f} |")
    return lines


#: The last commit of the first version: what "today" was when half its time was asked for.
FIRST = "07493b2"
HALF, EVEN = 0.5, 1.0
"""What our time over the first version's shall be at most, and GUDHI's over ours at least."""


@contextmanager
def first_version() -> Iterator[Path]:
    """A folder with the first version's `isoref`; raises `AbsentError` without the history."""
    with tempfile.TemporaryDirectory() as folder:
        packed = subprocess.run(
            ["git", "archive", FIRST, "reference/isoref"],
            cwd=ROOT,
            capture_output=True,
            check=False,
        )
        if packed.returncode:
            raise AbsentError(f"the history of this copy has no {FIRST}")
        subprocess.run(["tar", "x", "-C", folder], input=packed.stdout, check=True)
        yield Path(folder) / "reference"


SPINDLE = Path(__file__).with_name("spindle.py")


def served(reference: Path, N: int) -> Outside:
    """A process that cuts the spindle by the `isoref` of this folder."""
    return Outside(sys.executable, SPINDLE, reference, str(N))


def _asked(other: Outside, line: str = "call") -> Callable[[], Cost]:
    """What a call in another process costs."""

    def run() -> Cost:
        seconds, processor, *_ = other.ask(line).split()
        return Cost(float(seconds), float(processor))

    return run


def against_first(page: Page, N: int, rounds: int, seconds: float, largest_N: int) -> None:
    """The spindle beside the first version of the project.

    seconds : what one run on `largest_N` cells takes
    """
    what = f"5-D, m = 3, N = {N}, tree and mesh: time over the first version's"
    page.add(
        f"## Beside the first version of this project ({FIRST}): 5-D, m = 3, N = {N}",
        f"It was asked for at N = 128. One run of ours takes {seconds:.0f} s at N = {largest_N}; "
        "rounds of both would take too long there. The growth is that of the table above.",
    )
    try:
        with ExitStack() as stack:
            folder = stack.enter_context(first_version())
            ours = stack.enter_context(served(ROOT / "reference", N))
            first = stack.enter_context(served(folder, N))
            timings = in_turn({"ours": _asked(ours), "first": _asked(first)}, rounds)
    except AbsentError as error:
        page.add(str(error))
        page.ask("five", what, None, HALF, most=True, absent=str(error))
        return
    page.table(["", "seconds (least to most)"], [[one.name, one.shown(2)] for one in timings])
    page.ask("five", what, over(timings, "ours", "first"), HALF, most=True)


def largest(N: int) -> tuple[float, float, int]:
    """Seconds of the processor, gigabytes at the highest, and simplices, of one run on N cells."""
    with served(ROOT / "reference", N) as ours:
        _, seconds, count, peak = ours.ask("call").split()
    return float(seconds), float(peak) / 1e9, int(count)


def sphere(dimension: int, N: int) -> Mesh:
    """The unit sphere on N cells a side, sampled and cut."""
    axes = np.meshgrid(*[np.linspace(-1.3, 1.3, N + 1)] * dimension, indexing="ij", sparse=True)
    values = np.asarray(1 - sum(x**2 for x in axes))
    return extract(Field.of(values[None], 2.6 / N, dimension=dimension))


def traced(page: Page, dimension: int, N: int, rounds: int) -> list[str]:
    """A row of a table: GUDHI's tracing of the same sphere beside ours."""
    what = f"GUDHI's tracing over ours, a sphere in {dimension} dimensions, N = {N}"
    try:
        with gudhi(dimension, N, 1.0, 2.6) as other:
            ours = partial(sphere, dimension, N)
            vertices = int(other.ask("call").split()[2])
            assert vertices == len(ours().vertices), "not the same triangulation"
            costs = {"ours": timed(ours), "tracing": _asked(other), "cells": _asked(other, "cells")}
            timings = in_turn(costs, rounds)
    except AbsentError as error:
        page.ask("tracing", what, None, EVEN, most=False, absent=str(error))
        return [f"{dimension}", f"{N}", str(error), "", "", ""]
    found = [over(timings, one, "ours") for one in ("tracing", "cells")]
    page.ask("tracing", what, found[0], EVEN, most=False)
    ratios = ["{:.1f} ({:.1f} to {:.1f})".format(*one) for one in found]
    return [f"{dimension}", f"{N}", f"{vertices:,}", timings[0].shown(3), *ratios]


TRACED = """\
GUDHI's Python package has no manifold tracing (looked for in its wheel, 3.13); its headers in C++
have, and are a package of Debian's (libgudhi-dev, 3.7). On Kuhn's triangulation, which GUDHI calls
Freudenthal's, it finds as many vertices as ours. It follows the sphere from one point and keeps
what it met in a hash table; it evaluates the sphere's function where it needs it, ours at every
sample, which is in our time. *Tracing* finds vertices alone; *with cells* makes the complex too, as
ours does."""
REASON = """\
The largest of these takes {} of the time, so were it free, the rest would still take {:.2f} of it
where {:g} was asked. The time is spread over many passes: the tree tests boxes level by level, the
section of a block of simplices sorts the keys of its edges so that each vertex is had once, and
joins the blocks. Each is a sort or a pass over all boxes or all edges. A look-up of a cell's
section by the signs of all its 32 corners would save the passes over its 120 simplices; for three
fields those are 96 signs, and the table would have 2^96 entries."""


def shared(rows: Sequence[Sequence[str]]) -> float:
    """What the rows of a profile but the last have of the time together.

    >>> round(shared([["a", "13%"], ["b", "12%"], ["9 others", "75%"]]), 2)
    0.25
    """
    return sum(float(share.rstrip("%")) for _, share in rows[:-1]) / 100


def main() -> None:
    """The report, in reports/benchmarks or in --out."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    root = Path(__file__).parents[1]
    out = root / "reports" / "benchmarks" / "simplicial.md"
    parser.add_argument("--out", type=Path, default=out)
    parser.add_argument("--small", action="store_true", help="lower resolutions only")
    options = parser.parse_args()
    page = Page("Simplicial isosurfaces", (__doc__ or "").split("\n\n")[1].split(" Writes")[0])
    page.add("## Cost by size", "\n".join(scale(options.small)))
    N = 32 if options.small else 128
    seconds, gigabytes, count = largest(N)
    page.add(
        f"5-D, m = 3, N = {N}, tree and mesh, one run in a process of its own: {seconds:.1f} s of "
        f"the processor, {gigabytes:.2f} GB at its highest, {count:,} triangles."
    )
    page.add("## Growth of the tree: exponents of N, n - m = 2", "\n".join(growth(options.small)))
    page.add(GROWTH)
    page.add("## Peers in space", "\n".join(peers(64 if options.small else 128, 5)), PEERS)
    against_first(page, 16 if options.small else 32, 3, seconds, N)
    page.add("## GUDHI's manifold tracing, the same sphere")
    sizes = ((3, 16),) if options.small else ((3, 64), (4, 10))
    rows = [traced(page, dimension, cells, 3) for dimension, cells in sizes]
    heads = ["dimension", "N", "vertices", "ours, s (least to most)"]
    page.table([*heads, "tracing over ours", "with cells over ours"], rows)
    page.add(TRACED)
    page.show_goals()
    made = spindle_5d(16 if options.small else 32)
    rows = profile(lambda: extract_dyadic(*made), "isoref", 12)
    share = float(rows[0][1].rstrip("%")) / 100
    reason = REASON.format(rows[0][1], 1 - share, HALF)
    for one in page.unexplained:
        page.explain(
            one,
            f"no part is large: the largest, {rows[0][0]}, takes {rows[0][1]} of the time of the "
            f"tree and its mesh, the {len(rows) - 1} largest {shared(rows):.0%}",
        )
    page.why(table_of(["5-D, m = 3, tree and mesh: function", "of its time"], rows), reason)
    page.write(options.out)


if __name__ == "__main__":
    main()
