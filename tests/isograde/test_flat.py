"""Flat triangles are given to the cells on either side so that all is right, where it can be.

The extractor of these tests is right, and lies in the faces of cells: where an ambiguous face cuts
a polygon in two when it is decided the other way, the cell decides it so, and puts a quad into the
face, a *collar*, that makes one polygon of the two again.
"""

from collections.abc import Callable
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from isograde.cases import all_cases
from isograde.claims import bilinear, frequencies, symmetry, topology, trilinear
from isograde.claims import cells as of_cells
from isograde.declaration import Declaration, End
from isograde.model import Case, Claim, Finding, Outcome, Status, Trial, Verdict
from isograde.oracles.flat import LIMIT, MOST, Lying, read
from isograde.oracles.lattice import Lattice
from isograde.oracles.sheets import Fault, judge
from isograde.oracles.traces import Traces, traces
from isograde.oracles.trilinear import cells
from isograde.oracles.trilinear_grid import active_cells
from isograde.variants import named, pose
from isoref import trilinear_cubes
from isoref.fast.sweep import sweep
from isoref.field import Array, Field, Floats, Integers
from isoref.mesh import Mesh
from isoref.rule import Rule
from skimage.measure import marching_cubes

from tests.isograde.families import CORRECT, collared

CLAIMS: dict[str, Claim] = {
    claim.id: claim
    for family in (of_cells, bilinear, frequencies, symmetry, topology, trilinear)
    for claim in family.CLAIMS
}
UPPER, LOWER = (1, 3, 5), (0, 2, 4)


# --- extractors that lie in faces ---------------------------------------------------------------


ABOVE, BELOW, BOTH = collared(UPPER), collared(LOWER), collared((*UPPER, *LOWER))
RIGHT = {"above": ABOVE, "below": BELOW, "both": BOTH}


def noise(seed: int, shape: tuple[int, ...] = (6, 7, 5)) -> Floats:
    """Noise without ties, in odd steps of 1/1024."""
    values = np.random.default_rng(seed).normal(size=shape)
    return np.asarray((2 * np.rint(512 * values) + 1) / 1024)


def level(mesh: Mesh) -> Integers:
    """The triangles that lie flat in a face of a cell."""
    spread = np.ptp(mesh.vertices[mesh.simplices], axis=1)
    return np.flatnonzero((spread == 0).any(axis=1))


def drawn(values: Array, mesh: Mesh) -> Traces:
    """The mesh's traces."""
    return traces(Lattice.of(Field.of(values), (0.0,)), mesh.vertices, mesh.simplices)


def faults(values: Array, mesh: Mesh) -> list[Fault]:
    """What is wrong in each cell."""
    index, corners = active_cells(values, 0.0)
    return judge(mesh.vertices, mesh.simplices, index, cells(corners), values.shape)


Extract = Callable[[Field, float], Mesh]


def by(rule: Rule) -> Extract:
    """The sweep of a rule."""
    return lambda field, isovalue: sweep(rule, field, isovalue)


def verdict(claim: str, values: Array, mesh: Mesh) -> Verdict:
    """The verdict of a claim on this mesh."""
    return finding(claim, values, lambda field, isovalue: mesh).verdict


def finding(claim: str, values: Array, extract: Extract) -> Finding:
    """What a claim says of an extractor on these values at 0."""
    field = Field.of(values)
    case = Case("test", lambda: field, (0.0,), field.values.size)
    asked: dict[str, tuple[Field, tuple[float, ...]]] = {"plain": (field, (0.0,))}
    for name in named(CLAIMS[claim].variants, case.kind):
        asked[name] = pose(name, case, field) or asked["plain"]
    meshes = {name: extract(posed, level) for name, (posed, (level,)) in asked.items()}
    outcomes = {name: Outcome(Status.OK, m.vertices, m.simplices) for name, m in meshes.items()}
    return CLAIMS[claim].judge(Trial(case, field, Declaration("test"), outcomes))


# --- right answers pass -------------------------------------------------------------------------


@pytest.mark.parametrize("name", RIGHT)
@pytest.mark.parametrize("seed", range(4))
def test_a_right_mesh_with_flat_triangles_is_right(name: str, seed: int) -> None:
    """Every cell and every face, though the triangles of a face belong to one cell or to both."""
    values = noise(seed)
    mesh = sweep(RIGHT[name], Field.of(values), 0.0)
    assert len(level(mesh)) > 20
    assert set(faults(values, mesh)) == {Fault.NONE}
    found = drawn(values, mesh)
    assert (found.separated | found.joined).all()
    assert not found.readings.torn.any()
    assert not found.undecided.any()
    assert set(found.settled.excess.tolist()) <= {0, 4}


@pytest.mark.parametrize("name", RIGHT)
@pytest.mark.parametrize(
    "claim",
    [
        "cells.legal",
        "cells.frequencies",
        "cells.count",
        "topology.bilinear",
        "topology.trilinear",
        "symmetry.translation",
        "symmetry.shift",
        "symmetry.orientation",
    ],
)
def test_the_claims_pass_it(name: str, claim: str) -> None:
    """On a field with collars on its border as well."""
    values = noise(9, (5, 5, 5))
    assert len(level(sweep(RIGHT[name], Field.of(values), 0.0))) > 10
    told = finding(claim, values, by(RIGHT[name]))
    assert told.verdict is Verdict.PASS, told.detail


def test_two_collars_on_one_face_are_the_fault_of_the_edges() -> None:
    """Each cell is right; the claim that names edges of four triangles fails, and only there."""
    values = noise(2)
    for rule, wanted in ((ABOVE, Verdict.PASS), (BELOW, Verdict.PASS), (BOTH, Verdict.FAIL)):
        mesh = sweep(rule, Field.of(values), 0.0)
        assert verdict("topology.manifold", values, mesh) is wanted
        assert verdict("topology.trilinear", values, mesh) is Verdict.PASS


# --- a second way -------------------------------------------------------------------------------


def pushed(mesh: Mesh, flat: Integers, up: tuple[bool, ...]) -> Mesh:
    """The mesh without flat triangles: each is made a shallow cap in the cell above, or below."""
    corners = mesh.vertices[mesh.simplices[flat]]
    across = np.eye(3)[(np.ptp(corners, axis=1) == 0).argmax(axis=1)]
    apex = corners.mean(axis=1) + np.where(up, 0.01, -0.01)[:, None] * across
    a, b, c = mesh.simplices[flat].T
    top = len(mesh.vertices) + np.arange(len(flat))
    caps = np.concatenate([np.stack([p, q, top], 1) for p, q in ((a, b), (b, c), (c, a))])
    rest = np.delete(mesh.simplices, flat, axis=0)
    return Mesh.of(np.concatenate([mesh.vertices, apex]), np.concatenate([rest, caps]))


def without(mesh: Mesh, triangle: int) -> Mesh:
    """The mesh with a triangle less."""
    return Mesh.of(mesh.vertices, np.delete(mesh.simplices, triangle, axis=0))


def fields_with_few() -> list[tuple[Floats, Mesh]]:
    """Two cells at an ambiguous face with flat triangles in it: right, misplaced, and torn."""
    found = []
    for seed in range(16):
        values = noise(seed, (3, 2, 2))
        values[1] = abs(values[1]) * [[1, -1], [-1, 1]]
        for rule in (collared((1,)), collared((0, 1)), collared((0, 1), careful=False)):
            mesh = sweep(rule, Field.of(values), 0.0)
            flat = level(mesh)
            inner = (mesh.vertices[mesh.simplices[flat]][..., 0] == 1).all(axis=1)
            if 0 < len(flat) <= 4 and inner.all():
                found += [(values, mesh), (values, without(mesh, int(flat[0])))]
    return found


def test_caps_pushed_into_the_cells_in_every_way_say_the_same() -> None:
    """All cells are right exactly when they are under some way to push the triangles off the face.

    Then no triangle is flat, and the judge of cells needs no readings.
    """
    said = []
    for values, mesh in fields_with_few():
        flat = level(mesh)
        ways = product((False, True), repeat=len(flat))
        right = any(set(faults(values, pushed(mesh, flat, up))) == {Fault.NONE} for up in ways)
        assert (set(faults(values, mesh)) == {Fault.NONE}) == right
        said.append(right)
    assert len(said) > 20
    assert 5 < sum(said) < len(said) - 5


def test_what_a_face_can_be_read_as_is_what_pushed_caps_draw() -> None:
    """Separated or joined, exactly as some way to push the triangles off draws it in both cells."""
    compared = 0
    for values, mesh in fields_with_few():
        flat, found = level(mesh), drawn(values, mesh)
        ways = set()
        for up in product((False, True), repeat=len(flat)):
            plain = drawn(values, pushed(mesh, flat, up))
            low, high = (plain.separated[:, 1], plain.joined[:, 1]), (plain.separated, plain.joined)
            ways |= {s for s in (0, 1) if low[s][0] and high[s][1, 0]}
        read_as = {s for s, x in enumerate((found.separated, found.joined)) if x[0, 1]}
        assert read_as == ways
        compared += len(found.readings.lying)
    assert compared > 20


# --- wrong ones are caught ----------------------------------------------------------------------


def twice(mesh: Mesh, triangle: int) -> Mesh:
    """The mesh with a triangle and its opposite more."""
    one = mesh.simplices[[triangle]]
    return Mesh.of(mesh.vertices, np.concatenate([mesh.simplices, one, one[:, ::-1]]))


def moved(mesh: Mesh, triangle: int) -> Mesh:
    """The mesh with a flat triangle copied: an odd one out."""
    return Mesh.of(mesh.vertices, np.concatenate([mesh.simplices, mesh.simplices[[triangle]]]))


@pytest.mark.parametrize("name", RIGHT)
@pytest.mark.parametrize("change", [without, twice, moved])
def test_a_hole_and_a_doubled_triangle_are_caught(
    name: str, change: Callable[[Mesh, int], Mesh]
) -> None:
    """Wherever it is between cells, flat or not, and by a claim of level 2 as well."""
    values = noise(5)
    mesh = sweep(RIGHT[name], Field.of(values), 0.0)
    middle = mesh.vertices[mesh.simplices].mean(axis=1)
    inner = ((middle > 0) & (middle < np.subtract(values.shape, 1))).all(axis=1)
    flat = [t for t in level(mesh) if inner[t]]
    rest = np.setdiff1d(np.flatnonzero(inner), level(mesh))
    tried = [*flat[:6], *rest[:: len(rest) // 6]]
    assert len(tried) > 10
    for triangle in tried:
        wrong = change(mesh, int(triangle))
        assert set(faults(values, wrong)) != {Fault.NONE}
        told = {verdict(claim, values, wrong) for claim in ("cells.legal", "cells.count")}
        assert Verdict.FAIL in told


def test_a_missing_flat_triangle_tears_the_face() -> None:
    """Nobody's trace is legal there, in either cell."""
    values = noise(5)
    mesh = sweep(ABOVE, Field.of(values), 0.0)
    torn = drawn(values, without(mesh, int(level(mesh)[0])))
    assert torn.readings.torn.sum() == 1
    assert (~(torn.separated | torn.joined)).sum() in (1, 2)


def test_a_flipped_decision_is_caught() -> None:
    """Both cells decide a face the other way, alike: legal, but not the interpolant's."""
    rule = collared(UPPER)

    def wrong(g: Floats) -> Integers:
        return np.asarray(trilinear_cubes.decisions(g) ^ 0b111111)

    flipped = Rule("flipped", rule.tile, wrong, rule.asks, 8)
    values = noise(3)
    mesh = sweep(flipped, Field.of(values), 0.0)
    assert len(level(mesh)) > 20
    assert verdict("cells.legal", values, mesh) is Verdict.PASS
    for claim in ("topology.bilinear", "cells.frequencies", "topology.trilinear"):
        assert verdict(claim, values, mesh) is Verdict.FAIL
    found = faults(values, mesh)
    assert found.count(Fault.FACE) > 20


def test_a_collar_where_none_belongs_is_caught() -> None:
    """The face is right, and so is every trace; but the collar joins what is not joined: a ring."""
    values = noise(3)
    mesh = sweep(collared(UPPER, careful=False), Field.of(values), 0.0)
    assert verdict("cells.legal", values, mesh) is Verdict.PASS
    assert verdict("topology.bilinear", values, mesh) is Verdict.PASS
    assert verdict("topology.trilinear", values, mesh) is Verdict.FAIL


# --- what is not decided is said ----------------------------------------------------------------


def lying(count: int, faces: int = 1) -> Lying:
    """A row of cells, and in each face between two of them so many flat triangles."""
    start = count * np.arange(faces + 1)
    bits = np.zeros(count * faces, np.int64)
    below = np.arange(faces)
    axis = np.zeros(faces, np.int64)
    return Lying(np.arange(count * faces), bits, start, axis, below, below + 1)


def test_more_triangles_than_are_tried_are_not_guessed() -> None:
    """Eight are tried in all 256 ways; nine leave the face undecided and its cells unjudged."""
    for count in (MOST, MOST + 1):
        flat = lying(count)
        found = read(flat, np.zeros((2, 6), np.int64), np.zeros((2, 6, 2), np.int64))
        assert found.undecided.tolist() == [count > MOST]
        assert found.unjudged.tolist() == ([0, 1] if count > MOST else [])
        assert len(found.masks[0]) == (1 if count > MOST else 2**MOST)


def test_more_combinations_than_are_tried_are_not_guessed() -> None:
    """Twelve faces of two options are 4,096 combinations; thirteen leave all cells unjudged."""
    for faces in (12, 13):
        flat = lying(1, faces)
        drawn_ = np.zeros((faces + 1, 6), np.int64)
        found = read(flat, drawn_, np.zeros((faces + 1, 6, 2), np.int64))
        assert (2**faces > LIMIT) == (faces == 13)
        assert not found.undecided.any()
        assert len(found.unjudged) == (faces + 1 if faces == 13 else 0)
        cost = np.arange(len(found.trials.row)) % 3
        assert len(found.settle(cost)) == faces


def test_settling_finds_the_least_of_all_sums() -> None:
    """Beside all combinations of random costs, one by one."""
    random = np.random.default_rng(0)
    for faces in (1, 2, 4, 6):
        flat = lying(2, faces)
        found = read(
            flat, np.zeros((faces + 1, 6), np.int64), np.zeros((faces + 1, 6, 2), np.int64)
        )
        assert found.clusters == [list(range(faces))]
        cost = random.integers(0, 100, len(found.trials.row))
        sums = {
            options: int(cost[found.trials.chosen(found, np.array(options))].sum())
            for options in product(range(4), repeat=faces)
        }
        assert sums[tuple(found.settle(cost).tolist())] == min(sums.values())


def test_a_face_with_too_many_makes_no_pass() -> None:
    """Copies of a flat triangle, five of it and five of its opposite: the claims do not pass."""
    values = noise(5)
    mesh = sweep(ABOVE, Field.of(values), 0.0)
    one = mesh.simplices[[level(mesh)[0]]]
    more = Mesh.of(mesh.vertices, np.concatenate([mesh.simplices, *5 * [one], *5 * [one[:, ::-1]]]))
    assert Fault.UNDECIDED in faults(values, more)
    for claim in (
        "cells.legal",
        "cells.frequencies",
        "cells.count",
        "topology.bilinear",
        "topology.trilinear",
    ):
        told = finding(claim, values, lambda field, isovalue: more)
        assert told.verdict is Verdict.SKIP, claim
        assert "flat" in told.detail


def test_without_flat_triangles_there_is_nothing_to_read() -> None:
    """The common case: no faces, no options."""
    values = noise(0)
    found = drawn(values, sweep(trilinear_cubes.RULE, Field.of(values), 0.0))
    assert len(found.readings.lying) == 0
    assert found.settled is found


# --- the border ---------------------------------------------------------------------------------


def on_the_border() -> tuple[Floats, Mesh, Mesh]:
    """One cell with an ambiguous face, right as it is; and the same with a quad in that face."""
    values = np.full((2, 2, 2), -1.0)
    values[1] = [[2, -1], [-1, 2]]
    plain = sweep(trilinear_cubes.RULE, Field.of(values), 0.0)
    nodes = np.flatnonzero(plain.vertices[:, 0] == 1)
    a, b, c, d = nodes[np.lexsort(plain.vertices[nodes, 1:].T)]
    quad = np.array([[a, b, c], [b, c, d]])
    return values, plain, Mesh.of(plain.vertices, np.concatenate([plain.simplices, quad]))


def test_a_quad_in_the_border_belongs_to_the_cell() -> None:
    """Nothing is beyond the border that it could belong to, so a cell that is right is no more."""
    values, plain, more = on_the_border()
    assert faults(values, plain) == [Fault.NONE]
    assert faults(values, more) == [Fault.FACE]
    assert verdict("topology.bilinear", values, plain) is Verdict.PASS
    assert verdict("topology.bilinear", values, more) is Verdict.FAIL


def test_where_the_mesh_goes_on_a_quad_in_the_border_may_belong_there() -> None:
    """As the answer in a larger grid, cut off at the border of the smaller one."""
    values, _, more = on_the_border()
    lattice = Lattice.of(Field.of(values), (0.0,))
    found = traces(lattice, more.vertices, more.simplices, more=True)
    assert found.separated[0, 1]
    assert found.joined[0, 1]


def test_a_cap_in_the_border_is_not_the_cells() -> None:
    """Triangles to an inside sample of the border's face close the volume; the cell is right."""
    values, plain, _ = on_the_border()
    joined = drawn(values, plain).joined[0, 1]
    assert joined
    nodes = np.flatnonzero(plain.vertices[:, 0] == 1)
    near = nodes[(plain.vertices[nodes, 1:].sum(axis=1) < 1)]
    top = len(plain.vertices)
    ends = np.concatenate([plain.vertices, [[1, 0, 0], [1, 1, 1]]])
    far = np.setdiff1d(nodes, near)
    cap = np.array([[*near, top], [*far, top + 1], [*near, far[0]], [near[0], *far]])
    capped = Mesh.of(ends, np.concatenate([plain.simplices, cap]))
    lattice = Lattice.of(Field.of(values), (0.0,), Declaration("", domain=(End(0.0, "closed"),)))
    assert traces(lattice, capped.vertices, capped.simplices).joined[0, 1]
    assert not drawn(values, capped).joined[0, 1]


def of_a_peer(values: Array, isovalue: float) -> Mesh:
    """Scikit-image's lewiner, its normals turned to low."""
    vertices, faces, *_ = marching_cubes(np.asarray(values, np.float64), isovalue)
    return Mesh.of(vertices, faces[:, ::-1])


@pytest.mark.parametrize("case", ["trilinear/pair/10.1.2/0-", "trilinear/pair/10.1.2/0+"])
@pytest.mark.parametrize(
    "claim", ["cells.legal", "cells.count", "cells.frequencies", "topology.bilinear"]
)
def test_a_peer_that_lies_in_faces_is_not_accused_of_them(case: str, claim: str) -> None:
    """Issue 11, false alarm 1: both cells of the pair are right under one way to read the face."""
    values = all_cases(0)[case].build().values
    mesh = of_a_peer(values, 0.0)
    assert verdict(claim, values, mesh) in (Verdict.PASS, Verdict.SKIP)
    assert verdict("topology.bilinear", values, mesh) is Verdict.PASS


@pytest.mark.parametrize("claim", ["topology.bilinear", "cells.frequencies", "topology.trilinear"])
def test_a_right_family_with_flat_triangles_is_not_accused(claim: str) -> None:
    """The same, of the extractor of the tests that puts a collar into upper faces."""
    values = noise(11, (6, 6, 6))
    vertices, faces = CORRECT["trilinear_with_flat_triangles"].function(values, 0.0, (1, 1, 1))
    mesh = Mesh.of(vertices, faces)
    assert len(level(mesh)) > 20
    assert verdict(claim, values, mesh) is Verdict.PASS


def test_where_no_reading_is_right_the_one_with_more_legal_sides_is_kept() -> None:
    """Given to the cell above, its triangle makes both traces legal, though not alike."""
    legal, bits = np.tile([9, 6], (2, 6, 1)), 2
    drawn_ = np.zeros((2, 6), np.int64)
    drawn_[0, 1], drawn_[1, 0] = 9, 6 ^ bits
    found = read(replace(lying(1), bits=np.array([bits])), drawn_, legal)
    assert [mask.tolist() for mask in found.masks] == [[1]]
    assert found.torn.tolist() == [True]
