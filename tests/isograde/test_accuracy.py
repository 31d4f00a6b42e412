"""Observed orders: the formulas beside scipy and trimesh, right answers, and wrong ones."""

from collections.abc import Callable

import numpy as np
import pytest
import trimesh
from isograde.cases import accuracy as fields
from isograde.claims import accuracy
from isograde.model import Case, Declaration, Outcome, Status, Trial, Verdict
from isograde.oracles.convergence import normal_error, observed_order, total_mean_curvature
from isograde.oracles.halfedges import Surface
from isograde.oracles.shapes import shapes, smallest_angles
from isograde.oracles.trilinear_distance import distance, value_and_gradient
from isoref.field import Field, Floats
from isoref.methods import METHODS
from scipy import ndimage, stats

CASES = {case.id: case for case in fields.cases()}
CLAIMS = {claim.id: claim for claim in accuracy.CLAIMS}


def trial(case: Case, change: Callable[[Floats], Floats] = lambda v: v) -> Trial:
    """The reference's answer to the case, its samples changed."""
    field = case.build()
    posed = Field.of(change(np.asarray(field.values, np.float64)))
    mesh = METHODS["trilinear-cubes"](posed, case.isovalue)
    outcome = Outcome(Status.OK, mesh.vertices, mesh.simplices)
    return Trial(case, field, Declaration("here"), {"plain": outcome})


def verdicts(made: Trial) -> dict[str, Verdict]:
    """What each claim says."""
    return {name: claim.judge(made).verdict for name, claim in CLAIMS.items()}


@pytest.mark.parametrize("case", CASES.values(), ids=list(CASES))
def test_linear_interpolation_has_the_formal_orders(case: Case) -> None:
    """Etiene and others 2009: position, area and volume 2, normals 1."""
    made = trial(case)
    assert set(verdicts(made).values()) == {Verdict.PASS}
    position = CLAIMS["accuracy.position"].judge(made).numbers
    assert 1.8 < position["order"] < 2.2
    finest = accuracy.pieces(made)[-1]
    assert position["finest_error"] == finest.position
    assert finest.body.scale == max(piece.body.scale for piece in accuracy.pieces(made))


# What is done to the samples of the sphere, and the claims that catch it.
BROKEN: dict[str, tuple[Callable[[Floats], Floats], set[str]]] = {
    # Vertices in the middle of edges: first order at best; the volume is right on average.
    "midpoints": (np.sign, {"position", "normal", "distance", "area", "curvature"}),
    # Half a spacing too large: the error of the volume shrinks with order 1 only.
    "a shifted isovalue": (lambda v: v + 0.5, {"position", "distance", "area", "volume"}),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_one_is_caught_by_the_claims_on_what_it_spoils(name: str) -> None:
    """And by no others."""
    change, expected = BROKEN[name]
    found = verdicts(trial(CASES["accuracy/sphere"], change))
    wrong = {claim for claim, verdict in found.items() if verdict is Verdict.FAIL}
    assert wrong == {f"accuracy.{quantity}" for quantity in expected}


def test_every_claim_has_a_broken_implementation() -> None:
    """The table is complete."""
    caught = {f"accuracy.{quantity}" for _, claims in BROKEN.values() for quantity in claims}
    assert caught == set(CLAIMS)


def test_a_missing_body_is_not_judged() -> None:
    """That is a fault of level 1."""
    found = verdicts(trial(CASES["accuracy/sphere"], lambda v: v - 4.0))
    assert set(found.values()) == {Verdict.SKIP}


def test_orders_are_those_of_scipy() -> None:
    """Slope and confidence interval by another hand."""
    rng = np.random.default_rng(0)
    h = np.geomspace(0.01, 1, 9)
    error = h**1.7 * np.exp(rng.normal(0, 0.1, 9))
    mine = observed_order(h, error)
    theirs = stats.linregress(np.log(h), np.log(error))
    half = stats.t.ppf(0.975, 7) * theirs.stderr
    np.testing.assert_allclose(
        [mine.value, mine.low, mine.high],
        [theirs.slope, theirs.slope - half, theirs.slope + half],
    )


def test_curvature_is_that_of_trimesh_and_of_polyhedra() -> None:
    """A cube's total mean curvature is 3 pi times its side; trimesh sums the same angles."""
    box = trimesh.creation.box()
    assert np.isclose(total_mean_curvature(Surface.of(box.vertices, box.faces)), 3 * np.pi)
    ball = trimesh.creation.icosphere(subdivisions=3, radius=2.0)
    mine = total_mean_curvature(Surface.of(np.asarray(ball.vertices), np.asarray(ball.faces)))
    assert np.isclose(mine, ball.integral_mean_curvature, rtol=1e-6)
    assert np.isclose(mine, 8 * np.pi, rtol=0.01)


def test_normals_of_a_flat_face_have_their_angle() -> None:
    """A face tilted by 0.1."""
    flat = Surface.of(np.array([[0, 0, 0], [1.0, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
    truth = np.array([[np.sin(0.1), 0, np.cos(0.1)]])
    assert np.isclose(normal_error(flat, truth), 0.1)
    assert np.isclose(normal_error(flat, -truth), 0.1)


@pytest.mark.parametrize("shape", fields.SCALES)
def test_bodies_stand_clear_and_measure_what_their_meshes_do(shape: fields.Shape) -> None:
    """Distance, normals, area and volume beside a fine mesh and finite differences."""
    bodies, samples = fields.row(shape)
    for body in bodies:
        wide, high = body.reach
        extent = np.array([wide, wide, high])
        assert (np.array(body.middle) - extent > 1).all()
        assert (np.array(body.middle) + extent < np.array(samples) - 2).all()
    body = bodies[-1]
    scale = body.scale
    made = (
        trimesh.creation.icosphere(5, scale)
        if shape == "sphere"
        else trimesh.creation.torus(scale, fields.TUBE * scale, 200, 200)
    )
    assert np.isclose(made.area, body.area, rtol=2e-3)
    assert np.isclose(made.volume, body.volume, rtol=3e-3)
    assert np.isclose(made.integral_mean_curvature, body.bend, rtol=2e-3)
    points = np.asarray(made.vertices) * 1.05 + np.array(body.middle)
    step = 1e-5 * np.eye(3)
    slopes = [(body.distance(points + s) - body.distance(points - s)) / 2e-5 for s in step]
    np.testing.assert_allclose(body.normals(points), np.stack(slopes, axis=1), atol=1e-6)


def test_part_of_a_row_is_not_judged() -> None:
    """A block cut from the field has no whole bodies."""
    whole = trial(CASES["accuracy/sphere"])
    part = Case("accuracy/sphere/block", whole.case.build, 0.0, 8, whole.case.tags)
    made = Trial(part, whole.field, whole.declaration, whole.outcomes)
    assert set(verdicts(made).values()) == {Verdict.SKIP}


def test_distances_are_those_of_a_plane_and_of_a_fine_mesh() -> None:
    """Along Newton's way: exact for a plane; for a noisy field not below the nearest point's."""
    rng = np.random.default_rng(0)
    i, j, k = np.meshgrid(*[np.arange(6.0)] * 3, indexing="ij")
    places = rng.uniform(2, 3, (50, 3))
    found = distance(2 * i + j - 2 * k, 2.5, places)
    np.testing.assert_allclose(found, np.abs(places @ [2, 1, -2] - 2.5) / 3, atol=1e-8)
    values = rng.normal(size=(3, 3, 3))
    fine = np.linspace(0, 2, 41)
    grid = np.stack(np.meshgrid(fine, fine, fine, indexing="ij"), axis=-1).reshape(-1, 3)
    level, slope = value_and_gradient(values, grid)
    theirs = ndimage.map_coordinates(values, grid.T, order=1)
    np.testing.assert_allclose(level, theirs, atol=1e-12)
    near = grid[np.abs(level) < np.linalg.norm(slope, axis=1) * 0.05]
    places = rng.uniform(0, 2, (30, 3))
    found = distance(values, 0.0, places)
    nearest = np.linalg.norm(places[:, None] - near, axis=2).min(axis=1)
    arrived = np.isfinite(found)
    assert arrived.sum() > 20
    assert (found[arrived] > nearest[arrived] - 0.16).all()


def test_shapes_are_those_of_trimesh() -> None:
    """The smallest angle of each triangle by another hand."""
    rng = np.random.default_rng(0)
    points, faces = rng.normal(size=(30, 3)), np.arange(30).reshape(10, 3)
    mine = smallest_angles(Surface.of(points, faces))
    theirs = trimesh.triangles.angles(points[faces]).min(axis=1)
    np.testing.assert_allclose(np.radians(mine), theirs)
    thin = np.array([[0, 0, 0], [1, 0, 0], [1, 0.01, 0]])
    both = Surface.of(np.concatenate([thin, np.eye(3)]), np.arange(6).reshape(2, 3))
    assert shapes(both).thin == 0.5
