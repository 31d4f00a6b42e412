"""The four words of a declaration, as far as the answers on a few balls tell them."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
from isoref.field import Field, Floats
from numpy.typing import NDArray

from isograde.adapters.measure import Ask, Measured, ball, levels
from isograde.checking.arrays import rows_of
from isograde.declaration import Declaration, declaration_json
from isograde.model import SURFACES, Outcome

# A coordinate this near to a whole number, in cells, is one.
WHOLE = 1e-4

# With so many vertices for each place, they are not shared from cell to cell.
SHARED = 1.5


FIVE = "the alternating split of cells into five tetrahedra"


def said_more(declaration: Declaration, word: str) -> bool:
    """Whether the declaration says of a word what a measurement cannot."""
    said = declaration_json(declaration)[word]
    if word == "domain":
        return any(end["inset"] or end["end"] == "periodic" for end in said) or len(said) > 1
    return isinstance(said, dict)


def exact(said: dict[str, Any]) -> bool:
    """Whether this family's top is above level 2."""
    return bool(said["interpolant"] == "multilinear" and said["vertices"] == "edges")


def words_of(ask: Ask, plain: Outcome, measured: Measured) -> dict[str, Any]:
    """The four words, as far as the answers on a few balls tell them."""
    field = ball(SURFACES)
    points = index_of(plain, field, measured)
    interpolant = _interpolant(ask, points, field)
    return {
        "interpolant": interpolant,
        "vertices": _vertices(points, interpolant),
        "domain": _domain(ask),
        "mesh": _mesh(plain),
    }


def index_of(outcome: Outcome, field: Field, measured: Measured) -> Floats:
    """The vertices in samples, in the order of the array's axes."""
    assert outcome.vertices is not None
    points = outcome.vertices.astype(float)
    points = points[:, ::-1] if measured.axes == "reversed" else points
    return points / np.asarray(field.spacing) if measured.units == "world" else points


def _fractional(points: Floats) -> NDArray[np.bool_]:
    """(V, 3) coordinates that are no whole numbers."""
    away: NDArray[np.bool_] = np.abs(points - points.round()) > WHOLE
    return away


def _interpolant(ask: Ask, points: Floats, field: Field) -> Any:
    """Labels where values do not matter, a split where vertices are on its diagonals."""
    seen = np.where(field.values >= 1, 3.0, -1.0)
    again = ask(replace(field, values=seen), (1.0,))
    if again.vertices is not None and again.vertices.shape == points.shape:
        plain = ask(field, levels(SURFACES))
        if plain.vertices is not None and np.allclose(again.vertices, plain.vertices):
            return "labels"
    many = _fractional(points).sum(axis=1) >= 2
    parts = points - np.floor(points)
    inner = np.where(_fractional(points), parts, np.nan)[many]
    # On a diagonal of Kuhn's split every coordinate that is not whole has the same fraction.
    alike = len(inner) and (np.nanmax(inner, axis=1) - np.nanmin(inner, axis=1) < WHOLE).all()
    if alike and many.mean() > 0.3:
        return "kuhn"
    parity = alternating(points)
    return "multilinear" if parity is None else five(parity)


def alternating(points: Floats) -> int | None:
    """The parity of the samples that diagonals join, where vertices are on an alternating split.

    Its edges are those of the lattice and, in each face, the diagonal between the two samples
    whose indices have a sum of this parity.
    """
    inner = _fractional(points)
    two = inner.sum(axis=1) == 2
    if inner.all(axis=1).any() or two.mean() < 0.1:
        return None
    low = np.floor(points[two])
    first, second = (points - np.floor(points))[two][inner[two]].reshape(-1, 2).T
    up, down = np.abs(first - second) < WHOLE, np.abs(first + second - 1) < WHOLE
    if not (up | down).all():
        return None
    # From a sample to that beyond it along both axes, or between the other two.
    parities = (low.sum(axis=1) + down)[up != down] % 2
    return int(parities[0]) if len(parities) and np.ptp(parities) == 0 else None


def five(parity: int) -> dict[str, Any]:
    """The split of each cell into five tetrahedra that joins samples of this parity."""
    found = []
    corners = list(product((0, 1), repeat=3))
    for cell in corners:
        points = [[a + b for a, b in zip(cell, corner, strict=True)] for corner in corners]
        joined = [p for p in points if sum(p) % 2 == parity]
        found.append(joined)
        for other in (p for p in points if sum(p) % 2 != parity):
            near = [p for p in joined if np.abs(np.subtract(p, other)).sum() == 1]
            found.append([other, *near])
    return {"tetrahedra": found}


def _vertices(points: Floats, interpolant: Any) -> str:
    """On edges, where most vertices have one coordinate that is not whole; else in cells."""
    inner = _fractional(points).sum(axis=1)
    parts = points - np.floor(points)
    diagonal = np.where(_fractional(points), parts, np.nan)
    with np.errstate(invalid="ignore"):
        alike = np.ptp(np.where(np.isnan(diagonal), parts.max(1)[:, None], diagonal), axis=1)
    on_edges = inner <= 1
    if interpolant == "kuhn":
        on_edges |= alike < WHOLE
    if isinstance(interpolant, dict):
        on_edges |= inner == 2
    return "edges" if on_edges.mean() > 0.6 else "cells"


def _domain(ask: Ask) -> str:
    """Open or closed: whether the surface of a slab that reaches the border is capped there."""
    place = np.indices((6, 6, 6), dtype=float)
    slab = 1.3 - np.abs(place[0] - 2.55)
    outcome = ask(Field.of(slab), (0.0,))
    mesh = outcome.mesh_of(SURFACES)
    if mesh is None or not len(mesh.simplices):
        return "open"
    _, place_of = np.unique(mesh.vertices.round(5), axis=0, return_inverse=True)
    # Count each triangle once, so that one that is there twice looks no more closed.
    rows = np.unique(np.sort(place_of.reshape(-1)[mesh.simplices], axis=1), axis=0)
    edges = np.concatenate([rows[:, [0, 1]], rows[:, [1, 2]], rows[:, [0, 2]]])
    _, uses = np.unique(edges, axis=0, return_counts=True)
    return "open" if (uses == 1).any() else "closed"


def _mesh(plain: Outcome) -> Any:
    """Soup, where each simplex, or each cell, has corners of its own."""
    assert plain.vertices is not None
    places = np.unique(plain.vertices.astype(float).round(5), axis=0)
    shared = len(plain.vertices) < min(rows_of(plain).size, SHARED * len(places))
    return "indexed" if shared else {"soup": 1e-6}
