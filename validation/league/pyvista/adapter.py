"""pyvista: `contour` and `contour_labels` of an image, over VTK."""

import numpy as np


def surface(values, isovalue, spacing, method):
    """The surface by one of the methods of `contour`."""
    wider = {"b1": np.uint8, "f2": np.float32}.get(values.dtype.str[1:], values.dtype)
    image = volume(values.astype(wider, copy=False), spacing)
    return arrays(image.contour([isovalue], scalars="values", method=method))


def labels(values, isovalue, spacing, smoothing):
    """The surface round the label 1."""
    image = volume(np.asarray(values >= isovalue, np.uint8), spacing)
    return arrays(
        image.contour_labels(scalars="values", smoothing=smoothing, output_mesh_type="triangles")
    )


def volume(values, spacing):
    """An image with these samples at its points."""
    import pyvista

    image = pyvista.ImageData(dimensions=values.shape, spacing=spacing)
    image.point_data["values"] = values.ravel(order="F")
    return image


def arrays(mesh):
    """Vertices and triangles."""
    return np.asarray(mesh.points), np.asarray(mesh.faces).reshape(-1, 4)[:, 1:]
