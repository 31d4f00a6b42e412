"""A report reads back as it was written, and every page says what the lines say."""

import gzip
import json
import subprocess
import sys
import xml.etree.ElementTree as ET
from html.parser import HTMLParser
from pathlib import Path
from typing import Literal

import jsonschema
import numpy as np
import pytest
from isograde.grading import contrast, grade
from isograde.model import LEVELS, Conventions, Declaration, Finding, Verdict
from isograde.report import FORMATS, record, words, write, write_whole
from isograde.report.badge import badge
from isograde.report.comparison import changes, comparison_page, markdown_table
from isograde.report.junit import junit
from isograde.report.markdown import markdown
from isograde.report.page import page
from isograde.report.picture import picture
from isograde.report.record import Report
from isograde.report.snippet import calling, snippet
from isograde.runner import Evidence, Judged, Options
from isoref.field import Field
from isoref.mesh import Mesh


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
    return record.read(path)


def test_every_line_fits_the_schema(path: Path) -> None:
    """The schema is itself a valid one, and each line is one of its kinds."""
    jsonschema.Draft202012Validator.check_schema(record.schema())
    validator = jsonschema.Draft202012Validator(record.schema())
    lines = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    for kind in record.KINDS:
        some = [line for line in lines if line["kind"] == kind]
        assert some
        validator.validate(some[-1])


def test_a_report_begins_with_its_header_and_ends_with_its_footer(path: Path) -> None:
    kinds = [json.loads(line)["kind"] for line in path.read_text(encoding="utf-8").splitlines()]
    assert kinds[0] == "header"
    assert kinds[-1] == "footer"
    assert kinds.count("case") == kinds.count("result") == 17


def test_the_counts_of_the_footer_are_those_of_the_results(report: Report) -> None:
    assert report.footer is not None
    counted: dict[str, int] = {}
    for summary in report.summaries.values():
        for verdict, count in summary.counts.items():
            counted[verdict] = counted.get(verdict, 0) + count
    assert report.footer["verdicts"] == counted
    assert report.footer["calls"] == sum(result["calls"] for result in report.results)


def test_a_report_without_a_footer_is_read_and_known_to_be_cut_off(path: Path) -> None:
    lines = path.read_text(encoding="utf-8").splitlines()[:-1]
    cut = record.gather(map(json.loads, lines))
    assert cut.footer is None
    assert "cut off" in page(cut)
    assert "cut off" in markdown(cut)
    assert "cut off" in junit(cut)
    assert "cut off" in badge(cut)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("{", "bad.jsonl:1 is not JSON"),
        ("[]", "is no record of a report"),
        ('{"kind": "finding"}', "kind 'finding'"),
        ('{"kind": "footer", "cases": -1}', "is no footer record"),
        (
            '{"kind":"case","id":"a/b","samples":8,"isovalue":0,"tags":[]}',
            "does not begin with a header",
        ),
    ],
)
def test_what_is_no_report_is_refused_with_its_place(
    text: str, message: str, tmp_path: Path
) -> None:
    bad = tmp_path / "bad.jsonl"
    bad.write_text(text, encoding="utf-8")
    with pytest.raises(record.ReportError, match=message):
        record.read(bad)


def test_a_file_that_is_no_archive_is_refused(tmp_path: Path) -> None:
    bad = tmp_path / "bad.jsonl.gz"
    bad.write_bytes(b"rubbish")
    with pytest.raises(record.ReportError, match="cannot be read"):
        record.read(bad)


def test_a_compressed_report_reads_the_same_and_is_the_same_file_each_time(tmp_path: Path) -> None:
    texts = []
    for name in ("one.jsonl.gz", "two.jsonl.gz"):
        with record.open_text(tmp_path / name, "w") as file:
            record.write_line(file, {"kind": "footer", "number": np.float32(0.5), "nan": np.nan})
        texts.append((tmp_path / name).read_bytes())
    assert texts[0] == texts[1]
    assert json.loads(gzip.decompress(texts[0])) == {"kind": "footer", "number": 0.5, "nan": "nan"}


def test_the_evidence_is_the_smallest_case_and_holds_its_numbers(report: Report) -> None:
    """Nielson & Hamann 1991, Figure 3: two cells are enough for a hole."""
    shown = report.evidence["topology.closed"]
    assert shown["shape"] == [3, 2, 2]
    assert len(shown["values"]) == 12
    failure = report.summaries["topology.closed"].failure
    assert failure is not None
    assert failure.case == shown["case"]
    assert failure.numbers["boundary_edges"] == 4


def test_the_level_reached_ends_below_the_first_level_that_fails(report: Report) -> None:
    states = {rung.level: rung.state for rung in report.rungs}
    assert states[0] == "pass"
    assert states[1] == "fail"
    assert report.reached == 0


@pytest.mark.parametrize(("claimed", "reached"), [(1, 1), (2, 2)])
def test_a_level_promised_in_part_is_not_reached_above_what_is_claimed(
    claimed: int, reached: int, report: Report
) -> None:
    """Design: nothing but pass counts as a pass."""
    header = {
        **report.header,
        "implementation": {**report.header["implementation"], "level": claimed},
    }
    levels = {"structure.finite": 0, "topology.closed": 1, "cases.legal": 2, "symmetry.shift": 2}
    claims = {name: {"id": name, "level": level, "held": True} for name, level in levels.items()}
    result = {
        "case": "a",
        "passed": [name for name in levels if name != "cases.legal"],
        "findings": [{"claim": "cases.legal", "verdict": "unsupported", "detail": "not promised"}],
    }
    case = {"a": {"samples": 8}}
    assert Report(header, claims, case, [result]).reached == reached


@pytest.fixture(scope="module")
def partial(tmp_path_factory: pytest.TempPathFactory) -> Report:
    """The report of an implementation that does not promise to stand on edges at the crossing."""
    folder = tmp_path_factory.mktemp("partial")
    (folder / "shy.py").write_text(
        "from isoref import extract as reference\n"
        "def extract(values, isovalue, spacing):\n"
        "    mesh = reference(values, isovalue, spacing)\n"
        "    return mesh.vertices, mesh.simplices\n"
        'extract.declaration = {"name": "shy", "without": ["linear-crossing"]}\n',
        encoding="utf-8",
    )
    spec, lines = f"python:{folder / 'shy.py'}:extract", folder / "report.jsonl"
    grade(spec, Options(only=("pairs/021*",)), lines)
    text = lines.read_text(encoding="utf-8").replace('"only":["pairs/021*"]', '"only":[]')
    return record.gather(map(json.loads, text.splitlines()))


def test_a_level_reached_without_the_claims_withheld_is_said_to_be(partial: Report) -> None:
    """On every page: the level alone would say more than was seen."""
    withheld = partial.withheld
    assert withheld
    assert all("unsupported" in partial.summaries[name].counts for name in withheld)
    assert partial.reached is not None
    level = f"level {partial.reached} {LEVELS[partial.reached][0]}"
    said = f"{level}, {words.withheld(len(withheld))}"
    assert words.reached(partial) == said
    for text in (badge(partial), markdown(partial), page(partial), markdown_table([partial])):
        assert said in text
    for text in (markdown(partial), page(partial), comparison_page([partial], [""])):
        assert all(name in text for name in withheld)
    assert "holds in part" in page(partial)
    assert f"☑️ **{partial.rungs[2].name}**" in markdown(partial)
    assert '<span class="star" title="' in comparison_page([partial], [""])


def test_a_level_reached_whole_is_said_without_more(partial: Report) -> None:
    results = [
        {**line, "passed": [*line["passed"], *partial.withheld], "findings": []}
        for line in partial.results
    ]
    whole = Report(partial.header, partial.claims, partial.cases, results, {}, partial.footer)
    assert not whole.withheld
    assert partial.reached == whole.reached is not None
    assert words.reached(whole) == f"level {whole.reached} {LEVELS[whole.reached][0]}"
    assert "withheld" not in badge(whole) + page(whole) + markdown(whole)


def test_the_footer_says_the_level_and_what_is_withheld(partial: Report) -> None:
    tally = record.Tally()
    footer = tally.footer(1.0, partial)
    assert (footer["reached"], footer["withheld"]) == (partial.reached, partial.withheld)
    assert partial.footer is not None
    assert partial.footer["reached"] is None  # It was written of a part of the cases.


def test_a_claim_above_the_declared_level_is_shown_and_not_held(report: Report) -> None:
    """Issue 2: judged and shown, but not held against it."""
    assert not report.claims["topology.bilinear"]["held"]
    assert report.summaries["topology.bilinear"].state == "fail"
    assert "topology.bilinear" not in {summary.id for summary in report.broken}
    assert "topology.bilinear" in {summary.id for summary in report.failures}


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
    for summary in report.failures:
        assert f'id="failure-{summary.id}"' in text
    assert text.count('<svg class="pic"') >= 2 * len(report.evidence) - 1
    assert 'class="gap"' in text
    assert "isograde grade isoref:lorensen-cline --only pairs/0217 --only topology.closed" in text


def test_hostile_names_are_escaped(path: Path) -> None:
    lines = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    lines[0]["implementation"]["name"] = "<script>alert(1)</script>"
    for line in lines:
        for finding in line.get("findings", []):
            finding["detail"] = "<b>&"
    text = page(record.gather(lines))
    assert "<script>alert" not in text
    assert "<b>&" not in text
    _well_formed(text)
    ET.fromstring(junit(record.gather(lines)))
    ET.fromstring(badge(record.gather(lines)))


def test_junit_fails_what_is_held_and_skips_what_is_not(report: Report) -> None:
    root = ET.fromstring(junit(report))
    failed = {
        case.get("name") for case in root.iter("testcase") if case.find("failure") is not None
    }
    assert failed == {summary.id for summary in report.broken}
    assert root.get("failures") == str(len(report.broken))


def test_markdown_has_the_ladder_the_failures_and_every_claim(report: Report) -> None:
    text = markdown(report)
    assert "❌ **watertight**" in text
    assert "### `topology.closed`" in text
    for summary in report.summaries.values():
        assert f"`{summary.id}`" in text


def test_an_open_edge_is_red_inside_and_thin_on_the_border(report: Report) -> None:
    shown = report.evidence["topology.closed"]
    drawn = ET.fromstring(picture(shown, shown["came"], "came"))
    kinds = [element.get("class") for element in drawn.iter()]
    assert kinds.count("gap") == 4
    assert kinds.count("rim") > 0
    assert kinds.count("in") + kinds.count("out") == 12
    legal = ET.fromstring(picture(shown, shown["legal"], "legal"))
    assert "gap" not in [element.get("class") for element in legal.iter()]


def test_a_triangle_turned_over_changes_colour() -> None:
    """Normals point from inside to outside, and outside is blue."""
    field = {"shape": [2, 2, 2], "spacing": [1.0] * 3, "origin": [0.0] * 3, "isovalue": 0.5}
    field["values"] = [1.0] + [0.0] * 7
    vertices = [[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]]
    for face, kind in (([0, 1, 2], "front"), ([2, 1, 0], "back")):
        drawn = picture(field, {"vertices": vertices, "faces": [face]}, "one corner")
        assert f'<polygon class="{kind}"' in drawn


def test_the_lines_that_show_a_failure_run_without_the_grader(
    report: Report, tmp_path: Path
) -> None:
    """They name the reference, print the four open edges and import nothing of isograde."""
    program = snippet(report, report.summaries["topology.closed"])
    assert program is not None
    assert "isograde" not in program
    (tmp_path / "show.py").write_text(program, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "show.py"], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    inner = [line for line in done.stdout.splitlines() if line.count("[1. ") == 2]
    assert len(inner) == 4


@pytest.mark.parametrize(
    ("spec", "word"),
    [
        ("skimage:lorensen", 'method="lorensen"'),
        ("pymcubes", "mcubes.marching_cubes"),
        ("libigl", "igl.marching_cubes"),
        ("vtk:flying-edges", "vtkFlyingEdges3D"),
        ("python:mine:extract", "from mine import extract as extract"),
        ("exec:./mine", None),
        ("python:./mine.py:extract", 'run_path("./mine.py")'),
    ],
)
def test_an_implementation_is_called_as_its_users_call_it(spec: str, word: str | None) -> None:
    lines = calling(spec)
    assert (lines is None) if word is None else (lines is not None and word in lines)


@pytest.mark.parametrize(
    "spec",
    [
        "pymcubes",
        "libigl",
        "trimesh",
        "pymeshlab",
        "manifold3d",
        "vtk:marching-cubes",
        "vtk:discrete-marching-cubes",
        "vtk:surface-nets",
    ],
)
def test_the_lines_that_call_a_library_give_its_mesh(spec: str) -> None:
    pytest.importorskip({"pymcubes": "mcubes", "libigl": "igl"}.get(spec, spec.split(":")[0]))
    lines = calling(spec)
    assert lines is not None
    made: dict[str, object] = {"np": np}
    exec(lines, made)
    x, y, z = np.ogrid[-1:1:7j, -1:1:8j, -1:1:9j]
    extract = made["extract"]
    assert callable(extract)
    vertices, faces = extract(0.6 - (x * x + y * y + z * z), 0.0, (1.0, 1.0, 1.0))
    used = np.unique(vertices[np.unique(faces)], axis=0)
    assert len(used) > 20
    assert len(faces) == 2 * len(used) - 4


def test_the_legal_answer_puts_ties_where_the_implementation_does() -> None:
    """One tied sample among low ones: a surface round it where ties are inside, else nothing."""
    values = -np.ones((3, 3, 3))
    values[1, 1, 1] = 0
    judged = Judged("ties/one", {}, evidence=Evidence(Field.of(values), 0.0, {}))

    def decided(tie: Literal["inside", "outside"]) -> Mesh | None:
        declared = Declaration("mine", conventions=Conventions(tie=tie))
        answers = contrast("isoref:asymptotic-decider", [judged], Options(), declared)
        return answers["ties/one"].mesh

    inside, outside = decided("inside"), decided("outside")
    assert inside is not None
    assert outside is not None
    assert len(inside.simplices) == 8
    assert len(outside.simplices) == 0


def test_a_comparison_links_each_failure_to_its_page(report: Report) -> None:
    text = comparison_page([report, report], ["a.html", ""], {"vtk": "not installed"})
    _well_formed(text)
    assert 'href="a.html#failure-topology.closed"' in text
    assert "not installed" in text
    assert "`topology.closed`" in markdown_table([report])


def test_a_report_has_no_changes_from_itself(report: Report) -> None:
    assert changes(report, report) == []


def test_every_format_writes_one_file_and_leaves_no_draft(report: Report, tmp_path: Path) -> None:
    written = write(report, tmp_path, "name", FORMATS)
    assert sorted(tmp_path.iterdir()) == sorted(written)
    write_whole(tmp_path / "name.md", "again")
    assert (tmp_path / "name.md").read_text(encoding="utf-8") == "again"


def test_what_was_measured_is_kept_and_shown_though_it_passed() -> None:
    """An order with its interval, and the shapes of triangles, which no claim judges."""
    numbers = {"order": 2.0, "interval": [1.9, 2.1], "thin_triangles": 0.06}
    judged = Judged("accuracy/sphere", {"accuracy.normal": Finding(Verdict.PASS, "", numbers)})
    kept = record.result_record(judged)
    assert kept["passed"] == ["accuracy.normal"]
    assert kept["measured"] == {"accuracy.normal": numbers}
    assert words.figures(numbers) == "order 2, interval 1.9 to 2.1, thin triangles 0.06"


def test_the_page_shows_what_was_measured_and_what_was_promised(tmp_path: Path) -> None:
    only = ("accuracy/sphere", "accuracy.area")
    made = grade("isoref:marching-vesta-connect-L", Options(only=only), tmp_path / "report.jsonl")
    assert made.header["implementation"]["promises"] == {"connectivity": "connect"}
    ((claim, case, numbers),) = made.measured
    text = page(made)
    _well_formed(text)
    assert f"<td>{words.figures(numbers)}</td>" in text
    assert "<tr><th>connectivity</th><td>connect</td></tr>" in text
    assert (claim, case) == ("accuracy.area", "accuracy/sphere")
