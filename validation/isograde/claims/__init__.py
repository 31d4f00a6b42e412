"""Every claim the grader judges, by id: one module a family, each with a tuple ``CLAIMS``."""

from isograde.model import Claim

CLAIMS: dict[str, Claim] = {}
