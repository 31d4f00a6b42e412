"""Known bodies come out: the evidence of level 0, which no declaration can take away.

On smooth closed bodies of known numbers (`isograde.oracles.bodies`) the mesh has the right pieces
and holes, and is as near as the declared family can be. How near follows from the interpolant and
from where the vertices may be, by the derivation in the oracle; nothing there is tuned. Each claim
is said of every (n, m). A mesh without simplices fails them all.

A mesh that declares no normals is turned the right way first, simplex by simplex, by the body's own
gradients; it is not asked for its degree.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite

import numpy as np
from isoref.field import Integers

from isograde.claims.evidence import complex_of, failed, on_mesh, passed, remembered, skipped
from isograde.declaration import Declaration
from isograde.model import Claim, Finding, Kind, Trial
from isograde.oracles.bodies import KINDS, Body, Bounds, bounds
from isograde.oracles.body_measures import Measures, measures
from isograde.oracles.complexes import Complex

DERIVED = "isograde design: known bodies, with bounds derived for each family in oracles/bodies.py"
# The degree of a right mesh is a whole number blurred: nearer to 1 than to any other.
BLUR = 0.5


@dataclass(frozen=True, eq=False)
class Beside:
    """A mesh beside the body it should be."""

    found: Measures
    body: Body
    allowed: Bounds
    oriented: bool


def beside(trial: Trial) -> Beside:
    """What the plain outcome measures, and what is right."""

    def compute() -> Beside:
        body: Body = trial.case.facts["body"]
        declared, mesh = trial.declaration, complex_of(trial)
        oriented = declared.conventions.normals != "none"
        rows = mesh.simplices if oriented else turned(mesh, body)
        found = measures(mesh.points, rows, body)
        return Beside(found, body, allowed(declared, body, trial.case.facts["rounding"]), oriented)

    return remembered(trial, "beside a body", compute)


def allowed(declared: Declaration, body: Body, rounding: float) -> Bounds:
    """How far a right mesh of this family may be off; what a soup welds is moved by as much."""
    return bounds(
        declared.interpolant,
        declared.vertices,
        body.radii,
        body.n,
        reach=declared.reach,
        block=max(declared.split.period(body.n)),
        rounding=rounding + (declared.soup or 0.0),
    )


def turned(mesh: Complex, body: Body) -> Integers:
    """The simplices, each turned so that det(-g_1, .., -g_m, t_1, .., t_k) is not negative."""
    corners = mesh.points[mesh.simplices]
    if mesh.k < 1 or not len(corners):
        return mesh.simplices
    gradients = -body.gradients(corners.mean(axis=1))
    frame = np.concatenate([gradients, np.diff(corners, axis=1)], axis=1)
    wrong = np.linalg.det(frame) < 0
    rows = mesh.simplices.copy()
    rows[wrong, :2] = rows[wrong, 1::-1]
    return rows


def pieces(one: Beside) -> Finding:
    """Pass when the mesh has as many pieces as the body."""
    found, right = one.found.pieces, one.body.pieces
    told = f"{found} pieces, where {one.body.name} has {right}"
    return _decided(found == right, told, pieces=found, expected=right)


def holes(one: Beside) -> Finding:
    """Pass when the mesh has the body's b1, and each of its pieces is closed."""
    found, b1, shells = one.found, one.body.b1, one.body.pieces
    right = found.shells == shells and found.b1 in (b1, None)
    told = f"b1 is {found.b1} and {found.shells} pieces are closed, where b1 of {one.body.name} "
    told += f"is {b1} and {shells} are"
    return _decided(right, told, b1=found.b1, closed=found.shells, expected=[b1, shells])


def offset(one: Beside) -> Finding:
    """Pass when the mesh is, on the average, as far inside or outside as it may be."""
    what = "difference of volume over area" if one.body.volume is not None else "mean distance"
    return _within(what, one.found.mean, one.allowed.mean)


def centroid(one: Beside) -> Finding:
    """Pass when the mesh is in the body's place."""
    away = float(np.linalg.norm(one.found.centroid - one.body.centroid))
    return _within("distance of the centroid", away, one.allowed.centroid)


def distance(one: Beside) -> Finding:
    """Pass when no point of the mesh is far from the body, and none of the body from the mesh."""
    to_body, to_mesh = one.found.to_body, one.found.to_mesh
    return _within("distance between mesh and body", max(to_body, to_mesh), one.allowed.largest)


def degree(one: Beside) -> Finding:
    """Pass when the mesh covers the body once, its orientation counted."""
    if not one.oriented:
        return skipped("it declares that its simplices are not oriented")
    found = one.found.degree
    right = abs(found - 1) <= BLUR
    return _decided(right, f"the body is covered {found:.2f} times, not once", degree=found)


def _within(what: str, found: float, most: float) -> Finding:
    """Whether a number is within its bound; without a bound there is no evidence."""
    if not isfinite(most):
        return skipped("the family is too coarse for a bound on this body")
    # A number that is none is not within its bound.
    told = f"the {what} is {found:.3g} of a cell; this family's is at most {most:.3g}"
    number = float(found) if isfinite(found) else None
    return _decided(found <= most, told, found=number, bound=most)


def _decided(right: bool, told: str, **numbers: object) -> Finding:
    """Pass, or fail with what is told."""
    return passed(**numbers) if right else failed(told, **numbers)


def has_bodies(kind: Kind) -> bool:
    """Those of which there are bodies."""
    return kind in KINDS


def _claim(name: str, rule: str, judge: Callable[[Beside], Finding]) -> Claim:
    """A claim of this family: of level 0, on known bodies of every kind, never withdrawn."""

    def of_trial(trial: Trial) -> Finding:
        if "body" not in trial.case.facts:
            return skipped("a part of the case is no whole body")
        return judge(beside(trial))

    of_trial.__doc__ = judge.__doc__
    return Claim(
        f"bodies.{name}", rule, DERIVED, 0, on_mesh(of_trial), kinds=has_bodies,
        tags=frozenset({"bodies"}), firm=True,
    )  # fmt: skip


CLAIMS = (
    _claim("pieces", "The mesh of a known body has as many pieces as the body.", pieces),
    _claim(
        "holes",
        "The mesh of a known body has its first Betti number, and as many closed pieces.",
        holes,
    ),
    _claim(
        "offset",
        "The volume of a known body is right but for its area times what the family allows; of "
        "curves and the like, the mean distance.",
        offset,
    ),
    _claim("centroid", "The centroid of a known body is within a quarter of a cell.", centroid),
    _claim(
        "distance",
        "Mesh and known body are nowhere farther apart than the family allows.",
        distance,
    ),
    _claim("degree", "The mesh covers a known body once, its orientation counted.", degree),
)
