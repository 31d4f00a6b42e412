"""Triangles that have an area, and points that stand apart.

Both are asked with a margin, in units of the spacing, because the points may be a little out of
place. It is far above that, and far below what any sound triangle of a cell has (see the tests).

Glossary
--------
places      (V, 3) index coordinates of the vertices
corners     (n, 3, 3) the places of the corners of n triangles
"""

from __future__ import annotations

import numpy as np
from isoref.field import Floats, Integers
from scipy.spatial import KDTree

#: Below this a doubled area or a distance is taken for none.
MARGIN = 0.01
#: Below this it is what single precision rounds off.
ROUNDING = 1e-6


def without_area(corners: Floats, margin: float = MARGIN) -> Integers:
    """The triangles of no area, or of less than the margin.

    >>> without_area(np.array([[[0, 0, 0], [1, 1, 0], [2, 2, 0]]]))
    array([0])
    """
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled = np.linalg.norm(normals, axis=1)
    return np.flatnonzero(doubled < margin)


def together(places: Floats) -> Integers:
    """(.., 2) places that fall together, each that has a neighbour with its nearest.

    >>> together(np.array([[0, 0, 0], [1, 0, 0], [1, 1e-4, 0]])).tolist()
    [[1, 2], [2, 1]]
    """
    if len(places) < 2:
        return np.empty((0, 2), np.int64)
    distance, nearest = map(np.asarray, KDTree(places).query(places, k=2))
    close = np.flatnonzero(distance[:, 1] < MARGIN)
    # Where two coincide, either may be named as its own nearest.
    other = np.where(nearest[close, 0] == close, nearest[close, 1], nearest[close, 0])
    return np.stack([close, other], axis=1)
