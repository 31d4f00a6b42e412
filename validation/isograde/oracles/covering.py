"""Facets that lie on other facets: two cuts of one face.

Where two simplices met in a face and cut it differently, each facet of one cut has its centroid on
a facet of the other. Nothing here knows how the mesh was made.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from isoref.field import Booleans, Floats, Integers
from scipy.spatial import KDTree

from isograde.oracles.complexes import Complex


def inner_open_facets(mesh: Complex, box: Sequence[Sequence[float]]) -> Integers:
    """The facets (F, k) of one simplex that lie in no face of the box (lowest, highest corner)."""
    low, high = np.asarray(box, np.float64)
    slack = 1e-9 * (high - low).max()
    rows = mesh.facets.rows[mesh.facets.uses == 1]
    place = mesh.points[rows]
    at_low = (abs(place - low) <= slack).all(axis=1)
    at_high = (abs(place - high) <= slack).all(axis=1)
    return np.asarray(rows[~(at_low | at_high).any(axis=1)])


def covered(vertices: Floats, rows: Integers) -> Booleans:
    """Which of these facets have their centroid on another one of them."""
    out = np.zeros(len(rows), bool)
    if not len(rows):
        return out
    place = vertices[rows]
    centroid = place.mean(axis=1)
    low, high = place.min(axis=1), place.max(axis=1)
    radius = np.linalg.norm(place - centroid[:, None], axis=2).max(axis=1) * (1 + 1e-9)
    near = KDTree(centroid).query_ball_point(centroid, radius)
    other = np.repeat(np.arange(len(rows)), [len(found) for found in near])
    own = np.concatenate([np.asarray(found, np.int64) for found in near])
    slack = 1e-9 * radius[other, None]
    boxed = (low[other] - slack <= centroid[own]) & (centroid[own] <= high[other] + slack)
    pairs = np.flatnonzero(boxed.all(axis=1) & (own != other))
    hit = contain(place[other[pairs]], centroid[own[pairs]])
    out[own[pairs[hit]]] = True
    return out


def contain(corners: Floats, points: Floats, slack: float = 1e-7) -> Booleans:
    """Whether each simplex, corners (P, k, d), contains its point (P, d), up to rounding.

    >>> contain(np.array([[[0.0, 0.0], [2.0, 0.0]]]), np.array([[1.0, 0.0]])).tolist()
    [True]
    """
    scale = abs(corners - corners[:, :1]).max(axis=(1, 2), initial=1e-300)
    edges = (corners[:, 1:] - corners[:, :1]) / scale[:, None, None]
    offset = (points - corners[:, 0]) / scale[:, None]
    weights = (offset[:, None] @ np.linalg.pinv(edges))[:, 0]
    flat = abs((weights[:, None] @ edges)[:, 0] - offset).max(axis=1) <= slack
    return np.asarray(flat & (weights >= -slack).all(axis=1) & (weights.sum(axis=1) <= 1 + slack))
