r"""Naive surface nets: one vertex in each cell that the surface crosses, its flaw included.

Gibson put one vertex into each cell with samples on both sides, joined those of cells that share a
face, and then let the net relax, each vertex held in its cell. The naive kind, the one in wide
use, leaves the relaxation out and places each vertex where one would like it to come to rest: at
the mean of the points where the edges of its cell are crossed [2].

With the quadrilateral of each crossed edge (`isoref.dual`) that is the whole method: no table, no
ambiguous face, and about half as many triangles as marching cubes, better shaped.

The flaw is that a cell has one vertex, however many pieces of surface pass through it. On an
ambiguous face all four edges are crossed, and all four quadrilaterals have the segment between the
same two vertices as a side::

      in  |  out          The face between two cells, and the four quadrilaterals that go through
     -----+-----          its four edges. Each has the line from the one cell's vertex to the
      out |  in           other's as a side: an edge of four quadrilaterals, not two.

The mesh is still closed and oriented, since the four come in two pairs, but it is not a manifold
there. Where two pieces pass through one cell without an ambiguous face, they touch in its vertex.
`isoref.dual_marching_cubes` gives each piece a vertex of its own.

Invariants
----------
One vertex in each active cell that has an inner crossed edge, strictly inside the cell unless
samples are tied. Every edge away from the border has two or four quadrilaterals; four exactly at
the ambiguous faces.

References
----------
[1] S. F. F. Gibson, "Constrained elastic surface nets: generating smooth surfaces from binary
    segmented data", MICCAI 1998, section 2.
[2] M. Lysenko, "Smooth voxel terrain (part 2)", 0fps.net, 2012.
"""

from __future__ import annotations

from isoref.cube import crossed_edges
from isoref.dual import DualRule, Patch, inner_edges


def patches(signs: int, turned: bool, border: int) -> tuple[Patch, ...]:
    """All crossings of the cell as one patch; a net never turns, and only its quads know a border.

    >>> patches(0b10000001, False, border=0)  # two opposite corners, and one vertex for both
    (Patch(crossings=(0, 3, 4, 7, 8, 11), quads=(0, 3, 4, 7, 8, 11)),)
    """
    inner = inner_edges(signs, border)
    if not inner:
        return ()
    return (Patch(crossed_edges(signs), tuple(sorted(inner))),)


def never(signs: int) -> None:
    """No face: the net has no second surface to turn to."""


RULE = DualRule("surface-nets", patches, never)
