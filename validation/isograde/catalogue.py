"""What `isograde list` shows, read from a file: to build it takes ten times as long as NumPy.

`catalogue.json` beside this module is made from the registries of claims, cases, implementations
and levels by ``python -m isograde.catalogue`` (``make catalogue``), and a test holds it to them.
What depends on the machine, whether a volume is here and a package installed, is looked up when it
is shown.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Collection, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from isograde.model import Case, Claim, Kind

FILE = Path(__file__).with_name("catalogue.json")
# List so many kinds that have no word of their own.
LISTED = 3
# Show so many cases of one name, but for its end, under one pattern.
MANY = 40

Catalogue = dict[str, list[Any]]


@cache
def read() -> Catalogue:
    """The catalogue as it stands in the file."""
    found: Catalogue = json.loads(FILE.read_text(encoding="utf-8"))
    return found


def build() -> Catalogue:
    """The catalogue of the registries."""
    from isograde.adapters.registry import READY_MADE
    from isograde.cases import all_cases, volumes
    from isograde.claims import CLAIMS
    from isograde.model import LEVELS

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
        "implementations": [_implementation_row(*item) for item in READY_MADE.items()],
    }


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
    from isograde.model import Kind
    from isograde.report.words import kinds as kind_words

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


def _implementation_row(name: str, made: Any) -> list[Any]:
    """The name, package, modules, kinds, promise and notes of a ready-made implementation."""
    from isograde.model import LEVELS
    from isograde.report.words import kinds as kind_words

    declared = made.declaration()
    kinds = [_kind(kind) for kind in declared.limits.kinds]
    shown = kind_words(kinds) if len(kinds) <= LISTED else f"{len(kinds)} kinds"
    level = f"{declared.level} {LEVELS[declared.level][0]}"
    return [name, made.distribution, list(made.imports), shown, level, declared.notes]


def _kind(kind: Sequence[int]) -> Kind:
    """(n, m) as a kind."""
    from isograde.model import Kind

    return Kind(*kind)


if __name__ == "__main__":
    write()
