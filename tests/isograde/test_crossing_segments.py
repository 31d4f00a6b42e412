"""Crossing segments and parts in stars, beside brute force in rational numbers."""

from fractions import Fraction
from itertools import combinations, product

import numpy as np
import pytest
from isograde.oracles.crossing_segments import crossing_segments
from isograde.oracles.dual import in_a_star
from isograde.oracles.lattice import Lattice
from isoref.field import Field, Floats, Integers


def meet(points: Floats, one: Integers, other: Integers) -> bool:
    """The segments have a point in common that is no vertex of both, by solving for it."""
    a, b, c, d = ([Fraction(x) for x in points[v].tolist()] for v in (*one, *other))
    u, v, w = ([q - p for p, q in zip(*ends, strict=True)] for ends in ((a, b), (c, d), (a, c)))
    across = u[0] * v[1] - u[1] * v[0]
    if across:
        s, t = ((w[0] * x[1] - w[1] * x[0]) / across for x in (v, u))
        at = [p + s * q for p, q in zip(a, u, strict=True)]
        shared = [points[x].tolist() for x in set(one.tolist()) & set(other.tolist())]
        return 0 <= s <= 1 and 0 <= t <= 1 and [float(x) for x in at] not in shared
    if w[0] * u[1] - w[1] * u[0]:
        return False
    low, high = max(min(a, b), min(c, d)), min(max(a, b), max(c, d))
    return low < high or (low == high and not set(one.tolist()) & set(other.tolist()))


@pytest.mark.parametrize("seed", range(4))
def test_crossings_are_those_of_brute_force(seed: int) -> None:
    """Whole coordinates, so that touching, overlapping and common ends are frequent."""
    rng = np.random.default_rng(seed)
    points = np.unique(rng.integers(0, 6, (24, 2)), axis=0).astype(float)
    rows = np.array(list(combinations(range(len(points)), 2)))
    segments = rows[rng.choice(len(rows), 30, replace=False)]
    found = {tuple(pair) for pair in crossing_segments(points, segments).tolist()}
    wanted = {
        (i, j)
        for i, j in combinations(range(len(segments)), 2)
        if meet(points, segments[i], segments[j])
    }
    assert found == wanted
    assert 5 < len(wanted) < 435


def test_one_unit_in_the_last_place_is_told() -> None:
    """A segment that ends on another, and one that ends a hair before it."""
    near = np.nextafter(0.5, 0)
    points = np.array([[0.0, 0.5], [1, 0.5], [0.5, 0], [0.5, 0.5], [0.5, near]])
    assert len(crossing_segments(points, np.array([[0, 1], [2, 3]]))) == 1
    assert len(crossing_segments(points, np.array([[0, 1], [2, 4]]))) == 0


@pytest.mark.parametrize("n", [2, 3])
def test_stars_are_those_of_brute_force(n: int) -> None:
    """Every crossed edge tried, its cells as a closed box."""
    rng = np.random.default_rng(n)
    values = rng.normal(size=(4,) * n)
    lattice = Lattice.of(Field.of(values), (0.0,))
    centre = rng.uniform(0, 3, (200, 1, n))
    corners = np.clip(centre + rng.uniform(-0.7, 0.7, (200, n, n)), 0, 3)
    corners = np.where(rng.random(corners.shape) < 0.3, np.rint(corners), corners)
    parts = np.arange(200 * n).reshape(200, n)
    found = in_a_star(lattice, corners.reshape(-1, n), parts)
    wanted = np.zeros(200, bool)
    for axis, start in product(range(n), np.ndindex((4,) * n)):
        end = np.add(start, np.eye(n, dtype=int)[axis])
        if end[axis] > 3 or (values[start] >= 0) == (values[tuple(end)] >= 0):
            continue
        low, high = np.subtract(start, 1.0), np.add(start, 1.0)
        low[axis], high[axis] = start[axis], end[axis]
        wanted |= ((corners >= low - 1e-6) & (corners <= high + 1e-6)).all(axis=(1, 2))
    assert np.array_equal(found, wanted)
    assert 20 < wanted.sum() < 180
