"""The registries of claims and cases: nothing is listed twice, or never judged."""

from isograde.cases import all_cases
from isograde.claims import CLAIMS, FAMILIES
from isograde.model import LEVELS


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


def test_every_claim_has_a_case_and_every_case_a_claim() -> None:
    """Nothing is listed that is never judged."""
    # Of thousands of cases with the same kind and tags one will do.
    alike = {(case.kind, case.tags): case for case in all_cases(0).values()}
    cases, claims = alike.values(), CLAIMS.values()
    assert [c.id for c in claims if not any(c.applies_to(case) for case in cases)] == []
    for case in cases:
        special = [c.id for c in claims if c.applies_to(case)]
        assert len(special) > 20, case.id


def test_every_kind_has_claims_at_every_level_up_to_consistent() -> None:
    """Closed, manifold, sides, bodies: each is said once, for every (n, m)."""
    for kind in {case.kind for case in all_cases(0).values()}:
        said = {claim.level for claim in CLAIMS.values() if claim.kinds(kind)}
        assert {0, 1, 2} <= said
