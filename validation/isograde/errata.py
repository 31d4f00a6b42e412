"""Ids of verdicts, so that they can be contested, and what was found to be wrong with one since.

A verdict has an id: the version of the plan, the seed, the claim and the case, with dots between,
as `verdict_id` writes them. Whoever contests one names it (CONTRIBUTING.md says where). Where the
grader was wrong, an erratum is added here and stays for ever: pages show it beside the verdicts it
is about, whenever they were made.

`isograde.cases.PLAN` is raised whenever a case, a claim or a judge changes what is said of some
implementation. Reports of unlike plans are not laid side by side: what differs might be the grader.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from fnmatch import fnmatchcase


@dataclass(frozen=True)
class Erratum:
    """A verdict that the grader should not have given.

    plans : the versions of the plan it is about
    claims, cases : globs of ids
    told : what was wrong, and what is right
    """

    id: str
    date: str
    plans: tuple[int, ...]
    claims: str
    cases: str
    told: str

    def is_about(self, plan: int, claim: str, case: str) -> bool:
        """Whether a verdict is one of these."""
        named = fnmatchcase(claim, self.claims) and fnmatchcase(case, self.cases)
        return plan in self.plans and named


ERRATA: tuple[Erratum, ...] = ()


def verdict_id(plan: int, seed: int, claim: str, case: str) -> str:
    """The id of a verdict.

    >>> verdict_id(1, 0, "topology.closed", "cells/outside/137")
    '1.0.topology.closed.cells/outside/137'
    """
    return f"{plan}.{seed}.{claim}.{case}"


def errata_of(plan: int, claim: str, case: str) -> list[Erratum]:
    """What was found to be wrong with a verdict."""
    return [one for one in ERRATA if one.is_about(plan, claim, case)]


VERDICT_ID = re.compile(r"(\d+)\.(\d+)\.([a-z_]+\.[a-z_]+)\.(.+)")


def parsed(text: str) -> tuple[int, int, str, str] | None:
    """Plan, seed, claim and case of a verdict's id; None where it is none.

    >>> parsed("1.0.topology.closed.cells/outside/137")
    (1, 0, 'topology.closed', 'cells/outside/137')
    """
    found = VERDICT_ID.fullmatch(text)
    return None if found is None else (int(found[1]), int(found[2]), found[3], found[4])
