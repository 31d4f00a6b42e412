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
    corners = places[parts]
    low, high = corners.min(axis=1) - lattice.tolerance, corners.max(axis=1) + lattice.tolerance
    found = np.zeros(len(parts), bool)
    for axis in range(lattice.n):
        across = [a for a in range(lattice.n) if a != axis]
        start, end = pair(lattice.n, axis)
        crossed = lattice.inside[start] != lattice.inside[end]
        # The edge begins at the sample below the part and has its line within reach across.
        base = np.ceil(high - 1).astype(np.int64)
        base[:, axis] = np.floor(low[:, axis] + 2 * lattice.tolerance)
        for offset in product(range(3), repeat=lattice.n - 1):
            edge = base.copy()
            edge[:, across] += offset
            fits = (edge[:, axis] <= low[:, axis] + 2 * lattice.tolerance) & (
                edge[:, axis] + 1 >= high[:, axis] - 2 * lattice.tolerance
            )
            for a in across:
                slack = 2 * lattice.tolerance
                fits &= (edge[:, a] - 1 <= low[:, a] + slack) & (
                    edge[:, a] + 1 >= high[:, a] - slack
                )
            fits &= ((edge >= 0) & (edge < crossed.shape)).all(axis=1)
            rows = np.flatnonzero(fits & ~found)
            found[rows] = crossed[tuple(edge[rows].T)]
    return found
