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
from functools import partial
from pathlib import Path

import numpy as np
from isograde.oracles.complexes import Complex
from isograde.oracles.self_intersections import self_intersections
from isograde.oracles.shapes import shapes
from isograde.oracles.trilinear_distance import STEPS, distance, value_and_gradient
from isoref import asymptotic_decider, diagonals, trilinear_cubes
from isoref.fast.sweep import sweep
from isoref.field import Field, Floats
from isoref.mesh import Mesh
from scipy import ndimage

HERE = Path(__file__).parent
SIDE, SEEDS = 16, range(3)
PLAIN, NEAR, FIVE, THREE = (
    f"trilinear-cubes{ending}" for ending in ("", ", nearest diagonals", "-5", "-3")
)
METHODS: dict[str, Callable[[Field, float], Mesh]] = {
    "asymptotic-decider": partial(sweep, asymptotic_decider.RULE),
    PLAIN: partial(sweep, trilinear_cubes.RULE),
    NEAR: partial(diagonals.extract, trilinear_cubes.RULE, criterion="near"),
    FIVE: partial(sweep, trilinear_cubes.drawn(5)),
    THREE: partial(sweep, trilinear_cubes.drawn(3)),
}
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


def report() -> str:
    """The table, and what it says."""
    lines = [
        "# How near the trilinear cell is drawn",
        "",
        "Made by `papers/trilinear/drawing.py`: mean distances in spacings, mesh to level set and "
        f"level set to mesh, over {len(SEEDS)} seeded fields of {SIDE}^3 samples each "
        "(`smooth_noise`, `white_noise` there). *Nearest diagonals* are those of "
        "`isoref.diagonals` with its criterion `near`. `trilinear-cubes-5` has a point on the "
        "level set in each polygon of more than five sides, `-3` in each of more than three "
        "(Lopes and Brodlie's way). Grosso's TMC is in no registry and not measured here.",
        "",
        "| field | rule | to the level set | to the mesh | triangles | more | median least angle "
        "| below 5 degrees | crossings |",
        "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    pairs = ((NEAR, PLAIN), (FIVE, PLAIN), (THREE, FIVE))
    below = dict.fromkeys(pairs, 0)
    fewer, crossings = 0, 0.0
    for name, make in FIELDS.items():
        rows = {method: measured(extract, make) for method, extract in METHODS.items()}
        plain = rows[PLAIN]
        for method, row in rows.items():
            more = row[2] / plain[2] - 1
            lines.append(
                f"| {name} | {method} | {row[0]:.4f} | {row[1]:.4f} | {row[2]:,.0f} | {more:+.0%} "
                f"| {row[3]:.1f}° | {row[4]:.1%} | {row[5]:.0f} |"
            )
        fewer += rows[NEAR][2] <= plain[2]
        crossings += sum(row[5] for row in rows.values())
        for pair in pairs:
            below[pair] += sum(rows[pair[0]][i] < rows[pair[1]][i] for i in (0, 1))
    told = "; ".join(f"{one} below {other} in {n}" for (one, other), n in below.items())
    lines += [
        "",
        f"Of {2 * len(FIELDS)} distances, two a field: {told}. The nearest diagonals take no more "
        f"triangles than the plain tiles in {fewer} of {len(FIELDS)} fields. "
        f"{crossings:.0f} pairs of triangles cross in all meshes together.",
    ]
    return "\n".join(lines) + "\n"


def measured(extract: Callable[[Field, float], Mesh], make: Callable[[int], Floats]) -> Floats:
    """(6,) both distances, triangles, median least angle, share of thin ones, crossings."""
    rows = []
    for seed in SEEDS:
        values = make(seed)
        mesh = extract(Field.of(values), 0.0)
        of_triangles = shapes(Complex.of(mesh.vertices, mesh.simplices))
        crossings = len(self_intersections(mesh.vertices, mesh.simplices))
        rows.append(
            [
                from_mesh(values, mesh),
                to_mesh(on_level_set(values, 3000), mesh),
                len(mesh.simplices),
                of_triangles.median,
                of_triangles.thin,
                crossings,
            ]
        )
    found = np.array(rows, np.float64)
    return np.append(found[:, :5].mean(axis=0), found[:, 5].sum())


def main() -> None:
    """Write the report."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE.parents[1] / "reports" / "papers")
    options = parser.parse_args()
    path = options.out / "trilinear" / "drawing.md"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(report(), encoding="utf-8")
    print(f"wrote {path}")


if __name__ == "__main__":
    main()
