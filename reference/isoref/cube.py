"""The cube: its corners, edges and faces, its rotations, its fifteen configurations.

A cell of a three-dimensional lattice is a cube with a sample at each corner. This module numbers
its parts once, for the whole package, and derives everything else from the numbers' bits.

::

        6--------7          corner c stands at (c & 1, c >> 1 & 1, c >> 2 & 1),
       /|       /|          in the order of the array's axes 0, 1, 2
      4--------5 |
      | |      | |          axis 2  axis 1
      | 2------|-3             | /
      |/       |/              |/
      0--------1               +--- axis 0

Glossary
--------
corner c    0 .. 7; bit a of c is its coordinate along axis a
edge e      0 .. 11; e = 4 a + k runs along axis a; the two bits of k are the coordinates of its
            lower end along the other two axes, the lower axis first
face f      0 .. 5; f = 2 a + s is perpendicular to axis a, at coordinate s
signs       an integer of eight bits; bit c is set where corner c is inside
ambiguous   a face whose inside corners are two diagonally opposite ones
configuration
            0 .. 14: a class of signs under the rotations and the exchange of inside and outside

Invariants
----------
`FACE_CORNERS[f]` runs counterclockwise for someone who looks at the cube from outside, so each
edge is passed once in either direction by its two faces. `FACE_EDGES[f][i]` joins corners i and
i + 1 of that walk.

References
----------
[1] Lorensen, Cline, "Marching cubes", SIGGRAPH 1987, Fig. 3.
[2] Nielson, Hamann, "The asymptotic decider", Visualization 1991, section 1, Fig. 2.
"""

from __future__ import annotations

from functools import cache
from itertools import permutations, product

import numpy as np

CORNERS = tuple((c & 1, c >> 1 & 1, c >> 2 & 1) for c in range(8))


def corner_at(i: int, j: int, k: int) -> int:
    """The corner with these coordinates.

    >>> corner_at(*CORNERS[6])
    6
    """
    return i | j << 1 | k << 2


def _edge_corners(e: int) -> tuple[int, int]:
    """The lower and the upper corner of edge e."""
    axis, k = divmod(e, 4)
    others = [a for a in range(3) if a != axis]
    low = (k & 1) << others[0] | (k >> 1) << others[1]
    return low, low | 1 << axis


def _face_corners(f: int) -> tuple[int, int, int, int]:
    """The corners of face f, counterclockwise seen from outside."""
    axis, side = divmod(f, 2)
    u, v = 1 << (axis + 1) % 3, 1 << (axis + 2) % 3
    base = side << axis
    walk = (base, base | u, base | u | v, base | v)
    return walk if side else (walk[0], walk[3], walk[2], walk[1])


EDGES = tuple(_edge_corners(e) for e in range(12))
EDGE_OF = {frozenset(ends): e for e, ends in enumerate(EDGES)}
FACE_CORNERS = tuple(_face_corners(f) for f in range(6))
FACE_EDGES = tuple(
    tuple(EDGE_OF[frozenset((walk[i], walk[(i + 1) % 4]))] for i in range(4))
    for walk in FACE_CORNERS
)


def axis_of(e: int) -> int:
    """The axis edge e runs along.

    >>> [axis_of(e) for e in (0, 3, 4, 11)]
    [0, 0, 1, 2]
    """
    return e // 4


def inside(signs: int, c: int) -> bool:
    """Whether corner c is inside."""
    return bool(signs >> c & 1)


def crossed_edges(signs: int) -> tuple[int, ...]:
    """The edges with one end inside and one outside.

    >>> crossed_edges(0b00000001)
    (0, 4, 8)
    """
    return tuple(e for e, (a, b) in enumerate(EDGES) if inside(signs, a) != inside(signs, b))


def is_ambiguous(signs: int, f: int) -> bool:
    """Whether the inside corners of face f are two diagonally opposite ones."""
    a, b, c, d = (inside(signs, corner) for corner in FACE_CORNERS[f])
    return a == c != b == d


@cache
def ambiguous_faces(signs: int) -> tuple[int, ...]:
    """The ambiguous faces, in order.

    >>> ambiguous_faces(0b01101001)
    (0, 1, 2, 3, 4, 5)
    """
    return tuple(f for f in range(6) if is_ambiguous(signs, f))


def _is_rotation(order: tuple[int, ...], flips: tuple[int, ...]) -> bool:
    """Whether permuting the axes by `order` and flipping some keeps right hands right."""
    inversions = sum(order[i] > order[j] for i in range(3) for j in range(i + 1, 3))
    return (inversions + sum(flips)) % 2 == 0


def _moved(order: tuple[int, ...], flips: tuple[int, ...]) -> tuple[int, ...]:
    """Where each corner goes when axis a becomes axis order[a], flipped where flips[a] is 1."""
    return tuple(sum((CORNERS[c][a] ^ flips[a]) << order[a] for a in range(3)) for c in range(8))


SYMMETRIES = tuple(
    (order, flips) for order in permutations(range(3)) for flips in product((0, 1), repeat=3)
)
ROTATIONS = tuple(_moved(*symmetry) for symmetry in SYMMETRIES if _is_rotation(*symmetry))
REFLECTIONS = tuple(_moved(*symmetry) for symmetry in SYMMETRIES if not _is_rotation(*symmetry))


def moved_signs(signs: int, move: tuple[int, ...]) -> int:
    """The signs after each corner c went to move[c]."""
    return sum(1 << move[c] for c in range(8) if inside(signs, c))


# One drawing of Fig. 2 of [2] for each configuration, by its marked corners. The figure fixes
# the names 0 .. 14, which no rule gives; everything else about a configuration is derived.
# Configurations 11 and 14 are mirror images of each other: the text of [2] does not say which is
# which, and the choice here is ours.
REPRESENTATIVES: tuple[tuple[int, ...], ...] = (
    (),
    (0,),
    (0, 1),
    (0, 3),
    (0, 7),
    (0, 1, 2),
    (0, 1, 6),
    (0, 3, 5),
    (0, 1, 2, 3),
    (0, 1, 2, 4),
    (0, 1, 6, 7),
    (0, 1, 2, 5),
    (0, 1, 2, 7),
    (0, 3, 5, 6),
    (0, 1, 2, 6),
)


def _named(representative: tuple[int, ...]) -> dict[int, int]:
    """Signs in the class of these marked corners -> 1 where inside and outside are exchanged."""
    signs = sum(1 << c for c in representative)
    direct = {moved_signs(signs, move): 0 for move in ROTATIONS}
    exchanged = {255 - s: 1 for s in direct}
    return exchanged | direct


_CONFIGURATION = {
    signs: (name, exchanged)
    for name, corners in enumerate(REPRESENTATIVES)
    for signs, exchanged in _named(corners).items()
}


def configuration(signs: int) -> int:
    """The number 0 .. 14 of Fig. 2 of [2] whose class the signs belong to.

    >>> configuration(0b10000001), configuration(0b01111110)
    (4, 4)
    """
    return _CONFIGURATION[signs][0]


def is_exchanged(signs: int) -> bool:
    """Whether only the exchange of inside and outside brings the signs to the drawing.

    >>> is_exchanged(0b00000001), is_exchanged(0b11111110), is_exchanged(0b00001111)
    (False, True, False)
    """
    return bool(_CONFIGURATION[signs][1])


CORNER_OFFSETS = np.array(CORNERS)
EDGE_CORNERS = np.array(EDGES)
