"""Where vertices stand instead of on the crossings of the lattice's edges, in one sentence.

The crossings follow from the samples alone. A mistake in placing moves all vertices by one map of
the axes: scaled, shifted, reversed, or the share of the way along each edge exchanged for another
one. Each of the maps below is tried, and one is named only where it puts the vertices on crossings
and leaving them where they are does not.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations

import numpy as np
from isoref.field import Floats, Integers
from scipy.spatial import KDTree

# Call a vertex right up to so far from a crossing, in cells; a map right for so many of them.
NEAR, MOST = 1e-4, 0.9
# Try every order of so many axes.
MOST_AXES = 4
Shift = tuple[str, Floats, Floats]


def misplacement(vertices: Floats, values: Floats, isovalue: float, spacing: Floats) -> str:
    """What moves the vertices (V, n), in index coordinates, off the crossings; or nothing."""
    low, high, share = crossings(values, isovalue)
    if not len(low) or not len(vertices):
        return ""
    right = np.asarray(low + share[:, None] * (high - low), np.float64)
    if _agree(vertices, right) > 1 - MOST:
        return _by_share(vertices, low, high, share)
    for axes, said in ((slice(None), ""), (slice(None, None, -1), "in reversed order of the axes")):
        if said and _agree(vertices[:, ::-1], right) >= MOST:
            return f"vertices are given {said}"
        for told, scale, shift in _maps(np.array(values.shape, float), spacing):
            if _agree((vertices[:, axes] - shift) / scale, right) >= MOST:
                return f"vertices are {told}{', and ' + said if said else ''}"
    if told := _by_order(vertices, right, spacing):
        return told
    if np.mean(np.abs(vertices - np.rint(vertices)).max(axis=1) < NEAR) > MOST:
        return "vertices stand on samples, not on the crossings of the edges between them"
    return _by_share(vertices, low, high, share)


def crossings(values: Floats, isovalue: float) -> tuple[Integers, Integers, Floats]:
    """The ends (r, n) of the crossed lattice edges, and the share of the way to each crossing."""
    ends, shares = [], []
    for axis in range(values.ndim):
        before, after = np.moveaxis(values, axis, 0)[:-1], np.moveaxis(values, axis, 0)[1:]
        at = np.argwhere((before >= isovalue) != (after >= isovalue))
        a, b = before[tuple(at.T)], after[tuple(at.T)]
        places = np.concatenate([at[:, 1 : axis + 1], at[:, :1], at[:, axis + 1 :]], axis=1)
        ends.append(np.stack([places, places + np.eye(values.ndim, dtype=int)[axis]]))
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
    yield "scaled by n/(n-1), n the number of samples of each axis", shape / (shape - 1), none
    yield "scaled by (n-1)/n, n the number of samples of each axis", (shape - 1) / shape, none
    yield "drawn in the unit cube: divided by n-1", 1 / (shape - 1), none
    yield "drawn in a cube from -1 to 1", 2 / (shape - 1), -one
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


def _by_order(vertices: Floats, right: Floats, spacing: Floats) -> str:
    """The order of the axes in which the vertices are given, or nothing; reversed is one too."""
    n = len(spacing)
    if n > MOST_AXES:
        return ""
    for order in list(permutations(range(n)))[1:]:
        taken = f"[:, {list(order)}]"
        for told, given in (
            (f"take index{taken} and scale it then", vertices[:, order]),
            (f"take vertices{taken}", (vertices * spacing)[:, order] / spacing),
        ):
            if _agree(given, right) >= MOST:
                return f"vertices have their axes exchanged: {told}"
    return ""


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
