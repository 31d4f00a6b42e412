"""With the label "equal": a manifold by position, no triangle without area, topology as before."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from isograde.oracles.complexes import Complex
from isograde.oracles.self_intersections import self_intersections
from isoref import METHODS, FieldError, Mesh, extract
from isoref.degenerate import state
from isoref.field import Array
from isoref.ties import NEARNESS, near_samples, separated

# Their vertices lie on the edges of cells or of tetrahedra; the drawings of 1987 are torn.
ON_EDGES = [
    name
    for name in METHODS
    if name not in ("surface-nets", "dual-marching-cubes", "label-cubes", "lorensen-cline")
]


def plate() -> Array:
    """One sample thick, at the isovalue: the surface lies on itself."""
    values = np.full((7, 7, 5), -1)
    values[1:6, 1:6, 2] = 0
    return values


def rod() -> Array:
    """A row of samples at the isovalue."""
    values = np.full((7, 5, 5), -1)
    values[1:6, 2, 2] = 0
    return values


def lone() -> Array:
    """One sample at the isovalue, and nothing else inside."""
    values = np.full((3, 3, 3), -1)
    values[1, 1, 1] = 0
    return values


def blocks() -> Array:
    """Two blocks of ones among minus ones that meet in a sample at the isovalue."""
    values = np.full((9, 9, 9), -1)
    values[1:4, 1:4, 1:4] = values[5:8, 5:8, 5:8] = 1
    values[4, 4, 4] = 0
    return values


def signs() -> Array:
    """Minus one, 0 and one at random: plates, rods and blocks of every kind."""
    return np.random.default_rng(3).integers(-1, 2, size=(6, 6, 6))


def whole() -> Array:
    """Small whole numbers at random."""
    return np.random.default_rng(1).integers(-2, 3, size=(6, 6, 6))


FIELDS = (plate, rod, lone, blocks, signs, whole)


def by_position(mesh: Mesh) -> Complex:
    """The mesh with one vertex a place, as somebody reads it who gets triangles alone."""
    _, first, number = np.unique(mesh.vertices, axis=0, return_index=True, return_inverse=True)
    return Complex.of(mesh.vertices[first], number.reshape(-1)[mesh.simplices])


@pytest.mark.parametrize("make", FIELDS)
@pytest.mark.parametrize("method", ON_EDGES)
def test_ties_leave_a_manifold_by_position_with_the_topology_it_had(
    method: str, make: object
) -> None:
    """No two vertices at one place, no triangle without area; Euler number and pieces as before."""
    values = make()  # type: ignore[operator]
    given_mesh = extract(values, 0, method=method)
    mesh = extract(values, 0, method=method, nearness=NEARNESS)
    assert len(mesh.simplices)
    before, after = state(given_mesh), state(mesh)
    assert before.degenerate > after.degenerate == 0
    assert after.crowded == after.pinched == 0
    assert after.euler == before.euler
    placed = by_position(mesh)
    assert len(placed.points) == len(mesh.vertices)
    assert not len(placed.crowded_facets)
    assert not len(placed.misdirected_facets)
    assert placed.components == Complex.of(given_mesh.vertices, given_mesh.simplices).components
    assert (before.boundary == 0) == (after.boundary == 0)


@pytest.mark.parametrize("make", FIELDS)
@pytest.mark.parametrize("method", ["trilinear-cubes", "asymptotic-decider"])
def test_triangles_beside_ties_do_not_cross(method: str, make: object) -> None:
    """By exact arithmetic; as they were, sheets lie on each other."""
    mesh = extract(make(), 0, method=method, nearness=NEARNESS)  # type: ignore[operator]
    assert len(self_intersections(mesh.vertices, mesh.simplices)) == 0


@given(
    values=arrays(np.int8, (4, 4, 4), elements=st.integers(-2, 2)),
    nearness=st.sampled_from([2.0**-20, NEARNESS, 0.1, 0.25]),
)
def test_whole_numbers_of_any_kind(values: Array, nearness: float) -> None:
    """The law of the module, with caps too: closed stays closed."""
    for cap in (False, True):
        given_mesh = extract(values, 0, method="trilinear-cubes", cap=cap, provenance=True)
        if not len(given_mesh.simplices):
            continue
        done = separated(given_mesh, nearness)
        before, after = state(given_mesh), state(done.mesh)
        assert after.crowded == after.pinched == after.degenerate == done.without_area == 0
        assert after.euler == before.euler
        assert (before.boundary == 0) == (after.boundary == 0)
        places = done.mesh.vertices
        assert len(np.unique(places, axis=0)) == len(places)


@given(
    values=arrays(
        np.float64,
        (4, 4, 4),
        elements=st.one_of(
            st.floats(-1, 1), st.sampled_from([0.0, 1e-12, -1e-12, 1e-300, -5e-324])
        ),
    )
)
def test_what_is_nearly_a_tie_is_as_good_as_one(values: Array) -> None:
    """No vertex on an edge is nearer to a sample than said, unless it is the sample."""
    given_mesh = extract(values, 0, method="trilinear-cubes", provenance=True)
    done = separated(given_mesh)
    before, after = state(given_mesh), state(done.mesh)
    assert after.crowded == after.pinched == 0
    assert after.euler == before.euler
    found = done.mesh.traced()
    on_edge = (found.ends[:, 1] >= 0) & (found.ends[:, 0] != found.ends[:, 1])
    assert (np.abs(found.t[on_edge] - 0.5) <= 0.5 - NEARNESS).all()
    moved = np.abs(done.mesh.vertices[on_edge] - done.mesh.vertices[on_edge].round()).max(axis=1)
    assert (moved >= NEARNESS * (1 - 1e-9)).all()


def test_the_labels_know_no_order() -> None:
    """Vertices and triangles shuffled: the same samples become vertices."""
    mesh = extract(signs(), 0, method="trilinear-cubes", provenance=True)
    found, random = mesh.traced(), np.random.default_rng(0)
    new, rows = random.permutation(len(mesh.vertices)), random.permutation(len(mesh.simplices))
    shuffled = Mesh(
        mesh.vertices[new],
        np.argsort(new)[mesh.simplices[rows]],
        replace(found, ends=found.ends[new], t=found.t[new], cells=found.cells[rows]),
    )
    one, other = separated(mesh), separated(shuffled)
    assert one.labelled == other.labelled > 0
    assert one.moved == other.moved > 0
    assert np.array_equal(
        np.unique(one.mesh.vertices, axis=0), np.unique(other.mesh.vertices, axis=0)
    )


def test_a_surface_that_passes_a_tie_once_has_the_sample_as_its_vertex() -> None:
    """A plane of ties under inside samples: every one is labelled, nothing moves off."""
    values = np.broadcast_to(np.arange(5)[:, None, None] - 2, (5, 4, 4)).copy()
    done = separated(extract(values, 0, method="trilinear-cubes", provenance=True))
    assert (done.labelled, done.moved) == (16, 0)
    assert (done.mesh.vertices[:, 0] == 2).all()


def test_a_plate_gets_the_stated_thickness_and_its_samples_are_inside_it() -> None:
    """Where the surface passes a sample twice it moves off to both sides."""
    done = separated(extract(plate(), 0, method="trilinear-cubes", provenance=True), 0.125)
    assert done.labelled == 0
    assert done.mesh.vertices[:, 2].min() == 2 - 0.125
    assert done.mesh.vertices[:, 2].max() == 2 + 0.125


def test_in_general_position_nothing_happens() -> None:
    """No crossing is near a sample: the same arrays."""
    values = np.where(np.random.default_rng(0).random((6, 6, 6)) < 0.5, -1.0, 1.0)
    mesh = extract(values, 0, method="trilinear-cubes", provenance=True)
    done = separated(mesh)
    assert (done.labelled, done.moved) == (0, 0)
    assert np.array_equal(done.mesh.vertices, mesh.vertices)
    assert np.array_equal(done.mesh.simplices, mesh.simplices)


def test_where_the_lattice_stands_and_what_numbers_the_mesh_has_do_not_matter() -> None:
    """Spacing, origin and single precision; the labels are the same."""
    values = signs()
    one = extract(values, 0, method="trilinear-cubes", nearness=NEARNESS)
    other = extract(
        values, 0, (0.5, 2, 4), (8, 16, 32), "trilinear-cubes", "single", nearness=NEARNESS
    )
    assert other.vertices.dtype == np.float32
    assert np.array_equal(one.simplices, other.simplices)
    assert np.allclose(one.vertices * (0.5, 2, 4) + (8, 16, 32), other.vertices, atol=1e-5)


def test_a_mesh_that_was_torn_stays_as_torn() -> None:
    """The drawings of 1987: what is wrong without ties is not what the labels answer for."""
    given_mesh = extract(whole(), 0, method="lorensen-cline", provenance=True)
    done = separated(given_mesh)
    assert state(done.mesh).degenerate == 0
    assert state(done.mesh).pinched == state(given_mesh).pinched > 0


@pytest.mark.parametrize("nearness", [-0.1, 0.26, np.nan])
def test_another_nearness_is_refused(nearness: float) -> None:
    """With the number, and what it may be."""
    with pytest.raises(FieldError, match="at most 1/4"):
        extract(lone(), 0, nearness=nearness)


def test_segments_and_meshes_without_provenance_are_refused() -> None:
    """An error that says what is missing."""
    mesh = extract(lone(), 0, provenance=True)
    with pytest.raises(FieldError, match="no triangles"):
        separated(replace(mesh, simplices=mesh.simplices[:, :2]))
    with pytest.raises(FieldError, match="provenance=True"):
        separated(Mesh(mesh.vertices, mesh.simplices))


def test_vertices_inside_cells_are_near_no_sample() -> None:
    """Dual methods have no crossings: their vertices stay."""
    mesh = extract(whole(), 0, method="dual-marching-cubes", provenance=True)
    assert len(mesh.vertices)
    assert (near_samples(mesh.traced(), 0.25) == -1).all()
