"""scikit-image: marching cubes in space, contours in the plane."""

import numpy as np


def surface(values, isovalue, spacing, method):
    """The surface by one of the two methods of `marching_cubes`, with its normals."""
    from skimage.measure import marching_cubes

    return marching_cubes(values, isovalue, spacing=spacing, method=method)[:3]


def masked(values, isovalue, spacing):
    """The surface of all cells, each of them asked for by a mask."""
    from skimage.measure import marching_cubes

    everywhere = values.astype(bool) | True
    return marching_cubes(values, isovalue, spacing=spacing, mask=everywhere)[:2]


def without_degenerate(values, isovalue, spacing):
    """The surface without the triangles that have no area."""
    from skimage.measure import marching_cubes

    return marching_cubes(values, isovalue, spacing=spacing, allow_degenerate=False)[:2]


def every_second(values, isovalue, spacing):
    """The surface of every second sample along each axis, empty where these have none."""
    from skimage.measure import marching_cubes

    try:
        return marching_cubes(values, isovalue, spacing=spacing, step_size=2)[:2]
    except RuntimeError as error:
        if "No surface found" not in str(error) or np.isnan(isovalue):
            raise
        return np.empty((0, 3)), np.empty((0, 3), np.int64)


def contours(values, isovalue, spacing):
    """Contours with high values on their left."""
    from skimage.measure import find_contours

    lines = find_contours(values, isovalue, positive_orientation="high")
    return [line * spacing for line in lines]


LIBRARY = {"distribution": "scikit-image", "imports": ["skimage.measure"]}
_CONVENTIONS = {"tie": "outside", "normals": "to_high", "nan": "answers", "empty": "raises"}
METHODS = {
    "skimage:lewiner": {
        "function": "surface",
        "options": {"method": "lewiner"},
        "declaration": {
            "level": 4,
            "conventions": _CONVENTIONS,
            "limits": {"least": 2},
            "notes": "its documentation guarantees topologically correct results; "
            "computes in float32",
        },
    },
    "skimage:lorensen": {
        "function": "surface",
        "options": {"method": "lorensen"},
        "declaration": {
            "conventions": _CONVENTIONS,
            "limits": {"least": 2},
            "notes": "computes in float32",
        },
    },
    "skimage:masked": {
        "function": "masked",
        "declaration": {
            "conventions": _CONVENTIONS,
            "limits": {"least": 2},
            "notes": "lewiner with a mask that holds every sample",
        },
    },
    "skimage:no-degenerate": {
        "function": "without_degenerate",
        "declaration": {
            "conventions": _CONVENTIONS,
            "limits": {"least": 2},
            "notes": "lewiner with allow_degenerate=False",
        },
    },
    "skimage:step-size": {
        "function": "every_second",
        "declaration": {
            "vertices": {"own": 2.0},
            "domain": {"inset": 1.0, "end": "open"},
            "conventions": _CONVENTIONS,
            "limits": {"least": 3},
            "notes": "lewiner with step_size=2: every second sample is its lattice, and the last "
            "of an even number is beyond it",
        },
        "does": ["gives no triangles where it raises that it found no surface"],
    },
    "skimage:find-contours": {
        "function": "contours",
        "declaration": {
            "conventions": {"tie": "outside", "nan": "answers"},
            "limits": {"kinds": [[2, 1]], "least": 2},
        },
        "does": ["asks for high values on the left, and multiplies by the spacing"],
    },
}
