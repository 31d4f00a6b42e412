"""manifold3d: `Manifold.level_set` of a function, here the trilinear interpolant of the samples."""

from array import array

import numpy as np


def surface(values, isovalue, spacing):
    """The solid's surface, sampled on a body-centred lattice as fine as ours."""
    from manifold3d import Manifold

    ends = [(n - 1) * h for n, h in zip(values.shape, spacing, strict=True)]
    solid = Manifold.level_set(
        interpolant(values, spacing), [0.0, 0.0, 0.0, *ends], min(spacing), level=isovalue
    )
    mesh = solid.to_mesh()
    return mesh.vert_properties[:, :3], mesh.tri_verts


def interpolant(values, spacing):
    """The trilinear interpolant, continued constantly beyond the lattice; a plain function."""
    flat = array("d", values.astype(np.float64).tobytes())
    ends = [n - 1 for n in values.shape]
    strides = [values.shape[1] * values.shape[2], values.shape[2], 1]

    def at(x, y, z):
        low, parts = 0, []
        for p, h, end, stride in zip((x, y, z), spacing, ends, strides, strict=True):
            index = min(max(p / h, 0.0), end)
            cell = min(int(index), max(end - 1, 0))
            low += cell * stride
            parts.append((index - cell, stride if end else 0))
        (s, dx), (t, dy), (u, dz) = parts

        def edge(o):
            return flat[o] * (1 - u) + flat[o + dz] * u

        def face(o):
            return edge(o) * (1 - t) + edge(o + dy) * t

        return face(low) * (1 - s) + face(low + dx) * s

    return at


LIBRARY = {"distribution": "manifold3d", "imports": ["manifold3d"]}
METHODS = {
    "manifold3d": {
        "function": "surface",
        "declaration": {
            "vertices": {"own": 1.0},
            "domain": "closed",
            "conventions": {"tie": "outside", "nan": "answers"},
            "limits": {"least": 2},
            "notes": "samples on a body-centred lattice of its own; closes the surface at the "
            "border",
        },
        "does": [
            "gives it the trilinear interpolant of the samples, positive inside, continued "
            "constantly beyond the lattice",
            "asks for an edge as long as the least spacing",
        ],
    },
}
