"""The claims on curves, each with the cases it is judged on and where it comes from."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from isoref.field import Field

from isograde.disciplines.curves.cases import known_curves
from isograde.disciplines.curves.judges import (
    Curves,
    converges,
    covers,
    linking,
    on_surfaces,
    same_swapped,
)
from isograde.disciplines.polylines import (
    count,
    judged,
    no_point_twice,
    nothing,
    unstacked,
    well_formed,
    whole,
)
from isograde.model import Claim, Finding, Trial, Verdict
from isograde.oracles.space_curves import KnownCurves, Points


def _h(field: Field) -> float:
    """The longest edge of a cell."""
    return max(field.spacing)


def _corners(trial: Trial) -> tuple[Points, Points]:
    """The lowest and the highest corner of the lattice."""
    field = trial.field
    return field.position(np.zeros(3)), field.position(np.array(field.shape) - 1)


def _known(trial: Trial) -> KnownCurves:
    """What is known of the trial's case."""
    return known_curves()[trial.case.id]


def _numbers(trial: Trial) -> dict[str, int]:
    """How many closed and open curves are known."""
    known = _known(trial)
    return {"closed": known.closed, "open": len(known.curves) - known.closed}


def _variant(trial: Trial, name: str) -> Curves:
    """The curves of a variant whose call did not fail."""
    return unstacked(trial.outcomes[name], 3) or []


def _claim(
    name: str,
    rule: str,
    level: int | None,
    judge: Callable[[Curves, Trial], Finding],
    tags: set[str],
    source: str,
    variants: tuple[str, ...] = (),
) -> Claim:
    """A claim of this discipline."""
    return Claim(
        f"curves.{name}",
        rule,
        source,
        level,
        judged(name, judge, lambda trial: unstacked(trial.plain, 3), 3, "curve", variants),
        tags=frozenset(tags),
        variants=variants,
        needs_mesh=False,
        discipline="curves",
    )


def _identical(curves: Curves, trial: Trial) -> Finding:
    """There is no curve, for an implementation that declares so."""
    if not trial.declaration.identical:
        return Finding(Verdict.UNSUPPORTED, "declares no answer for surfaces that are the same")
    return nothing(curves, "curve")


ALL = {"curves"}
CLAIMS: tuple[Claim, ...] = (
    _claim(
        "well-formed",
        "every curve is an array of at least two finite points",
        0,
        lambda curves, _: well_formed(curves, "curve"),
        ALL,
        "the signature of extract_curves",
    ),
    _claim(
        "nothing",
        "surfaces that do not meet have no curve",
        0,
        lambda curves, _: nothing(curves, "curve"),
        {"empty"},
        "Ljung & Ynnerman, appendix A",
    ),
    _claim(
        "identical",
        'who declares "identical": "nothing" finds no curve where both surfaces are the same',
        None,
        _identical,
        {"identical"},
        "Ljung & Ynnerman, appendix A: two identical surfaces lead to N intersection tests",
    ),
    _claim(
        "whole",
        "every curve is closed or ends on the border of the lattice",
        1,
        lambda curves, trial: whole(curves, *_corners(trial), "curve"),
        {"generic", "touching", "levels"},
        "Ljung & Ynnerman, section 5: until the curve reaches the boundary or connects to itself",
    ),
    _claim(
        "no-point-twice",
        "no point is on two curves, or twice on one",
        1,
        lambda curves, _: no_point_twice(curves),
        {"generic", "levels"},
        "Ljung & Ynnerman, section 5: segments are marked to prevent multiple connections",
    ),
    _claim(
        "count",
        "as many closed and open curves as are known",
        2,
        lambda curves, trial: count(curves, _numbers(trial)),
        {"known"},
        "the parametrised curve",
    ),
    _claim(
        "linking",
        "closed curves are linked and knotted as the known ones",
        2,
        lambda curves, trial: linking(curves, _known(trial)),
        {"known"},
        "linking numbers by Gauss's integral; knot determinants by Fox's colourings",
    ),
    _claim(
        "swapped",
        "the fields in the other order give the same curves",
        2,
        lambda curves, trial: same_swapped(curves, _variant(trial, "swapped"), _h(trial.field)),
        {"generic"},
        "an intersection is symmetric",
        ("swapped",),
    ),
    _claim(
        "on-surfaces",
        "at every point both functions are within M h^2 / 2 of their isovalues",
        None,
        lambda curves, trial: on_surfaces(curves, _known(trial), _h(trial.field)),
        {"known"},
        "the error of linear interpolation",
    ),
    _claim(
        "covers",
        "found and known curves are within a cell's diagonal of each other",
        None,
        lambda curves, trial: covers(curves, _known(trial), _h(trial.field)),
        {"known", "touching"},
        "the parametrised curve",
    ),
    _claim(
        "converges",
        "the distance to the known curve falls with the square of the cell's size",
        None,
        lambda curves, trial: converges(curves, _variant(trial, "finer"), _known(trial)),
        {"known"},
        "the error of linear interpolation",
        ("finer",),
    ),
)
