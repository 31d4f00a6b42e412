"""Ready-made implementations of ``simplices``: the reference, scikit-image, contourpy.

Each is a function as the doors call it (`isograde.disciplines.simplicial.through_door`). A library
is loaded only in the worker process that runs it.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from isoref.field import Field
from isoref.simplicial import extract as reference_extract

from isograde.disciplines.simplicial import through_door


def isoref_simplices(values: Any, spacing: tuple[float, ...], rule: str = "staircase") -> Any:
    """The reference, `isoref.simplicial.extract`."""
    mesh = reference_extract(Field.of(values, spacing, dimension=len(spacing)), rule=rule)
    return mesh.vertices, mesh.simplices


def isoref_printed_tables(values: Any, spacing: tuple[float, ...]) -> Any:
    """The reference with Min's Tables 1 to 4 as printed."""
    return isoref_simplices(values, spacing, "printed")


def skimage_measure(values: Any, spacing: tuple[float, ...]) -> Any:
    """scikit-image, for one component in the plane or in space."""
    from skimage.measure import find_contours, marching_cubes

    if len(values) != 1 or values.ndim not in (3, 4):
        raise NotImplementedError("scikit-image has one component in the plane or in space")
    if values.ndim == 3:
        return _polylines(find_contours(values[0], 0.0, positive_orientation="high"), spacing)
    if values.min() >= 0 or values.max() <= 0:
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    return marching_cubes(values[0], 0.0, spacing=spacing, gradient_direction="ascent")[:2]


def contourpy_lines(values: Any, spacing: tuple[float, ...]) -> Any:
    """contourpy, for one component in the plane."""
    from contourpy import contour_generator

    if len(values) != 1 or values.ndim != 3:
        raise NotImplementedError("contourpy has one component in the plane")
    # Its x runs along the second axis of the array; exchanging axes turns the lines about.
    lines = contour_generator(z=values[0]).lines(0.0)
    return _polylines([np.asarray(line)[::-1, ::-1] for line in lines], spacing)


def _polylines(lines: Iterable[Any], spacing: tuple[float, ...]) -> Any:
    """Shared points and segments of polylines that repeat their first point where they close."""
    points, segments, start = [np.empty((0, 2))], [np.empty((0, 2), np.int64)], 0
    for line in lines:
        ring = len(line) > 2 and bool((line[0] == line[-1]).all())
        count = len(line) - ring
        follow = np.arange(count if ring else count - 1)
        segments.append(start + np.stack([follow, (follow + 1) % count], axis=1))
        points.append(line[:count])
        start += count
    return np.concatenate(points) * spacing, np.concatenate(segments)


reference = through_door(isoref_simplices)
printed = through_door(isoref_printed_tables)
skimage = through_door(skimage_measure)
contourpy = through_door(contourpy_lines)
