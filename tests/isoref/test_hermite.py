"""Curves of higher order from points and tangents."""

import numpy as np
import pytest
from isoref.fast.marching_faces import intersection_curves
from isoref.field import Field, Floats
from isoref.hermite import completed, hermite, smooth_curves


def helix(t: Floats) -> tuple[Floats, Floats]:
    """Points and unit tangents of a helix."""
    points = np.stack([np.cos(t), np.sin(t), t / 3], axis=1)
    tangents = np.stack([-np.sin(t), np.cos(t), np.full_like(t, 1 / 3)], axis=1)
    return points, tangents / np.linalg.norm(tangents, axis=1, keepdims=True)


def error(samples: Floats) -> float:
    """The largest distance of samples from the helix, along the plane of their height."""
    t = 3 * samples[:, 2]
    return float(np.linalg.norm(samples - helix(t)[0], axis=1).max())


def test_a_known_curve_is_met_in_fourth_order() -> None:
    """A helix from 12, 24 and 48 points: order 4, where the polyline has 2."""
    errors = []
    for n in (13, 25, 49):
        points, tangents = helix(np.linspace(0, 2 * np.pi, n))
        middle = (points[1:] + points[:-1]) / 2
        errors.append([error(hermite(points, tangents, False, 8)), error(middle)])
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    np.testing.assert_allclose(orders[:, 0], 4, atol=0.2)
    np.testing.assert_allclose(orders[:, 1], 2, atol=0.1)


def test_the_points_are_on_the_curve_and_its_direction_is_theirs() -> None:
    """Open and closed."""
    points, tangents = helix(np.linspace(0, 5, 9))
    samples = hermite(points, tangents, False, 100)
    assert len(samples) == 801
    np.testing.assert_allclose(samples[::100], points, atol=1e-14)
    leaving = samples[1] - samples[0]
    np.testing.assert_allclose(leaving / np.linalg.norm(leaving), tangents[0], atol=0.02)
    t = np.linspace(0, 2 * np.pi, 7)[:-1]
    ring = np.stack([np.cos(t), np.sin(t)], axis=1)
    round_it = hermite(ring, np.stack([-np.sin(t), np.cos(t)], axis=1), True, 5)
    assert len(round_it) == 30
    np.testing.assert_allclose(np.linalg.norm(round_it, axis=1), 1, atol=0.03)


def test_curves_of_two_fields_are_nearer_to_the_true_one_than_their_polylines() -> None:
    """Two spheres meet in a circle: samples of the cubics beside those of the chords."""
    axis = np.linspace(-1.5, 1.5, 13)
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    one, two = (
        Field.of(1.0 - np.sqrt(x**2 + y**2 + (z - s) ** 2), axis[1] - axis[0], [-1.5] * 3)
        for s in (-0.42, 0.42)
    )
    radius = np.sqrt(1 - 0.42**2)

    def off(samples: Floats) -> float:
        return float(np.abs(np.linalg.norm(samples[:, :2], axis=1) - radius).mean())

    (chords,), (smooth,) = intersection_curves(one, two), smooth_curves(one, two, parts=4)
    assert smooth.closed
    middles = (chords.points + np.roll(chords.points, -1, axis=0)) / 2
    assert off(smooth.points[2::4]) < 0.75 * off(middles)


def test_a_point_without_a_tangent_takes_its_neighbours_direction() -> None:
    """Parallel gradients leave a tangent of 0."""
    points, tangents = helix(np.linspace(0, 1, 5))
    lame = tangents.copy()
    lame[2] = 0
    np.testing.assert_allclose(completed(points, lame, False)[2], tangents[2], atol=0.02)
    assert np.isfinite(hermite(points, np.zeros_like(points), False)).all()


def test_what_makes_no_curve_is_refused() -> None:
    """One point, two shapes, no parts."""
    points, tangents = helix(np.linspace(0, 1, 3))
    for wrong in ((points[:1], tangents[:1], 4), (points, tangents[:2], 4), (points, tangents, 0)):
        with pytest.raises(ValueError, match="at least two"):
            hermite(wrong[0], wrong[1], False, wrong[2])
