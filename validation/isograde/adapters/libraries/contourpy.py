"""contourpy: the lines of its default algorithm."""


def contours(values, isovalue, spacing):
    """Contours in samples; x runs along the second axis of the array."""
    from contourpy import contour_generator

    return contour_generator(z=values).lines(isovalue)


LIBRARY = {"distribution": "contourpy", "imports": ["contourpy"]}
METHODS = {
    "contourpy": {
        "function": "contours",
        "declaration": {
            "conventions": {
                "tie": "outside",
                "axes": "reversed",
                "units": "index",
                "nan": "answers",
            },
            "limits": {"kinds": [[2, 1]], "least": 2},
        },
    },
}
