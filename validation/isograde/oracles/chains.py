"""Segments joined into curves.

A curve runs through vertices that just two segments share; it ends at every other vertex, or comes
back to where it began. It is walked along its segments, from their first vertex to their second,
where these agree.

Glossary
--------
end      a vertex that one segment names, or more than two
curve    indices of vertices in order; a closed one repeats its first
"""

from __future__ import annotations

import numpy as np
from isoref.field import Integers


def curves_of(segments: Integers) -> list[Integers]:
    """The curves that these (S, 2) segments make up, each segment in one: open ones first.

    >>> [curve.tolist() for curve in curves_of(np.array([[0, 1], [5, 6], [2, 0], [6, 5], [1, 2]]))]
    [[0, 1, 2, 0], [5, 6, 5]]
    """
    touching: dict[int, list[int]] = {}
    for number, pair in enumerate(segments.tolist()):
        for vertex in pair:
            touching.setdefault(vertex, []).append(number)
    walked = np.zeros(len(segments), bool)
    ends = [number for numbers in touching.values() if len(numbers) != 2 for number in numbers]
    found = []
    for number in [*sorted(set(ends)), *range(len(segments))]:
        if not walked[number]:
            found.append(_walk(number, segments, touching, walked))
    return found


def _walk(
    number: int, segments: Integers, touching: dict[int, list[int]], walked: np.ndarray
) -> Integers:
    """The curve through this segment, which is an end's if its curve has ends."""
    first, second = (int(vertex) for vertex in segments[number])
    # Begin at the end; where both or none are one, go the way the segment points.
    starts_here = len(touching[first]) != 2 or len(touching[second]) == 2
    curve = [first, second] if starts_here else [second, first]
    walked[number] = True
    while len(touching[curve[-1]]) == 2 and curve[-1] != curve[0]:
        number = next(one for one in touching[curve[-1]] if not walked[one])
        walked[number] = True
        one, other = (int(vertex) for vertex in segments[number])
        curve.append(other if one == curve[-1] else one)
    return np.array(curve if starts_here else curve[::-1], np.int64)
