"""VTK: its filters from images, of values and of labels, to surfaces, and to curves in them."""

from importlib import import_module
from itertools import permutations

import numpy as np


def surface(values, isovalue, spacing, module, filter_name, widened=True, directions=None):
    """The surface by a filter for values; `widened` types of samples that VTK does not have.

    directions : a row for each axis, the columns of VTK's matrix
    """
    contour = getattr(import_module(f"vtkmodules.{module}"), filter_name)()
    contour.SetValue(0, isovalue)
    contour.ComputeNormalsOff()
    contour.ComputeGradientsOff()
    contour.ComputeScalarsOff()
    data = image([known_to_vtk(values) if widened else values], spacing)
    if directions is not None:
        data.SetDirectionMatrix(*directions.T.ravel().tolist())
    contour.SetInputData(data)
    contour.Update()
    return cells(contour.GetOutput(), 3, 3)


def labels(values, isovalue, spacing, module, filter_name, nets=False):
    """The surface round the label 1 by a filter for labels; `nets` would be smoothed otherwise."""
    contour = getattr(import_module(f"vtkmodules.{module}"), filter_name)()
    contour.SetValue(0, 1)
    if nets:
        contour.SmoothingOff()
        contour.SetOutputMeshTypeToTriangles()
    contour.SetInputData(image([(values >= isovalue).astype(np.uint8)], spacing))
    contour.Update()
    return cells(contour.GetOutput(), 3, 3)


def contour_twice(a, b, isovalue_a, isovalue_b, spacing, widened=True):
    """The curve in which two surfaces meet: the first surface, and a contour on it.

    VTK gives values that it interpolates the type of the samples: `widened` ones are not rounded.
    """
    fields = [field.astype(np.float64) if widened else field for field in (a, b)]
    return contoured(image(fields, spacing), (isovalue_a, isovalue_b), 3)


def contour_intersect(a, b, isovalue_a, isovalue_b, spacing):
    """The curve in which two surfaces meet: both surfaces, and a filter that intersects them."""
    from vtkmodules.vtkFiltersGeneral import vtkIntersectionPolyDataFilter

    both = image([field.astype(np.float64) for field in (a, b)], spacing)
    surfaces = [contour(both, c, level) for c, level in enumerate((isovalue_a, isovalue_b))]
    if not all(one.GetNumberOfCells() for one in surfaces):
        return np.empty((0, 3)), np.empty((0, 2), np.int64)
    meeting = vtkIntersectionPolyDataFilter()
    for number, one in enumerate(surfaces):
        meeting.SetInputData(number, one)
    meeting.SplitFirstOutputOff()
    meeting.SplitSecondOutputOff()
    meeting.Update()
    return cells(meeting.GetOutput(), 3, 2)


def kuhn(values, isovalues, spacing):
    """Level sets on Kuhn's triangles or tetrahedra, by the contour filter once for each field."""
    n = len(spacing)
    fields, levels = (values[None], [isovalues]) if values.ndim == n else (values, isovalues)
    return contoured(simplices(fields.astype(np.float64), spacing), levels, n)


def image(fields, spacing):
    """A vtkImageData whose x is the first axis, with the fields as arrays "0", "1", .."""
    from vtkmodules.vtkCommonDataModel import vtkImageData

    data = vtkImageData()
    data.SetDimensions(fields[0].shape)
    data.SetSpacing(spacing)
    return with_arrays(data, [field.ravel(order="F") for field in fields])


def simplices(fields, spacing):
    """A vtkUnstructuredGrid of Kuhn's simplices, with the fields as arrays "0", "1", .."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import VTK_TETRA, VTK_TRIANGLE, vtkCellArray
    from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid as Grid

    n, shape = len(spacing), fields[0].shape
    rows = kuhn_simplices(shape)
    points, rings, grid = vtkPoints(), vtkCellArray(), Grid()
    places = np.indices(shape).reshape(n, -1).T * np.asarray(spacing)
    points.SetData(numpy_to_vtk(np.pad(places, ((0, 0), (0, 3 - n))), deep=True))
    starts = np.arange(0, rows.size + 1, n + 1)
    rings.SetData(*(numpy_to_vtkIdTypeArray(ids, deep=True) for ids in (starts, rows.ravel())))
    grid.SetPoints(points)
    grid.SetCells(VTK_TRIANGLE if n == 2 else VTK_TETRA, rings)
    return with_arrays(grid, [field.ravel() for field in fields])


def kuhn_simplices(shape):
    """The simplices of all cells along paths from the lowest corner to the highest, (S, n + 1)."""
    n, number = len(shape), np.arange(np.prod(shape)).reshape(shape)
    low = number[(slice(-1),) * n].ravel()
    rows = []
    for order in permutations(range(n)):
        steps = np.cumsum([0, *(number.strides[axis] // number.itemsize for axis in order)])
        if np.linalg.det(np.eye(n)[list(order)]) < 0:
            steps[-2:] = steps[[-1, -2]]
        rows.append(low[:, None] + steps)
    return np.concatenate(rows)


def with_arrays(data, arrays):
    """The data with these point arrays, named "0", "1", ..; the first is the active one."""
    from vtkmodules.util.numpy_support import numpy_to_vtk

    for number, values in enumerate(arrays):
        given = numpy_to_vtk(values, deep=True)
        given.SetName(str(number))
        data.GetPointData().AddArray(given)
    data.GetPointData().SetActiveScalars("0")
    return data


def known_to_vtk(values):
    """The values in a type that VTK has: native, and wider than bool or float16."""
    wider = {"b1": np.uint8, "f2": np.float32}.get(values.dtype.str[1:])
    return values.astype(wider or values.dtype.newbyteorder("="), copy=False)


def contoured(data, isovalues, n):
    """The level set of the data's arrays "0", "1", .. at these isovalues, one after the other."""
    for number, isovalue in enumerate(isovalues):
        data = contour(data, number, isovalue)
    return cells(data, n, n - len(isovalues) + 1)


def contour(data, number, isovalue):
    """The contour of one array, in double precision."""
    from vtkmodules.vtkFiltersCore import vtkContourFilter

    made = vtkContourFilter()
    made.SetInputData(data)
    made.SetInputArrayToProcess(0, 0, 0, 0, str(number))
    made.SetValue(0, isovalue)
    made.SetOutputPointsPrecision(1)
    made.ComputeNormalsOff()
    made.Update()
    return made.GetOutput()


def cells(data, n, corners):
    """The points, and the cells of so many corners; none where there is no cell."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    found = data.GetLines() if corners == 2 else data.GetPolys()
    if not found.GetNumberOfCells():
        return np.empty((0, n)), np.empty((0, corners), np.int64)
    rows = vtk_to_numpy(found.GetConnectivityArray()).reshape(-1, corners)
    return vtk_to_numpy(data.GetPoints().GetData())[:, :n], rows


LIBRARY = {
    "distribution": "vtk",
    "imports": [
        "vtkmodules.util.numpy_support", "vtkmodules.vtkCommonDataModel",
        "vtkmodules.vtkFiltersCore", "vtkmodules.vtkFiltersGeneral",
    ],
}  # fmt: skip
_ANSWERS = {"nan": "answers"}
_WIDENS = "gives bool as uint8, float16 as float32, and a foreign byte order as the native one"
_CONVERTS = "converts samples to float64: on a surface it interpolates in the type of the samples"
_LABELS = "gives it the label 1 where values >= isovalue, else 0"


def _values(filter_name, **more):
    """The row of a filter for values."""
    return {
        "function": "surface",
        "options": {"module": "vtkFiltersCore", "filter_name": filter_name, **more},
        "declaration": {"conventions": _ANSWERS},
        "does": [] if more else [_WIDENS],
    }


def _placed(filter_name):
    """The row of a filter for values that is also given directions and negative spacings."""
    row = _values(filter_name)
    said = {**row["declaration"], "limits": {"directions": True, "negative": True}}
    return {**row, "declaration": {**said, "notes": "given vtkImageData's direction matrix"}}


METHODS = {
    "vtk:marching-cubes": _values("vtkMarchingCubes"),
    "vtk:flying-edges": _values("vtkFlyingEdges3D"),
    "vtk:flying-edges-raw": _values("vtkFlyingEdges3D", widened=False),
    "vtk:contour-filter": _values("vtkContourFilter"),
    "vtk:flying-edges-directions": _placed("vtkFlyingEdges3D"),
    "vtk:contour-filter-directions": _placed("vtkContourFilter"),
    "vtk:discrete-marching-cubes": {
        "function": "labels",
        "options": {"module": "vtkFiltersGeneral", "filter_name": "vtkDiscreteMarchingCubes"},
        "declaration": {"interpolant": "labels", "conventions": _ANSWERS},
        "does": [_LABELS],
    },
    "vtk:surface-nets": {
        "function": "labels",
        "options": {"module": "vtkFiltersCore", "filter_name": "vtkSurfaceNets3D", "nets": True},
        "declaration": {
            "interpolant": "labels",
            "vertices": "cells",
            "domain": {"inset": -0.5, "end": "open"},
            "conventions": _ANSWERS,
            "notes": "not smoothed",
        },
        "does": [_LABELS, "turns smoothing off, and asks for triangles"],
    },
    "vtk:contour-twice": {
        "function": "contour_twice",
        "declaration": {"conventions": _ANSWERS, "limits": {"kinds": [[3, 2]]}},
        "does": [_CONVERTS, "asks for double precision"],
    },
    "vtk:contour-twice-raw": {
        "function": "contour_twice",
        "options": {"widened": False},
        "declaration": {"conventions": _ANSWERS, "limits": {"kinds": [[3, 2]]}},
        "does": ["asks for double precision"],
    },
    "vtk:contour-intersect": {
        "function": "contour_intersect",
        "declaration": {
            "conventions": _ANSWERS,
            "limits": {"kinds": [[3, 2]]},
        },
        "does": [_CONVERTS, "asks for double precision"],
    },
    "vtk:kuhn": {
        "function": "kuhn",
        "declaration": {
            "interpolant": "kuhn",
            "conventions": _ANSWERS,
            "limits": {"kinds": [[2, 1], [3, 1], [3, 2]], "least": 2},
        },
        "does": [
            _CONVERTS,
            "cuts the cells of the lattice into simplices",
            "asks for double precision",
        ],
    },
}
