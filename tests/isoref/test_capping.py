"""Caps: closed on the border whatever the samples are, and where they should be."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from isoref import METHODS, Field, FieldError, Mesh, attributes, extract
from isoref.capping import capped, framed_samples
from isoref.degenerate import state
from isoref.methods import DUAL_RULES, RULES
from numpy.typing import NDArray

# Lorensen and Cline's drawings are torn inside already; naive nets have edges of four triangles.
CLOSED = [name for name in METHODS if name != "lorensen-cline"]
MANIFOLD = [name for name in CLOSED if name != "surface-nets"]


def balanced(mesh: Mesh) -> bool:
    """Whether each edge is passed as often in one direction as in the other."""
    there = mesh.simplices[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    there, back = (edges[np.lexsort(edges.T)] for edges in (there, there[:, ::-1]))
    return np.array_equal(there, back)


def volume(mesh: Mesh) -> float:
    """What a closed mesh encloses; positive where normals point out."""
    a, b, c = np.moveaxis(mesh.vertices[mesh.simplices], 1, 0)
    return float((a * np.cross(b, c)).sum() / 6)


def corners_of(mesh: Mesh) -> set[Any]:
    """The triangles by their corners, in no order."""
    places = np.round(mesh.vertices[mesh.simplices], 9).tolist()
    return {tuple(sorted(map(tuple, corners))) for corners in places}


SHAPES = st.tuples(*[st.integers(2, 5)] * 3)
FIELDS = SHAPES.flatmap(
    lambda shape: st.one_of(
        arrays(np.int8, shape, elements=st.integers(-1, 1)),
        arrays(np.uint8, shape, elements=st.integers(0, 2)),
        arrays(np.bool_, shape),
        arrays(np.float32, shape, elements=st.floats(-1, 1, width=32)),
        arrays(np.float64, shape, elements=st.floats(-1e300, 1e300)),
    )
)


@pytest.mark.parametrize("method", CLOSED)
@settings(max_examples=50)
@given(values=FIELDS, isovalue=st.sampled_from([0, 1, 0.25]))
def test_caps_close_every_closed_method_whatever_the_samples(
    method: str, values: NDArray[Any], isovalue: float
) -> None:
    """Random fields, with ties, of every kind of number: closed, oriented, a manifold, inside."""
    field = Field.of(values, (1, 2, 3), (4, 5, 6))
    mesh = capped(METHODS[method], field, isovalue)
    assert balanced(mesh)
    index = field.index(mesh.vertices)
    assert np.all((index >= -1e-9) & (index <= np.array(field.shape) - 1 + 1e-9))
    if method in MANIFOLD:
        found = state(mesh)
        assert (found.boundary, found.crowded, found.pinched) == (0, 0, 0)


FIELDS_WITH_ABSENT = FIELDS.flatmap(
    lambda values: st.tuples(st.just(values), arrays(np.bool_, values.shape))
)


@pytest.mark.parametrize("method", CLOSED)
@settings(max_examples=50)
@given(posed=FIELDS_WITH_ABSENT, isovalue=st.sampled_from([0, 1, 0.25]))
def test_caps_close_beside_absent_samples_whatever_they_are(
    method: str, posed: tuple[NDArray[Any], NDArray[np.bool_]], isovalue: float
) -> None:
    """Random samples are absent: closed, oriented, a manifold, and no vertex on their edges."""
    values, absent = posed
    field = Field.of(values, (1, 2, 3), (4, 5, 6))
    mesh = capped(METHODS[method], field, isovalue, True, absent)
    assert balanced(mesh)
    if method in MANIFOLD:
        found = state(mesh)
        assert (found.boundary, found.crowded, found.pinched) == (0, 0, 0)
    index = field.index(mesh.vertices)
    assert np.all((index >= -1e-9) & (index <= np.array(field.shape) - 1 + 1e-9))
    ends = mesh.traced().ends
    on_edges = ends[:, 1] >= 0
    assert not absent.reshape(-1)[ends[on_edges]].any()


def solid(size: int, at: tuple[int, ...]) -> tuple[NDArray[Any], NDArray[np.bool_]]:
    """A block that is all inside, and one absent sample of it."""
    absent = np.zeros((size,) * 3, np.bool_)
    absent[at] = True
    return np.ones((size,) * 3), absent


@pytest.mark.parametrize("method", METHODS)
def test_a_lone_absent_sample_leaves_a_hole_of_known_volume(method: str) -> None:
    """An octahedron between its six neighbours; with diagonals, what their star leaves of it."""
    values, absent = solid(5, (2, 2, 2))
    mesh = extract(values, 0.5, method=method, cap=True, absent=absent)
    hole = 4**3 - volume(mesh)
    if method in DUAL_RULES:
        assert hole == pytest.approx((2 / 3) ** 3)
    elif method in RULES or "vesta" in method or "label" in method:
        assert hole == pytest.approx(4 / 3)
    else:
        assert 4 / 3 <= hole <= 8
    assert state(mesh).euler == 4
    assert state(mesh).degenerate == 0


@pytest.mark.parametrize("method", METHODS)
def test_a_lone_absent_sample_in_the_border_leaves_a_dent(method: str) -> None:
    """On a face, an edge and a corner of the block; one closed piece stays."""
    for at in ((0, 2, 2), (0, 0, 2), (0, 0, 0)):
        values, absent = solid(4, at)
        mesh = extract(values, 0.5, method=method, cap=True, absent=absent)
        assert balanced(mesh)
        assert 0 < 3**3 - volume(mesh) < 4
        assert state(mesh).euler == 2


@pytest.mark.parametrize("method", METHODS)
def test_no_number_at_an_absent_sample_matters(method: str) -> None:
    """NaN, infinity, or masked."""
    random = np.random.default_rng(3)
    values, absent = random.normal(size=(6, 6, 7)), random.random((6, 6, 7)) < 0.2
    first = extract(values, 0.1, method=method, cap=True, absent=absent)
    for number in (np.nan, np.inf, -np.inf, 7.0, 0.1):
        other = np.where(absent, number, values)
        again = extract(other, 0.1, method=method, cap=True, absent=absent)
        assert np.array_equal(first.vertices, again.vertices)
        assert np.array_equal(first.simplices, again.simplices)
    masked = np.ma.masked_array(values, absent)
    again = extract(masked, 0.1, method=method, cap=True, absent=True)
    assert np.array_equal(first.vertices, again.vertices)
    assert len(first.simplices) > 200


@pytest.mark.parametrize("method", sorted(set(METHODS) - {"surface-nets", "dual-marching-cubes"}))
def test_cells_without_an_absent_corner_keep_their_triangles(method: str) -> None:
    """Where all samples of a cell are present, a cap adds and takes nothing."""
    random = np.random.default_rng(5)
    values, absent = random.normal(size=(6, 7, 8)), random.random((6, 7, 8)) < 0.06
    plain, closed = (
        corners_of(extract(values, 0.1, method=method, cap=cap, absent=absent))
        for cap in (False, True)
    )
    assert len(plain) > 100
    assert plain <= closed
    assert len(closed) > len(plain)


def test_a_sheet_of_samples_between_absent_ones_stays_a_closed_manifold() -> None:
    """Attack: a single plane of samples is present; both its sides stand in it, not as one."""
    values, absent = np.ones((5, 5, 5)), np.ones((5, 5, 5), np.bool_)
    absent[2] = False
    mesh = extract(values, 0.5, cap=True, absent=absent)
    found = state(mesh)
    assert (found.boundary, found.crowded, found.pinched, found.euler) == (0, 0, 0, 2)
    assert volume(mesh) == 0
    assert set(mesh.vertices[:, 0].tolist()) == {2.0}
    nothing = extract(values, 0.5, cap=True, absent=np.ones_like(absent))
    assert len(nothing.vertices) == len(nothing.simplices) == 0


def test_caps_beside_absent_samples_stand_where_the_volume_stands() -> None:
    """A mirrored, oblique volume of one component: as a straight one, placed."""
    random = np.random.default_rng(6)
    values, absent = random.normal(size=(5, 6, 7)), random.random((5, 6, 7)) < 0.2
    frame = np.array([[0, -1, 0], [0.6, 0, 0.8], [-0.8, 0, 0.6]])
    field = Field.of(values, (1, 2, 3), (4, 5, 6), directions=frame)
    mesh = capped(METHODS["trilinear-cubes"], field, 0.0, True, absent)
    straight = capped(METHODS["trilinear-cubes"], field.straight(), 0.0, True, absent)
    assert balanced(mesh)
    assert np.allclose(mesh.vertices, field.placed(straight.vertices))
    assert volume(mesh) == pytest.approx(volume(straight))
    assert volume(mesh) > 0


@pytest.mark.parametrize("method", CLOSED)
def test_caps_close_large_fields(method: str) -> None:
    """Noise with many ties, over more than one block of every algorithm."""
    random = np.random.default_rng(4)
    for values in (random.integers(-2, 3, size=(17, 19, 21)), random.normal(size=(17, 19, 21))):
        mesh = extract(values, 0, method=method, cap=True)
        assert balanced(mesh)
        assert len(mesh.simplices) > 2000


@pytest.mark.parametrize("method", METHODS)
def test_a_block_that_is_all_inside_is_itself(method: str) -> None:
    """Its surface is the border of the volume: eight corners, the right volume, no sliver left."""
    field = Field.of(np.full((3, 4, 5), 7, np.uint8), (0.5, 1, 2), (1, 2, 3))
    mesh = capped(METHODS[method], field, 0)
    assert volume(mesh) == pytest.approx(1 * 3 * 8)
    assert state(mesh).degenerate == 0
    assert state(mesh).euler == 2
    assert mesh.vertices.min(axis=0).tolist() == [1, 2, 3]
    assert mesh.vertices.max(axis=0).tolist() == [2, 5, 11]


@pytest.mark.parametrize(
    "method",
    [name for name in METHODS if "label" not in name and "nets" not in name and "dual" not in name],
)
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_half_space_is_cut_out_of_the_volume_exactly(method: str, mirrored: bool) -> None:
    """A linear field has a flat surface, so what is enclosed is a polytope of known volume."""
    x, y, z = np.indices((6, 7, 8))
    values = 3.3 - x  # inside: x <= 3.3, of 5 x 6 x 7
    affine = np.diag([-0.5 if mirrored else 0.5, 1, 2, 1])
    mesh = capped(METHODS[method], Field.of_affine(values, affine), 0)
    assert volume(mesh) == pytest.approx(3.3 * 6 * 7)
    slanted = capped(METHODS[method], Field.of_affine(7.5 - x - y + 0 * z, affine), 0)
    # Of the 5 x 6 rectangle a triangle of legs 3.5 is cut off.
    assert volume(slanted) == pytest.approx((5 * 6 - 3.5**2 / 2) * 7)


@pytest.mark.parametrize("method", sorted(set(METHODS) - {"surface-nets", "dual-marching-cubes"}))
def test_away_from_the_border_nothing_changes(method: str) -> None:
    """The surface without caps is a part of the one with them, triangle by triangle."""
    values = np.random.default_rng(2).normal(size=(5, 6, 7))
    ours, theirs = (
        corners_of(extract(values, 0.1, method=method, cap=cap)) for cap in (False, True)
    )
    assert len(ours) > 100
    assert ours <= theirs
    assert len(theirs) > len(ours)


def test_the_drawings_of_1987_close_where_they_are_not_torn() -> None:
    """A smooth body has no ambiguous face."""
    x, y, z = np.indices((9, 9, 9))
    mesh = extract(30 - (x - 2) ** 2 - y**2 - (z - 4) ** 2, 0.5, method="lorensen-cline", cap=True)
    assert len(mesh.simplices) > 200
    assert state(mesh).boundary == 0


@pytest.mark.parametrize("method", CLOSED)
def test_provenance_of_caps_names_samples_and_the_cells_they_close(method: str) -> None:
    """Values are interpolated on caps too, and masks leave them out with their cells."""
    field = Field.of(np.random.default_rng(7).normal(size=(4, 5, 6)), (1, 2, 3), (4, 5, 6))
    mesh = capped(METHODS[method], field, 0.0, provenance=True)
    found = mesh.traced()
    places = np.moveaxis(field.position(np.moveaxis(np.indices(field.shape), 0, -1)), -1, 0)
    assert np.allclose(attributes.values(mesh, places), mesh.vertices)
    assert len(found.cells) == len(mesh.simplices) > 50
    if (found.cells < 0).any():
        return
    cells = np.stack(np.unravel_index(found.cells, [n - 1 for n in field.shape]), axis=1)
    inner = field.index(mesh.vertices)[mesh.simplices] - cells[:, None]
    assert np.all((inner > -1e-9) & (inner < 1 + 1e-9))


def test_where_nothing_can_be_outside_it_is_said() -> None:
    """The least number of double precision has none below it."""
    least = -np.finfo(np.float64).max
    with pytest.raises(FieldError, match="no number is below the isovalue"):
        capped(METHODS["asymptotic-decider"], Field.of(np.zeros((2, 2, 2))), least)


@pytest.mark.parametrize("kind", ["u1", "i1", "i8", "u8", "?", "f2", "f4", "f8"])
def test_the_frame_is_outside_and_the_volume_keeps_its_sides(kind: str) -> None:
    """Even where all numbers of a type are inside."""
    values = np.array([[[0, 1], [1, 0]], [[1, 1], [0, 0]]], kind)
    for isovalue in (-300.5, 0, 0.5, 1):
        framed = framed_samples(values, isovalue) >= isovalue
        assert np.array_equal(framed[2:-1, 2:-1, 2:-1], values >= isovalue)
        assert framed.sum() == (values >= isovalue).sum()


def test_a_volume_one_sample_thick_has_no_cells_and_no_cap() -> None:
    """As without caps."""
    assert len(extract(np.ones((1, 4, 4)), 0.5, cap=True).simplices) == 0


def region_area(values: NDArray[Any], level: float) -> float:
    """The area of a plane's inside region, by contourpy: saddles by the mean of their square.

    What it fills is above a level, so the rest of what is filled of the negated plane is asked for.
    """
    contourpy: Any = pytest.importorskip("contourpy")
    filled, offsets = contourpy.contour_generator(z=-values, fill_type="OuterOffset").filled(
        -level, np.inf
    )
    total = float(np.prod(np.array(values.shape) - 1))
    for points, ends in zip(filled, offsets, strict=True):
        for start, stop in pairwise(ends.tolist()):
            x, y = points[start:stop].T
            total -= float((x[:-1] * y[1:] - x[1:] * y[:-1]).sum() / 2)
    return total


def areas_in_plane(mesh: Mesh, axis: int, at: int) -> tuple[float, float]:
    """The area of the triangles in a plane, with sign and without."""
    a, b, c = corners = np.moveaxis(mesh.vertices[mesh.simplices], 1, 0)
    flat = (corners[:, :, axis] == at).all(axis=0)
    doubled = np.cross(b - a, c - a)[flat, axis]
    return float(doubled.sum() / 2), float(np.abs(doubled).sum() / 2)


@pytest.mark.parametrize("method", [name for name in METHODS if "mixed" in name])
@pytest.mark.parametrize("ties", [False, True])
def test_caps_cover_the_inside_of_the_border_once(method: str, ties: bool) -> None:
    """On each of the six planes their area, with sign and without, is that of contourpy's region.

    VESTA's mixed mode decides a saddle as contourpy does, so the regions are the same.
    """
    random = np.random.default_rng(11)
    shape = (6, 7, 8)
    values = random.integers(-1, 2, size=shape) * 1.0 if ties else random.normal(size=shape)
    whole = capped(METHODS[method], Field.of(values), 0.0)
    own = METHODS[method](Field.of(values), 0.0)
    for axis, last in enumerate(np.array(shape) - 1):
        for at, outwards in ((0, -1), (last, 1)):
            # Where samples are tied, triangles of the surface itself may lie in the border.
            with_caps, without = (areas_in_plane(mesh, axis, at) for mesh in (whole, own))
            area = region_area(np.take(values, at, axis), 0.0)
            assert outwards * (with_caps[0] - without[0]) == pytest.approx(area)
            assert with_caps[1] - without[1] == pytest.approx(area)
            assert area > 5
