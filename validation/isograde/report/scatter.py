"""Correctness against speed as a picture: a point an implementation, the front marked.

Across is the time beside the peer's, on a logarithmic scale, fast on the right; up is the level
reached and the share of fields that reach the next. The *front* are the points that no other beats
in one without losing in the other. Points on the front have their names in the picture; the others
have numbers, and stand with their names in the list beneath it. Each is a link.

A label stands in the nearest place that is free of points and of other labels, and a thin line
leads to its point where that is not beside it; so no label covers another, however many there are.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from html import escape
from math import hypot, log2
from typing import NamedTuple

import numpy as np
from isoref.field import Floats

from isograde.model import LEVELS

WIDTH, HEIGHT = 720, 460
LEFT, RIGHT, TOP, BOTTOM = 96, 40, 16, 44
Scale = Callable[[float], float]
# A point's radius; a letter of a name and of a number is at most so wide, and a line so high.
RADIUS, LETTER, DIGIT, LINE = 4, 8.0, 6.5, 14
# Places for a label are tried in steps of so much, so far from its point.
STEP, FAR = 3, (300, 240)
# Nearer than this a label needs no line to its point.
BESIDE = 14


class Point(NamedTuple):
    """An implementation in the picture: its time beside the peer's, and its height."""

    name: str
    link: str
    ratio: float
    height: float
    ours: bool


def front(points: Sequence[Point]) -> list[Point]:
    """The points that no other is at least as good as in both and better in one, fastest first."""
    best: list[Point] = []
    for point in sorted(points, key=lambda one: (one.ratio, -one.height)):
        if not best or point.height > best[-1].height:
            best.append(point)
    return best


def scatter(points: Sequence[Point], peer: str) -> str:
    """The picture as SVG."""
    marked = front(points)
    spans = [log2(point.ratio) for point in points]
    low, high = min(spans) - 0.5, max(spans) + 0.5
    floor = min(-1, *(int(point.height) for point in points))

    def across(ratio: float) -> float:
        return LEFT + (high - log2(ratio)) / (high - low) * (WIDTH - LEFT - RIGHT)

    def up(height: float) -> float:
        top = max(LEVELS) + 0.3
        return TOP + (top - height) / (top - floor) * (HEIGHT - TOP - BOTTOM)

    parts = [_axes(across, up, (low, high), floor, peer)]
    steps = " ".join(f"{across(one.ratio):.1f},{up(one.height):.1f}" for one in marked)
    parts.append(f'<polyline class="front" points="{steps}"/>')
    places = Places([(across(one.ratio), up(one.height)) for one in points])
    for point in marked:
        size = (LETTER * len(point.name) + 8, LINE)
        parts.append(_drawn(point, (across(point.ratio), up(point.height)), places, size))
    names = {point.name for point in marked}
    others = (point for point in points if point.name not in names)
    for number, point in enumerate(others, 1):
        size = (DIGIT * len(str(number)) + 2, LINE)
        at = across(point.ratio), up(point.height)
        parts.append(_drawn(point, at, places, size, str(number)))
    told = f"Correctness against speed of {len(points)} implementations; the list beneath says it."
    return (
        f'<svg class="scatter" viewBox="0 0 {WIDTH} {HEIGHT}" role="group" aria-label="{told}">'
        f"{''.join(parts)}</svg>"
    )


class Places:
    """What is taken in the picture, as boxes: the points, and the labels placed until now."""

    def __init__(self, points: Sequence[tuple[float, float]]) -> None:
        around = np.array([-RADIUS, -RADIUS, RADIUS, RADIUS], float)
        self.taken = np.tile(np.array(points, float), 2) + around
        across, up = (np.arange(-most, most + 1, STEP) for most in FAR)
        steps = np.stack(np.meshgrid(across, up), -1).reshape(-1, 2)
        # Of places equally far, one to the right is read first.
        self.steps = steps[np.lexsort((-steps[:, 0], np.hypot(*steps.T)))]

    def place(self, at: tuple[float, float], size: tuple[float, float]) -> tuple[float, float]:
        """The middle of the nearest free box of this size, which is taken from then on.

        At the farthest place that is tried where nothing is free: labels can then cover each other.
        """
        half = np.array(size) / 2
        # The side of a label stands beside its point, not its middle.
        for step in self.steps:
            middle = np.array(at) + step + np.sign(step) * half
            box = np.concatenate([middle - half, middle + half])
            if self._free(box):
                break
        self.taken = np.vstack([self.taken, box])
        return float(middle[0]), float(middle[1])

    def _free(self, box: Floats) -> bool:
        """The box is in the picture, and covers nothing."""
        inside = (box[:2] >= (LEFT, TOP)).all() and (box[2:] <= (WIDTH, HEIGHT - BOTTOM)).all()
        apart = (box[:2] >= self.taken[:, 2:]) | (box[2:] <= self.taken[:, :2])
        return bool(inside and apart.any(axis=1).all())


def _drawn(
    point: Point,
    at: tuple[float, float],
    places: Places,
    size: tuple[float, float],
    number: str = "",
) -> str:
    """A point with its name, or its number, as a link."""
    (x, y), (left, top) = at, places.place(at, size)
    # The line ends at the label's nearest side.
    end = max(left - size[0] / 2, min(x, left + size[0] / 2))
    tip = max(top - LINE / 2, min(y, top + LINE / 2))
    leader = (
        f'<line class="leader" x1="{x:.1f}" x2="{end:.1f}" y1="{y:.1f}" y2="{tip:.1f}"/>'
        if hypot(end - x, tip - y) > BESIDE
        else ""
    )
    best = "" if number else " best"
    mark = f'<circle class="{_kind(point)}{best}" cx="{x:.1f}" cy="{y:.1f}" r="{RADIUS}"/>'
    kind = "number" if number else "name"
    words = f'<text class="{kind}" x="{left:.1f}" y="{top + 4:.1f}">{number or escape(point.name)}'
    return _linked(point, f"{leader}{mark}{words}</text>")


def _axes(across: Scale, up: Scale, span: tuple[float, float], floor: int, peer: str) -> str:
    """Lines and words of the two axes."""
    parts = []
    for level in range(floor, max(LEVELS) + 1):
        y, word = up(level), "none" if level < 0 else f"{level} {LEVELS[level][0]}"
        parts.append(_line(LEFT, WIDTH - RIGHT, y, y))
        parts.append(_word(LEFT - 8, y + 4, "end", word))
    for power in range(int(span[0]) - 1, int(span[1]) + 2):
        if span[0] <= power <= span[1] and power % 2 == 0:
            x, word = across(2.0**power), f"{2.0**power:g} ×"
            parts.append(_line(x, x, TOP, HEIGHT - BOTTOM))
            parts.append(_word(x, HEIGHT - BOTTOM + 16, "middle", word))
    words = f"time beside {escape(peer)}: faster to the right"
    middle = (LEFT + WIDTH - RIGHT) / 2
    parts.append(_word(middle, HEIGHT - 6, "middle", words))
    return "".join(parts)


def _line(x1: float, x2: float, y1: float, y2: float) -> str:
    """A line of the grid."""
    return f'<line class="grid" x1="{x1:.1f}" x2="{x2:.1f}" y1="{y1:.1f}" y2="{y2:.1f}"/>'


def _word(x: float, y: float, anchor: str, word: str) -> str:
    """A word of an axis."""
    return f'<text class="tick" x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{word}</text>'


def _kind(point: Point) -> str:
    """The class of a point."""
    return "ours" if point.ours else "theirs"


def _linked(point: Point, inner: str) -> str:
    """What is drawn of a point, as a link that says its name."""
    said = f"{escape(point.name)}: {point.ratio:.2g} times the time, height {point.height:.2f}"
    return f'<a href="{escape(point.link)}" aria-label="{said}">{inner}</a>'
