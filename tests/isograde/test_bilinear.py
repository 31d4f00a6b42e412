"""Which corners the bilinear interpolant connects, beside a fine raster of the interpolant."""

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from isograde.claims import bilinear
from isograde.declaration import Declaration
from isograde.model import Case, Outcome, Status, Trial, Verdict
from isograde.oracles.bilinear import _sign_by_parts, exact_sign, saddle_sign, saddles
from isograde.oracles.lattice import Lattice
from isograde.oracles.traces import FACES, traces
from isoref.field import Array, Field, Floats
from isoref.methods import METHODS
from scipy import ndimage


def raster(corners: Floats, n: int = 400) -> Floats:
    """The bilinear interpolant on a fine grid of the unit square."""
    s = np.linspace(0, 1, n)[:, None]
    t = np.linspace(0, 1, n)[None, :]
    b00, b10, b01, b11 = corners
    fine: Floats = (1 - s) * (1 - t) * b00 + s * (1 - t) * b10 + (1 - s) * t * b01 + s * t * b11
    return fine


def test_the_saddle_says_what_a_raster_shows() -> None:
    """The inside corners are one component of the raster exactly where the saddle is inside."""
    rng = np.random.default_rng(0)
    corners = rng.uniform(0.2, 1, (50, 4)) * [1, -1, -1, 1] * rng.choice([-1, 1], (50, 1))
    sign, clarity = saddle_sign(corners, 0.0)
    clear = clarity > 0.02
    assert clear.sum() > 40
    for one, joined in zip(corners[clear], sign[clear] > 0, strict=True):
        label, _ = ndimage.label(raster(one) >= 0)
        high = [label[0, 0], label[-1, -1]] if one[0] > 0 else [label[-1, 0], label[0, -1]]
        assert (high[0] == high[1]) == joined


def test_a_degenerate_saddle_is_told_exactly() -> None:
    """0.1 * 0.3 and 0.1 * 0.3 are equal; one unit in the last place more is not."""
    more = np.nextafter(0.3, 1)
    corners = np.array([[0.1, -0.1, -0.3, 0.3], [0.1, -0.1, -0.3, more], [-0.1, 0.1, more, -0.3]])
    assert saddle_sign(corners, 0.0)[0].tolist() == [0, 1, 1]


def test_large_integers_do_not_round() -> None:
    """Products of 60 bits do not fit a double; the sign is right all the same."""
    big = 2**30
    corners = np.array([[big + 1, -big, -big, big - 1], [big + 1, -big, -big, big]])
    assert saddle_sign(corners, 0.0)[0].tolist() == [-1, 1]


def test_the_sign_is_that_of_the_value_at_the_saddle() -> None:
    """Section 2: B(S, T) = (b00 b11 - b10 b01) / (b00 + b11 - b10 - b01), about any isovalue."""
    rng = np.random.default_rng(0)
    n, isovalue = 5000, 0.75
    b = rng.uniform(0.01, 1, (n, 4)) * [1, -1, -1, 1] * rng.choice([-1, 1], (n, 1))
    value = (b[:, 0] * b[:, 3] - b[:, 1] * b[:, 2]) / (b[:, 0] + b[:, 3] - b[:, 1] - b[:, 2])
    sign, clarity = saddle_sign(b + isovalue, isovalue)
    assert np.array_equal(sign, np.sign(value))
    assert clarity == pytest.approx(saddle_sign(3 * b, 0.0)[1])


def test_a_degenerate_saddle_is_told_exactly_about_any_isovalue() -> None:
    """Values and isovalue in quarters: their differences are exact."""
    corners = np.array([[0.5, -0.25, -1.0, 0.5], [0.5, -0.25, -1.25, 0.5]])
    assert saddle_sign(corners + 0.75, 0.75)[0].tolist() == [0, -1]


def test_products_too_small_for_a_double_have_their_sign() -> None:
    """Both products are 0 in double precision: the sign is exact, and not clear."""
    tiny = 1e-200
    sign, clarity = saddle_sign(np.array([[2 * tiny, -tiny, -tiny, tiny]]), 0.0)
    assert (sign.tolist(), clarity.tolist()) == ([1], [0.0])


def test_saddles_are_those_of_the_faces_of_the_active_cells() -> None:
    """Each face cut out of its cell by slicing, its sign from B(S, T)."""
    values = np.random.default_rng(1).normal(size=(5, 6, 7))
    lattice = Lattice.of(Field.of(values), (0.25,))
    seen = traces(lattice, np.empty((0, 3)), np.empty((0, 3), np.int64))
    row, face, sign, _ = saddles(lattice, seen)
    found = {
        (*seen.place[r].tolist(), *FACES[f]): s for r, f, s in zip(row, face, sign, strict=True)
    }
    expected = {}
    for i, j, k in np.ndindex(4, 5, 6):
        cell = values[i : i + 2, j : j + 2, k : k + 2] - 0.25
        for axis, side in FACES:
            (a, b), (c, d) = np.take(cell, side // 2, axis)
            if (a >= 0) == (d >= 0) != (b >= 0) == (c >= 0):
                expected[i, j, k, axis, side] = np.sign((a * d - b * c) / (a + d - b - c))
    assert found == expected
    assert set(expected.values()) == {-1, 1}


def exact(corners: Array, isovalue: float) -> list[int]:
    """The signs, by rational arithmetic."""
    found = []
    for row in corners.tolist():
        a, b, c, d = (Fraction(value) - Fraction(isovalue) for value in row)
        found.append((a * d > b * c) - (a * d < b * c))
    return found


def nearly_equal(random: np.random.Generator, count: int) -> Floats:
    """Corners whose products differ by a few units in the last place, or by less."""
    a, b = random.uniform(-2, 2, (2, count))
    steps = 1 + random.integers(-2, 3, (2, count)) * 2.0**-52
    return np.stack([a, a * steps[0], b, b * steps[1]], axis=1)


DRAWN: dict[str, tuple[Callable[[np.random.Generator], Array], float]] = {
    "ones": (lambda random: random.choice([-1.0, 1.0], (300, 4)), 0.0),
    "whole numbers": (lambda random: random.integers(-5, 6, (300, 4)).astype(float), 0.5),
    "bytes": (lambda random: random.integers(98, 103, (300, 4)).astype(np.uint8), 100.0),
    "nearly equal": (lambda random: nearly_equal(random, 300), 0.0),
    "nearly equal, away": (lambda random: 1 + nearly_equal(random, 300) / 8, 1.0),
    "single precision": (lambda random: nearly_equal(random, 300).astype(np.float32), 0.1),
    "large whole numbers": (lambda random: random.integers(-(2**62), 2**62, (300, 4)), 0.5),
    "tiny": (lambda random: random.choice([1e-300, -1e-300, 3e-300, 5e-324], (300, 4)), 0.0),
    "huge": (lambda random: random.choice([1e300, -1e300, 3e300], (300, 4)), 0.0),
}


@pytest.mark.parametrize("name", DRAWN)
def test_the_sign_by_parts_is_the_exact_one(name: str) -> None:
    """What floating point cannot hold goes to fractions; of what it can there is nothing lost."""
    draw, isovalue = DRAWN[name]
    corners = draw(np.random.default_rng(0))
    with np.errstate(over="ignore"):
        found = exact_sign(corners, isovalue)
    assert found.tolist() == exact(corners, isovalue)


def test_the_sign_by_parts_tells_products_a_last_place_apart() -> None:
    """All three signs occur, and no fraction is asked for."""
    sign, known = _sign_by_parts(nearly_equal(np.random.default_rng(0), 300))
    assert known.all()
    assert set(sign.tolist()) == {-1, 0, 1}


def test_a_saddle_that_rounding_of_the_distances_decides_may_be_on_either_side() -> None:
    """A cell of multiples of 0.1 at 0.05, of whose face exact arithmetic on the samples says -1."""
    values = np.array([[[0.4, -0.4], [0.4, 0.5]], [[0.0, 0.5], [0.5, -0.4]]])
    corners = np.array([[values[i, j, 1] for j in (0, 1) for i in (0, 1)]])
    assert exact_sign(corners, 0.05)[0] != 0
    assert saddle_sign(corners, 0.05)[0].tolist() == [0]
    assert saddle_sign(20 * corners, 1.0)[0].tolist() == [0]  # Exactly, in whole numbers.
    field = Field.of(values)
    mesh = METHODS["asymptotic-decider"](field, 0.05)
    outcome = Outcome(Status.OK, mesh.vertices, mesh.simplices)
    case = Case("own/tenths", lambda: field, (0.05,), values.size)
    found = bilinear.bilinear(Trial(case, field, Declaration("here"), {"plain": outcome}))
    assert found.verdict is Verdict.PASS
    assert found.numbers["degenerate"] >= 1
