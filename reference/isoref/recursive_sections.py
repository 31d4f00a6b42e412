r"""The section of a simplex by recursion over its faces, as Weigle and Banks do it.

Min's tables say at once how the section of a simplex is cut. The method he improves on has no
tables. To cut the section of a simplex, cut the sections of its facets, which are the boundary of
it, and join a point in the middle to each piece::

    type (2, 2)      02 ---- 12        a point, c, in the middle of the quadrilateral,
                      | \  / |         joined to the four sections of the facets
                      |  c   |
                      | /  \ |
                     03 ---- 13

A facet is cut in the same way, and so on down to edges, where the section is a point. Whoever
shares a face finds the same pieces on it: the result is a simplicial complex, with no order of the
vertices. The price is many more simplices, and a recursion over all faces.

Glossary
--------
face        of a simplex: a sorted tuple of its vertices
p, q        how many of them are negative and positive
node        a vertex of the section, named by a face: the crossing where the face is an edge, the
            middle of the face's section where it is larger
pieces      of a face: the simplices of its section, each a tuple of nodes
asked       faces that were looked at: the cost of the recursion

Invariants
----------
A section that is a simplex (p = 1 or q = 1) is left whole. The number of pieces of any other is the
sum of those of the facets (`piece_count`).

References
----------
[1] C. Weigle, D. Banks, "Complex-valued contour meshing", Visualization 1996: recursion over
    faces. Its text was not at hand; that the boundary is joined to a point in the middle is our
    reading of what later work says of it.
[2] C. Min, 2003, sections 1 and 3: "our algorithm is explicit, while that of Weigle and Banks is
    recursive".
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from isoref.field import Field, Floats
from isoref.mesh import Mesh, in_space
from isoref.simplex_section import crossing
from isoref.simplicial import (
    Isovalue,
    check_input,
    checked_values,
    kuhn_complex,
    levels,
    takes_both_signs,
)

Node = tuple[int, ...]
Piece = tuple[Node, ...]


def pieces_of(face: Node, positive: Sequence[bool], known: dict[Node, list[Piece]]) -> list[Piece]:
    """The simplices of the section of a face, by recursion; `known` holds what was asked before.

    >>> pieces_of((0, 1, 2), [False, True, True], {})
    [((0, 1), (0, 2))]
    >>> len(pieces_of((0, 1, 2, 3), [False, False, True, True], {}))
    4
    """
    if face not in known:
        low = [v for v in face if not positive[v]]
        high = [v for v in face if positive[v]]
        if not low or not high:
            known[face] = []
        elif len(low) == 1 or len(high) == 1:
            crossed = sorted((min(i, j), max(i, j)) for i in low for j in high)
            known[face] = [tuple(crossed)]
        else:
            facets = (face[:k] + face[k + 1 :] for k in range(len(face)))
            known[face] = [
                (face, *piece) for facet in facets for piece in pieces_of(facet, positive, known)
            ]
    return known[face]


@cache
def piece_count(p: int, q: int) -> int:
    """How many simplices the recursion makes of a section of type (p, q).

    >>> piece_count(2, 2), piece_count(3, 2), piece_count(3, 3)
    (4, 14, 84)
    """
    if p < 1 or q < 1:
        return 0
    if p == 1 or q == 1:
        return 1
    return p * piece_count(p - 1, q) + q * piece_count(p, q - 1)


def asked(p: int, q: int) -> int:
    """How many faces the recursion looks at for one section of type (p, q), each once.

    >>> asked(3, 1), asked(3, 3)
    (1, 40)
    """
    known: dict[Node, list[Piece]] = {}
    pieces_of(tuple(range(p + q)), [False] * p + [True] * q, known)
    return len(known)


@in_space
def extract(field: Field, isovalue: Isovalue = 0.0) -> Mesh:
    """The isosurface of m components on a lattice of dimension n, by recursive sections.

    Parameters are those of `isoref.simplicial.extract`. The set is the same, cut finer; rows are
    not oriented, as nothing here needs it.

    Raises
    ------
    FieldError
        for more components than axes, a lattice one sample thick, or an isovalue that is no
        finite number.

    >>> i, j = np.indices((5, 5))
    >>> extract(Field.of((i - 2) ** 2 + (j - 2) ** 2), 2.5)
    Mesh(22 vertices in R^2, 22 simplices of dimension 1)
    """
    # Begin with the simplices of the lattice.
    check_input(field.shape, field.components)
    level = levels(isovalue, field.components)
    flat = field.values.reshape(field.components, -1).T.astype(np.float64) - level
    lowest = np.indices([N - 1 for N in field.shape]).reshape(field.dimension, -1)
    cells = np.ravel_multi_index(tuple(lowest), field.shape)
    start = kuhn_complex(field.shape, np.asarray(cells), lambda numbers: flat[numbers])
    points, values, rows = start.points, checked_values(start.values), start.simplices.tolist()

    # Cut them by one component after the other.
    while values.shape[1]:
        points, values, rows = cut(points, values, rows)
    k = field.dimension - field.components
    simplices = np.array(rows, np.int64).reshape(-1, k + 1)
    return Mesh(points.reshape(-1, field.dimension) * field.spacing + field.origin, simplices)


def cut(
    points: Floats, values: Floats, rows: list[list[int]]
) -> tuple[Floats, Floats, list[list[int]]]:
    """Points, remaining values and simplices of the section where the first value is 0."""
    psi = values[:, 0]
    positive = (psi >= 0).tolist()
    known: dict[Node, list[Piece]] = {}
    pieces = [piece for row in rows for piece in pieces_of(tuple(sorted(row)), positive, known)]

    # Place the nodes: crossings first, then the middle of each larger face.
    nodes = sorted({node for piece in pieces for node in piece}, key=lambda node: (len(node), node))
    number = {node: v for v, node in enumerate(nodes)}
    both = np.hstack([points, values[:, 1:]])
    placed = np.empty((len(nodes), both.shape[1]))
    for node, v in number.items():
        ends = [(i, j) for i in node if not positive[i] for j in node if positive[j]]
        crossings = [crossing(both[i], both[j], psi[i], psi[j]) for i, j in ends]
        placed[v] = np.mean(crossings, axis=0)

    # Keep what the remaining components can still cross.
    n = points.shape[1]
    left = placed[:, n:]
    made = [[number[node] for node in piece] for piece in pieces]
    kept = [row for row in made if takes_both_signs(left[row])] if left.shape[1] else made
    return placed[:, :n], left, kept
