"""PyMCubes: `mcubes.marching_cubes`, which knows no spacing."""


def surface(values, isovalue, spacing):
    """The surface in samples."""
    import mcubes

    return mcubes.marching_cubes(values, isovalue)


LIBRARY = {"distribution": "PyMCubes", "imports": ["mcubes"]}
METHODS = {
    "pymcubes": {
        "function": "surface",
        "declaration": {
            "conventions": {"tie": "outside", "units": "index", "nan": "answers"},
            "notes": "takes the isovalue as float32",
        },
    },
}
