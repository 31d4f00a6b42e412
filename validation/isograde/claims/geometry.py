"""Claims on where the vertices and the triangles are.

A vertex *stands on* a lattice edge when two of its index coordinates are whole numbers to within
the tolerance (see `isograde.oracles.lattice`).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from isoref.field import Booleans, Floats, Integers

from isograde.claims.evidence import (
    failed,
    lattice_of,
    on_triangles,
    passed,
    place,
    remembered,
    surface_of,
)
from isograde.model import Claim, Finding, Trial
from isograde.oracles.lattice import SINGLE, Lattice, crossing_share
from isograde.oracles.self_intersections import self_intersections
from isograde.oracles.traces import signs_of


@dataclass(frozen=True, eq=False)
class Standing:
    """Where each vertex in use stands.

    Attributes
    ----------
    places : (n, 3) index coordinates
    at_sample, on_edge, inside_cell : (n,) all, two or none of them whole
    low, high : (n, 3) the samples at the ends of the lattice edge it stands on
    axis : (n,) direction of that edge
    within : (n,) it is inside the volume
    """

    places: Floats
    at_sample: Booleans
    on_edge: Booleans
    inside_cell: Booleans
    low: Integers
    high: Integers
    axis: Integers
    within: Booleans


def standing(trial: Trial) -> Standing:
    """Where the trial's vertices stand."""

    def compute() -> Standing:
        lattice, surface = lattice_of(trial), surface_of(trial)
        places = surface.points[surface.used]
        nearest = np.rint(places).astype(np.int64)
        gap = np.abs(places - nearest)
        whole = (gap <= lattice.tolerance).sum(axis=1)
        axis, rows = gap.argmax(axis=1), np.arange(len(places))
        last = np.subtract(lattice.shape, 1)
        low = nearest.copy()
        low[rows, axis] = np.floor(places[rows, axis]).astype(np.int64)
        low = np.clip(low, 0, last)
        high = low.copy()
        high[rows, axis] += 1
        high = np.minimum(high, last)
        slack = lattice.tolerance
        within = np.asarray(((places >= -slack) & (places <= last + slack)).all(axis=1))
        return Standing(places, whole == 3, whole == 2, whole == 0, low, high, axis, within)

    return remembered(trial, "standing", compute)


def on_edges(trial: Trial) -> Finding:
    """Pass when every vertex is on a crossed lattice edge or strictly inside an active cell."""
    lattice, at = lattice_of(trial), standing(trial)
    right = at.within & at.at_sample
    edge = np.flatnonzero(at.within & at.on_edge)
    right[edge] = _inside(lattice, at.low[edge]) != _inside(lattice, at.high[edge])
    inner = np.flatnonzero(at.within & at.inside_cell)
    if len(inner):
        signs = signs_of(lattice)[tuple(np.floor(at.places[inner]).astype(np.int64).T)]
        right[inner] = (signs != 0) & (signs != 255)
    # Inner vertices of a cell with tied corners may be anywhere in it, its faces included.
    bad = np.flatnonzero(~right)
    bad = bad[~_beside_tie(lattice, at.places[bad])]
    if not len(bad):
        return passed(on_edges=len(edge), inside_cells=len(inner))
    first = int(bad[0])
    return failed(
        f"{len(bad)} vertices, the first at index {place(at.places[first])}, which is "
        f"{_where(at, first)}",
        vertices=len(bad),
        first=place(at.places[first]),
    )


def _beside_tie(lattice: Lattice, places: Floats) -> Booleans:
    """(n,) a corner of a cell that the place belongs to is a tied sample."""
    beside = np.zeros(len(places), bool)
    if not len(places) or not lattice.tied.any():
        return beside
    ends = np.stack([np.ceil(places) - 1, np.rint(places), np.floor(places) + 1])
    ends = np.clip(ends, 0, np.subtract(lattice.shape, 1)).astype(np.int64)
    for a, b, c in product(range(3), repeat=3):
        beside |= lattice.tied[ends[a, :, 0], ends[b, :, 1], ends[c, :, 2]]
    return beside


def _where(at: Standing, n: int) -> str:
    """Where a vertex that is out of place stands."""
    if not at.within[n]:
        return "outside the volume"
    if at.on_edge[n]:
        return "on a lattice edge whose ends are on the same side"
    if at.inside_cell[n]:
        return "in a cell whose corners are all on the same side"
    return "in the middle of a face between four samples"


def _inside(lattice: Lattice, sample: Integers) -> Booleans:
    """(n,) the samples' sides."""
    i, j, k = sample.T
    side: Booleans = lattice.inside[i, j, k]
    return side


def linear_crossing(trial: Trial) -> Finding:
    """Pass when every vertex on a crossed lattice edge is where the linear interpolant crosses."""
    lattice, at = lattice_of(trial), standing(trial)
    edge = np.flatnonzero(at.within & (at.on_edge | at.at_sample))
    edge = edge[~lattice.at_tie(at.places[edge])]
    crossed = _inside(lattice, at.low[edge]) != _inside(lattice, at.high[edge])
    astray = edge[~crossed & at.at_sample[edge]]
    edge = edge[crossed]
    values = [
        lattice.field.values[tuple(end[edge].T)].astype(np.float64) for end in (at.low, at.high)
    ]
    share = crossing_share(values[0], values[1], lattice.isovalue)
    found = at.places[edge, at.axis[edge]] - at.low[edge, at.axis[edge]]
    # Allow for values kept in single precision, whose differences lose digits.
    size = np.maximum(np.maximum(np.abs(values[0]), np.abs(values[1])), abs(lattice.isovalue))
    slack = lattice.tolerance + 8 * SINGLE * size / np.abs(values[1] - values[0])
    error = np.abs(found - share)
    # Inner vertices of a cell with tied corners may come to stand on one of its edges.
    bad = np.concatenate([astray, edge[error > slack]])
    bad = bad[~_beside_tie(lattice, at.places[bad])]
    if not len(bad):
        return passed(vertices=len(edge), largest_error=float(error.max()) if len(edge) else 0.0)
    first = int(bad[0])
    return failed(
        f"{len(bad)} of {len(edge)} vertices, the first at index {place(at.places[first])}, are "
        "not at the linear crossing",
        vertices=len(bad),
        first=place(at.places[first]),
        largest_error=float(error.max()) if len(edge) else 0.0,
    )


def no_self_intersection(trial: Trial) -> Finding:
    """Pass when triangles meet in nothing but the vertices and edges that they share."""
    lattice, surface = lattice_of(trial), surface_of(trial).welded()
    pairs = self_intersections(surface.points, surface.faces)
    # Sheets may touch at a tied sample, and fold where its crossings fall together.
    corners = surface.points[surface.faces[pairs]].reshape(-1, 3)
    pairs = pairs[~_beside_tie(lattice, corners).reshape(-1, 6).any(axis=1)]
    if not len(pairs):
        return passed(triangles=len(surface.faces))
    one, other = surface.points[surface.faces[pairs[0]]].tolist()
    return failed(
        f"{len(pairs)} pairs of triangles meet in more than they share; the first are "
        f"{[place(p) for p in one]} and {[place(p) for p in other]}",
        pairs=len(pairs),
        triangles=len(surface.faces),
        first=[one, other],
    )


CLAIMS = (
    Claim(
        id="geometry.on_edges",
        rule="Every vertex is on a lattice edge whose ends are on different sides, or strictly "
        "inside a cell that has corners on both sides.",
        source="Lorensen & Cline 1987, step 5; Nielson & Hamann 1991, section 3 (inner vertices)",
        level=2,
        judge=on_triangles(on_edges),
        unless=frozenset({"on-edges", "border"}),
    ),
    Claim(
        id="geometry.linear_crossing",
        rule="A vertex on a lattice edge is where the linear interpolant takes the isovalue.",
        source="Lorensen & Cline 1987, step 5: linear interpolation along the edge",
        level=2,
        judge=on_triangles(linear_crossing),
        unless=frozenset({"on-edges", "linear-crossing"}),
    ),
    Claim(
        id="geometry.no_self_intersection",
        rule="Two triangles meet in nothing but the vertices and edges that they share.",
        source="Guigue & Devillers 2003 (the test, here in exact arithmetic); a surface without "
        "self-intersections is what 'manifold' means in space",
        level=2,
        judge=on_triangles(no_self_intersection),
        weld="exact",
        tags=frozenset({"trilinear", "cells", "pairs", "noise"}),
        unless=frozenset({"embedded"}),
    ),
)
