"""VTK: filters that have no ready-made name, and another default."""

from importlib import import_module

import numpy as np


def surface(values, isovalue, spacing, module, filter_name):
    """The surface of an image by a filter for values."""
    contour = getattr(import_module(f"vtkmodules.{module}"), filter_name)()
    contour.SetValue(0, isovalue)
    contour.SetInputData(image(known(values), spacing))
    contour.Update()
    return arrays(contour.GetOutput())


def nets(values, isovalue, spacing):
    """The surface round the label 1, smoothed as it is by default."""
    from vtkmodules.vtkFiltersCore import vtkSurfaceNets3D

    contour = vtkSurfaceNets3D()
    contour.SetValue(0, 1)
    contour.SetOutputMeshTypeToTriangles()
    contour.SetInputData(image(np.asarray(values >= isovalue, np.uint8), spacing))
    contour.Update()
    return arrays(contour.GetOutput())


def image(values, spacing):
    """An image whose first axis is the array's."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData

    data = vtkImageData()
    data.SetDimensions(values.shape)
    data.SetSpacing(spacing)
    data.GetPointData().SetScalars(numpy_to_vtk(values.ravel(order="F"), deep=True))
    return data


def known(values):
    """The values in a type that VTK has."""
    wider = {"b1": np.uint8, "f2": np.float32}.get(values.dtype.str[1:])
    return values.astype(wider or values.dtype.newbyteorder("="), copy=False)


def arrays(mesh):
    """Vertices and triangles."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    polygons = mesh.GetPolys()
    if not polygons.GetNumberOfCells():
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    corners = vtk_to_numpy(polygons.GetConnectivityArray()).reshape(-1, 3)
    return vtk_to_numpy(mesh.GetPoints().GetData()), corners
