"""The league's programs beside the grader: versions of libraries, and costs beside a peer."""

import importlib
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from isograde.adapters.registry import READY_MADE

HERE = Path(__file__).parents[2] / "validation" / "league"


@pytest.fixture(scope="module")
def versions() -> ModuleType:
    """The program, which stands in no package."""
    return _program("versions")


@pytest.fixture(scope="module")
def speed() -> ModuleType:
    """The program, which stands in no package."""
    return _program("speed")


def _program(name: str) -> ModuleType:
    """A program beside the recipes, found as it finds the others."""
    sys.path.insert(0, str(HERE))
    try:
        return importlib.import_module(name)
    finally:
        sys.path.remove(str(HERE))


def test_four_libraries_have_three_versions_each(versions: ModuleType) -> None:
    """Issue 16: the current one included, the oldest first."""
    for library in ("skimage", "vtk", "pymcubes", "libigl"):
        found = versions.versions(library)
        assert len(found) >= 3
        assert len({package.name for package in found}) == len(found)
        for package in found:
            (wanted,) = [one for one in package.said["install"]["pip"] if "==" in one]
            assert wanted == f"{package.said['package']}=={package.said['version']}"


def test_a_version_declares_what_the_ready_made_name_does(versions: ModuleType) -> None:
    """The same functions and words, so that only the library differs."""
    package = versions.versions("skimage")[0]
    said = package.declaration("skimage-lewiner")
    assert said["name"] == "skimage:lewiner"
    assert said["version"] == package.said["version"]
    assert said["conventions"] == READY_MADE["skimage:lewiner"].said["conventions"]


def test_a_library_without_versions_is_wrong_use(
    versions: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    """Status 2, and what there is."""
    assert versions.main(["nobody"]) == 2
    assert "no versions of nobody; of skimage" in capsys.readouterr().err


def test_an_unknown_method_is_wrong_use(
    speed: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    """Status 2."""
    assert speed.main(["nobody"]) == 2
    assert "no nobody" in capsys.readouterr().err


def test_curves_and_functions_are_not_timed_beside_surfaces(speed: ModuleType) -> None:
    """Only what takes samples in space is asked; each name once."""
    names = [name for _, _, name in speed.asked(())]
    assert len(names) == len(set(names))
    assert {"gts", "vtk-js", "skimage:lewiner"} <= set(names)
    assert not {"skimage:find-contours", "pymcubes:func", "vtk:contour-twice"} & set(names)


def test_the_service_tells_what_a_call_costs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Seconds of the clock, of the processor, and kilobytes: a line a call, where it is asked."""
    monkeypatch.syspath_prepend(str(HERE / "services"))
    serve = importlib.import_module("serve")
    monkeypatch.setenv("ISOGRADE_COST", str(tmp_path / "cost"))
    cost = serve.Cost()
    filled = np.ones(4_000_000)
    assert cost.told() > 0
    seconds, processor, kilobytes = map(float, (tmp_path / "cost").read_text().split())
    assert filled.all()
    assert seconds > 0
    assert processor >= 0
    assert kilobytes == 0 or kilobytes > 20_000, "the array was not seen"


def test_the_service_takes_a_mesh_whatever_comes_after_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """scikit-image's ready-made function answers with normals too."""
    monkeypatch.syspath_prepend(str(HERE / "services"))
    serve = importlib.import_module("serve")
    np.save(tmp_path / "values.npy", np.zeros((2, 2, 2)))
    asked = {
        "values": str(tmp_path / "values.npy"),
        "isovalues": [0.5],
        "spacing": [1.0, 1.0, 1.0],
        "directory": str(tmp_path),
    }
    corners = np.eye(3)
    told = serve.answer(asked, lambda *_: (corners, [[0, 1, 2]], corners), {})
    assert "error" not in told
    assert np.load(tmp_path / told["simplices"]).tolist() == [[0, 1, 2]]
