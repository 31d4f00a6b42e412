"""Claims on how an implementation bears what it is given.

Those of level 2 (*consistent*) ask for the same answer whatever the spacing, the layout in memory
or the type of the samples, and twice the same answer to the same question. "The same" is said in
`isograde.claims.symmetry`. Those beside the ladder ask for clear errors and for sense on ties.
"""

from __future__ import annotations

import numpy as np

from isograde.claims.evidence import (
    VERDICT_OF,
    failed,
    off_border,
    on_triangles,
    passed,
    skipped,
    steps_of,
    surface_of,
    welded,
)
from isograde.claims.symmetry import same
from isograde.model import Claim, Finding, Judge, Outcome, Status, Trial
from isograde.oracles.winding import TooWideError

DESIGN = "isograde design"


def input_unmodified(trial: Trial) -> Finding:
    """Pass when no call wrote into the array it was given."""
    for name, outcome in trial.outcomes.items():
        if outcome.input_changed:
            return failed(f"the samples were changed by the call ({name})", variant=name)
    return passed(calls=len(trial.outcomes))


def deterministic(trial: Trial) -> Finding:
    """Pass when a second call gives the same arrays, number for number."""
    again = trial.outcomes.get("repeat")
    if again is None or again.status is Status.DECLINED:
        return skipped("the case was not asked a second time")
    if again.status is not Status.OK:
        return Finding(VERDICT_OF[again.status], f"repeat: {again.detail}", {"variant": "repeat"})
    plain = trial.plain
    for what, one, two in (
        ("vertices", plain.vertices, again.vertices),
        ("faces", plain.faces, again.faces),
    ):
        if one is None or two is None or not np.array_equal(one, two):
            return failed(f"a second call gives other {what}", variant="repeat")
    return passed()


def nan(trial: Trial) -> Finding:
    """Pass when a sample that is not a number does what is declared."""
    outcome = trial.outcomes.get("nan")
    if outcome is None or outcome.status is Status.DECLINED:
        return skipped("the case has no such variant")
    declared = trial.declaration.conventions.nan
    if outcome.status is Status.RAISED:
        if declared == "raises":
            return passed()
        return failed(f"declared to answer, but raised: {outcome.detail}", variant="nan")
    if outcome.status is not Status.OK:
        return Finding(VERDICT_OF[outcome.status], outcome.detail, {"variant": "nan"})
    if declared == "answers":
        return passed()
    return failed("declared to raise, but answered without a word", variant="nan")


def out_of_range(trial: Trial) -> Finding:
    """Pass when an isovalue beyond every sample gives no triangles."""
    asked = 0
    for name in ("above", "below"):
        outcome = trial.outcomes.get(name)
        if outcome is None or outcome.status is Status.DECLINED:
            continue
        asked += 1
        if outcome.status is not Status.OK:
            return Finding(VERDICT_OF[outcome.status], outcome.detail, {"variant": name})
        if outcome.faces is None or len(outcome.faces):
            return failed(
                f"{_count(outcome)} triangles for an isovalue {name} all samples", variant=name
            )
    return passed() if asked else skipped("the case has no such variant")


def _count(outcome: Outcome) -> int:
    """Number of triangles that came."""
    return 0 if outcome.faces is None else len(outcome.faces)


def bad_input(trial: Trial) -> Finding:
    """Pass when input that is no field is refused with an error that has a text."""
    asked = 0
    for name in BAD_INPUT:
        outcome = trial.outcomes.get(name)
        if outcome is None or outcome.status is Status.DECLINED:
            continue
        asked += 1
        if outcome.status is Status.OK:
            return failed(f"{name} was answered as if it were a field", variant=name)
        if outcome.status is not Status.RAISED:
            return Finding(VERDICT_OF[outcome.status], outcome.detail, {"variant": name})
        if not outcome.detail.strip():
            return failed(f"{name} was refused without a word", variant=name)
    return passed(refused=asked) if asked else skipped("the case has no such variant")


def ties(trial: Trial) -> Finding:
    """Pass when, equal vertices welded, directed edges cancel and the mesh separates."""
    surface = surface_of(trial)
    if not len(off_border(trial, surface.unbalanced_edges)):
        return _separated(trial)
    joined = welded(trial)
    loose = off_border(trial, joined.unbalanced_edges, joined.points)
    if not len(loose):
        return _separated(trial)
    return failed(
        f"{len(loose)} directed edges inside the volume are not cancelled, even with equal "
        "vertices welded",
        edges=len(loose),
    )


def _separated(trial: Trial) -> Finding:
    """Pass when samples that the mesh does not touch are on the right sides of it."""
    try:
        steps = steps_of(trial)
    except TooWideError as error:
        return failed(str(error))
    bad = int(steps.unseparated.sum())
    return failed(f"{bad} steps between samples are not separated", steps=bad) if bad else passed()


BAD_INPUT = ("rank-2", "no-samples", "isovalue-nan")
LAYOUTS = ("fortran", "strided", "backwards")
TYPES = ("float32", "float64", "int16", "uint8")


def _claim(
    name: str,
    rule: str,
    judge: Judge,
    level: int | None = 2,
    variants: tuple[str, ...] = (),
    unless: frozenset[str] = frozenset(),
    needs_mesh: bool = True,
) -> Claim:
    """A claim of this family."""
    return Claim(
        id=f"robustness.{name}",
        rule=rule,
        source=DESIGN,
        level=level,
        judge=judge,
        variants=variants,
        unless=unless,
        needs_mesh=needs_mesh,
    )


CLAIMS = (
    _claim(
        "spacing",
        "An uneven spacing stretches the answer and changes nothing else.",
        same("spacing"),
        variants=("spacing",),
        unless=frozenset({"spacing", "on-edges"}),
    ),
    _claim(
        "layout",
        "The order of the samples in memory does not change the answer.",
        same(*LAYOUTS),
        variants=LAYOUTS,
        unless=frozenset({"layout", "on-edges"}),
    ),
    _claim(
        "dtype",
        "The same numbers in another type give the same answer.",
        same(*TYPES),
        variants=TYPES,
        unless=frozenset({"dtype", "on-edges"}),
    ),
    _claim(
        "input_unmodified",
        "The samples are not changed.",
        input_unmodified,
        needs_mesh=False,
    ),
    _claim(
        "deterministic",
        "Asked twice, it gives the same arrays.",
        deterministic,
        variants=("repeat",),
        unless=frozenset({"deterministic"}),
    ),
    _claim(
        "nan",
        "A sample that is not a number does what is declared: an error, unless said otherwise.",
        nan,
        level=None,
        variants=("nan",),
        needs_mesh=False,
    ),
    _claim(
        "out_of_range",
        "An isovalue above or below every sample gives no triangles (or the declared error).",
        out_of_range,
        level=None,
        variants=("above", "below"),
        unless=frozenset({"border"}),
        needs_mesh=False,
    ),
    _claim(
        "bad_input",
        "A plane of samples, no samples, an isovalue that is not a number: each is refused with an "
        "error that says something.",
        bad_input,
        level=None,
        variants=BAD_INPUT,
        needs_mesh=False,
    ),
    Claim(
        id="robustness.ties",
        rule="On a field with ties the mesh, its equal vertices welded, has no boundary inside the "
        "volume as a chain of directed edges, and it separates the samples it does not touch.",
        source=DESIGN,
        level=None,
        judge=on_triangles(ties),
        weld="exact",
        tags=frozenset({"ties"}),
        unless=frozenset({"closed", "separates"}),
    ),
)
