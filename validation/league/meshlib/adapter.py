"""MeshLib: marching cubes, and OpenVDB's dual method, of a volume of single precision."""

import numpy as np


def marching_cubes(values, isovalue, spacing):
    """The triangles; MeshLib's voxels have their samples in the middle."""
    from meshlib import mrmeshpy

    params = mrmeshpy.MarchingCubesParams()
    params.iso = isovalue
    params.lessInside = False
    vertices, triangles = arrays(mrmeshpy.marchingCubes(volume(values, spacing), params))
    return vertices - 0.5 * np.asarray(spacing), triangles


def dual(values, isovalue, spacing):
    """The triangles of the dual method."""
    from meshlib import mrmeshpy

    settings = mrmeshpy.GridToMeshSettings()
    settings.isoValue = isovalue
    settings.voxelSize = mrmeshpy.Vector3f(*spacing)
    low = float(np.nanmin(values)) if values.size else 0.0
    grid = mrmeshpy.simpleVolumeToDenseGrid(volume(values, spacing), low)
    return arrays(mrmeshpy.gridToMesh(grid, settings))


def volume(values, spacing):
    """The samples as MeshLib's volume."""
    from meshlib import mrmeshnumpy, mrmeshpy

    made = mrmeshnumpy.simpleVolumeFrom3Darray(np.ascontiguousarray(values, np.float32))
    made.voxelSize = mrmeshpy.Vector3f(*spacing)
    return made


def arrays(mesh):
    """Vertices and triangles."""
    from meshlib import mrmeshnumpy

    return mrmeshnumpy.getNumpyVerts(mesh), mrmeshnumpy.getNumpyFaces(mesh.topology)
