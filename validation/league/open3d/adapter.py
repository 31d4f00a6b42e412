"""Open3D: `create_isosurfaces` of a tensor of single precision."""

import numpy as np


def surface(values, isovalue, spacing):
    """The triangles, in samples."""
    import open3d as o3d

    tensor = o3d.core.Tensor(np.ascontiguousarray(values, np.float32))
    mesh = o3d.t.geometry.TriangleMesh.create_isosurfaces(tensor, [isovalue])
    if "positions" not in mesh.vertex or "indices" not in mesh.triangle:
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    return mesh.vertex.positions.numpy(), mesh.triangle.indices.numpy()
