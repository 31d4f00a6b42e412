"""The suites of scikit-image, trimesh and contourpy, with the calls of the page in place of theirs.

Their wheels bring no tests; their source distributions do (`tests.peers.fetching`). Each suite runs
as it is, in a process of its own, with `tests.peers.substituting`. A test of theirs that fails is
listed here with its reason; one that is listed and passes fails ours. PyMCubes' source distribution
brings no tests either, and VTK has none in a package.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tarfile
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.peers.fetching import CannotBeHadError, fetched, unpacked

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Suite:
    """Files of a source distribution, and what is expected of them.

    package : the source distribution
    files : the files of tests
    passes : how many of the tests that call ours pass
    chosen : what pytest's -k chooses of them
    differs : patterns of names of tests that fail, each with the reason
    """

    package: str
    files: tuple[str, ...]
    passes: int
    chosen: str = ""
    differs: tuple[tuple[str, str], ...] = ()


SUITES = (
    Suite(
        "scikit-image",
        (
            "tests/skimage/measure/test_marching_cubes.py",
            "tests/skimage/measure/test_find_contours.py",
        ),
        25,
    ),
    Suite(
        "trimesh",
        ("tests/test_voxel.py",),
        2,
        # What of it asks for surfaces; the model that `test_voxel` draws is not brought along.
        "marching",
    ),
    Suite(
        "contourpy",
        ("suite/test_lines.py", "suite/test_minimal.py"),
        38,
        # Of its algorithms and forms those of the page; a million random points take minutes.
        "serial and not Chunk and not filled and not OuterCode and not random_big",
        (
            (r"_chunk|minimal_lines", "chunks are not offered"),
            (r"corner_mask|levels_type\[(False|True)", "masks are not offered"),
            (r"quad_as_tri", "quads are not drawn as triangles"),
            (r"z_nonfinite\[0.0-", "samples that are not finite are refused"),
            (r"return_by_line_type", "lines come in another order"),
        ),
    ),
)


def outcomes(suite: Suite, folder: Path) -> list[dict[str, object]]:
    """What became of each test of theirs."""
    place = unpacked(suite.package, folder)
    if suite.package == "contourpy":
        # A package of the name of ours; it looks for its pictures under the old name.
        (place / "tests").rename(place / "suite")
        (place / "tests").symlink_to("suite")
    said = folder / "said.jsonl"
    options = ["-p", "tests.peers.substituting", "-p", "no:cacheprovider", "-p", "no:xdist", "-q"]
    if suite.package != "contourpy":
        options.append("--noconftest")
    done = subprocess.run(
        [
            *(sys.executable, "-P", "-m", "pytest", *options),
            *("-c", os.devnull, "--rootdir", str(place), "-k", suite.chosen, *suite.files),
        ],
        cwd=place,
        env={**os.environ, "PYTHONPATH": str(ROOT), "ISOGRADE_PEERS_SAY": str(said)},
        capture_output=True,
        encoding="utf-8",
        timeout=300,
        check=False,
    )
    assert done.returncode in (0, 1), done.stdout + done.stderr
    return [json.loads(line) for line in said.read_text(encoding="utf-8").splitlines()]


@pytest.mark.slow
@pytest.mark.parametrize("suite", SUITES, ids=lambda suite: suite.package)
def test_their_suite_passes_but_for_what_is_listed(suite: Suite, tmp_path: Path) -> None:
    """Ours is called in each, what is not listed passes, what is listed fails, and why is said."""
    pytest.importorskip({"scikit-image": "skimage"}.get(suite.package, suite.package))
    try:
        found = outcomes(suite, tmp_path)
    except CannotBeHadError as error:
        pytest.skip(str(error))
    asked = [one for one in found if one["called"]]
    failed = {str(one["test"]): one["why"] for one in asked if one["outcome"] != "passed"}
    listed = {
        str(one["test"])
        for one in asked
        for pattern, _ in suite.differs
        if re.search(pattern, str(one["test"]))
    }
    assert failed.keys() == listed, {name: failed.get(name) for name in failed.keys() ^ listed}
    assert all(any(re.search(p, name) for name in failed) for p, _ in suite.differs)
    assert len(asked) - len(failed) == suite.passes


def test_the_page_says_what_runs() -> None:
    """How many of theirs pass, and each difference with its reason."""
    page = (ROOT / "docs" / "coming_from.rst").read_text(encoding="utf-8")
    for suite in SUITES:
        assert f"{suite.passes} tests of {suite.package}" in page.replace("\n", " ")
        for _, reason in suite.differs:
            assert reason in page.replace("\n", " ")


def test_pymcubes_brings_no_tests(tmp_path: Path) -> None:
    """As the page says."""
    mcubes = pytest.importorskip("mcubes")
    try:
        archive = fetched("pymcubes", mcubes.__version__, tmp_path)
    except CannotBeHadError as error:
        pytest.skip(str(error))
    with tarfile.open(archive) as names:
        assert not [name for name in names.getnames() if "test" in name]


def test_what_cannot_be_had_is_told(tmp_path: Path) -> None:
    """A version that was never published."""
    with pytest.raises(
        CannotBeHadError, match=r"the sources of contourpy 0\.0\.0 cannot be had here"
    ):
        fetched("contourpy", "0.0.0", tmp_path)
