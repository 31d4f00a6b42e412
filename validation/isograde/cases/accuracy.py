"""Bodies of one shape at several sizes in one field, to see errors shrink.

Refining a lattice by a factor and enlarging the body by it are the same thing. So one field holds
a row of similar bodies, the largest several times as large as the smallest, and one call of an
implementation gives its errors at as many resolutions.

Glossary
--------
scale   size of a body in spacings: radius of a sphere, radius of a torus's ring; h = 1 / scale
across  unit vectors of the hyperplanes in which spheres are cut, one for each function but the
        first; they are at right angles to the row
bend    total mean curvature of a surface in space, the integral of (k1 + k2) / 2 over it

The first function is the signed distance from the nearest sphere or torus, positive inside, the
others are the distances from the hyperplanes, all in multiples of 2 ** -20. Bodies stand off the
lattice and clear of each other and of the border.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from math import pi
from typing import Literal

import numpy as np
from isoref.field import Field, Floats

from isograde.cases.analytic import rounded
from isograde.model import CONTOURS, CURVES, SURFACES, Case, Kind
from isograde.oracles.bodies import ball_volume, length, sphere_measure

Shape = Literal["sphere", "torus"]
TUBE = 0.55  # of a torus, as a share of its ring
OFFSET = (0.311, 0.173, 0.441, 0.257)
MARGIN = 2


@dataclass(frozen=True)
class Row:
    """Which bodies stand in a row."""

    kind: Kind
    shape: Shape
    scales: tuple[float, ...]
    across: tuple[tuple[float, ...], ...] = ()


SIX = (3.5, 4.2, 5.25, 7.0, 10.5, 21.0)
ROWS: dict[str, Row] = {
    "sphere": Row(SURFACES, "sphere", SIX),
    "torus": Row(SURFACES, "torus", (2.75, 3.3, 4.125, 5.5, 8.25, 16.5)),
    "2-1": Row(CONTOURS, "sphere", SIX),
    "3-2": Row(CURVES, "sphere", SIX[:-1], ((0.0, 0.28, 0.96),)),
    "4-2": Row(Kind(4, 2), "sphere", SIX[:-2], ((0.0, 0.0, 0.28, 0.96),)),
}
# Rows that take long.
FULL = ("4-2",)
# The row whose triangles are looked at one by one.
QUALITY = "sphere"


@dataclass(frozen=True)
class Body:
    """A sphere, cut by hyperplanes through its middle, or a torus about the last axis."""

    shape: Shape
    scale: float
    middle: tuple[float, ...]
    across: tuple[tuple[float, ...], ...] = ()

    @property
    def k(self) -> int:
        """Its dimension."""
        return len(self.middle) - 1 - len(self.across)

    def function(self, points: Floats) -> Floats:
        """(..,) signed distance from the sphere or torus, positive outside."""
        away = points - np.array(self.middle)
        if self.shape == "sphere":
            flat = away.reshape(-1, away.shape[-1])
            return np.asarray(length(flat).reshape(away.shape[:-1]) - self.scale)
        x, y, z = np.moveaxis(away, -1, 0)
        return np.asarray(np.hypot(np.hypot(x, y) - self.scale, z) - TUBE * self.scale)

    def heights(self, points: Floats) -> Floats:
        """(.., m - 1) signed distances from the hyperplanes."""
        rows = np.reshape(self.across, (-1, len(self.middle)))
        return np.asarray((points - np.array(self.middle)) @ rows.T)

    def distance(self, points: Floats) -> Floats:
        """(..,) distance from the body; with a sign, positive outside, where it is not cut."""
        if not self.across:
            return self.function(points)
        heights = self.heights(points)
        inside = points - heights @ np.array(self.across)
        return np.asarray(np.hypot(self.function(inside), np.linalg.norm(heights, axis=-1)))

    def normals(self, points: Floats) -> Floats:
        """(.., m, n) orthonormal vectors across the body nearest to the points, one outward."""
        away = points - np.array(self.middle)
        away = away - self.heights(points) @ np.reshape(self.across, (-1, away.shape[-1]))
        if self.shape == "torus":
            flat = away * [1, 1, 0]
            size = np.linalg.norm(flat, axis=-1, keepdims=True)
            away = away - flat * (self.scale / size)
        outward = away / np.linalg.norm(away, axis=-1, keepdims=True)
        planes = [np.broadcast_to(row, outward.shape) for row in self.across]
        return np.stack([outward, *planes], axis=-2)

    @property
    def measure(self) -> float:
        """Length, area, .."""
        if self.shape == "torus":
            return 4 * pi**2 * self.scale**2 * TUBE
        return sphere_measure(self.k + 1, self.scale)

    @property
    def volume(self) -> float:
        """Volume inside, of a body that is not cut."""
        if self.shape == "torus":
            return 2 * pi**2 * self.scale**3 * TUBE**2
        return ball_volume(len(self.middle), self.scale)

    @property
    def bend(self) -> float:
        """Total mean curvature, of a surface in space."""
        return 4 * pi * self.scale if self.shape == "sphere" else 2 * pi**2 * self.scale

    @property
    def reach(self) -> Floats:
        """(n,) half the extent along each axis."""
        if self.shape == "torus":
            return np.array([1 + TUBE, 1 + TUBE, TUBE]) * self.scale
        rows = np.reshape(self.across, (-1, len(self.middle)))
        return np.asarray(self.scale * np.sqrt(1 - (rows**2).sum(axis=0)))


def row(name: str) -> tuple[list[Body], tuple[int, ...]]:
    """The bodies of the row of this name, and the number of samples that hold them."""
    said, n = ROWS[name], ROWS[name].kind.n
    whole = [Body(said.shape, scale, (0.0,) * n, said.across) for scale in said.scales]
    wide = np.ceil(np.max([body.reach for body in whole], axis=0)).astype(int)[1:]
    beside = 2 * (wide + MARGIN) + 1
    bodies, start = [], 0
    for body in whole:
        half = int(np.ceil(body.reach[0])) + MARGIN
        place = np.array([start + half, *(beside // 2)]) + OFFSET[:n]
        bodies.append(Body(said.shape, body.scale, tuple(place.tolist()), said.across))
        start += 2 * half
    return bodies, (start + 2, *(int(x) + 1 for x in beside))


def field(name: str) -> Field:
    """The field of the row of this name."""
    bodies, samples = row(name)
    places = np.stack(np.meshgrid(*map(np.arange, samples), indexing="ij"), axis=-1).astype(float)
    nearest = -np.min([body.function(places) for body in bodies], axis=0)
    # The hyperplanes go through all middles: those of the first body are those of every other.
    parts = [nearest, *np.moveaxis(bodies[0].heights(places), -1, 0)]
    values = rounded(np.stack(parts))
    return Field.of(values[0] if len(parts) == 1 else values, dimension=len(samples))


def cases(seed: int = 0) -> list[Case]:
    """The rows "accuracy/sphere", "accuracy/torus", "accuracy/2-1" ..; the seed does not matter."""
    del seed
    rows = [
        Case(
            f"accuracy/{name}",
            partial(field, name),
            (0.0,) * said.kind.m,
            int(np.prod(row(name)[1])),
            frozenset({"accuracy", "closed", *(["full"] if name in FULL else [])}),
            {"row": name, "components": len(said.scales)},
            said.kind,
        )
        for name, said in ROWS.items()
    ]
    return [*rows, _quality(QUALITY)]


def _quality(name: str) -> Case:
    """The bodies of a row for who asks what shapes its triangles have; in full runs alone."""
    tags, only = frozenset({"quality", "full"}), ("accuracy.shapes", "structure.*")
    facts, samples = {"components": len(ROWS[name].scales)}, int(np.prod(row(name)[1]))
    build, kind = partial(field, name), ROWS[name].kind
    return Case("accuracy/quality", build, (0.0,), samples, tags, facts, kind, only)
