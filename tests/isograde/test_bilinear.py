"""Which corners the bilinear interpolant connects, beside a fine raster of the interpolant."""

import numpy as np
import pytest
from isograde.truths.bilinear import saddle_sign
from isoref.field import Floats
from scipy import ndimage


def raster(corners: Floats, n: int = 400) -> Floats:
    """The bilinear interpolant on a fine grid of the unit square."""
    s = np.linspace(0, 1, n)[:, None]
    t = np.linspace(0, 1, n)[None, :]
    b00, b10, b01, b11 = corners
    fine: Floats = (1 - s) * (1 - t) * b00 + s * (1 - t) * b10 + (1 - s) * t * b01 + s * t * b11
    return fine


@pytest.mark.parametrize("seed", range(40))
def test_the_saddle_says_what_a_raster_shows(seed: int) -> None:
    """The inside corners are one component of the raster exactly where the saddle is inside."""
    rng = np.random.default_rng(seed)
    corners = rng.uniform(0.2, 1, 4) * [1, -1, -1, 1] * rng.choice([-1, 1])
    label, _ = ndimage.label(raster(corners) >= 0)
    high = [label[0, 0], label[-1, -1]] if corners[0] > 0 else [label[-1, 0], label[0, -1]]
    sign, clarity = saddle_sign(corners[None], 0.0)
    if clarity[0] > 0.02:
        assert (high[0] == high[1]) == (sign[0] > 0)


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
