"""Faults written before their author had seen a case or a claim's code.

Their author had read the README, what `isograde explain` prints, the reference, reports in public
trackers, and the issue that asks for these faults, and not a line of `isograde.cases`,
`isograde.claims` or the older broken implementations. What was not caught was not removed.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from isoref import asymptotic_decider, extract, lorensen_cline, trilinear_cubes
from isoref.cube import CORNER_OFFSETS, EDGE_CORNERS, ambiguous_faces, configuration
from isoref.cycles import cycles, fan
from isoref.rule import Average, Tile
from scipy.ndimage import gaussian_filter, label

from tests.isograde.faults.engine import Answer, Array, Engine, Spacing
from tests.isograde.faults.registry import fault

blind = partial(fault, blind=True)
GITHUB = "https://github.com/"

# --- which cells are visited --------------------------------------------------------------------


@blind("topology.closed", GITHUB + "NVIDIA/warp/issues/324")
class LastLayer(Engine):
    """The bound of the loops is one too small: the last layer of cells is never drawn."""

    def visited(self, cells: Array, shape: tuple[int, ...]) -> Array:
        """The cells of all layers but the last of each axis."""
        return cells[(cells < np.array(shape) - 2).all(axis=1)]


@blind("topology.closed")
class LastColumnOfLongRows(Engine):
    """Rows are read sixteen cells at a time, and what is left over at their end is not."""

    def visited(self, cells: Array, shape: tuple[int, ...]) -> Array:
        """The cells of whole blocks."""
        whole = (shape[2] - 1) // 16 * 16 or shape[2]
        return cells[cells[:, 2] < whole]


@blind("topology.sides")
class RowsWithoutCrossingAlongThem(Engine):
    """Rows of cells whose own four edges have no crossing are skipped, as if nothing were there."""

    def active(self, inside: Array) -> Array:
        """The active cells of rows that look crossed along axis 2."""
        found = super().active(inside)
        along = (inside[..., 1:] != inside[..., :-1]).any(axis=2)
        row = along[1:, 1:] | along[:-1, 1:] | along[1:, :-1] | along[:-1, :-1]
        return np.asarray(found & row[..., None])


@blind("bodies.holes")
class BlocksWithoutRange(Engine):
    """Blocks of four cells are skipped by their range, which leaves out the samples they share."""

    def active(self, inside: Array) -> Array:
        """The active cells of blocks whose own samples lie on both sides."""
        found = super().active(inside)
        for start in np.ndindex(*(-(-n // 4) for n in found.shape)):
            block = tuple(slice(4 * s, 4 * s + 4) for s in start)
            own = inside[block]
            if own.all() or not own.any():
                found[block] = False
        return found


@blind("topology.sides", GITHUB + "mikolalysenko/isosurface/issues/2")
class FewTriangles(Engine):
    """Pieces of fewer than nine triangles are taken for noise and left out."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh without small pieces."""
        piece = np.arange(len(vertices))
        while True:
            low = piece[triangles].min(axis=1)
            new = piece.copy()
            np.minimum.at(new, triangles.reshape(-1), np.repeat(low, 3))
            if (new == piece).all():
                break
            piece = new
        size = np.bincount(piece[triangles[:, 0]], minlength=len(vertices))
        kept = size[piece[triangles[:, 0]]] >= 9
        return super().finish(vertices, triangles[kept], spacing, shape)


@blind("topology.sides")
class LargestPiece(Engine):
    """Only the largest connected inside part of the volume is drawn."""

    def inside(self, samples: Array, relative: Array, alpha: float) -> Array:
        """The samples of the largest part."""
        found = super().inside(samples, relative, alpha)
        parts, count = label(found)
        if count < 2:
            return found
        return np.asarray(parts == 1 + np.argmax(np.bincount(parts.ravel())[1:]))


@blind("topology.sides")
class TwoHundredFiftyFivePieces(Engine):
    """Parts of the inside are numbered with a byte: the 256th and later ones vanish."""

    def inside(self, samples: Array, relative: Array, alpha: float) -> Array:
        """The samples of the first 255 parts."""
        found = super().inside(samples, relative, alpha)
        parts, _ = label(found)
        return np.asarray(found & (parts < 256))


@blind("topology.closed")
class RoundTheEnds(Engine):
    """Neighbours are taken with a roll, so the last samples meet the first ones."""

    def read(self, values: Any) -> Array:
        """The samples, the first of each axis appended at its end."""
        return np.pad(super().read(values), (0, 1), mode="wrap")


@blind("geometry.vertices")
class ClosedAtTheEnds(Engine):
    """The volume is padded with its least value, so that the surface is capped, unsaid."""

    def read(self, values: Any) -> Array:
        """The samples in a frame of low ones."""
        samples = super().read(values)
        return np.pad(samples, 1, constant_values=samples.min())

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh, moved back by the frame."""
        return super().finish(vertices - 1, triangles, spacing, shape)


# --- how samples are read and compared ----------------------------------------------------------


@blind("bodies.offset")
class ByteArithmetic(Engine):
    """Whole numbers are subtracted in their own type, and wrap round."""

    def relative(self, samples: Array, alpha: float) -> Array:
        """Differences in the samples' own type."""
        if samples.dtype.kind in "iu":
            with np.errstate(over="ignore"):
                return np.asarray(samples - np.array(alpha).astype(samples.dtype))
        return super().relative(samples, alpha)

    def inside(self, samples: Array, relative: Array, alpha: float) -> Array:
        """The comparison is right."""
        return np.asarray(samples >= alpha)


@blind("topology.sides")
class WholeLevel(Engine):
    """The isovalue is converted to the samples' type: 2.5 in a volume of bytes becomes 2."""

    def level(self, samples: Array, isovalue: float) -> float:
        """The isovalue in the samples' type."""
        return float(np.array(isovalue).astype(samples.dtype))


@blind("symmetry.layout", GITHUB + "pmneila/PyMCubes/issues")
class ForeignByteOrder(Engine):
    """The bytes of the array are taken as the machine's own, whatever their order."""

    def read(self, values: Any) -> Array:
        """The samples, as their bytes would be in native order."""
        samples = np.ascontiguousarray(values)
        return super().read(np.nan_to_num(samples.view(samples.dtype.newbyteorder("="))))


@blind("symmetry.layout", GITHUB + "scikit-image/scikit-image/issues/232")
class MemoryOrder(Engine):
    """The samples are read in the order of the memory, as if every array were in C order."""

    def read(self, values: Any) -> Array:
        """The samples as they lie in the memory."""
        return super().read(np.asarray(values).ravel(order="K").reshape(np.shape(values)))


@blind("symmetry.layout", GITHUB + "seung-lab/euclidean-distance-transform-3d/issues/18")
class FortranFlagOnly(Engine):
    """Fortran order is honoured, every other layout is read as one block of memory."""

    def read(self, values: Any) -> Array:
        """The samples: right in C and Fortran order."""
        samples = np.asarray(values)
        if not (samples.flags.c_contiguous or samples.flags.f_contiguous):
            whole = samples
            while isinstance(whole.base, np.ndarray):
                whole = whole.base
            flat = whole.ravel(order="K")
            start = 0
            samples = np.resize(flat[start:], samples.size).reshape(samples.shape)
        return super().read(samples)


@blind("symmetry.layout")
class StepsWithoutSign(Engine):
    """Strides are taken by their size: an array that runs backwards is read forwards."""

    def read(self, values: Any) -> Array:
        """The samples, every axis forwards."""
        samples = np.asarray(values)
        turned = tuple(slice(None, None, -1) if s < 0 else slice(None) for s in samples.strides)
        return super().read(samples[turned])


@blind("range.digits", promised=["range.digits"])
class SinglePrecisionSamples(Engine):
    """Samples are converted to single precision before the isovalue is subtracted."""

    def relative(self, samples: Array, alpha: float) -> Array:
        """Differences in single precision."""
        with np.errstate(over="ignore"):
            return np.asarray(samples.astype(np.float32) - np.float32(alpha), np.float64)


@blind("geometry.crossing")
class HalfPrecisionCrossings(Engine):
    """Crossings are computed with half floats."""

    def parameter(self, low: Array, high: Array) -> Array:
        """The parameter, of eleven bits."""
        return super().parameter(low, high).astype(np.float16).astype(np.float64)


@blind("bodies.distance", GITHUB + "libigl/libigl/issues/1032")
class LevelForgotten(Engine):
    """The isovalue finds the cells, and the interpolation looks for zero instead."""

    alpha = 0.0

    def level(self, samples: Array, isovalue: float) -> float:
        """The isovalue, kept for the wrong use."""
        self.alpha = super().level(samples, isovalue)
        return self.alpha

    def parameter(self, low: Array, high: Array) -> Array:
        """Where the samples themselves vanish, if they do; the middle where not."""
        low, high = low + self.alpha, high + self.alpha
        gap = np.where(low == high, 1, low - high)
        return np.asarray(np.where(low * high < 0, low / gap, 0.5))


@blind("range.scale", "https://paulbourke.net/geometry/polygonise/", promised=["range.scale"])
class NearlyEqualIsEqual(Engine):
    """A sample within 1e-5 of the isovalue takes the crossing to itself, whatever the unit."""

    def parameter(self, low: Array, high: Array) -> Array:
        """The parameter, pulled to ends that are close in value."""
        t = super().parameter(low, high)
        near_equal = np.abs(high - low) < 1e-5
        return np.where(
            np.abs(low) < 1e-5, 0.0, np.where(np.abs(high) < 1e-5, 1.0, np.where(near_equal, 0, t))
        )


@blind("topology.sides", GITHUB + "scikit-image/scikit-image/issues/8116")
class LeastDifference(Engine):
    """A relative value below the epsilon of single precision is made that epsilon."""

    def relative(self, samples: Array, alpha: float) -> Array:
        """Differences, never small."""
        found = super().relative(samples, alpha)
        return np.where(np.abs(found) < np.finfo(np.float32).eps, np.finfo(np.float32).eps, found)


@blind("geometry.crossing")
class InverseWeights(Engine):
    """Crossings are weighted by inverse distances plus an epsilon, to spare a division by zero."""

    def parameter(self, low: Array, high: Array) -> Array:
        """The weighted mean of both ends."""
        a, b = 1 / (1e-4 + np.abs(low)), 1 / (1e-4 + np.abs(high))
        return np.asarray(b / (a + b))


@blind("topology.sides")
class Sixteenths(Engine):
    """Crossings are kept in bytes, as games do: 256 places on an edge."""

    def parameter(self, low: Array, high: Array) -> Array:
        """The parameter in 256ths."""
        return np.round(super().parameter(low, high) * 255) / 255


@blind("geometry.crossing")
class AwayFromCorners(Engine):
    """Crossings are kept away from corners by a thousandth, so that no triangle gets thin."""

    def parameter(self, low: Array, high: Array) -> Array:
        """The parameter, clipped."""
        return super().parameter(low, high).clip(1e-3, 1 - 1e-3)


@blind("topology.sides")
class OneEndOnly(Engine):
    """Crossings within a hundredth of the lower end are pulled to it, at the upper end not."""

    def parameter(self, low: Array, high: Array) -> Array:
        """The parameter, zero where it is small."""
        t = super().parameter(low, high)
        return np.where(t < 1e-2, 0, t)


@blind("robustness.nan", promised=["robustness.nan"])
class NoneIsLow(Engine):
    """A sample that is not a number is taken for a low one, and nobody is told."""

    def read(self, values: Any) -> Array:
        """The samples, holes filled."""
        samples = np.asarray(values)
        if samples.dtype.kind == "f" and np.isnan(samples).any():
            samples = np.where(np.isnan(samples), np.nanmin(samples) - 1, samples)
        return super().read(samples)


@blind("robustness.input_unmodified")
class InPlace(Engine):
    """The isovalue is subtracted in place and added again, which rounds."""

    def relative(self, samples: Array, alpha: float) -> Array:
        """Differences, made in the caller's array where it can be written to."""
        if samples.dtype == np.float64 and samples.flags.writeable:
            samples -= alpha
            found = samples.copy()
            samples += alpha
            return found
        return super().relative(samples, alpha)

    def inside(self, samples: Array, relative: Array, alpha: float) -> Array:
        """The sign of the difference."""
        return np.asarray(relative >= 0)


# --- faces and tiles ----------------------------------------------------------------------------


@blind("topology.bilinear", level=3)
class MeanOfTheFace(Engine):
    """An ambiguous face is decided by the mean of its four samples instead of its saddle."""

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """Separated where the mean is outside."""
        from isoref.cube import FACE_CORNERS, is_ambiguous

        ambiguous = np.array([[is_ambiguous(s, f) for s in range(256)] for f in range(6)])
        return np.asarray(
            sum(
                (ambiguous[f][signs] & (g[list(FACE_CORNERS[f])].sum(axis=0) < 0)).astype(np.int64)
                << f
                for f in range(6)
            )
        )


@blind("topology.closed")
class MeanOfTheCell(Engine):
    """An ambiguous face is decided by the mean of the cell, which its neighbour does not share."""

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """All ambiguous faces separated where the mean of the cell is outside."""
        found = super().decisions(g, signs, cells)
        every = np.array([asymptotic_decider.bits_of(ambiguous_faces(s)) for s in range(256)])
        return np.where(g.mean(axis=0) < 0, every[signs], 0) * (found >= 0)


@blind("symmetry.orientation", level=3)
class WrongDiagonal(Engine):
    """The printed test of the decider is used for both diagonals of a face."""

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """Separated where a c < b d, also where b and d are the inside ones."""
        from isoref.cube import FACE_CORNERS, is_ambiguous

        ambiguous = np.array([[is_ambiguous(s, f) for s in range(256)] for f in range(6)])
        found = np.zeros(len(signs), np.int64)
        for f in range(6):
            a, b, c, d = g[sorted(FACE_CORNERS[f])][[0, 1, 3, 2]]
            found |= (ambiguous[f][signs] & (a * c < b * d)).astype(np.int64) << f
        return found


@blind("topology.closed")
class RoundedSaddle(Engine):
    """The saddle is divided out in single precision, in the order of each cell's own walk."""

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """The sign of a rounded saddle."""
        from isoref.cube import FACE_CORNERS, is_ambiguous

        ambiguous = np.array([[is_ambiguous(s, f) for s in range(256)] for f in range(6)])
        found = np.zeros(len(signs), np.int64)
        with np.errstate(all="ignore"):
            for f in range(6):
                a, b, c, d = g[list(FACE_CORNERS[f])].astype(np.float32)
                slope = (a - d) / ((a - b) + (c - d))
                saddle = a + slope * (b - a)
                found |= (ambiguous[f][signs] & (saddle < 0)).astype(np.int64) << f
        return found


@blind("topology.closed")
class FaceBitLost(Engine):
    """The test of one face of six is left out: its inside corners are always joined."""

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """The decisions without that of face 3."""
        return super().decisions(g, signs, cells) & ~(1 << 3)


@blind("topology.oriented", GITHUB + "afni/afni/issues/342")
class RowTurned(Engine):
    """One row of the table lists its triangles the other way round."""

    def tile(self, signs: int, decisions: int) -> Tile:
        """The tile, turned for one row."""
        tile = super().tile(signs, decisions)
        if signs != 0b01101011:
            return tile
        return Tile(tuple((a, c, b) for a, b, c in tile.triangles), tile.interior)


@blind("topology.closed")
class RowShort(Engine):
    """One row of the table lacks its last triangle."""

    def tile(self, signs: int, decisions: int) -> Tile:
        """The tile, one triangle short for one row."""
        tile = super().tile(signs, decisions)
        return Tile(tile.triangles[:-1], tile.interior) if signs == 0b10110100 else tile


@blind("topology.closed")
class RowOfOneVariant(Engine):
    """One row of the table, for one decision of one configuration, lacks a triangle."""

    def tile(self, signs: int, decisions: int) -> Tile:
        """The tile, one triangle short in a variant of 13."""
        tile = super().tile(signs, decisions)
        rare = configuration(signs) == 13 and decisions.bit_count() == 5
        return Tile(tile.triangles[:-1], tile.interior) if rare else tile


@blind("bodies.holes", GITHUB + "JuliaGeometry/MarchingCubes.jl/issues/21")
class MisprintedEdge(Engine):
    """One number of one row of the table is off by one: an edge that is not crossed."""

    def tile(self, signs: int, decisions: int) -> Tile:
        """The tile with a misprint."""
        tile = super().tile(signs, decisions)
        if signs != 0b00110111 or not tile.triangles:
            return tile
        (a, b, c), *rest = tile.triangles
        return Tile(((a, b, (c + 1) % 12), *rest), tile.interior)

    def crossings(self, g: Array, signs: Array, cells: Array) -> Array:
        """Edges that are not crossed have their middle."""
        found = super().crossings(g, signs, cells)
        for e, (a, b) in enumerate(EDGE_CORNERS):
            middle = (CORNER_OFFSETS[a] + CORNER_OFFSETS[b]) / 2
            found[e] = np.where(np.isnan(found[e]), middle, found[e])
        return found


@blind("topology.manifold")
class FansOnFaces(Engine):
    """Every polygon is cut from its first corner, with chords on the faces of the cell."""

    def tile(self, signs: int, decisions: int) -> Tile:
        """The polygons as fans from their first corners."""
        return Tile(
            tuple(
                (p[0], p[i], p[i + 1])
                for p in cycles(signs, decisions)
                for i in range(1, len(p) - 1)
            )
        )


class CentreInEveryPolygon(Engine):
    """Polygons of four corners get a point in their middle.

    Its author took it for a fault; a cell may have inner points, so it is none, and every claim
    lets it pass, as it should.
    """

    def tile(self, signs: int, decisions: int) -> Tile:
        """Quadrilaterals as four triangles round their mean, where no other tile has a point."""
        polygons = cycles(signs, decisions)
        if any(len(p) > 6 for p in polygons):
            return super().tile(signs, decisions)
        triangles: list[tuple[int, int, int]] = []
        inner: list[Average] = []
        for p in polygons:
            if len(p) == 4:
                triangles += fan(p, 12 + len(inner))
                inner.append(Average(p))
            else:
                triangles += [(p[0], p[i], p[i + 1]) for i in range(1, len(p) - 1)]
        return Tile(tuple(triangles), tuple(inner))


@blind("topology.manifold")
class OnePointForAll(Engine):
    """The inner points of a layer of cells share a number: the last one places them all."""

    def inner_name(self, cells: Array, node: int, key: int, shape: tuple[int, ...]) -> Array:
        """A name that forgets the first index."""
        without = cells.copy()
        without[:, 0] = 0
        return super().inner_name(without, node, key, shape)


@blind("topology.trilinear", "https://doi.org/10.1016/j.cag.2013.04.004", level=4)
class NoTunnels(Engine):
    """The faces are right and no cell gets a tunnel, though the trilinear topology is promised."""

    rule = asymptotic_decider.RULE


@blind("topology.trilinear", "https://doi.org/10.1016/j.cag.2013.04.004", level=4)
class OneSlice(Engine):
    """A tunnel is decided by one slice, as Chernyaev wrote, and not by the interpolant's shape."""

    rule = trilinear_cubes.RULE

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """Tunnel bits dropped where the slice at the middle of axis 0 is separated."""
        found = super().decisions(g, signs, cells)
        middle = (g[0::2] + g[1::2]) / 2
        cut = middle[0] * middle[3] < middle[1] * middle[2]
        return np.where(cut, found & 63, found)


@blind("topology.closed", GITHUB + "tatsy/torchmcubes/issues/7")
class DrawingsOf1987(Engine):
    """The drawings of 1987, which tear between a cell and the complement of another."""

    rule = lorensen_cline.RULE


# --- names of vertices, numbers and places ------------------------------------------------------


@blind("structure.no_repeated_index", GITHUB + "nglviewer/ngl/pull/605")
class NamedByItsEnd(Engine):
    """A vertex is named by the lower end of its edge alone: three edges share a name."""

    def edge_name(self, cells: Array, e: int, shape: tuple[int, ...]) -> Array:
        """The flat index of the lower end."""
        return self.flat(cells + CORNER_OFFSETS[EDGE_CORNERS[e][0]], shape)


@blind("topology.closed")
class ShapesExchanged(Engine):
    """The flat index uses the wrong extent: fine in cubes, wrong where the axes differ."""

    def flat(self, index: Array, shape: tuple[int, ...]) -> Array:
        """A flat index that collides in lattices longer along the last axis."""
        i, j, k = index.T
        return np.asarray((i * shape[0] + j) * shape[1] + k)


@blind("topology.closed", GITHUB + "seung-lab/zmesh/issues/4")
class NineBits(Engine):
    """Names keep nine bits an axis: beyond 512 samples they repeat."""

    def flat(self, index: Array, shape: tuple[int, ...]) -> Array:
        """The three indices side by side, nine bits each."""
        i, j, k = (index & 511).T
        return np.asarray(i << 18 | j << 9 | k)


@blind("topology.closed")
class SixteenBits(Engine):
    """Triangles are returned with 16-bit numbers, which wrap beyond 65,536 vertices."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh with short numbers."""
        made, rows = super().finish(vertices, triangles, spacing, shape)
        return made, rows.astype(np.uint16)


@blind("structure.no_repeated_index")
class SixteenMillion(Engine):
    """Names of edges pass through single precision: beyond 2^24 neighbours share one."""

    def edge_name(self, cells: Array, e: int, shape: tuple[int, ...]) -> Array:
        """The name, rounded."""
        return super().edge_name(cells, e, shape).astype(np.float32).astype(np.int64)


@blind("bodies.pieces", GITHUB + "pmneila/PyMCubes/issues/13")
class NothingShared(Engine):
    """Each triangle brings its own three vertices, though an indexed mesh is declared."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The triangles as a soup."""
        soup = vertices[triangles.reshape(-1)]
        return super().finish(soup, np.arange(len(soup)).reshape(-1, 3), spacing, shape)


@blind("bodies.pieces")
class Seams(Engine):
    """The volume is drawn in slabs of eight layers that share no vertices where they meet."""

    def edge_name(self, cells: Array, e: int, shape: tuple[int, ...]) -> Array:
        """A name that knows the slab of its cell."""
        return np.asarray(super().edge_name(cells, e, shape) * 1000 + cells[:, 0] // 8)


@blind("structure.no_repeated_index")
class WeldedByPlace(Engine):
    """Vertices are welded by their place, rounded to five digits in the world's unit."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh after welding; triangles that collapse stay."""
        made, rows = super().finish(vertices, triangles, spacing, shape)
        _, first, number = np.unique(made.round(5), axis=0, return_index=True, return_inverse=True)
        return made[first], number.reshape(-1)[rows]


@blind("topology.closed", GITHUB + "scikit-image/scikit-image/pull/4872")
class FlatOnesDropped(Engine):
    """Triangles without area are dropped one by one, their vertices not welded."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh without thin triangles."""
        a, b, c = (vertices[triangles[:, k]] for k in range(3))
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        return super().finish(vertices, triangles[area > 1e-6], spacing, shape)


@blind("structure.answers")
class LoneSamples(Engine):
    """A lattice that is one sample thick is refused."""

    def read(self, values: Any) -> Array:
        """The samples, at least two along each axis."""
        samples = super().read(values)
        if min(samples.shape) < 2:
            raise IndexError("index 1 is out of bounds for axis 0 with size 1")
        return samples


@blind("symmetry.spacing", GITHUB + "CGAL/cgal/pull/6849")
class FirstSpacing(Engine):
    """The spacing of the first axis serves all three."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh in cubes."""
        return super().finish(vertices, triangles, (spacing[0],) * 3, shape)


@blind("symmetry.spacing")
class SpacingReversed(Engine):
    """The spacing is applied in the order x, y, z to coordinates in the order z, y, x."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh with the wrong unit on two axes."""
        return super().finish(vertices, triangles, spacing[::-1], shape)


@blind("topology.sides")
class CrossingsInTheWorld(Engine):
    """Vertices are rounded to a hundredth of the world's unit, however small the cells are."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh with two digits."""
        made, rows = super().finish(vertices, triangles, spacing, shape)
        return (made * 128).round() / 128, rows


@blind("bodies.offset", GITHUB + "pmneila/PyMCubes/issues/22")
class OneSampleLess(Engine):
    """Coordinates are stretched by n / (n - 1), as if the samples filled the cells."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh, stretched."""
        n = np.array(shape)
        return super().finish(vertices * n / (n - 1), triangles, spacing, shape)


@blind("bodies.centroid")
class HalfACell(Engine):
    """Coordinates count from the corners of voxels: half a cell too much."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh, moved."""
        return super().finish(vertices + 0.5, triangles, spacing, shape)


@blind("bodies.centroid", GITHUB + "Marcello-Sega/pytim/pull/339")
class AxesReversed(Engine):
    """Coordinates come in the order z, y, x, and the order is not declared."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh, mirrored and turned back."""
        made, rows = super().finish(vertices, triangles, spacing, shape)
        return made[:, ::-1], rows[:, ::-1]


@blind("robustness.deterministic")
class OrderOfTheDay(Engine):
    """Triangles come in another order each time, as from threads that race."""

    calls = 0

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh, its triangles rolled by the number of calls so far."""
        OrderOfTheDay.calls += 1
        made, rows = super().finish(vertices, triangles, spacing, shape)
        return made, np.roll(rows, OrderOfTheDay.calls, axis=0)


@blind("topology.closed")
class RelaxedALittle(Engine):
    """Vertices are smoothed by one step in a thousand towards their neighbours."""

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The mesh, slightly smoothed."""
        mean, count = np.zeros_like(vertices), np.zeros(len(vertices))
        for a, b in ((0, 1), (1, 2), (2, 0)):
            np.add.at(mean, triangles[:, a], vertices[triangles[:, b]])
            np.add.at(count, triangles[:, a], 1)
        moved = vertices + 1e-3 * (mean / np.maximum(count, 1)[:, None] - vertices)
        return super().finish(moved, triangles, spacing, shape)


# --- whole calls, of the reference and of scikit-image ------------------------------------------


@blind("topology.sides")
def a_corner_of_nothing(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Where there is no surface the answer is one triangle at the origin."""
    mesh = extract(values, isovalue, spacing)
    if len(mesh.simplices):
        return mesh.vertices, mesh.simplices
    return np.eye(3) * 1e-3, np.array([[0, 1, 2]])


@blind("robustness.bad_input", promised=["robustness.bad_input"])
def any_rank(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """A picture is taken for a volume one sample thick, and answered."""
    volume = np.atleast_3d(values)
    mesh = extract(volume, isovalue, (*spacing, 1.0, 1.0, 1.0)[:3])
    return mesh.vertices, mesh.simplices


@blind("structure.all_used", promised=["structure.all_used"])
def every_sample(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """The samples themselves are left among the vertices."""
    mesh = extract(values, isovalue, spacing)
    points = np.argwhere(np.ones(np.shape(values))) * np.asarray(spacing)
    return np.concatenate([mesh.vertices, points]), mesh.simplices


def skimage(values: Any, isovalue: float, spacing: Spacing, **options: Any) -> Answer:
    """scikit-image's answer; nothing where it says that there is none."""
    from skimage.measure import marching_cubes

    samples = np.asarray(values)
    if min(samples.shape) < 2 or not samples.min() < isovalue <= samples.max():
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    try:
        made = marching_cubes(samples, isovalue, spacing=spacing, **options)
    except RuntimeError:  # "No surface found at the given iso value."
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    return made[0], made[1]


@blind("bodies.offset", GITHUB + "tatsy/torchmcubes/issues/7")
def skimage_of_1987(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """The method of 1987 is called, and a consistent mesh is promised."""
    return skimage(values, isovalue, spacing, method="lorensen")


@blind("bodies.offset")
def skimage_every_second(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Every second sample is read, for speed."""
    return skimage(values, isovalue, spacing, step_size=2)


@blind("topology.manifold")
def skimage_up(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Normals point to high values, and nobody said so."""
    return skimage(values, isovalue, spacing, gradient_direction="ascent")


@blind("bodies.offset", GITHUB + "scikit-image/scikit-image/issues/8202")
def skimage_masked(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """Cells whose samples are all near the least value are masked out."""
    samples = np.asarray(values, np.float64)
    mask = samples > samples.min() + 0.05 * np.ptp(samples)
    return skimage(values, isovalue, spacing, mask=mask)


@blind("bodies.offset")
def skimage_normalised(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """The volume is scaled to 256 grey values first."""
    samples = np.asarray(values, np.float64)
    size = np.ptp(samples) or 1.0
    grey = (255 * ((samples - samples.min()) / size)).astype(np.uint8)
    return skimage(grey, 255 * (isovalue - samples.min()) / size, spacing)


@blind("bodies.offset")
def skimage_smoothed(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """The volume is smoothed a little before the surface is drawn."""
    smooth = gaussian_filter(np.asarray(values, np.float64), 0.35)
    return skimage(smooth, isovalue, spacing)


@blind("bodies.offset")
def skimage_padded(values: Any, isovalue: float, spacing: Spacing) -> Answer:
    """The volume is padded by its own border, and the pad is not taken off again."""
    return skimage(np.pad(np.asarray(values, np.float64), 1, mode="edge"), isovalue, spacing)
