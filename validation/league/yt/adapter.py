"""yt: the private function behind its isocontours."""

import numpy as np


def surface(values, isovalue, spacing):
    """Triangles that each have their own three vertices."""
    from yt.utilities.lib.marching_cubes import march_cubes_grid

    corners = march_cubes_grid(
        isovalue,
        np.ascontiguousarray(values, np.float64),
        np.ones(np.subtract(values.shape, 1), np.uint8),
        np.zeros(3),
        np.asarray(spacing, np.float64),
    )
    return corners, np.arange(len(corners)).reshape(-1, 3)
