"""Exercise 12: a dual surface. Two things in it were wrong.

Read lesson 12, mend this file, and ask: isograde exercise 12 exercise_12.py
"""

import numpy as np
from isoref.cube import EDGE_OF, EDGES
from isoref.cycles import ALL_SEPARATED, cycles

declaration = {
    "name": "exercise 12",
    "vertices": "cells",
    "domain": {"inset": 0.5, "end": "open"},
}


def groups(signs):
    """The crossed edges of a cell, those together that share a vertex."""
    return cycles(signs, ALL_SEPARATED)


def cells_round(axis, low):
    """The four cells round a lattice edge, and what number the edge has in each."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    found = []
    for back in ((), (u,), (u, v), (v,)):
        corner = sum(1 << a for a in back)
        cell = tuple(low[a] - (a in back) for a in range(3))
        found.append((cell, EDGE_OF[frozenset((corner, corner | 1 << axis))]))
    return found


def extract(values, isovalue, spacing):
    """A vertex for each group of crossings, a quadrilateral across each crossed lattice edge."""
    vertices, vertex_at = [], {}
    for cell in np.ndindex(*np.subtract(values.shape, 1)):
        corners = [tuple(cell[a] + (c >> a & 1) for a in range(3)) for c in range(8)]
        g = [float(values[corner]) - isovalue for corner in corners]
        for edges in groups(sum(1 << c for c in range(8) if g[c] >= 0)):
            points = []
            for edge in edges:
                low, high = EDGES[edge]
                t = g[low] / (g[low] - g[high])
                points.append((1 - t) * np.array(corners[low]) + t * np.array(corners[high]))
                vertex_at[cell, edge] = len(vertices)
            vertices.append(np.mean(points, axis=0) * spacing)

    # Join the four vertices round each crossed edge, counterclockwise for who stands outside.
    triangles = []
    for low in np.ndindex(values.shape):
        for axis in range(3):
            if all(place in vertex_at for place in cells_round(axis, low)):
                a, b, c, d = (vertex_at[place] for place in cells_round(axis, low))
                inside = values[low] >= isovalue
                triangles += [(a, b, c), (a, c, d)] if inside else [(a, c, b), (a, d, c)]
    return np.array(vertices).reshape(-1, 3), np.array(triangles, int).reshape(-1, 3)
