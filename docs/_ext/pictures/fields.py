"""Pictures of curves, fields and any dimension."""

from __future__ import annotations

from typing import Any

import numpy as np
from isoref import METHODS, Field, Mesh
from isoref.dyadic import Samples, dyadic_tree, local_slopes
from isoref.fast.marching_faces import intersection_curves, nodal_lines
from isoref.fast.simplicial import extract as simplices
from isoref.kuhn import box_simplices
from isoref.plane_waves import random_waves
from isoref.projection import project
from isoref.simplex_section import section_types, staircase

from pictures import Picture, beside
from pictures.drawing import BLUE, INK, RED, SAND, bare, flat, lines, panels, surface


@beside("isoref.kuhn")
def two_and_six() -> Picture:
    """A square cut in two, and a cube in six, moved apart."""
    figure, axes = panels(2, 2.8, 2.8)
    for axis in axes:
        axis.set_axis_off()
    flat_axis = figure.add_subplot(1, 2, 1)
    for triangle, color in zip(box_simplices([0, 0], [1, 1]), (BLUE, SAND), strict=True):
        flat_axis.fill(*triangle.T, color=color, edgecolor=INK)
    flat(flat_axis, "2! triangles")
    cut = box_simplices([0, 0, 0], [1, 1, 1])
    for n, tetrahedron in enumerate(cut):
        moved = tetrahedron + 0.35 * (tetrahedron.mean(axis=0) - 0.5)
        faces = np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]])
        surface(axes[1], Mesh.of(moved, faces), BLUE if n % 2 else SAND, width=0.8)
    view = (18, -38)
    bare(axes[1], (-0.1,) * 3, (1.1,) * 3, f"{len(cut)} tetrahedra, apart", view=view)
    return Picture(
        figure, "A square and a cube, cut along every path that climbs one axis at a time."
    )


@beside("isoref.simplex_section", "staircase")
def paths() -> Picture:
    """The staircases of one type."""
    p, q = 3, 3
    table = staircase(p, q)
    figure, axes = panels(len(table), 1.3, 1.5, space=False)
    for axis, row in zip(axes, table.tolist(), strict=True):
        steps = np.array([divmod(int(v), q) if isinstance(v, int) else v for v in row])
        axis.plot(*np.array([(i, j) for i in range(p) for j in range(q)]).T, ".", color="#b8c2ca")
        axis.plot(*steps.T, "o-", color=RED, linewidth=2, markersize=4)
        flat(axis)
        axis.set(xlim=(-0.4, p - 0.6), ylim=(-0.4, q - 0.6))
    kinds = len(section_types(p + q - 1))
    return Picture(
        figure,
        f"Type ({p}, {q}), one of {kinds} of a {p + q - 1}-simplex: its section is cut into "
        f"{len(table)} simplices, one "
        "for each path from corner to corner.",
    )


def _pair(count: int) -> tuple[Field, Field]:
    x, y, z = np.meshgrid(*[np.linspace(-1.4, 1.4, count)] * 3, indexing="ij")
    step = 2.8 / (count - 1)
    ball = Field.of(1.0 - np.sqrt(x**2 + y**2 + z**2), step)
    rod = Field.of(0.55 - np.hypot(x - 0.35, y), step)
    return ball, rod


@beside("isoref.marching_faces")
def ball_and_rod() -> Picture:
    """Two isosurfaces and the curve in which they meet."""
    ball, rod = _pair(15)
    figure, axes = panels(2, 3, 3)
    for field, color in ((ball, BLUE), (rod, SAND)):
        surface(axes[0], METHODS["asymptotic-decider"](field, 0.0), color, alpha=0.45, edges=None)
    curves = intersection_curves(ball, rod)
    pieces = [np.asarray(c.polyline) for c in curves]
    for axis in axes:
        axis.computed_zorder = False
        lines(axis, pieces, RED, 2.4)
    axes[1].plot(*np.concatenate(pieces).T, ".", color=INK, markersize=4)
    bare(axes[0], (0.2, 0.2, 0), (2.6, 2.6, 2.8), "two isosurfaces")
    bare(axes[1], (0.2, 0.2, 0), (2.6, 2.6, 2.8), "their curve, without either")
    return Picture(
        figure,
        f"A ball and a rod on one lattice meet in {len(curves)} curve{'s' * (len(curves) != 1)} "
        "through "
        f"{sum(len(c.points) for c in curves)} points on faces of voxels.",
    )


@beside("isoref.plane_waves", "random_waves")
def vortices() -> Picture:
    """Vortices of random waves, and how long they are."""
    psi = random_waves((30, 30, 30), k=14.0, seed=8)
    curves = nodal_lines(psi)
    figure, axes = panels(1, 4.2, 4)
    for curve in curves:
        lines(axes[0], [np.asarray(curve.polyline)], RED if curve.closed else BLUE, 1.4)
    closed = sum(c.closed for c in curves)
    size = np.max([np.max(c.polyline) for c in curves])
    bare(axes[0], (0, 0, 0), (size, size, size))
    return Picture(
        figure,
        f"Vortices of a hundred random waves: {closed} closed (red), {len(curves) - closed} "
        "that end on the border.",
    )


@beside("isoref.dyadic", "dyadic_tree")
def leaves() -> Picture:
    """The leaves of a dyadic tree round a curve."""
    count = 65
    x, y = np.meshgrid(*[np.linspace(-1.2, 1.2, count)] * 2, indexing="ij")
    field = Field.of(1 - (x**2 + 1.6 * y**2 - 0.35 * np.sin(3 * x)), dimension=2)
    tree = dyadic_tree(Samples.of_field(field), local_slopes(field))
    figure, axes = panels(1, 3.6, 3.6, space=False)
    for side, boxes in zip(tree.sides, tree.boxes, strict=True):
        for low in boxes.tolist():
            axes[0].add_patch(_square(low, side))
    found = simplices(field)
    for a, b in found.vertices[found.simplices]:
        axes[0].plot(*np.array([a, b]).T, color=RED, linewidth=1.4)
    flat(axes[0])
    axes[0].set(xlim=(-1, count), ylim=(-1, count))
    cells = (count - 1) ** 2
    return Picture(
        figure,
        f"Where the curve may be, boxes are halved: {tree.tested:,} of them are tested, and "
        f"{len(tree.leaves)} of {cells:,} cells are left to be cut.",
    )


def _square(low: list[int], side: int) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle((low[0], low[1]), side, side, fill=False, edgecolor=BLUE, linewidth=0.6)


@beside("isoref.projection", "project")
def clifford() -> Picture:
    """A torus of four dimensions, projected."""
    side = np.linspace(-1.3, 1.3, 12)
    x, y, p, q = np.meshgrid(side, side, side, side, indexing="ij")
    values = np.stack([1 - x**2 - y**2, 1 - p**2 - q**2])
    mesh = simplices(Field.of(values, side[1] - side[0], [side[0]] * 4, dimension=4))
    flat_mesh = project(mesh, (0, 1, 2))
    figure, axes = panels(1, 3.6, 3.6)
    surface(axes[0], flat_mesh, SAND, edges=None)
    bare(axes[0], (-1.1, -1.1, -1.1), (1.1, 1.1, 1.1), view=(30, -60))
    return Picture(
        figure,
        f"A torus of {len(mesh.simplices):,} triangles in four dimensions. With one coordinate "
        "dropped it is a cylinder, each "
        "point of it met twice.",
    )


@beside("isoref.simplicial")
def three_kinds() -> Picture:
    """One algorithm for a contour, a surface and a curve."""
    figure, axes = panels(3, 2.8, 2.8)
    axes[0].set_axis_off()
    plane = figure.add_subplot(1, 3, 1)
    x, y = np.meshgrid(*[np.linspace(-1.3, 1.3, 9)] * 2, indexing="ij")
    contour = simplices(Field.of(1 - x**2 - y**2, dimension=2))
    _kuhn_lines(plane, 9)
    for a, b in contour.vertices[contour.simplices]:
        plane.plot(*np.array([a, b]).T, color=RED, linewidth=2)
    flat(plane, f"(2, 1): {len(contour.simplices)} segments")
    x, y, z = np.meshgrid(*[np.linspace(-1.3, 1.3, 9)] * 3, indexing="ij")
    ball = 1 - x**2 - y**2 - z**2
    mesh = simplices(Field.of(ball, dimension=3))
    surface(axes[1], mesh)
    bare(axes[1], (0.5, 0.5, 0.5), (7.5, 7.5, 7.5), f"(3, 1): {len(mesh.simplices)} triangles")
    curve = simplices(Field.of(np.stack([ball, 0.4 * x + z - 0.2 * y * y]), dimension=3))
    lines(axes[2], list(curve.vertices[curve.simplices]), RED, 2.4)
    bare(axes[2], (0.5, 0.5, 0.5), (7.5, 7.5, 7.5), f"(3, 2): {len(curve.simplices)} segments")
    return Picture(
        figure, "The same function for one field in the plane, one in space, and two in space."
    )


def _kuhn_lines(axis: Any, count: int) -> None:
    """The edges of the Kuhn triangulation of a square lattice."""
    thin = {"color": "#c9d2d9", "linewidth": 0.6}
    for n in range(count):
        axis.plot([n, n], [0, count - 1], **thin)
        axis.plot([0, count - 1], [n, n], **thin)
    for i in range(count - 1):
        for j in range(count - 1):
            axis.plot([i, i + 1], [j, j + 1], **thin)
