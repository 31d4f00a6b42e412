"""Beside topology: how near the meshes are to the level set, and what their triangles are like."""

from __future__ import annotations

from dataclasses import dataclass

import agreement as agree
import numpy as np
import pymeshlab
from isograde.claims.accuracy import CLAIMS
from isograde.fields import accuracy
from isograde.model import Case, Declaration, Door, Finding, Request, Trial
from isograde.truths.halfedges import Surface
from numpy.typing import NDArray
from scipy import ndimage

Floats = NDArray[np.float64]
# Corners, middles of sides and the middle of a triangle.
PROBES = np.array([[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4], [3, 3, 0], [0, 3, 3], [3, 0, 3]])


def smooth_noise(n: int = 24, seed: int = 0) -> Floats:
    """Noise smoothed over about a spacing: every configuration, and surfaces worth the name."""
    values = ndimage.gaussian_filter(np.random.default_rng(seed).normal(size=(n,) * 3), 1.0)
    return np.asarray(np.rint(values / values.std() * 256) / 256 + 1 / 1024)


def value_and_gradient(values: Floats, points: Floats) -> tuple[Floats, Floats]:
    """F (n,) and its gradient (n, 3) of the trilinear interpolant."""
    cell = np.clip(np.floor(points).astype(int), 0, np.array(values.shape) - 2)
    t = points - cell
    total, slope = np.zeros(len(points)), np.zeros((len(points), 3))
    for corner in np.ndindex(2, 2, 2):
        sample = values[tuple((cell + np.array(corner)).T)]
        weights = np.where(np.array(corner), t, 1 - t)
        total += sample * weights.prod(axis=1)
        for axis in range(3):
            others = np.delete(weights, axis, axis=1).prod(axis=1)
            slope[:, axis] += sample * others * (1 if corner[axis] else -1)
    return total, slope


def distance(values: Floats, points: Floats, steps: int = 20) -> Floats:
    """How far Newton's steps along the gradient move points onto the level set, each in its cell.

    An upper bound of the distance; points whose walk ends off the level set are left out.
    """
    at = points.copy()
    low = np.clip(np.floor(points), 0, np.array(values.shape) - 2)
    for _ in range(steps):
        value, slope = value_and_gradient(values, at)
        size = np.maximum((slope**2).sum(axis=1, keepdims=True), 1e-12)
        at = np.clip(at - value[:, None] * slope / size, low, low + 1 - 1e-9)
    arrived = np.abs(value_and_gradient(values, at)[0]) < 1e-6
    return np.asarray(np.linalg.norm(at - points, axis=1)[arrived])


def smallest_angles(surface: Surface) -> Floats:
    """The smallest angle of each triangle, in degrees."""
    corners = surface.points[surface.faces]
    sides = np.roll(corners, -1, axis=1) - corners
    back = -np.roll(sides, 1, axis=1)
    lengths = np.linalg.norm(sides, axis=2) * np.linalg.norm(back, axis=2)
    cosine = (sides * back).sum(axis=2) / np.maximum(lengths, 1e-300)
    return np.asarray(np.degrees(np.arccos(np.clip(cosine, -1, 1))).min(axis=1))


def self_intersections(surface: Surface) -> int:
    """Number of triangles that meet others where they should not, as MeshLab counts them."""
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(surface.points, surface.faces.astype(np.int32)))
    meshes.compute_selection_by_self_intersections_per_face()
    return int(meshes.current_mesh().selected_face_number())


@dataclass(frozen=True)
class Geometry:
    """What was measured of one implementation's answer."""

    mean: float
    worst: float
    median_angle: float
    slivers: float
    crossing: int
    triangles: int


def measured(door: Door, values: Floats) -> Geometry:
    """The measures on one field."""
    answer = agree.surface(door, values)
    corners = answer.points[answer.faces]
    probes = np.einsum("pk,fkd->pfd", PROBES / 6, corners).reshape(-1, 3)
    probes = probes[:: max(1, len(probes) // 30_000)]
    away, angles = distance(values, probes), smallest_angles(answer)
    return Geometry(
        float(away.mean()),
        float(np.quantile(away, 0.999)),
        float(np.median(angles)),
        float((angles < 5).mean()),
        self_intersections(answer),
        len(answer.faces),
    )


def orders(door: Door, said: Declaration) -> dict[str, list[Finding]]:
    """What each claim of accuracy says of the rows of spheres and of tori."""
    found: dict[str, list[Finding]] = {}
    for case in accuracy.cases():
        trial = _trial(door, said, case)
        for claim in CLAIMS:
            if trial is not None and not claim.unless & said.without:
                found.setdefault(claim.id, []).append(claim.judge(trial))
    return found


def _trial(door: Door, said: Declaration, case: Case) -> Trial | None:
    """The case and its answer, where there is one."""
    field = case.build()
    outcome = door.run(Request(case.id, "plain", field, case.isovalue))
    return None if outcome.mesh is None else Trial(case, field, said, {"plain": outcome})
