"""Freeze-out: a VESTA surface as the boundary over which a current is summed.

A fireball expands and cools. Where its temperature falls through T_f its matter stops to interact
and flies on: the isosurface T = T_f in space-time is the freeze-out hypersurface, and whatever
leaves the fireball is the flux of some current through it. For that sum the surface is wanted as
a list of places with normals, as short as accuracy allows. VESTA gives one place a cycle.

Glossary
--------
T_f         freeze-out temperature
dsigma      normal of one triangle; its length is the triangle's area
dSigma      normal of one cycle, the sum of its triangles' dsigma (eq. 1)
average     the average of a cycle's support points, where its dSigma is taken to stand
unphysical  with a coordinate below zero that cannot be: a radius or a time

Invariants
----------
dSigma depends on the cycle alone, not on how it is cut. Over a closed surface both normals sum to
zero, and the flux of the field x / 3 is the enclosed volume: exactly with dsigma at the middles
of triangles, to second order in the voxel with dSigma at the averages.

References
----------
1. B. R. Schlei, "Volume-Enclosing Surface Extraction", section III.C, eq. 1, Figs. 30 to 33.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from isoref.fast.diconex import diconex
from isoref.fast.vesta import Surface, extract
from isoref.field import Booleans, Field, Floats
from isoref.mesh import Mesh


@dataclass(frozen=True, eq=False)
class Elements:
    """Pieces of a surface, as a flux wants them.

    Attributes
    ----------
    places : (n, 3) where a piece is taken to stand
    normals : (n, 3) its outward normal, as long as it is large
    """

    places: Floats
    normals: Floats

    def flux(self, current: Callable[[Floats], Floats]) -> float:
        """The sum over all pieces of the current at its place times its normal.

        >>> Elements(np.ones((2, 3)), np.eye(3)[:2]).flux(lambda x: 3 * x)
        6.0
        """
        return float((current(self.places) * self.normals).sum())


def hypersurface(temperature: Field, freeze_out: float) -> Surface:
    """The closed surface round all voxels with temperature of at least T_f, in mixed mode."""
    return extract(temperature, freeze_out, mode="mixed", border="closed")


def triangle_elements(mesh: Mesh) -> Elements:
    """The dsigma of each triangle, at its middle, as in Fig. 33d.

    >>> triangle_elements(Mesh.of(np.eye(3), [[0, 1, 2]])).normals
    array([[0.5, 0.5, 0.5]])
    """
    a, b, c = np.moveaxis(mesh.vertices[mesh.simplices], 1, 0)
    return Elements((a + b + c) / 3, 0.5 * np.cross(b - a, c - a))


def cycle_elements(surface: Surface) -> Elements:
    """The dSigma of each cycle, at its average, eq. 1."""
    averages = [surface.points[rows].mean(axis=1) for rows in surface.cycles.values()]
    empty = np.empty((0, 3))
    return Elements(
        np.concatenate([empty, *averages]), np.concatenate([empty, *surface.normals.values()])
    )


def physical(surface: Surface, axes: Sequence[int]) -> Surface:
    """The surface without the cycles that have a point below zero along one of these axes.

    The paper discards triangles; of a cycle that straddles zero it keeps some. Whole cycles are
    discarded here, so that each dSigma is that of a whole cycle. `physical_triangles` is the
    paper's way.
    """
    below: Booleans = np.any(surface.points[:, list(axes)] < 0, axis=1)
    kept = {n: rows[~below[rows].any(axis=1)] for n, rows in surface.cycles.items()}
    return Surface(
        surface.points, surface.centres, {n: rows for n, rows in kept.items() if len(rows)}
    )


def physical_triangles(mesh: Mesh, axes: Sequence[int]) -> Mesh:
    """The mesh without the triangles that have a corner below zero along one of these axes."""
    below: Booleans = np.any(mesh.vertices[:, list(axes)] < 0, axis=1)
    return Mesh.of(mesh.vertices, mesh.simplices[~below[mesh.simplices].any(axis=1)])


def contour_stack(temperature: Field, freeze_out: float, axis: int) -> list[list[Floats]]:
    """For each plane across `axis`, its contours as (n, 2) polygons, as in Figs. 30 and 31.

    Joining the contours of neighbouring planes to a surface is a matter of luck: where their
    number changes it is not said which continues which.
    """
    others = [a for a in range(3) if a != axis]
    spacing = [temperature.spacing[a] for a in others]
    origin = [temperature.origin[a] for a in others]
    return [
        diconex(Field.of(plane, spacing, origin), freeze_out, border="closed").polygons()
        for plane in np.moveaxis(temperature.values, axis, 0)
    ]


def correspondence_problems(stack: Sequence[Sequence[Floats]]) -> list[int]:
    """The k for which planes k and k + 1 both have contours, but not as many."""
    counts = [len(contours) for contours in stack]
    return [k for k, (a, b) in enumerate(pairwise(counts)) if a and b and a != b]
