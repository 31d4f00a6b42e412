"""Ready-made implementations of the discipline ``curves``: both methods of the reference, and VTK.

Each is a function as the adapters call it (`isograde.disciplines.curves.through_adapter`); that
module's `READY_MADE` names their adapters.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from types import ModuleType
from typing import Any

import isoref.fast.marching_faces
import isoref.fast.surface_intersection
import numpy as np
from isoref.field import Field
from numpy.typing import NDArray

from isograde.disciplines.curves import Extract, through_adapter


def _reference(module: ModuleType) -> Extract:
    """The function of this reference module, in the discipline's signature."""

    def extract_curves(
        a: Any, b: Any, isovalue_a: float, isovalue_b: float, spacing: tuple[float, ...]
    ) -> list[Any]:
        fields = (Field.of(a, spacing), Field.of(b, spacing))
        curves = module.intersection_curves(*fields, (isovalue_a, isovalue_b))
        return [curve.polyline for curve in curves]

    extract_curves.declaration = {"identical": "nothing"}  # type: ignore[attr-defined]
    extract_curves.__name__ = module.__name__.replace(".", ":").replace("_", "-")
    return extract_curves


@dataclass(frozen=True)
class _Grid:
    """The two fields as VTK takes them."""

    a: NDArray[Any]
    b: NDArray[Any]
    spacing: tuple[float, ...]

    def image(self) -> Any:
        """A vtkImageData with point arrays "a" and "b", x fastest."""
        from vtkmodules.util.numpy_support import numpy_to_vtk
        from vtkmodules.vtkCommonDataModel import vtkImageData

        image = vtkImageData()
        image.SetDimensions(*self.a.shape)
        image.SetSpacing(*self.spacing)
        for name, values in (("a", self.a), ("b", self.b)):
            array = numpy_to_vtk(np.asarray(values, np.float64).ravel(order="F"), deep=True)
            array.SetName(name)
            image.GetPointData().AddArray(array)
        image.GetPointData().SetActiveScalars("a")
        return image


def _contour(image: Any, name: str, isovalue: float) -> Any:
    """The filter that makes the isosurface of one of the arrays, in double precision."""
    from vtkmodules.vtkFiltersCore import vtkContourFilter

    surface = vtkContourFilter()
    surface.SetOutputPointsPrecision(1)
    surface.SetInputData(image)
    surface.SetInputArrayToProcess(0, 0, 0, 0, name)
    surface.SetValue(0, isovalue)
    return surface


def _strips(port: Any) -> list[Any]:
    """The segments of this output as polylines, joined by vtkStripper."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersCore import vtkStripper

    strips = vtkStripper()
    strips.SetInputConnection(port)
    strips.SetMaximumLength(1_000_000)
    strips.JoinContiguousSegmentsOn()
    strips.Update()
    output = strips.GetOutput()
    if not output.GetNumberOfLines():
        return []
    points = vtk_to_numpy(output.GetPoints().GetData()).astype(np.float64)
    cells = output.GetLines()
    places = vtk_to_numpy(cells.GetConnectivityArray())
    starts = vtk_to_numpy(cells.GetOffsetsArray())
    return [points[places[i:j]] for i, j in pairwise(starts)]


def vtk_contour_twice(
    a: Any, b: Any, isovalue_a: float, isovalue_b: float, spacing: tuple[float, ...]
) -> list[Any]:
    """VTK's way: contour the first field, contour the second one on that surface, strip."""
    from vtkmodules.vtkFiltersCore import vtkContourFilter

    image = _Grid(np.asarray(a), np.asarray(b), tuple(spacing)).image()
    surface = _contour(image, "a", isovalue_a)  # Keep it: its port does not.
    lines = vtkContourFilter()
    lines.SetOutputPointsPrecision(1)
    lines.SetInputConnection(surface.GetOutputPort())
    lines.SetInputArrayToProcess(0, 0, 0, 0, "b")
    lines.SetValue(0, isovalue_b)
    return _strips(lines.GetOutputPort())


def vtk_contour_and_intersect(
    a: Any, b: Any, isovalue_a: float, isovalue_b: float, spacing: tuple[float, ...]
) -> list[Any]:
    """VTK's other way: contour both fields, intersect the surfaces, strip."""
    from vtkmodules.vtkFiltersGeneral import vtkIntersectionPolyDataFilter

    image = _Grid(np.asarray(a), np.asarray(b), tuple(spacing)).image()
    surfaces = [_contour(image, *one) for one in (("a", isovalue_a), ("b", isovalue_b))]
    for surface in surfaces:
        surface.Update()
        if not surface.GetOutput().GetNumberOfCells():
            return []
    meeting = vtkIntersectionPolyDataFilter()
    for number, surface in enumerate(surfaces):
        meeting.SetInputConnection(number, surface.GetOutputPort())
    meeting.SplitFirstOutputOff()
    meeting.SplitSecondOutputOff()
    return _strips(meeting.GetOutputPort())


def _noted(function: Extract, notes: str) -> Extract:
    """The function, with these words in its declaration."""
    function.declaration = {"notes": notes}  # type: ignore[attr-defined]
    return function


marching_faces = through_adapter(_reference(isoref.fast.marching_faces))
surface_intersection = through_adapter(_reference(isoref.fast.surface_intersection))
vtk = through_adapter(_noted(vtk_contour_twice, "vtkContourFilter twice, vtkStripper"))
vtk_intersect = through_adapter(
    _noted(
        vtk_contour_and_intersect,
        "vtkContourFilter, vtkIntersectionPolyDataFilter, vtkStripper",
    )
)
