"""Every claim the grader judges, by id: one module a family, each with a tuple ``CLAIMS``."""

from isograde.claims import (
    accuracy,
    bilinear,
    bodies,
    calls,
    cells,
    curves,
    frequencies,
    geometry,
    passing,
    perfect,
    ranges,
    robustness,
    simplices,
    structure,
    symmetry,
    topology,
    trilinear,
)
from isograde.model import Claim

FAMILIES = (
    structure,
    bodies,
    topology,
    geometry,
    cells,
    bilinear,
    frequencies,
    perfect,
    trilinear,
    symmetry,
    ranges,
    robustness,
    calls,
    curves,
    simplices,
    accuracy,
    passing,
)

CLAIMS: dict[str, Claim] = {claim.id: claim for family in FAMILIES for claim in family.CLAIMS}
