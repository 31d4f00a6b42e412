"""Which parts of a mesh are dual to the lattice: pieces of a polygon round one crossed edge.

A dual method puts its vertices into cells and draws, round each lattice edge whose ends are on
different sides, a polygon with a corner in each cell that meets in the edge. However that is cut
into simplices, all of them stay in those cells: in a box of one cell along the edge and two across
it. Two vertices on one edge of the mesh are therefore in cells that share a face (or, on a
diagonal, an edge), and that face, or edge, has samples on both sides.

Glossary
--------
part        one simplex of the mesh
star        the closed box of the cells that meet in a lattice edge
"""

from __future__ import annotations

from itertools import product

import numpy as np
from isoref.field import Booleans, Floats, Integers

from isograde.oracles.lattice import Lattice, pair


def in_a_star(lattice: Lattice, places: Floats, parts: Integers) -> Booleans:
    """(S,) the part lies in the star of some crossed lattice edge.

    Parameters
    ----------
    places : (V, n) vertices in index coordinates
    parts : (S, k + 1)
    """
    corners, slack = places[parts], 2 * lattice.tolerance
    low, high = corners.min(axis=1) + slack, corners.max(axis=1) - slack
    found = np.zeros(len(parts), bool)
    for axis in range(lattice.n):
        before = np.array([float(a != axis) for a in range(lattice.n)])
        start, end = pair(lattice.n, axis)
        crossed = lattice.inside[start] != lattice.inside[end]
        # The star of the edge at j runs from j - before to j + 1: one of three j along each axis.
        base = np.ceil(high - 1).astype(np.int64)
        for offset in product(range(3), repeat=lattice.n):
            edge = base + offset
            fits = ((edge - before <= low) & (edge + 1 >= high)).all(axis=1)
            fits &= ((edge >= 0) & (edge < crossed.shape)).all(axis=1)
            rows = np.flatnonzero(fits & ~found)
            found[rows] = crossed[tuple(edge[rows].T)]
    return found
