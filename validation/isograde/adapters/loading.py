"""From a name to a function: what a worker process runs.

How to write an implementation in Python
----------------------------------------
A function ``function(values, isovalue, spacing) -> (vertices, faces)``:

values      NumPy array of n axes, of any real type and any memory layout; not to be written to
isovalue    a float
spacing     a tuple of n floats
vertices    (V, n) numbers: ``index * spacing``, coordinates in the order of the array's axes
faces       (S, n) integers, rows of 0-based indices into `vertices`

Name it ``python:package.module:function`` or ``python:path/to/file.py:function``.

It may say what it is in a declaration (`isograde.adapters.declaring`): a dictionary, or a function
without parameters that returns one, found as an attribute ``declaration`` of the function, or
else under the name ``declaration`` in its module. To decline a field, raise `NotImplementedError`.
With ``{"discipline": "curves"}``, ``"contours"`` or ``"simplices"`` the function has that
discipline's own signature (`isograde.disciplines`).
"""

from __future__ import annotations

import importlib
import importlib.util
import re
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

from isograde.adapters.declaring import declaration_from
from isograde.adapters.ready_made import READY_MADE
from isograde.model import AdapterError, Declaration, Extract

# The system packages (Debian's names) that hold the shared libraries wheels do not bring along.
SYSTEM_PACKAGES = {
    "libGL.so": "libgl1",
    "libEGL.so": "libegl1",
    "libGLU.so": "libglu1-mesa",
    "libGLX.so": "libglx0",
    "libOpenGL.so": "libopengl0",
    "libOSMesa.so": "libosmesa6",
    "libX11.so": "libx11-6",
    "libXext.so": "libxext6",
    "libXrender.so": "libxrender1",
    "libXt.so": "libxt6",
    "libXcursor.so": "libxcursor1",
    "libSM.so": "libsm6",
    "libICE.so": "libice6",
    "libgomp.so": "libgomp1",
    "libglib-2.0.so": "libglib2.0-0",
    "libxkbcommon.so": "libxkbcommon0",
}


def load(spec: str) -> tuple[Extract, Declaration]:
    """The function that `spec` names, and what it declares; raises `AdapterError`."""
    if spec.startswith("python:"):
        return _load_python(spec)
    ready = READY_MADE[spec]
    try:
        return ready.load(), ready.declaration(spec)
    except (ImportError, OSError) as error:
        raise AdapterError(f"{spec}: {advice(error, ready.distribution)}") from error


def advice(error: Exception, distribution: str) -> str:
    """What to install, where an import of the distribution failed with `error`.

    >>> advice(ImportError("libGL.so.1: cannot open shared object file"), "vtk")
    'the system library libGL.so.1 is missing: install it (Debian, Ubuntu: apt-get install libgl1)'
    >>> advice(ModuleNotFoundError("No module named 'vtk'"), "vtk")
    "No module named 'vtk': pip install vtk"
    """
    missing = re.match(r"(lib[\w+.-]+\.so[\d.]*): cannot open shared object", str(error))
    if not missing:
        return f"{error}: pip install {distribution}"
    library = missing[1]
    package = SYSTEM_PACKAGES.get(library[: library.index(".so") + 3])
    how = f"apt-get install {package}" if package else f"apt-file search {library} names it"
    return f"the system library {library} is missing: install it (Debian, Ubuntu: {how})"


def _load_python(spec: str) -> tuple[Extract, Declaration]:
    """The function of a ``python:`` name, and what it declares."""
    place, _, name = spec.removeprefix("python:").rpartition(":")
    if not place or not name:
        raise AdapterError(
            f"{spec}: write python:package.module:function or python:file.py:function"
        )
    try:
        module = _module(place)
    except Exception as error:
        raise AdapterError(f"{spec}: importing {place}: {type(error).__name__}: {error}") from error
    function = module
    for part in name.split("."):
        function = getattr(function, part, None)  # type: ignore[assignment]
    if not callable(function):
        others = [n for n in vars(module) if callable(getattr(module, n)) and n[0] != "_"]
        raise AdapterError(f"{spec}: {place} has no function {name}; it has {', '.join(others)}")
    said = getattr(function, "declaration", getattr(module, "declaration", {}))
    try:
        said = said() if callable(said) else said
    except Exception as error:
        raise AdapterError(
            f"{spec}: its declaration raised {type(error).__name__}: {error}"
        ) from error
    declaration = declaration_from(said, spec)
    return _as_called(function, declaration), declaration


# Disciplines whose functions have a signature of their own, adapted by their `through_adapter`.
OWN_SIGNATURE = ("contours", "curves", "simplices")


def _as_called(function: Any, declaration: Declaration) -> Extract:
    """The function as the worker calls it, whatever the signature of its discipline."""
    name = declaration.discipline
    if name in OWN_SIGNATURE and not getattr(function, "adapted", False):
        discipline = importlib.import_module(f"isograde.disciplines.{name}")
        adapted: Extract = discipline.through_adapter(function)
        return adapted
    extract: Extract = function
    return extract


def _module(place: str) -> ModuleType:
    """The module with this dotted name, or in this file."""
    if not place.endswith(".py"):
        return importlib.import_module(place)
    path = Path(place).resolve()
    if not path.is_file():
        raise FileNotFoundError(f"no such file: {path}")
    sys.path.insert(0, str(path.parent))
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    return module
