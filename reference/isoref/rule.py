"""Rules: what one cell does, said once for one cell and for a million.

A cube algorithm is a rule. Its two halves are kept apart, as the papers keep them apart:

*decisions*
    which numbers are compared on an ambiguous face or inside the cell, written with array
    arithmetic, so that the same lines serve one cell and a million;
*tile*
    pure combinatorics, from signs and decisions to oriented triangles, called once for each pair
    that occurs.

A sweep (`isoref.sweep`) carries a rule over a field.

Invariants
----------
A bit of a face is a function of the face's four values alone, the same from both cells and whatever
the magnitudes of other values; it is 0 where the face is not ambiguous. A tile names the crossed
edges and its own interior points, all of them. `isograde prove` checks both.

Glossary
--------
g           (8, n) corner values minus the isovalue, of n cells; inside is g >= 0
decisions   an integer of `Rule.bits` bits; bit f < 6 belongs to ambiguous face f (by custom it says
            that the face's inside corners are separated), and further bits to the interior
node        0 .. 11 the point where the surface crosses that edge; 12, 13, .. interior points
placement   how an interior point is placed: from g (8, n) and the crossings (12, n, 3), in
            coordinates of the cell (0 .. 1 on each axis; NaN on an edge that is not crossed), to
            n points (n, 3). One that does not look at the crossings may say so, and spare them:
            it has an attribute `asks_crossings` that is False. One that does the same in many
            tiles but for some numbers may be in two steps: ``begin(g, crossings)`` gives these
            numbers, (n, k), and ``finish(g, begun)`` the points, whatever the tiles
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from isoref.cube import FACE_CORNERS, ambiguous_faces
from isoref.cycles import Triangle
from isoref.field import Booleans, Floats, Integers

Placement = Callable[[Floats, Floats], Floats]


@dataclass(frozen=True)
class Tile:
    """The surface in one cell: oriented triangles on nodes, and its interior points."""

    triangles: tuple[Triangle, ...]
    interior: tuple[Placement, ...] = ()


@dataclass(frozen=True)
class Average:
    """The placement at the mean of some crossed edges' points.

    >>> crossings = np.zeros((12, 1, 3)); crossings[0, 0] = [0.5, 0, 0]
    >>> Average((0, 1))(np.zeros((8, 1)), crossings)
    array([[0.25, 0.  , 0.  ]])
    """

    nodes: tuple[int, ...]

    def __call__(self, g: Floats, crossings: Floats) -> Floats:
        """The mean points, (n, 3)."""
        return np.asarray(crossings[list(self.nodes)].mean(axis=0))


def has_ambiguous_face(signs: int) -> bool:
    """Whether any face is ambiguous: the cells for which face decisions are needed."""
    return bool(ambiguous_faces(signs))


def no_decisions(g: Floats) -> Integers:
    """Zero for each cell: the rule compares no numbers."""
    return np.zeros(g.shape[1], np.int64)


#: (4, 6) the corners of the faces: first, second, third and fourth of each walk.
WALKS = np.array(FACE_CORNERS).T


def decide_faces(g: Floats, separated: Callable[..., Booleans]) -> Integers:
    """(n,) bit f is set where face f is ambiguous and separated, for n cells, from g (8, n).

    separated : from a, b, c, d (m,), the values round m ambiguous faces, whether each is

    >>> g = np.array([[1.0], [-1], [-1], [1], [-1], [-1], [-1], [-1]])
    >>> decide_faces(g, lambda a, b, c, d: a * c == b * d)
    array([16])
    """
    # Find the ambiguous faces among the six of all cells.
    high_a, high_b, high_c, high_d = (g >= 0)[WALKS]
    found = (high_a == high_c) & (high_b == high_d) & (high_a != high_b)
    which = found.reshape(-1).nonzero()[0]

    # Ask about these alone, from their own four values.
    n = g.shape[1]
    face = which // n
    cell = which - face * n
    values = (g.take((n * corners).take(face) + cell) for corners in WALKS)
    found.reshape(-1)[which] = separated(*values)
    bits = np.zeros(n, np.uint8)
    for f, one in enumerate(found.view(np.uint8)):
        bits |= one << f
    return bits.astype(np.int64)


@dataclass(frozen=True)
class Rule:
    """A cube algorithm: its name and its two halves.

    name : as the catalogue knows it
    tile : signs, decisions -> the surface in the cell
    decisions : g (8, n) -> (n,) integers of `bits` bits
    asks : signs -> whether decisions are needed; where not, they are 0
    bits : how many bits a decision has; the proof by enumeration runs through all of them
    """

    name: str
    tile: Callable[[int, int], Tile]
    decisions: Callable[[Floats], Integers] = no_decisions
    asks: Callable[[int], bool] = has_ambiguous_face
    bits: int = 0
