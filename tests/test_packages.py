"""What is published: metadata from one setting, light packages, a recipe that agrees."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parent.parent
SETTING = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = SETTING["project"]
HOME = SETTING["tool"]["hatch"]["metadata"]["hooks"]["custom"]["home"]
LIGHT = {
    "numpy", "scipy", "typer", "rich", "jinja2", "jsonschema", "fastjsonschema", "psutil",
    "cloudpickle",
}  # fmt: skip
BASE_MEGABYTES = 300


def names(requirements: list[str]) -> set[str]:
    """The distributions that requirements name."""
    return {re.split(r"[\s>=<\[]", one)[0].lower() for one in requirements}


def test_the_base_install_is_what_the_design_says() -> None:
    """Design, dependencies.

    Beside them cloudpickle, for functions of a notebook, and the compiled schema of reports.
    """
    assert names(PROJECT["dependencies"]) == LIGHT
    extras = PROJECT["optional-dependencies"]
    assert "weasyprint" in names(extras["dossier"])
    assert {"scikit-image", "vtk", "manifold3d", "pymeshlab"} <= names(extras["libraries"])
    everything = re.findall(r"\w+", extras["all"][0])[1:]
    assert set(everything) >= {"libraries", "data", "search", "pytest", "dossier", "plots"}


def tracked() -> list[Path]:
    """The text files that git knows."""
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, encoding="utf-8", check=False
    )
    if listed.returncode:
        pytest.skip("no checkout of git")
    return [ROOT / name for name in listed.stdout.split("\0") if name]


def test_one_setting_says_where_the_project_lives() -> None:
    """The home stands in pyproject.toml, and in the recipe that a test holds to it."""
    host = HOME.split("/")[2]
    found = set()
    for path in tracked():
        if path.suffix in {".gz", ".png", ".npz"} or not path.is_file() or path == Path(__file__):
            continue
        if host in path.read_text(encoding="utf-8", errors="ignore"):
            found.add(path.relative_to(ROOT).as_posix())
    assert found == {"pyproject.toml", "packaging/conda-forge/recipe.yaml"}


def test_the_recipe_is_that_of_the_project() -> None:
    text = (ROOT / "packaging" / "conda-forge" / "recipe.yaml").read_text(encoding="utf-8")
    recipe = yaml.safe_load(text)
    assert recipe["context"] == {"version": PROJECT["version"], "home": HOME}
    wanted = {re.sub(r"(>=)", r" \1", one) for one in PROJECT["dependencies"]}
    assert set(recipe["requirements"]["run"][1:]) == wanted
    assert recipe["about"]["license"] == PROJECT["license"]
    entry = PROJECT["scripts"]["isograde"]
    assert recipe["build"]["python"]["entry_points"] == [f"isograde = {entry}"]


def test_the_citation_has_the_version_and_a_date() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["version"] == PROJECT["version"]
    assert re.fullmatch(r"\d{4}-\d\d-\d\d", str(citation["date-released"]))


def test_the_change_log_begins_with_what_is_prepared() -> None:
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.findall(r"^## (.*)", text, re.M)[0] == "1.0.0, not yet dated"


def test_classifiers_name_every_python_that_is_supported() -> None:
    classifiers = PROJECT["classifiers"]
    named = [one.rsplit("3.", 1)[1] for one in classifiers if "Python :: 3." in one]
    assert named == ["11", "12", "13", "14"]


@pytest.mark.slow
def test_packages_are_checked_by_twine_and_hold_what_they_should(packages: Path) -> None:
    """No reports in the sdist; the README's links absolute; the wheel has what it reads."""
    import tarfile
    import zipfile

    files = sorted(map(str, packages.iterdir()))
    assert len(files) == 2
    done = subprocess.run(
        [sys.executable, "-m", "twine", "check", "--strict", *files],
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    assert done.returncode == 0, done.stdout
    (wheel,) = packages.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        held = set(archive.namelist())
        (metadata,) = (one for one in held if one.endswith("METADATA"))
        said = archive.read(metadata).decode()
        (entries,) = (one for one in held if one.endswith("entry_points.txt"))
        assert "isograde = isograde.pytest_plugin" in archive.read(entries).decode()
    wanted = ("catalogue.json", "py.typed", "report/schema.json", "report/templates/report.html")
    assert {f"isograde/{name}" for name in wanted} <= held
    body = said.partition("\n\n")[2]
    assert f"Project-URL: Homepage, {HOME}" in said
    assert "](reports/" not in body
    assert f"({HOME}/raw/main/reports/report.png)" in body
    (sdist,) = packages.glob("*.tar.gz")
    with tarfile.open(sdist) as archive:
        folders = {name.split("/")[1] for name in archive.getnames() if "/" in name}
    assert "reports" not in folders
    assert {"reference", "validation", "tests", "README.md", "LICENSE"} <= folders
    assert sdist.stat().st_size < 20e6


MINE = """
from isoref import extract as reference

def extract(values, isovalue, spacing):
    mesh = reference(values, isovalue, spacing)
    return mesh.vertices, mesh.simplices
"""


@pytest.mark.slow
def test_the_wheel_alone_checks_and_grades_ones_own_function(clean: Path, tmp_path: Path) -> None:
    """In a clean environment, base alone: under 300 MB, and what is missing says its extra."""
    binaries = clean / "bin"
    (packed,) = clean.glob("lib/python*/site-packages")
    listed = subprocess.run(
        [str(binaries / "pip"), "list", "--format", "freeze"],
        capture_output=True,
        encoding="utf-8",
        check=True,
    )
    assert not {"scikit-image", "vtk", "matplotlib", "trimesh"} & names(listed.stdout.split())
    tools = {"pip", "setuptools", "wheel"}
    size = sum(
        path.stat().st_size
        for folder in packed.iterdir()
        if not any(folder.name.startswith(tool) for tool in tools)
        for path in ([folder] if folder.is_file() else folder.rglob("*"))
        if path.is_file()
    )
    assert size < BASE_MEGABYTES * 1e6
    work = tmp_path / "work"
    work.mkdir()
    (work / "mine.py").write_text(MINE, encoding="utf-8")

    def isograde(*arguments: str) -> subprocess.CompletedProcess[str]:
        command = [str(binaries / "isograde"), *arguments]
        return subprocess.run(command, cwd=work, capture_output=True, encoding="utf-8", check=False)

    checked = isograde("check", "python:mine:extract", "--timeout", "60")
    assert checked.returncode in (0, 1), checked.stderr
    assert "it started" in checked.stdout
    graded = isograde("grade", "python:mine:extract", "--only", "pairs/02*", "--only", "topology.*")
    assert graded.returncode == 0, graded.stdout + graded.stderr
    assert (work / "report" / "only" / "report.html").is_file()
    assert "not installed" in isograde("list", "implementations").stdout
    absent = isograde("grade", "skimage:lewiner")
    assert absent.returncode == 3
    assert "isograde[libraries]" in absent.stderr
