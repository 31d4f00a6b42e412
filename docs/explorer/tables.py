"""The tables of the explorer, as JSON: what every rule of `isoref` draws in every cell.

Nothing here is typed in: tiles, polygons and names come from `isoref`, the cases of Chernyaev and
one cell of each topology from the grader's oracle. The explorer adds arithmetic only: which numbers
a rule compares, and where its interior points stand.

Glossary
--------
signs, decisions    as in `isoref.rule`
key                 signs | decisions << 8
word                nodes or edges in a row, one character each: 0 .. 9, a .. z
tile                a word of triangles, and the placements of nodes 12, 13, ..
placement           a kind with its parameters: ["average", word], ["saddles", face, face],
                    ["diagonal", corner], ["waist", corner, swap], ["surface", word], ["pair", a, b]
separated           the face bits that the tile in fact shows; tunnel: 0, 64 or 128 as in
                    `isoref.trilinear_cubes`, or -1 where it is neither discs nor that tunnel
"""

from __future__ import annotations

import json
import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from isograde.cases.trilinear_cells import cell_of
from isograde.oracles import trilinear_cases
from isograde.oracles.trilinear import rim_of
from isoref import asymptotic_decider, kuhn, simplex_section, trilinear_cubes
from isoref.cube import (
    CORNERS,
    EDGE_OF,
    EDGES,
    FACE_CORNERS,
    FACE_EDGES,
    ROTATIONS,
    ambiguous_faces,
    configuration,
    is_exchanged,
)
from isoref.cycles import Triangle, cycles, segments
from isoref.diconex import diconex
from isoref.field import Floats
from isoref.marching_tetrahedra import KUHN, section
from isoref.methods import RULES
from isoref.rule import Average, Tile
from isoref.sweep import crossing_parameter

JSON = dict[str, Any]
FACE_BITS = 0b111111

# How each rule is called, the numbers it compares, and the sentence beside its picture.
SHOWN = {
    "lorensen-cline": (
        "Marching cubes, 1987",
        "none",
        "Lorensen & Cline: the minority is cut apart. No numbers are compared.",
    ),
    "asymptotic-decider": (
        "Asymptotic decider, 1991",
        "faces",
        "Nielson & Hamann: the saddle of each ambiguous face decides.",
    ),
    "trilinear-cubes": (
        "Trilinear cubes",
        "trilinear",
        "Saddles of faces, and inside the cell the tunnel that the interpolant has.",
    ),
    "marching-vesta-mixed-L": (
        "VESTA, mixed, L",
        "mean",
        "Schlei: the mean of a face's four values decides; no added points up to seven sides.",
    ),
    "marching-vesta-mixed-H": (
        "VESTA, mixed, H",
        "mean",
        "Schlei: the mean decides; an added point in every cycle of more than three.",
    ),
    "marching-vesta-disconnect-L": (
        "VESTA, disconnect, L",
        "none",
        "Schlei: inside corners of an ambiguous face are always separated.",
    ),
    "marching-vesta-disconnect-H": (
        "VESTA, disconnect, H",
        "none",
        "Schlei: always separated; an added point in every cycle of more than three.",
    ),
    "marching-vesta-connect-L": (
        "VESTA, connect, L",
        "none",
        "Schlei: inside corners of an ambiguous face are always joined.",
    ),
    "marching-vesta-connect-H": (
        "VESTA, connect, H",
        "none",
        "Schlei: always joined; an added point in every cycle of more than three.",
    ),
    "marching-tetrahedra-kuhn": (
        "Marching tetrahedra",
        "none",
        "Six tetrahedra round one diagonal of the cell: linear in each, nothing is ambiguous.",
    ),
}


def tables() -> JSON:
    """Everything the explorer shows that is no arithmetic."""
    store = Store()
    assert set(RULES) < set(SHOWN), "a rule of the catalogue is not shown"
    rules = {name: rule_table(name, store) for name in SHOWN}
    named = [(signs, bits) for signs, bits in decided(8) if trilinear_name(signs, bits)]
    return {
        "corners": CORNERS,
        "edges": EDGES,
        "faceCorners": FACE_CORNERS,
        "faceEdges": FACE_EDGES,
        "rules": rules,
        "tiles": store.tiles,
        "polygons": {key(*one): [word(p) for p in cycles(*one)] for one in decided(6)},
        "configurations": [[configuration(s), int(is_exchanged(s))] for s in range(256)],
        "variants": {key(*one): asymptotic_decider.variant(*one) for one in decided(6)},
        "cases": {key(*one): trilinear_name(*one) for one in named},
        "cells": {key(*one): example(*one) for one in named},
        "cycles": cycle_classes(),
        "squares": squares(),
        "kuhn4": kuhn.chains(4).tolist(),
        "kuhn4signs": kuhn.signs(4).tolist(),
        "sections4": [section_rows(code) for code in range(32)],
    }


def key(signs: int, bits: int) -> int:
    """Signs and decisions as one number."""
    return signs | bits << 8


def word(nodes: Iterable[int]) -> str:
    """Nodes in a row, one character each."""
    return "".join("0123456789abcdefghijklmnopqrstuvwxyz"[node] for node in nodes)


def decided(bits: int) -> Iterator[tuple[int, int]]:
    """Every pair of signs and decisions in which no bit is idle."""
    for signs in range(256):
        faces = asymptotic_decider.bits_of(ambiguous_faces(signs))
        for decision in range(1 << bits):
            if decision & FACE_BITS & ~faces:
                continue
            if not decision >> 6 or trilinear_cubes.tunnel(signs, decision):
                yield signs, decision


# --- tiles --------------------------------------------------------------------------------------


class Store:
    """Tiles by number, each once."""

    def __init__(self) -> None:
        self.tiles: list[list[Any]] = []
        self.number: dict[str, int] = {}

    def add(self, tile: Tile) -> int:
        """The number of this tile."""
        triangles = word(node for triangle in tile.triangles for node in triangle)
        row = [triangles, [placement_json(one) for one in tile.interior]]
        text = json.dumps(row)
        if text not in self.number:
            self.number[text] = len(self.tiles)
            self.tiles.append(row)
        return self.number[text]


def rule_table(name: str, store: Store) -> JSON:
    """What one rule draws: rows of key, tile, separated, tunnel."""
    title, compares, says = SHOWN[name]
    rows = []
    bits = RULES[name].bits if name in RULES else 0
    for signs, decisions in decided(bits):
        tile = RULES[name].tile(signs, decisions) if name in RULES else cut(signs)
        rows.append([key(signs, decisions), store.add(tile), *shape_of(tile, signs)])
    return {"title": title, "compares": compares, "says": says, "rows": rows}


def placement_json(one: object) -> list[Any]:
    """A placement as its kind and its parameters."""
    if isinstance(one, Average):
        return ["average", word(one.nodes)]
    if isinstance(one, asymptotic_decider.BetweenSaddles):
        return ["saddles", one.top, one.bottom]
    if isinstance(one, asymptotic_decider.OnDiagonal):
        return ["diagonal", one.v]
    if isinstance(one, trilinear_cubes.OnWaist):
        return ["waist", one.corner, one.swap]
    if isinstance(one, trilinear_cubes.OnSurface):
        return ["surface", word(one.polygon)]
    if isinstance(one, Pair):
        return ["pair", one.low, one.high]
    raise TypeError(f"the explorer does not know the placement {one!r}")


@dataclass(frozen=True)
class Pair:
    """The placement where the segment between two corners is crossed: on a diagonal of a split."""

    low: int
    high: int

    def __call__(self, g: Floats, crossings: Floats) -> Floats:
        """The points, (n, 3)."""
        t = crossing_parameter(g[self.low], g[self.high])[:, None]
        a, b = np.array(CORNERS[self.low]), np.array(CORNERS[self.high])
        return np.asarray(a + t * (b - a))


def cut(signs: int) -> Tile:
    """The tile of Kuhn's six tetrahedra: crossings of diagonals are interior points."""
    triangles: list[Triangle] = []
    pairs: list[Pair] = []
    for tetrahedron in KUHN.at((0, 0, 0)):
        for piece in section(tetrahedron, signs):
            a, b, c = (node_of(ends, pairs) for ends in piece)
            triangles.append((a, b, c))
    return Tile(tuple(triangles), tuple(pairs))


def node_of(ends: tuple[int, int], pairs: list[Pair]) -> int:
    """The node of a crossed edge of the split; the diagonal is added to `pairs` where it is new."""
    edge = EDGE_OF.get(frozenset(ends))
    if edge is not None:
        return edge
    pair = Pair(*sorted(ends))
    if pair not in pairs:
        pairs.append(pair)
    return 12 + pairs.index(pair)


# --- what a tile shows --------------------------------------------------------------------------


def shape_of(tile: Tile, signs: int) -> tuple[int, int]:
    """The face bits that the tile's border shows, and the tunnel it has."""
    rims = boundary(tile)
    separated = 0
    for face in ambiguous_faces(signs):
        on_face = {frozenset(side) for side in rims if set(side) <= set(FACE_EDGES[face])}
        # A cut along the face's diagonal crosses it between the two edges that it separates.
        if not on_face:
            separated |= tetrahedral_bit(signs, face) << face
            continue
        for bit in (0, 1):
            wanted = {frozenset(one) for one in segments(signs, face, bool(bit))}
            if on_face == wanted:
                separated |= bit << face
    return separated, tunnel_of(tile, signs, separated)


def tetrahedral_bit(signs: int, face: int) -> int:
    """Whether the face's diagonal from low to high runs between outside corners."""
    return int(not signs >> min(FACE_CORNERS[face]) & 1)


def boundary(tile: Tile) -> list[tuple[int, int]]:
    """The sides of triangles that no other triangle has in reverse."""
    sides = {(t[i], t[(i + 1) % 3]) for t in tile.triangles for i in range(3)}
    return sorted(side for side in sides if side[::-1] not in sides)


def tunnel_of(tile: Tile, signs: int, separated: int) -> int:
    """0 where the tile is one disc for each polygon, 64 or 128 a tunnel, else -1."""
    triangles = tile.triangles
    parts: list[set[int]] = []
    for triangle in triangles:
        near = [part for part in parts if part & set(triangle)]
        parts = [part for part in parts if part not in near] + [set(triangle).union(*near)]
    polygons = cycles(signs, separated)
    sheets = {frozenset(p for p in polygons if p[0] in part): part for part in parts}
    joined = [sheet for sheet in sheets if len(sheet) != 1]
    for sheet, part in sheets.items():
        own = [t for t in triangles if t[0] in part]
        lines = {frozenset(pair) for t in own for pair in combinations(t, 2)}
        if len(part) - len(lines) + len(own) != 2 - len(sheet):
            return -1
    if not joined:
        return 0
    for bit in (trilinear_cubes.INSIDE_TUNNEL, trilinear_cubes.OUTSIDE_TUNNEL):
        found = trilinear_cubes.tunnel(signs, separated | bit)
        if found is not None and joined == [frozenset(found)]:
            return bit
    return -1


# --- names, and a cell for each -----------------------------------------------------------------


def topology(signs: int, bits: int) -> trilinear_cases.Topology | None:
    """The oracle's word for these signs and decisions; None for a tunnel that cannot be.

    The oracle numbers corners the other way round: bit 0 of ours is its bit 2.
    """
    order = [c >> 2 & 1 | c & 2 | (c & 1) << 2 for c in range(8)]
    high = tuple(1 if signs >> order[c] & 1 else -1 for c in range(8))
    ambiguous = ambiguous_faces(signs)
    faces = tuple((-1 if bits >> f & 1 else 1) if f in ambiguous else 0 for f in range(6))
    body = list(rim_of(high, faces))
    if bits >> 6:
        joined = trilinear_cubes.tunnel(signs, bits)
        if joined is None:
            return None
        inside = bits >> 6 == 1
        ends = [next(c for c in EDGES[p[0]] if bool(signs >> c & 1) == inside) for p in joined]
        one, other = sorted(body[order.index(c)] for c in ends)
        body = [one if part == other else part for part in body]
    return trilinear_cases.Topology(high, faces, tuple(body))


def trilinear_name(signs: int, bits: int) -> str | None:
    """Chernyaev's name of a cell with these decisions; None where no values make it."""
    found = topology(signs, bits)
    possible = found is not None and found in trilinear_cases.every_topology()
    return trilinear_cases.case_name(found) if found is not None and possible else None


def example(signs: int, bits: int) -> list[int]:
    """1024 times the values at the corners of a cell in which this happens, isovalue 0."""
    found = topology(signs, bits)
    assert found is not None
    values = cell_of(found, 0)
    cell = [float(values[corner]) for corner in CORNERS]
    g = np.array(cell).reshape(8, 1)
    assert sum(1 << c for c in range(8) if cell[c] >= 0) == signs
    assert int(trilinear_cubes.decisions(g)[0]) == bits, "oracle and reference disagree"
    whole = [round(value * 1024) for value in cell]
    assert [value / 1024 for value in whole] == cell
    return whole


# --- cycles -------------------------------------------------------------------------------------


def cycle_classes() -> list[JSON]:
    """The oriented polygons that occur, by length, one of each class under the rotations."""
    found: dict[tuple[int, ...], list[tuple[int, int]]] = defaultdict(list)
    for signs, separated in decided(6):
        for polygon in cycles(signs, separated):
            found[polygon].append((signs, separated))
    classes: dict[tuple[int, ...], list[tuple[int, ...]]] = defaultdict(list)
    for polygon in found:
        classes[min(turned(polygon, move) for move in ROTATIONS)].append(polygon)
    rows = []
    for members in classes.values():
        polygon = min(members)
        rows.append(
            {
                "polygon": word(polygon),
                "members": len(members),
                "cells": sum(len(found[one]) for one in members),
                "example": key(*found[polygon][0]),
            }
        )
    return sorted(rows, key=lambda row: (len(row["polygon"]), row["polygon"]))


def turned(polygon: tuple[int, ...], move: tuple[int, ...]) -> tuple[int, ...]:
    """The polygon after a rotation of the cube, begun at its least edge."""
    edges = [EDGE_OF[frozenset(move[c] for c in EDGES[e])] for e in polygon]
    start = edges.index(min(edges))
    return tuple(edges[start:] + edges[:start])


# --- squares, and simplices of four dimensions --------------------------------------------------


def squares() -> list[list[list[int]]]:
    """For each of 16 signs and separated or joined, at 2 signs + joined: segments of edges.

    Corner c of the square stands at (c & 1, c >> 1); edge e is 2 axis + the other coordinate.
    """
    rows = []
    for signs in range(16):
        for mode in ("disconnect", "connect"):
            high = [[signs >> (i | j << 1) & 1 for j in (0, 1)] for i in (0, 1)]
            values = 2.0 * np.array(high) - 1
            mesh = diconex(values, 0.0, mode=mode, displaced=False).mesh
            edges = [int(2 * (x != 0.5) + (y if x == 0.5 else x)) for x, y in mesh.vertices]
            rows.append([[edges[a], edges[b]] for a, b in mesh.simplices.tolist()])
    return rows


def section_rows(code: int) -> list[list[list[int]]]:
    """Tetrahedra of the section of a 4-simplex by signs, each four pairs of its vertices."""
    low = [v for v in range(5) if not code >> v & 1]
    high = [v for v in range(5) if code >> v & 1]
    if not low or not high:
        return []
    rows = simplex_section.staircase(len(low), len(high)).tolist()
    return [[[low[i], high[j]] for i, j in row] for row in rows]


if __name__ == "__main__":
    place = Path(sys.argv[1])
    place.write_text(json.dumps(tables(), separators=(",", ":")), encoding="utf-8")
