"""A rule by its name: one of isoref's, or anybody's as ``python:module:RULE``.

`module` is a module that can be imported, or a file that ends in ``.py``; `RULE` is an
`isoref.rule.Rule`, or any object with the same attributes: `tile`, `decisions`, `asks`, `bits` and
`name`.
"""

from __future__ import annotations

import difflib
import importlib
import sys
from pathlib import Path
from typing import Any

from isoref.methods import RULES
from isoref.rule import Rule

PREFIX = "python:"


class RuleError(Exception):
    """There is no such rule; says what there is."""


def load_rule(spec: str) -> Rule:
    """The rule that `spec` names; raises `RuleError`.

    >>> load_rule("asymptotic-decider").bits
    6
    """
    if spec in RULES:
        return RULES[spec]
    if not spec.startswith(PREFIX):
        close = difflib.get_close_matches(spec, RULES, n=1)
        advice = f"did you mean {close[0]}?" if close else f"there are {', '.join(RULES)}"
        raise RuleError(f"no rule {spec!r}; {advice}; for your own: python:module:RULE")
    place, _, name = spec.removeprefix(PREFIX).rpartition(":")
    if not place or not name:
        raise RuleError(f"{spec!r} is not of the form python:module:RULE")
    module = _module(spec, place)
    if not hasattr(module, name):
        rules = [one for one, it in vars(module).items() if isinstance(it, Rule)]
        there = f"rules there: {', '.join(rules)}" if rules else "it has no rule"
        raise RuleError(f"{spec}: {place} has no {name}; {there}")
    rule: Rule = getattr(module, name)
    return rule


def _module(spec: str, place: str) -> Any:
    """The module of this name or file, also where it stands in the working directory."""
    path = Path(place)
    folder = path.resolve().parent if path.suffix == ".py" else Path.cwd()
    if path.suffix == ".py" and not path.is_file():
        raise RuleError(f"{spec}: no such file: {path}")
    sys.path.insert(0, str(folder))
    try:
        return importlib.import_module(path.stem if path.suffix == ".py" else place)
    except Exception as error:
        words = f"importing {place}: {type(error).__name__}: {error}"
        raise RuleError(f"{spec}: {words}") from error
    finally:
        sys.path.remove(str(folder))
