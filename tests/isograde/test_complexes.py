"""What is true of meshes of simplices, beside trimesh, pymeshlab, manifold3d and Qhull."""

from collections import Counter
from collections.abc import Callable
from itertools import combinations
from math import factorial

import manifold3d
import numpy as np
import pymeshlab
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from isograde.oracles import complexes, rows
from isograde.oracles.complexes import Complex, _sorted, parity
from isoref.field import Floats, Integers
from scipy.spatial import ConvexHull
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
    ours = Complex.of(points, faces)
    theirs = trimesh.Trimesh(points, faces, process=False)
    assert ours.measure == pytest.approx(theirs.area)
    assert ours.euler == theirs.euler_number
    assert (len(ours.open_facets) == 0) == theirs.is_watertight
    assert (len(ours.unbalanced_facets) == len(ours.open_facets)) == theirs.is_winding_consistent
    pieces = trimesh.graph.connected_components(theirs.edges_unique, min_len=2)
    assert ours.components == len(pieces)
    if theirs.is_watertight:
        assert ours.enclosed == pytest.approx(theirs.volume)


@pytest.mark.parametrize("shape", SHAPES)
def test_agrees_with_pymeshlab(shape: Callable[[], Shape]) -> None:
    """Edges, boundary, holes and non-manifold edges and vertices are counted as pymeshlab does."""
    points, faces = shape()
    ours = Complex.of(points, faces)
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(points, faces))
    theirs = meshes.get_topological_measures()
    assert len(ours.facets.rows) == theirs["edges_number"]
    assert len(ours.open_facets) == theirs["boundary_edges"]
    assert len(ours.crowded_facets) == theirs["non_two_manifold_edges"]
    assert int((ours.fans > 1).sum()) == theirs["non_two_manifold_vertices"]
    if theirs["number_holes"] >= 0:
        assert ours.boundary_pieces == theirs["number_holes"]


@pytest.mark.parametrize("shape", SHAPES)
def test_agrees_with_manifold3d(shape: Callable[[], Shape]) -> None:
    """A mesh without open, crowded or misdirected edges is a manifold to manifold3d."""
    points, faces = shape()
    ours = Complex.of(points, faces)
    theirs = manifold3d.Manifold(
        manifold3d.Mesh64(points, faces.astype(np.uint64), merge_from_vert=None)
    )
    sound = not len(ours.unbalanced_facets) and not len(ours.crowded_facets)
    assert (theirs.status() == manifold3d.Error.NoError) == sound
    if sound:
        assert theirs.surface_area() == pytest.approx(ours.measure)
        assert theirs.volume() == pytest.approx(ours.enclosed)


def test_an_open_mesh_has_a_boundary() -> None:
    """A tetrahedron without one face has three boundary edges in one loop."""
    surface = Complex.of(CORNERS, TETRAHEDRON[1:])
    assert sorted(map(tuple, surface.open_facets.tolist())) == [(0, 1), (0, 2), (1, 2)]
    assert surface.boundary_pieces == 1
    assert surface.fans.tolist() == [1, 1, 1, 1]


def test_a_flipped_face_misdirects_its_three_edges() -> None:
    """Orientation is a property of edges, not of normals."""
    faces = TETRAHEDRON.copy()
    faces[0] = faces[0][::-1]
    assert len(Complex.of(CORNERS, faces).misdirected_facets) == 3


def test_two_tetrahedra_that_share_a_vertex_have_two_fans_there() -> None:
    """No edge tells: the vertex does."""
    points = np.concatenate([CORNERS, CORNERS + 5])
    other = TETRAHEDRON + 4
    other[other == 4] = 0
    surface = Complex.of(points, np.concatenate([TETRAHEDRON, other]))
    assert surface.fans.tolist() == [2, 1, 1, 1, 0, 1, 1, 1]
    assert not len(surface.open_facets)
    assert not len(surface.crowded_facets)


def test_two_tetrahedra_that_share_an_edge_crowd_it() -> None:
    """Four faces at one edge, none of them misdirected."""
    points = np.concatenate([CORNERS, CORNERS[2:] + 5])
    other = np.where(TETRAHEDRON < 2, TETRAHEDRON, TETRAHEDRON + 2)
    surface = Complex.of(points, np.concatenate([TETRAHEDRON, other]))
    assert surface.crowded_facets.tolist() == [[0, 1]]
    assert not len(surface.open_facets)
    assert not len(surface.misdirected_facets)


@pytest.mark.parametrize("seed", range(5))
def test_turning_and_linking_find_the_same_fans(seed: int) -> None:
    """The fast way round a vertex and the plain one agree, on closed, open and shared fans."""
    points, faces = noise(6, seed)
    rng = np.random.default_rng(seed)
    fewer = faces[rng.random(len(faces)) < 0.8]
    surface = Complex.of(points, fewer)
    tail = surface.simplices.reshape(-1)
    turning = np.bincount(tail[surface._fans_by_turning(*surface._turns())], minlength=len(points))
    linking = np.bincount(tail[surface._fans_by_linking()], minlength=len(points))
    assert np.array_equal(turning, linking)
    assert turning.max() > 1


@pytest.mark.parametrize("holes", [0, 1, 300])
@pytest.mark.parametrize("seed", range(3))
def test_walks_about_vertices_find_where_one_has_two_fans(seed: int, holes: int) -> None:
    """On a closed ball, on one with a hole, and where fans are torn apart."""
    x = np.linspace(-1.0, 1, 12) ** 2
    values = 0.6 - (x[:, None, None] + x[None, :, None] + x)
    points, faces, _, _ = measure.marching_cubes(values, 0.0)
    faces = np.random.default_rng(seed).permutation(faces)[holes:].astype(np.int64)
    surface = Complex.of(points.astype(float), faces)
    turn, ends = surface._turns()
    roots = surface._fans_by_linking()
    fans = np.bincount(surface.simplices.reshape(-1)[roots], minlength=len(points))
    assert surface._each_is_one_fan(turn, ends) == (fans.max() == 1)
    assert (fans.max() == 1) == (holes < 300)


def test_a_walk_gives_up_where_a_fan_is_large_and_doubling_answers() -> None:
    """A wheel of more triangles than a walk has steps."""
    count = complexes.WALK + 9
    rim = np.arange(count) + 1
    faces = np.stack([np.zeros(count, int), rim, np.roll(rim, -1)], axis=1)
    wheel = Complex.of(np.zeros((count + 1, 3)), faces)
    assert not wheel._each_is_one_fan(*wheel._turns())
    assert wheel.fans.tolist() == [1] * (count + 1)


@pytest.mark.parametrize("seed", range(3))
def test_names_in_portions_give_the_facets_of_the_plain_way(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With holes, flipped triangles and crowded edges; and all else is as it was before."""
    points, faces = noise(7, seed)
    rng = np.random.default_rng(seed)
    faces = faces[rng.random(len(faces)) < 0.9]
    faces[::7] = faces[::7, ::-1]
    faces = np.concatenate([faces, faces[:5]])

    def told(portion: int, plain: bool) -> list[object]:
        with monkeypatch.context() as patch:
            patch.setattr(complexes, "PORTION", portion)
            patch.setattr(rows, "PORTION", portion)
            if plain:
                patch.setattr(complexes, "_edges", lambda simplices, vertices: None)
            one = Complex.of(points, faces)
            found = one.facets
            arrays = found.rows, found.uses, found.balance, found.sides, found.start
            return [
                *(array.tolist() for array in (*arrays, one.fans, one.measures, one.normals)),
                *(one.components, one.euler, one.measure, one.enclosed),
            ]

    assert told(3 << 14, False) == told(33, False) == told(3 << 14, True)
    assert len(Complex.of(points, faces).crowded_facets) > 0


@pytest.mark.parametrize("vertices", [500, 2**30, 2**40])
def test_rows_that_do_not_fit_one_key_sort_the_same(vertices: int) -> None:
    """With few vertices row and index share a key; with many the row alone, then columns."""
    _, faces = noise(6, 0)
    columns = list(np.sort(faces[:, :2], axis=1).T)
    order, start = _sorted(columns, vertices)
    listed = np.stack(columns, axis=1)[order]
    expected, first = np.unique(np.stack(columns, axis=1), axis=0, return_index=True)
    assert np.array_equal(listed[start], expected)
    assert np.array_equal(order[start], first)


def test_welding_joins_a_soup() -> None:
    """Triangles that share no index share vertices once equal positions are one."""
    points, faces = closed_noise(8, 4)
    soup = Complex.of(points[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3))
    assert len(soup.open_facets) == faces.size
    assert not len(soup.welded().open_facets)
    assert soup.welded().euler == Complex.of(points, faces).euler


def test_welding_keeps_the_places_and_takes_both_zeros_for_one() -> None:
    """A vertex at -0.0 is the vertex at 0.0; no coordinate is rounded."""
    points = np.array([[0.1, 0, 0], [1, 0, 0], [0, 1e-20, 0], [0.1, -0.0, 0], [0, 0, 1.0]])
    welded = Complex.of(points, np.array([[0, 1, 2], [3, 2, 4]])).welded()
    assert welded.points.tolist() == sorted((points[[0, 1, 2, 4]] + 0.0).tolist())
    assert len(welded.facets.uses) == 5


def test_a_flipped_face_stays_in_its_fan() -> None:
    """Which way a face runs does not change which faces meet at its vertex."""
    points, faces = closed_noise(8, 4)
    flipped = faces.copy()
    flipped[::3] = flipped[::3, ::-1]
    turned = Complex.of(points, flipped)
    assert len(turned.misdirected_facets)
    assert np.array_equal(turned.fans, Complex.of(points, faces).fans)


def hull(d: int, seed: int) -> tuple[Floats, Integers]:
    """A convex hull in R^d: a sphere of dimension d - 1."""
    points = np.random.default_rng(seed).normal(size=(6 + 2 * d, d))
    return points, ConvexHull(points).simplices.astype(np.int64)


@given(d=st.integers(2, 5), seed=st.integers(0, 99))
def test_hulls_are_closed_spheres(d: int, seed: int) -> None:
    """Counted with sets of sets, and by Qhull's own neighbours; every link is a sphere."""
    points, simplices = hull(d, seed)
    found = Complex.of(points, simplices)
    counts = Counter(
        frozenset(face) for row in simplices.tolist() for face in combinations(row, d - 1)
    )
    named = map(frozenset, found.facets.rows.tolist())
    assert dict(zip(named, found.facets.uses.tolist(), strict=True)) == counts
    assert (found.facets.uses == 2).all()
    assert found.euler == 1 + (-1) ** (d - 1)
    assert found.components == 1
    assert not len(found.singular_vertices)
    assert found.measure == pytest.approx(ConvexHull(points).area)


@given(seed=st.integers(0, 99))
def test_pieces_and_cycles_are_those_of_the_graph(seed: int) -> None:
    """Segments: components by merging sets, Euler characteristic by counting."""
    rng = np.random.default_rng(seed)
    pairs = sorted({tuple(sorted(rng.choice(12, 2, replace=False).tolist())) for _ in range(12)})
    pieces: list[set[int]] = []
    for pair in pairs:
        touched = [piece for piece in pieces if piece & set(pair)]
        pieces = [piece for piece in pieces if piece not in touched]
        pieces.append(set(pair).union(*touched))
    graph = Complex.of(np.zeros((12, 2)), np.array(pairs, np.int64))
    assert graph.components == len(pieces)
    assert graph.euler == sum(map(len, pieces)) - len(pairs)


@pytest.mark.parametrize("d", [2, 3, 4])
def test_parity_is_the_sign_of_the_permutation_matrix(d: int) -> None:
    """Against determinants."""
    rows = np.array([np.random.default_rng(i).permutation(d + 1) for i in range(20)])
    expected = [round(np.linalg.det(np.eye(d + 1)[row])) for row in rows]
    assert parity(rows).tolist() == expected


@pytest.mark.parametrize("d", [2, 3, 4])
def test_the_boundary_of_a_simplex_encloses_it(d: int) -> None:
    """With the sign of its orientation, and every facet balanced."""
    corners = np.random.default_rng(d).normal(size=(d + 1, d))
    exact = np.linalg.det(corners[1:] - corners[0]) / factorial(d)
    border = []
    for i in range(d + 1):
        row = [j for j in range(d + 1) if j != i]
        border.append(row if i % 2 == 0 else [row[1], row[0], *row[2:]])
    found = Complex.of(corners, np.array(border))
    assert found.enclosed == pytest.approx(exact)
    assert not len(found.unbalanced_facets)


def suspension(surface: Complex) -> Complex:
    """Two cones over a surface, turned against each other: a complex of tetrahedra."""
    top = len(surface.points)
    one = np.column_stack([np.full(len(surface.simplices), top), surface.simplices])
    other = np.column_stack([np.full(len(surface.simplices), top + 1), surface.simplices[:, ::-1]])
    return Complex.of(np.zeros((top + 2, 4)), np.concatenate([one, other]))


def test_the_link_of_an_apex_decides_whether_a_complex_of_tetrahedra_is_a_manifold() -> None:
    """Over a sphere it is one; over a torus, facets and edges are fine and the apexes are not."""
    sphere = suspension(Complex.of(*hull(3, 0)))
    round_torus = suspension(Complex.of(*torus()))
    for found in (sphere, round_torus):
        assert (found.facets.uses == 2).all()
    assert not len(sphere.singular_vertices)
    apexes = [len(round_torus.points) - 2, len(round_torus.points) - 1]
    assert round_torus.singular_vertices.tolist() == apexes


def test_two_balls_that_share_a_vertex_are_no_manifold() -> None:
    """Tetrahedra that meet in one vertex: its link has two parts."""
    found = Complex.of(np.zeros((7, 3)), np.array([[0, 1, 2, 3], [0, 4, 5, 6]]))
    assert found.singular_vertices.tolist() == [0]


def test_points_measure_one_each_and_have_no_facets() -> None:
    """A simplex of dimension 0 has no edges; counting is its measure."""
    found = Complex.of(np.random.default_rng(0).normal(size=(3, 2)), np.array([[0], [2]]))
    assert found.measures.tolist() == [1, 1]
    assert (found.components, found.euler) == (2, 2)
    assert not len(found.facets.rows)
