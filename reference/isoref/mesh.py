"""Meshes: simplices on shared vertices.

Every algorithm of this package ends in a `Mesh`: points, segments, triangles, tetrahedra, ..
in a space of any dimension.

Glossary
--------
d       dimension of the space the vertices live in
k       dimension of the simplices: 1 segments, 2 triangles, 3 tetrahedra
V, S    number of vertices and of simplices

Invariants
----------
Vertices are float64 (V, d), simplices are int64 (S, k + 1), every index is in range. Where single
precision was asked for they are float32 and int32. A triangle's right-hand normal points from
inside to outside, from high values to low ones.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import wraps
from typing import Any, Literal, ParamSpec

import numpy as np
from numpy.typing import ArrayLike

from isoref.field import Field, FieldError, Floats, Integers

Given = ParamSpec("Given")
Precision = Literal["single", "double"]

#: What vertices and simplices are made of.
NUMBER_TYPES: dict[str, tuple[type[Any], type[Any]]] = {
    "single": (np.float32, np.int32),
    "double": (np.float64, np.int64),
}


def number_types(precision: str, vertices: int = 0) -> tuple[type[Any], type[Any]]:
    """What vertices and simplices are made of in this precision.

    Raises
    ------
    FieldError
        for another precision, or more vertices than its integers can number.

    >>> [kind.__name__ for kind in number_types("single")]
    ['float32', 'int32']
    """
    if precision not in NUMBER_TYPES:
        raise FieldError(f"precision {precision!r} is not one of {', '.join(NUMBER_TYPES)}")
    real, whole = NUMBER_TYPES[precision]
    if vertices - 1 > np.iinfo(whole).max:
        raise FieldError(f"{vertices:,} vertices are too many for {whole.__name__}; take double")
    return real, whole


@dataclass(frozen=True, eq=False)
class Provenance:
    """Where each vertex and each simplex of a mesh comes from, on the lattice of a field.

    Samples and cells are named by their flat indices (C order), in the lattice of samples
    (N1, .., Nn) and in that of cells (N1 - 1, .., Nn - 1).

    Attributes
    ----------
    ends : (V, 2) the samples between which a vertex lies, the lower number first; the edge between
        them is one of the lattice, or a diagonal where a method cuts cells into simplices. For a
        vertex inside a cell, the cell's lowest sample and -1
    t : (V,) where on that edge it lies, from 0 at the first end to 1 at the second; NaN inside a
        cell
    cells : (S,) the cell in which a simplex lies; -1 for simplices of a dual method, which lie
        across a lattice edge and in the cells of their vertices
    field : what the mesh was drawn of; its samples are held, not copied
    """

    ends: Integers
    t: Floats
    cells: Integers
    field: Field

    @classmethod
    def empty(cls, field: Field) -> Provenance:
        """That of no vertices and no simplices."""
        return cls(np.empty((0, 2), np.int64), np.empty(0), np.empty(0, np.int64), field)


@dataclass(frozen=True, eq=False)
class Mesh:
    """Simplices on shared vertices.

    Attributes
    ----------
    vertices : (V, d) float64
    simplices : (S, k + 1) int64, rows of indices into `vertices`
    provenance : where they come from, where it was asked for, else None
    """

    vertices: Floats
    simplices: Integers
    provenance: Provenance | None = None

    @classmethod
    def of(cls, vertices: ArrayLike, simplices: ArrayLike) -> Mesh:
        """The mesh of these arrays, its shapes and index range checked.

        Raises
        ------
        ValueError
            for arrays that are not two-dimensional or an index out of range.

        >>> Mesh.of([[0, 0], [1, 0]], [[0, 1]])
        Mesh(2 vertices in R^2, 1 simplices of dimension 1)
        """
        points = np.asarray(vertices, np.float64)
        cells = np.asarray(simplices, np.int64)
        if points.ndim != 2 or cells.ndim != 2:
            raise ValueError(
                f"vertices {points.shape} and simplices {cells.shape} must have two axes each"
            )
        if cells.size and not (0 <= cells.min() and cells.max() < len(points)):
            raise ValueError(
                f"simplices use indices {cells.min()} to {cells.max()}, "
                f"but there are {len(points)} vertices"
            )
        return cls(points, cells)

    @classmethod
    def empty(cls, d: int, k: int) -> Mesh:
        """No simplices of dimension k in R^d.

        >>> Mesh.empty(3, 2)
        Mesh(0 vertices in R^3, 0 simplices of dimension 2)
        """
        return cls(np.empty((0, d)), np.empty((0, k + 1), np.int64))

    def in_precision(self, precision: Precision) -> Mesh:
        """The same mesh of these number types, positions rounded; errors as of `number_types`.

        >>> Mesh.empty(3, 2).in_precision("single").vertices.dtype
        dtype('float32')
        """
        real, whole = number_types(precision, len(self.vertices))
        vertices = self.vertices.astype(real, copy=False)
        return replace(self, vertices=vertices, simplices=self.simplices.astype(whole, copy=False))

    def placed(self, field: Field) -> Mesh:
        """The mesh of ``field.straight()`` where the field stands in space.

        Where space sees a mirror image, each simplex is turned, so that its orientation says again
        what it says of a straight field (for triangles, normals from high values to low ones).
        """
        if field.directions is None:
            return self
        vertices = field.placed(self.vertices).astype(self.vertices.dtype, copy=False)
        simplices = self.simplices
        if field.handedness < 0 and self.dimension > 0:
            simplices = np.concatenate([simplices[:, :-2], simplices[:, :-3:-1]], axis=1)
        return replace(self, vertices=vertices, simplices=simplices).drawn_of(field)

    def drawn_of(self, field: Field) -> Mesh:
        """The same mesh; its provenance, where it has one, names this field."""
        if self.provenance is None:
            return self
        return replace(self, provenance=replace(self.provenance, field=field))

    def traced(self) -> Provenance:
        """The provenance, or a FieldError where it was not asked for."""
        if self.provenance is None:
            raise FieldError("this needs the mesh's provenance: extract it with provenance=True")
        return self.provenance

    @property
    def dimension(self) -> int:
        """k, the dimension of the simplices."""
        return int(self.simplices.shape[1]) - 1

    def __repr__(self) -> str:
        return (
            f"Mesh({len(self.vertices)} vertices in R^{self.vertices.shape[1]}, "
            f"{len(self.simplices)} simplices of dimension {self.dimension})"
        )

    def canonical(self) -> Mesh:
        """The same oriented mesh, numbered independently of how it was made; no provenance.

        Vertices are sorted by position (those that coincide keep their order), each simplex
        starts at its smallest vertex and keeps its orientation, and simplices are sorted.
        Segments and triangles only: a larger simplex is sorted whole, with its sign in the order
        of its last two vertices.
        """
        order = np.lexsort(self.vertices.T[::-1])
        rank = np.empty_like(order)
        rank[order] = np.arange(len(order))
        cells = rank[self.simplices]
        if self.dimension == 2 and len(cells):
            start = cells.argmin(axis=1)[:, None]
            cells = np.take_along_axis(cells, (start + np.arange(3)) % 3, axis=1)
        elif self.dimension > 2 and len(cells):
            cells = _sorted_with_sign(cells)
        return Mesh(self.vertices[order], cells[np.lexsort(cells.T[::-1])])


def _sorted_with_sign(cells: Integers) -> Integers:
    """Rows sorted; the last two entries swapped where sorting was an odd permutation."""
    order = np.argsort(cells, axis=1)
    inversions = sum(
        (order[:, i] > order[:, j]).astype(np.int64)
        for i in range(order.shape[1])
        for j in range(i + 1, order.shape[1])
    )
    ordered = np.take_along_axis(cells, order, axis=1)
    odd = np.asarray(inversions) % 2 == 1
    ordered[odd, -2:] = ordered[odd, -2:][:, ::-1]
    return ordered


def in_space(extract: Callable[Given, Mesh]) -> Callable[Given, Mesh]:
    """An extractor for straight fields, made to serve fields that have directions too.

    It is called with the straight field, and what it draws is placed. So the articles need know
    nothing of directions, and topology and vertices along the lattice's axes do not depend on them.
    """

    @wraps(extract)
    def placed(*args: Given.args, **kwargs: Given.kwargs) -> Mesh:
        fields = [one for one in (*args, *kwargs.values()) if isinstance(one, Field)]
        if not fields or fields[0].directions is None:
            return extract(*args, **kwargs)
        straight = [one.straight() if isinstance(one, Field) else one for one in args]
        named = {
            name: one.straight() if isinstance(one, Field) else one for name, one in kwargs.items()
        }
        mesh: Mesh = extract(*straight, **named)  # type: ignore[arg-type]
        return mesh.placed(fields[0])

    return placed
