"""Polylines through a door: an answer of several (N, d) arrays as one pair of arrays.

The pair is the points of all polylines (V, d), one polyline after the other, and for each point the
number of its polyline (V,) or (V, 1). It takes the places of vertices and faces. Python functions
return a list of arrays, and `stacked` makes the pair; programs and folders give the pair. The
disciplines `contours` and `curves` share it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isograde.model import Outcome, Status

Polylines = list[NDArray[np.float64]]
Pair = tuple[NDArray[np.float64], NDArray[np.int64]]


def stacked(parts: Iterable[ArrayLike], d: int, kind: str) -> Pair:
    """The points of all parts, and the number of each one's part.

    Raises
    ------
    TypeError
        for a part that is not (N, d) or has no point; it is named by `kind` and its number.

    >>> stacked([[[0, 0], [1, 0]], [[2, 2]]], 2, "contour")[1].ravel()
    array([0, 0, 1])
    """
    arrays = [np.asarray(part, np.float64) for part in parts]
    for number, array in enumerate(arrays):
        if array.ndim != 2 or array.shape[1] != d or not len(array):
            raise TypeError(f"{kind} {number} has shape {array.shape}, not (N, {d})")
    owner = np.repeat(np.arange(len(arrays)), [len(array) for array in arrays])
    return np.concatenate([*arrays, np.empty((0, d))]), owner[:, None].astype(np.int64)


def unstacked(outcome: Outcome, d: int) -> Polylines | None:
    """The polylines of an outcome, or None where it holds none that can be judged."""
    points, owner = outcome.vertices, outcome.faces
    if points is None or owner is None or complaint(outcome, d):
        return None
    cuts = np.flatnonzero(np.diff(owner.reshape(-1))) + 1
    return [part.astype(np.float64) for part in np.split(points.reshape(-1, d), cuts) if len(part)]


def complaint(outcome: Outcome, d: int) -> str:
    """Why the outcome holds no polylines in d dimensions; nothing where it does.

    >>> complaint(Outcome(Status.OK, np.zeros((3, 2)), np.zeros((3, 1), int)), 2)
    ''
    """
    points, owner = outcome.vertices, outcome.faces
    if outcome.status is not Status.OK or points is None or owner is None:
        return outcome.detail or "no arrays came back"
    if points.size == owner.size == 0:
        return ""
    if points.ndim != 2 or points.shape[1] != d:
        return f"the points have shape {points.shape}, not (V, {d})"
    if owner.shape not in {(len(points),), (len(points), 1)}:
        return f"the numbers have shape {owner.shape}: one for each of {len(points)} points is due"
    return ""


def declare(
    extract: Callable[..., Any], function: Callable[..., Any], discipline: str
) -> Callable[..., Any]:
    """`extract`, marked as what the doors call for a third party's `function`."""
    extract.adapted = True  # type: ignore[attr-defined]
    extract.declaration = {  # type: ignore[attr-defined]
        "name": getattr(function, "__name__", discipline),
        "discipline": discipline,
    }
    return extract
