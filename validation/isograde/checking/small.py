"""The claims of levels 0 to 2, judged on the smallest cases under the declaration to paste.

They are judged as the implementation was measured to be, not as it says: what it says wrongly was
told before, and what still fails is wrong beside that.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from isograde.adapters.conventions import to_house
from isograde.adapters.process import ProcessAdapter
from isograde.checking.checked import Advice
from isograde.checking.rows import CORNERS, row_told
from isograde.checking.spans import LONG
from isograde.declaration import Declaration
from isograde.model import BAD, Case, Claim, Kind, Limits, Outcome, Request, Verdict
from isograde.within import Within

# Judge so many small cases of each kind, fewer only of who takes longer than these seconds for its
# answers to them: how busy a machine is shall not change what is said.
CASES_TRIED, SECONDS = 200, 2.5
# Claims of a declared level up to this are judged on small cases.
HIGHEST = 2
# Samples of a known body that is small enough here.
LARGEST_BODY = 5_000
# Families with cases of a few samples, quickly listed.
QUICK = ("cells", "ties", "noise", "contours", "curves", "simplices")
# What takes longer than all other claims together, and on how many cases it is judged.
SLOW, SLOW_CASES = ("geometry.embedded",), 3
# Conventions that are judged by claims of their own, which ask variants.
CONVENTIONS = ("robustness.nan", "robustness.out_of_range")
CONVENTION_CASES = 6
TIED = "; on fields with samples equal to the isovalue only"
# What claims on small cases say where a long field showed a fault.
SHORTER = f"; what is wrong above was seen on a longer field, of {LONG} samples along that axis"
# What a hole is, where no cell alone is at fault.
BETWEEN_CELLS = (
    "; each row of the table is right alone, so two cells join the crossings of an ambiguous face "
    "between them in different ways, or do not share its vertices"
)
# What crowded edges are, where a cell has one vertex.
ONE_VERTEX = (
    "; where two sheets of the surface pass through one cell, or through the face between two, one "
    "vertex stands for both: give each sheet its own"
)


@dataclass
class Under:
    """An adapter whose answers are converted from other conventions than it declares.

    seconds : that the calls took so far
    """

    adapter: ProcessAdapter
    declaration: Declaration
    seconds: float = 0.0

    def open(self, limits: Limits) -> Declaration:
        """What it is taken to declare; it is open already."""
        del limits
        return self.declaration

    def run(self, request: Request) -> Outcome:
        """The outcome of one call, in the house's conventions."""
        outcome = self.adapter.answer(request)
        self.seconds += outcome.seconds
        return to_house(outcome, request, self.declaration.conventions)

    def close(self) -> None:
        """Nothing: whoever opened it closes it."""


def small_cases(
    adapter: ProcessAdapter,
    declaration: Declaration,
    kind: Kind,
    held: Declaration,
    rows: bool | None = None,
    within: Within | None = None,
    *,
    ended: bool = False,
) -> Iterator[Advice]:
    """What claims of levels 0 to 2 say of the smallest cases, most faults first.

    `declaration` is what it is judged by, `held` what it promised itself; `rows` says
    whether each configuration of a cell alone is right, where that is known; cases are posed
    `within` limits; `ended` says that a longer field showed a seam or an end.
    """
    # Import what judges only here: who made a mistake above shall not wait for it.
    from isograde.cases import FAMILIES
    from isograde.runner import Task, Worker, claims_for

    measured = {} if within is None else within.limits
    only = replace(declaration.limits, kinds=((kind.n, kind.m),), **measured)
    declared = replace(declaration, limits=only)
    claims = {name: one for name, one in claims_for(declared).items() if _asked(one)}
    listed = [case for name in QUICK for case in FAMILIES[name].cases(0)]
    if not any(case.kind == kind for case in listed):
        # Of a kind of which no family is quick, the known bodies are the smallest there are.
        listed = [case for case in FAMILIES["bodies"].cases(0) if case.samples <= LARGEST_BODY]
    cases = {case.id: case for case in listed if case.kind == kind}
    under = Under(adapter, declared)
    worker = Worker(under, declared, cases, claims)
    bad: dict[str, list[tuple[Case, Advice]]] = {}
    judged, general = 0, list[str]()
    for turn, case in enumerate(_smallest(cases.values())):
        if under.seconds > SECONDS:
            break
        asked = tuple(
            name for name, one in claims.items() if one.applies_to(case) and _in_turn(name, turn)
        )
        said_of = worker.judge(Task(case.id, asked))
        found = said_of.findings
        general += [case.id] if said_of.general else []
        judged += any(one.verdict in (Verdict.PASS, *BAD) for one in found.values())
        for name, one in found.items():
            if one.verdict in BAD:
                said = (one.verdict, f"{case.id}: {one.detail}")
                bad.setdefault(name, []).append((case, said))
    if rows is False and bad:
        failing = ", ".join(f"{name} ({len(bad[name])})" for name in sorted(bad))
        told = f"{kind}: with such rows {len(bad)} claims fail on {judged} small cases: {failing}"
        yield Verdict.FAIL, told
        bad = {}
    for name in sorted(bad, key=lambda name: -len(bad[name])):
        dual = declared.vertices == "cells"
        verdict, told = _of_one_claim(kind, name, bad[name], judged, dual=dual)
        tied = not any(case.id in general for case, _ in bad[name])
        between = BETWEEN_CELLS if rows and name == "topology.closed" else ""
        told += "" if ended and name == "topology.closed" else TIED if tied else between
        promised = claims[name].held(held)
        yield (verdict, told) if promised else (Verdict.SKIP, f"{told} (not promised)")
    if judged and len(bad) < len(claims) and rows is not False:
        hold = f"{len(claims) - len(bad)} of {len(claims)} claims of levels 0 to {HIGHEST} hold"
        short = SHORTER if ended else ""
        yield Verdict.PASS, f"{kind}: {hold} on {judged} small cases{short}"
    if not judged:
        yield Verdict.UNSUPPORTED, f"{kind}: no small case could be judged"


def _asked(claim: Claim) -> bool:
    """Whether a claim is judged here."""
    if claim.id in CONVENTIONS:
        return True
    return claim.level is not None and claim.level <= HIGHEST and not claim.variants


def _in_turn(name: str, turn: int) -> bool:
    """Whether a claim is judged on the case of this turn."""
    if name in SLOW:
        return turn < SLOW_CASES
    return name not in CONVENTIONS or turn < CONVENTION_CASES


def _of_one_claim(
    kind: Kind, name: str, failed: list[tuple[Case, Advice]], judged: int, *, dual: bool
) -> Advice:
    """One sentence on a claim that fails; where that is on single cells, with a row.

    `dual` : its vertices are in cells, so no row of a table is at fault
    """
    case, (verdict, told) = next((one for one in failed if _is_cell(one[0])), failed[0])
    told = f"{kind}: {name} fails on {len(failed)} of {judged} small cases; {told}"
    if dual:
        return verdict, told + (ONE_VERTEX if name == "topology.manifold" else "")
    return verdict, f"{told} ({_row(case)})" if _is_cell(case) else told


def _is_cell(case: Case) -> bool:
    """Whether this is one cell in a border."""
    return case.id.startswith("cells/")


def _row(case: Case) -> str:
    """The row of the table that a case of the family "cells" is about."""
    bits = int(case.id[-3:])
    inside = frozenset((x, y, z) for x, y, z in CORNERS if bits >> (x + 2 * y + 4 * z) & 1)
    return row_told(inside) if inside else "no inside corner"


def _smallest(cases: Iterable[Case]) -> list[Case]:
    """The smallest cases of every family, in turn, those that always run."""
    families: dict[str, list[Case]] = {}
    for case in cases:
        if "full" not in case.tags:
            families.setdefault(case.id.split("/")[0], []).append(case)
    for members in families.values():
        # Of cells, one of each class under rotations comes first.
        members.sort(key=lambda case: (case.samples, "posed" not in case.tags))
    found: list[Case] = []
    turns = max((len(members) for members in families.values()), default=0)
    for turn in range(turns):
        found += [members[turn] for members in families.values() if turn < len(members)]
        if len(found) >= CASES_TRIED:
            break
    return found[:CASES_TRIED]
