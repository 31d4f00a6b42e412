"""Whether a surface reaches from end to end: left out layers, padding, seams between blocks.

A wavy sheet runs along a row of `LONG` cells and through all of the other axes. It crosses every
layer of cells, so that its extent shows where it ends, and an edge of one triangle away from the
ends is a seam.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from isoref.field import Field, Floats, Integers

from isograde.checking.checked import Advice
from isograde.checking.sentences import open_inside, scaled
from isograde.model import SURFACES, Outcome, Verdict

Answer = Callable[[Field, tuple[float, ...]], Outcome]
# Longer than the blocks in which volumes are usually cut: 8, 16, 32, 64.
LONG, SHORT = 66, 4
NEAR = 1e-3


@dataclass(frozen=True)
class Span:
    """Where the sheet along one axis begins and ends, in samples, and where it is open inside."""

    axis: int
    low: float
    high: float
    last: float
    seams: tuple[float, ...]


def spans(answer: Answer, *, soup: bool = False, border: float = 0.0) -> list[Span]:
    """The spans along each axis that were answered with a mesh.

    Of a soup, vertices at one place are one; the surface may end within `border` cells of its end.
    """
    found = []
    for axis in range(3):
        field = sheet(axis)
        mesh = answer(field, (0.0,)).mesh_of(SURFACES)
        if mesh is None or not len(mesh.simplices):
            continue
        points, rows = mesh.vertices, mesh.simplices
        if soup:
            points, rows = welded(points, rows)
        low, high = points[np.unique(rows)].min(0), points[np.unique(rows)].max(0)
        seams = _seams(points, rows, low, high, axis, border)
        last = field.shape[axis] - 1
        found.append(Span(axis, float(low[axis]), float(high[axis]), last, seams))
    return found


def sheet(axis: int) -> Field:
    """The field whose level set at 0 is a sheet that runs along this axis, from end to end."""
    shape = [SHORT] * 3
    shape[axis] = LONG
    places = np.indices(shape, dtype=float)
    across = places[(axis + 1) % 3]
    waves = 0.37 * np.sin(0.9 * places[axis] + 0.3) + 0.21 * np.cos(1.7 * places[(axis + 2) % 3])
    return Field.of(across - 1.53 - waves)


def welded(points: Floats, rows: Integers) -> tuple[Floats, Integers]:
    """The mesh with vertices at one place made one."""
    places, where = np.unique(points.round(5), axis=0, return_inverse=True)
    return places, where.reshape(-1)[rows]


def _seams(
    points: Floats, rows: Integers, low: Floats, high: Floats, axis: int, border: float
) -> tuple[float, ...]:
    """Where along the axis edges of one triangle are, away from the ends of the surface."""
    edges = np.sort(np.concatenate([rows[:, [0, 1]], rows[:, [1, 2]], rows[:, [0, 2]]]), axis=1)
    unique, uses = np.unique(edges, axis=0, return_counts=True)
    once = points[unique[uses == 1]]
    at_end = [
        (np.abs(once[:, :, k] - end[k]) < border + NEAR).all(axis=1)
        for k in range(3)
        for end in (low, high)
    ]
    inner = once[~np.any(at_end, axis=0)]
    return tuple(sorted({round(float(x), 1) for x in inner.mean(axis=1)[:, axis]}))


def stretch(found: list[Span]) -> str:
    """The mistake by which every coordinate is scaled, where all sheets show it, or nothing."""
    if not found:
        return ""
    for up in (True, False):
        ends = []
        for span in found:
            scale = ((span.last + 1) / span.last) ** (1 if up else -1)
            ends.append(abs(span.high - span.last * scale) + abs(span.low))
        if max(ends) < NEAR:
            return f"vertices are {scaled(up=up)}"
    return ""


def spans_told(found: list[Span]) -> Iterator[Advice]:
    """What is wrong with where sheets end, and where they are open."""
    for span in found:
        low, high = span.low, span.last - span.high
        if abs(low - high) > 0.4:
            end = "last" if high > low else "first"
            layers = abs(high - low)
            yield (
                Verdict.FAIL,
                f"the surface ends {layers:.2g} cells short at the {end} layer along axis "
                f"{span.axis}: it reaches from {span.low:.2f} to {span.high:.2f} of 0 to "
                f"{span.last:g}; does the loop leave out a layer of cells?",
            )
        if span.seams:
            yield Verdict.FAIL, open_inside(span.axis, span.seams)


def inset(found: list[Span]) -> float | None:
    """The distance of the surface's ends from the first and last samples, where it is one."""
    ends = [end for span in found for end in (span.low, span.last - span.high)]
    if not ends or np.ptp(ends) > NEAR:
        return None
    return round(float(np.mean(ends)), 3) + 0.0
