"""Claims on accuracy, beside the ladder: errors shrink as fast as theory says.

A row of similar bodies in one field gives the errors at six resolutions. The observed order of
each must not be below the formal one, which linear interpolation along the edges of the lattice
has: 2 for position, area, volume and the distance of the triangles from the trilinear surface
itself, 1 for normals and for total mean curvature. Thin triangles spoil normals, so what shapes
the triangles have is measured beside them; no order is asked of it.

An order is below the formal one when its whole confidence interval is, by more than `SLACK`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from isograde.cases.accuracy import SCALES, Body, row
from isograde.claims.evidence import failed, on_triangles, passed, remembered, skipped
from isograde.model import Claim, Finding, Trial
from isograde.oracles.convergence import normal_error, observed_order, total_mean_curvature
from isograde.oracles.halfedges import Surface
from isograde.oracles.shapes import shapes
from isograde.oracles.trilinear_distance import distance

SLACK = 0.15
# The middle of a triangle and of each side.
PROBES = np.array([[2, 2, 2], [3, 3, 0], [0, 3, 3], [3, 0, 3]]) / 6
ETIENE = "Etiene and others 2009, section 4: observed order against the formal one"


@dataclass(frozen=True, eq=False)
class Piece:
    """What the mesh has of one body."""

    body: Body
    surface: Surface
    trial: Trial

    @property
    def position(self) -> float:
        """Largest distance of a vertex in use from the body, over its scale."""
        used = self.surface.points[self.surface.used]
        return float(np.abs(self.body.distance(used)).max() / self.body.scale)

    @property
    def normal(self) -> float:
        """Root mean square angle of the faces' normals, in radians."""
        middles = self.surface.points[self.surface.faces].mean(axis=1)
        return normal_error(self.surface, self.body.normals(middles))

    @property
    def distance(self) -> float:
        """Largest distance of the triangles from the trilinear surface, over the body's scale.

        Taken at the middles of triangles and of their sides; infinite where no surface is near.
        """
        corners = self.surface.points[self.surface.faces]
        probes = np.einsum("pk,fkd->pfd", PROBES, corners).reshape(-1, 3)
        away = distance(self.trial.field.values, self.trial.case.isovalue, probes)
        return float(np.nan_to_num(away, nan=np.inf).max() / self.body.scale)

    @property
    def area(self) -> float:
        """Relative error of the area."""
        return abs(self.surface.area / self.body.area - 1)

    @property
    def volume(self) -> float:
        """Relative error of the volume, whichever way the faces turn."""
        return abs(abs(self.surface.volume) / self.body.volume - 1)

    @property
    def bend(self) -> float:
        """Relative error of the total mean curvature, whichever way the faces turn."""
        return abs(abs(total_mean_curvature(self.surface)) / self.body.bend - 1)


def pieces(trial: Trial) -> list[Piece]:
    """The mesh cut into one piece a body: each face belongs to the nearest."""

    def compute() -> list[Piece]:
        shape = next(name for name in SCALES if trial.case.id == f"accuracy/{name}")
        bodies, _ = row(shape)
        surface = Surface.of(trial.mesh.vertices.astype(float), trial.mesh.simplices).welded()
        middles = surface.points[surface.faces].mean(axis=1)
        nearest = np.argmin([np.abs(body.distance(middles)) for body in bodies], axis=0)
        return [
            Piece(body, Surface.of(surface.points, surface.faces[nearest == i]), trial)
            for i, body in enumerate(bodies)
        ]

    return remembered(trial, "accuracy pieces", compute)


def converges(
    trial: Trial,
    *,
    error: Callable[[Piece], float],
    formal: float,
    also: Callable[[Surface], dict[str, float]] | None,
) -> Finding:
    """Pass when the observed order is not below the formal one.

    `also` measures the finest body's surface for the report.
    """
    if trial.case.id not in {f"accuracy/{shape}" for shape in SCALES}:
        return skipped("a part of the case has no whole row of bodies")
    found = pieces(trial)
    if not all(len(piece.surface.faces) for piece in found):
        return skipped("a body has no surface: see the claims of level 1")
    h = [1 / piece.body.scale for piece in found]
    errors = [error(piece) for piece in found]
    order = observed_order(h, errors)
    numbers = {
        "order": round(order.value, 3),
        "interval": [round(order.low, 3), round(order.high, 3)],
        "formal": formal,
        "finest_error": errors[-1],
        **(also(found[-1].surface) if also else {}),
    }
    if order.high >= formal - SLACK:
        return passed(**numbers)
    return failed(
        f"order {order.value:.2f} (95 %: {order.low:.2f} to {order.high:.2f}), formally "
        f"{formal:g}; error {errors[0]:.2g} at h = {h[0]:.2g}, {errors[-1]:.2g} at h = {h[-1]:.2g}",
        **numbers,
    )


def thinness(surface: Surface) -> dict[str, float]:
    """The shapes of the triangles as figures: no order, and no threshold."""
    found = shapes(surface)
    return {
        "median_smallest_angle": round(found.median, 1),
        "thin_triangles": round(found.thin, 4),
    }


def _claim(
    name: str,
    what: str,
    formal: float,
    error: Callable[[Piece], float],
    also: Callable[[Surface], dict[str, float]] | None = None,
) -> Claim:
    """A claim of this family: beside the ladder, on the bodies of `isograde.cases.accuracy`."""
    return Claim(
        id=f"accuracy.{name}",
        rule=f"{what} shrinks at least with order {formal:g} as a smooth body is sampled more "
        f"finely, to within {SLACK:g} of the 95 % confidence interval.",
        source=ETIENE,
        level=None,
        judge=on_triangles(partial(converges, error=error, formal=formal, also=also)),
        tags=frozenset({"accuracy"}),
        unless=frozenset({"linear-crossing"}),
    )


CLAIMS = (
    _claim("position", "The largest distance of a vertex", 2, lambda piece: piece.position),
    _claim("normal", "The error of the faces' normals", 1, lambda piece: piece.normal, thinness),
    _claim(
        "distance",
        "The largest distance of the triangles from the trilinear surface",
        2,
        lambda piece: piece.distance,
    ),
    _claim("area", "The error of the area", 2, lambda piece: piece.area),
    _claim("volume", "The error of the volume", 2, lambda piece: piece.volume),
    _claim("curvature", "The error of the total mean curvature", 1, lambda piece: piece.bend),
)
