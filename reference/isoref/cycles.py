r"""From signs to polygons, and from polygons to triangles.

A surface that crosses a cell leaves a curve on the cell's boundary: on each face it runs from
crossed edge to crossed edge, and the pieces join to closed polygons. Which pieces a face holds
follows from the signs of its four corners, and, on an ambiguous face, from one decision: are its
two inside corners *separated* by the surface, or joined?

::

      o----x----I      o----x----I
      |     \   |      |   /     |        I inside   o outside   x crossed edge
      x      \  x      x  /      x
      |\      \ |      | /     / |
      | \      \|      |/     /  |
      I--x-----o       I----x----o
       separated         joined           (section 2 and Fig. 8 of [1])

Because the decision belongs to the face and not to the cell, two cells that share a face draw the
same pieces on it, in opposite directions: that is why surfaces made so have no holes.

Glossary
--------
signs       eight bits, see `isoref.cube`
separated   six bits; bit f is set where the inside corners of ambiguous face f are cut apart
segment     an oriented piece (e, e') on one face, from crossed edge to crossed edge
polygon     a closed cycle of segments, a tuple of crossed edges
chord       an inner edge of a triangulation of a polygon; it must not lie on a face of the cell

Invariants
----------
Each crossed edge starts one segment and ends one. Seen from outside the cell a segment has the
inside on its right, so that right-hand normals of the polygons point from inside to outside.

References
----------
[1] Nielson, Hamann, "The asymptotic decider", Visualization 1991, sections 1 to 3.
[2] Schlei, "Volume-enclosing surface extraction", 2010, section II.C: cycles instead of tables.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

from isoref.cube import FACE_CORNERS, FACE_EDGES, crossed_edges, inside

Polygon = tuple[int, ...]
Triangle = tuple[int, int, int]

ALL_SEPARATED = 0b111111
ALL_JOINED = 0


def segments(signs: int, f: int, separated: bool) -> list[tuple[int, int]]:
    """The oriented pieces of the surface on face f.

    >>> segments(0b00000001, 4, separated=False)
    [(0, 4)]
    """
    walk, edges = FACE_CORNERS[f], FACE_EDGES[f]
    marks = [inside(signs, c) for c in walk]
    # Walk round the face and note where the walk enters the inside and where it leaves it.
    enter = [i for i in range(4) if not marks[i] and marks[(i + 1) % 4]]
    leave = [i for i in range(4) if marks[i] and not marks[(i + 1) % 4]]
    if len(enter) < 2:
        return [(edges[i], edges[j]) for i, j in zip(enter, leave, strict=True)]
    # Cut off each inside corner by itself, or each outside corner.
    step = 1 if separated else 3
    return [(edges[i], edges[(i + step) % 4]) for i in enter]


@cache
def cycles(signs: int, separated: int) -> tuple[Polygon, ...]:
    """The oriented boundary polygons of the cell, each from its lowest edge, sorted.

    >>> cycles(0b00000001, ALL_JOINED)
    ((0, 4, 8),)
    >>> [len(polygon) for polygon in cycles(0b01101001, ALL_SEPARATED)]
    [3, 3, 3, 3]
    """
    # Collect the segments of all faces: each crossed edge starts one.
    successor = dict(
        segment for f in range(6) for segment in segments(signs, f, bool(separated >> f & 1))
    )

    # Follow them round.
    found = []
    waiting = set(crossed_edges(signs))
    while waiting:
        start = min(waiting)
        polygon = [start]
        while (edge := successor[polygon[-1]]) != start:
            polygon.append(edge)
        waiting -= set(polygon)
        found.append(tuple(polygon))
    return tuple(found)


@cache
def share_face(e: int, f: int) -> bool:
    """Whether two edges lie on one face of the cell.

    >>> share_face(0, 1), share_face(0, 3)
    (True, False)
    """
    return any(e in edges and f in edges for edges in FACE_EDGES)


def triangulations(polygon: Polygon) -> Iterator[tuple[Triangle, ...]]:
    """Every triangulation of the polygon whose chords stay inside the cell.

    A chord between two edges of one face would lie on that face, where the neighbouring cell may
    put another: more than two triangles could then meet in it (section 1 of [1], on Dürst).

    >>> list(triangulations((0, 4, 8)))
    [((0, 4, 8),)]
    """
    first, *_, last = polygon
    if len(polygon) == 2:
        yield ()
        return
    # Choose the apex of the triangle on the side (last, first), then fill both remaining parts.
    for i in range(1, len(polygon) - 1):
        apex = polygon[i]
        left_ok = i == 1 or not share_face(first, apex)
        right_ok = i == len(polygon) - 2 or not share_face(apex, last)
        if left_ok and right_ok:
            for left in triangulations(polygon[: i + 1]):
                for right in triangulations(polygon[i:]):
                    yield ((first, apex, last), *left, *right)


@cache
def triangulate(polygon: Polygon) -> tuple[Triangle, ...] | None:
    """A triangulation of the polygon without a chord on a face, or None where there is none.

    >>> triangulate((0, 4, 8))
    ((0, 4, 8),)
    """
    return next(triangulations(polygon), None)


def fan(polygon: Polygon, centre: int) -> tuple[Triangle, ...]:
    """The triangles that join each side of the polygon to a point inside the cell.

    >>> fan((0, 4, 8), 12)
    ((0, 4, 12), (4, 8, 12), (8, 0, 12))
    """
    return tuple((a, b, centre) for a, b in zip(polygon, polygon[1:] + polygon[:1], strict=True))
