"""Table 1's row of lines: which reading of the paper can have given it.

The paper does not say which tables of marching cubes it used, how many waves it mixed, or whether
segments of no length were dropped. Each reading here is drawn with several seeds; a printed share
fits where it can be one more draw (`isograde.reproduction.Table.add_draws`). A reading explains the
table where the rows of both surfaces fit too; a few waves scatter so much that a lot fits, so the
distance of the means from the print stands beside the verdict.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from inspect import signature
from typing import Any

import numpy as np
from isograde.reproduction import Row, Table
from isoref.curves import real_and_imaginary
from isoref.fast.surface_intersection import enhanced_marching_cubes, surface_intersection
from isoref.field import Field, Floats
from isoref.mesh import Mesh
from isoref.methods import RULES
from isoref.plane_waves import Complex
from isoref.surface_intersection import IndexedSurface, Segments
from numpy.typing import NDArray

Sampler = Callable[..., Complex]
# 1987, the asymptotic decider, and VESTA's cycles cut with other diagonals.
TABLES = ("lorensen-cline", "asymptotic-decider", "marching-vesta-disconnect-L")
BOURKE = "Bourke's tables (PyMCubes)"
WAVES = (5, 10, 20, 100)
# Least lengths of a segment that is counted, in voxel edges.
LENGTHS = (0.01, 0.05)


# What is compared: numbers of lines, and of triangles of either surface, in a voxel. The empty
# voxels of the real surface are what the wave number is fitted to.
LINES = range(1, 6)
TRIANGLES = {"real": range(1, 6), "imaginary": range(6)}

Shares = dict[str, Floats]


@dataclass(frozen=True)
class Reading:
    """One way to count: the equation, the tables, the number of waves, the least length."""

    equation: str
    tables: str
    waves: int
    least: float

    def __str__(self) -> str:
        dropped = f", segments under {self.least:g} h dropped" if self.least else ""
        return f"{self.equation}, {self.tables}, {self.waves} waves{dropped}"


def surface(field: Field, tables: str) -> IndexedSurface:
    """The zero surface by these tables, with the voxel of each triangle."""
    if tables != BOURKE:
        return enhanced_marching_cubes(field, 0.0, RULES[tables])
    import mcubes

    vertices, triangles = mcubes.marching_cubes(np.asarray(field.values), 0.0)
    middle = vertices[triangles].mean(axis=1)
    shape = tuple(n - 1 for n in field.shape)
    voxel = np.clip(np.floor(middle).astype(np.int64), 0, np.array(shape) - 1)
    cells = np.ravel_multi_index(tuple(voxel.T), shape)
    order = np.argsort(cells, kind="stable")
    mesh = Mesh.of(vertices * field.spacing, triangles[order].astype(np.int64))
    return IndexedSurface(mesh, cells[order], shape)


def tables_at_hand() -> tuple[str, ...]:
    """The tables that can be tried here."""
    try:
        import mcubes  # noqa: F401
    except ImportError:
        return TABLES
    return (*TABLES, BOURKE)


def mixing(sampler: Sampler, waves: int) -> Sampler:
    """The sampler with this many waves: itself where that is what it takes when it is not told."""
    if signature(sampler).parameters["count"].default == waves:
        return sampler
    return partial(sampler, count=waves)


def shares(counts: NDArray[np.int64], voxels: int) -> Floats:
    """(8,) percentages of voxels with 0 to 7 primitives, from the counts of 1, 2, .. of them."""
    found = np.zeros(8)
    found[1 : len(counts)] = counts[1:8]
    found[0] = voxels - found[1:].sum()
    return 100 * found / voxels


def lines_in(segments: Segments, least: float) -> NDArray[np.int64]:
    """How many voxels have 0 (not counted), 1, 2, .. lines of at least this length."""
    long = np.linalg.norm(segments.ends[:, 1] - segments.ends[:, 0], axis=1) >= least
    return np.bincount(np.bincount(segments.cells[long]))


def draw(
    sampler: Sampler, equation: str, side: int, seed: int, match: Callable[..., float]
) -> dict[Reading, Shares]:
    """Each reading's rows of Table 1 for one seed; `match` finds the wave number of a sampler."""
    found: dict[Reading, Shares] = {}
    voxels = (side - 1) ** 3
    for waves in WAVES:
        mixed = mixing(sampler, waves)
        k = match(mixed, side, seed)
        pair = real_and_imaginary(mixed((side,) * 3, k, seed=seed), 1 / (side - 1))
        for tables in tables_at_hand() if waves == WAVES[-1] else tables_at_hand()[::3]:
            surfaces = [surface(field, tables) for field in pair]
            both = (shares(one.histogram(), voxels) for one in surfaces)
            rows = dict(zip(TRIANGLES, both, strict=True))
            segments = surface_intersection(*surfaces)
            for least in (0.0, *LENGTHS) if waves == WAVES[-1] else (0.0,):
                lines = shares(lines_in(segments, least / (side - 1)), voxels)
                found[Reading(equation, tables, waves, least)] = {**rows, "lines": lines}
    return found


def fit(drawn: Sequence[Shares], printed: dict[str, Any], columns: dict[str, range]) -> Table:
    """These columns of these rows of Table 1 beside the draws; the level of 5 % is theirs."""
    table = Table("")
    family = sum(len(numbers) for numbers in columns.values())
    for part, numbers in columns.items():
        for n in numbers:
            draws = [float(one[part][n]) for one in drawn]
            table.add_draws(f"{part}, {n}", printed[part][n], draws, step=0.01, family=family)
    return table


def readings(
    samplers: dict[str, Sampler],
    side: int,
    seeds: Sequence[int],
    printed: dict[str, Any],
    match: Callable[..., float],
) -> str:
    """A row a reading, and what follows: which fit, and which comes nearest."""
    drawn: dict[Reading, list[Shares]] = {}
    for equation, sampler in samplers.items():
        for seed in seeds:
            for reading, row in draw(sampler, equation, side, seed, match).items():
                drawn.setdefault(reading, []).append(row)
    heads = ["reading", *(f"{n} lines" for n in LINES), "furthest", "lines fit", "surfaces fit"]
    lines = [
        "## Table 1, lines: every reading tried",
        "",
        f"| {' | '.join(heads)} |",
        f"| --- |{' ---: |' * (len(LINES) + 1)} --- | --- |",
        f"| paper | {' | '.join(f'{share:.2f}' for share in printed['lines'][1:6])} | | | |",
    ]
    fitting, explaining, furthest = [], [], {}
    for reading, rows in drawn.items():
        of_lines = fit(rows, printed, {"lines": LINES})
        of_surfaces = fit(rows, printed, TRIANGLES)
        cells = [f"{row.ours:.3f} ({row.verdict.split('z = ')[1]})" for row in of_lines.rows]
        furthest[reading] = max(abs(_apart(row)) for row in of_lines.rows)
        fits, both = not of_lines.differing(), not of_surfaces.differing()
        fitting += [reading] if fits else []
        explaining += [reading] if fits and both else []
        cells += [f"{furthest[reading]:.3f}", *("yes" if ok else "no" for ok in (fits, both))]
        lines.append(f"| {reading} | {' | '.join(cells)} |")
    lines += ["", _told(len(seeds)), "", _conclusion(fitting, explaining, furthest)]
    return "\n".join(lines) + "\n"


def _apart(row: Row) -> float:
    """How far the mean of the draws lies above the print."""
    if not (isinstance(row.ours, float) and isinstance(row.paper, int | float)):
        raise TypeError(f"row {row.what!r} does not hold two numbers")
    return row.ours - row.paper


def _told(seeds: int) -> str:
    """How the rows are to be read."""
    others = sum(len(numbers) for numbers in TRIANGLES.values())
    return (
        f"Percent of voxels, mean over {seeds} seeds, in brackets how many standard deviations the "
        "mean lies above the print; the deviation is that of one more draw, rounding included, and "
        f"the level of 5 % is shared by the {len(LINES)} columns of lines, and by the {others} of "
        "both surfaces. `furthest` is the largest distance of a mean from the print, in percent of "
        "voxels. The wave number is matched anew for each seed."
    )


def _conclusion(
    fitting: Sequence[Reading], explaining: Sequence[Reading], furthest: dict[Reading, float]
) -> str:
    """Which readings fit, and which comes nearest."""
    names = "; ".join(map(str, explaining)) or "none"
    nearest = min(furthest, key=lambda reading: furthest[reading])
    word = "fits" if nearest in fitting else "does not fit"
    few = sum(reading.waves < WAVES[-1] for reading in fitting)
    return (
        f"The lines of {len(fitting)} of {len(furthest)} readings fit the print, {few} of them "
        f"with fewer than {WAVES[-1]} waves. Both surfaces fit as well in {len(explaining)}: "
        f"{names}. The means nearest to the print are those of {nearest}, {furthest[nearest]:.3f} "
        f"off at most; it {word}. The paper does not say which it was."
    )
