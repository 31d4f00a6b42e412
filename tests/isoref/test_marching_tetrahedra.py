"""Marching tetrahedra: manifold whatever the split, and of the split's own interpolant."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from isograde.oracles.self_intersections import self_intersections
from isoref import kuhn, simplicial
from isoref.cube import CORNERS
from isoref.field import Array, Field, FieldError, Floats
from isoref.marching_tetrahedra import FIVE, KUHN, Split, Tetrahedron, section, surface
from isoref.methods import METHODS, SPLITS
from scipy.spatial import cKDTree
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkContourGrid
from vtkmodules.vtkFiltersGeneral import vtkDataSetTriangleFilter

from tests.isoref.counting import edges, fans

EVERY = pytest.mark.parametrize("split", SPLITS.values(), ids=list(SPLITS))


def noise(shape: tuple[int, ...], seed: int = 0) -> Floats:
    """Normal random samples."""
    return np.random.default_rng(seed).normal(size=shape)


def corners_of(split: Split) -> list[Floats]:
    """The corners of every tetrahedron of the block, (4, 3), in its order."""
    return [
        np.array([np.add(cell, CORNERS[c]) for c in tetrahedron.corners], float)
        for cell in np.ndindex(split.block)
        for tetrahedron in split.at(cell)
    ]


# --- Splits ----------------------------------------------------------------------------------


@pytest.mark.parametrize(("split", "a_cell"), [(KUHN, 6), (FIVE, 5)])
def test_a_split_fills_its_block_once(split: Split, a_cell: int) -> None:
    """Payne & Toga: five; Bloomenthal: six. Each random point is in one tetrahedron."""
    tetrahedra = corners_of(split)
    assert len(tetrahedra) == a_cell * np.prod(split.block)
    points = np.random.default_rng(0).random((300, 3)) * split.block
    hits = np.zeros(len(points), int)
    for corners in tetrahedra:
        inner = np.linalg.solve((corners[1:] - corners[0]).T, (points - corners[0]).T)
        hits += ((inner > 0).all(axis=0)) & (inner.sum(axis=0) < 1)
    assert set(hits.tolist()) == {1}


@EVERY
def test_corners_come_in_the_order_of_the_lattice_with_their_orientation(split: Split) -> None:
    for cell in np.ndindex(split.block):
        for tetrahedron in split.at(cell):
            places = [CORNERS[c] for c in tetrahedron.corners]
            assert places == sorted(places)
            frame = np.subtract(places[1:], places[0])
            assert np.sign(np.linalg.det(frame)) == tetrahedron.sign


def test_the_two_splits_cut_faces_along_known_diagonals() -> None:
    """Kuhn: from low to high. Five: between points of even sum; every other cell is mirrored."""
    for split in (KUHN, FIVE):
        for places in corners_of(split):
            for a, b in product(places.tolist(), repeat=2):
                step = np.subtract(b, a)
                if np.abs(step).sum() == 2 and split is FIVE:
                    assert sum(a) % 2 == sum(b) % 2 == 0
                if np.abs(step).sum() > 1 and split is KUHN:
                    assert len(set(np.sign(step[step != 0]).tolist())) == 1
    assert FIVE.at((0, 0, 0)) == FIVE.at((2, 4, 6)) == FIVE.at((1, 1, 0)) != FIVE.at((1, 0, 0))


def test_five_tetrahedra_in_all_cells_alike_are_refused() -> None:
    """The consistency condition: neighbours cut the face between them along one diagonal."""
    cell = [corners for corners in corners_of(FIVE) if corners.max() <= 1]
    assert len(cell) == 5
    alike = [[tuple(map(int, p)) for p in corners] for corners in cell]
    with pytest.raises(FieldError, match="same diagonal"):
        Split.of("alike", (1, 1, 1), alike)


@pytest.mark.parametrize(
    ("block", "simplices", "message"),
    [
        ((1, 1, 3), [], "a split has 1 or 2"),
        ((1, 1, 1), [], "fill 0 sixth of 6"),
        ((1, 1, 1), [((0, 0, 0), (1, 0, 0), (0, 1, 0))], "not four points"),
        ((1, 1, 1), [((0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0))], "no tetrahedron"),
        ((2, 1, 1), [((0, 0, 0), (2, 0, 0), (0, 1, 0), (0, 0, 1))], "no tetrahedron"),
        ((1, 1, 1), [((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 2))], "no tetrahedron"),
    ],
)
def test_what_is_no_split_is_refused_with_a_reason(
    block: tuple[int, int, int], simplices: list[list[tuple[int, ...]]], message: str
) -> None:
    with pytest.raises(FieldError, match=message):
        Split.of("wrong", block, simplices)


def test_tetrahedra_that_overlap_are_refused_though_their_volumes_add_up() -> None:
    """Kuhn's first tetrahedron six times."""
    first = [CORNERS[c] for c in kuhn.chains(3)[0]]
    with pytest.raises(FieldError, match="not whole on both sides"):
        Split.of("six times", (1, 1, 1), [first] * 6)


def test_a_split_of_one_s_own_is_as_good() -> None:
    """Kuhn's split, seen in a mirror: diagonals of the other direction along axis 0."""
    turned = [[tuple(map(int, p)) for p in abs(c - [1, 0, 0])] for c in corners_of(KUHN)]
    mirrored = Split.of("mirrored", (1, 1, 1), turned)
    values = noise((5, 6, 7))
    mesh = surface(mirrored, Field.of(values), 0.0).canonical()
    there = surface(KUHN, Field.of(values[::-1]), 0.0)
    back = there.vertices * [-1, 1, 1] + [4, 0, 0]
    assert len(mesh.vertices) == len(back) > 300
    np.testing.assert_allclose(np.sort(back, axis=0), np.sort(mesh.vertices, axis=0), atol=1e-14)


# --- One tetrahedron -------------------------------------------------------------------------


@EVERY
def test_the_table_has_one_or_two_triangles_that_face_the_outside_corners(split: Split) -> None:
    """Doi & Koide: 14 of 16 cases, eight with a triangle and six with a quadrilateral."""
    for cell in np.ndindex(split.block):
        for tetrahedron in split.at(cell):
            counts = []
            for code in range(16):
                signs = sum(1 << c for bit, c in enumerate(tetrahedron.corners) if code >> bit & 1)
                pieces = section(tetrahedron, signs)
                counts.append(len(pieces))
                outside = [c for c in tetrahedron.corners if not signs >> c & 1]
                inside = [c for c in tetrahedron.corners if signs >> c & 1]
                for piece in pieces:
                    assert all(a in inside and b in outside for a, b in piece)
                    ends = np.array([[CORNERS[a], CORNERS[b]] for a, b in piece], float)
                    p, q, r = ends.mean(axis=1)
                    normal = np.cross(q - p, r - p)
                    outwards = np.mean([CORNERS[c] for c in outside], axis=0) - p
                    assert normal @ outwards > 0
            assert sorted(counts) == [0, 0, *[1] * 8, *[2] * 6]


def test_corners_of_other_parity_turn_the_pieces_over() -> None:
    """The same corners with the other sign: the same triangles the other way round."""
    right, left = (section(Tetrahedron((0, 1, 2, 4), s), 0b10) for s in (1, -1))
    assert [piece[::-1] for piece in left] == list(right)
    assert len(right) == 1


# --- The surface -----------------------------------------------------------------------------


@settings(max_examples=40)
@given(
    values=hnp.arrays(np.int8, st.tuples(*[st.integers(2, 4)] * 3), elements=st.integers(0, 3)),
    isovalue=st.sampled_from([1, 1.5, 2]),
)
def test_kuhn_s_surface_is_that_of_min(values: Array, isovalue: float) -> None:
    """Min, section 4, for n = 3 and m = 1: the same triangles, ties or not."""
    field = Field.of(values)
    mesh, other = surface(KUHN, field, isovalue), simplicial.extract(field, isovalue)
    assert len(mesh.vertices) == len(other.vertices)
    assert corners_sorted(mesh.vertices[mesh.simplices]) == corners_sorted(
        other.vertices[other.simplices]
    )


def corners_sorted(corners: Floats) -> list[list[list[float]]]:
    """Triangles by their corners' positions, each begun where its list comes first."""
    return sorted(min(t[i:] + t[:i] for i in range(3)) for t in corners.tolist())


def test_the_catalogue_has_all_three_and_kuhn_s_is_simplicial_number_for_number() -> None:
    """`marching-tetrahedra-kuhn` and `simplicial`, on noise in space."""
    field = Field.of(noise((9, 8, 7), seed=5), (1, 2, 0.5), (3, -1, 2))
    mesh = METHODS["marching-tetrahedra-kuhn"](field, 0.1).canonical()
    other = METHODS["simplicial"](field, 0.1).canonical()
    assert len(mesh.simplices) > 1000
    np.testing.assert_array_equal(mesh.vertices, other.vertices)
    np.testing.assert_array_equal(mesh.simplices, other.simplices)
    assert len(METHODS["marching-tetrahedra-five"](field, 0.1).simplices) < len(mesh.simplices)


def test_vertices_lie_where_the_interpolant_of_kuhn_takes_the_isovalue() -> None:
    """And so do points inside the triangles: they are pieces of its level set."""
    field = Field.of(noise((6, 5, 7)))
    mesh = surface(KUHN, field, 0.2)
    corners = mesh.vertices[mesh.simplices]
    weights = np.random.default_rng(1).dirichlet([1, 1, 1], size=len(corners))
    inner = np.einsum("tk,tkd->td", weights, corners)
    assert len(inner) > 500
    values = kuhn.interpolate(field, np.concatenate([mesh.vertices, inner]))
    np.testing.assert_allclose(values, 0.2, atol=1e-12)


@EVERY
@pytest.mark.parametrize("seed", range(3))
def test_closed_manifold_and_without_crossings(split: Split, seed: int) -> None:
    """Exact counts behind a border of low samples; odd and even shapes, where a block is cut."""
    rng = np.random.default_rng(seed)
    shape = tuple(rng.integers(7, 11, size=3))
    for values in (rng.normal(size=shape), rng.integers(0, 4, size=shape) - 2.0):
        mesh = METHODS[f"marching-tetrahedra-{split.name}"](
            Field.of(np.pad(values, 1, constant_values=-9)), 0.0
        )
        found = edges(mesh.simplices)
        assert len(mesh.simplices) > 1000
        assert set(zip(found.forth.tolist(), found.back.tolist(), strict=True)) == {(1, 1)}
        assert set(fans(mesh.simplices, len(mesh.vertices)).tolist()) == {1}
        if values[0, 0, 0] != round(values[0, 0, 0]):
            assert len(self_intersections(mesh.vertices, mesh.simplices)) == 0


def test_five_is_what_vtk_draws_of_a_volume_cut_into_tetrahedra() -> None:
    """An independent implementation: the same alternation, crossings and number of triangles."""
    values = noise((8, 9, 7), seed=2)
    image = vtkImageData()
    image.SetDimensions(*values.shape[::-1])
    image.GetPointData().SetScalars(numpy_to_vtk(values.reshape(-1)))
    cut, contour = vtkDataSetTriangleFilter(), vtkContourGrid()
    cut.SetInputData(image)
    contour.SetInputConnection(cut.GetOutputPort())
    contour.SetValue(0, 0.1)
    contour.Update()
    theirs = contour.GetOutput()
    mesh = surface(FIVE, Field.of(values), 0.1)
    assert theirs.GetNumberOfCells() == len(mesh.simplices) > 1000
    points = np.asarray(vtk_to_numpy(theirs.GetPoints().GetData()), float)[:, ::-1]
    assert len(points) == len(mesh.vertices)
    nearest, place = cKDTree(points).query(mesh.vertices)
    assert np.max(nearest) < 1e-5
    assert len(np.unique(place)) == len(points)


@EVERY
def test_a_plane_is_drawn_exactly_and_a_ball_is_enclosed(split: Split) -> None:
    """Linear functions are their own interpolants; the volume of a ball comes out positive."""
    i, j, k = np.indices((6, 7, 8))
    plane = surface(split, Field.of(1.0 * i + 2 * j - 1.5 * k), 3.3)
    assert len(plane.simplices) > 60
    np.testing.assert_allclose(plane.vertices @ [1, 2, -1.5], 3.3, atol=1e-12)
    x = np.indices((15, 15, 16)) - np.array([6.9, 7.3, 7.8])[:, None, None, None]
    ball = METHODS[f"marching-tetrahedra-{split.name}"](
        Field.of(6 - np.sqrt((x**2).sum(axis=0))), 0.0
    )
    volume = np.linalg.det(ball.vertices[ball.simplices]).sum() / 6
    # The chord of a cell's diagonal: an offset of at most 3 / (8 R), three times that over R.
    assert volume == pytest.approx(4 / 3 * np.pi * 216, rel=9 / 8 / 36)


@EVERY
@pytest.mark.parametrize("size", [1.7e308, 1e-300])
def test_vertices_do_not_move_where_values_are_huge_or_tiny(split: Split, size: float) -> None:
    """The difference of two samples may overflow."""
    values = np.where(np.indices((3, 4, 3)).sum(axis=0) % 3, -1.0, 1.0) * [1.0, 0.5, 0.25]
    plain = surface(split, Field.of(values), 0.0)
    scaled = surface(split, Field.of(values * size), 0.0)
    assert len(plain.vertices) > 10
    np.testing.assert_allclose(scaled.vertices, plain.vertices, rtol=0, atol=1e-12)


@EVERY
def test_out_of_range_and_thin_lattices_are_empty_and_other_fields_refused(split: Split) -> None:
    for name in (f"marching-tetrahedra-{split.name}", "simplicial"):
        for values in (np.zeros((3, 3, 3)), noise((4, 1, 4)), noise((1, 1, 1))):
            mesh = METHODS[name](Field.of(values), 9.0)
            assert mesh.vertices.shape == (0, 3)
            assert mesh.simplices.shape == (0, 3)
        with pytest.raises(FieldError, match="3-D lattice"):
            METHODS[name](Field.of(np.zeros((3, 3))), 0.0)
        with pytest.raises(FieldError, match="not finite"):
            METHODS[name](Field.of(np.zeros((3, 1, 3))), float("nan"))
