"""A failed case as a few lines of Python that show it without the grader.

The lines hold the samples, call the implementation as its own users do, and print what the claim is
about. For implementations that are no Python, and for cases too large to print, there is only the
command that grades the case again.
"""

from __future__ import annotations

from textwrap import indent
from typing import Any

import numpy as np

from isograde.report import snippets_beside
from isograde.report.record import JSON, Report, Summary

# Print samples up to this many.
PRINTED = 200

SKIMAGE = """
from skimage.measure import marching_cubes


def extract(values, isovalue, spacing):
    return marching_cubes(values, isovalue, spacing=spacing, method="{rest}")[:2]
"""
ISOREF = """
from isoref import extract as isoref_extract


def extract(values, isovalue, spacing):
    mesh = isoref_extract(values, isovalue, spacing, method="{rest}")
    return mesh.vertices, mesh.simplices
"""
PYMCUBES = """
import mcubes


def extract(values, isovalue, spacing):
    return mcubes.marching_cubes(values, isovalue)
"""
TRIMESH = """
from trimesh.voxel.ops import matrix_to_marching_cubes


def extract(values, isovalue, spacing):
    mesh = matrix_to_marching_cubes(values >= isovalue, pitch=spacing)
    return mesh.vertices, mesh.faces
"""
LIBIGL = """
import igl


def extract(values, isovalue, spacing):
    index = np.stack(np.meshgrid(*map(np.arange, values.shape), indexing="ij"), -1) * spacing
    points = np.stack([index[..., axis].ravel(order="F") for axis in range(3)], axis=1)
    samples = values.astype(float).ravel(order="F")
    return igl.marching_cubes(samples, points, *values.shape, isovalue)[:2]
"""
VTK = """
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy


def extract(values, isovalue, spacing):
    image = vtk.vtkImageData()
    image.SetDimensions(values.shape)
    image.SetSpacing(spacing)
    image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(order="F"), deep=True))
    contour = vtk.{rest}()
    contour.SetInputData(image)
    contour.SetValue(0, isovalue)
    contour.Update()
    surface = contour.GetOutput()
    if surface.GetNumberOfCells() == 0:
        return np.empty((0, 3)), np.empty((0, 3), int)
    faces = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return vtk_to_numpy(surface.GetPoints().GetData()), faces
"""
VTK_LABELS = """
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy


def extract(values, isovalue, spacing):
    labels = (values >= isovalue).astype(np.uint8)
    image = vtk.vtkImageData()
    image.SetDimensions(values.shape)
    image.SetSpacing(spacing)
    image.GetPointData().SetScalars(numpy_to_vtk(labels.ravel(order="F"), deep=True))
    contour = vtk.{rest}()
    contour.SetValue(0, 1)
    if hasattr(contour, "SmoothingOff"):
        contour.SmoothingOff()
        contour.SetOutputMeshTypeToTriangles()
    contour.SetInputData(image)
    contour.Update()
    surface = contour.GetOutput()
    if surface.GetNumberOfCells() == 0:
        return np.empty((0, 3)), np.empty((0, 3), int)
    faces = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return vtk_to_numpy(surface.GetPoints().GetData()), faces
"""
PYMESHLAB = """
import pymeshlab


def formula(samples, axes="xyz"):
    # MeshLab takes a field as a formula: look the sample up by its index along each axis.
    if samples.ndim == 0:
        return f"{{samples:.9g}}"
    text = formula(samples[-1], axes[1:])
    for index in reversed(range(len(samples) - 1)):
        text = f"({{axes[0]}}<{{index + 0.5}}?{{formula(samples[index], axes[1:])}}:{{text}})"
    return text


def extract(values, isovalue, spacing):
    meshes = pymeshlab.MeshSet()
    low = dict(minx=0.0, miny=0.0, minz=0.0)
    high = dict(zip(("maxx", "maxy", "maxz"), (n + 1.0 for n in values.shape)))
    meshes.create_implicit_surface(
        voxelsize=1.0, expr=formula(values.astype(float) - isovalue), **low, **high
    )
    mesh = meshes.current_mesh()
    return mesh.vertex_matrix(), mesh.face_matrix()
"""
MANIFOLD3D = """
from manifold3d import Manifold
from scipy.ndimage import map_coordinates


def extract(values, isovalue, spacing):
    def at(*point):
        index = [[x / h] for x, h in zip(point, spacing)]
        return float(map_coordinates(values.astype(float), index, order=1, mode="nearest")[0])

    box = [0.0, 0.0, 0.0, *((n - 1) * h for n, h in zip(values.shape, spacing))]
    mesh = Manifold.level_set(at, box, min(spacing), level=isovalue).to_mesh()
    return mesh.vert_properties[:, :3], mesh.tri_verts
"""
PYTHON_FILE = """
import runpy

extract = runpy.run_path("{module}")["{function}"]
"""
PYTHON = """
from {module} import {function} as extract
"""
CALLS = {
    "skimage": SKIMAGE,
    "isoref": ISOREF,
    "pymcubes": PYMCUBES,
    "trimesh": TRIMESH,
    "libigl": LIBIGL,
    "pymeshlab": PYMESHLAB,
    "manifold3d": MANIFOLD3D,
}
LABEL_FILTERS = {
    "vtk:discrete-marching-cubes": "vtkDiscreteMarchingCubes",
    "vtk:surface-nets": "vtkSurfaceNets3D",
}
FILTERS = {
    "vtk:marching-cubes": "vtkMarchingCubes",
    "vtk:flying-edges": "vtkFlyingEdges3D",
    "vtk:contour-filter": "vtkContourFilter",
}

SHOW_OPEN = """
# Edges that one triangle has and no other: inside the volume a closed surface has none.
edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
ends, uses = np.unique(edges, axis=0, return_counts=True)
for a, b in vertices[ends[uses == 1]]:
    print("open edge from", a, "to", b)
"""
SHOW_CROWDED = """
# Edges that more than two triangles share.
edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
ends, uses = np.unique(edges, axis=0, return_counts=True)
for a, b in vertices[ends[uses > 2]]:
    print("crowded edge from", a, "to", b)
"""
SHOW_TWICE = """
# Triangles that are there more than once.
triangles, count = np.unique(np.sort(faces, axis=1), axis=0, return_counts=True)
print(triangles[count > 1])
"""
SHOW_UNUSED = """
# Vertices that no triangle uses.
print(np.setdiff1d(np.arange(len(vertices)), faces))
"""
SHOW_ALL = """
print(vertices)
print(faces)
"""
SHOWS = {
    "topology.closed": SHOW_OPEN,
    "robustness.ties": SHOW_OPEN,
    "topology.edge_manifold": SHOW_CROWDED,
    "structure.no_duplicate_face": SHOW_TWICE,
    "structure.all_used": SHOW_UNUSED,
}
PLAIN = "vertices, faces = extract(values, isovalue, spacing)\n"
BOTH = """
for samples, level, steps in ((values, isovalue, spacing), (posed, posed_isovalue, posed_spacing)):
    vertices, faces = extract(samples, level, steps)
    print(vertices)
    print(faces)
"""


def snippet(report: Report, summary: Summary) -> str | None:
    """The lines that show the claim's smallest failed case, or None where there are none."""
    record, call = report.evidence.get(summary.id), calling(report.spec)
    if record is None or call is None or len(record["values"]) > PRINTED:
        return None
    discipline = report.header["implementation"]["discipline"]
    if discipline != "surfaces":
        return _beside(record, call, discipline, summary.id)
    lines = ["import numpy as np", call.strip(), "", ""]
    if _has_nan(record.get("posed", record)):
        lines += ["nan = np.nan", ""]
    lines.append(_samples(record))
    if "posed" in record:
        lines.append(f"# The same, {record['posed']['meaning']}.")
        lines += [_samples(record["posed"], "posed", "posed_"), BOTH.strip()]
    else:
        lines += [PLAIN, SHOWS.get(summary.id, SHOW_ALL).strip()]
    return "\n".join(lines) + "\n"


def _beside(record: JSON, call: str, discipline: str, claim: str) -> str | None:
    """The lines for a discipline beside surfaces."""
    if not record["values"]:
        return None
    size = int(np.prod(record["shape"]))
    # A third component holds nothing but the second isovalue.
    second = record["values"][2 * size] if record.get("components") == 3 else "isovalue"
    variant = record.get("posed", {}).get("variant", "")
    told = snippets_beside.shown(discipline, claim, second, variant)
    if told is None:
        return None
    samples = _samples(record, stacked=discipline != "contours")
    lines = ["import numpy as np", call.strip(), "", "", samples, told]
    return "\n".join(lines) + "\n"


def calling(spec: str) -> str | None:
    """The lines that define `extract` as the implementation's users call it; None if none do."""
    kind, _, rest = spec.partition(":")
    if kind == "python":
        module, _, function = rest.rpartition(":")
        template = PYTHON_FILE if module.endswith(".py") else PYTHON
        return template.format(module=module, function=function)
    if spec in snippets_beside.CALLS:
        return snippets_beside.CALLS[spec]
    if spec in FILTERS:
        return VTK.format(rest=FILTERS[spec])
    if spec in LABEL_FILTERS:
        return VTK_LABELS.format(rest=LABEL_FILTERS[spec])
    return CALLS[kind].format(rest=rest) if kind in CALLS else None


def _has_nan(record: JSON) -> bool:
    """Whether a sample is not a number."""
    return any(isinstance(value, str) for value in [record["isovalue"], *record["values"]])


def _samples(record: JSON, name: str = "values", prefix: str = "", *, stacked: bool = False) -> str:
    """The lines that make the samples, the isovalue and the spacing."""
    numbers = [float(value) if isinstance(value, str) else value for value in record["values"]]
    shape = [-1, *record["shape"]] if stacked else record["shape"]
    values = np.asarray(numbers, record["dtype"]).reshape(shape)
    start = f"{name} = np.array("
    printed = np.array2string(values, separator=", ", threshold=PRINTED + 1, floatmode="unique")
    rows = indent(printed, " " * len(start)).strip().replace("\n\n", "\n")
    dtype = f', dtype="{record["dtype"]}"' if record["dtype"] != "float64" else ""
    if not values.size:
        rows = f"np.empty({values.shape})"
    spacing: Any = tuple(record["spacing"])
    return (
        f"{start}{rows}{dtype})\n"
        f"{prefix}isovalue, {prefix}spacing = {record['isovalue']}, {spacing}\n"
    )
