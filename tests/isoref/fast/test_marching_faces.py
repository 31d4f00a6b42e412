"""Marching faces, vectorised: the article's points and curves, exact closure, known curves."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from isograde.oracles.space_curves import phase_winding
from isoref import marching_faces as article
from isoref.curves import Curve
from isoref.fast.marching_faces import (
    AMBIGUOUS,
    LINES,
    Pair,
    gradients,
    intersection_curves,
    join,
    marching_faces,
    nodal_lines,
    voxel_configurations,
)
from isoref.field import Field, FieldError
from isoref.marching_faces import FacePoints, FaceRule, across_at_ends
from isoref.plane_waves import nodal_density, random_waves

RULES: tuple[FaceRule, ...] = ("gradient", "middle", "asymptotic", "separated", "joined")


def lattice(n: int, half: float = 1.5) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coordinates of n samples a side over the cube of this half side."""
    x, y, z = np.meshgrid(*[np.linspace(-half, half, n)] * 3, indexing="ij")
    return x, y, z


def placed(values: np.ndarray, half: float = 1.5) -> Field:
    """The field with these samples over the cube of this half side."""
    return Field.of(values, 2 * half / (len(values) - 1), (-half,) * 3)


def ends_on_border(curves: list[Curve], field: Field) -> bool:
    """Whether each open curve ends on the border of the lattice, in exact coordinates."""
    low, high = field.position([0, 0, 0]), field.position(np.array(field.shape) - 1)
    ends = [curve.points[[0, -1]] for curve in curves if not curve.closed]
    return all(bool(((end == low) | (end == high)).any(axis=1).all()) for end in ends)


def assert_same(a: FacePoints, b: FacePoints) -> None:
    """The same points in the same order."""
    for name in ("voxels", "faces", "headings", "edges"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name))
    for name in ("positions", "tangents", "confidence"):
        np.testing.assert_allclose(getattr(a, name), getattr(b, name), rtol=0, atol=1e-12)


class TestTables:
    """The tables follow from their definitions."""

    def test_figure_3_has_six_configurations_under_rotation(self) -> None:
        """Six unique configurations; by rotation all 16 are obtained."""
        turned = [min((c << i | c >> (4 - i)) & 15 for i in range(4)) for c in range(16)]
        assert len(set(turned)) == 6
        assert np.flatnonzero(AMBIGUOUS).tolist() == [0b0101, 0b1010]
        lines = (LINES[1, :, :, 0] >= 0).sum(axis=1)
        assert lines[[0, 1, 3, 5, 7, 15]].tolist() == [0, 1, 1, 2, 1, 0]

    def test_lines_use_each_mixed_edge_once_and_keep_the_inside_right(self) -> None:
        """SETUPLINES: every pair of points on the edges is an isoline of the face."""
        vertices = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
        middle = (vertices + np.roll(vertices, -1, axis=0)) / 2
        for separated in (0, 1):
            for c in range(16):
                lines = [line for line in LINES[separated, c].tolist() if line[0] >= 0]
                mixed = [e for e in range(4) if (c >> e & 1) != (c >> (e + 1) % 4 & 1)]
                assert sorted(e for line in lines for e in line) == mixed
                for start, end in lines:
                    (du, dv), away = middle[end] - middle[start], vertices - middle[start]
                    side = np.sign(du * away[:, 1] - dv * away[:, 0])
                    left, right = (
                        {bool(c >> i & 1) for i in np.flatnonzero(side == s)} for s in (1, -1)
                    )
                    if not AMBIGUOUS[c]:
                        assert (left, right) == ({False}, {True})
                    elif separated:
                        assert right == {True}
                    else:
                        assert left == {False}

    def test_voxel_configurations_agree_with_the_plain_one(self) -> None:
        """Eq. 2 folded axis by axis gives the same byte as corner by corner."""
        values = np.random.default_rng(0).normal(size=(4, 3, 5))
        surface = article.Isosurface(Field.of(values), 0.1, "gradient")
        found = voxel_configurations(values >= 0.1)
        assert found.shape == (3, 2, 4)
        for index in np.ndindex(3, 2, 4):
            assert found[index] == article.voxel_config(surface, index)

    def test_gradients_are_central_and_one_sided_at_the_border(self) -> None:
        """Eq. 4, against numpy.gradient."""
        field = Field.of(np.random.default_rng(1).normal(size=(4, 3, 2)), (0.5, 1, 2))
        expected = np.moveaxis(np.asarray(np.gradient(field.values, 0.5, 1, 2)), 0, -1)
        indices = np.moveaxis(np.indices(field.shape), 0, -1)
        np.testing.assert_allclose(gradients(field, indices), expected, atol=1e-14)


def assert_same_curves(a: list[Curve], b: list[Curve]) -> None:
    """The same curves in the same order, to the last bit."""
    assert [curve.closed for curve in a] == [curve.closed for curve in b]
    for one, other in zip(a, b, strict=True):
        np.testing.assert_array_equal(one.points, other.points)


class TestTwins:
    """The twin gives what the article gives."""

    @pytest.mark.parametrize("rule", RULES)
    def test_the_sweep_gives_the_points_of_the_plain_loop(self, rule: FaceRule) -> None:
        """Noise has every configuration and many ambiguous faces."""
        chance = np.random.default_rng(2)
        a, b = (Field.of(chance.normal(size=(5, 6, 4)), (1, 0.5, 2)) for _ in range(2))
        given = a, b, (0.1, -0.2), rule
        assert len(marching_faces(*given)) > 50
        assert_same(marching_faces(*given), article.marching_faces(*given))
        assert_same_curves(intersection_curves(*given), article.intersection_curves(*given))

    @settings(max_examples=60)
    @given(st.lists(st.integers(-2, 2), min_size=54, max_size=54), st.sampled_from(RULES))
    def test_the_twins_agree_on_ties(self, numbers: list[int], rule: FaceRule) -> None:
        """Small integers tie on edges, corners and saddles."""
        a, b = (Field.of(part) for part in np.array(numbers).reshape(2, 3, 3, 3))
        assert_same(marching_faces(a, b, rule=rule), article.marching_faces(a, b, rule=rule))
        assert_same_curves(
            intersection_curves(a, b, rule=rule), article.intersection_curves(a, b, rule=rule)
        )

    def test_the_twins_agree_beyond_what_a_float_holds(self) -> None:
        """Whole numbers round 2^60, many of them one and the same float."""
        chance = np.random.default_rng(5)
        a, b = (Field.of(2**60 + chance.integers(-200, 200, (4, 4, 4))) for _ in range(2))
        levels = float(2**60), float(2**60)
        assert len(marching_faces(a, b, levels)) > 20
        assert_same(marching_faces(a, b, levels), article.marching_faces(a, b, levels))

    def test_no_common_voxel_gives_no_points(self) -> None:
        """Surfaces that never meet: no crash, nothing found."""
        x, _, _ = lattice(5)
        a, b = placed(x - 1), placed(x + 1)
        assert len(marching_faces(a, b)) == len(article.marching_faces(a, b)) == 0
        assert intersection_curves(a, b) == []

    def test_the_running_count_finds_the_points_of_a_voxel(self) -> None:
        """I_P of table 4: as I_T of eq. 1."""
        psi = random_waves((9, 9, 9), 12.0, seed=4)
        points = marching_faces(Field.of(psi.real), Field.of(psi.imag))
        count = points.running_count()
        assert len(points) == count[-1] > 20
        for k in (0, 100, 301, 511):
            start = count[k - 1] if k else 0
            assert (points.voxels[start : count[k]] == k).all()


class TestClosure:
    """Curves are whole, whatever the numbers."""

    @settings(max_examples=150)
    @given(
        st.lists(st.integers(-3, 3), min_size=96, max_size=96),
        st.sampled_from(RULES),
        st.sampled_from([0.0, 0.5]),
    )
    def test_curves_close_or_end_on_the_border_whatever_the_numbers(
        self, numbers: list[int], rule: FaceRule, isovalue: float
    ) -> None:
        """As many points enter a voxel as leave it, ties and touching surfaces included."""
        a, b = (Field.of(part) for part in np.array(numbers).reshape(2, 4, 3, 4))
        points = marching_faces(a, b, (0.0, isovalue), rule)
        chains = join(points, Pair(a, b, (0.0, isovalue), rule))
        assert sorted(i for chain, _ in chains for i in chain.tolist()) == list(range(len(points)))
        assert ends_on_border([Curve(points.positions[c], closed) for c, closed in chains], a)

    def test_noise_closes_too(self) -> None:
        """Crowded voxels: up to several points in and out."""
        chance = np.random.default_rng(7)
        a, b = (Field.of(chance.normal(size=(12, 12, 12))) for _ in range(2))
        points, curves = marching_faces(a, b), intersection_curves(a, b)
        assert sum(len(curve.points) for curve in curves) == len(points) > 1000
        assert ends_on_border(curves, a)

    def test_a_face_has_one_to_four_points(self) -> None:
        """Section 6 says one or two; two ambiguous configurations make up to four."""
        chance = np.random.default_rng(3)
        a, b = (Field.of(chance.normal(size=(14, 14, 14))) for _ in range(2))
        points = marching_faces(a, b)
        _, count = np.unique(6 * points.voxels + points.faces, return_counts=True)
        assert np.unique(count).tolist() == [1, 2, 3, 4]

    def test_identical_surfaces_have_no_point_in_common(self) -> None:
        """The stated answer: as if the first isovalue were lower by a trifle."""
        x, y, z = lattice(9)
        ball = placed(1 - x**2 - y**2 - z**2)
        assert intersection_curves(ball, ball) == []
        assert intersection_curves(ball, placed(2 * ball.values)) == []
        assert intersection_curves(ball, placed(-ball.values)) == []

    def test_surfaces_that_are_the_same_but_for_rounding_have_whole_curves_or_none(self) -> None:
        """A third is not exact, so that some crossings of edges differ in their last bit."""
        chance = np.random.default_rng(7)
        noise = chance.normal(size=(9, 9, 9))
        curves = intersection_curves(Field.of(noise), Field.of(3 * noise))
        assert curves
        assert ends_on_border(curves, Field.of(noise))

    def test_a_tangent_plane_has_whole_curves_or_none(self) -> None:
        """A sphere that touches a plane from inside: no half curves."""
        x, y, z = lattice(13)
        for height in (1.0, 0.99, 1.01):
            sphere, plane = placed(1 - x**2 - y**2 - z**2), placed(z - height)
            assert all(curve.closed for curve in intersection_curves(sphere, plane))

    def test_swapping_the_fields_turns_the_curves_round_and_nothing_else(self) -> None:
        """Same points; ``grad psi_2 x grad psi_1`` is the opposite direction."""
        chance = np.random.default_rng(3)
        a, b = (Field.of(chance.normal(size=(6, 6, 6))) for _ in range(2))
        one, two = marching_faces(a, b), marching_faces(b, a)
        assert {tuple(p) for p in one.positions} == {tuple(p) for p in two.positions}
        assert len(intersection_curves(a, b)) == len(intersection_curves(b, a))
        np.testing.assert_array_equal(np.sort(one.headings), np.sort(-two.headings))


class TestKnownCurves:
    """Curves whose equations are known."""

    def test_two_spheres_meet_in_a_circle_to_second_order(self) -> None:
        """Error of the circle's radius and of its length falls four times as the cell halves."""
        errors = []
        for n in (16, 31, 61):
            x, y, z = lattice(n)
            a = placed(1 - (x + 0.31) ** 2 - y**2 - (z - 0.02) ** 2)
            b = placed(1 - (x - 0.31) ** 2 - y**2 - (z - 0.02) ** 2)
            (circle,) = intersection_curves(a, b)
            radius = np.hypot(circle.points[:, 1], circle.points[:, 2] - 0.02)
            errors.append(np.abs(radius - np.sqrt(1 - 0.31**2)).max())
            assert circle.closed
            np.testing.assert_allclose(circle.points[:, 0], 0, atol=0.1 / n)
        orders = -np.diff(np.log2(errors))
        assert (orders > 1.6).all(), (errors, orders)

    def test_tangents_are_those_of_the_circle(self) -> None:
        """Unit tangents along ``grad psi_1 x grad psi_2``; the curve runs along them."""
        x, y, z = lattice(31)
        a, b = placed(1 - x**2 - y**2 - z**2), placed(z - 0.205)
        points = marching_faces(a, b)
        radial = points.positions * [1, 1, 0]
        # grad a points inwards, grad b up: the cross product runs clockwise seen from above.
        expected = np.cross(-radial, [0, 0, 1.0])
        expected /= np.linalg.norm(expected, axis=1, keepdims=True)
        np.testing.assert_allclose(points.tangents, expected, atol=0.01)
        height = 0.205
        np.testing.assert_allclose(points.confidence, np.sqrt(1 - height**2), atol=0.01)
        (circle,) = intersection_curves(a, b)
        steps = np.diff(circle.polyline, axis=0)
        middle = circle.points + steps / 2
        assert (np.einsum("ij,ij->i", steps, np.cross(-middle * [1, 1, 0], [0, 0, 1.0])) > 0).all()

    def test_parallel_gradients_have_no_confidence_and_no_tangent(self) -> None:
        """Section 6: almost co-planar surfaces have a small cross product."""
        x, y, _ = lattice(9)
        points = marching_faces(placed(x + 0.04), placed(x + 0.04 + 1e-9 * y - 1e-10))
        assert len(points) > 0
        assert (points.confidence < 1e-6).all()

    def test_the_gradient_decides_an_ambiguous_face(self) -> None:
        """Ridges along a diagonal stay whole by the gradient in the middle; the saddle cuts some.

        At the border, where differences are one-sided, gradients at the points p_j cut some too.
        """
        m = np.arange(8)
        ridges = np.cos(0.8 * np.pi * np.subtract.outer(m, m) + 0.3) - 0.4
        a = Field.of(np.repeat(ridges[:, :, None], 3, axis=2))
        b = Field.of(np.broadcast_to(np.arange(3) - 0.7, (8, 8, 3)))
        width = {
            rule: max(np.ptp(c.points[:, 0] - c.points[:, 1]) for c in found)
            for rule in ("middle", "asymptotic")
            for found in [intersection_curves(a, b, rule=rule)]
        }
        assert width["middle"] < 1e-12 < 0.1 < width["asymptotic"]

    def test_lines_run_across_the_gradients_at_their_ends(self) -> None:
        """An ambiguous face on a ridge, seen by all four gradients: joined along the ridge."""
        d = np.array([[1.0, 1.0], [-1.0, -1.0], [-1.0, -1.0], [1.0, 1.0]])
        g = np.array([[[1.0, -1.0], [1.0, 1.0]]] * 4)
        found = across_at_ends(d, g, np.ones(2))
        assert found[0] > 0 > found[1]
        turned = across_at_ends(d[[0, 2, 1, 3]], g[[0, 2, 1, 3]][:, :, ::-1], np.ones(2))
        np.testing.assert_allclose(turned, found, atol=1e-15)

    @pytest.mark.parametrize("size", [1e-300, 1e-160, 1.0, 1e160, 1e300])
    def test_tangents_and_confidence_are_right_for_any_magnitude(self, size: float) -> None:
        """Two planes at right angles, and an ambiguous face, in tiny and in huge numbers."""
        x, y, _ = lattice(7)
        points = marching_faces(placed((x - 0.03) * size), placed((y - 0.04) * size))
        assert len(points) > 0
        np.testing.assert_allclose(points.confidence, 1.0, rtol=1e-12)
        np.testing.assert_allclose(np.abs(points.tangents[:, 2]), 1.0, rtol=1e-12)
        noise = np.random.default_rng(0).normal(size=(2, 6, 6, 6))
        plain = marching_faces(Field.of(noise[0]), Field.of(noise[1]))
        one, two = (Field.of(part * 2.0 ** round(np.log2(size))) for part in noise)
        scaled = marching_faces(one, two)
        np.testing.assert_array_equal(plain.voxels, scaled.voxels)
        np.testing.assert_allclose(plain.tangents, scaled.tangents, atol=1e-9)

    def test_nodal_lines_of_random_waves_have_berrys_length(self) -> None:
        """Berry & Dennis 2000: ``k^2 / (3 pi)`` per unit volume, an answer from theory."""
        k = 30.0
        lengths = [
            sum(curve.length for curve in nodal_lines(random_waves((40,) * 3, k, 200, s), 1 / 39))
            for s in range(10)
        ]
        assert np.mean(lengths) == pytest.approx(nodal_density(k), rel=0.05)


class TestPhase:
    """The two fields as one complex wave, its phase as an independent witness."""

    @pytest.mark.parametrize("rule", RULES)
    @pytest.mark.parametrize("noise", [False, True])
    def test_headings_add_up_to_the_phase_winding_of_every_face(
        self, rule: FaceRule, noise: bool
    ) -> None:
        """The phase turns once around a nodal line, whatever the rule of ambiguous faces."""
        chance = np.random.default_rng(0)
        psi = random_waves((12, 10, 11), 20.0, seed=3)
        if noise:
            psi = chance.normal(size=(8, 9, 7)) + 1j * chance.normal(size=(8, 9, 7))
        points = marching_faces(Field.of(psi.real), Field.of(psi.imag), rule=rule)
        corner = np.stack(np.unravel_index(points.voxels, points.cells), axis=1)
        for axis in range(3):
            winding = phase_winding(np.angle(psi), axis)
            across = points.faces // 2 == axis
            place = corner[across]
            place[:, axis] += points.faces[across] % 2
            passing = np.zeros_like(winding)
            np.add.at(passing, tuple(place.T), points.headings[across])
            np.testing.assert_array_equal(passing, winding)
            assert (winding != 0).sum() > 50


class TestBadInput:
    """Errors name what was wrong."""

    def test_fields_must_share_a_lattice(self) -> None:
        """Shapes, spacings and origins are compared, and named."""
        a = Field.of(np.zeros((3, 3, 3)))
        with pytest.raises(FieldError, match=r"\(3, 3, 3\) and \(3, 3, 4\)"):
            marching_faces(a, Field.of(np.zeros((3, 3, 4))))
        with pytest.raises(FieldError, match="lattices differ"):
            marching_faces(a, Field.of(np.zeros((3, 3, 3)), 2.0))
        with pytest.raises(FieldError, match="field 2 has rank 2"):
            marching_faces(a, Field.of(np.zeros((3, 3))))
        with pytest.raises(FieldError, match="nan"):
            marching_faces(a, a, (0.0, float("nan")))
        with pytest.raises(FieldError, match="rule"):
            marching_faces(a, a, rule="guess")  # type: ignore[arg-type]

    def test_a_lattice_without_voxels_has_no_points(self) -> None:
        """One sample along an axis: nothing to march over."""
        flat = Field.of(np.arange(9.0).reshape(3, 1, 3) - 4)
        assert len(marching_faces(flat, flat)) == len(article.marching_faces(flat, flat)) == 0

    def test_integer_fields_of_different_types_are_welcome(self) -> None:
        """Values are compared with the isovalue as they are."""
        x, y, _ = np.meshgrid(*[np.arange(6)] * 3, indexing="ij")
        curves = intersection_curves(
            Field.of(x.astype(np.uint8)), Field.of(y.astype(np.int16)), (2.5, 1.25)
        )
        assert [len(c.points) for c in curves] == [6]
        np.testing.assert_allclose(curves[0].points[:, :2], [[2.5, 1.25]] * 6)
