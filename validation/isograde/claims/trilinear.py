"""The claims that measure the mesh by the trilinear interpolant.

Level 4 asks it of each cell: the crossings on its edges must be grouped into arcs and sheets as
those of the trilinear level set are, and its Euler characteristic must be the level set's. Where
that holds in every cell, the surface glued from the cells' pieces has the level set's topology,
since both are glued along the same arcs. Two cells may draw the same edge on the face they share;
the mesh then has an edge of four triangles, which is a fault of its own (`topology.manifold`). A
cell that is a tie, or that has a corner on the surface to within single precision, has no single
right answer and is not judged. What is wrong is said case by case, in Chernyaev's names.

Beside the ladder, `topology.scan` measures every family by the whole: pieces, Euler characteristic,
boundary curves and handles of the mesh and of the level set inside its domain. Whoever draws
another interpolant's level set promises no agreement; the numbers say how far apart they are.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from math import floor

import numpy as np
from isoref.field import Booleans, Integers

from isograde.claims.cells import follows_values
from isograde.claims.evidence import (
    domain_of,
    failed,
    judged_complex,
    lattice_of,
    on_mesh,
    passed,
    skipped,
)
from isograde.model import SURFACES, Claim, Finding, Trial
from isograde.oracles.lattice import Lattice, components
from isograde.oracles.sheets import Fault, judge
from isograde.oracles.trilinear import NONE, cells
from isograde.oracles.trilinear_cases import case_names
from isograde.oracles.trilinear_grid import GridTruth, active_cells, grid

FAMILIES = frozenset({"trilinear", "cells", "pairs", "noise", "real"})
MEASURED = frozenset({"real", "noise"})


def trilinear(trial: Trial) -> Finding:
    """Pass when every cell that is no tie has the sheets, arcs and Euler characteristic it must."""
    domain = domain_of(trial)
    lattice, values = domain.lattice, components(domain.lattice.field)[0]
    if min(values.shape) < 2:
        return skipped("the domain has no cells")
    index, corners = active_cells(values, lattice.isovalue)
    truths = cells(corners, lattice.isovalue)
    judged = (truths.ties == NONE) & ~_near_a_corner(lattice.tied, index)
    if not judged.any():
        return skipped("every cell of the surface is a tie: it has no single right answer")
    mesh = domain.at_places
    # What is beyond the samples is in no cell.
    inner = np.clip(mesh.points, 0, np.subtract(values.shape, 1))
    far = np.asarray((np.abs(mesh.points - inner) > lattice.tolerance).any(axis=1))
    parts = mesh.simplices[~far[mesh.simplices].any(axis=1)]
    found = np.array(
        judge(mesh.points, parts, index, truths, values.shape, lattice, judged), np.str_
    )
    names = case_names(truths)
    open_ = judged & (found == Fault.UNDECIDED)
    wrong = np.flatnonzero(judged & ~open_ & (found != Fault.NONE))
    if len(wrong):
        return _wrong_cells(index + domain.corner, found, names, wrong, judged & ~open_)
    if open_.any():
        return skipped(f"{int(open_.sum())} cells are {Fault.UNDECIDED}")
    counted = dict(Counter(names[judged].tolist()))
    return passed(cells=int(judged.sum()), wrong=0, cases=counted)


def _near_a_corner(tied: Booleans, index: Integers) -> Booleans:
    """(n,) cells with a corner on the surface to within the tolerance."""
    near = np.zeros(len(index), bool)
    for offset in np.ndindex(2, 2, 2) if tied.any() else ():
        near |= tied[tuple((index + np.array(offset)).T)]
    return near


def _wrong_cells(
    index: Integers,
    found: np.ndarray[tuple[int], np.dtype[np.str_]],
    names: np.ndarray[tuple[int], np.dtype[np.str_]],
    wrong: Integers,
    judged: Booleans,
) -> Finding:
    """What is wrong, case by case."""
    count = Counter(zip(names[wrong].tolist(), found[wrong].tolist(), strict=True))
    said = "; ".join(f"{fault} in {n} of case {name}" for (name, fault), n in sorted(count.items()))
    first = int(wrong[0])
    return failed(
        f"{len(wrong)} of {int(judged.sum())} cells: {said}; the first is the cell at "
        f"{index[first].tolist()}",
        cells=int(judged.sum()),
        wrong=len(wrong),
        cases=dict(Counter(names[judged].tolist())),
        faults=[[name, fault, n] for (name, fault), n in sorted(count.items())],
        cell=index[first].tolist(),
    )


def scan(trial: Trial) -> Finding:
    """Pass when the mesh as a whole has the topology of the trilinear level set in its domain."""
    lattice, found = _measured(trial), judged_complex(trial)
    if min(lattice.shape) < 2:
        return skipped("the domain has no cells")
    wanted, isovalue = _level_set(lattice)
    if not len(found.simplices) and not wanted.components:
        return skipped("there is no surface")
    made = GridTruth(found.components, found.euler, found.boundary_pieces, 0)
    numbers = {
        "pieces": made.components,
        "pieces_wanted": wanted.components,
        "euler": made.euler,
        "euler_wanted": wanted.euler,
        "rims": made.curves,
        "rims_wanted": wanted.curves,
        "handles": handles(made),
        "handles_wanted": handles(wanted),
        "isovalue": isovalue,
    }
    if (made.components, made.euler) == (wanted.components, wanted.euler):
        return passed(**numbers)
    return failed(
        f"{made.components} pieces with {numbers['handles']:g} handles, where the trilinear "
        f"level set has {wanted.components} with {numbers['handles_wanted']:g}",
        **numbers,
    )


def _measured(trial: Trial) -> Lattice:
    """The samples of the domain; of an end between two samples, those up to the outer one."""
    lattice = lattice_of(trial)
    ends = tuple(replace(end, inset=float(floor(end.inset))) for end in lattice.ends)
    return replace(lattice, declared=replace(lattice.declared, domain=ends)).within[0]


def handles(surface: GridTruth) -> float:
    """The genus of all pieces together, by their Euler characteristic and boundary curves.

    >>> handles(GridTruth(components=1, euler=0, curves=0, ties=0))
    1.0
    """
    return surface.components - (surface.euler + surface.curves) / 2


def _level_set(lattice: Lattice) -> tuple[GridTruth, float]:
    """The topology of the trilinear level set, and the isovalue it is of.

    Where a sample or a saddle is on the isovalue, the isovalue moves by less than rounding does in
    single precision, to the side that puts it where the declaration puts ties.
    """
    values, isovalue = components(lattice.field)[0].astype(np.float64), lattice.isovalue
    found = grid(values, isovalue)
    step = -1 if lattice.declared.conventions.tie == "inside" else 1
    size = float(max(np.abs(values).max(), abs(isovalue), 1.0))
    shift = size * 2.0**-30
    while found.ties and shift < size * 2.0**-20:
        isovalue = lattice.isovalue + step * shift
        found, shift = grid(values, isovalue), 2 * shift
    return found, isovalue


CLAIMS = (
    Claim(
        id="topology.trilinear",
        rule="In every cell the mesh has the sheets, boundary curves and Euler characteristic of "
        "the trilinear interpolant's level set.",
        source="Chernyaev 1995; Lopes & Brodlie 2003; Etiene and others 2012: the topology of the "
        "trilinear interpolant",
        level=4,
        judge=on_mesh(trilinear),
        kinds=lambda kind: kind == SURFACES,
        families=follows_values,
        tags=FAMILIES,
    ),
    Claim(
        id="topology.scan",
        rule="The mesh has as many pieces and handles as the trilinear interpolant's level set in "
        "its domain.",
        source="isograde design: every family is measured by the trilinear interpolant on scans",
        level=None,
        judge=on_mesh(scan),
        kinds=lambda kind: kind == SURFACES,
        tags=MEASURED,
        promised=False,
    ),
)
