"""Pictures of samples that tie, and of curves in which two surfaces meet."""

from __future__ import annotations

import numpy as np
from isoref import Field, Mesh, extract
from isoref.asymptotic_decider import RULE
from isoref.field import Floats
from isoref.hermite import smooth_curves
from isoref.marching_faces import intersection_curves
from isoref.surface_intersection import enhanced_marching_cubes, surface_intersection
from isoref.ties import separated

from pictures import Picture, beside
from pictures.drawing import BLUE, INK, RED, SAND, bare, corners, lines, panels, surface, wire


@beside("isoref.ties", "separated")
def tied() -> Picture:
    """One sample at the isovalue, before and after its crossings are one."""
    values = np.full((3, 3, 3), -1.0)
    values[..., 0] = 1.0
    values[1, 1, 1] = 0.0
    mesh = extract(values, 0.0, provenance=True)
    label = separated(mesh).mesh
    told = [
        (int(np.isclose(one.vertices, (1, 1, 1)).all(axis=1).sum()), without_area(one))
        for one in (mesh, label)
    ]
    # Draw crossings where they would be if the sample were a little inside.
    values[1, 1, 1] = 0.25
    figure, axes = panels(2, 3.4, 3)
    for axis, one, title in zip(
        axes, (extract(values, 0.0), label), ("crossings", "one vertex"), strict=True
    ):
        surface(axis, one, alpha=0.85, width=0.8)
        for at in np.ndindex(2, 2):
            wire(axis, (*at, 0))
        corners(axis, values[..., :2], 16)
        bare(axis, (0, 0, 0), (2, 2, 1.3), title, view=(38, -58))
    (before, flat), (after, left) = told
    return Picture(
        figure,
        f"The sample in the middle equals the isovalue. {before} crossings stand at it, here drawn "
        f"a little off it, and {flat} triangles between them have no area. With the label it is "
        f"{after} vertex, and {left} such triangles are left.",
    )


def without_area(mesh: Mesh) -> int:
    """How many triangles have none."""
    a, b, c = np.moveaxis(mesh.vertices[mesh.simplices], 1, 0)
    return int((np.linalg.norm(np.cross(b - a, c - a), axis=1) < 1e-12).sum())


def pair(n: int) -> tuple[Floats, Floats]:
    """(n, n, n) samples of a ball and of a wave through it."""
    x, y, z = np.meshgrid(*[np.linspace(-1.3, 1.3, n)] * 3, indexing="ij")
    return 1 - np.sqrt(x**2 + y**2 + z**2), 0.45 * np.sin(2.4 * x) + 0.2 * y - z


@beside("isoref.surface_intersection", "surface_intersection")
def two_surfaces() -> Picture:
    """Both surfaces, and the segments in which their triangles meet."""
    n = 9
    fields = [Field.of(values) for values in pair(n)]
    both = [enhanced_marching_cubes(field, 0.0, RULE) for field in fields]
    found = surface_intersection(*both)
    figure, axes = panels(2, 3.4, 3.2)
    for one, color in zip(both, (BLUE, SAND), strict=True):
        surface(axes[0], one.mesh, color, alpha=0.55, width=0.25)
    for axis, title in zip(axes, ("two surfaces", "what their triangles share"), strict=True):
        lines(axis, list(found.ends), RED, 2.4)
        bare(axis, (0.8,) * 3, (n - 1.8,) * 3, title)
    axes[1].scatter(*found.ends.reshape(-1, 3).T, s=5, c=INK, depthshade=False)
    of = [len(one.mesh.simplices) for one in both]
    return Picture(
        figure,
        f"{of[0]:,} triangles and {of[1]:,}: of {of[0] * of[1]:,} pairs the voxels leave "
        f"{found.tests:,} to test, and {len(found.ends)} meet in a segment.",
    )


@beside("isoref.hermite", "smooth_curves")
def cubics() -> Picture:
    """The same curve by straight segments and by cubics."""
    n = 5
    first, second = (Field.of(values) for values in pair(n))
    straight = intersection_curves(first, second)
    smooth = smooth_curves(first, second, parts=8)
    figure, axes = panels(2, 3.2, 3)
    for axis, curves, title in zip(
        axes, (straight, smooth), ("straight between its points", "a cubic a segment"), strict=True
    ):
        lines(axis, [curve.polyline for curve in curves], BLUE, 2.4)
        for curve in straight:
            axis.scatter(*curve.points.T, s=12, c=INK, depthshade=False)
        bare(axis, (0.6,) * 3, (n - 1.6,) * 3, title, view=(48, -58))
    count = sum(len(curve.points) for curve in straight)
    return Picture(
        figure,
        f"A curve of {count} points on faces of cells. The cubics have its points, and at each "
        "the direction in which both surfaces run.",
    )
