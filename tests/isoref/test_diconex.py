"""DICONEX, as the article has it: the contours of Schlei's Fig. 1."""

from collections.abc import Callable
from typing import get_args

import numpy as np
import pytest
from isoref.diconex import Contours, Mode, connects, diconex, successor
from isoref.fast.diconex import diconex as fast_diconex
from isoref.field import Field, FieldError, Floats

MODES = get_args(Mode)

# Eleven active pixels of 6 x 6 with a hole and a corner contact, in the spirit of Fig. 1a.
SHAPE = np.array(
    [
        [0, 0, 0, 0, 0, 0],
        [0, 1, 1, 1, 0, 0],
        [0, 1, 0, 1, 0, 0],
        [0, 1, 1, 1, 0, 0],
        [0, 0, 0, 0, 1, 1],
        [0, 0, 0, 0, 1, 0],
    ]
)


def signed_area(polygon: Floats) -> float:
    """Twice the area, positive counterclockwise."""
    x, y = polygon[:-1].T
    u, v = polygon[1:].T
    return float((x * v - y * u).sum())


def test_a_single_pixel_is_enclosed_counterclockwise_by_four_vectors() -> None:
    """Fig. 1b: four initial contour vectors, the active pixel on their left."""
    (polygon,) = diconex([[0, 0, 0], [0, 1, 0], [0, 0, 0]], 0.5).polygons()
    assert len(polygon) == 5
    assert signed_area(polygon) == 2 * 0.5


def test_holes_run_clockwise() -> None:
    """Section II.A: a shape is enclosed counterclockwise, its holes clockwise."""
    areas = [signed_area(p) for p in diconex(SHAPE, 1, border="closed", mode="connect").polygons()]
    assert sum(a > 0 for a in areas) == 1
    assert sum(a < 0 for a in areas) == 1


def test_disconnect_separates_what_connect_joins() -> None:
    """Fig. 1e, 1f: the pixels that meet in a corner have a contour each, or one together."""
    counts = {m: len(diconex(SHAPE, 1, mode=m, border="closed").polygons()) for m in MODES}
    assert counts == {"disconnect": 3, "connect": 2, "mixed": 3}


def test_displacement_is_the_papers_example() -> None:
    """Fig. 2c: between 133 and 0 the level 100 lies in the pixel of 133, at 1 - 100 / 133."""
    image = np.zeros((3, 3))
    image[1, 1] = 133
    points = diconex(image, 100).points
    assert np.allclose(np.abs(points - 1).max(axis=1), 1 - 100 / 133)
    still = diconex(image, 100, displaced=False).points
    assert np.array_equal(np.abs(still - 1).max(axis=1), np.full(4, 0.5))


def test_a_point_of_ambiguity_turns_left_to_disconnect_and_right_to_connect() -> None:
    """Fig. 1d, at the head of the vector of pixel (0, 0) that points up."""
    grey = {(0, 0): 1.0, (1, 0): -1.0, (0, 1): -1.0, (1, 1): 1.0}
    active = {(0, 0), (1, 1)}
    found = {mode: successor(((0, 0), 0), active, grey, mode) for mode in MODES}
    assert found == {"disconnect": ((0, 0), 1), "connect": ((1, 1), 3), "mixed": ((1, 1), 3)}
    assert [connects("mixed", 1, 1, -1, x) for x in (-1.0, -1.5)] == [True, False]


@pytest.mark.parametrize("extract", [diconex, fast_diconex])
def test_bad_input_is_named(extract: Callable[..., Contours]) -> None:
    """An error says what was wrong, in the article and in its twin."""
    with pytest.raises(FieldError, match="sample \\(0, 1\\) is nan"):
        extract([[0, np.nan]], 0.5)
    with pytest.raises(FieldError, match="dimension 3"):
        extract(Field.of(np.zeros((2, 2, 2))), 0.5)
    with pytest.raises(ValueError, match="mode 'both' is not one of"):
        extract(SHAPE, 1, mode="both")
    with pytest.raises(FieldError, match="isovalue nan is not finite"):
        extract(SHAPE, float("nan"))
    with pytest.raises(FieldError, match="shape \\(0, 3\\) has no samples"):
        extract(np.zeros((0, 3)), 0.5)
    with pytest.raises(FieldError, match="rank 1"):
        extract(np.zeros(3), 0.5)
    with pytest.raises(ValueError, match="border 'ajar' is not one of open, closed"):
        extract(SHAPE, 1, border="ajar")
