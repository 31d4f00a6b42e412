"""trimesh: `matrix_to_marching_cubes`, which takes inside and outside, and no values."""


def surface(values, isovalue, spacing):
    """The surface round the samples inside."""
    from trimesh.voxel.ops import matrix_to_marching_cubes

    return matrix_to_marching_cubes(values >= isovalue, pitch=spacing)


LIBRARY = {"distribution": "trimesh", "imports": ["trimesh.voxel.ops", "skimage.measure"]}
METHODS = {
    "trimesh": {
        "function": "surface",
        "declaration": {
            "interpolant": "labels",
            "domain": {"inset": -0.5, "end": "closed"},
            "conventions": {"nan": "answers", "empty": "raises"},
            "notes": "pads the samples, and calls scikit-image",
        },
        "does": ["gives it booleans, values >= isovalue"],
    },
}
