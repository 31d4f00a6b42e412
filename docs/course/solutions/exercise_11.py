"""Exercise 11: where two surfaces meet. Two things in it were wrong.

Read lesson 11, mend this file, and ask: isograde exercise 11 exercise_11.py
"""

from collections import defaultdict
from fractions import Fraction

import numpy as np
from isoref.asymptotic_decider import RULE
from isoref.field import Field
from isoref.surface_intersection import enhanced_marching_cubes

declaration = {"name": "exercise 11", "limits": {"kinds": [[3, 2]]}}


def normal(triangle):
    """The right-hand normal of a triangle, exactly: coordinates are fractions."""
    return np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])


def passages(own, other):
    """Where a triangle comes to the front of another's plane, and where it goes to its back.

    Each is a place and the number of an edge, 0 to 2; None where all of it is on one side.
    """
    n = normal(other)
    height = [n @ (corner - other[0]) for corner in own]
    found = {}
    for e in range(3):
        low, high = height[e], height[(e + 1) % 3]
        if (low > 0) != (high > 0):
            place = own[e] + low / (low - high) * (own[(e + 1) % 3] - own[e])
            found[high > 0] = (place, e)
    return (found[True], found[False]) if found else None


def meeting(a, b):
    """The two ends of the segment in which two triangles meet; None where they do not.

    An end is a place, the edge of the first and the edge of the second triangle that make it; -1
    where it is the inside of the triangle.
    """
    ours, theirs = passages(a, b), passages(b, a)
    if ours is None or theirs is None:
        return None
    # Along the common line the first triangle is entered where it comes to the front of the
    # second, and the second where it goes behind the first.
    (entry_a, exit_a), (exit_b, entry_b) = ours, theirs
    along = np.cross(normal(a), normal(b))
    in_a, out_a = along @ entry_a[0], along @ exit_a[0]
    in_b, out_b = along @ entry_b[0], along @ exit_b[0]
    if in_a >= out_b or in_b >= out_a:
        return None
    later, sooner = max(in_a, in_b), min(out_a, out_b)
    start = (
        entry_a[0] if in_a == later else entry_b[0],
        entry_a[1] if in_a == later else -1,
        entry_b[1] if in_b == later else -1,
    )
    stop = (
        exit_a[0] if out_a == sooner else exit_b[0],
        exit_a[1] if out_a == sooner else -1,
        exit_b[1] if out_b == sooner else -1,
    )
    return start, stop


def name(row, edge, number):
    """What an edge is called by both its triangles; for -1 the number of the triangle itself."""
    return number if edge < 0 else frozenset((row[edge], row[(edge + 1) % 3]))


def extract(a, b, isovalue_a, isovalue_b, spacing):
    """The segments in which two isosurfaces meet, on shared nodes."""
    surfaces = [
        enhanced_marching_cubes(Field.of(values, spacing), isovalue, RULE)
        for values, isovalue in ((a, isovalue_a), (b, isovalue_b))
    ]
    rows = [surface.mesh.simplices.tolist() for surface in surfaces]
    exact = [np.vectorize(Fraction, otypes=[object])(one.mesh.vertices) for one in surfaces]
    in_voxel = defaultdict(lambda: ([], []))
    for side, surface in enumerate(surfaces):
        for triangle, voxel in enumerate(surface.cells.tolist()):
            in_voxel[voxel][side].append(triangle)

    # Test each triangle of one surface with each of the other that is in the same voxel.
    nodes, points, segments = {}, [], []
    for left, right in in_voxel.values():
        for i, j in ((i, j) for i in left for j in right):
            ends = meeting(exact[0][rows[0][i]], exact[1][rows[1][j]])
            if ends is None:
                continue
            segment = []
            for place, edge_a, edge_b in ends:
                node = name(rows[0][i], edge_a, i), name(rows[1][j], edge_b, j)
                if node not in nodes:
                    nodes[node] = len(points)
                    points.append([float(x) for x in place])
                segment.append(nodes[node])
            segments.append(segment)
    return np.array(points).reshape(-1, 3), np.array(segments, int).reshape(-1, 2)
