"""Exercise 6: polygons followed round a cell and cut into triangles. Two things in it were wrong.

Read lesson 6, mend this file, and ask: isograde exercise 6 exercise_6.py
"""

from itertools import pairwise

import numpy as np

declaration = {"name": "exercise 6"}

# Corner c stands one step along axis a where bit a of c is set. The corners of each face are in
# the order of a walk round it, counterclockwise for somebody who looks at the cell from outside.
FACES = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]


def segments(inside):
    """From each crossed edge of a cell the one that follows it; an edge is a pair of corners."""
    following = {}
    for walk in FACES:
        edges = [tuple(sorted((walk[i], walk[(i + 1) % 4]))) for i in range(4)]
        enter = [i for i in range(4) if not inside[walk[i]] and inside[walk[(i + 1) % 4]]]
        leave = [i for i in range(4) if inside[walk[i]] and not inside[walk[(i + 1) % 4]]]
        for i in enter:
            # One segment joins the only two crossings; of four, each inside corner is cut off.
            to = leave[0] if len(leave) == 1 else (i + 1) % 4
            following[edges[i]] = edges[to]
    return following


def polygons(inside):
    """The closed polygons of a cell, each a list of crossed edges."""
    following = segments(inside)
    found = []
    while following:
        polygon = [min(following)]
        while (edge := following.pop(polygon[-1])) != polygon[0]:
            polygon.append(edge)
        found.append(polygon)
    return found


def one_face(e, f):
    """Whether two edges lie on one face of the cell."""
    return any(set(e) | set(f) <= set(walk) for walk in FACES)


def triangles(polygon):
    """The polygon cut into triangles, each three crossed edges."""
    for k in range(len(polygon)):
        first, *others = polygon[k:] + polygon[:k]
        if not any(one_face(first, edge) for edge in others[1:-1]):
            break
    return [(first, a, b) for a, b in pairwise(others)]


def extract(values, isovalue, spacing):
    """The triangles of all cells; a vertex belongs to a lattice edge, and is made once."""
    vertices, rows, numbers = [], [], {}
    for cell in np.ndindex(*np.subtract(values.shape, 1)):
        corners = [tuple(cell[a] + (c >> a & 1) for a in range(3)) for c in range(8)]
        g = [float(values[corner]) - isovalue for corner in corners]
        for polygon in polygons([value >= 0 for value in g]):
            for triangle in triangles(polygon):
                row = []
                for a, b in triangle:
                    name = corners[a], corners[b]
                    if name not in numbers:
                        numbers[name] = len(vertices)
                        t = g[a] / (g[a] - g[b])
                        place = np.array(corners[a]) + t * np.subtract(corners[b], corners[a])
                        vertices.append(place * spacing)
                    row.append(numbers[name])
                rows.append(row)
    return np.array(vertices).reshape(-1, 3), np.array(rows, int).reshape(-1, 3)
