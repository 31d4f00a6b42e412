"""VTK's `vtkFlyingEdges3D`, made of isoref: a vtkImageData goes in, a vtkPolyData comes out."""

import numpy as np
from isoref import Field, attributes
from isoref.methods import surface
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData


class FlyingEdges3D:
    """The calls of a contour filter that a pipeline makes, for the image's active scalars."""

    method = "marching-vesta-disconnect-L"  # VTK's case table; "asymptotic-decider" knows better

    def __init__(self):
        self.values, self.normals, self.output = {}, True, None

    def SetInputData(self, image):
        """Take the image: x is fastest in VTK, so the axes of its array are (z, y, x)."""
        shape, first = image.GetDimensions()[::-1], np.array(image.GetExtent()[::2])
        turn = np.reshape(image.GetDirectionMatrix().GetData(), (3, 3))
        affine = np.eye(4)
        affine[:3, :3] = turn * image.GetSpacing()
        affine[:3, 3] = image.GetOrigin() + affine[:3, :3] @ first
        samples = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(shape)
        self.field = Field.of_affine(samples, affine[:, [2, 1, 0, 3]])

    def SetValue(self, number, value):
        """Draw this isovalue too."""
        self.values[number] = value

    def SetComputeNormals(self, wanted):
        """Say whether points get normals."""
        self.normals = bool(wanted)

    def Update(self):
        """Draw, one isovalue after the other."""
        levels = self.values.values()
        meshes = [surface(self.field, level, self.method, provenance=True) for level in levels]
        starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
        rows = [mesh.simplices + start for mesh, start in zip(meshes, starts, strict=False)]
        places = np.concatenate([mesh.vertices for mesh in meshes]).astype("f4")
        self.output, points, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
        points.SetData(numpy_to_vtk(places, deep=1))
        cells.SetData(3, numpy_to_vtkIdTypeArray(np.concatenate(rows).ravel(), deep=1))
        self.output.SetPoints(points)
        self.output.SetPolys(cells)
        if self.normals:
            found = np.concatenate([attributes.normals(mesh) for mesh in meshes]).astype("f4")
            array = numpy_to_vtk(found, deep=1)
            array.SetName("Normals")
            self.output.GetPointData().SetNormals(array)

    def GetOutput(self):
        """The surface."""
        return self.output
