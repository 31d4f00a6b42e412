"""Table 1 counted with the reference: signs, decisions, names.

The grader counts the same table by other means (`isograde.frequencies`); `reproduce.py` holds the
two beside each other.
"""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import numpy as np
from isoref.asymptotic_decider import decisions, saddle_point, variant
from isoref.cube import CORNERS, ambiguous_faces
from isoref.field import Field, Floats, Integers, inside_samples
from numpy.typing import NDArray

PRINTED = json.loads((Path(__file__).parent / "table1.json").read_text(encoding="utf-8"))
ROWS: tuple[str, ...] = tuple(PRINTED["rows"])
# The row of a variant: its own name, or the row that lumps it with another.
ROW_OF = {
    f"{names.split(',')[0][:-1]}{letter}": names
    for names in ROWS
    if "," in names
    for letter in (names.split(",")[0][-1], names[-1])
}


def printed_column(example: str) -> dict[str, int]:
    """Row -> number of cells, as printed for this example."""
    column = list(PRINTED["voxels"]).index(example)
    return {row: counts[column] for row, counts in PRINTED["rows"].items()}


def cell_signs(field: Field, isovalue: float) -> NDArray[np.uint8]:
    """(N1 - 1, N2 - 1, N3 - 1) signs, bit c for corner c of `isoref.cube`."""
    inside = inside_samples(field, isovalue)
    n = [size - 1 for size in inside.shape]
    signs = np.zeros(n, np.uint8)
    for c, (i, j, k) in enumerate(CORNERS):
        signs |= inside[i : i + n[0], j : j + n[1], k : k + n[2]].view(np.uint8) << np.uint8(c)
    return signs


def corner_values(field: Field, isovalue: float, places: Integers) -> Floats:
    """(8, n) values minus the isovalue at the corners of the cells at `places` (n, 3)."""
    corners = (field.values[tuple((places + corner).T)] for corner in np.array(CORNERS))
    return np.stack([values.astype(np.float64) - isovalue for values in corners])


def ambiguous_cells(signs: NDArray[np.uint8]) -> Integers:
    """(n, 3) the cells with an ambiguous face."""
    asks = np.array([bool(ambiguous_faces(s)) for s in range(256)])
    return np.argwhere(asks[signs])


def variants(field: Field, isovalue: float) -> Counter[str]:
    """How many cells are of each variant, by its full name."""
    signs = cell_signs(field, isovalue)
    places = ambiguous_cells(signs)
    counts: Counter[str] = Counter()
    for s, number in enumerate(np.bincount(signs.reshape(-1), minlength=256).tolist()):
        if not ambiguous_faces(s):
            counts[variant(s, 0)] += number
    decided = decisions(corner_values(field, isovalue, places))
    asked = signs[tuple(places.T)].astype(np.int64)
    for (s, d), number in Counter(zip(asked.tolist(), decided.tolist(), strict=True)).items():
        counts[variant(s, d)] += number
    return counts


def table(counts: Counter[str]) -> dict[str, int]:
    """The rows of Table 1 from the counts of variants."""
    rows = dict.fromkeys(ROWS, 0)
    for name, number in counts.items():
        rows["13" if name.startswith("13") else ROW_OF.get(name, name)] += number
    return rows


def faces(field: Field, isovalue: float) -> tuple[int, int, int]:
    """Ambiguous faces of cells, those separated, and those with the saddle on the isovalue.

    A face between two cells counts twice. A saddle is taken to be on the isovalue where its value,
    which is rounded, is less than 1e-12 of the largest corner's.
    """
    signs = cell_signs(field, isovalue)
    places = ambiguous_cells(signs)
    g = corner_values(field, isovalue, places)
    asked, bits = signs[tuple(places.T)], decisions(g)
    total = separated = on_it = 0
    for f in range(6):
        here = np.array([f in ambiguous_faces(s) for s in range(256)])[asked]
        _, value = saddle_point(g[:, here], f)
        total += int(here.sum())
        separated += int((bits[here] >> f & 1).sum())
        on_it += int((np.abs(value) <= 1e-12 * np.abs(g[:, here]).max(axis=0, initial=0)).sum())
    return total, separated, on_it
