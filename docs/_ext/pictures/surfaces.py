"""Pictures of the algorithms for surfaces."""

from __future__ import annotations

import numpy as np
from isoref import METHODS, Field, extract
from isoref.asymptotic_decider import saddle
from isoref.capping import capped
from isoref.cube import CORNERS, configuration
from isoref.cycles import cycles
from isoref.field import Floats
from isoref.trilinear_cubes import interpolate

from pictures import Picture, beside
from pictures.drawing import (
    BLUE,
    INK,
    RED,
    SAND,
    bare,
    corners,
    flat,
    lines,
    open_edges,
    panels,
    surface,
    wire,
)


def cell_of(signs: int) -> Floats:
    """(2, 2, 2) samples of one cell: 1 inside, -1 outside."""
    values = np.full((2, 2, 2), -1.0)
    for c, place in enumerate(CORNERS):
        if signs >> c & 1:
            values[tuple(place)] = 1.0
    return values


@beside("isoref.cube", "configuration")
def fifteen() -> Picture:
    """One cell of each configuration."""
    numbers = [configuration(s) for s in range(256)]
    first = [
        min((s for s in range(256) if numbers[s] == n), key=lambda s: (bin(s).count("1"), s))
        for n in range(15)
    ]
    figure, axes = panels(15, 1.5, 1.7, rows=3)
    for n, (axis, signs) in enumerate(zip(axes, first, strict=True)):
        values = cell_of(signs)
        surface(axis, METHODS["asymptotic-decider"](Field.of(values), 0.0), alpha=0.9)
        wire(axis)
        corners(axis, values, 14)
        bare(axis, (0, 0, 0), (1, 1, 1), f"{n}: {numbers.count(n)} of 256")
    return Picture(
        figure,
        f"One cell of each of the {len(set(numbers))} configurations, and how many of the 256 "
        "patterns of corners belong "
        "to it. Full dots are inside.",
    )


HOLE = -np.ones((3, 2, 2))
HOLE[1, 0, 0] = HOLE[1, 1, 1] = HOLE[0, 0, 0] = 1
HOLE[2] = 1


@beside("isoref.lorensen_cline")
def hole() -> Picture:
    """The hole of 1987, and the same cells by the decider."""
    figure, axes = panels(2, 4, 3)
    torn = []
    for axis, name in zip(axes, ("lorensen-cline", "asymptotic-decider"), strict=True):
        mesh = METHODS[name](Field.of(HOLE), 0.0)
        inner = [e for e in open_edges(mesh) if np.all(e[:, 0] == 1)]
        torn.append(len(inner))
        surface(axis, mesh, alpha=0.9)
        lines(axis, inner, RED, 3)
        wire(axis)
        wire(axis, (1, 0, 0))
        corners(axis, HOLE)
        bare(axis, (0, 0, 0), (2, 1, 1), name)
    return Picture(
        figure,
        "Two cells with an ambiguous face between them. On the left the drawings of 1987 leave "
        f"{torn[0]} open edges, in "
        f"red; on the right the face decides, and {torn[1]} are left.",
    )


@beside("isoref.cycles", "cycles")
def separated_and_joined() -> Picture:
    """The polygons of one pattern of signs under both decisions."""
    signs = 0b00001001
    figure, axes = panels(2, 2.8, 2.8)
    told = []
    values = cell_of(signs)
    middles = {e: np.mean([CORNERS[a], CORNERS[b]], axis=0) for e, (a, b) in enumerate(_edges())}
    for axis, decisions in zip(axes, (63, 0), strict=True):
        polygons = cycles(signs, decisions)
        told.append([len(p) for p in polygons])
        for polygon, color in zip(polygons, (BLUE, SAND), strict=False):
            points = np.array([middles[e] for e in (*polygon, polygon[0])])
            lines(axis, [points], color, 3)
        wire(axis)
        corners(axis, values)
        bare(axis, (0, 0, 0), (1, 1, 1), "separated" if decisions else "joined")
    sides = " and ".join(str(n) for n in told[0])
    return Picture(
        figure,
        f"The same inside corners on one face diagonal: separated, the cycles have {sides} "
        "sides; joined, one cycle has "
        f"{told[1][0]}.",
    )


def _edges() -> list[tuple[int, int]]:
    from isoref.cube import EDGES

    return [(int(a), int(b)) for a, b in EDGES]


@beside("isoref.asymptotic_decider", "separated")
def hyperbolas() -> Picture:
    """The bilinear interpolant of a face as one corner rises."""
    s, t = np.meshgrid(np.linspace(0, 1, 161), np.linspace(0, 1, 161), indexing="ij")
    figure, axes = panels(4, 2.2, 2.4, space=False)
    words = []
    for axis, high in zip(axes, (0.5, 0.9, 1.2, 2.5), strict=True):
        a, b, c, d = 1.0, -1.0, high, -1.0
        values = a * (1 - s) * (1 - t) + b * s * (1 - t) + c * s * t + d * (1 - s) * t
        axis.contourf(s, t, values, [-9, 0, 9], colors=["#ffffff", "#cfe2f0"])
        axis.contour(s, t, values, [0], colors=BLUE, linewidths=2.2)
        S, T, at = (float(x) for x in saddle(*np.array([a, b, c, d])))
        axis.axvline(S, color="#9aa5ae", linestyle="--", linewidth=0.9)
        axis.axhline(T, color="#9aa5ae", linestyle="--", linewidth=0.9)
        axis.plot(S, T, "+", color=RED, markersize=11, markeredgewidth=2)
        for x, y, value in ((0, 0, a), (1, 0, b), (1, 1, c), (0, 1, d)):
            axis.plot(
                x,
                y,
                "o",
                color=INK if value >= 0 else "white",
                markeredgecolor=INK,
                clip_on=False,
                zorder=3,
            )
        words.append("joined" if at >= 0 else "separated")
        flat(axis, f"saddle {at:+.2f}: {words[-1]}")
        axis.set(xlim=(-0.04, 1.04), ylim=(-0.04, 1.04))
    turns = words.index("joined")
    return Picture(
        figure,
        "One corner of a face rises from picture to picture. In the "
        f"{('first', 'second', 'third', 'fourth')[turns]} the "
        "saddle (red) has come inside, and the inside corners are joined. Dashed are the "
        "asymptotes.",
    )


@beside("isoref.trilinear_cubes")
def tunnel() -> Picture:
    """A tunnel by the decider, by the module, and as the level set itself."""
    values = np.full((2, 2, 2), -1.0)
    values[0, 0, 0] = values[1, 1, 1] = 4.0
    count = 33
    side = np.linspace(0, 1, count)
    points = np.stack(np.meshgrid(side, side, side, indexing="ij")).reshape(3, -1)
    fine = interpolate(_by_corner(values)[:, None], points.T[:, None, :]).reshape(
        count, count, count
    )
    figure, axes = panels(3, 2.6, 2.8)
    euler = []
    meshes = [METHODS[n](Field.of(values), 0.0) for n in ("asymptotic-decider", "trilinear-cubes")]
    meshes.append(METHODS["trilinear-cubes"](Field.of(fine, 1 / (count - 1)), 0.0))
    for axis, mesh, title in zip(
        axes, meshes, ("asymptotic decider", "trilinear cubes", "the level set"), strict=True
    ):
        halves = {frozenset((t[i], t[i - 1])) for t in mesh.simplices.tolist() for i in range(3)}
        euler.append(len(mesh.vertices) - len(halves) + len(mesh.simplices))
        surface(axis, mesh, edges=INK if len(mesh.simplices) < 99 else None)
        wire(axis)
        corners(axis, values)
        bare(axis, (0, 0, 0), (1, 1, 1), title, view=(16, -28))
    return Picture(
        figure,
        "Two opposite corners are high. No face is ambiguous, so the decider draws two caps "
        "(Euler characteristic "
        f"{euler[0]}). The interpolant's own level set, here drawn from {count - 1}³ small "
        f"cells, is a tunnel ({euler[2]}), "
        f"and so is what this module draws ({euler[1]}).",
    )


def _by_corner(values: Floats) -> Floats:
    return np.array([values[tuple(place)] for place in CORNERS])


@beside("isoref.diagonals")
def smooth_diagonals() -> Picture:
    """A cylinder whose quadrilaterals are cut both ways."""
    from isoref.asymptotic_decider import RULE
    from isoref.diagonals import extract as with_diagonals

    i, j, k = np.meshgrid(*[np.arange(9.0)] * 3, indexing="ij")
    field = Field.of(3.1 - np.hypot(i - 4 + 0.35 * (k - 4), j - 4 - 0.2 * (k - 4)))
    figure, axes = panels(2, 3, 3)
    plain = METHODS["asymptotic-decider"](field, 0.0)
    smooth = with_diagonals(RULE, field, 0.0)
    for axis, mesh, title in (
        (axes[0], plain, "as the tiles have them"),
        (axes[1], smooth, "chosen by smoothness"),
    ):
        surface(axis, mesh, SAND)
        bare(axis, (0, 0, 0), (8, 8, 8), title)
    changed = len(
        {frozenset(t) for t in plain.simplices.tolist()}
        - {frozenset(t) for t in smooth.simplices.tolist()}
    )
    return Picture(
        figure,
        f"A leaning cylinder: {changed} of {len(plain.simplices)} triangles are cut otherwise.",
    )


@beside("isoref.capping")
def open_and_capped() -> Picture:
    """A ball that the border cuts, open and capped."""
    i, j, k = np.meshgrid(*[np.arange(12.0)] * 3, indexing="ij")
    field = Field.of(5.2 - np.sqrt((i - 8) ** 2 + (j - 5.5) ** 2 + (k - 7) ** 2))
    figure, axes = panels(2, 3, 3)
    numbers = []
    method = METHODS["asymptotic-decider"]
    for axis, mesh, title in (
        (axes[0], method(field, 0.0), "open"),
        (axes[1], capped(method, field, 0.0), "capped"),
    ):
        rim = open_edges(mesh)
        numbers.append(len(rim))
        surface(axis, mesh)
        lines(axis, rim, RED, 2)
        bare(axis, (2, 0, 1), (11.5, 11, 11.5), title, view=(24, 28))
    return Picture(
        figure,
        f"A ball that reaches over the border: open it has {numbers[0]} open edges, capped "
        f"{numbers[1]}.",
    )


@beside("isoref.attributes", "normals")
def by_normals() -> Picture:
    """A surface coloured by its normals."""
    from isoref.attributes import normals

    x, y, z = np.meshgrid(*[np.linspace(-np.pi, np.pi, 26)] * 3, indexing="ij")
    values = np.cos(x) * np.sin(y) + np.cos(y) * np.sin(z) + np.cos(z) * np.sin(x)
    mesh = extract(values, 0.0, method="trilinear-cubes", provenance=True)
    colors = (normals(mesh)[mesh.simplices].mean(axis=1) + 1) / 2
    figure, axes = panels(1, 4, 4)
    surface(axes[0], mesh, [tuple(c) for c in np.clip(colors, 0, 1)], edges=None)
    bare(axes[0], (0, 0, 0), (25, 25, 25))
    return Picture(
        figure,
        f"A gyroid of {len(mesh.simplices):,} triangles, its colours the components of the "
        "normals.",
    )
