"""Ready-made implementations of the discipline ``contours``: DICONEX, scikit-image, contourpy.

Each is a function as the adapters call it (`isograde.disciplines.contours.through_adapter`). A
library is loaded only in the worker process that runs it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from isoref.fast.diconex import diconex
from isoref.field import Field
from numpy.typing import NDArray

from isograde.disciplines.contours import Extract, through_adapter
from isograde.disciplines.polylines import Polylines


def _reference(mode: Any) -> Extract:
    """DICONEX in this mode."""

    def extract_contours(values: Any, isovalue: float, spacing: tuple[float, ...]) -> Polylines:
        return diconex(Field.of(values, spacing), isovalue, mode=mode).polygons()

    extract_contours.__name__ = f"isoref:diconex-{mode}"
    return extract_contours


def skimage_find_contours(
    values: Any, isovalue: float, spacing: tuple[float, ...]
) -> list[NDArray[Any]]:
    """`skimage.measure.find_contours`, told to keep high values on the left."""
    from skimage.measure import find_contours

    lines = find_contours(np.asarray(values), isovalue, positive_orientation="high")
    return [line * spacing for line in lines]


def contourpy_serial(
    values: Any, isovalue: float, spacing: tuple[float, ...]
) -> list[NDArray[Any]]:
    """The lines of contourpy's default algorithm.

    Its x is our second axis. To exchange the axes mirrors the plane, so lines are turned round.
    """
    from contourpy import contour_generator

    lines: Any = contour_generator(z=np.asarray(values, np.float64)).lines(isovalue)
    return [line[::-1, ::-1] * spacing for line in lines]


diconex_disconnect = through_adapter(_reference("disconnect"))
diconex_connect = through_adapter(_reference("connect"))
diconex_mixed = through_adapter(_reference("mixed"))
skimage = through_adapter(skimage_find_contours)
contourpy = through_adapter(contourpy_serial)
