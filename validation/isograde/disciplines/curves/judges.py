"""What is right for curves in which surfaces meet; pure functions of them and of what is known."""

from __future__ import annotations

import numpy as np

from isograde.claims.evidence import failed, passed
from isograde.disciplines.polylines import is_closed
from isograde.model import Finding
from isograde.oracles import space_curves
from isograde.oracles.space_curves import KnownCurves, Points

Curves = list[Points]

# An answer in single precision is within this share of the extent of the lattice.
ROUNDING = 1e-6
# The error of linear interpolation falls as h^2; two sizes do not show the order exactly.
LEAST_ORDER = 1.4


def linking(curves: Curves, known: KnownCurves) -> Finding:
    """Closed curves are linked and knotted as the known ones."""
    closed = [curve for curve in curves if is_closed(curve)]
    links = space_curves.linking_numbers(closed)
    knots = sorted(space_curves.knot_determinant(curve) for curve in closed)
    found = {"links": links, "determinants": knots}
    expected = {"links": list(known.links), "determinants": list(known.determinants)}
    if found != expected:
        return failed(f"{found}, where it is {expected}", found=found, expected=expected)
    return passed(**found)


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
        return failed(f"values are {worst} times the bound M h^2 / 2", **worst)
    return passed(**worst)


def covers(curves: Curves, known: KnownCurves, h: float) -> Finding:
    """Every point of the known curves is within a cell's diagonal of a found curve, and back."""
    missing, astray = _gaps(curves, known)
    if not known.transversal:
        # Where surfaces touch, an error of h^2 in the values moves a curve by about h.
        h = 3 * h
    if max(missing, astray) > np.sqrt(3) * h:
        return failed(
            f"known curves are up to {missing:.3g} from the found ones, and those {astray:.3g} "
            f"from the known ones; a cell's diagonal is {np.sqrt(3) * h:.3g}",
            missing=missing,
            astray=astray,
        )
    return passed(missing=missing, astray=astray)


def converges(coarse: Curves, finer: Curves, known: KnownCurves) -> Finding:
    """The greatest distance to the known curves falls with the square of the cell's size."""
    errors = [max(_gaps(curves, known)) for curves in (coarse, finer)]
    if not all(np.isfinite(errors)):
        return failed("no curves to measure", curves=[len(coarse), len(finer)])
    order = float(np.log2(errors[0] / max(errors[1], 1e-12)))
    if order < LEAST_ORDER:
        return failed(f"of order {order:.2f}: errors {errors}", order=order, errors=errors)
    return passed(order=order, errors=errors)


def same_swapped(curves: Curves, swapped: Curves, h: float) -> Finding:
    """The fields in the other order give the same points, and curves alike in number and length."""
    if len(curves) != len(swapped):
        return failed(f"{len(curves)} curves, {len(swapped)} with the fields in the other order")
    lengths = [
        sorted((is_closed(c), space_curves.length(c)) for c in some) for some in (curves, swapped)
    ]
    worst = max((abs(a[1] - b[1]) for a, b in zip(*lengths, strict=True)), default=0.0)
    if worst > 1e-4 * h or [a[0] for a in lengths[0]] != [b[0] for b in lengths[1]]:
        return failed(f"lengths differ by up to {worst:.3g}", worst=worst)
    return passed(worst=worst)


def _gaps(curves: Curves, known: KnownCurves) -> tuple[float, float]:
    """Greatest distance of known points to found curves, and of found points to known curves."""
    if not curves:
        return np.inf, 0.0
    dense = np.concatenate([curve[::4] for curve in known.curves])
    missing = float(space_curves.distances(dense, curves).max())
    return missing, float(space_curves.distances(np.concatenate(curves), known.curves).max())
