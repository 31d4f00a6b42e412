"""Numbers made to tempt a decision: values round a face, and what stands behind it.

A decision on a face is right for the proof if both cells at the face come to the same one. Smooth
random numbers do not show the difference between a function of the face and a function that is
nearly one: sums added in another order, quotients that are rounded, values scaled by what else is
in the cell. So each kind of numbers below is aimed at one of these.

========================== ========================================================================
reals                      normal deviates: no ties, nothing special
alike                      all values of both cells of one size, which is anything from 1e-6 to 1e6
small integers             many ties, and saddles exactly on the isovalue
tenths                     decimals of one place, less an isovalue of one place: sums and products
                           that would be equal, were they not rounded
saddles                    a c and b d within two units in the last place of each other
means                      a + b + c + d within two units in the last place of zero
equal products             a c = b d with the same two factors
mixed magnitudes           1e-300 to 1e300: whoever scales, or multiplies plainly, loses numbers
smallest, largest          multiples of the smallest float, and what is near the largest
========================== ========================================================================

The values stand round the face as a, b, c, d; both diagonals, and all turns and mirror images, so
that a walk round the face begins and runs every way. Behind the face, in either cell, stand other
numbers of the same kind, or of any magnitude.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from isoref.field import Floats

WALK = (0, 1, 3, 2)
"""Corners of a face, in binary order of its two axes, as a walk round it meets them."""

Random = np.random.Generator


def _reals(rng: Random, n: int) -> Floats:
    return np.abs(rng.normal(size=(4, n)))


def _alike(rng: Random, n: int) -> Floats:
    return rng.uniform(1, 2, (4, n))


def _small_integers(rng: Random, n: int) -> Floats:
    return rng.integers(0, 3, (4, n)).astype(np.float64)


def _tenths(rng: Random, n: int) -> Floats:
    return np.abs(rng.integers(-20, 21, (4, n)) / 10 - rng.integers(0, 10, n) / 10)


def _saddles(rng: Random, n: int) -> Floats:
    a, b, c = _any_of((_reals, _tenths), rng, n)[:3]
    b = b + (b == 0)
    return np.array([a, b, c, _stepped(rng, a * c / b)])


def _means(rng: Random, n: int) -> Floats:
    a, b, c = _any_of((_reals, _tenths), rng, n)[:3]
    return np.array([a, b, c, _stepped(rng, np.abs(a - b + c))])


def _equal_products(rng: Random, n: int) -> Floats:
    x, y = _any_of((_reals, _mixed), rng, n)[:2]
    return np.array([x, x, y, y])


def _mixed(rng: Random, n: int) -> Floats:
    return np.asarray(10.0 ** rng.uniform(-300, 300, (4, n)))


def _smallest(rng: Random, n: int) -> Floats:
    return rng.integers(0, 9, (4, n)) * 5e-324 * 2.0 ** rng.integers(0, 60, n)


def _largest(rng: Random, n: int) -> Floats:
    return np.asarray(8e307 * rng.uniform(0.1, 1, (4, n)))


Sizes = Callable[[Random, int], Floats]
KINDS: dict[str, Sizes] = {
    "reals": _reals,
    "alike": _alike,
    "small integers": _small_integers,
    "tenths": _tenths,
    "saddles": _saddles,
    "means": _means,
    "equal products": _equal_products,
    "mixed magnitudes": _mixed,
    "smallest": _smallest,
    "largest": _largest,
}


def _any_of(kinds: tuple[Sizes, ...], rng: Random, n: int) -> Floats:
    """Each column by one of the kinds."""
    made = np.array([kind(rng, n) for kind in kinds])
    return np.asarray(made[rng.integers(0, len(kinds), n), :, np.arange(n)].T)


def _stepped(rng: Random, x: Floats) -> Floats:
    """Each number moved by up to two units in the last place."""
    return np.asarray(x + rng.integers(-2, 3, len(x)) * np.spacing(x))


def faces(kind: str, rng: Random, n: int) -> Floats:
    """(4, n) values round faces, ambiguous but where a zero ought to be negative.

    >>> a, b, c, d = faces("means", np.random.default_rng(0), 1000)
    >>> bool((np.abs(a + b + c + d) < 1e-14).mean() > 0.8)
    True
    """
    sizes = np.abs(KINDS[kind](rng, n))
    signed = sizes * rng.choice([1, -1], n) * np.array([[1], [-1], [1], [-1]])
    # Turn and mirror the walk, each column in its own way.
    turn, mirror = rng.integers(0, 4, n), rng.choice([1, -1], n)
    return np.asarray(signed[(turn + mirror * np.arange(4)[:, None]) % 4, np.arange(n)])


def behind(kind: str, rng: Random, n: int) -> Floats:
    """(4, n) values for the other corners of a cell, with any signs."""
    own = np.abs(KINDS[kind](rng, n))
    sizes = np.where((rng.random(n) < 0.5) | (kind == "alike"), own, _mixed(rng, n))
    return np.asarray(sizes * rng.choice([1, -1], (4, n)))


def pairs(kind: str, axis: int, rng: Random, n: int) -> tuple[Floats, Floats]:
    """Two cells (8, n) that share a face across `axis`: the lower and the upper one.

    >>> low, high = pairs("tenths", 1, np.random.default_rng(0), 5)
    >>> bool((low[[2, 3, 6, 7]] == high[[0, 1, 4, 5]]).all())
    True
    """
    above = [c for c in range(8) if c >> axis & 1]
    below = [c ^ 1 << axis for c in above]
    low, high = np.empty((2, 8, n))
    low[below], high[above] = behind(kind, rng, n), behind(kind, rng, n)
    shared = faces(kind, rng, n)[list(WALK)]
    low[above] = high[below] = shared
    size = 10.0 ** rng.uniform(-6, 6, n) if kind == "alike" else 1.0
    return low * size, high * size
