"""Observed orders: the formulas beside scipy and trimesh, right answers, and wrong ones."""

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import trimesh
from isograde.cases import accuracy as fields
from isograde.cases import simplices
from isograde.claims import accuracy
from isograde.declaration import Declaration, declaration_from
from isograde.model import SURFACES, Case, Finding, Outcome, Status, Trial, Verdict
from isograde.oracles.complexes import Complex
from isograde.oracles.convergence import normal_error, observed_order, total_mean_curvature
from isograde.oracles.shapes import OF_PLANES, shapes, smallest_angles
from isograde.oracles.trilinear_distance import distance, value_and_gradient
from isoref.fast import simplicial
from isoref.field import Field, Floats
from isoref.mesh import Mesh
from isoref.methods import METHODS
from scipy import ndimage, stats

from tests.isograde.families import CORRECT
from tests.isograde.judging import verdicts as judged

CASES = {case.id: case for case in fields.cases()}
QUICK = [name for name, case in CASES.items() if "full" not in case.tags]
RETURNED = "accuracy.normals_returned"
PLANES = "accuracy.normals_of_planes"
SHAPES = "accuracy.shapes"
CLAIMS = {
    claim.id: claim for claim in accuracy.CLAIMS if claim.id not in (RETURNED, PLANES, SHAPES)
}
CUBES = Declaration("here", level=4)
KUHN = Declaration("here", interpolant="tetrahedra")


def trial(
    case: Case,
    change: Callable[[Floats], Floats] = lambda v: v,
    declared: Declaration = CUBES,
) -> Trial:
    """The reference's answer to the case, its samples changed."""
    field = case.build()
    values = change(np.asarray(field.values, np.float64))
    posed = Field.of(values, dimension=field.dimension)
    if case.kind == SURFACES:
        mesh = METHODS["trilinear-cubes"](posed, 0.0)
    else:
        mesh = simplicial.extract(posed, 0.0)
    outcome = Outcome(Status.OK, mesh.vertices, mesh.simplices)
    return Trial(case, field, declared, {"plain": outcome})


def verdicts(made: Trial) -> dict[str, Verdict]:
    """What each claim says."""
    return {
        name: claim.judge(made).verdict
        for name, claim in CLAIMS.items()
        if claim.kinds(made.kind) and claim.families(made.declaration)
    }


@pytest.mark.parametrize("name", QUICK)
def test_linear_interpolation_has_the_formal_orders(name: str) -> None:
    """Etiene and others 2009: position, area and volume 2, normals 1; of every kind."""
    case = CASES[name]
    declared = CUBES if case.kind == SURFACES else KUHN
    made = trial(case, declared=declared)
    said = verdicts(made)
    assert {"accuracy.position", "accuracy.measure", "accuracy.normal"} <= set(said)
    assert ("accuracy.volume" in said) == (case.kind.m == 1)
    assert set(said.values()) == {Verdict.PASS}
    position = CLAIMS["accuracy.position"].judge(made).numbers
    assert 1.8 < position["order"] < 2.2
    finest = accuracy.pieces(made)[-1]
    assert position["finest_error"] == finest.position
    assert finest.body.scale == max(piece.body.scale for piece in accuracy.pieces(made))


@pytest.mark.slow
def test_surfaces_in_four_dimensions_have_the_formal_orders() -> None:
    """The row that is not run by default."""
    assert set(verdicts(trial(CASES["accuracy/4-2"], declared=KUHN)).values()) == {Verdict.PASS}


@pytest.mark.parametrize("name", ["accuracy/2-1", "accuracy/3-2"])
def test_midpoints_are_of_first_order_in_every_kind(name: str) -> None:
    """Right for who sees labels only, and for nobody else."""
    found = verdicts(trial(CASES[name], np.sign, KUHN))
    wrong = {claim for claim, verdict in found.items() if verdict is Verdict.FAIL}
    assert {"accuracy.position", "accuracy.normal", "accuracy.measure"} <= wrong
    labels = declaration_from({"interpolant": "labels"}, "labels")
    said = verdicts(trial(CASES[name], np.sign, labels))
    assert said
    assert set(said.values()) == {Verdict.PASS}


@pytest.mark.parametrize("name", ["nets", "dual_cubes", "label_cubes", "tetrahedra_of_five"])
def test_families_have_the_orders_that_are_asked_of_them(name: str) -> None:
    """Vertices in cells, labels and splits."""
    family = CORRECT[name]
    found = by_family(family.function, declaration_from(dict(family.says), name))
    assert found
    returned = found.pop("accuracy.normals_returned")
    assert set(returned) == {Verdict.SKIP}  # They return none.
    assert found
    assert all(set(counted) == {Verdict.PASS} for counted in found.values()), found


def by_family(function: Any, declared: Declaration) -> dict[str, Counter[Verdict]]:
    """The verdicts on the row of spheres."""
    return judged(function, declared, [CASES["accuracy/sphere"]], "accuracy.")


# What is done to the samples of the sphere, and the claims that catch it.
BROKEN: dict[str, tuple[Callable[[Floats], Floats], set[str]]] = {
    # Vertices in the middle of edges: first order at best; the volume is right on average.
    "midpoints": (np.sign, {"position", "normal", "distance", "measure", "curvature"}),
    # Half a spacing too large: the error of the volume shrinks with order 1 only.
    "a shifted isovalue": (lambda v: v + 0.5, {"position", "distance", "measure", "volume"}),
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
    assert np.isclose(total_mean_curvature(Complex.of(box.vertices, box.faces)), 3 * np.pi)
    ball = trimesh.creation.icosphere(subdivisions=3, radius=2.0)
    mine = total_mean_curvature(Complex.of(np.asarray(ball.vertices), np.asarray(ball.faces)))
    assert np.isclose(mine, ball.integral_mean_curvature, rtol=1e-6)
    assert np.isclose(mine, 8 * np.pi, rtol=0.01)


def test_normals_of_a_flat_face_have_their_angle() -> None:
    """A face tilted by 0.1."""
    flat = Complex.of(np.array([[0, 0, 0], [1.0, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
    truth = np.array([[[np.sin(0.1), 0, np.cos(0.1)]]])
    assert np.isclose(normal_error(flat, truth), 0.1)
    assert np.isclose(normal_error(flat, -truth), 0.1)


@pytest.mark.parametrize("name", fields.ROWS)
def test_bodies_stand_clear_of_the_border_and_of_each_other(name: str) -> None:
    """And what their functions say of points near them is a distance."""
    bodies, samples = fields.row(name)
    rng = np.random.default_rng(1)
    for body, after in zip(bodies, [*bodies[1:], None], strict=True):
        assert (np.array(body.middle) - body.reach > 1).all()
        assert (np.array(body.middle) + body.reach < np.array(samples) - 2).all()
        if after:
            assert body.middle[0] + body.reach[0] + 2 < after.middle[0] - after.reach[0]
        # Go from points of the body along its normals: the distance is the way.
        points = np.array(body.middle) + body.scale * rng.normal(size=(40, len(samples)))
        for _ in range(60):
            normals = body.normals(points)
            step = np.concatenate([body.function(points)[:, None], body.heights(points)], axis=1)
            points = points - np.einsum("pm,pmn->pn", step, normals)
        assert np.allclose(body.distance(points), 0, atol=1e-6)
        away = rng.normal(size=(40, fields.ROWS[name].kind.m))
        away *= 0.1 / np.linalg.norm(away, axis=1, keepdims=True)
        moved = points + np.einsum("pm,pmn->pn", away, body.normals(points))
        assert np.allclose(np.abs(body.distance(moved)), 0.1, atol=1e-6)


@pytest.mark.parametrize("name", ["sphere", "torus"])
def test_bodies_measure_what_their_meshes_do(name: str) -> None:
    """Area, volume, curvature and normals beside a fine mesh and finite differences."""
    bodies, _ = fields.row(name)
    body = bodies[-1]
    scale = body.scale
    made = (
        trimesh.creation.icosphere(5, scale)
        if name == "sphere"
        else trimesh.creation.torus(scale, fields.TUBE * scale, 200, 200)
    )
    assert np.isclose(made.area, body.measure, rtol=2e-3)
    assert np.isclose(made.volume, body.volume, rtol=3e-3)
    assert np.isclose(made.integral_mean_curvature, body.bend, rtol=2e-3)
    points = np.asarray(made.vertices) * 1.05 + np.array(body.middle)
    step = 1e-5 * np.eye(3)
    slopes = [(body.distance(points + s) - body.distance(points - s)) / 2e-5 for s in step]
    np.testing.assert_allclose(body.normals(points)[:, 0], np.stack(slopes, axis=1), atol=1e-6)


def test_part_of_a_row_is_not_judged() -> None:
    """A block cut from the field has no whole bodies."""
    whole = trial(CASES["accuracy/sphere"])
    part = Case("accuracy/sphere/block", whole.case.build, (0.0,), 8, whole.case.tags)
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
    mine = smallest_angles(Complex.of(points, faces))
    theirs = trimesh.triangles.angles(points[faces]).min(axis=1)
    np.testing.assert_allclose(np.radians(mine), theirs)
    thin = np.array([[0, 0, 0], [1, 0, 0], [1, 0.01, 0]])
    both = Complex.of(np.concatenate([thin, np.eye(3)]), np.arange(6).reshape(2, 3))
    assert shapes(both).thin == 0.5
    assert shapes(both).least < 1


def with_normals(turned: Callable[[Floats], Floats]) -> Verdict:
    """What is said of the reference's row of spheres with normals of their own, changed."""
    made = trial(CASES["accuracy/sphere"])
    bodies, _ = fields.row(made.case.facts["row"])
    points = made.mesh.vertices
    nearest = np.argmin([np.abs(body.distance(points)) for body in bodies], axis=0)
    normals = np.stack([body.normals(points)[:, 0] for body in bodies])
    right = turned(np.asarray(normals[nearest, np.arange(len(points))]))
    plain = replace(made.plain, normals=right)
    claim = next(claim for claim in accuracy.CLAIMS if claim.id == RETURNED)
    return claim.judge(replace(made, outcomes={"plain": plain})).verdict


def test_normals_that_come_with_the_vertices_are_judged() -> None:
    """Of "accuracy.normals_returned": either side up, all alike, and finite."""
    tilt = np.array([0.2, -0.1, 0.1])
    assert with_normals(lambda n: n + 1e-4 * tilt) is Verdict.PASS
    assert with_normals(lambda n: -3 * n + 1e-4 * tilt) is Verdict.PASS
    assert with_normals(lambda n: n + tilt) is Verdict.FAIL
    assert with_normals(lambda n: np.where(n[:, :1] > 0, n, -n)) is Verdict.FAIL
    assert with_normals(lambda n: n * np.nan) is Verdict.FAIL
    assert CLAIMS
    assert trial(CASES["accuracy/sphere"]).plain.normals is None


def of_a_plane(turned: Callable[[Floats, Floats], Any] | None) -> Finding:
    """What is said of the reference's plane with normals of its slope, changed by its points."""
    case = next(case for case in simplices.cases() if case.id == "simplices/flat-3-1")
    field = case.build()
    mesh = METHODS["trilinear-cubes"](field, 0.0)
    slope = case.facts["manifold"].gradients(np.zeros((1, 3)))[0, 0]
    at = (mesh.vertices - field.origin) / field.spacing
    normals = turned(np.tile(slope, (len(at), 1)), at) if turned else None
    outcome = Outcome(Status.OK, mesh.vertices, mesh.simplices, normals=normals)
    claim = next(claim for claim in accuracy.CLAIMS if claim.id == PLANES)
    return claim.judge(Trial(case, field, CUBES, {"plain": outcome}))


def test_normals_of_a_plane_are_judged_on_the_border_too() -> None:
    """Of "accuracy.normals_of_planes": either side up, of any length, single precision will do."""
    assert of_a_plane(lambda n, _: n).verdict is Verdict.PASS
    assert of_a_plane(lambda n, _: -3e-9 * n.astype(np.float32)).verdict is Verdict.PASS
    assert of_a_plane(lambda n, _: n * np.nan).verdict is Verdict.FAIL
    assert of_a_plane(lambda n, _: 0 * n).verdict is Verdict.FAIL
    assert of_a_plane(lambda n, at: np.where(at[:, :1] > 8, n, -n)).verdict is Verdict.FAIL
    assert of_a_plane(None).verdict is Verdict.SKIP
    # Differences along the first axis are halved on its border.
    found = of_a_plane(lambda n, at: np.where(at[:, :1] % 16 == 0, n * (0.5, 1, 1), n))
    assert found.verdict is Verdict.FAIL
    assert found.numbers["wrong"] == found.numbers["on_border"] > 0


@pytest.mark.parametrize("name", [name for name in QUICK if CASES[name].kind == SURFACES])
def test_round_bodies_have_a_slope_at_each_vertex(name: str) -> None:
    """Of "accuracy.normals_returned": that a normal has no length is a fault there.

    By differences of neighbouring samples, the coarsest that anybody takes, it is far from zero.
    """
    made = trial(CASES[name])
    slopes = [np.gradient(made.field.values, axis=axis) for axis in range(3)]
    points = made.mesh.vertices[np.unique(made.mesh.simplices)] / made.field.spacing
    at = np.stack([ndimage.map_coordinates(part, points.T, order=1) for part in slopes], axis=1)
    length = np.linalg.norm(at, axis=1)
    assert length.min() > 0.3 * np.median(length)


def planes(count: int, seed: int = 0) -> Floats:
    """The smallest angles of triangles of planes at random that are cut by a cube, as fans."""
    random, angles = np.random.default_rng(seed), list[float]()
    corners = np.indices((2, 2, 2)).reshape(3, -1).T.astype(float)
    edges = [(a, b) for a in range(8) for b in range(a) if bin(a ^ b).count("1") == 1]
    while len(angles) < count:
        normal = random.normal(size=3)
        normal /= np.linalg.norm(normal)
        v = corners @ normal - random.uniform(-1.8, 1.8)
        crossed = [(a, b) for a, b in edges if (v[a] > 0) != (v[b] > 0)]
        if len(crossed) < 3:
            continue
        cut = [corners[a] + v[a] / (v[a] - v[b]) * (corners[b] - corners[a]) for a, b in crossed]
        spokes = np.array(cut) - np.mean(cut, axis=0)
        across = np.cross(normal, spokes[0])
        order = np.argsort(np.arctan2(spokes @ across, spokes @ spokes[0]))
        polygon = np.roll(np.array(cut)[order], random.integers(len(cut)), axis=0)
        rows = np.array([[0, i, i + 1] for i in range(1, len(cut) - 1)])
        angles += smallest_angles(Complex.of(polygon, rows)).tolist()
    return np.array(angles)


def test_a_fifteenth_of_the_triangles_of_planes_cut_by_cubes_is_thin() -> None:
    """What `accuracy.shapes` allows is what linear crossings cost, to within three deviations."""
    found = planes(3000)
    deviation = np.sqrt(OF_PLANES * (1 - OF_PLANES) / len(found))
    assert abs((found < 5).mean() - OF_PLANES) < 3 * deviation


def quality(method: str, change: Callable[[Mesh], Mesh] = lambda mesh: mesh) -> Finding:
    """What "accuracy.shapes" says of a method's mesh, changed."""
    case = CASES["accuracy/quality"]
    field = case.build()
    mesh = change(METHODS[method](field, 0.0))
    outcome = Outcome(Status.OK, mesh.vertices, mesh.simplices)
    claim = next(claim for claim in accuracy.CLAIMS if claim.id == SHAPES)
    return claim.judge(Trial(case, field, Declaration("here"), {"plain": outcome}))


def with_needles(mesh: Mesh) -> Mesh:
    """Every sixth triangle is cut along its first side, a hundredth from the end."""
    one = mesh.simplices[::6]
    a, b, c = one.T
    new = 0.99 * mesh.vertices[a] + 0.01 * mesh.vertices[b]
    at = len(mesh.vertices) + np.arange(len(one))
    rest = np.delete(mesh.simplices, np.arange(0, len(mesh.simplices), 6), axis=0)
    rows = [rest, np.stack([a, at, c], axis=1), np.stack([at, b, c], axis=1)]
    return Mesh.of(np.concatenate([mesh.vertices, new]), np.concatenate(rows))


@pytest.mark.parametrize("method", ["asymptotic-decider", "surface-nets", "simplicial"])
def test_shapes_of_cubes_nets_and_splits_are_measured_and_pass(method: str) -> None:
    """Nothing that interpolates along edges is worse than planes are."""
    found = quality(method)
    assert found.verdict is Verdict.PASS
    assert 0 <= found.numbers["least_angle"] < found.numbers["median_smallest_angle"] < 60
    assert found.numbers["median_aspect"] > 1.15


def test_needles_are_caught() -> None:
    """Of "accuracy.shapes": a surface in place, its triangles cut into needles."""
    found = quality("asymptotic-decider", with_needles)
    assert found.verdict is Verdict.FAIL
    assert "angle below 5 degrees" in found.detail


def test_a_finding_on_an_order_names_both_ends_of_the_row() -> None:
    """The error at the coarsest spacing and at the finest, each with its spacing."""
    found = accuracy._in_order([0.5, 0.25, 0.125], [0.3, 0.2, 0.1], 3.0, {"more": 7.0})
    assert found.verdict is Verdict.FAIL
    assert "error 0.3 at h = 0.5, 0.1 at h = 0.12" in found.detail
    assert (found.numbers["finest_error"], found.numbers["more"]) == (0.1, 7.0)


def test_as_many_thin_triangles_are_allowed_as_a_binomial_count_may_have() -> None:
    """Of "accuracy.shapes": the mean and three deviations, beside SciPy's."""
    found = quality("asymptotic-decider")
    count = found.numbers["triangles"]
    drawn = stats.binom(count, OF_PLANES)
    assert found.numbers["allowed"] == round((drawn.mean() + 3 * drawn.std()) / count, 4)
