"""What the commands on one volume do: `extract` and `frequencies`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from isoref.field import Field, FieldError
from isoref.mesh import Mesh
from isoref.methods import METHODS
from rich.markup import escape

from isograde.cases import volumes
from isograde.commands.console import Exit, close_to, console, stop
from isograde.frequencies import frequencies as count

MESH_FILES = (".ply", ".obj", ".off", ".stl", ".glb", ".npz")


def extract(volume: str, isovalue: float, method: str, out: Path) -> None:
    """The reference's surface of a volume is in the mesh file `out`."""
    if method not in METHODS:
        stop(Exit.WRONG_USE, f"no method {method!r}; {close_to(method, METHODS)}")
    if out.suffix.lower() not in MESH_FILES:
        stop(Exit.WRONG_USE, f"{out} ends in none of {' '.join(MESH_FILES)}")
    try:
        mesh = METHODS[method](_volume(volume), isovalue)
        write_mesh(mesh, out)
    except (volumes.VolumeError, FieldError, OSError) as error:
        stop(Exit.WRONG_USE, str(error))
    console.print(
        f"{len(mesh.vertices):,} vertices, {len(mesh.simplices):,} triangles: "
        f"[bold]{escape(str(out))}[/]"
    )


def frequencies(volume: str, isovalue: float) -> None:
    """The table of configurations of a volume's cells is printed."""
    try:
        table = count(_volume(volume), isovalue).markdown()
    except (volumes.VolumeError, FieldError) as error:
        stop(Exit.WRONG_USE, str(error))
    console.print(table, end="", markup=False)


def _volume(name: str) -> Field:
    """The field in a file, or of a known data set, which is downloaded where it is not here."""
    known = volumes.REGISTRY.get(name)
    if known is not None and not Path(name).exists():
        return volumes.read(volumes.fetch(known), volume=known)
    return volumes.read(Path(name))


def write_mesh(mesh: Mesh, path: Path) -> None:
    """The file holds the mesh; nothing half-written stays."""
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(f".{path.stem}.tmp{path.suffix}")
    try:
        if path.suffix.lower() == ".npz":
            np.savez(draft, vertices=mesh.vertices, faces=mesh.simplices)
        else:
            import trimesh

            trimesh.Trimesh(mesh.vertices, mesh.simplices, process=False).export(draft)
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)
