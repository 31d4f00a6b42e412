"""The discipline ``contours``: where a field on a 2-D lattice takes a value.

An implementation is a function::

    extract_contours(values, isovalue, spacing) -> list of (N, 2) arrays

values      one array (N1, N2)
spacing     two floats; a point is ``index * spacing``, in the order of the array's axes
answer      one array a contour, its points in order; a closed contour repeats its first point;
            the inside, value >= isovalue, lies on the left when axis 0 points right and axis 1 up

It goes through the doors like any other: declare ``{"discipline": "contours"}`` and name it
``python:my.module:extract_contours``. Inside, `through_door` makes of it a function that answers
with arrays of points and contour numbers. Programs behind ``exec:`` and folders behind ``dir:``
give these arrays as they stand: `LAYOUT` says how.

The four rules for an ambiguous square, whose inside corners are opposite ones: *separate* them,
*join* them, join them where the *mean* of the four samples is inside (Schlei), or where the
*saddle* of the bilinear interpolant is (Nielson & Hamann). Each is right; to follow none of them
throughout is not.

References
----------
[1] B. R. Schlei, Volume-enclosing surface extraction, section II.A and Fig. 1.
[2] G. M. Nielson, B. Hamann, The asymptotic decider, section 2.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from isoref.field import Field
from numpy.typing import NDArray

from isograde.claims.evidence import VERDICT_OF, failed, passed
from isograde.disciplines.polylines import complaint, declare, stacked, unstacked
from isograde.model import (
    Case,
    Claim,
    Finding,
    Outcome,
    Trial,
    Verdict,
)
from isograde.truths import planar
from isograde.truths.planar import Booleans, Points

Contours = list[Points]
Extract = Callable[[Any, float, tuple[float, ...]], Sequence[Any]]

RULES = ("separate", "join", "mean", "saddle")


# --- through the doors ---------------------------------------------------------------------------

# What a manifest says of requests and answers.
LAYOUT: Mapping[str, str] = {
    "values": "npy in C order, (N1, N2)",
    "inside": "value >= isovalue, on the left of a contour when axis 0 points right and axis 1 up",
    "vertices": "origin + index * spacing (V, 2): all points, one contour after the other; a "
    "closed contour repeats its first point",
    "faces": "for each point the number of its contour, (V,) or (V, 1)",
    "answer": "beside the values, same name: .vertices.npy and .faces.npy",
    "no contour": "arrays without points; a missing file counts as unsupported",
}


def through_door(function: Extract) -> Callable[[Any, float, tuple[float, ...]], Any]:
    """`function` as the doors call it.

    It answers with the points of all contours (V, 2) and, for each, its contour's number (V, 1).
    """

    def extract(
        values: NDArray[Any], isovalue: float, spacing: tuple[float, ...]
    ) -> tuple[NDArray[Any], NDArray[Any]]:
        return stacked(function(values, isovalue, tuple(spacing)), 2, "contour")

    return declare(extract, function, "contours")


def polylines(outcome: Outcome) -> Contours | None:
    """The contours of an outcome, or None where it holds none that can be judged."""
    return unstacked(outcome, 2)


# --- judges: contours in index coordinates -------------------------------------------------------


def is_closed(contour: Points) -> bool:
    """Whether the contour ends where it began."""
    return len(contour) > 1 and bool((contour[0] == contour[-1]).all())


def well_formed(contours: Contours) -> Finding:
    """Every contour has at least two points, all of them finite."""
    for number, contour in enumerate(contours):
        if len(contour) < 2:
            return failed(f"contour {number} has {len(contour)} point", contour=number)
        if not np.isfinite(contour).all():
            return failed(f"contour {number} has a coordinate that is not finite", contour=number)
    return passed(contours=len(contours))


def nothing(contours: Contours) -> Finding:
    """There is no contour."""
    return failed(f"{len(contours)} contours where there is none") if contours else passed()


def whole(contours: Contours, shape: tuple[int, ...]) -> Finding:
    """Every contour is closed or has both ends on the border of the lattice."""
    top = np.array(shape) - 1
    for number, contour in enumerate(contours):
        ends = contour[:0] if is_closed(contour) else contour[[0, -1]]
        for end in ends:
            if not ((end == 0) | (end == top)).any():
                at = end.tolist()
                return failed(f"contour {number} ends inside, at {at}", contour=number, at=at)
    return passed(closed=sum(map(is_closed, contours)))


def no_point_twice(contours: Contours) -> Finding:
    """No two points are equal, but for the last point of a closed contour."""
    points = [c[:-1] if is_closed(c) else c for c in contours]
    places, count = np.unique(
        np.concatenate([*points, np.empty((0, 2))]), axis=0, return_counts=True
    )
    if (count > 1).any():
        at = places[count.argmax()].tolist()
        return failed(f"{int((count > 1).sum())} points come twice, such as {at}", at=at)
    return passed(points=len(places))


def no_crossing(contours: Contours) -> Finding:
    """No two segments cross."""
    parts = planar.segments(contours)
    pairs = planar.crossing_pairs(parts)
    if len(pairs):
        at = parts[pairs[0, 0]].mean(axis=0).round(6).tolist()
        return failed(f"{len(pairs)} pairs of segments cross, one near {at}", pairs=len(pairs))
    return passed(segments=len(parts))


def separates(contours: Contours, inside: Booleans) -> Finding:
    """Contours cross the step between two samples oddly often where their sides differ."""
    return _steps(contours, inside, lambda crossed, expected: (crossed - expected) % 2 != 0)


def oriented(contours: Contours, inside: Booleans) -> Finding:
    """Going along a contour, the inside is on the left."""
    return _steps(contours, inside, lambda crossed, expected: crossed != expected)


def _steps(contours: Contours, inside: Booleans, wrong: Callable[[Any, Any], Booleans]) -> Finding:
    """Fails at the first step along either axis whose crossings are wrong for its two sides."""
    parts = planar.segments(contours)
    for axis in (0, 1):
        sides = inside.astype(np.int64)
        crossed = planar.crossings(parts, inside.shape, axis)
        bad = np.argwhere(wrong(crossed, -np.diff(sides, axis=axis)))
        if len(bad):
            i, j = bad[0].tolist()
            return failed(
                f"{len(bad)} steps along axis {axis}, the first from sample ({i}, {j}): crossed "
                f"{int(crossed[i, j])} times from right to left",
                axis=axis,
                sample=[i, j],
            )
    return passed(samples=int(inside.size))


def legal(contours: Contours, inside: Booleans) -> Finding:
    """In each square the segments join edges as one of its legal resolutions does."""
    found = planar.squares(planar.segments(contours))
    expected = planar.legal(inside)
    for square in sorted(found.keys() | expected.keys()):
        pairs = found.get(square, [])
        if len(set(pairs)) != len(pairs) or set(pairs) not in expected.get(square, [set()]):
            shown = [sorted(map(str, pair)) for pair in pairs]
            return failed(f"square {list(square)} has segments {shown}", square=list(square))
    return passed(squares=len(expected))


def one_rule(contours: Contours, values: NDArray[Any], isovalue: float) -> Finding:
    """One of the four rules decides every ambiguous square."""
    decided = _decisions(contours, values, isovalue)
    fitting = [
        rule for rule in RULES if all(answer[rule] in (did, None) for did, answer in decided)
    ]
    if not fitting:
        return failed("no rule decides all ambiguous squares so", ambiguous=len(decided))
    return passed(rules=fitting, ambiguous=len(decided))


def bilinear(contours: Contours, values: NDArray[Any], isovalue: float) -> Finding:
    """Every ambiguous square is decided by the saddle of the bilinear interpolant."""
    decided = _decisions(contours, values, isovalue)
    wrong = sum(answer["saddle"] not in (did, None) for did, answer in decided)
    if wrong:
        return failed(f"{wrong} of {len(decided)} ambiguous squares are decided otherwise")
    return passed(ambiguous=len(decided))


def _decisions(
    contours: Contours, values: NDArray[Any], isovalue: float
) -> list[tuple[bool, dict[str, bool | None]]]:
    """For each ambiguous square that is legal: whether it is joined, and what the rules say."""
    found = planar.squares(planar.segments(contours))
    decided = []
    for (i, j), answers in planar.legal(values >= isovalue).items():
        pairs = set(found.get((i, j), []))
        if len(answers) == 2 and pairs in answers:
            rules = planar.joins(values[i : i + 2, j : j + 2], isovalue)
            decided.append((pairs == answers[1], rules))
    return decided


def on_edges(contours: Contours, values: NDArray[Any], isovalue: float) -> Finding:
    """Every point is where linear interpolation along a lattice edge takes the isovalue."""
    worst, top = 0.0, np.array(values.shape) - 1
    for place in np.concatenate([*contours, np.empty((0, 2))]):
        if not ((place >= 0) & (place <= top)).all():
            return failed(f"point {place.tolist()} is outside the lattice", at=place.tolist())
        edge = planar.edge_of(place)
        if edge is None:
            return failed(f"point {place.tolist()} is on no lattice edge", at=place.tolist())
        i, j, axis = edge
        low, high = (float(values[i + s * (1 - axis), j + s * axis]) - isovalue for s in (0, 1))
        if (low >= 0) == (high >= 0):
            return failed(f"edge {list(edge)} does not take the isovalue", edge=list(edge))
        worst = max(worst, abs(place[axis] - (i, j)[axis] - low / (low - high)))
    if worst > planar.SNAP:
        return failed(f"a point is {worst:.3g} of an edge from where it should be", worst=worst)
    return passed(worst=worst)


def count(contours: Contours, known: Mapping[str, Any]) -> Finding:
    """As many closed and open contours as are known."""
    closed = sum(map(is_closed, contours))
    found = {"closed": closed, "open": len(contours) - closed}
    expected = {kind: known[kind] for kind in ("closed", "open")}
    if found != expected:
        return failed(f"{found} contours, where there are {expected}")
    return passed(**found)


def area(contours: Contours, known: Mapping[str, Any]) -> Finding:
    """Closed contours enclose the known area, up to a share that falls with the square's size."""
    found = planar.enclosed_area(contours)
    if abs(found - known["area"]) > known["tolerance"]:
        return failed(f"area {found:.6g}, where it is {known['area']:.6g}", area=found)
    return passed(area=found, expected=known["area"])


def same_transposed(contours: Contours, transposed: Contours) -> Finding:
    """The transposed field has the same segments, with their coordinates exchanged."""
    one = planar.segments(contours)
    other = planar.segments(transposed)[..., ::-1]
    if len(one) != len(other):
        return failed(f"{len(one)} segments, {len(other)} of the transposed field")
    worst = max(planar.farthest(one, other), planar.farthest(other, one))
    if worst > planar.SNAP:
        return failed(f"segments differ by up to {worst:.3g} of an edge", worst=worst)
    return passed(segments=len(one))


# --- cases ---------------------------------------------------------------------------------------


def cases(seed: int = 0) -> list[Case]:
    """Every case of the discipline, deterministic for a seed."""
    listed = [
        _case("disc", _disc, 0.0, {"generic", "known"}, _round(2.5, 0.3, closed=1)),
        _case("annulus", _annulus, 0.0, {"generic", "known"}, _annular()),
        _case("two-discs", _two_discs, 0.0, {"generic", "known"}, _round(1.5, 0.3, closed=2)),
        _case("border", _border, 0.0, {"generic", "open"}, {"closed": 0, "open": 2}),
        _case("waves", partial(_waves, seed), 0.1, {"generic"}, {}),
        _case("noise", partial(_noise, seed), 0.05, {"generic"}, {}),
        _case("narrow", partial(_narrow, seed), 0.0, {"generic"}, {}),
        _case("bytes", partial(_bytes, seed), 99.5, {"generic"}, {}),
        _case("integers", _integers, 9.0, {"ties"}, {}),
        _case("constant", _constant, 0.5, {"empty"}, {}),
        _case("at-the-constant", _constant, 1.0, {"empty"}, {}),
        _case("out-of-range", _integers, 1000.0, {"empty"}, {}),
    ]
    for signs in range(16):
        listed.append(_case(f"square-{signs:04b}", partial(_square, signs), 0.0, {"generic"}, {}))
    for mean in (False, True):
        for saddle in (False, True):
            name = f"saddle-{'mean-in' if mean else 'mean-out'}-{'in' if saddle else 'out'}"
            listed.append(_case(name, partial(_saddle, mean, saddle), 0.0, {"generic"}, {}))
    return listed


def _case(
    name: str,
    build: Callable[[], Field],
    isovalue: float,
    tags: set[str],
    facts: Mapping[str, Any],
) -> Case:
    """A case of this discipline."""
    size = build().values.size
    return Case(
        f"contours/{name}", build, isovalue, size, frozenset({"contours", *tags}), dict(facts)
    )


def _plane(n1: int = 25, n2: int = 29) -> tuple[Points, Points, tuple[float, float]]:
    """Coordinates over -3.6 to 3.6 and -4.2 to 4.2 in squares of 0.3."""
    x, y = np.meshgrid(
        0.3 * (np.arange(n1) - (n1 - 1) / 2), 0.3 * (np.arange(n2) - (n2 - 1) / 2), indexing="ij"
    )
    return x, y, (0.3, 0.3)


def _round(radius: float, h: float, *, closed: int) -> dict[str, Any]:
    """What is known of discs of this radius sampled by their distance, in squares of side h.

    A chord of length up to sqrt(2) h lies h^2 / 4 r inside the circle at most, and interpolation
    errs by h^2 / 8 r: both times the length of the circle bounds the area's error.
    """
    length = 2 * np.pi * radius
    error = length * (h**2 / (4 * radius) + h**2 / (8 * radius)) * closed
    total = closed * np.pi * radius**2 / h**2
    return {"closed": closed, "open": 0, "area": total, "tolerance": error / h**2}


def _annular() -> dict[str, Any]:
    """What is known of the annulus."""
    outer, inner = _round(3.2, 0.3, closed=1), _round(1.4, 0.3, closed=1)
    return {
        "closed": 2,
        "open": 0,
        "area": outer["area"] - inner["area"],
        "tolerance": outer["tolerance"] + inner["tolerance"],
    }


def _disc() -> Field:
    """The distance to a circle."""
    x, y, h = _plane()
    return Field.of(2.5 - np.hypot(x - 0.031, y + 0.017), h)


def _annulus() -> Field:
    """The distance to two circles, the inside between them."""
    x, y, h = _plane()
    return Field.of(0.9 - np.abs(np.hypot(x - 0.031, y + 0.017) - 2.3), h)


def _two_discs() -> Field:
    """The distance to the nearer of two circles."""
    x, y, h = _plane()
    nearer = np.minimum(np.hypot(x - 0.7, y - 2.11), np.hypot(x + 0.6, y + 1.97))
    return Field.of(1.5 - nearer, h)


def _border() -> Field:
    """A band that leaves the lattice on two sides, in oblong squares."""
    x, y, _ = _plane()
    return Field.of(1.03 - np.abs(x + 0.2 * np.sin(y)), (0.5, 2.0))


def _waves(seed: int) -> Field:
    """Twelve plane waves of one length."""
    chance = np.random.default_rng(seed)
    x, y, h = _plane()
    angles, phases = chance.uniform(0, 2 * np.pi, (2, 12))
    sums = [np.cos(3 * (x * np.cos(a) + y * np.sin(a)) + p) for a, p in zip(angles, phases)]  # noqa: B905
    return Field.of(np.sum(sums, axis=0), h)


def _noise(seed: int) -> Field:
    """Independent normal numbers: every square, and every saddle."""
    return Field.of(np.random.default_rng(seed + 1).normal(size=(16, 19)), (1.0, 0.25))


def _narrow(seed: int) -> Field:
    """Noise two samples wide: squares with borders on both sides."""
    return Field.of(np.random.default_rng(seed + 2).normal(size=(2, 24)))


def _bytes(seed: int) -> Field:
    """Noise in bytes, with an isovalue between them."""
    return Field.of(np.random.default_rng(seed + 3).integers(0, 200, (14, 12)).astype(np.uint8))


def _integers() -> Field:
    """A disc in small integers: samples on the isovalue."""
    x, y = np.indices((9, 9)) - 4
    return Field.of(18 - x**2 - y**2)


def _constant() -> Field:
    """One value everywhere."""
    return Field.of(np.ones((5, 6)))


def _square(signs: int) -> Field:
    """One square with these corners inside: bit c for the corner (c & 1, c >> 1)."""
    size = np.random.default_rng(signs).uniform(0.1, 1, 4)
    corners = np.where([signs >> c & 1 for c in range(4)], size, -size)
    return Field.of(corners.reshape(2, 2).T)


def _saddle(mean: bool, saddle: bool) -> Field:
    """An ambiguous square whose mean and whose saddle are inside or outside as told."""
    # Opposite corners a, d inside, b, c outside: a + d > b + c joins by mean, ad > bc by saddle.
    a, d, b, c = {
        (True, True): (0.9, 0.7, 0.4, 0.3),
        (False, False): (0.4, 0.3, 0.9, 0.7),
        (True, False): (1.3, 0.1, 0.6, 0.5),
        (False, True): (0.6, 0.5, 1.3, 0.1),
    }[mean, saddle]
    return Field.of([[a, -b], [-c, d]])


# --- claims --------------------------------------------------------------------------------------


def _judged(name: str, judge: Callable[[Contours, Trial], Finding]) -> Callable[[Trial], Finding]:
    """`judge`, for well-formed contours that came back, in index coordinates."""

    def decide(trial: Trial) -> Finding:
        contours = indexed(trial, "plain")
        if contours is None:
            verdict = VERDICT_OF.get(trial.plain.status, Verdict.FAIL)
            return Finding(verdict, complaint(trial.plain, 2))
        if name != "well-formed" and well_formed(contours).verdict is Verdict.FAIL:
            return Finding(Verdict.NOT_RUN, "the contours are not well formed")
        return judge(contours, trial)

    return decide


def indexed(trial: Trial, variant: str) -> Contours | None:
    """The contours of a variant in index coordinates of the plain or transposed field."""
    contours = polylines(trial.outcomes[variant])
    if contours is None:
        return None
    turn = -1 if variant == "transposed" else 1
    spacing, origin = (np.array(x)[::turn] for x in (trial.field.spacing, trial.field.origin))
    return [planar.snapped((c - origin) / spacing) for c in contours]


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
        _judged(name, judge),
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
        lambda contours, _: well_formed(contours),
        ALL,
        "the signature of extract_contours",
    ),
    _claim(
        "nothing",
        "a field that is nowhere, or everywhere, inside has no contour",
        0,
        lambda contours, _: nothing(contours),
        {"empty"},
        "a contour separates inside from outside",
    ),
    _claim(
        "whole",
        "every contour is closed or ends on the border of the lattice",
        1,
        lambda contours, trial: whole(contours, trial.field.shape),
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


# --- grading -------------------------------------------------------------------------------------


def pose(variant: str, case: Case, field: Field) -> Field:
    """The field of a variant: ``plain`` or ``transposed``."""
    if variant == "transposed":
        values = np.ascontiguousarray(field.values.T)
        return Field.of(values, field.spacing[::-1], field.origin[::-1])
    return field


# Ready-made implementations, by short name.
READY_MADE: Mapping[str, str] = {
    f"contours:{name.replace('_', '-')}": f"python:isograde.doors.contour_methods:{name}"
    for name in ("diconex_disconnect", "diconex_connect", "diconex_mixed", "skimage", "contourpy")
}
