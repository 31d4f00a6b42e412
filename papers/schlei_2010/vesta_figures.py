"""Pictures of cells, cycles and surfaces, drawn after the figures of the paper.

Cells are drawn by lines, in an oblique view; large surfaces as shaded points, nearest first.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import matplotlib
import numpy as np
from isoref.cube import CORNERS, EDGES, REPRESENTATIVES, ambiguous_faces, axis_of, inside
from isoref.field import Floats
from isoref.marching_vesta import CENTRES, JUNCTURES, cell_paths, cycles, tile
from isoref.mesh import Mesh
from isoref.sweep import cell_crossings

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.collections import PolyCollection
from vesta_census import attainable, kind
from vesta_counts import all_signatures

COLOURS = ("#4878a8", "#d1813b", "#5b9a5b", "#a85c72", "#7b6ba8", "#8c8c3a")

#: Boundary faces by the axis they are perpendicular to.
TONES = ("#d3d8e0", "#b7bfcb", "#e8ebef")

AZIMUTH, ELEVATION = np.radians([24, 20])
#: The picture's right and up, and the direction to the eye: from the front, right and above.
RIGHT = np.array([np.cos(AZIMUTH), np.sin(AZIMUTH), 0])
EYE = np.array([np.sin(AZIMUTH), -np.cos(AZIMUTH), 0]) * np.cos(ELEVATION)
EYE[2] = np.sin(ELEVATION)
UP = np.cross(EYE, RIGHT)

plt.rcParams.update({"svg.hashsalt": "schlei-2010", "font.size": 7, "svg.fonttype": "path"})


def flat(points: Floats) -> Floats:
    """(.., 2) places in the picture."""
    return np.asarray(points, float) @ np.stack([RIGHT, UP]).T


def depth(points: Floats) -> Floats:
    """How near to the eye points are."""
    return np.asarray(points, float) @ EYE


def draw_box(ax, origin=(0, 0, 0)) -> None:
    """The edges of a cell, those behind it dotted."""
    corners = np.array(CORNERS) + origin
    hidden = int(depth(corners).argmin())
    for a, b in EDGES:
        x, y = flat(corners[[a, b]]).T
        style = ":" if hidden in (a, b) else "-"
        ax.plot(x, y, style, color="0.55", lw=0.7, zorder=0 if hidden in (a, b) else 3)


def draw_sites(ax, signs: int) -> None:
    """A dot at each active corner."""
    active = [CORNERS[c] for c in range(8) if inside(signs, c)]
    if active:
        ax.plot(*flat(np.array(active)).T, "o", color="0.15", ms=3.2, zorder=4, clip_on=False)


def draw_triangles(ax, triangles: Floats, colours: Sequence, edge: str = "white") -> None:
    """Triangles (n, 3, 3), farthest first, shaded by their direction."""
    order = depth(triangles.mean(axis=1)).argsort()
    ax.add_collection(
        PolyCollection(
            flat(triangles[order]),
            facecolors=[shaded(triangles[i], colours[i]) for i in order],
            edgecolors=edge,
            linewidths=0.5,
            zorder=1,
        )
    )


def shaded(triangle: Floats, colour: str) -> tuple:
    """The colour, darker the more the triangle turns away."""
    normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
    light = np.array([0.4, 0.6, 0.75])
    share = abs(normal @ light) / (np.linalg.norm(normal) * np.linalg.norm(light))
    base = np.array(matplotlib.colors.to_rgb(colour))
    return (*(base * (0.55 + 0.45 * share)), 0.88)


def draw_cycles(ax, signs: int, separated: int, resolution: str | None) -> None:
    """The cycles of a cell, as outlines, or cut into triangles where a resolution is given."""
    draw_box(ax)
    draw_sites(ax, signs)
    found = cycles(signs, separated)
    if resolution:
        corners, owner = cell_triangles(signs, separated, resolution)
        draw_triangles(ax, corners, [COLOURS[i % len(COLOURS)] for i in owner])
    for i, cycle in enumerate(found):
        loop = CENTRES[[*cycle, cycle[0]]] / 2
        x, y = flat(loop).T
        colour = COLOURS[i % len(COLOURS)]
        ax.plot(x, y, "-", color=colour, lw=1.8, zorder=2, solid_joinstyle="round")
        ax.plot(x, y, "o", color=colour, ms=2.4, zorder=2)
    finish(ax)


def draw_chain(ax, signs: int, cycle: tuple[int, ...], vectors: bool = False) -> None:
    """A cycle with its boundary face chain: unit squares that all have the cell's middle in common.

    Grey discs are the centres of active voxels, thin lines the vectors from face to face. With
    `vectors` these are all there is on the faces, and no voxel is told to be active.
    """
    paths = cell_paths(signs)
    for e in cycle:
        for quarter in face_quarters(e):
            ax.fill(*flat(quarter).T, fc=TONES[axis_of(e)], alpha=0.6, lw=0, **at(quarter))
            ax.plot(*flat(quarter[1:]).T, "-", color="0.5", lw=0.6, **at(quarter[1:], 0.01))
        way = np.array([JUNCTURES[paths[e][0]], CENTRES[e], JUNCTURES[paths[e][2]]]) / 2
        width = 1.8 if vectors else 0.6
        ax.plot(*flat(way).T, "-", color="0.3", lw=width, **at(way, 0.01))
    if not vectors:
        _draw_cycle(ax, signs, cycle)
    for centre in CENTRES[list(cycle)] / 2:
        ax.plot(*flat(centre), "o", color="k", ms=2.6, **at(centre[None], 0.02))
    finish(ax)
    (left, bottom), (right, top) = (
        end(flat(2 * np.array(CORNERS) - 0.5), axis=0) for end in (np.min, np.max)
    )
    ax.set(xlim=(left, right), ylim=(bottom, top))


def _draw_cycle(ax, signs: int, cycle: tuple[int, ...]) -> None:
    """The centres of active voxels, and the lines of the cycle."""
    for site in (np.array(CORNERS[c]) for c in range(8) if inside(signs, c)):
        ax.plot(*flat(site), "o", color="0.6", ms=5, mec="0.4", mew=0.5, **at(site[None]))
    for pair in pairwise([*cycle, cycle[0]]):
        line = CENTRES[list(pair)] / 2
        ax.plot(*flat(line).T, "-", color=COLOURS[0], lw=2, **at(line, 0.01))


def at(points: Floats, before: float = 0.0) -> dict[str, float | bool]:
    """How to draw what lies at these points: the nearer to the eye, the later; never cut off."""
    return {"zorder": 5 + before + float(depth(points).mean()), "clip_on": False}


def face_quarters(e: int) -> Floats:
    """(4, 4, 3) the boundary face round centre e in four squares: centre, side, corner, side."""
    one, other = np.delete(np.eye(3), axis_of(e), axis=0) / 2
    sides = [one, other, -one, -other, one]
    return np.array([[CENTRES[e] / 2 + step for step in (0 * a, a, a + b, b)]
                     for a, b in pairwise(sides)])  # fmt: skip


def cell_triangles(signs: int, separated: int, resolution: str) -> tuple[Floats, list[int]]:
    """Corners (n, 3, 3) of the cell's triangles with unmoved points, and the cycle of each."""
    # The decisions are given; values of one size leave each point in the middle of its edge.
    g = np.where([inside(signs, c) for c in range(8)], 1.0, -1.0)[:, None]
    made = tile(signs, separated, "mixed", resolution)
    crossings = cell_crossings(g)
    places = [*crossings[:, 0], *(place(g, crossings)[0] for place in made.interior)]
    number = {e: i for i, cycle in enumerate(cycles(signs, separated)) for e in cycle}
    owner = [next(number[n] for n in t if n < 12) for t in made.triangles]
    corners = np.array([[places[n] for n in t] for t in made.triangles]).reshape(-1, 3, 3)
    return corners, owner


def finish(ax) -> None:
    """No axes, equal scales."""
    ax.set_aspect("equal")
    ax.axis("off")
    ax.margins(0.03)


def panels(count: int, columns: int, size: float = 1.3):
    """A figure with `count` panels, the axes in reading order."""
    rows = -(-count // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(columns * size, rows * size * 1.12))
    axes = np.atleast_1d(axes).ravel()
    for ax in axes[count:]:
        ax.axis("off")
    return figure, axes[:count]


def save(figure, path: Path) -> Path:
    """The file, the same bytes whenever the picture is the same."""
    path.parent.mkdir(parents=True, exist_ok=True)
    metadata = {"Date": None} if path.suffix == ".svg" else {}
    figure.savefig(path, bbox_inches="tight", pad_inches=0.03, metadata=metadata, dpi=110)
    plt.close(figure)
    return path


def examples() -> list[tuple[tuple[int, ...], int, int]]:
    """(type, signs, separated): for each type the cell with fewest cycles, then fewest corners.

    Among those that are equal, the one that shows the cycle most broadly.
    """
    best: dict[tuple[int, ...], tuple] = {}
    for signs, separated in all_signatures():
        for cycle in cycles(signs, separated):
            reachable = attainable(signs, separated) if len(cycle) > 7 else True
            size = (len(cycles(signs, separated)), signs.bit_count())
            rank = (not reachable, *size, -shown_area(cycle), signs, separated)
            best[kind(cycle)] = min(best.get(kind(cycle), rank), rank)
    order = sorted(best, key=lambda k: (len(k), k))
    return [(k, best[k][-2], best[k][-1]) for k in order]


def shown_area(cycle: tuple[int, ...]) -> float:
    """The area of the cycle's outline in the picture."""
    x, y = flat(CENTRES[list(cycle)]).T
    return round(abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2, 6)


def draw_types(path: Path, resolution: str | None, shortest: int = 3, longest: int = 12) -> Path:
    """The types of cycle, on their boundary faces (Figs. 7, 12) or cut (Figs. 8, 9, 14).

    A star marks what the averages of four voxels never decide.
    """
    shown = [e for e in examples() if shortest <= len(e[0]) <= longest]
    columns = len(shown) if len(shown) < 10 else 8
    figure, axes = panels(len(shown), columns, 1.3 if resolution else 1.6)
    for ax, (wanted, signs, separated) in zip(axes, shown, strict=True):
        if resolution:
            draw_cycles(ax, signs, separated, resolution)
        else:
            draw_chain(ax, signs, next(c for c in cycles(signs, separated) if kind(c) == wanted))
        never = "" if attainable(signs, separated) else " *"
        ax.set_title(f"{len(wanted)}-cycle{never}", pad=2)
    return save(figure, path)


def resolutions() -> list[tuple[int, int, int]]:
    """(configuration, signs, separated): the ways to resolve each ambiguous configuration.

    One for each multiset of cycle types, as in Fig. 13.
    """
    found = []
    for number, corners in enumerate(REPRESENTATIVES):
        signs = sum(1 << c for c in corners)
        seen = set()
        for given, separated in all_signatures():
            if given == signs and ambiguous_faces(signs):
                types = tuple(sorted(kind(c) for c in cycles(signs, separated)))
                if types not in seen:
                    seen.add(types)
                    found.append((number, signs, separated))
    return found


def draw_resolutions(path: Path) -> Path:
    """Every way to resolve a configuration, with the cycles it leaves (Fig. 13)."""
    ways = resolutions()
    figure, axes = panels(len(ways), 8)
    for ax, (number, signs, separated) in zip(axes, ways, strict=True):
        draw_cycles(ax, signs, separated, "H")
        sizes = "+".join(str(len(c)) for c in cycles(signs, separated))
        never = "" if attainable(signs, separated) else " *"
        ax.set_title(f"{number}: {sizes}{never}", pad=2)
    return save(figure, path)


def draw_meshes(path: Path, named: Sequence[tuple[str, Mesh]], cells: Sequence) -> Path:
    """Small meshes side by side, with the boxes of their cells and their open edges in red."""
    figure, axes = panels(len(named), len(named), 2.2)
    for ax, (name, mesh) in zip(axes, named, strict=True):
        for cell in cells:
            draw_box(ax, cell)
        draw_triangles(ax, mesh.vertices[mesh.simplices], [COLOURS[0]] * len(mesh.simplices))
        for a, b in inner_boundary(mesh, np.array(cells)):
            ax.plot(*flat(mesh.vertices[[a, b]]).T, color="#c22", lw=2.2, zorder=5)
        ax.set_title(name, pad=2)
        finish(ax)
    return save(figure, path)


def inner_boundary(mesh: Mesh, cells) -> list[tuple[int, int]]:
    """Edges with one triangle that do not lie on the border of the box of cells."""
    sides = mesh.simplices[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    edges, count = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    low, high = cells.min(axis=0), cells.max(axis=0) + 1
    open_edges = []
    for a, b in edges[count == 1].tolist():
        ends = mesh.vertices[[a, b]]
        on_border = ((ends == low) | (ends == high)).all(axis=0).any()
        if not on_border:
            open_edges.append((a, b))
    return open_edges


def render(mesh: Mesh, right: Floats, up: Floats, width: int = 520, both: bool = False) -> Floats:
    """(h, w) grey levels 0 .. 1 of the mesh seen along up x right, NaN where nothing is.

    Each triangle is sampled closely enough that no pixel between its samples is left out; the
    nearest sample of a pixel is shown, lit from the upper left. A side that faces inwards is not
    shown; with `both` it is, darker.
    """
    corners = mesh.vertices[mesh.simplices]
    frame = np.stack([right, up, np.cross(right, up)]).astype(float)
    frame /= np.linalg.norm(frame, axis=1)[:, None]
    seen = corners @ frame.T
    low, high = seen[..., :2].min(axis=(0, 1)), seen[..., :2].max(axis=(0, 1))
    scale = (width - 1) / (high[0] - low[0])
    seen[..., :2] = (seen[..., :2] - low) * scale
    normals = np.cross(seen[:, 1] - seen[:, 0], seen[:, 2] - seen[:, 0])
    # Leave out what turns its back, or turn it round.
    front = normals[:, 2] > 0
    if both:
        normals = np.where(front[:, None], normals, -normals)
    else:
        seen, normals, front = seen[front], normals[front], front[front]
    light = np.array([-0.6, 0.45, 0.66])
    lit = np.clip(normals @ light / np.maximum(np.linalg.norm(normals, axis=1), 1e-300), 0, 1)
    lit = np.where(front, lit, 0.75 * lit)
    height = int((high[1] - low[1]) * scale) + 1
    image, nearest = np.full((2, height * width), -np.inf)
    spread = np.ptp(seen[..., :2], axis=1).max(axis=1)
    for parts in np.unique(np.ceil(spread / 0.7).astype(int)):
        group = np.ceil(spread / 0.7).astype(int) == parts
        for weights in barycentric(max(int(parts), 1)):
            points = np.einsum("k,nkc->nc", weights, seen[group])
            pixel = points[:, 1].astype(int) * width + points[:, 0].astype(int)
            order = points[:, 2].argsort()
            pixel, z, shade = pixel[order], points[order, 2], lit[group][order]
            # The last write wins: sorted by depth, that is the nearest of this batch.
            top = np.full(len(nearest), -1)
            top[pixel] = np.arange(len(pixel))
            hit = np.flatnonzero(top >= 0)
            better = hit[z[top[hit]] > nearest[hit]]
            nearest[better], image[better] = z[top[better]], shade[top[better]]
    image[np.isinf(image)] = np.nan
    return image.reshape(height, width)[::-1]


def barycentric(parts: int) -> list[Floats]:
    """Weights of the centres of `parts` squared equal pieces of a triangle."""
    if parts == 1:
        return [np.full(3, 1 / 3)]
    steps = [(i, j) for i in range(parts + 1) for j in range(parts + 1 - i)]
    return [np.array([i, j, parts - i - j]) / parts for i, j in steps]


def stretched(image: Floats) -> Floats:
    """The grey levels from 0 to 1, but for a hundredth at either end: for gently bent surfaces."""
    low, high = np.nanpercentile(image, (1, 99))
    return np.clip((image - low) / (high - low), 0, 1)


def draw_views(path: Path, views: Sequence, names: Sequence[str], last) -> Path:
    """Lettered renderings of meshes with their axes beside them, and a panel that `last` draws.

    A view is a mesh, the picture's right, its up, and what is said over it.
    """
    figure, axes = panels(len(views) + 1, len(views) + 1, 2.6)
    for letter, ax, (mesh, right, up, told) in zip("abcdefgh", axes, views, strict=False):
        image = stretched(render(mesh, right, up, 340, both=True))
        shown = matplotlib.colormaps["bone"](0.12 + 0.85 * image)
        shown[np.isnan(image)] = 1
        height, width = image.shape
        ax.imshow(shown, interpolation="nearest", extent=(0, width, 0, height))
        frame = np.stack([np.asarray(one, float) / np.linalg.norm(one) for one in (right, up)])
        corner = np.array([0.02 * width, -0.3 * width])
        for axis, name in enumerate(names):
            tip = corner + 0.26 * width * frame[:, axis]
            style = {"arrowstyle": "-|>", "color": "k", "lw": 0.8, "mutation_scale": 6}
            ax.annotate("", tip, corner, arrowprops=style, annotation_clip=False)
            ax.text(*(corner + 0.33 * width * frame[:, axis]), name, ha="center", va="center")
            ax.plot(*tip, alpha=0)
        ax.set(xlim=(-0.15 * width, 1.05 * width), ylim=(-0.5 * width, 1.05 * height))
        ax.set_title(f"({letter}) {told}", pad=2)
        ax.set_aspect("equal")
        ax.axis("off")
    last(axes[-1])
    axes[-1].set_title(f"({'abcdefgh'[len(views)]}) a 5-cycle and its normals", pad=2)
    return save(figure, path)


def draw_rendering(path: Path, image: Floats) -> Path:
    """The rendering as a small picture."""
    height, width = image.shape
    figure, ax = plt.subplots(figsize=(width / 110, height / 110))
    shown = matplotlib.colormaps["bone"](0.12 + 0.85 * image)
    shown[np.isnan(image)] = 1
    ax.imshow(shown, interpolation="nearest")
    ax.axis("off")
    return save(figure, path)
