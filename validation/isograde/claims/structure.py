"""Claims on the arrays as they came, before anything is made of them (level 0, *runs*).

They are said of every (n, m). Vertices that no simplex names, vertices that stand at one place and
simplices without measure are counted beside the ladder: they are waste, or what a tie leaves, and
no fault of the surface.
"""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
from isoref.field import Floats
from numpy.typing import NDArray

from isograde.claims.evidence import (
    VERDICT_OF,
    answered,
    complex_of,
    failed,
    first_row,
    on_mesh,
    passed,
    place,
    skipped,
)
from isograde.model import Claim, Finding, Judge, Status, Trial, Verdict
from isograde.oracles.complexes import Complex
from isograde.oracles.lattice import FAR
from isograde.oracles.rows import distinct

ROUNDING = 1e-9
"""In cells: closer than this, places are one, and simplices of less measure have none."""

DESIGN = "isograde design: vertices (V, n), simplices (S, n - m + 1), indices from 0"


def answers(trial: Trial) -> Finding:
    """Pass when the call came back with two arrays; else what became of it."""
    outcome = trial.plain
    if outcome.status is Status.OK and answered(outcome):
        return passed()
    return Finding(VERDICT_OF.get(outcome.status, Verdict.FAIL), outcome.detail)


def shapes(trial: Trial) -> Finding:
    """Pass when vertices are (V, n) numbers and simplices (S, k + 1) whole numbers."""
    if not answered(trial.plain):
        return Finding(Verdict.NOT_RUN, "no arrays came back")
    (vertices, simplices), n, k = _arrays(trial), trial.kind.n, trial.kind.k
    if vertices.ndim != 2 or vertices.shape[1] != n or vertices.dtype.kind not in "fiu":
        return failed(
            f"vertices are {vertices.dtype} of shape {vertices.shape}, not (V, {n}) reals"
        )
    if simplices.ndim != 2 or simplices.shape[1] != k + 1 or simplices.dtype.kind not in "iu":
        return failed(
            f"simplices are {simplices.dtype} of shape {simplices.shape}, not (S, {k + 1}) integers"
        )
    return passed(vertices=len(vertices), simplices=len(simplices))


def finite(trial: Trial) -> Finding:
    """Pass when no coordinate is NaN or infinite."""
    vertices, _ = _arrays(trial)
    if not vertices.size:
        return skipped("there is no vertex")
    if vertices.dtype.kind not in "fiub":
        return failed(f"vertices are {vertices.dtype}")
    bad = ~np.isfinite(vertices)
    if not bad.any():
        return passed(vertices=len(vertices))
    first = int(np.argwhere(bad)[0][0])
    return failed(f"vertex {first} has a coordinate that is not finite", count=int(bad.sum()))


def in_range(trial: Trial) -> Finding:
    """Pass when every simplex names vertices that exist."""
    vertices, simplices = _arrays(trial)
    if not simplices.size:
        return skipped("there is no simplex")
    bad = (simplices < 0) | (simplices >= len(vertices))
    if not bad.any():
        return passed(simplices=len(simplices))
    first = int(np.argwhere(bad)[0][0])
    return failed(
        f"simplex {first} names a vertex that does not exist; there are {len(vertices)}",
        simplex=first,
        count=int(bad.sum()),
    )


def no_repeated_index(trial: Trial) -> Finding:
    """Pass when no simplex names a vertex twice."""
    _, simplices = _arrays(trial)
    if simplices.ndim != 2 or simplices.shape[1] < 2 or not len(simplices):
        return skipped("there is no simplex with two vertices")
    same = np.zeros(len(simplices), bool)
    for i, j in combinations(range(simplices.shape[1]), 2):
        same |= simplices[:, i] == simplices[:, j]
    bad = np.flatnonzero(same)
    if not len(bad):
        return passed(simplices=len(simplices))
    return failed(
        f"simplex {int(bad[0])} is {first_row(simplices[bad])}: it names a vertex twice",
        count=len(bad),
        simplex=int(bad[0]),
    )


def no_duplicate(trial: Trial) -> Finding:
    """Pass when no two simplices have the same vertices; those of a soup within its tolerance."""
    found = complex_of(trial)
    if not len(found.simplices):
        return skipped("there is no simplex")
    rows = np.sort(found.simplices, axis=1)
    order = np.lexsort(rows.T)
    same = np.flatnonzero((rows[order][1:] == rows[order][:-1]).all(axis=1))
    if not len(same):
        return passed(simplices=len(rows))
    one, other = sorted(int(order[same[0] + i]) for i in (0, 1))
    return failed(
        f"simplices {one} and {other} are the same",
        count=len(same),
        first=[place(point) for point in found.points[found.simplices[one]]],
    )


def all_used(trial: Trial) -> Finding:
    """Pass when every vertex belongs to a simplex."""
    vertices, simplices = _arrays(trial)
    index = simplices.reshape(-1)
    if index.dtype.kind not in "iu":
        return Finding(Verdict.NOT_RUN, "simplices are no integers")
    if not len(vertices):
        return skipped("there is no vertex")
    used = np.zeros(len(vertices), bool)
    used[index[(index >= 0) & (index < len(vertices))]] = True
    if used.all():
        return passed(vertices=len(vertices))
    first = int(np.argmin(used))
    return failed(f"vertex {first} belongs to no simplex", count=int((~used).sum()), vertex=first)


def apart(trial: Trial) -> Finding:
    """Pass when no two vertices in use stand at one place."""
    found = complex_of(trial)
    places = found.points[found.used] + 0.0
    if len(places) < 2:
        return skipped("there are not two vertices")
    first, name = distinct(places)
    came = _as_they_came(trial)[found.used]
    away = np.abs(came - came[first[name]]).max(axis=1)
    twice = (away <= ROUNDING) & (first[name] != np.arange(len(places)))
    if not twice.any():
        return passed(vertices=len(places))
    count, worst = int(twice.sum()), places[first[np.bincount(name[twice]).argmax()]]
    stand = "1 vertex stands" if count == 1 else f"{count} vertices stand"
    return failed(
        f"{stand} where another does, {'' if count == 1 else 'one '}at index {place(worst)}",
        count=count,
        first=place(worst),
    )


def with_measure(trial: Trial) -> Finding:
    """Pass when every simplex has a length, an area, .."""
    found = complex_of(trial)
    if not len(found.simplices) or found.k < 1:
        return skipped("there is no simplex with a measure")
    bad = np.flatnonzero(found.measures <= 0)
    came = Complex(_as_they_came(trial), found.simplices[bad])
    bad = bad[came.measures <= ROUNDING]
    if not len(bad):
        return passed(simplices=len(found.simplices))
    return failed(
        f"{len(bad)} of {len(found.simplices)} simplices have no measure, the first at index "
        f"{place(found.points[found.simplices[bad[0]]].mean(axis=0))}",
        count=len(bad),
        first=[place(point) for point in found.points[found.simplices[bad[0]]]],
    )


def _as_they_came(trial: Trial) -> Floats:
    """(V, n) index coordinates; what is near an end of the domain is not brought to it.

    Two vertices of single precision may stand on either side of such a plane, and are brought to
    one place there.
    """
    field = trial.field
    places = np.subtract(trial.mesh.vertices, field.origin) / field.spacing
    return np.asarray(np.clip(places, -FAR, FAR))


def _arrays(trial: Trial) -> tuple[NDArray[Any], NDArray[Any]]:
    """The arrays as they came; empty ones where nothing came."""
    outcome = trial.plain
    if outcome.vertices is None or outcome.simplices is None:
        return np.empty((0, trial.kind.n)), np.empty((0, trial.kind.k + 1), np.int64)
    return outcome.vertices, outcome.simplices


def _claim(name: str, rule: str, judge: Judge) -> Claim:
    """A claim of level 0, on the raw arrays."""
    return Claim(f"structure.{name}", rule, DESIGN, 0, judge, needs_mesh=False)


def _counted(name: str, rule: str, judge: Judge) -> Claim:
    """A claim beside the ladder, counted and shown: waste, which nobody need promise to avoid."""
    return Claim(f"structure.{name}", rule, DESIGN, None, judge, promised=False)


CLAIMS = (
    _claim("answers", "Every field within its limits gets an answer: no error, no crash.", answers),
    _claim(
        "shapes",
        "Vertices are (V, n) reals, simplices are (S, n - m + 1) integers, counted from 0.",
        shapes,
    ),
    _claim("finite", "No coordinate is NaN or infinite.", finite),
    _claim("in_range", "Every simplex names vertices that exist.", in_range),
    _claim("no_repeated_index", "No simplex names a vertex twice.", no_repeated_index),
    _counted("no_duplicate", "No two simplices have the same vertices.", on_mesh(no_duplicate)),
    _counted("all_used", "Every vertex belongs to a simplex.", all_used),
    _counted("apart", "No two vertices stand at one place.", on_mesh(apart)),
    _counted("with_measure", "Every simplex has a length, an area, ..", on_mesh(with_measure)),
)
