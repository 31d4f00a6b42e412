"""Parts of one run, joined: the report that the whole would have been.

A run of ``--shard i/n`` takes every n-th case of a plan. Parts join where they are parts of one
plan (the same cases, claims and numbers, by checksum) for one implementation under one declaration,
limits and expectations, and none is missing, twice or cut off.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from isograde.causes import roots
from isograde.model import BAD, JUDGE_FAULT, Verdict
from isograde.report.lines import JSON
from isograde.report.reading import Report, findings_of, gather
from isograde.report.record import Tally

# What must be the same of all parts, with a word for it.
SAME: Mapping[str, str] = {
    "spec": "the implementation",
    "declaration": "what it declares",
    "seed": "the seed",
    "full": "--full",
    "only": "--only",
    "limits": "the limits",
    "expected": "the expected failures",
    "plan": "the version of the plan",
    "versions": "the versions of libraries",
    "fingerprint": "the implementation's file",
}


class JoinError(ValueError):
    """Reports do not join; the message says which and why."""


def join(reports: Sequence[Report], names: Sequence[str]) -> Report:
    """The report of the whole plan. Raises `JoinError`."""
    parts = _parts(reports, names)
    count = len(parts)
    results = [
        parts[turn % count].results[turn // count]
        for turn in range(sum(len(one.results) for one in parts))
    ]
    head = {key: value for key, value in parts[0].header.items() if key != "shard"}
    head["date"] = min(one.header["date"] for one in parts)
    records: list[JSON] = [head, *parts[0].claims.values()]
    for result in results:
        owner = next(one for one in parts if result["case"] in one.cases)
        records += [owner.cases[result["case"]], result]
    records += _evidence(parts, [result["case"] for result in results])
    seconds = sum(one.footer["seconds"] for one in parts if one.footer is not None)
    footer = _tally(results, parts).footer(seconds, gather(records))
    spent = [one.footer.get("spent", {}) for one in parts if one.footer is not None]
    if all(spent):
        shares = dict.fromkeys(name for one in spent for name in one)
        footer["spent"] = {name: sum(one.get(name, 0.0) for one in spent) for name in shares}
    return gather([*records, footer])


def _parts(reports: Sequence[Report], names: Sequence[str]) -> list[Report]:
    """The reports in the order of their parts, found to be all parts of one plan."""
    for one, name in zip(reports, names, strict=True):
        if "shard" not in one.header:
            raise JoinError(f"{name} is no part of a run: grade with --shard i/n")
        if one.footer is None:
            raise JoinError(f"{name} was cut off: it has no footer")
        if one.stopped is not None:
            raise JoinError(f"{name} was stopped before the end: {one.stopped['why']}")
    first = reports[0].header
    for one, name in zip(reports, names, strict=True):
        for key, word in SAME.items():
            if one.header.get(key) != first.get(key):
                raise JoinError(f"{name} and {names[0]} differ in {word}")
        if one.header["shard"]["of"] != first["shard"]["of"]:
            raise JoinError(f"{name} and {names[0]} are parts of different numbers of parts")
        if one.header["tasks"] != first["tasks"]:
            raise JoinError(f"{name} and {names[0]} are not parts of one plan: their cases differ")
    numbers = [one.header["shard"]["part"] for one in reports]
    of = first["shard"]["of"]
    if sorted(numbers) != list(range(1, of + 1)):
        missing = sorted({*range(1, of + 1)} - {*numbers})
        twice = sorted({number for number in numbers if numbers.count(number) > 1})
        said = [f"part {number} of {of} is missing" for number in missing]
        said += [f"part {number} is there more than once" for number in twice]
        raise JoinError("; ".join(said))
    return sorted(reports, key=lambda one: int(one.header["shard"]["part"]))


def _evidence(parts: Sequence[Report], order: Sequence[str]) -> list[JSON]:
    """For each failed claim the line that the whole run would have: of its smallest case."""
    place = {case: index for index, case in enumerate(order)}
    best: dict[str, tuple[tuple[bool, bool, bool, int, int], JSON]] = {}
    for one in parts:
        of = {result["case"]: result for result in one.results}
        for claim, record in one.evidence.items():
            case = record["of"] or record["case"]
            known = one.expected.get(claim)
            expected = known is not None and known.covers(case)
            general, follows = of[case]["general"], _root(of[case], claim) != claim
            samples = one.cases[case]["samples"]
            size = (expected, not general, follows, samples, place[case])
            if claim not in best or size < best[claim][0]:
                best[claim] = (size, record)
    return [record for _, record in sorted(best.values(), key=lambda one: one[0][-1])]


def _root(result: JSON, claim: str) -> str:
    """The claim from which this one's failure on a case comes."""
    failed = {
        one["claim"]: one.get("numbers", {}) for one in result["findings"] if one["verdict"] in BAD
    }
    return roots(failed)[claim]


def _tally(results: Sequence[JSON], parts: Sequence[Report]) -> Tally:
    """What was counted in all parts."""
    tally = Tally(cases=len(results), calls=sum(result["calls"] for result in results))
    for result in results:
        for _, verdict, finding in findings_of(result):
            tally.verdicts[Verdict(verdict).value] += 1
            tally.judge_faults += (finding or {}).get("detail", "").startswith(JUDGE_FAULT)
    assert sum(one.footer["cases"] for one in parts if one.footer) == tally.cases
    return tally
