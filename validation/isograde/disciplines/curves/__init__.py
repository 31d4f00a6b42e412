"""The discipline ``curves``: where the isosurfaces of two fields on one lattice meet.

An implementation is a function::

    extract_curves(values_a, values_b, isovalue_a, isovalue_b, spacing) -> list of (N, 3) arrays

values      two arrays of one shape (N1, N2, N3)
spacing     three floats; a point is ``index * spacing``, in the order of the arrays' axes
answer      one array a curve, its points in order; a closed curve repeats its first point

It goes through the adapters like any other: declare ``{"discipline": "curves"}`` and name it
``python:my.module:extract_curves``. Inside, `through_adapter` makes of it a function of one array
(the fields stacked) that answers with arrays of points and curve numbers. Programs behind ``exec:``
and folders behind ``dir:`` get and give these arrays as they stand: `LAYOUT` says how.

Glossary
--------
h           the longest edge of a cell
M           the largest second derivatives of a function near a known curve
whole       closed, or with both ends on the border of the lattice

`cases` are what is asked, `judges` pure functions of a list of arrays and of what is known, and
each of the `claims` names its judge. A case whose surfaces touch is judged by what holds however
the curves are joined there. Where both surfaces are the same, any list of curves is an answer,
unless the declaration says ``{"identical": "nothing"}``: then it is judged by that.

References
----------
[1] P. Ljung, A. Ynnerman, Extraction of intersection curves from iso-surfaces on co-located 3D
    grids.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from numpy.typing import NDArray

from isograde.disciplines.curves.cases import cases, known_curves, pose
from isograde.disciplines.curves.claims import CLAIMS
from isograde.disciplines.polylines import declare, stacked

__all__ = ["CLAIMS", "LAYOUT", "READY_MADE", "cases", "known_curves", "pose", "through_adapter"]

Extract = Callable[[Any, Any, float, float, tuple[float, ...]], Sequence[Any]]

# What a manifest says of requests and answers.
LAYOUT: Mapping[str, str] = {
    "values": "npy in C order, (2, N1, N2, N3): the first field, then the second; where the "
    "second isovalue differs from the first, (3, N1, N2, N3): the third holds nothing but it",
    "vertices": "origin + index * spacing (V, 3): all points, one curve after the other; a closed "
    "curve repeats its first point",
    "faces": "for each point the number of its curve, (V,) or (V, 1)",
    "answer": "beside the values, same name: .vertices.npy and .faces.npy",
    "no curve": "arrays without points; a missing file counts as unsupported",
}


def through_adapter(function: Extract) -> Callable[[Any, float, tuple[float, ...]], Any]:
    """`function` as the adapters call it: stacked values (2, N1, N2, N3), one isovalue, spacing.

    Where the second isovalue differs, a third array (N1, N2, N3) holds nothing but it.
    It answers with the points of all curves (V, 3) and, for each, the number of its curve (V, 1).
    """

    def extract(
        values: NDArray[Any], isovalue: float, spacing: tuple[float, ...]
    ) -> tuple[NDArray[Any], NDArray[Any]]:
        second = float(values[2].flat[0]) if len(values) == 3 else isovalue
        answer = function(values[0], values[1], isovalue, second, tuple(spacing))
        return stacked(answer, 3, "curve")

    return declare(extract, function, "curves")


# Short names of the implementations in `isograde.adapters.curve_methods`.
READY_MADE: Mapping[str, str] = {
    f"curves:{name.replace('_', '-')}": f"python:isograde.adapters.curve_methods:{name}"
    for name in ("marching_faces", "surface_intersection", "vtk", "vtk_intersect")
}
