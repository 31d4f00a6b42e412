"""Marching cubes as published in 1987, its flaw included.

Lorensen and Cline drew one surface for each of fifteen configurations of a cell and reached the
other 241 cells by rotation and by exchanging inside and outside. The exchange is the flaw. Where
two inside corners of a face are diagonally opposite, every drawing cuts them apart; but a cell
with more than four inside corners uses the drawing of its complement, which cuts the *outside*
corners apart and so joins the inside ones. A face between two such cells is torn: each side draws
its own pair of segments, and the hole between them has four edges (Fig. 3 of [2]).

No drawing needs to be copied. What the fifteen have in common is this one sentence, and the
polygons follow from it: *cut apart the corners that are in the minority; where there are four and
four, the inside ones.* The diagonals of a polygon with more than three sides are ours.

Invariants
----------
At most four triangles a cell. The mesh has holes, and only at ambiguous faces; `isograde` must
find them.

References
----------
[1] Lorensen, Cline, "Marching cubes: a high resolution 3D surface construction algorithm",
    SIGGRAPH 1987, Fig. 3.
[2] Nielson, Hamann, "The asymptotic decider", Visualization 1991, section 1, Figs. 2 and 3.
"""

from __future__ import annotations

from isoref.cycles import ALL_JOINED, ALL_SEPARATED, Polygon, Triangle, cycles, triangulate
from isoref.rule import Rule, Tile


def polygons(signs: int) -> tuple[Polygon, ...]:
    """The boundary polygons of the 1987 drawing for these signs.

    >>> polygons(0b00001001)  # two diagonally opposite corners are cut apart
    ((0, 4, 8), (1, 5, 11))
    >>> polygons(0b11110110)  # and so are two outside ones
    ((0, 8, 4), (1, 11, 5))
    """
    minority_inside = signs.bit_count() <= 4
    return cycles(signs, ALL_SEPARATED if minority_inside else ALL_JOINED)


def tile(signs: int, decisions: int) -> Tile:
    """The triangles of the drawing; `decisions` is not looked at, which is the flaw."""
    triangles: list[Triangle] = []
    for polygon in polygons(signs):
        pieces = triangulate(polygon)
        assert pieces is not None, "polygons that separate the minority have safe triangulations"
        triangles += pieces
    return Tile(tuple(triangles))


RULE = Rule("lorensen-cline", tile)
