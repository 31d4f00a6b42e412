"""Simplices of any dimension in space of any dimension, drawn as SVG.

In the plane and in space they are drawn as they are; in more dimensions, where a picture of all
would be a thicket, those near the place that the judge named, with one direction of the picture for
each axis. Facets that only one simplex has are red away from the border of the lattice.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import Any

import numpy as np
from isoref.field import Floats, Integers

from isograde.report.picture import open_edges, triangles
from isograde.report.view import Part, View, box, dot, drawing, line

# Show no more simplices than this, those nearest to the place that was named.
SHOWN = {2: 2000, 3: 2000}
SHOWN_BEYOND = 4
NEAR = 10.0


def simplex_picture(record: Mapping[str, Any], mesh: Mapping[str, Any], label: str = "") -> str:
    """The SVG of the simplices that came."""
    shape = tuple(record["shape"])
    n, view = len(shape), View.of(shape)
    steps, origin = np.asarray(record["spacing"]), np.asarray(record["origin"])
    points = (np.asarray(mesh.get("vertices", [])).reshape(-1, n) - origin) / steps
    rows = np.asarray(mesh.get("faces", []), np.int64)
    rows = rows.reshape(len(rows), -1)
    numbers = record["finding"].get("numbers", {})
    at = (np.asarray(numbers["at"]) - origin) / steps if "at" in numbers else None
    parts = list(box(view, shape))
    if len(rows):
        shown = rows[nearest(points, rows, at, SHOWN.get(n, SHOWN_BEYOND))]
        parts += _simplices(view, points, shown)
        parts += _open_facets(view, points, rows, shown, shape)
    if at is not None:
        parts.append(dot(view, at, "ring", 9, nearer=NEAR))
    return drawing(view, parts, label)


def nearest(points: Floats, rows: Integers, at: Floats | None, count: int) -> Integers:
    """The numbers of so many simplices, those nearest to `at` where it is given."""
    if at is None:
        return np.arange(min(count, len(rows)))
    away = np.abs(points[rows].mean(axis=1) - at).max(axis=1)
    return np.argsort(away, kind="stable")[:count]


def _simplices(view: View, points: Floats, rows: Integers) -> Iterator[Part]:
    """Triangles as triangles; of simplices of another dimension the edges."""
    if rows.shape[1] == 3 and points.shape[1] == 3:
        yield from triangles(view, points, rows)
        return
    pairs = np.concatenate([rows[:, pair] for pair in combinations(range(rows.shape[1]), 2)])
    for a, b in np.unique(np.sort(pairs, axis=1), axis=0):
        yield line(view, points[a], points[b], "run")


def _open_facets(
    view: View, points: Floats, rows: Integers, shown: Integers, shape: tuple[int, ...]
) -> Iterator[Part]:
    """The facets of shown simplices that no other simplex has: red, or thin on the border."""
    k = rows.shape[1] - 1
    if k == 2 and points.shape[1] == 3:
        yield from open_edges(view, points, rows, shape)
        return
    top = np.asarray(shape) - 1
    for facet in _once(rows) & _facets(shown):
        place = points[list(facet)]
        on_border = ((place == place[0]).all(axis=0) & ((place[0] == 0) | (place[0] == top))).any()
        if k == 1 and not on_border:
            yield dot(view, place[0], "spot", 3.5, nearer=NEAR)
        for a, b in combinations(place, 2):
            yield line(view, a, b, "rim" if on_border else "gap", nearer=0.05)


def _facets(rows: Integers) -> set[tuple[int, ...]]:
    """Every facet of the simplices, its vertices in order."""
    width = rows.shape[1] - 1
    return {facet for row in rows.tolist() for facet in combinations(sorted(row), width)}


def _once(rows: Integers) -> set[tuple[int, ...]]:
    """The facets that one simplex has and no other."""
    width = rows.shape[1] - 1
    facets = np.concatenate([rows[:, list(kept)] for kept in combinations(range(width + 1), width)])
    ends, uses = np.unique(np.sort(facets, axis=1), axis=0, return_counts=True)
    return {tuple(row) for row in ends[uses == 1].tolist()}
