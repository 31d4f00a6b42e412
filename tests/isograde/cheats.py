"""Implementations that cheat, or are right nearly everywhere: each must be caught.

Each is a plain function (values, isovalue, spacing) -> (vertices, faces) with what it claims of
itself, in JSON, and its docstring says what is wrong. `CHEATS` has them all by name. Some answer
nothing, or the same to everything: those may be declared in any way and must reach no level. The
others are made of a correct extractor of `tests.isograde.families`, declare what it declares, and
are wrong where a careless grader does not look.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from isoref import dual_marching_cubes
from isoref.dual import DualRule, in_triangles
from isoref.fast import dual
from isoref.field import Array, Field, Floats, Integers
from isoref.methods import METHODS
from isoref.surface_nets import never
from scipy.ndimage import gaussian_filter
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull

from tests.isograde.families import (
    CORRECT,
    Answer,
    Family,
    Function,
    Spacing,
    by_method,
    cubes,
    dual_cubes,
    label_cubes,
    nets,
    resampled,
    tetrahedra_of_kuhn,
)

CHEATS: dict[str, Family] = {}
# Of these, the ones that give no evidence of anything, whatever is declared.
EMPTY_HANDED: dict[str, Family] = {}

NOTHING: Answer = (np.empty((0, 3)), np.empty((0, 3), np.int64))
TRIANGLE: Answer = (np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))


def cheat(base: Function | None = None, **says: Any) -> Callable[[Function], Function]:
    """The decorator that puts a function among the cheats, declared as `base` is, and as said."""

    def register(function: Function) -> Function:
        name = function.__name__
        inherited: Mapping[str, Any] = CORRECT[base.__name__].says if base else {}
        CHEATS[name] = Family(function, {**inherited, **says, "name": name})
        if base is None:
            EMPTY_HANDED[name] = CHEATS[name]
        return function

    return register


# --------------------------------------------------------------------------------------------
# The same answer to everything, or none
# --------------------------------------------------------------------------------------------


@cheat()
def always_empty(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """No surface in any field."""
    return NOTHING


@cheat()
def always_one_triangle(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """One triangle for every field."""
    return TRIANGLE


@cheat()
def always_one_ball(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The same closed mesh for every field: a ball of radius six, flawless in itself."""
    x = np.indices((17, 17, 17)) - 8.0
    return by_method("dual-marching-cubes", 36 - (x**2).sum(axis=0), 0.0, (1, 1, 1))


@cheat()
def always_a_ball_in_the_middle(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """A ball in the middle of every lattice, as large as there is room."""
    middle = (np.array(values.shape) - 1.0) / 2
    x = np.indices(values.shape) - middle[:, None, None, None]
    radius = max(min(values.shape) / 2 - 2, 0.4)
    return cubes(radius - np.sqrt((x**2).sum(axis=0)), 0.0, spacing)


@cheat()
def declines_everything(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Takes no field at all."""
    raise NotImplementedError("not today")


@cheat()
def fails_everywhere(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """An error for every field."""
    raise ValueError("no such field")


@cheat()
def declines_what_has_a_surface(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Answers only where the answer is empty."""
    if len(cubes(values, isovalue, spacing)[1]):
        raise NotImplementedError("too hard")
    return NOTHING


@cheat()
def flips_a_coin(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Random triangles near the lattice, closed in pairs: each with its opposite."""
    corners = np.random.default_rng().random((30, 3, 3)) * np.maximum(values.shape, 2)
    faces = np.arange(90).reshape(-1, 3)
    return corners.reshape(-1, 3), np.concatenate([faces, faces[:, ::-1]])


@cheat()
def boxes(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The box round the inside samples: closed, a manifold, and in the right place."""
    inside = np.argwhere(Field.of(values).values >= isovalue)
    if not len(inside):
        return NOTHING
    box = np.zeros(values.shape)
    low, high = inside.min(axis=0), inside.max(axis=0) + 1
    box[tuple(slice(a, b) for a, b in zip(low, high, strict=True))] = 1
    return cubes(box, 0.5, spacing)


# --------------------------------------------------------------------------------------------
# Right for some types, layouts and sizes only
# --------------------------------------------------------------------------------------------


@cheat(nets)
def nets_of_doubles_only(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Surface nets that read every type but float64 as if it were shifted by one sample."""
    if values.dtype != np.float64:
        values = np.roll(values, 1, axis=2)
    return nets(values, isovalue, spacing)


@cheat(nets)
def nets_of_c_order_only(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Surface nets that read the memory of the array as if it were in C order."""
    return nets(values.ravel(order="K").reshape(values.shape), isovalue, spacing)


@cheat(cubes)
def little_endian_only(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Reads the bytes of every array as little-endian."""
    return cubes(np.nan_to_num(values.view(values.dtype.newbyteorder("<"))), isovalue, spacing)


@cheat(cubes)
def whole_isovalues(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Cuts the isovalue of integer fields down to an integer."""
    return cubes(values, np.floor(isovalue) if values.dtype.kind in "iu" else isovalue, spacing)


@cheat(cubes)
def unsigned_below_zero(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Subtracts the isovalue in the samples' own type: unsigned ones wrap round below it."""
    values = Field.of(values).values
    if values.dtype.kind == "b":
        values = values.astype(np.uint8)
    with np.errstate(over="ignore", invalid="ignore"):
        relative = values - np.asarray(isovalue).astype(values.dtype)
    return cubes(relative, 0.0 if values.dtype.kind != "u" else 1.0, spacing)


@cheat(cubes)
def names_in_two_bytes(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Numbers vertices in 16 bits: right up to 65,536 of them."""
    vertices, faces = cubes(values, isovalue, spacing)
    return vertices, faces % (1 << 16)


@cheat(cubes)
def axes_of_cubes_swapped(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Swaps two axes, and nobody sees it unless they have different lengths."""
    if len(set(values.shape)) > 1:
        return cubes(values, isovalue, spacing)
    vertices, faces = cubes(values.transpose(1, 0, 2), isovalue, spacing)
    return vertices, faces[:, ::-1]


@cheat(cubes)
def one_spacing_for_all(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Takes the first axis's spacing for all three."""
    return cubes(values, isovalue, (spacing[0],) * 3)


@cheat(cubes)
def powers_of_two_only(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Right for an even number of samples; of an odd number the last is not read."""
    even = Field.of(values).values[tuple(slice(0, max(n - n % 2, 2)) for n in values.shape)]
    return cubes(even, isovalue, spacing)


# --------------------------------------------------------------------------------------------
# A little off
# --------------------------------------------------------------------------------------------


@cheat(nets)
def nets_half_a_cell_off(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Surface nets shifted by half a cell along every axis."""
    vertices, faces = nets(values, isovalue, spacing)
    return vertices - 0.5 * np.asarray(spacing), faces


@cheat(dual_cubes)
def dual_half_a_cell_off(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Dual marching cubes shifted by half a cell along one axis."""
    vertices, faces = dual_cubes(values, isovalue, spacing)
    return vertices + np.array([0, 0, 0.5]) * spacing, faces


@cheat(dual_cubes)
def scaled_to_the_samples(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Larger by n / (n - 1): as if n samples spanned n cells."""
    vertices, faces = dual_cubes(values, isovalue, spacing)
    n = np.array(values.shape)
    return vertices * (n / np.maximum(n - 1, 1)), faces


@cheat(cubes)
def cubes_scaled_to_the_samples(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The same of marching cubes, whose vertices ought to stand on lattice edges."""
    vertices, faces = cubes(values, isovalue, spacing)
    n = np.array(values.shape)
    return vertices * (n / np.maximum(n - 1, 1)), faces


@cheat(cubes)
def in_the_middle(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Crossings in the middle of edges, without saying that it sees labels only."""
    return label_cubes(values, isovalue, spacing)


@cheat(cubes)
def rounded(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Vertices rounded to a hundredth of a cell."""
    vertices, faces = cubes(values, isovalue, (1, 1, 1))
    return np.round(vertices, 2) * np.asarray(spacing), faces


@cheat(cubes)
def smoothed(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Every vertex moved half the way to the mean of its neighbours, for looks."""
    vertices, faces = cubes(values, isovalue, spacing)
    if not len(faces):
        return vertices, faces
    a, b = np.concatenate([faces[:, [i, (i + 1) % 3]] for i in range(3)]).T
    total, count = np.zeros_like(vertices), np.bincount(a, minlength=len(vertices))
    np.add.at(total, a, vertices[b])
    return (vertices + total / np.maximum(count, 1)[:, None]) / 2, faces


@cheat(dual_cubes)
def blurred(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The surface of the field blurred by a cell: small pieces are gone, the rest has shrunk."""
    soft = gaussian_filter(Field.of(values).values.astype(np.float64), 1.0)
    return dual_cubes(soft, isovalue, spacing)


@cheat(vertices={"own": 3})
def far_between(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """A lattice of its own with samples four cells apart, declared with the largest reach."""
    return resampled(4.0, 0.0, values, isovalue, spacing)


EMPTY_HANDED.pop("far_between")


# --------------------------------------------------------------------------------------------
# A little missing
# --------------------------------------------------------------------------------------------


@cheat(dual_cubes)
def without_a_patch(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """A round patch is missing from the top of everything larger than five cells."""
    vertices, faces = dual_cubes(values, isovalue, (1, 1, 1))
    if len(faces) and np.ptp(vertices, axis=0).max() > 5:
        top = vertices[vertices[:, 2].argmax()]
        near = ((vertices - top) ** 2).sum(axis=1) < 1.5**2
        faces = faces[~near[faces].all(axis=1)]
    return vertices * spacing, faces


@cheat(cubes)
def slabs_unwelded(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Works in slabs of 64 layers, and repeats the vertices between them."""
    parts, end = [], 0
    for start in range(0, max(values.shape[0] - 1, 1), 64):
        vertices, faces = cubes(values[start : start + 65], isovalue, spacing)
        parts.append((vertices + np.array([start, 0, 0]) * spacing, faces + end))
        end += len(vertices)
    return np.concatenate([v for v, _ in parts]), np.concatenate([f for _, f in parts])


@cheat(cubes)
def slabs_apart(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Works in slabs of 64 layers, and leaves the layer of cells between two of them out."""
    parts, end = [], 0
    for start in range(0, values.shape[0], 64):
        vertices, faces = cubes(values[start : start + 64], isovalue, spacing)
        parts.append((vertices + np.array([start, 0, 0]) * spacing, faces + end))
        end += len(vertices)
    return np.concatenate([v for v, _ in parts]), np.concatenate([f for _, f in parts])


@cheat(cubes)
def last_layer_missing(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Stops one cell early along the last axis."""
    return cubes(Field.of(values).values[:, :, : max(values.shape[2] - 1, 1)], isovalue, spacing)


@cheat(cubes)
def largest_piece_only(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Of several pieces only the one with the most vertices."""
    vertices, faces = cubes(values, isovalue, spacing)
    if not len(faces):
        return vertices, faces
    ends = np.concatenate([faces[:, :2], faces[:, 1:]]).T
    graph = coo_array((np.ones(ends.shape[1]), ends), shape=(len(vertices),) * 2)
    _, piece = connected_components(graph, directed=False)
    keep = piece[faces[:, 0]] == np.bincount(piece).argmax()
    return renumbered(vertices, faces[keep])


def renumbered(vertices: Floats, faces: Integers) -> Answer:
    """The mesh of these faces, without the vertices that they do not use."""
    used, numbers = np.unique(faces, return_inverse=True)
    return vertices[used], numbers.reshape(faces.shape)


@cheat(cubes)
def one_triangle_in_a_thousand(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Loses every thousandth triangle, as a race between threads may."""
    vertices, faces = cubes(values, isovalue, spacing)
    return vertices, faces[np.arange(len(faces)) % 1000 != 999]


@cheat(cubes)
def ties_left_out(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Leaves every triangle out that touches a lattice point."""
    vertices, faces = cubes(values, isovalue, (1, 1, 1))
    whole = (vertices == np.round(vertices)).all(axis=1)
    return vertices * spacing, faces[~whole[faces].any(axis=1)]


@cheat(cubes)
def hulls(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The convex hull of the right vertices: closed, a manifold, right for convex bodies."""
    vertices, faces = cubes(values, isovalue, spacing)
    if len(vertices) < 5 or np.ptp(vertices, axis=0).min() < 0.1:
        return vertices, faces
    hull = ConvexHull(vertices, qhull_options="QJ")
    rows = hull.simplices.astype(np.int64)
    a, b, c = (vertices[rows[:, k]] for k in range(3))
    inwards = (np.cross(b - a, c - a) * (a - vertices.mean(axis=0))).sum(axis=1) < 0
    return renumbered(vertices, np.where(inwards[:, None], rows[:, ::-1], rows))


# --------------------------------------------------------------------------------------------
# Of another kind than declared
# --------------------------------------------------------------------------------------------

NIELSON = DualRule("nielson", dual_marching_cubes.patches, never)


@cheat(dual_cubes)
def nielsons_own(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Dual marching cubes without Wenger's repair: an edge of four triangles now and then."""
    mesh = in_triangles(*dual.quads(NIELSON, Field.of(values, spacing), isovalue))
    return mesh.vertices, mesh.simplices


@cheat(dual_cubes)
def nets_as_a_manifold(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Surface nets that promise to be a manifold."""
    return nets(values, isovalue, spacing)


@cheat(cubes, level=2)
def holes_of_1987(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Marching cubes of 1987: holes between ambiguous faces."""
    return by_method("lorensen-cline", values, isovalue, spacing)


@cheat(tetrahedra_of_kuhn)
def kuhn_in_a_mirror(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Tetrahedra over Kuhn's split seen in a mirror, declared as Kuhn's."""
    field = Field.of(values[::-1], spacing)
    mesh = METHODS["marching-tetrahedra-kuhn"](field, isovalue)
    end = (values.shape[0] - 1) * field.spacing[0]
    return mesh.vertices * [-1, 1, 1] + [end, 0, 0], mesh.simplices[:, ::-1]


@cheat(cubes)
def cubes_of_tetrahedra(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Marching tetrahedra, declared as marching cubes."""
    return tetrahedra_of_kuhn(values, isovalue, spacing)


@cheat(cubes)
def soup_undeclared(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """A soup that says it is an indexed mesh."""
    vertices, faces = cubes(values, isovalue, spacing)
    return vertices[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3)


@cheat(cubes)
def one_sheet_turned(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Normals to high in the half of the lattice beyond its middle plane."""
    vertices, faces = cubes(values, isovalue, (1, 1, 1))
    beyond = vertices[faces][..., 0].mean(axis=1) > (values.shape[0] - 1) / 2
    return vertices * spacing, np.where(beyond[:, None], faces[:, ::-1], faces)


# --------------------------------------------------------------------------------------------
# Not a function of the field
# --------------------------------------------------------------------------------------------

_REMEMBERED: dict[Any, Answer] = {}


@cheat(cubes)
def remembers_the_shape(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Keeps the answer to the first field of each shape, type and spacing, and gives it again."""
    key = values.shape, values.dtype.str, tuple(spacing)
    if key not in _REMEMBERED:
        _REMEMBERED[key] = cubes(values, isovalue, spacing)
    return _REMEMBERED[key]


@cheat(cubes)
def in_any_order(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Gives the triangles in another order each time, and every now and then one less."""
    vertices, faces = cubes(values, isovalue, spacing)
    order = np.random.default_rng().permutation(len(faces))
    return vertices, faces[order[: len(faces) - len(faces) // 500]]


@cheat(cubes)
def overwrites(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Right, and leaves the samples changed."""
    answer = cubes(values, isovalue, spacing)
    if values.size and values.flags.writeable:
        values.flat[0] = 0 if values.flat[0] else 1
    return answer
