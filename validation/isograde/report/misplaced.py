"""Where vertices stand instead of on the crossings of the lattice's edges, in one sentence.

The crossings follow from the samples alone. A mistake in placing moves all vertices by one map of
the axes: scaled, shifted, reversed, or the share of the way along each edge exchanged for another
one. Each of the maps below is tried, and one is named only where it puts the vertices on crossings
and leaving them where they are does not.

A small answer may be explained by several maps: a corner that is cut off looks the same with two
axes exchanged. `shared` names what explains all of several answers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np
from isoref.field import Floats, Integers
from scipy.spatial import KDTree

from isograde.checking.sentences import axes_exchanged, scaled

# Call a vertex right up to so far from a crossing, in cells; a map right for so many of them.
NEAR, MOST = 1e-4, 0.9
# Try every order of so many axes.
MOST_AXES = 4
Shift = tuple[str, Floats, Floats]


@dataclass(frozen=True, eq=False)
class Placed:
    """The vertices (V, n) of an answer, in index coordinates, with the samples it is of."""

    vertices: Floats
    values: Floats
    isovalue: float
    spacing: Floats


def misplacement(
    vertices: Floats, values: Floats, isovalue: float, spacing: Floats, *, shares: bool = True
) -> str:
    """What moves the vertices (V, n), in index coordinates, off the crossings; or nothing.

    `shares` : say so where single vertices stand at a wrong share of the way along their edges
    """
    low, high, share = crossings(values, isovalue)
    if not len(low) or not len(vertices):
        return ""
    right = np.asarray(low + share[:, None] * (high - low), np.float64)
    if _agree(vertices, right) <= 1 - MOST:
        if told := explanations(Placed(vertices, values, isovalue, spacing)):
            return told[0]
        if np.mean(np.abs(vertices - np.rint(vertices)).max(axis=1) < NEAR) > MOST:
            return "vertices stand on samples, not on the crossings of the edges between them"
    return _by_share(vertices, low, high, share) if shares else ""


def shared(answer: Placed, others: Sequence[Placed], *, kuhn: bool = False) -> str | None:
    """The simplest that explains this answer and the others, "" where no map is needed; or None.

    Of the others, one that nothing explains has another fault, and does not count.
    """
    found = [told for one in others if (told := explanations(one, kuhn=kuhn))]
    mine = explanations(answer, kuhn=kuhn)
    return next((told for told in mine if all(told in each for each in found)), None)


def explanations(answer: Placed, *, kuhn: bool = False) -> list[str]:
    """Each map that puts the vertices on the crossings, "" for none needed; the simplest first.

    `kuhn` : on those of the edges of Kuhn's split, which has the diagonals too
    """
    low, high, share = crossings(answer.values, answer.isovalue, kuhn=kuhn)
    if not len(low) or not len(answer.vertices):
        return []
    right = np.asarray(low + share[:, None] * (high - low), np.float64)
    shape = np.array(answer.values.shape, float)
    found = [""] if _agree(answer.vertices, right) >= MOST else []
    for axes, said in ((slice(None), ""), (slice(None, None, -1), "in reversed order of the axes")):
        if said and _agree(answer.vertices[:, axes], right) >= MOST:
            found.append(f"vertices are given {said}")
        for told, scale, shift in _maps(shape, answer.spacing):
            if _agree((answer.vertices[:, axes] - shift) / scale, right) >= MOST:
                found.append(f"vertices are {told}{', and ' + said if said else ''}")
    return found + list(_by_order(answer.vertices, right, answer.spacing))


def on_diagonals(answer: Placed) -> int:
    """How many vertices stand on a diagonal of Kuhn's split, at its crossing."""
    low, high, share = crossings(answer.values, answer.isovalue, kuhn=True)
    diagonal = (high - low).sum(axis=1) > 1
    if not diagonal.any():
        return 0
    right = np.asarray(low + share[:, None] * (high - low), np.float64)[diagonal]
    return int(np.count_nonzero(KDTree(right).query(answer.vertices)[0] < NEAR))


def crossings(
    values: Floats, isovalue: float, *, kuhn: bool = False
) -> tuple[Integers, Integers, Floats]:
    """The ends (r, n) of the crossed lattice edges, and the share of the way to each crossing.

    `kuhn` : and of the diagonals of Kuhn's split, which lead up along several axes at once
    """
    ends, shares = [], []
    for step in sorted(product((0, 1), repeat=values.ndim), reverse=True):
        if not sum(step) or (sum(step) > 1 and not kuhn):
            continue
        before = values[tuple(slice(0, n - s) for n, s in zip(values.shape, step, strict=True))]
        after = values[tuple(slice(s, None) for s in step)]
        at = np.argwhere((before >= isovalue) != (after >= isovalue))
        a, b = before[tuple(at.T)], after[tuple(at.T)]
        ends.append(np.stack([at, at + np.array(step)]))
        shares.append((isovalue - a) / (b - a))
    low, high = np.concatenate(ends, axis=1)
    return low, high, np.concatenate(shares)


def _agree(vertices: Floats, right: Floats) -> float:
    """The part of the vertices and of the crossings that are near one another."""
    if not np.isfinite(vertices).all():
        return 0.0
    to, back = KDTree(right).query(vertices)[0], KDTree(vertices).query(right)[0]
    return float(min(np.mean(to < NEAR), np.mean(back < NEAR)))


def _maps(shape: Floats, spacing: Floats) -> Iterator[Shift]:
    """What is said, the factor and the shift of each mistake, in index coordinates."""
    one, none = np.ones(len(shape)), np.zeros(len(shape))
    cells = np.maximum(shape - 1, 1)
    yield scaled(), shape / cells, none
    yield scaled(up=False), cells / shape, none
    yield "drawn in the unit cube: divided by n-1", 1 / cells, none
    yield "drawn in a cube from -1 to 1", 2 / cells, -one
    for told, by in (("half a cell", 0.5), ("a whole cell", 1.0)):
        yield f"shifted by {told} along every axis", one, by * one
        yield f"shifted by {told} against every axis", one, -by * one
        if np.any(spacing != 1):
            in_units = told.replace("cell", "unit of length")
            yield f"shifted by {in_units} along every axis", one, by / spacing
            yield f"shifted by {in_units} against every axis", one, -by / spacing
    yield "centred at 0: (n-1)/2 cells are taken off", one, -(shape - 1) / 2
    if np.any(spacing != 1):
        yield "not multiplied by the spacing", 1 / spacing, none
        yield "multiplied by the spacing twice", spacing, none
        yield "multiplied by the first spacing on every axis", spacing[0] / spacing, none


def _by_order(vertices: Floats, right: Floats, spacing: Floats) -> Iterator[str]:
    """The orders of the axes in which the vertices may be given; reversed is one too."""
    n = len(spacing)
    if n > MOST_AXES:
        return
    for order in list(permutations(range(n)))[1:]:
        taken = list(order)
        if _agree(vertices[:, taken], right) >= MOST:
            yield axes_exchanged(order)
        if _agree((vertices * spacing)[:, taken] / spacing, right) >= MOST:
            yield axes_exchanged(order, of="vertices")


def _by_share(vertices: Floats, low: Integers, high: Integers, share: Floats) -> str:
    """What is wrong with the shares of the way along their edges, or nothing."""
    found, right = shares_of(vertices, low, high, share)
    wrong = np.abs(found - right) > NEAR
    if not wrong.any():
        return ""
    where = "vertices stand" if wrong.all() else f"{wrong.sum()} of {len(found)} vertices stand"
    found, right = found[wrong], right[wrong]
    for told, other in (
        (
            "at 1 - t of their edges, where the crossing is at t: the two ends are exchanged",
            1 - right,
        ),
        ("halfway along their edges, wherever the crossing is", np.full(len(right), 0.5)),
    ):
        if (np.abs(found - other) < NEAR).mean() >= MOST:
            return f"{where} {told}"
    worst = int(np.abs(found - right).argmax())
    return (
        f"{where} on the right edges at a wrong share of the way: {found[worst]:.4g}, "
        f"where the crossing is at {right[worst]:.4g}"
    )


def shares_of(
    vertices: Floats, low: Integers, high: Integers, share: Floats
) -> tuple[Floats, Floats]:
    """For the vertices that stand on one crossed edge: the share of the way found, and right."""
    found, right = [], []
    for a, b, t in zip(low, high, share, strict=True):
        axis = int(np.argmax(b - a))
        beside = np.delete(np.abs(vertices - a), axis, axis=1).max(axis=1, initial=0.0) < NEAR
        along = vertices[:, axis] - a[axis]
        on = beside & (along > -NEAR) & (along < 1 + NEAR)
        found += along[on].tolist()
        right += [float(t)] * int(on.sum())
    return np.array(found), np.array(right)
