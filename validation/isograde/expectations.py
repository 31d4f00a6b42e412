"""Failures that are known: which cases of which claim may fail, and why.

A file of them is TOML, a table a claim, written by ``--write-expect`` and read by ``--expect``::

    ["topology.manifold"]
    reason = "edges of four triangles at corners where two sheets touch"
    cases = ["pairs/10.1.2", "noise/white-5x6x7"]

``cases = ["*"]`` stands for every case. Ids of claims and cases are stable. A listed case that
passes is told, so that the list stays as short as the truth, and fails under ``--strict``; a case
that fails and is not listed fails. Known bodies cannot be expected to fail: who draws no ball
right has nothing else worth expecting.
"""

from __future__ import annotations

import difflib
import json
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from isograde import catalogue

EVERY = "*"
FIRM = "bodies."


class ExpectationError(ValueError):
    """A list of expected failures cannot be taken; the message says which entry and why."""


@dataclass(frozen=True)
class Expected:
    """Why a claim may fail, and on which cases; `EVERY` alone for all."""

    reason: str
    cases: tuple[str, ...] = (EVERY,)

    def covers(self, case: str) -> bool:
        """A failure on this case is expected."""
        return self.cases == (EVERY,) or case in self.cases


Expectations = Mapping[str, Expected]


def is_expected(known: Expectations, claim: str, case: str) -> bool:
    """Whether a failure of this claim on this case is on the list."""
    return claim in known and known[claim].covers(case)


Given = Mapping[str, str] | str | PathLike[str] | None


def expectations(given: Given) -> dict[str, Expected]:
    """What is expected, by claim: of a file, or of reasons by claim. Raises `ExpectationError`.

    >>> expectations({"topology.manifold": "touching sheets"})
    {'topology.manifold': Expected(reason='touching sheets', cases=('*',))}
    >>> expectations({"topology.manifld": "touching sheets"})
    Traceback (most recent call last):
    isograde.expectations.ExpectationError: no claim 'topology.manifld'; did you mean \
topology.manifold?
    """
    if given is None:
        return {}
    if isinstance(given, Mapping):
        said = {name: {"reason": why, "cases": [EVERY]} for name, why in given.items()}
    elif isinstance(given, str | PathLike):
        said = dict(_loaded(Path(given)))
    else:
        kind = type(given).__name__
        raise ExpectationError(f"give {{claim: reason}}, or a file of expectations, not a {kind}")
    return {name: _entry(name, one) for name, one in said.items()}


def _loaded(path: Path) -> Mapping[str, Any]:
    """The tables of a file."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ExpectationError(f"{path} cannot be read: {error.strerror}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ExpectationError(f"{path} is not TOML: {error}") from error


def _entry(name: str, said: Any) -> Expected:
    """The entry of one claim, checked."""
    known = [row[0] for row in catalogue.read()["claims"]]
    if name not in known:
        close = difflib.get_close_matches(name, known, n=1)
        hint = f"did you mean {close[0]}?" if close else "see `isograde list claims`"
        raise ExpectationError(f"no claim {name!r:.200}; {hint}")
    if name.startswith(FIRM):
        raise ExpectationError(f"{name}: known bodies cannot be expected to fail")
    reason, cases = _parts(name, said)
    if not reason.strip():
        raise ExpectationError(f"{name}: say why it is expected to fail, as its reason")
    if not cases or (EVERY in cases and len(cases) > 1):
        raise ExpectationError(f'{name}: name its cases, or ["{EVERY}"] alone for all')
    return Expected(reason, tuple(cases))


def _parts(name: str, said: Any) -> tuple[str, list[str]]:
    """The reason and the cases of an entry."""
    allowed = {"reason", "cases"}
    if not isinstance(said, Mapping) or said.keys() - allowed or allowed - said.keys():
        shape = f'["{name}"] with reason = ".." and cases = [".."]'
        raise ExpectationError(f"{name}: write a table {shape}, and nothing else")
    reason, cases = said["reason"], said["cases"]
    strings = isinstance(cases, list) and all(isinstance(case, str) for case in cases)
    if not isinstance(reason, str) or not strings:
        raise ExpectationError(f"{name}: reason is a text, and cases a list of ids")
    return reason, cases


def toml(found: Expectations, title: str) -> str:
    """The file that lists them."""
    lines = [f"# {line}" for line in title.splitlines()]
    for name, one in sorted(found.items()):
        lines += ["", f"[{json.dumps(name)}]", f"reason = {json.dumps(one.reason)}", "cases = ["]
        lines += [f"    {json.dumps(case)}," for case in one.cases]
        lines += ["]"]
    return "\n".join(lines) + "\n"
