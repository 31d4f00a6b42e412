"""Polylines through an adapter: an answer of several (N, d) arrays as one pair of arrays.

The pair is the points of all polylines (V, d), one polyline after the other, and for each point the
number of its polyline (V,) or (V, 1). It takes the places of vertices and faces. Python functions
return a list of arrays, and `stacked` makes the pair; programs and folders give the pair. The
disciplines `contours` and `curves` share it, and what is right for polylines of either kind.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isograde.claims.evidence import VERDICT_OF, failed, passed
from isograde.model import Finding, Outcome, Status, Trial, Verdict

Polylines = list[NDArray[np.float64]]
Pair = tuple[NDArray[np.float64], NDArray[np.int64]]
Point = NDArray[np.float64]

# An end counts as on the border within this share of the extent of the lattice: single precision.
ROUNDING = 1e-6


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
    """`extract`, marked as what the adapters call for a third party's `function`."""
    extract.adapted = True  # type: ignore[attr-defined]
    extract.declaration = {  # type: ignore[attr-defined]
        "name": getattr(function, "__name__", discipline),
        **getattr(function, "declaration", {}),
        "discipline": discipline,
    }
    return extract


def judged(
    name: str,
    judge: Callable[[Polylines, Trial], Finding],
    read: Callable[[Trial], Polylines | None],
    d: int,
    kind: str,
    variants: Iterable[str] = (),
) -> Callable[[Trial], Finding]:
    """`judge`, for polylines that `read` finds in a trial and that are well formed.

    Otherwise the finding says which call failed, the plain one or a variant's, and how; where the
    polylines are not well formed, only the claim of this name fails.
    """

    def decide(trial: Trial) -> Finding:
        for way in ("plain", *variants):
            outcome = trial.outcomes[way]
            why = complaint(outcome, d)
            if why:
                detail = why if way == "plain" else f"{way}: {why}"
                return Finding(VERDICT_OF.get(outcome.status, Verdict.FAIL), detail)
        parts = read(trial) or []
        if name != "well-formed" and well_formed(parts, kind).verdict is Verdict.FAIL:
            return Finding(Verdict.NOT_RUN, f"the {kind}s are not well formed")
        return judge(parts, trial)

    return decide


def is_closed(part: Point) -> bool:
    """Whether the polyline ends where it began."""
    return len(part) > 1 and bool((part[0] == part[-1]).all())


def well_formed(parts: Polylines, kind: str) -> Finding:
    """Every polyline has at least two points, all of them finite."""
    for number, part in enumerate(parts):
        if len(part) < 2:
            return failed(f"{kind} {number} has {len(part)} point", part=number)
        if not np.isfinite(part).all():
            return failed(f"{kind} {number} has a coordinate that is not finite", part=number)
    return passed(parts=len(parts))


def nothing(parts: Polylines, kind: str) -> Finding:
    """There is no polyline."""
    return failed(f"{len(parts)} {kind}s where there is none") if parts else passed()


def whole(parts: Polylines, low: Point, high: Point, kind: str) -> Finding:
    """Every polyline is closed or has both ends on the border of the box from `low` to `high`."""
    near = ROUNDING * float((high - low).max())
    for number, part in enumerate(parts):
        for end in part[:0] if is_closed(part) else part[[0, -1]]:
            if min(np.abs(end - low).min(), np.abs(end - high).min()) > near:
                at = end.round(6).tolist()
                return failed(f"{kind} {number} ends inside, at {at}", part=number, at=at)
    return passed(closed=sum(map(is_closed, parts)))


def no_point_twice(parts: Polylines) -> Finding:
    """No two points are equal, but for the last point of a closed polyline."""
    points = [part[:-1] if is_closed(part) else part for part in parts]
    if not points:
        return passed(points=0)
    places, times = np.unique(np.concatenate(points) + 0.0, axis=0, return_counts=True)
    if (times > 1).any():
        at, repeated = places[times.argmax()].tolist(), int((times > 1).sum())
        return failed(f"{repeated} points come twice, such as {at}", points=repeated, at=at)
    return passed(points=len(places))


def count(parts: Polylines, known: Mapping[str, Any]) -> Finding:
    """As many closed and open polylines as are known."""
    closed = sum(map(is_closed, parts))
    found = {"closed": closed, "open": len(parts) - closed}
    expected = {kind: known[kind] for kind in ("closed", "open")}
    if found != expected:
        return failed(f"{found}, where there are {expected}", found=found, expected=expected)
    return passed(**found)
