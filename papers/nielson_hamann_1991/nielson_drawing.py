"""Cells drawn in the paper's manner: seen from the front, a little from the right and from above.

Everything is a small polygon with a depth, and the farthest is painted first: cube edges, sheets,
their outlines, corners. So a sheet hides what lies behind it without any geometry library.

Glossary
--------
place       coordinates of a cell: axis 0 right, axis 1 up, axis 2 towards the reader
patch       a polygon on paper with a depth and a colour
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from isoref.cube import CORNERS, EDGES, inside
from isoref.cycles import Polygon, Triangle
from isoref.field import Floats
from isoref.rule import Tile
from isoref.sweep import cell_crossings
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb

OBLIQUE = np.array([0.34, 0.22])  # how far on paper the back is from the front
VIEWER = np.array([*OBLIQUE, 1.0]) / np.linalg.norm([*OBLIQUE, 1.0])
LIGHT = np.array([-0.35, 0.75, 0.6]) / np.linalg.norm([-0.35, 0.75, 0.6])
OUTSIDE, INSIDE = "#5b8fc7", "#e9a15b"  # the side a sheet shows: towards low values, towards high
LINE, EDGE, MARK, HOLE = "#1d2b3a", "#9aa5b1", "#1d2b3a", "#d0342c"
PIECES = 8  # each triangle is cut into PIECES**2, for the order of painting


@dataclass
class Picture:
    """Patches of one drawing, and spots that are seen through whatever hides them."""

    marks: list[Floats] = field(default_factory=list)
    shapes: list[Floats] = field(default_factory=list)
    depths: list[float] = field(default_factory=list)
    colours: list[tuple[float, float, float]] = field(default_factory=list)

    def add(self, shape: Floats, depth: float, colour: object) -> None:
        """One more patch."""
        self.shapes.append(shape)
        self.depths.append(depth)
        self.colours.append(to_rgb(colour))  # type: ignore[arg-type]

    def line(self, a: Floats, b: Floats, width: float, colour: str, lift: float = 0.07) -> None:
        """A segment from place a to place b, `lift` nearer than it is."""
        ends = np.linspace(a, b, 13)
        across = on_paper(b) - on_paper(a)
        length = float(np.hypot(*across))
        if length == 0:
            return
        normal = width / 2 * np.array([-across[1], across[0]]) / length
        for p, q in pairwise(ends):
            x, y = on_paper(p), on_paper(q)
            shape = np.array([x + normal, y + normal, y - normal, x - normal])
            self.add(shape, float((p + q) @ VIEWER / 2) + lift, colour)

    def mark(self, place: Floats, radius: float) -> None:
        """A round spot that is seen through sheets."""
        self.marks.append(on_paper(place) + radius * circle())

    def dot(self, place: Floats, radius: float, fill: str, rim: str = LINE) -> None:
        """A round spot."""
        ring = circle()
        depth = float(place @ VIEWER) + 0.09
        self.add(on_paper(place) + radius * ring, depth, rim)
        self.add(on_paper(place) + 0.72 * radius * ring, depth + 1e-6, fill)

    def triangle(self, corners: Floats) -> None:
        """A sheet, shaded by its slope, coloured by the side it shows."""
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        size = float(np.linalg.norm(normal))
        if size == 0:
            return
        seen = normal / size * np.sign(normal @ VIEWER or 1)
        base = OUTSIDE if normal @ VIEWER > 0 else INSIDE
        light = 0.62 + 0.38 * max(0.0, float(seen @ LIGHT))
        colour = tuple(min(1.0, light * channel) for channel in to_rgb(base))
        for piece in pieces(corners):
            depth = float(piece.mean(axis=0) @ VIEWER)
            self.add(on_paper(piece), depth, colour)

    def paint(self, axes: Axes) -> None:
        """Everything on the axes, the farthest first."""
        order = np.argsort(self.depths, kind="stable")
        colours = [self.colours[i] for i in order]
        axes.add_collection(
            PolyCollection(
                [self.shapes[i] for i in order],
                facecolors=colours,
                edgecolors=colours,
                linewidths=0.6,
            )
        )
        axes.add_collection(
            PolyCollection(
                self.marks, facecolors=MARK, edgecolors="white", linewidths=0.4, alpha=0.6
            )
        )
        axes.set_aspect("equal")
        axes.autoscale_view()
        axes.margins(0.08)
        axes.axis("off")


def circle() -> Floats:
    """(24, 2) points of the unit circle."""
    turn = np.linspace(0, 2 * np.pi, 25)[:-1]
    return np.stack([np.cos(turn), np.sin(turn)], axis=1)


def on_paper(place: Floats) -> Floats:
    """Where places (.., 3) stand on paper (.., 2)."""
    return np.asarray(place[..., :2] + (1 - place[..., 2:]) * OBLIQUE)


def pieces(corners: Floats) -> Iterable[Floats]:
    """The triangle cut into PIECES**2 like it."""
    u, v = (corners[1] - corners[0]) / PIECES, (corners[2] - corners[0]) / PIECES
    for i in range(PIECES):
        for j in range(PIECES - i):
            low = corners[0] + i * u + j * v
            yield np.array([low, low + u, low + v])
            if i + j < PIECES - 1:
                yield np.array([low + u, low + u + v, low + v])


def draw_cube(picture: Picture, signs: int, shift: Sequence[float] = (0, 0, 0)) -> None:
    """Edges and corners; marked corners are dark, and seen through sheets."""
    at = np.array(shift, float)
    for a, b in EDGES:
        ends = np.array(CORNERS[a]) + at, np.array(CORNERS[b]) + at
        picture.line(*ends, 0.013, EDGE, lift=0.0)
    for c, corner in enumerate(CORNERS):
        picture.dot(np.array(corner) + at, 0.045, MARK if inside(signs, c) else "white")
        if inside(signs, c):
            picture.mark(np.array(corner) + at, 0.036)


def node_places(tile: Tile, g: Floats) -> Floats:
    """(nodes, 3) places of the crossings and interior points for the values g (8,)."""
    crossings = cell_crossings(g[:, None])
    inner = [place(g[:, None], crossings) for place in tile.interior]
    return np.concatenate([crossings[:, 0], *inner])


def draw_tile(
    picture: Picture,
    tile: Tile,
    polygons: Iterable[Polygon],
    nodes: Floats,
    shift: Sequence[float] = (0, 0, 0),
) -> None:
    """The sheets of a cell, thin inner edges, thick boundary polygons."""
    places = nodes + np.array(shift)
    sides = {frozenset(s) for p in polygons for s in zip(p, p[1:] + p[:1], strict=True)}
    for t in tile.triangles:
        picture.triangle(places[list(t)])
    for side in {frozenset(s) for t in tile.triangles for s in sides_of(t)}:
        a, b = sorted(side)
        width = 0.020 if side in sides else 0.007
        picture.line(places[a], places[b], width, LINE)
    for number in range(len(tile.interior)):
        picture.dot(places[12 + number], 0.032, HOLE)


def draw_polygon(picture: Picture, polygon: Polygon, nodes: Floats, colour: str = LINE) -> None:
    """A boundary polygon alone."""
    for a, b in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        picture.line(nodes[a], nodes[b], 0.024, colour)
    for e in polygon:
        picture.dot(nodes[e], 0.022, colour)


def sides_of(t: Triangle) -> list[tuple[int, int]]:
    """The three sides."""
    return [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]
