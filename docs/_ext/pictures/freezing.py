"""Pictures of freeze-out: where elements of a surface stand, and which way they face."""

from __future__ import annotations

from typing import Any

import numpy as np
from isoref import Field, Mesh
from isoref.cornelius import cornelius, elements
from isoref.cube import CORNERS
from isoref.field import Floats
from isoref.freeze_out import cycle_elements, triangle_elements
from isoref.freeze_out import hypersurface as fireball_surface
from isoref.hypersurface import hypersurface

from pictures import Picture, beside
from pictures.drawing import BLUE, INK, RED, SAND, bare, corners, flat, panels, surface, wire


@beside("isoref.freeze_out", "cycle_elements")
def one_place_a_cycle() -> Picture:
    """The normals of triangles and those of cycles."""
    i, j, k = np.meshgrid(*[np.arange(9.0)] * 3, indexing="ij")
    hot = 3.1 - np.sqrt((i - 4) ** 2 + (j - 4) ** 2 / 1.4 + (k - 4) ** 2 / 0.7)
    found = fireball_surface(Field.of(hot), 0.0)
    mesh = found.mesh("L")
    figure, axes = panels(2, 3.4, 3.3)
    told = []
    for axis, one, title in zip(
        axes, (triangle_elements(mesh), cycle_elements(found)), ("dsigma", "dSigma"), strict=True
    ):
        told.append(len(one.places))
        surface(axis, mesh, SAND, alpha=0.9, width=0.25)
        # Draw those that a reader of this side sees.
        eye = np.array([0.5, -0.75, 0.35])
        seen = one.normals @ eye > 0.15 * np.linalg.norm(one.normals, axis=1)
        axis.computed_zorder = False
        axis.quiver(
            *one.places[seen].T, *(1.3 * one.normals[seen]).T, color=RED, linewidth=0.9, zorder=9
        )
        bare(axis, (0.2, 0.2, 0.8), (7.8, 7.8, 7.2), f"{title}: {told[-1]}", view=(22, -56))
    moved = cycle_elements(found).flux(lambda x: x / 3)
    exact = triangle_elements(mesh).flux(lambda x: x / 3)
    return Picture(
        figure,
        f"The surface of a fireball with the normals of its {told[0]} triangles, and of its "
        f"{told[1]} cycles. The flux of x / 3 through the first is the enclosed volume, "
        f"{exact:.2f}; through the second it is {moved:.2f}.",
    )


@beside("isoref.cornelius", "element")
def where_it_stands() -> Picture:
    """The elements of a contour, and one polygon with its two middles."""
    figure, axes = panels(2, 3.4, 3.2)
    axes[0].set_axis_off()
    plane = figure.add_subplot(1, 2, 1)
    i, j = np.meshgrid(np.arange(9.0), np.arange(9.0), indexing="ij")
    values = (
        2.1 - np.abs(np.hypot(i - 4, j - 4.1) - 1.1) - 0.25 * np.cos(3 * np.arctan2(j - 4, i - 4))
    )
    field = Field.of(values - 1.1)
    found = cornelius(field, 0.0)
    shown = field.values
    plane.scatter(*np.argwhere(shown >= 0).T, s=14, c=INK)
    plane.scatter(*np.argwhere(shown < 0).T, s=14, c="white", edgecolor="#9aa5ae", linewidths=0.6)
    across = found.normals @ np.array([[0, 1], [-1, 0]]) / 2
    for place, half in zip(found.places, across, strict=True):
        plane.plot(*np.array([place - half, place + half]).T, color=BLUE, linewidth=2)
    plane.quiver(
        *found.places.T,
        *found.normals.T,
        color=RED,
        angles="xy",
        scale_units="xy",
        scale=1.4,
        width=0.006,
    )
    flat(plane, f"in the plane: {len(found.places)} elements")
    # One cell of three axes, with a polygon of five sides.
    cell = np.array([[[1.6, -0.2], [0.4, -0.9]], [[0.25, -1.4], [-1.5, -2.0]]])
    ((place, normal),) = elements(cell, np.ones(3))
    rim = _rim(cell)
    mean = rim.mean(axis=0)
    loose = Mesh.of(
        np.array([*rim, place]), [(n, (n + 1) % len(rim), len(rim)) for n in range(len(rim))]
    )
    surface(axes[1], loose, BLUE, alpha=0.75, width=0.9)
    wire(axes[1])
    corners(axes[1], cell)
    axes[1].computed_zorder = False
    axes[1].scatter(*mean, s=34, c=SAND, edgecolor=INK, depthshade=False, zorder=9)
    axes[1].scatter(*place, s=34, c=RED, edgecolor=INK, depthshade=False, zorder=9)
    axes[1].quiver(*place, *(0.75 * normal), color=RED, linewidth=2, zorder=9)
    bare(axes[1], (0, 0, 0), (1, 1, 1.15), f"in space: a polygon of {len(rim)}", view=(28, 38))
    away = float(np.linalg.norm(place - mean))
    return Picture(
        figure,
        "On the left the elements of two contours, each a line (blue) with its normal (red), from "
        f"hot to cold. On the right the one element of a cell: it stands at the centre of mass "
        f"(red), {away:.3f} of a cell from the average of its {len(rim)} points (sand).",
    )


def _rim(cell: Floats) -> Floats:
    """The points of the one polygon of a cell, in order."""
    from isoref.cube import EDGES
    from isoref.cycles import cycles

    g = np.array([cell[tuple(place)] for place in CORNERS])
    (polygon,) = cycles(sum(1 << c for c in range(8) if g[c] >= 0), 0)
    ends = [EDGES[e] for e in polygon]
    places = np.array(CORNERS, float)
    return np.array([places[a] + g[a] / (g[a] - g[b]) * (places[b] - places[a]) for a, b in ends])


@beside("isoref.hypersurface", "hypersurface")
def in_space_and_time() -> Picture:
    """A fireball that grows and dies: elements by time and radius, and its surface at two times."""
    count, times = 10, 11
    t = np.arange(times, dtype=float)[:, None, None, None]
    side = np.arange(count, dtype=float) - (count - 1) / 2
    x, y, z = np.meshgrid(side, side, side, indexing="ij")
    radius = np.sqrt(x**2 + y**2 + z**2)[None]
    hot = 1 - ((radius - 0.3 * t) / 2.6) ** 2 * (radius > 0.3 * t) - (t / 8.6) ** 2
    found = hypersurface(Field.of(hot, 1, (0, *[side[0]] * 3)), 0.15)
    one = found.polyhedra
    r = np.linalg.norm(one.places[:, 1:], axis=1)
    outward = (one.normals[:, 1:] * one.places[:, 1:]).sum(axis=1) / np.maximum(r, 1e-9)
    figure, axes = panels(1, 5, 3.6, space=False)
    axes[0].quiver(
        r,
        one.places[:, 0],
        outward,
        one.normals[:, 0],
        one.normals[:, 0] > 0,
        cmap=_two(),
        angles="xy",
        scale_units="xy",
        scale=1.6,
        width=0.0022,
        headwidth=5,
    )
    fine, late = np.meshgrid(np.linspace(0, 5, 200), np.linspace(0, times - 1, 200))
    exact = 1 - ((fine - 0.3 * late) / 2.6) ** 2 * (fine > 0.3 * late) - (late / 8.6) ** 2
    axes[0].contour(fine, late, exact, [0.15], colors=INK, linewidths=1)
    axes[0].set(xlabel="radius", ylabel="time", xlim=(0, 4.9), ylim=(0, times - 1.6))
    axes[0].spines[["top", "right"]].set_visible(False)
    figure.subplots_adjust(left=0.1, bottom=0.14, right=0.98, top=0.97)
    later = int((one.normals[:, 0] > 0).sum())
    return Picture(
        figure,
        f"The {len(one.places):,} elements of a fireball on four axes, each by its radius and its "
        f"time, with its normal. The dark line is the surface itself. The normals of {later:,} "
        "elements point forward in time (red), where the fireball shrinks or ends; the others "
        "(blue) point back, where it still grows.",
    )


def _two() -> Any:
    """A map of two colours."""
    from matplotlib.colors import ListedColormap

    return ListedColormap([BLUE, RED])
