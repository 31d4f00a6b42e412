"""What the bilinear interpolant connects on an ambiguous face, from the interpolant itself.

On a face with corner values b00, b10, b01, b11 (less the isovalue) where b00 and b11 are on one
side and b10 and b01 on the other, the level set of the bilinear interpolant is a hyperbola. Its
two branches are separated by its asymptotes, which cross in the saddle (S, T), with value

    B(S, T) = (b00 b11 - b10 b01) / (b00 + b11 - b10 - b01).

If the saddle is inside, the two inside corners are joined through it; if it is outside, they are
separated; if its value is zero, the level set is the asymptotes themselves and either is right.
The denominator's sign is that of b00, so the sign of B(S, T) is that of b00 b11 - b10 b01 where
b00 and b11 are the inside corners, and the opposite where they are the outside ones.

The product is taken in double precision with a bound on its rounding; where the bound does not
tell the sign, what rounding took from each product decides [2], and where that cannot be had, exact
rational arithmetic. Where the corners' distances from the isovalue are rounded themselves, as are
0.4 - 0.05 and most others of decimal fractions, a program that decides its distances exactly and
one that decides the samples exactly may differ within that bound, and both are right: there the
saddle counts as on the surface.

References
----------
[1] G. M. Nielson, B. Hamann, The asymptotic decider, IEEE Visualization 1991, section 2.
[2] T. J. Dekker, A floating-point technique for extending the available precision, Numerische
    Mathematik 18, 1971: sums and products as a rounded number and what it lacks.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations
from weakref import WeakKeyDictionary

import numpy as np
from isoref.field import Array, Booleans, Floats, Integers

from isograde.oracles.bounded import lost, rounded
from isograde.oracles.lattice import Lattice, components
from isograde.oracles.traces import FACES, Traces

# Each factor is a rounded difference, each product and their difference is rounded once.
ROUNDING = 8 * float(np.finfo(np.float64).eps)
# A number times this one has its upper 26 digits where they can be rounded off.
SPLIT = 2.0**27 + 1
# Products of what is larger, and smaller than its inverse, have all their digits.
SMALLEST = 2.0**-200


def saddle_sign(corners: Array, isovalue: float) -> tuple[Integers, Floats]:
    """Whether the saddle is inside (+1), outside (-1) or on the surface (0), and how clearly.

    Parameters
    ----------
    corners : (n, 4) values b00, b10, b01, b11 of faces that are ambiguous

    Returns
    -------
    sign : (n,) of the bilinear interpolant's value at its saddle, less the isovalue
    clarity : (n,) size of the deciding difference relative to its two products

    >>> saddle_sign(np.array([[2.0, -1.0, -1.0, 2.0]]), 0.0)
    (array([1]), array([0.6]))
    """
    a, b, c, d = (np.asarray(corners, np.float64) - isovalue).T
    difference, size = a * d - b * c, np.abs(a * d) + np.abs(b * c)
    # The corners b00 and b11 are the inside ones where they are the higher ones.
    high = np.where(a + d > b + c, 1, -1)
    sign = np.sign(difference).astype(np.int64) * high
    unsure = np.flatnonzero(np.abs(difference) <= ROUNDING * size)
    if len(unsure):
        near = rounded(np.asarray(corners)[unsure], isovalue)
        sign[unsure[near]], exact = 0, unsure[~near]
        sign[exact] = exact_sign(np.asarray(corners)[exact], isovalue) * high[exact]
    with np.errstate(invalid="ignore", divide="ignore"):
        return sign, np.where(size > 0, np.abs(difference) / size, 0.0)


def exact_sign(corners: Array, isovalue: float) -> Integers:
    """(n,) the sign of b00 b11 - b10 b01, of values (n, 4) less the isovalue.

    >>> exact_sign(np.array([[0.1, 0.3, 0.1, 0.3], [2.0, 1, 2, 1]]), 0.0)
    array([0, 0])
    """
    values = corners.astype(np.float64)
    away = values - isovalue
    sign, known = _sign_by_parts(away)
    # The values themselves, and their distances from the isovalue, are to be these doubles.
    given = corners.dtype.kind in "bf" or corners.dtype.itemsize < 8
    known &= given and corners.dtype.itemsize <= 8 and float(isovalue) == isovalue
    known &= ~rounded(corners, isovalue)
    for n in np.flatnonzero(~known):
        w, x, y, z = (Fraction(value) - Fraction(isovalue) for value in corners[n].tolist())
        exact = w * z - x * y
        sign[n] = (exact > 0) - (exact < 0)
    return sign


def _sign_by_parts(away: Floats) -> tuple[Integers, Booleans]:
    """(n,) the sign of a d - b c of doubles (n, 4), where the products differ little; if known.

    Each product is a rounded number and what it lacks. The rounded ones, so near to each other,
    have an exact difference; it is compared with that of what they lack, rounded, and where these
    are equal, with what that rounding took.
    """
    a, b, c, d = away.T
    size = np.abs(away)
    known = ((size == 0) | ((size > SMALLEST) & (size < 1 / SMALLEST))).all(axis=1)
    with np.errstate(over="ignore", invalid="ignore"):
        (first, less), (second, lesser) = _product(a, d), _product(b, c)
        gap, wanted = first - second, lesser - less
        rest = lost(lesser, less, wanted)
        sign = np.where(gap != wanted, np.sign(gap - wanted), -np.sign(rest))
    return np.where(known, sign, 0).astype(np.int64), known


def _product(a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """The rounded product, and what it lacks of the exact one; neither may over- or underflow."""
    product = a * b
    (high, low), (high_b, low_b) = _halves(a), _halves(b)
    lacking = ((high * high_b - product) + high * low_b + low * high_b) + low * low_b
    return product, lacking


def _halves(a: Floats) -> tuple[Floats, Floats]:
    """Two numbers of half as many digits that add up to the number."""
    moved = a * SPLIT
    high = moved - (moved - a)
    return high, a - high


def tied_saddles(lattice: Lattice, low: Integers, along: Booleans) -> Booleans:
    """(r,) which of these faces, along two axes each, have a saddle within reach of the isovalue.

    An inner vertex as near to the face stands in it, as far as the tolerance can tell.

    Parameters
    ----------
    low : (r, n) the lowest sample of each face
    along : (r, n) the axes along which it runs; a row without exactly two is no face of two
    """
    tied = np.zeros(len(low), bool)
    there = (low + along < lattice.shape).all(axis=1)
    rows = np.flatnonzero((along.sum(axis=1) == 2) & there)
    if not len(rows):
        return tied
    one, other = (along[rows].cumsum(axis=1) == step for step in (1, 2))
    steps = [np.zeros_like(low[rows]), one & along[rows], other & along[rows], along[rows]]
    corners = np.moveaxis(np.stack([low[rows] + step for step in steps], axis=1), -1, 0)
    a, b, c, d = lattice.inside[tuple(corners)].T
    ambiguous = np.flatnonzero((a == d) & (b == c) & (a != b))
    values = components(lattice.field)[0][tuple(corners)][ambiguous]
    sign, clarity = saddle_sign(values, lattice.isovalue)
    tied[rows[ambiguous]] = (sign == 0) | (clarity <= lattice.reach)
    return tied


def tied_saddle(lattice: Lattice) -> bool:
    """Whether some ambiguous face of the lattice has its saddle exactly on the isovalue."""
    values, inside = components(lattice.field)[0], lattice.inside
    for axes in combinations(range(lattice.n), 2):
        windows = [_window(lattice.n, axes, corner) for corner in ((0, 0), (1, 0), (0, 1), (1, 1))]
        a, b, c, d = (inside[window] for window in windows)
        ambiguous = np.nonzero((a == d) & (b == c) & (a != b))
        if len(ambiguous[0]):
            corners = np.stack([values[window][ambiguous] for window in windows], axis=1)
            if (saddle_sign(corners, lattice.isovalue)[0] == 0).any():
                return True
    return False


def _window(n: int, axes: tuple[int, int], corner: tuple[int, int]) -> tuple[slice, ...]:
    """The samples at this corner of every face along these axes."""
    window = [slice(None)] * n
    for axis, end in zip(axes, corner, strict=True):
        window[axis] = slice(1, None) if end else slice(None, -1)
    return tuple(window)


def faces_of(lattice: Lattice, traces: Traces) -> tuple[Integers, Integers, Array]:
    """The ambiguous faces of the active cells, each as seen from a cell.

    Returns
    -------
    row, face : (m,) index into `traces` and into its six faces
    values : (m, 4) samples at the face's corners 00, 10, 01, 11
    """
    row, face = np.nonzero(traces.ambiguous)
    i, j, k = (traces.place[row][:, None, :] + _OFFSETS[face]).transpose(2, 0, 1)
    return row, face, components(lattice.field)[0][i, j, k]


def saddles(lattice: Lattice, traces: Traces) -> tuple[Integers, Integers, Integers, Floats]:
    """The ambiguous faces of the active cells, and on which side each one's saddle is.

    Returns
    -------
    row, face : (m,) index into `traces` and into its six faces
    sign, clarity : (m,) as in `saddle_sign`
    """
    if traces not in _SADDLES:
        row, face, values = faces_of(lattice, traces)
        _SADDLES[traces] = row, face, *saddle_sign(values, lattice.isovalue)
    return _SADDLES[traces]


_SADDLES: WeakKeyDictionary[Traces, tuple[Integers, Integers, Integers, Floats]] = (
    WeakKeyDictionary()
)
"""What `saddles` found, of which several claims ask; traces are over one lattice."""


def read_in_favour(lattice: Lattice, traces: Traces) -> Booleans:
    """(n, 6) faces whose inside corners are separated; where either can be read, the right one.

    A face has several readings where triangles lie flat in it, see `isograde.oracles.flat`.
    """
    separated = traces.separated.copy()
    row, face, sign, _ = saddles(lattice, traces)
    joins = traces.joined[row, face] & (sign > 0)
    separated[row[joins], face[joins]] = False
    return separated


def _corners(axis: int, side: int) -> list[list[int]]:
    """Offsets of a face's corners 00, 10, 01, 11."""
    across = [a for a in range(3) if a != axis]
    corners = []
    for t, s in ((0, 0), (0, 1), (1, 0), (1, 1)):
        offset = [side // 2] * 3
        offset[across[0]], offset[across[1]] = s, t
        corners.append(offset)
    return corners


_OFFSETS = np.array([_corners(*face) for face in FACES])
"""(6, 4, 3) offsets of the corners of each face."""
