"""A report as JUnit XML, which continuous integration knows how to show: a test a claim.

A claim that is not held against the implementation is skipped there, whatever it found.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET

from isograde.report import words
from isograde.report.record import Report, Summary


def junit(report: Report) -> str:
    """The report as JUnit XML."""
    judged = [summary for summary in report.summaries.values() if summary.judged]
    failures = sum(_fails(summary) for summary in judged)
    skipped = sum(not _fails(summary) and summary.state != "pass" for summary in judged)
    counts = {"tests": str(len(judged)), "failures": str(failures), "skipped": str(skipped)}
    root = ET.Element("testsuites", counts)
    suite = ET.SubElement(root, "testsuite", {"name": report.name, **counts})
    if report.footer is None:
        ET.SubElement(root, "testsuite", {"name": "the report was cut off", "errors": "1"})
    for summary in judged:
        _add(suite, report, summary)
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, "unicode") + "\n"


def _fails(summary: Summary) -> bool:
    """Whether the claim is a failed test."""
    return summary.state == "fail" and bool(summary.claim["held"])


def _add(suite: ET.Element, report: Report, summary: Summary) -> None:
    """The suite has one more test."""
    names = {"classname": f"{report.name}.{summary.family}", "name": summary.id}
    test = ET.SubElement(suite, "testcase", names)
    if _fails(summary):
        failure = summary.failure
        assert failure is not None
        told = ET.SubElement(test, "failure", {"message": failure.detail})
        told.text = "\n".join(
            [
                str(summary.claim["rule"]),
                words.counted(summary),
                f"smallest case: {failure.case}, {failure.samples} samples",
                words.reproduce(report, summary),
            ]
        )
    elif summary.state != "pass":
        why = "not claimed" if summary.state == "fail" else summary.state
        ET.SubElement(test, "skipped", {"message": f"{why}: {words.counted(summary)}"})
