"""The triangulations printed in section 3, each held against the boundary polygon it must fill.

A list fills the polygons of its variant when each side of a polygon lies in one triangle, every
other edge in two, and no inner edge lies on a face of the cell. The polygons are derived from the
signs of the drawing and the separated faces (`isoref.cycles`), never from the list.

The scan reads "e1" as "e11" or "e10", where the next letter is an e, and "e0" as "e9". A list that
does not fit is read again with as few such slips undone as make it fit.

Glossary
--------
triangle    three of the paper's edge numbers 1 .. 12, or 0 for the vertex e0
slip        a printed number and what it may stand for
"""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, product
from pathlib import Path

from isoref.asymptotic_decider import PAPER_EDGES, VARIANTS, bits_of, drawing
from isoref.cycles import cycles, share_face

HERE = Path(__file__).parent
SLIPS = {10: (1,), 11: (1,), 9: (0,)}
PRINTED = json.loads((HERE / "printed.json").read_text(encoding="utf-8"))
# What section 3 replaces for the other diagonal of 3B, and by what.
OTHER_DIAGONAL: tuple[str, str] = (
    PRINTED["other diagonal of 3B"]["replace"],
    PRINTED["other diagonal of 3B"]["by"],
)
MOST_SLIPS = 5

Numbers = tuple[int, ...]
Pair = frozenset[int]


def read_list(text: str) -> list[Numbers]:
    """The triangles of a printed list.

    >>> read_list("e2e3e12, e11e4e9; e1e2e0")
    [(2, 3, 12), (11, 4, 9), (1, 2, 0)]
    """
    return [tuple(int(n) for n in re.findall(r"e(\d+)", part)) for part in re.split("[,;]", text)]


def polygons_of(name: str) -> list[Numbers]:
    """The boundary polygons of a variant in its drawing, in the paper's edge numbers."""
    number = {e: n for n, e in PAPER_EDGES.items()}
    signs = drawing(int(name[:-1]))
    found = cycles(signs, bits_of(VARIANTS[name]))
    return [tuple(number[e] for e in polygon) for polygon in found]


def pairs(corners: Numbers) -> list[Pair]:
    """The sides of a triangle."""
    return [frozenset(pair) for pair in combinations(corners, 2)]


def sides_of(polygons: list[Numbers]) -> set[Pair]:
    """The sides of all polygons."""
    return {
        frozenset(side)
        for polygon in polygons
        for side in zip(polygon, polygon[1:] + polygon[:1], strict=True)
    }


def faults(triangles: list[Numbers], polygons: list[Numbers]) -> list[str]:
    """What is wrong with these triangles as a filling of these polygons; nothing where they fit."""
    sides, found = sides_of(polygons), []
    used = Counter(pair for t in triangles for pair in pairs(t))
    for t in triangles:
        if len(set(t)) < 3:
            found.append(f"{shown(t)} has a corner twice")
    found += [f"side {shown(s)} in {used[s]} triangles" for s in order(sides) if used[s] != 1]
    for pair in order(set(used) - sides):
        if len(pair) == 2 and used[pair] != 2:
            found.append(f"inner edge {shown(pair)} in {used[pair]} triangles")
        if len(pair) == 2 and 0 not in pair and share_face(*(PAPER_EDGES[n] for n in pair)):
            found.append(f"inner edge {shown(pair)} on a face")
    return found


def order(found: set[Pair]) -> list[Pair]:
    """The pairs in the order of their numbers."""
    return sorted(found, key=sorted)


def shown(numbers: Pair | Numbers) -> str:
    """The edges as the paper writes them.

    >>> shown((1, 10, 0))
    'e1e10e0'
    """
    return "".join(
        f"e{n}" for n in (sorted(numbers) if isinstance(numbers, frozenset) else numbers)
    )


def readings(triangles: list[Numbers], slips: int) -> Iterator[list[Numbers]]:
    """The list with so many of its numbers read as what they may stand for."""
    flat = [n for t in triangles for n in t]
    doubtful = [i for i, n in enumerate(flat) if n in SLIPS]
    for places in combinations(doubtful, slips):
        for meant in product(*(SLIPS[flat[i]] for i in places)):
            new = flat.copy()
            for i, n in zip(places, meant, strict=True):
                new[i] = n
            yield [tuple(new[i : i + 3]) for i in range(0, len(new), 3)]


@dataclass(frozen=True)
class Checked:
    """A printed list and what became of it.

    printed, fitting : the triangles as scanned, and as they must be read
    wrong : what is wrong with the list as scanned
    choices : how many different sets of triangles fit with as few slips
    """

    name: str
    printed: list[Numbers]
    wrong: list[str]
    fitting: list[Numbers] | None
    choices: int

    @property
    def verdict(self) -> str:
        """One line for the report."""
        if not self.wrong:
            return "fits as scanned"
        if self.fitting is None:
            return "cannot be right: " + "; ".join(self.wrong)
        changed = [
            f"{shown(old)} is {shown(new)}"
            for old, new in zip(self.printed, self.fitting, strict=True)
            if old != new
        ]
        return "misprint of the scan: " + ", ".join(changed)


def check(name: str, text: str) -> Checked:
    """The printed list of a variant, read with as few slips as make it fit."""
    printed, polygons = read_list(text), polygons_of(name)
    wrong = faults(printed, polygons)
    for slips in range(MOST_SLIPS + 1):
        fitting = [list(r) for r in readings(printed, slips) if not faults(r, polygons)]
        if fitting:
            different = {frozenset(frozenset(t) for t in reading) for reading in fitting}
            return Checked(name, printed, wrong, fitting[0], len(different))
    return Checked(name, printed, wrong, None, 0)


def check_all() -> list[Checked]:
    """Every list of section 3."""
    return [check(name, text) for name, text in PRINTED["triangulations"].items()]


def barred_edges() -> tuple[list[Numbers], list[Pair]]:
    """The edges section 3 does not allow in Figure 12, as scanned, and as derived."""
    printed = read_list(PRINTED["edges not allowed in Figure 12"])
    (polygon,) = polygons_of("10B")
    derived = {
        frozenset(pair)
        for pair in combinations(polygon, 2)
        if share_face(*(PAPER_EDGES[n] for n in pair))
    } - sides_of([polygon])
    return printed, order(derived)


if __name__ == "__main__":
    for checked in check_all():
        print(checked.name, checked.verdict, f"({checked.choices})")
    print(*(" ".join(map(shown, found)) for found in barred_edges()), sep="\n")
