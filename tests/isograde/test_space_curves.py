"""Known curves: zero on both functions, and linked and knotted as their names say."""

import numpy as np
import pytest
from isograde.oracles.space_curves import (
    KNOWN,
    KnownCurves,
    Points,
    distances,
    hopf_link,
    is_closed,
    knot_determinant,
    length,
    linking_by_area,
    linking_by_crossings,
    linking_numbers,
    phase_winding,
    trefoil,
)
from scipy.interpolate import CubicSpline

ALL = [make() for make in KNOWN]
NAMES = [known.name for known in ALL]


def thinned(curve: Points, step: int = 8) -> Points:
    """Every so many points of a closed curve."""
    return np.asarray(np.concatenate([curve[:-1:step], curve[:1]]), np.float64)


def circle(radius: float, centre: tuple[float, float, float], turn: bool, n: int = 60) -> Points:
    """A closed polygon in the plane of x, y, or of x, z where `turn`."""
    t = np.linspace(0, 2 * np.pi, n + 1)
    flat = radius * np.stack([np.cos(t), np.sin(t), 0 * t], axis=1)
    flat[-1] = flat[0]
    return np.asarray((flat[:, [0, 2, 1]] if turn else flat) + np.array(centre))


@pytest.mark.parametrize("known", ALL, ids=NAMES)
def test_both_functions_vanish_on_the_curves(known: KnownCurves) -> None:
    """The parametrisation and the functions are written down independently."""
    assert known.curves
    for curve in known.curves:
        assert np.abs(known.first(*curve.T)).max() < 1e-12
        assert np.abs(known.second(*curve.T)).max() < 1e-12
        assert np.abs(curve).max() <= known.half


@pytest.mark.parametrize("known", ALL, ids=NAMES)
def test_nothing_else_in_the_cube_is_zero(known: KnownCurves) -> None:
    """Newton's iteration from a grid of starts ends on the curves, wherever it converges."""
    axis = np.linspace(-0.97, 0.97, 9) * known.half
    p = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    for _ in range(60):
        p = p + np.clip(_newton_step(known, p), -0.2, 0.2)
    inside = np.abs(p).max(axis=1) <= known.half
    small = np.abs(known.first(*p.T)) + np.abs(known.second(*p.T)) < 1e-12
    found = p[inside & small]
    assert len(found) > 100
    # Where surfaces touch, a small value does not mean a small distance.
    assert distances(found, known.curves).max() < (5e-4 if known.transversal else 1e-2)


def _newton_step(known: KnownCurves, p: Points) -> Points:
    """The least step to the zero of both linearised functions, at each point."""
    e = 1e-6 * np.eye(3)
    values = np.stack([known.first(*p.T), known.second(*p.T)], axis=1)
    jacobian = np.stack(
        [[(f(*(p + d).T) - f(*(p - d).T)) / 2e-6 for d in e] for f in (known.first, known.second)]
    )
    inverse = np.linalg.pinv(jacobian.transpose(2, 0, 1), 1e-8)
    return np.asarray(-np.einsum("pij,pj->pi", inverse, values))


@pytest.mark.parametrize("known", [k for k in ALL if k.transversal], ids=lambda k: k.name)
def test_links_and_knots_are_those_stated(known: KnownCurves) -> None:
    """From the dense polylines, thinned; curves that cross each other have no linking number."""
    loops = [thinned(curve) for curve in known.curves if is_closed(curve)]
    assert linking_numbers(loops) == list(known.links)
    assert sorted(knot_determinant(loop) for loop in loops) == list(known.determinants)


def test_linking_numbers_agree_two_ways() -> None:
    """The solid-angle sum and the signed crossings of a projection, orientation included."""
    apart = circle(1, (0, 0, 0), False), circle(1, (5, 0, 0.1), True)
    linked = circle(1, (0, 0, 0), False), circle(1, (1, 0.05, 0.02), True)
    hopf = tuple(thinned(curve) for curve in hopf_link().curves)
    for (one, two), expected in ((apart, 0), (linked, 1), (hopf, 1)):
        area, crossed = linking_by_area(one, two), linking_by_crossings(one, two)
        assert area == pytest.approx(crossed, abs=1e-9)
        assert abs(area) == pytest.approx(expected, abs=1e-9)
        assert linking_by_area(one[::-1], two) == pytest.approx(-area, abs=1e-9)


def test_a_curve_wound_three_times_around_has_linking_number_three() -> None:
    """A coil on a torus, around the torus's core and through it."""
    t = np.linspace(0, 2 * np.pi, 400)
    coil = np.stack(
        [
            (2 + 0.5 * np.cos(3 * t)) * np.cos(t),
            (2 + 0.5 * np.cos(3 * t)) * np.sin(t),
            0.5 * np.sin(3 * t),
        ],
        axis=1,
    )
    coil[-1] = coil[0]
    assert abs(linking_by_area(coil, circle(2, (0, 0, 0), False))) == pytest.approx(3, abs=1e-9)
    assert linking_numbers([coil, circle(2, (0, 0, 0), False)]) == [3]
    assert knot_determinant(coil) == 1


@pytest.mark.parametrize(("p", "q", "determinant"), [(2, 3, 3), (2, 5, 5), (3, 4, 3), (2, 7, 7)])
def test_determinants_of_torus_knots(p: int, q: int, determinant: int) -> None:
    """Of the (2, q) torus knot q; of (3, 4), the knot 8_19, three."""
    t = np.linspace(0, 2 * np.pi, 500)
    r = 2 + 0.7 * np.cos(q * t)
    knot = np.stack([r * np.cos(p * t), r * np.sin(p * t), 0.7 * np.sin(q * t)], axis=1)
    knot[-1] = knot[0]
    assert knot_determinant(knot) == determinant


def test_the_figure_eight_knot_has_determinant_five() -> None:
    """A knot that is on no torus."""
    t = np.linspace(0, 2 * np.pi, 400)
    r = 2 + np.cos(2 * t)
    knot = np.stack([r * np.cos(3 * t), r * np.sin(3 * t), np.sin(4 * t)], axis=1)
    knot[-1] = knot[0]
    assert knot_determinant(knot) == 5


def test_distances_are_to_segments_not_to_points() -> None:
    """The middle of a long segment is near it; lengths add up."""
    line = np.array([[0.0, 0, 0], [10, 0, 0]])
    np.testing.assert_allclose(distances(np.array([[5.0, 0.5, 0], [12, 0, 0]]), [line]), [0.5, 2])
    assert length(line) == 10
    (knot,) = trefoil().curves
    turn = np.linspace(0, 1, len(knot))
    slope = CubicSpline(turn, knot, bc_type="periodic").derivative()
    even = np.linspace(0, 1, 50_000, endpoint=False)
    arc = np.linalg.norm(slope(even), axis=1).mean()
    assert trefoil().length == pytest.approx(arc, rel=1e-4)


@pytest.mark.parametrize("known", ALL, ids=NAMES)
def test_samples_are_raised_to_their_levels(known: KnownCurves) -> None:
    """Both functions on the lattice of the cube, so that the curves are where both are at them."""
    first, second, spacing = known.sample((3, 5, 4))
    place = -known.half + spacing * [2, 1, 3]
    one, two = known.levels
    assert first[2, 1, 3] - one == pytest.approx(float(known.first(*place)))
    assert second[2, 1, 3] - two == pytest.approx(float(known.second(*place)))
    assert place[[0, 2]] == pytest.approx([known.half, known.half])


@pytest.mark.parametrize("axis", range(3))
def test_the_phase_turns_once_around_a_line_along_the_axis(axis: int) -> None:
    """Counterclockwise for u + iv, clockwise for u - iv; elsewhere not at all."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    shape = (4, 5, 6)
    index = np.indices(shape)
    wave = (index[u] - 1.4) + 1j * (index[v] - 2.3)
    at: list[slice | int] = [slice(None)] * 3
    at[u], at[v] = 1, 2
    for psi, turns in ((wave, 1), (wave.conj(), -1)):
        expected = np.zeros([n - (a != axis) for a, n in enumerate(shape)], int)
        expected[tuple(at)] = turns
        assert np.array_equal(phase_winding(np.angle(psi), axis), expected)
        for other in (u, v):
            assert not phase_winding(np.angle(psi), other).any()


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("place", [(0.1, 0.2), (0.9, 0.2), (0.9, 0.8), (0.1, 0.8), (0.5, 0.4)])
def test_a_line_anywhere_in_a_face_turns_the_phase(axis: int, place: tuple[float, float]) -> None:
    """Beside each of the four corners, and in the middle: in no other face."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    index = np.indices((3, 3, 3))
    found = phase_winding(np.angle(index[u] - place[0] + 1j * (index[v] - 1 - place[1])), axis)
    faces = np.moveaxis(found, (axis, u, v), (0, 1, 2))
    assert faces.tolist() == [[[0, 1], [0, 0]]] * 3


def test_the_bend_is_the_largest_within_reach_and_no_farther() -> None:
    """Of x ** 3 on the axis of z it is 6 reach; of a paraboloid it is the same everywhere."""

    def cubic(x: Points, y: Points, z: Points) -> Points:
        return np.asarray(x**3 + 0 * (y + z))

    def paraboloid(x: Points, y: Points, z: Points) -> Points:
        return np.asarray(x**2 + 2 * y**2 + z)

    axis = np.linspace(0, 1, 90)[:, None] * [0, 0, 1.0]
    known = KnownCurves("axis", cubic, paraboloid, 1.0, (axis,))
    assert known.bend(0.25) == pytest.approx((1.5, 20**0.5), rel=1e-6)
