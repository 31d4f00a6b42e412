"""Where a surface is instead of where it should be, and the mistake that would put it there."""

from __future__ import annotations

from itertools import permutations

import numpy as np
from isoref.field import Field, Floats

from isograde.adapters.measure import RADIUS, centre_of
from isograde.checking.sentences import axes_exchanged, scaled
from isograde.model import Outcome

# A vertex this near to a lattice edge, in cells, stands on it.
ON_EDGE = 1e-4
# Vertices on one level have values this much alike, as a share of the samples' range.
ONE_LEVEL = 0.01
# A box this near to the right one, in cells, is the right one in another order of the axes.
PERMUTED = 0.2


def misplaced(plain: Outcome, field: Field) -> str:
    """Where the surface is instead, with the mistake that would put it there."""
    assert plain.vertices is not None
    vertices = plain.vertices.astype(float)
    low, high = vertices.min(0).round(2), vertices.max(0).round(2)
    told = f"vertices lie between {low.tolist()} and {high.tolist()}: the surface is not there"
    guess = misplacement(vertices, field)
    if guess:
        return f"{told}; {guess}"
    return f"{told}, whatever the order of the axes, scaled or not; vertex = index * spacing"


def misplacement(vertices: Floats, field: Field) -> str:
    """The mistake that explains where the vertices of `ball` are, or nothing."""
    n, shape = field.dimension, np.asarray(field.shape, float)
    steps = np.asarray(field.spacing)
    centre = centre_of(n)
    reach = np.zeros(n)
    reach[: n - field.components + 1] = RADIUS
    right = np.stack([centre - reach, centre + reach])
    found = np.stack([vertices.min(0), vertices.max(0)])
    guesses = {
        "half a cell is added to each index: subtract spacing / 2": (right + 0.5) * steps,
        "half a cell is taken from each index: add spacing / 2": (right - 0.5) * steps,
        "half a cell is added to each index: subtract 0.5": right + 0.5,
        "half a cell is taken from each index: add 0.5": right - 0.5,
        "a sample is added to each index, as if the field were padded: subtract spacing": (
            (right + 1) * steps
        ),
        "a sample is added to each index, as if the field were padded: subtract 1": right + 1,
        f"vertices are {scaled()}": right * shape / (shape - 1) * steps,
        f"vertices are {scaled()}; and not by the spacing": right * shape / (shape - 1),
        f"vertices are {scaled(up=False)}": right * (shape - 1) / shape * steps,
        f"vertices are {scaled(up=False)}; and not by the spacing": right * (shape - 1) / shape,
        "it is drawn in the unit cube: vertices * (n - 1) * spacing": right / (shape - 1),
        "it is drawn in a cube from -1 to 1": 2 * right / (shape - 1) - 1,
        "the lattice is centred at 0: add (n - 1) / 2 * spacing": (right - (shape - 1) / 2) * steps,
        "the lattice is centred at 0: add (n - 1) / 2": right - (shape - 1) / 2,
        "the lattice is centred at 0: add n / 2 * spacing": (right - shape / 2) * steps,
        "the lattice is centred at 0: add n / 2": right - shape / 2,
        "it is scaled by the spacing twice: vertices / spacing": right * steps**2,
        "it is divided by the spacing: vertices * spacing**2": right / steps,
    }
    if told := _permuted(found, right, steps):
        return told
    for order in sorted(permutations(range(n)), key=lambda order: order != tuple(range(n))[::-1]):
        said = _order_told(order)
        tried = guesses if not said or "reversed" in said else {"": right * steps, **guesses}
        # Let a guess explain the place to a part of what it changes.
        off = {told: _off(found[:, order], box) for told, box in tried.items()}
        best = min(off, key=lambda told: off[told])
        if off[best] < 0.12 * float(np.ptp(tried[best], axis=0).max()):
            return f"{best}, and {said}" if best and said else best or said
    return ""


def _permuted(found: Floats, right: Floats, steps: Floats) -> str:
    """That the axes are exchanged and nothing else is wrong, where that explains the place."""
    n = len(steps)
    for order in list(permutations(range(n)))[1:]:
        taken = list(order)
        for told, box in (
            (axes_exchanged(order), (found / steps)[:, taken]),
            (axes_exchanged(order, of="vertices"), found[:, taken] / steps),
            (axes_exchanged(order, end=", where it is not scaled"), found[:, taken]),
        ):
            if _off(box, right) < PERMUTED:
                return told
    return ""


def _off(found: Floats, box: Floats) -> float:
    """How far two boxes are apart."""
    return float(np.abs(found - box).max())


def _order_told(order: tuple[int, ...]) -> str:
    """What is said of coordinates that have to be taken in this order; nothing where it is ours."""
    if order == tuple(range(len(order))):
        return ""
    if order == tuple(range(len(order)))[::-1]:
        return "axes are reversed"
    return f"coordinates come in another order of the axes: vertices[:, {list(order)}]"


def shifted(points: Floats, field: Field, *, widest: float = 0.2) -> str:
    """By how much the ball is off its place though its surface is near there, or nothing.

    `points` are in samples. A shift within `widest` is the method's own.
    """
    centre, n = centre_of(field.dimension), field.dimension
    middle = (points.min(0) + points.max(0)) / 2
    off = (middle - centre)[: n - field.components + 1]
    if np.abs(off).max() <= widest:
        return ""
    told = ", ".join(f"{one:+.2f}" for one in off)
    every = f"by about {off.mean():+.1f}" if np.ptp(off) < widest else f"by about ({told})"
    return f"the surface is off its place {every} cells along the axes"


def level_at(points: Floats, field: Field, isovalue: float) -> float | None:
    """The value that the samples have at all vertices, where it is one, and not the isovalue.

    `points` are in samples; asked of vertices on lattice edges, where values are linear.
    """
    if field.components > 1 or not len(points):
        return None
    values = field.values.astype(float)
    low = np.clip(np.floor(points + ON_EDGE).astype(int), 0, np.array(values.shape) - 1)
    part = np.clip(points - low, 0, 1)
    axis = part.argmax(axis=1)
    each = np.arange(len(points))
    if (np.delete(np.sort(part, axis=1), -1, axis=1) > ON_EDGE).any():
        return None
    high = low.copy()
    high[each, axis] = np.minimum(high[each, axis] + 1, np.array(values.shape)[axis] - 1)
    first, last = values[tuple(low.T)], values[tuple(high.T)]
    at = first + part[each, axis] * (last - first)
    span = float(np.ptp(values))
    if np.ptp(at) > ONE_LEVEL * span or abs(at.mean() - isovalue) < ONE_LEVEL * span:
        return None
    return float(at.mean())
