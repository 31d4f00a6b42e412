"""The claim of level 4: right answers pass, each fault is told, what is a tie is not judged."""

from collections import Counter
from collections.abc import Callable, Sequence

import numpy as np
import pytest
from isograde.claims import topology
from isograde.claims import trilinear as family
from isograde.declaration import Declaration, declaration_from
from isograde.model import Case, Claim, Finding, Outcome, Status, Trial, Verdict
from isograde.oracles.trilinear import CLOSE, cells
from isograde.oracles.trilinear_cases import case_names
from isograde.oracles.trilinear_grid import active_cells
from isoref import asymptotic_decider, lorensen_cline, trilinear_cubes
from isoref.fast.sweep import sweep
from isoref.field import Array, Field, Floats
from isoref.mesh import Mesh
from isoref.rule import Rule

from tests.isograde.families import CORRECT
from tests.isograde.miniatures import Place, asymptotic, careful_fan, made

CLAIM, SCAN = family.CLAIMS
Extract = Callable[[Field], Mesh]


def by(rule: Rule) -> Extract:
    """The sweep of a rule at 0."""
    return lambda field: sweep(rule, field, 0.0)


right = by(trilinear_cubes.RULE)


def judged(extract: Extract, values: Array, claim: Claim = CLAIM) -> Finding:
    """What the claim says of an extractor on these values at 0."""
    field = Field.of(values, (1, 0.5, 2), (3, -1, 0))
    mesh = extract(field)
    case = Case("test", lambda: field, (0.0,), field.values.size)
    outcome = Outcome(Status.OK, mesh.vertices, mesh.simplices)
    return claim.judge(Trial(case, field, Declaration("test"), {"plain": outcome}))


def noise(n: int = 12) -> Floats:
    """Noise without ties, in odd steps of 1/1024."""
    values = np.random.default_rng(8).normal(size=(n, n, n))
    return np.asarray((2 * np.rint(512 * values) + 1) / 1024)


def names_of(values: Floats) -> dict[tuple[int, ...], str]:
    """The case of each cell of the surface, by its lowest corner."""
    index, corners = active_cells(values, 0.0)
    places = map(tuple, index.tolist())
    return dict(zip(places, map(str, case_names(cells(corners))), strict=True))


def without_one(field: Field) -> Mesh:
    """The right answer without its first triangle."""
    mesh = right(field)
    return Mesh(mesh.vertices, mesh.simplices[1:])


# Implementations that the claim catches, and the faults that are theirs.
BROKEN: dict[str, tuple[Extract, set[str]]] = {
    "no tunnels": (by(asymptotic_decider.RULE), {"missing tunnel"}),
    "fixed polarity": (by(lorensen_cline.RULE), {"missing tunnel", "wrong face"}),
    "a hole": (without_one, {"hole"}),
}


def test_the_right_answer_passes_and_every_cell_is_counted() -> None:
    """By the cases' names, as many as the surface has cells."""
    finding = judged(right, noise())
    assert finding.verdict is Verdict.PASS
    names = names_of(noise())
    assert finding.numbers == {
        "cells": len(names),
        "wrong": 0,
        "cases": dict(Counter(names.values())),
    }


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_one_is_caught_and_its_faults_are_told(name: str) -> None:
    """Case by case; the first is a cell of a case that is named."""
    extract, kinds = BROKEN[name]
    finding = judged(extract, noise())
    assert finding.verdict is Verdict.FAIL
    told = finding.numbers["faults"]
    assert {fault for _, fault, _ in told} == kinds
    assert sum(count for *_, count in told) == finding.numbers["wrong"] < finding.numbers["cells"]
    names = names_of(noise())
    assert names[tuple(finding.numbers["cell"])] in {case for case, *_ in told}
    assert all(count <= Counter(names.values())[case] for case, _, count in told)


def test_without_tunnels_the_cells_with_a_tunnel_are_wrong() -> None:
    """All of them, and no others: every face is right."""
    finding = judged(by(asymptotic_decider.RULE), noise())
    tunnels = {"4.2", "6.1.2", "7.4.2", "10.1.2", "12.1.2", "13.5.2"}
    have = Counter(name for name in names_of(noise()).values() if name in tunnels)
    assert {case: count for case, _, count in finding.numbers["faults"]} == have


def test_a_cell_with_a_tied_corner_is_not_judged() -> None:
    """Zero, or so near that a vertex is not told from the sample; the others are judged."""
    for value in (0.0, 1e-9, -1e-9):
        values = noise(6)
        values[2, 3, 1] = value
        beside = {(i, j, k) for i in (1, 2) for j in (2, 3) for k in (0, 1)}
        finding = judged(right, values)
        assert finding.verdict is Verdict.PASS
        assert finding.numbers["cells"] == len(names_of(values).keys() - beside)


def test_where_every_cell_is_a_tie_nothing_is_judged() -> None:
    """There is no single truth; nor are there cells in a layer of samples."""
    tied = np.zeros((2, 2, 2))
    tied[0] = -1
    assert judged(right, tied).verdict is Verdict.SKIP
    assert "every cell" in judged(right, tied).detail
    flat = judged(lambda _: Mesh.empty(3, 2), noise()[:1])
    assert flat.verdict is Verdict.SKIP
    assert "no cells" in flat.detail


def along_the_face(polygon: Sequence[Place]) -> list[Sequence[Place | None]]:
    """Four triangles of a hexagon, one edge of theirs in the face that holds four of its nodes.

    The corners turn about the cell as a, b, x, c, d, y, where x and y are off the face.
    """
    if len(polygon) != 6:
        return careful_fan(polygon)
    start = next(s for s in range(6) if all(polygon[(s + i) % 6][0] == 1 for i in (2, 5)))
    a, b, x, c, d, y = (polygon[(start + i) % 6] for i in range(6))
    if min((a, b, c, d), key=lambda p: p[1:]) in (a, c):
        return [(a, b, x), (a, x, c), (a, c, y), (c, d, y)]
    return [(b, x, d), (x, c, d), (d, y, b), (y, a, b)]


def test_an_edge_that_two_cells_draw_on_the_face_they_share_is_not_the_cells_fault() -> None:
    """Each cell is right by itself; both cut their hexagon (case 3.2) along the shared face.

    The edge of four triangles is told by the claim that names it.
    """

    def careless(field: Field) -> Mesh:
        cut = made(decide=asymptotic, cut=along_the_face)
        vertices, faces = cut(field.values, 0.0, field.spacing)
        return Mesh.of(vertices + field.origin, faces)

    values = np.full((3, 2, 2), -1.0)
    values[1] = [[2, -1], [-1, 2]]
    assert set(names_of(values).values()) == {"3.2"}
    (manifold,) = (claim for claim in topology.CLAIMS if claim.id == "topology.manifold")
    for extract, wanted in ((right, Verdict.PASS), (careless, Verdict.FAIL)):
        assert judged(extract, values).verdict is Verdict.PASS
        assert judged(extract, values, manifold).verdict is wanted


def test_the_whole_is_measured_for_every_family() -> None:
    """Pieces and handles are the level set's for who is right, and told for who is not."""
    values = np.pad(noise(8), 1, constant_values=-3.0)
    found = judged(right, values, SCAN)
    assert found.verdict is Verdict.PASS
    assert found.numbers["pieces"] == found.numbers["pieces_wanted"] > 1
    assert found.numbers["handles"] == found.numbers["handles_wanted"] > 1
    other = judged(by(lorensen_cline.RULE), values, SCAN)
    assert other.verdict is Verdict.FAIL
    assert other.numbers["handles_wanted"] == found.numbers["handles_wanted"]
    assert all(SCAN.families(declaration_from(f.says, n)) for n, f in CORRECT.items())
    assert not SCAN.held(Declaration(""))


@pytest.mark.parametrize("name", ["cropped", "periodic", "capped", "capped_outside"])
def test_cells_of_the_domain_are_judged_and_no_others(name: str) -> None:
    """The domain's own cells: fewer where the outermost are left out, more where it is periodic."""
    values = noise(7)
    plain = judged(by(asymptotic_decider.RULE), values)
    family_ = CORRECT[name]
    declared = declaration_from(family_.says, name)
    field = Field.of(values)
    case = Case(name, lambda: field, (0.0,), field.values.size)
    outcome = Outcome(Status.OK, *family_.function(values, 0.0, (1, 1, 1)))
    finding = CLAIM.judge(Trial(case, field, declared, {"plain": outcome}))
    cells_judged, faults = finding.numbers["cells"], finding.numbers.get("faults", [])
    assert {fault for _, fault, _ in faults} <= {"missing tunnel"}
    order = {"cropped": -1, "periodic": 1}.get(name, 0)
    assert np.sign(cells_judged - plain.numbers["cells"]) == order


def test_a_tie_of_the_whole_is_decided_by_the_side_of_ties() -> None:
    """Two inside samples across a face whose saddle is on the isovalue: joined, as ties are."""
    values = np.full((4, 4, 4), -1.0)
    values[1, 1, 1] = values[1, 2, 2] = 1
    mesh = trilinear_joined(values)
    found = judged(lambda _: mesh, values, SCAN)
    assert found.numbers["pieces_wanted"] == 1
    assert found.numbers["isovalue"] != 0


def trilinear_joined(values: Array) -> Mesh:
    """The answer to a field in which the two samples are a little higher."""
    field = Field.of(np.where(values > 0, 1.01, values), (1, 0.5, 2), (3, -1, 0))
    return sweep(trilinear_cubes.RULE, field, 0.0)


def test_decimal_fractions_are_no_trap_for_the_right_answer() -> None:
    """Fields of tenths at 0.05: distances are rounded, and some saddles undecided but for that."""
    random, undecided = np.random.default_rng(5), 0
    for _ in range(150):
        field = Field.of(random.integers(-9, 10, (3, 3, 3)) * 0.1)
        mesh = sweep(trilinear_cubes.RULE, field, 0.05)
        outcome = Outcome(Status.OK, mesh.vertices, mesh.simplices)
        case = Case("own/tenths", lambda field=field: field, (0.05,), field.values.size)  # type: ignore[misc]
        found = CLAIM.judge(Trial(case, field, Declaration("here"), {"plain": outcome}))
        assert found.verdict is not Verdict.FAIL, found.detail
        _, corners = active_cells(np.asarray(field.values), 0.05)
        undecided += int((cells(corners, 0.05).ties == CLOSE).sum())
    assert undecided > 3
