"""The topology of a mesh by half-edges, beside trimesh, pymeshlab and manifold3d."""

from collections.abc import Callable

import manifold3d
import numpy as np
import pymeshlab
import pytest
import trimesh
from isograde.oracles.halfedges import Surface, _sorted_pairs
from isoref.field import Floats, Integers
from skimage import measure

Shape = tuple[Floats, Integers]
TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
CORNERS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])


def noise(n: int, seed: int) -> Shape:
    """Marching cubes of noise: many components, handles and a boundary."""
    values = np.random.default_rng(seed).normal(size=(n, n, n))
    vertices, faces, _, _ = measure.marching_cubes(values, 0.0)
    return vertices.astype(float), faces.astype(np.int64)


def closed_noise(n: int, seed: int) -> Shape:
    """The same with a border outside, so that it is closed."""
    values = np.full((n, n, n), -1.0)
    values[1:-1, 1:-1, 1:-1] = np.random.default_rng(seed).normal(size=(n - 2,) * 3)
    vertices, faces, _, _ = measure.marching_cubes(values, 0.0)
    return vertices.astype(float), faces.astype(np.int64)


def torus() -> Shape:
    """A torus: Euler characteristic 0."""
    shape = trimesh.creation.torus(3.0, 1.0)
    return np.asarray(shape.vertices), np.asarray(shape.faces)


SHAPES: list[Callable[[], Shape]] = [
    lambda: noise(8, 1),
    lambda: noise(12, 2),
    lambda: closed_noise(10, 3),
    torus,
    lambda: (CORNERS, TETRAHEDRON),
]


@pytest.mark.parametrize("shape", SHAPES)
def test_agrees_with_trimesh(shape: Callable[[], Shape]) -> None:
    """Area, volume, Euler characteristic, components and being closed are trimesh's."""
    points, faces = shape()
    ours = Surface.of(points, faces)
    theirs = trimesh.Trimesh(points, faces, process=False)
    assert ours.area == pytest.approx(theirs.area)
    assert ours.euler == theirs.euler_number
    assert (len(ours.open_edges) == 0) == theirs.is_watertight
    assert (len(ours.unbalanced_edges) == len(ours.open_edges)) == theirs.is_winding_consistent
    pieces = trimesh.graph.connected_components(theirs.edges_unique, min_len=2)
    assert ours.components == len(pieces)
    if theirs.is_watertight:
        assert ours.volume == pytest.approx(theirs.volume)


@pytest.mark.parametrize("shape", SHAPES)
def test_agrees_with_pymeshlab(shape: Callable[[], Shape]) -> None:
    """Edges, boundary, holes and non-manifold edges and vertices are counted as pymeshlab does."""
    points, faces = shape()
    ours = Surface.of(points, faces)
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(points, faces))
    theirs = meshes.get_topological_measures()
    assert len(ours.edges.ends) == theirs["edges_number"]
    assert len(ours.open_edges) == theirs["boundary_edges"]
    assert len(ours.crowded_edges) == theirs["non_two_manifold_edges"]
    assert int((ours.fans > 1).sum()) == theirs["non_two_manifold_vertices"]
    if theirs["number_holes"] >= 0:
        assert ours.boundary_loops == theirs["number_holes"]


@pytest.mark.parametrize("shape", SHAPES)
def test_agrees_with_manifold3d(shape: Callable[[], Shape]) -> None:
    """A mesh without open, crowded or misdirected edges is a manifold to manifold3d."""
    points, faces = shape()
    ours = Surface.of(points, faces)
    theirs = manifold3d.Manifold(
        manifold3d.Mesh64(points, faces.astype(np.uint64), merge_from_vert=None)
    )
    sound = not len(ours.unbalanced_edges) and not len(ours.crowded_edges)
    assert (theirs.status() == manifold3d.Error.NoError) == sound
    if sound:
        assert theirs.surface_area() == pytest.approx(ours.area)
        assert theirs.volume() == pytest.approx(ours.volume)


def test_an_open_mesh_has_a_boundary() -> None:
    """A tetrahedron without one face has three boundary edges in one loop."""
    surface = Surface.of(CORNERS, TETRAHEDRON[1:])
    assert sorted(map(tuple, surface.open_edges.tolist())) == [(0, 1), (0, 2), (1, 2)]
    assert surface.boundary_loops == 1
    assert surface.fans.tolist() == [1, 1, 1, 1]


def test_a_flipped_face_misdirects_its_three_edges() -> None:
    """Orientation is a property of edges, not of normals."""
    faces = TETRAHEDRON.copy()
    faces[0] = faces[0][::-1]
    assert len(Surface.of(CORNERS, faces).misdirected_edges) == 3


def test_two_tetrahedra_that_share_a_vertex_have_two_fans_there() -> None:
    """No edge tells: the vertex does."""
    points = np.concatenate([CORNERS, CORNERS + 5])
    other = TETRAHEDRON + 4
    other[other == 4] = 0
    surface = Surface.of(points, np.concatenate([TETRAHEDRON, other]))
    assert surface.fans.tolist() == [2, 1, 1, 1, 0, 1, 1, 1]
    assert not len(surface.open_edges)
    assert not len(surface.crowded_edges)


def test_two_tetrahedra_that_share_an_edge_crowd_it() -> None:
    """Four faces at one edge, none of them misdirected."""
    points = np.concatenate([CORNERS, CORNERS[2:] + 5])
    other = np.where(TETRAHEDRON < 2, TETRAHEDRON, TETRAHEDRON + 2)
    surface = Surface.of(points, np.concatenate([TETRAHEDRON, other]))
    assert surface.crowded_edges.tolist() == [[0, 1]]
    assert not len(surface.open_edges)
    assert not len(surface.misdirected_edges)


@pytest.mark.parametrize("seed", range(5))
def test_turning_and_linking_find_the_same_fans(seed: int) -> None:
    """The fast way round a vertex and the plain one agree, on closed, open and shared fans."""
    points, faces = noise(6, seed)
    rng = np.random.default_rng(seed)
    fewer = faces[rng.random(len(faces)) < 0.8]
    surface = Surface.of(points, fewer)
    tail = surface.faces.reshape(-1)
    turning = np.bincount(tail[surface._fans_by_turning()], minlength=len(points))
    linking = np.bincount(tail[surface._fans_by_linking()], minlength=len(points))
    assert np.array_equal(turning, linking)
    assert turning.max() > 1


def test_pairs_that_do_not_fit_one_key_sort_the_same() -> None:
    """Vertex numbers near 2**31 leave no room for the half-edge in the key."""
    points, faces = noise(6, 0)
    low, high = np.sort(faces[:, :2], axis=1).T
    packed, _ = _sorted_pairs(low, high, len(points))
    plain, order = _sorted_pairs(low, high, 2**31)
    assert np.array_equal(packed >> (len(points) - 1).bit_length(), plain >> 31)
    assert np.array_equal(low[order], plain >> 31)


def test_welding_joins_a_soup() -> None:
    """Triangles that share no index share vertices once equal positions are one."""
    points, faces = closed_noise(8, 4)
    soup = Surface.of(points[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3))
    assert len(soup.open_edges) == faces.size
    assert not len(soup.welded().open_edges)
    assert soup.welded().euler == Surface.of(points, faces).euler


def test_welding_keeps_the_places_and_takes_both_zeros_for_one() -> None:
    """A vertex at -0.0 is the vertex at 0.0; no coordinate is rounded."""
    points = np.array([[0.1, 0, 0], [1, 0, 0], [0, 1e-20, 0], [0.1, -0.0, 0], [0, 0, 1.0]])
    welded = Surface.of(points, np.array([[0, 1, 2], [3, 2, 4]])).welded()
    assert welded.points.tolist() == sorted((points[[0, 1, 2, 4]] + 0.0).tolist())
    assert len(welded.edges.uses) == 5


def test_a_flipped_face_stays_in_its_fan() -> None:
    """Which way a face runs does not change which faces meet at its vertex."""
    points, faces = closed_noise(8, 4)
    flipped = faces.copy()
    flipped[::3] = flipped[::3, ::-1]
    turned = Surface.of(points, flipped)
    assert len(turned.misdirected_edges)
    assert np.array_equal(turned.fans, Surface.of(points, faces).fans)


def test_a_face_is_flat_where_its_corners_are_on_a_line() -> None:
    """However it lies: a face in a plane of the axes has an area."""
    points = np.concatenate([CORNERS, [[2.0, 0, 0]]])
    assert Surface.of(points, np.array([[0, 1, 2], [0, 1, 4], [1, 2, 3]])).flat_faces.tolist() == [
        1
    ]
