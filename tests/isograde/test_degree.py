"""Meetings of meshes and lattice faces, beside libigl's winding number and on the peers' meshes."""

from fractions import Fraction
from itertools import permutations

import igl
import mcubes
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from isograde.declaration import Conventions, Declaration, End
from isograde.oracles.degree import (
    Meetings,
    TooWideError,
    _determinant_signs,
    _determinants,
    _in_simplices,
    _in_triangles,
    _whole_numbers,
    crossings,
    excused_samples,
    meetings,
    winding,
)
from isograde.oracles.lattice import Lattice
from isograde.oracles.traces import traces
from isoref.field import Field, Floats, Integers
from isoref.mesh import Mesh
from isoref.simplicial import extract as simplicial
from skimage import measure

OUTSIDE = Declaration("", conventions=Conventions(tie="outside"))
SPLIT = Declaration("", interpolant="tetrahedra")
SHAPES = {1: (20,), 2: (9, 8), 3: (6, 5, 6), 4: (4, 4, 3, 4), 5: (3, 2, 3, 2, 2)}
# Every kind with facets, in up to five dimensions.
KINDS = [(n, m) for n in range(2, 6) for m in range(1, n)]


def noise(shape: tuple[int, ...], seed: int) -> Field:
    return Field.of(np.random.default_rng(seed).normal(size=shape))


def skimage_mesh(field: Field) -> tuple[Floats, Integers]:
    vertices, faces, _, _ = measure.marching_cubes(field.values, 0.0, gradient_direction="ascent")
    return vertices.astype(float), faces.astype(np.int64)


def several(n: int, m: int, seed: int = 0) -> tuple[Lattice, Mesh]:
    """Noise of m components on a small n-dimensional lattice, and Min's simplices in it."""
    values = np.random.default_rng([seed, n, m]).normal(size=(m, *SHAPES[n]))
    mesh = simplicial(Field.of(values, dimension=n))
    field = Field.of(values if m > 1 else values[0], dimension=n)
    return Lattice.of(field, (0.0,) * m, SPLIT), mesh


@pytest.mark.parametrize("seed", range(4))
def test_the_peers_separate_noise(seed: int) -> None:
    """Meshes open at the border meet every step, in single precision and in double."""
    field = noise((7, 9, 8), seed)
    lattice = Lattice.of(field, (0.0,), OUTSIDE)
    for vertices, faces in (skimage_mesh(field), mcubes.marching_cubes(field.values, 0.0)):
        places = lattice.index(np.asarray(vertices))
        found = meetings(lattice, places, np.asarray(faces, np.int64))
        assert len(found.axes) > 300
        assert not found.wrong(signed=False).any()
        assert found.reversed.all() or not found.reversed.any()


@pytest.mark.parametrize(("n", "m"), KINDS)
def test_simplices_meet_every_face_as_the_samples_say(n: int, m: int) -> None:
    """Another extractor, another dimension: degree on the boundary, with sign; Min 2003."""
    lattice, mesh = several(n, m)
    found = meetings(lattice, lattice.index(mesh.vertices), mesh.simplices)
    assert not found.wrong().any()
    assert found.wanted.any()
    turned = mesh.simplices[:, [*range(n - m - 1), n - m, n - m - 1]]
    against = meetings(lattice, lattice.index(mesh.vertices), turned)
    assert against.wrong().sum() == np.count_nonzero(found.wanted)
    assert not against.wrong(signed=False).any()


@pytest.mark.parametrize(("n", "m"), KINDS)
def test_a_mesh_half_a_cell_away_meets_the_wrong_faces(n: int, m: int) -> None:
    """However its vertices stand: nothing excuses them but values."""
    lattice, mesh = several(n, m)
    found = meetings(lattice, lattice.index(mesh.vertices) + 0.5, mesh.simplices)
    assert found.wrong().sum() > np.count_nonzero(found.wanted) / 2


@pytest.mark.parametrize(("n", "m"), KINDS)
def test_a_mesh_that_lost_a_fifth_of_its_simplices_is_found_out(n: int, m: int) -> None:
    """A hole that no walk from sample to sample passes is for `topology.closed` to find."""
    lattice, mesh = several(n, m)
    kept = np.random.default_rng(0).random(len(mesh.simplices)) > 0.2
    found = meetings(lattice, lattice.index(mesh.vertices), mesh.simplices[kept])
    assert found.wrong().any()


@given(st.integers(0, 10_000))
def test_the_winding_number_counts_the_turns_of_the_angle(seed: int) -> None:
    """Against the sum of the angles between neighbours."""
    corners = np.random.default_rng(seed).normal(size=(20, 5, 2))
    angle = np.arctan2(corners[..., 1], corners[..., 0])
    step = (np.roll(angle, -1, axis=1) - angle + np.pi) % (2 * np.pi) - np.pi
    assert np.array_equal(winding(corners), np.rint(step.sum(axis=1) / (2 * np.pi)))


def test_determinants_are_exact() -> None:
    """In integers, whatever the magnitudes; a matrix of rank three has none."""
    rows = np.random.default_rng(0).normal(size=(6, 4, 4))
    ratio = [float(x) for x in _determinants(_whole_numbers(rows))] / np.linalg.det(rows)
    assert ratio == pytest.approx(np.full(6, ratio[0]))
    rows = np.rint(rows * 2**20) * 2.0**-300
    rows[:, 3] = rows[:, 0] + rows[:, 1]
    assert all(x == 0 for x in _determinants(_whole_numbers(rows)))


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
    found = np.zeros((9, 9, 9))
    for x, (j, k), s in zip(height[:, 0], column, sign, strict=True):
        found[: int(np.ceil(x)), j, k] += s
    samples = np.argwhere(np.ones((9, 9, 9), bool)).astype(float)
    theirs = igl.winding_number(places, faces, samples).reshape(9, 9, 9)
    assert np.abs(theirs).max() > 0.5
    assert np.array_equal(np.rint(theirs), found)


def test_a_missing_face_is_a_step_that_is_not_separated() -> None:
    """One triangle of an octahedron round a sample gone: some step passes through the hole."""
    values = np.full((3, 3, 3), -1.0)
    values[1, 1, 1] = 1.0
    lattice = Lattice.of(Field.of(values), (0.0,))
    vertices, faces = mcubes.marching_cubes(values, 0.0)
    bad = [
        meetings(lattice, np.asarray(vertices), np.delete(faces, f, 0).astype(np.int64)).wrong()
        for f in range(8)
    ]
    assert sum(b.any() for b in bad) >= 3


def test_a_tied_sample_is_bridged() -> None:
    """A sample equal to the isovalue lies on the mesh: both conventions of a tie pass."""
    values = np.full((3, 3, 5), -1.0)
    values[1, 1, 1:4] = 1.0, 0.0, 1.0
    field = Field.of(values)
    vertices, faces = mcubes.marching_cubes(values, 0.0)
    for declared in (Declaration(""), OUTSIDE):
        lattice = Lattice.of(field, (0.0,), declared)
        found = meetings(lattice, np.asarray(vertices), np.asarray(faces, np.int64))
        assert not found.wrong().any()
        assert found.wanted.any()


def test_a_sample_that_the_mesh_touches_is_not_excused() -> None:
    """Surface nets half a cell away touch samples with all their vertices (design, one judge)."""
    values = np.full((5, 5, 5), -1.0)
    values[2, 2, 2] = 1.0
    lattice = Lattice.of(Field.of(values), (0.0,))
    vertices, faces = mcubes.marching_cubes(values, 0.0)
    on_samples = np.asarray(vertices) + np.sign(np.asarray(vertices) - 2) * 0.5
    assert np.array_equal(on_samples, np.rint(on_samples))
    inward = meetings(lattice, np.full_like(on_samples, 2.0), np.asarray(faces, np.int64))
    assert inward.wrong().any()
    assert not meetings(lattice, np.asarray(vertices), np.asarray(faces, np.int64)).wrong().any()


def test_an_own_lattice_is_excused_within_its_reach_and_no_farther() -> None:
    """A ball whose surface is off by less than the reach passes, and by more does not."""
    at = np.indices((17, 17, 17)) - 8.04
    field = Field.of(5.5 - np.sqrt((at**2).sum(axis=0)))
    declared = Declaration("", vertices="own", reach=1.0)
    lattice = Lattice.of(field, (0.0,), declared)
    assert excused_samples(lattice).any()
    for change, right in ((0.0, True), (0.9, True), (-0.9, True), (3.0, False), (-3.0, False)):
        vertices, faces = mcubes.marching_cubes(field.values + change, 0.0)
        found = meetings(lattice, np.asarray(vertices), np.asarray(faces, np.int64))
        assert len(found.found) > 50
        assert (not found.wrong().any()) == right


def test_a_period_closes_the_steps_round_it() -> None:
    """A wave that repeats after its last sample: the mesh of one period more, cut to it."""
    n = 8
    i, j, k = np.indices((n, n, n))
    wave = np.cos(2 * np.pi * (i + 0.3) / n) + np.cos(2 * np.pi * (j + 0.1) / n)
    values = wave + np.cos(2 * np.pi * (k + 0.7) / n) + 0.4
    vertices, faces = mcubes.marching_cubes(np.pad(values, (0, 1), mode="wrap"), 0.0)
    periodic = Declaration("", domain=(End(0.0, "periodic"),))
    lattice = Lattice.of(Field.of(values), (0.0,), periodic)
    places = lattice.index(np.asarray(vertices))
    found = meetings(lattice, places, np.asarray(faces, np.int64))
    assert not found.wrong().any()
    closing = found.corner[np.arange(len(found.corner)), found.axes[:, 0]] == n - 1
    assert found.wanted[closing].any()
    short, cut = mcubes.marching_cubes(values, 0.0)
    open_mesh = meetings(lattice, np.asarray(short), np.asarray(cut, np.int64))
    assert open_mesh.wrong().any()


def test_samples_outside_the_domain_are_not_judged() -> None:
    """An extractor that leaves the outermost cells out says so, and is right inside."""
    field = noise((8, 8, 8), 3)
    inner, faces = mcubes.marching_cubes(field.values[1:-1, 1:-1, 1:-1], 0.0)
    places, rows = np.asarray(inner) + 1.0, np.asarray(faces, np.int64)
    whole = Lattice.of(field, (0.0,))
    assert meetings(whole, places, rows).wrong().any()
    less = Lattice.of(field, (0.0,), Declaration("", domain=(End(1.0, "open"),)))
    found = meetings(less, places, rows)
    assert not found.wrong().any()
    assert found.wanted.any()


def test_absurdly_wide_faces_are_refused() -> None:
    """Ten thousand faces across the whole volume are no isosurface; nobody counts for an hour."""
    lattice = Lattice.of(noise((64, 64, 64), 0), (0.0,))
    places = np.random.default_rng(0).uniform(0, 63, (3000, 3))
    with pytest.raises(TooWideError, match="lines of samples"):
        meetings(lattice, places, np.random.default_rng(1).integers(0, 3000, (10_000, 3)))


def test_places_out_of_this_world_do_not_overflow() -> None:
    """Coordinates of 1e300 are far outside, and nothing more."""
    field = noise((4, 4, 4), 0)
    lattice = Lattice.of(field, (0.0,))
    vertices, faces = mcubes.marching_cubes(field.values, 0.0)
    vertices[0] = 1e300
    places = lattice.index(vertices)
    assert meetings(lattice, places, faces.astype(np.int64)).wrong().any()
    assert len(traces(lattice, places, faces.astype(np.int64)).spanning)


def test_found_and_wanted_are_laid_side_by_side() -> None:
    """The words of the judge: wrong with sign, wrong without, reversed."""
    pair = (np.array([[0], [1]]), np.zeros((2, 3), np.int64))
    met = Meetings(*pair, np.array([1, 0]), np.array([-1, 0]))
    assert met.wrong().tolist() == [True, False]
    assert met.wrong(signed=False).tolist() == [False, False]
    assert met.reversed.tolist() == [True, False]


def test_triangles_turn_round_zero_as_simplices_do() -> None:
    """All triangles on nine points about zero, with corners on both axes and in zero itself."""
    points = np.stack(np.meshgrid([-1.0, 0, 1], [-1.0, 0, 1], indexing="ij"), axis=-1).reshape(9, 2)
    rows = np.array(list(permutations(range(9), 3)))
    by_triangles, by_simplices = (
        _in_triangles(points[rows])[0],
        _in_simplices(points[rows], rows)[0],
    )
    assert np.array_equal(by_triangles, by_simplices)
    assert np.unique(by_triangles).tolist() == [-1, 0, 1]


@pytest.mark.parametrize("turned", [False, True])
def test_determinants_that_rounding_leaves_open_have_their_signs(turned: bool) -> None:
    """One unit in the last place more on the diagonal, one less, and none."""
    step = 2.0**-52
    rows = np.array([[[1 + k * step, 1.0], [1.0, 1.0]] for k in (1, -1, 0)])
    sign, _ = _determinant_signs(rows[:, ::-1] if turned else rows)
    assert sign.tolist() == ([-1, 1, 0] if turned else [1, -1, 0])


@pytest.mark.parametrize("past", [1, -1, 0])
def test_a_chain_that_passes_zero_more_nearly_than_rounding_tells_is_asked_exactly(
    past: int,
) -> None:
    """Rounded, one side goes by on the left of zero; exactly, on either side or through it."""
    corners = [(1, -1), (-1, 1), (-1, -1)]
    rounded = np.array([[*corners]], np.float64)
    rounded[0, 1, 1] += 2.0**-52
    exact = [[Fraction(a), Fraction(b)] for a, b in corners]
    exact[1][1] += past * Fraction(1, 2**80)
    assert winding(rounded).tolist() == [1]
    # A side through zero is on neither side of it, and not counted.
    assert winding(rounded, lambda row: exact).tolist() == [int(past > 0)]
    assert winding(rounded[:, ::-1], lambda row: exact[::-1]).tolist() == [-int(past > 0)]
