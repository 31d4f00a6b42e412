"""A report as JUnit XML, which continuous integration knows how to show: a test a claim.

A claim that is not promised is skipped there, whatever it found, as is one without evidence, and
one that fails as it was expected to.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET

from isograde.adapters.texts import clean
from isograde.report import words
from isograde.report.findings import causes
from isograde.report.headline import headline
from isograde.report.reading import Report, Summary


def junit(report: Report) -> str:
    """The report as JUnit XML."""
    summaries = list(report.summaries.values())
    failures = sum(_fails(report, summary) for summary in summaries)
    skipped = sum(not _fails(report, one) and one.state != "pass" for one in summaries)
    counts = {"tests": str(len(summaries)), "failures": str(failures), "skipped": str(skipped)}
    root = ET.Element("testsuites", counts)
    suite = ET.SubElement(root, "testsuite", {"name": _plain(headline(report)), **counts})
    properties = ET.SubElement(suite, "properties")
    for name, value in words.run(report).items():
        ET.SubElement(properties, "property", {"name": name, "value": _plain(value)})
    if report.footer is None:
        ET.SubElement(root, "testsuite", {"name": "the report was cut off", "errors": "1"})
    because = {
        one.summary.id: cause for cause in causes(report) for one in cause.follows if one.wholly
    }
    said = {cause.root.id: cause.said for cause in causes(report)}
    for summary in summaries:
        told = said.get(summary.id, "")
        if cause := because.get(summary.id):
            told = f"follows from {cause.root.id}: {cause.said}"
        _add(suite, report, summary, told)
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, "unicode") + "\n"


def _fails(report: Report, summary: Summary) -> bool:
    """Whether the claim is a failed test: promised, and bad where it was not expected to be."""
    return summary.id in report.unexpected


def _add(suite: ET.Element, report: Report, summary: Summary, why: str) -> None:
    """The suite has one more test; `why` is what its failure comes from."""
    names = {"classname": _plain(f"{report.name}.{summary.family}"), "name": summary.id}
    test = ET.SubElement(suite, "testcase", names)
    if _fails(report, summary):
        failure = summary.failure
        assert failure is not None
        told = ET.SubElement(test, "failure", {"message": _plain(why)})
        told.text = _plain(
            "\n".join(
                [
                    str(summary.claim["rule"]),
                    words.counted(summary),
                    failure.detail,
                    f"smallest case: {failure.case}, {failure.samples} samples",
                    words.reproduce(report, summary),
                ]
            )
        )
    elif summary.state != "pass":
        known = report.expected.get(summary.id) if summary.bad else None
        why = f"expected to fail: {known.reason}" if known is not None else words.evidence(summary)
        ET.SubElement(test, "skipped", {"message": _plain(why)})


def _plain(text: str) -> str:
    """The text, cut, with what XML cannot hold spelt out."""
    return clean(text)
