"""Continuity in the isovalue: the mesh does not jump where the level set does not.

As the isovalue passes the value of a saddle inside a cell, a tunnel's waist shrinks to the saddle
and parts. The level set is continuous there: from a step below the value to a step above it, it
moves by about the root of the step. A mesh that draws the tunnel, and next the two flat sheets that
are left of it, jumps by a third of a cell's side, however small the step. So the distance of both
meshes is taken at several steps, and its observed order must not be below the level set's 1/2. Who
draws no tunnels, and moves with the crossings alone, has order 1.

Saddles on faces are left out: there every mesh whose vertices are on edges and inside cells draws
straight lines between other crossings, and jumps (`papers/trilinear/continuity.py` measures it).

Nobody promises this who does not say so, and no case of it is in the plan's default run.
"""

from __future__ import annotations

import numpy as np
from isoref.field import Floats
from isoref.mesh import Mesh

from isograde import variants
from isograde.claims.accuracy import SLACK, sees_values
from isograde.claims.evidence import VERDICT_OF, failed, on_mesh, passed, placed, skipped
from isograde.model import SURFACES, Claim, Finding, Status, Trial
from isograde.oracles.body_measures import Search
from isograde.oracles.complexes import Complex
from isograde.oracles.convergence import observed_order

FORMAL = 0.5
# Points of a triangle: corners, those that cut its sides in four, and between them.
WEIGHTS = np.array([[i, j, 4 - i - j] for i in range(5) for j in range(5 - i)]) / 4
# Movements below are what single precision rounds off, in cells.
STILL = 1e-6


def farthest(one: Complex, other: Complex) -> float:
    """The largest distance of points on one mesh from the other, in cells."""
    points = np.einsum("pk,fkd->pfd", WEIGHTS, one.points[one.simplices]).reshape(-1, 3)
    return float(Search.of(other.points, other.simplices).distances(points).max())


def moved(one: Complex, other: Complex) -> float:
    """Hausdorff's distance of two meshes that have triangles, from points on triangles."""
    return max(farthest(one, other), farthest(other, one))


def continuous(trial: Trial) -> Finding:
    """Pass when what the mesh moves shrinks with the step as the level set's movement does."""
    steps, moves = [], []
    for word, step in variants.STEPS.items():
        meshes = []
        for way in "-+":
            outcome = trial.outcomes.get(f"passed/{way}{word}")
            if outcome is None or outcome.status is Status.DECLINED:
                return skipped("the isovalue cannot be moved")
            if outcome.status is not Status.OK:
                return Finding(VERDICT_OF[outcome.status], outcome.detail, {"variant": word})
            mesh = outcome.mesh_of(trial.kind)
            if mesh is None:
                return failed(f"at an isovalue {way}{word} further no mesh came back")
            meshes.append(mesh)
        if not all(len(mesh.simplices) for mesh in meshes):
            return failed(f"{word} to a side of the isovalue there is no surface")
        steps.append(step)
        moves.append(_between(trial, *meshes))
    return _judged(np.array(steps), np.array(moves))


def _between(trial: Trial, one: Mesh, other: Mesh) -> float:
    """How far apart two answers to the trial's field are, in cells."""
    return moved(placed(trial, one), placed(trial, other))


def _judged(steps: Floats, moves: Floats) -> Finding:
    """What these movements say; the smallest step comes last."""
    if moves.max() < STILL:
        return skipped("the mesh does not move with the isovalue")
    order = observed_order(steps, np.maximum(moves, STILL))
    numbers = {
        "order": round(order.value, 3),
        "interval": [round(order.low, 3), round(order.high, 3)],
        "formal": FORMAL,
        "first_move": float(moves[0]),
        "last_move": float(moves[-1]),
    }
    if order.high >= FORMAL - SLACK:
        return passed(**numbers)
    return failed(
        f"the mesh moves by {moves[0]:.2g} cells as the isovalue passes the saddle by "
        f"{steps[0]:.2g}, and by {moves[-1]:.2g} as it passes it by {steps[-1]:.2g}: order "
        f"{order.value:.2f} (95 %: {order.low:.2f} to {order.high:.2f}), that of the level set is "
        f"{FORMAL:g}",
        **numbers,
    )


CLAIMS = (
    Claim(
        "accuracy.continuity",
        "As the isovalue passes the value of a saddle inside a cell, where a tunnel ends, the mesh "
        "moves by a distance that shrinks with the step at least as the level set's movement does, "
        f"with order 1/2, to within {SLACK:g} of the 95 % confidence interval. In full runs alone.",
        "Lopes & Brodlie 2003: an isosurface that moves continuously with the isovalue",
        None,
        on_mesh(continuous),
        kinds=lambda kind: kind == SURFACES,
        families=sees_values,
        tags=frozenset({"passing"}),
        variants=("passed/",),
        promised=False,
    ),
)
