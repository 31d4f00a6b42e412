"""Answers in files: pairs of .npy files, mesh files, and JSON, as vertices and simplices.

JSON holds, as its standard has it (`isograde.adapters.strict`), an object with ``vertices`` and
``simplices`` (or ``faces``), or with ``polylines``, in the forms of `isograde.adapters.forms`; in
place of rows, the name of a .npy file that has them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isograde.adapters.forms import AnswerError, Arrays, from_pair, from_polylines, tried
from isograde.adapters.strict import parse
from isograde.adapters.texts import clean
from isograde.model import SURFACES, Kind, Status

MESH_FILES = (".ply", ".obj", ".off", ".stl")

# The first words of lines in an .obj file that has no faces, and how much of it is looked at.
OBJ_WORDS = {b"v", b"vn", b"vt", b"o", b"g", b"s", b"mtllib", b"usemtl"}
CHECKED_BYTES = 1 << 16
# Of a name that is no file's, so much is quoted.
LONGEST_NAME = 120


def arrays_said(said: Mapping[str, Any], folder: Path, limit: int, kind: Kind) -> Arrays:
    """Vertices and simplices of an answer in JSON, its files in `folder`; raises `AnswerError`."""
    if "answer" in said:
        return json_in(folder / said["answer"], limit, kind)
    if "mesh" in said:
        return mesh_in(folder / said["mesh"], limit, kind)
    if "polylines" in said:
        if kind.k != 1:
            raise AnswerError(f"polylines are no answer of dimension {kind.k}: {kind}")
        lines = [numbers(one) for one in said["polylines"]]
        return tried("polylines", lambda: from_polylines(lines, kind))  # type: ignore[no-any-return]
    pair = said["vertices"], said["simplices"] if "simplices" in said else said["faces"]
    loaded = [load(folder / part, limit) if isinstance(part, str) else part for part in pair]
    return from_pair(numbers(loaded[0]), loaded[1], kind)


def numbers(rows: Any) -> Any:
    """Rows of coordinates out of JSON, in which null stands for a number that is not finite."""
    if not isinstance(rows, list):
        return rows
    return [
        [math.nan if x is None else x for x in row] if isinstance(row, list) else row
        for row in rows
    ]


def json_in(path: Path, limit: int, kind: Kind) -> Arrays:
    """Vertices and simplices of an answer in a JSON file; raises `AnswerError`."""
    check_file(path, limit)
    said = tried(path.name, lambda: parse(path.read_bytes()))
    keys = set(said) if isinstance(said, dict) else set()
    if keys not in ({"polylines"}, {"vertices", "simplices"}, {"vertices", "faces"}):
        raise AnswerError(f"{path.name} has neither polylines nor vertices and simplices")
    return arrays_said(said, path.parent, limit, kind)


def load(path: Path, limit: int) -> NDArray[Any]:
    """The array in a .npy file; raises `AnswerError`."""
    check_file(path, limit)
    array: NDArray[Any] = tried(path.name, lambda: np.load(path, allow_pickle=False))
    return array


def mesh_in(path: Path, limit: int, kind: Kind) -> Arrays:
    """Vertices and triangles of a mesh file, as they stand in it; raises `AnswerError`.

    STL has no shared vertices: those with equal coordinates are made one.
    """
    if kind != SURFACES:
        raise AnswerError(f"{path.name}: mesh files hold surfaces in space, not {kind}")
    if path.suffix.lower() not in MESH_FILES:
        raise AnswerError(f"{path.name}: a mesh file ends in {', '.join(MESH_FILES)}")
    check_file(path, limit)
    vertices, faces = tried(path.name, lambda: _read_mesh(path))
    if not len(faces) and not _says_empty(path):
        raise AnswerError(f"{path.name} is no mesh file")
    if path.suffix.lower() == ".stl" and len(vertices):
        vertices, where = np.unique(vertices, axis=0, return_inverse=True)
        faces = where.reshape(-1)[faces]
    return from_pair(vertices, faces, kind)


def _read_mesh(path: Path) -> tuple[NDArray[Any], NDArray[Any]]:
    """Vertices and faces, read by trimesh and not touched up."""
    import trimesh

    mesh = trimesh.load(path, force="mesh", process=False, maintain_order=True)
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    return vertices, faces if faces.size else np.empty((0, 3), np.int64)


def _says_empty(path: Path) -> bool:
    """Whether a file without faces is one: .stl and .obj are read from any text without a word."""
    beginning = path.read_bytes()[:CHECKED_BYTES]
    if path.suffix.lower() == ".stl":
        return beginning.lstrip().startswith(b"solid") or beginning[80:] == bytes(4)
    if path.suffix.lower() == ".obj":
        words = (line.split()[0] for line in beginning.splitlines() if line.strip())
        return all(word in OBJ_WORDS or word.startswith(b"#") for word in words)
    return True


def check_file(path: Path, limit: int) -> None:
    """Raise `AnswerError` unless `path` is a regular file within the limit."""
    try:
        there = path.is_file()
    except (OSError, ValueError):  # No file can have such a name.
        there = False
    if not there:
        raise AnswerError(f"no such file: {clean(path.name, LONGEST_NAME)}")
    size = path.stat().st_size
    if size == 0:
        raise AnswerError(f"{path.name} has no bytes; an empty mesh has a header at least")
    if size > limit:
        raise AnswerError(f"an absurd mesh: {path.name} has {size:,} bytes", Status.MEMORY)
