"""The same answer however the field is posed: correct families pass, and each cheat is caught."""

from __future__ import annotations

from collections import Counter
from functools import cache, partial
from typing import Any

import isoref
import numpy as np
import pytest
from isograde.cases import all_cases
from isograde.claims.symmetry import _clear, _turned, own_symmetry, same_shape
from isograde.declaration import Declaration, End, Split, declaration_from
from isograde.model import CONTOURS, SURFACES, Case, Kind, Outcome, Status, Trial, Verdict
from isograde.oracles import overlay
from isograde.oracles.complexes import Complex
from isograde.runner import claims_for
from isograde.variants import named, symmetry_of, variant
from isoref.fast.simplicial import extract as simplicial
from isoref.field import Field

from tests.isograde import mistaken
from tests.isograde.cheats import CHEATS
from tests.isograde.families import CORRECT, Function
from tests.isograde.judging import Here, grade, verdicts

# A cell with an ambiguous face, and a little noise.
CASES = ("cells/outside/009", "noise/white-5x6x7")
# One of each family; the conventions differ in nothing that is compared here.
FAMILIES = (
    "cubes", "cubes_in_soup_from_either_end", "trilinear_with_flat_triangles", "nets",
    "dual_cubes_of_quads", "tetrahedra_of_kuhn", "tetrahedra_of_five", "label_cubes",
    "dual_cubes_of_labels", "resampled_finer", "axes_reversed", "capped", "periodic",
)  # fmt: skip
CAUGHT = {
    "nets_of_doubles_only": "symmetry.type",
    "nets_of_c_order_only": "symmetry.layout",
    "one_spacing_for_all": "symmetry.spacing",
    "kuhn_in_a_mirror": "symmetry.orientation",
    "cubes_of_tetrahedra": "symmetry.orientation",
    "last_layer_missing": "symmetry.orientation",
    "always_a_ball_in_the_middle": "symmetry.translation",
    "flips_a_coin": "symmetry.shift",
}


@cache
def asked() -> tuple[Case, ...]:
    """The cases."""
    every = all_cases()
    return tuple(every[name] for name in CASES)


@pytest.mark.parametrize("name", FAMILIES)
def test_correct_extractors_of_every_family_pass(name: str) -> None:
    """Whatever is free for a family is not compared, and something is."""
    family = CORRECT[name]
    found = verdicts(
        family.function,
        declaration_from(family.says, name),
        asked()[name.startswith("resampled") :][:1],
        "symmetry.",
    )
    bad = {claim: counts for claim, counts in found.items() if set(counts) - {"pass", "skip"}}
    assert not bad
    assert sum(counts[Verdict.PASS] for counts in found.values()) >= 3


@pytest.mark.parametrize(("name", "claim"), CAUGHT.items())
def test_a_cheat_is_caught(name: str, claim: str) -> None:
    """By the claim that is made for it."""
    cheat = CHEATS[name]
    found = verdicts(cheat.function, declaration_from(cheat.says, name), asked(), claim)
    assert found[claim][Verdict.FAIL]


@pytest.mark.parametrize(
    ("function", "told"),
    [
        (mistaken.tunnels_on_one_side, "together otherwise"),
        (mistaken.turned_on_one_side, "turned over"),
    ],
)
def test_what_is_inside_a_cell_is_compared(function: Function, told: str) -> None:
    """Tunnels, and which way triangles are turned, though every face has the same segments."""
    case = all_cases()["noise/white-10x8x9"]
    found = list(grade(Here(function, Declaration("d")), [case], "symmetry.orientation"))
    assert [(f.verdict, told in f.detail) for _, _, f in found] == [(Verdict.FAIL, True)]


def test_scaling_finds_an_absolute_epsilon() -> None:
    """Differences below one thousandth count as none, whatever the values' size."""
    cubes = CORRECT["cubes"].function

    def coarse(values, isovalue, spacing):  # type: ignore[no-untyped-def]
        rounded = np.where(np.abs(values - isovalue) < 0.3, isovalue + 0.3, values)
        return cubes(rounded, isovalue, spacing)

    found = verdicts(coarse, Declaration("coarse"), asked(), "symmetry.scaling")
    assert found["symmetry.scaling"][Verdict.FAIL]


def test_the_order_of_the_components_is_compared() -> None:
    """Curves on whose first field a sample more counts as inside: another answer, turned round."""
    shape = (4, 3, 4)
    field = Field.of(np.random.default_rng(5).normal(size=(2, *shape)), dimension=3)
    case = Case("test", lambda: field, (0.1, 0.1), 1, kind=Kind(3, 2))
    declared = declaration_from({"interpolant": "kuhn", "limits": {"kinds": [[3, 2]]}}, "curves")

    def extract(values, isovalues, spacing):  # type: ignore[no-untyped-def]
        levels = np.reshape([isovalues[0] - 0.2, isovalues[1]], (2, 1, 1, 1))
        mesh = simplicial(Field.of(values - levels, spacing, dimension=3))
        return mesh.vertices, mesh.simplices

    found = verdicts(extract, declared, [case], "symmetry.components")
    assert found["symmetry.components"][Verdict.FAIL]


@pytest.mark.parametrize("kind", [Kind(2, 1), Kind(3, 2), Kind(4, 2)], ids=str)
def test_simplices_of_other_kinds_pass(kind: Kind) -> None:
    """Kuhn's simplices under their own symmetries, and another order of the components."""
    shape = {2: (6, 5), 3: (4, 3, 4), 4: (3, 3, 2, 3)}[kind.n]
    values = np.random.default_rng([*kind]).normal(size=(kind.m, *shape))
    field = Field.of(values if kind.m > 1 else values[0], dimension=kind.n)
    case = Case("test", lambda: field, (0.1,) * kind.m, 1, kind=kind)
    declared = declaration_from(
        {"interpolant": "kuhn", "limits": {"kinds": [list(kind)]}}, "simplices"
    )

    def extract(values, isovalues, spacing):  # type: ignore[no-untyped-def]
        levels = np.reshape(isovalues, (kind.m, *(1,) * kind.n))
        parts = values.reshape(kind.m, *values.shape[-kind.n :]) - levels
        mesh = simplicial(Field.of(parts, spacing, dimension=kind.n))
        return mesh.vertices, mesh.simplices

    found = verdicts(extract, declared, [case], "symmetry.")
    assert {claim for claim, counts in found.items() if counts[Verdict.PASS]} >= {
        "symmetry.translation",
        "symmetry.scaling",
        "symmetry.shift",
        "symmetry.orientation",
        "symmetry.layout",
    }
    assert not sum(found.values(), Counter()) - Counter({Verdict.PASS: 99, Verdict.SKIP: 99})


def test_the_splits_own_symmetries_are_those_that_leave_it_as_it_is() -> None:
    """Kuhn: orders of the axes, and all axes mirrored at once; the five: by the parities."""
    kuhn = Split()
    orders = [(0, 1, 2), (1, 0, 2), (2, 1, 0)]
    assert all(own_symmetry(kuhn, (0, 1, 0), order, (False,) * 3) for order in orders)
    assert own_symmetry(kuhn, (0, 0, 0), (0, 1, 2), (True,) * 3)
    assert not own_symmetry(kuhn, (0, 0, 0), (0, 1, 2), (True, False, False))
    five = declaration_from(CORRECT["tetrahedra_of_five"].says, "five").split
    assert own_symmetry(five, (0, 0, 0), (0, 1, 2), (True, False, False))
    assert not own_symmetry(five, (1, 0, 0), (0, 1, 2), (True, False, False))


def test_the_oracle_finds_one_simplex_moved_turned_or_lost() -> None:
    """And does not mind numbering, order or the last digits."""
    rng = np.random.default_rng(0)
    points, rows = rng.normal(size=(9, 3)), rng.permuted(np.tile(np.arange(9), (6, 1)), axis=1)
    rows = rows[:, :3]
    plain, order = Complex(points, rows), rng.permutation(9)
    renamed = Complex(points[order] + 1e-9, np.argsort(order)[np.roll(rows[::-1], 1, axis=1)])
    assert [len(x) for x in overlay.unmatched(plain, renamed, 1e-6)] == [0, 0]
    turned = rows.copy()
    turned[2] = turned[2][::-1]
    assert [x.tolist() for x in overlay.unmatched(plain, Complex(points, turned), 1e-6)] == [
        [2],
        [2],
    ]
    fewer = Complex(points, rows[1:])
    assert [x.tolist() for x in overlay.unmatched(plain, fewer, 1e-6)] == [[0], []]
    moved = points.copy()
    moved[rows[0, 0]] += 1e-3
    assert len(overlay.lonely(points, moved, 1e-6)[0]) == 1


DIRECTED = {"limits": {"directions": True}}
BACKWARDS = {"limits": {"negative": True}}


def in_the_world(name: str) -> Function:
    """The extractor of this name, moved to the axes of the world that it is told."""
    function = CORRECT[name].function

    def extract(values, isovalue, spacing, directions=None):  # type: ignore[no-untyped-def]
        frame = np.eye(3) if directions is None else directions
        frame = frame * np.sign(spacing)[:, None]
        vertices, rows = function(values, isovalue, tuple(np.abs(spacing).tolist()))[:2]
        return vertices @ frame, rows[:, ::-1] if np.linalg.det(frame) < 0 else rows

    return extract


@pytest.mark.parametrize(
    "name", ["cubes", "nets", "dual_cubes_of_quads", "tetrahedra_of_kuhn", "label_cubes", "capped"]
)
def test_who_goes_with_the_axes_of_the_world_passes(name: str) -> None:
    """Of "symmetry.directions": in every family, turned, mirrored, and at negative spacings."""
    says = {**CORRECT[name].says, "limits": {**DIRECTED["limits"], **BACKWARDS["limits"]}}
    declared = declaration_from(says, name)
    found = list(grade(Here(in_the_world(name), declared), asked()[1:], "symmetry.directions"))
    assert [(f.verdict, f.numbers) for _, _, f in found] == [(Verdict.PASS, {"variants": 4})]


def test_the_reference_takes_directions() -> None:
    """`isoref.extract`, whose declaration says nothing of them, asked by name."""
    declared = declaration_from(DIRECTED, "isoref")

    def extract(values, isovalue, spacing, directions=None):  # type: ignore[no-untyped-def]
        mesh = isoref.extract(values, isovalue, spacing, directions=directions)
        return mesh.vertices, mesh.simplices

    found = list(grade(Here(extract, declared), asked(), "symmetry.directions"))
    assert [(f.verdict, f.numbers) for _, _, f in found] == [(Verdict.PASS, {"variants": 2})] * 2


@pytest.mark.parametrize("says", [DIRECTED, BACKWARDS], ids=["directions", "negative"])
@pytest.mark.parametrize("name", ["cubes", "nets", "tetrahedra_of_kuhn", "label_cubes"])
def test_who_comes_out_of_a_mirror_inside_out_does_not(name: str, says: dict[str, object]) -> None:
    """Vertices are moved, and simplices keep their order: in every family."""
    right: Any = in_the_world(name)

    def extract(values, isovalue, spacing, directions=None):  # type: ignore[no-untyped-def]
        vertices, rows = right(values, isovalue, spacing, directions)
        frame = np.eye(3) if directions is None else directions
        mirrored = np.linalg.det(frame * np.sign(spacing)[:, None]) < 0
        return vertices, rows[:, ::-1] if mirrored else rows

    declared = declaration_from({**CORRECT[name].says, **says}, name)
    found = list(grade(Here(extract, declared), asked()[1:], "symmetry.directions"))
    assert [f.verdict for _, _, f in found] == [Verdict.FAIL]


def test_nobody_else_is_asked_for_directions() -> None:
    """The plan of who does not take them is what it was."""
    for name, family in CORRECT.items():
        assert "symmetry.directions" not in claims_for(declaration_from(family.says, name))
    both = claims_for(declaration_from(DIRECTED, "one"))
    assert set(both) - set(claims_for(Declaration("one"))) == {"symmetry.directions"}


@pytest.mark.parametrize("kind", [Kind(2, 1), Kind(3, 2)], ids=str)
def test_contours_and_curves_go_with_the_axes_too(kind: Kind) -> None:
    """In other dimensions, with their direction along the curve."""
    shape = {2: (6, 5), 3: (4, 3, 4)}[kind.n]
    values = np.random.default_rng([*kind]).normal(size=(kind.m, *shape))
    field = Field.of(values if kind.m > 1 else values[0], dimension=kind.n)
    case = Case("test", lambda: field, (0.1,) * kind.m, 1, kind=kind)
    limits = {"kinds": [list(kind)], "directions": True, "negative": True}
    declared = declaration_from({"interpolant": "kuhn", "limits": limits}, "simplices")

    def extract(values, isovalues, spacing, directions=None, turn=True):  # type: ignore[no-untyped-def]
        levels = np.reshape(isovalues, (kind.m, *(1,) * kind.n))
        parts = values.reshape(kind.m, *values.shape[-kind.n :]) - levels
        frame = np.eye(kind.n) if directions is None else directions
        frame = frame * np.sign(spacing)[:, None]
        mesh = simplicial(Field.of(parts, tuple(np.abs(spacing).tolist()), dimension=kind.n))
        rows = mesh.simplices[:, ::-1] if turn and np.linalg.det(frame) < 0 else mesh.simplices
        return mesh.vertices @ frame, rows

    right = list(grade(Here(extract, declared), [case], "symmetry.directions"))
    assert [(f.verdict, f.numbers) for _, _, f in right] == [(Verdict.PASS, {"variants": 4})]
    wrong = list(grade(Here(partial(extract, turn=False), declared), [case], "symmetry.directions"))
    assert [f.verdict for _, _, f in wrong] == [Verdict.FAIL]


def test_normals_that_come_know_the_spacing() -> None:
    """Of "symmetry.normals_returned": a surface that is stretched has normals that are shrunk."""
    from tests.isograde.faults.histories import Normals, NormalsOfSamples

    asked = [all_cases()["noise/white-5x6x7"]]
    said = {
        made: verdicts(made(), Declaration("normals"), asked, "symmetry.normals")
        for made in (Normals, NormalsOfSamples)
    }
    claim = "symmetry.normals_returned"
    assert list(said[Normals][claim]) == [Verdict.PASS]
    assert list(said[NormalsOfSamples][claim]) == [Verdict.FAIL]


@pytest.mark.parametrize(
    ("lost", "verdict"),
    [
        ("one", Verdict.PASS),
        ("one is not a number", Verdict.PASS),
        ("all", Verdict.SKIP),
        ("all but those that are wrong", Verdict.FAIL),
    ],
)
def test_a_vertex_without_slope_may_have_no_normal(lost: str, verdict: Verdict) -> None:
    """Of "symmetry.normals_returned": zeros are not compared, and zeros alone are no pass."""
    from tests.isograde.faults.histories import Normals, NormalsOfSamples

    wrong = "wrong" in lost
    kind = NormalsOfSamples if wrong else Normals

    class Flat(kind):  # type: ignore[misc, valid-type]
        """Some normals are zero, or no numbers."""

        def turned(self, normals: Any, spacing: Any) -> Any:
            """The normals but the first, or none of them."""
            made = super().turned(normals, spacing)
            made[: None if lost == "all" else 1] = np.nan if "number" in lost else 0.0
            return made

    asked = [all_cases()["noise/white-5x6x7"]]
    said = verdicts(Flat(), Declaration("flat"), asked, "symmetry.normals")
    assert list(said["symmetry.normals_returned"]) == [verdict]


@pytest.mark.parametrize("turned", [False, True])
def test_the_oracle_finds_an_edge_lost_whichever_end_is_named_first(turned: bool) -> None:
    """Of three segments the last; those without extent are no edges."""
    points = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0, 1 + 1e-9]])[:: -1 if turned else 1]
    rows = np.array([[0, 1], [1, 2], [2, 3], [3, 4]])
    whole, fewer = Complex(points, rows), Complex(points, np.delete(rows, 1, axis=0))
    kept = np.ones(4, bool), np.ones(3, bool)
    alone, other = overlay.unmatched_edges(whole, fewer, kept, 1e-6)
    assert (alone.tolist(), other.tolist()) == ([[1, 2]], [])
    other, alone = overlay.unmatched_edges(fewer, whole, kept[::-1], 1e-6)
    assert (alone.tolist(), other.tolist()) == ([[1, 2]], [])


def test_the_ends_of_the_domain_turn_with_the_axes_of_a_symmetry_alone() -> None:
    """One for all axes needs no turning."""
    declared = Declaration("", domain=(End(0.5), End(0.0, "closed"), End(1.0)))
    for name in named(["symmetry/"], SURFACES):
        order, _ = symmetry_of(name)
        ends = _turned(declared, variant(name, SURFACES), 3).domain
        assert ends == tuple(declared.domain[axis] for axis in order)
    assert {"spacing", "offset/2^10"} < set(named(["spacing", "offset/"], SURFACES))
    for name in named(["spacing", "offset/", "translate"], SURFACES):
        assert _turned(declared, variant(name, SURFACES), 3) is declared
    alike = Declaration("", domain=(End(0.5),))
    assert _turned(alike, variant(named(["symmetry/"], SURFACES)[3], SURFACES), 3) is alike


def bare(values: Any) -> Trial:
    """A trial on these values at 0 that has no answer yet."""
    field = Field.of(np.array(values, np.float64))
    kind = Kind(field.dimension, 1)
    case = Case("test", lambda: field, (0.0,), field.values.size, kind=kind)
    nothing = Outcome(Status.OK, np.empty((0, kind.n)), np.empty((0, kind.n), np.int64))
    return Trial(case, field, Declaration("test"), {"plain": nothing})


@pytest.mark.parametrize(("high", "clear"), [(1.0, False), (1.0 + 1e-9, False), (1.1, True)])
def test_what_hangs_on_rounding_at_a_saddle_is_not_compared(high: float, clear: bool) -> None:
    """The simplices of a cell with such a face; the way such a square of the plane is joined."""
    square = [[high, -1.0], [-1.0, 1.0]]
    trial = bare([square, [[-1.0, -1.0], [-1.0, -1.0]]])
    middle = Complex(
        np.array([[0.2, 0.1, 0.1], [0.1, 0.2, 0.1], [0.1, 0.1, 0.2]]), np.array([[0, 1, 2]])
    )
    assert len(_clear(trial, middle, np.array([0]))) == clear
    # In the plane, both corners cut off, and the other two.
    contours = bare(square)
    crossing = high / (1 + high)
    places = np.array([[crossing, 0], [0, crossing], [0.5, 1], [1, 0.5]])
    apart, joined = (
        Complex(places, np.array([[0, 1], [2, 3]])),
        Complex(places, np.array([[0, 3], [1, 2]])),
    )
    contours.memory["complex"] = apart
    asked = variant("spacing", CONTOURS)
    assert same_shape(contours, apart, asked) == ""
    assert ("joined otherwise" in same_shape(contours, joined, asked)) == clear


def test_normals_of_vertices_that_moved_are_not_compared() -> None:
    """At another spacing all are elsewhere, and turned over: for "symmetry.spacing" to say."""
    from tests.isograde.faults.histories import Normals

    class Moved(Normals):
        def __call__(self, values: Any, isovalue: float, spacing: Any) -> Any:
            vertices, triangles, normals = super().__call__(values, isovalue, spacing)
            if len(set(spacing)) == 1:
                return vertices, triangles, normals
            return vertices + 0.01, triangles, -normals

    asked = [all_cases()["noise/white-5x6x7"]]
    [found] = grade(Here(Moved(), Declaration("moved")), asked, "symmetry.normals")
    assert found[2].verdict is Verdict.SKIP
    assert "no vertex is where it was" in found[2].detail
