"""ITK: `BinaryMask3DMeshSource`, a surface round a label.

ITK loads a module when a name of it is first asked for: here, not in the first call.
"""

import itk
import numpy as np

FILTER = itk.BinaryMask3DMeshSource[itk.Image[itk.UC, 3], itk.Mesh[itk.D, 3]]


def surface(values, isovalue, spacing):
    """The surface round the label 1; ITK's first axis is fastest."""
    # What makes an image of an array takes one of a single row for one in Fortran's order.
    image = itk.Image[itk.UC, 3].New()
    image.SetRegions(list(values.shape))
    image.Allocate()
    itk.array_view_from_image(image)[:] = (values >= isovalue).transpose(2, 1, 0)
    image.SetSpacing(spacing)
    source = FILTER.New()
    source.SetObjectValue(1)
    source.SetInput(image)
    source.Update()
    mesh = source.GetOutput()
    count = mesh.GetNumberOfCells()
    if not count:
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    # Each cell is its kind, the number of its corners, and these.
    cells = itk.array_from_vector_container(mesh.GetCellsArray()).reshape(count, -1)
    return itk.array_from_vector_container(mesh.GetPoints()), cells[:, 2:]
