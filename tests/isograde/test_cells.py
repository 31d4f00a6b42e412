"""Cells are legal for their family, have the parts they take, and what they choose is told."""

from collections.abc import Callable
from itertools import product
from typing import Any

import numpy as np
import pytest
from isograde.claims import CLAIMS
from isograde.declaration import Declaration, declaration_from
from isograde.model import Finding, Outcome, Request, Status, Trial, Verdict
from isoref.fast.diconex import diconex
from isoref.fast.simplicial import extract as simplicial
from isoref.field import Array, Field, Floats, Integers
from isoref.methods import METHODS

from tests.isograde.cheats import CHEATS
from tests.isograde.families import CORRECT, Family
from tests.isograde.judging import Here
from tests.isograde.test_geometry import noise, of, trial, whole_numbers

SPLIT = Declaration("", interpolant="tetrahedra")
PLAIN = Declaration("")


def judged(name: str, one: Trial) -> Finding:
    """What a claim says of it, where it is stated for its family."""
    claim = CLAIMS[name]
    assert claim.families(one.declaration)
    assert claim.kinds(one.kind)
    return claim.judge(one)


def stated(family: Family, *names: str) -> list[str]:
    """Those of the claims that are stated for the family."""
    declared = declaration_from(family.says, "test")
    return [name for name in names if CLAIMS[name].families(declared)]


# --- legal and counted --------------------------------------------------------------------------


@pytest.mark.parametrize("name", CORRECT)
def test_correct_extractors_of_every_family_pass(name: str) -> None:
    """On noise with evidence; on whole numbers, full of ties, nothing is held against them."""
    family = CORRECT[name]
    names = stated(family, "cells.legal", "cells.count")
    assert bool(names) == ("own" not in str(family.says.get("vertices")))
    for values, wanted in ((noise(), {Verdict.PASS}), (whole_numbers(), {*Verdict} - {"fail"})):
        found = [judged(claim, trial(family, values)) for claim in names]
        assert {finding.verdict for finding in found} <= wanted, found


CAUGHT = {
    "always_empty": "cells.legal",
    "nets_half_a_cell_off": "cells.legal",
    "dual_half_a_cell_off": "cells.legal",
    "blurred": "cells.legal",
    "last_layer_missing": "cells.legal",
    "largest_piece_only": "cells.legal",
    "cubes_of_tetrahedra": "cells.legal",
    "kuhn_in_a_mirror": "cells.legal",
    "hulls": "cells.legal",
}


@pytest.mark.parametrize("name", CAUGHT)
def test_cheats_are_caught(name: str) -> None:
    """Each by the claim that says what is wrong with it."""
    assert judged(CAUGHT[name], trial(CHEATS[name], noise())).verdict is Verdict.FAIL


Change = Callable[[Floats, Integers], tuple[Any, Any]]


def doubled(vertices: Floats, rows: Integers) -> tuple[Any, Any]:
    """One simplex and its opposite more."""
    return vertices, np.concatenate([rows, rows[5:6], rows[5:6, ::-1]])


def less(vertices: Floats, rows: Integers) -> tuple[Any, Any]:
    """One simplex less."""
    return vertices, np.delete(rows, 5, axis=0)


def long(vertices: Floats, rows: Integers) -> tuple[Any, Any]:
    """A vertex far from where its neighbours are."""
    changed = rows.copy()
    changed[5, 0] = rows[-5, 0]
    return vertices, changed


SHAPES = {2: (8, 9), 3: (5, 5, 4), 4: (3, 3, 3, 3)}


@pytest.mark.parametrize("n", [2, 3, 4])
@pytest.mark.parametrize(
    ("change", "claim"), [(less, "cells.legal"), (long, "cells.legal"), (doubled, "cells.count")]
)
def test_sections_of_a_split_in_every_dimension(n: int, change: Change, claim: str) -> None:
    """Min's simplices are right in 2, 3 and 4 dimensions; a lost, long or doubled one is not."""
    values = np.random.default_rng(n).normal(size=SHAPES[n])
    field = Field.of(values)
    mesh = simplicial(field)
    right = of(field, mesh.vertices, mesh.simplices, SPLIT)
    assert judged("cells.legal", right).verdict is Verdict.PASS
    assert judged("cells.count", right).verdict is Verdict.PASS
    wrong = of(field, *change(mesh.vertices, mesh.simplices), SPLIT)
    assert judged(claim, wrong).verdict is Verdict.FAIL


@pytest.mark.parametrize("change", [less, long])
@pytest.mark.parametrize("name", ["cubes", "label_cubes", "tetrahedra_of_five", "dual_cubes"])
def test_a_lost_or_long_triangle_makes_a_cell_illegal(name: str, change: Change) -> None:
    """Lost ones are told by every family but the dual, whose polygons are not counted."""
    right = trial(CORRECT[name], noise(2))
    assert right.plain.vertices is not None
    assert right.plain.simplices is not None
    changed = Outcome(Status.OK, *change(right.plain.vertices, right.plain.simplices))
    wrong = Trial(right.case, right.field, right.declaration, {"plain": changed})
    wanted = Verdict.PASS if name == "dual_cubes" and change is less else Verdict.FAIL
    assert judged("cells.legal", wrong).verdict is wanted


def contours(values: Floats, mode: str = "mixed") -> Trial:
    """Contours of the reference's walk along pixel edges, as an adapter calls it."""
    field = Field.of(values, (1, 0.5))
    request = Request("test", "plain", field, (0.0,))

    def extract(samples: Array, isovalue: float, spacing: tuple[float, ...]) -> Any:
        return diconex(Field.of(samples, spacing), isovalue, mode=mode).polygons()  # type: ignore[arg-type]

    outcome = Here(extract, PLAIN).run(request)
    return of(field, outcome.vertices, outcome.simplices, PLAIN)


@pytest.mark.parametrize("mode", ["disconnect", "connect", "mixed"])
def test_contours_are_legal_in_every_square(mode: str) -> None:
    """All modes are; with a segment less, or moved, they are not."""
    right = contours(noise(3, (9, 8)), mode)
    assert judged("cells.legal", right).verdict is Verdict.PASS
    assert judged("cells.count", right).verdict is Verdict.PASS
    for change in (less, long, doubled):
        wrong = of(right.field, *change(right.mesh.vertices, right.mesh.simplices), PLAIN)
        assert judged("cells.legal", wrong).verdict is Verdict.FAIL
        assert judged("cells.count", wrong).verdict is Verdict.FAIL


def test_an_empty_answer_is_wrong_where_cells_are_crossed_and_no_evidence_elsewhere() -> None:
    """Nothing passes on a field without a surface."""
    nothing = np.empty((0, 3)), np.empty((0, 3), np.int64)
    crossed, flat = Field.of(noise()), Field.of(np.ones((4, 4, 4)))
    for declared in (PLAIN, SPLIT):
        assert judged("cells.legal", of(crossed, *nothing, declared)).verdict is Verdict.FAIL
        assert judged("cells.legal", of(flat, *nothing, declared)).verdict is Verdict.SKIP
        assert judged("cells.count", of(flat, *nothing, declared)).verdict is Verdict.SKIP


def test_cells_outside_the_domain_are_not_judged() -> None:
    """Who leaves the outermost layer of cells out is wrong unless it says so."""
    family = CORRECT["cropped"]
    undeclared = Family(family.function, {"name": "cropped"})
    assert judged("cells.legal", trial(family, noise())).verdict is Verdict.PASS
    assert judged("cells.legal", trial(undeclared, noise())).verdict is Verdict.FAIL


def test_a_periodic_mesh_is_judged_in_the_last_cells_too() -> None:
    """From the last sample to the first: with a hole there, and nowhere else, it fails."""
    right = trial(CORRECT["periodic"], noise())
    points, rows = right.mesh.vertices, right.mesh.simplices
    beyond = (points[rows][..., 0] > right.field.shape[0] - 1).all(axis=1)
    assert beyond.sum() > 10
    kept = np.delete(rows, np.flatnonzero(beyond)[3], axis=0)
    wrong = of(right.field, points, kept, right.declaration)
    assert judged("cells.legal", right).verdict is Verdict.PASS
    assert judged("cells.legal", wrong).verdict is Verdict.FAIL


def test_a_flat_cap_is_not_the_cells() -> None:
    """Closed in the planes of the border: the caps there are no part of the cells."""
    capped = trial(CORRECT["capped"], noise(5))
    for name in ("cells.legal", "cells.count", "topology.bilinear"):
        assert judged(name, capped).verdict is Verdict.PASS


# --- choices ------------------------------------------------------------------------------------

CHOICES = {"cells.separate": "disconnect", "cells.join": "connect", "cells.mean": "mixed"}


@pytest.mark.parametrize("claim", CHOICES)
@pytest.mark.parametrize("mode", CHOICES.values())
def test_each_mode_of_vesta_has_its_choice_and_no_other(claim: str, mode: str) -> None:
    """Schlei 2010, section II.C, in space and in the plane; how many faces is told."""
    field = Field.of(noise())
    mesh = METHODS[f"marching-vesta-{mode}-L"](field, 0.0)
    for one in (of(field, mesh.vertices, mesh.simplices, PLAIN), contours(noise(6, (9, 9)), mode)):
        found = judged(claim, one)
        assert (found.verdict is Verdict.PASS) == (CHOICES[claim] == mode)
        assert 5 < found.numbers["faces"] >= found.numbers["held"]
        assert (found.numbers["faces"] == found.numbers["held"]) == (CHOICES[claim] == mode)


def test_a_choice_is_promised_by_who_names_it() -> None:
    """Beside the ladder; nobody else is held to it."""
    for name in CHOICES:
        assert CLAIMS[name].level is None
        assert not CLAIMS[name].held(PLAIN)
        assert CLAIMS[name].held(Declaration("", promised=frozenset({name})))


def test_without_an_ambiguous_face_there_is_no_choice() -> None:
    """A single inside sample."""
    values = np.full((4, 4, 4), -1.0)
    values[1, 2, 1] = 1.0
    for name in CHOICES:
        assert judged(name, trial(CORRECT["cubes"], values)).verdict is Verdict.SKIP


def test_labels_are_not_judged_by_values_they_never_saw() -> None:
    """Neither are dual methods, splits, and lattices of their own."""
    by_values = ("topology.bilinear", "cells.frequencies", "topology.trilinear", "cells.mean")
    for name in ("label_cubes", "dual_cubes", "tetrahedra_of_kuhn", "resampled_finer"):
        assert stated(CORRECT[name], *by_values) == []
    assert stated(CORRECT["cubes"], *by_values) == list(by_values)


def test_contours_follow_the_bilinear_interpolant_or_not() -> None:
    """Level 3 in the plane: the saddle of one square decides; the other way is told."""
    inside, outside = [[2.0, -1], [-1, 2]], [[1.0, -2], [-2, 1]]
    for values, right, wrong in (
        (inside, "connect", "disconnect"),
        (outside, "disconnect", "connect"),
    ):
        samples = np.pad(np.array(values), 1, constant_values=-3.0)
        assert judged("topology.bilinear", contours(samples, right)).verdict is Verdict.PASS
        found = judged("topology.bilinear", contours(samples, wrong))
        assert found.verdict is Verdict.FAIL
        assert (found.numbers["cells"], found.numbers["wrong"]) == (1, 1)


def test_a_split_keeps_its_phase_where_the_outermost_cells_are_left_out() -> None:
    """The alternating five, cut off one cell inside: the domain begins in the middle of a block."""
    family = CORRECT["tetrahedra_of_five"]
    values = noise(7, (7, 8, 7))
    vertices, faces = family.function(values, 0.0, (1, 1, 1))
    inner = ((vertices >= 1) & (vertices <= np.subtract(values.shape, 2))).all(axis=1)
    says = {**family.says, "domain": {"inset": 1, "end": "open"}}
    declared = declaration_from(says, "inner five")
    one = of(Field.of(values), vertices, faces[inner[faces].all(axis=1)], declared)
    for name in ("geometry.vertices", "geometry.crossing", "cells.legal", "cells.count"):
        assert judged(name, one).verdict is Verdict.PASS, name


def test_the_faces_and_the_cells_that_the_saddle_decides_otherwise_are_counted() -> None:
    """Of noise with the inside corners joined: where they are apart, by B(S, T) face by face."""
    values = noise()
    faces = []
    for i, j, k in np.ndindex(*np.subtract(values.shape, 1)):
        for axis, side in product(range(3), range(2)):
            (a, b), (c, d) = np.take(values[i : i + 2, j : j + 2, k : k + 2], side, axis)
            if (a > 0) == (d > 0) != (b > 0) == (c > 0) and (a * d < b * c) == (a + d > b + c):
                faces.append((i, j, k))
    mesh = METHODS["marching-vesta-connect-L"](Field.of(values), 0.0)
    found = judged("topology.bilinear", of(Field.of(values), mesh.vertices, mesh.simplices, PLAIN))
    assert found.numbers["wrong_faces"] == len(faces)
    assert found.numbers["wrong"] == len(set(faces)) < len(faces)


def test_a_triangle_drawn_twice_more_is_two_more_than_the_cell_takes() -> None:
    """The finding has what was found, and what is wanted."""
    right = trial(CORRECT["cubes"], noise())
    wrong = of(right.field, *doubled(right.mesh.vertices, right.mesh.simplices), PLAIN)
    found = judged("cells.count", wrong)
    assert found.verdict is Verdict.FAIL
    assert found.numbers["found"] == found.numbers["wanted"] + 2
    assert f"has {found.numbers['found']} triangles" in found.detail
    assert found.detail.endswith(f"take {found.numbers['wanted']}")


def test_of_several_parts_that_span_cells_the_first_is_named() -> None:
    """By its vertices, in index coordinates."""
    right = contours(noise(3, (9, 8)))
    rows = right.mesh.simplices.copy()
    rows[[5, 15, 25], 0] = rows[[-5, -15, -25], 0]
    found = judged("cells.legal", of(right.field, right.mesh.vertices, rows, PLAIN))
    assert found.numbers["spanning"] == 3
    first = right.mesh.vertices[rows[5]] / right.field.spacing
    assert found.numbers["first"] == pytest.approx(first, abs=1e-4)


def test_where_inner_vertices_leave_the_number_of_parts_open_it_is_not_judged() -> None:
    """In four dimensions: one part cut at its middle is still a section, of four parts more."""
    field = Field.of(np.random.default_rng(4).normal(size=SHAPES[4]))
    mesh = simplicial(field)
    row, top = mesh.simplices[7], len(mesh.vertices)
    cut = np.array([[*np.delete(row, i), top] for i in range(4)])
    points = np.concatenate([mesh.vertices, mesh.vertices[row].mean(axis=0)[None]])
    rows = np.concatenate([np.delete(mesh.simplices, 7, axis=0), cut])
    found = judged("cells.count", of(field, points, rows, SPLIT))
    plain = judged("cells.count", of(field, mesh.vertices, mesh.simplices, SPLIT))
    assert found.verdict is plain.verdict is Verdict.PASS
    assert found.numbers["cells"] == plain.numbers["cells"] - 1
