"""A marching cubes that goes by a table, and what goes wrong with such programs, one thing each.

The table is made at import from the reference's answers to single cells: for each configuration the
triangles as triples of lattice edges; ambiguous faces join their inside corners.
"""

from collections.abc import Callable
from itertools import product
from typing import Any

import numpy as np
from isoref.field import Field
from isoref.methods import METHODS

# The usual order of corners.
CORNERS = (
    (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1),
)  # fmt: skip
Edge = tuple[tuple[int, int, int], int]
Table = dict[int, list[tuple[Edge, Edge, Edge]]]


def edge_at(point: Any) -> Edge:
    """The lattice edge of a cell on which this point stands."""
    axis = int(np.flatnonzero(np.abs(point - point.round()) > 1e-6)[0])
    low = [int(x) for x in point.round()]
    low[axis] = 0
    return (low[0], low[1], low[2]), axis


def row_of(number: int) -> list[tuple[Edge, Edge, Edge]]:
    """The triangles of a configuration, bit c for corner c inside."""
    values = np.full((2, 2, 2), -1.0)
    for bit, corner in enumerate(CORNERS):
        if number >> bit & 1:
            values[corner] = 1.0
    mesh = METHODS["asymptotic-decider"](Field.of(values * 0.7 + 0.05), 0.0)
    edges = [edge_at(point) for point in mesh.vertices]
    return [(edges[a], edges[b], edges[c]) for a, b, c in mesh.simplices.tolist()]


TABLE: Table = {number: row_of(number) for number in range(256)}
Share = Callable[[float, float, float, int], float]


def linear(a: float, b: float, level: float, axis: int) -> float:
    """Where the linear interpolant crosses."""
    del axis
    return (level - a) / (b - a)


def made(
    table: Table | None = None,
    share: Share = linear,
    cells: Callable[[tuple[int, ...]], Any] | None = None,
    key: Callable[[Any, int, Any], Any] = lambda at, axis, cell: (at, axis),
) -> Callable[..., Any]:
    """A marching cubes with this table, interpolation, walk, and sharing of vertices."""
    rows = TABLE if table is None else table

    def extract(values: Any, isovalue: float, spacing: Any) -> Any:
        if (
            values.ndim != 3
            or not values.size
            or not np.isfinite(values).all()
            or isovalue != isovalue
        ):
            raise ValueError("no field of finite samples in three axes")
        values = values.astype(float)
        points: dict[Any, int] = {}
        places: list[Any] = []
        triangles = []
        walk = cells(values.shape) if cells else product(*(range(n - 1) for n in values.shape))
        for cell in walk:
            corners = [tuple(x + d for x, d in zip(cell, c, strict=True)) for c in CORNERS]
            number = sum(1 << bit for bit, at in enumerate(corners) if values[at] >= isovalue)
            for triangle in rows[number]:
                indices = []
                for low, axis in triangle:
                    at = tuple(x + d for x, d in zip(cell, low, strict=True))
                    name = key(at, axis, cell)
                    if name not in points:
                        end = tuple(x + (k == axis) for k, x in enumerate(at))
                        t = share(values[at], values[end], isovalue, axis)
                        points[name] = len(places)
                        places.append([x + t * (k == axis) for k, x in enumerate(at)])
                    indices.append(points[name])
                triangles.append(indices)
        vertices = np.array(places, float).reshape(-1, 3) * np.asarray(spacing)
        return vertices, np.array(triangles, int).reshape(-1, 3)

    return extract


def changed(number: int, change: Callable[[list[Any]], list[Any]]) -> Table:
    """The table with one row changed."""
    return {**TABLE, number: change(list(TABLE[number]))}


def entry(row: list[Any]) -> list[Any]:
    """The first triangle's first edge is another edge of the cell."""
    used = {edge for triangle in row for edge in triangle}
    every = [(c, k) for c in CORNERS for k in range(3) if not c[k]]
    other = next(edge for edge in every if edge not in used)
    return [(other, *row[0][1:]), *row[1:]]


def epsilon(a: float, b: float, level: float, axis: int) -> float:
    """As in a widely copied program: a difference below 1e-5 is none."""
    if abs(level - a) < 1e-5 or abs(a - b) < 1e-5:
        return 0.0
    return 1.0 if abs(level - b) < 1e-5 else linear(a, b, level, axis)


def flipped(row: list[Any]) -> list[Any]:
    """Each triangle the other way round."""
    return [(a, c, b) for a, b, c in row]


extract = made()
wrong_entry = made(changed(35, entry))
flipped_row = made(changed(35, flipped))
flipped_triangle = made(changed(35, lambda row: [flipped(row)[0], *row[1:]]))
missing_triangle = made(changed(35, lambda row: row[1:]))
missing_middle = made(changed(15 ^ 1 ^ 255, lambda row: row[:1] + row[2:]))
missing_row = made(changed(7, lambda row: []))
doubled_row = made(changed(7, lambda row: [*row, *row]))
swapped = made(share=lambda a, b, level, axis: 1 - linear(a, b, level, axis))
swapped_axis = made(share=lambda a, b, level, axis: abs((axis == 1) - linear(a, b, level, axis)))
halved_axis = made(share=lambda a, b, level, axis: 0.5 if axis == 2 else linear(a, b, level, axis))
with_epsilon = made(share=epsilon)
bent = made(share=lambda a, b, level, axis: linear(a, b, level, axis) ** 1.5)
one_layer_short = made(
    cells=lambda shape: product(range(shape[0] - 1), range(shape[1] - 1), range(shape[2] - 2))
)
seam = made(key=lambda at, axis, cell: (at, axis, cell[2] // 32))
seam_left_out = made(
    cells=lambda shape: (c for c in product(*(range(n - 1) for n in shape)) if c[0] % 16 != 15)
)


def upside_down(values: Any, isovalue: float, spacing: Any) -> Any:
    """Samples counted from the other end along the first axis."""
    return extract(values[::-1], isovalue, spacing)


def isovalue_left_out(values: Any, isovalue: float, spacing: Any) -> Any:
    """The surface of 0, whatever was asked."""
    del isovalue
    return extract(values, 0.0, spacing)


def both_sides(values: Any, isovalue: float, spacing: Any) -> Any:
    """Every triangle once more, turned over."""
    vertices, faces = extract(values, isovalue, spacing)
    return vertices, np.concatenate([faces, faces[:, ::-1]])


def every_twice(values: Any, isovalue: float, spacing: Any) -> Any:
    """Every triangle twice."""
    vertices, faces = extract(values, isovalue, spacing)
    return vertices, np.concatenate([faces, faces])


RANDOM = np.random.default_rng()


def moody(values: Any, isovalue: float, spacing: Any) -> Any:
    """Now and then a triangle is lost."""
    vertices, faces = extract(values, isovalue, spacing)
    keep = RANDOM.random(len(faces)) > 0.1
    return vertices, faces[keep]


def shuffled(values: Any, isovalue: float, spacing: Any) -> Any:
    """Triangles in another order each time."""
    vertices, faces = extract(values, isovalue, spacing)
    return vertices, RANDOM.permutation(faces)


def padded(values: Any, isovalue: float, spacing: Any) -> Any:
    """A layer of low samples all round, and vertices counted from it."""
    return extract(np.pad(values, 1, constant_values=values.min()), isovalue, spacing)


def capped(values: Any, isovalue: float, spacing: Any) -> Any:
    """A layer of low samples all round, taken back: closed at the border."""
    low = np.pad(values.astype(float), 1, constant_values=float(values.min()) - 1)
    vertices, faces = extract(low, isovalue, spacing)
    return vertices - np.asarray(spacing), faces


def bytes_only(values: Any, isovalue: float, spacing: Any) -> Any:
    """Declines what is not bytes; interpolation swapped along one axis."""
    if values.dtype != np.uint8:
        raise NotImplementedError("bytes only")
    return swapped_axis(values, isovalue, spacing)


def cubes_only(values: Any, isovalue: float, spacing: Any) -> Any:
    """Declines what is no cube; in samples."""
    if len(set(values.shape)) > 1:
        raise NotImplementedError("cubes only")
    return extract(values, isovalue, (1, 1, 1))


def swapped_axes(values: Any, isovalue: float, spacing: Any) -> Any:
    """The first two coordinates exchanged."""
    vertices, faces = extract(values, isovalue, spacing)
    return vertices[:, [1, 0, 2]], faces[:, ::-1]


def stretched(values: Any, isovalue: float, spacing: Any) -> Any:
    """Scaled by n / (n - 1)."""
    vertices, faces = extract(values, isovalue, spacing)
    shape = np.array(values.shape)
    return vertices * shape / (shape - 1), faces
