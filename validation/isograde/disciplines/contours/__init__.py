"""The discipline ``contours``: where a field on a 2-D lattice takes a value.

An implementation is a function::

    extract_contours(values, isovalue, spacing) -> list of (N, 2) arrays

values      one array (N1, N2)
spacing     two floats; a point is ``index * spacing``, in the order of the array's axes
answer      one array a contour, its points in order; a closed contour repeats its first point;
            the inside, value >= isovalue, lies on the left when axis 0 points right and axis 1 up

It goes through the adapters like any other: declare ``{"discipline": "contours"}`` and name it
``python:my.module:extract_contours``. Inside, `through_adapter` makes of it a function that answers
with arrays of points and contour numbers. Programs behind ``exec:`` and folders behind ``dir:``
give these arrays as they stand: `LAYOUT` says how.

`cases` are what is asked, `judges` pure functions of contours in index coordinates, and each of the
`claims` names its judge.

The four rules for an ambiguous square, whose inside corners are opposite ones: *separate* them,
*join* them, join them where the *mean* of the four samples is inside (Schlei), or where the
*saddle* of the bilinear interpolant is (Nielson & Hamann). Each is right; to follow none of them
throughout is not.

References
----------
[1] B. R. Schlei, Volume-enclosing surface extraction, section II.A and Fig. 1.
[2] G. M. Nielson, B. Hamann, The asymptotic decider, section 2.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from numpy.typing import NDArray

from isograde.disciplines.contours.cases import cases, pose
from isograde.disciplines.contours.claims import CLAIMS
from isograde.disciplines.polylines import declare, stacked

__all__ = ["CLAIMS", "LAYOUT", "READY_MADE", "cases", "pose", "through_adapter"]

Extract = Callable[[Any, float, tuple[float, ...]], Sequence[Any]]

# What a manifest says of requests and answers.
LAYOUT: Mapping[str, str] = {
    "values": "npy in C order, (N1, N2)",
    "inside": "value >= isovalue, on the left of a contour when axis 0 points right and axis 1 up",
    "vertices": "origin + index * spacing (V, 2): all points, one contour after the other; a "
    "closed contour repeats its first point",
    "faces": "for each point the number of its contour, (V,) or (V, 1)",
    "answer": "beside the values, same name: .vertices.npy and .faces.npy",
    "no contour": "arrays without points; a missing file counts as unsupported",
}


def through_adapter(function: Extract) -> Callable[[Any, float, tuple[float, ...]], Any]:
    """`function` as the adapters call it.

    It answers with the points of all contours (V, 2) and, for each, its contour's number (V, 1).
    """

    def extract(
        values: NDArray[Any], isovalue: float, spacing: tuple[float, ...]
    ) -> tuple[NDArray[Any], NDArray[Any]]:
        return stacked(function(values, isovalue, tuple(spacing)), 2, "contour")

    return declare(extract, function, "contours")


# Ready-made implementations, by short name.
READY_MADE: Mapping[str, str] = {
    f"contours:{name.replace('_', '-')}": f"python:isograde.adapters.contour_methods:{name}"
    for name in ("diconex_disconnect", "diconex_connect", "diconex_mixed", "skimage", "contourpy")
}
