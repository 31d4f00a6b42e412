"""The name of a function that somebody holds in a Python session.

An implementation runs in a process of its own, which finds a function by name where it can import
it, as ``python:package.module:function``. What it cannot (a function of a notebook, of a script, of
a test file that is not on the path; a lambda, a closure, a `functools.partial`) is written to a
file with cloudpickle, code and all, as ``pickle:folder/name``. The file goes when the session does.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import ModuleType
from typing import Any

import cloudpickle

from isograde.adapters.child import MARK
from isograde.adapters.loading import PICKLED
from isograde.model import AdapterError

Implementation = str | Callable[..., Any]


@contextmanager
def named(implementation: Implementation) -> Iterator[str]:
    """A name that any process can open while the context lasts. Raises `AdapterError`.

    >>> from isoref.methods import extract
    >>> with named(extract) as spec:
    ...     print(spec)
    python:isoref.methods:extract
    """
    if MARK in os.environ:
        raise AdapterError(
            "a module that grades while it is imported cannot be graded itself: put its calls of "
            'isograde under `if __name__ == "__main__":`'
        )
    if isinstance(implementation, str):
        yield implementation
        return
    if not callable(implementation):
        kind = type(implementation).__name__
        raise TypeError(f"an implementation is a function or a name, not {kind}")
    importable = _importable(implementation)
    if importable is not None:
        yield importable
        return
    with tempfile.TemporaryDirectory(prefix="isograde-") as folder:
        path = Path(folder) / name_of(implementation)
        path.write_bytes(_pickled(implementation))
        yield f"{PICKLED}{path}"


def name_of(function: Callable[..., Any]) -> str:
    """The name a function goes by, fit for a file.

    >>> from functools import partial
    >>> name_of(print), name_of(lambda: 0), name_of(partial(print, end=""))
    ('print', 'lambda', 'print')
    """
    inner = getattr(function, "func", function)
    name = str(getattr(inner, "__name__", type(inner).__name__))
    return "".join(c for c in name if c.isalnum() or c in "._-") or "function"


def _importable(function: Callable[..., Any]) -> str | None:
    """The ``python:`` name under which another process finds this very function, or None."""
    module, name = getattr(function, "__module__", None), getattr(function, "__qualname__", "")
    if module in (None, "__main__") or not name or "<" in name:
        return None
    found: Any = sys.modules.get(module)
    if found is None or _half_imported(found) or not _stands_on_the_path(module):
        return None
    for part in name.split("."):
        found = getattr(found, part, None)
    return f"python:{module}:{name}" if found is function else None


def _half_imported(module: ModuleType) -> bool:
    """Whether the module's own lines are still running, and may be what asks for its function."""
    return bool(getattr(getattr(module, "__spec__", None), "_initializing", False))


def _stands_on_the_path(module: str) -> bool:
    """Whether an import in a new process leads to the file from which the module came."""
    here = getattr(sys.modules[module], "__file__", None)
    path, spec = None, None
    parts = module.split(".")
    for count in range(1, len(parts) + 1):
        spec = _found(".".join(parts[:count]), path)
        if spec is None:
            return False
        path = spec.submodule_search_locations
    return here is not None and spec is not None and spec.origin == here


def _found(name: str, path: Sequence[str] | None) -> ModuleSpec | None:
    """Where an import would look, whatever is loaded already."""
    finders = (getattr(finder, "find_spec", None) for finder in sys.meta_path)
    found = (find(name, path) for find in finders if find is not None)
    return next((spec for spec in found if spec is not None), None)


def _pickled(function: Callable[..., Any]) -> bytes:
    """The function as bytes, with the code of its module where that cannot be imported."""
    name = getattr(getattr(function, "func", function), "__module__", None)
    module = sys.modules.get(name or "")
    apart = (
        module is not None
        and name != "__main__"
        and (_half_imported(module) or not _stands_on_the_path(str(name)))
    )
    if apart:
        cloudpickle.register_pickle_by_value(module)
    try:
        written: bytes = cloudpickle.dumps(function)
    except Exception as error:
        raise AdapterError(
            f"{name_of(function)} cannot be sent to a process of its own "
            f"({type(error).__name__}: {error}); put it in a module, and name it python:module:name"
        ) from error
    finally:
        if apart:
            cloudpickle.unregister_pickle_by_value(module)
    return written
