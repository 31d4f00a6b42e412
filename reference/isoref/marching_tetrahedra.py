r"""Marching tetrahedra: nothing ambiguous is left once a cell is cut into tetrahedra.

A function that is linear on a tetrahedron is fixed by its values at the four corners. Where one
corner is on the other side than the rest, the surface is a triangle; where there are two and two,
a quadrilateral, cut into two triangles. That is the whole table::

        1 inside, 3 outside        2 inside, 2 outside

              3                          3
             /|\                        /|\             x   a crossed edge
            / | \                      x | x
           x  |  \                    /  x  \           0 and 1 are inside in the second
          /  \2   \                  /  /2\  \          drawing, 0 alone in the first
         / . x \ . \                / .    x .\
        0----x------1              0-----------1

The price is paid elsewhere. Vertices stand on the diagonals of faces and cells too, the mesh has
about twice the triangles of marching cubes, and the diagonals show in it: what is drawn is the
level set of another interpolant than the trilinear one, and which one depends on the split.

The split
---------
A `Split` says how cells are cut: a list of tetrahedra over a block of one or two cells an axis,
repeated over the lattice.

    kuhn    six round one body diagonal, all cells alike; the diagonals of all faces run from low
            to high. Bloomenthal and `isoref.kuhn` cut so.
    five    one tetrahedron in the middle and four corners cut off [1, 2]. Its mirror image is
            another split of the cube, and the two must alternate like the squares of a
            chessboard: the block has 2 x 2 x 2 cells.

The condition on a split is that the cells on either side of a face cut it along the *same*
diagonal. Five tetrahedra in all cells alike would cut it along both, and the surface would be torn
there. `Split.of` asks each triangle between two tetrahedra that it be whole on both sides.

`isoref.fast.marching_tetrahedra` is the vectorised twin. `isoref.simplicial` cuts Kuhn's simplices
in any dimension; in this one, both give the same mesh.

Glossary
--------
corner c        0 .. 7, of a cell (`isoref.cube`)
tetrahedron     four corners in the order of their lattice points (C order), and the sign of their
                orientation
block           how many cells a split is long along each axis before it repeats itself
pair (a, b)     the crossed edge from inside corner a to outside corner b
g               samples minus the isovalue; inside is g >= 0

Invariants
----------
Every vertex is the crossing of one edge of the split: of the lattice, of a face's diagonal or of a
cell's. Two triangles share it when they cross that edge, and only then. The mesh is a manifold,
closed away from the border of the lattice and oriented from high to low, whatever the samples are.

References
----------
[1] A. Doi, A. Koide, "An efficient method of triangulating equi-valued surfaces by using
    tetrahedral cells", IEICE Transactions E74(1), 1991.
[2] B. A. Payne, A. W. Toga, "Surface mapping brain function on 3D models", IEEE Computer Graphics
    and Applications 10(5), 1990: five tetrahedra, alternating.
[3] J. Bloomenthal, "An implicit surface polygonizer", Graphics Gems IV, 1994: six tetrahedra.
[4] C. Min, "Simplicial isosurfacing in arbitrary dimension and codimension", 2003, section 2.1.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import combinations, product
from typing import NamedTuple

import numpy as np

from isoref.cube import CORNER_OFFSETS, CORNERS, corner_at
from isoref.field import Field, FieldError, Floats, check_isovalue, inside_samples
from isoref.kuhn import chains
from isoref.mesh import Mesh, Provenance, in_space
from isoref.sweep import check_volume, crossing_parameter

Place = tuple[int, ...]
Pair = tuple[int, int]
Piece = tuple[Pair, Pair, Pair]


class Tetrahedron(NamedTuple):
    """Four corners of a cell, in the order of their lattice points, and their orientation.

    sign : +1 where the edges from the first corner to the others form a right-handed frame
    """

    corners: tuple[int, int, int, int]
    sign: int


# --------------------------------------------------------------------------------------------
# Splits
# --------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Split:
    """How the cells of a lattice are cut into tetrahedra.

    Build one with `Split.of`, which checks everything.

    name : as the catalogue knows it
    block : cells along each axis before the split repeats itself, 1 or 2
    cells : the tetrahedra of each cell of the block, in C order
    """

    name: str
    block: tuple[int, int, int]
    cells: tuple[tuple[Tetrahedron, ...], ...]

    @classmethod
    def of(
        cls, name: str, block: tuple[int, int, int], simplices: Iterable[Sequence[Place]]
    ) -> Split:
        """The split with these tetrahedra, each given by four lattice points of the block.

        Raises
        ------
        FieldError
            where a tetrahedron is flat or lies in more than one cell, where the tetrahedra do not
            fill the block, or where two cells do not cut their common face alike.

        >>> corner = [((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))]
        >>> Split.of("too little", (1, 1, 1), corner)
        Traceback (most recent call last):
        isoref.field.FieldError: the tetrahedra fill 1 sixth of 6 in a block of (1, 1, 1) cells
        """
        given = [tuple(sorted(tuple(map(int, p)) for p in simplex)) for simplex in simplices]
        _check_tetrahedra(block, given)
        _check_facets(block, given)
        found: dict[Place, list[Tetrahedron]] = {cell: [] for cell in np.ndindex(block)}
        for simplex in given:
            cell = tuple(np.min(simplex, axis=0).tolist())
            a, b, c, d = (corner_at(*np.subtract(p, cell).tolist()) for p in simplex)
            found[cell].append(Tetrahedron((a, b, c, d), int(np.sign(_sixths(simplex)))))
        return cls(name, block, tuple(tuple(found[cell]) for cell in np.ndindex(block)))

    def at(self, cell: Place) -> tuple[Tetrahedron, ...]:
        """The tetrahedra of a cell of the lattice."""
        i, j, k = (x % n for x, n in zip(cell, self.block, strict=True))
        return self.cells[(i * self.block[1] + j) * self.block[2] + k]


def _sixths(simplex: Sequence[Place]) -> int:
    """Six times the signed volume of a tetrahedron."""
    a, b, c, d = np.array(simplex)
    return round(float(np.linalg.det([b - a, c - a, d - a])))


def _check_tetrahedra(block: tuple[int, int, int], simplices: list[tuple[Place, ...]]) -> None:
    """Raise FieldError unless each tetrahedron is in one cell and they fill the block."""
    if len(block) != 3 or not set(block) <= {1, 2}:
        raise FieldError(f"a block of {block} cells: a split has 1 or 2 along each of 3 axes")
    for simplex in simplices:
        if len(simplex) != 4 or any(len(p) != 3 for p in simplex):
            raise FieldError(f"{simplex} is not four points of three coordinates")
        low, high = np.min(simplex, axis=0), np.max(simplex, axis=0)
        if not ((low >= 0) & (high <= block) & (high == low + 1)).all() or not _sixths(simplex):
            raise FieldError(f"{simplex} is no tetrahedron with corners of one cell of the block")
    filled, whole = sum(abs(_sixths(s)) for s in simplices), 6 * int(np.prod(block))
    if filled != whole:
        raise FieldError(
            f"the tetrahedra fill {filled} sixth of {whole} in a block of {block} cells"
        )


def _check_facets(block: tuple[int, int, int], simplices: list[tuple[Place, ...]]) -> None:
    """Raise FieldError unless each facet is one of two tetrahedra, on either side of it.

    The block repeats itself, so that a facet on one face of it is matched with one on the opposite.
    """
    sides: Counter[tuple[Place, ...]] = Counter()
    uses: Counter[tuple[Place, ...]] = Counter()
    for simplex in simplices:
        for i, apex in enumerate(simplex):
            facet = simplex[:i] + simplex[i + 1 :]
            # Move the facet to where its lowest coordinates are in the first block.
            back = np.min(facet, axis=0) // block * block
            name = tuple(tuple(np.subtract(p, back).tolist()) for p in facet)
            uses[name] += 1
            sides[name] += int(np.sign(_sixths((*facet, apex))))
    for facet, n in uses.items():
        if n != 2 or sides[facet] != 0:
            raise FieldError(
                f"the triangle {facet} is not whole on both sides: cells that share a face must "
                "cut it along the same diagonal"
            )


def _kuhn() -> Split:
    """Six tetrahedra round the diagonal from the lowest corner to the highest."""
    return Split.of("kuhn", (1, 1, 1), [[CORNERS[c] for c in chain] for chain in chains(3)])


def _five() -> Split:
    """In each cell the tetrahedron of the points with an even sum, and the four corners left over.

    A face then has its diagonal between its even points, whichever cell one looks from.
    """
    simplices = []
    for cell in product((0, 1), repeat=3):
        points = [tuple(np.add(cell, offset).tolist()) for offset in CORNERS]
        even = [p for p in points if sum(p) % 2 == 0]
        simplices.append(even)
        for odd in (p for p in points if sum(p) % 2 == 1):
            near = [p for p in even if np.abs(np.subtract(p, odd)).sum() == 1]
            simplices.append([odd, *near])
    return Split.of("five", (2, 2, 2), simplices)


KUHN = _kuhn()
FIVE = _five()


# --------------------------------------------------------------------------------------------
# The surface
# --------------------------------------------------------------------------------------------


@cache
def section(tetrahedron: Tetrahedron, signs: int) -> tuple[Piece, ...]:
    """The triangles of the surface in one tetrahedron of a cell, from the signs of its corners.

    >>> section(Tetrahedron((0, 4, 2, 1), -1), 0b00000001)
    (((0, 1), (0, 2), (0, 4)),)
    """
    within = [c for c in tetrahedron.corners if signs >> c & 1]
    without = [c for c in tetrahedron.corners if not signs >> c & 1]
    if not within or not without:
        return ()
    # Draw the pieces as for a right-handed row of inside corners, then outside ones.
    pieces: tuple[Piece, ...]
    if len(within) == 1:
        (a,), (p, q, r) = within, without
        pieces = (((a, p), (a, q), (a, r)),)
    elif len(within) == 3:
        (a, b, c), (p,) = within, without
        pieces = (((a, p), (b, p), (c, p)),)
    else:
        (a, b), (p, q) = within, without
        pieces = (((a, p), (b, q), (b, p)), ((a, p), (a, q), (b, q)))
    handed = tetrahedron.sign * _parity([tetrahedron.corners.index(c) for c in within + without])
    return pieces if handed > 0 else tuple((z, y, x) for x, y, z in pieces)


def _parity(order: Sequence[int]) -> int:
    """The sign of a permutation.

    >>> _parity([0, 1, 2, 3]), _parity([1, 0, 2, 3])
    (1, -1)
    """
    return 1 - 2 * (sum(a > b for a, b in combinations(order, 2)) % 2)


@in_space
def surface(split: Split, field: Field, isovalue: float, provenance: bool = False) -> Mesh:
    """The level set of the function that is linear on each tetrahedron, from high to low.

    Parameters
    ----------
    split : `KUHN`, `FIVE`, or one made by `Split.of`; its first block begins at the first sample
    field : one value a sample on a lattice (N1, N2, N3)
    isovalue : in the unit of the samples
    provenance : also say where vertices and triangles come from (`isoref.mesh.Provenance`)

    Raises
    ------
    FieldError
        for a field that is not a scalar volume, or an isovalue that is no finite number.

    >>> surface(KUHN, Field.of([[[1, 0], [0, 0]], [[0, 0], [0, 0]]]), 0.5)
    Mesh(7 vertices in R^3, 6 simplices of dimension 2)
    """
    check_volume(field)
    alpha = check_isovalue(isovalue)
    inside = inside_samples(field, alpha)
    g = field.values.astype(np.float64) - alpha
    vertices: list[Floats] = []
    number: dict[tuple[Place, Place], int] = {}
    ends: list[list[int]] = []
    parameters: list[float] = []
    triangles: list[list[int]] = []
    cells: list[int] = []

    for k, cell in enumerate(product(*(range(n - 1) for n in field.shape))):
        points = [tuple((cell + offset).tolist()) for offset in CORNER_OFFSETS]
        signs = sum(1 << c for c in range(8) if inside[points[c]])
        for tetrahedron in split.at(cell):
            for piece in section(tetrahedron, signs):
                # Number the crossings that no earlier tetrahedron has met.
                names = [(points[a], points[b]) for a, b in piece]
                for high, low in names:
                    if (high, low) not in number:
                        number[high, low] = len(vertices)
                        t = crossing_parameter(np.array(g[low]), np.array(g[high]))
                        vertices.append(field.position(low + t * np.subtract(high, low)))
                        ends.append(sorted((flat_index(high, field), flat_index(low, field))))
                        parameters.append(float(t if low < high else 1 - t))
                triangles.append([number[name] for name in names])
                cells.append(k)

    mesh = Mesh.of(vertices, triangles) if triangles else Mesh.empty(3, 2)
    if not provenance:
        return mesh
    pairs = np.array(ends, np.int64).reshape(-1, 2)
    found = Provenance(pairs, np.array(parameters), np.array(cells, np.int64), field)
    return replace(mesh, provenance=found)


def flat_index(place: Place, field: Field) -> int:
    """The number of a sample, in C order."""
    return int(np.ravel_multi_index(place, field.shape))
