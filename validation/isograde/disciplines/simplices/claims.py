"""The claims on simplices, each with the cases it is judged on and where it comes from."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from isoref.mesh import Mesh

from isograde.claims.evidence import VERDICT_OF
from isograde.disciplines.simplices.judges import (
    ROUNDING,
    at_crossing,
    closed,
    conforming,
    converges,
    euler,
    flat,
    manifold,
    nothing,
    oriented,
    side,
    well_formed,
)
from isograde.model import Claim, Finding, Status, Trial, Verdict
from isograde.oracles import simplices as oracle
from isograde.oracles.known_manifolds import MANIFOLDS, Manifold


def _known(trial: Trial) -> Manifold:
    """The known manifold of a trial's case."""
    return MANIFOLDS[trial.case.id.removeprefix("simplices/")]


def _joined(mesh: Mesh, trial: Trial) -> Mesh:
    """The mesh; with ties, where vertices fall together up to rounding, they count as one."""
    if "ties" not in trial.case.tags or not len(mesh.vertices):
        return mesh
    slack = ROUNDING * float(np.ptp(_box(trial), axis=0).max())
    return Mesh(*oracle.joined(mesh.vertices, mesh.simplices, slack))


def _box(trial: Trial) -> Any:
    """Lowest and highest corner of the lattice."""
    field = trial.field
    top = np.array(field.shape) - 1
    return field.position(np.stack([0 * top, top]))


def _claim(
    name: str,
    rule: str,
    level: int | None,
    judge: Callable[[Mesh, Trial], Finding],
    tags: set[str],
    source: str,
    variants: tuple[str, ...] = (),
) -> Claim:
    """A claim about a well-formed mesh; not run where there is none."""

    def of_trial(trial: Trial) -> Finding:
        for way in ("plain", *variants):
            outcome = trial.outcomes[way]
            if outcome.status is not Status.OK:
                detail = outcome.detail if way == "plain" else f"{way}: {outcome.detail}"
                return Finding(VERDICT_OF.get(outcome.status, Verdict.FAIL), detail)
        form = well_formed(trial.plain, trial.field.dimension, trial.field.components)
        if name == "well-formed":
            return form
        if form.verdict is not Verdict.PASS or trial.plain.mesh is None:
            return Finding(Verdict.NOT_RUN, form.detail)
        return judge(trial.plain.mesh, trial)

    return Claim(
        f"simplices.{name}", rule, source, level, of_trial, tags=frozenset(tags),
        variants=variants, needs_mesh=False, discipline="simplices",
    )  # fmt: skip


ALL, SOLID = {"simplices"}, {"generic", "ties"}
CLAIMS: tuple[Claim, ...] = (
    _claim(
        "well-formed", "vertices are (V, n) finite numbers, simplices (S, n-m+1) indices", 0,
        lambda _, trial: well_formed(trial.plain, trial.field.dimension, trial.field.components),
        ALL, "the signature of extract_simplices",
    ),
    _claim(
        "nothing", "components without a common zero give no simplex", 0,
        lambda mesh, _: nothing(mesh), {"empty"}, "[1] section 2.2, definition of the isosurface",
    ),
    _claim(
        "closed", "away from the border every facet has something on both sides", 1,
        lambda mesh, trial: closed(_joined(mesh, trial), _box(trial)), SOLID,
        "[1] theorem 2.1: phi^ is continuous",
    ),
    _claim(
        "conforming", "simplices meet in common faces: no face is cut in two ways", 1,
        lambda mesh, trial: conforming(_joined(mesh, trial), _box(trial)), SOLID,
        "[1] section 2, definition of a triangulation",
    ),
    _claim(
        "manifold", "a facet belongs to two simplices at most", 1,
        lambda mesh, _: manifold(mesh), {"generic"}, "[1] section 5: a manifold of dimension n - m",
    ),
    _claim(
        "oriented", "neighbours are oriented alike", 1,
        lambda mesh, _: oriented(mesh), {"generic"}, "orientability of regular level sets",
    ),
    _claim(
        "side", "det(-g_1, .., -g_m, t_1, .., t_k) > 0: normals point from high to low", 2,
        lambda mesh, trial: side(mesh, _known(trial)), {"known"}, "the convention of the house",
    ),
    _claim(
        "euler", "Euler characteristic and number of pieces are those of the known manifold", 2,
        lambda mesh, trial: euler(mesh, _known(trial)), {"known"}, "the manifold's description",
    ),
    _claim(
        "at-crossing", "every vertex lies in a cell where each component has both signs", None,
        lambda mesh, trial: at_crossing(mesh, trial.field), {"generic"},
        "interpolation stays between its samples",
    ),
    _claim(
        "flat", "where the components are affine, every vertex solves them", None,
        lambda mesh, trial: flat(mesh, _known(trial)), {"flat"},
        "[1] section 2.2: linear on each simplex",
    ),
    _claim(
        "converges", "the error of the volume falls with the square of the cell's edge", None,
        lambda mesh, trial: converges(mesh, trial.outcomes["finer"].mesh, _known(trial)),
        {"volume"}, "the error of linear interpolation", ("finer",),
    ),
)  # fmt: skip
