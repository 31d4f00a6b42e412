"""How near to the level set the trilinear cell is drawn, and at how many triangles.

Run it from anywhere: ``python papers/trilinear/drawing.py``. It writes
reports/papers/trilinear/drawing.md: trilinear cubes with and without points on the level set beside
the asymptotic decider, on seeded fields that anybody can make again. The distance has two sides:
from points of the mesh to the level set, along Newton's steps (an upper bound), and from points of
the level set to the mesh, by libigl. Triangles are counted, and their shapes.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

import numpy as np
from isograde.oracles.halfedges import Surface
from isograde.oracles.self_intersections import self_intersections
from isograde.oracles.shapes import shapes
from isograde.oracles.trilinear_distance import STEPS, distance, value_and_gradient
from isoref import asymptotic_decider, trilinear_cubes
from isoref.fast.sweep import sweep
from isoref.field import Field, Floats
from isoref.mesh import Mesh
from isoref.rule import Rule
from scipy import ndimage

HERE = Path(__file__).parent
SIDE, SEEDS = 16, range(3)
RULES: tuple[Rule, ...] = (
    asymptotic_decider.RULE,
    trilinear_cubes.RULE,
    trilinear_cubes.drawn(5),
    trilinear_cubes.drawn(3),
)
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
        "(`smooth_noise`, `white_noise` there). `trilinear-cubes-5` has a point on the level set "
        "in each polygon of more than five sides, `-3` in each of more than three (Lopes and "
        "Brodlie's way). Grosso's TMC is in no registry and not measured here.",
        "",
        "| field | rule | to the level set | to the mesh | triangles | more | median least angle "
        "| below 5 degrees | crossings |",
        "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    nearer: list[bool] = []
    for name, make in FIELDS.items():
        rows = {rule.name: measured(rule, make) for rule in RULES}
        plain = rows[trilinear_cubes.RULE.name]
        for rule, row in rows.items():
            more = row[2] / plain[2] - 1
            lines.append(
                f"| {name} | {rule} | {row[0]:.4f} | {row[1]:.4f} | {row[2]:,.0f} | {more:+.0%} "
                f"| {row[3]:.1f}° | {row[4]:.1%} | {row[5]:.0f} |"
            )
        five, three = (rows[rule.name] for rule in RULES[2:])
        nearer += [five[i] < plain[i] and three[i] < five[i] for i in (0, 1)]
    lines += [
        "",
        f"More points are nearer in {sum(nearer)} of {len(nearer)} comparisons (`-5` below the "
        "plain tiles and `-3` below `-5`).",
    ]
    return "\n".join(lines) + "\n"


def measured(rule: Rule, make: Callable[[int], Floats]) -> Floats:
    """(6,) both distances, triangles, median least angle, share of thin ones, crossings."""
    rows = []
    for seed in SEEDS:
        values = make(seed)
        mesh = sweep(rule, Field.of(values), 0.0)
        of_triangles = shapes(Surface.of(mesh.vertices, mesh.simplices))
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
