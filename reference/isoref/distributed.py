"""Past one machine: a volume in blocks, the surface of each by itself, and one mesh of them all.

A cube rule decides in a cell by the samples at its eight corners. So a volume may be cut into
blocks of cells, and each block be given to another process, or another machine::

    samples of a block    its cells and one more plane along each axis, shared with its neighbour
    piece                 the block's part of the surface, with a name for each vertex
    welded                vertices of one name become one

The name of a vertex is the number of its lattice edge in the whole volume. Two blocks that share a
plane of samples interpolate the crossings on it from the same two samples, to the same bits, and
give them the same names; so welding needs no tolerance, and what comes is the mesh of the whole, up
to the order of vertices and triangles: closed where it is, and manifold where it is.

What it costs, for blocks of b samples a side, p bytes a sample, and a surface that crosses about
b^2 cells of a block:

    sent to a worker      p (b + 1)^3 bytes of samples, or nothing where it reads them from a store
    sent back             about 2 b^2 triangles and b^2 vertices: 72 b^2 bytes
    welded by name        the crossings on the faces of blocks: about 6 b of a block's b^2

So messages are two a block, and with b the share of the border falls as 1 / b: a thousand workers
with a block of 512^3 each send back 19 MB a block, of which less than 2 percent are looked up.

Glossary
--------
block       cells between two samples along each axis, with all their corners
name        3 * number of the lower sample of a lattice edge + its axis; -1 inside a cell

>>> values = np.random.default_rng(3).normal(size=(9, 8, 7))
>>> cut = blocks(values.shape, ((4, 5), (8,), (3, 4)))
>>> pieces = [piece(values[where], 0.2, values.shape, start_of(where)) for where in cut]
>>> len(pieces), welded(pieces)
(4, Mesh(664 vertices in R^3, 1101 simplices of dimension 2))
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from isoref.fast.slabs import lattice_of
from isoref.fast.sweep import block
from isoref.field import Booleans, Field, FieldError, Floats, Integers, check_isovalue
from isoref.mesh import Mesh
from isoref.methods import RULES

Where = tuple[slice, slice, slice]


@dataclass(frozen=True, eq=False)
class Piece:
    """The surface in one block.

    Attributes
    ----------
    vertices : (V, 3) positions in the whole volume
    names : (V,) what each is called in the whole volume
    shared : (V,) whether it may belong to another block too
    simplices : (T, 3) triangles by numbers of these vertices
    """

    vertices: Floats
    names: Integers
    shared: Booleans
    simplices: Integers


def blocks(shape: Sequence[int], chunks: Sequence[Sequence[int]]) -> list[Where]:
    """The samples of each block, whose first samples are those of the chunks.

    Parameters
    ----------
    shape : (N1, N2, N3) of the volume
    chunks : for each axis the lengths of the chunks along it, whose sum is the axis's

    >>> [where[0] for where in blocks((5, 2, 2), ((2, 3), (2,), (2,)))]
    [slice(0, 3, None), slice(2, 5, None)]
    """
    axes = []
    for n, lengths in zip(shape, chunks, strict=True):
        ends = np.cumsum([0, *lengths]).tolist()
        if ends[-1] != n:
            raise FieldError(f"chunks {tuple(lengths)} do not fill an axis of {n} samples")
        # A block has the first plane of the next chunk too; one that would have no cells is none.
        spans = [slice(a, min(b + 1, n)) for a, b in pairwise(ends)]
        axes.append([span for span in spans if span.stop - span.start >= 2])
    return [(i, j, k) for i, j, k in product(*axes)]


def start_of(where: Where) -> tuple[int, int, int]:
    """The first sample of a block."""
    i, j, k = where
    return i.start, j.start, k.start


def piece(
    samples: ArrayLike,
    isovalue: float,
    shape: Sequence[int],
    start: tuple[int, int, int],
    spacing: float | Sequence[float] | None = None,
    origin: Sequence[float] | None = None,
    method: str = "asymptotic-decider",
) -> Piece:
    """The surface in a block of a volume, by a cube rule.

    Parameters
    ----------
    samples : (n1, n2, n3) of the block
    isovalue : in the unit of the samples
    shape : (N1, N2, N3) of the volume
    start : the block's first sample in the volume
    spacing, origin : of the volume, as of `Field.of`
    method : a cube rule of `isoref.methods.RULES`

    Raises
    ------
    FieldError
        as `Field.of`; samples that are not finite are counted from the block's first.
    """
    field = Field.of(samples, spacing, origin)
    mesh = block(RULES[method], field, isovalue, start)
    traced = mesh.traced()
    on_edges = traced.ends[:, 1] >= 0

    # Name the lattice edges by their lower ends in the volume, and the axis along which they run.
    low, high = (np.array(np.unravel_index(ends[on_edges], field.shape)) for ends in traced.ends.T)
    axis = (high - low).argmax(axis=0)
    whole = np.ravel_multi_index(tuple(low + np.array(start)[:, None]), tuple(shape))
    names = np.full(len(mesh.vertices), -1)
    names[on_edges] = 3 * whole + axis

    # An edge in a plane between blocks is found by all that share the plane.
    border = (low == 0) | (low == np.array(field.shape)[:, None] - 1)
    border[axis, np.arange(len(axis))] = False
    shared = np.zeros(len(mesh.vertices), np.bool_)
    shared[on_edges] = border.any(axis=0)
    return Piece(mesh.vertices, names, shared, mesh.simplices)


def welded(pieces: Sequence[Piece]) -> Mesh:
    """One mesh of all pieces: vertices of one name are one.

    Vertices and triangles keep the order of the pieces, so it does not depend on who was done when.
    """
    if not pieces:
        return Mesh.empty(3, 2)
    names = np.concatenate([one.names for one in pieces])
    shared = np.flatnonzero(np.concatenate([one.shared for one in pieces]))

    # Keep the first of each name, and point the others to it.
    _, first, which = np.unique(names[shared], return_index=True, return_inverse=True)
    same = np.arange(len(names))
    same[shared] = shared[first][which]
    kept = same == np.arange(len(names))
    number = np.cumsum(kept) - 1

    # Number the vertices of each piece from those of the pieces before it on.
    before = np.cumsum([0, *(len(one.vertices) for one in pieces)])[:-1]
    simplices = [one.simplices + n for one, n in zip(pieces, before, strict=True)]
    vertices = np.concatenate([one.vertices for one in pieces])[kept]
    return Mesh(vertices, number[same[np.concatenate(simplices)]])


def extract(
    array: Any,
    isovalue: float,
    spacing: float | Sequence[float] | None = None,
    origin: Sequence[float] | None = None,
    *,
    directions: ArrayLike | None = None,
    method: str = "asymptotic-decider",
) -> Mesh:
    """The isosurface of a dask array, a task a chunk, by whatever runs dask's tasks.

    Where a `dask.distributed.Client` is there, its workers do the work, and what a lost worker was
    to do is done by another. Chunks of a store are read by the workers. Only the mesh has to fit
    the memory of who asks.

    Parameters
    ----------
    array : (N1, N2, N3) `dask.array.Array` of real numbers, finite
    isovalue, spacing, origin, directions : as of `isoref.methods.extract`
    method : a cube rule of `isoref.methods.RULES`

    Raises
    ------
    ValueError
        for a method that is no cube rule
    FieldError
        as `Field.of`; of a sample that is not finite, counted from its block's first
    """
    import dask

    if method not in RULES:
        raise ValueError(f"no cube rule {method!r}; there are {', '.join(sorted(RULES))}")
    level = check_isovalue(isovalue)
    place = lattice_of(array, spacing, origin, directions)
    straight = place.straight()
    asked = dask.delayed(piece, pure=True)
    tasks = [
        asked(
            array[where],
            level,
            array.shape,
            start_of(where),
            straight.spacing,
            straight.origin,
            method,
        )
        for where in blocks(array.shape, array.chunks)
    ]
    return welded(dask.compute(*tasks)).placed(place)
