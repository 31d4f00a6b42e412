"""The claim on VESTA's cycles: who promises a mode has the cycles of that mode, in every cell.

A cell's cycles are the closed curves in which the surface meets the cell's six faces. They follow
from the signs of its corners and, on ambiguous faces, from the mode: *disconnect* separates the
inside corners, *connect* joins them, *mixed* joins them where the average of the four samples is
inside. Each cycle bounds one disc, and discs have nothing to do with each other.

Glossary
--------
code        a cell's trace on its faces, see `isograde.oracles.traces`
discs       a cell's triangles are T = b - 2 d + 2 i, where d discs have b sides on the cell's faces
            and i vertices inside; a tube between two cycles would have two triangles more a disc
"""

from __future__ import annotations

import numpy as np
from isoref.field import Booleans, Floats, Integers

from isograde.claims.evidence import failed, on_triangles, passed, skipped, traces_of, undecided
from isograde.model import Claim, Finding, Trial, Verdict
from isograde.oracles.traces import CORNERS, FACES, Traces

MODES = ("disconnect", "connect", "mixed")


def cycles(trial: Trial) -> Finding:
    """Pass when every cell without a tied corner has the cycles of the declared mode."""
    mode = trial.declaration.connectivity
    if mode not in MODES:
        return Finding(Verdict.UNSUPPORTED, "declares no connectivity mode")
    traces = traces_of(trial)
    settled = traces.settled
    judged = ~traces.tied & ~settled.unjudged
    if not judged.any():
        return skipped("every active cell has a tied corner")
    wrong = judged & ~_faces_as(mode, trial, traces).all(axis=1)
    if wrong.any():
        return _told(traces, wrong, f"does not have the cycles of mode {mode!r}", mode)
    wrong = judged & (settled.excess != 0)
    if wrong.any():
        return _told(traces, wrong, "does not fill each cycle with a disc of its own", mode)
    return undecided(trial, settled.unjudged) or passed(
        cells=int(judged.sum()),
        ambiguous=int((traces.ambiguous & judged[:, None]).sum()),
        cycles=int(settled.polygons[judged].sum()),
    )


def _faces_as(mode: str, trial: Trial, traces: Traces) -> Booleans:
    """(n, 6) faces whose trace is that of the mode; an average of nothing may be taken either way.

    Where a face is not ambiguous, both legal traces are the same.
    """
    separated, joined = traces.separated, traces.joined
    if mode == "disconnect":
        return separated
    if mode == "connect":
        return joined
    average = averages(trial, traces.place)
    return np.asarray(
        np.where(
            traces.ambiguous, (separated & (average <= 0)) | (joined & (average >= 0)), separated
        )
    )


def averages(trial: Trial, place: Integers) -> Floats:
    """(n, 6) sums of the four samples minus the isovalue on each face of the cells at `place`."""
    values = trial.field.values
    sums = np.zeros((len(place), len(FACES)))
    for f, (axis, side) in enumerate(FACES):
        for corner in CORNERS:
            if corner[axis] == side:
                index = tuple((place + np.asarray(corner) // 2).T)
                sums[:, f] += values[index].astype(np.float64) - trial.case.isovalue
    return sums


def _told(traces: Traces, wrong: Booleans, what: str, mode: str) -> Finding:
    """The failure, with its first cell."""
    first = int(np.flatnonzero(wrong)[0])
    return failed(
        f"{int(wrong.sum())} cells; the cell at {traces.place[first].tolist()} with corner signs "
        f"{int(traces.signs[first]):08b} {what}",
        cells=int(wrong.sum()),
        cell=traces.place[first].tolist(),
        signs=int(traces.signs[first]),
        mode=mode,
    )


CLAIMS = (
    Claim(
        id="cases.cycles",
        rule="Who declares a connectivity mode of VESTA has, in every cell, the cycles of that "
        "mode: ambiguous faces separated, joined, or joined where the average of the four samples "
        "is inside; and fills each with a disc of its own.",
        source="Schlei 2010, sections II.C to II.F, Figs. 7, 12 and 13",
        level=None,
        judge=on_triangles(cycles),
        unless=frozenset({"on-edges", "welded"}),
    ),
)
