"""Marching VESTA: the cycles of one 2 x 2 x 2 neighbourhood, traced by a table of 24 paths.

Every cycle of VESTA (`isoref.vesta`) stays within one neighbourhood of eight voxels. So the
volume can be swept neighbourhood by neighbourhood: a cell sees a quarter of each boundary face,
and on it one path, from juncture to juncture. The junctures are the middles of the cell's faces,
which hold no, two or four vectors; only with four there is a choice, and it is that of the 2-D
contours (Fig. 1d). Tracing the paths gives the cycles. That is the whole algorithm.

Glossary
--------
corner c    of the cell `isoref.cube` is the centre of a voxel, "site" in the paper
centre e    0 .. 11: the middle of edge e, where a boundary face has its centre
juncture f  0 .. 5: the middle of face f
path        f -> e -> f', on the quarter of the boundary face round e that lies in the cell;
            plus where the active voxel is the lower end of the edge, minus where it is the upper
POA         a juncture with two paths in and two out: an ambiguous face
separated   six bits, as in `isoref.cycles`: bit f is set where the POA of face f disconnects

Invariants
----------
The minus path is the plus path backwards. Cycles are those of the original VESTA round the
middle of the cell, begun at the same support point and cut into the same triangles.

References
----------
1. B. R. Schlei, "Volume-Enclosing Surface Extraction", section II.F, Figs. 15 to 18 and Table I;
   section II.E (8-, 9- and 12-cycles; the tube of Fig. 10b), III.B (the average at a POA).
"""

from __future__ import annotations

from functools import cache, partial
from itertools import pairwise

import numpy as np

from isoref.cube import (
    CORNERS,
    EDGES,
    FACE_CORNERS,
    FACE_EDGES,
    axis_of,
    crossed_edges,
    inside,
)
from isoref.cycles import Polygon, Triangle, fan
from isoref.diconex import Mode, average_is_active
from isoref.field import Floats, Integers
from isoref.rule import Average, Placement, Rule, Tile, decide_faces, no_decisions
from isoref.vesta import SIX_SURFACES, Resolution, fan_start

Path = tuple[int, int, int]

#: Twice the coordinates of the centres and junctures: (12, 3) and (6, 3).
CENTRES = np.array([np.add(CORNERS[a], CORNERS[b]) for a, b in EDGES])
JUNCTURES = np.array([np.sum([CORNERS[c] for c in walk], axis=0) // 2 for walk in FACE_CORNERS])


def _plus_path(e: int) -> Path:
    """The path round centre e when its lower end is active: clockwise round the range vector."""
    f, g = (f for f in range(6) if e in FACE_EDGES[f])
    to_f, to_g = JUNCTURES[f] - CENTRES[e], JUNCTURES[g] - CENTRES[e]
    counterclockwise = np.cross(to_f, to_g)[axis_of(e)] > 0
    return (g, e, f) if counterclockwise else (f, e, g)


#: Table I. PATHS[e] holds the plus and the minus path of centre e.
PATHS = tuple((_plus_path(e), _plus_path(e)[::-1]) for e in range(12))


def cell_paths(signs: int) -> dict[int, Path]:
    """Centre -> path, for each boundary face that has a quarter in the cell, as in Fig. 17b.

    >>> cell_paths(0b00000001)
    {0: (2, 0, 4), 4: (4, 4, 0), 8: (0, 8, 2)}
    """
    return {e: PATHS[e][inside(signs, EDGES[e][1])] for e in crossed_edges(signs)}


@cache
def cycles(signs: int, separated: int) -> tuple[Polygon, ...]:
    """The cycles of the cell as tuples of centres, each begun at its first in `ORDER`.

    >>> three = 1 << 0 | 1 << 3 | 1 << 7  # two voxels on an edge, one more above: Fig. 17
    >>> [len(cycle) for cycle in cycles(three, 0b111111)], [len(c) for c in cycles(three, 0)]
    ([3, 4], [7])
    """
    paths = cell_paths(signs)
    waiting = sorted(paths, key=ORDER.index)
    found = []
    while waiting:
        cycle = [waiting[0]]
        while (centre := _successor(paths, cycle[-1], signs, separated)) != cycle[0]:
            cycle.append(centre)
        waiting = [e for e in waiting if e not in cycle]
        found.append(tuple(cycle))
    return tuple(found)


#: Centres in the order of their lower voxel and axis, the order of the original's support points.
ORDER = sorted(range(12), key=lambda e: (CORNERS[EDGES[e][0]], axis_of(e)))


def _successor(paths: dict[int, Path], e: int, signs: int, separated: int) -> int:
    """The centre of the path that begins where the path of centre e ends."""
    juncture = paths[e][2]
    onward = [g for g, path in paths.items() if path[0] == juncture]
    if len(onward) == 1:
        return onward[0]
    # At a point of ambiguity stay with the active voxel to disconnect, leave it to connect.
    stay = bool(separated >> juncture & 1)
    return next(g for g in onward if (_active_end(g, signs) == _active_end(e, signs)) == stay)


def _active_end(e: int, signs: int) -> int:
    """The corner at the active end of a crossed edge."""
    a, b = EDGES[e]
    return a if inside(signs, a) else b


def decisions(g: Floats) -> Integers:
    """Bit f set where face f is ambiguous and the average of its four voxels is not active.

    g (8, n) are the values at the corners minus the isovalue.
    """
    return decide_faces(g, lambda a, b, c, d: ~average_is_active(a, c, b, d))


def tile(
    signs: int, decisions: int, mode: Mode, resolution: Resolution, tube: bool = False
) -> Tile:
    """The triangles of the cell's cycles, as in Figs. 8, 9 and 14; with `tube`, Fig. 10b."""
    separated = {"disconnect": 0b111111, "connect": 0, "mixed": decisions}[mode]
    if tube and signs in DIAGONALS:
        return Tile(_tube(*cycles(signs, separated)))
    triangles: list[Triangle] = []
    averages: list[Placement] = []
    for cycle in cycles(signs, separated):
        if len(cycle) > 7 or (resolution == "H" and len(cycle) > 3):
            triangles += fan(cycle, 12 + len(averages))
            averages.append(Average(cycle))
        else:
            triangles += _cut(cycle)
    return Tile(tuple(triangles), tuple(averages))


@cache
def _cut(cycle: Polygon) -> tuple[Triangle, ...]:
    """The triangles of a cycle without a further point, as `isoref.vesta` cuts it."""
    start = fan_start(CENTRES[list(cycle)])
    first, *others = cycle[start:] + cycle[:start]
    return tuple((first, a, b) for a, b in pairwise(others))


#: The signs of a cell in which two voxels alone are active that share one point.
DIAGONALS = frozenset(1 << c | 1 << (7 - c) for c in range(4))


def _tube(one: Polygon, other: Polygon) -> tuple[Triangle, ...]:
    """The tube of Fig. 10b in place of the two opposite 3-cycles: six triangles round a diagonal.

    The six dashed lines of the figure join each point of a cycle to the two points of the other
    that lie on edges along other axes. Between two neighbouring lines there is one triangle, on a
    side of one cycle, which runs as it ran in the cycle.
    """
    triangles: list[Triangle] = []
    for cycle, opposite in ((one, other), (other, one)):
        at = {axis_of(e): e for e in opposite}
        for a, b in zip(cycle, cycle[1:] + cycle[:1], strict=True):
            (third,) = {0, 1, 2} - {axis_of(a), axis_of(b)}
            triangles.append((a, b, at[third]))
    return tuple(triangles)


def rule(mode: Mode, resolution: Resolution, tube: bool = False) -> Rule:
    """The rule of one of the six surfaces; with `tube`, voxels that share a point are linked.

    "If one nonetheless desires to establish a link between voxels that only share a single common
    point one may insert a tubular template" (section II.E, Fig. 10b). The paper itself does not,
    and neither do the six surfaces.

    >>> rule("mixed", "H").name, rule("disconnect", "L", tube=True).name
    ('marching-vesta-mixed-H', 'marching-vesta-disconnect-L-tube')
    """
    name = f"marching-vesta-{mode}-{resolution}" + ("-tube" if tube else "")
    cut = partial(tile, mode=mode, resolution=resolution, tube=tube)
    if mode == "mixed":
        return Rule(name, cut, decisions, bits=6)
    return Rule(name, cut, no_decisions, asks=_never)


def _never(signs: int) -> bool:
    """False: a global mode compares no numbers."""
    return False


RULES = tuple(rule(mode, resolution) for mode, resolution in SIX_SURFACES)


# The numbers of the paper, for whoever compares with Table I.


def paper_number(place: Integers) -> int:
    """The number of a centre or juncture in Fig. 15c, 15d, from its doubled coordinates.

    Both are numbered upwards, then away from the reader, then to the right: centres 0 .. 11,
    junctures 12 .. 17.

    >>> paper_number(CENTRES[11]), paper_number(JUNCTURES[5])
    (7, 17)
    """
    odd = int((place % 2).sum())
    upward = sorted((CENTRES if odd == 1 else JUNCTURES).tolist(), key=lambda p: p[::-1])
    return upward.index(place.tolist()) + (0 if odd == 1 else 12)
