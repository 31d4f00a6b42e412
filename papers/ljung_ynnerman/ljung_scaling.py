"""Figures 5 and 6 and Appendix A: how tests and times grow.

The law is of large volumes. Two corrections are known, and the fits say which they allow for:

- a lattice too coarse for the wave misses details. Linear interpolation errs by the square of a
  voxel's edge, so a count is ``a s^p (1 + b / s^2)``;
- a lattice of s voxels a side has ``3 s^2 (s + 1)`` faces, those of the border too, so the tests of
  Marching Faces grow with ``s + 1``.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import ljung_words as words
import numpy as np
from isograde.reproduction import Table
from isoref.curves import real_and_imaginary
from isoref.fast import marching_faces, surface_intersection
from isoref.fast.surface_intersection import candidate_pairs, enhanced_marching_cubes
from isoref.field import Field
from isoref.plane_waves import random_waves
from ljung_pictures import save
from scipy import stats

# Section 4.2: five triangles against five.
MOST_PAIRS = 25


@dataclass(frozen=True)
class Counted:
    """What Figure 6 plots, for one size and one seed; s is the side in voxels."""

    s: int
    seed: int
    n1: int
    n2: int
    trisect: int
    xface: int


@dataclass(frozen=True)
class Timed:
    """What Figure 5 plots, for one size and one seed: seconds."""

    s: int
    seed: int
    n1: int
    emc_seconds: float
    isect_seconds: float
    faces_seconds: float


def waves(side: int, seed: int, k: float) -> tuple[Field, Field]:
    """Waves of a fixed geometry on a lattice of this many samples a side."""
    return real_and_imaginary(random_waves((side,) * 3, k, seed=seed), 1 / (side - 1))


def count(side: int, seed: int, k: float) -> Counted:
    """The tests of both methods, counted without being done."""
    first, second = waves(side, seed, k)
    one, two = (enhanced_marching_cubes(field, 0.0) for field in (first, second))
    pair = marching_faces.Pair(first, second, (0.0, 0.0), "gradient")
    return Counted(
        s=side - 1,
        seed=seed,
        n1=len(one.mesh.simplices),
        n2=len(two.mesh.simplices),
        trisect=len(candidate_pairs(one, two)[0]),
        xface=sum(len(voxels) for voxels, _ in pair.candidates()),
    )


def clock(side: int, seed: int, k: float) -> Timed:
    """The times of both methods: of this process, so that others on the machine do not count."""
    first, second = waves(side, seed, k)
    start = time.process_time()
    one, two = (enhanced_marching_cubes(field, 0.0) for field in (first, second))
    made = time.process_time()
    surface_intersection.surface_intersection(one, two)
    met = time.process_time()
    marching_faces.marching_faces(first, second)
    marched = time.process_time()
    return Timed(side - 1, seed, len(one.mesh.simplices), made - start, met - made, marched - met)


Rows = Sequence[Counted] | Sequence[Timed]


def exponent(
    rows: Rows, of: str, against: str, *, border: int = 0, bend: bool = False
) -> tuple[float, float]:
    """The exponent p of ``of = a (against + border)^p``, and half the width of its 95 % interval.

    It is the mean over the seeds. With `bend` the factor ``1 + b / s^2`` is fitted too, as
    ``b / s^2`` in the logarithm.
    """
    slopes = []
    for seed in sorted({row.seed for row in rows}):
        own = [row for row in rows if row.seed == seed]
        x = np.log([getattr(row, against) + border for row in own])
        y = np.log([getattr(row, of) for row in own])
        columns = [np.ones_like(x), x]
        columns += [np.array([row.s for row in own], float) ** -2] if bend else []
        slopes.append(float(np.linalg.lstsq(np.stack(columns, axis=1), y)[0][1]))
    return interval(slopes)


def interval(numbers: Sequence[float]) -> tuple[float, float]:
    """Mean, and half the width of its 95 % interval by Student's t."""
    n = len(numbers)
    half = stats.t.ppf(0.975, n - 1) * np.std(numbers, ddof=1) / np.sqrt(n)
    return float(np.mean(numbers)), float(half)


def by_seed(rows: Sequence[Counted], of: Callable[[Counted], float]) -> tuple[float, float]:
    """`interval` of the means for each seed: sizes of one seed are samples of one wave."""
    seeds = sorted({row.seed for row in rows})
    return interval([float(np.mean([of(r) for r in rows if r.seed == seed])) for seed in seeds])


def shown(value: tuple[float, float]) -> str:
    """Mean and half width, with as many digits as they deserve."""
    return f"{value[0]:.3f} ± {value[1]:.3f}"


def scaling(counted: Sequence[Counted], timed: Sequence[Timed]) -> Table:
    """The fitted slopes of Figures 5 and 6."""
    table = Table("Figures 5 and 6: exponents, fitted over sizes, for several seeds")
    sides = sorted({row.s for row in counted})
    sizes = f"s from {sides[0]} to {sides[-1]}, {len({row.seed for row in counted})} seeds"
    for of, against, claimed, border in (
        ("n1", "s", 2.0, 0),
        ("trisect", "s", 1.0, 0),
        ("xface", "s", 1.0, 1),
        ("trisect", "n1", 0.5, 0),
        ("xface", "n1", 0.5, 0),
    ):
        fits = [(f"{of} over {against}", "a power and nothing else", {})]
        if border:
            fits.append((f"{of} over s + 1", "the border's faces allowed for", {"border": 1}))
        if against == "s":
            what, note, options = fits[-1]
            note = "the bend 1 + b / s^2 allowed for" + (", and the border" if border else "")
            fits.append((what, note, {**options, "bend": True}))
        for what, note, options in fits:
            mean, half = exponent(counted, of, against, **options)
            note = f"{note}; {sizes}; 95 % interval ± {half:.4f}"
            table.add(
                what, None, round(mean, 4), expected=claimed, tolerance=round(half, 4), note=note
            )
    table.rows += _times(timed).rows
    ratio = by_seed(counted, lambda row: row.trisect / row.xface)
    note = "the paper: Marching Faces has a smaller constant"
    table.add("trisect / xface", None, shown(ratio), note=note)
    return table


def _times(rows: Sequence[Timed]) -> Table:
    """How times grow, and what the paper says of them."""
    table = Table("")
    for of in ("emc_seconds", "isect_seconds", "faces_seconds"):
        note = "time over triangles, this machine; a share of it is constant"
        table.add(f"{of} over n1", None, shown(exponent(rows, of, "n1")), note=note)
    load = f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors"
    sizes = _by_size(rows)
    for what, count, quoted in (
        (
            "Marching Faces is faster than both surfaces together",
            sum(faces < emc for emc, _, faces in sizes),
            '"the MF algorithm is faster than EMC"',
        ),
        (
            "making both surfaces takes the most time of the three",
            sum(emc > max(isect, faces) for emc, isect, faces in sizes),
            '"iso-surface extraction requires the most work"',
        ),
    ):
        note = f"{quoted}; medians over {len({row.seed for row in rows})} seeds; {load}"
        what = f"{what}: sizes of {len(sizes)}"
        table.add(what, None, count, expected=len(sizes), note=note)
    return table


def _by_size(rows: Sequence[Timed]) -> list[tuple[float, float, float]]:
    """Medians over the seeds, a size a row: both surfaces, their intersection, Marching Faces."""
    found = []
    for s in sorted({row.s for row in rows}):
        own = [row for row in rows if row.s == s]
        emc, isect, faces = (
            float(np.median([getattr(row, f"{name}_seconds") for row in own]))
            for name in ("emc", "isect", "faces")
        )
        found.append((emc, isect, faces))
    return found


def approach(rows: Sequence[Counted]) -> str:
    """How the counts approach their laws, size by size, as a Markdown table."""
    lines = [
        "## Size by size: what should be constant",
        "",
        "| s | seeds | N1 / s^2 | triangle tests / s | faces tested / s | faces tested / (s + 1) |",
        "| ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for s in sorted({row.s for row in rows}):
        own = [row for row in rows if row.s == s]
        columns = (
            interval([row.n1 / s**2 for row in own]),
            interval([row.trisect / s for row in own]),
            interval([row.xface / s for row in own]),
            interval([row.xface / (s + 1) for row in own]),
        )
        cells = " | ".join(f"{mean:.2f} ± {half:.2f}" for mean, half in columns)
        lines.append(f"| {s} | {len(own)} | {cells} |")
    return "\n".join(lines) + "\n"


def appendix_a(rows: Sequence[Counted], side: int, k: float) -> Table:
    """c1 and c2, the predicted number of tests, and the extreme cases on `side` samples."""
    table = Table("Appendix A: the probability argument, measured")
    largest = max(row.s for row in rows)
    own = [row for row in rows if row.s == largest]
    for name in ("n1", "n2"):
        c = interval([getattr(row, name) / row.s**2 for row in own])
        table.add(f"c{name[1]} = N{name[1]} / s^2", None, shown(c), note=f"s = {largest}")
    mean, half = by_seed(rows, lambda row: row.trisect * row.s**3 / (row.n1 * row.n2))
    note = f"independent surfaces, mean over the sizes; 95 % interval over seeds ± {half:.3f}"
    what = "tests / (c1 c2 s)"
    table.add(what, None, round(mean, 3), expected=1.0, tolerance=round(half, 3), note=note)
    triangles = interval([row.n1 / row.s**3 for row in own])
    note = "eq. 7 calls it a probability; it is the mean number of triangles"
    table.add("N1 / s^3", None, shown(triangles), note=note)
    table.rows += _extremes(side, k).rows
    return table


def costs(side: int, seeds: int, k: float) -> Table:
    """Pairs in a tested voxel, what caching saves, and how much of the time is traversal."""
    table = Table("Sections 4.2 and 7: pairs of triangles, caching, and where the time goes")
    pairs, most, share, beside = [], 0, [], []
    for seed in range(seeds):
        first, second = waves(side, seed, k)
        begun = time.process_time()
        one, two = (enhanced_marching_cubes(field, 0.0) for field in (first, second))
        made = time.process_time()
        surface_intersection.surface_intersection(one, two)
        beside.append((time.process_time() - made) / (made - begun))
        in_voxels = np.arange(int(np.prod(one.shape)))
        tests = one.count_in(in_voxels) * two.count_in(in_voxels)
        pairs.append(float(tests[tests > 0].mean()))
        most = max(most, int(tests.max()))
        pair = marching_faces.Pair(first, second, (0.0, 0.0), "gradient")
        start = time.process_time()
        pair.candidates()
        found = time.process_time()
        marching_faces.marching_faces(first, second)
        share.append((found - start) / (time.process_time() - found))
    mean = float(np.mean(pairs))
    note = f'"typically 2-3 triangle pairs are tested"; {words.beyond(mean, 2, 3)}'
    table.add("pairs in a tested voxel, mean", "2 to 3", round(mean, 2), note=note)
    table.add("most pairs in a voxel", None, most, note=words.bound(most, MOST_PAIRS))
    first, _ = waves(side, 0, k)
    voxels, samples = (side - 1) ** 3, side**3
    table.add("comparisons of samples a voxel, none kept", None, 8.0)
    half = (8 + 4 * (side - 2)) / (side - 1)
    note = (
        '"a simple caching scheme to save half of the bit-set": "roughly halves the time"; '
        "by arithmetic, not timed"
    )
    table.add("the same, half of the bits kept along a row", None, round(half, 3), note=note)
    note = "each sample compared once, whole planes at a time (`voxel_configurations`)"
    table.add("comparisons a voxel in isoref", None, round(samples / voxels, 3), note=note)
    table.rows += _quoted(share, beside, f"CPU time on {side}^3 samples, a busy machine").rows
    return table


def _quoted(share: Sequence[float], beside: Sequence[float], how: str) -> Table:
    """What the paper says in words of two times, each as a question that a run answers."""
    table, seeds = Table(""), len(share)
    note = f'"almost all"; a share of {min(share):.2f} to {max(share):.2f}; {how}'
    what = f"traversal takes more than half of the time: runs of {seeds}"
    table.add(what, None, sum(s > 0.5 for s in share), expected=seeds, note=note)
    note = (
        f'"a small additional amount of work"; {min(beside):.2f} to {max(beside):.2f} times; {how}'
    )
    what = f"segments cost less than both surfaces: runs of {seeds}"
    table.add(what, None, sum(b < 1 for b in beside), expected=seeds, note=note)
    return table


def _extremes(side: int, k: float) -> Table:
    """Identical surfaces, and surfaces that never meet."""
    table = Table("")
    first, _ = waves(side, 0, k)
    surface = enhanced_marching_cubes(first, 0.0)
    n = len(surface.mesh.simplices)
    tests = surface_intersection.surface_intersection(surface, surface).tests
    note = "of order N, as the appendix says; a voxel of n triangles has n^2 tests"
    table.add("identical surfaces: tests / N", None, round(tests / n, 3), note=note)
    away = enhanced_marching_cubes(first, float(first.values.max()) + 1)
    tests = surface_intersection.surface_intersection(surface, away).tests
    table.add("surfaces that never meet: tests", 0, tests, note="appendix A, last sentence")
    return table


def figure_6(rows: Sequence[Counted], path: Path) -> None:
    """Tests over the side of the volume, each seed a thin line, with fitted and paper's slopes."""
    from matplotlib import pyplot as plt
    from matplotlib.ticker import NullFormatter

    figure, axes = plt.subplots(1, 2, figsize=(10, 4))
    for of, colour in (("trisect", "tab:red"), ("xface", "tab:blue")):
        for panel, against in zip(axes, ("s", "n1"), strict=True):
            border = int(of == "xface" and against == "s")
            fitted = shown(exponent(rows, of, against, border=border, bend=against == "s"))
            for seed in sorted({row.seed for row in rows}):
                own = [row for row in rows if row.seed == seed]
                label = f"{of}, slope {fitted}" if seed == rows[0].seed else None
                x, y = ([getattr(row, name) for row in own] for name in (against, of))
                panel.plot(x, y, "o-", color=colour, alpha=0.5, ms=3, lw=0.8, label=label)
    axes[0].set(xlabel="side of the volume (voxels)", ylabel="intersection tests")
    axes[0].set(xlim=(0, None), ylim=(0, None), title="over the side (slopes with bend and border)")
    reach = np.array([min(row.n1 for row in rows), max(row.n1 for row in rows)])
    start = np.mean([row.trisect for row in rows if row.s == rows[0].s])
    axes[1].plot(reach, start * np.sqrt(reach / reach[0]), "k--", lw=1, label=r"$\sqrt{N}$")
    axes[1].set(
        xlabel="triangles of the first surface",
        ylabel="intersection tests",
        xscale="log",
        yscale="log",
    )
    axes[1].set(title="over the triangles; dashed: a square root")
    axes[1].xaxis.set_minor_formatter(NullFormatter())
    for panel in axes:
        panel.legend(frameon=False)
        panel.grid(alpha=0.2)
    save(figure, path)


def figure_5(rows: Sequence[Timed], path: Path) -> None:
    """Times over the number of triangles, median over the seeds."""
    from matplotlib import pyplot as plt
    from matplotlib.ticker import NullFormatter

    figure, panel = plt.subplots(figsize=(6, 4))
    sizes = sorted({row.s for row in rows})
    for name, label in (
        ("emc_seconds", "EMC x 2"),
        ("isect_seconds", "MC-Isect"),
        ("faces_seconds", "MF-Points"),
    ):
        own = [[row for row in rows if row.s == s] for s in sizes]
        x = [np.median([row.n1 for row in some]) for some in own]
        y = [np.median([getattr(row, name) for row in some]) for some in own]
        label = f"{label}, slope {shown(exponent(rows, name, 'n1'))}"
        panel.loglog(x, y, "o-", ms=4, label=label)
    panel.set(xlabel="triangles of the first surface", ylabel="processor seconds, this machine")
    panel.xaxis.set_minor_formatter(NullFormatter())
    panel.legend(frameon=False)
    panel.grid(alpha=0.2, which="both")
    save(figure, path)
