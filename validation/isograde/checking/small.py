"""The claims of levels 0 to 2, judged on the smallest cases."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

from isograde.checking.checked import Advice
from isograde.declaration import Declaration
from isograde.model import BAD, Adapter, Kind, Verdict

# Judge so many small cases of each kind in so many seconds.
CASES_TRIED, SECONDS = 200, 5.0
# Claims of a declared level up to this are judged on small cases.
HIGHEST = 2


def small_cases(adapter: Adapter, declaration: Declaration, kind: Kind) -> Iterator[Advice]:
    """What claims of levels 0 to 2 say of the smallest cases, most faults first."""
    # Import what judges only here: who made a mistake above shall not wait for it.
    from isograde.runner import Task, Worker, cases_for, claims_for

    only = replace(declaration.limits, kinds=((kind.n, kind.m),))
    declared = replace(declaration, limits=only)
    claims = {
        name: claim
        for name, claim in claims_for(declared).items()
        if claim.level is not None and claim.level <= HIGHEST and not claim.variants
    }
    cases = cases_for(declared, 0)
    worker = Worker(adapter, declared, cases, claims)
    deadline = time.monotonic() + SECONDS
    bad: Counter[str] = Counter()
    first: dict[str, Advice] = {}
    judged = 0
    for case in _smallest(cases.values()):
        if time.monotonic() > deadline:
            break
        asked = tuple(name for name, claim in claims.items() if claim.applies_to(case))
        found = worker.judge(Task(case.id, asked)).findings
        judged += any(one.verdict in (Verdict.PASS, *BAD) for one in found.values())
        for name, one in found.items():
            if one.verdict in BAD:
                bad[name] += 1
                first.setdefault(name, (one.verdict, f"{case.id}: {one.detail}"))
    for name, count in bad.most_common():
        verdict, told = first[name]
        told = f"{kind}: {name} fails on {count} of {judged} small cases; {told}"
        if claims[name].held(declared):
            yield verdict, told
        else:
            yield Verdict.SKIP, f"{told} (not promised)"
    if judged and not bad:
        yield (
            Verdict.PASS,
            f"{kind}: {len(claims)} claims of levels 0 to {HIGHEST} hold on {judged} small cases",
        )
    if not judged:
        yield Verdict.UNSUPPORTED, f"{kind}: no small case could be judged"


def _smallest(cases: Iterable[Any]) -> list[Any]:
    """The smallest cases of every family, in turn, those that always run."""
    families: dict[str, list[Any]] = {}
    for case in cases:
        if "full" not in case.tags:
            families.setdefault(case.id.split("/")[0], []).append(case)
    for members in families.values():
        members.sort(key=lambda case: case.samples)
    found: list[Any] = []
    turns = max((len(members) for members in families.values()), default=0)
    for turn in range(turns):
        found += [members[turn] for members in families.values() if turn < len(members)]
        if len(found) >= CASES_TRIED:
            break
    return found[:CASES_TRIED]
