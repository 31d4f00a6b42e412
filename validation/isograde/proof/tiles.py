"""The tiles of a rule, enumerated, and what must hold in each by itself.

Conditions 1, 2 and 5 of the argument (`isograde.proof`).

Positions, not numbers
----------------------
Nodes are told apart by where they are, in half steps of the cell: a node on a lattice edge has one
coordinate 1 and two that are 0 or 2. Only `node_place` and `corner_place` know how a rule numbers
them; two nodes lie on one face when they agree in a coordinate that is 0 or 2. Interior points keep
their numbers.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import product

from isoref.rule import Rule, Tile

Place = tuple[int, ...]
Node = Place | int
Edge = tuple[Node, Node]
Face = tuple[int, int]

FACES: tuple[Face, ...] = tuple((axis, side) for axis in range(3) for side in (0, 2))


def corner_place(c: int) -> Place:
    """Where a rule's corner c stands.

    >>> corner_place(6)
    (0, 2, 2)
    """
    return 2 * (c & 1), 2 * (c >> 1 & 1), 2 * (c >> 2 & 1)


def node_place(e: int) -> Place:
    """Where a rule's node e on a lattice edge stands.

    >>> node_place(0), node_place(11)
    ((1, 0, 0), (2, 2, 1))
    """
    axis, k = divmod(e, 4)
    place = [0, 0, 0]
    first, second = (a for a in range(3) if a != axis)
    place[axis], place[first], place[second] = 1, 2 * (k & 1), 2 * (k >> 1)
    return tuple(place)


@dataclass(frozen=True)
class Case:
    """What a rule is asked for: signs, and a decision; `asked` where it decides at all."""

    signs: int
    decision: int = 0
    asked: bool = False

    def inside(self, corner: Place) -> bool:
        """The corner at this place is inside."""
        return bool(self.signs >> (corner[0] // 2 + corner[1] + 2 * corner[2]) & 1)

    def __str__(self) -> str:
        return f"{self.signs:08b}" + (f" decided {self.decision:b}" if self.decision else "")


@dataclass(frozen=True)
class Cell:
    """One tile of a rule, its triangles on places (and numbers, for interior points)."""

    case: Case
    triangles: tuple[tuple[Node, Node, Node], ...]

    def __str__(self) -> str:
        return str(self.case)


# ------------------------------------------------------------------------------------------------
# All cases
# ------------------------------------------------------------------------------------------------


def cases(rule: Rule) -> Iterator[Case]:
    """All signs, and where the rule is asked all decisions on ambiguous faces and inside."""
    for signs in range(256):
        if not rule.asks(signs):
            yield Case(signs)
            continue
        free = [f for f in range(rule.bits) if f >= 6 or is_ambiguous(Case(signs), rule_face(f))]
        for bits in product((0, 1), repeat=len(free)):
            yield Case(signs, sum(bit << f for bit, f in zip(bits, free, strict=True)), True)


def cell_of(case: Case, tile: Tile) -> Cell:
    """The tile of a case, on places."""
    return Cell(case, tuple((_node(a), _node(b), _node(c)) for a, b, c in tile.triangles))


def rule_face(f: int) -> Face:
    """The axis and side of a rule's face f = 2 axis + side."""
    return f // 2, 2 * (f % 2)


def _node(n: int) -> Node:
    """The place of a node on a lattice edge; an interior point keeps its number."""
    return node_place(n) if n < 12 else n


def corners_of(face: Face) -> list[Place]:
    """The places of a face's corners, in the order of the face's own coordinates."""
    return [_at(face, p) for p in product((0, 2), repeat=2)]


def _at(face: Face, flat: Iterable[int]) -> Place:
    """The place in the cell of a place in the face's own coordinates."""
    axis, side = face
    a, b = flat
    place = [a, b]
    place.insert(axis, side)
    return tuple(place)


def flat(face: Face, place: Place) -> Place:
    """The coordinates in the face of a place on it."""
    return tuple(x for axis, x in enumerate(place) if axis != face[0])


def is_ambiguous(case: Case, face: Face) -> bool:
    """Opposite corners of the face are on one side, neighbours on different ones."""
    a, b, c, d = (case.inside(corner) for corner in corners_of(face))
    return a == d != b == c


@cache
def common_face(p: Node, q: Node) -> Face | None:
    """The face that both nodes lie on, if there is one; two nodes have one at most."""
    if isinstance(p, int) or isinstance(q, int):
        return None
    shared = [(axis, x) for axis, (x, y) in enumerate(zip(p, q, strict=True)) if x == y != 1]
    return shared[0] if shared else None


# ------------------------------------------------------------------------------------------------
# Conditions 1, 2 and 5: one tile by itself
# ------------------------------------------------------------------------------------------------


def faults_in(cell: Cell) -> Iterator[tuple[int, str]]:
    """What is wrong in a tile: which condition it breaks, and how, in words."""
    used = {node for triangle in cell.triangles for node in triangle}
    crossed = {p for p in map(node_place, range(12)) if _is_crossed(cell, p)}
    if {node for node in used if not isinstance(node, int)} != crossed:
        yield 1, f"cell {cell}: nodes are not on the crossed lattice edges, one on each"
    if any(len(set(triangle)) < 3 for triangle in cell.triangles):
        yield 1, f"cell {cell}: a triangle names a node twice"
        return
    repeated = [edge for edge, n in Counter(directed(cell)).items() if n > 1]
    if repeated:
        yield 1, f"cell {cell}: the edge {in_words(repeated[0])} occurs twice in one direction"
        return
    for segment in segments(cell):
        yield from ((2, fault) for fault in _faults_of_segment(cell, segment))
    for node in sorted(used, key=str):
        if not turns_once(cell, node):
            yield 5, f"cell {cell}: the triangles round {node} are not one fan"


def directed(cell: Cell) -> list[Edge]:
    """The directed edges of the tile's triangles."""
    return [edge for a, b, c in cell.triangles for edge in ((a, b), (b, c), (c, a))]


def segments(cell: Cell) -> list[Edge]:
    """The directed edges that no triangle of the tile runs along the other way."""
    edges = directed(cell)
    known = set(edges)
    return [(p, q) for p, q in edges if (q, p) not in known]


def _is_crossed(cell: Cell, node: Place) -> bool:
    """The ends of the node's lattice edge are on different sides."""
    low, high = (tuple(end if x == 1 else x for x in node) for end in (0, 2))
    return cell.case.inside(low) != cell.case.inside(high)


def _faults_of_segment(cell: Cell, segment: Edge) -> Iterator[str]:
    """Nothing, where the segment lies on a face with the inside on its right."""
    p, q = segment
    face = common_face(p, q)
    if face is None or isinstance(p, int) or isinstance(q, int):
        yield f"cell {cell}: the boundary edge {in_words(segment)} lies on no face"
        return
    axis, side = face
    low, high = (tuple(end if x == 1 else x for x in p) for end in (0, 2))
    inner = low if cell.case.inside(low) else high
    ahead, aside = _minus(q, p), _minus(inner, p)
    # The component of their cross product along the axis, which points outwards on the high side.
    b, c = (axis + 1) % 3, (axis + 2) % 3
    if (ahead[b] * aside[c] - ahead[c] * aside[b]) * (side - 1) >= 0:
        yield f"cell {cell}: the segment {in_words(segment)} has the inside on its left"


def _minus(p: Place, q: Place) -> Place:
    """The vector from q to p."""
    return tuple(a - b for a, b in zip(p, q, strict=True))


def turns_once(cell: Cell, node: Node) -> bool:
    """The tile's triangles round the node are one fan, ending on both faces at its lattice edge.

    Round an interior point they must be a full turn.
    """
    after: dict[Node, Node] = {}
    for triangle in cell.triangles:
        if node in triangle:
            n = triangle.index(node)
            after[triangle[(n + 1) % 3]] = triangle[(n + 2) % 3]
    starts = set(after) - set(after.values())
    if isinstance(node, int):
        return not starts and _length(after, next(iter(after))) == len(after)
    if len(starts) != 1:
        return False
    start = starts.pop()
    if _length(after, start) != len(after):
        return False
    end = (set(after.values()) - set(after)).pop()
    faces = {common_face(node, start), common_face(node, end)}
    return faces == {(axis, x) for axis, x in enumerate(node) if x != 1}


def _length(after: dict[Node, Node], start: Node) -> int:
    """How many steps lead on from the start before they end or come back."""
    steps, at = 0, start
    while at in after:
        at, steps = after[at], steps + 1
        if at == start:
            break
    return steps


def in_words(edge: Edge) -> str:
    """An edge as its two ends."""
    return f"{edge[0]}-{edge[1]}"
