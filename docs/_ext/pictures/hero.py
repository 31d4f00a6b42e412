"""The picture of the landing page: a knot, and the surface it bounds.

Milnor's map of the three-sphere vanishes on a trefoil. Where its imaginary part vanishes stands an
isosurface, and the half of it where the real part is positive is a surface whose rim is the knot.
The surface is drawn by `asymptotic-decider`, cut by `attributes`, and the knot is where two
isosurfaces meet, found by Marching Faces.
"""

from __future__ import annotations

import numpy as np
from isoref import METHODS, Field, Mesh
from isoref.fast.marching_faces import nodal_lines
from isoref.field import Floats
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from pictures import Picture, beside
from pictures.drawing import lit

COUNT = 96
REACH = 3.0


def trefoil(count: int = COUNT) -> Floats:
    """(count, count, count) complex values that vanish on a trefoil."""
    x, y, z = np.meshgrid(*[np.linspace(-REACH, REACH, count)] * 3, indexing="ij")
    r2 = x**2 + y**2 + z**2
    u = (2 * z + 1j * (r2 - 1)) / (r2 + 1)
    v = 2 * (x + 1j * y) / (r2 + 1)
    return np.asarray((u**2 - v**3) * np.exp(-0.15j * np.pi))


def tube(points: Floats, radius: float) -> Mesh:
    """A closed line as a surface round it, again an isosurface: of the distance to the line."""
    low = points.min(axis=0) - 4 * radius
    span = (points.max(axis=0) - low).max() + 4 * radius
    count = 96
    step = span / (count - 1)
    from scipy.spatial import cKDTree

    grid = np.stack(np.meshgrid(*[np.arange(count) * step] * 3, indexing="ij"), axis=-1) + low
    ends = np.roll(points, -1, axis=0)
    dense = np.concatenate([points + t * (ends - points) for t in np.linspace(0, 1, 9)[:-1]])
    distance, _ = cKDTree(dense).query(grid.reshape(-1, 3), distance_upper_bound=4 * radius)
    values = radius - np.minimum(distance, 4 * radius).reshape(count, count, count)
    return METHODS["asymptotic-decider"](Field.of(values, step, list(low)), 0.0)


def smooth(points: Floats, waves: int = 24) -> Floats:
    """The closed line without what varies faster than this."""
    spectrum = np.fft.fft(points, axis=0)
    spectrum[waves:-waves] = 0
    return np.asarray(np.fft.ifft(spectrum, axis=0).real)


@beside("hero")
def knot() -> Picture:
    """A trefoil and a surface that it bounds."""
    psi = trefoil()
    step = 2 * REACH / (COUNT - 1)
    field = Field.of(psi.imag, step, [-REACH] * 3)
    mesh = METHODS["asymptotic-decider"](field, 0.0)
    triangles = mesh.vertices[mesh.simplices]
    # Keep the half on which the real part is positive, within a ball.
    middles = triangles.mean(axis=1)
    places = np.clip(np.rint((middles + REACH) / step).astype(int), 0, COUNT - 1)
    kept = (psi.real[tuple(places.T)] > 0) & (np.linalg.norm(middles, axis=1) < 2.95)
    curves = [c for c in nodal_lines(psi) if c.closed]
    line = max(curves, key=lambda c: len(c.points)).points * step - REACH
    rope = tube(smooth(line), 0.085)

    figure = Figure(figsize=(7.2, 6.4))
    axis = figure.add_subplot(projection="3d", computed_zorder=False)
    shown = triangles[kept]
    rest = rope.vertices[rope.simplices]
    colors = np.concatenate([_two_sided(shown), lit(rest, "#c8324b")])
    drawn = Poly3DCollection(np.concatenate([shown, rest]), facecolors=colors, edgecolors=colors)
    drawn.set_linewidth(0.6)
    axis.add_collection3d(drawn)
    bound = 2.15
    axis.set(xlim=(-bound, bound), ylim=(-bound, bound), zlim=(-bound, bound))
    axis.set_box_aspect((1, 1, 1), zoom=1.5)
    axis.view_init(64, -50)
    axis.set_axis_off()
    figure.patch.set_alpha(0)
    figure.subplots_adjust(left=0, right=1, bottom=0, top=1)
    return Picture(
        figure,
        "A trefoil knot, where the isosurfaces of a complex field's two parts meet, and the "
        "half of one of them that the "
        f"knot bounds: {int(kept.sum()):,} triangles, all made by isoref.",
    )


def _two_sided(triangles: Floats) -> Floats:
    """Colours that tell the two sides of a surface apart, as seen from above."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    toward = normals @ np.array([0.24, -0.48, 0.85]) > 0
    return lit(triangles, ["#4f94c6" if up else "#e6b866" for up in toward])
