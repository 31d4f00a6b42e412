"""Meshes written to files, by the libraries that know the formats.

| ending | written by |
| --- | --- |
| ply, obj, off, stl, glb, 3mf | trimesh |
| vtk, vtu, msh, inp, mesh, med, avs, tec | meshio |
| vtp | pyvista: VTK's own PolyData |
| npz | NumPy: `vertices`, `faces`, and `space` |

What meshio writes in more than one file, or cannot read back, is left out. STL, PLY and glTF hold
single precision, whatever they are given.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from isoref.mesh import Mesh

from isograde.formats.reading import library

TRIMESH = (".ply", ".obj", ".off", ".stl", ".glb", ".3mf")
MESHIO = (".vtk", ".vtu", ".msh", ".inp", ".mesh", ".med", ".avs", ".tec")
MESH_FILES = (*TRIMESH, *MESHIO, ".vtp", ".npz")


def write(mesh: Mesh, path: Path, space: str = "") -> None:
    """The file holds the mesh; nothing half-written stays.

    `space` ("RAS", "LPS") is written down where the format has a place for it: npz and vtp.

    Raises
    ------
    VolumeError
        where the library of the format is not installed.
    """
    ending = path.suffix.lower()
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(f".{path.stem}.tmp{ending}")
    try:
        _writer(ending)(mesh, draft, space)
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)


def _writer(ending: str) -> Callable[[Mesh, Path, str], None]:
    """What writes files of this ending."""
    if ending == ".npz":
        return _npz
    if ending == ".vtp":
        return _vtp
    return _trimesh if ending in TRIMESH else _meshio


def _npz(mesh: Mesh, path: Path, space: str) -> None:
    """Three arrays."""
    np.savez(path, vertices=mesh.vertices, faces=mesh.simplices, space=space)


def _trimesh(mesh: Mesh, path: Path, _: str) -> None:
    """Vertices and triangles as they are: trimesh would weld them."""
    library("trimesh", "meshes").Trimesh(mesh.vertices, mesh.simplices, process=False).export(path)


def _meshio(mesh: Mesh, path: Path, _: str) -> None:
    """One block of triangles."""
    meshio: Any = library("meshio", "meshes")
    meshio.Mesh(mesh.vertices, [("triangle", mesh.simplices)]).write(path)


def _vtp(mesh: Mesh, path: Path, space: str) -> None:
    """Polygons, and SPACE among the data of the whole."""
    pyvista: Any = library("pyvista", "meshes")
    surface = pyvista.PolyData.from_regular_faces(mesh.vertices, mesh.simplices)
    if space:
        surface.field_data["SPACE"] = [space]
    surface.save(path)
