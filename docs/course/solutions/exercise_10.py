"""Exercise 10: isosurfaces in any dimension and codimension. Two things in it were wrong.

Read lesson 10, mend this file, and ask: isograde exercise 10 exercise_10.py
"""

from functools import cache
from itertools import combinations, permutations

import numpy as np

declaration = {
    "name": "exercise 10",
    "interpolant": "kuhn",
    "limits": {"kinds": [[2, 1], [3, 1], [3, 2], [4, 1], [4, 2]], "least": 2},
}


def kuhn(shape):
    """The simplices of all cells, n! in each, as rows of samples, and each one's orientation."""
    n = len(shape)
    for cell in np.ndindex(*np.subtract(shape, 1)):
        for order in permutations(range(n)):
            # Climb from the lowest corner to the highest, one axis after the other.
            steps = np.zeros((n + 1, n), int)
            for i, axis in enumerate(order):
                steps[i + 1 :, axis] = 1
            swaps = sum(a > b for a, b in combinations(order, 2))
            yield [tuple(v) for v in (steps + cell).tolist()], (-1) ** swaps


@cache
def staircases(p, q):
    """The ways to climb from (0, 0) to (p - 1, q - 1), one step in i or in j at a time."""
    if p == q == 1:
        return [[(0, 0)]]
    low = [[*way, (p - 1, q - 1)] for way in staircases(p - 1, q)] if p > 1 else []
    return low + ([[*way, (p - 1, q - 1)] for way in staircases(p, q - 1)] if q > 1 else [])


def orientation(high, piece):
    """The orientation of a piece of a section in a simplex that has itself 1: 1 or -1.

    high says of each vertex on which side it is; the piece is rows of a low and a high one.
    """
    corners = np.vstack([np.zeros(len(high) - 1), np.eye(len(high) - 1)])
    gradient = np.array(high[1:], float) - high[0]
    points = np.array([(corners[i] + corners[j]) / 2 for i, j in piece])
    return 1 if np.linalg.det([-gradient, *(points[1:] - points[0])]) > 0 else -1


def section(simplices, point, value):
    """The simplices of the section where the first value is 0; new vertices are added.

    A vertex is named by the sample it is, or by the two ends of the edge it lies on, the lower
    name first. point and value say of each name where it is, and the values still to be cut.
    """
    found = []
    for row, sign in simplices:
        high = [bool(value[v][0] >= 0) for v in row]
        low_at = [i for i, one in enumerate(high) if not one]
        high_at = [i for i, one in enumerate(high) if one]
        if not low_at or not high_at:
            continue
        for way in staircases(len(low_at), len(high_at)):
            piece = [(low_at[i], high_at[j]) for i, j in way]
            names = [tuple(sorted((row[i], row[j]))) for i, j in piece]
            found.append((names, sign * orientation(high, piece)))
            for name, (i, j) in zip(names, piece, strict=True):
                a, b = row[i], row[j]
                t = value[a][0] / (value[a][0] - value[b][0])
                point[name] = point[a] + t * (point[b] - point[a])
                value[name] = value[a][1:] + t * (value[b][1:] - value[a][1:])
    return found


def extract(values, isovalues, spacing):
    """The set where all components take their isovalues: simplices of dimension n - m."""
    n = len(spacing)
    fields = np.asarray(values, float).reshape(-1, *np.shape(values)[-n:])
    levels = np.atleast_1d(isovalues)
    samples = list(np.ndindex(fields.shape[1:]))
    point = {v: np.array(v, float) for v in samples}
    value = {v: fields[(slice(None), *v)] - levels for v in samples}

    # Cut by one component after the other.
    simplices = list(kuhn(fields.shape[1:]))
    for _ in levels:
        simplices = section(simplices, point, value)

    # Number the vertices, and turn those rows whose orientation is -1.
    numbers = {v: k for k, v in enumerate(dict.fromkeys(v for row, _ in simplices for v in row))}
    rows = [[numbers[v] for v in row] for row, _ in simplices]
    for row, (_, sign) in zip(rows, simplices, strict=True):
        if sign < 0:
            row[-1], row[-2] = row[-2], row[-1]
    places = np.array([point[v] for v in numbers]).reshape(-1, n) * spacing
    return places, np.array(rows, int).reshape(-1, n - len(levels) + 1)
