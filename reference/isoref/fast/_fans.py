r"""What is known of a rule: its tiles, cut into fans, so that many cells can be drawn at once.

Tiles differ from cell to cell, but nearly all of their triangles lie in *fans*, side by side round
a common node, the *hub*::

          r1 ---- r2              a fan of three triangles and its five nodes: the hub h, and
         /  \    /  \              r0 .. r3 round it. Three triangles have nine corners, and five
       r0 --- h ---- r3           look-ups find them all

Fans of as many triangles with the hub in the same corner are of one *kind*. All fans of a kind are
drawn together, whatever their tiles: one look-up a node for all of them, and one write a corner.

Glossary
--------
key         of a cell: signs + 256 * decisions; it names a tile
kind        2 * (3 * triangles + the hub's corner) + 1 where the tile has interior points, else + 0
column      of a kind: the nodes of one fan, the hub first

Invariants
----------
The number of a kind is the same whatever tiles are known, and so is the order of the triangles of a
mesh, which come kind by kind.
"""

from __future__ import annotations

import threading
from dataclasses import dataclass
from functools import cache, lru_cache

import numpy as np
from numpy.typing import NDArray

from isoref.cube import CORNER_OFFSETS, EDGE_CORNERS
from isoref.cycles import Triangle
from isoref.fast._bits import Bytes, Lattice, take
from isoref.field import Array, Floats, Integers
from isoref.rule import Average, Rule, Tile

Fan = tuple[int, int, list[int]]

#: A fan has at most so many triangles; more of them are cut into two.
LONGEST = 12


@cache
def fans(triangles: tuple[Triangle, ...]) -> list[Fan]:
    """The triangles cut into fans: of each the number of triangles, the hub's corner, its nodes.

    The longest fan first, and so on with what is left.

    >>> fans(((0, 4, 8), (4, 9, 8), (9, 5, 8), (1, 2, 3)))
    [(3, 2, [8, 0, 4, 9, 5]), (1, 2, [3, 1, 2])]
    """
    left, found = list(triangles), list[Fan]()
    while left:
        corner, fan = _longest(left)
        ring = [triangle[corner - 2] for triangle in fan]
        found.append((len(fan), corner, [fan[0][corner], *ring, fan[-1][corner - 1]]))
        left = [triangle for triangle in left if triangle not in fan]
    return found


def _longest(triangles: list[Triangle]) -> tuple[int, list[Triangle]]:
    """The longest fan among some triangles, and the corner that is its hub."""
    longest: tuple[int, list[Triangle]] = (2, [])
    for corner in (2, 0, 1):
        onward = {(t[corner], t[corner - 2]): t for t in triangles}
        for first in triangles:
            fan, following = [first], onward.get((first[corner], first[corner - 1]))
            while following is not None and following not in fan and len(fan) < LONGEST:
                fan.append(following)
                following = onward.get((following[corner], following[corner - 1]))
            if len(fan) > len(longest[1]):
                longest = corner, fan
            if len(fan) == len(triangles):
                return longest
    return longest


#: So many fans of a kind are drawn at once, so that their nodes fit the first cache.
BLOCK = 1 << 12


@cache
def corners_of(number: int) -> Integers:
    """(BLOCK * T * 3,) the corners of the triangles of a block of fans of this kind.

    Each is named by its place among the nodes of the block, (T + 2, BLOCK) flat.

    >>> (corners_of(2 * (3 * 2 + 2))[:6] // BLOCK).tolist()
    [1, 2, 0, 2, 3, 0]
    """
    triangles, hub = number // 6, number // 2 % 3
    nodes = np.zeros((triangles, 3), np.int64)
    for step in (1, 2):
        nodes[:, (hub + step) % 3] = np.arange(triangles) + step
    return (nodes * BLOCK + np.arange(BLOCK)[:, None, None]).reshape(-1)


@dataclass(frozen=True, eq=False)
class Kind:
    """The fans of one kind, K of them.

    number : as in the glossary
    nodes : (T + 2, K) the hub of each fan, and the nodes round it
    """

    number: int
    nodes: Integers

    @property
    def triangles(self) -> int:
        """T, of each fan."""
        return self.number // 6

    @property
    def hub(self) -> int:
        """The corner of each triangle that is the hub."""
        return self.number // 2 % 3

    @property
    def is_inside(self) -> bool:
        """Whether some of the nodes may be interior points."""
        return bool(self.number & 1)


# (3, 12) along each axis: whether an edge runs along it, and where its lower end is in the cell.
_ALONG = np.array([[float(e // 4 == axis) for e in range(12)] for axis in range(3)])
_LOWER = np.ascontiguousarray(CORNER_OFFSETS[EDGE_CORNERS[:, 0]].T.astype(np.float64))


@dataclass(frozen=True, eq=False)
class Means:
    """The averages of N nodes, K of them.

    nodes : (N, K)
    lower : (3, N, K) where the lower end of each node's edge is in the cell, along each axis
    along : (3, N, K) 1 where the edge runs along the axis, else 0
    """

    nodes: Integers
    lower: Floats
    along: Floats

    @classmethod
    def of(cls, rows: list[tuple[int, ...]]) -> Means:
        """Those with these nodes."""
        nodes = _columns(rows)
        return cls(nodes, _LOWER[:, nodes], _ALONG[:, nodes])


@dataclass(frozen=True, eq=False)
class Tables:
    """The tiles of the keys met so far.

    tile : of each key
    known : for each key, whether its tile is in the tables
    first, count : for each key, the number of its first fan, and how many it has
    kind, column : for each fan
    kinds : by their numbers
    interior : for each key, its number of interior points
    deferred : for each key, whether it has interior points that are no averages
    means : for a key, the number of its first average
    length, place : for an average, its number of nodes N, and its column in `averages[N]`
    averages : by their N
    """

    tile: dict[int, Tile]
    known: NDArray[np.bool_]
    first: Integers
    count: Bytes
    kind: Bytes
    column: Integers
    kinds: dict[int, Kind]
    interior: Integers
    deferred: NDArray[np.bool_]
    means: Integers
    length: Bytes
    place: Integers
    averages: dict[int, Means]

    @classmethod
    def of(cls, tile: dict[int, Tile], size: int) -> Tables:
        """The tables of these tiles, for keys below `size`."""
        known, deferred = np.zeros((2, size), np.bool_)
        count = np.zeros(size, np.uint8)
        first, interior, means = np.zeros((3, size), np.int64)
        kind: list[int] = []
        column: list[int] = []
        nodes: dict[int, list[list[int]]] = {}
        averages: dict[int, list[tuple[int, ...]]] = {}
        length: list[int] = []
        place: list[int] = []
        for key, one in tile.items():
            # Put each fan into its kind.
            cut = fans(one.triangles)
            known[key], first[key], count[key] = True, len(kind), len(cut)
            for triangles, hub, fan in cut:
                kind.append(2 * (3 * triangles + hub) + bool(one.interior))
                own = nodes.setdefault(kind[-1], [])
                column.append(len(own))
                own.append(fan)

            # Note its averages.
            interior[key], means[key] = len(one.interior), len(length)
            for mean in one.interior:
                if not isinstance(mean, Average):
                    deferred[key] = True
                    continue
                of_length = averages.setdefault(len(mean.nodes), [])
                length.append(len(mean.nodes))
                place.append(len(of_length))
                of_length.append(mean.nodes)
        return cls(
            tile,
            known,
            first,
            count,
            np.array(kind, np.uint8),
            np.array(column, np.int64),
            {number: Kind(number, _columns(nodes[number])) for number in sorted(nodes)},
            interior,
            deferred,
            means,
            np.array(length, np.uint8),
            np.array(place, np.int64),
            {n: Means.of(rows) for n, rows in averages.items()},
        )

    def fans_of(self, keys: Integers) -> tuple[Integers, Integers]:
        """The fans of cells with these keys (n,), and in which of the n cells each lies."""
        first, count = take(self.first, keys), take(self.count, keys)
        if count.all():
            cells, found = [np.arange(len(keys))], [first]
        else:
            cells = [count.nonzero()[0]]
            found = [take(first, cells[0])]
        more, nth = (count > 1).nonzero()[0], 1
        while len(more):
            cells.append(more)
            found.append(take(first, more) + nth)
            nth += 1
            more = take(more, (take(count, more) > nth).nonzero()[0])
        if len(found) == 1:
            return found[0], cells[0]
        return np.concatenate(found), np.concatenate(cells)


@dataclass(frozen=True, eq=False)
class Steps:
    """From 3 * place of a cell to the edges that are its nodes, in the planes of some lattice.

    fans : for the number of each kind, (T + 2, K); 0 for an interior point
    averages : for each N, (N, K)
    """

    fans: dict[int, Integers]
    averages: dict[int, Integers]


@lru_cache(maxsize=16)
def steps_of(tables: Tables, lattice: Lattice) -> Steps:
    """The steps to the nodes that are in these tables."""
    steps = np.append(lattice.edge_steps, 0)
    return Steps(
        {n: take(steps, np.minimum(kind.nodes, 12)) for n, kind in tables.kinds.items()},
        {n: take(steps, means.nodes) for n, means in tables.averages.items()},
    )


def _columns(rows: list[list[int]] | list[tuple[int, ...]]) -> Integers:
    """The rows as columns of an array."""
    return np.ascontiguousarray(np.array(rows, np.int64).T)


class Tiles:
    """What was learned of a rule; kept between calls, and safe to share between threads."""

    def __init__(self, rule: Rule) -> None:
        self.rule = rule
        self.asks = np.array([rule.asks(signs) for signs in range(256)])
        self.size = 1 << (8 + rule.bits)
        self.lock = threading.Lock()
        self.tables = Tables.of({}, self.size)

    def learn(self, keys: Array) -> Tables:
        """Tables that hold the tile of every key that occurs."""
        tables = self.tables
        known = take(tables.known, keys)
        if known.all():
            return tables
        with self.lock:
            # Never change tables that another thread may be reading: make new ones.
            tile = dict(self.tables.tile)
            for key in np.unique(keys[~known]).tolist():
                if key not in tile:
                    tile[key] = self.rule.tile(key & 255, key >> 8)
            self.tables = Tables.of(tile, self.size)
            return self.tables


_remembered = lru_cache(maxsize=64)(Tiles)


def tiles_of(rule: Rule) -> Tiles:
    """What is known of this rule from earlier calls, where the rule can be remembered."""
    try:
        return _remembered(rule)
    except TypeError:
        return Tiles(rule)
