"""Cycles, points and triangles counted cell by cell, beside the surfaces themselves.

A volume of V voxels is V + .. cells of eight voxels, and what a cell adds to Tables II to IV
depends on its eight signs, and in mixed mode on the decisions of its ambiguous faces. So the
whole table follows from a histogram: 256 numbers for the global modes.

Glossary
--------
histogram   (256,) how many cells have these signs; bit c of the signs is corner c of `isoref.cube`
signatures  (signs, separated) -> how many cells, for the mixed mode
cycles      N -> how many N-cycles
points      of the original: support points shared by all cells, and averages
            of the marching: counted once a cycle, as the paper's programs left them
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from itertools import product

import numpy as np
from isoref.cube import CORNERS, ambiguous_faces, crossed_edges
from isoref.field import Field, Floats, Integers, inside_samples
from isoref.marching_vesta import cycles, decisions

Signatures = Mapping[tuple[int, int], int]
Lengths = dict[int, int]
GLOBAL = {"disconnect": 0b111111, "connect": 0}


def cell_signs(field: Field, isovalue: float, plane: int) -> Integers:
    """(N2 + 1, N3 + 1) signs of the cells between planes `plane - 1` and `plane` of voxels.

    Voxels outside the volume are inactive.
    """
    n = field.shape[0]
    both = [np.zeros(field.shape[1:], np.bool_)] * 2
    for side in (0, 1):
        if 0 <= plane - 1 + side < n:
            layer = Field(field.values[plane - 1 + side], field.spacing[1:], field.origin[1:])
            both[side] = inside_samples(layer, isovalue)
    framed = np.pad(np.stack(both), ((0, 0), (1, 1), (1, 1)))
    signs = np.zeros(np.add(field.shape[1:], 1), np.uint8)
    for c, (i, j, k) in enumerate(CORNERS):
        corner = framed[i, j : j + signs.shape[0], k : k + signs.shape[1]]
        signs |= corner.view(np.uint8) << np.uint8(c)
    return signs


def histogram(field: Field, isovalue: float, border: str = "closed") -> Integers:
    """(256,) the number of cells with each signs; an open border leaves outer cells out."""
    inner = slice(None) if border == "closed" else slice(1, -1)
    count = np.zeros(256, np.int64)
    for plane in range(field.shape[0] + 1)[inner]:
        signs = cell_signs(field, isovalue, plane)[inner, inner]
        count += np.bincount(signs.ravel(), minlength=256)
    return count


def signatures(field: Field, isovalue: float, mode: str, border: str = "closed") -> Counter:
    """(signs, separated) -> cells, with the decisions of this mode on ambiguous faces."""
    count = histogram(field, isovalue, border)
    if mode != "mixed":
        return Counter({(s, GLOBAL[mode]): int(n) for s, n in enumerate(count) if n})
    total = Counter({(s, 0): int(n) for s, n in enumerate(count) if n and not ambiguous_faces(s)})
    for signs, g in ambiguous_cells(field, isovalue, border):
        total.update(zip(signs.tolist(), decisions(g).tolist(), strict=True))
    return total


def ambiguous_cells(field: Field, isovalue: float, border: str = "closed"):
    """Plane by plane, the signs (n,) and relative values (8, n) of the cells that are asked.

    A cell of the border can be ambiguous within the volume's outer plane only; voxels outside
    count as minus infinity.
    """
    inner = slice(None) if border == "closed" else slice(1, -1)
    asks = np.array([bool(ambiguous_faces(signs)) for signs in range(256)])
    offset = 0 if border == "closed" else 1
    for plane in range(field.shape[0] + 1)[inner]:
        signs = cell_signs(field, isovalue, plane)[inner, inner]
        at = np.argwhere(asks[signs]) + offset
        if len(at):
            index = np.column_stack([np.full(len(at), plane), at]) - 1
            yield signs[tuple((at - offset).T)].astype(int), _relative(field, isovalue, index)


def _relative(field: Field, isovalue: float, lower: Integers) -> Floats:
    """(8, n) values minus the isovalue at the corners above these lower corners."""
    g = np.full((8, len(lower)), -np.inf)
    for c, corner in enumerate(CORNERS):
        index = lower + corner
        here = ((index >= 0) & (index < field.shape)).all(axis=1)
        g[c, here] = field.values[tuple(index[here].T)].astype(np.float64) - isovalue
    return g


def lengths(cells: Signatures) -> Lengths:
    """N -> cycles, from the signatures of all cells."""
    total: Counter[int] = Counter()
    for (signs, separated), n in cells.items():
        for cycle in cycles(signs, separated):
            total[len(cycle)] += n
    return dict(sorted(total.items()))


def support_points(cells: Signatures) -> int:
    """Crossed lattice edges of a closed volume: each lies in four cells."""
    four_times = sum(n * len(crossed_edges(signs)) for (signs, _), n in cells.items())
    whole, rest = divmod(four_times, 4)
    if rest:
        raise ValueError(f"{four_times} edges of cells are no multiple of four: an open border?")
    return whole


def triangles(found: Mapping[int, int], resolution: str) -> int:
    """Triangles of the cycles: L adds a point to those longer than seven, H than three."""
    last = 7 if resolution == "L" else 3
    return sum(n * (N if N > last else N - 2) for N, n in found.items())


def averages(found: Mapping[int, int], resolution: str) -> int:
    """Average points among the vertices."""
    last = 7 if resolution == "L" else 3
    return sum(n for N, n in found.items() if N > last)


def marching_points(found: Mapping[int, int], resolution: str) -> int:
    """Points of the marching program, which shares none between cells."""
    return sum(N * n for N, n in found.items()) + averages(found, resolution)


def differing_decisions(field: Field, isovalue: float) -> tuple[int, int]:
    """Ambiguous faces of cells, and those where the average and the bilinear saddle disagree."""
    from isoref import asymptotic_decider

    faces = differ = 0
    for signs, g in ambiguous_cells(field, isovalue, border="open"):
        faces += sum(len(ambiguous_faces(s)) for s in signs.tolist())
        disagreement = decisions(g) ^ asymptotic_decider.decisions(g)
        differ += int(np.bitwise_count(disagreement).sum())
    return faces, differ


def all_signatures() -> list[tuple[int, int]]:
    """Every signs with every choice on its ambiguous faces."""
    return [
        (signs, sum(bit << f for f, bit in zip(ambiguous_faces(signs), choice, strict=True)))
        for signs in range(256)
        for choice in product((0, 1), repeat=len(ambiguous_faces(signs)))
    ]
