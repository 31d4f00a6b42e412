r"""Simplices that fill the lattice, and whether a mesh is in each of them the section it must be.

A function that is linear on a simplex, given at its n + 1 corners, has its level set in general
position on the edges whose ends are on different sides: with p corners inside and q outside it is
a product of two simplices, of p and of q corners, has p q vertices and bounds nothing inside. Any
way to cut it into simplices without further vertices takes the same number of them, (n-1 choose
p-1): all simplices on the vertices of such a product have the same volume.

A mesh is this section when its boundary says so, from the simplex down to its edges. Of the part
of the mesh in a simplex, the facets that occur an odd number of times must lie in the simplex's
facets. What lies in one of these is again a mesh, one dimension lower, of which the same is asked;
and so on, until points are left on edges: one on each edge whose ends differ, none on the others::

        o                     one tetrahedron, one corner inside: the triangle of the mesh has
       /|\                    three sides, one in each of three faces; each side has two ends, on
      / * \                   the two edges of its face that are crossed
     / /|\ \
    o-*-+-*-o

Glossary
--------
block       cells after which the split repeats itself, 1 or 2 along each axis
simplex     of the split, with corners at samples; in this module never one of the mesh
part        of the mesh: one of its simplices
weights     barycentric coordinates of a place in a simplex
mask        a face of a simplex as bits, bit c for its corner c
flag        a sequence of faces of a simplex, each a facet of the one before it
support     the least face of a simplex that holds a place: its corners of positive weight

Simplices, corners and faces are numbered as the declaration lists them.

References
----------
[1] J. A. De Loera, J. Rambau, F. Santos, Triangulations, 2010, section 6.2: products of simplices.
[2] C. Min, Simplicial isosurfacing in arbitrary dimension and codimension, J. Comput. Phys. 190,
    2003.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import comb, factorial

import numpy as np
from isoref.field import Booleans, Floats, Integers

from isograde.oracles.lattice import Lattice
from isograde.oracles.rows import distinct
from isograde.oracles.standing import active

# Places are looked up so many at a time.
PORTION = 20_000


@dataclass(frozen=True, eq=False)
class Located:
    """The simplex that holds each place; one of them where there are several.

    Attributes
    ----------
    block : (r, n) lowest sample of the block
    number : (r,) the simplex in it
    weights : (r, n + 1) those within the tolerance of 0 are 0
    """

    block: Integers
    number: Integers
    weights: Floats


@dataclass(frozen=True, eq=False)
class Sections:
    """What a mesh is in each simplex that the surface, or the mesh, passes through.

    Attributes
    ----------
    corners : (a, n + 1, n) the simplices, by the samples at their corners
    inside, tied : (a, n + 1) the corners' sides, and which are tied samples
    right : (a,) the mesh is there the section of a linear function, as far as its boundary says
    parts, inner : (a,) number of parts, and of vertices strictly inside
    astray : (s,) parts that no simplex holds
    """

    corners: Integers
    inside: Booleans
    tied: Booleans
    right: Booleans
    parts: Integers
    inner: Integers
    astray: Integers

    @property
    def wanted(self) -> Integers:
        """(a,) number of parts of the section; -1 where inner vertices leave it open."""
        n = self.corners.shape[2]
        within = self.inside.sum(axis=1)
        count = np.array([0, *(comb(n - 1, p - 1) for p in range(1, n + 1)), 0])[within]
        count[within == n + 1] = 0
        if n <= 3:
            return np.asarray(count + np.where(within % (n + 1) > 0, (n - 1) * self.inner, 0))
        return np.where(self.inner > 0, -1, count)


def locate(lattice: Lattice, places: Floats, corner: Integers) -> Located:
    """The simplex of the declared split that holds each place.

    Parameters
    ----------
    places : (r, n) index coordinates of `lattice`
    corner : (n,) where the lattice begins, counted from a corner of a block
    """
    simplices = np.array(lattice.declared.split.over(lattice.n))
    period = np.array(lattice.declared.split.period(lattice.n))
    block = np.floor((places + corner) / period).astype(np.int64) * period - corner
    slack = lattice.n * lattice.tolerance
    number = np.empty(len(places), np.int64)
    weights = np.empty((len(places), lattice.n + 1))
    for start in range(0, len(places), PORTION):
        rows = slice(start, start + PORTION)
        every = _weights(simplices, places[rows] - block[rows])
        number[rows] = every.min(axis=2).argmax(axis=1)
        weights[rows] = every[np.arange(len(every)), number[rows]]
    return Located(block, number, np.where(np.abs(weights) <= slack, 0.0, weights))


def _weights(simplices: Integers, places: Floats) -> Floats:
    """(r, s, n + 1) barycentric coordinates of places in every simplex."""
    with_one = np.concatenate([places, np.ones((len(places), 1))], axis=1)
    return np.asarray(np.einsum("sij,rj->rsi", _to_weights(simplices), with_one))


def _to_weights(simplices: Integers) -> Floats:
    """(s, n + 1, n + 1) what turns a place, with a one behind it, into barycentric coordinates."""
    ones = np.ones((*simplices.shape[:2], 1))
    matrix = np.concatenate([simplices, ones], axis=2).transpose(0, 2, 1)
    return np.asarray(np.linalg.inv(matrix))


def corners_of(lattice: Lattice, found: Located) -> Integers:
    """(r, n + 1, n) the samples at the corners of the simplices that were found."""
    simplices = np.array(lattice.declared.split.over(lattice.n))
    corners: Integers = found.block[:, None, :] + simplices[found.number]
    return corners


def sections(lattice: Lattice, places: Floats, mesh: Integers, corner: Integers) -> Sections:
    """What the mesh is in each simplex.

    Parameters
    ----------
    lattice : samples, with the declared split
    places : (V, n) vertices in index coordinates
    mesh : (S, n) its parts, of dimension n - 1
    corner : (n,) where the lattice begins, counted from a corner of a block
    """
    simplices = np.array(lattice.declared.split.over(lattice.n))
    # Name each simplex by its block and number; list those the field or the mesh makes active.
    middle = locate(lattice, places[mesh].mean(axis=1), corner)
    own = np.column_stack([middle.block, middle.number])
    held = _in_lattice(lattice, corners_of(lattice, middle))
    names, row = _listed(np.concatenate([_active(lattice, corner, simplices), own[held]]))
    part = np.flatnonzero(held)
    row = row[len(row) - len(part) :]
    corners = names[:, None, :-1] + simplices[names[:, -1]]
    inside = lattice.inside[tuple(np.moveaxis(corners, -1, 0))]
    tied = lattice.tied[tuple(np.moveaxis(corners, -1, 0))]

    # Say on which face of its simplex each vertex of a part is; leave out parts that stick out.
    masks, sticking = _masks(lattice, places[mesh[part]], simplices, names[row])
    kept = ~sticking
    right = _bounded(mesh[part][kept], row[kept], masks[kept], inside)
    whole = (1 << (lattice.n + 1)) - 1
    keys = np.column_stack([np.repeat(row[kept], mesh.shape[1]), mesh[part][kept].reshape(-1)])
    strictly = _listed(keys[(masks[kept] == whole).reshape(-1)])[0][:, 0]
    return Sections(
        corners,
        inside,
        tied,
        right,
        np.bincount(row[kept], minlength=len(names)),
        np.bincount(strictly, minlength=len(names)),
        part[sticking],
    )


def _in_lattice(lattice: Lattice, corners: Integers) -> Booleans:
    """(r,) all corners are samples of the lattice."""
    return np.asarray(((corners >= 0) & (corners < lattice.shape)).all(axis=(1, 2)))


def _active(lattice: Lattice, corner: Integers, simplices: Integers) -> Integers:
    """(a, n + 1) lowest sample of the block, and number, of the simplices with both sides."""
    period = np.array(lattice.declared.split.period(lattice.n))
    # A simplex with both sides is in a block with an active cell.
    cells = np.argwhere(active(lattice)) + corner
    blocks = _listed(cells // period)[0] * period - corner
    found = []
    for number, simplex in enumerate(simplices):
        at = blocks[_in_lattice(lattice, blocks[:, None, :] + simplex)]
        sides = np.stack([lattice.inside[tuple((at + c).T)] for c in simplex])
        at = at[sides.any(axis=0) & ~sides.all(axis=0)]
        found.append(np.column_stack([at, np.full(len(at), number)]))
    return np.concatenate(found)


def _listed(rows: Integers) -> tuple[Integers, Integers]:
    """The distinct rows, and where each given one is among them."""
    first, where = distinct(rows)
    return rows[first], where


def _masks(
    lattice: Lattice, places: Floats, simplices: Integers, name: Integers
) -> tuple[Integers, Booleans]:
    """(r, n) the support of each vertex of each part, and (r,) which parts stick out.

    Parameters
    ----------
    places : (r, n, n) the vertices of each part
    name : (r, n + 1) block and number of the simplex that holds it
    """
    n = lattice.n
    local = places - name[:, None, :-1]
    with_one = np.concatenate([local, np.ones((*local.shape[:2], 1))], axis=2)
    weights = np.empty((len(places), n, n + 1))
    for number, matrix in enumerate(_to_weights(simplices)):
        here = name[:, -1] == number
        weights[here] = with_one[here] @ matrix.T
    slack = n * lattice.tolerance
    masks: Integers = (weights > slack) @ (1 << np.arange(n + 1))
    return masks, np.asarray((weights < -slack).any(axis=(1, 2)))


def _bounded(parts: Integers, row: Integers, masks: Integers, inside: Booleans) -> Booleans:
    """(a,) the chain of parts in each simplex has the section's boundary, down to the edges.

    Parameters
    ----------
    parts : (r, n) vertices, distinct
    row : (r,) the simplex of each part
    masks : (r, n) the support of each of its vertices
    inside : (a, n + 1) sides of the simplices' corners
    """
    n = inside.shape[1] - 1
    right = np.ones(len(inside), bool)
    face = np.full(len(parts), (1 << (n + 1)) - 1)
    flag = np.zeros(len(parts), np.int64)
    order = np.argsort(parts, axis=1)
    parts, masks = (np.take_along_axis(x, order, axis=1) for x in (parts, masks))
    while parts.shape[1] > 1:
        # Take the facets that are left over, modulo two.
        each = range(parts.shape[1])
        facets = np.concatenate([np.delete(parts, i, axis=1) for i in each])
        supports = np.concatenate([np.delete(masks, i, axis=1) for i in each])
        row, face, flag = (np.tile(x, len(each)) for x in (row, face, flag))
        left = _odd([flag, row, *facets.T])
        parts, masks = facets[left], supports[left]
        row, face, flag = row[left], face[left], flag[left]
        # Each must lie in one facet of the face: that without the corner it does not use.
        missing = face & ~np.bitwise_or.reduce(masks, axis=1)
        single = (missing > 0) & (missing & (missing - 1) == 0)
        right[row[~single]] = False
        parts, masks, row = parts[single], masks[single], row[single]
        face, flag = face[single] & ~missing[single], flag[single]
        flag = flag * (n + 2) + np.log2(missing[single]).astype(np.int64) + 1

    # One point on each crossed edge of every flag, and none elsewhere.
    bits: Integers = inside @ (1 << np.arange(n + 1))
    mixed = (face & bits[row] != 0) & (face & ~bits[row] != 0) & (masks[:, 0] == face)
    right[row[~mixed]] = False
    flags, _ = _listed(np.column_stack([row, flag]))
    within = inside.sum(axis=1)
    wanted = within * (n + 1 - within) * factorial(n - 1)
    right &= np.bincount(row, minlength=len(inside)) == wanted
    right &= np.bincount(flags[:, 0], minlength=len(inside)) == wanted
    return right


def _odd(columns: list[Integers]) -> Integers:
    """One row of each value that occurs an odd number of times."""
    order = np.lexsort(columns)
    if not len(order):
        return order
    new = np.zeros(len(order), bool)
    new[0] = True
    for column in columns:
        new[1:] |= np.diff(column[order]) != 0
    start = np.flatnonzero(new)
    uses = np.diff(start, append=len(order))
    rows: Integers = order[start[uses % 2 == 1]]
    return rows
