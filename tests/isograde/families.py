"""Correct extractors of different families, conventions and layouts.

Each is a plain function (values, isovalue, spacing) -> (vertices, faces), and each is right: what
is true of it stands in its docstring and, in the words of a declaration, in what `correct` is given
beside it. A grader that fails one of them raises a false alarm. `CORRECT` has them all by name.

They are made of the methods of the reference and differ in what is done to the samples before and
to the mesh behind, in index coordinates wherever the spacing plays no part.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from isoref import dual_marching_cubes, marching_tetrahedra, surface_nets, trilinear_cubes
from isoref.cube import CORNERS, EDGES, FACE_CORNERS, ambiguous_faces
from isoref.cycles import Triangle, cycles
from isoref.dual import DualRule
from isoref.fast import dual
from isoref.fast.sweep import sweep
from isoref.field import Array, Field, Floats, Integers, check_isovalue
from isoref.marching_tetrahedra import Split
from isoref.methods import METHODS
from isoref.rule import Rule, Tile
from isoref.sweep import check_volume

Spacing = Sequence[float]
Answer = tuple[Any, Any]
Function = Callable[[Array, float, Spacing], Answer]


@dataclass(frozen=True)
class Family:
    """A correct extractor, and what it says of itself, as a declaration in JSON."""

    function: Function
    says: Mapping[str, Any]


CORRECT: dict[str, Family] = {}


def correct(**says: Any) -> Callable[[Function], Function]:
    """The decorator that puts a function among the correct ones, with its declaration."""

    def register(function: Function) -> Function:
        name = function.__name__
        CORRECT[name] = Family(function, {"name": name, **says})
        return function

    return register


def by_method(name: str, values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The mesh of a method of the catalogue, as arrays."""
    mesh = METHODS[name](Field.of(values, spacing), isovalue)
    return mesh.vertices, mesh.simplices


def checked(values: Array, isovalue: float) -> Array:
    """The samples, where they are those of a scalar volume and the isovalue is a number."""
    field = Field.of(values)
    check_volume(field)
    check_isovalue(isovalue)
    return field.values


def in_soup(vertices: Floats, faces: Integers) -> Answer:
    """Every face with corners of its own."""
    size = faces.shape[1]
    return vertices[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, size)


CUBES = "asymptotic-decider"
HALF_INSIDE = {"inset": 0.5, "end": "open"}
SOUP = {"soup": 1e-9}
NOT_MANIFOLD = ["topology.manifold"]
TYPES = ["bool", "uint8", "int8", "uint16", "int16", "uint32", "int32"]
FLOATS = ["float16", "float32", "float64"]


def lattice_simplices(split: Split) -> list[list[list[int]]]:
    """The simplices of a split as lists of the corners' coordinates in its block."""
    return [
        [np.add(cell, CORNERS[c]).tolist() for c in tetrahedron.corners]
        for cell in np.ndindex(split.block)
        for tetrahedron in split.at(cell)
    ]


# --------------------------------------------------------------------------------------------
# Rules of the cube
# --------------------------------------------------------------------------------------------


@correct(level=3)
def cubes(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Marching cubes with the asymptotic decider: bilinear on every face."""
    return by_method(CUBES, values, isovalue, spacing)


@correct(level=3, mesh=SOUP)
def cubes_in_soup(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The same, each triangle with corners of its own; equal ones are equal to the last digit."""
    return in_soup(*cubes(values, isovalue, spacing))


@correct(mesh={"soup": 1e-6})
def cubes_in_soup_from_either_end(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """A soup whose equal corners differ by up to 1e-7 of a cell.

    Every other triangle interpolates its edges from their upper ends, with shares in single
    precision. As a soup with a tolerance it is closed; judged to the last digit it is not.
    """
    vertices, faces = cubes(values, isovalue, (1, 1, 1))
    low = np.floor(vertices)
    share = vertices - low
    from_below = low + np.float32(1) * share.astype(np.float32)
    from_above = (low + 1) - (1 - share).astype(np.float32)
    from_above = np.where(share == 0, vertices, from_above)
    odd = (np.arange(len(faces)) % 2 == 1)[:, None, None]
    corners = np.where(odd, from_above[faces], from_below[faces]) * spacing
    return corners.reshape(-1, 3), np.arange(faces.size).reshape(-1, 3)


@correct(level=4)
def trilinear(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Marching cubes with the topology of the trilinear interpolant in every cell."""
    return by_method("trilinear-cubes", values, isovalue, spacing)


@correct(level=4)
def trilinear_with_flat_triangles(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The same topology, with pairs of triangles that lie flat in upper faces of cells.

    The two triangles of a face belong to the cell below it. No edge has more than two triangles.
    """
    mesh = sweep(COLLARED, Field.of(values, spacing), isovalue)
    return mesh.vertices, mesh.simplices


def collared(faces: Sequence[int], careful: bool = True) -> Rule:
    """Trilinear cubes with collars on these faces, where that is right; else wherever it can be.

    Where an ambiguous face cuts a polygon in two when it is decided the other way, the cell decides
    it so, and puts a quad into the face, a *collar*, that makes one polygon of the two again.
    """

    def tile(signs: int, decisions: int) -> Tile:
        if decisions & ~trilinear_cubes.FACE_BITS:
            return trilinear_cubes.tile(signs, decisions)
        now, more = decisions, []
        for face in ambiguous_faces(signs):
            flipped = now ^ 1 << face
            grown = len(cycles(signs, flipped)) - len(cycles(signs, now))
            if face in faces and (grown == 1 or not careful):
                now = flipped
                more.append(face)
        plain = trilinear_cubes.tile(signs, now)
        quads = [triangle for face in more for triangle in collar(signs, now, face)]
        return Tile((*plain.triangles, *quads), plain.interior)

    return Rule("collared", tile, trilinear_cubes.decisions, trilinear_cubes.asks, 8)


def collar(signs: int, separated: int, face: int) -> list[Triangle]:
    """The quad between the two segments that these decisions put on a face, as two triangles."""
    on = {e for e, ends in enumerate(EDGES) if set(ends) <= set(FACE_CORNERS[face])}
    arcs = [
        (p, q)
        for polygon in cycles(signs, separated)
        for p, q in zip(polygon, (*polygon[1:], polygon[0]), strict=True)
        if {p, q} <= on
    ]
    (a, b), (c, d) = arcs
    return [(b, a, d), (b, d, c)]


COLLARED = collared((1, 3, 5))


# --------------------------------------------------------------------------------------------
# Dual methods
# --------------------------------------------------------------------------------------------


def quads(rule: DualRule, values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The quadrilaterals of a dual method."""
    return dual.quads(rule, Field.of(values, spacing), isovalue)


@correct(vertices="cells", domain=HALF_INSIDE, not_promised=NOT_MANIFOLD)
def nets(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Naive surface nets: closed, but edges of four triangles at ambiguous faces."""
    return by_method("surface-nets", values, isovalue, spacing)


@correct(vertices="cells", domain=HALF_INSIDE, not_promised=NOT_MANIFOLD)
def nets_of_quads(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The same in quadrilaterals."""
    return quads(surface_nets.RULE, values, isovalue, spacing)


@correct(vertices="cells", domain=HALF_INSIDE, not_promised=NOT_MANIFOLD, mesh=SOUP)
def nets_in_soup(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The same, each triangle with corners of its own."""
    return in_soup(*nets(values, isovalue, spacing))


@correct(vertices="cells", domain=HALF_INSIDE)
def dual_cubes(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Dual marching cubes with Wenger's repair: a manifold, whatever the signs."""
    return by_method("dual-marching-cubes", values, isovalue, spacing)


@correct(vertices="cells", domain=HALF_INSIDE)
def dual_cubes_of_quads(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The same in quadrilaterals."""
    return quads(dual_marching_cubes.RULE, values, isovalue, spacing)


@correct(vertices="cells", domain=HALF_INSIDE, mesh=SOUP)
def dual_cubes_in_soup(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The same, each triangle with corners of its own."""
    return in_soup(*dual_cubes(values, isovalue, spacing))


@correct(vertices="cells", domain=HALF_INSIDE, mesh=SOUP)
def dual_cubes_of_quads_in_soup(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The same, each quadrilateral with corners of its own."""
    return in_soup(*dual_cubes_of_quads(values, isovalue, spacing))


# --------------------------------------------------------------------------------------------
# Tetrahedra and labels
# --------------------------------------------------------------------------------------------


@correct(interpolant="kuhn")
def tetrahedra_of_kuhn(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Marching tetrahedra over Kuhn's six, whose interpolant is the simplicial one."""
    return by_method("marching-tetrahedra-kuhn", values, isovalue, spacing)


@correct(interpolant="kuhn", mesh=SOUP)
def tetrahedra_of_kuhn_in_soup(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The same, each triangle with corners of its own."""
    return in_soup(*tetrahedra_of_kuhn(values, isovalue, spacing))


@correct(interpolant="kuhn")
def simplices_of_min(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Min's surface over Kuhn's split, by sections of simplices."""
    return by_method("simplicial", values, isovalue, spacing)


@correct(interpolant={"tetrahedra": lattice_simplices(marching_tetrahedra.FIVE)})
def tetrahedra_of_five(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Marching tetrahedra over the alternating five: alike after every two cells."""
    return by_method("marching-tetrahedra-five", values, isovalue, spacing)


@correct(interpolant={"tetrahedra": lattice_simplices(marching_tetrahedra.FIVE)}, mesh=SOUP)
def tetrahedra_of_five_in_soup(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The same, each triangle with corners of its own."""
    return in_soup(*tetrahedra_of_five(values, isovalue, spacing))


@correct(interpolant="labels")
def label_cubes(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Marching cubes of inside and outside: crossings in the middle of lattice edges."""
    return by_method("label-cubes", values, isovalue, spacing)


@correct(interpolant="labels", mesh=SOUP)
def label_cubes_in_soup(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The same, each triangle with corners of its own."""
    return in_soup(*label_cubes(values, isovalue, spacing))


@correct(interpolant="labels", vertices="cells", domain=HALF_INSIDE)
def dual_cubes_of_labels(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Dual marching cubes of inside and outside, as label filters with vertices in cells."""
    inside = np.where(checked(values, isovalue) >= isovalue, 1.0, -1.0)
    return dual_cubes(inside, 0.0, spacing)


# --------------------------------------------------------------------------------------------
# A lattice of its own
# --------------------------------------------------------------------------------------------


def resampled(
    step: float, inset: float, values: Array, isovalue: float, spacing: Spacing
) -> Answer:
    """Marching cubes of the trilinear interpolant's samples on a lattice of its own.

    Its samples lie `step` cells apart or a little less, from `inset` behind the first sample of the
    field to `inset` before the last.
    """
    samples, steps = checked(values, isovalue).astype(np.float64), []
    for axis, n in enumerate(values.shape):
        span = n - 1 - 2 * inset
        own = int(np.ceil(span / step - 1e-9)) + 1
        if own < 2:
            return np.empty((0, 3)), np.empty((0, 3), np.int64)
        samples = along(samples, inset + np.linspace(0, span, own), axis)
        steps.append(span / (own - 1))
    vertices, faces = cubes(samples, isovalue, (1, 1, 1))
    return (vertices * steps + inset) * spacing, faces


def along(samples: Floats, places: Floats, axis: int) -> Floats:
    """Samples interpolated linearly along an axis at places in index coordinates."""
    low = np.clip(np.floor(places).astype(int), 0, samples.shape[axis] - 2)
    share = np.reshape(places - low, [-1 if a == axis else 1 for a in range(3)])
    below, above = samples.take(low, axis), samples.take(low + 1, axis)
    return np.asarray(below * (1 - share) + above * share)


@correct(vertices={"own": 2 / 3 * 3**0.5})
def resampled_finer(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Samples the trilinear interpolant at least every 2/3 of a cell, border included."""
    return resampled(2 / 3, 0.0, values, isovalue, spacing)


@correct(vertices={"own": 1.5 * 3**0.5}, domain=HALF_INSIDE)
def resampled_coarser(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Samples the trilinear interpolant every 1.5 cells or less, half a cell off the border."""
    return resampled(1.5, 0.5, values, isovalue, spacing)


@correct(vertices={"own": 3**0.5}, domain=HALF_INSIDE)
def resampled_at_centres(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Takes the mean of its corners for the sample of a cell: a lattice shifted by half a step."""
    return resampled(1.0, 0.5, values, isovalue, spacing)


@correct(vertices={"own": 1.5 * 3**0.5}, domain=HALF_INSIDE, mesh=SOUP)
def resampled_coarser_in_soup(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The coarser one, each triangle with corners of its own."""
    return in_soup(*resampled_coarser(values, isovalue, spacing))


# --------------------------------------------------------------------------------------------
# Other conventions
# --------------------------------------------------------------------------------------------


@correct(conventions={"normals": "to_high"})
def normals_to_high(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Right-hand normals point from low to high."""
    vertices, faces = cubes(values, isovalue, spacing)
    return vertices, faces[:, ::-1]


@correct(conventions={"axes": "reversed"})
def axes_reversed(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Coordinates in the order x, y, z of an array z, y, x; normals to low in these coordinates."""
    vertices, faces = cubes(values, isovalue, spacing)
    return vertices[:, ::-1], faces[:, ::-1]


@correct(conventions={"axes": "reversed", "normals": "to_high"})
def axes_reversed_alone(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """The same with faces left as they are: a mirror image, so that normals point to high."""
    vertices, faces = cubes(values, isovalue, spacing)
    return vertices[:, ::-1], faces


@correct(conventions={"units": "index"})
def index_units(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Vertices counted in samples, whatever the spacing."""
    return cubes(values, isovalue, (1, 1, 1))


@correct(conventions={"tie": "outside"}, limits={"types": [*TYPES, *FLOATS]})
def ties_outside(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """A sample equal to the isovalue counts as low; takes types that float64 holds exactly."""
    vertices, faces = cubes(-checked(values, isovalue).astype(np.float64), -isovalue, spacing)
    return vertices, faces[:, ::-1]


@correct(conventions={"empty": "raises"})
def raises_where_empty(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """An error where there is no surface."""
    vertices, faces = cubes(values, isovalue, spacing)
    if not len(faces):
        raise ValueError("the isovalue is out of range")
    return vertices, faces


@correct(conventions={"nan": "answers"})
def answers_nan(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Takes a sample that is not a number for a very low one."""
    if values.dtype.kind == "f":
        values = np.nan_to_num(values, nan=-1e30 if values.itemsize > 2 else -1e4)
    return cubes(values, isovalue, spacing)


@correct()
def single_vertices(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Vertices in single precision."""
    vertices, faces = cubes(values, isovalue, spacing)
    return vertices.astype(np.float32), faces


@correct()
def short_faces(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Faces as 32-bit integers."""
    vertices, faces = cubes(values, isovalue, spacing)
    return vertices, faces.astype(np.int32)


@correct()
def unsigned_faces(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Faces as unsigned 32-bit integers of the other byte order, vertices of it too."""
    vertices, faces = cubes(values, isovalue, spacing)
    return vertices.astype(">f8"), faces.astype(">u4")


@correct()
def fortran_ordered(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Both arrays in Fortran's order."""
    vertices, faces = cubes(values, isovalue, spacing)
    return np.asfortranarray(vertices), np.asfortranarray(faces)


@correct(limits={"samples": 20_000})
def lists(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Plain lists; an answer without a surface is two empty ones. Small fields only."""
    if values.size > 20_000:
        raise NotImplementedError("20,000 samples at most")
    vertices, faces = cubes(values, isovalue, spacing)
    return vertices.tolist(), faces.tolist()


@correct(limits={"types": ["float32"]})
def singles_only(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Takes single precision, and nothing else."""
    if values.dtype.name != "float32":
        raise TypeError(f"expected float32, not {values.dtype}")
    return cubes(values, isovalue, spacing)


@correct(limits={"cubes": True, "least": 2, "greatest": 96})
def cubes_only(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Takes as many samples along each axis, 2 to 96."""
    if len(set(values.shape)) > 1 or not 2 <= values.shape[0] <= 96:
        raise NotImplementedError("cubes of 2 to 96 samples a side only")
    return cubes(values, isovalue, spacing)


@correct(
    conventions={
        "normals": "to_low",
        "axes": "reversed",
        "units": "index",
        "tie": "outside",
        "empty": "raises",
    },
    limits={"types": [*TYPES, *FLOATS]},
    mesh={"soup": 1e-4},
)
def all_otherwise(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Everything at once: axes reversed, samples counted, ties outside, a soup in single precision.

    Corners are rounded to single precision: 1e-4 of a cell up to a thousand samples an axis.
    """
    vertices, faces = ties_outside(values, isovalue, (1, 1, 1))
    if not len(faces):
        raise ValueError("the isovalue is out of range")
    corners, soup = in_soup(vertices[:, ::-1], faces[:, ::-1])
    return corners.astype(np.float32), soup.astype(np.int32)


# --------------------------------------------------------------------------------------------
# Other ends
# --------------------------------------------------------------------------------------------


@correct(domain={"inset": 1, "end": "open"})
def cropped(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Leaves the outermost layer of cells out: the surface ends one cell inside."""
    inner = checked(values, isovalue)[1:-1, 1:-1, 1:-1]
    if not inner.size:
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    vertices, faces = cubes(inner, isovalue, spacing)
    return vertices + spacing, faces


@correct(domain={"inset": -0.5, "end": "closed"})
def capped_outside(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Closes the surface half a cell outside the border.

    Beyond each border sample there is one as far on the other side, so the edge between is crossed
    in its middle where the border sample is inside, and nowhere else; a sample on the isovalue is
    cut off just behind the border sample.
    """
    relative = checked(values, isovalue).astype(np.float64) - isovalue
    padded = np.pad(relative, 1, mode="edge")
    beyond = np.ones(padded.shape, bool)
    beyond[1:-1, 1:-1, 1:-1] = False
    padded[beyond] = -np.maximum(np.abs(padded[beyond]), np.finfo(np.float64).tiny)
    vertices, faces = cubes(padded, 0.0, (1, 1, 1))
    return (vertices - 1) * spacing, faces


@correct(domain="closed")
def capped(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Closes the surface in the planes of the border, with flat triangles there."""
    vertices, faces = capped_outside(values, isovalue, (1, 1, 1))
    last = np.subtract(values.shape, 1)
    flat = np.clip(vertices, 0, last)
    # Where two or three faces of the border meet, points that were moved have become one.
    moved = (flat != vertices).any(axis=1)
    name = np.arange(len(vertices))
    if moved.any():
        _, first, which = np.unique(flat[moved], axis=0, return_index=True, return_inverse=True)
        name[moved] = np.flatnonzero(moved)[first][which.ravel()]
    faces = name[faces]
    whole = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    used, numbers = np.unique(faces[whole], return_inverse=True)
    return flat[used] * spacing, numbers.reshape(-1, 3)


@correct(domain="periodic")
def periodic(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Takes the field for periodic: a cell more along each axis, from the last sample to the first.

    Vertices run from 0 to N samples; those in the last plane repeat those in the first.
    """
    return cubes(np.pad(checked(values, isovalue), (0, 1), mode="wrap"), isovalue, spacing)


# --------------------------------------------------------------------------------------------
# Those that take so little that a field must be posed for them
# --------------------------------------------------------------------------------------------


def bytes_only(values: Array, isovalue: float, spacing: Spacing) -> Answer:
    """Takes bytes, as scanners give them, and nothing else."""
    if values.dtype.name != "uint8":
        raise TypeError(f"expected uint8, not {values.dtype}")
    return cubes(values, isovalue, spacing)


NARROW = {"bytes_only": Family(bytes_only, {"limits": {"types": ["uint8"]}})}
"""Judged with the others by the grader, which poses fields within these limits."""
