"""What `check` and a report both say of a mistake, in the same words.

`check` asks fields of its own, a report has the answers to the plan: what they look at differs, and
so does how they find a mistake. What it is called, and what is to be done, is written here once.
"""

from __future__ import annotations

import json
from collections.abc import Sequence

WORDS = {
    "interpolant": "what it draws inside a cell",
    "vertices": "where its vertices are",
    "domain": "how the surface ends at the border",
    "mesh": "how triangles share vertices",
}
# Name so many places of a seam.
PLACES = 4


def axes_exchanged(order: Sequence[int], *, of: str = "index", end: str = "") -> str:
    """The vertices' axes come in another order than this one.

    >>> axes_exchanged([1, 0, 2])
    'axes are exchanged: vertex = index[:, [1, 0, 2]] * spacing'
    >>> axes_exchanged([1, 0, 2], of="vertices")
    'axes are exchanged: take vertices[:, [1, 0, 2]]'
    """
    taken = f"{of}[:, {list(order)}]"
    told = f"vertex = {taken} * spacing" if of == "index" else f"take {taken}"
    return f"axes are exchanged: {told}{end}"


def scaled(*, up: bool = True) -> str:
    """The vertices are stretched, or shrunk, as if n samples spanned n cells.

    >>> scaled()
    'scaled by n/(n-1), n the number of samples along each axis: index * spacing, \
not index / (n - 1) * n'
    """
    told, instead = ("n/(n-1)", "/ (n - 1) * n") if up else ("(n-1)/n", "/ n * (n - 1)")
    axis = "n the number of samples along each axis"
    return f"scaled by {told}, {axis}: index * spacing, not index {instead}"


def looks_like(word: str, found: object, now: object) -> str:
    """One of the four words is measured to be other than declared.

    >>> looks_like("interpolant", "kuhn", "multilinear")
    'what it draws inside a cell looks like "kuhn", and it declares "multilinear": \
"interpolant": "kuhn", if it is meant to be'
    """
    seen = json.dumps(found)
    told = f"{WORDS[word]} looks like {seen}, and it declares {json.dumps(now)}"
    return f'{told}: "{word}": {seen}, if it is meant to be'


def times(exponent: int) -> str:
    """How samples are presented that are multiplied by this power of two.

    >>> times(-24)
    'times 2^-24, 16777216 times smaller; is a fixed tolerance added or compared with?'
    """
    word = "smaller" if exponent < 0 else "larger"
    count = f"{2 ** abs(exponent)} times {word}"
    return f"times 2^{exponent:+d}, {count}; is a fixed tolerance added or compared with?"


def another_surface(way: str) -> str:
    """The answer to the same samples, presented in some way, is another one.

    >>> another_surface("of type float32")
    'it gives another surface for the same samples of type float32'
    """
    return f"it gives another surface for the same samples {way}"


def open_inside(axis: int, at: Sequence[float]) -> str:
    """Edges of one triangle are at these places along an axis, away from the ends.

    >>> open_inside(0, [16, 32])
    'the surface is open inside, along axis 0 at 16, 32: is there a seam between blocks or slabs, \
or a vertex that is not shared?'
    """
    told = ", ".join(f"{x:g}" for x in at[:PLACES])
    more = f" and {len(at) - PLACES} more" if len(at) > PLACES else ""
    return (
        f"the surface is open inside, along axis {axis} at {told}{more}: is there a seam between "
        "blocks or slabs, or a vertex that is not shared?"
    )
