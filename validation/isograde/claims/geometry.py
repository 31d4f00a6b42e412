"""Claims on where the vertices and the simplices are (level 2, *consistent*).

A vertex *stands on* the least face of the lattice that holds it, a lattice edge when all but one of
its index coordinates are whole numbers to within the tolerance (`isograde.oracles.standing`); of a
split of the cells, on the least face of a simplex (`isograde.oracles.split`). Where it may stand
follows from what is declared:

edges       on faces of dimension m on whose corners every component has both sides (m = 1: on
            crossed lattice edges), and strictly inside active cells; of a split, on such faces of
            its simplices and inside these
cells       in active cells, their borders included
own         within the reach of an active cell

A cap, where the domain is closed, may have vertices wherever its plane has an inside sample beside
them. A vertex beside a tied sample is not judged: crossings fall together there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from isoref.field import Booleans, Floats, Integers
from scipy.spatial import KDTree

from isograde.claims.evidence import (
    clusters,
    complex_of,
    failed,
    lattice_of,
    on_mesh,
    passed,
    place,
    remembered,
    skipped,
)
from isograde.declaration import Declaration
from isograde.model import Claim, Finding, Kind, Trial
from isograde.oracles.bilinear import tied_saddles
from isograde.oracles.complexes import Complex
from isograde.oracles.crossing_segments import crossing_segments
from isograde.oracles.lattice import SINGLE, Lattice, components, crossing_share
from isograde.oracles.rows import distinct
from isograde.oracles.self_intersections import self_intersections
from isograde.oracles.split import corners_of, locate
from isograde.oracles.standing import has_inside, least_faces, mixed, near_active

# Vertices of a soup that were interpolated from either end of an edge are this near, in cells.
NEARLY = 1e-5
# Pairs of more simplices than this take minutes to compare.
MANY = 30_000


def whole_of(trial: Trial) -> Lattice:
    """The field's samples; along a periodic axis with the first once more after the last."""

    def compute() -> Lattice:
        lattice = lattice_of(trial)
        ends = tuple(replace(end, inset=min(end.inset, 0.0)) for end in lattice.ends)
        if ends == lattice.ends:
            return lattice.within[0]
        declared = replace(lattice.declared, domain=ends)
        return replace(lattice, declared=declared).within[0]

    return remembered(trial, "whole", compute)


def used_places(trial: Trial) -> Floats:
    """(V, n) index coordinates of the vertices that a simplex names, each once."""

    def compute() -> Floats:
        found = complex_of(trial)
        places: Floats = found.points[found.used] + 0.0
        return places[distinct(places)[0]]

    return remembered(trial, "used places", compute)


def vertices(trial: Trial) -> Finding:
    """Pass when every vertex is where the declaration lets vertices be."""
    places, lattice = used_places(trial), lattice_of(trial)
    if not len(places):
        return skipped("there is no vertex")
    beyond = _beyond(lattice, places)
    allowed = _allowed(trial, places)
    # Ask what explains a place that is not allowed, of those alone.
    rest = np.flatnonzero(~allowed)
    if len(rest):
        allowed[rest] = _in_end(trial, places[rest])
    bad = np.flatnonzero(beyond | ~allowed)
    bad = bad[~whole_of(trial).beside_tie(places[bad])]
    if not len(bad):
        return passed(vertices=len(places))
    first = int(bad[0])
    told = "outside its domain" if beyond[first] else FORBIDDEN[lattice.declared.vertices]
    return failed(
        f"{len(bad)} of {len(places)} vertices, the first at index {place(places[first])}, which "
        f"is {told}",
        vertices=len(places),
        wrong=len(bad),
        first=place(places[first]),
    )


FORBIDDEN = {
    "edges": "on no crossed edge and inside no cell with samples on both sides",
    "cells": "in no cell with samples on both sides",
    "own": "farther than its reach from every cell with samples on both sides",
}


def _beyond(lattice: Lattice, places: Floats) -> Booleans:
    """(r,) places outside the domain's ends; of vertices in cells, outside the border layer."""
    slack = {"edges": 0.0, "cells": 0.5}.get(lattice.declared.vertices, lattice.declared.reach)
    slack += lattice.tolerance
    low, high = lattice.first - slack, lattice.last + slack
    return np.asarray(((places < low) | (places > high)).any(axis=1))


def _allowed(trial: Trial, places: Floats) -> Booleans:
    """(r,) what the declaration says of vertices away from the ends."""
    lattice, declared = whole_of(trial), trial.declaration
    if declared.vertices != "edges":
        return near_active(lattice, places, declared.reach)
    if declared.interpolant == "tetrahedra":
        return _on_split(lattice, places, trial.kind)
    low, along = least_faces(lattice, places)
    dimension = along.sum(axis=1)
    right = (dimension == trial.kind.n) | (dimension == trial.kind.m)
    if trial.kind.m > 1:
        right |= dimension > trial.kind.m
    elif declared.interpolant == "multilinear":
        # Where a saddle is on the surface, a vertex inside the cell may come to stand in the face.
        right |= (dimension == 2) & tied_saddles(lattice, low, along)
    return np.asarray(right & mixed(lattice, low, along) & _in_lattice(lattice, places))


def _on_split(lattice: Lattice, places: Floats, kind: Kind) -> Booleans:
    """(r,) places on a face of dimension m of the split, or inside a simplex; all sides on it."""
    found = locate(lattice, places, np.zeros(kind.n, np.int64))
    corners = corners_of(lattice, found)
    inside = np.clip(corners, 0, np.subtract(lattice.shape, 1))
    on = found.weights > 0
    sides = lattice.sides[(slice(None), *np.moveaxis(inside, -1, 0))]
    both = (sides & on).any(axis=-1) & (~sides & on).any(axis=-1)
    dimension = on.sum(axis=1) - 1
    right = ((dimension == kind.n) | (dimension == kind.m)) & both.all(axis=0)
    if kind.m > 1:
        right |= (dimension > kind.m) & both.all(axis=0)
        right |= (dimension < kind.m) & _on_level_sets(lattice, inside, found.weights)
    return np.asarray(right & _in_lattice(lattice, places))


def _on_level_sets(lattice: Lattice, corners: Integers, weights: Floats) -> Booleans:
    """(r,) places where every linear function is at its isovalue, up to what `locate` rounds off.

    Where several sets meet near a face of fewer than m dimensions, `locate` puts the place on it,
    though no function need change sides there. Each of the n + 1 weights was moved by n tolerances
    at most, and the function by as much of its range over the simplex.
    """
    slack = (lattice.n + 1) * lattice.n * lattice.tolerance
    right = np.ones(len(corners), bool)
    for component, isovalue in zip(components(lattice.field), lattice.isovalues, strict=True):
        values = component[tuple(np.moveaxis(corners, -1, 0))].astype(np.float64) - isovalue
        off = np.abs((weights * values).sum(axis=1))
        mixed = (values.min(axis=1) <= 0) & (values.max(axis=1) >= 0)
        right &= mixed & (off <= slack * np.ptp(values, axis=1))
    return right


def _in_lattice(lattice: Lattice, places: Floats) -> Booleans:
    """(r,) places between the first and the last samples."""
    last = np.subtract(lattice.shape, 1) + lattice.tolerance
    return np.asarray(((places >= -lattice.tolerance) & (places <= last)).all(axis=1))


def _in_end(trial: Trial, places: Floats) -> Booleans:
    """(r,) places in an end's plane, or beyond the samples, that a cap or a cut explains."""
    lattice = whole_of(trial)
    at_end, capped = _ends(lattice_of(trial), places)
    inner = np.clip(places, 0, np.subtract(lattice.shape, 1))
    active = near_active(lattice, inner, 0.0)
    return np.asarray(
        (at_end & active) | (capped & has_inside(lattice, *least_faces(lattice, inner)))
    )


def _ends(lattice: Lattice, places: Floats) -> tuple[Booleans, Booleans]:
    """(r,) places in an end's plane or beyond the samples: not in the samples' planes; closed."""
    at_end, capped = np.zeros(len(places), bool), np.zeros(len(places), bool)
    last = np.subtract(lattice.shape, 1)
    for axis, end in enumerate(lattice.ends):
        x = places[:, axis]
        at = np.abs(x - lattice.first[axis]) <= lattice.tolerance
        at |= np.abs(x - lattice.last[axis]) <= lattice.tolerance
        if end.inset < 0 or end.end == "closed":
            # A cap's vertex just beyond a sample may be rounded into the sample's plane.
            near = lattice.tolerance if end.end == "closed" and end.inset < 0 else 0.0
            if end.end == "closed" and lattice.declared.vertices == "own":
                # A cap's vertices come as far into the samples as their reach lets them.
                near = max(near, end.inset + lattice.declared.reach)
            at |= x < near
            at |= x > last[axis] + (end.end == "periodic") - near
        if end.end == "closed":
            capped |= at
        elif end.inset % 1:
            at_end |= at
    return at_end, capped


def crossing(trial: Trial) -> Finding:
    """Pass when every vertex on a crossed edge is where the interpolant crosses it."""
    lattice, places = whole_of(trial), used_places(trial)
    places = places[_in_lattice(lattice, places) & ~_ends(lattice_of(trial), places)[1]]
    places = places[~lattice.at_tie(places)]
    low, high, found = _edges_under(lattice, places)
    sides = lattice.inside[tuple(low.T)], lattice.inside[tuple(high.T)]
    crossed = np.flatnonzero(sides[0] != sides[1])
    if not len(crossed):
        return skipped("no vertex is on a crossed edge between samples that are not tied")
    low, high, found = low[crossed], high[crossed], found[crossed]
    values = components(lattice.field)[0]
    a, b = (values[tuple(end.T)].astype(np.float64) for end in (low, high))
    share, slack = np.full(len(found), 0.5), np.full(len(found), lattice.tolerance)
    if trial.declaration.interpolant != "labels":
        share = crossing_share(a, b, lattice.isovalue)
        # Allow for values kept in single precision, whose differences lose digits.
        size = np.maximum(np.maximum(np.abs(a), np.abs(b)), abs(lattice.isovalue))
        slack = lattice.tolerance + 8 * SINGLE * size / np.abs(b - a)
    error, at = np.abs(found - share), low + found[:, None] * (high - low)
    # Inner vertices of a cell with tied corners may come to stand on one of its edges: not on a
    # crossed one with an end on the isovalue, for whatever crosses it does so in that end.
    bad = np.flatnonzero(error > slack)
    ended = (a[bad] == lattice.isovalue) | (b[bad] == lattice.isovalue)
    bad = bad[ended | ~lattice.beside_tie(np.asarray(at[bad], np.float64))]
    numbers = {"vertices": len(found), "largest_error": float(error.max())}
    if not len(bad):
        return passed(**numbers)
    first = place(at[bad[0]])
    where = "halfway" if trial.declaration.interpolant == "labels" else "at the linear crossing"
    return failed(
        f"{len(bad)} of {len(found)} vertices on edges, the first at index {first}, are not "
        f"{where}",
        wrong=len(bad),
        first=first,
        **numbers,
    )


def _edges_under(lattice: Lattice, places: Floats) -> tuple[Integers, Integers, Floats]:
    """The ends (r, n) of the edges that some of the places stand on, and the share of the way."""
    if lattice.declared.interpolant != "tetrahedra":
        low, along = least_faces(lattice, places)
        on = np.flatnonzero(along.sum(axis=1) == 1)
        low, along = low[on], along[on]
        return low, low + along, ((places[on] - low) * along).sum(axis=1)
    found = locate(lattice, places, np.zeros(lattice.n, np.int64))
    on = np.flatnonzero((found.weights > 0).sum(axis=1) == 2)
    corners, weights = corners_of(lattice, found)[on], found.weights[on]
    ends = np.argsort(weights == 0, axis=1, kind="stable")[:, :2]
    rows = np.arange(len(on))
    return corners[rows, ends[:, 0]], corners[rows, ends[:, 1]], weights[rows, ends[:, 1]]


def embedded(trial: Trial) -> Finding:
    """Pass when simplices meet in nothing but what they share; vertices at one place are one."""
    found = _welded(trial)
    parts = found.simplices
    if len(parts) < 2:
        return skipped("there are not two simplices")
    lattice = lattice_of(trial)
    if any(end.end == "closed" for end in lattice.ends) and (lattice.last <= lattice.first).any():
        return skipped("between closed ends that fall together the two sides of a body touch")
    if len(parts) > MANY:
        return skipped(f"crossings are looked for among up to {MANY:,} simplices")
    pairs = (
        self_intersections(found.points, parts)
        if found.k == 2
        else crossing_segments(found.points, parts)
    )
    # Sheets may touch at a tied sample, and fold where its crossings fall together.
    corners = found.points[parts[pairs]].reshape(-1, trial.kind.n)
    excused = lattice.beside_tie(corners) | _at_own_tie(trial, corners)
    pairs = pairs[~excused.reshape(len(pairs), 2 * (found.k + 1)).any(axis=1)]
    name = {1: "segments", 2: "triangles"}[found.k]
    if not len(pairs):
        return passed(simplices=len(parts))
    one, other = found.points[parts[pairs[0]]].tolist()
    return failed(
        f"{len(pairs)} pairs of {name} meet in more than they share; the first are "
        f"{[place(np.array(p)) for p in one]} and {[place(np.array(p)) for p in other]}",
        pairs=len(pairs),
        simplices=len(parts),
        first=[one, other],
    )


def _at_own_tie(trial: Trial, places: Floats) -> Booleans:
    """(r,) places that stand at a tied sample of a lattice of the implementation's own.

    What it samples there is not known. Where one of its samples is tied, crossings fall together
    in it, and the simplices between them have no extent: these say where.
    """
    at = np.zeros(len(places), bool)
    if trial.declaration.vertices != "own" or not len(places):
        return at
    lattice, mesh = lattice_of(trial), trial.mesh
    points = lattice.index(mesh.vertices)
    tolerance = max(trial.declaration.soup or 0.0, lattice.tolerance)
    rows = np.sort(clusters(points, tolerance)[mesh.simplices], axis=1)
    fallen = (rows[:, 1:] == rows[:, :-1]).any(axis=1)
    if not fallen.any():
        return at
    ties = points[np.unique(mesh.simplices[fallen])]
    distance, _ = KDTree(ties).query(places)
    return np.asarray(distance <= tolerance)


def _welded(trial: Trial) -> Complex:
    """The mesh with vertices at one place made one; of a soup, those that differ by rounding."""
    found = complex_of(trial)
    soup = trial.declaration.soup
    if soup is None:
        return found.welded()
    return found.renamed(clusters(found.points, max(soup, NEARLY)))


def on_edges(declaration: Declaration) -> bool:
    """Vertices on edges."""
    return declaration.vertices == "edges"


CLAIMS = (
    Claim(
        id="geometry.vertices",
        rule="Every vertex is where the implementation says its vertices are: on a crossed lattice "
        "edge (or edge of its split) or strictly inside an active cell; in an active cell; or "
        "within its reach of one. None is outside its domain.",
        source="Lorensen & Cline 1987, step 5; Nielson & Hamann 1991, section 3 (inner vertices); "
        "Gibson 1998, section 2 (vertices in cells)",
        level=2,
        judge=on_mesh(vertices),
    ),
    Claim(
        id="geometry.crossing",
        rule="A vertex on an edge is where the interpolant, linear on it, takes the isovalue; "
        "halfway, where only inside and outside are seen.",
        source="Lorensen & Cline 1987, step 5: linear interpolation along the edge",
        level=2,
        judge=on_mesh(crossing),
        kinds=lambda kind: kind.m == 1,
        families=on_edges,
    ),
    Claim(
        id="geometry.embedded",
        rule="Two simplices meet in nothing but the vertices and edges that they share.",
        source="Guigue & Devillers 2003 (the test, here in exact arithmetic); a surface without "
        "self-intersections is what 'manifold' means in space",
        level=2,
        judge=on_mesh(embedded),
        kinds=lambda kind: kind in ((3, 1), (2, 1)),
    ),
)
