"""Every claim the grader judges, by id: one module a family, each with a tuple ``CLAIMS``."""

from isograde.claims import (
    bilinear,
    cells,
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
    geometry,
    cells,
    bilinear,
    frequencies,
    perfect,
    trilinear,
    symmetry,
    robustness,
)

CLAIMS: dict[str, Claim] = {claim.id: claim for family in FAMILIES for claim in family.CLAIMS}
