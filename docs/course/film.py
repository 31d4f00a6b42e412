"""Films: figures that move, as a fragment of HTML without a network.

A film has steps; each is a picture of points, with faces, lines, dots and words on them, and a
sentence. The reader goes through the steps by a slider, and turns what stands in space by dragging
or by the arrow keys. `film.js` draws it, 90 lines that are put into each fragment; so the same
fragment serves a lesson, a slide, and a file that is opened from disk.

Glossary
--------
step        one picture, with what is said of it
view        from where a film in space is seen first: turn about the upright axis, tilt, in radians
centre      the point in the middle of the picture
size        how much is seen, in units of the points: width, height
"""

from __future__ import annotations

import html
import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

HERE = Path(__file__).parent
BLUE, GOLD, RED, GREEN, GREY = "#5b8ff0", "#f0b94a", "#d6402b", "#2e9e5b", "#8a8f98"
INSIDE, OUTSIDE = "#222222", "#ffffff"
DIGITS = 3


@dataclass
class Step:
    """One picture, which grows by what is drawn into it."""

    says: str
    points: list[list[float]] = field(default_factory=list)
    faces: list[tuple[list[int], str, float]] = field(default_factory=list)
    lines: list[tuple[int, int, str, float, int]] = field(default_factory=list)
    dots: list[tuple[int, str, float]] = field(default_factory=list)
    texts: list[tuple[int, str]] = field(default_factory=list)

    def point(self, place: ArrayLike) -> int:
        """The number of a new point; one in the plane lies in it."""
        x = [round(float(one), DIGITS) + 0.0 for one in np.asarray(place, float)]
        self.points.append([*x, 0.0][:3])
        return len(self.points) - 1

    def face(self, places: ArrayLike, colour: str = GOLD, alpha: float = 0.9) -> None:
        """A polygon is drawn."""
        self.faces.append(([self.point(p) for p in np.asarray(places, float)], colour, alpha))

    def line(self, ends: ArrayLike, colour: str = GREY, thick: float = 1.5, dash: int = 0) -> None:
        """A polyline is drawn."""
        numbers = [self.point(p) for p in np.asarray(ends, float)]
        self.lines += [(a, b, colour, thick, dash) for a, b in pairwise(numbers)]

    def dot(self, place: ArrayLike, colour: str = INSIDE, radius: float = 5) -> None:
        """A point is marked."""
        self.dots.append((self.point(place), colour, radius))

    def text(self, place: ArrayLike, words: str) -> None:
        """Words stand above a place."""
        self.texts.append((self.point(place), words))

    def mesh(
        self, vertices: ArrayLike, faces: ArrayLike, colour: str = GOLD, alpha: float = 0.9
    ) -> None:
        """The polygons of a mesh are drawn on shared points."""
        first = len(self.points)
        for place in np.asarray(vertices, float):
            self.point(place)
        self.faces += [([first + int(v) for v in row], colour, alpha) for row in np.asarray(faces)]


@dataclass(frozen=True)
class Film:
    """A figure that moves.

    title : said to who does not see it
    """

    title: str
    steps: Sequence[Step]
    centre: Sequence[float]
    size: tuple[float, float]
    view: tuple[float, float] = (0.6, 0.35)
    flat: bool = False

    def fragment(self) -> str:
        """The film as HTML."""
        told: dict[str, Any] = {
            "centre": [float(x) for x in (*self.centre, 0.0)[:3]],
            "size": self.size,
            "view": self.view,
            "flat": self.flat,
            "steps": [vars(step) for step in self.steps],
        }
        data = json.dumps(told, separators=(",", ":")).replace("</", "<\\/")
        script = (HERE / "film.js").read_text(encoding="utf-8").replace("\n  ", "\n")
        last, title = len(self.steps) - 1, html.escape(self.title, quote=True)
        turning = "" if self.flat else " Drag, or press the arrow keys, to turn it."
        return (
            '<figure class="film" style="margin:1.5em 0;max-width:42em">'
            f'<svg viewBox="0 0 640 400" role="img" aria-label="{title}.{turning}" '
            f'tabindex="{-1 if self.flat else 0}" style="width:100%;height:auto;display:block;'
            'background:#fff;border:1px solid #bbb;border-radius:6px;touch-action:pan-y"></svg>'
            '<label style="display:flex;gap:.6em;align-items:center">step '
            f'<input type="range" min="0" max="{last}" value="0" style="flex:1;min-width:0">'
            "</label>"
            '<figcaption aria-live="polite" style="min-height:3em;color:inherit;text-align:left">'
            "</figcaption>"
            f'<script type="application/json">{data}</script>\n'
            f"<script>\n{script}</script></figure>\n"
        )
