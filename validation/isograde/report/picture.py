"""A small field and its mesh, drawn as SVG.

Inside samples are filled, outside samples hollow. Triangles are blue from outside and orange from
inside, so that a wrong orientation is seen. Edges that only one triangle has are red where they lie
inside the volume, and thin where they lie on its border.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from isoref.field import Booleans, Floats, Integers

from isograde.report.view import MARGIN, SIZE, Part, View, drawing, line

# Leave samples and lattice out of fields larger than this.
DETAILED = 400
# Name the axes and show values up to this many samples.
LABELLED = 12


def picture(
    record: Mapping[str, Any], mesh: Mapping[str, Any], label: str = "", tie: str = "inside"
) -> str:
    """The SVG of an evidence record's field, with one of the meshes that belong to it.

    `tie` is the side on which a sample equal to the isovalue counts.
    """
    shape = tuple(record["shape"])
    values = np.asarray(record["values"], np.float64).reshape(shape)
    level = record["isovalue"]
    inside = values >= level if tie == "inside" else values > level
    view = View.of(shape)
    parts = [*_lattice(view, shape), *_samples(view, values, inside)]
    if "faces" in mesh:
        points = (np.asarray(mesh["vertices"]).reshape(-1, 3) - record["origin"]) / np.asarray(
            record["spacing"]
        )
        faces = np.asarray(mesh["faces"], np.int64).reshape(-1, 3)
        parts += [*triangles(view, points, faces), *open_edges(view, points, faces, shape)]
    return drawing(view, parts, label)


def _lattice(view: View, shape: tuple[int, ...]) -> Iterator[Part]:
    """The lattice's edges, or of a large lattice the box round it."""
    step = np.ones(3, np.int64)
    if np.prod(shape) > DETAILED:
        step = np.asarray(shape) - 1
    nodes = np.indices(tuple((np.asarray(shape) - 1) // step + 1)).reshape(3, -1).T * step
    for axis in range(3):
        offset = np.zeros(3, np.int64)
        offset[axis] = step[axis]
        for start in nodes[nodes[:, axis] + step[axis] < shape[axis]]:
            yield line(view, start, start + offset, "lat", short=_radius(int(np.prod(shape))))


def _radius(samples: int) -> float:
    """The radius of a sample's disc; 0 where samples are not shown."""
    if samples > DETAILED:
        return 0.0
    return 5.5 if samples <= LABELLED else 3.6


def _samples(view: View, values: Floats, inside: Booleans) -> Iterator[Part]:
    """A disc for each sample; the value beside it where there are few."""
    radius = _radius(values.size)
    if not radius:
        return
    for index in np.ndindex(*values.shape):
        (x, y), depth = view.place(index)
        kind = "in" if inside[index] else "out"
        told = f"sample {index}: {values[index]:g}"
        svg = f'<circle class="{kind}" cx="{x:.1f}" cy="{y:.1f}" r="{radius}">'
        svg += f"<title>{told}</title></circle>"
        if values.size <= LABELLED:
            svg += _value(x, y, float(values[index]))
        yield Part(float(depth) + 1e-3, svg)


def _value(x: float, y: float, value: float) -> str:
    """The sample's value beside it, on the left where there is no room on the right."""
    left = x > SIZE - 2 * MARGIN
    anchor = ' text-anchor="end"' if left else ""
    return (
        f'<text class="val" x="{x - 8 if left else x + 8:.1f}" y="{y - 7:.1f}"{anchor}>'
        f"{value:.3g}</text>"
    )


def triangles(view: View, points: Floats, faces: Integers) -> Iterator[Part]:
    """The triangles, shaded by how they face the eye."""
    flat, depth = view.place(points)
    for face in faces:
        a, b, c = flat[face]
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        length = np.linalg.norm(
            np.cross(points[face[1]] - points[face[0]], points[face[2]] - points[face[0]])
        )
        facing = abs(area) / (length * view.scale**2) if length else 0.0
        # The picture's second axis points down, so a front face turns clockwise.
        kind = "front" if area < 0 else "back"
        corners = " ".join(f"{x:.1f},{y:.1f}" for x, y in (a, b, c))
        svg = (
            f'<polygon class="{kind}" points="{corners}" fill-opacity="{0.45 + 0.4 * facing:.2f}"/>'
        )
        yield Part(float(depth[face].mean()), svg)


def open_edges(
    view: View, points: Floats, faces: Integers, shape: tuple[int, ...]
) -> Iterator[Part]:
    """The edges that only one triangle has."""
    if not len(faces):
        return
    edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    ends, uses = np.unique(edges, axis=0, return_counts=True)
    last = np.asarray(shape) - 1
    for a, b in points[ends[uses == 1]]:
        on_border = ((a == b) & ((a == 0) | (a == last))).any()
        yield line(view, a, b, "rim" if on_border else "gap", nearer=0.05)
