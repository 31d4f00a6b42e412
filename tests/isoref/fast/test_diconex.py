"""DICONEX, vectorised: the article's numbers, the laws of contours, two libraries beside them."""

from itertools import pairwise
from typing import get_args

import contourpy
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from isoref.diconex import Border, Mode
from isoref.diconex import diconex as diconex_plainly
from isoref.fast.diconex import diconex
from isoref.field import Field, Floats, Integers
from skimage.measure import find_contours

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


def images() -> st.SearchStrategy[Integers]:
    """Small images of small whole numbers: many ties, many points of ambiguity."""
    shapes = array_shapes(min_dims=2, max_dims=2, max_side=7)
    drawn: st.SearchStrategy[Integers] = arrays(np.int64, shapes, elements=st.integers(0, 3))
    return drawn


def signed_area(polygon: Floats) -> float:
    """Twice the area, positive counterclockwise."""
    x, y = polygon[:-1].T
    u, v = polygon[1:].T
    return float((x * v - y * u).sum())


@given(images(), st.sampled_from(MODES), st.sampled_from(get_args(Border)), st.booleans())
def test_the_twin_has_the_numbers_of_the_article(
    image: Integers, mode: Mode, border: Border, displaced: bool
) -> None:
    """Points and successors, in the same order, to the last bit."""
    field = Field.of(image, spacing=(1, 0.3), origin=(5, 0.1))
    fast, plain = (
        make(field, 2, mode=mode, border=border, displaced=displaced)
        for make in (diconex, diconex_plainly)
    )
    assert np.array_equal(fast.points, plain.points)
    assert np.array_equal(fast.successor, plain.successor)


@given(images(), st.sampled_from(MODES), st.booleans())
def test_undisplaced_contours_enclose_the_active_pixels(
    image: Integers, mode: Mode, displaced: bool
) -> None:
    """Closed contours wind once round every active pixel centre and never round another."""
    polygons = diconex(image, 1.5, mode=mode, border="closed", displaced=displaced).polygons()
    for (i, j), value in np.ndenumerate(image):
        turns = sum(winding(polygon - [i, j]) for polygon in polygons)
        assert turns == (value >= 1.5)


def winding(polygon: Floats) -> int:
    """Times a closed polygon turns counterclockwise round the origin."""
    angles = np.unwrap(np.arctan2(polygon[:, 1], polygon[:, 0]))
    return round(float(angles[-1] - angles[0]) / (2 * np.pi))


@given(images(), st.sampled_from(MODES))
def test_every_vector_has_one_predecessor(image: Integers, mode: Mode) -> None:
    """No gap and no branch: the successors of closed contours are a permutation."""
    successor = diconex(image, 2, mode=mode, border="closed").successor
    assert np.array_equal(np.sort(successor), np.arange(len(successor)))


@given(images(), st.sampled_from(MODES))
def test_open_contours_are_the_closed_ones_cut_at_the_border(image: Integers, mode: Mode) -> None:
    """With an open border every point lies on the hull of the samples, and no other is lost."""
    top = np.array(image.shape) - 1
    closed = diconex(image, 2, mode=mode, border="closed").mesh
    ends = closed.vertices[closed.simplices]
    kept = [pair for pair in ends.tolist() if np.all((np.array(pair) >= 0) & (pair <= top))]
    cut = diconex(image, 2, mode=mode).mesh
    got = cut.vertices[cut.simplices]
    assert sorted(map(str, kept)) == sorted(map(str, got.tolist()))


def segments(polygons: list[Floats]) -> set[tuple[tuple[float, ...], ...]]:
    """Unordered segments with rounded ends."""
    return {
        tuple(sorted((tuple(a), tuple(b))))
        for polygon in polygons
        for a, b in pairwise((np.round(polygon, 6) + 0.0).tolist())
    }


@pytest.mark.parametrize(("mode", "connected"), [("disconnect", "low"), ("connect", "high")])
def test_segments_agree_with_scikit_image(mode: Mode, connected: str) -> None:
    """Marching squares of another hand, in the same two modes, gives the same segments."""
    image = np.random.default_rng(1).normal(size=(40, 31))
    theirs = find_contours(image, 0.1, fully_connected=connected)
    assert segments(diconex(image, 0.1, mode=mode).polygons()) == segments(theirs)


def test_mixed_segments_agree_with_contourpy() -> None:
    """Contourpy decides an ambiguous square by the mean of its corners too (`serial`)."""
    image = np.random.default_rng(2).normal(size=(40, 31))
    lines = contourpy.contour_generator(z=image, name="serial").lines(0.1)
    theirs = [np.asarray(line)[:, ::-1] for line in lines]
    assert segments(diconex(image, 0.1).polygons()) == segments(theirs)


def test_positions_follow_spacing_and_origin() -> None:
    """A vertex is origin + index * spacing."""
    image = np.random.default_rng(3).normal(size=(6, 5))
    plain = diconex(image, 0.0).points
    placed = diconex(Field.of(image, spacing=(2, 0.5), origin=(1, -1)), 0.0).points
    assert np.allclose(placed, plain * [2, 0.5] + [1, -1])


def test_no_contour_outside_the_range() -> None:
    """An isovalue nobody reaches gives no point, one that all reach only the border."""
    assert len(diconex(SHAPE, 2).points) == 0
    assert len(diconex(SHAPE, 0).points) == 0
    assert len(diconex(SHAPE, 0, border="closed").polygons()) == 1


def test_integers_do_not_wrap() -> None:
    """uint8 samples are averaged and subtracted as real numbers."""
    image = np.array([[250, 3], [0, 251]], np.uint8)
    for mode in MODES:
        small = diconex(image, 127, mode=mode, border="closed")
        real = diconex(image.astype(float), 127, mode=mode, border="closed")
        assert np.array_equal(small.points, real.points)
        assert np.array_equal(small.successor, real.successor)


@pytest.mark.parametrize("scale", [1e-320, 1e-150, 1e150, 1e307])
def test_points_do_not_depend_on_the_scale_of_the_values(scale: float) -> None:
    """Scaling the samples and the isovalue together moves no point."""
    image = np.array([[0.0, 1, 0], [2, 0, 1], [1, 2, -2]])
    assert np.allclose(diconex(image * scale, 0.5 * scale).points, diconex(image, 0.5).points)


def test_an_image_of_one_pixel() -> None:
    """Alone it has no neighbours: nothing in an open border, four vectors round it in a closed."""
    assert diconex([[1]], 0.5).polygons() == []
    (closed,) = diconex([[1]], 0.5, border="closed").polygons()
    assert closed.shape == (5, 2)
    assert signed_area(closed) == pytest.approx(2 * 0.5)
    assert diconex([[0]], 0.5, border="closed").polygons() == []


def test_a_row_of_pixels_has_points_and_no_vectors() -> None:
    """One pixel wide: every support point is a contour by itself, with an open border."""
    contours = diconex([[1, 0, 3]], 0.5)
    assert [p.tolist() for p in contours.polygons()] == [[[0, 0.5]], [[0, pytest.approx(7 / 6)]]]
    assert len(contours.mesh.simplices) == 0


def test_an_image_of_active_pixels_is_enclosed_once() -> None:
    """Nothing in an open border; one contour half a pixel out, without its corners, in a closed."""
    full = np.full((3, 4), 7)
    for mode in MODES:
        assert diconex(full, 7, mode=mode).polygons() == []
        (closed,) = diconex(full, 7, mode=mode, border="closed").polygons()
        assert len(closed) == 14 + 1
        assert signed_area(closed) == pytest.approx(2 * (12 - 4 / 8))
