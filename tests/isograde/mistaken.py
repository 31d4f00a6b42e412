"""Implementations with one beginner's mistake each, round the reference, which has none."""

import sys
import time
from typing import Any

import numpy as np
from isoref.field import Field
from isoref.methods import METHODS


def correct(values: Any, isovalue: float, spacing: Any) -> Any:
    mesh = METHODS["asymptotic-decider"](Field.of(values, spacing), isovalue)
    return mesh.vertices, mesh.simplices


def turned(*asked: Any) -> Any:
    vertices, faces = correct(*asked)
    return vertices, faces[:, ::-1]


def reversed_axes(*asked: Any) -> Any:
    vertices, faces = correct(*asked)
    return vertices[:, ::-1], faces[:, ::-1]


def unscaled(values: Any, isovalue: float, spacing: Any) -> Any:
    return correct(values, isovalue, (1, 1, 1))


def shifted(*asked: Any) -> Any:
    vertices, faces = correct(*asked)
    return vertices + 100, faces


def one_based(*asked: Any) -> Any:
    vertices, faces = correct(*asked)
    return vertices, faces + 1


def out_of_range(*asked: Any) -> Any:
    vertices, faces = correct(*asked)
    return vertices, faces - 5


def float_faces(*asked: Any) -> Any:
    vertices, faces = correct(*asked)
    return vertices, faces * 1.0


def transposed(*asked: Any) -> Any:
    vertices, faces = correct(*asked)
    return vertices.T, faces


def flat(*asked: Any) -> Any:
    vertices, faces = correct(*asked)
    return vertices, faces.ravel()


def counted(*asked: Any) -> Any:
    """Faces with a leading 3, as VTK stores them."""
    vertices, faces = correct(*asked)
    return vertices, np.insert(faces, 0, 3, axis=1)


def not_finite(*asked: Any) -> Any:
    vertices, faces = correct(*asked)
    return np.where(vertices == vertices.max(), np.nan, vertices), faces


def nothing(*asked: Any) -> Any:
    correct(*asked)


def four(*asked: Any) -> Any:
    return (*correct(*asked), None, None)


def two_parameters(values: Any, isovalue: float) -> Any:
    return correct(values, isovalue, (1, 1, 1))


def empty(*asked: Any) -> Any:
    return np.empty((0, 3)), np.empty((0, 3), int)


def printing(*asked: Any) -> Any:
    print("marching")
    print("still marching", file=sys.stderr)
    return correct(*asked)


def overwriting(values: Any, isovalue: float, spacing: Any) -> Any:
    answer = correct(values, isovalue, spacing)
    values -= np.asarray(isovalue).astype(values.dtype)
    return answer


def fussy(values: Any, isovalue: float, spacing: Any) -> Any:
    if values.dtype != np.float64 or not values.flags.c_contiguous:
        raise TypeError("buffer dtype mismatch")
    return correct(values, isovalue, spacing)


def careless(values: Any, isovalue: float, spacing: Any) -> Any:
    """Reads the memory of the array as if it were in C order."""
    memory = values.ravel(order="K").reshape(values.shape)
    return correct(memory, isovalue, spacing)


def raising_where_empty(*asked: Any) -> Any:
    vertices, faces = correct(*asked)
    if not len(faces):
        raise ValueError("no surface")
    return vertices, faces


def ignoring_nan(values: Any, isovalue: float, spacing: Any) -> Any:
    return correct(np.nan_to_num(values), isovalue, spacing)


def declared(*asked: Any) -> Any:
    return turned(*asked)


declared.declaration = {  # type: ignore[attr-defined]
    "name": "turned on purpose",
    "level": 1,
    "conventions": {"normals": "to_high"},
}


def misdeclared(*asked: Any) -> Any:
    return correct(*asked)


misdeclared.declaration = lambda: {"level": "high"}  # type: ignore[attr-defined]


KEPT: dict[str, Any] = {}


def shared_in_cells(values: Any, isovalue: float, spacing: Any) -> Any:
    """Triangles share their vertices within a cell, and not with those of the next."""
    vertices, faces = correct(values, isovalue, (1.0, 1.0, 1.0))
    cells = np.floor(vertices[faces].mean(axis=1)).astype(int)
    _, cell = np.unique(cells, axis=0, return_inverse=True)
    keys = cell.reshape(-1, 1) * (len(vertices) + 1) + faces
    names, rows = np.unique(keys, return_inverse=True)
    return vertices[names % (len(vertices) + 1)] * spacing, rows.reshape(-1, 3)


def soup_of_cells(*asked: Any) -> Any:
    """The same, which says so."""
    return shared_in_cells(*asked)


soup_of_cells.declaration = {"mesh": {"soup": 1e-6}}  # type: ignore[attr-defined]


def raising_on_small_fields(values: Any, isovalue: float, spacing: Any) -> Any:
    """Fields of three samples along each axis are refused with an error."""
    if values.shape == (3, 3, 3):
        raise ValueError("odd shape")
    return correct(values, isovalue, spacing)


def hanging(*asked: Any) -> Any:
    """It never comes back."""
    while True:
        time.sleep(1)


def buffered(*asked: Any) -> Any:
    """The vertices of every answer stand in one array, which the next call writes over."""
    vertices, faces = correct(*asked)
    store = KEPT.setdefault("store", np.empty((100_000, 3)))
    store[: len(vertices)] = vertices
    return store[: len(vertices)], faces


def by_array(values: Any, isovalue: float, spacing: Any) -> Any:
    """The samples of an array are read once, and not again when it was written to."""
    if KEPT.get("array") is not values:
        KEPT.update(array=values, samples=values.copy())
    return correct(KEPT["samples"], isovalue, spacing)


def with_globals(values: Any, isovalue: float, spacing: Any) -> Any:
    """The samples are put where every thread finds them, and taken from there a little later."""
    KEPT["values"] = values
    time.sleep(0.02)
    return correct(KEPT["values"], isovalue, spacing)


def leaking(*asked: Any) -> Any:
    """Every answer is kept for ever."""
    answer = correct(*asked)
    KEPT.setdefault("answers", []).append([part.copy() for part in answer])
    return answer


def searching(*asked: Any) -> Any:
    """One vertex in thirty-two is looked for among all."""
    vertices, faces = correct(*asked)
    for vertex in vertices[::32]:
        (np.abs(vertices - vertex) < 1e-12).all(axis=1).any()
    return vertices, faces


def squaring(values: Any, isovalue: float, spacing: Any) -> Any:
    """Time is spent that grows as the square of the number of samples."""
    end = time.process_time() + 0.004 * (values.size / 15_600) ** 2
    while time.process_time() < end:
        pass
    return correct(values, isovalue, spacing)


def hoarding(*asked: Any) -> Any:
    """A table with a row and a column for every fifth vertex."""
    vertices, faces = correct(*asked)
    table = np.ones((len(vertices) // 5, len(vertices) // 5), np.int8)
    return vertices + 0 * table[:1, :1].sum(), faces


def with_epsilon(values: Any, isovalue: float, spacing: Any) -> Any:
    """Differences below a millionth count as none, whatever the values' size."""
    level = np.asarray(values, float) - isovalue
    return correct(np.where(np.abs(level) < 1e-6, 1e-6, level), 0.0, spacing)


def in_single_precision(values: Any, isovalue: float, spacing: Any) -> Any:
    """The samples are rounded before the isovalue is taken off."""
    with np.errstate(over="ignore"):
        single = np.asarray(values).astype(np.float32)
    return correct(single, isovalue, spacing)


def tunnels_on_one_side(values: Any, isovalue: float, spacing: Any) -> Any:
    """The trilinear interpolant where the first sample is below the last, and no tunnels else."""
    rising = float(values.flat[0]) < float(values.flat[-1])
    method = METHODS["trilinear-cubes" if rising else "asymptotic-decider"]
    mesh = method(Field.of(values, spacing), isovalue)
    return mesh.vertices, mesh.simplices


def turned_on_one_side(values: Any, isovalue: float, spacing: Any) -> Any:
    """A face in the middle is turned over where the first sample is below the last."""
    vertices, faces = correct(values, isovalue, spacing)
    if len(faces) and float(values.flat[0]) < float(values.flat[-1]):
        faces[len(faces) // 2] = faces[len(faces) // 2, ::-1]
    return vertices, faces
