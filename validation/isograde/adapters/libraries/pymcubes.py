"""PyMCubes: `mcubes.marching_cubes`, which knows no spacing."""


def surface(values, isovalue, spacing):
    """The surface in samples."""
    import mcubes

    return mcubes.marching_cubes(values, isovalue)


LIBRARY = {"distribution": "PyMCubes", "imports": ["mcubes"]}
# It raises "data type not supported" for float16.
_WHOLE = [f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)]
_TYPES = ["float32", "float64", "bool", *_WHOLE]
METHODS = {
    "pymcubes": {
        "function": "surface",
        "declaration": {
            "conventions": {"tie": "outside", "units": "index", "nan": "answers"},
            "limits": {"types": _TYPES},
            "notes": "takes the isovalue as float32",
        },
    },
}
