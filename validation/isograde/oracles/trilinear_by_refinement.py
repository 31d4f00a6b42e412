"""The truth about a cell, a second way: refine, then count samples.

Idea
----
Sample the trilinear interpolant on a finer and finer lattice. In a subcell whose high corners are
connected along its edges, and whose low corners are, the level set is one plain sheet; a lattice
of such subcells is well-composed, and the topology of the high and low regions is that of their
samples. Wherever a subcell is not plain, split the lattice intervals it stands on and look again.
Nothing here knows of saddles, cases or tables: the counts are those of digital topology.

    components(S) = components(high) + components(low) - 1
    Euler(S)      = Euler(high) + Euler(low) - 1
    Euler(region) = samples - edges - .. of the cubes all of whose corners are in the region

This is slow, and never ends on a tie: it is the check of `isograde.oracles.trilinear`, which it
shares no line with.

References
----------
1. T. Etiene and others: Topology verification for isosurface extraction. IEEE TVCG 18(6), 2012
   (refinement and digital topology as a check).
2. L. Latecki, U. Eckhardt, A. Rosenfeld: Well-composed sets. CVIU 61(1), 1995.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

# Splitting at the middle would put lattice planes on the saddles of symmetric cells.
SPLIT = (3 - 5**0.5) / 2


class UnresolvedError(RuntimeError):
    """Refinement did not end: the field is on a tie or too near one."""


@dataclass(frozen=True)
class Refined:
    """The topology of the level set of an interpolated grid.

    components, euler, curves : of the level set, curves being those on the skin
    corners : for each sample of the unrefined grid, the number of its region; 0 is never used
    """

    components: int
    euler: int
    curves: int
    corners: NDArray[np.int64]


def refine(values: ArrayLike, isovalue: float = 0.0, limit: int = 4_000_000) -> Refined:
    """The topology of the level set, found by refining until every subcell is plain.

    Raises
    ------
    UnresolvedError
        when the lattice would exceed `limit` samples.

    >>> v = np.full((2, 2, 2), -1.0); v[0, 0, 0] = v[1, 1, 1] = 1
    >>> found = refine(v)
    >>> found.components, found.euler, found.curves
    (2, 2, 2)
    """
    samples = np.asarray(values, np.float64) - isovalue
    places = [_split(np.arange(float(n)), np.ones(n - 1, bool)) for n in samples.shape]
    while True:
        high = _interpolate(samples, places) > 0
        rough = _not_plain(high)
        if not rough.any():
            return _count(high, places)
        others = ((1, 2), (0, 2), (0, 1))
        where = [np.asarray(rough.any(axis=other)) for other in others]
        places = [_split(p, w) for p, w in zip(places, where, strict=True)]
        if np.prod([len(p) for p in places]) > limit:
            raise UnresolvedError(f"{int(rough.sum())} subcells are not plain; is this a tie?")


def _split(places: Floats, where: Flags) -> Floats:
    """`places` with one more inside each of the marked intervals."""
    more = places[:-1] + SPLIT * np.diff(places)
    return np.sort(np.concatenate([places, more[where]]))


def _interpolate(samples: Floats, places: list[Floats]) -> Floats:
    """The trilinear interpolant at the product of `places`, one axis after the other."""
    for axis, at in enumerate(places):
        cell = np.minimum(at.astype(int), samples.shape[axis] - 2)
        t = (at - cell).reshape([-1 if a == axis else 1 for a in range(3)])
        samples = (1 - t) * samples.take(cell, axis) + t * samples.take(cell + 1, axis)
    return samples


def _corner(flags: Flags, offset: tuple[int, ...]) -> Flags:
    """The samples at `offset` of all subcells."""
    n = flags.shape
    return flags[tuple(slice(o, n[a] - 1 + o) for a, o in enumerate(offset))]


def _not_plain(high: Flags) -> Flags:
    """Subcells whose high corners, or low corners, are not connected along edges."""
    code = np.zeros([n - 1 for n in high.shape], np.int64)
    for bit, offset in enumerate(product((0, 1), repeat=3)):
        code |= _corner(high, offset).astype(np.int64) << bit
    return _ROUGH[code]


def _rough_codes() -> Flags:
    """For each code, whether labelling a 2 x 2 x 2 block finds two high or two low parts."""
    rough = np.zeros(256, bool)
    for code in range(256):
        block = np.array([code >> bit & 1 for bit in range(8)], bool).reshape(2, 2, 2)
        rough[code] = ndimage.label(block)[1] > 1 or ndimage.label(~block)[1] > 1
    return rough


_ROUGH = _rough_codes()


def _euler(region: Flags) -> int:
    """Samples, less edges, plus squares, less cubes of the region."""
    total = 0
    for extent in product((0, 1), repeat=3):
        whole = region
        for axis in np.flatnonzero(extent):
            n = whole.shape[axis]
            whole = whole.take(range(n - 1), axis) & whole.take(range(1, n), axis)
        total += (-1) ** sum(extent) * int(whole.sum())
    return total


def _count(high: Flags, places: list[Floats]) -> Refined:
    """The topology of the level set between high and low samples of a well-composed lattice."""
    above, n_above = ndimage.label(high)
    below, n_below = ndimage.label(~high)
    corners = np.where(high, above, below + n_above)[np.ix_(*[p == np.floor(p) for p in places])]
    if not (n_above and n_below):
        return Refined(0, 0, 0, corners.astype(np.int64))
    skin = np.ones(high.shape, bool)
    skin[1:-1, 1:-1, 1:-1] = False
    curves = ndimage.label(high & skin)[1] + ndimage.label(~high & skin)[1]
    euler = _euler(high) + _euler(~high) - 1
    return Refined(n_above + n_below - 1, euler, max(int(curves) - 1, 0), corners.astype(np.int64))
