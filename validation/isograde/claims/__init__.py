"""Every claim the grader judges, by id: one module a family, each with a tuple ``CLAIMS``."""

from isograde.claims import bodies, curves, robustness, simplices, structure, symmetry, topology
from isograde.model import Claim

FAMILIES = (structure, bodies, topology, symmetry, robustness, curves, simplices)

CLAIMS: dict[str, Claim] = {claim.id: claim for family in FAMILIES for claim in family.CLAIMS}
