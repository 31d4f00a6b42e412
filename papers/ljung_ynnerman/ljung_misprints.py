"""Tables 2 and 3 transcribed letter for letter, to show what their misprints do.

Table 2, line 4 continues with the next voxel before line 10 has set I_L: the count stays unset for
every voxel that is skipped. Table 3, line 10 traces forward only if ``i_F != i_L``: where the
backward trace finds nothing, both are still the first segment, the forward trace is skipped, and
the segment is a curve of its own, "closed" because ``i_F = i_L``.
"""

from __future__ import annotations

import numpy as np
from isograde.reproduction import Table
from isoref.fast.surface_intersection import (
    enhanced_marching_cubes,
    segment_chains,
    surface_intersection,
)
from isoref.field import Field, Integers
from isoref.surface_intersection import IndexedSurface, Segments, triangle_intersection
from isoref.surface_intersection import rational as exactly

NIL = None
End = tuple[int, int]


def table_2(first: IndexedSurface, second: IndexedSurface) -> tuple[int, dict[int, int]]:
    """SURFACEISECT as printed: the number of segments |L|, and I_L of the voxels that have it."""
    corners = [
        [[exactly(s.mesh.vertices[v]) for v in row] for row in s.mesh.simplices]
        for s in (first, second)
    ]
    L, I_L = 0, dict[int, int]()
    for k in range(int(np.prod(first.shape))):
        if first.count_in(k) == 0 or second.count_in(k) == 0:
            continue
        for i in range(int(first.count_through(k - 1)), int(first.count_through(k))):
            for j in range(int(second.count_through(k - 1)), int(second.count_through(k))):
                L += triangle_intersection(corners[0][i], corners[1][j]) is not None
        I_L[k] = L
    return L, I_L


def table_3(segments: Segments, threshold: float) -> list[tuple[Integers, bool]]:
    """COMBINELINESEGS as printed: the segments of each curve, and whether i_F = i_L ("closed")."""
    U: dict[int, End] = {}
    curves = []
    for i in range(len(segments.cells)):
        if i in U:
            continue
        i_F, i_L, m, m_ = i, i, 1, 1
        while True:
            found = closest(segments, i_F, 1 - m, U, threshold)
            if found is not NIL:
                U[found[0]] = (i_F, found[1])
                i_F, m = found
            if found is NIL or i_F == i_L:
                break
        if i_F != i_L:
            while True:
                found = closest(segments, i_F, m_, U, threshold)
                if found is not NIL:
                    U[i_L] = found
                    i_L, m_ = found[0], 1 - found[1]
                if found is NIL or i_F == i_L:
                    break
        curves.append((traced(i_F, U), i_F == i_L))
    return curves


def closest(segments: Segments, i: int, m: int, U: dict[int, End], threshold: float) -> End | None:
    """FINDCLOSESTPOINT: the end of an unused segment nearest to end m of segment i."""
    gaps = np.linalg.norm(segments.ends - segments.ends[i, m], axis=2)
    gaps[[i, *U]] = np.inf
    best = np.unravel_index(int(gaps.argmin()), gaps.shape)
    return (int(best[0]), int(best[1])) if gaps[best] <= threshold else None


def traced(i_F: int, U: dict[int, End]) -> Integers:
    """LINESEGSTRACE: the segments from i_F on, as U links them."""
    found = [i_F]
    while found[-1] in U and U[found[-1]][0] not in found:
        found.append(U[found[-1]][0])
    return np.array(found)


def open_line() -> tuple[IndexedSurface, IndexedSurface]:
    """Two planes askew in a lattice, which meet in one line from border to border."""
    x, y, z = np.meshgrid(*[np.linspace(0, 1, 9)] * 3, indexing="ij")
    planes = (x + 0.31 * y - 0.57 * z - 0.43, y - 0.23 * x + 0.11 * z - 0.47)
    one, two = (enhanced_marching_cubes(Field.of(values, 1 / 8), 0.0) for values in planes)
    return one, two


def report() -> Table:
    """What each misprint does, beside what the text lets expect."""
    one, two = open_line()
    segments = surface_intersection(one, two)
    total, I_L = table_2(one, two)
    voxels = int(np.prod(one.shape))
    table = Table("Tables 2 and 3 transcribed letter for letter: one open line")
    table.add("segments by table 2", None, total, expected=len(segments.cells))
    note = "line 4: `continue` skips line 10, so I_L stays unset for skipped voxels"
    table.add("voxels for which table 2 sets I_L", None, len(I_L), expected=voxels, note=note)
    chains = segment_chains(segments)
    literal = table_3(segments, 1e-9)
    note = "line 10: where the backward trace finds nothing, i_F = i_L and no trace goes forward"
    table.add("curves by table 3", None, len(literal), expected=len(chains), note=note)
    closed = sum(is_closed for _, is_closed in literal)
    wanted = sum(is_closed for _, is_closed in chains)
    table.add("of these closed, by i_F = i_L", None, closed, expected=wanted)
    return table
