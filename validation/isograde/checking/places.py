"""Where a surface is instead of where it should be, and the mistake that would put it there."""

from __future__ import annotations

import numpy as np
from isoref.field import Field, Floats

from isograde.model import Outcome


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
    centre = (shape - 1) / 2 + np.array([0.1, -0.1, 0.2, -0.2, 0.15, -0.15])[:n]
    reach = np.zeros(n)
    reach[: n - field.components + 1] = 3**0.5
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
        "indices are scaled by n / (n - 1): index * spacing, not index / (n - 1) * n": (
            right * shape / (shape - 1) * steps
        ),
        "indices are scaled by (n - 1) / n": right * (shape - 1) / shape * steps,
        "it is drawn in the unit cube: vertices * (n - 1) * spacing": right / (shape - 1),
        "it is drawn in a cube from -1 to 1": 2 * right / (shape - 1) - 1,
        "the lattice is centred at 0: add (n - 1) / 2 * spacing": (right - (shape - 1) / 2) * steps,
        "the lattice is centred at 0: add (n - 1) / 2": right - (shape - 1) / 2,
    }
    for order, said in ((slice(None), ""), (slice(None, None, -1), ", and axes are reversed")):
        # Let a guess explain the place to a part of what it changes.
        off = {told: float(np.abs(found[:, order] - box).max()) for told, box in guesses.items()}
        best = min(off, key=lambda told: off[told])
        if off[best] < 0.12 * float(np.ptp(guesses[best], axis=0).max()):
            return best + said
    return ""
