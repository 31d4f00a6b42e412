"""PyTessel: marching cubes of a scalar field in a unit cell."""

import numpy as np


def surface(values, isovalue, spacing):
    """The triangles, moved so that the first sample is at the origin."""
    from pytessel import PyTessel

    cell = np.diag(np.multiply(values.shape, spacing)).astype(float)
    vertices, _, indices = PyTessel().marching_cubes(
        np.asarray(values, float).ravel("F"), values.shape, cell.ravel(), isovalue
    )
    middle = np.multiply(values.shape, spacing) / 2
    return np.reshape(vertices, (-1, 3)) + middle, np.reshape(indices, (-1, 3))
