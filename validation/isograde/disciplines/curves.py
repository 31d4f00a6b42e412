"""The discipline ``curves``: where the isosurfaces of two fields on one lattice meet.

An implementation is a function::

    extract_curves(values_a, values_b, isovalue_a, isovalue_b, spacing) -> list of (N, 3) arrays

values      two arrays of one shape (N1, N2, N3)
spacing     three floats; a point is ``index * spacing``, in the order of the arrays' axes
answer      one array a curve, its points in order; a closed curve repeats its first point

It goes through the doors like any other: declare ``{"discipline": "curves"}`` and name it
``python:my.module:extract_curves``. Inside, `through_door` makes of it a function of one array (the
fields stacked) that answers with arrays of points and curve numbers. Programs behind ``exec:`` and
folders behind ``dir:`` get and give these arrays as they stand: `LAYOUT` says how.

Glossary
--------
h           the longest edge of a cell
M           the largest second derivatives of a function near a known curve
whole       closed, or with both ends on the border of the lattice

Judges are pure functions of a list of arrays and of what is known; each claim names its judge. A
case whose surfaces touch is judged by what holds however the curves are joined there; where they
are the same, any list of curves is an answer, and only a crash or a malformed list is a fault.

References
----------
[1] P. Ljung, A. Ynnerman, Extraction of intersection curves from iso-surfaces on co-located 3D
    grids.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from typing import Any

import numpy as np
from isoref.field import Field
from numpy.typing import NDArray

from isograde.disciplines.polylines import complaint, declare, stacked, unstacked
from isograde.model import (
    Case,
    Claim,
    Finding,
    Outcome,
    Status,
    Trial,
    Verdict,
)
from isograde.truths import space_curves
from isograde.truths.space_curves import KnownCurves, Points

Curves = list[Points]
Extract = Callable[[Any, Any, float, float, tuple[float, ...]], Sequence[Any]]

# Samples along each axis of a known case; "finer" has cells of half the size.
COARSE = (24, 27, 25)
# An answer in single precision is within this share of the extent of the lattice.
ROUNDING = 1e-6
# The error of linear interpolation falls as h^2; two sizes do not show the order exactly.
LEAST_ORDER = 1.4


# --- through the doors ---------------------------------------------------------------------------

# What a manifest says of requests and answers.
LAYOUT: Mapping[str, str] = {
    "values": "npy in C order, (2, N1, N2, N3): the first field, then the second; where the "
    "second isovalue differs from the first, (3, N1, N2, N3): the third holds nothing but it",
    "vertices": "origin + index * spacing (V, 3): all points, one curve after the other; a closed "
    "curve repeats its first point",
    "faces": "for each point the number of its curve, (V,) or (V, 1)",
    "answer": "beside the values, same name: .vertices.npy and .faces.npy",
    "no curve": "arrays without points; a missing file counts as unsupported",
}


def through_door(function: Extract) -> Callable[[Any, float, tuple[float, ...]], Any]:
    """`function` as the doors call it: stacked values (2, N1, N2, N3), one isovalue, spacing.

    Where the second isovalue differs, a third array (N1, N2, N3) holds nothing but it.
    It answers with the points of all curves (V, 3) and, for each, the number of its curve (V, 1).
    """

    def extract(
        values: NDArray[Any], isovalue: float, spacing: tuple[float, ...]
    ) -> tuple[NDArray[Any], NDArray[Any]]:
        second = float(values[2].flat[0]) if len(values) == 3 else isovalue
        answer = function(values[0], values[1], isovalue, second, tuple(spacing))
        return stacked(answer, 3, "curve")

    return declare(extract, function, "curves")


def polylines(outcome: Outcome) -> Curves | None:
    """The curves of an outcome, or None where it holds none that can be judged."""
    return unstacked(outcome, 3)


# --- judges --------------------------------------------------------------------------------------


def well_formed(curves: Curves) -> Finding:
    """Every curve has at least two points, all of them finite."""
    for number, curve in enumerate(curves):
        if len(curve) < 2:
            return _fail(f"curve {number} has {len(curve)} point", curve=number)
        if not np.isfinite(curve).all():
            return _fail(f"curve {number} has a coordinate that is not finite", curve=number)
    return _pass(curves=len(curves))


def whole(curves: Curves, low: Points, high: Points) -> Finding:
    """Every curve is closed or ends on the border of the box from `low` to `high`."""
    near = ROUNDING * float((high - low).max())
    for number, curve in enumerate(curves):
        if space_curves.is_closed(curve):
            continue
        for end in curve[[0, -1]]:
            if min(np.abs(end - low).min(), np.abs(end - high).min()) > near:
                place = np.round(end, 6).tolist()
                return _fail(f"curve {number} ends inside, at {place}", curve=number, at=place)
    return _pass(closed=sum(space_curves.is_closed(curve) for curve in curves))


def no_point_twice(curves: Curves) -> Finding:
    """No two points are equal, but for the last point of a closed curve."""
    points = [curve[:-1] if space_curves.is_closed(curve) else curve for curve in curves]
    if not points:
        return _pass(points=0)
    places, count = np.unique(np.concatenate(points) + 0.0, axis=0, return_counts=True)
    if (count > 1).any():
        place = places[count.argmax()].tolist()
        repeated = int((count > 1).sum())
        return _fail(f"{repeated} points come twice, such as {place}", points=repeated, at=place)
    return _pass(points=len(places))


def count(curves: Curves, known: KnownCurves) -> Finding:
    """As many closed and as many open curves as are known."""
    closed = sum(space_curves.is_closed(curve) for curve in curves)
    found = {"closed": closed, "open": len(curves) - closed}
    expected = {"closed": known.closed, "open": len(known.curves) - known.closed}
    if found != expected:
        return _fail(f"{found} curves, where there are {expected}", found=found, expected=expected)
    return _pass(**found)


def linking(curves: Curves, known: KnownCurves) -> Finding:
    """Closed curves are linked and knotted as the known ones."""
    closed = [curve for curve in curves if space_curves.is_closed(curve)]
    links = space_curves.linking_numbers(closed)
    knots = sorted(space_curves.knot_determinant(curve) for curve in closed)
    found = {"links": links, "determinants": knots}
    expected = {"links": list(known.links), "determinants": list(known.determinants)}
    if found != expected:
        return _fail(f"{found}, where it is {expected}", found=found, expected=expected)
    return _pass(**found)


def on_surfaces(curves: Curves, known: KnownCurves, h: float) -> Finding:
    """At every point both functions are at most ``M h^2 / 2`` from zero.

    Linear interpolation along an edge errs by at most ``M h^2 / 8``; a plane through three such
    points in a cell whose diagonal is ``sqrt(3) h`` adds at most ``3 M h^2 / 8``.
    """
    points = np.concatenate([*curves, np.empty((0, 3))])
    worst = {}
    for name, function, bend in zip(
        ("first", "second"), (known.first, known.second), known.bend(h), strict=True
    ):
        bound = bend * h**2 / 2 + ROUNDING
        value = float(np.abs(function(*points.T)).max(initial=0.0))
        worst[name] = value / bound
    if max(worst.values()) > 1:
        return _fail(f"values are {worst} times the bound M h^2 / 2", **worst)
    return _pass(**worst)


def covers(curves: Curves, known: KnownCurves, h: float) -> Finding:
    """Every point of the known curves is within a cell's diagonal of a found curve, and back."""
    missing, astray = _gaps(curves, known)
    if not known.transversal:
        # Where surfaces touch, an error of h^2 in the values moves a curve by about h.
        h = 3 * h
    if max(missing, astray) > np.sqrt(3) * h:
        return _fail(
            f"known curves are up to {missing:.3g} from the found ones, and those {astray:.3g} "
            f"from the known ones; a cell's diagonal is {np.sqrt(3) * h:.3g}",
            missing=missing,
            astray=astray,
        )
    return _pass(missing=missing, astray=astray)


def converges(coarse: Curves, finer: Curves, known: KnownCurves) -> Finding:
    """The greatest distance to the known curves falls with the square of the cell's size."""
    errors = [max(_gaps(curves, known)) for curves in (coarse, finer)]
    if not all(np.isfinite(errors)):
        return _fail("no curves to measure", curves=[len(coarse), len(finer)])
    order = float(np.log2(errors[0] / max(errors[1], 1e-12)))
    if order < LEAST_ORDER:
        return _fail(f"of order {order:.2f}: errors {errors}", order=order, errors=errors)
    return _pass(order=order, errors=errors)


def same_swapped(curves: Curves, swapped: Curves, h: float) -> Finding:
    """The fields in the other order give the same points, and curves alike in number and length."""
    if len(curves) != len(swapped):
        return _fail(f"{len(curves)} curves, {len(swapped)} with the fields in the other order")
    lengths = [
        sorted((space_curves.is_closed(c), space_curves.length(c)) for c in some)
        for some in (curves, swapped)
    ]
    worst = max((abs(a[1] - b[1]) for a, b in zip(*lengths, strict=True)), default=0.0)
    if worst > 1e-4 * h or [a[0] for a in lengths[0]] != [b[0] for b in lengths[1]]:
        return _fail(f"lengths differ by up to {worst:.3g}", worst=worst)
    return _pass(worst=worst)


def nothing(curves: Curves) -> Finding:
    """There is no curve."""
    return _fail(f"{len(curves)} curves where there is none") if curves else _pass()


def _gaps(curves: Curves, known: KnownCurves) -> tuple[float, float]:
    """Greatest distance of known points to found curves, and of found points to known curves."""
    if not curves:
        return np.inf, 0.0
    dense = np.concatenate([curve[::4] for curve in known.curves])
    missing = float(space_curves.distances(dense, curves).max())
    return missing, float(space_curves.distances(np.concatenate(curves), known.curves).max())


def _pass(**numbers: Any) -> Finding:
    """The claim holds."""
    return Finding(Verdict.PASS, "", numbers)


def _fail(detail: str, **numbers: Any) -> Finding:
    """The claim does not hold, and why."""
    return Finding(Verdict.FAIL, detail, numbers)


# --- cases ---------------------------------------------------------------------------------------


def cases(seed: int = 0) -> list[Case]:
    """Every case of the discipline, deterministic for a seed."""
    listed = [_known_case(known) for known in known_curves().values()]
    for name, build, tags in (
        ("curves/waves", partial(_waves, seed), {"generic"}),
        ("curves/noise", partial(_noise, seed), {"generic", "noise"}),
        ("curves/apart", _apart, {"generic", "empty"}),
        ("curves/identical", _identical, {"degenerate"}),
        ("curves/tangent", _tangent, {"ties"}),
        ("curves/integers", _integers, {"ties"}),
    ):
        size = build().values[0].size
        listed.append(Case(name, build, 0.0, size, frozenset({"curves", *tags})))
    return listed


@cache
def known_curves() -> Mapping[str, KnownCurves]:
    """The known curves by the id of their case."""
    return {f"curves/{known.name}": known for known in (make() for make in space_curves.KNOWN)}


def _known_case(known: KnownCurves) -> Case:
    """The case that samples two functions whose common zeros are known."""
    tags = {"curves", "known", "generic"} if known.transversal else {"curves", "touching"}
    if known.levels != (0, 0):
        tags = {"curves", "known", "levels"}
    return Case(
        f"curves/{known.name}",
        lambda: _sampled(known, COARSE),
        known.levels[0],
        int(np.prod(COARSE)),
        frozenset(tags),
        {"length": known.length, "closed": known.closed},
    )


def _sampled(known: KnownCurves, shape: tuple[int, int, int]) -> Field:
    """Both functions on the lattice, as one field; a third component is the second isovalue."""
    first, second, spacing = known.sample(shape)
    one, two = known.levels
    last = [] if one == two else [np.full(shape, two)]
    values = np.stack([first, second, *last])
    return Field.of(values, spacing.tolist(), (-known.half,) * 3, dimension=3)


def _pair(
    first: NDArray[Any], second: NDArray[Any], spacing: float | tuple[float, ...] = 1.0
) -> Field:
    """Two arrays as one field of two components."""
    return Field.of(np.stack([first, second]), spacing, dimension=3)


def _waves(seed: int) -> Field:
    """Real and imaginary part of 60 plane waves of wave number 6 in a cube of side 3."""
    chance = np.random.default_rng(seed)
    axis = np.linspace(0, 3, 22)
    grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1)
    psi = np.zeros(grid.shape[:3], np.complex128)
    for _ in range(60):
        k = chance.normal(size=3)
        psi += np.exp(1j * (grid @ (6 * k / np.linalg.norm(k)) + chance.uniform(0, 2 * np.pi)))
    return _pair(psi.real, psi.imag, 3 / 21)


def _noise(seed: int) -> Field:
    """Independent normal numbers: every configuration, many ambiguous faces."""
    a, b = np.random.default_rng(seed + 1).normal(size=(2, 9, 8, 10))
    return _pair(a, b, (1.0, 0.5, 2.0))


def _grid(n: int) -> list[Points]:
    """Coordinates -1 to 1."""
    return list(np.meshgrid(*[np.linspace(-1, 1, n)] * 3, indexing="ij"))


def _apart() -> Field:
    """A small ball in a large one: the surfaces never meet."""
    x, y, z = _grid(13)
    r2 = x**2 + y**2 + z**2
    return _pair(0.31 - r2, 0.83 - r2, 1 / 6)


def _identical() -> Field:
    """The same ball twice."""
    x, y, z = _grid(11)
    ball = 0.53 - x**2 - 0.9 * y**2 - 1.1 * z**2
    return _pair(ball, ball, 0.2)


def _tangent() -> Field:
    """A ball on a plane."""
    x, y, z = _grid(13)
    return _pair(0.25 - x**2 - y**2 - z**2, z + 0.5, 1 / 6)


def _integers() -> Field:
    """Balls in small integers: samples on the isovalue, ties on edges."""
    x, y, z = np.indices((9, 9, 9)) - 4
    return _pair(9 - x**2 - y**2 - z**2, 9 - (x - 2) ** 2 - y**2 - z**2)


# --- claims --------------------------------------------------------------------------------------


def _h(field: Field) -> float:
    """The longest edge of a cell."""
    return max(field.spacing)


def _judged(judge: Callable[[Curves, Trial], Finding]) -> Callable[[Trial], Finding]:
    """`judge`, for curves that came back; a failure of the call itself is told as such."""

    def decide(trial: Trial) -> Finding:
        curves = polylines(trial.plain)
        if curves is None:
            return Finding(_verdict(trial.plain.status), complaint(trial.plain, 3))
        return judge(curves, trial)

    return decide


def _verdict(status: Status) -> Verdict:
    """What a call that ended so makes of a claim."""
    return {
        Status.RAISED: Verdict.ERROR,
        Status.DECLINED: Verdict.UNSUPPORTED,
        Status.CRASH: Verdict.CRASH,
        Status.TIMEOUT: Verdict.TIMEOUT,
        Status.MEMORY: Verdict.TIMEOUT,
    }.get(status, Verdict.FAIL)


def _corners(trial: Trial) -> tuple[Points, Points]:
    """The lowest and the highest corner of the lattice."""
    field = trial.field
    return field.position(np.zeros(3)), field.position(np.array(field.shape) - 1)


def _known(trial: Trial) -> KnownCurves:
    """What is known of the trial's case."""
    return known_curves()[trial.case.id]


def _variant(trial: Trial, name: str) -> Curves:
    """The curves of a variant; none where the call failed."""
    return polylines(trial.outcomes[name]) or []


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
        _judged(judge),
        tags=frozenset(tags),
        variants=variants,
        needs_mesh=False,
        discipline="curves",
    )


ALL = {"curves"}
CLAIMS: tuple[Claim, ...] = (
    _claim(
        "well-formed",
        "every curve is an array of at least two finite points",
        0,
        lambda curves, _: well_formed(curves),
        ALL,
        "the signature of extract_curves",
    ),
    _claim(
        "nothing",
        "surfaces that do not meet have no curve",
        0,
        lambda curves, _: nothing(curves),
        {"empty"},
        "Ljung & Ynnerman, appendix A",
    ),
    _claim(
        "whole",
        "every curve is closed or ends on the border of the lattice",
        1,
        lambda curves, trial: whole(curves, *_corners(trial)),
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
        lambda curves, trial: count(curves, _known(trial)),
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


# Short names of the implementations in `isograde.doors.curve_methods`.
READY_MADE: Mapping[str, str] = {
    f"curves:{name.replace('_', '-')}": f"python:isograde.doors.curve_methods:{name}"
    for name in ("marching_faces", "surface_intersection", "vtk")
}


# --- grading -------------------------------------------------------------------------------------


def pose(variant: str, case: Case, field: Field) -> Field:
    """The field of a variant of a case: ``plain``, ``swapped`` or ``finer``."""
    if variant == "swapped":
        return Field.of(field.values[::-1].copy(), field.spacing, field.origin, dimension=3)
    if variant == "finer":
        n1, n2, n3 = COARSE
        return _sampled(known_curves()[case.id], (2 * n1 - 1, 2 * n2 - 1, 2 * n3 - 1))
    return field
