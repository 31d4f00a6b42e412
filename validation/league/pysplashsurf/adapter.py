"""splashsurf: marching cubes of a background grid, here of samples."""


def surface(values, isovalue, spacing):
    """The triangles, in samples."""
    import pysplashsurf

    mesh = pysplashsurf.marching_cubes(values, iso_surface_threshold=isovalue, cube_size=1.0)
    return mesh.vertices, mesh.triangles
