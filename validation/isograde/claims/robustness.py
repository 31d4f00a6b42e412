"""Claims on how an implementation bears what it is given.

Those of level 2 (*consistent*) ask for the same arrays to the same question, and that the samples
are left alone. An isovalue beyond every sample gives nothing. What a sample that is not a number
does, and what is done with input that is no field, are conventions: measured and shown, and held
against nobody who does not promise otherwise.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from isoref.field import Integers

from isograde import variants
from isograde.claims.evidence import (
    VERDICT_OF,
    complex_of,
    failed,
    given_samples,
    lattice_of,
    on_mesh,
    passed,
    skipped,
)
from isograde.claims.symmetry import NEAR, Difference, compared, not_own
from isograde.declaration import Declaration
from isograde.model import Claim, Finding, Judge, Outcome, Status, Trial, Verdict, every_family
from isograde.oracles.complexes import Complex
from isograde.oracles.overlay import unmatched

DESIGN = "isograde design"
BAD_INPUT = ("rank", "no-samples", "isovalue-nan")


def input_unmodified(trial: Trial) -> Finding:
    """Pass when no call wrote into the array it was given."""
    asked = [one for one in trial.outcomes.values() if one.status is not Status.DECLINED]
    for name, outcome in trial.outcomes.items():
        if outcome.input_changed:
            return failed(f"the samples were changed by the call ({name})", variant=name)
    return passed(calls=len(asked)) if asked else skipped("nothing was asked")


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
        ("simplices", plain.simplices, again.simplices),
    ):
        if one is None or two is None or not np.array_equal(one, two):
            return failed(f"a second call gives other {what}", variant="repeat")
    return passed() if _count(plain) else skipped("both answers are empty")


def nan(trial: Trial) -> Finding:
    """Pass when a sample that is not a number does what is declared."""
    outcome = trial.outcomes.get("nan")
    if outcome is None or outcome.status is Status.DECLINED:
        return skipped("the case has no such variant")
    declared = trial.declaration.conventions.nan
    if outcome.status is Status.RAISED:
        if declared == "raises":
            return passed()
        if trial.declaration.conventions.empty == "raises" and not _count(trial.plain):
            return skipped("it raises where there is no surface, with such a sample or without")
        return failed(f"declared to answer, but raised: {outcome.detail}", variant="nan")
    if outcome.status is not Status.OK:
        return Finding(VERDICT_OF[outcome.status], outcome.detail, {"variant": "nan"})
    if declared == "answers":
        return passed()
    return failed("declared to raise, but answered without a word", variant="nan")


def elsewhere(trial: Trial) -> Finding:
    """Pass when one sample that is no number, or infinite, changes the mesh about it alone."""
    # Vertices in cells depend on all corners of their cell, and so do the cells beside it.
    reach = 2.0 if trial.declaration.vertices == "cells" else 1.0
    middle = np.array([n // 2 for n in trial.field.shape])
    ours = _apart_from(complex_of(trial), middle, reach + lattice_of(trial).tolerance)
    if not len(ours.simplices):
        return skipped("the mesh has nothing elsewhere")
    answered = 0
    for name in ("nan", "infinity"):
        outcome = trial.outcomes.get(name)
        # Who refuses such a sample does not say what it does elsewhere.
        if outcome is None or outcome.status in (Status.DECLINED, Status.RAISED):
            continue
        variant = variants.variant(name, trial.kind)
        if outcome.status is Status.OK:
            outcome = _where_finite(outcome)
        finding = compared(trial, outcome, variant, _difference_elsewhere(ours, middle, reach))
        if finding.verdict is not Verdict.PASS:
            return finding
        answered += 1
    return passed(answered=answered) if answered else skipped("it refuses such samples")


def _difference_elsewhere(ours: Complex, middle: Integers, reach: float) -> Difference:
    """How the simplices apart from the middle sample differ."""

    def difference(trial: Trial, other: Complex, variant: variants.Variant) -> str:
        del variant
        near = NEAR * lattice_of(trial).tolerance
        theirs = _apart_from(other, middle, reach + lattice_of(trial).tolerance)
        lost, new = unmatched(ours, theirs, near)
        if not len(lost) and not len(new):
            return ""
        return (
            f"{len(lost)} simplices that are more than {reach:g} from that sample are lost, and "
            f"{len(new)} are new"
        )

    return difference


def _apart_from(mesh: Complex, middle: Integers, reach: float) -> Complex:
    """The simplices with no vertex within the reach of the sample along every axis."""
    near = np.asarray((np.abs(mesh.points - middle) <= reach).all(axis=1))
    return Complex(mesh.points, mesh.simplices[~near[mesh.simplices].any(axis=1)])


def _where_finite(outcome: Outcome) -> Outcome:
    """The outcome without the simplices that have a coordinate that is no finite number."""
    points, rows = outcome.vertices, outcome.simplices
    if points is None or rows is None or points.dtype.kind != "f" or points.ndim != 2:
        return outcome
    if rows.ndim != 2 or (rows.size and (rows.min() < 0 or rows.max() >= len(points))):
        return outcome
    finite = np.isfinite(points).all(axis=1)
    kept = rows[finite[rows].all(axis=1)] if rows.size else rows
    return replace(outcome, vertices=np.where(finite[:, None], points, 0), simplices=kept)


def out_of_range(trial: Trial) -> Finding:
    """Pass when an isovalue beyond every sample gives nothing; below, only at open ends."""
    capped = any(end.end == "closed" for end in trial.declaration.ends(trial.kind.n))
    asked = 0
    for name in ("above", "infinite") if capped else ("above", "below", "infinite"):
        outcome = trial.outcomes.get(name)
        if outcome is None or outcome.status is Status.DECLINED:
            continue
        asked += 1
        # Whether infinity is an isovalue is a matter of taste: an error will do.
        if name == "infinite" and outcome.status is Status.RAISED:
            continue
        if outcome.status is not Status.OK:
            return Finding(VERDICT_OF[outcome.status], outcome.detail, {"variant": name})
        if outcome.simplices is None or len(outcome.simplices):
            told = f"{_count(outcome)} simplices for an isovalue {name} all samples"
            return failed(told, variant=name)
    return passed(asked=asked) if asked else skipped("the case has no such variant")


def _count(outcome: Outcome) -> int:
    """Number of simplices that came."""
    return 0 if outcome.simplices is None else len(outcome.simplices)


def bad_input(trial: Trial) -> Finding:
    """Pass when input that is no field is refused with an error that has a text."""
    kind, asked = trial.kind, 0
    for name in BAD_INPUT:
        outcome = trial.outcomes.get(name)
        if outcome is None or outcome.status is Status.DECLINED:
            continue
        # Who takes any dimension is right to answer a field with an axis less.
        if name == "rank" and (kind.n - 1, kind.m) in trial.declaration.limits.kinds:
            continue
        asked += 1
        if outcome.status is Status.OK:
            return failed(f"{name} was answered as if it were a field", variant=name)
        if outcome.status is not Status.RAISED:
            return Finding(VERDICT_OF[outcome.status], outcome.detail, {"variant": name})
        if not outcome.detail.strip():
            return failed(f"{name} was refused without a word", variant=name)
    return passed(refused=asked) if asked else skipped("the case has no such variant")


def _claim(
    name: str,
    rule: str,
    judge: Judge,
    level: int | None,
    variants: tuple[str, ...] = (),
    *,
    needs_mesh: bool = True,
    promised: bool = True,
    families: Callable[[Declaration], bool] = every_family,
) -> Claim:
    """A claim of this family."""
    return Claim(
        id=f"robustness.{name}",
        rule=rule,
        source=DESIGN,
        level=level,
        judge=judge,
        variants=variants,
        needs_mesh=needs_mesh,
        promised=promised,
        families=families,
    )


CLAIMS = (
    _claim(
        "input_unmodified",
        "The samples are not changed.",
        input_unmodified,
        2,
        needs_mesh=False,
        families=given_samples,
    ),
    _claim(
        "deterministic", "Asked twice, it gives the same arrays.", deterministic, 2, ("repeat",)
    ),
    _claim(
        "out_of_range",
        "An isovalue above every sample gives no simplices (or the declared error), an infinite "
        "one neither (or an error), and one below every sample neither, unless the surface is "
        "capped at the border.",
        out_of_range,
        None,
        ("above", "below", "infinite"),
        needs_mesh=False,
    ),
    _claim(
        "nan",
        "A sample that is not a number does what is declared: an error, unless said otherwise.",
        nan,
        None,
        ("nan",),
        needs_mesh=False,
        promised=False,
    ),
    Claim(
        id="robustness.elsewhere",
        rule="A sample that is not a number, or infinite, changes nothing but what is about it, "
        "where it is answered and not refused.",
        source=DESIGN,
        level=None,
        judge=on_mesh(elsewhere),
        families=not_own,
        variants=("nan", "infinity"),
        promised=False,
    ),
    _claim(
        "bad_input",
        "A field with one axis less, no samples, an isovalue that is not a number: each is refused "
        "with an error that says something.",
        bad_input,
        None,
        BAD_INPUT,
        needs_mesh=False,
        promised=False,
        families=given_samples,
    ),
)
