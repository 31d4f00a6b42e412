"""PyMCubes: `mcubes.marching_cubes`, which knows no spacing, and `marching_cubes_func`."""


def surface(values, isovalue, spacing):
    """The surface in samples."""
    import mcubes

    return mcubes.marching_cubes(values, isovalue)


def of_function(function, lower, upper, spacing, isovalue):
    """The surface of a function, sampled as finely as ours."""
    import mcubes

    counts = [1 + round(end / step) for end, step in zip(upper, spacing, strict=True)]
    return mcubes.marching_cubes_func(lower, upper, *counts, function, isovalue)


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
    "pymcubes:func": {
        "function": "of_function",
        "declaration": {
            "given": "function",
            "vertices": {"own": 1.0},
            "conventions": {"tie": "outside", "nan": "answers"},
            "limits": {"least": 2, "samples": 1_000_000},
            "notes": "asks a function of Python's sample by sample",
        },
        "does": ["asks for as many samples along each axis as the field has"],
    },
}
