"""Beside topology: how near the meshes are to the level set, and what their triangles are like."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import posing
import pymeshlab
from isograde.cases import accuracy
from isograde.claims import accuracy as claims
from isograde.claims.accuracy import PROBES
from isograde.model import SURFACES, Adapter, Declaration, Finding, Request, Trial
from isograde.oracles.complexes import Complex
from isograde.oracles.self_intersections import self_intersections
from isograde.oracles.shapes import Shapes, shapes
from isograde.oracles.trilinear_distance import distance
from numpy.typing import NDArray
from scipy import ndimage

# The claims on orders of convergence, which rows of bodies answer.
CLAIMS = tuple(claim for claim in claims.CLAIMS if "accuracy" in claim.tags)

Floats = NDArray[np.float64]


def smooth_noise(n: int = 24, seed: int = 0) -> Floats:
    """Noise smoothed over about a spacing: every configuration, and surfaces worth the name."""
    values = ndimage.gaussian_filter(np.random.default_rng(seed).normal(size=(n,) * 3), 1.0)
    return np.asarray(np.rint(values / values.std() * 256) / 256 + 1 / 1024)


def by_meshlab(surface: Complex) -> int:
    """Number of triangles that meet others where they should not, as MeshLab counts them."""
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(surface.points, surface.simplices.astype(np.int32)))
    meshes.compute_selection_by_self_intersections_per_face()
    return int(meshes.current_mesh().selected_face_number())


@dataclass(frozen=True)
class Geometry:
    """What was measured of one implementation's answer.

    mean, worst : distance of points on triangles from the trilinear level set, and the distance
        that one in a thousand exceeds, in spacings
    astray : points from which no way led to the level set
    crossing : pairs of triangles that meet in more than they share
    by_meshlab : triangles that MeshLab says intersect others
    """

    mean: float
    worst: float
    astray: int
    shapes: Shapes
    crossing: int
    by_meshlab: int
    triangles: int


def measured(adapter: Adapter, values: Floats) -> Geometry:
    """The measures on one field."""
    answer = posing.surface(adapter, values)
    probes = np.einsum("pk,fkd->pfd", PROBES, answer.points[answer.simplices]).reshape(-1, 3)
    probes = probes[:: max(1, len(probes) // 30_000)]
    away = distance(values, 0.0, probes)
    found = away[np.isfinite(away)]
    return Geometry(
        float(found.mean()),
        float(np.quantile(found, 0.999)),
        len(away) - len(found),
        shapes(answer),
        len(self_intersections(answer.points, answer.simplices)),
        by_meshlab(answer),
        len(answer.simplices),
    )


def orders(adapter: Adapter, said: Declaration) -> dict[str, dict[str, Finding] | str]:
    """For spheres and tori, what each claim of accuracy says of them, or why there is no mesh."""
    found: dict[str, dict[str, Finding] | str] = {}
    for case in accuracy.cases():
        if "row" not in case.facts or case.kind != SURFACES:
            continue
        field = case.build()
        outcome = adapter.run(Request(case.id, "plain", field, case.isovalues))
        if outcome.mesh is None:
            found[str(case.facts["row"])] = f"no mesh: {outcome.status}, {outcome.detail}"
            continue
        trial = Trial(case, field, said, {"plain": outcome})
        asked = [c for c in CLAIMS if c.applies_to(case) and c.families(said)]
        found[str(case.facts["row"])] = {claim.id: claim.judge(trial) for claim in asked}
    return found
