"""An extractor made to be broken: marching cubes in steps that a fault can replace one by one.

The sound one draws what `isoref` draws with the rule it is given, and a test says so. A fault is a
subclass that changes one step, as a slip of an author would: the comparison, the interpolation, the
decision on a face, the tile, the name of a lattice edge, the cells that are visited, the types of
the answer. It is a second implementation of the sweep, slow and short, so that a fault can sit in
any of its lines.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

import numpy as np
from isoref import asymptotic_decider
from isoref.cube import CORNER_OFFSETS, EDGE_CORNERS
from isoref.field import Field, check_isovalue
from isoref.rule import Rule, Tile
from isoref.sweep import cell_crossings
from numpy.typing import NDArray

Array = NDArray[Any]
Answer = tuple[Any, Any]
Spacing = tuple[float, ...]


class Engine:
    """Marching cubes: each method is one step."""

    rule: ClassVar[Rule] = asymptotic_decider.RULE

    def __call__(self, values: Any, isovalue: float, spacing: Spacing) -> Answer:
        """Vertices and triangles of a volume."""
        # Read the samples and compare them.
        samples = self.read(values)
        alpha = self.level(samples, isovalue)
        if min(samples.shape) < 2:
            return np.empty((0, 3)), np.empty((0, 3), np.int64)
        relative = self.relative(samples, alpha)
        inside = self.inside(samples, relative, alpha)
        shape = samples.shape

        # Find the cells that the surface crosses, and what each draws.
        cells = self.visited(np.argwhere(self.active(inside)), shape)
        if not len(cells):
            return np.empty((0, 3)), np.empty((0, 3), np.int64)
        corners = [tuple((cells + offset).T) for offset in CORNER_OFFSETS]
        g = np.array([relative[c] for c in corners], np.float64)
        signs = np.array(sum(inside[c].astype(np.int64) << k for k, c in enumerate(corners)))
        decisions = self.decisions(g, signs, cells)
        crossings = self.crossings(g, signs, cells)

        # Copy the triangles, cells of one kind together.
        on_edges = np.array([self.edge_name(cells, e, shape) for e in range(12)])
        names, places, owners = [], [], []
        keys = signs | decisions << 8
        for key, rows in of_one_kind(keys):
            tile = self.tile(key & 255, key >> 8)
            nodes = np.array(tile.triangles, np.int64).reshape(-1).tolist()
            inner = [place(g[:, rows], crossings[:, rows]) for place in tile.interior]
            inner = self.interior(inner, g[:, rows])
            named, placed = on_edges[:, rows], cells[rows] + crossings[:, rows]
            for node in nodes:
                if node < 12:
                    names.append(named[node])
                    places.append(placed[node])
                else:
                    names.append(self.inner_name(cells[rows], node, key, shape))
                    places.append(cells[rows] + inner[node - 12])
                owners.append(rows)
        return self.finish(*self.weld(names, places, owners, keys), spacing, shape)

    # The steps, in order.

    def read(self, values: Any) -> Array:
        """The samples, checked."""
        return np.ascontiguousarray(Field.of(values, dimension=3).values)

    def level(self, samples: Array, isovalue: float) -> float:
        """The isovalue, checked."""
        return check_isovalue(isovalue)

    def relative(self, samples: Array, alpha: float) -> Array:
        """Samples minus the isovalue."""
        return np.asarray(samples.astype(np.float64) - alpha)

    def inside(self, samples: Array, relative: Array, alpha: float) -> Array:
        """Which samples are inside."""
        return np.asarray(relative >= 0)

    def active(self, inside: Array) -> Array:
        """Which cells have corners on both sides."""
        counts = sum(
            inside[
                tuple(slice(o, o + n - 1) for o, n in zip(offset, inside.shape, strict=True))
            ].astype(np.int64)
            for offset in CORNER_OFFSETS
        )
        return np.asarray((counts > 0) & (counts < 8))

    def visited(self, cells: Array, shape: tuple[int, ...]) -> Array:
        """The cells of these that are drawn."""
        return cells

    def decisions(self, g: Array, signs: Array, cells: Array) -> Array:
        """What the rule decides for each cell."""
        made = self.rule.decisions(g)
        asks = np.array([self.rule.asks(s) for s in range(256)])
        return np.where(asks[signs], made, 0)

    def crossings(self, g: Array, signs: Array, cells: Array) -> Array:
        """Where each edge of each cell is crossed, (12, n, 3)."""
        found = cell_crossings(g)
        for e, (a, b) in enumerate(EDGE_CORNERS):
            crossed = np.flatnonzero((signs >> a & 1) != (signs >> b & 1))
            found[e, crossed] = CORNER_OFFSETS[a]
            found[e, crossed, e // 4] = self.parameter(g[a, crossed], g[b, crossed])
        return found

    def parameter(self, low: Array, high: Array) -> Array:
        """Where on an edge the linear interpolant vanishes."""
        return np.asarray(low / 2 / (low / 2 - high / 2))

    def tile(self, signs: int, decisions: int) -> Tile:
        """The triangles of a cell."""
        return self.rule.tile(signs, decisions)

    def interior(self, inner: list[Array], g: Array) -> list[Array]:
        """The inner points of cells of one kind, in coordinates of the cell."""
        return inner

    def edge_name(self, cells: Array, e: int, shape: tuple[int, ...]) -> Array:
        """One integer for each lattice edge."""
        low = cells + CORNER_OFFSETS[EDGE_CORNERS[e][0]]
        return np.asarray(3 * self.flat(low, shape) + e // 4)

    def inner_name(self, cells: Array, node: int, key: int, shape: tuple[int, ...]) -> Array:
        """One integer for each inner point of a cell, none of them a lattice edge's."""
        return np.asarray(-1 - 8 * self.flat(cells, shape) - (node - 12))

    def flat(self, index: Array, shape: tuple[int, ...]) -> Array:
        """The flat index of lattice points."""
        i, j, k = index.T
        return np.asarray((i * shape[1] + j) * shape[2] + k)

    def weld(
        self, names: list[Array], places: list[Array], owners: list[Array], keys: Array
    ) -> tuple[Array, Array]:
        """Vertices in units of cells, and triangles in the order of their cells."""
        every, where = np.concatenate(names), np.concatenate(places)
        _, first, number = np.unique(every, return_index=True, return_inverse=True)
        # A triangle's corners stand one after the other, each for all cells of its kind.
        many = np.array([len(rows) for rows in owners[::3]])
        starts, step = np.repeat(3 * np.cumsum(many) - 3 * many, many), np.repeat(many, many)
        within = np.arange(many.sum()) - np.repeat(np.cumsum(many) - many, many)
        triangles = number[(starts + within)[:, None] + step[:, None] * np.arange(3)]
        order = np.argsort(np.concatenate(owners[::3]), kind="stable")
        return where[first], triangles[order]

    def finish(
        self, vertices: Array, triangles: Array, spacing: Spacing, shape: tuple[int, ...]
    ) -> Answer:
        """The answer in the world's units."""
        return vertices * np.asarray(spacing), triangles


def of_one_kind(keys: Array) -> Iterator[tuple[int, Array]]:
    """Each number that occurs, and the places where it does, both in ascending order."""
    order = np.argsort(keys, kind="stable")
    kinds, first = np.unique(keys[order], return_index=True)
    yield from zip(kinds.tolist(), np.split(order, first[1:]), strict=True)
