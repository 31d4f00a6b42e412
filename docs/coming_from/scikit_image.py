"""scikit-image's `skimage.measure.marching_cubes`, made of isoref."""

import numpy as np
from isoref import attributes, extract
from isoref.degenerate import without_degenerate

# Their "lorensen" separates what is high on ambiguous faces. Values are negated below: so connect.
METHODS = {"lewiner": "trilinear-cubes", "lorensen": "marching-vesta-connect-L"}


def marching_cubes(
    volume, level=None, *, spacing=(1.0, 1.0, 1.0), gradient_direction="descent",
    step_size=1, allow_degenerate=True, method="lewiner", mask=None,
):  # fmt: skip
    """Vertices, faces, normals and values, as scikit-image returns them."""
    if method not in METHODS or gradient_direction not in ("descent", "ascent"):
        raise ValueError("method is lewiner or lorensen, gradient_direction descent or ascent")
    if np.ndim(volume) != 3 or min(np.shape(volume)) < 2 or len(spacing) != 3 or step_size < 1:
        raise ValueError("a volume of 2 x 2 x 2 samples or more, 3 spacings and a step are needed")
    if mask is not None and np.shape(mask) != np.shape(volume):
        raise ValueError("volume and mask must have the same shape")
    values = np.asarray(volume, np.float32)[(slice(None, None, int(step_size)),) * 3]
    level = 0.5 * (values.min() + values.max()) if level is None else float(level)
    if not values.min() <= level <= values.max():
        raise ValueError("the level must lie between the least and the greatest sample")

    # Their inside is value > level, ours value >= isovalue: negated, the two are each other's rest.
    steps = np.multiply(spacing, int(step_size))
    mesh = extract(-values, -level, tuple(steps), method=METHODS[method], provenance=True)
    if mask is not None:
        marked = np.asarray(mask)[(slice(None, None, int(step_size)),) * 3]
        mesh = attributes.without_cells(mesh, ~marked[1:, 1:, 1:])
    normals = -attributes.normals(mesh)
    ends = np.maximum(mesh.traced().ends, mesh.traced().ends[:, :1])  # -1 inside a cell
    nearby = values.reshape(-1)[ends].max(axis=1)
    if not allow_degenerate:
        removal = without_degenerate(mesh, manifold=False)
        mesh, normals, nearby = removal.mesh, normals[removal.kept], nearby[removal.kept]
    if not len(mesh.simplices):
        raise RuntimeError("no surface at this level")
    faces = mesh.simplices if gradient_direction == "descent" else mesh.simplices[:, ::-1]
    kind = "f4" if np.array_equal(spacing, (1, 1, 1)) else "f8"
    return mesh.vertices.astype(kind), faces.astype("i4"), normals.astype("f4"), nearby
