"""The registries of claims and cases: nothing is listed twice, or never judged."""

from pathlib import Path

from isograde.cases import all_cases
from isograde.cataloguing import kinds_of
from isograde.claims import CLAIMS, FAMILIES
from isograde.model import LEVELS
from isograde.report.record import families_of, first_line

from tests.isograde import (
    miniatures,
    test_accuracy,
    test_cells,
    test_claims_calls,
    test_curves,
    test_geometry,
    test_perfect_claim,
    test_simplices_claims,
    test_structure,
    test_symmetry,
)

# The claims that the tables of broken implementations name as the one that catches each.
CAUGHT = {
    *(one.breaks for one in miniatures.BROKEN),
    *(f"structure.{name}" for name, _, _ in test_structure.FAULTS),
    *test_symmetry.CAUGHT.values(),
    *test_cells.CHOICES,
    test_perfect_claim.CLAIM,
    *(f"curves.{name}" for name in test_curves.BROKEN),
    *(f"simplices.{name}" for _, _, name in test_simplices_claims.BROKEN),
    *(f"accuracy.{name}" for _, names in test_accuracy.BROKEN.values() for name in names),
}
# Those with a test of their own, and where it stands.
BY_TEST = {
    "bodies.pieces": "test_bodies_claim",
    "bodies.holes": "test_bodies_claim",
    "bodies.offset": "test_bodies_claim",
    "bodies.centroid": "test_bodies_claim",
    "bodies.distance": "test_bodies_claim",
    "bodies.degree": "test_bodies_claim",
    "symmetry.components": "test_symmetry",
    "symmetry.directions": "test_symmetry",
    "topology.scan": "test_scan",
    "range.scale": "test_ranges",
    "range.shift": "test_ranges",
    "accuracy.normals_returned": "test_accuracy",
    "accuracy.normals_of_planes": "test_accuracy",
    "symmetry.normals_returned": "test_symmetry",
    "accuracy.continuity": "test_passing",
    "accuracy.shapes": "test_accuracy",
    "range.digits": "test_ranges",
    "range.extremes": "test_ranges",
    "robustness.elsewhere": "test_robustness",
    "topology.tie_side": "test_topology",
    **dict.fromkeys(test_claims_calls.CLAIMS, "test_claims_calls"),
}


def test_every_claim_has_a_broken_implementation_that_it_catches() -> None:
    """A claim that nothing can fail says nothing; a new claim needs its own."""
    assert len(test_geometry.CAUGHT) > 3
    assert set(CLAIMS) == CAUGHT | set(BY_TEST)
    assert not CAUGHT & set(BY_TEST)
    for claim, module in BY_TEST.items():
        text = (Path(__file__).parent / f"{module}.py").read_text(encoding="utf-8")
        assert f'"{claim}"' in text or f'"{claim.split(".")[1]}"' in text, claim


def test_no_claim_is_lost_on_the_way_to_the_registry() -> None:
    """Every family's claims are listed, under an id that no other has."""
    listed = [claim for family in FAMILIES for claim in family.CLAIMS]
    assert len({claim.id for claim in listed}) == len(listed) == len(CLAIMS) > 40


def test_every_claim_says_its_rule_its_source_and_its_level() -> None:
    """A claim beside the ladder has no level."""
    for claim in CLAIMS.values():
        assert claim.rule.endswith(".")
        assert claim.source
        assert claim.level is None or claim.level in LEVELS


def test_what_a_claim_is_said_of_is_told_in_words() -> None:
    """`isograde explain` once said "others (<lambda>)", which tells nobody anything."""
    assert CLAIMS
    for claim in CLAIMS.values():
        kinds = first_line(claim.kinds) if kinds_of(claim).endswith("others") else ""
        assert "lambda" not in f"{kinds} {families_of(claim)} {first_line(claim.judge)}", claim.id


def test_every_claim_has_a_case_and_every_case_a_claim() -> None:
    """Nothing is listed that is never judged."""
    # Of thousands of cases with the same kind and tags one will do.
    alike = {(case.kind, case.tags): case for case in all_cases(0).values()}
    cases, claims = alike.values(), CLAIMS.values()
    assert [c.id for c in claims if not any(c.applies_to(case) for case in cases)] == []
    for case in cases:
        special = [c.id for c in claims if c.applies_to(case)]
        assert len(special) > (3 if case.only else 20), case.id


def test_every_kind_has_claims_at_every_level_up_to_consistent() -> None:
    """Closed, manifold, sides, bodies: each is said once, for every (n, m)."""
    for kind in {case.kind for case in all_cases(0).values()}:
        said = {claim.level for claim in CLAIMS.values() if claim.kinds(kind)}
        assert {0, 1, 2} <= said
