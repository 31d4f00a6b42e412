"""Claims on each cell by itself: it must be one of the legal resolutions.

A cell has several where it has ambiguous faces; any of them passes. That the two cells at a face
made the same choice is `topology.closed`. A cell with a tied corner is not judged here: vertices
there stand on several lattice edges at once.
"""

from __future__ import annotations

import numpy as np

from isograde.claims.evidence import failed, on_triangles, passed, traces_of, undecided
from isograde.model import Claim, Finding, Trial
from isograde.oracles.traces import FACES, Traces, segments_on


def legal(trial: Trial) -> Finding:
    """Pass when every cell without a tied corner has a legal trace on each of its faces."""
    traces = traces_of(trial)
    if len(traces.spanning):
        return failed(
            f"{len(traces.spanning)} triangles span several cells, the first is face "
            f"{int(traces.spanning[0])}",
            spanning=len(traces.spanning),
        )
    wrong = ~(traces.separated | traces.joined | traces.undecided)
    wrong[traces.tied] = False
    cells = np.flatnonzero(wrong.any(axis=1))
    if not len(cells):
        open_cells = np.asarray(traces.undecided.any(axis=1))
        counts = {"cells": int((~traces.tied).sum()), "tied": int(traces.tied.sum())}
        return undecided(trial, open_cells) or passed(**counts)
    first = int(cells[0])
    face = int(np.argmax(wrong[first]))
    return failed(
        f"{len(cells)} cells; in the cell at {traces.place[first].tolist()} with corner signs "
        f"{int(traces.signs[first]):08b} the mesh meets the {'low' if face % 2 == 0 else 'high'} "
        f"face of axis {face // 2} in {describe(traces, first, face)}",
        cells=len(cells),
        cell=traces.place[first].tolist(),
        signs=int(traces.signs[first]),
        face=face,
    )


def describe(traces: Traces, row: int, face: int) -> str:
    """The segments of a cell's trace on one face, by the halves its nodes stand on."""
    code = int(traces.faces[row, face])
    found = [f"{p}-{q}" for s, (p, q) in enumerate(segments_on(FACES[face])) if code >> s & 1]
    return ", ".join(found) if found else "no segment"


CLAIMS = (
    Claim(
        id="cases.legal",
        rule="Every cell is bounded by one of the legal systems of segments: on each face the "
        "segments that separate its corners by sign, and on an ambiguous face one of the two "
        "pairs that do not cross.",
        source="Nielson & Hamann 1991, section 2 and Figure 4: both triangulations are correct",
        level=2,
        judge=on_triangles(legal),
        unless=frozenset({"on-edges", "welded"}),
    ),
)
