"""PyGEL3D: a half-edge mesh of the isosurface; faces are read one by one."""

from itertools import pairwise

import numpy as np


def surface(values, isovalue, spacing, dual):
    """The polygons of the mesh, cut into triangles from their first corner."""
    from pygel3d import hmesh

    high = [(n - 1) * step for n, step in zip(values.shape, spacing, strict=True)]
    mesh = hmesh.volumetric_isocontour(
        np.asfortranarray(values, np.float32),
        bbox_min=[0.0, 0.0, 0.0],
        bbox_max=high,
        tau=isovalue,
        dual_connectivity=dual,
    )
    triangles = []
    for face in mesh.faces():
        first, *rest = mesh.circulate_face(face)
        triangles += [(first, a, b) for a, b in pairwise(rest)]
    return np.array(mesh.positions()), np.array(triangles, np.int64).reshape(-1, 3)
