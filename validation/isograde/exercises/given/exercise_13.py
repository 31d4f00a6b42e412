"""Exercise 13: contours that were tried on a circle. Four things in it are wrong.

Read lesson 13, mend this file, and ask: isograde exercise 13 exercise_13.py
"""

import numpy as np

declaration = {"name": "exercise 13", "level": 3, "limits": {"kinds": [[2, 1]]}}


def separated(a, b, c, d):
    """Whether the inside corners of an ambiguous square are apart; values minus the isovalue."""
    return a * c < b * d if a >= 0 else b * d < a * c


def extract(values, isovalue, spacing):
    """Segments on the squares between samples, the inside on their left."""
    values -= isovalue
    points, segments, numbers = [], [], {}
    for i, j in np.ndindex(*np.subtract(values.shape, 1)):
        # The corners in the order of a walk round the square; edge k leads from k to k + 1.
        corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
        g = [float(values[corner]) for corner in corners]
        leaves = [k for k in range(4) if g[k] > 0 > g[(k + 1) % 4]]
        enters = [k for k in range(4) if g[k] < 0 < g[(k + 1) % 4]]
        for k in leaves:
            to = enters[0]
            if len(leaves) == 2:
                to = (k - 1) % 4 if separated(*g) else (k + 1) % 4
            segment = []
            for edge in (k, to):
                ends = tuple(sorted((corners[edge], corners[(edge + 1) % 4])))
                place = crossing(values, ends) * np.array(spacing)
                name = tuple(np.round(place, 2))
                if name not in numbers:
                    numbers[name] = len(points)
                    points.append(place)
                segment.append(numbers[name])
            segments.append(segment)
    return np.array(points).reshape(-1, 2), np.array(segments, int).reshape(-1, 2)


def crossing(values, ends):
    """Where the line between two samples passes zero, in samples."""
    low, high = (float(values[end]) for end in ends)
    start, stop = np.array(ends, float)
    t = min(max(low / (low - high), 0.01), 0.99)
    return start + t * (stop - start)
