"""`cells.perfect`: unmoved, the six VESTA surfaces are not degenerate; broken ones are."""

from collections import Counter
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from isograde.cases import all_cases
from isograde.claims import CLAIMS
from isograde.claims.perfect import _judged
from isograde.declaration import Declaration
from isograde.model import Case, Finding, Request, Trial, Verdict
from isograde.oracles.complexes import Complex
from isograde.variants import pose
from isoref.fast.vesta import extract
from isoref.field import Array, Field, Floats, Integers
from isoref.methods import METHODS
from isoref.vesta import SIX_SURFACES

from tests.isograde import miniatures
from tests.isograde.miniatures import Answer, Function, Inside, Miniature, changed, made

CLAIM = "cells.perfect"
MODES = ("disconnect", "connect", "mixed")
DECIDE = {
    "disconnect": miniatures.apart,
    "connect": miniatures.together,
    "mixed": miniatures.by_mean,
}
FINE = (Verdict.PASS, Verdict.SKIP)


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
        Case("noise", noise, (0.125,), 80, frozenset({"posed"})),
        Case("signs", every_sign, (0.0,), 336, frozenset({"ties"})),
    )
}


def findings(run: Function, claims: tuple[str, ...]) -> Iterator[tuple[str, Finding]]:
    """What these claims say of an implementation, posed as it stands and levelled."""
    adapter = Inside(Miniature("here", run))
    for case in CASES.values():
        field = case.build()
        asked = {"plain": (field, case.isovalues)}
        levelled = pose("level", case, field)
        if levelled is not None:
            asked["level"] = levelled
        outcomes = {n: adapter.run(Request(case.id, n, *posed)) for n, posed in asked.items()}
        trial = Trial(case, field, Declaration("here"), outcomes)
        for name in claims:
            yield name, CLAIMS[name].judge(trial)


def verdicts(run: Function) -> set[Verdict]:
    """What the claim says of it."""
    return {finding.verdict for _, finding in findings(run, (CLAIM,))}


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
    assert verdicts(of_method(f"{kind}-{mode}-{resolution}")) == {Verdict.PASS}


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("cut", [miniatures.careful_fan, miniatures.star])
def test_other_hands_pass_too(mode: str, cut: Callable[..., object]) -> None:
    """The plain extractor of the tests, which shares no code with VESTA, with and without points.

    Its points are put in triangles as well, which the paper leaves to whoever implements it.
    """
    assert verdicts(made(decide=DECIDE[mode], cut=cut)) == {Verdict.PASS}


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
    found = [finding for _, finding in findings(run, (CLAIM,))]
    assert {finding.verdict for finding in found} == {Verdict.FAIL}
    assert any(told in finding.detail for finding in found)


@pytest.mark.parametrize("told", BROKEN)
def test_of_the_other_claims_only_that_on_crossings_catches_it(told: str) -> None:
    """Its discs, edges and crossings are right, so this claim is needed."""
    run = changed(BROKEN[told], made(decide=miniatures.by_mean, cut=miniatures.star))
    plain = tuple(
        name
        for name, claim in CLAIMS.items()
        if name == CLAIM or (name.startswith(("topology.", "geometry.", "cells.")) and claim.level)
    )
    level2 = tuple(n for n in plain if n == CLAIM or (CLAIMS[n].level or 0) <= 2)
    bad = {name for name, finding in findings(run, level2) if finding.verdict not in FINE}
    crosses = {"geometry.embedded"} if told == "cross or overlap" else set()
    assert bad - {*crosses} == {CLAIM}


def test_nobody_promises_it_unasked() -> None:
    """A claim of choice; who names it among the promises is held to it."""
    assert not CLAIMS[CLAIM].held(Declaration("here"))
    assert CLAIMS[CLAIM].held(Declaration("here", promised=frozenset({CLAIM})))


def test_a_levelled_field_that_gets_no_answer_is_no_pass() -> None:
    """An error where the plain field had an answer."""

    def run(values: Array, isovalue: float, spacing: tuple[float, ...]) -> Answer:
        if np.ptp(np.abs(values)) < 1e-3:
            raise ValueError("all alike")
        return miniatures.plain(values, isovalue, spacing)

    found = [finding.verdict for _, finding in findings(run, (CLAIM,))]
    assert found[0] is Verdict.ERROR
    assert Verdict.PASS not in found


def test_the_levelled_field_is_unmoved_and_has_the_cycles_of_the_plain_one() -> None:
    """Every point within 2 ** -13 of the middle of its edge; 8- and 9-cycles stay."""
    lengths: Counter[int] = Counter()
    for case in all_cases().values():
        if case.id.startswith("noise/white") and case.samples <= 720:
            field = case.build()
            posed = pose("level", case, field)
            assert posed is not None
            plain, level = (
                extract(f, a, mode="mixed") for f, (a,) in ((field, case.isovalues), posed)
            )
            assert level.lengths == plain.lengths
            assert np.abs(level.points - 0.5 * level.centres).max() < 2.0**-13
            lengths.update(level.lengths)
    assert {8, 9} <= set(lengths)


@pytest.mark.parametrize("narrow", [70, 90])
def test_a_narrow_tunnel_is_drawn_with_small_triangles_and_is_no_fault(narrow: int) -> None:
    """The levelled values say how narrow it is; the same triangles on one line are a fault."""
    values = np.array([-1, 1, -1, -1, 70, -1, -1, narrow], np.float64).reshape(2, 2, 2)
    case = Case("narrow", lambda: Field.of(values), (0.0,), 8, frozenset({"posed"}))
    posed = pose("level", case, case.build())
    assert posed is not None
    for squeeze, verdict in ((False, Verdict.PASS), (True, Verdict.FAIL)):

        def run(
            values: Array, isovalue: float, spacing: tuple[float, ...], squeeze: bool = squeeze
        ) -> Answer:
            vertices, faces = of_method("trilinear-cubes")(values, isovalue, spacing)
            points = inner(vertices)
            assert len(points) == 6
            if squeeze:
                vertices[points] = vertices[points].mean(axis=0)
            return vertices, faces

        outcome = Inside(Miniature("here", run)).run(Request(case.id, "level", *posed))
        outcomes = {"plain": outcome, "level": outcome}
        trial = Trial(case, case.build(), Declaration("here"), outcomes)
        assert CLAIMS[CLAIM].judge(trial).verdict is verdict


def test_the_first_triangle_without_area_is_named_by_its_middle() -> None:
    """In index coordinates, with the number of such triangles."""
    level = Trial(CASES["signs"], every_sign(), Declaration("here"), {})
    places = np.array([[0.5, 1, 2], [1, 1.5, 3], [2, 1, 2.5], [1.25, 1.25, 2.25], [2.5, 4, 5]])
    surface = Complex(places, np.array([[0, 1, 2], [0, 2, 3], [3, 0, 3]]))
    found = _judged(level, surface)
    assert (found.verdict, found.numbers["count"]) == (Verdict.FAIL, 1)
    assert found.numbers["first"] == pytest.approx([1, 7 / 6, 13 / 6], abs=1e-5)
