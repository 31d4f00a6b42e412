"""One cause, one finding: which failures of a case follow from which.

An edge of four triangles makes triangles that cross, and a hole makes vertices where sheets meet:
who is told both, and a third, looks for three faults where there is one. On each case the claims
that fail are put into an order of causes. A failure *follows* from another of the same case where
the table below says that it can, and nothing says that the two are in different places; what
follows from nothing is a *root*. A claim may be a root on some cases and follow on others.

The table is of logic, not of any implementation: what a vertex in a wrong place, a hole, a crowded
edge, a wrong segment must or may spoil further on. Its order is that of the causes, and no claim
follows from a later one.
"""

from __future__ import annotations

from collections.abc import Mapping
from fnmatch import fnmatchcase
from typing import Any

import numpy as np

# What can follow from the failure of a claim; the globs name claims.
FOLLOWS: Mapping[str, tuple[str, ...]] = {
    "structure.shapes": ("structure.no_repeated_index", "structure.all_used"),
    "structure.in_range": ("structure.all_used",),
    "structure.no_repeated_index": ("topology.*", "cells.*", "bodies.*", "structure.with_measure"),
    "robustness.input_unmodified": ("robustness.*", "symmetry.*"),
    "robustness.deterministic": ("robustness.*", "symmetry.*"),
    "geometry.vertices": (
        "geometry.*", "topology.*", "cells.*", "bodies.*", "symmetry.*", "accuracy.*",
        "simplices.*",
    ),
    "topology.closed": (
        "topology.*", "cells.*", "bodies.*", "simplices.*", "geometry.embedded", "symmetry.*",
    ),
    "topology.ties": ("topology.scan",),
    "topology.oriented": ("topology.sides", "bodies.*"),
    "topology.manifold": (
        "geometry.embedded", "structure.no_duplicate", "cells.legal", "cells.count",
        "cells.perfect", "simplices.*",
    ),
    "topology.sides": (
        "cells.*", "topology.bilinear", "topology.trilinear", "topology.scan", "bodies.*",
        "geometry.crossing", "accuracy.*", "symmetry.*",
    ),
    "geometry.crossing": ("bodies.*", "accuracy.*", "geometry.embedded", "symmetry.*"),
    "cells.legal": (
        "cells.*", "topology.bilinear", "topology.trilinear", "topology.scan", "symmetry.*",
    ),
    "cells.count": ("cells.perfect", "topology.trilinear", "topology.scan", "symmetry.*"),
    "topology.bilinear": ("cells.frequencies", "topology.trilinear", "topology.scan"),
    "topology.trilinear": ("topology.scan",),
    "bodies.pieces": ("bodies.*",),
    "bodies.holes": ("bodies.offset", "bodies.distance", "bodies.centroid", "bodies.degree"),
    "bodies.centroid": ("bodies.distance", "bodies.offset", "accuracy.*"),
    "bodies.offset": ("bodies.distance", "bodies.degree", "accuracy.*"),
    "bodies.distance": ("accuracy.*",),
    "structure.apart": ("structure.with_measure", "topology.raw", "cells.perfect"),
}  # fmt: skip
ORDER = tuple(FOLLOWS)
# Two findings with few faults each are of different places where these are so many cells apart.
FEW, FAR = 4, 1.0
COUNTS = ("boundary_facets", "facets", "wrong", "pairs", "count", "wrong_faces", "faces")


def can_follow(claim: str, cause: str) -> bool:
    """Whether a failure of the claim can follow from one of the other, which is its cause.

    A claim never follows from one that comes after it in the table.
    """
    if claim == cause or not any(fnmatchcase(claim, glob) for glob in FOLLOWS.get(cause, ())):
        return False
    return claim not in FOLLOWS or ORDER.index(claim) > ORDER.index(cause)


def roots(failed: Mapping[str, Mapping[str, Any]]) -> dict[str, str]:
    """For each claim that fails on a case, the claim that it comes from in the end, or itself.

    failed : the numbers of each finding, by claim

    >>> four = {"first": [[1, 0, 0], [1, 1, 0]], "facets": 1}
    >>> roots({"geometry.embedded": {}, "topology.manifold": four, "robustness.dtype": {}})
    {'geometry.embedded': 'topology.manifold', 'topology.manifold': 'topology.manifold', \
'robustness.dtype': 'robustness.dtype'}
    """
    found: dict[str, str] = {}

    def root(claim: str) -> str:
        if claim not in found:
            causes = (
                one
                for one in ORDER
                if one in failed
                and can_follow(claim, one)
                and not apart(failed[one], failed[claim])
            )
            cause = next(causes, None)
            found[claim] = claim if cause is None else root(cause)
        return found[claim]

    return {claim: root(claim) for claim in failed}


def apart(one: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    """Two findings name few faults each, in places too far apart to be one.

    Of many faults only the first is named, and the first of one kind need not be that of another.
    """
    mine, others = box(one), box(other)
    if mine is None or others is None or mine.shape != others.shape:
        return False
    if any(_count(numbers) > FEW for numbers in (one, other)):
        return False
    (low, high), (start, stop) = mine, others
    return bool(np.maximum(start - high, low - stop).max() > FAR)


def box(numbers: Mapping[str, Any]) -> np.ndarray[Any, np.dtype[np.float64]] | None:
    """(2, n) the least and the greatest index coordinates of what a finding names, or None."""
    for name in ("first", "at", "cell", "sample"):
        try:
            points = np.asarray(numbers[name], np.float64)
        except (KeyError, TypeError, ValueError):
            continue
        if not points.size or not points.ndim:
            continue
        points = points.reshape(-1, points.shape[-1])
        return np.stack([points.min(axis=0), points.max(axis=0) + (name == "cell")])
    return None


def _count(numbers: Mapping[str, Any]) -> int:
    """How many faults a finding has seen; many where it does not say."""
    counts = [numbers[name] for name in COUNTS if isinstance(numbers.get(name), int)]
    return int(counts[0]) if counts else FEW + 1
