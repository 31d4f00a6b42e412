"""Simplicial isosurfaces: cost in four and five dimensions, growth with N, peers in space.

Times are CPU seconds of one thread; memory is the highest rise of the process. Writes
``reports/benchmarks/simplicial.md``.
"""

from __future__ import annotations

import argparse
import importlib.util
import time
from collections.abc import Callable, Sequence
from math import pi
from pathlib import Path

import numpy as np
from isograde.stopwatch import Machine, interleave, peak_memory
from isoref.dyadic import Samples, SlopeBound
from isoref.fast.dyadic import dyadic_tree, extract_dyadic
from isoref.fast.simplicial import extract
from isoref.field import Field, Floats, Integers
from isoref.mesh import Mesh

Make = Callable[[], Mesh]

GROWTH = """A leaf is a cell that the surface may meet, so leaves follow the area of the surface. A
wide box is tested where its parent, twice as wide, could not be ruled out: on the first levels
that is everywhere, and the law shows only where boxes are small beside the surface. Seconds at
small N are the fixed cost of calls."""

PEERS = """Kuhn's triangulation cuts a cell into six tetrahedra, which make more triangles than
a cube does. The general machinery costs more than a table of cubes; `isoref.sweep` is the module
for surfaces in space."""


def two_spheres(x: Floats) -> Floats:
    """Min, section 7.5: two unit spheres of R^4."""
    across: Floats = (x[:, :3] ** 2).sum(axis=1) - 1
    shifted = [across + (x[:, 3] - 0.5) ** 2, across + (x[:, 3] + 0.5) ** 2]
    return np.asarray(np.stack(shifted, axis=1))


def spindle(x: Floats) -> Floats:
    """Min, section 7.3: a surface of revolution with its two angles, in R^5."""
    theta, polar = x[:, 3], x[:, 4]
    across = 2 * np.cos(polar) ** 2 * np.sin(polar)
    surface = [across * np.cos(theta), across * np.sin(theta), 2 * np.cos(polar) ** 3]
    return np.asarray(x[:, :3] - np.stack(surface, axis=1))


def spheres_4d(N: int) -> tuple[Samples, SlopeBound]:
    """The two spheres on N cells a side, with slopes that bound them box by box."""
    h, centres = 2.6 / N, np.array([[0, 0, 0, 0.5], [0, 0, 0, -0.5]])
    samples = Samples.of_function(two_spheres, (N + 1,) * 4, h, [-1.3] * 4)

    def slopes(low: Integers, high: Integers) -> Floats:
        ends = np.stack([low, high])[:, :, None] * h - 1.3 - centres
        steepest: Floats = 2 * h * np.abs(ends).max(axis=0)
        return steepest

    return samples, SlopeBound(slopes)


def spindle_5d(N: int) -> tuple[Samples, SlopeBound]:
    """The lifted spindle on N cells a side, with slopes that bound it."""
    h = np.array([4 / N, 4 / N, 4 / N, 2 * pi / N, pi / N])
    samples = Samples.of_function(spindle, (N + 1,) * 5, list(h), [-2, -2, -2, 0, 0])
    slopes = np.array([[1, 0, 0, 0.77, 2], [0, 1, 0, 0.77, 2], [0, 0, 1, 0, 2.31]])
    return samples, SlopeBound(slopes * h)


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
    """Leaves, boxes tested, and least CPU seconds of three runs."""
    seconds = np.inf
    for _ in range(3):
        start = time.process_time()
        tree = dyadic_tree(samples, bound)
        seconds = min(seconds, time.process_time() - start)
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


def main() -> None:
    """The report, in reports/benchmarks or in --out."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    root = Path(__file__).parents[1]
    parser.add_argument("--out", type=Path, default=root / "reports" / "benchmarks")
    parser.add_argument("--small", action="store_true", help="lower resolutions only")
    options = parser.parse_args()
    machine = Machine()
    parts = [
        "# Simplicial isosurfaces",
        "",
        (__doc__ or "").split("\n\n")[1].split(" Writes")[0],
        "",
    ]
    parts += ["## Cost by size", "", *scale(options.small), ""]
    parts += ["## Growth of the tree: exponents of N, n - m = 2", "", *growth(options.small), ""]
    parts += [*GROWTH.splitlines(), ""]
    parts += ["## Peers in space", "", *peers(64 if options.small else 128, 5), ""]
    parts += [*PEERS.splitlines(), ""]
    parts[4:4] = [f"{machine.state()}.", ""]
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "simplicial.md").write_text("\n".join(parts), encoding="utf-8")
    print(f"wrote {options.out / 'simplicial.md'}")


if __name__ == "__main__":
    main()
