"""What judges share: the truths about one trial, each computed once, and how to say a finding."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

import numpy as np
from isoref.field import Booleans, Floats, Integers

from isograde.model import Finding, Judge, Outcome, Status, Trial, Verdict
from isograde.oracles.flat import LIMIT, MOST
from isograde.oracles.halfedges import Surface
from isograde.oracles.lattice import Lattice
from isograde.oracles.traces import Traces, traces
from isograde.oracles.winding import Steps, steps

T = TypeVar("T")

PASSED = Finding(Verdict.PASS)


def passed(**numbers: Any) -> Finding:
    """The claim holds; the numbers say on how much evidence."""
    return Finding(Verdict.PASS, "", numbers)


def failed(detail: str, **numbers: Any) -> Finding:
    """The claim does not hold, and why."""
    return Finding(Verdict.FAIL, detail, numbers)


def skipped(detail: str) -> Finding:
    """The case offers nothing to judge the claim by."""
    return Finding(Verdict.SKIP, detail)


VERDICT_OF = {
    Status.DECLINED: Verdict.UNSUPPORTED,
    Status.RAISED: Verdict.ERROR,
    Status.GARBAGE: Verdict.FAIL,
    Status.CRASH: Verdict.CRASH,
    Status.TIMEOUT: Verdict.TIMEOUT,
    Status.MEMORY: Verdict.TIMEOUT,
}


def remembered(trial: Trial, key: str, compute: Callable[[], T]) -> T:
    """``compute()``, computed once for this trial."""
    if key not in trial.memory:
        trial.memory[key] = compute()
    value: T = trial.memory[key]
    return value


def on_triangles(judge: Judge) -> Judge:
    """The judge, for outcomes that are triangles in space; anything else is not run."""

    @wraps(judge)
    def guarded(trial: Trial) -> Finding:
        mesh = trial.plain.mesh
        if mesh is None or mesh.vertices.shape[1] != 3 or mesh.simplices.shape[1] != 3:
            return Finding(Verdict.NOT_RUN, "there are no triangles in space to judge")
        return judge(trial)

    return guarded


def lattice_of(trial: Trial) -> Lattice:
    """The trial's samples and sides, with the declared side of a tie."""
    return remembered(
        trial,
        "lattice",
        lambda: Lattice.of(trial.field, trial.case.isovalue, trial.declaration.conventions.tie),
    )


def surface_of(trial: Trial) -> Surface:
    """The plain outcome's surface, its vertices in index coordinates."""
    return remembered(
        trial,
        "surface",
        lambda: Surface.of(lattice_of(trial).index(trial.mesh.vertices), trial.mesh.simplices),
    )


def judged_surface(trial: Trial) -> Surface:
    """The surface as given; where it is open there and ties could be why, welded."""

    def compute() -> Surface:
        surface = surface_of(trial)
        loose = off_border(trial, surface.open_edges)
        return welded(trial) if len(loose) and lattice_of(trial).tied.any() else surface

    return remembered(trial, "judged surface", compute)


def welded(trial: Trial) -> Surface:
    """The surface, vertices at a tied sample or of exactly equal coordinates made one."""

    def compute() -> Surface:
        surface = surface_of(trial)
        at_tie = lattice_of(trial).at_tie(surface.points)[:, None]
        points = np.where(at_tie, np.rint(surface.points), surface.points)
        return Surface(points, surface.faces).welded()

    return remembered(trial, "welded", compute)


def steps_of(trial: Trial) -> Steps:
    """The steps between samples that the plain outcome's surface, or the field, makes."""
    surface = surface_of(trial)
    return remembered(
        trial, "steps", lambda: steps(lattice_of(trial), surface.points, surface.faces)
    )


def traces_of(trial: Trial) -> Traces:
    """The plain outcome's traces in the cells."""
    surface = surface_of(trial)
    return remembered(
        trial, "traces", lambda: traces(lattice_of(trial), surface.points, surface.faces)
    )


def undecided(trial: Trial, cells: Booleans) -> Finding | None:
    """What to say where no cell is wrong and these cells are not judged; None where all are.

    cells : (n,) of `traces_of(trial)`, with too many flat triangles
    """
    count = int((cells & ~traces_of(trial).tied).sum())
    if not count:
        return None
    return skipped(
        f"{count} cells are not judged: more than {MOST} triangles lie flat in a face, or there "
        f"are more than {LIMIT:,} ways to give such triangles to the cells on either side"
    )


def off_border(trial: Trial, edges: Integers, points: Floats | None = None) -> Integers:
    """Those of the edges that do not lie on one side of the volume's border."""
    if not len(edges):
        return edges
    places = surface_of(trial).points if points is None else points
    return edges[~lattice_of(trial).on_border(places, edges)]


def off_ties(trial: Trial, places: Floats) -> Booleans:
    """(n,) places that are not a tied sample, where sheets may touch."""
    return ~lattice_of(trial).at_tie(places)


def place(point: Floats) -> list[float]:
    """Index coordinates, rounded for a reader."""
    return [round(float(x), 6) for x in point]


def answered(outcome: Outcome) -> bool:
    """The call came back with two arrays."""
    return outcome.vertices is not None and outcome.faces is not None


def first_row(rows: Integers) -> list[int]:
    """The first row, as JSON."""
    return [int(x) for x in np.asarray(rows).reshape(len(rows), -1)[0]]
