"""libigl: marching cubes in space, isolines of a function on triangles in the plane."""

import numpy as np


def surface(values, isovalue, spacing):
    """The surface; samples and their positions are given with the first axis fastest."""
    import igl

    samples = values.astype(np.float64).ravel(order="F")
    axes = [np.arange(n) * h for n, h in zip(values.shape, spacing, strict=True)]
    grid = np.meshgrid(*axes, indexing="ij")
    positions = np.stack([axis.ravel(order="F") for axis in grid], axis=1)
    return igl.marching_cubes(samples, positions, *values.shape, isovalue)[:2]


def isolines(values, isovalue, spacing):
    """The isolines, each square of the lattice cut from its lowest to its highest corner."""
    import igl

    number = np.arange(values.size).reshape(values.shape)
    low, right, up, high = number[:-1, :-1], number[1:, :-1], number[:-1, 1:], number[1:, 1:]
    halves = np.stack([low, right, high, low, high, up], axis=-1).reshape(-1, 3)
    places = np.indices(values.shape).reshape(2, -1).T * np.asarray(spacing)
    samples = values.ravel().astype(np.float64)
    return igl.isolines(places, halves, samples, np.array([float(isovalue)]))[:2]


LIBRARY = {"distribution": "libigl", "imports": ["igl"]}
METHODS = {
    "libigl": {
        "function": "surface",
        "declaration": {
            "conventions": {"tie": "outside", "normals": "to_high", "nan": "answers"},
        },
        "does": ["converts samples to float64"],
    },
    "libigl:isolines": {
        "function": "isolines",
        "declaration": {
            "interpolant": "kuhn",
            "conventions": {"nan": "answers"},
            "limits": {"kinds": [[2, 1]], "least": 2},
        },
        "does": ["cuts the squares of the lattice into triangles", "converts samples to float64"],
    },
}
