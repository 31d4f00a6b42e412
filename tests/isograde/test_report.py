"""A report reads back as it was written, and every page says what the lines say."""

import gzip
import json
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any, Literal

import jsonschema
import numpy as np
import pytest
from isograde.adapters.registry import READY_MADE
from isograde.claims import CLAIMS as EVERY_CLAIM
from isograde.declaration import Conventions, Declaration, declaration_from
from isograde.grading import contrast, grade
from isograde.model import SURFACES, Case, Finding, Verdict
from isograde.report import FORMATS, lines, reading, record, shown, words, write, write_whole
from isograde.report.badge import badge
from isograde.report.comparison import changes, comparison_page, markdown_table
from isograde.report.headline import headline
from isograde.report.junit import junit
from isograde.report.markdown import markdown
from isograde.report.oracles import oracles_of
from isograde.report.page import page
from isograde.report.picture import picture
from isograde.report.reading import Report
from isograde.report.snippet import calling, snippet
from isograde.runner import Evidence, Judged, Options, cases_for
from isoref.field import Field
from isoref.mesh import Mesh
from isoref.methods import extract

from tests.isograde.judging import Here
from tests.isograde.reporting import CLAIMS, body, graded, made, row


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The lines of the original marching cubes on a few pairs and noise."""
    place = tmp_path_factory.mktemp("report") / "report.jsonl"
    only = ("pairs/02*", "noise/white-5*")
    grade("isoref:lorensen-cline", Options(only=only), place, arguments=["grade"])
    return place


@pytest.fixture(scope="module")
def report(path: Path) -> Report:
    """The same, read back."""
    return reading.read(path)


def records(path: Path) -> list[lines.JSON]:
    """The records of a file, unchecked."""
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def test_every_line_fits_the_schema(path: Path) -> None:
    """The schema is itself a valid one, and each line is one of its kinds."""
    jsonschema.Draft202012Validator.check_schema(lines.schema())
    validator = jsonschema.Draft202012Validator(lines.schema())
    written = records(path)
    for name in lines.RECORDS:
        some = [line for line in written if line["record"] == name]
        assert some
        validator.validate(some[-1])


ODD: tuple[Any, ...] = (
    None,
    True,
    -1,
    0,
    1.0,
    1.5,
    7,
    1e999,
    "",
    "nan",
    [],
    {},
    [1],
    ["a.b"],
    [[1, "1"]],
)
# What JSON Schema of 2020 and of 2018, which is compiled, mean alike.
ALIKE = {
    "type", "$ref", "description", "minimum", "maximum", "items", "minItems", "maxItems", "enum",
    "additionalProperties", "required", "properties", "const", "anyOf", "pattern",
}  # fmt: skip


def damaged(value: Any, depth: int = 4) -> Iterator[Any]:
    """The value with one part exchanged for something odd, taken away or added."""
    yield from ODD
    if not depth:
        return
    if isinstance(value, dict):
        yield {**value, "odd": 1}
        for key in value:
            yield {name: item for name, item in value.items() if name != key}
            yield from ({**value, key: odd} for odd in damaged(value[key], depth - 1))
    if isinstance(value, list) and value:
        yield [*value, None]
        yield from ([*value[:-1], odd] for odd in damaged(value[-1], depth - 1))


@pytest.mark.parametrize("name", lines.RECORDS)
def test_the_compiled_schema_refuses_what_the_schema_refuses(path: Path, name: str) -> None:
    """A line is read by the compiled one; what it lets pass, the other would let pass."""
    whole = min(
        (one for one in records(path) if one["record"] == name), key=lambda one: len(str(one))
    )
    validator, verdicts = lines._validator(name), set()
    for one in damaged(whole):
        if isinstance(one, dict) and one.get("record") == name:
            try:
                lines.checked(json.dumps(one).replace("Infinity", "1e999"), "here")
            except lines.ReportError:
                passed = False
            else:
                passed = True
            assert passed == validator.is_valid(one), one
            verdicts.add(passed)
    assert verdicts == {True, False}


def test_the_schema_has_no_word_that_is_compiled_otherwise() -> None:
    """A word that the compiler does not know it would leave out."""

    def words(schema: Any) -> Iterator[str]:
        if isinstance(schema, dict):
            yield from schema
            for name, inner in schema.items():
                parts = inner.values() if name == "properties" else [inner]
                for part in parts:
                    yield from words(part)
        for inner in schema if isinstance(schema, list) else ():
            yield from words(inner)

    for definition in lines.schema()["$defs"].values():
        assert set(words(definition)) <= ALIKE


@pytest.mark.parametrize("case", ["types/bool", "types/signed", "types/float16"])
def test_samples_of_any_type_are_written_as_numbers(case: str) -> None:
    """True and false are 1 and 0, so that the evidence of a fault on them can be read."""

    def torn(values: Any, isovalue: float, spacing: Any) -> tuple[Any, Any]:
        mesh = extract(values, isovalue, spacing)
        return mesh.vertices, mesh.simplices[1:]

    declared = declaration_from({"name": "torn", "level": 1}, "torn")
    asked = [one for name, one in cases_for(declared, 0).items() if name == case]
    read = graded(Here(torn, declared), "python:it:it", asked, "topology.closed")
    shown_values = read.evidence["topology.closed"]["values"]
    assert shown_values
    assert all(type(one) in (int, float) for one in shown_values)


def test_a_report_begins_with_its_header_and_ends_with_its_footer(path: Path) -> None:
    names = [line["record"] for line in records(path)]
    assert names[0] == "header"
    assert names[-1] == "footer"
    assert names.count("case") == names.count("result") == 17


def test_the_header_holds_the_declaration_as_it_is_written(report: Report) -> None:
    """`isograde explain declaration`: the same entries, and the kinds beside them."""
    assert report.declaration["interpolant"] == "multilinear"
    assert report.declaration["limits"]["kinds"] == [[3, 1]]
    assert report.kinds == [SURFACES]
    assert report.header["top"] == 4


def test_the_counts_of_the_footer_are_those_of_the_results(report: Report) -> None:
    assert report.footer is not None
    counted: dict[str, int] = {}
    for summary in report.summaries.values():
        for verdict, count in summary.counts.items():
            counted[verdict] = counted.get(verdict, 0) + count
    assert report.footer["verdicts"] == counted
    assert report.footer["calls"] == sum(result["calls"] for result in report.results)


def test_the_page_says_where_the_time_went(report: Report) -> None:
    """Of one process with what is left of the whole; of several, only what was added over them."""
    assert report.footer is not None
    spent, seconds = report.footer["spent"], report.footer["seconds"]
    assert spent["oracles"] > 0
    assert spent["adapter"] > 0
    left = seconds - sum(spent.values())
    assert left >= -0.01  # Numbers are rounded.
    told = words.spent(report)
    assert told.startswith(f"{spent['implementation']:.1f} s the implementation, ")
    assert told.endswith(f"{max(0.0, left):.1f} s the smallest cases and the lines of the report")
    assert told in page(report)
    assert told in markdown(report)
    several = Report({**report.header, "jobs": 2}, report.claims, report.cases)
    several.footer = report.footer
    assert words.spent(several).endswith("s making the fields, added over its processes")
    several.footer = {"seconds": 1.0}  # As older reports have it, and those that went on.
    assert words.spent(several) == ""


def test_the_checksum_is_that_of_the_cases(report: Report) -> None:
    assert report.footer is not None
    assert report.footer["checksum"] == record.checksum(report)
    other = Report(report.header, report.claims, dict(list(report.cases.items())[1:]))
    assert record.checksum(other) != record.checksum(report)


def test_a_report_without_a_footer_is_read_and_known_to_be_cut_off(path: Path) -> None:
    cut = reading.gather(records(path)[:-1])
    assert cut.footer is None
    for text in (page(cut), markdown(cut), junit(cut), badge(cut)):
        assert "cut off" in text


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("{", "bad.jsonl:1 is not JSON"),
        ("[]", "is no record of a report"),
        ('{"record": "finding"}', "record 'finding'"),
        ('{"record": "footer", "cases": -1}', "is no footer record"),
        (
            '{"record":"case","id":"a/b","kind":[3,1],"samples":8,"isovalues":[0],"tags":[]}',
            "does not begin with a header",
        ),
    ],
)
def test_what_is_no_report_is_refused_with_its_place(
    text: str, message: str, tmp_path: Path
) -> None:
    bad = tmp_path / "bad.jsonl"
    bad.write_text(text, encoding="utf-8")
    with pytest.raises(lines.ReportError, match=message):
        reading.read(bad)


def test_a_file_that_is_no_archive_is_refused(tmp_path: Path) -> None:
    bad = tmp_path / "bad.jsonl.gz"
    bad.write_bytes(b"rubbish")
    with pytest.raises(lines.ReportError, match="cannot be read"):
        reading.read(bad)


def test_a_compressed_report_reads_the_same_and_is_the_same_file_each_time(tmp_path: Path) -> None:
    texts = []
    for name in ("one.jsonl.gz", "two.jsonl.gz"):
        with lines.open_text(tmp_path / name, "w") as file:
            lines.write_line(file, {"record": "x", "number": np.float32(0.5), "nan": np.nan})
        texts.append((tmp_path / name).read_bytes())
    assert texts[0] == texts[1]
    assert json.loads(gzip.decompress(texts[0])) == {"record": "x", "number": 0.5, "nan": "nan"}


def test_the_evidence_is_the_smallest_case_and_holds_its_numbers(report: Report) -> None:
    """Nielson & Hamann 1991, Figure 3: two cells are enough for a hole."""
    evidence = report.evidence["topology.closed"]
    assert evidence["shape"] == [3, 2, 2]
    assert len(evidence["values"]) == 12
    failure = report.summaries["topology.closed"].failure
    assert failure is not None
    assert failure.case == evidence["case"]
    assert failure.numbers["boundary_facets"] == 4


def test_a_failure_in_general_position_is_shown_before_a_smaller_one_with_ties() -> None:
    """The one that ends a level."""
    rows = [body(), row("a", False, topology__closed="fail"), row("b", topology__closed="fail")]
    failure = made(rows).summaries["topology.closed"].failure
    assert failure is not None
    assert failure.case == "b"


class _Balanced(HTMLParser):
    """Follows which elements are open."""

    VOID = frozenset({"meta", "link", "br", "img"})

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: object) -> None:
        """One more is open."""
        del attrs
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: object) -> None:
        """It closes itself."""

    def handle_endtag(self, tag: str) -> None:
        """The last one that was opened is closed."""
        assert self.open.pop() == tag


def _well_formed(text: str) -> None:
    """Nothing, where every element that opens closes in order."""
    parser = _Balanced()
    parser.feed(text)
    assert not parser.open


def test_the_page_is_one_well_formed_file_that_loads_nothing(report: Report) -> None:
    text = page(report)
    _well_formed(text)
    for outside in ("http://", "https://", "src=", "<link", "@import", "url("):
        assert outside not in text.replace("http://www.w3.org/2000/svg", "")


def test_the_page_shows_each_failure_with_picture_numbers_and_command(report: Report) -> None:
    text = page(report)
    assert report.failures
    for summary in report.failures:
        assert f'id="failure-{summary.id}"' in text
    assert text.count('<svg class="pic"') >= len(report.evidence)
    assert 'class="gap"' in text
    smallest = report.evidence["topology.closed"]
    assert smallest["of"] == "pairs/0217"
    asked = f"--only {smallest['case']} --only topology.closed"
    assert f"isograde grade isoref:lorensen-cline {asked}" in text
    assert "Cut out of pairs/0217; its values are as simple as they can be." in text


def test_a_page_shows_of_every_claim_its_rule_source_and_evidence() -> None:
    """Issue 12: not only of those that fail."""
    report = made([body(), row("a"), row("b", symmetry__type="skip")])
    text = page(report)
    _well_formed(text)
    for name, claim in CLAIMS.items():
        assert f'id="{name}"' in text
        assert claim.rule in text
        assert claim.source in text
        assert f"Judge: pass when it is so{_oracles(name)}." in text
    assert "Cases that could fail: bodies 1, a 1, b 1." in text
    assert "holds on 3 cases" in text
    assert "holds on 2 cases" in text


def _oracles(name: str) -> str:
    """What a page says of the oracles of a claim of this name."""
    return f" (oracles: {', '.join(oracles_of(name))})" if oracles_of(name) else ""


def test_the_first_screen_says_what_is_wrong_and_what_is_right() -> None:
    rows = [body(), row("a", topology__manifold="fail"), row("b")]
    report = made(rows)
    for text in (page(report), markdown(report)):
        assert "1 of its promises is broken" in text.replace("\n", " ") or "are broken" in text
        assert "1 of 3 fields short of consistent" in text
    assert "Right on every case tried: the arrays are well formed, known bodies" in words.right(
        report
    )
    first = page(report).split('id="ladder"')[0]
    assert "It is a fail" in first
    assert "The arrays are well formed. Known bodies come out. There is no hole." in first


def test_long_names_and_traces_are_cut_where_they_are_told_and_whole_beside() -> None:
    """Issue 12: an id of 72 numbers and a crash's trace leave the first screen readable."""
    name = f"given/8x3x3/{','.join(['-0.5', '1'] * 36)}"
    trace = "Fatal Python error: Aborted Current thread 0x7f" + ' File "a.py", line 9' * 90
    broken = row(name, structure__answers="crash")
    broken[1].findings["structure.answers"] = Finding(Verdict.CRASH, trace)  # type: ignore[index]
    report = made([body(), broken])
    html, text = page(report), markdown(report)
    for one in (html.split('id="ladder"')[0], text.split("```sh")[0]):
        assert "Aborted .." in one
        assert "File " not in one
        assert name not in one
    told = "given/8x3x3/-0.5,1,-0.5,1,-0.5,1,-0.5,1,.."
    assert f'<code title="{name}">{told}</code>' in html
    assert f"`{told}`" in text
    assert trace.split()[-1] in html, "the whole of it stands below"
    for one in (html, text):
        assert f"--only {name} --only structure.answers" in one


def test_what_is_not_promised_is_said_with_what_holds() -> None:
    rows = [body(), row("a", symmetry__type="fail"), row("b")]
    report = made(rows, not_promised=["symmetry.type"])
    for text in (page(report), markdown(report), junit(report)):
        assert "not promised: 2 of 3 cases hold" in text
    assert "Not promised: symmetry.type." in page(report)


def test_a_choice_is_said_in_words_on_the_page() -> None:
    text = page(made([body(), row("a")]))
    assert "It separates the inside corners of every ambiguous face, by choice." in text


HOSTILE = [
    "<script>alert(1)</script>", "a|b\n# c", "`x`\x07", '"/>&', "</script><img src=x onerror=y>",
    "]]>", "<!-- ", "--> <b", "\ud800 \udfff", "\x00\x1b[31m\x9b", "\u202etxt.exe", "\ufffe\uffff",
    "```\n\n# heading", "![x](javascript:y)", "{{ 7*7 }} {% raw %}", "&#x0; &bogus; %s {0}",
    "| a | b |\n| --- |", "@all #1 ~~x~~ $y$", "x" * 3_000_000, "\u0300" * 5000, "\r\n\t\x0b",
]  # fmt: skip


@pytest.mark.parametrize("said", HOSTILE, ids=range(len(HOSTILE)))
def test_nothing_an_implementation_says_breaks_a_page(said: str, tmp_path: Path) -> None:
    """Its name, version, notes and errors are text, on every page, and not much of it."""
    broken = row("a", structure__answers="error")
    broken[1].findings["structure.answers"] = Finding(Verdict.ERROR, said)  # type: ignore[index]
    report = made([body(), broken], name=said, version=said, notes=said)
    harmless = made([body(), row("a", structure__answers="error")], name="it", notes="it")
    text = page(report)
    for tag in ("<script", "<img", "<b>", "onerror=y>"):
        assert text.count(tag) == page(harmless).count(tag)
    for name, (_, make) in FORMATS.items():
        assert len(make(report)) < len(make(harmless)) + 60_000, name
    assert len(write(report, tmp_path, "page", FORMATS)) == len(FORMATS)
    assert len(markdown(report).splitlines()) == len(markdown(harmless).splitlines())
    _well_formed(text)
    assert "<script>alert" not in text + markdown(report) + markdown_table([report])
    assert len(markdown_table([report]).splitlines()) == len(
        markdown_table([made([body(), broken])]).splitlines()
    )
    _well_formed(comparison_page([report], [""]))
    ET.fromstring(junit(report))
    ET.fromstring(badge(report))


def test_every_report_says_when_with_what_and_on_which_cases_it_was_made(report: Report) -> None:
    """Issue 12: date, commit, checksum of cases, versions in every report."""
    assert report.footer is not None
    said = [report.footer["checksum"], report.header["date"], report.header["versions"]["numpy"]]
    said += [report.header["versions"].get("commit", "")]
    pages = [page(report), markdown(report), junit(report), markdown_table([report])]
    for text in [*pages, comparison_page([report], [""])]:
        assert all(one in text for one in said)


def test_the_commit_is_that_of_the_checkout_or_nothing() -> None:
    found = record.commit()
    assert found == "" or re.fullmatch(r"[0-9a-f]{7,40}(-dirty)?", found)


def test_every_judge_says_when_it_passes() -> None:
    """Each claim of a page is shown with its judge, by what that says of itself."""
    told = {name: record.first_line(claim.judge) for name, claim in EVERY_CLAIM.items()}
    assert len(told) > 50
    assert [name for name, said in told.items() if not said.startswith("Pass ")] == []


def test_the_oracles_of_a_claim_are_read_off_its_judge() -> None:
    assert oracles_of("structure.answers") == ()
    assert set(oracles_of("topology.trilinear")) >= {"trilinear", "sheets"}
    assert "degree" in oracles_of("topology.sides")
    assert oracles_of("no.such") == ()
    assert sum(bool(oracles_of(name)) for name in EVERY_CLAIM) > 35


def test_junit_fails_what_is_promised_and_skips_what_is_not(report: Report) -> None:
    root = ET.fromstring(junit(report))
    failed = {
        case.get("name") for case in root.iter("testcase") if case.find("failure") is not None
    }
    assert failed == {summary.id for summary in report.broken}
    assert failed
    assert root.get("failures") == str(len(report.broken))


def test_junit_skips_conventions_and_claims_without_evidence() -> None:
    rows = [body(), row("a", robustness__nan="fail", symmetry__type="skip")]
    report = made([_nothing(one) for one in rows])
    root = ET.fromstring(junit(report))
    skipped = {case.get("name") for case in root.iter("testcase") if case.find("skipped")}
    skipped |= {c.get("name") for c in root.iter("testcase") if c.find("skipped") is not None}
    assert {"robustness.nan", "symmetry.type"} <= skipped
    assert root.get("failures") == "0"


def _nothing(pair: tuple[Case, Judged]) -> tuple[Case, Judged]:
    """The row with no evidence on types."""
    asked, judged = pair
    found = {**judged.findings, "symmetry.type": Finding(Verdict.SKIP, "no")}
    return asked, Judged(judged.case, judged.kind, found, judged.general)


def test_markdown_has_the_ladder_the_failures_and_every_claim() -> None:
    report = made([body(), row("a", topology__closed="fail")])
    text = markdown(report)
    assert "❌ **closed**" in text
    assert "### It is a fail" in text
    for summary in report.summaries.values():
        assert f"`{summary.id}`" in text


def test_a_badge_says_the_level_of_how_many() -> None:
    assert "level 1 closed of 4" in badge(made([body(), row("a", topology__manifold="fail")]))
    assert "no level" in badge(made([row("a", every="unsupported")]))


def test_an_open_edge_is_red_inside_and_thin_on_the_border(report: Report) -> None:
    evidence = report.evidence["topology.closed"]
    drawn = ET.fromstring(picture(evidence, evidence["came"], "came"))
    kinds = [element.get("class") for element in drawn.iter()]
    assert kinds.count("gap") == 4
    assert kinds.count("rim") > 0
    assert kinds.count("sore-line") == 1
    assert kinds.count("in") + kinds.count("out") == 12
    legal = ET.fromstring(picture(evidence, evidence["legal"], "legal"))
    assert not {"gap", "sore-line"} & {element.get("class") for element in legal.iter()}


def _corner(**numbers: object) -> lines.JSON:
    """An evidence record of one cell, one corner of which is inside."""
    values = [1.0] + [0.0] * 7
    vertices = [[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]]
    return {
        "shape": [2, 2, 2], "spacing": [1.0] * 3, "origin": [0.0] * 3, "isovalues": [0.5],
        "values": values, "finding": {"numbers": numbers},
        "came": {"vertices": vertices, "simplices": [[0, 1, 2]]},
    }  # fmt: skip


def test_a_triangle_turned_over_changes_colour() -> None:
    """Normals point from inside to outside, and outside is blue."""
    evidence = _corner()
    for face, kind in (([0, 1, 2], "front"), ([2, 1, 0], "back")):
        drawn = picture(evidence, {**evidence["came"], "simplices": [face]}, "one corner")
        assert f'<polygon class="{kind}"' in drawn


@pytest.mark.parametrize(
    ("numbers", "drawn", "count"),
    [
        ({"first": [0.5, 0.5, 0.5]}, "ring", 1),
        ({"at": [0.5, 0.5, 0.5]}, "ring", 1),
        ({"first": [[0, 0, 0], [1, 0, 0]]}, "sore-line", 1),
        ({"first": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}, "sore-line", 3),
        (
            {"first": [[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 1], [1, 0, 1], [0, 1, 1]]]},
            "sore-line",
            6,
        ),
        ({"vertex": 1}, "ring", 1),
        ({"simplex": 0}, "sore-line", 3),
        ({"vertex": 7, "simplex": 7}, "ring", 0),
        ({"corners": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]]}, "sore-line", 6),
        ({"cell": [0, 0, 0], "face": 3}, "sore-line", 4),
        ({"cell": [0, 0, 0]}, "sore-line", 12),
        ({"sample": [0, 0, 0], "axes": [2]}, "sore-line", 1),
        ({"sample": [0, 0, 0], "axes": [0, 1]}, "sore-line", 4),
        ({"sample": [0, 0, 0]}, "ring", 1),
        ({"first": "nowhere", "cell": [[1], [2, 3]], "at": [1, 2]}, "ring", 0),
    ],
)
def test_the_fault_is_drawn_where_the_numbers_say(
    numbers: dict[str, object], drawn: str, count: int
) -> None:
    evidence = _corner(**numbers)
    assert picture(evidence, evidence["came"]).count(f'class="{drawn}"') == count


def test_triangles_that_lie_flat_in_a_face_are_tinted() -> None:
    """At the facet that is named, in the face between two cells; not in the border."""
    values = [1.0] + [0.0] * 11
    vertices = [[1.0, 0.2, 0.0], [1.0, 0.8, 0.0], [1.0, 0.5, 0.9], [0.0, 0.5, 0.5]]
    evidence = {
        **_corner(first=vertices[:2]), "shape": [3, 2, 2], "values": values,
        "came": {"vertices": vertices, "simplices": [[0, 1, 2], [0, 1, 3]]},
    }  # fmt: skip
    assert picture(evidence, evidence["came"]).count('class="level"') == 1
    evidence["shape"], evidence["values"] = [2, 2, 2], values[:8]
    assert 'class="level"' not in picture(evidence, evidence["came"])


def test_an_answer_that_is_missing_leaves_the_samples() -> None:
    evidence = _corner()
    drawn = picture({**evidence, "came": {"status": "crash"}}, {"status": "crash"})
    assert drawn.count('class="in"') == 1
    assert "<polygon" not in drawn


def test_the_lines_that_show_a_failure_name_the_reference_and_nothing_of_the_grader(
    report: Report,
) -> None:
    """They print the four open edges, and fail."""
    program = snippet(report, report.summaries["topology.closed"])
    assert program is not None
    assert "isograde" not in program
    found: dict[str, object] = {}
    with pytest.raises(AssertionError, match="The mesh has no boundary"):
        exec(program, found)
    assert len(found["wrong"]) == 4  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("spec", "word"),
    [
        ("skimage:lorensen", "method='lorensen'"),
        ("pymcubes", "mcubes.marching_cubes"),
        ("python:mine:extract", "from mine import extract as extract"),
        ("exec:./mine", "command = './mine'"),
        ("dir:answers", None),
        ("python:./mine.py:extract", 'run_path("./mine.py")'),
    ],
)
def test_an_implementation_is_called_as_its_users_call_it(spec: str, word: str | None) -> None:
    text = calling(spec)
    assert (text is None) if word is None else (text is not None and word in text)


def test_what_an_adapter_does_for_its_library_is_on_the_page() -> None:
    report = made([body(), row("a")])
    done = [name for name, one in READY_MADE.items() if one.does]
    assert done
    header = {**report.header, "spec": done[0]}
    text = page(Report(header, report.claims, report.cases, report.results, {}, report.footer))
    assert READY_MADE[done[0]].does[0].replace("'", "&#39;") in text


def test_the_legal_answer_puts_ties_where_the_implementation_does() -> None:
    """One tied sample among low ones: a surface round it where ties are inside, else nothing."""
    values = -np.ones((3, 3, 3))
    values[1, 1, 1] = 0
    evidence = Evidence(Field.of(values), (0.0,), {})
    judged = Judged("ties/one", SURFACES, {}, evidence=evidence)

    def decided(tie: Literal["inside", "outside"]) -> Mesh | None:
        declared = Declaration("mine", conventions=Conventions(tie=tie))
        answers = contrast("isoref:asymptotic-decider", [judged], Options(), declared)
        return answers["ties/one"].mesh

    inside, outside = decided("inside"), decided("outside")
    assert inside is not None
    assert outside is not None
    assert len(inside.simplices) == 8
    assert len(outside.simplices) == 0


def test_a_comparison_links_each_failure_to_its_page(path: Path, report: Report) -> None:
    text = comparison_page([report, reading.read(path)], ["a.html", ""], {"vtk": "not installed"})
    _well_formed(text)
    assert 'href="a.html#failure-topology.closed"' in text
    assert "not installed" in text
    assert "`topology.closed`" in markdown_table([report])


def test_a_comparison_has_headlines_in_two_orders() -> None:
    exact = made([body(), row("a", topology__manifold="fail")], name="exact")
    plain = made([body(), row("a", topology__trilinear="fail")], name="plain")
    for text in (comparison_page([exact, plain], ["", ""]), markdown_table([exact, plain])):
        level, topology = text.split("Topology first")
        assert level.index("plain 1.2") < level.index("exact 1.2")
        assert topology.index("exact 1.2") < topology.index("plain 1.2")


def test_kinds_are_compared_apart() -> None:
    planar = made([row("a", kind=SURFACES)], limits={"kinds": [[2, 1]]}, name="planar")
    text = markdown_table([planar, made([body(), row("a")])])
    assert "## Contours" in text
    assert "## Surfaces" in text


def test_a_report_has_no_changes_from_itself(report: Report) -> None:
    assert changes(report, report) == []


def test_every_format_writes_one_file_and_leaves_no_draft(report: Report, tmp_path: Path) -> None:
    written = write(report, tmp_path, "name", FORMATS)
    beside = tmp_path / "explorer.html"
    assert sorted(tmp_path.iterdir()) == sorted([*written, beside])
    write_whole(tmp_path / "name.md", "again")
    assert (tmp_path / "name.md").read_text(encoding="utf-8") == "again"


@pytest.mark.parametrize(
    ("claim", "numbers", "kept"),
    [
        ("topology.manifold", {"order": 2.0, "interval": [1.9, 2.1]}, True),
        ("topology.trilinear", {"cells": 9}, True),
        ("structure.all_used", {"vertices": 9}, True),
        ("topology.closed", {"facets": 9}, False),
    ],
)
def test_figures_are_kept_though_the_claim_passed(
    claim: str, numbers: dict[str, object], kept: bool
) -> None:
    judged = Judged("a", SURFACES, {claim: Finding(Verdict.PASS, "", numbers)}, True)
    written = record.result_record(judged, CLAIMS)
    assert written["passed"] == [claim]
    assert written["measured"] == ({claim: numbers} if kept else {})


def test_an_order_is_shown_with_its_interval() -> None:
    numbers = {"order": 2.0, "interval": [1.9, 2.1], "thin_triangles": 0.06}
    report = made([body(), row("accuracy/sphere", topology__manifold=("pass", numbers))])
    assert words.figures(numbers) == "order 2, interval 1.9 to 2.1, thin triangles 0.06"
    assert f"<td>{words.figures(numbers)}</td>" in page(report)


def test_the_page_says_what_is_declared_in_four_words() -> None:
    declared: dict[str, Any] = {
        "interpolant": "labels", "vertices": {"own": 1.5}, "level": 2, "mesh": {"soup": 1e-6},
        "domain": ["open", "closed", {"inset": 0.5, "end": "open"}], "promised": ["cells.join"],
    }  # fmt: skip
    report = made([body(), row("a")], **declared)
    assert words.declared(report) | {
        "interpolant": "labels",
        "vertices": "own 1.5",
        "domain": "open, closed, open, 0.5 cells inside",
        "mesh": "soup 1e-06",
        "promised": "cells.join",
    } == words.declared(report)
    assert "<th>domain</th><td>open, closed, open, 0.5 cells inside</td>" in page(report)
    assert "(labels, vertices on a lattice of its own)" in headline(report)


def test_a_large_mesh_or_field_is_not_written_out() -> None:
    field = Field.of(np.zeros((20, 20, 20)))
    found = Finding(Verdict.FAIL, "no")
    judged = Judged(
        "a", SURFACES, {"a.b": found}, True, evidence=Evidence(field, (0.5,), _Answers())
    )
    written = shown.evidence_record("a.b", judged)
    assert written["values"] == []
    assert "simplices" not in written["came"]


class _Answers(dict):  # type: ignore[type-arg]
    """One answer of many triangles, whatever is asked."""

    def __missing__(self, key: str) -> object:
        from isograde.model import Outcome, Status

        rows = np.zeros((shown.SHOWN_SIMPLICES + 1, 3), int)
        return Outcome(Status.OK, np.zeros((1, 3)), rows)
