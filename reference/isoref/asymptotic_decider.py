r"""The asymptotic decider: marching cubes without holes.

Marching cubes joins the points where a surface crosses the edges of a cell to polygons. On a face
with two diagonally opposite inside corners there are two ways to join four points, and the 1987
drawings take one way in one cell and the other way in its neighbour: the surface has a hole
(`isoref.lorensen_cline`). Nielson and Hamann let the face itself decide. They interpolate its four
samples bilinearly and ask which points the interpolant's own contour joins.

::

      B01 ------- B11
       |     :     |
     t |. . .+. . .|        + the saddle, where the asymptotes cross
       |     :     |
      B00 ------- B10
             s

    B(s, t) = B00 (1-s) (1-t) + B10 s (1-t) + B01 (1-s) t + B11 s t

The contour B = alpha is a hyperbola. Its asymptotes s = S and t = T meet in the saddle, and the
value there tells in which of the four quarters its two branches lie (Figs. 5 to 7 of [1]).

The module follows the paper. Section 2: the interpolant, its saddle, the decision. Section 3: the
variants each configuration has, their boundary polygons (`isoref.cycles`) and the point inside the
cell that some polygons need.

Glossary
--------
alpha       the isovalue
a, b, c, d  values round a face, minus alpha: a = B00, b = B10, c = B11, d = B01
S, T        the saddle: the point of the face where both derivatives of B vanish
separated   the surface cuts each inside corner of an ambiguous face off by itself; else the face
            is *not separated*, or joined
variant     a configuration with a letter for what its ambiguous faces decided: 3A, 3B, .. 13J
e0          a point inside the cell, for a polygon that no triangles on its own corners fill
v1 .. v8, e1 .. e12
            the paper's names for corners and edges: `PAPER_CORNERS`, `PAPER_EDGES`

Degenerate faces
----------------
The decision is exact: it compares a c with b d as if in endless precision, whatever their size.
So it does not change when all values are scaled by a power of two, and both cells at a face find
the same. On an ambiguous face the denominator a + c - b - d is never zero, because one diagonal is
not negative and the other is. A saddle exactly on the isovalue counts as inside, as a sample does:
the face is not separated. The paper's "else" says the same. An inside sample on the isovalue has
a c = 0 < b d: it is cut off, by triangles without area. In 10B and 10D a saddle on the isovalue
puts e0 on the face itself, the only case in which it is not strictly inside the cell.

What cannot be
--------------
Of the paper's ten variants of configuration 13, three never occur. Two opposite faces of it are
both separated only if the product of the four inside values is below that of the four outside
values (multiply the two inequalities), and both joined only if it is not. So no values separate
one pair of opposite faces and join another: 13C, 13E and 13G have polygons, but no cell. An exact
decision never chooses them; a rounded one might. On the other hand the list lacks a variant that
does occur: three separated faces that meet in a marked corner. We call it 13K.

Invariants
----------
The decision depends on the four values of the face alone: cells that share it draw the same
segments on it, and the surface has no hole. No triangle has an edge on a face of its cell but such
a segment.

References
----------
[1] Nielson, Hamann, "The asymptotic decider: resolving the ambiguity in marching cubes",
    Visualization 1991.
[2] Dekker, "A floating-point technique for extending the available precision", Numerische
    Mathematik 18, 1971, section 5: the rounding error of a product.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import ClassVar

import numpy as np

from isoref.cube import (
    CORNER_OFFSETS,
    EDGE_OF,
    FACE_CORNERS,
    REFLECTIONS,
    ROTATIONS,
    ambiguous_faces,
    configuration,
    corner_at,
    inside,
    is_exchanged,
    moved_signs,
)
from isoref.cycles import Triangle, cycles, fan, triangulate
from isoref.field import Booleans, Floats, Integers
from isoref.rule import Placement, Rule, Tile, decide_faces

# --------------------------------------------------------------------------------------------
# Section 2: the bilinear interpolant of a face, its saddle, the decision
# --------------------------------------------------------------------------------------------


def bilinear(s: Floats, t: Floats, a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
    """B(s, t), where a, b, c, d stand round the face: B00, B10, B11, B01.

    >>> float(bilinear(*np.array([0.5, 0.5, 0.0, 1.0, 5.0, 2.0])))
    2.0
    """
    return np.asarray((1 - s) * ((1 - t) * a + t * d) + s * ((1 - t) * b + t * c))


def saddle(a: Floats, b: Floats, c: Floats, d: Floats) -> tuple[Floats, Floats, Floats]:
    """S, T and B(S, T) of an ambiguous face: where its asymptotes meet, and the value there.

    S = (B00 - B01) / D, T = (B00 - B10) / D, B(S, T) = (B00 B11 - B01 B10) / D with
    D = B00 + B11 - B01 - B10. (Section 2 of [1] as scanned has a plus in the last numerator.)
    Each difference is of values of different signs, so nothing cancels.

    >>> [float(x) for x in saddle(*np.array([3.0, -1.0, 1.0, -1.0]))]
    [0.6666666666666666, 0.6666666666666666, 0.3333333333333333]
    """
    # Divide all by the power of two above the largest, so that no sum or product overflows.
    size = np.frexp(np.max(np.abs([a, b, c, d]), axis=0))[1] + 2
    a, b, c, d = (np.ldexp(x, -size) for x in (a, b, c, d))
    D = (a - d) + (c - b)
    return (a - d) / D, (a - b) / D, np.ldexp((a * c - b * d) / D, size)


def separated(a: Floats, b: Floats, c: Floats, d: Floats) -> Booleans:
    """Whether the inside corners of an ambiguous face are separated, decided exactly.

    They are where alpha > B(S, T). The values a, b, c, d stand round the face, minus alpha, so the
    question is whether (a c - b d) / (a + c - b - d) is below zero. The denominator has the sign
    of the inside diagonal: it is enough to compare the products. (The test printed in section 2 of
    [1] is for marked B00 and B11; for the other diagonal its two branches change places.) Rounded
    products nearly always tell; where they do not, `product_below` does.

    >>> separated(*np.array([[3.0, 1.0], [-1.0, -2.0], [1.0, 2.0], [-1.0, -1.0]]))
    array([False, False])
    """
    with np.errstate(over="ignore", under="ignore"):
        below, sure = plainly_below(a * c, b * d)
    below = np.asarray(below == (a >= 0))
    if not sure.all():
        a, b, c, d = (x[~sure] for x in (a, b, c, d))
        below[~sure] = product_below(*np.where(a >= 0, (a, c, b, d), (b, d, a, c)))
    return below


def plainly_below(left: Floats, right: Floats) -> tuple[Booleans, Booleans]:
    """Whether left < right, for two rounded products that are not negative, and whether it is sure.

    A product that neither over- nor underflows is off by 2^-53 of itself, so a difference of more
    than 2^-51 of the larger one is no rounding. Where the larger one is that far above the least
    float, the smaller one may have underflowed and does not matter.

    >>> [x.tolist() for x in plainly_below(np.array([1.0, 1.0]), np.array([2.0, 1.0]))]
    [[True, False], [True, False]]
    """
    larger = np.maximum(left, right)
    with np.errstate(invalid="ignore"):
        gap = np.abs(left - right)
    return np.asarray(left < right), np.asarray((gap > 2.0**-51 * larger) & (larger > 2.0**-900))


def product_below(p: Floats, q: Floats, r: Floats, s: Floats) -> Booleans:
    """Whether p q < r s, for two products that are not negative, without any rounding.

    >>> tiny, third = 2.0**-600, 1 / 3
    >>> bool(product_below(tiny, tiny, tiny, 2 * tiny)), bool(product_below(third, 3, 1, 1))
    (True, True)
    """
    # Take the exponents apart: mantissas lie in [1/2, 1), their products neither over- nor
    # underflow, and a shift by more than two settles the question by itself.
    (p, i), (q, j), (r, k), (s, m) = (np.frexp(x) for x in (p, q, r, s))
    shift = np.clip((i + j) - (k + m), -3, 3)
    left, right = np.ldexp(p * q, shift), np.asarray(r * s)
    # Rounding keeps order, so different rounded products decide; equal ones leave it to what
    # was rounded off.
    below = np.ldexp(rounded_off(p, q), shift) < rounded_off(r, s)
    return np.asarray((left < right) | (left == right) & below)


def rounded_off(x: Floats, y: Floats) -> Floats:
    """The exact product of x and y minus the rounded one, for factors of moderate size ([2]).

    >>> float(rounded_off(1 + 2.0**-30, 1 + 2.0**-30)) == 2.0**-60
    True
    """
    x1, x2 = _halves(x)
    y1, y2 = _halves(y)
    return np.asarray(((x1 * y1 - x * y) + x1 * y2 + x2 * y1) + x2 * y2)


def _halves(x: Floats) -> tuple[Floats, Floats]:
    """Two numbers of at most 26 bits each whose sum is x."""
    shifted = (2.0**27 + 1) * x
    upper = shifted - (shifted - x)
    return upper, x - upper


def decisions(g: Floats) -> Integers:
    """Bit f set where face f is ambiguous and separated, for n cells, from g (8, n)."""
    return decide_faces(g, separated)


# --------------------------------------------------------------------------------------------
# Section 3: the variants of the configurations and their names
# --------------------------------------------------------------------------------------------
#
#         v8 ---e7--- v7          e1 .. e4 run round the front from v1, e5 .. e8 round the back
#        /|          /|           from v5, e9 .. e12 from the front to the back. The text calls
#     e11 |       e12 |           the face of v2 v3 v7 v6 "right" (configuration 6), v1 v2 v3 v4
#      /  |        /  |           "front" and v1 v4 v8 v5 "left" (12), and the two others "top" and
#    v4 ---e3--- v3   e6          "bottom" (10). It does not say which of these is which: v1 at
#     |   v5 ---e5|-- v6          the bottom is our reading, and all that hangs on it is which
#    e4  /        e2 /            mixed variant of 12 is called B.
#     | e9        | e10
#     |/          |/              Axis 0 points right, axis 1 up, axis 2 to the reader.
#    v1 ---e1--- v2

PAPER_CORNERS = {
    1: corner_at(0, 0, 1),
    2: corner_at(1, 0, 1),
    3: corner_at(1, 1, 1),
    4: corner_at(0, 1, 1),
    5: corner_at(0, 0, 0),
    6: corner_at(1, 0, 0),
    7: corner_at(1, 1, 0),
    8: corner_at(0, 1, 0),
}
_EDGE_ENDS = ("12", "23", "34", "41", "56", "67", "78", "85", "15", "26", "48", "37")
PAPER_EDGES = {
    n: EDGE_OF[frozenset(PAPER_CORNERS[int(v)] for v in ends)]
    for n, ends in enumerate(_EDGE_ENDS, start=1)
}
LEFT, RIGHT, BOTTOM, TOP, BACK, FRONT = range(6)

# The corners marked in the paper's drawings of the configurations that have ambiguous faces, read
# off its triangulations.
DRAWN = {
    3: (1, 3),
    6: (1, 2, 7),
    7: (2, 4, 7),
    10: (1, 4, 6, 7),
    12: (2, 4, 5, 6),
    13: (2, 4, 5, 7),
}
# The separated faces of each variant in its drawing, read off the same way; the letter K is ours.
VARIANTS: dict[str, tuple[int, ...]] = {
    "3A": (FRONT,),
    "3B": (),
    "6A": (),
    "6B": (RIGHT,),
    "7A": (RIGHT, TOP, FRONT),
    "7B": (RIGHT, TOP),
    "7C": (TOP,),
    "7D": (),
    "10A": (BOTTOM, TOP),
    "10B": (BOTTOM,),
    "10C": (),
    "10D": (TOP,),
    "12A": (LEFT, FRONT),
    "12B": (LEFT,),
    "12C": (),
    "12D": (FRONT,),
    "13A": (LEFT, RIGHT, BOTTOM, TOP, BACK, FRONT),
    "13B": (LEFT, RIGHT, BOTTOM, TOP, BACK),
    "13C": (LEFT, RIGHT, BOTTOM, TOP),
    "13D": (LEFT, BOTTOM, TOP, BACK),
    "13E": (BOTTOM, TOP, BACK),
    "13F": (LEFT, TOP, BACK),
    "13G": (BACK, FRONT),
    "13H": (RIGHT, FRONT),
    "13I": (FRONT,),
    "13J": (),
    "13K": (RIGHT, BOTTOM, FRONT),
}


def drawing(number: int) -> int:
    """The signs of the paper's drawing of a configuration that has ambiguous faces.

    >>> configuration(drawing(7))
    7
    """
    return sum(1 << PAPER_CORNERS[v] for v in DRAWN[number])


def bits_of(faces: tuple[int, ...]) -> int:
    """The decisions that separate exactly these faces.

    >>> bits_of((LEFT, TOP))
    9
    """
    return sum(1 << f for f in faces)


def exchanged(signs: int, separated: int) -> tuple[int, int]:
    """The same surface seen from its other side: inside for outside, separated for joined.

    >>> exchanged(0b00001001, 0) == (0b11110110, 1 << 4)
    True
    """
    return 255 - signs, bits_of(ambiguous_faces(signs)) & ~separated


def moved_faces(separated: int, move: tuple[int, ...]) -> int:
    """The decisions after each corner c went to move[c]."""
    place = {frozenset(walk): f for f, walk in enumerate(FACE_CORNERS)}
    return sum(
        1 << place[frozenset(move[c] for c in walk)]
        for f, walk in enumerate(FACE_CORNERS)
        if separated >> f & 1
    )


def views(signs: int, separated: int) -> Iterator[tuple[int, int]]:
    """The cell turned, and at last mirrored, in every way that brings it to the paper's drawing."""
    if is_exchanged(signs):
        signs, separated = exchanged(signs, separated)
    target = drawing(configuration(signs))
    for move in (*ROTATIONS, *REFLECTIONS):
        if moved_signs(signs, move) == target:
            yield target, moved_faces(separated, move)


@cache
def variant(signs: int, separated: int) -> str:
    """The paper's name of the cell: 0 .. 14, with a letter where a face is ambiguous.

    A rotation that brings the cell to the drawing decides, the first that finds a letter. 10B and
    10D are one class: half a turn exchanges top and bottom. Three separated faces in a U come in
    two mirror images, of which the paper draws one: both are called 13E.

    >>> variant(0b00001001, 1 << 4), variant(0b11110110, 1 << 4), variant(0b00000001, 0)
    ('3A', '3B', '1')
    """
    number = configuration(signs)
    if not ambiguous_faces(signs):
        return str(number)
    letters = {bits_of(faces): name for name, faces in VARIANTS.items() if int(name[:-1]) == number}
    return next(letters[view] for _, view in views(signs, separated) if view in letters)


# --------------------------------------------------------------------------------------------
# Section 3: polygons, triangles, and the point e0
# --------------------------------------------------------------------------------------------


@cache
def tile(signs: int, decisions: int) -> Tile:
    """The triangles of the cell, with the point e0 where a polygon needs one.

    The polygons that need one are the octagons of 10B and 10D, the 9-gons of 7C, 13D and 13H and
    the 12-gons of 13E and 13F; no cell has two of them. Triangulations of the 12-gon of 13E exist,
    but each of them crosses itself.
    """
    triangles: list[Triangle] = []
    interior: list[Placement] = []
    for polygon in cycles(signs, decisions):
        pieces = triangulate(polygon) if len(polygon) < 12 else None
        if pieces is None:
            pieces = fan(polygon, 12 + len(interior))
            interior.append(place(signs, decisions))
        triangles += pieces
    return Tile(tuple(triangles), tuple(interior))


def place(signs: int, separated: int) -> Placement:
    """Where e0 stands: between two saddles in 10B and 10D, else on a body diagonal."""
    faces = ambiguous_faces(signs)
    if len(faces) == 2:
        return BetweenSaddles(*faces)
    return OnDiagonal(diagonal(signs, separated))


@dataclass(frozen=True)
class BetweenSaddles:
    """The placement of 10B and 10D: on the line that joins the saddles of two faces.

    e0 = (1 - u) e_t + u e_b, u = (alpha - F(e_t)) / (F(e_b) - F(e_t)), where e_t and e_b are the
    saddles of the top face and the bottom face (the paper's e(top), e(bot)). One of these faces is
    separated and the other is not, so 0 <= u <= 1.
    """

    top: int
    bottom: int

    asks_crossings: ClassVar[bool] = False

    def __call__(self, g: Floats, crossings: Floats) -> Floats:
        """The points e0, (n, 3)."""
        top, F_top = saddle_point(g, self.top)
        bottom, F_bottom = saddle_point(g, self.bottom)
        # Saddles so near the isovalue that both values round to zero say nothing: take the middle.
        flat = F_top == F_bottom
        u = np.where(flat, 0.5, F_top / np.where(flat, 1, F_top - F_bottom)).clip(0, 1)[:, None]
        return np.asarray((1 - u) * top + u * bottom)


def saddle_point(g: Floats, f: int) -> tuple[Floats, Floats]:
    """The saddles of face f in coordinates of the cell (n, 3), and the values there minus alpha.

    >>> g = np.array([3.0, -1, -1, 1, 0, 0, 0, 0])[:, None]
    >>> saddle_point(g, 4)[0].round(3)
    array([[0.667, 0.667, 0.   ]])
    """
    S, T, F = saddle(*g[list(FACE_CORNERS[f])])
    origin, along_s, _, along_t = CORNER_OFFSETS[list(FACE_CORNERS[f])]
    point = origin + np.outer(S, along_s - origin) + np.outer(T, along_t - origin)
    return np.asarray(point), F


@dataclass(frozen=True)
class OnDiagonal:
    """The placement of 7C, 13D, 13E, 13F, 13H: where the body diagonal from corner v is crossed.

    e0 = (1 - u) v + u w, u = (alpha - F(v)) / (F(w) - F(v)), with w opposite to v. The inside end
    has joined faces, so its value is above alpha, not on it: 0 < u < 1.
    """

    v: int

    asks_crossings: ClassVar[bool] = False

    def __call__(self, g: Floats, crossings: Floats) -> Floats:
        """The points e0, (n, 3)."""
        w = 7 - self.v
        # Halve, so that the difference of two large values stays finite.
        F_v, F_w = g[self.v] / 2, g[w] / 2
        u = (F_v / (F_v - F_w))[:, None]
        return np.asarray((1 - u) * CORNER_OFFSETS[self.v] + u * CORNER_OFFSETS[w])


def diagonal(signs: int, separated: int) -> int:
    """The body diagonal that carries e0, by the end that has the lower number.

    It joins an inside corner to an outside one, and of these diagonals it is the one whose ends
    are least cut off: most ambiguous faces are joined at its inside end or separated at its
    outside end. In the paper's drawings that is v2 v8 for 7C, 13D, 13E, 13F and v3 v5 for 13H;
    13E has a second as good, v4 v6; the higher number of two then decides as the paper does.
    """

    def freedom(v: int) -> int:
        """How many ambiguous faces cut neither end of the diagonal from v off."""
        high, low = (v, 7 - v) if inside(signs, v) else (7 - v, v)
        faces = ambiguous_faces(signs)
        joined = sum(high in FACE_CORNERS[f] and not separated >> f & 1 for f in faces)
        return joined + sum(low in FACE_CORNERS[f] and separated >> f & 1 for f in faces)

    crossed = [v for v in (3, 2, 1, 0) if inside(signs, v) != inside(signs, 7 - v)]
    return max(crossed, key=freedom)


RULE = Rule("asymptotic-decider", tile, decisions, bits=6)
