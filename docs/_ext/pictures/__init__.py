"""Pictures for the articles, drawn by the code they explain while the site is built.

A function stands for a picture. It says beside what it belongs, draws with `isoref` alone, and
gives back the figure and the sentence below it, whose numbers it has counted::

    @beside("isoref.asymptotic_decider", "saddle")
    def hyperbolas() -> Picture:
        ...
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from matplotlib.figure import Figure


class Picture(NamedTuple):
    """A figure, and the sentence that stands below it."""

    figure: Figure
    caption: str


Draw = Callable[[], Picture]
REGISTERED: dict[str, tuple[str, Draw]] = {}


def beside(module: str, name: str = "") -> Callable[[Draw], Draw]:
    """Register a picture that belongs beside a module's text, or beside a function of it."""

    def register(draw: Draw) -> Draw:
        REGISTERED[draw.__name__] = (f"{module}.{name}" if name else module, draw)
        return draw

    return register
