"""What became of an implementation from version to version: what was mended, what broke.

Reports of the same name, of the same part of the same plan, are laid beside each other in the order
of their versions. A *step* from one to the next lists the claims that some case no longer fails, or
fails now (`isograde.report.comparison.changes`).
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from isograde.report.comparison import Change, changes, unlike
from isograde.report.reading import Report


@dataclass(frozen=True)
class Version:
    """One version: its page, cases that break a promise, of how many, and claims that fail."""

    name: str
    version: str
    link: str
    bad: int
    fields: int
    claims: int


@dataclass(frozen=True)
class Step:
    """From one version to the next."""

    before: Version
    after: Version
    changes: tuple[Change, ...]

    @property
    def broken(self) -> tuple[Change, ...]:
        """Claims that fail on a case on which they held before."""
        return tuple(change for change in self.changes if change.broken)

    @property
    def mended(self) -> tuple[Change, ...]:
        """Claims that hold on a case on which they failed before."""
        return tuple(change for change in self.changes if change.mended)


@dataclass(frozen=True)
class Trend:
    """An implementation over its versions, the oldest first, all graded on one plan."""

    name: str
    plan: int
    versions: tuple[Version, ...]
    steps: tuple[Step, ...]


def trends(found: Sequence[tuple[Report, str]]) -> list[Trend]:
    """The trends of these reports, each with its page; raises ValueError for unlike plans."""
    groups: dict[str, list[tuple[Report, str]]] = {}
    for report, link in found:
        groups.setdefault(report.name, []).append((report, link))
    return [_trend(name, group) for name, group in sorted(groups.items())]


def _trend(name: str, group: Sequence[tuple[Report, str]]) -> Trend:
    """The trend of one implementation."""
    if told := unlike([report for report, _ in group]):
        raise ValueError(f"{name}: {told}")
    ordered = sorted(group, key=lambda one: _order(str(one[0].declaration["version"])))
    versions = [_version(report, link) for report, link in ordered]
    steps = [
        Step(old, new, tuple(changes(before, after)))
        for (old, new), ((before, _), (after, _)) in zip(
            pairwise(versions), pairwise(ordered), strict=True
        )
    ]
    return Trend(name, group[0][0].plan, tuple(versions), tuple(steps))


def _version(report: Report, link: str) -> Version:
    """What is told of one version."""
    promised = {summary.id for summary in report.promised}
    bad = {case for claim, cases in report.bad_cases.items() if claim in promised for case in cases}
    failing = sum(summary.bad > 0 for summary in report.promised)
    return Version(
        report.name,
        str(report.declaration["version"]),
        link,
        len(bad),
        len(report.results),
        failing,
    )


def _order(version: str) -> tuple[int, ...]:
    """The numbers of a version.

    >>> sorted(["0.1.10", "0.1.9"], key=_order)
    ['0.1.9', '0.1.10']
    """
    return tuple(int(number) for number in re.findall(r"\d+", version))
