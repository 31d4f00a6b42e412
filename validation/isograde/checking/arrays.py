"""What is wrong with the arrays of an answer, and what to do."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isograde.model import Kind, Outcome

Array = NDArray[Any]


def malformed(outcome: Outcome, kind: Kind) -> Iterator[str]:
    """What is wrong with the arrays of an answer, and what to do."""
    vertices, rows = outcome.vertices, outcome.simplices
    assert vertices is not None
    assert rows is not None
    yield from _misshaped("vertices", vertices, kind.n, "coordinates")
    yield from _misshaped("simplices", rows, kind.k + 1, "indices")
    if vertices.size == 0 or rows.size == 0:
        yield "it gave nothing for a ball in the middle of the field: is the isovalue used?"
        return
    if vertices.dtype.kind == "f" and not np.isfinite(vertices).all():
        yield "vertices have coordinates that are NaN or infinite"
    if rows.dtype.kind not in "iu":
        yield f"simplices are {rows.dtype}, not integers<: simplices.astype(int)>"
    elif rows.min() == 1 and rows.max() == len(vertices):
        yield "simplices count vertices from 1: subtract 1"
    elif rows.min() < 0 or rows.max() >= len(vertices):
        yield (
            f"simplices name vertices {rows.min()} to {rows.max()}, "
            f"but there are {len(vertices)}, counted from 0"
        )


def _misshaped(name: str, array: Array, width: int, what: str) -> Iterator[str]:
    """Why an array is not rows of so many numbers, and what to do."""
    if array.ndim == 2 and array.shape[1] == width:
        return
    advice = f"give one row of {width} {what} each"
    if array.ndim == 2 and array.shape[0] == width:
        advice = f"it looks transposed<: {name}.T>"
    elif array.ndim == 1 and array.size % width == 0:
        advice = f"it looks flat<: {name}.reshape(-1, {width})>"
    yield f"{name} have shape {array.shape}, not (n, {width}): {advice}"


def same(one: Outcome, other: Outcome) -> bool:
    """Whether two outcomes have the same arrays."""
    pairs = (one.vertices, other.vertices), (one.simplices, other.simplices)
    return all(a is not None and b is not None and np.array_equal(a, b) for a, b in pairs)


def rows_of(outcome: Outcome) -> Array:
    """The simplices of an answer that has them."""
    assert outcome.simplices is not None
    return outcome.simplices


def doubled(outcome: Outcome, kind: Kind) -> Iterator[str]:
    """Simplices that are there more than once, corners at the same place counting as one."""
    vertices = outcome.vertices
    assert vertices is not None
    _, place = np.unique(vertices.astype(float).round(6), axis=0, return_inverse=True)
    simplices = np.sort(place.reshape(-1)[rows_of(outcome)], axis=1)
    unique, where, counts = np.unique(simplices, axis=0, return_inverse=True, return_counts=True)
    if counts.max() < 2:
        return
    twice = int((counts > 1).sum())
    word = {1: "segment", 2: "triangle"}.get(kind.k, "row")
    every = f"every {word} is" if twice == len(unique) else f"{twice} of {len(unique)} {word}s are"
    rows = place.reshape(-1)[rows_of(outcome)]
    first, second = rows[where.reshape(-1) == counts.argmax()][:2]
    ways = "both ways round" if _turned(first, second) else "the same way round"
    count = int(counts.max())
    yield f"{every} there {count} times, {ways}: are both sides drawn, or cells twice?"


def _turned(one: Array, other: Array) -> bool:
    """Whether one of two rows of the same corners is an odd permutation of the other."""
    order = [int(np.flatnonzero(one == corner)[0]) for corner in other]
    odd = sum(a > b for i, a in enumerate(order) for b in order[i + 1 :]) % 2
    return bool(odd)
