"""How Bourke's public tables cut the cycles of VESTA L, disconnect: what rule there is, counted.

Sections I and III say that the extended marching cubes of Bourke and others gives exactly the
surface of VESTA L, disconnect. The tables (PyMCubes brings them) are read here by asking for each
of the 254 mixed cells. Their bits mark values below the level, so that they are asked about -F. The
cycles come out the same; how they are cut into triangles does not follow from the cycle alone.

Glossary
--------
drawing     the triangles of one cycle, without direction: a frozenset of frozensets of edges
class       a cell with one of its cycles, up to rotation: configuration, inverted or not, and the
            canonical cycle
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
from isograde.reproduction import Table
from isoref.cube import (
    CORNERS,
    EDGE_OF,
    EDGES,
    ROTATIONS,
    configuration,
    is_exchanged,
    moved_signs,
)
from isoref.cycles import Polygon
from isoref.marching_vesta import cycles, rule

Drawing = frozenset[frozenset[int]]
Class = tuple[int, bool, int, tuple[int, ...]]
DISCONNECT = 0b111111
OURS = rule("disconnect", "L")


@dataclass(frozen=True)
class Cut:
    """One cycle of one cell, and how the tables cut it."""

    signs: int
    cycle: Polygon
    drawing: Drawing


def table_triangles(signs: int) -> list[tuple[int, int, int]]:
    """The triangles of the tables for a cell with these corners active, by our edges."""
    import mcubes

    values = np.ones((2, 2, 2))
    for c, corner in enumerate(CORNERS):
        if signs >> c & 1:
            values[corner] = -1.0
    vertices, triangles = mcubes.marching_cubes(values, 0.0)
    middle = {tuple(np.add(CORNERS[a], CORNERS[b])): e for e, (a, b) in enumerate(EDGES)}
    names = [middle[tuple(np.rint(2 * p).astype(int).tolist())] for p in vertices]
    return [(names[a], names[b], names[c]) for a, b, c in triangles.tolist()]


def cuts(signs: int) -> list[Cut] | None:
    """The cycles of the cell with their drawings; None where the tables have other cycles."""
    triangles = table_triangles(signs)
    found = []
    for cycle in cycles(signs, DISCONNECT):
        own = [t for t in triangles if set(t) <= set(cycle)]
        sides = Counter(frozenset(p) for a, b, c in own for p in ((a, b), (b, c), (c, a)))
        border = {side for side, uses in sides.items() if uses == 1}
        wanted = {frozenset(pair) for pair in zip(cycle, cycle[1:] + cycle[:1], strict=True)}
        if border != wanted or len(own) != len(cycle) - 2:
            return None
        found.append(Cut(signs, cycle, frozenset(frozenset(t) for t in own)))
    return found if sum(len(cut.drawing) for cut in found) == len(triangles) else None


def canonical(cycle: Polygon) -> Polygon:
    """The same oriented cycle, begun at its lowest edge."""
    start = cycle.index(min(cycle))
    return cycle[start:] + cycle[:start]


def moved_drawing(drawing: Drawing, move: tuple[int, ...]) -> Drawing:
    """The drawing after each corner c went to move[c]."""
    return frozenset(frozenset(moved_edge(e, move) for e in triangle) for triangle in drawing)


def moved_edge(e: int, move: tuple[int, ...]) -> int:
    """The edge after each corner c went to move[c]."""
    a, b = EDGES[e]
    return EDGE_OF[frozenset((move[a], move[b]))]


def by_cycle(every: list[Cut]) -> dict[Polygon, Counter[Drawing]]:
    """Oriented cycle -> how often the tables cut it in which way."""
    found: dict[Polygon, Counter[Drawing]] = {}
    for cut in every:
        found.setdefault(canonical(cut.cycle), Counter())[cut.drawing] += 1
    return found


def best_rule_of_the_cycle(every: list[Cut], ways: dict[Polygon, Counter[Drawing]]) -> int:
    """Cells that a rule gets right which cuts each oriented cycle as the tables mostly do."""
    choice = {cycle: counts.most_common(1)[0][0] for cycle, counts in ways.items()}
    wrong = {cut.signs for cut in every if choice[canonical(cut.cycle)] != cut.drawing}
    return len({cut.signs for cut in every} - wrong)


def classes(every: list[Cut]) -> dict[Class, set[frozenset[Drawing]]]:
    """Class -> the orbits of its drawings under the rotations that leave its cell as it is.

    A class with one orbit is one drawing, carried about by rotations.
    """
    found: dict[Class, set[frozenset[Drawing]]] = {}
    for cut in every:
        views = [
            ((moved_signs(cut.signs, m), tuple(sorted(moved_edge(e, m) for e in cut.cycle))), m)
            for m in ROTATIONS
        ]
        least = min(view for view, _ in views)
        orbit = frozenset(moved_drawing(cut.drawing, m) for view, m in views if view == least)
        key = (configuration(cut.signs), is_exchanged(cut.signs), *least)
        found.setdefault(key, set()).add(orbit)
    return found


def same_triangles(signs: int, every: list[Cut]) -> bool:
    """Whether our L has the triangles of the tables in this cell."""
    ours = frozenset(frozenset(t) for t in OURS.tile(signs, DISCONNECT).triangles)
    return ours == frozenset(t for cut in every for t in cut.drawing)


def report() -> list[Table | str]:
    """The counts, and what follows from them."""
    try:
        found = {signs: cuts(signs) for signs in range(1, 255)}
    except ImportError:
        return ["## How L cuts its cycles\n\nSkipped: PyMCubes, which has the tables, is absent."]
    every = [cut for own in found.values() if own for cut in own]
    ways, orbits = by_cycle(every), classes(every)
    mixed = [cycle for cycle, counts in ways.items() if len(counts) > 1]
    alike = sum(bool(own) and same_triangles(signs, own or []) for signs, own in found.items())
    best = best_rule_of_the_cycle(every, ways)
    table = Table("How L cuts its cycles: Bourke's public tables beside VESTA L, disconnect")
    table.add("cells with the same cycles", None, sum(own is not None for own in found.values()),
              expected=len(found), note="sections I and III: exactly the same surface")  # fmt: skip
    table.add("cells with the same triangles", None, alike, expected=len(found))
    table.add("oriented cycles that occur", None, len(ways))
    sizes = Counter(len(cycle) for cycle in mixed)
    note = ", ".join(f"{n} of {length} points" for length, n in sorted(sizes.items()))
    table.add("of these cut in two ways by the tables", None, len(mixed), note=note)
    note = "each oriented cycle cut as the tables mostly cut it"
    table.add("cells right by the best rule of the cycle alone", None, best, note=note)
    table.add("classes of a cell and a cycle under rotations", None, len(orbits))
    single = [key for key, own in orbits.items() if len(own) == 1]
    others = sorted({key[0] for key, own in orbits.items() if len(own) > 1})
    note = "the others have two drawings: configurations " + ", ".join(map(str, others))
    table.add("classes that are one drawing, turned", None, len(single), note=note)
    return [table, conclusion(len(ways), len(mixed), best, len(found))]


def conclusion(cycles_met: int, mixed: int, best: int, cells: int) -> str:
    """What the counts say, in words."""
    if mixed == 0:
        return "Every oriented cycle is cut in one way: the cut is a rule of the cycle.\n"
    return (
        f"Of the {cycles_met} oriented cycles {mixed} are cut in one way in one cell and in "
        "another way in another. So no rule that looks at the cycle alone, as the original VESTA "
        "does, "
        f"gives all {cells} tilings of the tables; the best gives {best}. The paper says that the "
        'tiling of Fig. 8 is "similar" to the templates, and "not unique".\n'
    )
