"""Faults of extractors that take directions of the axes in the world, or negative spacings."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from tests.isograde.faults.engine import Answer, Array, Engine, Spacing
from tests.isograde.faults.registry import fault


class InTheWorld(Engine):
    """The mesh at its place, for who has directions of the axes and negative spacings."""

    def __call__(
        self, values: Any, isovalue: float, spacing: Spacing, directions: Array | None = None
    ) -> Answer:
        """Vertices moved to the axes of the world, triangles turned over where they must be."""
        frame = np.eye(3) if directions is None else directions
        frame = frame * np.sign(spacing)[:, None]
        vertices, triangles = super().__call__(values, isovalue, tuple(np.abs(spacing).tolist()))
        return self.moved(vertices, frame), self.turned(triangles, frame)

    def moved(self, vertices: Array, frame: Array) -> Array:
        """The vertices in the world."""
        return np.asarray(vertices @ frame)

    def turned(self, triangles: Array, frame: Array) -> Array:
        """The triangles, the way round that they must be."""
        return triangles[:, ::-1] if np.linalg.det(frame) < 0 else triangles


in_the_world = partial(fault, "symmetry.directions")


@in_the_world("https://github.com/Slicer/Slicer/pull/7627", limits={"directions": True})
class MirroredInsideOut(InTheWorld):
    """Vertices go with axes that are a mirror image, and triangles keep their order."""

    def turned(self, triangles: Array, frame: Array) -> Array:
        """As they were."""
        return triangles


@in_the_world("https://github.com/Kitware/vtk-js/issues/2955", limits={"directions": True})
class DirectionsLost(InTheWorld):
    """The directions of the axes are taken, and not looked at."""

    def moved(self, vertices: Array, frame: Array) -> Array:
        """As they were."""
        return vertices


@in_the_world(limits={"directions": True})
class DirectionsTransposed(InTheWorld):
    """The rows of the directions are read as columns: right for a mirror, wrong for a turn."""

    def moved(self, vertices: Array, frame: Array) -> Array:
        """Turned back, where they should be turned."""
        return np.asarray(vertices @ frame.T)


@in_the_world(limits={"negative": True})
class SpacingWithoutSign(InTheWorld):
    """A negative spacing is taken by its size: the surface is beyond the origin."""

    def moved(self, vertices: Array, frame: Array) -> Array:
        """Along positive axes."""
        return vertices


@in_the_world(limits={"negative": True})
class InsideOutAtNegativeSpacing(InTheWorld):
    """Coordinates are multiplied by a spacing below zero, and triangles keep their order."""

    def turned(self, triangles: Array, frame: Array) -> Array:
        """As they were."""
        return triangles
