"""Faults of the kinds that stand in public trackers and histories of extractors.

Each names the report that its author read; what is done here is in our own words and code, and
often milder than what was reported. Those without a report are classic slips of the same kind.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from isoref import (
    asymptotic_decider,
    extract,
    lorensen_cline,
    marching_vesta,
    trilinear_cubes,
)
from isoref.cube import (
    CORNER_OFFSETS,
    EDGE_CORNERS,
    FACE_CORNERS,
    ambiguous_faces,
    configuration,
    is_ambiguous,
    is_exchanged,
)
from isoref.cycles import cycles, fan, triangulate
from isoref.rule import Average, Tile
from scipy.ndimage import map_coordinates

from tests.isograde.faults.engine import Answer, Array, Engine, Spacing
from tests.isograde.faults.registry import fault

GITHUB = "https://github.com/"
EPSILON = float(np.finfo(np.float32).eps)


class Trilinear(Engine):
    """The engine with the topology of the trilinear interpolant."""

    rule = trilinear_cubes.RULE


class AnyFaces(Engine):
    """The engine with tiles that are sound for any decisions on faces: those of VESTA."""

    rule = marching_vesta.rule("mixed", "L")


def faces_that(g: Array, signs: Array, cut: Any) -> Array:
    """Bits of the ambiguous faces whose four values, in the walk of the face, say that they cut."""
    ambiguous = np.array([[is_ambiguous(s, f) for s in range(256)] for f in range(6)])
    found = np.zeros(len(signs), np.int64)
    with np.errstate(all="ignore"):
        for f in range(6):
            own = np.asarray(cut(*g[list(FACE_CORNERS[f])]))
            found |= (ambiguous[f][signs] & own).astype(np.int64) << f
    return found


def every_ambiguous(signs: Array) -> Array:
    """All bits of the ambiguous faces."""
    bits = [asymptotic_decider.bits_of(ambiguous_faces(s)) for s in range(256)]
    return np.array(bits)[signs]


# --- reading and comparing ----------------------------------------------------------------------


@fault("bodies.offset", GITHUB + "MRtrix3/mrtrix3/pull/854")
class ReadAsWhole(Engine):
    """A volume of floats is read as whole numbers."""

    def read(self, values: Any) -> Array:
        """The samples without their fractions."""
        return np.asarray(super().read(values).astype(np.int64))


@fault("range.shift", not_promised=["symmetry.shift"], promised=["range.shift"])
class HalfPrecisionSamples(Engine):
    """Samples are converted to half precision before the isovalue is subtracted."""

    def relative(self, samples: Array, alpha: float) -> Array:
        """Differences in half precision."""
        with np.errstate(over="ignore", invalid="ignore"):
            halves = samples.astype(np.float64).astype(np.float16) - np.float16(alpha)
        return np.nan_to_num(np.asarray(halves, np.float64))


@fault("geometry.crossing", GITHUB + "uos/lvr2/pull/45")
class ZeroIsHalfway(Engine):
    """An edge with an end on the isovalue is crossed in its middle."""

    def parameter(self, low: Array, high: Array) -> Array:
        """The parameter, a half at ties."""
        return np.where((low == 0) | (high == 0), 0.5, super().parameter(low, high))


@fault("geometry.crossing")
class FixedOffset(Engine):
    """A crossing that comes out at an end of its edge is put a fixed way inside."""

    def parameter(self, low: Array, high: Array) -> Array:
        """The parameter, a hundredth from the ends where it is one."""
        t = super().parameter(low, high)
        return np.where(t < 2e-3, 0.01, np.where(t > 1 - 2e-3, 0.99, t))


@fault("topology.bilinear", GITHUB + "JuliaGeometry/MarchingCubes.jl/issues/5", level=3)
class FacesOfTheRawField(Engine):
    """The test of a face looks at the samples, and forgets to subtract the isovalue."""

    alpha = 0.0

    def level(self, samples: Array, isovalue: float) -> float:
        """The isovalue, remembered."""
        self.alpha = super().level(samples, isovalue)
        return self.alpha

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """Decisions on raw values."""
        return faces_that(
            g + self.alpha,
            signs,
            lambda a, b, c, d: np.where(a - self.alpha >= 0, a * c < b * d, b * d < a * c),
        )


@fault("topology.closed", GITHUB + "scikit-image/scikit-image/issues/8109", level=3)
class ZeroIsPositive(Engine):
    """A face test of exactly zero says "positive" to both cells, whichever side each asks for."""

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """A tie cuts in cells with few inside corners and joins in others."""
        tie = faces_that(g, signs, lambda a, b, c, d: a * c == b * d)
        few = np.array([s.bit_count() <= 4 for s in range(256)])
        found = super().decisions(g, signs, cells)
        return np.where(few[signs], found | tie, found & ~tie)


@fault("symmetry.scaling", GITHUB + "scikit-image/scikit-image/issues/8116", level=3)
class FaceTestWithEpsilon(AnyFaces):
    """The face test counts products that differ by less than the epsilon of floats as equal."""

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """Joined unless the products differ by an absolute epsilon."""
        return faces_that(
            g,
            signs,
            lambda a, b, c, d: np.where(a >= 0, a * c < b * d - 1e-2, b * d < a * c - 1e-2),
        )


@fault("topology.bilinear", GITHUB + "OSGeo/gdal/pull/834", level=3)
class AlwaysApart(AnyFaces):
    """Ambiguous faces are always cut, and the bilinear topology is promised."""

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """All ambiguous faces separated."""
        return every_ambiguous(signs)


@fault("symmetry.orientation", GITHUB + "guillaumechereau/goxel/issues/256")
class AlongOneAxis(AnyFaces):
    """Faces across the first axis are joined and all others cut."""

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """The ambiguous faces 2 to 5 separated."""
        return every_ambiguous(signs) & 0b111100


@fault("symmetry.translation")
class Chessboard(AnyFaces):
    """Faces are cut or joined like the fields of a chessboard, so that neither wins."""

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """Separated where the number of the face's lattice plane and cell is odd."""
        found = np.zeros(len(signs), np.int64)
        for f in range(6):
            place = cells.sum(axis=1) + f % 2
            found |= (place % 2) << f
        return found & every_ambiguous(signs)


@fault("symmetry.scaling")
class FacesBySize(AnyFaces):
    """Faces are cut where their values are large, as if the unit were known."""

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """Separated where the four values sum to more than three in size."""
        return faces_that(
            g, signs, lambda a, b, c, d: np.abs(a) + np.abs(b) + np.abs(c) + np.abs(d) > 3
        )


@fault("symmetry.shift")
class FacesByLevel(AnyFaces):
    """Faces are cut for isovalues above zero and joined for others."""

    alpha = 0.0

    def level(self, samples: Array, isovalue: float) -> float:
        """The isovalue, remembered."""
        self.alpha = super().level(samples, isovalue)
        return self.alpha

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """All or none."""
        return every_ambiguous(signs) * int(self.alpha > 1)


@fault("symmetry.spacing")
class FacesBySpacing(AnyFaces):
    """Diagonals of a polygon follow the shorter way in space, across faces that are not theirs."""

    wide = False

    def __call__(self, values: Any, isovalue: float, spacing: Spacing) -> Answer:
        """The mesh; faces are cut where cells are cubes, and joined where they are not."""
        self.wide = len(set(spacing)) > 1
        return super().__call__(values, isovalue, spacing)

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """All or none."""
        return every_ambiguous(signs) * int(self.wide)


@fault("symmetry.type")
class FacesByType(AnyFaces):
    """Single precision takes another branch, in which ambiguous faces are joined."""

    single = False

    def read(self, values: Any) -> Array:
        """The samples, their type remembered."""
        samples = super().read(values)
        self.single = samples.dtype != np.float64
        return samples

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """All or none."""
        return every_ambiguous(signs) * int(not self.single)


@fault("symmetry.layout", GITHUB + "ilastik/marching_cubes/pull/35")
class FacesByLayout(AnyFaces):
    """Arrays in Fortran order take another branch, in which ambiguous faces are joined."""

    fortran = False

    def read(self, values: Any) -> Array:
        """The samples, their layout remembered."""
        flags = np.asarray(values).flags
        self.fortran = not flags.c_contiguous
        return super().read(values)

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """All or none."""
        return every_ambiguous(signs) * int(not self.fortran)


@fault("topology.tie_side")
class EqualIsOutside(Engine):
    """A sample on the isovalue counts as outside, and the other side is declared by default."""

    def inside(self, samples: Array, relative: Array, alpha: float) -> Array:
        """Strictly above."""
        return np.asarray(relative > 0)


@fault("range.digits", promised=["range.digits"])
class RoundedComparison(Engine):
    """Samples are compared in single precision, so two that differ in the ninth digit are equal."""

    def inside(self, samples: Array, relative: Array, alpha: float) -> Array:
        """At least the isovalue, in single precision."""
        with np.errstate(over="ignore"):
            return np.asarray(samples.astype(np.float32) >= np.float32(alpha))


@fault("topology.sides")
class WithTolerance(Engine):
    """A sample within a thousandth of the isovalue counts as inside."""

    def inside(self, samples: Array, relative: Array, alpha: float) -> Array:
        """At least the isovalue, nearly."""
        return np.asarray(relative >= -1e-3)

    def parameter(self, low: Array, high: Array) -> Array:
        """The parameter on the edge."""
        gap = np.where(low == high, 1, low / 2 - high / 2)
        return np.asarray(low / 2 / gap).clip(0, 1)


@fault("bodies.distance")
class SquaredField(Engine):
    """Crossings are those of squared distances, which are not linear along an edge."""

    def parameter(self, low: Array, high: Array) -> Array:
        """The share of the roots of both ends."""
        a, b = np.sqrt(np.abs(low)), np.sqrt(np.abs(high))
        return np.asarray(a / (a + b))


@fault("bodies.distance")
class EndsExchanged(Engine):
    """Along one axis the share is counted from the wrong end."""

    def crossings(self, g: Array, signs: Array, cells: Array) -> Array:
        """Crossings, those of axis 1 mirrored on their edges."""
        found = super().crossings(g, signs, cells)
        found[4:8, :, 1] = 1 - found[4:8, :, 1]
        return found


# --- tables -------------------------------------------------------------------------------------


@fault("topology.closed", GITHUB + "lorensen/VTKExamples/pull/224")
class FourteenDrawings(Engine):
    """There are fourteen drawings, not fifteen: a mirror image is missing."""

    def tile(self, signs: int, decisions: int) -> Tile:
        """The tile; configuration 14 is drawn as its mirror image is, edge numbers and all."""
        tile = super().tile(signs, decisions)
        if configuration(signs) != 14:
            return tile
        return Tile(tuple((a, b, c) for a, b, c in tile.triangles[1:]), tile.interior)


@fault("bodies.offset")
class ComplementsNotTurned(Engine):
    """The complement of a drawing uses its triangles as they are, and forgets to turn them."""

    rule = lorensen_cline.RULE

    def tile(self, signs: int, decisions: int) -> Tile:
        """The tile, turned where configuration 5 is exchanged."""
        tile = super().tile(signs, decisions)
        if configuration(signs) == 5 and is_exchanged(signs):
            return Tile(tuple((a, c, b) for a, b, c in tile.triangles), tile.interior)
        return tile


@fault("topology.trilinear", level=4)
class CrossedPair(Trilinear):
    """Two corners that are cut off at the ends of a diagonal are joined by a sleeve."""

    def tile(self, signs: int, decisions: int) -> Tile:
        """Configuration 4 with a tunnel, whatever the values."""
        if configuration(signs) != 4:
            return super().tile(signs, decisions)
        first, second = cycles(signs, decisions)
        band = [(first[i], first[(i + 1) % 3], second[-i]) for i in range(3)]
        band += [(second[i], second[(i + 1) % 3], first[-i]) for i in range(3)]
        return Tile(tuple(band))


@fault("cells.count")
class Bubble(Engine):
    """A closed speck is left beside the first triangle, from a cell that was drawn twice."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh with a tetrahedron too small to see."""
        a, b, c = vertices[triangles[0]]
        normal = np.cross(b - a, c - a)
        size = np.linalg.norm(normal)
        near = (a + b + c) / 3 + (1e-3 * normal / size if size else 0)
        speck = near + 1e-5 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
        rows = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]) + len(vertices)
        whole = np.concatenate([vertices, speck])
        return super().finish(whole, np.concatenate([triangles, rows]), spacing, shape)


@fault("bodies.holes")
class TrianglesThereAndBack(Engine):
    """Hexagons get a triangle in their middle twice, there and back."""

    def tile(self, signs: int, decisions: int) -> Tile:
        """The tile with a purse in each hexagon."""
        tile = super().tile(signs, decisions)
        more = []
        for p in cycles(signs, decisions):
            if len(p) == 6:
                more += [(p[0], p[2], p[4]), (p[0], p[4], p[2])]
        return Tile((*tile.triangles, *more), tile.interior)


@fault("structure.no_duplicate", level=1, promised=["structure.no_duplicate"])
class SameTriangleTwice(Engine):
    """Some cells are visited twice, and the mesh promises that no triangle is repeated."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh, its last triangle there, back and there again."""
        last = triangles[-1:]
        rows = np.concatenate([triangles, last[:, ::-1], last])
        return super().finish(vertices, rows, spacing, shape)


@fault("structure.apart", promised=["structure.apart"])
class TiesTwice(Engine):
    """It is promised that no two vertices coincide, and on a tied sample they do."""


@fault("structure.with_measure", promised=["structure.with_measure"])
class FlatAtTies(Engine):
    """It is promised that every triangle has an area, and on a tied sample some have none."""


@fault("geometry.embedded")
class MiddlesExchanged(Engine):
    """In a cell of two polygons with inner points, each gets the other's."""

    def tile(self, signs: int, decisions: int) -> Tile:
        """Every polygon round a point, that of the next polygon."""
        polygons = cycles(signs, decisions)
        triangles = [t for i, p in enumerate(polygons) for t in fan(p, 12 + i)]
        return Tile(tuple(triangles), tuple(Average(p) for p in (*polygons[1:], polygons[0])))


@fault("topology.manifold")
class OneMiddleForAll(Engine):
    """All polygons of a cell share one inner point."""

    def tile(self, signs: int, decisions: int) -> Tile:
        """Every polygon round the same point."""
        polygons = cycles(signs, decisions)
        triangles = [t for p in polygons for t in fan(p, 12)]
        return Tile(tuple(triangles), (Average(tuple(e for p in polygons for e in p)),))


@fault("structure.finite", GITHUB + "AMReX-Codes/amrex/issues/5704")
class AveragesOfAll(Engine):
    """The point inside a cell is the mean of all twelve edges, also of those without a crossing."""

    def tile(self, signs: int, decisions: int) -> Tile:
        """The tile, its inner points the mean of every edge."""
        tile = super().tile(signs, decisions)
        return Tile(tile.triangles, tuple(Average(tuple(range(12))) for _ in tile.interior))


@fault("topology.sides", GITHUB + "AMReX-Codes/amrex/issues/5704")
class SlotsOfOthers(Engine):
    """The point inside a cell is numbered from zero and overwrites a crossing."""

    def weld(
        self, names: list[Array], places: list[Array], owners: list[Array], keys: Array
    ) -> tuple[Array, Array]:
        """The mesh; inner points replace the first vertices."""
        vertices, triangles = super().weld(names, places, owners, keys)
        inner = min((int(x.min()) for x in names), default=0) < 0
        if inner:
            number = int(sum(len(np.unique(x)) for x in names if x.min() < 0) > 0)
            triangles = np.where(triangles == 0, len(vertices) - number, triangles)
        return vertices, triangles


@fault("structure.in_range", GITHUB + "JuliaGeometry/MarchingCubes.jl/issues/21")
class CountedFromOne(Engine):
    """Triangles count vertices from one."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh, its numbers one too high."""
        return super().finish(vertices, triangles + 1, spacing, shape)


@fault("structure.in_range", GITHUB + "JuliaGeometry/MarchingCubes.jl/issues/5")
class MinusOneForNone(Engine):
    """A tunnel's band names a vertex that was never made: its number is still minus one."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh; where a triangle touches the border of the lattice its last number is lost."""
        edge = (vertices[triangles] == 0).all(axis=1).any(axis=1)
        rows = triangles.copy()
        rows[edge, 2] = -1
        return super().finish(vertices, rows, spacing, shape)


@fault("structure.shapes")
class Homogeneous(Engine):
    """Vertices have a fourth coordinate, one."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh in homogeneous coordinates."""
        made, rows = super().finish(vertices, triangles, spacing, shape)
        return np.pad(made, ((0, 0), (0, 1)), constant_values=1.0), rows


@fault("structure.answers", GITHUB + "neurolabusc/nii2mesh/pull/13")
class CrashAtTheEnd(Engine):
    """An index runs over where the surface reaches the last layer of the volume."""

    def visited(self, cells: Array, shape: tuple[int, ...]) -> Array:
        """The cells, or an error."""
        if len(cells) and (cells[:, 0] == shape[0] - 2).any():
            raise IndexError(f"index {shape[0]} is out of bounds for axis 0 with size {shape[0]}")
        return cells


@fault("robustness.out_of_range")
class CornerAbove(Engine):
    """An isovalue above all samples leaves a triangle of an uninitialised buffer."""

    above = False

    def level(self, samples: Array, isovalue: float) -> float:
        """The isovalue, compared with the samples."""
        self.above = bool(samples.max() < isovalue)
        return super().level(samples, isovalue)

    def visited(self, cells: Array, shape: tuple[int, ...]) -> Array:
        """The cells; without one, and with everything below, an answer all the same."""
        if self.above:
            raise StopIteration
        return cells

    def __call__(self, values: Any, isovalue: float, spacing: Spacing) -> Answer:
        """The mesh, or what was in the buffer."""
        try:
            return super().__call__(values, isovalue, spacing)
        except StopIteration:
            return np.eye(3) * 1e-3, np.array([[0, 1, 2]])


@fault("structure.answers", GITHUB + "sgsellan/gpytoolbox/issues/104")
class CrashOnOneSide(Engine):
    """Where all samples are on one side there is an error, and nobody said so."""

    def visited(self, cells: Array, shape: tuple[int, ...]) -> Array:
        """The cells, or an error."""
        if not len(cells):
            raise ValueError("surface level must be within volume data range")
        return cells


# --- names and places ---------------------------------------------------------------------------


@fault("structure.no_repeated_index", GITHUB + "facebookresearch/pytorch3d/issues/1731")
class HashOfTwoEnds(Engine):
    """An edge is named by the sum of the numbers of its ends, which is not one edge's alone."""

    def edge_name(self, cells: Array, e: int, shape: tuple[int, ...]) -> Array:
        """The sum of both flat indices."""
        a, b = (self.flat(cells + CORNER_OFFSETS[end], shape) for end in EDGE_CORNERS[e])
        return np.asarray(a + b)


@fault("topology.closed", GITHUB + "vengi-voxel/vengi/pull/795")
class ShortIndices(Engine):
    """Samples are numbered in 16 bits: from the 65,537th on their names repeat."""

    def flat(self, index: Array, shape: tuple[int, ...]) -> Array:
        """The flat index, wrapped."""
        return super().flat(index, shape) & 0xFFFF


@fault("topology.closed", GITHUB + "pmneila/PyMCubes/issues/22")
class BorderTwice(Engine):
    """Vertices in the first plane of the volume are made anew by each cell."""

    def edge_name(self, cells: Array, e: int, shape: tuple[int, ...]) -> Array:
        """A name that is the cell's own in the border."""
        names = super().edge_name(cells, e, shape)
        low = cells + CORNER_OFFSETS[EDGE_CORNERS[e][0]]
        own = 10_000_019 * (1 + self.flat(cells, shape))
        return np.where((low[:, 2] == 0) & (e // 4 != 2), names + own, names)


@fault("bodies.pieces", GITHUB + "pmneila/PyMCubes/pull/7")
class TwoPlanesOnly(Engine):
    """To save memory names are kept for two planes, and the wrong one is forgotten."""

    def edge_name(self, cells: Array, e: int, shape: tuple[int, ...]) -> Array:
        """A name by the parity of the cell's plane where its edges are not along the first axis."""
        names = super().edge_name(cells, e, shape)
        low = cells + CORNER_OFFSETS[EDGE_CORNERS[e][0]]
        apart = (e // 4 != 0) & (low[:, 0] % 8 == 7) & (cells[:, 0] == low[:, 0])
        return np.where(apart, names + 1_000_000_007, names)


@fault("topology.sides")
class WeldedWithinOneHundredth(Engine):
    """Vertices closer than a hundredth of a cell become one, and collapsed triangles go."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh after welding."""
        _, first, number = np.unique(
            vertices.round(2), axis=0, return_index=True, return_inverse=True
        )
        rows = number.reshape(-1)[triangles]
        kept = (rows[:, 0] != rows[:, 1]) & (rows[:, 1] != rows[:, 2]) & (rows[:, 2] != rows[:, 0])
        return super().finish(vertices[first], rows[kept], spacing, shape)


@fault("topology.sides")
class WeldedInTheWorld(Engine):
    """Vertices within 1e-4 of the world's unit become one: fine, until the cells are small."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh after welding in the world."""
        made, rows = super().finish(vertices, triangles, spacing, shape)
        cell = np.round(made / 1e-4).astype(np.int64)
        _, first, number = np.unique(cell, axis=0, return_index=True, return_inverse=True)
        rows = number.reshape(-1)[rows]
        kept = (rows[:, 0] != rows[:, 1]) & (rows[:, 1] != rows[:, 2]) & (rows[:, 2] != rows[:, 0])
        return made[first], rows[kept]


@fault("topology.sides")
class SinglePlaces(Engine):
    """Places are added up in half precision, so that they get coarse far from the origin."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh with half floats."""
        made, rows = super().finish(vertices, triangles, spacing, shape)
        return made.astype(np.float16), rows


@fault("bodies.distance")
class OneVertexLost(Engine):
    """The last vertex of a buffer of 256 is never written: it stands at the origin."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh, every 256th vertex at the origin."""
        moved = vertices.copy()
        moved[255::256] = 0
        return super().finish(moved, triangles, spacing, shape)


@fault("bodies.holes")
class EveryThousandth(Engine):
    """A race between threads loses one triangle in five hundred."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh with gaps."""
        kept = np.arange(len(triangles)) % 500 != 499
        return super().finish(vertices, triangles[kept], spacing, shape)


@fault("topology.closed")
class WholeSpacing(Engine):
    """The spacing is read as a whole number."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh in whole units."""
        whole = tuple(float(max(1, int(s))) for s in spacing)
        return super().finish(vertices, triangles, whole, shape)


@fault("robustness.deterministic")
class RemembersTheLast(Engine):
    """Names of vertices from the call before are still there: the first vertex is left over."""

    left: Array | None = None

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh, with the vertices of the call before appended once."""
        made, rows = super().finish(vertices, triangles, spacing, shape)
        before, self.left = self.left, made[:1]
        return (made if before is None else np.concatenate([made, before])), rows


@fault("robustness.input_unmodified", GITHUB + "pmneila/PyMCubes/issues")
class BorderFilled(Engine):
    """The border of the caller's array is filled with its least value, to close the surface."""

    def read(self, values: Any) -> Array:
        """The samples, read before the border is written and written for the next caller."""
        samples = super().read(values).copy()
        given = np.asarray(values)
        if given.flags.writeable and given.size:
            given[..., -1] = given.min()
        return samples


# --- beside the ladder --------------------------------------------------------------------------


@fault("cells.separate", promised=["cells.separate"])
class SaysItSeparates(Engine):
    """Every face is said to be cut, and saddles decide."""


@fault("cells.join", promised=["cells.join"])
class SaysItJoins(Engine):
    """Every face is said to be joined, and saddles decide."""


@fault("cells.mean", promised=["cells.mean"])
class SaysItTakesMeans(Engine):
    """Means are said to decide, and saddles do."""


@fault("cells.perfect", level=0, promised=["cells.perfect"])
class SaysItIsPerfect(Engine):
    """No two points at one place are promised, and each triangle brings its own."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The triangles as a soup."""
        soup = vertices[triangles.reshape(-1)]
        return super().finish(soup, np.arange(len(soup)).reshape(-1, 3), spacing, shape)


@fault("cells.frequencies", level=3, not_promised=["topology.bilinear"])
class CountsOfMeans(Engine):
    """The counts of Table 1 are promised, and the mean of a face decides."""

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """Separated where the mean is outside."""
        return faces_that(g, signs, lambda a, b, c, d: a + b + c + d < 0)


@fault("topology.scan", promised=["topology.scan"])
class SaysItCountsHandles(Engine):
    """The pieces and handles of the trilinear surface are promised, and no tunnel is drawn."""


@fault("topology.trilinear", "https://doi.org/10.1016/j.cag.2013.04.004", level=4)
class TunnelsByTheWrongSide(Trilinear):
    """A tunnel's bit is read for the other side: inside parts are joined where outside ones are."""

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """The two tunnel bits exchanged."""
        found = super().decisions(g, signs, cells)
        return (found & 63) | (found >> 1 & 64) | (found << 1 & 128)


@fault("topology.trilinear", level=4)
class FalseTunnels(Trilinear):
    """Configuration 4 gets a tunnel whenever the middle of the cell is inside."""

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """A tunnel bit set by the mean of the cell."""
        found = super().decisions(g, signs, cells)
        four = np.array([configuration(s) == 4 and s.bit_count() == 2 for s in range(256)])
        return np.where(four[signs], np.where(g.mean(axis=0) > 0, 64, 0), found)


@fault("topology.raw", level=1, promised=["topology.raw"])
class WeldedAtTies(Engine):
    """Vertices at one place become one, so that sheets that touch at a sample hang together."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh after welding, without the triangles that collapse."""
        _, first, number = np.unique(vertices, axis=0, return_index=True, return_inverse=True)
        rows = number.reshape(-1)[triangles]
        kept = (rows[:, 0] != rows[:, 1]) & (rows[:, 1] != rows[:, 2]) & (rows[:, 2] != rows[:, 0])
        return super().finish(vertices[first], rows[kept], spacing, shape)


@fault("topology.ties", level=0)
class TiesLeftOut(Engine):
    """A cell with a sample on the isovalue is skipped, for fear of triangles without area."""

    tied: Array | None = None

    def relative(self, samples: Array, alpha: float) -> Array:
        """Differences, ties remembered."""
        found = super().relative(samples, alpha)
        self.tied = found == 0
        return found

    def visited(self, cells: Array, shape: tuple[int, ...]) -> Array:
        """The cells without a tied corner."""
        assert self.tied is not None
        tied = np.zeros(len(cells), bool)
        for offset in CORNER_OFFSETS:
            tied |= self.tied[tuple((cells + offset).T)]
        return cells[~tied]


@fault("robustness.bad_input", promised=["robustness.bad_input"])
def mute(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """What is no field is refused without a word."""
    try:
        mesh = extract(values, isovalue, spacing)
    except ValueError:
        raise ValueError from None
    return mesh.vertices, mesh.simplices


@fault("robustness.nan", promised=["robustness.nan"])
class NanIsZero(Engine):
    """A sample that is not a number is taken for zero."""

    def read(self, values: Any) -> Array:
        """The samples, holes filled with zeros."""
        return super().read(np.nan_to_num(values))


@fault("robustness.elsewhere", promised=["robustness.elsewhere"])
class Normalised(Engine):
    """Values are divided by their range first, so that one that is no number spoils them all."""

    def read(self, values: Any) -> Array:
        """The samples, unchecked."""
        return np.ascontiguousarray(values)

    def relative(self, samples: Array, alpha: float) -> Array:
        """Samples minus the isovalue, over the largest of them."""
        away = super().relative(samples, alpha)
        return np.asarray(away / np.abs(away).max())


@fault("range.extremes", promised=["range.extremes"])
class SingleDifferences(Engine):
    """Differences are kept in single precision, where 1e300 becomes infinite."""

    def relative(self, samples: Array, alpha: float) -> Array:
        """Samples minus the isovalue, rounded."""
        with np.errstate(over="ignore"):
            return super().relative(samples, alpha).astype(np.float32).astype(np.float64)


class Normals(Trilinear):
    """Normals come with the vertices, by central differences."""

    def __call__(self, values: Any, isovalue: float, spacing: Spacing) -> Any:
        """Vertices, triangles and normals."""
        vertices, triangles = super().__call__(values, isovalue, spacing)
        if not len(vertices):
            return vertices, triangles
        index: Any = vertices / np.asarray(spacing)
        gradient: Any = np.gradient(np.asarray(values, np.float64))
        at = [map_coordinates(part, index.T, order=1) for part in gradient]
        return vertices, triangles, self.turned(-np.stack(at, axis=1), spacing)

    def turned(self, normals: Array, spacing: Spacing) -> Array:
        """The normals in the world's units."""
        made = normals / np.asarray(spacing)
        return np.asarray(made / np.maximum(np.linalg.norm(made, axis=1), 1e-300)[:, None])


@fault("symmetry.normals_returned", promised=["symmetry.normals_returned"])
class NormalsOfSamples(Normals):
    """Normals come in units of samples, whatever the spacing."""

    def turned(self, normals: Array, spacing: Spacing) -> Array:
        """The normals, their spacing forgotten."""
        return super().turned(normals, (1.0, 1.0, 1.0))


@fault("accuracy.normals_returned", promised=["accuracy.normals_returned"])
class NormalsUpwards(Normals):
    """Normals come with the vertices, and where they point down they are turned over."""

    def turned(self, normals: Array, spacing: Spacing) -> Array:
        """The normals, none of which points down."""
        made = super().turned(normals, spacing)
        return np.where(made[:, 2:] < 0, -made, made)


@fault("accuracy.normal", level=1, not_promised=["accuracy.position", "accuracy.distance"])
class Pyramids(Engine):
    """Every polygon gets a point above its middle, which shading then shows as a bump."""

    def tile(self, signs: int, decisions: int) -> Tile:
        """Each polygon round a point of its own, where no other tile has one."""
        polygons = cycles(signs, decisions)
        if any(triangulate(p) is None for p in polygons):
            return super().tile(signs, decisions)
        triangles = [t for i, p in enumerate(polygons) for t in fan(p, 12 + i)]
        return Tile(tuple(triangles), tuple(Above(p) for p in polygons))


class Above:
    """The placement above the mean of a polygon, by a seventh of a cell."""

    def __init__(self, nodes: tuple[int, ...]) -> None:
        self.nodes = nodes

    def __call__(self, g: Array, crossings: Array) -> Array:
        """The points, in their cells."""
        points = crossings[list(self.nodes)]
        mean = points.mean(axis=0)
        normal = np.cross(points - mean, np.roll(points, -1, axis=0) - mean).sum(axis=0)
        normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
        return np.asarray((mean + 0.14 * normal).clip(1e-3, 1 - 1e-3))
