"""PyMCubes' `marching_cubes` and `marching_cubes_func`, made of isoref."""

import numpy as np
from isoref import extract

# Its table joins high corners on every ambiguous face; negated, it separates them.
METHOD = "marching-vesta-disconnect-L"


def marching_cubes(volume, isovalue):
    """Vertices (V, 3) and triangles (T, 3), normals towards lower values."""
    # A sample equal to the isovalue is outside there: negated it is inside here, the rest outside.
    mesh = extract(-np.asarray(volume, np.float64), -float(isovalue), method=METHOD)
    return mesh.vertices, mesh.simplices[:, ::-1].astype(np.uint64)


def marching_cubes_func(lower, upper, numx, numy, numz, f, isovalue):
    """The surface of a function of x, y and z, sampled on a lattice between two corners."""
    numbers = numx, numy, numz
    axes = [np.linspace(*ends) for ends in zip(lower, upper, numbers, strict=True)]
    volume = np.array([[[f(x, y, z) for z in axes[2]] for y in axes[1]] for x in axes[0]])
    vertices, triangles = marching_cubes(volume, isovalue)
    steps = np.subtract(upper, lower) / np.subtract(numbers, 1)
    return vertices * steps + lower, triangles
