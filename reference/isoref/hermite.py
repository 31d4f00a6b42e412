r"""Curves of higher order through the points of Marching Faces, by their tangents.

Marching Faces finds points of an intersection curve, and a tangent at each. "The estimated tangent
can also be used as the direction of the curves' first order derivative for higher order curves":
between two neighbouring points runs the cubic that has both points and both tangents::

    p(t) = h00 p0 + h10 c T0 + h01 p1 + h11 c T1    c = |p1 - p0|
    h00 = (1 + 2 t)(1 - t)^2                        h10 = t (1 - t)^2
    h01 = t^2 (3 - 2 t)                             h11 = t^2 (t - 1)

The curve is smooth in its direction at every point. If points and tangents are exact it is of
fourth order in the distance of the points, where the polyline is of second. The points of Marching
Faces are themselves of second order only: there the gain is smoothness.

Glossary
--------
p, T        points and unit tangents, T along the curve
c           the chord between two points: the speed at both ends
parts       into how many pieces each segment is cut when a curve is sampled

Invariants
----------
The points are on the curve. A point whose tangent is 0 (parallel gradients, no confidence) takes
the direction from the point before to the point after.

References
----------
1. P. Ljung, A. Ynnerman, Extraction of intersection curves from iso-surfaces on co-located 3D
   grids, section 6.
2. C. de Boor, K. Höllig, M. Sabin, "High accuracy geometric Hermite interpolation", CAGD 4, 1987:
   orders of curves from points and directions.
"""

from __future__ import annotations

import numpy as np

from isoref.curves import Curve, moved_on
from isoref.fast.marching_faces import Pair, join, marching_faces
from isoref.field import Field, Floats
from isoref.marching_faces import FaceRule, units


def smooth_curves(
    first: Field,
    second: Field,
    isovalues: tuple[float, float] = (0.0, 0.0),
    rule: FaceRule = "gradient",
    parts: int = 4,
) -> list[Curve]:
    """The curves in which two isosurfaces meet, each segment sampled on its cubic.

    Parameters and errors are those of `isoref.marching_faces.intersection_curves`; `parts` is the
    number of pieces of a segment, at least 1.
    """
    points = marching_faces(first, second, isovalues, rule)
    found = []
    for chain, closed in join(points, Pair(first, second, isovalues, rule)):
        places, tangents = points.positions[chain], points.tangents[chain]
        new = moved_on(places, closed)
        if new.sum() > 1:
            found.append(Curve(hermite(places[new], tangents[new], closed, parts), closed))
    return found


def hermite(points: Floats, tangents: Floats, closed: bool, parts: int = 4) -> Floats:
    """Samples (K, d) of the cubics through points (P, d) with unit tangents (P, d).

    An open curve has (P - 1) parts + 1 of them, a closed one P parts, its first not repeated.

    Raises
    ------
    ValueError
        for fewer than two points, arrays of two shapes, or no parts

    >>> hermite(np.array([[0.0, 0], [1, 0]]), np.array([[1.0, 0], [1, 0]]), False, 2).tolist()
    [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0]]
    """
    if points.shape != tangents.shape or points.ndim != 2 or len(points) < 2 or parts < 1:
        raise ValueError(
            f"points {points.shape}, tangents {tangents.shape}, {parts} parts: give at least two "
            "points, a tangent for each, and at least one part"
        )
    directions = completed(points, tangents, closed)
    after = np.roll(np.arange(len(points)), -1)[: None if closed else -1]
    p0, p1 = points[: len(after)], points[after]
    chord = np.linalg.norm(p1 - p0, axis=1, keepdims=True)
    v0, v1 = chord * directions[: len(after)], chord * directions[after]
    t = np.arange(parts)[:, None, None] / parts
    samples = (
        (1 + 2 * t) * (1 - t) ** 2 * p0
        + t * (1 - t) ** 2 * v0
        + t**2 * (3 - 2 * t) * p1
        + t**2 * (t - 1) * v1
    )
    rows = samples.transpose(1, 0, 2).reshape(-1, points.shape[1])
    return rows if closed else np.concatenate([rows, points[-1:]])


def completed(points: Floats, tangents: Floats, closed: bool) -> Floats:
    """Unit tangents, those that are 0 replaced by the direction of the neighbours.

    >>> completed(np.array([[0.0, 0], [1, 0], [2, 0]]), np.zeros((3, 2)), False).tolist()
    [[1.0, 0.0], [1.0, 0.0], [1.0, 0.0]]
    """
    index = np.arange(len(points))
    before, after = (np.roll(index, 1), np.roll(index, -1))
    if not closed:
        before[0], after[-1] = 0, len(points) - 1
    directions = units(points[after] - points[before])
    here = units(tangents)
    known = (here != 0).any(axis=1, keepdims=True)
    return np.asarray(np.where(known, here, directions))
