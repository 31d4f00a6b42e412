"""Exercise 1: where a line of samples takes a value. Two things in it were wrong.

Read lesson 1, mend this file, and ask: isograde exercise 1 exercise_1.py
"""

import numpy as np

declaration = {"name": "exercise 1", "limits": {"kinds": [[1, 1]]}}


def extract(values, isovalue, spacing):
    """The points where the straight lines between neighbouring samples take the isovalue."""
    points = []
    for i in range(len(values) - 1):
        low, high = float(values[i]) - isovalue, float(values[i + 1]) - isovalue
        if (low >= 0) != (high >= 0):
            points.append([(i + low / (low - high)) * spacing[0]])
    return np.array(points).reshape(-1, 1), np.arange(len(points)).reshape(-1, 1)
