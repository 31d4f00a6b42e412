"""What a surface carries, beside what VTK and scikit-image give for the same volume."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest
from isoref import (
    METHODS,
    Field,
    FieldError,
    Mesh,
    attributes,
    dual,
    extract,
    marching_tetrahedra,
    simplicial,
    sweep,
    vesta,
)
from isoref.mesh import Provenance
from isoref.methods import DUAL_RULES, RULES, SPLITS
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Floats = NDArray[np.float64]

TURNED = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, -1]])


def body(shape: tuple[int, int, int] = (12, 13, 14)) -> Field:
    """A smooth, lopsided body that runs out of the lattice, mirrored and turned in space."""
    x, y, z = np.indices(shape, np.float64)
    values = 30 - (x - 5) ** 2 - 0.5 * (y - 3) ** 2 - (z - 8) ** 2 + 0.2 * x * y + np.sin(z)
    return Field.of(values, (0.5, 1, 2), (3, -4, 5), directions=TURNED.T)


def noise(seed: int, ties: bool = False) -> Field:
    """Samples without shape, with ties if asked."""
    random = np.random.default_rng(seed)
    shape = (4, 5, 6)
    values = random.integers(-1, 2, size=shape) if ties else random.normal(size=shape)
    return Field.of(values, (0.5, 1, 2), (3, -4, 5), directions=TURNED.T)


def matched(points: Floats, others: Floats, limit: float) -> NDArray[np.int64]:
    """For each of the points the one of the others at the same place."""
    distance, which = cKDTree(others).query(points)
    assert np.max(distance) < limit
    return np.asarray(which)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("ties", [False, True])
def test_provenance_says_where_vertices_and_triangles_are(method: str, ties: bool) -> None:
    """A vertex stands at ``(1 - t) A + t B``, or in its cell; a triangle lies in its cell."""
    field = noise(1, ties)
    mesh, free = METHODS[method](field, 0.0, provenance=True), METHODS[method](field, 0.0)
    assert free.provenance is None
    assert np.array_equal(free.vertices, mesh.vertices)
    assert np.array_equal(free.canonical().simplices, mesh.canonical().simplices)
    found = mesh.traced()
    assert (len(found.ends), len(found.t)) == (len(mesh.vertices),) * 2
    assert len(found.cells) == len(mesh.simplices) > 50

    # Ask of vertices on edges that they stand between their ends, on either side of the surface.
    dual = method in ("surface-nets", "dual-marching-cubes")
    on_edge = found.ends[:, 1] >= 0
    assert on_edge.any() != dual
    ends = found.ends[on_edge]
    assert (ends[:, 0] < ends[:, 1]).all()
    inside = field.values.reshape(-1) >= 0
    assert (inside[ends[:, 0]] != inside[ends[:, 1]]).all()
    a, b = (np.stack(np.unravel_index(end, field.shape), axis=1) for end in ends.T)
    if not dual:
        assert np.abs(b - a).max() == 1
    t = found.t[on_edge, None]
    assert np.allclose(field.position((1 - t) * a + t * b), mesh.vertices[on_edge])
    assert len(np.unique(ends, axis=0)) == len(ends)

    # Ask of the others that they stand in their cells.
    assert np.isnan(found.t[~on_edge]).all()
    low = np.stack(np.unravel_index(found.ends[~on_edge, 0], field.shape), axis=1)
    inner = field.index(mesh.vertices[~on_edge]) - low
    assert np.all((inner > -1e-9) & (inner < 1 + 1e-9))
    if dual:
        assert (found.cells == -1).all()
        return
    cells = np.stack(np.unravel_index(found.cells, [n - 1 for n in field.shape]), axis=1)
    corners = field.index(mesh.vertices)[mesh.simplices] - cells[:, None]
    assert np.all((corners > -1e-9) & (corners < 1 + 1e-9))


ARTICLES: dict[str, Callable[..., Mesh]] = {
    **{
        name: partial(sweep.sweep, RULES[name])
        for name in ("asymptotic-decider", "marching-vesta-mixed-H", "trilinear-cubes")
    },
    **{name: partial(dual.surface, rule) for name, rule in DUAL_RULES.items()},
    **{name: partial(marching_tetrahedra.surface, split) for name, split in SPLITS.items()},
    "vesta-mixed-L": partial(vesta.vesta, mode="mixed", resolution="L"),
    "vesta-connect-H": partial(vesta.vesta, mode="connect", resolution="H"),
    "simplicial": simplicial.extract,
}


@pytest.mark.parametrize("name", ARTICLES)
@pytest.mark.parametrize("ties", [False, True])
def test_the_articles_tell_what_their_twins_tell(name: str, ties: bool) -> None:
    """Vertex by vertex and triangle by triangle, under other numbers."""
    field = noise(2, ties)
    told = []
    for mesh in (
        ARTICLES[name](field, 0.0, provenance=True),
        METHODS[name](field, 0.0, provenance=True),
    ):
        found = mesh.traced()
        order = np.lexsort([*np.round(mesh.vertices, 9).T, *found.ends.T])
        told.append((found.ends[order], found.t[order], np.sort(found.cells)))
        assert found.field is field
    assert len(told[0][1]) > 50
    (ends, t, cells), (same_ends, same_t, same_cells) = told
    assert np.array_equal(ends, same_ends)
    assert np.allclose(t, same_t, rtol=0, atol=1e-12, equal_nan=True)
    assert np.array_equal(cells, same_cells)


def test_points_beyond_the_lattice_have_no_provenance() -> None:
    """VESTA's closed border stands half a sample out."""
    with pytest.raises(FieldError, match="lie on no edge of the lattice"):
        vesta.vesta(np.ones((2, 2, 2)), 0.5, border="closed", provenance=True)
    two = Field.of(np.random.default_rng(0).normal(size=(2, 4, 4, 4)), dimension=3)
    with pytest.raises(FieldError, match="where 2 components meet"):
        simplicial.extract(two, 0.0, provenance=True)


def test_provenance_costs_nothing_and_is_nothing_where_it_was_not_asked_for() -> None:
    """What needs it says how to get it."""
    mesh = extract(body().values, 2.0)
    with pytest.raises(FieldError, match="provenance=True"):
        attributes.values(mesh, body().values)
    asked = extract(body().values, 2.0, provenance=True)
    with pytest.raises(FieldError, match=r"lattice of \(12, 13, 14\) samples, .* \(4, 5, 6\)"):
        attributes.values(asked, noise(0).values)
    with pytest.raises(FieldError, match="does not fit"):
        attributes.without_cells(asked, np.zeros((12, 13, 14)))
    with pytest.raises(FieldError, match="one component, and there are 2"):
        attributes.gradients(asked, np.zeros((2, 12, 13, 14)))


@pytest.mark.parametrize("method", METHODS)
def test_values_of_a_linear_field_are_exact(method: str) -> None:
    """Linear on edges and trilinear in cells: both give back x + 2 y + 3 z at the vertices."""
    field = body()
    mesh = METHODS[method](field, 2.0, provenance=True)
    places = field.position(np.moveaxis(np.indices(field.shape), 0, -1))
    colours = np.moveaxis(places @ [[1, 0], [2, -1], [3, 1]], -1, 0)
    found = attributes.values(mesh, colours)
    assert len(found) > 100
    assert np.allclose(found, mesh.vertices @ [[1, 0], [2, -1], [3, 1]])
    slopes = attributes.gradients(mesh, colours[0])
    assert np.allclose(slopes, [1, 2, 3])


def vtk_surface(field: Field, isovalue: float, other: Field | None = None) -> Any:
    """VTK's flying edges, with normals, gradients and the values of another field."""
    vtk: Any = pytest.importorskip("vtk")
    from vtk.util.numpy_support import numpy_to_vtk

    image = vtk.vtkImageData()
    image.SetDimensions(field.shape)
    image.SetSpacing(field.spacing)
    image.SetOrigin(field.origin)
    if field.directions is not None:
        image.SetDirectionMatrix(np.array(field.directions).T.ravel().tolist())
    scalars = numpy_to_vtk(field.values.ravel(order="F"), deep=True)
    scalars.SetName("field")
    image.GetPointData().SetScalars(scalars)
    if other is not None:
        extra = numpy_to_vtk(other.values.ravel(order="F").astype(np.float64), deep=True)
        extra.SetName("other")
        image.GetPointData().AddArray(extra)
    filter_ = vtk.vtkFlyingEdges3D()
    filter_.SetInputData(image)
    filter_.SetValue(0, isovalue)
    filter_.ComputeNormalsOn()
    filter_.ComputeGradientsOn()
    filter_.InterpolateAttributesOn()
    filter_.Update()
    return filter_.GetOutput()


def arrays(surface: Any, *names: str) -> list[Floats]:
    """The points of a VTK surface and some of its arrays."""
    from vtk.util.numpy_support import vtk_to_numpy

    data = surface.GetPointData()
    found = [surface.GetPoints().GetData(), *(data.GetArray(name) for name in names)]
    return [vtk_to_numpy(one).astype(np.float64) for one in found]


@pytest.mark.parametrize("turned", [False, True])
def test_normals_gradients_and_values_are_vtks(turned: bool) -> None:
    """Central differences interpolated along edges, in space; VTK keeps single precision.

    In a mirrored image VTK's normals point to high values; ours never do.
    """
    field = body() if turned else Field.of(body().values, (0.5, 1, 2), (3, -4, 5))
    other = field.with_values(np.random.default_rng(0).normal(size=field.shape))
    mesh = METHODS["asymptotic-decider"](field, 2.0, provenance=True)
    points, normals, gradients, values = arrays(
        vtk_surface(field, 2.0, other), "Normals", "Gradients", "other"
    )
    which = matched(mesh.vertices, points, 1e-5)
    assert len(points) == len(mesh.vertices) > 100
    assert np.allclose(attributes.values(mesh, other.values), values[which], atol=1e-5)
    size = np.abs(gradients).max()
    assert np.allclose(attributes.gradients(mesh), gradients[which], atol=1e-4 * size)
    ours = attributes.normals(mesh)
    assert np.allclose(ours, field.handedness * normals[which], atol=2e-4)


def test_central_differences_are_numpys() -> None:
    """`numpy.gradient` gives them for the whole volume."""
    values = np.random.default_rng(0).normal(size=(3, 4, 5))
    found = attributes.central(Field.of(values), np.arange(60))
    assert np.allclose(found.T.reshape(3, 3, 4, 5), np.gradient(values))
    assert attributes.central(Field.of(np.ones((1, 2))), np.arange(2)).tolist() == [[0, 0]] * 2


def test_normals_point_where_scikit_images_point() -> None:
    """It adds up one-sided differences of cells, and they differ by no more than these may.

    Of ``a x^2`` a one-sided difference is wrong by a; the least gradient is that at the far ends.
    """
    measure: Any = pytest.importorskip("skimage.measure")
    x, y, z = np.indices((32, 32, 32)) - 15.3
    values = 100 - x * x - y * y - 0.5 * z * z
    vertices, _, theirs, _ = measure.marching_cubes(values, 5.0)
    mesh = extract(values, 5.0, provenance=True)
    which = matched(mesh.vertices, vertices.astype(np.float64), 1e-4)
    cosines = (attributes.normals(mesh) * theirs[which]).sum(axis=1)
    assert len(cosines) > 1000
    least = 2 * 0.5 * np.sqrt(95 / 0.5)
    assert cosines.min() > np.cos(np.arcsin(np.linalg.norm([1, 1, 0.5]) / least))


def test_normals_of_a_smooth_body_converge() -> None:
    """Half the spacing, a quarter of the error: central differences are of second order."""
    worst = []
    for n in (17, 33, 65):
        grid = np.linspace(-1.5, 1.5, n)
        x, y, z = np.meshgrid(grid, grid, grid, indexing="ij")
        field = Field.of(1 - np.sqrt(x * x + y * y + z * z), 3 / (n - 1), (-1.5,) * 3)
        mesh = METHODS["asymptotic-decider"](field, 0.0, provenance=True)
        exact = mesh.vertices / np.linalg.norm(mesh.vertices, axis=1, keepdims=True)
        worst.append(np.abs(attributes.normals(mesh) - exact).max())
    assert np.log2(worst[1] / worst[2]) > 1.8
    assert np.log2(worst[0] / worst[1]) > 1.6


def test_where_the_gradient_vanishes_the_normal_is_zero() -> None:
    """Halfway between two samples at the ends of a row of three that are each other's mirror."""
    values = np.zeros((3, 3, 3))
    values[1, 1, 1] = 1
    mesh = extract(values, 1.0, provenance=True)
    assert len(mesh.vertices) == 6
    assert (attributes.normals(mesh) == 0).all()


@pytest.mark.parametrize("method", METHODS)
def test_cells_are_left_out_as_if_they_had_never_been(method: str) -> None:
    """What is left is what the other cells hold; no triangle touches an absent one's inside."""
    field = noise(5)
    mesh = METHODS[method](field, 0.0, provenance=True)
    absent = np.random.default_rng(0).random([n - 1 for n in field.shape]) < 0.3
    left = attributes.without_cells(mesh, absent)
    assert 0 < len(left.simplices) < len(mesh.simplices)
    assert set(np.unique(left.simplices)) == set(range(len(left.vertices)))
    found = left.traced()
    if (found.cells >= 0).all():
        assert not attributes.of_cells(left, absent).any()
        kept = ~attributes.of_cells(mesh, absent)
        assert np.array_equal(left.vertices[left.simplices], mesh.vertices[mesh.simplices][kept])
    inside = found.ends[:, 1] < 0
    assert not absent[np.unravel_index(found.ends[inside, 0], field.shape)].any()
    nothing = attributes.without_cells(mesh, np.ones_like(absent))
    assert (len(nothing.vertices), len(nothing.simplices)) == (0, 0)
    everything = attributes.without_cells(mesh, np.zeros_like(absent))
    assert len(everything.simplices) == len(mesh.simplices)


def test_what_is_left_has_its_boundary_on_absent_cells() -> None:
    """Every edge of one triangle lies on the border of the lattice or of an absent cell."""
    field = noise(5)
    mesh = METHODS["asymptotic-decider"](field, 0.0, provenance=True)
    absent = np.zeros([n - 1 for n in field.shape], np.bool_)
    absent[1, 2, 3] = True
    left = attributes.without_cells(mesh, absent)
    edges = np.sort(left.simplices[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    assert count.max() == 2
    middles = field.index(left.vertices[unique[count == 1]].mean(axis=1))
    last = np.array(field.shape) - 1
    on_border = ((np.abs(middles) < 1e-9) | (np.abs(middles - last) < 1e-9)).any(axis=1)
    at = np.abs(middles - np.array([1.5, 2.5, 3.5])).max(axis=1)
    assert (on_border | (np.abs(at - 0.5) < 1e-9)).all()
    assert (~on_border).sum() >= 3


def test_masked_cells_are_left_out_as_vtk_leaves_them_out() -> None:
    """VTK contours the cells that are there, one by one, by the case table."""
    pyvista: Any = pytest.importorskip("pyvista")
    field = Field.of(body().values)
    absent = np.random.default_rng(1).random([n - 1 for n in field.shape]) < 0.3
    left = attributes.without_cells(
        METHODS["asymptotic-decider"](field, 2.0, provenance=True), absent
    )
    grid = pyvista.ImageData(dimensions=field.shape)
    grid.point_data["field"] = field.values.ravel(order="F")
    some = grid.extract_cells(np.flatnonzero(~absent.ravel(order="F")))
    theirs = some.contour([2.0], scalars="field").triangulate()
    assert len(theirs.points) == len(left.vertices) > 100
    assert len(theirs.faces) // 4 == len(left.simplices)
    matched(left.vertices, np.asarray(theirs.points, np.float64), 1e-5)


def test_masked_cells_are_left_out_as_scikit_image_leaves_them_out() -> None:
    """Its mask is one of samples: a cell counts where its highest corner is marked."""
    measure: Any = pytest.importorskip("skimage.measure")
    field = Field.of(body().values)
    mask = np.random.default_rng(1).random(field.shape) < 0.7
    vertices, faces, _, _ = measure.marching_cubes(field.values, 2.0, mask=mask)
    left = attributes.without_cells(
        METHODS["asymptotic-decider"](field, 2.0, provenance=True), ~mask[1:, 1:, 1:]
    )
    assert len(faces) == len(left.simplices) > 100
    matched(left.vertices, vertices.astype(np.float64), 1e-4)


def test_cells_of_samples_are_those_that_touch_one() -> None:
    """Eight for a sample in the middle, one for a corner."""
    absent = np.zeros((4, 4, 4), np.bool_)
    absent[1, 1, 1] = True
    assert attributes.cells_of_samples(absent).sum() == 8
    absent[:] = False
    absent[3, 3, 3] = True
    assert attributes.cells_of_samples(absent).sum() == 1


def test_triangles_of_dual_methods_lie_in_several_cells() -> None:
    """So a number of one cell is not theirs."""
    field = noise(0)
    mesh = METHODS["surface-nets"](field, 0.0, provenance=True)
    with pytest.raises(FieldError, match="several cells"):
        attributes.of_cells(mesh, np.zeros([n - 1 for n in field.shape]))


def test_regions_are_vtks() -> None:
    """The same triangles together; ours are numbered from the largest on."""
    pyvista: Any = pytest.importorskip("pyvista")
    mesh = extract(np.random.default_rng(0).normal(size=(9, 9, 9)), 1.2)
    found = attributes.regions(mesh)
    surface = pyvista.PolyData.from_regular_faces(mesh.vertices, mesh.simplices)
    theirs = np.asarray(surface.connectivity("all").cell_data["RegionId"])
    pairs = np.unique(np.stack([found, theirs]), axis=1)
    assert len(pairs[0]) == len(np.unique(found)) == len(np.unique(theirs)) > 10
    sizes = np.bincount(found)
    assert (np.diff(sizes) <= 0).all()
    largest = attributes.only(mesh, found == 0)
    assert len(largest.simplices) == sizes[0]
    assert (attributes.regions(largest) == 0).all()


def test_no_simplices_have_no_regions() -> None:
    """And nothing breaks."""
    field = Field.of(np.zeros((2, 2, 2)))
    mesh = Mesh(np.empty((0, 3)), np.empty((0, 3), np.int64), Provenance.empty(field))
    assert len(attributes.regions(mesh)) == 0
    assert len(attributes.values(mesh, field.values)) == 0
    assert len(attributes.normals(mesh)) == 0
    assert len(attributes.without_cells(mesh, np.zeros((1, 1, 1))).simplices) == 0
