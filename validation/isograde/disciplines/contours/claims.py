"""The claims on contours, each with the cases it is judged on and where it comes from."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from isograde.disciplines.contours.judges import (
    Contours,
    area,
    bilinear,
    legal,
    no_crossing,
    on_edges,
    one_rule,
    oriented,
    same_transposed,
    separates,
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
from isograde.model import Claim, Finding, Trial
from isograde.oracles import planar
from isograde.oracles.planar import Booleans, Points


def indexed(trial: Trial, variant: str) -> Contours | None:
    """The contours of a variant in index coordinates of the plain or transposed field."""
    contours = unstacked(trial.outcomes[variant], 2)
    if contours is None:
        return None
    turn = -1 if variant == "transposed" else 1
    spacing, origin = (np.array(x)[::turn] for x in (trial.field.spacing, trial.field.origin))
    return [planar.snapped((c - origin) / spacing) for c in contours]


def _corners(trial: Trial) -> tuple[Points, Points]:
    """The lowest and the highest corner of the lattice, in index coordinates."""
    return np.zeros(2), np.array(trial.field.shape) - 1.0


def _inside(trial: Trial) -> Booleans:
    """The side of each sample."""
    return np.greater_equal(trial.field.values, np.float64(trial.case.isovalue))


def _claim(
    name: str,
    rule: str,
    level: int | None,
    judge: Callable[[Contours, Trial], Finding],
    tags: set[str],
    source: str,
    variants: tuple[str, ...] = (),
    unless: tuple[str, ...] = (),
) -> Claim:
    """A claim of this discipline."""
    return Claim(
        f"contours.{name}",
        rule,
        source,
        level,
        judged(name, judge, lambda trial: indexed(trial, "plain"), 2, "contour", variants),
        tags=frozenset(tags),
        variants=variants,
        needs_mesh=False,
        unless=frozenset(unless),
        discipline="contours",
    )


def _valued(judge: Callable[..., Finding]) -> Callable[[Contours, Trial], Finding]:
    """A judge of contours, values and isovalue, for a trial."""
    return lambda contours, trial: judge(contours, trial.field.values, trial.case.isovalue)


ALL, GENERIC, KNOWN = {"contours"}, {"generic"}, {"known"}
SECTION = "Schlei 2010, section II.A"
CLAIMS: tuple[Claim, ...] = (
    _claim(
        "well-formed",
        "every contour is an array of at least two finite points",
        0,
        lambda contours, _: well_formed(contours, "contour"),
        ALL,
        "the signature of extract_contours",
    ),
    _claim(
        "nothing",
        "a field that is nowhere, or everywhere, inside has no contour",
        0,
        lambda contours, _: nothing(contours, "contour"),
        {"empty"},
        "a contour separates inside from outside",
    ),
    _claim(
        "whole",
        "every contour is closed or ends on the border of the lattice",
        1,
        lambda contours, trial: whole(contours, *_corners(trial), "contour"),
        {"generic", "ties"},
        f"{SECTION}: contours are free of gaps",
    ),
    _claim(
        "no-point-twice",
        "no point is on two contours, or twice on one",
        1,
        lambda contours, _: no_point_twice(contours),
        GENERIC,
        f"{SECTION}: an initial contour vector has one successor",
    ),
    _claim(
        "no-crossing",
        "no two segments cross",
        1,
        lambda contours, _: no_crossing(contours),
        ALL,
        f"{SECTION}, Fig. 1d: contours turn at a point of ambiguity, they do not cross there",
    ),
    _claim(
        "separates",
        "contours pass between two neighbouring samples where, and only where, one is inside",
        1,
        lambda contours, trial: separates(contours, _inside(trial)),
        GENERIC,
        f"{SECTION}: contours enclose the active pixels",
    ),
    _claim(
        "oriented",
        "the inside is on the left of a contour",
        1,
        lambda contours, trial: oriented(contours, _inside(trial)),
        GENERIC,
        f"{SECTION}: shapes counterclockwise, holes clockwise",
        unless=("oriented",),
    ),
    _claim(
        "legal",
        "in each square the segments are those of one of its legal resolutions",
        2,
        lambda contours, trial: legal(contours, _inside(trial)),
        GENERIC,
        "Nielson & Hamann 1991, section 2: two ways to join four points, and a third crosses",
        unless=("on-edges",),
    ),
    _claim(
        "one-rule",
        "one rule decides every ambiguous square: separate, join, mean or saddle",
        2,
        _valued(one_rule),
        GENERIC,
        f"{SECTION}: a consistent choice",
        unless=("on-edges",),
    ),
    _claim(
        "transposed",
        "the transposed field has the transposed contours",
        2,
        lambda contours, trial: same_transposed(contours, indexed(trial, "transposed") or []),
        GENERIC,
        "a contour does not know the order of the axes",
        ("transposed",),
    ),
    _claim(
        "bilinear",
        "every ambiguous square is decided by the saddle of the bilinear interpolant",
        3,
        _valued(bilinear),
        GENERIC,
        "Nielson & Hamann 1991, section 2",
        unless=("on-edges",),
    ),
    _claim(
        "on-edges",
        "every point is where linear interpolation along a lattice edge takes the isovalue",
        None,
        _valued(on_edges),
        GENERIC,
        "Schlei 2010, section II.B and Fig. 2c",
        unless=("on-edges", "linear-crossing"),
    ),
    _claim(
        "count",
        "as many closed and open contours as are known",
        None,
        lambda contours, trial: count(contours, trial.case.facts),
        {"known", "open"},
        "the formula of the field",
    ),
    _claim(
        "area",
        "closed contours enclose the known area",
        None,
        lambda contours, trial: area(contours, trial.case.facts),
        KNOWN,
        "the formula of the field",
        unless=("oriented",),
    ),
)
