"""Pictures of what every algorithm rests on: fields, meshes, rules, the sweep, the catalogue."""

from __future__ import annotations

from typing import Any

import numpy as np
from isoref import METHODS, Field, Mesh
from isoref.cube import ambiguous_faces
from isoref.curves import follow
from isoref.field import Floats
from isoref.marching_faces import intersection_curves
from isoref.methods import RULES

from pictures import Picture, beside
from pictures.drawing import BLUE, INK, RED, SAND, bare, corners, flat, lines, panels, surface, wire
from pictures.surfaces import cell_of


@beside("isoref.field")
def straight_and_tilted() -> Picture:
    """One array as a straight field and as one whose second axis leans."""
    values = np.add.outer(np.arange(4.0), 0.6 * np.arange(5.0))
    lean = np.deg2rad(62)
    fields = (
        Field.of(values, (1.0, 0.7), (0.5, 0.4)),
        Field.of(values, (1.0, 0.7), (0.5, 0.4), directions=[[1, 0], [np.cos(lean), np.sin(lean)]]),
    )
    figure, axes = panels(2, 3.6, 2.7, space=False)
    index, shown = (2, 3), []
    for axis, field, title in zip(axes, fields, ("straight", "tilted"), strict=True):
        places = np.array([field.position(at) for at in np.ndindex(values.shape)])
        grid = places.reshape(*values.shape, 2)
        for row in (*grid, *grid.swapaxes(0, 1)):
            axis.plot(*row.T, color="#b8c2ca", linewidth=0.8, zorder=0)
        inside = values.ravel() >= 2.5
        for chosen, color in ((inside, INK), (~inside, "white")):
            axis.scatter(*places[chosen].T, s=26, c=color, edgecolor=INK, zorder=2)
        _arrow(axis, grid[0, 0], grid[1, 0], "axis 0")
        _arrow(axis, grid[0, 0], grid[0, 1], "axis 1")
        place = field.position(index)
        shown.append(", ".join(f"{x:.2f}" for x in place))
        axis.scatter(*place, s=90, facecolor="none", edgecolor=RED, linewidth=2, zorder=3)
        flat(axis, f"{title}: index {index} at ({shown[-1]})")
        axis.set(xlim=(-0.1, 5.2), ylim=(0, 3.6))
    return Picture(
        figure,
        f"The same {values.shape[0]} by {values.shape[1]} samples, full where they are at least "
        f"2.5, with the same origin and spacing. The ringed sample stands at ({shown[0]}), and at "
        f"({shown[1]}) where the second axis leans.",
    )


def _arrow(axis: Any, a: Floats, b: Floats, word: str) -> None:
    """An arrow with a word at its head."""
    axis.annotate("", b, a, arrowprops={"arrowstyle": "-|>", "color": BLUE, "lw": 2})
    axis.annotate(word, b, (-4, 7), textcoords="offset points", fontsize=7, color=BLUE, ha="right")


@beside("isoref.mesh")
def shared_vertices() -> Picture:
    """A closed mesh with the numbers of its vertices, and the arrows of its normals."""
    values = np.full((3, 3, 3), -1.0)
    values[1, 1, 1] = 2.0
    mesh = METHODS["lorensen-cline"](Field.of(values), 0.0)
    figure, axes = panels(1, 4.4, 3.6)
    surface(axes[0], mesh, alpha=0.6, width=1)
    a, b, c = np.moveaxis(mesh.vertices[mesh.simplices], 1, 0)
    normals = np.cross(b - a, c - a)
    normals = 0.32 * normals / np.linalg.norm(normals, axis=1, keepdims=True)
    axes[0].computed_zorder = False
    axes[0].quiver(*((a + b + c) / 3).T, *normals.T, color=RED, linewidth=1.4)
    for n, place in enumerate(mesh.vertices):
        axes[0].text(
            *(place + 0.2 * (place - 1)), str(n), fontsize=11, ha="center", va="center", zorder=9
        )
    bare(axes[0], (0.3,) * 3, (1.7,) * 3, view=(24, -62))
    rows = ", ".join("(" + " ".join(map(str, row)) + ")" for row in mesh.simplices.tolist())
    corner_count = mesh.simplices.size
    return Picture(
        figure,
        f"The surface round one sample: {len(mesh.vertices)} vertices with their numbers, and "
        f"{len(mesh.simplices)} triangles, the rows {rows}. {corner_count} corners share the "
        "vertices, and the right-hand normals (red) point outside.",
    )


@beside("isoref.rule", "Rule")
def tiles_of_one_pattern() -> Picture:
    """All the tiles of one pattern of signs."""
    rule, signs = RULES["asymptotic-decider"], 0b10010010
    asked = ambiguous_faces(signs)
    values = cell_of(signs)
    middles = _middles()
    choices = [
        sum(1 << face for n, face in enumerate(asked) if choice >> n & 1)
        for choice in range(1 << len(asked))
    ]
    figure, axes = panels(len(choices), 1.9, 2.1, rows=2)
    numbers = []
    for axis, decisions in zip(axes, choices, strict=True):
        tile = rule.tile(signs, decisions)
        inner = [place(values.reshape(8, 1), middles[:, None])[0] for place in tile.interior]
        places = np.array([*middles, *inner])
        numbers.append(len(tile.triangles))
        surface(axis, Mesh.of(places, list(tile.triangles)), alpha=0.9, width=0.7)
        wire(axis)
        corners(axis, values, 12)
        apart = [str(f) for f in asked if decisions >> f & 1]
        title = f"separated: {' '.join(apart) or 'none'}\n{numbers[-1]} triangles"
        bare(axis, (0, 0, 0), (1, 1, 1), title)
    return Picture(
        figure,
        f"One pattern of signs with {len(asked)} ambiguous faces ({', '.join(map(str, asked))}), "
        f"hence {len(choices)} decisions, and the tile of each: {min(numbers)} to {max(numbers)} "
        "triangles. A cell's numbers enter into the decisions and into where points stand, and "
        "never into a tile.",
    )


def _middles() -> Floats:
    """(12, 3) the middles of a cell's edges."""
    from isoref.cube import CORNERS, EDGES

    return np.array([np.mean([CORNERS[a], CORNERS[b]], axis=0) for a, b in EDGES])


@beside("isoref.sweep", "sweep")
def cell_by_cell() -> Picture:
    """The tiles of a ball, moved apart, and the mesh."""
    i, j, k = np.meshgrid(*[np.arange(5.0)] * 3, indexing="ij")
    field = Field.of(1.45 - np.sqrt((i - 2) ** 2 + (j - 1.9) ** 2 + (k - 2.1) ** 2))
    mesh = METHODS["asymptotic-decider"](field, 0.0, provenance=True)
    cells = np.array(np.unravel_index(mesh.traced().cells, field.shape)).T
    figure, axes = panels(2, 3.4, 3.4)
    apart = 0.45
    pieces = mesh.vertices[mesh.simplices] + apart * (cells - 1.5)[:, None]
    surface(axes[0], _loose(pieces), SAND, width=0.7)
    each = np.unique(cells, axis=0)
    bare(axes[0], (-0.5,) * 3, (4.5,) * 3, "cell by cell", view=(24, -52))
    surface(axes[1], mesh, SAND, width=0.7)
    bare(axes[1], (0.3,) * 3, (3.7,) * 3, "vertices named by their edges", view=(24, -52))
    return Picture(
        figure,
        f"{len(each)} of {int(np.prod(np.array(field.shape) - 1))} cells have triangles. Their "
        f"{len(mesh.simplices)} triangles have {3 * len(mesh.simplices)} corners, and these are "
        f"{len(mesh.vertices)} vertices: each lattice edge that is crossed names one.",
    )


def _loose(triangles: Floats) -> Mesh:
    """Triangles that share nothing."""
    return Mesh.of(triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3))


@beside("isoref.methods")
def catalogue() -> Picture:
    """The same samples by every method."""
    from scipy.ndimage import gaussian_filter

    noise = gaussian_filter(np.random.default_rng(12).normal(size=(7, 7, 7)), 0.75)
    noise[[0, -1]] = noise[:, [0, -1]] = noise[:, :, [0, -1]] = noise.min()
    field = Field.of(noise)
    level = float(np.quantile(noise, 0.86))
    figure, axes = panels(len(METHODS), 1.75, 2.0, rows=-(-len(METHODS) // 7))
    counts = {}
    for axis, (name, method) in zip(axes, METHODS.items(), strict=True):
        mesh = method(field, level)
        counts[name] = len(mesh.simplices)
        surface(axis, mesh, SAND if name in ("surface-nets", "dual-marching-cubes") else BLUE)
        bare(axis, (0.6,) * 3, (5.4,) * 3, f"{name}\n{counts[name]}", view=(24, -52))
        axis.title.set_fontsize(7.5)
    few, many = min(counts, key=lambda n: counts[n]), max(counts, key=lambda n: counts[n])
    return Picture(
        figure,
        f"One field of {field.shape[0]}³ samples by all {len(METHODS)} methods, with the number "
        f"of triangles: {few} makes {counts[few]}, {many} {counts[many]}.",
    )


@beside("isoref.curves", "follow")
def segments_followed() -> Picture:
    """Segments in any order, and the curves that they are."""
    n = 17
    x, y, z = np.meshgrid(*[np.linspace(-1.3, 1.3, n)] * 3, indexing="ij")
    first = Field.of(np.cos(4.9 * x) + np.cos(4.9 * y) + np.cos(4.9 * z) - 1.1)
    second = Field.of(z - 0.25 * x + 0.3 * x * y)
    found = intersection_curves(first, second)
    pieces = [
        np.stack([c.polyline[:-1], c.polyline[1:]], axis=1) for c in found if len(c.points) > 1
    ]
    loose = np.concatenate(pieces)[np.random.default_rng(1).permutation(sum(map(len, pieces)))]
    # The segment that begins where this one ends.
    starts = {tuple(a): i for i, (a, _) in enumerate(loose.tolist())}
    after = np.array([starts.get(tuple(b), -1) for _, b in loose.tolist()])
    chains = follow(after)
    figure, axes = panels(2, 3.4, 3)
    palette = (
        BLUE,
        RED,
        SAND,
        "#6aa56a",
        "#8d6fb0",
        "#4d5b66",
        "#c98ab0",
        "#59b3b3",
        "#b9b26b",
        "#777f86",
    )
    for number, piece in enumerate(loose):
        lines(axes[0], [piece], palette[number * 3 % len(palette)], 2)
    for number, (chain, _) in enumerate(chains):
        lines(axes[1], list(loose[chain]), palette[number % len(palette)], 2)
    for axis, title in zip(axes, (f"{len(loose)} segments", f"{len(chains)} curves"), strict=True):
        bare(axis, (1, 1, 4), (n - 2, n - 2, n - 5), title, view=(50, -60))
    closed = sum(one for _, one in chains)
    return Picture(
        figure,
        f"{len(loose)} segments in no order, each of which knows which one begins where it ends: "
        f"{len(chains) - closed} chains that end on the border, and {closed} "
        f"{'cycle' if closed == 1 else 'cycles'}.",
    )
