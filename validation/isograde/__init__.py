"""A grader for isosurface extractors: cases, adapters, oracles, claims and reports.

`grade(extract)` says what is true of a function, `check(extract)` what is wrong with the call,
`compare(..)` lays several side by side, `extract(volume, isovalue)` is the reference's surface, and
`@parametrize_with_claims([extract])` makes one test of pytest for each claim. They, and NumPy with
them, are imported when they are first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from isograde.calls import check, compare, extract, grade
    from isograde.checking import Checked
    from isograde.claim_tests import parametrize_with_claims
    from isograde.results import Comparison, Grade

__all__ = [
    "Checked",
    "Comparison",
    "Grade",
    "__version__",
    "check",
    "compare",
    "extract",
    "grade",
    "parametrize_with_claims",
]

_HOMES = {
    **dict.fromkeys(("check", "compare", "extract", "grade"), "isograde.calls"),
    **dict.fromkeys(("Comparison", "Grade"), "isograde.results"),
    "Checked": "isograde.checking",
    "parametrize_with_claims": "isograde.claim_tests",
}


def __getattr__(name: str) -> Any:
    """What is public, imported when it is asked for."""
    if name == "__version__":
        return _version()
    if name not in _HOMES:
        raise AttributeError(f"module 'isograde' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    """What is public, and the modules that were imported."""
    return sorted({*__all__, *globals()})


def _version() -> str:
    """The installed version, or "source" where the code is used without being installed."""
    from isograde.installed import version_of

    return version_of("isograde") or "source"
