"""
A tunnel that no corner shows
=============================

Two opposite corners of a cell are inside, all others outside. No face is ambiguous, and yet the
trilinear interpolant has two answers: two separate caps, or, where the inside reaches through
the middle of the cell, one surface that runs round a tunnel. The asymptotic decider never asks
and always draws two caps; `trilinear-cubes` compares the saddles inside the cell. Dots are points
of the level set itself.
"""

from itertools import combinations

import matplotlib.pyplot as plt
import numpy as np
from isoref import METHODS, Field
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection


def trilinear(values, points):
    """The trilinear interpolant of one cell."""
    x, y, z = points.T
    return sum(
        values[i, j, k] * np.where(i, x, 1 - x) * np.where(j, y, 1 - y) * np.where(k, z, 1 - z)
        for i, j, k in np.ndindex(2, 2, 2)
    )


def level_set(values, rays=20000):
    """Points where lines along the axes cross the zero of the interpolant."""
    chance = np.random.default_rng(1)
    found = []
    for axis in range(3):
        ends = chance.random((2, rays, 3))
        ends[1] = ends[0]
        ends[0][:, axis], ends[1][:, axis] = 0, 1
        low, high = trilinear(values, ends[0]), trilinear(values, ends[1])
        crossed = (low >= 0) != (high >= 0)
        t = (low / (low - high))[crossed, None]
        found.append((1 - t) * ends[0][crossed] + t * ends[1][crossed])
    return np.concatenate(found)


values = np.full((2, 2, 2), -1.0)
values[0, 0, 0] = values[1, 1, 1] = 4.0
corners = np.array(list(np.ndindex(2, 2, 2)))
wires = [
    corners[[a, b]] for a, b in combinations(range(8), 2) if abs(corners[a] - corners[b]).sum() == 1
]

figure, axes = plt.subplots(1, 2, figsize=(9.5, 4.8), subplot_kw={"projection": "3d"})
for axis, name in zip(axes, ("asymptotic-decider", "trilinear-cubes"), strict=True):
    mesh = METHODS[name](Field.of(values), 0.0)
    surface = Poly3DCollection(
        mesh.vertices[mesh.simplices], facecolor="#7fb2d9", edgecolor="#2f4a60", alpha=0.55
    )
    axis.add_collection3d(surface)
    dots = level_set(values)[::12]
    axis.plot(*dots.T, ".", color="crimson", markersize=1.2)
    axis.add_collection3d(Line3DCollection(wires, colors="#777777", linewidths=0.8))
    for corner in corners:
        color = "black" if values[tuple(corner)] >= 0 else "white"
        axis.scatter(*corner, s=45, c=color, edgecolor="black")
    axis.set_title(f"{name}: {len(mesh.simplices)} triangles", y=1.02)
    axis.set(xlim=(0, 1), ylim=(0, 1), zlim=(0, 1))
    axis.set_box_aspect((1, 1, 1), zoom=1.05)
    axis.view_init(18, -66)
    axis.set_axis_off()
figure.tight_layout()
plt.show()
