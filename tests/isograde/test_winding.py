"""Signed steps between samples, beside libigl's winding number and on the peers' meshes."""

import igl
import mcubes
import numpy as np
import pytest
from isograde.oracles.lattice import Lattice
from isograde.oracles.traces import traces
from isograde.oracles.winding import TooWideError, crossings, steps
from isoref.field import Field, Floats, Integers
from isoref.mesh import Mesh
from skimage import measure


def noise(shape: tuple[int, int, int], seed: int) -> Field:
    return Field.of(np.random.default_rng(seed).normal(size=shape))


def skimage_mesh(field: Field) -> tuple[Floats, Integers]:
    vertices, faces, _, _ = measure.marching_cubes(field.values, 0.0, gradient_direction="ascent")
    return vertices.astype(float), faces.astype(np.int64)


@pytest.mark.parametrize("seed", range(4))
def test_the_peers_separate_noise(seed: int) -> None:
    """Meshes open at the border pass every step, in single precision and in double."""
    field = noise((7, 9, 8), seed)
    lattice = Lattice.of(field, 0.0, "outside")
    for vertices, faces in (skimage_mesh(field), mcubes.marching_cubes(field.values, 0.0)):
        found = steps(lattice, lattice.index(np.asarray(vertices)), np.asarray(faces, np.int64))
        assert len(found.axis) > 300
        assert not found.unseparated.any()
        assert found.reversed.all() or not found.reversed.any()


def test_a_reversed_mesh_separates_but_faces_the_wrong_way() -> None:
    """Separation ignores the sign, facing is the sign."""
    field = noise((5, 5, 5), 0)
    lattice = Lattice.of(field, 0.0)
    vertices, faces = mcubes.marching_cubes(field.values, 0.0)
    mesh = Mesh.of(vertices, faces)
    right = steps(lattice, lattice.index(mesh.vertices), mesh.simplices)
    wrong = steps(lattice, lattice.index(mesh.vertices), mesh.simplices[:, ::-1])
    assert not right.reversed.any()
    assert not wrong.unseparated.any()
    assert wrong.reversed.all()


@pytest.mark.parametrize("seed", range(3))
def test_steps_add_up_to_the_winding_number(seed: int) -> None:
    """On a closed mesh that ignores the lattice, sums along a line are libigl's winding numbers."""
    rng = np.random.default_rng(seed)
    values = np.full((9, 9, 9), -1.0)
    values[1:-1, 1:-1, 1:-1] = rng.normal(size=(7, 7, 7))
    vertices, faces = mcubes.marching_cubes(values, 0.0)
    # Turn and shrink the mesh, so that it crosses the lines of samples anywhere.
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    places = (vertices - 4) @ turn.T * 0.55 + 4.03
    faces = faces.astype(np.int64)
    height, column, sign = crossings(places, faces, (9, 9, 9))
    winding = np.zeros((9, 9, 9))
    for x, (j, k), s in zip(height, column, sign, strict=True):
        winding[: int(np.ceil(x)), j, k] += s
    samples = np.argwhere(np.ones((9, 9, 9), bool)).astype(float)
    theirs = igl.winding_number(places, faces, samples).reshape(9, 9, 9)
    assert np.abs(theirs).max() > 0.5
    assert np.array_equal(np.rint(theirs), winding)


def test_a_missing_face_is_a_step_that_is_not_separated() -> None:
    """One triangle of an octahedron round a sample gone: some step passes through the hole."""
    values = np.full((3, 3, 3), -1.0)
    values[1, 1, 1] = 1.0
    field = Field.of(values)
    lattice = Lattice.of(field, 0.0)
    vertices, faces = mcubes.marching_cubes(values, 0.0)
    bad = [
        steps(lattice, np.asarray(vertices), np.delete(faces, f, 0).astype(np.int64)).unseparated
        for f in range(8)
    ]
    assert sum(b.any() for b in bad) >= 3


def test_a_touched_sample_is_bridged() -> None:
    """A sample equal to the isovalue lies on the mesh: both conventions of a tie pass."""
    values = np.full((3, 3, 5), -1.0)
    values[1, 1, 1:4] = 1.0, 0.0, 1.0
    field = Field.of(values)
    vertices, faces = mcubes.marching_cubes(values, 0.0)
    for tie in ("inside", "outside"):
        lattice = Lattice.of(field, 0.0, tie)
        found = steps(lattice, np.asarray(vertices), np.asarray(faces, np.int64))
        assert not found.unseparated.any()


def test_absurdly_wide_faces_are_refused() -> None:
    """Ten thousand faces across the whole volume are no isosurface; nobody counts for an hour."""
    lattice = Lattice.of(noise((64, 64, 64), 0), 0.0)
    places = np.random.default_rng(0).uniform(0, 63, (3000, 3))
    with pytest.raises(TooWideError, match="lines of samples"):
        steps(lattice, places, np.random.default_rng(1).integers(0, 3000, (10_000, 3)))


def test_places_out_of_this_world_do_not_overflow() -> None:
    """Coordinates of 1e300 are far outside, and nothing more."""
    field = noise((4, 4, 4), 0)
    lattice = Lattice.of(field, 0.0)
    vertices, faces = mcubes.marching_cubes(field.values, 0.0)
    vertices[0] = 1e300
    places = lattice.index(vertices)
    assert steps(lattice, places, faces.astype(np.int64)).unseparated.any()
    assert len(traces(lattice, places, faces.astype(np.int64)).spanning)
