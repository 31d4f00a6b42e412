"""Surfaces larger than memory: a volume that stays in its file, a mesh that is written as it comes.

A cube rule looks at two planes of samples at a time, and its sweep numbers each crossing once, when
the lattice edge it lies on is first met (`isoref.fast.sweep`). So neither the volume nor the mesh
has to be there whole::

    volume      in a file: numpy.memmap, a zarr array, an HDF5 dataset
      |         a block of planes is read, checked, and let go
    sweep       a slab of planes, and the numbers of the crossings on its last plane
      |         a piece of the mesh, and let go
    mesh        to a file, a database, a viewer

A piece is no mesh: its triangles also use vertices of pieces before it. All pieces, one after
another, are the mesh that `isoref.fast.sweep.sweep` makes of the whole, bit by bit; so they are
welded where they meet, and closed where it is.

Glossary
--------
source      an array that is read by planes: it has a shape, a dtype, and slices
chunk       planes that a file keeps together, so that reading one costs as much as reading all

>>> ball = Field.of(10.0 - np.linalg.norm(np.indices((24, 24, 24)) - 11.5, axis=0))
>>> pieces = list(slabs(ball.values, 0.0))
>>> sum(len(piece.vertices) for piece in pieces), sum(len(piece.simplices) for piece in pieces)
(1896, 3788)
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, cast

import numpy as np
from numpy.typing import ArrayLike

from isoref import asymptotic_decider
from isoref.fast.sweep import pieces
from isoref.field import Array, Field, FieldError, Integers, check_finite, check_isovalue
from isoref.mesh import Mesh, Precision
from isoref.rule import Rule
from isoref.sweep import check_volume


class Source(Protocol):
    """Samples on a 3-D lattice that are read plane by plane."""

    @property
    def shape(self) -> tuple[int, ...]:
        """(N1, N2, N3)."""
        ...

    @property
    def dtype(self) -> np.dtype[Any]:
        """The type of a sample."""
        ...

    def __getitem__(self, planes: slice, /) -> Any:
        """The samples of these planes, or what NumPy makes an array of them from."""
        ...


@dataclass(frozen=True, eq=False)
class Slab:
    """What a part of the volume adds to a surface.

    Attributes
    ----------
    first : how many vertices came before
    vertices : (V, 3) positions of those that are new
    simplices : (T, 3) triangles, oriented as in `Mesh`, by numbers of all vertices so far
    """

    first: int
    vertices: Array
    simplices: Integers


def slabs(
    source: Source,
    isovalue: float,
    spacing: float | Sequence[float] | None = None,
    origin: Sequence[float] | None = None,
    *,
    directions: ArrayLike | None = None,
    rule: Rule = asymptotic_decider.RULE,
    precision: Precision = "double",
) -> Iterator[Slab]:
    """The rule's surface piece by piece, identical to that of the whole volume.

    Parameters
    ----------
    source : (N1, N2, N3) real numbers that may stay in a file
    isovalue : in the unit of the samples
    spacing, origin, directions : of the lattice, as of `isoref.field.Field.of`
    rule : of a cube (`isoref.methods.RULES`)
    precision : "double" or "single", as of `isoref.methods.extract`

    Raises
    ------
    FieldError
        where `Field.of` would: at once for the lattice and the isovalue, for a sample that is not
        finite when its plane is read; and where single precision cannot number the vertices.
    """
    lattice = lattice_of(source, spacing, origin, directions)
    if 0 in source.shape:
        raise FieldError(f"an array of shape {source.shape} has no samples")
    field = replace(lattice, values=cast(Array, _Planes(source)))
    straight = field.straight()
    check_volume(straight)
    return _placed(pieces(rule, straight, check_isovalue(isovalue), precision), field)


def lattice_of(
    source: Source,
    spacing: float | Sequence[float] | None,
    origin: Sequence[float] | None,
    directions: ArrayLike | None,
) -> Field:
    """The place in space of a source, whose samples are not read: a field of one sample.

    Raises `FieldError` for a source that is no volume of real numbers, and as `Field.of`.
    """
    if len(source.shape) != 3:
        raise FieldError(f"an array of shape {source.shape} is no volume, which has three axes")
    return Field.of(np.zeros((1, 1, 1), source.dtype), spacing, origin, directions=directions)


def _placed(parts: Iterator[tuple[Array, Array]], field: Field) -> Iterator[Slab]:
    """The pieces where the field stands in space, with the number of vertices before each."""
    first = 0
    for vertices, triangles in parts:
        mesh = Mesh(vertices, triangles).placed(field)
        yield Slab(first, mesh.vertices, mesh.simplices)
        first += len(vertices)


class _Planes:
    """A source that gives checked arrays, and reads each chunk once."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.shape, self.dtype = tuple(source.shape), np.dtype(source.dtype)
        self.ndim = 3
        chunks = getattr(source, "chunks", None)
        self.depth = int(chunks[0]) if chunks else 0
        self.blocks: dict[int, Array] = {}

    def __getitem__(self, planes: slice) -> Array:
        """The samples of these planes, which climb, as `slabs` asks for them."""
        start, stop, _ = planes.indices(self.shape[0])
        if not self.depth:
            return self._read(start, stop)

        # Keep the chunks that these planes lie in, and no others.
        needed = range(start // self.depth, (stop - 1) // self.depth + 1)
        self.blocks = {
            n: self.blocks[n]
            if n in self.blocks
            else self._read(n * self.depth, min((n + 1) * self.depth, self.shape[0]))
            for n in needed
        }
        parts = [
            block[max(start - n * self.depth, 0) : stop - n * self.depth]
            for n, block in self.blocks.items()
        ]
        return parts[0] if len(parts) == 1 else np.concatenate(parts)

    def _read(self, start: int, stop: int) -> Array:
        """The samples of these planes, each a finite number; else a FieldError."""
        samples = np.asarray(self.source[start:stop])
        check_finite(samples, start)
        return samples
