"""The conventions of an implementation, as measured: what it does, not what it says.

Each convention is found out with a few small fields whose answers differ by it. ``isograde check``
shows where the measurement differs from the declaration, and a test holds the declarations of the
ready-made adapters to it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from itertools import product
from typing import Literal

import numpy as np
from isoref.field import Field
from numpy.typing import NDArray

from isograde.model import Conventions, Outcome, Status

Ask = Callable[[Field, float], Outcome]
Values = NDArray[np.float64]

# Different along every axis, so that no two orders of the axes look alike.
SHAPE = (5, 6, 7)
SPACING = (1.0, 2.0, 3.0)
LEVEL = 1.0
TIED_FIELDS = 24
NUDGE = 1e-3
# How much the two areas must differ, in faces of a cell, to tell the sides apart.
TELLING_AREA = 0.3
# How near, as a share of that difference, the tied field's area must be to one of them.
CLOSE = 0.1
# Share of the telling fields that must agree on the side of a tie.
MAJORITY = 0.9


@dataclass(frozen=True)
class Measured:
    """What was seen of each convention; None where it could not be told."""

    tie: Literal["inside", "outside"] | None = None
    normals: Literal["to_low", "to_high"] | None = None
    axes: Literal["array", "reversed"] | None = None
    units: Literal["world", "index"] | None = None
    nan: Literal["raises", "answers"] | None = None
    empty: Literal["mesh", "raises"] | None = None

    def differences(self, declared: Conventions) -> list[tuple[str, str, str]]:
        """(convention, declared, measured) for each that was measured to be something else."""
        rows = [(f.name, getattr(declared, f.name), getattr(self, f.name)) for f in fields(self)]
        return [row for row in rows if row[2] is not None and row[1] != row[2]]


def measure(ask: Ask) -> Measured:
    """The conventions of whatever answers to ``ask(field, isovalue)``, its answers unconverted."""
    field = ball()
    outcome = ask(field, LEVEL)
    axes, units = frame(outcome, field)
    return Measured(
        tie=side_of_ties(ask),
        normals=facing(outcome),
        axes=axes,
        units=units,
        nan=with_nan(ask),
        empty=without_surface(ask),
    )


def ball(shape: tuple[int, int, int] = SHAPE, spacing: tuple[float, ...] = SPACING) -> Field:
    """High in the middle of the lattice, off the centre, and low at the border."""
    i, j, k = np.indices(shape)
    a, b, c = ((n - 1) / 2 + shift for n, shift in zip(shape, (0.1, -0.1, 0.2), strict=True))
    return Field.of(4 - (i - a) ** 2 - (j - b) ** 2 - (k - c) ** 2, spacing)


def frame(
    outcome: Outcome, field: Field
) -> tuple[Literal["array", "reversed"] | None, Literal["world", "index"] | None]:
    """The order of the axes and the units in which the vertices lie where the surface is."""
    vertices = _points(outcome)
    if vertices is None:
        return None, None
    target = _box(field, LEVEL)
    orders: tuple[Literal["array", "reversed"], ...] = ("array", "reversed")
    scales: tuple[Literal["world", "index"], ...] = ("world", "index")
    errors = {}
    for order, scale in product(orders, scales):
        turned = vertices[:, ::-1] if order == "reversed" else vertices
        index = turned / field.spacing if scale == "world" else turned
        errors[order, scale] = np.abs([index.min(0), index.max(0)] - target).max()
    best = min(errors, key=lambda key: float(errors[key]))
    return best if errors[best] < 1 else (None, None)


def facing(outcome: Outcome) -> Literal["to_low", "to_high"] | None:
    """Where right-hand normals point, on a surface round high values, in its own coordinates."""
    vertices, faces = _points(outcome), outcome.faces
    if vertices is None or faces is None or faces.dtype.kind not in "iu" or faces.ndim != 2:
        return None
    if faces.min() < 0 or faces.max() >= len(vertices):
        return None
    a, b, c = vertices[faces[:, :3]].swapaxes(0, 1)
    volume = np.einsum("ij,ij->", a - vertices[0], np.cross(b - a, c - a))
    return "to_low" if volume > 0 else "to_high"


def side_of_ties(ask: Ask) -> Literal["inside", "outside"] | None:
    """The side to which samples equal to the isovalue belong.

    A field of -1, 0 and 1 at isovalue 0 is compared with the fields whose zeros are a little
    higher and a little lower. Flat features vanish with the nudge, so that the surface's area is
    that of one of the two. Fields for which both have the same area tell nothing, and neither do
    those that are like none of the two, since a tie also decides how a cell is filled.
    """
    rng = np.random.default_rng(1987)
    inside = outside = 0
    for _ in range(TIED_FIELDS):
        values = rng.integers(-1, 2, (3, 3, 3)).astype(float)
        tied, high, low = (
            _area(ask(Field.of(np.where(values == 0, nudge, values)), 0.0))
            for nudge in (0.0, NUDGE, -NUDGE)
        )
        gap = abs(high - low)
        if gap > TELLING_AREA:
            inside += abs(tied - high) < CLOSE * gap
            outside += abs(tied - low) < CLOSE * gap
    told = inside + outside
    if not told or max(inside, outside) < MAJORITY * told:
        return None
    return "inside" if inside > outside else "outside"


def with_nan(ask: Ask) -> Literal["raises", "answers"]:
    """What a sample that is not a number does, beside the surface."""
    field = ball()
    values = field.values.copy()
    values[2, 2, 3] = np.nan
    answered = ask(Field(values, field.spacing, field.origin), LEVEL).status is Status.OK
    return "answers" if answered else "raises"


def without_surface(ask: Ask) -> Literal["mesh", "raises"]:
    """What an isovalue above and one below all samples give."""
    answered = all(ask(ball(), level).status is Status.OK for level in (99.0, -99.0))
    return "mesh" if answered else "raises"


def _points(outcome: Outcome) -> Values | None:
    """The vertices, or None where there are none in space."""
    vertices = outcome.vertices
    if vertices is None or vertices.ndim != 2 or vertices.shape[1] != 3 or not len(vertices):
        return None
    points: Values = vertices.astype(np.float64)
    return points if np.isfinite(points).all() else None


def _box(field: Field, level: float) -> Values:
    """Least and greatest index coordinates at which lattice edges cross the level."""
    values = field.values.astype(np.float64)
    crossings = []
    for axis in range(values.ndim):
        low, high = (np.moveaxis(values, axis, 0)[part] for part in (slice(-1), slice(1, None)))
        where = np.argwhere((low >= level) != (high >= level))
        at = tuple(where.T)
        points = where.astype(float)
        points[:, 0] += (level - low[at]) / (high[at] - low[at])
        order = [axis, *(a for a in range(values.ndim) if a != axis)]
        crossings.append(points[:, np.argsort(order)])
    every = np.concatenate(crossings)
    return np.stack([every.min(0), every.max(0)])


def _area(outcome: Outcome) -> float:
    """The area of the mesh, NaN where there is none."""
    mesh = outcome.mesh
    if mesh is None:
        return 0.0 if outcome.status is Status.RAISED else float("nan")
    a, b, c = mesh.vertices[mesh.simplices[:, :3]].swapaxes(0, 1)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)
