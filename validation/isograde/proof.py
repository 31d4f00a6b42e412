"""A proof by enumeration that a cube rule is closed, oriented and manifold on every field.

The argument
------------
A cube rule puts into each cell a *tile*: triangles on nodes, which depend on nothing but the signs
of the cell's corners and the rule's decisions. Two cells know of each other only through what they
share: nodes on lattice edges, and faces. So "closed, oriented and manifold on every field" is a
statement about finitely many tiles and about pairs of tiles that can meet at a face. It holds when

1. *In a tile* every crossed lattice edge has its node and no other edge has one, no triangle names
   a node twice, and no directed edge occurs twice. An edge of the tile then belongs to two
   triangles that run along it in opposite directions, or to one; call the latter a segment.
2. *Segments* lie on the faces of the cell, with the inside on their right seen from outside the
   cell.
3. *At a face* both cells have the same segments, in opposite directions. For this the segments
   must depend on nothing but what the two cells share: the signs of the face's corners and the
   decision on the face.
4. *No chord* of one cell, an edge between two of its triangles whose ends lie on one face, is also
   a chord of a cell on the other side.
5. *Round each node* the tile's triangles are one fan: a full turn about an interior point; a
   path about a node on a lattice edge, from one of the two faces at that edge to the other.

Take any edge of the mesh. If both its ends lie on one face, it is a segment of both cells there,
used once by each, in opposite directions (3), or a chord of one of them alone, used twice (4). If
not, one cell contains it and uses it twice (1). On the border of the volume there is one cell and
the segment is the boundary. So every edge off the border has exactly two triangles, in opposite
directions: the mesh is closed, edge-manifold and oriented. Four cells stand round a lattice edge,
each shares a face at that edge with the next, and their paths about its node (5) meet in the
segments on these faces: together they are one full turn. So the mesh is vertex-manifold too. By
(2) the normals point from inside to outside. Nothing was said of the field but its signs and
decisions, and all of these are enumerated.

One thing is not enumerable: that both cells at a face come to the same decision on it, and that no
other decisions occur than those enumerated. A decision is arithmetic on values. `prove` tries it on
random pairs of cells that share a face, ties and exactly degenerate saddles among them, and says on
how many.

What is not claimed: that triangles do not cut each other in space.

Positions, not numbers
----------------------
Nodes are told apart by where they are, in half steps of the cell: a node on a lattice edge has one
coordinate 1 and two that are 0 or 2. Only `node_place` and `corner_place` know how a rule numbers
them; two nodes lie on one face when they agree in a coordinate that is 0 or 2.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np
from isoref.field import Floats
from isoref.rule import Rule

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
class Cell:
    """One tile of a rule, its triangles on places (and numbers, for interior points)."""

    signs: int
    decision: int
    triangles: tuple[tuple[Node, Node, Node], ...]

    def inside(self, corner: Place) -> bool:
        """The corner at this place is inside."""
        return bool(self.signs >> (corner[0] // 2 + corner[1] + 2 * corner[2]) & 1)

    def __str__(self) -> str:
        return f"{self.signs:08b}" + (f" decided {self.decision:b}" if self.decision else "")


@dataclass(frozen=True)
class Side:
    """What a cell does on one of its faces, in coordinates of the face."""

    cell: Cell
    segments: frozenset[tuple[Place, Place]]
    chords: frozenset[frozenset[Place]]


@dataclass(frozen=True)
class Tear:
    """Two cells that can meet at a face and do not agree there."""

    axis: int
    low: Side
    high: Side

    def __str__(self) -> str:
        return (
            f"axis {self.axis}: {self.low.cell} below draws {_drawn(self.low.segments)}, "
            f"{self.high.cell} above draws {_drawn(self.high.segments)}"
        )


@dataclass(frozen=True)
class Proof:
    """What the enumeration found; the rule is proved where nothing is wrong.

    rule : its name
    tiles : how many were enumerated
    meetings : how many kinds of face two cells can meet at (axis, signs, decision)
    tears : pairs of cells that break statement 3
    faults : everything else that is wrong, in words
    tried : random pairs of cells on which both decisions were compared, 0 where nothing is decided
    """

    rule: str
    tiles: int
    meetings: int
    tears: tuple[Tear, ...]
    faults: tuple[str, ...]
    tried: int

    @property
    def holds(self) -> bool:
        """The rule is closed, oriented and manifold on every field."""
        return not self.tears and not self.faults

    def text(self, shown: int = 8) -> str:
        """The result in words, with the first few of what is wrong."""
        compared = f"compared on {self.tried} pairs of cells" if self.tried else "none to compare"
        enumerated = (
            f"{self.rule}: {self.tiles} tiles, {self.meetings} kinds of face at which cells meet; "
            f"decisions: {compared}."
        )
        if self.holds:
            return f"{enumerated}\nClosed, oriented and manifold on every field."
        lines = [enumerated, "Not proved."]
        if self.tears:
            lines.append(
                f"{len(self.tears)} pairs of cells tear at the face they share (a cell is its "
                "eight signs, corner 7 first; places on the face in half steps):"
            )
            lines += [f"  {tear}" for tear in self.tears[:shown]]
        lines += [f"  {fault}" for fault in self.faults[:shown]]
        hidden = max(len(self.tears) - shown, 0) + max(len(self.faults) - shown, 0)
        return "\n".join([*lines, f"  and {hidden} more"] if hidden else lines)


def prove(rule: Rule, pairs: int = 20_000) -> Proof:
    """The five statements, checked on every tile and on every pair of tiles that can meet."""
    cells = list(enumerated(rule))
    faults = [fault for cell in cells for fault in faults_in(cell)]
    meetings = meetings_of(rule, cells)
    tears = [tear for key, sides in meetings.items() for tear in tears_at(key[0], *sides)]
    faults += [fault for key, sides in meetings.items() for fault in shared_chords(key, *sides)]
    faults += undecided(rule, pairs)
    tried = pairs if rule.bits else 0
    return Proof(rule.name, len(cells), len(meetings), tuple(tears), tuple(faults), tried)


# ------------------------------------------------------------------------------------------------
# The tiles
# ------------------------------------------------------------------------------------------------


def enumerated(rule: Rule) -> Iterator[Cell]:
    """Every tile of the rule: all signs, and all decisions on ambiguous faces and inside."""
    for signs in range(256):
        cell = Cell(signs, 0, ())
        free = [f for f in range(rule.bits) if f >= 6 or is_ambiguous(cell, rule_face(f))]
        choices = product((0, 1), repeat=len(free)) if rule.asks(signs) else [()]
        for bits in choices:
            decision = sum(bit << f for bit, f in zip(bits, free, strict=False))
            triangles = tuple(
                (_node(a), _node(b), _node(c)) for a, b, c in rule.tile(signs, decision).triangles
            )
            yield Cell(signs, decision, triangles)


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


def _flat(face: Face, place: Place) -> Place:
    """The coordinates in the face of a place on it."""
    return tuple(x for axis, x in enumerate(place) if axis != face[0])


def is_ambiguous(cell: Cell, face: Face) -> bool:
    """Opposite corners of the face are on one side, neighbours on different ones."""
    a, b, c, d = (cell.inside(corner) for corner in corners_of(face))
    return a == d != b == c


@cache
def common_face(p: Node, q: Node) -> Face | None:
    """The face that both nodes lie on, if there is one; two nodes have one at most."""
    if isinstance(p, int) or isinstance(q, int):
        return None
    shared = [(axis, x) for axis, (x, y) in enumerate(zip(p, q, strict=True)) if x == y != 1]
    return shared[0] if shared else None


# ------------------------------------------------------------------------------------------------
# Statements 1, 2 and 5: one tile by itself
# ------------------------------------------------------------------------------------------------


def faults_in(cell: Cell) -> Iterator[str]:
    """What is wrong in a tile, in words."""
    used = {node for triangle in cell.triangles for node in triangle}
    crossed = {p for p in map(node_place, range(12)) if _is_crossed(cell, p)}
    if {node for node in used if not isinstance(node, int)} != crossed:
        yield f"cell {cell}: nodes are not on the crossed lattice edges, one on each"
    if any(len(set(triangle)) < 3 for triangle in cell.triangles):
        yield f"cell {cell}: a triangle names a node twice"
    repeated = [edge for edge, n in Counter(directed(cell)).items() if n > 1]
    if repeated:
        yield f"cell {cell}: the edge {_edge(repeated[0])} occurs twice in one direction"
        return
    for segment in segments(cell):
        yield from _faults_of_segment(cell, segment)
    for node in sorted(used, key=str):
        if not turns_once(cell, node):
            yield f"cell {cell}: the triangles round {node} are not one fan"


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
    return cell.inside(low) != cell.inside(high)


def _faults_of_segment(cell: Cell, segment: Edge) -> Iterator[str]:
    """Nothing, where the segment lies on a face with the inside on its right."""
    p, q = segment
    face = common_face(p, q)
    if face is None or isinstance(p, int) or isinstance(q, int):
        yield f"cell {cell}: the boundary edge {_edge(segment)} lies on no face"
        return
    axis, side = face
    low, high = (tuple(end if x == 1 else x for x in p) for end in (0, 2))
    inner = low if cell.inside(low) else high
    ahead, aside = _minus(q, p), _minus(inner, p)
    # The component of their cross product along the axis, which points outwards on the high side.
    b, c = (axis + 1) % 3, (axis + 2) % 3
    if (ahead[b] * aside[c] - ahead[c] * aside[b]) * (side - 1) >= 0:
        yield f"cell {cell}: the segment {_edge(segment)} has the inside on its left"


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


# ------------------------------------------------------------------------------------------------
# Statements 3 and 4: two tiles at a face
# ------------------------------------------------------------------------------------------------

Key = tuple[int, tuple[bool, ...], int]
Sides = tuple[set[Side], set[Side]]


def meetings_of(rule: Rule, cells: Iterable[Cell]) -> dict[Key, Sides]:
    """For each axis, signs and decision of a face, the cells below it and the cells above it."""
    found: dict[Key, Sides] = defaultdict(lambda: (set(), set()))
    for cell in cells:
        chords = _chords(cell)
        edges = segments(cell)
        for f, face in enumerate(FACES):
            axis, side = face
            signs = tuple(cell.inside(corner) for corner in corners_of(face))
            decision = cell.decision >> f & 1 if f < rule.bits else 0
            # The upper face of a cell is where it is the cell below.
            below = 0 if side == 2 else 1
            found[axis, signs, decision][below].add(_side(cell, face, edges, chords))
    return dict(found)


def _chords(cell: Cell) -> set[Edge]:
    """The edges between two of the tile's triangles."""
    edges = directed(cell)
    known = set(edges)
    return {(p, q) for p, q in edges if (q, p) in known}


def _side(cell: Cell, face: Face, edges: list[Edge], chords: set[Edge]) -> Side:
    """The segments and chords of a cell that lie on this face."""

    def here(group: Iterable[Edge]) -> list[tuple[Place, Place]]:
        return [
            (_flat(face, p), _flat(face, q))
            for p, q in group
            if not isinstance(p, int) and not isinstance(q, int)
            if p != q and common_face(p, q) == face
        ]

    return Side(cell, frozenset(here(edges)), frozenset(frozenset(edge) for edge in here(chords)))


def tears_at(axis: int, below: set[Side], above: set[Side]) -> Iterator[Tear]:
    """The pairs whose segments are not the same in opposite directions."""
    ordered = sorted(above, key=_by_cell)
    for low in sorted(below, key=_by_cell):
        turned = frozenset((q, p) for p, q in low.segments)
        for high in ordered:
            if high.segments != turned:
                yield Tear(axis, low, high)


def _by_cell(side: Side) -> tuple[int, int]:
    """A side's cell, to sort by."""
    return side.cell.signs, side.cell.decision


def shared_chords(key: Key, below: set[Side], above: set[Side]) -> Iterator[str]:
    """The chords that a cell below and a cell above can both have."""
    low = {chord: side for side in below for chord in side.chords}
    high = {chord: side for side in above for chord in side.chords}
    for chord in low.keys() & high.keys():
        p, q = sorted(chord)
        yield (
            f"axis {key[0]}: cells {low[chord].cell} and {high[chord].cell} both have the chord "
            f"{p}-{q} on the face they share: four triangles meet there"
        )


# ------------------------------------------------------------------------------------------------
# The decisions
# ------------------------------------------------------------------------------------------------


def undecided(rule: Rule, pairs: int) -> Iterator[str]:
    """Random pairs of cells that share a face and decide it differently, in words."""
    if not rule.bits:
        return
    rng = np.random.default_rng(1991)
    for axis in range(3):
        low = _values(rng, pairs // 3)
        high = _values(rng, pairs // 3)
        above = [c for c in range(8) if corner_place(c)[axis] == 2]
        below = [c for c in range(8) if corner_place(c)[axis] == 0]
        high[below] = low[above]
        a, b, c, d = (low[n] >= 0 for n in above)
        ambiguous = (a == d) & (b == c) & (a != b)
        mine = rule.decisions(low) >> (2 * axis + 1) & 1
        theirs = rule.decisions(high) >> (2 * axis) & 1
        if (~ambiguous & ((mine | theirs) != 0)).any():
            yield f"axis {axis}: a face that is not ambiguous is decided"
        differ = np.flatnonzero(ambiguous & (mine != theirs))
        if len(differ):
            values = low[above, differ[0]].tolist()
            yield f"axis {axis}: two cells decide the face with values {values} differently"


def _values(rng: np.random.Generator, n: int) -> Floats:
    """(8, n) corner values: reals, and small integers with many ties and degenerate saddles."""
    values = rng.normal(size=(8, n))
    values[:, ::2] = rng.integers(-2, 3, size=(8, (n + 1) // 2))
    return values


def _drawn(segments: frozenset[tuple[Place, Place]]) -> str:
    """Segments in the face's half steps."""
    return " and ".join(f"{p}-{q}" for p, q in sorted(segments)) or "nothing"


def _edge(edge: Edge) -> str:
    """An edge as its two ends."""
    return f"{edge[0]}-{edge[1]}"


def tears_by_face(proof: Proof) -> dict[tuple[int, tuple[bool, ...]], int]:
    """How many pairs of cells tear, by axis and signs of the face they share."""
    counts: Counter[tuple[int, tuple[bool, ...]]] = Counter()
    for tear in proof.tears:
        cell = tear.low.cell
        counts[tear.axis, tuple(cell.inside(c) for c in corners_of((tear.axis, 2)))] += 1
    return dict(counts)
