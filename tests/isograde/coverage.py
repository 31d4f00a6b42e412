"""What the default plan covers, counted from its cases: ``make coverage``.

Writes `reports/coverage.md` and `reports/coverage.json`; a test counts again, and fails where a
number has shrunk. Nothing is typed in: tiles are looked up by the rules of the reference, types,
shapes and positions are read off the fields.

Glossary
--------
tile        signs of a cell's corners and the decisions of a rule: what the rule looks up
reachable   tiles of the 766 topologies that the surface can have in a cell, and of chance's cells
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path

import numpy as np
from isograde import variants
from isograde.cases import all_cases, mosaics
from isograde.cases.frozen import STEP, integers
from isograde.cases.trilinear_cells import TUNNELS, cell_of
from isograde.claims import CLAIMS
from isograde.model import SURFACES, Case
from isograde.oracles.trilinear import BODY, CORNER, FACE, cells
from isograde.oracles.trilinear_cases import every_topology
from isoref.cube import CORNER_OFFSETS
from isoref.field import Field, Floats
from isoref.methods import RULES
from isoref.rule import Rule

ROOT = Path(__file__).parents[2] / "reports"
# Cells of chance, half of them checkered, beside one of each topology: rules that decide by other
# numbers than the interpolant's reach tiles that no topology names.
CHANCE = 400_000
LARGEST = 20_000


def default_surfaces() -> list[Case]:
    """The cases for surfaces in space that every grade has, in plain."""
    return [
        case
        for case in all_cases(0).values()
        if case.kind == SURFACES and not {"full", "real"} & case.tags
    ]


def corners_of(field: Field, isovalue: float) -> Floats:
    """(8, n) the corners of the cells that the surface meets, less the isovalue."""
    values = field.values.reshape(field.shape).astype(np.float64) - isovalue
    size = [n - 1 for n in values.shape]
    corners = np.stack(
        [
            values[tuple(slice(a, a + n) for a, n in zip(offset, size, strict=True))].ravel()
            for offset in CORNER_OFFSETS
        ]
    )
    inside = (corners >= 0).sum(axis=0)
    return np.asarray(corners[:, (inside > 0) & (inside < 8)])


def tiles(rule: Rule, corners: Floats) -> set[int]:
    """The tiles that the rule looks up for these cells, each as one number."""
    signs = ((corners >= 0) * (1 << np.arange(8))[:, None]).sum(axis=0)
    asked = np.array([rule.asks(one) for one in range(256)])[signs]
    decisions = np.zeros(len(signs), np.int64)
    if asked.any():
        decisions[asked] = rule.decisions(corners[:, asked])
    return set(np.unique(signs + 256 * decisions).tolist())


@cache
def topologies() -> Floats:
    """(8, 766) a cell of each topology that the surface meets."""
    parts = [cell_of(one, 0) for one in sorted(every_topology()) if len(set(one.signs)) > 1]
    return np.stack([[part[tuple(o)] for part in parts] for o in CORNER_OFFSETS])


def chance() -> Floats:
    """(8, n) cells of chance, half of them checkered."""
    shape = (8, CHANCE)
    size = integers("coverage/size", 0, shape, 64, 1024) * STEP
    sign = 2 * integers("coverage/sign", 0, shape, 0, 2) - 1
    checkers = np.where(CORNER_OFFSETS.sum(axis=1) % 2, 1, -1)
    sign[:, : CHANCE // 2] = checkers[:, None]
    return np.asarray(size * sign, np.float64)


def reachable(rule: Rule) -> int:
    """How many tiles are known to be reached."""
    return len(tiles(rule, topologies()) | _met(rule, chance()))


def _met(rule: Rule, corners: Floats) -> set[int]:
    """The tiles of the cells that the surface meets."""
    inside = (corners >= 0).sum(axis=0)
    return tiles(rule, corners[:, (inside > 0) & (inside < 8)])


@cache
def built() -> tuple[tuple[Case, Field], ...]:
    """The default cases for surfaces, with their fields."""
    return tuple((case, case.build()) for case in default_surfaces())


@cache
def met() -> tuple[Floats, ...]:
    """The corners of every cell that a surface of the plan meets, case by case."""
    return tuple(
        corners_of(field, case.isovalues[0])
        for case, field in built()
        if min(field.shape) > 1 and field.values.size <= LARGEST
    )


def tiles_covered(rule: Rule) -> int:
    """How many tiles of the rule the default plan reaches in plain cases."""
    return len(tiles(rule, np.concatenate(met(), axis=1)))


def near_tunnels() -> dict[str, int]:
    """What the mosaics near tunnels hold: cases from both sides, bases, positions, cells."""
    pairs = {(name, base) for name in TUNNELS for base in mosaics.bases(name, 0)}
    steps = [bits for bits in mosaics.STEPS.values() if bits <= 12]
    return {
        "cases with a tunnel": len({name for name, _ in pairs}),
        "independent bases of each": min(sum(name == one for one, _ in pairs) for name in TUNNELS),
        "positions of each, from both sides": len(mosaics.POSITIONS),
        "cells near a tunnel": sum(mosaics.tunnels(bits, 0).values.size // 8 for bits in steps),
    }


def ties() -> dict[str, int]:
    """Samples, face saddles and body saddles on the isovalue, in cells."""
    found = np.zeros(4, np.int64)
    for case, field in built():
        if "ties" in case.tags and min(field.shape) > 1:
            corners = corners_of(field, case.isovalues[0])
            ordered = np.empty((corners.shape[1], 2, 2, 2))
            for number, (i, j, k) in enumerate(CORNER_OFFSETS):
                ordered[:, i, j, k] = corners[number]
            found += np.bincount(cells(ordered).ties, minlength=4)
    return {
        "cells with a sample on the isovalue": int(found[CORNER]),
        "cells with a face saddle on it": int(found[FACE]),
        "cells with a body saddle on it": int(found[BODY]),
    }


def fields() -> dict[str, int]:
    """Types, shapes, sizes and layouts of the fields, plain and posed."""
    shapes = {field.shape for _, field in built()}
    plain = {field.values.dtype.name for _, field in built()}
    asked = _asked()
    return {
        "number types in plain cases": len(plain),
        "number types as variants": len(asked & set(variants.TYPES)),
        "layouts in memory": len(asked & set(_layouts())),
        "number types, each in each layout": _types_in_layouts(),
        "shapes": len(shapes),
        "axes with an extent of 1": len({a for s in shapes for a in range(3) if s[a] == 1}),
        "axes with an extent of 2": len({a for s in shapes for a in range(3) if s[a] == 2}),
        "axes with an extent of 3": len({a for s in shapes for a in range(3) if s[a] == 3}),
        "axes longer than 65,536": len({a for s in shapes for a in range(3) if s[a] > 1 << 16}),
        "magnitudes": len(asked & {f"magnitude/{word}" for word in variants.MAGNITUDES}),
        "offsets": len(asked & {f"offset/{word}" for word in variants.OFFSETS}),
        "symmetries": sum(name.startswith("symmetry/") for name in asked),
        "most vertices of a surface": max(map(vertices, built())),
        "most pieces that are known": max(case.facts.get("components", 0) for case, _ in built()),
    }


def _layouts() -> tuple[str, ...]:
    """The variants of memory."""
    return CLAIMS["symmetry.layout"].variants


def _types_in_layouts() -> int:
    """Pairs of the number type and the layout with which some field is posed."""
    names = _layouts()
    return len(
        {
            (field.values.dtype.name, name)
            for case, field in built()
            if "posed" in case.tags
            for name in names
            if variants.pose(name, case, field) is not None
        }
    )


def _asked() -> set[str]:
    """The variants of surfaces that are posed by default and that some case's values allow."""
    found: set[str] = set()
    for case, field in built():
        if "posed" not in case.tags:
            continue
        claims = [claim for claim in CLAIMS.values() if claim.applies_to(case)]
        wanted = {name for claim in claims for name in claim.variants}
        for name in variants.named(sorted(wanted), SURFACES):
            if name not in found and variants.pose(name, case, field) is not None:
                found.add(name)
    return found


def vertices(one: tuple[Case, Field]) -> int:
    """How many lattice edges the surface of a case crosses."""
    case, field = one
    inside = field.values >= case.isovalues[0]
    return sum(int((np.diff(inside.astype(np.int8), axis=axis) != 0).sum()) for axis in range(3))


def counted() -> dict[str, dict[str, int]]:
    """Every number that must not shrink, by table and row."""
    return {
        "Tiles of the cube rules": {name: tiles_covered(rule) for name, rule in RULES.items()},
        "Near tunnels": near_tunnels(),
        "Ties": ties(),
        "Fields": fields(),
        "Cases": {
            "by default, of surfaces": len(default_surfaces()),
            "claims": len(CLAIMS),
        },
    }


def lines(numbers: Mapping[str, Mapping[str, int]], wanted: Mapping[str, int]) -> Iterator[str]:
    """The report in Markdown."""
    yield "# What the default plan covers\n"
    yield "Counted by `make coverage` from the cases that every grade has: surfaces in space, plain"
    yield "unless it says variants; scans are left out, since not everybody has them. A test counts"
    yield "again and fails where a number is smaller.\n"
    for table, rows in numbers.items():
        yield f"## {table}\n"
        known = table.startswith("Tiles")
        yield "| rule | tiles covered | known to be reachable |" if known else "| what | how many |"
        yield "| --- | ---: | ---: |" if known else "| --- | ---: |"
        for name, number in rows.items():
            yield f"| {name} | {number:,} |" + (f" {wanted[name]:,} |" if known else "")
        yield ""
    yield "Reachable is what one cell of each of the 766 topologies, and"
    yield f"{CHANCE:,} cells of chance, look up.\n"


def written(text: Iterable[str], path: Path) -> None:
    """The lines, in this file."""
    path.write_text("\n".join(text).rstrip() + "\n", encoding="utf-8")


def main() -> None:
    """The report, in both forms."""
    numbers = counted()
    wanted = {name: reachable(rule) for name, rule in RULES.items()}
    written(lines(numbers, wanted), ROOT / "coverage.md")
    written([json.dumps(numbers, indent=1)], ROOT / "coverage.json")


if __name__ == "__main__":
    main()
