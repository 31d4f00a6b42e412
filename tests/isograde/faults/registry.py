"""The register of faults: each an extractor that is broken on purpose, and what must say so."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

Extract = Callable[..., Any]


@dataclass(frozen=True)
class Fault:
    """One extractor that is broken on purpose.

    name : of the fault
    extract : the function under test; made anew by `make`, so that none keeps another's state
    first : the claim that must catch it before any other
    report : where the public saw its like, or nothing
    blind : written from the README and `isograde explain` alone
    declares : what it says of itself
    says : what is wrong, in a sentence
    module : the last name of the module it stands in
    """

    name: str
    make: Callable[[], Extract]
    first: str
    report: str
    blind: bool
    says: str
    module: str
    declares: Mapping[str, Any] = field(default_factory=dict)


FAULTS: dict[str, Fault] = {}

#: Those that no case of the default plan was seen to catch, and what would.
SURVIVORS: dict[str, str] = {}


def kebab(name: str) -> str:
    """The name of a class or function with hyphens.

    >>> kebab("LastLayer"), kebab("last_layer")
    ('last-layer', 'last-layer')
    """
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "-", name).replace("_", "-").lower()


def fault(
    first: str, report: str = "", *, blind: bool = False, **declares: Any
) -> Callable[[Any], Any]:
    """A decorator that registers a class of extractors, or a function, as a fault."""

    def register(broken: Any) -> Any:
        name = kebab(broken.__name__)
        module = broken.__module__.rpartition(".")[2]
        # pytest executes a module twice where it looks for doctests.
        known = FAULTS.get(name)
        assert known is None or known.module == module, f"two faults are named {name}"
        assert broken.__doc__, f"{name} says nothing of what is wrong"
        make = broken if isinstance(broken, type) else lambda: broken
        FAULTS[name] = Fault(
            name, make, first, report, blind, broken.__doc__.split("\n")[0], module, declares
        )
        return broken

    return register
