"""Every claim the grader judges, by id: one module a family, each with a tuple ``CLAIMS``."""

from isograde.claims import (
    accuracy,
    cases,
    counting,
    cycles,
    frequencies,
    geometry,
    perfect,
    robustness,
    structure,
    symmetry,
    topology,
    trilinear,
)
from isograde.model import Claim

FAMILIES = (
    structure,
    topology,
    trilinear,
    geometry,
    cases,
    cycles,
    perfect,
    frequencies,
    counting,
    symmetry,
    robustness,
    accuracy,
)

CLAIMS: dict[str, Claim] = {claim.id: claim for family in FAMILIES for claim in family.CLAIMS}
