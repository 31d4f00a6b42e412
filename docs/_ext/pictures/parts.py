"""Pictures of volumes in parts: blocks and bricks."""

from __future__ import annotations

from typing import Any

import numpy as np
from isoref import Mesh
from isoref.distributed import blocks, piece, start_of, welded
from isoref.fast.bricks import Index, boxes
from isoref.field import Floats
from matplotlib.patches import Rectangle

from pictures import Picture, beside
from pictures.drawing import BLUE, INK, RED, SAND, bare, flat, panels, surface

COLORS = (BLUE, SAND, "#7fb27f", "#a58bc0", "#d0909c", "#6db5b5", "#b9b26b", "#8c9aa6")


def gyroid(n: int) -> Floats:
    """(n, n, n) samples of a ball with a gyroid cut into it."""
    x, y, z = np.meshgrid(*[np.linspace(-3.4, 3.4, n)] * 3, indexing="ij")
    wave = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
    return np.asarray(np.minimum(3.1 - np.sqrt(x**2 + y**2 + z**2), 0.55 - np.abs(wave)))


@beside("isoref.distributed", "welded")
def eight_blocks() -> Picture:
    """The surface of each block, and the one that they are."""
    values = gyroid(19)
    cut = blocks(values.shape, ((9, 10),) * 3)
    pieces = [piece(values[where], 0.0, values.shape, start_of(where)) for where in cut]
    whole = welded(pieces)
    figure, axes = panels(2, 3.6, 3.4)
    middle = (np.array(values.shape) - 1) / 2
    moved, colors = [], []
    for n, (one, where) in enumerate(zip(pieces, cut, strict=True)):
        away = 0.28 * (np.array([(s.start + s.stop - 1) / 2 for s in where]) - middle)
        moved.append((one.vertices + away)[one.simplices])
        colors += [COLORS[n]] * len(one.simplices)
    apart = np.concatenate(moved)
    loose = Mesh.of(apart.reshape(-1, 3), np.arange(3 * len(apart)).reshape(-1, 3))
    surface(axes[0], loose, colors, width=0.15)
    surface(axes[1], whole, colors, width=0.15)
    for axis, title in zip(axes, (f"{len(cut)} pieces", "one mesh"), strict=True):
        far = 1.5 if title == "one mesh" else -0.5
        bare(axis, (far,) * 3, (18 - far,) * 3, title, view=(26, -50))
    came = sum(len(one.vertices) for one in pieces)
    shared = sum(int(one.shared.sum()) for one in pieces)
    return Picture(
        figure,
        f"A volume of {values.shape[0]}³ samples in {len(cut)} blocks. The pieces come with "
        f"{came:,} vertices; the {shared:,} on planes between blocks are looked up by name, and "
        f"{len(whole.vertices):,} are left.",
    )


@beside("isoref.fast.bricks", "boxes")
def bricks_of_a_plane() -> Picture:
    """The bricks that an isovalue divides, and the boxes round them, in one layer."""
    n, side = 321, 16
    x, y = np.meshgrid(*[np.linspace(-1.6, 1.6, n)] * 2, indexing="ij")
    bumps = (((-0.9, -0.7), 0.30), ((0.8, 0.9), 0.22), ((0.75, -0.85), 0.16))
    layer = sum(np.exp(-((x - a) ** 2 + (y - b) ** 2) / (2 * r * r)) for (a, b), r in bumps)
    values = np.repeat(np.asarray(layer)[:, :, None], side + 1, axis=2)
    figure, axes = panels(2, 3.1, 3.2, space=False)
    index, told = Index.of(values, side=side), []
    for axis, level in zip(axes, (0.85, 0.12), strict=True):
        divided = index.divided(level)
        axis.contour(values[:, :, 0].T, [level], colors=RED, linewidths=1.6)
        for low in np.ndindex(divided.shape[:2]):
            _brick(axis, low, (1, 1), side, bool(divided[low[0], low[1], 0]))
        made = boxes(divided, side)
        for box in made:
            size = [s.stop - s.start for s in box[:2]]
            corner = (side * box[0].start, side * box[1].start)
            axis.add_patch(
                Rectangle(corner, side * size[0], side * size[1], fill=False, edgecolor=INK, lw=2)
            )
        told.append((int(divided.sum()), divided.size, len(made)))
        flat(axis, f"isovalue {level}: {told[-1][0]} of {told[-1][1]}")
        axis.set(xlim=(-1, n), ylim=(-1, n))
    (few, of, heaps), (many, _, more) = told
    return Picture(
        figure,
        f"One layer of bricks of {side}³ cells. At the higher isovalue the surface (red) divides "
        f"{few} of {of}, in {heaps} {'box' if heaps == 1 else 'boxes'} (dark); at the lower one "
        f"{many}, in {more}. All other samples are not looked at.",
    )


def _brick(axis: Any, low: Any, size: Any, side: int, divided: bool) -> None:
    """One brick, tinted where it is divided."""
    axis.add_patch(
        Rectangle(
            (side * low[0], side * low[1]),
            side * size[0],
            side * size[1],
            facecolor="#dbe8f2" if divided else "none",
            edgecolor="#b8c2ca",
            linewidth=0.5,
            zorder=0,
        )
    )
