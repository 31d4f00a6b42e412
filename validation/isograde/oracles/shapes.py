"""The shapes of triangles: no claim asks for good ones, but everybody wants to know.

References
----------
1. J. R. Shewchuk: What is a good linear finite element? 2002 (small angles spoil matrices, large
   ones spoil gradients and normals).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from isoref.field import Floats

from isograde.oracles.complexes import Complex

THIN = 5.0
"""Degrees: a triangle with a smaller angle is counted as thin."""


@dataclass(frozen=True)
class Shapes:
    """The triangles of a mesh in two numbers.

    median : of the smallest angles, in degrees; 60 at best
    thin : share of the triangles that are thin
    """

    median: float
    thin: float


def smallest_angles(mesh: Complex) -> Floats:
    """(F,) the smallest angle of each triangle, in degrees.

    >>> points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]])
    >>> smallest_angles(Complex.of(points, np.array([[0, 1, 2]]))).round(9)
    array([45.])
    """
    corners = mesh.points[mesh.simplices]
    sides = np.roll(corners, -1, axis=1) - corners
    back = -np.roll(sides, 1, axis=1)
    area = np.linalg.norm(np.cross(sides, back), axis=2)
    return np.asarray(np.degrees(np.arctan2(area, (sides * back).sum(axis=2))).min(axis=1))


def shapes(mesh: Complex) -> Shapes:
    """The shapes of a mesh that has triangles."""
    angles = smallest_angles(mesh)
    return Shapes(float(np.median(angles)), float((angles < THIN).mean()))
