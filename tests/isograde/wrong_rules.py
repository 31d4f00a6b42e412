"""Cube rules that are wrong in one way each, with the check of the proof that must say so."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import count, pairwise
from typing import Any

import numpy as np
from isoref import asymptotic_decider, lorensen_cline, trilinear_cubes
from isoref.asymptotic_decider import RULE as ASYMPTOTIC
from isoref.cube import FACE_CORNERS, ambiguous_faces, configuration
from isoref.cycles import ALL_JOINED, cycles
from isoref.field import Booleans, Floats, Integers
from isoref.rule import Average, Rule, Tile

FaceTest = Callable[[Floats, Floats, Floats, Floats], Any]


def by_faces(separated: FaceTest) -> Rule:
    """The asymptotic decider's tiles, with another test of faces: values in the order of a walk."""

    def decisions(g: Floats) -> Integers:
        bits = np.zeros(g.shape[1], np.int64)
        for f, walk in enumerate(FACE_CORNERS):
            a, b, c, d = g[list(walk)]
            ambiguous = ((a >= 0) == (c >= 0)) & ((b >= 0) == (d >= 0)) & ((a >= 0) != (b >= 0))
            bits |= (ambiguous & separated(a, b, c, d)).astype(np.int64) << f
        return bits

    return replace(ASYMPTOTIC, decisions=decisions)


def mean_in_walk_order(a: Floats, b: Floats, c: Floats, d: Floats) -> Booleans:
    """The mean of four values is below zero, added as they come."""
    return np.asarray(a + b + c + d < 0)


def divided_saddle(a: Floats, b: Floats, c: Floats, d: Floats) -> Booleans:
    """The interpolant at the saddle is below zero: the saddle by a division, then four products."""
    D = np.where(a + c - b - d == 0, 1.0, a + c - b - d)
    s, t = (a - d) / D, (a - b) / D
    return np.asarray(((1 - s) * a + s * b) * (1 - t) + ((1 - s) * d + s * c) * t < 0)


def scaled_by_the_cell(g: Floats) -> Integers:
    """The trilinear rule as it once was: each cell scaled by its largest value, then decided."""
    there, joins_inside = trilinear_cubes.tunnels(g)
    bits = np.where(joins_inside, trilinear_cubes.INSIDE_TUNNEL, trilinear_cubes.OUTSIDE_TUNNEL)
    faces = asymptotic_decider.decisions(trilinear_cubes.normalised(g))
    return np.asarray(faces | np.where(there, bits, 0))


def scaled_by_all(g: Floats) -> Integers:
    """Values below a millionth of the largest in the whole call count as zero."""
    return ASYMPTOTIC.decisions(np.where(np.abs(g) < 1e-6 * np.abs(g).max(), 0.0, g))


def by_the_mean_of_the_cell(g: Floats) -> Integers:
    """A face is decided by the face where the cell's mean is inside, else joined."""
    return np.asarray(np.where(g.mean(axis=0) > 0, ASYMPTOTIC.decisions(g), 0))


def every_face(g: Floats) -> Integers:
    """All six bits, whether the faces are ambiguous or not, by the sign of the face's sum."""
    bits = np.zeros(g.shape[1], np.int64)
    for f, walk in enumerate(FACE_CORNERS):
        bits |= (np.sort(g[list(walk)], axis=0).sum(axis=0) < 0).astype(np.int64) << f
    return bits


def in_small_calls(g: Floats) -> Integers:
    """Right decisions in small calls; in large ones by the mean of the cell."""
    return ASYMPTOTIC.decisions(g) if g.shape[1] < 1000 else by_the_mean_of_the_cell(g)


def in_one_layout(g: Floats) -> Integers:
    """Right decisions where the values of a corner lie side by side; else none."""
    return ASYMPTOTIC.decisions(g) * g.flags.c_contiguous


def in_place(g: Floats) -> Integers:
    """Right decisions, but the values are scaled where they stand."""
    bits = ASYMPTOTIC.decisions(g)
    g *= 2
    return bits


def spoiled(change: Callable[[Tile], Tile], base: Rule = ASYMPTOTIC) -> Rule:
    """The rule with every tile changed."""
    return replace(base, tile=lambda signs, decisions: change(base.tile(signs, decisions)))


def only_at(case: tuple[int, int], change: Callable[[Tile], Tile], base: Rule) -> Rule:
    """The rule with one tile changed."""

    def tile(signs: int, decisions: int) -> Tile:
        right = base.tile(signs, decisions)
        return change(right) if (signs, decisions) == case else right

    return replace(base, tile=tile)


def turned(tile: Tile) -> Tile:
    """Every triangle the other way round."""
    return replace(tile, triangles=tuple((c, b, a) for a, b, c in tile.triangles))


def shortened(tile: Tile) -> Tile:
    """The last triangle missing."""
    return replace(tile, triangles=tile.triangles[:-1])


def doubled(tile: Tile) -> Tile:
    """The first triangle there twice."""
    return replace(tile, triangles=tile.triangles + tile.triangles[:1])


def collapsed(tile: Tile) -> Tile:
    """One more triangle, which names a node twice."""
    a, b, _ = tile.triangles[0] if tile.triangles else (0, 0, 0)
    return replace(tile, triangles=(*tile.triangles, (a, b, b))) if tile.triangles else tile


def without_interior(tile: Tile) -> Tile:
    """The interior points are named and not there."""
    return replace(tile, interior=())


def one_point_more(tile: Tile) -> Tile:
    """One more interior point, which no triangle names."""
    return replace(tile, interior=(*tile.interior, Average((0,))))


def fractional(tile: Tile) -> Tile:
    """Nodes as floats."""
    triangles: Any = tuple(tuple(float(n) for n in t) for t in tile.triangles)
    return replace(tile, triangles=triangles)


def fans_on_faces(signs: int, decisions: int) -> Tile:
    """Every polygon a fan from its first node, whatever face its chords lie on."""
    triangles = []
    for polygon in cycles(signs, ALL_JOINED):
        triangles += [(polygon[0], p, q) for p, q in pairwise(polygon[1:])]
    return Tile(tuple(triangles))


def one_middle(signs: int, decisions: int) -> Tile:
    """Every polygon round one and the same interior point."""
    polygons = cycles(signs, decisions)
    triangles = [(a, b, 12) for p in polygons for a, b in zip(p, p[1:] + p[:1], strict=True)]
    return Tile(tuple(triangles), (Average((0,)),) if triangles else ())


def moody() -> Rule:
    """A tile that is another one each time it is asked for."""
    calls = count()
    return spoiled(lambda tile: turned(tile) if next(calls) % 1000 == 999 else tile)


def refusing(signs: int, decisions: int) -> Tile:
    """No tile for the configuration 13, which it takes for impossible."""
    if configuration(signs) == 13:
        raise KeyError(decisions)
    return ASYMPTOTIC.tile(signs, decisions)


def unasked_for_three(signs: int) -> bool:
    """Not asked where configuration 3 leaves one face open."""
    return bool(ambiguous_faces(signs)) and configuration(signs) != 3


@dataclass(frozen=True)
class Wrong:
    """A wrong rule, the check that must be broken, and words of what it says."""

    rule: Any
    check: str
    words: str


def _decides(decisions: Any, base: Rule = ASYMPTOTIC) -> Rule:
    """The rule with other decisions."""
    return replace(base, decisions=decisions)


THREE_OF_TWO_BITS = replace(ASYMPTOTIC, bits=2)
TUNNEL_TILE = (0b10000001, trilinear_cubes.INSIDE_TUNNEL)

#: The first five are those of the issue that asked for premises.
WRONG: dict[str, Wrong] = {
    "asks leaves configuration 3 out": Wrong(
        replace(ASYMPTOTIC, asks=unasked_for_three), "cells that are not asked", "cells tear"
    ),
    "an interior node that is not there": Wrong(
        spoiled(without_interior), "tiles", "names node 12; there are 0 to 11 and 0 interior"
    ),
    "decisions beyond bits": Wrong(
        THREE_OF_TWO_BITS, "decisions in range", "which is not of 2 bits"
    ),
    "a mean in walk order": Wrong(
        by_faces(mean_in_walk_order), "decisions of a face", "differently"
    ),
    "a saddle by division": Wrong(by_faces(divided_saddle), "decisions of a face", "differently"),
    "scaled by the cell's largest": Wrong(
        _decides(scaled_by_the_cell, trilinear_cubes.RULE), "decisions of a face", "differently"
    ),
    "scaled by the largest of all": Wrong(
        _decides(scaled_by_all), "decisions of a cell", "among others"
    ),
    "other in large calls": Wrong(
        _decides(in_small_calls), "decisions of a cell", "in one call with all others"
    ),
    "other in another layout": Wrong(
        _decides(in_one_layout), "decisions of a cell", "another layout"
    ),
    "the cell's mean": Wrong(_decides(by_the_mean_of_the_cell), "decisions of a face", "differ"),
    "faces decided that are not ambiguous": Wrong(
        _decides(every_face), "decisions in range", "is not ambiguous"
    ),
    "values changed in place": Wrong(_decides(in_place), "decisions in range", "changes the val"),
    "decisions that are floats": Wrong(
        _decides(lambda g: ASYMPTOTIC.decisions(g) / 1), "decisions in range", "float64"
    ),
    "one decision for all cells": Wrong(
        _decides(lambda g: np.int64(0)), "decisions in range", "of shape ()"
    ),
    "decisions that raise": Wrong(_decides(lambda g: [][1]), "decisions in range", "IndexError"),
    "a tile that changes": Wrong(moody(), "tiles", "asked again"),
    "a tile that raises": Wrong(replace(ASYMPTOTIC, tile=refusing), "tiles", "raises KeyError"),
    "an interior point by itself": Wrong(
        only_at((1, 0), one_point_more, ASYMPTOTIC), "tiles", "a vertex by itself"
    ),
    "nodes that are no integers": Wrong(spoiled(fractional), "tiles", "no whole number"),
    "bits that are no number": Wrong(replace(ASYMPTOTIC, bits="six"), "form", "'six'"),  # type: ignore[arg-type]
    "asks that answers a mask": Wrong(
        replace(ASYMPTOTIC, asks=ambiguous_faces),  # type: ignore[arg-type]
        "form",
        "not true or false",
    ),
    "no rule at all": Wrong(object(), "form", "no function `tile`"),
    "turned": Wrong(spoiled(turned), "condition 2", "inside on its left"),
    "shortened": Wrong(spoiled(shortened), "condition 1", "not on the crossed lattice edges"),
    "doubled": Wrong(spoiled(doubled), "condition 1", "twice in one direction"),
    "collapsed": Wrong(spoiled(collapsed), "condition 1", "names a node twice"),
    "one tunnel open": Wrong(
        only_at(TUNNEL_TILE, shortened, trilinear_cubes.RULE), "condition 2", "lies on no face"
    ),
    "the table of 1987": Wrong(lorensen_cline.RULE, "condition 3", "660 pairs of cells tear"),
    "chords on faces": Wrong(Rule("fans", fans_on_faces), "condition 4", "both have the chord"),
    "one middle": Wrong(replace(ASYMPTOTIC, tile=one_middle), "condition 5", "not one fan"),
}
