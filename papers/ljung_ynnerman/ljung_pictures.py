"""The pictures of surfaces, curves and points, and how a figure is written."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from isoref.curves import Curve
from isoref.field import Floats
from isoref.marching_faces import FacePoints
from isoref.mesh import Mesh

COLOURS = np.array(
    [(230, 75, 53), (77, 187, 213), (0, 160, 135), (60, 84, 136), (243, 155, 127), (220, 180, 50),
     (126, 97, 72), (145, 100, 190), (110, 170, 60), (200, 90, 150)], np.uint8
)  # fmt: skip


def save(figure: Any, path: Path) -> None:
    """The figure is written, without a date so that it only changes when its content does."""
    from matplotlib import pyplot as plt

    path.parent.mkdir(parents=True, exist_ok=True)
    figure.tight_layout()
    plt.rcParams["svg.hashsalt"] = "isograde"
    figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None, dpi=90)
    plt.close(figure)


def figure_1(
    surfaces: Sequence[Mesh], curves: Sequence[Curve], points: FacePoints, path: Path
) -> str | None:
    """The four pictures of Figure 1; None, or why they could not be made."""
    try:
        import pyvista as pv
    except ImportError as error:
        return f"Figure 1 needs pyvista: {error}"
    plotter = pv.Plotter(off_screen=True, shape=(2, 2), window_size=[1000, 1000], border=False)
    for panel, (surface, colour) in enumerate(zip(surfaces, ("#d9a441", "#5b8fc7"), strict=True)):
        plotter.subplot(0, panel)
        mesh = pv.PolyData.from_regular_faces(surface.vertices, surface.simplices)
        plotter.add_mesh(mesh, color=colour, smooth_shading=True, specular=0.1)
    plotter.subplot(1, 0)
    plotter.add_mesh(tubes(curves, 0.004), scalars="colour", rgb=True)
    plotter.subplot(1, 1)
    plotter.add_mesh(shaded_points(points), scalars="light", cmap="bone", point_size=4.5,
                     render_points_as_spheres=False, show_scalar_bar=False)  # fmt: skip
    captions = (
        f"(a) real part, {len(surfaces[0].simplices):,} triangles",
        f"(b) imaginary part, {len(surfaces[1].simplices):,} triangles",
        f"(c) {len(curves)} curves as four-sided tubes",
        f"(d) {len(points):,} points, shaded by their tangents",
    )
    for (row, column), caption in zip(np.ndindex(2, 2), captions, strict=True):
        plotter.subplot(row, column)
        plotter.add_text(caption, position="upper_edge", font_size=9, color="white")
        plotter.set_background("#15202b")
        plotter.camera_position = [(2.75, 2.2, 1.8), (0.5, 0.5, 0.47), (0, 0, 1)]
    _screenshot(plotter, path)
    return None


def tubes(curves: Sequence[Curve], radius: float) -> Any:
    """Four-sided tubes around the curves, each curve in a colour of its own."""
    import pyvista as pv

    blocks = []
    for number, curve in enumerate(sorted(curves, key=lambda c: -c.length)):
        line = pv.lines_from_points(curve.polyline).strip()
        tube = line.tube(radius=radius, n_sides=4)
        tube.point_data.clear()
        tube["colour"] = np.tile(COLOURS[number % len(COLOURS)], (tube.n_points, 1))
        blocks.append(tube)
    return pv.merge(blocks)


def shaded_points(points: FacePoints) -> Any:
    """The points of Marching Faces, lit as fine hairs along their tangents (Zöckler et al.)."""
    import pyvista as pv

    light = np.array([0.6, 0.5, 0.62])
    along = points.tangents @ (light / np.linalg.norm(light))
    cloud = pv.PolyData(points.positions)
    cloud["light"] = 0.25 + 0.75 * points.confidence * np.sqrt(np.maximum(1 - along**2, 0)) ** 4
    return cloud


def _screenshot(plotter: Any, path: Path) -> None:
    """The picture is written with a palette, so that it stays small."""
    from PIL import Image

    path.parent.mkdir(parents=True, exist_ok=True)
    pixels = plotter.screenshot(return_img=True)
    plotter.close()
    Image.fromarray(pixels).quantize(256).save(path, optimize=True)


def vortex_picture(
    magnitude: Floats, curves: Sequence[Curve], spacing: Sequence[float], path: Path
) -> str | None:
    """The vortex lines above the slice of the magnitude through their lowest point."""
    try:
        import pyvista as pv
    except ImportError as error:
        return f"the picture of the vortices needs pyvista: {error}"
    grid = pv.ImageData(dimensions=magnitude.shape, spacing=tuple(map(float, spacing)))
    grid["magnitude"] = magnitude.ravel(order="F")
    plotter = pv.Plotter(off_screen=True, window_size=[900, 700])
    points = np.concatenate([curve.points for curve in curves])
    floor = np.array(grid.center)
    floor[2] = max(points[:, 2].min(), 0.01 * spacing[2])
    plotter.add_mesh(grid.slice(normal="z", origin=floor), cmap="gray", show_scalar_bar=False,
                     lighting=False)  # fmt: skip
    plotter.add_mesh(tubes(curves, 0.2 * min(spacing)), scalars="colour", rgb=True)
    plotter.set_background("white")
    reach = max(grid.length, 1e-9)
    eye = floor + reach * np.array([0.28, -0.42, 0.5])
    plotter.camera_position = [eye, floor, (0, 0, 1)]
    plotter.camera.zoom(1.05)
    _screenshot(plotter, path)
    return None
