"""Which oracles a claim's judge asks, read off its code: the modules of `isograde.oracles` it uses.

A page says it of every claim, so it is found and not written down: the names in the judge's code,
and in the code of whatever functions of the claims it calls, are followed to where they come from.
"""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from functools import cache
from types import CodeType, FunctionType, ModuleType
from typing import Any

from isograde.claims import CLAIMS
from isograde.report.record import first_line

ORACLES, OURS = "isograde.oracles.", "isograde.claims."


@cache
def oracles_of(claim: str) -> tuple[str, ...]:
    """The names of the oracles that this claim's judge asks; none for a claim that is not known.

    >>> oracles_of("structure.answers"), "complexes" in oracles_of("topology.closed")
    ((), True)
    """
    known = CLAIMS.get(claim)
    if known is None:
        return ()
    found: set[str] = set()
    seen: set[Any] = set()
    _follow(known.judge, found, seen)
    return tuple(sorted(found))


def judge_of(claim: str, told: str) -> str:
    """What a report says of a claim's judge, or for want of a sentence what is said of it now.

    >>> judge_of("a", "Pass when it is so"), judge_of("bodies.pieces", "of_trial")[:9]
    ('Pass when it is so', 'Pass when')
    """
    known = CLAIMS.get(claim)
    return told if known is None or " " in told else first_line(known.judge)


def _follow(thing: Any, found: set[str], seen: set[Any]) -> None:
    """`found` knows the oracles that this function or value leads to."""
    function = inspect.unwrap(thing) if callable(thing) else thing
    home = getattr(function, "__module__", "") or ""
    if isinstance(function, ModuleType):
        home = f"{function.__name__}."
    if home.startswith(ORACLES):
        found.add(home.removeprefix(ORACLES).split(".")[0])
    elif isinstance(function, FunctionType) and home.startswith(OURS) and function not in seen:
        seen.add(function)
        for value in _named(function):
            _follow(value, found, seen)


def _named(function: FunctionType) -> Iterator[Any]:
    """What the names in a function's code stand for: globals, and what it closes over."""
    for name in _names(function.__code__):
        if name in function.__globals__:
            yield function.__globals__[name]
    for cell in function.__closure__ or ():
        if callable(cell.cell_contents):
            yield cell.cell_contents


def _names(code: CodeType) -> Iterator[str]:
    """The names in a function's code and in the functions inside it."""
    yield from code.co_names
    for part in code.co_consts:
        if isinstance(part, CodeType):
            yield from _names(part)
