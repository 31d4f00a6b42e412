"""From a name to a function: what a worker process runs.

How to write an implementation in Python
----------------------------------------
A function ``extract(values, isovalue, spacing)``:

values      NumPy array of n axes, of any real type and any memory layout; not to be written to
isovalue    a float
spacing     a tuple of n floats
answer      a pair (vertices, simplices): (V, n) numbers, ``index * spacing`` in the order of the
            array's axes, and rows of 0-based indices into them; or polygons, polylines, a soup, a
            mesh (`isograde.adapters.forms`)
orientation right-hand normals of triangles point to lower values; contours have the inside on
            their left where axis 0 points right and axis 1 up; in general, with the gradients g of
            the fields and the edges t of a simplex, det(-g_1, .., -g_m, t_1, ..) > 0

Where m > 1 fields meet it is ``extract(values, isovalues, spacing)`` with values (m, N1, .., Nn)
and a tuple of m floats, or, with 2 m + 1 parameters, ``extract(a, b, isovalue_a, isovalue_b,
spacing)`` and so on: the number of parameters without a default tells which.

Who takes the directions of the axes in space declares ``{"limits": {"directions": true}}``, and is
called with ``directions=rows`` where a field has some: a vertex is then at ``index * spacing @
rows``, and its normals point to lower values in space, also where the axes are a mirror image.

Who samples a function, and takes no samples, declares ``"given": "function"``, and is called with
one (``isograde explain function``).

Name it ``python:package.module:function`` or ``python:path/to/file.py:function``.

It may say what it is in a declaration (`isograde.declaration`): a dictionary, or a function without
parameters that returns one, found as an attribute ``declaration`` of the function, or else under
the name ``declaration`` in its module. Whoever makes anything but surfaces says so there, as
``{"limits": {"kinds": [[2, 1]]}}`` for contours; a function of 2 m + 1 > 3 parameters is taken to
be for m fields in space. To decline a field, raise `NotImplementedError`.
"""

from __future__ import annotations

import difflib
import importlib
import importlib.util
import inspect
import pickle
import pkgutil
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from numpy.typing import NDArray

from isograde.adapters.interpolants import on_samples
from isograde.adapters.protocol import declared
from isograde.adapters.registry import READY_MADE
from isograde.declaration import Declaration
from isograde.model import AdapterError, UnknownName

# A function as the worker calls it: samples, one isovalue a component, spacing.
Call = Callable[..., Any]  # of samples, isovalues and spacing, and the function where it is known

# How the name of a function that a session wrote to a file begins (`isograde.adapters.functions`).
PICKLED = "pickle:"

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


def load(spec: str) -> tuple[Call, Declaration]:
    """The function that `spec` names, and what it declares; raises `AdapterError`."""
    if spec.startswith(("python:", PICKLED)):
        function, said = _load_pickled(spec) if spec.startswith(PICKLED) else _load_python(spec)
        required = required_parameters(function)
        if isinstance(said, Mapping):
            said = _with_kinds(said, required)
        declaration = declared(said, called(spec))
        if declaration.given == "function":
            _check_given(function, declaration, spec)
            return as_called(on_samples(function), 3), declaration
        for kind in declaration.limits.kinds:
            if required not in (3, 2 * kind[1] + 1):
                raise AdapterError(f"{spec}: {_miscounted(required, kind)}")
        return as_called(function, required), declaration
    ready = READY_MADE[spec]
    try:
        for name in ready.imports:
            importlib.import_module(name)
    except (ImportError, OSError) as error:
        raise AdapterError(f"{spec}: {advice(error, ready.distribution)}") from error
    function = ready.function()
    return as_called(function, required_parameters(function)), ready.declaration()


def _check_given(function: Callable[..., Any], declaration: Declaration, spec: str) -> None:
    """Raise `AdapterError` unless the function can be called with one function."""
    if any(m != 1 for _, m in declaration.limits.kinds):
        raise AdapterError(f"{spec}: given one function, it can be for kinds (n, 1) alone")
    try:
        inspect.signature(function).bind(*[None] * 5)
    except TypeError as error:
        asked = "(function, lower, upper, spacing, isovalue)"
        raise AdapterError(f"{spec}: it is called with {asked}: {error}") from None
    except ValueError:
        return  # What is not written in Python may not say what it takes.


def required_parameters(function: Callable[..., Any]) -> int:
    """How many arguments the function is called with: three, or as many as it asks for.

    >>> required_parameters(lambda values, isovalue, spacing=None: None)
    3
    >>> required_parameters(lambda a, b, isovalue_a, isovalue_b, spacing: None)
    5
    """
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):
        return 3
    try:
        signature.bind(None, None, None)
        return 3
    except TypeError:
        positional = inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD
        return sum(
            one.kind in positional and one.default is one.empty
            for one in signature.parameters.values()
        )


def _with_kinds(said: Mapping[str, Any], required: int) -> Mapping[str, Any]:
    """What is said, with the kind that 2 m + 1 parameters tell where none is said."""
    limits = said.get("limits", {})
    if said.get("given") == "function":
        return said
    if required <= 3 or required % 2 == 0 or not isinstance(limits, Mapping) or "kinds" in limits:
        return said
    return {**said, "limits": {**limits, "kinds": [[3, required // 2]]}}


def _miscounted(required: int, kind: tuple[int, int]) -> str:
    """What a function with too few or too many parameters should have."""
    m = kind[1]
    apart = "" if m == 1 else f", or {2 * m + 1}: {m} arrays, {m} isovalues, spacing"
    return f"it asks for {required} arguments; for (n, m) = {kind} it is called with 3{apart}"


def as_called(function: Callable[..., Any], required: int) -> Call:
    """The function as the worker calls it, whichever of its signatures it has."""

    def call(
        values: NDArray[Any],
        isovalues: tuple[float, ...],
        spacing: tuple[float, ...],
        **more: Any,
    ) -> Any:
        if len(isovalues) == 1:
            return function(values, isovalues[0], spacing, **more)
        if required == 3:
            return function(values, isovalues, spacing, **more)
        return function(*values, *isovalues, spacing, **more)

    return call


def advice(error: Exception, distribution: str) -> str:
    r"""What to install, where an import of the distribution failed with `error`.

    >>> advice(ImportError("libGL.so.1: cannot open shared object file"), "vtk")
    'the system library libGL.so.1 is missing: install it (Debian, Ubuntu: apt-get install libgl1)'
    >>> advice(ModuleNotFoundError("No module named 'vtk'"), "vtk")
    'No module named \'vtk\': pip install vtk, or "isograde[libraries]"'
    """
    missing = re.match(r"(lib[\w+.-]+\.so[\d.]*): cannot open shared object", str(error))
    if not missing:
        return f'{error}: pip install {distribution}, or "isograde[libraries]"'
    library = missing[1]
    package = SYSTEM_PACKAGES.get(library[: library.index(".so") + 3])
    how = f"apt-get install {package}" if package else f"apt-file search {library} names it"
    return f"the system library {library} is missing: install it (Debian, Ubuntu: {how})"


def called(spec: str) -> str:
    """The name under which a report shows what `spec` names, free of this machine's folders.

    >>> called("pickle:/tmp/isograde-1/extract"), called("python:mine:extract")
    ('function:extract', 'python:mine:extract')
    """
    return f"function:{Path(spec).name}" if spec.startswith(PICKLED) else spec


def _load_pickled(spec: str) -> tuple[Callable[..., Any], object]:
    """The function of a session that was written to a file, and what it says of itself."""
    try:
        with Path(spec.removeprefix(PICKLED)).open("rb") as file:
            function = pickle.load(file)
        return function, _said(function, None)
    except Exception as error:
        raise AdapterError(f"{called(spec)}: {type(error).__name__}: {error}") from error


def _said(function: Callable[..., Any], module: ModuleType | None) -> object:
    """What the function, or else its module, says in a `declaration`."""
    said = getattr(function, "declaration", getattr(module, "declaration", {}))
    return said() if callable(said) else said


def _load_python(spec: str) -> tuple[Callable[..., Any], object]:
    """The function of a ``python:`` name, and what it says of itself."""
    place, _, name = spec.removeprefix("python:").rpartition(":")
    if not place or not name:
        raise UnknownName(
            f"{spec}: write python:package.module:function or python:file.py:function"
        )
    try:
        module = _module(place)
    except Exception as error:
        if _is_misspelt(error, place):
            raise UnknownName(f"{spec}: {error}; {_nearest_module(place)}") from error
        raise AdapterError(f"{spec}: importing {place}: {type(error).__name__}: {error}") from error
    function: Any = module
    for part in name.split("."):
        function = getattr(function, part, None)
    if not callable(function):
        others = [n for n in vars(module) if callable(getattr(module, n)) and n[0] != "_"]
        raise UnknownName(f"{spec}: {place} has no function {name}; {_hint(name, others)}")
    try:
        return function, _said(function, module)
    except Exception as error:
        raise AdapterError(
            f"{spec}: its declaration raised {type(error).__name__}: {error}"
        ) from error


def _is_misspelt(error: Exception, place: str) -> bool:
    """Whether an import failed because there is no module or file of this name."""
    if place.endswith(".py"):
        return isinstance(error, FileNotFoundError) and not Path(place).is_file()
    if not isinstance(error, ModuleNotFoundError) or error.name is None:
        return False
    return f"{place}.".startswith(f"{error.name}.")


def _nearest_module(place: str) -> str:
    """What may have been meant by a module or file that is not there."""
    if place.endswith(".py"):
        folder = Path(place).parent
        beside = sorted(str(path) for path in folder.glob("*.py")) if folder.is_dir() else []
        close = difflib.get_close_matches(place, beside, n=1)
        return f"did you mean {close[0]}?" if close else "is the folder right?"
    package, _, name = place.rpartition(".")
    try:
        within = importlib.import_module(package).__path__ if package else None
    except ImportError:
        return _nearest_module(package)
    known = [*sys.stdlib_module_names] if within is None else []
    beside = [one.name for one in pkgutil.iter_modules(within) if one.name not in known]
    close = difflib.get_close_matches(name, beside, n=1)
    full = f"{package}." if package else ""
    return f"did you mean {full}{close[0]}?" if close else "is it installed, or in this folder?"


def _hint(name: str, others: Sequence[str]) -> str:
    """Which of the others may have been meant, or what there is."""
    close = difflib.get_close_matches(name, others, n=1)
    return f"did you mean {close[0]}?" if close else f"it has {', '.join(others) or 'none'}"


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
