"""Surfaces of one shape at several sizes in one field, to see errors shrink.

Refining a lattice by a factor and enlarging the body by it are the same thing. So one field holds
a row of similar bodies, the largest six times as large as the smallest, and one call of an
implementation gives its errors at six resolutions.

Glossary
--------
scale   size of a body in spacings: radius of a sphere, radius of a torus's ring; h = 1 / scale
bend    total mean curvature, the integral of (k1 + k2) / 2 over the surface

The field is the signed distance from the nearest body, positive inside, in multiples of 2 ** -20.
Bodies stand off the lattice and clear of each other and of the border.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from math import pi
from typing import Literal

import numpy as np
from isoref.field import Field, Floats

from isograde.cases.analytic import rounded
from isograde.model import Case

Shape = Literal["sphere", "torus"]
TUBE = 0.55  # of a torus, as a share of its ring
SCALES: dict[Shape, tuple[float, ...]] = {
    "sphere": (3.5, 4.2, 5.25, 7.0, 10.5, 21.0),
    "torus": (2.75, 3.3, 4.125, 5.5, 8.25, 16.5),
}
OFFSET = np.array([0.311, 0.173, 0.441])
MARGIN = 2


@dataclass(frozen=True)
class Body:
    """A sphere, or a torus about the last axis."""

    shape: Shape
    scale: float
    middle: tuple[float, float, float]

    def distance(self, points: Floats) -> Floats:
        """(..,) signed distance from the surface, positive outside."""
        x, y, z = np.moveaxis(points - np.array(self.middle), -1, 0)
        if self.shape == "sphere":
            return np.asarray(np.sqrt(x * x + y * y + z * z) - self.scale)
        return np.asarray(np.hypot(np.hypot(x, y) - self.scale, z) - TUBE * self.scale)

    def normals(self, points: Floats) -> Floats:
        """(.., 3) outward unit normals of the surface nearest to the points."""
        away = points - np.array(self.middle)
        if self.shape == "torus":
            flat = away * [1, 1, 0]
            length = np.linalg.norm(flat, axis=-1, keepdims=True)
            away = away - flat * (self.scale / length)
        return np.asarray(away / np.linalg.norm(away, axis=-1, keepdims=True))

    @property
    def area(self) -> float:
        """Area of the surface."""
        share = 1.0 if self.shape == "sphere" else pi * TUBE
        return 4 * pi * self.scale**2 * share

    @property
    def volume(self) -> float:
        """Volume inside."""
        share = 4 / 3 if self.shape == "sphere" else 2 * pi * TUBE**2
        return pi * self.scale**3 * share

    @property
    def bend(self) -> float:
        """Total mean curvature."""
        return 4 * pi * self.scale if self.shape == "sphere" else 2 * pi**2 * self.scale

    @property
    def reach(self) -> tuple[float, float]:
        """Half the extent across the last axis, and along it."""
        if self.shape == "sphere":
            return self.scale, self.scale
        return (1 + TUBE) * self.scale, TUBE * self.scale


def row(shape: Shape) -> tuple[list[Body], tuple[int, int, int]]:
    """The bodies, and the number of samples that hold them."""
    bodies, start = [], 0
    wide, high = (max(Body(shape, s, (0, 0, 0)).reach[i] for s in SCALES[shape]) for i in (0, 1))
    across, along = (2 * (int(np.ceil(x)) + MARGIN) + 1 for x in (wide, high))
    for scale in SCALES[shape]:
        half = int(np.ceil(Body(shape, scale, (0, 0, 0)).reach[0])) + MARGIN
        place = np.array([start + half, across // 2, along // 2]) + OFFSET
        bodies.append(Body(shape, scale, (float(place[0]), float(place[1]), float(place[2]))))
        start += 2 * half
    return bodies, (start + 2, across + 1, along + 1)


def field(shape: Shape) -> Field:
    """The field of the row."""
    bodies, samples = row(shape)
    places = np.stack(np.meshgrid(*map(np.arange, samples), indexing="ij"), axis=-1).astype(float)
    nearest = np.min([body.distance(places) for body in bodies], axis=0)
    return Field.of(rounded(-nearest))


def cases(seed: int = 0) -> list[Case]:
    """The rows "accuracy/sphere" and "accuracy/torus"; they do not depend on the seed."""
    del seed
    return [
        Case(
            f"accuracy/{shape}",
            partial(field, shape),
            (0.0,),
            int(np.prod(row(shape)[1])),
            frozenset({"accuracy", "closed"}),
            {"components": len(SCALES[shape]), "euler": (2 if shape == "sphere" else 0) * 6},
        )
        for shape in SCALES
    ]
