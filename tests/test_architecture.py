"""The design's rules about who may import whom, checked on the code itself."""

import ast
import subprocess
import sys
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
REFERENCE = ROOT / "reference" / "isoref"
GRADER = ROOT / "validation" / "isograde"
WORDS = {"isoref.field", "isoref.mesh"}
# The adapters, the calls and the command reach the reference as one more implementation; the proof
# takes a rule of the reference as what it judges.
MAY_REACH_THE_REFERENCE = {"adapters", "calls.py", "command.py", "commands", "proof"}
EXTRAS = (
    "mcubes",
    "vtk",
    "vtkmodules",
    "igl",
    "contourpy",
    "nibabel",
    "pooch",
    "tifffile",
    "pyvista",
    "SimpleITK",
    "h5py",
    "zarr",
    "meshio",
)


def imports(path: Path) -> Iterator[str]:
    """Every module a file imports, at its top or inside a function."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module


def taken(path: Path) -> Iterator[str]:
    """Every module a file imports, as one too where it is taken as a name out of its package."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (one.name for one in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            for one in node.names:
                inner = f"{node.module}.{one.name}"
                place = Path(*inner.split("."))
                there = any(
                    (root / one).exists()
                    for root in (REFERENCE.parent, GRADER.parent)
                    for one in (place.with_suffix(".py"), place / "__init__.py")
                )
                yield inner if there else node.module


def name(path: Path) -> str:
    """The name by which the module in this file is imported."""
    root = REFERENCE.parent if path.is_relative_to(REFERENCE) else GRADER.parent
    parts = path.relative_to(root).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def modules(package: Path) -> list[Path]:
    """Every Python file of a package."""
    return sorted(package.rglob("*.py"))


def test_the_reference_imports_nothing_of_the_grader() -> None:
    """Design: `isoref` imports nothing of `isograde`."""
    guilty = [p.name for p in modules(REFERENCE) if any("isograde" in m for m in imports(p))]
    assert not guilty


def test_the_grader_takes_two_words_from_the_reference() -> None:
    """Design: `isograde` reaches `isoref` through adapters; field and mesh are words."""
    guilty = [
        (str(p.relative_to(GRADER)), m)
        for p in modules(GRADER)
        if p.relative_to(GRADER).parts[0] not in MAY_REACH_THE_REFERENCE
        and p.parent != GRADER / "exercises" / "given"  # extractors to mend, under test themselves
        for m in imports(p)
        if m.split(".")[0] == "isoref" and m not in WORDS
    ]
    assert not guilty


def test_the_reference_needs_numpy_and_scipy_alone() -> None:
    """Design, dependencies: dask is an extra, imported where it is called, in one module."""
    own = {"isoref", "numpy", "scipy", *sys.stdlib_module_names}
    needed = {p: {m.split(".")[0] for m in imports(p)} for p in modules(REFERENCE)}
    assert "numpy" in set().union(*needed.values())
    foreign = {p.name: found - own for p, found in needed.items() if not found <= own}
    assert foreign == {"distributed.py": {"dask"}}


def test_articles_know_nothing_of_their_twins_but_the_catalogue_does() -> None:
    """Design, plain and fast: who reads an article meets no engine; users get the fast one."""
    plain = [p for p in modules(REFERENCE) if p.parent == REFERENCE]
    users = {p.name for p in plain if any(m.startswith("isoref.fast") for m in imports(p))}
    twins = {p.name for p in modules(REFERENCE / "fast")}
    assert "methods.py" in users
    assert not users & twins


@pytest.mark.parametrize("package", [REFERENCE, GRADER])
def test_no_module_imports_itself_through_others(package: Path) -> None:
    """Data flows one way, and so do imports, those inside functions too."""
    paths = {name(path): path for path in modules(package)}
    graph = {one: {other for other in taken(paths[one]) if other in paths} for one in paths}
    assert sum(map(len, graph.values())) > 20
    tuple(TopologicalSorter(graph).static_order())  # Raises CycleError, which names the cycle.


@pytest.mark.parametrize(
    "module", ["isograde.command", "isograde.checking", "isograde.adapters.worker"]
)
def test_help_and_check_wait_for_nothing_they_do_not_use(module: str) -> None:
    """A newcomer's first commands import neither SciPy nor what draws, writes or reads files.

    Help does without NumPy, and without what draws boxes and coerces parameters.
    """
    program = f"import sys, {module}; print(*{{one.split('.')[0] for one in sys.modules}})"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, encoding="utf-8", check=True
    )
    heavy = {"scipy", "trimesh", "matplotlib", "jinja2", "jsonschema", "skimage"}
    assert "isograde" in done.stdout.split()
    heavy |= {"numpy", "rich", "pydantic"} if module == "isograde.command" else set()
    assert not heavy & set(done.stdout.split())


@pytest.mark.parametrize("package", ["isoref", "isograde"])
def test_every_module_imports_without_the_extras(package: str) -> None:
    """Design: peers under test are an extra, never needed to import."""
    program = f"""
import importlib, importlib.abc, pkgutil, sys

class Absent(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {EXTRAS!r}:
            raise ModuleNotFoundError(name)

sys.meta_path.insert(0, Absent())
package = importlib.import_module({package!r})
for module in pkgutil.walk_packages(package.__path__, {package!r} + "."):
    importlib.import_module(module.name)
"""
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        encoding="utf-8",
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("folder", ["validation", "benchmarks", "tests"])
def test_what_programs_print_is_read_as_utf8(folder: str) -> None:
    """Never in the locale's encoding, which a library in the same process may set to ASCII."""
    calls = 0
    for path in sorted((ROOT / folder).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call):
                words = {word.arg for word in node.keywords}
                calls += "encoding" in words
                read = words & {"capture_output", "stdout", "stderr"}
                locale = words & {"text", "universal_newlines"}
                assert not (read and locale), f"{path}:{node.lineno}: say encoding="
    assert calls
