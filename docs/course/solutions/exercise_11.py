"""Exercise 11: where two surfaces meet. Two things in it were wrong.

Read lesson 11, mend this file, and ask: isograde exercise 11 exercise_11.py
"""

from collections import defaultdict

import numpy as np
from isoref.asymptotic_decider import RULE
from isoref.field import Field
from isoref.surface_intersection import (
    End,
    edge_name,
    enhanced_marching_cubes,
    exact_triangles,
    passages,
)

declaration = {"name": "exercise 11", "limits": {"kinds": [[3, 2]]}}


def normal(triangle):
    """The right-hand normal of a triangle, exactly: its corners are fractions."""
    a, b, c = (np.array(corner, object) for corner in triangle)
    return np.cross(b - a, c - a)


def meeting(a, b):
    """The two ends of the segment in which two triangles meet; None where they do not."""
    ours, theirs = passages(a, b), passages(b, a)
    if ours is None or theirs is None:
        return None
    # Along the common line the first triangle is entered where it comes to the front of the
    # second, and the second where it goes behind the first.
    (entry_a, exit_a), (exit_b, entry_b) = ours, theirs
    along = np.cross(normal(a), normal(b))
    in_a, out_a = along @ entry_a.place, along @ exit_a.place
    in_b, out_b = along @ entry_b.place, along @ exit_b.place
    if in_a >= out_b or in_b >= out_a:
        return None
    # An end names the edge of the first and the edge of the second triangle that make it, or -1.
    later, sooner = max(in_a, in_b), min(out_a, out_b)
    start = End(
        entry_a.place if in_a == later else entry_b.place,
        entry_a.edge if in_a == later else -1,
        entry_b.edge if in_b == later else -1,
    )
    stop = End(
        exit_a.place if out_a == sooner else exit_b.place,
        exit_a.edge if out_a == sooner else -1,
        exit_b.edge if out_b == sooner else -1,
    )
    return start, stop


def extract(a, b, isovalue_a, isovalue_b, spacing):
    """The segments in which two isosurfaces meet, on shared nodes."""
    first = enhanced_marching_cubes(Field.of(a, spacing), isovalue_a, RULE)
    second = enhanced_marching_cubes(Field.of(b, spacing), isovalue_b, RULE)
    ours, theirs = exact_triangles(first.mesh), exact_triangles(second.mesh)
    in_voxel = defaultdict(lambda: ([], []))
    for side, surface in enumerate((first, second)):
        for triangle, voxel in enumerate(surface.cells.tolist()):
            in_voxel[voxel][side].append(triangle)

    # Test each triangle of one surface with each of the other that is in the same voxel.
    nodes, points, segments = {}, [], []
    for left, right in in_voxel.values():
        for i, j in ((i, j) for i in left for j in right):
            ends = meeting(ours[i], theirs[j])
            if ends is None:
                continue
            segment = []
            for end in ends:
                name = edge_name(ours[i], end.edge_a, i), edge_name(theirs[j], end.edge_b, j)
                if name not in nodes:
                    nodes[name] = len(points)
                    points.append([float(x) for x in end.place])
                segment.append(nodes[name])
            segments.append(segment)
    return np.array(points).reshape(-1, 3), np.array(segments, int).reshape(-1, 2)
