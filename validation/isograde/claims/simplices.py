"""Claims on simplices of any dimension: Euler numbers, flat sets, and faces cut in two ways.

A facet off the border with a simplex on one side only may be the rim of a hole, or one of two cuts
of a face that two simplices share. The second kind leaves no gap in space, but no complex either:
`topology.closed` fails on both, and `simplices.conforming` says which.

References
----------
[1] C. Min, Simplicial isosurfacing in arbitrary dimension and codimension, 2003.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from isograde.claims.curves import leaves_ends_open, on_edges
from isograde.claims.evidence import (
    complex_of,
    failed,
    is_cut_off,
    judged_complex,
    lattice_of,
    off_border,
    on_mesh,
    passed,
    place,
    skipped,
)
from isograde.declaration import Declaration
from isograde.model import Claim, Finding, Kind, Trial, every_family, every_kind
from isograde.oracles.covering import covered
from isograde.oracles.known_manifolds import Manifold

# An answer in single precision is within this share of the extent of the lattice.
ROUNDING = 1e-6


def nothing(trial: Trial) -> Finding:
    """Pass when there is no simplex."""
    count = len(trial.mesh.simplices)
    return failed(f"{count} simplices, where there are no zeros") if count else passed()


def conforming(trial: Trial) -> Finding:
    """Pass when no open facet off the border lies on another one."""
    found = judged_complex(trial)
    if found.k < 2 or not len(found.facets.rows):
        return skipped("ends of segments are not cut")
    rows = off_border(trial, found.open_facets, found.points)
    doubled = rows[covered(found.points, rows)]
    if not len(doubled):
        return passed(facets=len(found.facets.rows))
    first = place(found.points[doubled[0]].mean(axis=0))
    return failed(
        f"{len(doubled)} facets lie on facets of another cut of their face, the first about index "
        f"{first}",
        facets=len(doubled),
        first=first,
    )


def euler(trial: Trial) -> Finding:
    """Pass when the Euler characteristic and the number of pieces are those of the manifold."""
    mesh, known = complex_of(trial), trial.case.facts["manifold"]
    found, right = (mesh.euler, mesh.components), (known.euler, known.pieces)
    if found != right:
        return failed(
            f"Euler characteristic {found[0]} in {found[1]} pieces, where {known.name} has "
            f"{right[0]} in {right[1]}",
            euler=found[0],
            pieces=found[1],
            expected=list(right),
        )
    return passed(euler=found[0], pieces=found[1])


def flat(trial: Trial) -> Finding:
    """Pass when every vertex solves the affine equations."""
    mesh, known = complex_of(trial), trial.case.facts["manifold"]
    if not mesh.used.any():
        return failed("there is no simplex where there are zeros")
    # Call a value an error in cells: over the slope, which is the same everywhere.
    points = trial.field.position(mesh.points[mesh.used])
    values = abs(known.phi(points))
    step = max(trial.field.spacing) * abs(known.gradients(points[:1])[0]).sum(axis=1)
    worst = float((values / step).max())
    allowed = ROUNDING * max(lattice_of(trial).shape) + (trial.declaration.soup or 0.0)
    if worst > allowed:
        return failed(f"a vertex is {worst:.3g} of a cell off its flat set", worst=worst)
    return passed(worst=worst)


def has_faces(kind: Kind) -> bool:
    """Simplices have facets with an inside."""
    return kind.k >= 2


def takes_reals(declared: Declaration) -> bool:
    """Of a manifold that is known, samples in whole numbers are another one."""
    types = declared.limits.types
    return not types or any(np.dtype(one).kind == "f" for one in types)


def uncapped(declared: Declaration) -> bool:
    """Nothing closes a mesh at the border."""
    return all(end.end != "closed" for end in declared.domain)


def shows_topology(declared: Declaration) -> bool:
    """It takes real numbers, sees values, and leaves what goes on beyond the lattice open."""
    return leaves_ends_open(declared) and takes_reals(declared)


def solves(declared: Declaration) -> bool:
    """Its vertices are crossings, and what goes on beyond the lattice stays open."""
    return on_edges(declared) and leaves_ends_open(declared)


def has_length(kind: Kind) -> bool:
    """Points have neither pieces that hang together nor an Euler characteristic to compare."""
    return kind.k >= 1


def _claim(
    name: str,
    rule: str,
    source: str,
    level: int | None,
    judge: Callable[[Trial], Finding],
    tags: set[str],
    families: Callable[[Declaration], bool],
    kinds: Callable[[Kind], bool] = every_kind,
    promised: bool = True,
) -> Claim:
    """A claim of this family; what asks for a manifold is judged where one is known."""

    def of_trial(trial: Trial) -> Finding:
        if tags & {"curved", "flat"} and not isinstance(trial.case.facts.get("manifold"), Manifold):
            return skipped("of a part of a case nothing is known")
        if "curved" in tags and is_cut_off(trial):
            return skipped("the known manifold goes on beyond the domain")
        return judge(trial)

    of_trial.__doc__ = judge.__doc__
    return Claim(
        f"simplices.{name}", rule, source, level, on_mesh(of_trial),
        kinds=kinds, families=families, tags=frozenset(tags), promised=promised,
    )  # fmt: skip


CLAIMS = (
    _claim(
        "nothing",
        "Where components have no common zero, or a component has no zero, there is no simplex.",
        "Min 2003, section 2.2, definition of the isosurface",
        0,
        nothing,
        {"empty"},
        uncapped,
    ),
    _claim(
        "conforming",
        "Simplices meet in common faces: no face is cut in two ways.",
        "Min 2003, section 2, definition of a triangulation",
        None,
        conforming,
        {"simplices"},
        every_family,
        has_faces,
        promised=False,
    ),
    _claim(
        "euler",
        "Euler characteristic and number of pieces are those of the known manifold.",
        "the manifold's description",
        2,
        euler,
        {"curved", "flat"},
        shows_topology,
        has_length,
    ),
    _claim(
        "flat",
        "Where the components are affine, every vertex solves them.",
        "Min 2003, section 2.2: linear on each simplex",
        None,
        flat,
        {"flat"},
        solves,
    ),
)
