"""Implementations with one beginner's mistake each, round the reference, which has none."""

import sys
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
