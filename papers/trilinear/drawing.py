"""How near to the level set the trilinear cell is drawn, and at how many triangles.

Run it from anywhere: ``python papers/trilinear/drawing.py``. It writes
reports/papers/trilinear/drawing.md: trilinear cubes with the diagonals that are nearest to the
level set, and with points on it, beside the plain tiles and the asymptotic decider, on seeded
fields that anybody can make again. The distance has two sides:
from points of the mesh to the level set, along Newton's steps (an upper bound), and from points of
the level set to the mesh, by libigl. Triangles are counted, and their shapes.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from isograde.oracles.complexes import Complex
from isograde.oracles.self_intersections import self_intersections
from isograde.oracles.shapes import shapes
from isograde.oracles.trilinear_distance import STEPS, distance, value_and_gradient
from isograde.proof import prove
from isograde.reproduction import Table, write_report
from isoref import asymptotic_decider, diagonals, trilinear_cubes
from isoref.fast.sweep import sweep
from isoref.field import Field, Floats
from isoref.mesh import Mesh
from scipy import ndimage

HERE = Path(__file__).parent
SIDE, SEEDS = 16, range(3)
PLAIN, NEAR, FIVE, THREE, TWO = (
    f"trilinear-cubes{ending}" for ending in ("", ", nearest diagonals", "-5", "-3", "-2")
)
METHODS: dict[str, Callable[[Field, float], Mesh]] = {
    "asymptotic-decider": partial(sweep, asymptotic_decider.RULE),
    PLAIN: partial(sweep, trilinear_cubes.RULE),
    NEAR: partial(diagonals.extract, trilinear_cubes.RULE, criterion="near"),
    FIVE: partial(sweep, trilinear_cubes.drawn(5)),
    THREE: partial(sweep, trilinear_cubes.drawn(3)),
    TWO: partial(sweep, trilinear_cubes.drawn(2)),
}
# The nearest diagonals turn inner edges of cells alone: the proof of the plain rule is theirs.
PROVED = (trilinear_cubes.RULE, *map(trilinear_cubes.drawn, (5, 3, 2)))
PROBES = np.array([[2, 2, 2], [3, 3, 0], [0, 3, 3], [3, 0, 3]]) / 6


def smooth_noise(seed: int) -> Floats:
    """Noise smoothed over about a spacing."""
    values = np.random.default_rng(seed).normal(size=(SIDE,) * 3)
    return np.asarray(ndimage.gaussian_filter(values, 1.0))


def white_noise(seed: int) -> Floats:
    """Noise as it is."""
    return np.random.default_rng(seed).normal(size=(SIDE,) * 3)


FIELDS: dict[str, Callable[[int], Floats]] = {
    "smoothed noise": smooth_noise,
    "white noise": white_noise,
}


def from_mesh(values: Floats, mesh: Mesh) -> float:
    """Mean distance of points on triangles from the level set, in spacings."""
    probes = np.einsum("pk,fkd->pfd", PROBES, mesh.vertices[mesh.simplices]).reshape(-1, 3)
    return float(np.nanmean(distance(values, 0.0, probes)))


def on_level_set(values: Floats, number: int) -> Floats:
    """Points of the level set inside the lattice, led there from random points near it."""
    chance = np.random.default_rng(0)
    last = np.subtract(values.shape, 1.0)
    points = chance.uniform(0, 1, (20 * number, 3)) * last
    value, slope = value_and_gradient(values, points)
    near = np.abs(value) < 0.5 * np.linalg.norm(slope, axis=1)
    at = points[near]
    for _ in range(STEPS):
        value, slope = value_and_gradient(values, at)
        size = np.maximum((slope**2).sum(axis=1), 1e-30)
        at = np.clip(at - (value / size)[:, None] * slope, 0, last)
    value, _ = value_and_gradient(values, at)
    return np.asarray(at[np.abs(value) < 1e-9 * np.ptp(values)][:number])


def to_mesh(points: Floats, mesh: Mesh) -> float:
    """Mean distance of points from the nearest triangle, in spacings."""
    import igl

    squared = igl.point_mesh_squared_distance(points, mesh.vertices, mesh.simplices)[0]
    return float(np.sqrt(squared).mean())


@dataclass(frozen=True)
class Drawn:
    """What was measured of a way to draw, on the fields of one kind.

    to_level_set, to_mesh : mean distances, in spacings
    triangles : mean number
    angle, thin : median least angle, in degrees, and share of triangles below 5 degrees
    crossings, crowded : pairs of triangles that cross, and edges of more than two triangles, in all
    """

    to_level_set: float
    to_mesh: float
    triangles: float
    angle: float
    thin: float
    crossings: int
    crowded: int


OPENING = f"""Made by `papers/trilinear/drawing.py`: mean distances in spacings, mesh to level set
and level set to mesh, over {len(SEEDS)} seeded fields of {SIDE}^3 samples each (`smooth_noise`,
`white_noise` there). *Nearest diagonals* are those of `isoref.diagonals` with its criterion
`near`. `trilinear-cubes-5` has a point on the level set in each polygon of more than five sides,
`-3` in each of more than three (Lopes and Brodlie's way), `-2` in every one. The nearest diagonals
turn edges inside cells alone (`test_diagonals.py`), so that the proof of the plain rule is theirs.
Grosso's TMC is in no registry and not measured here.
"""
READING = """What was asked for is a distance "below that of the plain tiles at no more triangles
and below Lopes & Brodlie's way at more". The second half can be read in two ways: their way is
below the plain tiles, at more triangles; or there is a drawing below theirs, at more triangles than
theirs. Both are rows.
"""
Rows = dict[str, dict[str, Drawn]]


def verdicts(found: Rows, proved: dict[str, bool]) -> Table:
    """The halves of the sentence, each counted: distances of both sides, and triangles.

    found : for each kind of field, what each method draws
    """
    table = Table("Nearer, and at how many triangles")
    fields, both = len(found), 2 * len(found)
    for near, far, fewer in ((NEAR, PLAIN, True), (THREE, PLAIN, False), (TWO, THREE, False)):
        pairs = [(rows[near], rows[far]) for rows in found.values()]
        below = sum((a.to_level_set < b.to_level_set) + (a.to_mesh < b.to_mesh) for a, b in pairs)
        count = sum((a.triangles <= b.triangles) == fewer for a, b in pairs)
        table.add(f"{near}: distances below those of {far}", None, below, expected=both)
        words = "no more triangles" if fewer else "more triangles"
        table.add(f"{near}: kinds of field with {words}", None, count, expected=fields)
    every = [row for rows in found.values() for row in rows.values()]
    for what, number in (
        ("pairs of triangles that cross, in all meshes", sum(row.crossings for row in every)),
        ("edges of more than two triangles, in all meshes", sum(row.crowded for row in every)),
    ):
        table.add(what, None, number, expected=0)
    note = ", ".join(name for name, holds in proved.items() if holds)
    table.add("rules proved closed and manifold", None, sum(proved.values()),
              expected=len(proved), note=note)  # fmt: skip
    return table


def measures(found: Rows) -> str:
    """The table of what was measured."""
    lines = [
        "## What was measured",
        "",
        "| field | rule | to the level set | to the mesh | triangles | more | median least angle "
        "| below 5 degrees | crossings |",
        "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for name, rows in found.items():
        for method, row in rows.items():
            more = row.triangles / rows[PLAIN].triangles - 1
            lines.append(
                f"| {name} | {method} | {row.to_level_set:.4f} | {row.to_mesh:.4f} "
                f"| {row.triangles:,.0f} | {more:+.0%} | {row.angle:.1f}° | {row.thin:.1%} "
                f"| {row.crossings} |"
            )
    return "\n".join(lines) + "\n"


def measured(extract: Callable[[Field, float], Mesh], make: Callable[[int], Floats]) -> Drawn:
    """What is true of the method on the fields of one kind."""
    rows, crossings, crowded = [], 0, 0
    for seed in SEEDS:
        values = make(seed)
        mesh = extract(Field.of(values), 0.0)
        surface = Complex.of(mesh.vertices, mesh.simplices)
        of_triangles = shapes(surface)
        crossings += len(self_intersections(mesh.vertices, mesh.simplices))
        crowded += len(surface.crowded_facets)
        rows.append(
            [
                from_mesh(values, mesh),
                to_mesh(on_level_set(values, 3000), mesh),
                len(mesh.simplices),
                of_triangles.median,
                of_triangles.thin,
            ]
        )
    return Drawn(*np.array(rows, np.float64).mean(axis=0).tolist(), crossings, crowded)


def main() -> None:
    """Write the report."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE.parents[1] / "reports" / "papers")
    options = parser.parse_args()
    path = options.out / "trilinear" / "drawing.md"
    found = {
        name: {method: measured(extract, make) for method, extract in METHODS.items()}
        for name, make in FIELDS.items()
    }
    table = verdicts(found, {rule.name: prove(rule).holds for rule in PROVED})
    title = "How near the trilinear cell is drawn"
    write_report(path, title, [OPENING, READING, table, measures(found)])
    print(f"wrote {path}")


if __name__ == "__main__":
    main()
