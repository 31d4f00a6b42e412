r"""Caps: a surface closed where it runs out of the volume, on its border and beside absent samples.

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

A sample that is absent, in the middle of the volume, is treated as one of the frame. It is outside,
and vertices between it and an inside sample go to that sample. So the surface is closed by what is
drawn in the cells that have an absent corner, and stands at samples that are present, or between
two of them: a lone absent sample in a solid becomes a hole in the form of an octahedron, whose
corners are its six neighbours. Cells without an absent corner have the surface they have without
caps.

Where absent samples lie on several sides of a sample, it may happen that making one vertex of all
that have come to it would fold the surface or pinch it. There they stay several vertices at one
place, with triangles between them that have no area.

Glossary
--------
frame       the samples added: two before the first on each axis, one behind the last. (Two, so that
            a split of cells that repeats itself after two begins where it did.)
present     of a sample: neither in the frame nor absent
cap         the triangles that have a corner at a sample, moved there
inner       of a vertex: inside a cell, on none of its edges

Invariants
----------
A method that is closed away from the border gives a closed mesh; triangles in cells whose samples
are all present are the ones it drew without caps. On each square of the border a cap's polygons are
convex: their corners are corners of the square and at most one point on each of its sides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from isoref.attributes import cells_of_samples
from isoref.degenerate import crowded_edges, fans, three_corners
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
# As many times lower than the range of the samples, an outside one is crossed at the inside one.
DEEP = 2.0**60


@in_space
def capped(
    method: Callable[..., Mesh],
    field: Field,
    isovalue: float,
    provenance: bool = False,
    absent: Booleans | None = None,
) -> Mesh:
    """The method's surface, closed on the border of the volume and beside absent samples.

    Parameters
    ----------
    method : of `isoref.methods.METHODS`, or any that gives the provenance of its mesh
    field : one value a sample on a lattice (N1, N2, N3)
    isovalue : in the unit of the samples
    provenance : keep it. A vertex of a cap stands at a sample, which is both its ends; a triangle
        of a cap belongs to the cell that it closes, or to the one with an absent corner in which it
        was drawn (so what is interpolated at an inner vertex there takes all eight corners)
    absent : (N1, N2, N3), which samples do not count, whatever number stands there

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
    gone = np.zeros(field.shape, np.bool_) if absent is None else absent.reshape(field.shape)
    framed = Field.of(framed_samples(field.values.reshape(field.shape), alpha, gone), dimension=3)
    present = np.pad(~gone, [(BEFORE, BEHIND)] * 3)
    drawn = method(framed, alpha, provenance=True)
    if gone.any() and (drawn.traced().ends[:, 1] < 0).all():
        # A dual method's vertices stand between crossings, which must be at inside samples.
        drawn = method(_deepened(framed, present, alpha), alpha, provenance=True)
    moved = _moved(drawn, present)

    # Make one vertex of all that have come to one sample.
    names = _unharmed(drawn, moved.names) if gone.any() else moved.names
    own, number = np.unique(names, return_inverse=True)
    first = np.full(len(own), len(number))
    np.minimum.at(first, number, np.arange(len(number)))
    triangles = number[drawn.simplices]
    kept = three_corners(triangles)

    mesh = Mesh(field.position(moved.index[first]), triangles[kept])
    if not provenance:
        return mesh
    found = drawn.traced()
    cells = _real_cells(found.cells[kept], framed.shape)
    return Mesh(
        mesh.vertices, mesh.simplices, Provenance(moved.ends[first], moved.t[first], cells, field)
    )


def framed_samples(values: Array, isovalue: float, absent: Booleans | None = None) -> Array:
    """The samples in a frame of outside ones, of a wider type where theirs has none outside.

    Absent samples are outside too.

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
    framed = np.pad(values, [(BEFORE, BEHIND)] * 3, constant_values=outside)
    if absent is not None:
        framed[tuple(slice(BEFORE, n - BEHIND) for n in framed.shape)][absent] = outside
    return framed


def _deepened(framed: Field, present: Booleans, alpha: float) -> Field:
    """The same sides, with samples that are not present so low that crossings are not near them.

    They are at the inside sample instead, but for values near the largest number.
    """
    # Keep each sample on its side where the isovalue is finer than double precision tells.
    inside, values = inside_samples(framed, alpha), framed.values.astype(np.float64)
    low = float(np.nextafter(alpha, -np.inf))
    values = np.where(inside, np.maximum(values, alpha), np.minimum(values, low))
    with np.errstate(over="ignore"):
        deep = float(alpha - DEEP * np.abs(values - alpha).max())
    deep = min(max(deep, -np.finfo(np.float64).max / 4), low)
    return framed.with_values(np.where(present, values, deep))


@dataclass(frozen=True, eq=False)
class _Moved:
    """The vertices of the framed volume, moved where they were beside samples not present.

    index : (V, 3) fractional indices in the volume without its frame
    names : (V,) vertices of one name have come to one sample, whose number it is where it is one
    ends, t : as of `Provenance`, without the frame
    """

    index: Floats
    names: Integers
    ends: Integers
    t: Floats


def _moved(drawn: Mesh, present: Booleans) -> _Moved:
    """The vertices of a mesh that was drawn on a framed volume of these present samples."""
    found = drawn.traced()
    shape = tuple(n - BEFORE - BEHIND for n in present.shape)
    low, high = (_without_frame(end, present.shape) for end in found.ends.T)
    inner = found.ends[:, 1] < 0

    # Go to the end that is present, where the other is not.
    there = [present.reshape(-1)[np.maximum(end, 0)] for end in found.ends.T]
    at_sample = ~inner & ~(there[0] & there[1])
    sample = np.where(there[0][:, None], low, high)
    low, high = (np.where(at_sample[:, None], sample, end) for end in (low, high))
    t = np.where(at_sample, 0.0, found.t)
    index = low + np.where(inner, 0.0, t)[:, None] * (high - low)
    numbers = np.stack([_flat(low, shape), _flat(high, shape)], axis=1)
    names = np.where(at_sample, numbers[:, 0], np.arange(len(t)) + int(np.prod(shape)))

    # Keep what was drawn inside cells in the volume, and in the middle of its neighbours there.
    index[inner] = np.clip(drawn.vertices[inner] - BEFORE, 0, np.array(shape) - 1)
    if not inner.all():
        closing = cells_of_samples(~present)[
            tuple(np.minimum(low + BEFORE, np.array(present.shape) - 2).T)
        ]
        _follow(drawn.simplices, inner & closing, inner, index, names)
        to_sample = inner & (names < np.prod(shape))
        numbers[to_sample] = names[to_sample, None]
        t[to_sample] = 0.0
        inner &= ~to_sample
    numbers[inner, 0] = _flat(np.minimum(low[inner], np.array(shape) - 2), shape)
    numbers[inner, 1] = -1
    return _Moved(index, names, numbers, t)


def _follow(
    triangles: Integers, closing: Booleans, inner: Booleans, index: Floats, names: Integers
) -> None:
    """Inner vertices of cells that close stand in the middle of their neighbours on edges.

    Where the neighbours have come to two places or one, the polygon has shrunk to a segment: the
    vertex goes to an end of it that is a sample.
    """
    pairs = triangles[:, [0, 1, 1, 2, 2, 0, 1, 0, 2, 1, 0, 2]].reshape(-1, 2)
    pairs = np.unique(pairs[closing[pairs[:, 0]] & ~inner[pairs[:, 1]]], axis=0)
    if not len(pairs):
        return
    which, row, count = np.unique(pairs[:, 0], return_inverse=True, return_counts=True)
    middle = np.zeros((len(which), 3))
    np.add.at(middle, row, index[pairs[:, 1]])
    index[which] = middle / count[:, None]

    # Find the places of the neighbours, the samples among them first.
    places, first = np.unique(
        np.stack([row, names[pairs[:, 1]]], axis=1), axis=0, return_index=True
    )
    starts = np.searchsorted(places[:, 0], np.arange(len(which)))
    shrunk = np.diff(np.append(starts, len(places))) < 3
    ends = pairs[first[starts[shrunk]], 1]
    index[which[shrunk]], names[which[shrunk]] = index[ends], names[ends]


def _unharmed(drawn: Mesh, names: Integers) -> Integers:
    """Names for which making one vertex of all of a name does no harm to a manifold.

    Only vertices that edges of the mesh join at one sample get one name. Then, until nothing is
    left to mend, names at crowded edges and pinched vertices, or next to them, are given up.
    """
    single = np.arange(len(names))
    labels = _joined(drawn.simplices, names)
    while (merged := np.bincount(labels, minlength=len(names))[labels] > 1).any():
        # Look at the triangles round what was merged, and what is beside it.
        near = np.zeros(len(names), np.bool_)
        near[labels[drawn.simplices[merged[drawn.simplices].any(axis=1)]]] = True
        rows = labels[drawn.simplices]
        rows = rows[near[rows].any(axis=1) & three_corners(rows)]
        bad = _harmed(rows, near)
        wrong = merged & bad[labels]
        if not wrong.any():
            break
        labels = np.where(wrong, single, labels)
    return labels


def _joined(triangles: Integers, names: Integers) -> Integers:
    """(V,) the first of the vertices of one name that edges join to each vertex."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    pairs = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    pairs = pairs[names[pairs[:, 0]] == names[pairs[:, 1]]]
    size = len(names)
    graph = coo_array((np.ones(len(pairs), np.bool_), tuple(pairs.T)), shape=(size, size))
    _, number = connected_components(graph, directed=False)
    _, first = np.unique(number, return_index=True)
    return np.asarray(first[number])


def _harmed(triangles: Integers, near: Booleans) -> Booleans:
    """Which vertices are at a crowded edge, or pinched, or joined to one that is pinched."""
    bad = np.zeros(len(near), np.bool_)
    edges = crowded_edges(triangles)
    bad[edges[near[edges].all(axis=1)]] = True
    pinched = near & (fans(triangles, len(near)) > 1)
    bad[triangles[pinched[triangles].any(axis=1)]] = True
    return bad


def _without_frame(framed: Integers, shape: tuple[int, ...]) -> Integers:
    """(V, 3) the indices of samples of the framed volume, counted from the first of the volume."""
    return np.stack(np.unravel_index(np.maximum(framed, 0), shape), axis=1) - BEFORE


def _flat(index: Integers, shape: tuple[int, ...]) -> Integers:
    """(V,) the flat index of the sample of the volume that is nearest to each (V, 3)."""
    nearest = np.clip(index, 0, np.array(shape) - 1)
    return np.asarray(np.ravel_multi_index(tuple(nearest.T), shape))


def _real_cells(cells: Integers, framed: tuple[int, ...]) -> Integers:
    """The cells without the frame, each cell beyond the border replaced by the one beside it."""
    shape = tuple(n - BEFORE - BEHIND for n in framed)
    index = np.unravel_index(np.maximum(cells, 0), tuple(n - 1 for n in framed))
    inner = [np.clip(i - BEFORE, 0, n - 2) for i, n in zip(index, shape, strict=True)]
    flat = np.ravel_multi_index(inner, tuple(n - 1 for n in shape))
    return np.asarray(np.where(cells < 0, -1, flat))
