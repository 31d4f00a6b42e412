"""Meshes written to files, by the libraries that know the formats.

| ending | written by |
| --- | --- |
| ply, obj, off, stl, glb, 3mf | trimesh |
| vtk, vtu, msh, inp, mesh, med, avs, tec | meshio |
| vtp | pyvista: VTK's own PolyData |
| npz | NumPy: `vertices`, `faces`, and `space` |

What meshio writes in more than one file, or cannot read back, is left out. STL, PLY and glTF hold
single precision, whatever they are given. A mesh that comes piece by piece is written to PLY as it
comes (`write_pieces`), which holds what it is given.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
from isoref.field import Array
from isoref.mesh import Mesh

from isograde.formats.reading import VolumeError, library

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


def write_pieces(pieces: Iterable[tuple[Array, Array]], path: Path) -> tuple[int, int]:
    """The PLY file holds the mesh of all pieces, and nothing of them was kept in memory.

    A piece is new vertices (V, 3) and triangles (T, 3), which number all vertices so far. Positions
    are double or float, as they come; triangles are uint, which numbers 2^32 vertices. Where it
    goes wrong, nothing half-written stays. Returns how many vertices and triangles there are.

    Raises
    ------
    VolumeError
        where there are more vertices than PLY can number.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    drafts = [path.with_name(f".{path.stem}.{part}.tmp.ply") for part in ("vertices", "faces")]
    vertices = triangles = 0
    real = "double"
    try:
        with drafts[0].open("w+b") as file, drafts[1].open("w+b") as faces:
            # Leave room for a header, whose numbers are known last.
            file.write(_ply_header(0, 0, real))
            for points, corners in pieces:
                real = "double" if points.dtype == np.float64 else "float"
                vertices += len(points)
                triangles += len(corners)
                if vertices > 1 << 32:
                    raise VolumeError(f"{vertices:,} vertices are more than a PLY file can number")
                file.write(points.astype(points.dtype.newbyteorder("<")).tobytes())
                rows = np.empty(len(corners), PLY_FACE)
                rows["count"], rows["corners"] = 3, corners
                faces.write(rows.tobytes())
            faces.seek(0)
            shutil.copyfileobj(faces, file)
            file.seek(0)
            file.write(_ply_header(vertices, triangles, real))
        drafts[0].replace(path)
    finally:
        for draft in drafts:
            draft.unlink(missing_ok=True)
    return vertices, triangles


PLY_FACE = np.dtype([("count", "u1"), ("corners", "<u4", 3)])


def _ply_header(vertices: int, triangles: int, real: str) -> bytes:
    """The header of a binary PLY file, of one length whatever the numbers are."""
    lines = [
        "ply",
        "format binary_little_endian 1.0",
        f"element vertex {vertices}",
        *(f"property {real} {axis}" for axis in "xyz"),
        f"element face {triangles}",
        "property list uchar uint vertex_indices",
    ]
    rest = 300 - sum(len(line) + 1 for line in lines) - len("comment \nend_header\n")
    return "\n".join([*lines, f"comment {'-' * rest}", "end_header", ""]).encode("ascii")


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
