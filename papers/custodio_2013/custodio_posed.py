"""The published cells and grids posed by the hundred, and what a mesh says of each.

Blocks of samples stand side by side in one field. A grid of the set is high all round, so nothing
is drawn between two of them. A cell is set apart by a layer of high samples; what is drawn in the
layer is left out, by the middles of triangles.

Glossary
--------
b0          the number of pieces of a surface
chi         its Euler characteristic, V - E + F
b1          as the set counts it: handles, b0 - chi / 2. The first Betti number of a closed surface
            is twice that; the set's 0, 1, 2, .. are handles, or one loop of the two of each
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from custodio_files import is_set, read_set
from isograde.model import Adapter, AdapterError, Request
from isograde.oracles.complexes import Complex
from isograde.oracles.rows import components_of
from isoref.field import Field
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
# Blocks along each axis that are posed at once.
SIDES = {"pymeshlab": 3, "pymeshlab:raw": 3, "manifold3d": 5}
SIDE = 10
# Layers of samples more at the far ends of a field: MeshLab's filter, called as it is, leaves the
# last two layers of cells out along each axis, which is 19 of 27 blocks.
MARGINS = {"pymeshlab:raw": 2}
NAME = "custodio.npz"


@dataclass(frozen=True, eq=False)
class Published:
    """The published verification set, isovalue 0.

    Attributes
    ----------
    cells, euler : (n, 2, 2, 2) samples, and the Euler characteristic in each cell
    grids : (g, 5, 5, 5) the distinct grids
    times : (g,) how often each is in the set
    betti : (g, 2) b0 and b1 of each, b1 counting handles
    """

    cells: Floats
    euler: Ints
    grids: Floats
    times: Ints
    betti: Ints

    @classmethod
    def read(cls, folder: Path) -> Published:
        """The set in this folder: as it is published, in small files, or in one file of NumPy's.

        Raises
        ------
        FileNotFoundError
            where the folder has neither
        ValueError
            where the set contradicts itself: equal grids with unequal Betti numbers
        """
        if is_set(folder):
            cells, euler, every, betti = read_set(folder)
        else:
            with np.load(folder / NAME) as kept:
                every = kept["grids"].astype(np.float64)
                betti = np.stack([kept["grid_b0"], kept["grid_b1"]], axis=1).astype(np.int64)
                cells, euler = kept["cells"].astype(np.float64), kept["cell_euler"].astype(np.int64)
        _, first, back, times = np.unique(
            every.reshape(len(every), -1),
            axis=0,
            return_index=True,
            return_inverse=True,
            return_counts=True,
        )
        if (betti[first][back.reshape(-1)] != betti).any():
            raise ValueError("equal grids of the set have unequal Betti numbers")
        return cls(cells, euler, every[first], times.astype(np.int64), betti[first])


def field_of(blocks: Floats, side: int) -> Floats:
    """The field in which side^3 blocks (b, n, n, n) stand side by side."""
    n = blocks.shape[1]
    cube = blocks.reshape(*(side,) * 3, *(n,) * 3)
    return np.asarray(cube.transpose(0, 3, 1, 4, 2, 5).reshape((n * side,) * 3))


def padded(cells: Floats) -> Floats:
    """Each cell with one layer of high samples below it and one above along each axis."""
    top = abs(cells).max() + 1.0
    return np.pad(cells, [(0, 0)] + [(1, 1)] * 3, constant_values=top)


def answer(adapter: Adapter, values: Floats, margin: int = 0) -> Complex:
    """What the implementation makes of a field, equal vertices made one. Raises AdapterError."""
    wide = np.pad(values, (0, margin), mode="edge")
    outcome = adapter.run(Request("papers/custodio_2013", "plain", Field.of(wide), (0.0,)))
    if outcome.mesh is None:
        raise AdapterError(f"no mesh: {outcome.status}, {outcome.detail}")
    return Complex.of(outcome.mesh.vertices, outcome.mesh.simplices).welded()


def euler_of_cells(surface: Complex, side: int) -> Ints:
    """(side^3,) V - E + F of the triangles in the middle cell of each block of 4^3 samples."""
    middle = surface.points[surface.simplices].mean(axis=1)
    inside = ((middle % 4 >= 1) & (middle % 4 <= 2)).all(axis=1)
    home = _home(middle[inside], 4, side)
    faces = surface.simplices[inside]
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    corners = np.unique(np.stack([np.repeat(home, 3), faces.reshape(-1)], axis=1), axis=0)
    sides = np.unique(np.column_stack([np.repeat(home, 3), ends]), axis=0)
    V, E, F = (np.bincount(own, minlength=side**3) for own in (corners[:, 0], sides[:, 0], home))
    return np.asarray(V - E + F, np.int64)


def betti_of_blocks(surface: Complex, n: int, side: int) -> Ints:
    """(side^3, 2) b0 and b1 of the surface in each block of n^3 samples; -1 where it is open.

    A surface with a border has no handles to compare: its grid is wrong whatever they are.
    """
    total = side**3
    _, piece = components_of(len(surface.points), surface.facets.rows.T)
    used = np.flatnonzero(surface.used)
    _, first = np.unique(piece[used], return_index=True)
    home = _home(surface.points, n, side)
    b0 = np.bincount(home[used][first], minlength=total)
    chi = np.bincount(home[used], minlength=total)
    chi -= np.bincount(home[surface.facets.rows[:, 0]], minlength=total)
    chi += np.bincount(home[surface.simplices[:, 0]], minlength=total)
    handles = np.where(chi % 2 == 0, b0 - chi // 2, -1)
    handles[home[surface.open_facets[:, 0]]] = -1
    return np.stack([b0, handles], axis=1).astype(np.int64)


def _home(points: Floats, n: int, side: int) -> Ints:
    """The number of the block in which each point lies."""
    place = np.clip(np.floor((points + 0.5) / n).astype(np.int64), 0, side - 1)
    return np.asarray(np.ravel_multi_index(tuple(place.T), (side,) * 3), np.int64)


def right_cells(
    adapter: Adapter, cells: Floats, euler: Ints, side: int, margin: int = 0
) -> NDArray[np.bool_]:
    """(n,) cells in which the implementation's surface has the published Euler characteristic."""
    found = []
    for block, number in _blocks(padded(cells), side):
        surface = answer(adapter, field_of(block, side), margin)
        found.append(euler_of_cells(surface, side)[:number])
    return np.asarray(np.concatenate(found) == euler)


def right_grids(
    adapter: Adapter, grids: Floats, betti: Ints, side: int, margin: int = 0
) -> NDArray[np.bool_]:
    """(g,) grids in which the implementation's surface has the published Betti numbers."""
    n, found = grids.shape[1], []
    for block, number in _blocks(grids, side):
        surface = answer(adapter, field_of(block, side), margin)
        found.append(betti_of_blocks(surface, n, side)[:number])
    return np.asarray((np.concatenate(found) == betti).all(axis=1))


def _blocks(blocks: Floats, side: int) -> list[tuple[Floats, int]]:
    """The blocks in lots of side^3, the last lot filled up with high ones; how many are real."""
    lots = []
    for start in range(0, len(blocks), side**3):
        own = blocks[start : start + side**3]
        filler = np.full((side**3 - len(own), *blocks.shape[1:]), blocks.max())
        lots.append((np.concatenate([own, filler]), len(own)))
    return lots
