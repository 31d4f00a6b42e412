"""The census of cycles, and VESTA beside the templates of 1987 (sections II.C, II.E, II.G).

Glossary
--------
signature   signs and decisions of a cell, as in `isoref.cycles`
type        a class of cycles under the 24 rotations of the cube and reversal
attainable  a signature whose decisions the averages of four voxels can take together
template    the polygons of the original marching cubes; a cell and its complement share them
"""

from __future__ import annotations

from functools import cache

import numpy as np
from isoref import lorensen_cline
from isoref.cube import (
    EDGE_OF,
    EDGES,
    FACE_CORNERS,
    REPRESENTATIVES,
    ROTATIONS,
    ambiguous_faces,
    inside,
)
from isoref.marching_vesta import cycles
from scipy.optimize import linprog
from vesta_counts import all_signatures

Cycle = tuple[int, ...]


def moved(cycle: Cycle, move: tuple[int, ...]) -> Cycle:
    """The cycle after each corner c went to move[c]."""
    return tuple(EDGE_OF[frozenset(move[c] for c in EDGES[e])] for e in cycle)


def kind(cycle: Cycle) -> Cycle:
    """The least of the cycle's images: the same for all cycles of its type."""
    images = []
    for move in ROTATIONS:
        image = moved(cycle, move)
        for way in (image, image[::-1]):
            start = way.index(min(way))
            images.append(way[start:] + way[:start])
    return min(images)


@cache
def attainable(signs: int, separated: int) -> bool:
    """Whether eight values exist with these signs and these decisions by averages.

    A linear feasibility problem: active values are at least 1, inactive ones at most -1, and the
    sums over ambiguous faces have their signs. (Scaling makes the margins no restriction.)
    """
    rows, bounds = [], []
    for f in ambiguous_faces(signs):
        row = np.zeros(8)
        row[list(FACE_CORNERS[f])] = 1 if separated >> f & 1 else -1
        rows.append(row)
        bounds.append(-1 if separated >> f & 1 else 0)
    if not rows:
        return True
    box = [(1, None) if inside(signs, c) else (None, -1) for c in range(8)]
    answer = linprog(np.zeros(8), np.array(rows), np.array(bounds), bounds=box, method="highs")
    return answer.status == 0


def types(global_modes_only: bool = False, averages_only: bool = False) -> dict[Cycle, int]:
    """Type -> how many cells show it, over all signatures, or over those attained."""
    found: dict[Cycle, int] = {}
    for signs, separated in all_signatures():
        faces = sum(1 << f for f in ambiguous_faces(signs))
        if global_modes_only and separated not in (0, faces):
            continue
        if averages_only and not attainable(signs, separated):
            continue
        for cycle in cycles(signs, separated):
            found[kind(cycle)] = found.get(kind(cycle), 0) + 1
    return dict(sorted(found.items(), key=lambda item: (len(item[0]), item[0])))


def perimeters(polygons: tuple[Cycle, ...]) -> set[frozenset[int]]:
    """The sides of all polygons, without direction."""
    return {frozenset((a, b)) for p in polygons for a, b in zip(p, p[1:] + p[:1], strict=True)}


def comparison() -> list[dict[str, object]]:
    """One entry a configuration: cycle lengths in both modes, for it and its complement.

    `same` tells whether the perimeters are those of the 1987 template, which the complement
    shares (Figs. 19 to 24).
    """
    entries = []
    for number, corners in enumerate(REPRESENTATIVES):
        signs = sum(1 << c for c in corners)
        template = lorensen_cline.polygons(signs)
        entry: dict[str, object] = {"configuration": number, "template": _sizes(template)}
        for name, given in (("", signs), ("inverted ", 255 - signs)):
            for mode, separated in (("disconnect", 0b111111), ("connect", 0)):
                found = cycles(given, separated)
                same = perimeters(found) == perimeters(template)
                entry[f"{name}{mode}"] = (_sizes(found), same)
        entries.append(entry)
    return entries


def _sizes(polygons: tuple[Cycle, ...]) -> list[int]:
    """The lengths of the polygons, sorted."""
    return sorted(len(p) for p in polygons)


def hole() -> np.ndarray:
    """Two cells side by side whose templates leave a hole between them (Fig. 25).

    The common face is ambiguous; one cell has three active corners, the other five or more.
    """
    for bits in range(256):
        # Corners of the first cell; the second repeats two of its own above the common face.
        grey = np.zeros((2, 2, 3))
        grey[:, :, 1] = [[1, 0], [0, 1]]
        grey[:, :, 0] = [[bits & 1, bits >> 1 & 1], [bits >> 2 & 1, bits >> 3 & 1]]
        grey[:, :, 2] = [[bits >> 4 & 1, bits >> 5 & 1], [bits >> 6 & 1, bits >> 7 & 1]]
        first, second = grey[:, :, :2].sum(), grey[:, :, 1:].sum()
        if first == 3 and second == 6:
            return grey
    raise AssertionError("no such pair among 256")
