"""An extractor to grade: marching cubes as it was drawn in 1987, from isoref."""

from isoref import METHODS, Field


def extract(values, isovalue, spacing):
    """Vertices (V, 3) and triangles (F, 3) of the isosurface."""
    mesh = METHODS["lorensen-cline"](Field.of(values, spacing), isovalue)
    return mesh.vertices, mesh.simplices
