"""The claim of level 4: in every cell the mesh has the topology of the trilinear interpolant.

Each cell is judged by itself: the crossings on its edges must be grouped into arcs and sheets as
those of the trilinear level set are, and its Euler characteristic must be the level set's. Where
that holds in every cell, the surface glued from the cells' pieces has the level set's topology,
since both are glued along the same arcs. Two cells may draw the same edge on the face they share;
the mesh then has an edge of four triangles, which is a fault of its own (`topology.edge_manifold`).

A cell that is a tie, or that has a corner on the surface to within single precision, has no single
truth and is not judged. What is wrong is said case by case, in Chernyaev's names.
"""

from __future__ import annotations

from collections import Counter

import numpy as np
from isoref.field import Booleans, Integers

from isograde.claims.evidence import failed, lattice_of, on_triangles, passed, skipped, surface_of
from isograde.model import Claim, Finding, Trial
from isograde.oracles.sheets import Fault, judge
from isograde.oracles.trilinear import NONE, cells
from isograde.oracles.trilinear_cases import case_names
from isograde.oracles.trilinear_grid import active_cells

FAMILIES = frozenset({"trilinear", "cells", "pairs", "noise"})


def trilinear(trial: Trial) -> Finding:
    """Pass when every cell that is no tie has the sheets, arcs and Euler characteristic it must."""
    lattice, values = lattice_of(trial), np.asarray(trial.field.values)
    if min(values.shape) < 2:
        return skipped("the lattice has no cells")
    index, corners = active_cells(values, trial.case.isovalue)
    truths = cells(corners, trial.case.isovalue)
    judged = (truths.ties == NONE) & ~_near_a_corner(lattice.tied, index)
    if not judged.any():
        return skipped("every cell of the surface is a tie: there is no single truth")
    surface = surface_of(trial).welded()
    mesh = surface.points, surface.faces
    found = np.array(judge(*mesh, index, truths, values.shape, lattice, judged), np.str_)
    names = case_names(truths)
    open_ = judged & (found == Fault.UNDECIDED)
    wrong = np.flatnonzero(judged & ~open_ & (found != Fault.NONE))
    if len(wrong):
        return _wrong_cells(index, found, names, wrong, int(judged.sum()))
    if open_.any():
        return skipped(f"{int(open_.sum())} cells are {Fault.UNDECIDED}")
    return passed(cells=int(judged.sum()), cases=dict(Counter(names[judged].tolist())))


def _near_a_corner(tied: Booleans, index: Integers) -> Booleans:
    """(n,) cells with a corner on the surface to within the tolerance."""
    near = np.zeros(len(index), bool)
    for offset in np.ndindex(2, 2, 2):
        near |= tied[tuple((index + np.array(offset)).T)]
    return near


def _wrong_cells(
    index: Integers,
    found: np.ndarray[tuple[int], np.dtype[np.str_]],
    names: np.ndarray[tuple[int], np.dtype[np.str_]],
    wrong: Integers,
    judged: int,
) -> Finding:
    """What is wrong, case by case."""
    count = Counter(zip(names[wrong].tolist(), found[wrong].tolist(), strict=True))
    said = "; ".join(f"{fault} in {n} of case {name}" for (name, fault), n in sorted(count.items()))
    first = int(wrong[0])
    return failed(
        f"{len(wrong)} of {judged} cells: {said}; the first is the cell at {index[first].tolist()}",
        cells=judged,
        wrong=len(wrong),
        faults=[[name, fault, n] for (name, fault), n in sorted(count.items())],
        cell=index[first].tolist(),
    )


CLAIMS = (
    Claim(
        id="topology.trilinear",
        rule="In every cell the mesh has the sheets, boundary curves and Euler characteristic of "
        "the trilinear interpolant's level set.",
        source="Chernyaev 1995; Lopes & Brodlie 2003; Etiene and others 2012: the topology of the "
        "trilinear interpolant",
        level=4,
        judge=on_triangles(trilinear),
        tags=FAMILIES,
        unless=frozenset({"on-edges", "welded", "border"}),
    ),
)
