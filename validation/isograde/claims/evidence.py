"""What judges share: the oracles' answers about one trial, each computed once, and how to say it.

A mesh is judged as it is given: vertices count as one where they share an index. There are two
exceptions. In a soup, vertices within its declared tolerance count as one. And where a mesh is
open, and a sample is tied, vertices at one tied sample are made one before it is judged again: an
implementation may have one vertex or several there. Nothing is welded anywhere else.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, wraps
from typing import Any, TypeVar

import numpy as np
from isoref.field import Booleans, Floats, Integers
from isoref.mesh import Mesh
from numpy.lib.stride_tricks import sliding_window_view

from isograde.declaration import Declaration
from isograde.model import Finding, Judge, Outcome, Status, Trial, Verdict
from isograde.oracles.bilinear import tied_saddle
from isograde.oracles.complexes import Complex
from isograde.oracles.degree import Meetings, meetings
from isograde.oracles.flat import LIMIT, MOST
from isograde.oracles.lattice import Lattice
from isograde.oracles.rows import components_of, distinct, near_pairs
from isograde.oracles.traces import Traces, traces

T = TypeVar("T")


def given_samples(declared: Declaration) -> bool:
    """Called with samples, and not with a function."""
    return declared.given == "samples"


def passed(**numbers: Any) -> Finding:
    """The claim holds; the numbers say on how much evidence."""
    return Finding(Verdict.PASS, "", numbers)


def failed(detail: str, **numbers: Any) -> Finding:
    """The claim does not hold, and why."""
    return Finding(Verdict.FAIL, detail, numbers)


def skipped(detail: str) -> Finding:
    """The case is no evidence: the claim could not fail on it."""
    return Finding(Verdict.SKIP, detail)


VERDICT_OF = {
    Status.DECLINED: Verdict.UNSUPPORTED,
    Status.RAISED: Verdict.ERROR,
    Status.GARBAGE: Verdict.FAIL,
    Status.CRASH: Verdict.CRASH,
    Status.TIMEOUT: Verdict.TIMEOUT,
    Status.MEMORY: Verdict.TIMEOUT,
}


def remembered(trial: Trial, key: str, compute: Callable[[], T]) -> T:
    """``compute()``, computed once for this trial."""
    if key not in trial.memory:
        trial.memory[key] = compute()
    value: T = trial.memory[key]
    return value


def on_mesh(judge: Judge) -> Judge:
    """The judge, for outcomes that are meshes of the case's kind; anything else is not run."""

    @wraps(judge)
    def guarded(trial: Trial) -> Finding:
        if trial.plain.mesh_of(trial.kind) is None:
            n, k = trial.kind.n, trial.kind.k
            return Finding(Verdict.NOT_RUN, f"there is no mesh of dimension {k} in {n} to judge")
        return judge(trial)

    return guarded


def lattice_of(trial: Trial) -> Lattice:
    """The trial's samples and sides, with the declared side of a tie."""
    return remembered(
        trial, "lattice", lambda: Lattice.of(trial.field, trial.isovalues, trial.declaration)
    )


def is_cut_off(trial: Trial) -> bool:
    """The level set may go on in cells outside a domain that ends inside the lattice.

    In none of those cells do all components have both sides where it does not.
    """
    lattice = lattice_of(trial)
    if (lattice.first <= 0).all() or min(lattice.shape) < 2:
        return False
    cells = sliding_window_view(
        lattice.sides, (2,) * lattice.n, axis=tuple(range(1, lattice.n + 1))
    )
    corners = tuple(range(-lattice.n, 0))
    mixed = (cells.any(axis=corners) & ~cells.all(axis=corners)).all(axis=0)
    low = np.stack(np.nonzero(mixed), axis=1)
    outside = (low < lattice.first - lattice.tolerance) | (
        low + 1 > lattice.last + lattice.tolerance
    )
    return bool(outside.any())


def is_general(trial: Trial) -> bool:
    """The field is in general position: nothing about its level set hangs on rounding."""

    def compute() -> bool:
        lattice = lattice_of(trial)
        if lattice.tied.any():
            return False
        ambiguous = trial.kind.m == 1 and trial.declaration.interpolant == "multilinear"
        return not (ambiguous and tied_saddle(lattice))

    return remembered(trial, "general", compute)


def complex_of(trial: Trial) -> Complex:
    """The plain outcome's mesh, its vertices in index coordinates; a soup's are welded."""
    return remembered(trial, "complex", lambda: placed(trial, trial.mesh))


def placed(trial: Trial, mesh: Mesh) -> Complex:
    """A mesh that answers the trial's field, in index coordinates; a soup's vertices welded.

    Corners of a soup that become one at a tied sample become that sample: on the border they may
    have come from two of its planes, and any one of them would leave the other.
    """
    lattice, soup = lattice_of(trial), trial.declaration.soup
    found = Complex.of(lattice.index(mesh.vertices), mesh.simplices)
    if soup is None:
        return found
    name = clusters(found.points, soup)
    moved = np.unique(name[(found.points != found.points[name]).any(axis=1)])
    moved = moved[lattice.at_tie(found.points[moved])]
    if len(moved):
        points = found.points.copy()
        points[moved] = np.rint(points[moved])
        found = Complex(points, found.simplices)
    return found.renamed(name)


def clusters(points: Floats, tolerance: float) -> Integers:
    """(V,) for each vertex one that stands for all within the tolerance of it, chained."""
    first, name = distinct(points + 0.0)
    if tolerance > 0:
        _, cluster = components_of(len(first), near_pairs(points[first], tolerance))
        example = np.unique(cluster, return_index=True)[1]
        first = first[example[cluster]]
    renamed: Integers = first[name]
    return renamed


def judged_complex(trial: Trial) -> Complex:
    """The mesh as given; where it is open and ties could be why, welded at tied samples."""

    def compute() -> Complex:
        found = complex_of(trial)
        loose = off_border(trial, found.unbalanced_facets)
        return welded_at_ties(trial) if len(loose) and lattice_of(trial).tied.any() else found

    return remembered(trial, "judged complex", compute)


def welded_at_ties(trial: Trial) -> Complex:
    """The mesh, its vertices at one tied sample made one, and no others."""

    def compute() -> Complex:
        found, lattice = complex_of(trial), lattice_of(trial)
        at = np.flatnonzero(lattice.at_tie(found.points))
        sample = np.rint(found.points[at]).astype(np.int64)
        first, group = distinct(sample)
        name = np.arange(len(found.points))
        name[at] = at[first[group]]
        points = found.points.copy()
        points[at] = sample
        return Complex(points, found.simplices).renamed(name)

    return remembered(trial, "welded at ties", compute)


def meetings_of(trial: Trial) -> Meetings:
    """The faces of the lattice that the plain outcome's mesh, or the field, meets."""
    found = complex_of(trial)
    return remembered(
        trial, "meetings", lambda: meetings(lattice_of(trial), found.points, found.simplices)
    )


def traces_of(trial: Trial) -> Traces:
    """What the plain outcome's surface does in each cell; for surfaces in space only."""
    found = complex_of(trial)
    return remembered(
        trial, "traces", lambda: traces(lattice_of(trial), found.points, found.simplices)
    )


@dataclass(frozen=True, eq=False)
class Domain:
    """The samples in which an implementation says its mesh ends, and its mesh among them.

    Attributes
    ----------
    lattice : these samples
    corner : (n,) the first of them, as a sample of the field
    mesh : the mesh, in the index coordinates of `lattice`
    """

    lattice: Lattice
    corner: Integers
    mesh: Complex

    @cached_property
    def at_places(self) -> Complex:
        """The mesh with vertices of equal coordinates made one."""
        return self.mesh.welded()

    def of_field(self, place: Integers) -> list[int]:
        """A sample or a cell of this lattice, by its index in the field."""
        return [int(i) for i in np.asarray(place) + self.corner]


def domain_of(trial: Trial) -> Domain:
    """The part of the lattice in which cells are judged: those that are wholly in the domain."""

    def compute() -> Domain:
        lattice, corner = lattice_of(trial).within
        found = complex_of(trial)
        if corner.any():
            found = Complex(found.points - corner, found.simplices)
        return Domain(lattice, corner, found)

    return remembered(trial, "domain", compute)


def cells_of(trial: Trial) -> Traces:
    """What the surface does in each cell of the domain; for surfaces in space only."""
    domain = domain_of(trial)
    if domain.lattice is lattice_of(trial):
        return traces_of(trial)
    mesh = domain.mesh
    return remembered(trial, "cells", lambda: traces(domain.lattice, mesh.points, mesh.simplices))


def undecided(found: Traces, cells: Booleans) -> Finding | None:
    """What to say where no cell is wrong and these cells are not judged; None where all are.

    cells : (n,) of `found`, with too many flat triangles
    """
    count = int((cells & ~found.tied).sum())
    if not count:
        return None
    return skipped(
        f"{count} cells are not judged: more than {MOST} triangles lie flat in a face, or there "
        f"are more than {LIMIT:,} ways to give such triangles to the cells on either side"
    )


def off_border(trial: Trial, rows: Integers, points: Floats | None = None) -> Integers:
    """Those of the facets that do not lie at an open end of the domain."""
    if not len(rows):
        return rows
    places = complex_of(trial).points if points is None else points
    return rows[~lattice_of(trial).on_border(places, rows)]


def off_ties(trial: Trial, places: Floats) -> Booleans:
    """(r,) places that are not a tied sample, where sheets may touch.

    Sheets of a dual method touch in whole faces beside tied samples; in a soup they then are one.
    """
    lattice, declared = lattice_of(trial), trial.declaration
    if declared.soup is not None and declared.vertices == "cells":
        return ~lattice.beside_tie(places)
    return ~lattice.at_tie(places)


def place(point: Floats) -> list[float]:
    """Index coordinates, rounded for a reader."""
    return [round(float(x), 6) for x in point]


def answered(outcome: Outcome) -> bool:
    """The call came back with two arrays."""
    return outcome.vertices is not None and outcome.simplices is not None


def first_row(rows: Integers) -> list[int]:
    """The first row, as JSON."""
    return [int(x) for x in np.asarray(rows).reshape(len(rows), -1)[0]]
