"""Marching tetrahedra, vectorised: the mesh of `isoref.marching_tetrahedra`.

The tetrahedra of a cell make a tile that depends on the cell's signs and on its place in the block
alone. Each tile that occurs is drawn once; then all active cells look theirs up, and the crossings
they ask for are welded by the lattice points at their ends.

Glossary
--------
key         of a cell: signs + 256 * its place in the block of the split
edge        a crossed edge as one number: 27 * its lower lattice point + 9 (i + 1) + 3 (j + 1) +
            (k + 1), where (i, j, k) are the steps to its upper one
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from isoref.cube import CORNER_OFFSETS
from isoref.fast.dual import cell_signs
from isoref.field import Booleans, Field, Floats, Integers, check_isovalue, inside_samples
from isoref.marching_tetrahedra import Split, section
from isoref.mesh import Mesh, Provenance, in_space
from isoref.sweep import check_volume, crossing_parameter

_STEP = np.array([9, 3, 1])
_MIDDLE = int(_STEP.sum())


@in_space
def surface(split: Split, field: Field, isovalue: float, provenance: bool = False) -> Mesh:
    """The level set of the split's interpolant; see `isoref.marching_tetrahedra.surface`."""
    check_volume(field)
    alpha = check_isovalue(isovalue)
    if min(field.shape) < 2:
        none = Provenance.empty(field) if provenance else None
        return replace(Mesh.empty(3, 2), provenance=none)
    inside = inside_samples(field, alpha)
    rows, cells = _edges(split, inside)
    edges, triangles = np.unique(rows, return_inverse=True)
    vertices, ends, t = _place(field, alpha, inside, edges)
    found = Provenance(ends, t, cells, field) if provenance else None
    return Mesh(vertices, triangles.reshape(-1, 3), found)


def _edges(split: Split, inside: Booleans) -> tuple[Integers, Integers]:
    """The three edges of each triangle, (T, 3), in the order of the cells; their cells, (T,)."""
    signs = cell_signs(inside)
    cell = np.nonzero((signs != 0) & (signs != 255))
    place = np.zeros(len(cell[0]), np.int64)
    for index, n in zip(cell, split.block, strict=True):
        place = place * n + index % n
    keys = signs[cell] + 256 * place

    # Draw the tiles that occur, with edges as for a cell at lattice point 0.
    strides = np.array([inside.shape[1] * inside.shape[2], inside.shape[2], 1])
    occurs = np.flatnonzero(np.bincount(keys, minlength=256 * len(split.cells)))
    tiles = [_tile(split, int(key), strides) for key in occurs]
    rows = np.concatenate([np.empty((0, 3), np.int64), *tiles])
    count, start = np.zeros((2, 256 * len(split.cells)), np.int64)
    count[occurs] = [len(tile) for tile in tiles]
    start[occurs] = np.cumsum(count[occurs]) - count[occurs]

    # Copy each cell's tile to where the cell is.
    own = count[keys]
    owner = np.repeat(np.arange(len(keys)), own)
    row = np.arange(len(owner)) - np.repeat(np.cumsum(own) - own - start[keys], own)
    points = np.ravel_multi_index(cell, inside.shape)
    cells = np.ravel_multi_index(cell, signs.shape)[owner]
    return np.asarray(rows[row] + 27 * points[owner, None]), np.asarray(cells)


def _tile(split: Split, key: int, strides: Integers) -> Integers:
    """The edges of the triangles of a cell at lattice point 0, (T, 3)."""
    place, signs = divmod(key, 256)
    pieces = [piece for t in split.cells[place] for piece in section(t, signs)]
    ends = CORNER_OFFSETS[np.array(pieces, np.int64).reshape(-1, 3, 2)]
    numbers = ends @ strides
    backwards = (numbers[..., 0] > numbers[..., 1])[..., None]
    steps = np.where(backwards, ends[:, :, 0] - ends[:, :, 1], ends[:, :, 1] - ends[:, :, 0])
    return np.asarray(27 * numbers.min(axis=-1) + steps @ _STEP + _MIDDLE)


def _place(
    field: Field, alpha: float, inside: Booleans, edges: Integers
) -> tuple[Floats, Integers, Floats]:
    """Where the edges are crossed, (V, 3), between which samples, (V, 2), and where on them."""
    shape = np.array(field.shape)
    points, code = np.divmod(edges, 27)
    ends = np.empty((2, len(edges), 3), np.int64)
    ends[0] = np.stack(np.unravel_index(points, field.shape), axis=1)
    ends[1] = ends[0] + np.stack(np.unravel_index(code, (3, 3, 3)), axis=1) - 1
    # Go from the outside end, as the article does.
    numbers = np.stack([points, ends[1] @ [shape[1] * shape[2], shape[2], 1]])
    turned = inside.reshape(-1)[numbers[0]]
    low, high = np.where(turned, numbers[::-1], numbers)
    step = np.where(turned[:, None], ends[0] - ends[1], ends[1] - ends[0])
    start = np.where(turned[:, None], ends[1], ends[0])
    flat = field.values.reshape(-1)
    t = crossing_parameter(
        flat[low].astype(np.float64) - alpha, flat[high].astype(np.float64) - alpha
    )
    along = np.where(turned, 1 - t, t)
    return field.position(start + t[:, None] * step), numbers.T, along
