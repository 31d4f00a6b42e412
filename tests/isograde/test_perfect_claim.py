"""`cases.perfect`: unmoved, the six VESTA surfaces are not degenerate; broken ones are."""

from collections import Counter
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from isograde.adapters.ready_made import READY_MADE
from isograde.cases import all_cases
from isograde.claims import CLAIMS
from isograde.claims.cycles import MODES
from isograde.model import Case, Declaration, Finding, Verdict
from isograde.runner import Task, Worker
from isograde.variants import pose
from isoref.fast.vesta import extract
from isoref.field import Array, Field, Floats, Integers
from isoref.methods import METHODS
from isoref.vesta import SIX_SURFACES

from tests.isograde import miniatures
from tests.isograde.miniatures import Answer, Function, Inside, Miniature, changed, made

CLAIM = "cases.perfect"
DECIDE = {
    "disconnect": miniatures.apart,
    "connect": miniatures.together,
    "mixed": miniatures.by_mean,
}
FINE = (Verdict.PASS, Verdict.UNSUPPORTED, Verdict.SKIP)


def noise() -> Field:
    """A field with every ambiguity, its crossings well inside their lattice edges."""
    random = np.random.default_rng(1)
    side = random.choice([-1.0, 1.0], (4, 5, 4))
    values = 0.125 + side * random.integers(32, 96, side.shape) / 64
    return Field.of(values, (1, 0.5, 2), (3, -1, 0))


def every_sign() -> Field:
    """Samples of 1 and -1."""
    return Field.of(np.random.default_rng(2).choice([-1.0, 1.0], (7, 6, 8)))


CASES = {
    case.id: case
    for case in (
        Case("noise", noise, 0.125, 80, frozenset({"posed"})),
        Case("signs", every_sign, 0.0, 336, frozenset({"ties"})),
    )
}


def findings(run: Function, mode: str, claims: tuple[str, ...]) -> Iterator[tuple[str, Finding]]:
    """What these claims say of an implementation that declares this mode."""
    worker = Worker(Inside(Miniature("here", run)), declared(mode), CASES, CLAIMS)
    for case in CASES:
        yield from worker.judge(Task(case, claims)).findings.items()


def declared(mode: str) -> Declaration:
    """Level 2, and this mode."""
    return Declaration("here", connectivity=mode)


def verdicts(run: Function, mode: str) -> set[Verdict]:
    """What the claim says of it."""
    return {finding.verdict for _, finding in findings(run, mode, (CLAIM,))}


def of_method(name: str) -> Function:
    """A method of the reference as an implementation."""

    def run(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
        mesh = METHODS[name](Field.of(values, spacing), isovalue)
        return mesh.vertices, mesh.simplices

    return run


@pytest.mark.parametrize(("mode", "resolution"), SIX_SURFACES)
@pytest.mark.parametrize("kind", ["vesta", "marching-vesta"])
def test_the_six_surfaces_are_perfect(kind: str, mode: str, resolution: str) -> None:
    """Section IV, both algorithms, L and H."""
    assert READY_MADE[f"isoref:{kind}-{mode}-{resolution}"].connectivity == mode
    assert verdicts(of_method(f"{kind}-{mode}-{resolution}"), mode) == {Verdict.PASS}


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("cut", [miniatures.careful_fan, miniatures.star])
def test_other_hands_pass_too(mode: str, cut: Callable[..., object]) -> None:
    """The plain extractor of the tests, which shares no code with VESTA, with and without points.

    Its points are put in triangles as well, which the paper leaves to whoever implements it.
    """
    assert verdicts(made(decide=DECIDE[mode], cut=cut), mode) == {Verdict.PASS}


def inner(vertices: Floats) -> Integers:
    """The vertices inside cells."""
    return np.flatnonzero((np.abs(vertices - np.rint(vertices)) > 1e-9).all(axis=1))


def with_late_averages(vertices: Floats, faces: Integers) -> Answer:
    """Inner points stand almost on the first point of their cycle: triangles without area."""
    vertices = vertices.copy()
    for point in inner(vertices):
        at = faces[(faces == point).any(axis=1)][0]
        first = vertices[at[at != point][0]]
        vertices[point] = first + 4e-3 * (vertices[point] - first)
    return vertices, faces


def with_exchanged_averages(vertices: Floats, faces: Integers) -> Answer:
    """Inner points of one cell take each other's places: cones that cross."""
    vertices, points = vertices.copy(), inner(vertices)
    cells: dict[tuple[float, ...], list[int]] = {}
    for point in points:
        cells.setdefault(tuple(np.floor(vertices[point])), []).append(int(point))
    for several in cells.values():
        vertices[several] = vertices[several[1:] + several[:1]]
    return vertices, faces


def with_common_averages(vertices: Floats, faces: Integers) -> Answer:
    """All inner points of a cell in one place, their mean: sheets that touch."""
    vertices, points = vertices.copy(), inner(vertices)
    cell, number = np.unique(np.floor(vertices[points]), axis=0, return_inverse=True)
    for n in range(len(cell)):
        vertices[points[number.ravel() == n]] = vertices[points[number.ravel() == n]].mean(axis=0)
    return vertices, faces


BROKEN = {
    "have no area": with_late_averages,
    "fall together": with_common_averages,
    "cross or overlap": with_exchanged_averages,
}


@pytest.mark.parametrize("told", BROKEN)
@pytest.mark.parametrize("mode", MODES)
def test_a_degenerate_surface_is_caught(told: str, mode: str) -> None:
    """And the finding says in which way."""
    run = changed(BROKEN[told], made(decide=DECIDE[mode], cut=miniatures.star))
    found = [finding for _, finding in findings(run, mode, (CLAIM,))]
    assert {finding.verdict for finding in found} == {Verdict.FAIL}
    assert any(told in finding.detail for finding in found)


@pytest.mark.slow
@pytest.mark.parametrize("told", BROKEN)
def test_of_the_other_claims_only_that_on_crossings_catches_it(told: str) -> None:
    """Its discs, edges and crossings are right, so this claim is needed."""
    run = changed(BROKEN[told], made(decide=miniatures.by_mean, cut=miniatures.star))
    made_claims = tuple(name for name, c in CLAIMS.items() if c.level is None or c.level <= 2)
    bad = {
        name for name, finding in findings(run, "mixed", made_claims) if finding.verdict not in FINE
    }
    crosses = {"geometry.no_self_intersection"} if told == "cross or overlap" else set()
    assert bad - {*crosses} == {CLAIM}


def test_who_declares_no_mode_is_not_judged() -> None:
    """A promise never made is not held against anybody."""
    run = changed(with_late_averages, made(cut=miniatures.star))
    assert verdicts(run, "") == {Verdict.UNSUPPORTED}


def test_a_levelled_field_that_gets_no_answer_is_no_pass() -> None:
    """An error where the plain field had an answer."""

    def run(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
        if np.ptp(np.abs(values)) < 1e-3:
            raise ValueError("all alike")
        return miniatures.plain(values, isovalue, spacing)

    found = dict(findings(run, "disconnect", (CLAIM,)))
    assert found[CLAIM].verdict is not Verdict.PASS
    noisy = Worker(Inside(Miniature("here", run)), declared("disconnect"), CASES, CLAIMS)
    assert noisy.judge(Task("noise", (CLAIM,))).findings[CLAIM].verdict is Verdict.ERROR


def test_the_levelled_field_is_unmoved_and_has_the_cycles_of_the_plain_one() -> None:
    """Every point within 2 ** -13 of the middle of its edge; 8- and 9-cycles stay."""
    lengths: Counter[int] = Counter()
    for case in all_cases().values():
        if case.id.startswith("noise/white") and case.samples <= 720:
            field = case.build()
            posed = pose("level", field, case.isovalue)
            assert posed is not None
            plain, level = (extract(f, a, mode="mixed") for f, a in ((field, case.isovalue), posed))
            assert level.lengths == plain.lengths
            assert np.abs(level.points - 0.5 * level.centres).max() < 2.0**-13
            lengths.update(level.lengths)
    assert {8, 9} <= set(lengths)
