"""Known bodies: the oracle checked a second way, right meshes in their bounds, faults caught."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from hashlib import sha256
from itertools import combinations, product
from math import ceil, inf, sqrt
from typing import Any

import numpy as np
import pytest
from isograde.cases import bodies as cases
from isograde.model import Case
from isograde.oracles.bodies import KINDS, Body, Bounds, bounds, known_bodies
from isograde.oracles.body_measures import (
    Measures,
    Search,
    disagreements,
    distinct,
    enclosed,
    first_betti,
    measures,
    pieces,
    shells,
    simplex_measures,
)
from isoref import METHODS
from isoref.fast.simplicial import extract
from isoref.field import Integers
from isoref.mesh import Mesh

Extractor = Callable[[Any, float], Mesh]
BODIES = {f"{n}-{m}/{body.name}": body for n, m in KINDS for body in known_bodies(n, m)}
CASES = {case.id: case for case in cases.cases() if case.id.endswith(("-float64", "-uint8"))}
# Kinds whose meshes take seconds to judge rather than parts of one.
HEAVY = {(4, 1), (4, 2), (5, 3)}
SURFACES = [
    name
    for name in CASES
    if "3-1/sphere" in name
    or name.endswith(("two-spheres-32-float64", "3-1/torus-64-uint8", "genus-2-65-float64"))
]
SMALL = [case_id for case_id in SURFACES if "sphere" in case_id]
TORUS = "bodies/3-1/torus-64-float64"


def posed(names: Iterable[str]) -> list[Any]:
    """These cases, the large ones marked as slow."""
    return [
        pytest.param(name, marks=pytest.mark.slow) if CASES[name].samples > 50_000 else name
        for name in names
    ]


def body_of(case: Case) -> Body:
    """The body of a case."""
    body = case.facts["body"]
    assert isinstance(body, Body)
    return body


def allowed(case: Case, interpolant: str, vertices: str, reach: float = 1.0) -> Bounds:
    """The bounds of a family on a case."""
    body = body_of(case)
    rounding = case.facts["rounding"]
    return bounds(interpolant, vertices, body.radii, body.n, reach=reach, rounding=rounding)  # type: ignore[arg-type]


def judged(case: Case, mesh: Mesh, within: Bounds) -> Measures:
    """The measures of a mesh that is right."""
    body = body_of(case)
    found = measures(mesh.vertices, mesh.simplices, body)
    ratios = [
        f"{name} {number / most:.2f}"
        for name, number, most in (
            ("mean", found.mean, within.mean),
            ("to body", found.to_body, within.largest),
            ("to mesh", found.to_mesh, within.largest),
        )
    ]
    print(case.id, *ratios)
    assert disagreements(found, body, within) == {}
    return found


# -- the bodies ------------------------------------------------------------------------------------


def test_there_are_two_topologies_of_every_kind_with_radii_of_six_cells() -> None:
    """Design: known bodies of radius at least six cells, at least two topologies."""
    assert {(body.n, body.m) for body in BODIES.values()} == set(KINDS)
    for n, m in KINDS:
        listed = known_bodies(n, m)
        assert len({(body.pieces, body.b1) for body in listed}) >= 2
        assert min(min(body.radii) for body in listed) >= 6


@pytest.mark.parametrize("name", BODIES)
def test_a_body_has_the_measure_that_the_coarea_formula_gives(name: str) -> None:
    """The share of random points with all |phi| < d, over the volume of that shell's section."""
    body, d = BODIES[name], 1.5
    rng = np.random.default_rng(7)
    # Keep to a box about the body, in which the shell is a larger share.
    place, margin = body.points(4000), d * sqrt(body.m) + 0.1
    low, high = place.min(axis=0) - margin, place.max(axis=0) + margin
    points = rng.uniform(low, high, (400_000, body.n))
    near = (abs(body.phi(points)) < d).all(axis=1)
    share = near.mean()
    found = share * np.prod(high - low) / (2 * d) ** body.m
    # A shell about a curved set is larger by at most k (k-1)/6 (d/R)^2; four standard errors more.
    k, least = body.n - body.m, min(body.radii)
    bent = 0.0 if least == inf else max(k * (k - 1), 1) / 6 * (d / least) ** 2 + (d / least) ** 3
    error = 4 * sqrt((1 - share) / (share * len(points)))
    assert error < 0.25
    assert found == pytest.approx(body.measure, rel=bent + error)


@pytest.mark.parametrize("name", [k for k, body in BODIES.items() if body.volume is not None])
def test_a_hypersurface_encloses_its_volume_about_its_centroid(name: str) -> None:
    """By Monte Carlo: phi > 0 inside."""
    body = BODIES[name]
    rng = np.random.default_rng(8)
    size = np.array(body.shape) - 1.0
    points = rng.uniform(0, size, (400_000, body.n))
    inside = body.phi(points)[:, 0] > 0
    share = inside.mean()
    error = 4 * sqrt((1 - share) / (share * len(points)))
    assert share * np.prod(size) == pytest.approx(body.volume, rel=error)
    spread = 4 * points[inside].std(axis=0) / sqrt(inside.sum())
    assert (abs(points[inside].mean(axis=0) - body.centroid) < spread).all()


@pytest.mark.parametrize("name", BODIES)
def test_functions_are_distances_with_gradients_at_right_angles(name: str) -> None:
    """The premises of the bounds; and dense points of the body give the distance a second way."""
    body = BODIES[name]
    place = body.points(400)
    assert len(place) > 200
    g = body.gradients(place)
    assert np.allclose(g @ g.transpose(0, 2, 1), np.eye(body.m), atol=1e-6)
    # Move off the body along the normal space by two cells: that is the distance.
    rng = np.random.default_rng(3)
    step = rng.normal(size=(len(place), body.m))
    step *= 2 / np.linalg.norm(step, axis=1, keepdims=True)
    moved = place + np.einsum("pm,pmn->pn", step, g)
    assert np.allclose(body.distance(moved), 2, atol=1e-5)
    dense = body.points(20_000)
    apart = np.linalg.norm(moved[:50, None] - dense[None], axis=2).min(axis=1)
    assert (apart > 2 - 1e-5).all()


def test_bodies_stay_clear_of_the_border_and_off_centre_along_each_axis() -> None:
    """Level 0 needs no border; axes that are exchanged show in the centroid."""
    for name, body in BODIES.items():
        place = body.points(4000)
        assert (place > 1).all(), name
        assert (place < np.array(body.shape) - 2).all(), name
        if len(set(body.shape)) == 1:
            for i, j in combinations(range(body.n), 2):
                assert sqrt(2) * abs(body.centroid[i] - body.centroid[j]) > 0.25, name


def test_second_derivatives_stay_below_the_bound_of_the_derivation() -> None:
    """rho^2 / r^3 < 1 / sqrt(R^2 - 2 L^2) on an edge of length L that meets the ball, R >= 2 L."""
    for R, L in product((6.0, 7.0, 9.0, 20.0), (1.0, sqrt(2), sqrt(3), 2.0, sqrt(5), 3.0)):
        start = np.linspace(0, R, 2001)[:, None]
        along = start - np.linspace(0, L, 201)[None]
        rho = R**2 - start**2
        worst = (rho / np.maximum(rho + along**2, 1e-300) ** 1.5)[rho[:, 0] > 0].max()
        assert worst < 1 / sqrt(R**2 - 2 * L**2)


# -- the measures ----------------------------------------------------------------------------------


def ranks(simplices: Integers) -> list[int]:
    """All Betti numbers over Z/2 by elimination in dense boundary matrices."""
    k = simplices.shape[1] - 1
    chains = []
    for d in range(k + 1):
        faces = {tuple(sorted(s)) for row in simplices.tolist() for s in combinations(row, d + 1)}
        chains.append(sorted(faces))
    rank = [0]
    for d in range(1, k + 1):
        place = {face: i for i, face in enumerate(chains[d - 1])}
        matrix = np.zeros((len(chains[d - 1]), len(chains[d])), bool)
        for column, face in enumerate(chains[d]):
            for part in combinations(face, d):
                matrix[place[part], column] = True
        rank.append(eliminated(matrix))
    rank.append(0)
    return [len(chains[d]) - rank[d] - rank[d + 1] for d in range(k + 1)]


def eliminated(matrix: np.ndarray) -> int:
    """The rank over Z/2."""
    found = 0
    for column in range(matrix.shape[1]):
        rows = np.flatnonzero(matrix[found:, column]) + found
        if not len(rows):
            continue
        matrix[[found, rows[0]]] = matrix[[rows[0], found]]
        others = np.flatnonzero(matrix[:, column])
        matrix[others[others != found]] ^= matrix[found]
        found += 1
    return found


def small_meshes() -> Iterator[tuple[str, Integers]]:
    """Closed ones, ones with holes, with fins, doubled, and random ones."""
    rng = np.random.default_rng(5)
    octahedron = np.array([[a, b, c] for a in (0, 1) for b in (2, 3) for c in (4, 5)])
    grid = np.arange(16).reshape(4, 4)
    right, down = np.roll(grid, -1, 1), np.roll(grid, -1, 0)
    both = np.roll(right, -1, 0)
    torus = np.concatenate(
        [
            np.stack([grid, right, both], -1).reshape(-1, 3),
            np.stack([grid, both, down], -1).reshape(-1, 3),
        ]
    )
    yield "sphere", octahedron
    yield "torus", torus
    yield "torus with a hole", torus[1:]
    yield "torus with two holes", torus[[i for i in range(len(torus)) if i not in (3, 20)]]
    yield "two spheres", np.concatenate([octahedron, octahedron + 6])
    yield "spheres that share a vertex", np.concatenate([octahedron, octahedron + 5])
    yield "sphere with a wall", np.concatenate([octahedron, [[0, 1, 2], [0, 1, 3]]])
    yield "sphere twice", np.concatenate([octahedron, octahedron[:, ::-1]])
    for count in (6, 10, 16):
        yield f"random triangles {count}", rng.integers(0, 7, (count, 3))
        yield f"random segments {count}", rng.integers(0, 9, (count, 2))
        yield f"random tetrahedra {count}", rng.integers(0, 7, (count, 4))


@pytest.mark.parametrize(("name", "simplices"), list(small_meshes()))
def test_betti_numbers_are_those_of_the_boundary_matrices(name: str, simplices: Integers) -> None:
    """Edelsbrunner & Harer, section IV.2, by dense elimination."""
    del name
    simplices = distinct(simplices)
    betti = ranks(simplices)
    assert pieces(simplices) == betti[0]
    assert shells(simplices) == betti[-1]
    assert first_betti(simplices) == (betti[1] if simplices.shape[1] <= 3 else None)


def test_volume_area_and_distances_agree_with_trimesh() -> None:
    """A second library for triangles in space."""
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.creation.torus(3.0, 1.0, 12, 9)
    moved = np.array([1.0, 2.0, 3.0])
    vertices, faces = np.asarray(mesh.vertices, float) + moved, np.asarray(mesh.faces)
    volume, centroid = enclosed(vertices, faces)
    assert volume == pytest.approx(mesh.volume)
    assert np.allclose(centroid, mesh.center_mass + moved)
    assert simplex_measures(vertices, faces).sum() == pytest.approx(mesh.area)
    points = np.random.default_rng(2).uniform(-4, 7, (200, 3))
    near = trimesh.triangles.closest_point(
        np.repeat(vertices[faces], len(points), axis=0), np.tile(points, (len(faces), 1))
    ).reshape(len(faces), len(points), 3)
    known = np.linalg.norm(near - points, axis=2).min(axis=0)
    assert np.allclose(Search.of(vertices, faces).distances(points), known)


@pytest.mark.parametrize(("n", "k"), [(2, 1), (3, 1), (4, 2), (4, 3), (5, 0), (5, 2)])
def test_distances_from_simplices_agree_with_least_squares(n: int, k: int) -> None:
    """Scipy's non-negative least squares, the sum of the weights held at 1 by a heavy row."""
    from scipy.optimize import nnls

    rng = np.random.default_rng([n, k])
    vertices, simplices = rng.normal(size=(12, n)), rng.integers(0, 12, (9, k + 1))
    points = rng.normal(size=(10, n)) * 2
    found = Search.of(vertices, simplices).distances(points)
    for point, distance in zip(points, found, strict=True):
        each = []
        for corners in vertices[simplices]:
            weights, _ = nnls(np.vstack([corners.T, np.full(k + 1, 1e4)]), np.append(point, 1e4))
            each.append(float(np.linalg.norm(weights @ corners / weights.sum() - point)))
        assert distance == pytest.approx(min(each), abs=1e-5)


# -- right meshes are within their bounds ----------------------------------------------------------


Volume = np.ndarray[Any, Any]


def lewiner(values: Volume, isovalue: float) -> Mesh:
    """scikit-image, whose normals point to high values."""
    measure = pytest.importorskip("skimage.measure")
    vertices, faces = measure.marching_cubes(values, isovalue)[:2]
    return Mesh.of(vertices, faces[:, ::-1].astype(np.int64))


def lorensen(values: Volume, isovalue: float) -> Mesh:
    """scikit-image's tables of 1987."""
    measure = pytest.importorskip("skimage.measure")
    vertices, faces = measure.marching_cubes(values, isovalue, method="lorensen")[:2]
    return Mesh.of(vertices, faces[:, ::-1].astype(np.int64))


def pymcubes(values: Volume, isovalue: float) -> Mesh:
    """PyMCubes."""
    mcubes = pytest.importorskip("mcubes")
    vertices, faces = mcubes.marching_cubes(values, isovalue)
    return Mesh.of(vertices, faces.astype(np.int64))


def vtk_surface(name: str, values: Volume, isovalue: float) -> Mesh:
    """A filter of VTK from an image to triangles."""
    pytest.importorskip("vtkmodules")
    from vtkmodules import vtkFiltersCore
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkImageData

    image = vtkImageData()
    image.SetDimensions(values.shape)
    image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(order="F"), deep=True))
    contour = getattr(vtkFiltersCore, name)()
    contour.SetValue(0, isovalue)
    if name == "vtkSurfaceNets3D":
        contour.SmoothingOff()
        contour.SetOutputMeshTypeToTriangles()
    contour.SetInputData(image)
    contour.Update()
    surface = contour.GetOutput()
    faces = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return Mesh.of(vtk_to_numpy(surface.GetPoints().GetData()), faces.astype(np.int64))


def flying_edges(values: Volume, isovalue: float) -> Mesh:
    """VTK's flying edges."""
    return vtk_surface("vtkFlyingEdges3D", values, isovalue)


LIBRARIES = (lewiner, lorensen, pymcubes, flying_edges)


def naive_nets(values: Volume, isovalue: float, *, centred: bool = False) -> Mesh:
    """Gibson's surface nets without smoothing: the mean of a cell's crossings, quads round edges.

    With `centred`, vertices are the centres of their cells.
    """
    g = values.astype(float) - isovalue
    cells = tuple(N - 1 for N in g.shape)
    total, count, rows = np.zeros((*cells, 3)), np.zeros(cells), []
    number = np.arange(np.prod(cells)).reshape(cells)
    for axis in range(3):
        low = np.moveaxis(g, axis, 0)[:-1]
        high = np.moveaxis(g, axis, 0)[1:]
        low, high = np.moveaxis(low, 0, axis), np.moveaxis(high, 0, axis)
        crossed = (low >= 0) != (high >= 0)
        place = np.argwhere(crossed)
        where = place.astype(float)
        where[:, axis] += (low / np.where(crossed, low - high, 1))[crossed]
        second, third = (axis + 1) % 3, (axis + 2) % 3
        ring = []
        for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
            cell = place.copy()
            cell[:, second] -= a
            cell[:, third] -= b
            np.add.at(total, tuple(cell.T), where)
            np.add.at(count, tuple(cell.T), 1)
            ring.append(number[tuple(cell.T)])
        quads = np.stack(ring, axis=1)
        outward = (low >= 0)[crossed]
        quads = np.where(outward[:, None], quads, quads[:, ::-1])
        rows += [quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]
    means: Any = total.reshape(-1, 3) / np.maximum(count.reshape(-1, 1), 1)
    if centred:
        means = np.argwhere(np.ones(cells)) + 0.5
    used, faces = np.unique(np.concatenate(rows), return_inverse=True)
    return Mesh.of(means[used], faces.reshape(-1, 3))


@pytest.mark.parametrize(
    "case_id", posed(k for k, v in CASES.items() if (body_of(v).n, body_of(v).m) not in HEAVY)
)
def test_simplices_of_every_kind_are_within_the_bounds_of_a_split(case_id: str) -> None:
    """`isoref.simplicial` draws the zeros of the Kuhn split's linear interpolant."""
    case = CASES[case_id]
    within = allowed(case, "tetrahedra", "edges")
    found = judged(case, extract(case.build(), case.isovalues[0]), within)
    body = body_of(case)
    # The bound is no empty one: a curved body uses a fifth of it at least.
    assert min(body.radii) == inf or found.to_body > within.largest / 5


@pytest.mark.slow
@pytest.mark.parametrize("kind", sorted(HEAVY))
def test_large_simplicial_sets_are_within_the_bounds_of_a_split(kind: tuple[int, int]) -> None:
    """The same for sets of a hundred thousand simplices."""
    listed = [case for case in cases.of_kind(*kind) if case.id.endswith("uint8")]
    assert len(listed) == 4
    for case in listed:
        judged(case, extract(case.build(), case.isovalues[0]), allowed(case, "tetrahedra", "edges"))


FAMILIES = {
    "surface-nets": ("multilinear", "cells"),
    "dual-marching-cubes": ("multilinear", "cells"),
    "label-cubes": ("labels", "edges"),
    "marching-tetrahedra-kuhn": ("tetrahedra", "edges"),
    "marching-tetrahedra-five": ("tetrahedra", "edges"),
    "simplicial": ("tetrahedra", "edges"),
}
"""Methods of the reference that are not cubes with vertices on edges."""


@pytest.mark.parametrize("name", METHODS)
def test_methods_of_the_reference_are_within_the_bounds_of_their_family(name: str) -> None:
    """Every method; the longest distance uses a quarter of its bound at least."""
    assert set(FAMILIES) < set(METHODS)
    assert len(SMALL) == 5
    for case_id in SMALL[1::2]:
        case = CASES[case_id]
        within = allowed(case, *FAMILIES.get(name, ("multilinear", "edges")))
        found = judged(case, METHODS[name](case.build(), case.isovalues[0]), within)
        assert found.to_body > within.largest / 4


@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("case_id", posed(SURFACES))
def test_libraries_are_within_the_bounds_of_edges(library: Extractor, case_id: str) -> None:
    """scikit-image, PyMCubes and VTK."""
    case = CASES[case_id]
    mesh = library(case.build().values, case.isovalues[0])
    judged(case, mesh, allowed(case, "multilinear", "edges"))


@pytest.mark.parametrize("case_id", [k for k in CASES if k.startswith("bodies/2-1")])
def test_contours_of_a_library_are_within_the_bounds_of_edges(case_id: str) -> None:
    """scikit-image's find_contours; closed polylines repeat their first point."""
    measure = pytest.importorskip("skimage.measure")
    case, vertices, rows, start = CASES[case_id], [], [], 0
    lines = measure.find_contours(
        case.build().values, case.isovalues[0], positive_orientation="high"
    )
    assert lines
    for line in lines:
        ring = np.arange(len(line) - 1)
        rows.append(start + np.stack([ring, np.roll(ring, -1)], axis=1))
        vertices.append(line[:-1])
        start += len(ring)
    mesh = Mesh.of(np.concatenate(vertices), np.concatenate(rows))
    judged(case, mesh, allowed(case, "multilinear", "edges"))


@pytest.mark.parametrize("case_id", posed(SURFACES))
def test_surface_nets_are_within_the_bounds_of_cells(case_id: str) -> None:
    """Naive surface nets leave the body further than marching cubes may, and no further."""
    case = CASES[case_id]
    mesh = naive_nets(case.build().values, case.isovalues[0])
    found = judged(case, mesh, allowed(case, "multilinear", "cells"))
    assert found.to_body > allowed(case, "multilinear", "edges").largest


@pytest.mark.parametrize("case_id", posed(SURFACES))
def test_labels_are_within_their_bounds(case_id: str) -> None:
    """Vertices halfway along edges; nets of labels, their vertices averages or centres of cells."""
    case = CASES[case_id]
    inside = (case.build().values >= case.isovalues[0]).astype(np.uint8)
    found = judged(case, lewiner(inside.astype(float), 0.5), allowed(case, "labels", "edges"))
    assert found.to_body > allowed(case, "labels", "edges").largest / 2
    within = allowed(case, "labels", "cells")
    assert judged(case, naive_nets(inside, 0.5), within).to_body > within.largest / 4
    assert judged(case, naive_nets(inside, 0.5, centred=True), within).to_body > within.largest / 2
    judged(case, vtk_surface("vtkSurfaceNets3D", inside, 1), within)


@pytest.mark.parametrize("reach", [0.7, 1.5, 3.0])
@pytest.mark.parametrize("case_id", posed(SURFACES))
def test_a_resampler_is_within_the_bounds_of_its_reach(case_id: str, reach: float) -> None:
    """Marching cubes on a lattice of its own, of steps up to `reach` cells, multilinear between."""
    from scipy.ndimage import map_coordinates

    case = CASES[case_id]
    values = case.build().values.astype(float)
    counts = [ceil((N - 1) / reach) + 1 for N in values.shape]
    axes = [np.linspace(0, N - 1, count) for N, count in zip(values.shape, counts, strict=True)]
    own = map_coordinates(values, np.meshgrid(*axes, indexing="ij"), order=1)
    mesh = lewiner(own, case.isovalues[0])
    found = judged(
        case,
        Mesh.of(mesh.vertices * [axis[1] for axis in axes], mesh.simplices),
        allowed(case, "multilinear", "own", reach),
    )
    assert found.to_body > allowed(case, "multilinear", "own", reach).largest / 5


# -- wrong ones are caught -------------------------------------------------------------------------


def wrong(case: Case, mesh: Mesh) -> set[str]:
    """The names of the numbers that give a mesh away, by the widest bounds of indexed meshes."""
    body = body_of(case)
    found = measures(mesh.vertices, mesh.simplices, body)
    edges = disagreements(found, body, allowed(case, "multilinear", "edges"))
    cells = disagreements(found, body, allowed(case, "multilinear", "cells"))
    assert set(cells) <= set(edges)
    return set(cells)


def right(case: Case) -> Mesh:
    """The reference's answer."""
    return extract(case.build(), case.isovalues[0])


LIGHT = [
    k for k, v in CASES.items() if (body_of(v).n, body_of(v).m) not in HEAVY and v.samples < 10**5
]


@pytest.mark.parametrize("case_id", posed(LIGHT))
def test_an_empty_mesh_and_one_simplex_are_caught(case_id: str) -> None:
    """Nothing, or one simplex for every field."""
    case = CASES[case_id]
    mesh = right(case)
    none = np.empty((0, mesh.simplices.shape[1]), np.int64)
    assert {"pieces", "to_body", "to_mesh", "mean", "centroid", "degree"} <= wrong(
        case, Mesh.of(mesh.vertices, none)
    )
    n = body_of(case).n
    one = np.eye(n)[: mesh.simplices.shape[1]] * 2
    caught = wrong(case, Mesh.of(one, np.arange(len(one))[None]))
    assert {"to_body", "to_mesh"} <= caught


@pytest.mark.slow
def test_the_same_mesh_for_every_field_is_caught_on_all_but_its_own_body() -> None:
    """Whichever right mesh of a kind is answered always."""
    listed = [case for case in CASES.values() if "/3-1/" in case.id]
    sphere = right(listed[0])
    assert len(listed) == 16
    for case in listed:
        assert bool(wrong(case, sphere)) == (body_of(case) is not body_of(listed[0])), case.id


def patched(mesh: Mesh, count: int = 1) -> Mesh:
    """The mesh without the simplices about `count` of its vertices."""
    gone = mesh.simplices[:: max(len(mesh.simplices) // count, 1), 0][:count]
    kept = ~np.isin(mesh.simplices, gone).any(axis=1)
    return Mesh.of(mesh.vertices, mesh.simplices[kept])


FAULTS: dict[str, tuple[Callable[[Mesh], Mesh], str]] = {
    "missing patch": (patched, "shells"),
    "three missing patches": (lambda x: patched(x, 3), "b1"),
    "shift by half a cell": (lambda x: Mesh.of(x.vertices + 0.5, x.simplices), "centroid"),
    "shift along one axis": (
        lambda x: Mesh.of(x.vertices + 0.5 * np.eye(3)[1], x.simplices),
        "centroid",
    ),
    "axes swapped": (lambda x: Mesh.of(x.vertices[:, ::-1], x.simplices[:, ::-1]), "centroid"),
    "two axes swapped": (
        lambda x: Mesh.of(x.vertices[:, [1, 0, 2]], x.simplices[:, ::-1]),
        "centroid",
    ),
    "inside out": (lambda x: Mesh.of(x.vertices, x.simplices[:, ::-1]), "mean"),
    "every simplex twice": (
        lambda x: Mesh.of(x.vertices, np.concatenate([x.simplices] * 2)),
        "degree",
    ),
    "every component twice": (
        lambda x: Mesh.of(
            np.concatenate([x.vertices] * 2),
            np.concatenate([x.simplices, x.simplices + len(x.vertices)]),
        ),
        "pieces",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize(
    "case_id", posed(["bodies/3-1/sphere-16-uint8", "bodies/3-1/two-spheres-33-float64", TORUS])
)
def test_a_fault_of_surfaces_is_caught_by_the_number_that_shows_it(
    case_id: str, fault: str
) -> None:
    """And by no bound that is not exceeded: the mesh without the fault passes."""
    case = CASES[case_id]
    break_it, number = FAULTS[fault]
    mesh = METHODS["asymptotic-decider"](case.build(), case.isovalues[0])
    assert wrong(case, mesh) == set()
    assert number in wrong(case, break_it(mesh))


@pytest.mark.parametrize("case_id", posed(["bodies/3-1/sphere-17-float64", TORUS]))
def test_a_scale_by_n_over_n_minus_1_and_another_radius_are_caught(case_id: str) -> None:
    """The spacing of n samples taken for that of n - 1 intervals; a body half a cell too large."""
    case = CASES[case_id]
    mesh = METHODS["asymptotic-decider"](case.build(), case.isovalues[0])
    N = body_of(case).shape[0]
    scaled = Mesh.of(mesh.vertices * N / (N - 1), mesh.simplices)
    assert "centroid" in wrong(case, scaled)
    larger = METHODS["asymptotic-decider"](case.build(), case.isovalues[0] - 0.5)
    assert {"mean", "to_body"} <= wrong(case, larger)


@pytest.mark.parametrize("case_id", posed(k for k in LIGHT if k.endswith("-float64") and "16" in k))
def test_shifts_orientation_and_doubling_are_caught_in_every_kind(case_id: str) -> None:
    """What is said of surfaces holds for curves, points and sets in four and five dimensions."""
    case = CASES[case_id]
    mesh = right(case)
    assert {"centroid", "to_body"} <= wrong(case, Mesh.of(mesh.vertices + 0.5, mesh.simplices))
    assert "degree" in wrong(case, Mesh.of(mesh.vertices, np.concatenate([mesh.simplices] * 2)))
    if mesh.simplices.shape[1] > 1:
        turned = mesh.simplices.copy()
        turned[:, :2] = turned[:, 1::-1]
        assert "degree" in wrong(case, Mesh.of(mesh.vertices, turned))
        assert "shells" in wrong(case, Mesh.of(mesh.vertices, mesh.simplices[1:]))


# -- the cases -------------------------------------------------------------------------------------


@pytest.mark.slow
def test_cases_are_posed_as_the_design_says() -> None:
    """As floats and as bytes, of 2^e and 2^e + 1 samples, with no sample at its isovalue."""
    assert len(CASES) == 4 * len(BODIES)
    for case in cases.cases():
        body = body_of(case)
        field = case.build()
        assert field.shape == body.shape
        assert case.samples == np.prod(field.shape)
        assert {N & (N - 1) == 0 for N in body.shape} in ({True}, {False})
        assert field.values.dtype == np.dtype(case.id.rsplit("-", 1)[1])
        assert len(case.isovalues) == body.m
        assert not (field.values == case.isovalues[0]).any()
        if field.values.dtype == np.uint8:
            assert np.ptp(field.values) > 120


def test_cases_are_frozen() -> None:
    """The same numbers for ever: a checksum of all samples of a few cases of each kind."""
    digest = sha256()
    for n, m in KINDS:
        for case in [case for case in cases.of_kind(n, m) if case.id in CASES][:4]:
            values = case.build().values
            digest.update(values.astype(values.dtype.newbyteorder("<")).tobytes())
    assert digest.hexdigest()[:16] == "c4a08a391ad6c500"


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (("linear", "edges", [6.0], 3), "no interpolant 'linear'"),
        (("multilinear", "corners", [6.0], 3), "no placing of vertices 'corners'"),
    ],
)
def test_bounds_refuse_what_they_do_not_know(given: Any, message: str) -> None:
    """A message says what was wrong."""
    with pytest.raises(ValueError, match=message):
        bounds(*given)
    with pytest.raises(ValueError, match="no bodies are known"):
        known_bodies(6, 2)


def test_what_is_flat_encloses_nothing_and_has_no_centroid() -> None:
    """Two triangles of opposite orientation, and a polygon walked there and back."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0]])
    for vertices, rows in ((points, [[0, 1, 2], [0, 2, 1]]), (points[:, :2], [[0, 1], [1, 0]])):
        volume, centroid = enclosed(vertices, np.array(rows))
        assert volume == 0
        assert np.isnan(centroid).all()
