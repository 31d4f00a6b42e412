"""Claims on curves, k = 1: their number, their links, and the surfaces that they lie on.

The segments of the mesh are joined into curves (`isograde.oracles.chains`); what is known of the
case are its "closed" and "open" curves and, where two surfaces meet, the curves themselves
(`isograde.oracles.space_curves`). Labels and lattices that are not the field's may be too coarse
for these cases: nothing is said of them here, and bodies are known that judge them.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from isoref.field import Floats

from isograde.claims.evidence import complex_of, failed, on_mesh, passed, remembered, skipped
from isograde.declaration import Declaration
from isograde.model import CURVES, Claim, Finding, Kind, Trial
from isograde.oracles import space_curves
from isograde.oracles.chains import curves_of
from isograde.oracles.space_curves import KnownCurves

# An answer in single precision is within this share of the extent of the lattice.
ROUNDING = 1e-6
# Where surfaces touch, an error of h^2 in the values moves a curve by about h: so many cells.
TOUCHING = 3


def resolves(declared: Declaration) -> bool:
    """It sees values, at the samples of the field."""
    return declared.interpolant != "labels" and declared.vertices != "own"


def on_edges(declared: Declaration) -> bool:
    """Its vertices are crossings."""
    return declared.interpolant != "labels" and declared.vertices == "edges"


def leaves_ends_open(declared: Declaration) -> bool:
    """A curve that leaves the lattice stays open."""
    return resolves(declared) and all(end.end == "open" for end in declared.domain)


def curves(trial: Trial) -> list[Floats]:
    """The curves of the plain outcome, in the field's coordinates; closed ones repeat a point."""

    def compute() -> list[Floats]:
        found = complex_of(trial)
        places = trial.field.position(found.points)
        return [places[curve] for curve in curves_of(found.simplices)]

    return remembered(trial, "curves", compute)


def known(trial: Trial) -> KnownCurves:
    """The curves of the case."""
    shape: KnownCurves = trial.case.facts["curves"]
    return shape


def spacing(trial: Trial) -> float:
    """The longest edge of a cell."""
    return max(trial.field.spacing)


def count(trial: Trial) -> Finding:
    """Pass when there are as many closed and open curves as are known."""
    closed = sum(map(space_curves.is_closed, curves(trial)))
    found = {"closed": closed, "open": len(curves(trial)) - closed}
    expected = {word: trial.case.facts[word] for word in found}
    if found != expected:
        return failed(
            f"{closed} closed and {found['open']} open curves, where there are "
            f"{expected['closed']} and {expected['open']}",
            found=found,
            expected=expected,
        )
    return passed(**found)


def linking(trial: Trial) -> Finding:
    """Pass when closed curves are linked and knotted as the known ones are."""
    closed = [curve for curve in curves(trial) if space_curves.is_closed(curve)]
    shape = known(trial)
    expected = {"links": list(shape.links), "determinants": list(shape.determinants)}
    links = space_curves.linking_numbers(closed)
    found = {"links": links, "determinants": sorted(map(space_curves.knot_determinant, closed))}
    if found != expected:
        return failed(
            f"linking numbers {links} and determinants {found['determinants']} of knots, where "
            f"they are {expected['links']} and {expected['determinants']}",
            found=found,
            expected=expected,
        )
    return passed(**found)


def on_surfaces(trial: Trial) -> Finding:
    """Pass when at every vertex both functions are at most M h^2 / 2 from their isovalues.

    Linear interpolation along an edge errs by M h^2 / 8 at most; a plane through three such points
    in a cell whose diagonal is sqrt(3) h adds 3 M h^2 / 8 at most.
    """
    points = np.concatenate([*curves(trial), np.empty((0, 3))])
    if not len(points):
        return failed("there is no curve where surfaces meet")
    shape, h = known(trial), spacing(trial)
    shares = []
    for function, bend in zip((shape.first, shape.second), shape.bend(h), strict=True):
        value = float(np.abs(function(*points.T)).max())
        shares.append(value / (bend * h**2 / 2 + ROUNDING))
    numbers = {"first": shares[0], "second": shares[1]}
    if max(shares) > 1:
        return failed(
            f"the functions reach {shares[0]:.3g} and {shares[1]:.3g} of the bound M h^2 / 2",
            **numbers,
        )
    return passed(**numbers)


def covers(trial: Trial) -> Finding:
    """Pass when found and known curves are within a cell's diagonal of each other."""
    shape, found = known(trial), curves(trial)
    if not found:
        return failed("there is no curve where surfaces meet")
    cells = 1 if shape.transversal else TOUCHING
    bound = cells * float(np.linalg.norm(trial.field.spacing))
    missing = float(space_curves.distances(np.concatenate(shape.curves), found).max())
    astray = float(space_curves.distances(np.concatenate(found), shape.curves).max())
    if max(missing, astray) > bound:
        return failed(
            f"known curves are up to {missing:.3g} from the found ones, and those up to "
            f"{astray:.3g} from the known ones; allowed is {bound:.3g}",
            missing=missing,
            astray=astray,
            bound=bound,
        )
    return passed(missing=missing, astray=astray, bound=bound)


def confidence(trial: Trial) -> Finding:
    """Pass when each vector is n1 x n2, or each is n2 x n1, up to what differences in a cell err.

    n1 and n2 are the unit gradients. Each component of a gradient is taken by a difference along an
    edge of the cell, so it is the derivative somewhere in the cell, within its diagonal D: the
    gradient errs by M D at most, its direction by M D over its length, and the cross product by the
    sum of both.
    """
    vectors, mesh = trial.plain.normals, trial.mesh
    if vectors is None or vectors.shape != mesh.vertices.shape:
        return skipped("no directions came with the vertices")
    used = np.unique(mesh.simplices)
    if not len(used):
        return failed("there is no curve where surfaces meet")
    shape, diagonal = known(trial), float(np.linalg.norm(trial.field.spacing))
    right, sizes = shape.directions(mesh.vertices[used])
    bends = np.array(shape.bend(diagonal))
    bound = (bends[:, None] * diagonal / np.maximum(sizes, space_curves.TINY)).sum(axis=0)
    side = 1.0 if np.median((vectors[used] * right).sum(axis=1)) >= 0 else -1.0
    error = np.linalg.norm(side * vectors[used] - right, axis=1)
    # Where the bound is as long as any such vector may be, nothing can be said.
    told = bound < 1
    if not told.any():
        return skipped("the lattice is too coarse to say where the curves go")
    bad = np.flatnonzero(told & ~(error <= bound))
    numbers = {"vertices": int(told.sum()), "largest_share": float((error / bound)[told].max())}
    if not len(bad):
        return passed(**numbers)
    worst = bad[(error / bound)[bad].argmax()]
    return failed(
        f"{len(bad)} of {int(told.sum())} vectors are not the cross product of the unit gradients: "
        f"one of length {np.linalg.norm(vectors[used[worst]]):.3g}, where it is "
        f"{np.linalg.norm(right[worst]):.3g}, is off by {error[worst]:.3g}; allowed is "
        f"{bound[worst]:.3g}",
        **numbers,
    )


def identical(trial: Trial) -> Finding:
    """Pass when there is no segment where both surfaces are the same."""
    segments = len(trial.mesh.simplices)
    return failed(f"{segments} segments", segments=segments) if segments else passed()


def _claim(
    name: str,
    rule: str,
    source: str,
    level: int | None,
    judge: Callable[[Trial], Finding],
    tags: set[str],
    fact: str,
    families: Callable[[Declaration], bool] = resolves,
    kinds: Callable[[Kind], bool] = lambda kind: kind == CURVES,
    promised: bool = True,
) -> Claim:
    """A claim of this family, on cases of which this fact is known, if any need be."""

    def of_trial(trial: Trial) -> Finding:
        if fact and fact not in trial.case.facts:
            return skipped("of a part of a case nothing is known")
        return judge(trial)

    of_trial.__doc__ = judge.__doc__
    return Claim(
        f"curves.{name}", rule, source, level, on_mesh(of_trial),
        kinds=kinds, families=families, tags=frozenset(tags), promised=promised,
    )  # fmt: skip


FORMULA = "the formula of the fields"
CLAIMS = (
    _claim(
        "count",
        "Of known curves there are as many closed ones and as many open ones as there should be.",
        FORMULA,
        2,
        count,
        {"known"},
        "closed",
        leaves_ends_open,
        lambda kind: kind.k == 1,
    ),
    _claim(
        "linking",
        "Closed curves are linked and knotted as the known ones are.",
        "Banchoff 1976: linking by Gauss's integral; Fox 1970: knot determinants by colourings",
        2,
        linking,
        {"known"},
        "curves",
        leaves_ends_open,
    ),
    _claim(
        "on_surfaces",
        "At every vertex of a known curve both functions are within M h^2 / 2 of their isovalues.",
        "the error of linear interpolation",
        None,
        on_surfaces,
        {"known"},
        "curves",
        on_edges,
    ),
    _claim(
        "covers",
        "Found and known curves are within a cell's diagonal of each other, "
        f"{TOUCHING} where surfaces touch.",
        FORMULA,
        None,
        covers,
        {"known", "touching"},
        "curves",
    ),
    _claim(
        "confidence",
        "Where a vector comes with each vertex of a known curve, it is along the curve, and as "
        "long as the confidence in it, the sine of the angle between the gradients, up to the "
        "error of differences in the vertex's own cell. In full runs alone.",
        "Ljung & Ynnerman, section 6: the cross product of the normalized gradients, whose "
        "magnitude places a confidence on the tangent",
        None,
        confidence,
        {"directed"},
        "curves",
        on_edges,
        promised=False,
    ),
    _claim(
        "identical",
        "Where both surfaces are the same there is no curve.",
        "Ljung & Ynnerman, appendix A: two identical surfaces lead to N intersection tests",
        None,
        identical,
        {"identical"},
        "",
        promised=False,
    ),
)
