"""Ready-made implementations of ``simplices``: the reference, and the libraries people use.

Each is a function as the adapters call it (`isograde.disciplines.simplices.through_adapter`). A
library is loaded only in the worker process that runs it, and declines every kind (n, m) it has no
answer for::

    kind      a contour (2, 1)     a surface (3, 1)     a curve (3, 2)
    skimage   find_contours        marching_cubes
    vtk                            vtkContourFilter     the filter, twice
    vtk-tetrahedra   the filter on Kuhn's simplices, m times over
    pymcubes                       marching_cubes
    libigl    isolines             marching_cubes
    contourpy lines

VTK's filter gives lines of an image in the plane no direction; it does so for lines of triangles.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import wraps
from typing import Any

import numpy as np
from isoref.fast.simplicial import extract as reference_extract
from isoref.field import Field
from isoref.kuhn import lattice_simplices

from isograde.disciplines.simplices import Extract, through_adapter

Spacing = tuple[float, ...]


def answers(*kinds: tuple[int, int]) -> Callable[[Extract], Extract]:
    """A function that answers these kinds (n, m) and declines all others."""

    def decorate(function: Extract) -> Extract:
        @wraps(function)
        def extract(values: Any, spacing: Spacing) -> Any:
            kind = (len(spacing), len(values))
            if kind not in kinds:
                listed = ", ".join(map(str, kinds))
                raise NotImplementedError(f"(n, m) = {kind}; it answers {listed}")
            return function(values, spacing)

        return extract

    return decorate


def isoref_simplices(values: Any, spacing: Spacing, rule: str = "staircase") -> Any:
    """The reference, `isoref.simplicial.extract`."""
    mesh = reference_extract(Field.of(values, spacing, dimension=len(spacing)), rule=rule)
    return mesh.vertices, mesh.simplices


def isoref_printed_tables(values: Any, spacing: Spacing) -> Any:
    """The reference with Min's Tables 1 to 4 as printed."""
    return isoref_simplices(values, spacing, "printed")


@answers((2, 1), (3, 1))
def skimage_measure(values: Any, spacing: Spacing) -> Any:
    """scikit-image: contours in the plane, marching cubes in space."""
    from skimage.measure import find_contours, marching_cubes

    if len(spacing) == 2:
        return _polylines(find_contours(values[0], 0.0, positive_orientation="high"), spacing)
    if values.min() >= 0 or values.max() <= 0:
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    return marching_cubes(values[0], 0.0, spacing=spacing, gradient_direction="ascent")[:2]


@answers((2, 1))
def contourpy_lines(values: Any, spacing: Spacing) -> Any:
    """Contourpy. Its x runs along the second axis of the array; to exchange axes turns lines."""
    from contourpy import contour_generator

    lines = contour_generator(z=values[0]).lines(0.0)
    return _polylines([np.asarray(line)[::-1, ::-1] for line in lines], spacing)


def _polylines(lines: Iterable[Any], spacing: Spacing) -> Any:
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


@answers((3, 1))
def pymcubes_marching_cubes(values: Any, spacing: Spacing) -> Any:
    """PyMCubes, which knows no spacing."""
    import mcubes

    vertices, triangles = mcubes.marching_cubes(values[0], 0.0)
    return vertices * spacing, triangles


@answers((2, 1), (3, 1))
def libigl_isolines_and_cubes(values: Any, spacing: Spacing) -> Any:
    """libigl: isolines of Kuhn's triangles, marching cubes with the first axis fastest."""
    import igl

    if len(spacing) == 2:
        points, rows = kuhn_simplices(values.shape[1:], spacing)
        return igl.isolines(points, rows, values[0].ravel().astype(np.float64), np.zeros(1))[:2]
    places = np.indices(values.shape[1:]).reshape(3, *values.shape[1:])
    points = np.stack([axis.ravel(order="F") for axis in places], axis=1) * np.asarray(spacing)
    samples = values[0].ravel(order="F").astype(np.float64)
    vertices, triangles = igl.marching_cubes(samples, points, *values.shape[1:], 0.0)[:2]
    # Its normals point to higher values.
    return vertices, triangles[:, ::-1]


@answers((3, 1), (3, 2))
def vtk_images(values: Any, spacing: Spacing) -> Any:
    """VTK's contour filter on an image; for a second component, on the surface of the first."""
    from vtkmodules.vtkCommonDataModel import vtkImageData

    image = vtkImageData()
    image.SetDimensions(*values.shape[1:])
    image.SetSpacing(*spacing)
    _give_components(image, [component.ravel(order="F") for component in values])
    image.GetPointData().SetActiveScalars("phi 0")
    return _contoured(image, values, spacing)


@answers((2, 1), (3, 1), (3, 2))
def vtk_kuhn(values: Any, spacing: Spacing) -> Any:
    """VTK's contour filter on Kuhn's triangles or tetrahedra, once for each component."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import VTK_TETRA, VTK_TRIANGLE, vtkCellArray
    from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid as Grid

    places, rows = kuhn_simplices(values.shape[1:], spacing)
    points, cells, grid = vtkPoints(), vtkCellArray(), Grid()
    in_space = np.pad(places, ((0, 0), (0, 3 - len(spacing))))
    points.SetData(numpy_to_vtk(in_space, deep=True))
    starts = np.arange(0, rows.size + 1, rows.shape[1])
    ids = [numpy_to_vtkIdTypeArray(part, deep=True) for part in (starts, rows.ravel())]
    cells.SetData(*ids)
    grid.SetPoints(points)
    grid.SetCells(VTK_TRIANGLE if len(spacing) == 2 else VTK_TETRA, cells)
    _give_components(grid, [component.ravel() for component in values])
    return _contoured(grid, values, spacing)


def kuhn_simplices(shape: tuple[int, ...], spacing: Spacing) -> Any:
    """The points of a lattice and all its simplices, each turned to be positively oriented."""
    rows, signs = lattice_simplices(shape)
    rows[signs < 0, -2:] = rows[signs < 0, -2:][:, ::-1]
    return np.indices(shape).reshape(len(shape), -1).T * np.asarray(spacing), rows


def _give_components(data: Any, components: list[Any]) -> None:
    """Component c as the point array "phi c", in double precision."""
    from vtkmodules.util.numpy_support import numpy_to_vtk

    for c, component in enumerate(components):
        array = numpy_to_vtk(component.astype(np.float64), deep=True)
        array.SetName(f"phi {c}")
        data.GetPointData().AddArray(array)


def _contoured(data: Any, values: Any, spacing: Spacing) -> Any:
    """The points and simplices of the data where all its components are 0."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersCore import vtkContourFilter

    n, m = len(spacing), len(values)
    for c in range(m):
        contour = vtkContourFilter()
        contour.SetInputData(data)
        contour.SetInputArrayToProcess(0, 0, 0, 0, f"phi {c}")
        contour.SetValue(0, 0.0)
        contour.SetOutputPointsPrecision(1)
        contour.ComputeNormalsOff()
        contour.Update()
        data = contour.GetOutput()
    cells = data.GetLines() if n - m == 1 else data.GetPolys()
    if not cells.GetNumberOfCells():
        return np.empty((0, n)), np.empty((0, n - m + 1), np.int64)
    rows = vtk_to_numpy(cells.GetConnectivityArray()).reshape(-1, n - m + 1)
    return vtk_to_numpy(data.GetPoints().GetData())[:, :n], rows


reference = through_adapter(isoref_simplices)
printed = through_adapter(isoref_printed_tables)
skimage = through_adapter(skimage_measure)
contourpy = through_adapter(contourpy_lines)
pymcubes = through_adapter(pymcubes_marching_cubes)
libigl = through_adapter(libigl_isolines_and_cubes)
vtk = through_adapter(vtk_images)
vtk_tetrahedra = through_adapter(vtk_kuhn)
