"""What `import isograde` gives: grade, check, compare and extract."""

import subprocess
import sys
from functools import partial
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import isograde
import numpy as np
import pytest
from isograde.adapters.functions import named
from isograde.formats.reading import VolumeError
from isograde.model import AdapterError, UnknownName
from isograde.report import reading
from isograde.results import Grade
from isograde.runner import NothingToRun
from isoref.methods import METHODS
from isoref.methods import extract as reference

from tests.isograde.reporting import made, row

FEW = ["pairs/0217", "structure.*", "topology.*"]


def mine(values: Any, isovalue: float, spacing: Any, method: str = "asymptotic-decider") -> Any:
    """The reference, as a function of this file, which no process could import by its name."""
    mesh = reference(values, isovalue, spacing, method=method)
    return mesh.vertices, mesh.simplices


def test_every_public_name_is_there_and_documented() -> None:
    assert set(isograde.__all__) <= set(dir(isograde))
    for name in isograde.__all__:
        assert getattr(isograde, name).__doc__
    with pytest.raises(AttributeError, match="no attribute 'grde'"):
        isograde.grde  # noqa: B018 - a name that is not there


def test_what_is_public_waits_to_be_used() -> None:
    """`import isograde` imports nothing else, so that help and a plug-in of pytest are quick."""
    program = "import sys, isograde; print('numpy' in sys.modules, 'rich' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, encoding="utf-8", check=True
    )
    assert done.stdout.split() == ["False", "False"]


@pytest.mark.parametrize(
    "implementation",
    [
        "isoref:asymptotic-decider",
        reference,
        mine,
        partial(mine, method="asymptotic-decider"),
        lambda values, isovalue, spacing: mine(values, isovalue, spacing),
    ],
    ids=["name", "importable", "of this file", "partial", "lambda"],
)
def test_a_function_is_graded_wherever_it_stands(implementation: Any) -> None:
    found = isograde.grade(implementation, only=FEW, show_progress=False)
    assert found.holds
    assert found.status == 0
    assert not found.failures
    assert found.report.summaries["topology.closed"].passed == 1


def test_an_importable_function_goes_by_its_name_and_no_folder_is_told() -> None:
    assert isograde.grade(reference, only=FEW).report.spec == "python:isoref.methods:extract"
    found = isograde.grade(partial(mine, method="lorensen-cline"), only=FEW)
    assert found.report.spec == "function:mine"
    assert found.report.name == "function:mine"
    said = str(found)
    assert "isograde.grade(mine, only=['given/" in said
    assert "/tmp" not in said


def test_what_fails_is_told_in_print_and_in_a_notebook(tmp_path: Path) -> None:
    found = isograde.grade("isoref:lorensen-cline", only=["pairs/0217"])
    assert not found.holds
    assert found.status == 1
    assert found.failures["topology.closed"].partition(": ")[2].startswith("4 edges")
    assert "topology.closed: 1 fail" in str(found)
    html = found._repr_html_()
    assert "topology.closed" in html
    parser = HTMLParser()
    parser.feed(html)
    parser.close()
    assert "<script" not in html.partition("<details>")[0]
    saved = found.save(tmp_path / "report")
    assert reading.read(saved / "report.jsonl").broken
    assert (saved / "report.html").exists()
    again = isograde.compare(saved)
    assert again.grades[0].failures == found.failures


def test_what_names_nothing_or_does_not_start_is_raised() -> None:
    with pytest.raises(UnknownName, match="did you mean skimage:lewiner"):
        isograde.grade("skimage:levine")
    with pytest.raises(AdapterError, match="4 arguments"):
        isograde.grade(lambda a, b, c, d: None)
    with pytest.raises(NothingToRun, match=r"topology\.closed"):
        isograde.grade("isoref:lorensen-cline", only=["topology.closd"])
    with pytest.raises(TypeError, match="a function or a name, not int"):
        isograde.grade(3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="needs an implementation"):
        isograde.compare()


def test_reports_of_unlike_plans_are_not_compared() -> None:
    """As the command refuses them: what differs might be the grader."""
    one, other = (Grade(made([row("noise/a")])) for _ in range(2))
    assert len(isograde.compare(one, other).grades) == 2
    other.report.header["seed"] = 1
    with pytest.raises(ValueError, match="unlike plans: the seed is 0 for mine, 1 for mine"):
        isograde.compare(one, other)


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ({"jobs": 0}, "jobs=0: give a whole number of at least 1"),
        ({"jobs": "two"}, "jobs='two'"),
        ({"seed": -1}, "at least 0"),
        ({"seed": 1.5}, "whole number"),
        ({"memory": 0}, "at least 16"),
        ({"timeout": 0}, "timeout=0: give seconds"),
        ({"timeout": float("nan")}, "timeout=nan"),
        ({"timeout": float("inf")}, "timeout=inf"),
        ({"timeout": "30"}, "timeout='30'"),
        ({"expected_failures": ["topology.closed"]}, "a file of expectations, not a list"),
    ],
)
def test_a_wrong_number_is_told_before_anything_starts(wrong: Any, told: str) -> None:
    """As the command tells it: an unchecked 0 would make every call run out of time."""
    with pytest.raises(ValueError, match=told):
        isograde.grade("isoref:lorensen-cline", only=FEW, **wrong)


def test_check_takes_seconds_too() -> None:
    with pytest.raises(ValueError, match="timeout=-1"):
        isograde.check(reference, timeout=-1)


def test_one_id_is_as_good_as_a_list() -> None:
    """A text is no sequence of letters."""
    found = isograde.grade(reference, only="cells/inside/001", show_progress=False)
    assert list(found.report.cases) == ["cells/inside/001"]


def test_a_function_that_cannot_be_sent_says_what_to_do() -> None:
    held = (line for line in "abc")
    with pytest.raises(AdapterError, match="put it in a module"):
        isograde.check(lambda values, isovalue, spacing: held)


def test_a_check_says_what_is_wrong_with_the_call() -> None:
    def one_based(values: Any, isovalue: float, spacing: Any) -> Any:
        vertices, rows = mine(values, isovalue, spacing)
        return vertices, rows + 1

    found = isograde.check(one_based)
    assert found.started
    assert not found.right
    assert "count vertices from 1: subtract 1" in str(found)
    assert "count vertices from 1" in found._repr_html_()


def test_a_comparison_ranks_and_writes(tmp_path: Path) -> None:
    found = isograde.compare("isoref:lorensen-cline", reference, only=["pairs/0217"])
    assert found.ranking == ["python:isoref.methods:extract", "isoref:lorensen-cline"]
    assert "lorensen" in found._repr_html_()
    assert found.save(tmp_path / "table.md").read_text(encoding="utf-8").startswith("# Comparison")
    with pytest.raises(ValueError, match="neither"):
        found.save(tmp_path / "table.pdf")


def test_extract_takes_an_array_or_a_file(tmp_path: Path) -> None:
    values = 9.0 - ((np.indices((9, 9, 9)) - 4.0) ** 2).sum(axis=0)
    np.save(tmp_path / "ball.npy", values)
    of_array = isograde.extract(values, 0.0)
    of_file = isograde.extract(tmp_path / "ball.npy", 0.0, method="trilinear-cubes")
    assert len(of_array.simplices) == len(of_file.simplices) > 100
    doubled = isograde.extract(values, 0.0, spacing=(2, 2, 2), origin=(1, 0, 0))
    assert np.allclose(doubled.vertices, 2 * of_array.vertices + [1, 0, 0])
    assert sorted(METHODS) == sorted(set(METHODS))
    with pytest.raises(ValueError, match="did you mean asymptotic-decider"):
        isograde.extract(values, 0.0, method="asymtotic-decider")
    with pytest.raises(ValueError, match="its own spacing"):
        isograde.extract(tmp_path / "ball.npy", 0.0, spacing=(1, 1, 1))


def test_extract_leaves_absent_samples_out_and_caps_beside_them(tmp_path: Path) -> None:
    """Of a masked array, of one with NaN, and of a file: the same closed surface."""
    values = 9.0 - ((np.indices((9, 9, 9)) - 4.0) ** 2).sum(axis=0)
    mask = np.zeros(values.shape, bool)
    mask[4, 4, 4:] = True
    holed = np.where(mask, np.nan, values)
    np.save(tmp_path / "holed.npy", holed)
    masked = np.ma.masked_array(values, mask)
    meshes = [
        isograde.extract(volume, 0.0, cap=True, absent=True)
        for volume in (holed, masked, tmp_path / "holed.npy")
    ]
    for mesh in meshes:
        assert np.array_equal(mesh.vertices, meshes[0].vertices)
        edges = np.sort(mesh.simplices[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    with pytest.raises(VolumeError, match="nan"):
        isograde.extract(tmp_path / "holed.npy", 0.0)


def test_extract_draws_a_label_where_the_scan_stands_and_caps_it(tmp_path: Path) -> None:
    """An oblique, mirrored NIfTI: label 2 fills its last four planes, and the cap ends there."""
    nibabel = pytest.importorskip("nibabel")
    values = np.zeros((7, 8, 9), np.uint8)
    values[:, 2:6, 5:] = 2
    affine = np.array([[-0.6, 0, 0.8, 5], [0.8, 0, 0.6, 6], [0, 2.0, 0, 7], [0, 0, 0, 1]])
    nibabel.save(nibabel.Nifti1Image(values, affine), tmp_path / "labels.nii")
    mesh = isograde.extract(tmp_path / "labels.nii", label=2, cap=True)
    index = np.linalg.solve(affine[:3, :3], (mesh.vertices - affine[:3, 3]).T).T
    assert np.allclose(index.min(axis=0), [0, 1.5, 4.5], atol=1e-6)
    assert np.allclose(index.max(axis=0), [6, 5.5, 8], atol=1e-6)
    a, b, c = np.moveaxis(mesh.vertices[mesh.simplices], 1, 0)
    # A box of 6 x 4 x 3.5 steps, two of its long edges cut off by an eighth of a square.
    whole = 6 * (4 * 3.5 - 2 * 0.5**2 / 2) * abs(np.linalg.det(affine))
    assert (a * np.cross(b, c)).sum() / 6 == pytest.approx(whole)
    with pytest.raises(ValueError, match="no sample has the label 3; there are 0, 2"):
        isograde.extract(tmp_path / "labels.nii", label=3)
    for isovalue, label in ((None, None), (1.0, 2)):
        with pytest.raises(ValueError, match="an isovalue, or a label in its place"):
            isograde.extract(values, isovalue, label=label)


@pytest.mark.slow
def test_a_script_without_a_guard_is_graded_in_several_processes(tmp_path: Path) -> None:
    """Processes do not run the caller's script again: no fork bomb, and each line printed once."""
    script = tmp_path / "script.py"
    script.write_text(
        "import isograde\n"
        "from isoref.methods import extract\n"
        "print('once')\n"
        "def mine(values, isovalue, spacing):\n"
        "    return extract(values, isovalue, spacing)\n"
        "print(isograde.grade(mine, only=['cells/outside/*', 'topology.closed'], jobs=2).holds)\n",
        encoding="utf-8",
    )
    done = subprocess.run(
        [sys.executable, script], capture_output=True, encoding="utf-8", check=False
    )
    assert done.stdout.split() == ["once", "True"], done.stderr


def test_a_module_that_grades_itself_while_it_is_imported_is_told(tmp_path: Path) -> None:
    """Attack: each process would import the module, which would start another process."""
    script = tmp_path / "mine.py"
    script.write_text(
        "import isograde\n"
        "def extract(values, isovalue, spacing):\n"
        "    return [], []\n"
        "isograde.check(extract)\n",
        encoding="utf-8",
    )
    with pytest.raises(AdapterError, match="cannot be graded itself"):
        isograde.grade(f"python:{script}:extract")


def test_names_of_functions_are_those_a_new_process_can_open() -> None:
    with named(lambda values, isovalue, spacing: None) as spec:
        assert spec.startswith("pickle:")
        path = Path(spec.removeprefix("pickle:"))
        assert path.is_file()
    assert not path.exists()
    with named("skimage:lewiner") as spec:
        assert spec == "skimage:lewiner"
