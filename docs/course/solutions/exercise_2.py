"""Exercise 2: contours of a field of squares. Something in it was wrong.

Read lesson 2, mend this file, and ask: isograde exercise 2 exercise_2.py
"""

import numpy as np

declaration = {"name": "exercise 2", "level": 3, "limits": {"kinds": [[2, 1]]}}


def separated(a, b, c, d):
    """Whether the inside corners of an ambiguous square are apart; values minus the isovalue."""
    return a * c < b * d if a >= 0 else b * d < a * c


def extract(values, isovalue, spacing):
    """Segments on the squares between samples, the inside on their left."""
    points, segments, numbers = [], [], {}
    for i in range(values.shape[0] - 1):
        for j in range(values.shape[1] - 1):
            # The corners in the order of a walk round the square; edge k leads from k to k + 1.
            corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            g = [float(values[corner]) - isovalue for corner in corners]
            leaves = [k for k in range(4) if g[k] >= 0 and g[(k + 1) % 4] < 0]
            enters = [k for k in range(4) if g[k] < 0 and g[(k + 1) % 4] >= 0]
            for k in leaves:
                # One segment joins the only two crossings; of four, each leads to a neighbour.
                to = enters[0]
                if len(leaves) == 2:
                    to = (k - 1) % 4 if separated(*g) else (k + 1) % 4
                ends = []
                for edge in (k, to):
                    pair = (corners[edge], corners[(edge + 1) % 4])
                    name = tuple(sorted(pair))
                    if name not in numbers:
                        numbers[name] = len(points)
                        points.append(crossing(values, isovalue, name) * np.array(spacing))
                    ends.append(numbers[name])
                segments.append(ends)
    return np.array(points).reshape(-1, 2), np.array(segments, int).reshape(-1, 2)


def crossing(values, isovalue, ends):
    """Where the line between two samples takes the isovalue, in samples."""
    low, high = (float(values[end]) - isovalue for end in ends)
    start, stop = np.array(ends, float)
    return start + low / (low - high) * (stop - start)
