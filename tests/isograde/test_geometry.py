"""Vertices are where they are said to be, crossings are right, simplices do not cross."""

from importlib import import_module
from typing import Any

import numpy as np
import pytest
from isograde.adapters.forms import arrays_from
from isograde.claims import cells, geometry
from isograde.claims.geometry import _ends, _on_level_sets
from isograde.declaration import Declaration, End, declaration_from
from isograde.model import Case, Finding, Kind, Outcome, Request, Status, Trial, Verdict
from isograde.oracles.lattice import Lattice
from isoref.fast.simplicial import extract as simplicial
from isoref.field import Array, Field, Floats
from isoref.methods import METHODS

from tests.isograde.cheats import CHEATS
from tests.isograde.families import CORRECT, Family
from tests.isograde.judging import Here

CLAIMS = {claim.id: claim for claim in geometry.CLAIMS}
RIGHT = {Verdict.PASS, Verdict.SKIP}


def noise(seed: int = 0, shape: tuple[int, ...] = (6, 7, 8)) -> Floats:
    """White noise."""
    return np.random.default_rng(seed).normal(size=shape)


def whole_numbers(seed: int = 0, shape: tuple[int, ...] = (6, 7, 6)) -> Floats:
    """Whole numbers from -2 to 2: a fifth of the samples are tied at 0."""
    return np.random.default_rng(seed).integers(-2, 3, size=shape).astype(float)


def trial(family: Family, values: Array, isovalue: float = 0.0) -> Trial:
    """A trial of a function with its declaration, as an adapter calls it."""
    declared = declaration_from(family.says, "test")
    types = declared.limits.types
    posed = values.astype("float64" if not types or "float64" in types else types[0])
    if declared.limits.cubes:
        posed = posed[tuple(slice(0, min(posed.shape)) for _ in posed.shape)]
    field = Field.of(posed, (1, 0.5, 2))
    case = Case("test", lambda: field, (isovalue,), posed.size)
    outcome = Here(family.function, declared).run(Request("test", "plain", field, (isovalue,)))
    assert outcome.status is Status.OK, outcome.detail
    return Trial(case, field, declared, {"plain": outcome})


def of(field: Field, vertices: Any, simplices: Any, declared: Declaration, *levels: float) -> Trial:
    """A trial of these arrays."""
    kind = Kind(field.dimension, field.components)
    case = Case("test", lambda: field, levels or (0.0,) * kind.m, 1, kind=kind)
    outcome = Outcome(Status.OK, np.asarray(vertices), np.asarray(simplices))
    return Trial(case, field, declared, {"plain": outcome})


def judged(name: str, one: Trial) -> Finding:
    """What a claim says of it, where it is stated for its family."""
    claim = CLAIMS[f"geometry.{name}"]
    assert claim.families(one.declaration)
    assert claim.kinds(one.kind)
    return claim.judge(one)


STATED = {
    name: [
        claim
        for claim in ("vertices", "crossing", "embedded")
        if CLAIMS[f"geometry.{claim}"].families(declaration_from(family.says, name))
    ]
    for name, family in CORRECT.items()
}


@pytest.mark.parametrize("name", CORRECT)
def test_correct_extractors_of_every_family_pass(name: str) -> None:
    """On noise with evidence; on whole numbers, full of ties, nothing is held against them."""
    for values in (noise(), whole_numbers()):
        one = trial(CORRECT[name], values)
        found = {claim: judged(claim, one) for claim in STATED[name]}
        assert {finding.verdict for finding in found.values()} <= RIGHT, found
        if len(np.unique(values)) > 5:
            assert {finding.verdict for finding in found.values()} == {Verdict.PASS}


CAUGHT = {
    "nets_half_a_cell_off": "vertices",
    "dual_half_a_cell_off": "vertices",
    "scaled_to_the_samples": "vertices",
    "cubes_scaled_to_the_samples": "vertices",
    "always_one_triangle": "vertices",
    "cubes_of_tetrahedra": "vertices",
    "kuhn_in_a_mirror": "vertices",
    "in_the_middle": "crossing",
    "rounded": "crossing",
    "hulls": "embedded",
    "flips_a_coin": "embedded",
}


@pytest.mark.parametrize("name", CAUGHT)
def test_cheats_are_caught(name: str) -> None:
    """Each by the claim that says what is wrong with it."""
    assert judged(CAUGHT[name], trial(CHEATS[name], noise())).verdict is Verdict.FAIL


def test_nothing_is_no_evidence() -> None:
    """An empty mesh passes none of them."""
    empty = of(Field.of(noise()), np.empty((0, 3)), np.empty((0, 3), int), Declaration(""))
    for name in ("vertices", "crossing", "embedded"):
        assert judged(name, empty).verdict is Verdict.SKIP


@pytest.mark.parametrize("word", ["edges", "cells", {"own": 1.0}])
def test_a_vertex_far_from_the_surface_is_told(word: Any) -> None:
    """In the middle of a block of samples on one side, and one beyond the end of the domain."""
    values = np.full((9, 9, 9), -1.0)
    values[1:3, 1:3, 1:3] = 1
    mesh = METHODS["asymptotic-decider"](Field.of(values), 0.0)
    declared = declaration_from({"vertices": word, "level": 1}, "test")
    for astray in ([6.5, 6.5, 6.5], [1.5, 1.5, -2.5]):
        vertices = mesh.vertices.copy()
        vertices[4] = astray
        found = judged("vertices", of(Field.of(values), vertices, mesh.simplices, declared))
        assert found.verdict is Verdict.FAIL
        assert found.numbers["wrong"] == 1
        assert found.numbers["first"] == astray


def test_a_lattice_of_its_own_is_held_to_its_reach() -> None:
    """A vertex a cell and a half from the last active cell: within a reach of 2, not of 1."""
    values = np.full((9, 9, 9), -1.0)
    values[1:3, 1:3, 1:3] = 1
    mesh = METHODS["asymptotic-decider"](Field.of(values), 0.0)
    vertices = mesh.vertices.copy()
    vertices[4] = [4.5, 1.5, 1.5]
    for reach, wanted in ((1.0, Verdict.FAIL), (2.0, Verdict.PASS)):
        declared = declaration_from({"vertices": {"own": reach}}, "test")
        one = of(Field.of(values), vertices, mesh.simplices, declared)
        assert judged("vertices", one).verdict is wanted


def test_a_cap_of_a_lattice_of_its_own_comes_as_far_inwards_as_its_reach() -> None:
    """Labels smoothed by pyvista, all of them inside: the shell, half a cell outside, shrinks."""
    said = {"vertices": {"own": 1.0}, "domain": {"inset": -0.5, "end": "closed"}}
    declared = declaration_from({**said, "interpolant": "labels"}, "smooth")
    field = Field.of(np.ones((5, 5, 5)))
    shell = np.array([[2, 2, 0], [2, 0, 2], [0, 2, 2], [2, 2, 4], [2, 4, 2], [4, 2, 2]], float)
    faces = [[a, b, c] for a in (0, 3) for b in (1, 4) for c in (2, 5)]
    for inwards, verdict in [(-0.5, "PASS"), (0.45, "PASS"), (0.6, "FAIL"), (-1.6, "FAIL")]:
        moved = shell + inwards * np.sign(2 - shell) * (shell != 2)
        found = judged("vertices", of(field, moved, faces, declared))
        assert found.verdict is Verdict[verdict], (inwards, found.detail)
    outside = of(Field.of(-np.ones((5, 5, 5))), shell, faces, declared)
    assert judged("vertices", outside).verdict is Verdict.FAIL


def test_only_tied_samples_excuse_and_only_there() -> None:
    """A vertex in the middle of a face is out of place; a tie excuses it beside it, not far off."""
    values = noise(3, (7, 7, 7))
    mesh = METHODS["asymptotic-decider"](Field.of(values), 0.0)
    vertices = mesh.vertices.copy()
    vertices[0] = [1.0, 1.5, 1.5]
    for at, wanted in (((5, 5, 5), Verdict.FAIL), ((1, 1, 1), Verdict.PASS)):
        tied = values.copy()
        tied[at] = 0.0
        plain = METHODS["asymptotic-decider"](Field.of(tied), 0.0)
        both = np.concatenate([plain.vertices, vertices[:1]])
        rows = np.concatenate([plain.simplices, [[0, 1, len(plain.vertices)]]])
        one = of(Field.of(tied), both, rows, Declaration(""))
        assert judged("vertices", one).verdict is wanted


def test_labels_cross_halfway_and_no_sample_of_theirs_is_tied() -> None:
    """The linear crossing is wrong for who says that only inside and outside are seen."""
    says = {"interpolant": "labels"}
    values = whole_numbers() + 0.0
    halfway = trial(CORRECT["label_cubes"], values)
    linear = trial(Family(CORRECT["cubes"].function, says), values)
    assert judged("crossing", halfway).verdict is Verdict.PASS
    assert judged("crossing", linear).verdict is Verdict.FAIL


SHAPES = {2: (7, 8), 3: (5, 4, 5), 4: (3, 3, 3, 4)}


@pytest.mark.parametrize("kind", [Kind(2, 1), Kind(3, 1), Kind(3, 2), Kind(4, 1), Kind(4, 2)])
def test_simplices_of_every_kind(kind: Kind) -> None:
    """Min's simplices stand on faces of dimension m of Kuhn's split; moved, they do not."""
    values = np.random.default_rng(kind).normal(size=(kind.m, *SHAPES[kind.n]))
    mesh = simplicial(Field.of(values, dimension=kind.n))
    field = Field.of(values if kind.m > 1 else values[0], dimension=kind.n)
    split = Declaration("", interpolant="tetrahedra")
    right = of(field, mesh.vertices, mesh.simplices, split)
    assert judged("vertices", right).verdict is Verdict.PASS
    if kind.m == 1:
        assert judged("crossing", right).verdict is Verdict.PASS
    shift = 0.3 * np.eye(kind.n)[0]
    wrong = of(field, mesh.vertices + shift, mesh.simplices, split)
    assert judged("vertices", wrong).verdict is Verdict.FAIL


def test_where_three_sets_meet_beside_a_face_of_two_dimensions() -> None:
    """A point on a face of three dimensions, nearer than the rounding to one of two: right there.

    Found as simplices/flat-5-3, where no function changed sides on the smaller face. Moved along
    it by half a cell the same vertex is wrong.
    """
    corners = np.array(list(np.ndindex(2, 2, 2, 2)), float)
    meeting = np.array([0.4, 0.125, 0.125 - 1e-5, 0.0])
    slopes = np.random.default_rng(5).normal(size=(3, 4))
    values = slopes @ (corners - meeting).T
    field = Field.of(values.reshape(3, 2, 2, 2, 2), dimension=4)
    mesh = simplicial(field)
    assert len(mesh.simplices)
    split = Declaration("", interpolant="tetrahedra")
    right = of(field, mesh.vertices, mesh.simplices, split)
    assert judged("vertices", right).verdict is Verdict.PASS
    wrong = mesh.vertices.copy()
    near = np.linalg.norm(wrong - meeting, axis=1).argmin()
    assert np.linalg.norm(wrong[near] - meeting) < 1e-4
    wrong[near] = [0.9, 0.05, 0.05, 0.0]
    moved = of(field, wrong, mesh.simplices, split)
    assert judged("vertices", moved).verdict is Verdict.FAIL


def test_contours_that_cross_are_told() -> None:
    """A vertex moved across its neighbour; the right ones do not cross."""
    values = noise(1, (9, 9))
    mesh = simplicial(Field.of(values))
    split = Declaration("", interpolant="tetrahedra")
    right = of(Field.of(values), mesh.vertices, mesh.simplices, split)
    assert judged("embedded", right).verdict is Verdict.PASS
    vertices = mesh.vertices.copy()
    inner = np.bincount(mesh.simplices.reshape(-1)) == 2
    vertices[np.flatnonzero(inner)[0]] += [2.1, 2.3]
    found = judged("embedded", of(Field.of(values), vertices, mesh.simplices, split))
    assert found.verdict is Verdict.FAIL


def test_a_soup_whose_corners_differ_by_rounding_is_not_said_to_cross() -> None:
    """Interpolated from either end, and declared with too small a tolerance: still no crossing."""
    family = CORRECT["cubes_in_soup_from_either_end"]
    strict = Family(family.function, {**family.says, "mesh": {"soup": 1e-9}})
    assert judged("embedded", trial(strict, noise())).verdict is Verdict.PASS
    crossing = trial(strict, noise())
    outcome = crossing.plain
    assert outcome.vertices is not None
    pushed = outcome.vertices.copy()
    pushed[3] += [0.9, 0.9, 0.9]
    wrong = Trial(
        crossing.case,
        crossing.field,
        crossing.declaration,
        {"plain": Outcome(Status.OK, pushed, outcome.simplices)},
    )
    assert judged("embedded", wrong).verdict is Verdict.FAIL


def test_a_vertex_may_stand_in_a_face_whose_saddle_is_on_the_surface() -> None:
    """Whole numbers: an inner vertex of the decider comes to stand there; elsewhere it may not."""
    tied = Field.of(np.array([[[2.0, -1], [-2, 1]], [[1, -2], [-2, 2]]]))
    free = Field.of(np.array([[[2.0, -1], [-2, 1.5]], [[1, -2], [-2, 2]]]))
    at = [[0, 0.5, 2 / 3], [0, 0, 2 / 3], [0, 0.5, 0]]
    for field, wanted in ((tied, Verdict.PASS), (free, Verdict.FAIL)):
        assert judged("vertices", of(field, at, [[0, 1, 2]], Declaration(""))).verdict is wanted


@pytest.mark.parametrize("method", ["marching_faces", "surface_intersection"])
def test_curves_in_which_isosurfaces_meet(method: str) -> None:
    """Their vertices are on faces, or in cells, where both components have both sides."""
    module = import_module(f"isoref.fast.{method}")
    one, other = (Field.of(noise(seed, (5, 6, 5))) for seed in (1, 2))
    lines = [curve.polyline for curve in module.intersection_curves(one, other, (0.0, 0.0))]
    vertices, segments = arrays_from(lines, Kind(3, 2))
    field = Field.of(np.stack([one.values, other.values]), dimension=3)
    right = of(field, vertices, segments, Declaration(""))
    assert judged("vertices", right).verdict is Verdict.PASS
    wrong = of(field, np.asarray(vertices) + 0.7, segments, Declaration(""))
    assert judged("vertices", wrong).verdict is Verdict.FAIL


def test_an_inner_vertex_close_to_a_face_stands_in_it_beside_a_saddle_that_is_close() -> None:
    """Found by ``make correct``: 1 of 13,025 vertices, 5e-6 of a cell from the face with a saddle.

    The tolerance follows single precision, and so the extent of the lattice.
    """
    values = np.full((40, 3, 2), -1.0)
    values[0, 1:] = [[-0.103512763977, 0.103434562683], [-0.136645317078, 0.928647041321]]
    values[1, 1:] = [[0.133810997009, -0.133717536926], [0.835034370422, -0.453156471252]]
    field = Field.of(values)
    mesh = METHODS["asymptotic-decider"](field, 0.0)
    away = np.abs(mesh.vertices[:, 1] - 1)
    assert ((away > 0) & (away < 1e-5)).any()
    one = of(field, mesh.vertices, mesh.simplices, Declaration(""))
    assert judged("vertices", one).verdict is Verdict.PASS
    count = next(claim for claim in cells.CLAIMS if claim.id == "cells.count")
    assert count.judge(one).verdict is Verdict.PASS


@pytest.mark.parametrize("near", [0.5, 1e-8])
def test_a_caps_vertex_that_is_rounded_into_the_plane_of_a_sample_is_none_out_of_place(
    near: float,
) -> None:
    """OpenVDB 10.0.1 was accused of one (magnitudes/mixed-30): 1e-8 beyond the corner's sample.

    Nets of the field padded with the background; the last sample is hardly above the isovalue.
    """
    values = np.array([-1, 1, 1, 1, 1, 1, 1, -1, 1, 1, 1, near]).reshape(2, 3, 2)
    padded = np.pad(values, 1, constant_values=-1.0)
    nets = CORRECT["nets"].function(padded, 0.0, (1, 1, 1))
    points, simplices = nets[0] - 1.0, nets[1]
    says = {"vertices": "cells", "domain": {"inset": -1.0, "end": "closed"}}
    declared = declaration_from(says, "padded")
    rounded = points.astype(np.float32).astype(np.float64)
    assert (near == 1e-8) == (rounded == (1, 2, 1)).all(axis=1).any()
    finding = judged("vertices", of(Field.of(values), rounded, simplices, declared))
    assert finding.verdict is Verdict.PASS, finding.detail
    # A vertex in the plane of a sample that is outside has no such excuse.
    moved = rounded.copy()
    moved[0] = (0, 0, -0.7)
    assert (
        judged("vertices", of(Field.of(values), moved, simplices, declared)).verdict is Verdict.FAIL
    )


@pytest.mark.parametrize(
    ("end", "at_end", "capped"),
    [
        (End(), [], []),
        (End(1.0), [], []),
        (End(0.5), [0.5, 4.5], []),
        (End(-0.5), [-0.7, -0.5, -0.1, 5.1, 5.5, 5.7], []),
        (End(0.0, "closed"), [], [-0.7, -0.5, -0.1, 0.0, 5.0, 5.1, 5.5, 5.7]),
        (End(0.5, "closed"), [], [-0.7, -0.5, -0.1, 0.5, 4.5, 5.1, 5.5, 5.7]),
        (End(-0.5, "closed"), [], [-0.7, -0.5, -0.1, 0.0, 5.0, 5.1, 5.5, 5.7]),
        (End(0.0, "periodic"), [], []),
        (End(-0.5, "periodic"), [-0.7, -0.5, -0.1, 6.5], []),
    ],
    ids=str,
)
def test_places_at_an_end_are_those_that_a_cut_or_a_cap_explains(
    end: End, at_end: list[float], capped: list[float]
) -> None:
    """In its plane or, where the surface goes on there, beyond the samples; closed, it is a cap."""
    lattice = Lattice.of(Field.of(np.zeros((6, 6))), (0.5,), Declaration("", domain=(end, End())))
    along = np.array([-0.7, -0.5, -0.1, 0.0, 0.3, 0.5, 1.0, 4.0, 4.5, 4.7, 5.0, 5.1, 5.5, 5.7, 6.5])
    along = along[along < (9 if end.end == "periodic" else 6)]
    places = np.stack([along, np.full(len(along), 2.5)], axis=1)
    found = _ends(lattice, places)
    assert [along[one].tolist() for one in found] == [at_end, capped]


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_a_place_is_on_a_level_set_up_to_its_share_of_the_range(size: float) -> None:
    """Of a linear function of any size: a little less than what `locate` rounds off, or more."""
    field = Field.of(size * (np.indices((2, 2, 2)).sum(axis=0) - 1.25))
    lattice = Lattice.of(field, (0.0,), Declaration("", interpolant="tetrahedra"))
    corners = np.array([[[0, 0, 0], [0, 0, 1], [0, 1, 1], [1, 1, 1]]])
    slack = 12 * lattice.tolerance
    for off, right in (
        (0.0, True),
        (0.9 * slack, True),
        (-0.9 * slack, True),
        (1.1 * slack, False),
    ):
        share = 1.25 / 3 + off
        weights = np.array([[1 - share, 0, 0, share]])
        assert _on_level_sets(lattice, corners, weights).tolist() == [right]
