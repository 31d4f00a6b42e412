"""From an implementation's conventions to the house's, and what it is not asked."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from isoref.field import Field
from numpy.typing import NDArray

from isograde.declaration import Conventions, Declaration
from isograde.model import Kind, Outcome, Request, Status
from isograde.variants import is_bad_input


def refusal(request: Request, declaration: Declaration) -> str:
    """Why the request is outside the limits that were declared; nothing where it is not.

    What is no field (no samples, a wrong rank) is asked about to see what comes back.
    """
    field = request.field
    if is_bad_input(request.variant) or not is_field(field):
        return ""
    limits = declaration.limits
    if field.directions is not None and not limits.directions:
        return "outside its limits: directions of the axes"
    if min(field.spacing) < 0 and not limits.negative:
        return "outside its limits: a negative spacing"
    return limits.refusal(request.kind, field.shape, field.values.dtype)


def is_field(field: Field) -> bool:
    """Whether there are samples, and they fill a lattice."""
    n = field.dimension
    return field.values.size > 0 and field.values.ndim in (n, n + 1)


def to_house(
    outcome: Outcome, request: Request, conventions: Conventions, *, placed: bool = False
) -> Outcome:
    """The outcome with vertices in world units of the array's axes and the house's orientation.

    `placed` says that world units already contain the field's origin. Arrays of the wrong shape
    or kind stay as they came, for the claims about structure to judge.
    """
    if outcome.status is Status.RAISED and conventions.empty == "raises":
        return _empty_for_error(outcome, request, conventions)
    if outcome.status is not Status.OK or outcome.vertices is None or outcome.simplices is None:
        return outcome
    vertices, simplices = outcome.vertices, outcome.simplices
    if vertices.ndim == 2 and vertices.shape[1] == request.field.dimension:
        vertices = _house_vertices(vertices, request.field, conventions, placed)
    if simplices.ndim == 2 and simplices.shape[1] > 1 and _turns(conventions, request.kind):
        simplices = simplices[:, [*range(simplices.shape[1] - 2), -1, -2]]
    normals = outcome.normals
    if normals is not None:
        house = _house_normals if request.kind.k > 1 else _house_directions
        normals = house(normals, request.field, conventions)
    return replace(outcome, vertices=vertices, simplices=simplices, normals=normals)


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


def _house_normals(normals: NDArray[Any], field: Field, conventions: Conventions) -> NDArray[Any]:
    """Normals in the order of the array's axes; those of a place in samples, in the world's."""
    if conventions.axes == "reversed":
        normals = normals[:, ::-1]
    return normals / np.asarray(field.spacing) if conventions.units == "index" else normals


def _house_directions(
    directions: NDArray[Any], field: Field, conventions: Conventions
) -> NDArray[Any]:
    """Directions along curves likewise; as long as they came, for their length is a confidence."""
    if conventions.axes == "reversed":
        directions = directions[:, ::-1]
    if conventions.units == "world":
        return directions
    made = directions * np.asarray(field.spacing)
    size = [np.linalg.norm(one, axis=1, keepdims=True) for one in (directions, made)]
    return np.asarray(made * size[0] / np.where(size[1] > 0, size[1], 1))


def is_reflection(conventions: Conventions, n: int) -> bool:
    """Whether the axes come in an order that is a reflection: reversed, n of 2 or 3 modulo 4."""
    return conventions.axes == "reversed" and n // 2 % 2 == 1


def _turns(conventions: Conventions, kind: Kind) -> bool:
    """Whether simplices must be turned over; those without orientation stay as they are."""
    if conventions.normals == "none":
        return False
    return (conventions.normals == "to_high") != is_reflection(conventions, kind.n)


def _empty_for_error(outcome: Outcome, request: Request, conventions: Conventions) -> Outcome:
    """An empty mesh for the error declared for fields without a level set; else the error."""
    field, kind = request.field, request.kind
    if not is_field(field) or not np.isfinite(request.isovalues).all():
        return outcome
    parts = field.values.reshape(kind.m, *field.shape)
    one_sided = [
        _one_sided(part, isovalue, conventions)
        for part, isovalue in zip(parts, request.isovalues, strict=True)
    ]
    # A lattice that is one sample thick has no cells, and so no level set.
    if not any(one_sided) and min(field.shape) > 1:
        return outcome
    nothing = np.empty((0, kind.n)), np.empty((0, kind.k + 1), np.int64)
    return replace(outcome, status=Status.OK, vertices=nothing[0], simplices=nothing[1])


def _one_sided(values: NDArray[Any], isovalue: float, conventions: Conventions) -> bool:
    """Whether all samples, each of them a number, are on one side of the isovalue."""
    tie = conventions.tie == "inside"
    inside = values >= isovalue if tie else values > isovalue
    return not np.isnan(values).any() and not (inside.any() and not inside.all())
