"""Table 1's row of lines: which reading of the paper can have given it.

The paper does not say which tables of marching cubes it used, how many waves it mixed, or whether
segments of no length were dropped. Each reading here is drawn with several seeds; a printed share
fits where it can be one more draw (`isograde.reproduction.Table.add_draws`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from isograde.reproduction import Table
from isoref.curves import real_and_imaginary
from isoref.fast.surface_intersection import enhanced_marching_cubes, surface_intersection
from isoref.field import Field, Floats
from isoref.mesh import Mesh
from isoref.methods import RULES
from isoref.plane_waves import Complex
from isoref.surface_intersection import IndexedSurface, Segments

Sampler = Callable[..., Complex]
# 1987, the asymptotic decider, and VESTA's cycles cut with other diagonals.
TABLES = ("lorensen-cline", "asymptotic-decider", "marching-vesta-disconnect-L")
BOURKE = "Bourke's tables (PyMCubes)"
WAVES = (5, 10, 20, 100)
# Least lengths of a segment that is counted, in voxel edges.
LENGTHS = (0.01, 0.05)


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


def shares(segments: Segments, voxels: int, least: float) -> Floats:
    """(8,) percentages of voxels with 0 to 7 lines of at least this length."""
    long = np.linalg.norm(segments.ends[:, 1] - segments.ends[:, 0], axis=1) >= least
    counts = np.bincount(np.bincount(segments.cells[long]), minlength=8)[:8].astype(float)
    counts[0] = voxels - counts[1:].sum()
    return np.asarray(100 * counts / voxels)


def draw(
    sampler: Sampler, equation: str, side: int, seed: int, match: Callable[..., float]
) -> dict[Reading, Floats]:
    """Each reading's shares for one seed; `match` finds the wave number of a sampler."""
    found: dict[Reading, Floats] = {}
    for waves in WAVES:

        def mixed(shape: tuple[int, ...], k: float, *, seed: int, waves: int = waves) -> Complex:
            return sampler(shape, k, count=waves, seed=seed)

        k = match(mixed, side, seed)
        pair = real_and_imaginary(mixed((side,) * 3, k, seed=seed), 1 / (side - 1))
        for tables in tables_at_hand() if waves == WAVES[-1] else tables_at_hand()[::3]:
            first, second = (surface(field, tables) for field in pair)
            segments = surface_intersection(first, second)
            for least in (0.0, *LENGTHS) if waves == WAVES[-1] else (0.0,):
                reading = Reading(equation, tables, waves, least)
                found[reading] = shares(segments, (side - 1) ** 3, least / (side - 1))
    return found


def readings(
    samplers: dict[str, Sampler],
    side: int,
    seeds: Sequence[int],
    printed: Sequence[float],
    match: Callable[..., float],
) -> tuple[str, list[str]]:
    """A row a reading, and the names of those that fit in every column."""
    drawn: dict[Reading, list[Floats]] = {}
    for equation, sampler in samplers.items():
        for seed in seeds:
            for reading, row in draw(sampler, equation, side, seed, match).items():
                drawn.setdefault(reading, []).append(row)
    shown = list(range(1, 6))
    lines = [
        "## Table 1, lines: every reading tried",
        "",
        f"| reading | {' | '.join(f'{n} lines' for n in shown)} | fits |",
        f"| --- |{' ---: |' * len(shown)} --- |",
        f"| paper | {' | '.join(f'{printed[n]:.2f}' for n in shown)} | |",
    ]
    fitting = []
    for reading, rows in drawn.items():
        table = Table("")
        for n in shown:
            draws = [float(row[n]) for row in rows]
            table.add_draws(f"{n}", printed[n], draws, step=0.01, family=len(shown))
        cells = [f"{row.ours:.3f} ({row.verdict.split('z = ')[1]})" for row in table.rows]
        fits = not table.differing()
        fitting += [str(reading)] if fits else []
        lines.append(f"| {reading} | {' | '.join(cells)} | {'yes' if fits else 'no'} |")
    lines += [
        "",
        f"Percent of voxels, mean over {len(seeds)} seeds, in brackets how many standard "
        "deviations the mean lies above the print; the deviation is that of one more draw, and the "
        f"level of 5 % is shared by the {len(shown)} columns. The wave number is matched anew for "
        "each seed.",
        "",
        f"{len(fitting)} of {len(drawn)} readings fit the print: {'; '.join(fitting) or 'none'}.",
    ]
    return "\n".join(lines) + "\n", fitting
