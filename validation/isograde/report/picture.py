"""A small field and its mesh, drawn as SVG.

Inside samples are filled, outside samples hollow. Triangles are blue from outside and orange from
inside, so that a wrong orientation is seen. Edges that only one triangle has are red where they lie
inside the volume, and thin where they lie on its border. Colours are CSS variables, so that the
picture follows the page's light or dark theme.

The projection is orthographic, and parts are painted from far to near.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
from isoref.field import Booleans, Floats, Integers

# Look along this direction, with axis 2 up: from the front, a little right of and above the middle.
TURN, TILT = np.radians(-62.0), np.radians(24.0)
SIZE, MARGIN = 360.0, 34.0
# Leave samples and lattice out of fields larger than this.
DETAILED = 400
# Name the axes and show values up to this many samples.
LABELLED = 12


@dataclass(frozen=True)
class Part:
    """A piece of SVG with its distance from the eye."""

    depth: float
    svg: str


@dataclass(frozen=True)
class View:
    """Index coordinates to the picture's plane."""

    scale: float
    shift: Floats
    height: float

    @classmethod
    def of(cls, shape: tuple[int, ...]) -> View:
        """The view that fits a lattice of this shape."""
        corners = np.indices((2, 2, 2)).reshape(3, -1).T * (np.asarray(shape) - 1)
        flat = corners @ _axes()[:2].T
        low, high = flat.min(axis=0), flat.max(axis=0)
        scale = float((SIZE - 2 * MARGIN) / (high - low).max())
        height = round(scale * float(high[1] - low[1]) + 2 * MARGIN)
        return cls(scale, (SIZE / 2, height / 2) - scale * (low + high) / 2, height)

    def place(self, points: Any) -> tuple[Floats, Floats]:
        """Positions in the picture and depths of these points."""
        turned = np.asarray(points, np.float64) @ _axes().T
        return turned[..., :2] * self.scale + self.shift, turned[..., 2]


def _axes() -> Floats:
    """Rows: the picture's right, its down, and towards the eye."""
    right = np.array([-np.sin(TURN), np.cos(TURN), 0.0])
    eye = np.array([np.cos(TILT) * np.cos(TURN), np.cos(TILT) * np.sin(TURN), np.sin(TILT)])
    return np.stack([right, -np.cross(eye, right), eye])


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
        parts += [*_triangles(view, points, faces), *_open_edges(view, points, faces, shape)]
    body = "\n".join(part.svg for part in sorted(parts, key=lambda part: part.depth))
    return (
        f'<svg class="pic" viewBox="0 0 {SIZE:g} {view.height:g}" role="img" '
        f'aria-label="{escape(label)}"><title>{escape(label)}</title>\n{body}\n</svg>'
    )


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
            yield _line(view, start, start + offset, "lat", short=_radius(int(np.prod(shape))))


def _radius(samples: int) -> float:
    """The radius of a sample's disc; 0 where samples are not shown."""
    if samples > DETAILED:
        return 0.0
    return 5.5 if samples <= LABELLED else 3.6


def _line(
    view: View, start: Any, end: Any, kind: str, *, nearer: float = 0.0, short: float = 0.0
) -> Part:
    """A segment, each end drawn back by `short`."""
    (a, b), depths = view.place([start, end])
    length = float(np.linalg.norm(b - a))
    if length > 2 * short > 0:
        step = (b - a) * short / length
        a, b = a + step, b - step
    svg = f'<line class="{kind}" x1="{a[0]:.1f}" y1="{a[1]:.1f}" x2="{b[0]:.1f}" y2="{b[1]:.1f}"/>'
    return Part(float(depths.mean()) + nearer, svg)


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


def _triangles(view: View, points: Floats, faces: Integers) -> Iterator[Part]:
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


def _open_edges(
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
        yield _line(view, a, b, "rim" if on_border else "gap", nearer=0.05)
