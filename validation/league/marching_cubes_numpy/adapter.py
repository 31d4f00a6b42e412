"""marching-cubes-numpy: marching cubes in NumPy."""


def surface(values, isovalue, spacing):
    """The triangles, in samples."""
    from marching_cubes import marching_cubes

    return marching_cubes(values, isovalue)[:2]
