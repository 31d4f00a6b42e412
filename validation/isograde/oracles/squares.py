r"""What a mesh of segments does in each square of a plane lattice, and which of it is legal.

The signs of a square's four corners leave little choice, as in `isograde.oracles.traces` on the
faces of a cell: crossed edges are joined in pairs, and where all four are crossed the two segments
cut off either the two inside corners (*separated*) or the two outside ones (*joined*)::

      o--*--x            separated: a-b and c-d cut off the corners o, which are inside
      |  b  |            joined:    b-d and a-c cut off the corners x
      *a   d*
      |  c  |
      x--*--o

A curve may have vertices inside a square: it counts by the edges on which it ends.

Glossary
--------
square      named by its lowest sample
node        the middle of an edge, in half steps: (0, 1), (1, 0), (1, 2) or (2, 1)
bit         of a pair of nodes, in the order of `PAIRS`
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from itertools import combinations

import numpy as np
from isoref.field import Array, Booleans, Floats, Integers

from isograde.oracles.lattice import Lattice, components
from isograde.oracles.rows import components_of, distinct

NODES = ((0, 1), (1, 0), (1, 2), (2, 1))
CORNERS = ((0, 0), (0, 2), (2, 0), (2, 2))
PAIRS = tuple(combinations(range(4), 2))


@cache
def legal() -> Integers:
    """(16, 2) legal bits of each square, separated first, joined second.

    Bit c of the square's number is set where ``CORNERS[c]`` is inside.
    """
    table = np.zeros((16, 2), np.int64)
    for signs in range(16):
        inside = {c for bit, c in enumerate(CORNERS) if signs >> bit & 1}
        crossed = [k for k, node in enumerate(NODES) if len(_ends(node) & inside) == 1]
        if len(crossed) == 2:
            table[signs] = 1 << PAIRS.index((crossed[0], crossed[1]))
        elif crossed:
            table[signs] = _cut(inside), _cut(set(CORNERS) - inside)
    return table


def _ends(node: tuple[int, int]) -> set[tuple[int, int]]:
    """The two corners of a node's edge."""
    a, b = node
    return {(a if a != 1 else side, b if b != 1 else side) for side in (0, 2)}


def _cut(corners: set[tuple[int, int]]) -> int:
    """The bits of the segments that cut these corners off, one by one."""
    return sum(
        1 << bit for bit, (p, q) in enumerate(PAIRS) if _ends(NODES[p]) & _ends(NODES[q]) & corners
    )


@dataclass(frozen=True, eq=False)
class Squares:
    """What the mesh does in each square that it, or the field, passes through.

    Attributes
    ----------
    place : (s, 2) lowest sample
    signs : (s,) the corners' sides, as in `legal`
    tied : (s,) a corner is a tied sample
    code : (s,) bits of the pairs of nodes that are joined
    odd : (s,) there is more than curves from node to node
    segments, inner : (s,) number of segments in it, and of vertices strictly inside
    spanning : segments that no single square contains
    values : (s, 4) samples at (0, 0), (1, 0), (0, 1), (1, 1)
    """

    place: Integers
    signs: Integers
    tied: Booleans
    code: Integers
    odd: Booleans
    segments: Integers
    inner: Integers
    spanning: Integers
    values: Array

    @cached_property
    def ambiguous(self) -> Booleans:
        """(s,) squares with two legal resolutions."""
        pairs = legal()[self.signs]
        return np.asarray(pairs[:, 0] != pairs[:, 1])

    @cached_property
    def wanted(self) -> Integers:
        """(s,) number of segments: one for two crossed edges, and one for each inner vertex."""
        ends = np.array([bin(code).count("1") for code in legal()[:, 0].tolist()])
        return np.asarray(ends[self.signs] + self.inner)

    @cached_property
    def separated(self) -> Booleans:
        """(s,) the inside corners are separated, as is legal."""
        return np.asarray((self.code == legal()[self.signs, 0]) & ~self.odd)

    @cached_property
    def joined(self) -> Booleans:
        """(s,) the inside corners are joined, as is legal."""
        return np.asarray((self.code == legal()[self.signs, 1]) & ~self.odd)


def squares(lattice: Lattice, places: Floats, segments: Integers) -> Squares:
    """The squares of a plane lattice.

    Parameters
    ----------
    places : (V, 2) vertices in index coordinates
    segments : (S, 2)
    """
    shape = np.maximum(np.subtract(lattice.shape, 1), 0)
    # Give each segment to the square that its middle is in.
    ends = places[segments]
    corner = np.floor(ends.mean(axis=1)).astype(np.int64)
    here = ((corner >= 0) & (corner < shape)).all(axis=1)
    slack = lattice.tolerance
    beyond = (ends < corner[:, None] - slack) | (ends > corner[:, None] + 1 + slack)
    proper = here & ~beyond.any(axis=(1, 2))

    # List the squares of the field and of the mesh.
    signs = _signs(lattice, shape)
    active = np.argwhere((signs > 0) & (signs < 15))
    every = np.concatenate([active, corner[proper]])
    first, where = distinct(every)
    listed, row = every[first], where[len(active) :]
    code, odd, inner = _curves(lattice, places, segments[proper], row, listed)
    x, y = listed.T
    tied = lattice.tied
    values = components(lattice.field)[0]
    return Squares(
        listed,
        signs[x, y] if len(listed) else np.empty(0, np.int64),
        tied[x, y] | tied[x + 1, y] | tied[x, y + 1] | tied[x + 1, y + 1],
        code,
        odd,
        np.bincount(row, minlength=len(listed)),
        inner,
        np.flatnonzero(here & ~proper),
        np.stack([values[x, y], values[x + 1, y], values[x, y + 1], values[x + 1, y + 1]], axis=1),
    )


def _signs(lattice: Lattice, shape: Integers) -> Integers:
    """The sides of every square's corners, as in `legal`."""
    signs = np.zeros(shape, np.int64)
    for bit, (a, b) in enumerate(CORNERS):
        x, y = a // 2, b // 2
        signs |= lattice.inside[x : x + shape[0], y : y + shape[1]].astype(np.int64) << bit
    return signs


def _curves(
    lattice: Lattice, places: Floats, segments: Integers, row: Integers, listed: Integers
) -> tuple[Integers, Booleans, Integers]:
    """(s,) the bits of each square, where there is more than curves, and the inner vertices."""
    code, odd = np.zeros(len(listed), np.int64), np.zeros(len(listed), bool)
    if not len(segments):
        return code, odd, np.zeros(len(listed), np.int64)
    # Give each square its own copy of each vertex, and say on which node it stands.
    keys, local = np.unique(row[:, None] * len(places) + segments, return_inverse=True)
    local = local.reshape(-1, 2)
    owner, vertex = np.divmod(keys, len(places))
    node = _node(places[vertex] - listed[owner], lattice.tolerance)
    degree = np.bincount(local.reshape(-1), minlength=len(keys))
    odd[owner[np.where(node >= 0, degree != 1, degree != 2) | (node == OFF)]] = True
    # A curve has two ends, on nodes.
    count, curve = components_of(len(keys), local.T)
    at = np.flatnonzero(node >= 0)
    at = at[np.argsort(curve[at], kind="stable")]
    number = np.bincount(curve[at], minlength=count)
    odd[owner[number[curve] != 2]] = True
    at = at[number[curve[at]] == 2].reshape(-1, 2)
    pair = np.sort(node[at], axis=1)
    bit = 1 << _PAIR[pair[:, 0], pair[:, 1]]
    doubled = np.bincount(owner[at[:, 0]] * 64 + bit, minlength=len(listed) * 64) > 1
    odd[np.flatnonzero(doubled) // 64] = True
    np.bitwise_or.at(code, owner[at[:, 0]], bit)
    return code, odd, np.bincount(owner[node == INSIDE], minlength=len(listed))


# A place that is neither on an edge nor strictly inside; a place strictly inside.
OFF, INSIDE = -2, -1
_PAIR = np.zeros((4, 4), np.int64)
for _bit, (_p, _q) in enumerate(PAIRS):
    _PAIR[_p, _q] = _bit


def _node(local: Floats, tolerance: float) -> Integers:
    """(r,) the node that a place in a square stands on, `INSIDE` or `OFF`."""
    whole = np.abs(local - np.rint(local)) <= tolerance
    half = np.where(whole, 2 * np.rint(local), 1).astype(np.int64)
    found = np.full(len(local), OFF)
    found[~whole.any(axis=1)] = INSIDE
    for k, node in enumerate(NODES):
        found[(half == node).all(axis=1)] = k
    return found
