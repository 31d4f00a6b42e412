"""Every claim of every discipline has a broken implementation that it catches."""

import pytest
from isograde import claims as surfaces
from isograde.disciplines.registry import ALL_CLAIMS, DISCIPLINES

from tests.isograde import (
    miniatures,
    test_accuracy,
    test_claims,
    test_contours_discipline,
    test_curves_discipline,
    test_cycles_claim,
    test_disciplines_simplicial,
    test_frequencies,
    test_perfect_claim,
    test_trilinear_claim,
)

# Tests of families of one claim, each with a table of broken implementations that it catches.
OF_ONE_CLAIM = {
    test_cycles_claim.CLAIM.id: test_cycles_claim.BROKEN,
    test_frequencies.CLAIM.id: test_frequencies.BROKEN,
    test_perfect_claim.CLAIM: test_perfect_claim.BROKEN,
    test_trilinear_claim.CLAIM.id: test_trilinear_claim.BROKEN,
}
# The claims that the broken implementations of each discipline are caught by; the tables are those
# that the discipline's own tests run.
CAUGHT = {
    "surfaces": {
        *(miniature.breaks for miniature in miniatures.BROKEN),
        *(f"accuracy.{name}" for _, names in test_accuracy.BROKEN.values() for name in names),
        *(name for name, table in OF_ONE_CLAIM.items() if table),
    },
    "contours": {f"contours.{name}" for name in test_contours_discipline.BROKEN},
    "curves": {f"curves.{name}" for name in test_curves_discipline.BROKEN},
    "simplices": {f"simplices.{name}" for _, _, name, _ in test_disciplines_simplicial.BROKEN},
}


@pytest.mark.parametrize("name", DISCIPLINES)
def test_every_claim_is_caught_by_a_broken_implementation(name: str) -> None:
    """A claim that nothing can fail says nothing; a new claim, or discipline, needs its own."""
    assert CAUGHT[name] == set(DISCIPLINES[name].claims)


def test_no_claim_is_lost_on_the_way_to_the_registry() -> None:
    """Every family's claims are listed, under an id that no other has."""
    listed = [claim for family in surfaces.FAMILIES for claim in family.CLAIMS]
    assert len({claim.id for claim in listed}) == len(listed) == len(DISCIPLINES["surfaces"].claims)
    assert len(ALL_CLAIMS) == sum(len(one.claims) for one in DISCIPLINES.values())
    assert set(test_claims.CLAIMS) <= set(ALL_CLAIMS)


def test_every_claim_says_its_rule_its_source_and_its_level() -> None:
    """Levels are 0 to 4; a claim beside the ladder has none."""
    for name, discipline in DISCIPLINES.items():
        for claim in discipline.claims.values():
            assert claim.rule
            assert claim.source
            assert claim.level in (None, 0, 1, 2, 3, 4)
            assert claim.discipline == name


@pytest.mark.parametrize("name", DISCIPLINES)
def test_every_claim_has_a_case_and_every_case_a_claim(name: str) -> None:
    """Nothing is listed that is never judged."""
    discipline = DISCIPLINES[name]
    cases, claims = discipline.cases(0).values(), discipline.claims.values()
    assert [c.id for c in claims if not any(c.applies_to(case) for case in cases)] == []
    assert [case.id for case in cases if not any(c.applies_to(case) for c in claims)] == []
