"""The discipline ``simplices``: isosurfaces of any dimension and codimension.

An implementation is a function::

    extract_simplices(values, spacing) -> (vertices, simplices)

values      (m, N1, .., Nn) samples of m components, m < n
spacing     n floats; a vertex is ``index * spacing``, in the order of the array's axes
vertices    (V, n) numbers
simplices   (S, n - m + 1) rows of indices into `vertices`, of the set where all components are 0

It goes through the adapters like any other: declare ``{"discipline": "simplices"}`` and name it
``python:my.module:extract_simplices``. Inside, `through_adapter` drops the isovalue, which is
always 0. Programs behind ``exec:`` and folders behind ``dir:`` see `LAYOUT`. To decline a dimension
or a codimension, raise `NotImplementedError`, or answer "unsupported".

Glossary
--------
k           n - m, the dimension of the simplices
facet       a (k-1)-face of a simplex; open where it has one simplex and is not on the border
covered     an open facet that lies on other open facets: two cuts of one face
h           edge of a cell

`cases` are what is asked, `judges` pure functions of a mesh and of what is known, and each of the
`claims` names its judge. How a cell is cut is the implementation's choice, so nothing is said of
counts. What is said of vertices holds for every interpolation that stays between its samples:
Kuhn's, cubes', and others.

References
----------
[1] C. Min, Simplicial isosurfacing in arbitrary dimension and codimension, 2003.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from numpy.typing import NDArray

from isograde.disciplines.polylines import declare
from isograde.disciplines.simplices.cases import cases, pose
from isograde.disciplines.simplices.claims import CLAIMS

__all__ = ["CLAIMS", "LAYOUT", "READY_MADE", "cases", "pose", "through_adapter"]

Extract = Callable[[Any, tuple[float, ...]], Any]

# What a manifest says of requests and answers.
LAYOUT: Mapping[str, str] = {
    "values": "npy in C order, (m, N1, .., Nn): the surface is where all m components are 0",
    "vertices": "origin + index * spacing (V, n), coordinates in the order of the array's axes",
    "faces": "rows of n - m + 1 0-based indices; with the negated gradients before them, the "
    "simplex's edges have a positive determinant",
    "answer": "beside the values, same name: .vertices.npy and .faces.npy",
    "no simplex": "arrays without rows; a missing file counts as unsupported",
}


def through_adapter(function: Extract) -> Callable[[Any, float, tuple[float, ...]], Any]:
    """`function` as the adapters call it, with an isovalue, which is 0 in every case."""

    def extract(values: NDArray[Any], isovalue: float, spacing: tuple[float, ...]) -> Any:
        return function(values - isovalue if isovalue else values, tuple(spacing))

    return declare(extract, function, "simplices")


# Ready-made implementations, by short name.
_METHODS = ("reference", "printed", "skimage", "contourpy", "pymcubes", "libigl", "vtk")
READY_MADE: Mapping[str, str] = {
    f"simplices:{name}": f"python:isograde.adapters.simplex_methods:{name.replace('-', '_')}"
    for name in (*_METHODS, "vtk-tetrahedra")
}
