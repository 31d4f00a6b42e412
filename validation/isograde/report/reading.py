"""A report read back: each claim over all cases, the ladder, and what the level reached rests on.

A level is reached when every claim of it that can be said of the implementation's kinds and family
holds on evidence: it passed on some case, failed on none in general position, and the declaration
does not take it out of what is promised; and when the level below is reached. Level 0 also asks
that known bodies came out for every declared kind that has some. Failures on fields with ties do
not change the level; whether it holds with ties too is said beside it. A run of a part of the
claims or cases reaches no level.

Glossary
--------
evidence   findings that could have been failures: pass, fail, error, crash, timeout
general    the field is in general position: nothing about its level set hangs on rounding
rung       one level of the ladder
short      a field that fails a rung, or on which the rung could not be judged
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from dataclasses import field as fresh
from functools import cached_property
from pathlib import Path
from sys import intern
from typing import Any, NamedTuple

import numpy as np

from isograde.adapters.texts import clean
from isograde.errata import Erratum, errata_of, verdict_id
from isograde.expectations import EVERY, Expected
from isograde.model import BAD, EVIDENCE, LEVELS, Kind, Verdict
from isograde.report.lines import JSON, ReportError, lines

# Claims about input that is no field: measured and shown, and of no effect on the exit status.
CONVENTIONS = frozenset({"robustness.bad_input", "robustness.nan"})
BODIES = "bodies"
# Claims that a choice is always made one way: who does not promise one is free to choose.
CHOICES = frozenset({"cells.separate", "cells.join", "cells.mean"})
# Verdicts of a case that is evidence, had it been judged.
UNJUDGED = (Verdict.UNSUPPORTED, Verdict.NOT_RUN)
# A text that is shorter is never cut.
SHORT = 200
# As it stands in a line.
PASSED = Verdict.PASS.value


@dataclass(frozen=True)
class Failure:
    """The smallest case on which a claim failed; `of` is the case it is a block of, or empty."""

    case: str
    samples: int
    detail: str
    numbers: Mapping[str, Any]
    of: str = ""
    tied: bool = False
    expected: bool = False


@dataclass
class Summary:
    """One claim over all cases.

    counts, general, tied : verdicts on all fields, on those in general position, on the others
    passed_of, unjudged_of : the kinds of which some case passed, or could not be judged
    reasons : why a finding is neither pass nor failure, with how often
    """

    claim: JSON
    counts: Counter[str] = fresh(default_factory=Counter)
    general: Counter[str] = fresh(default_factory=Counter)
    tied: Counter[str] = fresh(default_factory=Counter)
    passed_of: set[Kind] = fresh(default_factory=set)
    unjudged_of: set[Kind] = fresh(default_factory=set)
    failure: Failure | None = None
    reasons: Counter[str] = fresh(default_factory=Counter)

    @property
    def id(self) -> str:
        """The claim's id."""
        return str(self.claim["id"])

    @property
    def family(self) -> str:
        """The first part of the claim's id."""
        return self.id.split(".")[0]

    @property
    def level(self) -> int | None:
        """The claim's level, or None beside the ladder."""
        level: int | None = self.claim["level"]
        return level

    @property
    def promised(self) -> bool:
        """A failure is held against the implementation."""
        return bool(self.claim["promised"])

    @property
    def passed(self) -> int:
        """Cases on which it holds."""
        return self.counts[Verdict.PASS]

    @property
    def bad(self) -> int:
        """Cases on which something went wrong."""
        return bad_in(self.counts)

    @property
    def evidence(self) -> int:
        """Cases on which it could fail."""
        return self.passed + self.bad

    @property
    def asked(self) -> int:
        """All findings."""
        return sum(self.counts.values())

    @property
    def kinds(self) -> list[Kind]:
        """The declared kinds of which the claim can be said."""
        return [Kind(*kind) for kind in self.claim["kinds"]]

    @property
    def state(self) -> str:
        """One word: fail, choice, pass, unsupported, or no evidence."""
        if self.bad:
            return "choice" if self.id in CHOICES and not self.promised else "fail"
        if self.passed:
            return "pass"
        return "unsupported" if self.counts[Verdict.UNSUPPORTED] else "no evidence"

    @property
    def only_with_ties(self) -> bool:
        """It fails, and only on fields with ties."""
        return bool(self.bad) and self.bad == bad_in(self.tied)


def bad_in(counts: Mapping[str, int]) -> int:
    """Findings that say something went wrong."""
    return sum(counts.get(verdict.value, 0) for verdict in BAD)


class Short(NamedTuple):
    """Fields in general position that are short of a rung."""

    failed: int
    unjudged: int
    fields: int

    @property
    def share(self) -> float:
        """The part of the fields that is short; 1 where there is no field."""
        return (self.failed + self.unjudged) / self.fields if self.fields else 1.0


@dataclass
class Rung:
    """One level of the ladder.

    bodiless : the kinds of which no known body came out; they count at level 0
    """

    level: int
    name: str
    promise: str
    summaries: list[Summary]
    bodiless: list[Kind] = fresh(default_factory=list)

    @property
    def failing(self) -> list[Summary]:
        """Claims that fail in general position."""
        return [summary for summary in self.summaries if bad_in(summary.general)]

    @property
    def failing_with_ties(self) -> list[Summary]:
        """Claims that fail on fields with ties."""
        return [summary for summary in self.summaries if bad_in(summary.tied)]

    @property
    def lacking(self) -> list[Summary]:
        """Claims that passed nowhere, or nowhere for a kind whose cases could not be judged."""
        return [s for s in self.summaries if not s.passed or s.unjudged_of - s.passed_of]

    @property
    def withdrawn(self) -> list[Summary]:
        """Claims that the declaration takes out of what is promised."""
        return [summary for summary in self.summaries if summary.claim["withdrawn"]]

    @property
    def state(self) -> str:
        """One word: fail, no evidence, not promised, or pass."""
        if self.failing:
            return "fail"
        if self.lacking or self.bodiless or not self.summaries:
            return "no evidence"
        return "not promised" if self.withdrawn else "pass"


@dataclass
class Report:
    """A report read back."""

    header: JSON
    claims: dict[str, JSON] = fresh(default_factory=dict)
    cases: dict[str, JSON] = fresh(default_factory=dict)
    results: list[JSON] = fresh(default_factory=list)
    evidence: dict[str, JSON] = fresh(default_factory=dict)
    footer: JSON | None = None
    # What one page made of the report and another may need again, such as its causes.
    memory: dict[str, Any] = fresh(default_factory=dict)

    @property
    def records(self) -> Iterator[JSON]:
        """The lines of the report, in their order."""
        yield self.header
        yield from self.claims.values()
        for result in self.results:
            yield self.cases[result["case"]]
            yield result
        yield from self.evidence.values()
        if self.footer is not None:
            yield self.footer

    @property
    def declaration(self) -> JSON:
        """What the implementation declares."""
        declared: JSON = self.header["declaration"]
        return declared

    @property
    def name(self) -> str:
        """The implementation's name."""
        return str(self.declaration["name"])

    @property
    def spec(self) -> str:
        """How the implementation was named on the command line."""
        return str(self.header["spec"])

    @property
    def kinds(self) -> list[Kind]:
        """The kinds that the implementation takes."""
        return [Kind(*kind) for kind in self.header["kinds"]]

    @property
    def partial(self) -> bool:
        """The run was of a part of the claims or cases, or stopped before the end."""
        return bool(self.header["only"] or self.stopped or "shard" in self.header)

    @property
    def stopped(self) -> JSON | None:
        """Why the run stopped before the end, and how many cases are left; None for a whole run."""
        return None if self.footer is None else self.footer.get("stopped")

    @property
    def plan(self) -> int:
        """The version of the plan; 1 for reports from before versions were kept."""
        return int(self.header.get("plan", 1))

    def verdict_id(self, claim: str, case: str) -> str:
        """The id of a verdict of this report."""
        return verdict_id(self.plan, int(self.header["seed"]), claim, case)

    def errata(self, claim: str, case: str) -> list[Erratum]:
        """What was found to be wrong with a verdict since."""
        return errata_of(self.plan, claim, case)

    @cached_property
    def summaries(self) -> dict[str, Summary]:
        """Each claim over all cases, by id."""
        summaries = {name: Summary(claim) for name, claim in self.claims.items()}
        for result in self.results:
            kind = Kind(*self.cases[result["case"]]["kind"])
            for name, verdict, finding in findings_of(result):
                summary = summaries[name]
                summary.counts[verdict] += 1
                if result["general"] is not None:
                    (summary.general if result["general"] else summary.tied)[verdict] += 1
                if verdict in UNJUDGED:
                    summary.unjudged_of.add(kind)
                if finding is None:
                    summary.passed_of.add(kind)
                else:
                    self._explain(summary, result, finding)
        for name, record in self.evidence.items():
            found, samples = record["finding"], int(np.prod(record["shape"]))
            summaries[name].failure = Failure(
                record["case"], samples, found["detail"], found.get("numbers", {}), record["of"]
            )
        return summaries

    def _explain(self, summary: Summary, result: JSON, finding: JSON) -> None:
        """The summary knows why a finding is no pass; what was not expected comes first."""
        if finding["verdict"] not in BAD:
            summary.reasons[finding["detail"]] += 1
            return
        samples, tied = self.cases[result["case"]]["samples"], not result["general"]
        listed = self.expected.get(summary.id)
        expected = listed is not None and listed.covers(result["case"])
        known = summary.failure
        size = (expected, tied, samples)
        if known is None or size < (known.expected, known.tied, known.samples):
            numbers = finding.get("numbers", {})
            found = Failure(result["case"], samples, finding["detail"], numbers, "", tied, expected)
            summary.failure = found

    @cached_property
    def top(self) -> int:
        """The highest level of its family that has claims for its kinds."""
        levels = [s.level for s in self.summaries.values() if s.level is not None]
        top: int = self.header["top"]
        return top if self.partial or not levels else min(top, max(levels))

    @cached_property
    def rungs(self) -> list[Rung]:
        """The ladder, up to the top of the implementation's family."""
        return [
            Rung(level, name, promise, self._of_level(level), self._bodiless() if not level else [])
            for level, (name, promise) in LEVELS.items()
            if level <= self.top
        ]

    def _of_level(self, level: int | None) -> list[Summary]:
        """The summaries of one level."""
        return [s for s in self.summaries.values() if s.level == level]

    def _bodiless(self) -> list[Kind]:
        """The kinds of which no known body came out, though some claim on bodies is stated."""
        bodies = [s for s in self.summaries.values() if s.family == BODIES]
        wanted = {kind for summary in bodies for kind in summary.kinds} or set(self.kinds)
        passed = {kind for summary in bodies for kind in summary.passed_of}
        return sorted(wanted - passed)

    @property
    def unbodied(self) -> list[Kind]:
        """The declared kinds of which no known body is kept, where others are judged by theirs."""
        stated = {kind for s in self.summaries.values() if s.family == BODIES for kind in s.kinds}
        return [kind for kind in self.kinds if kind not in stated] if stated else []

    @property
    def beside(self) -> list[Summary]:
        """The claims beside the ladder."""
        return self._of_level(None)

    @cached_property
    def reached(self) -> int | None:
        """The highest level that holds with all levels below it; None when not even the lowest."""
        if self.partial:
            return None
        reached = None
        for rung in self.rungs:
            if rung.state != "pass":
                break
            reached = rung.level
        return reached

    @property
    def next_rung(self) -> Rung | None:
        """The rung above the level reached, or in a run of a part the first that fails; or None."""
        if self.partial:
            return next((rung for rung in self.rungs if rung.state == "fail"), None)
        height = 0 if self.reached is None else self.reached + 1
        return self.rungs[height] if height < len(self.rungs) else None

    @property
    def with_ties(self) -> bool | None:
        """The level reached holds with ties too; None where no field with ties is evidence."""
        if self.reached is None:
            return None
        held = [s for rung in self.rungs[: self.reached + 1] for s in rung.summaries]
        if any(bad_in(summary.tied) for summary in held):
            return False
        return True if any(summary.tied[Verdict.PASS] for summary in held) else None

    @cached_property
    def judged(self) -> tuple[int, int]:
        """Of the cases on which claims up to the level reached were asked, how many were judged."""
        names = {s.id for rung in self.rungs[: (self.reached or 0) + 1] for s in rung.summaries}
        states = [_judged(result, names) for result in self.results]
        return states.count("judged"), len(states) - states.count("")

    def short_of(self, level: int) -> Short:
        """The fields in general position that are short of this level's rung."""
        shorts: dict[int, Short] = self.memory.setdefault("short", {})
        if level not in shorts:
            shorts[level] = self._short_of(level)
        return shorts[level]

    def _short_of(self, level: int) -> Short:
        """The same, computed."""
        names = {summary.id for summary in self._of_level(level)}
        general = [result for result in self.results if result["general"]]
        states = [_judged(result, names) for result in general]
        failed = sum(any(name in names for name, _, _ in bad_of(result)) for result in general)
        return Short(failed, states.count("unjudged"), len(states) - states.count(""))

    @property
    def withdrawn(self) -> list[str]:
        """Claims that the declaration takes out of what is promised."""
        return [summary.id for summary in self.summaries.values() if summary.claim["withdrawn"]]

    @property
    def failures(self) -> list[Summary]:
        """Claims that failed and are promised, then those that are not."""
        failed = [summary for summary in self.summaries.values() if summary.state == "fail"]
        return sorted(failed, key=lambda summary: not summary.promised)

    @property
    def promised(self) -> list[Summary]:
        """What the exit status depends on: promised claims, those on bad input apart."""
        return [s for s in self.summaries.values() if s.promised and s.id not in CONVENTIONS]

    @property
    def broken(self) -> list[Summary]:
        """The promised claims that failed on some case."""
        return [summary for summary in self.promised if summary.bad]

    @cached_property
    def expected(self) -> dict[str, Expected]:
        """The failures that were known beforehand, by claim."""
        return {
            name: Expected(said["reason"], tuple(said["cases"]))
            for name, said in self.header.get("expected", {}).items()
        }

    @cached_property
    def bad_cases(self) -> dict[str, list[str]]:
        """The cases on which each claim is bad."""
        found: dict[str, list[str]] = {}
        for result in self.results:
            for name, _, _ in bad_of(result):
                found.setdefault(name, []).append(result["case"])
        return found

    @property
    def unexpected(self) -> dict[str, list[str]]:
        """The cases on which a promised claim failed, and was not expected to."""
        found = {}
        for summary in self.broken:
            known = self.expected.get(summary.id)
            bad = self.bad_cases[summary.id]
            left = [case for case in bad if known is None or not known.covers(case)]
            if left:
                found[summary.id] = left
        return found

    @property
    def mended(self) -> dict[str, list[str]]:
        """The cases on which a claim was expected to fail, and held."""
        held: dict[str, list[str]] = {name: [] for name in self.expected}
        for result in self.results:
            for name in set(result["passed"]) & held.keys():
                known = self.expected[name]
                if known.covers(result["case"]) and (known.cases != (EVERY,)):
                    held[name].append(result["case"])
        for name, known in self.expected.items():
            summary = self.summaries.get(name)
            if known.cases == (EVERY,) and summary is not None and summary.state == "pass":
                held[name] = [EVERY]
        return {name: cases for name, cases in held.items() if cases}

    @property
    def unproven(self) -> list[Summary]:
        """The promised claims without evidence."""
        return [summary for summary in self.promised if not summary.evidence]

    @property
    def has_evidence(self) -> bool:
        """A promised claim could have failed, and in a full run a known body was judged."""
        proven = any(summary.evidence for summary in self.promised)
        bodies = any(s.evidence for s in self.summaries.values() if s.family == BODIES)
        return proven and (self.partial or bodies)

    @property
    def measured(self) -> list[tuple[str, str, JSON]]:
        """Claim, case and figures of every order that was measured."""
        return [
            (claim, result["case"], numbers)
            for result in self.results
            for claim, numbers in result["measured"].items()
            if "order" in numbers
        ]

    def figures_of(self, claim: str) -> list[JSON]:
        """What was measured of this claim, case by case."""
        every = (result["measured"].get(claim) for result in self.results)
        return [numbers for numbers in every if numbers]


def findings_of(result: JSON) -> Iterator[tuple[str, str, JSON | None]]:
    """Claim, verdict, and of what is no pass the finding."""
    for name in result["passed"]:
        yield name, PASSED, None
    for finding in result["findings"]:
        yield finding["claim"], finding["verdict"], finding


def bad_of(result: JSON) -> Iterator[tuple[str, str, JSON]]:
    """Claim, verdict and finding of what went wrong on a case."""
    for finding in result["findings"]:
        if finding["verdict"] in BAD:
            yield finding["claim"], finding["verdict"], finding


def _judged(result: JSON, names: set[str]) -> str:
    """Whether the claims of these names were judged on a case; nothing where it is no evidence."""
    if not names.isdisjoint(result["passed"]):
        return "judged"
    said = {finding["verdict"] for finding in result["findings"] if finding["claim"] in names}
    if not said.isdisjoint(EVIDENCE):
        return "judged"
    return "" if said.isdisjoint(UNJUDGED) else "unjudged"


def read(path: Path) -> Report:
    """The report in a file. Raises `ReportError`; a missing footer is no error, but `None`."""
    return gather(lines(path), str(path))


def gather(records: Iterable[JSON], place: str = "the report") -> Report:
    """The report these records make. Raises `ReportError` where they do not begin with a header."""
    report: Report | None = None
    for record in records:
        try:
            record = fit(record)
        except RecursionError:
            raise ReportError(f"{place} has a line that is nested too deeply") from None
        if record["record"] == "header":
            if report is not None:
                raise ReportError(f"{place} has two headers: it is two reports in one file")
            report = Report(record)
        elif report is None:
            raise ReportError(f"{place} does not begin with a header")
        else:
            if told := _unknown(report, record):
                raise ReportError(f"{place}: {told}, which has no line of its own before")
            _add(report, record)
    if report is None:
        raise ReportError(f"{place} is empty")
    return report


def fit(value: Any) -> Any:
    """The value with every text in it fit for a page: cut, and unfit characters spelt out.

    A report may have been written by another version, or by hand.
    """
    if isinstance(value, str):
        # Names of claims stand in thousands of lines: keep each once.
        return intern(value) if _is_plain(value) else clean(value)
    if isinstance(value, dict):
        return {key: fit(item) for key, item in value.items()}
    if isinstance(value, list):
        # Most are the names of claims that passed, or numbers.
        plain = all(map(NUMBERS.__contains__, map(type, value)))
        return value if plain else [fit(item) for item in value]
    return value


NUMBERS = frozenset({int, float, bool})


def _is_plain(text: str) -> bool:
    """It is known at a glance to need no cleaning: most texts, but not all that need none."""
    return len(text) < SHORT and text.isascii() and text.isprintable()


def _unknown(report: Report, record: JSON) -> str:
    """What a record speaks of that no record before it has introduced, or nothing."""
    if record["record"] == "result":
        if record["case"] not in report.cases:
            return f"a result on the case {record['case']!r:.80}"
        named = [*record["passed"], *record["measured"]]
        named += [one["claim"] for one in record["findings"]]
        strange = [name for name in named if name not in report.claims]
        return f"a result of the claim {strange[0]!r:.80}" if strange else ""
    if record["record"] == "evidence" and record["claim"] not in report.claims:
        return f"evidence of the claim {record['claim']!r:.80}"
    return ""


def _add(report: Report, record: JSON) -> None:
    """The report has one more record."""
    name = record["record"]
    if name == "claim":
        report.claims[record["id"]] = record
    elif name == "case":
        report.cases[record["id"]] = record
    elif name == "result":
        report.results.append(record)
    elif name == "evidence":
        report.evidence[record["claim"]] = record
    else:
        report.footer = record


def results_tagged(report: Report, tag: str) -> Sequence[JSON]:
    """The results of cases that have this tag."""
    return [one for one in report.results if tag in report.cases[one["case"]]["tags"]]
