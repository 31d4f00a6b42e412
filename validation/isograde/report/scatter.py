"""Correctness against speed as a picture: a point an implementation, the front marked.

Across is the time beside the peer's, on a logarithmic scale, fast on the right; up is the level
reached and the share of fields that reach the next. The *front* are the points that no other beats
in one without losing in the other. Points on the front have their names in the picture; the others
have numbers, and stand with their names in the list beneath it. Each is a link.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from html import escape
from math import log2
from typing import NamedTuple

from isograde.model import LEVELS

WIDTH, HEIGHT = 720, 380
LEFT, RIGHT, TOP, BOTTOM = 96, 130, 16, 44
Scale = Callable[[float], float]
# Names of the front are kept so far apart, in pixels.
APART = 15
# A letter of a name is about so wide.
LETTER = 7.5


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
    names = {point.name for point in marked}
    taken: list[tuple[float, float, float]] = []
    others = [point for point in points if point.name not in names]
    for number, point in enumerate(others, 1):
        x, y = across(point.ratio), up(point.height)
        mark = f'<circle class="{_kind(point)}" cx="{x:.1f}" cy="{y:.1f}" r="8"/>'
        text = f'<text class="number" x="{x:.1f}" y="{y + 3.5:.1f}">{number}</text>'
        parts.append(_linked(point, mark + text))
    for point in marked:
        x, y = across(point.ratio), up(point.height)
        at = y + 4
        end = x + LETTER * (len(point.name) + 2)
        while any(
            abs(at - other) < APART and x < last and first < end for first, last, other in taken
        ):
            at += APART
        taken.append((x, end, at))
        mark = f'<circle class="{_kind(point)} best" cx="{x:.1f}" cy="{y:.1f}" r="6"/>'
        text = f'<text class="name" x="{x + 11:.1f}" y="{at:.1f}">{escape(point.name)}</text>'
        parts.append(_linked(point, mark + text))
    told = f"Correctness against speed of {len(points)} implementations; the list beneath says it."
    return (
        f'<svg class="scatter" viewBox="0 0 {WIDTH} {HEIGHT}" role="group" aria-label="{told}">'
        f"{''.join(parts)}</svg>"
    )


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
