"""Rows that are the same, places that nearly are, and what pairs of them join.

What NumPy and SciPy have for this is made for large arrays: rows are compared as records, a tree is
grown, a graph is checked and copied. Claims ask it thousands of times of some hundred rows, where a
few sorts are several times faster; on large arrays they are no slower.

Places
------
Two places within a tolerance of each other are within a known reach of each other on any line on
to which they are projected. The direction is one in which no two samples of a lattice fall
together, so next to nobody else is that near: sort by it, and look at neighbours.
"""

from __future__ import annotations

import numpy as np
from isoref.field import Array, Floats, Integers

# Square roots of primes: no sum of whole multiples of them is zero.
WIDEST, FEW = 62, 256
"""Bits of a key, and rows whose columns are not put together."""

PORTION = 1 << 16
"""Pairs that are looked at at once."""

DIRECTION = np.sqrt([2.0, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37])


def distinct(rows: Array) -> tuple[Integers, Integers]:
    """(d,) the first of each distinct row, these in ascending order, and (n,) which each row is.

    >>> [x.tolist() for x in distinct(np.array([[1, 2], [0, 5], [1, 2]]))]
    [[1, 0], [1, 0, 1]]
    """
    count = len(rows)
    keys = _keys(rows) if rows.dtype.kind == "i" and count > FEW else list(rows.T)
    order = np.lexsort(keys[::-1])
    new = np.zeros(count, bool)
    new[:1] = True
    if count <= FEW:
        few = rows[order]
        new[1:] = (few[1:] != few[:-1]).any(axis=1)
    else:
        for key in keys:
            ordered = key[order]
            new[1:] |= ordered[1:] != ordered[:-1]
    name = np.empty(count, np.int64)
    name[order] = np.cumsum(new) - 1
    return order[new], name


def _keys(rows: Integers) -> list[Integers]:
    """Columns in the same order as those of `rows`, as many of these in one as it can hold."""
    low, high = rows.min(axis=0).tolist(), rows.max(axis=0).tolist()
    keys: list[Integers] = []
    held = 1 << WIDEST
    for column, least, most in zip(rows.T, low, high, strict=True):
        span = most - least + 1
        held *= span
        if held < 1 << WIDEST:
            keys[-1] = keys[-1] * span + (column - least)
        else:
            keys.append(column.astype(np.int64))
            held = span
    return keys


def in_order(places: Floats) -> Integers:
    """(n,) the places in their order along a line on which no two samples fall together."""
    return np.argsort(places @ DIRECTION[: places.shape[1]])


def near_pairs(places: Floats, tolerance: float, *, along_axes: bool = False) -> Integers:
    """(2, r) pairs of places within the tolerance of each other.

    along_axes : the distance is the largest along an axis; else it is Euclid's

    >>> near_pairs(np.array([[0.0, 0], [3, 3], [0, 0.25]]), 0.5).tolist()
    [[0], [2]]
    """
    direction = DIRECTION[: places.shape[1]]
    key = places @ direction
    order = np.argsort(key, kind="stable")
    key = key[order]
    reach = tolerance * float(direction.sum())
    reach += 1e-14 * float(np.abs(places).max(initial=0.0)) * float(direction.sum())
    step, at, found = 1, np.arange(len(key)), [np.empty((2, 0), np.int64)]
    while len(at):
        at = at[at + step < len(key)]
        at = at[key[at + step] - key[at] <= reach]
        one, other = order[at], order[at + step]
        apart = places[one] - places[other]
        near = (
            np.abs(apart).max(axis=1, initial=0.0) <= tolerance
            if along_axes
            else (apart * apart).sum(axis=1) <= tolerance * tolerance
        )
        found.append(np.stack([one[near], other[near]]))
        step += 1
    return np.concatenate(found, axis=1)


def components_of(nodes: int, pairs: Integers) -> tuple[int, Integers]:
    """Number of components of the graph with these (2, n) pairs, and each node's component.

    Components are numbered in the order of their first nodes. Every node has a label, a node of its
    own component, at first itself. Labels that a pair shows to be of one component are made one,
    the lower, and each node then takes the label of its label, until that is its own. What is asked
    next are the pairs of labels that were not one, in portions that stay in the processor's cache.

    >>> components_of(4, np.array([[3, 1], [1, 0]]))
    (2, array([0, 0, 1, 0]))
    """
    label = np.arange(nodes)
    one, other = pairs
    while True:
        open_ = []
        for at in range(0, len(one), PORTION):
            first, second = (x[at : at + PORTION] for x in (one, other))
            first, second = label.take(first), label.take(second)
            rows = (first != second).nonzero()[0]
            if len(rows):
                first, second = first.take(rows), second.take(rows)
                np.minimum.at(label, np.maximum(first, second), np.minimum(first, second))
                open_.append((first, second))
        if not open_:
            break
        while not np.array_equal(label, further := label.take(label)):
            label = further
        one, other = (np.concatenate(x) for x in zip(*open_, strict=True))
    number = np.cumsum(label == np.arange(nodes)) - 1
    return int(number[-1]) + 1 if nodes else 0, number[label]
