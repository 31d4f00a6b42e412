"""The lines that show a failure without the grader, of the disciplines beside surfaces.

As in `isograde.report.snippet`: how each library is called, what makes the answer, and what of it
to print for a claim.
"""

from __future__ import annotations

CONTOURS_SKIMAGE = """
from skimage.measure import find_contours


def extract(values, isovalue, spacing):
    lines = find_contours(values, isovalue, positive_orientation="high")
    return [line * spacing for line in lines]
"""
CONTOURS_CONTOURPY = """
from contourpy import contour_generator


def extract(values, isovalue, spacing):
    # contourpy's x is the second axis; to exchange the axes turns the lines about.
    lines = contour_generator(z=values.astype(float)).lines(isovalue)
    return [line[::-1, ::-1] * spacing for line in lines]
"""
CONTOURS_DICONEX = """
from isoref.fast.diconex import diconex
from isoref.field import Field


def extract(values, isovalue, spacing):
    return diconex(Field.of(values, spacing), isovalue, mode="{rest}").polygons()
"""
CURVES_ISOREF = """
from isoref.fast.{rest} import intersection_curves
from isoref.field import Field


def extract(a, b, isovalue_a, isovalue_b, spacing):
    fields = Field.of(a, spacing), Field.of(b, spacing)
    curves = intersection_curves(*fields, (isovalue_a, isovalue_b))
    return [curve.polyline for curve in curves]
"""
CURVES_VTK = """
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy


def extract(a, b, isovalue_a, isovalue_b, spacing):
    image = vtk.vtkImageData()
    image.SetDimensions(a.shape)
    image.SetSpacing(spacing)
    for name, values in (("a", a), ("b", b)):
        array = numpy_to_vtk(values.astype(float).ravel(order="F"), deep=True)
        array.SetName(name)
        image.GetPointData().AddArray(array)
    surface, lines, strips = vtk.vtkContourFilter(), vtk.vtkContourFilter(), vtk.vtkStripper()
    for contour, name, isovalue in ((surface, "a", isovalue_a), (lines, "b", isovalue_b)):
        contour.SetOutputPointsPrecision(1)
        contour.SetInputArrayToProcess(0, 0, 0, 0, name)
        contour.SetValue(0, isovalue)
    surface.SetInputData(image)
    lines.SetInputConnection(surface.GetOutputPort())
    strips.SetInputConnection(lines.GetOutputPort())
    strips.SetMaximumLength(1000000)
    strips.JoinContiguousSegmentsOn()
    strips.Update()
    found = strips.GetOutput()
    if not found.GetNumberOfLines():
        return []
    points = vtk_to_numpy(found.GetPoints().GetData())
    places = vtk_to_numpy(found.GetLines().GetConnectivityArray())
    starts = vtk_to_numpy(found.GetLines().GetOffsetsArray())
    return [points[places[i:j]] for i, j in zip(starts, starts[1:])]
"""
SIMPLICES_ISOREF = """
from isoref.field import Field
from isoref.fast.simplicial import extract as isoref_extract


def extract(values, spacing):
    field = Field.of(values, spacing, dimension=len(spacing))
    mesh = isoref_extract(field, rule="{rest}")
    return mesh.vertices, mesh.simplices
"""
SIMPLICES_SKIMAGE = """
from skimage.measure import marching_cubes


def extract(values, spacing):
    # One component in space.
    return marching_cubes(values[0], 0.0, spacing=spacing, gradient_direction="ascent")[:2]
"""
CALLS = {
    "contours:skimage": CONTOURS_SKIMAGE,
    "contours:contourpy": CONTOURS_CONTOURPY,
    "contours:diconex-disconnect": CONTOURS_DICONEX.format(rest="disconnect"),
    "contours:diconex-connect": CONTOURS_DICONEX.format(rest="connect"),
    "contours:diconex-mixed": CONTOURS_DICONEX.format(rest="mixed"),
    "curves:marching-faces": CURVES_ISOREF.format(rest="marching_faces"),
    "curves:surface-intersection": CURVES_ISOREF.format(rest="surface_intersection"),
    "curves:vtk": CURVES_VTK,
    "simplices:reference": SIMPLICES_ISOREF.format(rest="staircase"),
    "simplices:printed": SIMPLICES_ISOREF.format(rest="printed"),
    "simplices:skimage": SIMPLICES_SKIMAGE,
}

# The line that makes the answer.
ASKED = {
    "contours": "lines = extract(values, isovalue, spacing)",
    "curves": "lines = extract(values[0], values[1], isovalue, {second}, spacing)",
    "simplices": "vertices, simplices = extract(values, spacing)",
}
# The lines that make another answer which ought to be the same.
ASKED_AGAIN = {
    "transposed": "turned = extract(values.T, isovalue, spacing[::-1])\n"
    "again = [line[:, ::-1] for line in turned]",
    "swapped": "again = extract(values[1], values[0], {second}, isovalue, spacing)",
}

SHOW_ENDS = """
# Lines that do not come back to where they began; they may end on the border of the lattice only.
for line in lines:
    if (line[0] != line[-1]).any():
        print("from", line[0], "to", line[-1])
"""
SHOW_TWICE = """
# Points that are there more than once, the end of a closed line apart.
rings = [(line[0] == line[-1]).all() for line in lines]
points = np.concatenate([line[:-1] if ring else line for line, ring in zip(lines, rings)])
places, count = np.unique(points, axis=0, return_counts=True)
print(places[count > 1])
"""
SHOW_LINES = """
for line in lines:
    print(line)
"""
SHOW_BOTH = """
for found in (lines, again):
    print(len(found), "lines")
    for line in found:
        print(line)
"""
SHOW_FACETS = """
# Facets that one simplex has and no other; on the border of the lattice they are right.
sides = [np.delete(simplices, corner, axis=1) for corner in range(simplices.shape[1])]
facets, uses = np.unique(np.sort(np.concatenate(sides), axis=1), axis=0, return_counts=True)
for corners in vertices[facets[uses == 1]]:
    print(corners.tolist())
"""
SHOW_SIMPLICES = """
print(vertices)
print(simplices)
"""
SHOWS = {
    "contours.whole": SHOW_ENDS,
    "curves.whole": SHOW_ENDS,
    "contours.no-point-twice": SHOW_TWICE,
    "curves.no-point-twice": SHOW_TWICE,
    "simplices.closed": SHOW_FACETS,
    "simplices.conforming": SHOW_FACETS,
}


def shown(discipline: str, claim: str, second: float | str, variant: str) -> str | None:
    """The lines that ask and print; None where the variant cannot be made in a line.

    `second` is the isovalue of the second field, as it is to be written.
    """
    asked = ASKED[discipline].format(second=second)
    if variant:
        again = ASKED_AGAIN.get(variant)
        return again and f"{asked}\n{again.format(second=second)}\n{SHOW_BOTH.strip()}"
    plain = SHOW_SIMPLICES if discipline == "simplices" else SHOW_LINES
    return f"{asked}\n\n{SHOWS.get(claim, plain).strip()}"
