"""Attributes: what a surface carries from the lattice it was drawn on.

A vertex on an edge between samples A and B knows more than its position: at parameter t it is worth
``(1 - t) A + t B`` of whatever is known at samples, be it another field, a colour or a gradient::

        A                       B
        o-----------x-----------o        value  (1 - t) a + t b
        0           t           1

A vertex inside a cell gets the trilinear interpolant of the cell's corners at its place. And a
triangle that knows its cell takes the cell's number, or is left out where the cell is. All of it
needs the mesh's `isoref.mesh.Provenance`, so extract with ``provenance=True``.

Glossary
--------
ends, t     of a vertex: the two samples it lies between, and where
central     of a sample: half the difference of its two neighbours along an axis; at the border of
            the lattice the difference to the only one, and 0 along an axis of one sample
J           (n, n) the affine map's matrix: position = J index + origin
region      of a mesh: the simplices that can be reached from one of them through shared vertices

Invariants
----------
Everything is computed for the samples that the mesh asks for, never for the whole volume.
Gradients are those of space: of a field with directions, along x, y and z, not along its axes.

References
----------
[1] W. E. Lorensen, H. E. Cline, "Marching cubes", SIGGRAPH 1987, section 4: central differences at
    the samples, interpolated along the edges. (They interpolate unit normals; here, as in VTK,
    gradients are interpolated and made units at last.)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from isoref.field import Array, Booleans, Field, FieldError, Floats, Integers
from isoref.mesh import Mesh, Provenance


def values(mesh: Mesh, samples: ArrayLike) -> Floats:
    """What is known at the samples of the mesh's lattice, interpolated at its vertices.

    Parameters
    ----------
    mesh : with provenance
    samples : (N1, .., Nn) numbers, or (m, N1, .., Nn) for m of them a sample, as for colours

    Returns
    -------
    (V,), or (V, m) for m numbers a sample

    Raises
    ------
    FieldError
        for a mesh without provenance, or samples of another shape than its lattice's.

    >>> from isoref import extract
    >>> mesh = extract([[[1, 0], [0, 0]], [[0, 0], [0, 0]]], 0.75, provenance=True)
    >>> values(mesh, 10 * np.arange(8).reshape(2, 2, 2)).tolist()
    [10.0, 5.0, 2.5]
    """
    field = _on_the_lattice(mesh, samples)
    flat = field.values.reshape(field.components, -1)
    at_vertices = _interpolated(mesh, lambda which: flat[:, which].T)
    return at_vertices if field.values.ndim > field.dimension else at_vertices[:, 0]


def gradients(mesh: Mesh, samples: ArrayLike | None = None) -> Floats:
    """(V, n) the gradient at the mesh's vertices, in space.

    At samples it is ``J^-T c``, where c holds the central differences along the axes, and between
    them it is interpolated, after Lorensen and Cline [1]; this is VTK's scheme.

    Parameters
    ----------
    mesh : with provenance
    samples : (N1, .., Nn) numbers; by default those that the mesh was drawn of

    Raises
    ------
    FieldError
        as of `values`, and for several numbers a sample.
    """
    own = mesh.traced().field
    field = own if samples is None else _on_the_lattice(mesh, samples)
    if field.components != 1:
        raise FieldError(f"a gradient is that of one component, and there are {field.components}")
    inverse = np.linalg.inv(own.affine[:-1, :-1])
    along_axes = _interpolated(mesh, lambda which: central(field, which))
    return np.asarray(along_axes @ inverse)


def normals(mesh: Mesh) -> Floats:
    """(V, n) unit vectors against the gradient of the field the mesh was drawn of: high to low.

    Where the gradient vanishes there is no such vector, and the row is 0.
    """
    slopes = gradients(mesh)
    lengths = np.linalg.norm(slopes, axis=1, keepdims=True)
    return np.asarray(-np.divide(slopes, lengths, out=np.zeros_like(slopes), where=lengths > 0))


def central(field: Field, which: Integers) -> Floats:
    """(P, n) the central differences of a scalar field at the samples with these numbers (P,).

    >>> central(Field.of([0.0, 1.0, 4.0, 9.0]), np.arange(4)).tolist()
    [[1.0], [2.0], [4.0], [5.0]]
    """
    samples = field.values.reshape(field.shape)
    index = np.unravel_index(which, field.shape)
    differences = np.zeros((len(which), field.dimension))
    for axis, n in enumerate(field.shape):
        below, above = (
            tuple(
                np.clip(i + (a == axis) * step, 0, m - 1)
                for a, (i, m) in enumerate(zip(index, field.shape, strict=True))
            )
            for step in (-1, 1)
        )
        if n > 1:
            rise = samples[above].astype(np.float64) - samples[below].astype(np.float64)
            differences[:, axis] = rise / (above[axis] - below[axis])
    return differences


def without_cells(mesh: Mesh, absent: ArrayLike) -> Mesh:
    """The part of a mesh that lies in cells that are not absent; its boundary is theirs.

    Parameters
    ----------
    mesh : with provenance, which is kept
    absent : (N1 - 1, .., Nn - 1) booleans, one a cell; see `cells_of_samples`

    A simplex of a dual method is left out where any of its vertices is in an absent cell. Nothing
    is added: on the border of what is left the mesh has boundary edges, as at the border of the
    lattice, and stays a manifold except where two pieces touch in a vertex alone.

    Raises
    ------
    FieldError
        for another shape than that of the lattice of cells.
    """
    found = mesh.traced()
    gone = _a_cell_each(absent, found).astype(np.bool_)
    inside = found.ends[:, 1] < 0
    in_gone = np.zeros(len(mesh.vertices), np.bool_)
    lowest = np.unravel_index(found.ends[inside, 0], found.field.shape)
    in_gone[inside] = gone[lowest]
    left_out = np.where(
        found.cells >= 0,
        gone.reshape(-1)[np.maximum(found.cells, 0)] if gone.size else False,
        in_gone[mesh.simplices].any(axis=1),
    )
    return only(mesh, ~left_out)


def of_cells(mesh: Mesh, numbers: ArrayLike) -> Array:
    """(S,) what stands in an array over the cells, for the cell of each simplex.

    Raises
    ------
    FieldError
        for another shape than that of the lattice of cells, or for a dual method's mesh, whose
        simplices lie in several cells.
    """
    found = mesh.traced()
    table = _a_cell_each(numbers, found)
    if (found.cells < 0).any():
        raise FieldError("a triangle of a dual method lies in several cells: ask its vertices")
    return np.asarray(table.reshape(-1)[found.cells])


def cells_of_samples(absent: ArrayLike) -> Booleans:
    """Which cells have at least one absent sample at a corner.

    >>> cells_of_samples([[True, False, False], [False, False, False]]).tolist()
    [[True, False]]
    """
    marked = np.asarray(absent, np.bool_)
    for axis in range(marked.ndim):
        low = (slice(None),) * axis + (slice(None, -1),)
        high = (slice(None),) * axis + (slice(1, None),)
        marked = marked[low] | marked[high]
    return marked


def filled(samples: ArrayLike, absent: bool | ArrayLike = True) -> tuple[Array, Booleans]:
    """The samples with a number in place of each absent one, and which are absent.

    Parameters
    ----------
    samples : numbers, in a masked array or any other
    absent : True for samples that are not finite, or masked; or booleans of the samples' shape,
        True for those that are absent too

    Which number stands in for an absent sample does not matter once `without_cells` has left out
    every cell that it is a corner of.

    Raises
    ------
    FieldError
        for booleans of another shape.

    >>> filled([1.0, np.nan, 3.0])
    (array([1., 1., 3.]), array([False,  True, False]))
    """
    given = np.ma.getdata(samples) if isinstance(samples, np.ma.MaskedArray) else samples
    numbers = np.asarray(given)
    gone = np.ma.getmaskarray(samples) if isinstance(samples, np.ma.MaskedArray) else None
    gone = np.zeros(numbers.shape, np.bool_) if gone is None else gone.copy()
    if numbers.dtype.kind == "f":
        gone |= ~np.isfinite(numbers)
    marked = np.asarray(absent)
    if marked.ndim:
        if marked.shape != numbers.shape:
            raise FieldError(
                f"absent has shape {marked.shape}, and the samples have {numbers.shape}"
            )
        gone |= marked.astype(np.bool_)
    if not gone.any():
        return numbers, gone
    present = numbers[~gone]
    stand_in = present[:1] if len(present) else np.zeros(1, numbers.dtype)
    return np.where(gone, stand_in, numbers), gone


def regions(mesh: Mesh) -> Integers:
    """(S,) the number of the region each simplex belongs to, 0 the one of most simplices.

    Regions of equally many are numbered by their first simplex.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(mesh.vertices)
    rows = np.repeat(mesh.simplices[:, :1], mesh.dimension, axis=1).ravel()
    joined = coo_array(
        (np.ones(len(rows)), (rows, mesh.simplices[:, 1:].ravel())), shape=(count, count)
    )
    _, of_vertex = connected_components(joined, directed=False)
    of_simplex = of_vertex[mesh.simplices[:, 0]]
    _, first, own, sizes = np.unique(
        of_simplex, return_index=True, return_inverse=True, return_counts=True
    )
    rank = np.empty(len(first), np.int64)
    rank[np.lexsort([first, -sizes])] = np.arange(len(first))
    return np.asarray(rank[own])


def only(mesh: Mesh, kept: Booleans) -> Mesh:
    """The mesh of the simplices marked by `kept` (S,), on the vertices that they use.

    >>> only(Mesh.of(np.eye(4), [[0, 1], [2, 3]]), np.array([False, True])).simplices.tolist()
    [[0, 1]]
    """
    simplices = mesh.simplices[kept]
    used = np.zeros(len(mesh.vertices), np.bool_)
    used[simplices] = True
    number = np.cumsum(used) - 1
    found = mesh.provenance
    if found is not None:
        found = replace(found, ends=found.ends[used], t=found.t[used], cells=found.cells[kept])
    whole = mesh.simplices.dtype
    return Mesh(mesh.vertices[used], number[simplices].astype(whole, copy=False), found)


def _on_the_lattice(mesh: Mesh, samples: ArrayLike) -> Field:
    """These samples where those stand that the mesh was drawn of."""
    own, given = mesh.traced().field, np.asarray(samples)
    if own.shape not in (given.shape, given.shape[1:]):
        raise FieldError(
            f"the mesh comes from a lattice of {own.shape} samples, and there are {given.shape}"
        )
    return own.with_values(given)


def _a_cell_each(given: ArrayLike, found: Provenance) -> Array:
    """An array that has something for each cell of the mesh's lattice."""
    table, cells = np.asarray(given), tuple(n - 1 for n in found.field.shape)
    if table.shape != cells:
        raise FieldError(f"an array of shape {table.shape} does not fit {cells} cells")
    return table


def _interpolated(mesh: Mesh, at: Callable[[Integers], Array]) -> Floats:
    """(V, r) what `at` gives for samples, (P,) -> (P, r), interpolated at the vertices."""
    found = mesh.traced()
    on_edge = found.ends[:, 1] >= 0
    first = at(np.where(on_edge, found.ends[:, 0], 0)).astype(np.float64)
    second = at(np.where(on_edge, found.ends[:, 1], 0)).astype(np.float64)
    t = np.where(on_edge, found.t, 0.0)[:, None]
    result = np.asarray((1 - t) * first + t * second)

    # Weigh the corners of the cells that have vertices inside.
    rows = np.flatnonzero(~on_edge)
    shape = found.field.shape
    lowest = np.stack(np.unravel_index(found.ends[rows, 0], shape), axis=1)
    inner = found.field.index(mesh.vertices[rows]) - lowest
    result[rows] = 0.0
    for corner in product((0, 1), repeat=len(shape)):
        weight = np.where(corner, inner, 1 - inner).prod(axis=1)
        which = np.ravel_multi_index(tuple((lowest + corner).T), shape)
        result[rows] += weight[:, None] * at(np.asarray(which))
    return result
