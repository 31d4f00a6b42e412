"""Plots as SVG: curves on logarithmic scales, and ratios with their spread.

A plot stands by itself or inside a page: it brings its own colours, for light and dark, and takes
those of the page's style sheet where there is one. Its words are text, so that they are found by a
search and read aloud; what is drawn is also in a table beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from html import escape
from math import ceil, floor, log10
from typing import NamedTuple

WIDTH, HEIGHT = 480, 330
LEFT, RIGHT, BOTTOM = 58, 14, 46
KEY_ROW, KEY_COLUMNS = 17, 2
BAR_ROW, LETTER, MOST_LEFT = 22, 6.9, 250
COLOURS = ("front", "back", "crowd", "good", "bad")
STYLE = """
.plot{--p-ink:var(--ink,#1b1f24);--p-soft:var(--soft,#5c6570);--p-line:var(--line,#e3e4df);
--p-card:var(--card,#fff);--p-front:var(--front,#4f86c6);--p-back:var(--back,#e0973d);
--p-crowd:var(--crowd,#8436b0);--p-good:var(--good,#1f7a4d);--p-bad:var(--bad,#b3261e);
width:100%;height:auto;font-family:var(--sans,system-ui,"DejaVu Sans",sans-serif)}
@media screen and (prefers-color-scheme:dark){.plot{
--p-ink:var(--ink,#e8e9e6);--p-soft:var(--soft,#9aa3ad);
--p-line:var(--line,#2d3339);--p-card:var(--card,#1b1f23);--p-crowd:var(--crowd,#c58bea);
--p-good:var(--good,#5cc08d);--p-bad:var(--bad,#ff8a80)}}
.plot .back{fill:var(--p-card)}.plot .grid{stroke:var(--p-line)}.plot .one{stroke:var(--p-soft)}
.plot text{font-size:12.5px;fill:var(--p-soft)}.plot .title{fill:var(--p-ink);font-weight:600}
.plot polyline,.plot .spread{fill:none;stroke-width:2;stroke-linejoin:round}
.plot .dashed{stroke-dasharray:5 4}.plot circle.hollow{fill:var(--p-card);stroke-width:1.8}
""" + "".join(
    f".plot .s-{name}{{stroke:var(--p-{name})}}.plot .f-{name}{{fill:var(--p-{name});"
    f"stroke:var(--p-{name})}}"
    for name in COLOURS
)
Scale = Callable[[float], float]


class Series(NamedTuple):
    """A curve: its name, its points (x, y), all above 0, its colour, and whether it is dashed."""

    name: str
    points: Sequence[tuple[float, float]]
    colour: int = 0
    dashed: bool = False


class Bar(NamedTuple):
    """A ratio with its quartiles, all above 0, and what it is of."""

    name: str
    middle: float
    low: float
    high: float
    colour: int = 0


def curves(title: str, across: str, up: str, series: Sequence[Series]) -> str:
    """Curves on logarithmic scales, or nothing where there are no points.

    `across` and `up` say what the axes are, with the unit.
    """
    drawn = [one for one in series if one.points]
    if not drawn:
        return ""
    top = 34 + KEY_ROW * ceil(len(drawn) / KEY_COLUMNS)
    height = HEIGHT + top - 34
    xs = [x for one in drawn for x, _ in one.points]
    ys = [y for one in drawn for _, y in one.points]
    x, x_ticks = _scale(xs, LEFT, WIDTH - RIGHT)
    y, y_ticks = _scale(ys, height - BOTTOM, top)
    parts = [_word(LEFT - 44, 18, title, "start", "title")]
    parts += [_key(number, one) for number, one in enumerate(drawn)]
    for tick in x_ticks:
        parts.append(_line(x(tick), x(tick), top, height - BOTTOM))
        parts.append(_word(x(tick), height - BOTTOM + 16, short(tick), "middle"))
    for tick in y_ticks:
        parts.append(_line(LEFT, WIDTH - RIGHT, y(tick), y(tick)))
        parts.append(_word(LEFT - 6, y(tick) + 4, short(tick), "end"))
    parts.append(_word((LEFT + WIDTH - RIGHT) / 2, height - 8, across, "middle"))
    parts.append(
        f'<text transform="translate(13 {(top + height - BOTTOM) / 2:.1f}) rotate(-90)" '
        f'text-anchor="middle">{escape(up)}</text>'
    )
    for one in drawn:
        places = [(x(a), y(b)) for a, b in one.points]
        joined = " ".join(f"{a:.1f},{b:.1f}" for a, b in places)
        dashed = " dashed" if one.dashed else ""
        parts.append(f'<polyline class="{_stroke(one.colour)}{dashed}" points="{joined}"/>')
        for (a, b), (told_x, told_y) in zip(places, one.points, strict=True):
            said = f"{one.name}: {short(told_x)}, {short(told_y)}"
            mark = f"{_fill(one.colour)}{' hollow' if one.dashed else ''}"
            parts.append(
                f'<circle class="{mark}" cx="{a:.1f}" cy="{b:.1f}" r="3.4">'
                f"<title>{escape(said)}</title></circle>"
            )
    return _svg(f"{title}: {up} against {across}", height, parts)


def bars(title: str, across: str, rows: Sequence[Bar]) -> str:
    """Ratios on a logarithmic scale, each with its quartiles; a line where they are 1."""
    top, height = 34, 34 + BAR_ROW * len(rows) + BOTTOM
    values = [number for row in rows for number in (row.low, row.middle, row.high)]
    left = min(MOST_LEFT, 24 + LETTER * max((len(row.name) for row in rows), default=0))
    x, ticks = _scale([*values, 1.0], left, WIDTH - RIGHT - 40)
    parts = [_word(LEFT - 44, 18, title, "start", "title")]
    for tick in ticks:
        parts.append(_line(x(tick), x(tick), top, height - BOTTOM))
        parts.append(_word(x(tick), height - BOTTOM + 16, short(tick), "middle"))
    parts.append(_line(x(1.0), x(1.0), top, height - BOTTOM, "one"))
    for number, row in enumerate(rows):
        y = top + BAR_ROW * (number + 0.5)
        parts.append(_word(left - 10, y + 4, row.name, "end"))
        spread = _line(x(row.low), x(row.high), y, y, f"spread {_stroke(row.colour)}")
        parts.append(spread)
        parts.append(
            f'<circle class="{_fill(row.colour)}" cx="{x(row.middle):.1f}" cy="{y:.1f}" r="4"/>'
        )
        parts.append(_word(x(row.high) + 9, y + 4, f"{row.middle:.2f}", "start"))
    parts.append(_word((left + WIDTH - RIGHT) / 2, height - 8, across, "middle"))
    return _svg(f"{title}: {across}", height, parts)


def short(number: float) -> str:
    """A number in few characters.

    >>> [short(n) for n in (0.0002, 0.05, 1.0, 4096, 2_097_152)]
    ['2e-4', '0.05', '1', '4.1k', '2.1M']
    """
    if number == 0:
        return "0"
    for unit, size in (("G", 1e9), ("M", 1e6), ("k", 1e3)):
        if abs(number) >= size:
            return (
                f"{number / size:.2g}{unit}"
                if number < 100 * size
                else f"{number / size:.0f}{unit}"
            )
    if abs(number) < 1e-3:
        digits, _, power = f"{number:.0e}".partition("e")
        return f"{digits}e{int(power)}"
    return f"{number:.2g}" if number < 100 else f"{number:.0f}"


def _scale(values: Sequence[float], first: float, last: float) -> tuple[Scale, list[float]]:
    """A logarithmic scale on which the values lie, and the ticks to draw: few round numbers."""
    low, high = (log10(value) for value in (min(values), max(values)))
    margin = max(0.04 * (high - low), 0.02)
    low, high = low - margin, high + margin

    def place(value: float) -> float:
        return first + (log10(value) - low) / (high - low) * (last - first)

    steps = (1, 2, 5) if high - low < 2.2 else (1,)
    if high - low < 0.6:
        steps = (1, 1.5, 2, 3, 4, 5, 7)  # type: ignore[assignment]
    every = max(1, ceil((high - low) / 6))
    powers = range(floor(low), ceil(high) + 1)
    ticks = [
        step * 10.0**power
        for power in powers
        if power % every == 0
        for step in steps
        if low <= log10(step) + power <= high
    ]
    return place, ticks


def _svg(told: str, height: float, parts: Sequence[str]) -> str:
    """The picture with its style."""
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" class="plot" viewBox="0 0 {WIDTH} {height:.0f}" '
        f'role="img" aria-label="{escape(told)}"><style>{STYLE}</style>'
        f'<rect class="back" width="{WIDTH}" height="{height:.0f}" rx="10"/>{"".join(parts)}</svg>'
    )


def _key(number: int, one: Series) -> str:
    """The name of a curve, with a piece of it."""
    x = LEFT - 44 + (number % KEY_COLUMNS) * (WIDTH - LEFT + 44) / KEY_COLUMNS
    y = 36 + KEY_ROW * (number // KEY_COLUMNS)
    dashed = " dashed" if one.dashed else ""
    line = _line(x, x + 22, y - 4, y - 4, f"spread {_stroke(one.colour)}{dashed}")
    return line + _word(x + 28, y, one.name, "start")


def _stroke(colour: int) -> str:
    """The class of a line."""
    return f"s-{COLOURS[colour % len(COLOURS)]}"


def _fill(colour: int) -> str:
    """The class of a mark."""
    return f"f-{COLOURS[colour % len(COLOURS)]}"


def _line(x1: float, x2: float, y1: float, y2: float, kind: str = "grid") -> str:
    """A straight line."""
    return f'<line class="{kind}" x1="{x1:.1f}" x2="{x2:.1f}" y1="{y1:.1f}" y2="{y2:.1f}"/>'


def _word(x: float, y: float, text: str, anchor: str, kind: str = "") -> str:
    """Words in a plot."""
    named = f' class="{kind}"' if kind else ""
    return f'<text{named} x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(text)}</text>'
