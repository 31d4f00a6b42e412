"""Adapters to the libraries people use, and to the reference, under short names.

Each library is loaded only in the worker process that runs it. Conventions are declared as
measured (`isograde.adapters.measure`); a test holds each declaration to the measurement.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable
from dataclasses import dataclass
from dataclasses import field as fresh
from functools import partial
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np
from isoref.field import Field
from isoref.methods import METHODS
from numpy.typing import NDArray

from isograde.model import Conventions, Declaration, Extract

Values = NDArray[Any]
Spacing = tuple[float, ...]


@dataclass(frozen=True)
class ReadyMade:
    """An implementation that has a short name.

    distribution : the package that brings the library
    load : imports the library; the function to call
    """

    distribution: str
    load: Callable[[], Extract]
    conventions: Conventions = fresh(default_factory=Conventions)
    level: int = 2
    without: frozenset[str] = fresh(default_factory=frozenset)
    notes: str = ""
    connectivity: str = ""

    @property
    def version(self) -> str:
        """The installed version, or "source" where the code is used without being installed."""
        try:
            return version(self.distribution)
        except PackageNotFoundError:
            return "source"

    def declaration(self, name: str) -> Declaration:
        """What it declares."""
        return Declaration(
            name,
            self.version,
            self.level,
            self.conventions,
            without=self.without,
            notes=self.notes,
            connectivity=self.connectivity,
        )


def _skimage(method: str) -> Extract:
    """`skimage.measure.marching_cubes` with this method."""
    from skimage.measure import marching_cubes

    def extract(values: Values, isovalue: float, spacing: Spacing) -> Any:
        return marching_cubes(values, isovalue, spacing=spacing, method=method)[:2]

    return extract


def _pymcubes() -> Extract:
    """`mcubes.marching_cubes`, which knows no spacing."""
    import mcubes

    def extract(values: Values, isovalue: float, spacing: Spacing) -> Any:
        return mcubes.marching_cubes(values, isovalue)

    return extract


def _libigl() -> Extract:
    """`igl.marching_cubes`, given the samples and their positions with the first axis fastest."""
    import igl

    def extract(values: Values, isovalue: float, spacing: Spacing) -> Any:
        samples = values.astype(np.float64).ravel(order="F")
        axes = [np.arange(n) * h for n, h in zip(values.shape, spacing, strict=True)]
        grid = np.meshgrid(*axes, indexing="ij")
        positions = np.stack([axis.ravel(order="F") for axis in grid], axis=1)
        return igl.marching_cubes(samples, positions, *values.shape, isovalue)[:2]

    return extract


def _trimesh() -> Extract:
    """`trimesh.voxel.ops.matrix_to_marching_cubes`, which takes inside and outside, no values."""
    from trimesh.voxel.ops import matrix_to_marching_cubes

    def extract(values: Values, isovalue: float, spacing: Spacing) -> Any:
        mesh = matrix_to_marching_cubes(values >= isovalue, pitch=spacing)
        return mesh.vertices, mesh.faces

    return extract


def _vtk(module: str, name: str, *, labels: bool = False) -> Extract:
    """A filter of VTK from images to triangles; with `labels` it is given inside and outside."""
    filters = import_module(f"vtkmodules.{module}")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    def extract(values: Values, isovalue: float, spacing: Spacing) -> Any:
        contour = getattr(filters, name)()
        samples = (values >= isovalue).astype(np.uint8) if labels else values
        contour.SetValue(0, 1 if labels else isovalue)
        if labels:
            _smooth_nothing(contour)
        else:
            contour.ComputeNormalsOff()
            contour.ComputeGradientsOff()
            contour.ComputeScalarsOff()
        contour.SetInputData(_vtk_image(samples, spacing))
        contour.Update()
        surface = contour.GetOutput()
        if surface.GetNumberOfCells() == 0:
            return np.empty((0, 3)), np.empty((0, 3), np.int64)
        faces = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        return vtk_to_numpy(surface.GetPoints().GetData()), faces

    return extract


def _smooth_nothing(contour: Any) -> None:
    """A filter for labels gives triangles where it puts them first."""
    if hasattr(contour, "SmoothingOff"):
        contour.SmoothingOff()
        contour.SetOutputMeshTypeToTriangles()


def _vtk_image(values: Values, spacing: Spacing) -> Any:
    """The samples as a vtkImageData whose x is the array's first axis.

    Types that VTK does not have (bool, float16, foreign byte order) are widened without loss.
    """
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData

    widened = {"b1": np.uint8, "f2": np.float32}.get(values.dtype.str[1:])
    native = values.astype(widened or values.dtype.newbyteorder("="), copy=False)
    image = vtkImageData()
    image.SetDimensions(values.shape)
    image.SetSpacing(spacing)
    image.GetPointData().SetScalars(numpy_to_vtk(native.ravel(order="F"), deep=True))
    return image


def _pymeshlab() -> Extract:
    """MeshLab's "create implicit surface", given the samples as a formula to be looked up in.

    The filter walks the whole lattice only when told of two samples more along each axis.
    """
    import pymeshlab

    def extract(values: Values, isovalue: float, spacing: Spacing) -> Any:
        formula = _lookup(values.astype(np.float64) - isovalue)
        if len(formula) > MESHLAB_FORMULA:
            raise NotImplementedError(
                f"MeshLab takes samples only as a formula of up to {MESHLAB_FORMULA:,} characters; "
                f"these {values.size:,} samples need {len(formula):,}"
            )
        meshes = pymeshlab.MeshSet()
        ends = {f"max{axis}": float(n + 1) for axis, n in zip("xyz", values.shape, strict=True)}
        starts = {f"min{axis}": 0.0 for axis in "xyz"}
        meshes.create_implicit_surface(voxelsize=1.0, expr=formula, **starts, **ends)
        mesh = meshes.current_mesh()
        return mesh.vertex_matrix(), mesh.face_matrix()

    return extract


# The longest formula the parser under MeshLab (muParser) takes.
MESHLAB_FORMULA = 20_000


def _lookup(samples: Values, axis: int = 0) -> str:
    """A formula of x, y, z with these values at the lattice's samples: nested bisections.

    >>> _lookup(np.array([[[1.0, 2.0]], [[3.0, 3.0]]]))
    '(x<0.5?(z<0.5?1:2):3)'
    """
    first = samples.flat[0]
    if samples.ndim == 0 or (samples == first).all():
        return f"{first:.9g}" if first == first else "(0/0)"
    parts = [_lookup(np.asarray(part), axis + 1) for part in samples]

    def bisected(low: int, high: int) -> str:
        if high - low == 1 or len(set(parts[low:high])) == 1:
            return parts[low]
        middle = (low + high) // 2
        left, right = bisected(low, middle), bisected(middle, high)
        return f"({'xyz'[axis]}<{middle - 0.5:g}?{left}:{right})"

    return bisected(0, len(parts))


def _manifold3d() -> Extract:
    """`manifold3d.Manifold.level_set` of the trilinear interpolant, on a grid as fine as ours."""
    from manifold3d import Manifold

    def extract(values: Values, isovalue: float, spacing: Spacing) -> Any:
        ends = [(n - 1) * h for n, h in zip(values.shape, spacing, strict=True)]
        solid = Manifold.level_set(
            _interpolant(values, spacing), [0.0, 0.0, 0.0, *ends], min(spacing), level=isovalue
        )
        mesh = solid.to_mesh()
        return mesh.vert_properties[:, :3], mesh.tri_verts

    return extract


def _interpolant(values: Values, spacing: Spacing) -> Callable[[float, float, float], float]:
    """The trilinear interpolant of the samples, continued constantly beyond the lattice."""
    flat: array[float] = array("d", values.astype(np.float64).tobytes())
    ends: list[int] = [n - 1 for n in values.shape]
    strides: list[int] = [values.shape[1] * values.shape[2], values.shape[2], 1]

    def at(x: float, y: float, z: float) -> float:
        low, parts = 0, []
        for p, h, end, stride in zip((x, y, z), spacing, ends, strides, strict=True):
            index = min(max(p / h, 0.0), end)
            cell = min(int(index), max(end - 1, 0))
            low += cell * stride
            parts.append((index - cell, stride if end else 0))
        (s, dx), (t, dy), (u, dz) = parts

        def edge(o: int) -> float:
            return flat[o] * (1 - u) + flat[o + dz] * u

        def face(o: int) -> float:
            return edge(o) * (1 - t) + edge(o + dy) * t

        return face(low) * (1 - s) + face(low + dx) * s

    return at


def _isoref(name: str) -> Extract:
    """The method of the reference with this name."""
    method = METHODS[name]

    def extract(values: Values, isovalue: float, spacing: Spacing) -> Any:
        mesh = method(Field.of(values, spacing), isovalue)
        return mesh.vertices, mesh.simplices

    return extract


def _connectivity(name: str) -> str:
    """The mode in a VESTA method's name, which it promises; nothing for any other method.

    >>> _connectivity("marching-vesta-mixed-H"), _connectivity("asymptotic-decider")
    ('mixed', '')
    """
    _, vesta, rest = name.partition("vesta-")
    return rest.partition("-")[0] if vesta else ""


# What is not promised where samples are given as inside or outside, with no values; where
# vertices stand in cells; where the surface is sampled on another grid than ours.
_LABELS = frozenset({"linear-crossing"})
_DUAL = frozenset({"on-edges", "linear-crossing", "manifold", "closed", "border"})
_TETRAHEDRA = frozenset({"on-edges", "linear-crossing"})
_OWN_GRID = frozenset({"on-edges", "linear-crossing", "separates", "border"})

_SKIMAGE = Conventions(tie="outside", normals="to_high", nan="answers", empty="raises")
_VTK = Conventions(nan="answers")

# How a library resolves every ambiguous face, declared where a test finds the cycles of that mode
# in all 256 cells. The rest has none: scikit-image's lewiner and MeshLab decide by the asymptotes,
# trimesh calls lewiner, and manifold3d and surface nets have no vertices on our lattice edges.
_DISCONNECT, _CONNECT = "disconnect", "connect"

# Methods of the reference that promise more than to be consistent.
_PROMISES = {"asymptotic-decider": 3, "trilinear-cubes": 4}

# What the reference's methods of other families leave out.
_OTHER_FAMILIES = {
    "surface-nets": _DUAL,
    "dual-marching-cubes": _DUAL - {"manifold"},
    "label-cubes": _LABELS,
    "marching-tetrahedra-kuhn": _TETRAHEDRA,
    "marching-tetrahedra-five": _TETRAHEDRA,
    "simplicial": _TETRAHEDRA,
}

READY_MADE: dict[str, ReadyMade] = {
    "skimage:lewiner": ReadyMade(
        "scikit-image",
        partial(_skimage, "lewiner"),
        _SKIMAGE,
        level=4,
        notes="its documentation guarantees topologically correct results; computes in float32",
    ),
    "skimage:lorensen": ReadyMade(
        "scikit-image",
        partial(_skimage, "lorensen"),
        _SKIMAGE,
        notes="computes in float32",
        connectivity=_DISCONNECT,
    ),
    "pymcubes": ReadyMade(
        "PyMCubes",
        _pymcubes,
        Conventions(tie="outside", units="index", nan="answers"),
        notes="takes the isovalue as float32",
        connectivity=_CONNECT,
    ),
    "libigl": ReadyMade(
        "libigl",
        _libigl,
        Conventions(tie="outside", normals="to_high", nan="answers"),
        connectivity=_DISCONNECT,
    ),
    "trimesh": ReadyMade(
        "trimesh",
        _trimesh,
        Conventions(nan="answers", empty="raises"),
        without=_LABELS | {"border"},
        notes="is given values >= isovalue; closes the surface half a sample beyond the border",
    ),
    "vtk:marching-cubes": ReadyMade(
        "vtk",
        partial(_vtk, "vtkFiltersCore", "vtkMarchingCubes"),
        _VTK,
        connectivity=_DISCONNECT,
    ),
    "vtk:flying-edges": ReadyMade(
        "vtk",
        partial(_vtk, "vtkFiltersCore", "vtkFlyingEdges3D"),
        _VTK,
        connectivity=_DISCONNECT,
    ),
    "vtk:contour-filter": ReadyMade(
        "vtk",
        partial(_vtk, "vtkFiltersCore", "vtkContourFilter"),
        _VTK,
        connectivity=_DISCONNECT,
    ),
    "vtk:discrete-marching-cubes": ReadyMade(
        "vtk",
        partial(_vtk, "vtkFiltersGeneral", "vtkDiscreteMarchingCubes", labels=True),
        _VTK,
        without=_LABELS,
        notes="is given values >= isovalue as the label 1",
        connectivity=_DISCONNECT,
    ),
    "vtk:surface-nets": ReadyMade(
        "vtk",
        partial(_vtk, "vtkFiltersCore", "vtkSurfaceNets3D", labels=True),
        _VTK,
        level=1,
        without=_DUAL,
        notes="is given values >= isovalue as the label 1; vertices in cells, not smoothed",
    ),
    "pymeshlab": ReadyMade(
        "pymeshlab",
        _pymeshlab,
        Conventions(tie="outside", normals="to_high", units="index", nan="answers"),
        notes="is given the samples as a formula, so takes small fields only; computes in float32",
    ),
    "manifold3d": ReadyMade(
        "manifold3d",
        _manifold3d,
        Conventions(tie="outside", nan="answers"),
        level=1,
        without=_OWN_GRID,
        notes="samples the trilinear interpolant on a body-centred grid of its own; "
        "closes the surface at the border",
    ),
} | {
    f"isoref:{name}": ReadyMade(
        "isograde",
        partial(_isoref, name),
        level=1 if name == "surface-nets" else _PROMISES.get(name, 2),
        without=_OTHER_FAMILIES.get(name, frozenset()),
        connectivity=_connectivity(name),
    )
    for name in METHODS
}
