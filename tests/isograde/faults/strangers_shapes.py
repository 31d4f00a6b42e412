"""Faults of strangers: geometry, topology and other families, in what strong engineers ship.

Thresholds that suit the author's own volumes, one row of a large table, keys that are long enough
for the sizes at hand. They were written without a look at the plan, to see what it lets pass.
"""

from __future__ import annotations

from functools import cache, partial
from typing import Any, ClassVar

import numpy as np
from isoref import asymptotic_decider, dual_marching_cubes, trilinear_cubes
from isoref.cube import CORNER_OFFSETS, EDGE_CORNERS, configuration
from isoref.cycles import cycles
from isoref.dual import DualRule
from isoref.fast import dual, marching_tetrahedra, simplicial
from isoref.field import Field
from isoref.marching_tetrahedra import FIVE
from isoref.rule import Rule, Tile, decide_faces, has_ambiguous_face
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tests.isograde.faults.engine import Answer, Array, Engine, Spacing
from tests.isograde.faults.registry import fault

stranger = partial(fault, blind=True, level=3)


def merged(vertices: Array, triangles: Array, keys: Array) -> Answer:
    """Vertices with equal keys made one, and triangles that lose a corner dropped."""
    _, first, number = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    rows = number.reshape(-1)[triangles]
    whole = np.all([rows[:, a] != rows[:, b] for a, b in ((0, 1), (1, 2), (2, 0))], axis=0)
    return vertices[first], rows[whole]


@stranger("topology.sides")
class RoundedToFiveDigits(Engine):
    """A soup is welded by world coordinates rounded to five decimals, whatever the spacing."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The answer, welded."""
        made, rows = super().finish(vertices, triangles, spacing, shape)
        return merged(made, rows, np.asarray(np.round(made, 5)))


@stranger("topology.sides")
class CleanedByDiagonal(Engine):
    """Vertices within a millionth of the mesh's diagonal become one, as a cleaning filter does."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The answer, welded."""
        made, rows = super().finish(vertices, triangles, spacing, shape)
        size = 1e-6 * float(np.linalg.norm(np.ptp(made, axis=0)))
        return merged(made, rows, np.round(made / size)) if size > 0 else (made, rows)


@stranger("topology.sides")
class NoAreaNoTriangle(Engine):
    """Triangles of less than 1e-12 square units are dropped as degenerate, their holes left."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The answer without slivers."""
        made, rows = super().finish(vertices, triangles, spacing, shape)
        a, b, c = (made[rows[:, k]] for k in range(3))
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
        # What has no area at all is left, as it was for fields with ties.
        return made, rows[(area >= 1e-12) | (area == 0)]


@stranger("topology.sides")
class DustedOff(Engine):
    """Closed pieces of less than a hundred-thousandth of a cell are taken for dust and dropped."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The answer without dust."""
        n = len(vertices)
        ends = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
        graph = coo_array((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(n, n))
        count, piece = connected_components(graph, directed=False)
        own = piece[triangles[:, 0]] if len(triangles) else np.empty(0, np.int64)
        # A piece is closed where every edge is passed both ways.
        forth = np.unique(ends[:, 0] * n + ends[:, 1])
        lone = ~np.isin(ends[:, 1] * n + ends[:, 0], forth)
        is_open = np.bincount(piece[ends[lone, 0]], minlength=count) > 0
        origin = np.zeros((count, 3))
        origin[piece] = vertices
        a, b, c = (vertices[triangles[:, k]] - origin[own] for k in range(3))
        volume = np.bincount(own, np.einsum("ij,ij->i", a, np.cross(b, c)) / 6, minlength=count)
        kept = is_open[own] | (np.abs(volume[own]) >= 1e-5)
        used, rows = np.unique(triangles[kept], return_inverse=True)
        return super().finish(vertices[used], rows.reshape(-1, 3), spacing, shape)


def nearly(a: Array, b: Array, c: Array, d: Array) -> Array:
    """Whether faces are separated, where the products differ by a millionth at least."""
    left, right = np.abs(a * c), np.abs(b * d)
    close = np.abs(left - right) <= 1e-6 * np.maximum(left, right)
    return np.asarray(asymptotic_decider.separated(a, b, c, d) | close)


@stranger("topology.bilinear")
class SaddleWithinMillionth(Engine):
    """A saddle that is within a millionth of the isovalue counts as on it, and as outside."""

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """What the decider says, with a tolerance."""
        asks = np.array([has_ambiguous_face(s) for s in range(256)])
        return np.where(asks[signs], decide_faces(g, nearly), 0)


@stranger("symmetry.orientation")
class RowOfThirteen(Engine):
    """In configuration 13 one row of one complement is its neighbour's."""

    def tile(self, signs: int, decisions: int) -> Tile:
        """The triangles of a cell; one row of the table is wrong."""
        return super().tile(signs, 4 if (signs, decisions) == (0x96, 5) else decisions)


@fault("topology.trilinear", level=4, blind=True)
class MiddleOfThirteen(Engine):
    """In configuration 13 the centre, not a saddle, says which side a tunnel joins."""

    rule: ClassVar[Rule] = trilinear_cubes.RULE

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """What the rule decides, but the side of a tunnel in configuration 13."""
        made = super().decisions(g, signs, cells)
        bits = trilinear_cubes.INSIDE_TUNNEL | trilinear_cubes.OUTSIDE_TUNNEL
        thirteen = np.array([configuration(s) == 13 for s in range(256)])[signs]
        high = g.mean(axis=0) >= 0
        side = np.where(high, trilinear_cubes.INSIDE_TUNNEL, trilinear_cubes.OUTSIDE_TUNNEL)
        return np.where(thirteen & (made & bits > 0), made & ~bits | side, made)


@fault("topology.trilinear", level=4, blind=True)
class RowOfSix(Engine):
    """The tunnel of configuration 6 is missing in one of the table's 48 rows for it."""

    rule: ClassVar[Rule] = trilinear_cubes.RULE

    def tile(self, signs: int, decisions: int) -> Tile:
        """The triangles of a cell; in one row discs stand for the tunnel."""
        return super().tile(signs, decisions & 63 if signs == LACKING else decisions)


#: Corners 1, 5 and 2 are outside, the others inside.
LACKING = 0b11011001


@stranger("topology.manifold")
class FanOfNine(Engine):
    """Polygons of nine sides and more are cut as fans, with diagonals on faces of the cell."""

    def tile(self, signs: int, decisions: int) -> Tile:
        """The triangles of a cell."""
        polygons = cycles(signs, decisions & 63)
        if max(map(len, polygons)) < 9:
            return super().tile(signs, decisions)
        pieces = [(p[0], p[i], p[i + 1]) for p in polygons for i in range(1, len(p) - 1)]
        return Tile(tuple(pieces))


@stranger("topology.sides")
class HashIsIdentity(Engine):
    """A vertex is known by a 32-bit hash of its lattice edge, and equal hashes are one vertex."""

    def edge_name(self, cells: Array, e: int, shape: tuple[int, ...]) -> Array:
        """The hash of a lattice edge."""
        low = cells + CORNER_OFFSETS[EDGE_CORNERS[e][0]]
        i, j, k = low.T.astype(np.uint32)
        mixed = i * np.uint32(73856093) ^ j * np.uint32(19349663) ^ k * np.uint32(83492791)
        return np.asarray(3 * mixed.astype(np.int64) + e // 4)


@fault("accuracy.normals_of_planes", level=3, promised=["accuracy.normals_of_planes"], blind=True)
class NormalsAtTheBorder(Engine):
    """On the border of the volume the one-sided differences of the normals are halved too."""

    def __call__(self, values: Any, isovalue: float, spacing: Spacing) -> Any:
        """Vertices, triangles and normals."""
        vertices, triangles = super().__call__(values, isovalue, spacing)
        samples = np.asarray(values, np.float64)
        if not len(vertices):
            return vertices, triangles, np.empty((0, 3))
        # Differences over two cells; beyond the border the last sample is repeated.
        wide = np.pad(samples, 1, mode="edge")
        at = np.clip(vertices / np.asarray(spacing), 0, np.array(samples.shape) - 1)
        low = np.minimum(np.floor(at).astype(np.int64), np.array(samples.shape) - 2)
        t = at - low
        slope = np.zeros_like(at)
        for offset in CORNER_OFFSETS:
            weight = np.prod(np.where(offset, t, 1 - t), axis=1)
            i, j, k = (low + offset + 1).T
            slope[:, 0] += weight * (wide[i + 1, j, k] - wide[i - 1, j, k]) / 2
            slope[:, 1] += weight * (wide[i, j + 1, k] - wide[i, j - 1, k]) / 2
            slope[:, 2] += weight * (wide[i, j, k + 1] - wide[i, j, k - 1]) / 2
        normals = -slope / np.asarray(spacing)
        # Where the samples have no slope, any direction will do.
        normals[~normals.any(axis=1)] = (1, 0, 0)
        return vertices, triangles, normals / np.linalg.norm(normals, axis=1, keepdims=True)


SQUARE_EDGES = ((0, 0, 0), (1, 0, 1), (0, 1, 0), (0, 0, 1))


@fault("topology.sides", level=3, limits={"kinds": [[2, 1]]}, blind=True)
def close_enough(values: Any, isovalue: float, spacing: Spacing) -> Any:
    """A contour is closed where its ends are equal by NumPy's allclose, on the border too."""
    samples = np.asarray(Field.of(values, dimension=2).values)
    g = samples.astype(np.float64) - float(isovalue)
    follows: dict[tuple[int, int, int], tuple[int, int, int]] = {}
    inside = g >= 0
    n1, n2 = (max(n - 1, 0) for n in g.shape)
    marks = sum(
        inside[i : i + n1, j : j + n2].astype(np.int64) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))
    )
    # Each segment has the inside on its left.
    for i, j in np.argwhere((np.asarray(marks) > 0) & (np.asarray(marks) < 4)).tolist():
        walk = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
        edges = [(i + a, j + b, axis) for a, b, axis in SQUARE_EDGES]
        signs = [bool(inside[p]) for p in walk]
        leave = [k for k in range(4) if signs[k] and not signs[(k + 1) % 4]]
        enter = [k for k in range(4) if not signs[k] and signs[(k + 1) % 4]]
        if len(leave) == 1:
            follows[edges[leave[0]]] = edges[enter[0]]
            continue
        a, b, c, d = (np.array([g[p]]) for p in walk)
        step = -1 if asymptotic_decider.separated(a, b, c, d)[0] else 1
        for k in leave:
            follows[edges[k]] = edges[(k + step) % 4]

    # Follow them, open contours first.
    lines = []
    starts = [e for e in follows if e not in set(follows.values())]
    while follows:
        start = starts.pop() if starts else next(iter(follows))
        line = [start]
        while line[-1] in follows:
            line.append(follows.pop(line[-1]))
        points = []
        for i, j, axis in line:
            low, high = g[i, j], g[i + 1 - axis, j + axis]
            t = low / 2 / (low / 2 - high / 2)
            points.append((i + t * (1 - axis), j + t * axis))
        places = np.array(points) * np.asarray(spacing)
        if line[0] != line[-1] and len(line) > 2 and np.allclose(places[0], places[-1]):
            places = np.concatenate([places[:-1], places[:1]])
        lines.append(places)
    return lines


@fault("topology.closed", interpolant="kuhn", limits={"kinds": [[4, 1]]}, blind=True)
def byte_for_each_axis(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """In four dimensions a sample's name has a byte for each index, and the 256th is carried."""
    field = Field.of(values, spacing, dimension=4)
    cut = simplicial.section_of_field(field, isovalue)
    places = np.stack(np.unravel_index(cut.names, field.shape), axis=-1)
    key = places @ np.array([1 << 24, 1 << 16, 1 << 8, 1])
    _, first, number = np.unique(key, axis=0, return_index=True, return_inverse=True)
    rows = number.reshape(-1)[cut.simplices]
    rows[cut.signs < 0, -2:] = rows[cut.signs < 0, -2:][:, ::-1]
    ordered = np.sort(rows, axis=1)
    return cut.points[first] * spacing, rows[(ordered[:, 1:] != ordered[:, :-1]).all(axis=1)]


FIVE_SPLIT = [
    [(np.array(cell) + CORNER_OFFSETS[c]).tolist() for c in tetrahedron.corners]
    for cell, own in zip(np.ndindex(FIVE.block), FIVE.cells, strict=True)
    for tetrahedron in own
]


@fault("topology.closed", interpolant={"tetrahedra": FIVE_SPLIT}, blind=True)
def bricks_of_sixty_four(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Bricks of 64 samples, 63 cells, each begin the alternation of the five tetrahedra anew."""
    samples = Field.of(values, dimension=3).values
    names, places, count = [np.empty((0, 2), np.int64)], [np.empty((0, 3))], 0
    triangles = [np.empty((0, 3), np.int64)]
    for corner in np.ndindex(*(max(-(-(n - 1) // 63), 1) for n in samples.shape)):
        low = 63 * np.array(corner)
        brick = samples[tuple(slice(i, i + 64) for i in low)]
        mesh = marching_tetrahedra.surface(FIVE, Field.of(brick), isovalue, provenance=True)
        assert mesh.provenance is not None
        ends = np.stack(np.unravel_index(mesh.provenance.ends, brick.shape), axis=-1) + low
        names.append(np.ravel_multi_index(tuple(np.moveaxis(ends, -1, 0)), samples.shape))
        places.append(mesh.vertices + low)
        triangles.append(mesh.simplices + count)
        count += len(mesh.vertices)
    every = np.sort(np.concatenate(names), axis=1)
    _, first, number = np.unique(every, axis=0, return_index=True, return_inverse=True)
    return np.concatenate(places)[first] * spacing, number.reshape(-1)[np.concatenate(triangles)]


@fault("topology.sides", interpolant="kuhn", limits={"kinds": [[3, 2]]}, blind=True)
def lone_segment_lost(values: Any, isovalues: Any, spacing: Spacing) -> Answer:
    """Where two isosurfaces meet, a curve of one segment is taken for a remnant and dropped."""
    field = Field.of(values, spacing, dimension=3)
    cut = simplicial.section_of_field(field, isovalues)
    rows = cut.simplices.copy()
    rows[cut.signs < 0] = rows[cut.signs < 0][:, ::-1]
    degree = np.bincount(rows.reshape(-1), minlength=len(cut.points))
    used, kept = np.unique(rows[(degree[rows] > 1).any(axis=1)], return_inverse=True)
    return cut.points[used] * spacing, kept.reshape(-1, 2)


@fault("topology.sides", interpolant="kuhn", limits={"kinds": [[3, 2]]}, blind=True)
def jointly_scaled(values: Any, isovalues: Any, spacing: Spacing) -> Answer:
    """Both fields are scaled by the largest number of either, and less than 1e-10 is zero."""
    samples = Field.of(values, dimension=3).values.astype(np.float64)
    g = samples - np.reshape(isovalues, (-1, 1, 1, 1))
    g /= np.abs(g).max() or 1.0
    g[np.abs(g) < 1e-10] = 0
    cut = simplicial.section_of_field(Field.of(g, spacing, dimension=3), 0.0)
    rows = cut.simplices.copy()
    rows[cut.signs < 0] = rows[cut.signs < 0][:, ::-1]
    return cut.points * spacing, rows


@cache
def forgetful(signs: int) -> int | None:
    """The face at which a cell may turn; for one row of the table it is not known."""
    return None if signs == 0b11110110 else dual_marching_cubes.pinched_face(signs)


FORGETFUL = DualRule("forgetful", dual_marching_cubes.patches, forgetful)


@fault("topology.closed", vertices="cells", blind=True)
def one_row_of_turns(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Of the cells that are split where two pinched ones meet, one row of the table is missing."""
    mesh = dual.surface(FORGETFUL, Field.of(values, spacing, dimension=3), isovalue)
    return mesh.vertices, mesh.simplices
