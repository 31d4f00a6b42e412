"""A lattice seen from outside: from its index coordinates to the plane of a picture, as SVG.

The plane is drawn as it is, axis 0 to the right and axis 1 up; space orthographically, from the
front, a little right of and above the middle; more dimensions with one direction of the picture for
each axis. Parts are painted from far to near. Colours are CSS classes of `style.css`, so that
pictures follow the page's light or dark theme.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from html import escape
from itertools import product
from typing import Any

import numpy as np
from isoref.field import Floats

# Look along this direction, with axis 2 up: from the front, a little right of and above the middle.
TURN, TILT = np.radians(-62.0), np.radians(24.0)
SIZE, MARGIN = 360.0, 34.0


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
        corners = np.array(list(product((0, 1), repeat=len(shape)))) * (np.asarray(shape) - 1)
        flat = corners @ _axes(len(shape))[:2].T
        low, high = flat.min(axis=0), flat.max(axis=0)
        scale = float((SIZE - 2 * MARGIN) / max(1.0, (high - low).max()))
        height = round(scale * float(high[1] - low[1]) + 2 * MARGIN)
        return cls(scale, (SIZE / 2, height / 2) - scale * (low + high) / 2, height)

    def place(self, points: Any) -> tuple[Floats, Floats]:
        """Positions in the picture and depths of these points."""
        places = np.asarray(points, np.float64)
        turned = places @ _axes(places.shape[-1]).T
        return turned[..., :2] * self.scale + self.shift, turned[..., 2]


@cache
def _axes(n: int) -> Floats:
    """Rows: the picture's right, its down, and towards the eye, in coordinates of n axes."""
    if n == 2:
        return np.array([[1.0, 0.0], [0.0, -1.0], [0.0, 0.0]])
    if n > 3:
        angle = np.linspace(-0.2, np.pi / 2 + 0.6, n)
        return np.stack([np.cos(angle), -np.sin(angle), np.zeros(n)])
    right = np.array([-np.sin(TURN), np.cos(TURN), 0.0])
    eye = np.array([np.cos(TILT) * np.cos(TURN), np.cos(TILT) * np.sin(TURN), np.sin(TILT)])
    return np.stack([right, -np.cross(eye, right), eye])


def drawing(view: View, parts: Iterable[Part], label: str) -> str:
    """The picture of these parts, the nearest on top."""
    body = "\n".join(part.svg for part in sorted(parts, key=lambda part: part.depth))
    return (
        f'<svg class="pic" viewBox="0 0 {SIZE:g} {view.height:g}" role="img" '
        f'aria-label="{escape(label)}"><title>{escape(label)}</title>\n{body}\n</svg>'
    )


def line(
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


def dot(view: View, place: Any, kind: str, radius: float, *, nearer: float = 0.0) -> Part:
    """A disc or a ring."""
    (x, y), depth = view.place(place)
    drawn = f'<circle class="{kind}" cx="{x:.1f}" cy="{y:.1f}" r="{radius:g}"/>'
    return Part(float(depth) + nearer, drawn)


def box(view: View, shape: tuple[int, ...]) -> Iterator[Part]:
    """The edges of the box round a lattice."""
    top = np.asarray(shape) - 1
    for corner in product((0, 1), repeat=len(shape)):
        for axis in np.flatnonzero(np.array(corner) == 0):
            other = np.array(corner)
            other[axis] = 1
            yield line(view, corner * top, other * top, "lat")
