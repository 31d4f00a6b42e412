"""What may be in an answer: arrays of real numbers, in memory or in files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isograde.model import Status

Arrays = list[NDArray[Any]]
MESH_FILES = (".ply", ".obj", ".off", ".stl")

# The first words of lines in an .obj file that has no faces, and how much of it is looked at.
OBJ_WORDS = {b"v", b"vn", b"vt", b"o", b"g", b"s", b"mtllib", b"usemtl"}
CHECKED_BYTES = 1 << 16


class AnswerError(ValueError):
    """The answer cannot be judged; `status` says whether it is garbage or too large."""

    def __init__(self, detail: str, status: Status = Status.GARBAGE):
        super().__init__(detail)
        self.status = status


def arrays_from(answer: object) -> Arrays:
    """Vertices and faces of a pair of array-likes; raises `AnswerError`.

    >>> [part.shape for part in arrays_from(([[0, 0, 0]], []))]
    [(1, 3), (0,)]
    >>> arrays_from("done")
    Traceback (most recent call last):
    isograde.adapters.answers.AnswerError: returned str, not a pair of vertices and faces
    """
    if not isinstance(answer, tuple | list) or len(answer) != 2:
        size = f" of {len(answer)}" if isinstance(answer, tuple | list) else ""
        kind = type(answer).__name__
        raise AnswerError(f"returned {kind}{size}, not a pair of vertices and faces")
    return [_array(name, part) for name, part in zip(("vertices", "faces"), answer, strict=True)]


def _array(name: str, part: object) -> NDArray[Any]:
    """The part as a contiguous array of real numbers; raises `AnswerError`."""
    array: NDArray[Any] = _tried(name, lambda: np.asarray(part))
    if array.dtype.kind not in "biuf":
        raise AnswerError(f"{name} ({type(part).__name__}) are not real numbers: {array.dtype}")
    solid: NDArray[Any] = _tried(name, lambda: np.ascontiguousarray(array))
    return solid


def arrays_in(vertices: Path, faces: Path, limit: int) -> Arrays:
    """Vertices and faces of a pair of .npy files; raises `AnswerError`."""
    return arrays_from([_load(path, limit) for path in (vertices, faces)])


def _load(path: Path, limit: int) -> NDArray[Any]:
    """The array in a .npy file; raises `AnswerError`."""
    _check_file(path, limit)
    array: NDArray[Any] = _tried(path.name, lambda: np.load(path, allow_pickle=False))
    return array


def mesh_in(path: Path, limit: int) -> Arrays:
    """Vertices and faces of a mesh file, as they stand in it; raises `AnswerError`.

    STL has no shared vertices: those with equal coordinates are made one.
    """
    if path.suffix.lower() not in MESH_FILES:
        raise AnswerError(f"{path.name}: a mesh file ends in {', '.join(MESH_FILES)}")
    _check_file(path, limit)
    vertices, faces = _tried(path.name, lambda: _read_mesh(path))
    if not len(faces) and not _says_empty(path):
        raise AnswerError(f"{path.name} is no mesh file")
    if path.suffix.lower() == ".stl" and len(vertices):
        vertices, where = np.unique(vertices, axis=0, return_inverse=True)
        faces = where.reshape(-1)[faces]
    return arrays_from((vertices, faces))


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


def _check_file(path: Path, limit: int) -> None:
    """Nothing, where `path` is a regular file within the limit; else raises `AnswerError`."""
    if not path.is_file():
        raise AnswerError(f"no such file: {path.name}")
    size = path.stat().st_size
    if size == 0:
        raise AnswerError(f"{path.name} has no bytes; a mesh without faces has a header at least")
    if size > limit:
        raise AnswerError(f"an absurd mesh: {path.name} has {size:,} bytes", Status.MEMORY)


def _tried(name: str, make: Callable[[], Any]) -> Any:
    """What `make` returns; raises `AnswerError` for whatever it raises."""
    try:
        return make()
    except MemoryError as error:
        raise AnswerError(f"an absurd mesh: {name}: {error}", Status.MEMORY) from error
    except Exception as error:
        raise AnswerError(f"{name} cannot be made an array: {error}") from error
