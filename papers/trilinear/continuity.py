"""How far the mesh moves as the isovalue passes the end of a tunnel.

Run it from anywhere: ``python papers/trilinear/continuity.py``. It writes
reports/papers/trilinear/continuity.md. In random cells with a saddle inside, the isovalue is put a
little to either side of the saddle's value, where a tunnel begins or ends, and the distance between
both meshes of the cell is taken (Hausdorff's, from points on their triangles, by libigl). The level
set itself moves by about the square root of the step there. Beside it stands the other end of a
tunnel, where the isovalue passes the saddle of a face: there any straight line on the face jumps.
"""

from __future__ import annotations

import argparse
from itertools import pairwise
from pathlib import Path

import igl
import numpy as np
from isograde.oracles.self_intersections import self_intersections
from isoref import asymptotic_decider, trilinear_cubes
from isoref.fast.sweep import sweep
from isoref.field import Field, Floats
from isoref.mesh import Mesh
from isoref.rule import Rule

HERE = Path(__file__).parent
EVENTS, STEPS = 100, (1e-2, 1e-4, 1e-6)
RULES: tuple[Rule, ...] = (
    asymptotic_decider.RULE,
    trilinear_cubes.RULE,
    trilinear_cubes.drawn(5),
    trilinear_cubes.drawn(3),
    trilinear_cubes.CONTINUOUS,
)
HEADS = " | ".join(f"step {step:g}: median, 99 %" for step in STEPS)
# Points of a triangle: corners, middles and thirds.
WEIGHTS = np.array([[i, j, 6 - i - j] for i in range(7) for j in range(7 - i)]) / 6


def events(number: int, seed: int = 0) -> list[tuple[Floats, float]]:
    """Random cells (2, 2, 2), each with the isovalue at which a tunnel of it ends at a saddle."""
    random = np.random.default_rng(seed)
    found: list[tuple[Floats, float]] = []
    while len(found) < number:
        cells = random.uniform(-1, 1, size=(8, 4000))
        axis = trilinear_cubes.Axis.of(cells)
        for side in (1, -1):
            saddle = axis.centre + side * axis.step
            inside = ((saddle > 0) & (saddle < 1)).all(axis=1)
            level = np.full(cells.shape[1], np.nan)
            places = saddle[inside]
            level[inside] = trilinear_cubes.interpolate(cells[:, inside], places)
            # Keep those that have a tunnel on the far side of the saddle's value.
            beyond = np.where(inside, level + side * 1e-4, 0)
            there = inside & trilinear_cubes.tunnels(cells - beyond)[0]
            found += [
                (cells[:, n].reshape(2, 2, 2), float(level[n])) for n in np.flatnonzero(there)
            ]
    return found[:number]


def face_events(number: int, seed: int = 1) -> list[tuple[Floats, float]]:
    """Random cells, and for each the isovalue of a saddle on a face at which its tunnel ends."""
    random = np.random.default_rng(seed)
    found: list[tuple[Floats, float]] = []
    while len(found) < number:
        cells = random.uniform(-1, 1, size=(8, 4000))
        for n in np.flatnonzero(trilinear_cubes.tunnels(cells)[0]):
            g = cells[:, n].reshape(2, 2, 2)
            levels = [
                (f[0, 0] * f[1, 1] - f[0, 1] * f[1, 0]) / (f[0, 0] + f[1, 1] - f[0, 1] - f[1, 0])
                for axis in range(3)
                for f in (g.take(0, axis=axis), g.take(1, axis=axis))
            ]
            for level in levels:
                near = np.repeat(cells[:, [n]], 2, axis=1) - level - np.array([1e-7, -1e-7])
                if trilinear_cubes.tunnels(near)[0].any() > trilinear_cubes.tunnels(near)[0].all():
                    found.append((g, float(level)))
    return found[:number]


def apart(one: Mesh, other: Mesh) -> float:
    """The Hausdorff distance of two meshes, from points on triangles; infinite for no mesh."""
    if not (len(one.simplices) and len(other.simplices)):
        return float("inf")
    return max(_farthest(one, other), _farthest(other, one))


def _farthest(one: Mesh, other: Mesh) -> float:
    """The largest distance of points on one mesh from the other."""
    points = np.einsum("pk,fkd->pfd", WEIGHTS, one.vertices[one.simplices]).reshape(-1, 3)
    squared = igl.point_mesh_squared_distance(points, other.vertices, other.simplices)[0]
    return float(np.sqrt(squared.max()))


def jumps(rule: Rule, found: list[tuple[Floats, float]], step: float) -> Floats:
    """(N,) how far the mesh moves from `step` below each level to `step` above it."""
    moved = []
    for values, level in found:
        field = Field.of(values)
        moved.append(apart(*(sweep(rule, field, level + way * step) for way in (-1, 1))))
    return np.array(moved)


# --- the face alone ------------------------------------------------------------------------------


def face_jumps(number: int, seed: int = 2) -> tuple[Floats, Floats, Floats]:
    """On random faces at their saddle's value, in sides of the face.

    (N,) how far a mesh that held the lines of both sides of the event would be off the level set;
    (steps, N) how far straight lines move, and lines with a vertex where their arc is nearest to
    the saddle.
    """
    random, off = np.random.default_rng(seed), []
    straight: list[list[float]] = []
    bent: list[list[float]] = []
    while len(off) < number:
        g = random.uniform(-1, 1, size=(2, 2))
        D = g[0, 0] + g[1, 1] - g[0, 1] - g[1, 0]
        S, T = (g[0, 0] - g[0, 1]) / D, (g[0, 0] - g[1, 0]) / D
        if not (0.1 < S < 0.9 and 0.1 < T < 0.9):
            continue
        # At the event the crossings are the ends of the asymptotes; a side of their quadrilateral
        # cuts a corner a, b off, and is ab / (a + b) from the nearer asymptote at most.
        off.append(max(a * b / (a + b) for a in (S, 1 - S) for b in (T, 1 - T)))
        at = S, T, abs(D)
        straight.append([_apart(_lines(at, -d, False), _lines(at, d, False)) for d in STEPS])
        bent.append([_apart(_lines(at, -d, True), _lines(at, d, True)) for d in STEPS])
    return np.array(off), np.array(straight).T, np.array(bent).T


def _lines(at: tuple[float, float, float], c: float, bend: bool) -> Floats:
    """(P, 2) points of the lines of (x - S)(y - T) = c / D, straight or bent at its vertices."""
    S, T, D = at
    c /= D
    t = np.linspace(0, 1, 200)[:, None]
    lines = []
    for way in (1, -1):
        # The arc on the side x > S, or x < S: it leaves the face through two of its sides.
        x_end = 1.0 if way > 0 else 0.0
        y_end = (1.0 if way > 0 else 0.0) if c > 0 else (0.0 if way > 0 else 1.0)
        ends = np.array([[x_end, T + c / (x_end - S)], [S + c / (y_end - T), y_end]])
        root = np.sqrt(abs(c))
        middle = np.array([S + way * root, T + np.sign(c) * way * root])
        corners = [ends[0], middle, ends[1]] if bend else [ends[0], ends[1]]
        for a, b in pairwise(corners):
            lines.append(a + t * (b - a))
    return np.concatenate(lines)


def _apart(one: Floats, other: Floats) -> float:
    """Hausdorff's distance of two sets of points."""
    gaps = np.linalg.norm(one[:, None] - other[None], axis=2)
    return float(max(gaps.min(axis=0).max(), gaps.min(axis=1).max()))


def crossings(rule: Rule, seeds: range, side: int = 12) -> tuple[int, int]:
    """Pairs of triangles that cross in white noise, and how many triangles there are."""
    crossed = triangles = 0
    for seed in seeds:
        values = np.random.default_rng(seed).normal(size=(side,) * 3)
        mesh = sweep(rule, Field.of(values), 0.0)
        crossed += len(self_intersections(mesh.vertices, mesh.simplices))
        triangles += len(mesh.simplices)
    return crossed, triangles


def report(number: int) -> str:
    """The tables and what follows from them."""
    lines = [
        "# The mesh as the isovalue passes the end of a tunnel",
        "",
        f"Made by `papers/trilinear/continuity.py`: {number} random cells (corner values uniform "
        "in -1 .. 1), each at the value of a saddle inside it where a tunnel ends; how far the "
        "mesh of the cell moves, in sides of the cell, from a step below that value to a step "
        "above it. The level set moves by about the root of the step: a hundredth of the step, a "
        "tenth of the way. (The asymptotic decider draws no tunnels, so none ends.)",
        "",
        f"| rule | {HEADS} | triangles | crossings |",
        "| --- |" + " ---: |" * (len(STEPS) + 2),
    ]
    cells = events(number)
    medians: dict[str, Floats] = {}
    for rule in RULES:
        moved = [jumps(rule, cells, step) for step in STEPS]
        medians[rule.name] = np.array([np.median(m) for m in moved])
        told = " | ".join(f"{np.median(m):.4f}, {np.quantile(m, 0.99):.4f}" for m in moved)
        crossed, triangles = crossings(rule, range(3))
        lines.append(f"| {rule.name} | {told} | {triangles:,} | {crossed} |")
    lines += [
        "",
        "Triangles and crossings are those of three fields of 12^3 samples of white noise. "
        + conclusion(medians),
        "",
        "## The other end: a saddle on a face",
        "",
        f"| rule | {HEADS} |",
        "| --- |" + " ---: |" * len(STEPS),
    ]
    ends = face_events(number)
    for rule in RULES:
        moved = [jumps(rule, ends, step) for step in STEPS]
        told = " | ".join(f"{np.median(m):.4f}, {np.quantile(m, 0.99):.4f}" for m in moved)
        lines.append(f"| {rule.name} | {told} |")
    off, straight, bent = face_jumps(number)
    lines += [
        "",
        "A mesh whose vertices stand on lattice edges and inside cells meets such a face in two "
        "straight lines between its four crossings: one pair of opposite sides of their "
        "quadrilateral on one side of the event, the other pair on the other. If it moved "
        "continuously it would hold all four sides at the event. The level set is the "
        "quadrilateral's diagonals there, and holds but the corners: such a mesh is off it by a "
        f"median of {np.median(off):.2f} of the face's side, {np.quantile(off, 0.99):.2f} at most "
        "in 99 of 100, whatever stands inside the cells. So no table per cell whose vertices are "
        "on edges and inside cells is both continuous there and on the level set; it takes a "
        "vertex on the face, which both cells share. On the face alone, what that would bring:",
        "",
        f"| lines on {number} random faces | {HEADS} |",
        "| --- |" + " ---: |" * len(STEPS),
    ]
    for name, moves in (("straight", straight), ("with a vertex on the arc", bent)):
        told = " | ".join(f"{np.median(m):.4f}, {np.quantile(m, 0.99):.4f}" for m in moves)
        lines.append(f"| {name} | {told} |")
    lines.append("")
    return "\n".join(lines)


def conclusion(medians: dict[str, Floats]) -> str:
    """How the median jumps of each rule fall with the step, which falls by `STEPS`."""
    plain = medians[trilinear_cubes.RULE.name]
    ways = (STEPS[-1] / STEPS[0]) ** 0.5
    shrinks = [name for name, m in medians.items() if m[-1] <= ways * m[0]]
    return (
        f"The plain rule's median jump goes from {plain[0]:.2f} to {plain[-1]:.2f} of a cell's "
        f"side as the step goes from {STEPS[0]:g} to {STEPS[-1]:g}. Rules whose median jump "
        f"shrinks as fast as the root of the step, or faster: {', '.join(shrinks) or 'none'}."
    )


def main() -> None:
    """The report, in reports/papers of this repository or in --out."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE.parents[1] / "reports" / "papers")
    parser.add_argument("--events", type=int, default=EVENTS, help="cells of each kind")
    options = parser.parse_args()
    path = options.out / "trilinear" / "continuity.md"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(report(options.events), encoding="utf-8")
    print(f"wrote {path}")


if __name__ == "__main__":
    main()
