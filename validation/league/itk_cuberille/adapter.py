"""itk-cuberille: the faces of voxels, which are then moved to the isosurface.

ITK loads a module when a name of it is first asked for: here, not in the first call.
"""

import itk
import numpy as np

# The filter for this type of image, the one of three axes and single precision.
(FILTER,) = (
    itk.CuberilleImageToMeshFilter[key]
    for key in itk.CuberilleImageToMeshFilter
    if key[0] is itk.Image[itk.F, 3]
)


def surface(values, isovalue, spacing, project):
    """The triangles; ITK's first axis is fastest."""
    # What makes an image of an array takes one of a single row for one in Fortran's order.
    image = itk.Image[itk.F, 3].New()
    image.SetRegions(list(values.shape))
    image.Allocate()
    itk.array_view_from_image(image)[:] = values.transpose(2, 1, 0)
    image.SetSpacing(spacing)
    source = FILTER.New()
    source.SetInput(image)
    source.SetIsoSurfaceValue(isovalue)
    source.SetGenerateTriangleFaces(True)
    source.SetProjectVerticesToIsoSurface(project)
    source.Update()
    found = source.GetOutput()
    count = found.GetNumberOfCells()
    if not count:
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    # Each cell is its kind, the number of its corners, and these.
    cells = itk.array_from_vector_container(found.GetCellsArray()).reshape(count, -1)
    return itk.array_from_vector_container(found.GetPoints()), cells[:, 2:]
