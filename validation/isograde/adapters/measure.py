"""The conventions of an implementation, as measured: what it does, not what it says.

Each convention is found out with a few small fields whose answers differ by it, for any kind
(n, m). ``isograde check`` shows where the measurement differs from the declaration, and a test
holds the declarations of the ready-made adapters to it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import partial
from itertools import permutations, product
from math import factorial
from typing import Any, Literal

import numpy as np
from isoref.field import Field
from numpy.typing import NDArray

from isograde.adapters.conventions import is_reflection
from isograde.declaration import Conventions
from isograde.model import SURFACES, Kind, Outcome, Status

# A question at one isovalue for each component.
Ask = Callable[[Field, tuple[float, ...]], Outcome]
Values = NDArray[np.float64]
Side = Literal["inside", "outside"]
Normals = Literal["to_low", "to_high", "none"]
Axes = Literal["array", "reversed"]
Units = Literal["world", "index"]

# Different along every axis, so that no two orders of the axes look alike.
SHAPE = (5, 6, 7, 8, 9, 10)
SHIFTS = (0.1, -0.1, 0.2, -0.2, 0.15, -0.15)
LEVEL = 1.0
RADIUS = 3.0**0.5
TIED_FIELDS = 24
NUDGE = 1e-3
# How much the two sizes must differ, in faces of a cell, to tell the sides apart.
TELLING_SIZE = 0.3
# How near, as a share of that difference, the tied field's size must be to one of them.
CLOSE = 0.1
# Share of the telling fields, or of the simplices' sizes, that must agree.
MAJORITY = 0.9
# By so many cells another order of the axes must fit better to be taken for what is meant.
CLEARLY = 0.15


@dataclass(frozen=True)
class Measured:
    """What was seen of each convention; None where it could not be told."""

    tie: Side | None = None
    normals: Normals | None = None
    axes: Axes | None = None
    units: Units | None = None
    nan: Literal["raises", "answers"] | None = None
    empty: Literal["mesh", "raises"] | None = None

    def differences(self, declared: Conventions) -> list[tuple[str, str, str]]:
        """(convention, declared, measured) for each that was measured to be something else."""
        rows = [(f.name, getattr(declared, f.name), getattr(self, f.name)) for f in fields(self)]
        return [row for row in rows if row[2] is not None and row[1] != row[2]]


def measure(ask: Ask, kind: Kind = SURFACES) -> Measured:
    """The conventions of whatever answers to ``ask(field, isovalues)``, its answers unconverted."""
    field = ball(kind)
    outcome = ask(field, levels(kind))
    axes, units = frame(outcome, field)
    return Measured(
        tie=side_of_ties(ask, kind),
        normals=None if axes is None or units is None else facing(outcome, field, axes, units),
        axes=axes,
        units=units,
        nan=with_nan(ask, kind),
        empty=without_surface(ask, kind),
    )


def levels(kind: Kind) -> tuple[float, ...]:
    """The isovalues at which `ball` has its sphere: 1 for the ball, 0 for the planes."""
    return (LEVEL,) + (0.0,) * (kind.m - 1)


def ball(kind: Kind = SURFACES) -> Field:
    """A ball, high in the middle of the lattice, off its centre; with m - 1 planes through that.

    The k-sphere in which they meet lies in the first k + 1 axes.
    """
    centre = centre_of(kind.n)
    places = np.indices(SHAPE[: kind.n], dtype=float) - np.expand_dims(
        centre, tuple(range(1, kind.n + 1))
    )
    high = 4 - np.einsum("i...,i...->...", places, places)
    spacing = tuple(float(1 + axis) for axis in range(kind.n))
    if kind.m == 1:
        return Field.of(high, spacing)
    return Field.of(np.stack([high, *places[kind.k + 1 :]]), spacing, dimension=kind.n)


def centre_of(n: int) -> Values:
    """The centre of the ball, in samples."""
    return (np.array(SHAPE[:n]) - 1) / 2 + SHIFTS[:n]


def frame(outcome: Outcome, field: Field) -> tuple[Axes | None, Units | None]:
    """The order of the axes and the units in which the vertices lie where the sphere is."""
    n = field.dimension
    vertices = _points(outcome, n)
    if vertices is None:
        return None, None
    centre, reach = centre_of(n), np.zeros(n)
    reach[: n - field.components + 1] = RADIUS
    target = np.stack([centre - reach, centre + reach])
    orders: tuple[Axes, ...] = ("array", "reversed")
    scales: tuple[Units, ...] = ("world", "index")
    errors = {}
    for order, scale in product(orders, scales):
        index = _index(vertices, field, order, scale)
        errors[order, scale] = np.abs([index.min(0), index.max(0)] - target).max()
    best = min(errors, key=lambda key: float(errors[key]))
    if errors[best] >= 1 or _permuted(vertices, field, target) < errors[best] - CLEARLY:
        return None, None
    return best


def _permuted(vertices: Values, field: Field, target: Values) -> float:
    """How far the vertices are off the sphere in the best order of the axes that is not allowed."""
    spacing = np.asarray(field.spacing)
    boxes = np.stack([vertices.min(0), vertices.max(0)])
    usual = (tuple(range(field.dimension)), tuple(range(field.dimension))[::-1])
    off = [np.inf]
    for order in permutations(range(field.dimension)):
        if order not in usual:
            turned = boxes[:, order]
            for index in (turned / spacing, turned, (boxes / spacing)[:, order]):
                off.append(float(np.abs(index - target).max()))
    return min(off)


def _index(vertices: Values, field: Field, axes: Axes, units: Units) -> Values:
    """The vertices in samples, in the order of the array's axes."""
    turned = vertices[:, ::-1] if axes == "reversed" else vertices
    return turned / field.spacing if units == "world" else turned


def facing(outcome: Outcome, field: Field, axes: Axes, units: Units) -> Normals | None:
    """Where right-hand normals point, on the sphere round high values, in its own coordinates."""
    n, m = field.dimension, field.components
    vertices, rows = _points(outcome, n), _rows(outcome, n - m)
    if vertices is None or rows is None or n == m:
        return None
    corners = _index(vertices, field, axes, units)[rows]
    # Put the edges of each simplex after the negated gradients at its middle.
    frames = np.zeros((len(rows), n, n))
    frames[:, 0] = corners.mean(axis=1) - centre_of(n)
    frames[:, range(1, m), range(n - m + 1, n)] = -1.0
    frames[:, m:] = corners[:, 1:] - corners[:, :1]
    signed = np.linalg.det(frames)
    total, whole = float(signed.sum()), float(np.abs(signed).sum())
    if abs(total) < MAJORITY * whole or not whole:
        return "none"
    right = (total > 0) != is_reflection(Conventions(axes=axes), n)
    return "to_low" if right else "to_high"


def side_of_ties(ask: Ask, kind: Kind = SURFACES) -> Side | None:
    """The side to which samples equal to the isovalue belong.

    A field of -1, 0 and 1 at isovalue 0 is compared with the fields whose zeros are a little
    higher and a little lower. Flat features vanish with the nudge, so that the level set's size is
    that of one of the two. Fields for which both have the same size tell nothing, and neither do
    those that are like none of the two, since a tie also decides how a cell is filled.
    """
    rng = np.random.default_rng(1987)
    shape = (3,) * kind.n if kind.m == 1 else (kind.m, *(3,) * kind.n)
    size = partial(_size, kind=kind)
    inside = outside = 0
    for _ in range(TIED_FIELDS):
        values = rng.integers(-1, 2, shape).astype(float)
        tied, high, low = (
            size(ask(Field.of(np.where(values == 0, nudge, values), dimension=kind.n), zeros))
            for nudge, zeros in ((by, (0.0,) * kind.m) for by in (0.0, NUDGE, -NUDGE))
        )
        gap = abs(high - low)
        if gap > TELLING_SIZE:
            inside += abs(tied - high) < CLOSE * gap
            outside += abs(tied - low) < CLOSE * gap
    told = inside + outside
    if not told or max(inside, outside) < MAJORITY * told:
        return None
    return "inside" if inside > outside else "outside"


def with_nan(ask: Ask, kind: Kind = SURFACES) -> Literal["raises", "answers"]:
    """What a sample that is not a number does, beside the level set."""
    field = ball(kind)
    values = field.values.copy()
    near = tuple(int(x) for x in centre_of(kind.n).round())
    at: tuple[Any, ...] = (..., *near)
    values[at] = np.nan
    asked = Field(values, field.spacing, field.origin)
    return "answers" if ask(asked, levels(kind)).status is Status.OK else "raises"


def without_surface(ask: Ask, kind: Kind = SURFACES) -> Literal["mesh", "raises"]:
    """What an isovalue above and one below all samples give."""
    beyond = [(level, *levels(kind)[1:]) for level in (99.0, -999.0)]
    answered = all(ask(ball(kind), level).status is Status.OK for level in beyond)
    return "mesh" if answered else "raises"


def _points(outcome: Outcome, n: int) -> Values | None:
    """The vertices, or None where there are none in n dimensions."""
    vertices = outcome.vertices
    if vertices is None or vertices.ndim != 2 or vertices.shape[1] != n or not len(vertices):
        return None
    points: Values = vertices.astype(np.float64)
    return points if np.isfinite(points).all() else None


def _rows(outcome: Outcome, k: int) -> NDArray[np.int64] | None:
    """The simplices, or None where they are none of dimension k on the vertices."""
    rows, vertices = outcome.simplices, outcome.vertices
    if rows is None or vertices is None or rows.dtype.kind not in "iu":
        return None
    if rows.ndim != 2 or rows.shape[1] != k + 1 or not len(rows):
        return None
    if rows.min() < 0 or rows.max() >= len(vertices):
        return None
    return rows.astype(np.int64)


def _size(outcome: Outcome, kind: Kind) -> float:
    """The k-dimensional volume of the mesh, NaN where there is none."""
    mesh = outcome.mesh_of(kind)
    if mesh is None:
        return 0.0 if outcome.status is Status.RAISED else float("nan")
    corners = mesh.vertices[mesh.simplices]
    edges = corners[:, 1:] - corners[:, :1]
    gram = np.linalg.det(edges @ edges.swapaxes(1, 2)) if kind.k else np.ones(len(corners))
    return float(np.sqrt(gram.clip(0)).sum() / factorial(kind.k))
