"""Exercise 9: VESTA, grown from the faces of voxels. Two things in it are wrong.

Read lesson 9, mend this file, and ask: isograde exercise 9 exercise_9.py
"""

from itertools import pairwise

import numpy as np

declaration = {"name": "exercise 9", "promised": ["cells.mean"]}

# Directions 0 .. 5; d ^ 1 is opposite to d.
STEPS = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]


def step(voxel, d):
    """The voxel next to this one in direction d."""
    return tuple(x + s for x, s in zip(voxel, STEPS[d], strict=True))


def quarter_turn(r, d):
    """The direction a quarter turn on from d, counterclockwise round r."""
    return STEPS.index(tuple(np.cross(STEPS[r], STEPS[d]).tolist()))


def connects(v, w, p, q):
    """Whether a juncture connects its two active voxels v and q: four values minus the isovalue.

    w and p are inactive; the path that ends here came along the face between v and w.
    """
    return v + w >= 0


def successor(path, g):
    """The path that begins where this one ends; g has all values minus the isovalue.

    A path (v, r, d) runs on the face between v and its neighbour in direction r, to the juncture
    in direction d.
    """
    v, r, d = path
    w, p = step(v, r), step(v, d)
    q = step(w, d)
    p_active, q_active = g.get(p, -1) >= 0, g.get(q, -1) >= 0
    convex, in_plane, concave = (v, d, r), (p, r, d ^ 1), (q, d ^ 1, r ^ 1)
    if p_active:
        voxel, face, entry = concave if q_active else in_plane
    elif not q_active:
        voxel, face, entry = convex
    else:
        # Decide the point of ambiguity.
        voxel, face, entry = concave if connects(g[v], g[w], g[p], g[q]) else convex
    return voxel, face, quarter_turn(entry, face)


def support_point(v, r, g):
    """Where the face's centre is moved to: the crossing between v and its neighbour."""
    w = step(v, r)
    t = g[w] / (g[w] - g[v])
    return np.array(v) + t * np.array(STEPS[r])


def fan(cycle):
    """A cycle of faces, begun where no chord of a fan joins faces of one voxel edge."""
    middles = [2 * np.array(v) + STEPS[r] for v, r in cycle]
    for k in range(len(cycle)):
        ends = [middles[(k + i) % len(cycle)] for i in range(2, len(cycle) - 1)]
        if all((end - middles[k]) @ (end - middles[k]) > 4 for end in ends):
            return cycle[k:] + cycle[:k]
    return None


def extract(values, isovalue, spacing):
    """The surface round the voxels whose value is at least the isovalue."""
    g = {v: float(values[v]) - isovalue for v in np.ndindex(values.shape)}
    faces = [(v, r) for v in g if g[v] >= 0 for r in range(6) if g.get(step(v, r), -1) < 0]
    inner = {face: n for n, face in enumerate(f for f in faces if step(*f) in g)}
    vertices = [support_point(v, r, g) for v, r in inner]

    # Follow the paths until they close.
    waiting = {(v, r, d): None for v, r in faces for d in range(6) if d // 2 != r // 2}
    triangles = []
    while waiting:
        path, cycle = next(iter(waiting)), []
        while path in waiting:
            del waiting[path]
            cycle.append(path[:2])
            path = successor(path, g)
        # Leave out what reaches beyond the samples.
        if not all(face in inner for face in cycle):
            continue

        # Cut the cycle into triangles; one that no fan will do for takes its average.
        begun = fan(cycle)
        if begun is not None:
            first, *others = (inner[face] for face in begun)
            triangles += [(first, a, b) for a, b in pairwise(others)]
        else:
            row = [inner[face] for face in cycle]
            triangles += [(a, b, len(vertices)) for a, b in pairwise([*row, row[0]])]
            vertices.append(np.mean([vertices[n] for n in row], axis=0))
    places = np.array(vertices).reshape(-1, 3) * spacing
    return places, np.array(triangles, int).reshape(-1, 3)
