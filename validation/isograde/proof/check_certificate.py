#!/usr/bin/env python3
"""Checks the certificate of a cube rule from the definitions alone.

    python check_certificate.py CERTIFICATE.json ...

This program imports nothing but Python's own library. It shares no line with the prover that wrote
the certificate, and works differently: with points and sums of oriented edges instead of names of
nodes and sets of segments. Exit status: 0 every certificate is right, 1 one is wrong, 2 one cannot
be read.

The lattice
-----------
A cell is the cube of the points with coordinates 0, 1, 2 on each axis. Corners have coordinates 0
and 2 alone; the node of a lattice edge is its middle, with one coordinate 1; interior points are
(1, 1, 1, k). A face is where one coordinate is 0 or 2.

What is checked
---------------
A  The cases are all there are, each once: 256 signs, and where the rule is asked, every choice of
   bits for ambiguous faces and for the cell itself.
B  Triangles have three different nodes, the nodes of crossed edges and the interior points, each of
   them used.
C  No directed edge occurs twice in a tile. Its *border*, the edges whose reverse does not occur,
   lies on faces; on each face the inside is on its right, seen from outside.
D  On a face, all cells that can stand on one side have one border, and all that can stand on the
   other side have its reverse. A cell that does not decide its face can stand at a face decided 0
   and at one decided 1, if anybody decides there.
E  No undirected edge that lies on a face and has two triangles in a cell on one side has two in a
   cell on the other.
F  The triangles round a node, each seen as a step from one of its other nodes to the next, are one
   closed walk round an interior point; round the node of an edge one open walk that starts on one
   of the two faces there and ends on the other.

Why that is enough stands in `isograde.proof` and is proved in `validation/proofs`: any lattice of
such cells, whatever the samples, makes a mesh in which every directed edge occurs once and, off
the border of the lattice, its reverse too; and the triangles at each vertex are one fan.
"""

import json
import sys
from collections.abc import Iterable, Iterator
from itertools import product
from typing import Any

FORMAT = "isograde certificate 1"
AXES = (0, 1, 2)
Point = tuple[int, ...]
Edge = tuple[Point, Point]
Face = tuple[int, int]


class WrongError(Exception):
    """The certificate does not show what it claims."""


def require(condition: bool, *words: object) -> None:
    """Nothing, where the condition holds; else raise `WrongError`."""
    if not condition:
        raise WrongError(" ".join(map(str, words)))


# --- the cube --------------------------------------------------------------


def middle(number: int) -> Point:
    """The point of a node on a lattice edge."""
    along, k = divmod(number, 4)
    point = [2 * (k & 1), 2 * (k >> 1)]
    point.insert(along, 1)
    return tuple(point)


def ends(point: Point) -> list[Point]:
    """The two corners of the lattice edge with this middle."""
    return [tuple(end if x == 1 else x for x in point) for end in (0, 2)]


MIDDLES = [middle(number) for number in range(12)]
FACES = [(axis, side) for axis in AXES for side in (0, 2)]  # face 2 axis + side / 2
CORNERS_OF = {face: [c for c in range(8) if 2 * (c >> face[0] & 1) == face[1]] for face in FACES}


def inside(signs: int, point: Point) -> bool:
    """Whether the corner at this point is inside."""
    return signs >> (point[0] + 2 * point[1] + 4 * point[2]) // 2 & 1 == 1


def is_ambiguous(signs: int, face: Face) -> bool:
    """Whether the corners of the face change their side all the way round."""
    a, b, c, d = (signs >> number & 1 for number in CORNERS_OF[face])
    return a == d and b == c and a != b


def crossed(signs: int) -> set[Point]:
    """The middles of the lattice edges whose ends are on different sides."""
    return {p for p in MIDDLES if inside(signs, ends(p)[0]) != inside(signs, ends(p)[1])}


def face_of(edge: Edge) -> Face | None:
    """The face that holds both ends of an edge, or None."""
    p, q = edge
    if len(p) == len(q) == 3:
        for face in FACES:
            if p[face[0]] == q[face[0]] == face[1]:
                return face
    return None


def has_inside_on_the_right(signs: int, edge: Edge) -> bool:
    """Whether an edge lies on a face and runs rightly, for someone who looks from outside."""
    face = face_of(edge)
    if face is None:
        return False
    p, q = edge
    ahead = [y - x for x, y in zip(p, q, strict=True)]
    (inner,) = [end for end in ends(p) if inside(signs, end)]
    aside = [y - x for x, y in zip(p, inner, strict=True)]
    outward = [0, 0, 0]
    outward[face[0]] = face[1] - 1
    # The inside is on the right where (ahead, aside, outward) is a left-handed frame.
    (a, b, c), (d, e, f), (g, h, i) = ahead, aside, outward
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0


# --- A: the cases ----------------------------------------------------------


def read(content: Any) -> "tuple[int, set[int], dict[tuple[int, int], Tile]]":
    """bits, asked and tiles of a certificate of the right form."""
    require(isinstance(content, dict) and content.get("format") == FORMAT, "no", FORMAT)
    bits, asked, tiles = (content.get(key) for key in ("bits", "asked", "tiles"))
    require(is_number(bits, 13), "bits are", bits)
    require(isinstance(asked, list) and all(is_number(s, 256) for s in asked), "asked:", asked)
    require(len(set(asked)) == len(asked), "signs are listed twice as asked")
    require(isinstance(tiles, list), "there are no tiles")
    found: dict[tuple[int, int], Tile] = {}
    for tile in tiles:
        require(isinstance(tile, list) and len(tile) == 4, "not a tile:", tile)
        signs, decision, interior, triangles = tile
        require(is_number(signs, 256) and is_number(decision, 1 << bits), "not a case:", tile)
        require(is_number(interior, 1 << 16) and isinstance(triangles, list), "no tile:", tile)
        require((signs, decision) not in found, "case", signs, decision, "is there twice")
        found[signs, decision] = Tile(signs, decision, interior, triangles)
    return bits, set(asked), found


def is_number(x: object, end: int) -> bool:
    """Whether x is a whole number from 0 to end - 1."""
    return type(x) is int and 0 <= x < end


def cases(bits: int, asked: set[int]) -> Iterator[tuple[int, int]]:
    """Every case: signs and decision."""
    for signs in range(256):
        choices = [
            (0, 1) if signs in asked and (f >= 6 or is_ambiguous(signs, FACES[f])) else (0,)
            for f in range(bits)
        ]
        for chosen in product(*choices):
            yield signs, sum(bit << f for f, bit in enumerate(chosen))


# --- B, C, F: one tile -----------------------------------------------------


class Tile:
    """The triangles of a case on points, their edges, and the border."""

    def __init__(self, signs: int, decision: int, interior: int, triangles: list[Any]):
        self.signs, self.decision, self.interior = signs, decision, interior
        self.name = f"tile {signs} {decision}:"
        for t in triangles:
            right = isinstance(t, list) and all(is_number(n, 12 + interior) for n in t)
            require(right and len(t) == len(set(t)) == 3, self.name, "no triangle:", t)
        self.triangles = [tuple(self.point(n) for n in t) for t in triangles]
        directed = [(t[i], t[(i + 1) % 3]) for t in self.triangles for i in AXES]
        self.edges = set(directed)
        require(len(self.edges) == len(directed), self.name, "a directed edge occurs twice")
        self.border = {(p, q) for p, q in self.edges if (q, p) not in self.edges}

    def point(self, node: int) -> Point:
        """The point of a node."""
        return MIDDLES[node] if node < 12 else (1, 1, 1, node - 12)

    def check(self) -> None:
        """Raise `WrongError` where B, C or F is broken."""
        used = {point for triangle in self.triangles for point in triangle}
        there = crossed(self.signs) | {(1, 1, 1, k) for k in range(self.interior)}
        require(used == there, self.name, "nodes are not those of crossed edges and interior")
        for edge in self.border:
            right = has_inside_on_the_right(self.signs, edge)
            require(right, self.name, "not on a face with the inside on the right:", edge)
        for point in used:
            self.check_fan(point)

    def check_fan(self, point: Point) -> None:
        """Raise `WrongError` where the triangles round a node are not one walk."""
        step: dict[Point, Point] = {}
        for a, b, c in self.triangles:
            for first, second, third in ((a, b, c), (b, c, a), (c, a, b)):
                if first == point:
                    step[second] = third
        starts = set(step) - set(step.values())
        is_open = len(point) == 3
        require(len(starts) == is_open, self.name, "the walk round", point, "has no one start")
        here = start = starts.pop() if is_open else next(iter(step))
        length = 0
        while here in step and (length == 0 or here != start):
            here, length = step[here], length + 1
        require(length == len(step), self.name, "more than one walk round", point)
        if is_open:
            found = [face_of((point, start)), face_of((point, here))]
            wanted = [(axis, point[axis]) for axis in AXES if point[axis] != 1]
            leads = found in (wanted, wanted[::-1])
            require(leads, self.name, "the walk round", point, "does not lead from face to face")


# --- D, E: two tiles at a face ---------------------------------------------


def on_face(edges: Iterable[Edge], face: Face) -> frozenset[Edge]:
    """The edges on a face, as seen without the coordinate across it."""
    axis = face[0]
    here = [(p, q) for p, q in edges if face_of((p, q)) == face]
    return frozenset((p[:axis] + p[axis + 1 :], q[:axis] + q[axis + 1 :]) for p, q in here)


def reverse(edges: frozenset[Edge]) -> frozenset[Edge]:
    """The edges, each the other way."""
    return frozenset((q, p) for p, q in edges)


def check_faces(bits: int, asked: set[int], tiles: Iterable[Tile]) -> None:
    """Raise `WrongError` where D or E is broken."""
    standing = []  # (kind of face without its decision, bit or None, side, tile, border, doubled)
    for tile in tiles:
        for number, face in enumerate(FACES):
            signs = tuple(tile.signs >> c & 1 for c in CORNERS_OF[face])
            decides = tile.signs in asked and number < bits
            bit = tile.decision >> number & 1 if decides else None
            border = on_face(tile.border, face)
            doubled = on_face(tile.edges - tile.border, face)
            standing.append(((face[0], signs), bit, face[1], tile, border, doubled))
    decided = {(kind, bit) for kind, bit, *_ in standing if bit is not None}
    drawn: dict[Any, tuple[Tile, frozenset[Edge]]] = {}
    doubles: dict[Any, dict[int, set[Edge]]] = {}
    for kind, bit, side, tile, border, doubled in standing:
        for value in (0, 1):
            if bit == value or (bit is None and (value == 0 or (kind, 1) in decided)):
                low = border if side == 2 else reverse(border)
                first, expected = drawn.setdefault((kind, value), (tile, low))
                where = f"at a face {kind} decided {value}"
                require(low == expected, first.name, "and", tile.name, "differ", where)
                doubles.setdefault((kind, value), {0: set(), 2: set()})[side].update(doubled)
    for (kind, value), both in doubles.items():
        shared = both[0] & both[2]
        require(not shared, "edges of four triangles at a face", kind, value, sorted(shared)[:1])


# --- the whole -------------------------------------------------------------


def check(content: object) -> int:
    """How many tiles the certificate has; raises `WrongError` where it does not hold."""
    bits, asked, tiles = read(content)
    wanted = set(cases(bits, asked))
    missing = wanted - set(tiles)
    require(not missing, "cases without a tile:", len(missing), "of", len(wanted))
    require(set(tiles) <= wanted, "tiles of cases that do not exist")
    for tile in tiles.values():
        tile.check()
    check_faces(bits, asked, tiles.values())
    return len(tiles)


def main(paths: list[str]) -> int:
    """Check the files, say what was found, and return the exit status."""
    if not paths or paths[0].startswith("-"):
        print(__doc__)
        return 0 if paths and paths[0] in ("-h", "--help") else 2
    status = 0
    for path in paths:
        try:
            with open(path, encoding="utf-8") as file:
                content = json.load(file)
            print(f"{path}: right, {check(content)} tiles")
        except WrongError as fault:
            status = max(status, 1)
            print(f"{path}: wrong: {fault}")
        except (OSError, ValueError) as error:
            status = 2
            print(f"{path}: cannot be read: {error}")
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
