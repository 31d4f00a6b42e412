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
    """The triangles, of an image with a layer of background round it.

    Its documentation asks for that layer: no sample at the border may be inside. Without one it
    reads beyond the image, and answers otherwise each time.
    """
    values = padded(values, isovalue)
    # What makes an image of an array takes one of a single row for one in Fortran's order.
    image = itk.Image[itk.F, 3].New()
    image.SetRegions(list(values.shape))
    image.Allocate()
    # ITK's first axis is fastest.
    itk.array_view_from_image(image)[:] = values.transpose(2, 1, 0)
    image.SetSpacing(spacing)
    image.SetOrigin([-step for step in spacing])
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


def padded(values, isovalue):
    """The values in one more layer of the least; of one below the isovalue where none is.

    >>> padded(np.full((1, 1, 1), 3.0), 1.0).min()
    np.float64(-1.0)
    """
    values = np.asarray(values, np.float64)
    finite = values[np.isfinite(values)]
    least = finite.min() if finite.size else isovalue - 1
    if least >= isovalue:
        least = isovalue - max(finite.max() - isovalue, 1)
    return np.pad(values, 1, constant_values=least)
