"""The catalogue that `isograde list` shows, made from the registries.

``python -m isograde.cataloguing`` (``make catalogue``) writes it after a change of claims, cases,
implementations or levels; `isograde.catalogue` reads it.
"""

from __future__ import annotations

import ast
import inspect
import json
from collections import Counter
from collections.abc import Collection, Sequence
from functools import cache, partial
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from types import CodeType
from typing import Any

from isograde import oracles as package
from isograde.adapters.registry import READY_MADE, ReadyMade
from isograde.cases import all_cases, volumes
from isograde.catalogue import FILE, Catalogue
from isograde.claims import CLAIMS
from isograde.model import LEVELS, Case, Claim, Kind
from isograde.report.words import kinds as kind_words

# Where the tests and the kept reports stand in a checkout; the catalogue is made there only.
ROOT = Path(__file__).parents[2]
# List so many kinds that have no word of their own.
LISTED = 3
# Show so many cases of one name, but for its end, under one pattern.
MANY = 40


def build() -> Catalogue:
    """The catalogue of the registries."""
    every = [case for case in all_cases(0).values() if not case.id.startswith("real/")]
    return {
        "levels": [[level, *words] for level, words in LEVELS.items()],
        "claims": [
            [one.id, one.level, kinds_of(one), one.rule, _source(one)] for one in CLAIMS.values()
        ],
        "cases": _case_rows(every),
        "volumes": [
            [
                one.name,
                one.file,
                one.package,
                one.samples,
                one.url or one.source,
                _case_rows(volumes.cases_of(one)),
            ]
            for one in volumes.REGISTRY.values()
        ],
        "oracles": [[name, *said] for name, said in oracles().items()],
        "judged_by": [[name, sorted(asked_by(one))] for name, one in CLAIMS.items()],
        **_kept(),
        "implementations": [_implementation_row(*item) for item in READY_MADE.items()],
    }


def asked_by(claim: Claim) -> set[str]:
    """The oracles that the judge of a claim asks, itself or through the functions it calls."""
    found, seen = set[str](), set[Any]()
    waiting: list[Any] = [claim.judge]
    while waiting:
        function = waiting.pop()
        if isinstance(function, partial):
            # What is bound to a function may be the function that asks.
            waiting += [function.func, *function.args, *function.keywords.values()]
            continue
        code = getattr(function, "__code__", None)
        if code is None or function in seen:
            continue
        seen.add(function)
        inner = [one.cell_contents for one in function.__closure__ or () if one.cell_contents]
        named = [function.__globals__.get(name) for name in _names(code)]
        for one in [*inner, *named]:
            home = getattr(one, "__module__", None) or getattr(one, "__name__", "")
            if str(home).startswith("isograde.oracles."):
                found.add(str(home))
            elif str(home).startswith("isograde.claims.") or isinstance(one, partial):
                waiting.append(one)
    return found


def _names(code: CodeType) -> set[str]:
    """The names that a function, or one inside it, takes from its module."""
    inner = [one for one in code.co_consts if isinstance(one, CodeType)]
    return {*code.co_names, *(name for one in inner for name in _names(one))}


def oracles() -> dict[str, list[Any]]:
    """What each oracle says of itself, and the tests that check it: those that import it."""
    found = {}
    for module in iter_modules(package.__path__):
        name = f"{package.__name__}.{module.name}"
        tests = [
            [path.name, first_line_of(text)]
            for path, text in _tests()
            if f"oracles.{module.name} " in text or f"oracles import {module.name}" in text
        ]
        found[name] = [first_line_of(inspect.getsource(import_module(name))), tests]
    return found


@cache
def _tests() -> list[tuple[Path, str]]:
    """The tests of a checkout, with their text."""
    folder = ROOT / "tests" / "isograde"
    return [(path, path.read_text(encoding="utf-8")) for path in sorted(folder.glob("test_*.py"))]


def first_line_of(source: str) -> str:
    """The first sentence of a module's docstring; nothing where it has none."""
    said = ast.get_docstring(ast.parse(source)) or ""
    return " ".join(said.split("\n\n")[0].split())


def _kept() -> Catalogue:
    """Of the reports that are kept: tiles of rules that the plan covers, and mutants killed."""
    coverage = json.loads((ROOT / "reports" / "coverage.json").read_text(encoding="utf-8"))
    tiles = [[rule, count] for rule, count in coverage["Tiles of the cube rules"].items()]
    mutation = ROOT / "reports" / "mutation" / "README.md"
    lines = mutation.read_text(encoding="utf-8").splitlines() if mutation.exists() else []
    plain = [line.replace("**", "") for line in lines]
    said = [line for line in plain if "killed" in line and not line.startswith(("#", "|"))]
    return {"tiles": tiles, "mutation": [[line] for line in said[:1]]}


def write() -> None:
    """The file holds the catalogue of the registries, a row a line."""
    parts = [
        f'"{name}": [\n' + ",\n".join(json.dumps(row, ensure_ascii=False) for row in rows) + "\n]"
        for name, rows in build().items()
    ]
    FILE.write_text("{\n" + ",\n".join(parts) + "\n}\n", encoding="utf-8")


def _source(claim: Claim) -> str:
    """Where a claim comes from."""
    return " ".join(claim.source.split())


def kinds_of(claim: Claim) -> str:
    """The kinds of which a claim can be said, in words."""
    asked = [Kind(n, m) for n in range(1, 6) for m in range(1, n + 1)]
    told = [kind for kind in asked if claim.kinds(kind)]
    if len(told) == len(asked):
        return "every kind"
    named = [kind for kind in told if not str(kind).startswith("(")]
    others = [kind for kind in told if kind not in named]
    shown = kind_words([*named, *others[:LISTED]])
    return f"{shown} and others" if len(others) > LISTED else shown


def _case_rows(cases: Sequence[Case]) -> list[list[Any]]:
    """A row a case, or a row for many that differ in a number only."""
    every = {case.id: case for case in cases}
    return [_case_row(group, [every[n] for n in names]) for group, names in _grouped(every).items()]


def _case_row(group: str, members: Sequence[Case]) -> list[Any]:
    """The name, kind, size, isovalues and occasion of a group of cases."""
    rare = sum("full" in case.tags for case in members)
    runs = {0: "always", len(members): "with --full"}.get(
        rare, f"{len(members) - rare} always, {rare} with --full"
    )
    name = group if len(members) == 1 else f"{group} ({len(members)} cases)"
    first = members[0]
    levels = ", ".join(f"{level:g}" for level in first.isovalues)
    return [name, str(first.kind), max(case.samples for case in members), levels, runs]


def _grouped(names: Collection[str]) -> dict[str, list[str]]:
    """Ids that differ in their end only, a number or one of many, under one pattern."""
    heads = Counter(name.rpartition("/")[0] for name in names)
    groups: dict[str, list[str]] = {}
    for name in names:
        head, _, tail = name.rpartition("/")
        alike = tail.isdigit() or heads[head] > MANY
        groups.setdefault(f"{head}/*" if alike else name, []).append(name)
    return groups


def _implementation_row(name: str, made: ReadyMade) -> list[Any]:
    """The name, package, modules, kinds, promise and notes of a ready-made implementation."""
    declared = made.declaration()
    kinds = [Kind(*kind) for kind in declared.limits.kinds]
    shown = kind_words(kinds) if len(kinds) <= LISTED else f"{len(kinds)} kinds"
    level = f"{declared.level} {LEVELS[declared.level][0]}"
    return [name, made.distribution, list(made.imports), shown, level, declared.notes]


if __name__ == "__main__":
    write()
