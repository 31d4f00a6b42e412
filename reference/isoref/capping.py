r"""Caps: a surface closed where it runs out of the volume.

A surface that reaches the border of the lattice ends there, with a boundary. To print it, to
measure its volume or to cut it, one wants it closed. Put a frame of samples outside round the
volume, and whatever method draws, it draws on, round the inside samples of the border::

        . . . . . .           . : a sample of the frame, outside       o : outside       # : inside
        . o # # # .
        . o # # o .           between # and . a crossed edge, and so a vertex
        . o o o o .
        . . . . . .

That closes it, by the method's own virtue, but a sample beyond the border. So the vertices between
an inside sample and the frame are moved back to the sample. Then the cap lies in the border, which
it covers exactly where the samples say inside, up to the surface's own boundary. At the edges and
corners of the volume a sample has several neighbours in the frame: their vertices have become one,
and triangles that have lost a corner by it are dropped.

Glossary
--------
frame       the samples added: two before the first on each axis, one behind the last. (Two, so that
            a split of cells that repeats itself after two begins where it did.)
cap         the triangles that have a corner at a sample, moved there
rim         the cells that lie beyond the border along two axes or three: what a method draws in
            them shrinks to an edge or a corner of the volume

Invariants
----------
A method that is closed away from the border gives a closed mesh; triangles away from the border are
the ones it drew without caps. On each square of the border a cap's polygons are convex: their
corners are corners of the square and at most one point on each of its sides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from isoref.field import (
    Array,
    Booleans,
    Field,
    FieldError,
    Floats,
    Integers,
    check_isovalue,
    inside_samples,
    least_inside,
)
from isoref.mesh import Mesh, Provenance, in_space
from isoref.sweep import check_volume

BEFORE, BEHIND = 2, 1


@in_space
def capped(
    method: Callable[..., Mesh], field: Field, isovalue: float, provenance: bool = False
) -> Mesh:
    """The method's surface, closed on the border of the volume.

    Parameters
    ----------
    method : of `isoref.methods.METHODS`, or any that gives the provenance of its mesh
    field : one value a sample on a lattice (N1, N2, N3)
    isovalue : in the unit of the samples
    provenance : keep it. A vertex of a cap stands at a sample, which is both its ends; a triangle
        of a cap belongs to the cell that it closes

    Raises
    ------
    FieldError
        as the method does, and where no number of the samples' type is outside.

    >>> from isoref import METHODS
    >>> block = Field.of(np.ones((2, 2, 2)))
    >>> capped(METHODS["asymptotic-decider"], block, 0.5)
    Mesh(8 vertices in R^3, 12 simplices of dimension 2)
    """
    check_volume(field)
    alpha = check_isovalue(isovalue)
    if min(field.shape) < 2:
        return method(field, alpha, provenance=provenance)
    values = field.values.reshape(field.shape)
    framed = Field.of(framed_samples(values, alpha), dimension=3)
    drawn = method(framed, alpha, provenance=True)
    moved = _moved(drawn.traced(), drawn.vertices, inside_samples(framed, alpha))

    # Make one vertex of all that have come to one sample.
    own, number = np.unique(moved.names, return_inverse=True)
    first = np.full(len(own), len(number))
    np.minimum.at(first, number, np.arange(len(number)))
    triangles = number[drawn.simplices]
    a, b, c = triangles.T
    kept = (a != b) & (b != c) & (c != a)

    mesh = Mesh(field.position(moved.index[first]), triangles[kept])
    if not provenance:
        return mesh
    found = drawn.traced()
    cells = _real_cells(found.cells[kept], framed.shape)
    return Mesh(
        mesh.vertices, mesh.simplices, Provenance(moved.ends[first], moved.t[first], cells, field)
    )


def framed_samples(values: Array, isovalue: float) -> Array:
    """The samples in a frame of outside ones, of a wider type where theirs has none outside.

    >>> framed_samples(np.array([[[7]]], np.uint8), 3).shape
    (4, 4, 4)
    """
    level = least_inside(values.dtype, isovalue)
    outside: Any = 0 if values.dtype.kind in "bu" else None
    if values.dtype.kind == "i":
        outside = np.iinfo(values.dtype).min
    if outside is not None and outside >= level:
        # Every sample is inside, and stays so when it is rounded.
        values, level, outside = values.astype(np.float64), np.float64(isovalue), None
    if outside is None:
        with np.errstate(over="ignore"):
            outside = np.nextafter(level, values.dtype.type(-np.inf))
    if not np.isfinite(outside):
        raise FieldError(f"no number is below the isovalue {isovalue}: nothing can be outside")
    return np.pad(values, [(BEFORE, BEHIND)] * 3, constant_values=outside)


@dataclass(frozen=True, eq=False)
class _Moved:
    """The vertices of the framed volume, moved to the border where they were beyond it.

    index : (V, 3) fractional indices in the volume without its frame
    names : (V,) vertices of one name have come to one sample
    ends, t : as of `Provenance`, without the frame
    """

    index: Floats
    names: Integers
    ends: Integers
    t: Floats


def _moved(found: Provenance, vertices: Floats, inside: Booleans) -> _Moved:
    """The vertices of a mesh that was drawn on a framed volume, whose `inside` is given."""
    shape = tuple(n - BEFORE - BEHIND for n in inside.shape)
    low, high = (_without_frame(end, inside.shape) for end in found.ends.T)
    in_cell = found.ends[:, 1] < 0

    # Go to the end that is in the volume, where the other is in the frame.
    in_volume = [np.all((end >= 0) & (end < shape), axis=1) for end in (low, high)]
    at_sample = ~in_cell & ~(in_volume[0] & in_volume[1])
    sample = np.where(in_volume[0][:, None], low, high)

    # Let what was drawn inside a cell of the rim go to an inside sample of it.
    beyond = (low < 0) | (low == np.array(shape) - 1)
    rim = in_cell & (beyond.sum(axis=1) > 1) & ~in_cell.all()
    sample[rim] = _inside_sample(low[rim], inside)
    at_sample |= rim
    low, high = (np.where(at_sample[:, None], sample, end) for end in (low, high))
    t = np.where(at_sample, 0.0, found.t)

    # Project what was drawn inside other cells beyond the border.
    inner = in_cell & ~rim
    index = low + np.where(inner, 0.0, t)[:, None] * (high - low)
    index[inner] = np.clip(vertices[inner] - BEFORE, 0, np.array(shape) - 1)

    # Name vertices at samples by the samples, all others by themselves.
    numbers = np.stack([_flat(low, shape), _flat(high, shape)], axis=1)
    names = np.where(at_sample, numbers[:, 0], np.arange(len(t)) + int(np.prod(shape)))
    numbers[inner, 0] = _flat(np.minimum(low[inner], np.array(shape) - 2), shape)
    numbers[inner, 1] = -1
    return _Moved(index, names, numbers, t)


def _without_frame(framed: Integers, shape: tuple[int, ...]) -> Integers:
    """(V, 3) the indices of samples of the framed volume, counted from the first of the volume."""
    return np.stack(np.unravel_index(np.maximum(framed, 0), shape), axis=1) - BEFORE


def _flat(index: Integers, shape: tuple[int, ...]) -> Integers:
    """(V,) the flat index of the sample of the volume that is nearest to each (V, 3)."""
    nearest = np.clip(index, 0, np.array(shape) - 1)
    return np.asarray(np.ravel_multi_index(tuple(nearest.T), shape))


def _inside_sample(lowest: Integers, inside: Booleans) -> Integers:
    """(R, 3) an inside sample of each cell of the rim, which has one or two in the volume."""
    last = np.array(inside.shape) - BEFORE - BEHIND - 1
    one, other = np.clip(lowest, 0, last), np.clip(lowest + 1, 0, last)
    return np.where(inside[tuple((one + BEFORE).T)][:, None], one, other)


def _real_cells(cells: Integers, framed: tuple[int, ...]) -> Integers:
    """The cells without the frame, each cell beyond the border replaced by the one beside it."""
    shape = tuple(n - BEFORE - BEHIND for n in framed)
    index = np.unravel_index(np.maximum(cells, 0), tuple(n - 1 for n in framed))
    inner = [np.clip(i - BEFORE, 0, n - 2) for i, n in zip(index, shape, strict=True)]
    flat = np.ravel_multi_index(inner, tuple(n - 1 for n in shape))
    return np.asarray(np.where(cells < 0, -1, flat))
