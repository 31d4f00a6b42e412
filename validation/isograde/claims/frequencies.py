"""The claim on how often each configuration occurs: Table 1, counted on the mesh.

One count is read off the mesh: in each cell the configuration is that of the samples, and the
variant follows from the segments in which the mesh meets the cell's ambiguous faces. The other is
taken from the samples alone (`isograde.frequencies`). Cells with a tied corner or with a saddle on
the isovalue have more than one right answer and are left out of both.
"""

from __future__ import annotations

from collections import Counter

import numpy as np
from isoref.field import Booleans, Integers

from isograde.claims.cells import follows_values
from isograde.claims.evidence import (
    cells_of,
    domain_of,
    failed,
    on_mesh,
    passed,
    skipped,
    undecided,
)
from isograde.frequencies import AMBIGUOUS_ROWS, CORNERS, ROWS, rows_of, rows_with
from isograde.model import SURFACES, Claim, Finding, Trial
from isograde.oracles.bilinear import read_in_favour, saddles
from isograde.oracles.lattice import Lattice
from isograde.oracles.traces import Traces

UNKNOWN = "none"


def judged_cells(lattice: Lattice, traces: Traces) -> Booleans:
    """(n,) cells whose variant has one right answer."""
    row, _, sign, _ = saddles(lattice, traces)
    judged = ~traces.tied & ~traces.undecided.any(axis=1)
    judged[row[sign == 0]] = False
    return judged


def rows_found(lattice: Lattice, traces: Traces, signs: Integers) -> Integers:
    """(n,) index into `ROWS` of what the mesh makes of each cell, or -1."""
    fits = np.asarray(traces.separated | traces.joined).all(axis=1)
    separated = (read_in_favour(lattice, traces) & traces.ambiguous).sum(axis=1)
    return np.where(fits, rows_with(signs, separated), -1)


def counted(rows: Integers) -> Counter[str]:
    """How many cells each row has; -1 counts as `UNKNOWN`."""
    return Counter({(*ROWS, UNKNOWN)[row]: n for row, n in Counter(rows.tolist()).items()})


def frequencies(trial: Trial) -> Finding:
    """Pass when the counts on the mesh are those of the samples, row by row."""
    lattice, traces = domain_of(trial).lattice, cells_of(trial)
    judged = judged_cells(lattice, traces)
    i, j, k = traces.place.T
    signs = np.zeros(len(traces.cell), np.int64)
    for bit, (a, b, c) in enumerate(CORNERS):
        signs |= lattice.inside[i + a, j + b, k + c].astype(np.int64) << bit
    asked = rows_of(lattice.field, lattice.isovalue, signs, traces.place)
    wanted, made = asked[judged], rows_found(lattice, traces, signs)[judged]
    expected, found = counted(wanted), counted(made)
    open_ = undecided(traces, np.asarray(traces.undecided.any(axis=1)))
    if not AMBIGUOUS_ROWS & set(expected) and not found[UNKNOWN]:
        return open_ or skipped("no judged cell has an ambiguous face")
    counts = {"cells": len(wanted), "wrong": int((wanted != made).sum())}
    if expected == found:
        return open_ or passed(counts=dict(expected), **counts)
    rows = [row for row in (*ROWS, UNKNOWN) if expected[row] != found[row]]
    return failed(
        "; ".join(f"{found[row]} cells of {row} instead of {expected[row]}" for row in rows),
        found=dict(found),
        expected=dict(expected),
        **counts,
    )


CLAIMS = (
    Claim(
        id="cells.frequencies",
        rule="The cells counted by configuration and variant, as the mesh resolves them, are as "
        "many as the bilinear interpolant says, row by row of Table 1.",
        source="Nielson & Hamann 1991, section 4, Table 1",
        level=3,
        judge=on_mesh(frequencies),
        kinds=lambda kind: kind == SURFACES,
        families=follows_values,
    ),
)
