"""On which face of the lattice a place is, and which cells it is in; for any (n, m).

Glossary
--------
least face  of the lattice, that holds the place: it runs along the axes on which the place's index
            coordinate is no whole number; a sample, an edge, .., a cell
mixed       a face or a cell on whose corners every component has samples on both sides; an *active*
            cell is mixed
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np
from isoref.field import Booleans, Floats, Integers

from isograde.oracles.lattice import Lattice


def whole(lattice: Lattice, places: Floats) -> Booleans:
    """(r, n) coordinates that are whole numbers to within the tolerance."""
    return np.asarray(np.abs(places - np.rint(places)) <= lattice.tolerance)


def least_faces(lattice: Lattice, places: Floats) -> tuple[Integers, Booleans]:
    """(r, n) the lowest sample of each place's least face, and the axes along which it runs."""
    fixed = whole(lattice, places)
    low = np.where(fixed, np.rint(places), np.floor(places)).astype(np.int64)
    return np.clip(low, 0, np.subtract(lattice.shape, 1)), ~fixed


def mixed(lattice: Lattice, low: Integers, along: Booleans) -> Booleans:
    """(r,) every component has both sides on the corners of these faces."""
    some, every = (np.full((len(lattice.sides), len(low)), fill) for fill in (False, True))
    for sides in _corners(lattice, low, along):
        some |= sides
        every &= sides
    return np.asarray((some & ~every).all(axis=0))


def _corners(lattice: Lattice, low: Integers, along: Booleans) -> Iterator[Booleans]:
    """(m, r) the sides at one corner of these faces, corner by corner.

    A face that would go on beyond the last sample ends there.
    """
    sides = lattice.sides.reshape(len(lattice.sides), -1)
    inner = along & (low < np.subtract(lattice.shape, 1))
    strides = np.cumprod((1, *lattice.shape[:0:-1]))[::-1]
    corners = [low @ strides]
    for steps in (inner * strides).T:
        corners += [corner + steps for corner in corners]
    for corner in corners:
        yield sides.take(corner, axis=1)


def has_inside(lattice: Lattice, low: Integers, along: Booleans) -> Booleans:
    """(r,) some corner of these faces is inside, of every component."""
    found = np.zeros(len(low), bool)
    for sides in _corners(lattice, low, along):
        found |= sides.all(axis=0)
    return found


def active(lattice: Lattice) -> Booleans:
    """(N1 - 1, .., Nn - 1) the active cells."""
    size = [max(n - 1, 0) for n in lattice.shape]
    some, every = (np.full((len(lattice.sides), *size), fill) for fill in (False, True))
    for offset in product((0, 1), repeat=lattice.n):
        window = tuple(slice(o, o + n) for o, n in zip(offset, size, strict=True))
        sides = lattice.sides[(slice(None), *window)]
        some, every = some | sides, every & sides
    return np.asarray((some & ~every).all(axis=0))


def near_active(lattice: Lattice, places: Floats, reach: float) -> Booleans:
    """(r,) an active cell is within the reach; 0 for the closed cell itself."""
    cells = active(lattice)
    near = np.zeros(len(places), bool)
    if not cells.size:
        return near
    slack = reach + lattice.tolerance
    steps = range(-int(np.ceil(reach)) - 1, int(np.ceil(reach)) + 2)
    base = np.floor(places).astype(np.int64)
    offsets = sorted(product(steps, repeat=lattice.n), key=lambda o: sum(x * x for x in o))
    open_ = np.arange(len(places))
    for offset in offsets:
        cell = base[open_] + offset
        known = np.asarray(((cell >= 0) & (cell < cells.shape)).all(axis=1))
        known[known] = cells[tuple(cell[known].T)]
        gap = np.maximum(np.maximum(cell - places[open_], places[open_] - cell - 1), 0)
        known &= np.sqrt((gap**2).sum(axis=1)) <= slack
        near[open_[known]] = True
        open_ = open_[~known]
        if not len(open_):
            break
    return near
