"""Surface intersection, vectorised: the article's segments, exact signs, known curves."""

from collections import Counter
from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from isograde.oracles.space_curves import KNOWN, KnownCurves, knot_determinant, linking_numbers
from isoref import asymptotic_decider, lorensen_cline, trilinear_cubes
from isoref import surface_intersection as article
from isoref.curves import Curve, real_and_imaginary
from isoref.fast import marching_faces
from isoref.fast import surface_intersection as surface_intersection_module
from isoref.fast.surface_intersection import (
    _link,
    _Pairs,
    candidate_pairs,
    enhanced_marching_cubes,
    intersection_curves,
    join_segments,
    names_of_rows,
    orientation,
    segment_chains,
    surface_intersection,
)
from isoref.field import Field, FieldError, Floats
from isoref.mesh import Mesh
from isoref.plane_waves import random_waves
from isoref.rule import Rule
from isoref.surface_intersection import (
    IndexedSurface,
    Segments,
    combine_line_segments,
    rational,
    triangle_intersection,
)
from scipy.ndimage import map_coordinates
from scipy.spatial import cKDTree


def waves(n: int, k: float, seed: int = 1) -> tuple[Field, Field]:
    """Real and imaginary part of random waves over the unit cube."""
    return real_and_imaginary(random_waves((n, n, n), k, seed=seed), 1 / (n - 1))


def surfaces(pair: tuple[Field, Field]) -> tuple[IndexedSurface, IndexedSurface]:
    """Both surfaces at the isovalue 0."""
    return enhanced_marching_cubes(pair[0], 0.0), enhanced_marching_cubes(pair[1], 0.0)


def heap(triangles: Floats) -> IndexedSurface:
    """Triangles (T, 3, 3) that all stand in one voxel."""
    mesh = Mesh.of(triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3))
    return IndexedSurface(mesh, np.zeros(len(triangles), np.int64), (1, 1, 1))


def placed(values: Floats, half: float = 1.5) -> Field:
    """The field with these samples over the cube of this half side."""
    return Field.of(values, 2 * half / (len(values) - 1), (-half,) * 3)


def assert_same(fast: Segments, plain: Segments, atol: float) -> None:
    """The same segments in the same order, with the same nodes up to their names."""
    assert fast.tests == plain.tests
    np.testing.assert_array_equal(fast.cells, plain.cells)
    np.testing.assert_allclose(fast.ends, plain.ends, atol=atol)
    names = set(zip(fast.nodes.ravel().tolist(), plain.nodes.ravel().tolist(), strict=True))
    assert (
        len(names)
        == len(set(fast.nodes.ravel().tolist()))
        == len(set(plain.nodes.ravel().tolist()))
    )
    chains = segment_chains(plain), article.segment_chains(plain)
    for (chain, closed), (same, closed_too) in zip(*chains, strict=True):
        np.testing.assert_array_equal(chain, same)
        assert closed == closed_too


def assert_whole(curves: list[Curve], field: Field) -> None:
    """Each curve is closed or ends on the border of the lattice."""
    low, high = field.position([0, 0, 0]), field.position(np.array(field.shape) - 1)
    for curve in curves:
        if not curve.closed:
            ends = curve.points[[0, -1]]
            assert (np.isclose(ends, low) | np.isclose(ends, high)).any(axis=1).all()


def assert_balanced(segments: Segments, last: int) -> None:
    """Inside a lattice of cells up to `last`, every node has as many segments in as out."""
    balance: Counter[int] = Counter()
    inside = np.asarray(((segments.ends > 0) & (segments.ends < last)).all(axis=2))
    balance.update(segments.nodes[inside[:, 0], 0].tolist())
    balance.subtract(segments.nodes[inside[:, 1], 1].tolist())
    assert not any(balance.values())


class TestIndex:
    """Enhanced marching cubes."""

    def test_each_triangle_lies_in_its_voxel(self) -> None:
        """Section 4, observation 1: any triangle is located inside only one voxel."""
        a, b = waves(9, 12.0)
        surface = enhanced_marching_cubes(a, 0.0)
        corner = np.stack(np.unravel_index(surface.cells, surface.shape), axis=1)
        place = surface.mesh.vertices[surface.mesh.simplices] * 8 - corner[:, None]
        assert place.min() > -1e-9
        assert place.max() < 1 + 1e-9
        assert b.shape == a.shape

    def test_only_pairs_of_one_voxel_are_tested(self) -> None:
        """Table 2, lines 3 to 6."""
        first, second = surfaces(waves(8, 9.0))
        i, j = candidate_pairs(first, second)
        expected = [
            (i, j)
            for i, cell in enumerate(first.cells.tolist())
            for j in np.flatnonzero(second.cells == cell).tolist()
        ]
        assert list(zip(i.tolist(), j.tolist(), strict=True)) == expected

    def test_an_empty_surface_needs_no_tests(self) -> None:
        """Appendix A: two surfaces never intersecting yield 0."""
        a, _ = waves(6, 9.0)
        full, empty = enhanced_marching_cubes(a, 0.0), enhanced_marching_cubes(a, 1e9)
        assert surface_intersection(full, empty).tests == 0
        assert join_segments(surface_intersection(empty, full)) == []
        assert empty.histogram().tolist() == [125]

    @pytest.mark.parametrize("apart", [0.125, 1e-12])
    def test_parallel_planes_in_one_layer_of_voxels_are_tested_and_do_not_meet(
        self, apart: float
    ) -> None:
        """Two triangles against two in each voxel of the layer; the other way finds nothing too."""
        z = np.indices((5, 4, 6))[2].astype(float)
        planes = Field.of(z - 2.5), Field.of(z - 2.5 - apart)
        segments = surface_intersection(*surfaces(planes))
        assert (segments.tests, len(segments.cells)) == (4 * 4 * 3, 0)
        assert marching_faces.intersection_curves(*planes) == []

    def test_identical_surfaces_need_about_n_tests_and_meet_nowhere(self) -> None:
        """Appendix A: "two more or less identical surfaces leads to N intersection tests"."""
        surface, _ = surfaces(waves(12, 9.0))
        segments = surface_intersection(surface, surface)
        n = len(surface.mesh.simplices)
        assert n <= segments.tests <= 5 * n
        assert join_segments(segments) == []

    @pytest.mark.parametrize("factor", [2.0, 3.0, -1.0])
    def test_the_same_surface_from_other_numbers_needs_as_many_tests(self, factor: float) -> None:
        """Exact, rounded, and facing the other way; what is found lies on the surface."""
        field, _ = waves(8, 9.0)
        values = np.asarray(field.values)
        pair = field, Field.of(factor * values, field.spacing)
        first, second = surfaces(pair)
        segments = surface_intersection(first, second)
        assert segments.tests == surface_intersection(first, first).tests
        curves = join_segments(segments)
        assert factor != 2.0 or curves == []
        places = [curve.points / field.spacing for curve in curves]
        found = map_coordinates(values, np.concatenate([*places, np.empty((0, 3))]).T, order=1)
        assert np.abs(found).max(initial=0.0) < 0.2 * np.abs(values).max()


class TestTriangles:
    """The intersection of two triangles."""

    @settings(max_examples=100)
    @given(st.lists(st.integers(-3, 3), min_size=12, max_size=12), st.floats(0, 1e-15))
    def test_signs_are_exact(self, numbers: list[int], shift: float) -> None:
        """Almost coplanar points, against rational arithmetic."""
        points = np.array(numbers, float).reshape(4, 3) / 3 + 0.1
        points[3] = points[:3].mean(axis=0) + shift
        exact = article.orientation(*(rational(p) for p in points))
        sign, unsure = orientation(*points[:, None])
        assert len(unsure) or sign.tolist() == [(exact > 0) - (exact < 0)]
        one, two = heap(points[None, :3]), heap(points[None, [3, 0, 1]])
        pairs = _Pairs(one, two, np.array([0]), np.array([0]))
        assert pairs.height(1, 0).tolist() == [(exact > 0) - (exact < 0)]

    @settings(max_examples=150)
    @given(st.lists(st.integers(0, 3), min_size=36, max_size=36), st.booleans())
    def test_the_fast_path_agrees_with_rational_arithmetic(
        self, numbers: list[int], generic: bool
    ) -> None:
        """On integers corners touch, edges cross and planes coincide; thirds are rounded."""
        corners = np.array(numbers, float).reshape(2, 2, 3, 3)
        if generic:
            corners = corners / 3 + np.random.default_rng(sum(numbers)).normal(size=corners.shape)
        one, two = heap(corners[0]), heap(corners[1])
        fast, plain = surface_intersection(one, two), article.surface_intersection(one, two)
        assert_same(fast, plain, 1e-9)

    def test_ends_lie_on_both_triangles_and_run_along_d(self) -> None:
        """Random triangles; the share that meets is known to be neither 0 nor 1."""
        corners = np.random.default_rng(5).normal(size=(2, 40, 3, 3))
        one, two = heap(corners[0]), heap(corners[1])
        i, j = candidate_pairs(one, two)
        segments = surface_intersection(one, two)
        normals = np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
        met = 0
        for a, b in zip(i.tolist(), j.tolist(), strict=True):
            meeting = triangle_intersection(
                [rational(p) for p in corners[0, a]], [rational(p) for p in corners[1, b]]
            )
            if meeting is None:
                continue
            start, stop = segments.ends[met]
            met += 1
            assert (stop - start) @ np.cross(normals[0, a], normals[1, b]) > 0
            for end in (start, stop):
                for corner in (corners[0, a], corners[1, b]):
                    weights = np.linalg.lstsq(
                        np.vstack([corner.T, np.ones(3)]), np.append(end, 1), rcond=None
                    )[0]
                    assert weights.min() > -1e-9
                    np.testing.assert_allclose(weights @ corner, end, atol=1e-9)
        assert met == len(segments.cells) > 50

    def test_vtk_finds_the_same_segments(self) -> None:
        """An independent implementation, on random triangles."""
        graphics = pytest.importorskip("vtkmodules.vtkFiltersGeneral")
        mutable = pytest.importorskip("vtkmodules.vtkCommonCore").mutable
        vtk_filter = graphics.vtkIntersectionPolyDataFilter
        corners = np.random.default_rng(6).normal(size=(2, 25, 3, 3))
        expected = []
        for a in corners[0].tolist():
            for b in corners[1].tolist():
                start, stop, ids = [0.0] * 3, [0.0] * 3, [0.0, 0.0]
                hit = vtk_filter.TriangleTriangleIntersection(
                    *a, *b, mutable(0), start, stop, ids, 1e-12
                )
                if hit:
                    expected.append(sorted([start, stop]))
        found = surface_intersection(heap(corners[0]), heap(corners[1])).ends
        np.testing.assert_allclose([sorted(e.tolist()) for e in found], expected, atol=1e-9)

    def test_coplanar_and_touching_triangles_have_their_stated_answers(self) -> None:
        """The module's text: behind is where a point in the plane counts."""
        flat = np.array([[0.0, 0, 0], [4, 0, 0], [0, 4, 0]])
        shifted = flat + np.array([0.5, 0.5, 0])
        above = np.array([[1.0, 1, 0], [1, 2, 1], [2, 1, 1]])
        on_edge = np.array([[1.0, 1, 0], [2, 1, 0], [1, 1, 1]])
        below = on_edge * [1, 1, -1]

        def meet(a: Floats, b: Floats) -> list[list[Floats]]:
            found = surface_intersection(heap(a[None]), heap(b[None])).ends.tolist()
            plain = article.surface_intersection(heap(a[None]), heap(b[None])).ends.tolist()
            assert found == plain
            return found  # type: ignore[no-any-return]

        assert meet(flat, shifted) == []
        assert meet(flat, flat) == []
        assert meet(flat, above) == [[[1, 1, 0], [1, 1, 0]]]
        assert meet(flat, above * [1, 1, -1]) == []
        assert sorted(meet(flat, on_edge)[0]) == [[1, 1, 0], [2, 1, 0]]
        assert meet(flat, below) == []


class TestNames:
    """Rows named by a hash."""

    @settings(max_examples=60)
    @given(st.lists(st.tuples(*[st.integers(-2, 2)] * 3), min_size=1, max_size=40))
    def test_equal_rows_and_no_others_have_one_name(self, rows: list[tuple[int, ...]]) -> None:
        """As whole numbers and as floats, whose bits are mostly zeros."""
        for kind in (np.int64, np.float64):
            names = names_of_rows(np.array(rows, kind) + kind(0)).tolist()
            assert len(set(names)) == len(set(rows)) == len(set(zip(names, rows, strict=True)))

    def test_rows_of_one_hash_are_told_apart(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """The worst hash there is."""
        monkeypatch.setattr(surface_intersection_module, "_mixed_up", lambda words: words * 0)
        names = names_of_rows(np.array([[1, 2], [3, 4], [1, 2], [5, 6]]))
        assert names[0] == names[2]
        assert len(set(names.tolist())) == 3

    def test_free_ends_are_linked_to_free_starts_in_order(self) -> None:
        """The first end on a node with its first start, the second with the second."""
        nodes = np.array([[7, 1], [1, 7], [7, 2], [9, 7], [7, 7]])
        successor = np.full(5, -1)
        _link(nodes, successor)
        assert successor.tolist() == [1, 0, -1, 2, 4]


class TestKnownCurves:
    """Curves whose equations are known, found by both methods."""

    @pytest.mark.parametrize("make", KNOWN, ids=lambda make: make.__name__)
    @pytest.mark.parametrize("module", [marching_faces, surface_intersection_module])
    def test_lengths_links_and_knots_are_those_known(
        self, make: Callable[[], KnownCurves], module: ModuleType
    ) -> None:
        """Circles, cylinders, Villarceau, hydrogen, Hopf link, trefoil; two isovalues."""
        known = make()
        first, second, spacing = known.sample((31, 33, 32))
        fields = [Field.of(f, spacing.tolist(), (-known.half,) * 3) for f in (first, second)]
        curves = module.intersection_curves(*fields, known.levels)
        assert_whole(curves, fields[0])
        length = sum(curve.length for curve in curves)
        assert length == pytest.approx(known.length, rel=0.02 if known.transversal else 0.08)
        if known.transversal:
            polylines = [curve.polyline for curve in curves]
            closed = [curve.polyline for curve in curves if curve.closed]
            assert (len(curves), len(closed)) == (len(known.curves), known.closed)
            assert linking_numbers(polylines) == list(known.links)
            assert sorted(map(knot_determinant, closed)) == list(known.determinants)


class TestCurves:
    """Joining, by identity and by distance, and marching faces beside."""

    def test_the_fast_segments_are_the_plain_ones(self) -> None:
        """Table 2 by its loops, in rational arithmetic."""
        pair = surfaces(waves(6, 9.0))
        fast = surface_intersection(*pair)
        assert len(fast.cells) > 50
        assert_same(fast, article.surface_intersection(*pair), 1e-12)

    def test_the_fast_curves_are_the_plain_ones(self) -> None:
        """The whole way, from the fields to the curves."""
        pair = waves(6, 9.0, 2)
        fast, plain = intersection_curves(*pair), article.intersection_curves(*pair)
        assert len(fast) == len(plain) > 3
        for one, other in zip(fast, plain, strict=True):
            assert one.closed == other.closed
            np.testing.assert_allclose(one.points, other.points, atol=1e-12)

    @settings(max_examples=40)
    @given(st.lists(st.integers(-2, 2), min_size=54, max_size=54))
    def test_both_find_the_same_segments_on_ties(self, numbers: list[int]) -> None:
        """Surfaces through each other's vertices: whatever touches, both say the same of it."""
        a, b = (Field.of(part) for part in np.array(numbers).reshape(2, 3, 3, 3))
        pair = surfaces((a, b))
        assert_same(surface_intersection(*pair), article.surface_intersection(*pair), 1e-12)

    @pytest.mark.parametrize("seed", range(3))
    def test_curves_close_or_end_on_the_border(self, seed: int) -> None:
        """Each node of a generic field has one segment in and one out."""
        pair = waves(20, 25.0, seed)
        curves = intersection_curves(*pair)
        assert len(curves) > 10
        assert_whole(curves, pair[0])

    @pytest.mark.parametrize("seed", range(3))
    def test_greedy_joining_finds_the_curves_of_exact_joining(self, seed: int) -> None:
        """Table 3 beside identity: the same sets of points, closed alike."""
        first, second = surfaces(waves(16, 18.0, seed))
        segments = surface_intersection(first, second)
        exact = join_segments(segments)
        greedy = combine_line_segments(segments, first.shape, 1e-6)

        def summary(curves: list[Curve]) -> list[tuple[bool, float]]:
            return sorted((c.closed, round(c.length, 9)) for c in curves)

        assert summary(greedy) == summary(exact)

    @pytest.mark.parametrize("seed", range(3))
    def test_every_marching_faces_point_lies_on_the_explicit_curves(self, seed: int) -> None:
        """With one face rule both ways have the same isolines on faces, hence the same points."""
        pair = waves(20, 25.0, seed)
        points = marching_faces.marching_faces(*pair, rule="asymptotic")
        ends = surface_intersection(*surfaces(pair)).ends.reshape(-1, 3)
        distance = np.asarray(cKDTree(ends).query(points.positions)[0])
        assert distance.max() < 1e-12

    @pytest.mark.parametrize("seed", range(3))
    def test_both_methods_find_the_same_curves(self, seed: int) -> None:
        """As many, as many closed, and the explicit ones no shorter, by a few percent at most."""
        pair = waves(24, 20.0, seed)
        explicit = intersection_curves(*pair)
        implicit = marching_faces.intersection_curves(*pair, rule="asymptotic")
        assert len(explicit) == len(implicit)
        assert sum(c.closed for c in explicit) == sum(c.closed for c in implicit)
        ratio = sum(c.length for c in implicit) / sum(c.length for c in explicit)
        assert 0.95 < ratio <= 1

    def test_curves_run_the_same_way_in_both_methods(self) -> None:
        """Along ``grad psi_1 x grad psi_2``."""
        z, y, x = np.meshgrid(*[np.linspace(-1.5, 1.5, 12)] * 3, indexing="ij")
        pair = placed(1 - x**2 - y**2 - z**2), placed(z - 0.2 + 0.1 * y)
        areas = []
        for found in (intersection_curves(*pair), marching_faces.intersection_curves(*pair)):
            (circle,) = found
            p = circle.points
            areas.append(np.cross(p, np.roll(p, -1, axis=0)).sum(axis=0) / 2)
        np.testing.assert_allclose(areas[0], areas[1], rtol=0.02, atol=0.05)

    @pytest.mark.parametrize("sign", [1, -1])
    def test_a_plane_through_lattice_points_still_has_its_circle(self, sign: int) -> None:
        """All triangles of the plane lie in faces of voxels: touching decides everything."""
        x, y, z = np.meshgrid(*[np.linspace(-1.5, 1.5, 13)] * 3, indexing="ij")
        pair = placed(1.03 - x**2 - y**2 - z**2), placed(sign * z)
        for found in (intersection_curves(*pair), marching_faces.intersection_curves(*pair)):
            (circle,) = found
            assert circle.closed
            assert circle.length == pytest.approx(2 * np.pi * np.sqrt(1.03), rel=0.03)

    def test_the_rule_of_1987_works_too(self) -> None:
        """Any rule of a cell will do, where it has no holes."""
        pair = waves(20, 10.0)
        assert_whole(intersection_curves(*pair, rule=lorensen_cline.RULE), pair[0])

    @settings(max_examples=40)
    @given(st.lists(st.integers(-2, 2), min_size=128, max_size=128))
    def test_ties_leave_no_loose_end(self, numbers: list[int]) -> None:
        """Surfaces through each other's vertices: as many segments in as out on every node inside.

        So curves close or end on the border, also when what runs back is left out.
        """
        a, b = (Field.of(part) for part in np.array(numbers).reshape(2, 4, 4, 4))
        segments = surface_intersection(*surfaces((a, b)))
        assert_balanced(segments, 3)
        assert_whole(join_segments(segments), a)

    @pytest.mark.parametrize("rule", [trilinear_cubes.RULE, asymptotic_decider.RULE])
    def test_whole_numbers_leave_no_loose_end(self, rule: Rule) -> None:
        """A third of the samples tied in each field, and nearly all of them in one of a plate."""
        random = np.random.default_rng(0)
        noise = [random.integers(-1, 2, size=(7, 7, 7)) for _ in range(2)]
        plate = np.where(np.indices((7, 7, 7))[0] == 3, 0, -1)
        for one, two in (noise, (noise[0], plate), (plate, plate.T), (noise[0], noise[0].T)):
            pair = Field.of(one), Field.of(two)
            segments = surface_intersection(
                *(enhanced_marching_cubes(field, 0.0, rule) for field in pair)
            )
            assert len(segments.cells)
            assert_balanced(segments, 6)
            assert_whole(join_segments(segments), pair[0])

    @pytest.mark.parametrize("factor", [1, 2])
    def test_whole_numbers_twice_are_contact(self, factor: int) -> None:
        """Identical surfaces of noise, full of ties: no curve."""
        values = np.random.default_rng(2).integers(-2, 3, size=(7, 7, 7))
        pair = Field.of(values), Field.of(factor * values)
        assert join_segments(surface_intersection(*surfaces(pair))) == []

    def test_surfaces_that_share_a_piece_cross_along_its_rim(self) -> None:
        """A plane, and one that is the same in the middle, above on one side, below beyond."""
        x, _, z = np.indices((9, 4, 7)).astype(float)
        bent = z - 3 - np.where(x < 3, 3 - x, np.where(x > 5, 5 - x, 0)) / 4
        (curve,) = intersection_curves(Field.of(z - 3), Field.of(bent))
        assert not curve.closed
        assert curve.length == pytest.approx(3)
        assert set(curve.points[:, 0].tolist()) <= {3.0, 5.0}

    def test_fields_must_share_a_lattice(self) -> None:
        """The same check as marching faces; and surfaces of different lattices are refused."""
        a, b = waves(6, 9.0)[0], waves(7, 9.0)[0]
        with pytest.raises(FieldError, match="not co-located"):
            intersection_curves(a, b)
        with pytest.raises(ValueError, match="share no voxels"):
            candidate_pairs(enhanced_marching_cubes(a, 0.0), enhanced_marching_cubes(b, 0.0))
