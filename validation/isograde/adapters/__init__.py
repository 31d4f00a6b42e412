"""Ways to an implementation.

``python:package.module:function``, ``python:file.py:function``
    a Python function (`isograde.adapters.loading` says how to write one)
``exec:command``
    any program, in any language (`isograde.adapters.exec`)
``dir:path``
    meshes computed elsewhere (`isograde.adapters.directory`)
``skimage:lewiner``, ``isoref:asymptotic-decider``, ..
    ready-made names (`ready_made_names`)

Every implementation runs in a process of its own with a time and a memory limit.
"""

from __future__ import annotations

import difflib

from isograde.adapters.directory import DirectoryAdapter, export
from isograde.adapters.exec import ExecAdapter
from isograde.adapters.python import PythonAdapter
from isograde.adapters.registry import READY_MADE
from isograde.model import Adapter, Kind, UnknownName

__all__ = ["export", "open_adapter", "ready_made_names"]


# The adapters to an implementation of one's own, by the word before the colon.
KINDS = ("python", "exec", "dir")


def ready_made_names(kind: Kind | None = None) -> list[str]:
    """The names of the adapters that come with the grader, whether or not their library is here.

    With a kind only those that make it.

    >>> "contourpy" in ready_made_names(Kind(3, 1)), "contourpy" in ready_made_names(Kind(2, 1))
    (False, True)
    """
    return sorted(
        name
        for name, ready in READY_MADE.items()
        if kind is None or kind in ready.declaration().limits.kinds
    )


def open_adapter(spec: str) -> Adapter:
    """The adapter that `spec` names, not yet opened.

    Raises
    ------
    UnknownName
        for a name that is unknown; the message lists what is close.

    >>> open_adapter("skimage:levine")
    Traceback (most recent call last):
    isograde.model.UnknownName: no implementation 'skimage:levine'; did you mean skimage:lewiner?
    >>> open_adapter("pyhton:mine:f")
    Traceback (most recent call last):
    isograde.model.UnknownName: no implementation 'pyhton:mine:f'; did you mean python:mine:f?
    """
    kind, _, rest = spec.partition(":")
    if spec in READY_MADE or (kind in ("python", "pickle") and rest):
        return PythonAdapter(spec)
    if kind == "exec" and rest:
        return ExecAdapter(spec)
    if kind == "dir" and rest:
        return DirectoryAdapter(spec)
    if kind == "function" and rest:
        raise UnknownName(f"{spec} was a function of a session: call isograde.grade({rest}) there")
    close = difflib.get_close_matches(kind, KINDS, n=1) if rest and kind not in KINDS else []
    close = [f"{close[0]}:{rest}"] if close else difflib.get_close_matches(spec, READY_MADE, n=1)
    hint = (
        f"did you mean {close[0]}?" if close else "`isograde list implementations` shows the names"
    )
    raise UnknownName(f"no implementation {spec!r}; {hint}")
