"""The broken miniatures by names that can be imported, so that a snippet can call them as users do.

Beside them what has no miniature: contours and curves that are broken, and known bodies.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from isoref.field import Field
from isoref.simplicial import extract as simplices

from tests.isograde import mistaken
from tests.isograde.faults import kinds
from tests.isograde.miniatures import (
    BROKEN,
    ROUGH,
    accurate,
    by_mean,
    changed,
    made,
    star,
    trilinear,
)
from tests.isograde.test_perfect_claim import BROKEN as DEGENERATE


def slug(name: str) -> str:
    """The name of a miniature as an identifier."""
    return "broken_" + re.sub(r"\W+", "_", name)


globals().update({slug(one.name): one.run for one in BROKEN})


# --- other kinds --------------------------------------------------------------------------------


def kuhn(values: Any, isovalues: Any, spacing: Any) -> Any:
    """Min's simplices, of any kind."""
    mesh = simplices(Field.of(values, spacing, dimension=len(spacing)), isovalues)
    return mesh.vertices, mesh.simplices


def kuhn_without_half(values: Any, isovalues: Any, spacing: Any) -> Any:
    """Every other simplex is left out."""
    vertices, rows = kuhn(values, isovalues, spacing)
    return vertices, rows[::2]


def kuhn_turned(values: Any, isovalues: Any, spacing: Any) -> Any:
    """Every simplex is turned over."""
    vertices, rows = kuhn(values, isovalues, spacing)
    return vertices, rows[:, [*range(rows.shape[1] - 2), -1, -2]]


def kuhn_astray(values: Any, isovalues: Any, spacing: Any) -> Any:
    """The first vertex is somewhere else."""
    vertices, rows = kuhn(values, isovalues, spacing)
    vertices = vertices.copy()
    vertices[rows[:1, 0]] += 0.11 * np.arange(1, 1 + vertices.shape[1])
    return vertices, rows


def contours(values: Any, isovalue: float, spacing: Any, join: bool | None = None) -> Any:
    """The contours of the bilinear interpolant; or ambiguous squares always joined, or never."""
    points: dict[Any, int] = {}
    places: list[Any] = []
    rows: list[list[int]] = []
    above = np.asarray(values, float) - isovalue

    def node(a: Any, b: Any) -> int:
        key = tuple(sorted((a, b)))
        if key not in points:
            p, q = key
            points[key] = len(places)
            places.append(np.add(p, np.subtract(q, p) * above[p] / (above[p] - above[q])))
        return points[key]

    for i, j in np.ndindex(above.shape[0] - 1, above.shape[1] - 1):
        ring = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
        inside = [bool(above[corner] >= 0) for corner in ring]
        leave = [t for t in range(4) if inside[t] and not inside[(t + 1) % 4]]
        enter = [t for t in range(4) if not inside[t] and inside[(t + 1) % 4]]
        if len(leave) == 2:
            f = above[i : i + 2, j : j + 2]
            saddle = (f[0, 0] * f[1, 1] - f[0, 1] * f[1, 0]) * (1 if f[0, 0] >= 0 else -1)
            joined = (saddle > 0) if join is None else join
            # Cut off the outside corner after the edge that leaves, or the inside one before it.
            enter = [(t + 1) % 4 if joined else (t - 1) % 4 for t in leave]
        for t, u in zip(leave, enter, strict=True):
            ends = [node(ring[w], ring[(w + 1) % 4]) for w in (t, u)]
            rows.append(ends)
    vertices = np.array(places, float).reshape(-1, 2) * spacing
    return vertices, np.array(rows, np.int64).reshape(-1, 2)


def contours_apart(values: Any, isovalue: float, spacing: Any) -> Any:
    """Ambiguous squares are always separated."""
    return contours(values, isovalue, spacing, join=False)


def contours_crossing(values: Any, isovalue: float, spacing: Any) -> Any:
    """In ambiguous squares the two segments cross."""
    vertices, rows = contours(values, isovalue, spacing)
    vertices, rows = np.array(vertices), rows.copy()
    middle = np.floor(vertices[rows].mean(axis=1) / spacing).astype(int)
    for cell in np.unique(middle, axis=0):
        both = np.flatnonzero((middle == cell).all(axis=1))
        if len(both) == 2:
            one, other = both
            rows[one], rows[other] = [rows[one, 0], rows[other, 0]], [rows[one, 1], rows[other, 1]]
    return vertices, rows


# --- known bodies -------------------------------------------------------------------------------


def _changed(change: Any) -> Any:
    """The reference with its mesh changed, in cells."""

    def run(values: Any, isovalue: float, spacing: Any) -> Any:
        vertices, faces = accurate(values, isovalue, (1.0, 1.0, 1.0))
        if len(faces):
            vertices, faces = change(np.array(vertices), np.array(faces), values)
        return vertices * spacing, faces

    return run


def _twice(v: Any, f: Any, values: Any) -> Any:
    """The mesh, and the same a little smaller inside."""
    middle = v.mean(axis=0)
    inner = middle + 0.98 * (v - middle)
    return np.concatenate([v, inner]), np.concatenate([f, f + len(v)])


ONCE_MORE = _changed(_twice)
HOLED = _changed(lambda v, f, _: (v, f[1:]))
GROWN = _changed(lambda v, f, _: (v.mean(axis=0) + 1.2 * (v - v.mean(axis=0)), f))
SCALED = _changed(lambda v, f, x: (v * x.shape[0] / (x.shape[0] - 1), f))
SPIKED = _changed(lambda v, f, _: (np.where(np.arange(len(v))[:, None] == 5, v + 2, v), f))
TURNED = _changed(lambda v, f, _: (v, f[:, ::-1]))

WHOLE, EXACT = accurate, trilinear


def contours_joined(values: Any, isovalue: float, spacing: Any) -> Any:
    """Ambiguous squares are always joined."""
    return contours(values, isovalue, spacing, join=True)


def double_curve(values: Any, isovalues: Any, spacing: Any) -> Any:
    """A segment, where two surfaces that are one have no curve in common."""
    return np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]) * spacing, np.array([[0, 1]])


def no_curve(values: Any, isovalues: Any, spacing: Any) -> Any:
    """Nothing."""
    return np.empty((0, 3)), np.empty((0, 2), int)


MEAN = made(decide=by_mean)


# --- what is known by formula -------------------------------------------------------------------

curves_right = kinds.faces
OF_KINDS = (
    "curves_by_the_first_field", "curves_of_eight_points", "curves_of_four_points",
    "curves_pulled_inwards", "curves_with_a_speck", "sections_as_printed", "sections_at_means",
    "sections_with_a_bubble",
)  # fmt: skip
globals().update({name: getattr(kinds, name) for name in OF_KINDS})

globals().update({slug(one.name): one.run for one in ROUGH})
globals().update(
    {
        slug(told): changed(broken, made(decide=by_mean, cut=star))
        for told, broken in DEGENERATE.items()
    }
)
STARS = made(decide=by_mean, cut=star)


def contour_with_a_speck(values: Any, isovalue: float, spacing: Any) -> Any:
    """A closed contour more, too small to see."""
    vertices, rows = contours(values, isovalue, spacing)
    if not len(rows):
        return vertices, rows
    ring = np.array([[0, 1], [1, 2], [2, 0]]) + len(vertices)
    tiny = vertices[0] + 1e-5 * np.array([[1.0, 1.0], [2.0, 1.0], [1.0, 2.0]])
    return np.concatenate([vertices, tiny]), np.concatenate([rows, ring])


def torn_curve(values: Any, isovalues: Any, spacing: Any) -> Any:
    """A segment of the first curve is missing."""
    vertices, rows = kuhn(values, isovalues, spacing)
    return vertices, rows[1:]


def kuhn_at_middles(values: Any, isovalues: Any, spacing: Any) -> Any:
    """Every crossing in the middle of its edge."""
    level = np.reshape(isovalues, (-1,) + (1,) * (np.ndim(values) - 1)) if np.ndim(isovalues) else 0
    signs = np.where(np.asarray(values) >= (isovalues if np.ndim(isovalues) == 0 else level), 1, -1)
    zeros = 0.0 if np.ndim(isovalues) == 0 else (0.0,) * len(isovalues)
    return kuhn(signs.astype(float), zeros, spacing)


with_epsilon = mistaken.with_epsilon


def in_half_precision(values: Any, isovalue: float, spacing: Any) -> Any:
    """The samples are rounded to half precision before the isovalue is taken off."""
    with np.errstate(over="ignore"):
        half = np.asarray(values, np.float64).astype(np.float16)
    return accurate(np.nan_to_num(half), isovalue, spacing)


def in_single_precision(values: Any, isovalue: float, spacing: Any) -> Any:
    """The samples are rounded to single precision before the isovalue is taken off."""
    single = np.asarray(values, np.float64).astype(np.float32)
    return accurate(np.nan_to_num(single), isovalue, spacing)


def half_a_curve(values: Any, isovalues: Any, spacing: Any) -> Any:
    """The second half of the segments is missing."""
    vertices, rows = kuhn(values, isovalues, spacing)
    places = vertices[rows].mean(axis=1)
    return vertices, rows[places[:, 1] < places[:, 1].mean()]


def overflowing(values: Any, isovalue: float, spacing: Any) -> Any:
    """Vertices are infinite where a square of a sample is."""
    vertices, faces = accurate(values, isovalue, spacing)
    with np.errstate(over="ignore", invalid="ignore"):
        size = np.square(np.asarray(values, float)).max()
        return vertices + (0.0 * size if len(vertices) else 0.0), faces


def torn_at_extremes(values: Any, isovalue: float, spacing: Any) -> Any:
    """Every third triangle is missing where a sample is large."""
    vertices, faces = accurate(values, isovalue, spacing)
    large = bool(np.abs(np.asarray(values, float)).max() > 1e200)
    return vertices, faces[np.arange(len(faces)) % 3 > 0] if large else faces


def turned_by_isovalue(values: Any, isovalue: float, spacing: Any) -> Any:
    """One triangle is turned over where the isovalue is not 0."""
    vertices, faces = WHOLE(values, isovalue, spacing)
    if isovalue:
        faces = np.concatenate([faces[:1, ::-1], faces[1:]])
    return vertices, faces
