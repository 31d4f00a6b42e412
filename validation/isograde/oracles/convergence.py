"""How fast errors shrink: the observed order, with its confidence interval.

An error that behaves as C h^p is a straight line of slope p in logarithms. The slope fitted to a
few resolutions is the observed order; the spread of the points about the line gives the interval
in which the order lies with 95 % confidence. It is compared with the formal order, which theory
gives for an extractor without faults.

References
----------
1. T. Etiene, C. Scheidegger, L. G. Nonato, R. M. Kirby, C. Silva: Verifiable visualization for
   isosurface extraction. IEEE TVCG 15(6), 2009, section 4.
2. D. Cohen-Steiner, J.-M. Morvan: Restricted Delaunay triangulations and normal cycle. SoCG 2003
   (total mean curvature from the angles at edges).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from isoref.field import Floats
from numpy.typing import ArrayLike
from scipy.special import stdtrit

from isograde.oracles.complexes import Complex


@dataclass(frozen=True)
class Order:
    """An observed order and its 95 % confidence interval."""

    value: float
    low: float
    high: float


def observed_order(h: ArrayLike, error: ArrayLike) -> Order:
    """The slope of log error over log h, by least squares.

    >>> h = np.array([1, 2, 4, 8.0])
    >>> round(observed_order(h, 3 * h**2).value, 12)
    2.0
    """
    x, y = np.log(np.asarray(h, float)), np.log(np.maximum(error, np.finfo(float).tiny))
    n = len(x)
    deviation = x - x.mean()
    slope = float(deviation @ y / (deviation @ deviation))
    residual = y - y.mean() - slope * deviation
    spread = np.sqrt(residual @ residual / (n - 2) / (deviation @ deviation))
    half = float(stdtrit(n - 2, 0.975) * spread)
    return Order(slope, slope - half, slope + half)


def total_mean_curvature(mesh: Complex) -> float:
    """Half the sum over edges of length times the angle by which the normal turns; closed meshes.

    Angles are positive where the surface is convex, seen from the side the normals point to.
    """
    edges = mesh.facets
    two = edges.uses == 2
    first, second = edges.sides[edges.start[two]], edges.sides[edges.start[two] + 1]
    normal = _unit(mesh.normals)
    ends = mesh.points[edges.rows[two]]
    way = ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(way, axis=1)
    one, other = normal[first // 3], normal[second // 3]
    sine = (np.cross(one, other) * way).sum(axis=1) / np.maximum(length, np.finfo(float).tiny)
    angle = np.arctan2(sine, (one * other).sum(axis=1))
    upwards = np.where(mesh.simplices.reshape(-1)[first] == edges.rows[two][:, 0], 1, -1)
    return float((length * angle * upwards).sum() / 2)


def normal_error(mesh: Complex, normals: Floats) -> float:
    """Root mean square angle of the simplices against `normals` (S, m, n), by measure.

    Of each simplex the largest angle between a direction in it and the space at right angles to
    its orthonormal `normals`; either side up.
    """
    size = mesh.measures
    kept = size > 0
    place = mesh.points[mesh.simplices[kept]]
    # Span each simplex by orthonormal vectors; what of them is along the normals is the sine.
    span, _ = np.linalg.qr((place[:, 1:] - place[:, :1]).transpose(0, 2, 1))
    sine = np.linalg.norm(normals[kept] @ span, ord=2, axis=(1, 2))
    angle = np.arcsin(np.clip(sine, 0, 1))
    return float(np.sqrt((size[kept] * angle**2).sum() / size.sum()))


def _unit(vectors: Floats) -> Floats:
    """The directions; zero where there is none."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors / np.maximum(length, np.finfo(float).tiny))
