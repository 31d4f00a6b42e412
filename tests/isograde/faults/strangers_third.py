"""Faults of a third stranger: what an author's own volumes are too small, too few or too tidy for.

They were written, and frozen, before their author had graded anything or read more than the README
and `isograde explain`. There were twenty-four. Four were here already, and are caught: a weld
within 1e-8 metres (`strangers_numbers.WeldedInMetres`), slivers left out (`NoAreaNoTriangle`),
products of 32 bits (`outsiders.ShortProducts`), a workspace of all threads (`test_claims_calls`).
"""

from __future__ import annotations

import hashlib
from functools import partial
from typing import Any

import numpy as np
from isoref import asymptotic_decider
from isoref.cube import CORNER_OFFSETS, EDGE_CORNERS, FACE_CORNERS
from isoref.field import Field
from isoref.rule import decide_faces, has_ambiguous_face

from tests.isograde.faults.engine import Answer, Array, Engine, Spacing
from tests.isograde.faults.placed import InTheWorld
from tests.isograde.faults.registry import fault

stranger = partial(fault, blind=True, level=3)
ASKS = np.array([has_ambiguous_face(signs) for signs in range(256)])

# --- names of vertices, and their numbers -------------------------------------------------------


@stranger("topology.sides")
class ThousandOnEachAxis(Engine):
    """A vertex is known by 1e6 i + 1e3 j + k, as if no axis had more than a thousand samples."""

    def flat(self, index: Array, shape: tuple[int, ...]) -> Array:
        """The name of lattice points, unique in a cube of a thousand."""
        return np.asarray(index @ np.array([10**6, 10**3, 1]))


@stranger("topology.closed")
class HalfAsManyVertices(Engine):
    """Indices have 16 bits where half the triangles have: a surface in pieces has more vertices."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The answer in short indices, where V = F / 2 would let them be short."""
        short = np.uint16 if len(triangles) // 2 < 2**16 else np.uint32
        vertices, triangles = super().finish(vertices, triangles, spacing, shape)
        return vertices, triangles.astype(short)


@stranger("topology.closed")
class SlabsOfFourMillion(Engine):
    """Large volumes are drawn in slabs of 2 ** 22 samples, which share no vertices."""

    def edge_name(self, cells: Array, e: int, shape: tuple[int, ...]) -> Array:
        """The lattice edge, and the slab whose cell draws it."""
        slab = cells[:, 0] // max(1, 2**22 // (shape[1] * shape[2]))
        return np.asarray(super().edge_name(cells, e, shape) + slab * 3 * int(np.prod(shape)))


# --- numbers ------------------------------------------------------------------------------------


@stranger("range.scale", promised=["range.scale"])
class HalfwayForSafety(Engine):
    """Where samples differ by less than 1e-12 the crossing is halfway, lest it divide by zero."""

    def parameter(self, low: Array, high: Array) -> Array:
        """The parameter, or a half."""
        return np.where(np.abs(low - high) < 1e-12, 0.5, super().parameter(low, high))


@stranger("geometry.crossing", promised=["range.scale"])
class TiesLifted(Engine):
    """Samples on the isovalue are lifted by 1e-10, so that there are no ties, whatever the unit."""

    def relative(self, samples: Array, alpha: float) -> Array:
        """Differences, none of them zero."""
        found = super().relative(samples, alpha)
        return np.where(found == 0, 1e-10, found)


@stranger("range.digits", promised=["range.digits"])
class SingleWhereLarge(Engine):
    """Volumes of more than a million samples are converted to single precision, to save memory."""

    def relative(self, samples: Array, alpha: float) -> Array:
        """Differences, those of many samples in single precision."""
        if samples.size > 2**20:
            return (samples.astype(np.float32) - np.float32(alpha)).astype(np.float64)
        return super().relative(samples, alpha)


@stranger("range.extremes", promised=["range.extremes"])
class SaddleFromItsOwnCorner(Engine):
    """The saddle's value is computed from the corner at which a cell begins its face.

    Two cells begin a shared face at opposite corners, and round differently: where the saddle is on
    the isovalue but for rounding, as among multiples of 0.1, one may join and the other separate.
    """

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """A bit for each ambiguous face that is separated."""
        made = np.zeros(len(signs), np.int64)
        for f, walk in enumerate(FACE_CORNERS):
            first = walk if f % 2 == 0 else walk[2:] + walk[:2]
            a, b, c, d = g[list(first)]
            high = [x >= 0 for x in (a, b, c, d)]
            asked = (high[0] == high[2]) & (high[1] == high[3]) & (high[0] != high[1])
            a, b, c, d = (x[asked] for x in (a, b, c, d))
            scale = np.max(np.abs([a, b, c, d]), axis=0)
            a, b, c, d = (x / 2.0 ** np.frexp(scale)[1] for x in (a, b, c, d))
            made[asked] |= (a - (a - b) * (a - d) / (a - b + c - d) < 0).astype(np.int64) << f
        return made


@stranger("geometry.crossing")
class SummedCoordinates(Engine):
    """The samples' coordinates are a running sum of the spacing, in single precision."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The answer, between the samples' coordinates."""
        placed = np.empty_like(vertices)
        for axis, (length, step) in enumerate(zip(shape, spacing, strict=True)):
            steps = np.full(length, step, np.float32)
            steps[0] = 0
            places = np.cumsum(steps, dtype=np.float32).astype(np.float64)
            placed[:, axis] = np.interp(vertices[:, axis], np.arange(length), places)
        return placed, triangles


@stranger("topology.closed")
class ComplementsOfTies(Engine):
    """More than four corners inside are drawn as the complement, and a tied saddle with it."""

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """What the decider says; of complements, with ties the other way."""
        many = np.array([signs.bit_count() > 4 for signs in range(256)])[signs]
        turned = decide_faces(
            g, lambda *f: asymptotic_decider.separated(*f) | (f[0] * f[2] == f[1] * f[3])
        )
        return np.where(ASKS[signs], np.where(many, turned, super().decisions(g, signs, cells)), 0)


# --- blocks, calls, arrays ----------------------------------------------------------------------

BESIDE = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))


@stranger("bodies.holes")
class BricksBesideAndNotAcross(Engine):
    """Bricks of eight cells are skipped by their range, with the next samples along each axis.

    The samples that are next along two axes or three are left out: what enters a brick at an edge
    or a corner alone is not seen.
    """

    def active(self, inside: Array) -> Array:
        """The crossed cells of bricks whose samples, as far as they are seen, differ."""
        found = super().active(inside)
        counts = tuple(-(-n // 8) for n in found.shape)
        some, every = np.zeros(counts, bool), np.ones(counts, bool)
        for offset in BESIDE:
            part = inside[tuple(slice(o, o + n) for o, n in zip(offset, found.shape, strict=True))]
            ends = [(0, 8 * c - n) for c, n in zip(counts, part.shape, strict=True)]
            bricks = np.pad(part, ends, mode="edge").reshape([m for c in counts for m in (c, 8)])
            some |= bricks.any(axis=(1, 3, 5))
            every &= bricks.all(axis=(1, 3, 5))
        seen = np.kron(some & ~every, np.ones((8, 8, 8), bool))
        return np.asarray(found & seen[tuple(slice(n) for n in found.shape)])


@stranger("symmetry.orientation")
class KeptWithoutShape(Engine):
    """Eight answers are kept, by all bytes, their type, isovalue and spacing, and not the shape."""

    def __init__(self) -> None:
        self.kept: dict[tuple[Any, ...], Answer] = {}

    def __call__(self, values: Any, isovalue: float, spacing: Spacing) -> Answer:
        """Vertices and triangles; those of an array of the same bytes, if there are any."""
        samples = self.read(values)
        digest = hashlib.blake2b(samples.tobytes()).digest()
        key = (digest, samples.dtype.str, isovalue, tuple(spacing))
        if key not in self.kept:
            while len(self.kept) >= 8:
                self.kept.pop(next(iter(self.kept)))
            self.kept[key] = super().__call__(values, isovalue, spacing)
        vertices, triangles = self.kept[key]
        return vertices.copy(), triangles.copy()


@stranger(
    "robustness.input_unmodified", conventions={"nan": "answers"}, promised=["robustness.nan"]
)
class MissingFilledInPlace(Engine):
    """Samples that are no number are taken for low ones, in the caller's array."""

    def read(self, values: Any) -> Array:
        """The samples; what was missing is missing no more."""
        if isinstance(values, np.ndarray) and values.dtype.kind == "f" and values.flags.writeable:
            values[np.isnan(values)] = np.finfo(values.dtype).min
        return super().read(values)


@stranger("symmetry.layout")
class CopiedOrSwapped(Engine):
    """What is not contiguous is copied, else what is of foreign byte order is swapped: not both."""

    def read(self, values: Any) -> Array:
        """The samples, as their bytes are after one of the two."""
        samples = np.asarray(values)
        if not samples.flags.c_contiguous:
            samples = np.ascontiguousarray(samples)
        elif not samples.dtype.isnative:
            samples = samples.astype(samples.dtype.newbyteorder("="))
        return super().read(np.nan_to_num(samples.view(samples.dtype.newbyteorder("="))))


@stranger("symmetry.spacing")
class SpacingInTheirType(Engine):
    """The spacing is converted to the samples' type, for a core that knows one type."""

    kind = np.dtype(np.float64)

    def read(self, values: Any) -> Array:
        """The samples; their type is kept."""
        samples = super().read(values)
        self.kind = samples.dtype
        return samples

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The answer, in a spacing of this type."""
        return vertices * np.asarray(spacing).astype(self.kind).astype(np.float64), triangles


@fault("symmetry.directions", blind=True, limits={"negative": True})
class AnyNegativeTurns(InTheWorld):
    """Triangles are turned over where a spacing is negative, also where two are: that is a turn."""

    def turned(self, triangles: Array, frame: Array) -> Array:
        """Turned over once."""
        return triangles[:, ::-1] if (np.diag(frame) < 0).any() else triangles


# --- normals and soups --------------------------------------------------------------------------


def gradients(samples: Array, spacing: Spacing, at: Array) -> Array:
    """The gradient at points in cells, between the samples' central differences, (V, 3)."""
    g = samples.astype(np.float64)
    slopes = np.stack([np.gradient(g, h, axis=a) for a, h in enumerate(spacing)], axis=-1)
    low = np.clip(np.floor(at).astype(np.int64), 0, np.array(samples.shape) - 2)
    t, total = at - low, np.zeros_like(at)
    for offset in CORNER_OFFSETS:
        total += (
            np.prod(np.where(offset, t, 1 - t), axis=1)[:, None] * slopes[tuple((low + offset).T)]
        )
    return total


RETURNED = ["accuracy.normals_returned", "accuracy.normals_of_planes", "symmetry.normals_returned"]


@stranger("accuracy.normals_returned", promised=RETURNED)
class NormalsOfNothing(Engine):
    """Normals are gradients by their length, and nobody asks whether that is zero: some are NaN."""

    def __call__(self, values: Any, isovalue: float, spacing: Spacing) -> Any:
        """Vertices, triangles and normals."""
        vertices, triangles = super().__call__(values, isovalue, spacing)
        if not len(vertices):
            return vertices, triangles, np.empty((0, 3))
        found = -gradients(self.read(values), spacing, vertices / np.asarray(spacing))
        with np.errstate(all="ignore"):
            return vertices, triangles, found / np.linalg.norm(found, axis=1, keepdims=True)


@stranger("topology.closed", mesh={"soup": 1e-4})
class ThereAndBack(Engine):
    """A soup in single precision, whose cells run along an edge from either end.

    Bourke's list of edges goes round a face, so two cells interpolate a shared edge from different
    ends. They differ in the last bit, which beyond a thousand cells is more than the tolerance.
    """

    def crossings(self, g: Array, signs: Array, cells: Array) -> Array:
        """Where edges are crossed: the last bit of some is another."""
        found = super().crossings(g, signs, cells)
        for e, (a, b) in enumerate(EDGE_CORNERS):
            axis, base = e // 4, cells[:, e // 4].astype(np.float32)
            crossed = (signs >> a & 1) != (signs >> b & 1)
            t = self.parameter(g[a, crossed], g[b, crossed])
            low, one = base[crossed], np.float32(1)
            if CORNER_OFFSETS[a].sum() % 2:
                back = (low + one) + (1 - t).astype(np.float32) * (low - (low + one))
            else:
                back = low + t.astype(np.float32) * one
            found[e, crossed, axis] = back.astype(np.float64) - low
        return found

    def edge_name(self, cells: Array, e: int, shape: tuple[int, ...]) -> Array:
        """Of each cell its own."""
        return np.asarray(12 * self.flat(cells, shape) + e)


# --- contours -----------------------------------------------------------------------------------

contours = partial(fault, blind=True, level=3, limits={"kinds": [[2, 1]]})


class Contours:
    """Marching squares with the decider, traced to polylines: each method is one step."""

    def __call__(self, values: Any, isovalue: float, spacing: Spacing) -> list[Array]:
        """The contours, the inside on their left; a closed one repeats its first point."""
        samples = np.asarray(Field.of(values, dimension=2).values)
        if min(samples.shape) < 2:
            return []
        g = samples.astype(np.float64) - float(isovalue)
        start, end = self.segments(g)
        ids = np.unique(np.concatenate([start, end]))
        follows = np.full(len(ids), -1)
        follows[np.searchsorted(ids, start)] = np.searchsorted(ids, end)

        # Put a point on each edge, those along axis 0 first.
        axis, at = ids // g.size, ids % g.size
        low, high = g.flat[at], g.flat[at + np.where(axis == 0, g.shape[1], 1)]
        points = np.stack([at // g.shape[1], at % g.shape[1]], axis=1).astype(np.float64)
        points[np.arange(len(points)), axis] += low / 2 / (low / 2 - high / 2)
        points *= np.asarray(spacing)
        return [self.line(points[line]) for line in self.trace(follows.tolist())]

    def segments(self, g: Array) -> tuple[Array, Array]:
        """The names of the edges at which segments begin and end."""
        inside = g >= 0
        corners = [inside[:-1, :-1], inside[1:, :-1], inside[1:, 1:], inside[:-1, 1:]]
        count = sum(one.astype(np.int64) for one in corners)
        cells = self.cells(np.argwhere((np.asarray(count) > 0) & (np.asarray(count) < 4)))
        i, j = cells.T
        values = [g[i, j], g[i + 1, j], g[i + 1, j + 1], g[i, j + 1]]
        high = [value >= 0 for value in values]
        low = i * g.shape[1] + j
        edges = [low, g.size + low + g.shape[1], low + 1, g.size + low]
        apart = asymptotic_decider.separated(*values)
        saddle = (high[0] == high[2]) & (high[1] == high[3]) & (high[0] != high[1])
        start, end = [np.empty(0, np.int64)], [np.empty(0, np.int64)]
        for k in range(4):
            leaves = high[k] & ~high[(k + 1) % 4]
            for step in (1, 2, 3):
                enters = ~high[(k + step) % 4] & high[(k + step + 1) % 4]
                wanted = ~saddle | (apart if step == 3 else ~apart)
                here = leaves & enters & wanted
                start.append(edges[k][here])
                end.append(edges[(k + step) % 4][here])
        return np.concatenate(start), np.concatenate(end)

    def cells(self, cells: Array) -> Array:
        """The indices of the crossed cells."""
        return cells

    def trace(self, follows: list[int]) -> list[list[int]]:
        """The contours as rows of points; open ones first."""
        aimed, lines = set(follows), []
        seen = [False] * len(follows)
        for start in sorted(range(len(follows)), key=lambda one: one in aimed):
            while start != -1 and not seen[start]:
                line, at = [start], follows[start]
                seen[start] = True
                while at != -1 and self.goes_on(line):
                    line.append(at)
                    if seen[at]:
                        break
                    seen[at] = True
                    at = follows[at]
                lines.append(line)
                start = at
        return [line for line in lines if len(line) > 1]

    def goes_on(self, line: list[int]) -> bool:
        """Whether a walk takes another step."""
        return True

    def line(self, points: Array) -> Array:
        """The points of a contour that are returned."""
        return points


@contours("topology.closed")
class RasterOfShortIndices(Contours):
    """Rows and columns are kept with 16 bits, and a map of the world has more."""

    def cells(self, cells: Array) -> Array:
        """The indices, modulo 65,536."""
        return cells.astype(np.uint16).astype(np.int64)


@contours("topology.closed")
class TenThousandSteps(Contours):
    """A walk ends after ten thousand points, lest it be endless; the rest is begun as another."""

    def goes_on(self, line: list[int]) -> bool:
        """Whether the guard is reached."""
        return len(line) < 10_000


@contours("topology.closed")
class AllcloseIsEqual(Contours):
    """Points that NumPy's allclose takes for the one before are dropped."""

    def line(self, points: Array) -> Array:
        """The points, none like the last one."""
        kept = [points[0]]
        for point in points[1:-1]:
            if not (np.abs(point - kept[-1]) <= 1e-8 + 1e-5 * np.abs(kept[-1])).all():
                kept.append(point)
        return np.array([*kept, points[-1]])
