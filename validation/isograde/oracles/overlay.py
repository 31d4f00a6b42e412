"""Whether two meshes are the same, as far as an implementation can be asked for it.

Two answers to one question are laid over each other in index coordinates. Vertices of either that
are within a tolerance of each other, chained, get one name; numbering does not count. Then either
all oriented simplices are compared, as a multiset, or only what a family of implementations cannot
help but agree on when a field is turned: where dual methods put their vertices and which cells they
join, or where the mesh crosses the edges of a split.

Glossary
--------
name        what vertices of both meshes at one place have in common
row         the names of a simplex, ascending, with the parity of the permutation that sorts them
"""

from __future__ import annotations

import numpy as np
from isoref.field import Booleans, Floats, Integers

from isograde.oracles.complexes import Complex, parity
from isograde.oracles.rows import components_of, distinct, in_order, near_pairs


def names(one: Floats, other: Floats, tolerance: float) -> tuple[Integers, Integers]:
    """A name for each place of two sets; places within the tolerance, chained, have the same.

    >>> [x.tolist() for x in names(np.array([[0.0], [1.0]]), np.array([[1 + 1e-9]]), 1e-6)]
    [[0, 1], [1]]
    """
    points = np.concatenate([one, other]) + 0.0
    first, name = distinct(points)
    near = near_pairs(points[first], tolerance, along_axes=True)
    name = components_of(len(first), near)[1][name]
    return name[: len(one)], name[len(one) :]


def unmatched(one: Complex, other: Complex, tolerance: float) -> tuple[Integers, Integers]:
    """Simplices of either mesh, by number, that the other does not have as often, turned the same.

    Simplices whose vertices are within the tolerance of each other have no part in it.
    """
    first, second = names(one.points, other.points, tolerance)
    rows = [_rows(mesh.simplices, name) for mesh, name in ((one, first), (other, second))]
    first_of, group = distinct(np.concatenate([row for row, _ in rows]))
    mine, theirs = group[: len(rows[0][0])], group[len(rows[0][0]) :]
    size = len(first_of)
    count = np.bincount(mine, minlength=size) - np.bincount(theirs, minlength=size)
    return rows[0][1][count[mine] > 0], rows[1][1][count[theirs] < 0]


def _rows(simplices: Integers, name: Integers) -> tuple[Integers, Integers]:
    """The rows of the simplices that do not collapse, their parity last, and their numbers."""
    named = name[simplices]
    ordered = np.sort(named, axis=1)
    whole = np.flatnonzero((ordered[:, 1:] != ordered[:, :-1]).all(axis=1))
    kept = named[whole]
    turned = parity(kept)[:, None] if kept.shape[1] > 1 else np.ones((len(kept), 1), np.int64)
    return np.concatenate([ordered[whole], turned], axis=1), whole


def lonely(one: Floats, other: Floats, tolerance: float) -> tuple[Integers, Integers]:
    """Places of either set, by number, without one of the other set within the tolerance."""
    # Most often the sets are the same, and in order each place is next to its own.
    if one.shape == other.shape and len(one):
        ordered = (places.take(in_order(places), axis=0) for places in (one, other))
        if (np.abs(np.subtract(*ordered)) <= tolerance).all():
            return np.empty(0, np.int64), np.empty(0, np.int64)
    first, second = names(one, other, tolerance)
    return np.flatnonzero(~np.isin(first, second)), np.flatnonzero(~np.isin(second, first))


def edges(mesh: Complex) -> Integers:
    """(e, 2) the distinct edges of the simplices."""
    if mesh.k < 1:
        return np.empty((0, 2), np.int64)
    rows: Integers = mesh.faces()[1][0]
    return rows


def unmatched_edges(
    one: Complex, other: Complex, kept: tuple[Booleans, Booleans], tolerance: float
) -> tuple[Integers, Integers]:
    """The kept edges of either mesh that are no edges of the other.

    `kept` marks, for each mesh, the rows of `edges` that are to be found again; they are looked for
    among all edges of the other.
    """
    first, second = names(one.points, other.points, tolerance)
    mine, theirs = edges(one), edges(other)
    count = max(first.max(initial=0), second.max(initial=0)) + 1
    keys = []
    for rows, name in ((mine, first), (theirs, second)):
        ends = np.sort(name[rows], axis=1)
        keys.append(ends[:, 0] * count + ends[:, 1])
    alone = []
    for i, (rows, name) in enumerate(((mine, first), (theirs, second))):
        real = name[rows[:, 0]] != name[rows[:, 1]]
        alone.append(rows[kept[i] & real & ~np.isin(keys[i], keys[1 - i])])
    return alone[0], alone[1]
