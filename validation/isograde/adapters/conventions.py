"""From an implementation's conventions to the house's."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from isoref.field import Field
from numpy.typing import NDArray

from isograde.model import Conventions, Outcome, Request, Status


def to_house(
    outcome: Outcome, request: Request, conventions: Conventions, *, placed: bool = False
) -> Outcome:
    """The outcome with vertices in world units of the array's axes and normals to lower values.

    `placed` says that world units already contain the field's origin. Arrays of the wrong shape
    or kind stay as they came, for the claims about structure to judge.
    """
    if outcome.status is Status.RAISED and conventions.empty == "raises":
        return _empty_for_error(outcome, request, conventions)
    if outcome.status is not Status.OK or outcome.vertices is None or outcome.faces is None:
        return outcome
    vertices, faces = outcome.vertices, outcome.faces
    if vertices.ndim == 2 and vertices.shape[1] == request.field.dimension:
        vertices = _house_vertices(vertices, request.field, conventions, placed)
    if faces.ndim == 2 and faces.shape[1] > 1 and _turns(conventions, request.field.dimension):
        faces = faces[:, [*range(faces.shape[1] - 2), -1, -2]]
    return replace(outcome, vertices=vertices, faces=faces)


def _house_vertices(
    vertices: NDArray[Any], field: Field, conventions: Conventions, placed: bool
) -> NDArray[Any]:
    """Vertices in the order of the array's axes, scaled by the spacing, moved to the origin."""
    if conventions.axes == "reversed":
        vertices = vertices[:, ::-1]
    if conventions.units == "index":
        vertices = vertices * np.asarray(field.spacing)
    if any(field.origin) and not (placed and conventions.units == "world"):
        vertices = vertices + np.asarray(field.origin)
    return vertices


def _turns(conventions: Conventions, n: int) -> bool:
    """Whether simplices must be turned over: normals to high, or axes reversed by a reflection."""
    reflected = conventions.axes == "reversed" and n // 2 % 2 == 1
    return (conventions.normals == "to_high") != reflected


def _empty_for_error(outcome: Outcome, request: Request, conventions: Conventions) -> Outcome:
    """An empty mesh for the error declared for fields without a surface; else the error."""
    values, n = request.field.values, request.field.dimension
    tie = conventions.tie == "inside"
    inside = values >= request.isovalue if tie else values > request.isovalue
    is_field = values.ndim == n and values.size > 0 and np.isfinite(request.isovalue)
    if not is_field or (inside.any() and not inside.all()):
        return outcome
    nothing = np.empty((0, n)), np.empty((0, n), np.int64)
    return replace(outcome, status=Status.OK, vertices=nothing[0], faces=nothing[1])
