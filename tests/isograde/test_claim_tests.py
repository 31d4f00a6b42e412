"""Claims as tests of pytest: the plug-in, and the decorator in one's own test file."""

import re
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path

import isograde
import pytest
from isograde.expectations import ExpectationError
from isograde.model import UnknownName

FLAWED, SOUND = "isoref:lorensen-cline", "isoref:asymptotic-decider"
# The plug-in is known where isograde is installed; a checkout has to name it.
KNOWN = any(one.value == "isograde.pytest_plugin" for one in entry_points(group="pytest11"))
PLUGIN = [] if KNOWN else ["-p", "isograde.pytest_plugin"]
FEW = "structure.finite or structure.in_range or topology.closed"
# Two cells with a face that the rule of 1987 tears.
CASES = ("pairs/248*",)


def pytest_of(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """What a pytest of its own says in this folder."""
    command = [sys.executable, "-m", "pytest", *PLUGIN, "-p", "no:cacheprovider", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, encoding="utf-8", check=False)


CONFORMANCE = ("--pyargs", "isograde.conformance")
ASKED = ("--isograde-only", " ".join(CASES))


@pytest.mark.slow
def test_each_claim_is_a_test_with_a_readable_id(tmp_path: Path) -> None:
    done = pytest_of(tmp_path, *CONFORMANCE, "--isograde", SOUND, "--collect-only", "-q")
    ids = re.findall(r"test_claim\[(.+)\]", done.stdout)
    assert "topology.closed" in ids
    assert "bodies.pieces" in ids
    assert len(ids) == len(set(ids)) > 40


@pytest.mark.slow
def test_a_failure_has_the_smallest_case_and_the_command(tmp_path: Path) -> None:
    """-k chooses, -x stops, and the text is all one needs."""
    chosen = ("-k", f"{FEW} or topology.manifold", "-x", "-q", *ASKED)
    done = pytest_of(tmp_path, *CONFORMANCE, "--isograde", FLAWED, *chosen)
    assert done.returncode == 1
    assert "3 passed" not in done.stdout
    assert "2 passed" in done.stdout
    assert "1 failed" in done.stdout
    assert "smallest case: " in done.stdout
    assert "isograde grade isoref:lorensen-cline --only " in done.stdout
    assert "claim_tests.py" not in done.stdout.split("short test summary")[0]


@pytest.mark.slow
def test_the_ini_file_names_the_implementation_and_what_is_known(tmp_path: Path) -> None:
    """Two processes of xdist share the claims; a known failure is an xfail with its reason."""
    (tmp_path / "known.toml").write_text(
        '["topology.closed"]\nreason = "the flaw of 1987"\ncases = ["*"]\n', encoding="utf-8"
    )
    (tmp_path / "pytest.ini").write_text(
        f"[pytest]\nisograde = {FLAWED}\nisograde_expect = known.toml\n"
        f"isograde_only = {' '.join(CASES)}\n",
        encoding="utf-8",
    )
    done = pytest_of(tmp_path, *CONFORMANCE, "-k", FEW, "-q", "-rx", "-n", "2")
    assert done.returncode == 0, done.stdout
    assert "2 passed, 1 xfailed" in done.stdout
    assert "the flaw of 1987" in done.stdout


def test_a_mistake_in_the_call_is_wrong_use(tmp_path: Path) -> None:
    """The collection ends with a line that says why; nothing ran, and nothing passed."""
    none = pytest_of(tmp_path, *CONFORMANCE)
    assert "isograde: name one: --isograde" in none.stdout + none.stderr
    assert none.returncode == 2
    misspelt = pytest_of(tmp_path, *CONFORMANCE, "--isograde", "skimage:levine")
    assert "did you mean skimage:lewiner?" in misspelt.stdout + misspelt.stderr
    assert misspelt.returncode == 2
    listed = ("--isograde", SOUND, "--isograde-expect", "absent.toml")
    absent = pytest_of(tmp_path, *CONFORMANCE, *listed)
    assert "cannot be read" in absent.stdout + absent.stderr
    assert absent.returncode == 2
    nowhere = ("--isograde", SOUND, "--isograde-only", "paris/*")
    empty = pytest_of(tmp_path, *CONFORMANCE, *nowhere)
    assert "nothing matches paris/*" in empty.stdout + empty.stderr
    assert empty.returncode == 2


OWN = """
import isograde
from isoref.methods import extract as reference


def extract(values, isovalue, spacing):
    mesh = reference(values, isovalue, spacing, method="{method}")
    return mesh.vertices, mesh.simplices


@isograde.parametrize_with_claims(
    [extract], only={cases}, expected_failures={known}, strict=True
)
def test_my_extractor(implementation, claim):
    claim(implementation)
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("method", "known", "said"),
    [
        ("lorensen-cline", {"topology.closed": "the flaw of 1987"}, "2 passed, 52 deselected"),
        ("lorensen-cline", {}, "1 failed, 2 passed"),
        ("asymptotic-decider", {"topology.closed": "mended"}, "1 failed, 2 passed"),
    ],
)
def test_ones_own_test_file_has_a_test_a_claim(
    method: str, known: dict[str, str], said: str, tmp_path: Path
) -> None:
    """An expected failure is an xfail; without the list it fails; mended, strict says so."""
    text = OWN.format(method=method, known=known, cases=CASES)
    (tmp_path / "test_mine.py").write_text(text, encoding="utf-8")
    done = pytest_of(tmp_path, "-q", "-k", FEW)
    if "deselected" in said:
        assert done.returncode == 0, done.stdout
        assert re.search(r"2 passed, \d+ deselected, 1 xfailed", done.stdout), done.stdout
    else:
        assert done.returncode == 1
        assert said in done.stdout
        assert "[topology.closed]" in done.stdout
    if method == "lorensen-cline" and not known:
        assert "isograde.grade(extract, only=['" in done.stdout


def test_a_list_that_names_no_claim_is_told_where_it_stands() -> None:
    with pytest.raises(ExpectationError, match=r"did you mean topology\.closed"):
        isograde.parametrize_with_claims([SOUND], expected_failures={"topology.closd": "x"})
    with pytest.raises(ExpectationError, match="known bodies"):
        isograde.parametrize_with_claims([SOUND], expected_failures={"bodies.pieces": "x"})
    with pytest.raises(UnknownName, match="skimage:lewiner"):
        isograde.parametrize_with_claims(["skimage:levine"])


NOTHING = """
import numpy as np

def extract(values, isovalue, spacing):
    {what}
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "what",
    ["return np.empty((0, 3)), np.empty((0, 3), int)", "raise NotImplementedError('not today')"],
    ids=["empty", "declines"],
)
def test_who_answers_nothing_does_not_pass(what: str, tmp_path: Path) -> None:
    """Attack: skipped tests alone would be green; known bodies need evidence."""
    (tmp_path / "mine.py").write_text(NOTHING.format(what=what), encoding="utf-8")
    done = pytest_of(
        tmp_path, *CONFORMANCE, "--isograde", "python:mine.py:extract", "-q", "-k", "bodies"
    )
    assert done.returncode == 1
    assert re.search(r"\d+ failed", done.stdout)
