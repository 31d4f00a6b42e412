"""The design's rules about who may import whom, checked on the code itself."""

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
REFERENCE = ROOT / "reference" / "isoref"
GRADER = ROOT / "validation" / "isograde"
WORDS = {"isoref.field", "isoref.mesh"}
# The doors and the command reach the reference as one more implementation; the proof takes a
# rule of the reference as what it judges.
MAY_REACH_THE_REFERENCE = {"doors", "command.py", "proof.py"}
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
)


def imports(path: Path) -> Iterator[str]:
    """Every module a file imports, at its top or inside a function."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module


def modules(package: Path) -> list[Path]:
    """Every Python file of a package."""
    return sorted(package.rglob("*.py"))


def test_the_reference_imports_nothing_of_the_grader() -> None:
    """Design: `isoref` imports nothing of `isograde`."""
    guilty = [p.name for p in modules(REFERENCE) if any("isograde" in m for m in imports(p))]
    assert not guilty


def test_the_grader_takes_two_words_from_the_reference() -> None:
    """Design: `isograde` reaches `isoref` only through a door; field and mesh are vocabulary."""
    guilty = [
        (str(p.relative_to(GRADER)), m)
        for p in modules(GRADER)
        if p.relative_to(GRADER).parts[0] not in MAY_REACH_THE_REFERENCE
        for m in imports(p)
        if m.split(".")[0] == "isoref" and m not in WORDS
    ]
    assert not guilty


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
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
