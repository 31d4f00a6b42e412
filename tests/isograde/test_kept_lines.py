"""The lines of kept reports fail on who they are about, and are silent on the reference."""

from __future__ import annotations

import multiprocessing
import sys

import pytest

from tests.isograde.kept_lines import NONE, installed, kept, main, run, with_reference

FORKS = "fork" in multiprocessing.get_all_start_methods()


@pytest.mark.slow
@pytest.mark.skipif(not FORKS, reason="a program is run in a fork of this process")
def test_every_snippet_of_every_kept_report_shows_its_fault_and_no_other(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Issue 12: a test runs every snippet of every report on both."""
    status = main([])
    assert status == 0, capsys.readouterr().out


@pytest.mark.skipif(not FORKS, reason="a program is run in a fork of this process")
def test_lines_that_show_nothing_are_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """A snippet that asserts nothing, and one that accuses everybody."""
    [path] = [one for one in kept() if one.name == "isoref-label-cubes.jsonl.gz"]
    assert installed(path)
    assert [line for one in run(path) for line in one.wrong] == []
    here = sys.modules["tests.isograde.kept_lines"]
    monkeypatch.setattr(here, "snippet", lambda *_: "\n\ndef arrays(): ...\nwrong = []")
    wrong = [line for one in run(path) for line in one.wrong]
    assert wrong
    assert all("on the accused silent" in line for line in wrong)
    monkeypatch.setattr(here, "snippet", lambda *_: "\n\ndef arrays(): ...\nassert not [1]")
    wrong = [line for one in run(path) for line in one.wrong]
    assert wrong
    assert all("on the reference fails" in line for line in wrong)


def test_the_reference_takes_the_place_of_who_is_accused() -> None:
    program = "extract = 1\n\n\ndef arrays(answer, n, k): ...\n"
    assert with_reference(program).index("REFERENCE") < program.index("def arrays") + 25
    with pytest.raises(ValueError, match="nothing begins"):
        with_reference("print(1)")
    assert all(NONE.values())
