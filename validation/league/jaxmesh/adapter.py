"""jaxmesh: marching tetrahedra in JAX."""

import numpy as np


def surface(values, isovalue, spacing):
    """The triangles."""
    import jaxmesh

    axes = [np.arange(n, dtype=np.float32) * s for n, s in zip(values.shape, spacing, strict=True)]
    mesh = jaxmesh.marching_tetrahedra(
        np.asarray(values, np.float32), jaxmesh.rectilinear_grid(*axes), level=isovalue
    )
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)
