"""Whether triangles keep apart: none without area, no two corners at one place, none that cross.

Two convex sets are apart when some axis keeps their shadows apart. Of two triangles seventeen axes
are enough: both normals, the nine products of their edges, and the normals of the edges within each
plane. Triangles that share a corner may touch there: some axis that is not along both of them must
still have them on different sides.

Every test has a margin, in units of the spacing, because the corners may be a little out of place.
It is far above that, and far below what any sound triangle of a cell has (see the tests).

Glossary
--------
places      (V, 3) index coordinates of the vertices
corners     (n, 3, 3) the places of the corners of n triangles
gap         how far apart two shadows are; below zero they overlap

References
----------
S. Gottschalk, M. Lin, D. Manocha: OBBTree. SIGGRAPH 1996, section 5 (axes that separate).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from isoref.field import Booleans, Floats, Integers
from scipy.spatial import KDTree

#: Below this a doubled area, a distance or a gap is taken for none.
MARGIN = 0.01
#: An axis tells two triangles that share a corner apart only if one has this much of a shadow.
SHADOW = 0.05


def without_area(corners: Floats) -> Integers:
    """The triangles of no area.

    >>> without_area(np.array([[[0, 0, 0], [1, 1, 0], [2, 2, 0]]]))
    array([0])
    """
    doubled = np.linalg.norm(_normals(corners), axis=1)
    return np.flatnonzero(doubled < MARGIN)


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


def crossing(places: Floats, faces: Integers) -> Integers:
    """(.., 2) faces in one cell that meet elsewhere than in what they share."""
    corners, found = places[faces], [np.empty((0, 2), np.int64)]
    for one, other in _pairs(np.floor(corners.mean(axis=1))):
        shared = (faces[one][:, :, None] == faces[other][:, None]).any(axis=(1, 2))
        bad = ~are_apart(corners[one], corners[other], shared)
        found.append(np.stack([one[bad], other[bad]], axis=1))
    return np.concatenate(found)


def _pairs(cell: Floats) -> Iterator[tuple[Integers, Integers]]:
    """Every two rows that are in one cell, a batch at a time: neighbours, next but one, and on."""
    order = np.lexsort(cell.T)
    cell = cell[order]
    for step in range(1, len(cell)):
        at = np.flatnonzero((cell[step:] == cell[:-step]).all(axis=1))
        if not len(at):
            return
        yield order[at], order[at + step]


def are_apart(a: Floats, b: Floats, shared: Booleans) -> Booleans:
    """(n,) whether triangles a and b, (n, 3, 3), meet nowhere but in corners they share."""
    axes = _axes(a, b)
    s, t = np.einsum("nxc,nvc->nxv", axes, a), np.einsum("nxc,nvc->nxv", axes, b)
    gap = np.maximum(s.min(axis=2) - t.max(axis=2), t.min(axis=2) - s.max(axis=2))
    seen = np.maximum(np.ptp(s, axis=2), np.ptp(t, axis=2)) > SHADOW
    beside, apart = ((gap > -MARGIN) & seen).any(axis=1), (gap > MARGIN).any(axis=1)
    return np.asarray(np.where(shared, beside, apart))


def _axes(a: Floats, b: Floats) -> Floats:
    """(n, 17, 3) unit axes that can tell the triangles apart; zero where two edges are parallel."""
    e, f = np.roll(a, -1, axis=1) - a, np.roll(b, -1, axis=1) - b
    n, m = _normals(a)[:, None], _normals(b)[:, None]
    products = np.cross(e[:, :, None], f[:, None]).reshape(len(a), 9, 3)
    axes = np.concatenate([n, m, products, np.cross(e, n), np.cross(f, m)], axis=1)
    length = np.linalg.norm(axes, axis=2, keepdims=True)
    units: Floats = np.divide(axes, length, out=np.zeros_like(axes), where=length > 1e-9)
    return units


def _normals(corners: Floats) -> Floats:
    """(n, 3) normals of triangles, twice their area long."""
    normals: Floats = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return normals
