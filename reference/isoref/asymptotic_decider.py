"""The asymptotic decider: marching cubes without holes.

On a face of a cell the samples are interpolated bilinearly. Where the two inside corners of the
face are diagonally opposite, the curve B(s, t) = alpha is a hyperbola with both branches in the
face, and which crossed edges a branch joins depends on one number: the value at the saddle, where
the asymptotes meet. The decision is the face's own, so both cells that share it decide alike.

Glossary
--------
alpha       the isovalue
B00 .. B11  the values at the corners of a face
saddle      the point (S, T) where both derivatives of B vanish
separated   the surface cuts each inside corner of the face off by itself
e0          an interior point, where no triangulation exists without one

References
----------
[1] Nielson, Hamann, "The asymptotic decider: resolving the ambiguity in marching cubes",
    Visualization 1991, section 2 and Figs. 5 to 8.
"""

from __future__ import annotations

import numpy as np

from isoref.cube import FACE_CORNERS
from isoref.cycles import Polygon, Triangle, cycles, fan, triangulate
from isoref.field import Booleans, Floats, Integers
from isoref.rule import Average, Placement, Rule, Tile


def separated(a: Floats, b: Floats, c: Floats, d: Floats) -> Booleans:
    """Whether the inside corners of an ambiguous face are separated.

    The values a, b, c, d stand round the face, minus alpha. At the saddle the interpolant is
    (a c - b d) / (a + c - b - d); the inside corners are separated where that is below zero.
    The denominator has the sign of the inside diagonal, so it is enough to compare the products.
    A saddle exactly on the isovalue counts as inside, as a sample does: not separated.
    """
    inside, outside = np.where(a >= 0, (a * c, b * d), (b * d, a * c))
    return np.asarray(inside < outside)


def decisions(g: Floats) -> Integers:
    """Bit f set where face f is ambiguous and separated, for n cells, from g (8, n)."""
    bits = np.zeros(g.shape[1], np.int64)
    for f, walk in enumerate(FACE_CORNERS):
        a, b, c, d = g[list(walk)]
        signs = np.stack([a, b, c, d]) >= 0
        ambiguous = (signs[0] == signs[2]) & (signs[1] == signs[3]) & (signs[0] != signs[1])
        bits |= (ambiguous & separated(a, b, c, d)).astype(np.int64) << f
    return bits


def tile(signs: int, decisions: int) -> Tile:
    """The triangles of the cell, with a point e0 in each polygon that needs one."""
    triangles: list[Triangle] = []
    interior: list[Placement] = []
    for polygon in cycles(signs, decisions):
        pieces = triangulate(polygon)
        if pieces is None:
            pieces = fan(polygon, 12 + len(interior))
            interior.append(place(polygon))
        triangles += pieces
    return Tile(tuple(triangles), tuple(interior))


def place(polygon: Polygon) -> Placement:
    """The interior point of a polygon that has no triangulation of its own."""
    return Average(polygon)


RULE = Rule("asymptotic-decider", tile, decisions, bits=6)
