"""Claims as tests of pytest: one test a claim, in one's own test file or by the plug-in.

::

    import isograde
    from mymodule import extract

    @isograde.parametrize_with_claims(
        [extract], expected_failures={"topology.manifold": "touching sheets, see issue 12"}
    )
    def test_my_extractor(implementation, claim):
        claim(implementation)

A test passes where its claim holds, and fails with the smallest case and the command or call that
repeats it. It is skipped where there is no evidence, or where a claim that is not promised fails;
known bodies need evidence. A failure that is expected, and no other, is an xfail with its reason;
where it does not happen any more, pytest says XPASS, which `xfail_strict` or ``strict=True`` makes
a failure.

One open process serves all claims of an implementation, and small answers are kept, so that each
claim costs little beside its judging.
"""

from __future__ import annotations

import atexit
import fnmatch
import os
import tempfile
from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from isograde import grading
from isograde.adapters.child import MARK
from isograde.adapters.functions import Implementation, name_of, named
from isograde.expectations import FIRM, Expected, Given, expectations
from isograde.model import Claim
from isograde.report import words
from isograde.report.reading import CONVENTIONS, Report, Summary
from isograde.results import Grade
from isograde.runner import Options, Worker, plan

Only = tuple[str, ...]  # Globs on ids of claims or of cases.


class ClaimFailed(AssertionError):  # noqa: N818 - what failed is the claim
    """A claim does not hold; the message has the smallest case and how to repeat it."""


class FailedAsExpected(ClaimFailed):
    """A claim fails on cases on which it was expected to, and on no other."""


@dataclass
class Judge:
    """An implementation that is asked one claim after another, by one process.

    judged : the grades found until now, by claim
    """

    spec: str
    worker: Worker
    options: Options
    folder: Path
    judged: dict[str, Grade]

    @classmethod
    def open(cls, implementation: Implementation, only: Only, stack: ExitStack) -> Judge:
        """A judge that is closed with the stack. Raises `AdapterError`."""
        spec = stack.enter_context(named(implementation))
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="isograde-")))
        options = Options(only=only)
        worker = Worker.open(spec, options)
        worker.keeps = True
        stack.callback(worker.adapter.close)
        return cls(spec, worker, options, folder, {})

    @property
    def claims(self) -> list[Claim]:
        """The claims that some case of the plan is for. Raises `NothingToRun`."""
        tasks = plan(self.options, self.worker.cases, self.worker.claims)
        asked = {name for task in tasks for name in task.claims}
        return [claim for name, claim in self.worker.claims.items() if name in asked]

    @property
    def _cases(self) -> Only:
        """The globs that choose cases, without those that choose claims."""
        return tuple(
            one for one in self.options.only if not fnmatch.filter(self.worker.claims, one)
        )

    def grade(self, claim: str, expected: Expected | None = None) -> Grade:
        """What was found of one claim."""
        if claim not in self.judged:
            known = {} if expected is None else {claim: expected}
            options, path = Options(only=(claim, *self._cases)), self.folder / "report.jsonl"
            how = grading.Manner(resume=False, expected=known)
            report = grading.graded_by(self.worker, self.spec, options, path, how=how)
            self.judged[claim] = Grade(report)
        return self.judged[claim]


# The judges of this process, by implementation and choice; closed when it ends.
_JUDGES: dict[tuple[Any, Only], Judge] = {}
_OPEN = ExitStack()
atexit.register(_OPEN.close)


def judge_of(implementation: Implementation, only: Only) -> Judge:
    """The open judge of an implementation. Raises `AdapterError`."""
    if (implementation, only) not in _JUDGES:
        _JUDGES[implementation, only] = Judge.open(implementation, only, _OPEN)
    return _JUDGES[implementation, only]


@dataclass(frozen=True)
class ClaimTest:
    """One claim as a test: called with an implementation, it is silent where the claim holds."""

    id: str
    expected: Expected | None = None
    only: Only = ()

    def __call__(self, implementation: Implementation) -> None:
        """Nothing where the claim holds.

        Raises
        ------
        ClaimFailed
            where it fails, or where no known body was judged; `FailedAsExpected` where it fails as
            was expected.
        pytest.skip.Exception
            where there is no evidence, or where it fails and is not promised.
        """
        __tracebackhide__ = True
        report = judge_of(implementation, self.only).grade(self.id, self.expected).report
        summary = report.summaries[self.id]
        if summary.bad:
            self._failed(report, summary)
        elif not summary.evidence and self.id.startswith(FIRM):
            raise ClaimFailed(f"no known body was judged: {words.counted(summary)}")
        elif not summary.evidence:
            pytest.skip(f"no evidence: {_why(summary)}")

    def _failed(self, report: Report, summary: Summary) -> None:
        """Raise what a failure of the claim is."""
        __tracebackhide__ = True
        if not summary.promised or self.id in CONVENTIONS:
            pytest.skip(f"not held against it: {words.evidence(summary)}")
        if not report.unexpected:
            raise FailedAsExpected(words.evidence(summary))
        raise ClaimFailed(told(report, summary))


def _why(summary: Summary) -> str:
    """The commonest reason why there is no evidence."""
    return summary.reasons.most_common(1)[0][0] if summary.reasons else "no case was judged"


def told(report: Report, summary: Summary) -> str:
    """The rule, how often it fails, the smallest case that was not expected, how to repeat it."""
    failure = summary.failure
    assert failure is not None
    bad = report.unexpected[summary.id]
    known = len(report.bad_cases[summary.id]) - len(bad)
    return "\n".join(
        [
            str(summary.claim["rule"]),
            words.evidence(summary) + (f", {known:,} of which were expected" if known else ""),
            f"smallest case: {failure.case}, {failure.samples} samples",
            failure.detail,
            words.reproduce(report, summary),
        ]
    )


def parameters(
    implementation: Implementation,
    known: dict[str, Expected],
    strict: bool | None = None,
    prefix: str = "",
    only: Only = (),
) -> list[Any]:
    """One parameter of pytest for each claim of an implementation.

    Raises `AdapterError`, or `NothingToRun` where `only` leaves nothing.
    """
    marked = {} if strict is None else {"strict": strict}
    found = []
    for claim in judge_of(implementation, only).claims:
        expected = known.get(claim.id)
        marks = []
        if expected is not None:
            reason = expected.reason
            marks.append(pytest.mark.xfail(reason=reason, raises=FailedAsExpected, **marked))
        test = ClaimTest(claim.id, expected, only)
        found.append(pytest.param(implementation, test, id=f"{prefix}{claim.id}", marks=marks))
    return found


def parametrize_with_claims(
    implementations: Iterable[Implementation],
    *,
    only: Iterable[str] = (),
    expected_failures: Given = None,
    strict: bool | None = None,
) -> Callable[[Callable[..., Any]], Any]:
    """A decorator that makes a test of ``implementation`` and ``claim`` into one test a claim.

    Parameters
    ----------
    implementations : functions or names, as `isograde.grade` takes them
    only : globs on ids of claims or of cases, as ``isograde grade --only`` takes them; all by
        default, which takes about as long as a grade
    expected_failures : reasons by claim, or a file that ``isograde grade --write-expect`` wrote
    strict : an expected failure that does not happen fails; by default as ``xfail_strict`` says

    Raises
    ------
    ExpectationError
        where `expected_failures` name no claim, or a known body.
    AdapterError
        where an implementation does not start.
    NothingToRun
        where `only` leaves no claim and no case.
    """
    if MARK in os.environ:
        return lambda test: test  # The test file is imported for a function in it.
    known = expectations(expected_failures)
    listed: Sequence[Implementation] = list(implementations)
    chosen = tuple(only)
    rows = []
    for one in listed:
        name = one if isinstance(one, str) else name_of(one)
        rows += parameters(one, known, strict, f"{name}-" if len(listed) > 1 else "", chosen)
    return pytest.mark.parametrize(("implementation", "claim"), rows)
