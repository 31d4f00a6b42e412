r"""Dual marching cubes, the manifold kind: one vertex for each piece of surface in a cell.

Nielson's surface is the dual of the one marching cubes draws: a vertex for each polygon of a cell
(`isoref.cycles`), a quadrilateral across each crossed edge (`isoref.dual`). Ambiguous faces are
decided one way throughout: the inside corners are separated. Where surface nets let two pieces
meet in one vertex, here each has its own.

Nielson's remark, and the reason for it
---------------------------------------
The quadrilaterals through an ambiguous face have two sides across it, one for each of the two
segments that marching cubes draws there. A side joins the vertex of the polygon that holds its
segment in one cell to that in the other. If *both* segments belong to one polygon in the one cell
and to one polygon in the other, then both sides join the same two vertices, and four
quadrilaterals meet in one edge::

       one cell       face      other cell
                       /
           .---------- s1 ----------.
          A            |             B          s1, s2   the two segments on the face
           '---------- s2 ----------'           A, B     the polygons they belong to
                       /

By enumeration, that happens in a cell for 36 of the 256 signs: configurations 3 and 6 with five or
six inside corners, whose one ambiguous face is joined to itself outside. On all other ambiguous
faces the two segments belong to different polygons.

The repair
----------
Where two such cells share their ambiguous face, join its inside corners instead, in both
(Wenger). Then each cell has two polygons with one of the segments each. Neither has another
ambiguous face, so no third cell sees the difference, and no cell is asked twice. That is the only
place where a decision depends on anything but the signs of the cell.

At the border
-------------
A polygon may touch the border of the lattice in several places, and the quadrilaterals round its
vertex then fall into several fans that meet in nothing but the vertex. Each fan then gets a vertex
of its own, at the mean of its crossings and the nearer half of the crossings of the border on
either side, so that the mesh is a manifold with a border and not only within it. (A middle one
counts for neither: then the mirror image of a field has the mirror image of the surface.)

Glossary
--------
pinched     of a cell: its one ambiguous face has both segments in one polygon
turned      of a pinched cell: its neighbour beyond that face is pinched there too
fan         a run of inner edges along a polygon: the quadrilaterals round a vertex, one connected
            piece of them

Invariants
----------
Every edge away from the border has two quadrilaterals, those of a vertex form one fan or one
circle, and neighbours agree in orientation: for all signs of all samples, ties or not, as
quadrilaterals and as triangles. Vertices lie in their cells. `tests` prove it for every pair of
cells.

References
----------
[1] G. M. Nielson, "Dual marching cubes", IEEE Visualization 2004, section 5.3 (the remark).
[2] R. Wenger, "Isosurfaces: geometry, topology, and algorithms", CRC Press 2013, section 3.3.5.
[3] S. Schaefer, T. Ju, J. Warren, "Manifold dual contouring", IEEE TVCG 13(3), 2007: the same
    vertices on an octree, where cells are merged only as long as the result stays a manifold.
[4] D. Zint, R. Grosso, P. Gürtler, "Resolving non-manifoldness on meshes from dual marching
    cubes", Eurographics 2022 (short papers): the same remark with other decisions on the faces.
"""

from __future__ import annotations

from functools import cache

from isoref.cube import FACE_EDGES, ambiguous_faces
from isoref.cycles import ALL_JOINED, ALL_SEPARATED, Polygon, cycles
from isoref.dual import DualRule, Patch, inner_edges


@cache
def pinched_face(signs: int) -> int | None:
    """The ambiguous face with both its segments in one polygon, or None; no cell has two.

    >>> pinched_face(0b11110110), pinched_face(0b00001001)
    (4, None)
    """
    polygons = cycles(signs, ALL_SEPARATED)
    for f in ambiguous_faces(signs):
        if any(set(FACE_EDGES[f]) <= set(polygon) for polygon in polygons):
            return f
    return None


@cache
def patches(signs: int, turned: bool, border: int) -> tuple[Patch, ...]:
    """One patch for each polygon of the cell, or for each fan of it at the border.

    >>> [patch.crossings for patch in patches(0b11110110, turned=False, border=0)]
    [(0, 8, 4, 1, 11, 5)]
    >>> [patch.crossings for patch in patches(0b11110110, turned=True, border=0)]
    [(0, 8, 4), (1, 11, 5)]
    """
    polygons = cycles(signs, ALL_JOINED if turned else ALL_SEPARATED)
    inner = inner_edges(signs, border)
    return tuple(patch for polygon in polygons for patch in fans(polygon, inner))


def fans(polygon: Polygon, inner: frozenset[int]) -> list[Patch]:
    """The fans of a polygon, which is a circle; none without an inner edge.

    >>> [fan.quads for fan in fans((0, 8, 4, 1, 11, 5), frozenset({0, 1, 4}))]
    [(0,), (4, 1)]
    >>> fans((0, 8, 4), frozenset({0, 4, 8}))
    [Patch(crossings=(0, 8, 4), quads=(0, 8, 4))]
    """
    starts = [i for i, e in enumerate(polygon) if e in inner and polygon[i - 1] not in inner]
    if len(starts) < 2:
        quads = tuple(e for e in polygon if e in inner)
        return [Patch(polygon, quads)] if quads else []
    found = []
    for start in starts:
        ring = polygon[start:] + polygon[:start]
        length = next(i for i, e in enumerate(ring) if e not in inner)
        before = _leading(ring[::-1], inner)[::-1]
        after = _leading(ring[length:] + ring, inner)
        quads = ring[:length]
        found.append(Patch((*before, *quads, *after), quads))
    return found


def _leading(way: Polygon, inner: frozenset[int]) -> Polygon:
    """The nearer half of the border crossings with which this way begins, without a middle one.

    >>> _leading((0, 8, 4, 1), frozenset({1})), _leading((8, 4, 1), frozenset({1}))
    ((0,), (8,))
    """
    run = next(i for i, e in enumerate(way) if e in inner)
    return way[: run // 2]


RULE = DualRule("dual-marching-cubes", patches, pinched_face)
