"""Claims on accuracy, beside the ladder: errors shrink as fast as theory says.

A row of similar bodies in one field gives the errors at several resolutions. The observed order of
each must not be below the formal one. Linear interpolation along the edges of the lattice, or of a
split, has order 2 for position, for length, area and the like, for volume, and for the distance of
triangles from the trilinear surface itself; it has order 1 for normals and for total mean
curvature. Vertices of `cells` and of a lattice of its own are averages of such points, with the
same orders for position, measure and volume; of their normals nothing is promised. Labels have
order 1 for position and volume, and no order for the rest. Thin triangles spoil normals, so what
shapes the triangles have is measured beside them; no order is asked of it.

An order is below the formal one when its whole confidence interval is, by more than `SLACK`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from isoref.field import Floats

from isograde.cases.accuracy import Body, row
from isograde.claims.curves import on_edges
from isograde.claims.evidence import (
    complex_of,
    failed,
    lattice_of,
    on_mesh,
    passed,
    place,
    remembered,
    skipped,
)
from isograde.declaration import Declaration
from isograde.model import SURFACES, Claim, Finding, Kind, Trial, every_family, every_kind
from isograde.oracles.complexes import Complex
from isograde.oracles.convergence import normal_error, observed_order, total_mean_curvature
from isograde.oracles.shapes import OF_PLANES, THIN, shapes
from isograde.oracles.trilinear_distance import distance

SLACK = 0.15
# Normals within this angle of the body's, in radians, are taken for exact.
EXACT = 1e-3
# The middle of a triangle and of each side.
PROBES = np.array([[2, 2, 2], [3, 3, 0], [0, 3, 3], [3, 0, 3]]) / 6
NO_DIRECTION = "a normal has no length, or is not finite"
ETIENE = "Etiene and others 2009, section 4: observed order against the formal one"


@dataclass(frozen=True, eq=False)
class Piece:
    """What the mesh has of one body, in cells."""

    body: Body
    mesh: Complex
    trial: Trial

    @property
    def position(self) -> float:
        """Largest distance of a vertex in use from the body, over its scale."""
        used = self.mesh.points[self.mesh.used]
        return float(np.abs(self.body.distance(used)).max() / self.body.scale)

    @property
    def normal(self) -> float:
        """Root mean square angle between simplices and body, in radians."""
        middles = self.mesh.points[self.mesh.simplices].mean(axis=1)
        return normal_error(self.mesh, self.body.normals(middles))

    @property
    def distance(self) -> float:
        """Largest distance of the triangles from the trilinear surface, over the body's scale.

        Taken at the middles of triangles and of their sides; infinite where no surface is near.
        """
        corners = self.mesh.points[self.mesh.simplices]
        probes = np.einsum("pk,fkd->pfd", PROBES, corners).reshape(-1, 3)
        away = distance(self.trial.field.values, self.trial.isovalues[0], probes)
        return float(np.nan_to_num(away, nan=np.inf).max() / self.body.scale)

    @property
    def measure(self) -> float:
        """Relative error of length, area, .."""
        return abs(self.mesh.measure / self.body.measure - 1)

    @property
    def volume(self) -> float:
        """Relative error of the volume, whichever way the simplices turn."""
        return abs(abs(self.mesh.enclosed) / self.body.volume - 1)

    @property
    def bend(self) -> float:
        """Relative error of the total mean curvature, whichever way the triangles turn."""
        return abs(abs(total_mean_curvature(self.mesh)) / self.body.bend - 1)


def pieces(trial: Trial) -> list[Piece]:
    """The mesh cut into one piece a body: each simplex belongs to the nearest."""

    def compute() -> list[Piece]:
        bodies, _ = row(trial.case.facts["row"])
        mesh = complex_of(trial).welded()
        middles = mesh.points[mesh.simplices].mean(axis=1)
        nearest = np.argmin([np.abs(body.distance(middles)) for body in bodies], axis=0)
        return [
            Piece(body, Complex(mesh.points, mesh.simplices[nearest == i]), trial)
            for i, body in enumerate(bodies)
        ]

    return remembered(trial, "accuracy pieces", compute)


def converges(
    trial: Trial,
    *,
    error: Callable[[Piece], float],
    formal: float,
    of_labels: float,
    also: Callable[[Complex], dict[str, float]] | None,
) -> Finding:
    """Pass when the observed order is not below the formal one.

    `also` measures the finest body's triangles for the report.
    """
    if "row" not in trial.case.facts:
        return skipped("a part of the case has no whole row of bodies")
    found = pieces(trial)
    if not all(len(piece.mesh.simplices) for piece in found):
        return skipped("a body is missing: see the claims on bodies")
    order_due = of_labels if trial.declaration.interpolant == "labels" else formal
    h = [1 / piece.body.scale for piece in found]
    errors = [error(piece) for piece in found]
    more = also(found[-1].mesh) if also and trial.kind == SURFACES else {}
    return _in_order(h, errors, order_due, more)


def _in_order(
    h: list[float], errors: list[float], order_due: float, more: dict[str, float]
) -> Finding:
    """Pass when the order of these errors is not below the formal one; `more` is shown beside."""
    order = observed_order(h, errors)
    numbers = {
        "order": round(order.value, 3),
        "interval": [round(order.low, 3), round(order.high, 3)],
        "formal": order_due,
        "finest_error": errors[-1],
        **more,
    }
    if order.high >= order_due - SLACK:
        return passed(**numbers)
    return failed(
        f"order {order.value:.2f} (95 %: {order.low:.2f} to {order.high:.2f}), formally "
        f"{order_due:g}; error {errors[0]:.2g} at h = {h[0]:.2g}, {errors[-1]:.2g} at "
        f"h = {h[-1]:.2g}",
        **numbers,
    )


def returned(trial: Trial) -> Finding:
    """Pass when the normals that came with the vertices approach those of the body.

    They may point to high values or to low, all of them alike.
    """
    normals = trial.plain.normals
    if normals is None or trial.mesh.vertices.shape != normals.shape:
        return skipped("no normals came with the vertices")
    if "row" not in trial.case.facts:
        return skipped("a part of the case has no whole row of bodies")
    bodies, _ = row(trial.case.facts["row"])
    used = np.unique(trial.mesh.simplices)
    points = lattice_of(trial).index(trial.mesh.vertices[used])
    directions = _directions(normals[used])
    if directions is None:
        return failed(NO_DIRECTION)
    nearest = np.argmin([np.abs(body.distance(points)) for body in bodies], axis=0)
    cosines = np.zeros(len(used))
    for number, body in enumerate(bodies):
        here = nearest == number
        if not here.any():
            return skipped("a body is missing: see the claims on bodies")
        right = body.normals(points[here])[:, 0]
        cosines[here] = (directions[here] * right).sum(axis=1)
    side = 1.0 if np.median(cosines) > 0 else -1.0
    angle = np.arccos(np.clip(side * cosines, -1, 1))
    errors = [float(np.sqrt((angle[nearest == n] ** 2).mean())) for n in range(len(bodies))]
    if max(errors) < EXACT:  # What a function's gradient gives does not shrink.
        return passed(finest_error=errors[-1])
    return _in_order([1 / body.scale for body in bodies], errors, 1.0, {})


def normals_of_a_plane(trial: Trial) -> Finding:
    """Pass when the normals that came with the vertices are those of the plane, at its rim too.

    Differences of neighbouring samples give the slope of an affine field exactly: over two cells,
    and on the border of the volume over one. Normals of triangles are those of the plane as well.
    They may point to high values or to low, all of them alike.
    """
    normals, known = trial.plain.normals, trial.case.facts.get("manifold")
    if normals is None or trial.mesh.vertices.shape != normals.shape:
        return skipped("no normals came with the vertices")
    used = np.unique(trial.mesh.simplices)
    if known is None or not len(used):
        return skipped("the plane is not known, or nothing of it was drawn")
    directions = _directions(normals[used])
    if directions is None:
        return failed(NO_DIRECTION)
    points = trial.mesh.vertices[used]
    slope = known.gradients(points[:1])[0, 0]
    cosines = directions @ slope / np.linalg.norm(slope)
    side = 1.0 if np.median(cosines) > 0 else -1.0
    angles = np.arccos(np.clip(side * cosines, -1, 1))
    bad = np.flatnonzero(angles > EXACT)
    if not len(bad):
        return passed(normals=len(used))
    at = lattice_of(trial).index(points[bad])
    border = int(((at <= 0) | (at >= np.array(trial.field.shape) - 1)).any(axis=1).sum())
    return failed(
        f"{len(bad)} of {len(used)} normals are not those of the plane, {border} of them on the "
        f"border of the volume; the first at index {place(at[0])}, the worst is off by "
        f"{np.degrees(angles.max()):.2g} degrees",
        wrong=len(bad),
        on_border=border,
    )


def _directions(normals: Floats) -> Floats | None:
    """The normals at length one, or None where one has no length or is not finite."""
    length = np.linalg.norm(normals.astype(np.float64), axis=1)
    if not (np.isfinite(length).all() and (length > 0).all()):
        return None
    found: Floats = normals / length[:, None]
    return found


def thinness(mesh: Complex) -> dict[str, float]:
    """The shapes of the triangles as figures: no order, and no threshold."""
    found = shapes(mesh)
    return {
        "median_smallest_angle": round(found.median, 1),
        "thin_triangles": round(found.thin, 4),
    }


def well_shaped(trial: Trial) -> Finding:
    """Pass when no more triangles are thin than of planes cut by cubes, and three deviations."""
    mesh = complex_of(trial).welded()
    if not len(mesh.simplices):
        return skipped("there are no triangles")
    found, count = shapes(mesh), len(mesh.simplices)
    most = OF_PLANES + 3 * float(np.sqrt(OF_PLANES * (1 - OF_PLANES) / count))
    numbers = {
        "triangles": count,
        "least_angle": round(found.least, 2),
        "median_smallest_angle": round(found.median, 1),
        "median_aspect": round(found.aspect, 2),
        "thin_triangles": round(found.thin, 4),
        "allowed": round(most, 4),
    }
    if found.thin <= most:
        return passed(**numbers)
    return failed(
        f"{found.thin:.1%} of {count:,} triangles have an angle below {THIN:g} degrees, where "
        f"planes cut by cubes have {OF_PLANES:.1%}",
        **numbers,
    )


def sees_values(declared: Declaration) -> bool:
    """It interpolates."""
    return declared.interpolant != "labels"


def follows_cubes(declared: Declaration) -> bool:
    """It interpolates along the edges of cubes."""
    return declared.interpolant == "multilinear" and declared.vertices == "edges"


def _claim(
    name: str,
    what: str,
    formal: float,
    error: Callable[[Piece], float],
    kinds: Callable[[Kind], bool],
    families: Callable[[Declaration], bool],
    also: Callable[[Complex], dict[str, float]] | None = None,
    of_labels: float = 0.0,
) -> Claim:
    """A claim of this family: beside the ladder, on the bodies of `isograde.cases.accuracy`."""
    labels = f" ({of_labels:g} of labels)" if of_labels else ""
    judge = partial(converges, error=error, formal=formal, of_labels=of_labels, also=also)
    return Claim(
        id=f"accuracy.{name}",
        rule=f"{what} shrinks at least with order {formal:g}{labels} as a smooth body is sampled "
        f"more finely, to within {SLACK:g} of the 95 % confidence interval.",
        source=ETIENE,
        level=None,
        judge=on_mesh(judge),
        kinds=kinds,
        families=families,
        tags=frozenset({"accuracy"}),
    )


def has_extent(kind: Kind) -> bool:
    """Points have neither length nor directions."""
    return kind.k >= 1


def is_surface(kind: Kind) -> bool:
    """A surface in space."""
    return kind == SURFACES


CLAIMS = (
    _claim(
        "position",
        "The largest distance of a vertex",
        2,
        lambda piece: piece.position,
        every_kind,
        every_family,
        of_labels=1,
    ),
    _claim(
        "normal",
        "The angle between simplices and body",
        1,
        lambda piece: piece.normal,
        has_extent,
        on_edges,
        thinness,
    ),
    _claim(
        "distance",
        "The largest distance of the triangles from the trilinear surface",
        2,
        lambda piece: piece.distance,
        is_surface,
        follows_cubes,
    ),
    _claim(
        "measure",
        "The error of the length, the area, ..",
        2,
        lambda piece: piece.measure,
        has_extent,
        sees_values,
    ),
    _claim(
        "volume",
        "The error of the volume",
        2,
        lambda piece: piece.volume,
        lambda kind: kind.m == 1,
        every_family,
        of_labels=1,
    ),
    _claim(
        "curvature",
        "The error of the total mean curvature",
        1,
        lambda piece: piece.bend,
        is_surface,
        on_edges,
    ),
    Claim(
        "accuracy.normals_returned",
        "Where normals come with the vertices, their angle to the body's shrinks at least with "
        f"order 1 as a smooth body is sampled more finely, to within {SLACK:g} of the 95 % "
        "confidence interval; all of them point to high values, or all to low.",
        ETIENE,
        None,
        on_mesh(returned),
        kinds=is_surface,
        tags=frozenset({"accuracy"}),
        promised=False,
    ),
    Claim(
        "accuracy.normals_of_planes",
        "Where normals come with the vertices, those of an affine field are the plane's, on the "
        "border of the volume as well; all of them point to high values, or all to low.",
        "Lorensen and Cline 1987: normals are differences of neighbouring samples, which are exact "
        "where the field is affine",
        None,
        on_mesh(normals_of_a_plane),
        kinds=is_surface,
        families=sees_values,
        tags=frozenset({"flat"}),
        promised=False,
    ),
    Claim(
        "accuracy.shapes",
        f"No more triangles of round bodies have an angle below {THIN:g} degrees than where planes "
        f"are cut by cubes, {OF_PLANES:.1%}; least angle and aspect are measured. In full runs "
        "alone.",
        "Shewchuk 2002: small angles spoil matrices and normals; the bound is that of linear "
        "crossings on cubes",
        None,
        on_mesh(well_shaped),
        kinds=is_surface,
        tags=frozenset({"quality"}),
        promised=False,
    ),
)
