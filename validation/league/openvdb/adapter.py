"""OpenVDB's Python module: its dual method, of a grid of single precision."""

import numpy as np


def surface(values, isovalue, spacing):
    """The quadrilaterals of the surface, in samples; beyond them all is below the isovalue."""
    import pyopenvdb

    samples = np.ascontiguousarray(values, np.float32)
    low = float(np.nanmin(samples)) if samples.size else 0.0
    grid = pyopenvdb.FloatGrid(low)
    grid.copyFromArray(samples)
    points, quads = grid.convertToQuads(isovalue)
    return points, np.asarray(quads, np.int64).reshape(-1, 4)
