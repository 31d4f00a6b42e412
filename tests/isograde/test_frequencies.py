"""Table 1 for any volume, and the claim that compares it with what a mesh does."""

from collections import Counter
from collections.abc import Callable
from functools import partial

import numpy as np
import pytest
from isograde.cases import nielson_hamann
from isograde.claims import frequencies as family
from isograde.declaration import Declaration
from isograde.frequencies import ROWS, configuration, frequencies
from isograde.model import Case, Finding, Outcome, Request, Status, Trial, Verdict
from isoref import asymptotic_decider, cube, lorensen_cline
from isoref.fast.sweep import sweep
from isoref.field import Field, FieldError, Floats
from isoref.mesh import Mesh
from isoref.rule import Rule

from tests.isograde import miniatures
from tests.isograde.miniatures import Inside, Miniature, asymptotic, made, star


def by_the_reference(field: Field, isovalue: float) -> Counter[str]:
    """The same table by isoref's rotations, decisions and names."""
    g = field.values.astype(np.float64) - isovalue
    n = [size - 1 for size in g.shape]
    corners = np.stack(
        [g[i : i + n[0], j : j + n[1], k : k + n[2]].reshape(-1) for i, j, k in cube.CORNERS]
    )
    signs = ((corners >= 0) << np.arange(8)[:, None]).sum(axis=0)
    decided = asymptotic_decider.decisions(corners)
    names = Counter(
        asymptotic_decider.variant(s, d)
        for s, d in zip(signs.tolist(), decided.tolist(), strict=True)
    )
    lumped = {f"{row.split(',')[0][:-1]}{x}": row for row in ROWS if "," in row for x in row[-3::2]}
    table = Counter(dict.fromkeys(ROWS, 0))
    for name, count in names.items():
        table["13" if name.startswith("13") else lumped.get(name, name)] += count
    return table


def test_configurations_by_distances_are_the_classes_under_rotation() -> None:
    """Figure 2: the same fifteen classes as isoref's, which are made by rotations."""
    for signs in range(256):
        mine = sum(
            1 << bit
            for bit, corner in enumerate(np.ndindex(2, 2, 2))
            if signs >> cube.corner_at(*corner) & 1
        )
        assert configuration(mine) == str(cube.configuration(signs))


@pytest.mark.parametrize("seed", range(3))
def test_the_table_is_the_references_on_noise(seed: int) -> None:
    """Two ways to count, with no code in common, agree in every row; every row occurs."""
    field = Field.of(np.random.default_rng(seed).normal(size=(28, 27, 26)))
    found = frequencies(field, 0.1).counts
    assert Counter(found) == by_the_reference(field, 0.1)
    assert all(found.values())


def test_the_table_is_the_references_on_ties() -> None:
    """Saddles and samples on the isovalue: both take them as inside."""
    field = Field.of(np.random.default_rng(4).integers(0, 4, (24, 24, 24)).astype(np.uint8))
    assert Counter(frequencies(field, 2).counts) == by_the_reference(field, 2)


def test_the_isovalue_is_not_rounded_to_the_samples_type() -> None:
    """The nearest single to 0.3 is above 0.3 and inside, its lower neighbour outside."""
    near = np.float32(0.3)
    samples = [near, np.nextafter(near, np.float32(0)), np.float32(0)]
    values = np.random.default_rng(0).choice(np.array(samples), (9, 9, 9))
    found = frequencies(Field.of(values), 0.3)
    assert found.counts == frequencies(Field.of(values.astype(np.float64)), 0.3).counts
    assert Counter(found.counts) == by_the_reference(Field.of(values), 0.3)


def test_example_3_has_the_counts_of_table_1() -> None:
    """Nielson & Hamann, Table 1, column Example 3, A/B split included."""
    found = frequencies(nielson_hamann.example_3(), nielson_hamann.ISOVALUE_3)
    assert {row: n for row, n in found.counts.items() if n} == {
        "0": 110993, "1": 1673, "2": 2421, "3A": 6, "3B": 6, "5": 1143, "8": 1146, "9": 261,
    }  # fmt: skip
    assert found.cells == 49**3
    assert found.ambiguous == 12
    assert "| 3A | 6 | 0.090 % |" in found.markdown()


def test_a_field_of_one_cell_or_none_is_counted() -> None:
    """Small volumes are no special case; no cell, no count."""
    one = frequencies(Field.of([[[1, 0], [0, 0]], [[0, 0], [0, 0]]]), 0.5)
    assert {row: n for row, n in one.counts.items() if n} == {"1": 1}
    assert frequencies(Field.of(np.zeros((1, 4, 4))), 0.5).cells == 0


def test_what_is_no_volume_is_refused() -> None:
    """A clear error instead of a table of something else."""
    with pytest.raises(FieldError, match="3-D"):
        frequencies(Field.of(np.zeros((3, 3))), 0.5)
    with pytest.raises(FieldError, match="not finite"):
        frequencies(Field.of(np.zeros((3, 3, 3))), float("nan"))


# The claim

(CLAIM,) = family.CLAIMS


def judged(values: Floats, extract: Callable[[Field], Mesh]) -> Finding:
    """What the claim says of an extractor on these values at 0."""
    field = Field.of(values)
    mesh = extract(field)
    case = Case("test", lambda: field, (0.0,), values.size)
    outcome = Outcome(Status.OK, mesh.vertices, mesh.simplices)
    trial = Trial(case, field, Declaration("test"), {"plain": outcome})
    return CLAIM.judge(trial)


def by(rule: Rule) -> Callable[[Field], Mesh]:
    """The sweep of a rule at 0."""
    return lambda field: sweep(rule, field, 0.0)


def noise(n: int = 16) -> Floats:
    """Noise with every configuration in it."""
    return np.random.default_rng(8).normal(size=(n, n, n))


def test_the_claim_passes_the_asymptotic_decider() -> None:
    """The right answer passes, on noise and with ties."""
    assert judged(noise(), by(asymptotic_decider.RULE)).verdict is Verdict.PASS
    ties = np.random.default_rng(8).integers(-2, 3, (12, 12, 12)).astype(float)
    assert judged(ties, by(asymptotic_decider.RULE)).verdict is Verdict.PASS


def test_the_claim_fails_a_fixed_choice_on_ambiguous_faces() -> None:
    """The 1987 drawings separate marked corners always: 3B, 6A, 7C, .. do not occur."""
    finding = judged(noise(), by(lorensen_cline.RULE))
    assert finding.verdict is Verdict.FAIL
    assert " cells of 1 " not in finding.detail
    assert "3B" not in finding.numbers["found"]
    assert "0 cells of 3B instead of" in finding.detail


def test_the_claim_fails_a_decider_with_the_sign_of_the_scan() -> None:
    """The formula as scanned, a c + b d, is never negative: nothing would be separated."""
    joined = Rule("scan", asymptotic_decider.tile, lambda g: np.zeros(g.shape[1], np.int64), bits=6)
    assert judged(noise(), by(joined)).verdict is Verdict.FAIL


def test_the_claim_fails_a_mesh_with_a_missing_cell() -> None:
    """A triangle left out leaves a cell that is no variant."""

    def without_one(field: Field) -> Mesh:
        mesh = sweep(asymptotic_decider.RULE, field, 0.0)
        return Mesh(mesh.vertices, mesh.simplices[1:])

    finding = judged(noise(6), without_one)
    assert finding.verdict is Verdict.FAIL
    assert finding.numbers["found"]["none"] == 1


def by_miniature(miniature: Miniature) -> set[Verdict]:
    """What the claim says of a miniature, on noise, integers and ties."""
    rng = np.random.default_rng(3)
    fields = {
        "noise": Field.of(np.rint(64 * rng.normal(size=(6, 5, 7))) / 64, (0.5, 1, 2), (3, -4, 5)),
        "integers": Field.of(rng.integers(0, 6, (5, 5, 5)).astype(float)),
        "ties": Field.of(rng.integers(-1, 2, (5, 5, 5)).astype(float)),
    }
    levels = {"noise": 0.13, "integers": 2.5, "ties": 0.0}
    found = set()
    for name, field in fields.items():
        case = Case(name, partial(fields.__getitem__, name), (levels[name],), 125)
        outcome = Inside(miniature).run(Request(name, "plain", field, case.isovalues))
        trial = Trial(case, field, miniature.declaration, {"plain": outcome})
        found.add(CLAIM.judge(trial).verdict)
    return found


@pytest.mark.parametrize(
    "miniature",
    [
        Miniature("asymptotic", made(decide=asymptotic), level=3),
        Miniature("inner vertices", made(decide=asymptotic, cut=star), level=3),
        Miniature(
            "ties outside",
            made(decide=asymptotic, tie_inside=False),
            says={"conventions": {"tie": "outside"}},
            level=3,
        ),
    ],
    ids=lambda m: m.name,
)
def test_right_answers_pass_whatever_their_conventions(miniature: Miniature) -> None:
    """The grader is graded: right answers, made by code that is neither reference nor truth."""
    assert by_miniature(miniature) - {Verdict.SKIP} == {Verdict.PASS}


BROKEN = [m for m in miniatures.BROKEN if m.name in ("fixed polarity", "face means", "1987")]


@pytest.mark.parametrize("miniature", BROKEN, ids=lambda m: m.name)
def test_broken_miniatures_are_caught(miniature: Miniature) -> None:
    """What topology.bilinear catches face by face follows through to the counts."""
    assert Verdict.FAIL in by_miniature(miniature)
