"""Failures that are known: written, read, honoured both ways, and never on known bodies."""

from pathlib import Path

import isograde
import pytest
from isograde.command import app
from isograde.commands.console import Exit, status_of
from isograde.expectations import EVERY, ExpectationError, Expected, expectations, toml
from isograde.report import reading
from isograde.report.junit import junit
from typer.testing import CliRunner, Result

from tests.isograde.reporting import body, made, row

FLAWED = "isoref:lorensen-cline"
PAIRS = ("--only", "pairs/02*", "--only", "topology.*", "--format", "junit")


def run(*arguments: str | Path) -> Result:
    """The result of the command with these arguments."""
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('["topology.clsed"]\nreason = "x"\ncases = ["*"]', r"did you mean topology\.closed\?"),
        ('["bodies.pieces"]\nreason = "x"\ncases = ["*"]', "known bodies cannot"),
        ('["topology.closed"]\nreason = " "\ncases = ["*"]', "say why"),
        ('["topology.closed"]\nreason = "x"\ncases = []', "name its cases"),
        ('["topology.closed"]\nreason = "x"\ncases = ["*", "a"]', "alone for all"),
        ('["topology.closed"]\nreason = "x"\ncases = [3]', "a list of ids"),
        ('["topology.closed"]\nreason = "x"', "and nothing else"),
        ('["topology.closed"]\nreason = "x"\ncases = ["*"]\ncase = "a"', "and nothing else"),
        ("topology.closed = 3", "no claim 'topology'"),
        ("no toml", "is not TOML"),
    ],
)
def test_a_file_that_cannot_be_taken_is_told(text: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "known.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ExpectationError, match=message):
        expectations(path)
    result = run("grade", FLAWED, *PAIRS, "--expect", path, "--out", tmp_path / "report")
    assert result.exit_code == Exit.WRONG_USE


def test_a_file_survives_being_written_and_read(tmp_path: Path) -> None:
    found = {
        "topology.closed": Expected("why", (EVERY,)),
        "topology.manifold": Expected('a "reason" with\nlines and ä', ("pairs/1", "noise/ü")),
    }
    path = tmp_path / "known.toml"
    path.write_text(toml(found, "Known."), encoding="utf-8")
    assert expectations(path) == found
    with pytest.raises(ExpectationError, match="cannot be read"):
        expectations(tmp_path / "absent.toml")


def test_the_exit_status_hangs_on_what_was_not_expected() -> None:
    """Status 0 when what fails is what is expected; one case more, and it is 1."""
    rows = [body(), row("a", topology__closed="fail"), row("b", topology__closed="fail"), row("c")]
    known = {"topology.closed": Expected("why", ("a", "b"))}
    less = {"topology.closed": Expected("why", ("a",))}
    assert status_of(made(rows)) == Exit.FAILS
    assert status_of(made(rows, expected=known)) == Exit.HOLDS
    assert status_of(made(rows, expected=less)) == Exit.FAILS
    assert made(rows, expected=less).unexpected == {"topology.closed": ["b"]}
    assert status_of(made(rows, expected={"topology.closed": Expected("why")})) == Exit.HOLDS
    other = {"topology.sides": Expected("why")}
    assert status_of(made(rows, expected=other)) == Exit.FAILS


def test_what_was_expected_and_holds_is_told_and_fails_when_strict() -> None:
    rows = [body(), row("a"), row("b", topology__closed="fail")]
    known = {"topology.closed": Expected("why", ("a", "b", "absent"))}
    found = made(rows, expected=known)
    assert found.mended == {"topology.closed": ["a"]}
    assert (status_of(found), status_of(found, strict=True)) == (Exit.HOLDS, Exit.FAILS)
    whole = made([body(), row("a")], expected={"topology.closed": Expected("why")})
    assert whole.mended == {"topology.closed": [EVERY]}
    exact = made(rows, expected={"topology.closed": Expected("why", ("b",))})
    assert not exact.mended


def test_an_expectation_gives_no_evidence() -> None:
    """Attack: a list of everything makes nothing hold that was not judged."""
    rows = [row("a", every="skip", topology__closed="skip")]
    found = made(rows, expected={"topology.closed": Expected("why")})
    assert status_of(found) == Exit.NO_EVIDENCE
    assert found.reached is None


def test_an_expected_failure_ends_a_level_all_the_same() -> None:
    """What is known is no less true: the level is that of the results."""
    rows = [body(), row("a", topology__closed="fail"), row("b")]
    assert made(rows, expected={"topology.closed": Expected("why")}).reached == made(rows).reached


def test_a_case_that_was_not_expected_is_shown_before_a_smaller_one_that_was() -> None:
    rows = [body(), row("a", topology__closed="fail"), row("b", topology__closed="fail")]
    found = made(rows, expected={"topology.closed": Expected("why", ("a",))})
    failure = found.summaries["topology.closed"].failure
    assert failure is not None
    assert failure.case == "b"


def test_continuous_integration_sees_an_expected_failure_as_skipped() -> None:
    rows = [body(), row("a", topology__closed="fail"), row("b")]
    assert "<failure" in junit(made(rows))
    text = junit(made(rows, expected={"topology.closed": Expected("the flaw of 1987")}))
    assert "<failure" not in text
    assert "expected to fail: the flaw of 1987" in text


@pytest.mark.slow
def test_known_failures_turn_green_and_a_third_turns_red(tmp_path: Path) -> None:
    """The round in CI: write what fails, expect it, lose a line of the list."""
    path, out = tmp_path / "known.toml", ("--out", tmp_path / "report")
    first = run("grade", FLAWED, *PAIRS, *out, "--write-expect", path)
    assert first.exit_code == Exit.FAILS
    assert "failures of" in first.output
    listed = expectations(path)
    assert len(listed["topology.closed"].cases) == 4
    green = run("grade", FLAWED, *PAIRS, *out, "--expect", path)
    assert green.exit_code == Exit.HOLDS, green.output
    assert "What fails is what was expected to." in green.output
    gone = listed["topology.closed"].cases[0]
    text = path.read_text(encoding="utf-8").replace(f'    "{gone}",\n', "")
    path.write_text(text, encoding="utf-8")
    red = run("grade", FLAWED, *PAIRS, *out, "--expect", path)
    assert red.exit_code == Exit.FAILS
    assert f"not expected: topology.closed on 1 cases: {gone}" in red.output
    failure = (
        reading.read(tmp_path / "report" / "report.jsonl").summaries["topology.closed"].failure
    )
    assert failure is not None
    assert gone in (failure.case, failure.of)
    # Keep a reason that somebody wrote, when the list is written anew.
    path.write_text(text.replace(listed["topology.closed"].reason, "said by me"), "utf-8")
    run("grade", FLAWED, *PAIRS, *out, "--expect", path, "--write-expect", path)
    assert expectations(path)["topology.closed"] == Expected(
        "said by me", listed["topology.closed"].cases
    )
    sound = run("grade", "isoref:asymptotic-decider", *PAIRS, *out, "--expect", path)
    assert sound.exit_code == Exit.HOLDS
    assert "expected to fail, and holds: topology.closed" in sound.output


def test_reasons_are_taken_from_python_too() -> None:
    only = ["pairs/0217", "topology.closed"]
    found = isograde.grade(FLAWED, only=only, expected_failures={"topology.closed": "of 1987"})
    assert found.holds
    with pytest.raises(ExpectationError, match="known bodies"):
        isograde.grade(FLAWED, only=only, expected_failures={"bodies.pieces": "no"})
