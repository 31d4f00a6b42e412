"""The shapes of triangles: no level asks for good ones, but everybody wants to know.

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
OF_PLANES = 1 / 15
"""So many of the triangles are thin where planes at random are cut by cubes, each polygon into a
fan from any of its corners: what no more than linear crossings costs."""


@dataclass(frozen=True)
class Shapes:
    """The triangles of a mesh in a few numbers.

    median, least : of the smallest angles, in degrees; 60 at best
    thin : share of the triangles that are thin
    aspect : median of the longest side over the height on it; 1.15 at best
    """

    median: float
    thin: float
    least: float = 0.0
    aspect: float = 0.0


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
    thin, aspect = float((angles < THIN).mean()), float(np.median(aspects(mesh)))
    return Shapes(float(np.median(angles)), thin, float(angles.min()), aspect)


def aspects(mesh: Complex) -> Floats:
    """(F,) the longest side of each triangle over the height on it; infinite for no area.

    >>> points = np.array([[0, 0, 0], [2, 0, 0], [1, 1, 0.0]])
    >>> aspects(Complex.of(points, np.array([[0, 1, 2]])))
    array([2.])
    """
    corners = mesh.points[mesh.simplices]
    sides = np.roll(corners, -1, axis=1) - corners
    longest = np.linalg.norm(sides, axis=2).max(axis=1)
    doubled = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    with np.errstate(divide="ignore"):
        return np.asarray(longest**2 / doubled)
